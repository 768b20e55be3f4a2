!> muscle: counterweights and springs for planar linkages, from a namelist file.
program muscle
   use psalm_batch, only: outputs_t, common_options, json_option, run_files
   use psalm_check_list, only: list_input
   use psalm_console, only: arguments_t, begin
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, header_of
   use psalm_error, only: problem_t, make_problem
   use psalm_mark, only: mark_t
   use psalm_muscle_report, only: report_muscle
   use psalm_muscle_study, only: muscle_study_t, check_muscle, find_muscle
   use psalm_preparation, only: memory_need_t, prepared_t, prepare_loops
   use psalm_status, only: diagnostics_t
   use psalm_system, only: finish_program
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   type(memory_need_t), parameter :: need = memory_need_t(position=4000, arc=1000)
   ! saved: procedures that are handed on then need no code on the stack
   type(outputs_t), save :: outputs
   type(arguments_t), save :: arguments
   logical, save :: finished
   integer, save :: code

   outputs = outputs_t(suffix='.muscle', endings=['.dev7', '.dev8', '.dev9'], of_search=[character(5) ::])
   call begin('muscle', &
      'usage: muscle [options] [CASE.nml ...]'//nl// &
      nl//'Counterweights (&BALANC): complete force balance - whether it is possible, on which links, with what masses -'//nl// &
      'and weights that make a composite of shaking force, shaking moment, drive torque, joint loads and mass least.'//nl// &
      'Springs (&SPRNGS) that make the range or RMS of the drive torque, or of the load of a joint, least.'//nl// &
      nl//'The listing goes to standard output; CASE.muscle.dev7 (the case with weights and springs, for kalm and balm),'//nl// &
      'CASE.muscle.dev8 (input) and CASE.muscle.dev9 (blocks) in the folder of the case.'//nl// &
      nl//json_option// &
      common_options// &
      nl//'Exit status: 0 done; 1 done, but what was asked for is impossible or not within the limits;'//nl// &
      '2 the input is wrong; 3 a file could not be read or written.'//nl, &
      outputs%suffix//outputs%endings, arguments, finished)
   code = arguments%code
   if (finished) call finish_program(code)
   call run_files(arguments, outputs, prepare_muscle, run_case, code)
   call finish_program(code)

contains

   subroutine prepare_muscle(file, set, prepared, findings, mark)
      character(*), intent(in) :: file
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(inout) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(mark_t), intent(inout) :: mark

      associate (unused => file, also_unused => mark)
      end associate
      call prepare_loops('muscle balances', need, set, prepared, findings)
      if (.not. findings%failed()) call check_muscle(set, prepared, findings)
   end subroutine prepare_muscle

   subroutine run_case(number, set, prepared, devices, stopped)
      integer, intent(in) :: number
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(devices_t), intent(inout) :: devices
      logical, intent(inout) :: stopped
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(muscle_study_t), allocatable :: study

      associate (unused => stopped, also_unused => number)
      end associate
      allocate (problem, study)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call list_input(header_of('MUSCLE', devices%mark), set, problem, devices%eight)
      call find_muscle(set, problem, prepared, study)
      call report_muscle(set, problem, prepared, study, devices)
   end subroutine run_case
end program muscle
