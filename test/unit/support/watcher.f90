!> An observer that remembers what is reported to it, for the tests of the solvers; a problem that is nothing but a function.
module watcher
   use psalm_kinds, only: wp
   use psalm_nlp, only: nlp_t
   use psalm_solver, only: observer_t, search_state_t
   implicit none (type, external)
   private
   public :: watcher_t, bare_t, bare

   type, extends(observer_t) :: watcher_t
      integer :: reports = 0
      logical :: in_order = .true.       !! evaluations only grew
      type(search_state_t) :: last
   contains
      procedure :: report
   end type watcher_t

   !> (x1 - 1)^2 + 10 (x2 - 2)^2 for x1 <= 3: no gradient, no squares, no constraints but the bound.
   type, extends(nlp_t) :: bare_t
   contains
      procedure :: measure
      procedure :: accept
   end type bare_t

contains

   subroutine report(self, state, points, objectives)
      class(watcher_t), intent(inout) :: self
      type(search_state_t), intent(in) :: state
      real(wp), intent(in), optional :: points(:, :), objectives(:)

      if (present(points) .neqv. present(objectives)) self%in_order = .false.
      if (state%evaluations < self%last%evaluations) self%in_order = .false.
      self%reports = self%reports + 1
      self%last = state
   end subroutine report

   type(bare_t) function bare() result(problem)
      problem%core = 2
      problem%low = [-10.0_wp, -10.0_wp]
      problem%high = [3.0_wp, 10.0_wp]
      problem%scale = [0.5_wp, 0.25_wp]
   end function bare

   subroutine measure(self, x, objective, violation)
      class(bare_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective, violation

      self%evaluations = self%evaluations + 1
      objective = (x(1) - 1.0_wp)**2 + 10.0_wp*(x(2) - 2.0_wp)**2
      violation = 0.0_wp
   end subroutine measure

   subroutine accept(self, x, objective, feasible)
      class(bare_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      real(wp) :: violation

      call self%measure(x, objective, violation)
      feasible = violation <= 0.0_wp .and. all(x >= self%low .and. x <= self%high)
   end subroutine accept
end module watcher
