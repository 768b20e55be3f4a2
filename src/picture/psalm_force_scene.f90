!> What pictures show of forces: centres of mass, loads, joints and what they bear, drive and frame.
module psalm_force_scene
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, motion_t
   use psalm_force_model, only: force_model_t, make_force_model, vertices_of
   use psalm_force_trace, only: force_trace_t, trace_forces
   use psalm_kinds, only: wp
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: force_scene_t, make_force_scene, change_unit_of_forces, largest_load, largest_in_joint

   integer, parameter :: name_width = 24

   type :: force_scene_t
      type(force_trace_t) :: prescribed, sweep
      character(name_width), allocatable :: joints(:)  !! names
      character(name_width), allocatable :: links(:)   !! names of those with a centre of mass
      logical :: sliding = .false.                     !! the drive is a force
   end type force_scene_t

contains

   !> Forces of a case without faults, at its positions and over a sweep.
   subroutine make_force_scene(set, given, dimensions, sweep, forces)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: sweep(:)                 !! increments of the input
      type(force_scene_t), intent(out) :: forces
      type(problem_t), allocatable :: problem          ! large: it would fill a small stack
      type(force_model_t) :: model
      type(diagnostics_t) :: unused
      type(motion_t) :: motion
      integer :: j

      allocate (problem, source=given)
      call make_force_model(set, problem%mechanism, dimensions, model, unused)
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(dimensions, motion)
      call trace_forces(problem, model, set%speed, set%accel, motion%closed, motion%input, forces%prescribed)
      call problem%set_inputs(sweep)
      call problem%analyse(dimensions, motion)
      call trace_forces(problem, model, set%speed, set%accel, motion%closed, motion%input, forces%sweep)
      allocate (forces%joints(size(problem%mechanism%joints)))
      do j = 1, size(forces%joints)
         forces%joints(j) = problem%mechanism%joints(j)%name
      end do
      allocate (forces%links(size(forces%sweep%bodies)))
      do j = 1, size(forces%links)
         forces%links(j) = problem%mechanism%bodies(forces%sweep%bodies(j))%name
      end do
      forces%sliding = problem%mechanism%sliding_input
   end subroutine make_force_scene

   !> All places in another unit of length.
   pure subroutine change_unit_of_forces(forces, unit)
      type(force_scene_t), intent(inout) :: forces
      real(wp), intent(in) :: unit

      call change(forces%prescribed)
      call change(forces%sweep)

   contains

      pure subroutine change(trace)
         type(force_trace_t), intent(inout) :: trace

         trace%centre = trace%centre/unit
         trace%load_at = trace%load_at/unit
         trace%joint_at = trace%joint_at/unit
      end subroutine change
   end subroutine change_unit_of_forces

   !> Largest load over the sweep, N; 0 if there is none.
   pure real(wp) function largest_load(forces) result(largest)
      type(force_scene_t), intent(in) :: forces
      integer :: k, l

      largest = 0.0_wp
      do l = 1, size(forces%sweep%load, 3)
         do k = 1, size(forces%sweep%load, 2)
            largest = max(largest, hypotenuse(forces%sweep%load(1, k, l), forces%sweep%load(2, k, l)))
         end do
      end do
   end function largest_load

   !> Largest force in a joint over the sweep, N.
   pure real(wp) function largest_in_joint(forces, joint) result(largest)
      type(force_scene_t), intent(in) :: forces
      integer, intent(in) :: joint
      integer :: k

      largest = 0.0_wp
      do k = 1, size(forces%sweep%joint, 2)
         if (.not. forces%sweep%table%known(k)) cycle
         largest = max(largest, hypotenuse(forces%sweep%joint(1, k, joint), forces%sweep%joint(2, k, joint)))
      end do
   end function largest_in_joint
end module psalm_force_scene
