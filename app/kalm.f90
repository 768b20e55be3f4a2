!> kalm: velocities and accelerations of planar linkages from a namelist file.
program kalm
   use psalm_console, only: arguments_t, begin, begin_mark, prepare_outputs, show_findings, stem_of, write_devices
   use psalm_check_list, only: list_input
   use psalm_chain_report, only: report_chain, report_chain_csv
   use psalm_chain_study, only: chain_study_t, study_chain
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, header_of
   use psalm_error, only: problem_t, make_problem
   use psalm_force_model, only: forces_wanted
   use psalm_force_study, only: force_study_t, find_forces
   use psalm_machine_study, only: machine_study_t, find_machine
   use psalm_mark, only: mark_t
   use psalm_preparation, only: demand_t, prepared_t, prepare
   use psalm_rate_study, only: rate_study_t, find_rates
   use psalm_report, only: most_summarised, report_rates, report_summary
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_summary, only: summary_t, summarise
   use psalm_system, only: finish_program, write_standard_error
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: endings(*) = [character(5) :: '.dev8', '.dev9']
   type(demand_t), parameter :: demand = demand_t(position=1000, arc=400)
   type(arguments_t) :: arguments
   logical :: finished
   integer :: code, i

   call begin('kalm', &
      'usage: kalm [options] [CASE.nml ...]'//nl// &
      nl//'Displacement, velocity, acceleration and jerk of the output of each case, at its positions. The group'//nl// &
      '&RATES gives the SPEED, ACCEL and UNITS of the input; without it the input moves at 1 rad/s or 1 length/s.'//nl// &
      nl//'With a group &MASSES, &LOADS or &SPRING: torque or force of the drive, force in every joint, force and'//nl// &
      'moment on the frame; with &MOTOR: steady cycle, run-up, flywheel.'//nl// &
      nl//'The listing goes to standard output; CASE.kalm.dev8 (input; with KTHETA=1 all arcs and joints) and'//nl// &
      'CASE.kalm.dev9 beside the case.'//nl// &
      nl//'  --output-dir DIR  put the device files into DIR'//nl// &
      '  --quiet           no remarks on standard error, errors only'//nl// &
      '  --version         print the version'//nl// &
      '  --help            print this text'//nl// &
      nl//'Exit status: 0 done; 1 done, but the linkage does not close somewhere or passes a dead point;'//nl// &
      '2 the input is wrong; 3 a file could not be read or written.'//nl, &
      '.kalm'//endings, arguments, finished)
   code = arguments%code
   if (finished) call finish_program(code)
   do i = 1, size(arguments%files)
      call run_file(trim(arguments%files(i)))
      if (arguments%no_place) exit
   end do
   call finish_program(code)

contains

   subroutine run_file(file)
      character(*), intent(in) :: file
      type(diagnostics_t) :: findings
      type(data_set_t), allocatable :: sets(:)
      type(line_t) :: none(0)
      type(prepared_t), allocatable :: prepared(:)
      type(devices_t) :: devices
      type(mark_t) :: mark
      character(:), allocatable :: stem
      logical :: ready
      integer :: k

      mark = begin_mark(arguments%program)
      call read_cases(file, sets, findings, program='kalm', mark=mark)
      allocate (prepared(size(sets)))
      do k = 1, size(sets)
         sets(k)%nguess = 0
         if (.not. findings%failed()) call prepare(sets(k), none, prepared(k), findings, demand)
      end do
      if (findings%failed() .or. .not. arguments%quiet) call show_findings(findings)
      code = max(code, findings%exit_code())
      if (findings%failed()) return
      stem = stem_of(file, arguments%output_dir)//'.kalm'
      call prepare_outputs(arguments, stem, endings, ready, code)
      if (ready .and. any([(sets(k)%sketch%given, k=1, size(sets))])) then
         call prepare_outputs(arguments, stem, ['.csv'], ready, code)
      end if
      if (.not. ready) return
      devices%mark = mark%name()
      do k = 1, size(sets)
         call run_case(sets(k), prepared(k), devices)
      end do
      if (.not. arguments%quiet) call write_standard_error(devices%notes%content()//devices%summary%content())
      code = max(code, devices%code)
      call write_devices(arguments, stem, devices, code)
   end subroutine run_file

   subroutine run_case(set, prepared, devices)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(devices_t), intent(inout) :: devices
      type(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(rate_study_t), allocatable :: rates
      type(force_study_t), allocatable :: forces     ! absent arguments unless the case asks for them
      type(machine_study_t), allocatable :: machine
      type(summary_t) :: summary

      if (set%sketch%given) call run_sketch(set, devices)
      if (allocated(set%no_loops)) return
      allocate (problem, rates)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call list_input(header_of('KALM', devices%mark), set, problem, devices%eight)
      call find_rates(set, problem, prepared%given, rates)
      if (forces_wanted(set)) then
         allocate (forces)
         call find_forces(set, problem, prepared%given, forces)
         if (set%motor%given) then
            allocate (machine)
            call find_machine(set, problem, forces%model, machine)
         end if
      end if
      call report_rates(set, problem, rates, devices, forces, machine)
      if (arguments%quiet .or. devices%summarised == most_summarised) return
      call summarise(problem, prepared%given, rates%motion, summary)
      call report_summary(set, summary, devices)
   end subroutine run_case

   !> All outputs and joints of a sketch with their rates; one without loops has nothing else.
   subroutine run_sketch(set, devices)
      type(data_set_t), intent(in) :: set
      type(devices_t), intent(inout) :: devices
      type(chain_study_t), allocatable :: study
      integer, parameter :: accelerations = 2

      allocate (study)
      call study_chain(set, set%speed, set%accel, study)
      call report_chain_csv(set, study, accelerations, devices)
      if (allocated(set%no_loops)) call report_chain('KALM', set, study, accelerations, devices)
   end subroutine run_sketch
end program kalm
