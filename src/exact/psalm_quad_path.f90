!> One solution followed along a path of problems in quadruple precision: where the lanes of psalm_tracker give up.
!>
!> Near infinity differences of the unknowns cancel beyond what the working precision holds. Here the equations of a point are
!> freed of its turn by elimination with pivoting, whatever its kind, so that one text serves all of them. Predictor and corrector
!> are those of psalm_tracker. Source: Bates, Hauenstein, Sommese and Wampler (2008) on adaptive precision.
module psalm_quad_path
   use psalm_elementary, only: fractional_power
   use psalm_kinds, only: wp
   use psalm_leg_lanes, only: problem_path_t
   use psalm_leg_problem, only: at_a, at_ah, at_b, at_bh, at_x, at_xh, at_y, at_yh, kind_pose, kind_rate, kind_timed, &
                                leg_data_t, most_order, most_points, turns_of, variables
   use psalm_quad, only: qp, abs, exp
   implicit none (type, external)
   private
   public :: follow_precisely, path_arrived, path_stuck, path_to_infinity, path_singular

   integer, parameter :: path_arrived = 1, path_stuck = 2, path_to_infinity = 3, path_singular = 4
   integer, parameter :: of_g = 1, of_gh = 2, of_value = 2 + variables + 1, of_rate = 2 + variables + 2, columns = of_rate
   integer, parameter :: remembered = 3              !! points that the predictor goes through
   integer, parameter :: most_equations = 4          !! of a point
   integer, parameter :: most_steps = 500, most_corrections = 12
   real(qp), parameter :: first_step = 0.01_qp, least_step = 1.0e-16_qp
   real(qp), parameter :: accepted_error = 1.0e-4_qp, aimed_error = 1.0e-5_qp !! of a prediction
   real(qp), parameter :: converged = 1.0e-8_qp, contraction = 0.1_qp, slack = 1.0e-20_qp !! of the second correction
   real(qp), parameter :: settled = 1.0e-24_qp       !! correction of a start or an end
   real(qp), parameter :: caution = 0.9_qp, shortest = 0.3_qp, longest = 2.0_qp, after_refusal = 0.35_qp
   real(qp), parameter :: most_in_hand = 1.0e3_qp    !! of an error over the one aimed at: no step grows more
   real(qp), parameter :: infinite = 1.0e12_qp, nearly_there = 1.0e-6_qp !! a number beyond the first at a t below the second
   real(qp), parameter :: loose_start = 1.0e-2_qp
   real(qp), parameter :: undetermined = 1.0e-4_qp   !! relative change of an end by the rounding of the data
   ! An end that is no regular one is assessed from afar. Where two branches cross at the end, rounding of the data parts them below
   ! a t of its square root: nothing nearer than that is known
   real(qp), parameter :: first_look = 1.0e-4_qp, last_look = 1.0e-6_qp !! the t of two looks at the way to it
   real(qp), parameter :: hopeless = 1.0e-8_qp       !! the t at which a path that has not come to its end is given up
   real(qp), parameter :: late = 1.0e-5_qp           !! the largest t from which an end is assessed
   real(qp), parameter :: runs_away = 0.1_qp         !! a number that grows like t to less than minus this is infinite in the end
   integer, parameter :: most_winding = 6

   !> Legs and turns of the coupler.
   type :: tracking_state_t
      complex(qp) :: v(variables) = (0.0_qp, 0.0_qp)
      complex(qp) :: g(most_points) = (0.0_qp, 0.0_qp), gh(most_points) = (0.0_qp, 0.0_qp)
   end type tracking_state_t

   !> A place on the way to an end.
   type :: look_t
      real(qp) :: t = 0.0_qp
      complex(qp) :: v(variables) = (0.0_qp, 0.0_qp), tangent(variables) = (0.0_qp, 0.0_qp)
   end type look_t

contains

   !> Follow a solution from some t to t = 0. `outcome` is one of path_arrived, path_stuck, path_to_infinity, path_singular. Near an
   !> end where the equations are singular the numbers are series in t**(1/m), m the winding number; it is found from the growth of
   !> t dz/dt between two places, and the end by its first two terms. Source: Morgan, Sommese and Wampler (1992), Numerische
   !> Mathematik 63, 391.
   subroutine follow_precisely(path, first_t, start, v, outcome, winding)
      type(problem_path_t), intent(in) :: path
      real(wp), intent(in) :: first_t
      complex(wp), intent(in) :: start(variables)    !! the solution there
      complex(wp), intent(out) :: v(variables)       !! where it ended
      integer, intent(out) :: outcome
      integer, intent(out) :: winding                !! of a singular end; else 1
      complex(wp) :: g(most_points), gh(most_points)
      type(leg_data_t) :: between
      type(tracking_state_t), allocatable :: past(:), slope(:) ! large: they would fill a small stack
      type(tracking_state_t) :: z, tangent
      type(look_t) :: looks(2)
      real(qp) :: past_t(remembered), t, h, aimed, e(2)
      integer :: known, k, step

      allocate (past(remembered), slope(remembered))
      g = (0.0_wp, 0.0_wp)
      gh = g
      between = path%to
      between%d = path%to%d + first_t*(path%from%d - path%to%d)
      between%dh = path%to%dh + first_t*(path%from%dh - path%to%dh)
      between%turn = path%to%turn + first_t*(path%from%turn - path%to%turn)
      call turns_of(path%problem, between, start, g(:path%problem%points), gh(:path%problem%points))
      z%v = cmplx(start, kind=qp)
      z%g = cmplx(g, kind=qp)
      z%gh = cmplx(gh, kind=qp)
      v = start
      outcome = path_stuck
      winding = 1
      t = real(first_t, qp)
      do k = 1, most_corrections
         call correct(path, t, z, tangent, e(1))
         if (e(1) < settled .or. .not. e(1) < loose_start) exit
      end do
      if (.not. e(1) < converged) return
      past = z
      slope = tangent
      past_t = t
      known = 1
      h = first_step*t
      call look
      do step = 1, most_steps
         aimed = max(t - h, 0.0_qp)
         call predict(past_t(:known), past(:known), slope(:known), aimed, z)
         call correct(path, aimed, z, tangent, e(1))
         call correct(path, aimed, z, tangent, e(2))
         if (e(1) < accepted_error .and. e(2) < converged .and. e(2) < contraction*e(1) + slack) then
            t = aimed
            v = cmplx(z%v, kind=wp)
            if (t < nearly_there .and. maxval(abs(z%v)) > infinite) then
               outcome = path_to_infinity
               return
            end if
            if (.not. t > 0.0_qp) exit
            call look
            h = h*min(max(caution*real(fractional_power(real(min(aimed_error/max(e(1), tiny(1.0_qp)), most_in_hand), wp), &
                                                        1.0_wp/6.0_wp), qp), shortest), longest)
            past(2:) = past(:remembered - 1)
            slope(2:) = slope(:remembered - 1)
            past_t(2:) = past_t(:remembered - 1)
            past(1) = z
            slope(1) = tangent
            past_t(1) = t
            known = min(known + 1, remembered)
         else
            h = h*after_refusal
            if (h < least_step .or. t < hopeless) exit
         end if
      end do
      if (t > 0.0_qp) then
         call assess_end
         return
      end if
      do k = 1, most_corrections
         call correct(path, t, z, tangent, e(1))
         if (e(1) < settled) exit
      end do
      ! what the rounding of the data moves as far as it likes is there by that alone
      if (e(1) < converged .and. &
          .not. epsilon(1.0_wp)*maxval(abs(tangent%v)/max(abs(z%v), tiny(1.0_qp))) > undetermined) then
         v = cmplx(z%v, kind=wp)
         outcome = path_arrived
      else
         call assess_end
      end if

   contains

      !> Keep the place: the last one above each look's t.
      subroutine look()
         type(look_t) :: now

         now%t = t
         now%v = z%v
         now%tangent = tangent%v
         if (t > first_look .or. .not. looks(1)%t > 0.0_qp) looks(1) = now
         if (t > last_look .or. .not. looks(2)%t > 0.0_qp) looks(2) = now
      end subroutine look

      !> What an end is like that is not regular.
      subroutine assess_end()
         complex(qp) :: ends(variables, 2)
         real(qp) :: growth(variables, 2), exponent, weight
         integer :: i

         if (looks(2)%t > late) return
         do i = 1, 2
            growth(:, i) = real(looks(i)%t*looks(i)%tangent/looks(i)%v, qp)
         end do
         if (any(growth(:, 2) < -runs_away)) then
            outcome = path_to_infinity
            return
         end if
         do i = 1, 2
            growth(1, i) = maxval(abs(looks(i)%t*looks(i)%tangent))
         end do
         if (.not. looks(2)%t < 0.5_qp*looks(1)%t .or. .not. growth(1, 2) > 0.0_qp) return
         exponent = real(log(real(growth(1, 1)/growth(1, 2), wp))/log(real(looks(1)%t/looks(2)%t, wp)), qp)
         if (.not. exponent > 0.5_qp/real(most_winding, qp)) return
         winding = max(nint(1.0_wp/real(exponent, wp)), 1)
         ! z - m t dz/dt has no first term; what is left of both looks gives the second
         weight = real(real(looks(2)%t/looks(1)%t, wp)**(2.0_wp/real(winding, wp)), qp)
         do i = 1, 2
            ends(:, i) = looks(i)%v - real(winding, qp)*looks(i)%t*looks(i)%tangent
         end do
         v = cmplx((ends(:, 2) - weight*ends(:, 1))/(1.0_qp - weight), kind=wp)
         outcome = path_singular
      end subroutine assess_end
   end subroutine follow_precisely

   !> Hermite extrapolation through past points and tangents.
   pure subroutine predict(past_t, past, slope, aimed, z)
      real(qp), intent(in) :: past_t(:)
      type(tracking_state_t), intent(in) :: past(:), slope(:) !! shape (n)
      real(qp), intent(in) :: aimed
      type(tracking_state_t), intent(out) :: z
      real(qp) :: basis, sum_of_slopes, of_point, of_tangent
      integer :: k, m

      do k = 1, size(past_t)
         basis = 1.0_qp
         sum_of_slopes = 0.0_qp
         do m = 1, size(past_t)
            if (m == k) cycle
            basis = basis*(aimed - past_t(m))/(past_t(k) - past_t(m))
            sum_of_slopes = sum_of_slopes + 1.0_qp/(past_t(k) - past_t(m))
         end do
         of_tangent = (aimed - past_t(k))*basis**2
         of_point = basis**2 - 2.0_qp*sum_of_slopes*of_tangent
         z%v = z%v + of_point*past(k)%v + of_tangent*slope(k)%v
         z%g = z%g + of_point*past(k)%g + of_tangent*slope(k)%g
         z%gh = z%gh + of_point*past(k)%gh + of_tangent*slope(k)%gh
      end do
   end subroutine predict

   !> One step of Newton's method at t; the tangent where it began, and its relative size: huge where the equations are singular.
   pure subroutine correct(path, t, z, tangent, size_of_step)
      type(problem_path_t), intent(in) :: path
      real(qp), intent(in) :: t
      type(tracking_state_t), intent(inout) :: z
      type(tracking_state_t), intent(out) :: tangent
      real(qp), intent(out) :: size_of_step
      complex(qp), allocatable :: block(:, :, :)     ! large: it would fill a small stack
      complex(qp), allocatable :: owed(:, :, :)      ! of terms along the path and their points: changes of g, gh by the others
      complex(qp) :: m(variables + 2, variables), row(columns)
      complex(qp) :: by_t, turn, sides(2), factor
      complex(qp) :: dv(variables, 2), dg(2), dgh(2)
      real(qp) :: scale(variables), largest
      integer :: count_of(most_points), n, rows, i, j, k, p

      allocate (block(columns, most_equations, most_points), owed(columns, 2, most_points))
      associate (problem => path%problem)
         n = problem%unknowns
         do k = 1, variables
            if (any(problem%free(:n) == k)) cycle
            z%v(k) = t*cmplx(path%from%pivot(k), kind=qp) + (1.0_qp - t)*cmplx(path%to%pivot(k), kind=qp)
         end do
         size_of_step = huge(1.0_qp)
         scale = max(abs(z%v), tiny(1.0_qp))
         rows = 0
         do j = 1, problem%points
            if (problem%kind(j) == kind_pose) then
               by_t = cmplx(path%from%turn(j), kind=qp) - cmplx(path%to%turn(j), kind=qp)
               turn = exp(cmplx(path%to%turn(j), kind=qp) + t*by_t)
               z%g(j) = turn - 1.0_qp
               z%gh(j) = 1.0_qp/turn - 1.0_qp
            end if
            if (problem%kind(j) == kind_rate) then
               call equations_of_term(path, j, t, z, owed, block(:, :, j))
               count_of(j) = 3
            else
               call equations_of(path, j, t, z, block(:, :, j), count_of(j))
            end if
            ! turns first: each is in the equations of its point only
            p = 0
            if (problem%kind(j) /= kind_pose) p = 2
            do k = 1, p
               i = k - 1 + maxloc(abs(block(k, k:count_of(j), j)), dim=1)
               row = block(:, i, j)
               block(:, i, j) = block(:, k, j)
               block(:, k, j) = row
               if (.not. abs(row(k)) > 0.0_qp) return
               do i = k + 1, count_of(j)
                  factor = block(k, i, j)/row(k)
                  block(k + 1:, i, j) = block(k + 1:, i, j) - factor*row(k + 1:)
                  block(k, i, j) = (0.0_qp, 0.0_qp)
               end do
            end do
            if (problem%continued(j)) then
               owed(:, :, j) = (0.0_qp, 0.0_qp)
               if (p == 0) then
                  owed(of_rate, :, j) = [by_t*turn, -by_t/turn]
               else
                  owed(3:, 2, j) = -block(3:, 2, j)/block(of_gh, 2, j)
                  owed(3:, 1, j) = -(block(3:, 1, j) + block(of_gh, 1, j)*owed(3:, 2, j))/block(of_g, 1, j)
               end if
            end if
            do i = p + 1, count_of(j)
               rows = rows + 1
               m(:n, rows) = block(2 + problem%free(:n), i, j)*scale(problem%free(:n))
               m(n + 1:n + 2, rows) = -block(of_value:of_rate, i, j)
               do k = 1, variables
                  if (any(problem%free(:n) == k)) cycle
                  m(n + 2, rows) = m(n + 2, rows) - block(2 + k, i, j)*moving(k)
               end do
               largest = maxval(abs(real(m(:n, rows), qp)) + abs(aimag(m(:n, rows))))
               if (.not. largest > 0.0_qp) return
               m(:n + 2, rows) = m(:n + 2, rows)*(1.0_qp/largest)
            end do
         end do
         do k = 1, n
            p = k - 1 + maxloc(abs(real(m(k, k:n), qp)) + abs(aimag(m(k, k:n))), dim=1)
            row(:n + 2) = m(:n + 2, p)
            m(:n + 2, p) = m(:n + 2, k)
            if (.not. abs(row(k)) > 0.0_qp) return
            factor = 1.0_qp/row(k)
            m(k:n + 2, k) = row(k:n + 2)*factor
            do i = 1, n
               if (i /= k) m(k + 1:n + 2, i) = m(k + 1:n + 2, i) - m(k, i)*m(k + 1:n + 2, k)
            end do
         end do
         size_of_step = maxval(abs(m(n + 1, :n)))
         dv(:, 1) = (0.0_qp, 0.0_qp)
         do k = 1, variables
            dv(k, 2) = moving(k)
         end do
         do i = 1, 2
            dv(problem%free(:n), i) = m(n + i, :n)*scale(problem%free(:n))
         end do
         tangent%v = dv(:, 2)
         do j = 1, problem%points
            if (problem%kind(j) == kind_pose) then
               by_t = cmplx(path%from%turn(j), kind=qp) - cmplx(path%to%turn(j), kind=qp)
               tangent%g(j) = by_t*(z%g(j) + 1.0_qp)
               tangent%gh(j) = -by_t*(z%gh(j) + 1.0_qp)
               cycle
            end if
            associate (b => block(:, :, j))
               do i = 1, 2
                  do k = 1, 2
                     sides(k) = b(of_value - 1 + i, k) + sum(b(3:2 + variables, k)*dv(:, i))
                  end do
                  dgh(i) = -sides(2)/b(of_gh, 2)
                  dg(i) = -(sides(1) + b(of_gh, 1)*dgh(i))/b(of_g, 1)
               end do
            end associate
            tangent%g(j) = dg(2)
            tangent%gh(j) = dgh(2)
            size_of_step = max(size_of_step, abs(dg(1))/(1.0_qp + abs(z%g(j))), abs(dgh(1))/(1.0_qp + abs(z%gh(j))))
            z%g(j) = z%g(j) + dg(1)
            z%gh(j) = z%gh(j) + dgh(1)
         end do
         z%v = z%v + dv(:, 1)
      end associate

   contains

      !> By t, of a number that is given.
      pure complex(qp) function moving(k)
         integer, intent(in) :: k

         moving = cmplx(path%from%pivot(k), kind=qp) - cmplx(path%to%pivot(k), kind=qp)
      end function moving
   end subroutine correct

   !> The equations of point j: derivatives by g, gh and the legs, value, and derivative by t.
   pure subroutine equations_of(path, j, t, z, block, equations)
      type(problem_path_t), intent(in) :: path
      integer, intent(in) :: j
      real(qp), intent(in) :: t
      type(tracking_state_t), intent(in) :: z
      complex(qp), intent(out) :: block(columns, most_equations)
      integer, intent(out) :: equations
      complex(qp) :: d, dh, dd, ddh, by_t, q, f, fh
      integer, parameter :: legs = 2

      dd = cmplx(path%from%d(j), kind=qp) - cmplx(path%to%d(j), kind=qp)
      ddh = cmplx(path%from%dh(j), kind=qp) - cmplx(path%to%dh(j), kind=qp)
      d = cmplx(path%to%d(j), kind=qp) + t*dd
      dh = cmplx(path%to%dh(j), kind=qp) + t*ddh
      by_t = cmplx(path%from%turn(j), kind=qp) - cmplx(path%to%turn(j), kind=qp)
      block = (0.0_qp, 0.0_qp)
      associate (g => z%g(j), gh => z%gh(j), x => z%v(at_x), xh => z%v(at_xh), a => z%v(at_a), ah => z%v(at_ah), &
                 y => z%v(at_y), yh => z%v(at_yh), b => z%v(at_b), bh => z%v(at_bh))
         if (path%problem%slides) then
            block(of_g, 1) = y
            block(of_gh, 1) = -b*yh
            block(legs + at_y, 1) = g
            block(legs + at_yh, 1) = -b*gh
            block(legs + at_b, 1) = -(yh*gh + dh)
            block(of_value, 1) = d + y*g - b*(yh*gh + dh)
            block(of_rate, 1) = dd - b*ddh
         else if (path%problem%differences) then
            ! leg b less leg a
            block(of_g, 1) = (ah - dh)*y + bh*(x + y)
            block(of_gh, 1) = (a - d)*yh + b*(xh + yh)
            block(legs + at_x, 1) = bh*g
            block(legs + at_xh, 1) = b*gh
            block(legs + at_a, 1) = yh*gh
            block(legs + at_ah, 1) = y*g
            block(legs + at_y, 1) = (ah + bh - dh)*g - dh
            block(legs + at_yh, 1) = (a + b - d)*gh - d
            block(legs + at_b, 1) = (xh + yh)*gh + dh
            block(legs + at_bh, 1) = (x + y)*g + d
            block(of_value, 1) = block(of_g, 1)*g + block(of_gh, 1)*gh + (bh - yh)*d + (b - y)*dh
            block(of_rate, 1) = -ddh*(y*g + y - b) - dd*(yh*gh + yh - bh)
         else
            call leg_equation(d, dh, dd, ddh, g, gh, z%v(at_y:at_bh), at_y, block(:, 1))
         end if
         if (path%problem%kind(j) == kind_timed) then
            equations = 4
            q = exp(cmplx(path%to%turn(j), kind=qp) + t*by_t)
            f = q - 1.0_qp
            fh = 1.0_qp/q - 1.0_qp
            block(of_g, 2) = x
            block(legs + at_x, 2) = g - f
            block(legs + at_a, 2) = f
            block(of_value, 2) = x*g - (x - a)*f + d
            block(of_rate, 2) = dd - (x - a)*q*by_t
            block(of_gh, 3) = xh
            block(legs + at_xh, 3) = gh - fh
            block(legs + at_ah, 3) = fh
            block(of_value, 3) = xh*gh - (xh - ah)*fh + dh
            block(of_rate, 3) = ddh + (xh - ah)/q*by_t
         else
            equations = 3
            call leg_equation(d, dh, dd, ddh, g, gh, z%v(at_x:at_ah), at_x, block(:, 2))
         end if
         if (path%problem%kind(j) == kind_pose) then
            equations = 2
            block(of_rate, :2) = block(of_rate, :2) + by_t*(block(of_g, :2)*(1.0_qp + g) - block(of_gh, :2)*(1.0_qp + gh))
         else
            block(of_g, equations) = 1.0_qp + gh
            block(of_gh, equations) = 1.0_qp + g
            block(of_value, equations) = g*gh + g + gh
         end if
      end associate
   end subroutine equations_of

   !> The equations of a term along the path, the changes of the terms before it put in.
   pure subroutine equations_of_term(path, j, t, z, owed, block)
      type(problem_path_t), intent(in) :: path
      integer, intent(in) :: j
      real(qp), intent(in) :: t
      type(tracking_state_t), intent(in) :: z
      complex(qp), intent(in) :: owed(columns, 2, most_points)
      complex(qp), intent(out) :: block(columns, most_equations)
      complex(qp), dimension(0:most_order) :: g, gh, d, dh, dd, ddh
      complex(qp) :: factor_g(3), factor_gh(3)
      integer, parameter :: legs = 2
      integer :: i, k, m

      m = path%problem%order(j)
      g = (0.0_qp, 0.0_qp)
      gh = g
      d = g
      dh = g
      dd = g
      ddh = g
      do i = 0, m
         associate (own => path%problem%chain(i, j))
            if (own == 0) cycle
            g(i) = z%g(own)
            gh(i) = z%gh(own)
            dd(i) = cmplx(path%from%d(own), kind=qp) - cmplx(path%to%d(own), kind=qp)
            ddh(i) = cmplx(path%from%dh(own), kind=qp) - cmplx(path%to%dh(own), kind=qp)
            d(i) = cmplx(path%to%d(own), kind=qp) + t*dd(i)
            dh(i) = cmplx(path%to%dh(own), kind=qp) + t*ddh(i)
         end associate
      end do
      block = (0.0_qp, 0.0_qp)
      call term_of_leg(z%v(at_x:at_ah), at_x, g(:m), gh(:m), d(:m), dh(:m), dd(:m), ddh(:m), block(:, 1))
      associate (x => z%v(at_x), xh => z%v(at_xh), a => z%v(at_a), ah => z%v(at_ah), y => z%v(at_y), yh => z%v(at_yh), &
                 b => z%v(at_b), bh => z%v(at_bh))
         if (path%problem%slides) then
            block(of_g, 2) = y
            block(of_gh, 2) = -b*yh
            block(legs + at_y, 2) = g(m)
            block(legs + at_yh, 2) = -b*gh(m)
            block(legs + at_b, 2) = -(yh*gh(m) + dh(m))
            block(of_value, 2) = d(m) + y*g(m) - b*(yh*gh(m) + dh(m))
            block(of_rate, 2) = dd(m) - b*ddh(m)
         else if (path%problem%differences) then
            ! leg b less leg a
            block(of_g, 2) = (ah - dh(0))*y + bh*(x + y)
            block(of_gh, 2) = (a - d(0))*yh + b*(xh + yh)
            block(legs + at_x, 2) = bh*g(m)
            block(legs + at_xh, 2) = b*gh(m)
            block(legs + at_a, 2) = yh*gh(m)
            block(legs + at_ah, 2) = y*g(m)
            block(legs + at_y, 2) = (ah + bh)*g(m) - dh(m) - sum(dh(:m)*g(m:0:-1))
            block(legs + at_yh, 2) = (a + b)*gh(m) - d(m) - sum(d(:m)*gh(m:0:-1))
            block(legs + at_b, 2) = (xh + yh)*gh(m) + dh(m)
            block(legs + at_bh, 2) = (x + y)*g(m) + d(m)
            block(of_value, 2) = (ah*y + bh*(x + y))*g(m) + (a*yh + b*(xh + yh))*gh(m) + (bh - yh)*d(m) + (b - y)*dh(m) - &
                                 y*sum(dh(:m)*g(m:0:-1)) - yh*sum(d(:m)*gh(m:0:-1))
            block(of_rate, 2) = (b - y)*ddh(m) + (bh - yh)*dd(m) - y*sum(ddh(:m)*g(m:0:-1)) - yh*sum(dd(:m)*gh(m:0:-1))
         else
            call term_of_leg(z%v(at_y:at_bh), at_y, g(:m), gh(:m), d(:m), dh(:m), dd(:m), ddh(:m), block(:, 2))
         end if
         block(of_g, 3) = 1.0_qp + gh(0)
         block(of_gh, 3) = 1.0_qp + g(0)
         block(of_value, 3) = g(m) + gh(m) + sum(g(:m)*gh(m:0:-1))
         do i = 0, m - 1
            associate (before => path%problem%chain(i, j))
               if (before == 0) cycle
               factor_g = [-dh(m - i)*x, (0.0_qp, 0.0_qp), gh(m - i)]
               factor_gh = [-d(m - i)*xh, (0.0_qp, 0.0_qp), g(m - i)]
               if (.not. path%problem%slides) then
                  factor_g(2) = -dh(m - i)*y
                  factor_gh(2) = -d(m - i)*yh
               end if
               do k = 1, 3
                  block(3:, k) = block(3:, k) + factor_g(k)*owed(3:, 1, before) + factor_gh(k)*owed(3:, 2, before)
               end do
            end associate
         end do
      end associate
   end subroutine equations_of_term

   !> A term along the path of the equation of a leg with two pins, whose numbers begin at a place of the unknowns.
   pure subroutine term_of_leg(leg, first, g, gh, d, dh, dd, ddh, row)
      complex(qp), intent(in) :: leg(4)
      integer, intent(in) :: first
      complex(qp), intent(in) :: g(0:), gh(0:), d(0:), dh(0:), dd(0:), ddh(0:) !! shapes (0:order)
      complex(qp), intent(inout) :: row(columns)
      integer :: m

      m = ubound(g, 1)
      associate (x => leg(1), xh => leg(2), a => leg(3), ah => leg(4))
         row(of_g) = (ah - dh(0))*x
         row(of_gh) = (a - d(0))*xh
         row(2 + first:5 + first) = [ah*g(m) - dh(m) - sum(dh*g(m:0:-1)), a*gh(m) - d(m) - sum(d*gh(m:0:-1)), &
                                     xh*gh(m) + dh(m), x*g(m) + d(m)]
         row(of_value) = ah*x*g(m) + a*xh*gh(m) + (ah - xh)*d(m) + (a - x)*dh(m) - x*sum(dh*g(m:0:-1)) - &
                         xh*sum(d*gh(m:0:-1)) - sum(d*dh(m:0:-1))
         row(of_rate) = (a - x)*ddh(m) + (ah - xh)*dd(m) - x*sum(ddh*g(m:0:-1)) - xh*sum(dd*gh(m:0:-1)) - &
                        sum(dd*dh(m:0:-1)) - sum(d*ddh(m:0:-1))
      end associate
   end subroutine term_of_leg

   !> The equation of a leg with two pins, whose numbers begin at a place of the unknowns.
   pure subroutine leg_equation(d, dh, dd, ddh, g, gh, leg, first, row)
      complex(qp), intent(in) :: d, dh, dd, ddh, g, gh, leg(4)
      integer, intent(in) :: first
      complex(qp), intent(inout) :: row(columns)

      associate (x => leg(1), xh => leg(2), a => leg(3), ah => leg(4))
         row(of_g) = (ah - dh)*x
         row(of_gh) = (a - d)*xh
         row(2 + first:5 + first) = [(ah - dh)*g - dh, (a - d)*gh - d, xh*gh + dh, x*g + d]
         row(of_value) = row(of_g)*g + row(of_gh)*gh + (ah - xh)*d + (a - x)*dh - d*dh
         row(of_rate) = -ddh*(x*g + d + x - a) - dd*(xh*gh + dh + xh - ah)
      end associate
   end subroutine leg_equation
end module psalm_quad_path
