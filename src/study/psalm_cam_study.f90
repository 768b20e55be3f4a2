!> Everything that calm finds of a cam: what cannot be made is found before any work is done. Data in, results out.
module psalm_cam_study
   use psalm_cam_chain, only: cam_chain_t, make_cam_chain, numbers_of
   use psalm_cam_contact, only: cam_contact_t, find_contact
   use psalm_cam_centres, only: centres_t, admissible_centres, tightest_angles, sharpen_centres
   use psalm_cam_data, only: cam_group_t, follower_flat
   use psalm_cam_interference, only: interference_t, find_interference
   use psalm_cam_law, only: law_t, law_joint_t, make_law, law_made, law_velocity_jumps, law_jerk_jumps, &
                           law_points_missing, law_beyond_tolerance, highest_law_order
   use psalm_cam_motion, only: chained_motion, prepare_cam_motion
   use psalm_cam_pair, only: gap_t, find_gap, greatest_in, least_in, play_of
   use psalm_cam_crossing, only: ways_t, ways_found, ways_jump, ways_infinite, ways_end
   use psalm_cam_paths, only: cam_path_t, find_paths, path_pitch, path_cutter
   use psalm_cam_profile, only: cam_points_t
   use psalm_cam_shape, only: cam_shape_t, cam_extreme_t, samples_t, measure, sample_turn, find_extreme, measures, &
                              measure_pressure, measure_convex, measure_concave, measure_base, measure_excursion_low, &
                              measure_face_low, measure_face_high, table_angles, upward
   use psalm_cam_trace, only: cam_trace_t, fault_none, fault_reach, fault_dead_point, fault_on_axis, fault_standstill
   use psalm_closure, only: closure_t, state_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, new_problem
   use psalm_force_model, only: force_model_t, make_force_model
   use psalm_kinds, only: wp, full_turn
   use psalm_preparation, only: prepared_t
   use psalm_sketch_assembly, only: assemble_sketch
   use psalm_status, only: diagnostics_t
   use psalm_number_format, only: number_words
   use psalm_text, only: to_text
   use psalm_shown_input, only: reference_input
   implicit none (type, external)
   private
   public :: cam_role_t, role_cam, role_conjugate, role_outer_wall, parts_of
   public :: make_shape, cam_of_part, find_sampled_contact
   public :: cam_study_t, check_cam, find_cam, way_rise, way_return, way_dwell

   integer, parameter :: way_rise = 1, way_return = 2, way_dwell = 3 !! the follower leaves the cam's centre, comes back, rests
   integer, parameter :: role_cam = 1, role_conjugate = 2, role_outer_wall = 3 !! what of a case a study is of
   real(wp), parameter :: largest_wheel = 100.0_wp !! radius of a roller or a cutter, in the greatest distance from the cam's axis
   real(wp), parameter :: rounding = 1.0e-9_wp   !! by which a cutter may seem to exceed a hollow
   real(wp), parameter :: fit = 1.0e-9_wp        !! part of the cam's size by which a second roller may seem not to fit
   integer, parameter :: most_of_table = 8000    !! places where a table's derivatives are looked at
   integer, parameter :: coarse_table = 4        !! changes of sign of the third derivative to each of the first
   integer, parameter :: sharpenings = 3         !! of the polygon of centres at the smallest cam: each squares the error

   !> What a study is of.
   type :: cam_role_t
      integer :: cam = 1                             !! 1 the group CAM, 2 CAM2
      integer :: role = role_cam
   end type cam_role_t

   !> The largest pressure angle of a segment.
   type :: rise_t
      integer :: way = way_dwell
      type(cam_extreme_t) :: pressure
   end type rise_t

   type :: cam_study_t
      type(cam_role_t) :: part
      type(cam_group_t) :: cam                       !! with the roller and the cutter of this part
      type(cam_shape_t) :: shape
      type(law_joint_t), allocatable :: joints(:)        !! of the pieces of the law
      ! table
      real(wp), allocatable :: angle(:)              !! degrees
      type(cam_trace_t) :: states
      type(cam_points_t) :: points
      ! extremes over the turn
      type(cam_extreme_t) :: extremes(measures)          !! radii for curvatures, distances for `measure_base`
      type(rise_t), allocatable :: segments(:)
      logical :: hollow = .false.                    !! the profile is concave somewhere
      logical :: undercut = .false.                  !! the roller cannot follow the pitch curve, or a flat face a hollow
      logical :: gouge = .false.                     !! the cutter is larger than a hollow
      type(interference_t) :: roller, cutter
      type(cam_path_t) :: paths(path_pitch:path_cutter)
      type(centres_t) :: centres(2)                  !! of a roller: to the left and to the right of its way
      type(cam_contact_t), allocatable :: contact        !! at the angles of the table; not allocated: no CAMRPM
      type(cam_contact_t), allocatable :: fine           !! and at those of the samples
      logical :: lost = .false., stressed = .false., jammed = .false. !! contact is lost at this speed; PHERTZ is not kept; friction
      real(wp), allocatable :: play(:)               !! of conjugate cams with CAMERR, at the angles of the table
      type(gap_t), allocatable :: second             !! roller on the same profile, at those angles
      type(cam_trace_t) :: second_states             !! and what it does
      class(cam_shape_t), allocatable :: other        !! and its motion
      type(cam_extreme_t) :: least_slack, most_slack     !! of the play, or of the gap
      logical :: tight = .false., loose = .false.    !! the second roller does not fit, or with more than CLEAR
      real(wp), allocatable :: flanks(:, :)          !! shape (2, changes): cam angles where the flank changes, jerk of the input
      real(wp) :: least_base = 0.0_wp                !! of a flat face: base radius with which the profile is just convex
      logical :: steep = .false., sharp = .false., face_short = .false. !! ALFMAX, RHOMIN, WFACE are not kept
   contains
      procedure :: is_violating
   end type cam_study_t

contains

   !> True if the cam cannot do what is wanted, or a limit is not kept.
   pure logical function is_violating(self)
      class(cam_study_t), intent(in) :: self

      is_violating = self%undercut .or. self%gouge .or. self%roller%depth > 0.0_wp .or. self%cutter%depth > 0.0_wp .or. &
                     self%steep .or. self%sharp .or. self%face_short .or. self%lost .or. self%stressed .or. &
                     self%jammed .or. self%tight .or. self%loose
   end function is_violating

   !> Its errors: no cam, a law that cannot be made or whose velocity jumps, outputs out of reach, dead points, a linkage that does
   !> not close, a roller's centre on the cam's axis or at rest on the cam, a face that turns with the cam, cams for drives that
   !> are not there.
   subroutine check_cam(set, cams, prepared, findings)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      type(prepared_t), intent(in) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      class(cam_shape_t), allocatable :: shape     ! large: it would fill a small stack
      type(samples_t) :: samples
      integer :: first, k

      if (.not. cams(1)%given) then
         call findings%error('the group is missing: it says what the cam is to do', line=set%title_line, group='CAM')
         return
      end if
      if (size(cams(2)%variations) > 0) call complain(set, 2, 'VARY', 'a search changes the first cam alone', findings)
      if (size(cams(1)%variations) > 0) then
         if (is_chained(set, cams)) call complain(set, 1, 'VARY', 'a search takes one drive on the frame, no gears, and the '// &
                                            'follower on an arc (NFOLLK)', findings)
         if (set%search%nstart > 1) call complain(set, 1, 'VARY', 'the search begins at the numbers given: leave NSTART out', &
                                                  findings)
      end if
      do k = 1, merge(2, 1, cams(2)%given)
         if (allocated(shape)) deallocate (shape)
         allocate (shape)
         call make_shape(set, cams, prepared, cam_role_t(cam=k), shape, findings)
         if (findings%failed()) return
         call assess_table(set, cam_of_part(cams, cam_role_t(cam=k)), k, findings)
         call sample_turn(shape, cam_of_part(cams, cam_role_t(cam=k)), samples)
         first = findloc(samples%states%fault /= fault_none, .true., dim=1)
         if (first > 0) then
            call refuse_motion(set, cams, k, shape, samples, first, findings)
            return
         end if
         first = 0
         if (.not. shape%flat) first = findloc(abs(samples%states%by_input) > 0.0_wp, .false., dim=1)
         if (first > 0) then
            call complain(set, k, merge('FOLJNT', 'NFOLLK', allocated(shape%motion%chain)), &
                          'the follower does not move with the input at '//number_words(samples%angle(first))// &
                          ' degrees; FOLLK is its distance from the arc''s end', findings)
            return
         end if
         if (merge(cams(1)%conjugate, cams(2)%conjugate, k == 1)) then
            call check_conjugate(set, cams, prepared, k, findings)
            if (findings%failed()) return
         end if
         if (cams(1)%pair .and. k == 1) then
            call check_second(set, cams, prepared, samples, findings)
            if (findings%failed()) return
         end if
         call assess_wheels(set, k, shape, samples, findings)
         if (findings%failed()) return
         first = findloc(samples%possible, .false., dim=1)
         if (shape%flat .and. first == 0) then
            ! from slower than the cam to faster there is an angle at which it turns with it
            associate (faster => samples%states%turning(1, :) > shape%axes%sense)
               first = findloc(faster .neqv. faster(1), .true., dim=1)
            end associate
         end if
         if (first > 0) call complain(set, k, 'KFOL', 'the flat face turns with the cam at '//number_words(samples%angle(first))// &
                                      ' degrees: it touches nowhere', findings)
      end do
   end subroutine check_cam

   !> A roller or a cutter beside which the cam is a point: every place of the profile would have to be held against every other.
   subroutine assess_wheels(set, cam, shape, samples, findings)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: cam                  !! 1 or 2
      type(cam_shape_t), intent(in) :: shape
      type(samples_t), intent(in) :: samples
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: extent

      extent = maxval(abs(samples%points%pitch))
      call assess('RROLL', shape%roller, 'a roller', 'the roller''s centre')
      if (findings%failed()) return
      extent = max(extent, maxval(abs(samples%points%profile)))
      call assess('RCUT', shape%cutter, 'a cutter', 'the cam')

   contains

      subroutine assess(item, radius, wheel, what)
         character(*), intent(in) :: item, wheel, what
         real(wp), intent(in) :: radius

         if (.not. radius > largest_wheel*extent) return
         call complain(set, cam, item, wheel//' of radius '//number_words(radius)//', but '//what//' is at most '// &
                       number_words(extent)//' from the cam''s axis: give at most '// &
                       number_words(largest_wheel*extent), findings)
      end subroutine assess
   end subroutine assess_wheels

   !> The roller of the conjugate cam has a profile too.
   subroutine check_conjugate(set, cams, prepared, cam, findings)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      type(prepared_t), intent(in) :: prepared
      integer, intent(in) :: cam                  !! 1 or 2
      type(diagnostics_t), intent(inout) :: findings
      class(cam_shape_t), allocatable :: shape     ! large: it would fill a small stack
      type(samples_t) :: samples
      type(cam_role_t) :: part
      integer :: first

      allocate (shape)
      part = cam_role_t(cam, role_conjugate)
      call make_shape(set, cams, prepared, part, shape, findings)
      if (findings%failed()) return
      call sample_turn(shape, cam_of_part(cams, part), samples)
      first = findloc(samples%states%fault /= fault_none, .true., dim=1)
      if (first > 0) call refuse_motion(set, cams, cam, shape, samples, first, findings)
   end subroutine check_conjugate

   !> The linkage that carries the second roller closes at every cam angle.
   subroutine check_second(set, cams, prepared, samples, findings)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      type(prepared_t), intent(in) :: prepared
      type(samples_t), intent(in) :: samples
      type(diagnostics_t), intent(inout) :: findings
      class(cam_shape_t), allocatable :: shape     ! large: it would fill a small stack
      type(cam_trace_t) :: states
      integer :: first

      allocate (shape)
      call make_shape(set, cams, prepared, cam_role_t(role=role_conjugate), shape, findings)
      if (findings%failed()) return
      call shape%motion%trace(samples%angle, samples%piece, states)
      first = findloc(states%fault /= fault_none, .true., dim=1)
      if (first > 0) call complain(set, 1, 'NFOL2K', 'the linkage that carries the second roller does not close, or is at a '// &
                                   'dead point, at '//number_words(samples%angle(first))//' degrees', findings)
   end subroutine check_second

   !> A table whose third derivative changes its sign much more often than its slope is coarse.
   subroutine assess_table(set, given, cam, findings)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: given
      integer, intent(in) :: cam                  !! 1 or 2
      type(diagnostics_t), intent(inout) :: findings
      type(law_t) :: law
      real(wp) :: y(0:highest_law_order)
      real(wp), allocatable :: slope(:), jerk(:)
      integer :: k, n

      if (size(given%table) == 0) return
      call make_law(given, law)
      if (law%state /= law_made) return
      n = min(most_of_table, 4*size(given%table))
      allocate (slope(n), jerk(n))
      do k = 1, n
         y = law%evaluate(full_turn*real(k - 1, wp)/real(n, wp), law%piece_at(full_turn*real(k - 1, wp)/real(n, wp)))
         slope(k) = y(1)
         jerk(k) = y(3)
      end do
      if (changes(jerk) > coarse_table*max(changes(slope), 2)) &
         call set%origins%warning(findings, group_of(cam), 'TABOUT', 'the third derivative through the table changes its sign '// &
                                  to_text(changes(jerk))//' times, the first '//to_text(changes(slope))//' times: if the '// &
                                  'numbers are rounded give their tolerance, TABTOL', 1)

   contains

      pure integer function changes(values)
         real(wp), intent(in) :: values(:)

         changes = count(values*[values(2:), values(1)] < 0.0_wp)
      end function changes
   end subroutine assess_table

   subroutine complain(set, cam, item, text, findings)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: cam                  !! 1 or 2
      character(*), intent(in) :: item, text
      type(diagnostics_t), intent(inout) :: findings

      call set%origins%error(findings, group_of(cam), item, text, 1)
   end subroutine complain

   !> Name of the group of a cam.
   pure function group_of(cam) result(name)
      integer, intent(in) :: cam
      character(:), allocatable :: name

      name = trim(merge('CAM2', 'CAM ', cam == 2))
   end function group_of

   !> Law, motion and radii of a cam. Errors: as `check_cam`'s, of what is wrong before the cam turns.
   subroutine make_shape(set, cams, prepared, part, shape, findings)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      type(prepared_t), intent(in) :: prepared
      type(cam_role_t), intent(in) :: part
      type(cam_shape_t), intent(inout) :: shape
      type(diagnostics_t), intent(inout) :: findings
      type(cam_group_t) :: cam
      type(law_t), allocatable :: laws(:)
      type(law_joint_t), allocatable :: joints(:)
      real(wp), allocatable :: at(:)
      integer :: k, other

      cam = cam_of_part(cams, part)
      allocate (laws(merge(2, 1, cams(2)%given)))
      do k = 1, size(laws)
         call make_law(cam_of_part(cams, cam_role_t(cam=k)), laws(k))
         if (laws(k)%state == law_made) cycle
         call refuse_law(set, k, laws(k), findings)
         return
      end do
      if (is_chained(set, cams)) then
         ! both laws are cut at the joints of both
         if (size(laws) == 2) then
            do k = 1, 2
               other = 3 - k
               joints = laws(other)%joints()
               at = joints%at
               call laws(k)%cut_at(at)
            end do
         end if
         call make_chained(set, cams, part, cam, laws, shape, findings)
         if (findings%failed()) return
      else
         call prepare_cam_motion(cam, laws(1), prepared%mechanism, prepared%given, prepared%parameters, shape%motion)
         if (cam%of_output) then
            if (cam%axis > shape%motion%output%problem%output%kind%components) then
               call complain(set, 1, 'KAXIS', 'the output has '//to_text(shape%motion%output%problem%output%kind%components)// &
                             ' component(s); there is none of number '//to_text(cam%axis), findings)
               return
            end if
            if (.not. shape%motion%has_branch()) then
               call set%origins%error(findings, 'METHOD', 'CRNKI', 'at the reference position the linkage does not close, or '// &
                                      'its output stands still: the law of the output cannot be solved for the input', 1)
               return
            end if
            if (shape%motion%ways%state /= ways_found) then
               call refuse_ways(set, shape%motion%ways, findings)
               return
            end if
         end if
      end if
      call set_radii(cam, shape)
   end subroutine make_shape

   !> Why a law cannot rest at a dead point as it is to.
   subroutine refuse_ways(set, ways, findings)
      type(data_set_t), intent(in) :: set
      type(ways_t), intent(in) :: ways
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: place

      place = 'the law rests at a dead point of the linkage at '//number_words(ways%faulty_at)//' degrees, and '
      select case (ways%state)
      case (ways_jump)
         call complain(set, 1, 'LAW', place//'the velocity of the input would jump: the acceleration of the law must be the '// &
                       'same on both sides, or nothing on both (POLY4567)', findings)
      case (ways_infinite)
         call complain(set, 1, 'LAW', place//'the acceleration of the input would be infinite: the law must come and go '// &
                       'with an acceleration (HARMONIC, SEGACC), or without one and without jerk (POLY4567)', findings)
      case (ways_end)
         call complain(set, 1, 'SEGOUT', place//'beyond it the linkage does not move', findings)
      case default
         call complain(set, 1, 'KDEAD', 'after a turn of the cam the input is not where it was: the law passes a dead point '// &
                       'more often one way than back', findings)
      end select
   end subroutine refuse_ways

   !> True if the linkage is solved in the poses of its links.
   pure logical function is_chained(set, cams)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2

      is_chained = has_gears(set) .or. cams(1)%link > 0 .or. cams(2)%given
   end function is_chained

   !> True if gears tie the turns of a sketch's links or drives.
   pure logical function has_gears(set)
      type(data_set_t), intent(in) :: set

      has_gears = allocated(set%traced)
      if (has_gears) has_gears = size(set%traced%gears) > 0 .or. size(set%traced%seconds) > 0
   end function has_gears

   !> The motion of a sketch in the poses of its links.
   subroutine make_chained(set, cams, part, cam, laws, shape, findings)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      type(cam_role_t), intent(in) :: part
      type(cam_group_t), intent(in) :: cam
      type(law_t), intent(in) :: laws(:)
      type(cam_shape_t), intent(inout) :: shape
      type(diagnostics_t), intent(inout) :: findings
      type(closure_t) :: closure
      type(state_t) :: drawn
      type(cam_chain_t), allocatable :: chain
      type(cam_group_t) :: used(size(laws))
      logical :: valid
      integer :: k, own_drives

      call assemble_sketch(set, closure, drawn, valid, findings)
      if (.not. valid) return
      own_drives = count(.not. set%sketch%drives%geared)
      if (own_drives /= size(laws)) then
         call set%origins%error(findings, 'DRIVES', 'DRIVE', 'there are '//to_text(own_drives)//' drives of their own, but '// &
                                to_text(size(laws))//' cam(s): &CAM is for the first drive, &CAM2 for the second; geared '// &
                                'drives need none', 1)
         return
      end if
      do k = 1, size(laws)
         used(k) = cam_of_part(cams, cam_role_t(cam=k))
         if (used(k)%of_output .and. used(k)%axis > numbers_of(closure)) then
            call complain(set, k, 'KAXIS', 'the outputs have '//to_text(numbers_of(closure))//' number(s); there is none of '// &
                          'number '//to_text(used(k)%axis), findings)
            return
         end if
         if (used(k)%link == 0) then
            call complain(set, k, 'FOLJNT', 'missing; this sketch is solved in the poses of its links: name the joint that '// &
                          'carries the roller, or two joints of the link', findings)
            return
         end if
      end do
      if (any(used%slides)) then
         k = findloc(used%slides, .true., dim=1)
         call complain(set, k, 'KCAM', 'a cam that slides takes one drive on the frame, no gears, and the follower on an arc '// &
                       '(NFOLLK)', findings)
         return
      end if
      if (any(used%pair)) then
         k = findloc(used%pair, .true., dim=1)
         call complain(set, k, 'KPAIR', 'a second roller on the same profile takes one drive on the frame, no gears, and the '// &
                       'follower on an arc (NFOLLK)', findings)
         return
      end if
      if (cam%speed > 0.0_wp .and. cams(2)%given) then
         call complain(set, part%cam, 'CAMRPM', 'forces at the roller are computed for one cam, not for two; leave CAMRPM out', &
                       findings)
         return
      end if
      allocate (chain)
      call make_cam_chain(closure, drawn, used, laws, part%cam, cam%link, cam%joints, cam%roller, chain)
      call chained_motion(chain, shape%motion)
   end subroutine make_chained

   subroutine refuse_law(set, cam, law, findings)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: cam                  !! 1 or 2
      type(law_t), intent(in) :: law
      type(diagnostics_t), intent(inout) :: findings
      type(law_joint_t), allocatable :: joints(:)
      integer :: k

      if (law%state == law_jerk_jumps) then
         call findings%error('segment '//to_text(law%faulty)//': at its end the acceleration or the jerk jumps, and the law of '// &
                             'a flexible drive takes both into the cam: POLY4567, or a table, is smooth enough', &
                             line=set%origins%line(group_of(cam), 'LAW', max(1, law%faulty)), group=group_of(cam), item='CAMFRQ')
         return
      end if
      if (law%state == law_points_missing) then
         call complain(set, cam, 'NPIECE', 'the table has too few points, or too wide gaps between them, for pieces so short', &
                       findings)
         return
      end if
      if (law%state == law_beyond_tolerance) then
         call complain(set, cam, 'TABTOL', 'no fit by least squares stays so near the points; the best misses one by '// &
                       number_words(law%residual), findings)
         return
      end if
      if (law%state /= law_velocity_jumps) then
         call set%origins%error(findings, group_of(cam), 'LAW', 'segment '//to_text(law%faulty)//': no motion of this law '// &
                                'meets the ends that are given', max(1, law%faulty))
         return
      end if
      joints = law%joints()
      k = maxloc(abs(joints%jump(1)), dim=1)
      call set%origins%error(findings, group_of(cam), 'SEGVEL', 'the velocity jumps by '//number_words(joints(k)%jump(1))// &
                             ' per radian of cam at '//number_words(joints(k)%at)//' degrees; SEGVEL gives both sides one '// &
                             'velocity, and a ramp or dwell has its own', max(1, law%faulty))
   end subroutine refuse_law

   !> Say where the motion first fails, and of an output out of reach the furthest.
   subroutine refuse_motion(set, cams, cam, shape, samples, first, findings)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      integer, intent(in) :: cam                  !! 1 or 2
      type(cam_shape_t), intent(in) :: shape
      type(samples_t), intent(in) :: samples
      integer, intent(in) :: first
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: low, high, beyond(size(samples%angle))
      character(:), allocatable :: item
      integer :: k

      associate (motion => shape%motion, states => samples%states)
         if (any(states%fault(first) == [fault_on_axis, fault_standstill])) then
            call refuse_pitch(set, cams(cam), cam, samples, first, findings)
            return
         end if
         if (allocated(motion%chain)) then
            if (states%fault(first) == fault_dead_point) then
               call complain(set, cam, 'KOUT', 'the outputs with laws stand still at '//number_words(motion%chain%fault_at)// &
                             ' degrees while the inputs move: a dead point, or the end of their range; to drive through it '// &
                             'give the law of the input, KOUT=0', findings)
            else
               call complain(set, cam, 'SEGOUT', 'the linkage cannot follow at '//number_words(motion%chain%fault_at)// &
                             ' degrees: it does not close, or is at a dead point', findings)
            end if
            return
         end if
         select case (states%fault(first))
         case (fault_reach)
            low = minval(motion%f)
            high = maxval(motion%f)
            beyond = max(low - states%y(0, :), states%y(0, :) - high)
            k = maxloc(beyond, dim=1)
            item = merge('SEGOUT', 'TABOUT', size(cams(1)%table) == 0)
            call complain(set, cam, item, 'the output wanted at '//number_words(samples%angle(k))//' degrees, '// &
                          number_words(states%y(0, k))//', is out of range: the linkage gives '//number_words(low)//' to '// &
                          number_words(high)//' while its input goes from '//number_words(motion%q(1))//' to '// &
                          number_words(motion%q(size(motion%q))), findings)
         case (fault_dead_point)
            call complain(set, cam, 'KOUT', 'the output stands still at '// &
                          number_words(samples%angle(first))//' degrees while the input ('//number_words(states%q(0, first))// &
                          ') moves: a dead point; the law may rest at it where a segment ends; '// &
                          'to drive through it give the law of the input, KOUT=0', findings)
         case default
            call complain(set, cam, 'NFOLLK', 'the linkage that carries the follower does not close, or is at a dead point, at '// &
                          number_words(samples%angle(first))//' degrees (input '//number_words(states%q(0, first))//')', findings)
         end select
      end associate
   end subroutine refuse_motion

   !> A pitch curve beside which there is no profile, and what to change.
   subroutine refuse_pitch(set, given, cam, samples, first, findings)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: given
      integer, intent(in) :: cam                  !! 1 or 2
      type(samples_t), intent(in) :: samples
      integer, intent(in) :: first
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: angle, axis

      angle = ' at '//number_words(samples%angle(first))//' degrees'
      axis = 'XCAM='//number_words(given%x)//', YCAM='//number_words(given%y)
      if (samples%states%fault(first) == fault_on_axis) then
         call complain(set, cam, 'XCAM', 'the roller''s centre lies on the cam''s axis ('//axis//')'//angle//': there is no '// &
                       'base circle and no profile; move the axis or the roller until they are further apart than RROLL', findings)
      else if (given%slides) then
         call complain(set, cam, 'CAMLEN', 'the roller''s centre moves with the cam (CAMLEN='// &
                       number_words(given%travel)//')'//angle//': the pitch curve stands still and has no profile; '// &
                       'change CAMLEN, CAMDIR or the law', findings)
      else
         call complain(set, cam, 'XCAM', 'the roller''s centre moves with the cam'//angle//': the pitch curve stands still '// &
                       'and has no profile; move the cam''s axis ('//axis//') away from the roller, or change the law', findings)
      end if
   end subroutine refuse_pitch

   !> What a case has studied: its cams, and of each the conjugate cam or the outer wall of the track.
   pure function parts_of(cams) result(parts)
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      type(cam_role_t), allocatable :: parts(:)

      parts = [cam_role_t()]
      if (cams(1)%conjugate) parts = [parts, cam_role_t(role=role_conjugate)]
      if (cams(1)%track) parts = [parts, cam_role_t(role=role_outer_wall)]
      if (.not. cams(2)%given) return
      parts = [parts, cam_role_t(cam=2)]
      if (cams(2)%conjugate) parts = [parts, cam_role_t(2, role_conjugate)]
      if (cams(2)%track) parts = [parts, cam_role_t(2, role_outer_wall)]
   end function parts_of

   !> The group with the roller and the cutter of a part. The walls of a track are cut with their own width: the cutter runs on the
   !> pitch curve.
   pure type(cam_group_t) function cam_of_part(cams, part) result(cam)
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      type(cam_role_t), intent(in) :: part

      if (part%cam == 2) then
         cam = cams(2)
      else
         cam = cams(1)
      end if
      if (part%role == role_conjugate) then
         cam%roller = cam%second
         if (.not. cam%slides) cam%side = 0
         if (cam%pair) then
            cam%arc = cam%second_arc
            cam%loop = cam%second_loop
            cam%from_start = cam%second_from_start
         end if
      end if
      if (cam%track) then
         cam%roller%radius = cam%roller%radius + 0.5_wp*cam%clearance
         cam%cutter = cam%roller%radius
      else if (.not. cam%cutter_given) then
         cam%cutter = cam%roller%radius
      end if
   end function cam_of_part

   !> The other wall of a track.
   subroutine turn_side(cam, shape, samples)
      type(cam_group_t), intent(in) :: cam
      type(cam_shape_t), intent(inout) :: shape
      type(samples_t), intent(inout) :: samples
      type(cam_group_t) :: other

      other = cam
      other%side = -nint(shape%side)
      call sample_turn(shape, other, samples)
   end subroutine turn_side

   subroutine set_radii(cam, shape)
      type(cam_group_t), intent(in) :: cam
      type(cam_shape_t), intent(inout) :: shape

      shape%roller = cam%roller%radius
      shape%cutter = cam%cutter
      shape%face = cam%face_angle - cam%roller%angle
   end subroutine set_radii

   !> Centres that keep the pressure angle while the follower moves, on both sides of the roller's way.
   subroutine find_centres(cam, study, samples)
      type(cam_group_t), intent(in) :: cam
      type(cam_study_t), intent(inout) :: study
      type(samples_t), intent(in) :: samples
      logical :: moving(size(samples%angle))
      real(wp), allocatable :: angle(:)
      integer, allocatable :: piece(:)
      type(cam_trace_t) :: more
      real(wp) :: side
      integer :: k, round

      associate (way => study%segments(study%shape%motion%law%pieces(samples%piece)%segment)%way)
         moving = way == way_rise .or. (way == way_return .and. .not. cam%rise_only)
      end associate
      do k = 1, 2
         side = real(3 - 2*k, wp)
         associate (sense => study%shape%axes%sense, limit => cam%pressure_angle, centres => study%centres(k))
            call admissible_centres(samples%states, moving, sense, side, limit, centres)
            do round = 1, sharpenings
               call tightest_angles(samples%states, samples%piece, moving, sense, side, limit, centres, angle, piece)
               if (size(angle) == 0) exit
               call study%shape%motion%trace(angle, piece, more)
               call sharpen_centres(samples%states, more, sense, side, limit, centres)
               if (size(centres%corners) == 0) exit
            end do
         end associate
      end do
   end subroutine find_centres

   !> Study a part of a case that `check_cam` found no fault with.
   subroutine find_cam(set, cams, prepared, part, study)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      type(prepared_t), intent(in) :: prepared
      type(cam_role_t), intent(in) :: part               !! one of `parts_of`
      type(cam_study_t), intent(inout) :: study      !! as it is by default; `out` would put two of them on the stack
      type(diagnostics_t) :: unused
      type(samples_t) :: samples
      logical, allocatable :: possible(:), all_segments(:)
      integer :: k

      study%part = part
      study%cam = cam_of_part(cams, part)
      call make_shape(set, cams, prepared, part, study%shape, unused)
      associate (cam => study%cam, law => study%shape%motion%law)
         allocate (study%joints(size(law%pieces)))
         study%joints = law%joints()
         call sample_turn(study%shape, cam, samples)
         if (part%role == role_outer_wall) call turn_side(cam, study%shape, samples)
         study%angle = table_angles(study%shape, cam%points)
         call measure(study%shape, study%angle, law%piece_at(study%angle), study%states, study%points, possible)
         allocate (all_segments(size(law%segments)), source=.true.)
         do k = 1, measures
            call find_extreme(study%shape, samples, k, all_segments, study%extremes(k))
         end do
         call find_segments(study, samples)
         call assess_curvature(study)
         if (.not. study%shape%flat) then
            if (part%role /= role_outer_wall) then
               call find_interference(study%shape, samples, .false., study%roller)
               call find_interference(study%shape, samples, .true., study%cutter)
            end if
            if (cam%slides) then
               allocate (study%centres(1)%corners(0), study%centres(2)%corners(0))
            else
               call find_centres(cam, study, samples)
            end if
         end if
         call find_paths(study%shape, samples, cam%tolerance, study%paths)
         call assess_limits(study)
         if (part%role == role_conjugate .and. any(abs(cam%errors) > 0.0_wp)) call find_play(set, cams, prepared, study)
         if (part%role == role_cam .and. cam%pair) call find_second(set, cams, prepared, samples, study)
         if (cam%speed > 0.0_wp .and. part%role == role_cam) call find_forces(set, prepared, samples, study)
      end associate
   end subroutine find_cam

   !> The play that errors of the profiles leave between a cam and its conjugate, which is studied.
   subroutine find_play(set, cams, prepared, study)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      type(prepared_t), intent(in) :: prepared
      type(cam_study_t), intent(inout) :: study
      class(cam_shape_t), allocatable :: first     ! large: it would fill a small stack
      type(samples_t) :: samples
      type(cam_trace_t) :: states
      type(cam_points_t) :: points
      type(diagnostics_t) :: unused
      logical, allocatable :: possible(:)
      type(cam_role_t) :: part

      allocate (first)
      part = cam_role_t(cam=study%part%cam)
      call make_shape(set, cams, prepared, part, first, unused)
      call sample_turn(first, cam_of_part(cams, part), samples)
      call measure(first, study%angle, first%motion%law%piece_at(study%angle), states, points, possible)
      study%play = play_of(study%cam%errors(1), study%cam%errors(2), points%pressure, study%points%pressure, &
                           abs(states%by_input), abs(study%states%by_input))
      study%least_slack = least_in(study%play, study%angle)
      study%most_slack = greatest_in(study%play, study%angle)
   end subroutine find_play

   !> The second roller on the same profile.
   subroutine find_second(set, cams, prepared, samples, study)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cams(:)       !! CAM and CAM2
      type(prepared_t), intent(in) :: prepared
      type(samples_t), intent(in) :: samples
      type(cam_study_t), intent(inout) :: study
      type(diagnostics_t) :: unused

      allocate (study%other, study%second)
      call make_shape(set, cams, prepared, cam_role_t(study%part%cam, role_conjugate), study%other, unused)
      call study%other%motion%trace(study%angle, study%other%motion%law%piece_at(study%angle), study%second_states)
      call find_gap(study%shape, samples, study%states, study%points, study%second_states, study%other%roller, study%second)
      study%least_slack = least_in(study%second%gap, study%angle)
      study%most_slack = greatest_in(study%second%gap, study%angle)
      associate (fits => fit*maxval(abs(study%points%profile)))
         study%tight = study%least_slack%value < -fits
         study%loose = study%most_slack%value > study%cam%clearance + fits
      end associate
   end subroutine find_second

   !> Forces at the samples of a cam.
   subroutine find_sampled_contact(set, prepared, cam, shape, samples, contact)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(cam_group_t), intent(in) :: cam
      type(cam_shape_t), intent(in) :: shape
      type(samples_t), intent(in) :: samples
      type(cam_contact_t), intent(out) :: contact
      type(force_model_t) :: model
      type(diagnostics_t) :: unused
      class(problem_t), allocatable :: problem        ! large: it would fill a small stack

      call make_force_model(set, prepared%mechanism, prepared%given, model, unused)
      allocate (problem)
      call new_problem(prepared%mechanism, prepared%given, prepared%parameters, [0.0_wp], .true., problem)
      call find_contact(cam, model, problem, increments(problem, samples%states), samples%states, samples%points, &
                        merge(0.0_wp, shape%roller, shape%flat), shape%axes, contact)
   end subroutine find_sampled_contact

   !> Inputs of a trace as increments from the reference position.
   pure function increments(problem, states) result(delt)
      type(problem_t), intent(in) :: problem
      type(cam_trace_t), intent(in) :: states
      real(wp) :: delt(size(states%angle))

      delt = states%q(0, :) - reference_input(problem%mechanism, problem%given)
   end function increments

   !> Forces at the table's angles, and at the samples for what is extreme.
   subroutine find_forces(set, prepared, samples, study)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(samples_t), intent(in) :: samples
      type(cam_study_t), intent(inout) :: study
      type(force_model_t) :: model
      type(diagnostics_t) :: unused
      class(problem_t), allocatable :: problem        ! large: it would fill a small stack
      real(wp) :: roller

      call make_force_model(set, prepared%mechanism, prepared%given, model, unused)
      allocate (problem, study%contact, study%fine)
      call new_problem(prepared%mechanism, prepared%given, prepared%parameters, [0.0_wp], .true., problem)
      roller = merge(0.0_wp, study%shape%roller, study%shape%flat)
      call find_contact(study%cam, model, problem, increments(problem, samples%states), samples%states, &
                        samples%points, roller, study%shape%axes, study%fine)
      call find_contact(study%cam, model, problem, increments(problem, study%states), study%states, &
                        study%points, roller, study%shape%axes, study%contact)
      study%lost = any(study%fine%force < 0.0_wp) .and. .not. (study%cam%conjugate .or. study%cam%track)
      study%jammed = study%fine%jams
      if (study%cam%conjugate .or. study%cam%track) call find_flanks(study, samples)
      study%stressed = study%cam%stress > 0.0_wp .and. maxval(study%fine%stress) > study%cam%stress
   end subroutine find_forces

   !> Where the force changes its sign, the roller goes from one flank to the other, with the jerk there.
   subroutine find_flanks(study, samples)
      type(cam_study_t), intent(inout) :: study
      type(samples_t), intent(in) :: samples
      real(wp) :: share
      integer :: i

      allocate (study%flanks(2, 0))
      associate (force => study%fine%force, q => samples%states%q(3, :))
         do i = 2, size(force)
            if (force(i - 1)*force(i) >= 0.0_wp) cycle
            share = force(i - 1)/(force(i - 1) - force(i))
            study%flanks = reshape([study%flanks, samples%angle(i - 1) + share*(samples%angle(i) - samples%angle(i - 1)), &
                                    q(i - 1) + share*(q(i) - q(i - 1))], [2, size(study%flanks, 2) + 1])
         end do
      end associate
   end subroutine find_flanks

   subroutine find_segments(study, samples)
      type(cam_study_t), intent(inout) :: study
      type(samples_t), intent(in) :: samples
      logical :: wanted(size(study%shape%motion%law%segments))
      integer :: k, first, last
      real(wp) :: there, here

      allocate (study%segments(size(wanted)))
      associate (segment => study%shape%motion%law%pieces(samples%piece)%segment, o => study%shape%axes%centre)
         do k = 1, size(wanted)
            wanted = .false.
            wanted(k) = .true.
            call find_extreme(study%shape, samples, measure_pressure, wanted, study%segments(k)%pressure)
            first = findloc(segment == k, .true., dim=1)
            last = findloc(segment == k, .true., dim=1, back=.true.)
            here = abs(samples%states%c(0, first) - o)
            there = abs(samples%states%c(0, last) - o)
            if (study%shape%axes%slides) then
               here = real(conjg(upward(study%shape))*samples%states%c(0, first), wp)
               there = real(conjg(upward(study%shape))*samples%states%c(0, last), wp)
            end if
            if (maxval(abs(samples%states%y(1, first:last))) > 0.0_wp) &
               study%segments(k)%way = merge(way_rise, way_return, there > here)
         end do
      end associate
   end subroutine find_segments

   !> Curvatures become radii; what they forbid.
   subroutine assess_curvature(study)
      type(cam_study_t), intent(inout) :: study
      real(wp) :: hollow_radius

      associate (e => study%extremes, r => merge(0.0_wp, study%shape%roller, study%shape%flat))
         e(measure_base)%value = -e(measure_base)%value
         e(measure_excursion_low)%value = -e(measure_excursion_low)%value
         e(measure_face_low)%value = -e(measure_face_low)%value
         if (study%shape%flat) then
            call assess_face(study)
            return
         end if
         e(measure_convex)%found = e(measure_convex)%value > 0.0_wp
         if (e(measure_convex)%found) then
            e(measure_convex)%value = 1.0_wp/e(measure_convex)%value - r
            study%undercut = e(measure_convex)%value <= 0.0_wp .and. r > 0.0_wp
         end if
         e(measure_concave)%found = e(measure_concave)%value > 0.0_wp
         study%hollow = e(measure_concave)%found
         if (study%hollow) then
            e(measure_concave)%value = -1.0_wp/e(measure_concave)%value - r
            hollow_radius = -e(measure_concave)%value
            study%gouge = study%shape%cutter > hollow_radius*(1.0_wp + rounding)
         end if
      end associate
   end subroutine assess_curvature

   !> A flat face needs rho > 0 throughout. `points%radius` is linear in the base radius: what is missing is read off.
   subroutine assess_face(study)
      type(cam_study_t), intent(inout) :: study

      associate (convex => study%extremes(measure_convex), concave => study%extremes(measure_concave))
         ! 1/rho is largest where rho is least, as long as rho has one sign
         study%undercut = concave%value > 0.0_wp
         convex%value = 1.0_wp/convex%value
         convex%found = .true.
         concave%found = study%undercut
         if (study%undercut) concave%value = -1.0_wp/concave%value
         study%hollow = study%undercut
      end associate
   end subroutine assess_face

   subroutine assess_limits(study)
      type(cam_study_t), intent(inout) :: study

      associate (e => study%extremes, cam => study%cam)
         study%steep = any(study%segments%pressure%value > cam%pressure_angle .and. &
                           (study%segments%way == way_rise .or. .not. cam%rise_only))
         study%sharp = cam%least_radius > 0.0_wp .and. e(measure_convex)%found .and. &
                       e(measure_convex)%value < cam%least_radius
         if (cam%kind /= follower_flat) return
         study%least_base = e(measure_base)%value - e(measure_convex)%value
         study%face_short = cam%half_face > 0.0_wp .and. &
                            e(measure_face_high)%value - e(measure_face_low)%value > 2.0_wp*cam%half_face
      end associate
   end subroutine assess_limits
end module psalm_cam_study
