!> The pulse of force with which a pin goes through the passage where contact is kept: between the first and the second minimum of
!> the force of contact, of either sign (Haines, 9B, "impulse prediction"). Its height, width, growth and decay, its impulse, and
!> what it does to links that are elastic (its shock spectrum). Forces are parts of the least load R_u, times those of T.
module psalm_contact_pulse
   use psalm_flypast, only: passing_contact_t, passed_step_t
   use psalm_kinds, only: wp
   use psalm_ode, only: one_step
   use psalm_sort, only: ascending
   implicit none (type, external)
   private
   public :: contact_pulse_t, pulse_shape_t, find_pulse, shock_of

   integer, parameter :: within = 16             !! places in a step of the integration; cubics between them
   integer, parameter :: halvings = 48           !! of a place
   real(wp), parameter :: small_angle = 0.5_wp   !! rad, below which a series has no differences
   integer, parameter :: sine_terms = 16         !! its last power: the next is below 1E-18 of the first
   integer, parameter :: parts = 1024            !! of a pulse where its shape is taken

   type :: contact_pulse_t
      logical :: known = .false.                 !! two minima were found
      real(wp) :: at = 0.0_wp                    !! T of the greatest force
      real(wp) :: force = 0.0_wp                 !! the greatest force
      real(wp) :: height = 0.0_wp                !! the same above the greater one of both minima
      real(wp) :: width = 0.0_wp                 !! between the places at half the height
      real(wp) :: growth = 0.0_wp, decay = 0.0_wp !! greatest rates before and after the greatest force, both positive
      real(wp) :: impulse = 0.0_wp               !! of the force above the greater minimum
   end type contact_pulse_t

   !> The force above the greater minimum, while it is above.
   type :: pulse_shape_t
      real(wp), allocatable :: time(:), above(:) !! shape (places)
   end type pulse_shape_t

contains

   !> The pulse of a flypast that was followed. Not `known` with fewer than two minima.
   subroutine find_pulse(contact, steps, pulse, shape)
      type(passing_contact_t), intent(inout) :: contact !! its integration writes nothing that counts
      type(passed_step_t), intent(in) :: steps(:) !! from before the first minimum to after the second
      type(contact_pulse_t), intent(out) :: pulse
      type(pulse_shape_t), intent(out) :: shape
      real(wp) :: time(within*size(steps) + 1), force(within*size(steps) + 1), rate(within*size(steps) + 1)
      real(wp), allocatable :: known(:)
      real(wp) :: base, ends(2)
      integer, allocatable :: order(:)
      integer :: k, n, s, turns(3), found

      n = size(time)
      if (size(steps) == 0) return
      do s = 1, size(steps)
         do k = 1, within
            call look(s, steps(s)%length*real(k - 1, wp)/real(within, wp), time(within*(s - 1) + k), force(within*(s - 1) + k), &
                      rate(within*(s - 1) + k))
         end do
      end do
      call look(size(steps), steps(size(steps))%length, time(n), force(n), rate(n))
      ! a minimum, the greatest force, the next minimum: where the rate changes its sign
      found = 0
      do k = 1, n - 1
         if (modulo(found, 2) == 0) then
            if (.not. (rate(k) < 0.0_wp .and. rate(k + 1) >= 0.0_wp)) cycle
         else
            if (.not. (rate(k) > 0.0_wp .and. rate(k + 1) <= 0.0_wp)) cycle
         end if
         found = found + 1
         turns(found) = k
         if (found == size(turns)) exit
      end do
      if (found < size(turns)) return
      pulse%known = .true.
      pulse%at = turning_in(turns(2))
      pulse%force = force_at(pulse%at)
      ends = [turning_in(turns(1)), turning_in(turns(3))]
      base = max(force_at(ends(1)), force_at(ends(2)))
      pulse%height = pulse%force - base
      pulse%width = crossing(base + 0.5_wp*pulse%height, pulse%at, ends(2)) - &
                    crossing(base + 0.5_wp*pulse%height, pulse%at, ends(1))
      pulse%growth = steepest(turns(1) + 1, turns(2), 1.0_wp)
      pulse%decay = steepest(turns(2) + 1, turns(3), -1.0_wp)
      ends = [crossing(base, pulse%at, ends(1)), crossing(base, pulse%at, ends(2))]
      ! equal steps, and the places above, which lie close where the force changes fast
      shape%time = [(ends(1) + (ends(2) - ends(1))*real(k, wp)/real(parts, wp), k=0, parts), &
                    pack(time, time > ends(1) .and. time < ends(2))]
      known = [(force_at(shape%time(k)), k=1, parts + 1), pack(force, time > ends(1) .and. time < ends(2))]
      order = ascending(shape%time)
      shape%time = shape%time(order)
      shape%above = max(0.0_wp, known(order) - base)
      do k = 1, size(shape%time) - 1
         pulse%impulse = pulse%impulse + 0.5_wp*(shape%time(k + 1) - shape%time(k))*(shape%above(k) + shape%above(k + 1))
      end do

   contains

      !> Time, force and its rate some way into a step.
      subroutine look(step, way, t, f, r)
         integer, intent(in) :: step
         real(wp), intent(in) :: way
         real(wp), intent(out) :: t, f, r
         real(wp) :: state(2)

         call one_step(contact, steps(step)%time, steps(step)%state, way, state)
         t = steps(step)%time + way
         f = contact%force(t, state)
         r = contact%rate(t, state)
      end subroutine look

      !> Force and rate by the cubic between two places that has both at its ends.
      pure subroutine look_at(t, f, r)
         real(wp), intent(in) :: t
         real(wp), intent(out) :: f, r
         real(wp) :: length, s, slope
         integer :: step, k

         step = max(1, count(steps%time <= t))
         k = within*(step - 1) + 1 + max(0, min(within - 1, int(real(within, wp)*(t - steps(step)%time)/steps(step)%length)))
         length = time(k + 1) - time(k)
         s = (t - time(k))/length
         slope = (force(k + 1) - force(k))/length
         f = force(k) + length*s*(rate(k) + s*(3.0_wp*slope - 2.0_wp*rate(k) - rate(k + 1) &
                                               + s*(rate(k) + rate(k + 1) - 2.0_wp*slope)))
         r = rate(k) + s*(2.0_wp*(3.0_wp*slope - 2.0_wp*rate(k) - rate(k + 1)) + s*3.0_wp*(rate(k) + rate(k + 1) - 2.0_wp*slope))
      end subroutine look_at

      pure real(wp) function force_at(t) result(f)
         real(wp), intent(in) :: t
         real(wp) :: unused

         call look_at(t, f, unused)
      end function force_at

      !> Where the rate is zero between a place and the next.
      pure real(wp) function turning_in(k) result(middle)
         integer, intent(in) :: k
         real(wp) :: low, high, f, r
         integer :: i

         low = time(k)
         high = time(k + 1)
         do i = 1, halvings
            middle = 0.5_wp*(low + high)
            call look_at(middle, f, r)
            if (r*rate(k) > 0.0_wp) then
               low = middle
            else
               high = middle
            end if
         end do
         middle = 0.5_wp*(low + high)
      end function turning_in

      !> Where the force falls to a level on the way from its greatest to a minimum.
      pure real(wp) function crossing(level, from, to) result(middle)
         real(wp), intent(in) :: level, from, to
         real(wp) :: high, low
         integer :: i

         high = from
         low = to
         do i = 1, halvings
            middle = 0.5_wp*(low + high)
            if (force_at(middle) > level) then
               high = middle
            else
               low = middle
            end if
         end do
         middle = 0.5_wp*(low + high)
      end function crossing

      !> Greatest rate of a sign among places, by the parabola through the largest and its neighbours.
      pure real(wp) function steepest(first, last, sense) result(greatest)
         integer, intent(in) :: first, last
         real(wp), intent(in) :: sense
         real(wp) :: left, right, before, after
         integer :: i

         greatest = 0.0_wp
         if (last < first) return
         i = first - 1 + maxloc(sense*rate(first:last), dim=1)
         greatest = sense*rate(i)
         if (i == 1 .or. i == n) return
         before = time(i) - time(i - 1)
         after = time(i + 1) - time(i)
         left = (greatest - sense*rate(i - 1))/before
         right = (sense*rate(i + 1) - greatest)/after
         ! the parabola's slope at the place, and its bend
         associate (slope => (left*after + right*before)/(before + after), bend => (right - left)/(before + after))
            if (bend < 0.0_wp) greatest = greatest - 0.25_wp*slope**2/bend
         end associate
      end function steepest
   end subroutine find_pulse

   !> Greatest deflection of an undamped elastic system that the pulse meets at rest, over the static one of its height: the shock
   !> spectrum at a frequency. Between the places of the pulse the force is taken to grow in a straight line, where the motion is
   !> known exactly.
   pure real(wp) function shock_of(shape, frequency) result(greatest)
      type(pulse_shape_t), intent(in) :: shape   !! of a pulse that is known
      real(wp), intent(in) :: frequency          !! rad per unit of T
      real(wp) :: x, v, before, turned, growth, half, c, s, late
      integer :: k

      ! the deflection over that by a force of 1 at rest, and its rate over the frequency
      x = 0.0_wp
      v = 0.0_wp
      greatest = 0.0_wp
      do k = 1, size(shape%time) - 1
         turned = frequency*(shape%time(k + 1) - shape%time(k))
         if (.not. turned > 0.0_wp) cycle
         growth = shape%above(k + 1) - shape%above(k)
         c = cos(turned)
         s = sin(turned)
         half = sin(0.5_wp*turned)
         late = sine_below(turned)
         before = x
         ! free motion, the force as it was, and its growth; without differences, which are lost at a low frequency
         x = before*c + v*s + 2.0_wp*half**2*shape%above(k) + late*growth
         v = v*c - before*s + s*shape%above(k) + (half/(0.5_wp*turned))*half*growth
         greatest = max(greatest, abs(x))
      end do
      greatest = max(greatest, sqrt(x**2 + v**2))
      if (maxval(shape%above) > 0.0_wp) greatest = greatest/maxval(shape%above)
   end function shock_of

   !> 1 - sin(a)/a, by its series where a is small.
   elemental real(wp) function sine_below(a)
      real(wp), intent(in) :: a                  !! radians, not 0
      real(wp) :: term
      integer :: n

      if (abs(a) > small_angle) then
         sine_below = 1.0_wp - sin(a)/a
         return
      end if
      term = a**2/6.0_wp
      sine_below = term
      do n = 4, sine_terms, 2
         term = -term*a**2/real(n*(n + 1), wp)
         sine_below = sine_below + term
      end do
   end function sine_below
end module psalm_contact_pulse
