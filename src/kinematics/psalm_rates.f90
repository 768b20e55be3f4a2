!> Derivatives of a linkage with respect to its input: first, second and third, of every root, point and slide.
!>
!> The plan that found the positions is gone through again, once for each order: each dyad's unknown derivatives obey two
!> linear equations whose matrix is the same in every order and is inverted once. Input: the crank angle in radians, or the
!> sliding input's length. Closed forms, no differencing. Source: Haines (about 1982), section 15.1; derivation in
!> `doc/theory.md`, Rates.
module psalm_rates
   use psalm_data_set, only: motion_angle, motion_distance, motion_slide
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp
   use psalm_linkage, only: bound_step_t, line_elements, offset_to_line, padded
   use psalm_plan, only: step_point, root_crank
   use psalm_rate_kernels, only: arc_vector, add_arc_rate, difference, invert_columns, solve_columns, quarter_turn_of_sum, &
                                 link_pair_second, link_pair_third, turn_point_twice, turn_point_third, &
                                 slide_point_twice, projections_twice
   implicit none (type, external)
   private
   public :: rates_t, prepare_rates, differentiate, form_frames, output_rates, is_dead, highest_order
   public :: row_of, unknowns_of, rows_of_arc, at_origin

   integer, parameter :: highest_order = 3
   integer, parameter :: rows_of_arc = 5        !! unit vector, vector, length
   integer, parameter :: rows_of_matrix = 5     !! inverse by rows, square of the sine between the columns

   real(wp), parameter :: at_origin = 64.0_wp*epsilon(1.0_wp)    !! relative distance below which a point lies on the origin
   real(wp), parameter :: dead_by_root = 64.0_wp*epsilon(1.0_wp) !! square of the sine below which a triangle is flat
   real(wp), parameter :: dead_by_angle = dead_by_root**2        !! the same where the sine itself is computed

   !> Derivatives of one block of positions.
   type :: rates_t
      integer :: room = 0
      real(wp), allocatable :: d(:, :)    !! shape (size of the linkage's store, 3): at the places of the store the derivatives
                                          !! of a root's angle (at its x row), of points, of slides
      real(wp), allocatable :: work(:)    !! rows of arcs and matrices
      integer, allocatable :: place(:)    !! by step: its first row in `work`
      integer :: zero = 0                 !! row of zeros in `work`
      integer :: scratch = 0              !! six rows in `work`
   end type rates_t

contains

   !> Allocate for a problem (after `want_derivatives`).
   subroutine prepare_rates(problem, rates)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(out) :: rates
      real(wp), allocatable, target :: work(:)
      integer :: k, rows, shift

      rates%room = problem%linkage%room
      allocate (rates%place(size(problem%plan%steps)))
      rows = 0
      do k = 1, size(problem%plan%steps)
         rates%place(k) = rows*rates%room
         rows = rows + merge(rows_of_arc, 2*rows_of_arc + rows_of_matrix, problem%plan%steps(k)%kind == step_point)
      end do
      allocate (work((rows + 7)*rates%room + line_elements), source=0.0_wp)
      shift = 1 + offset_to_line(work)
      call move_alloc(work, rates%work)
      rates%place = rates%place + shift
      ! slides at right angles are never parallel
      do k = 1, size(rates%place)
         if (problem%plan%steps(k)%kind == step_point) cycle
         associate (at => rates%place(k) + (2*rows_of_arc + rows_of_matrix - 1)*rates%room)
            rates%work(at:at + rates%room - 1) = 1.0_wp
         end associate
      end do
      rates%zero = rows*rates%room + shift
      rates%scratch = (rows + 1)*rates%room + shift
      call allocate_alike(size(problem%linkage%store), problem%linkage%first_row, rates%d)
   end subroutine prepare_rates

   !> Allocate an array whose element `first` lies on a cache line, as it does in the store: a lower bound a little below 1.
   !>
   !> Where the memory lies is known only afterwards, so a second try may be needed. If that fails too nothing is lost but speed.
   subroutine allocate_alike(elements, first, array)
      integer, intent(in) :: elements, first
      real(wp), allocatable, intent(out) :: array(:, :)
      real(wp), allocatable, target :: trial(:, :)
      integer :: low, try, rows

      low = 1
      rows = line_elements*((elements + 2*line_elements - 1)/line_elements)
      do try = 1, 3
         if (allocated(trial)) deallocate (trial)
         allocate (trial(low:low + rows - 1, highest_order), source=0.0_wp)
         ! elements from `first` to the next cache line
         associate (gap => modulo(offset_to_line(trial(:, 1)) - (first - low), line_elements))
            if (gap == 0) exit
            low = low - gap
            if (low <= 1 - line_elements) low = low + line_elements
         end associate
      end do
      call move_alloc(trial, array)
   end subroutine allocate_alike

   !> Place of row `which` (counted from 0) of a step.
   pure integer function row_of(rates, step, which)
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: step, which

      row_of = rates%place(step) + which*rates%room
   end function row_of

   !> Arc vectors of all steps and inverse matrices of all dyads, for the block just solved.
   subroutine form_frames(problem, rates, n, fixed_too)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(inout) :: rates
      integer, intent(in) :: n            !! positions, padded
      logical, intent(in) :: fixed_too    !! arcs of the frame as well
      integer :: k

      do k = 1, size(problem%linkage%steps)
         if (problem%linkage%steps(k)%fixed .and. .not. fixed_too) cycle
         call form_step(problem, rates, k, n)
      end do
   end subroutine form_frames

   !> Arc vectors of one step, and the inverse matrix if it is a dyad.
   subroutine form_step(problem, rates, k, n)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(inout) :: rates
      integer, intent(in) :: k, n         !! step; positions, padded
      integer :: a, b, m, c
      real(wp) :: limit

      associate (step => problem%linkage%steps(k), link => problem%linkage)
         if (problem%plan%steps(k)%kind == step_point) then
            ! a varying length takes the arc's direction, a fixed one its vector
            call form_arc(step%root_x, step%root_y, step%sign*link%x(step%arc), step%sign*link%y(step%arc), &
                          link%length(step%arc), step%slide_row, row_of(rates, k, 0))
            return
         end if
         a = row_of(rates, k, 0)
         b = row_of(rates, k, rows_of_arc)
         m = row_of(rates, k, 2*rows_of_arc)
         c = rates%scratch
         call form_arc(step%p_x, step%p_y, link%x(step%arc_p), link%y(step%arc_p), step%p, step%slide_p, a)
         call form_arc(step%q_x, step%q_y, link%x(step%arc_q), link%y(step%arc_q), step%q, step%slide_q, b)
         limit = dead_limit(step%joint)
         select case (step%joint)
         case (1)
            call turned_column(a, rates%zero, 0)
            call turned_column(b, rates%zero, 2)
            call invert(row(c, 0), row(c, 1), row(c, 2), row(c, 3))
         case (2)
            call turned_column(a, b, 0)
            call invert(row(c, 0), row(c, 1), a, row(a, 1))
         case (3)
            call turned_column(a, b, 0)
            call invert(row(c, 0), row(c, 1), b, row(b, 1))
         case (4)
            call turned_column(a, rates%zero, 0)
            call invert(row(c, 0), row(c, 1), b, row(b, 1))
         case (5)
            call turned_column(b, rates%zero, 0)
            call invert(a, row(a, 1), row(c, 0), row(c, 1))
         case default
            call invert(a, row(a, 1), b, row(b, 1))
         end select
      end associate

   contains

      pure integer function row(base, which)
         integer, intent(in) :: base, which

         row = base + which*rates%room
      end function row

      subroutine form_arc(root_x, root_y, x, y, length, slide, at)
         integer, intent(in) :: root_x, root_y, slide, at
         real(wp), intent(in) :: x, y, length

         if (slide > 0) then
            rates%work(row(at, 4):row(at, 4) + n - 1) = problem%linkage%store(slide:slide + n - 1)
         else
            rates%work(row(at, 4):row(at, 4) + n - 1) = length
         end if
         call arc_vector(n, problem%linkage%store(root_x), problem%linkage%store(root_y), x, y, rates%work(row(at, 4)), &
                         rates%work(at), rates%work(row(at, 1)), rates%work(row(at, 2)), rates%work(row(at, 3)))
      end subroutine form_arc

      subroutine turned_column(first, second, at)
         integer, intent(in) :: first, second, at

         if (second == rates%zero) then
            call quarter_turn_of_sum(n, rates%work(row(first, 2)), rates%work(row(first, 3)), rates%work(rates%zero), &
                                     rates%work(rates%zero), rates%work(row(c, at)), rates%work(row(c, at + 1)))
         else
            call quarter_turn_of_sum(n, rates%work(row(first, 2)), rates%work(row(first, 3)), rates%work(row(second, 2)), &
                                     rates%work(row(second, 3)), rates%work(row(c, at)), rates%work(row(c, at + 1)))
         end if
      end subroutine turned_column

      subroutine invert(c1x, c1y, c2x, c2y)
         integer, intent(in) :: c1x, c1y, c2x, c2y

         call invert_columns(n, limit, rates%work(c1x), rates%work(c1y), rates%work(c2x), rates%work(c2y), &
                             rates%work(row(m, 0)), rates%work(row(m, 1)), rates%work(row(m, 2)), rates%work(row(m, 3)), &
                             rates%work(row(m, 4)))
      end subroutine invert
   end subroutine form_step

   !> Square of the sine at and below which a dyad of this type is at a dead point.
   pure real(wp) function dead_limit(joint)
      integer, intent(in) :: joint

      dead_limit = merge(dead_by_root, dead_by_angle, joint <= 5)
   end function dead_limit

   !> Derivatives by the input up to `orders` (2 or 3) for the first `n` positions of the block just solved.
   subroutine differentiate(problem, rates, n, orders)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(inout) :: rates
      integer, intent(in) :: n, orders
      integer :: m, k, order

      m = padded(n)
      associate (link => problem%linkage, d => rates%d)
         if (link%sliding_input) then
            if (link%input_slot > 0) call set_input(link%slide(link%input_slot), link%scale)
         else
            call set_input(link%root_x(root_crank), 1.0_wp)
         end if
         do k = 1, size(link%steps)
            associate (step => link%steps(k))
               if (problem%plan%steps(k)%kind == step_point) then
                  if (step%fixed) cycle
                  call point_rates(problem, step, k, m, orders, rates)
               else if (step%joint == 1) then
                  call link_pair_rates(problem, step, row_of(rates, k, 2*rows_of_arc), m, orders, rates)
               else if (orders == 2 .and. (step%joint == 6 .or. step%joint == 7)) then
                  call projections_twice(m, link%store(step%from_x), link%store(step%from_y), link%store(step%to_x), &
                                         link%store(step%to_y), d(step%from_x, 1), d(step%from_y, 1), d(step%to_x, 1), &
                                         d(step%to_y, 1), d(step%from_x, 2), d(step%from_y, 2), d(step%to_x, 2), &
                                         d(step%to_y, 2), link%store(step%p_x), link%store(step%p_y), d(step%p_x, 1), &
                                         d(step%p_x, 2), step%px, step%py, step%qx, step%qy, d(step%slide_p, 1), &
                                         d(step%slide_q, 1), d(step%slide_p, 2), d(step%slide_q, 2))
               else
                  call form_step(problem, rates, k, m)
                  do order = 1, orders
                     call dyad_rate(step, rates, k, m, order)
                  end do
               end if
            end associate
         end do
      end associate

   contains

      subroutine set_input(at, rate)
         integer, intent(in) :: at
         real(wp), intent(in) :: rate

         rates%d(at:at + m - 1, 1) = rate
         rates%d(at:at + m - 1, 2:) = 0.0_wp
      end subroutine set_input
   end subroutine differentiate

   !> Link pair, all orders.
   subroutine link_pair_rates(problem, step, at, n, orders, rates)
      type(problem_t), intent(in) :: problem
      type(bound_step_t), intent(in) :: step
      integer, intent(in) :: at, n, orders   !! first row of the matrix
      type(rates_t), intent(inout) :: rates

      associate (d => rates%d, store => problem%linkage%store, inverse => at, sine2 => at + 4*rates%room, &
                 sx => step%from_x, sy => step%from_y, ex => step%to_x, &
                 ey => step%to_y, px => step%p_x, py => step%p_y, qx => step%q_x, qy => step%q_y)
         call link_pair_second(n, step%p, step%q, dead_by_root, d(sx, 1), d(sy, 1), d(ex, 1), d(ey, 1), d(sx, 2), d(sy, 2), &
                               d(ex, 2), d(ey, 2), store(px), store(py), store(qx), store(qy), rates%work(inverse), &
                               rates%work(sine2), d(px, 1), d(qx, 1), d(px, 2), d(qx, 2))
         if (orders < 3) return
         call link_pair_third(n, step%p, step%q, d(sx, 3), d(sy, 3), d(ex, 3), d(ey, 3), store(px), store(py), store(qx), &
                              store(qy), rates%work(inverse), d(px, 1), d(qx, 1), d(px, 2), d(qx, 2), d(px, 3), d(qx, 3))
      end associate
   end subroutine link_pair_rates

   !> One point, all orders.
   subroutine point_rates(problem, step, k, n, orders, rates)
      type(problem_t), intent(in) :: problem
      type(bound_step_t), intent(in) :: step
      integer, intent(in) :: k, n, orders
      type(rates_t), intent(inout) :: rates
      integer :: order

      associate (d => rates%d, store => problem%linkage%store, fx => step%from_x, fy => step%from_y, tx => step%to_x, &
                 ty => step%to_y, root => step%root_x, slide => step%slide_row)
         if (slide == 0) then
            call turn_point_twice(n, step%x, step%y, d(fx, 1), d(fy, 1), d(fx, 2), d(fy, 2), store(root), store(step%root_y), &
                                  d(root, 1), d(root, 2), d(tx, 1), d(ty, 1), d(tx, 2), d(ty, 2))
            if (orders == 3) call turn_point_third(n, step%x, step%y, d(fx, 3), d(fy, 3), store(root), store(step%root_y), &
                                                   d(root, 1), d(root, 2), d(root, 3), d(tx, 3), d(ty, 3))
         else if (orders == 2) then
            call slide_point_twice(n, step%x, step%y, d(fx, 1), d(fy, 1), d(fx, 2), d(fy, 2), store(root), &
                                   store(step%root_y), d(root, 1), d(root, 2), store(slide), d(slide, 1), d(slide, 2), &
                                   d(tx, 1), d(ty, 1), d(tx, 2), d(ty, 2))
         else
            call form_step(problem, rates, k, n)
            do order = 1, orders
               call arc_rate(rates, n, order, 1.0_wp, row_of(rates, k, 0), root, slide, d(fx, order), d(fy, order), &
                             d(tx, order), d(ty, order))
            end do
         end if
      end associate
   end subroutine point_rates

   !> t = f + factor * derivative of an arc whose rows begin at `at`; its root's and slide's derivatives stand at `root`, `slide`.
   subroutine arc_rate(rates, n, order, factor, at, root, slide, fx, fy, tx, ty)
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: n, order, at, root, slide
      real(wp), intent(in) :: factor
      real(wp), intent(in) :: fx(n), fy(n)
      real(wp), intent(out) :: tx(n), ty(n)

      associate (w => rates%work, d => rates%d, room => rates%room, zero => rates%zero)
         if (slide > 0) then
            call add_arc_rate(n, order, factor, fx, fy, w(at), w(at + room), w(at + 4*room), d(root, 1), d(root, 2), d(root, 3), &
                              d(slide, 1), d(slide, 2), d(slide, 3), tx, ty)
         else
            call add_arc_rate(n, order, factor, fx, fy, w(at), w(at + room), w(at + 4*room), d(root, 1), d(root, 2), d(root, 3), &
                              w(zero), w(zero), w(zero), tx, ty)
         end if
      end associate
   end subroutine arc_rate

   !> One dyad with a slide, one order: what is known of both arcs goes to the right-hand side, the rest is solved for.
   subroutine dyad_rate(step, rates, k, n, order)
      type(bound_step_t), intent(in) :: step
      type(rates_t), intent(inout) :: rates
      integer, intent(in) :: k, n, order
      real(wp) :: gx(n), gy(n), tx(n), ty(n)
      integer :: first, second, a, b, m

      a = row_of(rates, k, 0)
      b = row_of(rates, k, rows_of_arc)
      m = row_of(rates, k, 2*rows_of_arc)
      call unknowns_of(step, first, second)
      associate (w => rates%work, room => rates%room, d => rates%d)
         call difference(n, d(step%from_x, order), d(step%from_y, order), d(step%to_x, order), d(step%to_y, order), gx, gy)
         d(first:first + n - 1, order) = 0.0_wp
         d(second:second + n - 1, order) = 0.0_wp
         call arc_rate(rates, n, order, -1.0_wp, a, step%p_x, step%slide_p, gx, gy, tx, ty)
         call arc_rate(rates, n, order, -1.0_wp, b, step%q_x, step%slide_q, tx, ty, gx, gy)
         call solve_columns(n, w(m), w(m + room), w(m + 2*room), w(m + 3*room), gx, gy, d(first, order), d(second, order))
      end associate
   end subroutine dyad_rate

   !> Rows of the two unknowns of a dyad, in the order of the columns of its matrix.
   pure subroutine unknowns_of(step, first, second)
      type(bound_step_t), intent(in) :: step
      integer, intent(out) :: first, second

      first = step%p_x
      select case (step%joint)
      case (1)
         second = step%q_x
      case (2)
         second = step%slide_p
      case (3, 4)
         second = step%slide_q
      case (5)
         first = step%slide_p
         second = step%q_x
      case default
         first = step%slide_p
         second = step%slide_q
      end select
   end subroutine unknowns_of

   !> True where the matrix of a loop's dyad has no inverse at position `i` of the block: a dead point, rates are infinite.
   pure logical function is_dead(problem, rates, loop, i)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: loop, i

      associate (k => problem%linkage%step_of_loop(loop))
         is_dead = rates%work(row_of(rates, k, 2*rows_of_arc + 4) + i - 1) <= dead_limit(problem%topology%joint(loop))
      end associate
   end function is_dead

   !> Derivatives of the output at position `i` of the block, orders 1 to 3: x and y for MOTION 0, else in x only.
   !>
   !> MOTION 1: of the angle in radians. User's unit of length. MOTION 2: zero where the point lies on the origin (`at_origin`).
   subroutine output_rates(problem, rates, i, orders, x, y)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: i, orders
      real(wp), intent(out) :: x(highest_order), y(highest_order)
      real(wp) :: px, py, rx, ry, r, w1, w2, w3, back
      integer :: root, order

      x = 0.0_wp
      y = 0.0_wp
      associate (link => problem%linkage, plan => problem%plan, arc => problem%topology%output_arc)
         back = 1.0_wp/link%scale
         root = link%root_x(plan%root(arc)) + i - 1
         select case (problem%motion)
         case (motion_angle)
            x(:orders) = rates%d(root, :orders)
            return
         case (motion_slide)
            x(:orders) = rates%d(link%slide(plan%length_slot(arc)) + i - 1, :orders)*back
            return
         end select
         rx = link%store(root)
         ry = link%store(link%root_y(plan%root(arc)) + i - 1)
         px = (problem%out_c*rx - problem%out_s*ry)*problem%out_length
         py = (problem%out_c*ry + problem%out_s*rx)*problem%out_length
         w1 = rates%d(root, 1)
         w2 = rates%d(root, 2)
         w3 = rates%d(root, 3)
         do order = 1, orders
            x(order) = rates%d(link%point_x(plan%output_point) + i - 1, order)*back
            y(order) = rates%d(link%point_y(plan%output_point) + i - 1, order)*back
            select case (order)
            case (1)
               x(1) = x(1) - w1*py
               y(1) = y(1) + w1*px
            case (2)
               x(2) = x(2) - w1*w1*px - w2*py
               y(2) = y(2) - w1*w1*py + w2*px
            case default
               x(3) = x(3) - 3.0_wp*w1*w2*px - (w3 - w1**3)*py
               y(3) = y(3) - 3.0_wp*w1*w2*py + (w3 - w1**3)*px
            end select
         end do
         if (problem%motion /= motion_distance) return
         r = abs(px) + abs(py) + abs(problem%origin_x) + abs(problem%origin_y)
         px = px + link%store(link%point_x(plan%output_point) + i - 1)*back + problem%origin_x
         py = py + link%store(link%point_y(plan%output_point) + i - 1)*back + problem%origin_y
         ! at the origin the distance has a corner and no derivative
         if (hypotenuse(px, py) <= at_origin*max(r, maxval(link%length)*back)) then
            x = 0.0_wp
            y = 0.0_wp
            return
         end if
         r = hypotenuse(px, py)
         ! r r' = x x' + y y', and its derivatives
         w1 = (px*x(1) + py*y(1))/r
         w2 = (px*x(2) + py*y(2) + x(1)**2 + y(1)**2 - w1*w1)/r
         w3 = (px*x(3) + py*y(3) + 3.0_wp*(x(1)*x(2) + y(1)*y(2)) - 3.0_wp*w1*w2)/r
         x = [w1, w2, w3]
         y = 0.0_wp
      end associate
   end subroutine output_rates
end module psalm_rates
