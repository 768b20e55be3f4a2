!> Columns of numbers in the listings of sketches.
program test_number_format
   use check, only: checks_t
   use psalm_kinds, only: wp
   use psalm_number_format, only: number_format_t, error_words, figure, figures_of, format_of, in_a_row, in_sentence, number_words
   use psalm_text, only: general
   implicit none (type, external)
   type(checks_t) :: t

   call columns()
   call whole_columns()
   call errors()
   call against_internal_files()
   call t%report()

contains

   subroutine columns()
      type(number_format_t) :: format

      format = format_of(.true., [0.0_wp, 10.0_wp, 350.0_wp])
      call t%equal_text(figure(350.0_wp, format), '          350.0', 'zeros that all numbers have are left out, but one')
      call t%equal_text(figure(0.0_wp, format), '            0.0', 'zero')
      format = format_of(.true., [12.5_wp, 0.12345678_wp])
      call t%equal_text(figure(12.5_wp, format), '       12.50000', 'the largest has seven digits')
      call t%equal_text(figure(0.12345678_wp, format), '        0.12346', 'the others as many decimals')
      call t%equal_text(figure(-1.0e-9_wp, format), '        0.00000', 'what rounds to zero has no sign')
      call t%equal_text(figure(-9.999996_wp, format), '      -10.00000', 'a digit more by rounding')
      format = format_of(.true., [0.5_wp, 1.0e30_wp], known=[.true., .false.])
      call t%equal_text(figure(0.5_wp, format), '            0.5', 'what is not known does not count')
      format = format_of(.true., [0.5_wp, huge(1.0_wp)])
      call t%equal_text(figure(0.5_wp, format), '            0.5', 'nor does what has no value')
      format = format_of(.true., [1234567890.0_wp])
      call t%equal_text(figure(1234567890.0_wp, format), '   1.234568E+09', 'large: engineering notation')
      call t%equal_text(figure(-12345.678_wp, format), '  -12.34568E+03', 'two digits before the point')
      format = format_of(.true., [-2.5e-8_wp])
      call t%equal_text(figure(-2.5e-8_wp, format), '  -25.00000E-09', 'small: engineering notation')
      call t%equal_text(figure(3.0e-101_wp, format), '  30.00000E-102', 'an exponent of three digits')
      call t%equal_text(figure(0.0_wp, format), '            0.0', 'zero among them')
      format = format_of(.true., [-1.4e-14_wp, 0.0_wp], among=[40.0_wp])
      call t%equal_text(figure(-1.4e-14_wp, format), '            0.0', 'what rounding makes beside lengths of 40')
      format = format_of(.true., [1.4e-6_wp], among=[40.0_wp])
      call t%equal_text(figure(1.4e-6_wp, format), '   1.400000E-06', 'a small number is not taken for it')
      format = format_of(.false., [0.0_wp, 10.0_wp])
      call t%equal_text(figure(10.0_wp, format), general(10.0_wp), 'loops: as the published listings')
   end subroutine columns

   !> All numbers of a column at once, numbers in sentences.
   subroutine whole_columns()
      character(15) :: texts(3)

      texts = figures_of(.true., [12.5_wp, -0.12345678_wp, 99.0_wp], [.true., .true., .false.])
      call t%equal_text(in_a_row(texts), '       12.50000       -0.12346               ', 'what is not known is blank')
      texts = figures_of(.true., [2.5_wp, 4.0e-7_wp, 0.0_wp])
      call t%equal_text(texts(2), '            0.0', 'beside a large number no digit is left of a small one')
      texts = figures_of(.true., [2.5_wp, 4.0e-7_wp, 0.0_wp], all_count=.true.)
      call t%equal_text(in_a_row(texts), '   2.500000E+00   400.0000E-09            0.0', 'unless all count')
      texts = figures_of(.true., [2.5_wp, 0.01_wp, 0.0_wp], all_count=.true.)
      call t%equal_text(in_a_row(texts), '           2.50           0.01           0.00', 'numbers of like size, zeros left out')
      texts = figures_of(.false., [2.5_wp, 4.0e-7_wp, 0.0_wp], all_count=.true.)
      call t%equal_text(texts(2), general(4.0e-7_wp), 'loops: as the published listings')
      call t%equal_text(in_sentence(.true., 0.05_wp), ' 0.05', 'in a sentence: one blank')
      call t%equal_text(in_sentence(.true., 1.0e-12_wp), ' 1.000000E-12', 'engineering in a sentence')
      call t%equal_text(in_sentence(.false., 0.05_wp), general(0.05_wp), 'of loops in its width')
      call t%equal_text(number_words(.true., 0.05_wp), '0.05', 'in words: no blank')
      call t%equal_text(number_words(.false., 0.05_wp), trim(adjustl(general(0.05_wp))), 'of loops in words')
      call t%equal_text(number_words(90.0_wp), '90.0', 'in a message')
   end subroutine whole_columns

   !> Digits that an error leaves open are blank, points stay below each other.
   subroutine errors()
      type(number_format_t) :: format

      format = format_of(.true., [-43.160112_wp])
      call t%equal_text(figure(-43.160112_wp, format, 1.0e-9_wp), '      -43.16011', 'a small error')
      call t%equal_text(figure(-43.160112_wp, format, 2.0e-4_wp), '      -43.160  ', 'two digits are open')
      call t%equal_text(figure(-43.160112_wp, format, 0.9_wp), '      -43.     ', 'all decimals are open')
      format = format_of(.true., [-58.17012e-6_wp])
      call t%equal_text(figure(-58.17012e-6_wp, format, 1.0e-14_wp), '  -58.17012E-06', 'engineering: a small error')
      call t%equal_text(figure(-58.17012e-6_wp, format, 2.0e-9_wp), '     -58.17E-06', 'three digits are open')
      call t%equal_text(figure(-58.17012e-6_wp, format, 2.0e-6_wp), '       -60.E-06', 'six are open: a zero keeps the place')
      call t%equal_text(figure(-58.17012e-6_wp, format, 1.0e-4_wp), '            0.0', 'all are open')
      call t%equal_text(in_sentence(.true., 0.5_wp, 1.0e-3_wp), ' 0.5', 'in a sentence')
      call t%equal_text(error_words(.true., 8.2341e-13_wp), ' 8.2E-13', 'of an error its size')
      call t%equal_text(error_words(.true., 0.0_wp), ' 0.0', 'no error')
      call t%equal_text(error_words(.true., -8.2341e-13_wp), ' -8.2E-13', 'an error below zero')
      call t%equal_text(error_words(.false., 8.2341e-13_wp), general(8.2341e-13_wp), 'loops: as the published listings')
      call t%equal_text(in_a_row(figures_of(.true., [12.123456_wp, 0.5_wp], error=2.0e-3_wp)), &
                        '       12.12           0.50   ', 'a column with an error')
   end subroutine errors

   !> The same digits as the run-time library's.
   subroutine against_internal_files()
      type(number_format_t) :: format
      character(15) :: text
      real(wp) :: x
      integer :: k, bad

      bad = 0
      do k = 1, 20000
         x = 1000.0_wp*sin(real(k, wp))
         format = format_of(.true., [x, 999.1234_wp])
         write (text, '(f15.4)') x
         if (text /= figure(x, format)) bad = bad + 1
      end do
      call t%equal_integer(bad, 0, 'digits as the run-time library rounds them')
   end subroutine against_internal_files
end program test_number_format
