!> balm: pictures of planar linkages from a namelist file.
program balm
   use psalm_console, only: arguments_t, begin, begin_mark, prepare_outputs, show_findings, stem_of
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_drawing, only: picture_t, draw_file, draw_curves
   use psalm_gnuplot, only: write_pictures, name_of
   use psalm_mark, only: mark_t
   use psalm_picture_report, only: report_picture
   use psalm_picture_study, only: pictured_t, make_scenes
   use psalm_source, only: line_t, read_lines
   use psalm_status, only: diagnostics_t, exit_file_trouble
   use psalm_system, only: finish_program, write_standard_error
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: endings(*) = [character(5) :: '.svg', '.html', '.dxf', '.gp', '.png', '.pdf']
   type(arguments_t) :: arguments
   logical :: finished
   integer :: code, i

   call begin('balm', &
      'usage: balm [options] [CASE.nml ...]'//nl// &
      nl//'Pictures of each case: CASE.svg, the linkage at its reference position with joints and output at every'//nl// &
      'position; CASE.html, a page on which it moves; CASE.dxf for CAD. Further cases of a file get CASE.2.svg and'//nl// &
      'so on; the page has them all. The linkage is drawn as given, no search is made: for its result draw CASE.dev7.'//nl// &
      nl//'  --curves          curves too: CASE.gp, CASE.png, CASE.pdf, by gnuplot; convergence from CASE.dev1'//nl// &
      '  --assemblies      the SVG shows the other assembly of each dyad in grey'//nl// &
      '  --output-dir DIR  put the files into DIR'//nl// &
      '  --quiet           no remarks on standard error, errors only'//nl// &
      '  --version         print the version'//nl// &
      '  --help            print this text'//nl// &
      nl//'Exit status: 0 done; 1 done, but the linkage violates closure or transmission limits; 2 the input is wrong'//nl// &
      '(the pictures show the messages); 3 a file could not be read or written, or gnuplot failed.'//nl, &
      endings, arguments, finished)
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
      type(pictured_t), allocatable :: cases(:)
      type(devices_t) :: devices
      type(picture_t), allocatable :: pictures(:), scripts(:)
      type(mark_t) :: mark
      character(:), allocatable :: stem
      logical :: ready
      integer :: k

      mark = begin_mark(arguments%program)
      if (arguments%assemblies) call mark%add('--assemblies')
      call read_cases(file, sets, findings, program='balm', mark=mark)
      do k = 1, size(sets)
         if (.not. allocated(sets(k)%no_loops)) cycle
         call findings%error('balm draws dyads with one drive on the frame, but this sketch has '//sets(k)%no_loops, &
                             line=sets(k)%title_line)
      end do
      call make_scenes(sets, findings, cases)
      do k = 1, size(cases)
         call report_picture(sets(k), cases(k), devices)
      end do
      if (findings%failed() .or. .not. arguments%quiet) call show_findings(findings)
      if (.not. arguments%quiet) call write_standard_error(devices%notes%content())
      code = max(code, findings%exit_code(), devices%code)
      if (findings%exit_code() == exit_file_trouble) return
      stem = stem_of(file, arguments%output_dir)
      allocate (scripts(0))
      if (arguments%curves) call draw_scripts(cases, stem, mark, scripts)
      call draw_file(cases, arguments%assemblies, mark%name(), pictures)
      if (size(pictures) == 0) return
      call prepare_outputs(arguments, stem, pictures%ending, ready, code)
      if (.not. ready) return
      call write_pictures(arguments, stem, pictures, scripts, code)
   end subroutine run_file

   !> Scripts for gnuplot; device 1 of the case, if it is there, has the convergence.
   subroutine draw_scripts(cases, stem, mark, scripts)
      type(pictured_t), intent(in) :: cases(:)
      character(*), intent(in) :: stem
      type(mark_t), intent(inout) :: mark         !! takes device 1 in
      type(picture_t), allocatable, intent(out) :: scripts(:)
      type(line_t), allocatable :: progress(:)
      type(diagnostics_t) :: unused
      logical :: there
      integer :: k

      allocate (progress(0))
      inquire (file=stem//'.dev1', exist=there)
      if (there) call read_lines(stem//'.dev1', progress, unused)
      do k = 1, size(progress)
         call mark%add(progress(k)%text)
      end do
      call draw_curves(cases, name_of(stem), progress, mark%name(), scripts)
   end subroutine draw_scripts
end program balm
