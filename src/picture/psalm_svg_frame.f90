!> What every SVG of the programs begins with.
module psalm_svg_frame
   use psalm_kinds, only: wp
   use psalm_markup, only: xml_text, short_number
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: begin_svg, pixels

contains

   !> The heading, the size in pixels and the title.
   subroutine begin_svg(title, width, height, text)
      character(*), intent(in) :: title
      real(wp), intent(in) :: width, height
      type(text_t), intent(inout) :: text
      character(:), allocatable :: across, down

      across = pixels(width)
      down = pixels(height)
      call text%add('<?xml version="1.0" encoding="UTF-8"?>')
      call text%add('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 '//across//' '//down//'" width="'//across// &
                    '" height="'//down//'" role="img" aria-labelledby="title">')
      call text%add('<title id="title">'//xml_text(trim(title))//'</title>')
   end subroutine begin_svg

   !> Pixels to the hundredth.
   pure function pixels(value) result(text)
      real(wp), intent(in) :: value
      character(:), allocatable :: text

      text = short_number(real(nint(value*100.0_wp), wp)/100.0_wp)
   end function pixels
end module psalm_svg_frame
