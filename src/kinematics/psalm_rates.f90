!> Derivatives of a linkage with respect to its input: first, second and third, of every root, point and slide.
!>
!> The plan that found the positions is gone through again, once for each order: each dyad's unknown derivatives obey two
!> linear equations whose matrix is the same in every order and is inverted once. Input: the crank angle in radians, or the
!> sliding input's length. Closed forms, no differencing. Source: Haines (about 1982), section 15.1; derivation in
!> `doc/theory.md`, Rates.
module psalm_rates
   use psalm_data_set, only: motion_angle, motion_distance, motion_slide
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp
   use psalm_linkage, only: bound_step_t, padded
   use psalm_plan, only: step_point, root_crank
   use psalm_rate_kernels, only: arc_vector, add_arc_rate, difference, invert_columns, solve_columns, link_pair_second, &
                                 quarter_turn_of_sum
   implicit none (type, external)
   private
   public :: rates_t, prepare_rates, differentiate, form_frames, output_rates, is_dead, highest_order
   public :: row_of, unknowns_of, rows_of_arc

   integer, parameter :: highest_order = 3
   integer, parameter :: rows_of_arc = 5        !! unit vector, vector, length
   integer, parameter :: rows_of_matrix = 5     !! inverse by rows, square of the sine between the columns

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
      integer :: k, rows

      rates%room = problem%linkage%room
      allocate (rates%place(size(problem%plan%steps)))
      rows = 0
      do k = 1, size(problem%plan%steps)
         rates%place(k) = rows*rates%room + 1
         rows = rows + merge(rows_of_arc, 2*rows_of_arc + rows_of_matrix, problem%plan%steps(k)%kind == step_point)
      end do
      rates%zero = rows*rates%room + 1
      rates%scratch = (rows + 1)*rates%room + 1
      allocate (rates%work((rows + 7)*rates%room), source=0.0_wp)
      allocate (rates%d(size(problem%linkage%store), highest_order), source=0.0_wp)
   end subroutine prepare_rates

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
      integer :: k, a, b, m, c
      real(wp) :: limit

      do k = 1, size(problem%linkage%steps)
         associate (step => problem%linkage%steps(k), link => problem%linkage)
            if (problem%plan%steps(k)%kind == step_point) then
               if (step%fixed .and. .not. fixed_too) cycle
               ! a varying length takes the arc's direction, a fixed one its vector
               call form_arc(step%root_x, step%root_y, step%sign*link%x(step%arc), step%sign*link%y(step%arc), &
                             link%length(step%arc), step%slide_row, row_of(rates, k, 0))
               cycle
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
      end do

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
   end subroutine form_frames

   !> Square of the sine at and below which a dyad of this type is at a dead point.
   pure real(wp) function dead_limit(joint)
      integer, intent(in) :: joint

      dead_limit = merge(dead_by_root, dead_by_angle, joint <= 5)
   end function dead_limit

   !> Derivatives by the input up to `orders` (1 to 3) for the first `n` positions of the block just solved.
   subroutine differentiate(problem, rates, n, orders)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(inout) :: rates
      integer, intent(in) :: n, orders
      integer :: m, k, order

      m = padded(n)
      call form_frames(problem, rates, m, fixed_too=.false.)
      associate (link => problem%linkage)
         if (link%sliding_input) then
            if (link%input_slot > 0) call set_input(link%slide(link%input_slot), link%scale)
         else
            call set_input(link%root_x(root_crank), 1.0_wp)
         end if
         do k = 1, size(link%steps)
            if (problem%plan%steps(k)%kind == step_point) then
               if (link%steps(k)%fixed) cycle
               do order = 1, orders
                  call point_rate(link%steps(k), rates, k, m, order)
               end do
            else
               do order = 1, orders
                  call dyad_rate(link%steps(k), rates, k, m, order)
               end do
            end if
         end do
      end associate

   contains

      subroutine set_input(at, first)
         integer, intent(in) :: at
         real(wp), intent(in) :: first

         rates%d(at:at + m - 1, 1) = first
         rates%d(at:at + m - 1, 2:) = 0.0_wp
      end subroutine set_input
   end subroutine differentiate

   !> One point, one order.
   subroutine point_rate(step, rates, k, n, order)
      type(bound_step_t), intent(in) :: step
      type(rates_t), intent(inout) :: rates
      integer, intent(in) :: k, n, order

      call arc_rate(rates, n, order, 1.0_wp, row_of(rates, k, 0), step%root_x, step%slide_row, &
                    rates%d(step%from_x, order), rates%d(step%from_y, order), rates%d(step%to_x, order), &
                    rates%d(step%to_y, order))
   end subroutine point_rate

   !> t = f + factor * derivative of an arc whose rows begin at `at`; its root's and slide's derivatives stand at `root`, `slide`.
   subroutine arc_rate(rates, n, order, factor, at, root, slide, fx, fy, tx, ty)
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: n, order, at, root, slide
      real(wp), intent(in) :: factor
      real(wp), intent(in) :: fx(n), fy(n)
      real(wp), intent(out) :: tx(n), ty(n)

      associate (ex => rates%work(at:), ey => rates%work(at + rates%room:), length => rates%work(at + 4*rates%room:), &
                 zero => rates%work(rates%zero:))
         if (slide > 0) then
            call add_arc_rate(n, order, factor, fx, fy, ex, ey, length, rates%d(root:, 1), rates%d(root:, 2), &
                              rates%d(root:, 3), rates%d(slide:, 1), rates%d(slide:, 2), rates%d(slide:, 3), tx, ty)
         else
            call add_arc_rate(n, order, factor, fx, fy, ex, ey, length, rates%d(root:, 1), rates%d(root:, 2), &
                              rates%d(root:, 3), zero, zero, zero, tx, ty)
         end if
      end associate
   end subroutine arc_rate

   !> One dyad, one order: what is known of both arcs goes to the right-hand side, the rest is solved for.
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
         if (step%joint == 1 .and. order == 2) then
            call link_pair_second(n, d(step%from_x, 2), d(step%from_y, 2), d(step%to_x, 2), d(step%to_y, 2), w(a + 2*room), &
                                  w(a + 3*room), w(b + 2*room), w(b + 3*room), d(first, 1), d(second, 1), w(m), w(m + room), &
                                  w(m + 2*room), w(m + 3*room), d(first, 2), d(second, 2))
            return
         end if
         call difference(n, d(step%from_x, order), d(step%from_y, order), d(step%to_x, order), d(step%to_y, order), gx, gy)
         if (step%joint > 1 .or. order > 1) then
            d(first:first + n - 1, order) = 0.0_wp
            d(second:second + n - 1, order) = 0.0_wp
            call arc_rate(rates, n, order, -1.0_wp, a, step%p_x, step%slide_p, gx, gy, tx, ty)
            call arc_rate(rates, n, order, -1.0_wp, b, step%q_x, step%slide_q, tx, ty, gx, gy)
         end if
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
   !> MOTION 1: of the angle in radians. User's unit of length.
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
         px = px + link%store(link%point_x(plan%output_point) + i - 1)*back + problem%origin_x
         py = py + link%store(link%point_y(plan%output_point) + i - 1)*back + problem%origin_y
         r = max(hypot(px, py), tiny(1.0_wp)**0.25_wp)
         ! r r' = x x' + y y', and its derivatives
         w1 = (px*x(1) + py*y(1))/r
         w2 = (px*x(2) + py*y(2) + x(1)**2 + y(1)**2 - w1*w1)/r
         w3 = (px*x(3) + py*y(3) + 3.0_wp*(x(1)*x(2) + y(1)*y(2)) - 3.0_wp*w1*w2)/r
         x = [w1, w2, w3]
         y = 0.0_wp
      end associate
   end subroutine output_rates
end module psalm_rates
