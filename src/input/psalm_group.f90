!> The groups of a NAMELIST text: items with their values and places, handed out by name and kind.
!>
!> What nobody asked for is reported with the nearest valid name, and every value that is not what was asked for with its
!> line, group and item. The scanner in `psalm_namelist` fills the groups.
module psalm_group
   use psalm_kinds, only: wp
   use psalm_number, only: parse_integer, parse_real
   use psalm_status, only: diagnostics_t
   use psalm_text, only: upper_case, to_text, nearest_name
   implicit none (type, external)
   private
   public :: group_t, item_t, value_t, add_item, add_value
   public :: read_flag, check_flags, check_range, out_of, required

   integer, parameter :: name_length = 31          !! longest name kept
   integer, parameter :: most_values = 20000000    !! values one item may have, repeat counts included
   integer, parameter :: not_a_position = -1
   integer, parameter :: values_a_line = 10        !! when a group is written again

   !> One value as written, perhaps repeated.
   type :: value_t
      character(:), allocatable :: text  !! the characters; empty for a null value
      integer :: repeats = 1             !! repeat count
      integer :: line = 0                !! line of the file
      logical :: quoted = .false.        !! given in quotes
   end type value_t

   !> One item: name, subscripts, values.
   type :: item_t
      character(name_length) :: name = ''   !! in capitals
      integer :: line = 0                   !! line of its name
      integer :: subscripts = 0             !! how many: 0, 1 or 2
      integer :: subscript(2) = 0           !! the subscripts
      type(value_t), allocatable :: values(:)
      integer :: count = 0                  !! valid elements of `values`
   end type item_t

   !> One group: its items and who asked for them.
   type :: group_t
      character(name_length) :: name = ''   !! in capitals, without `&`
      integer :: line = 0                   !! line of its name; 0: the group was not given
      type(item_t), allocatable :: items(:)
      integer :: count = 0                  !! valid elements of `items`
      character(name_length), allocatable :: known(:) !! names asked for so far
   contains
      procedure :: given
      procedure :: item_line
      procedure :: get_integer
      procedure :: get_real
      procedure :: get_word
      procedure :: get_integers
      procedure :: get_reals
      procedure :: finish
      procedure :: render
   end type group_t

contains

   !> Append a value to an item.
   pure subroutine add_value(item, value)
      type(item_t), intent(inout) :: item
      type(value_t), intent(in) :: value
      type(value_t), allocatable :: larger(:)

      if (item%count == size(item%values)) then
         allocate (larger(2*item%count))
         larger(:item%count) = item%values
         call move_alloc(larger, item%values)
      end if
      item%count = item%count + 1
      item%values(item%count) = value
   end subroutine add_value

   !> Append an item to a group.
   pure subroutine add_item(group, item)
      type(group_t), intent(inout) :: group
      type(item_t), intent(in) :: item
      type(item_t), allocatable :: larger(:)

      if (group%count == size(group%items)) then
         allocate (larger(2*group%count))
         larger(:group%count) = group%items
         call move_alloc(larger, group%items)
      end if
      group%count = group%count + 1
      group%items(group%count) = item
   end subroutine add_item

   ! ---- handing out items -------------------------------------------------------------------------------------------

   !> True if the item has at least one value.
   pure logical function given(self, name)
      class(group_t), intent(in) :: self
      character(*), intent(in) :: name

      given = self%item_line(name) > 0
   end function given

   !> Line of the item (its last mention), 0 if not given.
   pure integer function item_line(self, name)
      class(group_t), intent(in) :: self
      character(*), intent(in) :: name
      integer :: i

      item_line = 0
      do i = 1, self%count
         if (self%items(i)%name == name) item_line = self%items(i)%line
      end do
   end function item_line

   !> One integer; left as it is if the item is not given.
   subroutine get_integer(self, name, value, findings)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(inout) :: value
      type(diagnostics_t), intent(inout) :: findings
      integer :: values(1)

      values = value
      call self%get_integers(name, values, findings)
      value = values(1)
   end subroutine get_integer

   !> One real; left as it is if the item is not given.
   subroutine get_real(self, name, value, findings)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      real(wp), intent(inout) :: value
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: values(1)

      values = value
      call self%get_reals(name, values, findings)
      value = values(1)
   end subroutine get_real

   !> One word in capitals (quoted or not); left as it is if the item is not given.
   subroutine get_word(self, name, value, findings)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      character(:), allocatable, intent(inout) :: value
      type(diagnostics_t), intent(inout) :: findings
      integer :: i

      self%known = [character(name_length) :: self%known, padded(name)]
      do i = 1, self%count
         if (self%items(i)%name /= name) cycle
         if (self%items(i)%count /= 1) then
            call findings%error('expects one word', line=self%items(i)%line, group=trim(self%name), item=name)
         else
            value = upper_case(self%items(i)%values(1)%text)
         end if
      end do
   end subroutine get_word

   !> Integers, from the first element on; elements without a value are left as they are.
   !>
   !> `columns` is the length of a row when two subscripts are given. With `excess` values beyond the end of `values` are
   !> allowed if they are zero (`excess = 0`) or whatever they are (`excess = 1`). `last` is the highest element given.
   subroutine get_integers(self, name, values, findings, columns, excess, last)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(inout) :: values(:)                !! shape (n)
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(in), optional :: columns, excess
      integer, intent(out), optional :: last
      integer :: i, j, k, first, number, highest
      logical :: valid

      self%known = [character(name_length) :: self%known, padded(name)]
      highest = 0
      do i = 1, self%count
         if (self%items(i)%name /= name) cycle
         associate (item => self%items(i))
            call start_of(self, item, size(values), findings, first, columns)
            if (first == not_a_position) cycle
            each_value: do j = 1, item%count
               if (item%values(j)%repeats > most_values - first) then
                  call too_many(self, item, item%values(j), size(values), findings)
                  exit each_value
               end if
               number = 0
               if (len(item%values(j)%text) > 0) then
                  call to_integer(self, item, item%values(j), number, valid, findings)
                  if (.not. valid) exit each_value
                  k = min(first + item%values(j)%repeats - 1, size(values))
                  values(first:k) = number
                  if (first + item%values(j)%repeats - 1 > size(values)) then
                     if (.not. tolerated(excess, number == 0)) then
                        call too_many(self, item, item%values(j), size(values), findings)
                        exit each_value
                     end if
                  end if
               end if
               first = first + item%values(j)%repeats
               highest = max(highest, first - 1)
            end do each_value
         end associate
      end do
      if (present(last)) last = highest
   end subroutine get_integers

   !> Reals, in the manner of `get_integers`.
   subroutine get_reals(self, name, values, findings, columns, excess, last)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      real(wp), intent(inout) :: values(:)               !! shape (n)
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(in), optional :: columns, excess
      integer, intent(out), optional :: last
      integer :: i, j, k, first, highest
      real(wp) :: number
      logical :: valid

      self%known = [character(name_length) :: self%known, padded(name)]
      highest = 0
      do i = 1, self%count
         if (self%items(i)%name /= name) cycle
         associate (item => self%items(i))
            call start_of(self, item, size(values), findings, first, columns)
            if (first == not_a_position) cycle
            each_value: do j = 1, item%count
               if (item%values(j)%repeats > most_values - first) then
                  call too_many(self, item, item%values(j), size(values), findings)
                  exit each_value
               end if
               if (len(item%values(j)%text) > 0) then
                  call to_real(self, item, item%values(j), number, valid, findings)
                  if (.not. valid) exit each_value
                  k = min(first + item%values(j)%repeats - 1, size(values))
                  values(first:k) = number
                  if (first + item%values(j)%repeats - 1 > size(values)) then
                     if (.not. tolerated(excess, number == 0.0_wp)) then
                        call too_many(self, item, item%values(j), size(values), findings)
                        exit each_value
                     end if
                  end if
               end if
               first = first + item%values(j)%repeats
               highest = max(highest, first - 1)
            end do each_value
         end associate
      end do
      if (present(last)) last = highest
   end subroutine get_reals

   !> Report items that nobody asked for, each with the nearest valid name, and scalars given twice.
   subroutine finish(self, findings)
      class(group_t), intent(in) :: self
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: near, text
      integer :: i, j

      do i = 1, self%count
         associate (item => self%items(i))
            if (all(self%known /= item%name)) then
               near = nearest_name(item%name, self%known)
               text = 'no such item'
               if (len(near) > 0) text = text//'; did you mean '//near//'?'
               call findings%error(text, line=item%line, group=trim(self%name), item=trim(item%name))
               cycle
            end if
            if (item%subscripts > 0) cycle
            do j = 1, i - 1
               if (self%items(j)%name == item%name .and. self%items(j)%subscripts == 0) then
                  call findings%warning('given twice (first in line '//to_text(self%items(j)%line)//'); the last counts', &
                                        line=item%line, group=trim(self%name), item=trim(item%name))
                  exit
               end if
            end do
         end associate
      end do
   end subroutine finish

   !> The group as text again, one item a line. Shape of the result: one text, lines separated by line feeds.
   function render(self) result(text)
      class(group_t), intent(in) :: self
      character(:), allocatable :: text
      integer :: i, k

      text = ' &'//trim(self%name)//new_line('a')
      do i = 1, self%count
         associate (item => self%items(i))
            text = text//'  '//trim(item%name)
            if (item%subscripts == 1) text = text//'('//to_text(item%subscript(1))//')'
            if (item%subscripts == 2) text = text//'('//to_text(item%subscript(1))//','//to_text(item%subscript(2))//')'
            text = text//'='
            do k = 1, item%count
               associate (value => item%values(k))
                  if (value%repeats > 1) text = text//to_text(value%repeats)//'*'
                  if (value%quoted) then
                     text = text//"'"//value%text//"'"
                  else
                     text = text//value%text
                  end if
                  text = text//','
                  if (mod(k, values_a_line) == 0) text = text//new_line('a')//'   '
               end associate
            end do
            text = text//new_line('a')
         end associate
      end do
      text = text//' &END'//new_line('a')
   end function render

   !> First element an item fills; `not_a_position` after reporting a subscript out of range.
   subroutine start_of(group, item, n, findings, first, columns)
      type(group_t), intent(in) :: group
      type(item_t), intent(in) :: item
      integer, intent(in) :: n
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(out) :: first
      integer, intent(in), optional :: columns

      first = 1
      if (item%count == 0) then
         call findings%warning('no value given', line=item%line, group=trim(group%name), item=trim(item%name))
      end if
      select case (item%subscripts)
      case (1)
         first = item%subscript(1)
      case (2)
         if (.not. present(columns)) then
            call findings%error('takes one subscript, not two', line=item%line, group=trim(group%name), item=trim(item%name))
            first = not_a_position
            return
         end if
         first = (item%subscript(1) - 1)*columns + item%subscript(2)
         if (item%subscript(1) < 1 .or. item%subscript(2) < 1 .or. item%subscript(2) > columns) first = 0
      end select
      if (first < 1 .or. first > n) then
         call findings%error('subscript out of range; there are '//to_text(n)//' elements', line=item%line, &
                             group=trim(group%name), item=trim(item%name))
         first = not_a_position
      end if
   end subroutine start_of

   subroutine too_many(group, item, value, n, findings)
      type(group_t), intent(in) :: group
      type(item_t), intent(in) :: item
      type(value_t), intent(in) :: value
      integer, intent(in) :: n
      type(diagnostics_t), intent(inout) :: findings

      if (n == 1) then
         call findings%error("too many values: one is expected, '"//value%text//"' is one too many", &
                             line=value%line, group=trim(group%name), item=trim(item%name))
      else
         call findings%error('too many values: there is room for '//to_text(n)//", and '"//value%text// &
                             "' goes beyond (only zeros may fill up)", line=value%line, group=trim(group%name), &
                             item=trim(item%name))
      end if
   end subroutine too_many

   pure logical function tolerated(excess, is_zero)
      integer, intent(in), optional :: excess
      logical, intent(in) :: is_zero

      tolerated = .false.
      if (present(excess)) tolerated = excess > 0 .or. is_zero
   end function tolerated

   subroutine to_integer(group, item, value, number, valid, findings)
      type(group_t), intent(in) :: group
      type(item_t), intent(in) :: item
      type(value_t), intent(in) :: value
      integer, intent(out) :: number
      logical, intent(out) :: valid
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: reason

      reason = 'an integer is expected'
      number = 0
      valid = .not. value%quoted
      if (valid) call parse_integer(value%text, number, valid, reason)
      if (.not. valid) call findings%error(reason//"; found '"//value%text//"'", line=value%line, &
                                           group=trim(group%name), item=trim(item%name))
   end subroutine to_integer

   subroutine to_real(group, item, value, number, valid, findings)
      type(group_t), intent(in) :: group
      type(item_t), intent(in) :: item
      type(value_t), intent(in) :: value
      real(wp), intent(out) :: number
      logical, intent(out) :: valid
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: reason

      reason = 'a number is expected'
      number = 0.0_wp
      valid = .not. value%quoted
      if (valid) call parse_real(value%text, number, valid, reason)
      if (.not. valid) call findings%error(reason//"; found '"//value%text//"'", line=value%line, &
                                           group=trim(group%name), item=trim(item%name))
   end subroutine to_real

   pure function padded(name)
      character(*), intent(in) :: name
      character(name_length) :: padded

      padded = name
   end function padded

   !> An item that is 0 or 1.
   subroutine read_flag(group, name, value, findings)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      integer, intent(inout) :: value
      type(diagnostics_t), intent(inout) :: findings

      call group%get_integer(name, value, findings)
      call check_range(group, name, value, 0, 1, findings)
   end subroutine read_flag

   !> Report entries that are neither 0 nor 1.
   subroutine check_flags(group, name, values, findings)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: name
      integer, intent(in) :: values(:, :)
      type(diagnostics_t), intent(inout) :: findings

      if (any(values /= 0 .and. values /= 1)) call out_of(group, name, 'entries are 0 (fixed) or 1 (may vary)', findings)
   end subroutine check_flags

   !> Report a value outside its range.
   subroutine check_range(group, name, value, lowest, highest, findings, required)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: name
      integer, intent(in) :: value, lowest, highest
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in), optional :: required
      character(:), allocatable :: text

      if (present(required)) then
         if (required .and. .not. group%given(name)) then
            call findings%error('is required', line=group%line, group=trim(group%name), item=name)
            return
         end if
      end if
      if (value >= lowest .and. value <= highest) return
      text = 'must be at least '//to_text(lowest)
      if (highest < huge(1)) text = 'must lie in '//to_text(lowest)//' to '//to_text(highest)
      call findings%error(text//'; found '//to_text(value), line=group%item_line(name), group=trim(group%name), item=name)
   end subroutine check_range

   !> Report an item whose value cannot be.
   subroutine out_of(group, name, text, findings)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: name, text
      type(diagnostics_t), intent(inout) :: findings

      call findings%error(text, line=group%item_line(name), group=trim(group%name), item=name)
   end subroutine out_of

   !> Report an item that is missing.
   subroutine required(group, name, findings)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: name
      type(diagnostics_t), intent(inout) :: findings

      call findings%error('is required', line=group%line, group=trim(group%name), item=name)
   end subroutine required
end module psalm_group
