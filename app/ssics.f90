!> ssics: steady state and stability of the drives and links of planar linkages, from a namelist file.
program ssics
   use psalm_batch, only: outputs_t, common_options, json_option, run_file
   use psalm_check_list, only: list_input
   use psalm_console, only: arguments_t, begin, prepare_outputs, stem_of
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, header_of
   use psalm_drawing, only: picture_t, draw_steady
   use psalm_error, only: problem_t, make_problem
   use psalm_mark, only: mark_t
   use psalm_picture_files, only: write_pictures
   use psalm_preparation, only: memory_need_t, prepared_t, prepare_loops
   use psalm_status, only: diagnostics_t
   use psalm_steady_report, only: report_steady
   use psalm_steady_study, only: steady_study_t, check_steady, find_steady
   use psalm_system, only: finish_program
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   character(11), parameter :: of_curves = '.curves.svg'
   type(memory_need_t), parameter :: need = memory_need_t(position=1000, arc=400)
   ! saved: procedures that are handed on then need no code on the stack
   type(outputs_t), save :: outputs
   type(arguments_t), save :: arguments
   type(picture_t), allocatable, save :: pictures(:) ! of the cases of a file
   character(:), allocatable, save :: stem          ! of the file's devices
   logical, save :: finished
   integer, save :: code, i

   outputs = outputs_t(suffix='.ssics', endings=['.dev8', '.dev9'], of_search=[character(5) ::])
   call begin('ssics', &
      'usage: ssics [options] [CASE.nml ...]'//nl// &
      nl//'Steady state and stability: bending of links (&ESTIM, &VIBR, &FLEX), flexible drives (&DRIVEL), and any forced'//nl// &
      'Hill equation given by tables (&HILL). Masses and loads come from &MASSES, &LOADS, &SPRING, the speed from &RATES.'//nl// &
      nl//'The listing goes to standard output; CASE.ssics.dev8 (input) and CASE.ssics.dev9 (blocks) in the '// &
      'folder of the case.'//nl// &
      nl//'  --curves          curves too: CASE.ssics.curves.svg'//nl// &
      json_option// &
      common_options// &
      nl//'Exit status: 0 done; 1 done, but a motion is unstable, a link buckles, or the crank cannot turn;'//nl// &
      '2 the input is wrong; 3 a file could not be read or written.'//nl, &
      outputs%suffix//[character(len(of_curves)) :: outputs%endings, of_curves], arguments, finished)
   code = arguments%code
   if (finished) call finish_program(code)
   do i = 1, size(arguments%files)
      pictures = [picture_t ::]
      stem = stem_of(trim(arguments%files(i)), arguments%output_dir)//outputs%suffix
      call run_file(arguments, trim(arguments%files(i)), outputs, prepare_steady, run_case, code)
      if (size(pictures) > 0) call draw()
      if (arguments%no_place) exit
   end do
   call finish_program(code)

contains

   subroutine prepare_steady(file, set, prepared, findings, mark)
      character(*), intent(in) :: file
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(inout) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(mark_t), intent(inout) :: mark

      associate (unused => file, also_unused => mark)
      end associate
      if (set%loops() > 0) call prepare_loops('ssics studies', need, set, prepared, findings, turning=.true.)
      if (.not. findings%failed()) call check_steady(set, prepared, findings)
   end subroutine prepare_steady

   subroutine run_case(number, set, prepared, devices, stopped)
      integer, intent(in) :: number
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(devices_t), intent(inout) :: devices
      logical, intent(inout) :: stopped
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(steady_study_t) :: study

      associate (unused => stopped)
      end associate
      allocate (problem)
      if (set%loops() > 0) then
         call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
         call list_input(header_of('SSICS', devices%mark), set, problem, devices%eight)
      else
         call devices%eight%add(header_of('SSICS', devices%mark))
         call devices%eight%add(' '//set%title)
      end if
      call find_steady(set, problem, prepared, study)
      call report_steady(set, problem%mechanism, study, devices)
      if (arguments%curves) call draw_steady(set, study, number, devices%mark, pictures)
   end subroutine run_case

   !> The curves of a file.
   subroutine draw()
      logical :: ready

      call prepare_outputs(arguments, stem, pictures%ending, ready, code)
      if (ready) call write_pictures(arguments, stem, pictures, code)
   end subroutine draw
end program ssics
