!> Stresses of a vibrating link: those of bending follow from its curvature, those along it from its pull.
!>
!> The deflection is length * sum Q_j sin(j pi x), x from 0 to 1 along the link, so that the curvature is
!> -(1/length) sum (j pi)**2 Q_j sin(j pi x); an edge at the distance c from the middle has the strain c times that. The pull at x
!> is that of (13.24): of the finish, less what the mass between x and the finish needs for its acceleration, with the loads there.
module psalm_link_stress
   use psalm_kinds, only: wp, pi
   use psalm_link_vibration, only: moving_link_t
   use psalm_periodic, only: periodic_t
   implicit none (type, external)
   private
   public :: find_curvature, find_pull

contains

   !> Curvature times the length of the link: shape (positions, places); places at even steps from pin to pin.
   pure subroutine find_curvature(deflection, curvature)
      type(periodic_t), intent(in) :: deflection(:)  !! by mode: Q_j
      real(wp), intent(out) :: curvature(:, :)
      real(wp) :: q(size(curvature, 1))
      integer :: j, k

      curvature = 0.0_wp
      do j = 1, size(deflection)
         q = deflection(j)%values(size(q))*(real(j, wp)*pi)**2
         do k = 1, size(curvature, 2)
            curvature(:, k) = curvature(:, k) - q*sin(real(j, wp)*pi*place_of(k, size(curvature, 2)))
         end do
      end do
   end subroutine find_curvature

   !> Pull along the link over (mass length speed**2): shape (positions, places).
   pure subroutine find_pull(link, pull)
      type(moving_link_t), intent(in) :: link
      real(wp), intent(out) :: pull(:, :)
      real(wp), dimension(size(pull, 1)) :: tension, along, turning_squared
      real(wp) :: x
      integer :: k, n

      tension = link%tension%values(size(tension))
      along = link%along%values(size(along))
      turning_squared = link%turning_squared%values(size(turning_squared))
      do k = 1, size(pull, 2)
         x = place_of(k, size(pull, 2))
         pull(:, k) = tension - along*(1.0_wp - x) + 0.5_wp*turning_squared*(1.0_wp - x**2)
         if (.not. allocated(link%acting)) cycle
         do n = 1, size(link%acting)
            if (link%acting(n)%place > x) pull(:, k) = pull(:, k) + link%acting(n)%along%values(size(along))
         end do
      end do
   end subroutine find_pull

   !> Place k of n, from 0 to 1.
   pure real(wp) function place_of(k, n)
      integer, intent(in) :: k, n

      place_of = real(k - 1, wp)/real(n - 1, wp)
   end function place_of
end module psalm_link_stress
