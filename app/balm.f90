!> balm: pictures of planar linkages from a namelist file.
program balm
   use psalm_balm, only: balm_t, picture_t, make_scenes, draw_file, draw_curves
   use psalm_console, only: arguments_t, begin, leave, show_findings, stem_of
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_source, only: line_t, read_lines
   use psalm_status, only: diagnostics_t, exit_file_trouble
   use psalm_system, only: make_directory, move_file, write_standard_error, write_whole_file
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
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
      arguments, finished)
   code = arguments%code
   if (finished) call leave(code)
   do i = 1, size(arguments%files)
      call run_file(trim(arguments%files(i)))
   end do
   call leave(code)

contains

   subroutine run_file(file)
      character(*), intent(in) :: file
      type(diagnostics_t) :: findings
      type(data_set_t), allocatable :: sets(:)
      type(balm_t) :: scenes
      type(picture_t), allocatable :: pictures(:)
      character(:), allocatable :: stem
      integer :: k

      call read_data_sets(file, sets, findings)
      call make_scenes(sets, findings, scenes)
      if (findings%failed() .or. .not. arguments%quiet) call show_findings(findings)
      if (.not. arguments%quiet) call write_standard_error(scenes%notes%content())
      code = max(code, findings%exit_code(), scenes%code)
      stem = stem_of(file, arguments%output_dir)
      if (len(arguments%output_dir) > 0 .and. size(sets) > 0) call make_directory(arguments%output_dir)
      call draw_file(scenes, arguments%assemblies, pictures)
      do k = 1, size(pictures)
         call write_one(stem//pictures(k)%ending, pictures(k)%content)
      end do
      if (arguments%curves) call plot(scenes, stem)
   end subroutine run_file

   subroutine write_one(path, text)
      character(*), intent(in) :: path, text
      logical :: done

      call write_whole_file(path, text, done)
      if (done) return
      call write_standard_error("cannot write '"//path//"'"//nl)
      code = exit_file_trouble
   end subroutine write_one

   !> Scripts for gnuplot, and the pictures it makes of them.
   subroutine plot(scenes, stem)
      type(balm_t), intent(in) :: scenes
      character(*), intent(in) :: stem
      type(picture_t), allocatable :: scripts(:)
      type(line_t), allocatable :: progress(:)
      type(diagnostics_t) :: unused
      character(:), allocatable :: directory, name, script
      logical :: there, made, moved
      integer :: k, slash, status, failed

      slash = index(stem, '/', back=.true.)
      directory = './'
      if (slash > 0) directory = stem(:slash)
      if (directory(1:1) == '-') directory = './'//directory
      name = stem(slash + 1:)
      allocate (progress(0))
      inquire (file=stem//'.dev1', exist=there)
      if (there) call read_lines(stem//'.dev1', progress, unused)
      call draw_curves(scenes, name, progress, scripts)
      do k = 1, size(scripts)
         script = name//scripts(k)%ending//'.gp'
         call write_one(stem//scripts(k)%ending//'.gp', scripts(k)%content)
         call execute_command_line('cd '//shell_word(directory)//' && gnuplot '//shell_word('./'//script)//' >/dev/null 2>&1', &
                                   exitstat=status, cmdstat=failed)
         made = status == 0 .and. failed == 0
         if (made) then
            call move_file(stem//scripts(k)%ending//'.png.part', stem//scripts(k)%ending//'.png', made)
            call move_file(stem//scripts(k)%ending//'.pdf.part', stem//scripts(k)%ending//'.pdf', moved)
            made = made .and. moved
         end if
         if (made) cycle
         call write_standard_error("cannot make the curves of '"//stem//scripts(k)%ending// &
                                   "': gnuplot is missing or failed (install gnuplot, or run it on '"//script//"')"//nl)
         code = exit_file_trouble
      end do
   end subroutine plot

   !> A name as one word of the shell.
   pure function shell_word(name) result(word)
      character(*), intent(in) :: name
      character(:), allocatable :: word
      integer :: m

      word = "'"
      do m = 1, len(name)
         if (name(m:m) == "'") then
            word = word//"'"//achar(92)//"''"
         else
            word = word//name(m:m)
         end if
      end do
      word = word//"'"
   end function shell_word
end program balm
