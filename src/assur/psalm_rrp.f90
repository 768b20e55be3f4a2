!> Dyads RRP and PRR: a link, and a slide along a known direction u.
!>
!> Link p with slide q, or slide p with link q. Closure measure: the offset cross(u, h), user's sense; the dyad closes while
!> it is not longer than the link. Notes of `psalm_rrr` on kernels hold here too.
module psalm_rrp
   use psalm_arc_kernels, only: least
   use psalm_dyad, only: dyad_t, dyad_violation_t, violation_too_short, violation_toggle, rounding
   use psalm_dyad_kind, only: assur_rrp
   use psalm_dyad_lanes, only: dyad_lanes_t
   use psalm_frames, only: frames_t, turned_column, invert, rows_of_arc
   use psalm_kinds, only: wp
   use psalm_lanes, only: lanes
   use psalm_rows, only: rows_t
   implicit none (type, external)
   private
   public :: react_rrp
   public :: bind_rrp, solve_rrp, form_rrp, measure_rrp, change_of_measure_rrp, bounds_rrp, violation_rrp, repair_rrp, link_of
   public :: bind_rrp_lanes, solve_rrp_lanes
   public :: solve_link_slide

   real(wp), parameter :: least_length = tiny(1.0_wp)**0.4_wp !! of a link, guards a division

contains

   !> Length of the link.
   pure real(wp) function link_of(dyad)
      type(dyad_t), intent(in) :: dyad

      link_of = merge(dyad%p, dyad%q, dyad%kind == assur_rrp)
   end function link_of

   !> Limits of the measure.
   pure subroutine bind_rrp(dyad, toggle)
      type(dyad_t), intent(inout) :: dyad
      real(wp), intent(in) :: toggle    !! to spare where the dyad is accepted, scaled as its lengths

      dyad%closes_high = link_of(dyad)*(1.0_wp + rounding)
      dyad%closes_low = -dyad%closes_high
      dyad%accepts_high = most_accepted(link_of(dyad), toggle)
      dyad%accepts_low = -dyad%accepts_high
   end subroutine bind_rrp

   !> The same of linkages side by side: limits of what is accepted.
   pure subroutine bind_rrp_lanes(kind, numbers, toggle)
      integer, intent(in) :: kind
      type(dyad_lanes_t), intent(inout) :: numbers
      real(wp), intent(in) :: toggle

      if (kind == assur_rrp) then
         numbers%accepts_high = most_accepted(numbers%p, toggle)
      else
         numbers%accepts_high = most_accepted(numbers%q, toggle)
      end if
      numbers%accepts_low = -numbers%accepts_high
   end subroutine bind_rrp_lanes

   !> The largest offset of the outer joint that is accepted.
   elemental real(wp) function most_accepted(link, toggle)
      real(wp), intent(in) :: link, toggle

      most_accepted = link*(1.0_wp + rounding) - toggle
   end function most_accepted

   !> Direction of the link and length of the slide.
   pure subroutine solve_rrp(n, dyad, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(inout) :: store

      associate (v => store%v, sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y, px => dyad%p_x, py => dyad%p_y, &
                 qx => dyad%q_x, qy => dyad%q_y)
         if (dyad%kind == assur_rrp) then
            call solve_link_slide(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), dyad%p, dyad%sign, v(1, qx), v(1, qy), dyad%qx, &
                                  dyad%qy, v(1, px), v(1, py), v(1, dyad%slide_q), v(1, dyad%measure))
         else
            call solve_link_slide(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), dyad%q, -dyad%sign, v(1, px), v(1, py), dyad%px, &
                                  dyad%py, v(1, qx), v(1, qy), v(1, dyad%slide_p), v(1, dyad%measure))
         end if
      end associate
   end subroutine solve_rrp

   !> `solve_rrp` for linkages side by side.
   pure subroutine solve_rrp_lanes(n, dyad, numbers, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(dyad_lanes_t), intent(in) :: numbers
      type(rows_t), intent(inout) :: store

      associate (v => store%v, sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y, px => dyad%p_x, py => dyad%p_y, &
                 qx => dyad%q_x, qy => dyad%q_y)
         if (dyad%kind == assur_rrp) then
            call solve_link_slide_lanes(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), numbers%p, dyad%sign, v(1, qx), v(1, qy), &
                                        numbers%qx, numbers%qy, v(1, px), v(1, py), v(1, dyad%slide_q), v(1, dyad%measure))
         else
            call solve_link_slide_lanes(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), numbers%q, -dyad%sign, v(1, px), v(1, py), &
                                        numbers%px, numbers%py, v(1, qx), v(1, qy), v(1, dyad%slide_p), v(1, dyad%measure))
         end if
      end associate
   end subroutine solve_rrp_lanes

   !> Inverse matrix: the link's angle and the slide, in the order of p and q.
   subroutine form_rrp(n, limit, dyad, at, frames)
      integer, intent(in) :: n, at
      real(wp), intent(in) :: limit
      type(dyad_t), intent(in) :: dyad
      type(frames_t), intent(inout) :: frames

      if (dyad%kind == assur_rrp) then
         call turned_column(n, frames, at, 0, 1)
         call invert(n, limit, frames%scratch, at + rows_of_arc, at, frames)
      else
         call turned_column(n, frames, at + rows_of_arc, 0, 1)
         call invert(n, limit, at, frames%scratch, at, frames)
      end if
   end subroutine form_rrp

   !> Offset and clearance over link: the dyad closes, with the clearance to spare, while its absolute value is at most 1.
   pure subroutine measure_rrp(n, dyad, store, clearance, k)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store
      real(wp), intent(in) :: clearance
      real(wp), intent(out) :: k(:)

      associate (offset => store%v(1:n, dyad%measure))
         k = (offset + sign(clearance, offset))/link_of(dyad)
      end associate
   end subroutine measure_rrp

   !> Change of that with a variable that changes the lengths by `dp`, `dq`, turns the known direction by `turn_p` or `turn_q`
   !> beside its root's turn, and moves the outer joints.
   pure subroutine change_of_measure_rrp(n, dyad, store, d, clearance, unit, dp, dq, turn_p, turn_q, dk)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store, d
      real(wp), intent(in) :: clearance, unit, dp, dq, turn_p, turn_q
      real(wp), intent(out) :: dk(n)
      real(wp) :: c, s, fixed_turn, dl, hx, hy, gx, gy, ux, uy, turn, link, offset
      integer :: root_x, root_y, i     ! rows of the unit vector the slide is turned from

      if (dyad%kind == assur_rrp) then
         root_x = dyad%q_x
         root_y = dyad%q_y
         c = dyad%qx
         s = dyad%qy
         fixed_turn = turn_q
         dl = dp
      else
         root_x = dyad%p_x
         root_y = dyad%p_y
         c = dyad%px
         s = dyad%py
         fixed_turn = turn_p
         dl = dq
      end if
      link = link_of(dyad)
      associate (v => store%v)
         do i = 1, n
            hx = v(i, dyad%e_x) - v(i, dyad%s_x)
            hy = v(i, dyad%e_y) - v(i, dyad%s_y)
            gx = d%v(i, dyad%e_x) - d%v(i, dyad%s_x)
            gy = d%v(i, dyad%e_y) - d%v(i, dyad%s_y)
            offset = v(i, dyad%measure)
            ux = c*v(i, root_x) - s*v(i, root_y)
            uy = c*v(i, root_y) + s*v(i, root_x)
            turn = d%v(i, root_x) + fixed_turn
            dk(i) = (ux*gy - uy*gx - turn*(ux*hx + uy*hy))/link - (offset + sign(clearance, offset))*dl/link**2
         end do
      end associate
      dk = dk*unit
   end subroutine change_of_measure_rrp

   !> Force in the common pin, on the link: along the slide it balances `along`, and about the link's other end `moment`.
   !>
   !> Singular where the link is square to the slide.
   pure subroutine react_rrp(n, sense, ax, ay, ux, uy, moment, along, rx, ry)
      integer, intent(in) :: n
      real(wp), intent(in) :: sense                      !! +1: p is the link, -1: q is; the force is that of p on q
      real(wp), intent(in) :: ax(n), ay(n), ux(n), uy(n) !! vector of the link, direction of the slide
      real(wp), intent(in) :: moment(n), along(n)        !! free components of the wrenches on the link and on the slide
      real(wp), intent(out) :: rx(n), ry(n)
      real(wp) :: lever, across
      integer :: i

      do i = 1, n
         ! from the link's outer joint to the pin: along p, against q
         lever = sense*(ax(i)*ux(i) + ay(i)*uy(i))
         across = (moment(i) + sense*along(i)*(ax(i)*uy(i) - ay(i)*ux(i)))/sign(max(abs(lever), least), lever)
         rx(i) = sense*(-along(i)*ux(i) - across*uy(i))
         ry(i) = sense*(-along(i)*uy(i) + across*ux(i))
      end do
   end subroutine react_rrp

   !> First-order bounds of the errors of the link's direction and of the slide, in the order of p and q: offset c = cross(u, h),
   !> root = sqrt(link**2 - c**2).
   pure subroutine bounds_rrp(dyad, measure, h, gap, direction, bound)
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: measure, h, gap
      real(wp), intent(in) :: direction(2)    !! bounds of the directions of p and q as far as they are known
      real(wp), intent(out) :: bound(2)
      real(wp) :: link, along, across, cosine, root

      link = link_of(dyad)
      along = merge(direction(2), direction(1), dyad%kind == assur_rrp)
      across = gap + h*along
      cosine = max(sqrt(max((link - measure)*(link + measure), 0.0_wp)), epsilon(1.0_wp)*link)
      root = (link*link + abs(measure)*across)/cosine
      bound = [along + (across + abs(measure))/cosine + 1.0_wp, across + root]
      if (dyad%kind /= assur_rrp) bound = bound([2, 1])
   end subroutine bounds_rrp

   !> What is wrong at a position whose measure is not accepted.
   pure type(dyad_violation_t) function violation_rrp(dyad, measure, closes) result(violation)
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: measure
      logical, intent(in) :: closes    !! only less than TOGGLE is to spare

      violation%kind = merge(violation_toggle, violation_too_short, closes)
      violation%amount = abs(measure) - link_of(dyad)
      if (closes) violation%amount = max(-violation%amount, 0.0_wp)
      violation%is_length = .true.
   end function violation_rrp

   !> Length of the link with which the dyad closes at every position with `toggle` to spare.
   pure subroutine repair_rrp(kind, measure, toggle, vary, length, repaired)
      integer, intent(in) :: kind
      real(wp), intent(in) :: measure(:), toggle
      logical, intent(in) :: vary(2)
      real(wp), intent(inout) :: length(2)
      logical, intent(out) :: repaired

      associate (link => merge(1, 2, kind == assur_rrp))
         length(link) = maxval(abs(measure)) + toggle
         repaired = vary(link)
      end associate
   end subroutine repair_rrp

   ! ---- kernels -----------------------------------------------------------------------------------------------------

   !> Link p and slide q along a known direction u; slide p and link q are the same with -s.
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
      real(wp) :: length
      integer :: i

      length = max(p, least_length)
      do i = 1, n
         call place_link_slide(ex(i) - sx(i), ey(i) - sy(i), p, length, s, c*rx(i) - d*ry(i), c*ry(i) + d*rx(i), px(i), py(i), &
                               slide(i), reach(i))
      end do
   end subroutine solve_link_slide

   !> `solve_link_slide` for linkages side by side.
   pure subroutine solve_link_slide_lanes(n, sx, sy, ex, ey, p, s, rx, ry, c, d, px, py, slide, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(lanes, n), sy(lanes, n), ex(lanes, n), ey(lanes, n), p(lanes), s
      real(wp), intent(in) :: rx(lanes, n), ry(lanes, n), c(lanes), d(lanes)
      real(wp), intent(out) :: px(lanes, n), py(lanes, n), slide(lanes, n), reach(lanes, n)
      real(wp) :: length(lanes)
      integer :: i, l

      length = max(p, least_length)
      do i = 1, n
         !$omp simd
         do l = 1, lanes
            call place_link_slide(ex(l, i) - sx(l, i), ey(l, i) - sy(l, i), p(l), length(l), s, c(l)*rx(l, i) - d(l)*ry(l, i), &
                                  c(l)*ry(l, i) + d(l)*rx(l, i), px(l, i), py(l, i), slide(l, i), reach(l, i))
         end do
      end do
   end subroutine solve_link_slide_lanes

   !> Unit vector of the link and length of the slide at one position; u is the slide's direction.
   elemental subroutine place_link_slide(hx, hy, p, length, s, ux, uy, px, py, slide, reach)
      real(wp), intent(in) :: hx, hy, p, length, s, ux, uy
      real(wp), intent(out) :: px, py, slide, reach
      real(wp) :: offset, root

      offset = ux*hy - uy*hx
      reach = offset
      root = s*sqrt(max((p - offset)*(p + offset), 0.0_wp))
      slide = hx*ux + hy*uy - root
      px = (root*ux - offset*uy)/length
      py = (root*uy + offset*ux)/length
   end subroutine place_link_slide
end module psalm_rrp
