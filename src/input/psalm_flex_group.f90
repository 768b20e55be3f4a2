!> The group FLEX: links of any planar shape as beam elements, segment by segment, where they are held, and what is asked.
module psalm_flex_group
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
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: flex_items
   public :: flex_group_t, section_of_beam_t, flex_of

   integer, parameter :: fewest_points = 16    !! of a turn: parts of it that the solution is joined from
   real(wp), parameter :: usual_poisson = 0.3_wp !! of metals
   real(wp), parameter :: most_depth = 1000.0_wp !! of a section, in radii of gyration; of a rectangle it is 3.5
   real(wp), parameter :: rounded = 1.0e-3_wp    !! part by which a radius of gyration may be too large as written

   !> A cross section of a beam.
   type :: section_of_beam_t
      real(wp) :: area = 0.0_wp                !! m2
      real(wp) :: gyration = 0.0_wp            !! radius of gyration, m
      real(wp) :: depth = 0.0_wp               !! in the plane of motion, m; 0: not known
      real(wp) :: width = 0.0_wp               !! across it, m; 0: not known
      real(wp) :: gyration_across = 0.0_wp     !! radius of gyration for bending out of the plane, m
      real(wp) :: torsion = 0.0_wp             !! torsion constant, m4; 0: of a rectangle, or of a solid section
   end type section_of_beam_t

   type, extends(case_group_t) :: flex_group_t
      type(place_t), allocatable :: starts(:), ends(:) !! shape (segments)
      real(wp), allocatable :: rise(:)         !! shape (segments): XRISE, user's length
      real(wp), allocatable :: modulus(:), density(:) !! shape (segments): Pa, kg/m3
      real(wp), allocatable :: poisson(:)      !! shape (segments): XPOIS
      type(section_of_beam_t), allocatable :: sections(:, :) !! shape (2, segments): at start and end
      type(place_t), allocatable :: held(:)    !! shape (NXHELD)
      integer :: elements = 8                  !! NXELEM: of a segment
      real(wp) :: damping = 0.0_wp             !! XZETA: of every mode, part of the critical one
      real(wp) :: by_mass = 0.0_wp             !! XALPHA: Rayleigh's damping, 1/s
      real(wp) :: by_stiffness = 0.0_wp        !! XBETA: the same, s
      real(wp) :: strain = 0.0_wp              !! XSTRN: limit of the material; 0: not known
      integer :: modes = 6                     !! NXMODE
      logical :: long_pins = .false.           !! XPINS: they hold the slope out of the plane
      integer :: points = 256                  !! NXPNT: positions in a turn
   contains
      procedure :: read => read_flex
      procedure :: visit_places => visit_flex
   end type flex_group_t

   !> The items of the group.
   type(rule_t), parameter :: flex_items(*) = [ &
      rule_t('NXSEG', a_whole, '', '', 'as many as the longest item has', '[0,1000]', &
             'number of segments; those of one link are rigidly joined where they meet. Of the sizes the last holds for the '// &
             'segments after it'), &
      rule_t('XLINK', a_whole, 'NXSEG', '', 'required', '', &
             'start of each segment: an arc of the link, as in &MASSES'), &
      rule_t('XLOOP', a_whole, 'NXSEG', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('XNAME', a_text, 'NXSEG', '', '', '', &
             'of a sketch, in place of both: the link, and the joint the place is counted from'), &
      rule_t('XDIST', a_number, 'NXSEG', 'length', '0', '', &
             'distance from that end of the arc'), &
      rule_t('XANG', a_number, 'NXSEG', 'degrees', '0', '', &
             'angle from the arc''s direction'), &
      rule_t('YLINK', a_whole, 'NXSEG', '', 'required', '', &
             'end of each segment: an arc of the same link'), &
      rule_t('YLOOP', a_whole, 'NXSEG', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('YNAME', a_text, 'NXSEG', '', '', '', &
             'of a sketch, in place of both: the link, and the joint the place is counted from'), &
      rule_t('YDIST', a_number, 'NXSEG', 'length', '0', '', &
             'distance from that end of the arc'), &
      rule_t('YANG', a_number, 'NXSEG', 'degrees', '0', '', &
             'angle from the arc''s direction'), &
      rule_t('XRISE', a_number, 'NXSEG', 'length', '0', '', &
             'height of a segment that is a circular arc above its chord, to the left of the way from start to end; 0: straight'), &
      rule_t('XMOD', a_number, '1 to NXSEG', 'Pa', 'required', '(0,)', &
             'Young''s modulus'), &
      rule_t('XRHO', a_number, '1 to NXSEG', 'kg/m3', 'required', '(0,)', &
             'density'), &
      rule_t('XDEPTH', a_number, '1 to NXSEG', 'm', '', '(0,)', &
             'depth of the section in the plane of motion, at the start; with the area it is for stresses alone, '// &
             'and from 2 to 1000 times the radius of gyration'), &
      rule_t('XWIDTH', a_number, '1 to NXSEG', 'm', '', '(0,)', &
             'rectangular section: width at the start'), &
      rule_t('XAREA', a_number, '1 to NXSEG', 'm2', '', '(0,)', &
             'any other section: area at the start'), &
      rule_t('XGYR', a_number, '1 to NXSEG', 'm', '', '(0,)', &
             'any other section: radius of gyration at the start'), &
      rule_t('YDEPTH', a_number, '1 to NXSEG', 'm', 'XDEPTH', '(0,)', &
             'depth at the end; it varies evenly along the segment, and so do width, area and radius of gyration'), &
      rule_t('YWIDTH', a_number, '1 to NXSEG', 'm', 'XWIDTH', '(0,)', &
             'width at the end'), &
      rule_t('YAREA', a_number, '1 to NXSEG', 'm2', 'XAREA', '(0,)', &
             'area at the end'), &
      rule_t('YGYR', a_number, '1 to NXSEG', 'm', 'XGYR', '(0,)', &
             'radius of gyration at the end'), &
      rule_t('XGYRO', a_number, '1 to NXSEG', 'm', 'XGYR', '(0,)', &
             'any other section: radius of gyration for bending out of the plane, at the start'), &
      rule_t('YGYRO', a_number, '1 to NXSEG', 'm', 'XGYRO', '(0,)', &
             'the same at the end; without XGYRO it is YGYR'), &
      rule_t('XTORS', a_number, '1 to NXSEG', 'm4', '', '(0,)', &
             'any other section: torsion constant at the start; without it that of a solid section, area**4/(40 polar second '// &
             'moment)'), &
      rule_t('YTORS', a_number, '1 to NXSEG', 'm4', 'XTORS', '(0,)', &
             'torsion constant at the end'), &
      rule_t('XPOIS', a_number, '1 to NXSEG', '', '0.3', '[0,0.5]', &
             'Poisson''s ratio, for twist: the shear modulus is XMOD/(2(1 + XPOIS))'), &
      rule_t('XPINS', a_flag, '', '', '0', '', &
             'out of the plane the pins hold a link in place, 0: but not its slope (short or spherical bearings); 1: and its '// &
             'slope and twist (long bearings)'), &
      rule_t('NXHELD', a_whole, '', '', 'as many as the longest item has', '[0,1000]', &
             'number of joints named by XHLINK or XHNAME'), &
      rule_t('XHLINK', a_whole, 'NXHELD', '', '', '', &
             'joints between which a link bends: two of a link, on whose line it stays, or one, where it is clamped; the end '// &
             'of an arc of the link'), &
      rule_t('XHLOOP', a_whole, 'NXHELD', '', '', '', &
             'the loop of that arc'), &
      rule_t('XHNAME', a_text, 'NXHELD', '', '', '', &
             'of a sketch, in place of both: the link and the joint'), &
      rule_t('NXELEM', a_whole, '', '', '8', '[1,64]', &
             'elements in a segment, at least'), &
      rule_t('XZETA', a_number, '', '', '0', '[0,1)', &
             'damping of every mode, part of the critical one'), &
      rule_t('XALPHA', a_number, '', '1/s', '0', '[0,)', &
             'Rayleigh''s damping, by mass: XALPHA/(2 frequency) more of the critical damping'), &
      rule_t('XBETA', a_number, '', 's', '0', '[0,)', &
             'Rayleigh''s damping, by stiffness: XBETA*frequency/2 more of the critical damping'), &
      rule_t('XSTRN', a_number, '', '', '0', '[0,)', &
             'allowable strain of the material'), &
      rule_t('NXMODE', a_whole, '', '', '6', '[1,20]', &
             'natural modes; what higher ones add is taken from statics'), &
      rule_t('NXPNT', a_whole, '', '', '256', '[16,4096]', &
             'positions in a turn, a multiple of 16')]

contains

   !> Read the group. Errors: places that are not there, numbers out of range, sections that are not complete.
   subroutine read_flex_group(group, ilink, sketch, flex, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)       !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch     !! its names stand in place of arcs and loops
      type(flex_group_t), intent(inout) :: flex
      type(diagnostics_t), intent(inout) :: findings
      integer :: n, h

      flex%given = group%line > 0
      call group%follow(flex_items)
      call take_count(group, 'NXSEG', n, findings)
      call take_count(group, 'NXHELD', h, findings)
      allocate (flex%starts(n), flex%ends(n), flex%held(h), flex%sections(2, n))
      allocate (flex%rise(n), flex%modulus(n), flex%density(n), source=0.0_wp)
      allocate (flex%poisson(n), source=usual_poisson)
      call read_places(group, 'X', ilink, flex%starts, findings, sketch=sketch)
      call read_places(group, 'Y', ilink, flex%ends, findings, sketch=sketch)
      call read_places(group, 'XH', ilink, flex%held, findings, ends_only=.true., sketch=sketch, of_links=.true.)
      call take(group, 'XRISE', flex%rise, findings)
      call take(group, 'XMOD', flex%modulus, findings, repeated=.true.)
      call take(group, 'XRHO', flex%density, findings, repeated=.true.)
      call take(group, 'XPOIS', flex%poisson, findings, repeated=.true.)
      call read_sections(group, n, flex%sections, findings)
      call take(group, 'XPINS', flex%long_pins, findings)
      call take(group, 'NXELEM', flex%elements, findings)
      call take(group, 'XZETA', flex%damping, findings)
      call take(group, 'XALPHA', flex%by_mass, findings)
      call take(group, 'XBETA', flex%by_stiffness, findings)
      call take(group, 'XSTRN', flex%strain, findings)
      call take(group, 'NXMODE', flex%modes, findings)
      call take(group, 'NXPNT', flex%points, findings)
      if (modulo(flex%points, fewest_points) /= 0) call out_of(group, 'NXPNT', 'must be a multiple of 16', findings)
      if (flex%given .and. n == 0) call out_of(group, 'NXSEG', 'there are no segments', findings)
   end subroutine read_flex_group

   !> Sections at start and end of every segment.
   subroutine read_sections(group, n, sections, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: n                 !! segments
      type(section_of_beam_t), intent(inout) :: sections(:, :) !! shape (2, n)
      type(diagnostics_t), intent(inout) :: findings
      character(*), parameter :: letters(2) = ['X', 'Y']
      character(*), parameter :: sizes(6) = [character(5) :: 'DEPTH', 'WIDTH', 'AREA', 'GYR', 'GYRO', 'TORS']
      real(wp) :: values(n, size(sizes), 2)
      integer :: e, k
      logical :: rectangle

      values = 0.0_wp
      do e = 1, 2
         if (e == 2) values(:, :, 2) = values(:, :, 1)
         do k = 1, size(sizes)
            call take(group, letters(e)//trim(sizes(k)), values(:, k, e), findings, repeated=.true.)
         end do
      end do
      if (group%line == 0 .or. n == 0) return
      rectangle = group%given('XWIDTH')
      if (rectangle .and. (group%given('XAREA') .or. group%given('XGYR'))) then
         call out_of(group, 'XWIDTH', 'sections are given by depth and width, or by area and radius of gyration, not by both', &
                     findings)
      else if (rectangle) then
         if (.not. group%given('XDEPTH')) call required(group, 'XDEPTH', 'missing; with the width it gives the section')
         call refuse_end('AREA', 'the sections are rectangles: give YDEPTH and YWIDTH')
         call refuse_end('GYR', 'the sections are rectangles: give YDEPTH and YWIDTH')
         do e = 1, 2
            do k = 5, 6
               if (group%given(letters(e)//trim(sizes(k)))) &
                  call out_of(group, letters(e)//trim(sizes(k)), 'the sections are rectangles: depth and width give it', findings)
            end do
         end do
      else
         if (.not. group%given('XAREA')) call required(group, 'XAREA', 'missing; give the area (m2) and XGYR, or XDEPTH and XWIDTH')
         if (.not. group%given('XGYR')) call required(group, 'XGYR', 'missing; the radius of gyration (m)')
         call refuse_end('WIDTH', 'the sections have area and radius of gyration: give YAREA and YGYR')
         if (.not. group%given('XGYRO')) then
            call refuse_end('GYRO', 'needs XGYRO, the radius at the start')
            values(:, 5, :) = values(:, 4, :)
         end if
         if (.not. group%given('XTORS')) call refuse_end('TORS', 'needs XTORS, the constant at the start')
         do e = 1, 2
            if (.not. group%given(letters(e)//'DEPTH')) cycle
            do k = 1, n
               if (values(k, 1, e) < 2.0_wp*values(k, 4, e)*(1.0_wp - rounded)) then
                  call out_of(group, letters(e)//'DEPTH', 'no section of this depth has that radius of gyration: it is at most '// &
                              'half of the depth', findings, k)
               else if (values(k, 1, e) > most_depth*values(k, 4, e)) then
                  call out_of(group, letters(e)//'DEPTH', 'the depth is more than '//to_text(nint(most_depth))// &
                              ' times the radius of gyration: no section is like that', findings, k)
               end if
            end do
         end do
      end if
      do e = 1, 2
         sections(e, :)%depth = values(:, 1, e)
         sections(e, :)%width = values(:, 2, e)
         sections(e, :)%area = merge(values(:, 1, e)*values(:, 2, e), values(:, 3, e), rectangle)
         sections(e, :)%gyration = merge(values(:, 1, e)/sqrt(12.0_wp), values(:, 4, e), rectangle)
         sections(e, :)%gyration_across = merge(values(:, 2, e)/sqrt(12.0_wp), values(:, 5, e), rectangle)
         sections(e, :)%torsion = values(:, 6, e)
      end do

   contains

      subroutine refuse_end(name, text)
         character(*), intent(in) :: name, text

         if (group%given('Y'//name)) call out_of(group, 'Y'//name, text, findings)
      end subroutine refuse_end
   end subroutine read_sections

   !> The group as the case has it.
   subroutine read_flex(self, group, about, findings)
      class(flex_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_flex_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_flex

   subroutine visit_flex(self, visitor)
      class(flex_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor
      integer :: k

      do k = 1, size(self%starts)
         call visitor%place(self%starts(k))
         call visitor%place(self%ends(k))
      end do
      do k = 1, size(self%held)
         call visitor%place(self%held(k))
      end do
   end subroutine visit_flex

   !> The group FLEX of a case; as it is by default where the case does not have it.
   pure function flex_of(set) result(flex)
      class(data_set_t), intent(in) :: set
      type(flex_group_t) :: flex
      integer :: k

      k = set%place_of('FLEX')
      if (k > 0) then
         select type (group => set%sections(k)%group)
         type is (flex_group_t)
            flex = group
            return
         end select
      end if
      allocate (flex%starts(0), flex%ends(0), flex%rise(0), flex%modulus(0), flex%density(0), flex%sections(2, 0), flex%held(0))
      allocate (flex%poisson(0))
   end function flex_of
end module psalm_flex_group
