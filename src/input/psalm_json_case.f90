!> Cases written as JSON: one object, or an array of them, with a title and groups; items have the names of NAMELIST.
!>
!> `{"title": "FOUR-BAR", "LINKS": {"NLOOP": 1, "ARCL": [[40.0, 120.0, 80.0, 100.0]]}, "METHOD": {"IKIN": 10}}`
!>
!> An array may have rows, as that of loops and arcs, or the elements of all rows one after another. `null` leaves an element
!> out; `true` and `false` are 1 and 0. What the reader makes of it are groups like those of NAMELIST.
module psalm_json_case
   use psalm_group, only: group_t, item_t, value_t, add_item, add_value
   use psalm_namelist, only: case_text_t
   use psalm_origin, only: name_length
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: text_t, shortened, to_text, upper_case
   implicit none (type, external)
   private
   public :: is_json, read_json_cases

   character(*), parameter :: blanks = ' '//achar(9)
   character(*), parameter :: structure = '{}[]:,"'  !! characters that end a word
   character, parameter :: escape = '\'

   !> A text that is read from left to right.
   type :: json_cursor_t
      integer :: line = 1, column = 1
      logical :: stopped = .false.     !! by a mistake in the notation: the rest cannot be understood
   end type json_cursor_t

contains

   !> True if the text is JSON: it begins with `{`, or with `[` and `{`.
   logical function is_json(lines)
      type(line_t), intent(in) :: lines(:)
      type(json_cursor_t) :: at

      is_json = next_letter(lines, at) == '{'
      if (is_json .or. next_letter(lines, at) /= '[') return
      at%column = at%column + 1
      is_json = next_letter(lines, at) == '{'
   end function is_json

   !> Read all cases. Errors: a text that is no JSON, with line and column; names that are given twice; what is no case.
   subroutine read_json_cases(lines, cases, findings)
      type(line_t), intent(in) :: lines(:)                  !! the whole file
      type(case_text_t), allocatable, intent(out) :: cases(:)
      type(diagnostics_t), intent(inout) :: findings
      type(case_text_t), allocatable :: larger(:)
      type(json_cursor_t) :: at
      character(:), allocatable :: prefix
      integer :: count
      logical :: several

      allocate (cases(1))
      count = 0
      several = next_letter(lines, at) == '['
      if (several) at%column = at%column + 1
      do
         if (count == size(cases)) then
            allocate (larger(2*count))
            larger(:count) = cases
            call move_alloc(larger, cases)
         end if
         prefix = ''
         if (several) prefix = '/'//to_text(count)
         findings%prefix = prefix
         call read_case(lines, at, prefix, cases(count + 1), findings)
         if (at%stopped) exit
         count = count + 1
         if (.not. several) exit
         if (next_letter(lines, at) == ']') exit
         call expect(lines, at, ',', 'between two cases, or ] after the last', findings)
         if (at%stopped) exit
      end do
      if (.not. at%stopped) then
         if (several) at%column = at%column + 1
         if (next_letter(lines, at) /= '') call wrong(lines, at, 'nothing may follow here; several cases are an array, [...]', &
                                                      findings)
      end if
      if (several .and. allocated(findings%prefix)) deallocate (findings%prefix)
      if (at%stopped) count = 0
      cases = cases(:count)
   end subroutine read_json_cases

   !> Read one case from its `{`; `at` is left behind its `}`.
   subroutine read_case(lines, at, prefix, case, findings)
      type(line_t), intent(in) :: lines(:)
      type(json_cursor_t), intent(inout) :: at
      character(*), intent(in) :: prefix               !! of pointers: empty, or that of the case
      type(case_text_t), intent(inout) :: case
      type(diagnostics_t), intent(inout) :: findings
      type(group_t), allocatable :: larger(:)
      character(:), allocatable :: name, text
      integer :: line, i

      if (allocated(case%groups)) deallocate (case%groups)
      allocate (case%groups(4))
      case%title = ''
      case%count = 0
      call expect(lines, at, '{', 'at the begin of a case', findings)
      if (at%stopped) return
      case%line = at%line
      if (next_letter(lines, at) == '}') then
         at%column = at%column + 1
         return
      end if
      do
         call read_name(lines, at, name, line, findings)
         if (at%stopped) return
         if (name == 'title' .or. name == '$schema') then
            if (next_letter(lines, at) /= '"') call wrong(lines, at, 'a text in quotes is expected for "'//name//'"', findings)
            if (.not. at%stopped) call read_string(lines, at, text, findings)
            if (at%stopped) return
            if (name == 'title') case%title = text
            if (name == 'title') case%line = line
         else
            if (case%count == size(case%groups)) then
               allocate (larger(2*case%count))
               larger(:case%count) = case%groups
               call move_alloc(larger, case%groups)
            end if
            name = upper_case(name(:min(len(name), name_length)))
            do i = 1, case%count
               if (case%groups(i)%name == name) call findings%error('the group is given twice in this case (first in line '// &
                  to_text(case%groups(i)%line)//')', line=line, group=name)
            end do
            case%count = case%count + 1
            call read_group(lines, at, name, line, prefix, case%groups(case%count), findings)
            if (at%stopped) return
         end if
         if (next_letter(lines, at) == '}') exit
         call expect(lines, at, ',', 'before the next group, or } after the last', findings)
         if (at%stopped) return
      end do
      at%column = at%column + 1
   end subroutine read_case

   subroutine read_group(lines, at, name, line, prefix, group, findings)
      type(line_t), intent(in) :: lines(:)
      type(json_cursor_t), intent(inout) :: at
      character(*), intent(in) :: name, prefix
      integer, intent(in) :: line
      type(group_t), intent(inout) :: group
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: item_name
      type(item_t) :: item
      integer :: i, row, before

      call group%begin(name, line)
      call group%origins%use_pointers(prefix)
      call expect(lines, at, '{', 'at the begin of the items of '//name, findings)
      if (at%stopped) return
      if (next_letter(lines, at) == '}') then
         at%column = at%column + 1
         return
      end if
      do
         item = item_t()
         call read_name(lines, at, item_name, item%line, findings)
         if (at%stopped) return
         item%name = upper_case(item_name(:min(len(item_name), name_length)))
         do i = 1, group%count
            if (group%items(i)%name /= item%name) cycle
            call findings%error('given twice (first in line '//to_text(group%items(i)%line)//')', line=item%line, group=name, &
                                item=trim(item%name))
            exit
         end do
         if (next_letter(lines, at) /= '[') then
            call add_item(group, item)
            call read_value(lines, at, group, findings)
         else
            item%list = .true.
            at%column = at%column + 1
            if (next_letter(lines, at) /= '[') then
               call add_item(group, item)
               call read_list(lines, at, group, findings)
            else
               row = 0
               before = 0
               do
                  row = row + 1
                  item%subscripts = 2
                  item%subscript = [row, 1]
                  item%before = before
                  call expect(lines, at, '[', 'at the begin of a row', findings)
                  if (at%stopped) return
                  call add_item(group, item)
                  call read_list(lines, at, group, findings)
                  if (at%stopped) return
                  before = before + group%items(group%count)%count
                  if (next_letter(lines, at) == ']') exit
                  call expect(lines, at, ',', 'before the next row, or ] after the last', findings)
                  if (at%stopped) return
               end do
               at%column = at%column + 1
            end if
         end if
         if (at%stopped) return
         if (next_letter(lines, at) == '}') exit
         call expect(lines, at, ',', 'before the next item, or } after the last', findings)
         if (at%stopped) return
      end do
      at%column = at%column + 1
   end subroutine read_group

   !> Values up to `]`, which is read too.
   subroutine read_list(lines, at, group, findings)
      type(line_t), intent(in) :: lines(:)
      type(json_cursor_t), intent(inout) :: at
      type(group_t), intent(inout) :: group
      type(diagnostics_t), intent(inout) :: findings

      if (next_letter(lines, at) == ']') then
         at%column = at%column + 1
         return
      end if
      do
         if (next_letter(lines, at) == '[') then
            call wrong(lines, at, 'rows have no further rows: a number, a text, true, false or null is expected', findings)
            return
         end if
         call read_value(lines, at, group, findings)
         if (at%stopped) return
         if (next_letter(lines, at) == ']') exit
         call expect(lines, at, ',', 'before the next value, or ] after the last', findings)
         if (at%stopped) return
      end do
      at%column = at%column + 1
   end subroutine read_list

   !> One number, text, true, false or null of the item read last.
   subroutine read_value(lines, at, group, findings)
      type(line_t), intent(in) :: lines(:)
      type(json_cursor_t), intent(inout) :: at
      type(group_t), intent(inout) :: group
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: text
      type(value_t) :: value
      integer :: last

      select case (next_letter(lines, at))
      case ('"')
         value%line = at%line
         value%quoted = .true.
         call read_string(lines, at, text, findings)
         if (.not. at%stopped) call add_value(group, value, text)
         return
      case ('{', '}', ']', ':', ',', '')
         call wrong(lines, at, 'a number, a text in quotes, true, false, null or an array of them is expected', findings)
         return
      end select
      value%line = at%line
      associate (line => lines(at%line)%text)
         last = scan(line(at%column:), blanks//structure)
         last = merge(len(line), at%column + last - 2, last == 0)
         text = line(at%column:last)
      end associate
      select case (text)
      case ('true')
         text = '1'
      case ('false')
         text = '0'
      case ('null')
         text = ''
      case default
         if (scan(text(1:1), '-0123456789') == 0 .or. verify(text, '+-.0123456789eE') > 0) then
            call wrong(lines, at, 'a number, a text in quotes, true, false, null or an array of them is expected', findings)
            return
         end if
      end select
      at%column = last + 1
      call add_value(group, value, text)
   end subroutine read_value

   !> A name and the colon behind it.
   subroutine read_name(lines, at, name, line, findings)
      type(line_t), intent(in) :: lines(:)
      type(json_cursor_t), intent(inout) :: at
      character(:), allocatable, intent(out) :: name
      integer, intent(out) :: line
      type(diagnostics_t), intent(inout) :: findings

      line = at%line
      if (next_letter(lines, at) /= '"') then
         call wrong(lines, at, 'a name in quotes is expected', findings)
         return
      end if
      line = at%line
      call read_string(lines, at, name, findings)
      if (.not. at%stopped) call expect(lines, at, ':', 'after "'//shortened(name)//'"', findings)
   end subroutine read_name

   !> A text from its quote; `at` is left behind the other one.
   subroutine read_string(lines, at, string, findings)
      type(line_t), intent(in) :: lines(:)
      type(json_cursor_t), intent(inout) :: at
      character(:), allocatable, intent(out) :: string
      type(diagnostics_t), intent(inout) :: findings
      type(text_t) :: text
      integer :: i, code
      logical :: well_formed

      string = ''
      associate (line => lines(at%line)%text)
         i = at%column + 1
         do while (i <= len(line))
            if (line(i:i) == '"') then
               at%column = i + 1
               string = text%content()
               return
            else if (line(i:i) == escape) then
               at%column = i
               i = i + 1
               well_formed = i <= len(line)
               if (well_formed) then
                  select case (line(i:i))
                  case ('"', '/', escape)
                     call text%add_text(line(i:i))
                  case ('b', 'f', 'n', 'r', 't')
                     call text%add_text(' ')   ! no name has one
                  case ('u')
                     call read_code(line, i, code, well_formed)
                     if (well_formed) call text%add_text(letter_of(code))
                  case default
                     well_formed = .false.
                  end select
               end if
               if (.not. well_formed) then
                  call wrong(lines, at, 'the escape is none of \" \\ \/ \b \f \n \r \t \u1234', findings)
                  return
               end if
            else
               call text%add_text(line(i:i))
            end if
            i = i + 1
         end do
      end associate
      call wrong(lines, at, 'the text in quotes does not end in this line', findings)
   end subroutine read_string

   !> The number of a letter, `\u1234` or two of them; `i` is at the `u`, then at the last digit.
   pure subroutine read_code(line, i, code, well_formed)
      character(*), intent(in) :: line
      integer, intent(inout) :: i
      integer, intent(out) :: code
      logical, intent(out) :: well_formed
      integer, parameter :: digits = 4, high_first = 55296, low_first = 56320, low_last = 57343, beyond = 65536, half = 1024
      integer :: low

      call read_digits(i, code, well_formed)
      if (.not. well_formed) return
      i = i + digits
      if (code < high_first .or. code > low_last) return
      well_formed = code < low_first .and. i + 2 <= len(line)
      if (well_formed) well_formed = line(i + 1:i + 2) == escape//'u'
      if (.not. well_formed) return
      call read_digits(i + 2, low, well_formed)
      if (well_formed) well_formed = low >= low_first .and. low <= low_last
      if (.not. well_formed) return
      i = i + 2 + digits
      code = beyond + (code - high_first)*half + (low - low_first)

   contains

      pure subroutine read_digits(from, number, valid)
         integer, intent(in) :: from               !! place of the `u`
         integer, intent(out) :: number
         logical, intent(out) :: valid
         integer :: k, digit

         number = 0
         valid = from + digits <= len(line)
         if (.not. valid) return
         do k = from + 1, from + digits
            digit = index('0123456789ABCDEF', upper_case(line(k:k))) - 1
            valid = valid .and. digit >= 0
            number = 16*number + digit
         end do
      end subroutine read_digits
   end subroutine read_code

   !> A letter by its number, in UTF-8.
   pure function letter_of(code) result(letter)
      integer, intent(in) :: code
      character(:), allocatable :: letter
      integer, parameter :: one_byte = 128, two_bytes = 2048, three_bytes = 65536, six_bits = 64

      if (code < one_byte) then
         letter = achar(code)
      else if (code < two_bytes) then
         letter = char(192 + code/six_bits)//tail(code)
      else if (code < three_bytes) then
         letter = char(224 + code/six_bits**2)//tail(code/six_bits)//tail(code)
      else
         letter = char(240 + code/six_bits**3)//tail(code/six_bits**2)//tail(code/six_bits)//tail(code)
      end if

   contains

      pure character function tail(bits)
         integer, intent(in) :: bits

         tail = char(128 + modulo(bits, six_bits))
      end function tail
   end function letter_of

   ! ---- the text ----------------------------------------------------------------------------------------------------

   !> The next letter that is no blank, where `at` is left; empty at the end of the text.
   function next_letter(lines, at) result(letter)
      type(line_t), intent(in) :: lines(:)
      type(json_cursor_t), intent(inout) :: at
      character :: letter
      integer :: k

      letter = ''
      do while (at%line <= size(lines))
         associate (line => lines(at%line)%text)
            if (at%column <= len(line)) then
               k = verify(line(at%column:), blanks)
               if (k > 0) then
                  at%column = at%column + k - 1
                  letter = line(at%column:at%column)
                  return
               end if
            end if
         end associate
         if (at%line == size(lines)) return
         at%line = at%line + 1
         at%column = 1
      end do
   end function next_letter

   subroutine expect(lines, at, letter, where, findings)
      type(line_t), intent(in) :: lines(:)
      type(json_cursor_t), intent(inout) :: at
      character, intent(in) :: letter
      character(*), intent(in) :: where
      type(diagnostics_t), intent(inout) :: findings

      if (next_letter(lines, at) == letter) then
         at%column = at%column + 1
      else
         call wrong(lines, at, letter//' is expected '//where, findings)
      end if
   end subroutine expect

   !> A mistake in the notation; what follows is not read.
   subroutine wrong(lines, at, text, findings)
      type(line_t), intent(in) :: lines(:)
      type(json_cursor_t), intent(inout) :: at
      character(*), intent(in) :: text
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: found

      found = 'the end of the text'
      if (next_letter(lines, at) /= '') found = "'"//shortened(lines(at%line)%text(at%column:))//"'"
      call findings%error('column '//to_text(min(at%column, len(lines(at%line)%text) + 1))//': '//text//'; found '//found, &
                          line=at%line)
      at%stopped = .true.
   end subroutine wrong
end module psalm_json_case
