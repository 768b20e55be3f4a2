!> An oscillator for the tests of differential equations.
module swing
   use psalm_kinds, only: wp
   use psalm_ode, only: ode_t
   implicit none (type, external)
   private
   public :: swing_t

   !> y'' = -y, and the time as a third unknown that may have any error.
   type, extends(ode_t) :: swing_t
      real(wp) :: allowed = 1.0e-13_wp
      real(wp) :: wall = huge(1.0_wp)                !! no derivatives beyond it
      integer :: evaluations = 0
   contains
      procedure :: rates
      procedure :: tolerances
   end type swing_t

contains

   subroutine rates(self, time, y, d, valid)
      class(swing_t), intent(inout) :: self
      real(wp), intent(in) :: time, y(:)
      real(wp), intent(out) :: d(:)
      logical, intent(out) :: valid

      self%evaluations = self%evaluations + 1
      d = [y(2), -y(1), 1.0_wp]
      valid = time <= self%wall
   end subroutine rates

   pure function tolerances(self, y, after) result(allowed)
      class(swing_t), intent(in) :: self
      real(wp), intent(in) :: y(:), after(:)
      real(wp) :: allowed(size(y))

      allowed = self%allowed*max(1.0_wp, abs(y), abs(after))
      allowed(3) = huge(1.0_wp)
   end function tolerances
end module swing
