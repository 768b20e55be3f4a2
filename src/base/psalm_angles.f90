!> Angles in degrees and unit vectors.
!>
!> Kept in a file of its own: a compiler that sees sine or cosine inside a loop over an array may replace it by a vector
!> version whose last digit depends on the place in the array.
module psalm_angles
   use psalm_elementary, only: sine_cosine, sines_cosines, refined_direction, digits_of_pair
   use psalm_kinds, only: wp, dp, degrees_per_radian, full_turn, radians_per_degree, right_angle
   use psalm_lanes, only: lanes
   use psalm_quad, only: qp, unit_vector_quad
   implicit none (type, external)
   private
   public :: unit_vector, degrees_of, arc_sine, within_turn, nearest_difference, angles_between, angles_between_lanes, angles_of, &
             unit_vectors, exact_unit_vectors

   !> atan(t)/t as a polynomial in t**2, for abs(t) <= tan(pi/8): Chebyshev fit, relative error 1.3e-18.
   real(wp), parameter :: arc_tangent(0:11) = [ &
      0.99999999999999999874_wp, -0.33333333333333121163_wp, 0.19999999999940891462_wp, -0.14285714279250244942_wp, &
      0.11111110744919658237_wp, -0.090908968090640270761_wp, 0.076920453309022249521_wp, -0.066629518136291900881_wp, &
      0.058468782973308725201_wp, -0.050351024566015518428_wp, 0.037965257453865936236_wp, -0.017805397205419445228_wp]
   ! Taylor series of sin(r)/r and cos(r) in r**2, for abs(r) <= pi/4: relative error 5e-17
   real(wp), parameter :: sine_terms(0:7) = [ &
      1.0_wp, -1.0_wp/6.0_wp, 1.0_wp/120.0_wp, -1.0_wp/5040.0_wp, 1.0_wp/362880.0_wp, -1.0_wp/39916800.0_wp, &
      1.0_wp/6227020800.0_wp, -1.0_wp/1307674368000.0_wp]
   real(wp), parameter :: cosine_terms(0:8) = [ &
      1.0_wp, -1.0_wp/2.0_wp, 1.0_wp/24.0_wp, -1.0_wp/720.0_wp, 1.0_wp/40320.0_wp, -1.0_wp/3628800.0_wp, &
      1.0_wp/479001600.0_wp, -1.0_wp/87178291200.0_wp, 1.0_wp/20922789888000.0_wp]
   integer, parameter :: digits_of_fit = 17 !! decimal digits the polynomial is good for
   integer, parameter :: strip = 128        !! angles or positions at a time
   logical, parameter :: by_library = precision(1.0_wp) > digits_of_pair !! real128, the yardstick: the library's functions

contains

   !> Cosine and sine of an angle in degrees, correctly rounded: exact at multiples of 30 and 90 where the value is, and no digit
   !> lost to many turns.
   pure subroutine unit_vector(degrees, x, y)
      real(wp), intent(in) :: degrees
      real(wp), intent(out) :: x, y !! cosine, sine
      real(dp) :: cosine, sine
      real(qp) :: c, s

      if (by_library) then
         call unit_vector_quad(real(degrees, qp), c, s)
         x = real(c, wp)
         y = real(s, wp)
      else
         call sine_cosine(real(degrees, dp), sine, cosine)
         x = real(cosine, wp)
         y = real(sine, wp)
      end if
   end subroutine unit_vector

   !> The same of many angles at once: the bits of `unit_vector`.
   pure subroutine exact_unit_vectors(n, degrees, x, y)
      integer, intent(in) :: n
      real(wp), intent(in) :: degrees(n)
      real(wp), intent(out) :: x(n), y(n)
      real(dp) :: angle(strip), cosine(strip), sine(strip)
      integer :: first, m, i

      if (by_library) then
         do i = 1, n
            call unit_vector(degrees(i), x(i), y(i))
         end do
         return
      end if
      do first = 0, n - 1, strip
         m = min(strip, n - first)
         angle(:m) = real(degrees(first + 1:first + m), dp)
         call sines_cosines(m, angle, sine, cosine)
         x(first + 1:first + m) = real(cosine(:m), wp)
         y(first + 1:first + m) = real(sine(:m), wp)
      end do
   end subroutine exact_unit_vectors

   !> Direction of a vector in degrees, -180 to 180, correctly rounded; 0 for the zero vector.
   elemental real(wp) function degrees_of(x, y)
      real(wp), intent(in) :: x, y
      real(wp) :: guess(1), legs(2)
      real(dp) :: whole
      integer :: quadrant, e

      if (x == 0.0_wp .and. y == 0.0_wp) then
         degrees_of = 0.0_wp
         return
      end if
      if (by_library) then
         degrees_of = atan2(y, x)*degrees_per_radian
         return
      end if
      e = exponent(max(abs(x), abs(y)))
      legs = scale([x, y], -e)
      call angles_of(1, legs(1:1), legs(2:2), guess)
      quadrant = nint(guess(1)/right_angle)
      whole = real(right_angle, dp)*real(quadrant, dp)
      associate (lx => real(legs(1), dp), ly => real(legs(2), dp), rest => real(guess(1), dp) - whole)
         select case (quadrant)
         case (0)
            degrees_of = real(refined_direction(lx, ly, whole, rest), wp)
         case (1)
            degrees_of = real(refined_direction(ly, -lx, whole, rest), wp)
         case (-1)
            degrees_of = real(refined_direction(-ly, lx, whole, rest), wp)
         case default
            degrees_of = real(refined_direction(-lx, -ly, whole, rest), wp)
         end select
      end associate
   end function degrees_of

   !> Angle in degrees of which `value` is the sine, -90 to 90; to 4 units of the last digit.
   elemental real(wp) function arc_sine(value)
      real(wp), intent(in) :: value      !! -1 to 1
      real(wp) :: angle(1)

      call angles_of(1, [sqrt((1.0_wp - value)*(1.0_wp + value))], [value], angle)
      arc_sine = angle(1)
   end function arc_sine

   !> Directions of vectors, not zero, in degrees, for many positions at once: as `angles_between`.
   pure subroutine angles_of(n, x, y, degrees)
      integer, intent(in) :: n
      real(wp), intent(in) :: x(n), y(n)
      real(wp), intent(out) :: degrees(n)
      real(wp), parameter :: one(strip) = 1.0_wp, zero(strip) = 0.0_wp
      integer :: first, last

      do first = 1, n, strip
         last = min(n, first + strip - 1)
         call angles_between(last - first + 1, one, zero, 1.0_wp, 0.0_wp, x(first:last), y(first:last), degrees(first:last))
      end do
   end subroutine angles_of

   !> Angles from unit vectors (rx, ry), turned by a fixed angle, to unit vectors (wx, wy), -180 to 180 degrees, for many
   !> positions at once.
   !>
   !> A loop without calls or branches: the tangent of the angle reduced to -45 ... 45 by exchanging or turning the two legs.
   !> Accurate to 3 units of the last digit; the same bits at any place of the array. For a zero vector: 0.
   pure subroutine angles_between(n, rx, ry, turn_x, turn_y, wx, wy, degrees)
      integer, intent(in) :: n
      real(wp), intent(in) :: rx(n), ry(n), wx(n), wy(n)
      real(wp), intent(in) :: turn_x, turn_y  !! cosine, sine of the fixed angle
      real(wp), intent(out) :: degrees(n)
      real(wp) :: s(strip), c(strip), x, y
      integer :: first, m, i

      do first = 0, n - 1, strip
         m = min(strip, n - first)
         do i = 1, m
            x = turn_x*rx(first + i) - turn_y*ry(first + i)
            y = turn_x*ry(first + i) + turn_y*rx(first + i)
            s(i) = wy(first + i)*x - wx(first + i)*y
            c(i) = wx(first + i)*x + wy(first + i)*y
         end do
         call degrees_of_legs(m, s, c, degrees(first + 1))
      end do
   end subroutine angles_between

   !> The same for linkages side by side, each with a fixed angle of its own: the same bits.
   pure subroutine angles_between_lanes(n, rx, ry, turn_x, turn_y, wx, wy, degrees)
      integer, intent(in) :: n
      real(wp), intent(in) :: rx(lanes, n), ry(lanes, n)
      real(wp), intent(in) :: turn_x(lanes), turn_y(lanes) !! cosine, sine of the fixed angle of each
      real(wp), intent(in) :: wx(n), wy(n)                 !! unit vectors at every position, the same for all
      real(wp), intent(out) :: degrees(lanes, n)
      integer, parameter :: places = strip/lanes           ! positions at a time
      real(wp) :: s(lanes, places), c(lanes, places), x, y
      integer :: first, m, i, l

      do first = 0, n - 1, places
         m = min(places, n - first)
         do i = 1, m
            !$omp simd
            do l = 1, lanes
               x = turn_x(l)*rx(l, first + i) - turn_y(l)*ry(l, first + i)
               y = turn_x(l)*ry(l, first + i) + turn_y(l)*rx(l, first + i)
               s(l, i) = wy(first + i)*x - wx(first + i)*y
               c(l, i) = wx(first + i)*x + wy(first + i)*y
            end do
         end do
         call degrees_of_legs(lanes*m, s, c, degrees(1, first + 1))
      end do
   end subroutine angles_between_lanes

   !> Directions of the vectors (c, s), degrees.
   pure subroutine degrees_of_legs(n, s, c, degrees)
      integer, intent(in) :: n
      real(wp), intent(in) :: s(n), c(n)
      real(wp), intent(out) :: degrees(n)
      real(wp), parameter :: quarter_pi = 45.0_wp*radians_per_degree
      real(wp), parameter :: tan_eighth = 0.41421356237309504880168872420969808_wp !! tan(pi/8)
      real(wp) :: steep, wide, back, small, large, t, z, z2, z4, angle
      integer :: i

      if (precision(1.0_wp) > digits_of_fit) then
         do i = 1, n
            degrees(i) = atan2(s(i), c(i))*degrees_per_radian
         end do
         return
      end if
      do i = 1, n
         ! choices are factors 0 and 1, which lose no digit: a condition would keep the loop out of vector registers
         steep = 0.5_wp - sign(0.5_wp, abs(c(i)) - abs(s(i)))
         small = steep*abs(c(i)) + (1.0_wp - steep)*abs(s(i))
         large = steep*abs(s(i)) + (1.0_wp - steep)*abs(c(i))
         ! beyond 22.5 degrees the legs are turned by 45
         wide = 0.5_wp - sign(0.5_wp, tan_eighth*large - small)
         ! a dyad that is open may have no direction
         t = (small - wide*large)/(large + wide*small + tiny(1.0_wp))
         z = t*t
         ! in pairs (Estrin): short chains of operations
         z2 = z*z
         z4 = z2*z2
         angle = ((arc_tangent(0) + arc_tangent(1)*z) + (arc_tangent(2) + arc_tangent(3)*z)*z2) &
                 + ((arc_tangent(4) + arc_tangent(5)*z) + (arc_tangent(6) + arc_tangent(7)*z)*z2)*z4 &
                 + ((arc_tangent(8) + arc_tangent(9)*z) + (arc_tangent(10) + arc_tangent(11)*z)*z2)*(z4*z4)
         angle = t*angle + wide*quarter_pi
         angle = steep*(2.0_wp*quarter_pi) + (1.0_wp - 2.0_wp*steep)*angle
         ! 0 is added so that -0 counts as +0
         back = 0.5_wp - sign(0.5_wp, c(i) + 0.0_wp)
         angle = back*(4.0_wp*quarter_pi) + (1.0_wp - 2.0_wp*back)*angle
         degrees(i) = sign(angle, s(i))*degrees_per_radian
      end do
   end subroutine degrees_of_legs

   !> Cosines and sines of angles in degrees, for many positions at once.
   !>
   !> A loop without calls or branches: the angle less the nearest quarter turn, series, the legs exchanged. Accurate to 2 units of
   !> the last digit of the unit; the same bits at any place of the array, and on every processor.
   pure subroutine unit_vectors(n, degrees, x, y)
      integer, intent(in) :: n
      real(wp), intent(in) :: degrees(n)
      real(wp), intent(out) :: x(n), y(n)   !! cosines, sines
      real(wp), parameter :: shifter = 1.5_wp/epsilon(1.0_wp) !! whole numbers are the only ones beside it
      real(wp) :: quarters, part, odd, turned, r, z, z2, z4, c, s
      integer :: i

      if (precision(1.0_wp) > digits_of_fit) then
         do i = 1, n
            call unit_vector(degrees(i), x(i), y(i))
         end do
         return
      end if
      do i = 1, n
         ! rounded to a whole number by the addition: an intrinsic would be a call
         quarters = (degrees(i)/right_angle + shifter) - shifter
         r = (degrees(i) - right_angle*quarters)*radians_per_degree
         z = r*r
         z2 = z*z
         z4 = z2*z2
         s = r*(((sine_terms(0) + sine_terms(1)*z) + (sine_terms(2) + sine_terms(3)*z)*z2) &
                + ((sine_terms(4) + sine_terms(5)*z) + (sine_terms(6) + sine_terms(7)*z)*z2)*z4)
         c = ((cosine_terms(0) + cosine_terms(1)*z) + (cosine_terms(2) + cosine_terms(3)*z)*z2) &
             + (((cosine_terms(4) + cosine_terms(5)*z) + (cosine_terms(6) + cosine_terms(7)*z)*z2) + cosine_terms(8)*z4)*z4
         ! the quarter of the turn: 0 to 3
         part = quarters - 4.0_wp*(((0.25_wp*quarters - 0.375_wp) + shifter) - shifter)
         ! signs and choices by factors: no condition
         odd = abs(quarters - 2.0_wp*((0.5_wp*quarters + shifter) - shifter))
         turned = 1.0_wp - part*(3.0_wp - part)
         ! a zero added takes the sign from another
         x(i) = turned*(odd*s + (1.0_wp - odd)*c) + 0.0_wp
         y(i) = (turned*(1.0_wp - 2.0_wp*odd))*(odd*c + (1.0_wp - odd)*s) + 0.0_wp
      end do
   end subroutine unit_vectors

   !> The same angle in 0 <= angle < 360 degrees.
   elemental real(wp) function within_turn(degrees)
      real(wp), intent(in) :: degrees

      within_turn = modulo(degrees, full_turn)
      if (within_turn >= full_turn) within_turn = 0.0_wp
   end function within_turn

   !> Difference a - b of two angles, to the nearest turn: -180 to 180 degrees.
   elemental real(wp) function nearest_difference(a, b)
      real(wp), intent(in) :: a, b

      nearest_difference = mod(a - b, full_turn)
      nearest_difference = nearest_difference - full_turn*anint(nearest_difference/full_turn)
   end function nearest_difference
end module psalm_angles
