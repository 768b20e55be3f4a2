!> What a cam has to do to a linkage: from the law of the output back to the input, and on to the follower.
!>
!> The wanted output y(th) is solved for the input q by Newton's method inside a bracket, all cam angles at once, on the branch
!> round the reference position where every loop closes and the output rises or falls all the way; and on the branches beyond
!> dead points at which the law rests. Derivatives follow from those of the linkage in closed form, to the third order; the
!> follower from the linkage's own pose. Nothing here knows what the follower touches.
!> Source: Oldham (1977), 9.3.2; derivation in doc/theory/cams.md.
module psalm_cam_motion
   use psalm_angles, only: nearest_difference
   use psalm_cam_data, only: cam_group_t, roller_t
   use psalm_cam_chain, only: cam_chain_t
   use psalm_cam_law, only: law_t, highest_law_order
   use psalm_cam_crossing, only: ways_t, plan_ways, next_dead_point, solve_near, no_point
   use psalm_cam_branch, only: moved_problem_t, followed_t, branch_t, find_branch
   use psalm_cam_trace, only: cam_trace_t, clear_trace, fault_none, fault_reach, fault_dead_point, fault_open
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: new_problem
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_mechanism, only: mechanism_t, output_t
   use psalm_output_kind, only: motion_pose
   use psalm_parameters, only: parameters_t
   use psalm_rates, only: highest_order
   use psalm_shown_input, only: reference_input
   implicit none (type, external)
   private
   public :: cam_motion_t, prepare_cam_motion, chained_motion

   integer, parameter :: most_iterations = 60
   real(wp), parameter :: at_rest = 64.0_wp*epsilon(1.0_wp) !! squared ratio of slopes below which the output stands still
   real(wp), parameter :: settled = 4.0_wp*epsilon(1.0_wp)

   type :: cam_motion_t
      type(law_t) :: law
      logical :: of_output = .true.                  !! the law is that of the output, else of the input
      logical :: angular = .false.                   !! and that is an angle
      type(followed_t) :: what                       !! the output's component, and units
      type(moved_problem_t), allocatable :: output, follower
      real(wp) :: reference = 0.0_wp                 !! the reference input as shown
      real(wp), allocatable :: q(:), f(:)            !! the branch: inputs that rise, outputs there
      type(ways_t) :: ways                           !! this branch and those beyond its dead points
      type(cam_chain_t), allocatable :: chain        !! of a sketch solved in the poses of its links, in place of all this
   contains
      procedure :: trace
      procedure :: has_branch
   end type cam_motion_t

contains

   !> Make a motion ready. Where the reference position itself does not close or stands still there is no branch.
   subroutine prepare_cam_motion(cam, law, mechanism, given, parameters, motion)
      type(cam_group_t), intent(in) :: cam
      type(law_t), intent(in) :: law
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: given
      type(parameters_t), intent(in) :: parameters
      type(cam_motion_t), intent(out) :: motion

      motion%law = law
      motion%of_output = cam%of_output
      motion%what%turning_input = .not. mechanism%sliding_input
      motion%reference = reference_input(mechanism, given)
      allocate (motion%q(0), motion%f(0))
      allocate (motion%follower)
      call make_follower(cam, cam%roller, mechanism, given, parameters, motion%follower)
      motion%angular = motion%what%turning_input
      if (.not. cam%of_output) return
      allocate (motion%output)
      allocate (motion%output%problem)
      call new_problem(mechanism, given, parameters, [0.0_wp], .false., motion%output%problem)
      call motion%output%problem%want_derivatives(.false.)
      associate (kind => motion%output%problem%output%kind)
         motion%what%component = min(cam%axis, kind%components)
         motion%what%angular = kind%angle == motion%what%component
      end associate
      motion%angular = motion%what%angular
      call find_branch(motion%output, motion%what, motion%reference, motion%ways%branches(0))
      motion%q = motion%ways%branches(0)%q
      motion%f = motion%ways%branches(0)%f
      call plan_ways(cam, motion%output, motion%what, motion%law, motion%ways)
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
   subroutine make_follower(cam, roller, mechanism, given, parameters, quantity)
      type(cam_group_t), intent(in) :: cam
      type(roller_t), intent(in) :: roller
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: given
      type(parameters_t), intent(in) :: parameters
      type(moved_problem_t), intent(inout) :: quantity
      type(mechanism_t) :: posed
      type(dimensions_t) :: dimensions

      posed = mechanism
      posed%outputs = [output_t(motion_pose, mechanism%seq(cam%loop, cam%arc), cam%from_start)]
      dimensions = given
      dimensions%outlk = roller%distance
      dimensions%outang = roller%angle
      allocate (quantity%problem)
      call new_problem(posed, dimensions, parameters, [0.0_wp], .false., quantity%problem)
      call quantity%problem%want_derivatives(.false.)
   end subroutine make_follower

   !> True if the output can be followed round the reference position.
   pure logical function has_branch(self)
      class(cam_motion_t), intent(in) :: self

      has_branch = size(self%q) > 0
   end function has_branch

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
         call invert(self, piece, states)
      else
         states%q = states%y
      end if
      call follow(self, states)
   end subroutine trace

   !> Inputs that give the outputs wanted: where the law rests at a dead point, next to dead points, and elsewhere.
   subroutine invert(motion, piece, states)
      type(cam_motion_t), intent(inout) :: motion
      integer, intent(in) :: piece(:)                !! of the law
      type(cam_trace_t), intent(inout) :: states
      integer :: point(size(piece)), i
      integer, allocatable :: near(:), far(:)
      real(wp) :: distance(size(piece))
      real(wp), allocatable :: q(:, :)
      logical :: at_end(size(piece))
      logical, allocatable :: shut(:)

      point = no_point
      do i = 1, size(piece)
         call next_dead_point(motion%ways, motion%law, motion%what, states%angle(i), piece(i), point(i), distance(i), at_end(i))
      end do
      associate (resting => motion%ways%rests(motion%law%pieces(piece)%segment))
         near = pack([(i, i=1, size(piece))], point /= no_point)
         far = pack([(i, i=1, size(piece))], point == no_point .and. resting == no_point)
         do i = 1, size(piece)
            if (resting(i) /= no_point) states%q(0, i) = motion%ways%points(resting(i))%q
         end do
      end associate
      if (size(far) > 0) call invert_far(motion, piece, far, states)
      if (size(near) == 0) return
      allocate (q(0:3, size(near)), shut(size(near)))
      call solve_near(motion%ways, motion%law, motion%output, motion%what, states%angle(near), piece(near), point(near), &
                      at_end(near), distance(near), q, shut)
      states%q(:, near) = q
      do i = 1, size(near)
         if (.not. shut(i)) states%fault(near(i)) = fault_open
      end do
   end subroutine invert

   !> Inputs away from dead points, by Newton's method in brackets.
   subroutine invert_far(motion, piece, list, states)
      type(cam_motion_t), intent(inout) :: motion
      integer, intent(in) :: piece(:), list(:)       !! which of the states
      type(cam_trace_t), intent(inout) :: states
      real(wp), allocatable :: low(:), high(:), q(:), value(:, :), d(:, :, :), slope(:), before(:)
      logical, allocatable :: shut(:)
      integer, allocatable :: on(:)
      real(wp) :: step, miss, unit, input_unit
      integer :: n, i, k, components
      logical :: moving

      n = size(list)
      components = motion%output%problem%output%kind%components
      allocate (low(n), high(n), q(n), value(components, n), d(highest_order, components, n), slope(n), shut(n), before(n))
      unit = motion%what%output_unit()
      input_unit = motion%what%input_unit()
      on = motion%ways%on(motion%law%pieces(piece(list))%segment)
      do i = 1, n
         associate (branch => motion%ways%branches(on(i)), wanted => states%y(0, list(i)))
            k = bracket(branch, wanted)
            if (k == 0) then
               states%fault(list(i)) = fault_reach
               k = merge(1, size(branch%q) - 1, sense_of(branch)*(wanted - branch%f(1)) < 0.0_wp)
            end if
            low(i) = branch%q(k)
            high(i) = branch%q(k + 1)
            step = branch%f(k + 1) - branch%f(k)
            q(i) = low(i)
            if (abs(step) > 0.0_wp) q(i) = low(i) + (high(i) - low(i))*min(max((wanted - branch%f(k))/step, 0.0_wp), 1.0_wp)
         end associate
      end do
      before = huge(before)
      do k = 1, most_iterations
         call motion%output%move(q, 2, value, d, shut)
         moving = .false.
         do i = 1, n
            if (states%fault(list(i)) == fault_reach) cycle
            miss = states%y(0, list(i)) - value(motion%what%component, i)
            if (motion%angular) miss = nearest_difference(states%y(0, list(i)), value(motion%what%component, i))
            slope(i) = d(1, motion%what%component, i)
            if (sense_of(motion%ways%branches(on(i)))*miss > 0.0_wp) then
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
      states%q(0, list) = q
      do i = 1, n
         associate (f => d(:, motion%what%component, i), y => states%y(1:3, list(i)), dq => states%q(1:3, list(i)), &
                    fault => states%fault(list(i)))
            if (fault /= fault_none) cycle
            if (.not. shut(i)) fault = fault_open
            if ((f(1)/motion%ways%branches(on(i))%slope)**2 < at_rest) fault = fault_dead_point
            if (fault /= fault_none) cycle
            dq(1) = y(1)/f(1)
            dq(2) = (y(2) - f(2)*dq(1)**2)/f(1)
            dq(3) = (y(3) - 3.0_wp*f(2)*dq(1)*dq(2) - f(3)*dq(1)**3)/f(1)
         end associate
      end do
   end subroutine invert_far

   !> +1 where the output of a branch rises with the input, else -1.
   pure real(wp) function sense_of(branch)
      type(branch_t), intent(in) :: branch

      sense_of = merge(1.0_wp, -1.0_wp, branch%f(size(branch%f)) > branch%f(1))
   end function sense_of

   !> The interval of a branch in which an output lies; 0: none.
   pure integer function bracket(branch, wanted)
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: wanted
      real(wp) :: rising, rounding
      integer :: from, to, middle

      bracket = 0
      from = 1
      to = size(branch%q)
      rising = sense_of(branch)
      rounding = at_rest*maxval(abs(branch%f))
      if (rising*(wanted - branch%f(1)) < -rounding) return
      if (rising*(wanted - branch%f(to)) > rounding) return
      do while (to - from > 1)
         middle = (from + to)/2
         if (rising*(wanted - branch%f(middle)) >= 0.0_wp) then
            from = middle
         else
            to = middle
         end if
      end do
      bracket = from
   end function bracket

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
