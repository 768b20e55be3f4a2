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
      real(wp), allocatable :: grip(:)            !! shape (entries): friction whatever the load is, N m or N
      integer, allocatable :: others(:)           !! shape (entries): the other link of a clutch; 0: as the joint has it
      real(wp), allocatable :: from(:), until(:)  !! shape (entries): s, with TIME: it acts between these
      logical :: timed = .false.                  !! one of them is given
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
             'a radius is not negative'), &
      rule_t('FGRIP', a_number, 'NFRIC', 'N m, N', '0', '[0,)', &
             'friction besides, whatever the load is: of a clutch, a brake, a seal', &
             'friction is not negative'), &
      rule_t('FOTHER', a_text, 'NFRIC', '', '', '', &
             'of a sketch, where a joint pins more than two links: name of the other link of a clutch between two links that '// &
             'both turn there; with FGRIP alone (FMU=0)'), &
      rule_t('FTON', a_number, 'NFRIC', 's', '0', '[0,)', &
             'with &TIME: the entry acts from this time', &
             'a time is not negative'), &
      rule_t('FTOFF', a_number, 'NFRIC', 's', 'never', '(0,)', &
             'with &TIME: it does not from this time')]

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
      allocate (friction%grip(n), friction%from(n))
      allocate (friction%until(n), source=huge(1.0_wp))
      call take(group, 'FGRIP', friction%grip, findings)
      call read_others(group, sketch, friction, findings)
      call take(group, 'FTON', friction%from, findings)
      call take(group, 'FTOFF', friction%until, findings)
      friction%timed = group%given('FTON') .or. group%given('FTOFF')
      do k = 1, n
         if (.not. friction%until(k) > friction%from(k)) call out_of(group, 'FTOFF', 'entry '//to_text(k)// &
            ': it must end after it begins (FTON)', findings, k)
      end do
   end subroutine read_friction_group

   !> The other links of clutches.
   subroutine read_others(group, sketch, friction, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(in) :: sketch
      type(friction_group_t), intent(inout) :: friction
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      integer :: k

      allocate (friction%others(size(friction%joints)), source=0)
      call group%get_texts('FOTHER', names, findings)
      if (size(names) == 0) return
      if (.not. sketch%given) then
         call out_of(group, 'FOTHER', 'names a link of a sketch (&CHAIN), but this linkage is described by &LINKS', findings)
         return
      end if
      if (size(names) > size(friction%others)) then
         call out_of(group, 'FOTHER', 'has '//to_text(size(names))//' names; there are '//to_text(size(friction%others))// &
                     ' entries', findings, size(names))
         return
      end if
      do k = 1, size(names)
         if (len_trim(names(k)) == 0) cycle
         friction%others(k) = sketch%link_called(trim(adjustl(names(k))))
         if (friction%others(k) == 0) then
            call out_of(group, 'FOTHER', "entry "//to_text(k)//": there is no link '"//trim(adjustl(names(k)))//"'", findings, k)
         else if (friction%coefficient(k) > 0.0_wp) then
            call out_of(group, 'FOTHER', 'entry '//to_text(k)//': a clutch between two links that both turn on the pin has the '// &
                        'friction FGRIP alone; leave FMU out', findings, k)
         end if
      end do
   end subroutine read_others
end module psalm_friction_group
