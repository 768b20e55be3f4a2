!> Real periodic functions as Fourier series: from equally spaced samples, their values, derivatives and harmonics.
!>
!> f(x) = c_0 + 2 Re sum c_n exp(i n x), period 2 pi. The samples of a smooth function give it to rounding error as soon as
!> the last coefficients are rounding error themselves; `resolution` tells how far they are from it.
module psalm_periodic
   use psalm_kinds, only: wp, pi
   implicit none (type, external)
   private
   public :: periodic_t, periodic_from_samples, periodic_constant

   type :: periodic_t
      private
      complex(wp), allocatable :: c(:) !! coefficients, from index 0; index n belongs to exp(i n x)
   contains
      procedure :: highest         !! number of the last harmonic that counts
      procedure :: coefficient     !! c_n; of a negative n the conjugate
      procedure :: amplitude       !! of harmonic n, as of a_n cos(n x - phase); of 0 the mean
      procedure :: mean
      procedure :: values          !! at equally spaced places
      procedure :: at              !! at any place
      procedure :: derivative
      procedure :: integral        !! without the part of the mean; its own mean is 0
      procedure :: scaled
      procedure :: trimmed         !! without the highest harmonics that do not count
      procedure :: plus
      procedure :: resolution
   end type periodic_t

contains

   !> The trigonometric polynomial through samples at x = 0, 2 pi/N, ...
   pure function periodic_from_samples(samples) result(f)
      real(wp), intent(in) :: samples(:) !! shape (N), at least one
      type(periodic_t) :: f
      complex(wp), allocatable :: spectrum(:)
      integer :: n, half

      n = size(samples)
      half = n/2
      spectrum = transformed(cmplx(samples, 0.0_wp, wp))
      allocate (f%c(0:half))
      f%c = spectrum(1:half + 1)/real(n, wp)
      ! the highest harmonic of an even number of samples stands for n/2 and -n/2 at once
      if (mod(n, 2) == 0 .and. half > 0) f%c(half) = 0.5_wp*f%c(half)
   end function periodic_from_samples

   pure function periodic_constant(value) result(f)
      real(wp), intent(in) :: value
      type(periodic_t) :: f

      allocate (f%c(0:0))
      f%c(0) = value
   end function periodic_constant

   pure integer function highest(self, level)
      class(periodic_t), intent(in) :: self
      real(wp), intent(in), optional :: level !! what counts, against the largest coefficient; rounding of samples if absent
      real(wp) :: least

      least = 2.0_wp*epsilon(1.0_wp)
      if (present(level)) least = level
      least = least*maxval(abs(self%c))
      do highest = ubound(self%c, 1), 1, -1
         if (abs(self%c(highest)) > least) return
      end do
      highest = 0
   end function highest

   pure complex(wp) function coefficient(self, n)
      class(periodic_t), intent(in) :: self
      integer, intent(in) :: n

      coefficient = 0.0_wp
      if (abs(n) > ubound(self%c, 1)) return
      coefficient = self%c(abs(n))
      if (n < 0) coefficient = conjg(coefficient)
   end function coefficient

   pure real(wp) function amplitude(self, n)
      class(periodic_t), intent(in) :: self
      integer, intent(in) :: n

      amplitude = abs(self%coefficient(n))
      if (n /= 0) amplitude = 2.0_wp*amplitude
   end function amplitude

   pure real(wp) function mean(self)
      class(periodic_t), intent(in) :: self

      mean = real(self%c(0), wp)
   end function mean

   !> Values at x = 2 pi (i - 1 + shift)/count, i = 1..count.
   pure function values(self, count, shift) result(v)
      class(periodic_t), intent(in) :: self
      integer, intent(in) :: count
      real(wp), intent(in), optional :: shift !! in parts of the spacing; 0 if not given
      real(wp) :: v(count)
      complex(wp) :: roots(0:count - 1), c, r
      real(wp) :: ahead
      integer :: i, n

      ahead = 0.0_wp
      if (present(shift)) ahead = shift
      roots = roots_of_one(count)
      v = real(self%c(0), wp)
      do n = 1, self%highest()
         c = 2.0_wp*self%c(n)*unit(real(n, wp)*ahead/real(count, wp))
         do i = 0, count - 1
            r = roots(modulo_product(i, n, count))
            v(i + 1) = v(i + 1) + (real(c, wp)*real(r, wp) - aimag(c)*aimag(r))
         end do
      end do
   end function values

   elemental real(wp) function at(self, x)
      class(periodic_t), intent(in) :: self
      real(wp), intent(in) :: x !! radians
      integer :: n

      at = real(self%c(0), wp)
      do n = 1, self%highest()
         at = at + 2.0_wp*real(self%c(n)*unit(real(n, wp)*x/(2.0_wp*pi)), wp)
      end do
   end function at

   !> d^order f/dx^order
   pure function derivative(self, order) result(d)
      class(periodic_t), intent(in) :: self
      integer, intent(in) :: order
      type(periodic_t) :: d
      integer :: n, last

      last = self%highest() ! what is rounding error would be magnified
      allocate (d%c(0:last))
      do n = 0, last
         d%c(n) = self%c(n)*cmplx(0.0_wp, real(n, wp), wp)**order
      end do
   end function derivative

   !> The integral of f less its mean, of mean 0.
   pure function integral(self) result(f)
      class(periodic_t), intent(in) :: self
      type(periodic_t) :: f
      integer :: n

      allocate (f%c(0:ubound(self%c, 1)), source=(0.0_wp, 0.0_wp))
      do n = 1, ubound(self%c, 1)
         f%c(n) = self%c(n)/cmplx(0.0_wp, real(n, wp), wp)
      end do
   end function integral

   elemental function scaled(self, factor) result(f)
      class(periodic_t), intent(in) :: self
      real(wp), intent(in) :: factor
      type(periodic_t) :: f

      allocate (f%c(0:ubound(self%c, 1))) ! an assignment alone would count from 1
      f%c = factor*self%c
   end function scaled

   elemental function trimmed(self, least) result(f)
      class(periodic_t), intent(in) :: self
      real(wp), intent(in) :: least   !! amount of a coefficient that counts
      type(periodic_t) :: f
      integer :: last

      do last = ubound(self%c, 1), 1, -1
         if (abs(self%c(last)) > least) exit
      end do
      last = max(last, 0)
      allocate (f%c(0:last))
      f%c = self%c(0:last)
   end function trimmed

   elemental function plus(self, other) result(f)
      class(periodic_t), intent(in) :: self
      type(periodic_t), intent(in) :: other
      type(periodic_t) :: f

      allocate (f%c(0:max(ubound(self%c, 1), ubound(other%c, 1))), source=(0.0_wp, 0.0_wp))
      f%c(0:ubound(self%c, 1)) = self%c
      f%c(0:ubound(other%c, 1)) = f%c(0:ubound(other%c, 1)) + other%c
   end function plus

   !> The last eighth of the coefficients against the largest one: what the samples leave open. A constant is resolved.
   pure real(wp) function resolution(self)
      class(periodic_t), intent(in) :: self
      integer :: last

      resolution = 0.0_wp
      last = ubound(self%c, 1)
      if (last == 0) return
      if (all(abs(self%c) <= 0.0_wp)) return
      resolution = maxval(abs(self%c(last - last/8:)))/maxval(abs(self%c))
   end function resolution

   !> exp(2 pi i turns); whole turns are taken off before the sine
   elemental complex(wp) function unit(turns)
      real(wp), intent(in) :: turns
      real(wp) :: angle

      angle = 2.0_wp*pi*(turns - anint(turns))
      unit = cmplx(cos(angle), sin(angle), wp)
   end function unit

   pure function roots_of_one(count) result(roots)
      integer, intent(in) :: count
      complex(wp) :: roots(0:count - 1)
      integer :: i

      do i = 0, count - 1
         roots(i) = unit(real(i, wp)/real(count, wp))
      end do
   end function roots_of_one

   pure integer function modulo_product(a, b, m)
      use, intrinsic :: iso_fortran_env, only: int64
      integer, intent(in) :: a, b, m

      modulo_product = int(modulo(int(a, int64)*int(b, int64), int(m, int64)))
   end function modulo_product

   !> sum_k x_k exp(-2 pi i j k/N): by the smallest factor of N, again and again (Cooley and Tukey 1965).
   pure recursive function transformed(x) result(y)
      complex(wp), intent(in) :: x(:)
      complex(wp), allocatable :: y(:)
      complex(wp), allocatable :: roots(:), part(:)
      integer :: n, factor, block, q, j

      n = size(x)
      factor = smallest_factor(n)
      block = n/factor
      roots = conjg(roots_of_one(n))
      allocate (y(n), source=(0.0_wp, 0.0_wp))
      do q = 0, factor - 1
         if (block == 1) then
            part = x(q + 1:q + 1)
         else
            part = transformed(x(q + 1::factor))
         end if
         do j = 0, n - 1
            y(j + 1) = y(j + 1) + roots(modulo_product(q, j, n) + 1)*part(modulo(j, block) + 1)
         end do
      end do
   end function transformed

   pure integer function smallest_factor(n)
      integer, intent(in) :: n

      do smallest_factor = 2, n - 1
         if (smallest_factor*smallest_factor > n) exit
         if (modulo(n, smallest_factor) == 0) return
      end do
      smallest_factor = n
   end function smallest_factor
end module psalm_periodic
