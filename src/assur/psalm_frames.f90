!> Vectors of a dyad's arcs and the inverse of its matrix, for one block of positions: what every derivative of it needs.
!>
!> The unknowns x1, x2 of a dyad obey c1 x1 + c2 x2 = g; each kind of dyad has its own columns c1, c2.
module psalm_frames
   use psalm_arc_kernels, only: arc_vector, invert_columns, quarter_turn_of_sum, solve_columns, difference, add_arc_rate
   use psalm_dyad, only: dyad_t
   use psalm_kinds, only: wp
   use psalm_rows, only: rows_t, make_rows
   implicit none (type, external)
   private
   public :: frames_t, make_frames, form_arc, turned_column, invert, dyad_rate, arc_rate
   public :: rows_of_arc, rows_of_dyad, matrix_row, sine_row

   integer, parameter :: rows_of_arc = 5         !! unit vector, vector, length
   integer, parameter :: rows_of_matrix = 5      !! inverse by rows, square of the sine between the columns
   integer, parameter :: rows_of_dyad = 2*rows_of_arc + rows_of_matrix !! arcs p and q, matrix
   integer, parameter :: matrix_row = 2*rows_of_arc                    !! from a dyad's first row to its matrix
   integer, parameter :: sine_row = rows_of_dyad - 1                   !! from its first row to the square of the sine
   integer, parameter :: rows_of_scratch = 4

   type :: frames_t
      type(rows_t) :: work
      integer :: zero = 0       !! row of zeros
      integer :: scratch = 0    !! rows for two columns
   end type frames_t

contains

   !> Allocate `count` rows of `room` positions.
   subroutine make_frames(capacity, count, frames)
      integer, intent(in) :: capacity, count
      type(frames_t), intent(out) :: frames

      call make_rows(capacity, count + 1 + rows_of_scratch, frames%work)
      frames%zero = count + 1
      frames%scratch = count + 2
   end subroutine make_frames

   !> Vectors of one arc into the rows from `at` on.
   subroutine form_arc(n, store, root_x, root_y, x, y, length, slide, frames, at)
      integer, intent(in) :: n                   !! positions, padded
      type(rows_t), intent(in) :: store
      integer, intent(in) :: root_x, root_y      !! rows of the unit vector it is turned from
      real(wp), intent(in) :: x, y               !! cosine, sine of the fixed angle
      real(wp), intent(in) :: length
      integer, intent(in) :: slide               !! row of a length that varies, 0: none
      type(frames_t), intent(inout) :: frames
      integer, intent(in) :: at

      associate (w => frames%work%v)
         if (slide > 0) then
            w(1:n, at + 4) = store%v(1:n, slide)
         else
            w(1:n, at + 4) = length
         end if
         call arc_vector(n, store%v(1, root_x), store%v(1, root_y), x, y, w(1, at + 4), w(1, at), w(1, at + 1), w(1, at + 2), &
                         w(1, at + 3))
      end associate
   end subroutine form_arc

   !> Column of an angle that turns the arc at `first` and, if it is not 0, the arc at `second`; into scratch column 1 or 2.
   subroutine turned_column(n, frames, first, second, column)
      integer, intent(in) :: n, first, second, column
      type(frames_t), intent(inout) :: frames

      associate (w => frames%work%v, c => frames%scratch + 2*(column - 1), zero => frames%zero)
         if (second == 0) then
            call quarter_turn_of_sum(n, w(1, first + 2), w(1, first + 3), w(1, zero), w(1, zero), w(1, c), w(1, c + 1))
         else
            call quarter_turn_of_sum(n, w(1, first + 2), w(1, first + 3), w(1, second + 2), w(1, second + 3), w(1, c), w(1, c + 1))
         end if
      end associate
   end subroutine turned_column

   !> Inverse of the matrix whose columns begin at the rows `c1` and `c2`, into the dyad's rows from `at` on.
   subroutine invert(n, limit, c1, c2, at, frames)
      integer, intent(in) :: n
      real(wp), intent(in) :: limit              !! square of the sine at and below which there is no inverse
      integer, intent(in) :: c1, c2, at
      type(frames_t), intent(inout) :: frames

      associate (w => frames%work%v, m => at + matrix_row)
         call invert_columns(n, limit, w(1, c1), w(1, c1 + 1), w(1, c2), w(1, c2 + 1), w(1, m), w(1, m + 1), w(1, m + 2), &
                             w(1, m + 3), w(1, m + 4))
      end associate
   end subroutine invert

   !> t = f + factor * derivative of an arc whose rows begin at `at`; its root's and slide's derivatives stand at `root`, `slide`.
   subroutine arc_rate(frames, d, n, order, factor, at, root, slide, fx, fy, tx, ty)
      type(frames_t), intent(in) :: frames
      type(rows_t), intent(in) :: d(:)           !! by order
      integer, intent(in) :: n, order, at, root, slide
      real(wp), intent(in) :: factor
      real(wp), intent(in) :: fx(n), fy(n)
      real(wp), intent(out) :: tx(n), ty(n)

      associate (w => frames%work%v, zero => frames%zero)
         if (slide > 0) then
            call add_arc_rate(n, order, factor, fx, fy, w(1, at), w(1, at + 1), w(1, at + 4), d(1)%v(1, root), d(2)%v(1, root), &
                              d(3)%v(1, root), d(1)%v(1, slide), d(2)%v(1, slide), d(3)%v(1, slide), tx, ty)
         else
            call add_arc_rate(n, order, factor, fx, fy, w(1, at), w(1, at + 1), w(1, at + 4), d(1)%v(1, root), d(2)%v(1, root), &
                              d(3)%v(1, root), w(1, zero), w(1, zero), w(1, zero), tx, ty)
         end if
      end associate
   end subroutine arc_rate

   !> One dyad, one order: what is known of both arcs goes to the right-hand side, the rest is solved for.
   subroutine dyad_rate(n, order, dyad, frames, at, d)
      integer, intent(in) :: n, order, at
      type(dyad_t), intent(in) :: dyad
      type(frames_t), intent(in) :: frames
      type(rows_t), intent(inout) :: d(:)        !! by order
      real(wp) :: gx(n), gy(n), tx(n), ty(n)

      associate (w => frames%work%v, m => at + matrix_row, first => dyad%unknown(1), second => dyad%unknown(2), &
                 top => d(order)%v)
         call difference(n, top(1, dyad%s_x), top(1, dyad%s_y), top(1, dyad%e_x), top(1, dyad%e_y), gx, gy)
         top(1:n, first) = 0.0_wp
         top(1:n, second) = 0.0_wp
         call arc_rate(frames, d, n, order, -1.0_wp, at, dyad%p_x, dyad%slide_p, gx, gy, tx, ty)
         call arc_rate(frames, d, n, order, -1.0_wp, at + rows_of_arc, dyad%q_x, dyad%slide_q, tx, ty, gx, gy)
         call solve_columns(n, w(1, m), w(1, m + 1), w(1, m + 2), w(1, m + 3), gx, gy, top(1, first), top(1, second))
      end associate
   end subroutine dyad_rate
end module psalm_frames
