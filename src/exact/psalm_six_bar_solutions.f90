!> All solutions of a six-bar problem: those of its start set, followed.
!>
!> The start is turned so that it is near the wanted problem, and by a further phase, since a straight way between real problems
!> would meet singular ones. A path that does not arrive, or ends where another one did, is followed again the same way in extended
!> precision with more care. Where the number of solutions is known the few that are lost all the same have their last part
!> followed in quadruple precision: near solutions that nearly coincide, or that are far away, rounding hides the corrections.
!> What is missing then is sought by another way; the ends of all ways are united.
module psalm_six_bar_solutions
   use psalm_kinds, only: wp
   use psalm_six_bar_loops, only: first_equal, start_set_t, pack_columns, usual_tolerance
   use psalm_six_bar_paths, only: follow, polish
   use psalm_six_bar_paths_extended, only: follow_extended => follow, polish_extended => polish
   use psalm_six_bar_paths_quad, only: follow_quad => follow
   use psalm_six_bar_problem, only: order_legs, scale_data, scale_unknowns, six_bar_data_t, six_bar_problem_t
   use psalm_six_bar_team, only: follow_shared
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: solutions_t, solve_six_bar

   integer, parameter :: most_passes = 3
   real(wp), parameter :: phase = 0.8_wp             !! radians
   real(wp), parameter :: careful(2) = [1.0e-5_wp, 1.0e-7_wp] !! errors of a prediction that is aimed at
   real(wp), parameter :: last_part = 0.01_wp        !! of a path, in quadruple precision
   integer, parameter :: most_in_quad = 64           !! more lost paths than that lie at the problem, not at rounding
   real(wp), parameter :: same_exactly = 1.0e-18_wp  !! square of the relative difference of ends in extended precision that are one
   real(wp), parameter :: doubtful_digits = 1.0e-12_wp !! last correction of an end that is polished again
   real(wp), parameter :: far_off = 1.0e3_wp         !! a number of a path that is lost far away, over the frame
   !> By which phases a pass turns input and output.
   real(wp), parameter :: signs(2, most_passes) = reshape([1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 0.6_wp], [2, most_passes])

   !> What was found.
   type :: solutions_t
      complex(wp), allocatable :: ends(:, :)         !! distinct, shape (2 unknowns, count)
      real(wp), allocatable :: left(:)               !! last relative correction of each
      integer :: expected = 0                        !! of the start set
      integer :: passes = 0
      integer :: paths = 0, followed = 0             !! of the last pass
      integer :: lost_far = 0, lost_near = 0         !! of the last pass, paths that did not arrive: far away, at singular places
      integer :: mended = 0                          !! paths of all passes that extended precision has led to their end
      integer :: steps = 0
      logical :: stopped = .false.
   contains
      procedure :: complete
   end type solutions_t

contains

   !> True if as many distinct ends were found as there are.
   elemental logical function complete(self)
      class(solutions_t), intent(in) :: self

      complete = .false.
      if (allocated(self%ends)) complete = size(self%ends, 2) == self%expected .and. .not. self%stopped
   end function complete

   !> Follow the solutions of a start set to a problem of its kind.
   subroutine solve_six_bar(start, to, certain, threads, found, stop)
      type(start_set_t), intent(in) :: start
      type(six_bar_data_t), intent(in) :: to
      logical, intent(in) :: certain                 !! the start set has all; if not one pass is made
      integer, intent(in) :: threads                 !! that share the paths; the ends do not depend on it
      type(solutions_t), intent(out) :: found
      type(stop_t), intent(in), optional :: stop     !! asked now and then
      type(six_bar_data_t) :: from
      complex(wp), allocatable :: starts(:, :), ends(:, :), all_of_them(:, :)
      logical, allocatable :: arrived(:)
      integer, allocatable :: equal(:)
      complex(wp) :: l, m
      integer :: pass, i, n, steps

      associate (problem => start%problem)
         n = size(start%first, 2)
         found%expected = n
         found%paths = n
         allocate (found%ends(2*problem%unknowns, 0))
         allocate (arrived(n))
         do pass = 1, merge(most_passes, 1, certain)
            l = nearest_turn(problem%points, to%e0, to%de, start%data(1)%e0, start%data(1)%de)*turn(signs(1, pass))
            m = nearest_turn(problem%points, to%f0, to%df, start%data(1)%f0, start%data(1)%df)*turn(signs(2, pass))
            call scale_data(problem, start%data(1), l, m, from)
            starts = start%first
            do i = 1, n
               call scale_unknowns(problem, l, m, starts(:, i))
            end do
            ends = starts
            call follow_shared(follow, problem, from, to, starts, usual_tolerance, threads, .true., ends, arrived, &
                               steps, found%stopped, stop)
            call order_legs(problem, ends)
            found%steps = found%steps + steps
            if (.not. found%stopped) call mend(problem, from, to, starts, certain, threads, ends, arrived, found, stop)
            found%passes = pass
            found%followed = merge(count(arrived), n, found%stopped)
            ! a path that was cut off is not lost
            found%lost_far = 0
            found%lost_near = 0
            if (.not. found%stopped) then
               found%lost_far = count(.not. arrived .and. maxval(abs(ends), 1) > far_off)
               found%lost_near = count(.not. arrived) - found%lost_far
            end if
            ends = pack_columns(ends, arrived)
            allocate (all_of_them(size(ends, 1), size(found%ends, 2) + size(ends, 2)))
            all_of_them(:, :size(found%ends, 2)) = found%ends
            all_of_them(:, size(found%ends, 2) + 1:) = ends
            equal = same_ends(problem, to, all_of_them, size(found%ends, 2))
            found%ends = pack_columns(all_of_them, equal == [(i, i=1, size(equal))])
            deallocate (all_of_them)
            if (size(found%ends, 2) >= n .or. found%stopped) exit
         end do
         allocate (found%left(size(found%ends, 2)))
         call polish(problem, to, found%ends, found%left)
         call polish_rest(problem, to, found)
      end associate

   contains

      complex(wp) function turn(sign)
         real(wp), intent(in) :: sign

         turn = cmplx(cos(sign*phase), sin(sign*phase), wp)
      end function turn
   end subroutine solve_six_bar

   !> The turn that brings the points of one problem nearest to those of another.
   pure complex(wp) function nearest_turn(points, e0, de, start_e0, start_de)
      integer, intent(in) :: points
      complex(wp), intent(in) :: e0, de(:), start_e0, start_de(:)

      nearest_turn = e0*conjg(start_e0) + sum((e0 + de(:points))*conjg(start_e0 + start_de(:points)))
      if (abs(nearest_turn) > 0.0_wp) then
         nearest_turn = nearest_turn/abs(nearest_turn)
      else
         nearest_turn = (1.0_wp, 0.0_wp)
      end if
   end function nearest_turn

   !> Polish in extended precision what rounding has left in double.
   subroutine polish_rest(problem, to, found)
      type(six_bar_problem_t), intent(in) :: problem
      type(six_bar_data_t), intent(in) :: to
      type(solutions_t), intent(inout) :: found
      complex(wp), allocatable :: rest(:, :)
      real(wp), allocatable :: left(:)
      integer, allocatable :: which(:)
      integer :: i

      which = pack([(i, i=1, size(found%left))], found%left > doubtful_digits)
      rest = found%ends(:, which)
      left = found%left(which)
      call polish_extended(problem, to, rest, left)
      found%ends(:, which) = rest
      found%left(which) = left
   end subroutine polish_rest

   !> For each end the first that is the same, itself if it is new. Real ends may lie so near each other that only extended
   !> precision separates them. The first `known` differ from each other.
   function same_ends(problem, to, ends, known) result(first)
      type(six_bar_problem_t), intent(in) :: problem
      type(six_bar_data_t), intent(in) :: to
      complex(wp), intent(in) :: ends(:, :)          !! shape (2 unknowns, count)
      integer, intent(in) :: known
      integer, allocatable :: first(:)
      complex(wp), allocatable :: near(:, :)
      real(wp), allocatable :: left(:)
      integer, allocatable :: which(:), finer(:)
      logical, allocatable :: crowded(:)
      integer :: of(2, size(ends, 2)), i, k

      first = first_equal(ends)
      ! one end of each way is the usual; more at a place may be several ends
      of = 0
      do i = 1, size(first)
         k = merge(1, 2, i <= known)
         of(k, first(i)) = of(k, first(i)) + 1
      end do
      crowded = [(any(of(:, first(i)) > 1), i=1, size(first))]
      which = pack([(i, i=1, size(first))], crowded)
      if (size(which) == 0) return
      near = ends(:, which)
      allocate (left(size(which)))
      call polish_extended(problem, to, near, left)
      finer = first_equal(near, same_exactly)
      do i = 1, size(which)
         first(which(i)) = which(finer(i))
      end do
   end function same_ends

   !> Follow those that did not arrive, and those that ended at the same place, again with more care.
   subroutine mend(problem, from, to, starts, certain, threads, ends, arrived, found, stop)
      type(six_bar_problem_t), intent(in) :: problem
      type(six_bar_data_t), intent(in) :: from, to
      complex(wp), intent(in) :: starts(:, :)
      logical, intent(in) :: certain                 !! all paths have an end
      integer, intent(in) :: threads
      complex(wp), intent(inout) :: ends(:, :)
      logical, intent(inout) :: arrived(:)
      type(solutions_t), intent(inout) :: found
      type(stop_t), intent(in), optional :: stop
      complex(wp), allocatable :: again(:, :)
      logical, allocatable :: came(:), doubtful(:)
      integer, allocatable :: equal(:), which(:), own(:)
      integer :: care, i, steps

      do care = 1, size(careful) + merge(1, 0, certain)
         own = pack([(i, i=1, size(arrived))], arrived)
         equal = same_ends(problem, to, ends(:, own), 0)
         doubtful = .not. arrived
         do i = 1, size(own)
            if (equal(i) == i) cycle
            doubtful(own(i)) = .true.
            doubtful(own(equal(i))) = .true.
         end do
         which = pack([(i, i=1, size(arrived))], doubtful)
         if (size(which) == 0) exit
         allocate (again(size(starts, 1), size(which)), came(size(which)))
         if (care <= size(careful)) then
            call follow_shared(follow_extended, problem, from, to, starts(:, which), careful(care), threads, .false., &
                               again, came, steps, found%stopped, stop)
         else if (size(which) > most_in_quad) then
            exit
         else
            call follow_last_part(problem, from, to, starts(:, which), threads, again, came, steps, found%stopped, stop)
         end if
         found%steps = found%steps + steps
         found%mended = found%mended + count(came .and. .not. arrived(which))
         if (found%stopped) exit
         do i = 1, size(which)
            if (.not. came(i)) cycle
            ends(:, which(i)) = again(:, i)
            arrived(which(i)) = .true.
         end do
         call order_legs(problem, ends)
         deallocate (again, came)
      end do
   end subroutine mend

   !> Follow paths in extended precision and with the greatest care until little of the way is left, that in quadruple precision.
   subroutine follow_last_part(problem, from, to, starts, threads, ends, arrived, steps, stopped, stop)
      type(six_bar_problem_t), intent(in) :: problem
      type(six_bar_data_t), intent(in) :: from, to
      complex(wp), intent(in) :: starts(:, :)
      integer, intent(in) :: threads
      complex(wp), intent(out) :: ends(:, :)
      logical, intent(out) :: arrived(:)
      integer, intent(out) :: steps
      logical, intent(out) :: stopped
      type(stop_t), intent(in), optional :: stop
      type(six_bar_data_t) :: between
      complex(wp), allocatable :: rest(:, :)
      logical, allocatable :: came(:)
      integer, allocatable :: which(:)
      integer :: i, more

      between%e0 = to%e0 + last_part*(from%e0 - to%e0)
      between%f0 = to%f0 + last_part*(from%f0 - to%f0)
      between%de = to%de + last_part*(from%de - to%de)
      between%df = to%df + last_part*(from%df - to%df)
      between%known = to%known + last_part*(from%known - to%known)
      call follow_shared(follow_extended, problem, from, between, starts, careful(size(careful)), threads, .false., &
                         ends, arrived, steps, stopped, stop)
      if (stopped) return
      which = pack([(i, i=1, size(arrived))], arrived)
      allocate (rest(size(starts, 1), size(which)), came(size(which)))
      call follow_shared(follow_quad, problem, between, to, ends(:, which), careful(1), threads, .false., rest, came, &
                         more, stopped, stop)
      steps = steps + more
      ends(:, which) = rest
      arrived(which) = came
   end subroutine follow_last_part
end module psalm_six_bar_solutions
