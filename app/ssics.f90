!> ssics: steady state and stability of the drives and links of planar linkages, from a namelist file.
program ssics
   use psalm_cases, only: read_cases
   use psalm_check_list, only: list_input
   use psalm_console, only: arguments_t, begin, begin_mark, prepare_outputs, show_findings, stem_of, write_devices
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, header_of
   use psalm_error, only: problem_t, make_problem
   use psalm_mark, only: mark_t
   use psalm_preparation, only: demand_t, prepared_t, prepare
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_steady_report, only: report_steady
   use psalm_steady_study, only: steady_study_t, check_steady, find_steady
   use psalm_system, only: finish_program, write_standard_error
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: endings(*) = [character(5) :: '.dev8', '.dev9']
   type(demand_t), parameter :: demand = demand_t(position=1000, arc=400)
   type(arguments_t) :: arguments
   logical :: finished
   integer :: code, i

   call begin('ssics', &
      'usage: ssics [options] [CASE.nml ...]'//nl// &
      nl//'Steady state and stability: bending of links (&ESTIM, &VIBR), flexible drives (&DRIVEL), and any forced'//nl// &
      'Hill equation given by tables (&HILL). Masses and loads come from &MASSES, &LOADS, &SPRING, the speed from &RATES.'//nl// &
      nl//'The listing goes to standard output; CASE.ssics.dev8 (input) and CASE.ssics.dev9 (blocks) beside the case.'//nl// &
      nl//'  --output-dir DIR  put the device files into DIR'//nl// &
      '  --quiet           no remarks on standard error, errors only'//nl// &
      '  --version         print the version'//nl// &
      '  --help            print this text'//nl// &
      nl//'Exit status: 0 done; 1 done, but a motion is unstable, a link buckles, or the crank cannot turn;'//nl// &
      '2 the input is wrong; 3 a file could not be read or written.'//nl, &
      '.ssics'//endings, arguments, finished)
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
      call read_cases(file, sets, findings, program='ssics', mark=mark)
      allocate (prepared(size(sets)))
      do k = 1, size(sets)
         sets(k)%nguess = 0
         if (allocated(sets(k)%no_loops)) then
            call findings%error('ssics studies dyads with one drive on the frame, but this sketch has '//sets(k)%no_loops, &
                                line=sets(k)%title_line, group='CHAIN')
         end if
         if (sets(k)%nloop == 0) cycle ! Hill's equation alone
         if (.not. findings%failed()) call prepare(sets(k), none, prepared(k), findings, demand)
         if (.not. findings%failed()) call check_steady(sets(k), prepared(k), findings)
      end do
      if (findings%failed() .or. .not. arguments%quiet) call show_findings(findings)
      code = max(code, findings%exit_code())
      if (findings%failed()) return
      stem = stem_of(file, arguments%output_dir)//'.ssics'
      call prepare_outputs(arguments, stem, endings, ready, code)
      if (.not. ready) return
      devices%mark = mark%name()
      do k = 1, size(sets)
         call run_case(sets(k), prepared(k), devices)
      end do
      if (.not. arguments%quiet) call write_standard_error(devices%notes%content())
      code = max(code, devices%code)
      call write_devices(arguments, stem, devices, code)
   end subroutine run_file

   subroutine run_case(set, prepared, devices)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(devices_t), intent(inout) :: devices
      type(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(steady_study_t) :: study

      allocate (problem)
      if (set%nloop > 0) then
         call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
         call list_input(header_of('SSICS', devices%mark), set, problem, devices%eight)
      else
         call devices%eight%add(header_of('SSICS', devices%mark))
         call devices%eight%add(' '//set%title)
      end if
      call find_steady(set, problem, prepared, study)
      call report_steady(set, study, devices)
   end subroutine run_case
end program ssics
