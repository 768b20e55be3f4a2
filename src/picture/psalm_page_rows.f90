!> Rows of numbers in the data of pages (JSON).
module psalm_page_rows
   use psalm_kinds, only: wp
   use psalm_markup, only: comma, number_or_null, short_or_null
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: add_values, integers

contains

   !> Append numbers with commas between them, to nine digits; `null` stands for what is not known.
   subroutine add_values(values, text, known, exact)
      real(wp), intent(in) :: values(:)
      type(text_t), intent(inout) :: text
      logical, intent(in), optional :: known(:)   !! the same shape; all if absent
      logical, intent(in), optional :: exact      !! with all digits
      logical :: all_digits, is_known
      integer :: i

      all_digits = .false.
      if (present(exact)) all_digits = exact
      is_known = .true.
      do i = 1, size(values)
         if (present(known)) is_known = known(i)
         if (i > 1) call text%add_text(',')
         if (all_digits) then
            call text%add_text(number_or_null(values(i), is_known))
         else
            call text%add_text(short_or_null(values(i), is_known))
         end if
      end do
   end subroutine add_values

   !> Integers with commas between them.
   pure function integers(values) result(list)
      integer, intent(in) :: values(:)
      character(:), allocatable :: list
      integer :: i

      list = ''
      do i = 1, size(values)
         list = list//comma(i)//to_text(values(i))
      end do
   end function integers
end module psalm_page_rows
