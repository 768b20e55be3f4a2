!> Descent of a four-bar that passes points: damped least squares over shape and inputs, the linear unknowns solved for after every
!> step; the inputs kept in order; the best timing of a curve.
!>
!> Sources: damping, Nielsen (1999); order, pooling of adjacent violators, Barlow et al. (1972); notation, `psalm_path_fit`.
module psalm_path_descent
   use psalm_kinds, only: wp, degrees_per_radian, full_turn
   use psalm_linear, only: solve_positive
   use psalm_path_angles, only: limits_angle, keep_angles, slide_along
   use psalm_path_fit, only: fitted_path_t, path_timing_t, path_workspace_t, trace_at, halve, fit_linear, find_violations, weigh, &
                             square, &
                             dot, unknowns, lanes, column_turn, column_miss, shape_g, shape_s, shape_q, rows_most, places
   use psalm_sort, only: pool_rising
   implicit none (type, external)
   private
   public :: descend, put_in_order, retime, nearest_g, least_sigma, largest_q

   real(wp), parameter :: largest_g = 148.0_wp, largest_sigma = 1100.0_wp !! exp(5) and exp(7): the box is bounded
   real(wp), parameter :: nearest_g = 1.0e-6_wp      !! to 1, where ground and crank are equal
   real(wp), parameter :: least_sigma = 1.0_wp + 1.0e-7_wp, largest_q = 1.0_wp - 1.0e-7_wp !! the crank turns, rounding or not
   real(wp), parameter :: together = 1.0e-9_wp       !! degrees; inputs so near are pooled

contains

   !> Improve a timing by damped least squares, the linear unknowns solved for after every step.
   subroutine descend(path, steps, gain, weight, margin, timing, work)
      type(fitted_path_t), intent(in) :: path
      integer, intent(in) :: steps                   !! at most
      real(wp), intent(in) :: gain                   !! relative; three steps with less end it
      real(wp), intent(in) :: weight                 !! of squared relative violations
      real(wp), intent(in) :: margin                 !! inside the bounds
      type(path_timing_t), intent(inout) :: timing
      type(path_workspace_t), intent(inout) :: work
      real(wp) :: h(unknowns, unknowns), slope(unknowns), step(unknowns)
      real(wp) :: damping, raise, merit, trial
      integer :: iteration, groups, small
      logical :: fresh, solved

      call halve(timing%t, work%half)
      call trace_at(timing, work%half, work%e, work%v)
      call weigh(path, work%e, work%v, margin, timing)
      merit = timing%error + weight*timing%violation
      damping = 1.0e-3_wp
      raise = 2.0_wp
      small = 0
      fresh = .true.
      do iteration = 1, steps
         if (fresh) call form_equations(path, weight, margin, timing, work, h, slope, groups)
         fresh = .false.
         call solve_step(path, timing, work, h, slope, groups, damping, step, solved)
         if (solved) then
            call take_step(path, timing, work, step, groups, damping, work%next)
            call put_in_order(work%next%t, work)
            call halve(work%next%t, work%half_next)
            call trace_at(work%next, work%half_next, work%e, work%v)
            work%other%z0 = work%next%z0
            work%other%w1 = work%next%w1
            work%other%w2 = work%next%w2
            call fit_linear(path, work%e, work%v, work%next, 0.0_wp)
            call weigh(path, work%e, work%v, margin, work%next)
            if (work%next%violation > 0.0_wp) then
               work%next%z0 = work%other%z0
               work%next%w1 = work%other%w1
               work%next%w2 = work%other%w2
               call weigh(path, work%e, work%v, margin, work%next)
            end if
            trial = work%next%error + weight*work%next%violation
         else
            trial = huge(trial)
         end if
         if (trial < merit) then
            small = merge(small + 1, 0, merit - trial < gain*merit)
            merit = trial
            timing = work%next
            work%half = work%half_next
            damping = max(0.2_wp*damping, 1.0e-12_wp)
            raise = 2.0_wp
            fresh = .true.
         else
            damping = damping*raise
            raise = 2.0_wp*raise
            small = small + 1
            if (damping > 1.0e8_wp) exit
         end if
         if (small >= 3) exit
      end do
   end subroutine descend

   !> Normal equations: those of the nine unknowns, and what each group of inputs meets.
   subroutine form_equations(path, weight, margin, timing, work, h, slope, groups)
      type(fitted_path_t), intent(in) :: path
      real(wp), intent(in) :: weight, margin
      type(path_timing_t), intent(in) :: timing
      type(path_workspace_t), intent(inout) :: work
      real(wp), intent(out) :: h(unknowns, unknowns), slope(unknowns)
      integer, intent(out) :: groups
      real(wp) :: amount(rows_most), rows(unknowns, rows_most), products(lanes, unknowns), re(lanes), im(lanes), wr, wi
      complex(wp) :: j
      integer :: k, a, m, count, group

      call trace_at(timing, work%half, work%e, work%v, work%turn, work%grow)
      call pool(timing, path, work, groups)
      products = 0.0_wp
      work%b(:, :groups) = 0.0_wp
      re = 0.0_wp
      im = 0.0_wp
      re(1) = 1.0_wp
      im(2) = 1.0_wp
      do k = 1, path%n
         re(3) = real(work%e(k), wp)
         im(3) = aimag(work%e(k))
         re(4) = -im(3)
         im(4) = re(3)
         re(5) = real(work%v(k), wp)
         im(5) = aimag(work%v(k))
         re(6) = -im(5)
         im(6) = re(5)
         do m = 1, 3
            j = timing%w2*work%grow(k, m)
            re(6 + m) = real(j, wp)
            im(6 + m) = aimag(j)
         end do
         j = timing%w1*cmplx(re(4), im(4), wp) + timing%w2*work%turn(k)
         re(column_turn) = real(j, wp)
         im(column_turn) = aimag(j)
         j = timing%z0 + timing%w1*work%e(k) + timing%w2*work%v(k) - path%point(k)
         re(column_miss) = real(j, wp)
         im(column_miss) = aimag(j)
         do a = 1, unknowns
            wr = path%weight(k)*re(a)
            wi = path%weight(k)*im(a)
            !$omp simd
            do m = 1, lanes
               products(m, a) = products(m, a) + (wr*re(m) + wi*im(m))
            end do
         end do
         group = work%group(k)
         wr = path%weight(k)*re(column_turn)
         wi = path%weight(k)*im(column_turn)
         work%b(:, group) = work%b(:, group) + (wr*re + wi*im)
      end do
      h = products(:unknowns, :)
      slope = products(column_miss, :)
      call find_violations(path, timing, margin, count, amount, rows)
      do k = 1, count
         do a = 1, unknowns
            h(:, a) = h(:, a) + weight*rows(a, k)*rows(:, k)
         end do
         slope = slope + weight*amount(k)*rows(:, k)
      end do
   end subroutine form_equations

   !> Inputs that stand together and would cross if each went its own way move as one.
   subroutine pool(timing, path, work, groups)
      type(path_timing_t), intent(in) :: timing
      type(fitted_path_t), intent(in) :: path
      type(path_workspace_t), intent(inout) :: work
      integer, intent(out) :: groups
      complex(wp) :: miss, turn
      real(wp) :: target, before, mass
      integer :: k

      groups = 0
      before = 0.0_wp
      mass = 0.0_wp
      do k = 1, path%n
         miss = timing%z0 + timing%w1*work%e(k) + timing%w2*work%v(k) - path%point(k)
         turn = timing%w1*cmplx(-aimag(work%e(k)), real(work%e(k), wp), wp) + timing%w2*work%turn(k)
         target = -dot(turn, miss)/max(square(turn), tiny(1.0_wp)**0.5_wp)
         if (k > 1) then
            if (timing%t(k) - timing%t(k - 1) <= together .and. target <= before) then
               before = (before*mass + target*square(turn))/max(mass + square(turn), tiny(1.0_wp))
               mass = mass + square(turn)
               work%group(k) = groups
               cycle
            end if
         end if
         groups = groups + 1
         work%group(k) = groups
         before = target
         mass = square(turn)
      end do
   end subroutine pool

   !> The damped step of the nine unknowns; shape numbers that push against their box are held, and limits of the transmission angle
   !> are kept, made linear.
   subroutine solve_step(path, timing, work, h, slope, groups, damping, step, solved)
      type(fitted_path_t), intent(in) :: path
      type(path_timing_t), intent(in) :: timing
      type(path_workspace_t), intent(in) :: work
      real(wp), intent(in) :: h(unknowns, unknowns), slope(unknowns), damping
      integer, intent(in) :: groups
      real(wp), intent(out) :: step(unknowns)
      logical, intent(out) :: solved
      real(wp) :: matrix(lanes, unknowns), right(unknowns), over, part, most
      logical :: held(unknowns)
      integer :: k, a, m

      matrix(:unknowns, :) = h
      matrix(unknowns + 1:, :) = 0.0_wp              ! not used
      right = -slope
      do a = 1, unknowns
         matrix(a, a) = h(a, a)*(1.0_wp + damping) + tiny(1.0_wp)**0.5_wp
      end do
      do k = 1, groups
         if (.not. work%b(column_turn, k) > 0.0_wp) cycle
         over = 1.0_wp/(work%b(column_turn, k)*(1.0_wp + damping))
         do a = 1, unknowns
            part = over*work%b(a, k)
            !$omp simd
            do m = 1, lanes
               matrix(m, a) = matrix(m, a) - part*work%b(m, k)
            end do
         end do
         right = right + (over*work%b(column_miss, k))*work%b(:unknowns, k)
      end do
      held = .false.
      held(shape_g) = (timing%g >= largest_g .and. right(shape_g) > 0.0_wp) .or. &
                      (timing%g <= 1.0_wp/largest_g .and. right(shape_g) < 0.0_wp)
      held(shape_s) = (timing%sigma <= least_sigma .and. right(shape_s) < 0.0_wp) .or. &
                      (timing%sigma >= largest_sigma .and. right(shape_s) > 0.0_wp)
      held(shape_q) = (timing%q <= -largest_q .and. right(shape_q) < 0.0_wp) .or. &
                      (timing%q >= largest_q .and. right(shape_q) > 0.0_wp)
      do a = shape_g, unknowns
         if (.not. held(a)) cycle
         matrix(:, a) = 0.0_wp
         matrix(a, :) = 0.0_wp
         matrix(a, a) = 1.0_wp
         right(a) = 0.0_wp
      end do
      call solve_positive(matrix(:unknowns, :), right, step, solved)
      if (solved .and. limits_angle(path)) call slide_along(path, timing, matrix(:unknowns, :), held, step, solved)
      if (.not. solved) return
      most = max(abs(step(shape_g)), abs(step(shape_q)), abs(step(shape_s))/1.5_wp)
      if (most > 1.0_wp) step = step/most
   end subroutine solve_step

   !> Go that far. Factors exp(x) are taken as (1 + x/2)/(1 - x/2): a step is only true to its first order anyway.
   subroutine take_step(path, timing, work, step, groups, damping, next)
      type(fitted_path_t), intent(in) :: path
      type(path_timing_t), intent(in) :: timing
      type(path_workspace_t), intent(in) :: work
      real(wp), intent(in) :: step(unknowns), damping
      integer, intent(in) :: groups
      type(path_timing_t), intent(inout) :: next
      real(wp) :: turn(groups)
      integer :: k

      next%z0 = timing%z0 + cmplx(step(1), step(2), wp)
      next%w1 = timing%w1 + cmplx(step(3), step(4), wp)
      next%w2 = timing%w2 + cmplx(step(5), step(6), wp)
      next%g = timing%g*factor(step(shape_g))
      if (timing%g > 1.0_wp) then
         next%g = min(max(next%g, 1.0_wp + nearest_g), largest_g)
      else
         next%g = min(max(next%g, 1.0_wp/largest_g), 1.0_wp - nearest_g)
      end if
      next%sigma = min(max(timing%sigma*factor(step(shape_s)), least_sigma), largest_sigma)
      next%q = min(max(timing%q + step(shape_q), -largest_q), largest_q)
      if (limits_angle(path)) call keep_angles(path, next)
      next%side = timing%side
      next%way = timing%way
      do k = 1, groups
         turn(k) = 0.0_wp
         if (work%b(column_turn, k) > 0.0_wp) &
            turn(k) = -(work%b(column_miss, k) + sum(work%b(:unknowns, k)*step))/(work%b(column_turn, k)*(1.0_wp + damping))
         turn(k) = min(max(turn(k), -1.0_wp), 1.0_wp)*degrees_per_radian
      end do
      next%t = timing%t + turn(work%group)

   contains

      pure real(wp) function factor(x)
         real(wp), intent(in) :: x

         factor = (2.0_wp + x)/(2.0_wp - x)
      end function factor
   end subroutine take_step

   !> The nearest inputs that rise and stay within one turn, cut at the widest gap.
   subroutine put_in_order(t, work)
      real(wp), intent(inout) :: t(:)
      type(path_workspace_t), intent(inout) :: work
      real(wp) :: gap, widest, excess
      integer :: n, k, cut, pools, j

      n = size(t)
      cut = n                                        ! the last input before the gap
      widest = t(1) + full_turn - t(n)
      do k = 1, n - 1
         gap = t(k + 1) - t(k)
         if (gap > widest) then
            widest = gap
            cut = k
         end if
      end do
      do j = 1, n
         k = cut + j
         work%level(j) = t(merge(k - n, k, k > n))
         if (k > n) work%level(j) = work%level(j) + full_turn
      end do
      call pool_rising(work%level(:n), work%last(:n), pools)
      excess = work%level(pools) - work%level(1) - full_turn
      if (excess > 0.0_wp) then
         gap = work%level(1) + 0.5_wp*excess
         work%level(:pools) = min(max(work%level(:pools), gap), gap + full_turn)
      end if
      pools = 1
      do j = 1, n
         if (j > work%last(pools)) pools = pools + 1
         k = cut + j
         if (k > n) then
            t(k - n) = work%level(pools) - full_turn
         else
            t(k) = work%level(pools)
         end if
      end do
   end subroutine put_in_order

   !> The best timing of a linkage's curve: dynamic programming over places of the crank, begun where the curve comes nearest to the
   !> first point.
   subroutine retime(path, timing, work)
      type(fitted_path_t), intent(in) :: path
      type(path_timing_t), intent(inout) :: timing
      type(path_workspace_t), intent(inout) :: work
      real(wp), parameter :: place_step = full_turn/real(places, wp)
      real(wp) :: near(3), total, best, x, y
      integer :: from(3), begun, i, k

      call trace_at(timing, work%half_round, work%e_round, work%v_round)
      do k = 1, places
         work%e_round(k) = timing%z0 + timing%w1*work%e_round(k) + timing%w2*work%v_round(k)
      end do
      do i = 1, path%n
         do k = 1, places
            x = real(work%e_round(k), wp) - real(path%point(i), wp)
            y = aimag(work%e_round(k)) - aimag(path%point(i))
            work%cost(k, i) = path%weight(i)*(x*x + y*y)
         end do
         work%cost(places + 1:, i) = work%cost(:places, i)
      end do
      near = huge(near)
      from = 0
      do k = 1, places
         associate (here => work%cost(k + 1, 1))
            if (here > work%cost(k, 1) .or. here > work%cost(k + 2, 1)) cycle
            i = maxloc(near, dim=1)
            if (here >= near(i)) cycle
            near(i) = here
            from(i) = k + 1
         end associate
      end do
      best = huge(best)
      do begun = 1, 3
         if (from(begun) == 0) cycle
         call go_round(from(begun), total)
         if (total >= best) cycle
         best = total
         call read_back(from(begun))
      end do

   contains

      subroutine go_round(start, total)
         integer, intent(in) :: start
         real(wp), intent(out) :: total
         integer :: j, m
         real(wp) :: before

         work%least(:, 1) = work%cost(start, 1)
         do m = 2, path%n
            before = huge(before)
            do j = 1, places
               before = min(before, work%least(j, m - 1) + work%cost(start + j - 1, m))
               work%least(j, m) = before
            end do
         end do
         total = work%least(places, path%n)
      end subroutine go_round

      !> The timing of the least sum just found.
      subroutine read_back(start)
         integer, intent(in) :: start
         integer :: m, place

         place = places
         do m = path%n, 1, -1
            do while (place > 1)
               if (work%least(place - 1, m) > work%least(place, m)) exit
               place = place - 1
            end do
            timing%t(m) = place_step*real(start + place - 2, wp)
         end do
      end subroutine read_back
   end subroutine retime
end module psalm_path_descent
