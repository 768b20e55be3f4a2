!> Verbs about rates, forces and what they bring about: motion from torque, balance, vibration, clearance.
module psalm_force_verbs
   use psalm_case, only: case_t, set_of
   use psalm_chain_report, only: report_outputs, report_still_drives
   use psalm_clearance_group, only: clearance_of
   use psalm_clearance_report, only: report_clearance
   use psalm_clearance_study, only: clearance_study_t, check_clearance, study_clearance => find_clearance
   use psalm_clearance_svg, only: write_clearance_svg
   use psalm_data_set, only: data_set_t
   use psalm_force_study, only: force_study_t, study_forces => find_forces
   use psalm_kinds, only: wp
   use psalm_machine_study, only: machine_study_t, study_machine => find_machine
   use psalm_muscle_report, only: report_muscle
   use psalm_muscle_study, only: muscle_study_t, check_muscle, study_muscle => find_muscle
   use psalm_position_table, only: put_rates, put_sketch
   use psalm_preparation, only: memory_need_t
   use psalm_rate_study, only: rate_study_t, study_rates => find_rates
   use psalm_report, only: report_rates
   use psalm_sketch_study, only: sketch_study_t, study_sketch
   use psalm_status, only: findings_t => diagnostics_t
   use psalm_steady_report, only: report_steady
   use psalm_steady_study, only: steady_study_t, check_steady, study_steady => find_steady
   use psalm_stop, only: stop_t, is_to_end
   use psalm_study_frame, only: frame_t, report_t, need_of_rates, warn, empty_motion
   use psalm_text, only: text_t
   use psalm_time_list, only: report_time
   use psalm_time_study, only: time_study_t, check_time, study_time => find_time, time_on_request
   implicit none (type, external)
   private
   public :: find_rates, find_forces, find_machine, find_time, find_balance, find_springs, find_vibration, find_clearance

   integer, parameter :: accelerations = 2     !! orders of rates in tables
   type(memory_need_t), parameter :: need_of_muscle = memory_need_t(position=4000, arc=1000)

contains

   !> Velocities, accelerations and jerks of a case as given.
   subroutine find_rates(case, rates, findings, report, brief, stop)
      type(case_t), intent(in) :: case
      type(rate_study_t), intent(out) :: rates            !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: inputs, outputs and joints with their rates
      logical, intent(in), optional :: brief              !! no listing
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; then there is no result
      type(frame_t) :: frame

      call no_rates(rates)
      call frame%begin(case, findings, report, need=need_of_rates, reader='kalm')
      if (.not. frame%ready) return
      call study_rates(frame%set, frame%problem, frame%problem%given, rates, stop=stop)
      if (is_to_end(stop)) then
         call no_rates(rates)
         call frame%end_early(report, findings)
         return
      end if
      call warn(frame%problem, rates%motion, findings)
      if (present(report)) call report_dynamics(frame, rates, report, findings, brief)
   end subroutine find_rates

   pure subroutine no_rates(rates)
      type(rate_study_t), intent(out) :: rates

      call empty_motion(rates%motion)
      allocate (rates%by_input(0, 0, 0), rates%by_time(0, 0, 0), rates%dead(0))
   end subroutine no_rates

   pure subroutine no_forces(forces)
      type(force_study_t), intent(out) :: forces

      allocate (forces%input(0), forces%table%value(0, 0))
   end subroutine no_forces

   !> Forces of a case with masses, loads or springs: drive, frame, every joint, at the positions of the case.
   !>
   !> With `by_unit_mass` also the inertia forces of unit masses, in which every force is linear: shape (positions, columns, 4,
   !> bodies), see `loads_of_unit_masses`. Columns:
   !> drive, force x and y and moment on the frame, two for each joint, then further drives.
   subroutine find_forces(case, forces, findings, report, by_unit_mass, brief, stop)
      type(case_t), intent(in) :: case
      type(force_study_t), intent(out) :: forces          !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: those of `find_rates` with the forces
      real(wp), allocatable, intent(out), optional :: by_unit_mass(:, :, :, :)
      logical, intent(in), optional :: brief              !! no listing
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; then there is no result
      type(frame_t) :: frame
      type(rate_study_t), allocatable :: rates

      call no_forces(forces)
      if (present(by_unit_mass)) allocate (by_unit_mass(0, 0, 0, 0))
      call frame%begin(case, findings, report, need=need_of_rates, reader='kalm')
      if (.not. frame%ready) return
      call study_dynamics(frame, present(report), rates, forces, stop, by_unit_mass)
      if (is_to_end(stop)) then
         call no_forces(forces)
         if (present(by_unit_mass)) by_unit_mass = by_unit_mass(:0, :0, :, :0)
         call frame%end_early(report, findings)
         return
      end if
      if (.not. forces%all_known()) call findings%warning('forces are not known at every position: the linkage does not '// &
                                                          'close, is at a dead point, friction locks it, or a gas '// &
                                                          'spring has no room left')
      if (.not. present(report)) return
      call report_dynamics(frame, rates, report, findings, brief, forces)
   end subroutine find_forces

   !> Motion from torque, the group MOTOR: steady cycle, run-up, flywheel.
   subroutine find_machine(case, machine, findings, report, stop)
      type(case_t), intent(in) :: case
      type(machine_study_t), intent(out) :: machine       !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: forces, and the cycle
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; the forces are there then, and the cycle
                                                          !! if it was found
      type(frame_t) :: frame
      type(rate_study_t), allocatable :: rates
      type(force_study_t), allocatable :: forces

      call frame%begin(case, findings, report, 'MOTOR', need=need_of_rates, reader='kalm')
      if (.not. frame%ready) return
      allocate (forces)
      call study_dynamics(frame, present(report), rates, forces, stop)
      if (is_to_end(stop)) then
         machine%stopped = .true.
         call frame%end_early(report, findings)
         return
      end if
      call study_machine(frame%set, frame%problem, forces%model, machine, stop)
      if (machine%stopped) then
         call findings%warning('the study was ended before it had found all of the motion from torque')
         call frame%devices%note_violation()
      end if
      if (.not. present(report)) return
      if (machine%stopped .and. .not. machine%turns) then
         call report_dynamics(frame, rates, report, findings, .false., forces)
      else
         call report_dynamics(frame, rates, report, findings, .false., forces, machine)
      end if
   end subroutine find_machine

   !> Motion in time, the groups TIME and STOPS.
   subroutine find_time(case, time, findings, report, stop)
      type(case_t), intent(in) :: case
      type(time_study_t), intent(out) :: time             !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: forces at the positions; motion, events, equilibria
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; the times so far are there
      type(frame_t) :: frame
      type(rate_study_t), allocatable :: rates
      type(force_study_t), allocatable :: forces

      call frame%begin(case, findings, report, 'TIME', need=need_of_rates, reader='kalm')
      if (.not. frame%ready) return
      call check_time(frame%set, frame%prepared%mechanism, frame%noted)
      if (frame%fails(findings)) return
      allocate (forces)
      call study_dynamics(frame, present(report), rates, forces, stop)
      if (is_to_end(stop)) then
         time%ended = time_on_request
         call frame%end_early(report, findings)
         return
      end if
      call study_time(frame%set, frame%problem, frame%problem%given, forces, time, stop)
      if (.not. present(report)) return
      call report_dynamics(frame, rates, report, findings, .false., forces, time=time)
   end subroutine find_time

   !> Forces, and rates if a report is to have them: what these have analysed serves the forces.
   subroutine study_dynamics(frame, with_rates, rates, forces, stop, by_unit_mass)
      type(frame_t), intent(inout) :: frame
      logical, intent(in) :: with_rates
      type(rate_study_t), allocatable, intent(out) :: rates  !! not allocated without them
      type(force_study_t), intent(inout) :: forces
      type(stop_t), intent(in), optional :: stop             !! what the host ends is of no use
      real(wp), allocatable, intent(inout), optional :: by_unit_mass(:, :, :, :) !! see `find_forces`

      if (with_rates) then
         allocate (rates)
         call study_rates(frame%set, frame%problem, frame%problem%given, rates, stop=stop)
         if (is_to_end(stop)) return
         call study_forces(frame%set, frame%problem, frame%problem%given, forces, by_unit_mass, rates%motion, stop)
      else
         call study_forces(frame%set, frame%problem, frame%problem%given, forces, by_unit_mass, stop=stop)
      end if
   end subroutine study_dynamics

   !> What kalm writes.
   subroutine report_dynamics(frame, rates, report, findings, brief, forces, machine, time)
      type(frame_t), intent(inout) :: frame
      type(rate_study_t), intent(in) :: rates
      type(report_t), intent(inout) :: report
      type(findings_t), intent(inout) :: findings
      logical, intent(in), optional :: brief
      type(force_study_t), intent(in), optional :: forces
      type(machine_study_t), intent(in), optional :: machine
      type(time_study_t), intent(in), optional :: time
      type(sketch_study_t) :: sketch
      logical :: short

      short = .false.
      if (present(brief)) short = brief
      if (frame%set%has_names()) then
         call study_sketch(frame%set, frame%problem, frame%problem%given, rates%motion%closed, frame%set%pace(), &
                           frame%set%change_of_pace(), sketch)
         call put_sketch(frame%set%sketch, sketch, accelerations, frame%devices%cases(1), forces)
         call report_still_drives(frame%set, frame%devices)
      end if
      if (short) then
         if (.not. frame%set%has_names()) call put_rates(frame%set%title, frame%set%rates%speed, frame%set%rates%accel, &
                                                          frame%problem, rates, .true., frame%devices%cases(1), forces)
      else
         call report_rates(frame%set, frame%problem, rates, frame%devices, forces, machine)
         if (frame%set%has_names()) call report_outputs(frame%set, sketch, rates%motion%beyond, accelerations, frame%devices)
      end if
      if (present(time)) call report_time(frame%set, frame%problem, time, frame%devices)
      if (rates%is_violating()) call frame%devices%note_violation()
      if (present(forces)) then
         if (.not. forces%all_known()) call frame%devices%note_violation()
      end if
      if (present(machine) .or. present(time)) then
         call frame%conclude(report, findings)
      else
         call frame%conclude(report)
      end if
   end subroutine report_dynamics

   !> Counterweights, the group BALANC; springs too, if the case has SPRNGS.
   subroutine find_balance(case, muscle, findings, report, stop)
      type(case_t), intent(in) :: case
      type(muscle_study_t), intent(out) :: muscle         !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables; the linkage with its weights
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; then there are no weights

      call find_what_balances(case, 'BALANC', muscle, findings, report, stop)
   end subroutine find_balance

   !> Springs, the group SPRNGS; counterweights too, if the case has BALANC.
   subroutine find_springs(case, muscle, findings, report, stop)
      type(case_t), intent(in) :: case
      type(muscle_study_t), intent(out) :: muscle         !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables; the linkage with its springs
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; the springs so far are there

      call find_what_balances(case, 'SPRNGS', muscle, findings, report, stop)
   end subroutine find_springs

   subroutine find_what_balances(case, group, muscle, findings, report, stop)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: group
      type(muscle_study_t), intent(inout) :: muscle
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report
      type(stop_t), intent(in), optional :: stop
      type(frame_t) :: frame

      call frame%begin(case, findings, report, group, need=need_of_muscle, reader='muscle')
      if (.not. frame%ready) return
      call check_muscle(frame%set, frame%prepared, frame%noted)
      if (frame%fails(findings)) return
      call study_muscle(frame%set, frame%problem, frame%prepared, muscle, stop)
      if (muscle%stopped .and. .not. allocated(muscle%springs)) then
         call frame%end_early(report, findings)
         return
      end if
      if (muscle%stopped) call frame%devices%note_violation()
      if (.not. present(report)) return
      call report_muscle(frame%set, frame%problem, frame%prepared, muscle, frame%devices)
      call frame%conclude(report, findings)
   end subroutine find_what_balances

   !> Vibration and stability: the groups ESTIM, VIBR, FLEX, DRIVEL and HILL; what a case asks for is allocated.
   subroutine find_vibration(case, steady, findings, report, stop)
      type(case_t), intent(in) :: case
      type(steady_study_t), intent(out) :: steady         !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: responses, boundaries of stability
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; what was found so far is there
      type(frame_t) :: frame
      class(data_set_t), allocatable :: set
      type(findings_t) :: unused
      logical :: alone                                     ! Hill's equation without a linkage

      call set_of(case, set, unused, 'ssics')
      alone = .not. unused%failed()
      if (alone) alone = set%loops() == 0 .and. set%gives('HILL')
      if (alone) then
         call frame%read(case, findings, report, reader='ssics')
         allocate (frame%prepared, frame%problem)
         call check_steady(frame%set, frame%prepared, frame%noted)
         if (frame%fails(findings)) return
      else
         call frame%begin(case, findings, report, need=need_of_rates, reader='ssics', does='ssics studies', turning=.true.)
         if (.not. frame%ready) return
         call check_steady(frame%set, frame%prepared, frame%noted)
         if (frame%fails(findings)) return
      end if
      call study_steady(frame%set, frame%problem, frame%prepared, steady, stop)
      if (steady%stopped) then
         if (steady%is_empty()) then
            call frame%end_early(report, findings)
            return
         end if
         call findings%warning('the study was ended before it had found all that the case asks for')
         call frame%devices%note_violation()
      end if
      if (.not. present(report)) return
      call report_steady(frame%set, frame%problem%mechanism, steady, frame%devices)
      call frame%conclude(report, findings)
   end subroutine find_vibration

   !> A joint with clearance, the group CLEAR: loss of contact, flight, impact.
   subroutine find_clearance(case, clearance, findings, report, stop)
      type(case_t), intent(in) :: case
      type(clearance_study_t), intent(out) :: clearance   !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: load of the joint, flights; files: .svg
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; then there is no result
      type(frame_t) :: frame
      type(text_t) :: picture

      call frame%begin(case, findings, report, need=need_of_rates, reader='bridge', does='bridge studies', turning=.true.)
      if (.not. frame%ready) return
      call check_clearance(frame%set, clearance_of(frame%set), frame%prepared, frame%noted)
      if (frame%fails(findings)) return
      call study_clearance(frame%set, clearance_of(frame%set), frame%problem, frame%prepared%mechanism, frame%prepared%given, &
                           clearance, stop)
      if (clearance%stopped) then
         call frame%end_early(report, findings)
         return
      end if
      if (.not. present(report)) return
      call report_clearance(frame%set, frame%prepared%mechanism, clearance, frame%devices)
      if (clearance%done) then
         call write_clearance_svg(frame%set%title, clearance, picture)
         call frame%devices%add_drawing('.svg', picture%content())
      end if
      call frame%conclude(report, findings)
   end subroutine find_clearance
end module psalm_force_verbs
