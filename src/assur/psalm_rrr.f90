!> Dyad RRR: link p, link q, three revolute joints.
!>
!> Directions are unit vectors; no trigonometric function is called. There is no branch around a root: a radicand below zero
!> is clamped, and the closure measure, the squared distance h**2 of the outer joints, tells afterwards whether the dyad
!> closes: (p-q)**2 <= h**2 <= (p+q)**2. Every array has the shape (n), n positions. Derivation: `doc/theory/positions.md`.
module psalm_rrr
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_arc_kernels, only: least
   use psalm_dyad, only: dyad_t, dyad_violation_t, violation_too_short, violation_too_long, violation_angle_small, &
                         violation_angle_large, least_square, no_distance, rounding
   use psalm_dyad_lanes, only: dyad_lanes_t
   use psalm_frames, only: frames_t, turned_column, invert, rows_of_arc, matrix_row, sine_row
   use psalm_kinds, only: wp, degrees_per_radian, half_turn, right_angle
   use psalm_lanes, only: lanes
   use psalm_rows, only: rows_t
   implicit none (type, external)
   private
   public :: react_rrr
   public :: bind_rrr, solve_rrr, form_rrr, rates_rrr, measure_rrr, change_of_measure_rrr, bounds_rrr, violation_rrr, repair_rrr, &
             coincidence_rrr
   public :: bind_rrr_lanes, solve_rrr_lanes
   public :: solve_two_links, solve_one_link, repair_link_pair

   real(wp), parameter :: largest_half = 0.25_wp*huge(1.0_wp)*least_square !! so that 1/least_square times it is finite
   real(wp), parameter :: inside = 1.0e-6_wp*degrees_per_radian !! degrees a repaired transmission angle is put inside its limit
   real(wp), parameter :: most_sine2 = 2.0_wp        !! no square of a sine is as great, whatever its rounding

contains

   !> Limits of the measure for the dyad's lengths.
   pure subroutine bind_rrr(dyad, cosine_lowest)
      type(dyad_t), intent(inout) :: dyad
      real(wp), intent(in) :: cosine_lowest   !! cosine of the smallest transmission angle allowed
      real(wp) :: slack

      associate (p => dyad%p, q => dyad%q)
         slack = rounding*(p + q)**2
         dyad%closes_low = max((p - q)**2 - slack, least_square)
         dyad%closes_high = (p + q)**2 + slack
         call find_accepted(p, q, cosine_lowest, dyad%accepts_low, dyad%accepts_high)
      end associate
   end subroutine bind_rrr

   !> The same of linkages side by side: limits of what is accepted.
   pure subroutine bind_rrr_lanes(numbers, cosine_lowest)
      type(dyad_lanes_t), intent(inout) :: numbers
      real(wp), intent(in) :: cosine_lowest

      call find_accepted(numbers%p, numbers%q, cosine_lowest, numbers%accepts_low, numbers%accepts_high)
   end subroutine bind_rrr_lanes

   !> Limits of the squared distance of the outer joints for transmission angles within limits.
   elemental subroutine find_accepted(p, q, cosine_lowest, low, high)
      real(wp), intent(in) :: p, q, cosine_lowest
      real(wp), intent(out) :: low, high
      real(wp) :: slack

      slack = rounding*(p + q)**2
      low = max(p*p + q*q - 2.0_wp*p*q*cosine_lowest - slack, least_square)
      high = p*p + q*q + 2.0_wp*p*q*cosine_lowest + slack
   end subroutine find_accepted

   !> Directions of both links, or of the one that something hangs on.
   pure subroutine solve_rrr(n, dyad, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(inout) :: store

      associate (v => store%v, sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y, measure => dyad%measure)
         if (dyad%wants_p .and. dyad%wants_q) then
            call solve_two_links(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), dyad%p, dyad%q, dyad%sign, v(1, dyad%p_x), &
                                 v(1, dyad%p_y), v(1, dyad%q_x), v(1, dyad%q_y), v(1, measure))
         else if (dyad%wants_q) then
            call solve_link(n, dyad%q, dyad%p, -dyad%sign, dyad%q_x, dyad%q_y, dyad, store)
         else
            call solve_link(n, dyad%p, dyad%q, dyad%sign, dyad%p_x, dyad%p_y, dyad, store)
         end if
      end associate
   end subroutine solve_rrr

   !> Direction of one link, with the point that hangs on it if there is one.
   pure subroutine solve_link(n, a, b, t, x, y, dyad, store)
      integer, intent(in) :: n
      real(wp), intent(in) :: a, b, t              !! as `solve_one_link` has them
      integer, intent(in) :: x, y                  !! rows of the direction
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(inout) :: store

      associate (v => store%v, sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y, measure => dyad%measure, &
                 tip => dyad%tip)
         if (tip%to_x > 0) then
            call solve_link_and_tip(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), a, b, t, v(1, tip%from_x), v(1, tip%from_y), &
                                    tip%x, tip%y, v(1, x), v(1, y), v(1, measure), v(1, tip%to_x), v(1, tip%to_y))
         else
            call solve_one_link(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), a, b, t, v(1, x), v(1, y), v(1, measure))
         end if
      end associate
   end subroutine solve_link

   !> `solve_rrr` for linkages side by side.
   pure subroutine solve_rrr_lanes(n, dyad, numbers, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(dyad_lanes_t), intent(in) :: numbers
      type(rows_t), intent(inout) :: store

      associate (v => store%v, sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y, measure => dyad%measure)
         if (dyad%wants_p .and. dyad%wants_q) then
            call solve_two_links_lanes(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), numbers%p, numbers%q, dyad%sign, &
                                       v(1, dyad%p_x), v(1, dyad%p_y), v(1, dyad%q_x), v(1, dyad%q_y), v(1, measure))
         else if (dyad%wants_q) then
            call solve_link_lanes(n, numbers%q, numbers%p, -dyad%sign, dyad%q_x, dyad%q_y, dyad, numbers, store)
         else
            call solve_link_lanes(n, numbers%p, numbers%q, dyad%sign, dyad%p_x, dyad%p_y, dyad, numbers, store)
         end if
      end associate
   end subroutine solve_rrr_lanes

   pure subroutine solve_link_lanes(n, a, b, t, x, y, dyad, numbers, store)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(lanes), b(lanes), t
      integer, intent(in) :: x, y
      type(dyad_t), intent(in) :: dyad
      type(dyad_lanes_t), intent(in) :: numbers
      type(rows_t), intent(inout) :: store

      associate (v => store%v, sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y, measure => dyad%measure, &
                 tip => dyad%tip)
         if (tip%to_x > 0) then
            call solve_link_and_tip_lanes(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), a, b, t, v(1, tip%from_x), &
                                          v(1, tip%from_y), numbers%tip_x, numbers%tip_y, v(1, x), v(1, y), v(1, measure), &
                                          v(1, tip%to_x), v(1, tip%to_y))
         else
            call solve_one_link_lanes(n, v(1, sx), v(1, sy), v(1, ex), v(1, ey), a, b, t, v(1, x), v(1, y), v(1, measure))
         end if
      end associate
   end subroutine solve_link_lanes

   !> Inverse matrix; the arcs' vectors are formed.
   subroutine form_rrr(n, limit, at, frames)
      integer, intent(in) :: n, at
      real(wp), intent(in) :: limit
      type(frames_t), intent(inout) :: frames

      call turned_column(n, frames, at, 0, 1)
      call turned_column(n, frames, at + rows_of_arc, 0, 2)
      call invert(n, limit, frames%scratch, frames%scratch + 2, at, frames)
   end subroutine form_rrr

   !> Derivatives of both directions, all orders. Of the dyad's rows of `frames` the first of the matrix and the sine are used.
   subroutine rates_rrr(n, orders, limit, dyad, store, at, frames, d)
      integer, intent(in) :: n, orders, at
      real(wp), intent(in) :: limit
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store
      type(frames_t), intent(inout) :: frames
      type(rows_t), intent(inout) :: d(:)       !! by order

      associate (v => store%v, d1 => d(1)%v, d2 => d(2)%v, d3 => d(3)%v, inverse => frames%work%v, m => at + matrix_row, &
                 sx => dyad%s_x, sy => dyad%s_y, ex => dyad%e_x, ey => dyad%e_y, px => dyad%p_x, py => dyad%p_y, &
                 qx => dyad%q_x, qy => dyad%q_y)
         call link_pair_second(n, dyad%p, dyad%q, limit, d1(1, sx), d1(1, sy), d1(1, ex), d1(1, ey), d2(1, sx), d2(1, sy), &
                               d2(1, ex), d2(1, ey), v(1, px), v(1, py), v(1, qx), v(1, qy), inverse(1, m), &
                               inverse(1, at + sine_row), d1(1, px), d1(1, qx), d2(1, px), d2(1, qx))
         if (orders < 3) return
         call link_pair_third(n, dyad%p, dyad%q, d3(1, sx), d3(1, sy), d3(1, ex), d3(1, ey), v(1, px), v(1, py), v(1, qx), &
                              v(1, qy), inverse(1, m), d1(1, px), d1(1, qx), d2(1, px), d2(1, qx), d3(1, px), d3(1, qx))
      end associate
   end subroutine rates_rrr

   !> Cosine of the transmission angle; beyond 1 where the dyad is open: smooth across closing.
   pure subroutine measure_rrr(n, dyad, store, k)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store
      real(wp), intent(out) :: k(:)

      k = (dyad%p**2 + dyad%q**2 - store%v(1:n, dyad%measure))/(2.0_wp*dyad%p*dyad%q)
   end subroutine measure_rrr

   !> Change of that with a variable that changes the lengths by `dp`, `dq` and moves the outer joints.
   pure subroutine change_of_measure_rrr(n, dyad, store, d, unit, dp, dq, dk)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store, d
      real(wp), intent(in) :: unit, dp, dq
      real(wp), intent(out) :: dk(n)
      real(wp) :: h

      h = 0.5_wp/(dyad%p*dyad%q)
      associate (v => store%v)
         call link_pair_change(n, v(1, dyad%s_x), v(1, dyad%s_y), v(1, dyad%e_x), v(1, dyad%e_y), d%v(1, dyad%s_x), &
                               d%v(1, dyad%s_y), d%v(1, dyad%e_x), d%v(1, dyad%e_y), v(1, dyad%measure), &
                               unit*h*(dp/dyad%p - dq/dyad%q)*(dyad%p - dyad%q)*(dyad%p + dyad%q), &
                               unit*h*(dp/dyad%p + dq/dyad%q), 2.0_wp*unit*h, dk)
      end associate
   end subroutine change_of_measure_rrr

   !> Force of p on q in the common pin: alpha = a x r, -beta = b x r, with b = -q. Singular where both links are in one line.
   pure subroutine react_rrr(n, ax, ay, qx, qy, alpha, beta, rx, ry)
      integer, intent(in) :: n
      real(wp), intent(in) :: ax(n), ay(n), qx(n), qy(n) !! vectors of p and q
      real(wp), intent(in) :: alpha(n), beta(n)          !! moments of the wrenches on p about S, on q about E
      real(wp), intent(out) :: rx(n), ry(n)
      real(wp) :: determinant
      integer :: i

      do i = 1, n
         determinant = ay(i)*qx(i) - ax(i)*qy(i)
         determinant = 1.0_wp/sign(max(abs(determinant), least), determinant)
         rx(i) = (beta(i)*ax(i) - alpha(i)*qx(i))*determinant
         ry(i) = (beta(i)*ay(i) - alpha(i)*qy(i))*determinant
      end do
   end subroutine react_rrr

   !> First-order bounds of the errors of both directions, in epsilons. Derivation: `doc/theory/positions.md`, Condition.
   pure subroutine bounds_rrr(dyad, measure, s, e, worst, bound)
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: measure
      real(wp), intent(in) :: s, e        !! bounds of the outer joints
      real(wp), intent(in) :: worst       !! larger factors say nothing more
      real(wp), intent(out) :: bound(2)
      real(wp) :: sine, joint

      sine = sqrt(max(((dyad%p + dyad%q)**2 - measure)*(measure - (dyad%p - dyad%q)**2), 0.0_wp))/(2.0_wp*dyad%p*dyad%q)
      joint = min((s + dyad%p + e + dyad%q)/max(sine, epsilon(1.0_wp)), (dyad%p + dyad%q)*worst)
      bound = [(joint + s)/dyad%p + 1.0_wp, (joint + e)/dyad%q + 1.0_wp]
   end subroutine bounds_rrr

   !> What is wrong at a position whose measure is not accepted.
   pure type(dyad_violation_t) function violation_rrr(dyad, measure, closes) result(violation)
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: measure
      logical, intent(in) :: closes
      real(wp) :: h, cosine

      h = sqrt(measure)
      if (closes) then
         cosine = (dyad%p**2 + dyad%q**2 - measure)/(2.0_wp*dyad%p*dyad%q)
         violation%kind = merge(violation_angle_small, violation_angle_large, cosine > 0.0_wp)
         violation%amount = degrees_of(cosine, sqrt(max((1.0_wp - cosine)*(1.0_wp + cosine), 0.0_wp)))
         return
      end if
      violation%is_length = .true.
      if (h > dyad%p + dyad%q) then
         violation%kind = violation_too_short
         violation%amount = h - (dyad%p + dyad%q)
      else
         violation%kind = violation_too_long
         violation%amount = abs(dyad%p - dyad%q) - h
      end if
   end function violation_rrr

   !> Distance of the outer joints at and below which they coincide and no direction is determined; negative: they cannot.
   pure real(wp) function coincidence_rrr(dyad) result(distance)
      type(dyad_t), intent(in) :: dyad

      distance = -1.0_wp
      if (abs(dyad%p - dyad%q) <= no_distance*(dyad%p + dyad%q)) distance = no_distance*(dyad%p + dyad%q)
   end function coincidence_rrr

   !> Lengths with which the dyad is accepted at every position; see `repair_link_pair`.
   pure subroutine repair_rrr(measure, tangle, vary, length, repaired)
      real(wp), intent(in) :: measure(:), tangle
      logical, intent(in) :: vary(2)
      real(wp), intent(inout) :: length(2)
      logical, intent(out) :: repaired

      call repair_link_pair(measure, tangle, vary(1), vary(2), length(1), length(2), repaired)
   end subroutine repair_rrr

   ! ---- kernels -----------------------------------------------------------------------------------------------------

   !> Link p and link q: the triangle on h.
   !>
   !> `reach` is h**2: closed while (p-q)**2 <= reach <= (p+q)**2. With s = +1 the common joint lies right of S -> E.
   pure subroutine solve_two_links(n, sx, sy, ex, ey, p, q, s, px, py, qx, qy, reach)
      integer, intent(in) :: n                          !! positions
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n) !! S and E, [length]
      real(wp), intent(in) :: p, q                      !! lengths, > 0
      real(wp), intent(in) :: s                         !! assembly, +1 or -1
      real(wp), intent(out) :: px(n), py(n), qx(n), qy(n) !! unit vectors of p and q
      real(wp), intent(out) :: reach(n)                 !! h**2, [length**2]
      real(wp) :: sum2, diff2, product, half_p, half_q
      integer :: i

      sum2 = (p + q)**2
      diff2 = (p - q)**2
      product = (p - q)*(p + q)
      half_p = half_of(p)
      half_q = half_of(q)
      do i = 1, n
         call place_two_links(ex(i) - sx(i), ey(i) - sy(i), sum2, diff2, product, half_p, half_q, s, px(i), py(i), qx(i), qy(i), &
                              reach(i))
      end do
   end subroutine solve_two_links

   !> `solve_two_links` for linkages side by side.
   pure subroutine solve_two_links_lanes(n, sx, sy, ex, ey, p, q, s, px, py, qx, qy, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(lanes, n), sy(lanes, n), ex(lanes, n), ey(lanes, n), p(lanes), q(lanes), s
      real(wp), intent(out) :: px(lanes, n), py(lanes, n), qx(lanes, n), qy(lanes, n), reach(lanes, n)
      real(wp), dimension(lanes) :: sum2, diff2, product, half_p, half_q
      integer :: i, l

      sum2 = (p + q)**2
      diff2 = (p - q)**2
      product = (p - q)*(p + q)
      half_p = half_of(p)
      half_q = half_of(q)
      do i = 1, n
         !$omp simd
         do l = 1, lanes
            call place_two_links(ex(l, i) - sx(l, i), ey(l, i) - sy(l, i), sum2(l), diff2(l), product(l), half_p(l), half_q(l), s, &
                                 px(l, i), py(l, i), qx(l, i), qy(l, i), reach(l, i))
         end do
      end do
   end subroutine solve_two_links_lanes

   !> Unit vectors of both links of the triangle on h at one position.
   elemental subroutine place_two_links(hx, hy, sum2, diff2, product, half_p, half_q, s, px, py, qx, qy, reach)
      real(wp), intent(in) :: hx, hy, sum2, diff2, product, half_p, half_q, s
      real(wp), intent(out) :: px, py, qx, qy, reach
      real(wp) :: root, along_p, along_q, d

      d = hx*hx + hy*hy
      reach = d
      root = s*sqrt(max((sum2 - d)*(d - diff2), 0.0_wp))
      along_p = d + product
      along_q = d - product
      d = 1.0_wp/max(d, least_square)
      px = (along_p*hx + root*hy)*(d*half_p)
      py = (along_p*hy - root*hx)*(d*half_p)
      qx = (along_q*hx - root*hy)*(d*half_q)
      qy = (along_q*hy + root*hx)*(d*half_q)
   end subroutine place_two_links

   !> The same where only one of the two directions is wanted: that of the link `a`; `b` is the other.
   !>
   !> With t = +1 the joint lies right of the line from where `a` leaves h: t = s for a = p, t = -s for a = q.
   pure subroutine solve_one_link(n, sx, sy, ex, ey, a, b, t, ax, ay, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: a, b                      !! lengths, > 0
      real(wp), intent(in) :: t                         !! assembly, +1 or -1
      real(wp), intent(out) :: ax(n), ay(n), reach(n)   !! unit vector of a; h**2
      real(wp) :: sum2, diff2, product, half
      integer :: i

      sum2 = (a + b)**2
      diff2 = (a - b)**2
      product = (a - b)*(a + b)
      half = half_of(a)
      do i = 1, n
         call place_link(ex(i) - sx(i), ey(i) - sy(i), sum2, diff2, product, half, t, ax(i), ay(i), reach(i))
      end do
   end subroutine solve_one_link

   !> The same with a point at the other end of an arc that hangs on the link.
   pure subroutine solve_link_and_tip(n, sx, sy, ex, ey, a, b, t, fx, fy, cx, cy, ax, ay, reach, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ex(n), ey(n)
      real(wp), intent(in) :: a, b, t
      real(wp), intent(in) :: fx(n), fy(n), cx, cy      !! point to start from; the arc in the axes of a
      real(wp), intent(out) :: ax(n), ay(n), reach(n), tx(n), ty(n)
      real(wp) :: sum2, diff2, product, half, x, y
      integer :: i

      sum2 = (a + b)**2
      diff2 = (a - b)**2
      product = (a - b)*(a + b)
      half = half_of(a)
      do i = 1, n
         call place_link(ex(i) - sx(i), ey(i) - sy(i), sum2, diff2, product, half, t, x, y, reach(i))
         ax(i) = x
         ay(i) = y
         tx(i) = fx(i) + (cx*x - cy*y)
         ty(i) = fy(i) + (cx*y + cy*x)
      end do
   end subroutine solve_link_and_tip

   !> `solve_one_link` for linkages side by side.
   pure subroutine solve_one_link_lanes(n, sx, sy, ex, ey, a, b, t, ax, ay, reach)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(lanes, n), sy(lanes, n), ex(lanes, n), ey(lanes, n), a(lanes), b(lanes), t
      real(wp), intent(out) :: ax(lanes, n), ay(lanes, n), reach(lanes, n)
      real(wp), dimension(lanes) :: sum2, diff2, product, half
      integer :: i, l

      sum2 = (a + b)**2
      diff2 = (a - b)**2
      product = (a - b)*(a + b)
      half = half_of(a)
      do i = 1, n
         !$omp simd
         do l = 1, lanes
            call place_link(ex(l, i) - sx(l, i), ey(l, i) - sy(l, i), sum2(l), diff2(l), product(l), half(l), t, ax(l, i), &
                            ay(l, i), reach(l, i))
         end do
      end do
   end subroutine solve_one_link_lanes

   !> `solve_link_and_tip` for linkages side by side.
   pure subroutine solve_link_and_tip_lanes(n, sx, sy, ex, ey, a, b, t, fx, fy, cx, cy, ax, ay, reach, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(lanes, n), sy(lanes, n), ex(lanes, n), ey(lanes, n), a(lanes), b(lanes), t
      real(wp), intent(in) :: fx(lanes, n), fy(lanes, n), cx(lanes), cy(lanes)
      real(wp), intent(out) :: ax(lanes, n), ay(lanes, n), reach(lanes, n), tx(lanes, n), ty(lanes, n)
      real(wp), dimension(lanes) :: sum2, diff2, product, half
      real(wp) :: x, y
      integer :: i, l

      sum2 = (a + b)**2
      diff2 = (a - b)**2
      product = (a - b)*(a + b)
      half = half_of(a)
      do i = 1, n
         !$omp simd
         do l = 1, lanes
            call place_link(ex(l, i) - sx(l, i), ey(l, i) - sy(l, i), sum2(l), diff2(l), product(l), half(l), t, x, y, reach(l, i))
            ax(l, i) = x
            ay(l, i) = y
            tx(l, i) = fx(l, i) + (cx(l)*x - cy(l)*y)
            ty(l, i) = fy(l, i) + (cx(l)*y + cy(l)*x)
         end do
      end do
   end subroutine solve_link_and_tip_lanes

   !> Unit vector of a link of the triangle on h at one position; the compiler puts it into the loops over positions.
   elemental subroutine place_link(hx, hy, sum2, diff2, product, half, t, x, y, reach)
      real(wp), intent(in) :: hx, hy                    !! h, [length]
      real(wp), intent(in) :: sum2, diff2, product      !! (a + b)**2, (a - b)**2 and a**2 - b**2
      real(wp), intent(in) :: half, t                   !! 0.5/a; assembly, as `solve_one_link` has it
      real(wp), intent(out) :: x, y, reach              !! the vector; h**2
      real(wp) :: root, along, scale

      reach = hx*hx + hy*hy
      root = t*sqrt(max((sum2 - reach)*(reach - diff2), 0.0_wp))
      along = reach + product
      scale = (1.0_wp/max(reach, least_square))*half
      x = (along*hx + root*hy)*scale
      y = (along*hy - root*hx)*scale
   end subroutine place_link

   !> 0.5/length; what a length too short to have a direction gives stays finite when it is divided by `least_square`.
   elemental real(wp) function half_of(length)
      real(wp), intent(in) :: length             !! > 0

      half_of = 0.5_wp/max(length, 0.5_wp/largest_half)
   end function half_of

   !> Link pair, first and second order in one pass; the inverse of the sine between the links is kept.
   !>
   !> Where the square of the sine is not above `limit` (a dead point) the inverse is zero; so where it is beyond that of any angle:
   !> a pair that does not close has vectors as long as the pair would have to be, and beside a link of hardly any length what is
   !> left of their product by rounding would give rates without end.
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
         sine = merge(sine, 0.0_wp, sine2(i) > limit .and. sine2(i) < most_sine2)
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

   !> Change one or both lengths until the transmission angle is within limits at every position.
   !>
   !> Formulas of section 6.3 of the thesis, each from the cosine rule h**2 = p**2 + q**2 - 2 p q cos(mu); the forms for one
   !> variable length are solved from the same rule.
   pure subroutine repair_link_pair(reach, tangle, vary_p, vary_q, p, q, repaired)
      real(wp), intent(in) :: reach(:)           !! shape (positions): h**2
      real(wp), intent(in) :: tangle             !! allowed deviation from 90 degrees
      logical, intent(in) :: vary_p, vary_q      !! the length may change
      real(wp), intent(inout) :: p, q            !! lengths
      logical, intent(out) :: repaired           !! false if the demands of the positions conflict
      real(wp) :: c_low, s_low, half_sine, c_high, unused, k, d
      logical :: frozen
      integer :: i

      ! aim a little inside: the smallest angle raised, the largest lowered
      call unit_vector(right_angle - tangle + inside, c_low, s_low)
      call unit_vector((right_angle - tangle + inside)/2.0_wp, unused, half_sine)
      call unit_vector(half_turn - (right_angle - tangle) - inside, c_high, unused)
      frozen = .false.
      repaired = .false.
      do i = 1, size(reach)
         d = reach(i)
         if (d > p*p + q*q - 2.0_wp*p*q*c_high) then
            if (frozen) return
            if (vary_p .and. vary_q) then
               k = 0.5_wp*(sqrt((2.0_wp*d - (1.0_wp + c_high)*(p - q)**2)/(1.0_wp - c_high)) - (p + q))
               p = p + k
               q = q + k
            else if (vary_p) then
               p = q*c_high + sqrt(d - q*q*(1.0_wp - c_high)*(1.0_wp + c_high))
            else
               q = p*c_high + sqrt(d - p*p*(1.0_wp - c_high)*(1.0_wp + c_high))
            end if
         else if (d < p*p + q*q - 2.0_wp*p*q*c_low) then
            if (p <= q) then
               call close_up(d, c_low, s_low, half_sine, vary_p, vary_q, p, q, frozen)
            else
               call close_up(d, c_low, s_low, half_sine, vary_q, vary_p, q, p, frozen)
            end if
         end if
         if (.not. (p > 0.0_wp .and. q > 0.0_wp)) return
      end do
      call unit_vector(right_angle - tangle, c_low, unused)
      call unit_vector(right_angle + tangle, c_high, unused)
      repaired = all(reach <= p*p + q*q - 2.0_wp*p*q*c_high .and. reach >= p*p + q*q - 2.0_wp*p*q*c_low)
   end subroutine repair_link_pair

   !> The difference of the links is too great: the shorter is lengthened, or the longer shortened where only that may vary.
   !>
   !> Both lengths are made equal where no shorter link would do. A length of -1 says that nothing helps.
   pure subroutine close_up(d, cosine, sine, half_sine, vary_short, vary_long, short, long, frozen)
      real(wp), intent(in) :: d                       !! h**2
      real(wp), intent(in) :: cosine, sine, half_sine !! of the smallest angle; sine of its half
      logical, intent(in) :: vary_short, vary_long
      real(wp), intent(inout) :: short, long
      logical, intent(inout) :: frozen                !! if set, the links may not be lengthened again
      real(wp) :: root

      if (vary_short) then
         root = d - (long*sine)**2
         if (root >= 0.0_wp) then
            root = sqrt(root)
            short = long*cosine - root
            ! limits near 90 degrees: only the other solution is a length
            if (short <= 0.0_wp) short = long*cosine + root
         else if (vary_long) then
            short = 0.5_wp*sqrt(d)/half_sine
            long = short
            frozen = .true.
         else
            short = -1.0_wp
         end if
      else
         root = d - (short*sine)**2
         long = -1.0_wp
         if (root >= 0.0_wp) long = short*cosine + sqrt(root)
      end if
   end subroutine close_up
end module psalm_rrr
