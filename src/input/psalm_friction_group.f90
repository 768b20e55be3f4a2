!> The group FRICTN: joints with dry friction.
module psalm_friction_group
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: friction_items
   public :: friction_group_t, read_friction_group

   type :: friction_group_t
      logical :: given = .false.                  !! the group was given
      type(place_t), allocatable :: joints(:)     !! shape (entries): the end of an arc that is the joint
      real(wp), allocatable :: coefficient(:)     !! shape (entries)
      real(wp), allocatable :: at_rest(:)         !! shape (entries): coefficient at rest, in time
      logical :: at_rest_given = .false.
      real(wp), allocatable :: radius(:)          !! shape (entries): of the pin, or half the length of the shoe, user's length
   end type friction_group_t

   !> The items of the group.
   type(rule_t), parameter :: friction_items(*) = [ &
      rule_t('NFRIC', a_whole, '', '', 'as many as the longest item has', '[0,100000]', &
             'number of joints with friction'), &
      rule_t('FLINK', a_whole, 'NFRIC', '', 'required', '', &
             'the joint at the finish of this arc; negative: at its start'), &
      rule_t('FLOOP', a_whole, 'NFRIC', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('FNAME', a_text, 'NFRIC', '', '', '', &
             'of a sketch, in place of both: the joint or slide; where a joint pins more than two links with '// &
             'the one that turns in it, `''B rod''`'), &
      rule_t('FMU', a_number, 'NFRIC', '', '0', '[0,)', &
             'coefficient of friction', &
             'a coefficient of friction is not negative'), &
      rule_t('FSTAT', a_number, 'NFRIC', '', 'FMU', '[0,)', &
             'with &TIME: coefficient of friction at rest, not below FMU', &
             'a coefficient of friction is not negative'), &
      rule_t('FRAD', a_number, 'NFRIC', 'length', '0', '[0,)', &
             'radius of the pin, or half the length of the shoe that slides; a shoe of no length has the '// &
             'friction of N alone. The middle of the shoe is the foot of the slide, on the link that guides it '// &
             '(a bush); of a sketch it is the point SLX, SLY of the second link, SLNK2', &
             'a radius is not negative')]

contains

   !> Read the group. Errors: arcs that are not there, negative coefficients and radii.
   subroutine read_friction_group(group, ilink, sketch, friction, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(friction_group_t), intent(inout) :: friction
      type(diagnostics_t), intent(inout) :: findings
      integer :: n, k

      friction%given = group%line > 0
      call group%follow(friction_items)
      call take_count(group, 'NFRIC', n, findings)
      allocate (friction%joints(n), friction%coefficient(n), friction%radius(n))
      call read_places(group, 'F', ilink, friction%joints, findings, ends_only=.true., sketch=sketch)
      call take(group, 'FMU', friction%coefficient, findings)
      friction%at_rest = friction%coefficient
      call take(group, 'FSTAT', friction%at_rest, findings)
      friction%at_rest_given = group%given('FSTAT')
      do k = 1, n
         if (friction%at_rest(k) < friction%coefficient(k)) call out_of(group, 'FSTAT', 'entry '//to_text(k)// &
            ': the coefficient at rest is below that of slip, FMU', findings, k)
      end do
      call take(group, 'FRAD', friction%radius, findings)
   end subroutine read_friction_group
end module psalm_friction_group
