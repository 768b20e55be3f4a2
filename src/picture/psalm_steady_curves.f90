!> What ssics found as a gnuplot script that carries its data: responses over a turn, the link drawn bent, amplitudes over speeds
!> with the unstable ones shaded, the chart of stability (Oldham, figure 14.2).
module psalm_steady_curves
   use psalm_data_set, only: data_set_t
   use psalm_drive_study, only: drive_study_t
   use psalm_hill, only: hill_t
   use psalm_kinds, only: wp, pi, full_turn
   use psalm_markup, only: clean_text, gnuplot_text, short_number
   use psalm_periodic, only: periodic_t, periodic_from_samples
   use psalm_steady_study, only: steady_study_t
   use psalm_text, only: text_t, full_precision, to_text
   use psalm_vibration_study, only: vibration_study_t
   implicit none (type, external)
   private
   public :: write_steady_curves, steady_panels, shown_root, most_shown_modes

   integer, parameter :: panel_height = 380   !! pixels
   integer, parameter :: most_shown_modes = 4 !! curves of modes in one panel
   integer, parameter :: poses = 12           !! angles of the crank at which the link is drawn bent
   integer, parameter :: stations = 48        !! along the link
   character(*), parameter :: colour_unstable = '#d3302f'

contains

   !> Number of panels that a study makes; 0: there is nothing to draw.
   pure integer function steady_panels(study)
      type(steady_study_t), intent(in) :: study

      steady_panels = 0
      if (allocated(study%vibration)) then
         associate (v => study%vibration)
            if (has_response(v)) steady_panels = steady_panels + 2
            steady_panels = steady_panels + count([any_known(v%speeds%known), size(v%chart) > 0])
         end associate
      end if
      if (allocated(study%drive)) then
         associate (d => study%drive)
            if (d%found) steady_panels = steady_panels + 1 + count([d%hill%unique, any_known(d%speeds%known)])
         end associate
      end if
      if (allocated(study%hill)) steady_panels = steady_panels + count([study%hill%hill%unique])
   end function steady_panels

   pure logical function any_known(known)
      logical, intent(in) :: known(:)

      any_known = any(known)
   end function any_known

   pure logical function has_response(vibration)
      type(vibration_study_t), intent(in) :: vibration

      has_response = size(vibration%modes) > 0
      if (has_response) has_response = vibration%modes(1)%hill%unique
   end function has_response

   !> Append a script that makes `name`.png and `name`.pdf in the directory it is run in.
   subroutine write_steady_curves(set, study, name, text)
      type(data_set_t), intent(in) :: set
      type(steady_study_t), intent(in) :: study
      character(*), intent(in) :: name      !! of the case, without directory
      type(text_t), intent(inout) :: text
      integer :: pass, panels

      panels = steady_panels(study)
      call text%add('# '//clean_text(trim(set%title)))
      if (allocated(study%vibration)) call write_vibration(study%vibration, text)
      if (allocated(study%drive)) then
         if (study%drive%found) call write_drive(study%drive, text)
      end if
      if (allocated(study%hill)) call write_response('$hill', study%hill%hill, 1.0_wp, 1.0_wp, 1, text)
      call text%add('set grid; set key outside right top; set lmargin 12; set rmargin 22; set format y "%g"')
      do pass = 1, 2
         if (pass == 1) then
            call text%add('set terminal pngcairo noenhanced size 1000,'//to_text(panels*panel_height + 40)//' font "sans,10"')
            call text%add('set output '//gnuplot_text(name//'.png'))
         else
            call text%add('set terminal pdfcairo noenhanced size 21cm,'//short_number(8.0_wp*real(panels, wp) + 0.8_wp)// &
                          'cm font "sans,9"')
            call text%add('set output '//gnuplot_text(name//'.pdf'))
         end if
         call text%add('set multiplot layout '//to_text(panels)//',1 title '//gnuplot_text(trim(set%title)))
         if (allocated(study%vibration)) call plot_vibration(study%vibration, text)
         if (allocated(study%drive)) then
            if (study%drive%found) call plot_drive(study%drive, text)
         end if
         if (allocated(study%hill)) then
            if (study%hill%hill%unique) call plot_turn("y of Hill''s equation", '$hill', "title 'y'", full_turn, text)
         end if
         call text%add('unset multiplot')
         call text%add('unset output')
      end do
   end subroutine write_steady_curves

   !> Root with its sign, as the thesis's chart has it.
   elemental real(wp) function shown_root(square)
      real(wp), intent(in) :: square

      shown_root = sign(sqrt(abs(square)), square)
   end function shown_root

   ! ---- data --------------------------------------------------------------------------------------------------------

   subroutine write_vibration(study, text)
      type(vibration_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: j, k, p

      do j = 1, min(size(study%modes), most_shown_modes)
         call write_response('$mode'//to_text(j), study%modes(j)%hill, study%cycle%length, study%cycle%sense, 1, text)
      end do
      if (has_response(study)) call write_poses(study, text)
      call text%add('$speeds << END')
      call text%add('# speed amplitude')
      do k = 1, size(study%speeds)
         if (study%speeds(k)%known) then
            call text%add(full_precision(study%speeds(k)%speed)//' '//full_precision(study%speeds(k)%amplitude))
         else
            call text%add(full_precision(study%speeds(k)%speed)//' NaN')
         end if
      end do
      call text%add('END')
      if (size(study%chart) == 0) return
      call text%add('$chart << END')
      call text%add('# e, then frequency/speed of both boundaries of each p: a block for each p')
      do p = 0, ubound(study%chart(1)%exact%low, 1)
         do k = 1, size(study%chart)
            associate (b => study%chart(k)%exact)
               call text%add(full_precision(study%chart(k)%e)//' '//full_precision(shown_root(b%low(p)))//' '// &
                             full_precision(shown_root(b%high(p))))
            end associate
         end do
         call text%add()
         call text%add()
      end do
      call text%add('END')
   end subroutine write_vibration

   !> Input in degrees, deflection.
   subroutine write_response(name, hill, unit, sense, waves, text)
      character(*), intent(in) :: name
      type(hill_t), intent(in) :: hill
      real(wp), intent(in) :: unit, sense !! of y; of the crank's turning
      integer, intent(in) :: waves        !! periods in a turn
      type(text_t), intent(inout) :: text
      integer :: i, n

      call text%add(name//' << END')
      if (hill%unique) then
         n = size(hill%y)
         do i = 0, n
            call text%add(full_precision(sense*full_turn*real(i, wp)/real(waves*n, wp))//' '// &
                          full_precision(unit/real(waves, wp)*hill%y(modulo(i, n) + 1)))
         end do
      end if
      call text%add('END')
   end subroutine write_response

   !> The link in its own axes at equal steps of the crank: place along it, deflection.
   subroutine write_poses(study, text)
      type(vibration_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(periodic_t) :: q(size(study%modes))
      real(wp) :: x, v
      integer :: i, j, k

      do j = 1, size(q)
         if (study%modes(j)%hill%unique) q(j) = periodic_from_samples(study%cycle%length*study%modes(j)%hill%y)
      end do
      call text%add('$poses << END')
      do i = 0, poses - 1
         do k = 0, stations
            x = real(k, wp)/real(stations, wp)
            v = 0.0_wp
            do j = 1, size(q)
               if (study%modes(j)%hill%unique) v = v + q(j)%at(2.0_wp*pi*real(i, wp)/real(poses, wp))*sin(real(j, wp)*pi*x)
            end do
            call text%add(full_precision(x*study%cycle%length)//' '//full_precision(v))
         end do
         call text%add()
         call text%add()
      end do
      call text%add('END')
   end subroutine write_poses

   subroutine write_drive(study, text)
      type(drive_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: i, n

      n = size(study%inertia)
      call text%add('$inertia << END')
      do i = 0, n
         call text%add(full_precision(study%turn%sense*full_turn*real(i, wp)/real(n*study%waves, wp))//' '// &
                       full_precision(study%inertia(modulo(i, n) + 1)))
      end do
      call text%add('END')
      call write_response('$swing', study%hill, 1.0_wp, study%turn%sense, study%waves, text)
      call text%add('$swings << END')
      do i = 1, size(study%speeds)
         if (study%speeds(i)%known) then
            call text%add(full_precision(study%speeds(i)%speed)//' '//full_precision(study%speeds(i)%amplitude))
         else
            call text%add(full_precision(study%speeds(i)%speed)//' NaN')
         end if
      end do
      call text%add('END')
   end subroutine write_drive

   ! ---- panels ------------------------------------------------------------------------------------------------------

   subroutine plot_vibration(study, text)
      type(vibration_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: j, k

      if (has_response(study)) then
         line = "title 'mode 1'"
         do j = 2, min(size(study%modes), most_shown_modes)
            if (study%modes(j)%hill%unique) line = line//", $mode"//to_text(j)//" using 1:2 with lines lw 1.5 title 'mode "// &
                                                   to_text(j)//"'"
         end do
         call plot_turn('deflection by mode, m', '$mode1', line, study%cycle%sense*full_turn, text)
         call text%add('set xlabel "along the link, m"; set xrange [0:'//full_precision(study%cycle%length)// &
                       ']; set xtics auto; '// &
                       'set ylabel "the bent link: deflection, m"')
         line = 'plot '
         do k = 0, poses - 1
            if (k > 0) line = line//', '
            line = line//'$poses index '//to_text(k)//' using 1:2 with lines lw 1.5 lc palette frac '// &
                   short_number(real(k, wp)/real(poses, wp))//" title '"// &
                   to_text(nint(study%cycle%sense*full_turn*real(k, wp)/real(poses, wp)))//" degrees'"
         end do
         call text%add('set palette model HSV defined (0 0 1 0.85, 1 1 1 0.85); unset colorbox')
         call text%add(line)
      end if
      if (any(study%speeds%known)) then
         do k = 1, size(study%bands)
            call shade(study%bands(k)%from, study%bands(k)%to, text)
         end do
         call plot_speeds('greatest deflection of mode 1, m', '$speeds', study%speeds%speed, text)
      end if
      if (size(study%chart) > 0) call plot_chart(study, text)
   end subroutine plot_vibration

   !> Bands between the boundaries of each p; the case itself as a point; the rule of thumb.
   subroutine plot_chart(study, text)
      type(vibration_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: p

      call text%add('$here << END')
      call text%add(full_precision(study%given_e)//' '//full_precision(study%ratio))
      call text%add('END')
      call text%add('set xlabel "e: inertia of the other links"; set xtics auto; set xrange [0:'// &
                    full_precision(study%greatest_e)//']; set ylabel "first frequency/speed"; set yrange [0:'// &
                    full_precision(top_of_chart(study))//']')
      ! below the boundary of p = 0 all is unstable
      line = "plot $chart index 0 using 1:3:(-1) with filledcurves fs solid 0.35 lc rgb '"//colour_unstable// &
             "' title 'unstable', "
      do p = 1, ubound(study%chart(1)%exact%low, 1)
         line = line//'$chart index '//to_text(p)//" using 1:2:3 with filledcurves fs solid 0.35 lc rgb '"//colour_unstable// &
                "' notitle, $chart index "//to_text(p)//" using 1:3 with lines lw 0.6 lc rgb '"//colour_unstable//"' notitle, "
      end do
      call text%add(line//"1.4+0.85*x with lines dt 2 lc rgb '#566370' title 'rule (14.15)', "// &
                    "$here with points pt 7 ps 1 lc rgb '#0b57d0' title 'this case'")
      call text%add('set yrange [*:*]')
   end subroutine plot_chart

   !> The chart ends where its last boundaries are known for all e.
   pure real(wp) function top_of_chart(study)
      type(vibration_study_t), intent(in) :: study
      integer :: k, last

      last = ubound(study%chart(1)%exact%high, 1)
      top_of_chart = max(1.0_wp, study%ratio)
      do k = 1, size(study%chart)
         top_of_chart = max(top_of_chart, shown_root(study%chart(k)%exact%high(last)))
      end do
   end function top_of_chart

   subroutine plot_drive(study, text)
      type(drive_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      real(wp) :: turn, half
      integer :: k

      turn = study%turn%sense*full_turn/real(study%waves, wp)
      call plot_turn('inertia at the crank, kg m2', '$inertia', "title 'inertia'", turn, text)
      if (study%hill%unique) call plot_turn('swing of the crank, rad', '$swing', "title 'swing'", turn, text)
      if (.not. any(study%speeds%known)) return
      half = 0.0_wp
      if (size(study%speeds) > 1) half = 0.5_wp*(study%speeds(2)%speed - study%speeds(1)%speed)
      do k = 1, size(study%speeds)
         if (study%speeds(k)%grows) call shade(study%speeds(k)%speed - half, study%speeds(k)%speed + half, text)
      end do
      call plot_speeds('greatest swing of the crank, rad', '$swings', study%speeds%speed, text)
   end subroutine plot_drive

   !> A panel over a turn of the crank, or the period that a turn is made of.
   subroutine plot_turn(label, table, tail, turn, text)
      character(*), intent(in) :: label, table
      character(*), intent(in) :: tail      !! title of the first curve, and further curves
      real(wp), intent(in) :: turn          !! degrees, negative backwards
      type(text_t), intent(inout) :: text

      call text%add('set xlabel "input from the reference position, degrees"; set xtics 30; set xrange ['// &
                    short_number(min(0.0_wp, turn))//':'//short_number(max(0.0_wp, turn))//"]; set ylabel '"//label//"'")
      call text%add('plot '//table//' using 1:2 with lines lw 1.5 '//tail)
   end subroutine plot_turn

   !> A panel over speeds; the bands put down before are taken up again.
   subroutine plot_speeds(label, table, speeds, text)
      character(*), intent(in) :: label, table
      real(wp), intent(in) :: speeds(:)
      type(text_t), intent(inout) :: text

      call text%add('set xlabel "speed, rad/s (shaded: unstable, the curve is not the response)"; set xtics auto; set xrange ['// &
                    full_precision(minval(speeds))//':'//full_precision(maxval(speeds))//']; set logscale y; set ylabel "'// &
                    label//'"')
      call text%add('plot '//table//" using 1:2 with linespoints pt 7 ps 0.4 lw 1.5 title 'periodic'")
      call text%add('unset object; unset logscale y')
   end subroutine plot_speeds

   subroutine shade(from, to, text)
      real(wp), intent(in) :: from, to
      type(text_t), intent(inout) :: text

      call text%add('set object rectangle from first '//full_precision(from)//', graph 0 to first '//full_precision(to)// &
                    ', graph 1 fc rgb "'//colour_unstable//'" fs transparent solid 0.25 noborder behind')
   end subroutine shade
end module psalm_steady_curves
