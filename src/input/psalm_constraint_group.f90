!> The group CONSTR: where closure and transmission angles must hold, and where joints and links must not go.
module psalm_constraint_group
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_number, a_text, a_whole
   use psalm_segment_items, only: segment_t, read_segments
   use psalm_sketch, only: sketch_t
   use psalm_sketch_names, only: meant
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: shortened, to_text
   implicit none (type, external)
   private
   public :: constraint_items
   public :: constraint_group_t, region_t, segment_t, read_constraint_group, read_least_angle
   public :: range_positions, range_inputs, range_turn, region_box, region_half_plane, region_circle, every_segment

   integer, parameter :: range_positions = 0   !! IRANGE: at the prescribed positions
   integer, parameter :: range_inputs = 1      !! from the lowest to the highest prescribed input
   integer, parameter :: range_turn = 2        !! over a full turn of the crank
   integer, parameter :: region_box = 1, region_half_plane = 2, region_circle = 3 !! RKIND
   integer, parameter :: every_segment = -1    !! RSEG: for each link
   integer, parameter :: numbers_of_region = 4

   !> A region of the machine plane that a joint or a link must keep out of, or stay inside of.
   type :: region_t
      integer :: kind = region_box
      logical :: stay_inside = .false.    !! the outside is forbidden
      real(wp) :: at(numbers_of_region) = 0.0_wp !! two corners; point and angle of the edge; centre, radius
      integer :: arc = 0, loop = 0        !! the joint: finish of the arc (of arc 0: the input pivot); loop 0: output point
      integer :: joint = 0                !! the joint of a sketch
      integer :: segment = 0              !! for this link and no joint; `every_segment`
      real(wp) :: clearance = 0.0_wp      !! least distance from what is forbidden
      type(place_t) :: place = place_t()  !! of a joint that is no end of an arc; link 0: it is one
   end type region_t

   type :: constraint_group_t
      logical :: given = .false.          !! the group was given
      integer :: irange = range_positions
      real(wp) :: least_angle = 0.0_wp    !! TRMIN: least transmission angle, degrees
      logical :: gives_angle = .false.    !! TRMIN was given here
      type(region_t), allocatable :: regions(:)
      type(segment_t), allocatable :: segments(:)
   end type constraint_group_t

   !> The items of the group.
   type(rule_t), parameter :: constraint_items(*) = [ &
      rule_t('TRMIN', a_number, '', 'degrees', '', '[0,90)', &
             'least transmission angle, degrees, in place of TRMIN or TANGLE of &LIMITS, see '// &
             '[there](#tangle-and-trmin)', &
             'is the least transmission angle: at least 0, less than 90 degrees'), &
      rule_t('IRANGE', a_whole, '', '', '0', '[0,2]', &
             'closure, TANGLE or TRMIN, TOGGLE and clearances hold: 0, at the prescribed positions; 1, over the '// &
             'whole range of the inputs; 2, over a full turn of the crank, which then turns fully'), &
      rule_t('NREGN', a_whole, '', '', 'as many as RKIND has', '[0,1000]', &
             'number of forbidden regions'), &
      rule_t('RKIND', a_whole, 'NREGN', '', '', '', &
             'of each region: 1 a box, 2 a half-plane, 3 a circle; negative: its outside is forbidden'), &
      rule_t('RPLACE', a_number, 'NREGN*4', '', '', '', &
             'four numbers for each region: box, x and y of two opposite corners; half-plane, x and y of a '// &
             'point of its edge and the direction of the edge, degrees (what lies left of it is forbidden); '// &
             'circle, x and y of its centre and its radius'), &
      rule_t('RLINK', a_whole, 'NREGN', '', '0', '', &
             'the joint to which it applies: the finish of arc RLINK (negative: its start) of loop RLOOP'), &
      rule_t('RLOOP', a_whole, 'NREGN', '', '0', '', &
             'loop of that arc; 0: the output point'), &
      rule_t('RJNT', a_text, 'NREGN', '', '', '', &
             'of a sketch, in place of RLINK and RLOOP: the joint'), &
      rule_t('RSEG', a_whole, 'NREGN', '', '0', '', &
             'the link to which it applies, in place of a joint: number of a segment, see below; -1: every '// &
             'segment'), &
      rule_t('RCLEAR', a_number, 'NREGN', 'length', '0', '[0,)', &
             'least distance from what is forbidden', &
             'a least distance is at least 0'), &
      rule_t('NSEG', a_whole, '', '', 'as many as SJNT or SLINK has', '[0,100]', &
             'number of links that are segments with a width'), &
      rule_t('SLINK', a_whole, 'NSEG*2', '', '', '', &
             'the arcs at whose ends lie the two points between which each lies, named as by RLINK: '// &
             '`SLINK=-2,2, SLOOP=1,1` is arc 2 of loop 1'), &
      rule_t('SLOOP', a_whole, 'NSEG*2', '', '', '', &
             'the loops of these arcs'), &
      rule_t('SJNT', a_text, 'NSEG', '', '', '', &
             'the same in a sketch: `''A B'',''B C''`'), &
      rule_t('SWIDTH', a_number, 'NSEG', 'length', '0', '[0,)', &
             'width of each; its ends are round', &
             'a width is at least 0'), &
      rule_t('SCLEAR', a_number, 'NSEG', 'length', '0', '[0,)', &
             'least distance of each from the others; of two the larger counts', &
             'a least distance is at least 0'), &
      rule_t('SLAYER', a_whole, 'NSEG', '', '0', '', &
             'the layer in which each moves; links of different layers cannot meet')]

contains

   !> Read the group. Errors: numbers out of range, joints that are not there, regions without extent.
   subroutine read_constraint_group(group, nloop, maxarc, sketch, constr, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: nloop, maxarc
      type(sketch_t), intent(in) :: sketch   !! its joints are called by their names
      type(constraint_group_t), intent(inout) :: constr
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: kinds(:), links(:), loops(:), segments(:)
      real(wp), allocatable :: numbers(:), distances(:)
      character(:), allocatable :: names(:)
      type(diagnostics_t) :: unused
      integer :: n, r, given

      constr%given = group%line > 0
      call group%follow(constraint_items)
      call take(group, 'IRANGE', constr%irange, findings)
      call read_least_angle(group, constr%least_angle, findings)
      constr%gives_angle = group%given('TRMIN')
      call read_segments(group, nloop, maxarc, sketch, constr%segments, findings)
      call take_count(group, 'NREGN', n, findings)
      allocate (constr%regions(n), kinds(n), links(n), loops(n), segments(n))
      kinds = 0
      links = 0
      loops = 0
      segments = 0
      allocate (distances(n), source=0.0_wp)
      allocate (numbers(numbers_of_region*n), source=0.0_wp)
      if (group%given('NREGN') .and. n == 0) then
         if (group%given('RKIND') .or. group%given('RPLACE')) call out_of(group, 'NREGN', 'is 0, but regions are given', findings)
         call read_places(unused)
      else
         call read_places(findings)
      end if
      if (n > 0 .and. given < numbers_of_region*n - 1) then
         call findings%error('four numbers are expected for each of '//to_text(n)//' regions; found '//to_text(given), &
                             line=max(group%item_line('RPLACE'), group%line), group='CONSTR', item='RPLACE')
      end if
      if (size(names) > 0 .and. .not. sketch%given) call wrong('RJNT', 'joints have names in a sketch (&CHAIN) only; RLINK and '// &
                                                               'RLOOP count arcs of &LINKS', 1)
      do r = 1, n
         associate (region => constr%regions(r))
            region%kind = abs(kinds(r))
            region%stay_inside = kinds(r) < 0
            region%at = numbers(numbers_of_region*(r - 1) + 1:numbers_of_region*r)
            region%loop = loops(r)
            region%arc = links(r)
            if (links(r) < 0) region%arc = -links(r) - 1
            region%segment = segments(r)
            region%clearance = distances(r)
            select case (region%kind)
            case (region_box)
               if (region%at(1) == region%at(3) .or. region%at(2) == region%at(4)) call wrong('RPLACE', 'the box has no extent', r)
               region%at = [min(region%at(1), region%at(3)), min(region%at(2), region%at(4)), &
                            max(region%at(1), region%at(3)), max(region%at(2), region%at(4))]
            case (region_half_plane)
               continue
            case (region_circle)
               if (region%at(3) <= 0.0_wp) call wrong('RPLACE', 'the radius must be above 0', r)
            case default
               call wrong('RKIND', '1 (box), 2 (half-plane), 3 (circle) is expected, negative: outside forbidden; found '// &
                          to_text(kinds(r)), r)
            end select
            if (region%segment /= 0) then
               call check_segment(region, r)
            else if (sketch%given) then
               call find_joint(region, r)
            else if (region%loop == 0 .and. links(r) /= 0) then
               call wrong('RLOOP', 'arc '//to_text(links(r))//' is named, but not its loop', r)
            else if (region%loop < 0 .or. region%loop > nloop) then
               call wrong('RLOOP', 'there is no loop '//to_text(region%loop), r)
            else if (region%loop > 0 .and. (region%arc < 0 .or. region%arc > maxarc .or. links(r) == 0)) then
               call wrong('RLINK', 'the number of an arc is expected (negative for the joint at its start); found '// &
                          to_text(links(r)), r)
            end if
         end associate
      end do

   contains

      !> The joint that a region of a sketch is for; arcs and loops are not the user's to count.
      subroutine find_joint(region, which)
         type(region_t), intent(inout) :: region
         integer, intent(in) :: which

         if (links(which) /= 0 .or. region%loop /= 0) then
            call wrong('RLINK', 'RLINK and RLOOP count arcs of &LINKS; the joint of a sketch is named, RJNT', which)
         else if (which > size(names)) then
            call wrong('RJNT', "the joint that it is for is missing, RJNT='P'", which)
         else
            region%joint = sketch%joint_called(trim(adjustl(names(which))))
            if (region%joint == 0) call wrong('RJNT', "no joint is called '"//shortened(trim(names(which)))//"'"// &
                                              meant(trim(names(which)), sketch%joint_name), which)
         end if
      end subroutine find_joint

      !> A region for a link is for no joint.
      subroutine check_segment(region, which)
         type(region_t), intent(in) :: region
         integer, intent(in) :: which

         if (region%segment < every_segment .or. region%segment > size(constr%segments)) then
            call wrong('RSEG', 'the number of a segment is expected (-1: every segment, 0: a joint); found '// &
                       to_text(region%segment)//', and NSEG is '//to_text(size(constr%segments)), which)
         else if (region%segment == every_segment .and. size(constr%segments) == 0) then
            call wrong('RSEG', 'there are no segments; give NSEG', which)
         else if (links(which) /= 0 .or. region%loop /= 0) then
            call wrong('RLINK', 'it is for a segment (RSEG) and cannot be for a joint too', which)
         else if (which <= size(names)) then
            if (len_trim(names(which)) > 0) call wrong('RJNT', 'it is for a segment (RSEG) and cannot be for a joint too', which)
         end if
      end subroutine check_segment

      subroutine read_places(reported)
         type(diagnostics_t), intent(inout) :: reported

         call take(group, 'RKIND', kinds, reported)
         call take(group, 'RLINK', links, reported)
         call take(group, 'RLOOP', loops, reported)
         call group%get_texts('RJNT', names, reported)
         call take(group, 'RSEG', segments, reported)
         call take(group, 'RCLEAR', distances, reported)
         call group%get_reals('RPLACE', numbers, reported, numbers_of_region, last=given)
      end subroutine read_places

      subroutine wrong(item, text, which)
         character(*), intent(in) :: item, text
         integer, intent(in) :: which

         call out_of(group, item, 'region '//to_text(which)//': '//text, findings, &
                     merge(numbers_of_region*(which - 1) + 1, which, item == 'RPLACE'))
      end subroutine wrong
   end subroutine read_constraint_group

   !> TRMIN, the least transmission angle, of a group that has it.
   subroutine read_least_angle(group, least, findings)
      type(group_t), intent(inout) :: group
      real(wp), intent(inout) :: least         !! degrees
      type(diagnostics_t), intent(inout) :: findings

      call take(group, 'TRMIN', least, findings)
   end subroutine read_least_angle
end module psalm_constraint_group
