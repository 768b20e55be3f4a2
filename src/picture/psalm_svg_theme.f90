!> How every SVG of the programs looks, in light and dark: one table of colours, that of the pages (web/colours.css).
!>
!> A style is written once, with names of colours: `.bar{stroke:$ink;stroke-width:2}`, or a pair of its own `$(#fff|#000)`. The
!> rules for dark screens are those declarations that have a colour.
module psalm_svg_theme
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: style_element, base_style, palette_style, palette_size, style_of_areas

   integer, parameter :: palette_size = 8   !! colours of links and lines, used in turn

   !> A colour: its name, on light and on dark screens.
   type :: colour_t
      character(7) :: name
      character(7) :: shades(2)
   end type colour_t

   type(colour_t), parameter :: colours(*) = [ &
                                colour_t('paper', ['#ffffff', '#14191f']), colour_t('ink', ['#14202b', '#e6ebf0']), &
                                colour_t('soft', ['#56636f', '#aab6c1']), colour_t('line', ['#c9d1d8', '#36404a']), &
                                colour_t('accent', ['#0b57d0', '#7db4ff']), colour_t('actual', ['#c62828', '#ff6b60']), &
                                colour_t('desired', ['#0b57d0', '#7db4ff']), colour_t('bad', ['#d3302f', '#ff6b60']), &
                                colour_t('warn', ['#9a6700', '#f0c060']), colour_t('good', ['#2e7d32', '#7ccf8a']), &
                                colour_t('frame', ['#7d8994', '#8793a0']), colour_t('ghost', ['#9aa4ad', '#6b7681']), &
                                colour_t('link0', ['#1f6fb5', '#6db6f2']), colour_t('link1', ['#b5541c', '#f0a070']), &
                                colour_t('link2', ['#2e8540', '#7ccf8a']), colour_t('link3', ['#7b3fa0', '#c79be6']), &
                                colour_t('link4', ['#a8740a', '#e3bb5a']), colour_t('link5', ['#b0305f', '#f08bb0']), &
                                colour_t('link6', ['#16808a', '#63cbd4']), colour_t('link7', ['#5a6b1c', '#b9cc6a'])]

   !> Classes of every picture: head, small, error, warning; paper, bar, ghost.
   character(*), parameter :: base_style = &
      'svg{max-width:100%;height:auto}text{font:13px "DejaVu Sans",Verdana,Arial,sans-serif;fill:$ink}'// &
      '.head{font-size:18px;font-weight:bold}.small{font-size:11.5px;fill:$soft}.error{fill:$bad}.warning{fill:$warn}'// &
      '.paper{fill:$paper}.bar{stroke:$ink}.ghost{stroke:$ghost}'

contains

   !> The element of a style whose rules have names of colours.
   pure function style_element(rules) result(element)
      character(*), intent(in) :: rules
      character(:), allocatable :: element

      element = '<style>'//painted(rules, 1)//'@media screen and (prefers-color-scheme:dark){'//painted(of_colours(rules), 2)// &
                '}</style>'
   end function style_element

   !> Rules of lines (c) and areas (f) in the colours of links, of limits c0 and f0.
   pure function palette_style() result(rules)
      character(:), allocatable :: rules
      integer :: i

      rules = '.c0{stroke:$actual}.f0{fill:$actual}'
      do i = 1, palette_size
         rules = rules//'.c'//to_text(i)//'{stroke:$link'//to_text(i - 1)//'}.f'//to_text(i)//'{fill:$link'//to_text(i - 1)//'}'
      end do
   end function palette_style

   !> Rules of areas without an outline in the colours of a scale: classes of a letter and a number.
   pure function style_of_areas(letter, lights, darks) result(rules)
      character(1), intent(in) :: letter
      character(7), intent(in) :: lights(:), darks(:) !! shape (classes): on light and dark screens
      character(:), allocatable :: rules
      integer :: k

      rules = ''
      do k = 1, size(lights)
         rules = rules//'.'//letter//to_text(k)//'{stroke:none;fill:$('//lights(k)//'|'//darks(k)//')}'
      end do
   end function style_of_areas

   !> Rules with colours in place of their names.
   pure function painted(rules, screen) result(text)
      character(*), intent(in) :: rules
      integer, intent(in) :: screen          !! 1: light, 2: dark
      character(:), allocatable :: text
      integer :: at, next, last, k

      text = ''
      at = 1
      do
         next = index(rules(at:), '$')
         if (next == 0) exit
         text = text//rules(at:at + next - 2)
         at = at + next                      ! behind the sign
         if (rules(at:at) == '(') then
            last = at + index(rules(at:), ')') - 1
            k = at + index(rules(at:last), '|') - 1
            if (screen == 1) text = text//rules(at + 1:k - 1)
            if (screen == 2) text = text//rules(k + 1:last - 1)
            at = last + 1
         else
            last = at + scan(rules(at:), ';}') - 2
            do k = 1, size(colours)
               if (colours(k)%name == rules(at:last)) text = text//colours(k)%shades(screen)
            end do
            at = last + 1
         end if
      end do
      text = text//rules(at:)
   end function painted

   !> Of rules the declarations that have a colour.
   pure function of_colours(rules) result(text)
      character(*), intent(in) :: rules
      character(:), allocatable :: text, kept
      integer :: at, left, right, from, last

      text = ''
      at = 1
      do
         left = index(rules(at:), '{')
         if (left == 0) exit
         left = at + left - 1
         right = left + index(rules(left:), '}') - 1
         kept = ''
         from = left + 1
         do while (from < right)
            last = from + scan(rules(from:right), ';}') - 1
            if (index(rules(from:last), '$') > 0) then
               if (len(kept) > 0) kept = kept//';'
               kept = kept//rules(from:last - 1)
            end if
            from = last + 1
         end do
         if (len(kept) > 0) text = text//rules(at:left)//kept//'}'
         at = right + 1
      end do
   end function of_colours
end module psalm_svg_theme
