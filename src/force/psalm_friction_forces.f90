!> Friction of joints that slip, where it grows with loads that contain friction.
!>
!> The load of a joint is the length of a vector (a pin) or the sum of two sizes (a slide), whose parts are linear in the friction
!> of all joints. Where that grows little, one finds it by turns; here it is followed from no friction to all of it by Newton's
!> method, as far as the equations keep their sense: where their determinant passes 0 the joint jams (Painleve).
module psalm_friction_forces
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   use psalm_linear, only: eliminate_real
   implicit none (type, external)
   private
   public :: find_friction, load_of_joint

   integer, parameter :: most_steps = 30                   !! of Newton's method
   real(wp), parameter :: shortest = 1.0e-6_wp             !! part of all friction by which it is not followed any farther
   real(wp), parameter :: settled = 4.0_wp*epsilon(1.0_wp) !! part of the largest friction: a change that is none
   real(wp), parameter :: rounded = 1.0e-11_wp             !! and one that may be rounding, if it grows

contains

   !> What friction is a part of, from the parts that make it.
   pure real(wp) function load_of_joint(part, slides) result(load)
      real(wp), intent(in) :: part(2)
      logical, intent(in) :: slides

      if (slides) then
         load = abs(part(1)) + abs(part(2))
      else
         load = hypotenuse(part(1), part(2))
      end if
   end function load_of_joint

   !> Forces of friction, each `coefficient` times the load of its joint and `grip`. `found` is false where there is none that
   !> continues what there is with less friction.
   pure subroutine find_friction(fixed, by_force, slides, coefficient, grip, force, found)
      real(wp), intent(in) :: fixed(:, :)       !! shape (2, joints): parts of the loads without friction
      real(wp), intent(in) :: by_force(:, :, :) !! shape (2, joints, joints): by friction 1 of the last
      logical, intent(in) :: slides(:)          !! by joint
      real(wp), intent(in) :: coefficient(:)    !! by joint: negative against the sense in which forces count
      real(wp), intent(in) :: grip(:)           !! by joint: friction besides, likewise
      real(wp), intent(out) :: force(:)
      logical, intent(out) :: found
      real(wp) :: tried(size(force)), share, step, next

      force = 0.0_wp
      share = 0.0_wp
      step = 1.0_wp
      do
         next = min(1.0_wp, share + step)
         if (share > 0.0_wp) then
            tried = force*(next/share)
         else
            tried = 0.0_wp
         end if
         call improve(fixed, by_force, slides, next*coefficient, next*grip, tried, found)
         if (found) then
            force = tried
            share = next
            if (.not. share < 1.0_wp) return
            step = 2.0_wp*step
         else
            step = 0.5_wp*step
            if (step < shortest) return
         end if
      end do
   end subroutine find_friction

   !> Newton's method from an estimate.
   pure subroutine improve(fixed, by_force, slides, coefficient, grip, force, found)
      real(wp), intent(in) :: fixed(:, :), by_force(:, :, :), coefficient(:), grip(:)
      logical, intent(in) :: slides(:)
      real(wp), intent(inout) :: force(:)
      logical, intent(out) :: found
      real(wp), dimension(size(force), size(force)) :: matrix
      real(wp) :: missing(size(force), 1), part(2), along(2), load, determinant, change, change_before
      integer :: round, j, k, n

      n = size(force)
      found = .false.
      change_before = huge(change)
      do round = 1, most_steps
         do k = 1, n
            part = fixed(:, k)
            do j = 1, n
               part = part + by_force(:, k, j)*force(j)
            end do
            load = load_of_joint(part, slides(k))
            along = 0.0_wp
            if (slides(k)) then
               along = sign(1.0_wp, part)
            else if (load > 0.0_wp) then
               along = part/load
            end if
            do j = 1, n
               matrix(k, j) = -coefficient(k)*(along(1)*by_force(1, k, j) + along(2)*by_force(2, k, j))
            end do
            matrix(k, k) = matrix(k, k) + 1.0_wp
            missing(k, 1) = coefficient(k)*load + grip(k) - force(k)
         end do
         call eliminate_real(n, 1, matrix, missing, determinant)
         if (.not. determinant > 0.0_wp) return
         force = force + missing(:, 1)
         change = maxval(abs(missing))
         if (.not. change < huge(change)) return
         associate (largest => maxval(abs(force)))
            found = change <= settled*largest .or. (change <= rounded*largest .and. change >= change_before)
         end associate
         if (found) return
         change_before = change
      end do
   end subroutine improve
end module psalm_friction_forces
