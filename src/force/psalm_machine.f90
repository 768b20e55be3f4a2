!> Motion from torque: the steady cycle and the run-up of a machine that a crank drives.
!>
!> Reduced to the crank the machine has an inertia J(phi), which varies, and a torque Q(phi, w). Eksergian's equation
!> J w dw/dphi + J' w**2/2 = Q is solved for the energy E = J w**2/2, of which dE/dphi = Q: no derivative of J is needed.
!> Integration is over the angle; from rest phi = s**2 takes the root out of the speed. J and what weight, loads and springs do
!> are found from the forces at unit speed, in closed form at every node. Friction of joints (&FRICTN) is no part of this.
module psalm_machine
   use psalm_error, only: problem_t, motion_t
   use psalm_force_analysis, only: force_table_t, analyse_forces, column_drive
   use psalm_force_model, only: force_model_t, friction_t, load_t, spring_t, vertices_of
   use psalm_kinds, only: wp, pi, degrees_per_radian, full_turn
   use psalm_motor_group, only: motor_group_t
   implicit none (type, external)
   private
   public :: machine_t, cycle_t, run_t, reduced_t, reduce_machine, make_machine, steady_cycle, run_up, flywheel_for, free_flywheel
   public :: cycle_found, cycle_grows, cycle_falls, cycle_stalls, cycle_any_speed

   integer, parameter :: steps_of_turn = 1440        !! of integration: error of the classical Runge-Kutta below 1e-10
   integer, parameter :: most_iterations = 200       !! of a root
   real(wp), parameter :: settled = 1.0e-13_wp       !! relative change at which a root is found
   real(wp), parameter :: no_work = 1.0e-9_wp        !! relative work over a turn that counts as none

   integer, parameter :: cycle_found = 0     !! speed and torque are in balance
   integer, parameter :: cycle_grows = 1     !! the torque does not fall with the speed: it grows with every turn
   integer, parameter :: cycle_falls = 2     !! or falls with every turn
   integer, parameter :: cycle_stalls = 3    !! the machine stops within the turn
   integer, parameter :: cycle_any_speed = 4 !! no work over a turn at any speed: the given speed at the beginning was taken

   !> What the mechanism is for its crank, at a row of inputs.
   type :: reduced_t
      real(wp), allocatable :: inertia(:)    !! J, kg m2
      real(wp), allocatable :: slope(:)      !! J', kg m2/rad
      real(wp), allocatable :: torque(:)     !! of weight, loads and springs, N m
      real(wp), allocatable :: damping(:)    !! of dampers, N m s
      integer :: trouble = 0                 !! first input at which the linkage does not close or is at a dead point; 0: none
   end type reduced_t

   !> A machine: the mechanism at the nodes of one turn, its motor, its flywheel.
   type :: machine_t
      type(reduced_t) :: turn                !! at 2 `steps_of_turn` + 1 nodes, from CRNKI on
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
   end type cycle_t

   !> Turns of a run-up.
   type :: run_t
      real(wp), allocatable :: time(:)       !! shape (turns): s, at the end of each
      real(wp), allocatable :: speed(:)      !! shape (turns): rad/s there
      real(wp), allocatable :: least(:), greatest(:) !! shape (turns): within it
      real(wp) :: stopped_at = -1.0_wp       !! degrees from CRNKI: it stalls there; negative: it does not
   end type run_t

contains

   !> Inertia and torque on the crank at increments of the input. `problem` is left at these inputs.
   subroutine reduce_machine(problem, model, delt, reduced)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: delt(:)               !! degrees from CRNKI
      type(reduced_t), intent(out) :: reduced
      type(force_model_t) :: only
      type(force_table_t) :: table
      type(motion_t) :: motion
      integer :: k

      call problem%set_inputs(delt)
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(problem%given, motion)
      ! masses alone: the drive at unit speed is half of J'
      only = model
      only%gravity = 0.0_wp
      only%loads = [load_t ::]
      only%springs = [spring_t ::]
      only%friction = [friction_t ::]
      call analyse_forces(problem, only, 1.0_wp, 0.0_wp, motion%closed, motion%input, table)
      reduced%inertia = 2.0_wp*table%kinetic
      reduced%slope = 2.0_wp*table%value(:, column_drive)
      reduced%trouble = findloc([(table%known(k), k=1, size(delt))], .false., dim=1)
      ! everything else but dampers, at unit speed, where power is torque
      only = model
      only%friction = [friction_t ::]
      only%springs%damping = 0.0_wp
      call analyse_forces(problem, only, 1.0_wp, 0.0_wp, motion%closed, motion%input, table)
      reduced%torque = table%power
      only%gravity = 0.0_wp
      only%loads = [load_t ::]
      only%springs = model%springs
      only%springs%stiffness = 0.0_wp
      only%springs%preload = 0.0_wp
      call analyse_forces(problem, only, 1.0_wp, 0.0_wp, motion%closed, motion%input, table)
      reduced%damping = -table%power
   end subroutine reduce_machine

   !> The machine over one turn of its crank.
   subroutine make_machine(problem, model, motor, machine)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      type(motor_group_t), intent(in) :: motor
      type(machine_t), intent(out) :: machine
      integer :: k

      machine%motor = motor
      machine%flywheel = motor%flywheel
      call reduce_machine(problem, model, [(full_turn*real(k, wp)/real(2*steps_of_turn, wp), k=0, 2*steps_of_turn)], machine%turn)
   end subroutine make_machine

   !> Torque of the motor at a speed: the table, or the line, or a constant.
   pure real(wp) function motor_torque(motor, speed) result(torque)
      type(motor_group_t), intent(in) :: motor
      real(wp), intent(in) :: speed
      integer :: k

      associate (rows => size(motor%speed))
         if (rows > 0) then
            k = count(motor%speed <= speed)
            if (k == 0) then
               torque = motor%table(1)
            else if (k == rows) then
               torque = motor%table(rows)
            else
               torque = motor%table(k) + (motor%table(k + 1) - motor%table(k))*(speed - motor%speed(k))/ &
                        (motor%speed(k + 1) - motor%speed(k))
            end if
         else
            torque = motor%torque
            if (motor%idle > 0.0_wp) torque = motor%torque*(1.0_wp - speed/motor%idle)
         end if
      end associate
   end function motor_torque

   ! ---- integration -------------------------------------------------------------------------------------------------

   !> Speed through the nodes of `table`, two nodes a step, by the classical Runge-Kutta method for the energy; the time by
   !> Simpson's rule. `stretch` is d(phi)/d(variable) at the nodes.
   !>
   !> `stalled` is the step in which the machine stops, 0: none.
   subroutine integrate(machine, table, stretch, width, start, speed, time, stalled)
      type(machine_t), intent(in) :: machine
      type(reduced_t), intent(in) :: table
      real(wp), intent(in) :: stretch(0:)              !! shape (0:2*steps)
      real(wp), intent(in) :: width                    !! of a step, in the variable
      real(wp), intent(in) :: start                    !! speed at the first node
      real(wp), intent(out) :: speed(0:)               !! shape (0:steps), an even number of steps
      real(wp), intent(out) :: time
      integer, intent(out) :: stalled
      real(wp) :: e, k1, k2, k3, k4, slowness(0:ubound(speed, 1))
      logical :: alive
      integer :: k

      speed = 0.0_wp
      speed(0) = start
      time = 0.0_wp
      e = 0.5_wp*inertia(0)*start**2
      if (start > 0.0_wp) then
         slowness(0) = stretch(0)/start
      else
         ! from rest, phi = s**2: the speed is s sqrt(2 Q/J) to first order
         k1 = motor_torque(machine%motor, 0.0_wp) + table%torque(1)
         stalled = 1
         if (.not. k1 > 0.0_wp) return
         slowness(0) = 2.0_wp/sqrt(2.0_wp*k1/inertia(0))
      end if
      do k = 1, ubound(speed, 1)
         stalled = k
         alive = .true.
         k1 = torque_at(2*k - 2, e)
         k2 = torque_at(2*k - 1, e + 0.5_wp*width*k1)
         k3 = torque_at(2*k - 1, e + 0.5_wp*width*k2)
         k4 = torque_at(2*k, e + width*k3)
         e = e + width*(k1 + 2.0_wp*k2 + 2.0_wp*k3 + k4)/6.0_wp
         if (.not. (alive .and. e > 0.0_wp)) return
         speed(k) = sqrt(2.0_wp*e/inertia(2*k))
         slowness(k) = stretch(2*k)/speed(k)
      end do
      stalled = 0
      associate (last => ubound(speed, 1))
         time = width/3.0_wp*(slowness(0) + slowness(last) + 4.0_wp*sum(slowness(1:last - 1:2)) + &
                              2.0_wp*sum(slowness(2:last - 2:2)))
      end associate

   contains

      pure real(wp) function inertia(node)
         integer, intent(in) :: node

         inertia = table%inertia(node + 1) + machine%flywheel
      end function inertia

      !> Derivative of the energy by the variable.
      real(wp) function torque_at(node, energy) result(torque)
         integer, intent(in) :: node
         real(wp), intent(in) :: energy
         real(wp) :: w

         w = sqrt(2.0_wp*max(energy, 0.0_wp)/inertia(node))
         ! the first step from rest begins without energy
         alive = alive .and. (energy > 0.0_wp .or. (k == 1 .and. start <= 0.0_wp))
         torque = (motor_torque(machine%motor, w) + table%torque(node + 1) - table%damping(node + 1)*w)*stretch(node)
      end function torque_at
   end subroutine integrate

   !> One turn from a speed; `after` is the speed at its end, 0 if it stalls.
   subroutine one_turn(machine, start, cycle, after)
      type(machine_t), intent(in) :: machine
      real(wp), intent(in) :: start
      type(cycle_t), intent(inout) :: cycle
      real(wp), intent(out) :: after
      real(wp) :: stretch(0:2*steps_of_turn)
      integer :: stalled

      stretch = 1.0_wp
      if (.not. allocated(cycle%speed)) allocate (cycle%speed(0:steps_of_turn))
      call integrate(machine, machine%turn, stretch, 2.0_wp*pi/real(steps_of_turn, wp), start, cycle%speed, cycle%period, stalled)
      after = cycle%speed(steps_of_turn)
      if (stalled == 0) return
      after = 0.0_wp
      cycle%stopped_at = full_turn*real(stalled, wp)/real(steps_of_turn, wp)
   end subroutine one_turn

   ! ---- steady running ----------------------------------------------------------------------------------------------

   !> Work of motor, loads, springs and dampers over a turn at a steady speed, and that of all of them by amount.
   pure subroutine work_of_turn(machine, speed, work, amount)
      type(machine_t), intent(in) :: machine
      real(wp), intent(in) :: speed
      real(wp), intent(out) :: work, amount
      real(wp) :: motor

      motor = motor_torque(machine%motor, speed)
      ! the last node is the first one again
      associate (q => machine%turn%torque(:2*steps_of_turn), d => machine%turn%damping(:2*steps_of_turn))
         work = 2.0_wp*pi*(motor + (sum(q) - speed*sum(d))/real(size(q), wp))
         amount = 2.0_wp*pi*(abs(motor) + (sum(abs(q)) + speed*sum(abs(d)))/real(size(q), wp))
      end associate
   end subroutine work_of_turn

   !> The steady cycle. `given` is the speed at CRNKI where any speed would do.
   subroutine steady_cycle(machine, given, cycle)
      type(machine_t), intent(in) :: machine
      real(wp), intent(in) :: given
      type(cycle_t), intent(out) :: cycle
      real(wp) :: low, high, work, amount, after, before, balance, last_balance, last, next, top
      integer :: k

      call work_of_turn(machine, 0.0_wp, work, amount)
      top = machine%motor%idle
      if (size(machine%motor%speed) > 0) top = maxval(machine%motor%speed)
      if (top <= 0.0_wp .and. maxval(abs(machine%turn%damping)) <= 0.0_wp) then
         ! the torque does not depend on the speed
         cycle%state = merge(cycle_grows, cycle_falls, work > 0.0_wp)
         if (abs(work) > no_work*amount) return
         cycle%state = cycle_any_speed
         call one_turn(machine, abs(given), cycle, after)
         if (after <= 0.0_wp) cycle%state = cycle_stalls
         call find_extremes(machine, cycle)
         return
      end if
      cycle%state = cycle_falls
      if (work <= 0.0_wp) return
      ! the speed at which a steady turn would be in balance
      low = 0.0_wp
      high = max(top, 1.0_wp)
      do k = 1, most_iterations
         call work_of_turn(machine, high, work, amount)
         if (work < 0.0_wp) exit
         high = 2.0_wp*high
      end do
      cycle%state = cycle_grows
      if (work >= 0.0_wp) return
      do k = 1, most_iterations
         before = 0.5_wp*(low + high)
         call work_of_turn(machine, before, work, amount)
         if (work > 0.0_wp) then
            low = before
         else
            high = before
         end if
      end do
      ! then the speed at the beginning that comes back: turns are run through, which settles, and secants shorten the way
      cycle%state = cycle_stalls
      call one_turn(machine, before, cycle, after)
      if (after <= 0.0_wp) return
      last = before
      last_balance = after - before
      before = after
      do k = 1, most_iterations
         call one_turn(machine, before, cycle, after)
         if (after <= 0.0_wp) return
         balance = after - before
         cycle%state = cycle_found
         if (abs(balance) <= settled*before) exit
         next = after
         if (abs(balance - last_balance) > 0.0_wp) next = before - balance*(before - last)/(balance - last_balance)
         if (.not. (next > 0.5_wp*before .and. next < 2.0_wp*before)) next = after
         last = before
         last_balance = balance
         before = next
      end do
      call find_extremes(machine, cycle)
   end subroutine steady_cycle

   !> Least and greatest speed, by a parabola through the nodes beside them; mean speed.
   subroutine find_extremes(machine, cycle)
      type(machine_t), intent(in) :: machine
      type(cycle_t), intent(inout) :: cycle

      if (cycle%state == cycle_stalls) return
      if (size(machine%turn%inertia) == 0) return
      cycle%mean = 2.0_wp*pi/cycle%period
      call peak_of(-cycle%speed(:steps_of_turn - 1), cycle%least, cycle%least_at)
      cycle%least = -cycle%least
      call peak_of(cycle%speed(:steps_of_turn - 1), cycle%greatest, cycle%greatest_at)
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

   !> The first turns from a speed at CRNKI, 0: from rest. `problem` is needed for the first turn from rest.
   subroutine run_up(problem, model, machine, run)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      type(machine_t), intent(in) :: machine
      type(run_t), intent(out) :: run
      type(cycle_t) :: cycle
      type(reduced_t) :: first
      real(wp) :: stretch(0:2*steps_of_turn), width, before, after, time
      integer :: turn, turns, k, stalled

      turns = machine%motor%turns
      allocate (run%time(turns), run%speed(turns), run%least(turns), run%greatest(turns), source=0.0_wp)
      allocate (cycle%speed(0:steps_of_turn))
      before = machine%motor%start
      time = 0.0_wp
      do turn = 1, turns
         if (before > 0.0_wp) then
            call one_turn(machine, before, cycle, after)
         else
            width = sqrt(2.0_wp*pi)/real(steps_of_turn, wp)
            stretch = [(width*real(k, wp), k=0, 2*steps_of_turn)]   ! 2 s at half steps
            call reduce_machine(problem, model, 0.25_wp*stretch**2*degrees_per_radian, first)
            call integrate(machine, first, stretch, width, 0.0_wp, cycle%speed, cycle%period, stalled)
            after = cycle%speed(steps_of_turn)
            if (stalled > 0) after = 0.0_wp
            cycle%stopped_at = degrees_per_radian*(width*real(stalled, wp))**2
         end if
         if (after <= 0.0_wp) then
            run%stopped_at = cycle%stopped_at + full_turn*real(turn - 1, wp)
            call keep(turn - 1)
            return
         end if
         time = time + cycle%period
         run%time(turn) = time
         run%speed(turn) = after
         run%least(turn) = minval(cycle%speed)
         run%greatest(turn) = maxval(cycle%speed)
         before = after
      end do

   contains

      subroutine keep(count)
         integer, intent(in) :: count

         run%time = run%time(:count)
         run%speed = run%speed(:count)
         run%least = run%least(:count)
         run%greatest = run%greatest(:count)
      end subroutine keep
   end subroutine run_up

   ! ---- flywheel ----------------------------------------------------------------------------------------------------

   !> Flywheel with which a free run fluctuates as wanted: from the least and greatest inertia, by energy. Negative: none is needed.
   pure real(wp) function free_flywheel(machine, fluctuation) result(flywheel)
      type(machine_t), intent(in) :: machine
      real(wp), intent(in) :: fluctuation              !! (greatest - least)/mean of both
      real(wp) :: least, greatest, q, unused

      call peak_of(-machine%turn%inertia(:2*steps_of_turn), least, unused)
      least = -least
      call peak_of(machine%turn%inertia(:2*steps_of_turn), greatest, unused)
      q = ((1.0_wp + 0.5_wp*fluctuation)/(1.0_wp - 0.5_wp*fluctuation))**2
      flywheel = (greatest - q*least)/(q - 1.0_wp)
   end function free_flywheel

   !> Flywheel with which the steady cycle fluctuates as wanted: the exact cycle, by bisection. Negative: there is none.
   subroutine flywheel_for(machine, fluctuation, given, flywheel)
      type(machine_t), intent(in) :: machine
      real(wp), intent(in) :: fluctuation, given
      real(wp), intent(out) :: flywheel
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
         if (fluctuates_at_most(high)) exit
         low = high
         high = 4.0_wp*high
         if (high > huge(1.0_wp)**0.25_wp) return
      end do
      do k = 1, most_iterations
         flywheel = 0.5_wp*(low + high)
         if (high - low <= settled*high) exit
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
         call steady_cycle(tried, given, cycle)
         fluctuates_at_most = cycle%state == cycle_found .or. cycle%state == cycle_any_speed
         if (fluctuates_at_most) fluctuates_at_most = cycle%greatest - cycle%least <= &
                                                      0.5_wp*fluctuation*(cycle%greatest + cycle%least)
      end function fluctuates_at_most
   end subroutine flywheel_for
end module psalm_machine
