!> The closure equations of a sketch in the poses of its links, with derivatives of any order by time.
!>
!> A point p of a link lies at t + e p, with e = exp(i phi); poses are counted from the drawing. Where links share a joint the
!> points agree; a slide keeps both directions and lets nothing move across its line; a gear pair keeps
!> ratio (phi_a - phi_c) - (phi_b - phi_c); a drive gives an angle, a travel or the length of its cylinder. The highest
!> derivative of the poses stands in every order with the same matrix, that of the equations by the poses: the rest is its
!> derivative with that of the poses put to zero. Source: Oldham (1977), 15.1, in poses instead of loops.
module psalm_closure
   use psalm_angles, only: unit_vector
   use psalm_assur_order, only: assur_order_t
   use psalm_dense, only: factors_t, factorise, solve, solve_transposed
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_sketch, only: sketch_t, frame_link, drive_slides, drive_stretches, drive_turns
   implicit none (type, external)
   private
   public :: closure_t, state_t, make_closure, start_state, residuals, matrix_of, place_points
   public :: local_point, point_rate, turned
   public :: solve_group, travel, most_orders, row_pin, row_angle, row_line, row_gear, row_turn, row_travel, rank_lost

   integer, parameter :: most_orders = 3      !! derivatives carried along: velocity, acceleration, jerk
   integer, parameter :: newton_steps = 40
   real(wp), parameter :: rank_lost = 64.0_wp*epsilon(1.0_wp)**0.75_wp !! reciprocal condition of a group at a dead point

   integer, parameter :: row_pin = 1          !! two points agree: two equations
   integer, parameter :: row_angle = 2        !! of a slide: both links have one direction
   integer, parameter :: row_line = 3         !! of a slide: no motion across the line
   integer, parameter :: row_gear = 4
   integer, parameter :: row_turn = 5         !! a drive that turns
   integer, parameter :: row_travel = 6       !! a drive along a slide

   !> One or two equations of a group.
   type :: equation_row_t
      integer :: kind = 0
      integer :: links(2) = 0
      integer :: which = 0                    !! joint, slide, gear or drive
   end type equation_row_t

   !> What a group is solved by.
   type :: group_rows_t
      type(equation_row_t), allocatable :: rows(:)
      integer, allocatable :: links(:)        !! unknown poses
      integer :: equations = 0                !! at least three a link; more where special dimensions make some superfluous
   end type group_rows_t

   !> A sketch made ready.
   type :: closure_t
      type(sketch_t) :: sketch
      type(assur_order_t) :: order
      type(group_rows_t), allocatable :: groups(:)
      real(wp) :: size = 1.0_wp               !! of the drawing: angles count so many lengths a radian
      complex(wp), allocatable :: origin(:)   !! by link: where its axes begin in the drawing
      complex(wp), allocatable :: point(:, &
         :) !! shape (joints, links): places in the axes of the link
      complex(wp), allocatable :: point_rate(:, :, :) !! shape (joints, links, most_orders): derivatives of these places while
                                              !! dimensions change; not allocated: they do not
      complex(wp), allocatable :: line(:)     !! by slide: its direction in the drawing
      complex(wp), allocatable :: slide_point(:, :) !! shape (2, slides): a point of the line in the axes of either link
      integer, allocatable :: cylinder(:)     !! by link: the drive whose length it has; 0: none
      integer, allocatable :: holder(:)       !! by joint: the link that tells where it is
   end type closure_t

   !> Where everything is, with derivatives by time.
   type :: state_t
      complex(wp), allocatable :: t(:, :)     !! shape (links, 0:most_orders): place of the link's origin
      real(wp), allocatable :: phi(:, :)      !! shape (links, 0:most_orders): turn since the drawing, radians
      complex(wp), allocatable :: joint(:, :) !! shape (joints, 0:most_orders)
      real(wp), allocatable :: input(:, :)    !! shape (drives, 0:most_orders): radians or length, from the drawing
   end type state_t

contains

   !> Make a sketch ready. `order` must be valid.
   subroutine make_closure(sketch, order, closure)
      type(sketch_t), intent(in) :: sketch
      type(assur_order_t), intent(in) :: order
      type(closure_t), intent(out) :: closure
      complex(wp) :: places(size(sketch%joint_name))
      real(wp) :: c, s
      integer :: i, j, n

      closure%sketch = sketch
      closure%order = order
      n = size(sketch%links)
      closure%size = size_of(sketch)
      allocate (closure%origin(n), closure%point(size(sketch%joint_name), n), source=(0.0_wp, 0.0_wp))
      allocate (closure%line(size(sketch%slides)), closure%slide_point(2, size(sketch%slides)), source=(0.0_wp, 0.0_wp))
      allocate (closure%cylinder(n), closure%holder(size(sketch%joint_name)), source=0)
      do i = 1, size(sketch%drives)
         if (sketch%drives(i)%kind == drive_stretches) closure%cylinder(sketch%drives(i)%link) = i
      end do
      do i = 1, n
         associate (joints => sketch%links(i)%joints)
            call shape_link(sketch, i, closure%cylinder(i) > 0, places)
            if (size(joints) > 0) closure%origin(i) = places(joints(1))
            if (i == frame_link) closure%origin(i) = (0.0_wp, 0.0_wp)
            do j = 1, size(joints)
               closure%point(joints(j), i) = places(joints(j)) - closure%origin(i)
            end do
         end associate
      end do
      do i = 1, size(sketch%slides)
         associate (slide => sketch%slides(i))
            call unit_vector(slide%angle, c, s)
            closure%line(i) = cmplx(c, s, wp)
            do j = 1, 2
               if (size(sketch%links(slide%links(j))%joints) == 0 .and. slide%links(j) /= frame_link) &
                  closure%origin(slide%links(j)) = cmplx(slide%x, slide%y, wp)
            end do
         end associate
      end do
      do i = 1, size(sketch%slides)
         associate (slide => sketch%slides(i))
            closure%slide_point(:, i) = cmplx(slide%x, slide%y, wp) - closure%origin(slide%links)
         end associate
      end do
      do j = 1, size(sketch%joint_name)
         closure%holder(j) = first_placed(sketch%links_of(j), order)
      end do
      call collect_rows(closure)
   end subroutine make_closure

   !> Size of the drawing: that of a box round all joints and slides. Of one that has no size, as a single joint on a slide through
   !> it, the distance from the origin, and at the origin 1.
   pure real(wp) function size_of(sketch)
      type(sketch_t), intent(in) :: sketch

      associate (x => [sketch%x, sketch%slides%x], y => [sketch%y, sketch%slides%y])
         size_of = max(maxval(x) - minval(x), maxval(y) - minval(y))
         if (size_of <= 0.0_wp) size_of = max(maxval(abs(x)), maxval(abs(y)))
      end associate
      if (size_of <= 0.0_wp) size_of = 1.0_wp
   end function size_of

   !> Of some links the one that is placed first.
   pure integer function first_placed(links, order) result(first)
      integer, intent(in) :: links(:)
      type(assur_order_t), intent(in) :: order
      integer :: i

      first = links(1)
      do i = 2, size(links)
         if (order%of_link(links(i)) < order%of_link(first)) first = links(i)
      end do
   end function first_placed

   !> Places of a link's joints, moved as little as possible until the given lengths are kept.
   pure subroutine shape_link(sketch, link, is_cylinder, places)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: link
      logical, intent(in) :: is_cylinder            !! its length is the drive's
      complex(wp), intent(out) :: places(:)         !! shape (joints)
      type(factors_t) :: factors
      real(wp), allocatable :: matrix(:, :), right(:), step(:)
      integer, allocatable :: held(:)
      complex(wp) :: d, shift
      integer :: i, k, n, a, b, round

      places = cmplx(sketch%x, sketch%y, wp)
      if (is_cylinder) return
      held = [integer ::]
      do i = 1, size(sketch%length)
         if (sketch%has_joint(link, sketch%length_of(1, i)) .and. sketch%has_joint(link, sketch%length_of(2, i))) held = [held, i]
      end do
      if (size(held) == 0) return
      associate (joints => sketch%links(link)%joints)
         n = size(joints)
         allocate (matrix(2*n, size(held)), right(size(held)), step(2*n))
         do round = 1, newton_steps
            matrix = 0.0_wp
            do k = 1, size(held)
               a = findloc(joints, sketch%length_of(1, held(k)), dim=1)
               b = findloc(joints, sketch%length_of(2, held(k)), dim=1)
               d = places(joints(b)) - places(joints(a))
               right(k) = sketch%length(held(k)) - abs(d)
               if (abs(d) > 0.0_wp) d = d/abs(d)     ! joints that coincide have no direction: the matrix loses its rank
               matrix([2*a - 1, 2*a, 2*b - 1, 2*b], k) = [-d%re, -d%im, d%re, d%im]
            end do
            if (maxval(abs(right)) <= 2.0_wp*epsilon(1.0_wp)*maxval(sketch%length(held))) exit
            if (size(held) > 2*n) return
            call factorise(matrix, factors)
            if (factors%reciprocal_condition < rank_lost) return
            step = solve_transposed(factors, right)
            do i = 1, n
               places(joints(i)) = places(joints(i)) + cmplx(step(2*i - 1), step(2*i), wp)
            end do
         end do
         if (link == frame_link) then
            shift = cmplx(sketch%x(joints(1)), sketch%y(joints(1)), wp) - places(joints(1))
            places(joints) = places(joints) + shift
         end if
      end associate
   end subroutine shape_link

   !> The equations of every group: each belongs to the group that places the later of its links.
   subroutine collect_rows(closure)
      type(closure_t), intent(inout) :: closure
      integer :: i, j, k, g
      integer, allocatable :: links(:)

      allocate (closure%groups(size(closure%order%groups)))
      do g = 1, size(closure%groups)
         allocate (closure%groups(g)%rows(0))
         closure%groups(g)%links = closure%order%groups(g)%links
      end do
      associate (sketch => closure%sketch)
         do j = 1, size(sketch%joint_name)
            links = sketch%links_of(j)
            do k = 1, size(links)
               if (links(k) /= closure%holder(j)) call add(equation_row_t(row_pin, [closure%holder(j), links(k)], j))
            end do
         end do
         do i = 1, size(sketch%slides)
            call add(equation_row_t(row_angle, sketch%slides(i)%links, i))
            call add(equation_row_t(row_line, sketch%slides(i)%links, i))
         end do
         do i = 1, size(sketch%gears)
            g = maxval(closure%order%of_link([sketch%gears(i)%wheels, sketch%gears(i)%carrier]))
            call add_to(g, equation_row_t(row_gear, sketch%gears(i)%wheels, i))
         end do
         do i = 1, size(sketch%drives)
            associate (drive => sketch%drives(i))
               if (drive%kind == drive_turns) call add(equation_row_t(row_turn, [drive%base, drive%link], i))
               if (drive%kind == drive_slides) call add(equation_row_t(row_travel, [drive%base, drive%link], i))
            end associate
         end do
      end associate

   contains

      subroutine add(row)
         type(equation_row_t), intent(in) :: row

         call add_to(maxval(closure%order%of_link(row%links)), row)
      end subroutine add

      subroutine add_to(group, row)
         integer, intent(in) :: group
         type(equation_row_t), intent(in) :: row

         if (group == 0) return
         closure%groups(group)%rows = [closure%groups(group)%rows, row]
         closure%groups(group)%equations = closure%groups(group)%equations + merge(2, 1, row%kind == row_pin)
      end subroutine add_to
   end subroutine collect_rows

   !> Everything as it is drawn.
   pure subroutine start_state(closure, state)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(out) :: state
      integer :: n

      n = size(closure%origin)
      allocate (state%t(n, 0:most_orders), source=(0.0_wp, 0.0_wp))
      allocate (state%phi(n, 0:most_orders), source=0.0_wp)
      allocate (state%joint(size(closure%holder), 0:most_orders), source=(0.0_wp, 0.0_wp))
      allocate (state%input(size(closure%sketch%drives), 0:most_orders), source=0.0_wp)
      state%t(:, 0) = closure%origin
      call place_points(closure, state, 0)
   end subroutine start_state

   ! ---- one link ----------------------------------------------------------------------------------------------------

   !> exp(i angle).
   elemental complex(wp) function turned(angle)
      real(wp), intent(in) :: angle           !! radians

      real(wp) :: c, s

      call unit_vector(angle*degrees_per_radian, c, s)
      turned = cmplx(c, s, wp)
   end function turned

   !> Derivative of a point of a link; `p` are its place in the axes of the link and the derivatives of that.
   pure complex(wp) function point_rate(state, link, order, p) result(rate)
      type(state_t), intent(in) :: state
      integer, intent(in) :: link, order
      complex(wp), intent(in) :: p(0:most_orders)
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      complex(wp) :: e

      e = turned(state%phi(link, 0))
      associate (w => state%phi(link, :))
         select case (order)
         case (0)
            rate = e*p(0)
         case (1)
            rate = e*(i*at(w, 1)*p(0) + p(1))
         case (2)
            rate = e*((i*at(w, 2) - at(w, 1)**2)*p(0) + 2.0_wp*i*at(w, 1)*p(1) + p(2))
         case default
            rate = e*((i*at(w, 3) - 3.0_wp*at(w, 1)*at(w, 2) - i*at(w, 1)**3)*p(0) &
                      + 3.0_wp*(i*at(w, 2) - at(w, 1)**2)*p(1) + 3.0_wp*i*at(w, 1)*p(2) + p(3))
         end select
      end associate
      rate = rate + state%t(link, order)
   end function point_rate

   !> An element of a row of derivatives that is counted from 0.
   pure real(wp) function at(w, order)
      real(wp), intent(in) :: w(0:)
      integer, intent(in) :: order

      at = w(order)
   end function at

   !> Place of a joint in the axes of a link; the far end of a cylinder moves there.
   pure function local_point(closure, state, joint, link) result(p)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      integer, intent(in) :: joint, link
      complex(wp) :: p(0:most_orders)
      complex(wp) :: along
      integer :: drive

      p = (0.0_wp, 0.0_wp)
      p(0) = closure%point(joint, link)
      if (allocated(closure%point_rate)) p(1:) = closure%point_rate(joint, link, :)
      drive = closure%cylinder(link)
      if (drive == 0) return
      if (p(0) == (0.0_wp, 0.0_wp)) return
      along = p(0)/abs(p(0))
      p = along*state%input(drive, :)
      p(0) = p(0) + closure%point(joint, link)
   end function local_point

   !> Derivative of a joint, from the link that holds it.
   pure subroutine place_points(closure, state, order)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(inout) :: state
      integer, intent(in) :: order
      integer :: j

      do j = 1, size(closure%holder)
         state%joint(j, order) = point_rate(state, closure%holder(j), order, local_point(closure, state, j, closure%holder(j)))
      end do
   end subroutine place_points

   ! ---- equations ---------------------------------------------------------------------------------------------------

   !> Derivatives of a group's equations, of the given order (0: the equations themselves).
   pure function residuals(closure, state, group, order) result(values)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      integer, intent(in) :: group, order
      real(wp) :: values(closure%groups(group)%equations)
      complex(wp) :: z
      integer :: k, m

      m = 0
      associate (rows => closure%groups(group)%rows, scale => closure%size)
         do k = 1, size(rows)
            associate (a => rows(k)%links(1), b => rows(k)%links(2), n => rows(k)%which)
               select case (rows(k)%kind)
               case (row_pin)
                  z = point_rate(state, b, order, local_point(closure, state, n, b)) &
                      - point_rate(state, a, order, local_point(closure, state, n, a))
                  values(m + 1) = z%re
                  values(m + 2) = z%im
                  m = m + 1
               case (row_angle)
                  values(m + 1) = scale*(state%phi(b, order) - state%phi(a, order))
               case (row_line)
                  z = travel(closure, state, n, order)
                  values(m + 1) = z%im
               case (row_gear)
                  associate (gear => closure%sketch%gears(n))
                     values(m + 1) = scale*(state%phi(b, order) - state%phi(gear%carrier, order) &
                                            - gear%ratio*(state%phi(a, order) - state%phi(gear%carrier, order)))
                  end associate
               case (row_turn)
                  values(m + 1) = scale*(state%phi(b, order) - state%phi(a, order) - state%input(n, order))
               case default
                  z = travel(closure, state, closure%sketch%drives(n)%slide, order)
                  if (closure%sketch%slides(closure%sketch%drives(n)%slide)%links(1) /= a) z = -z
                  values(m + 1) = z%re - state%input(n, order)
               end select
            end associate
            m = m + 1
         end do
      end associate
   end function residuals

   !> Displacement of the second link of a slide against the first, along and across the line, and its derivatives.
   pure complex(wp) function travel(closure, state, slide, order) result(z)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      integer, intent(in) :: slide, order
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      complex(wp) :: d(0:most_orders), p(0:most_orders), q(0:most_orders)
      integer :: k

      p = (0.0_wp, 0.0_wp)
      q = (0.0_wp, 0.0_wp)
      associate (a => closure%sketch%slides(slide)%links(1), b => closure%sketch%slides(slide)%links(2))
         p(0) = closure%slide_point(1, slide)
         q(0) = closure%slide_point(2, slide)
         do k = 0, order
            d(k) = point_rate(state, b, k, q) - point_rate(state, a, k, p)
         end do
         associate (w => state%phi(a, :))
            select case (order)
            case (0)
               z = d(0)
            case (1)
               z = d(1) - i*at(w, 1)*d(0)
            case (2)
               z = d(2) - 2.0_wp*i*at(w, 1)*d(1) - (i*at(w, 2) + at(w, 1)**2)*d(0)
            case default
               z = d(3) - 3.0_wp*i*at(w, 1)*d(2) - 3.0_wp*(i*at(w, 2) + at(w, 1)**2)*d(1) &
                   + (-i*at(w, 3) - 3.0_wp*at(w, 1)*at(w, 2) + i*at(w, 1)**3)*d(0)
            end select
         end associate
         z = z*conjg(turned(state%phi(a, 0))*closure%line(slide))
      end associate
   end function travel

   !> The matrix of a group: its equations by x, y and turn (times the size of the drawing) of each of its links.
   function matrix_of(closure, state, group) result(matrix)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      integer, intent(in) :: group
      real(wp) :: matrix(closure%groups(group)%equations, 3*size(closure%groups(group)%links))
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      complex(wp) :: p(0:most_orders), d, across
      integer :: k, m, slide
      real(wp) :: sense

      matrix = 0.0_wp
      m = 1
      associate (rows => closure%groups(group)%rows, scale => closure%size)
         do k = 1, size(rows)
            associate (a => rows(k)%links(1), b => rows(k)%links(2), n => rows(k)%which)
               select case (rows(k)%kind)
               case (row_pin)
                  p = local_point(closure, state, n, b)
                  call add_pin(b, 1.0_wp, i*turned(state%phi(b, 0))*p(0)/scale)
                  p = local_point(closure, state, n, a)
                  call add_pin(a, -1.0_wp, i*turned(state%phi(a, 0))*p(0)/scale)
                  m = m + 1
               case (row_angle, row_turn)
                  call add_turn(b, 1.0_wp)
                  call add_turn(a, -1.0_wp)
               case (row_gear)
                  associate (gear => closure%sketch%gears(n))
                     call add_turn(b, 1.0_wp)
                     call add_turn(a, -gear%ratio)
                     call add_turn(gear%carrier, gear%ratio - 1.0_wp)
                  end associate
               case default
                  slide = n
                  if (rows(k)%kind == row_travel) slide = closure%sketch%drives(n)%slide
                  associate (first => closure%sketch%slides(slide)%links(1), second => closure%sketch%slides(slide)%links(2))
                     across = conjg(turned(state%phi(first, 0))*closure%line(slide))
                     p = (0.0_wp, 0.0_wp)
                     p(0) = closure%slide_point(2, slide)
                     d = point_rate(state, second, 0, p) - state%t(first, 0)
                     sense = 1.0_wp
                     if (rows(k)%kind == row_travel .and. first /= a) sense = -1.0_wp
                     call add_travel(second, sense, i*turned(state%phi(second, 0))*p(0)/scale*across)
                     ! the point of the first link and its direction turn together
                     call add_travel(first, -sense, i*d/scale*across)
                  end associate
               end select
            end associate
            m = m + 1
         end do
      end associate

   contains

      pure integer function column(link)
         integer, intent(in) :: link

         column = 3*findloc(closure%groups(group)%links, link, dim=1) - 2
      end function column

      subroutine add_pin(link, factor, by_turn)
         integer, intent(in) :: link
         real(wp), intent(in) :: factor
         complex(wp), intent(in) :: by_turn
         integer :: c

         c = column(link)
         if (c < 1) return
         matrix(m, c) = matrix(m, c) + factor
         matrix(m + 1, c + 1) = matrix(m + 1, c + 1) + factor
         matrix(m, c + 2) = matrix(m, c + 2) + factor*by_turn%re
         matrix(m + 1, c + 2) = matrix(m + 1, c + 2) + factor*by_turn%im
      end subroutine add_pin

      subroutine add_turn(link, factor)
         integer, intent(in) :: link
         real(wp), intent(in) :: factor
         integer :: c

         c = column(link)
         if (c > 0) matrix(m, c + 2) = matrix(m, c + 2) + factor
      end subroutine add_turn

      subroutine add_travel(link, factor, by_turn)
         integer, intent(in) :: link
         real(wp), intent(in) :: factor
         complex(wp), intent(in) :: by_turn
         complex(wp) :: by_x, by_y
         integer :: c

         c = column(link)
         if (c < 1) return
         by_x = across
         by_y = i*across
         if (rows_kind() == row_line) then
            matrix(m, c:c + 2) = matrix(m, c:c + 2) + factor*[by_x%im, by_y%im, by_turn%im]
         else
            matrix(m, c:c + 2) = matrix(m, c:c + 2) + factor*[by_x%re, by_y%re, by_turn%re]
         end if
      end subroutine add_travel

      pure integer function rows_kind()
         rows_kind = closure%groups(group)%rows(k)%kind
      end function rows_kind
   end function matrix_of

   !> Newton's method for one group from where it stands.
   !>
   !> `first` is the length of the first correction, by which a caller assesses the estimate. `closed` is false where the
   !> corrections do not die away or the equations contradict each other.
   subroutine solve_group(closure, group, state, closed, factors, first)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: group
      type(state_t), intent(inout) :: state
      logical, intent(out) :: closed
      type(factors_t), intent(out) :: factors
      real(wp), intent(out), optional :: first
      real(wp), allocatable :: step(:), right(:)
      real(wp) :: length, before, tolerance
      integer :: round, k

      closed = .false.
      tolerance = 16.0_wp*epsilon(1.0_wp)*closure%size
      if (present(first)) first = 0.0_wp
      if (size(closure%groups(group)%links) == 0) then
         closed = .true.
         return
      end if
      before = huge(1.0_wp)
      do round = 1, newton_steps
         call factorise(matrix_of(closure, state, group), factors)
         if (factors%reciprocal_condition < rank_lost**2) return
         right = -residuals(closure, state, group, 0)
         if (any(right /= right)) return
         step = solve(factors, right)
         length = maxval(abs(step))
         if (present(first) .and. round == 1) first = length
         if (length > 10.0_wp*closure%size) return
         associate (links => closure%groups(group)%links)
            do k = 1, size(links)
               state%t(links(k), 0) = state%t(links(k), 0) + cmplx(step(3*k - 2), step(3*k - 1), wp)
               state%phi(links(k), 0) = state%phi(links(k), 0) + step(3*k)/closure%size
            end do
         end associate
         if (length <= tolerance .or. (round > 3 .and. length >= 0.5_wp*before .and. length < 1.0e6_wp*tolerance)) exit
         before = length
      end do
      closed = maxval(abs(residuals(closure, state, group, 0))) <= 1.0e-9_wp*closure%size
   end subroutine solve_group
end module psalm_closure
