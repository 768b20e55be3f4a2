!> Several coupled Hill equations y'' + C(x) y' + K(x) y = p(x), all of period 2 pi: steady state, multipliers, stability.
!>
!> As for one equation (`psalm_hill`) a period is integrated by Magnus's series of sixth order on the affine system (Blanes, Casas
!> and Ros 2000, three Gauss points a step), but by matrix exponentials; velocities are counted in units of a frequency, so that
!> stiff equations do not lose digits. The periodic solution follows from one linear system for the ends of parts of the period.
!> Source: Haines, chapter 9 and appendix 10S: his routine SSICS took any number of states.
module psalm_coupled_hill
   use psalm_kinds, only: wp, pi
   use psalm_lapack, only: general_eigenvalues, solve_general
   use psalm_linear, only: eliminate_real, product_of
   use psalm_periodic, only: periodic_t, periodic_from_samples
   implicit none (type, external)
   private
   public :: coupled_t, solve_coupled, without_mass, places_for, fastest

   !> What one period does, and the periodic solution.
   type :: coupled_t
      complex(wp), allocatable :: multipliers(:) !! shape (2 n), the largest modulus first
      real(wp) :: determinant_error = 0.0_wp !! product of the multipliers against exp(-integral trace C), relative
      real(wp) :: error = 0.0_wp            !! estimate for the elements of the period's matrix, relative to the largest
      logical :: stable = .false.           !! all multipliers are within the unit circle, by more than the error
      logical :: neutral = .false.          !! the largest lies on the unit circle within the error
      logical :: unique = .false.           !! no multiplier is 1 within the error: there is one periodic solution
      logical :: converged = .false.        !! the tolerance was reached
      logical :: too_fast = .false.         !! an equation is too stiff to be followed through a period; then, too,
      logical :: grows_too_much = .false.   !! in a period by more than numbers can hold: there are no results
      integer :: steps = 0
      real(wp), allocatable :: y(:, :), y1(:, :), y2(:, :) !! shape (places, n): periodic solution and derivatives at
                                            !! x = 2 pi (i - 1)/places; only if unique
   end type coupled_t

   integer, parameter :: parts = 16         !! of a period, whose ends are unknowns; places are a multiple of it
   integer, parameter :: fewest_places = 256 !! of a solution
   integer, parameter :: most_steps = 2**14
   real(wp), parameter :: most_growth = sqrt(huge(1.0_wp))/1.0e30_wp !! squares of it are formed
   real(wp), parameter :: steepest = 300.0_wp !! norm of the exponent of a step
   real(wp), parameter :: fastest = 1.0e6_wp !! frequency of the stiffest equation, by the period of 2 pi
   real(wp), parameter :: first_exponent = 100.0_wp !! of the longest steps that are tried
   real(wp), parameter :: gauss_offset = 0.387298334620741688517926539978239961_wp !! sqrt(15)/10
   real(wp), parameter :: negligible = 1.0e-5_wp !! of the tolerance: coefficients so small are left out
   real(wp), parameter :: eigenvalue_error = 16.0_wp !! over that of the matrix, where eigenvalues are well separated

contains

   !> Its errors: `grows_too_much` true if a period cannot be followed; `converged` false if `tolerance` is not reached with the
   !> largest number of steps, or the eigenvalues fail; `unique` false where a multiplier is 1 within the error.
   subroutine solve_coupled(c, k, p, tolerance, places, coupled)
      type(periodic_t), intent(in) :: c(:, :), k(:, :) !! shape (n, n)
      type(periodic_t), intent(in) :: p(:)             !! shape (n)
      real(wp), intent(in) :: tolerance                !! relative error of the elements of the period's matrix
      integer, intent(in) :: places                    !! of the solution: a multiple of 16
      type(coupled_t), intent(out) :: coupled
      type(periodic_t) :: c_used(size(p), size(p)), k_used(size(p), size(p)), p_used(size(p))
      real(wp), dimension(2*size(p) + 1, 2*size(p) + 1, places) :: maps
      real(wp), dimension(2*size(p) + 1, 2*size(p) + 1) :: period, before
      real(wp) :: units(size(p)), change, largest, exact
      integer :: i, j, m, n, h, sub, first
      logical :: found, steep

      n = size(p)
      m = 2*n
      allocate (coupled%multipliers(m), source=(0.0_wp, 0.0_wp))
      units = [(max(1.0_wp, sqrt(abs(k(i, i)%mean()))), i=1, n)]
      do i = 1, n
         p_used(i) = p(i)%trimmed(negligible*tolerance*maxval([(abs(p(i)%coefficient(h)), h=0, p(i)%highest())]))
         do j = 1, n
            c_used(i, j) = c(i, j)%trimmed(negligible*tolerance*sqrt(units(i)*units(j)))
            k_used(i, j) = k(i, j)%trimmed(negligible*tolerance*units(i)*units(j))
         end do
      end do
      coupled%too_fast = .not. maxval(units) < fastest
      coupled%grows_too_much = coupled%too_fast
      if (coupled%too_fast) return
      sub = 1 + int(2.0_wp*pi*maxval(units)/(real(places, wp)*first_exponent))
      do
         call integrate(c_used, k_used, p_used, units, sub, maps, before, steep, coupled%grows_too_much)
         if (.not. steep .or. sub*places >= most_steps) exit
         sub = 2*sub
      end do
      first = sub
      coupled%too_fast = steep
      do
         if (coupled%grows_too_much) return
         sub = 2*sub
         call integrate(c_used, k_used, p_used, units, sub, maps, period, steep, coupled%grows_too_much)
         if (coupled%grows_too_much) return
         change = maxval(abs(period(:m, :m) - before(:m, :m)))/max(1.0_wp, maxval(abs(period(:m, :m))))
         largest = maxval(abs(period(:m, m + 1)))
         if (largest > 0.0_wp) change = max(change, maxval(abs(period(:m, m + 1) - before(:m, m + 1)))/largest)
         change = change/63.0_wp ! of sixth order
         coupled%steps = sub*places
         coupled%error = max(change, 0.25_wp*real(coupled%steps, wp)*epsilon(1.0_wp))
         coupled%converged = change <= tolerance
         if (coupled%converged .or. 2*coupled%steps > max(most_steps, 4*first*places)) exit
         before = period
      end do
      call general_eigenvalues(period(:m, :m), coupled%multipliers, found)
      coupled%converged = coupled%converged .and. found
      exact = exp(-2.0_wp*pi*sum([(c(i, i)%mean(), i=1, n)]))
      ! beside large multipliers the small ones lose digits
      coupled%determinant_error = abs(product(coupled%multipliers) - exact)/ &
                                  max(exact, abs(product(coupled%multipliers(:n))), tiny(1.0_wp))
      largest = abs(coupled%multipliers(1))
      change = eigenvalue_error*coupled%error*max(1.0_wp, maxval(abs(period(:m, :m))))
      coupled%stable = found .and. largest < 1.0_wp - change
      coupled%neutral = found .and. .not. coupled%stable .and. largest <= 1.0_wp + sqrt(change) ! two may be equal
      coupled%unique = found .and. all(abs(coupled%multipliers - 1.0_wp) > change)
      if (coupled%unique) call follow(c_used, k_used, p_used, units, maps, coupled)
   end subroutine solve_coupled

   !> The maps of all places to the next, and of the whole period, in y and y'/units.
   subroutine integrate(c, k, p, units, sub, maps, period, steep, grows_too_much)
      type(periodic_t), intent(in) :: c(:, :), k(:, :), p(:)
      real(wp), intent(in) :: units(:)
      integer, intent(in) :: sub                       !! steps between two places
      real(wp), intent(out) :: maps(:, :, :)           !! shape (2 n + 1, 2 n + 1, places)
      real(wp), intent(out) :: period(:, :)
      logical, intent(out) :: steep                    !! the steps are too long
      logical, intent(out) :: grows_too_much
      real(wp), dimension(size(period, 1), size(period, 1), 3) :: a
      real(wp), dimension(size(period, 1), size(period, 1)) :: step, a1, a2, a3, c1, c2
      real(wp), allocatable :: at(:, :, :, :)          ! coefficients at the Gauss points: shape (steps, 3, n, 2 n + 1)
      real(wp) :: h
      integer :: i, j, g, s, n, m, place, steps

      n = size(p)
      m = 2*n + 1
      steps = sub*size(maps, 3)
      h = 2.0_wp*pi/real(steps, wp)
      allocate (at(steps, 3, n, m))
      do g = 1, 3
         associate (shift => 0.5_wp + real(g - 2, wp)*gauss_offset)
            do i = 1, n
               do j = 1, n
                  at(:, g, i, j) = -k(i, j)%values(steps, shift)/units(i)
                  at(:, g, i, n + j) = -c(i, j)%values(steps, shift)*(units(j)/units(i))
               end do
               at(:, g, i, m) = p(i)%values(steps, shift)/units(i)
            end do
         end associate
      end do
      a = 0.0_wp
      do i = 1, n
         a(i, n + i, :) = units(i)
      end do
      period = unit_matrix(m)
      grows_too_much = .true.
      steep = .false.
      do place = 1, size(maps, 3)
         maps(:, :, place) = unit_matrix(m)
         do s = (place - 1)*sub + 1, place*sub
            do g = 1, 3
               a(n + 1:2*n, :, g) = at(s, g, :, :)
            end do
            a1 = h*a(:, :, 2)
            a2 = (2.0_wp*gauss_offset*5.0_wp/3.0_wp*h)*(a(:, :, 3) - a(:, :, 1)) ! sqrt(15)/3
            a3 = (10.0_wp/3.0_wp*h)*(a(:, :, 3) - 2.0_wp*a(:, :, 2) + a(:, :, 1))
            c1 = commutator(a1, a2)
            c2 = -commutator(a1, 2.0_wp*a3 + c1)/60.0_wp
            step = a1 + a3/12.0_wp + commutator(-20.0_wp*a1 - a3 + c1, a2 + c2)/240.0_wp
            steep = .not. maxval(sum(abs(step), dim=1)) < steepest
            if (steep) return
            maps(:, :, place) = product_of(exponential(step), maps(:, :, place))
         end do
         period = product_of(maps(:, :, place), period)
         if (.not. maxval(abs(period)) < most_growth) return
      end do
      grows_too_much = .false.
   end subroutine integrate

   !> The periodic solution at all places.
   subroutine follow(c, k, p, units, maps, coupled)
      type(periodic_t), intent(in) :: c(:, :), k(:, :), p(:)
      real(wp), intent(in) :: units(:)
      real(wp), intent(in) :: maps(:, :, :)
      type(coupled_t), intent(inout) :: coupled
      real(wp) :: matrix(2*size(p)*parts, 2*size(p)*parts), right(2*size(p)*parts), ends(2*size(p)*parts)
      real(wp), dimension(size(maps, 1), size(maps, 1)) :: part
      real(wp) :: state(size(maps, 1), 1)
      integer :: i, j, n, m, row, next, places
      logical :: ok

      n = size(p)
      m = 2*n
      places = size(maps, 3)
      matrix = 0.0_wp
      do i = 1, parts
         part = unit_matrix(m + 1)
         do j = (i - 1)*(places/parts) + 1, i*(places/parts)
            part = product_of(maps(:, :, j), part)
         end do
         row = (i - 1)*m
         next = modulo(i, parts)*m
         matrix(row + 1:row + m, row + 1:row + m) = -part(:m, :m)
         do j = 1, m
            matrix(row + j, next + j) = matrix(row + j, next + j) + 1.0_wp
         end do
         right(row + 1:row + m) = part(:m, m + 1)
      end do
      call solve_general(matrix, right, ends, ok)
      coupled%unique = ok
      if (.not. ok) return
      allocate (coupled%y(places, n), coupled%y1(places, n), coupled%y2(places, n))
      do i = 1, places
         if (modulo(i - 1, places/parts) == 0) then
            row = (i - 1)/(places/parts)*m
            state(:m, 1) = ends(row + 1:row + m)
            state(m + 1, 1) = 1.0_wp
         end if
         coupled%y(i, :) = state(:n, 1)
         coupled%y1(i, :) = state(n + 1:m, 1)*units
         state = product_of(maps(:, :, i), state)
      end do
      do i = 1, n
         coupled%y2(:, i) = p(i)%values(places)
         do j = 1, n
            coupled%y2(:, i) = coupled%y2(:, i) - c(i, j)%values(places)*coupled%y1(:, j) - k(i, j)%values(places)*coupled%y(:, j)
         end do
      end do
   end subroutine follow

   !> How many places a solution is to have whose coefficients are known by so many values: not fewer, a multiple of `parts`.
   pure integer function places_for(values) result(places)
      integer, intent(in) :: values

      places = fewest_places
      do while (places < values)
         places = 2*places
      end do
   end function places_for

   !> From M y'' + C y' + K y = p, by values at equal steps of the period, to y'' + C y' + K y = p.
   pure subroutine without_mass(mass, damping, stiffness, load, c, k, p)
      real(wp), intent(in) :: mass(:, :, :)      !! shape (n, n, steps): regular
      real(wp), intent(in) :: damping(:, :, :), stiffness(:, :, :) !! shape (n, n, steps)
      real(wp), intent(in) :: load(:, :)         !! shape (n, steps)
      type(periodic_t), intent(out) :: c(:, :), k(:, :) !! shape (n, n)
      type(periodic_t), intent(out) :: p(:)      !! shape (n)
      real(wp), allocatable :: c_at(:, :, :), k_at(:, :, :), p_at(:, :)
      integer :: i, j

      c_at = damping
      k_at = stiffness
      p_at = load
      do i = 1, size(load, 2)
         call divide_by_mass(mass(:, :, i), c_at(:, :, i), k_at(:, :, i), p_at(:, i))
      end do
      do j = 1, size(p)
         p(j) = periodic_from_samples(p_at(j, :))
         do i = 1, size(p)
            c(i, j) = periodic_from_samples(c_at(i, j, :))
            k(i, j) = periodic_from_samples(k_at(i, j, :))
         end do
      end do
   end subroutine without_mass

   !> The same at one place.
   pure subroutine divide_by_mass(m, c, k, p)
      real(wp), intent(in) :: m(:, :)            !! shape (n, n): regular
      real(wp), intent(inout) :: c(:, :), k(:, :) !! shape (n, n)
      real(wp), intent(inout) :: p(:)            !! shape (n)
      real(wp) :: matrix(size(p), size(p)), right(size(p), 2*size(p) + 1), determinant
      integer :: n

      n = size(p)
      matrix = m
      right(:, :n) = c
      right(:, n + 1:2*n) = k
      right(:, 2*n + 1) = p
      call eliminate_real(n, size(right, 2), matrix, right, determinant)
      c = right(:, :n)
      k = right(:, n + 1:2*n)
      p = right(:, 2*n + 1)
   end subroutine divide_by_mass

   pure function unit_matrix(m) result(unit)
      integer, intent(in) :: m
      real(wp) :: unit(m, m)
      integer :: i

      unit = 0.0_wp
      do i = 1, m
         unit(i, i) = 1.0_wp
      end do
   end function unit_matrix

   !> exp(a) by Taylor's series of 12 terms in blocks of three (Paterson and Stockmeyer 1973), after scaling to a norm below a
   !> quarter, where the rest is below epsilon, then squaring.
   pure function exponential(a) result(e)
      real(wp), intent(in) :: a(:, :)
      real(wp), dimension(size(a, 1), size(a, 1)) :: e, x, x2, x3
      integer :: i, squarings
      real(wp), parameter :: c(12) = 1.0_wp/[1.0_wp, 2.0_wp, 6.0_wp, 24.0_wp, 120.0_wp, 720.0_wp, 5040.0_wp, 40320.0_wp, &
                                             362880.0_wp, 3628800.0_wp, 39916800.0_wp, 479001600.0_wp]

      squarings = max(0, 2 + exponent(maxval(sum(abs(a), dim=1))))
      x = a/2.0_wp**squarings
      x2 = product_of(x, x)
      x3 = product_of(x2, x)
      e = c(10)*x + c(11)*x2 + c(12)*x3
      call add_unit(c(9), e)
      e = c(7)*x + c(8)*x2 + product_of(x3, e)
      call add_unit(c(6), e)
      e = c(4)*x + c(5)*x2 + product_of(x3, e)
      call add_unit(c(3), e)
      e = x + c(2)*x2 + product_of(x3, e)
      do i = 1, squarings
         e = 2.0_wp*e + product_of(e, e) ! of e - 1, which keeps the digits of small exponents
      end do
      call add_unit(1.0_wp, e)
   end function exponential

   pure subroutine add_unit(factor, matrix)
      real(wp), intent(in) :: factor
      real(wp), intent(inout) :: matrix(:, :)
      integer :: i

      do i = 1, size(matrix, 1)
         matrix(i, i) = matrix(i, i) + factor
      end do
   end subroutine add_unit

   pure function commutator(a, b) result(c)
      real(wp), intent(in) :: a(:, :), b(:, :)
      real(wp) :: c(size(a, 1), size(a, 1))

      c = product_of(a, b) - product_of(b, a)
   end function commutator
end module psalm_coupled_hill
