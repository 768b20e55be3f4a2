!> A scene as DXF (release 12, ASCII): the linkage at one position, and its links laid flat.
!>
!> One layer for each link, under the user's name where it has one; plates are closed, joints are circles, the output path is a
!> polyline. Geometry is that of the computation, in machine axes; of a link laid flat, along its own longest line.
module psalm_dxf
   use psalm_dxf_group, only: dxf_group_t
   use psalm_dxf_text, only: dxf_t, layer_length
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_link_outline, only: outline_t, outline_of, spine_of
   use psalm_output_kind, only: motion_point, motion_angle
   use psalm_scene, only: scene_t
   use psalm_text, only: text_t, to_text, upper_case
   use psalm_tolerance_marks, only: tolerance_mark_t, list_marks, layer_of_tolerances
   use psalm_trace, only: position_row_t, rail_ends
   implicit none (type, external)
   private
   public :: write_dxf, write_flat_dxf

   real(wp), parameter :: circle_part = 0.008_wp !! radius of a joint's circle, part of the view, where PIN is not given
   real(wp), parameter :: gap_part = 0.04_wp     !! between links laid flat, part of the view
   real(wp), parameter :: away = 1.6_wp, height = 2.5_wp !! of a letter: place from its joint, height, radii of the circle
   real(wp), parameter :: beside = 0.5_wp        !! of a tolerance from its line, heights of its letters
   real(wp), parameter :: line_height = 1.6_wp   !! from line to line, heights of letters
   real(wp), parameter :: smaller = 0.7_wp       !! letters of tolerances, of those of joints
   integer, parameter :: colour_of_tolerances = 3
   integer, parameter :: colours = 6             !! CAD colours 1 to 6 in turn
   character(*), parameter :: fit = 'ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-$' !! for a layer's name in release 12

contains

   !> Append the drawing: the linkage at the position chosen, the reference position unless the group DXF says otherwise.
   subroutine write_dxf(scene, dxf, text)
      type(scene_t), intent(in) :: scene
      type(dxf_group_t), intent(in) :: dxf
      type(text_t), intent(inout) :: text
      type(dxf_t) :: drawing
      type(position_row_t), allocatable :: row
      type(tolerance_mark_t), allocatable :: marks(:)
      character(layer_length), allocatable :: layers(:)
      real(wp) :: radius
      integer :: at, b, below

      call choose_position(scene, dxf, row, at)
      layers = layer_names(scene)
      radius = radius_of(scene, dxf)
      call drawing%add_layer('FRAME', 8)
      do b = 1, size(scene%bodies)
         if (.not. scene%bodies(b)%frame) call drawing%add_layer(layers(b), modulo(b - 1, colours) + 1)
      end do
      call drawing%add_layer('JOINTS', 7)
      call drawing%add_layer('OUTPUT', 1)
      call drawing%add_layer('DESIRED', 5)
      call drawing%add_layer('SLIDES', 9)
      if (allocated(scene%edges)) call drawing%add_layer('ENVELOPE', 3)
      below = 0
      if (allocated(scene%allotted)) then
         call drawing%add_layer(layer_of_tolerances, colour_of_tolerances)
         call list_marks(scene, marks)
         below = count([(.not. has_place(marks(b)), b=1, size(marks))])
      end if
      call drawing%begin(scene%low - [0.0_wp, real(below, wp)*line_height*smaller*height*radius], scene%high, dxf%unit)
      call add_plates()
      call add_bars()
      call add_slides()
      call add_joints()
      if (allocated(marks)) call add_tolerances()
      call add_path()
      call add_targets()
      if (allocated(scene%wheels)) call add_wheels()
      if (allocated(scene%edges)) call add_envelope()
      call drawing%finish()
      call text%add_text(drawing%text%content())

   contains

      !> Closed outlines of the moving links: of plates through their joints, or of all links by their width.
      subroutine add_plates()
         integer, allocatable :: spine(:)
         type(outline_t) :: outline
         integer :: k

         do k = 1, size(scene%bodies)
            if (.not. has_outline(scene, k)) cycle
            associate (joints => scene%bodies(k)%joints)
               if (.not. all(row%known(joints, at))) cycle
               spine = spine_of(row%x(joints, at), row%y(joints, at))
               associate (width => width_of(scene, dxf, k))
                  if (size(spine) < 3 .and. width <= 0.0_wp) cycle
                  outline = outline_of(row%x(joints(spine), at), row%y(joints(spine), at), 0.5_wp*width)
               end associate
               if (width_of(scene, dxf, k) > 0.0_wp) then
                  call drawing%polyline(layers(k), outline%x, outline%y, .true., outline%bulge)
               else
                  call drawing%polyline(layers(k), outline%x, outline%y, .true.)
               end if
            end associate
         end do
      end subroutine add_plates

      !> Lines of the links, but those that are sides of a plate or covered by its width.
      subroutine add_bars()
         integer :: k

         do k = 1, size(scene%bars)
            associate (bar => scene%bars(k))
               if (bar%start == bar%finish) cycle
               if (.not. (row%known(bar%start, at) .and. row%known(bar%finish, at))) cycle
               if (bar%slide == 0 .and. bar%body > 0) then
                  if (is_side(bar%body, bar%start, bar%finish)) cycle
                  if (has_outline(scene, bar%body)) then
                     if (width_of(scene, dxf, bar%body) > 0.0_wp) cycle
                  end if
               end if
               if (bar%body == 0) then
                  call drawing%line('SLIDES', row%x(bar%start, at), row%y(bar%start, at), row%x(bar%finish, at), &
                                    row%y(bar%finish, at))
               else
                  call drawing%line(layers(bar%body), row%x(bar%start, at), row%y(bar%start, at), row%x(bar%finish, at), &
                                    row%y(bar%finish, at))
               end if
            end associate
         end do
      end subroutine add_bars

      !> True if two joints follow each other round a plate that is drawn.
      logical function is_side(body, start, finish)
         integer, intent(in) :: body, start, finish
         integer, allocatable :: spine(:)
         integer :: k

         is_side = .false.
         if (.not. has_outline(scene, body)) return
         associate (joints => scene%bodies(body)%joints)
            if (.not. all(row%known(joints, at))) return
            spine = spine_of(row%x(joints, at), row%y(joints, at))
            if (size(spine) < 3) return
            spine = joints(spine)
         end associate
         do k = 1, size(spine)
            associate (a => spine(k), b => spine(modulo(k, size(spine)) + 1))
               is_side = is_side .or. (a == start .and. b == finish) .or. (a == finish .and. b == start)
            end associate
         end do
      end function is_side

      !> The rail of each slide.
      subroutine add_slides()
         real(wp) :: ends(2, 2)
         integer :: s

         do s = 1, size(scene%slides)
            associate (slide => scene%slides(s))
               if (.not. (row%known(slide%guide, at) .and. row%known(slide%block, at))) cycle
               ends = rail_ends(row, scene%slides, s, at)
               call drawing%line('SLIDES', ends(1, 1), ends(2, 1), ends(1, 2), ends(2, 2))
            end associate
         end do
      end subroutine add_slides

      subroutine add_joints()
         integer :: j

         do j = 1, size(scene%joints)
            if (len(scene%joints(j)%name) == 0 .or. .not. row%known(j, at)) cycle
            if (scene%joints(j)%turning .or. scene%joints(j)%slides) then
               call drawing%circle('JOINTS', row%x(j, at), row%y(j, at), radius)
            else
               call drawing%point('JOINTS', row%x(j, at), row%y(j, at))
            end if
            call drawing%words('JOINTS', row%x(j, at) + away*radius, row%y(j, at) + away*radius, height*radius, &
                               scene%joints(j)%name)
         end do
      end subroutine add_joints

      !> True if a tolerance stands at joints that are drawn.
      pure logical function has_place(mark)
         type(tolerance_mark_t), intent(in) :: mark

         has_place = all(mark%joints > 0)
         if (has_place) has_place = all(row%known(mark%joints, at))
      end function has_place

      !> Dimensions with their tolerances, each at its line or its vertex; those that have none below the drawing.
      subroutine add_tolerances()
         real(wp) :: letters, placed(2, size(marks))
         integer :: k, listed

         letters = smaller*height*radius
         placed = huge(1.0_wp)
         listed = 0
         do k = 1, size(marks)
            associate (mark => marks(k))
               if (has_place(mark)) then
                  call write_mark(drawing, mark, [row%x(mark%joints(1), at), row%y(mark%joints(1), at)], &
                                  [row%x(mark%joints(2), at), row%y(mark%joints(2), at)], letters, rank_of(marks, k), placed(:, :k))
               else
                  listed = listed + 1
                  call drawing%words(layer_of_tolerances, scene%low(1), scene%low(2) - line_height*letters*real(listed, wp), &
                                     letters, mark%name//' '//mark%words)
               end if
            end associate
         end do
      end subroutine add_tolerances

      !> The output point at the prescribed positions: a point each, and a polyline through each run of closed ones. With
      !> MOTION 1 a line along the direction of the output arc at each position.
      subroutine add_path()
         integer :: i, first

         associate (every => scene%prescribed)
            if (scene%motion == motion_angle) then
               do i = 1, every%n
                  if (every%closed(i)) call drawing%line('OUTPUT', every%x(scene%output_base, i), &
                                                         every%y(scene%output_base, i), every%actual_mark(1, i), &
                                                         every%actual_mark(2, i))
               end do
            end if
            do i = 1, every%n
               if (.not. every%known(scene%output, i)) cycle
               if (allocated(scene%meshes) .and. i /= scene%reference) cycle
               call drawing%point('OUTPUT', every%x(scene%output, i), every%y(scene%output, i))
            end do
         end associate
         if (allocated(scene%meshes)) return   ! the way through a grid is no path
         associate (sweep => scene%sweep)
            first = 1
            do i = 1, sweep%n
               if (.not. sweep%known(scene%output, i)) then
                  first = i + 1
                  cycle
               end if
               if (i < sweep%n) then
                  if (sweep%known(scene%output, i + 1)) cycle
               end if
               call drawing%polyline('OUTPUT', sweep%x(scene%output, first:i), sweep%y(scene%output, first:i), &
                                     all(sweep%known(scene%output, :)) .and. .not. scene%sliding)
            end do
         end associate
      end subroutine add_path

      !> Pitch circles of gear wheels.
      subroutine add_wheels()
         integer :: w

         do w = 1, size(scene%wheels)
            associate (wheel => scene%wheels(w))
               if (row%known(wheel%centre, at)) call drawing%circle(layers(wheel%body), row%x(wheel%centre, at), &
                                                                    row%y(wheel%centre, at), wheel%radius)
            end associate
         end do
      end subroutine add_wheels

      !> What the output reaches: a polyline for each drive and each of the ends of the others.
      subroutine add_envelope()
         integer :: e

         do e = 1, size(scene%edges)
            call drawing%polyline('ENVELOPE', scene%edges(e)%x, scene%edges(e)%y, .false.)
         end do
      end subroutine add_envelope

      subroutine add_targets()
         integer :: i

         if (.not. scene%desired) return
         associate (every => scene%prescribed)
            do i = 1, every%n
               if (scene%motion /= motion_point .and. .not. every%closed(i)) cycle
               if (scene%motion == motion_angle) then
                  call drawing%line('DESIRED', every%x(scene%output_base, i), every%y(scene%output_base, i), &
                                    every%desired_mark(1, i), every%desired_mark(2, i))
               else
                  call drawing%point('DESIRED', every%desired_mark(1, i), every%desired_mark(2, i))
               end if
            end do
         end associate
      end subroutine add_targets
   end subroutine write_dxf

   !> Append the links laid flat, one above the other, the frame first: each along its longest line, with its outline, its holes,
   !> its rails and its name. For cutting and for dimensions.
   subroutine write_flat_dxf(scene, dxf, text)
      type(scene_t), intent(in) :: scene
      type(dxf_group_t), intent(in) :: dxf
      type(text_t), intent(inout) :: text
      type(dxf_t) :: drawing
      type(position_row_t), allocatable :: row
      type(outline_t), allocatable :: outlines(:)
      type(tolerance_mark_t), allocatable :: marks(:)
      character(layer_length), allocatable :: layers(:)
      integer, allocatable :: order(:)
      real(wp) :: origin(2, size(scene%bodies)), along(2, size(scene%bodies)), shift(2, size(scene%bodies))
      real(wp) :: radius, gap, top, widest
      integer :: at, b, k

      call choose_position(scene, dxf, row, at)
      layers = layer_names(scene)
      radius = radius_of(scene, dxf)
      gap = max(gap_part*maxval(scene%high - scene%low), maxval([(width_of(scene, dxf, b), b=1, size(scene%bodies))]))
      order = [pack([(b, b=1, size(scene%bodies))], scene%bodies%frame), pack([(b, b=1, size(scene%bodies))], &
                                                                              .not. scene%bodies%frame)]
      allocate (outlines(size(scene%bodies)))
      top = 0.0_wp
      widest = 0.0_wp
      do k = 1, size(order)
         b = order(k)
         if (.not. all(row%known(scene%bodies(b)%joints, at))) cycle
         call drawing%add_layer(layers(b), merge(8, modulo(b - 1, colours) + 1, scene%bodies(b)%frame))
         call lay_flat(b)
      end do
      call drawing%add_layer('HOLES', 7)
      call drawing%add_layer('POINTS', 1)
      call drawing%add_layer('SLIDES', 9)
      call drawing%add_layer('NAMES', 7)
      if (allocated(scene%allotted)) then
         call drawing%add_layer(layer_of_tolerances, colour_of_tolerances)
         call list_marks(scene, marks)
      end if
      call drawing%begin([0.0_wp, 0.0_wp], [widest, max(top - gap, 0.0_wp)], dxf%unit)
      do k = 1, size(order)
         if (allocated(outlines(order(k))%x)) call draw_link(order(k))
      end do
      call drawing%finish()
      call text%add_text(drawing%text%content())

   contains

      !> Axes of a link's drawing and its place above those before it.
      subroutine lay_flat(b)
         integer, intent(in) :: b
         integer, allocatable :: spine(:)
         real(wp) :: flat(2, size(scene%bodies(b)%joints)), farthest, length
         integer :: i, m

         associate (joints => scene%bodies(b)%joints)
            along(:, b) = [1.0_wp, 0.0_wp]
            origin(:, b) = [row%x(joints(1), at), row%y(joints(1), at)]
            farthest = 0.0_wp
            do i = 1, size(joints)
               do m = i + 1, size(joints)
                  length = hypotenuse(row%x(joints(m), at) - row%x(joints(i), at), row%y(joints(m), at) - row%y(joints(i), at))
                  if (length <= farthest) cycle
                  farthest = length
                  origin(:, b) = [row%x(joints(i), at), row%y(joints(i), at)]
                  along(:, b) = ([row%x(joints(m), at), row%y(joints(m), at)] - origin(:, b))/length
               end do
            end do
            shift(:, b) = 0.0_wp
            do i = 1, size(joints)
               flat(:, i) = turned(b, row%x(joints(i), at), row%y(joints(i), at))
            end do
            spine = spine_of(flat(1, :), flat(2, :))
            outlines(b) = outline_of(flat(1, spine), flat(2, spine), max(0.5_wp*width_of(scene, dxf, b), 0.0_wp))
            associate (half => max(0.5_wp*width_of(scene, dxf, b), radius))
               shift(:, b) = [half - minval(flat(1, :)), top + half - minval(flat(2, :))]
               top = top + maxval(flat(2, :)) - minval(flat(2, :)) + 2.0_wp*half + gap
               widest = max(widest, maxval(flat(1, :)) - minval(flat(1, :)) + 2.0_wp*half)
            end associate
            outlines(b)%x = outlines(b)%x + shift(1, b)
            outlines(b)%y = outlines(b)%y + shift(2, b)
         end associate
      end subroutine lay_flat

      !> A place of a link in its drawing.
      function turned(b, x, y) result(place)
         integer, intent(in) :: b
         real(wp), intent(in) :: x, y
         real(wp) :: place(2)

         associate (from => [x, y] - origin(:, b), u => along(:, b))
            place = [dot_product(from, u), u(1)*from(2) - u(2)*from(1)] + shift(:, b)
         end associate
      end function turned

      subroutine draw_link(b)
         integer, intent(in) :: b
         real(wp) :: place(2), ends(2, 2)
         real(wp), allocatable :: placed(:, :)
         integer :: i, s

         associate (joints => scene%bodies(b)%joints, outline => outlines(b))
            if (size(outline%x) == 2 .and. width_of(scene, dxf, b) <= 0.0_wp) then
               if (size(joints) > 1) call drawing%line(layers(b), outline%x(1), outline%y(1), outline%x(2), outline%y(2))
            else if (width_of(scene, dxf, b) > 0.0_wp) then
               call drawing%polyline(layers(b), outline%x, outline%y, .true., outline%bulge)
            else
               call drawing%polyline(layers(b), outline%x, outline%y, .true.)
            end if
            do i = 1, size(joints)
               place = turned(b, row%x(joints(i), at), row%y(joints(i), at))
               if (scene%joints(joints(i))%turning) then
                  call drawing%circle('HOLES', place(1), place(2), radius)
               else
                  call drawing%point('POINTS', place(1), place(2))
               end if
               if (len(scene%joints(joints(i))%name) > 0) &
                  call drawing%words('NAMES', place(1) + away*radius, place(2) + away*radius, height*radius, &
                                     scene%joints(joints(i))%name)
            end do
            do s = 1, size(scene%slides)
               associate (slide => scene%slides(s))
                  if (scene%bars(slide%bar)%body /= b .or. .not. row%known(slide%guide, at)) cycle
                  ends = rail_ends(row, scene%slides, s, at)
                  ends(:, 1) = turned(b, ends(1, 1), ends(2, 1))
                  ends(:, 2) = turned(b, ends(1, 2), ends(2, 2))
                  call drawing%line('SLIDES', ends(1, 1), ends(2, 1), ends(1, 2), ends(2, 2))
               end associate
            end do
            if (allocated(marks)) then
               allocate (placed(2, size(marks)), source=huge(1.0_wp))
               do i = 1, size(marks)
                  if (marks(i)%body /= b) cycle
                  ends(:, 1) = turned(b, row%x(marks(i)%joints(1), at), row%y(marks(i)%joints(1), at))
                  ends(:, 2) = turned(b, row%x(marks(i)%joints(2), at), row%y(marks(i)%joints(2), at))
                  call write_mark(drawing, marks(i), ends(:, 1), ends(:, 2), smaller*height*radius, rank_of(marks, i), &
                                  placed(:, :i))
               end do
            end if
            ! beyond the arc at the end
            call drawing%words('NAMES', maxval(outline%x) + 0.5_wp*width_of(scene, dxf, b) + 2.0_wp*radius, &
                               0.5_wp*(minval(outline%y) + maxval(outline%y)), height*radius, trim(layers(b)))
         end associate
      end subroutine draw_link
   end subroutine write_flat_dxf

   !> A dimension with its tolerance: along the line between two places, or under the first of them.
   subroutine write_mark(drawing, mark, from, to, letters, rank, placed)
      type(dxf_t), intent(inout) :: drawing
      type(tolerance_mark_t), intent(in) :: mark
      real(wp), intent(in) :: from(2), to(2), letters !! letters: their height
      integer, intent(in) :: rank                     !! among the angles at one place
      real(wp), intent(inout) :: placed(:, :)         !! shape (2, marks): where those before it are; its own comes last
      real(wp) :: along(2), aside(2), place(2), degrees
      integer :: k

      if (mark%angle) then
         call drawing%words(layer_of_tolerances, from(1) + letters, from(2) - line_height*letters*real(rank, wp) - letters, &
                            letters, mark%words)
         return
      end if
      along = to - from
      if (along(1) < 0.0_wp) along = -along             ! to be read from below
      along = along/max(norm2(along), tiny(1.0_wp))
      degrees = degrees_per_radian*atan2(along(2), along(1))
      aside = [-along(2), along(1)]
      place = 0.5_wp*(from + to) + beside*letters*aside
      do k = 1, size(placed, 2)
         if (.not. any(max(abs(placed(1, :) - place(1)), abs(placed(2, :) - place(2))) < line_height*letters)) exit
         place = place + line_height*letters*aside
      end do
      placed(:, size(placed, 2)) = place
      call drawing%words_along(layer_of_tolerances, place(1), place(2), letters, degrees, mark%words)
   end subroutine write_mark

   !> Number of an angle among those at its vertex, from 1.
   pure integer function rank_of(marks, k) result(rank)
      type(tolerance_mark_t), intent(in) :: marks(:)
      integer, intent(in) :: k
      integer :: i

      rank = 0
      do i = 1, k
         if (marks(i)%angle .and. marks(i)%joints(1) == marks(k)%joints(1)) rank = rank + 1
      end do
   end function rank_of

   !> The position that is drawn.
   subroutine choose_position(scene, dxf, row, at)
      type(scene_t), intent(in) :: scene
      type(dxf_group_t), intent(in) :: dxf
      type(position_row_t), allocatable, intent(out) :: row
      integer, intent(out) :: at

      at = scene%reference
      if (scene%chosen%n > 0) then
         allocate (row, source=scene%chosen)
         at = 1
         return
      end if
      if (dxf%position > 0) at = min(dxf%position, scene%prescribed%n)
      allocate (row, source=scene%prescribed)
   end subroutine choose_position

   !> Radius of the pins.
   pure real(wp) function radius_of(scene, dxf) result(radius)
      type(scene_t), intent(in) :: scene
      type(dxf_group_t), intent(in) :: dxf

      radius = circle_part*maxval(scene%high - scene%low)
      if (any(scene%bodies%hole > 0.0_wp)) radius = 0.5_wp*maxval(scene%bodies%hole)
      if (dxf%pin > 0.0_wp) radius = 0.5_wp*dxf%pin
   end function radius_of

   !> Width of a link: WIDTH of &DXF, else that of the plate it is cut from; 0: none.
   pure real(wp) function width_of(scene, dxf, body) result(width)
      type(scene_t), intent(in) :: scene
      type(dxf_group_t), intent(in) :: dxf
      integer, intent(in) :: body

      width = dxf%width
      if (.not. width > 0.0_wp) width = scene%bodies(body)%width
   end function width_of

   !> True if a link is drawn with its outline: a moving one, of a plate or with a width. Cylinders change their length.
   pure logical function has_outline(scene, body)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: body
      integer :: k

      has_outline = .not. scene%bodies(body)%frame .and. size(scene%bodies(body)%joints) > 0
      do k = 1, size(scene%bars)
         if (scene%bars(k)%body == body .and. scene%bars(k)%cylinder) has_outline = .false.
      end do
   end function has_outline

   !> Layers of the links: FRAME, LINK_ and the user's name if a layer can be called so, else LINK_ and a number as they come.
   pure function layer_names(scene) result(names)
      type(scene_t), intent(in) :: scene
      character(layer_length) :: names(size(scene%bodies))
      integer :: b

      do b = 1, size(scene%bodies)
         if (scene%bodies(b)%frame) then
            names(b) = 'FRAME'
            cycle
         end if
         names(b) = 'LINK_'//to_text(count(.not. scene%bodies(:b)%frame))
      end do
      do b = 1, size(scene%bodies)
         if (scene%bodies(b)%frame .or. .not. allocated(scene%bodies(b)%name)) cycle
         associate (name => 'LINK_'//upper_case(scene%bodies(b)%name))
            if (len(name) > layer_length .or. verify(name, fit) > 0 .or. any(names == name)) cycle
            names(b) = name
         end associate
      end do
   end function layer_names
end module psalm_dxf
