!> Dyads RPP and PPR: two slides at right angles, one of them along a known direction. They can always be assembled.
module psalm_rpp
   use psalm_dyad, only: dyad_t
   use psalm_dyad_lanes, only: dyad_lanes_t
   use psalm_frames, only: frames_t, invert, rows_of_arc
   use psalm_kinds, only: wp
   use psalm_lanes, only: lanes
   use psalm_rows, only: rows_t
   implicit none (type, external)
   private
   public :: react_rpp
   public :: bind_rpp, solve_rpp, form_rpp, rates_twice_rpp, bounds_rpp
   public :: bind_rpp_lanes, solve_rpp_lanes
   public :: project_on_slides

   real(wp), parameter :: low = 0.0_wp, high = 2.0_wp !! limits of the measure

contains

   !> Limits of the measure, which is 1.
   pure subroutine bind_rpp(dyad)
      type(dyad_t), intent(inout) :: dyad

      dyad%closes_low = low
      dyad%closes_high = high
   end subroutine bind_rpp

   !> The same of linkages side by side.
   pure subroutine bind_rpp_lanes(numbers)
      type(dyad_lanes_t), intent(inout) :: numbers

      numbers%accepts_low = low
      numbers%accepts_high = high
   end subroutine bind_rpp_lanes

   !> Lengths of both slides.
   pure subroutine solve_rpp(n, dyad, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(inout) :: store

      associate (v => store%v)
         call project_on_slides(n, v(1, dyad%s_x), v(1, dyad%s_y), v(1, dyad%e_x), v(1, dyad%e_y), v(1, dyad%p_x), &
                                v(1, dyad%p_y), dyad%px, dyad%py, dyad%qx, dyad%qy, v(1, dyad%slide_p), v(1, dyad%slide_q), &
                                v(1, dyad%measure))
      end associate
   end subroutine solve_rpp

   !> `solve_rpp` for linkages side by side.
   pure subroutine solve_rpp_lanes(n, dyad, numbers, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(dyad_lanes_t), intent(in) :: numbers
      type(rows_t), intent(inout) :: store

      associate (v => store%v)
         call project_lanes(n, v(1, dyad%s_x), v(1, dyad%s_y), v(1, dyad%e_x), v(1, dyad%e_y), v(1, dyad%p_x), v(1, dyad%p_y), &
                            numbers%px, numbers%py, numbers%qx, numbers%qy, v(1, dyad%slide_p), v(1, dyad%slide_q), &
                            v(1, dyad%measure))
      end associate
   end subroutine solve_rpp_lanes

   !> Inverse matrix of the slides' directions.
   subroutine form_rpp(n, limit, at, frames)
      integer, intent(in) :: n, at
      real(wp), intent(in) :: limit
      type(frames_t), intent(inout) :: frames

      call invert(n, limit, at, at + rows_of_arc, at, frames)
   end subroutine form_rpp

   !> First and second derivatives of both lengths in one pass.
   subroutine rates_twice_rpp(n, dyad, store, d)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store
      type(rows_t), intent(inout) :: d(:)     !! by order

      associate (v => store%v, d1 => d(1)%v, d2 => d(2)%v, sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y)
         call projections_twice(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), d1(1, sx), d1(1, sy), d1(1, ex), d1(1, ey), &
                                d2(1, sx), d2(1, sy), d2(1, ex), d2(1, ey), v(1, dyad%p_x), v(1, dyad%p_y), d1(1, dyad%p_x), &
                                d2(1, dyad%p_x), dyad%px, dyad%py, dyad%qx, dyad%qy, d1(1, dyad%slide_p), &
                                d1(1, dyad%slide_q), d2(1, dyad%slide_p), d2(1, dyad%slide_q))
      end associate
   end subroutine rates_twice_rpp

   !> Force across the inner slide and couple, of p on q. Along the outer slide the force alone holds the body between the two.
   pure subroutine react_rpp(n, sense, ix, iy, ox, oy, slide, moment, along, across, couple)
      integer, intent(in) :: n
      real(wp), intent(in) :: sense                      !! +1: the pin is S (p slides on q), -1: it is E
      real(wp), intent(in) :: ix(n), iy(n), ox(n), oy(n) !! directions of the inner slide and of the outer one
      real(wp), intent(in) :: slide(n)                   !! length of the inner one
      real(wp), intent(in) :: moment(n), along(n)        !! free components of the wrenches at the pin and along the outer slide
      real(wp), intent(out) :: across(n), couple(n)
      integer :: i

      do i = 1, n
         ! the slides are at right angles: the product is +1 or -1
         across(i) = -sense*along(i)/(ix(i)*oy(i) - iy(i)*ox(i))
         couple(i) = sense*(moment(i) - across(i)*slide(i))
      end do
   end subroutine react_rpp

   !> First-order bound of the errors of both lengths.
   pure subroutine bounds_rpp(h, gap, direction, bound)
      real(wp), intent(in) :: h, gap
      real(wp), intent(in) :: direction(2)    !! bounds of the directions of p and q
      real(wp), intent(out) :: bound(2)

      bound = gap + h*direction(1)
   end subroutine bounds_rpp

   ! ---- kernels -----------------------------------------------------------------------------------------------------

   !> Two slides at right angles; their lengths are the projections of h. They always close.
   pure subroutine project_on_slides(n, sx, sy, ex, ey, rx, ry, cp, dp, cq, dq, slide_p, slide_q, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: rx(n), ry(n)       !! unit vector of the root both slides are fixed to
      real(wp), intent(in) :: cp, dp, cq, dq     !! cosine, sine of the fixed angles from it to p and to q
      real(wp), intent(out) :: slide_p(n), slide_q(n), reach(n) !! signed lengths; 1
      integer :: i

      do i = 1, n
         call project(ex(i) - sx(i), ey(i) - sy(i), rx(i), ry(i), cp, dp, cq, dq, slide_p(i), slide_q(i), reach(i))
      end do
   end subroutine project_on_slides

   !> `project_on_slides` for linkages side by side.
   pure subroutine project_lanes(n, sx, sy, ex, ey, rx, ry, cp, dp, cq, dq, slide_p, slide_q, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(lanes, n), sy(lanes, n), ex(lanes, n), ey(lanes, n), rx(lanes, n), ry(lanes, n)
      real(wp), intent(in) :: cp(lanes), dp(lanes), cq(lanes), dq(lanes)
      real(wp), intent(out) :: slide_p(lanes, n), slide_q(lanes, n), reach(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            call project(ex(l, i) - sx(l, i), ey(l, i) - sy(l, i), rx(l, i), ry(l, i), cp(l), dp(l), cq(l), dq(l), slide_p(l, i), &
                         slide_q(l, i), reach(l, i))
         end do
      end do
   end subroutine project_lanes

   !> Projections of h at one position.
   elemental subroutine project(hx, hy, rx, ry, cp, dp, cq, dq, slide_p, slide_q, reach)
      real(wp), intent(in) :: hx, hy, rx, ry, cp, dp, cq, dq
      real(wp), intent(out) :: slide_p, slide_q, reach
      real(wp) :: along, across

      along = hx*rx + hy*ry
      across = hy*rx - hx*ry
      slide_p = along*cp + across*dp
      slide_q = along*cq + across*dq
      reach = 1.0_wp
   end subroutine project

   !> First and second order: both slides are projections of h on directions that turn together.
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
end module psalm_rpp
