!> Dyad PRP: two slides along known directions, a revolute joint between them.
!>
!> Closure measure: the sine of the angle from p to q, with its sign; the dyad closes while it is not zero. Where it changes its
!> sign between two inputs the slides have been parallel, and their joint at infinity.
module psalm_prp
   use psalm_angles, only: arc_sine
   use psalm_dyad, only: dyad_t, dyad_violation_t, violation_parallel, violation_slides, rounding
   use psalm_dyad_lanes, only: dyad_lanes_t
   use psalm_frames, only: frames_t, invert, rows_of_arc
   use psalm_kinds, only: wp
   use psalm_lanes, only: lanes
   use psalm_rows, only: rows_t
   implicit none (type, external)
   private
   public :: react_prp
   public :: bind_prp, solve_prp, form_prp, measure_prp, change_of_measure_prp, bounds_prp, violation_prp
   public :: bind_prp_lanes, solve_prp_lanes
   public :: solve_two_slides

   real(wp), parameter :: least_sine = 16.0_wp*epsilon(1.0_wp) !! two slides at a smaller angle are parallel

   real(wp), parameter :: high = 2.0_wp                        !! limit of the measure that is never reached

contains

   !> Limits of the amount of the measure.
   pure subroutine bind_prp(dyad, sine_lowest)
      type(dyad_t), intent(inout) :: dyad
      real(wp), intent(in) :: sine_lowest     !! sine of the smallest angle between two slides allowed

      dyad%closes_low = least_sine
      dyad%closes_high = high
      dyad%accepts_low = max(sine_lowest - rounding, least_sine)
      dyad%accepts_high = high
   end subroutine bind_prp

   !> The same of linkages side by side: limits of what is accepted.
   pure subroutine bind_prp_lanes(numbers, sine_lowest)
      type(dyad_lanes_t), intent(inout) :: numbers
      real(wp), intent(in) :: sine_lowest

      numbers%accepts_low = max(sine_lowest - rounding, least_sine)
      numbers%accepts_high = high
   end subroutine bind_prp_lanes

   !> Lengths of both slides.
   pure subroutine solve_prp(n, dyad, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(inout) :: store

      associate (v => store%v)
         call solve_two_slides(n, v(1, dyad%s_x), v(1, dyad%s_y), v(1, dyad%e_x), v(1, dyad%e_y), v(1, dyad%p_x), &
                               v(1, dyad%p_y), dyad%px, dyad%py, v(1, dyad%q_x), v(1, dyad%q_y), dyad%qx, dyad%qy, &
                               v(1, dyad%slide_p), v(1, dyad%slide_q), v(1, dyad%measure))
      end associate
   end subroutine solve_prp

   !> `solve_prp` for linkages side by side.
   pure subroutine solve_prp_lanes(n, dyad, numbers, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(dyad_lanes_t), intent(in) :: numbers
      type(rows_t), intent(inout) :: store

      associate (v => store%v)
         call solve_two_slides_lanes(n, v(1, dyad%s_x), v(1, dyad%s_y), v(1, dyad%e_x), v(1, dyad%e_y), v(1, dyad%p_x), &
                                     v(1, dyad%p_y), numbers%px, numbers%py, v(1, dyad%q_x), v(1, dyad%q_y), numbers%qx, &
                                     numbers%qy, v(1, dyad%slide_p), v(1, dyad%slide_q), v(1, dyad%measure))
      end associate
   end subroutine solve_prp_lanes

   !> Inverse matrix of the slides' directions.
   subroutine form_prp(n, limit, at, frames)
      integer, intent(in) :: n, at
      real(wp), intent(in) :: limit
      type(frames_t), intent(inout) :: frames

      call invert(n, limit, at, at + rows_of_arc, at, frames)
   end subroutine form_prp

   !> First-order bounds of the errors of both lengths.
   pure subroutine bounds_prp(measure, slide, h, gap, direction, bound)
      real(wp), intent(in) :: measure, h, gap
      real(wp), intent(in) :: slide(2)        !! lengths of p and q
      real(wp), intent(in) :: direction(2)    !! bounds of their directions
      real(wp), intent(out) :: bound(2)
      real(wp) :: sine

      sine = max(abs(measure), epsilon(1.0_wp))
      bound = (gap + h*direction([2, 1]) + abs(slide)*(direction(1) + direction(2) + 1.0_wp))/sine
   end subroutine bounds_prp

   !> 1 less the sine between the slides: above 1 past parallel, so that nothing slips through at a point.
   pure subroutine measure_prp(n, dyad, store, side, k)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store
      real(wp), intent(in) :: side            !! +1 or -1: sign of the sine that is wanted
      real(wp), intent(out) :: k(:)

      k = 1.0_wp - side*store%v(1:n, dyad%measure)
   end subroutine measure_prp

   !> Change of that with a variable: what the sine loses where the angle from p to q turns.
   pure subroutine change_of_measure_prp(n, dyad, store, d, side, unit, turn_p, turn_q, dk)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store, d
      real(wp), intent(in) :: side, unit, turn_p, turn_q
      real(wp), intent(out) :: dk(n)
      real(wp) :: hx, hy, ux, uy, turn
      integer :: i

      associate (v => store%v, px => dyad%p_x, py => dyad%p_y, qx => dyad%q_x, qy => dyad%q_y)
         do i = 1, n
            hx = dyad%px*v(i, px) - dyad%py*v(i, py)
            hy = dyad%px*v(i, py) + dyad%py*v(i, px)
            ux = dyad%qx*v(i, qx) - dyad%qy*v(i, qy)
            uy = dyad%qx*v(i, qy) + dyad%qy*v(i, qx)
            turn = d%v(i, qx) + turn_q - d%v(i, px) - turn_p
            dk(i) = -side*(hx*ux + hy*uy)*turn*unit
         end do
      end associate
   end subroutine change_of_measure_prp

   !> Force of p on q in the common pin, from its components along both slides. Singular where they are parallel.
   pure subroutine react_prp(n, px, py, qx, qy, alpha, beta, rx, ry)
      integer, intent(in) :: n
      real(wp), intent(in) :: px(n), py(n), qx(n), qy(n) !! directions of p and q
      real(wp), intent(in) :: alpha(n), beta(n)          !! forces on p along p, on q along q
      real(wp), intent(out) :: rx(n), ry(n)
      real(wp) :: determinant
      integer :: i

      do i = 1, n
         determinant = px(i)*qy(i) - py(i)*qx(i)
         determinant = 1.0_wp/sign(max(abs(determinant), epsilon(1.0_wp)**2), determinant)
         rx(i) = (alpha(i)*qy(i) + beta(i)*py(i))*determinant
         ry(i) = -(alpha(i)*qx(i) + beta(i)*px(i))*determinant
      end do
   end subroutine react_prp

   !> What is wrong at a position whose measure is not accepted.
   pure type(dyad_violation_t) function violation_prp(measure, closes) result(violation)
      real(wp), intent(in) :: measure
      logical, intent(in) :: closes

      violation%kind = violation_parallel
      if (.not. closes) return
      violation%kind = violation_slides
      violation%amount = arc_sine(min(abs(measure), 1.0_wp))
   end function violation_prp

   ! ---- kernels -----------------------------------------------------------------------------------------------------

   !> Two slides along known directions; two linear equations.
   !>
   !> `reach` is the sine of the angle from p to q.
   pure subroutine solve_two_slides(n, sx, sy, ex, ey, rx, ry, cp, dp, tx, ty, cq, dq, slide_p, slide_q, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: rx(n), ry(n), cp, dp !! root of p, and the fixed angle from it to p
      real(wp), intent(in) :: tx(n), ty(n), cq, dq !! likewise for q
      real(wp), intent(out) :: slide_p(n), slide_q(n), reach(n) !! signed lengths; signed sine
      integer :: i

      do i = 1, n
         call place_two_slides(ex(i) - sx(i), ey(i) - sy(i), cp*rx(i) - dp*ry(i), cp*ry(i) + dp*rx(i), cq*tx(i) - dq*ty(i), &
                               cq*ty(i) + dq*tx(i), slide_p(i), slide_q(i), reach(i))
      end do
   end subroutine solve_two_slides

   !> `solve_two_slides` for linkages side by side.
   pure subroutine solve_two_slides_lanes(n, sx, sy, ex, ey, rx, ry, cp, dp, tx, ty, cq, dq, slide_p, slide_q, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(lanes, n), sy(lanes, n), ex(lanes, n), ey(lanes, n)
      real(wp), intent(in) :: rx(lanes, n), ry(lanes, n), cp(lanes), dp(lanes)
      real(wp), intent(in) :: tx(lanes, n), ty(lanes, n), cq(lanes), dq(lanes)
      real(wp), intent(out) :: slide_p(lanes, n), slide_q(lanes, n), reach(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            call place_two_slides(ex(l, i) - sx(l, i), ey(l, i) - sy(l, i), cp(l)*rx(l, i) - dp(l)*ry(l, i), &
                                  cp(l)*ry(l, i) + dp(l)*rx(l, i), cq(l)*tx(l, i) - dq(l)*ty(l, i), &
                                  cq(l)*ty(l, i) + dq(l)*tx(l, i), slide_p(l, i), slide_q(l, i), reach(l, i))
         end do
      end do
   end subroutine solve_two_slides_lanes

   !> Lengths along the directions u and v at one position.
   elemental subroutine place_two_slides(hx, hy, ux, uy, vx, vy, slide_p, slide_q, reach)
      real(wp), intent(in) :: hx, hy, ux, uy, vx, vy
      real(wp), intent(out) :: slide_p, slide_q, reach
      real(wp) :: det

      det = ux*vy - uy*vx
      reach = det
      det = 1.0_wp/sign(max(abs(det), epsilon(1.0_wp)**2), det)
      slide_p = (hx*vy - hy*vx)*det
      slide_q = (ux*hy - uy*hx)*det
   end subroutine place_two_slides
end module psalm_prp
