!> Random inputs at which a linkage is to pass points in their order: even, by the chords, or in runs with jumps between them.
module psalm_timing_draw
   use psalm_elementary, only: fractional_power
   use psalm_kinds, only: wp, full_turn
   use psalm_path_fit, only: fitted_path_t
   use psalm_xoshiro, only: xoshiro_t
   implicit none (type, external)
   private
   public :: draw_spread, draw_jumps, draw_corner, draw_ratio, follow, uniform

contains

   !> Uniform within 0 and 1.
   function uniform(random) result(deviate)
      type(xoshiro_t), intent(inout) :: random
      real(wp) :: deviate

      call random%next(deviate)
   end function uniform

   !> One to `most`, its logarithm uniform (in steps of 1/4096: the power is made by roots).
   real(wp) function draw_ratio(random, most) result(ratio)
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(in) :: most

      ratio = fractional_power(most, real(int(4096.0_wp*uniform(random)), wp)/4096.0_wp)
   end function draw_ratio

   !> A point, the sooner the sharper the path turns there.
   integer function draw_corner(path, random) result(corner)
      type(fitted_path_t), intent(in) :: path
      type(xoshiro_t), intent(inout) :: random
      real(wp) :: left

      left = uniform(random)
      do corner = 1, path%n - 1
         left = left - path%corner(corner)
         if (left < 0.0_wp) exit
      end do
   end function draw_corner

   !> Inputs that rise by these gaps.
   pure subroutine follow(gap, first, t)
      real(wp), intent(in) :: gap(:), first
      real(wp), intent(out) :: t(:)
      integer :: k

      t(1) = first
      do k = 2, size(t)
         t(k) = t(k - 1) + gap(k - 1)
      end do
   end subroutine follow

   !> Even or by the chords, over a part of the turn.
   subroutine draw_spread(path, random, gap)
      type(fitted_path_t), intent(in) :: path
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(out) :: gap(:)                !! shape (n): from each input to the next, the last one's to the first
      real(wp) :: span
      integer :: k

      span = full_turn*(0.2_wp + 0.8_wp*uniform(random))
      if (uniform(random) < 0.5_wp) then
         gap = path%chord + 1.0e-3_wp
      else
         do k = 1, size(gap)
            ! spaces between sorted deviates: shares of deviates of the exponential kind, here by a power of even ones
            gap(k) = share(random)
         end do
      end if
      gap(size(gap)) = 0.0_wp
      gap = span*gap/max(sum(gap), tiny(1.0_wp))
   end subroutine draw_spread

   !> Runs in which the inputs follow the chords, with jumps between them, half of these at corners.
   subroutine draw_jumps(path, random, gap)
      type(fitted_path_t), intent(in) :: path
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(out) :: gap(:)                !! shape (n), as of `draw_spread`
      logical :: jump(size(gap))
      real(wp) :: pace, runs, jumps, part
      integer :: k, breaks

      jump = .false.
      jump(size(gap)) = .true.                       ! the way back
      do breaks = 1, 1 + int(3.0_wp*uniform(random))
         if (uniform(random) < 0.5_wp) then
            k = 1 + min(int(real(size(gap), wp)*uniform(random)), size(gap) - 1)
         else
            k = draw_corner(path, random)            ! behind it, or before it
            if (uniform(random) < 0.5_wp) k = 1 + modulo(k - 2, size(gap))
         end if
         jump(k) = .true.
      end do
      pace = 1.0_wp
      do k = 1, size(gap)
         if (jump(k)) then
            gap(k) = share(random)
            ! near a normal deviate's exponential: between a quarter and four
            pace = 0.25_wp*draw_ratio(random, 16.0_wp)
         else
            gap(k) = pace*(path%chord(k) + 1.0e-3_wp)
         end if
      end do
      runs = max(sum(gap, mask=.not. jump), tiny(1.0_wp))
      jumps = sum(gap, mask=jump)
      part = 0.02_wp*draw_ratio(random, 35.0_wp)
      where (jump)
         gap = full_turn*(1.0_wp - part)*gap/jumps
      else where
         gap = full_turn*part*gap/runs
      end where
   end subroutine draw_jumps

   !> A positive deviate, small ones often: (1 - u)/u, cut.
   real(wp) function share(random)
      type(xoshiro_t), intent(inout) :: random
      real(wp) :: u

      u = uniform(random)
      share = min((1.0_wp - u)/u, 20.0_wp) + 1.0e-3_wp
   end function share
end module psalm_timing_draw
