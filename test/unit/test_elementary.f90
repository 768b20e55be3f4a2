!> Elementary functions against those of the library in quadruple precision, which share nothing with them.
program test_elementary
   use check, only: checks_t
   use psalm_angles, only: unit_vector, unit_vectors, degrees_of, arc_sine
   use psalm_elementary, only: hypotenuse, fractional_power
   use psalm_kinds, only: wp, i8
   use psalm_quad, only: unit_vector_quad, arc_sine_quad, root => sqrt, modulus => abs, exponential => exp
   implicit none (type, external)
   integer, parameter :: qp = selected_real_kind(33)
   real(qp), parameter :: degree = 3.14159265358979323846264338327950288419716939937511_qp/180.0_qp
   integer, parameter :: many = 300000
   real(qp), parameter :: most_units = 0.5000001_qp

   !> Errors of one function.
   type :: errors_t
      real(qp) :: largest = 0.0_qp       !! units of the last digit
      integer :: wrong = 0, count = 0    !! values not correctly rounded; all
   end type errors_t

   type(checks_t) :: t
   integer(i8) :: state = 88172645463325252_i8

   call exact_values()
   call sines()
   call directions()
   call others()
   call quadruple()
   call side_by_side()
   call t%report()

contains

   !> Cosines and sines of many angles at once against those that are correctly rounded.
   subroutine side_by_side()
      integer, parameter :: n = 20011
      real(wp) :: degrees(n), x(n), y(n), again(1), other(1), c, s, worst
      integer :: i
      logical :: same

      degrees = [(-1.0e4_wp + real(i, wp), i=1, n)]
      degrees(:8) = [0.0_wp, 90.0_wp, 180.0_wp, 270.0_wp, -90.0_wp, -180.0_wp, 45.0_wp, 1.0e-300_wp]
      degrees(9:n:2) = degrees(9:n:2) + 0.3_wp
      call unit_vectors(n, degrees, x, y)
      worst = 0.0_wp
      same = .true.
      do i = 1, n
         call unit_vector(degrees(i), c, s)
         worst = max(worst, abs(x(i) - c), abs(y(i) - s))
         call unit_vectors(1, degrees(i:i), again, other)
         same = same .and. again(1) >= x(i) .and. again(1) <= x(i) .and. other(1) >= y(i) .and. other(1) <= y(i)
      end do
      call t%close_to(worst, 0.0_wp, 2.0_wp*epsilon(1.0_wp), 'cosines and sines side by side')
      call t%is_true(same, 'the same at any place of the array')
      call t%is_true(all(sign(1.0_wp, x(:3)) >= [1.0_wp, 1.0_wp, -1.0_wp]) .and. all(sign(1.0_wp, y(:3)) > 0.0_wp), &
                     'zeros have no sign')
   end subroutine side_by_side

   subroutine add(self, got, exact)
      type(errors_t), intent(inout) :: self
      real(wp), intent(in) :: got
      real(qp), intent(in) :: exact

      self%count = self%count + 1
      self%largest = max(self%largest, abs(real(got, qp) - exact)/real(spacing(real(exact, wp)), qp))
      if (abs(got - real(exact, wp)) > 0.0_wp) self%wrong = self%wrong + 1
   end subroutine add

   subroutine tell(self, name, allowed)
      type(errors_t), intent(in) :: self
      character(*), intent(in) :: name
      real(qp), intent(in) :: allowed
      character(80) :: text

      write (text, '(i0," values, largest error ",f10.7," units, not correctly rounded ",i0)') self%count, self%largest, self%wrong
      print '(3a)', name, ': ', trim(text)
      call t%is_true(self%largest <= allowed, name//': error in units of the last digit', trim(text))
   end subroutine tell

   !> Uniform in (0, 1): the shift register of Marsaglia (2003).
   real(wp) function drawn()
      state = ieor(state, shiftl(state, 13))
      state = ieor(state, shiftr(state, 7))
      state = ieor(state, shiftl(state, 17))
      drawn = real(shiftr(state, 11), wp)/2.0_wp**53
   end function drawn

   subroutine exact_values()
      real(wp), parameter :: angle(*) = [0.0_wp, 30.0_wp, 90.0_wp, 150.0_wp, 180.0_wp, 210.0_wp, 270.0_wp, 330.0_wp, 360.0_wp, &
                                         -30.0_wp, 36000030.0_wp]
      real(wp), parameter :: sine(*) = [0.0_wp, 0.5_wp, 1.0_wp, 0.5_wp, 0.0_wp, -0.5_wp, -1.0_wp, -0.5_wp, 0.0_wp, -0.5_wp, 0.5_wp]
      real(wp), parameter :: legs_x(8) = [1.0_wp, 1.0_wp, 0.0_wp, -1.0_wp, -1.0_wp, -1.0_wp, 0.0_wp, 1.0_wp]
      real(wp), parameter :: legs_y(8) = [0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, -1.0_wp, -1.0_wp, -1.0_wp]
      real(wp), parameter :: eighths(8) = [0.0_wp, 45.0_wp, 90.0_wp, 135.0_wp, 180.0_wp, -135.0_wp, -90.0_wp, -45.0_wp]
      real(wp) :: x, y, other
      integer :: i

      do i = 1, size(angle)
         call unit_vector(angle(i), x, y)
         call t%is_true(abs(y - sine(i)) <= 0.0_wp, 'sine of a multiple of 30 degrees is exact')
         call unit_vector(90.0_wp - angle(i), x, y)
         call t%is_true(abs(x - sine(i)) <= 0.0_wp, 'and the cosine of its complement')
      end do
      do i = -7, 7
         call unit_vector(90.0_wp*real(i, wp) + 45.0_wp, x, y)
         call t%is_true(abs(abs(x) - sqrt(0.5_wp)) <= 0.0_wp .and. abs(abs(y) - abs(x)) <= 0.0_wp, &
                        'sine and cosine of 45 degrees are the root of a half')
      end do
      call unit_vector(60.0_wp, x, y)
      call unit_vector(30.0_wp, other, x)
      call t%is_true(abs(y - other) <= 0.0_wp .and. abs(x - 0.5_wp) <= 0.0_wp, 'sine of 60 degrees is the cosine of 30')
      do i = 1, size(eighths)
         call t%is_true(abs(degrees_of(legs_x(i), legs_y(i)) - eighths(i)) <= 0.0_wp, 'directions of an eighth are exact')
         call t%is_true(abs(degrees_of(1.0e300_wp*legs_x(i), 1.0e300_wp*legs_y(i)) - eighths(i)) <= 0.0_wp .and. &
                        abs(degrees_of(1.0e-300_wp*legs_x(i), 1.0e-300_wp*legs_y(i)) - eighths(i)) <= 0.0_wp, &
                        'whatever the length')
      end do
      call t%is_true(abs(degrees_of(0.0_wp, 0.0_wp)) <= 0.0_wp, 'the zero vector has direction 0')
      call t%is_true(abs(arc_sine(0.5_wp) - 30.0_wp) <= 4.0_wp*spacing(30.0_wp) .and. abs(arc_sine(-1.0_wp) + 90.0_wp) <= 0.0_wp, &
                     'arc sine of 0.5 and of -1')
   end subroutine exact_values

   !> Random angles within a turn, within a thousand turns, small ones, and the neighbours of whole degrees.
   subroutine sines()
      type(errors_t) :: sine, cosine
      real(wp) :: angle
      integer :: i

      do i = 1, many
         select case (mod(i, 4))
         case (0)
            angle = 720.0_wp*(drawn() - 0.5_wp)
         case (1)
            angle = 720000.0_wp*(drawn() - 0.5_wp)
         case (2)
            angle = scale(drawn(), -mod(i, 200))
         case default
            angle = real(mod(i, 721) - 360, wp)
            angle = angle + real(mod(i/721, 9) - 4, wp)*spacing(angle)
         end select
         call compare(angle, sine, cosine)
      end do
      do i = -3600, 3600
         call compare(real(i, wp)/10.0_wp, sine, cosine)
      end do
      call tell(sine, 'sine', most_units)
      call tell(cosine, 'cosine', most_units)
      call t%is_true(sine%wrong + cosine%wrong == 0, 'every sine and cosine is correctly rounded')
   end subroutine sines

   subroutine compare(degrees, sine, cosine)
      real(wp), intent(in) :: degrees
      type(errors_t), intent(inout) :: sine, cosine
      real(wp) :: x, y
      real(qp) :: rest, c, s
      integer :: quarter

      call unit_vector(degrees, x, y)
      rest = mod(real(degrees, qp), 360.0_qp)
      quarter = nint(rest/90.0_qp)
      rest = (rest - 90.0_qp*real(quarter, qp))*degree
      c = cos(rest)
      s = sin(rest)
      select case (modulo(quarter, 4))
      case (0)
         call add(sine, y, s)
         call add(cosine, x, c)
      case (1)
         call add(sine, y, c)
         call add(cosine, x, -s)
      case (2)
         call add(sine, y, -s)
         call add(cosine, x, -c)
      case default
         call add(sine, y, -c)
         call add(cosine, x, s)
      end select
   end subroutine compare

   !> Vectors in every direction, long and short, and nearly along an axis or a diagonal.
   subroutine directions()
      type(errors_t) :: direction, arc
      real(wp) :: x, y
      integer :: i

      do i = 1, many/2
         x = drawn() - 0.5_wp
         y = drawn() - 0.5_wp
         select case (mod(i, 4))
         case (1)
            y = scale(y, -mod(i, 300))
         case (2)
            x = scale(x, mod(i, 601) - 300)
            y = scale(y, mod(i, 601) - 300)
         case (3)
            y = sign(x, y) + real(mod(i, 9) - 4, wp)*spacing(x)
         end select
         call add(direction, degrees_of(x, y), atan2(real(y, qp), real(x, qp))/degree)
         x = 2.0_wp*drawn() - 1.0_wp
         call add(arc, arc_sine(x), asin(real(x, qp))/degree)
      end do
      call tell(direction, 'direction', most_units)
      call t%is_true(direction%wrong == 0, 'every direction is correctly rounded')
      call tell(arc, 'arc sine', 4.0_qp)
   end subroutine directions

   subroutine others()
      type(errors_t) :: leg, power
      real(wp) :: x, y
      integer :: i

      do i = 1, many/10
         x = scale(drawn(), mod(i, 1801) - 900)
         y = scale(drawn(), mod(i, 1801) - 900 + mod(i, 5))
         call add(leg, hypotenuse(x, y), sqrt(real(x, qp)**2 + real(y, qp)**2))
         x = 1000.0_wp*drawn()
         y = real(nint(drawn()*2.0_wp**30), wp)/2.0_wp**31
         call add(power, fractional_power(x, y), real(x, qp)**real(y, qp))
      end do
      call tell(leg, 'hypotenuse', 1.25_qp)
      call tell(power, 'power', 40.0_qp)
      call t%is_true(abs(hypotenuse(0.0_wp, 0.0_wp)) <= 0.0_wp .and. abs(hypotenuse(-3.0_wp, 4.0_wp) - 5.0_wp) <= 0.0_wp &
                     .and. abs(hypotenuse(3.0e307_wp, 4.0e307_wp) - 5.0e307_wp) <= spacing(5.0e307_wp), 'hypotenuses')
      call t%is_true(abs(fractional_power(7.0_wp, 0.0_wp) - 1.0_wp) <= 0.0_wp, 'the power 0')
   end subroutine others

   !> The suite's own functions in quadruple precision.
   subroutine quadruple()
      integer, parameter :: count = 5000
      real(qp), parameter :: allowed = 9.0_qp     !! units; those of the reference's angle, up to 6.3 radians, are most of it
      real(qp) :: turned, x, y, value, worst(6)
      complex(qp) :: z
      integer :: i

      worst = 0.0_qp
      do i = 1, count
         turned = (real(drawn(), qp) - 0.5_qp + real(i, qp)*epsilon(1.0_qp))*1000.0_qp
         call unit_vector_quad(turned, x, y)
         value = mod(turned, 360.0_qp)*degree
         worst(1) = max(worst(1), abs(x - cos(value)), abs(y - sin(value)))
         value = scale(real(drawn(), qp) + real(i, qp)*epsilon(1.0_qp), modulo(7*i, 32000) - 16000)
         worst(2) = max(worst(2), abs(root(value)/sqrt(value) - 1.0_qp))
         call unit_vector_quad(scale(turned, 40 + modulo(i, 400)), x, y)
         value = mod(scale(turned, 40 + modulo(i, 400)), 360.0_qp)*degree
         worst(3) = max(worst(3), abs(x - cos(value)), abs(y - sin(value)))
         z = cmplx((real(drawn(), qp) - 0.5_qp)*40.0_qp, (real(drawn(), qp) - 0.5_qp)*6.0_qp, qp)
         worst(4) = max(worst(4), abs(modulus(z)/abs(z) - 1.0_qp))
         worst(5) = max(worst(5), abs(exponential(z) - exp(z))/abs(exp(z)))
         value = scale(real(drawn(), qp) + real(i, qp)*epsilon(1.0_qp), -modulo(i, 40))
         if (value <= 1.0_qp) worst(6) = max(worst(6), abs(arc_sine_quad(value)*degree/asin(value) - 1.0_qp))
      end do
      call t%is_true(worst(1) <= allowed*epsilon(1.0_qp), 'quadruple precision: cosine and sine')
      call t%is_true(worst(2) <= 2.0_qp*epsilon(1.0_qp), 'quadruple precision: square root')
      call t%is_true(worst(3) <= allowed*epsilon(1.0_qp), 'quadruple precision: cosine and sine after many turns')
      call t%is_true(worst(4) <= 2.0_qp*epsilon(1.0_qp), 'quadruple precision: modulus')
      ! of the result: units of the exponent, up to 20
      call t%is_true(worst(5) <= 40.0_qp*epsilon(1.0_qp), 'quadruple precision: exponential')
      call t%is_true(worst(6) <= allowed*epsilon(1.0_qp), 'quadruple precision: arc sine')
      call unit_vector_quad(-630.0_qp, x, y)
      call t%is_true(abs(x) <= 0.0_qp .and. abs(y - 1.0_qp) <= 0.0_qp, 'quadruple precision: a quarter of a turn is exact')
      call t%is_true(root(-1.0_qp) <= 0.0_qp .and. root(0.0_qp) <= 0.0_qp, 'quadruple precision: no root of what is not positive')
   end subroutine quadruple
end program test_elementary
