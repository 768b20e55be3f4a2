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
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: upper_case, to_text
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
   end type case_text_t

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
      character(:), allocatable :: text

      allocate (case%groups(4))
      case%title = ''
      do while (next <= size(lines))
         if (.not. is_blank_or_comment(lines(next)%text)) exit
         next = next + 1
      end do
      if (next > size(lines)) return
      case%line = next
      text = clean(lines(next)%text)
      if (starts_group(text)) then
         call findings%error('the first line of a case is its title, but here is the group '//first_word(text)// &
                             '; put a title line before it', line=next)
      else
         case%title = trim(lines(next)%text)
         next = next + 1
      end if
      do while (next <= size(lines))
         text = clean(lines(next)%text)
         if (is_blank_or_comment(text)) then
            next = next + 1
         else if (starts_group(text)) then
            at = cursor_t(next, verify(text, ' '))
            call read_group(lines, at, case, findings)
            next = at%line
         else
            exit
         end if
      end do
   end subroutine read_case

   !> The group of that name, taken from the case; `line` is 0 if the case has none.
   function take(self, name) result(group)
      class(case_text_t), intent(in) :: self
      character(*), intent(in) :: name !! in capitals
      type(group_t) :: group
      integer :: i

      do i = 1, self%count
         if (self%groups(i)%name == name) then
            group = self%groups(i)
            exit
         end if
      end do
      group%name = name
      if (.not. allocated(group%items)) allocate (group%items(0))
      if (.not. allocated(group%known)) allocate (group%known(0))
   end function take

   ! ---- scanning ----------------------------------------------------------------------------------------------------

   !> Read a group, and any further groups that begin on the line where it ends; `at` is left at the start of a line.
   subroutine read_group(lines, at, case, findings)
      type(line_t), intent(in) :: lines(:)
      type(cursor_t), intent(inout) :: at
      type(case_text_t), intent(inout) :: case
      type(diagnostics_t), intent(inout) :: findings
      type(group_t) :: group
      type(group_t), allocatable :: larger(:)
      character(:), allocatable :: rest
      logical :: closed
      integer :: i

      do
         call scan_group(lines, at, group, closed, findings)
         do i = 1, case%count
            if (case%groups(i)%name == group%name) call findings%error('the group is given twice in this case (first in line ' &
               //to_text(case%groups(i)%line)//')', line=group%line, group=trim(group%name))
         end do
         if (case%count == size(case%groups)) then
            allocate (larger(2*case%count))
            larger(:case%count) = case%groups
            call move_alloc(larger, case%groups)
         end if
         case%count = case%count + 1
         case%groups(case%count) = group
         if (at%line > size(lines)) return
         if (at%column == 1) return
         rest = clean(lines(at%line)%text)
         if (at%column > len(rest)) then
            rest = ''
         else
            rest = rest(at%column:)
         end if
         if (starts_group(rest)) then
            at%column = at%column + verify(rest, ' ') - 1
         else
            if (.not. is_blank_or_comment(rest)) then
               call findings%warning("'"//trim(adjustl(rest))//"' after the end of the group is ignored", line=at%line, &
                                     group=trim(group%name))
            end if
            at = cursor_t(at%line + 1, 1)
            return
         end if
      end do
   end subroutine read_group

   !> Read one group from its `&`; `at` is left behind its end, or at the line of the group that follows an unclosed one.
   subroutine scan_group(lines, at, group, closed, findings)
      type(line_t), intent(in) :: lines(:)
      type(cursor_t), intent(inout) :: at
      type(group_t), intent(out) :: group
      logical, intent(out) :: closed
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: text, word
      integer :: column, stop_at
      logical :: complained

      closed = .false.
      complained = .false.
      group%line = at%line
      allocate (group%items(16), group%known(0))
      text = clean(lines(at%line)%text)
      stop_at = end_of_name(text, at%column + 1)
      group%name = upper_case(text(at%column + 1:stop_at))
      column = stop_at + 1
      each_line: do
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
               word = upper_case(text(column + 1:stop_at))
               if (word == 'END' .or. (word == '' .and. text(column:column) == '$')) then
                  at = cursor_t(at%line, stop_at + 1)
                  closed = .true.
               else
                  call findings%error('the group is not closed before '//text(column:stop_at)// &
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
         at%line = at%line + 1
         if (at%line > size(lines)) exit each_line
         text = clean(lines(at%line)%text)
         column = 1
      end do each_line
      call findings%error('the group is not closed before the end of the file; end it with &END or /', &
                          line=group%line, group=trim(group%name))
   end subroutine scan_group

   !> A word within a group: the name of an item if `=` follows (subscripts allowed between), else a value.
   subroutine scan_name_or_word(text, column, line, group, findings, complained)
      character(*), intent(in) :: text
      integer, intent(inout) :: column
      integer, intent(in) :: line
      type(group_t), intent(inout) :: group
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(inout) :: complained
      integer :: stop_at, after, close_at, colon, comma, status
      type(item_t) :: item
      character(:), allocatable :: inside

      stop_at = end_of_name(text, column)
      after = next_nonblank(text, stop_at + 1)
      if (after <= len(text)) then
         if (text(after:after) == '(') then
            close_at = index(text(after:), ')')
            if (close_at > 0) then
               inside = text(after + 1:after + close_at - 2)
               comma = index(inside, ',')
               colon = index(inside, ':')
               item%subscripts = merge(2, 1, comma > 0)
               if (colon > 0) inside = inside(:colon - 1)
               read (inside, *, iostat=status) item%subscript(:item%subscripts)
               if (status /= 0) then
                  call findings%error("cannot understand the subscript '("//inside//")'; write (number) or (loop,arc)", &
                                      line=line, group=trim(group%name), item=upper_case(text(column:stop_at)))
                  item%subscripts = 0
               end if
               after = next_nonblank(text, after + close_at)
            end if
         end if
      end if
      if (after <= len(text)) then
         if (text(after:after) == '=') then
            item%name = upper_case(text(column:stop_at))
            item%line = line
            allocate (item%values(4))
            call add_item(group, item)
            column = after + 1
            complained = .false.
            return
         end if
      end if
      call scan_value(text, column, line, group, findings, complained)
   end subroutine scan_name_or_word

   !> One value, or `n*value`, or `n*`.
   subroutine scan_value(text, column, line, group, findings, complained)
      character(*), intent(in) :: text
      integer, intent(inout) :: column
      integer, intent(in) :: line
      type(group_t), intent(inout) :: group
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(inout) :: complained
      type(value_t) :: value
      integer :: stop_at, star, status

      value%line = line
      star = 0
      stop_at = end_of_value(text, column)
      if (text(column:column) /= '"' .and. text(column:column) /= "'") then
         star = index(text(column:stop_at), '*')
         if (star > 1) then
            read (text(column:column + star - 2), *, iostat=status) value%repeats
            if (status /= 0 .or. value%repeats < 1 .or. verify(text(column:column + star - 2), '0123456789') > 0) then
               if (group%count > 0) then
                  call findings%error("'"//text(column:stop_at)//"' has no valid repeat count; write 4*0.0 for four zeros", &
                                      line=line, group=trim(group%name), item=trim(group%items(group%count)%name))
               end if
               value%repeats = 1
               star = 0
            end if
         end if
      end if
      column = column + star
      if (column <= stop_at) then
         if (text(column:column) == '"' .or. text(column:column) == "'") then
            value%quoted = .true.
            stop_at = column + index(text(column + 1:), text(column:column))
            if (stop_at == column) then
               call findings%error('the quotation is not closed on its line', line=line, group=trim(group%name))
               stop_at = len(text)
               value%text = text(column + 1:)
            else
               value%text = text(column + 1:stop_at - 1)
            end if
         else
            value%text = text(column:stop_at)
         end if
      else
         value%text = ''
      end if
      column = stop_at + 1
      if (group%count == 0) then
         if (.not. complained) then
            call findings%error("expected NAME = value, found '"//value%text//"'", line=line, group=trim(group%name))
         end if
         complained = .true.
      else
         call add_value(group%items(group%count), value)
      end if
      ! the comma that follows a value separates; only a second one makes a null value
      column = next_nonblank(text, column)
      if (column <= len(text)) then
         if (text(column:column) == ',' .or. text(column:column) == ';') column = column + 1
      end if
   end subroutine scan_value

   subroutine add_null(group, line)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: line
      type(value_t) :: value

      if (group%count == 0) return
      value%text = ''
      value%line = line
      call add_value(group%items(group%count), value)
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
         if (scan(text(end_of_value + 1:end_of_value + 1), " ,;/&$!=") > 0) exit
         end_of_value = end_of_value + 1
      end do
   end function end_of_value

   pure integer function next_nonblank(text, from)
      character(*), intent(in) :: text
      integer, intent(in) :: from

      next_nonblank = from
      do while (next_nonblank <= len(text))
         if (text(next_nonblank:next_nonblank) /= ' ') exit
         next_nonblank = next_nonblank + 1
      end do
   end function next_nonblank

   !> The line with tabs turned into blanks.
   pure function clean(text) result(cleaned)
      character(*), intent(in) :: text
      character(len(text)) :: cleaned
      integer :: i

      cleaned = text
      do i = 1, len(text)
         if (cleaned(i:i) == achar(9)) cleaned(i:i) = ' '
      end do
   end function clean

   pure logical function is_blank_or_comment(text)
      character(*), intent(in) :: text
      integer :: first

      first = next_nonblank(clean(text), 1)
      is_blank_or_comment = first > len(text)
      if (.not. is_blank_or_comment) is_blank_or_comment = text(first:first) == '!'
   end function is_blank_or_comment

   !> True for `&NAME` or `$NAME` at the start of the text.
   pure logical function starts_group(text)
      character(*), intent(in) :: text
      integer :: first

      starts_group = .false.
      first = next_nonblank(text, 1)
      if (first >= len(text)) return
      if (text(first:first) /= '&' .and. text(first:first) /= '$') return
      starts_group = end_of_name(text, first + 1) > first
   end function starts_group

   pure function first_word(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: first

      first = next_nonblank(text, 1)
      word = text(first:end_of_name(text, first + 1))
   end function first_word
end module psalm_namelist
