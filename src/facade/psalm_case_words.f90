!> Texts of the notation: names, words and what can be written of them.
module psalm_case_words
   use psalm_text, only: text_t, upper_case
   implicit none (type, external)
   private
   public :: name_length, is_word, without_blanks, with_lines, has_control, printable, is_name, put

   integer, parameter :: name_length = 31 !! longest name of a group or an item

contains

   !> True for a text that can be seen and is not blank.
   pure logical function is_word(text)
      character(*), intent(in) :: text

      is_word = len_trim(text) > 0 .and. .not. has_control(text)
   end function is_word

   pure function without_blanks(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: i

      word = ''
      do i = 1, len(text)
         if (text(i:i) /= ' ') word = word//text(i:i)
      end do
   end function without_blanks

   !> Words joined by _.
   pure function with_lines(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: i

      word = trim(text)
      do i = 1, len(word)
         if (word(i:i) == ' ') word(i:i) = '_'
      end do
   end function with_lines

   !> True if a text has characters that end a line or cannot be seen.
   pure logical function has_control(text)
      character(*), intent(in) :: text
      integer :: i

      has_control = .false.
      do i = 1, len(text)
         has_control = has_control .or. iachar(text(i:i)) < iachar(' ') .or. iachar(text(i:i)) == 127
      end do
   end function has_control

   !> A name for a finding: in capitals, as long as a name may be, what cannot be seen as a question mark.
   pure function printable(name) result(text)
      character(*), intent(in) :: name
      character(:), allocatable :: text
      integer :: i

      text = upper_case(name(:min(len(name), name_length)))
      do i = 1, len(text)
         if (has_control(text(i:i))) text(i:i) = '?'
      end do
   end function printable

   !> True for a letter followed by letters, digits and underscores; of an item an index may follow: DESX(3).
   pure logical function is_name(text, indexed)
      character(*), intent(in) :: text
      logical, intent(in) :: indexed
      character(*), parameter :: letters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZ', further = letters//'0123456789_', inner = '0123456789,: '
      character(:), allocatable :: name
      integer :: last

      is_name = len(text) > 0 .and. len(text) <= name_length
      if (.not. is_name) return
      name = upper_case(text)
      last = verify(name, further) - 1
      if (last < 0) last = len(name)
      is_name = last > 0 .and. scan(name(1:1), letters) == 1
      if (.not. is_name .or. last == len(name)) return
      is_name = indexed .and. name(last + 1:last + 1) == '(' .and. name(len(name):) == ')'
      if (is_name) is_name = len(name) > last + 2 .and. verify(name(last + 2:len(name) - 1), inner) == 0
   end function is_name

   !> A value on the last line of a text, or on a new one.
   subroutine put(value, text)
      character(*), intent(in) :: value
      type(text_t), intent(inout) :: text

      call text%add('  '//value//',')
   end subroutine put
end module psalm_case_words
