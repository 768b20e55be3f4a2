!> Dyad RPR: a slide between two revolute joints, guided at right angles by the other arc, the guide.
!>
!> Slide p with guide q, or guide p with slide q. Closure measure: the squared distance h**2 of the outer joints; the dyad
!> closes while h is not shorter than the guide. Notes of `psalm_rrr` on kernels hold here too.
module psalm_rpr
   use psalm_arc_kernels, only: least
   use psalm_dyad, only: dyad_t, dyad_violation_t, violation_too_long, violation_toggle, least_square, no_distance, rounding
   use psalm_dyad_kind, only: assur_rpr
   use psalm_dyad_lanes, only: dyad_lanes_t
   use psalm_frames, only: frames_t, turned_column, invert, rows_of_arc
   use psalm_kinds, only: wp
   use psalm_lanes, only: lanes
   use psalm_rows, only: rows_t
   implicit none (type, external)
   private
   public :: react_rpr
   public :: bind_rpr, solve_rpr, form_rpr, measure_rpr, change_of_measure_rpr, bounds_rpr, violation_rpr, repair_rpr, &
             coincidence_rpr, guide_of
   public :: bind_rpr_lanes, solve_rpr_lanes
   public :: solve_slide_on_q, solve_slide_on_p

contains

   !> Length of the guide.
   pure real(wp) function guide_of(dyad)
      type(dyad_t), intent(in) :: dyad

      guide_of = merge(dyad%q, dyad%p, dyad%kind == assur_rpr)
   end function guide_of

   !> Limits of the measure.
   pure subroutine bind_rpr(dyad, toggle)
      type(dyad_t), intent(inout) :: dyad
      real(wp), intent(in) :: toggle    !! to spare where the dyad is accepted, scaled as its lengths
      real(wp) :: guide

      guide = guide_of(dyad)
      dyad%closes_low = max(guide*guide*(1.0_wp - rounding), least_square)
      dyad%closes_high = huge(guide)
      dyad%accepts_low = least_accepted(guide, toggle)
      dyad%accepts_high = dyad%closes_high
   end subroutine bind_rpr

   !> The same of linkages side by side: limits of what is accepted.
   pure subroutine bind_rpr_lanes(kind, numbers, toggle)
      integer, intent(in) :: kind
      type(dyad_lanes_t), intent(inout) :: numbers
      real(wp), intent(in) :: toggle

      if (kind == assur_rpr) then
         numbers%accepts_low = least_accepted(numbers%q, toggle)
      else
         numbers%accepts_low = least_accepted(numbers%p, toggle)
      end if
      numbers%accepts_high = huge(toggle)
   end subroutine bind_rpr_lanes

   !> The least squared distance of the outer joints that is accepted.
   elemental real(wp) function least_accepted(guide, toggle)
      real(wp), intent(in) :: guide, toggle

      least_accepted = max((guide + toggle)**2*(1.0_wp - rounding), least_square)
   end function least_accepted

   !> Direction and length of the slide.
   pure subroutine solve_rpr(n, dyad, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(inout) :: store

      associate (v => store%v, sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y, px => dyad%p_x, py => dyad%p_y)
         if (dyad%kind == assur_rpr) then
            call solve_slide_on_q(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), dyad%q, dyad%sign, v(1, px), v(1, py), &
                                  v(1, dyad%slide_p), v(1, dyad%measure))
         else
            call solve_slide_on_p(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), dyad%p, dyad%sign, v(1, px), v(1, py), &
                                  v(1, dyad%slide_q), v(1, dyad%measure))
         end if
      end associate
   end subroutine solve_rpr

   !> `solve_rpr` for linkages side by side.
   pure subroutine solve_rpr_lanes(n, dyad, numbers, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(dyad_lanes_t), intent(in) :: numbers
      type(rows_t), intent(inout) :: store

      associate (v => store%v, sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y, px => dyad%p_x, py => dyad%p_y)
         if (dyad%kind == assur_rpr) then
            call solve_slide_on_q_lanes(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), numbers%q, dyad%sign, v(1, px), v(1, py), &
                                        v(1, dyad%slide_p), v(1, dyad%measure))
         else
            call solve_slide_on_p_lanes(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), numbers%p, dyad%sign, v(1, px), v(1, py), &
                                        v(1, dyad%slide_q), v(1, dyad%measure))
         end if
      end associate
   end subroutine solve_rpr_lanes

   !> Inverse matrix: an angle that turns both arcs, and the slide.
   subroutine form_rpr(n, limit, dyad, at, frames)
      integer, intent(in) :: n, at
      real(wp), intent(in) :: limit
      type(dyad_t), intent(in) :: dyad
      type(frames_t), intent(inout) :: frames

      call turned_column(n, frames, at, at + rows_of_arc, 1)
      call invert(n, limit, frames%scratch, merge(at, at + rows_of_arc, dyad%kind == assur_rpr), at, frames)
   end subroutine form_rpr

   !> Guide and clearance over distance: the dyad closes, with the clearance to spare, while it is at most 1.
   pure subroutine measure_rpr(n, dyad, store, clearance, k)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store
      real(wp), intent(in) :: clearance
      real(wp), intent(out) :: k(:)

      k = (guide_of(dyad) + clearance)/sqrt(max(store%v(1:n, dyad%measure), tiny(1.0_wp)))
   end subroutine measure_rpr

   !> Change of that with a variable that changes the lengths by `dp`, `dq` and moves the outer joints.
   pure subroutine change_of_measure_rpr(n, dyad, store, d, clearance, unit, dp, dq, dk)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store, d
      real(wp), intent(in) :: clearance, unit, dp, dq
      real(wp), intent(out) :: dk(n)
      real(wp) :: hx, hy, gx, gy, h
      integer :: i

      associate (v => store%v, sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y)
         do i = 1, n
            hx = v(i, ex) - v(i, sx)
            hy = v(i, ey) - v(i, sy)
            gx = d%v(i, ex) - d%v(i, sx)
            gy = d%v(i, ey) - d%v(i, sy)
            h = sqrt(max(v(i, dyad%measure), tiny(1.0_wp)))
            dk(i) = merge(dq, dp, dyad%kind == assur_rpr)/h - (guide_of(dyad) + clearance)*(hx*gx + hy*gy)/(h*h*h)
         end do
      end associate
      dk = dk*unit
   end subroutine change_of_measure_rpr

   !> Force across the slide and couple, of p on q. The moments about S and E balance; the lever is the slide's length.
   pure subroutine react_rpr(n, slide_first, slide, alpha, beta, across, couple)
      integer, intent(in) :: n
      logical, intent(in) :: slide_first                 !! p is the slide
      real(wp), intent(in) :: slide(n)                   !! its length
      real(wp), intent(in) :: alpha(n), beta(n)          !! moments of the wrenches on p about S, on q about E
      real(wp), intent(out) :: across(n), couple(n)
      integer :: i

      do i = 1, n
         across(i) = (alpha(i) + beta(i))/sign(max(abs(slide(i)), least), slide(i))
         couple(i) = merge(-beta(i), alpha(i), slide_first)
      end do
   end subroutine react_rpr

   !> First-order bounds of the errors of direction and slide: slide = sqrt(h**2 - guide**2); the angle between h and the
   !> slide has the sine guide/h.
   pure subroutine bounds_rpr(dyad, slide, h, gap, worst, bound)
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: slide, h, gap, worst
      real(wp), intent(out) :: bound(2)
      real(wp) :: guide, length

      guide = guide_of(dyad)
      length = max(slide, epsilon(1.0_wp)*h)
      bound(1) = ratio(gap, h) + ratio(guide*(1.0_wp + ratio(gap, h)), length) + 1.0_wp
      bound(2) = ratio(h*gap + guide*guide, length)

   contains

      !> a/b, but no more than `worst`.
      pure real(wp) function ratio(a, b)
         real(wp), intent(in) :: a, b

         ratio = worst
         if (b*worst > a) ratio = a/b
      end function ratio
   end subroutine bounds_rpr

   !> What is wrong at a position whose measure is not accepted.
   pure type(dyad_violation_t) function violation_rpr(dyad, measure, closes) result(violation)
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: measure
      logical, intent(in) :: closes    !! only less than TOGGLE is to spare

      violation%kind = merge(violation_toggle, violation_too_long, closes)
      violation%amount = guide_of(dyad) - sqrt(measure)
      if (closes) violation%amount = max(-violation%amount, 0.0_wp)
      violation%is_length = .true.
   end function violation_rpr

   !> Distance of the outer joints at and below which they coincide and no direction is determined; negative: they cannot.
   pure real(wp) function coincidence_rpr(dyad, size) result(distance)
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: size     !! longest arc of the linkage

      distance = -1.0_wp
      if (guide_of(dyad) <= 0.0_wp) distance = no_distance*size
   end function coincidence_rpr

   !> Length of the guide with which the dyad closes at every position with `toggle` to spare.
   pure subroutine repair_rpr(kind, measure, toggle, vary, length, repaired)
      integer, intent(in) :: kind
      real(wp), intent(in) :: measure(:), toggle
      logical, intent(in) :: vary(2)
      real(wp), intent(inout) :: length(2)
      logical, intent(out) :: repaired

      associate (guide => merge(2, 1, kind == assur_rpr))
         length(guide) = sqrt(minval(measure)) - toggle
         repaired = vary(guide) .and. length(guide) >= 0.0_wp
      end associate
   end subroutine repair_rpr

   ! ---- kernels -----------------------------------------------------------------------------------------------------

   !> Slide p guided by q: q is the guide, at right angles to p.
   !>
   !> `reach` is h**2: closed while reach >= q**2.
   pure subroutine solve_slide_on_q(n, sx, sy, ex, ey, q, s, px, py, slide, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: q                  !! length of the guide, >= 0
      real(wp), intent(in) :: s                  !! +1: the guide's direction is 90 degrees anticlockwise from the slide's
      real(wp), intent(out) :: px(n), py(n)      !! unit vector of the slide
      real(wp), intent(out) :: slide(n), reach(n) !! length of the slide; h**2
      real(wp) :: side
      integer :: i

      side = s*q
      do i = 1, n
         call place_slide_on_q(ex(i) - sx(i), ey(i) - sy(i), q, side, px(i), py(i), slide(i), reach(i))
      end do
   end subroutine solve_slide_on_q

   !> `solve_slide_on_q` for linkages side by side.
   pure subroutine solve_slide_on_q_lanes(n, sx, sy, ex, ey, q, s, px, py, slide, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(lanes, n), sy(lanes, n), ex(lanes, n), ey(lanes, n), q(lanes), s
      real(wp), intent(out) :: px(lanes, n), py(lanes, n), slide(lanes, n), reach(lanes, n)
      real(wp) :: side(lanes)
      integer :: i, l

      side = s*q
      do i = 1, n
         !$omp simd
         do l = 1, lanes
            call place_slide_on_q(ex(l, i) - sx(l, i), ey(l, i) - sy(l, i), q(l), side(l), px(l, i), py(l, i), slide(l, i), &
                                  reach(l, i))
         end do
      end do
   end subroutine solve_slide_on_q_lanes

   elemental subroutine place_slide_on_q(hx, hy, q, side, px, py, slide, reach)
      real(wp), intent(in) :: hx, hy, q, side
      real(wp), intent(out) :: px, py, slide, reach
      real(wp) :: d

      d = hx*hx + hy*hy
      reach = d
      slide = sqrt(max(d - q*q, 0.0_wp))
      d = 1.0_wp/max(d, least_square)
      px = (hx*slide + hy*side)*d
      py = (hy*slide - hx*side)*d
   end subroutine place_slide_on_q

   !> Slide q guided by p: p is the guide.
   !>
   !> `reach` is h**2: closed while reach >= p**2.
   pure subroutine solve_slide_on_p(n, sx, sy, ex, ey, p, t, px, py, slide, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: p                  !! length of the guide, >= 0
      real(wp), intent(in) :: t                  !! +1: the slide's direction is 90 degrees anticlockwise from the guide's
      real(wp), intent(out) :: px(n), py(n)      !! unit vector of the guide
      real(wp), intent(out) :: slide(n), reach(n) !! length of the slide; h**2
      integer :: i

      do i = 1, n
         call place_slide_on_p(ex(i) - sx(i), ey(i) - sy(i), p, t, px(i), py(i), slide(i), reach(i))
      end do
   end subroutine solve_slide_on_p

   !> `solve_slide_on_p` for linkages side by side.
   pure subroutine solve_slide_on_p_lanes(n, sx, sy, ex, ey, p, t, px, py, slide, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(lanes, n), sy(lanes, n), ex(lanes, n), ey(lanes, n), p(lanes), t
      real(wp), intent(out) :: px(lanes, n), py(lanes, n), slide(lanes, n), reach(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            call place_slide_on_p(ex(l, i) - sx(l, i), ey(l, i) - sy(l, i), p(l), t, px(l, i), py(l, i), slide(l, i), reach(l, i))
         end do
      end do
   end subroutine solve_slide_on_p_lanes

   elemental subroutine place_slide_on_p(hx, hy, p, t, px, py, slide, reach)
      real(wp), intent(in) :: hx, hy, p, t
      real(wp), intent(out) :: px, py, slide, reach
      real(wp) :: d, side

      d = hx*hx + hy*hy
      reach = d
      slide = sqrt(max(d - p*p, 0.0_wp))
      side = t*slide
      d = 1.0_wp/max(d, least_square)
      px = (hx*p + hy*side)*d
      py = (hy*p - hx*side)*d
   end subroutine place_slide_on_p
end module psalm_rpr
