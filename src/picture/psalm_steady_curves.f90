!> Curves of what ssics found: responses over a turn, the link drawn bent, amplitudes over speeds with the unstable ones shaded,
!> the chart of stability (Oldham, figure 14.2).
module psalm_steady_curves
   use psalm_crank_motion, only: crank_motion_t, constant_motion
   use psalm_data_set, only: data_set_t
   use psalm_drive_study, only: drive_study_t
   use psalm_flex_list, only: flexible_name
   use psalm_flex_study, only: flex_study_t, stress_kinds
   use psalm_hill, only: hill_t
   use psalm_kinds, only: wp, pi, full_turn
   use psalm_periodic, only: periodic_t, periodic_from_samples
   use psalm_plot, only: plot_t, begin_plot, add_line, add_span, look_area, look_dashed, look_dots, look_joined, &
                         look_line, look_thin, round_down
   use psalm_steady_study, only: steady_study_t
   use psalm_text, only: to_text
   use psalm_vibration_list, only: root_of
   use psalm_vibration_study, only: vibration_study_t
   implicit none (type, external)
   private
   public :: make_steady_curves, most_shown_modes

   integer, parameter :: most_shown_modes = 4 !! curves of modes in one panel
   integer, parameter :: steps_of_speed = 180 !! of a turn, at which the speed of the crank is drawn
   integer, parameter :: poses = 12           !! angles of the crank at which the link is drawn bent
   integer, parameter :: stations = 48        !! along the link
   real(wp), parameter :: shown_bend = 0.1_wp !! of its size a link of elements is drawn bent at most
   integer, parameter :: red = 0              !! the colour of limits
   real(wp), parameter :: rule(2) = [1.4_wp, 0.85_wp] !! Oldham (1977), equation 14.15: frequency/speed from which a link is safe

contains

   !> The curves of a study; none if there is nothing to draw.
   subroutine make_steady_curves(set, study, plots)
      type(data_set_t), intent(in) :: set
      type(steady_study_t), intent(in) :: study
      type(plot_t), allocatable, intent(out) :: plots(:)
      integer :: k

      allocate (plots(0))
      if (study%crank%varies) call add_crank(study%crank, plots)
      if (allocated(study%vibration)) call add_vibration(study%vibration, plots)
      if (allocated(study%flexible)) then
         do k = 1, size(study%flexible)
            associate (one => study%flexible(k))
               if (one%steady) call add_flexible('link '//flexible_name(set, one), one, plots)
            end associate
         end do
      end if
      if (allocated(study%drive)) then
         if (study%drive%found) call add_drive(study%drive, plots)
      end if
      if (.not. allocated(study%hill)) return
      if (allocated(study%hill%coupled)) then
         if (study%hill%coupled%unique) call add_equations(study%hill%coupled%y, plots)
         return
      end if
      if (.not. study%hill%hill%unique) return
      call begin_turn("y of Hill's equation", full_turn, plots)
      call add_response('', 1, study%hill%hill, 1.0_wp, constant_motion(1.0_wp), 1, plots(size(plots)))
   end subroutine make_steady_curves

   !> The speed of the crank where it varies.
   subroutine add_crank(crank, plots)
      type(crank_motion_t), intent(in) :: crank
      type(plot_t), allocatable, intent(inout) :: plots(:)
      type(crank_motion_t) :: turn

      turn = crank%at_steps(steps_of_speed)
      call begin_turn('speed of the crank, rad/s', crank%sense*full_turn, plots)
      call add_line(plots(size(plots)), '', look_line, 1, [turn%input, crank%sense*full_turn], &
                    crank%speed*[turn%rate, turn%rate(1)])
   end subroutine add_crank

   !> The responses of several equations of Hill.
   subroutine add_equations(y, plots)
      real(wp), intent(in) :: y(:, :)            !! shape (places, equations)
      type(plot_t), allocatable, intent(inout) :: plots(:)
      integer :: i, k, n

      n = size(y, 1)
      call begin_turn("y of Hill's equations", full_turn, plots)
      do k = 1, size(y, 2)
         call add_line(plots(size(plots)), to_text(k), look_line, k, [(full_turn*real(i, wp)/real(n, wp), i=0, n)], &
                       [y(:, k), y(1, k)])
      end do
   end subroutine add_equations

   !> A link of beam elements: its greatest stresses over the turn, and where it bends most.
   subroutine add_flexible(link, study, plots)
      character(*), intent(in) :: link           !! its name
      type(flex_study_t), intent(in) :: study
      type(plot_t), allocatable, intent(inout) :: plots(:)
      character(*), parameter :: kinds(stress_kinds) = [character(14) :: 'bending', 'along the link', 'both together']
      type(plot_t) :: axis
      real(wp) :: turn, factor, extent, moved(2, size(study%link%frame%x, 2))
      integer :: i, k, worst(2)

      turn = study%cycle%turn%crank%sense*full_turn
      if (study%stressed) then
         call begin_turn('greatest stress of '//link//', Pa', turn, plots)
         do k = 1, stress_kinds
            call add_line(plots(size(plots)), trim(kinds(k)), look_line, k, [study%cycle%turn%crank%input, turn], &
                          [study%stress(:, k), study%stress(1, k)])
         end do
      end if
      worst = maxloc(study%displacement(1, :, :)**2 + study%displacement(2, :, :)**2)
      associate (x => study%link%frame%x)
         moved = study%displacement(:, :, worst(2))
         extent = max(maxval(x(1, :)) - minval(x(1, :)), maxval(x(2, :)) - minval(x(2, :)))
         if (.not. maxval(abs(moved)) > 0.0_wp) return
         factor = round_down(shown_bend*extent/maxval(abs(moved)))
         moved = x + factor*moved
         axis%from = min(minval(x(1, :)), minval(moved(1, :)))
         axis%to = max(maxval(x(1, :)), maxval(moved(1, :)))
         axis%below = 'along the line that holds the link, m'
         call begin_plot(link//' where it bends most, '//to_text(nint(factor))//' times, m', axis, plots)
         do i = 1, size(study%link%frame%elements)
            associate (nodes => study%link%frame%elements(i)%nodes)
               call add_line(plots(size(plots)), trim(merge('at rest', '       ', i == 1)), look_thin, 2, x(1, nodes), x(2, nodes))
            end associate
         end do
         do i = 1, size(study%link%frame%elements)
            associate (nodes => study%link%frame%elements(i)%nodes)
               call add_line(plots(size(plots)), trim(merge('bent   ', '       ', i == 1)), look_line, 1, moved(1, nodes), &
                             moved(2, nodes))
            end associate
         end do
      end associate
   end subroutine add_flexible

   subroutine add_vibration(study, plots)
      type(vibration_study_t), intent(in) :: study
      type(plot_t), allocatable, intent(inout) :: plots(:)
      integer :: j, k
      logical :: bent

      bent = size(study%modes) > 0
      if (bent) bent = study%modes(1)%hill%unique
      if (bent) then
         call begin_turn('deflection by mode, m', study%cycle%crank%sense*full_turn, plots)
         do j = 1, min(size(study%modes), most_shown_modes)
            call add_response('mode '//to_text(j), j, study%modes(j)%hill, study%cycle%length, study%cycle%crank, 1, &
                              plots(size(plots)))
         end do
         call add_poses(study, plots)
      end if
      if (any(study%speeds%known)) then
         call begin_speeds('greatest deflection of mode 1, m', study%speeds%speed, plots)
         do k = 1, size(study%bands)
            call add_span(plots(size(plots)), study%bands(k)%from, study%bands(k)%to)
         end do
         call add_line(plots(size(plots)), '', look_joined, 1, study%speeds%speed, study%speeds%amplitude, study%speeds%known)
      end if
      if (size(study%chart) > 0) call add_chart(study, plots)
   end subroutine add_vibration

   !> The link in its own axes at equal steps of the crank.
   subroutine add_poses(study, plots)
      type(vibration_study_t), intent(in) :: study
      type(plot_t), allocatable, intent(inout) :: plots(:)
      type(plot_t) :: axis
      type(periodic_t) :: q(size(study%modes))
      real(wp), dimension(0:stations) :: x, v
      real(wp) :: angle, time
      integer :: i, j, k

      do j = 1, size(q)
         if (study%modes(j)%hill%unique) q(j) = periodic_from_samples(study%cycle%length*study%modes(j)%hill%y)
      end do
      x = [(real(k, wp)/real(stations, wp), k=0, stations)]
      axis%to = study%cycle%length
      axis%below = 'along the link, m'
      call begin_plot('the bent link: deflection, m', axis, plots)
      do i = 0, poses - 1
         angle = study%cycle%crank%sense*full_turn*real(i, wp)/real(poses, wp)
         time = 2.0_wp*pi*real(i, wp)/real(poses, wp)
         if (study%cycle%crank%varies) time = study%cycle%crank%time_of(angle)
         v = 0.0_wp
         do j = 1, size(q)
            if (study%modes(j)%hill%unique) v = v + q(j)%at(time)*sin(real(j, wp)*pi*x)
         end do
         call add_line(plots(size(plots)), to_text(nint(angle))//' degrees', &
                       look_line, i + 1, x*study%cycle%length, v)
      end do
   end subroutine add_poses

   !> Areas between the boundaries of each p; the case itself as a point; the rule of thumb.
   subroutine add_chart(study, plots)
      type(vibration_study_t), intent(in) :: study
      type(plot_t), allocatable, intent(inout) :: plots(:)
      type(plot_t) :: axis
      real(wp), dimension(size(study%chart)) :: low, high
      integer :: p, k, last

      axis%to = study%greatest_e
      axis%below = 'e, factor on the inertia of the other links'
      call begin_plot('frequency/speed, chart of stability', axis, plots)
      last = ubound(study%chart(1)%exact%high, 1)
      associate (plot => plots(size(plots)), chart => study%chart, ends => [0.0_wp, study%greatest_e])
         ! it ends where its last boundaries are known for all e; below the boundary of p = 0 all is unstable
         plot%high = max(1.0_wp, study%ratio)
         do k = 1, size(chart)
            plot%high = max(plot%high, root_of(chart(k)%exact%high(last)))
         end do
         do p = 0, last
            low = [(root_of(chart(k)%exact%low(p)), k=1, size(chart))]
            high = [(root_of(chart(k)%exact%high(p)), k=1, size(chart))]
            if (p == 0) low = min(0.0_wp, high)
            call add_line(plot, trim(merge('unstable', '        ', p == 0)), look_area, red, chart%e, low, other=high)
            if (p > 0) call add_line(plot, '', look_thin, red, chart%e, high)
         end do
         call add_line(plot, 'rule (14.15)', look_dashed, 3, ends, rule(1) + rule(2)*ends)
         call add_line(plot, 'this case', look_dots, 1, [study%given_e], [study%ratio])
      end associate
   end subroutine add_chart

   subroutine add_drive(study, plots)
      type(drive_study_t), intent(in) :: study
      type(plot_t), allocatable, intent(inout) :: plots(:)
      real(wp), allocatable :: inputs(:)
      real(wp) :: turn, half
      integer :: k, n

      turn = study%turn%crank%sense*full_turn/real(study%waves, wp)
      n = size(study%inertia)
      call begin_turn('inertia at the crank, kg m2', turn, plots)
      inputs = [study%turn%crank%inputs(study%waves*n), study%turn%crank%sense*full_turn]
      call add_line(plots(size(plots)), '', look_line, 1, inputs(:n + 1), &
                    [study%inertia, study%inertia(1)])
      if (study%hill%unique) then
         call begin_turn('swing of the crank, rad', turn, plots)
         call add_response('', 1, study%hill, 1.0_wp, study%turn%crank, study%waves, plots(size(plots)))
      end if
      if (.not. any(study%speeds%known)) return
      call begin_speeds('greatest swing of the crank, rad', study%speeds%speed, plots)
      half = 0.0_wp
      if (size(study%speeds) > 1) half = 0.5_wp*(study%speeds(2)%speed - study%speeds(1)%speed)
      do k = 1, size(study%speeds)
         if (study%speeds(k)%grows) call add_span(plots(size(plots)), study%speeds(k)%speed - half, study%speeds(k)%speed + half)
      end do
      call add_line(plots(size(plots)), '', look_joined, 1, study%speeds%speed, study%speeds%amplitude, study%speeds%known)
   end subroutine add_drive

   !> A periodic response over a turn of the crank.
   subroutine add_response(label, colour, hill, unit, crank, waves, plot)
      character(*), intent(in) :: label
      integer, intent(in) :: colour
      type(hill_t), intent(in) :: hill
      real(wp), intent(in) :: unit        !! of y
      type(crank_motion_t), intent(in) :: crank
      integer, intent(in) :: waves        !! periods in a turn
      type(plot_t), intent(inout) :: plot
      real(wp), allocatable :: inputs(:)
      integer :: n

      if (.not. hill%unique) return
      n = size(hill%y)
      inputs = [crank%inputs(waves*n), crank%sense*full_turn]
      call add_line(plot, label, look_line, colour, inputs(:n + 1), &
                    unit/real(waves, wp)*[hill%y, hill%y(1)])
   end subroutine add_response

   !> Begin a plot over a turn of the crank, or the period that a turn is made of.
   subroutine begin_turn(name, turn, plots)
      character(*), intent(in) :: name
      real(wp), intent(in) :: turn          !! degrees, negative backwards
      type(plot_t), allocatable, intent(inout) :: plots(:)
      type(plot_t) :: axis

      axis%from = min(0.0_wp, turn)
      axis%to = max(0.0_wp, turn)
      axis%turning = .true.
      axis%below = 'input from the reference position, degrees'
      call begin_plot(name, axis, plots)
   end subroutine begin_turn

   !> Begin a plot over speeds.
   subroutine begin_speeds(name, speeds, plots)
      character(*), intent(in) :: name
      real(wp), intent(in) :: speeds(:)
      type(plot_t), allocatable, intent(inout) :: plots(:)
      type(plot_t) :: axis

      axis%from = minval(speeds)
      axis%to = max(maxval(speeds), axis%from + tiny(axis%from))
      axis%logarithmic = .true.
      axis%below = 'speed, rad/s (shaded: unstable, the curve is not the response)'
      call begin_plot(name, axis, plots)
   end subroutine begin_speeds
end module psalm_steady_curves
