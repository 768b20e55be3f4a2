!> All solutions of one real six-bar problem, from nothing: the start set of every other problem of its kind.
!>
!> One generic problem is drawn with a solution, which is followed to a real problem whose points rise as those of functions do. A
!> second problem lies near that. All solutions known of one are followed to the other again and again, each time with e and f of
!> both turned against each other, which is another way; of the real problem the conjugate of a solution is one too. Small loops
!> alone may miss some, so the last passes turn by any angle. The state can be kept after every pass and taken up again. Source:
!> Duff, Hill, Jensen, Lee, Leykin and Sommars (2019), as psalm_monodromy.
module psalm_six_bar_loops
   use psalm_kinds, only: wp, pi
   use psalm_leg_problem, only: gaussian
   use psalm_six_bar_paths, only: follow
   use psalm_six_bar_problem, only: data_of_angles, draw_six_bar, most_unknowns, near_data, order_legs, scale_data, &
                                    scale_unknowns, six_bar_data_t, six_bar_problem_t, unit_phase
   use psalm_six_bar_team, only: follow_shared
   use psalm_sort, only: ascending
   use psalm_stop, only: stop_t
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: start_set_t, begin_loops, next_loop, first_equal, pack_columns, usual_tolerance

   real(wp), parameter :: usual_tolerance = 1.0e-4_wp !! error of a prediction that is aimed at
   real(wp), parameter :: near_by = 0.8_wp           !! deviation of the second problem, and of the phases of small loops
   real(wp), parameter :: same_within = 1.0e-11_wp   !! square of the relative difference of numbers that are the same
   real(wp), parameter :: window = 1.0e-6_wp         !! of the sums that solutions are sorted by
   integer, parameter :: idle_passes = 4             !! that turn by any angle and find nothing new
   integer, parameter :: most_draws = 200
   integer, parameter :: found_rarely = 4000         !! one in so many is almost none
   ! the real problem: points over so many radians, moved by up to so much of their distance
   real(wp), parameter :: range = 1.4_wp, disturbed = 0.8_wp

   !> How far the search has come.
   type :: start_set_t
      type(six_bar_problem_t) :: problem
      integer :: seed = 1
      integer :: passes = 0                          !! made
      integer :: idle = 0                            !! passes by any angle since one was new
      logical :: done = .false.
      type(six_bar_data_t) :: data(2)                !! of the real problem and of the other
      complex(wp), allocatable :: first(:, :), second(:, :) !! solutions known of both, shape (2 unknowns, count)
      integer :: paths = 0, lost = 0, steps = 0
   end type start_set_t

contains

   !> Both problems, and one solution of the first; none if none could be drawn.
   subroutine begin_loops(problem, seed, loops, drawn)
      type(six_bar_problem_t), intent(in) :: problem
      integer, intent(in) :: seed
      type(start_set_t), intent(out) :: loops
      logical, intent(out) :: drawn
      type(xoshiro_t) :: random
      type(six_bar_data_t) :: generic
      complex(wp) :: x(2*problem%unknowns, 1), reached(2*problem%unknowns, 1)
      real(wp) :: phi(0:problem%points), psi(0:problem%points), deviate
      logical :: arrived(1)
      integer :: n, k, steps, turn

      loops%problem = problem
      loops%seed = seed
      call random%seed(seed, purpose_starts)
      n = problem%unknowns
      do k = 0, problem%points
         call random%next(deviate)
         phi(k) = range*(real(k, wp) + disturbed*(deviate - 0.5_wp))/real(problem%points, wp)
         call random%next(deviate)
         psi(k) = range*(real(k, wp) + disturbed*(deviate - 0.5_wp))/real(problem%points, wp)
      end do
      call data_of_angles(phi, psi, loops%data(1))
      do k = 1, n
         if (problem%length_of == k) loops%data(1)%known(k) = abs(gaussian(random))**2
         if (.not. problem%is_given(k)) cycle
         loops%data(1)%known(k) = gaussian(random)
         loops%data(1)%known(n + k) = conjg(loops%data(1)%known(k))
      end do
      call near_data(problem, loops%data(1), near_by, random, loops%data(2))
      allocate (loops%first(2*n, 0), loops%second(2*n, 0))
      do turn = 1, most_draws
         call draw_six_bar(problem, random, generic, x(:, 1), drawn)
         if (.not. drawn) cycle
         call follow(problem, generic, loops%data(1), x, usual_tolerance, reached, arrived, steps)
         drawn = arrived(1)
         if (drawn) exit
      end do
      if (.not. drawn) return
      call add_to(problem, loops%first, reached)
      call add_to(problem, loops%first, conjugates(problem, reached))
   end subroutine begin_loops

   !> One pass: all solutions known of one problem are followed to the other. With `expected` it is done when so many of the first
   !> are known, without it when almost none is found any more.
   subroutine next_loop(loops, expected, threads, stopped, stop)
      type(start_set_t), intent(inout) :: loops
      integer, intent(in) :: expected                !! 0: not known
      integer, intent(in) :: threads                 !! that share the paths; the solutions do not depend on it
      logical, intent(out) :: stopped                !! the pass was cut off: nothing of it is kept
      type(stop_t), intent(in), optional :: stop
      type(xoshiro_t) :: random
      type(six_bar_data_t) :: turned
      complex(wp), allocatable :: starts(:, :), ends(:, :)
      logical, allocatable :: arrived(:)
      complex(wp) :: l, m
      integer :: before, steps, from, few
      real(wp) :: largest

      call random%seed(loops%seed, purpose_starts)
      call random%use_stream(loops%passes + 1)
      ! the same two nodes by turns; where nothing new was found lately, by any angle
      from = 1 + modulo(loops%passes, 2)
      largest = merge(pi, near_by*sqrt(3.0_wp), loops%idle > 0)
      l = unit_phase(random, largest)
      m = unit_phase(random, largest)
      if (from == 1) then
         starts = loops%first
      else
         starts = loops%second
      end if
      call scale_data(loops%problem, loops%data(from), l, m, turned)
      call scale_all(loops%problem, l, m, starts)
      allocate (ends, mold=starts)
      allocate (arrived(size(starts, 2)))
      call follow_shared(follow, loops%problem, turned, loops%data(3 - from), starts, usual_tolerance, threads, .true., &
                         ends, arrived, steps, stopped, stop)
      if (stopped) return
      loops%paths = loops%paths + size(starts, 2)
      loops%lost = loops%lost + count(.not. arrived)
      loops%steps = loops%steps + steps
      loops%passes = loops%passes + 1
      before = size(loops%first, 2) + size(loops%second, 2)
      ends = pack_columns(ends, arrived)
      if (from == 1) then
         call add_to(loops%problem, loops%second, ends)
      else
         call add_to(loops%problem, loops%first, ends)
         call add_to(loops%problem, loops%first, conjugates(loops%problem, ends))
      end if
      few = 0
      if (expected == 0) few = before/found_rarely
      if (size(loops%first, 2) + size(loops%second, 2) - before <= few) then
         loops%idle = loops%idle + 1
      else
         loops%idle = 0
      end if
      loops%done = loops%idle >= idle_passes
      if (expected > 0) loops%done = loops%done .or. size(loops%first, 2) >= expected
   end subroutine next_loop

   !> Solutions turned as the data are.
   pure subroutine scale_all(problem, l, m, solutions)
      type(six_bar_problem_t), intent(in) :: problem
      complex(wp), intent(in) :: l, m
      complex(wp), intent(inout) :: solutions(:, :)
      integer :: i

      do i = 1, size(solutions, 2)
         call scale_unknowns(problem, l, m, solutions(:, i))
      end do
   end subroutine scale_all

   !> The conjugate solutions of a real problem.
   pure function conjugates(problem, solutions) result(others)
      type(six_bar_problem_t), intent(in) :: problem
      complex(wp), intent(in) :: solutions(:, :)
      complex(wp) :: others(size(solutions, 1), size(solutions, 2))
      integer :: n

      n = problem%unknowns
      others(:n, :) = conjg(solutions(n + 1:, :))
      others(n + 1:, :) = conjg(solutions(:n, :))
   end function conjugates

   !> Those columns for which the mask is true.
   pure function pack_columns(columns, mask) result(kept)
      complex(wp), intent(in) :: columns(:, :)
      logical, intent(in) :: mask(:)
      complex(wp), allocatable :: kept(:, :)
      integer :: i

      kept = columns(:, pack([(i, i=1, size(mask))], mask))
   end function pack_columns

   !> Add solutions that are not there yet.
   subroutine add_to(problem, solutions, candidates)
      type(six_bar_problem_t), intent(in) :: problem
      complex(wp), allocatable, intent(inout) :: solutions(:, :)
      complex(wp), intent(in) :: candidates(:, :)
      complex(wp), allocatable :: both(:, :)
      integer, allocatable :: equal(:)
      integer :: i, n

      n = size(solutions, 2)
      allocate (both(size(solutions, 1), n + size(candidates, 2)))
      both(:, :n) = solutions
      both(:, n + 1:) = candidates
      call order_legs(problem, both(:, n + 1:))
      equal = first_equal(both)
      solutions = pack_columns(both, equal == [(i, i=1, size(equal))])
   end subroutine add_to

   !> For each solution the first that is the same, itself if it is new.
   pure function first_equal(solutions, within) result(first)
      complex(wp), intent(in) :: solutions(:, :)     !! shape (2 unknowns, count)
      real(wp), intent(in), optional :: within       !! square of the relative difference of numbers that are the same
      integer, allocatable :: first(:)
      real(wp), allocatable :: sums(:)
      real(wp) :: square
      integer, allocatable :: order(:)
      complex(wp) :: weight(2*most_unknowns)
      integer :: i, k, n

      square = same_within
      if (present(within)) square = within
      n = size(solutions, 2)
      ! angles far from any that a problem has
      weight = [(exp(cmplx(0.0_wp, 1.7_wp*real(k, wp)**2, wp)), k=1, size(weight))]
      allocate (sums(n), first(n))
      do i = 1, n
         sums(i) = sum(real(weight(:size(solutions, 1))*solutions(:, i)/(1.0_wp + abs(solutions(:, i))), wp))
         first(i) = i
      end do
      order = ascending(sums)
      do i = 2, n
         do k = i - 1, 1, -1
            if (sums(order(i)) - sums(order(k)) > window) exit
            if (.not. all(abs(solutions(:, order(i)) - solutions(:, order(k)))**2 <= &
                          square*(abs(solutions(:, order(i)))**2 + abs(solutions(:, order(k)))**2))) cycle
            first(order(i)) = min(first(order(k)), order(i))
            if (order(k) > first(order(i))) first(order(k)) = first(order(i))
         end do
      end do
   end function first_equal
end module psalm_six_bar_loops
