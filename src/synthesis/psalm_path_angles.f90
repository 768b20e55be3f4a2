!> Limits of the transmission angle of a four-bar whose crank turns fully: two inequalities of its shape, kept exactly.
!>
!> In the notation of `psalm_path_fit` the angle is extreme where the crank lies on the ground line. With kappa = (1 - cos mu)/2
!> it stays within mu and 180 degrees - mu if
!>
!>    kappa S^2 + (1 - kappa) D^2 <= (g - 1)^2   and   (1 - kappa) S^2 + kappa D^2 >= (g + 1)^2,
!>
!> where the outer joints are nearest and farthest. For a given g that is a triangle in S^2 and D^2; kappa = 0 gives the box in
!> which the crank turns.
!> A step keeps to both inequalities made linear (`slide_along`), and what their bends leave is taken off the shape (`keep_angles`),
!> so that a linkage at both limits at once can move along them.
module psalm_path_angles
   use psalm_kinds, only: wp
   use psalm_linear, only: solve_positive
   use psalm_path_fit, only: fitted_path_t, path_timing_t, unknowns, shape_g
   implicit none (type, external)
   private
   public :: limits_angle, angle_limits, keep_angles, slide_along

   real(wp), parameter :: parallel = 1.0e-12_wp      !! relative determinant below which both limits say the same
   real(wp), parameter :: most_kappa = 0.5_wp - 1.0e-9_wp !! a right angle all the time is no shape's

contains

   !> True if there is a limit.
   pure logical function limits_angle(path)
      type(fitted_path_t), intent(in) :: path

      limits_angle = path%cosine < 1.0_wp
   end function limits_angle

   pure real(wp) function kappa_of(path)
      type(fitted_path_t), intent(in) :: path

      kappa_of = min(0.5_wp*(1.0_wp - path%cosine), most_kappa)
   end function kappa_of

   !> Both inequalities: values, at most 0 where they are kept, and their derivatives by ln g, ln sigma, q.
   pure subroutine angle_limits(path, timing, values, slopes)
      type(fitted_path_t), intent(in) :: path
      type(path_timing_t), intent(in) :: timing
      real(wp), intent(out) :: values(2)             !! joints nearest, farthest; relative to (g - 1)^2 and (g + 1)^2
      real(wp), intent(out) :: slopes(3, 2)
      real(wp) :: kappa, wide, narrow, square, q2

      kappa = kappa_of(path)
      associate (g => timing%g)
         wide = ((g + 1.0_wp)/(g - 1.0_wp))**2
         narrow = 1.0_wp/wide
         square = timing%sigma**2
         q2 = timing%q**2
         values(1) = kappa*square*wide + (1.0_wp - kappa)*q2 - 1.0_wp
         slopes(:, 1) = [-4.0_wp*g*(g + 1.0_wp)/(g - 1.0_wp)**3*kappa*square, 2.0_wp*kappa*square*wide, &
                         2.0_wp*(1.0_wp - kappa)*timing%q]
         values(2) = 1.0_wp - (1.0_wp - kappa)*square - kappa*q2*narrow
         slopes(:, 2) = [-4.0_wp*g*(g - 1.0_wp)/(g + 1.0_wp)**3*kappa*q2, -2.0_wp*(1.0_wp - kappa)*square, &
                         -2.0_wp*kappa*timing%q*narrow]
      end associate
   end subroutine angle_limits

   !> The shape as near as may be that keeps both limits: ground and crank apart far enough, then sum and difference of coupler and
   !> follower.
   pure subroutine keep_angles(path, timing)
      type(fitted_path_t), intent(in) :: path
      type(path_timing_t), intent(inout) :: timing
      real(wp) :: kappa, least, near, far, x, y, x_corner, y_corner

      kappa = kappa_of(path)
      ! both limits leave a shape only if abs(g - 1)/(g + 1) is at least the tangent of mu/2
      least = sqrt(kappa/(1.0_wp - kappa))
      least = (1.0_wp + least)/(1.0_wp - least)
      if (timing%g > 1.0_wp) then
         timing%g = max(timing%g, least)
      else
         timing%g = min(timing%g, 1.0_wp/least)
      end if
      near = (timing%g - 1.0_wp)**2
      far = (timing%g + 1.0_wp)**2
      x_corner = ((1.0_wp - kappa)*far - kappa*near)/(1.0_wp - 2.0_wp*kappa)
      y_corner = max(((1.0_wp - kappa)*near - kappa*far)/(1.0_wp - 2.0_wp*kappa), 0.0_wp)
      x = far*timing%sigma**2
      y = near*timing%q**2
      if (kappa*x + (1.0_wp - kappa)*y <= near .and. (1.0_wp - kappa)*x + kappa*y >= far) return
      x = max(x, x_corner)
      y = min(y, y_corner)
      if (kappa*x + (1.0_wp - kappa)*y > near) then
         y = max((near - kappa*x)/(1.0_wp - kappa), 0.0_wp)
         x = min(x, max((near - (1.0_wp - kappa)*y)/kappa, x_corner))
      end if
      x = max(x, (far - kappa*y)/(1.0_wp - kappa))
      timing%sigma = sqrt(x/far)
      timing%q = sign(sqrt(y/near), timing%q)
   end subroutine keep_angles

   !> The least point of a quadratic under both limits made linear. `step` comes as its least point without them; what is held does
   !> not move.
   pure subroutine slide_along(path, timing, matrix, held, step, solved)
      type(fitted_path_t), intent(in) :: path
      type(path_timing_t), intent(in) :: timing
      real(wp), intent(in) :: matrix(:, :)           !! shape (unknowns, unknowns); of what is held the unit matrix
      logical, intent(in) :: held(unknowns)
      real(wp), intent(inout) :: step(unknowns)
      logical, intent(inout) :: solved
      real(wp) :: values(2), slopes(3, 2), rows(unknowns, 2), ways(unknowns, 2), products(2, 2), force(2), determinant
      logical :: valid
      integer :: k, other

      call angle_limits(path, timing, values, slopes)
      rows = 0.0_wp
      rows(shape_g:, :) = slopes
      do k = 1, 2
         where (held) rows(:, k) = 0.0_wp
         values(k) = values(k) + dot_product(rows(:, k), step)
      end do
      if (all(values <= 0.0_wp)) return
      solved = .false.
      do k = 1, 2
         call solve_positive(matrix, rows(:, k), ways(:, k), valid)
         if (.not. valid) return
      end do
      do k = 1, 2
         products(:, k) = [dot_product(rows(:, 1), ways(:, k)), dot_product(rows(:, 2), ways(:, k))]
      end do
      ! one limit alone
      do k = 1, 2
         other = 3 - k
         if (.not. (values(k) > 0.0_wp .and. products(k, k) > 0.0_wp)) cycle
         force(1) = values(k)/products(k, k)
         if (values(other) - force(1)*products(other, k) > 0.0_wp) cycle
         step = step - force(1)*ways(:, k)
         solved = .true.
         return
      end do
      determinant = products(1, 1)*products(2, 2) - products(1, 2)*products(2, 1)
      if (.not. determinant > parallel*products(1, 1)*products(2, 2)) return
      force = [products(2, 2)*values(1) - products(1, 2)*values(2), products(1, 1)*values(2) - products(2, 1)*values(1)]/determinant
      step = step - force(1)*ways(:, 1) - force(2)*ways(:, 2)
      solved = .true.
   end subroutine slide_along
end module psalm_path_angles
