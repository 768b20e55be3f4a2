!> What a cam costs at many angles, and how near a disc is to the circle it must be.
module bench_cams
   use psalm_cam_group, only: cams_of
   use psalm_cam_profile, only: cam_axes_t, cam_points_t, roller_profile, side_of_centre
   use psalm_cam_study, only: cam_study_t, find_cam, cam_role_t
   use psalm_cam_trace, only: cam_trace_t, clear_trace
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, new_problem
   use psalm_kinds, only: wp, dp, full_turn
   use psalm_mechanism, only: output_t
   use psalm_output_kind, only: motion_pose
   use psalm_preparation, only: prepare, prepared_t
   use psalm_rates, only: rates_t, prepare_rates, differentiate, output_rates, highest_order
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: measure_cam, measure_disc

   integer, parameter :: points = 3600
   integer, parameter :: samples = 50            !! timings of which the best counts

contains

   subroutine load(file, program, set, prepared)
      character(*), intent(in) :: file, program
      type(data_set_t), intent(out) :: set
      type(prepared_t), intent(out) :: prepared
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(line_t) :: none(0)

      call read_cases(file, sets, findings, program=program)
      if (findings%failed()) error stop 'the data set cannot be read'
      set = sets(1)
      set%method%nguess = 0
      call prepare(set, none, prepared, findings)
      if (findings%failed()) error stop 'the data set is wrong'
   end subroutine load

   pure function even_angles() result(angle)
      real(wp) :: angle(points)
      integer :: i

      angle = [(full_turn*real(i - 1, wp)/real(points, wp), i=1, points)]
   end function even_angles

   !> Of 3600 cam angles: seconds of law, linkage backwards and follower | seconds of profile, cutter, curvature, pressure angle.
   subroutine measure_cam(file)
      character(*), intent(in) :: file
      type(data_set_t) :: set
      type(prepared_t) :: prepared
      type(cam_study_t), allocatable :: study
      type(cam_trace_t) :: states
      type(cam_points_t) :: shape
      real(wp) :: angle(points), sum_of_all
      real(dp) :: began, traced, shaped, best(2)
      integer :: k

      call load(file, 'calm', set, prepared)
      allocate (study)
      call find_cam(set, cams_of(set), prepared, cam_role_t(), study)
      angle = even_angles()
      best = huge(best)
      sum_of_all = 0.0_wp
      associate (s => study%shape)
         do k = 1, samples
            call cpu_time(began)
            call s%motion%trace(angle, s%motion%law%piece_at(angle), states)
            call cpu_time(traced)
            call roller_profile(states, s%axes, s%side, s%roller, s%cutter, shape)
            call cpu_time(shaped)
            best = min(best, [traced - began, shaped - traced])
            sum_of_all = sum_of_all + shape%radius(1 + modulo(k, points))
         end do
      end associate
      if (.not. sum_of_all > 0.0_wp) error stop 'the cam is hollow'
      print '(es24.16,"|",es24.16)', best
   end subroutine measure_cam

   !> A crank-rocker is a disc, eccentric by the crank, under a roller on the rocker. Errors of the profile against the circle
   !> and of its curvature, relative, over 3600 angles.
   subroutine measure_disc(file)
      character(*), intent(in) :: file
      type(data_set_t) :: set
      type(prepared_t) :: prepared
      type(problem_t), allocatable :: problem
      type(rates_t) :: rates
      type(cam_trace_t) :: states
      type(cam_points_t) :: shape
      real(wp) :: d(highest_order, 3), crank, coupler, roller
      integer :: block, offset, m, i

      call load(file, 'psalm', set, prepared)
      crank = set%links%arcl(1, 1)
      coupler = set%links%arcl(2, 1)
      roller = 0.2_wp*coupler
      ! the start of the rocker's arc is the pin of the coupler
      prepared%mechanism%outputs = [output_t(motion_pose, 3, .true.)]
      prepared%given%crnki = 0.0_wp
      prepared%given%outlk = 0.0_wp
      allocate (problem)
      call new_problem(prepared%mechanism, prepared%given, prepared%parameters, even_angles(), .false., problem)
      call problem%want_derivatives(.false.)
      call problem%bind(problem%given)
      call prepare_rates(problem, rates)
      call clear_trace(even_angles(), states)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, m)
         call problem%output_of(m)
         call differentiate(problem, rates, m, highest_order)
         do i = 1, m
            call output_rates(problem, rates, i, highest_order, d)
            states%c(0, offset + i) = cmplx(problem%output%actual(1, i, problem%linkage), &
                                            problem%output%actual(2, i, problem%linkage), wp)
            states%c(1:3, offset + i) = cmplx(d(:, 1), d(:, 2), wp)
            states%by_input(offset + i) = cmplx(d(1, 1), d(1, 2), wp)
         end do
      end do
      call roller_profile(states, cam_axes_t(), side_of_centre(states, cam_axes_t()), roller, roller, shape)
      print '(es24.16,"|",es24.16)', maxval(abs(abs(shape%profile - crank) - (coupler - roller)))/coupler, &
         maxval(abs(shape%bend*coupler - 1.0_wp))
   end subroutine measure_disc
end module bench_cams
