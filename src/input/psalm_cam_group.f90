!> The group CAM: the law of motion of a cam, its follower, and what is asked of its shape.
module psalm_cam_group
   use psalm_cam_data, only: vary_names, first_of_segments, of_zones, goal_base, goal_outer, goal_stress, cam_group_t, roller_t, &
                             follower_flat, fit_spline, most_pieces
   use psalm_cam_kind, only: law_kind, law_dwell, law_modtrap, law_trig, law_names, has_zones, zones_of, zone_count
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, check_range, out_of, required
   use psalm_kinds, only: wp, full_turn
   use psalm_rule, only: rule_t, a_flag, a_number, a_text, a_whole, a_word
   use psalm_sketch, only: sketch_t
   use psalm_sketch_names, only: common_link, find_joints
   use psalm_link_place, only: refuse_unless
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text, upper_case
   implicit none (type, external)
   private
   public :: cam_items, cam_section_t, cams_of

   real(wp), parameter :: half_turn = 0.5_wp*full_turn
   character(4), parameter :: first_cam = 'CAM', second_cam = 'CAM2' !! groups

   type, extends(case_group_t) :: cam_section_t
      type(cam_group_t) :: cam
   contains
      procedure :: read => read_cam
   end type cam_section_t

   !> The items of the group.
   type(rule_t), parameter :: cam_items(*) = [ &
      rule_t('NSEG', a_whole, '', '', 'as many as SEGEND has', '[0,200]', &
             'number of segments of the law; or NTAB, a table'), &
      rule_t('SEGEND', a_number, 'NSEG', 'degrees', '', '', &
             'cam angle at the end of each segment; the last is 360'), &
      rule_t('SEGOUT', a_number, 'NSEG', '', '', '', &
             'output at the end of each segment, in its own unit'), &
      rule_t('OUT0', a_number, '', '', '0', '', &
             'output at cam angle 0'), &
      rule_t('LAW', a_text, 'NSEG', '', '''MODTRAP''', '', &
             'of each segment: ''DWELL'', ''RAMP'', ''CYCLOIDAL'', ''HARMONIC'', ''PARABOLIC'', ''MODTRAP'', '// &
             '''MODSINE'', ''MCV50'', ''POLY345'', ''POLY4567'', ''TRIG'', ''POLY'''), &
      rule_t('SEGVEL', a_number, 'NSEG', '', '0', '', &
             'velocity at the end of each segment, per radian of cam; next to a ramp it is that of the ramp'), &
      rule_t('SEGACC', a_number, 'NSEG', '', '0', '', &
             '''POLY'': acceleration there'), &
      rule_t('SEGJRK', a_number, 'NSEG', '', '0', '', &
             '''POLY'': jerk there; the degree is 7 if it is given, else 5'), &
      rule_t('TZONE', a_number, 'NSEG*7', '', 'modified trapezoid', '[0,)', &
             '''TRIG'': seven widths for each segment in any scale: acceleration as quarter sine up, constant, '// &
             'quarter cosine down, none, then the same for the retardation'), &
      rule_t('NTAB', a_whole, '', '', 'as many as TABOUT has', '[6,2000]', &
             'number of points of a table over one turn, in place of segments'), &
      rule_t('TABANG', a_number, 'NTAB', 'degrees', 'equal steps from 0', '', &
             'cam angles of the table'), &
      rule_t('TABOUT', a_number, 'NTAB', '', '', '', &
             'outputs of the table'), &
      rule_t('KTAB', a_whole, '', '', '5', '3 5', &
             'degree of its periodic spline', &
             'the degree of the spline is 5 or 3'), &
      rule_t('TABTOL', a_number, '', '', '0', '[0,)', &
             'largest distance of the smoothest curve from the points, 0 for through them (a warning says if '// &
             'that makes a rough law)'), &
      rule_t('TABFIT', a_word, '', '', 'SPLINE', 'SPLINE LSQ', &
             '''SPLINE'': a knot at every point, through them or within TABTOL; ''LSQ'': equal pieces, by least '// &
             'squares'), &
      rule_t('NPIECE', a_whole, '', '', 'by TABTOL', '', &
             '''LSQ'': pieces of the curve; where it is not given the fewest that stay within TABTOL of all '// &
             'points'), &
      rule_t('TABWT', a_number, '1 to NTAB', '', '1', '[0,)', &
             '''LSQ'': weights of the points', &
             'a weight must not be negative'), &
      rule_t('VELMAX', a_number, '', '', '0', '[0,)', &
             '''LSQ'': bound of the first derivative of the curve, in the unit of the table per radian of cam; '// &
             '0: none'), &
      rule_t('ACCMAX', a_number, '', '', '0', '[0,)', &
             '''LSQ'': bound of its second derivative; 0: none'), &
      rule_t('KOUT', a_flag, '', '', '1', '', &
             '1: law of the output, 0: of the input'), &
      rule_t('KAXIS', a_whole, '', '', '1, &CAM2: 2', '[1,1000]', &
             'component of the output (MOTION 0: 1 x, 2 y); of a sketch solved in poses the number among all of '// &
             '&OUTPUTS'), &
      rule_t('KDEAD', a_flag, '', '', '0', '', &
             '1: pass dead points at which the law has no acceleration, 0: turn back there (below)'), &
      rule_t('NFOLLK', a_whole, '', '', '1', '', &
             'arc that carries the follower, as NOUTLK: negative from its start, else from its end'), &
      rule_t('NFOLLP', a_whole, '', '', '1', '', &
             'the loop of that arc'), &
      rule_t('FOLJNT', a_text, '1', '', '', '', &
             'of a sketch, in place of NFOLLK: the joint that carries the roller, or two joints of a link, a '// &
             'line that is taken for the arc'), &
      rule_t('FOLLK', a_number, '', 'length', '0', '[0,)', &
             'distance from there to the roller''s centre, or to a point of the flat face', &
             'the length is negative; turn FOLANG by 180 instead'), &
      rule_t('FOLANG', a_number, '', 'degrees', '0', '', &
             'angle of that line from the arc''s direction'), &
      rule_t('KFOL', a_whole, '', '', '1', '[1,2]', &
             '1 roller, 2 flat face'), &
      rule_t('FACANG', a_number, '', 'degrees', '90', '', &
             'direction of the face''s normal, out of the cam, from that arc'), &
      rule_t('RROLL', a_number, '', 'length', '0', '[0,)', &
             'radius of the roller, at most 100 times the cam''s extent; 0: knife edge'), &
      rule_t('RCUT', a_number, '', 'length', 'RROLL', '(0,)', &
             'radius of the cutter or wheel, at most 100 times the cam''s extent', &
             'the cutter needs a radius above 0'), &
      rule_t('XCAM', a_number, '', 'length', '0', '', &
             'x of the centre of the cam'), &
      rule_t('YCAM', a_number, '', 'length', '0', '', &
             'y of the centre of the cam'), &
      rule_t('KTURN', a_whole, '', '', '1', '-1 1', &
             '1: it turns anticlockwise, -1: clockwise', &
             'must be 1 (anticlockwise) or -1'), &
      rule_t('KSIDE', a_whole, '', '', '0', '[-1,1]', &
             '0: the cam lies where its centre is; 1, -1: left or right of the way the roller goes seen from '// &
             'the cam'), &
      rule_t('KCONJ', a_flag, '', '', '0', '', &
             '1: a conjugate cam on the same shaft, its roller on the same arc'), &
      rule_t('FOLLK2', a_number, '', 'length', '0', '[0,)', &
             'distance to the centre of that roller', &
             'the length is negative; turn FOLAN2 by 180 instead'), &
      rule_t('FOLAN2', a_number, '', 'degrees', '0', '', &
             'angle of that line from the arc''s direction'), &
      rule_t('RROLL2', a_number, '', 'length', 'RROLL', '[0,)', &
             'radius of that roller'), &
      rule_t('CAMERR', a_number, '2', 'length', '0', '', &
             'what is missing on the profiles of the cam and of its conjugate, square to them; negative: too '// &
             'much'), &
      rule_t('KTRACK', a_flag, '', '', '0', '', &
             '1: the roller runs in a closed track; the cutter is as wide as the track'), &
      rule_t('CLEAR', a_number, '', 'length', '0', '[0,)', &
             'clearance of the roller in the track; with KPAIR the largest gap allowed'), &
      rule_t('KPAIR', a_flag, '', '', '0', '', &
             '1: a second roller runs on the same profile (FOLLK2, FOLAN2, RROLL2)'), &
      rule_t('NFOL2K', a_whole, '', '', 'NFOLLK', '', &
             'arc of the second roller'), &
      rule_t('NFOL2P', a_whole, '', '', 'NFOLLP', '', &
             'the loop of that arc'), &
      rule_t('KHALF', a_flag, '', '', '0', '', &
             '1: the segments are those of half a turn, the last SEGEND is 180; in the other half the output is '// &
             'the complement, so that outputs half a turn apart have one sum'), &
      rule_t('KCAM', a_whole, '', '', '1', '[1,2]', &
             '1: the cam turns; 2: it slides in the direction CAMDIR by CAMLEN while the cam angle goes evenly '// &
             'from 0 to 360'), &
      rule_t('CAMDIR', a_number, '', 'degrees', '0', '', &
             'direction in which the cam slides'), &
      rule_t('CAMLEN', a_number, '', 'length', '', '(0,)', &
             'way that the cam slides', &
             'must be above 0; turn CAMDIR by 180 instead'), &
      rule_t('ALFMAX', a_number, '', 'degrees', '30', '(0,90)', &
             'limit of the pressure angle', &
             'must lie between 0 and 90 degrees'), &
      rule_t('KALF', a_flag, '', '', '0', '', &
             '1: it holds only while the follower leaves the centre'), &
      rule_t('RHOMIN', a_number, '', 'length', '0', '[0,)', &
             'least convex radius of curvature'), &
      rule_t('WFACE', a_number, '', 'length', '0', '[0,)', &
             'half length of the face; 0: no limit'), &
      rule_t('TOLCUT', a_number, '', 'length', '0.01', '(0,)', &
             'largest deviation of the arcs that profile and cutter path are made of'), &
      rule_t('KGCODE', a_flag, '', '', '0', '', &
             '1: G-code too'), &
      rule_t('CAMRPM', a_number, '', 'rev/min', '0', '[0,)', &
             'forces: speed of the cam; 0: none', &
             'must not be negative; KTURN says which way'), &
      rule_t('CAMWID', a_number, '', 'length', '0', '[0,)', &
             'length of the line of contact; 0: no stress'), &
      rule_t('CAMMOD', a_number, '2', 'Pa', '206E9', '(0,)', &
             'Young''s moduli of cam and follower'), &
      rule_t('CAMNU', a_number, '2', '', '0.3', '[0,0.5]', &
             'Poisson''s ratios of cam and follower', &
             'must lie between 0 and 0.5'), &
      rule_t('PHERTZ', a_number, '', 'Pa', '0', '[0,)', &
             'limit of the stress; 0: none'), &
      rule_t('CAMMU', a_number, '', '', '0', '[0,)', &
             'friction between cam and follower, where it slides; of a roller what is left of it'), &
      rule_t('CAMFRQ', a_number, '', '', '0', '[0,)', &
             'flexible drive: frequency of what the cam drives over the cam''s speed; the cam has the law that '// &
             'makes the load follow LAW; 0: rigid'), &
      rule_t('CAMZET', a_number, '', '', '0', '[0,)', &
             'flexible drive: damping to the frame, part of the critical one'), &
      rule_t('VARY', a_text, 'n', '', '', '', &
             'numbers that a search may change, as `''XCAM'',''YCAM'',''TZONE 1 3''`'), &
      rule_t('VARLOW', a_number, 'n', '', '', '', &
             'their lower bounds'), &
      rule_t('VARHI', a_number, 'n', '', '', '', &
             'their upper bounds'), &
      rule_t('GOAL', a_word, '', '', 'BASE', 'BASE OUTER ALPHA RHO ACCEL STRESS', &
             'what is to be least: BASE (base radius), OUTER (outer radius), ALPHA (pressure angle), RHO '// &
             '(greatest convex curvature), ACCEL (second derivative of the input), STRESS'), &
      rule_t('NPOINT', a_whole, '', '', '360', '[12,100000]', &
             'cam angles of the tables')]

contains

   !> Read the group CAM. Errors: segments or tables that are too short or do not rise, laws that are not there, arcs that are
   !> not there, numbers out of range.
   subroutine read_cam_group(group, ilink, sketch, cam, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)       !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings

      cam%given = group%line > 0
      call group%follow(cam_items)
      call read_segments(group, cam, findings)
      call read_table(group, cam, findings)
      call read_follower(group, ilink, cam, findings)
      call read_pair(group, ilink, cam, findings)
      call read_slide(group, cam, findings)
      call read_joints(group, sketch, cam, findings)
      call read_variations(group, cam, findings)
      call take(group, 'ALFMAX', cam%pressure_angle, findings)
      call take(group, 'KALF', cam%rise_only, findings)
      call take(group, 'RHOMIN', cam%least_radius, findings)
      call take(group, 'WFACE', cam%half_face, findings)
      call take(group, 'TOLCUT', cam%tolerance, findings)
      call take(group, 'KGCODE', cam%code, findings)
      if (cam%code .and. .not. cam%cutter > 0.0_wp) call out_of(group, 'KGCODE', 'a program needs a cutter: give RCUT', findings)
      call take(group, 'NPOINT', cam%points, findings)
   end subroutine read_cam_group

   subroutine read_segments(group, cam, findings)
      type(group_t), intent(inout) :: group
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      real(wp), allocatable :: zones(:)
      integer :: n, k, last(2), zones_given, slides
      real(wp) :: whole

      call take(group, 'KHALF', cam%half, findings)
      whole = merge(half_turn, full_turn, cam%half)
      call take(group, 'KCAM', slides, findings)
      cam%slides = slides == 2
      if (cam%slides .and. cam%half) call out_of(group, 'KHALF', 'a cam that slides has no other half of its turn', findings)
      call take_count(group, 'NSEG', n, findings)
      if (cam%given .and. n == 0 .and. .not. (group%given('NTAB') .or. group%given('TABOUT'))) call required(group, 'NSEG', &
         'missing; the number of segments of the law (or NTAB, a table over one turn)')
      allocate (cam%finish(n), cam%output(n), cam%velocity(n), cam%acceleration(n), cam%jerk(n), source=0.0_wp)
      allocate (cam%law(n), source=law_modtrap)
      allocate (zones(zone_count*n), source=0.0_wp)
      call take(group, 'SEGEND', cam%finish, findings, last=last(1))
      call take(group, 'SEGOUT', cam%output, findings, last=last(2))
      call take(group, 'OUT0', cam%start, findings)
      call take(group, 'SEGVEL', cam%velocity, findings)
      call take(group, 'SEGACC', cam%acceleration, findings)
      call take(group, 'SEGJRK', cam%jerk, findings)
      cam%jerks = group%given('SEGJRK')
      call group%get_texts('LAW', names, findings)
      call group%get_reals('TZONE', zones, findings, zone_count, last=zones_given)
      allocate (cam%zones(zone_count, n), source=0.0_wp)
      if (n == 0) return
      if (.not. group%given('SEGEND')) call required(group, 'SEGEND')
      if (.not. group%given('SEGOUT')) call required(group, 'SEGOUT')
      if (group%given('SEGEND') .and. last(1) < n) call short('SEGEND', last(1))
      if (group%given('SEGOUT') .and. last(2) < n) call short('SEGOUT', last(2))
      if (size(names) > n) call out_of(group, 'LAW', to_text(n)//' segments are announced by NSEG, but '//to_text(size(names))// &
                                       ' laws given', findings, n + 1)
      do k = 1, min(n, size(names))
         if (len_trim(names(k)) == 0) cycle
         cam%law(k) = law_kind(upper_case(trim(names(k))))
         if (cam%law(k) > 0) cycle
         call out_of(group, 'LAW', 'entry '//to_text(k)//": there is no law '"//trim(names(k))//"'; the laws are "//all_laws(), &
                     findings, k)
         cam%law(k) = law_modtrap
      end do
      do k = 1, n
         if (has_zones(cam%law(k))) cam%zones(:, k) = zones_of(cam%law(k))
         associate (own => zones(zone_count*(k - 1) + 1:zone_count*k))
            if (zones_given <= zone_count*(k - 1) .or. .not. any(abs(own) > 0.0_wp)) cycle
            if (any(own < 0.0_wp)) then
               call out_of(group, 'TZONE', 'segment '//to_text(k)//': a zone has no negative width', findings, &
                           zone_count*(k - 1) + findloc(own < 0.0_wp, .true., dim=1))
            else if (cam%law(k) == law_trig) then
               cam%zones(:, k) = own/sum(own)
               if (.not. (any(own(:3) > 0.0_wp) .and. any(own(5:) > 0.0_wp))) call out_of(group, 'TZONE', 'segment '// &
                  to_text(k)//': zones 1 to 3 accelerate and 5 to 7 retard; one side has no width', findings, &
                  zone_count*(k - 1) + 1)
            else
               call out_of(group, 'TZONE', 'segment '//to_text(k)//" is of the law "//trim(law_names(cam%law(k)))// &
                           "; only 'TRIG' has zones of the user's", findings, zone_count*(k - 1) + 1)
            end if
         end associate
      end do
      if (group%given('SEGOUT')) call refuse_unless(cam%law /= law_dwell .or. &
                                                    .not. abs(cam%output - [cam%start, cam%output(:n - 1)]) > 0.0_wp, &
                                                    group, 'SEGOUT', 'a dwell ends where it begins', findings)
      if (.not. group%given('SEGEND')) return
      do k = 1, n
         if (k > 1) then
            if (.not. cam%finish(k) > cam%finish(k - 1)) then
               call out_of(group, 'SEGEND', 'entry '//to_text(k)//': the cam angles must rise', findings, k)
               return
            end if
         else if (.not. cam%finish(1) > 0.0_wp) then
            call out_of(group, 'SEGEND', 'entry 1: the first segment begins at 0; it must end above', findings)
            return
         end if
      end do
      if (abs(cam%finish(n) - whole) > 0.0_wp) call out_of(group, 'SEGEND', 'the last segment must end at '// &
                                                          trim(merge('180, for KHALF=1', '360             ', cam%half)), &
                                                          findings, n)
      if (cam%half) then
         call add_complement(cam)
      else if (group%given('SEGOUT') .and. abs(cam%output(n) - cam%start) > 0.0_wp .and. .not. cam%slides) then
         call out_of(group, 'SEGOUT', 'the last segment must end where the first begins, at OUT0', findings, n)
      end if

   contains

      subroutine short(item, last)
         character(*), intent(in) :: item
         integer, intent(in) :: last

         call out_of(group, item, to_text(n)//' segments are announced by NSEG, but only '//to_text(last)//' values given', &
                     findings)
      end subroutine short

      pure function all_laws() result(text)
         character(:), allocatable :: text
         integer :: i

         text = trim(law_names(1))
         do i = 2, size(law_names)
            text = text//', '//trim(law_names(i))
         end do
      end function all_laws
   end subroutine read_segments

   !> The other half of the turn: the sum of the outputs half a turn apart stays the same.
   pure subroutine add_complement(cam)
      type(cam_group_t), intent(inout) :: cam
      real(wp) :: zones(zone_count, 2*size(cam%finish))
      integer :: n

      n = size(cam%finish)
      zones(:, :n) = cam%zones
      zones(:, n + 1:) = cam%zones
      cam%zones = zones
      cam%output = [cam%output, cam%start + cam%output(n) - cam%output]
      cam%finish = [cam%finish, half_turn + cam%finish]
      cam%law = [cam%law, cam%law]
      cam%velocity = [cam%velocity, -cam%velocity]
      cam%acceleration = [cam%acceleration, -cam%acceleration]
      cam%jerk = [cam%jerk, -cam%jerk]
   end subroutine add_complement

   !> How the curve of a table of n points is to be found.
   subroutine read_fit(group, n, cam, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: n
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings

      call take(group, 'TABFIT', cam%fit, findings)
      call take(group, 'NPIECE', cam%pieces, findings)
      call take(group, 'TABWT', cam%weight, findings)
      if (n > 0 .and. .not. any(cam%weight > 0.0_wp)) call out_of(group, 'TABWT', 'no point has a weight', findings)
      call take(group, 'VELMAX', cam%most_velocity, findings)
      call take(group, 'ACCMAX', cam%most_acceleration, findings)
      if (cam%fit == fit_spline) then
         call only_of_fit('NPIECE')
         call only_of_fit('TABWT')
         call only_of_fit('VELMAX')
         call only_of_fit('ACCMAX')
         return
      end if
      if (group%given('NPIECE')) then
         call check_range(group, 'NPIECE', cam%pieces, cam%degree + 1, min(n, most_pieces), findings)
      else if (.not. cam%table_tolerance > 0.0_wp) then
         call required(group, 'NPIECE', 'missing; TABFIT=''LSQ'' needs the number of pieces, or the tolerance TABTOL')
      end if

   contains

      subroutine only_of_fit(item)
         character(*), intent(in) :: item

         if (group%given(item)) call out_of(group, item, 'is of TABFIT=''LSQ'' only', findings)
      end subroutine only_of_fit
   end subroutine read_fit

   subroutine read_table(group, cam, findings)
      type(group_t), intent(inout) :: group
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      integer :: n, k, last(2)

      call take_count(group, 'NTAB', n, findings)
      allocate (cam%table_at(n), cam%table(n), source=0.0_wp)
      allocate (cam%weight(n), source=1.0_wp)
      call take(group, 'TABANG', cam%table_at, findings, last=last(1))
      call take(group, 'TABOUT', cam%table, findings, last=last(2))
      call take(group, 'KTAB', cam%degree, findings)
      call take(group, 'TABTOL', cam%table_tolerance, findings)
      call read_fit(group, n, cam, findings)
      if (n == 0) return
      if (cam%slides) call out_of(group, 'NTAB', 'a table is of a cam that turns', findings)
      if (size(cam%finish) > 0) then
         call out_of(group, 'NTAB', 'a table is the law of the whole turn: leave NSEG out, or NTAB', findings)
         return
      end if
      if (last(2) < n) call out_of(group, 'TABOUT', to_text(n)//' values are announced by NTAB, but only '//to_text(last(2))// &
                                   ' given', findings)
      if (.not. group%given('TABANG')) then
         cam%table_at = [(full_turn*real(k - 1, wp)/real(n, wp), k=1, n)]
         return
      end if
      if (last(1) < n) then
         call out_of(group, 'TABANG', to_text(n)//' values are announced by NTAB, but only '//to_text(last(1))//' given', findings)
         return
      end if
      if (abs(cam%table_at(1)) > 0.0_wp) call out_of(group, 'TABANG', 'the table begins at 0', findings)
      do k = 2, n
         if (cam%table_at(k) > cam%table_at(k - 1)) cycle
         call out_of(group, 'TABANG', 'entry '//to_text(k)//': the cam angles must rise', findings, k)
         return
      end do
      if (cam%table_at(n) >= full_turn) call out_of(group, 'TABANG', 'the table ends before 360, where it begins again', &
                                                  findings, n)
   end subroutine read_table

   !> What a search may change, and what it is to make least.
   subroutine read_variations(group, cam, findings)
      type(group_t), intent(inout) :: group
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      real(wp), allocatable :: low(:), high(:)
      integer :: k, n, given(2), numbers(2), first, state
      character(:), allocatable :: word

      call group%get_texts('VARY', names, findings)
      n = size(names)
      allocate (cam%variations(n))
      allocate (low(max(1, n)), high(max(1, n)), source=0.0_wp)
      call take(group, 'VARLOW', low, findings, last=given(1))
      call take(group, 'VARHI', high, findings, last=given(2))
      call take(group, 'GOAL', cam%goal, findings)
      if (cam%goal == goal_stress .and. .not. (cam%speed > 0.0_wp .and. cam%width > 0.0_wp)) call out_of(group, 'GOAL', &
         'stress needs CAMRPM and CAMWID', findings)
      if (n > 0 .and. cam%slides .and. (cam%goal == goal_base .or. cam%goal == goal_outer)) call out_of(group, 'GOAL', &
         'a cam that slides has no base circle: make something else least', findings)
      if (n > 0 .and. any(given < n)) call out_of(group, 'VARY', 'each number that varies needs bounds, VARLOW and VARHI', findings)
      do k = 1, n
         associate (one => cam%variations(k))
            names(k) = adjustl(names(k))
            first = index(trim(names(k))//' ', ' ')
            word = upper_case(names(k) (:first - 1))
            one%item = findloc(vary_names == word, .true., dim=1)
            numbers = 0
            state = 0
            if (one%item >= first_of_segments) then
               read (names(k) (first:), *, iostat=state) numbers(:merge(2, 1, one%item == of_zones))
            else if (len_trim(names(k) (first:)) > 0) then
               state = 1
            end if
            one%segment = numbers(1)
            one%zone = numbers(2)
            one%low = low(k)
            one%high = high(k)
            if (one%item == 0) then
               call out_of(group, 'VARY', "'"//trim(names(k))//"' cannot vary; it is XCAM, YCAM, FOLLK, FOLANG, FACANG, RROLL, "// &
                           "ORIGLK, ORIGNG, 'SEGEND 1', 'SEGVEL 1', 'SEGACC 1' or 'TZONE 1 2' (segment, zone)", findings, k)
               one%item = 1
               cycle
            end if
            if (one%item >= first_of_segments .and. state == 0) then
               if (one%segment < 1 .or. one%segment > size(cam%finish)) state = 1
               if (one%item == of_zones .and. (one%zone < 1 .or. one%zone > zone_count)) state = 1
               if (word == 'SEGEND' .and. one%segment == size(cam%finish)) state = 1
            end if
            if (cam%half .and. one%item >= first_of_segments) call out_of(group, 'VARY', "'"//trim(names(k))// &
               "': a segment of half a turn (KHALF) cannot vary", findings, k)
            if (state /= 0) then
               call out_of(group, 'VARY', "'"//trim(names(k))//"': there is no such segment or zone to vary", findings, k)
            else if (word == 'TZONE') then
               if (cam%law(one%segment) /= law_trig) call out_of(group, 'VARY', "'"//trim(names(k))// &
                                                                 "': only 'TRIG' has zones of the user's", findings, k)
            end if
            if (n > 0 .and. all(given >= n) .and. .not. one%high > one%low) call out_of(group, 'VARHI', 'entry '//to_text(k)// &
               ': must be above VARLOW', findings, k)
         end associate
      end do
   end subroutine read_variations

   !> What of a sketch carries the follower.
   subroutine read_joints(group, sketch, cam, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(in) :: sketch
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      integer, allocatable :: joints(:)
      logical :: valid

      call group%get_texts('FOLJNT', names, findings)
      if (size(names) == 0) return
      if (.not. sketch%given) then
         call out_of(group, 'FOLJNT', 'joints have names in a sketch (&CHAIN) only; NFOLLK is the arc of &LINKS', findings)
         return
      end if
      if (group%given('NFOLLK')) call out_of(group, 'NFOLLK', 'the follower is on an arc or on joints (FOLJNT), not both', findings)
      if (.not. sketch%valid) return
      call find_joints(group, 'FOLJNT', 1, trim(names(1)), 'the follower', sketch, findings, joints, valid)
      if (.not. valid) return
      if (size(names) > 1 .or. size(joints) < 1 .or. size(joints) > 2) then
         call out_of(group, 'FOLJNT', "one text with one joint or two, as 'B' or 'A B'", findings)
         return
      end if
      cam%joints = [joints(1), joints(size(joints))]
      cam%link = common_link(sketch, cam%joints)
      if (cam%link == 0) call out_of(group, 'FOLJNT', 'the two joints are of no common link', findings)
      if (size(joints) == 1 .and. (cam%kind == follower_flat .or. cam%roller%distance > 0.0_wp)) &
         call out_of(group, 'FOLJNT', 'FOLLK and the direction of a face are counted from a line: name two joints', findings)
   end subroutine read_joints

   !> A second roller on the same profile, on an arc of its own; errors of the profiles of conjugate cams.
   subroutine read_pair(group, ilink, cam, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      logical :: there

      call take(group, 'KPAIR', cam%pair, findings)
      cam%second_arc = merge(-cam%arc, cam%arc, cam%from_start)
      cam%second_loop = cam%loop
      call take(group, 'NFOL2K', cam%second_arc, findings)
      call take(group, 'NFOL2P', cam%second_loop, findings)
      cam%second_from_start = cam%second_arc < 0
      cam%second_arc = abs(cam%second_arc)
      call take(group, 'CAMERR', cam%errors, findings)
      if (group%given('CAMERR') .and. .not. cam%conjugate) call out_of(group, 'CAMERR', 'is of conjugate cams (KCONJ=1)', findings)
      if (.not. cam%pair) then
         if (group%given('NFOL2K')) call out_of(group, 'NFOL2K', 'is of two rollers on one profile (KPAIR=1)', findings)
         if (group%given('NFOL2P')) call out_of(group, 'NFOL2P', 'is of two rollers on one profile (KPAIR=1)', findings)
         return
      end if
      if (cam%conjugate .or. cam%track) call out_of(group, 'KPAIR', &
         'the second roller runs on the same profile, on a conjugate cam (KCONJ), or there is a track (KTRACK)', findings)
      if (cam%kind == follower_flat) call out_of(group, 'KPAIR', 'two rollers on one profile: KFOL=1', findings)
      if (size(ilink) == 0) return
      there = cam%second_loop >= 1 .and. cam%second_loop <= size(ilink, 2) .and. cam%second_arc >= 1 &
              .and. cam%second_arc <= size(ilink, 1)
      if (there) there = ilink(cam%second_arc, cam%second_loop) /= 0
      if (.not. there) call out_of(group, 'NFOL2K', 'there is no arc '//to_text(cam%second_arc)//' in loop '// &
                                   to_text(cam%second_loop), findings)
   end subroutine read_pair

   !> The way of a cam that slides.
   subroutine read_slide(group, cam, findings)
      type(group_t), intent(inout) :: group
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings

      call take(group, 'CAMDIR', cam%direction, findings)
      call take(group, 'CAMLEN', cam%travel, findings)
      if (.not. cam%slides) then
         if (group%given('CAMDIR')) call out_of(group, 'CAMDIR', 'is of a cam that slides (KCAM=2)', findings)
         if (group%given('CAMLEN')) call out_of(group, 'CAMLEN', 'is of a cam that slides (KCAM=2)', findings)
         return
      end if
      if (.not. group%given('CAMLEN')) then
         call required(group, 'CAMLEN', 'missing; the way of the cam while the law goes from 0 to 360')
      end if
      if (cam%kind == follower_flat) call out_of(group, 'KFOL', 'a cam that slides needs a roller or a knife edge', findings)
      if (cam%pair) call out_of(group, 'KPAIR', 'a cam that slides has one roller, or a track or a conjugate', findings)
      if (group%given('KTURN')) call out_of(group, 'KTURN', 'a cam that slides does not turn', findings)
   end subroutine read_slide

   subroutine read_follower(group, ilink, cam, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings

      call take(group, 'KOUT', cam%of_output, findings)
      call take(group, 'KDEAD', cam%through, findings)
      call take(group, 'KAXIS', cam%axis, findings)
      call take(group, 'NFOLLK', cam%arc, findings)
      call take(group, 'NFOLLP', cam%loop, findings)
      cam%from_start = cam%arc < 0
      cam%arc = abs(cam%arc)
      if (cam%given .and. size(ilink) > 0) then
         if (cam%loop < 1 .or. cam%loop > size(ilink, 2)) then
            call out_of(group, 'NFOLLP', 'there is no loop '//to_text(cam%loop), findings)
         else if (cam%arc < 1 .or. cam%arc > size(ilink, 1)) then
            call out_of(group, 'NFOLLK', 'there is no arc '//to_text(cam%arc)//' in loop '//to_text(cam%loop), findings)
         else if (ilink(cam%arc, cam%loop) == 0) then
            call out_of(group, 'NFOLLK', 'there is no arc '//to_text(cam%arc)//' in loop '//to_text(cam%loop), findings)
         end if
      end if
      call take(group, 'FOLLK', cam%roller%distance, findings)
      call take(group, 'FOLANG', cam%roller%angle, findings)
      call take(group, 'RROLL', cam%roller%radius, findings)
      call take(group, 'KFOL', cam%kind, findings)
      call take(group, 'FACANG', cam%face_angle, findings)
      cam%cutter = cam%roller%radius
      call take(group, 'RCUT', cam%cutter, findings)
      cam%cutter_given = group%given('RCUT')
      call take(group, 'XCAM', cam%x, findings)
      call take(group, 'YCAM', cam%y, findings)
      call take(group, 'KTURN', cam%turn, findings)
      call take(group, 'KSIDE', cam%side, findings)
      call take(group, 'KCONJ', cam%conjugate, findings)
      call take(group, 'KTRACK', cam%track, findings)
      cam%second = roller_t(0.0_wp, 0.0_wp, cam%roller%radius)
      call take(group, 'FOLLK2', cam%second%distance, findings)
      call take(group, 'FOLAN2', cam%second%angle, findings)
      call take(group, 'RROLL2', cam%second%radius, findings)
      call take(group, 'CLEAR', cam%clearance, findings)
      if (cam%conjugate .and. cam%track) call out_of(group, 'KTRACK', &
         'a cam has a conjugate (KCONJ) or runs in a track, not both', findings)
      if (cam%track .and. .not. cam%roller%radius > 0.0_wp) call out_of(group, 'KTRACK', 'a track needs a roller', findings)
      if ((cam%track .or. cam%conjugate) .and. cam%kind == follower_flat) call out_of(group, 'KFOL', &
         'conjugate cams and tracks need rollers', findings)
      call take(group, 'CAMRPM', cam%speed, findings)
      call take(group, 'CAMWID', cam%width, findings)
      call take(group, 'CAMMOD', cam%modulus, findings)
      call take(group, 'CAMNU', cam%poisson, findings)
      call take(group, 'CAMMU', cam%friction, findings)
      call take(group, 'PHERTZ', cam%stress, findings)
      call take(group, 'CAMFRQ', cam%frequency, findings)
      call take(group, 'CAMZET', cam%damping, findings)
   end subroutine read_follower

   !> The group as the case has it.
   subroutine read_cam(self, group, about, findings)
      class(cam_section_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      if (group%name == second_cam) self%cam%axis = 2
      call read_cam_group(group, about%ilink, about%sketch, self%cam, findings)
      self%given = self%cam%given
      if (self%given .and. group%name == second_cam .and. .not. about%sketch%given) call out_of(group, 'NSEG', &
         'a second cam needs a second drive, which a sketch can have (&CHAIN, &DRIVES)', findings)
   end subroutine read_cam

   !> The groups CAM and CAM2 of a case; as they are by default where the case does not have them.
   pure function cams_of(set) result(cams)
      class(data_set_t), intent(in) :: set
      type(cam_group_t) :: cams(2)
      integer :: which, k

      do which = 1, size(cams)
         k = set%place_of(trim(merge(first_cam, second_cam, which == 1)))
         if (k == 0) cycle
         select type (group => set%sections(k)%group)
         type is (cam_section_t)
            cams(which) = group%cam
         end select
      end do
   end function cams_of
end module psalm_cam_group
