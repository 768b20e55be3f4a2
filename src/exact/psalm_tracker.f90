!> Solutions of polynomial equations followed along a path of problems, several side by side.
!>
!> Predictor: Hermite extrapolation through the last three points and tangents. Corrector: two steps of Newton's method, the
!> second of which gives the tangent too. Errors are relative, number by number. Every lane takes the next solution when it is
!> done with one. Source: Allgower and Georg (1990), chapters 2 and 6; Morgan and Sommese (1989) for paths of parameters.
module psalm_tracker
   use psalm_kinds, only: wp
   use psalm_leg_lanes, only: lanes, linearise, problem_path_t, set_given, solve_lanes, state_size, work_t
   use psalm_leg_problem, only: most_points, turns_of, variables
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: tracked_t, track, polish

   integer, parameter :: of_item = 32                !! paths that are followed together where the work is shared
   integer, parameter :: remembered = 3              !! points that the predictor goes through
   integer, parameter :: most_steps = 4000          !! of a path
   real(wp), parameter :: first_step = 0.02_wp, least_step = 1.0e-12_wp
   real(wp), parameter :: usual_prediction = 1.0e-3_wp !! largest error of a prediction that is accepted
   real(wp), parameter :: aim = 0.1_wp               !! error aimed at, over the one accepted
   real(wp), parameter :: converged = 1.0e-5_wp      !! largest second correction
   real(wp), parameter :: good_already = 1.0e-4_wp   !! both corrections of a prediction that is accepted as it is
   real(wp), parameter :: contraction = 0.1_wp, slack = 1.0e-10_wp !! of the second correction against the first
   real(wp), parameter :: caution = 0.9_wp, shortest = 0.3_wp, longest = 2.0_wp, after_refusal = 0.35_wp
   real(wp), parameter :: far_away = 1.0e12_wp       !! a number of a path that is given up
   real(wp), parameter :: loose_start = 1.0e-2_wp    !! first correction of a start
   real(wp), parameter :: still_far = 1.0e-3_wp      !! the t above which rounding cannot have spoilt a place
   integer, parameter :: most_polish = 8
   real(wp), parameter :: settled = 1.0e-14_wp       !! relative correction that is rounding

   !> How solutions ended.
   type :: tracked_t
      complex(wp), allocatable :: ends(:, :)         !! shape (variables, count); of one that did not arrive its last valid place
      real(wp), allocatable :: reached(:)            !! shape (count): the t of that
      logical, allocatable :: arrived(:)             !! shape (count)
      real(wp), allocatable :: left(:)               !! shape (count): last relative correction of those that arrived
      complex(wp), allocatable :: last_place(:, :)   !! shape (variables, count): last place on the way far from the end
      real(wp), allocatable :: last_t(:)             !! shape (count): the t of that
      logical, allocatable :: singular(:)            !! shape (count): the end is finite, the equations are singular there
                                                     !! (psalm_careful_tracking); such a path has not arrived
      integer, allocatable :: winding(:)             !! shape (count): of those, turns of t about 0 that close the path
      logical :: sure = .false.                      !! every end was reached by a path that did not jump
      logical :: stopped = .false.                   !! the host wanted the end, or the time was up, before all paths were followed
      integer :: followed = 0                        !! paths that were followed as far as they lead
      integer :: steps = 0                           !! of all paths
      integer :: precise = 0                         !! paths followed in quadruple precision (psalm_careful_tracking)
      integer :: infinite = 0                        !! of these those that end at infinity
   end type tracked_t

contains

   !> Follow solutions of the problem at t = 1 to that at t = 0. Paths that a stop cuts off have not arrived. Where the work is
   !> shared others follow some of them.
   subroutine track(path, starts, tracked, largest_prediction, stop)
      type(problem_path_t), intent(in) :: path
      complex(wp), intent(in) :: starts(:, :)        !! shape (variables, count)
      type(tracked_t), intent(out) :: tracked
      real(wp), intent(in), optional :: largest_prediction !! error accepted; smaller is safer and slower
      type(stop_t), intent(in), optional :: stop     !! asked, and informed of the paths followed, before every step of the lanes
      type(tracked_t) :: some
      real(wp), allocatable :: numbers(:)
      integer :: item, items, count
      logical :: shared

      count = size(starts, 2)
      shared = .false.
      if (present(stop)) shared = stop%is_shared() .and. count > of_item
      if (.not. shared) then
         call follow(path, starts, tracked, largest_prediction, stop, 0, count)
         return
      end if
      call begin_paths(starts, tracked)
      items = (count - 1)/of_item + 1
      call stop%open_batch('paths', items)
      item = 0
      do
         item = stop%next_item(item, 1, items)
         if (item > items) exit
         call follow(path, starts(:, first_of(item):last_of(item)), some, largest_prediction, stop, first_of(item) - 1, count)
         if (some%stopped) exit
         call stop%keep_item(item, [real(some%ends, wp), aimag(some%ends), real(some%last_place, wp), aimag(some%last_place), &
                                    some%reached, some%left, some%last_t, merge(1.0_wp, 0.0_wp, some%arrived), &
                                    real([some%steps, some%followed], wp)])
      end do
      call stop%close_batch()
      do item = 1, items
         call stop%take_item(item, numbers)
         if (allocated(numbers)) then
            call take_paths(numbers, first_of(item), last_of(item))
         else
            tracked%stopped = .true.
         end if
      end do

   contains

      pure integer function first_of(item)
         integer, intent(in) :: item

         first_of = (item - 1)*of_item + 1
      end function first_of

      pure integer function last_of(item)
         integer, intent(in) :: item

         last_of = min(item*of_item, count)
      end function last_of

      !> The paths of an item.
      subroutine take_paths(numbers, first, last)
         real(wp), intent(in) :: numbers(:)
         integer, intent(in) :: first, last
         integer :: n, m

         n = last - first + 1
         m = n*variables
         tracked%ends(:, first:last) = reshape(cmplx(numbers(:m), numbers(m + 1:2*m), wp), [variables, n])
         tracked%last_place(:, first:last) = reshape(cmplx(numbers(2*m + 1:3*m), numbers(3*m + 1:4*m), wp), [variables, n])
         m = 4*m
         tracked%reached(first:last) = numbers(m + 1:m + n)
         tracked%left(first:last) = numbers(m + n + 1:m + 2*n)
         tracked%last_t(first:last) = numbers(m + 2*n + 1:m + 3*n)
         tracked%arrived(first:last) = numbers(m + 3*n + 1:m + 4*n) > 0.0_wp
         tracked%steps = tracked%steps + nint(numbers(m + 4*n + 1))
         tracked%followed = tracked%followed + nint(numbers(m + 4*n + 2))
      end subroutine take_paths
   end subroutine track

   !> No path is followed yet.
   pure subroutine begin_paths(starts, tracked)
      complex(wp), intent(in) :: starts(:, :)        !! shape (variables, count)
      type(tracked_t), intent(out) :: tracked

      tracked%ends = starts
      tracked%last_place = starts
      allocate (tracked%arrived(size(starts, 2)), tracked%singular(size(starts, 2)), source=.false.)
      allocate (tracked%reached(size(starts, 2)), tracked%last_t(size(starts, 2)), source=1.0_wp)
      allocate (tracked%left(size(starts, 2)), source=0.0_wp)
      allocate (tracked%winding(size(starts, 2)), source=1)
   end subroutine begin_paths

   !> Follow paths here.
   subroutine follow(path, starts, tracked, largest_prediction, stop, before, of)
      type(problem_path_t), intent(in) :: path
      complex(wp), intent(in) :: starts(:, :)        !! shape (variables, count)
      type(tracked_t), intent(out) :: tracked
      real(wp), intent(in), optional :: largest_prediction !! error accepted; smaller is safer and slower
      type(stop_t), intent(in), optional :: stop     !! asked, and informed of the paths followed, before every step of the lanes
      integer, intent(in) :: before, of              !! paths before these, and of all, for whoever is informed
      type(work_t), allocatable :: work
      complex(wp), allocatable :: past(:, :, :), past_tangent(:, :, :), z(:, :), step(:, :), tangent(:, :)
      real(wp) :: past_t(lanes, remembered), t(lanes), h(lanes), aimed(lanes), e1(lanes), e2(lanes), accept_below
      real(wp) :: weight(lanes, remembered), slope_weight(lanes, remembered), factor
      integer :: which(lanes), known(lanes), taken(lanes), next, l, k, i, used
      complex(wp), allocatable :: polished(:, :)
      real(wp), allocatable :: left(:)
      integer, allocatable :: which_arrived(:)
      logical :: accepted

      call begin_paths(starts, tracked)
      if (size(starts, 2) == 0) return
      allocate (work)
      allocate (past(lanes, state_size, remembered), past_tangent(lanes, state_size, remembered), z(lanes, state_size), &
                step(lanes, state_size), tangent(lanes, state_size), source=(0.0_wp, 0.0_wp))
      accept_below = usual_prediction
      if (present(largest_prediction)) accept_below = largest_prediction
      next = 1
      past_t = 1.0_wp
      used = variables + most_points + path%problem%points
      do l = 1, lanes
         call take_next(l)
      end do
      do while (any(which > 0))
         if (present(stop)) then
            tracked%stopped = stop%waiting()
            if (tracked%stopped) exit
            call stop%tell(before + next - 1 - count(which > 0), of)
         end if
         call predict_weights(past_t, t, h, known, aimed, weight, slope_weight)
         z(:, :used) = (0.0_wp, 0.0_wp)
         do k = 1, remembered
            do i = 1, used
               do l = 1, lanes
                  z(l, i) = z(l, i) + weight(l, k)*past(l, i, k) + slope_weight(l, k)*past_tangent(l, i, k)
               end do
            end do
         end do
         call set_given(path, aimed, z)
         call linearise(path, aimed, z, work)
         call solve_lanes(path, aimed, z, work, .false., step, tangent, e1)
         z(:, :used) = z(:, :used) + step(:, :used)
         call linearise(path, aimed, z, work)
         call solve_lanes(path, aimed, z, work, .true., step, tangent, e2)
         z(:, :used) = z(:, :used) + step(:, :used)
         do l = 1, lanes
            if (which(l) == 0) cycle
            taken(l) = taken(l) + 1
            tracked%steps = tracked%steps + 1
            if (known(l) == 0) then
               accepted = e1(l) < loose_start .and. e2(l) < sqrt(converged)
            else
               ! a prediction that is good already needs no correction that shrinks: near infinity rounding does not let it
               accepted = e1(l) < accept_below .and. ((e2(l) < converged .and. e2(l) < contraction*e1(l) + slack) .or. &
                                                      max(e1(l), e2(l)) < good_already)
            end if
            if (accepted) then
               if (maxval(abs(z(l, :variables))) > far_away) then
                  call take_next(l)
                  cycle
               end if
               t(l) = aimed(l)
               tracked%ends(:, which(l)) = z(l, :variables)
               tracked%reached(which(l)) = t(l)
               if (.not. t(l) > 0.0_wp) then
                  tracked%arrived(which(l)) = .true.
                  call take_next(l)
                  cycle
               end if
               if (t(l) > still_far) then
                  tracked%last_place(:, which(l)) = z(l, :variables)
                  tracked%last_t(which(l)) = t(l)
               end if
               if (known(l) > 0) then
                  factor = caution*(aim*accept_below/max(e1(l), tiny(1.0_wp)))**(1.0_wp/6.0_wp)
                  h(l) = h(l)*min(max(factor, shortest), longest)
               else
                  h(l) = first_step
               end if
               past(l, :, 2:) = past(l, :, :remembered - 1)
               past_tangent(l, :, 2:) = past_tangent(l, :, :remembered - 1)
               past_t(l, 2:) = past_t(l, :remembered - 1)
               past(l, :, 1) = z(l, :)
               past_tangent(l, :, 1) = tangent(l, :)
               past_t(l, 1) = t(l)
               known(l) = min(known(l) + 1, remembered)
               if (h(l) < least_step) call take_next(l)
            else if (known(l) == 0) then
               call take_next(l)
            else
               h(l) = h(l)*after_refusal
               if (h(l) < least_step .or. taken(l) > most_steps) call take_next(l)
            end if
         end do
      end do
      tracked%followed = next - 1 - count(which > 0)
      ! what two solutions have in common must not depend on how they came here
      which_arrived = pack([(i, i=1, size(starts, 2))], tracked%arrived)
      polished = tracked%ends(:, which_arrived)
      allocate (left(size(which_arrived)))
      call polish(path, polished, left)
      tracked%ends(:, which_arrived) = polished
      tracked%left(which_arrived) = left

   contains

      !> Give a lane the next solution, or none.
      subroutine take_next(l)
         integer, intent(in) :: l
         complex(wp) :: g(most_points), gh(most_points)

         which(l) = 0
         known(l) = 0
         taken(l) = 0
         t(l) = 1.0_wp
         h(l) = 0.0_wp
         past_t(l, :) = 1.0_wp
         if (next > size(starts, 2)) then
            ! an idle lane goes on with what it has: finite numbers
            past(l, :, 1) = (1.0_wp, 0.0_wp)
            return
         end if
         which(l) = next
         next = next + 1
         g = (0.0_wp, 0.0_wp)
         gh = (0.0_wp, 0.0_wp)
         call turns_of(path%problem, path%from, starts(:, which(l)), g(:path%problem%points), gh(:path%problem%points))
         past(l, :variables, 1) = starts(:, which(l))
         past(l, variables + 1:variables + most_points, 1) = g
         past(l, variables + most_points + 1:, 1) = gh
      end subroutine take_next
   end subroutine follow

   !> Weights of past points and tangents in the prediction, for each lane by what it remembers.
   pure subroutine predict_weights(past_t, t, h, known, aimed, weight, slope_weight)
      real(wp), intent(in) :: past_t(lanes, remembered), t(lanes), h(lanes)
      integer, intent(in) :: known(lanes)
      real(wp), intent(out) :: aimed(lanes), weight(lanes, remembered), slope_weight(lanes, remembered)
      real(wp) :: basis, slope
      integer :: l, k, m

      weight = 0.0_wp
      slope_weight = 0.0_wp
      do l = 1, lanes
         aimed(l) = max(t(l) - h(l), 0.0_wp)
         ! what would be left is no step of its own
         if (aimed(l) < 0.01_wp*h(l)) aimed(l) = 0.0_wp
         if (known(l) == 0) then
            weight(l, 1) = 1.0_wp
            cycle
         end if
         do k = 1, known(l)
            basis = 1.0_wp
            slope = 0.0_wp
            do m = 1, known(l)
               if (m == k) cycle
               basis = basis*(aimed(l) - past_t(l, m))/(past_t(l, k) - past_t(l, m))
               slope = slope + 1.0_wp/(past_t(l, k) - past_t(l, m))
            end do
            weight(l, k) = (1.0_wp - 2.0_wp*(aimed(l) - past_t(l, k))*slope)*basis**2
            slope_weight(l, k) = (aimed(l) - past_t(l, k))*basis**2
         end do
      end do
   end subroutine predict_weights

   !> Newton's method on solutions of the problem at t = 0, until the corrections are of the size of rounding; `left` is the last
   !> relative correction.
   subroutine polish(path, solutions, left)
      type(problem_path_t), intent(in) :: path
      complex(wp), intent(inout) :: solutions(:, :)  !! shape (variables, count)
      real(wp), intent(out) :: left(:)               !! shape (count)
      type(work_t), allocatable :: work
      complex(wp), allocatable :: z(:, :), step(:, :), tangent(:, :)
      complex(wp) :: g(most_points), gh(most_points)
      real(wp) :: t(lanes), e(lanes), before(lanes)
      integer :: first, l, k, m

      allocate (work)
      allocate (z(lanes, state_size), step(lanes, state_size), tangent(lanes, state_size), source=(0.0_wp, 0.0_wp))
      t = 0.0_wp
      do first = 1, size(solutions, 2), lanes
         m = min(lanes, size(solutions, 2) - first + 1)
         do l = 1, lanes
            g = (0.0_wp, 0.0_wp)
            gh = (0.0_wp, 0.0_wp)
            associate (own => solutions(:, first + min(l, m) - 1))
               call turns_of(path%problem, path%to, own, g(:path%problem%points), gh(:path%problem%points))
               z(l, :variables) = own
            end associate
            z(l, variables + 1:variables + most_points) = g
            z(l, variables + most_points + 1:) = gh
         end do
         call set_given(path, t, z)
         before = huge(1.0_wp)
         do k = 1, most_polish
            call linearise(path, t, z, work)
            call solve_lanes(path, t, z, work, .false., step, tangent, e)
            do l = 1, lanes
               if (.not. (k <= 2 .or. e(l) < 0.5_wp*before(l))) cycle
               z(l, :) = z(l, :) + step(l, :)
               before(l) = e(l)
            end do
            if (all(before < settled)) exit
         end do
         solutions(:, first:first + m - 1) = transpose(z(:m, :variables))
         left(first:first + m - 1) = before(:m)
      end do
   end subroutine polish
end module psalm_tracker
