!> Numbers as people write them: text becomes an integer or a real, or a reason why not.
!>
!> The run-time library would take `Inf`, `NaN` and overflow, the last with a floating-point trap; they are turned away
!> before it sees them.
module psalm_number
   use psalm_kinds, only: wp
   use psalm_text, only: upper_case
   implicit none (type, external)
   private
   public :: parse_integer, parse_real

   integer, parameter :: far = 1000000000 !! a decimal exponent beyond every kind

contains

   !> Read an integer. Errors: `valid` is false and `reason` says what was expected.
   pure subroutine parse_integer(text, number, valid, reason)
      character(*), intent(in) :: text
      integer, intent(out) :: number
      logical, intent(out) :: valid
      character(:), allocatable, intent(out) :: reason
      integer :: status, first

      number = 0
      status = 1
      first = 1
      reason = 'an integer is expected'
      if (len(text) > 0) then
         if (scan(text(1:1), '+-') == 1) first = 2
      end if
      if (len(text) >= first .and. verify(text(first:), '0123456789') == 0) then
         read (text, *, iostat=status) number
         ! the one integer whose negative overflows is none of ours
         if (status == 0 .and. number < -huge(number)) status = 1
         if (status /= 0) reason = 'the integer is too large'
      else if (is_number(text)) then
         reason = 'an integer is expected, not a real'
      end if
      valid = status == 0
   end subroutine parse_integer

   !> Read a real. Errors: `valid` is false and `reason` says what was expected.
   pure subroutine parse_real(text, number, valid, reason)
      character(*), intent(in) :: text
      real(wp), intent(out) :: number
      logical, intent(out) :: valid
      character(:), allocatable, intent(out) :: reason
      integer :: status

      number = 0.0_wp
      status = 1
      reason = 'a number is expected'
      if (is_number(text)) then
         if (decimal_exponent(text) >= range(1.0_wp) + 1) then
            reason = 'the number is too large'
         else
            read (text, *, iostat=status) number
         end if
      else if (verify(text, '+-') > 0) then
         select case (upper_case(text(verify(text, '+-'):)))
         case ('INF', 'INFINITY', 'NAN')
            reason = 'a finite number is expected'
         end select
      end if
      valid = status == 0
   end subroutine parse_real

   !> True for a Fortran number: sign, digits with at most one point, exponent with E, D or Q or a sign alone.
   pure logical function is_number(text)
      character(*), intent(in) :: text
      integer :: i, digits, points
      character(*), parameter :: figures = '0123456789'

      is_number = .false.
      i = 1
      if (len(text) == 0) return
      if (scan(text(1:1), '+-') == 1) i = 2
      digits = 0
      points = 0
      do while (i <= len(text))
         if (scan(text(i:i), figures) == 1) then
            digits = digits + 1
         else if (text(i:i) == '.') then
            points = points + 1
         else
            exit
         end if
         i = i + 1
      end do
      if (digits == 0 .or. points > 1) return
      if (i <= len(text)) then
         if (scan(text(i:i), 'eEdDqQ') == 1) i = i + 1
         if (i > len(text)) return
         if (scan(text(i:i), '+-') == 1) i = i + 1
         if (i > len(text) .or. len(text) - i > 7) return
         if (verify(text(i:), figures) > 0) return
      end if
      is_number = .true.
   end function is_number

   !> Decimal exponent of a number as written: 1 for 25.0, -3 for 0.0025; very low for zero.
   pure integer function decimal_exponent(text)
      character(*), intent(in) :: text
      integer :: i, first, point, mark, written, status

      mark = scan(text, 'eEdDqQ')
      if (mark == 0) mark = scan(text(2:), '+-') + merge(1, 0, scan(text(2:), '+-') > 0)
      written = 0
      if (mark > 0) then
         i = mark
         if (scan(text(i:i), 'eEdDqQ') == 1) i = i + 1
         read (text(i:), *, iostat=status) written
         if (status /= 0) written = far
      else
         mark = len(text) + 1
      end if
      point = index(text(:mark - 1), '.')
      if (point == 0) point = mark
      first = scan(text(:mark - 1), '123456789')
      if (first == 0) then
         decimal_exponent = -far
      else if (first < point) then
         decimal_exponent = point - first - 1 + written
      else
         decimal_exponent = point - first + written
      end if
   end function decimal_exponent
end module psalm_number
