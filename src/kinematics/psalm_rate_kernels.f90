!> Kernels of the derivatives: one arc, one point, one dyad, for many positions at once.
!>
!> An arc L e, with e a unit vector whose angle has the derivatives w1, w2, w3 and L the derivatives l1, l2, l3, has
!>   order 1: l1 e + w1 L i e
!>   order 2: (l2 - w1**2 L) e + (2 w1 l1 + w2 L) i e
!>   order 3: (l3 - 3 w1**2 l1 - 3 w1 w2 L) e + (3 w1 l2 + 3 w2 l1 + (w3 - w1**3) L) i e
!> Derivatives are with respect to one parameter: the input, a dimension. A dyad's unknowns x1, x2 of the highest order obey
!> c1 x1 + c2 x2 = g with the same matrix in every order. All arrays have the shape (n). Derivation: `doc/theory.md`, Rates.
module psalm_rate_kernels
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: arc_vector, add_arc_rate, add_arc_change, difference
   public :: point_back, dyad_back, arc_back
   public :: invert_columns, solve_columns, quarter_turn_of_sum
   public :: link_pair_change, link_pair_second, link_pair_third, turn_point_twice, turn_point_third
   public :: slide_point_twice, projections_twice

   real(wp), parameter :: least = tiny(1.0_wp)**0.25_wp !! guards a division

contains

   !> Arc vector L e and unit vector e from a root turned by a fixed angle.
   pure subroutine arc_vector(n, rx, ry, c, s, length, ex, ey, ax, ay)
      integer, intent(in) :: n
      real(wp), intent(in) :: rx(n), ry(n), c, s   !! root; cosine, sine of the fixed angle
      real(wp), intent(in) :: length(n)
      real(wp), intent(out) :: ex(n), ey(n), ax(n), ay(n)
      integer :: i

      do i = 1, n
         ex(i) = c*rx(i) - s*ry(i)
         ey(i) = c*ry(i) + s*rx(i)
         ax(i) = length(i)*ex(i)
         ay(i) = length(i)*ey(i)
      end do
   end subroutine arc_vector

   !> t = f + factor * (derivative of the given order of an arc).
   !>
   !> For the part of a dyad's arc that is known, rows of unknown highest derivatives hold zero.
   pure subroutine add_arc_rate(n, order, factor, fx, fy, ex, ey, length, w1, w2, w3, l1, l2, l3, tx, ty)
      integer, intent(in) :: n, order
      real(wp), intent(in) :: factor
      real(wp), intent(in) :: fx(n), fy(n), ex(n), ey(n), length(n)
      real(wp), intent(in) :: w1(n), w2(n), w3(n), l1(n), l2(n), l3(n)
      real(wp), intent(out) :: tx(n), ty(n)
      real(wp) :: along, across
      integer :: i

      select case (order)
      case (1)
         do i = 1, n
            along = factor*l1(i)
            across = factor*(w1(i)*length(i))
            tx(i) = fx(i) + along*ex(i) - across*ey(i)
            ty(i) = fy(i) + along*ey(i) + across*ex(i)
         end do
      case (2)
         do i = 1, n
            along = factor*(l2(i) - w1(i)*w1(i)*length(i))
            across = factor*(2.0_wp*w1(i)*l1(i) + w2(i)*length(i))
            tx(i) = fx(i) + along*ex(i) - across*ey(i)
            ty(i) = fy(i) + along*ey(i) + across*ex(i)
         end do
      case default
         do i = 1, n
            along = factor*(l3(i) - 3.0_wp*w1(i)*(w1(i)*l1(i) + w2(i)*length(i)))
            across = factor*(3.0_wp*(w1(i)*l2(i) + w2(i)*l1(i)) + (w3(i) - w1(i)**3)*length(i))
            tx(i) = fx(i) + along*ex(i) - across*ey(i)
            ty(i) = fy(i) + along*ey(i) + across*ex(i)
         end do
      end select
   end subroutine add_arc_rate

   !> g = e - s, the derivative of h.
   pure subroutine difference(n, sx, sy, ex, ey, gx, gy)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(out) :: gx(n), gy(n)
      integer :: i

      do i = 1, n
         gx(i) = ex(i) - sx(i)
         gy(i) = ey(i) - sy(i)
      end do
   end subroutine difference

   !> Inverse of the matrix with the columns c1, c2, and the square of the sine between them.
   !>
   !> Where that is not above `limit` there is no inverse, and zero is given: the caller tells a dead point by `sine2`.
   pure subroutine invert_columns(n, limit, c1x, c1y, c2x, c2y, m11, m12, m21, m22, sine2)
      integer, intent(in) :: n
      real(wp), intent(in) :: limit
      real(wp), intent(in) :: c1x(n), c1y(n), c2x(n), c2y(n)
      real(wp), intent(out) :: m11(n), m12(n), m21(n), m22(n), sine2(n)
      real(wp) :: determinant, size2
      integer :: i

      do i = 1, n
         determinant = c1x(i)*c2y(i) - c1y(i)*c2x(i)
         size2 = (c1x(i)*c1x(i) + c1y(i)*c1y(i))*(c2x(i)*c2x(i) + c2y(i)*c2y(i))
         sine2(i) = determinant*determinant/max(size2, least)
         determinant = 1.0_wp/sign(max(abs(determinant), least), determinant)
         determinant = merge(determinant, 0.0_wp, sine2(i) > limit)
         m11(i) = c2y(i)*determinant
         m12(i) = -c2x(i)*determinant
         m21(i) = -c1y(i)*determinant
         m22(i) = c1x(i)*determinant
      end do
   end subroutine invert_columns

   !> x = M g.
   pure subroutine solve_columns(n, m11, m12, m21, m22, gx, gy, x1, x2)
      integer, intent(in) :: n
      real(wp), intent(in) :: m11(n), m12(n), m21(n), m22(n), gx(n), gy(n)
      real(wp), intent(out) :: x1(n), x2(n)
      integer :: i

      do i = 1, n
         x1(i) = m11(i)*gx(i) + m12(i)*gy(i)
         x2(i) = m21(i)*gx(i) + m22(i)*gy(i)
      end do
   end subroutine solve_columns

   !> Link pair, first and second order in one pass; the inverse of the sine between the links is kept.
   !>
   !> Where the square of the sine is not above `limit` (a dead point) the inverse is zero.
   pure subroutine link_pair_second(n, p, q, limit, sx1, sy1, ex1, ey1, sx2, sy2, ex2, ey2, px, py, qx, qy, inverse, sine2, wp1, &
                                    wq1, wp2, wq2)
      integer, intent(in) :: n
      real(wp), intent(in) :: p, q, limit
      real(wp), intent(in) :: sx1(n), sy1(n), ex1(n), ey1(n)  !! first derivatives of S and E
      real(wp), intent(in) :: sx2(n), sy2(n), ex2(n), ey2(n)  !! second derivatives of S and E
      real(wp), intent(in) :: px(n), py(n), qx(n), qy(n)
      real(wp), intent(out) :: inverse(n), sine2(n), wp1(n), wq1(n), wp2(n), wq2(n)
      real(wp) :: gx, gy, sine, to_p, to_q, along_p, along_q
      integer :: i

      to_p = 1.0_wp/p
      to_q = -1.0_wp/q
      do i = 1, n
         sine = px(i)*qy(i) - py(i)*qx(i)
         sine2(i) = sine*sine
         sine = 1.0_wp/sign(max(abs(sine), least), sine)
         sine = merge(sine, 0.0_wp, sine2(i) > limit)
         inverse(i) = sine
         gx = ex1(i) - sx1(i)
         gy = ey1(i) - sy1(i)
         along_p = (gx*qx(i) + gy*qy(i))*(sine*to_p)
         along_q = (gx*px(i) + gy*py(i))*(sine*to_q)
         wp1(i) = along_p
         wq1(i) = along_q
         along_p = p*along_p*along_p
         along_q = q*along_q*along_q
         gx = ex2(i) - sx2(i) + along_p*px(i) + along_q*qx(i)
         gy = ey2(i) - sy2(i) + along_p*py(i) + along_q*qy(i)
         wp2(i) = (gx*qx(i) + gy*qy(i))*(sine*to_p)
         wq2(i) = (gx*px(i) + gy*py(i))*(sine*to_q)
      end do
   end subroutine link_pair_second

   !> Link pair, third order.
   pure subroutine link_pair_third(n, p, q, sx, sy, ex, ey, px, py, qx, qy, inverse, wp1, wq1, wp2, wq2, wp3, wq3)
      integer, intent(in) :: n
      real(wp), intent(in) :: p, q
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)  !! third derivatives of S and E
      real(wp), intent(in) :: px(n), py(n), qx(n), qy(n), inverse(n), wp1(n), wq1(n), wp2(n), wq2(n)
      real(wp), intent(out) :: wp3(n), wq3(n)
      real(wp) :: gx, gy, to_p, to_q, along_p, along_q, across_p, across_q
      integer :: i

      to_p = 1.0_wp/p
      to_q = -1.0_wp/q
      do i = 1, n
         along_p = 3.0_wp*p*wp1(i)*wp2(i)
         along_q = 3.0_wp*q*wq1(i)*wq2(i)
         across_p = p*wp1(i)**3
         across_q = q*wq1(i)**3
         gx = ex(i) - sx(i) + along_p*px(i) + along_q*qx(i) - across_p*py(i) - across_q*qy(i)
         gy = ey(i) - sy(i) + along_p*py(i) + along_q*qy(i) + across_p*px(i) + across_q*qx(i)
         wp3(i) = (gx*qx(i) + gy*qy(i))*(inverse(i)*to_p)
         wq3(i) = (gx*px(i) + gy*py(i))*(inverse(i)*to_q)
      end do
   end subroutine link_pair_third

   !> Point at the end of an arc of fixed length, first and second order in one pass.
   pure subroutine turn_point_twice(n, ax, ay, fx1, fy1, fx2, fy2, rx, ry, w1, w2, tx1, ty1, tx2, ty2)
      integer, intent(in) :: n
      real(wp), intent(in) :: ax, ay                !! the arc in the axes of its root, sense included
      real(wp), intent(in) :: fx1(n), fy1(n), fx2(n), fy2(n), rx(n), ry(n), w1(n), w2(n)
      real(wp), intent(out) :: tx1(n), ty1(n), tx2(n), ty2(n)
      real(wp) :: x, y
      integer :: i

      do i = 1, n
         x = ax*rx(i) - ay*ry(i)
         y = ax*ry(i) + ay*rx(i)
         tx1(i) = fx1(i) - w1(i)*y
         ty1(i) = fy1(i) + w1(i)*x
         tx2(i) = fx2(i) - w1(i)*w1(i)*x - w2(i)*y
         ty2(i) = fy2(i) - w1(i)*w1(i)*y + w2(i)*x
      end do
   end subroutine turn_point_twice

   !> Point at the end of an arc of fixed length, third order.
   pure subroutine turn_point_third(n, ax, ay, fx, fy, rx, ry, w1, w2, w3, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: ax, ay                !! the arc in the axes of its root, sense included
      real(wp), intent(in) :: fx(n), fy(n), rx(n), ry(n), w1(n), w2(n), w3(n)
      real(wp), intent(out) :: tx(n), ty(n)
      real(wp) :: x, y
      integer :: i

      do i = 1, n
         x = ax*rx(i) - ay*ry(i)
         y = ax*ry(i) + ay*rx(i)
         tx(i) = fx(i) - 3.0_wp*w1(i)*w2(i)*x - (w3(i) - w1(i)**3)*y
         ty(i) = fy(i) - 3.0_wp*w1(i)*w2(i)*y + (w3(i) - w1(i)**3)*x
      end do
   end subroutine turn_point_third

   !> Point at the end of an arc of varying length, first and second order in one pass.
   pure subroutine slide_point_twice(n, c, s, fx1, fy1, fx2, fy2, rx, ry, w1, w2, length, l1, l2, tx1, ty1, tx2, ty2)
      integer, intent(in) :: n
      real(wp), intent(in) :: c, s                  !! the arc's direction in the axes of its root, sense included
      real(wp), intent(in) :: fx1(n), fy1(n), fx2(n), fy2(n), rx(n), ry(n), w1(n), w2(n), length(n), l1(n), l2(n)
      real(wp), intent(out) :: tx1(n), ty1(n), tx2(n), ty2(n)
      real(wp) :: x, y, along, across
      integer :: i

      do i = 1, n
         x = c*rx(i) - s*ry(i)
         y = c*ry(i) + s*rx(i)
         across = w1(i)*length(i)
         tx1(i) = fx1(i) + l1(i)*x - across*y
         ty1(i) = fy1(i) + l1(i)*y + across*x
         along = l2(i) - w1(i)*across
         across = 2.0_wp*w1(i)*l1(i) + w2(i)*length(i)
         tx2(i) = fx2(i) + along*x - across*y
         ty2(i) = fy2(i) + along*y + across*x
      end do
   end subroutine slide_point_twice

   !> Types 6 and 7, first and second order: both slides are projections of h on directions that turn together.
   !>
   !> L = h.u gives L' = h'.u + w1 h.iu and L'' = h''.u + 2 w1 h'.iu + (w2 iu - w1**2 u).h.
   pure subroutine projections_twice(n, sx, sy, ex, ey, sx1, sy1, ex1, ey1, sx2, sy2, ex2, ey2, rx, ry, w1, w2, cp, dp, cq, dq, &
                                     p1, q1, p2, q2)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)      !! S and E
      real(wp), intent(in) :: sx1(n), sy1(n), ex1(n), ey1(n)  !! their first derivatives
      real(wp), intent(in) :: sx2(n), sy2(n), ex2(n), ey2(n)  !! their second derivatives
      real(wp), intent(in) :: rx(n), ry(n), w1(n), w2(n)      !! root and derivatives of its angle
      real(wp), intent(in) :: cp, dp, cq, dq                  !! directions of the slides in the axes of the root
      real(wp), intent(out) :: p1(n), q1(n), p2(n), q2(n)
      real(wp) :: along, across, along1, across1, along2, across2
      integer :: i

      do i = 1, n
         ! h and its derivatives in the axes of the root
         along = (ex(i) - sx(i))*rx(i) + (ey(i) - sy(i))*ry(i)
         across = (ey(i) - sy(i))*rx(i) - (ex(i) - sx(i))*ry(i)
         along1 = (ex1(i) - sx1(i))*rx(i) + (ey1(i) - sy1(i))*ry(i)
         across1 = (ey1(i) - sy1(i))*rx(i) - (ex1(i) - sx1(i))*ry(i)
         along2 = (ex2(i) - sx2(i))*rx(i) + (ey2(i) - sy2(i))*ry(i)
         across2 = (ey2(i) - sy2(i))*rx(i) - (ex2(i) - sx2(i))*ry(i)
         ! what an observer on the root sees
         along2 = along2 + 2.0_wp*w1(i)*across1 + w2(i)*across - w1(i)*w1(i)*along
         across2 = across2 - 2.0_wp*w1(i)*along1 - w2(i)*along - w1(i)*w1(i)*across
         along1 = along1 + w1(i)*across
         across1 = across1 - w1(i)*along
         p1(i) = along1*cp + across1*dp
         q1(i) = along1*cq + across1*dq
         p2(i) = along2*cp + across2*dp
         q2(i) = along2*cq + across2*dq
      end do
   end subroutine projections_twice

   !> c = i (a + b): the column of an angle that turns both arcs of a dyad.
   pure subroutine quarter_turn_of_sum(n, ax, ay, bx, by, cx, cy)
      integer, intent(in) :: n
      real(wp), intent(in) :: ax(n), ay(n), bx(n), by(n)
      real(wp), intent(out) :: cx(n), cy(n)
      integer :: i

      do i = 1, n
         cx(i) = -(ay(i) + by(i))
         cy(i) = ax(i) + bx(i)
      end do
   end subroutine quarter_turn_of_sum

   !> Changes of one dimension: t = f + factor * ((dl + l1) e + (dw + w1) L i e).
   !>
   !> `dl` and `dw` are the same for all positions: the arc's own length or fixed angle changes at these rates.
   pure subroutine add_arc_change(n, factor, fx, fy, ex, ey, length, w1, l1, dw, dl, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: factor, dw, dl
      real(wp), intent(in) :: fx(n), fy(n), ex(n), ey(n), length(n), w1(n), l1(n)
      real(wp), intent(out) :: tx(n), ty(n)
      real(wp) :: along, across
      integer :: i

      do i = 1, n
         along = factor*(dl + l1(i))
         across = factor*((dw + w1(i))*length(i))
         tx(i) = fx(i) + along*ex(i) - across*ey(i)
         ty(i) = fy(i) + along*ey(i) + across*ex(i)
      end do
   end subroutine add_arc_change

   !> Reverse of a point step: what depends on the point t = f + arc is handed on to f, to the root and to the length.
   pure subroutine point_back(n, tx, ty, ex, ey, length, fx, fy, root, along)
      integer, intent(in) :: n
      real(wp), intent(in) :: tx(n), ty(n)           !! derivatives of the objective by the point
      real(wp), intent(in) :: ex(n), ey(n), length(n)
      real(wp), intent(inout) :: fx(n), fy(n)        !! by the point the arc starts from
      real(wp), intent(inout) :: root(n)             !! by the root's angle
      real(wp), intent(out) :: along(n)              !! by the arc's length
      integer :: i

      do i = 1, n
         fx(i) = fx(i) + tx(i)
         fy(i) = fy(i) + ty(i)
         root(i) = root(i) + (ty(i)*ex(i) - tx(i)*ey(i))*length(i)
         along(i) = tx(i)*ex(i) + ty(i)*ey(i)
      end do
   end subroutine point_back

   !> Reverse of a dyad: the multipliers M^T x of its equations go to its ends.
   pure subroutine dyad_back(n, x1, x2, m11, m12, m21, m22, sx, sy, ex, ey, gx, gy)
      integer, intent(in) :: n
      real(wp), intent(in) :: x1(n), x2(n)           !! derivatives of the objective by the unknowns
      real(wp), intent(in) :: m11(n), m12(n), m21(n), m22(n)
      real(wp), intent(inout) :: sx(n), sy(n), ex(n), ey(n) !! by S and E
      real(wp), intent(out) :: gx(n), gy(n)          !! multipliers
      integer :: i

      do i = 1, n
         gx(i) = m11(i)*x1(i) + m21(i)*x2(i)
         gy(i) = m12(i)*x1(i) + m22(i)*x2(i)
         ex(i) = ex(i) + gx(i)
         ey(i) = ey(i) + gy(i)
         sx(i) = sx(i) - gx(i)
         sy(i) = sy(i) - gy(i)
      end do
   end subroutine dyad_back

   !> Reverse of a dyad's arc: its known angle and length.
   pure subroutine arc_back(n, gx, gy, ex, ey, length, across, along)
      integer, intent(in) :: n
      real(wp), intent(in) :: gx(n), gy(n), ex(n), ey(n), length(n)
      real(wp), intent(out) :: across(n), along(n)   !! derivatives of the objective by angle and length
      integer :: i

      do i = 1, n
         across(i) = -(gy(i)*ex(i) - gx(i)*ey(i))*length(i)
         along(i) = -(gx(i)*ex(i) + gy(i)*ey(i))
      end do
   end subroutine arc_back

   !> Change of the cosine of a link pair's transmission angle: base + slope*reach - factor*(h . h').
   pure subroutine link_pair_change(n, sx, sy, ex, ey, dsx, dsy, dex, dey, reach, base, slope, factor, change)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)     !! outer joints S and E
      real(wp), intent(in) :: dsx(n), dsy(n), dex(n), dey(n) !! their changes
      real(wp), intent(in) :: reach(n)                       !! h**2
      real(wp), intent(in) :: base, slope, factor            !! parts that hang on the links
      real(wp), intent(out) :: change(n)
      integer :: i

      do i = 1, n
         change(i) = base + slope*reach(i) - factor*((ex(i) - sx(i))*(dex(i) - dsx(i)) + (ey(i) - sy(i))*(dey(i) - dsy(i)))
      end do
   end subroutine link_pair_change
end module psalm_rate_kernels
