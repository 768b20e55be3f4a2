!> Quadruple precision, whatever the working precision is: for proofs, and for angles where the working precision is that.
module psalm_quad
   use, intrinsic :: iso_fortran_env, only: real128
   implicit none (type, external)
   private
   public :: qp, unit_vector_quad

   integer, parameter :: qp = real128  !! quadruple precision

contains

   !> Cosine and sine of an angle in degrees, to one unit of the last digit; exact at multiples of 90.
   !>
   !> The angle is reduced to -45 ... 45 degrees before anything else; that is exact.
   pure subroutine unit_vector_quad(degrees, x, y)
      real(qp), intent(in) :: degrees
      real(qp), intent(out) :: x, y  !! cosine, sine
      real(qp), parameter :: full_turn = 360.0_qp, right_angle = 90.0_qp
      real(qp), parameter :: radians_per_degree = 0.017453292519943295769236907684886127134_qp
      real(qp) :: rest, c, s
      integer :: quadrant

      rest = mod(degrees, full_turn)
      ! ties go up, so that whole turns change nothing
      quadrant = floor(rest/right_angle + 0.5_qp)
      rest = rest - right_angle*real(quadrant, qp)
      c = cos(rest*radians_per_degree)
      s = sin(rest*radians_per_degree)
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
   end subroutine unit_vector_quad
end module psalm_quad
