!> Poses of all links of a sketch from its loops, at any inputs of its drives: what pictures draw, with rates by time.
module psalm_link_poses
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_chain_motion, only: chain_motion_t
   use psalm_closure, only: closure_t, most_orders, state_t
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: motion_t, problem_t, new_problem
   use psalm_joint_location, only: locate_sketch
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_mechanism, only: body_frame, mechanism_t
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_parameters, only: no_parameters, parameters_t
   use psalm_rates, only: derivatives_of, differentiate, in_time, prepare_rates, rates_t
   use psalm_setup, only: set_up
   use psalm_sketch, only: frame_link
   use psalm_sketch_motion, only: observe_sketch
   use psalm_sketch_study, only: sketch_study_t, study_sketch
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: find_poses

contains

   !> All that a sketch does at inputs of its drives, and where its links are.
   subroutine find_poses(set, closure, inputs, speed, accel, study, motion)
      type(data_set_t), intent(in) :: set               !! a sketch with its loops
      type(closure_t), intent(in) :: closure            !! its parts
      real(wp), intent(in) :: inputs(:, :)              !! shape (drives, positions): degrees or length, from the drawing
      real(wp), intent(in) :: speed, accel              !! of the first drive: radians or length a second
      class(sketch_study_t), intent(inout) :: study
      type(chain_motion_t), intent(out) :: motion
      class(mechanism_t), allocatable :: mechanism       ! large, as those below: they would fill a small stack
      class(dimensions_t), allocatable :: dimensions
      class(parameters_t), allocatable :: parameters
      type(diagnostics_t) :: findings
      class(problem_t), allocatable :: problem
      class(motion_t), allocatable :: found
      class(sketch_study_t), allocatable :: outputs
      integer :: k

      allocate (mechanism, dimensions, parameters, problem, found, outputs)
      call set_up(set, mechanism, dimensions, parameters, findings)
      call new_problem(mechanism, dimensions, no_parameters(mechanism), inputs(1, :) - (dimensions%crnki - dimensions%drawn), &
                       .true., problem, transpose(inputs(2:, :)))
      call problem%analyse(dimensions, found)
      call study_sketch(set, problem, dimensions, found%closed, speed, accel, outputs)
      study%inputs = inputs
      study%closed = outputs%closed
      study%dead = outputs%dead
      study%names = outputs%names
      study%angles = outputs%angles
      study%values = outputs%values
      study%by_drive = outputs%by_drive
      study%joints = outputs%joints
      allocate (motion%states(size(inputs, 2)))
      motion%closed = found%closed
      motion%dead = study%dead
      allocate (motion%group(size(inputs, 2)), source=0)
      do k = 1, size(found%violations)
         associate (violation => found%violations(k))
            if (violation%loop == 0) cycle
            where (motion%group(violation%first:violation%last) == 0 .and. .not. found%closed(violation%first:violation%last)) &
               motion%group(violation%first:violation%last) = group_of(violation%loop)
         end associate
      end do
      call find_states(set, problem, dimensions, speed, accel, study%joints, motion%states)

   contains

      !> The group of the sketch that a loop closes.
      pure integer function group_of(loop)
         integer, intent(in) :: loop

         group_of = 0
         associate (members => mechanism%groups(loop)%members)
            if (size(members) > 0) group_of = closure%order%of_link(mechanism%arcs(members(1))%link)
         end associate
      end function group_of
   end subroutine find_poses

   !> Places and turns of the links at every position, with their rates by time. Turns are between half a turn and its opposite.
   subroutine find_states(set, problem, dimensions, speed, accel, joints, states)
      type(data_set_t), intent(in) :: set
      class(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: speed, accel
      complex(wp), intent(in) :: joints(:, 0:, :)       !! shape (joints, 0:most_orders, positions)
      type(state_t), intent(inout) :: states(:)         !! shape (positions)
      type(sketch_motion_t) :: bare                     !! where links without joints begin
      type(rates_t), allocatable :: rates               ! large
      complex(wp), allocatable :: origin(:, :, :)
      real(wp), allocatable :: moved(:, :, :)
      real(wp) :: x, y, c, s, length
      integer :: axis(size(set%sketch%links)), block, offset, n, i, k, l, root

      do l = 1, size(axis)
         axis(l) = axis_of(problem%mechanism, l)
      end do
      call locate_sketch(set, bare, with_links=.true.)
      call problem%want_derivatives(.true., bare%points)
      call problem%bind(dimensions)
      allocate (rates, origin(size(bare%drawn), 0:most_orders, problem%linkage%room), &
                moved(size(bare%arcs), 0:most_orders, problem%linkage%room))
      call prepare_rates(problem, rates)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, most_orders)
         call observe_sketch(bare, problem, rates, n, speed, accel, origin(:, :, :n), moved(:, :, :n))
         do i = 1, n
            k = offset + i
            associate (state => states(k))
               allocate (state%t(size(axis), 0:most_orders), source=(0.0_wp, 0.0_wp))
               allocate (state%phi(size(axis), 0:most_orders), source=0.0_wp)
               allocate (state%joint(size(joints, 1), 0:most_orders), source=joints(:, :, k))
               do l = 1, size(axis)
                  if (l == frame_link) cycle
                  associate (of => set%sketch%links(l)%joints)
                     if (size(of) > 0) state%t(l, :) = joints(of(1), :, k)
                     if (size(of) == 0) state%t(l, :) = origin(size(set%sketch%joint_name) + l, :, i)
                  end associate
                  if (axis(l) == 0) cycle
                  root = problem%plan%root(axis(l))
                  call problem%linkage%arc_at(problem%plan, axis(l), i, x, y, length)
                  call unit_vector(set%traced%arcs(axis(l))%direction, c, s)
                  state%phi(l, 0) = degrees_of(x*c + y*s, y*c - x*s)*radians_per_degree
                  state%phi(l, 1:) = in_time(derivatives_of(rates, problem%linkage%root_x(root), i), speed, accel)
               end do
            end associate
         end do
      end do
   end subroutine find_states

   !> An arc that turns as a link does; 0: none.
   pure integer function axis_of(mechanism, link) result(axis)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: link
      integer :: body

      axis = 0
      do body = 1, size(mechanism%bodies)
         if (body == body_frame .or. mechanism%bodies(body)%is_rod) cycle
         if (mechanism%arcs(mechanism%bodies(body)%axis)%link == link) axis = mechanism%bodies(body)%axis
      end do
   end function axis_of
end module psalm_link_poses
