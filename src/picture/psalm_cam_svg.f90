!> Cams as SVG: profile, pitch curve, cutter path, follower, push, shaft and linkage at cam angle 0; below output, velocity,
!> acceleration, jerk, pressure angle and curvature of the profile over the turn.
module psalm_cam_svg
   use psalm_cam_profile, only: cam_axes_t, in_machine
   use psalm_cam_scene, only: cam_part_t, cam_scene_t
   use psalm_column_names, only: rate_unit
   use psalm_cam_study, only: cam_study_t, role_cam, role_outer_wall
   use psalm_kinds, only: wp, full_turn
   use psalm_markup, only: short_number, xml_text
   use psalm_svg_panel, only: plot_panel_t, begin_picture, draw_axes, draw_curve, draw_level, px
   use psalm_text, only: text_t
   use psalm_trace, only: rail_ends
   implicit none (type, external)
   private
   public :: write_cam_svg

   real(wp), parameter :: width = 860.0_wp, tallest = 680.0_wp, margin = 40.0_wp, header = 56.0_wp !! sizes, pixels
   real(wp), parameter :: panel_height = 100.0_wp, gap = 66.0_wp, axis = 72.0_wp, joint_radius = 4.0_wp
   real(wp), parameter :: push_length = 46.0_wp, contact_radius = 3.0_wp, ground_width = 8.0_wp, ground_height = 13.0_wp
   real(wp), parameter :: beside = 7.0_wp      !! from a joint to its name
   real(wp), parameter :: near_limit = 5.0_wp  !! degrees from the values: a limit is drawn
   character(*), parameter :: names(0:3) = [character(17) :: 'output', 'first derivative', 'second derivative', 'third derivative']
   real(wp), parameter :: tick = 90.0_wp       !! degrees of the cam between marks
   integer, parameter :: panels = 6
   character(*), parameter :: own_style = &
      'path,circle{vector-effect:non-scaling-stroke}.profile{stroke-width:2.2;fill:$link1;fill-opacity:.14}'// &
      '.wall{stroke-width:2.2}.pitch{stroke:$ghost;stroke-dasharray:6 4}.cutter{stroke:$link2;stroke-width:.8}'// &
      '.follower{stroke:$accent;stroke-width:1.8}.shaft{stroke:$actual}.bar{stroke:$frame;stroke-width:2.2}'// &
      '.joint{fill:$paper;stroke-width:1.2}.ground{stroke:$frame}.rail{stroke:$line;stroke-width:6}'// &
      '.plate{fill:$frame;fill-opacity:.12;stroke:none}.push{stroke:$actual}circle.push{fill:$actual}'// &
      '.push.steep{stroke:$bad}circle.push.steep{fill:$bad}'

contains

   !> Append the picture.
   subroutine write_cam_svg(title, studies, scene, text)
      character(*), intent(in) :: title
      type(cam_study_t), intent(in) :: studies(:)    !! the cam, its conjugate or the outer wall of its track; the second cam
      type(cam_scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      complex(wp) :: middle, offset
      real(wp) :: scale, reach, height, size_of_scene(2), shown
      integer :: k, i

      middle = 0.5_wp*(scene%low + scene%high)
      size_of_scene = [real(scene%high - scene%low, wp), aimag(scene%high - scene%low)]
      scale = min((width - 2.0_wp*margin)/size_of_scene(1), (tallest - 2.0_wp*margin)/size_of_scene(2))
      shown = scale*size_of_scene(2) + 2.0_wp*margin
      reach = maxval(abs(studies(1)%points%profile))
      height = header + shown + real(panels, wp)*(panel_height + gap)*real(count(studies%part%role == role_cam), wp) + margin
      call begin_picture(title, width, height, own_style, text)
      call text%add('<g transform="translate('//px(0.5_wp*width)//' '//px(header + 0.5_wp*shown)//') scale('// &
                    short_number(scale)//' '//short_number(-scale)//') translate('//short_number(-middle%re)//' '// &
                    short_number(-middle%im)//')">')
      do k = 1, size(studies)
         associate (part => scene%parts(k), shape => studies(k)%shape, role => studies(k)%part%role)
            offset = shape%axes%centre
            call outline(trim(merge('wall   ', 'profile', role == role_outer_wall)), part%profile, .true.)
            if (.not. shape%flat .and. role /= role_outer_wall) call outline('pitch', part%pitch, .not. shape%axes%slides)
            if (role /= role_outer_wall) call outline('cutter', part%cutter, .not. shape%axes%slides)
            call line('shaft', cmplx(-0.08_wp*reach, 0.0_wp, wp), cmplx(0.08_wp*reach, 0.0_wp, wp))
            call line('shaft', cmplx(0.0_wp, -0.08_wp*reach, wp), cmplx(0.0_wp, 0.08_wp*reach, wp))
            if (shape%flat) then
               call line('follower', part%points%pitch(1) - reach*part%points%tangent(1), &
                         part%points%pitch(1) + reach*part%points%tangent(1))
            else if (role /= role_outer_wall) then
               call line('follower', part%arm(1) - offset, part%states%c(0, 1) - offset)
               call circle('follower', part%states%c(0, 1) - offset, max(shape%roller, 2.0_wp/scale))
               if (size(part%second) > 0) then
                  call line('follower', part%second_arm(1) - offset, part%second(1) - offset)
                  call circle('follower', part%second(1) - offset, max(studies(k)%other%roller, 2.0_wp/scale))
               end if
            end if
            if (role /= role_outer_wall) call push(shape%axes, part, abs(part%points%pressure(1)) > studies(k)%cam%pressure_angle)
         end associate
      end do
      offset = (0.0_wp, 0.0_wp)
      associate (linkage => scene%linkage, row => scene%linkage%prescribed)
         if (linkage%valid) then
            do i = 1, size(linkage%slides)
               if (row%known(linkage%slides(i)%guide, 1)) call rail(rail_ends(row, linkage%slides, i, 1))
            end do
            do i = 1, size(linkage%bodies)
               if (.not. linkage%bodies(i)%frame) call plate(linkage%bodies(i)%hull, row%x(:, 1), row%y(:, 1))
            end do
            do i = 1, size(linkage%bars)
               associate (from => linkage%bars(i)%start, to => linkage%bars(i)%finish)
                  if (.not. (linkage%joints(from)%fixed .and. linkage%joints(to)%fixed)) &
                     call line('bar', cmplx(row%x(from, 1), row%y(from, 1), wp), cmplx(row%x(to, 1), row%y(to, 1), wp))
               end associate
            end do
            do i = 1, size(linkage%joints)
               if (linkage%joints(i)%fixed) call ground(cmplx(row%x(i, 1), row%y(i, 1), wp))
               if (linkage%joints(i)%turning) call circle('joint', cmplx(row%x(i, 1), row%y(i, 1), wp), joint_radius/scale)
            end do
         end if
      end associate
      call text%add('</g>')
      associate (linkage => scene%linkage, row => scene%linkage%prescribed)
         if (linkage%valid) then
            do i = 1, size(linkage%joints)
               call letter(linkage%joints(i)%name, cmplx(row%x(i, 1), row%y(i, 1), wp))
            end do
         end if
      end associate
      i = 0
      do k = 1, size(studies)
         if (studies(k)%part%role /= role_cam) cycle
         call curves(studies(k), scene%parts(k), merge('second cam, ', '            ', studies(k)%part%cam == 2), i)
      end do
      call text%add('</svg>')

   contains

      pure function pair(point) result(numbers)
         complex(wp), intent(in) :: point
         character(:), allocatable :: numbers

         numbers = short_number(real(point, wp))//' '//short_number(aimag(point))
      end function pair

      !> A curve through the points of the table.
      subroutine outline(class, points, closed)
         character(*), intent(in) :: class
         complex(wp), intent(in) :: points(:)
         logical, intent(in) :: closed
         integer :: i

         call text%add('<path class="'//class//'" d="M'//pair(points(1) + offset))
         do i = 2, size(points)
            call text%add('L'//pair(points(i) + offset))
         end do
         call text%add(trim(merge('Z"/>', '"/> ', closed)))
      end subroutine outline

      subroutine line(class, from, to)
         character(*), intent(in) :: class
         complex(wp), intent(in) :: from, to

         call text%add('<path class="'//class//'" d="M'//pair(from + offset)//'L'//pair(to + offset)//'"/>')
      end subroutine line

      subroutine circle(class, centre, radius)
         character(*), intent(in) :: class
         complex(wp), intent(in) :: centre
         real(wp), intent(in) :: radius

         call text%add('<circle class="'//class//'" cx="'//short_number(real(centre + offset, wp))//'" cy="'// &
                       short_number(aimag(centre + offset))//'" r="'//short_number(radius)//'"/>')
      end subroutine circle

      !> Where the cam touches the follower, and the direction in which it pushes.
      subroutine push(axes, part, steep)
         type(cam_axes_t), intent(in) :: axes
         type(cam_part_t), intent(in) :: part
         logical, intent(in) :: steep                !! beyond the limit of the pressure angle
         character(:), allocatable :: look

         look = trim(merge('push steep', 'push      ', steep))
         associate (contact => in_machine(axes, part%states%angle(1), part%points%profile(1), part%points%machine(1)) - offset)
            call line(look, contact, contact + push_length/scale*part%points%normal(1)*part%points%machine(1))
            call circle(look, contact, contact_radius/scale)
         end associate
      end subroutine push

      !> What a slide runs on.
      subroutine rail(ends)
         real(wp), intent(in) :: ends(:, :)          !! shape (2, 2): x and y of both ends

         call line('rail', cmplx(ends(1, 1), ends(2, 1), wp), cmplx(ends(1, 2), ends(2, 2), wp))
      end subroutine rail

      !> A link with three joints or more.
      subroutine plate(hull, x, y)
         integer, intent(in) :: hull(:)              !! joints round it
         real(wp), intent(in) :: x(:), y(:)          !! shape (joints)
         integer :: i

         if (size(hull) < 3) return
         call text%add('<path class="plate" d="M')
         do i = 1, size(hull)
            call text%add(merge('L', ' ', i > 1)//pair(cmplx(x(hull(i)), y(hull(i)), wp)))
         end do
         call text%add('Z"/>')
      end subroutine plate

      !> A fixed joint stands on a triangle.
      subroutine ground(point)
         complex(wp), intent(in) :: point
         complex(wp) :: left, right

         left = point + cmplx(-ground_width, -ground_height, wp)/scale
         right = point + cmplx(ground_width, -ground_height, wp)/scale
         call text%add('<path class="ground" d="M'//pair(point)//'L'//pair(left)//'L'//pair(right)//'Z"/>')
      end subroutine ground

      !> The name of a joint beside it, not mirrored.
      subroutine letter(name, point)
         character(*), intent(in) :: name
         complex(wp), intent(in) :: point

         if (len_trim(name) == 0) return
         call text%add('<text class="small" x="'//px(0.5_wp*width + scale*real(point - middle, wp) + beside)//'" y="'// &
                       px(header + 0.5_wp*shown - scale*aimag(point - middle) - beside)//'">'//xml_text(trim(name))//'</text>')
      end subroutine letter

      !> The panels of a cam, under those that are there.
      subroutine curves(study, part, prefix, drawn)
         type(cam_study_t), intent(in) :: study
         type(cam_part_t), intent(in) :: part
         character(*), intent(in) :: prefix
         integer, intent(inout) :: drawn
         character(:), allocatable :: unit
         real(wp) :: limits(2)
         integer :: order

         do order = 0, 3
            unit = rate_unit(study%shape%motion%angular, 'rad', order)
            if (study%shape%motion%angular .and. order == 0) unit = 'degrees'
            call curve(drawn + order + 1, trim(adjustl(prefix//names(order)))//', '//unit, study, part%states%y(order, :), &
                       [real(wp) ::])
         end do
         limits = [-study%cam%pressure_angle, study%cam%pressure_angle]
         associate (values => part%points%pressure)
            call curve(drawn + 5, trim(adjustl(prefix//'pressure angle, degrees')), study, values, &
                       pack(limits, limits > minval(values) - near_limit .and. limits < maxval(values) + near_limit))
         end associate
         call curve(drawn + panels, trim(adjustl(prefix//'curvature of the profile, 1/length')), study, 1.0_wp/part%points%radius, &
                    [real(wp) ::])
         drawn = drawn + panels
      end subroutine curves

      !> One panel: a curve over the cam angle between its least and greatest value, with limits.
      subroutine curve(number, name, study, values, limits)
         integer, intent(in) :: number
         character(*), intent(in) :: name
         type(cam_study_t), intent(in) :: study
         real(wp), intent(in) :: values(:), limits(:)
         type(plot_panel_t) :: panel
         real(wp) :: low, high
         integer :: i, n

         low = min(minval(values), minval(limits))
         high = max(maxval(values), maxval(limits))
         if (.not. high > low) then
            low = low - 1.0_wp
            high = high + 1.0_wp
         end if
         panel = plot_panel_t(axis, header + shown + real(number - 1, wp)*(panel_height + gap) + gap, width - axis - margin, &
                         panel_height, 0.0_wp, full_turn, low, high)
         call draw_axes(panel, name//': '//px(minval(values))//' to '//px(maxval(values)), tick, text, &
                        'cam angle, degrees')
         do i = 1, size(limits)
            call draw_level(panel, 'limit', limits(i), text)
         end do
         n = size(values)
         if (study%shape%axes%slides) then      ! its curves have two ends
            call draw_curve(panel, 'curve', [(full_turn*real(i, wp)/real(n - 1, wp), i=0, n - 1)], values, text)
         else
            call draw_curve(panel, 'curve', [(full_turn*real(i, wp)/real(n, wp), i=0, n)], [values, values(1)], text)
         end if
      end subroutine curve
   end subroutine write_cam_svg
end module psalm_cam_svg
