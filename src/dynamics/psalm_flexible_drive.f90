!> A linkage driven through a flexible shaft: Haines, chapter 7 (SSICS). The far end of the shaft turns at constant speed w; the
!> crank with the linkage's effective inertia J(phi) swings about it.
!>
!> J th'' + J' w th' + chi th' + (S + J'' w**2/2) th = -J' w**2/2, as a forced Hill equation in x:
!> c1 = (g' + C D)/g, c0 = (D**2 + g''/2)/g, p = -g'/(2 g) with g = J/J0 of mean 1 (his forms a and b differ in x only).
!>
!> Weight, loads and springs have a torque Q(phi) on the crank, dampers -B(phi) times its speed. Of Eksergian's equation
!> J phi'' + J' phi'**2/2 = Q - B phi' - S th - chi th', phi = w t + th, the terms of first order in th add B/(J0 w) to c1 g,
!> -Q'/(J0 w**2) + B'/(J0 w) to c0 g and Q/(J0 w**2) - B/(J0 w) to p g.
!>
!> Where the far end turns by psi(x), x = w t, at a speed that varies, phi = psi + th. With g, Q and B as functions of x, a dash
!> being d/dx, c0 g then has (g'' + g' psi''/psi')/2 - Q'/(psi' J0 w**2) + B'/(J0 w) besides D**2, and p g is
!> -g psi'' - g' psi'/2 + Q/(J0 w**2) - B psi'/(J0 w); c1 is as before.
module psalm_flexible_drive
   use psalm_hill, only: hill_t, solve_hill
   use psalm_kinds, only: wp
   use psalm_periodic, only: periodic_t, periodic_from_samples
   implicit none (type, external)
   private
   public :: drive_response, mean_ratio, least_ratio, ratio_for_mean, drive_coefficients, drive_torque_t

   !> What acts on the crank besides its inertia and the shaft, against x.
   type :: drive_torque_t
      type(periodic_t) :: torque               !! Q/(J0 w**2)
      type(periodic_t) :: damping              !! B/(J0 w)
      type(periodic_t) :: rate, push           !! psi' and psi'': 1 and 0 at constant speed
   end type drive_torque_t

   integer, parameter :: fewest_points = 64 !! samples of a turn for one harmonic of the inertia, times its highest
   integer, parameter :: per_harmonic = 16
   integer, parameter :: most_passes = 100  !! of the iteration for D

contains

   !> Swing of the crank about the steady turning, in radians of x. `tolerance` as in `solve_hill`.
   pure function drive_response(inertia, d, damping, tolerance, acting) result(hill)
      type(periodic_t), intent(in) :: inertia !! J, any unit, positive
      real(wp), intent(in) :: d               !! D = sqrt(S/J0)/w, per radian of x
      real(wp), intent(in) :: damping         !! C = chi/sqrt(S J0)
      real(wp), intent(in) :: tolerance
      type(drive_torque_t), intent(in), optional :: acting
      type(hill_t) :: hill
      type(periodic_t) :: c1, c0, p

      call drive_coefficients(inertia, d, damping, c1, c0, p, acting)
      hill = solve_hill(c1, c0, p, tolerance)
   end function drive_response

   !> c1, c0 and p of the Hill equation.
   pure subroutine drive_coefficients(inertia, d, damping, c1, c0, p, acting)
      type(periodic_t), intent(in) :: inertia
      real(wp), intent(in) :: d, damping
      type(periodic_t), intent(out) :: c1, c0, p
      type(drive_torque_t), intent(in), optional :: acting
      real(wp), allocatable :: g(:), slope(:), hold(:), q(:), b(:), rate(:)

      call ratio_and_slopes(inertia, g, slope, hold, acting)
      if (present(acting)) then
         q = acting%torque%values(size(g))
         b = acting%damping%values(size(g))
         c1 = periodic_from_samples((slope + damping*d + b)/g)
         rate = acting%rate%values(size(g))
         p = periodic_from_samples((-0.5_wp*slope*rate + q - b*rate)/g - acting%push%values(size(g)))
      else
         c1 = periodic_from_samples((slope + damping*d)/g)
         p = periodic_from_samples(-0.5_wp*slope/g)
      end if
      c0 = periodic_from_samples((d*d + hold)/g)
   end subroutine drive_coefficients

   !> Mean of the ratio of the drive's frequency to the speed, sqrt(c0). Errors: `ok` false where the root is not real (the ratio
   !> then means nothing).
   pure subroutine mean_ratio(inertia, d, ratio, ok, acting)
      type(periodic_t), intent(in) :: inertia
      real(wp), intent(in) :: d
      real(wp), intent(out) :: ratio
      logical, intent(out) :: ok
      type(drive_torque_t), intent(in), optional :: acting
      real(wp), allocatable :: g(:), slope(:), hold(:)

      call ratio_and_slopes(inertia, g, slope, hold, acting)
      ok = all(d*d + hold >= 0.0_wp)
      ratio = 0.0_wp
      if (ok) ratio = sum(sqrt((d*d + hold)/g))/real(size(g), wp)
   end subroutine mean_ratio

   !> Least of that ratio over a turn; 0 where it is not real.
   pure real(wp) function least_ratio(inertia, d, acting)
      type(periodic_t), intent(in) :: inertia
      real(wp), intent(in) :: d
      type(drive_torque_t), intent(in), optional :: acting
      real(wp), allocatable :: g(:), slope(:), hold(:)

      call ratio_and_slopes(inertia, g, slope, hold, acting)
      least_ratio = sqrt(max(minval((d*d + hold)/g), 0.0_wp))
   end function least_ratio

   !> D that gives a mean ratio: D <- ratio/mean sqrt(c0/D**2) from D = ratio, `passes` times at most.
   !> Errors: `ok` false where a root on the way is not real or it does not converge.
   pure subroutine ratio_for_mean(inertia, ratio, d, ok, passes, acting)
      type(periodic_t), intent(in) :: inertia
      real(wp), intent(in) :: ratio
      real(wp), intent(out) :: d
      logical, intent(out) :: ok
      integer, intent(in), optional :: passes !! to convergence if not given
      type(drive_torque_t), intent(in), optional :: acting
      real(wp) :: before, now
      integer :: i, last

      last = most_passes
      if (present(passes)) last = passes
      d = ratio
      do i = 1, last
         before = d
         call mean_ratio(inertia, before, now, ok, acting)
         if (.not. ok) return
         d = ratio*before/now
         if (abs(d - before) <= 4.0_wp*epsilon(1.0_wp)*d) return
      end do
      ok = present(passes)
   end subroutine ratio_for_mean

   !> J/J0, its slope, and what c0 g has besides D**2, densely enough for their quotients.
   pure subroutine ratio_and_slopes(inertia, g, slope, hold, acting)
      type(periodic_t), intent(in) :: inertia
      real(wp), allocatable, intent(out) :: g(:), slope(:), hold(:)
      type(drive_torque_t), intent(in), optional :: acting
      type(periodic_t) :: ratio, d1, d2
      real(wp), allocatable :: rate(:)
      integer :: n

      ratio = inertia%scaled(1.0_wp/inertia%mean())
      d1 = ratio%derivative(1)
      d2 = ratio%derivative(2)
      n = ratio%highest()
      if (present(acting)) n = max(n, acting%torque%highest(), acting%damping%highest(), acting%rate%highest(), &
                                   acting%push%highest())
      n = fewest_points + per_harmonic*n
      g = ratio%values(n)
      slope = d1%values(n)
      hold = 0.5_wp*d2%values(n)
      if (.not. present(acting)) return
      d1 = acting%torque%derivative(1)
      d2 = acting%damping%derivative(1)
      rate = acting%rate%values(n)
      hold = hold + 0.5_wp*slope*acting%push%values(n)/rate - d1%values(n)/rate + d2%values(n)
   end subroutine ratio_and_slopes
end module psalm_flexible_drive
