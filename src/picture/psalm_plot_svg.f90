!> Plots as one SVG, one below the other.
module psalm_plot_svg
   use psalm_kinds, only: wp
   use psalm_markup, only: xml_text
   use psalm_plot, only: plot_t, plot_line_t, values_seen, look_area, look_dashed, look_dots, look_dotted, look_joined, &
                         look_rings, look_steps, look_thin
   use psalm_svg_frame, only: pixels
   use psalm_svg_panel, only: plot_panel_t, begin_picture, draw_axes, px, round_step
   use psalm_svg_theme, only: palette_size, palette_style
   use psalm_text, only: text_t, full_precision, number_or_nan, to_text
   implicit none (type, external)
   private
   public :: write_plots, draw_plot, height_of_plot, plot_style, plot_width

   real(wp), parameter :: plot_width = 720.0_wp, left = 84.0_wp, right = 26.0_wp, header = 58.0_wp !! pixels
   real(wp), parameter :: head = 20.0_wp, foot = 62.0_wp, row_height = 17.0_wp
   real(wp), parameter :: letter = 7.2_wp, sample = 26.0_wp   !! width of a letter; of the line in the legend
   real(wp), parameter :: ring = 3.5_wp                       !! radius
   character(*), parameter :: circle = 'a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0' !! from its leftmost point
   real(wp), parameter :: pad = 0.05_wp                       !! of the values' range, above and below
   real(wp), parameter :: around = 0.01_wp                    !! part of the scale that is shown on either side of a constant
   real(wp), parameter :: turn_tick = 30.0_wp, part_of_turn = 300.0_wp !! degrees between marks of at least so many
   real(wp), parameter :: ticks = 8.0_wp
   character(*), parameter :: own = '.dots{stroke-width:4.5;stroke-linecap:round}.thin{stroke-width:1}'// &
                              '.dashed{stroke-dasharray:6 4;stroke-width:1.3}.dotted{stroke-dasharray:2 4;stroke-width:1.3}'// &
                              '.line{stroke-width:1.6}.area{fill-opacity:.22;stroke:none}.span{fill:$bad;fill-opacity:.13}'// &
                              '.mild{fill:$warn;fill-opacity:.16}'

contains

   !> Append the picture.
   subroutine write_plots(title, plots, text)
      character(*), intent(in) :: title
      type(plot_t), intent(in) :: plots(:)
      type(text_t), intent(inout) :: text
      real(wp) :: top
      integer :: p

      top = header
      do p = 1, size(plots)
         top = top + height_of_plot(plots(p))
      end do
      call begin_picture(title, plot_width, top, plot_style(), text)
      top = header
      do p = 1, size(plots)
         call draw_plot(plots(p), p, top, text)
         top = top + height_of_plot(plots(p))
      end do
      call text%add('</svg>')
   end subroutine write_plots

   !> What plots have besides the style of all pictures.
   pure function plot_style() result(style)
      character(:), allocatable :: style

      style = own//palette_style()
   end function plot_style

   !> Height of a plot with its head and axis, pixels.
   pure real(wp) function height_of_plot(plot) result(height)
      type(plot_t), intent(in) :: plot

      height = head + row_height*real(rows_of_legend(plot), wp) + plot%height + foot
   end function height_of_plot

   !> Append a plot, `number` of its picture, below `top`.
   subroutine draw_plot(plot, number, top, text)
      type(plot_t), intent(in) :: plot
      integer, intent(in) :: number
      real(wp), intent(in) :: top              !! pixels
      type(text_t), intent(inout) :: text
      type(plot_panel_t) :: panel
      real(wp) :: low, high, tick
      integer :: k

      call find_range(plot, low, high)
      panel = plot_panel_t(left, top + head + row_height*real(rows_of_legend(plot), wp), plot_width - left - right, plot%height, &
                           plot%from, plot%to, low, high)
      tick = round_step((plot%to - plot%from)/ticks)
      if (plot%turning .and. plot%to - plot%from >= part_of_turn) tick = turn_tick
      call text%add('<g class="plot" data-name="'//xml_text(trim(plot%name))//'" data-from="'//full_precision(plot%from)// &
                    '" data-to="'//full_precision(plot%to)//'" data-low="'//full_precision(low)//'" data-high="'// &
                    full_precision(high)//'" data-box="'//pixels(panel%left)//' '//pixels(panel%top)//' '// &
                    pixels(panel%width)//' '//pixels(panel%height)//'">')
      call text%add('<clipPath id="p'//to_text(number)//'"><rect x="'//px(panel%left)//'" y="'//px(panel%top)//'" width="'// &
                    px(panel%width)//'" height="'//px(panel%height)//'"/></clipPath>')
      do k = 1, size(plot%spans, 2)
         associate (first => panel%x_of(max(plot%from, plot%spans(1, k))), last => panel%x_of(min(plot%to, plot%spans(2, k))))
            if (last > first) call text%add('<rect class="'//trim(merge('mild', 'span', plot%mild(k)))//'" x="'// &
                                            pixels(first)//'" y="'//px(panel%top)//'" width="'// &
                                            pixels(last - first)//'" height="'//px(panel%height)//'"/>')
         end associate
      end do
      call draw_axes(panel, trim(plot%name), tick, text, trim(plot%below), top + head - 8.0_wp, plot%logarithmic)
      call draw_legend(plot, top + head, text)
      call text%add('<g clip-path="url(#p'//to_text(number)//')">')
      do k = 1, size(plot%lines)
         call draw_line(panel, plot%lines(k), plot%logarithmic, text)
      end do
      call text%add('</g>')
      if (.not. any([(any(plot%lines(k)%known), k=1, size(plot%lines))])) &
         call text%add('<text class="middle" x="'//px(panel%left + 0.5_wp*panel%width)//'" y="'// &
                       px(panel%top + 0.5_wp*panel%height)//'">the linkage does not close</text>')
      call text%add('</g>')
   end subroutine draw_plot

   !> Bottom and top, of a logarithmic plot powers of ten. An axis does not magnify the rounding of a constant.
   subroutine find_range(plot, low, high)
      use psalm_panels, only: flat
      type(plot_t), intent(in) :: plot
      real(wp), intent(out) :: low, high
      real(wp), allocatable :: values(:)
      real(wp) :: middle

      low = plot%low
      high = plot%high
      if (high > low) return
      values = values_seen(plot)
      if (plot%logarithmic) values = pack(values, values > 0.0_wp)
      if (size(values) == 0) then
         low = 0.0_wp
         high = 1.0_wp
         return
      end if
      low = minval(values)
      high = maxval(values)
      if (plot%logarithmic) then
         low = real(floor(log10(low)), wp)
         high = max(low + 1.0_wp, real(ceiling(log10(high)), wp))
         return
      end if
      if (plot%from_zero) then
         low = min(low, 0.0_wp)
         high = max(high, 0.0_wp)
      end if
      if (high - low < flat*plot%scale .or. .not. high > low) then
         middle = 0.5_wp*(low + high)
         if (abs(middle) < flat*plot%scale) middle = 0.0_wp
         associate (half => merge(around*plot%scale, 1.0_wp, plot%scale > 0.0_wp))
            low = middle - half
            high = middle + half
         end associate
         return
      end if
      associate (more => pad*(high - low))
         low = low - more
         high = high + more
      end associate
   end subroutine find_range

   !> Append the points that are known.
   subroutine draw_line(panel, line, logarithmic, text)
      type(plot_panel_t), intent(in) :: panel
      type(plot_line_t), intent(in) :: line
      logical, intent(in) :: logarithmic
      type(text_t), intent(inout) :: text
      logical :: pen
      integer :: i

      if (.not. any(line%known)) return
      if (line%look == look_area) then
         call draw_area()
         return
      end if
      call text%add('<path class="'//class_of(line)//'" data-name="'//xml_text(trim(line%label))//'"')
      if (line%look == look_dots .or. line%look == look_rings) then
         ! what is drawn by marks is there with all digits, as the marks of the linkage's own picture are
         call text%add(' data-values="')
         do i = 1, size(line%y)
            call text%add(number_or_nan(line%y(i), line%known(i)))
         end do
         call text%add_text('"')
      end if
      call text%add(' d="')
      pen = .false.
      do i = 1, size(line%x)
         if (.not. line%known(i)) then
            pen = .false.
            cycle
         end if
         associate (x => panel%x_of(line%x(i)), y => up(line%y(i)))
            select case (line%look)
            case (look_dots)
               call text%add('M'//pixels(x)//' '//pixels(y)//'h0')
            case (look_rings)
               call text%add('M'//pixels(x - ring)//' '//pixels(y)//circle)
            case (look_steps)
               if (pen) call text%add('H'//pixels(x))
               call text%add(merge('L', 'M', pen)//pixels(x)//' '//pixels(y))
            case default
               call text%add(merge('L', 'M', pen)//pixels(x)//' '//pixels(y))
            end select
         end associate
         pen = .true.
      end do
      call text%add('"/>')
      if (line%look /= look_joined) return
      call text%add('<path class="dots c'//to_text(line%colour)//'" d="')
      do i = 1, size(line%x)
         if (line%known(i)) call text%add('M'//pixels(panel%x_of(line%x(i)))//' '//pixels(up(line%y(i)))//'h0')
      end do
      call text%add('"/>')

   contains

      !> Pixels of a value; far outside no number grows too large for a viewer.
      pure real(wp) function up(value)
         real(wp), intent(in) :: value
         real(wp) :: shown

         shown = value
         if (logarithmic) shown = log10(max(value, tiny(value)))
         up = panel%y_of(max(panel%low - (panel%high - panel%low), min(panel%high + (panel%high - panel%low), shown)))
      end function up

      !> The areas between both edges, one for each run of known points.
      subroutine draw_area()
         integer :: first, last, k

         first = 1
         do while (first <= size(line%x))
            last = first
            do while (last < size(line%x))
               if (line%known(first) .neqv. line%known(last + 1)) exit
               last = last + 1
            end do
            if (line%known(first)) then
               call text%add('<path class="area f'//to_text(line%colour)//'" data-name="'//xml_text(trim(line%label))//'" d="M')
               do k = first, last
                  call text%add(pixels(panel%x_of(line%x(k)))//' '//pixels(up(line%y(k))))
               end do
               do k = last, first, -1
                  call text%add(pixels(panel%x_of(line%x(k)))//' '//pixels(up(line%other(k))))
               end do
               call text%add('Z"/>')
            end if
            first = last + 1
         end do
      end subroutine draw_area
   end subroutine draw_line

   pure function class_of(line) result(class)
      type(plot_line_t), intent(in) :: line
      character(:), allocatable :: class

      select case (line%look)
      case (look_thin, look_joined, look_rings)
         class = 'thin'
      case (look_dashed)
         class = 'dashed'
      case (look_dotted)
         class = 'dotted'
      case (look_dots)
         class = 'dots'
      case default
         ! beyond the colours of the palette they come again, dashed
         class = merge('dashed', 'line  ', line%colour > palette_size)
      end select
      class = trim(class)//' c'//to_text(merge(0, modulo(line%colour - 1, palette_size) + 1, line%colour == 0))
   end function class_of

   ! ---- legend ------------------------------------------------------------------------------------------------------

   pure integer function rows_of_legend(plot) result(rows)
      type(plot_t), intent(in) :: plot
      real(wp) :: x
      integer :: k

      rows = 0
      x = plot_width
      do k = 1, size(plot%lines)
         if (len_trim(plot%lines(k)%label) == 0) cycle
         call next_place(plot%lines(k)%label, x, rows)
      end do
   end function rows_of_legend

   !> Where the entry of a line begins: x is the end of the one before, then that of this one.
   pure subroutine next_place(label, x, row)
      character(*), intent(in) :: label
      real(wp), intent(inout) :: x
      integer, intent(inout) :: row
      real(wp) :: size_

      size_ = sample + 20.0_wp + letter*real(len_trim(label), wp)
      if (x + size_ > plot_width - right) then
         x = left
         row = row + 1
      end if
      x = x + size_
   end subroutine next_place

   subroutine draw_legend(plot, top, text)
      type(plot_t), intent(in) :: plot
      real(wp), intent(in) :: top
      type(text_t), intent(inout) :: text
      real(wp) :: x, start, y
      integer :: k, row

      row = 0
      x = plot_width
      do k = 1, size(plot%lines)
         associate (line => plot%lines(k))
            if (len_trim(line%label) == 0) cycle
            call next_place(line%label, x, row)
            start = x - sample - 20.0_wp - letter*real(len_trim(line%label), wp)
            y = top + row_height*real(row, wp) - 12.0_wp
            select case (line%look)
            case (look_area)
               call text%add('<path class="area f'//to_text(line%colour)//'" d="M'//px(start)//' '//px(y - 5.0_wp)//'h'// &
                             px(sample - 6.0_wp)//'v10H'//px(start)//'Z"/>')
            case (look_dots, look_rings)
               call text%add('<path class="'//class_of(line)//'" d="M'//px(start + 6.0_wp)//' '//px(y)// &
                             trim(merge(circle, 'h0'//repeat(' ', len(circle) - 2), line%look == look_rings))//'"/>')
            case default
               call text%add('<path class="'//class_of(line)//'" d="M'//px(start)//' '//px(y)//'h'//px(sample - 6.0_wp)//'"/>')
            end select
            call text%add('<text class="small" x="'//px(start + sample)//'" y="'//px(y + 4.0_wp)//'">'// &
                          xml_text(trim(line%label))//'</text>')
         end associate
      end do
   end subroutine draw_legend
end module psalm_plot_svg
