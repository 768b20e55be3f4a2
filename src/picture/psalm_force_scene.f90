!> What pictures show of forces: centres of mass, loads, joints and what they bear, drive and frame, counterweights and springs.
!>
!> A counterweight is drawn as the disc that has its mass and its own moment of inertia; a point mass as a disc of steel.
module psalm_force_scene
   use psalm_data_set, only: data_set_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t
   use psalm_force_analysis, only: force_table_t, analyse_forces
   use psalm_force_model, only: force_model_t, make_force_model, vertices_of
   use psalm_force_trace, only: force_trace_t, trace_forces
   use psalm_kinds, only: wp
   use psalm_mechanism, only: body_frame
   use psalm_row_study, only: row_study_t, solved_row_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: force_scene_t, make_force_scene, change_unit_of_forces, extent_of_weights, words_of_added, largest_load, &
             largest_in_joint

   integer, parameter :: name_width = 24
   real(wp), parameter :: steel = 7850.0_wp            !! kg/m3
   real(wp), parameter :: steel_thickness = 0.01_wp    !! of the disc that stands for a point mass, m
   real(wp), parameter :: pi = acos(-1.0_wp)

   type :: force_scene_t
      type(force_trace_t) :: prescribed, sweep
      character(name_width), allocatable :: joints(:)  !! names
      character(name_width), allocatable :: links(:)   !! names of those with a centre of mass
      logical :: sliding = .false.                     !! the drive is a force
      real(wp), allocatable :: radius(:)               !! shape (counterweights): of their discs
      logical, allocatable :: torsional(:)             !! shape (springs)
      logical, allocatable :: on_frame(:, :)           !! shape (ends, springs): held by the frame
      integer :: springs_added = 0                     !! so many of the last springs were found for this linkage
      type(force_table_t), allocatable :: bare         !! over the sweep: without counterweights and springs that were added
   end type force_scene_t

contains

   !> Forces of a case without faults, at its positions and over a sweep.
   subroutine make_force_scene(set, study, forces)
      type(data_set_t), intent(in) :: set
      type(row_study_t), intent(in) :: study
      type(force_scene_t), intent(out) :: forces
      class(problem_t), allocatable :: problem          ! large: it would fill a small stack
      type(force_model_t) :: model
      type(diagnostics_t) :: unused
      integer :: j
      real(wp) :: mass, inertia

      call make_force_model(set, study%problem%mechanism, study%dimensions, model, unused)
      call trace_row_forces(study%prescribed, forces%prescribed)
      call trace_row_forces(study%sweep, forces%sweep)
      allocate (forces%joints(size(problem%mechanism%joints)))
      do j = 1, size(forces%joints)
         forces%joints(j) = problem%mechanism%joints(j)%name
      end do
      allocate (forces%links(size(forces%sweep%bodies)))
      do j = 1, size(forces%links)
         forces%links(j) = problem%mechanism%bodies(forces%sweep%bodies(j))%name
      end do
      forces%sliding = problem%mechanism%sliding_input
      allocate (forces%radius(set%masses%added))
      do j = 1, size(forces%radius)
         mass = set%masses%mass(size(set%masses%mass) - set%masses%added + j)
         inertia = set%masses%inertia(size(set%masses%mass) - set%masses%added + j)
         forces%radius(j) = sqrt(merge(2.0_wp*inertia/max(mass, tiny(mass)), mass/(pi*steel*steel_thickness), &
                                       inertia > 0.0_wp .and. mass > 0.0_wp))/set%masses%metre
      end do
      forces%torsional = set%springs%torsional
      allocate (forces%on_frame(2, size(forces%torsional)))
      do j = 1, size(forces%torsional)
         forces%on_frame(:, j) = model%springs(j)%ends%body == body_frame
      end do
      forces%springs_added = set%springs%added
      if (set%masses%added + set%springs%added == 0 .or. allocated(study%sweep%forces)) return
      call make_force_model(set, problem%mechanism, study%dimensions, model, unused, without_added=.true.)
      allocate (forces%bare)
      associate (motion => study%sweep%motion)
         call analyse_forces(problem, model, set%pace(), set%change_of_pace(), motion%closed, motion%input, forces%bare)
      end associate

   contains

      !> Forces at a row; `problem` is that of the row then.
      subroutine trace_row_forces(row, trace)
         type(solved_row_t), intent(in) :: row
         type(force_trace_t), intent(out) :: trace

         if (allocated(problem)) deallocate (problem)
         allocate (problem, source=row%problem)
         call problem%want_derivatives(.true., vertices_of(problem%mechanism))
         call problem%bind(study%dimensions)
         call trace_forces(problem, model, set%pace(), set%change_of_pace(), row%motion%closed, row%motion%input, &
                           set%masses%added, trace, row%forces)
      end subroutine trace_row_forces
   end subroutine make_force_scene

   !> Corners of what counterweights and springs take over the prescribed positions.
   pure subroutine extent_of_weights(forces, low, high)
      type(force_scene_t), intent(in) :: forces
      real(wp), intent(inout) :: low(2), high(2)   !! widened
      integer :: k, j

      do j = 1, size(forces%radius)
         do k = 1, size(forces%prescribed%weight_at, 2)
            if (.not. forces%prescribed%table%known(k)) cycle
            low = min(low, forces%prescribed%weight_at(:, k, j) - forces%radius(j))
            high = max(high, forces%prescribed%weight_at(:, k, j) + forces%radius(j))
         end do
      end do
      do j = 1, size(forces%torsional)
         do k = 1, size(forces%prescribed%spring_at, 2)
            if (.not. forces%prescribed%table%known(k)) cycle
            low = min(low, forces%prescribed%spring_at(:, k, 1, j), forces%prescribed%spring_at(:, k, 2, j))
            high = max(high, forces%prescribed%spring_at(:, k, 1, j), forces%prescribed%spring_at(:, k, 2, j))
         end do
      end do
   end subroutine extent_of_weights

   !> What was added to the linkage, in words; empty if nothing was.
   pure function words_of_added(forces) result(words)
      type(force_scene_t), intent(in) :: forces
      character(:), allocatable :: words
      integer :: weights

      weights = size(forces%radius)
      words = ''
      if (weights > 0) words = to_text(weights)//trim(merge(' counterweight ', ' counterweights', weights == 1))
      if (weights > 0 .and. forces%springs_added > 0) words = words//' and '
      if (forces%springs_added > 0) words = words//to_text(forces%springs_added)// &
                                            trim(merge(' spring ', ' springs', forces%springs_added == 1))
   end function words_of_added

   !> All places in another unit of length.
   pure subroutine change_unit_of_forces(forces, unit)
      type(force_scene_t), intent(inout) :: forces
      real(wp), intent(in) :: unit

      call change(forces%prescribed)
      call change(forces%sweep)
      forces%radius = forces%radius/unit

   contains

      pure subroutine change(trace)
         type(force_trace_t), intent(inout) :: trace

         trace%centre = trace%centre/unit
         trace%load_at = trace%load_at/unit
         trace%joint_at = trace%joint_at/unit
         trace%weight_at = trace%weight_at/unit
         trace%spring_at = trace%spring_at/unit
         trace%spring_foot = trace%spring_foot/unit
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
