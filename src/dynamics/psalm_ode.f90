!> Ordinary differential equations of any number of unknowns by an explicit method of order 8.
!>
!> A step ends exactly where it is wanted: an event is met by repeating the step with another length, without interpolation. The
!> roots that lengths of steps take are square roots, whose bits are the same on every processor. Coefficients and estimate of the
!> error: `psalm_dormand_prince`.
module psalm_ode
   use psalm_dormand_prince, only: stages, nodes, weights, stage_weights, error_fifth, error_third
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: ode_t, smooth_ode_t, one_step, advance, next_step

   real(wp), parameter :: shrink = 0.2_wp, grow = 4.0_wp, safety = 0.9_wp !! of steps
   real(wp), parameter :: third_part = 0.01_wp     !! of the error of third order in the estimate (Hairer and others, II.10)

   !> An equation.
   type, abstract :: ode_t
      real(wp) :: tolerance = 0.0_wp               !! of a step, where `tolerances` is not another procedure: absolute
   contains
      procedure(rates_of), deferred :: rates
      procedure :: tolerances
   end type ode_t

   !> An equation that has derivatives everywhere.
   type, abstract, extends(ode_t) :: smooth_ode_t
   contains
      procedure :: rates => rates_everywhere
      procedure(slopes_of), deferred :: slopes
   end type smooth_ode_t

   abstract interface
      !> Derivatives of all unknowns. `valid` is false where there are none: a step that comes there is not made.
      subroutine rates_of(self, time, y, d, valid)
         import :: ode_t, wp
         implicit none (type, external)
         class(ode_t), intent(inout) :: self
         real(wp), intent(in) :: time, y(:)
         real(wp), intent(out) :: d(:)
         logical, intent(out) :: valid
      end subroutine rates_of

      !> Derivatives of all unknowns.
      pure function slopes_of(self, time, y) result(d)
         import :: smooth_ode_t, wp
         implicit none (type, external)
         class(smooth_ode_t), intent(in) :: self
         real(wp), intent(in) :: time, y(:)
         real(wp) :: d(size(y))
      end function slopes_of
   end interface

contains

   !> Errors of the unknowns that are allowed in a step from y to `after`; huge: any.
   pure function tolerances(self, y, after) result(allowed)
      class(ode_t), intent(in) :: self
      real(wp), intent(in) :: y(:), after(:)
      real(wp) :: allowed(size(y))

      associate (unused => after)
      end associate
      allowed = self%tolerance
   end function tolerances

   subroutine rates_everywhere(self, time, y, d, valid)
      class(smooth_ode_t), intent(inout) :: self
      real(wp), intent(in) :: time, y(:)
      real(wp), intent(out) :: d(:)
      logical, intent(out) :: valid

      d = self%slopes(time, y)
      valid = .true.
   end subroutine rates_everywhere

   !> One step of length h; `error` is the estimated one in parts of what is allowed, huge where a stage has no derivatives.
   subroutine one_step(ode, time, y, h, after, error, first, last)
      class(ode_t), intent(inout) :: ode
      real(wp), intent(in) :: time, y(:), h
      real(wp), intent(out) :: after(:)
      real(wp), intent(out), optional :: error
      real(wp), intent(in), optional :: first(:)   !! derivatives at the beginning, if they are known
      real(wp), intent(out), optional :: last(:, :) !! shape (unknowns, 2): the last stage, which is at the end, its derivatives
      real(wp) :: d(size(y), stages), fifth, third, allowed(size(y)), state(size(y))
      logical :: valid
      integer :: s, j, k

      if (present(error)) error = huge(1.0_wp)
      if (present(last)) last = 0.0_wp
      after = y
      if (present(first)) then
         d(:, 1) = first
      else
         call ode%rates(time, y, d(:, 1), valid)
         if (.not. valid) return
      end if
      do s = 2, stages
         state = 0.0_wp
         do j = 1, s - 1
            if (abs(stage_weights(j, s)) > 0.0_wp) state = state + stage_weights(j, s)*d(:, j)
         end do
         call ode%rates(time + nodes(s)*h, y + h*state, d(:, s), valid)
         if (.not. valid) return
      end do
      if (present(last)) then
         last(:, 1) = y + h*state
         last(:, 2) = d(:, stages)
      end if
      state = 0.0_wp
      do j = 1, stages
         if (abs(weights(j)) > 0.0_wp) state = state + weights(j)*d(:, j)
      end do
      after = y + h*state
      if (.not. present(error)) return
      allowed = ode%tolerances(y, after)
      fifth = 0.0_wp
      third = 0.0_wp
      do k = 1, size(y)
         if (allowed(k) >= huge(1.0_wp)) cycle
         fifth = max(fifth, abs(dot_product(d(k, :), error_fifth))/allowed(k))
         third = max(third, abs(dot_product(d(k, :), error_third))/allowed(k))
      end do
      error = 0.0_wp
      ! below it squares of both may be nothing
      if (fifth > epsilon(1.0_wp)**2) error = abs(h)*fifth**2/sqrt(fifth**2 + third_part*third**2)
   end subroutine one_step

   !> A step that keeps the tolerance, not longer than `wanted`; it may miss the tolerance where it would be below `shortest`.
   subroutine advance(ode, time, y, wanted, shortest, after, h, error, first, last)
      class(ode_t), intent(inout) :: ode
      real(wp), intent(in) :: time, y(:), wanted, shortest
      real(wp), intent(out) :: after(:), h, error
      real(wp), intent(in), optional :: first(:)   !! derivatives at the beginning, if they are known
      real(wp), intent(out), optional :: last(:, :) !! as `one_step` has it

      h = wanted
      do
         call one_step(ode, time, y, h, after, error, first, last)
         if (error <= 1.0_wp .or. h <= shortest) return
         h = h*max(shrink, min(safety, safety/eighth_root(error)))
      end do
   end subroutine advance

   !> Length of the step after one of length h with this error.
   pure real(wp) function next_step(h, error)
      real(wp), intent(in) :: h, error

      next_step = h*min(grow, max(shrink, safety/eighth_root(max(error, epsilon(error)**2))))
   end function next_step

   pure real(wp) function eighth_root(x)
      real(wp), intent(in) :: x

      eighth_root = sqrt(sqrt(sqrt(x)))
   end function eighth_root
end module psalm_ode
