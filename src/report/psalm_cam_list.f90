!> A cam in the listing and on device 9.
module psalm_cam_list
   use psalm_cam_data, only: fit_least_squares
   use psalm_cam_kind, only: law_names
   use psalm_cam_shape, only: cam_extreme_t, measure_pressure, measure_convex, measure_concave, measure_base, measure_outer, &
                              measure_excursion_low, measure_excursion_high, measure_face_low, measure_face_high, &
                              measure_output, measure_input
   use psalm_cam_paths, only: path_cutter
   use psalm_column_names, only: input_unit, output_unit, rate_unit
   use psalm_cam_study, only: cam_study_t, way_rise, way_return, role_cam, role_conjugate
   use psalm_angles, only: degrees_of, within_turn
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   use psalm_number_format, only: number_format_t, figure, figures_of, format_of, in_a_row, in_sentence
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t, lower_case, to_text
   implicit none (type, external)
   private
   public :: list_cam, put_cam

   character(5), parameter :: side_names(2) = ['left ', 'right']
   real(wp), parameter :: rounding = 1.0e-9_wp !! relative jump of acceleration that is none
   integer, parameter :: name_length = 32        !! characters of the name of an extreme
   integer, parameter :: most_extremes = 40    !! besides those of segments, dead points and flanks

contains

   !> Listing: law, joints, extremes, what is wrong.
   subroutine list_cam(named, study, text)
      logical, intent(in) :: named            !! joints have names: a sketch
      type(cam_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(number_format_t) :: of_value, of_angle
      type(cam_extreme_t), allocatable :: every(:)
      character(:), allocatable :: arcs, chords
      integer :: k

      every = [study%extremes, study%segments%pressure, study%least_slack, study%most_slack]
      of_value = format_of(named, every%value, every%found)
      of_angle = format_of(named, every%angle, every%found)
      associate (law => study%shape%motion%law, e => study%extremes)
         call text%add()
         if (study%part%cam == 2) call text%add(' THE SECOND CAM')
         if (study%part%role /= role_cam) then
            call text%add(' '//trim(merge('THE CONJUGATE CAM          ', 'THE OUTER WALL OF THE TRACK', &
                                          study%part%role == role_conjugate)))
         else
            call list_law()
         end if
         call text%add()
         call text%add(' CAM'//repeat(' ', 42)//'VALUE   AT CAM ANGLE')
         call show(trim(merge('LEAST HEIGHT', 'BASE RADIUS ', study%shape%axes%slides)), e(measure_base))
         call show(trim(merge('GREATEST HEIGHT', 'OUTER RADIUS   ', study%shape%axes%slides)), e(measure_outer))
         call show('LEAST CONVEX RADIUS OF CURVATURE', e(measure_convex))
         call show('LEAST HOLLOW RADIUS OF CURVATURE', e(measure_concave))
         call show('LARGEST PRESSURE ANGLE', e(measure_pressure))
         do k = 1, size(study%segments)
            call show('  SEGMENT '//to_text(k)//', '//way_name(study%segments(k)%way), study%segments(k)%pressure)
         end do
         if (study%shape%flat) then
            call show('CONTACT ON THE FACE, LEAST', e(measure_excursion_low))
            call show('CONTACT ON THE FACE, MOST', e(measure_excursion_high))
            call show('FROM THE FACE''S POINT, LEAST', e(measure_face_low))
            call show('FROM THE FACE''S POINT, MOST', e(measure_face_high))
            call text%add(' BASE RADIUS AT WHICH THE PROFILE IS JUST CONVEX'//in_sentence(named, study%least_base))
         end if
         call show('OUTPUT, LARGEST FIRST DERIVATIVE', e(measure_output))
         call show('OUTPUT, LARGEST SECOND DERIVATIVE', e(measure_output + 1))
         call show('INPUT, LARGEST FIRST DERIVATIVE', e(measure_input))
         call show('INPUT, LARGEST SECOND DERIVATIVE', e(measure_input + 1))
         call list_slack()
         call list_centres(named, study, text)
         associate (path => study%paths(path_cutter))
            if (path%found) then
               if (named) then
                  arcs = ' '//to_text(size(path%arcs))
                  chords = ' '//to_text(nint(path%chords))
               else
                  arcs = in_sentence(named, real(size(path%arcs), wp))
                  chords = in_sentence(named, path%chords)
               end if
               call text%add(' CUTTER PATH:'//arcs//' ARCS, LARGEST DEVIATION'//in_sentence(named, path%deviation)// &
                             '; A POLYLINE WOULD NEED'//chords//' CHORDS')
            else
               call text%add(' CUTTER PATH: IT CANNOT BE CUT WITHIN TOLCUT')
            end if
         end associate
         if (allocated(study%contact)) call list_forces(named, study, text)
         call list_faults(named, study, text)
      end associate

   contains

      subroutine list_law()
         real(wp) :: greatest
         character(15) :: columns(size(study%shape%motion%law%segments), 7)
         integer :: j, k

         associate (law => study%shape%motion%law, cam => study%cam)
            associate (of => law%segments)
               columns(:, 1) = figures_of(named, of%start)
               columns(:, 2) = figures_of(named, of%finish)
               columns(:, 3) = figures_of(named, of%from)
               columns(:, 4) = figures_of(named, of%to)
               do j = 1, 3
                  columns(:, 4 + j) = figures_of(named, of%peak(j))
               end do
               where (of%steps) columns(:, 7) = '       INFINITE'
            end associate
            call text%add(' LAW OF THE '//trim(merge('OUTPUT', 'INPUT ', cam%of_output))// &
                          ', DERIVATIVES BY RADIANS OF CAM; PEAKS NORMALISED BY LIFT AND WIDTH')
            call text%add(' LAW                  FROM             TO         OUTPUT             TO             CV'// &
                          '             CA             CJ')
            do k = 1, size(law%segments)
               call text%add(' '//law_name(study, k)//in_a_row(columns(k, :)))
            end do
            if (size(cam%table) > 0 .and. (cam%table_tolerance > 0.0_wp .or. cam%fit == fit_least_squares)) &
               call text%add(' '//to_text(size(law%pieces))//' PIECES; FROM THE TABLE''S POINTS AT MOST'// &
                             in_sentence(named, law%residual)//', ROOT OF MEAN SQUARE'//in_sentence(named, law%mean_residual))
            greatest = law%greatest(2)
            do k = 1, size(study%joints)
               if (study%shape%axes%slides .and. k == 1) cycle
               if (abs(study%joints(k)%jump(2)) <= rounding*greatest) cycle
               call text%add(' STEP OF ACCELERATION AT'//in_sentence(named, study%joints(k)%at)//' DEGREES:'// &
                             in_sentence(named, study%joints(k)%jump(2)))
            end do
            if (size(study%shape%motion%q) > 0) then
               call text%add(' THE LINKAGE GIVES OUTPUTS'//in_sentence(named, minval(study%shape%motion%f))//' TO'// &
                             in_sentence(named, maxval(study%shape%motion%f))//' FOR INPUTS'// &
                             in_sentence(named, study%shape%motion%q(1))//' TO'// &
                             in_sentence(named, study%shape%motion%q(size(study%shape%motion%q))))
               do k = 1, size(study%shape%motion%ways%crossings)
                  associate (one => study%shape%motion%ways%crossings(k))
                     call text%add(' AT THE DEAD POINT OF INPUT'//in_sentence(named, one%q)//', OUTPUT'// &
                                   in_sentence(named, one%f)//', THE INPUT '// &
                                   trim(merge('PASSES    ', 'TURNS BACK', one%passed))//' AT'// &
                                   in_sentence(named, one%angle)//' DEGREES')
                  end associate
               end do
            end if
         end associate
      end subroutine list_law

      !> Play of conjugate cams, or gap under a second roller.
      subroutine list_slack()
         if (allocated(study%play)) then
            call show('PLAY AT THE FIRST ROLLER, LEAST', study%least_slack)
            call show('PLAY AT THE FIRST ROLLER, MOST', study%most_slack)
            if (study%least_slack%value < 0.0_wp) call text%add(' BELOW 0: BOTH ROLLERS PRESS')
         else if (allocated(study%second)) then
            call show('GAP UNDER THE SECOND ROLLER, LEAST', study%least_slack)
            call show('GAP UNDER THE SECOND ROLLER, MOST', study%most_slack)
         end if
      end subroutine list_slack

      subroutine show(words, extreme)
         character(*), intent(in) :: words
         type(cam_extreme_t), intent(in) :: extreme
         character(37) :: padded

         if (.not. extreme%found) return
         padded = words
         call text%add(' '//padded//figure(extreme%value, of_value)//figure(extreme%angle, of_angle))
      end subroutine show
   end subroutine list_cam

   !> What the law of a segment is called.
   pure function law_name(study, k) result(name)
      type(cam_study_t), intent(in) :: study
      integer, intent(in) :: k                !! segment
      character(10) :: name

      name = 'TABLE'
      if (size(study%cam%law) > 0) name = law_names(study%cam%law(k))
   end function law_name

   !> Where the centre may lie, and of the smallest cam.
   subroutine list_centres(named, study, text)
      logical, intent(in) :: named            !! joints have names: a sketch
      type(cam_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: k

      if (study%shape%flat) return
      do k = 1, size(study%centres)
         associate (c => study%centres(k))
            if (size(c%corners) == 0) cycle
            call text%add(' CENTRE OF THE SMALLEST CAM THAT KEEPS ALFMAX, CAM TO THE '//trim(merge('LEFT ', 'RIGHT', k == 1))// &
                          ' OF THE TRAVEL:'//in_sentence(named, real(c%smallest, wp))// &
                          in_sentence(named, aimag(c%smallest))//', PITCH BASE RADIUS'// &
                          in_sentence(named, c%base))
         end associate
      end do
   end subroutine list_centres

   !> Force and stress of the contact.
   subroutine list_forces(named, study, text)
      logical, intent(in) :: named            !! joints have names: a sketch
      type(cam_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: k

      associate (fine => study%fine)
         if (.not. fine%known) then
            call text%add(' FORCES ARE NOT KNOWN: THE LINKAGE DOES NOT CLOSE, OR PASSES A DEAD POINT')
            return
         end if
         call text%add(' FORCE OF THE CAM, LEAST AND GREATEST, N'//in_sentence(named, minval(fine%force))// &
                       in_sentence(named, maxval(fine%force)))
         if (allocated(study%flanks)) then
            do k = 1, size(study%flanks, 2)
               call text%add(' THE ROLLER CHANGES FLANKS AT'//in_sentence(named, study%flanks(1, k))// &
                             ' DEGREES; THIRD DERIVATIVE OF THE INPUT'//in_sentence(named, study%flanks(2, k)))
            end do
         end if
         if (maxval(fine%stress) > 0.0_wp) call text%add(' GREATEST CONTACT STRESS, PA'//in_sentence(named, maxval(fine%stress)))
         if (fine%lost_speed > 0.0_wp) then
            call text%add(' CONTACT IS LOST FROM'//in_sentence(named, fine%lost_speed)//' REV/MIN ON, FIRST AT'// &
                          in_sentence(named, fine%lost_at)//' DEGREES')
         else if (minval(fine%force) < 0.0_wp) then
            call text%add(' CONTACT IS LOST AT REST: A SPRING OR A WEIGHT IS TO HOLD THE FOLLOWER ON THE CAM')
         end if
      end associate
   end subroutine list_forces

   pure function way_name(way) result(name)
      integer, intent(in) :: way
      character(:), allocatable :: name

      name = 'DWELL'
      if (way == way_rise) name = 'RISE'
      if (way == way_return) name = 'RETURN'
   end function way_name

   !> What the cam cannot do.
   subroutine list_faults(named, study, text)
      logical, intent(in) :: named            !! joints have names: a sketch
      type(cam_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text

      if (study%undercut) then
         if (study%shape%flat) then
            call text%add(' THE PROFILE WOULD BE HOLLOW, AND A FLAT FACE CANNOT FOLLOW A HOLLOW')
         else
            call text%add(' UNDERCUT: THE PITCH CURVE IS SHARPER THAN THE ROLLER')
         end if
      end if
      if (study%roller%depth > 0.0_wp) call text%add(' THE PROFILE CROSSES ITSELF: THE ROLLER AT'// &
         in_sentence(named, study%roller%by)//' TAKES AWAY WHAT IT TOUCHES AT'//in_sentence(named, study%roller%at)// &
         ', TO A DEPTH OF'//in_sentence(named, study%roller%depth))
      if (study%gouge) call text%add(' GOUGE: THE CUTTER IS LARGER THAN A HOLLOW OF THE PROFILE')
      if (study%cutter%depth > 0.0_wp) call text%add(' GOUGE: THE CUTTER AT'// &
         in_sentence(named, study%cutter%by)//' TAKES AWAY WHAT IT CUTS AT'//in_sentence(named, study%cutter%at)// &
         ', TO A DEPTH OF'//in_sentence(named, study%cutter%depth))
      if (study%lost) call text%add(' THE FOLLOWER LEAVES THE CAM AT THIS SPEED')
      if (study%jammed) call text%add(' FRICTION KEEPS THE CAM FROM MOVING THE FOLLOWER')
      if (study%stressed) call text%add(' THE CONTACT STRESS EXCEEDS PHERTZ')
      if (study%steep) call text%add(' THE PRESSURE ANGLE EXCEEDS ALFMAX')
      if (study%sharp) call text%add(' THE RADIUS OF CURVATURE IS LESS THAN RHOMIN')
      if (study%tight) call text%add(' THE SECOND ROLLER DOES NOT FIT')
      if (study%loose) call text%add(' THE SECOND ROLLER HAS MORE PLAY THAN CLEAR')
      if (study%face_short) call text%add(' THE FACE IS SHORTER THAN THE WAY OF THE CONTACT')
   end subroutine list_faults

   !> The table of the cam, its law and assessment, the extremes, play or gap, contact; `suffix` of the names of blocks, empty for
   !> the first cam.
   subroutine put_cam(study, suffix, tables)
      type(cam_study_t), intent(in) :: study
      character(*), intent(in) :: suffix
      type(tables_t), intent(inout) :: tables
      character(*), parameter :: conventions = 'angles in degrees; derivatives by radians of cam, of angles in radians'
      type(table_t) :: table
      character(:), allocatable :: around, out, in, unit
      integer :: k

      associate (motion => study%shape%motion)
         around = 'deg'
         unit = ''     ! of a sketch solved in poses it is that of a drive
         out = output_unit(motion%angular)
         in = input_unit(.not. motion%what%turning_input)
         if (allocated(motion%chain)) in = ''
         table = table_of('cam'//suffix, 'a row for each cam angle; '//conventions, '   ('//conventions//')', &
                          named=len(suffix) > 0, main=len(suffix) == 0)
         call table%add('cam_angle', study%angle, around)
         do k = 0, 3
            call table%add(by_cam('output', k), study%states%y(k, :), rate_of(out, k))
         end do
         do k = 0, 3
            if (len(in) > 0) unit = rate_of(in, k)
            call table%add(by_cam('input', k), study%states%q(k, :), unit)
         end do
      end associate
      if (study%shape%flat) then
         call add_point('contact', study%shape%axes%centre + study%points%profile*study%points%machine)
         call table%add('excursion', study%points%excursion, 'length')
      else
         call add_point('roller', study%states%c(0, :))
      end if
      call add_point('profile', study%points%profile)
      associate (m => study%points%cutter)
         call add_point('cutter', m)
         call table%add('cutter_r', hypotenuse(real(m, wp), aimag(m)), 'length')
         call table%add('cutter_angle', within_turn(degrees_of(real(m, wp), aimag(m))), around)
      end associate
      call table%add('rho', study%points%radius, 'length')
      call table%add('alpha', study%points%pressure, 'deg')
      call tables%put(table)
      if (study%part%role == role_cam) call put_law(study, suffix, tables)
      call put_assessment(study, suffix, tables)
      call put_extremes(study, suffix, tables)
      if (allocated(study%play)) then
         table = table_of('play'//suffix, 'a row for each cam angle: play at the first roller')
         call table%add('cam_angle', study%angle, around)
         call table%add('play', study%play, 'length')
         call tables%put(table)
      end if
      if (allocated(study%second)) then
         table = table_of('second_roller'//suffix, 'a row for each cam angle: the gap under the second roller')
         call table%add('cam_angle', study%angle, around)
         call table%add('gap', study%second%gap, 'length')
         call table%add('lag', study%second%lag, 'deg')
         call add_point('roller', study%second_states%c(0, :))
         call tables%put(table)
      end if
      if (.not. forces_known(study)) return
      table = table_of('contact'//suffix, 'a row for each cam angle: force and stress of the contact', '   (N, Pa)')
      call table%add('cam_angle', study%angle, around)
      call table%add('force', study%contact%force, 'N')
      call table%add('stress', study%contact%stress, 'Pa')
      call tables%put(table)

   contains

      !> A derivative by the cam's angle.
      function by_cam(name, order) result(column)
         character(*), intent(in) :: name
         integer, intent(in) :: order
         character(:), allocatable :: column

         column = name
         if (order > 0) column = name//to_text(order)
      end function by_cam

      function rate_of(unit, order) result(rate)
         character(*), intent(in) :: unit
         integer, intent(in) :: order
         character(:), allocatable :: rate

         rate = rate_unit(unit == 'deg', 'rad', order)
      end function rate_of

      subroutine add_point(name, places)
         character(*), intent(in) :: name
         complex(wp), intent(in) :: places(:)

         call table%add(name//'_x', real(places, wp), 'length')
         call table%add(name//'_y', aimag(places), 'length')
      end subroutine add_point
   end subroutine put_cam

   !> Tables segments, law and law_joints, for other programs.
   subroutine put_law(study, suffix, tables)
      type(cam_study_t), intent(in) :: study
      character(*), intent(in) :: suffix
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: names(:)
      character(:), allocatable :: in, out, unit
      integer :: k

      associate (law => study%shape%motion%law, motion => study%shape%motion, fits => size(study%cam%table) > 0)
         out = output_unit(motion%angular)
         in = input_unit(.not. motion%what%turning_input)
         if (allocated(motion%chain)) in = ''      ! of a sketch solved in poses it is that of a drive
         unit = in
         if (study%cam%of_output) unit = out
         table = table_of('segments'//suffix, 'a row for each segment of the law; peaks normalised by lift and width', &
                          audience=for_programs)
         associate (of => law%segments)
            allocate (names(size(of)))
            do k = 1, size(of)
               names(k) = lower_case(law_name(study, k))
            end do
            call table%add('law', names)
            call table%add('from', of%start, 'deg')
            call table%add('to', of%finish, 'deg')
            call table%add('value_from', of%from, unit)
            call table%add('value_to', of%to, unit)
            call table%add('cv', of%peak(1))
            call table%add('ca', of%peak(2))
            call table%add('cj', of%peak(3), known=.not. of%steps)
         end associate
         call tables%put(table)
         table = table_of('law'//suffix, 'one row: the law as a whole, and what the linkage makes of it', audience=for_programs)
         call table%add('of', [merge('output', 'input ', study%cam%of_output)])
         call table%add('pieces', [size(law%pieces)])
         call table%add('residual', [law%residual], unit, [fits])
         call table%add('mean_residual', [law%mean_residual], unit, [fits])
         if (size(motion%q) > 0) then
            call table%add('output_least', [minval(motion%f)], out)
            call table%add('output_most', [maxval(motion%f)], out)
            call table%add('input_from', motion%q(:1), in)
            call table%add('input_to', motion%q(size(motion%q):), in)
         end if
         call tables%put(table)
         table = table_of('law_joints'//suffix, 'a row for each joint of two pieces of the law: its jumps, by radians of cam', &
                          audience=for_programs)
         call table%add('at', study%joints%at, 'deg')
         do k = 0, 3
            call table%add('jump'//to_text(k), study%joints%jump(k))
         end do
         call tables%put(table)
      end associate
   end subroutine put_law

   !> Table assessment, for other programs: one row, a flag for each thing that the cam cannot do or that is not kept.
   subroutine put_assessment(study, suffix, tables)
      type(cam_study_t), intent(in) :: study
      character(*), intent(in) :: suffix
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of('assessment'//suffix, 'one row: 1 where the cam cannot do something, or a limit is not kept', &
                       audience=for_programs)
      call table%add('fails', [study%is_violating()])
      call table%add('undercut', [study%undercut])
      call table%add('profile_crosses_itself', [study%roller%depth > 0.0_wp])
      call table%add('crossed_by_roller_at', [study%roller%by], 'deg', [study%roller%depth > 0.0_wp])
      call table%add('gouge', [study%gouge .or. study%cutter%depth > 0.0_wp])
      call table%add('gouged_by_cutter_at', [study%cutter%by], 'deg', [study%cutter%depth > 0.0_wp])
      call table%add('cutter_path_fails', [.not. study%paths(path_cutter)%found])
      call table%add('contact_lost', [study%lost])
      call table%add('jammed', [study%jammed])
      call table%add('stress', [study%stressed])
      call table%add('pressure_angle', [study%steep])
      call table%add('radius_of_curvature', [study%sharp])
      call table%add('second_roller_tight', [study%tight])
      call table%add('second_roller_loose', [study%loose])
      call table%add('face_short', [study%face_short])
      call tables%put(table)
   end subroutine put_assessment

   !> True if the forces of the contact are known.
   pure logical function forces_known(study)
      type(cam_study_t), intent(in) :: study

      forces_known = allocated(study%contact)
      if (forces_known) forces_known = study%contact%known
   end function forces_known

   !> The table `extremes`.
   subroutine put_extremes(study, suffix, tables)
      type(cam_study_t), intent(in) :: study
      character(*), intent(in) :: suffix
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: what(:)
      real(wp), allocatable :: value(:), angle(:)
      integer :: k, rows

      rows = most_extremes + size(study%segments)
      if (allocated(study%shape%motion%ways%crossings)) rows = rows + size(study%shape%motion%ways%crossings)
      if (allocated(study%flanks)) rows = rows + size(study%flanks, 2)
      allocate (what(rows), value(rows), angle(rows))
      rows = 0
      associate (e => study%extremes)
         call put(trim(merge('least_height', 'base_radius ', study%shape%axes%slides)), e(measure_base))
         call put(trim(merge('greatest_height', 'outer_radius   ', study%shape%axes%slides)), e(measure_outer))
         if (allocated(study%play)) then
            call put('play_least', study%least_slack)
            call put('play_most', study%most_slack)
         else if (allocated(study%second)) then
            call put('gap_least', study%least_slack)
            call put('gap_most', study%most_slack)
         end if
         call put('rho_convex', e(measure_convex))
         call put('rho_concave', e(measure_concave))
         call put('alpha', e(measure_pressure))
         do k = 1, size(study%segments)
            call put('alpha_segment_'//to_text(k), study%segments(k)%pressure)
         end do
         if (study%shape%flat) then
            call put('excursion_least', e(measure_excursion_low))
            call put('excursion_most', e(measure_excursion_high))
            call put('face_least', e(measure_face_low))
            call put('face_most', e(measure_face_high))
            call put('least_base', cam_extreme_t(study%least_base, e(measure_convex)%angle, .true.))
         end if
         do k = 0, 2
            call put('output'//to_text(k + 1), e(measure_output + k))
         end do
         do k = 0, 2
            call put('input'//to_text(k + 1), e(measure_input + k))
         end do
         if (allocated(study%shape%motion%ways%crossings)) then
            do k = 1, size(study%shape%motion%ways%crossings)
               associate (one => study%shape%motion%ways%crossings(k))
                  call put('dead_point_'//trim(merge('passed', 'turned', one%passed)), cam_extreme_t(one%q, one%angle, .true.))
               end associate
            end do
         end if
         do k = 1, 2
            if (study%shape%flat) exit
            if (size(study%centres(k)%corners) == 0) cycle
            call put('smallest_base_'//trim(side_names(k)), cam_extreme_t(study%centres(k)%base, 0.0_wp, .true.))
            call put('smallest_x_'//trim(side_names(k)), cam_extreme_t(real(study%centres(k)%smallest, wp), 0.0_wp, .true.))
            call put('smallest_y_'//trim(side_names(k)), cam_extreme_t(aimag(study%centres(k)%smallest), 0.0_wp, .true.))
         end do
         if (study%paths(path_cutter)%found) then
            call put('cutter_deviation', cam_extreme_t(study%paths(path_cutter)%deviation, 0.0_wp, .true.))
            call put('cutter_arcs', cam_extreme_t(real(size(study%paths(path_cutter)%arcs), wp), 0.0_wp, .true.))
            call put('cutter_chords', cam_extreme_t(study%paths(path_cutter)%chords, 0.0_wp, .true.))
         end if
         if (study%roller%depth > 0.0_wp) call put('crossing_depth', cam_extreme_t(study%roller%depth, study%roller%at, .true.))
         if (study%cutter%depth > 0.0_wp) call put('gouge_depth', cam_extreme_t(study%cutter%depth, study%cutter%at, .true.))
      end associate
      if (forces_known(study)) then
         associate (fine => study%fine)
            call put('force_least', cam_extreme_t(minval(fine%force), 0.0_wp, .true.))
            call put('force_most', cam_extreme_t(maxval(fine%force), 0.0_wp, .true.))
            call put('stress', cam_extreme_t(maxval(fine%stress), 0.0_wp, maxval(fine%stress) > 0.0_wp))
            call put('contact_lost_rpm', cam_extreme_t(fine%lost_speed, fine%lost_at, fine%lost_speed > 0.0_wp))
         end associate
         if (allocated(study%flanks)) then
            do k = 1, size(study%flanks, 2)
               call put('flank_change_jerk', cam_extreme_t(study%flanks(2, k), study%flanks(1, k), .true.))
            end do
         end if
      end if
      table = table_of('extremes'//suffix, 'a row for each extreme: lengths in units of length, angles in degrees')
      call table%add('what', what(:rows))
      call table%add('value', value(:rows))
      call table%add('cam_angle', angle(:rows), 'deg')
      call tables%put(table)

   contains

      subroutine put(name, extreme)
         character(*), intent(in) :: name
         type(cam_extreme_t), intent(in) :: extreme

         if (.not. extreme%found) return
         rows = rows + 1
         what(rows) = name
         value(rows) = extreme%value
         angle(rows) = extreme%angle
      end subroutine put
   end subroutine put_extremes
end module psalm_cam_list
