!> A joint with clearance as SVG: load and force of contact over the turn, the lag, and the standard charts - where contact is
!> lost over H1 (the radius) and H2 (the angle) for each H3, and how hard the first impact is - with the minima of the case.
module psalm_clearance_svg
   use psalm_clearance_study, only: clearance_study_t, verdict_kept
   use psalm_flypast_chart, only: chart_t
   use psalm_kinds, only: wp, pi, full_turn, radians_per_degree
   use psalm_markup, only: short_number
   use psalm_svg_panel, only: plot_panel_t, begin_picture, draw_axes, draw_curve, px, round_step
   use psalm_svg_theme, only: style_of_areas
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_clearance_svg

   real(wp), parameter :: width = 900.0_wp, margin = 70.0_wp, header = 60.0_wp !! sizes, pixels
   real(wp), parameter :: panel_height = 180.0_wp, gap = 50.0_wp    !! height of the curves, and between them
   real(wp), parameter :: chart_height = 470.0_wp, chart_radius = 180.0_wp
   real(wp), parameter :: footer = 40.0_wp, head_room = 1.15_wp
   real(wp), parameter :: classes(*) = [0.05_wp, 0.1_wp, 0.2_wp, 0.4_wp, 0.8_wp] !! upper ends of the indices of one colour
   real(wp), parameter :: tick = 60.0_wp                     !! degrees between marks of the input

contains

   !> Append the picture of a case that was studied: the minima of the load are known.
   subroutine write_clearance_svg(title, study, text)
      character(*), intent(in) :: title
      type(clearance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      real(wp) :: height, top
      integer :: k, charts

      charts = 0
      if (allocated(study%chart%h3)) charts = size(study%chart%h3)
      height = header + 2.0_wp*(panel_height + gap) + gap + real(charts, wp)*chart_height + footer
      call begin_picture(title, width, height, own_style(), text)
      top = header + 0.6_wp*gap
      call draw_forces(study, top, text)
      call draw_lag(study, top + panel_height + gap, text)
      do k = 1, charts
         top = header + 2.0_wp*(panel_height + gap) + gap + real(k - 1, wp)*chart_height
         call draw_losses(study, k, top, text)
         call draw_indices(study%chart, k, top, text)
      end do
      call text%add('</svg>')
   end subroutine write_clearance_svg

   !> What this picture has besides the style of all.
   pure function own_style() result(style)
      character(:), allocatable :: style
      character(*), parameter :: lights(*) = [character(7) :: '#fde7b0', '#fcc46c', '#f59e3f', '#e2701f', '#bd4312', '#7c2310']
      character(*), parameter :: darks(*) = [character(7) :: '#4a3413', '#714711', '#9c5d12', '#c9741a', '#ee9138', '#ffc480']

      style = '.contact{stroke:$actual;stroke-width:1.4}.after{stroke-width:1;stroke-dasharray:4 3}'// &
              '.loss{stroke:none;fill:$actual}.passage{stroke:none;fill:$bad;fill-opacity:.75}'// &
              '.terminal{stroke:none;fill:$bad;fill-opacity:.3}.ring{stroke:$ghost;stroke-width:.7}'// &
              '.here{fill:$accent;stroke:$paper;stroke-width:1.5}'
      style = style//style_of_areas('i', lights, darks)
   end function own_style

   ! ---- curves over the turn ----------------------------------------------------------------------------------------

   !> Load without clearance and force of contact.
   subroutine draw_forces(study, top, text)
      type(clearance_study_t), intent(in) :: study
      real(wp), intent(in) :: top
      type(text_t), intent(inout) :: text
      type(plot_panel_t) :: panel
      real(wp) :: low, high
      integer :: k

      low = min(0.0_wp, minval(study%cycle%amount))
      high = max(0.0_wp, maxval(study%cycle%amount))
      ! after a loss the force of an unbroken contact may swing to any height
      if (study%followed) low = min(low, max(-0.5_wp*high, minval(study%force)))
      if (study%followed) high = min(head_room*high, max(high, maxval(study%force)))
      panel = panel_of(study, low, high, top)
      call draw_axes(panel, 'load without clearance (blue) and force of contact (red; dashed after its first loss), N', &
                     sign(tick, study%crank%sense), text)
      call draw_curve(panel, 'curve', in_turn(study%cycle%input), study%cycle%amount, text)
      call draw_followed(study, study%force, panel, text)
      do k = 1, size(study%minima)
         if (study%minima(k)%verdict == verdict_kept) cycle
         call text%add('<circle class="loss" data-input="'//short_number(study%minima(k)%input)//'" cx="'// &
                       px(panel%x_of(in_turn(study%minima(k)%input)))//'" cy="'//px(panel%y_of(study%minima(k)%load))//'" r="4"/>')
      end do
   end subroutine draw_forces

   subroutine draw_lag(study, top, text)
      type(clearance_study_t), intent(in) :: study
      real(wp), intent(in) :: top
      type(text_t), intent(inout) :: text
      type(plot_panel_t) :: panel
      real(wp) :: low, high

      low = 0.0_wp
      high = 0.0_wp
      if (study%followed) low = min(low, minval(study%lag))
      if (study%followed) high = max(high, maxval(study%lag))
      panel = panel_of(study, low, high, top)
      call draw_axes(panel, 'lag of the pin behind the load, degrees', sign(tick, study%crank%sense), text, &
                     'input from the reference position, degrees')
      call draw_followed(study, study%lag, panel, text)
   end subroutine draw_lag

   !> What is followed, after the first loss in another line.
   subroutine draw_followed(study, values, panel, text)
      type(clearance_study_t), intent(in) :: study
      real(wp), intent(in) :: values(:)
      type(plot_panel_t), intent(in) :: panel
      type(text_t), intent(inout) :: text
      integer :: last

      if (.not. study%followed) return
      last = size(values)
      if (study%loses) last = count(abs(study%input) <= abs(study%loss))
      call draw_curve(panel, 'contact', in_turn(study%input(:last)), values(:last), text)
      if (last < size(values)) call draw_curve(panel, 'contact after', in_turn(study%input(last:)), values(last:), text)
   end subroutine draw_followed

   !> A panel over the turn: inputs run to the right in the sense of the crank's turning.
   pure type(plot_panel_t) function panel_of(study, low, high, top)
      type(clearance_study_t), intent(in) :: study
      real(wp), intent(in) :: low, high, top

      panel_of = plot_panel_t(margin, top, width - 2.0_wp*margin, panel_height, 0.0_wp, &
                              sign(full_turn, study%crank%sense), low, high)
   end function panel_of

   !> An input within the turn, of its sign.
   elemental real(wp) function in_turn(input)
      real(wp), intent(in) :: input               !! degrees

      in_turn = input
      if (abs(input) > full_turn) in_turn = sign(modulo(abs(input), full_turn), input)
   end function in_turn

   ! ---- charts ------------------------------------------------------------------------------------------------------

   !> Where contact is lost: on every radial line the ranges between their borders, in two colours.
   subroutine draw_losses(study, k, top, text)
      type(clearance_study_t), intent(in) :: study
      integer, intent(in) :: k
      real(wp), intent(in) :: top
      type(text_t), intent(inout) :: text
      real(wp) :: low, high, x, y, reach
      integer :: i, j, r, first

      x = margin + chart_radius
      y = top + 50.0_wp + chart_radius
      reach = reach_of(study%chart, k)
      associate (chart => study%chart)
         call text%add('<text x="'//px(margin)//'" y="'//px(top + 20.0_wp)//'">contact lost, H3 = '//px(chart%h3(k))//'</text>')
         call text%add('<g data-chart="losses" data-h3="'//px(chart%h3(k))//'">')
         do i = 1, size(chart%h2)
            do r = 1, size(chart%lines(i, k)%ranges)
               associate (range => chart%lines(i, k)%ranges(r))
                  ! within a range passages and terminal losses by what was found at the steps of H1
                  low = range%from
                  if (low <= chart%h1(1)) low = 0.0_wp
                  first = 0
                  do j = 1, size(chart%h1)
                     if (chart%lost(j, i, k) == 0 .or. chart%h1(j) < range%from .or. chart%h1(j) > range%to) cycle
                     if (first > 0 .and. ((chart%lost(j, i, k) == 1) .neqv. (first == 1))) then
                        high = chart%h1(j) - 0.5_wp*chart%h1(1)
                        call sector(class_of(first), low, high, i)
                        low = high
                     end if
                     first = chart%lost(j, i, k)
                  end do
                  if (first == 0) first = range%minimum
                  call sector(class_of(first), low, range%to, i)
               end associate
            end do
         end do
         call text%add('</g>')
         call draw_rings(reach, x, y, text)
         do i = 1, size(study%minima)
            associate (m => study%minima(i))
               if (minloc(abs(chart%h3 - m%h3), dim=1) /= k .or. m%h1 > reach) cycle
               call text%add('<circle class="here" data-h1="'//short_number(m%h1)//'" data-h2="'//short_number(m%h2)// &
                             '" cx="'//px(x + scaled(reach, m%h1)*cos(radians_per_degree*m%h2))//'" cy="'// &
                             px(y - scaled(reach, m%h1)*sin(radians_per_degree*m%h2))//'" r="5"><title>input '//px(m%input)// &
                             ': H1 '//px(m%h1)//', H2 '//px(m%h2)//', H3 '//px(m%h3)//'</title></circle>')
            end associate
         end do
         call text%add('<path class="passage" d="M'//px(margin)//' '//px(top + 28.0_wp)//'h14v10h-14Z"/><text class="small" x="'// &
                       px(margin + 20.0_wp)//'" y="'//px(top + 38.0_wp)//'">in the passage</text><path class="terminal" d="M'// &
                       px(margin + 120.0_wp)//' '//px(top + 28.0_wp)//'h14v10h-14Z"/><text class="small" x="'// &
                       px(margin + 140.0_wp)//'" y="'//px(top + 38.0_wp)//'">terminal</text>')
         call text%add('<circle class="here" cx="'//px(margin + 218.0_wp)//'" cy="'//px(top + 33.0_wp)// &
                       '" r="5"/><text class="small" x="'//px(margin + 230.0_wp)//'" y="'//px(top + 38.0_wp)// &
                       '">minima of this case</text>')
      end associate

   contains

      subroutine sector(class, from, to, line)
         character(*), intent(in) :: class
         real(wp), intent(in) :: from, to          !! H1
         integer, intent(in) :: line

         call text%add(sector_of(study%chart, reach, class, from, to, line, x, y))
      end subroutine sector
   end subroutine draw_losses

   pure function class_of(minimum) result(name)
      integer, intent(in) :: minimum
      character(:), allocatable :: name

      name = 'terminal'
      if (minimum == 1) name = 'passage'
   end function class_of

   !> How hard the first impact is.
   subroutine draw_indices(chart, k, top, text)
      type(chart_t), intent(in) :: chart
      integer, intent(in) :: k
      real(wp), intent(in) :: top
      type(text_t), intent(inout) :: text
      real(wp) :: x, y, left, step, low, reach
      integer :: i, j, first, step_of

      left = 0.5_wp*width + 0.5_wp*margin
      x = left + chart_radius
      y = top + 50.0_wp + chart_radius
      step = chart%h1(1)
      reach = reach_of(chart, k)
      call text%add('<text x="'//px(left)//'" y="'//px(top + 20.0_wp)//'">index of the first impulse, H3 = '// &
                    px(chart%h3(k))//'</text>')
      call text%add('<g data-chart="index" data-h3="'//px(chart%h3(k))//'">')
      do i = 1, size(chart%h2)
         first = 0
         low = 0.0_wp
         do j = 1, size(chart%h1) + 1
            step_of = 0
            if (j <= size(chart%h1)) then
               if (chart%lost(j, i, k) > 0) step_of = 1 + count(chart%index(j, i, k) > classes)
            end if
            if (step_of == first) cycle
            if (first > 0) call text%add(sector_of(chart, reach, 'i'//to_text(first), low, step*(real(j, wp) - 0.5_wp), i, x, y))
            first = step_of
            if (j <= size(chart%h1)) low = merge(0.0_wp, chart%h1(j) - 0.5_wp*step, j == 1)
         end do
      end do
      call text%add('</g>')
      call draw_rings(reach, x, y, text)
      do i = 1, size(classes) + 1
         call text%add('<path class="i'//to_text(i)//'" d="M'//px(left + 62.0_wp*real(i - 1, wp))//' '//px(top + 28.0_wp)// &
                       'h14v10h-14Z"/><text class="small" x="'//px(left + 62.0_wp*real(i - 1, wp) + 18.0_wp)//'" y="'// &
                       px(top + 38.0_wp)//'">'//legend(i)//'</text>')
      end do

   contains

      function legend(i) result(words)
         integer, intent(in) :: i
         character(:), allocatable :: words

         if (i <= size(classes)) then
            words = 'to '//px(classes(i))
         else
            words = 'above'
         end if
      end function legend
   end subroutine draw_indices

   !> Rings of H1 with their numbers, lines of H2 each 30 degrees.
   subroutine draw_rings(reach, x, y, text)
      real(wp), intent(in) :: reach, x, y
      type(text_t), intent(inout) :: text
      real(wp), parameter :: apart = 30.0_wp, beyond = 14.0_wp
      real(wp) :: step, c, s
      integer :: k

      step = round_step(reach/5.0_wp)
      do k = 1, floor(reach/step*(1.0_wp + epsilon(1.0_wp)*8.0_wp))
         call text%add('<circle class="ring" cx="'//px(x)//'" cy="'//px(y)//'" r="'//px(scaled(reach, step*real(k, wp)))// &
                       '"/><text class="small" x="'//px(x + 3.0_wp)//'" y="'//px(y - scaled(reach, step*real(k, wp)) - 2.0_wp)// &
                       '">'//px(step*real(k, wp))//'</text>')
      end do
      do k = 0, nint(full_turn/apart) - 1
         c = cos(radians_per_degree*apart*real(k, wp))
         s = sin(radians_per_degree*apart*real(k, wp))
         call text%add('<path class="ring" d="M'//px(x)//' '//px(y)//'l'//px(chart_radius*c)//' '//px(-chart_radius*s)//'"/>')
         if (modulo(k, 3) == 1 .or. modulo(k, 3) == 2 .or. k == 3) cycle
         call text%add('<text class="small middle" x="'//px(x + (chart_radius + beyond)*c)//'" y="'// &
                       px(y - (chart_radius + beyond)*s + 4.0_wp)//'">'// &
                       px(apart*real(merge(k, k - 12, k <= 6), wp))//'</text>')
      end do
      call text%add('<text class="small middle" x="'//px(x)//'" y="'//px(y + chart_radius + 30.0_wp)// &
                    '">radius H1, angle H2 in degrees</text>')
   end subroutine draw_rings

   !> H1 of the outer ring: all losses lie within.
   pure real(wp) function reach_of(chart, k) result(reach)
      type(chart_t), intent(in) :: chart
      integer, intent(in) :: k
      real(wp), parameter :: step = 0.5_wp
      integer :: j

      reach = step
      do j = 1, size(chart%h1)
         if (any(chart%lost(j, :, k) > 0)) reach = step*real(ceiling((chart%h1(j) + 0.5_wp*chart%h1(1))/step), wp)
      end do
   end function reach_of

   pure real(wp) function scaled(reach, h1)
      real(wp), intent(in) :: reach, h1          !! reach is H1 of the outer ring

      scaled = chart_radius*h1/reach
   end function scaled

   !> The part of a ring that a radial line stands for.
   pure function sector_of(chart, reach, class, from, to, line, x, y) result(element)
      type(chart_t), intent(in) :: chart
      character(*), intent(in) :: class
      real(wp), intent(in) :: reach, from, to          !! H1
      integer, intent(in) :: line
      real(wp), intent(in) :: x, y                     !! centre
      character(:), allocatable :: element
      real(wp) :: half, a(2), inner, outer

      half = pi/real(size(chart%h2), wp)
      a = chart%h2(line) + [-half, half]
      inner = scaled(reach, from)
      outer = scaled(reach, min(to, reach))
      element = '<path class="'//class//'" d="M'//at(inner, a(1))//'L'//at(outer, a(1))//'A'//px(outer)//' '//px(outer)// &
                ' 0 0 0 '//at(outer, a(2))//'L'//at(inner, a(2))
      if (inner > 0.0_wp) element = element//'A'//px(inner)//' '//px(inner)//' 0 0 1 '//at(inner, a(1))
      element = element//'Z"/>'

   contains

      pure function at(radius, angle) result(place)
         real(wp), intent(in) :: radius, angle
         character(:), allocatable :: place

         place = px(x + radius*cos(angle))//' '//px(y - radius*sin(angle))
      end function at
   end function sector_of
end module psalm_clearance_svg
