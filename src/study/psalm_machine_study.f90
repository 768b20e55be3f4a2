!> Motion from torque: what the group MOTOR asks for. Data in, results out.
module psalm_machine_study
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t
   use psalm_kinds, only: wp, full_turn
   use psalm_machine, only: machine_t, cycle_t, machine_run_t, make_machine, settle_machine, run_up, flywheel_for, cycle_found, &
                            cycle_any_speed
   use psalm_motor_group, only: motor_group_t, motor_of
   use psalm_stop, only: stop_t, is_to_end
   implicit none (type, external)
   private
   public :: machine_study_t, find_machine

   type :: machine_study_t
      logical :: stopped = .false.           !! the host asked for the end; what is not marked below is not there
      logical :: turns = .false.             !! the crank turns fully, without a dead point, and J > 0: the rest is valid
      integer :: failure_at = 0              !! degrees from CRNKI, rounded: where it does not turn, or has no inertia
      logical :: massless = .false.          !! it has no inertia there
      real(wp) :: inertia_least = 0.0_wp, inertia_greatest = 0.0_wp !! kg m2, flywheel included
      type(cycle_t) :: cycle
      logical :: runs_up = .false.           !! a run-up was asked for
      type(machine_run_t) :: run
      logical :: wants_flywheel = .false.    !! a flywheel was asked for
      real(wp) :: flywheel = 0.0_wp          !! kg m2, for FLUCT; negative: there is none
   contains
      procedure :: is_complete
   end type machine_study_t

contains

   !> True if everything that was asked for was found.
   pure logical function is_complete(self)
      class(machine_study_t), intent(in) :: self

      is_complete = self%turns .and. (self%cycle%state == cycle_found .or. self%cycle%state == cycle_any_speed)
      if (is_complete .and. self%runs_up) is_complete = self%run%stopped_at < 0.0_wp .and. self%run%computed
      if (is_complete .and. self%wants_flywheel) is_complete = self%flywheel >= 0.0_wp
   end function is_complete

   !> Steady cycle, run-up and flywheel of a machine with a turning crank.
   !>
   !> Where the host ends it, the steady cycle is there if it was found; the run-up and the flywheel that were looked for are not.
   subroutine find_machine(set, given, model, study, stop)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: given
      type(force_model_t), intent(in) :: model
      type(machine_study_t), intent(out) :: study
      type(stop_t), intent(in), optional :: stop    !! asked now and then
      type(motor_group_t) :: motor
      class(problem_t), allocatable :: problem      ! large: it would fill a small stack
      type(machine_t), allocatable :: machine

      motor = motor_of(set)
      allocate (problem, source=given)
      allocate (machine)
      call make_machine(problem, model, motor, machine, stop=stop)
      study%stopped = is_to_end(stop)
      if (study%stopped) return
      call find_failure()
      if (study%turns) then
         call settle_machine(problem, model, set%rates%speed, machine, study%cycle, stop)
         study%stopped = is_to_end(stop)
         if (study%stopped) then
            study%turns = .false.
            return
         end if
         call find_failure()
      end if
      study%runs_up = motor%turns > 0
      study%wants_flywheel = motor%fluctuation > 0.0_wp
      if (.not. study%turns) return
      study%inertia_least = minval(machine%turn%inertia) + machine%flywheel
      study%inertia_greatest = maxval(machine%turn%inertia) + machine%flywheel
      if (study%runs_up) then
         call run_up(problem, model, machine, study%run, stop)
         study%stopped = is_to_end(stop)
         study%runs_up = .not. study%stopped
      end if
      if (study%wants_flywheel) then
         if (.not. study%stopped) call flywheel_for(machine, motor%fluctuation, set%rates%speed, study%flywheel, stop)
         study%stopped = is_to_end(stop)
         study%wants_flywheel = .not. study%stopped
      end if

   contains

      !> A node at which the crank does not turn, or nothing has inertia.
      subroutine find_failure()
         real(wp) :: degrees_of_node
         integer :: node

         degrees_of_node = full_turn/real(size(machine%turn%inertia) - 1, wp)
         node = machine%turn%failure
         if (node == 0) then
            node = findloc(machine%turn%inertia + machine%flywheel > 0.0_wp, .false., dim=1)
            study%massless = node > 0
         end if
         study%turns = node == 0
         if (.not. study%turns) study%failure_at = nint(degrees_of_node*real(node - 1, wp))
      end subroutine find_failure
   end subroutine find_machine
end module psalm_machine_study
