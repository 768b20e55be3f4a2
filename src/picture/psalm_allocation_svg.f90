!> Allotted tolerances as SVG: of every dimension its part of the cost and of what the tightest band takes up; then for every
!> number of an output the band that is asked for and what the tolerances reach.
module psalm_allocation_svg
   use psalm_allocation_group, only: rule_yield
   use psalm_allocation_scene, only: allocation_scene_t, allotted_band_t, allotted_words, degree_sign, legend_words, part_words, &
                                     plus_minus, tolerance_words
   use psalm_kinds, only: wp
   use psalm_markup, only: xml_text
   use psalm_plot, only: plot_t, add_line, begin_plot, look_area, look_dashed, look_dotted, look_line
   use psalm_plot_svg, only: draw_plot, height_of_plot, plot_style, plot_width
   use psalm_svg_panel, only: begin_picture, px
   use psalm_text, only: text_t, full_precision
   implicit none (type, external)
   private
   public :: write_allocation_svg

   real(wp), parameter :: margin = 28.0_wp, header = 56.0_wp !! sizes, pixels
   real(wp), parameter :: legend = 46.0_wp           !! height of the words above the bars
   real(wp), parameter :: row_height = 26.0_wp       !! of a dimension
   real(wp), parameter :: bars_at = 250.0_wp         !! where bars begin
   real(wp), parameter :: longest = 260.0_wp         !! of a bar and its per cent
   real(wp), parameter :: room_of_part = 48.0_wp     !! of the per cent
   real(wp), parameter :: thick = 9.0_wp             !! of a bar
   real(wp), parameter :: letter = 7.3_wp            !! width of a letter
   integer, parameter :: colour_worst = 2, colour_square = 1, colour_band = 0
   real(wp), parameter :: around_one = 0.5_wp        !! half of the axis where there is one position alone
   character(*), parameter :: own = '.cost{fill:$link0;stroke:none}.share{fill:$link1;stroke:none}'

contains

   !> Append the picture.
   subroutine write_allocation_svg(title, scene, text)
      character(*), intent(in) :: title
      type(allocation_scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      type(plot_t), allocatable :: plots(:)
      real(wp) :: height, top
      integer :: k

      allocate (plots(0))
      do k = 1, size(scene%bands)
         call plot_band(scene, scene%bands(k), plots)
      end do
      top = header + legend + row_height*real(size(scene%rows), wp) + margin
      height = top
      do k = 1, size(plots)
         height = height + height_of_plot(plots(k))
      end do
      call begin_picture(title, plot_width, height, plot_style()//own, text)
      call draw_bars(scene, text)
      do k = 1, size(plots)
         call draw_plot(plots(k), k, top, text)
         top = top + height_of_plot(plots(k))
      end do
      call text%add('</svg>')
   end subroutine write_allocation_svg

   !> Both bars of every dimension, and its tolerance.
   subroutine draw_bars(scene, text)
      type(allocation_scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      character(:), allocatable :: name
      real(wp) :: y, largest
      integer :: i, most

      call text%add('<text x="'//px(margin)//'" y="'//px(header)//'">'//xml_text(allotted_words(scene))//'</text>')
      call text%add('<path class="cost" d="M'//px(margin)//' '//px(header + 12.0_wp)//'h12v9h-12Z"/><text class="small" x="'// &
                    px(margin + 18.0_wp)//'" y="'//px(header + 21.0_wp)//'">part of the cost</text>')
      call text%add('<path class="share" d="M'//px(margin + 150.0_wp)//' '//px(header + 12.0_wp)//'h12v9h-12Z"/>'// &
                    '<text class="small" x="'//px(margin + 168.0_wp)//'" y="'//px(header + 21.0_wp)//'">'// &
                    xml_text(legend_words(scene))//'</text>')
      most = int((bars_at - margin)/letter)
      largest = max(maxval(scene%rows%cost), maxval(scene%rows%share))
      do i = 1, size(scene%rows)
         associate (row => scene%rows(i))
            y = header + legend + row_height*real(i - 1, wp)
            name = trim(row%name)
            if (len(name) > most) name = name(:most - 3)//'...'
            call text%add('<g class="dimension" data-name="'//xml_text(trim(row%name))//'" data-tolerance="'// &
                          full_precision(row%tolerance)//'" data-cost="'//full_precision(row%cost)//'" data-share="'// &
                          full_precision(row%share)//'"><title>'//xml_text(trim(row%name))//'</title>'// &
                          '<text class="small right" x="'//px(bars_at - 8.0_wp)//'" y="'//px(y + thick + 4.0_wp)//'">'// &
                          xml_text(name)//'</text>')
            call draw_bar('cost', y, row%cost)
            call draw_bar('share', y + thick, row%share)
            call text%add('<text class="small" x="'//px(bars_at + longest + 12.0_wp)//'" y="'//px(y + thick + 4.0_wp)//'">'// &
                          xml_text(tolerance_words(row, plus_minus, degree_sign))//'</text></g>')
         end associate
      end do

   contains

      !> A bar with its per cent at its end.
      subroutine draw_bar(class, y, part)
         character(*), intent(in) :: class
         real(wp), intent(in) :: y, part
         real(wp) :: length

         length = max(1.0_wp, (longest - room_of_part)*part/largest)
         call text%add('<rect class="'//class//'" x="'//px(bars_at)//'" y="'//px(y)//'" width="'//px(length)//'" height="'// &
                       px(thick - 1.0_wp)//'"/><text class="small" style="font-size:9.5px" x="'//px(bars_at + length + 4.0_wp)// &
                       '" y="'//px(y + thick - 1.0_wp)//'">'//part_words(part)//'</text>')
      end subroutine draw_bar
   end subroutine draw_bars

   !> Band and deviations over the input.
   pure subroutine plot_band(scene, band, plots)
      type(allocation_scene_t), intent(in) :: scene
      type(allotted_band_t), intent(in) :: band
      type(plot_t), allocatable, intent(inout) :: plots(:)
      type(plot_t) :: like
      integer, allocatable :: at(:)
      real(wp), allocatable :: x(:)
      integer :: i

      at = [(i, i=1, size(band%input))]
      x = band%input
      if (x(1) >= x(size(x))) then
         at = [1, 1]
         x = x(1) + [-around_one, around_one]
      end if
      like%below = scene%input
      like%turning = scene%turning
      like%from = x(1)
      like%to = x(size(x))
      like%from_zero = .true.
      call begin_plot('deviation of '//trim(band%name), like, plots)
      associate (plot => plots(size(plots)))
         call add_line(plot, 'worst case', look_area, colour_worst, x, band%worst(at), other=-band%worst(at))
         call add_line(plot, '', look_line, colour_worst, x, band%worst(at))
         call add_line(plot, '', look_line, colour_worst, x, -band%worst(at))
         call add_line(plot, 'root-sum-square', look_area, colour_square, x, band%square(at), other=-band%square(at))
         call add_line(plot, '', look_line, colour_square, x, band%square(at))
         call add_line(plot, '', look_line, colour_square, x, -band%square(at))
         if (scene%rule == rule_yield) then
            call add_line(plot, 'share of the linkages', look_dotted, 3, x, band%used(at))
            call add_line(plot, '', look_dotted, 3, x, -band%used(at))
         end if
         call add_line(plot, 'band', look_dashed, colour_band, x, band%width(at))
         call add_line(plot, '', look_dashed, colour_band, x, -band%width(at))
      end associate
   end subroutine plot_band
end module psalm_allocation_svg
