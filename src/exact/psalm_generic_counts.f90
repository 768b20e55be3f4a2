!> How many finite solutions a generic problem of two legs has.
!>
!> Of nine conditions of a path alone without exchange of the legs and cognates. Computed by monodromy, every number unchanged over
!> eight further loops; 8652/6 and 36 are those of Wampler, Morgan and Sommese (1992).
module psalm_generic_counts
   use psalm_leg_problem, only: kind_point, kind_pose, kind_rate, kind_timed, leg_problem_t
   implicit none (type, external)
   private
   public :: solutions_of

   type :: kind_t
      integer :: points, poses, timed                !! beyond the first
      logical :: slides, crank_given, follower_given
      integer :: solutions
   end type kind_t

   logical, parameter :: y = .true., n = .false.
   type(kind_t), parameter :: rows(*) = [ &
      kind_t(0, 4, 0, n, n, n, 12), kind_t(2, 3, 0, n, n, n, 60), kind_t(4, 2, 0, n, n, n, 402), kind_t(6, 1, 0, n, n, n, 2224), &
      kind_t(0, 0, 4, n, n, n, 12), kind_t(2, 0, 3, n, n, n, 60), kind_t(4, 0, 2, n, n, n, 402), kind_t(6, 0, 1, n, n, n, 2224), &
      kind_t(0, 1, 3, n, n, n, 15), kind_t(0, 2, 2, n, n, n, 15), kind_t(0, 3, 1, n, n, n, 15), &
      kind_t(2, 1, 2, n, n, n, 94), kind_t(2, 2, 1, n, n, n, 94), kind_t(4, 1, 1, n, n, n, 556), &
      kind_t(4, 0, 0, n, y, y, 36), kind_t(2, 1, 0, n, y, y, 6), kind_t(2, 0, 1, n, y, y, 8), &
      kind_t(0, 2, 0, n, y, y, 1), kind_t(0, 0, 2, n, y, y, 1), kind_t(0, 1, 1, n, y, y, 1), &
      kind_t(6, 0, 0, n, y, n, 486), kind_t(4, 1, 0, n, y, n, 94), kind_t(2, 2, 0, n, y, n, 12), &
      kind_t(6, 0, 0, n, n, y, 486), kind_t(4, 1, 0, n, n, y, 94), kind_t(2, 2, 0, n, n, y, 12), &
      kind_t(4, 0, 1, n, y, n, 94), kind_t(2, 0, 2, n, y, n, 12), kind_t(4, 0, 1, n, n, y, 140), kind_t(2, 0, 2, n, n, y, 28), &
      kind_t(7, 0, 0, y, n, n, 558), kind_t(5, 1, 0, y, n, n, 202), kind_t(3, 2, 0, y, n, n, 42), kind_t(1, 3, 0, y, n, n, 6), &
      kind_t(5, 0, 1, y, n, n, 202), kind_t(3, 0, 2, y, n, n, 42), kind_t(1, 0, 3, y, n, n, 6), &
      kind_t(5, 0, 0, y, y, n, 62), kind_t(3, 1, 0, y, y, n, 14), kind_t(1, 2, 0, y, y, n, 2), kind_t(3, 0, 1, y, y, n, 14), &
      kind_t(1, 0, 2, y, y, n, 2)]

   !> With terms along the path: a base, the places that have terms and the number of solutions. The base is 1000 times the number
   !> of points if each term were one, 100 of poses, 10 of timed points, all beyond the first, and what is given: 1 the crank's
   !> pivot, 2 the follower's, 3 both; 4 a slide, 5 with the crank's pivot. Of places, 10 times the number of those with a tangent
   !> alone and that of those with a curvature: first of points, then of poses or timed points and the first point. Timed points
   !> without a pivot of the follower's have the numbers of poses (a cognate's coupler turns as the crank does).
   integer, parameter :: row_of_terms = 4
   integer, parameter :: terms(row_of_terms, 153) = reshape([ &
      1205, 0, 10, 1, 1304, 0, 10, 3, 2013, 0, 1, 5, 2013, 0, 10, 6, 2013, 0, 20, 4, 2013, 10, 0, 6, 2022, 0, 1, 18, &
      2022, 0, 10, 20, 2022, 0, 20, 12, 2022, 10, 0, 24, 2103, 0, 1, 3, 2103, 0, 10, 4, 2103, 0, 20, 2, 2103, 10, 0, 4, &
      2201, 0, 1, 3, 2201, 0, 10, 6, 2201, 0, 20, 3, 2201, 10, 0, 6, 2300, 0, 1, 28, 2300, 0, 10, 32, 2300, 0, 20, 16, &
      2300, 10, 0, 52, 3105, 0, 1, 8, 3105, 0, 10, 10, 3105, 0, 11, 4, 3105, 0, 20, 6, 3105, 1, 0, 8, 3105, 10, 0, 10, &
      3105, 10, 10, 6, 3204, 0, 1, 20, 3204, 0, 10, 26, 3204, 0, 11, 10, 3204, 0, 20, 14, 3204, 0, 30, 7, 3204, 1, 0, 24, &
      3204, 10, 0, 30, 3204, 10, 10, 18, 4003, 1, 0, 24, 4003, 10, 0, 28, 4003, 11, 0, 16, 4003, 20, 0, 20, 4012, 0, 1, 82, &
      4012, 0, 2, 30, 4012, 0, 10, 98, 4012, 0, 11, 44, 4012, 0, 20, 56, 4012, 1, 0, 92, 4012, 1, 10, 62, 4012, 10, 0, 108, &
      4012, 10, 1, 62, 4012, 10, 10, 74, 4012, 10, 20, 40, 4012, 20, 0, 84, 4101, 0, 1, 46, 4101, 0, 2, 16, 4101, 0, 10, 62, &
      4101, 0, 11, 26, 4101, 0, 20, 38, 4101, 1, 0, 46, 4101, 1, 10, 26, 4101, 10, 0, 62, 4101, 10, 1, 26, 4101, 10, 10, 38, &
      4101, 10, 20, 24, 4101, 20, 0, 38, 4200, 0, 1, 174, 4200, 0, 2, 68, 4200, 0, 10, 234, 4200, 0, 11, 92, 4200, 0, 20, 128, &
      4200, 0, 21, 52, 4200, 0, 30, 72, 4200, 1, 0, 222, 4200, 1, 10, 126, 4200, 10, 0, 282, 4200, 10, 1, 126, &
      4200, 10, 10, 162, 4200, 10, 20, 88, 4200, 20, 0, 210, 5005, 1, 0, 44, 5005, 2, 0, 26, 5005, 10, 0, 50, 5005, 11, 0, 32, &
      5005, 20, 0, 38, 5005, 30, 0, 24, 5104, 0, 1, 118, 5104, 0, 2, 48, 5104, 0, 10, 142, 5104, 0, 11, 67, 5104, 0, 20, 86, &
      5104, 1, 0, 130, 5104, 1, 1, 67, 5104, 1, 10, 85, 5104, 1, 20, 50, 5104, 10, 0, 154, 5104, 10, 1, 84, 5104, 10, 10, 104, &
      5104, 10, 11, 47, 5104, 10, 20, 62, 5104, 11, 0, 94, 5104, 20, 0, 114, 5104, 20, 10, 74, 6001, 1, 0, 294, &
      6001, 2, 0, 156, 6001, 10, 0, 358, 6001, 11, 0, 202, 6001, 20, 0, 254, 6001, 21, 0, 134, 6001, 30, 0, 174, &
      6100, 0, 1, 1134, 6100, 0, 2, 428, 6100, 0, 10, 1446, 6100, 0, 11, 620, 6100, 0, 20, 840, 6100, 1, 0, 1288, &
      6100, 1, 1, 594, 6100, 1, 10, 786, 6100, 1, 11, 338, 6100, 1, 20, 456, 6100, 2, 0, 712, 6100, 10, 0, 1600, &
      6100, 10, 1, 774, 6100, 10, 2, 312, 6100, 10, 10, 1006, 6100, 10, 11, 432, 6100, 10, 20, 584, 6100, 11, 0, 904, &
      6100, 11, 10, 550, 6100, 20, 0, 1136, 6100, 20, 1, 542, 6100, 20, 10, 702, 6100, 20, 20, 416, 6100, 30, 0, 816, &
      7004, 1, 0, 378, 7004, 2, 0, 234, 7004, 10, 0, 438, 7004, 11, 0, 282, 7004, 12, 0, 162, 7004, 20, 0, 334, &
      7004, 21, 0, 202, 7004, 30, 0, 246, 7004, 40, 0, 174, 8000, 1, 0, 857, 8000, 2, 0, 461, 8000, 3, 0, 227, &
      8000, 10, 0, 1052, 8000, 11, 0, 593, 8000, 12, 0, 305, 8000, 20, 0, 746, 8000, 21, 0, 401, 8000, 30, 0, 516, &
      8000, 31, 0, 273, 8000, 40, 0, 354 &
      ], [row_of_terms, 153])
   integer, parameter :: of_points = 1000, of_poses = 100, of_timed = 10, of_tangents = 10

contains

   !> Solutions of a generic problem of the kind, 0 if they are not known.
   pure integer function solutions_of(problem)
      type(leg_problem_t), intent(in) :: problem
      integer :: i

      solutions_of = 0
      associate (kinds => problem%kind(:problem%points))
         if (any(kinds == kind_rate)) then
            solutions_of = with_terms(problem)
            return
         end if
         do i = 1, size(rows)
            if (rows(i)%points == count(kinds == kind_point) .and. rows(i)%poses == count(kinds == kind_pose) .and. &
                rows(i)%timed == count(kinds == kind_timed) .and. (rows(i)%slides .eqv. problem%slides) .and. &
                (rows(i)%crank_given .eqv. problem%crank_given) .and. &
                (rows(i)%follower_given .eqv. problem%follower_given)) solutions_of = rows(i)%solutions
         end do
      end associate
   end function solutions_of

   !> The same with terms along the path.
   pure integer function with_terms(problem)
      type(leg_problem_t), intent(in) :: problem
      integer :: at_points, elsewhere, base, i, poses, timed, own
      logical :: is_point

      with_terms = 0
      at_points = 0
      elsewhere = 0
      associate (kinds => problem%kind(:problem%points))
         poses = count(kinds == kind_pose)
         timed = count(kinds == kind_timed)
         if (poses > 0 .and. timed > 0) return
         do i = 1, problem%points
            if (kinds(i) /= kind_rate) cycle
            is_point = poses + timed == 0
            if (problem%chain(0, i) > 0) is_point = kinds(problem%chain(0, i)) == kind_point
            ! one with a curvature was counted as one with a tangent
            own = merge(of_tangents, 1 - of_tangents, problem%order(i) == 1)
            if (is_point) at_points = at_points + own
            if (.not. is_point) elsewhere = elsewhere + own
         end do
         base = of_points*(count(kinds == kind_point) + count(kinds == kind_rate))
      end associate
      if (.not. problem%follower_given) then
         poses = poses + timed
         timed = 0
      end if
      base = base + of_poses*poses + of_timed*timed
      if (problem%slides) then
         base = base + merge(5, 4, problem%crank_given)
      else if (problem%follower_given) then
         base = base + merge(3, merge(2, 1, timed > 0), problem%crank_given)
      else
         base = base + merge(1, 0, problem%crank_given)
      end if
      do i = 1, size(terms, 2)
         if (terms(1, i) == base .and. terms(2, i) == at_points .and. terms(3, i) == elsewhere) with_terms = terms(4, i)
      end do
   end function with_terms
end module psalm_generic_counts
