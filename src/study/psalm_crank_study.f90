!> The motion of the crank that a steady state is found for: constant speed, or one that varies over the turn, by the group CYCLE or
!> as the steady cycle of the machine of the group MOTOR. Source: Haines, 2I.
module psalm_crank_study
   use psalm_crank_motion, only: crank_motion_t, constant_motion, varying_motion, positive_between, can_be_followed
   use psalm_cycle_group, only: cycle_group_t, cycle_of
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t
   use psalm_kinds, only: wp, pi
   use psalm_machine, only: machine_t, cycle_t, make_machine, settle_machine, motor_torque, cycle_found, cycle_any_speed
   use psalm_motor_group, only: motor_of
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t, is_to_end
   implicit none (type, external)
   private
   public :: check_crank, find_crank

   integer, parameter :: nodes_used = 720         !! of the machine's steps, at least twice as many: the others show the error

contains

   !> Errors: nothing says how the speed varies; a crank that turns backwards by a motor; a speed between those given that is not
   !> positive.
   subroutine check_crank(set, findings)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(cycle_group_t) :: given

      if (.not. set%gives('CYCLE')) return
      given = cycle_of(set)
      if (size(given%speed) > 0) then
         if (.not. positive_between(given%speed)) then
            call set%origins%error(findings, 'CYCLE', 'CYCW', 'the smooth curve through these speeds is not above 0 '// &
                                   'everywhere: give more of them where they change fast')
         else if (.not. can_be_followed(given%speed)) then
            call set%origins%error(findings, 'CYCLE', 'CYCW', 'the speeds differ by too large a factor, or change too fast: '// &
                                   'the time over the turn cannot be found from them')
         end if
      else if (.not. set%gives('MOTOR')) then
         call set%origins%error(findings, 'CYCLE', '', 'says nothing of the speed: give CYCW, or &MOTOR, whose steady cycle is '// &
                                'taken')
      else if (set%rates%speed < 0.0_wp) then
         call set%origins%error(findings, 'RATES', 'SPEED', 'the machine of &MOTOR turns forwards; with &CYCLE give a speed '// &
                                'above 0', 1)
      end if
   end subroutine check_crank

   !> The motion of a crank that makes full turns; not `known` where the machine has no steady cycle, or the host ended the search.
   subroutine find_crank(set, given, model, crank, stop)
      type(data_set_t), intent(in) :: set         !! `check_crank` found no fault with it
      type(problem_t), intent(in) :: given
      type(force_model_t), intent(in) :: model    !! with all masses
      type(crank_motion_t), intent(out) :: crank
      type(stop_t), intent(in), optional :: stop
      type(cycle_group_t) :: law
      real(wp), allocatable :: values(:)

      crank = constant_motion(set%rates%speed)
      if (.not. set%gives('CYCLE')) return
      law = cycle_of(set)
      if (size(law%speed) == 0) then
         call follow_machine(set, given, model, crank, stop)
         return
      end if
      values = law%speed
      if (crank%sense < 0.0_wp) values = [values(1), values(size(values):2:-1)]
      crank = varying_motion(values, crank%speed, crank%sense)
   end subroutine find_crank

   !> The steady cycle of the machine. The nodes between those of the series show its errors.
   subroutine follow_machine(set, given, model, crank, stop)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: given
      type(force_model_t), intent(in) :: model
      type(crank_motion_t), intent(inout) :: crank
      type(stop_t), intent(in), optional :: stop
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(machine_t), allocatable :: machine
      type(cycle_t) :: cycle
      real(wp) :: angle, torque, unused, push, greatest
      integer :: k, apart

      crank%known = .false.
      allocate (problem, source=given)
      allocate (machine)
      call make_machine(problem, model, motor_of(set), machine, stop=stop)
      if (is_to_end(stop) .or. .not. turns(machine)) return
      call settle_machine(problem, model, set%rates%speed, machine, cycle, stop)
      if (is_to_end(stop) .or. .not. turns(machine)) return
      if (cycle%state /= cycle_found .and. cycle%state /= cycle_any_speed) return
      apart = machine%steps/nodes_used
      crank = varying_motion(cycle%speed(:machine%steps - 1:apart), cycle%mean, 1.0_wp)
      crank%by_motor = .true.
      greatest = 0.0_wp
      do k = apart/2, machine%steps - 1, apart
         angle = 2.0_wp*pi*real(k, wp)/real(machine%steps, wp)
         associate (turn => machine%turn, n => 2*k + 1, w => cycle%speed(k))
            crank%speed_error = max(crank%speed_error, abs(crank%speed_at(angle) - w/cycle%mean))
            ! Eksergian's equation at the same place
            call motor_torque(machine%motor, w, torque, unused)
            push = (torque + turn%torque(n) - turn%damping(n)*w - 0.5_wp*turn%slope(n)*w**2)/(turn%inertia(n) + machine%flywheel)
            push = push/cycle%mean**2
            crank%acceleration_error = max(crank%acceleration_error, abs(crank%push_at(angle) - push))
            greatest = max(greatest, abs(push))
         end associate
      end do
      if (greatest > 0.0_wp) crank%acceleration_error = crank%acceleration_error/greatest
   end subroutine follow_machine

   !> True if the crank turns fully and has an inertia everywhere.
   pure logical function turns(machine)
      type(machine_t), intent(in) :: machine

      turns = machine%turn%failure == 0
      if (turns) turns = all(machine%turn%inertia + machine%flywheel > 0.0_wp)
   end function turns
end module psalm_crank_study
