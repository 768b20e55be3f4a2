!> Details of the linkage at one position in the SVG: a vibrating link bent, and a pin in its hole with what acts on it.
module psalm_detail_drawing
   use psalm_kinds, only: wp, pi
   use psalm_markup, only: short_number, xml_text
   use psalm_scene, only: scene_t, place_on_sweep
   use psalm_text, only: text_t, full_precision
   implicit none (type, external)
   private
   public :: bent_path, bent_words, draw_pin, height_of_pin, detail_style

   integer, parameter :: steps = 40                     !! of a bent link
   integer, parameter :: digits = 5                     !! of forces in words
   real(wp), parameter :: height_of_pin = 150.0_wp      !! that the pin takes, pixels
   real(wp), parameter :: hole = 52.0_wp                !! radius of the hole, pixels
   real(wp), parameter :: play = 0.25_wp*hole           !! of the pin in it, as drawn
   real(wp), parameter :: head = 7.0_wp                 !! of an arrow, pixels
   real(wp), parameter :: most = 1.2_wp                 !! longest arrow of the contact over that of the largest load

   !> What these drawings need besides the style of the linkage.
   character(*), parameter :: detail_style = &
      '.straight{fill:none;stroke:$ink}.hole{fill:none;stroke:$ink;stroke-width:2.2}.pin{fill:$warn;fill-opacity:.16;'// &
      'stroke:$frame}.pin.lost{fill:$bad;stroke:$bad}.bearing{fill:none;stroke:$accent;stroke-width:2}'// &
      '.contact{fill:none;stroke:$actual;stroke-width:2}'

contains

   !> The vibrating link at a prescribed position, machine coordinates: a path from its first end to the other.
   function bent_path(scene, position) result(path)
      type(scene_t), intent(in) :: scene         !! with a vibrating link
      integer, intent(in) :: position
      character(:), allocatable :: path
      real(wp) :: from(2), along(2), place, bow
      real(wp), allocatable :: deflection(:)
      integer :: s, j, start, finish

      associate (v => scene%vibration, bar => scene%bars(scene%vibration%bar), row => scene%prescribed)
         start = merge(bar%finish, bar%start, v%reversed)
         finish = merge(bar%start, bar%finish, v%reversed)
         from = [row%x(start, position), row%y(start, position)]
         along = [row%x(finish, position), row%y(finish, position)] - from
         deflection = [(v%factor*on_sweep(scene, position, v%deflection(:, j))/norm2(along), j=1, size(v%deflection, 2))]
         path = ''
         do s = 0, steps
            place = real(s, wp)/real(steps, wp)
            bow = 0.0_wp                         ! to the left of the link
            do j = 1, size(deflection)
               bow = bow + deflection(j)*sin(real(j, wp)*pi*place)
            end do
            path = path//merge('M', 'L', s == 0)//full_precision(from(1) + place*along(1) - bow*along(2))//' '// &
                   full_precision(from(2) + place*along(2) + bow*along(1))
         end do
      end associate
   end function bent_path

   !> How much larger the bending is drawn.
   function bent_words(scene) result(words)
      type(scene_t), intent(in) :: scene         !! with a vibrating link
      character(:), allocatable :: words

      words = 'bending drawn '//short_number(scene%vibration%factor)//' times larger'
      if (.not. scene%vibration%settles) words = words//'; the motion is not stable'
   end function bent_words

   !> A value over the sweep at a prescribed position, between those beside it.
   function on_sweep(scene, position, values) result(value)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: position
      real(wp), intent(in) :: values(:)          !! shape (sweep)
      real(wp) :: value, place
      integer :: k, next

      place = place_on_sweep(scene, position)
      k = modulo(int(place), size(values)) + 1
      next = modulo(k, size(values)) + 1
      value = values(k) + (place - aint(place))*(values(next) - values(k))
   end function on_sweep

   !> The pin in its hole at a prescribed position, magnified: load without clearance, and force of contact.
   subroutine draw_pin(scene, position, top, text)
      type(scene_t), intent(in) :: scene         !! with a joint with clearance
      integer, intent(in) :: position
      real(wp), intent(in) :: top                !! pixels
      type(text_t), intent(inout) :: text
      real(wp) :: pin(2), load(2), force, largest, reach
      character(:), allocatable :: words

      associate (c => scene%clearance, middle => top + 0.5_wp*height_of_pin)
         pin = [on_sweep(scene, position, c%pin(1, :)), on_sweep(scene, position, c%pin(2, :))]
         pin = pin/max(norm2(pin), tiny(1.0_wp))
         load = [on_sweep(scene, position, c%load(1, :)), on_sweep(scene, position, c%load(2, :))]
         force = on_sweep(scene, position, c%force)
         largest = max(maxval(norm2(c%load, dim=1)), tiny(1.0_wp))
         reach = hole - play - 4.0_wp
         call text%add('<g id="pin" data-joint="'//xml_text(c%name)//'" data-force="'//full_precision(force)//'" data-load="'// &
                       full_precision(load(1))//' '//full_precision(load(2))//'" transform="translate('// &
                       short_number(28.0_wp + hole)//' '//short_number(middle)//')"><circle class="hole" r="'// &
                       short_number(hole)//'"/><circle class="pin'//trim(merge(' lost', '     ', force < 0.0_wp))//'" cx="'// &
                       short_number(play*pin(1))//'" cy="'//short_number(-play*pin(2))//'" r="'//short_number(hole - play)//'"/>')
         call arrow('bearing', [0.0_wp, 0.0_wp], reach/largest*load)
         if (force > 0.0_wp) call arrow('contact', hole*pin, min(most, force/largest)*reach*pin)
         call text%add('</g>')
         words = 'contact '//short_number(force, digits)//' N (red)'
         if (force < 0.0_wp) words = 'contact lost'
         call line(1, 'Joint '//c%name//', diametral clearance '//short_number(c%diametral, digits)//': the pin in its hole')
         call line(2, 'load without clearance '//short_number(norm2(load), digits)//' N (blue), '//words)
      end associate

   contains

      !> An arrow from a point of the hole, y upwards.
      subroutine arrow(class, from, along)
         character(*), intent(in) :: class
         real(wp), intent(in) :: from(2), along(2)   !! pixels
         real(wp) :: tip(2), back(2), aside(2)

         if (norm2(along) <= 1.0_wp) return
         tip = from + along
         back = min(head, 0.6_wp*norm2(along))/norm2(along)*along
         aside = 0.4_wp*[-back(2), back(1)]
         call text%add('<path class="'//class//'" d="M'//at(from)//'L'//at(tip)//'M'//at(tip - back + aside)//'L'//at(tip)//'L'// &
                       at(tip - back - aside)//'"/>')
      end subroutine arrow

      function at(point) result(pair)
         real(wp), intent(in) :: point(2)
         character(:), allocatable :: pair

         pair = short_number(point(1))//' '//short_number(-point(2))
      end function at

      subroutine line(number, content)
         integer, intent(in) :: number
         character(*), intent(in) :: content

         call text%add('<text class="key" x="'//short_number(28.0_wp + 2.4_wp*hole)//'" y="'// &
                       short_number(top + 0.5_wp*height_of_pin + 18.0_wp*(real(number, wp) - 1.5_wp) + 4.0_wp)//'">'// &
                       xml_text(content)//'</text>')
      end subroutine line
   end subroutine draw_pin
end module psalm_detail_drawing
