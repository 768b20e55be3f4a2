!> The C library's files: bytes written with every failure seen, files that appear whole or not at all.
!>
!> Fortran output to a full disk can fail unseen when a unit is closed; `fwrite`, `fflush` and `fclose` tell.
module psalm_system
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char, c_ptr, c_associated, c_size_t
   implicit none (type, external)
   private
   public :: write_whole_file, write_standard_output, write_standard_error, error_is_terminal, make_directory, move_file

   integer, parameter :: error_unit_number = 2  !! file descriptor of standard error
   integer, parameter :: output_unit_number = 1 !! file descriptor of standard output
   integer(c_int), parameter :: directory_mode = 511_c_int !! rwx for all, cut by the user's mask

   interface
      type(c_ptr) function c_fopen(path, mode) bind(c, name='fopen')
         import :: c_ptr, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*), mode(*)
      end function c_fopen

      integer(c_size_t) function c_fwrite(bytes, size, count, file) bind(c, name='fwrite')
         import :: c_size_t, c_char, c_ptr
         implicit none (type, external)
         character(kind=c_char), intent(in) :: bytes(*)
         integer(c_size_t), value :: size, count
         type(c_ptr), value :: file
      end function c_fwrite

      integer(c_int) function c_fflush(file) bind(c, name='fflush')
         import :: c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: file
      end function c_fflush

      integer(c_int) function c_fclose(file) bind(c, name='fclose')
         import :: c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: file
      end function c_fclose

      integer(c_int) function c_rename(from, to) bind(c, name='rename')
         import :: c_int, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: from(*), to(*)
      end function c_rename

      integer(c_int) function c_remove(path) bind(c, name='remove')
         import :: c_int, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
      end function c_remove

      integer(c_int) function c_isatty(descriptor) bind(c, name='isatty')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: descriptor
      end function c_isatty

      integer(c_int) function c_mkdir(path, mode) bind(c, name='mkdir')
         import :: c_int, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
      end function c_mkdir

      integer(c_size_t) function c_write(descriptor, bytes, count) bind(c, name='write')
         import :: c_int, c_size_t, c_char
         implicit none (type, external)
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(in) :: bytes(*)
         integer(c_size_t), value :: count
      end function c_write
   end interface

contains

   !> Write a file beside its place, then rename it there: readers see the old file or the new one, never half of it.
   subroutine write_whole_file(path, text, done)
      character(*), intent(in) :: path, text
      logical, intent(out) :: done    !! false: nothing was changed
      type(c_ptr) :: file
      character(:), allocatable :: beside

      beside = path//'.part'
      done = .false.
      file = c_fopen(beside//c_null_char, 'wb'//c_null_char)
      if (.not. c_associated(file)) return
      done = .true.
      if (len(text) > 0) done = c_fwrite(text, 1_c_size_t, len(text, c_size_t), file) == len(text, c_size_t)
      if (c_fflush(file) /= 0) done = .false.
      if (c_fclose(file) /= 0) done = .false.
      if (done) done = c_rename(beside//c_null_char, path//c_null_char) == 0
      if (.not. done) then
         if (c_remove(beside//c_null_char) /= 0) return
      end if
   end subroutine write_whole_file

   !> Write to standard output; `done` is false if it takes no more.
   subroutine write_standard_output(text, done)
      character(*), intent(in) :: text
      logical, intent(out) :: done

      call write_descriptor(output_unit_number, text, done)
   end subroutine write_standard_output

   !> Write to standard error, whatever becomes of it.
   subroutine write_standard_error(text)
      character(*), intent(in) :: text
      logical :: done

      call write_descriptor(error_unit_number, text, done)
   end subroutine write_standard_error

   subroutine write_descriptor(descriptor, text, done)
      integer, intent(in) :: descriptor
      character(*), intent(in) :: text
      logical, intent(out) :: done
      integer(c_size_t) :: at, written

      at = 0_c_size_t
      done = .true.
      do while (at < len(text, c_size_t))
         written = c_write(int(descriptor, c_int), text(at + 1:), len(text, c_size_t) - at)
         if (written <= 0_c_size_t) then
            done = .false.
            return
         end if
         at = at + written
      end do
   end subroutine write_descriptor

   !> True if standard error is a terminal.
   logical function error_is_terminal()

      error_is_terminal = c_isatty(int(error_unit_number, c_int)) == 1
   end function error_is_terminal

   !> Give a file another name, in place of a file that has it.
   subroutine move_file(from, to, done)
      character(*), intent(in) :: from, to
      logical, intent(out) :: done

      done = c_rename(from//c_null_char, to//c_null_char) == 0
   end subroutine move_file

   !> Make a directory; an existing one is as good. Failure shows when a file is written there.
   subroutine make_directory(path)
      character(*), intent(in) :: path

      if (c_mkdir(path//c_null_char, directory_mode) /= 0) return
   end subroutine make_directory
end module psalm_system
