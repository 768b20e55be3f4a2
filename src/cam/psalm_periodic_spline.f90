!> Periodic splines of degree 3 or 5 through or near the points of a table.
!>
!> The pieces are Hermite polynomials in the values and derivatives at the knots; what is left to be continuous at the knots
!> couples each with its neighbours, in a ring: cyclic block elimination, linear in the number of points. With a tolerance the
!> curve is the smoothest - least integral of the squared derivative of order (degree+1)/2 - that stays within it at
!> all points: at each knot the jump of the highest derivative is then proportional to the residual (Schoenberg, Reinsch).
module psalm_periodic_spline
   use psalm_dense, only: factors_t, factorise, solve
   use psalm_kinds, only: wp
   use psalm_linear, only: product_of
   implicit none (type, external)
   private
   public :: periodic_spline, quintic_hermite, septic_hermite

   integer, parameter :: most_halvings = 60       !! of the logarithm of the smoothing factor
   real(wp), parameter :: near_enough = 1.0e-3_wp !! part of the tolerance that may be left

contains

   !> Coefficients of the pieces in u = 0 ... 1, by powers; the last piece leads from the last point to the first.
   !>
   !> `at` rises and stays below at(1) + period. Errors: `found` is false where the elimination meets a singular block.
   subroutine periodic_spline(at, values, period, degree, tolerance, pieces, found)
      real(wp), intent(in) :: at(:), values(:)           !! shape (n), n >= 3
      real(wp), intent(in) :: period
      integer, intent(in) :: degree                      !! 3 or 5
      real(wp), intent(in) :: tolerance                  !! largest distance from the points; 0: through them
      real(wp), allocatable, intent(out) :: pieces(:, :) !! shape (0:degree, n)
      logical, intent(out) :: found
      real(wp) :: step(size(at)), low, high, middle, miss
      real(wp), allocatable :: knots(:, :)
      integer :: n, k

      n = size(at)
      step(:n - 1) = at(2:) - at(:n - 1)
      step(n) = at(1) + period - at(n)
      step = step*(real(n, wp)/period) ! near 1
      allocate (pieces(0:degree, n), source=0.0_wp)
      if (.not. tolerance > 0.0_wp) then
         call solve_ring(step, values, degree, 0.0_wp, knots, found)
      else
         ! decades of the smoothing factor: from nearly none to nearly a constant
         low = -16.0_wp
         high = 16.0_wp
         do k = 1, most_halvings
            middle = 0.5_wp*(low + high)
            call solve_ring(step, values, degree, power_of_ten(middle), knots, found)
            if (.not. found) return
            miss = maxval(abs(knots(1, :) - values))
            if (miss > tolerance) then
               high = middle
            else
               low = middle
               if (miss > (1.0_wp - near_enough)*tolerance) exit
            end if
         end do
         call solve_ring(step, values, degree, power_of_ten(low), knots, found)
      end if
      if (.not. found) return
      do k = 1, n
         pieces(:, k) = piece(step(k), knots(:, k), knots(:, modulo(k, n) + 1), degree)
      end do
   end subroutine periodic_spline

   !> 10**x by squarings and roots of the number 10.
   pure real(wp) function power_of_ten(x)
      real(wp), intent(in) :: x
      real(wp) :: root, rest
      integer :: k

      power_of_ten = 10.0_wp**floor(x)
      rest = x - real(floor(x), wp)
      root = 10.0_wp
      do k = 1, digits(1.0_wp)
         root = sqrt(root)
         rest = 2.0_wp*rest
         if (rest < 1.0_wp) cycle
         rest = rest - 1.0_wp
         power_of_ten = power_of_ten*root
      end do
   end function power_of_ten

   !> Powers of a piece of width h between two knots (value and derivatives).
   pure function piece(h, from, to, degree) result(c)
      real(wp), intent(in) :: h, from(:), to(:)
      integer, intent(in) :: degree
      real(wp) :: c(0:degree)

      if (degree == 5) then
         c = quintic_hermite(from(1), h*from(2), h*h*from(3), to(1), h*to(2), h*h*to(3))
      else
         c = [from(1), h*from(2), 3.0_wp*(to(1) - from(1)) - h*(2.0_wp*from(2) + to(2)), &
              2.0_wp*(from(1) - to(1)) + h*(from(2) + to(2))]
      end if
   end function piece

   !> Quintic in u = 0 ... 1 by value, first and second derivative at both ends.
   pure function quintic_hermite(y0, v0, a0, y1, v1, a1) result(c)
      real(wp), intent(in) :: y0, v0, a0, y1, v1, a1
      real(wp) :: c(0:5), d

      d = y1 - y0
      c(0) = y0
      c(1) = v0
      c(2) = 0.5_wp*a0
      c(3) = 10.0_wp*d - 6.0_wp*v0 - 4.0_wp*v1 - 1.5_wp*a0 + 0.5_wp*a1
      c(4) = -15.0_wp*d + 8.0_wp*v0 + 7.0_wp*v1 + 1.5_wp*a0 - a1
      c(5) = 6.0_wp*d - 3.0_wp*(v0 + v1) - 0.5_wp*(a0 - a1)
   end function quintic_hermite

   !> The same of degree 7, with the third derivatives.
   pure function septic_hermite(y0, v0, a0, j0, y1, v1, a1, j1) result(c)
      real(wp), intent(in) :: y0, v0, a0, j0, y1, v1, a1, j1
      real(wp) :: c(0:7), d

      d = y1 - y0
      c(0) = y0
      c(1) = v0
      c(2) = 0.5_wp*a0
      c(3) = j0/6.0_wp
      c(4) = 35.0_wp*d - 20.0_wp*v0 - 15.0_wp*v1 - 5.0_wp*a0 + 2.5_wp*a1 - (4.0_wp*j0 + j1)/6.0_wp
      c(5) = -84.0_wp*d + 45.0_wp*v0 + 39.0_wp*v1 + 10.0_wp*a0 - 7.0_wp*a1 + j0 + 0.5_wp*j1
      c(6) = 70.0_wp*d - 36.0_wp*v0 - 34.0_wp*v1 - 7.5_wp*a0 + 6.5_wp*a1 - (4.0_wp*j0 + 3.0_wp*j1)/6.0_wp
      c(7) = -20.0_wp*d + 10.0_wp*(v0 + v1) + 2.0_wp*(a0 - a1) + (j0 + j1)/6.0_wp
   end function septic_hermite

   !> Derivatives of a piece, in its own width, at one of its ends: orders 2, 3 (degree 3), or 3, 4, 5.
   pure function ends_of(c, h, u, degree) result(d)
      integer, intent(in) :: degree
      real(wp), intent(in) :: c(0:degree), h, u
      real(wp) :: d(3)

      if (degree == 5) then
         d(1) = (6.0_wp*c(3) + u*(24.0_wp*c(4) + u*60.0_wp*c(5)))/h**3
         d(2) = (24.0_wp*c(4) + u*120.0_wp*c(5))/h**4
         d(3) = 120.0_wp*c(5)/h**5
      else
         d(1) = (2.0_wp*c(2) + u*6.0_wp*c(3))/h**2
         d(2) = 6.0_wp*c(3)/h**3
         d(3) = 0.0_wp
      end if
   end function ends_of

   !> Value and derivatives at all knots. Unknowns of a knot: its derivatives, with smoothing its value before them. Equations:
   !> continuity, and with smoothing: residual = +-factor times the jump of the highest derivative.
   subroutine solve_ring(step, values, degree, factor, knots, found)
      real(wp), intent(in) :: step(:), values(:)
      integer, intent(in) :: degree
      real(wp), intent(in) :: factor                     !! 0: interpolation
      real(wp), allocatable, intent(out) :: knots(:, :)  !! shape ((degree+1)/2, n)
      logical, intent(out) :: found
      real(wp), allocatable :: before(:, :, :), here(:, :, :), after(:, :, :), right(:, :, :), x(:, :)
      real(wp) :: unit((degree + 1)/2), none((degree + 1)/2), left(3), behind(3)
      integer :: n, of_knot, m, i, k, last, lead

      n = size(step)
      of_knot = (degree + 1)/2
      lead = merge(0, 1, factor > 0.0_wp)
      m = of_knot - lead
      allocate (before(m, m, n), here(m, m, n), after(m, m, n), right(m, 1, n), source=0.0_wp)
      none = 0.0_wp
      do i = 1, n
         last = modulo(i - 2, n) + 1
         do k = 1, of_knot
            unit = 0.0_wp
            unit(k) = 1.0_wp
            ! the knot before, this one and the one after, each with a unit of its k-th number
            left = ends_of(piece(step(last), unit, none, degree), step(last), 1.0_wp, degree)
            call enter(-left, before(:, :, i), last, k)
            left = ends_of(piece(step(last), none, unit, degree), step(last), 1.0_wp, degree)
            behind = ends_of(piece(step(i), unit, none, degree), step(i), 0.0_wp, degree)
            call enter(behind - left, here(:, :, i), i, k)
            behind = ends_of(piece(step(i), none, unit, degree), step(i), 0.0_wp, degree)
            call enter(behind, after(:, :, i), modulo(i, n) + 1, k)
         end do
         if (lead == 0) then
            here(m, 1, i) = here(m, 1, i) - merge(1.0_wp, -1.0_wp, degree == 5)/factor
            right(m, 1, i) = -merge(1.0_wp, -1.0_wp, degree == 5)*values(i)/factor
         end if
      end do
      call solve_cyclic(before, here, after, right, x, found)
      allocate (knots(of_knot, n), source=0.0_wp)
      if (.not. found) return
      if (lead == 1) knots(1, :) = values
      knots(1 + lead:, :) = x

   contains

      !> What a number of a knot adds to the jumps here: to the matrix, or, if it is given, to the right-hand side.
      subroutine enter(jump, block, knot, k)
         real(wp), intent(in) :: jump(3)
         real(wp), intent(inout) :: block(:, :)
         integer, intent(in) :: knot, k

         if (k == 1 .and. lead == 1) then
            right(:, 1, i) = right(:, 1, i) - jump(:m)*values(knot)
         else
            block(:, k - lead) = block(:, k - lead) + jump(:m)
         end if
      end subroutine enter
   end subroutine solve_ring

   !> before(i) x(i-1) + here(i) x(i) + after(i) x(i+1) = right(i), in a ring: block elimination with the last block as border.
   subroutine solve_cyclic(before, here, after, right, x, found)
      real(wp), intent(in) :: before(:, :, :), here(:, :, :), after(:, :, :) !! shape (m, m, n)
      real(wp), intent(in) :: right(:, :, :)             !! shape (m, 1, n)
      real(wp), allocatable, intent(out) :: x(:, :)      !! shape (m, n)
      logical, intent(out) :: found
      real(wp), allocatable :: p(:, :, :)                !! shape (m, 2m+1, n-1): couplings ahead and to the border, right-hand side
      real(wp), allocatable :: pivot(:, :), row(:, :), corner(:, :), rest(:)
      type(factors_t) :: factors
      integer :: m, n, i, c

      m = size(here, 1)
      n = size(here, 3)
      allocate (x(m, n), p(m, 2*m + 1, n - 1), source=0.0_wp)
      allocate (pivot(m, m), row(m, 2*m + 1), corner(m, m), rest(m))
      found = .false.
      do i = 1, n - 1
         pivot = here(:, :, i)
         row = 0.0_wp
         row(:, 2*m + 1) = right(:, 1, i)
         if (i == 1) row(:, m + 1:2*m) = before(:, :, 1)
         if (i < n - 1) then
            row(:, :m) = after(:, :, i)
         else
            row(:, m + 1:2*m) = row(:, m + 1:2*m) + after(:, :, i)
         end if
         if (i > 1) then
            pivot = pivot - product_of(before(:, :, i), p(:, :m, i - 1))
            row(:, m + 1:) = row(:, m + 1:) - product_of(before(:, :, i), p(:, m + 1:, i - 1))
         end if
         call factorise(pivot, factors)
         if (.not. factors%reciprocal_condition > 0.0_wp) return
         do c = 1, 2*m + 1
            p(:, c, i) = solve(factors, row(:, c))
         end do
      end do
      ! back to front: every block by the last one alone
      do i = n - 2, 1, -1
         p(:, m + 1:, i) = p(:, m + 1:, i) - product_of(p(:, :m, i), p(:, m + 1:, i + 1))
      end do
      corner = here(:, :, n) - product_of(after(:, :, n), p(:, m + 1:2*m, 1)) - product_of(before(:, :, n), p(:, m + 1:2*m, n - 1))
      row(:, 1:1) = product_of(after(:, :, n), p(:, 2*m + 1:, 1)) + product_of(before(:, :, n), p(:, 2*m + 1:, n - 1))
      rest = right(:, 1, n) - row(:, 1)
      call factorise(corner, factors)
      found = factors%reciprocal_condition > 0.0_wp
      if (.not. found) return
      x(:, n) = solve(factors, rest)
      do i = 1, n - 1
         row(:, 1:1) = product_of(p(:, m + 1:2*m, i), x(:, n:n))
         x(:, i) = p(:, 2*m + 1, i) - row(:, 1)
      end do
   end subroutine solve_cyclic
end module psalm_periodic_spline
