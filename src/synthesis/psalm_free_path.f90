!> A path without prescribed timing, by a four-bar whose crank turns fully: random shapes and timings, many short descents, the
!> better part of them continued, the best finished. That is a batch; batches are independent of each other.
!>
!> Notation and what is eliminated: `psalm_path_fit`.
module psalm_free_path
   use psalm_kinds, only: wp, full_turn, half_turn
   use psalm_path_angles, only: limits_angle, keep_angles
   use psalm_path_descent, only: descend, put_in_order, retime, nearest_g, least_sigma, largest_q
   use psalm_path_fit, only: fitted_path_t, path_timing_t, path_workspace_t, trace_coupler, fit_linear, error_of, find_violations, &
                             rows_most, samples
   use psalm_timing_draw, only: draw_spread, draw_jumps, draw_corner, draw_ratio, follow, uniform
   use psalm_xoshiro, only: xoshiro_t
   implicit none (type, external)
   private
   public :: search_batch

   integer, parameter :: short = 32, medium = 4      !! descents of a batch; one is finished
   integer, parameter :: short_steps = 8, medium_steps = 40, final_steps = 1000 !! of a descent: valleys at a bound are long
   real(wp), parameter :: at_corners = 0.8_wp        !! part of the samples that pass a change point at a corner of the path
   real(wp), parameter :: ridge = 1.0e-7_wp          !! a sample's curve may be a point
   real(wp), parameter :: loose = 0.003_wp, firm = 0.0003_wp !! weights of violations, of the points' number, while errors are large
   real(wp), parameter :: inside = 1.0e-6_wp         !! relative distance from a bound that is aimed at

contains

   !> A random shape with random inputs.
   !>
   !> Where a path has corners its best linkage often passes a change point there, for only at one has its curve a corner too; most
   !> samples are drawn so.
   subroutine draw(path, random, timing)
      type(fitted_path_t), intent(in) :: path
      type(xoshiro_t), intent(inout) :: random
      type(path_timing_t), intent(inout) :: timing
      real(wp) :: lengths(4), gap(path%n)
      integer :: k

      do
         do k = 1, size(lengths)
            lengths(k) = draw_ratio(random, 10.0_wp)
         end do
         associate (ground => lengths(1), crank => lengths(2), coupler => lengths(3), follower => lengths(4))
            if (coupler + follower < ground + crank .or. abs(coupler - follower) > abs(ground - crank)) cycle
            timing%g = ground/crank
            if (abs(timing%g - 1.0_wp) < nearest_g) cycle
            timing%sigma = (coupler + follower)/(ground + crank)
            timing%q = (coupler - follower)/(ground - crank)
         end associate
         exit
      end do
      timing%side = path%side
      if (uniform(random) < at_corners) then
         call draw_jumps(path, random, gap)
         call follow(gap, 0.0_wp, timing%t)
         k = draw_corner(path, random)
         if (uniform(random) < 0.5_wp) then
            timing%sigma = least_sigma
            timing%t = timing%t + (half_turn - timing%t(k))
         else
            timing%q = sign(largest_q, uniform(random) - 0.5_wp)
            timing%t = timing%t - timing%t(k)
         end if
      else
         if (uniform(random) < 0.5_wp) then
            call draw_spread(path, random, gap)
         else
            call draw_jumps(path, random, gap)
         end if
         call follow(gap, uniform(random)*full_turn, timing%t)
      end if
      if (limits_angle(path)) call keep_angles(path, timing)
   end subroutine draw

   !> One batch: samples, short descents of the better half, longer ones of the best, and the best finished. Of several paths, to be
   !> followed in other directions or by other assemblies, each sample takes one at random.
   subroutine search_batch(paths, random, work, best)
      type(fitted_path_t), intent(in) :: paths(:)           !! as many points in each
      type(xoshiro_t), intent(inout) :: random
      type(path_workspace_t), intent(inout) :: work
      type(path_timing_t), intent(inout) :: best           !! finished; `worst` tells whether the bounds are kept
      real(wp) :: amount(rows_most), many, deviate
      integer :: i, count, order(samples)

      many = real(paths(1)%n, wp)
      do i = 1, samples
         call random%next(deviate)
         associate (timing => work%batch(i), path => paths(1 + min(int(deviate*real(size(paths), wp)), size(paths) - 1)))
            timing%way = 1 + min(int(deviate*real(size(paths), wp)), size(paths) - 1)
            call draw(path, random, timing)
            call put_in_order(timing%t, work)
            call trace_coupler(timing, timing%t, work%e, work%v)
            call fit_linear(path, work%e, work%v, timing, ridge*many)
            call find_violations(path, timing, 0.0_wp, count, amount)
            work%score(i) = error_of(path, work%e, work%v, timing) + loose*many*sum(min(amount(:count), 1.0_wp)**2)
         end associate
      end do
      call rank(samples, short)
      do i = 1, short
         call improve(work%batch(order(i)), short_steps, short_steps, 1.0e-3_wp, loose*many, 0.0_wp)
         work%score(order(i)) = work%batch(order(i))%error + loose*many*work%batch(order(i))%violation
      end do
      call rank(short, medium)
      do i = 1, medium
         call improve(work%batch(order(i)), medium_steps, medium_steps/2, 1.0e-3_wp, firm*many, 0.0_wp)
         work%score(order(i)) = work%batch(order(i))%error + firm*many*work%batch(order(i))%violation
      end do
      call rank(medium, 1)
      best = work%batch(order(1))
      call finish(best)

   contains

      !> The best `wanted` of the first `among` in the order so far.
      subroutine rank(among, wanted)
         integer, intent(in) :: among, wanted
         integer :: k, m, swap

         if (among == samples) order = [(k, k=1, samples)]
         do k = 1, wanted
            m = k - 1 + minloc(work%score(order(k:among)), dim=1)
            swap = order(k)
            order(k) = order(m)
            order(m) = swap
         end do
      end subroutine rank

      !> Descend, then from a better timing too; the better is kept.
      subroutine improve(timing, first, second, gain, weight, margin)
         type(path_timing_t), intent(inout) :: timing
         integer, intent(in) :: first, second
         real(wp), intent(in) :: gain, weight, margin

         associate (path => paths(timing%way))
            call descend(path, first, gain, weight, margin, timing, work)
            work%copy = timing
            call retime(path, work%copy, work)
            call descend(path, second, gain, weight, margin, work%copy, work)
         end associate
         if (work%copy%error + weight*work%copy%violation < timing%error + weight*timing%violation) timing = work%copy
      end subroutine improve

      !> To the end: the weight of violations follows the error, until every bound is kept.
      subroutine finish(timing)
         type(path_timing_t), intent(inout) :: timing
         real(wp) :: base, before
         integer :: k

         base = max(timing%error, 1.0e-9_wp*many)
         call improve(timing, final_steps, final_steps/2, 1.0e-5_wp, 30.0_wp*base, 0.0_wp)
         do k = 1, 3
            before = timing%error + 30.0_wp*base*timing%violation
            call improve(timing, final_steps/2, final_steps/2, 1.0e-5_wp, 30.0_wp*base, 0.0_wp)
            if (timing%error + 30.0_wp*base*timing%violation > 0.99_wp*before) exit
         end do
         do k = 2, 10, 2
            base = max(timing%error, 1.0e-9_wp*many)
            call descend(paths(timing%way), final_steps/2, 1.0e-7_wp, base*10.0_wp**k, inside, timing, work)
            if (timing%worst < inside) exit
         end do
      end subroutine finish
   end subroutine search_batch
end module psalm_free_path
