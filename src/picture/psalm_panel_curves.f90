!> Panels of a scene in the gnuplot script of the curves: further outputs, rates, tolerances.
module psalm_panel_curves
   use psalm_kinds, only: wp, full_turn
   use psalm_markup, only: gnuplot_text, short_number
   use psalm_output_kind, only: motion_angle
   use psalm_panels, only: tolerance_band_t, panel_t, flat
   use psalm_scene, only: scene_t
   use psalm_text, only: text_t, full_precision, number_or_nan, to_text
   implicit none (type, external)
   private
   public :: axis_range, panels_shown, write_panel_table, plot_panels_of, write_band_table, plot_band_panel

   real(wp), parameter :: around = 0.01_wp !! part of the scale that is shown on either side of a constant
   character(1), parameter :: components(2) = ['x', 'y']

contains

   !> How many panels the script gets from here.
   pure integer function panels_shown(scene)
      type(scene_t), intent(in) :: scene
      integer :: i

      panels_shown = count([(is_shown(scene%panels(i)), i=1, size(scene%panels))])
      if (allocated(scene%band)) panels_shown = panels_shown + merge(1, 0, any(scene%band%known))
   end function panels_shown

   !> True if there is a number to draw: gnuplot refuses a panel without one.
   pure logical function is_shown(panel)
      type(panel_t), intent(in) :: panel
      integer :: k

      is_shown = .false.
      do k = 1, size(panel%lines)
         is_shown = is_shown .or. any(panel%lines(k)%known)
      end do
   end function is_shown

   !> The table $panels: input, then every line of every panel.
   subroutine write_panel_table(panels, inputs, text)
      type(panel_t), intent(in) :: panels(:)
      real(wp), intent(in) :: inputs(:)       !! shape (sweep): on the axis of the curves
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: i, p, k

      call text%add('$panels << END')
      do i = 1, size(inputs)
         line = full_precision(inputs(i))
         do p = 1, size(panels)
            do k = 1, size(panels(p)%lines)
               line = line//' '//number_or_nan(panels(p)%lines(k)%values(i), panels(p)%lines(k)%known(i))
            end do
         end do
         call text%add(line)
      end do
      call text%add('END')
   end subroutine write_panel_table

   !> Append the panels.
   subroutine plot_panels_of(panels, text)
      type(panel_t), intent(in) :: panels(:)
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: p, k, column

      column = 1
      do p = 1, size(panels)
         if (is_shown(panels(p))) then
            line = 'set ylabel '//gnuplot_text(trim(panels(p)%name))//'; '// &
                   axis_range(known_values(panels(p)), panels(p)%scale)//'plot '
            do k = 1, size(panels(p)%lines)
               if (k > 1) line = line//', '
               line = line//'$panels using 1:'//to_text(column + k)//' with lines lw 1.5 '
               if (len_trim(panels(p)%lines(k)%label) > 0) then
                  line = line//'title '//gnuplot_text(trim(panels(p)%lines(k)%label))
               else
                  line = line//'notitle'
               end if
            end do
            ! the key has room for the speed, the axis has not
            if (len_trim(panels(p)%note) > 0) &
               line = 'set key title '//gnuplot_text(trim(panels(p)%note))//'; '//line//'; set key title'
            call text%add(line)
         end if
         column = column + size(panels(p)%lines)
      end do
      if (size(panels) > 0) call text%add('set yrange [*:*]')
   end subroutine plot_panels_of

   !> Range of an axis for some values: an axis does not magnify the rounding of a constant.
   pure function axis_range(values, scale) result(command)
      real(wp), intent(in) :: values(:)
      real(wp), intent(in) :: scale           !! changes below `flat` times it are rounding
      character(:), allocatable :: command
      real(wp) :: low, high, middle

      command = 'set yrange [*:*]; '
      if (size(values) == 0) return
      low = minval(values)
      high = maxval(values)
      if (high - low >= flat*scale) return
      middle = 0.5_wp*(low + high)
      if (abs(middle) < flat*scale) middle = 0.0_wp
      command = 'set yrange ['//short_number(middle - around*scale)//':'//short_number(middle + around*scale)//']; '
   end function axis_range

   !> All values of a panel that are known.
   pure function known_values(panel) result(values)
      type(panel_t), intent(in) :: panel
      real(wp), allocatable :: values(:)
      integer :: k

      allocate (values(0))
      do k = 1, size(panel%lines)
         values = [values, pack(panel%lines(k)%values, panel%lines(k)%known)]
      end do
   end function known_values

   !> The table $band: input, then for each component lower and upper end of the root-sum-square and of the worst case.
   subroutine write_band_table(scene, inputs, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: inputs(:)       !! shape (sweep): on the axis of the curves
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      real(wp) :: value, before
      integer :: i, c

      call text%add('$band << END')
      call text%add('# input, by component: actual -+ root-sum-square, actual -+ worst case; then the deviations themselves')
      before = 0.0_wp
      if (scene%desired .and. scene%motion == motion_angle) before = scene%prescribed%actual(1)
      do i = 1, size(inputs)
         line = full_precision(inputs(i))
         do c = 1, min(2, scene%band%components)
            value = scene%sweep%actual(i)
            if (c == 2) value = scene%sweep%actual_y(i)
            if (scene%motion == motion_angle) then
               ! an angle goes on from the one before it, as that of the curve
               value = value + full_turn*anint((before - value)/full_turn)
               if (scene%sweep%closed(i)) before = value
            end if
            line = line//' '//number_or_nan(value - scene%band%square(i, c), scene%band%known(i))//' '// &
                   number_or_nan(value + scene%band%square(i, c), scene%band%known(i))//' '// &
                   number_or_nan(value - scene%band%worst(i, c), scene%band%known(i))//' '// &
                   number_or_nan(value + scene%band%worst(i, c), scene%band%known(i))
         end do
         do c = 1, min(2, scene%band%components)
            line = line//' '//number_or_nan(scene%band%square(i, c), scene%band%known(i))//' '// &
                   number_or_nan(scene%band%worst(i, c), scene%band%known(i))
         end do
         call text%add(line)
      end do
      call text%add('END')
   end subroutine write_band_table

   !> Append the panel of the deviations: bands are often too narrow to be seen on the curve.
   subroutine plot_band_panel(band, text)
      type(tolerance_band_t), intent(in) :: band
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line, label
      integer :: c, shown, first

      if (.not. any(band%known)) return
      shown = min(2, band%components)
      line = "set ylabel 'deviation, tolerances'; set yrange [0:*]; plot "
      do c = 1, shown
         if (c > 1) line = line//', '
         label = ''
         if (shown > 1) label = components(c)//' '
         first = 4*shown + 2*c
         line = line//'$band using 1:'//to_text(first)//' with lines lw 1.5 lc '//to_text(c)//" title '"//label// &
                "RSS', $band using 1:"//to_text(first + 1)//' with lines dt 2 lc '//to_text(c)//" title '"//label// &
                "worst'"
      end do
      call text%add(line//'; set yrange [*:*]')
   end subroutine plot_band_panel
end module psalm_panel_curves
