!> A linkage driven through a flexible shaft: Haines, chapter 7 (SSICS). The far end of the shaft turns at constant speed w; the
!> crank with the linkage's effective inertia J(phi) swings about it.
!>
!> J th'' + J' w th' + chi th' + (S + J'' w**2/2) th = -J' w**2/2, as a forced Hill equation in x:
!> c1 = (g' + C D)/g, c0 = (D**2 + g''/2)/g, p = -g'/(2 g) with g = J/J0 of mean 1 (his forms a and b differ in x only).
module psalm_flexible_drive
   use psalm_hill, only: hill_t, solve_hill
   use psalm_kinds, only: wp
   use psalm_periodic, only: periodic_t, periodic_from_samples
   implicit none (type, external)
   private
   public :: drive_response, mean_ratio, ratio_for_mean, drive_coefficients

   integer, parameter :: fewest_points = 64 !! samples of a turn for one harmonic of the inertia, times its highest
   integer, parameter :: per_harmonic = 16
   integer, parameter :: most_passes = 100  !! of the iteration for D

contains

   !> Swing of the crank about the steady turning, in radians of x. `tolerance` as in `solve_hill`.
   pure function drive_response(inertia, d, damping, tolerance) result(hill)
      type(periodic_t), intent(in) :: inertia !! J, any unit, positive
      real(wp), intent(in) :: d               !! D = sqrt(S/J0)/w, per radian of x
      real(wp), intent(in) :: damping         !! C = chi/sqrt(S J0)
      real(wp), intent(in) :: tolerance
      type(hill_t) :: hill
      type(periodic_t) :: c1, c0, p

      call drive_coefficients(inertia, d, damping, c1, c0, p)
      hill = solve_hill(c1, c0, p, tolerance)
   end function drive_response

   !> c1, c0 and p of the Hill equation.
   pure subroutine drive_coefficients(inertia, d, damping, c1, c0, p)
      type(periodic_t), intent(in) :: inertia
      real(wp), intent(in) :: d, damping
      type(periodic_t), intent(out) :: c1, c0, p
      real(wp), allocatable :: g(:), slope(:), bend(:)

      call ratio_and_slopes(inertia, g, slope, bend)
      c1 = periodic_from_samples((slope + damping*d)/g)
      c0 = periodic_from_samples((d*d + 0.5_wp*bend)/g)
      p = periodic_from_samples(-0.5_wp*slope/g)
   end subroutine drive_coefficients

   !> Mean of the ratio of the drive's frequency to the speed, sqrt((D**2 + g''/2)/g). Errors: `ok` false where the root is not
   !> real (the ratio then means nothing).
   pure subroutine mean_ratio(inertia, d, ratio, ok)
      type(periodic_t), intent(in) :: inertia
      real(wp), intent(in) :: d
      real(wp), intent(out) :: ratio
      logical, intent(out) :: ok
      real(wp), allocatable :: g(:), slope(:), bend(:)

      call ratio_and_slopes(inertia, g, slope, bend)
      ok = all(d*d + 0.5_wp*bend >= 0.0_wp)
      ratio = 0.0_wp
      if (ok) ratio = sum(sqrt((d*d + 0.5_wp*bend)/g))/real(size(g), wp)
   end subroutine mean_ratio

   !> D that gives a mean ratio: D <- ratio/mean sqrt((1 + g''/(2 D**2))/g) from D = ratio, `passes` times at most.
   !> Errors: `ok` false where a root on the way is not real or it does not converge.
   pure subroutine ratio_for_mean(inertia, ratio, d, ok, passes)
      type(periodic_t), intent(in) :: inertia
      real(wp), intent(in) :: ratio
      real(wp), intent(out) :: d
      logical, intent(out) :: ok
      integer, intent(in), optional :: passes !! to convergence if not given
      real(wp) :: before, now
      integer :: i, last

      last = most_passes
      if (present(passes)) last = passes
      d = ratio
      do i = 1, last
         before = d
         call mean_ratio(inertia, before, now, ok)
         if (.not. ok) return
         d = ratio*before/now
         if (abs(d - before) <= 4.0_wp*epsilon(1.0_wp)*d) return
      end do
      ok = present(passes)
   end subroutine ratio_for_mean

   !> J/J0 and its first and second derivative, densely enough for their quotients.
   pure subroutine ratio_and_slopes(inertia, g, slope, bend)
      type(periodic_t), intent(in) :: inertia
      real(wp), allocatable, intent(out) :: g(:), slope(:), bend(:)
      type(periodic_t) :: ratio, d1, d2
      integer :: n

      ratio = inertia%scaled(1.0_wp/inertia%mean())
      d1 = ratio%derivative(1)
      d2 = ratio%derivative(2)
      n = fewest_points + per_harmonic*ratio%highest()
      g = ratio%values(n)
      slope = d1%values(n)
      bend = d2%values(n)
   end subroutine ratio_and_slopes
end module psalm_flexible_drive
