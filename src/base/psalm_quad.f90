!> Quadruple precision, whatever the working precision is: for proofs, and for angles where the working precision is that.
!>
!> Nothing but the four operations is asked of the compiler: not every library has functions of this kind.
module psalm_quad
   use, intrinsic :: iso_fortran_env, only: int64, real64, real128
   implicit none (type, external)
   private
   public :: qp, unit_vector_quad, sqrt

   integer, parameter :: qp = real128  !! quadruple precision

   interface sqrt
      module procedure square_root_quad
   end interface sqrt

   real(qp), parameter :: right_angle = 90.0_qp, full_turn = 360.0_qp
   real(qp), parameter :: radians_per_degree = 0.017453292519943295769236907684886127134_qp
   real(qp), parameter :: many_turns = full_turn*2.0_qp**52          !! their number still fits an integer
   !> (2 n + 1) 2 n, n = 1, 2 ..., and (2 n) (2 n - 1): what divides one term of the series of the sine and cosine by the one before
   integer :: n
   integer, parameter :: terms = 15    !! the next of an angle of 45 degrees is 1e-40
   real(qp), parameter :: of_sine(terms) = [(1.0_qp/real((2*n + 1)*2*n, qp), n=1, terms)]
   real(qp), parameter :: of_cosine(terms) = [(1.0_qp/real(2*n*(2*n - 1), qp), n=1, terms)]
   real(qp), parameter :: small = 2.0_qp**(-960), large = 2.0_qp**960 !! between them the guess of real64 is good

contains

   !> Cosine and sine of an angle in degrees, to two units of the last digit; exact at multiples of 90.
   !>
   !> The angle is reduced to -45 ... 45 degrees before anything else; that is exact.
   pure subroutine unit_vector_quad(degrees, x, y)
      real(qp), intent(in) :: degrees
      real(qp), intent(out) :: x, y  !! cosine, sine
      real(qp) :: rest, turns, square, c, s
      integer(int64) :: quadrant
      integer :: k

      rest = degrees
      do while (abs(rest) >= many_turns)
         turns = many_turns
         do while (turns <= abs(rest)*0.5_qp)
            turns = turns*2.0_qp
         end do
         rest = rest - sign(turns, rest)
      end do
      turns = rest/right_angle + 0.5_qp
      quadrant = int(turns, int64)
      ! ties go up, so that whole turns change nothing
      if (real(quadrant, qp) > turns) quadrant = quadrant - 1
      rest = (rest - right_angle*real(quadrant, qp))*radians_per_degree
      square = rest*rest
      s = 1.0_qp
      c = 1.0_qp
      do k = terms, 1, -1
         s = 1.0_qp - s*(square*of_sine(k))
         c = 1.0_qp - c*(square*of_cosine(k))
      end do
      s = s*rest
      select case (int(modulo(quadrant, 4_int64)))
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

   !> Square root, to two units of the last digit; 0 of what is not positive.
   elemental real(qp) function square_root_quad(a) result(root)
      real(qp), intent(in) :: a
      real(qp) :: b, factor

      root = 0.0_qp
      if (.not. a > 0.0_qp) return
      b = a
      factor = 1.0_qp
      do while (b < small)
         b = b*large
         factor = factor*2.0_qp**(-480)
      end do
      do while (b > large .and. b <= huge(b))
         b = b*small
         factor = factor*2.0_qp**480
      end do
      root = real(sqrt(real(b, real64)), qp)
      ! 53 digits, 105, all
      root = 0.5_qp*(root + b/root)
      root = 0.5_qp*(root + b/root)
      root = root*factor
   end function square_root_quad
end module psalm_quad
