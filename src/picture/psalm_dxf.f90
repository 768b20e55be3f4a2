!> A scene as DXF (release 12, ASCII): one layer for each link, joints as circles, the output path as a polyline.
module psalm_dxf
   use psalm_kinds, only: wp
   use psalm_output_kind, only: motion_point, motion_angle
   use psalm_scene, only: scene_t
   use psalm_text, only: text_t, full_precision, to_text
   implicit none (type, external)
   private
   public :: write_dxf

   real(wp), parameter :: circle_part = 0.008_wp !! radius of a joint's circle, part of the view
   integer, parameter :: colours = 6             !! CAD colours 1 to 6 in turn

contains

   !> Append the drawing: the linkage at the reference position, in machine axes.
   subroutine write_dxf(scene, text)
      type(scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      real(wp) :: radius

      radius = circle_part*maxval(scene%high - scene%low)
      call group(0, 'SECTION')
      call group(2, 'HEADER')
      call group(9, '$ACADVER')
      call group(1, 'AC1009')
      call group(9, '$EXTMIN')
      call place(scene%low(1), scene%low(2))
      call group(9, '$EXTMAX')
      call place(scene%high(1), scene%high(2))
      call group(0, 'ENDSEC')
      call add_tables()
      call group(0, 'SECTION')
      call group(2, 'ENTITIES')
      call add_bars()
      call add_slides()
      call add_joints()
      call add_path()
      call add_wishes()
      if (allocated(scene%wheels)) call add_wheels()
      if (allocated(scene%edges)) call add_envelope()
      call group(0, 'ENDSEC')
      call group(0, 'EOF')

   contains

      subroutine group(code, value)
         integer, intent(in) :: code
         character(*), intent(in) :: value

         call text%add(to_text(code))
         call text%add(value)
      end subroutine group

      subroutine place(x, y)
         real(wp), intent(in) :: x, y

         call group(10, full_precision(x))
         call group(20, full_precision(y))
         call group(30, '0.0')
      end subroutine place

      subroutine add_tables()
         integer :: b

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
         call group(70, to_text(size(scene%bodies) + merge(6, 5, allocated(scene%edges))))
         call layer('FRAME', 8)
         do b = 1, size(scene%bodies)
            if (.not. scene%bodies(b)%frame) call layer(layer_of(b), modulo(b - 1, colours) + 1)
         end do
         call layer('JOINTS', 7)
         call layer('OUTPUT', 1)
         call layer('DESIRED', 5)
         call layer('SLIDES', 9)
         if (allocated(scene%edges)) call layer('ENVELOPE', 3)
         call group(0, 'ENDTAB')
         call group(0, 'ENDSEC')
      end subroutine add_tables

      subroutine layer(name, colour)
         character(*), intent(in) :: name
         integer, intent(in) :: colour

         call group(0, 'LAYER')
         call group(2, name)
         call group(70, '0')
         call group(62, to_text(colour))
         call group(6, 'CONTINUOUS')
      end subroutine layer

      !> Links are numbered as they come; the frame is one.
      function layer_of(body) result(name)
         integer, intent(in) :: body
         character(:), allocatable :: name

         if (body == 0) then
            name = 'SLIDES'
         else if (scene%bodies(body)%frame) then
            name = 'FRAME'
         else
            name = 'LINK_'//to_text(count(.not. scene%bodies(:body)%frame))
         end if
      end function layer_of

      subroutine line(name, x1, y1, x2, y2)
         character(*), intent(in) :: name
         real(wp), intent(in) :: x1, y1, x2, y2

         call group(0, 'LINE')
         call group(8, name)
         call place(x1, y1)
         call group(11, full_precision(x2))
         call group(21, full_precision(y2))
         call group(31, '0.0')
      end subroutine line

      subroutine add_bars()
         integer :: b

         associate (row => scene%prescribed, i => scene%reference)
            do b = 1, size(scene%bars)
               associate (bar => scene%bars(b))
                  if (bar%start == bar%finish) cycle
                  if (.not. (row%known(bar%start, i) .and. row%known(bar%finish, i))) cycle
                  call line(layer_of(bar%body), row%x(bar%start, i), row%y(bar%start, i), row%x(bar%finish, i), &
                            row%y(bar%finish, i))
               end associate
            end do
         end associate
      end subroutine add_bars

      !> The rail of each slide.
      subroutine add_slides()
         real(wp) :: x, y, ux, uy
         integer :: s

         associate (row => scene%prescribed, i => scene%reference)
            do s = 1, size(scene%slides)
               associate (slide => scene%slides(s))
                  if (.not. (row%known(slide%guide, i) .and. row%known(slide%block, i))) cycle
                  x = row%x(slide%guide, i)
                  y = row%y(slide%guide, i)
                  ux = slide%sense*row%ux(s, i)
                  uy = slide%sense*row%uy(s, i)
                  call line('SLIDES', x + slide%low*ux, y + slide%low*uy, x + slide%high*ux, y + slide%high*uy)
               end associate
            end do
         end associate
      end subroutine add_slides

      subroutine add_joints()
         integer :: j

         associate (row => scene%prescribed, i => scene%reference)
            do j = 1, size(scene%joints)
               if (len(scene%joints(j)%name) == 0 .or. .not. row%known(j, i)) cycle
               call group(0, 'CIRCLE')
               call group(8, 'JOINTS')
               call place(row%x(j, i), row%y(j, i))
               call group(40, full_precision(radius))
               call group(0, 'TEXT')
               call group(8, 'JOINTS')
               call place(row%x(j, i) + 1.6_wp*radius, row%y(j, i) + 1.6_wp*radius)
               call group(40, full_precision(2.5_wp*radius))
               call group(1, scene%joints(j)%name)
            end do
         end associate
      end subroutine add_joints

      !> The output point at the prescribed positions: a point each, and a polyline through each run of closed ones. With
      !> MOTION 1 a line along the direction of the output arc at each position.
      subroutine add_path()
         integer :: i
         logical :: open

         associate (row => scene%prescribed)
            if (scene%motion == motion_angle) then
               do i = 1, row%n
                  if (row%closed(i)) call line('OUTPUT', row%x(scene%output_base, i), row%y(scene%output_base, i), &
                                               row%aim(1, i), row%aim(2, i))
               end do
            end if
            do i = 1, row%n
               if (.not. row%known(scene%output, i)) cycle
               if (allocated(scene%meshes) .and. i /= scene%reference) cycle
               call group(0, 'POINT')
               call group(8, 'OUTPUT')
               call place(row%x(scene%output, i), row%y(scene%output, i))
            end do
         end associate
         if (allocated(scene%meshes)) return   ! the way through a grid is no path
         associate (row => scene%sweep)
            open = .false.
            do i = 1, row%n
               if (row%known(scene%output, i)) then
                  if (.not. open) call begin_polyline('OUTPUT', all(row%known(scene%output, :)) .and. .not. scene%sliding)
                  open = .true.
                  call vertex('OUTPUT', row%x(scene%output, i), row%y(scene%output, i))
               else if (open) then
                  call group(0, 'SEQEND')
                  open = .false.
               end if
            end do
            if (open) call group(0, 'SEQEND')
         end associate
      end subroutine add_path

      subroutine begin_polyline(name, ring)
         character(*), intent(in) :: name
         logical, intent(in) :: ring

         call group(0, 'POLYLINE')
         call group(8, name)
         call group(66, '1')
         call place(0.0_wp, 0.0_wp)
         call group(70, merge('1', '0', ring))
      end subroutine begin_polyline

      subroutine vertex(name, x, y)
         character(*), intent(in) :: name
         real(wp), intent(in) :: x, y

         call group(0, 'VERTEX')
         call group(8, name)
         call place(x, y)
      end subroutine vertex

      !> Pitch circles of gear wheels.
      subroutine add_wheels()
         integer :: w

         associate (row => scene%prescribed, i => scene%reference)
            do w = 1, size(scene%wheels)
               associate (wheel => scene%wheels(w))
                  if (.not. row%known(wheel%centre, i)) cycle
                  call group(0, 'CIRCLE')
                  call group(8, layer_of(wheel%body))
                  call place(row%x(wheel%centre, i), row%y(wheel%centre, i))
                  call group(40, full_precision(wheel%radius))
               end associate
            end do
         end associate
      end subroutine add_wheels

      !> What the output reaches: a polyline for each drive and each of the ends of the others.
      subroutine add_envelope()
         integer :: e, i

         do e = 1, size(scene%edges)
            associate (edge => scene%edges(e))
               call begin_polyline('ENVELOPE', .false.)
               do i = 1, size(edge%x)
                  call vertex('ENVELOPE', edge%x(i), edge%y(i))
               end do
               call group(0, 'SEQEND')
            end associate
         end do
      end subroutine add_envelope

      subroutine add_wishes()
         integer :: i

         if (.not. scene%desired) return
         associate (row => scene%prescribed)
            do i = 1, row%n
               if (scene%motion /= motion_point .and. .not. row%closed(i)) cycle
               if (scene%motion == motion_angle) then
                  call line('DESIRED', row%x(scene%output_base, i), row%y(scene%output_base, i), row%wish(1, i), row%wish(2, i))
               else
                  call group(0, 'POINT')
                  call group(8, 'DESIRED')
                  call place(row%wish(1, i), row%wish(2, i))
               end if
            end do
         end associate
      end subroutine add_wishes
   end subroutine write_dxf
end module psalm_dxf
