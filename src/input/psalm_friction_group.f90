!> The group FRICTN: joints with dry friction.
module psalm_friction_group
   use psalm_group, only: group_t
   use psalm_kinds, only: wp
   use psalm_link_place, only: place_t, read_places, read_count, refuse_unless
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: friction_group_t, read_friction_group

   type :: friction_group_t
      logical :: given = .false.                  !! the group was given
      type(place_t), allocatable :: joints(:)     !! shape (entries): the end of an arc that is the joint
      real(wp), allocatable :: coefficient(:)     !! shape (entries)
      real(wp), allocatable :: radius(:)          !! shape (entries): of the pin, or half the length of the shoe, user's length
   end type friction_group_t

contains

   !> Read the group. Errors: arcs that are not there, negative coefficients and radii.
   subroutine read_friction_group(group, ilink, sketch, friction, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(friction_group_t), intent(inout) :: friction
      type(diagnostics_t), intent(inout) :: findings
      integer :: n

      friction%given = group%line > 0
      call read_count(group, 'NFRIC', n, findings)
      allocate (friction%joints(n))
      allocate (friction%coefficient(n), friction%radius(n), source=0.0_wp)
      call read_places(group, 'F', ilink, friction%joints, findings, ends_only=.true., sketch=sketch)
      call group%get_reals('FMU', friction%coefficient, findings)
      call group%get_reals('FRAD', friction%radius, findings)
      call refuse_unless(friction%coefficient >= 0.0_wp, group, 'FMU', 'a coefficient of friction is not negative', findings)
      call refuse_unless(friction%radius >= 0.0_wp, group, 'FRAD', 'a radius is not negative', findings)
   end subroutine read_friction_group
end module psalm_friction_group
