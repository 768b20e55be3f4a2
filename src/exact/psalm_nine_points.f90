!> Four-bars whose coupler point passes nine points: all of them.
!>
!> The solutions of a stored problem are followed to the one that is wanted. The stored points lie on a disturbed oval; the wanted
!> ones are matched to them, in any order, turned, scaled and perhaps mirrored, so that the way is short. It begins at the stored
!> problem with numbers and partners turned alike by one phase: a straight way between real problems would meet singular ones.
!> A path that does not arrive, or ends where another one did (one of both has jumped), is followed again the same way with more
!> care, at last in quadruple precision. If paths are unsettled then, all are followed by another way, whose phase is another.
!> There are 1442 solutions but for exchange of the legs and cognates, so 1442 distinct ends are all. Points that lie symmetrically
!> about an axis have fewer: some paths end at infinity, some in pairs at double solutions. Sources: Alt (1923); Wampler, Morgan and
!> Sommese (1992) for the number.
module psalm_nine_points
   use psalm_careful_tracking, only: ends_t, take_ends, track_carefully
   use psalm_kinds, only: wp
   use psalm_leg_lanes, only: problem_path_t
   use psalm_leg_problem, only: kind_point, leg_data_t, make_problem, most_points, variables
   use psalm_monodromy, only: scale_problem, scale_solutions
   use psalm_nine_points_start, only: own_conjugates, printed_points => start_points, start_line, stored
   use psalm_start_text, only: characters_a_number, decode
   use psalm_stop, only: stop_t
   use psalm_tracker, only: polish, track, tracked_t
   implicit none (type, external)
   private
   public :: nine_points_t, solve_nine_points, nine_point_orbits, in_place

   integer, parameter :: nine_point_orbits = 1442    !! Wampler, Morgan and Sommese (1992)
   integer, parameter :: most_passes = 3
   complex(wp), parameter :: start_points(0:most_points) = cmplx(printed_points, kind=wp)
   real(wp), parameter :: phases(most_passes) = [0.7_wp, -0.7_wp, 0.55_wp] !! radians

   !> All solutions, in the coordinates in which they were followed.
   type :: nine_points_t
      complex(wp), allocatable :: solutions(:, :)    !! shape (variables, count): distinct finite ends, singular ones last
      real(wp), allocatable :: left(:)               !! last relative correction of each regular one; of a singular one 0
      type(ends_t) :: ends                           !! how the paths ended
      type(problem_path_t) :: path                           !! whose end is the wanted problem, matched to the stored one
      integer :: order(0:most_points) = 0            !! the wanted point, from 1, that stands at each place
      complex(wp) :: factor = (1.0_wp, 0.0_wp)       !! by which wanted points were multiplied
      logical :: mirrored = .false.                  !! after they were mirrored
      integer :: passes = 0
      integer :: steps = 0
      integer :: precise = 0                         !! paths followed in quadruple precision
   end type nine_points_t

contains

   !> Follow the stored solutions to nine points. After a stop `found%ends%stopped` is true, and ends may be missing.
   subroutine solve_nine_points(points, first_phase, found, quick, stop)
      complex(wp), intent(in) :: points(0:most_points)
      integer, intent(in) :: first_phase             !! which of the phases begins, from 1
      type(nine_points_t), intent(out) :: found
      logical, intent(in), optional :: quick         !! lost paths are left alone: some ends may be missing
      type(stop_t), intent(in), optional :: stop     !! asked now and then
      complex(wp), allocatable :: starts(:, :), turned(:, :)
      complex(wp) :: wanted(0:most_points), turn
      type(leg_data_t) :: generic
      type(tracked_t) :: tracked
      integer :: pass
      logical :: lost_are_left

      lost_are_left = .false.
      if (present(quick)) lost_are_left = quick
      call match(points, found)
      call make_problem(spread(kind_point, 1, most_points), .false., .false., .false., found%path%problem)
      generic%d = start_points(1:) - start_points(0)
      generic%dh = conjg(generic%d)
      call load_starts(starts)
      found%path%to = generic
      allocate (found%left(nine_point_orbits))
      call polish(found%path, starts, found%left)
      deallocate (found%left)
      wanted = points(found%order - 1)
      if (found%mirrored) wanted = conjg(wanted)
      found%path%to%d = found%factor*(wanted(1:) - wanted(0))
      found%path%to%dh = conjg(found%path%to%d)
      do pass = 1, most_passes
         associate (phase => phases(1 + modulo(first_phase + pass - 2, most_passes)))
            turn = cmplx(cos(phase), sin(phase), wp)
         end associate
         turned = starts
         call scale_problem(found%path%problem, generic, turn, turn, found%path%from)
         call scale_solutions(found%path%problem, turn, turn, turned)
         if (lost_are_left) then
            call track(found%path, turned, tracked, stop=stop)
         else
            call track_carefully(found%path, turned, .true., tracked, stop)
         end if
         found%steps = found%steps + tracked%steps
         found%precise = found%precise + tracked%precise
         call take_ends(found%path, tracked, .true., found%ends)
         found%passes = pass
         if (found%ends%complete() .or. found%ends%stopped .or. lost_are_left) exit
      end do
      allocate (found%left(found%ends%count_of()), source=0.0_wp)
      call polish(found%path, found%ends%regular, found%left(:size(found%ends%regular, 2)))
      allocate (found%solutions(variables, found%ends%count_of()))
      found%solutions(:, :size(found%ends%regular, 2)) = found%ends%regular
      found%solutions(:, size(found%ends%regular, 2) + 1:) = found%ends%singular
   end subroutine solve_nine_points

   !> The stored solutions and the conjugates of those that come in pairs.
   pure subroutine load_starts(starts)
      complex(wp), allocatable, intent(out) :: starts(:, :)
      real(wp) :: parts(2*variables)
      character(2*variables*characters_a_number) :: line
      integer :: i, k, next

      allocate (starts(variables, nine_point_orbits))
      next = stored
      do i = 1, stored
         line = start_line(i)
         do k = 1, 2*variables
            parts(k) = decode(line((k - 1)*characters_a_number + 1:k*characters_a_number))
         end do
         starts(:, i) = cmplx(parts(1::2), parts(2::2), wp)
         if (i <= own_conjugates) cycle
         next = next + 1
         starts(:, next) = conjg(starts([2, 1, 4, 3, 6, 5, 8, 7], i))
      end do
   end subroutine load_starts

   !> Order, factor and mirroring of the wanted points that bring them nearest to the stored ones.
   pure subroutine match(points, found)
      complex(wp), intent(in) :: points(0:most_points)
      type(nine_points_t), intent(inout) :: found
      integer, parameter :: n = most_points + 1
      complex(wp) :: stored_about(0:most_points), about(0:most_points), product
      integer :: stored_order(0:most_points), order(0:most_points), shift, mirror
      real(wp) :: distance, least

      stored_about = start_points - sum(start_points)/real(n, wp)
      stored_order = by_angle(stored_about)
      least = huge(1.0_wp)
      do mirror = 1, 2
         about = points - sum(points)/real(n, wp)
         if (mirror == 2) about = conjg(about)
         order = by_angle(about)
         do shift = 0, most_points
            product = sum(conjg(about(cshift(order, shift)))*stored_about(stored_order))
            distance = -abs(product)**2
            if (distance >= least) cycle
            least = distance
            found%mirrored = mirror == 2
            found%factor = product/sum(abs(about)**2)
            found%order(stored_order) = cshift(order, shift) + 1
         end do
      end do
   end subroutine match

   !> Numbers, from 0, of points by their angle about 0.
   pure function by_angle(points) result(order)
      complex(wp), intent(in) :: points(0:most_points)
      integer :: order(0:most_points)
      real(wp) :: angle(0:most_points)
      integer :: i, k

      angle = atan2(aimag(points), real(points, wp))
      do i = 0, most_points
         k = i
         do while (k > 0)
            if (angle(order(k - 1)) <= angle(i)) exit
            order(k) = order(k - 1)
            k = k - 1
         end do
         order(k) = i
      end do
   end function by_angle

   !> A solution in the coordinates of the wanted points: x, a, y, b and partners from the point that stands first in the order.
   pure function in_place(found, v) result(own)
      type(nine_points_t), intent(in) :: found
      complex(wp), intent(in) :: v(variables)
      complex(wp) :: own(variables)

      own(1::2) = v(1::2)/found%factor
      own(2::2) = v(2::2)/conjg(found%factor)
      if (found%mirrored) own = own([2, 1, 4, 3, 6, 5, 8, 7])
   end function in_place
end module psalm_nine_points
