!> Panels of curves in an SVG: axes with round ticks and units, curves, limits, and how they look in light and dark.
module psalm_svg_panel
   use psalm_kinds, only: wp
   use psalm_markup, only: xml_text, short_number
   use psalm_svg_frame, only: begin_svg
   use psalm_svg_theme, only: base_style, style_element
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: plot_panel_t, begin_picture, draw_axes, draw_curve, draw_level, px, round_step

   integer, parameter :: digits_for_people = 5
   integer, parameter :: rows = 6                   !! lines across a panel at most, but for one
   integer, parameter :: most_marks = 100           !! of a scale of powers, too
   real(wp), parameter :: rounding = 1.0e-6_wp      !! of a tick: so much outside it is still shown
   real(wp), parameter :: tick_height = 14.0_wp     !! pixels from the panel to its numbers below
   real(wp), parameter :: least_span = tiny(1.0_wp)*1.0e10_wp

   !> Classes of every picture with panels besides: middle, right; frame, zero, curve, limit.
   character(*), parameter :: panel_style = &
      '.middle{text-anchor:middle}.right{text-anchor:end}path,circle{fill:none;stroke:$ink;stroke-linejoin:round}'// &
      '.frame{stroke:$line}.zero{stroke:$ghost;stroke-dasharray:3 3}.curve{stroke:$accent;stroke-width:1.5}'// &
      '.limit{stroke:$actual;stroke-dasharray:4 4}'

   !> A rectangle of the picture and the values at its sides.
   type :: plot_panel_t
      real(wp) :: left = 0.0_wp, top = 0.0_wp, width = 0.0_wp, height = 0.0_wp !! pixels
      real(wp) :: from = 0.0_wp, to = 1.0_wp        !! left and right
      real(wp) :: low = 0.0_wp, high = 1.0_wp       !! bottom and top
   contains
      procedure :: x_of
      procedure :: y_of
   end type plot_panel_t

contains

   !> The heading of an SVG, its style, paper and title. What a picture has besides comes as its own style.
   subroutine begin_picture(title, width, height, own, text)
      character(*), intent(in) :: title
      real(wp), intent(in) :: width, height            !! pixels
      character(*), intent(in) :: own                  !! rules with names of colours
      type(text_t), intent(inout) :: text

      call begin_svg(title, width, height, text)
      call text%add(style_element(base_style//panel_style//own))
      call text%add('<rect class="paper" width="'//px(width)//'" height="'//px(height)//'"/>')
      call text%add('<text class="head" x="28" y="34">'//xml_text(trim(title))//'</text>')
   end subroutine begin_picture

   !> Name and unit above the panel, lines and numbers at round values; below, numbers at every tick of the input.
   subroutine draw_axes(panel, name, tick, text, below, name_at, logarithmic)
      type(plot_panel_t), intent(in) :: panel
      character(*), intent(in) :: name                 !! of the curve, with its unit
      real(wp), intent(in) :: tick                     !! between marks of the input; of its sign
      type(text_t), intent(inout) :: text
      character(*), intent(in), optional :: below      !! name of the input, with its unit
      real(wp), intent(in), optional :: name_at        !! base line of the name; just above the panel if absent
      logical, intent(in), optional :: logarithmic     !! the sides are powers of ten
      real(wp) :: step, value, y, name_line
      logical :: powers
      integer :: k

      associate (right => panel%left + panel%width, bottom => panel%top + panel%height)
         name_line = panel%top - 8.0_wp
         if (present(name_at)) name_line = name_at
         powers = .false.
         if (present(logarithmic)) powers = logarithmic
         call text%add('<text x="'//px(panel%left)//'" y="'//px(name_line)//'">'//xml_text(name)//'</text>')
         call text%add('<path class="frame" d="M'//px(panel%left)//' '//px(panel%top)//'H'//px(right)//'V'//px(bottom)//'H'// &
                       px(panel%left)//'Z"/>')
         step = round_step((panel%high - panel%low)/real(rows, wp))
         if (powers) step = max(1.0_wp, step)
         do k = first_mark(panel%low, step), first_mark(panel%low, step) + most_marks
            if (real(k, wp) > panel%high/step) exit
            value = step*real(k, wp)
            y = panel%y_of(value)
            call text%add('<path class="'//trim(merge('zero ', 'frame', k == 0 .and. .not. powers))//'" d="M'// &
                          px(panel%left)//' '//px(y)//'H'//px(right)//'"/><text class="small right" x="'// &
                          px(panel%left - 6.0_wp)//'" y="'//px(y + 4.0_wp)//'">'// &
                          px(merge(10.0_wp**value, value, powers))//'</text>')
         end do
         do k = ceiling(panel%from/tick - rounding), floor(panel%to/tick + rounding)
            value = tick*real(k, wp)
            call text%add('<path class="frame" d="M'//px(panel%x_of(value))//' '//px(panel%top)//'v'// &
                          px(panel%height + 4.0_wp)//'"/><text class="small middle" x="'//px(panel%x_of(value))//'" y="'// &
                          px(bottom + 4.0_wp + tick_height)//'">'//px(value)//'</text>')
         end do
         if (present(below)) call text%add('<text class="small middle" x="'//px(panel%left + 0.5_wp*panel%width)//'" y="'// &
                                           px(bottom + 20.0_wp + tick_height)//'">'//xml_text(below)//'</text>')
      end associate
   end subroutine draw_axes

   !> The first mark not below a value, in steps; where the step is lost in the digits of the value, a number beyond all.
   pure integer function first_mark(value, step)
      real(wp), intent(in) :: value, step

      first_mark = huge(first_mark) - 2*most_marks
      if (abs(value) < 0.5_wp*real(huge(first_mark), wp)*step) first_mark = ceiling(value/step)
   end function first_mark

   !> A curve; what leaves the panel is drawn at its edge, and where the input begins anew so does the line.
   subroutine draw_curve(panel, class, input, values, text)
      type(plot_panel_t), intent(in) :: panel
      character(*), intent(in) :: class
      real(wp), intent(in) :: input(:), values(:)      !! shape (points)
      type(text_t), intent(inout) :: text
      real(wp) :: x, before
      integer :: i

      if (size(input) == 0) return
      call text%add('<path class="'//class//'" d="')
      before = huge(1.0_wp)
      do i = 1, size(input)
         x = panel%x_of(input(i))
         call text%add(merge('M', 'L', x < before)//px(x)//' '//px(panel%y_of(min(panel%high, max(panel%low, values(i))))))
         before = x
      end do
      call text%add('"/>')
   end subroutine draw_curve

   !> A line across a panel.
   subroutine draw_level(panel, class, value, text)
      type(plot_panel_t), intent(in) :: panel
      character(*), intent(in) :: class
      real(wp), intent(in) :: value
      type(text_t), intent(inout) :: text

      call text%add('<path class="'//class//'" d="M'//px(panel%left)//' '//px(panel%y_of(value))//'H'// &
                    px(panel%left + panel%width)//'"/>')
   end subroutine draw_level

   pure real(wp) function x_of(self, input) result(x)
      class(plot_panel_t), intent(in) :: self
      real(wp), intent(in) :: input

      x = self%left + self%width*(input - self%from)/(self%to - self%from)
   end function x_of

   pure real(wp) function y_of(self, value) result(y)
      class(plot_panel_t), intent(in) :: self
      real(wp), intent(in) :: value

      y = self%top + self%height*(self%high - value)/max(self%high - self%low, least_span)
   end function y_of

   !> The next 1, 2 or 5 times a power of ten, not below the value.
   pure real(wp) function round_step(value)
      real(wp), intent(in) :: value
      real(wp) :: power

      round_step = 1.0_wp
      if (.not. value > 0.0_wp) return
      power = 10.0_wp**floor(log10(value))
      round_step = 10.0_wp*power
      if (value <= 5.0_wp*power) round_step = 5.0_wp*power
      if (value <= 2.0_wp*power) round_step = 2.0_wp*power
      if (value <= power) round_step = power
   end function round_step

   !> A number of a picture that people read, or a place in it.
   pure function px(value) result(number)
      real(wp), intent(in) :: value
      character(:), allocatable :: number

      number = short_number(value, digits_for_people)
   end function px
end module psalm_svg_panel
