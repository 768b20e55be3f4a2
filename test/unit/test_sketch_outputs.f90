!> Outputs and joints of sketches by their loops, against the same by the poses of their links; where motions from the drawing end.
program test_sketch_outputs
   use check, only: checks_t
   use psalm_cases, only: read_cases, read_case_text
   use psalm_chain_study, only: chain_study_t, study_chain, turn_may_repeat
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t, make_problem
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_parameters, only: parameters_t, no_parameters, variable_gama, variable_length
   use psalm_preparation, only: prepared_t, prepare
   use psalm_sketch_study, only: sketch_study_t, study_sketch
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_tolerance, only: deviating_t, tolerance_t, find_tolerances
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: files(*) = [character(24) :: &
      'adjustable_stroke', 'chebyshev', 'double_wishbone', 'horst_suspension', &
      'jansen', 'klann', 'laser_cut_lift', 'peaucellier', &
      'quick_return', 'scissors_spindle', 'scissors_turned', &
      'sketch_four_bar', 'sketch_slider_crank', 'stephenson1_six_bar', 'stephenson3_six_bar', &
      'toggle_press', 'watt_six_bar', 'wiper']
   type(checks_t) :: t
   integer :: i

   do i = 1, size(files)
      call both_ways(trim(files(i)))
   end do
   call every_kind()
   call end_of_range()
   call change_point()
   call sliding_input()
   call geared_cranks()
   call wheels_after_a_turn()
   call tolerances()
   call t%report()

contains

   !> A sketch with loops, studied by them.
   subroutine by_loops(set, speed, accel, study, motion)
      type(data_set_t), intent(inout) :: set
      real(wp), intent(in) :: speed, accel
      type(sketch_study_t), intent(out) :: study
      type(motion_t), intent(out) :: motion
      type(prepared_t) :: prepared
      class(problem_t), allocatable :: problem
      type(diagnostics_t) :: findings
      type(line_t) :: none(0)

      call prepare(set, none, prepared, findings)
      call t%is_true(prepared%ready, set%title//': prepared')
      if (.not. prepared%ready) error stop 'a sketch of the test cannot be prepared'
      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call problem%analyse(prepared%given, motion)
      call study_sketch(set, problem, prepared%given, motion%closed, speed, accel, study)
   end subroutine by_loops

   subroutine compare(set)
      type(data_set_t), intent(inout) :: set
      type(sketch_study_t) :: loops
      type(chain_study_t) :: poses
      type(motion_t) :: motion
      real(wp), parameter :: speed = 1.5_wp, accel = -0.7_wp, tight = 1.0e-10_wp
      real(wp) :: size_of, scale
      integer :: n, order, k

      call t%is_true(.not. allocated(set%search_in_poses), set%title//': has loops')
      call by_loops(set, speed, accel, loops, motion)
      call study_chain(set, speed, accel, poses)
      call t%is_true(all(loops%closed .eqv. poses%closed), set%title//': closes at the same positions')
      call t%is_true(all(loops%dead .eqv. poses%dead), set%title//': the same dead points')
      call t%close_to(maxval(abs(loops%inputs - poses%inputs)), 0.0_wp, tight, set%title//': inputs')
      call t%is_true(all(loops%names == poses%names), set%title//': names')
      size_of = maxval(abs(poses%joints(:, 0, :)))
      do order = 0, 3
         scale = size_of
         do k = 1, size(loops%closed)
            if (poses%closed(k)) scale = max(scale, maxval(abs(poses%joints(:, order, k))))
         end do
         do k = 1, size(loops%closed)
            if (.not. poses%closed(k) .or. (order > 0 .and. poses%dead(k))) cycle
            call t%is_true(maxval(abs(loops%joints(:, order, k) - poses%joints(:, order, k))) <= tight*scale, set%title//': joints')
         end do
         do n = 1, size(loops%names)
            scale = size_of
            do k = 1, size(loops%closed)
               if (poses%closed(k) .and. poses%values(n, 0, k) < huge(scale)) scale = max(scale, abs(poses%values(n, order, k)))
            end do
            do k = 1, size(loops%closed)
               if (.not. poses%closed(k) .or. (order > 0 .and. poses%dead(k))) cycle
               call t%is_true(abs(loops%values(n, order, k) - poses%values(n, order, k)) <= tight*scale, set%title//': '// &
                              trim(loops%names(n)))
            end do
         end do
      end do
   end subroutine compare

   !> A shipped sketch of dyads.
   subroutine both_ways(file)
      character(*), intent(in) :: file
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      integer :: k

      call read_cases('data/'//file//'.nml', sets, findings)
      do k = 1, size(sets)
         call compare(sets(k))
      end do
   end subroutine both_ways

   !> A sketch of a text.
   subroutine read_one(text, set)
      character(*), intent(in) :: text
      type(data_set_t), intent(out) :: set
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      integer :: k

      call read_case_text(text, 'test', sets, findings, 'psalm')
      if (findings%failed()) then
         do k = 1, findings%count
            call t%is_true(.false., 'the sketch is sound', findings%list(k)%render())
         end do
      end if
      if (findings%failed()) error stop 'a sketch of the test cannot be read'
      set = sets(1)
   end subroutine read_one

   !> All kinds of outputs, with a slide whose length is given and moves the drawing.
   subroutine every_kind()
      type(data_set_t), save :: set

      call read_one('EVERY KIND'//nl//" &CHAIN JNT='A','B','C','D','P','Q', JX=0.0,0.0,60.0,90.0,40.0,130.0,"//nl// &
                    " JY=0.0,25.0,60.0,0.0,80.0,20.0, LNAME='frame','crank','coupler','rocker','rod','block',"//nl// &
                    " LNK='A D','A B','B C P','C D','C Q','Q', NSLIDE=1, SNAME='S', SLNK='frame', SLNK2='block', SLX=130.0,"//nl// &
                    " SLY=20.0, SLANG=170.0, LENP='A B', LENV=24.0 &END"//nl//" &DRIVES DRIVE='A' &END"//nl// &
                    " &OUTPUTS OUTPUT='between A B C D','pose P B C','slide S','distance P D','x P','y Q','angle coupler',"// &
                    "'point C','distance P','ratio O3 O7', ONAME='O1','O2','O3','O4','O5','O6','O7','O8','O9','O10' &END"//nl// &
                    ' &METHOD IKIN=15 &END'//nl, set)
      call compare(set)
   end subroutine every_kind

   !> A four-bar whose crank swings: crank 3, coupler 4, rocker 4, frame 6. At the ends coupler and rocker are in a line.
   subroutine end_of_range()
      type(data_set_t), save :: set
      type(sketch_study_t), save :: study
      type(motion_t), save :: motion
      real(wp) :: furthest
      integer :: k

      call read_one('SWINGS'//nl//" &CHAIN JNT='A','B','C','D', JX=0.0,0.0,4.0,6.0, JY=0.0,3.0,3.4641016151377544,0.0,"//nl// &
                    " LNK='A D','A B','B C','C D', LENP='B C','C D', LENV=4.0,4.0 &END"//nl// &
                    " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point C' &END &METHOD IKIN=1 &END"//nl, set)
      call by_loops(set, 1.0_wp, 0.0_wp, study, motion)
      ! 8**2 = 3**2 + 6**2 - 2*3*6*cos(furthest)
      furthest = acos((9.0_wp + 36.0_wp - 64.0_wp)/36.0_wp)*degrees_per_radian
      do k = 1, size(study%closed)
         associate (from_frame => modulo(90.0_wp + study%inputs(1, k) + 180.0_wp, 360.0_wp) - 180.0_wp)
            call t%is_true(study%closed(k) .eqv. abs(from_frame) <= furthest, 'a crank that swings')
         end associate
      end do
      call t%is_true(.not. any(motion%beyond), 'what opens is not called beyond')
   end subroutine end_of_range

   !> A parallelogram from 60 degrees: where all its links are in a line the motion ends, though the loop closes everywhere. Of a
   !> link pair that opens twice in a turn one range is not reached.
   subroutine change_point()
      type(data_set_t), save :: set
      type(sketch_study_t), save :: study
      type(motion_t), save :: motion
      integer :: k

      call read_one('PARALLELOGRAM'//nl//" &CHAIN JNT='A','B','C','D', JX=0.0,1.0,4.0,3.0, JY=0.0,1.7,1.7,0.0,"//nl// &
                    " LNK='A D','A B','B C','C D' &END &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point C' &END"//nl// &
                    ' &METHOD NDES=8, DELT=0.0,60.0,110.0,130.0,200.0,290.0,310.0,-50.0 &END'//nl, set)
      call by_loops(set, 1.0_wp, 0.0_wp, study, motion)
      call t%is_true(all(study%closed .eqv. [.true., .true., .true., .false., .false., .false., .true., .true.]), &
                     'a parallelogram is not followed through its change point')
      call t%is_true(all(motion%beyond .neqv. motion%closed), 'it could be put together there')
      call read_one('TWO RANGES'//nl//" &CHAIN JNT='A','B','C','D', JX=0.0,0.0,4.5,4.0, JY=0.0,5.0,3.0,0.0,"//nl// &
                    " LNK='A D','A B','B C','C D', LENP='B C','C D', LENV=5.0,3.0 &END"//nl// &
                    " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point C' &END"//nl// &
                    ' &METHOD IKIN=10 &END'//nl, set)
      call by_loops(set, 1.0_wp, 0.0_wp, study, motion)
      call t%is_true(any(motion%beyond), 'a crank that swings on either side of the frame')
      do k = 1, size(study%closed)
         if (motion%beyond(k)) call t%is_true(modulo(90.0_wp + study%inputs(1, k), 360.0_wp) > 180.0_wp, 'the other side')
      end do
   end subroutine change_point

   !> A slider that pushes a crank: at the dead point of the crank the range ends.
   subroutine sliding_input()
      type(data_set_t), save :: set
      type(sketch_study_t), save :: study
      type(motion_t), save :: motion

      call read_one('PUSHED'//nl//" &CHAIN JNT='A','B','C', JX=0.0,0.0,4.0, JY=0.0,3.0,0.0,"//nl// &
                    " LNAME='frame','crank','rod','block', LNK='A','A B','B C','C',"//nl// &
                    " NSLIDE=1, SNAME='S', SLNK='frame', SLNK2='block', SLX=4.0, SLY=0.0, SLANG=0.0 &END"//nl// &
                    " &DRIVES DRIVE='S' &END &OUTPUTS OUTPUT='angle crank' &END"//nl// &
                    ' &METHOD NDES=6, DELT=0.0,3.9,4.0,4.1,-1.9,-2.1 &END'//nl, set)
      call by_loops(set, 1.0_wp, 0.0_wp, study, motion)
      call t%is_true(all(study%closed .eqv. [.true., .true., .true., .false., .true., .false.]), 'a slider and its dead points')
   end subroutine sliding_input

   !> Two cranks of which one turns half as fast: after a turn of the first nothing stands as before, and where the motion ends
   !> on the way nothing beyond is reached.
   subroutine geared_cranks()
      type(data_set_t), save :: set

      call read_one('GEARED'//nl//" &CHAIN JNT='A','B','C','D','E', JX=0.0,0.0,40.0,80.0,80.0, JY=0.0,25.0,60.0,20.0,0.0,"//nl// &
                    " LNAME='frame','one','two','three','four', LNK='A E','A B','B C','C D','D E' &END"//nl// &
                    " &DRIVES DRIVE='A','E', DBASE='frame','frame', DLINK='one','four', RATIO=0.0,0.5 &END"//nl// &
                    " &OUTPUTS OUTPUT='point C','angle three' &END"//nl// &
                    ' &METHOD NDES=7, DELT=0.0,90.0,180.0,360.0,540.0,720.0,-60.0 &END'//nl, set)
      call compare(set)
   end subroutine geared_cranks

   !> The teeth say whether a wheel stands elsewhere after a turn, and so does the study of the turn.
   subroutine wheels_after_a_turn()
      call after_a_turn("GCARR='frame', GTA=30.0, GTB=40.0", .false.)
      call after_a_turn("GCARR='frame', GTA=40.0, GTB=20.0", .true.)
   end subroutine wheels_after_a_turn

   subroutine after_a_turn(gears, repeats)
      character(*), intent(in) :: gears
      logical, intent(in) :: repeats
      type(data_set_t) :: set
      type(chain_study_t) :: study

      call read_one('WHEEL'//nl//" &CHAIN JNT='A','B','C','D','W','V', JX=0.0,0.0,60.0,70.0,50.0,60.0,"//nl// &
                    " JY=0.0,20.0,60.0,0.0,0.0,0.0,"//nl// &
                    " LNAME='frame','crank','coupler','rocker','wheel', LNK='A D W','A B','B C','C D','W V',"//nl// &
                    " GEARA='crank', GEARB='wheel', "//gears//' &END'//nl//" &DRIVES DRIVE='A' &END"//nl// &
                    " &OUTPUTS OUTPUT='point V' &END"//nl//' &METHOD NDES=2, DELT=0.0,360.0 &END'//nl, set)
      call t%is_true(turn_may_repeat(set) .eqv. repeats, 'the teeth tell where the wheel is after a turn')
      call study_chain(set, 1.0_wp, 0.0_wp, study)
      call t%is_true(all(study%closed), 'the wheel turns')
      call t%is_true((maxval(abs(study%values(:, 0, 2) - study%values(:, 0, 1))) < 1.0e-9_wp) .eqv. repeats, &
                     'the study of the turn says the same')
   end subroutine after_a_turn

   !> Bands of all outputs against differences, dimension by dimension; those of the first output are the old ones.
   subroutine tolerances()
      type(data_set_t), save :: set
      type(prepared_t), save :: prepared
      type(diagnostics_t), save :: findings
      type(line_t), save :: none(0)
      type(deviating_t), allocatable, save :: deviating
      type(tolerance_t), allocatable, save :: linear
      type(problem_t), allocatable, save :: problem
      type(parameters_t), save :: one
      type(dimensions_t), save :: changed
      type(sketch_study_t), save :: low, high
      real(wp), parameter :: step = 1.0e-4_wp
      real(wp) :: values(1), difference
      logical :: closes
      integer :: v, n

      call read_one('BANDS'//nl//" &CHAIN JNT='A','B','C','D','P','Q','R', JX=0.0,-4.0,33.0,90.0,20.0,60.0,130.0,"//nl// &
                    " JY=0.0,31.0,82.0,5.0,95.0,100.0,20.0, LNAME='frame','crank','coupler','rocker','rod','block',"//nl// &
                    " LNK='A D','A B','B C P Q','C D','C R','R', SNAME='S', SLNK='frame', SLNK2='block', SLX=130.0,"//nl// &
                    " SLY=20.0, SLANG=170.0 &END"//nl//" &DRIVES DRIVE='A' &END"//nl// &
                    " &OUTPUTS OUTPUT='point P','angle rocker','distance P D','x Q','between B C C D','slide S','pose Q B C',"// &
                    "'ratio slide_S angle_rocker' &END"//nl//' &METHOD NDES=3, DELT=0.0,20.0,40.0 &END'//nl// &
                    ' &TOLER TOLLEN=0.1, TOLANG=0.05 &END'//nl, set)
      call prepare(set, none, prepared, findings)
      allocate (deviating, linear, problem)
      call find_tolerances(set, prepared%mechanism, prepared%given, deviating, linear, closes)
      call t%is_true(closes .and. allocated(linear%bands), 'bands of all outputs')
      call t%is_true(maxval(abs(linear%bands%worst(:, :2) - linear%worst)) < 1.0e-12_wp, 'those of the first output')
      call t%is_true(count(.not. linear%bands%known) == 1, 'of a ratio there are none')
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      do v = 1, size(linear%variables)
         associate (variable => linear%variables(v))
            one = no_parameters(prepared%mechanism)
            select case (variable%kind)
            case (variable_length)
               call one%vary_length(prepared%mechanism, prepared%mechanism%seq(variable%loop, variable%arc))
            case (variable_gama)
               call one%vary_angle(prepared%mechanism, prepared%mechanism%seq(variable%loop, variable%arc))
            case default
               cycle
            end select
         end associate
         values = one%first_values(prepared%given)
         changed = prepared%given
         call one%apply(values - step, changed)
         call study_sketch(set, problem, changed, [.true., .true., .true.], 1.0_wp, 0.0_wp, low, changed=.true.)
         call one%apply(values + step, changed)
         call study_sketch(set, problem, changed, [.true., .true., .true.], 1.0_wp, 0.0_wp, high, changed=.true.)
         do n = 1, size(low%names)
            if (.not. linear%bands%known(n)) cycle
            difference = maxval(abs(high%values(n, 0, :) - low%values(n, 0, :)))/(2.0_wp*step)*linear%tolerance(v)
            call t%close_to(linear%bands%effect(v, n), difference, 1.0e-7_wp, 'effect on '//trim(low%names(n)))
         end do
      end do
   end subroutine tolerances
end program test_sketch_outputs
