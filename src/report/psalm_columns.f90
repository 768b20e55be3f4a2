!> Columns of listings: words and numbers brought to a width, numbers within a sentence, rows of numbers.
module psalm_columns
   use psalm_kinds, only: wp
   use psalm_text, only: text_t, full_precision, general, to_text
   implicit none (type, external)
   private
   public :: left_column, right_column, heading_of, in_words, add_rows, add_item

   interface right_column
      module procedure :: right_text, right_number
   end interface right_column

contains

   !> Words at the left of a column, wider where they do not fit.
   pure function left_column(words, width, gap) result(column)
      character(*), intent(in) :: words
      integer, intent(in) :: width             !! characters
      integer, intent(in), optional :: gap     !! least number of blanks behind; 1 if absent
      character(:), allocatable :: column

      column = words//repeat(' ', max(least_gap(gap, 1), width - len(words)))
   end function left_column

   !> Words at the right of a column, wider where they do not fit.
   pure function right_text(words, width, gap) result(column)
      character(*), intent(in) :: words
      integer, intent(in) :: width             !! characters
      integer, intent(in), optional :: gap     !! least number of blanks before; 0 if absent
      character(:), allocatable :: column

      column = repeat(' ', max(least_gap(gap, 0), width - len(words)))//words
   end function right_text

   !> A number at the right of a column.
   pure function right_number(number, width, gap) result(column)
      integer, intent(in) :: number, width
      integer, intent(in), optional :: gap     !! as of words
      character(:), allocatable :: column

      column = right_text(to_text(number), width, gap)
   end function right_number

   !> The heading of a column of numbers: a name as it was written, cut where it does not fit.
   pure function heading_of(name) result(head)
      character(*), intent(in) :: name
      character(15) :: head

      head = right_text(name(:min(len_trim(name), len(head) - 1)), len(head))
   end function heading_of

   pure integer function least_gap(gap, usual)
      integer, intent(in), optional :: gap
      integer, intent(in) :: usual

      least_gap = usual
      if (present(gap)) least_gap = gap
   end function least_gap

   !> A number within a sentence: as in a column, without the blanks.
   pure function in_words(value, letter) result(words)
      real(wp), intent(in) :: value
      character(1), intent(in), optional :: letter !! of the exponent, as `general` has it
      character(:), allocatable :: words

      words = trim(adjustl(general(value, letter)))
   end function in_words

   !> Append numbers, so many a row.
   pure subroutine add_rows(values, per_row, margin, text)
      real(wp), intent(in) :: values(:)
      integer, intent(in) :: per_row
      character(*), intent(in) :: margin       !! before each row
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: first, k

      do first = 1, size(values), per_row
         line = margin
         do k = first, min(first + per_row - 1, size(values))
            line = line//general(values(k))
         end do
         call text%add(line)
      end do
   end subroutine add_rows

   !> Append the numbers of an item of a data set, with all digits.
   pure subroutine add_item(name, values, text)
      character(*), intent(in) :: name         !! with what stands before the first number
      real(wp), intent(in) :: values(:)
      type(text_t), intent(inout) :: text
      integer, parameter :: line_length = 100  ! columns
      character(:), allocatable :: line
      integer :: k

      line = '  '//name
      do k = 1, size(values)
         if (len(line) > line_length) then
            call text%add(line)
            line = '  '
         end if
         if (values(k) == 0.0_wp) then
            line = line//'0.0,'
         else
            line = line//full_precision(values(k))//','
         end if
      end do
      call text%add(line)
   end subroutine add_item
end module psalm_columns
