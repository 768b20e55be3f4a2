!> Extremes and sums of many samples, number by number.
module psalm_sample_sums
   use psalm_kinds, only: wp, i8
   implicit none (type, external)
   private
   public :: enter_sample

contains

   !> Enter the deviations of a sample.
   pure subroutine enter_sample(n, deviations, band, low, high, total, squares, beyond, within)
      integer, intent(in) :: n
      real(wp), intent(in) :: deviations(n)
      real(wp), intent(in) :: band(n)             !! largest amounts
      real(wp), intent(inout) :: low(n), high(n)  !! extremes so far
      real(wp), intent(inout) :: total(n), squares(n) !! sums of deviations and of their squares
      real(wp), intent(inout) :: beyond(n)        !! samples beyond the band
      logical, intent(out) :: within              !! no amount is beyond
      integer(i8) :: outside
      integer :: i

      outside = 0_i8
      do i = 1, n
         outside = outside + merge(1_i8, 0_i8, abs(deviations(i)) > band(i))
         beyond(i) = beyond(i) + merge(1.0_wp, 0.0_wp, abs(deviations(i)) > band(i))
         low(i) = merge(deviations(i), low(i), deviations(i) < low(i))
         high(i) = merge(deviations(i), high(i), deviations(i) > high(i))
         total(i) = total(i) + deviations(i)
         squares(i) = squares(i) + deviations(i)**2
      end do
      within = outside == 0_i8
   end subroutine enter_sample
end module psalm_sample_sums
