!> A cam as DXF (release 12, ASCII): curves as polylines of arcs (bulges) on named layers, in axes of the cam.
module psalm_cam_dxf
   use psalm_cam_paths, only: cam_path_t, path_pitch, path_profile, path_cutter
   use psalm_cam_study, only: cam_study_t, role_cam
   use psalm_kinds, only: wp
   use psalm_text, only: text_t, full_precision, to_text
   implicit none (type, external)
   private
   public :: write_cam_dxf

   integer, parameter :: white = 7, red = 1, green = 3, blue = 5, grey = 8, cyan = 4, magenta = 6 !! CAD colours

contains

   !> Append the drawing, the cam at angle 0.
   subroutine write_cam_dxf(studies, text)
      type(cam_study_t), intent(in) :: studies(:)    !! the cam, and its conjugate or the outer wall of its track
      type(text_t), intent(inout) :: text
      integer :: k

      call group(0, 'SECTION')
      call group(2, 'HEADER')
      call group(9, '$ACADVER')
      call group(1, 'AC1009')
      call group(0, 'ENDSEC')
      call group(0, 'SECTION')
      call group(2, 'TABLES')
      call group(0, 'TABLE')
      call group(2, 'LTYPE')
      call group(70, '1')
      call group(0, 'LTYPE')
      call group(2, 'CONTINUOUS')
      call group(70, '0')
      call group(3, 'Solid line')
      call group(72, '65')
      call group(73, '0')
      call group(40, '0.0')
      call group(0, 'ENDTAB')
      call group(0, 'TABLE')
      call group(2, 'LAYER')
      call group(70, '7')
      call layer('PITCH', grey)
      call layer('PROFILE', white)
      call layer('PROFILE_2', magenta)
      call layer('CUTTER', green)
      call layer('FOLLOWER_0', blue)
      call layer('SHAFT', red)
      call layer('CENTRES', cyan)
      call group(0, 'ENDTAB')
      call group(0, 'ENDSEC')
      call group(0, 'SECTION')
      call group(2, 'ENTITIES')
      do k = 1, size(studies)
         call add_cam(studies(k))
      end do
      call line('SHAFT', (-1.0_wp, 0.0_wp)*mark_size(), (1.0_wp, 0.0_wp)*mark_size())
      call line('SHAFT', (0.0_wp, -1.0_wp)*mark_size(), (0.0_wp, 1.0_wp)*mark_size())
      call group(0, 'ENDSEC')
      call group(0, 'EOF')

   contains

      subroutine add_cam(study)
         type(cam_study_t), intent(in) :: study
         complex(wp) :: at
         integer :: i

         if (.not. study%shape%flat) call curve('PITCH', study%paths(path_pitch), study%points%pitch)
         call curve(trim(merge('PROFILE  ', 'PROFILE_2', study%part%role == role_cam)), study%paths(path_profile), study%points%profile)
         call curve('CUTTER', study%paths(path_cutter), study%points%cutter)
         at = study%points%pitch(1)
         if (study%shape%flat) then
            call line('FOLLOWER_0', at + study%points%tangent(1)*(study%shape%roller + abs(at)), &
                      at - study%points%tangent(1)*(study%shape%roller + abs(at)))
         else if (study%shape%roller > 0.0_wp) then
            call circle('FOLLOWER_0', at, study%shape%roller)
         end if
         if (study%part%role /= role_cam) return
         do i = 1, size(study%centres)
            if (size(study%centres(i)%corners) > 0 .and. .not. study%shape%flat) call polygon(study%centres(i)%corners - &
                                                                                          study%shape%axes%centre)
         end do
      end subroutine add_cam

      !> Where the centre of the cam may lie, seen from where it is.
      subroutine polygon(corners)
         complex(wp), intent(in) :: corners(:)
         integer :: i

         call group(0, 'POLYLINE')
         call group(8, 'CENTRES')
         call group(66, '1')
         call place((0.0_wp, 0.0_wp))
         call group(70, '1')
         do i = 1, size(corners)
            call vertex('CENTRES', corners(i), 0.0_wp)
         end do
         call group(0, 'SEQEND')
      end subroutine polygon

      !> Half of the cross at the shaft.
      pure real(wp) function mark_size()
         mark_size = 0.1_wp*maxval(abs(real(studies(1)%points%profile, wp)))
      end function mark_size

      subroutine group(code, value)
         integer, intent(in) :: code
         character(*), intent(in) :: value

         call text%add(to_text(code))
         call text%add(value)
      end subroutine group

      subroutine place(point)
         complex(wp), intent(in) :: point

         call group(10, full_precision(real(point, wp)))
         call group(20, full_precision(aimag(point)))
         call group(30, '0.0')
      end subroutine place

      subroutine layer(name, colour)
         character(*), intent(in) :: name
         integer, intent(in) :: colour

         call group(0, 'LAYER')
         call group(2, name)
         call group(70, '0')
         call group(62, to_text(colour))
         call group(6, 'CONTINUOUS')
      end subroutine layer

      subroutine line(name, from, to)
         character(*), intent(in) :: name
         complex(wp), intent(in) :: from, to

         call group(0, 'LINE')
         call group(8, name)
         call place(from)
         call group(11, full_precision(real(to, wp)))
         call group(21, full_precision(aimag(to)))
         call group(31, '0.0')
      end subroutine line

      subroutine circle(name, centre, radius)
         character(*), intent(in) :: name
         complex(wp), intent(in) :: centre
         real(wp), intent(in) :: radius

         call group(0, 'CIRCLE')
         call group(8, name)
         call place(centre)
         call group(40, full_precision(radius))
      end subroutine circle

      !> A closed polyline: arcs, or where there are none the points of the table.
      subroutine curve(name, path, points)
         character(*), intent(in) :: name
         type(cam_path_t), intent(in) :: path
         complex(wp), intent(in) :: points(:)
         integer :: i

         call group(0, 'POLYLINE')
         call group(8, name)
         call group(66, '1')
         call place((0.0_wp, 0.0_wp))
         call group(70, '1')
         if (path%found) then
            do i = 1, size(path%arcs)
               call vertex(name, path%arcs(i)%start, path%arcs(i)%bulge)
            end do
         else
            do i = 1, size(points)
               call vertex(name, points(i), 0.0_wp)
            end do
         end if
         call group(0, 'SEQEND')
      end subroutine curve

      subroutine vertex(name, point, bulge)
         character(*), intent(in) :: name
         complex(wp), intent(in) :: point
         real(wp), intent(in) :: bulge

         call group(0, 'VERTEX')
         call group(8, name)
         call place(point)
         if (abs(bulge) > 0.0_wp) call group(42, full_precision(bulge))
      end subroutine vertex
   end subroutine write_cam_dxf
end module psalm_cam_dxf
