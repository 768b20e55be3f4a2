!> Pictures that gnuplot makes from scripts of the programs, written together with the files they belong to.
module psalm_gnuplot
   use psalm_console, only: arguments_t, say
   use psalm_drawing, only: picture_t
   use psalm_files, only: exchange_t, directory_of
   use psalm_status, only: exit_done, exit_file_trouble
   use psalm_system, only: held_signals_t, error_text, make_private_directory, remove_file, stage
   implicit none (type, external)
   private
   public :: write_pictures, name_of

contains

   !> Let gnuplot make its pictures, then write all files at once; the exit status is raised if something fails.
   subroutine write_pictures(arguments, stem, pictures, scripts, code)
      type(arguments_t), intent(in) :: arguments
      character(*), intent(in) :: stem              !! of the files' names
      type(picture_t), intent(in) :: pictures(:)    !! files
      type(picture_t), intent(inout) :: scripts(:)  !! `made` tells whether gnuplot did
      integer, intent(inout) :: code
      type(exchange_t) :: files
      type(held_signals_t) :: held
      character(:), allocatable :: workshop
      integer :: k

      workshop = ''
      if (size(scripts) > 0) then
         ! signals wait, so that nothing is left beside; the terminal's Ctrl-C still stops gnuplot
         call held%hold(gently=.true.)
         call plot(arguments, stem, scripts, workshop, code)
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
   end subroutine write_pictures

   !> Let gnuplot make the pictures in a directory of our own.
   subroutine plot(arguments, stem, scripts, workshop, code)
      type(arguments_t), intent(in) :: arguments
      character(*), intent(in) :: stem
      type(picture_t), intent(inout) :: scripts(:)      !! `made` tells whether gnuplot did
      character(:), allocatable, intent(out) :: workshop !! that directory, empty if it cannot be made
      integer, intent(inout) :: code
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
end module psalm_gnuplot
