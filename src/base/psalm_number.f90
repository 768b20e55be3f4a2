!> Numbers as people write them: text becomes an integer or a real, or a reason why not.
!>
!> The run-time library would take `Inf`, `NaN` and overflow, the last with a floating-point trap; they are turned away
!> before it sees them.
module psalm_number
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: wp
   use psalm_text, only: upper_case
   implicit none (type, external)
   private
   public :: parse_integer, parse_real

   integer, parameter :: far = 1000000000 !! a decimal exponent beyond every kind
   integer, parameter :: most_characters = 1000 !! of a number; converting takes time by the square of it
   integer, parameter :: short_integer = 9  !! digits that always fit
   ! a whole number of so many digits, and a power of ten up to this one, are exact: their product or ratio is rounded once
   integer, parameter :: exact_digits = min(18, int(digits(1.0_wp)*log10(2.0)))
   integer, parameter :: exact_power = int(digits(1.0_wp)*log10(2.0)/log10(5.0))

contains

   !> Read an integer. Errors: `valid` is false and `reason` says what was expected.
   pure subroutine parse_integer(text, number, valid, reason)
      character(*), intent(in) :: text
      integer, intent(out) :: number
      logical, intent(out) :: valid
      character(:), allocatable, intent(out) :: reason
      integer :: status, first, i

      number = 0
      status = 1
      first = 1
      reason = ''
      if (len(text) > 0) then
         if (scan(text(1:1), '+-') == 1) first = 2
      end if
      if (len(text) >= first .and. len(text) < first + short_integer) then
         do i = first, len(text)
            if (text(i:i) < '0' .or. text(i:i) > '9') exit
            number = 10*number + iachar(text(i:i)) - iachar('0')
         end do
         valid = i > len(text)
         if (valid) then
            if (text(1:1) == '-') number = -number
            return
         end if
         number = 0
      end if
      reason = 'an integer is expected'
      if (len(text) > most_characters) then
         reason = too_long()
      else if (len(text) >= first .and. verify(text(first:), '0123456789') == 0) then
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

      reason = ''
      call parse_short(text, number, valid)
      if (valid) return
      number = 0.0_wp
      status = 1
      reason = 'a number is expected'
      if (len(text) > most_characters) then
         reason = too_long()
      else if (is_number(text)) then
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

   pure function too_long() result(reason)
      character(:), allocatable :: reason
      character(12) :: limit

      write (limit, '(i0)') most_characters
      reason = 'a number of at most '//trim(limit)//' characters is expected'
   end function too_long

   !> A number that is exact as a whole number times or over a power of ten: rounded once, as the run-time library does.
   !> `valid` is false for all others, and for what is no number.
   pure subroutine parse_short(text, number, valid)
      character(*), intent(in) :: text
      real(wp), intent(out) :: number
      logical, intent(out) :: valid
      integer(int64) :: whole
      integer :: i, k, figures, seen, power, written, sense
      real(wp), parameter :: powers_of_ten(0:exact_power) = [(10.0_wp**k, k=0, exact_power)]

      number = 0.0_wp
      valid = .false.
      whole = 0_int64
      figures = 0   ! from the first that is not zero
      seen = 0
      power = 0
      i = 1
      if (len(text) == 0) return
      if (text(1:1) == '-' .or. text(1:1) == '+') i = 2
      do while (i <= len(text))
         select case (text(i:i))
         case ('0':'9')
            if (figures > 0 .or. text(i:i) /= '0') figures = figures + 1
            if (figures > exact_digits) return
            whole = 10_int64*whole + int(iachar(text(i:i)) - iachar('0'), int64)
            seen = seen + 1
            if (power < 0) power = power - 1
         case ('.')
            if (power < 0) return
            power = -1
         case default
            exit
         end select
         i = i + 1
      end do
      if (seen == 0 .or. seen > most_characters) return
      if (power < 0) power = power + 1
      if (i <= len(text)) then
         if (scan(text(i:i), 'eEdD') == 0) return
         i = i + 1
         sense = 1
         if (i <= len(text)) then
            if (text(i:i) == '-') sense = -1
            if (text(i:i) == '-' .or. text(i:i) == '+') i = i + 1
         end if
         if (i > len(text) .or. len(text) - i > 3) return
         written = 0
         do while (i <= len(text))
            if (text(i:i) < '0' .or. text(i:i) > '9') return
            written = 10*written + iachar(text(i:i)) - iachar('0')
            i = i + 1
         end do
         power = power + sense*written
      end if
      if (abs(power) > exact_power) return
      number = real(whole, wp)
      if (power > 0) number = number*powers_of_ten(power)
      if (power < 0) number = number/powers_of_ten(-power)
      if (text(1:1) == '-') number = -number
      valid = .true.
   end subroutine parse_short

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
