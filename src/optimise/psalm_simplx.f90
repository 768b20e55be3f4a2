!> SIMPLX is the constrained simplex search of the thesis.
!>
!> Nelder and Mead's simplex with the unlimited expansion and translation of Parkinson and Hutchinson; every vertex is made to
!> obey by the problem (`settle`; of a linkage, CONSTR). Source: Oldham (1977), section 6.4.3, equations 6.17 to 6.24.
module psalm_simplx
   use psalm_kinds, only: wp
   use psalm_nlp, only: nlp_t, failure_t
   use psalm_solver, only: solver_t, ending_t, observer_t, search_state_t, stop_converged, stop_evaluations, stop_interrupted, &
                           stop_iterations, stop_refused, stop_small_objective
   use psalm_stop, only: stop_t
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: simplex_t, simplex_rules_t, simplex_solver_t, search_simplex

   integer, parameter :: most_expansions = 200     !! of one move: a factor of EXPAND**200 is no linkage any more
   ! of `minimise`
   integer, parameter :: usual_iterations = 200    !! of a simplex, for each unknown
   integer, parameter :: most_simplexes = 40       !! one after another, each round the best vertex of the one before
   integer, parameter :: most_idle = 4             !! of these in a row that gain too little end the search

   !> The simplex and its objectives.
   type :: simplex_t
      real(wp), allocatable :: v(:, :)       !! shape (n, vertices): n+1, or more as in Box's complex
      real(wp), allocatable :: f(:)          !! shape (vertices): objectives
      integer :: best = 1                    !! the best vertex
   end type simplex_t

   !> Coefficients of the moves and criteria of convergence. Reflection by the full distance is `bounce` = 2.
   type :: simplex_rules_t
      real(wp) :: bounce = 2.0_wp, expand = 2.0_wp, snake = 0.5_wp, reduce = 0.5_wp, shrink = 0.5_wp
      integer :: niter = 0                   !! iterations; 0: as many as is usual
      integer :: ncheck = 1                  !! iterations between two looks whether it has converged
      real(wp) :: fmin = -huge(1.0_wp)       !! an objective below is small enough
      real(wp) :: small = 1.0e-8_wp          !! relative size of a simplex that has converged
   end type simplex_rules_t

   !> The search as a solver: begins with a random simplex round x, and again round the best vertex until that gains nothing.
   type, extends(solver_t) :: simplex_solver_t
      type(simplex_rules_t) :: rules
      integer :: vertices = 0                !! NVERT; 0: one more than unknowns
   contains
      procedure :: minimise
   end type simplex_solver_t

contains

   !> Improve x. All unknowns are moved alike. Refused: an x that cannot be made to obey.
   subroutine minimise(self, problem, x, stop, ending, observer)
      class(simplex_solver_t), intent(inout) :: self
      class(nlp_t), intent(inout), target :: problem
      real(wp), intent(inout) :: x(:)                  !! shape (core + local)
      type(stop_t), intent(in), target :: stop
      type(ending_t), intent(out) :: ending
      class(observer_t), intent(inout), optional :: observer
      type(simplex_t) :: simplex
      type(simplex_rules_t) :: rules
      type(search_state_t) :: state
      real(wp) :: before
      real(wp) :: deviate
      type(xoshiro_t) :: random
      integer :: round, i, k, n, m, last, idle
      logical :: reached

      problem%projects = .false.
      n = size(x)
      rules = self%rules
      if (rules%niter == 0) rules%niter = usual_iterations*n
      last = huge(last)
      if (self%most_evaluations > 0) last = problem%evaluations + min(self%most_evaluations, huge(1) - problem%evaluations)
      m = max(self%vertices, n + 1)
      allocate (simplex%v(n, m), simplex%f(m))
      call problem%settle(x, ending%objective, ending%feasible)
      ending%reason = stop_refused
      if (.not. ending%feasible) return
      call random%seed(self%seed, purpose_starts)
      idle = 0
      do round = 1, most_simplexes
         before = ending%objective
         simplex%v = spread(x, 2, m)
         simplex%f(1) = ending%objective
         associate (scales => problem%scales(x))
            do i = 1, m - 1
               do k = 1, n
                  call random%next(deviate)
                  simplex%v(k, i + 1) = x(k) + scales(k)*(2.0_wp*deviate - 1.0_wp)
               end do
               call problem%settle(simplex%v(:, i + 1), simplex%f(i + 1), reached, towards=x)
            end do
         end associate
         call search_simplex(rules, problem, simplex, stop, state, observer, last)
         x = simplex%v(:, simplex%best)
         ending%objective = simplex%f(simplex%best)
         ending%reason = state%reason
         if (all(state%reason /= [stop_converged, stop_iterations])) return
         idle = merge(idle + 1, 0, before - ending%objective <= self%least_gain*abs(before))
         if (idle >= most_idle) return
      end do
   end subroutine minimise

   !> Improve the simplex until one of the criteria of convergence is met. On return `simplex%best` is the result.
   subroutine search_simplex(rules, problem, simplex, stop, state, observer, last, made, start)
      type(simplex_rules_t), intent(in) :: rules
      class(nlp_t), intent(inout) :: problem
      type(simplex_t), intent(inout) :: simplex
      type(stop_t), intent(in) :: stop                !! asked after every iteration
      type(search_state_t), intent(out) :: state
      class(observer_t), intent(inout), optional :: observer
      integer, intent(in), optional :: last            !! evaluation to stop at
      integer, intent(in), optional :: made            !! iterations made before, which count
      integer, intent(in), optional :: start           !! number of this simplex; default 1
      integer :: worst

      state%limit = rules%niter
      if (present(made)) state%iteration = made
      if (present(start)) state%start = start
      do
         worst = maxloc(simplex%f, dim=1)
         simplex%best = minloc(simplex%f, dim=1)
         state%best = simplex%f(simplex%best)
         state%worst = simplex%f(worst)
         state%evaluations = problem%evaluations
         state%counts = problem%counts
         if (present(observer)) call observer%report(state, simplex%v, simplex%f)
         if (allocated(problem%counts%failures)) problem%counts%failures = failure_t()
         if (mod(state%iteration, rules%ncheck) == 0) then
            if (state%best < rules%fmin) then
               state%reason = stop_small_objective
            else if (has_converged(simplex, worst, rules%small)) then
               state%reason = stop_converged
            end if
         end if
         if (state%reason == 0 .and. state%iteration >= rules%niter) state%reason = stop_iterations
         if (state%reason == 0 .and. present(last)) then
            if (problem%evaluations >= last) state%reason = stop_evaluations
         end if
         if (state%reason == 0) then
            if (stop%waiting()) state%reason = stop_interrupted
         end if
         if (state%reason /= 0) return
         state%iteration = state%iteration + 1
         call iterate(rules, problem, simplex)
      end do
   end subroutine search_simplex

   !> One iteration: reflection, then expansion and translation, contraction or shrinkage.
   subroutine iterate(rules, problem, simplex)
      type(simplex_rules_t), intent(in) :: rules
      class(nlp_t), intent(inout) :: problem
      type(simplex_t), intent(inout) :: simplex
      real(wp) :: centroid(size(simplex%v, 1)), trial(size(simplex%v, 1)), lowest(size(simplex%v, 1))
      real(wp) :: f_trial, f_lowest, f_second
      integer :: worst, i, n
      logical :: feasible

      n = size(simplex%f)
      worst = maxloc(simplex%f, dim=1)
      simplex%best = minloc(simplex%f, dim=1)
      f_second = maxval(simplex%f, mask=[(i /= worst, i=1, n)])
      centroid = (sum(simplex%v, dim=2) - simplex%v(:, worst))/real(n - 1, wp)
      trial = rules%bounce*centroid + (1.0_wp - rules%bounce)*simplex%v(:, worst)
      call settle(trial, f_trial)
      if (f_trial < simplex%f(simplex%best)) then
         lowest = trial
         f_lowest = f_trial
         do i = 1, most_expansions
            trial = rules%expand*lowest + (1.0_wp - rules%expand)*centroid
            call problem%settle(trial, f_trial, feasible)
            if (.not. feasible) exit
            if (f_trial >= f_lowest) exit
            lowest = trial
            f_lowest = f_trial
         end do
         if (f_lowest > rules%snake*simplex%f(simplex%best)) then
            call replace(lowest, f_lowest)
         else
            call translate()
         end if
      else if (f_trial < f_second) then
         call replace(trial, f_trial)
      else
         if (f_trial < simplex%f(worst)) then
            trial = (1.0_wp - rules%reduce)*centroid + rules%reduce*trial
         else
            trial = (1.0_wp - rules%reduce)*centroid + rules%reduce*simplex%v(:, worst)
         end if
         call settle(trial, f_trial)
         if (f_trial < simplex%f(worst)) then
            call replace(trial, f_trial)
         else
            call shrink()
         end if
      end if
      simplex%best = minloc(simplex%f, dim=1)

   contains

      !> The point a conflicting vertex moves towards: the centroid if it obeys, else the best vertex.
      function safe_haven() result(place)
         real(wp) :: place(size(centroid))
         real(wp) :: f
         logical :: obeys

         place = centroid
         call problem%accept(place, f, obeys)
         if (.not. obeys) place = simplex%v(:, simplex%best)
      end function safe_haven

      !> Make a vertex obey; where its demands conflict it moves towards `towards`, or else towards a safe haven.
      subroutine settle(values, f, towards)
         real(wp), intent(inout) :: values(:)
         real(wp), intent(out) :: f
         real(wp), intent(in), optional :: towards(:)
         logical :: reached

         if (present(towards)) then
            call problem%settle(values, f, reached, towards)
         else
            call problem%settle(values, f, reached)
            if (.not. reached) call problem%settle(values, f, reached, safe_haven())
         end if
         if (.not. reached) f = huge(f)
      end subroutine settle

      subroutine replace(values, f)
         real(wp), intent(in) :: values(:), f

         simplex%v(:, worst) = values
         simplex%f(worst) = f
      end subroutine replace

      !> The whole simplex makes the move of its worst vertex.
      subroutine translate()
         real(wp) :: move(size(centroid))
         integer :: k

         move = lowest - simplex%v(:, worst)
         do k = 1, n
            if (k == worst) cycle
            simplex%v(:, k) = simplex%v(:, k) + move
            call settle(simplex%v(:, k), simplex%f(k), lowest)
         end do
         call replace(lowest, f_lowest)
      end subroutine translate

      !> All vertices draw near the best.
      subroutine shrink()
         integer :: k

         do k = 1, n
            if (k == simplex%best) cycle
            simplex%v(:, k) = rules%shrink*simplex%v(:, k) + (1.0_wp - rules%shrink)*simplex%v(:, simplex%best)
            call settle(simplex%v(:, k), simplex%f(k), simplex%v(:, simplex%best))
         end do
      end subroutine shrink
   end subroutine iterate

   !> Criterion (iii): objectives and coordinates of the worst and the best vertex agree.
   pure logical function has_converged(simplex, worst, small)
      type(simplex_t), intent(in) :: simplex
      integer, intent(in) :: worst
      real(wp), intent(in) :: small

      associate (b => simplex%v(:, simplex%best), w => simplex%v(:, worst), f => simplex%f)
         has_converged = f(worst) - f(simplex%best) <= small*abs(f(simplex%best))
         if (has_converged) has_converged = all(abs(w - b) <= small*abs(b) .or. abs(b) <= small)
      end associate
   end function has_converged
end module psalm_simplx
