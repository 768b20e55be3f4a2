!> How the crank of a machine turns over a turn: at constant speed, or at one that varies with its angle and is the same in every
!> turn (Haines, 2I). Studies of a steady state look at equal steps of time: the places of the crank, its speed and its acceleration
!> there are from here.
!>
!> x is the time in radians of the mean turning, phi the angle from the reference position in the sense of turning. With the
!> speed w(phi) and its mean over time W, x'(phi) = W/w(phi): x(phi) is the integral of a Fourier series, its inverse is found by
!> Newton's method. phi' = w/W, phi'' = (w/W) d(w/W)/dphi, a dash being d/dx.
module psalm_crank_motion
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, pi, degrees_per_radian, full_turn, radians_per_degree
   use psalm_kinetostatics, only: forces_t, move_bodies
   use psalm_mechanism, only: body_frame
   use psalm_periodic, only: periodic_t, periodic_from_samples
   use psalm_rates, only: rates_t
   implicit none (type, external)
   private
   public :: crank_motion_t, constant_motion, varying_motion, positive_between, can_be_followed, move_in_turn

   integer, parameter :: fewest_samples = 1024, most_samples = 8192 !! of the slowness over a turn
   real(wp), parameter :: followed = 1.0e-8_wp   !! resolution of the slowness with which the time is known
   integer, parameter :: per_value = 2           !! samples for each speed that is given, at least
   integer, parameter :: most_iterations = 60    !! of Newton's method
   real(wp), parameter :: rounding = 4.0_wp*epsilon(1.0_wp) !! what does not count of angles and of speeds over their mean

   type :: crank_motion_t
      logical :: known = .true.                  !! false: the machine has no steady cycle
      logical :: varies = .false.
      logical :: by_motor = .false.              !! the steady cycle of a machine
      real(wp) :: speed = 1.0_wp                 !! mean over time, rad/s
      real(wp) :: sense = 1.0_wp                 !! -1: the crank turns backwards
      real(wp) :: least = 1.0_wp, greatest = 1.0_wp !! speed, rad/s
      real(wp) :: speed_error = 0.0_wp           !! of the series between what it was made of, over the mean
      real(wp) :: acceleration_error = 0.0_wp    !! and of the acceleration, over its greatest
      type(periodic_t), private :: pace          !! w/W, by phi; of a speed that varies
      type(periodic_t), private :: slope         !! its derivative
      type(periodic_t), private :: late          !! x - phi, by phi
      real(wp), private :: first = 0.0_wp        !! that at the reference position, where time begins
      type(periodic_t), private :: ahead         !! phi - x, by x
      ! at equal steps of time, of `at_steps`:
      real(wp), allocatable :: input(:)          !! degrees from the reference position
      real(wp), allocatable :: rate(:)           !! phi'; not allocated: 1
      real(wp), allocatable :: push(:)           !! phi''; not allocated: 0
   contains
      procedure :: at_steps
      procedure :: inputs
      procedure :: input_at
      procedure :: time_of
      procedure :: speed_at
      procedure :: push_at
      procedure :: left_open
   end type crank_motion_t

contains

   !> Constant speed, of its sign.
   pure type(crank_motion_t) function constant_motion(speed) result(crank)
      real(wp), intent(in) :: speed              !! rad/s

      crank%speed = abs(speed)
      crank%sense = sign(1.0_wp, speed)
      crank%least = crank%speed
      crank%greatest = crank%speed
   end function constant_motion

   !> A speed that varies: the trigonometric polynomial through its values at equal steps of the input from the reference position
   !> in the sense of turning. The values may be multiples of the speed: `mean` is its mean over time. It is positive everywhere
   !> (`positive_between`).
   function varying_motion(values, mean, sense) result(crank)
      real(wp), intent(in) :: values(:)          !! shape (steps of a turn)
      real(wp), intent(in) :: mean               !! over time, rad/s, positive
      real(wp), intent(in) :: sense              !! 1 or -1
      type(crank_motion_t) :: crank
      type(periodic_t) :: speed, slowness
      real(wp), allocatable :: samples(:), angles(:)
      integer :: n, k

      speed = periodic_from_samples(values)
      call find_slowness(speed, size(values), slowness, n)
      crank%varies = .true.
      crank%speed = mean
      crank%sense = sense
      speed = speed%scaled(slowness%mean())
      crank%pace = speed%trimmed(rounding)
      crank%slope = crank%pace%derivative(1)
      slowness = slowness%scaled(1.0_wp/slowness%mean())
      slowness = slowness%integral()
      crank%late = slowness%trimmed(rounding)
      crank%first = crank%late%at(0.0_wp)
      samples = crank%pace%values(n)
      crank%least = -mean*greatest_of(-samples)
      crank%greatest = mean*greatest_of(samples)
      allocate (angles(n), source=0.0_wp)
      do k = 1, n
         associate (x => 2.0_wp*pi*real(k - 1, wp)/real(n, wp))
            if (k > 1) angles(k) = angles(k - 1)
            angles(k) = x + angles(k)
            call find_angle(crank, x, angles(k))
            angles(k) = angles(k) - x
         end associate
      end do
      crank%ahead = periodic_from_samples(angles)
      crank%ahead = crank%ahead%trimmed(rounding)
   end function varying_motion

   !> 1 over the speed, of enough samples; if there are not enough, of `most_samples`.
   pure subroutine find_slowness(speed, values, slowness, samples)
      type(periodic_t), intent(in) :: speed      !! positive
      integer, intent(in) :: values              !! it was made of
      type(periodic_t), intent(out) :: slowness
      integer, intent(out) :: samples

      samples = max(fewest_samples, per_value*values)
      do
         slowness = periodic_from_samples(1.0_wp/speed%values(samples))
         if (slowness%resolution() <= followed .or. 2*samples > most_samples) exit
         samples = 2*samples
      end do
   end subroutine find_slowness

   !> True if the time over the turn is known from speeds (`positive_between`): not where they differ by too large a factor, or
   !> change too fast.
   pure logical function can_be_followed(values)
      real(wp), intent(in) :: values(:)          !! shape (steps of a turn)
      type(periodic_t) :: slowness
      integer :: unused

      call find_slowness(periodic_from_samples(values), size(values), slowness, unused)
      can_be_followed = slowness%resolution() <= followed
   end function can_be_followed

   !> Greatest of samples of a period, by the parabola through the largest and its neighbours.
   pure real(wp) function greatest_of(samples) result(greatest)
      real(wp), intent(in) :: samples(:)
      real(wp) :: left, right, bend
      integer :: k

      k = maxloc(samples, dim=1)
      greatest = samples(k)
      left = samples(modulo(k - 2, size(samples)) + 1)
      right = samples(modulo(k, size(samples)) + 1)
      bend = left - 2.0_wp*greatest + right
      if (bend < 0.0_wp) greatest = greatest - 0.125_wp*(left - right)**2/bend
   end function greatest_of

   !> True if the trigonometric polynomial through values is positive everywhere.
   pure logical function positive_between(values)
      real(wp), intent(in) :: values(:)
      type(periodic_t) :: speed

      speed = periodic_from_samples(values)
      positive_between = all(speed%values(max(fewest_samples, per_value*size(values))) > 0.0_wp)
   end function positive_between

   !> The angle at a time, from a guess, by Newton's method: the time grows with the angle.
   subroutine find_angle(crank, x, angle)
      type(crank_motion_t), intent(in) :: crank
      real(wp), intent(in) :: x
      real(wp), intent(inout) :: angle           !! radians
      real(wp) :: move
      integer :: k

      do k = 1, most_iterations
         move = crank%pace%at(angle)*(x - angle - (crank%late%at(angle) - crank%first))
         angle = angle + move
         if (abs(move) <= rounding*max(1.0_wp, abs(x))) return
      end do
   end subroutine find_angle

   !> The motion with its places at equal steps of time in a turn, the first at the reference position.
   pure type(crank_motion_t) function at_steps(self, points) result(crank)
      class(crank_motion_t), intent(in) :: self
      integer, intent(in) :: points
      real(wp) :: angles(points)

      crank = self
      crank%input = self%inputs(points)
      if (.not. self%varies) return
      angles = self%sense*crank%input*radians_per_degree
      crank%rate = self%speed_at(angles)
      crank%push = self%push_at(angles)
   end function at_steps

   !> The inputs at equal steps of time in a turn, degrees from the reference position.
   pure function inputs(self, steps) result(input)
      class(crank_motion_t), intent(in) :: self
      integer, intent(in) :: steps
      real(wp) :: input(steps)
      integer :: i

      if (self%varies) then
         input = [(self%input_at(2.0_wp*pi*real(i - 1, wp)/real(steps, wp)), i=1, steps)]
      else
         input = [(self%sense*full_turn*real(i - 1, wp)/real(steps, wp), i=1, steps)]
      end if
   end function inputs

   !> The input at a time, degrees from the reference position with its sign; beyond a turn it goes on.
   elemental real(wp) function input_at(self, x)
      class(crank_motion_t), intent(in) :: self
      real(wp), intent(in) :: x                  !! radians of the mean turning

      input_at = self%sense*x*degrees_per_radian
      if (self%varies) input_at = self%sense*(x + self%ahead%at(x) - self%ahead%at(0.0_wp))*degrees_per_radian
   end function input_at

   !> The time at an input, radians of the mean turning within a turn.
   elemental real(wp) function time_of(self, input)
      class(crank_motion_t), intent(in) :: self
      real(wp), intent(in) :: input              !! degrees from the reference position

      time_of = self%sense*input*radians_per_degree
      if (self%varies) time_of = time_of + self%late%at(time_of) - self%first
      time_of = modulo(time_of, 2.0_wp*pi)
   end function time_of

   !> phi' and phi'' where the crank is at an angle.
   elemental real(wp) function speed_at(self, angle)
      class(crank_motion_t), intent(in) :: self
      real(wp), intent(in) :: angle              !! radians from the reference position in the sense of turning

      speed_at = 1.0_wp
      if (self%varies) speed_at = self%pace%at(angle)
   end function speed_at

   elemental real(wp) function push_at(self, angle)
      class(crank_motion_t), intent(in) :: self
      real(wp), intent(in) :: angle

      push_at = 0.0_wp
      if (self%varies) push_at = self%pace%at(angle)*self%slope%at(angle)
   end function push_at

   !> What positions at equal steps of time leave open of the speed (`resolution` of a series); 0 of a constant one.
   pure real(wp) function left_open(self, points)
      class(crank_motion_t), intent(in) :: self
      integer, intent(in) :: points
      type(crank_motion_t) :: turn
      type(periodic_t) :: pace

      left_open = 0.0_wp
      if (.not. self%varies) return
      turn = self%at_steps(points)
      pace = periodic_from_samples(turn%rate)
      left_open = pace%resolution()
   end function left_open

   !> `move_bodies` at the `n` positions after the first `offset` of a turn, `pace` times as fast as at a mean of 1 rad/s.
   subroutine move_in_turn(crank, problem, rates, offset, n, pace, forces)
      type(crank_motion_t), intent(in) :: crank  !! `at_steps`
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: offset, n
      real(wp), intent(in) :: pace               !! of the input, with its sign or without it
      type(forces_t), intent(inout) :: forces
      integer :: b

      call move_bodies(problem, rates, n, pace, 0.0_wp, forces)
      if (.not. crank%varies) return
      do b = body_frame + 1, size(forces%bodies)
         associate (w => forces%w%v, body => forces%bodies(b), rate => crank%rate(offset + 1:offset + n), &
                    push => pace*crank%sense*crank%push(offset + 1:offset + n))
            w(1:n, body%ax) = w(1:n, body%ax)*rate**2 + w(1:n, body%vx)*push
            w(1:n, body%ay) = w(1:n, body%ay)*rate**2 + w(1:n, body%vy)*push
            w(1:n, body%al) = w(1:n, body%al)*rate**2 + w(1:n, body%w)*push
            w(1:n, body%vx) = w(1:n, body%vx)*rate
            w(1:n, body%vy) = w(1:n, body%vy)*rate
            w(1:n, body%w) = w(1:n, body%w)*rate
         end associate
      end do
   end subroutine move_in_turn
end module psalm_crank_motion
