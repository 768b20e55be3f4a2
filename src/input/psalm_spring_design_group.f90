!> The group SPRNGS: springs that are to be found - between which links, within which limits, for what.
module psalm_spring_design_group
   use psalm_case_group, only: case_group_t, surroundings_t, place_visitor_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places, refuse_unless
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_number, a_text, a_whole, a_word
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   implicit none (type, external)
   private
   public :: design_items
   public :: spring_design_group_t, spring_design_of
   public :: criterion_range, criterion_rms, criterion_peak
   public :: acts_between_points, acts_by_turning, acts_along_slide

   integer, parameter :: criterion_range = 1 !! greatest less least value
   integer, parameter :: criterion_rms = 2   !! of the values themselves
   integer, parameter :: criterion_peak = 3  !! greatest amount

   integer, parameter :: acts_between_points = 0 !! SKIND: pulls two points together
   integer, parameter :: acts_by_turning = 1     !! a torsion spring between two links
   integer, parameter :: acts_along_slide = 2    !! pulls along the line on which the second place goes in the first link

   !> Springs. Arrays have the shape (NSFIND).
   type, extends(case_group_t) :: spring_design_group_t
      logical :: exact = .false.                    !! SMETH: 'EXACT', zero free length through six positions; else 'SEARCH'
      type(place_t), allocatable :: first(:), second(:) !! PLINK ..., QLINK ...: where the ends are looked for
      real(wp), allocatable :: first_reach(:), second_reach(:) !! PREACH, QREACH: around there, user's length; 0: just there
      real(wp), allocatable :: stiffest(:)          !! SKMAX: N/m; 0: no limit
      real(wp), allocatable :: free_low(:), free_high(:) !! SFLOW, SFHIGH: free length, user's length; free angle, degrees
      integer, allocatable :: acts(:)               !! SKIND: acts_...
      logical :: free_limited = .false.             !! SFLOW or SFHIGH was given
      integer :: criterion = criterion_range        !! SCRIT
      type(place_t) :: joint                        !! SJLINK, SJLOOP: the joint whose load counts
      logical :: of_joint = .false.                 !! else the drive
      integer :: starts = 32                        !! NSSTRT
      integer :: seed = 1                           !! ISSEED
      integer :: phases = 64                        !! item NPHASE: of EXACT, in a turn
      ! coils, of every spring; 0: not given
      real(wp) :: wire = 0.0_wp, coil = 0.0_wp      !! CWIRE, CDIAM: diameters, m
      real(wp) :: turns = 0.0_wp                    !! CTURNS
      real(wp) :: shear = 79.0e9_wp                 !! CSHEAR: modulus, Pa
   contains
      procedure :: read => read_spring_design
      procedure :: visit_places => visit_spring_design
   end type spring_design_group_t

   !> The items of the group.
   type(rule_t), parameter :: design_items(*) = [ &
      rule_t('NSFIND', a_whole, '', '', 'as many as the longest item has', '[0,100000]', &
             'springs'), &
      rule_t('PLINK', a_whole, 'NSFIND', '', 'required', '', &
             'where one end may be attached, a place as in &MASSES: an arc'), &
      rule_t('PLOOP', a_whole, 'NSFIND', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('PNAME', a_text, 'NSFIND', '', '', '', &
             'of a sketch, in place of both: the link, and the joint the place is counted from'), &
      rule_t('PDIST', a_number, 'NSFIND', 'length', '0', '', &
             'distance from that end of the arc'), &
      rule_t('PANG', a_number, 'NSFIND', 'degrees', '0', '', &
             'angle from the arc''s direction'), &
      rule_t('QLINK', a_whole, 'NSFIND', '', 'required', '', &
             'where the other end may be attached: an arc'), &
      rule_t('QLOOP', a_whole, 'NSFIND', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('QNAME', a_text, 'NSFIND', '', '', '', &
             'of a sketch, in place of both: the link, and the joint the place is counted from'), &
      rule_t('QDIST', a_number, 'NSFIND', 'length', '0', '', &
             'distance from that end of the arc'), &
      rule_t('QANG', a_number, 'NSFIND', 'degrees', '0', '', &
             'angle from the arc''s direction'), &
      rule_t('PREACH', a_number, '1 to NSFIND', 'length', '0', '[0,)', &
             'how far around the first place; 0: just there'), &
      rule_t('QREACH', a_number, '1 to NSFIND', 'length', '0', '[0,)', &
             'how far around the second place; 0: just there'), &
      rule_t('SKIND', a_whole, 'NSFIND', '', '0', '0 1 2', &
             '0: between two points; 1: torsional, between the two links; 2: along the slide on which the second place goes in '// &
             'the first link', &
             '0 (between two points), 1 (torsional) or 2 (along a slide) is expected'), &
      rule_t('SFLOW', a_number, '1 to NSFIND', 'length, degrees', '0; SKIND 1, 2: no limit', '', &
             'least free length; torsional: free angle from arc PLINK to arc QLINK; along a slide: free distance of the places '// &
             'along it'), &
      rule_t('SFHIGH', a_number, '1 to NSFIND', 'length, degrees', '0; SKIND 1, 2: no limit', '', &
             'greatest free length, angle, distance'), &
      rule_t('SKMAX', a_number, '1 to NSFIND', 'N/m, N m/rad', '0', '[0,)', &
             'greatest stiffness; 0: 1000 times the largest load over the square of the reach (or of the '// &
             'greatest free length); torsional and along slides: the one of 1000 times the largest load'), &
      rule_t('SCRIT', a_word, '', '', 'RANGE', 'RANGE RMS PEAK', &
             '''RANGE'' (greatest less least value), ''RMS'', ''PEAK'' (greatest amount)'), &
      rule_t('SJLINK', a_whole, '', '', '', '', &
             'the joint whose load is to fall, with ''RMS'' or ''PEAK'': the finish of this arc, negative: its '// &
             'start; without a joint the drive''s'), &
      rule_t('SJLOOP', a_whole, '', '', '', '', &
             'the loop of that arc'), &
      rule_t('SJNAME', a_text, '1', '', '', '', &
             'of a sketch, in place of both: the joint'), &
      rule_t('SMETH', a_word, '', '', 'SEARCH', 'SEARCH EXACT', &
             '''SEARCH'' from many starts; ''EXACT'': one spring of zero free length, by six crank angles'), &
      rule_t('NSSTRT', a_whole, '', '', '32', '[1,10000]', &
             'starts of the search'), &
      rule_t('ISSEED', a_whole, '', '', '1', '[1,)', &
             'their seed'), &
      rule_t('NPHASE', a_whole, '', '', '64', '[1,1024]', &
             'phases that EXACT tries in a turn'), &
      rule_t('CWIRE', a_number, '', 'm', '', '(0,)', &
             'a coil: diameter of the wire; from it follow the stiffness, the number of coils side by side, '// &
             'stress with Wahl''s factor and helix angle at the longest'), &
      rule_t('CDIAM', a_number, '', 'm', '', '(0,)', &
             'a coil: its diameter'), &
      rule_t('CTURNS', a_number, '', '', '', '(0,)', &
             'a coil: its turns'), &
      rule_t('CSHEAR', a_number, '', 'Pa', '79E9', '(0,)', &
             'a coil: shear modulus')]

contains

   !> Read the group. Errors: arcs that are not there, numbers out of range.
   subroutine read_spring_design_group(group, ilink, sketch, springs, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)            !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch          !! its names stand in place of arcs and loops
      type(spring_design_group_t), intent(inout) :: springs
      type(diagnostics_t), intent(inout) :: findings
      type(place_t) :: joint(1)
      integer, parameter :: method_exact = 2        !! among the words of SMETH
      character(*), parameter :: turns_anywhere = 'a torsion spring turns two links wherever it is mounted; leave the distance out'
      integer :: n, method

      springs%given = group%line > 0
      call group%follow(design_items)
      call take_count(group, 'NSFIND', n, findings)
      allocate (springs%first(n), springs%second(n), springs%acts(n))
      allocate (springs%first_reach(n), springs%second_reach(n), springs%stiffest(n), springs%free_low(n), springs%free_high(n), &
                source=0.0_wp)
      call read_places(group, 'P', ilink, springs%first, findings, sketch=sketch)
      call read_places(group, 'Q', ilink, springs%second, findings, sketch=sketch)
      call take(group, 'PREACH', springs%first_reach, findings, repeated=.true.)
      call take(group, 'QREACH', springs%second_reach, findings, repeated=.true.)
      call take(group, 'SKIND', springs%acts, findings)
      call take(group, 'SKMAX', springs%stiffest, findings, repeated=.true.)
      call take(group, 'SFLOW', springs%free_low, findings, repeated=.true.)
      call take(group, 'SFHIGH', springs%free_high, findings, repeated=.true.)
      call refuse_unless(springs%free_low <= springs%free_high, group, 'SFLOW', 'the least free length is above the greatest', &
                         findings)
      springs%free_limited = group%given('SFLOW') .or. group%given('SFHIGH')
      call refuse_unless(springs%free_low >= 0.0_wp .or. springs%acts /= acts_between_points, group, 'SFLOW', &
                         'a free length is not negative', findings)
      call refuse_unless(springs%first_reach <= 0.0_wp .or. springs%acts == acts_between_points, group, 'PREACH', &
                         'a torsion spring, or one along a slide, has no other place than that given: 0 is expected', findings)
      call refuse_unless(springs%second_reach <= 0.0_wp .or. springs%acts == acts_between_points, group, 'QREACH', &
                         'a torsion spring, or one along a slide, has no other place than that given: 0 is expected', findings)
      call refuse_unless(abs(springs%first%distance) <= 0.0_wp .or. springs%acts /= acts_by_turning, group, 'PDIST', &
                         turns_anywhere, findings)
      call refuse_unless(abs(springs%second%distance) <= 0.0_wp .or. springs%acts /= acts_by_turning, group, 'QDIST', &
                         turns_anywhere, findings)
      call take(group, 'SMETH', method, findings)
      springs%exact = method == method_exact
      call take(group, 'SCRIT', springs%criterion, findings)
      springs%of_joint = group%given('SJLINK') .or. group%given('SJNAME')
      if (springs%of_joint) then
         call read_places(group, 'SJ', ilink, joint, findings, ends_only=.true., sketch=sketch)
         springs%joint = joint(1)
         if (springs%criterion == criterion_range) then
            call out_of(group, 'SCRIT', "the load of a joint has no range: give 'RMS' or 'PEAK'", findings)
         end if
      end if
      if (group%given('SJLOOP') .and. .not. springs%of_joint) call required(group, 'SJLINK')
      call take(group, 'NSSTRT', springs%starts, findings)
      call take(group, 'ISSEED', springs%seed, findings)
      call take(group, 'NPHASE', springs%phases, findings)
      call take(group, 'CWIRE', springs%wire, findings)
      call take(group, 'CDIAM', springs%coil, findings)
      call take(group, 'CTURNS', springs%turns, findings)
      call take(group, 'CSHEAR', springs%shear, findings)
      if (.not. springs%given) return
      if (springs%exact .and. (n /= 1 .or. springs%of_joint .or. springs%criterion /= criterion_range)) then
         call out_of(group, 'SMETH', "'EXACT' finds one spring for the range of the drive torque; use 'SEARCH'", findings)
      end if
      if (springs%exact .and. any(springs%acts /= acts_between_points)) &
         call out_of(group, 'SKIND', "SMETH='EXACT' finds a spring between two points; use 'SEARCH'", findings)
      if (springs%wire > 0.0_wp .and. any(springs%acts == acts_by_turning)) &
         call out_of(group, 'CWIRE', 'these coils are pulled; a torsion spring has others: leave CWIRE, CDIAM and CTURNS out', &
                     findings)
      if (any([springs%wire, springs%coil, springs%turns] > 0.0_wp) .and. &
          .not. all([springs%wire, springs%coil, springs%turns] > 0.0_wp)) then
         call out_of(group, 'CWIRE', 'a coil is given by CWIRE, CDIAM and CTURNS together', findings)
      end if
   end subroutine read_spring_design_group

   !> The group as the case has it.
   subroutine read_spring_design(self, group, about, findings)
      class(spring_design_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_spring_design_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_spring_design

   subroutine visit_spring_design(self, visitor)
      class(spring_design_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor
      integer :: k

      do k = 1, size(self%first)
         call visitor%place(self%first(k))
         call visitor%place(self%second(k))
      end do
      if (self%of_joint) call visitor%joint(self%joint)
   end subroutine visit_spring_design

   !> The group SPRNGS of a case; as it is by default where the case does not have it.
   pure function spring_design_of(set) result(springs)
      class(data_set_t), intent(in) :: set
      type(spring_design_group_t) :: springs
      integer :: k

      k = set%place_of('SPRNGS')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (spring_design_group_t)
         springs = group
      end select
   end function spring_design_of
end module psalm_spring_design_group
