!> The pin in contact with its hole, followed through a turn of the crank: Haines, chapter 3 (the following mode).
!>
!> The pin stands at the angle g* - a in its hole, g* the angle of the load without clearance, a the lag. Time is the angle of the
!> crank; the load is interpolated by its components, so that it may pass through zero.
module psalm_following
   use psalm_kinds, only: wp, pi
   use psalm_ode, only: ode_t, one_step, advance, next_step
   use psalm_periodic, only: periodic_t
   implicit none (type, external)
   private
   public :: contact_t, contact_of, follow_contact, least_force_t

   integer, parameter :: places = 2048               !! of the interpolation in a turn
   real(wp), parameter :: tolerance = 1.0e-10_wp     !! of a step, radians
   real(wp), parameter :: shortest = 1.0e-12_wp      !! step, radians of the crank

   !> The equation of the lag.
   type, extends(ode_t) :: contact_t
      real(wp) :: speed = 0.0_wp                     !! rad/s
      real(wp) :: clearance = 0.0_wp                 !! radial, m
      real(wp), allocatable :: load(:, :, :)         !! shape (0:2, 2, 0:places): x and y of the load with two derivatives
      real(wp), allocatable :: tensor(:, :, :)       !! shape (0:1, 3, 0:places): M_uu, M_uv, M_vv with one
   contains
      procedure :: rates
      procedure :: force
      procedure, private :: state_of
   end type contact_t

   type :: least_force_t
      real(wp) :: input = 0.0_wp                     !! radians from the reference position, in the sense of turning
      real(wp) :: force = 0.0_wp                     !! N
   end type least_force_t

contains

   !> The equation of a joint from its load and inertia over a turn.
   pure function contact_of(load, tensor, speed, clearance) result(contact)
      type(periodic_t), intent(in) :: load(2)        !! N
      type(periodic_t), intent(in) :: tensor(3)      !! kg
      real(wp), intent(in) :: speed                  !! rad/s, positive
      real(wp), intent(in) :: clearance              !! radial, m, positive
      type(contact_t) :: contact
      type(periodic_t) :: derived
      integer :: c, k

      contact%speed = speed
      contact%clearance = clearance
      allocate (contact%load(0:2, 2, 0:places), contact%tensor(0:1, 3, 0:places))
      do c = 1, 2
         do k = 0, 2
            derived = load(c)%derivative(k)
            contact%load(k, c, 0:places - 1) = derived%values(places)
         end do
      end do
      do c = 1, 3
         do k = 0, 1
            derived = tensor(c)%derivative(k)
            contact%tensor(k, c, 0:places - 1) = derived%values(places)
         end do
      end do
      contact%load(:, :, places) = contact%load(:, :, 0)
      contact%tensor(:, :, places) = contact%tensor(:, :, 0)
   end function contact_of

   !> (a, a')' by the angle of the crank.
   pure function rates(self, time, y) result(d)
      class(contact_t), intent(in) :: self
      real(wp), intent(in) :: time, y(2)
      real(wp) :: d(2), amount, turn(2), mass, eps, p

      call self%state_of(time, y(1), amount, turn, mass, eps, p)
      d(1) = y(2)
      d(2) = turn(2) + (eps*(y(2) - turn(1))**2*sin(p) - amount*sin(y(1))/(self%clearance*mass*self%speed**2))/(1.0_wp + eps*cos(p))
   end function rates

   !> Force of contact, N; below zero contact would be lost.
   pure real(wp) function force(self, time, y)
      class(contact_t), intent(in) :: self
      real(wp), intent(in) :: time, y(2)
      real(wp) :: d(2), amount, turn(2), mass, eps, p

      call self%state_of(time, y(1), amount, turn, mass, eps, p)
      d = self%rates(time, y)
      force = amount*cos(y(1)) + self%clearance*mass*self%speed**2*((1.0_wp - eps*cos(p))*(turn(1) - y(2))**2 &
                                                                    + eps*sin(p)*(turn(2) - d(2)))
   end function force

   !> Amount of the load, first and second derivative of its angle, mean inertia, its difference and the angle P.
   pure subroutine state_of(self, time, lag, amount, turn, mass, eps, p)
      class(contact_t), intent(in) :: self
      real(wp), intent(in) :: time, lag
      real(wp), intent(out) :: amount, turn(2), mass, eps, p
      real(wp) :: x(0:2), y(0:2), m(3), place, s, h, square
      integer :: k, c

      h = 2.0_wp*pi/real(places, wp)
      place = modulo(time, 2.0_wp*pi)/h
      k = min(int(place), places - 1)
      s = place - real(k, wp)
      x = quintic(self%load(:, 1, k), self%load(:, 1, k + 1), s, h)
      y = quintic(self%load(:, 2, k), self%load(:, 2, k + 1), s, h)
      do c = 1, 3
         m(c) = cubic(self%tensor(:, c, k), self%tensor(:, c, k + 1), s, h)
      end do
      square = x(0)**2 + y(0)**2
      amount = sqrt(square)
      turn(1) = (x(0)*y(1) - y(0)*x(1))/square
      turn(2) = (x(0)*y(2) - y(0)*x(2))/square - 2.0_wp*turn(1)*(x(0)*x(1) + y(0)*y(1))/square
      mass = 0.5_wp*(m(1) + m(3))
      eps = hypot(0.5_wp*(m(3) - m(1)), m(2))/mass
      p = 2.0_wp*lag - 2.0_wp*atan2(y(0), x(0)) - atan2(2.0_wp*m(2), m(3) - m(1))
   end subroutine state_of

   !> Value and two derivatives of the polynomial through both ends with two derivatives each, at part s of the step h.
   pure function quintic(a, b, s, h) result(f)
      real(wp), intent(in) :: a(0:2), b(0:2), s, h
      real(wp) :: f(0:2), c(0:5), d(3)

      c(0:2) = [a(0), a(1)*h, 0.5_wp*a(2)*h*h]
      d = [b(0) - c(0) - c(1) - c(2), b(1)*h - c(1) - 2.0_wp*c(2), b(2)*h*h - 2.0_wp*c(2)]
      c(3) = 10.0_wp*d(1) - 4.0_wp*d(2) + 0.5_wp*d(3)
      c(4) = -15.0_wp*d(1) + 7.0_wp*d(2) - d(3)
      c(5) = 6.0_wp*d(1) - 3.0_wp*d(2) + 0.5_wp*d(3)
      f(0) = c(0) + s*(c(1) + s*(c(2) + s*(c(3) + s*(c(4) + s*c(5)))))
      f(1) = (c(1) + s*(2.0_wp*c(2) + s*(3.0_wp*c(3) + s*(4.0_wp*c(4) + s*5.0_wp*c(5)))))/h
      f(2) = (2.0_wp*c(2) + s*(6.0_wp*c(3) + s*(12.0_wp*c(4) + s*20.0_wp*c(5))))/h**2
   end function quintic

   pure real(wp) function cubic(a, b, s, h) result(f)
      real(wp), intent(in) :: a(0:1), b(0:1), s, h
      real(wp) :: rise

      rise = b(0) - a(0)
      f = a(0) + s*(a(1)*h + s*(3.0_wp*rise - (2.0_wp*a(1) + b(1))*h + s*(-2.0_wp*rise + (a(1) + b(1))*h)))
   end function cubic

   !> Follow a turn from a = a' = 0, force or no force. Errors: `ok` false if steps become too short, as where the load is zero.
   subroutine follow_contact(contact, from, inputs, lag, force, minima, loss, ok)
      type(contact_t), intent(in) :: contact
      real(wp), intent(in) :: from                   !! where to begin, radians
      integer, intent(in) :: inputs                  !! places told, at equal steps from `from`
      real(wp), intent(out) :: lag(:), force(:)      !! shape (inputs): radians, N
      type(least_force_t), allocatable, intent(out) :: minima(:) !! of the force, in their order
      real(wp), intent(out) :: loss                  !! radians: where the force becomes negative first; negative: nowhere
      logical, intent(out) :: ok
      real(wp) :: t, target, y(2), next(2), wanted, taken, gap, forces(3), starts(2, 2), times(3)
      integer :: i

      allocate (minima(0))
      t = from
      y = 0.0_wp
      wanted = 1.0e-4_wp
      loss = -1.0_wp
      forces = contact%force(t, y)
      times = t
      starts = 0.0_wp
      ok = .true.
      do i = 1, inputs
         lag(i) = y(1)
         force(i) = contact%force(t, y)
         target = from + 2.0_wp*pi*real(i, wp)/real(inputs, wp)
         do while (t < target - shortest)
            wanted = min(wanted, 0.1_wp*swing(), target - t)
            call advance(contact, t, y, wanted, tolerance, shortest, next, taken, gap)
            ok = taken > shortest
            if (.not. ok) then
               lag(i:) = y(1)
               force(i:) = 0.0_wp
               return
            end if
            if (loss < 0.0_wp .and. contact%force(t + taken, next) < 0.0_wp) loss = zero_between(t, y, taken)
            starts(:, 1) = starts(:, 2)
            starts(:, 2) = y
            times = [times(2:), t + taken]
            forces = [forces(2:), contact%force(t + taken, next)]
            if (forces(2) < forces(1) .and. forces(2) <= forces(3)) call note_minimum()
            t = t + taken
            y = next
            wanted = next_step(taken, gap, tolerance)
         end do
      end do

   contains

      !> A part of the period of the lag's swinging.
      pure real(wp) function swing()
         real(wp) :: amount, turn(2), mass, eps, p

         call contact%state_of(t, y(1), amount, turn, mass, eps, p)
         swing = 2.0_wp*pi/sqrt(amount/(contact%clearance*mass*contact%speed**2*(1.0_wp - eps)) + turn(1)**2 + 1.0_wp)
      end function swing

      pure real(wp) function zero_between(time, start, h) result(place)
         real(wp), intent(in) :: time, start(2), h
         real(wp) :: low, high, middle, state(2), unused

         low = 0.0_wp
         high = h
         do while (high - low > shortest)
            middle = 0.5_wp*(low + high)
            call one_step(contact, time, start, middle, state, unused)
            if (contact%force(time + middle, state) < 0.0_wp) then
               high = middle
            else
               low = middle
            end if
         end do
         place = time + low
      end function zero_between

      !> Of the last three forces the middle one is the least: refine by the parabola through them.
      subroutine note_minimum()
         real(wp) :: a, b, s, place, state(2), unused

         a = (forces(2) - forces(1))/(times(2) - times(1))
         b = ((forces(3) - forces(2))/(times(3) - times(2)) - a)/(times(3) - times(1))
         s = 0.5_wp*(times(1) + times(2)) - a/(2.0_wp*b)
         if (.not. (s > times(1) .and. s < times(3))) s = times(2)
         place = s
         if (place < times(2)) then
            call one_step(contact, times(1), starts(:, 1), place - times(1), state, unused)
         else
            call one_step(contact, times(2), starts(:, 2), place - times(2), state, unused)
         end if
         minima = [minima, least_force_t(place, contact%force(place, state))]
      end subroutine note_minimum
   end subroutine follow_contact
end module psalm_following
