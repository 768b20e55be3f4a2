!> balm: pictures of planar linkages from a namelist file.
program balm
   use psalm_console, only: arguments_t, begin, begin_mark, prepare_outputs, say, show_findings, stem_of
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_drawing, only: picture_t, draw_file, draw_curves
   use psalm_files, only: exchange_t, directory_of
   use psalm_mark, only: mark_t
   use psalm_picture_report, only: report_picture
   use psalm_picture_study, only: pictured_t, make_scenes
   use psalm_source, only: line_t, read_lines
   use psalm_status, only: diagnostics_t, exit_done, exit_file_trouble
   use psalm_system, only: held_signals_t, error_text, finish_program, make_private_directory, remove_file, stage, &
                           write_standard_error
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
      type(exchange_t) :: files
      type(held_signals_t) :: held
      type(mark_t) :: mark
      character(:), allocatable :: stem, workshop
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
      workshop = ''
      if (size(scripts) > 0) then
         ! signals wait, so that nothing is left beside; the terminal's Ctrl-C still stops gnuplot
         call held%hold(gently=.true.)
         call plot(stem, scripts, workshop)
      end if
      call files%begin(directory_of(stem), arguments%inputs)
      do k = 1, size(pictures)
         call files%add(stem//trim(pictures(k)%ending), pictures(k)%content)
      end do
      do k = 1, size(scripts)
         call files%add(stem//trim(scripts(k)%ending)//'.gp', scripts(k)%content)
         if (.not. scripts(k)%made) cycle
         call files%adopt(stem//trim(scripts(k)%ending)//'.png', inside(workshop, stem, scripts(k), '.png'))
         call files%adopt(stem//trim(scripts(k)%ending)//'.pdf', inside(workshop, stem, scripts(k), '.pdf'))
      end do
      call files%finish()
      if (len(workshop) > 0) call clear(workshop, stem, scripts)
      call held%release()
      if (files%code == exit_done) return
      call say(arguments%program, files%message)
      code = max(code, files%code)
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

   !> Let gnuplot make the pictures in a directory of our own.
   subroutine plot(stem, scripts, workshop)
      character(*), intent(in) :: stem
      type(picture_t), intent(inout) :: scripts(:)      !! `made` tells whether gnuplot did
      character(:), allocatable, intent(out) :: workshop !! that directory, empty if it cannot be made
      character(:), allocatable :: beside
      integer :: k, status, failed, error

      call make_private_directory(stem, workshop, error)
      if (error /= 0) then
         call say(arguments%program, "cannot make the directory '"//workshop//"'"//error_text(error))
         code = exit_file_trouble
         workshop = ''
         return
      end if
      do k = 1, size(scripts)
         call stage(workshop//'/script', scripts(k)%content, beside, error)
         status = 1
         failed = 0
         if (error == 0) call execute_command_line('cd '//shell_word('./', workshop)//' && gnuplot '// &
                                                   shell_word('./', name_of(beside))//' >/dev/null 2>&1', &
                                                   exitstat=status, cmdstat=failed)
         call remove_file(beside)
         scripts(k)%made = error == 0 .and. status == 0 .and. failed == 0
         if (scripts(k)%made) cycle
         call say(arguments%program, "cannot make the curves of '"//stem//trim(scripts(k)%ending)// &
                  "': gnuplot is missing or failed (install gnuplot, or run it on '"//name_of(stem)// &
                  trim(scripts(k)%ending)//".gp')")
         code = exit_file_trouble
      end do
   end subroutine plot

   !> Remove the directory of our own and what gnuplot may have left there.
   subroutine clear(workshop, stem, scripts)
      character(*), intent(in) :: workshop, stem
      type(picture_t), intent(in) :: scripts(:)
      integer :: k

      do k = 1, size(scripts)
         call remove_file(inside(workshop, stem, scripts(k), '.png'))
         call remove_file(inside(workshop, stem, scripts(k), '.pdf'))
      end do
      call remove_file(workshop)
   end subroutine clear

   !> A picture in the directory of our own.
   pure function inside(workshop, stem, script, ending) result(path)
      character(*), intent(in) :: workshop, stem, ending
      type(picture_t), intent(in) :: script
      character(:), allocatable :: path

      path = workshop//'/'//name_of(stem)//trim(script%ending)//ending
   end function inside

   !> A path without its directory.
   pure function name_of(path) result(name)
      character(*), intent(in) :: path
      character(:), allocatable :: name

      name = path(index(path, '/', back=.true.) + 1:)
   end function name_of

   !> A path as one word of the shell, led by `here` unless it begins at the root.
   pure function shell_word(here, path) result(word)
      character(*), intent(in) :: here, path
      character(:), allocatable :: word
      integer :: m

      word = "'"
      if (index(path, '/') /= 1) word = word//here
      do m = 1, len(path)
         if (path(m:m) == "'") then
            word = word//"'"//achar(92)//"''"
         else
            word = word//path(m:m)
         end if
      end do
      word = word//"'"
   end function shell_word
end program balm
