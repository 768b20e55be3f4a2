!> Quadruple precision, whatever the working precision is: for proofs, and for angles where the working precision is that.
!>
!> Nothing but the four operations is asked of the compiler: not every library has functions of this kind.
module psalm_quad
   use, intrinsic :: iso_fortran_env, only: int64, real64, real128
   implicit none (type, external)
   private
   public :: qp, unit_vector_quad, arc_sine_quad, sqrt, abs, exp

   integer, parameter :: qp = real128  !! quadruple precision

   interface sqrt
      module procedure square_root_quad
   end interface sqrt

   interface abs
      module procedure modulus_quad
   end interface abs

   interface exp
      module procedure exponential_quad
   end interface exp

   real(qp), parameter :: right_angle = 90.0_qp, full_turn = 360.0_qp
   real(qp), parameter :: radians_per_degree = 0.017453292519943295769236907684886127134_qp
   real(qp), parameter :: degrees_per_radian = 57.295779513082320876798154814105170332_qp
   real(qp), parameter :: log_of_two = 0.69314718055994530941723212145817656808_qp
   integer, parameter :: terms_of_exponential = 27 !! the next of half the logarithm of 2 is 5e-43
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

   !> Modulus of a complex number, to a few units of the last digit; not a number if that is none.
   elemental real(qp) function modulus_quad(z) result(modulus)
      complex(qp), intent(in) :: z
      real(qp) :: x, y

      x = abs(real(z, qp))
      y = abs(aimag(z))
      modulus = x + y
      if (min(x, y) > 0.0_qp .and. modulus <= huge(modulus)) modulus = max(x, y)*sqrt(1.0_qp + (min(x, y)/max(x, y))**2)
   end function modulus_quad

   !> Exponential of a complex number of moderate size, to some units of the last digit.
   elemental complex(qp) function exponential_quad(z) result(w)
      complex(qp), intent(in) :: z
      real(qp) :: rest, whole, x, y
      integer :: doubled, k

      doubled = nint(real(z, real64)/real(log_of_two, real64))
      rest = real(z, qp) - real(doubled, qp)*log_of_two
      whole = 1.0_qp
      do k = terms_of_exponential, 1, -1
         whole = 1.0_qp + whole*rest/real(k, qp)
      end do
      do k = 1, abs(doubled)
         whole = whole*merge(2.0_qp, 0.5_qp, doubled > 0)
      end do
      call unit_vector_quad(aimag(z)*degrees_per_radian, x, y)
      w = cmplx(whole*x, whole*y, qp)
   end function exponential_quad

   !> Arc sine of a number from 0 to 1, in degrees, to some units of the last digit.
   elemental real(qp) function arc_sine_quad(sine) result(degrees)
      real(qp), intent(in) :: sine
      real(qp) :: small_sine, x, y
      integer :: k

      ! above half of 1 by the half angle of what is left of 90 degrees
      small_sine = sine
      if (sine > 0.5_qp) small_sine = sqrt(0.5_qp*(1.0_qp - sine))
      degrees = small_sine*(1.0_qp + small_sine**2*(1.0_qp + small_sine**2*0.45_qp)/6.0_qp)*degrees_per_radian
      ! the series is good for three digits; their number doubles, each time
      do k = 1, 5
         call unit_vector_quad(degrees, x, y)
         degrees = degrees + (small_sine - y)/x*degrees_per_radian
      end do
      if (sine > 0.5_qp) degrees = right_angle - 2.0_qp*degrees
   end function arc_sine_quad
end module psalm_quad
