!> The mark of a run: a hash of everything its results depend on. The same input and options give the same mark.
!>
!> Every file of a run carries it, so that files of different runs can be distinguished.
module psalm_mark
   use, intrinsic :: iso_fortran_env, only: int64
   implicit none (type, external)
   private
   public :: mark_t, mark_width

   integer, parameter :: mark_width = 16                          !! hexadecimal digits
   integer(int64), parameter :: offset = -3750763034362895579_int64 !! where FNV-1a begins: 14695981039346656037 unsigned

   type :: mark_t
      private
      integer(int64) :: state = offset
   contains
      procedure :: add
      procedure :: name
   end type mark_t

contains

   !> Take a text in; where one ends and the next begins counts too.
   pure subroutine add(self, text)
      use psalm_system, only: hash
      class(mark_t), intent(inout) :: self
      character(*), intent(in) :: text

      self%state = hash(self%state, text//new_line('a'))
   end subroutine add

   !> The mark in words.
   pure function name(self) result(digits)
      class(mark_t), intent(in) :: self
      character(mark_width) :: digits

      write (digits, '(z16.16)') self%state
   end function name
end module psalm_mark
