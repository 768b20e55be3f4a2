!> The proof that solutions of a nine-point problem exist, are distinct and are real: Krawczyk's test in discs.
!>
!> For a solution v of 24 numbers (both legs, eight turns and partners), Y the inverse of its matrix, and radii r:
!>    |Y F(v)| + |I - Y J| r + |Y| rad(J) r < r   in every number
!> says that exactly one solution lies in the discs |w - v| <= r. If numbers and partners of v are conjugate and the data are
!> real, that solution is. F is evaluated in extended precision with a bound of its rounding. Source: Krawczyk (1969); Rump (1999)
!> for discs; Breiding, Rose and Timme (2023) for the test of reality.
module psalm_certificate
   use psalm_kinds, only: wp
   use psalm_leg_problem, only: at_a, at_ah, at_b, at_bh, at_x, at_xh, at_y, at_yh, most_points, variables
   implicit none (type, external)
   private
   public :: certificate_t, certify

   integer, parameter :: unknowns = variables + 2*most_points
   !> A kind of at least 18 digits: that of x87 where there is one.
   integer, parameter :: xp = merge(wp, selected_real_kind(18), precision(1.0_wp) >= 18)
   real(wp), parameter :: width = 3.0_wp             !! radius over the bound of the correction
   real(wp), parameter :: least = 1.0e-15_wp         !! of a radius, over the number
   real(wp), parameter :: rounding = 2.0e-14_wp      !! of products of 24 x 24 matrices, relative
   real(wp), parameter :: outward = 1.0_wp + 1.0e-10_wp !! that covers the rounding of bounds themselves
   integer, parameter :: forms = 3                   !! cognates that are tried
   integer, parameter :: corrections = 2             !! steps of Newton's method before the test

   type :: certificate_t
      integer :: proven = 0                          !! solutions that exist
      integer :: apart = 0                           !! of these those whose discs meet no other's
      integer :: real_ones = 0                       !! proven to be real
      integer :: not_real = 0                        !! proven not to be
   end type certificate_t

contains

   !> Examine solutions with differences (x, xh, a, ah, u, uh, s, sh) and their turns. `d` displacements, exactly as given.
   subroutine certify(first, points, solutions, turns, partners, likely_real, certificate)
      complex(wp), intent(in) :: first               !! point that displacements are counted from
      complex(wp), intent(in) :: points(most_points) !! the others
      complex(wp), intent(in) :: solutions(:, :)     !! shape (variables, count)
      complex(wp), intent(in) :: turns(:, :), partners(:, :) !! g and gh, shape (most_points, count)
      logical, intent(in) :: likely_real(:)          !! shape (count)
      type(certificate_t), intent(out) :: certificate
      complex(xp) :: d(most_points)
      complex(wp) :: v(unknowns), w(unknowns), key(size(solutions, 2)), key_partner(size(solutions, 2))
      real(wp) :: r(unknowns), radius(size(solutions, 2)), radius_partner(size(solutions, 2))
      logical :: sound(size(solutions, 2)), holds
      integer :: i, form

      d = cmplx(points, kind=xp) - cmplx(first, kind=xp)
      sound = .false.
      do i = 1, size(solutions, 2)
         w = [solutions(:, i), turns(:, i), partners(:, i)]
         do form = 1, forms
            ! of three cognates one is best conditioned
            if (form == 2) w = cognate_of(points - first, w)
            if (form == 3) w = cognate_of(points - first, with_legs_exchanged([solutions(:, i), turns(:, i), partners(:, i)]))
            v = w
            call test(d, corrections, v, r, holds)
            if (holds) exit
         end do
         sound(i) = holds
         if (.not. holds) cycle
         certificate%proven = certificate%proven + 1
         call third_pivot(v([at_x, at_a, at_y, at_b]), r([at_x, at_a, at_y, at_b]), key(i), radius(i))
         call third_pivot(v([at_xh, at_ah, at_yh, at_bh]), r([at_xh, at_ah, at_yh, at_bh]), key_partner(i), radius_partner(i))
         if (likely_real(i)) then
            w = v
            w(2:variables:2) = conjg(w(1:variables:2))
            w(variables + most_points + 1:) = conjg(w(variables + 1:variables + most_points))
            call test(d, 0, w, r, holds)
            if (holds) certificate%real_ones = certificate%real_ones + 1
         else if (any(abs(v(2:variables:2) - conjg(v(1:variables:2))) > outward*(r(2:variables:2) + r(1:variables:2)))) then
            certificate%not_real = certificate%not_real + 1
         end if
      end do
      call count_apart(sound, key, radius, key_partner, radius_partner, certificate%apart)
   end subroutine certify

   !> The same four-bar with its legs exchanged.
   pure function with_legs_exchanged(v) result(other)
      complex(wp), intent(in) :: v(unknowns)
      complex(wp) :: other(unknowns)

      other = v
      other(:at_ah) = v(:at_ah) + v(at_y:variables)
      other(at_y:variables) = -v(at_y:variables)
   end function with_legs_exchanged

   !> The cognate that keeps pivot a.
   pure function cognate_of(d, v) result(other)
      complex(wp), intent(in) :: d(most_points), v(unknowns)
      complex(wp) :: other(unknowns)
      integer :: i

      other(at_x) = v(at_a) - v(at_x)
      other(at_xh) = v(at_ah) - v(at_xh)
      other(at_a) = v(at_a)
      other(at_ah) = v(at_ah)
      other(at_y) = other(at_x)*v(at_x)/v(at_y)
      other(at_yh) = other(at_xh)*v(at_xh)/v(at_yh)
      other(at_b) = -v(at_b)*v(at_x)/v(at_y)
      other(at_bh) = -v(at_bh)*v(at_xh)/v(at_yh)
      ! its coupler turns with the crank
      do i = 1, most_points
         other(variables + i) = -(d(i) + v(variables + i)*v(at_x))/other(at_x)
         other(variables + most_points + i) = -(conjg(d(i)) + v(variables + most_points + i)*v(at_xh))/other(at_xh)
      end do
   end function cognate_of

   !> Three times a plus s less s x/u: sum of the three pivots, which exchange of the legs and cognates leave alone; with its disc.
   pure subroutine third_pivot(legs, r, key, radius)
      complex(wp), intent(in) :: legs(4)             !! x, a, u, s
      real(wp), intent(in) :: r(4)
      complex(wp), intent(out) :: key
      real(wp), intent(out) :: radius
      complex(wp) :: quotient
      real(wp) :: product_radius

      quotient = legs(4)*legs(1)/legs(3)
      key = 3.0_wp*legs(2) + legs(4) - quotient
      radius = huge(1.0_wp)
      if (abs(legs(3)) <= 2.0_wp*r(3)) return
      product_radius = abs(legs(4))*r(1) + abs(legs(1))*r(4) + r(1)*r(4)
      radius = (product_radius + abs(quotient)*r(3))/(abs(legs(3)) - r(3)) + 3.0_wp*r(2) + r(4) + &
               rounding*(abs(quotient) + 3.0_wp*abs(legs(2)) + abs(legs(4)))
      radius = outward*radius
   end subroutine third_pivot

   !> Solutions whose disc, or that of the partners, meets no other's.
   pure subroutine count_apart(sound, key, radius, key_partner, radius_partner, apart)
      logical, intent(in) :: sound(:)
      complex(wp), intent(in) :: key(:), key_partner(:)
      real(wp), intent(in) :: radius(:), radius_partner(:)
      integer, intent(out) :: apart
      logical :: meets(size(sound))
      integer :: i, k

      meets = .false.
      do i = 1, size(sound)
         if (.not. sound(i)) cycle
         do k = i + 1, size(sound)
            if (.not. sound(k)) cycle
            if (abs(real(key(i) - key(k), wp)) > radius(i) + radius(k)) cycle
            if (abs(key(i) - key(k)) > outward*(radius(i) + radius(k))) cycle
            if (abs(key_partner(i) - key_partner(k)) > outward*(radius_partner(i) + radius_partner(k))) cycle
            meets(i) = .true.
            meets(k) = .true.
         end do
      end do
      apart = count(sound .and. .not. meets)
   end subroutine count_apart

   !> Correct a solution some times and test it. `r` are the radii of the discs.
   subroutine test(d, steps, v, r, holds)
      complex(xp), intent(in) :: d(most_points)
      integer, intent(in) :: steps
      complex(wp), intent(inout) :: v(unknowns)
      real(wp), intent(out) :: r(unknowns)
      logical, intent(out) :: holds
      complex(wp) :: j(unknowns, unknowns), y(unknowns, unknowns), f(unknowns), rest(unknowns)
      real(wp) :: bound(unknowns), size_of_j(unknowns, unknowns), spread(unknowns), b(unknowns)
      real(wp) :: reached(unknowns), of_rest(unknowns)
      integer :: k, l, m

      do k = 0, steps
         call evaluate(d, v, f, bound)
         call matrix_of(d, v, j)
         call invert(j, y, holds)
         if (.not. holds) return
         rest = (0.0_wp, 0.0_wp)
         do l = 1, unknowns
            rest = rest + y(:, l)*f(l)
         end do
         if (k < steps) v = v - rest
      end do
      b = abs(rest)
      do l = 1, unknowns
         b = b + abs(y(:, l))*(bound(l) + rounding*abs(f(l)))
      end do
      r = width*b + least*abs(v)
      call radii_of(d, v, r, size_of_j)
      ! what the discs of the entries do to r, and the rounding of the products
      spread = 0.0_wp
      do l = 1, unknowns
         spread = spread + (size_of_j(:, l) + rounding*abs(j(:, l)))*r(l)
      end do
      of_rest = 0.0_wp
      do l = 1, unknowns
         rest = (0.0_wp, 0.0_wp)
         do m = 1, unknowns
            if (abs(real(j(m, l), wp)) + abs(aimag(j(m, l))) > 0.0_wp) rest = rest + y(:, m)*j(m, l)
         end do
         rest(l) = rest(l) - 1.0_wp
         of_rest = of_rest + abs(rest)*r(l)
      end do
      reached = b + of_rest
      do l = 1, unknowns
         reached = reached + abs(y(:, l))*spread(l)
      end do
      holds = all(outward*reached < r)
   end subroutine test

   !> The equations in extended precision, rounded, and a bound of the error.
   pure subroutine evaluate(d, v, f, bound)
      complex(xp), intent(in) :: d(most_points)
      complex(wp), intent(in) :: v(unknowns)
      complex(wp), intent(out) :: f(unknowns)
      real(wp), intent(out) :: bound(unknowns)
      complex(xp), parameter :: nothing = (0.0_xp, 0.0_xp)
      integer, parameter :: roundings = 80           !! more than meet in a term, its differences and the sum
      complex(xp) :: x, xh, a, ah, u, uh, s, sh, g, gh, dh, terms(6)
      real(xp) :: sizes
      integer :: i

      x = cmplx(v(at_x), kind=xp)
      xh = cmplx(v(at_xh), kind=xp)
      a = cmplx(v(at_a), kind=xp)
      ah = cmplx(v(at_ah), kind=xp)
      u = cmplx(v(at_y), kind=xp)
      uh = cmplx(v(at_yh), kind=xp)
      s = cmplx(v(at_b), kind=xp)
      sh = cmplx(v(at_bh), kind=xp)
      do i = 1, most_points
         g = cmplx(v(variables + i), kind=xp)
         gh = cmplx(v(variables + most_points + i), kind=xp)
         dh = conjg(d(i))
         terms = [(ah - dh)*x*g, (a - d(i))*xh*gh, (ah - xh)*d(i), (a - x)*dh, -d(i)*dh, nothing]
         f(3*i - 2) = cmplx(sum(terms), kind=wp)
         sizes = (abs(ah) + abs(d(i)))*abs(x)*abs(g) + (abs(a) + abs(d(i)))*abs(xh)*abs(gh) + &
                 (abs(ah) + abs(xh) + abs(a) + abs(x) + abs(d(i)))*abs(d(i))
         bound(3*i - 2) = real(sizes, wp)
         terms = [(ah - dh)*u*g, sh*(x + u)*g, (a - d(i))*uh*gh, s*(xh + uh)*gh, (sh - uh)*d(i), (s - u)*dh]
         f(3*i - 1) = cmplx(sum(terms), kind=wp)
         sizes = ((abs(ah) + abs(d(i)))*abs(u) + abs(sh)*(abs(x) + abs(u)))*abs(g) + &
                 ((abs(a) + abs(d(i)))*abs(uh) + abs(s)*(abs(xh) + abs(uh)))*abs(gh) + &
                 (abs(sh) + abs(uh) + abs(s) + abs(u))*abs(d(i))
         bound(3*i - 1) = real(sizes, wp)
         f(3*i) = cmplx(g*gh + g + gh, kind=wp)
         bound(3*i) = real(abs(g)*abs(gh) + abs(g) + abs(gh), wp)
      end do
      bound = outward*(real(roundings, wp)*real(epsilon(1.0_xp), wp)*bound + epsilon(1.0_wp)*abs(f))
   end subroutine evaluate

   !> Derivatives of the equations.
   pure subroutine matrix_of(data, v, j)
      complex(xp), intent(in) :: data(most_points)
      complex(wp), intent(in) :: v(unknowns)
      complex(wp), intent(out) :: j(unknowns, unknowns)
      complex(wp) :: d, dh
      integer :: i, k, at_g, at_gh

      j = (0.0_wp, 0.0_wp)
      associate (x => v(at_x), xh => v(at_xh), a => v(at_a), ah => v(at_ah), u => v(at_y), uh => v(at_yh), s => v(at_b), &
                 sh => v(at_bh))
         do i = 1, most_points
            at_g = variables + i
            at_gh = variables + most_points + i
            k = 3*i - 2
            d = cmplx(data(i), kind=wp)
            dh = conjg(d)
            j(k, at_x) = (ah - dh)*v(at_g) - dh
            j(k, at_xh) = (a - d)*v(at_gh) - d
            j(k, at_a) = xh*v(at_gh) + dh
            j(k, at_ah) = x*v(at_g) + d
            j(k, at_g) = (ah - dh)*x
            j(k, at_gh) = (a - d)*xh
            j(k + 1, at_x) = sh*v(at_g)
            j(k + 1, at_xh) = s*v(at_gh)
            j(k + 1, at_a) = uh*v(at_gh)
            j(k + 1, at_ah) = u*v(at_g)
            j(k + 1, at_y) = (ah + sh - dh)*v(at_g) - dh
            j(k + 1, at_yh) = (a + s - d)*v(at_gh) - d
            j(k + 1, at_b) = (xh + uh)*v(at_gh) + dh
            j(k + 1, at_bh) = (x + u)*v(at_g) + d
            j(k + 1, at_g) = (ah - dh)*u + sh*(x + u)
            j(k + 1, at_gh) = (a - d)*uh + s*(xh + uh)
            j(k + 2, at_g) = v(at_gh) + 1.0_wp
            j(k + 2, at_gh) = v(at_g) + 1.0_wp
         end do
      end associate
   end subroutine matrix_of

   !> Radii of the derivatives over the discs, with the rounding of their centres.
   pure subroutine radii_of(data, v, r, radius)
      complex(xp), intent(in) :: data(most_points)
      complex(wp), intent(in) :: v(unknowns)
      real(wp), intent(in) :: r(unknowns)
      real(wp), intent(out) :: radius(unknowns, unknowns)
      real(wp) :: d, m(unknowns)
      integer :: i, k, at_g, at_gh

      radius = 0.0_wp
      m = abs(v)
      do i = 1, most_points
         at_g = variables + i
         at_gh = variables + most_points + i
         k = 3*i - 2
         d = real(abs(data(i)), wp)*outward
         radius(k, at_x) = times(m(at_ah) + d, r(at_ah), m(at_g), r(at_g)) + rounding*d
         radius(k, at_xh) = times(m(at_a) + d, r(at_a), m(at_gh), r(at_gh)) + rounding*d
         radius(k, at_a) = times(m(at_xh), r(at_xh), m(at_gh), r(at_gh)) + rounding*d
         radius(k, at_ah) = times(m(at_x), r(at_x), m(at_g), r(at_g)) + rounding*d
         radius(k, at_g) = times(m(at_ah) + d, r(at_ah), m(at_x), r(at_x))
         radius(k, at_gh) = times(m(at_a) + d, r(at_a), m(at_xh), r(at_xh))
         radius(k + 1, at_x) = times(m(at_bh), r(at_bh), m(at_g), r(at_g))
         radius(k + 1, at_xh) = times(m(at_b), r(at_b), m(at_gh), r(at_gh))
         radius(k + 1, at_a) = times(m(at_yh), r(at_yh), m(at_gh), r(at_gh))
         radius(k + 1, at_ah) = times(m(at_y), r(at_y), m(at_g), r(at_g))
         radius(k + 1, at_y) = times(m(at_ah) + m(at_bh) + d, r(at_ah) + r(at_bh), m(at_g), r(at_g)) + rounding*d
         radius(k + 1, at_yh) = times(m(at_a) + m(at_b) + d, r(at_a) + r(at_b), m(at_gh), r(at_gh)) + rounding*d
         radius(k + 1, at_b) = times(m(at_xh) + m(at_yh), r(at_xh) + r(at_yh), m(at_gh), r(at_gh)) + rounding*d
         radius(k + 1, at_bh) = times(m(at_x) + m(at_y), r(at_x) + r(at_y), m(at_g), r(at_g)) + rounding*d
         radius(k + 1, at_g) = times(m(at_ah) + d, r(at_ah), m(at_y), r(at_y)) + &
                               times(m(at_bh), r(at_bh), m(at_x) + m(at_y), r(at_x) + r(at_y))
         radius(k + 1, at_gh) = times(m(at_a) + d, r(at_a), m(at_yh), r(at_yh)) + &
                                times(m(at_b), r(at_b), m(at_xh) + m(at_yh), r(at_xh) + r(at_yh))
         radius(k + 2, at_g) = r(at_gh) + rounding
         radius(k + 2, at_gh) = r(at_g) + rounding
      end do
   end subroutine radii_of

   !> Radius of the product of two discs, and of the rounding of its centre.
   elemental real(wp) function times(p, rp, q, rq)
      real(wp), intent(in) :: p, rp, q, rq           !! moduli and radii

      times = p*rq + q*rp + rp*rq + epsilon(1.0_wp)*8.0_wp*p*q
   end function times

   !> Inverse by elimination with partial pivoting, rows scaled.
   pure subroutine invert(matrix, inverse, regular)
      complex(wp), intent(in) :: matrix(unknowns, unknowns)
      complex(wp), intent(out) :: inverse(unknowns, unknowns)
      logical, intent(out) :: regular
      complex(wp) :: m(unknowns, unknowns), row(unknowns), factor
      real(wp) :: size_of(unknowns), column(unknowns)
      integer :: order(unknowns), k, p, i, hold

      ! transposed: rows of the matrix lie together
      m = transpose(matrix)
      do k = 1, unknowns
         column(k) = 1.0_wp/max(maxval(abs(real(m(k, :), wp)) + abs(aimag(m(k, :)))), tiny(1.0_wp))
         m(k, :) = m(k, :)*column(k)
      end do
      do k = 1, unknowns
         size_of(k) = 1.0_wp/max(maxval(abs(real(m(:, k), wp)) + abs(aimag(m(:, k)))), tiny(1.0_wp))
         m(:, k) = m(:, k)*size_of(k)
         order(k) = k
      end do
      ! Gauss and Jordan in place
      do k = 1, unknowns
         p = k - 1 + maxloc(abs(real(m(k, k:), wp)) + abs(aimag(m(k, k:))), dim=1)
         regular = abs(real(m(k, p), wp)) + abs(aimag(m(k, p))) > 0.0_wp
         if (.not. regular) then
            inverse = (0.0_wp, 0.0_wp)
            return
         end if
         row = m(:, p)
         m(:, p) = m(:, k)
         m(:, k) = row
         hold = order(p)
         order(p) = order(k)
         order(k) = hold
         factor = 1.0_wp/m(k, k)
         m(k, k) = (1.0_wp, 0.0_wp)
         m(:, k) = m(:, k)*factor
         do i = 1, unknowns
            if (i == k) cycle
            factor = m(k, i)
            m(k, i) = (0.0_wp, 0.0_wp)
            m(:, i) = m(:, i) - factor*m(:, k)
         end do
      end do
      ! columns go back to where the rows came from
      do k = 1, unknowns
         inverse(:, order(k)) = m(k, :)
      end do
      do k = 1, unknowns
         inverse(k, :) = inverse(k, :)*column(k)
      end do
      do k = 1, unknowns
         inverse(:, k) = inverse(:, k)*size_of(k)
      end do
   end subroutine invert
end module psalm_certificate
