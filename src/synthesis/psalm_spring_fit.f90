!> Springs whose load has the least RMS: least squares over the places of their ends, stiffness and free length.
module psalm_spring_fit
   use psalm_kinds, only: wp
   use psalm_least_squares, only: least_squares_t
   use psalm_nlp, only: plain_nlp_t
   use psalm_solver, only: ending_t
   use psalm_spring_load, only: spring_limits_t, found_spring_t, load_with, criterion_of, add_slopes, criterion_spread, &
                                stiffest_in
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: fit_springs

   integer, parameter :: each = 6                  !! unknowns of a spring: x, y of either end in reaches, S, L
   real(wp), parameter :: least_gain = 1.0e-11_wp  !! relative gain of a step that is one of the last: valleys are flat
   real(wp), parameter :: held = 0.0_wp            !! of unknowns that are given

   type, extends(plain_nlp_t) :: fit_t
      type(spring_limits_t), allocatable :: allowed(:)
      real(wp), allocatable :: bare(:, :)          !! shape (positions, components)
      real(wp), allocatable :: stiff(:)            !! N/m: unit of S
      real(wp), allocatable :: length(:)           !! m: unit of L
      real(wp) :: unit = 1.0_wp                    !! N or N m: of the load
      logical :: spread = .false.                  !! differences from the mean
   contains
      procedure :: residuals_at
      procedure :: constraints_at
   end type fit_t

contains

   !> Improve springs; `value` is the criterion at the end: `criterion_rms` or `criterion_spread`.
   subroutine fit_springs(bare, allowed, criterion, springs, value, stop)
      real(wp), intent(in) :: bare(:, :)           !! shape (positions, components): the load without these springs
      type(spring_limits_t), intent(in) :: allowed(:)
      integer, intent(in) :: criterion
      type(found_spring_t), intent(inout) :: springs(:)
      real(wp), intent(out) :: value
      type(stop_t), intent(in), optional :: stop   !! asked in every iteration: the best so far is there
      class(fit_t), allocatable :: problem
      type(least_squares_t) :: solver
      type(ending_t) :: ending
      type(stop_t) :: host
      real(wp), allocatable :: x(:)
      real(wp) :: slopes(size(bare, 1), size(bare, 2), each), limit
      integer :: k, e, first

      allocate (problem)
      problem%allowed = allowed
      problem%bare = bare
      problem%spread = criterion == criterion_spread
      problem%unit = max(criterion_of(criterion, bare), tiny(1.0_wp)**0.25_wp)
      problem%core = each*size(allowed)
      problem%residuals = size(bare)
      problem%inequalities = 2*size(allowed)
      problem%is_sum_of_squares = .true.
      problem%has_gradient = .true.
      allocate (problem%low(problem%core), problem%high(problem%core), x(problem%core), problem%stiff(size(allowed)), &
                problem%length(size(allowed)))
      do k = 1, size(allowed)
         first = each*(k - 1)
         associate (allowed => allowed(k))
            do e = 1, 2
               x(first + 2*e - 1:first + 2*e) = held
               problem%low(first + 2*e - 1:first + 2*e) = merge(-1.0_wp, held, allowed%reach(e) > 0.0_wp)
               problem%high(first + 2*e - 1:first + 2*e) = merge(1.0_wp, held, allowed%reach(e) > 0.0_wp)
               if (allowed%reach(e) > 0.0_wp) x(first + 2*e - 1:first + 2*e) = springs(k)%at(:, e)/allowed%reach(e)
            end do
            call add_slopes(allowed, springs(k), slopes)
            problem%stiff(k) = problem%unit/max(maxval(abs(slopes(:, :, 5))), tiny(1.0_wp)/epsilon(1.0_wp))
            problem%length(k) = max(maxval(allowed%reach), maxval(abs(allowed%free)))
            if (.not. problem%length(k) > 0.0_wp) problem%length(k) = 1.0_wp
            limit = stiffest_in(allowed, bare)/problem%stiff(k)
            problem%low(first + 5:first + 6) = [0.0_wp, allowed%free(1)/problem%length(k)]
            problem%high(first + 5:first + 6) = [limit, allowed%free(2)/problem%length(k)]
            x(first + 5:first + 6) = [springs(k)%stiffness/problem%stiff(k), springs(k)%free/problem%length(k)]
         end associate
      end do
      solver%least_gain = least_gain
      if (present(stop)) host = stop
      call solver%minimise(problem, x, host, ending)
      do k = 1, size(allowed)
         call take(problem, x, k, springs(k))
      end do
      value = criterion_of(criterion, load_with(bare, allowed, springs))
   end subroutine fit_springs

   !> Spring k of the unknowns; ends within their reach. Given ends stay as they are.
   pure subroutine take(problem, x, k, spring)
      class(fit_t), intent(in) :: problem
      real(wp), intent(in) :: x(:)
      integer, intent(in) :: k
      type(found_spring_t), intent(inout) :: spring
      integer :: e, first

      first = each*(k - 1)
      do e = 1, 2
         associate (at => x(first + 2*e - 1:first + 2*e), reach => problem%allowed(k)%reach(e))
            if (reach > 0.0_wp) spring%at(:, e) = reach*at/max(1.0_wp, norm2(at))
         end associate
      end do
      spring%stiffness = problem%stiff(k)*x(first + 5)
      spring%free = problem%length(k)*x(first + 6)
   end subroutine take

   !> Loads in units, without their mean where `spread` says so.
   subroutine residuals_at(self, x, r, jacobian)
      class(fit_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: r(:)
      real(wp), intent(out), optional :: jacobian(:, :)
      type(found_spring_t) :: springs(size(self%allowed))
      real(wp) :: slopes(size(self%bare, 1), size(self%bare, 2), each), per
      integer :: k, e, first

      do k = 1, size(springs)
         call put(self, x, k, springs(k))
      end do
      per = 1.0_wp/(self%unit*sqrt(real(size(self%bare), wp)))
      r = per*reshape(load_with(self%bare, self%allowed, springs), [size(r)])
      if (self%spread) r = r - sum(r)/real(size(r), wp)
      if (.not. present(jacobian)) return
      do k = 1, size(springs)
         first = each*(k - 1)
         call add_slopes(self%allowed(k), springs(k), slopes)
         slopes(:, :, 1:2) = slopes(:, :, 1:2)*self%allowed(k)%reach(1)
         slopes(:, :, 3:4) = slopes(:, :, 3:4)*self%allowed(k)%reach(2)
         slopes(:, :, 5) = (slopes(:, :, 5) + springs(k)%free*slopes(:, :, 6))*self%stiff(k)
         slopes(:, :, 6) = slopes(:, :, 6)*springs(k)%stiffness*self%length(k)
         do e = 1, each
            jacobian(:, first + e) = per*reshape(slopes(:, :, e), [size(r)])
            if (self%spread) jacobian(:, first + e) = jacobian(:, first + e) - sum(jacobian(:, first + e))/real(size(r), wp)
         end do
      end do

   contains

      !> As `take`, but ends may pass their reach on the way.
      pure subroutine put(problem, x, k, spring)
         class(fit_t), intent(in) :: problem
         real(wp), intent(in) :: x(:)
         integer, intent(in) :: k
         type(found_spring_t), intent(out) :: spring
         integer :: e

         do e = 1, 2
            spring%at(:, e) = problem%allowed(k)%reach(e)*x(each*(k - 1) + 2*e - 1:each*(k - 1) + 2*e)
         end do
         spring%stiffness = problem%stiff(k)*x(each*(k - 1) + 5)
         spring%free = problem%length(k)*x(each*(k - 1) + 6)
      end subroutine put
   end subroutine residuals_at

   !> Ends stay within their reach.
   subroutine constraints_at(self, x, c, slopes)
      class(fit_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: c(:)
      real(wp), intent(out), optional :: slopes(:, :)
      integer :: k

      if (present(slopes)) slopes = 0.0_wp
      do k = 1, size(c)
         associate (first => each*((k - 1)/2) + 2*modulo(k - 1, 2) + 1)
            c(k) = sum(x(first:first + 1)**2) - 1.0_wp
            if (present(slopes)) slopes(first:first + 1, k) = 2.0_wp*x(first:first + 1)
         end associate
      end do
      associate (unused => self)
      end associate
   end subroutine constraints_at
end module psalm_spring_fit
