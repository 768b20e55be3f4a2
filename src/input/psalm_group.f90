!> The groups of a NAMELIST text: items with their values and places, handed out by name and kind.
!>
!> What nobody asked for is reported with the nearest valid name, and every value that is not what was asked for with its
!> line, group and item. The scanner in `psalm_namelist` fills the groups. Values and their characters lie in one row each,
!> so that a group of a million values is read, copied and written in time linear in its size.
module psalm_group
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: wp
   use psalm_number, only: parse_integer, parse_real
   use psalm_origin, only: origins_t, name_length
   use psalm_rule, only: rule_t, value_rule_t, any_number, meaning_length
   use psalm_sort, only: ascending
   use psalm_status, only: diagnostics_t
   use psalm_text, only: quoted, text_t, upper_case, to_text, nearest_name, shortened
   implicit none (type, external)
   private
   public :: group_t, item_t, value_t, add_item, add_value
   public :: check_flags, check_range, out_of, required

   integer, parameter :: most_values = 20000000    !! values one item may have, repeat counts included
   integer, parameter :: not_a_position = -1
   integer, parameter :: most_texts = 100000       !! elements of an array of texts
   integer, parameter :: most_unknown = 5          !! unknown items of a group that are named
   integer, parameter :: values_a_line = 10        !! when a group is written again

   !> One value as written, perhaps repeated.
   type :: value_t
      integer :: first = 1               !! its first character in the group's
      integer :: length = 0              !! how many; 0 for a null value
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
      logical :: misplaced = .false.        !! its subscript is wrong and reported: the values are left out
      logical :: list = .false.             !! of JSON: an array; with two subscripts a row of one
      integer :: before = 0                 !! values of the rows before it
      integer :: first = 1                  !! its first value in the group's
      integer :: count = 0                  !! how many values
   end type item_t

   !> An item that must be there and is not.
   type :: missing_t
      character(name_length) :: name = ''
      character(:), allocatable :: text     !! what is said
   end type missing_t

   !> One group: its items and who asked for them.
   type :: group_t
      character(name_length) :: name = ''   !! in capitals, without `&`
      integer :: line = 0                   !! line of its name; 0: the group was not given
      type(item_t), allocatable :: items(:)
      integer :: count = 0                  !! valid elements of `items`
      type(value_t), allocatable :: values(:)
      integer :: filled = 0                 !! valid elements of `values`
      type(text_t) :: characters            !! of all values
      integer, allocatable :: order(:)      !! the items by name, those of one name as they were written
      type(value_rule_t), allocatable :: rules(:) !! what its items may be
      character(meaning_length), allocatable :: meanings(:) !! of its items, by rule; not of a group that is not given
      integer :: next_rule = 1              !! the rule behind that of the item asked for last
      character(name_length), allocatable :: known(:) !! names of its items: those of the rules, and asked for so far
      integer :: next_known = 1             !! the name behind that asked for last
      type(origins_t) :: origins            !! places of the values handed out
      logical :: count_missing = .false.    !! the item that counts the others is wrong: too many of them are not reported
      type(missing_t), allocatable :: missing(:) !! reported at the end, if no misspelt item is meant
   contains
      procedure :: begin
      procedure :: follow
      procedure :: forget
      procedure :: sort_items
      procedure :: text_of
      procedure :: given
      procedure :: item_line
      procedure :: get_integer
      procedure :: get_real
      procedure :: get_word
      procedure :: get_texts
      procedure :: get_integers
      procedure :: get_reals
      procedure :: finish
      procedure :: render
      procedure :: render_item
   end type group_t

contains

   !> Make an empty group of that name.
   pure subroutine begin(self, name, line)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(in) :: line  !! 0 if not given

      self%name = name
      self%line = line
      self%count_missing = .false.
      self%count = 0
      self%filled = 0
      self%characters%length = 0
      if (.not. allocated(self%items)) allocate (self%items(16), self%values(16))
      if (allocated(self%known)) deallocate (self%known)
      allocate (self%known(0))
      self%next_known = 1
      if (allocated(self%missing)) deallocate (self%missing)
      allocate (self%missing(0))
      if (allocated(self%order)) deallocate (self%order)
      allocate (self%order(0))
      call self%origins%clear()
      if (line > 0) call self%origins%mention(name, '', line)
   end subroutine begin

   !> Take the table of the group's items, which has their names.
   pure subroutine follow(self, rules)
      class(group_t), intent(inout) :: self
      type(rule_t), intent(in) :: rules(:)
      integer :: i

      if (allocated(self%rules)) deallocate (self%rules)
      allocate (self%rules(size(rules)))
      do i = 1, size(rules)
         associate (own => self%rules(i))
            own%name = rules(i)%name
            own%kind = rules(i)%kind
            own%shape = rules(i)%shape
            own%default = rules(i)%default
            own%values = rules(i)%values
            own%complaint = rules(i)%complaint
         end associate
      end do
      if (self%line > 0) self%meanings = rules%meaning
      self%next_rule = 1
      self%next_known = size(self%known) + 1
      self%known = [character(name_length) :: self%known, pack(rules%name, .not. is_counted(rules%name))]
   end subroutine follow

   !> Let the table go: all items have been asked for. The names of the items stay.
   pure subroutine forget(self)
      class(group_t), intent(inout) :: self

      if (allocated(self%rules)) deallocate (self%rules)
      if (allocated(self%meanings)) deallocate (self%meanings)
   end subroutine forget

   !> True for a name that ends in the sign for any number.
   elemental logical function is_counted(name)
      character(*), intent(in) :: name
      integer :: i

      is_counted = .false.
      do i = 1, len(name)
         is_counted = is_counted .or. name(i:i) == any_number
      end do
   end function is_counted

   !> Note that a name is one of an item.
   pure subroutine know(self, name)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      integer, parameter :: compared = 8         ! characters that one number holds; few names begin with the same
      character(name_length) :: wanted
      integer(int64) :: bits
      integer :: i, k

      ! each item of each group is looked up, and a comparison of texts is a call; most are asked for in the order of the table
      wanted = name
      bits = transfer(wanted(:compared), bits)
      do i = self%next_known, self%next_known + size(self%known) - 1
         k = merge(i, i - size(self%known), i <= size(self%known))
         if (transfer(self%known(k)(:compared), bits) /= bits) cycle
         if (self%known(k) /= wanted) cycle
         self%next_known = k + 1
         return
      end do
      self%known = [character(name_length) :: self%known, wanted]
   end subroutine know

   !> Append a value to the item read last.
   pure subroutine add_value(group, value, text)
      type(group_t), intent(inout) :: group
      type(value_t), intent(in) :: value
      character(*), intent(in) :: text  !! its characters
      type(value_t), allocatable :: larger(:)

      if (group%filled == size(group%values)) then
         allocate (larger(2*group%filled))
         larger(:group%filled) = group%values
         call move_alloc(larger, group%values)
      end if
      group%filled = group%filled + 1
      group%values(group%filled) = value
      group%values(group%filled)%first = group%characters%length + 1
      group%values(group%filled)%length = len(text)
      call group%characters%add_text(text)
      group%items(group%count)%count = group%items(group%count)%count + 1
   end subroutine add_value

   !> Append an item to a group; the values that follow are its.
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
      group%items(group%count)%first = group%filled + 1
      group%items(group%count)%count = 0
   end subroutine add_item

   !> Put the items in the order of their names, so that they can be found.
   pure subroutine sort_items(self)
      class(group_t), intent(inout) :: self

      self%order = ascending(self%items(:self%count)%name)
   end subroutine sort_items

   !> The items of a name are `order(first:last)`, in the order in which they were written.
   pure subroutine find(self, name, first, last)
      class(group_t), intent(in) :: self
      character(*), intent(in) :: name
      integer, intent(out) :: first, last
      integer :: low, high, middle

      low = 1
      high = size(self%order) + 1
      do while (low < high)
         middle = (low + high)/2
         if (self%items(self%order(middle))%name < name) then
            low = middle + 1
         else
            high = middle
         end if
      end do
      first = low
      last = low - 1
      do while (last < size(self%order))
         if (self%items(self%order(last + 1))%name /= name) exit
         last = last + 1
      end do
   end subroutine find

   !> The characters of a value.
   pure function text_of(self, value) result(text)
      class(group_t), intent(in) :: self
      type(value_t), intent(in) :: value
      character(value%length) :: text

      if (value%length > 0) text = self%characters%buffer(value%first:value%first + value%length - 1)
   end function text_of

   ! ---- handing out items -------------------------------------------------------------------------------------------

   !> True if the item was given.
   pure logical function given(self, name)
      class(group_t), intent(in) :: self
      character(*), intent(in) :: name

      given = self%item_line(name) > 0
   end function given

   !> Line of the item (its last mention), 0 if not given.
   pure integer function item_line(self, name)
      class(group_t), intent(in) :: self
      character(*), intent(in) :: name
      integer :: first, last

      item_line = 0
      call find(self, name, first, last)
      if (last >= first) item_line = self%items(self%order(last))%line
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
      integer :: k, first, last

      call know(self, name)
      call find(self, name, first, last)
      do k = first, last
         associate (item => self%items(self%order(k)))
            call self%origins%mention(trim(self%name), name, item%line)
            if (item%misplaced) cycle
            if (item%count /= 1 .or. item%subscripts > 0) then
               call findings%error('expects one word', line=item%line, group=trim(self%name), item=name)
            else
               value = shortened(upper_case(self%text_of(self%values(item%first))))
               call self%origins%place(1, 1, self%values(item%first)%line)
            end if
         end associate
      end do
   end subroutine get_word

   !> An array of texts as they were written, quoted or not; as many as are given, those between that are not given empty.
   subroutine get_texts(self, name, texts, findings)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      character(:), allocatable, intent(out) :: texts(:)
      type(diagnostics_t), intent(inout) :: findings
      integer :: k, j, from, to, first, highest, longest

      call know(self, name)
      call find(self, name, from, to)
      highest = 0
      longest = 1
      do k = from, to
         associate (item => self%items(self%order(k)))
            if (item%misplaced) cycle
            call start_of(self, item, most_texts, findings, first)
            if (first == not_a_position) cycle
            do j = item%first, item%first + item%count - 1
               if (self%values(j)%repeats > most_texts - first) then
                  call too_many(self, item, self%values(j), most_texts, .false., findings)
                  exit
               end if
               first = first + self%values(j)%repeats
               longest = max(longest, self%values(j)%length)
            end do
            highest = max(highest, first - 1)
         end associate
      end do
      allocate (character(longest) :: texts(highest))
      texts(:) = ''   ! of the whole array it would give the elements no length
      do k = from, to
         associate (item => self%items(self%order(k)))
            call self%origins%mention(trim(self%name), name, item%line)
            if (item%misplaced) cycle
            first = 1
            if (item%subscripts == 1) first = item%subscript(1)
            if (item%list) first = item%before + 1
            if (item%list) call self%origins%as_list(merge(item%subscript(1), 0, item%subscripts == 2), first)
            if ((item%subscripts > 1 .and. .not. item%list) .or. first > highest) cycle
            do j = item%first, item%first + item%count - 1
               associate (value => self%values(j))
                  if (first + value%repeats - 1 > highest) exit
                  if (value%length > 0) then
                     texts(first:first + value%repeats - 1) = self%text_of(value)
                     call self%origins%place(first, first + value%repeats - 1, value%line)
                  end if
                  first = first + value%repeats
               end associate
            end do
         end associate
      end do
   end subroutine get_texts

   !> Integers, from the first element on; elements without a value are left as they are.
   !>
   !> `columns` is the length of a row when two subscripts are given. Values beyond the end of `values` are an error, unless
   !> they are zero and `filler` is true, or `beyond` is there: then it is the line of the first of them that is not zero
   !> (0: there is none), and the caller assesses. With `as_written` a zero counts like any other value, unless it is repeated
   !> (`161*0.0`), and with `any_filler` whatever is repeated may go beyond the end. `last` is the highest element given,
   !> `needed` the highest that is no such filler.
   subroutine get_integers(self, name, values, findings, columns, filler, last, needed, beyond)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(inout) :: values(:)                !! shape (n)
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(in), optional :: columns
      logical, intent(in), optional :: filler
      integer, intent(out), optional :: last, needed, beyond

      call hand_out(self, name, size(values), findings, columns, filler, last, needed, beyond, integers=values)
   end subroutine get_integers

   !> Reals, in the manner of `get_integers`.
   subroutine get_reals(self, name, values, findings, columns, filler, last, needed, beyond, as_written, any_filler)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      real(wp), intent(inout) :: values(:)               !! shape (n)
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(in), optional :: columns
      logical, intent(in), optional :: filler, as_written, any_filler
      integer, intent(out), optional :: last, needed, beyond

      call hand_out(self, name, size(values), findings, columns, filler, last, needed, beyond, as_written, any_filler, &
                    reals=values)
   end subroutine get_reals

   !> What `get_integers` and `get_reals` have in common: either `integers` or `reals` is there.
   subroutine hand_out(self, name, n, findings, columns, filler, last, needed, beyond, as_written, any_filler, integers, reals)
      class(group_t), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(in) :: n                           !! elements there are
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(in), optional :: columns
      logical, intent(in), optional :: filler, as_written, any_filler
      integer, intent(out), optional :: last, needed, beyond
      integer, intent(inout), optional :: integers(:)    !! shape (n)
      real(wp), intent(inout), optional :: reals(:)      !! shape (n)
      integer :: k, j, from, to, first, final, whole, highest, highest_needed, line_beyond
      real(wp) :: number
      logical :: valid, fills
      logical :: zero                                    !! the value may fill up

      call know(self, name)
      fills = .false.
      if (present(filler)) fills = filler
      highest = 0
      highest_needed = 0
      line_beyond = 0
      whole = 0
      number = 0.0_wp
      call find(self, name, from, to)
      do k = from, to
         associate (item => self%items(self%order(k)))
            call self%origins%mention(trim(self%name), name, item%line)
            if (item%misplaced) cycle
            call start_of(self, item, n, findings, first, columns)
            if (first == not_a_position) cycle
            if (item%list) call self%origins%as_list(merge(item%subscript(1), 0, item%subscripts == 2), first)
            each_value: do j = item%first, item%first + item%count - 1
               if (self%values(j)%repeats > most_values - first) then
                  call too_many(self, item, self%values(j), n, fills, findings)
                  exit each_value
               end if
               final = first + self%values(j)%repeats - 1
               if (self%values(j)%length > 0 .or. self%values(j)%quoted) then
                  call to_number(self, item, self%values(j), present(integers), first, whole, number, valid, findings)
                  if (.not. valid) exit each_value
                  if (present(integers)) then
                     integers(first:min(final, n)) = whole
                     zero = whole == 0
                  else
                     reals(first:min(final, n)) = number
                     zero = number == 0.0_wp
                  end if
                  if (present(as_written)) then
                     if (as_written) zero = zero .and. self%values(j)%repeats > 1
                  end if
                  if (present(any_filler)) zero = zero .or. (any_filler .and. self%values(j)%repeats > 1)
                  if (first <= n) call self%origins%place(first, min(final, n), self%values(j)%line)
                  if (.not. zero) highest_needed = max(highest_needed, final)
                  if (final > n) then
                     if (present(beyond)) then
                        if (line_beyond == 0 .and. .not. zero) line_beyond = self%values(j)%line
                     else if (.not. (self%count_missing .or. (fills .and. zero))) then
                        call too_many(self, item, self%values(j), n, fills, findings)
                        exit each_value
                     end if
                  end if
               end if
               first = final + 1
               highest = max(highest, final)
            end do each_value
         end associate
      end do
      if (present(last)) last = highest
      if (present(needed)) needed = highest_needed
      if (present(beyond)) beyond = line_beyond
   end subroutine hand_out

   !> Report items that nobody asked for, each with the group it belongs to or the nearest valid name, scalars given twice,
   !> and items that are missing, unless a misspelt one is meant.
   !>
   !> `all_groups` have been asked for all their items, so that they know their names.
   subroutine finish(self, all_groups, findings)
      class(group_t), intent(in) :: self
      type(group_t), intent(in) :: all_groups(:)
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: earlier(:)  !! by item: line of an earlier mention, 0: none
      logical, allocatable :: known(:)    !! by item
      logical :: meant(size(self%missing))
      integer :: i, k, run, first_line, unknown
      logical :: is_known

      allocate (earlier(self%count), known(self%count))
      run = 1
      first_line = 0
      is_known = .false.
      do k = 1, self%count
         i = self%order(k)
         if (self%items(i)%name /= self%items(self%order(run))%name .or. k == 1) then
            run = k
            first_line = 0
            is_known = any(self%known == self%items(i)%name)
         end if
         known(i) = is_known
         earlier(i) = first_line
         if (self%items(i)%subscripts > 0 .or. self%items(i)%misplaced) then
            earlier(i) = 0
         else if (first_line == 0) then
            first_line = self%items(i)%line
         end if
      end do
      unknown = 0
      meant = .false.
      do i = 1, self%count
         associate (item => self%items(i))
            if (.not. known(i)) then
               unknown = unknown + 1
               if (unknown > most_unknown) cycle
               meant = meant .or. self%missing%name == nearest_name(item%name, self%known)
               call findings%error('no such item'//hint(item%name), line=item%line, group=trim(self%name), &
                                   item=trim(item%name))
            else if (earlier(i) > 0) then
               call findings%warning('given twice (first in line '//to_text(earlier(i))//'); the last counts', &
                                     line=item%line, group=trim(self%name), item=trim(item%name))
            end if
         end associate
      end do
      if (unknown > most_unknown) call findings%error('and '//to_text(unknown - most_unknown)//' more unknown items', &
                                                      line=self%line, group=trim(self%name))
      do i = 1, size(self%missing)
         if (.not. meant(i)) call findings%error(self%missing(i)%text, line=self%line, group=trim(self%name), &
                                                 item=trim(self%missing(i)%name))
      end do

   contains

      function hint(name) result(text)
         character(*), intent(in) :: name
         character(:), allocatable :: text
         integer :: g

         text = ''
         do g = 1, size(all_groups)
            if (any(all_groups(g)%known == name)) then
               text = '; it belongs to &'//trim(all_groups(g)%name)
               return
            end if
         end do
         text = nearest_name(name, self%known)
         if (len(text) > 0) then
            text = '; did you mean '//text//'?'
            return
         end if
         do g = 1, size(all_groups)
            text = nearest_name(name, all_groups(g)%known)
            if (len(text) > 0) then
               text = '; did you mean '//text//' of &'//trim(all_groups(g)%name)//'?'
               return
            end if
         end do
      end function hint
   end subroutine finish

   !> Append the group to a text, one item a line.
   subroutine render(self, text)
      class(group_t), intent(in) :: self
      type(text_t), intent(inout) :: text
      integer :: i

      call text%add(' &'//trim(self%name))
      do i = 1, self%count
         call self%render_item(i, text)
      end do
      call text%add(' &END')
   end subroutine render

   !> Append an item as it was written.
   subroutine render_item(self, i, text)
      class(group_t), intent(in) :: self
      integer, intent(in) :: i
      type(text_t), intent(inout) :: text
      integer :: k

      associate (item => self%items(i))
         call text%add_text('  '//trim(item%name))
         if (item%subscripts == 1) call text%add_text('('//to_text(item%subscript(1))//')')
         if (item%subscripts == 2) call text%add_text('('//to_text(item%subscript(1))//','//to_text(item%subscript(2))//')')
         call text%add_text('=')
         do k = 1, item%count
            associate (value => self%values(item%first + k - 1))
               if (value%repeats > 1) call text%add_text(to_text(value%repeats)//'*')
               if (value%quoted) then
                  call text%add_text(quoted(self%text_of(value)))
               else
                  call text%add_text(self%text_of(value))
               end if
               call text%add_text(',')
               if (mod(k, values_a_line) == 0) call text%add_text(new_line('a')//'   ')
            end associate
         end do
         call text%add()
      end associate
   end subroutine render_item

   !> First element an item fills; `not_a_position` after reporting a subscript out of range.
   subroutine start_of(group, item, n, findings, first, columns)
      type(group_t), intent(in) :: group
      type(item_t), intent(in) :: item
      integer, intent(in) :: n
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(out) :: first
      integer, intent(in), optional :: columns
      character(:), allocatable :: there_are

      first = 1
      if (item%count == 0) then
         call findings%warning('no value given', line=item%line, group=trim(group%name), item=trim(item%name))
      end if
      select case (item%subscripts)
      case (0)
         return
      case (1)
         first = item%subscript(1)
         if (first >= 1 .and. first <= n) return
         there_are = trim(merge('there is one value only         ', 'there are elements 1 to '//padded_number(n), n == 1))
      case default
         if (item%list .and. .not. present(columns)) then
            first = item%before + 1
            return
         end if
         if (.not. present(columns)) then
            call findings%error('takes one subscript, not two', line=item%line, group=trim(group%name), item=trim(item%name))
            first = not_a_position
            return
         end if
         first = not_a_position
         if (columns == 0) return   ! NLOOP or MAXARC is wrong and reported
         ! each subscript by itself: their product may not be a number
         if (item%subscript(1) >= 1 .and. item%subscript(1) <= n/columns .and. &
             item%subscript(2) >= 1 .and. item%subscript(2) <= columns) then
            first = (item%subscript(1) - 1)*columns + item%subscript(2)
            return
         end if
         there_are = 'there are loops 1 to '//to_text(n/columns)//' and arcs 1 to '//to_text(columns)
      end select
      call findings%error('subscript out of range; '//there_are, line=item%line, group=trim(group%name), item=trim(item%name))
      first = not_a_position
   end subroutine start_of

   pure function padded_number(n) result(text)
      integer, intent(in) :: n
      character(8) :: text

      text = to_text(n)
   end function padded_number

   subroutine too_many(group, item, value, n, fills, findings)
      type(group_t), intent(in) :: group
      type(item_t), intent(in) :: item
      type(value_t), intent(in) :: value
      integer, intent(in) :: n
      logical, intent(in) :: fills
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: text

      if (n == 1) then
         text = "too many values: one is expected, found more, beginning with '"//shortened(group%text_of(value))//"'"
      else
         text = 'too many values: at most '//to_text(n)//" are expected; the first one beyond is '"// &
                shortened(group%text_of(value))//"'"
         if (fills) text = text//' (only zeros may follow)'
      end if
      call findings%error(text//'; the decimal sign is a point, not a comma', line=value%line, group=trim(group%name), &
                          item=trim(item%name))
   end subroutine too_many

   !> The number that a value stands for: `whole` if an integer is asked for, else `number`.
   subroutine to_number(group, item, value, integer_asked, element, whole, number, valid, findings)
      type(group_t), intent(in) :: group
      type(item_t), intent(in) :: item
      type(value_t), intent(in) :: value
      logical, intent(in) :: integer_asked
      integer, intent(in) :: element    !! which one it is
      integer, intent(inout) :: whole
      real(wp), intent(inout) :: number
      logical, intent(out) :: valid
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: reason, pointer

      valid = .not. value%quoted
      if (.not. valid) then
         reason = trim(merge('an integer is expected', 'a number is expected  ', integer_asked))
      else
         associate (text => group%characters%buffer(value%first:value%first + value%length - 1))
            if (integer_asked) then
               call parse_integer(text(:digits_of_whole(text)), whole, valid, reason)
               if (.not. valid .and. scan(text, '.') > 0) reason = 'an integer is expected, not a real with a fraction or exponent'
            else
               call parse_real(text, number, valid, reason)
            end if
         end associate
      end if
      if (valid) return
      call group%origins%pointer_to_last(element, pointer)
      call findings%error(reason//"; found '"//shortened(group%text_of(value))//"'", line=value%line, group=trim(group%name), &
                          item=trim(item%name), pointer=pointer)
   end subroutine to_number

   !> Characters of an integer without the decimal point and the zeros that may follow it: the thesis fills an array of integers
   !> up by `76*0.0` (appendix B5.2). All characters of any other text.
   pure integer function digits_of_whole(text)
      character(*), intent(in) :: text

      digits_of_whole = index(text, '.') - 1
      if (digits_of_whole < 1) digits_of_whole = len(text)
      if (verify(text(digits_of_whole + 2:), '0') > 0) digits_of_whole = len(text)
   end function digits_of_whole

   !> Report entries that are neither 0 nor 1.
   subroutine check_flags(group, name, values, findings)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: name
      integer, intent(in) :: values(:, :)   !! shape (columns, rows)
      type(diagnostics_t), intent(inout) :: findings
      integer :: wrong(2)

      wrong = findloc(values /= 0 .and. values /= 1, .true.)
      if (all(wrong > 0)) call out_of(group, name, 'entries are 0 (fixed) or 1 (may vary); found '// &
                                      to_text(values(wrong(1), wrong(2))), findings, (wrong(2) - 1)*size(values, 1) + wrong(1))
   end subroutine check_flags

   !> Report a value outside its range.
   subroutine check_range(group, name, value, lowest, highest, findings, must_be)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      integer, intent(in) :: value, lowest, highest
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in), optional :: must_be  !! the item is required
      character(:), allocatable :: text

      if (present(must_be)) then
         if (must_be .and. .not. group%given(name)) then
            call required(group, name)
            return
         end if
      end if
      if (value >= lowest .and. value <= highest) return
      text = 'must be at least '//to_text(lowest)
      if (highest < huge(1)) text = 'must be from '//to_text(lowest)//' to '//to_text(highest)
      call group%origins%error(findings, trim(group%name), name, text//'; found '//to_text(value), 1)
   end subroutine check_range

   !> Report an item whose value cannot be.
   subroutine out_of(group, name, text, findings, element)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: name, text
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(in), optional :: element  !! which value; default the first
      integer :: which

      which = 1
      if (present(element)) which = element
      call group%origins%error(findings, trim(group%name), name, text, which)
   end subroutine out_of

   !> Note an item that is missing; `finish` reports it.
   subroutine required(group, name, text)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      character(*), intent(in), optional :: text  !! what is said
      type(missing_t) :: one

      one%name = name
      one%text = 'missing; this item is required'
      if (present(text)) one%text = text
      group%missing = [group%missing, one]
   end subroutine required
end module psalm_group
