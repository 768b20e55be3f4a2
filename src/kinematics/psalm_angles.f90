!> Angles in degrees and unit vectors.
!>
!> Kept in a file of its own: a compiler that sees sine or cosine inside a loop over an array may replace it by a vector
!> version whose last digit depends on the place in the array.
module psalm_angles
   use psalm_kinds, only: wp, degrees_per_radian, full_turn, radians_per_degree, right_angle
   implicit none (type, external)
   private
   public :: unit_vector, degrees_of, within_turn, nearest_difference

contains

   !> Cosine and sine of an angle in degrees; exact at multiples of 90, and no digit lost to many turns.
   !>
   !> The angle is reduced to -45 ... 45 degrees before it becomes radians; both reductions are exact.
   pure subroutine unit_vector(degrees, x, y)
      real(wp), intent(in) :: degrees
      real(wp), intent(out) :: x, y !! cosine, sine
      real(wp) :: rest, c, s
      integer :: quadrant

      rest = mod(degrees, full_turn)
      quadrant = nint(rest/right_angle)
      rest = (rest - right_angle*real(quadrant, wp))*radians_per_degree
      c = cos(rest)
      s = sin(rest)
      select case (modulo(quadrant, 4))
      case (0)
         x = c
         y = s
      case (1)
         x = -s
         y = c
      case (2)
         x = -c
         y = -s
      case default
         x = s
         y = -c
      end select
   end subroutine unit_vector

   !> Direction of a vector in degrees, -180 to 180; 0 for the zero vector.
   elemental real(wp) function degrees_of(x, y)
      real(wp), intent(in) :: x, y

      if (x == 0.0_wp .and. y == 0.0_wp) then
         degrees_of = 0.0_wp
      else
         degrees_of = atan2(y, x)*degrees_per_radian
      end if
   end function degrees_of

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
