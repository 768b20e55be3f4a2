!> bridge: joints with clearance in planar linkages - following, loss of contact, flight, impact - from a namelist file.
program bridge
   use psalm_batch, only: outputs_t, common_options, json_option, parts_options, ending_of_case, run_files
   use psalm_check_list, only: list_input
   use psalm_clearance_group, only: clearance_group_t, clearance_of
   use psalm_clearance_report, only: report_clearance
   use psalm_clearance_study, only: clearance_study_t, check_clearance, find_clearance
   use psalm_clearance_svg, only: write_clearance_svg
   use psalm_console, only: arguments_t, begin
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, header_of
   use psalm_error, only: problem_t, make_problem
   use psalm_mark, only: mark_t
   use psalm_preparation, only: memory_need_t, prepared_t, prepare_loops
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_team, only: team_t
   use psalm_text, only: text_t
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   type(memory_need_t), parameter :: need = memory_need_t(position=1000, arc=400)
   ! saved: procedures that are handed on then need no code on the stack
   type(outputs_t), save :: outputs
   type(arguments_t), save :: arguments
   type(team_t), save, target :: team
   type(stop_t), save :: stop
   logical, save :: finished
   integer, save :: code

   call team%start()
   outputs = outputs_t(suffix='.bridge', endings=['.dev8', '.dev9'], of_search=[character(5) ::], &
                       of_case=['.svg '])
   call begin('bridge', &
      'usage: bridge [options] [CASE.nml ...]'//nl// &
      nl//'A revolute joint with clearance (&CLEAR): where its pin loses contact with its hole, its flight and impact.'//nl// &
      'Masses and loads come from &MASSES, &LOADS, &SPRING, the speed from &RATES.'//nl// &
      nl//'The listing goes to standard output; CASE.bridge.dev8 (input), CASE.bridge.dev9 (blocks) and CASE.bridge.svg'//nl// &
      '(load, force of contact, lag; with NCRAD the standard charts) in the folder of the case.'//nl// &
      nl//json_option// &
      parts_options// &
      common_options// &
      nl//'Exit status: 0 done; 1 done, but contact is lost, or cannot be studied; 2 the input is wrong; 3 a file could'//nl// &
      'not be read or written.'//nl, &
      outputs%suffix//outputs%endings, arguments, finished)
   code = arguments%code
   if (finished) call team%leave(code)
   team%shares = team%shares .or. arguments%parts > 0 .or. arguments%merge .or. arguments%so_far .or. arguments%every > 0
   if (team%shares) call stop%share_with(team)
   call run_files(arguments, outputs, prepare_clearance, run_case, code, team, why_undivided)
   call team%leave(code)

contains

   !> Why the work of these cases cannot be divided into parts; empty: it can.
   function why_undivided(sets) result(reason)
      type(data_set_t), intent(in) :: sets(:)
      character(:), allocatable :: reason
      type(clearance_group_t) :: clearance
      integer :: k

      reason = 'there is no numbered work in it: charts (NCRAD of &CLEAR)'
      do k = 1, size(sets)
         clearance = clearance_of(sets(k))
         if (clearance%radii > 0) reason = ''
      end do
   end function why_undivided

   subroutine prepare_clearance(file, set, prepared, findings, mark)
      character(*), intent(in) :: file
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(inout) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(mark_t), intent(inout) :: mark

      associate (unused => file, also_unused => mark)
      end associate
      call prepare_loops('bridge studies', need, set, prepared, findings, turning=.true.)
      if (.not. findings%failed()) call check_clearance(set, clearance_of(set), prepared, findings)
   end subroutine prepare_clearance

   subroutine run_case(number, set, prepared, devices, stopped)
      integer, intent(in) :: number
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(devices_t), intent(inout) :: devices
      logical, intent(inout) :: stopped
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(clearance_study_t) :: study
      type(text_t) :: picture

      associate (unused => stopped)
      end associate
      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call list_input(header_of('BRIDGE', devices%mark), set, problem, devices%eight)
      call find_clearance(set, clearance_of(set), problem, prepared%mechanism, prepared%given, study, stop)
      call report_clearance(set, prepared%mechanism, study, devices)
      if (.not. study%done) return
      call write_clearance_svg(set%title, study, picture)
      call devices%add_drawing(trim(ending_of_case(number, '.svg')), picture%content())
   end subroutine run_case
end program bridge
