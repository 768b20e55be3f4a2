!> Four poses as SVG: the curves of fixed pivots and of pins with the best linkage on them; beside it the map of the transmission
!> angle over all pairs of pivots.
module psalm_pole_svg
   use psalm_defects, only: exact_linkage_t
   use psalm_kinds, only: wp, half_turn, full_turn
   use psalm_markup, only: short_number
   use psalm_pole_curves, only: branches
   use psalm_pole_scene, only: pole_scene_t, poses_drawn, rays_drawn
   use psalm_svg_panel, only: begin_picture, px
   use psalm_svg_theme, only: style_of_areas
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_pole_svg

   real(wp), parameter :: margin = 28.0_wp, header = 72.0_wp, plane = 480.0_wp, gap = 96.0_wp, map_size = 400.0_wp !! pixels
   real(wp), parameter :: narrow = 800.0_wp          !! width without the map
   real(wp), parameter :: footer = 92.0_wp, axis_length = 26.0_wp
   real(wp), parameter :: around = 1.5_wp            !! size of the plane that is shown, over that of poses and best linkage
   real(wp), parameter :: out_of_sight = 3.0_wp      !! sizes of that plane: points farther away end a line
   real(wp), parameter :: levels(*) = [15.0_wp, 30.0_wp, 45.0_wp] !! between colours of the transmission angle, degrees
   integer, parameter :: shades = size(levels) + 1, defect = 2*shades + 1 !! numbers of colours: turning, rocking, defect
   integer, parameter :: digits_for_people = 5

   !> The part of the plane that is shown.
   type :: view_t
      complex(wp) :: middle = (0.0_wp, 0.0_wp)
      real(wp) :: half = 1.0_wp
   end type view_t

contains

   !> Append the picture.
   subroutine write_pole_svg(scene, text)
      type(pole_scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      type(view_t) :: view
      real(wp) :: width, height

      width = 2.0_wp*margin + plane + gap + map_size
      if (.not. scene%has_map) width = narrow
      height = header + plane + footer
      call begin_picture(scene%title, width, height, own_style(), text)
      call text%add('<text class="small" x="28" y="56">'//subtitle(scene)//'</text>')
      call choose_view(scene, view)
      call draw_plane(scene, view, text)
      if (scene%has_map) call draw_map(scene, text)
      call text%add('</svg>')
   end subroutine write_pole_svg

   function subtitle(scene) result(words)
      type(pole_scene_t), intent(in) :: scene
      character(:), allocatable :: words

      words = 'Curves of the pivots of four poses'
      if (.not. scene%has_best) return
      associate (v => scene%best%verdict)
         select case (v%class)
         case (1)
            words = words//'; the best linkage has a crank that turns fully'
         case (2)
            words = words//'; the best linkage has a crank that rocks'
         case default
            words = words//'; the best linkage has a defect'
         end select
         words = words//', transmission angle '//short_number(v%transmission, digits_for_people)//' degrees'
      end associate
   end function subtitle

   !> What this picture has besides the style of all.
   pure function own_style() result(style)
      character(:), allocatable :: style
      character(7), parameter :: lights(defect) = ['#cfe3fb', '#8fbdf2', '#3f86d8', '#0a4aa0', '#fde3c0', '#f8bd77', '#e5862b', &
                                                   '#a8500c', '#d9dde1']
      character(7), parameter :: darks(defect) = ['#183352', '#1f5187', '#3b86d4', '#9cceff', '#4d3310', '#80541a', '#c98125', &
                                                  '#ffc680', '#2b323a']

      style = 'line,rect.box{fill:none;stroke:$ink}.box,.rule{stroke:$ghost}.centre{stroke:$accent;stroke-width:1.8}'// &
              '.pin{stroke:$link1;stroke-width:1.8;stroke-dasharray:6 3}.pole{stroke:$soft}.pose{stroke-width:1.6}'// &
              '.link{stroke:$link2;stroke-width:5;stroke-linecap:round;stroke-opacity:.55;fill:$link2;fill-opacity:.16}'// &
              '.slide{stroke:$link2;stroke-dasharray:9 4}.joint{fill:$paper;stroke-width:1.4}.fixed{fill:$ink}'// &
              '.dot{fill:$ink;stroke:none}.mark{stroke:$actual;stroke-width:2.2}'
      style = style//style_of_areas('m', lights, darks)
   end function own_style

   ! ---- the plane -----------------------------------------------------------------------------------------------------

   !> Poses and the best linkage, with room around them.
   pure subroutine choose_view(scene, view)
      type(pole_scene_t), intent(in) :: scene
      type(view_t), intent(out) :: view
      complex(wp), allocatable :: shown(:)

      shown = scene%pose
      if (scene%has_best) then
         associate (l => scene%best%linkage)
            shown = [shown, l%a, l%b, l%c(1), l%d(1)]
         end associate
      end if
      view%middle = 0.5_wp*cmplx(minval(shown%re) + maxval(shown%re), minval(shown%im) + maxval(shown%im), wp)
      view%half = 0.5_wp*around*max(maxval(shown%re) - minval(shown%re), maxval(shown%im) - minval(shown%im))
      if (.not. view%half > 0.0_wp) view%half = 1.0_wp
   end subroutine choose_view

   !> A place as x and y of the picture.
   pure function at(view, z) result(numbers)
      type(view_t), intent(in) :: view
      complex(wp), intent(in) :: z
      character(:), allocatable :: numbers
      complex(wp) :: place

      place = in_pixels(view, z)
      numbers = px(place%re)//' '//px(place%im)
   end function at

   pure complex(wp) function in_pixels(view, z)
      type(view_t), intent(in) :: view
      complex(wp), intent(in) :: z
      complex(wp) :: away

      away = 0.5_wp*plane*(z - view%middle)/view%half
      in_pixels = cmplx(margin + 0.5_wp*plane + away%re, header + 0.5_wp*plane - away%im, wp)
   end function in_pixels

   subroutine draw_plane(scene, view, text)
      type(pole_scene_t), intent(in) :: scene
      type(view_t), intent(in) :: view
      type(text_t), intent(inout) :: text
      complex(wp) :: place
      real(wp) :: below
      integer :: i, k

      call text%add('<clipPath id="plane"><rect x="'//px(margin)//'" y="'//px(header)//'" width="'//px(plane)//'" height="'// &
                    px(plane)//'"/></clipPath><g clip-path="url(#plane)">')
      call draw_curve(scene, view, 'centre', .false., text)
      call draw_curve(scene, view, 'pin', .true., text)
      if (size(scene%lines) > 0 .and. scene%has_best) call draw_slide(scene%best%linkage, view, text)
      if (scene%has_best) call draw_linkage(scene%best%linkage, view, text)
      do i = 1, poses_drawn
         do k = i + 1, poses_drawn
            if (.not. scene%has_pole(i, k)) cycle
            place = in_pixels(view, scene%pole(i, k))
            call text%add('<path class="pole" d="M'//px(place%re - 4.0_wp)//' '//px(place%im)// &
                          'h8m-4 -4v8"/><text class="small" x="'//px(place%re + 6.0_wp)//'" y="'//px(place%im - 5.0_wp)//'">P'// &
                          to_text(i)//to_text(k)//'</text>')
         end do
      end do
      do i = 1, poses_drawn
         place = in_pixels(view, scene%pose(i))
         call text%add('<path class="pose" d="M'//px(place%re)//' '//px(place%im)//'l'//px(axis_length*scene%axis(i)%re)//' '// &
                       px(-axis_length*scene%axis(i)%im)//'M'//px(place%re)//' '//px(place%im)//'l'// &
                       px(-0.5_wp*axis_length*scene%axis(i)%im)//' '//px(-0.5_wp*axis_length*scene%axis(i)%re)// &
                       '"/><circle class="dot" cx="'//px(place%re)//'" cy="'//px(place%im)//'" r="3.2"/><text x="'// &
                       px(place%re - 14.0_wp)//'" y="'//px(place%im + 14.0_wp)//'">'//to_text(i)//'</text>')
      end do
      call text%add('</g><rect class="box" x="'//px(margin)//'" y="'//px(header)//'" width="'//px(plane)//'" height="'// &
                    px(plane)//'"/>')
      below = header + plane + 22.0_wp
      call key(margin, below, '<path class="centre" d="M0 -4h30"/>', 'fixed pivots')
      call key(margin + 150.0_wp, below, '<path class="pin" d="M0 -4h30"/>', 'pins, in pose 1')
      call key(margin + 310.0_wp, below, '<path class="pole" d="M11 -4h8m-4 -4v8"/>', 'poles of two poses')
      call text%add('<text class="small" x="'//px(margin)//'" y="'//px(below + 24.0_wp)//'">the side of the square is '// &
                    short_number(2.0_wp*view%half, digits_for_people)//'</text>')

   contains

      subroutine key(x, y, sign, words)
         real(wp), intent(in) :: x, y
         character(*), intent(in) :: sign, words

         call text%add('<g transform="translate('//px(x)//' '//px(y)//')">'//sign//'<text class="small" x="38">'//words// &
                       '</text></g>')
      end subroutine key
   end subroutine draw_plane

   !> One of both curves: along the rays on either branch, from one branch to the other where rays cease to meet it.
   subroutine draw_curve(scene, view, class, of_pins, text)
      type(pole_scene_t), intent(in) :: scene
      type(view_t), intent(in) :: view
      character(*), intent(in) :: class
      logical, intent(in) :: of_pins
      type(text_t), intent(inout) :: text
      complex(wp) :: place(0:rays_drawn - 1, branches)
      logical :: there(0:rays_drawn - 1, branches)
      character(:), allocatable :: path
      integer :: i, k, ray
      logical :: down

      there = .false.
      place = (0.0_wp, 0.0_wp)
      do i = 1, size(scene%curve)
         associate (own => scene%curve(i))
            ray = int(own%ray*real(rays_drawn, wp)/half_turn)
            place(ray, own%branch) = scene%pose(1) + merge(own%dyad%pin, own%dyad%pivot, of_pins)
            there(ray, own%branch) = abs(place(ray, own%branch) - view%middle) < out_of_sight*view%half
         end associate
      end do
      do k = 1, branches
         path = ''
         down = .false.
         do i = 0, rays_drawn
            ray = modulo(i, rays_drawn)
            if (.not. there(ray, k)) then
               down = .false.
               cycle
            end if
            if (down .and. i > 0) down = is_near(place(modulo(i - 1, rays_drawn), k), place(ray, k))
            path = path//merge('L', 'M', down)//at(view, place(ray, k))
            down = .true.
         end do
         if (len(path) > 0) call text%add('<path class="'//class//'" d="'//path//'"/>')
      end do
      do i = 0, rays_drawn - 1
         if (.not. all(there(i, :))) cycle
         if (all(there(modulo(i - 1, rays_drawn), :)) .and. all(there(modulo(i + 1, rays_drawn), :))) cycle
         if (is_near(place(i, 1), place(i, 2))) call text%add('<path class="'//class//'" d="M'//at(view, place(i, 1))//'L'// &
                                                             at(view, place(i, 2))//'"/>')
      end do

   contains

      !> False if a line between two points would be one that the curve has not.
      pure logical function is_near(from, to)
         complex(wp), intent(in) :: from, to

         is_near = abs(to - from) < 0.5_wp*view%half
      end function is_near
   end subroutine draw_curve

   subroutine draw_linkage(l, view, text)
      type(exact_linkage_t), intent(in) :: l
      type(view_t), intent(in) :: view
      type(text_t), intent(inout) :: text
      character(:), allocatable :: path

      path = 'M'//at(view, l%a)//'L'//at(view, l%c(1))
      if (.not. (l%slides .or. l%swings)) path = path//'M'//at(view, l%b)//'L'//at(view, l%d(1))
      call text%add('<path class="link" d="'//path//'"/><path class="link" d="M'//at(view, l%c(1))//'L'//at(view, l%d(1))//'L'// &
                    at(view, l%p(1))//'z"/>')
      call joint(l%a, 'fixed', 'A')
      if (.not. l%slides) call joint(l%b, 'fixed', 'B')
      call joint(l%c(1), 'joint', 'C')
      if (.not. l%swings) call joint(l%d(1), 'joint', 'D')

   contains

      subroutine joint(z, class, name)
         complex(wp), intent(in) :: z
         character(*), intent(in) :: class, name
         complex(wp) :: place

         place = in_pixels(view, z)
         call text%add('<circle class="'//class//'" cx="'//px(place%re)//'" cy="'//px(place%im)//'" r="4.5"/><text x="'// &
                       px(place%re + 7.0_wp)//'" y="'//px(place%im + 15.0_wp)//'">'//name//'</text>')
      end subroutine joint
   end subroutine draw_linkage

   !> The fixed line of a pin, or the body's line through a pivot.
   subroutine draw_slide(l, view, text)
      type(exact_linkage_t), intent(in) :: l
      type(view_t), intent(in) :: view
      type(text_t), intent(inout) :: text

      call text%add('<path class="slide" d="M'//at(view, l%d(1) - 4.0_wp*view%half*l%guide)//'L'// &
                    at(view, l%d(1) + 4.0_wp*view%half*l%guide)//'"/>')
   end subroutine draw_slide

   ! ---- the map -------------------------------------------------------------------------------------------------------

   !> Colours of all pairs of pivots: runs of one colour along each row, one path for each colour.
   subroutine draw_map(scene, text)
      type(pole_scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      type(text_t) :: paths(defect)
      real(wp) :: left, bottom, cell, x, y
      integer :: row, column, first, k, n

      left = margin + plane + gap
      bottom = header + map_size
      associate (map => scene%map)
         n = size(map%ray)
         cell = map_size/real(n, wp)
         do row = 1, n
            first = 1
            do column = 2, n + 1
               if (column <= n) then
                  if (colour(row, column) == colour(row, first)) cycle
               end if
               k = colour(row, first)
               if (k > 0) call paths(k)%add('M'//to_text(first - 1)//' '//to_text(n - row)//'h'//to_text(column - first)// &
                                            'v1h-'//to_text(column - first)//'z')
               first = column
            end do
         end do
      end associate
      call text%add('<g transform="translate('//px(left)//' '//px(header)//') scale('//short_number(cell)//')" '// &
                    'shape-rendering="crispEdges">')
      do k = 1, defect
         if (len(paths(k)%content()) > 0) call text%add('<path class="m'//to_text(k)//'" d="'//paths(k)%content()//'"/>')
      end do
      call text%add('</g>')
      do k = 0, 4
         x = left + 0.25_wp*real(k, wp)*map_size
         y = bottom - 0.25_wp*real(k, wp)*map_size
         call text%add('<path class="rule" d="M'//px(x)//' '//px(bottom)//'v'//px(merge(-map_size, 5.0_wp, k == 2))//'M'// &
                       px(left)//' '//px(y)//'h'//px(merge(map_size, -5.0_wp, k == 2))//'"/>')
         call text%add('<text class="small middle" x="'//px(x)//'" y="'//px(bottom + 18.0_wp)//'">'//tick(k)//'</text>')
         call text%add('<text class="small right" x="'//px(left - 9.0_wp)//'" y="'//px(y + 4.0_wp)//'">'//tick(k)//'</text>')
      end do
      call text%add('<rect class="box" x="'//px(left)//'" y="'//px(header)//'" width="'//px(map_size)//'" height="'// &
                    px(map_size)//'"/>')
      call text%add('<text class="small middle" x="'//px(left + 0.5_wp*map_size)//'" y="'//px(bottom + 38.0_wp)// &
                    '">one fixed pivot: its direction from P1'//to_text(scene%base)//', degrees, on branch 1 and branch 2</text>')
      call text%add('<text class="small middle" transform="translate('//px(left - 52.0_wp)//' '//px(bottom - 0.5_wp*map_size)// &
                    ') rotate(-90)">the other fixed pivot</text>')
      if (scene%has_best) then
         do k = 1, 2
            call text%add('<circle class="mark" cx="'//px(left + scene%at(k)/full_turn*map_size)//'" cy="'// &
                          px(bottom - scene%at(3 - k)/full_turn*map_size)//'" r="7"/>')
         end do
      end if
      call draw_key(left, bottom + 62.0_wp, text)

   contains

      !> Number of a colour, 0 where there is none.
      pure integer function colour(i, j)
         integer, intent(in) :: i, j

         colour = 0
         associate (class => scene%map%class(i, j))
            if (class == 0) return
            colour = defect
            if (class <= 2) colour = (class - 1)*shades + 1 + count(levels < scene%map%transmission(i, j))
         end associate
      end function colour

      pure function tick(k) result(words)
         integer, intent(in) :: k
         character(:), allocatable :: words

         words = to_text(modulo(90*k, 180))
         if (k == 2) words = '180|0'
         if (k == 4) words = '180'
      end function tick
   end subroutine draw_map

   subroutine draw_key(left, top, text)
      real(wp), intent(in) :: left, top
      type(text_t), intent(inout) :: text
      real(wp), parameter :: box = 44.0_wp, first = 150.0_wp
      character(*), parameter :: names(2) = [character(22) :: 'crank turns, at least', 'crank rocks, at least']
      integer :: i, k

      do i = 1, 2
         call text%add('<text class="small" x="'//px(left)//'" y="'//px(top + 20.0_wp*real(i - 1, wp) + 11.0_wp)//'">'// &
                       trim(names(i))//'</text>')
         do k = 1, shades
            call text%add('<rect class="m'//to_text((i - 1)*shades + k)//'" x="'//px(left + first + box*real(k - 1, wp))// &
                          '" y="'//px(top + 20.0_wp*real(i - 1, wp))//'" width="'//px(box)//'" height="14"/>')
         end do
      end do
      do k = 1, shades
         call text%add('<text class="small" x="'//px(left + first + box*real(k - 1, wp))//'" y="'//px(top + 52.0_wp)//'">'// &
                       short_number(merge(0.0_wp, levels(max(k - 1, 1)), k == 1))//'&#176;</text>')
      end do
      call text%add('<rect class="m'//to_text(defect)//'" x="'//px(left + first + box*real(shades, wp) + 16.0_wp)//'" y="'// &
                    px(top)//'" width="14" height="14"/><text class="small" x="'// &
                    px(left + first + box*real(shades, wp) + 36.0_wp)//'" y="'//px(top + 11.0_wp)//'">defect</text>')
      call text%add('<rect class="box" x="'//px(left + first + box*real(shades, wp) + 16.5_wp)//'" y="'//px(top + 20.5_wp)// &
                    '" width="13" height="13"/><text class="small" x="'//px(left + first + box*real(shades, wp) + 36.0_wp)// &
                    '" y="'//px(top + 31.0_wp)//'">no pivot</text>')
   end subroutine draw_key
end module psalm_pole_svg
