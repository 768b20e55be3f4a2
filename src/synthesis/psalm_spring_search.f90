!> Springs that make a load least: the drive's or a joint's, its range, its RMS or its greatest amount.
!>
!> For given places of its ends every load is linear in S and k = S L of a spring of stiffness S and free length L, and the least
!> range, RMS or amount is a convex problem: one step is the global optimum, with the bound that proves it. Otherwise least squares
!> go from many starts to an optimum of the RMS (for the range, of the differences from the mean), whose curved valleys they follow;
!> from the best of these the search goes by tangents of the places: the load is linear in their moves too, to first order, so that
!> each step is convex with moves of limited length.
module psalm_spring_search
   use psalm_conic, only: conic_t, conic_solution_t, solve_conic
   use psalm_kinds, only: wp
   use psalm_linear, only: triangle_of
   use psalm_spring_design_group, only: criterion_range, criterion_rms, criterion_peak
   use psalm_spring_fit, only: fit_springs
   use psalm_spring_load, only: spring_limits_t, found_spring_t, load_with, criterion_of, add_slopes, stiffest_in, &
                                criterion_spread
   use psalm_stop, only: stop_t, is_to_end, tell_host
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: spring_search_t, search_springs

   integer, parameter :: each = 6                  !! unknowns of a spring: x, y of either end, S, k
   integer, parameter :: most_steps = 300
   real(wp), parameter :: least_part = 0.01_wp     !! of a reach: so near to its middle
   integer, parameter :: followed = 6              !! fits that are followed by tangents
   integer, parameter :: times_met = 3             !! so often is the best fit to be met
   integer, parameter :: times_last = 3            !! starts, against those up to the last better fit
   integer, parameter :: least_times = 8           !! the starts asked for, so many times, if springs are several
   integer, parameter :: most_times = 16           !! and at most so many times
   real(wp), parameter :: no_load = 1.0e-9_wp      !! of the bare load: smaller ones are rounding
   real(wp), parameter :: alike = 2.0e-2_wp        !! relative difference of fits of the same valley
   real(wp), parameter :: least_move = 1.0e-7_wp   !! of the reach: the search ends with such moves
   real(wp), parameter :: least_gain = 1.0e-10_wp  !! relative gain of a step that is one of the last
   real(wp), parameter :: as_low = 1.0e-6_wp       !! relative difference of values that are the same optimum

   type :: spring_search_t
      type(found_spring_t), allocatable :: springs(:)
      real(wp) :: value = huge(1.0_wp)             !! of the criterion, N or N m
      real(wp) :: bound = 0.0_wp                   !! where the places are given: no springs there have less
      real(wp) :: gap = 0.0_wp, residual = 0.0_wp
      integer :: starts = 0, ended_here = 0
      logical :: convex = .false.
      logical :: found = .false.
   end type spring_search_t

contains

   !> The best springs from `starts` starts (of several springs `least_times` as many), and from more of them until the best fit is
   !> met `times_met` times, at most `most_times` as many. Of several springs every one is looked for alone, too: the result is
   !> never worse than the best of them.
   recursive subroutine search_springs(bare, allowed, criterion, starts, seed, search, stop)
      real(wp), intent(in) :: bare(:, :)           !! shape (positions, components): the load without these springs
      type(spring_limits_t), intent(in) :: allowed(:)
      integer, intent(in) :: criterion, starts, seed
      type(spring_search_t), intent(out) :: search
      type(stop_t), intent(in), optional :: stop   !! asked before each start, each step: the best so far is there
      type(spring_search_t) :: tried
      type(found_spring_t) :: springs(size(allowed)), best(size(allowed), followed)
      type(xoshiro_t) :: random
      real(wp), allocatable :: values(:)
      real(wp) :: value, nothing, least(followed)
      integer :: start, k, made, smooth, last_better
      logical :: again

      smooth = criterion_rms
      if (criterion == criterion_range) smooth = criterion_spread
      call random%seed(seed, purpose_starts)
      search%springs = springs
      if (all([(allowed(k)%reach, k=1, size(allowed))] <= 0.0_wp)) then
         do k = 1, size(allowed)
            call draw(random, allowed(k), springs(k))
         end do
         call go_by_tangents(bare, allowed, criterion, springs, search, stop)
         search%starts = 1
         search%ended_here = 1
         return
      end if
      nothing = no_load*criterion_of(smooth, bare)
      made = 0
      last_better = 0
      least = huge(least)
      allocate (values(most_times*starts))
      do start = 1, most_times*starts
         if (made > 0 .and. is_to_end(stop)) exit
         if (start > 1) call tell_host(stop, start - 1, most_times*starts)
         call random%use_stream(start)
         ! every other start draws but one spring anew, in one of the best that there are
         again = modulo(start, 2) == 0 .and. made > 0 .and. size(allowed) > 1
         if (again) springs = best(:, modulo(start/2, count(least < huge(least))) + 1)
         do k = 1, size(allowed)
            if (again .and. modulo(start/2, size(allowed)) + 1 /= k) cycle
            call draw(random, allowed(k), springs(k))
         end do
         call go_by_tangents(bare, allowed, smooth, springs, tried, stop, steps=1)
         if (.not. tried%found) cycle
         call fit_springs(bare, allowed, smooth, tried%springs, value, stop)
         made = made + 1
         values(made) = value
         if (value < least(1)*(1.0_wp - as_low) - nothing) last_better = start
         call insert()
         if (start < starts*merge(least_times, 1, size(allowed) > 1) .or. start < times_last*last_better) cycle
         if (count(values(:made) <= least(1)*(1.0_wp + as_low) + nothing) >= times_met) exit
      end do
      search%starts = made
      do k = 1, min(followed, made)
         if (k > 1 .and. is_to_end(stop)) return
         if (least(k) >= huge(least)) exit
         call go_by_tangents(bare, allowed, criterion, best(:, k), tried, stop)
         call keep(count(abs(values(:made) - least(k)) <= as_low*least(k) + nothing))
      end do
      if (size(allowed) == 1) return
      do k = 1, size(allowed)
         if (is_to_end(stop)) return
         call search_springs(bare, allowed(k:k), criterion, starts, seed, tried, stop)
         if (.not. tried%found) cycle
         springs = search%springs
         springs%stiffness = 0.0_wp
         springs(k) = tried%springs(1)
         call go_by_tangents(bare, allowed, criterion, springs, tried, stop)
         call keep(1)
      end do

   contains

      !> Put a fit among the best, of which no two are alike.
      subroutine insert()
         integer :: at

         at = findloc(abs(least - value) <= alike*value + nothing, .true., dim=1)
         if (at > 0) then
            if (value >= least(at)) return
            least(at:) = [least(at + 1:), huge(1.0_wp)]
            best(:, at:followed - 1) = best(:, at + 1:)
         end if
         at = count(least <= value) + 1
         if (at > followed) return
         least(at + 1:) = least(at:followed - 1)
         best(:, at + 1:) = best(:, at:followed - 1)
         least(at) = value
         best(:, at) = tried%springs
      end subroutine insert

      subroutine keep(times)
         integer, intent(in) :: times             !! that it was met

         if (.not. tried%found .or. tried%value >= search%value) return
         tried%starts = search%starts
         tried%ended_here = times
         search = tried
      end subroutine keep
   end subroutine search_springs

   !> Ends anywhere within their reach, every other one nearer to its middle: stiff springs with short arms have optima there.
   !> A free length anywhere between its limits; stiffness comes with the first step.
   subroutine draw(random, allowed, spring)
      type(xoshiro_t), intent(inout) :: random
      type(spring_limits_t), intent(in) :: allowed
      type(found_spring_t), intent(out) :: spring
      real(wp) :: draw_now
      integer :: e, c

      do e = 1, 2
         do
            do c = 1, 2
               call random%next(draw_now)
               spring%at(c, e) = 2.0_wp*draw_now - 1.0_wp
            end do
            if (sum(spring%at(:, e)**2) <= 1.0_wp) exit
         end do
         spring%at(:, e) = allowed%reach(e)*spring%at(:, e)
         call random%next(draw_now)
         if (draw_now < 0.5_wp) spring%at(:, e) = spring%at(:, e)*least_part**(2.0_wp*draw_now)
      end do
      call random%next(draw_now)
      spring%free = allowed%free(1) + draw_now*(allowed%free(2) - allowed%free(1))
   end subroutine draw

   !> A local optimum from a start. The first step gives the best stiffness for its places; `steps` limits their number. Before each
   !> further step the host is asked.
   subroutine go_by_tangents(bare, allowed, criterion, begin, best, stop, steps)
      real(wp), intent(in) :: bare(:, :)
      type(spring_limits_t), intent(in) :: allowed(:)
      integer, intent(in) :: criterion
      type(found_spring_t), intent(in) :: begin(:)
      type(spring_search_t), intent(out) :: best
      type(stop_t), intent(in), optional :: stop
      integer, intent(in), optional :: steps
      type(spring_search_t) :: tried
      type(found_spring_t) :: springs(size(begin))
      real(wp) :: move, gain
      integer :: step, k, last

      last = most_steps
      if (present(steps)) last = steps
      springs = begin
      best%springs = springs
      best%convex = all([(allowed(k)%reach, k=1, size(allowed))] <= 0.0_wp)
      move = 0.0_wp    ! first the best stiffness for these places
      do step = 1, last
         if (step > 1 .and. is_to_end(stop)) exit
         call solve_step(bare, allowed, criterion, springs, move, tried)
         if (.not. tried%found) then
            if (step == 1) return
            move = 0.25_wp*move
            if (move < least_move) exit
            cycle
         end if
         tried%value = criterion_of(criterion, load_with(bare, allowed, tried%springs))
         if (step == 1 .or. tried%value < best%value) then
            gain = huge(1.0_wp)
            if (step > 1) gain = (best%value - tried%value)/max(best%value, tiny(1.0_wp))
            tried%convex = best%convex
            best = tried
            springs = tried%springs
            if (best%convex) exit
            if (gain <= least_gain .and. move < 1.0e-2_wp) exit
            move = min(1.0_wp, max(2.0_wp*move, 0.25_wp))
         else
            move = 0.25_wp*move
            if (move < least_move) exit
         end if
      end do
   end subroutine go_by_tangents

   !> The convex problem of one step: springs whose ends move at most `move` reaches.
   subroutine solve_step(bare, allowed, criterion, springs, move, result)
      real(wp), intent(in) :: bare(:, :)
      type(spring_limits_t), intent(in) :: allowed(:)
      integer, intent(in) :: criterion
      type(found_spring_t), intent(in) :: springs(:)
      real(wp), intent(in) :: move
      type(spring_search_t), intent(out) :: result
      type(conic_t) :: problem
      type(conic_solution_t) :: solution
      real(wp) :: constant(size(bare, 1), size(bare, 2)), slopes(size(bare, 1), size(bare, 2), each)
      real(wp) :: unit, stiff(size(allowed)), length(size(allowed)), limit, value
      real(wp), allocatable :: rows(:, :), triangle(:, :), scales(:)
      integer, allocatable :: column(:, :), sizes(:)
      integer :: k, e, c, n, tau, level, row, cone, positions, comps, i, lines
      logical :: smooth

      smooth = criterion == criterion_rms .or. criterion == criterion_spread
      positions = size(bare, 1)
      comps = size(bare, 2)
      unit = criterion_of(criterion, bare)
      result%springs = springs
      if (.not. unit > 0.0_wp) then
         ! there is nothing to be made less
         result%found = .true.
         result%springs%stiffness = 0.0_wp
         return
      end if
      ! unknowns: moves of the ends in reaches, S and k/length in stiff; then the level of a range, and tau
      allocate (column(each, size(allowed)), source=0)
      n = 0
      do k = 1, size(allowed)
         do e = 1, 2
            if (.not. (allowed(k)%reach(e) > 0.0_wp .and. move > 0.0_wp)) cycle
            column(2*e - 1:2*e, k) = [n + 1, n + 2]
            n = n + 2
         end do
         column(5, k) = n + 1
         n = n + 1
         if (allowed(k)%free(2) > allowed(k)%free(1)) then
            column(6, k) = n + 1
            n = n + 1
         end if
      end do
      level = 0
      if (criterion == criterion_range) level = n + 1
      if (criterion == criterion_range) n = n + 1
      n = n + 1
      tau = n
      allocate (scales(n), source=1.0_wp)
      allocate (rows(positions*comps, n + 1), source=0.0_wp)
      constant = load_with(bare, allowed, springs)
      do k = 1, size(allowed)
         slopes = 0.0_wp
         call add_slopes(allowed(k), springs(k), slopes)
         if (column(6, k) == 0) then
            ! the free length is given: k follows from S
            slopes(:, :, 5) = slopes(:, :, 5) + allowed(k)%free(1)*slopes(:, :, 6)
            slopes(:, :, 6) = 0.0_wp
         end if
         ! a stiffness whose load is of the size of what is to be made less
         length(k) = max(maxval(allowed(k)%reach), maxval(abs(allowed(k)%free)))
         if (.not. length(k) > 0.0_wp) length(k) = 1.0_wp
         stiff(k) = unit/max(maxval(abs(slopes(:, :, 5))), tiny(1.0_wp)/epsilon(1.0_wp))
         do e = 1, each
            if (column(e, k) == 0) cycle
            select case (e)
            case (1, 2)
               scales(column(e, k)) = allowed(k)%reach(1)
            case (3, 4)
               scales(column(e, k)) = allowed(k)%reach(2)
            case (5)
               scales(column(e, k)) = stiff(k)
            case default
               scales(column(e, k)) = stiff(k)*length(k)
            end select
            rows(:, column(e, k)) = reshape(slopes(:, :, e), [positions*comps])*scales(column(e, k))/unit
         end do
         ! S and k are unknowns themselves, not their changes
         constant = constant - springs(k)%stiffness*slopes(:, :, 5) - springs(k)%stiffness*springs(k)%free*slopes(:, :, 6)
      end do
      rows(:, n + 1) = reshape(constant, [positions*comps])/unit
      if (criterion == criterion_spread) then
         do k = 1, n + 1
            rows(:, k) = rows(:, k) - sum(rows(:, k))/real(positions, wp)
         end do
      end if
      if (level > 0) rows(:, level) = -1.0_wp
      lines = 1
      do k = 1, size(allowed)
         lines = lines + 2
         if (column(6, k) > 0) lines = lines + 2
      end do
      if (criterion == criterion_range .or. (criterion == criterion_peak .and. comps == 1)) lines = lines + 2*positions
      allocate (sizes(0))
      do k = 1, size(allowed)
         do e = 1, 2
            if (column(2*e, k) > 0) sizes = [sizes, 3, 3]
         end do
      end do
      if (smooth) sizes = [sizes, n + 2]
      if (criterion == criterion_peak .and. comps == 2) sizes = [sizes, spread(3, 1, positions)]
      problem%lines = lines
      problem%cones = sizes
      allocate (problem%q(n), problem%g(lines + sum(sizes), n), problem%h(lines + sum(sizes)), source=0.0_wp)
      problem%q(tau) = 1.0_wp
      row = 1
      problem%g(1, tau) = 1.0_wp
      problem%h(1) = 1.0e3_wp
      do k = 1, size(allowed)
         limit = stiffest_in(allowed(k), bare)/stiff(k)
         problem%g(row + 1, column(5, k)) = -1.0_wp
         problem%g(row + 2, column(5, k)) = 1.0_wp
         problem%h(row + 2) = limit
         row = row + 2
         if (column(6, k) == 0) cycle
         problem%g(row + 1, column(5, k)) = allowed(k)%free(1)/length(k)
         problem%g(row + 1, column(6, k)) = -1.0_wp
         problem%g(row + 2, column(5, k)) = -allowed(k)%free(2)/length(k)
         problem%g(row + 2, column(6, k)) = 1.0_wp
         row = row + 2
      end do
      cone = lines
      do k = 1, size(allowed)
         do e = 1, 2
            if (column(2*e, k) == 0) cycle
            problem%h(cone + 1) = 1.0_wp + 1.0e-9_wp
            problem%h(cone + 4) = move
            do c = 1, 2
               problem%h(cone + 1 + c) = springs(k)%at(c, e)/allowed(k)%reach(e)
               problem%g(cone + 1 + c, column(2*e - 2 + c, k)) = -1.0_wp
               problem%g(cone + 4 + c, column(2*e - 2 + c, k)) = -1.0_wp
            end do
            cone = cone + 6
         end do
      end do
      if (smooth) then
         triangle = triangle_of(rows/sqrt(real(positions*comps, wp)))
         problem%g(cone + 1, tau) = -1.0_wp
         problem%g(cone + 2:cone + n + 2, :) = -triangle(:, :n)
         problem%h(cone + 2:cone + n + 2) = triangle(:, n + 1)
      else if (comps == 2) then
         do i = 1, positions
            problem%g(cone + 1, tau) = -1.0_wp
            problem%g(cone + 2:cone + 3, :) = -rows([i, positions + i], :n)
            problem%h(cone + 2:cone + 3) = rows([i, positions + i], n + 1)
            cone = cone + 3
         end do
      else
         problem%g(row + 1:row + positions, :) = rows(:, :n)
         problem%h(row + 1:row + positions) = -rows(:, n + 1)
         problem%g(row + positions + 1:row + 2*positions, :) = -rows(:, :n)
         problem%h(row + positions + 1:row + 2*positions) = rows(:, n + 1)
         problem%g(row + 1:row + 2*positions, tau) = -1.0_wp
      end if
      call solve_conic(problem, solution)
      result%found = solution%solved
      if (.not. solution%solved) return
      do k = 1, size(allowed)
         associate (spring => result%springs(k))
            do e = 1, 4
               if (column(e, k) == 0) cycle
               associate (at => spring%at(modulo(e - 1, 2) + 1, (e + 1)/2))
                  at = at + scales(column(e, k))*solution%x(column(e, k))
               end associate
            end do
            spring%stiffness = max(0.0_wp, scales(column(5, k))*solution%x(column(5, k)))
            spring%free = allowed(k)%free(1)
            if (column(6, k) > 0 .and. spring%stiffness > 0.0_wp) then
               value = scales(column(6, k))*solution%x(column(6, k))/spring%stiffness
               spring%free = min(max(value, allowed(k)%free(1)), allowed(k)%free(2))
            end if
         end associate
      end do
      result%gap = solution%gap
      result%residual = solution%residual
      result%bound = max(0.0_wp, solution%bound)*unit
      if (criterion == criterion_range) result%bound = 2.0_wp*result%bound
   end subroutine solve_step
end module psalm_spring_search
