!> The group CLEAR: a revolute joint with clearance.
module psalm_clearance_group
   use psalm_case_group, only: case_group_t, surroundings_t, place_visitor_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_number, a_text, a_whole, a_word
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   implicit none (type, external)
   private
   public :: clearance_items
   public :: clearance_group_t, clearance_of, losses_any, losses_passage

   integer, parameter :: most_charts = 6
   real(wp), parameter :: greatest_h3 = 0.999_wp
   integer, parameter :: losses_any = 1, losses_passage = 2 !! the words of CLOSS
   real(wp), parameter :: usual_h3(3) = [0.25_wp, 0.5_wp, 0.75_wp] !! of the published charts

   type, extends(case_group_t) :: clearance_group_t
      type(place_t) :: joint                   !! CLINK, CLOOP: the end of an arc that is the joint; of a sketch CNAME
      real(wp) :: diametral = 0.0_wp           !! CDIAM: diametral clearance, user's length
      real(wp) :: restitution = 0.0_wp         !! CREST
      real(wp) :: frequency = 0.0_wp           !! CFREQ: rad/s
      integer :: counted = losses_any          !! CLOSS: the losses that the exit status and the critical speed are about
      real(wp) :: begin = 0.0_wp               !! CBEGIN: input at which following begins, degrees from the reference position
      logical :: begins = .false.              !! it is given; else following begins where the load is largest
      real(wp) :: slowest = 0.0_wp, fastest = 0.0_wp !! CSPLOW, CSPHGH: rad/s
      integer :: speeds = 0                    !! NCSPED: speeds in this range
      integer :: points = 512                  !! NCPNT: positions in a turn
      integer :: radii = 0                     !! NCRAD: values of H1 in the standard charts; 0: no charts
      integer :: angles = 72                   !! NCANG: values of H2
      real(wp) :: greatest_h1 = 2.0_wp         !! CHMAX
      real(wp), allocatable :: h3(:)           !! CEPS: one for each chart
   contains
      procedure :: read => read_clearance
      procedure :: visit_places => visit_clearance
   end type clearance_group_t

   !> The items of the group.
   type(rule_t), parameter :: clearance_items(*) = [ &
      rule_t('CLINK', a_whole, '', '', 'required', '', &
             'the joint: the finish of this arc, with a negative CLINK its start'), &
      rule_t('CLOOP', a_whole, '', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('CNAME', a_text, '1', '', '', '', &
             'of a sketch in their place: the joint, where it pins more than two links with the one that turns '// &
             'in it: `''B''`, `''B rod''`'), &
      rule_t('CDIAM', a_number, '', 'length', 'required', '(0,)', &
             'diametral clearance', &
             'must be above 0: without clearance contact is never lost'), &
      rule_t('CREST', a_number, '', '', '0', '[0,1]', &
             'coefficient of restitution', &
             'must lie between 0 and 1'), &
      rule_t('CFREQ', a_number, '', 'rad/s', '0', '[0,)', &
             'lowest natural frequency of the links that the force of the joint bends or stretches; the listing says what '// &
             'a pulse of that force does to them', &
             'must not be negative (0: nothing is said of elastic links)'), &
      rule_t('CLOSS', a_word, '', '', 'ANY', 'ANY PASSAGE', &
             'losses that count for the exit status and the critical speed: ''ANY'', or ''PASSAGE'', those in the '// &
             'passage, which measurements confirm; a load that passes through zero always counts'), &
      rule_t('CBEGIN', a_number, '', 'degrees', 'where the load is largest', '', &
             'where following begins: increment of the input from the reference position'), &
      rule_t('CSPLOW', a_number, '', 'rad/s', '0', '', &
             'range of speeds for a table of verdicts: the lowest'), &
      rule_t('CSPHGH', a_number, '', 'rad/s', '0', '', &
             'the highest speed'), &
      rule_t('NCSPED', a_whole, '', '', '0', '[0,10000]', &
             'number of speeds in this range'), &
      rule_t('NCPNT', a_whole, '', '', '512', '[32,4096]', &
             'positions in a turn'), &
      rule_t('NCRAD', a_whole, '', '', '0', '[0,400]', &
             'standard charts: values of H1 on each radial line; 0: no charts'), &
      rule_t('NCANG', a_whole, '', '', '72', '[8,720]', &
             'standard charts: values of H2'), &
      rule_t('CHMAX', a_number, '', '', '2', '(0,)', &
             'largest H1 of the charts'), &
      rule_t('CEPS', a_number, '1 to 6', '', '0.25,0.5,0.75', '[0,0.999]', &
             'H3 of each chart', &
             'values of H3 lie between 0 and 0.999')]

contains

   !> Read the group. Errors: an arc that is not there, no clearance, numbers out of range.
   subroutine read_clearance_group(group, ilink, sketch, clearance, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)       !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch     !! its names stand in place of arcs and loops
      type(clearance_group_t), intent(inout) :: clearance
      type(diagnostics_t), intent(inout) :: findings
      type(place_t) :: places(1)
      real(wp) :: h3(most_charts)

      clearance%given = group%line > 0
      call group%follow(clearance_items)
      call read_places(group, 'C', ilink, places, findings, ends_only=.true., sketch=sketch)
      clearance%joint = places(1)
      call take(group, 'CDIAM', clearance%diametral, findings)
      call take(group, 'CREST', clearance%restitution, findings)
      call take(group, 'CFREQ', clearance%frequency, findings)
      call take(group, 'CLOSS', clearance%counted, findings)
      call take(group, 'CBEGIN', clearance%begin, findings)
      clearance%begins = group%given('CBEGIN')
      call take(group, 'CSPLOW', clearance%slowest, findings)
      call take(group, 'CSPHGH', clearance%fastest, findings)
      call take(group, 'NCSPED', clearance%speeds, findings)
      call take(group, 'NCPNT', clearance%points, findings)
      call take(group, 'NCRAD', clearance%radii, findings)
      call take(group, 'NCANG', clearance%angles, findings)
      call take(group, 'CHMAX', clearance%greatest_h1, findings)
      h3 = -1.0_wp
      call group%get_reals('CEPS', h3, findings)
      clearance%h3 = usual_h3
      if (group%given('CEPS')) clearance%h3 = pack(h3, abs(h3 + 1.0_wp) > 0.0_wp)
      if (.not. clearance%given) return
      if (any(clearance%h3 < 0.0_wp .or. clearance%h3 > greatest_h3)) then
         call out_of(group, 'CEPS', 'values of H3 lie between 0 and 0.999', findings)
      end if
      if (clearance%speeds == 0) return
      if (.not. clearance%slowest > 0.0_wp) call out_of(group, 'CSPLOW', 'speeds must be above 0', findings)
      if (clearance%fastest < clearance%slowest) call out_of(group, 'CSPHGH', 'must not be below CSPLOW', findings)
   end subroutine read_clearance_group

   !> The group as the case has it.
   subroutine read_clearance(self, group, about, findings)
      class(clearance_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_clearance_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_clearance

   subroutine visit_clearance(self, visitor)
      class(clearance_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor

      if (self%given) call visitor%joint(self%joint)
   end subroutine visit_clearance

   !> The group CLEAR of a case; as it is by default where the case does not have it.
   pure function clearance_of(set) result(clearance)
      class(data_set_t), intent(in) :: set
      type(clearance_group_t) :: clearance
      integer :: k

      k = set%place_of('CLEAR')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (clearance_group_t)
         clearance = group
      end select
   end function clearance_of
end module psalm_clearance_group
