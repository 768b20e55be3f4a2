!> What an item of a case may be: its name, kind, shape, unit, default, values, meaning.
!>
!> Every group of items has a table of these beside its reader. From it come the default and the assessment of each value, the
!> names that may have been meant, `--items`, the schema of a case as JSON and the tables of the manual.
module psalm_rule
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: wp
   use psalm_number, only: parse_real
   implicit none (type, external)
   private
   public :: rule_t, value_rule_t, limits_t, rule_of, word_of, word_count, word_number, one_of, limits_of
   public :: a_flag, a_whole, a_number, a_word, a_text, required_word, any_number, meaning_length

   integer, parameter :: a_flag = 1     !! 0 or 1
   integer, parameter :: a_whole = 2    !! an integer
   integer, parameter :: a_number = 3   !! a real
   integer, parameter :: a_word = 4     !! one of some words
   integer, parameter :: a_text = 5     !! names

   character(*), parameter :: required_word = 'required' !! in place of a default
   character, parameter :: any_number = '#'              !! ends the name of items that are counted: DES# for DES1, DES2 ...

   integer, parameter :: meaning_length = 300            !! characters, at most

   !> One item.
   type :: rule_t
      character(8) :: name                 !! in capitals; `#` at its end stands for a number
      integer :: kind                      !! `a_flag` ...
      character(16) :: shape               !! blank for one value; `NMASS`: as many as that item says; `NLOOP*MAXARC`: rows of so
                                           !! many; `2`; `n`: as many as there are; `1 or NDES`
      character(20) :: unit                !! `length`: the user's; blank: none
      character(32) :: default             !! a value, the word `required`, or what takes its place in words; blank: none
      character(48) :: values              !! numbers: an interval, `[0,1)`, `(0,)`, or all there are, `0 1`; words: these
      character(meaning_length) :: meaning !! in a sentence
      character(72) :: complaint = ''      !! about a value that is none of these; blank: the usual one
   end type rule_t

   !> Of these what values are read and checked by: every group of every case has a table of it.
   type :: value_rule_t
      character(8) :: name = ''
      integer :: kind = 0
      character(16) :: shape = ''
      character(32) :: default = ''
      character(48) :: values = ''
      character(72) :: complaint = ''
   end type value_rule_t

   !> An interval.
   type :: limits_t
      real(wp) :: low = -huge(1.0_wp), high = huge(1.0_wp)
      logical :: bounded_below = .false., bounded_above = .false. !! there is such an end
      logical :: without_low = .false., without_high = .false.    !! the end does not belong to it
      character(16) :: low_text = '', high_text = ''              !! as it stands in the table
   contains
      procedure :: contain
      procedure :: in_words
   end type limits_t

contains

   !> Index of the rule of an item; 0 if there is none.
   pure integer function rule_of(rules, name, first)
      type(value_rule_t), intent(in) :: rules(:)
      character(*), intent(in) :: name
      integer, intent(in) :: first              !! where it is looked for first
      character(len(rules%name)) :: padded
      integer(int64) :: bits
      integer :: length, k

      ! each item of each group is looked up, and a comparison of texts is a call: eight characters are compared as one number
      if (len_trim(name) <= len(padded)) then
         padded = name
         bits = transfer(padded, bits)
         do k = first, first + size(rules) - 1
            rule_of = merge(k, k - size(rules), k <= size(rules))
            if (transfer(rules(rule_of)%name, bits) == bits) return
         end do
      end if
      do rule_of = 1, size(rules)
         length = index(rules(rule_of)%name, any_number) - 1
         if (length < 1 .or. len_trim(name) <= length) cycle
         if (name(:length) == rules(rule_of)%name(:length) .and. number_in_name(name, length) > 0) return
      end do
      rule_of = 0
   end function rule_of

   !> The number behind the first `length` characters of a name; 0 if there is none.
   pure integer function number_in_name(name, length)
      character(*), intent(in) :: name
      integer, intent(in) :: length
      integer, parameter :: most_digits = 6
      integer :: i, last, digit

      number_in_name = 0
      last = len_trim(name)
      if (last <= length .or. last > length + most_digits) return
      if (name(length + 1:length + 1) == '0') return
      do i = length + 1, last
         digit = index('0123456789', name(i:i)) - 1
         if (digit < 0) then
            number_in_name = 0
            return
         end if
         number_in_name = 10*number_in_name + digit
      end do
   end function number_in_name

   !> How many words stand in a text, blanks between them.
   pure integer function word_count(text)
      character(*), intent(in) :: text
      integer :: i

      word_count = 0
      do i = 1, len_trim(text)
         if (text(i:i) == ' ') cycle
         if (i == 1) then
            word_count = 1
         else if (text(i - 1:i - 1) == ' ') then
            word_count = word_count + 1
         end if
      end do
   end function word_count

   !> The k-th word of a text.
   pure function word_of(text, k) result(word)
      character(*), intent(in) :: text
      integer, intent(in) :: k
      character(:), allocatable :: word
      integer :: i, first, last

      first = 1
      last = 0
      do i = 1, k
         call find_next_word(text, first, last)
      end do
      word = text(first:last)
   end function word_of

   !> Which word of a text a word is; 0: none.
   pure integer function word_number(text, word)
      character(*), intent(in) :: text, word
      integer :: first, last, k

      word_number = 0
      k = 0
      last = 0
      do
         call find_next_word(text, first, last)
         if (last < first) return
         k = k + 1
         if (text(first:last) == word) exit
      end do
      word_number = k
   end function word_number

   !> The word of a text behind position `last`, from `first` to `last`; empty if there is none.
   pure subroutine find_next_word(text, first, last)
      character(*), intent(in) :: text
      integer, intent(out) :: first
      integer, intent(inout) :: last

      first = last + 1
      do while (first <= len(text))
         if (text(first:first) /= ' ') exit
         first = first + 1
      end do
      last = first - 1
      do while (last < len(text))
         if (text(last + 1:last + 1) == ' ') exit
         last = last + 1
      end do
   end subroutine find_next_word

   !> The words that may stand, for a message: `'RMS' or 'PEAK'`, `one of 'POINT', 'BODY', 'DISC'`.
   pure function one_of(words) result(text)
      character(*), intent(in) :: words
      character(:), allocatable :: text
      integer :: k, n

      n = word_count(words)
      text = "'"//word_of(words, 1)//"'"
      do k = 2, n
         if (n == 2) text = text//" or '"//word_of(words, k)//"'"
         if (n > 2) text = text//", '"//word_of(words, k)//"'"
      end do
      if (n > 2) text = 'one of '//text
   end function one_of

   !> The interval that stands in `values`; `valid` is false if none does.
   pure subroutine limits_of(values, limits, valid)
      character(*), intent(in) :: values
      type(limits_t), intent(out) :: limits
      logical, intent(out) :: valid
      integer :: comma, last

      valid = values(1:1) == '[' .or. values(1:1) == '('
      if (.not. valid) return
      last = len_trim(values)
      comma = index(values, ',')
      limits%without_low = values(1:1) == '('
      limits%without_high = values(last:last) == ')'
      limits%low_text = values(2:comma - 1)
      limits%high_text = values(comma + 1:last - 1)
      call read_end(limits%low_text, limits%low, limits%bounded_below)
      call read_end(limits%high_text, limits%high, limits%bounded_above)
   end subroutine limits_of

   !> One end of an interval; what is no number, as the name of a count, bounds nothing.
   pure subroutine read_end(text, value, valid)
      character(*), intent(in) :: text
      real(wp), intent(inout) :: value
      logical, intent(out) :: valid
      character(:), allocatable :: reason
      real(wp) :: number

      valid = .false.
      if (len_trim(text) > 0) call parse_real(trim(text), number, valid, reason)
      if (valid) value = number
   end subroutine read_end

   !> True if a value lies in the interval.
   elemental logical function contain(self, value)
      class(limits_t), intent(in) :: self
      real(wp), intent(in) :: value

      contain = value >= self%low .and. value <= self%high
      if (self%without_low .and. self%bounded_below) contain = contain .and. value > self%low
      if (self%without_high .and. self%bounded_above) contain = contain .and. value < self%high
   end function contain

   !> What a value must be.
   pure function in_words(self) result(text)
      class(limits_t), intent(in) :: self
      character(:), allocatable :: text

      if (self%bounded_below .and. self%bounded_above) then
         if (self%without_low .or. self%without_high) then
            text = 'must lie between '//trim(self%low_text)//' and '//trim(self%high_text)
         else
            text = 'must be from '//trim(self%low_text)//' to '//trim(self%high_text)
         end if
      else if (self%without_low) then
         text = 'must be above '//trim(self%low_text)
      else if (self%low_text == '0') then
         text = 'must not be negative'
      else
         text = 'must be at least '//trim(self%low_text)
      end if
   end function in_words
end module psalm_rule
