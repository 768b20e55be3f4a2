!> What every solver offers: minimise a problem from x, until it converges or must end.
!>
!> A search tells how it goes to an observer; it forms no text and touches no signal. `psalm_solvers` makes solvers by name.
module psalm_solver
   use psalm_kinds, only: wp
   use psalm_nlp, only: nlp_t, repair_count_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: solver_t, ending_t, observer_t, search_state_t
   public :: stop_iterations, stop_small_objective, stop_converged, stop_interrupted, stop_evaluations, stop_refused

   ! why a search ended; 0: it goes on
   integer, parameter :: stop_iterations = 1       !! as many iterations as it was given
   integer, parameter :: stop_small_objective = 2  !! the best objective is small enough
   integer, parameter :: stop_converged = 3        !! nothing is to be gained any more
   integer, parameter :: stop_interrupted = 4      !! the time is up, or somebody asked for an end
   integer, parameter :: stop_evaluations = 5      !! as many evaluations as it was given
   integer, parameter :: stop_refused = 6          !! the solver cannot work on this problem

   !> Where a search stands.
   type :: search_state_t
      integer :: start = 1              !! number of the simplex, of several
      integer :: iteration = 0          !! iterations, or starts, made
      integer :: limit = 0              !! at most so many will be
      integer :: evaluations = 0
      real(wp) :: best = 0.0_wp         !! objectives
      real(wp) :: worst = 0.0_wp
      integer :: reason = 0             !! one of `stop_...` when the search is over
      type(repair_count_t) :: counts    !! what was done to points to make them obey
   end type search_state_t

   !> Watches a search: shows progress, writes a log.
   type, abstract :: observer_t
   contains
      procedure(report_i), deferred :: report
   end type observer_t

   !> How a search ended.
   type :: ending_t
      real(wp) :: objective = huge(1.0_wp)
      logical :: feasible = .false.     !! x obeys every constraint at the places looked at
      integer :: reason = 0             !! one of `stop_...`
   end type ending_t

   type, abstract :: solver_t
      integer :: most_evaluations = 0   !! of one call; 0: as many as is usual
      real(wp) :: least_gain = 1.0e-9_wp !! relative gain of a step below which it is one of the last
      logical :: hasty = .false.        !! where violations are weighed: the first weight is not followed to the end
      integer :: seed = 1               !! of algorithms that draw random numbers
   contains
      procedure(minimise_i), deferred :: minimise
   end type solver_t

   abstract interface
      !> Called after every iteration; a search that has points shows them.
      subroutine report_i(self, state, points, objectives)
         import :: observer_t, search_state_t, wp
         implicit none (type, external)
         class(observer_t), intent(inout) :: self
         type(search_state_t), intent(in) :: state
         real(wp), intent(in), optional :: points(:, :)   !! shape (unknowns, points)
         real(wp), intent(in), optional :: objectives(:)  !! shape (points)
      end subroutine report_i

      !> Improve x.
      subroutine minimise_i(self, problem, x, stop, ending, observer)
         import :: solver_t, nlp_t, stop_t, ending_t, observer_t, wp
         implicit none (type, external)
         class(solver_t), intent(inout) :: self
         class(nlp_t), intent(inout), target :: problem
         real(wp), intent(inout) :: x(:)                  !! shape (core + local)
         type(stop_t), intent(in), target :: stop        !! asked now and then
         type(ending_t), intent(out) :: ending
         class(observer_t), intent(inout), optional :: observer
      end subroutine minimise_i
   end interface
end module psalm_solver
