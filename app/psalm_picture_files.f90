!> Pictures become files, all of a run at once.
module psalm_picture_files
   use psalm_console, only: arguments_t, say
   use psalm_drawing, only: picture_t
   use psalm_files, only: exchange_t, directory_of
   use psalm_status, only: exit_done
   implicit none (type, external)
   private
   public :: write_pictures, name_of

contains

   !> Write all files at once; the exit status is raised if that fails.
   subroutine write_pictures(arguments, stem, pictures, code)
      type(arguments_t), intent(in) :: arguments
      character(*), intent(in) :: stem              !! of the files' names
      type(picture_t), intent(in) :: pictures(:)
      integer, intent(inout) :: code
      type(exchange_t) :: files
      integer :: k

      call files%begin(directory_of(stem), arguments%inputs)
      do k = 1, size(pictures)
         call files%add(stem//trim(pictures(k)%ending), pictures(k)%content)
      end do
      call files%finish()
      if (files%code == exit_done) return
      call say(arguments%program, files%message)
      code = max(code, files%code)
   end subroutine write_pictures

   !> A path without its directory.
   pure function name_of(path) result(name)
      character(*), intent(in) :: path
      character(:), allocatable :: name

      name = path(index(path, '/', back=.true.) + 1:)
   end function name_of
end module psalm_picture_files
