!> Cams as DXF (release 12, ASCII): curves as polylines of arcs (bulges) on named layers, in axes of the first cam at cam angle 0;
!> beside them the linkage.
module psalm_cam_dxf
   use psalm_cam_paths, only: cam_path_t, path_pitch, path_profile, path_cutter
   use psalm_cam_study, only: cam_study_t, role_cam
   use psalm_kinds, only: wp
   use psalm_scene, only: scene_t
   use psalm_text, only: text_t, full_precision, to_text
   implicit none (type, external)
   private
   public :: write_cam_dxf

   real(wp), parameter :: joint_part = 0.008_wp !! radius of a joint's circle, of the linkage's size
   integer, parameter :: white = 7, red = 1, green = 3, blue = 5, grey = 8, cyan = 4, magenta = 6 !! CAD colours

contains

   !> Append the drawing, the cam at angle 0.
   subroutine write_cam_dxf(studies, linkage, text)
      type(cam_study_t), intent(in) :: studies(:)    !! the cam, its conjugate or the outer wall of its track; the second cam
      type(scene_t), intent(in) :: linkage           !! its first prescribed position is that of cam angle 0
      type(text_t), intent(inout) :: text
      complex(wp) :: offset                          !! of what is drawn from the first cam's axes
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
      call group(70, '11')
      call layer('PITCH', grey)
      call layer('PROFILE', white)
      call layer('PROFILE_2', magenta)
      call layer('CUTTER', green)
      call layer('FOLLOWER_0', blue)
      call layer('SHAFT', red)
      call layer('CENTRES', cyan)
      call layer('PITCH_2', grey)
      call layer('CUTTER_2', green)
      call layer('LINKAGE', white)
      call layer('JOINTS', grey)
      call group(0, 'ENDTAB')
      call group(0, 'ENDSEC')
      call group(0, 'SECTION')
      call group(2, 'ENTITIES')
      do k = 1, size(studies)
         offset = studies(k)%shape%axes%centre - studies(1)%shape%axes%centre
         call add_cam(studies(k))
         if (studies(k)%part%role /= role_cam) cycle
         call line('SHAFT', (-1.0_wp, 0.0_wp)*mark_size(), (1.0_wp, 0.0_wp)*mark_size())
         call line('SHAFT', (0.0_wp, -1.0_wp)*mark_size(), (0.0_wp, 1.0_wp)*mark_size())
      end do
      offset = -studies(1)%shape%axes%centre
      if (linkage%valid) call add_linkage()
      call group(0, 'ENDSEC')
      call group(0, 'EOF')

   contains

      subroutine add_cam(study)
         type(cam_study_t), intent(in) :: study
         complex(wp) :: at
         character(:), allocatable :: second
         integer :: i

         second = trim(merge('_2', '  ', study%part%cam == 2))
         if (.not. study%shape%flat) call curve('PITCH'//second, study%paths(path_pitch), study%points%pitch, &
                                                 study%shape%axes%slides)
         call curve(trim(merge('PROFILE  ', 'PROFILE_2', study%part%role == role_cam .and. study%part%cam == 1)), &
                    study%paths(path_profile), study%points%profile, study%shape%axes%slides)
         call curve('CUTTER'//second, study%paths(path_cutter), study%points%cutter, study%shape%axes%slides)
         at = study%points%pitch(1)
         if (study%shape%flat) then
            call line('FOLLOWER_0', at + study%points%tangent(1)*(study%shape%roller + abs(at)), &
                      at - study%points%tangent(1)*(study%shape%roller + abs(at)))
         else if (study%shape%roller > 0.0_wp) then
            call circle('FOLLOWER_0', at, study%shape%roller)
         end if
         if (study%part%role /= role_cam .or. study%shape%flat) return
         do i = 1, size(study%centres)
            if (size(study%centres(i)%corners) > 0) call polygon(study%centres(i)%corners - study%shape%axes%centre)
         end do
      end subroutine add_cam

      !> Bars and revolute joints at cam angle 0.
      subroutine add_linkage()
         integer :: i

         associate (row => linkage%prescribed)
            do i = 1, size(linkage%bars)
               associate (from => linkage%bars(i)%start, to => linkage%bars(i)%finish)
                  call line('LINKAGE', cmplx(row%x(from, 1), row%y(from, 1), wp), cmplx(row%x(to, 1), row%y(to, 1), wp))
               end associate
            end do
            do i = 1, size(linkage%joints)
               if (linkage%joints(i)%turning) call circle('JOINTS', cmplx(row%x(i, 1), row%y(i, 1), wp), &
                                                          joint_part*maxval(linkage%high - linkage%low))
            end do
         end associate
      end subroutine add_linkage

      !> Where the centre of the cam may lie, seen from where it is.
      subroutine polygon(corners)
         complex(wp), intent(in) :: corners(:)
         integer :: i

         call group(0, 'POLYLINE')
         call group(8, 'CENTRES')
         call group(66, '1')
         call place(-offset)
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

         call group(10, full_precision(real(point + offset, wp)))
         call group(20, full_precision(aimag(point + offset)))
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
         call group(11, full_precision(real(to + offset, wp)))
         call group(21, full_precision(aimag(to + offset)))
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

      !> A polyline, closed unless the cam slides: arcs, or where there are none the points of the table.
      subroutine curve(name, path, points, open)
         character(*), intent(in) :: name
         type(cam_path_t), intent(in) :: path
         complex(wp), intent(in) :: points(:)
         logical, intent(in) :: open
         integer :: i

         call group(0, 'POLYLINE')
         call group(8, name)
         call group(66, '1')
         call place(-offset)
         call group(70, trim(merge('0', '1', open)))
         if (path%found) then
            do i = 1, size(path%arcs)
               call vertex(name, path%arcs(i)%start, path%arcs(i)%bulge)
            end do
            if (open) call vertex(name, path%arcs(size(path%arcs))%finish, 0.0_wp)
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
