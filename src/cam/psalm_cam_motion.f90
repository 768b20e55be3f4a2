!> What a cam has to do to a linkage: from the law of the output back to the input, and on to the follower.
!>
!> The wanted output y(th) is solved for the input q by Newton's method inside a bracket, all cam angles at once, on the stretch
!> round the reference position where every loop closes and the output rises or falls all the way. Derivatives follow from those
!> of the linkage in closed form, to the third order; the follower from the linkage's own pose. Nothing here knows what the
!> follower touches. Source: Oldham (1977), 9.3.2; derivation in doc/theory.md.
module psalm_cam_motion
   use psalm_angles, only: nearest_difference
   use psalm_cam_group, only: cam_group_t, roller_t
   use psalm_cam_chain, only: cam_chain_t
   use psalm_cam_law, only: law_t, highest_law_order
   use psalm_cam_trace, only: cam_trace_t, clear_trace, fault_none, fault_reach, fault_dead_point, fault_open
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, new_problem
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_mechanism, only: mechanism_t, output_t
   use psalm_output_kind, only: motion_pose
   use psalm_parameters, only: parameters_t
   use psalm_rates, only: rates_t, prepare_rates, differentiate, output_rates, is_dead, highest_order
   implicit none (type, external)
   private
   public :: cam_motion_t, prepare_cam_motion, chained_motion

   integer, parameter :: scan_steps = 720                !! to either side of the reference position
   real(wp), parameter :: scan_degrees = 0.5_wp
   integer, parameter :: bisections = 60, most_iterations = 60
   real(wp), parameter :: at_rest = 64.0_wp*epsilon(1.0_wp) !! squared ratio of slopes below which the output stands still
   real(wp), parameter :: settled = 4.0_wp*epsilon(1.0_wp)

   !> A problem and its derivatives at a row of inputs.
   type :: mover_t
      type(problem_t) :: problem
      type(rates_t) :: rates
      integer :: prepared = 0                        !! positions
   contains
      procedure :: move
   end type mover_t

   type :: cam_motion_t
      type(law_t) :: law
      logical :: of_output = .true.                  !! the law is that of the output, else of the input
      logical :: angular = .false.                   !! and that is an angle
      logical :: turning_input = .true.
      integer :: component = 1                       !! of the output
      type(mover_t), allocatable :: output, follower
      real(wp) :: reference = 0.0_wp                 !! CRNKI
      real(wp), allocatable :: q(:), f(:)            !! the stretch: inputs that rise, outputs there
      real(wp) :: steepest = 0.0_wp                  !! greatest slope of the output on it
      type(cam_chain_t), allocatable :: chain        !! of a sketch solved in the poses of its links, in place of all this
   contains
      procedure :: trace
      procedure :: has_stretch
   end type cam_motion_t

contains

   !> Make a motion ready. Where the reference position itself does not close or stands still there is no stretch.
   subroutine prepare_cam_motion(cam, law, mechanism, given, parameters, motion)
      type(cam_group_t), intent(in) :: cam
      type(law_t), intent(in) :: law
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: given
      type(parameters_t), intent(in) :: parameters
      type(cam_motion_t), intent(out) :: motion

      motion%law = law
      motion%of_output = cam%of_output
      motion%turning_input = .not. mechanism%sliding_input
      motion%reference = given%crnki
      allocate (motion%q(0), motion%f(0))
      allocate (motion%follower)
      call make_follower(cam, cam%roller, mechanism, given, parameters, motion%follower)
      motion%angular = motion%turning_input
      if (.not. cam%of_output) return
      allocate (motion%output)
      call new_problem(mechanism, given, parameters, [0.0_wp], .false., motion%output%problem)
      call motion%output%problem%want_derivatives(.false.)
      associate (kind => motion%output%problem%output%kind)
         motion%component = min(cam%axis, kind%components)
         motion%angular = kind%angle == motion%component
      end associate
      call find_stretch(motion)
   end subroutine prepare_cam_motion

   !> The motion of a sketch that is solved in the poses of its links.
   subroutine chained_motion(chain, motion)
      type(cam_chain_t), intent(in) :: chain
      type(cam_motion_t), intent(out) :: motion

      motion%law = chain%law(chain%own)
      motion%of_output = chain%number(chain%own) > 0
      motion%angular = chain%angular(chain%own)
      allocate (motion%q(0), motion%f(0))
      motion%chain = chain
   end subroutine chained_motion

   !> The pose of a point on the arc that carries the follower, as a problem.
   subroutine make_follower(cam, roller, mechanism, given, parameters, mover)
      type(cam_group_t), intent(in) :: cam
      type(roller_t), intent(in) :: roller
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: given
      type(parameters_t), intent(in) :: parameters
      type(mover_t), intent(inout) :: mover
      type(mechanism_t) :: posed
      type(dimensions_t) :: dimensions

      posed = mechanism
      posed%outputs = [output_t(motion_pose, mechanism%seq(cam%loop, cam%arc), cam%from_start)]
      dimensions = given
      dimensions%outlk = roller%distance
      dimensions%outang = roller%angle
      call new_problem(posed, dimensions, parameters, [0.0_wp], .false., mover%problem)
      call mover%problem%want_derivatives(.false.)
   end subroutine make_follower

   !> Move to inputs (degrees or length, not increments): values and derivatives of all components; `shut` where all
   !> loops close and have derivatives.
   subroutine move(self, inputs, orders, value, d, shut, direction)
      class(mover_t), intent(inout) :: self
      real(wp), intent(in) :: inputs(:)              !! shape (n)
      integer, intent(in) :: orders                  !! 2 or 3
      real(wp), intent(out) :: value(:, :)           !! shape (components, n): angles in a turn
      real(wp), intent(out) :: d(:, :, :)            !! shape (3, components, n)
      logical, intent(out) :: shut(:)                !! shape (n)
      complex(wp), intent(out), optional :: direction(:) !! shape (n): of the output arc
      integer :: block, offset, m, i, c, loop

      associate (problem => self%problem)
         if (self%prepared /= size(inputs)) then
            call problem%set_inputs(inputs - problem%given%crnki)
            call problem%bind(problem%given)
            call prepare_rates(problem, self%rates)
            self%prepared = size(inputs)
         else
            call problem%move_inputs(inputs - problem%given%crnki)
         end if
         shut = .true.
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, m)
            call problem%output_of(m)
            call differentiate(problem, self%rates, m, orders)
            do i = 1, m
               do loop = 1, problem%mechanism%nloop
                  if (problem%linkage%step_of_loop(loop) == 0) cycle
                  if (.not. problem%linkage%closes(i, loop)) shut(offset + i) = .false.
                  if (is_dead(problem, self%rates, loop, i)) shut(offset + i) = .false.
               end do
               do c = 1, size(value, 1)
                  value(c, offset + i) = problem%output%actual(c, i, problem%linkage)
               end do
               call output_rates(problem, self%rates, i, orders, d(:, :, offset + i))
               if (present(direction)) direction(offset + i) = cmplx(problem%linkage%store%v(i, problem%linkage%direction(1)), &
                                                                  problem%linkage%store%v(i, problem%linkage%direction(2)), wp)
            end do
         end do
      end associate
   end subroutine move

   !> The stretch of inputs round the reference position, its ends by bisection.
   subroutine find_stretch(motion)
      type(cam_motion_t), intent(inout) :: motion
      real(wp), allocatable :: q(:), f(:)
      logical, allocatable :: good(:)
      real(wp) :: step, sense, ends(2), at_ends(2)
      integer :: k, first, last, middle

      middle = scan_steps + 1
      step = scan_degrees
      if (.not. motion%turning_input) step = 2.0_wp*max(sum(motion%output%problem%given%arcl), &
                                                        abs(motion%reference))/real(scan_steps, wp)
      q = [(motion%reference + step*real(k, wp), k=-scan_steps, scan_steps)]
      allocate (f(size(q)), good(size(q)))
      sense = 0.0_wp
      call judge(q, f, good)
      if (.not. good(middle)) return
      first = middle
      do while (first > 1)
         if (.not. good(first - 1)) exit
         first = first - 1
      end do
      last = middle
      do while (last < size(q))
         if (.not. good(last + 1)) exit
         last = last + 1
      end do
      ends = [q(first), q(last)]
      at_ends = [f(first), f(last)]
      if (first > 1) call narrow(q(first), q(first - 1), ends(1), at_ends(1))
      if (last < size(q)) call narrow(q(last), q(last + 1), ends(2), at_ends(2))
      motion%q = [ends(1), q(first:last), ends(2)]
      motion%f = [at_ends(1), f(first:last), at_ends(2)]
      if (motion%angular) then
         do k = 2, size(motion%f)
            motion%f(k) = motion%f(k - 1) + nearest_difference(motion%f(k), motion%f(k - 1))
         end do
      end if

   contains

      !> Outputs, and whether each input belongs to the stretch as far as it can be seen from there.
      subroutine judge(inputs, output, belongs)
         real(wp), intent(in) :: inputs(:)
         real(wp), intent(out) :: output(:)
         logical, intent(out) :: belongs(:)
         real(wp) :: value(motion%output%problem%output%kind%components, size(inputs))
         real(wp) :: d(highest_order, size(value, 1), size(inputs))
         logical :: shut(size(inputs))

         call motion%output%move(inputs, 2, value, d, shut)
         output = value(motion%component, :)
         associate (slope => d(1, motion%component, :))
            if (size(inputs) > 1 .and. shut(min(middle, size(inputs)))) sense = sign(1.0_wp, slope(middle))
            belongs = shut .and. sense*slope > 0.0_wp
            if (any(belongs)) motion%steepest = max(motion%steepest, maxval(abs(slope), belongs))
         end associate
      end subroutine judge

      !> The last input that belongs, between one that does and one that does not.
      subroutine narrow(inside, outside, input, output)
         real(wp), intent(in) :: inside, outside
         real(wp), intent(inout) :: input, output
         real(wp) :: low, high, one(1)
         logical :: belongs(1)
         integer :: i

         low = inside
         high = outside
         do i = 1, bisections
            call judge([0.5_wp*(low + high)], one, belongs)
            if (belongs(1)) then
               low = 0.5_wp*(low + high)
               output = one(1)
            else
               high = 0.5_wp*(low + high)
            end if
         end do
         input = low
      end subroutine narrow
   end subroutine find_stretch

   !> True if the output can be followed round the reference position.
   pure logical function has_stretch(self)
      class(cam_motion_t), intent(in) :: self

      has_stretch = size(self%q) > 0
   end function has_stretch

   !> Output, input and follower at cam angles, each on its piece of the law.
   subroutine trace(self, angle, piece, states)
      class(cam_motion_t), intent(inout) :: self
      real(wp), intent(in) :: angle(:)               !! degrees, shape (n)
      integer, intent(in) :: piece(:)
      type(cam_trace_t), intent(out) :: states
      real(wp) :: y(0:highest_law_order), unit
      integer :: n, i

      if (allocated(self%chain)) then
         call self%chain%trace(angle, piece, states)
         return
      end if
      n = size(angle)
      call clear_trace(angle, states)
      unit = merge(radians_per_degree, 1.0_wp, self%angular)
      do i = 1, n
         y = self%law%evaluate(angle(i), piece(i))
         states%y(0, i) = y(0)
         states%y(1:3, i) = y(1:3)*unit
      end do
      if (self%of_output) then
         call invert(self, states)
      else
         states%q = states%y
      end if
      call follow(self, states)
   end subroutine trace

   !> Inputs that give the outputs wanted.
   subroutine invert(motion, states)
      type(cam_motion_t), intent(inout) :: motion
      type(cam_trace_t), intent(inout) :: states
      real(wp), allocatable :: low(:), high(:), q(:), value(:, :), d(:, :, :), slope(:), before(:)
      logical, allocatable :: shut(:)
      real(wp) :: step, miss, scale, unit, input_unit
      integer :: n, i, k, count, components, rising
      logical :: moving

      n = size(states%angle)
      components = motion%output%problem%output%kind%components
      allocate (low(n), high(n), q(n), value(components, n), d(highest_order, components, n), slope(n), shut(n), before(n))
      unit = merge(radians_per_degree, 1.0_wp, motion%angular)
      input_unit = merge(radians_per_degree, 1.0_wp, motion%turning_input)
      count = size(motion%q)
      rising = merge(1, -1, motion%f(count) > motion%f(1))
      scale = maxval(abs(motion%f))
      do i = 1, n
         k = bracket(states%y(0, i))
         if (k == 0) then
            states%fault(i) = fault_reach
            k = merge(1, count - 1, real(rising, wp)*(states%y(0, i) - motion%f(1)) < 0.0_wp)
         end if
         low(i) = motion%q(k)
         high(i) = motion%q(k + 1)
         step = motion%f(k + 1) - motion%f(k)
         q(i) = low(i)
         if (abs(step) > 0.0_wp) q(i) = low(i) + (high(i) - low(i))*min(max((states%y(0, i) - motion%f(k))/step, 0.0_wp), 1.0_wp)
      end do
      before = huge(before)
      do k = 1, most_iterations
         call motion%output%move(q, 2, value, d, shut)
         moving = .false.
         do i = 1, n
            if (states%fault(i) == fault_reach) cycle
            miss = states%y(0, i) - value(motion%component, i)
            if (motion%angular) miss = nearest_difference(states%y(0, i), value(motion%component, i))
            slope(i) = d(1, motion%component, i)
            if (real(rising, wp)*miss > 0.0_wp) then
               low(i) = max(low(i), q(i))
            else
               high(i) = min(high(i), q(i))
            end if
            step = 0.0_wp
            if (abs(slope(i)) > 0.0_wp) step = miss*unit/slope(i)/input_unit
            ! rounding only: each step would undo the last
            if (abs(step) <= settled*max(1.0_wp, abs(q(i))) .or. (abs(step) >= before(i) .and. k > 8)) cycle
            moving = .true.
            before(i) = abs(step)
            if (q(i) + step < low(i) .or. q(i) + step > high(i) .or. .not. abs(slope(i)) > 0.0_wp) then
               q(i) = 0.5_wp*(low(i) + high(i))
            else
               q(i) = q(i) + step
            end if
         end do
         if (.not. moving) exit
      end do
      call motion%output%move(q, highest_order, value, d, shut)
      states%q(0, :) = q
      do i = 1, n
         associate (f => d(:, motion%component, i), y => states%y(1:3, i), dq => states%q(1:3, i))
            if (states%fault(i) /= fault_none) cycle
            if (.not. shut(i)) states%fault(i) = fault_open
            if ((f(1)/motion%steepest)**2 < at_rest) states%fault(i) = fault_dead_point
            if (states%fault(i) /= fault_none) cycle
            dq(1) = y(1)/f(1)
            dq(2) = (y(2) - f(2)*dq(1)**2)/f(1)
            dq(3) = (y(3) - 3.0_wp*f(2)*dq(1)*dq(2) - f(3)*dq(1)**3)/f(1)
         end associate
      end do

   contains

      !> The interval of the stretch in which an output lies; 0: none.
      pure integer function bracket(wanted)
         real(wp), intent(in) :: wanted
         integer :: from, to, middle

         bracket = 0
         from = 1
         to = count
         if (real(rising, wp)*(wanted - motion%f(1)) < -at_rest*scale) return
         if (real(rising, wp)*(wanted - motion%f(count)) > at_rest*scale) return
         do while (to - from > 1)
            middle = (from + to)/2
            if (real(rising, wp)*(wanted - motion%f(middle)) >= 0.0_wp) then
               from = middle
            else
               to = middle
            end if
         end do
         bracket = from
      end function bracket
   end subroutine invert

   !> The follower at the inputs found, by the chain rule.
   subroutine follow(motion, states)
      type(cam_motion_t), intent(inout) :: motion
      type(cam_trace_t), intent(inout) :: states
      real(wp), allocatable :: value(:, :), d(:, :, :)
      logical, allocatable :: shut(:)
      integer :: n, i

      n = size(states%angle)
      allocate (value(3, n), d(highest_order, 3, n), shut(n))
      call motion%follower%move(states%q(0, :), highest_order, value, d, shut, states%direction)
      do i = 1, n
         if (states%fault(i) /= fault_none) cycle
         if (.not. shut(i)) then
            states%fault(i) = fault_open
            cycle
         end if
         associate (c1 => cmplx(d(1, 1, i), d(1, 2, i), wp), c2 => cmplx(d(2, 1, i), d(2, 2, i), wp), &
                    c3 => cmplx(d(3, 1, i), d(3, 2, i), wp), b => d(:, 3, i), q => states%q(1:3, i))
            states%c(0, i) = cmplx(value(1, i), value(2, i), wp)
            states%c(1, i) = c1*q(1)
            states%c(2, i) = c2*q(1)**2 + c1*q(2)
            states%c(3, i) = c3*q(1)**3 + 3.0_wp*c2*(q(1)*q(2)) + c1*q(3)
            states%turning(1, i) = b(1)*q(1)
            states%turning(2, i) = b(2)*q(1)**2 + b(1)*q(2)
            states%turning(3, i) = b(3)*q(1)**3 + 3.0_wp*b(2)*q(1)*q(2) + b(1)*q(3)
            states%by_input(i) = c1
            states%turning_by_input(i) = b(1)
         end associate
      end do
   end subroutine follow
end module psalm_cam_motion
