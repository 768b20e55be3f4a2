!> psalm: displacement analysis and dimensional synthesis of planar linkages from a namelist file.
program psalm
   use psalm_console, only: arguments_t, progress_t, begin, begin_mark, device4_of, prepare_outputs, show_findings, stem_of, &
                            write_devices
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_kinds, only: wp
   use psalm_mark, only: mark_t
   use psalm_run, only: devices_t, check_case, run_case
   use psalm_signals, only: signals_t, shield_threads
   use psalm_source, only: line_t, read_lines
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_system, only: finish_program, threads_to_be_had, write_standard_error
   implicit none (type, external)

   !> Vertices of one case, from device 4.
   type :: supply_t
      real(wp), allocatable :: vertices(:, :)
   end type supply_t

   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: endings(*) = [character(5) :: '.dev7', '.dev8', '.dev9', '.dev1', '.dev2']
   integer, parameter :: of_analysis = 3 !! of these
   type(arguments_t) :: arguments
   logical :: finished
   integer :: code, i
   logical :: interrupted = .false. !! a signal came: what is left is not begun

   call begin('psalm', &
      'usage: psalm [options] [CASE.nml ...]'//nl// &
      nl//'Analyses the linkage of each case, or searches for better dimensions where the case has variables.'//nl// &
      'Without a file, or with -, the case is read from standard input.'//nl// &
      nl//'The listing goes to standard output; CASE.dev1, .dev2, .dev7, .dev8 and .dev9 beside the case.'//nl// &
      nl//'  --output-dir DIR  put the device files into DIR'//nl// &
      '  --device4 FILE    read supplied vertices (NGUESS) from FILE; default CASE.dev4'//nl// &
      '  --threads N       threads that share the work; default THREADS of the case, or 1'//nl// &
      '  --quiet           no remarks on standard error, errors only'//nl// &
      '  --version         print the version'//nl// &
      '  --help            print this text'//nl// &
      nl//'Exit status: 0 done; 1 done, but limits are violated or the search stopped before converging;'//nl// &
      '2 the input is wrong; 3 a file could not be read or written.'//nl, &
      endings, arguments, finished)
   code = arguments%code
   if (finished) call finish_program(code)
   do i = 1, size(arguments%files)
      call run_file(trim(arguments%files(i)))
      if (interrupted .or. arguments%no_place) exit
   end do
   call finish_program(code)

contains

   subroutine run_file(file)
      character(*), intent(in) :: file
      type(diagnostics_t) :: findings
      type(data_set_t), allocatable :: sets(:)
      type(supply_t), allocatable :: supplies(:)
      type(line_t), allocatable :: device4(:)
      type(devices_t) :: devices
      type(signals_t), target :: signals
      type(stop_t) :: stop
      type(progress_t) :: monitor
      type(mark_t) :: mark
      character(:), allocatable :: stem
      logical :: ready
      integer :: k, l

      mark = begin_mark(arguments%program)
      call read_data_sets(file, sets, findings, mark=mark)
      allocate (supplies(size(sets)), device4(0))
      do k = 1, size(sets)
         if (sets(k)%nguess > 0) then
            call read_lines(device4_of(arguments, file), device4, findings)
            do l = 1, size(device4)
               call mark%add(device4(l)%text)
            end do
         end if
         if (.not. findings%failed()) call check_case(sets(k), device4, supplies(k)%vertices, findings)
      end do
      if (findings%failed() .or. .not. arguments%quiet) call show_findings(findings)
      code = max(code, findings%exit_code())
      if (findings%failed()) return
      stem = stem_of(file, arguments%output_dir)
      k = of_analysis
      if (any([(sets(l)%wants_search(), l=1, size(sets))])) k = size(endings)
      call prepare_outputs(arguments, stem, endings(:k), ready, code)
      if (.not. ready) return
      devices%mark = mark%name()
      devices%wants_summary = .not. arguments%quiet
      call stop%listen_to(signals)
      do k = 1, size(sets)
         call prepare_signals(sets(k), signals)
         call run_case(sets(k), supplies(k)%vertices, arguments%threads, stop, devices, monitor)
         interrupted = signals%asked()
         if (interrupted) exit
      end do
      if (monitor%active) call write_standard_error(nl)
      if (.not. arguments%quiet) call write_standard_error(devices%notes%content()//devices%summary%content())
      code = max(code, devices%code)
      call write_devices(arguments, stem, devices, code)
      call signals%release()
   end subroutine run_file

   !> A case with a search or a sample has something to lose: signals wait until it is written. Threads take none.
   subroutine prepare_signals(set, signals)
      type(data_set_t), intent(in) :: set
      type(signals_t), intent(inout) :: signals
      integer :: threads

      threads = threads_to_be_had(merge(arguments%threads, max(1, set%search%threads), arguments%threads > 0))
      if (threads > 1) call shield_threads(threads)
      if (set%wants_search() .or. set%ntrial > 0) call signals%hold(threads)
   end subroutine prepare_signals
end program psalm
