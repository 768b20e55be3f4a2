!> Kernels of arcs and points, which no kind of Assur group owns: vectors, their derivatives, the reverse of both.
!>
!> An arc L e, with e a unit vector whose angle has the derivatives w1, w2, w3 and L the derivatives l1, l2, l3, has
!>   order 1: l1 e + w1 L i e
!>   order 2: (l2 - w1**2 L) e + (2 w1 l1 + w2 L) i e
!>   order 3: (l3 - 3 w1**2 l1 - 3 w1 w2 L) e + (3 w1 l2 + 3 w2 l1 + (w3 - w1**3) L) i e
!> Derivatives are with respect to one parameter: the input, a dimension. A dyad's unknowns x1, x2 of the highest order obey
!> c1 x1 + c2 x2 = g with the same matrix in every order. All arrays have the shape (n). Derivation: `doc/theory/rates.md`.
module psalm_arc_kernels
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: arc_vector, add_arc_rate, add_arc_change, add_change_of_rate, difference
   public :: change_ends, change_ends_and_arcs
   public :: invert_columns, solve_columns, quarter_turn_of_sum
   public :: turn_point_twice, turn_point_third, slide_point_twice
   public :: least

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

   !> Changes of a dyad's unknowns where its outer joints alone move: `difference` and `solve_columns` in one pass.
   pure subroutine change_ends(n, sx, sy, ex, ey, m11, m12, m21, m22, x1, x2)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n), m11(n), m12(n), m21(n), m22(n)
      real(wp), intent(out) :: x1(n), x2(n)
      real(wp) :: gx, gy
      integer :: i

      do i = 1, n
         gx = ex(i) - sx(i)
         gy = ey(i) - sy(i)
         x1(i) = m11(i)*gx + m12(i)*gy
         x2(i) = m21(i)*gx + m22(i)*gy
      end do
   end subroutine change_ends

   !> The same where the arcs p and q change, too: `add_arc_change` of both, with the factor -1, before it is solved.
   pure subroutine change_ends_and_arcs(n, sx, sy, ex, ey, px, py, p, pw, pl, dpw, dpl, qx, qy, q, qw, ql, dqw, dql, &
                                        m11, m12, m21, m22, x1, x2)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: px(n), py(n), p(n), pw(n), pl(n) !! unit vector, length; changes of angle and length of the root
      real(wp), intent(in) :: dpw, dpl                         !! of the arc's own angle and length
      real(wp), intent(in) :: qx(n), qy(n), q(n), qw(n), ql(n), dqw, dql
      real(wp), intent(in) :: m11(n), m12(n), m21(n), m22(n)
      real(wp), intent(out) :: x1(n), x2(n)
      real(wp) :: gx, gy, along, across
      integer :: i

      do i = 1, n
         gx = ex(i) - sx(i)
         gy = ey(i) - sy(i)
         along = -(dpl + pl(i))
         across = -((dpw + pw(i))*p(i))
         gx = gx + along*px(i) - across*py(i)
         gy = gy + along*py(i) + across*px(i)
         along = -(dql + ql(i))
         across = -((dqw + qw(i))*q(i))
         gx = gx + along*qx(i) - across*qy(i)
         gy = gy + along*qy(i) + across*qx(i)
         x1(i) = m11(i)*gx + m12(i)*gy
         x2(i) = m21(i)*gx + m22(i)*gy
      end do
   end subroutine change_ends_and_arcs

   !> t = f + factor * change of an arc's derivative of order 1 or 2 with one dimension.
   !>
   !> w1, w2, l1, l2 are the derivatives of the arc's angle and length by the input; h0, h1, h2 and g0, g1, g2 are the changes with
   !> the dimension of angle and length and of these derivatives. For the part of a dyad's arc that is known, rows of the unknown
   !> highest order hold zero. `dw` and `dl` are the rates of the arc's own fixed angle and length.
   pure subroutine add_change_of_rate(n, order, factor, fx, fy, ex, ey, length, w1, w2, l1, l2, h0, h1, h2, g0, g1, g2, dw, dl, &
                                      tx, ty)
      integer, intent(in) :: n, order
      real(wp), intent(in) :: factor, dw, dl
      real(wp), intent(in) :: fx(n), fy(n), ex(n), ey(n), length(n)
      real(wp), intent(in) :: w1(n), w2(n), l1(n), l2(n), h0(n), h1(n), h2(n), g0(n), g1(n), g2(n)
      real(wp), intent(out) :: tx(n), ty(n)
      real(wp) :: along, across, h, g
      integer :: i

      if (order == 1) then
         do i = 1, n
            h = h0(i) + dw
            g = g0(i) + dl
            along = factor*(g1(i) - w1(i)*h*length(i))
            across = factor*(g*w1(i) + l1(i)*h + h1(i)*length(i))
            tx(i) = fx(i) + along*ex(i) - across*ey(i)
            ty(i) = fy(i) + along*ey(i) + across*ex(i)
         end do
      else
         do i = 1, n
            h = h0(i) + dw
            g = g0(i) + dl
            along = factor*(g2(i) - g*w1(i)**2 - 2.0_wp*l1(i)*w1(i)*h - (2.0_wp*w1(i)*h1(i) + w2(i)*h)*length(i))
            across = factor*(2.0_wp*(g1(i)*w1(i) + l1(i)*h1(i)) + g*w2(i) + l2(i)*h + (h2(i) - w1(i)**2*h)*length(i))
            tx(i) = fx(i) + along*ex(i) - across*ey(i)
            ty(i) = fy(i) + along*ey(i) + across*ex(i)
         end do
      end if
   end subroutine add_change_of_rate
end module psalm_arc_kernels
