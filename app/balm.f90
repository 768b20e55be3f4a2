!> balm: pictures of planar linkages from a namelist file.
program balm
   use psalm_batch, only: common_options
   use psalm_console, only: arguments_t, begin, begin_mark, prepare_outputs, show_findings, stem_of
   use psalm_board, only: write_board
   use psalm_cases, only: read_cases, read_case_text
   use psalm_contact_sheet, only: write_contact_sheet
   use psalm_data_set, only: data_set_t, title_columns
   use psalm_devices, only: devices_t
   use psalm_drawing, only: picture_t, add_picture, draw_file, draw_curves, draw_phase, ending
   use psalm_picture_files, only: write_pictures, name_of
   use psalm_mark, only: mark_t
   use psalm_picture_report, only: report_picture
   use psalm_picture_study, only: make_scenes
   use psalm_pictured, only: pictured_t
   use psalm_robot_files, only: draw_models
   use psalm_source, only: joined, line_t, read_lines
   use psalm_status, only: diagnostics_t, exit_done, exit_file_error
   use psalm_system, only: finish_program, write_standard_error
   use psalm_text, only: text_t
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: endings(*) = [character(15) :: '.svg', '.html', '.dxf', '.flat.dxf', '.curves.svg', &
                                           '.edit.html', '.move.svg', '.sheet.html', '.mjcf.xml', '.sdf', '.urdf', &
                                           '.tolerances.svg', '.phase.svg', '.freecad.py', '.urdf.json']
   type(arguments_t) :: arguments
   logical :: finished
   integer :: code, i

   call begin('balm', &
      'usage: balm [options] [CASE.nml ...]'//nl// &
      '       balm --edit [options] [CASE.nml ...]'//nl// &
      nl//'Pictures of each case: CASE.svg, the linkage at its reference position with joints and output at every'//nl// &
      'position; CASE.html, a page on which it moves; CASE.dxf for CAD (&DXF). Further cases get CASE.2.svg and'//nl// &
      'so on; the page has them all. With &ALLOC CASE.tolerances.svg too. The linkage is drawn as given, no search'//nl// &
      'is made: for its result draw CASE.dev7.'//nl// &
      nl//'  --edit            the drawing board instead: CASE.edit.html, a page on which the sketch of a case is'//nl// &
      '                    changed and saved; without a case sketch.edit.html, empty'//nl// &
      '  --curves          curves too: CASE.curves.svg; convergence from CASE.dev1'//nl// &
      '  --assemblies      the SVG shows the other assembly of each dyad in grey'//nl// &
      '  --animate         CASE.move.svg too: the linkage moves, without a script'//nl// &
      '  --phase           phase planes too, of a motion in time: CASE.phase.svg, each free drive''s speed over its place'//nl// &
      '  --sheet           CASE.sheet.html too: all cases of the file moving on one page (with --animate)'//nl// &
      '  --mjcf            CASE.mjcf.xml too: the links as bodies with their masses and joints, for MuJoCo'//nl// &
      '  --sdf             CASE.sdf too: the same for Gazebo'//nl// &
      '  --urdf            CASE.urdf too: the same for ROS; joints that close loops stand in a tag for Gazebo;'//nl// &
      '                    CASE.urdf.json: the joints as polynomials of the drive, over the range that is proven'//nl// &
      '  --freecad         CASE.freecad.py too: a script with which FreeCAD makes solids of the links (&PLATES)'//nl// &
      common_options// &
      nl//'Exit status: 0 done; 1 done, but the linkage violates closure or transmission limits; 2 the input is wrong'//nl// &
      '(the pictures show the messages); 3 a file could not be read or written.'//nl, &
      endings, arguments, finished)
   code = arguments%code
   if (finished) call finish_program(code)
   do i = 1, size(arguments%files)
      if (arguments%edit) then
         call make_board(trim(arguments%files(i)))
      else
         call run_file(trim(arguments%files(i)))
      end if
      if (arguments%no_place) exit
   end do
   call finish_program(code)

contains

   subroutine run_file(file)
      character(*), intent(in) :: file
      type(diagnostics_t) :: findings, draw_none
      type(data_set_t), allocatable :: sets(:)
      type(pictured_t), allocatable :: cases(:)
      type(devices_t) :: devices
      type(picture_t), allocatable :: pictures(:), models(:)
      type(line_t), allocatable :: progress(:)
      type(mark_t) :: mark
      character(:), allocatable :: stem
      logical :: ready
      integer :: k

      mark = begin_mark(arguments%program)
      if (arguments%assemblies) call mark%add('--assemblies')
      if (arguments%animate) call mark%add('--animate')
      if (arguments%robots%any()) call mark%add(arguments%robots%options())
      call read_cases(file, sets, findings, program='balm', mark=mark)
      call make_scenes(sets, findings, cases)
      do k = 1, size(cases)
         call report_picture(sets(k), cases(k), devices)
      end do
      allocate (models(0))
      if (arguments%robots%any()) call draw_models(sets, cases, arguments%robots, mark%name(), findings, models)
      if (findings%failed() .or. .not. arguments%quiet) call show_findings(findings)
      if (.not. arguments%quiet) call show_findings(devices%remarks)
      code = max(code, findings%exit_code(), devices%code)
      if (findings%exit_code() == exit_file_error) return
      stem = stem_of(file, arguments%output_dir)
      allocate (progress(0))
      if (arguments%curves) call read_progress(stem, mark, progress)
      call draw_file(cases, arguments%assemblies, arguments%animate, mark%name(), pictures)
      if (size(pictures) == 0) return
      if (arguments%curves) call draw_curves(cases, progress, mark%name(), pictures)
      if (arguments%phase) then
         call draw_phase(cases, mark%name(), pictures, ready)
         if (.not. (ready .or. findings%failed())) then
            call draw_none%warning('--phase draws motions in time with free drives, and there is none')
            call show_findings(draw_none)
         end if
      end if
      if (arguments%sheet) call add_sheet(file, name_of(stem), sets, cases, pictures)
      do k = 1, size(models)
         call add_picture(pictures, trim(models(k)%ending), models(k)%content)
      end do
      call prepare_outputs(arguments, stem, pictures%ending, ready, code)
      if (.not. ready) return
      call write_pictures(arguments, stem, pictures, code)
   end subroutine run_file

   !> The page of all cases, as the animations show them.
   subroutine add_sheet(file, stem, sets, cases, pictures)
      character(*), intent(in) :: file, stem         !! stem: of the names of the pictures, without directory
      type(data_set_t), intent(in) :: sets(:)
      type(pictured_t), intent(in) :: cases(:)
      type(picture_t), allocatable, intent(inout) :: pictures(:)
      type(line_t), allocatable :: lines(:)
      type(diagnostics_t) :: unused
      type(text_t) :: page
      character(len(stem) + 24) :: names(size(cases))
      character(title_columns) :: titles(size(cases))
      integer :: k

      allocate (lines(0))
      if (file /= '-') call read_lines(file, lines, unused)
      do k = 1, size(cases)
         titles(k) = sets(k)%title
         names(k) = ''
         if (any(pictures%ending == ending(k, '.move.svg'))) names(k) = stem//ending(k, '.move.svg')
      end do
      call write_contact_sheet(titles, names, sets%title_line, lines, page)
      call add_picture(pictures, '.sheet.html', page%content())
   end subroutine add_sheet

   !> The drawing board, with a case or empty. A case with mistakes is drawn as far as it can be read.
   subroutine make_board(file)
      character(*), intent(in) :: file
      type(diagnostics_t) :: findings, of_case
      type(data_set_t), allocatable :: sets(:)
      type(line_t), allocatable :: lines(:)
      type(picture_t), allocatable :: pictures(:)
      type(text_t) :: page
      character(:), allocatable :: stem
      logical :: ready
      integer :: failed

      allocate (lines(0), pictures(0))
      stem = stem_of('sketch', arguments%output_dir)
      if (.not. arguments%no_case) then
         stem = stem_of(file, arguments%output_dir)
         findings%file = file
         call read_lines(file, lines, findings)
         if (.not. findings%failed()) then
            call read_case_text(joined(lines), file, sets, of_case, 'balm')
            if (size(sets) > 0) then
               if (.not. sets(1)%is_drawn() .and. .not. of_case%failed()) &
                  call findings%error('the drawing board takes sketches (&CHAIN), but this linkage is described by its loops '// &
                                      '(&LINKS)', line=sets(1)%title_line)
            end if
            if (of_case%failed()) call show_findings(of_case)
         end if
         if (findings%failed()) call show_findings(findings)
         code = max(code, findings%exit_code(), of_case%exit_code())
         if (findings%failed()) return
      end if
      call prepare_outputs(arguments, stem, ['.edit.html'], ready, code)
      if (.not. ready) return
      call write_board('Drawing board', name_of(stem)//'.nml', lines, page)
      call add_picture(pictures, '.edit.html', page%content())
      failed = exit_done
      call write_pictures(arguments, stem, pictures, failed)
      code = max(code, failed)
      if (failed == exit_done .and. .not. arguments%quiet) &
         call write_standard_error('Written: '//stem//'.edit.html (drawing board; open it in a browser)'//nl)
   end subroutine make_board

   !> Device 1 of the case, if it is there, has the convergence.
   subroutine read_progress(stem, mark, progress)
      character(*), intent(in) :: stem
      type(mark_t), intent(inout) :: mark         !! takes device 1 in
      type(line_t), allocatable, intent(inout) :: progress(:)
      type(diagnostics_t) :: failure
      integer, parameter :: largest = 256      !! MB of device 1
      logical :: there
      integer :: k

      inquire (file=stem//'.dev1', exist=there)
      if (there) call read_lines(stem//'.dev1', progress, failure, largest)
      if (failure%failed()) then
         call show_findings(failure)
         code = max(code, failure%exit_code())
      end if
      do k = 1, size(progress)
         call mark%add(progress(k)%text)
      end do
   end subroutine read_progress
end program balm
