!> Joints and slides of a sketch at the positions of a block that its loops have been solved at, with their derivatives by time.
!>
!> A joint is a point of the plan, or fixed on a link at a distance from one; joints of the frame stand still.
module psalm_sketch_motion
   use psalm_angles, only: unit_vector
   use psalm_closure, only: most_orders
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_mechanism, only: mechanism_t, ring_t
   use psalm_place, only: place_t
   use psalm_rates, only: rates_t, derivatives_of, in_time
   use psalm_rows, only: rows_t
   use psalm_sketch, only: frame_link, most_wished
   implicit none (type, external)
   private
   public :: sketch_motion_t, locate_sketch, observe_sketch, find_places, find_changes, find_own_changes, &
             find_rate_changes, find_own_rate_changes

   !> A joint that moves.
   type :: moving_t
      integer :: joint = 0                  !! after the last joint of the sketch: points of its slides
      integer :: arc = 0                    !! sequential number: its direction carries the offset
      complex(wp) :: offset = (0.0_wp, 0.0_wp) !! from the point of the plan, in the axes of that arc, user's unit
   end type moving_t

   !> Where joints and slides of a sketch are to be found in the store.
   type :: sketch_motion_t
      complex(wp), allocatable :: drawn(:)  !! shape (joints), or joints and slides
      type(moving_t), allocatable :: moving(:)
      integer, allocatable :: points(:, :)  !! shape (2, moving joints): loop and arc, as `make_plan` has them
      integer, allocatable :: arcs(:)       !! by slide: sequential number; 0: it has none
      real(wp), allocatable :: sense(:), zero(:) !! by slide: travel = sense*length + zero
   end type sketch_motion_t

contains

   !> Find joints and slides. The plan must then be made with `points`. Joints of the frame are where they were drawn; with
   !> `dimensions` that are not, or not only, those of the drawing they are where these put them, and so is the first output.
   subroutine locate_sketch(set, mechanism, sketch, dimensions, with_slides, with_links)
      type(data_set_t), intent(in) :: set               !! a sketch with its loops
      type(mechanism_t), intent(in) :: mechanism
      type(sketch_motion_t), intent(out) :: sketch
      type(dimensions_t), intent(in), optional :: dimensions
      logical, intent(in), optional :: with_slides      !! after the joints come the points of slides, on their second links
      logical, intent(in), optional :: with_links       !! in place of slides: where the axes of links without joints begin
      type(place_t) :: place
      integer :: j, k

      sketch%drawn = cmplx(set%sketch%x, set%sketch%y, wp)
      allocate (sketch%moving(0), sketch%points(2, 0))
      do j = 1, size(set%traced%joint_places)
         place = set%traced%joint_places(j)
         if (place%link == frame_link .and. .not. present(dimensions)) cycle
         if (present(dimensions)) call move_output(set, dimensions, j, place)
         call add_moving(mechanism, j, place, sketch)
      end do
      if (present(with_slides)) then
         if (with_slides) then
            sketch%drawn = [sketch%drawn, cmplx(set%sketch%slides%x, set%sketch%slides%y, wp)]
            do k = 1, size(set%traced%shoes)
               call add_moving(mechanism, size(set%traced%joint_places) + k, set%traced%shoes(k), sketch)
            end do
         end if
      end if
      if (present(with_links)) then
         if (with_links) then
            associate (links => set%sketch%links)
               sketch%drawn = [sketch%drawn, [((0.0_wp, 0.0_wp), k=1, size(links))]]
               do k = 1, size(links)
                  if (k == frame_link .or. size(links(k)%joints) > 0) cycle
                  call add_moving(mechanism, size(set%traced%joint_places) + k, set%traced%link_places(k), sketch)
               end do
            end associate
         end if
      end if
      allocate (sketch%arcs(size(set%traced%travels)), source=0)
      do k = 1, size(set%traced%travels)
         if (set%traced%travels(k)%arc > 0) sketch%arcs(k) = mechanism%seq(set%traced%travels(k)%loop, set%traced%travels(k)%arc)
      end do
      sketch%sense = set%traced%travels%sense
      sketch%zero = set%traced%travels%zero
   end subroutine locate_sketch

   !> A joint at its place on an arc; one that is on none stands still.
   subroutine add_moving(mechanism, joint, place, sketch)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: joint
      type(place_t), intent(in) :: place
      type(sketch_motion_t), intent(inout) :: sketch
      type(moving_t) :: one
      type(ring_t) :: ring
      real(wp) :: c, s
      integer :: arc

      if (place%arc == 0) return
      one%joint = joint
      one%arc = mechanism%seq(place%loop, place%arc)
      call unit_vector(place%turn + place%angle, c, s)
      one%offset = place%distance*cmplx(c, s, wp)
      arc = place%arc
      if (place%from_start) then
         ring = mechanism%ring_of(place%loop, one%arc)
         arc = merge(0, arc - 1, one%arc == ring%first)
      end if
      sketch%moving = [sketch%moving, one]
      sketch%points = reshape([sketch%points, place%loop, arc], [2, size(sketch%moving)])
   end subroutine add_moving

   !> The output of the loops, if it stands off the arcs, where OUTLK and OUTANG have it: a search may vary these.
   subroutine move_output(set, dimensions, joint, place)
      type(data_set_t), intent(in) :: set
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: joint
      type(place_t), intent(inout) :: place             !! of that joint

      if (joint /= set%traced%output_joint .or. dimensions%outlk <= 0.0_wp) return
      associate (arc => set%traced%arcs(set%traced%output_arc))
         place%loop = arc%loop
         place%arc = arc%place
         place%from_start = set%traced%from_start
      end associate
      place%distance = dimensions%outlk
      place%angle = dimensions%outang
      place%turn = 0.0_wp
   end subroutine move_output

   !> Joints and slides at the first `n` positions of the block just solved and differentiated.
   subroutine observe_sketch(sketch, problem, rates, n, speed, accel, joint, moved)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: n
      real(wp), intent(in) :: speed, accel              !! of the input: radians or length a second
      complex(wp), intent(out) :: joint(:, 0:, :)       !! shape (joints, 0:most_orders, n): places and their derivatives by time
      real(wp), intent(out) :: moved(:, 0:, :)          !! shape (slides, 0:most_orders, n): travel from the drawing
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      complex(wp) :: z(most_orders), u
      real(wp) :: back, w(most_orders), x(most_orders), y(most_orders)
      integer :: k, m, row

      joint = (0.0_wp, 0.0_wp)
      moved = 0.0_wp
      call find_places(sketch, problem, n, joint(:, 0, :), moved(:, 0, :))
      associate (link => problem%linkage, plan => problem%plan)
         back = 1.0_wp/link%scale
         do k = 1, size(sketch%moving)
            associate (one => sketch%moving(k), point => plan%joint_points(k))
               do m = 1, n
                  x = derivatives_of(rates, link%point_x(point), m)*back
                  y = derivatives_of(rates, link%point_y(point), m)*back
                  z = cmplx(x, y, wp)
                  if (abs(one%offset) > 0.0_wp) then
                     u = offset_of(sketch, problem, k, m)
                     w = derivatives_of(rates, link%root_x(plan%root(one%arc)), m)
                     z(1) = z(1) + i*w(1)*u
                     z(2) = z(2) + cmplx(-w(1)**2, w(2), wp)*u
                     z(3) = z(3) + cmplx(-3.0_wp*w(1)*w(2), w(3) - w(1)**3, wp)*u
                  end if
                  joint(one%joint, 1:, m) = cmplx(in_time(z%re, speed, accel), in_time(z%im, speed, accel), wp)
               end do
            end associate
         end do
         do k = 1, size(sketch%arcs)
            if (sketch%arcs(k) == 0) cycle
            row = link%slide(plan%length_slot(sketch%arcs(k)))
            do m = 1, n
               moved(k, 1:, m) = sketch%sense(k)*in_time(derivatives_of(rates, row, m)*back, speed, accel)
            end do
         end do
      end associate
   end subroutine observe_sketch

   !> The places alone.
   subroutine find_places(sketch, problem, n, joint, moved)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: n
      complex(wp), intent(out) :: joint(:, :)           !! shape (joints, n)
      real(wp), intent(out) :: moved(:, :)              !! shape (slides, n)
      integer :: k, m

      moved = 0.0_wp
      associate (link => problem%linkage, plan => problem%plan)
         do m = 1, n
            joint(:, m) = sketch%drawn
            do k = 1, size(sketch%moving)
               joint(sketch%moving(k)%joint, m) = cmplx( &
                  link%store%v(m, link%point_x(plan%joint_points(k)))/link%scale + problem%output%origin_x, &
                  link%store%v(m, link%point_y(plan%joint_points(k)))/link%scale + problem%output%origin_y, wp) &
                  + offset_of(sketch, problem, k, m)
            end do
            do k = 1, size(sketch%arcs)
               if (sketch%arcs(k) == 0) cycle
               moved(k, m) = sketch%sense(k)*(link%store%v(m, link%slide(plan%length_slot(sketch%arcs(k))))/link%scale) &
                             + sketch%zero(k)
            end do
         end do
      end associate
   end subroutine find_places

   !> Changes of the places with a variable that changes the rows of the store by `d`.
   subroutine find_changes(sketch, problem, d, turn, origin, unit, n, joint, moved)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      type(rows_t), intent(in) :: d                     !! per radian of angles
      real(wp), intent(in) :: turn(:)                   !! shape (arcs): of their fixed angles
      complex(wp), intent(in) :: origin                 !! of the input pivot
      real(wp), intent(in) :: unit                      !! radians a unit of the variable is worth, or 1
      integer, intent(in) :: n
      complex(wp), intent(out) :: joint(:, :)           !! shape (joints, n)
      real(wp), intent(out) :: moved(:, :)              !! shape (slides, n)
      real(wp) :: back
      integer :: k, m

      joint = (0.0_wp, 0.0_wp)
      moved = 0.0_wp
      associate (link => problem%linkage, plan => problem%plan)
         back = unit/link%scale
         do m = 1, n
            do k = 1, size(sketch%moving)
               associate (one => sketch%moving(k), point => plan%joint_points(k))
                  joint(one%joint, m) = origin*unit + back*cmplx(d%v(m, link%point_x(point)), d%v(m, link%point_y(point)), wp) &
                                        + cmplx(0.0_wp, unit*(d%v(m, link%root_x(plan%root(one%arc))) + turn(one%arc)), wp) &
                                        *offset_of(sketch, problem, k, m)
               end associate
            end do
            do k = 1, size(sketch%arcs)
               if (sketch%arcs(k) == 0) cycle
               moved(k, m) = sketch%sense(k)*d%v(m, link%slide(plan%length_slot(sketch%arcs(k))))*back
            end do
         end do
      end associate
   end subroutine find_changes

   !> Changes of a joint's place with its own distance from the point of the plan, and with the angle of that line, by degrees.
   subroutine find_own_changes(sketch, problem, moving, position, along, across)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: moving                     !! of the joints that move: one with an offset
      integer, intent(in) :: position                   !! of the block
      complex(wp), intent(out) :: along, across
      complex(wp) :: u

      u = offset_of(sketch, problem, moving, position)
      along = u/abs(u)
      across = u*cmplx(0.0_wp, radians_per_degree, wp)
   end subroutine find_own_changes

   !> Changes of the places and of their derivatives by the input, with a variable that changes the rows of the store by `d`.
   subroutine find_rate_changes(sketch, problem, rates, d, turn, origin, unit, n, joint, moved)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates                !! by the input
      type(rows_t), intent(in) :: d(0:)                 !! by order; per radian of angles
      real(wp), intent(in) :: turn(:)                   !! shape (arcs): of their fixed angles
      complex(wp), intent(in) :: origin                 !! of the input pivot
      real(wp), intent(in) :: unit                      !! radians a unit of the variable is worth, or 1
      integer, intent(in) :: n
      complex(wp), intent(out) :: joint(:, 0:, :)       !! shape (joints, 0:most_wished, n)
      real(wp), intent(out) :: moved(:, 0:, :)          !! shape (slides, 0:most_wished, n)
      real(wp) :: h(0:most_wished)
      integer :: k, m, order, row

      joint = (0.0_wp, 0.0_wp)
      moved = 0.0_wp
      associate (link => problem%linkage, plan => problem%plan)
         do m = 1, n
            do k = 1, size(sketch%moving)
               associate (one => sketch%moving(k), point => plan%joint_points(k))
                  do order = 0, most_wished
                     joint(one%joint, order, m) = cmplx(d(order)%v(m, link%point_x(point)), d(order)%v(m, link%point_y(point)), &
                                                        wp)/link%scale
                  end do
                  joint(one%joint, 0, m) = joint(one%joint, 0, m) + origin
                  if (abs(one%offset) > 0.0_wp) then
                     row = link%root_x(plan%root(one%arc))
                     h = [(d(order)%v(m, row), order=0, most_wished)]
                     h(0) = h(0) + turn(one%arc)
                     joint(one%joint, :, m) = joint(one%joint, :, m) + turned_change(offset_of(sketch, problem, k, m), &
                                                                                     derivatives_of(rates, row, m), h)
                  end if
                  joint(one%joint, :, m) = joint(one%joint, :, m)*unit
               end associate
            end do
            do k = 1, size(sketch%arcs)
               if (sketch%arcs(k) == 0) cycle
               row = link%slide(plan%length_slot(sketch%arcs(k)))
               do order = 0, most_wished
                  moved(k, order, m) = sketch%sense(k)*d(order)%v(m, row)*(unit/link%scale)
               end do
            end do
         end do
      end associate
   end subroutine find_rate_changes

   !> Changes of a vector u exp(i theta) and of its derivatives by the input, where theta and its derivatives change by h.
   pure function turned_change(u, w, h) result(change)
      complex(wp), intent(in) :: u                      !! the vector
      real(wp), intent(in) :: w(:)                      !! derivatives of theta
      real(wp), intent(in) :: h(0:most_wished)
      complex(wp) :: change(0:most_wished)
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)

      change(0) = i*h(0)*u
      change(1) = i*(h(1)*u + w(1)*change(0))
      change(2) = i*h(2)*u + cmplx(-w(1)**2, w(2), wp)*change(0) - 2.0_wp*w(1)*h(1)*u
   end function turned_change

   !> Changes of a joint's place and of its derivatives by the input, with its own distance from the point of the plan, and with the
   !> angle of that line, by degrees.
   subroutine find_own_rate_changes(sketch, problem, rates, moving, position, along, across)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates                !! by the input
      integer, intent(in) :: moving                     !! of the joints that move: one with an offset
      integer, intent(in) :: position                   !! of the block
      complex(wp), intent(out) :: along(0:), across(0:) !! shape (0:most_wished)
      real(wp) :: w(most_orders)

      w = derivatives_of(rates, problem%linkage%root_x(problem%plan%root(sketch%moving(moving)%arc)), position)
      call find_own_changes(sketch, problem, moving, position, along(0), across(0))
      along = along(0)*[(1.0_wp, 0.0_wp), cmplx(0.0_wp, w(1), wp), cmplx(-w(1)**2, w(2), wp)]
      across = across(0)*[(1.0_wp, 0.0_wp), cmplx(0.0_wp, w(1), wp), cmplx(-w(1)**2, w(2), wp)]
   end subroutine find_own_rate_changes

   !> From the point of the plan to a joint at position m of the block.
   pure complex(wp) function offset_of(sketch, problem, moving, m) result(u)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: moving, m

      u = (0.0_wp, 0.0_wp)
      associate (one => sketch%moving(moving), link => problem%linkage)
         if (abs(one%offset) <= 0.0_wp) return
         associate (root => problem%plan%root(one%arc))
            u = one%offset*cmplx(link%x(one%arc), link%y(one%arc), wp)* &
                cmplx(link%store%v(m, link%root_x(root)), link%store%v(m, link%root_y(root)), wp)
         end associate
      end associate
   end function offset_of
end module psalm_sketch_motion
