!> The groups VIBR (vibration of one link) and ESTIM (estimates of several links): the links as uniform beams, and what is asked.
module psalm_vibration_group
   use psalm_beam, only: beam_t
   use psalm_case_group, only: case_group_t, surroundings_t, place_visitor_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_flag, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   implicit none (type, external)
   private
   public :: vibration_items, estimate_items
   public :: vibration_group_t, estimate_group_t, vibration_of, estimates_of

   type, extends(case_group_t) :: vibration_group_t
      type(beam_t) :: beam
      integer :: modes = 1                     !! NMODE
      integer :: last = 16                     !! VPMAX: highest boundary
      real(wp) :: slowest = 0.0_wp, fastest = 0.0_wp !! VSPLOW, VSPHGH: rad/s
      integer :: speeds = 0                    !! NVSPED: speeds in this range
      real(wp) :: given_e = 1.0_wp             !! VEBASE: what e stands for the masses as given
      real(wp) :: greatest_e = 0.0_wp          !! VEMAX: of the chart; 0: no chart
      integer :: in_chart = 41                 !! NVCHRT: values of e in the chart
      integer :: points = 256                  !! NVPNT: positions in a turn
      logical :: stresses = .false.            !! ISTRSS: stresses are wanted
   contains
      procedure :: read => read_vibration
      procedure :: visit_places => visit_vibration
   end type vibration_group_t

   type, extends(case_group_t) :: estimate_group_t
      type(beam_t), allocatable :: beams(:)
      real(wp), allocatable :: clearance(:)    !! ECLEAR: of the pins of each, diametral, m; 0: not known
      integer :: points = 256                  !! NEPNT: positions in a turn
   contains
      procedure :: read => read_estimate
      procedure :: visit_places => visit_estimate
   end type estimate_group_t

   !> The items of VIBR.
   type(rule_t), parameter :: vibration_items(*) = [ &
      rule_t('VLINK', a_whole, '', '', 'required', '', &
             'the arc between the two pins of the link'), &
      rule_t('VLOOP', a_whole, '', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('VNAME', a_text, '1', '', '', '', &
             'of a sketch, in place of both: the link, with more than two joints the two pins: `''rod''`, '// &
             '`''rod B C''`'), &
      rule_t('VMOD', a_number, '', 'Pa', 'required', '(0,)', &
             'Young''s modulus'), &
      rule_t('VRHO', a_number, '', 'kg/m3', 'required', '(0,)', &
             'density'), &
      rule_t('VDEPTH', a_number, '', 'm', '', '(0,)', &
             'rectangular section: depth in the plane of motion'), &
      rule_t('VWIDTH', a_number, '', 'm', '', '(0,)', &
             'rectangular section: width'), &
      rule_t('VAREA', a_number, '', 'm2', '', '(0,)', &
             'any other section: area'), &
      rule_t('VGYR', a_number, '', 'm', '', '(0,)', &
             'any other section: radius of gyration'), &
      rule_t('VZETA', a_number, '', '', '0', '[0,1)', &
             'damping of every mode, part of the critical one'), &
      rule_t('VSHEAR', a_number, '', '', '0', '[0,)', &
             'Young''s modulus/(shear modulus * section factor) for a stocky (Timoshenko) beam; 0: slender'), &
      rule_t('VSTRN', a_number, '', '', '0', '[0,)', &
             'allowable strain of the material; with the depth it gives the least frequency ratio that strength '// &
             'allows'), &
      rule_t('NMODE', a_whole, '', '', '1', '[1,10]', &
             'modes, half waves along the link'), &
      rule_t('VPMAX', a_whole, '', '', '16', '[0,100]', &
             'highest boundary of stability'), &
      rule_t('VSPLOW', a_number, '', 'rad/s', '0', '', &
             'range of speeds for a table of the deflection: the lowest'), &
      rule_t('VSPHGH', a_number, '', 'rad/s', '0', '', &
             'the highest speed'), &
      rule_t('NVSPED', a_whole, '', '', '0', '[0,10000]', &
             'number of speeds in this range'), &
      rule_t('VEMAX', a_number, '', '', '0', '[0,)', &
             'chart of stability: largest e, by which the inertia of all other links is multiplied; 0: no chart'), &
      rule_t('NVCHRT', a_whole, '', '', '41', '[2,1000]', &
             'number of values of e in the chart'), &
      rule_t('VEBASE', a_number, '', '', '1', '(0,)', &
             'the e at which the masses are those given'), &
      rule_t('ISTRSS', a_flag, '', '', '0', '', &
             '1: stresses of the link over the turn, of bending by all modes and along it; needs VDEPTH'), &
      rule_t('NVPNT', a_whole, '', '', '256', '[16,4096]', &
             'positions in a turn')]

   !> The items of ESTIM: those of a beam are VIBR's, one for each link.
   type(rule_t), parameter :: estimate_items(*) = [ &
      rule_t('NESTIM', a_whole, '', '', 'as many as the longest item has', '[0,100000]', &
             'number of links'), &
      rule_t('ELINK', a_whole, 'NESTIM', '', 'required', '', &
             'the arc between the two pins of each link'), &
      rule_t('ELOOP', a_whole, 'NESTIM', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('ENAME', a_text, 'NESTIM', '', '', '', &
             'of a sketch, in place of both: the link, with more than two joints the two pins: `''rod''`, '// &
             '`''rod B C''`'), &
      rule_t('EMOD', a_number, 'NESTIM', 'Pa', 'required', '(0,)', &
             'Young''s modulus'), &
      rule_t('ERHO', a_number, 'NESTIM', 'kg/m3', 'required', '(0,)', &
             'density'), &
      rule_t('EDEPTH', a_number, 'NESTIM', 'm', '', '(0,)', &
             'rectangular section: depth in the plane of motion'), &
      rule_t('EWIDTH', a_number, 'NESTIM', 'm', '', '(0,)', &
             'rectangular section: width'), &
      rule_t('EAREA', a_number, 'NESTIM', 'm2', '', '(0,)', &
             'any other section: area'), &
      rule_t('EGYR', a_number, 'NESTIM', 'm', '', '(0,)', &
             'any other section: radius of gyration'), &
      rule_t('EZETA', a_number, 'NESTIM', '', '0', '[0,1)', &
             'damping of every mode, part of the critical one'), &
      rule_t('ESHEAR', a_number, 'NESTIM', '', '0', '[0,)', &
             'Young''s modulus/(shear modulus * section factor) for a stocky (Timoshenko) beam; 0: slender'), &
      rule_t('ESTRN', a_number, 'NESTIM', '', '0', '[0,)', &
             'allowable strain of the material; with the depth it gives the least frequency ratio that strength '// &
             'allows'), &
      rule_t('ECLEAR', a_number, 'NESTIM', 'm', '0', '[0,)', &
             'diametral clearance of the pins of the link; with it the error by an impact across it is estimated'), &
      rule_t('NEPNT', a_whole, '', '', '256', '[16,4096]', &
             'positions in a turn')]

contains

   !> Read the group VIBR. Errors: a link that is not there, numbers out of range.
   subroutine read_vibration_group(group, ilink, sketch, vibration, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)       !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch     !! its names stand in place of arcs and loops
      type(vibration_group_t), intent(inout) :: vibration
      type(diagnostics_t), intent(inout) :: findings
      type(beam_t) :: beams(1)

      vibration%given = group%line > 0
      call group%follow(vibration_items)
      call read_beams(group, 'V', ilink, sketch, beams, findings)
      vibration%beam = beams(1)
      call take(group, 'NMODE', vibration%modes, findings)
      call take(group, 'VPMAX', vibration%last, findings)
      call take(group, 'VSPLOW', vibration%slowest, findings)
      call take(group, 'ISTRSS', vibration%stresses, findings)
      if (vibration%given .and. vibration%stresses) then
         if (.not. vibration%beam%depth > 0.0_wp) then
            call out_of(group, 'ISTRSS', 'stresses need the depth of the section: give VDEPTH and VWIDTH', findings)
         else if (vibration%beam%shear_ratio > 0.0_wp) then
            call out_of(group, 'ISTRSS', 'stresses are found of slender links: leave VSHEAR out', findings)
         end if
      end if
      call take(group, 'VSPHGH', vibration%fastest, findings)
      call take(group, 'NVSPED', vibration%speeds, findings)
      if (vibration%speeds > 0) then
         if (.not. vibration%slowest > 0.0_wp) call out_of(group, 'VSPLOW', 'speeds must be above 0', findings)
         if (vibration%fastest < vibration%slowest) call out_of(group, 'VSPHGH', 'must not be below VSPLOW', findings)
      end if
      call take(group, 'VEBASE', vibration%given_e, findings)
      call take(group, 'VEMAX', vibration%greatest_e, findings)
      call take(group, 'NVCHRT', vibration%in_chart, findings)
      call take(group, 'NVPNT', vibration%points, findings)
   end subroutine read_vibration_group

   !> Read the group ESTIM. Errors: as above.
   subroutine read_estimate_group(group, ilink, sketch, estimates, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)
      type(sketch_t), intent(in) :: sketch
      type(estimate_group_t), intent(inout) :: estimates
      type(diagnostics_t), intent(inout) :: findings
      integer :: n

      estimates%given = group%line > 0
      call group%follow(estimate_items)
      call take_count(group, 'NESTIM', n, findings)
      allocate (estimates%beams(n))
      allocate (estimates%clearance(n), source=0.0_wp)
      call read_beams(group, 'E', ilink, sketch, estimates%beams, findings)
      call take(group, 'ECLEAR', estimates%clearance, findings)
      call take(group, 'NEPNT', estimates%points, findings)
   end subroutine read_estimate_group

   !> Beams from the items LINK, LOOP, MOD, RHO, AREA, GYR or DEPTH and WIDTH, ZETA, SHEAR, STRN, each with the group's letter
   !> before it.
   subroutine read_beams(group, letter, ilink, sketch, beams, findings)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: letter
      integer, intent(in) :: ilink(:, :)
      type(sketch_t), intent(in) :: sketch
      type(beam_t), intent(inout) :: beams(:)
      type(diagnostics_t), intent(inout) :: findings
      type(place_t) :: places(size(beams))
      character(*), parameter :: items(*) = [character(5) :: 'MOD', 'RHO', 'ZETA', 'SHEAR', 'STRN']
      real(wp) :: depth(size(beams)), width(size(beams)), area(size(beams)), gyration(size(beams))
      real(wp) :: numbers(size(beams), size(items))
      integer :: k
      logical :: rectangle

      call read_places(group, letter, ilink, places, findings, ends_only=.true., sketch=sketch, of_links=.true.)
      beams%link = places
      numbers = reshape([beams%modulus, beams%density, beams%damping, beams%shear_ratio, beams%strain], shape(numbers))
      do k = 1, size(items)
         call take(group, letter//trim(items(k)), numbers(:, k), findings)
      end do
      beams%modulus = numbers(:, 1)
      beams%density = numbers(:, 2)
      beams%damping = numbers(:, 3)
      beams%shear_ratio = numbers(:, 4)
      beams%strain = numbers(:, 5)
      depth = 0.0_wp
      width = 0.0_wp
      area = 0.0_wp
      gyration = 0.0_wp
      call take(group, letter//'DEPTH', depth, findings)
      call take(group, letter//'WIDTH', width, findings)
      call take(group, letter//'AREA', area, findings)
      call take(group, letter//'GYR', gyration, findings)
      if (group%line == 0 .or. size(beams) == 0) return
      rectangle = group%given(letter//'WIDTH')
      if (rectangle .and. (group%given(letter//'AREA') .or. group%given(letter//'GYR'))) then
         call out_of(group, letter//'WIDTH', 'a section is given by its depth and width, or by its area and radius of '// &
                     'gyration, not by both', findings)
      else if (rectangle .and. .not. group%given(letter//'DEPTH')) then
         call required(group, letter//'DEPTH', 'missing; with the width it gives the section')
      else if (.not. rectangle) then
         if (.not. group%given(letter//'AREA')) call required(group, letter//'AREA', 'missing; give the area (m2) and '//letter// &
                                                              'GYR, or '//letter//'DEPTH and '//letter//'WIDTH')
         if (.not. group%given(letter//'GYR')) call required(group, letter//'GYR', 'missing; the radius of gyration (m)')
      end if
      if (rectangle) then
         area = depth*width
         gyration = depth/sqrt(12.0_wp)
      end if
      beams%depth = depth
      beams%area = area
      beams%gyration = gyration
   end subroutine read_beams

   !> The group as the case has it.
   subroutine read_vibration(self, group, about, findings)
      class(vibration_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_vibration_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_vibration

   subroutine visit_vibration(self, visitor)
      class(vibration_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor

      if (self%given) call visitor%line(self%beam%link)
   end subroutine visit_vibration

   !> The group VIBR of a case; as it is by default where the case does not have it.
   pure function vibration_of(set) result(vibration)
      class(data_set_t), intent(in) :: set
      type(vibration_group_t) :: vibration
      integer :: k

      k = set%place_of('VIBR')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (vibration_group_t)
         vibration = group
      end select
   end function vibration_of

   !> The group as the case has it.
   subroutine read_estimate(self, group, about, findings)
      class(estimate_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_estimate_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_estimate

   subroutine visit_estimate(self, visitor)
      class(estimate_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor
      integer :: k

      do k = 1, size(self%beams)
         call visitor%line(self%beams(k)%link)
      end do
   end subroutine visit_estimate

   !> The group ESTIM of a case; as it is by default where the case does not have it.
   pure function estimates_of(set) result(estimates)
      class(data_set_t), intent(in) :: set
      type(estimate_group_t) :: estimates
      integer :: k

      k = set%place_of('ESTIM')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (estimate_group_t)
         estimates = group
      end select
   end function estimates_of
end module psalm_vibration_group
