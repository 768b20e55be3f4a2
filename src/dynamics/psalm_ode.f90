!> Ordinary differential equations of two unknowns by Dormand and Prince's formulas of fifth order with their error of the fourth.
module psalm_ode
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: ode_t, one_step, advance, next_step

   real(wp), parameter :: shrink = 0.2_wp, grow = 4.0_wp, safety = 0.9_wp !! of steps

   !> An equation.
   type, abstract :: ode_t
   contains
      procedure(rates_of), deferred :: rates
   end type ode_t

   abstract interface
      !> Derivatives of both unknowns.
      pure function rates_of(self, time, y) result(d)
         import :: ode_t, wp
         implicit none (type, external)
         class(ode_t), intent(in) :: self
         real(wp), intent(in) :: time, y(2)
         real(wp) :: d(2)
      end function rates_of
   end interface

contains

   !> One step of length h; `error` is the largest difference of both formulas.
   pure subroutine one_step(ode, time, y, h, after, error)
      class(ode_t), intent(in) :: ode
      real(wp), intent(in) :: time, y(2), h
      real(wp), intent(out) :: after(2), error
      real(wp), dimension(2) :: k1, k2, k3, k4, k5, k6, k7

      k1 = ode%rates(time, y)
      k2 = ode%rates(time + h/5.0_wp, y + h*k1/5.0_wp)
      k3 = ode%rates(time + 0.3_wp*h, y + h*(3.0_wp*k1 + 9.0_wp*k2)/40.0_wp)
      k4 = ode%rates(time + 0.8_wp*h, y + h*(44.0_wp/45.0_wp*k1 - 56.0_wp/15.0_wp*k2 + 32.0_wp/9.0_wp*k3))
      k5 = ode%rates(time + 8.0_wp/9.0_wp*h, y + h*(19372.0_wp/6561.0_wp*k1 - 25360.0_wp/2187.0_wp*k2 &
                                                    + 64448.0_wp/6561.0_wp*k3 - 212.0_wp/729.0_wp*k4))
      k6 = ode%rates(time + h, y + h*(9017.0_wp/3168.0_wp*k1 - 355.0_wp/33.0_wp*k2 + 46732.0_wp/5247.0_wp*k3 &
                                      + 49.0_wp/176.0_wp*k4 - 5103.0_wp/18656.0_wp*k5))
      after = y + h*(35.0_wp/384.0_wp*k1 + 500.0_wp/1113.0_wp*k3 + 125.0_wp/192.0_wp*k4 - 2187.0_wp/6784.0_wp*k5 &
                     + 11.0_wp/84.0_wp*k6)
      k7 = ode%rates(time + h, after)
      error = maxval(abs(h*(71.0_wp/57600.0_wp*k1 - 71.0_wp/16695.0_wp*k3 + 71.0_wp/1920.0_wp*k4 &
                            - 17253.0_wp/339200.0_wp*k5 + 22.0_wp/525.0_wp*k6 - k7/40.0_wp)))
   end subroutine one_step

   !> A step that keeps the tolerance, not longer than `wanted`; it may miss the tolerance where it would be below `shortest`.
   pure subroutine advance(ode, time, y, wanted, tolerance, shortest, after, h, error)
      class(ode_t), intent(in) :: ode
      real(wp), intent(in) :: time, y(2), wanted, tolerance, shortest
      real(wp), intent(out) :: after(2), h, error

      h = wanted
      do
         call one_step(ode, time, y, h, after, error)
         if (error <= tolerance .or. h <= shortest) return
         h = h*max(shrink, safety*(tolerance/error)**0.2_wp)
      end do
   end subroutine advance

   !> Length of the step after one of length h with this error.
   pure real(wp) function next_step(h, error, tolerance)
      real(wp), intent(in) :: h, error, tolerance

      next_step = h*min(grow, max(shrink, safety*(tolerance/max(error, tiny(error)))**0.2_wp))
   end function next_step
end module psalm_ode
