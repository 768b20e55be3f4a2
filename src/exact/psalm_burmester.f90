!> Bodies guided through poses by an RR dyad: a link from a fixed pivot to a pin of the body.
!>
!> Points are complex numbers; a pose is that of the moving body against its first one: displacement d of the reference point and
!> g = exp(i angle) - 1. A dyad is its fixed pivot a and its pin x, both from the reference point in the first pose; it is good
!> for a pose when  2 Re((conj(a) - conj(d)) x g) + 2 Re(conj(d) (a - x)) = |d|**2. With u = conj(a) x that is linear, and
!> u = conj(a) x are two conics in what is left free. Source: Burmester (1888); Bottema and Roth (1979), chapter 8.
!>
!> A condition is that equation or a derivative of it while the body moves (multiply separated poses: Tesar (1968)): its numbers
!> g, k = conj(d) (1 + g), d and |d|**2, or their derivatives, in  Re(conj(a) x g - k x + conj(d) a) = |d|**2/2.
module psalm_burmester
   use psalm_kinds, only: wp, pi
   implicit none (type, external)
   private
   public :: pin_pair_t, dyads_t, curve_point_t, dyad_condition_t, of_poses, derivative_of, five_conditions, five_poses, &
             four_poses_curve, centres_on_line, pin_for_pivot, slider_pin, slider_circle, guide_of, inverted, polynomial_roots
   public :: dyad_turns, dyad_slides, dyad_swings

   integer, parameter :: dyad_turns = 1              !! a link from a fixed pivot to a pin of the body
   integer, parameter :: dyad_slides = 2             !! a pin of the body moves along a fixed line
   integer, parameter :: dyad_swings = 3             !! a line of the body goes through a fixed pivot

   integer, parameter :: unknowns = 7                !! u, x, a and the homogenising one, as real numbers
   integer, parameter :: most_dyads = 4
   integer, parameter :: most_turns = 100            !! iterations of the roots of a polynomial
   real(wp), parameter :: dependent = 1.0e4_wp*epsilon(1.0_wp) !! pivot of a dependent row over the largest one
   real(wp), parameter :: at_infinity = 1.0e-9_wp    !! homogenising coordinate over the largest one
   real(wp), parameter :: real_part_only = 1.0e-7_wp !! imaginary part over the modulus of a root that is polished as a real one
   real(wp), parameter :: same = 1.0e-9_wp           !! distance of two dyads that are one, over their size

   !> A dyad that is good for some poses.
   type :: pin_pair_t
      complex(wp) :: pivot = (0.0_wp, 0.0_wp)        !! fixed, from the reference point in the first pose
      complex(wp) :: pin = (0.0_wp, 0.0_wp)          !! on the body, from the reference point in the first pose
      integer :: kind = dyad_turns                   !! one of `dyad_...`
      complex(wp) :: guide = (1.0_wp, 0.0_wp)        !! direction of the line, of modulus 1; of the body's in the first pose
   end type pin_pair_t

   !> What a pose, or a motion at one, asks of a dyad.
   type :: dyad_condition_t
      complex(wp) :: g = (0.0_wp, 0.0_wp), k = (0.0_wp, 0.0_wp), d = (0.0_wp, 0.0_wp)
      real(wp) :: square = 0.0_wp                    !! |d|**2
      complex(wp) :: rest = (0.0_wp, 0.0_wp)         !! k - conj(d) g, of a pose conj(d): exactly, where the difference is rounded
      logical :: is_pose = .true.                    !! its numbers follow from d and g, no derivative
   end type dyad_condition_t

   !> All dyads for five poses.
   type :: dyads_t
      integer :: count = 0                           !! real ones
      type(pin_pair_t) :: list(most_dyads)
      integer :: infinite = 0                        !! real ones with pivot or pin at infinity
      integer :: sliding = 0                         !! of these those that are a line: a pin on one or a pivot on one of the body
      type(pin_pair_t) :: lines(most_dyads)
      integer :: imaginary = 0                       !! those that are not real
      logical :: degenerate = .false.                !! the poses leave more than finitely many
      real(wp) :: residual = 0.0_wp                  !! largest of the equations, over the square of the size
      complex(wp) :: ends(4, most_dyads) = (0.0_wp, 0.0_wp) !! pin, pivot and their partners (x, xh, a, ah), the real ones first,
                                                     !! then those that are not
   end type dyads_t

   !> A point of the curves of four poses.
   type :: curve_point_t
      type(pin_pair_t) :: dyad
      logical :: exists = .false.
   end type curve_point_t

contains

   !> Conditions of poses.
   elemental type(dyad_condition_t) function of_poses(d, g) result(condition)
      complex(wp), intent(in) :: d, g

      condition = dyad_condition_t(g, conjg(d)*(1.0_wp + g), d, abs(d)**2, conjg(d))
   end function of_poses

   !> Condition of a motion at a pose: the first derivative, or with `second` the second, by what drives it.
   pure type(dyad_condition_t) function derivative_of(d, g, second) result(condition)
      complex(wp), intent(in) :: d(0:), g(0:)        !! shape (0:1) or (0:2): the pose and its derivatives
      logical, intent(in) :: second

      if (second) then
         condition%g = g(2)
         condition%d = d(2)
         condition%k = conjg(d(2))*(1.0_wp + g(0)) + 2.0_wp*conjg(d(1))*g(1) + conjg(d(0))*g(2)
         condition%square = 2.0_wp*(abs(d(1))**2 + real(conjg(d(0))*d(2), wp))
      else
         condition%g = g(1)
         condition%d = d(1)
         condition%k = conjg(d(1))*(1.0_wp + g(0)) + conjg(d(0))*g(1)
         condition%square = 2.0_wp*real(conjg(d(0))*d(1), wp)
      end if
      condition%rest = condition%k - conjg(condition%d)*condition%g
      condition%is_pose = .false.
   end function derivative_of

   !> The same with lengths over a size.
   elemental type(dyad_condition_t) function over(given, size) result(condition)
      type(dyad_condition_t), intent(in) :: given
      real(wp), intent(in) :: size

      if (given%is_pose) then
         condition = of_poses(given%d/size, given%g)
      else
         condition = dyad_condition_t(given%g, given%k/size, given%d/size, given%square/size**2, given%rest/size, .false.)
      end if
   end function over

   !> All dyads for five poses, the first of which is (0, 0). At most four.
   pure subroutine five_poses(d, g, dyads)
      complex(wp), intent(in) :: d(4), g(4)
      type(dyads_t), intent(out) :: dyads

      call five_conditions(of_poses(d, g), dyads)
   end subroutine five_poses

   !> All dyads for four conditions beyond the first pose. At most four.
   pure subroutine five_conditions(given, dyads)
      type(dyad_condition_t), intent(in) :: given(4)
      type(dyads_t), intent(out) :: dyads
      ! a fixed rotation, so that no solution lies at infinity of the chart but by chance
      real(wp), parameter :: c1 = 0.6_wp, s1 = 0.8_wp, c2 = 5.0_wp/13.0_wp, s2 = 12.0_wp/13.0_wp
      integer, parameter :: most_infinite = 2        ! a line, here that at infinity, meets a conic twice, or is a part of it
      real(wp) :: basis(unknowns, 3), turned(unknowns, 3), conic(6, 2), size, along(3), h
      complex(wp) :: p(4), q(4), quartic(0:4), imaginary(4, most_dyads)
      type(dyad_condition_t) :: scaled(4)
      type(pin_pair_t) :: dyad
      integer :: i, k
      logical :: full, infinite(4)

      size = maxval(abs(given%d))
      if (.not. size > 0.0_wp) then
         ! the body turns about its reference point: any pose scale will do
         size = 1.0_wp
      end if
      scaled = over(given, size)
      call null_space(scaled, basis, full)
      if (.not. full) then
         dyads%degenerate = .true.
         return
      end if
      turned(:, 1) = c1*basis(:, 1) + s1*basis(:, 2)
      turned(:, 2) = -s1*c2*basis(:, 1) + c1*c2*basis(:, 2) + s2*basis(:, 3)
      turned(:, 3) = s1*s2*basis(:, 1) - c1*s2*basis(:, 2) + c2*basis(:, 3)
      call conics(turned, conic)
      call intersect(conic, quartic, p, q, full)
      if (.not. full) then
         dyads%degenerate = .true.
         return
      end if
      do i = 1, most_dyads
         call polish_on_conics(conic, p(i), q(i))
         infinite(i) = is_infinite([p(i), q(i), (1.0_wp, 0.0_wp)])
      end do
      ! each point of a circle of the body moves along a line (a trammel), or lines of the body pass the points of a fixed circle
      dyads%degenerate = count(infinite) > most_infinite
      if (dyads%degenerate) return
      do i = 1, most_dyads
         if (abs(aimag(p(i))) > real_part_only*(1.0_wp + abs(p(i))) .or. &
             abs(aimag(q(i))) > real_part_only*(1.0_wp + abs(q(i)))) then
            dyads%imaginary = dyads%imaginary + 1
            imaginary(:, dyads%imaginary) = size*imaginary_dyad(turned, p(i), q(i))
            cycle
         end if
         along = [real(p(i), wp), real(q(i), wp), 1.0_wp]
         h = sum(turned(7, :)*along)
         if (is_infinite(cmplx(along, 0.0_wp, wp))) then
            dyads%infinite = dyads%infinite + 1
            call add_line(turned, along, size, dyads)
            cycle
         end if
         dyad%pin = cmplx(sum(turned(3, :)*along), sum(turned(4, :)*along), wp)/h
         dyad%pivot = cmplx(sum(turned(5, :)*along), sum(turned(6, :)*along), wp)/h
         call polish_dyad(scaled, dyad)
         dyads%residual = max(dyads%residual, worst_residual(scaled, dyad))
         do k = 1, dyads%count
            if (abs(dyad%pin*size - dyads%list(k)%pin) + abs(dyad%pivot*size - dyads%list(k)%pivot) < &
                same*size*(abs(dyad%pin) + abs(dyad%pivot))) exit
         end do
         if (k <= dyads%count) cycle
         dyads%count = dyads%count + 1
         dyads%list(dyads%count) = pin_pair_t(pivot=dyad%pivot*size, pin=dyad%pin*size)
         associate (own => dyads%list(dyads%count))
            dyads%ends(:, dyads%count) = [own%pin, conjg(own%pin), own%pivot, conjg(own%pivot)]
         end associate
      end do
      dyads%ends(:, dyads%count + 1:dyads%count + dyads%imaginary) = imaginary(:, :dyads%imaginary)

   contains

      !> The homogenising number of a common point of the conics vanishes.
      pure logical function is_infinite(along)
         complex(wp), intent(in) :: along(3)

         is_infinite = abs(sum(turned(7, :)*along)) <= &
                       at_infinity*maxval(abs(turned(1, :)*along(1)) + abs(turned(2, :)*along(2)) + abs(along))
      end function is_infinite
   end subroutine five_conditions

   !> Add what a dyad is whose homogenising number vanishes, and with it pin or pivot: conj(a) x = 0.
   pure subroutine add_line(basis, along, size, dyads)
      real(wp), intent(in) :: basis(unknowns, 3), along(3)
      real(wp), intent(in) :: size                   !! length by which the poses were divided
      type(dyads_t), intent(inout) :: dyads
      real(wp) :: v(unknowns)
      complex(wp) :: u, x, a
      type(pin_pair_t) :: line

      v = along(1)*basis(:, 1) + along(2)*basis(:, 2) + along(3)*basis(:, 3)
      u = cmplx(v(1), v(2), wp)
      x = cmplx(v(3), v(4), wp)
      a = cmplx(v(5), v(6), wp)
      if (max(abs(x), abs(a)) <= at_infinity*maxval(abs(v))) return
      if (abs(a) > abs(x)) then
         line%kind = dyad_slides
         line%pin = size*u/conjg(a)
         line%guide = (0.0_wp, 1.0_wp)*a/abs(a)
      else
         line%kind = dyad_swings
         line%pivot = size*conjg(u/x)
         line%guide = (0.0_wp, 1.0_wp)*x/abs(x)
      end if
      dyads%sliding = dyads%sliding + 1
      dyads%lines(dyads%sliding) = line
   end subroutine add_line

   !> Pin, pivot and their partners of a common point of the conics that is not real.
   pure function imaginary_dyad(basis, p, q) result(legs)
      real(wp), intent(in) :: basis(unknowns, 3)
      complex(wp), intent(in) :: p, q
      complex(wp) :: legs(4), v(unknowns)

      v = p*basis(:, 1) + q*basis(:, 2) + basis(:, 3)
      legs = [v(3) + (0.0_wp, 1.0_wp)*v(4), v(3) - (0.0_wp, 1.0_wp)*v(4), v(5) + (0.0_wp, 1.0_wp)*v(6), &
              v(5) - (0.0_wp, 1.0_wp)*v(6)]/v(7)
   end function imaginary_dyad

   !> The vectors (u, x, a, h) that are good for all poses: the last columns of Q of the transposed equations, by Householder's
   !> reflections with column pivoting. `full` false: the equations depend on each other.
   pure subroutine null_space(given, basis, full)
      type(dyad_condition_t), intent(in) :: given(:)      !! shape (n): displacements about 1
      real(wp), intent(out) :: basis(:, :)            !! shape (7, 7 - n)
      logical, intent(out) :: full
      real(wp) :: m(unknowns, size(given)), column(unknowns), tau(size(given)), norm, s, largest
      integer :: n, i, j, p

      n = size(given)
      do i = 1, n
         associate (g => given(i)%g, k => given(i)%k, d => given(i)%d)
            m(:, i) = [2.0_wp*real(g, wp), -2.0_wp*aimag(g), -2.0_wp*real(k, wp), 2.0_wp*aimag(k), &
                       2.0_wp*real(d, wp), 2.0_wp*aimag(d), -given(i)%square]
         end associate
         norm = sqrt(sum(m(:, i)**2))
         if (norm > 0.0_wp) m(:, i) = m(:, i)/norm
      end do
      full = .true.
      largest = 0.0_wp
      basis = 0.0_wp
      do j = 1, n
         p = j
         do i = j + 1, n
            if (sum(m(j:, i)**2) > sum(m(j:, p)**2)) p = i
         end do
         column = m(:, j)
         m(:, j) = m(:, p)
         m(:, p) = column
         norm = sqrt(sum(m(j:, j)**2))
         largest = max(largest, norm)
         full = norm > dependent*largest
         if (.not. full) return
         norm = sign(norm, m(j, j))
         m(j, j) = m(j, j) + norm
         tau(j) = 1.0_wp/(norm*m(j, j))
         do i = j + 1, n
            s = sum(m(j:, j)*m(j:, i))*tau(j)
            m(j:, i) = m(j:, i) - s*m(j:, j)
         end do
      end do
      do i = 1, unknowns - n
         basis(n + i, i) = 1.0_wp
         do j = n, 1, -1
            s = sum(m(j:, j)*basis(j:, i))*tau(j)
            basis(j:, i) = basis(j:, i) - s*m(j:, j)
         end do
      end do
   end subroutine null_space

   !> Real and imaginary part of u h - conj(a) x on the vectors p n1 + q n2 + n3: coefficients of p**2, p q, q**2, p, q, 1.
   pure subroutine conics(n, conic)
      real(wp), intent(in) :: n(unknowns, 3)
      real(wp), intent(out) :: conic(6, 2)
      integer, parameter :: first(6) = [1, 1, 2, 1, 2, 3], second(6) = [1, 2, 2, 3, 3, 3]
      complex(wp) :: u(3), x(3), a(3), value
      real(wp) :: h(3)
      integer :: k

      u = cmplx(n(1, :), n(2, :), wp)
      x = cmplx(n(3, :), n(4, :), wp)
      a = cmplx(n(5, :), n(6, :), wp)
      h = n(7, :)
      do k = 1, 6
         associate (i => first(k), j => second(k))
            value = u(i)*h(j) - conjg(a(i))*x(j)
            if (i /= j) value = value + u(j)*h(i) - conjg(a(j))*x(i)
         end associate
         conic(k, 1) = real(value, wp)
         conic(k, 2) = aimag(value)
      end do
      do k = 1, 2
         conic(:, k) = conic(:, k)/max(maxval(abs(conic(:, k))), tiny(1.0_wp))
      end do
   end subroutine conics

   !> The four common points of two conics, by the resultant in q. `full` false: they share a component.
   pure subroutine intersect(conic, quartic, p, q, full)
      real(wp), intent(in) :: conic(6, 2)
      complex(wp), intent(out) :: quartic(0:4), p(4), q(4)
      logical, intent(out) :: full
      real(wp) :: cross02(0:2), cross01(0:1), cross12(0:3), a1(0:1), b1(0:1), a2(0:2), b2(0:2), r(0:4)
      complex(wp) :: lower, upper
      integer :: i, j

      associate (a0 => conic(3, 1), b0 => conic(3, 2))
         a1 = [conic(5, 1), conic(2, 1)]
         b1 = [conic(5, 2), conic(2, 2)]
         a2 = [conic(6, 1), conic(4, 1), conic(1, 1)]
         b2 = [conic(6, 2), conic(4, 2), conic(1, 2)]
         cross02 = a0*b2 - a2*b0
         cross01 = a0*b1 - a1*b0
         cross12 = 0.0_wp
         do i = 0, 1
            do j = 0, 2
               cross12(i + j) = cross12(i + j) + a1(i)*b2(j) - b1(i)*a2(j)
            end do
         end do
      end associate
      r = 0.0_wp
      do i = 0, 2
         do j = 0, 2
            r(i + j) = r(i + j) + cross02(i)*cross02(j)
         end do
      end do
      do i = 0, 1
         do j = 0, 3
            r(i + j) = r(i + j) - cross01(i)*cross12(j)
         end do
      end do
      full = maxval(abs(r)) > dependent**2 .and. abs(r(4)) > 0.0_wp
      p = (0.0_wp, 0.0_wp)
      q = p
      quartic = cmplx(r, 0.0_wp, wp)
      if (.not. full) return
      call polynomial_roots(quartic, p)
      do i = 1, 4
         upper = cross02(0) + p(i)*(cross02(1) + p(i)*cross02(2))
         lower = cross01(0) + p(i)*cross01(1)
         if (abs(lower) > 0.0_wp) q(i) = -upper/lower
      end do
   end subroutine intersect

   !> All roots of a polynomial by the method of Aberth and Ehrlich. The leading coefficient must not be zero.
   pure subroutine polynomial_roots(c, roots)
      complex(wp), intent(in) :: c(0:)               !! shape (0:n), by rising powers
      complex(wp), intent(out) :: roots(:)           !! shape (n)
      complex(wp) :: value, slope, step, repulsion
      real(wp) :: radius, bound, turn
      logical :: settled(size(roots))
      integer :: n, i, j, k

      n = size(roots)
      ! a circle of the mean modulus
      radius = 1.0_wp
      if (abs(c(0)) > 0.0_wp) radius = (abs(c(0))/abs(c(n)))**(1.0_wp/real(n, wp))
      do i = 1, n
         turn = 2.0_wp*pi*real(i - 1, wp)/real(n, wp) + 0.4_wp
         roots(i) = radius*cmplx(cos(turn), sin(turn), wp)
      end do
      settled = .false.
      do k = 1, most_turns
         do i = 1, n
            if (settled(i)) cycle
            value = c(n)
            slope = (0.0_wp, 0.0_wp)
            bound = abs(c(n))
            do j = n - 1, 0, -1
               slope = slope*roots(i) + value
               value = value*roots(i) + c(j)
               bound = bound*abs(roots(i)) + abs(c(j))
            end do
            settled(i) = abs(value) <= epsilon(1.0_wp)*bound
            if (settled(i)) cycle
            repulsion = (0.0_wp, 0.0_wp)
            do j = 1, n
               if (j /= i .and. abs(roots(i) - roots(j)) > 0.0_wp) repulsion = repulsion + 1.0_wp/(roots(i) - roots(j))
            end do
            step = slope - value*repulsion
            if (abs(step) > 0.0_wp) roots(i) = roots(i) - value/step
         end do
         if (all(settled)) exit
      end do
   end subroutine polynomial_roots

   !> Newton's method on both conics.
   pure subroutine polish_on_conics(conic, p, q)
      real(wp), intent(in) :: conic(6, 2)
      complex(wp), intent(inout) :: p, q
      integer, parameter :: steps = 3
      complex(wp) :: f(2), by_p(2), by_q(2), determinant
      integer :: k

      do k = 1, steps
         f = conic(1, :)*p**2 + conic(2, :)*p*q + conic(3, :)*q**2 + conic(4, :)*p + conic(5, :)*q + conic(6, :)
         by_p = 2.0_wp*conic(1, :)*p + conic(2, :)*q + conic(4, :)
         by_q = conic(2, :)*p + 2.0_wp*conic(3, :)*q + conic(5, :)
         determinant = by_p(1)*by_q(2) - by_p(2)*by_q(1)
         if (.not. abs(determinant) > 0.0_wp) return
         p = p - (f(1)*by_q(2) - f(2)*by_q(1))/determinant
         q = q - (by_p(1)*f(2) - by_p(2)*f(1))/determinant
      end do
   end subroutine polish_on_conics

   !> The four equations in (x, a) and, asked for, their matrix.
   pure subroutine dyad_equations(given, dyad, f, jacobian)
      type(dyad_condition_t), intent(in) :: given(:)
      type(pin_pair_t), intent(in) :: dyad
      real(wp), intent(out) :: f(:)                  !! shape (n)
      real(wp), intent(out), optional :: jacobian(:, :) !! shape (n, 4): by x and by a
      complex(wp) :: by_x, by_a
      integer :: j

      do j = 1, size(given)
         associate (g => given(j)%g, d => given(j)%d)
            by_x = conjg(dyad%pivot - d)*g - given(j)%rest
            by_a = conjg(dyad%pin*g + d)
            f(j) = 2.0_wp*real(by_x*dyad%pin + conjg(d)*dyad%pivot, wp) - given(j)%square
            if (present(jacobian)) jacobian(j, :) = 2.0_wp*[real(by_x, wp), -aimag(by_x), real(by_a, wp), -aimag(by_a)]
         end associate
      end do
   end subroutine dyad_equations

   !> Newton's method on the four equations.
   pure subroutine polish_dyad(given, dyad)
      type(dyad_condition_t), intent(in) :: given(4)
      type(pin_pair_t), intent(inout) :: dyad
      integer, parameter :: steps = 2
      real(wp) :: f(4), m(4, 5), row(5)
      integer :: k, i, p

      do k = 1, steps
         call dyad_equations(given, dyad, f, m(:, :4))
         m(:, 5) = f
         do i = 1, 4
            p = i - 1 + maxloc(abs(m(i:, i)), dim=1)
            row = m(p, :)
            m(p, :) = m(i, :)
            m(i, :) = row
            if (.not. abs(m(i, i)) > 0.0_wp) return
            m(i, :) = m(i, :)/m(i, i)
            do p = 1, 4
               if (p /= i) m(p, :) = m(p, :) - m(p, i)*m(i, :)
            end do
         end do
         dyad%pin = dyad%pin - cmplx(m(1, 5), m(2, 5), wp)
         dyad%pivot = dyad%pivot - cmplx(m(3, 5), m(4, 5), wp)
      end do
   end subroutine polish_dyad

   !> Largest of the equations over the sizes that meet in them.
   pure real(wp) function worst_residual(given, dyad)
      type(dyad_condition_t), intent(in) :: given(4)
      type(pin_pair_t), intent(in) :: dyad
      real(wp) :: f(4)

      call dyad_equations(given, dyad, f)
      worst_residual = maxval(abs(f))/(1.0_wp + abs(dyad%pin) + abs(dyad%pivot))**2
   end function worst_residual

   ! ---- four and three poses ------------------------------------------------------------------------------------------

   !> The points of the curves of four poses on a ray through the pole of the first two: centre point and circle point, on two
   !> branches. The centre points are zeros of a cubic that is known to vanish at the pole. Without a pole (the body does not
   !> turn between two poses) the points do not exist.
   pure subroutine four_poses_curve(d, g, direction, points)
      complex(wp), intent(in) :: d(3), g(3)
      complex(wp), intent(in) :: direction           !! of the ray, of modulus 1
      type(curve_point_t), intent(out) :: points(2)
      complex(wp) :: pole
      real(wp) :: cubic(0:3), c(3), root, half, r(2)
      integer :: j, k

      j = maxloc(abs(g), dim=1)
      if (.not. abs(g(j)) > 0.0_wp) return
      pole = -d(j)/g(j)
      call centre_cubic(of_poses(d, g), pole, direction, cubic)
      c = cubic(1:)
      half = 0.5_wp*c(2)
      root = half**2 - c(1)*c(3)
      if (root < 0.0_wp) return
      root = sign(sqrt(root), half)
      if (.not. abs(half + root) > 0.0_wp) return
      r = 0.0_wp
      r(1) = -c(1)/(half + root)
      points(1)%exists = .true.
      if (abs(c(3)) > 0.0_wp) then
         r(2) = -(half + root)/c(3)
         points(2)%exists = .true.
      end if
      if (half < 0.0_wp) then
         ! a branch is that of one sign of the root: it goes on from ray to ray
         r = r([2, 1])
         points%exists = points([2, 1])%exists
      end if
      do k = 1, 2
         if (.not. points(k)%exists) cycle
         points(k)%dyad%pivot = pole + r(k)*direction
         call pin_for_pivot(d, g, points(k)%dyad, points(k)%exists)
      end do
   end subroutine four_poses_curve

   !> The cubic whose real zeros are the places, along a line, of the centre points of four poses.
   pure subroutine centre_cubic(given, base_point, direction, cubic)
      type(dyad_condition_t), intent(in) :: given(3)
      complex(wp), intent(in) :: base_point, direction !! of the line
      real(wp), intent(out) :: cubic(0:3)            !! by rising powers
      complex(wp) :: base(3, 3), along(3, 3), determinant(0:3)
      integer :: j, k

      do j = 1, 3
         base(j, 1) = given(j)%g*conjg(base_point) - given(j)%k
         base(j, 2) = conjg(base(j, 1))
         base(j, 3) = 2.0_wp*real(conjg(given(j)%d)*base_point, wp) - given(j)%square
         along(j, 1) = given(j)%g*conjg(direction)
         along(j, 2) = conjg(along(j, 1))
         along(j, 3) = 2.0_wp*real(conjg(given(j)%d)*direction, wp)
      end do
      cubic = 0.0_wp
      do k = 1, 3
         call three_linear(base(:, 1), along(:, 1), base(:, 2), along(:, 2), base(:, 3), along(:, 3), k, determinant)
         ! columns 1 and 2 are conjugate: the determinant is purely imaginary
         cubic = cubic + aimag(determinant)
      end do
   end subroutine centre_cubic

   !> Dyads for four poses whose fixed pivot lies on a line, at most three; `degenerate`: the whole line is good.
   pure subroutine centres_on_line(given, base_point, direction, dyads)
      type(dyad_condition_t), intent(in) :: given(3)
      complex(wp), intent(in) :: base_point, direction !! of the line
      type(dyads_t), intent(out) :: dyads
      real(wp) :: cubic(0:3), place
      complex(wp) :: roots(3)
      type(pin_pair_t) :: dyad
      integer :: degree, k
      logical :: exists

      call centre_cubic(given, base_point, direction, cubic)
      degree = 3
      do while (degree > 0)
         if (abs(cubic(degree)) > dependent*maxval(abs(cubic))) exit
         degree = degree - 1
         dyads%infinite = dyads%infinite + 1
      end do
      dyads%degenerate = degree == 0 .and. .not. abs(cubic(0)) > 0.0_wp
      if (degree == 0) return
      call polynomial_roots(cmplx(cubic(:degree), 0.0_wp, wp), roots(:degree))
      do k = 1, degree
         if (abs(aimag(roots(k))) > real_part_only*(1.0_wp + abs(roots(k)))) then
            dyads%imaginary = dyads%imaginary + 1
            cycle
         end if
         place = real(roots(k), wp)
         dyad%pivot = base_point + place*direction
         call pin_for_conditions(given, dyad, exists)
         if (.not. exists) cycle
         dyads%count = dyads%count + 1
         dyads%list(dyads%count) = dyad
      end do
   end subroutine centres_on_line

   !> The part of a determinant of linear polynomials that has its entry of the third column in row k.
   pure subroutine three_linear(a, da, b, db, c, dc, k, polynomial)
      complex(wp), intent(in) :: a(3), da(3), b(3), db(3), c(3), dc(3) !! columns: values at 0 and slopes
      integer, intent(in) :: k
      complex(wp), intent(out) :: polynomial(0:3)
      complex(wp) :: minor(0:2)
      integer :: i, j

      i = 1 + modulo(k, 3)
      j = 1 + modulo(k + 1, 3)
      minor(0) = a(i)*b(j) - a(j)*b(i)
      minor(1) = a(i)*db(j) + da(i)*b(j) - a(j)*db(i) - da(j)*b(i)
      minor(2) = da(i)*db(j) - da(j)*db(i)
      polynomial(0) = c(k)*minor(0)
      polynomial(1) = c(k)*minor(1) + dc(k)*minor(0)
      polynomial(2) = c(k)*minor(2) + dc(k)*minor(1)
      polynomial(3) = dc(k)*minor(2)
   end subroutine three_linear

   !> The pin that moves on a circle about a given pivot: of two poses beyond the first exactly, of three in the sense of least
   !> squares. It does not exist where the equations depend on each other.
   pure subroutine pin_for_pivot(d, g, dyad, exists)
      complex(wp), intent(in) :: d(:), g(:)
      type(pin_pair_t), intent(inout) :: dyad
      logical, intent(out) :: exists

      call pin_for_conditions(of_poses(d, g), dyad, exists)
   end subroutine pin_for_pivot

   !> The same of any conditions.
   pure subroutine pin_for_conditions(given, dyad, exists)
      type(dyad_condition_t), intent(in) :: given(:)
      type(pin_pair_t), intent(inout) :: dyad
      logical, intent(out) :: exists
      complex(wp) :: k
      real(wp) :: rows(size(given), 2), right(size(given))
      integer :: j

      do j = 1, size(given)
         k = conjg(dyad%pivot)*given(j)%g - given(j)%k
         rows(j, :) = [real(k, wp), -aimag(k)]
         right(j) = 0.5_wp*given(j)%square - real(conjg(given(j)%d)*dyad%pivot, wp)
      end do
      call two_unknowns(rows, right, dyad%pin, exists)
   end subroutine pin_for_conditions

   !> Two real unknowns as one complex number, by orthogonal columns.
   pure subroutine two_unknowns(rows, right, z, exists)
      real(wp), intent(in) :: rows(:, :), right(:)   !! shapes (n, 2), (n)
      complex(wp), intent(out) :: z
      logical, intent(out) :: exists
      real(wp) :: q1(size(right)), q2(size(right)), n1, n2, mix, y

      z = (0.0_wp, 0.0_wp)
      n1 = sqrt(sum(rows(:, 1)**2))
      exists = n1 > 0.0_wp
      if (.not. exists) return
      q1 = rows(:, 1)/n1
      mix = sum(q1*rows(:, 2))
      q2 = rows(:, 2) - mix*q1
      n2 = sqrt(sum(q2**2))
      exists = n2 > dependent*(n1 + abs(mix))
      if (.not. exists) return
      q2 = q2/n2
      y = sum(q2*right)/n2
      z = cmplx((sum(q1*right) - mix*y)/n1, y, wp)
   end subroutine two_unknowns

   !> The circle of the points of the body that are on a straight line in three poses, one of them the first:
   !> level |x|**2 + 2 Re(conj(centre) x) + offset = 0. It goes through the pole of the first two.
   pure subroutine slider_circle(d, g, level, centre, offset)
      complex(wp), intent(in) :: d(2), g(2)
      real(wp), intent(out) :: level, offset
      complex(wp), intent(out) :: centre

      ! Im(conj(d1 + x g1) (d2 + x g2))
      level = aimag(conjg(g(1))*g(2))
      centre = 0.5_wp*conjg((0.0_wp, -1.0_wp)*(conjg(d(1))*g(2) - conjg(d(2))*g(1)))
      offset = aimag(conjg(d(1))*d(2))
   end subroutine slider_circle

   !> The one point of the body that is on a straight line in four poses: the circles of points that are so in two triples of
   !> them meet in the pole of the poses they share and in this point. Source: Bottema and Roth (1979), chapter 8.
   pure subroutine slider_pin(d, g, pin, exists)
      complex(wp), intent(in) :: d(3), g(3)
      complex(wp), intent(out) :: pin
      logical, intent(out) :: exists
      complex(wp) :: pole, centre(2), line
      real(wp) :: level(2), offset(2)
      integer :: k, shared

      pin = (0.0_wp, 0.0_wp)
      ! other poses may have the orientation of the first one
      shared = maxloc(abs(g), dim=1)
      exists = abs(g(shared)) > 0.0_wp
      if (.not. exists) return
      do k = 1, 2
         associate (own => 1 + modulo(shared + k - 1, 3))
            call slider_circle(d([shared, own]), g([shared, own]), level(k), centre(k), offset(k))
         end associate
      end do
      ! the radical line holds the pole, and its other point is wanted
      pole = -d(shared)/g(shared)
      line = level(2)*centre(1) - level(1)*centre(2)
      exists = abs(line) > dependent*(abs(level(2)*centre(1)) + abs(level(1)*centre(2)))
      if (.not. exists) return
      line = line*(0.0_wp, 1.0_wp)/abs(line)
      k = maxloc(abs(level), dim=1)
      exists = abs(level(k)) > 0.0_wp
      if (.not. exists) return
      pin = pole - 2.0_wp*real(conjg(line)*(pole + centre(k)/level(k)), wp)*line
   end subroutine slider_pin

   !> Direction of the line on which a point of the body is in all poses, as far as that can be found from the poses farthest apart.
   pure complex(wp) function guide_of(d, g, pin) result(guide)
      complex(wp), intent(in) :: d(:), g(:)
      complex(wp), intent(in) :: pin
      complex(wp) :: along(size(d))
      integer :: k

      along = d + g*pin
      k = maxloc(abs(along), dim=1)
      guide = (1.0_wp, 0.0_wp)
      if (abs(along(k)) > 0.0_wp) guide = along(k)/abs(along(k))
   end function guide_of

   !> The fixed plane seen from the body: a pivot on a line of the body is a pin on a line of these poses.
   pure subroutine inverted(d, g, inverse_d, inverse_g)
      complex(wp), intent(in) :: d(:), g(:)
      complex(wp), intent(out) :: inverse_d(:), inverse_g(:)

      inverse_g = 1.0_wp/(1.0_wp + g) - 1.0_wp
      inverse_d = -d/(1.0_wp + g)
   end subroutine inverted
end module psalm_burmester
