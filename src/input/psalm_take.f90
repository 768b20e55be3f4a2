!> Values of items by the rules of their group's table: the default, the value that was written, and whether it may be.
module psalm_take
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp
   use psalm_number, only: parse_integer, parse_real
   use psalm_rule, only: value_rule_t, limits_t, rule_of, word_of, word_count, word_number, one_of, limits_of, a_flag, a_word, &
                         required_word
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: take, take_count

   !> Set a value to its default, read it where it is given, and complain where the table does not allow it. A default that is
   !> no value leaves it as it is. What is required and missing is reported with the group.
   interface take
      procedure :: take_whole, take_flag, take_number, take_wholes, take_numbers
   end interface take

contains

   !> An integer, or the number of a word among those of the table. A word that is not there leaves the default.
   subroutine take_whole(group, name, value, findings)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      integer, intent(inout) :: value
      type(diagnostics_t), intent(inout) :: findings
      integer :: at
      character(:), allocatable :: reason, word
      integer :: found
      logical :: valid

      call find_rule(group, name, at)
      associate (rule => group%rules(at))
         if (rule%kind == a_word) then
            word = rule%default(:len_trim(rule%default))
            found = word_number(rule%values, word)
            if (found > 0) value = found
            call group%get_word(name, word, findings)
            if (.not. group%given(name)) return
            found = word_number(rule%values, word)
            if (found > 0) then
               value = found
            else
               call out_of(group, name, complaint_about(rule, one_of(rule%values)//' is expected')//"; found '"//word//"'", &
                           findings)
            end if
            return
         end if
         call whole_default(rule, found, valid)
         if (valid) value = found
         call group%get_integer(name, value, findings)
         call require(group, at)
         if (.not. group%given(name)) return
         if (allowed(rule, value)) return
         reason = complaint_about(rule, must_be(rule))
         if (len_trim(rule%complaint) == 0) reason = reason//'; found '//to_text(value)
         call out_of(group, name, reason, findings)
      end associate
   end subroutine take_whole

   !> A flag: 0 or 1.
   subroutine take_flag(group, name, value, findings)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      logical, intent(inout) :: value
      type(diagnostics_t), intent(inout) :: findings
      integer :: number

      number = merge(1, 0, value)
      call take_whole(group, name, number, findings)
      value = number == 1
   end subroutine take_flag

   !> A real.
   subroutine take_number(group, name, value, findings)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      real(wp), intent(inout) :: value
      type(diagnostics_t), intent(inout) :: findings
      integer :: at
      type(limits_t) :: limits
      real(wp) :: default
      logical :: valid

      call find_rule(group, name, at)
      associate (rule => group%rules(at))
         call number_default(rule, default, valid)
         if (valid) value = default
         call group%get_real(name, value, findings)
         call require(group, at)
         if (.not. group%given(name)) return
         call limits_of(rule%values, limits, valid)
         if (.not. valid) return
         if (.not. limits%contain(value)) call out_of(group, name, complaint_about(rule, limits%in_words()), findings)
      end associate
   end subroutine take_number

   !> Integers. `last` is the highest element given.
   subroutine take_wholes(group, name, values, findings, last)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      integer, intent(inout) :: values(:)      !! shape (entries)
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(out), optional :: last
      integer :: at
      character(:), allocatable :: reason
      integer, allocatable :: columns
      integer :: default, k
      logical :: valid

      call find_rule(group, name, at)
      associate (rule => group%rules(at))
         call whole_default(rule, default, valid)
         if (valid) values = default
         call read_columns(rule, columns)
         call group%get_integers(name, values, findings, columns, last=last)
         if (.not. group%given(name) .and. size(values) > 0) call require(group, at)
         if (.not. group%given(name)) return
         do k = 1, size(values)
            if (allowed(rule, values(k))) cycle
            reason = complaint_about(rule, must_be(rule))
            if (len_trim(rule%complaint) == 0) reason = reason//'; found '//to_text(values(k))
            call out_of(group, name, 'entry '//to_text(k)//': '//reason, findings, k)
            exit
         end do
      end associate
   end subroutine take_wholes

   !> Reals. `last` is the highest element given; with `repeated` an entry that is not given is that before it, from the second
   !> on.
   subroutine take_numbers(group, name, values, findings, last, repeated)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      real(wp), intent(inout) :: values(:)     !! shape (entries)
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(out), optional :: last
      logical, intent(in), optional :: repeated
      integer :: at
      type(limits_t) :: limits
      real(wp) :: default
      integer, allocatable :: columns
      integer :: highest, k
      logical :: valid

      call find_rule(group, name, at)
      associate (rule => group%rules(at))
         call number_default(rule, default, valid)
         if (valid) values = default
         call read_columns(rule, columns)
         call group%get_reals(name, values, findings, columns, last=highest)
         if (present(last)) last = highest
         if (.not. group%given(name) .and. size(values) > 0) call require(group, at)
         if (.not. group%given(name)) return
         if (present(repeated)) then
            if (repeated .and. highest > 0 .and. highest < size(values)) values(highest + 1:) = values(highest)
         end if
         call limits_of(rule%values, limits, valid)
         if (.not. valid) return
         do k = 1, size(values)
            if (limits%contain(values(k))) cycle
            call out_of(group, name, 'entry '//to_text(k)//': '//complaint_about(rule, limits%in_words()), findings, k)
            exit
         end do
      end associate
   end subroutine take_numbers

   !> The number of entries of a group: as given, else that of the longest item that has so many.
   !>
   !> Errors: a number out of range, in place of which 0 is handed out; none, where the table requires one.
   subroutine take_count(group, name, n, findings)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      integer, intent(out) :: n
      type(diagnostics_t), intent(inout) :: findings
      integer :: at

      n = 0
      call find_rule(group, name, at)
      associate (rule => group%rules(at))
         call group%get_integer(name, n, findings)
         if (.not. group%given(name)) n = longest(group, name)
         if (group%given(name) .or. n > 0) then
            if (allowed(rule, n)) return
            call out_of(group, name, must_be(rule)//'; found '//to_text(n), findings)
            n = 0
            group%count_missing = .true.   ! that the items have too many values is a consequence
         else
            call require(group, at)
         end if
      end associate
   end subroutine take_count

   ! ---- rules -------------------------------------------------------------------------------------------------------

   !> Place of the rule of an item in the table of the group. Items are asked for in the order of the table, nearly.
   pure subroutine find_rule(group, name, at)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      integer, intent(out) :: at

      at = rule_of(group%rules, name, group%next_rule)
      group%next_rule = at + 1
   end subroutine find_rule

   !> The default of an integer; not valid where it is none.
   pure subroutine whole_default(rule, value, valid)
      type(value_rule_t), intent(in) :: rule
      integer, intent(out) :: value
      logical, intent(out) :: valid
      character(:), allocatable :: reason

      value = 0
      valid = is_figure(rule%default(1:1))
      if (valid) call parse_integer(rule%default(:len_trim(rule%default)), value, valid, reason)
   end subroutine whole_default

   !> The default of a real; not valid where it is none.
   pure subroutine number_default(rule, value, valid)
      type(value_rule_t), intent(in) :: rule
      real(wp), intent(out) :: value
      logical, intent(out) :: valid
      character(:), allocatable :: reason

      value = 0.0_wp
      valid = is_figure(rule%default(1:1))
      if (valid) call parse_real(rule%default(:len_trim(rule%default)), value, valid, reason)
   end subroutine number_default

   !> True for a character that may begin a number; words and blanks, which many defaults are, need not be parsed.
   pure logical function is_figure(first)
      character, intent(in) :: first

      is_figure = (first >= '0' .and. first <= '9') .or. first == '-' .or. first == '+' .or. first == '.'
   end function is_figure

   !> The length of a row of an array; not allocated unless the table says it.
   pure subroutine read_columns(rule, columns)
      type(value_rule_t), intent(in) :: rule
      integer, allocatable, intent(out) :: columns
      character(:), allocatable :: reason
      logical :: valid
      integer :: number, star

      do star = 1, len(rule%shape)
         if (rule%shape(star:star) == '*') exit
      end do
      if (star > len(rule%shape)) return
      call parse_integer(trim(rule%shape(star + 1:)), number, valid, reason)
      if (valid) columns = number
   end subroutine read_columns

   !> Note an item that is required and not given.
   subroutine require(group, at)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: at                        !! place of its rule

      ! a group that is not given misses nothing
      if (group%line == 0 .or. group%rules(at)%default(1:1) /= 'r') return ! `required`: a comparison of texts is a call
      if (group%rules(at)%default /= required_word .or. group%given(trim(group%rules(at)%name))) return
      associate (meaning => group%meanings(at))
         call required(group, trim(group%rules(at)%name), 'missing; this item is required: '// &
                       trim(meaning(:scan(trim(meaning)//';', ';:') - 1)))
      end associate
   end subroutine require

   !> May an integer be?
   pure logical function allowed(rule, value)
      type(value_rule_t), intent(in) :: rule
      integer, intent(in) :: value
      type(limits_t) :: limits
      character(:), allocatable :: reason
      integer :: number, k
      logical :: valid

      if (rule%kind == a_flag) then
         allowed = value == 0 .or. value == 1
         return
      end if
      allowed = len_trim(rule%values) == 0
      if (allowed) return
      call limits_of(rule%values, limits, valid)
      if (valid) then
         allowed = .true.
         call parse_integer(trim(limits%low_text), number, valid, reason)
         if (valid) allowed = value >= number
         call parse_integer(trim(limits%high_text), number, valid, reason)
         if (valid) allowed = allowed .and. value <= number
         return
      end if
      do k = 1, word_count(rule%values)
         call parse_integer(word_of(rule%values, k), number, valid, reason)
         allowed = allowed .or. value == number
      end do
   end function allowed

   !> What an integer must be.
   pure function must_be(rule) result(text)
      type(value_rule_t), intent(in) :: rule
      character(:), allocatable :: text
      type(limits_t) :: limits
      integer :: k
      logical :: valid

      if (rule%kind == a_flag) then
         text = 'must be from 0 to 1'
         return
      end if
      call limits_of(rule%values, limits, valid)
      if (.not. valid) then
         text = 'must be '//word_of(rule%values, 1)
         do k = 2, word_count(rule%values)
            text = text//' or '//word_of(rule%values, k)
         end do
      else if (limits%bounded_above) then
         text = 'must be from '//trim(limits%low_text)//' to '//trim(limits%high_text)
      else
         text = 'must be at least '//trim(limits%low_text)
      end if
   end function must_be

   pure function complaint_about(rule, usual) result(text)
      type(value_rule_t), intent(in) :: rule
      character(*), intent(in) :: usual
      character(:), allocatable :: text

      text = usual
      if (len_trim(rule%complaint) > 0) text = trim(rule%complaint)
   end function complaint_about

   ! ---- counts ------------------------------------------------------------------------------------------------------

   !> Entries of the longest item of the group that has as many as this one says. Zeros that fill up an array are none.
   pure recursive integer function longest(group, name)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: name
      integer :: r, star, entries, others, elements
      character(:), allocatable :: first, second

      longest = 0
      if (group%count == 0) return
      do r = 1, size(group%rules)
         associate (shape => group%rules(r)%shape)
            star = index(shape, '*')
            first = trim(shape)
            second = ''
            if (star > 0) first = trim(shape(:star - 1))
            if (star > 0) second = trim(shape(star + 1:))
         end associate
         if (first /= name .and. second /= name) cycle
         elements = elements_of(group, trim(group%rules(r)%name))
         others = 1
         if (first == name .and. len(second) > 0) others = size_of(group, second)
         if (second == name) others = size_of(group, first)
         if (others == 0) cycle
         entries = (elements - 1)/others + 1
         if (elements > 0) longest = max(longest, entries)
      end do
   end function longest

   !> What stands in a shape, as a number; of a count that is not given the longest item's.
   pure recursive integer function size_of(group, text)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: text
      character(:), allocatable :: reason
      logical :: valid
      integer :: k

      call parse_integer(text, size_of, valid, reason)
      if (valid) return
      do k = 1, group%count
         if (group%items(k)%name /= text .or. group%items(k)%count /= 1) cycle
         call parse_integer(group%text_of(group%values(group%items(k)%first)), size_of, valid, reason)
         if (valid) return
      end do
      ! the other factor of a table of rows comes from items that have it alone
      size_of = 0
      do k = 1, size(group%rules)
         if (group%rules(k)%shape == text) size_of = max(size_of, elements_of(group, trim(group%rules(k)%name)))
      end do
   end function size_of

   !> The highest element of an item that is given, without zeros that are repeated up to its end.
   pure integer function elements_of(group, name)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: name
      integer, parameter :: highest = 1000000000 !! of elements: a number of more digits is a slip of the pen
      integer :: k, j, at

      elements_of = 0
      do k = 1, group%count
         if (group%items(k)%name /= name) cycle
         associate (item => group%items(k))
            at = 0
            if (item%subscripts == 1) at = max(0, item%subscript(1) - 1)
            if (item%list) at = item%before
            if (item%subscripts > 1 .and. .not. item%list) cycle
            do j = item%first, item%first + item%count - 1
               associate (value => group%values(j))
                  if (value%repeats > highest - at) exit
                  at = at + value%repeats
                  if (value%repeats > 1 .and. is_zero(group%text_of(value))) cycle
                  if (value%length > 0 .or. value%quoted) elements_of = max(elements_of, at)
               end associate
            end do
         end associate
      end do
   end function elements_of

   pure logical function is_zero(text)
      character(*), intent(in) :: text

      is_zero = len(text) > 0 .and. verify(text, '+-0.') == 0
   end function is_zero
end module psalm_take
