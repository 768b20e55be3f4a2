!> The NAMELIST notation, read with its place in the file so that every mistake can be named.
!>
!> `read_case` splits a text into one title and its groups; `group_t` then hands out items by name, and what nobody asked
!> for is reported with the nearest valid name. The notation is that of the Fortran standard (any case, `!` comments,
!> repeat counts `4*0.0`, null values, `&END` or `/`, also `$NAME ... $END`), with one thing more: an array over loops and
!> arcs may be given by two subscripts, `ARCL(2,3) = 31.0`.
!>
!> The run-time library's own NAMELIST reader is not used: it gives no line, blames the wrong item, takes `Inf` and `NaN`,
!> cannot say how many values were given, and needs arrays of fixed size.
module psalm_namelist
   use psalm_group, only: group_t, item_t, value_t, add_item, add_value
   use psalm_number, only: parse_integer
   use psalm_origin, only: name_length
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: upper_case, to_text, shortened
   implicit none (type, external)
   private
   public :: case_text_t, read_case

   !> One case: title and groups.
   type :: case_text_t
      character(:), allocatable :: title    !! as written
      integer :: line = 0                   !! line of the title
      type(group_t), allocatable :: groups(:)
      integer :: count = 0                  !! valid elements of `groups`
   contains
      procedure :: take
      procedure :: make
   end type case_text_t

   integer, parameter :: most_groups = 1000 !! of a case; above this the file is taken for something else

   !> Where the scanner stands.
   type :: cursor_t
      integer :: line = 1
      integer :: column = 1
   end type cursor_t

contains

   !> Read one case, beginning at line `next`; `next` is left at the title of the following case, or past the end.
   !>
   !> Errors (in `findings`): nothing but blank lines, a title that is a group, groups that are not closed or given twice,
   !> text that is not `NAME = values`.
   subroutine read_case(lines, next, case, findings)
      type(line_t), intent(in) :: lines(:)              !! the whole file
      integer, intent(inout) :: next                    !! first line to look at
      type(case_text_t), intent(out) :: case            !! title and groups
      type(diagnostics_t), intent(inout) :: findings
      type(cursor_t) :: at

      allocate (case%groups(4))
      case%title = ''
      do while (next <= size(lines))
         if (.not. is_blank_or_comment(lines(next)%text, 1)) exit
         next = next + 1
      end do
      if (next > size(lines)) return
      case%line = next
      if (starts_group(lines(next)%text, 1)) then
         call findings%error('the first line of a case is its title, but here is the group '//first_word(lines(next)%text)// &
                             '; put a title line before it', line=next)
      else
         case%title = trim(lines(next)%text)
         next = next + 1
      end if
      do while (next <= size(lines))
         if (is_blank_or_comment(lines(next)%text, 1)) then
            next = next + 1
         else if (starts_group(lines(next)%text, 1)) then
            at = cursor_t(next, next_nonblank(lines(next)%text, 1))
            call read_group(lines, at, case, findings)
            next = at%line
         else
            exit
         end if
      end do
   end subroutine read_case

   !> Take the group of that name out of the case; its `line` is 0 if the case has none.
   subroutine take(self, name, group)
      class(case_text_t), intent(inout) :: self
      character(*), intent(in) :: name !! in capitals
      type(group_t), intent(out) :: group
      integer :: i

      do i = 1, self%count
         if (self%groups(i)%name /= name) cycle
         group = self%groups(i)
         call group%sort_items()
         return
      end do
      call group%begin(name, 0)
   end subroutine take

   !> Place of the group of that name, which becomes an empty one, put down to that line, if the case has none.
   pure subroutine make(self, name, line, place)
      class(case_text_t), intent(inout) :: self
      character(*), intent(in) :: name !! in capitals
      integer, intent(in) :: line
      integer, intent(out) :: place
      type(group_t), allocatable :: larger(:)

      place = findloc(self%groups(:self%count)%name == name, .true., dim=1)
      if (place > 0) return
      if (self%count == size(self%groups)) then
         allocate (larger(self%count + 1))
         larger(:self%count) = self%groups(:self%count)
         call move_alloc(larger, self%groups)
      end if
      self%count = self%count + 1
      place = self%count
      call self%groups(place)%begin(name, line)
   end subroutine make

   ! ---- scanning ----------------------------------------------------------------------------------------------------

   !> Read a group, and any further groups that begin on the line where it ends; `at` is left at the start of a line.
   subroutine read_group(lines, at, case, findings)
      type(line_t), intent(in) :: lines(:)
      type(cursor_t), intent(inout) :: at
      type(case_text_t), intent(inout) :: case
      type(diagnostics_t), intent(inout) :: findings
      type(group_t), allocatable :: larger(:)
      logical :: closed
      integer :: i

      do
         if (case%count == most_groups) then
            call findings%error('more than '//to_text(most_groups)//' groups in one case', line=at%line)
            at = cursor_t(size(lines) + 1, 1)
            return
         end if
         if (case%count == size(case%groups)) then
            allocate (larger(2*case%count))
            larger(:case%count) = case%groups
            call move_alloc(larger, case%groups)
         end if
         case%count = case%count + 1
         associate (group => case%groups(case%count))
            call scan_group(lines, at, group, closed, findings)
            do i = 1, case%count - 1
               if (case%groups(i)%name == group%name) call findings%error('the group is given twice in this case (first in line ' &
                  //to_text(case%groups(i)%line)//')', line=group%line, group=trim(group%name))
            end do
            if (at%line > size(lines)) return
            if (at%column == 1) return
            associate (text => lines(at%line)%text)
               if (starts_group(text, at%column)) then
                  at%column = next_nonblank(text, at%column)
                  cycle
               end if
               if (.not. is_blank_or_comment(text, at%column)) then
                  call findings%warning("'"//shortened(text(next_nonblank(text, at%column):))// &
                                        "' after the end of the group is ignored", line=at%line, group=trim(group%name))
               end if
            end associate
         end associate
         at = cursor_t(at%line + 1, 1)
         return
      end do
   end subroutine read_group

   !> Read one group from its `&`; `at` is left behind its end, or at the line of the group that follows an unclosed one.
   subroutine scan_group(lines, at, group, closed, findings)
      type(line_t), intent(in) :: lines(:)
      type(cursor_t), intent(inout) :: at
      type(group_t), intent(inout) :: group
      logical, intent(out) :: closed
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: word
      integer :: column, stop_at, start
      logical :: complained

      closed = .false.
      complained = .false.
      column = end_of_name(lines(at%line)%text, at%column + 1) + 1
      call group%begin(name_of(lines(at%line)%text(at%column + 1:column - 1)), at%line)
      start = at%line
      each_line: do while (at%line <= size(lines))
         if (at%line > start) column = 1
         associate (text => lines(at%line)%text)
            each_token: do
               column = next_nonblank(text, column)
               if (column > len(text)) exit each_token
               select case (text(column:column))
               case ('!')
                  exit each_token
               case ('/')
                  at = cursor_t(at%line, column + 1)
                  closed = .true.
                  return
               case ('&', '$')
                  stop_at = end_of_name(text, column + 1)
                  word = name_of(text(column + 1:stop_at))
                  if (word == 'END' .or. (word == '' .and. text(column:column) == '$')) then
                     at = cursor_t(at%line, stop_at + 1)
                     closed = .true.
                  else
                     call findings%error('the group is not closed before '//text(column:column)//word// &
                                         ' in line '//to_text(at%line)//'; end it with &END or /', &
                                         line=group%line, group=trim(group%name))
                     at = cursor_t(at%line, column)
                     if (next_nonblank(text, 1) == column) at%column = 1
                  end if
                  return
               case (',', ';')
                  call add_null(group, at%line)
                  column = column + 1
               case ('a':'z', 'A':'Z', '_')
                  call scan_name_or_word(text, column, at%line, group, findings, complained)
               case default
                  call scan_value(text, column, at%line, group, findings, complained)
               end select
            end do each_token
         end associate
         at%line = at%line + 1
      end do each_line
      call findings%error('the group is not closed before the end of the file; end it with &END or /', &
                          line=group%line, group=trim(group%name))
   end subroutine scan_group

   !> A name in capitals, cut to the room there is for names.
   pure function name_of(text) result(name)
      character(*), intent(in) :: text
      character(:), allocatable :: name

      name = upper_case(text(:min(len(text), name_length)))
   end function name_of

   !> A word within a group: the name of an item if `=` follows (subscripts allowed between), else a value.
   subroutine scan_name_or_word(text, column, line, group, findings, complained)
      character(*), intent(in) :: text
      integer, intent(inout) :: column
      integer, intent(in) :: line
      type(group_t), intent(inout) :: group
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(inout) :: complained
      integer :: stop_at, after, open_at, close_at
      type(item_t) :: item

      stop_at = end_of_name(text, column)
      after = next_nonblank(text, stop_at + 1)
      open_at = 0
      close_at = 0
      if (after <= len(text)) then
         if (text(after:after) == '(') then
            open_at = after
            close_at = end_of_subscript(text, after)
            if (close_at > 0) after = next_nonblank(text, close_at + 1)
         end if
      end if
      if (after <= len(text)) then
         if (text(after:after) == '=') then
            item%name = name_of(text(column:stop_at))
            item%line = line
            if (close_at > 0) call read_subscripts(text(open_at + 1:close_at - 1), item, group, findings)
            call add_item(group, item)
            column = after + 1
            complained = .false.
            return
         end if
      end if
      call scan_value(text, column, line, group, findings, complained)
   end subroutine scan_name_or_word

   !> Place of the parenthesis that closes the one at `from`; 0 if there is none before the next item.
   pure integer function end_of_subscript(text, from)
      character(*), intent(in) :: text
      integer, intent(in) :: from

      do end_of_subscript = from + 1, len(text)
         select case (text(end_of_subscript:end_of_subscript))
         case (')')
            return
         case ('(', '=', '!')
            exit
         end select
      end do
      end_of_subscript = 0
   end function end_of_subscript

   !> Understand what stands between the parentheses: one number, or two with a comma between them.
   subroutine read_subscripts(inside, item, group, findings)
      character(*), intent(in) :: inside
      type(item_t), intent(inout) :: item
      type(group_t), intent(in) :: group
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: part, reason, name
      integer :: from, comma
      logical :: valid

      name = trim(item%name)
      if (index(inside, ':') > 0) then
         call wrong('is a section; give the first element, as '//name//'(1)= or '//name//'(2,1)=, and the values of the '// &
                    'following ones after it')
         return
      end if
      from = 1
      do
         comma = index(inside(from:), ',')
         if (comma == 0) comma = len(inside) - from + 2
         part = trimmed(inside(from:from + comma - 2))
         if (item%subscripts == 2) then
            call wrong('has more than two subscripts; write (number) or (loop,arc)')
            return
         end if
         if (len(part) == 0) then
            call wrong('lacks a subscript; write (number) or (loop,arc)')
            return
         end if
         if (scan(part, ' '//achar(9)) > 0) then
            call wrong('has a blank within a subscript; write (number), or (loop,arc) with a comma')
            return
         end if
         item%subscripts = item%subscripts + 1
         call parse_integer(part, item%subscript(item%subscripts), valid, reason)
         if (.not. valid) then
            call wrong("is not a subscript: "//reason//"; found '"//shortened(part)//"'")
            return
         end if
         if (item%subscript(item%subscripts) < 1) then
            call wrong('is not a subscript: loops, arcs and elements are counted from 1')
            return
         end if
         from = from + comma
         if (from > len(inside) + 1) exit
      end do

   contains

      subroutine wrong(words)
         character(*), intent(in) :: words

         item%misplaced = .true.
         call findings%error("'("//shortened(inside)//")' "//words, line=item%line, group=trim(group%name), item=name)
      end subroutine wrong
   end subroutine read_subscripts

   !> The text without the blanks and tabs round it.
   pure function trimmed(text) result(inner)
      character(*), intent(in) :: text
      character(:), allocatable :: inner

      if (verify(text, ' '//achar(9)) == 0) then
         inner = ''
      else
         inner = text(verify(text, ' '//achar(9)):verify(text, ' '//achar(9), back=.true.))
      end if
   end function trimmed

   !> One value, or `n*value`, or `n*`.
   subroutine scan_value(text, column, line, group, findings, complained)
      character(*), intent(in) :: text
      integer, intent(inout) :: column
      integer, intent(in) :: line
      type(group_t), intent(inout) :: group
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(inout) :: complained
      character(:), allocatable :: reason, words
      character(1) :: mark
      type(value_t) :: value
      integer :: stop_at, star, start, filled
      logical :: valid

      value%line = line
      stop_at = column
      if (.not. is_quote(text(column:column))) then
         stop_at = end_of_value(text, column)
         star = index(text(column:stop_at), '*')
         if (star > 1) then
            call parse_integer(text(column:column + star - 2), value%repeats, valid, reason)
            if (valid .and. value%repeats > 0) then
               column = column + star
            else
               if (group%count > 0) then
                  call findings%error("'"//shortened(text(column:stop_at))//"' has no valid repeat count; write 4*0.0 for four "// &
                                      "zeros", line=line, group=trim(group%name), item=trim(group%items(group%count)%name))
               end if
               value%repeats = 1
            end if
         end if
      end if
      if (column <= len(text)) value%quoted = is_quote(text(column:column))
      if (value%quoted) then
         column = column + 1
         mark = text(column - 1:column - 1)
         start = column
         do
            stop_at = index(text(column:), mark)
            if (stop_at == 0) then
               call findings%error('the quoted text is not closed on its line', line=line, group=trim(group%name))
               stop_at = len(text) + 1
            else
               stop_at = column + stop_at - 1
            end if
            if (stop_at >= len(text)) exit
            ! within the text the mark is written twice
            if (text(stop_at + 1:stop_at + 1) /= mark) exit
            column = stop_at + 2
         end do
         allocate (character(stop_at - start) :: words)
         filled = 0
         do while (start < stop_at)
            filled = filled + 1
            words(filled:filled) = text(start:start)
            start = start + merge(2, 1, text(start:start) == mark)
         end do
         call take(words(:filled))
      else
         call take(text(column:stop_at))
      end if
      ! the comma that follows a value separates; only a second one makes a null value
      column = next_nonblank(text, stop_at + 1)
      if (column <= len(text)) then
         if (text(column:column) == ',' .or. text(column:column) == ';') column = column + 1
      end if

   contains

      subroutine take(characters)
         character(*), intent(in) :: characters

         if (group%count == 0) then
            if (.not. complained) call findings%error("expected NAME = value, found '"//shortened(characters)//"'", line=line, &
                                                      group=trim(group%name))
            complained = .true.
         else
            call add_value(group, value, characters)
         end if
      end subroutine take
   end subroutine scan_value

   subroutine add_null(group, line)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: line
      type(value_t) :: value

      if (group%count == 0) return
      value%line = line
      call add_value(group, value, '')
   end subroutine add_null

   pure integer function end_of_name(text, from)
      character(*), intent(in) :: text
      integer, intent(in) :: from

      end_of_name = from - 1
      do while (end_of_name < len(text))
         select case (text(end_of_name + 1:end_of_name + 1))
         case ('a':'z', 'A':'Z', '0':'9', '_')
            end_of_name = end_of_name + 1
         case default
            exit
         end select
      end do
   end function end_of_name

   pure integer function end_of_value(text, from)
      character(*), intent(in) :: text
      integer, intent(in) :: from

      end_of_value = from
      do while (end_of_value < len(text))
         select case (text(end_of_value + 1:end_of_value + 1))
         case (' ', ',', ';', '/', '&', '$', '!', '=', '"', "'", achar(9))
            exit
         end select
         end_of_value = end_of_value + 1
      end do
   end function end_of_value

   pure integer function next_nonblank(text, from)
      character(*), intent(in) :: text
      integer, intent(in) :: from

      next_nonblank = from
      do while (next_nonblank <= len(text))
         if (text(next_nonblank:next_nonblank) /= ' ' .and. text(next_nonblank:next_nonblank) /= achar(9)) exit
         next_nonblank = next_nonblank + 1
      end do
   end function next_nonblank

   pure logical function is_quote(letter)
      character(1), intent(in) :: letter

      is_quote = letter == '"' .or. letter == "'"
   end function is_quote

   !> True if nothing stands behind that column, or a comment.
   pure logical function is_blank_or_comment(text, from)
      character(*), intent(in) :: text
      integer, intent(in) :: from
      integer :: first

      first = next_nonblank(text, from)
      is_blank_or_comment = first > len(text)
      if (.not. is_blank_or_comment) is_blank_or_comment = text(first:first) == '!'
   end function is_blank_or_comment

   !> True for `&NAME` or `$NAME` behind that column.
   pure logical function starts_group(text, from)
      character(*), intent(in) :: text
      integer, intent(in) :: from
      integer :: first

      starts_group = .false.
      first = next_nonblank(text, from)
      if (first >= len(text)) return
      if (text(first:first) /= '&' .and. text(first:first) /= '$') return
      starts_group = end_of_name(text, first + 1) > first
   end function starts_group

   pure function first_word(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: first

      first = next_nonblank(text, 1)
      word = shortened(text(first:end_of_name(text, first + 1)))
   end function first_word
end module psalm_namelist
