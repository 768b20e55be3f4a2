!> The forced Hill equation y'' + c1(x) y' + c0(x) y = p(x), all of period 2 pi: steady state, multipliers, stability.
!>
!> One period is integrated by Magnus's series of sixth order (Blanes, Casas and Ros 2000, three Gauss points a step) on the affine
!> system: each step is an exact exponential, so the determinant of the period is exp(-integral c1) but for its quadrature, and a
!> constant coefficient is integrated exactly. The number of steps is doubled until the period does not change any more.
!> Source: Haines, chapter 7 (there Runge and Kutta of fourth order); the equation is (13.24) of Oldham with other coefficients.
module psalm_hill
   use psalm_kinds, only: wp, pi
   use psalm_lapack, only: solve_general
   use psalm_periodic, only: periodic_t, periodic_from_samples
   implicit none (type, external)
   private
   public :: hill_t, solve_hill, greatest_of, most_damping

   !> What one period does, and the periodic solution.
   type :: hill_t
      real(wp) :: transfer(2, 2) = 0.0_wp   !! (y, y') after one period, of the free equation: columns from (1, 0) and (0, 1)
      real(wp) :: forced(2) = 0.0_wp        !! (y, y') after one period from rest
      real(wp) :: start(2) = 0.0_wp         !! (y, y') at x = 0 of the periodic solution
      complex(wp) :: multipliers(2) = (0.0_wp, 0.0_wp) !! eigenvalues of `transfer`, the larger first
      real(wp) :: determinant_error = 0.0_wp !! of `transfer` against exp(-integral c1), relative
      real(wp) :: error = 0.0_wp            !! estimate for the elements of `transfer`, relative to the largest
      logical :: stable = .false.           !! both multipliers are within the unit circle, by more than the error
      logical :: neutral = .false.          !! the larger lies on the unit circle within the error
      logical :: unique = .false.           !! no multiplier is 1 within the error: there is one periodic solution
      logical :: converged = .false.        !! the tolerance was reached
      logical :: grows_too_much = .false.   !! in a turn by more than numbers can hold: there are no results
      logical :: too_stiff = .false.        !! c1 is so large that no step is short enough: there are none either
      integer :: steps = 0
      real(wp), allocatable :: y(:), y1(:), y2(:) !! periodic solution and derivatives at x = 2 pi (i - 1)/steps; only if unique
   end type hill_t

   !> The system of order one (y, y')' = m (y, y') + b, or its integral over a step.
   type :: affine_t
      real(wp) :: m(2, 2), b(2)
   end type affine_t

   type(affine_t), parameter :: unit_map = affine_t(reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2]), [0.0_wp, 0.0_wp])
   integer, parameter :: parts = 16 !! of a turn, for the periodic solution; a divisor of every number of steps
   real(wp), parameter :: most_growth = sqrt(huge(1.0_wp))/1.0e30_wp !! squares of it are formed
   real(wp), parameter :: steepest = 300.0_wp !! of the exponent of a step
   real(wp), parameter :: near_greatest = 0.7_wp !! of the greatest step: a maximum between steps may be so far above them
   real(wp), parameter :: level = 64.0_wp*epsilon(1.0_wp) !! part of the greatest by which rounding makes neighbours differ
   real(wp), parameter :: most_damping = 2.0e5_wp !! c1: of the shortest step the exponent is 10
   integer, parameter :: newton_steps = 5
   integer, parameter :: fewest_steps = 64, most_steps = 2**17
   real(wp), parameter :: gauss_offset = 0.387298334620741688517926539978239961_wp !! sqrt(15)/10

contains

   !> Its errors: `grows_too_much` true if a turn cannot be followed, with `too_stiff` for its damping; `converged` false if
   !> `tolerance` is not reached with the largest number of steps; `unique` false where a multiplier is 1 within the error (then
   !> there is no steady state, or none that is unique, and `y` is not allocated).
   pure function solve_hill(c1, c0, p, tolerance) result(hill)
      type(periodic_t), intent(in) :: c1, c0, p
      real(wp), intent(in) :: tolerance !! relative error of the elements of the period's matrix
      type(hill_t) :: hill
      type(affine_t), allocatable :: steps(:)
      type(affine_t) :: period, before
      real(wp) :: change, largest, determinant, exact
      integer :: n

      hill%too_stiff = .not. maxval(abs(c1%values(fewest_steps))) <= most_damping
      hill%grows_too_much = hill%too_stiff
      if (hill%too_stiff) return
      n = fewest_steps
      do while (n < most_steps .and. real(n, wp) < 2.0_wp*sqrt(maxval(abs(c0%values(fewest_steps)))))
         n = 2*n
      end do
      n = max(n, fewest_steps*((4*max(c0%highest(), c1%highest(), p%highest()))/fewest_steps))
      call integrate(c1, c0, p, n, steps, before, hill%grows_too_much)
      do
         if (hill%grows_too_much) return
         n = 2*n
         call integrate(c1, c0, p, n, steps, period, hill%grows_too_much)
         if (hill%grows_too_much) return
         ! of sixth order: the error left is a 63rd of the change
         change = maxval(abs(period%m - before%m))/max(1.0_wp, maxval(abs(period%m)))
         largest = maxval(abs(period%b))
         if (largest > 0.0_wp) change = max(change, maxval(abs(period%b - before%b))/largest)
         change = change/63.0_wp
         hill%error = max(change, 0.25_wp*real(n, wp)*epsilon(1.0_wp))
         hill%converged = change <= tolerance
         if (hill%converged .or. n >= most_steps) exit
         before = period
      end do
      hill%steps = n
      hill%transfer = period%m
      hill%forced = period%b
      exact = exp(-2.0_wp*pi*c1%mean())
      determinant = period%m(1, 1)*period%m(2, 2) - period%m(1, 2)*period%m(2, 1)
      ! where everything dies within a turn all of it is 0
      hill%determinant_error = abs(determinant - exact)/max(exact, abs(period%m(1, 1)*period%m(2, 2)), &
                                                            abs(period%m(1, 2)*period%m(2, 1)), tiny(1.0_wp))
      call settle_stability(hill, exact)
      if (hill%unique) call follow(hill, c1, c0, p, steps)
   end function solve_hill

   !> Greatest |y| of the periodic solution, between its steps too. Newton's method for y' = 0, with the Fourier series
   !> through the steps, from every step whose |y| is not below that of its neighbours and comes near the greatest. 0 if there is
   !> no such solution.
   pure real(wp) function greatest_of(hill) result(greatest)
      type(hill_t), intent(in) :: hill
      type(periodic_t) :: y, y1, y2
      real(wp) :: largest, x, width, slope, bend
      integer :: i, k, n

      greatest = 0.0_wp
      if (.not. allocated(hill%y)) return
      n = size(hill%y)
      width = 2.0_wp*pi/real(n, wp)
      largest = maxval(abs(hill%y))
      greatest = largest
      if (.not. largest > 0.0_wp) return
      y = periodic_from_samples(hill%y)
      y1 = y%derivative(1)
      y2 = y%derivative(2)
      do i = 1, n
         if (abs(hill%y(i)) < near_greatest*largest) cycle
         if (abs(hill%y(i)) < abs(hill%y(modulo(i, n) + 1)) .or. abs(hill%y(i)) < abs(hill%y(modulo(i - 2, n) + 1))) cycle
         ! nothing higher lies between steps that are level but for rounding
         if (abs(hill%y(i)) - min(abs(hill%y(modulo(i, n) + 1)), abs(hill%y(modulo(i - 2, n) + 1))) <= level*largest) cycle
         x = 0.0_wp
         do k = 1, newton_steps
            slope = y1%at(width*real(i - 1, wp) + x)
            bend = y2%at(width*real(i - 1, wp) + x)
            if (.not. abs(slope) < width*abs(bend)) exit
            x = x - slope/bend
            if (abs(x) > width) exit
         end do
         if (abs(x) <= width) greatest = max(greatest, abs(y%at(width*real(i - 1, wp) + x)))
      end do
   end function greatest_of

   !> Eigenvalues of a period's matrix from its trace and determinant, the larger first. The determinant is better known than
   !> the small eigenvalue of an unstable period, which is lost in the trace.
   pure function multipliers_of(trace, determinant) result(mu)
      real(wp), intent(in) :: trace, determinant
      complex(wp) :: mu(2)
      real(wp) :: half, square, larger

      half = 0.5_wp*trace
      square = half*half - determinant
      if (square < 0.0_wp) then
         mu = [cmplx(half, sqrt(-square), wp), cmplx(half, -sqrt(-square), wp)]
      else
         larger = half + sign(sqrt(square), half)
         mu(1) = larger
         mu(2) = 0.0_wp
         if (abs(larger) > 0.0_wp) mu(2) = determinant/larger
      end if
   end function multipliers_of

   pure subroutine settle_stability(hill, determinant)
      type(hill_t), intent(inout) :: hill
      real(wp), intent(in) :: determinant !! of the period, from the mean of c1
      real(wp) :: trace, size_of, slack, margins(2)

      trace = hill%transfer(1, 1) + hill%transfer(2, 2)
      hill%multipliers = multipliers_of(trace, determinant)
      size_of = max(1.0_wp, maxval(abs(hill%transfer)))
      slack = 16.0_wp*hill%error*size_of
      ! by trace and determinant: two equal multipliers are known to half the digits only
      margins = [1.0_wp + determinant - abs(trace), 1.0_wp - determinant]
      hill%stable = all(margins > slack)
      hill%neutral = .not. hill%stable .and. all(margins >= -slack)
      hill%unique = abs(1.0_wp - trace + determinant) > slack*size_of ! the determinant of 1 - transfer
   end subroutine settle_stability

   !> The periodic solution, step by step. The turn is cut into parts whose ends are unknowns of one linear system, so that
   !> the growth of an unstable equation does not magnify rounding over the whole turn.
   pure subroutine follow(hill, c1, c0, p, steps)
      type(hill_t), intent(inout) :: hill
      type(periodic_t), intent(in) :: c1, c0, p
      type(affine_t), intent(in) :: steps(:)
      type(affine_t) :: part
      real(wp) :: matrix(2*parts, 2*parts), right(2*parts), ends(2*parts), state(2)
      integer :: i, k, n, row, next
      logical :: ok

      n = hill%steps
      matrix = 0.0_wp
      do k = 1, parts
         part = unit_map
         do i = (k - 1)*(n/parts) + 1, k*(n/parts)
            part = affine_t(product_of(steps(i)%m, part%m), times(steps(i)%m, part%b) + steps(i)%b)
         end do
         row = 2*k - 1
         next = 2*modulo(k, parts) + 1
         matrix(row:row + 1, row:row + 1) = -part%m
         matrix(row, next) = matrix(row, next) + 1.0_wp
         matrix(row + 1, next + 1) = matrix(row + 1, next + 1) + 1.0_wp
         right(row:row + 1) = part%b
      end do
      call solve_general(matrix, right, ends, ok)
      hill%unique = ok
      if (.not. ok) return
      hill%start = ends(1:2)
      allocate (hill%y(n), hill%y1(n))
      do k = 1, parts
         state = ends(2*k - 1:2*k)
         do i = (k - 1)*(n/parts) + 1, k*(n/parts)
            hill%y(i) = state(1)
            hill%y1(i) = state(2)
            state = times(steps(i)%m, state) + steps(i)%b
         end do
      end do
      hill%y2 = p%values(n) - c1%values(n)*hill%y1 - c0%values(n)*hill%y
   end subroutine follow

   !> All steps of a period, and the period.
   pure subroutine integrate(c1, c0, p, n, steps, period, too_much)
      type(periodic_t), intent(in) :: c1, c0, p
      integer, intent(in) :: n
      type(affine_t), allocatable, intent(out) :: steps(:)
      type(affine_t), intent(out) :: period
      logical, intent(out) :: too_much
      type(affine_t) :: at(3)
      real(wp) :: damping(n, 3), stiffness(n, 3), force(n, 3), h
      integer :: i, k

      allocate (steps(n))
      h = 2.0_wp*pi/real(n, wp)
      do k = 1, 3
         damping(:, k) = c1%values(n, 0.5_wp + real(k - 2, wp)*gauss_offset)
         stiffness(:, k) = c0%values(n, 0.5_wp + real(k - 2, wp)*gauss_offset)
         force(:, k) = p%values(n, 0.5_wp + real(k - 2, wp)*gauss_offset)
      end do
      period = unit_map
      too_much = .false.
      do i = 1, n
         do k = 1, 3
            at(k) = affine_t(reshape([0.0_wp, -stiffness(i, k), 1.0_wp, -damping(i, k)], [2, 2]), [0.0_wp, force(i, k)])
         end do
         at(1) = magnus(at, h)
         too_much = growth_of(at(1)%m) > steepest .or. maxval(abs(period%m)) > most_growth
         if (too_much) return
         steps(i) = exponential(at(1))
         period = affine_t(product_of(steps(i)%m, period%m), times(steps(i)%m, period%b) + steps(i)%b)
      end do
   end subroutine integrate

   !> Largest real part of the eigenvalues of an exponent.
   pure real(wp) function growth_of(m)
      real(wp), intent(in) :: m(2, 2)
      real(wp) :: half

      half = 0.5_wp*(m(1, 1) - m(2, 2))
      growth_of = 0.5_wp*(m(1, 1) + m(2, 2)) + sqrt(max(half*half + m(1, 2)*m(2, 1), 0.0_wp))
   end function growth_of

   !> Exponent of a step of length h from the system at the three Gauss points. Sixth order: Blanes, Casas, Oteo, Ros, The Magnus
   !> expansion and some of its applications, Physics Reports 470 (2009), eq. 253-257.
   pure type(affine_t) function magnus(at, h)
      type(affine_t), intent(in) :: at(3)
      real(wp), intent(in) :: h
      type(affine_t) :: a1, a2, a3, c1, c2
      real(wp), parameter :: root15 = 3.87298334620741688517926539978239961_wp

      a1 = combined(h, at(2), 0.0_wp, at(2))
      a2 = combined(root15*h/3.0_wp, at(3), -root15*h/3.0_wp, at(1))
      a3 = combined(1.0_wp, combined(10.0_wp*h/3.0_wp, at(3), 10.0_wp*h/3.0_wp, at(1)), -20.0_wp*h/3.0_wp, at(2))
      c1 = commutator(a1, a2)
      c2 = commutator(a1, combined(2.0_wp, a3, 1.0_wp, c1))
      magnus = combined(1.0_wp, a1, 1.0_wp/12.0_wp, a3)
      magnus = combined(1.0_wp, magnus, 1.0_wp/240.0_wp, &
                        commutator(combined(1.0_wp, combined(-20.0_wp, a1, -1.0_wp, a3), 1.0_wp, c1), &
                                   combined(1.0_wp, a2, -1.0_wp/60.0_wp, c2)))
   end function magnus

   pure type(affine_t) function combined(f, a, g, b)
      real(wp), intent(in) :: f, g
      type(affine_t), intent(in) :: a, b

      combined%m = f*a%m + g*b%m
      combined%b = f*a%b + g*b%b
   end function combined

   pure type(affine_t) function commutator(a, b)
      type(affine_t), intent(in) :: a, b

      commutator%m = product_of(a%m, b%m) - product_of(b%m, a%m)
      commutator%b = times(a%m, b%b) - times(b%m, a%b)
   end function commutator

   !> exp of an affine exponent: exp(m), and integral exp(t m) dt b over t = 0..1.
   pure type(affine_t) function exponential(w)
      type(affine_t), intent(in) :: w
      real(wp) :: half, n(2, 2), square, root, c, s, growth, f, g

      half = 0.5_wp*(w%m(1, 1) + w%m(2, 2))
      n = w%m
      n(1, 1) = n(1, 1) - half
      n(2, 2) = n(2, 2) - half
      square = n(1, 1)*n(1, 1) + n(1, 2)*n(2, 1) ! n*n is this times the unit matrix
      root = sqrt(abs(square))
      growth = exp(half)
      if (square < 0.0_wp) then
         c = cos(root)
         s = sin(root)
      else
         c = cosh(root)
         s = sinh(root)
      end if
      if (root > sqrt(epsilon(1.0_wp))) then
         s = s/root
      else
         s = 1.0_wp ! its next term, root**2/6, is lost in rounding
      end if
      call integral(half, square, growth*c, growth*s, f, g)
      exponential%m = growth*s*n
      exponential%m(1, 1) = exponential%m(1, 1) + growth*c
      exponential%m(2, 2) = exponential%m(2, 2) + growth*c
      exponential%b = f*w%b + g*times(n, w%b)
   end function exponential

   !> integral exp(t m) dt over t = 0..1 = f + g n, where m = half + n, n*n = square, exp(m) = c + s n.
   pure subroutine integral(half, square, c, s, f, g)
      real(wp), intent(in) :: half, square, c, s
      real(wp), intent(out) :: f, g
      real(wp) :: a, b, next, determinant, factor
      integer :: k
      integer, parameter :: terms = 60
      real(wp), parameter :: far = 1.0_wp ! from where the closed form loses no digit that matters

      determinant = half*half - square
      if (abs(determinant) > far) then
         g = (half*s - c + 1.0_wp)/determinant
         f = s - half*g
         return
      end if
      a = 1.0_wp ! m**k/k! = a + b n
      b = 0.0_wp
      f = 0.0_wp
      g = 0.0_wp
      do k = 1, terms
         factor = 1.0_wp/real(k, wp)
         f = f + a*factor
         g = g + b*factor
         next = (half*a + square*b)*factor
         b = (a + half*b)*factor
         a = next
         if (abs(a) + abs(b) <= epsilon(1.0_wp)*epsilon(1.0_wp)) exit
      end do
   end subroutine integral

   pure function product_of(a, b) result(c)
      real(wp), intent(in) :: a(2, 2), b(2, 2)
      real(wp) :: c(2, 2)

      c(:, 1) = a(:, 1)*b(1, 1) + a(:, 2)*b(2, 1)
      c(:, 2) = a(:, 1)*b(1, 2) + a(:, 2)*b(2, 2)
   end function product_of

   pure function times(a, v) result(w)
      real(wp), intent(in) :: a(2, 2), v(2)
      real(wp) :: w(2)

      w = a(:, 1)*v(1) + a(:, 2)*v(2)
   end function times
end module psalm_hill
