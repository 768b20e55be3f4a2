!> kalm: velocities and accelerations of planar linkages from a namelist file.
program kalm
   use psalm_batch, only: csv_of_sketches, outputs_t, common_options, json_option, run_files
   use psalm_console, only: arguments_t, begin
   use psalm_check_list, only: list_input
   use psalm_chain_proof_study, only: chain_proof_t, prove_loops
   use psalm_chain_report, only: report_chain_proof, report_outputs, report_still_drives
   use psalm_chain_study, only: chain_study_t
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, header_of
   use psalm_error, only: problem_t, make_problem
   use psalm_force_model, only: forces_wanted
   use psalm_force_study, only: force_study_t, find_forces
   use psalm_machine_study, only: machine_study_t, find_machine
   use psalm_mark, only: mark_t
   use psalm_position_table, only: put_sketch
   use psalm_preparation, only: memory_need_t, prepared_t, prepare
   use psalm_proof_study, only: proof_study_t, study_proof, proof_wanted, no_proof
   use psalm_rate_study, only: rate_study_t, find_rates
   use psalm_report, only: most_summarised, report_proof, report_rates, report_summary
   use psalm_sketch_study, only: sketch_study_t, study_sketch
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_summary, only: summary_t, summarise
   use psalm_system, only: finish_program
   use psalm_time_list, only: report_time, summarise_time
   use psalm_time_study, only: time_study_t, check_time, find_time
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   integer, parameter :: accelerations = 2     ! orders of rates in the table
   type(memory_need_t), parameter :: need = memory_need_t(position=1000, arc=400)
   ! saved: procedures that are handed on then need no code on the stack
   type(outputs_t), save :: outputs
   type(arguments_t), save :: arguments
   logical, save :: finished
   integer, save :: code

   outputs = outputs_t(suffix='.kalm', endings=['.dev8', '.dev9'], of_search=[character(5) ::], csv=csv_of_sketches)
   call begin('kalm', &
      'usage: kalm [options] [CASE.nml ...]'//nl// &
      nl//'Displacement, velocity, acceleration and jerk of the output of each case, at its positions. The group'//nl// &
      '&RATES gives the SPEED, ACCEL and UNITS of the input; without it the input moves at 1 rad/s or 1 length/s.'//nl// &
      nl//'With a group &MASSES, &LOADS or &SPRING: torque or force of the drive, force in every joint, force and'//nl// &
      'moment on the frame; with &MOTOR: steady cycle, run-up, flywheel; with &TIME: motion in time.'//nl// &
      nl//'The listing goes to standard output; CASE.kalm.dev8 (input; with KTHETA=1 all arcs and joints) and'//nl// &
      'CASE.kalm.dev9 in the folder of the case.'//nl// &
      nl//json_option// &
      common_options// &
      nl//'Exit status: 0 done; 1 done, but the linkage does not close somewhere or passes a dead point;'//nl// &
      '2 the input is wrong; 3 a file could not be read or written.'//nl, &
      outputs%suffix//outputs%endings, arguments, finished)
   code = arguments%code
   if (finished) call finish_program(code)
   call run_files(arguments, outputs, prepare_rates, run_case, code)
   call finish_program(code)

contains

   subroutine prepare_rates(file, set, prepared, findings, mark)
      character(*), intent(in) :: file
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(inout) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(mark_t), intent(inout) :: mark
      type(line_t) :: none(0)

      associate (unused => file, also_unused => mark)
      end associate
      if (.not. findings%failed()) call prepare(set, none, prepared, findings, need)
      if (.not. findings%failed()) call check_time(set, prepared%mechanism, findings)
      prepared%ready = prepared%ready .and. .not. findings%failed()
   end subroutine prepare_rates

   subroutine run_case(number, set, prepared, devices, stopped)
      integer, intent(in) :: number
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(devices_t), intent(inout) :: devices
      logical, intent(inout) :: stopped
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(rate_study_t), allocatable :: rates
      type(force_study_t), allocatable :: forces     ! absent arguments unless the case asks for them
      type(machine_study_t), allocatable :: machine
      type(time_study_t), allocatable :: time
      type(proof_study_t), allocatable :: proof
      type(summary_t) :: summary
      type(sketch_study_t) :: sketch

      associate (unused => stopped, also_unused => number)
      end associate
      allocate (problem, rates)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call list_input(header_of('KALM', devices%mark), set, problem, devices%eight)
      call find_rates(set, problem, prepared%given, rates)
      if (forces_wanted(set)) then
         allocate (forces)
         call find_forces(set, problem, prepared%given, forces, analysed=rates%motion)
         if (set%gives('TIME')) then
            allocate (time)
            call find_time(set, problem, prepared%given, forces, time)
         else if (set%gives('MOTOR')) then
            allocate (machine)
            call find_machine(set, problem, forces%model, machine)
         end if
      end if
      if (set%has_names()) then
         call study_sketch(set, problem, prepared%given, rates%motion%closed, set%pace(), set%change_of_pace(), sketch)
         call put_sketch(set%sketch, sketch, accelerations, devices%cases(devices%last_case()), forces)
         call report_still_drives(set, devices)
      end if
      call report_rates(set, problem, rates, devices, forces, machine)
      if (set%has_names()) call report_outputs(set, sketch, rates%motion%beyond, accelerations, devices)
      if (allocated(time)) call report_time(set, problem, time, devices)
      if (proof_wanted(set, .false.) /= no_proof .and. set%is_beyond_arrays()) then
         call prove_sketch(set, devices)
      else if (proof_wanted(set, .false.) /= no_proof) then
         allocate (proof)
         call study_proof(set, problem, prepared%given, proof_wanted(set, .false.), proof)
         call report_proof(set, problem%mechanism, proof, devices)
      end if
      if (.not. arguments%json .and. (arguments%quiet .or. devices%summarised == most_summarised)) return
      call summarise(set, problem, prepared%given, rates%motion, summary)
      if (set%has_names()) then
         call report_summary(set, problem%mechanism, summary, rates%motion, devices, sketch)
      else
         call report_summary(set, problem%mechanism, summary, rates%motion, devices)
      end if
      if (allocated(time)) call summarise_time(problem, time, devices%summary)
   end subroutine run_case

   !> The proof of a sketch with a larger group, which is made in the poses of its links.
   subroutine prove_sketch(set, devices)
      type(data_set_t), intent(in) :: set
      type(devices_t), intent(inout) :: devices
      type(chain_study_t), allocatable :: study
      type(chain_proof_t), allocatable :: proof
      logical :: valid

      allocate (study, proof)
      call prove_loops(set, proof_wanted(set, .false.), study, proof, valid)
      if (valid) call report_chain_proof(set, study, proof, devices)
   end subroutine prove_sketch
end program kalm
