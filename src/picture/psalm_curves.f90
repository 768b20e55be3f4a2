!> Curves of a scene as a gnuplot script that carries its data: output, error, transmission angles, convergence.
module psalm_curves
   use psalm_chain_curves, only: chain_panels, plot_chain_panels, write_chain_tables
   use psalm_dyad_kind, only: assur_rrr
   use psalm_force_curves, only: write_force_table, plot_force_panels, force_panels
   use psalm_kinds, only: wp, full_turn
   use psalm_markup, only: clean_text, gnuplot_text, short_number
   use psalm_number, only: parse_real
   use psalm_output_kind, only: motion_point, motion_angle, motion_distance
   use psalm_panel_curves, only: axis_range, panels_shown, plot_band_panel, plot_panels_of, write_band_table, write_panel_table
   use psalm_scene, only: scene_t
   use psalm_source, only: line_t
   use psalm_text, only: text_t, full_precision, number_or_nan, to_text
   use psalm_trace, only: position_row_t
   implicit none (type, external)
   private
   public :: write_curves

   integer, parameter :: panel_height = 330 !! pixels
   integer, parameter :: most_lines = 12    !! transmission angles named one by one
   real(wp), parameter :: part_of_turn = 300.0_wp !! prescribed over less than this, degrees, the axis shows that part only
   character(*), parameter :: colour_open = '#d3302f' !! of bands where the linkage does not close

contains

   !> Append a script that makes `name`.png and `name`.pdf in the directory it is run in.
   subroutine write_curves(scene, name, progress, text)
      type(scene_t), intent(in) :: scene
      character(*), intent(in) :: name         !! of the case, without directory
      type(line_t), intent(in) :: progress(:)  !! device 1, empty if there is none
      type(text_t), intent(inout) :: text
      integer :: panels, steps, pass, i
      logical :: errors, angles, starts
      real(wp) :: low, high

      call text%add('# '//clean_text(trim(scene%title)))
      call write_table('$prescribed', scene, scene%prescribed, text)
      call write_table('$sweep', scene, scene%sweep, text)
      if (allocated(scene%forces)) call write_force_table(scene%forces, [(along(scene, scene%sweep, i), i=1, scene%sweep%n)], text)
      if (allocated(scene%curves)) call write_chain_tables(scene, [(along(scene, scene%prescribed, i), i=1, scene%prescribed%n)], &
                                                           [(along(scene, scene%sweep, i), i=1, scene%sweep%n)], text)
      if (size(scene%panels) > 0) call write_panel_table(scene%panels, [(along(scene, scene%sweep, i), i=1, scene%sweep%n)], text)
      if (allocated(scene%band)) call write_band_table(scene, [(along(scene, scene%sweep, i), i=1, scene%sweep%n)], text)
      call write_progress(progress, steps, starts, text)
      errors = scene%desired
      angles = any(scene%pairs%joint_type == assur_rrr)
      panels = 1 + count([scene%motion == motion_point, errors, angles, steps > 0])
      if (allocated(scene%forces)) panels = panels + force_panels
      if (allocated(scene%curves)) panels = chain_panels(scene) + count([steps > 0])
      panels = panels + panels_shown(scene)
      call text%add('set grid; set key outside right top; set lmargin 11; set rmargin 17')
      call find_axis(scene, low, high)
      call input_axis(scene, low, high, text)
      do pass = 1, 2
         if (pass == 1) then
            call text%add('set terminal pngcairo noenhanced size 1000,'//to_text(panels*panel_height + 40)//' font "sans,10"')
            call text%add('set output '//gnuplot_text(name//'.png'))
         else
            call text%add('set terminal pdfcairo noenhanced size 21cm,'//short_number(7.0_wp*real(panels, wp) + 0.8_wp)// &
                          'cm font "sans,9"')
            call text%add('set output '//gnuplot_text(name//'.pdf'))
         end if
         call text%add('set multiplot layout '//to_text(panels)//',1 title '//gnuplot_text(trim(scene%title)))
         call add_bands(scene, low, high, text)
         call plot_panels(scene, errors, angles, steps, starts, low, high, text)
         call text%add('unset multiplot')
         call text%add('unset output')
      end do
   end subroutine write_curves

   !> Range of the inputs that is shown: what is prescribed, if that is a part of a turn only, else the whole turn.
   pure subroutine find_axis(scene, low, high)
      type(scene_t), intent(in) :: scene
      real(wp), intent(out) :: low, high
      real(wp) :: ends(2)
      integer :: i

      if (scene%sliding) then
         low = minval(scene%sweep%input)
         high = maxval(scene%sweep%input)
         return
      end if
      ends = scene%sweep%input(1)
      do i = 1, scene%prescribed%n
         associate (place => along(scene, scene%prescribed, i))
            ends = [min(ends(1), place), max(ends(2), place)]
         end associate
      end do
      low = ends(1)
      high = ends(2)
      if (scene%prescribed%n > 1 .and. high - low < part_of_turn .and. high > low) return
      low = scene%sweep%input(1) + min(0.0_wp, scene%sense*full_turn)
      high = low + full_turn
   end subroutine find_axis

   !> The same axis for all panels.
   subroutine input_axis(scene, low, high, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: low, high
      type(text_t), intent(inout) :: text

      call text%add('set xlabel '//gnuplot_text(input_name(scene)))
      if (.not. scene%sliding .and. high - low >= part_of_turn) call text%add('set xtics 30')
      if (high > low) call text%add('set xrange ['//short_number(low)//':'//short_number(high)//']')
   end subroutine input_axis

   !> Red bands where the linkage does not close.
   subroutine add_bands(scene, low, high, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: low, high
      type(text_t), intent(inout) :: text
      real(wp) :: half, from, to
      integer :: i, k

      associate (row => scene%sweep)
         if (row%n < 2) return
         half = 0.5_wp*abs(row%delt(2) - row%delt(1))
         i = 1
         do while (i <= row%n)
            k = i
            do while (k <= row%n)
               if (row%closed(k) .neqv. row%closed(i)) exit
               k = k + 1
            end do
            if (.not. row%closed(i)) then
               from = max(low, min(along(scene, row, i), along(scene, row, k - 1)) - half)
               to = min(high, max(along(scene, row, i), along(scene, row, k - 1)) + half)
               if (to > from) call text%add('set object rectangle from first '//short_number(from)//', graph 0 to first '// &
                                            short_number(to)//', graph 1 fc rgb "'//colour_open// &
                                            '" fs transparent solid 0.13 noborder behind')
            end if
            i = k
         end do
      end associate
   end subroutine add_bands

   !> Input along the sweep (degrees go on beyond a turn), actual, desired, errors, transmission angles.
   subroutine write_table(name, scene, row, text)
      character(*), intent(in) :: name
      type(scene_t), intent(in) :: scene
      type(position_row_t), intent(in) :: row
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      real(wp) :: value, before
      integer :: i, loop

      call text%add(name//' << END')
      call text%add('# input actual actual_y desired desired_y error error_y, then the transmission angle of each link pair')
      before = 0.0_wp
      do i = 1, row%n
         value = row%actual(i)
         if (scene%motion == motion_angle) then
            ! an angle goes on from the one before it
            if (scene%desired .and. size(row%wanted) == 0 .and. i == 1) before = scene%prescribed%actual(1)
            if (size(row%wanted) == 0) value = value + full_turn*anint((before - value)/full_turn)
            if (row%closed(i)) before = value
         end if
         line = full_precision(along(scene, row, i))//' '//number_or_nan(value, row%closed(i))//' '// &
                number_or_nan(row%actual_y(i), row%closed(i) .and. scene%motion == motion_point)
         if (size(row%wanted) > 0) then
            line = line//' '//full_precision(row%wanted(i))
            if (scene%motion == motion_point) then
               line = line//' '//full_precision(row%wanted_y(i))
            else
               line = line//' NaN'
            end if
            line = line//' '//number_or_nan(row%error(i), row%closed(i))//' '//number_or_nan(row%error_y(i), row%closed(i))
         else
            line = line//' NaN NaN NaN NaN'
         end if
         do loop = 1, scene%loops
            if (scene%pairs(loop)%joint_type == assur_rrr) line = line//' '//number_or_nan(row%angle(loop, i), row%sound(loop, i))
         end do
         call text%add(line)
      end do
      call text%add('END')
   end subroutine write_table

   !> Input of a position on the axis of the sweep.
   pure real(wp) function along(scene, row, i)
      type(scene_t), intent(in) :: scene
      type(position_row_t), intent(in) :: row
      integer, intent(in) :: i

      along = row%input(i)
      if (scene%sliding) return
      associate (start => scene%sweep%input(1))
         along = start + scene%sense*modulo(scene%sense*(row%delt(i) - scene%sweep%delt(1)), full_turn)
      end associate
   end function along

   !> Best and worst objective by iteration, or objective of each start and the best so far, from device 1.
   subroutine write_progress(progress, steps, starts, text)
      type(line_t), intent(in) :: progress(:)
      integer, intent(out) :: steps      !! lines found
      logical, intent(out) :: starts     !! they are starts, not iterations
      type(text_t), intent(inout) :: text
      character(:), allocatable :: reason
      real(wp) :: at, best, worst, least
      logical :: valid
      integer :: i

      steps = 0
      starts = .false.
      least = huge(least)
      call text%add('$progress << END')
      do i = 1, size(progress)
         associate (line => progress(i)%text)
            if (index(line, ' ITERATION ') == 1) then
               call value_after(line, ' ITERATION', at, valid)
               if (valid) call value_after(line, ' BEST', best, valid)
               if (valid) call value_after(line, ' WORST', worst, valid)
            else if (index(line, ' START ') == 1) then
               call value_after(line, ' START', at, valid)
               if (valid) call value_after(line, ' OBJECTIVE', worst, valid)
               if (valid) then
                  starts = .true.
                  least = min(least, worst)
                  best = least
               end if
            else
               valid = .false.
            end if
            if (.not. valid) cycle
            steps = steps + 1
            call text%add(short_number(at)//' '//full_precision(best)//' '//full_precision(worst))
         end associate
      end do
      call text%add('END')

   contains

      subroutine value_after(line, word, value, valid)
         character(*), intent(in) :: line, word
         real(wp), intent(out) :: value
         logical, intent(out) :: valid
         integer :: first, last

         value = 0.0_wp
         valid = index(line, word//' ') > 0
         if (.not. valid) return
         first = index(line, word//' ') + len(word)
         first = first + verify(line(first:)//'x', ' ') - 1
         last = first + scan(line(first:)//' ', ' ') - 2
         call parse_real(line(first:last), value, valid, reason)
      end subroutine value_after
   end subroutine write_progress

   subroutine plot_panels(scene, errors, angles, steps, starts, low, high, text)
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: errors, angles
      integer, intent(in) :: steps
      logical, intent(in) :: starts
      real(wp), intent(in) :: low, high       !! of the inputs shown
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: loop, column, i
      logical :: seen

      ! gnuplot refuses a panel without a single number
      seen = any(scene%prescribed%closed)
      do i = 1, scene%sweep%n
         associate (place => along(scene, scene%sweep, i))
            seen = seen .or. (scene%sweep%closed(i) .and. place >= low .and. place <= high)
         end associate
      end do
      if (.not. seen) call text%add("set label 1 'the linkage does not close' at graph 0.5,0.5 center front")

      if (allocated(scene%curves)) then
         call plot_chain_panels(scene, text)
      else if (scene%motion == motion_point) then
         call output_panel('x of '//called(scene), 2, 4, scene%sweep%actual, scene%prescribed%actual, scene%prescribed%wanted)
         call output_panel('y of '//called(scene), 3, 5, scene%sweep%actual_y, scene%prescribed%actual_y, &
                           scene%prescribed%wanted_y)
      else
         call output_panel(output_name(scene), 2, 4, scene%sweep%actual, scene%prescribed%actual, scene%prescribed%wanted)
      end if
      if (errors) then
         line = 'set ylabel "error: desired - actual"; '//error_range()// &
                'plot $prescribed using 1:6 with linespoints pt 7 ps 0.6 title '
         if (scene%motion == motion_point) then
            call text%add(line//"'x', '' using 1:7 with linespoints pt 5 ps 0.6 title 'y'")
         else
            call text%add(line//"'error'")
         end if
      end if
      if (angles) then
         line = 'set ylabel "transmission angle, degrees"; set yrange [0:180]; plot '
         column = 7
         do loop = 1, scene%loops
            if (scene%pairs(loop)%joint_type /= assur_rrr) cycle
            column = column + 1
            line = line//"$sweep using 1:"//to_text(column)//" with lines "
            if (column - 7 <= most_lines) then
               line = line//"title 'loop "//to_text(loop)//"', "
            else
               line = line//'notitle, '
            end if
         end do
         call text%add(line//short_number(90.0_wp - scene%tangle)//" dt 2 lc 'red' title 'limits', "// &
                       short_number(90.0_wp + scene%tangle)//" dt 2 lc 'red' notitle; set yrange [*:*]")
      end if
      call text%add('set yrange [*:*]; unset label 1')
      if (allocated(scene%band)) call plot_band_panel(scene%band, text)
      call plot_panels_of(scene%panels, text)
      if (allocated(scene%forces)) call plot_force_panels(scene%forces, text)
      if (steps == 0) return
      call text%add('unset object; set xtics auto; set xrange [*:*]; set logscale y; set format y "%g"; set ylabel "objective"')
      if (starts) then
         call text%add('set xlabel "start"; '// &
                       "plot $progress using 1:3 with points pt 7 ps 0.4 title 'start', "// &
                       "'' using 1:2 with steps lw 1.5 title 'best'")
      else
         call text%add('set xlabel "iteration"; '// &
                       "plot $progress using 1:3 with linespoints pt 7 ps 0.4 title 'worst', '' using 1:2 with linespoints "// &
                       "pt 7 ps 0.4 title 'best'")
      end if
      call text%add('unset logscale y; set format y')
      call input_axis(scene, low, high, text)

   contains

      subroutine output_panel(name, actual, desired, swept, found, wanted)
         character(*), intent(in) :: name
         integer, intent(in) :: actual, desired           !! columns
         real(wp), intent(in) :: swept(:), found(:), wanted(:) !! what is plotted: actual values, desired ones
         character(:), allocatable :: plot

         plot = 'set ylabel '//gnuplot_text(name)//'; '//y_range(seen .or. scene%desired, &
            [pack(swept, scene%sweep%closed), pack(found, scene%prescribed%closed), wanted])// &
                'plot '//band_of(actual - 1)//'$sweep using 1:'//to_text(actual)// &
                " with lines lw 1.5 lc 1 title 'actual', $prescribed using 1:"//to_text(actual)// &
                " with points pt 7 ps 0.5 lc 1 notitle"
         if (scene%desired) plot = plot//', $prescribed using 1:'//to_text(desired)//" with points pt 6 lc 2 title 'desired'"
         call text%add(plot)
      end subroutine output_panel

      !> The band of a component of the output, below its curve.
      pure function band_of(component) result(command)
         integer, intent(in) :: component
         character(:), allocatable :: command

         command = ''
         if (.not. allocated(scene%band)) return
         if (.not. any(scene%band%known)) return
         command = '$band using 1:'//to_text(4*component - 2)//':'//to_text(4*component - 1)// &
                   " with filledcurves fc rgb '#8ab4f8' fs transparent solid 0.5 notitle, $band using 1:"// &
                   to_text(4*component)//" with lines dt 3 lc rgb '#566370' notitle, $band using 1:"// &
                   to_text(4*component + 1)//" with lines dt 3 lc rgb '#566370' notitle, "
      end function band_of

      pure function error_range() result(command)
         character(:), allocatable :: command

         associate (row => scene%prescribed)
            if (scene%motion == motion_point) then
               command = y_range(any(row%closed), [pack(row%error, row%closed), pack(row%error_y, row%closed), 0.0_wp])
            else
               command = y_range(any(row%closed), [pack(row%error, row%closed), 0.0_wp])
            end if
         end associate
      end function error_range

      !> An axis does not magnify the rounding of a constant.
      pure function y_range(numbers, values) result(command)
         logical, intent(in) :: numbers     !! there is something to scale the axis by
         real(wp), intent(in) :: values(:)
         character(:), allocatable :: command
         real(wp) :: scale, turned(size(values))

         command = 'set yrange [0:1]; '
         if (.not. numbers) return
         command = axis_range(values, 0.0_wp)
         if (size(values) == 0) return
         scale = maxval(scene%high - scene%low)
         turned = values
         if (scene%motion == motion_angle) then
            scale = full_turn
            turned = values - full_turn*anint((values - values(1))/full_turn)
         end if
         command = axis_range(turned, scale)
      end function y_range
   end subroutine plot_panels

   !> What the output point is called.
   pure function called(scene) result(name)
      type(scene_t), intent(in) :: scene
      character(:), allocatable :: name

      name = 'the output point'
      if (allocated(scene%output_label)) name = scene%output_label
   end function called

   pure function output_name(scene) result(name)
      type(scene_t), intent(in) :: scene
      character(:), allocatable :: name

      if (allocated(scene%output_label)) then
         name = scene%output_label
         if (scene%motion == motion_angle) name = name//', degrees'
         return
      end if
      select case (scene%motion)
      case (motion_angle)
         name = 'angle, degrees'
      case (motion_distance)
         name = 'distance'
      case default
         name = 'length of the slide'
      end select
   end function output_name

   pure function input_name(scene) result(name)
      type(scene_t), intent(in) :: scene
      character(:), allocatable :: name

      if (allocated(scene%input_label)) then
         name = scene%input_label
         return
      end if
      name = trim(merge('input length         ', 'crank angle, degrees ', scene%sliding))
   end function input_name
end module psalm_curves
