!> The pin in contact with its hole, followed through a turn of the crank: Haines, chapter 3 (the following mode).
!>
!> The pin stands at the angle g in its hole; the lag behind the load without clearance is a = g* - g. The equation is written for
!> g and the components of the load, which may pass through zero. Time is in radians of the crank's mean turning.
module psalm_following
   use psalm_kinds, only: wp, pi
   use psalm_ode, only: smooth_ode_t, one_step, advance, next_step
   use psalm_periodic, only: periodic_t
   implicit none (type, external)
   private
   public :: followed_contact_t, contact_of, follow_contact, least_force_t

   integer, parameter :: places = 2048               !! of the interpolation in a turn
   real(wp), parameter :: tolerance = 1.0e-10_wp     !! of a step, radians
   real(wp), parameter :: shortest = 1.0e-12_wp      !! step, radians of the crank
   real(wp), parameter :: nothing = 1.0e-9_wp        !! a load below this part of the greatest has no direction to begin with

   !> The equation of the angle g.
   type, extends(smooth_ode_t) :: followed_contact_t
      real(wp) :: speed = 0.0_wp                     !! rad/s
      real(wp) :: clearance = 0.0_wp                 !! radial, m
      real(wp), allocatable :: load(:, :, :)         !! shape (0:2, 2, 0:places): x and y of the load with two derivatives, N
      real(wp), allocatable :: tensor(:, :, :)       !! shape (0:1, 3, 0:places): M_uu, M_uv, M_vv with one
   contains
      procedure :: slopes
      procedure :: force
      procedure, private :: state_of
   end type followed_contact_t

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
      type(followed_contact_t) :: contact
      type(periodic_t) :: derived
      integer :: c, k

      contact%tolerance = tolerance
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

   !> (g, g')' by the angle of the crank.
   pure function slopes(self, time, y) result(d)
      class(followed_contact_t), intent(in) :: self
      real(wp), intent(in) :: time, y(:)
      real(wp) :: d(size(y)), load(0:2, 2), m(3), unit(2), along, across

      call self%state_of(time, load, m)
      unit = [cos(y(1)), sin(y(1))]
      call felt(m, unit, along, across)
      d(1) = y(2)
      d(2) = ((load(0, 2)*unit(1) - load(0, 1)*unit(2))/(self%clearance*self%speed**2) - across*y(2)**2)/along
   end function slopes

   !> Force of contact, N; below zero contact would be lost.
   pure real(wp) function force(self, time, y)
      class(followed_contact_t), intent(in) :: self
      real(wp), intent(in) :: time, y(2)
      real(wp) :: d(2), load(0:2, 2), m(3), unit(2), along, across

      call self%state_of(time, load, m)
      unit = [cos(y(1)), sin(y(1))]
      call felt(m, unit, along, across)
      d = self%slopes(time, y)
      force = load(0, 1)*unit(1) + load(0, 2)*unit(2) &
              + self%clearance*self%speed**2*((m(1) + m(3) - along)*y(2)**2 + across*d(2))
   end function force

   !> Inertia against motion along the wall of the hole, and its product with that across: M0 (1 + eps cos P), M0 eps sin P.
   pure subroutine felt(m, unit, along, across)
      real(wp), intent(in) :: m(3), unit(2)       !! tensor; direction of the pin in its hole
      real(wp), intent(out) :: along, across

      along = m(1)*unit(2)**2 - 2.0_wp*m(2)*unit(1)*unit(2) + m(3)*unit(1)**2
      across = (m(1) - m(3))*unit(1)*unit(2) - m(2)*(unit(1)**2 - unit(2)**2)
   end subroutine felt

   !> Load with two derivatives by the angle of the crank, and tensor.
   pure subroutine state_of(self, time, load, m)
      class(followed_contact_t), intent(in) :: self
      real(wp), intent(in) :: time
      real(wp), intent(out) :: load(0:2, 2), m(3)
      real(wp) :: place, s, h
      integer :: k, c

      h = 2.0_wp*pi/real(places, wp)
      place = modulo(time, 2.0_wp*pi)/h
      k = min(int(place), places - 1)
      s = place - real(k, wp)
      do c = 1, 2
         load(:, c) = quintic(self%load(:, c, k), self%load(:, c, k + 1), s, h)
      end do
      do c = 1, 3
         m(c) = cubic(self%tensor(:, c, k), self%tensor(:, c, k + 1), s, h)
      end do
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

   !> Follow a turn from a = a' = 0, force or no force. Errors: `ok` false if the load is zero where it begins, or steps become too
   !> short.
   subroutine follow_contact(contact, from, inputs, lag, force, minima, loss, ok)
      type(followed_contact_t), intent(inout) :: contact
      real(wp), intent(in) :: from                   !! where to begin, radians
      integer, intent(in) :: inputs                  !! places wanted, at equal steps from `from`
      real(wp), intent(out) :: lag(:), force(:)      !! shape (inputs): radians, within half a turn; N
      type(least_force_t), allocatable, intent(out) :: minima(:) !! of the force, in their order
      real(wp), intent(out) :: loss                  !! radians: where the force becomes negative first; negative: nowhere
      logical, intent(out) :: ok
      real(wp) :: t, target, y(2), next(2), wanted, taken, gap, forces(3), before(2), times(3), load(0:2, 2), m(3)
      integer :: i

      allocate (minima(0))
      t = from
      call contact%state_of(t, load, m)
      lag = 0.0_wp
      force = 0.0_wp
      loss = -1.0_wp
      ok = norm2(load(0, :)) > nothing*maxval(abs(contact%load(0, :, :)))
      if (.not. ok) return
      y = [atan2(load(0, 2), load(0, 1)), &
           (load(0, 1)*load(1, 2) - load(0, 2)*load(1, 1))/(load(0, 1)**2 + load(0, 2)**2)]
      wanted = 1.0e-4_wp
      forces = contact%force(t, y)
      times = t
      before = y
      do i = 1, inputs
         lag(i) = lag_now()
         force(i) = contact%force(t, y)
         target = from + 2.0_wp*pi*real(i, wp)/real(inputs, wp)
         do while (t < target - shortest)
            wanted = min(wanted, 0.1_wp*swing(), target - t)
            call advance(contact, t, y, wanted, shortest, next, taken, gap)
            ok = taken > shortest
            if (.not. ok) return
            if (loss < 0.0_wp .and. contact%force(t + taken, next) < 0.0_wp) loss = zero_between(t, y, taken)
            before = y
            times = [times(2:), t + taken]
            forces = [forces(2:), contact%force(t + taken, next)]
            if (forces(2) < forces(1) .and. forces(2) <= forces(3)) call note_minimum()
            t = t + taken
            y = next
            wanted = next_step(taken, gap)
         end do
      end do

   contains

      !> Angle from the pin to the load.
      pure real(wp) function lag_now() result(angle)
         real(wp) :: load(0:2, 2), m(3), c, s

         call contact%state_of(t, load, m)
         c = cos(y(1))
         s = sin(y(1))
         angle = 0.0_wp
         if (any(abs(load(0, :)) > 0.0_wp)) &
            angle = atan2(load(0, 2)*c - load(0, 1)*s, load(0, 1)*c + load(0, 2)*s)
      end function lag_now

      !> Period of the lag's swinging, or of the pin's turning, about.
      pure real(wp) function swing()
         real(wp) :: load(0:2, 2), m(3), least

         call contact%state_of(t, load, m)
         least = 0.5_wp*(m(1) + m(3) - hypot(m(3) - m(1), 2.0_wp*m(2)))
         swing = 2.0_wp*pi/sqrt(norm2(load(0, :))/(contact%clearance*least*contact%speed**2) + y(2)**2 + 1.0_wp)
      end function swing

      real(wp) function zero_between(time, start, h) result(place)
         real(wp), intent(in) :: time, start(2), h
         real(wp) :: low, high, middle, state(2)

         low = 0.0_wp
         high = h
         do while (high - low > shortest)
            middle = 0.5_wp*(low + high)
            call one_step(contact, time, start, middle, state)
            if (contact%force(time + middle, state) < 0.0_wp) then
               high = middle
            else
               low = middle
            end if
         end do
         place = time + low
      end function zero_between

      !> Of the last three forces the middle one is the least: the place between them where the force has no slope.
      subroutine note_minimum()
         real(wp), parameter :: part = 1.0e-3_wp       ! of the steps, for differences of fourth order
         real(wp) :: low, high, middle, h

         ! `before` is the state at the middle one
         low = times(1) - times(2)
         high = times(3) - times(2)
         h = part*(high - low)
         do while (high - low > shortest)
            middle = 0.5_wp*(low + high)
            if (8.0_wp*(force_beside(middle + h) - force_beside(middle - h)) &
                < force_beside(middle + 2.0_wp*h) - force_beside(middle - 2.0_wp*h)) then
               low = middle
            else
               high = middle
            end if
         end do
         minima = [minima, least_force_t(times(2) + low, force_beside(low))]
      end subroutine note_minimum

      real(wp) function force_beside(step)
         real(wp), intent(in) :: step
         real(wp) :: state(2)

         call one_step(contact, times(2), before, step, state)
         force_beside = contact%force(times(2) + step, state)
      end function force_beside
   end subroutine follow_contact
end module psalm_following
