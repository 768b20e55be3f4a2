!> Motion of a sketch of any Assur groups and drives: positions by continuation from the drawing, and rates.
!>
!> A position is reached from the nearest one that is known, along a straight line of the inputs: a step is predicted by
!> velocity and acceleration and corrected by Newton's method. It is halved unless the first correction is small against the
!> prediction, the prediction itself is short and no group's determinant has changed its sign: without these, Newton's method jumps
!> to another assembly. Where steps become too small the linkage stands at a dead point, the end of its range, or a link runs to
!> infinity. With one input that end is found once for each side. With several inputs a straight way may meet a dead point that
!> another way goes round: a position that is not reached is tried from the drawing and from the positions known later, too.
!> Source: Allgower and Georg (1990), chapter 6, for the control of steps.
module psalm_chain_motion
   use psalm_closure, only: closure_t, state_t, matrix_of, most_orders, place_points, residuals, solve_group, rank_lost
   use psalm_dense, only: factors_t, factorise, solve
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: chain_motion_t, follow, nearest_known, differentiate, advance, try_step, senses
   public :: least_step, first_step, easy

   real(wp), parameter :: trusted = 0.15_wp        !! first correction against the prediction
   real(wp), parameter :: easy = 0.01_wp           !! below this the next step is doubled
   real(wp), parameter :: farthest = 0.3_wp        !! of the drawing's size, or of the distance gone, and radians: longer
                                                   !! predictions are not believed
   real(wp), parameter :: one_line = 1.0e-12_wp    !! deviation of inputs that change in proportion, of the largest
   real(wp), parameter :: least_step = 1.0e-9_wp   !! of the way
   real(wp), parameter :: first_step = 0.25_wp

   !> Where everything is at a row of positions.
   type :: chain_motion_t
      logical, allocatable :: closed(:)            !! shape (positions)
      type(state_t), allocatable :: states(:)      !! shape (positions); of one that does not close, where it stopped
      integer, allocatable :: group(:)             !! shape (positions): the group that stopped it; 0: none
      logical, allocatable :: dead(:)              !! shape (positions): rates are infinite
   end type chain_motion_t

contains

   !> Positions at all inputs, each with its rates.
   !>
   !> `rate(d, o)` is the derivative of order o of input d by the parameter that all rates are by. With `turn` inputs that differ
   !> by it are the same, and what is not reached one way may be reached the other way from the drawing.
   subroutine follow(closure, start, inputs, rate, motion, turn)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: start           !! at the drawing
      real(wp), intent(in) :: inputs(:, :)         !! shape (drives, positions): from the drawing, radians or length
      real(wp), intent(in) :: rate(:, :, :)        !! shape (drives, most_orders, positions)
      type(chain_motion_t), intent(out) :: motion
      real(wp), intent(in), optional :: turn(:)    !! shape (drives)
      type(state_t) :: back
      real(wp) :: ends(2)                          !! inputs of drive 1 at which the way ends, below and above the drawing
      integer :: k, best, stopped_by, side, stopped(2)
      logical :: reached, waiting(size(inputs, 2)), line

      associate (n => size(inputs, 2))
         allocate (motion%closed(n), motion%dead(n), source=.false.)
         allocate (motion%group(n), source=0)
         allocate (motion%states(n))
      end associate
      line = on_a_line(inputs)
      stopped = 0
      ends = 0.0_wp
      do k = 1, size(inputs, 2)
         side = merge(2, 1, inputs(1, k) > 0.0_wp)
         if (line .and. stopped(side) > 0) then
            if (abs(inputs(1, k)) >= abs(ends(side))) then
               motion%states(k) = motion%states(stopped(side))
               motion%group(k) = motion%group(stopped(side))
               cycle
            end if
         end if
         best = nearest_known(inputs, motion%closed, k)
         if (best == 0) then
            motion%states(k) = start
         else
            motion%states(k) = motion%states(best)
         end if
         call advance(closure, inputs(:, k), motion%states(k), motion%closed(k), motion%group(k))
         if (motion%closed(k)) cycle
         stopped(side) = k
         ends(side) = inputs(1, k)
         associate (at => motion%states(k)%input(1, 0))
            if (at*inputs(1, k) > 0.0_wp .and. abs(at) < abs(inputs(1, k))) ends(side) = at
         end associate
      end do
      if (.not. line) call try_other_ways(closure, start, inputs, motion)
      if (present(turn)) then
         do side = -1, 1, 2
            back = start
            waiting = .not. motion%closed .and. side*inputs(1, :) > 0.0_wp .and. side*inputs(1, :) < turn(1)
            do while (any(waiting))
               k = maxloc(side*inputs(1, :), dim=1, mask=waiting)
               waiting(k) = .false.
               call advance(closure, inputs(:, k) - side*turn, back, reached, stopped_by)
               if (.not. reached) exit
               motion%states(k) = back
               motion%closed(k) = .true.
               motion%group(k) = 0
            end do
         end do
      end if
      do k = 1, size(inputs, 2)
         if (.not. motion%closed(k)) cycle
         motion%states(k)%input(:, 1:) = rate(:, :, k)
         call differentiate(closure, most_orders, motion%states(k), motion%dead(k))
      end do
   end subroutine follow

   !> Try the positions that were not reached from the drawing, and from the nearest position of all that are known by now.
   subroutine try_other_ways(closure, start, inputs, motion)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: start
      real(wp), intent(in) :: inputs(:, :)         !! shape (drives, positions)
      type(chain_motion_t), intent(inout) :: motion
      type(state_t) :: state
      integer :: tried(size(inputs, 2)), k, best, group
      logical :: more, reached

      ! the position tried last; of those that began at the drawing there is nothing to be gained by beginning there again
      do k = 1, size(inputs, 2)
         tried(k) = 0
         if (.not. motion%closed(k)) tried(k) = nearest_known(inputs, motion%closed, k)
         if (motion%closed(k) .or. tried(k) == 0) cycle
         state = start
         call advance(closure, inputs(:, k), state, reached, group)
         if (.not. reached) cycle
         motion%states(k) = state
         motion%closed(k) = .true.
         motion%group(k) = 0
      end do
      more = any(motion%closed)
      do while (more)
         more = .false.
         do k = 1, size(inputs, 2)
            if (motion%closed(k)) cycle
            best = nearest_of_all(inputs, motion%closed, k)
            if (best == 0 .or. best == tried(k)) cycle
            tried(k) = best
            state = motion%states(best)
            call advance(closure, inputs(:, k), state, reached, group)
            if (.not. reached) cycle
            motion%states(k) = state
            motion%closed(k) = .true.
            motion%group(k) = 0
            more = .true.
         end do
      end do
   end subroutine try_other_ways

   !> True if all inputs change in proportion, as those of one drive and its gears do: all positions then lie on one way.
   pure logical function on_a_line(inputs)
      real(wp), intent(in) :: inputs(:, :)         !! shape (drives, positions)
      integer :: k, most

      on_a_line = .true.
      if (size(inputs, 1) == 1) return
      most = maxloc(abs(inputs(1, :)), dim=1)
      on_a_line = abs(inputs(1, most)) > 0.0_wp
      if (.not. on_a_line) return
      do k = 1, size(inputs, 2)
         on_a_line = on_a_line .and. all(abs(inputs(:, k) - inputs(1, k)/inputs(1, most)*inputs(:, most)) &
                                         <= one_line*maxval(abs(inputs(:, most))))
      end do
   end function on_a_line

   !> The nearest of all positions that close, the first of equals; 0: none does.
   pure integer function nearest_of_all(inputs, closed, position) result(best)
      real(wp), intent(in) :: inputs(:, :)         !! shape (drives, positions): from the drawing
      logical, intent(in) :: closed(:)             !! shape (positions)
      integer, intent(in) :: position

      best = nearest_of(inputs, closed, position, 1, size(closed), 1, huge(1.0_wp))
   end function nearest_of_all

   !> Of the positions before one that close the nearest, the latest of equals; 0: the drawing is nearer.
   pure integer function nearest_known(inputs, closed, position) result(best)
      real(wp), intent(in) :: inputs(:, :)         !! shape (drives, positions): from the drawing
      logical, intent(in) :: closed(:)             !! shape (positions)
      integer, intent(in) :: position

      best = nearest_of(inputs, closed, position, position - 1, 1, -1, sum(inputs(:, position)**2))
   end function nearest_known

   !> Of the positions `first` to `last` that close the nearest, the first met of equals; 0: none is nearer than `limit`, squared.
   pure integer function nearest_of(inputs, closed, position, first, last, step, limit) result(best)
      real(wp), intent(in) :: inputs(:, :)         !! shape (drives, positions): from the drawing
      logical, intent(in) :: closed(:)             !! shape (positions)
      integer, intent(in) :: position, first, last, step
      real(wp), intent(in) :: limit
      real(wp) :: distance, nearest
      integer :: i

      best = 0
      nearest = limit
      do i = first, last, step
         if (.not. closed(i)) cycle
         distance = sum((inputs(:, position) - inputs(:, i))**2)
         if (distance >= nearest) cycle
         best = i
         nearest = distance
      end do
   end function nearest_of

   !> From a position to another; `group` tells which one stopped it.
   subroutine advance(closure, target, state, reached, group)
      type(closure_t), intent(in) :: closure
      real(wp), intent(in) :: target(:)            !! shape (drives)
      type(state_t), intent(inout) :: state
      logical, intent(out) :: reached
      integer, intent(out) :: group
      type(state_t) :: next
      real(wp) :: from(size(target)), way, step, worst
      real(wp) :: sense(size(closure%groups)), sense_next(size(closure%groups))
      logical :: dead, valid

      group = 0
      reached = .false.
      from = state%input(:, 0)
      way = 0.0_wp
      step = first_step
      call senses(closure, state, sense)
      do while (way < 1.0_wp)
         state%input(:, 1) = target - from
         state%input(:, 2:) = 0.0_wp
         call differentiate(closure, 2, state, dead)
         if (dead) then
            group = maxval(closure%order%of_link)
            return
         end if
         step = min(step, 1.0_wp - way)
         do
            next = state
            call try_step(closure, from, target, way, step, next, sense, sense_next, worst, valid, group)
            if (valid) exit
            step = 0.5_wp*step
            if (step < least_step) return
         end do
         group = 0
         state = next
         sense = sense_next
         way = way + step
         if (way > 1.0_wp - 0.5_wp*least_step) way = 1.0_wp
         if (worst < easy) step = 2.0_wp*step
      end do
      state%input(:, 0) = target
      call place_points(closure, state, 0)
      reached = .true.
   end subroutine advance

   !> One step, group after group.
   subroutine try_step(closure, from, target, way, step, next, sense, sense_next, worst, valid, group)
      type(closure_t), intent(in) :: closure
      real(wp), intent(in) :: from(:), target(:), way, step
      type(state_t), intent(inout) :: next
      real(wp), intent(in) :: sense(:)
      real(wp), intent(out) :: sense_next(:)
      real(wp), intent(out) :: worst               !! largest ratio of the first correction to the prediction
      logical, intent(out) :: valid
      integer, intent(out) :: group
      type(factors_t) :: factors
      real(wp) :: predicted, moved, turned, reach, first
      integer :: k

      worst = 0.0_wp
      sense_next = sense
      valid = .true.
      if (way + step >= 1.0_wp) then
         next%input(:, 0) = target
      else
         next%input(:, 0) = from + (way + step)*(target - from)
      end if
      do group = 1, size(closure%groups)
         associate (links => closure%groups(group)%links)
            if (size(links) == 0) cycle
            moved = 0.0_wp
            turned = 0.0_wp
            reach = closure%size
            do k = 1, size(links)
               associate (t => next%t(links(k), :), phi => next%phi(links(k), :))
                  ! towards infinity a link moves by a part of the way that it has gone
                  reach = max(reach, abs(t(1)))
                  moved = max(moved, abs(t(2))*step + 0.5_wp*abs(t(3))*step**2)
                  turned = max(turned, closure%size*(abs(phi(2))*step + 0.5_wp*abs(phi(3))*step**2))
                  next%t(links(k), 0) = t(1) + step*t(2) + 0.5_wp*step**2*t(3)
                  next%phi(links(k), 0) = phi(1) + step*phi(2) + 0.5_wp*step**2*phi(3)
               end associate
            end do
            predicted = max(moved, turned)
            call solve_group(closure, group, next, valid, factors, first)
            if (.not. valid) return
            sense_next(group) = factors%sense
            valid = factors%reciprocal_condition > rank_lost
            if (size(factors%q, 1) == size(factors%q, 2)) valid = valid .and. factors%sense == sense(group)
            first = first/max(predicted, 1.0e-7_wp*closure%size)
            worst = max(worst, first)
            valid = valid .and. first < trusted .and. moved < farthest*reach .and. turned < farthest*closure%size
            if (.not. valid) return
         end associate
      end do
      group = 0
   end subroutine try_step

   !> Sign of every group's determinant.
   subroutine senses(closure, state, sense)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      real(wp), intent(out) :: sense(:)
      type(factors_t) :: factors
      integer :: g

      sense = 1.0_wp
      do g = 1, size(closure%groups)
         if (size(closure%groups(g)%links) == 0) cycle
         call factorise(matrix_of(closure, state, g), factors)
         sense(g) = factors%sense
      end do
   end subroutine senses

   !> Derivatives of all poses and joints up to an order, from those of the inputs. `dead` where a group has none.
   subroutine differentiate(closure, orders, state, dead)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: orders
      type(state_t), intent(inout) :: state
      logical, intent(out) :: dead
      type(factors_t) :: factors
      real(wp), allocatable :: rates(:)
      integer :: g, order, k

      dead = .false.
      state%t(:, 1:) = (0.0_wp, 0.0_wp)
      state%phi(:, 1:) = 0.0_wp
      do g = 1, size(closure%groups)
         associate (links => closure%groups(g)%links)
            if (size(links) == 0) cycle
            call factorise(matrix_of(closure, state, g), factors)
            dead = factors%reciprocal_condition < rank_lost
            if (dead) return
            do order = 1, orders
               rates = solve(factors, -residuals(closure, state, g, order))
               do k = 1, size(links)
                  state%t(links(k), order) = cmplx(rates(3*k - 2), rates(3*k - 1), wp)
                  state%phi(links(k), order) = rates(3*k)/closure%size
               end do
            end do
         end associate
      end do
      do order = 1, orders
         call place_points(closure, state, order)
      end do
   end subroutine differentiate
end module psalm_chain_motion
