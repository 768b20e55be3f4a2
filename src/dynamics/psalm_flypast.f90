!> A joint with clearance at a minimum of its load: the standard flypast of Haines, chapters 3 and 4.
!>
!> Near a minimum R_u of the load its component across, R_v, passes through zero at a steady rate R'_v. With T = R_v/R_u as time the
!> angle g of the pin in contact with its hole obeys one equation with three parameters (the lag behind the load is atan T - g):
!> H1 = R_u/(R'_v**2 e M0)**(1/3), H2 = 2 eta (the axis of the inertia felt at the joint) and H3 = eps, its difference along and
!> across. Where the force of contact becomes negative the pin leaves its hole, flies freely, and strikes.
module psalm_flypast
   use psalm_kinds, only: wp, pi
   use psalm_ode, only: smooth_ode_t, one_step, advance, next_step
   implicit none (type, external)
   private
   public :: flypast_t, flight_t, passing_contact_t, passed_step_t, follow_flypast, fly

   integer, parameter :: most_minima = 6            !! of the force: contact is assessed by the passage and five after it
   real(wp), parameter :: first_time = -40.0_wp     !! T at which following begins: from -10 on figures still move
   real(wp), parameter :: last_time = 400.0_wp      !! T by which all minima have come, at most;
   real(wp), parameter :: settling = 40.0_wp        !! sooner where H1 is large: settling/H1 after T = 20
   real(wp), parameter :: tolerance = 1.0e-9_wp     !! of a step, absolute in g and g'
   real(wp), parameter :: shortest = 1.0e-9_wp      !! step, in T
   real(wp), parameter :: located = 1.0e-12_wp      !! events are located to this part of T
   integer, parameter :: most_steps = 400000
   real(wp), parameter :: passage_begins = -5.0_wp  !! T
   real(wp), parameter :: quiet_part = 0.25_wp, least_part = 0.1_wp !! steps are at most these parts of the period of swinging

   !> What the contact does. Forces are parts of R_u.
   type :: flypast_t
      real(wp) :: minima(most_minima) = 0.0_wp      !! of the force, in their order: the first is the passage
      integer :: found = 0                          !! how many there are
      logical :: lost = .false.                     !! one of the first six is negative
      integer :: at = 0                             !! the first that is
      real(wp) :: loss(3) = 0.0_wp                  !! T, g, g' where the force becomes zero for the first time
      logical :: ok = .false.                       !! false: it could not be followed
   end type flypast_t

   !> Free flight and the first impact. Lengths are parts of the radial clearance e, times those of T.
   type :: flight_t
      real(wp) :: duration = 0.0_wp
      real(wp) :: angle = 0.0_wp                    !! of the pin in the hole at the impact, from the least force
      real(wp) :: across = 0.0_wp                   !! speed towards the wall, VN
      real(wp) :: along = 0.0_wp                    !! and along it, VT
      real(wp) :: index = 0.0_wp                    !! of the impulse: impulse = (M0 R'_v e/R_u) index (1 + restitution)
      logical :: ok = .false.                       !! false: no impact follows
   end type flight_t

   !> The equation of the angle g.
   type, extends(smooth_ode_t) :: passing_contact_t
      real(wp) :: cube = 0.0_wp                     !! H1**3
      real(wp) :: h3 = 0.0_wp
      real(wp) :: cosine = 1.0_wp, sine = 0.0_wp    !! of H2
   contains
      procedure :: slopes
      procedure :: force
      procedure :: rate
   end type passing_contact_t

   !> A step of its integration.
   type :: passed_step_t
      real(wp) :: time = 0.0_wp                     !! T at which it begins
      real(wp) :: state(2) = 0.0_wp                 !! g, g' there
      real(wp) :: length = 0.0_wp
   end type passed_step_t

contains

   !> (g, g')' by T.
   pure function slopes(self, time, y) result(d)
      class(passing_contact_t), intent(in) :: self
      real(wp), intent(in) :: time, y(:)
      real(wp) :: d(size(y)), c, s, cos_p, sin_p

      c = cos(y(1))
      s = sin(y(1))
      call turn_twice(self%cosine, self%sine, c, s, cos_p, sin_p)
      d(1) = y(2)
      d(2) = (self%cube*(time*c - s) - self%h3*y(2)**2*sin_p)/(1.0_wp + self%h3*cos_p)
   end function slopes

   !> Force of contact over R_u.
   pure real(wp) function force(self, time, y)
      class(passing_contact_t), intent(in) :: self
      real(wp), intent(in) :: time, y(2)
      real(wp) :: d(2), c, s, cos_p, sin_p

      c = cos(y(1))
      s = sin(y(1))
      call turn_twice(self%cosine, self%sine, c, s, cos_p, sin_p)
      d = self%slopes(time, y)
      force = c + time*s + ((1.0_wp - self%h3*cos_p)*y(2)**2 + self%h3*sin_p*d(2))/self%cube
   end function force

   !> Derivative of the force by T. With A = 1 + H3 cos P and B = H3 sin P is A' = 2 g' B, B' = -2 g' (A - 1), and g''' follows
   !> from the equation of g''.
   pure real(wp) function rate(self, time, y)
      class(passing_contact_t), intent(in) :: self
      real(wp), intent(in) :: time, y(2)
      real(wp) :: d(2), c, s, cos_p, sin_p, a, b, a1, b1, third

      c = cos(y(1))
      s = sin(y(1))
      call turn_twice(self%cosine, self%sine, c, s, cos_p, sin_p)
      d = self%slopes(time, y)
      a = 1.0_wp + self%h3*cos_p
      b = self%h3*sin_p
      a1 = 2.0_wp*y(2)*b
      b1 = -2.0_wp*y(2)*self%h3*cos_p
      third = (self%cube*(c - (time*s + c)*y(2)) - b1*y(2)**2 - 2.0_wp*b*y(2)*d(2) - d(2)*a1)/a
      rate = s + (time*c - s)*y(2) + (-a1*y(2)**2 + 2.0_wp*(2.0_wp - a)*y(2)*d(2) + b1*d(2) + b*third)/self%cube
   end function rate

   !> Cosine and sine of P = -2 g - H2, from those of g.
   pure subroutine turn_twice(cosine, sine, c, s, cos_p, sin_p)
      real(wp), intent(in) :: cosine, sine          !! of H2
      real(wp), intent(in) :: c, s
      real(wp), intent(out) :: cos_p, sin_p
      real(wp) :: cos_twice, sin_twice

      cos_twice = (c - s)*(c + s)
      sin_twice = 2.0_wp*s*c
      cos_p = cos_twice*cosine - sin_twice*sine
      sin_p = -(sin_twice*cosine + cos_twice*sine)
   end subroutine turn_twice

   !> Follow the contact from T = -40 through the minimum. Errors: `ok` false if H1 <= 0, H3 is not in [0, 1), or the equation
   !> cannot be followed.
   function follow_flypast(h1, h2, h3, from, passing, steps) result(flypast)
      real(wp), intent(in) :: h1                    !! positive
      real(wp), intent(in) :: h2                    !! radians
      real(wp), intent(in) :: h3                    !! 0 <= H3 < 1
      real(wp), intent(in), optional :: from        !! T at which to begin; -40 if not given
      type(passing_contact_t), intent(out), optional :: passing
      type(passed_step_t), allocatable, intent(out), optional :: steps(:) !! from before the first minimum to after the second
      type(flypast_t) :: flypast
      type(passing_contact_t) :: contact
      real(wp) :: t, last, g(2), step, next(2), taken, forces(3), times(3), states(2, 3), least, gap, period
      integer :: i, count                           ! of the steps kept
      logical :: passed                             ! the second minimum

      passed = .false.
      count = 0
      if (present(steps)) allocate (steps(0))
      if (.not. (h1 > 0.0_wp .and. h3 >= 0.0_wp .and. h3 < 1.0_wp)) return
      ! flang 19 breaks off at a constructor that names a component of ode_t, two types up
      contact%tolerance = tolerance
      contact%cube = h1**3
      contact%h3 = h3
      contact%cosine = cos(h2)
      contact%sine = sin(h2)
      if (present(passing)) passing = contact
      last = min(last_time, 0.5_wp*settling + settling/h1)
      t = first_time
      if (present(from)) t = from
      g = [atan(t) - quiet_lag(), 1.0_wp/(1.0_wp + t*t)]
      step = 0.01_wp/h1
      times = t
      states = spread(g, 2, 3)
      forces = contact%force(t, g)
      do i = 1, most_steps
         ! a minimum must not hide within a step; long before the passage there is none
         period = 2.0_wp*pi/sqrt(h1**3*sqrt(1.0_wp + t*t)/(1.0_wp - h3) + 1.0_wp)
         step = min(step, merge(quiet_part, least_part, t < passage_begins)*period)
         call advance(contact, t, g, step, shortest, next, taken, gap)
         if (taken <= shortest) exit
         if (flypast%loss(1) <= 0.0_wp .and. .not. any(abs(flypast%loss) > 0.0_wp)) then
            if (contact%force(t + taken, next) < 0.0_wp) flypast%loss = loss_between(t, g, taken)
         end if
         times = [times(2:), t + taken]
         states(:, :2) = states(:, 2:)
         states(:, 3) = next
         forces = [forces(2:), contact%force(t + taken, next)]
         if (forces(2) < forces(1) .and. forces(2) <= forces(3)) then
            least = least_within(times(3) - times(1))
            flypast%found = flypast%found + 1
            flypast%minima(flypast%found) = least
            if (least < 0.0_wp .and. .not. flypast%lost) then
               flypast%lost = .true.
               flypast%at = flypast%found
            end if
            if (flypast%found == most_minima) exit
         end if
         if (present(steps)) then
            if (flypast%found == 1 .and. count == 0) call keep(passed_step_t(times(1), states(:, 1), times(2) - times(1)))
            if (flypast%found == 1 .or. (flypast%found == 2 .and. .not. passed)) call keep(passed_step_t(t, g, taken))
            passed = flypast%found > 1
         end if
         t = t + taken
         g = next
         step = next_step(taken, gap)
         if (t > last) exit
      end do
      flypast%ok = flypast%found == most_minima .or. t > last
      if (present(steps)) steps = steps(:count)

   contains

      !> Append a step to `steps`, which doubles where it is full.
      subroutine keep(passed_step)
         type(passed_step_t), intent(in) :: passed_step
         type(passed_step_t), allocatable :: longer(:)

         if (count == size(steps)) then
            allocate (longer(max(64, 2*count)))
            longer(:count) = steps
            call move_alloc(longer, steps)
         end if
         count = count + 1
         steps(count) = passed_step
      end subroutine keep

      !> Lag without swinging: a'' = 0 at a' = 0, the root near zero by damped Newton's method.
      pure real(wp) function quiet_lag() result(angle)
         real(wp), parameter :: longest = 0.2_wp, small = 1.0e-6_wp
         real(wp) :: slope, move
         integer :: k

         angle = 0.0_wp
         do k = 1, 200
            move = acceleration(angle)
            slope = (acceleration(angle + small) - move)/small
            if (abs(slope) <= tiny(slope)) return
            move = -move/slope
            move = sign(min(abs(move), longest), move)
            angle = angle + move
            if (abs(move) < 1.0e-13_wp) return
         end do
      end function quiet_lag

      !> a'' at a' = 0.
      pure real(wp) function acceleration(angle)
         real(wp), intent(in) :: angle
         real(wp) :: d(2), q

         q = 1.0_wp + t*t
         d = contact%slopes(t, [atan(t) - angle, 1.0_wp/q])
         acceleration = -2.0_wp*t/q**2 - d(2)
      end function acceleration

      !> T, g, g' where the force passes zero within a step, by bisection.
      function loss_between(time, start, h) result(place)
         real(wp), intent(in) :: time, start(2), h
         real(wp) :: place(3), low, high, middle, state(2)

         low = 0.0_wp
         high = h
         do while (high - low > located*max(1.0_wp, abs(time)))
            middle = 0.5_wp*(low + high)
            call one_step(contact, time, start, middle, state)
            if (contact%force(time + middle, state) < 0.0_wp) then
               high = middle
            else
               low = middle
            end if
         end do
         call one_step(contact, time, start, low, state)
         place = [time + low, state]
      end function loss_between

      !> Least force within two steps, by the golden section.
      real(wp) function least_within(h) result(least)
         real(wp), intent(in) :: h
         real(wp), parameter :: ratio = 0.5_wp*(sqrt(5.0_wp) - 1.0_wp)
         real(wp) :: low, high, x1, x2, f1, f2
         integer :: k

         low = 0.0_wp
         high = h
         x1 = high - ratio*(high - low)
         x2 = low + ratio*(high - low)
         f1 = force_after(x1)
         f2 = force_after(x2)
         do k = 1, 24
            if (f1 < f2) then
               high = x2
               x2 = x1
               f2 = f1
               x1 = high - ratio*(high - low)
               f1 = force_after(x1)
            else
               low = x1
               x1 = x2
               f1 = f2
               x2 = low + ratio*(high - low)
               f2 = force_after(x2)
            end if
         end do
         least = min(f1, f2)
      end function least_within

      real(wp) function force_after(h)
         real(wp), intent(in) :: h
         real(wp) :: state(2)

         call one_step(contact, times(1), states(:, 1), h, state)
         force_after = contact%force(times(1) + h, state)
      end function force_after
   end function follow_flypast

   !> Flight from the place where contact was lost to the first impact. Errors: `ok` false if no impact follows.
   !>
   !> The pin's path is a cubic in the time d. At the loss the distance to the wall and its first two derivatives vanish, so that of
   !> the sextic u**2 + v**2 = 1 a cubic is left, whose least positive root is the impact.
   pure function fly(h1, h2, h3, loss) result(flight)
      real(wp), intent(in) :: h1, h2, h3
      real(wp), intent(in) :: loss(3)               !! T, g, g'
      type(flight_t) :: flight
      real(wp) :: u(0:3), v(0:3), c(3:6), k, angle, turning, d, vu, vv

      angle = loss(2)
      turning = loss(3)
      k = h1**3/(1.0_wp - h3**2)
      u = [cos(angle), -turning*sin(angle), 0.5_wp*k*(1.0_wp + h3*cos(h2) - loss(1)*h3*sin(h2)), -k*h3*sin(h2)/6.0_wp]
      v = [sin(angle), turning*cos(angle), 0.5_wp*k*(-h3*sin(h2) + loss(1)*(1.0_wp - h3*cos(h2))), &
           k*(1.0_wp - h3*cos(h2))/6.0_wp]
      c(3) = 2.0_wp*(u(0)*u(3) + u(1)*u(2) + v(0)*v(3) + v(1)*v(2))
      c(4) = u(2)**2 + 2.0_wp*u(1)*u(3) + v(2)**2 + 2.0_wp*v(1)*v(3)
      c(5) = 2.0_wp*(u(2)*u(3) + v(2)*v(3))
      c(6) = u(3)**2 + v(3)**2
      d = least_positive_root(c)
      if (.not. d > 0.0_wp) return
      vu = u(1) + d*(2.0_wp*u(2) + d*3.0_wp*u(3))
      vv = v(1) + d*(2.0_wp*v(2) + d*3.0_wp*v(3))
      flight%duration = d
      flight%angle = atan2(v(0) + d*(v(1) + d*(v(2) + d*v(3))), u(0) + d*(u(1) + d*(u(2) + d*u(3))))
      flight%across = vu*cos(flight%angle) + vv*sin(flight%angle)
      flight%along = vv*cos(flight%angle) - vu*sin(flight%angle)
      flight%index = (1.0_wp - h3**2)*flight%across/(1.0_wp + h3*cos(h2 + 2.0_wp*flight%angle))
      flight%ok = .true.
   end function fly

   !> Of c(3) + c(4) d + c(5) d**2 + c(6) d**3, c(6) > 0; 0 if there is none. Between the turning points the cubic is monotone.
   pure real(wp) function least_positive_root(c) result(root)
      real(wp), intent(in) :: c(3:6)
      real(wp) :: ends(4), half, square, bound
      integer :: i

      root = 0.0_wp
      if (.not. c(6) > 0.0_wp) return
      bound = 1.0_wp + maxval(abs(c(3:5)))/c(6) ! Cauchy's
      half = -c(5)/(3.0_wp*c(6))
      square = half*half - c(4)/(3.0_wp*c(6))
      ends = [0.0_wp, bound, bound, bound]
      if (square > 0.0_wp) then
         ends(2) = min(bound, max(0.0_wp, half - sqrt(square)))
         ends(3) = min(bound, max(0.0_wp, half + sqrt(square)))
      end if
      do i = 1, 3
         if (ends(i + 1) <= ends(i)) cycle
         if (value_at(ends(i))*value_at(ends(i + 1)) > 0.0_wp) cycle
         root = root_between(ends(i), ends(i + 1))
         if (root > 0.0_wp) return
      end do

   contains

      pure real(wp) function value_at(d)
         real(wp), intent(in) :: d

         value_at = c(3) + d*(c(4) + d*(c(5) + d*c(6)))
      end function value_at

      pure real(wp) function root_between(from, to) result(middle)
         real(wp), intent(in) :: from, to
         real(wp) :: low, high
         integer :: k

         low = from
         high = to
         do k = 1, digits(1.0_wp) + 12
            middle = 0.5_wp*(low + high)
            if (value_at(middle)*value_at(from) > 0.0_wp .or. (middle <= from)) then
               low = middle
            else
               high = middle
            end if
         end do
         middle = 0.5_wp*(low + high)
      end function root_between
   end function least_positive_root

end module psalm_flypast
