!> Numbers as the listings print them, and as files keep them.
program test_text
   use check, only: checks_t
   use psalm_kinds, only: wp, i8
   use psalm_number, only: parse_integer, parse_real
   use psalm_random, only: random_t
   use psalm_text, only: edit_distance, fixed, full_precision, general, nearest_name, to_text
   implicit none (type, external)
   type(checks_t) :: t

   call columns()
   call round_trip()
   call numbers()
   call random()
   call figures()
   call integers()
   call t%equal_integer(edit_distance('MAXRAC', 'MAXARC'), 2, 'two letters exchanged are two changes')
   call t%equal_text(trim(nearest_name('NITTER', [character(6) :: 'NCHECK', 'NITER', 'FMIN'])), 'NITER', 'nearest name')
   call t%report()

contains

   subroutine columns()
      call t%equal_text(trim(adjustl(fixed(0.0_wp, 10, 3))), '0.0', 'an exact zero prints as 0.0')
      call t%equal_text(adjustl(fixed(352.7155_wp, 10, 3)), '352.715', 'a decimal tie goes towards zero (figure 7.3)')
      call t%equal_text(adjustl(fixed(20.4425_wp, 10, 3)), '20.442', 'tie in the input (figure 7.3)')
      call t%equal_text(adjustl(fixed(20.4425_wp, 10, 3, tie_away=.true.)), '20.443', 'tie in the results (figure 7.2)')
      call t%equal_text(adjustl(fixed(-3.7496_wp, 10, 3)), '-3.750', 'negative numbers')
      call t%is_true(index(fixed(1.0e12_wp, 10, 3), '*') == 0, 'a wide number is printed, not asterisks')
      call t%equal_text(adjustl(general(-0.09952564_wp)), '-0.9952564D-01', 'G15.7 with D exponent')
      call t%equal_text(adjustl(general(90.0_wp)), '90.00000', 'G15.7 without exponent')
      call t%equal_text(adjustl(general(0.0_wp)), '0.0', 'G15.7 of zero')
   end subroutine columns

   subroutine round_trip()
      real(wp) :: x, y
      type(random_t) :: random
      character(:), allocatable :: text
      integer :: i, bad, status

      bad = 0
      do i = 1, 2000
         call random%next(x)
         x = (x - 0.5_wp)*10.0_wp**(mod(i, 61) - 30)
         text = full_precision(x)
         read (text, *, iostat=status) y
         if (status /= 0 .or. y /= x) bad = bad + 1
      end do
      call t%equal_integer(bad, 0, 'full precision reads back to the same bits')
   end subroutine round_trip

   !> Integers as the run-time library writes them, from one end of their range to the other.
   subroutine integers()
      character(20) :: library
      integer :: value, power, sense, step, bad

      bad = 0
      do power = 0, range(value)
         do sense = -1, 1
            do step = -2, 2
               value = sense*10**power + step
               write (library, '(i0)') value
               if (to_text(value) /= trim(library) .or. len(to_text(value)) /= len_trim(library)) bad = bad + 1
            end do
         end do
      end do
      call t%equal_integer(bad, 0, 'integers around powers of ten')
      call t%equal_text(to_text(huge(value)), '2147483647', 'the highest integer')
      call t%equal_text(to_text(-huge(value) - 1), '-2147483648', 'the lowest integer')
   end subroutine integers

   !> The fast ways to figures give what the run-time library gives.
   subroutine figures()
      real(wp) :: x
      type(random_t) :: random
      character(40) :: library
      character(15) :: short
      integer :: i, bad, worse

      bad = 0
      worse = 0
      do i = 1, 40000
         call random%next(x)
         x = (x - 0.5_wp)*10.0_wp**(mod(i, 25) - 6)
         if (mod(i, 3) == 0) x = anint(x*1000.0_wp)/1000.0_wp
         if (mod(i, 7) == 0) x = anint(x)
         if (mod(i, 11) == 0) x = anint(x) + 0.5_wp**mod(i, 30)
         if (mod(i, 13) == 0) x = nearest(10.0_wp**(mod(i, 21) - 5), x)
         if (x == 0.0_wp) cycle
         if (abs(x) >= 1.0_wp .and. abs(x) < 1.0e7_wp) then
            write (short, '(g15.7)') x
            if (index(short, 'E') == 0 .and. adjustr(short) /= general(x)) bad = bad + 1
         end if
         write (library, '(es40.16e2)') x
         if (precision(x) == 15 .and. adjustl(library) /= full_precision(x)) worse = worse + 1
      end do
      call t%equal_integer(bad, 0, 'seven figures')
      call t%equal_integer(worse, 0, 'seventeen figures')
   end subroutine figures

   subroutine numbers()
      real(wp) :: x
      integer :: n
      logical :: valid
      character(:), allocatable :: reason

      call parse_real('1.5D-3', x, valid, reason)
      call t%is_true(valid .and. abs(x - 1.5e-3_wp) < 1.0e-18_wp, 'D exponents are read')
      call parse_real('-.25', x, valid, reason)
      call t%is_true(valid .and. abs(x + 0.25_wp) < 1.0e-15_wp, 'a point without a figure before it')
      call parse_real('Inf', x, valid, reason)
      call t%equal_text(reason, 'a finite number is expected', 'infinity is turned away')
      call parse_real('1e999999', x, valid, reason)
      call t%equal_text(reason, 'the number is too large', 'overflow is turned away without a trap')
      call parse_real('1e4294967297', x, valid, reason)
      call t%is_true(.not. valid, 'an exponent that wraps around to 1')
      call parse_real('1e00000002', x, valid, reason)
      call t%is_true(valid .and. abs(x - 100.0_wp) <= 0.0_wp, 'an exponent with leading zeros')
      call parse_real('1.2.3', x, valid, reason)
      call t%is_true(.not. valid, 'two points are no number')
      call parse_real('', x, valid, reason)
      call t%is_true(.not. valid, 'nothing is no number')
      call parse_integer('3.0', n, valid, reason)
      call t%equal_text(reason, 'an integer is expected, not a real', 'a real is no integer')
      call parse_integer('99999999999', n, valid, reason)
      call t%equal_text(reason, 'the integer is too large', 'integer overflow')
   end subroutine numbers

   subroutine random()
      type(random_t) :: a, b
      real(wp) :: x, y
      integer :: i
      logical :: inside

      call a%next(x)
      call t%is_true(a%state == 1245241_i8, 'ix <- 65539 ix mod 2**31 from 19')
      inside = .true.
      do i = 1, 10000
         call a%next(x)
         inside = inside .and. x > 0.0_wp .and. x < 1.0_wp
      end do
      call t%is_true(inside, 'deviates lie in (0, 1)')
      b%state = a%state
      call a%next(x)
      call b%next(y)
      call t%is_true(x == y, 'a sequence goes on from its state')
   end subroutine random
end program test_text
