!> The eight dyads in closed form, for many positions at once.
!>
!> A dyad is a pair of arcs p, q with p + q = h, where h = E - S leads from the start of p to the finish of q. Directions
!> are unit vectors; no trigonometric function is called. There is no branch around a root: a radicand below zero is
!> clamped, and `reach` tells the caller afterwards, position by position, whether the dyad closes. Every array has the
!> shape (n), n positions. Derivation: `doc/theory.md`; source of the types: Oldham (1977), chapters 4 and 5.
module psalm_dyads
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: solve_two_links, solve_one_link, solve_slide_on_q, solve_slide_on_p, solve_link_slide
   public :: project_on_slides, solve_two_slides, least_square

   real(wp), parameter :: least_square = tiny(1.0_wp)**0.8_wp !! guards a division; such a dyad is reported as open
   real(wp), parameter :: least_length = tiny(1.0_wp)**0.4_wp !! the same for the length of a link
   real(wp), parameter :: largest_half = 0.25_wp*huge(1.0_wp)*least_square !! so that 1/least_square times it is finite

contains

   !> Type 1, link p and link q: the triangle on h.
   !>
   !> `reach` is h**2: closed while (p-q)**2 <= reach <= (p+q)**2. With s = +1 the common joint lies right of S -> E.
   pure subroutine solve_two_links(n, sx, sy, ex, ey, p, q, s, px, py, qx, qy, reach)
      integer, intent(in) :: n                          !! positions
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n) !! S and E, [length]
      real(wp), intent(in) :: p, q                      !! lengths, > 0
      real(wp), intent(in) :: s                         !! assembly, +1 or -1
      real(wp), intent(out) :: px(n), py(n), qx(n), qy(n) !! unit vectors of p and q
      real(wp), intent(out) :: reach(n)                 !! h**2, [length**2]
      real(wp) :: hx, hy, d, root, along_p, along_q, sum2, diff2, product, half_p, half_q
      integer :: i

      sum2 = (p + q)**2
      diff2 = (p - q)**2
      product = (p - q)*(p + q)
      half_p = half_of(p)
      half_q = half_of(q)
      do i = 1, n
         hx = ex(i) - sx(i)
         hy = ey(i) - sy(i)
         d = hx*hx + hy*hy
         reach(i) = d
         root = s*sqrt(max((sum2 - d)*(d - diff2), 0.0_wp))
         along_p = d + product
         along_q = d - product
         d = 1.0_wp/max(d, least_square)
         px(i) = (along_p*hx + root*hy)*(d*half_p)
         py(i) = (along_p*hy - root*hx)*(d*half_p)
         qx(i) = (along_q*hx - root*hy)*(d*half_q)
         qy(i) = (along_q*hy + root*hx)*(d*half_q)
      end do
   end subroutine solve_two_links

   !> Type 1 where only one of the two directions is wanted: that of the link `a`; `b` is the other.
   !>
   !> With t = +1 the joint lies right of the line from where `a` leaves h: t = s for a = p, t = -s for a = q.
   pure subroutine solve_one_link(n, sx, sy, ex, ey, a, b, t, ax, ay, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: a, b                      !! lengths, > 0
      real(wp), intent(in) :: t                         !! assembly, +1 or -1
      real(wp), intent(out) :: ax(n), ay(n), reach(n)   !! unit vector of a; h**2
      real(wp) :: hx, hy, d, root, along, sum2, diff2, product, half
      integer :: i

      sum2 = (a + b)**2
      diff2 = (a - b)**2
      product = (a - b)*(a + b)
      half = half_of(a)
      do i = 1, n
         hx = ex(i) - sx(i)
         hy = ey(i) - sy(i)
         d = hx*hx + hy*hy
         reach(i) = d
         root = t*sqrt(max((sum2 - d)*(d - diff2), 0.0_wp))
         along = d + product
         d = (1.0_wp/max(d, least_square))*half
         ax(i) = (along*hx + root*hy)*d
         ay(i) = (along*hy - root*hx)*d
      end do
   end subroutine solve_one_link

   !> 0.5/length; what a length too short to have a direction gives stays finite when it is divided by `least_square`.
   elemental real(wp) function half_of(length)
      real(wp), intent(in) :: length             !! > 0

      half_of = 0.5_wp/max(length, 0.5_wp/largest_half)
   end function half_of

   !> Type 2, slide p guided by q: q is the guide, at right angles to p.
   !>
   !> `reach` is h**2: closed while reach >= q**2.
   pure subroutine solve_slide_on_q(n, sx, sy, ex, ey, q, s, px, py, slide, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: q                  !! length of the guide, >= 0
      real(wp), intent(in) :: s                  !! +1: the guide's direction is 90 degrees anticlockwise from the slide's
      real(wp), intent(out) :: px(n), py(n)      !! unit vector of the slide
      real(wp), intent(out) :: slide(n), reach(n) !! length of the slide; h**2
      real(wp) :: hx, hy, d, length, side
      integer :: i

      side = s*q
      do i = 1, n
         hx = ex(i) - sx(i)
         hy = ey(i) - sy(i)
         d = hx*hx + hy*hy
         reach(i) = d
         length = sqrt(max(d - q*q, 0.0_wp))
         slide(i) = length
         d = 1.0_wp/max(d, least_square)
         px(i) = (hx*length + hy*side)*d
         py(i) = (hy*length - hx*side)*d
      end do
   end subroutine solve_slide_on_q

   !> Type 3, slide q guided by p: p is the guide.
   !>
   !> `reach` is h**2: closed while reach >= p**2.
   pure subroutine solve_slide_on_p(n, sx, sy, ex, ey, p, t, px, py, slide, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: p                  !! length of the guide, >= 0
      real(wp), intent(in) :: t                  !! +1: the slide's direction is 90 degrees anticlockwise from the guide's
      real(wp), intent(out) :: px(n), py(n)      !! unit vector of the guide
      real(wp), intent(out) :: slide(n), reach(n) !! length of the slide; h**2
      real(wp) :: hx, hy, d, length, side
      integer :: i

      do i = 1, n
         hx = ex(i) - sx(i)
         hy = ey(i) - sy(i)
         d = hx*hx + hy*hy
         reach(i) = d
         length = sqrt(max(d - p*p, 0.0_wp))
         slide(i) = length
         side = t*length
         d = 1.0_wp/max(d, least_square)
         px(i) = (hx*p + hy*side)*d
         py(i) = (hy*p - hx*side)*d
      end do
   end subroutine solve_slide_on_p

   !> Type 4, link p and slide q along a known direction u; type 5, slide p and link q, is the same with -s.
   !>
   !> `reach` is the offset cross(u, h): closed while abs(reach) <= p.
   pure subroutine solve_link_slide(n, sx, sy, ex, ey, p, s, rx, ry, c, d, px, py, slide, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: p                  !! length of the link, > 0
      real(wp), intent(in) :: s                  !! assembly, type 4: +1 if the common joint lies beyond the foot, along u
      real(wp), intent(in) :: rx(n), ry(n)       !! unit vector of a root
      real(wp), intent(in) :: c, d               !! cosine, sine of the fixed angle from the root to u
      real(wp), intent(out) :: px(n), py(n)      !! unit vector of the link
      real(wp), intent(out) :: slide(n), reach(n) !! signed length of the slide; offset
      real(wp) :: hx, hy, ux, uy, offset, root, length
      integer :: i

      length = max(p, least_length)
      do i = 1, n
         hx = ex(i) - sx(i)
         hy = ey(i) - sy(i)
         ux = c*rx(i) - d*ry(i)
         uy = c*ry(i) + d*rx(i)
         offset = ux*hy - uy*hx
         reach(i) = offset
         root = s*sqrt(max((p - offset)*(p + offset), 0.0_wp))
         slide(i) = hx*ux + hy*uy - root
         px(i) = (root*ux - offset*uy)/length
         py(i) = (root*uy + offset*ux)/length
      end do
   end subroutine solve_link_slide

   !> Types 6 and 7: two slides at right angles; their lengths are the projections of h. They always close.
   pure subroutine project_on_slides(n, sx, sy, ex, ey, rx, ry, cp, dp, cq, dq, slide_p, slide_q, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: rx(n), ry(n)       !! unit vector of the root both slides are fixed to
      real(wp), intent(in) :: cp, dp, cq, dq     !! cosine, sine of the fixed angles from it to p and to q
      real(wp), intent(out) :: slide_p(n), slide_q(n), reach(n) !! signed lengths; 1
      real(wp) :: hx, hy, along, across
      integer :: i

      do i = 1, n
         hx = ex(i) - sx(i)
         hy = ey(i) - sy(i)
         along = hx*rx(i) + hy*ry(i)
         across = hy*rx(i) - hx*ry(i)
         slide_p(i) = along*cp + across*dp
         slide_q(i) = along*cq + across*dq
         reach(i) = 1.0_wp
      end do
   end subroutine project_on_slides

   !> Type 8: two slides along known directions; two linear equations.
   !>
   !> `reach` is the sine of the angle from p to q: closed while it is not zero. Where it changes its sign between two inputs the
   !> slides have been parallel, and their joint at infinity.
   pure subroutine solve_two_slides(n, sx, sy, ex, ey, rx, ry, cp, dp, tx, ty, cq, dq, slide_p, slide_q, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: rx(n), ry(n), cp, dp !! root of p, and the fixed angle from it to p
      real(wp), intent(in) :: tx(n), ty(n), cq, dq !! likewise for q
      real(wp), intent(out) :: slide_p(n), slide_q(n), reach(n) !! signed lengths; signed sine
      real(wp) :: hx, hy, ux, uy, vx, vy, det
      integer :: i

      do i = 1, n
         hx = ex(i) - sx(i)
         hy = ey(i) - sy(i)
         ux = cp*rx(i) - dp*ry(i)
         uy = cp*ry(i) + dp*rx(i)
         vx = cq*tx(i) - dq*ty(i)
         vy = cq*ty(i) + dq*tx(i)
         det = ux*vy - uy*vx
         reach(i) = det
         det = 1.0_wp/sign(max(abs(det), epsilon(1.0_wp)**2), det)
         slide_p(i) = (hx*vy - hy*vx)*det
         slide_q(i) = (ux*hy - uy*hx)*det
      end do
   end subroutine solve_two_slides
end module psalm_dyads
