!> Motion from torque: the steady cycle and the run-up of a machine that a crank drives.
!>
!> Reduced to the crank the machine has an inertia J(phi), which varies, and a torque Q(phi, w). Eksergian's equation
!> J w dw/dphi + J' w**2/2 = Q is solved for the energy E = J w**2/2, of which dE/dphi = Q: no derivative of J is needed.
!> Integration is over the angle, by an L-stable method: with little inertia and a motor whose torque falls steeply the equation is
!> stiff. In the first turn phi = s**2 takes the root out of a speed that begins at rest, and gives short steps to a speed that
!> changes fast. The same with twice the step estimates the error. J and what weight, loads and springs do are found from the
!> forces at unit speed, in closed form at every node. Friction of joints (&FRICTN) is no part of this.
!>
!> The host is asked before each turn and each block of nodes; what it ends is of no use.
module psalm_machine
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t
   use psalm_kinds, only: wp, pi, degrees_per_radian, full_turn
   use psalm_linear, only: solve_three
   use psalm_motor_group, only: motor_group_t
   use psalm_reduced, only: reduced_t, reduce_machine
   use psalm_stop, only: stop_t, is_to_end, tell_host
   implicit none (type, external)
   private
   public :: machine_t, cycle_t, machine_run_t, make_machine, settle_machine, steady_cycle, run_up, flywheel_for, motor_torque
   public :: cycle_found, cycle_grows, cycle_falls, cycle_stalls, cycle_any_speed, cycle_unknown

   integer, parameter :: least_steps = 1440          !! of integration over a turn: an even multiple of what is listed
   integer, parameter :: most_steps = 8*least_steps  !! finer than this no turn is divided
   real(wp), parameter :: wanted_error = 1.0e-8_wp   !! relative error of speeds: steps are halved until it is met
   real(wp), parameter :: worst_error = 1.0e-4_wp    !! with a greater one nothing is reported
   integer, parameter :: most_iterations = 200       !! of a root
   integer, parameter :: most_newton = 60            !! iterations in a step
   integer, parameter :: most_turns = 2000           !! that are run through to show that a machine stops
   real(wp), parameter :: settled = 1.0e-13_wp       !! relative change at which a root is found
   real(wp), parameter :: no_work = 1.0e-9_wp        !! relative work over a turn that counts as none
   real(wp), parameter :: never = huge(1.0_wp)       !! error of what could not be computed

   integer, parameter :: cycle_found = 0     !! speed and torque are in balance
   integer, parameter :: cycle_grows = 1     !! the torque does not fall with the speed: it grows with every turn
   integer, parameter :: cycle_falls = 2     !! or falls with every turn
   integer, parameter :: cycle_stalls = 3    !! the machine stops within the turn, from whatever speed
   integer, parameter :: cycle_any_speed = 4 !! no work over a turn at any speed: the given speed at the beginning was taken
   integer, parameter :: cycle_unknown = 5   !! could not be computed

   ! how a turn ends
   integer, parameter :: turn_done = 0       !! at a speed
   integer, parameter :: turn_stalled = 1    !! at rest: the energy is spent where the torque at rest is below the load
   integer, parameter :: turn_failed = 2     !! the equations of a step could not be solved

   ! Lobatto IIIC with three stages: order 4, L-stable, so that a light machine with a strong motor (stiff) is solved as well as
   ! a heavy one; stages at the ends and in the middle of a step (Hairer and Wanner, Solving ODE II, table IV.5.5)
   real(wp), parameter :: stages(3, 3) = reshape([1.0_wp/6.0_wp, 1.0_wp/6.0_wp, 1.0_wp/6.0_wp, &
                                                  -1.0_wp/3.0_wp, 5.0_wp/12.0_wp, 2.0_wp/3.0_wp, &
                                                  1.0_wp/6.0_wp, -1.0_wp/12.0_wp, 1.0_wp/6.0_wp], [3, 3])

   !> A machine: the mechanism at the nodes of one turn, its motor, its flywheel.
   type :: machine_t
      integer :: steps = least_steps         !! of a turn; a multiple of 4
      type(reduced_t) :: turn                !! at 2 `steps` + 1 nodes, from CRNKI on
      type(motor_group_t) :: motor
      real(wp) :: flywheel = 0.0_wp          !! kg m2
   end type machine_t

   !> One turn at steady running.
   type :: cycle_t
      integer :: state = cycle_found
      real(wp), allocatable :: speed(:)      !! shape (0:steps): rad/s, from CRNKI on
      real(wp) :: period = 0.0_wp            !! s
      real(wp) :: mean = 0.0_wp              !! rad/s: a turn over the period
      real(wp) :: least = 0.0_wp, least_at = 0.0_wp       !! rad/s; degrees from CRNKI
      real(wp) :: greatest = 0.0_wp, greatest_at = 0.0_wp
      real(wp) :: stopped_at = 0.0_wp        !! degrees from CRNKI: where it stalls
      real(wp) :: error = 0.0_wp             !! estimated, of the speeds and the period, relative to the greatest speed
   end type cycle_t

   !> Turns of a run-up.
   type :: machine_run_t
      real(wp), allocatable :: time(:)       !! shape (turns): s, at the end of each
      real(wp), allocatable :: speed(:)      !! shape (turns): rad/s there
      real(wp), allocatable :: least(:), greatest(:) !! shape (turns): within it
      real(wp) :: stopped_at = -1.0_wp       !! degrees from CRNKI: it stalls there; negative: it does not
      logical :: computed = .true.           !! false: the turn after those listed could not be computed
      real(wp) :: error = 0.0_wp             !! estimated, relative, of times and speeds
   end type machine_run_t

contains

   !> The machine over one turn of its crank, at `steps` steps (a multiple of 4; without it the least there are).
   subroutine make_machine(problem, model, motor, machine, steps, stop)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      type(motor_group_t), intent(in) :: motor
      type(machine_t), intent(out) :: machine
      integer, intent(in), optional :: steps
      type(stop_t), intent(in), optional :: stop
      integer :: k

      if (present(steps)) machine%steps = steps
      machine%motor = motor
      machine%flywheel = motor%flywheel
      call reduce_machine(problem, model, [(full_turn*real(k, wp)/real(2*machine%steps, wp), k=0, 2*machine%steps)], machine%turn, &
                          stop)
   end subroutine make_machine

   !> The machine and its steady cycle, with steps so short that the error is small. `machine` has an inertia and no dead point at
   !> its own steps; with more of them one may be found: `machine%turn%failure`.
   subroutine settle_machine(problem, model, given, machine, cycle, stop)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: given             !! rad/s at CRNKI, where any speed would do
      type(machine_t), intent(inout) :: machine
      type(cycle_t), intent(out) :: cycle
      type(stop_t), intent(in), optional :: stop
      type(motor_group_t) :: motor

      motor = machine%motor
      do
         call steady_cycle(machine, given, cycle, stop)
         if (is_to_end(stop)) return
         if (cycle%error <= wanted_error .or. machine%steps >= most_steps) exit
         call make_machine(problem, model, motor, machine, 2*machine%steps, stop)
         if (machine%turn%failure > 0) return
      end do
      if (cycle%error > worst_error) cycle%state = cycle_unknown
   end subroutine settle_machine

   !> Torque of the motor at a speed and its derivative: the table, or the line, or a constant.
   pure subroutine motor_torque(motor, speed, torque, slope)
      type(motor_group_t), intent(in) :: motor
      real(wp), intent(in) :: speed
      real(wp), intent(out) :: torque, slope
      integer :: k

      slope = 0.0_wp
      associate (rows => size(motor%speed))
         if (rows > 0) then
            k = count(motor%speed <= speed)
            if (k == 0) then
               torque = motor%table(1)
            else if (k == rows) then
               torque = motor%table(rows)
            else
               slope = (motor%table(k + 1) - motor%table(k))/(motor%speed(k + 1) - motor%speed(k))
               torque = motor%table(k) + slope*(speed - motor%speed(k))
            end if
         else
            torque = motor%torque
            if (motor%idle > 0.0_wp) then
               torque = motor%torque*(1.0_wp - speed/motor%idle)
               slope = -motor%torque/motor%idle
            end if
         end if
      end associate
   end subroutine motor_torque

   ! ---- integration -------------------------------------------------------------------------------------------------

   !> Speed through the nodes of `table`, 2 `stride` nodes a step, by Lobatto IIIC for the energy; the time by Simpson's rule.
   !> `stretch` is d(phi)/d(variable) at the nodes. `ended` is one of turn_..., `last` the last step.
   pure subroutine integrate(machine, table, stride, stretch, width, start, speed, time, ended, last)
      type(machine_t), intent(in) :: machine
      type(reduced_t), intent(in) :: table
      integer, intent(in) :: stride                    !! 1, or 2 for steps twice as long
      real(wp), intent(in) :: stretch(0:)              !! shape (0:2*steps*stride)
      real(wp), intent(in) :: width                    !! of a step, in the variable
      real(wp), intent(in) :: start                    !! speed at the first node
      real(wp), intent(out) :: speed(0:)               !! shape (0:steps), an even number of steps
      real(wp), intent(out) :: time
      integer, intent(out) :: ended, last
      real(wp) :: inertia(3), w(3), torque, unused
      real(wp), allocatable :: slowness(:)    ! large: it would fill a small stack
      integer :: nodes(3), k
      logical :: solved

      allocate (slowness(0:ubound(speed, 1)))
      speed = 0.0_wp
      speed(0) = start
      time = 0.0_wp
      last = 1
      ended = turn_stalled
      w = start
      if (start > 0.0_wp) then
         slowness(0) = stretch(0)/start
      else
         ! from rest, phi = s**2: the speed is s sqrt(2 Q/J) to first order
         call motor_torque(machine%motor, 0.0_wp, torque, unused)
         torque = torque + table%torque(1)
         if (.not. torque > 0.0_wp) return
         slowness(0) = 2.0_wp/sqrt(2.0_wp*torque/(table%inertia(1) + machine%flywheel))
         w = [0.0_wp, 0.5_wp*width, width]*2.0_wp/slowness(0)
      end if
      do k = 1, ubound(speed, 1)
         last = k
         nodes = stride*[2*k - 2, 2*k - 1, 2*k] + 1
         inertia = table%inertia(nodes) + machine%flywheel
         call solve_step(machine%motor, inertia, table%torque(nodes), table%damping(nodes), stretch(nodes - 1), width, &
                         0.5_wp*inertia(1)*speed(k - 1)**2, w, solved)
         ended = turn_failed
         if (.not. solved) return
         ended = turn_stalled
         if (.not. minval(w(2:)) > 0.0_wp) then
            call motor_torque(machine%motor, 0.0_wp, torque, unused)
            if (torque + minval(table%torque(nodes)) >= 0.0_wp) ended = turn_failed
            return
         end if
         speed(k) = w(3)
         slowness(k) = stretch(nodes(3) - 1)/w(3)
         w = w(3)
      end do
      ended = turn_done
      associate (n => ubound(speed, 1))
         time = width/3.0_wp*(slowness(0) + slowness(n) + 4.0_wp*sum(slowness(1:n - 1:2)) + 2.0_wp*sum(slowness(2:n - 2:2)))
      end associate
   end subroutine integrate

   !> The speeds at the three stages of a step, by Newton's method with steps that lessen the residual. A negative speed stands for
   !> an energy below 0.
   pure subroutine solve_step(motor, inertia, load, damping, stretch, width, energy, w, solved)
      type(motor_group_t), intent(in) :: motor
      real(wp), dimension(3), intent(in) :: inertia, load, damping, stretch
      real(wp), intent(in) :: width, energy            !! of the step; J at its beginning
      real(wp), intent(inout) :: w(3)                  !! a guess, and the speeds
      logical, intent(out) :: solved
      real(wp), parameter :: rounding = 8.0_wp*epsilon(1.0_wp), least_part = 2.0_wp**(-20)
      real(wp) :: residual(3), slope(3), matrix(3, 3), change(3), tried(3), tried_residual(3), tried_slope(3), scale, part
      integer :: k, i
      logical :: regular

      call residual_at(w, residual, slope, scale)
      do k = 1, most_newton
         solved = maxval(abs(residual)) <= rounding*scale
         if (solved) return
         matrix = -width*stages*spread(slope, 1, 3)
         do i = 1, 3
            matrix(i, i) = matrix(i, i) + inertia(i)*abs(w(i))
         end do
         ! at rest the first stage has no part in the others
         if (stretch(1) <= 0.0_wp .and. energy <= 0.0_wp) then
            matrix(1, :) = [1.0_wp, 0.0_wp, 0.0_wp]
            residual(1) = 0.0_wp
         end if
         call solve_three(matrix, -residual, change, regular)
         if (.not. regular) return
         part = 1.0_wp
         do
            tried = w + part*change
            call residual_at(tried, tried_residual, tried_slope, scale)
            if (norm2(tried_residual) < norm2(residual)) exit
            part = 0.5_wp*part
            if (part < least_part) exit
         end do
         if (part < least_part) then
            ! no better: rounding is all that is left, or the method has failed
            solved = maxval(abs(change)) <= settled*maxval(abs(w))
            return
         end if
         w = tried
         residual = tried_residual
         slope = tried_slope
      end do
      solved = maxval(abs(residual)) <= settled*scale

   contains

      pure subroutine residual_at(w, residual, slope, scale)
         real(wp), intent(in) :: w(3)
         real(wp), intent(out) :: residual(3)          !! J
         real(wp), intent(out) :: slope(3)             !! of the torque by the speed, stretched
         real(wp), intent(out) :: scale                !! J: of what is added up
         real(wp) :: torque(3)
         integer :: j

         do j = 1, 3
            call motor_torque(motor, w(j), torque(j), slope(j))
         end do
         scale = maxval(0.5_wp*inertia*w**2) + energy + width*maxval((abs(torque) + abs(load))*stretch)
         torque = (torque + load - damping*w)*stretch
         slope = (slope - damping)*stretch
         residual = 0.5_wp*inertia*w*abs(w) - energy - width*matmul(stages, torque)
         if (stretch(1) <= 0.0_wp .and. energy <= 0.0_wp) residual(1) = 0.0_wp
      end subroutine residual_at
   end subroutine solve_step

   !> One turn from a speed; `after` is the speed at its end, 0 if there is none.
   pure subroutine one_turn(machine, stride, start, cycle, after, ended)
      type(machine_t), intent(in) :: machine
      integer, intent(in) :: stride
      real(wp), intent(in) :: start
      type(cycle_t), intent(inout) :: cycle
      real(wp), intent(out) :: after
      integer, intent(out) :: ended
      real(wp), allocatable :: stretch(:)     ! large: it would fill a small stack
      integer :: steps, last

      allocate (stretch(0:2*machine%steps), source=1.0_wp)
      steps = machine%steps/stride
      if (.not. allocated(cycle%speed)) allocate (cycle%speed(0:steps))
      call integrate(machine, machine%turn, stride, stretch, 2.0_wp*pi/real(steps, wp), start, cycle%speed, cycle%period, ended, &
                     last)
      after = cycle%speed(steps)
      if (ended == turn_done) return
      after = 0.0_wp
      cycle%stopped_at = full_turn*real(last, wp)/real(steps, wp)
   end subroutine one_turn

   ! ---- steady running ----------------------------------------------------------------------------------------------

   !> Work of motor, loads, springs and dampers over a turn at a steady speed, and that of all of them by amount.
   pure subroutine work_of_turn(machine, speed, work, amount)
      type(machine_t), intent(in) :: machine
      real(wp), intent(in) :: speed
      real(wp), intent(out) :: work, amount
      real(wp) :: motor, unused
      integer :: n

      call motor_torque(machine%motor, speed, motor, unused)
      n = size(machine%turn%torque) - 1    ! the last node is the first one again
      associate (q => machine%turn%torque(:n), d => machine%turn%damping(:n))
         work = 2.0_wp*pi*(motor + (sum(q) - speed*sum(d))/real(n, wp))
         amount = 2.0_wp*pi*(abs(motor) + (sum(abs(q)) + speed*sum(abs(d)))/real(n, wp))
      end associate
   end subroutine work_of_turn

   !> The steady cycle and its error, by the same with twice the step. `given` is the speed at CRNKI where any speed would do.
   subroutine steady_cycle(machine, given, cycle, stop)
      type(machine_t), intent(in) :: machine
      real(wp), intent(in) :: given
      type(cycle_t), intent(out) :: cycle
      type(stop_t), intent(in), optional :: stop
      type(cycle_t) :: coarse
      integer :: n

      call find_cycle(machine, 1, given, cycle, stop)
      call find_cycle(machine, 2, given, coarse, stop)
      cycle%error = never
      if (cycle%state == cycle_unknown .or. coarse%state /= cycle%state) return
      cycle%error = 0.0_wp
      if (cycle%state /= cycle_found .and. cycle%state /= cycle_any_speed) return
      n = machine%steps
      cycle%error = max(maxval(abs(cycle%speed(0:n:2) - coarse%speed)), abs(cycle%mean - coarse%mean))/maxval(cycle%speed)
   end subroutine steady_cycle

   !> The steady cycle at steps of `stride`.
   !>
   !> Two runs never cross in the plane of angle and energy: the speed after a turn grows with the speed before it. So what begins
   !> below a run that stops, stops too. A torque that falls with the speed has one steady cycle at most, for the work of any run
   !> above it is less. Then a speed that falls over a turn has the cycle below it, one that rises above it.
   subroutine find_cycle(machine, stride, given, cycle, stop)
      type(machine_t), intent(in) :: machine
      integer, intent(in) :: stride
      real(wp), intent(in) :: given
      type(cycle_t), intent(out) :: cycle
      type(stop_t), intent(in), optional :: stop
      real(wp) :: low, high, work, amount, after, after_high, before, balance, last, last_balance, strongest, top, next, greatest
      real(wp) :: lost
      integer :: k, ended, low_is
      logical :: falling

      associate (motor => machine%motor)
         top = motor%idle
         strongest = motor%torque
         falling = .true.
         if (size(motor%speed) > 0) then
            top = maxval(motor%speed)
            strongest = maxval(motor%table)
            falling = all(motor%table(2:) <= motor%table(:size(motor%table) - 1))
            if (.not. any(abs(motor%table - strongest) > 0.0_wp)) top = 0.0_wp
         else if (motor%torque < 0.0_wp .and. top > 0.0_wp) then
            falling = .false.
            strongest = huge(1.0_wp)
         end if
      end associate
      call work_of_turn(machine, 0.0_wp, work, amount)
      if (top <= 0.0_wp .and. maxval(abs(machine%turn%damping)) <= 0.0_wp) then
         ! the torque does not depend on the speed
         cycle%state = merge(cycle_grows, cycle_falls, work > 0.0_wp)
         if (abs(work) > no_work*amount) return
         call one_turn(machine, stride, abs(given), cycle, after, ended)
         cycle%state = state_of(ended, cycle_any_speed)
         call find_extremes(machine, cycle)
         return
      end if
      ! the strongest torque of the motor, without dampers, gives no work
      cycle%state = cycle_falls
      associate (n => size(machine%turn%torque) - 1)
         if (strongest + sum(machine%turn%torque(:n))/real(n, wp) <= 0.0_wp) return
      end associate
      ! a speed above all cycles: it falls over a turn
      high = max(top, 1.0_wp)
      cycle%state = cycle_grows
      do k = 1, most_iterations
         call work_of_turn(machine, high, work, amount)
         if (work < 0.0_wp) then
            cycle%state = cycle_unknown
            if (is_to_end(stop)) return
            call one_turn(machine, stride, high, cycle, after, ended)
            if (ended == turn_done .and. after < high) exit
         end if
         high = 2.0_wp*high
      end do
      if (k > most_iterations) return
      greatest = high
      after_high = after
      last = high
      last_balance = after - high
      next = after
      low = 0.0_wp
      low_is = turn_failed
      lost = 0.0_wp
      do k = 1, most_iterations
         if (high - low <= settled*high) exit
         ! what begins at most at `high` begins the next turn at most at `after_high`: if that stops, all do
         if (low_is == turn_stalled .and. after_high <= low) exit
         ! secants, bisected now and then so that the bracket shrinks in any case
         if (.not. (next > low .and. next < high) .or. modulo(k, 5) == 0) next = 0.5_wp*(low + high)
         before = next
         if (is_to_end(stop)) exit
         call one_turn(machine, stride, before, cycle, after, ended)
         if (ended /= turn_done) then
            if (ended == turn_failed .and. before >= after_high) return
            low = before
            low_is = ended
            lost = cycle%stopped_at
            next = after_high
            cycle
         end if
         balance = after - before
         if (abs(balance) <= settled*before) then
            low_is = turn_done
            exit
         end if
         if (balance < 0.0_wp) then
            high = before
            after_high = after
         else
            low = before
            low_is = turn_done
         end if
         next = after
         if (abs(balance - last_balance) > 0.0_wp) next = before - balance*(before - last)/(balance - last_balance)
         last = before
         last_balance = balance
      end do
      if (is_to_end(stop)) return
      if (low_is == turn_done) then
         cycle%state = cycle_found
         call find_extremes(machine, cycle)
         return
      end if
      cycle%state = cycle_unknown
      if (low_is == turn_failed .or. after_high > low) return
      cycle%state = cycle_stalls
      cycle%stopped_at = lost
      if (falling) return
      ! the torque rises somewhere with the speed: only the turns themselves, from above all cycles, show that there is none
      before = greatest
      do k = 1, most_turns
         if (is_to_end(stop)) return
         call one_turn(machine, stride, before, cycle, after, ended)
         if (ended /= turn_done .or. abs(after - before) <= settled*before) exit
         before = after
      end do
      cycle%state = cycle_unknown
      if (k <= most_turns) cycle%state = state_of(ended, cycle_found)
      call find_extremes(machine, cycle)

   contains

      !> What the end of a turn means.
      pure integer function state_of(ended, good) result(state)
         integer, intent(in) :: ended, good

         state = cycle_unknown
         if (ended == turn_done) state = good
         if (ended == turn_stalled) state = cycle_stalls
      end function state_of
   end subroutine find_cycle

   !> Least and greatest speed, by a parabola through the nodes beside them; mean speed.
   subroutine find_extremes(machine, cycle)
      type(machine_t), intent(in) :: machine
      type(cycle_t), intent(inout) :: cycle
      integer :: n

      if (cycle%state == cycle_stalls .or. cycle%state == cycle_unknown) return
      if (size(machine%turn%inertia) == 0) return
      n = ubound(cycle%speed, 1)
      cycle%mean = 2.0_wp*pi/cycle%period
      call peak_of(-cycle%speed(:n - 1), cycle%least, cycle%least_at)
      cycle%least = -cycle%least
      call peak_of(cycle%speed(:n - 1), cycle%greatest, cycle%greatest_at)
   end subroutine find_extremes

   !> Greatest of values at even steps of a turn, and where: degrees from the first.
   pure subroutine peak_of(values, peak, at)
      real(wp), intent(in) :: values(0:)
      real(wp), intent(out) :: peak, at
      real(wp) :: left, right, bend, shift
      integer :: k, n

      n = size(values)
      k = maxloc(values, dim=1) - 1
      left = values(modulo(k - 1, n))
      right = values(modulo(k + 1, n))
      bend = left - 2.0_wp*values(k) + right
      shift = 0.0_wp
      if (bend < 0.0_wp) shift = 0.5_wp*(left - right)/bend
      peak = values(k) - 0.25_wp*(left - right)*shift
      at = modulo((real(k, wp) + shift)*full_turn/real(n, wp), full_turn)
   end subroutine peak_of

   ! ---- run-up ------------------------------------------------------------------------------------------------------

   !> The first turns from a speed at CRNKI, 0: from rest, with steps so short that the error is small.
   !> `problem` is needed for the first turn, whose nodes lie closer at its beginning.
   subroutine run_up(problem, model, machine, run, stop)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      type(machine_t), intent(in) :: machine
      type(machine_run_t), intent(out) :: run
      type(stop_t), intent(in), optional :: stop
      type(machine_t) :: finer
      type(reduced_t) :: first
      type(machine_run_t) :: coarse
      real(wp), allocatable :: stretch(:)
      real(wp) :: width
      integer :: k

      finer = machine
      do
         width = sqrt(2.0_wp*pi)/real(finer%steps, wp)
         stretch = [(width*real(k, wp), k=0, 2*finer%steps)]   ! 2 s at half steps
         call reduce_machine(problem, model, 0.25_wp*stretch**2*degrees_per_radian, first, stop)
         call run_through(finer, first, stretch, 1, run, stop)
         call run_through(finer, first, stretch, 2, coarse, stop)
         if (is_to_end(stop)) return
         run%error = never
         associate (turns => size(run%time))
            if (size(coarse%time) == turns .and. run%computed .and. coarse%computed) then
               run%error = max(0.0_wp, maxval(abs(run%time/coarse%time - 1.0_wp)), maxval(abs(run%speed/coarse%speed - 1.0_wp)))
            end if
         end associate
         if (run%error <= wanted_error .or. finer%steps >= most_steps) exit
         call make_machine(problem, model, machine%motor, finer, 2*finer%steps, stop)
         finer%flywheel = machine%flywheel
         if (finer%turn%failure > 0) exit
      end do
      if (run%error <= worst_error) return
      run%computed = .false.
      run%stopped_at = -1.0_wp
      run%time = [real(wp) ::]
      run%speed = [real(wp) ::]
      run%least = [real(wp) ::]
      run%greatest = [real(wp) ::]
   end subroutine run_up

   !> The turns of a run-up at steps of `stride`; `first` is the machine at the nodes of its first turn.
   subroutine run_through(machine, first, stretch, stride, run, stop)
      type(machine_t), intent(in) :: machine
      type(reduced_t), intent(in) :: first
      real(wp), intent(in) :: stretch(0:)              !! shape (0:2*steps)
      integer, intent(in) :: stride
      type(machine_run_t), intent(out) :: run
      type(stop_t), intent(in), optional :: stop
      type(cycle_t) :: cycle
      real(wp) :: width, before, after, time
      integer :: steps, turn, turns, ended, last

      turns = machine%motor%turns
      steps = machine%steps/stride
      allocate (run%time(turns), run%speed(turns), run%least(turns), run%greatest(turns), source=0.0_wp)
      allocate (cycle%speed(0:steps))
      before = machine%motor%start
      time = 0.0_wp
      do turn = 1, turns
         if (is_to_end(stop)) return
         if (turn > 1) then
            call one_turn(machine, stride, before, cycle, after, ended)
         else
            width = sqrt(2.0_wp*pi)/real(steps, wp)
            call integrate(machine, first, stride, stretch, width, before, cycle%speed, cycle%period, ended, last)
            after = cycle%speed(steps)
            cycle%stopped_at = degrees_per_radian*(width*real(last, wp))**2
         end if
         if (ended /= turn_done) then
            run%computed = ended == turn_stalled
            if (run%computed) run%stopped_at = cycle%stopped_at + full_turn*real(turn - 1, wp)
            call keep(turn - 1)
            return
         end if
         time = time + cycle%period
         run%time(turn) = time
         run%speed(turn) = after
         run%least(turn) = minval(cycle%speed)
         run%greatest(turn) = maxval(cycle%speed)
         before = after
         call tell_host(stop, turn, turns)
      end do

   contains

      subroutine keep(count)
         integer, intent(in) :: count

         run%time = run%time(:count)
         run%speed = run%speed(:count)
         run%least = run%least(:count)
         run%greatest = run%greatest(:count)
      end subroutine keep
   end subroutine run_through

   ! ---- flywheel ----------------------------------------------------------------------------------------------------

   !> Flywheel with which the steady cycle fluctuates as wanted: the exact cycle, by bisection. Negative: there is none.
   subroutine flywheel_for(machine, fluctuation, given, flywheel, stop)
      type(machine_t), intent(in) :: machine
      real(wp), intent(in) :: fluctuation, given
      real(wp), intent(out) :: flywheel
      type(stop_t), intent(in), optional :: stop
      type(machine_t) :: tried
      real(wp) :: low, high
      integer :: k

      tried = machine
      low = 0.0_wp
      flywheel = 0.0_wp
      if (fluctuates_at_most(0.0_wp)) return
      high = maxval(abs(machine%turn%inertia))
      flywheel = -1.0_wp
      do k = 1, most_iterations
         if (is_to_end(stop)) return
         if (fluctuates_at_most(high)) exit
         low = high
         high = 4.0_wp*high
         if (high > huge(1.0_wp)**0.25_wp) return
      end do
      do k = 1, most_iterations
         flywheel = 0.5_wp*(low + high)
         if (high - low <= settled*high .or. is_to_end(stop)) exit
         if (fluctuates_at_most(flywheel)) then
            high = flywheel
         else
            low = flywheel
         end if
      end do

   contains

      logical function fluctuates_at_most(wheel)
         real(wp), intent(in) :: wheel
         type(cycle_t) :: cycle

         tried%flywheel = wheel
         call find_cycle(tried, 1, given, cycle, stop)
         fluctuates_at_most = cycle%state == cycle_found .or. cycle%state == cycle_any_speed
         if (fluctuates_at_most) fluctuates_at_most = cycle%greatest - cycle%least <= &
                                                      0.5_wp*fluctuation*(cycle%greatest + cycle%least)
      end function fluctuates_at_most
   end subroutine flywheel_for
end module psalm_machine
