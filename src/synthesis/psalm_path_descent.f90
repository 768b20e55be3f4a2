!> Descent of a four-bar that visits points: damped least squares over shape and inputs, the linear unknowns solved for after every
!> step; the inputs kept in order; the best timing of a curve.
!>
!> Sources: damping, Nielsen (1999); order, pooling of adjacent violators, Barlow et al. (1972); notation, `psalm_path_fit`.
module psalm_path_descent
   use psalm_kinds, only: wp, degrees_per_radian, full_turn
   use psalm_linear, only: solve_positive
   use psalm_path_fit, only: path_t, visit_t, path_room_t, trace_coupler, fit_linear, find_violations, weigh, square, dot, &
                             unknowns, shape_g, shape_s, shape_q, rows_most, places
   implicit none (type, external)
   private
   public :: descend, put_in_order, retime, nearest_g

   real(wp), parameter :: largest_g = 148.0_wp, largest_sigma = 1100.0_wp !! exp(5) and exp(7): the box is bounded
   real(wp), parameter :: nearest_g = 1.0e-6_wp      !! to 1, where ground and crank are equal
   real(wp), parameter :: least_sigma = 1.0_wp + 1.0e-7_wp, largest_q = 1.0_wp - 1.0e-7_wp !! the crank turns, rounding or not
   real(wp), parameter :: together = 1.0e-9_wp       !! degrees: inputs so near are pooled

contains

   !> Improve a visit by damped least squares, the linear unknowns solved for after every step.
   subroutine descend(path, steps, gain, weight, margin, visit, room)
      type(path_t), intent(in) :: path
      integer, intent(in) :: steps                   !! at most
      real(wp), intent(in) :: gain                   !! relative; three steps with less end it
      real(wp), intent(in) :: weight                 !! of squared relative violations
      real(wp), intent(in) :: margin                 !! inside the bounds
      type(visit_t), intent(inout) :: visit
      type(path_room_t), intent(inout) :: room
      real(wp) :: h(unknowns, unknowns), slope(unknowns), step(unknowns)
      real(wp) :: damping, raise, merit, trial
      integer :: iteration, groups, small
      logical :: fresh, solved

      call trace_coupler(visit, visit%t, room%e, room%v)
      call weigh(path, room%e, room%v, margin, visit)
      merit = visit%error + weight*visit%violation
      damping = 1.0e-3_wp
      raise = 2.0_wp
      small = 0
      fresh = .true.
      do iteration = 1, steps
         if (fresh) call form_equations(path, weight, margin, visit, room, h, slope, groups)
         fresh = .false.
         call solve_step(visit, room, h, slope, groups, damping, step, solved)
         if (solved) then
            call take_step(visit, room, step, groups, damping, room%next)
            call put_in_order(room%next%t, room)
            call trace_coupler(room%next, room%next%t, room%e, room%v)
            room%other%z0 = room%next%z0
            room%other%w1 = room%next%w1
            room%other%w2 = room%next%w2
            call fit_linear(path, room%e, room%v, room%next, 0.0_wp)
            call weigh(path, room%e, room%v, margin, room%next)
            if (room%next%violation > 0.0_wp) then
               room%next%z0 = room%other%z0
               room%next%w1 = room%other%w1
               room%next%w2 = room%other%w2
               call weigh(path, room%e, room%v, margin, room%next)
            end if
            trial = room%next%error + weight*room%next%violation
         else
            trial = huge(trial)
         end if
         if (trial < merit) then
            small = merge(small + 1, 0, merit - trial < gain*merit)
            merit = trial
            visit = room%next
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
   subroutine form_equations(path, weight, margin, visit, room, h, slope, groups)
      type(path_t), intent(in) :: path
      real(wp), intent(in) :: weight, margin
      type(visit_t), intent(in) :: visit
      type(path_room_t), intent(inout) :: room
      real(wp), intent(out) :: h(unknowns, unknowns), slope(unknowns)
      integer, intent(out) :: groups
      real(wp) :: amount(rows_most), rows(unknowns, rows_most), w
      complex(wp) :: j(unknowns), miss, turn
      integer :: k, a, m, count, group

      call trace_coupler(visit, visit%t, room%e, room%v, room%turn, room%grow)
      call pool(visit, path, room, groups)
      h = 0.0_wp
      slope = 0.0_wp
      room%b(:, :groups) = 0.0_wp
      room%c(:groups) = 0.0_wp
      room%r(:groups) = 0.0_wp
      j(1) = (1.0_wp, 0.0_wp)
      j(2) = (0.0_wp, 1.0_wp)
      do k = 1, path%n
         w = path%weight(k)
         group = room%group(k)
         j(3) = room%e(k)
         j(4) = j(2)*room%e(k)
         j(5) = room%v(k)
         j(6) = j(2)*room%v(k)
         do m = 1, 3
            j(6 + m) = visit%w2*room%grow(k, m)
         end do
         miss = visit%z0 + visit%w1*room%e(k) + visit%w2*room%v(k) - path%point(k)
         turn = visit%w1*j(4) + visit%w2*room%turn(k)
         do a = 1, unknowns
            do m = 1, a
               h(m, a) = h(m, a) + w*dot(j(m), j(a))
            end do
            slope(a) = slope(a) + w*dot(j(a), miss)
            room%b(a, group) = room%b(a, group) + w*dot(j(a), turn)
         end do
         room%c(group) = room%c(group) + w*square(turn)
         room%r(group) = room%r(group) + w*dot(turn, miss)
      end do
      call find_violations(path, visit, margin, count, amount, rows)
      do k = 1, count
         do a = 1, unknowns
            h(:a, a) = h(:a, a) + weight*rows(a, k)*rows(:a, k)
         end do
         slope = slope + weight*amount(k)*rows(:, k)
      end do
   end subroutine form_equations

   !> Inputs that stand together and would cross if each went its own way move as one.
   subroutine pool(visit, path, room, groups)
      type(visit_t), intent(in) :: visit
      type(path_t), intent(in) :: path
      type(path_room_t), intent(inout) :: room
      integer, intent(out) :: groups
      complex(wp) :: miss, turn
      real(wp) :: wish, before, mass
      integer :: k

      groups = 0
      before = 0.0_wp
      mass = 0.0_wp
      do k = 1, path%n
         miss = visit%z0 + visit%w1*room%e(k) + visit%w2*room%v(k) - path%point(k)
         turn = visit%w1*cmplx(-aimag(room%e(k)), real(room%e(k), wp), wp) + visit%w2*room%turn(k)
         wish = -dot(turn, miss)/max(square(turn), tiny(1.0_wp)**0.5_wp)
         if (k > 1) then
            if (visit%t(k) - visit%t(k - 1) <= together .and. wish <= before) then
               before = (before*mass + wish*square(turn))/max(mass + square(turn), tiny(1.0_wp))
               mass = mass + square(turn)
               room%group(k) = groups
               cycle
            end if
         end if
         groups = groups + 1
         room%group(k) = groups
         before = wish
         mass = square(turn)
      end do
   end subroutine pool

   !> The damped step of the nine unknowns; shape numbers that push against their box are held.
   subroutine solve_step(visit, room, h, slope, groups, damping, step, solved)
      type(visit_t), intent(in) :: visit
      type(path_room_t), intent(in) :: room
      real(wp), intent(in) :: h(unknowns, unknowns), slope(unknowns), damping
      integer, intent(in) :: groups
      real(wp), intent(out) :: step(unknowns)
      logical, intent(out) :: solved
      real(wp) :: matrix(unknowns, unknowns), right(unknowns), over, most
      logical :: free(unknowns)
      integer :: k, a, kept(unknowns), n

      matrix = h
      right = -slope
      do a = 1, unknowns
         matrix(a, a) = h(a, a)*(1.0_wp + damping) + tiny(1.0_wp)**0.5_wp
      end do
      do k = 1, groups
         if (.not. room%c(k) > 0.0_wp) cycle
         over = 1.0_wp/(room%c(k)*(1.0_wp + damping))
         do a = 1, unknowns
            matrix(:a, a) = matrix(:a, a) - (over*room%b(a, k))*room%b(:a, k)
         end do
         right = right + (over*room%r(k))*room%b(:, k)
      end do
      free = .true.
      free(shape_g) = .not. ((visit%g >= largest_g .and. right(shape_g) > 0.0_wp) .or. &
                             (visit%g <= 1.0_wp/largest_g .and. right(shape_g) < 0.0_wp))
      free(shape_s) = .not. ((visit%sigma <= least_sigma .and. right(shape_s) < 0.0_wp) .or. &
                             (visit%sigma >= largest_sigma .and. right(shape_s) > 0.0_wp))
      free(shape_q) = .not. ((visit%q <= -largest_q .and. right(shape_q) < 0.0_wp) .or. &
                             (visit%q >= largest_q .and. right(shape_q) > 0.0_wp))
      n = count(free)
      kept(:n) = pack([(a, a=1, unknowns)], free)
      step = 0.0_wp
      call solve_positive(matrix(kept(:n), kept(:n)), right(kept(:n)), step(:n), solved)
      if (.not. solved) return
      right = step
      step = 0.0_wp
      step(kept(:n)) = right(:n)
      most = max(abs(step(shape_g)), abs(step(shape_q)), abs(step(shape_s))/1.5_wp)
      if (most > 1.0_wp) step = step/most
   end subroutine solve_step

   !> Go that far. Factors exp(x) are taken as (1 + x/2)/(1 - x/2): a step is only true to its first order anyway.
   subroutine take_step(visit, room, step, groups, damping, next)
      type(visit_t), intent(in) :: visit
      type(path_room_t), intent(in) :: room
      real(wp), intent(in) :: step(unknowns), damping
      integer, intent(in) :: groups
      type(visit_t), intent(inout) :: next
      real(wp) :: turn(groups)
      integer :: k

      next%z0 = visit%z0 + cmplx(step(1), step(2), wp)
      next%w1 = visit%w1 + cmplx(step(3), step(4), wp)
      next%w2 = visit%w2 + cmplx(step(5), step(6), wp)
      next%g = visit%g*factor(step(shape_g))
      if (visit%g > 1.0_wp) then
         next%g = min(max(next%g, 1.0_wp + nearest_g), largest_g)
      else
         next%g = min(max(next%g, 1.0_wp/largest_g), 1.0_wp - nearest_g)
      end if
      next%sigma = min(max(visit%sigma*factor(step(shape_s)), least_sigma), largest_sigma)
      next%q = min(max(visit%q + step(shape_q), -largest_q), largest_q)
      next%side = visit%side
      do k = 1, groups
         turn(k) = 0.0_wp
         if (room%c(k) > 0.0_wp) turn(k) = -(room%r(k) + sum(room%b(:, k)*step))/(room%c(k)*(1.0_wp + damping))
         turn(k) = min(max(turn(k), -1.0_wp), 1.0_wp)*degrees_per_radian
      end do
      next%t = visit%t + turn(room%group)

   contains

      pure real(wp) function factor(x)
         real(wp), intent(in) :: x

         factor = (2.0_wp + x)/(2.0_wp - x)
      end function factor
   end subroutine take_step

   !> The nearest inputs that rise and stay within one turn: pool adjacent violators, cut at the widest gap.
   subroutine put_in_order(t, room)
      real(wp), intent(inout) :: t(:)
      type(path_room_t), intent(inout) :: room
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
      pools = 0
      do j = 1, n
         k = cut + j
         pools = pools + 1
         room%level(pools) = t(merge(k - n, k, k > n))
         if (k > n) room%level(pools) = room%level(pools) + full_turn
         room%mass(pools) = 1.0_wp
         room%last(pools) = j
         do while (pools > 1)
            if (room%level(pools - 1) < room%level(pools)) exit
            associate (a => room%mass(pools - 1), b => room%mass(pools))
               room%level(pools - 1) = (a*room%level(pools - 1) + b*room%level(pools))/(a + b)
               room%mass(pools - 1) = a + b
               room%last(pools - 1) = room%last(pools)
            end associate
            pools = pools - 1
         end do
      end do
      excess = room%level(pools) - room%level(1) - full_turn
      if (excess > 0.0_wp) then
         gap = room%level(1) + 0.5_wp*excess
         room%level(:pools) = min(max(room%level(:pools), gap), gap + full_turn)
      end if
      pools = 1
      do j = 1, n
         if (j > room%last(pools)) pools = pools + 1
         k = cut + j
         if (k > n) then
            t(k - n) = room%level(pools) - full_turn
         else
            t(k) = room%level(pools)
         end if
      end do
   end subroutine put_in_order

   !> The best timing of a visit's curve: dynamic programming over places of the crank, begun where the curve comes nearest to the
   !> first point.
   subroutine retime(path, visit, room)
      type(path_t), intent(in) :: path
      type(visit_t), intent(inout) :: visit
      type(path_room_t), intent(inout) :: room
      real(wp), parameter :: place_step = full_turn/real(places, wp)
      real(wp) :: near(3), total, best
      integer :: from(3), begun, i, k, place, best_from
      complex(wp) :: at

      call trace_coupler(visit, [(place_step*real(k, wp), k=0, places - 1)], room%e_round, room%v_round)
      do k = 1, places
         at = visit%z0 + visit%w1*room%e_round(k) + visit%w2*room%v_round(k)
         do i = 1, path%n
            room%cost(k, i) = path%weight(i)*square(at - path%point(i))
         end do
      end do
      near = huge(near)
      from = 0
      do k = 1, places
         associate (here => room%cost(k, 1))
            if (here > room%cost(1 + modulo(k - 2, places), 1) .or. here > room%cost(1 + modulo(k, places), 1)) cycle
            i = maxloc(near, dim=1)
            if (here >= near(i)) cycle
            near(i) = here
            from(i) = k
         end associate
      end do
      best = huge(best)
      best_from = 0
      do begun = 1, 3
         if (from(begun) == 0) cycle
         call go_round(from(begun), total)
         if (total >= best) cycle
         best = total
         best_from = from(begun)
      end do
      if (best_from == 0) return
      call go_round(best_from, total)
      k = places
      do i = path%n, 1, -1
         do while (k > 1)
            if (room%least(k - 1, i) > room%least(k, i)) exit
            k = k - 1
         end do
         place = best_from + k - 1
         visit%t(i) = place_step*real(place - 1, wp)
      end do

   contains

      subroutine go_round(start, total)
         integer, intent(in) :: start
         real(wp), intent(out) :: total
         integer :: j, m
         real(wp) :: before

         room%least(:, 1) = room%cost(start, 1)
         do m = 2, path%n
            before = huge(before)
            do j = 1, places
               before = min(before, room%least(j, m - 1) + room%cost(1 + modulo(start + j - 2, places), m))
               room%least(j, m) = before
            end do
         end do
         total = room%least(places, path%n)
      end subroutine go_round
   end subroutine retime
end module psalm_path_descent
