!> JSON: strings, numbers, arrays and members, for tables (`psalm_table_json`), the data of pages and schemas.
!>
!> What is not known, or is no number, is `null`: JSON has no other word for it.
module psalm_json
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use psalm_kinds, only: wp
   use psalm_markup, only: clean_text, short_number, strings_t
   use psalm_text, only: text_t, full_precision, to_text
   implicit none (type, external)
   private
   public :: json_text, json_number, json_integers, truth, comma, add_numbers, add_member, add_strings

contains

   !> The text as a JSON string, quotes included; it may stand inside a script element of HTML.
   pure function json_text(text) result(quoted)
      character(*), intent(in) :: text
      character(:), allocatable :: quoted, clean
      type(text_t) :: out         ! grows without being copied for every letter
      integer :: i

      clean = clean_text(text)
      call out%add_text('"')
      do i = 1, len(clean)
         select case (clean(i:i))
         case ('"')
            call out%add_text(achar(92)//'"')
         case (achar(92))
            call out%add_text(achar(92)//achar(92))
         case ('<')
            call out%add_text(achar(92)//'u003c')
         case ('>')
            call out%add_text(achar(92)//'u003e')
         case ('&')
            call out%add_text(achar(92)//'u0026')
         case default
            call out%add_text(clean(i:i))
         end select
      end do
      call out%add_text('"')
      quoted = out%content()
   end function json_text

   !> A truth value of JSON.
   pure function truth(value) result(word)
      logical, intent(in) :: value
      character(:), allocatable :: word

      word = trim(merge('true ', 'false', value))
   end function truth

   !> What stands before the i-th element of a JSON list.
   pure function comma(i) result(mark)
      integer, intent(in) :: i
      character(:), allocatable :: mark

      mark = ','
      if (i == 1) mark = ''
   end function comma

   !> A number to nine digits, to so many, or with all of them.
   pure function json_number(value, known, exact, digits) result(text)
      real(wp), intent(in) :: value
      logical, intent(in), optional :: known   !! default: true
      logical, intent(in), optional :: exact   !! with all digits; default: false
      integer, intent(in), optional :: digits  !! in place of nine
      character(:), allocatable :: text
      logical :: all_digits

      text = 'null'
      if (present(known)) then
         if (.not. known) return
      end if
      if (.not. ieee_is_finite(value)) return
      all_digits = .false.
      if (present(exact)) all_digits = exact
      if (all_digits) then
         text = full_precision(value)
      else
         text = short_number(value, digits)
      end if
   end function json_number

   !> Append numbers as an array.
   pure subroutine add_numbers(values, text, known, exact, digits)
      real(wp), intent(in) :: values(:)
      type(text_t), intent(inout) :: text
      logical, intent(in), optional :: known(:)   !! the same shape; all if absent
      logical, intent(in), optional :: exact      !! as `json_number` has it
      integer, intent(in), optional :: digits
      integer :: i

      call text%add_text('[')
      do i = 1, size(values)
         if (i > 1) call text%add_text(',')
         if (present(known)) then
            call text%add_text(json_number(values(i), known(i), exact, digits))
         else
            call text%add_text(json_number(values(i), exact=exact, digits=digits))
         end if
      end do
      call text%add_text(']')
   end subroutine add_numbers

   !> Append a further member of an object, an array of numbers.
   pure subroutine add_member(name, values, text, known, exact, digits)
      character(*), intent(in) :: name
      real(wp), intent(in) :: values(:)
      type(text_t), intent(inout) :: text
      logical, intent(in), optional :: known(:), exact !! as `add_numbers` has them
      integer, intent(in), optional :: digits

      call text%add_text(','//json_text(name)//':')
      call add_numbers(values, text, known, exact, digits)
      call text%add()
   end subroutine add_member

   !> Append strings as an array.
   pure subroutine add_strings(strings, text)
      type(strings_t), intent(in) :: strings(:)
      type(text_t), intent(inout) :: text
      integer :: i

      call text%add_text('[')
      do i = 1, size(strings)
         call text%add_text(comma(i)//json_text(strings(i)%text))
      end do
      call text%add_text(']')
   end subroutine add_strings

   !> Integers as an array.
   pure function json_integers(values) result(list)
      integer, intent(in) :: values(:)
      character(:), allocatable :: list
      integer :: i

      list = '['
      do i = 1, size(values)
         list = list//comma(i)//to_text(values(i))
      end do
      list = list//']'
   end function json_integers
end module psalm_json
