!> Bounds of the harmonics of a periodic function from its range and its total variation: Haines, chapter 1.
!>
!> For derivative p of f: R'_p = greatest - least value; R_p = half the total variation over a period. Then
!> a_n <= (2/pi) R'_p/n**p, a_n <= (2/pi) R_(p-1)/n**p, and the sharpest, a_n <= (2/pi) R'_p sin(R_(p-1)/R'_p)/n**p.
module psalm_harmonic_bounds
   use psalm_kinds, only: wp, pi
   implicit none (type, external)
   private
   public :: extent_t, extent_of, harmonic_bound

   type :: extent_t
      real(wp) :: range = 0.0_wp     !! R'
      real(wp) :: variation = 0.0_wp !! R
   end type extent_t

contains

   !> Of the samples of one period. Plateaus and single turning points count once, since it is the sum of all rises.
   pure type(extent_t) function extent_of(samples)
      real(wp), intent(in) :: samples(:)

      extent_of%range = maxval(samples) - minval(samples)
      extent_of%variation = 0.5_wp*sum(abs(cshift(samples, 1) - samples))
   end function extent_of

   !> Least bound of harmonic n of f from the extents of f and of its bounded derivatives.
   pure real(wp) function harmonic_bound(n, extents) result(bound)
      integer, intent(in) :: n                 !! 1, 2 ...
      type(extent_t), intent(in) :: extents(0:) !! of derivative 0, 1, ...: shape (0:q)
      real(wp) :: power, angle
      integer :: p

      bound = extents(0)%range
      power = 1.0_wp
      do p = 1, ubound(extents, 1) + 1
         power = power/real(n, wp)
         bound = min(bound, extents(p - 1)%variation*power)
         if (p > ubound(extents, 1)) exit
         bound = min(bound, extents(p)%range*power)
         if (.not. extents(p)%range > 0.0_wp) cycle
         angle = extents(p - 1)%variation/extents(p)%range
         ! at most a right angle, but for the rounding of samples
         if (angle < 0.5_wp*pi) bound = min(bound, extents(p)%range*sin(angle)*power)
      end do
      bound = 2.0_wp/pi*bound
   end function harmonic_bound
end module psalm_harmonic_bounds
