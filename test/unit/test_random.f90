!> The modern generator against published numbers, and its streams.
program test_random
   use, intrinsic :: iso_fortran_env, only: int64
   use check, only: checks_t
   use psalm_kinds, only: wp
   use psalm_xoshiro, only: xoshiro_t, splitmix, purpose_starts, purpose_sample
   implicit none (type, external)
   type(checks_t) :: t

   call published()
   call jumps()
   call streams()
   call uniform()
   call t%report()

contains

   subroutine published()
      type(xoshiro_t) :: random
      integer(int64) :: state, bits
      integer :: i
      ! reference implementation from the state 1, 2, 3, 4, as the tests of several libraries have them
      integer(int64), parameter :: first(*) = [11520_int64, 0_int64, 1509978240_int64, 1215971899390074240_int64, &
         1216172134540287360_int64, 607988272756665600_int64, int(z'E071C3C2E143F089', int64), 8476171486693032832_int64, &
         int(z'9309685B465C23F9', int64), 2904607092377533576_int64]
      ! splitmix64 from 1234567
      integer(int64), parameter :: mixed(*) = [6457827717110365317_int64, 3203168211198807973_int64, &
                                               int(z'883EBCE5A3F27C77', int64), 4593380528125082431_int64, &
                                               int(z'E3B8346708CB5ECD', int64)]

      state = 1234567_int64
      do i = 1, size(mixed)
         call splitmix(state, bits)
         call t%is_true(bits == mixed(i), 'splitmix64 from 1234567')
      end do
      do i = 1, size(first)
         call random%next_bits(bits)
         call t%is_true(bits == first(i), 'xoshiro256** from 1, 2, 3, 4')
      end do
   end subroutine published

   !> The number that the engine Xoshiro256StarStar of PHP gives in its own test: seeded with 1234, 10000 numbers on, after a
   !> jump and a long jump.
   subroutine jumps()
      type(xoshiro_t) :: random
      integer(int64) :: bits
      integer :: i

      call random%seed(1234, purpose_starts)
      do i = 1, 10000
         call random%next_bits(bits)
      end do
      call random%jump()
      call random%long_jump()
      call random%next_bits(bits)
      call t%is_true(bits == int(z'239196A79C7E191F', int64), 'seed, jump and long jump of the reference')
   end subroutine jumps

   !> A stream depends on its number alone.
   subroutine streams()
      type(xoshiro_t) :: random, other, stepped
      real(wp) :: x, y
      integer, parameter :: order(*) = [3, 7, 2, 2, 0, 11]
      integer :: i, k

      call random%seed(19, purpose_starts)
      do i = 1, size(order)
         call random%use_stream(order(i))
         call stepped%seed(19, purpose_starts)
         do k = 1, order(i)
            call stepped%jump()
         end do
         call t%is_true(all(random%state == stepped%state), 'stream k is k jumps away, in whatever order they are used')
         call random%next(x)
         call random%next(y)
         call t%is_true(abs(x - y) > 0.0_wp, 'numbers differ')
      end do
      call other%seed(19, purpose_sample)
      call random%use_stream(0)
      call t%is_true(any(other%state /= random%state), 'another purpose, other numbers')
   end subroutine streams

   !> Moments, and the dimension in which RANDU fails: x(k+2) - 6 x(k+1) + 9 x(k) is no integer.
   subroutine uniform()
      type(xoshiro_t) :: random
      real(wp) :: x, before(2), mean, square, product, lattice
      integer :: i
      integer, parameter :: n = 200000

      call random%seed(19, purpose_starts)
      mean = 0.0_wp
      square = 0.0_wp
      product = 0.0_wp
      lattice = 0.0_wp
      before = 0.5_wp
      do i = 1, n
         call random%next(x)
         if (x <= 0.0_wp .or. x >= 1.0_wp) exit
         mean = mean + x
         square = square + x**2
         product = product + x*before(2)
         associate (z => x - 6.0_wp*before(2) + 9.0_wp*before(1))
            lattice = lattice + abs(z - anint(z))
         end associate
         before = [before(2), x]
      end do
      call t%equal_integer(i, n + 1, 'deviates lie in (0, 1)')
      ! four standard deviations of each sum
      call t%close_to(mean/n, 0.5_wp, 4.0_wp*sqrt(1.0_wp/12.0_wp/n), 'mean')
      call t%close_to(square/n, 1.0_wp/3.0_wp, 4.0_wp*sqrt(4.0_wp/45.0_wp/n), 'mean square')
      call t%close_to(product/n, 0.25_wp, 4.0_wp*sqrt(7.0_wp/144.0_wp/n), 'neighbours are independent')
      call t%close_to(lattice/n, 0.25_wp, 4.0_wp*sqrt(1.0_wp/48.0_wp/n), 'three in a row lie on no lattice of fifteen planes')
   end subroutine uniform
end program test_random
