!> Poses of all links of a sketch from its loops, at any inputs of its drives: what pictures draw, with rates by time.
module psalm_link_poses
   use psalm_chain_motion, only: chain_motion_t
   use psalm_closure, only: closure_t, most_orders
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: motion_t, problem_t, reach_t, follows_drawing, new_problem
   use psalm_joint_location, only: add_link_axes
   use psalm_kinds, only: wp
   use psalm_mechanism, only: body_frame, mechanism_t
   use psalm_parameters, only: no_parameters, parameters_t
   use psalm_row_study, only: solved_row_t
   use psalm_setup, only: set_up
   use psalm_sketch_study, only: link_poses_t, sketch_study_t, study_sketch
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: looped_t, make_looped, find_poses

   !> A sketch with its loops, ready to be solved at any inputs.
   type :: looped_t
      type(mechanism_t) :: mechanism
      type(dimensions_t) :: dimensions
      type(link_poses_t) :: links                   !! parts and axes, no poses
      type(reach_t) :: reach                        !! how far it goes from its drawing
   end type looped_t

contains

   !> Set a sketch up.
   subroutine make_looped(set, looped, solved)
      type(data_set_t), intent(in) :: set               !! a sketch with its loops
      type(looped_t), intent(out) :: looped
      type(solved_row_t), intent(in), optional :: solved !! it is set up already
      class(parameters_t), allocatable :: parameters    ! large: they would fill a small stack
      type(diagnostics_t) :: findings
      integer :: l

      if (present(solved)) then
         looped%mechanism = solved%problem%mechanism
         looped%dimensions = solved%problem%given
      else
         allocate (parameters)
         call set_up(set, looped%mechanism, looped%dimensions, parameters, findings)
      end if
      looped%links%parts = set%traced%moving
      call add_link_axes(set, looped%links%parts)
      looped%links%axis = [(axis_of(looped%mechanism, l), l=1, size(set%sketch%links))]
   end subroutine make_looped

   !> All that a sketch does at inputs of its drives, and where its links are.
   subroutine find_poses(set, closure, inputs, speed, accel, looped, study, motion, solved)
      type(data_set_t), intent(in) :: set               !! a sketch with its loops
      type(closure_t), intent(in) :: closure            !! its parts
      real(wp), intent(in) :: inputs(:, :)              !! shape (drives, positions): degrees or length, from the drawing
      real(wp), intent(in) :: speed, accel              !! of the first drive: radians or length a second
      type(looped_t), intent(inout) :: looped
      class(sketch_study_t), intent(inout) :: study
      type(chain_motion_t), intent(out) :: motion
      type(solved_row_t), intent(in), optional :: solved !! its loops at these inputs
      class(problem_t), allocatable :: problem          ! large, as those below: they would fill a small stack
      class(motion_t), allocatable :: found
      class(sketch_study_t), allocatable :: outputs
      class(link_poses_t), allocatable :: poses
      integer :: k

      allocate (outputs)
      allocate (poses, source=looped%links)
      associate (dimensions => looped%dimensions)
         if (present(solved)) then
            allocate (problem, source=solved%problem)
            allocate (found, source=solved%motion)
         else
            allocate (problem, found)
            call new_problem(looped%mechanism, dimensions, no_parameters(looped%mechanism), &
                             inputs(1, :) - (dimensions%crnki - dimensions%drawn), .true., problem, transpose(inputs(2:, :)))
            problem%followed = follows_drawing(set, looped%mechanism)
            call problem%analyse(dimensions, found, looped%reach)
         end if
         call study_sketch(set, problem, dimensions, found%closed, speed, accel, outputs, poses=poses)
      end associate
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
      do k = 1, size(motion%states)
         associate (state => motion%states(k))
            allocate (state%t(size(poses%axis), 0:most_orders), source=poses%t(:, :, k))
            allocate (state%phi(size(poses%axis), 0:most_orders), source=poses%phi(:, :, k))
            allocate (state%joint(size(study%joints, 1), 0:most_orders), source=study%joints(:, :, k))
         end associate
      end do

   contains

      !> The group of the sketch that a loop closes.
      pure integer function group_of(loop)
         integer, intent(in) :: loop

         group_of = 0
         associate (members => looped%mechanism%groups(loop)%members)
            if (size(members) > 0) group_of = closure%order%of_link(looped%mechanism%arcs(members(1))%link)
         end associate
      end function group_of
   end subroutine find_poses

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
