!> The search by the simplex of the thesis: one simplex, or several from several random integers, the linkages on their way kept.
!>
!> Oldham (1977), section 9.1.4: several linkages for one application come of the vertices that are listed every NPRINT iterations,
!> and of initial simplexes from other random integers. Here both are ranked as what other searches find.
module psalm_simplex_search
   use psalm_constr, only: vertex_problem_t, make_vertex_problem, without_rates
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_few_positions, only: stage_sizes, positions_of_stage, take_positions
   use psalm_kinds, only: wp, i8
   use psalm_multistart, only: candidate_t, multistart_t, starter_t
   use psalm_search, only: result_t, start_record_t, distance_of, lengths_among, tell_apart
   use psalm_search_group, only: pareto_none
   use psalm_simplx, only: simplex_t, simplex_rules_t, search_simplex
   use psalm_solver, only: observer_t, search_state_t, stop_converged, stop_small_objective
   use psalm_start, only: beginning_t, rules_of, start_simplex
   use psalm_stop, only: stop_t
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: simplex_run_t, run_simplex, run_simplexes, wants_several

   real(wp), parameter :: near = 1.0e-2_wp           !! relative size of a simplex that goes on to more positions
   integer, parameter :: most_odd = 499999999        !! odd random integers of nine digits, as ISTART has
   integer, parameter :: most_weighed = 100          !! linkages that a list of PARETO is chosen from, at least

   !> One simplex, from its beginning to its end.
   type :: simplex_run_t
      integer :: number = 1                      !! of the start
      integer :: integer = 0                     !! random integer that it was begun with
      logical :: feasible = .false.              !! the given linkage could be made to obey: there was a search
      type(beginning_t) :: beginning             !! how it was begun
      type(simplex_t) :: first, last             !! the initial simplex, the final one
      type(search_state_t) :: state              !! iterations, evaluations, best objective
      real(wp), allocatable :: way(:, :)         !! shape (nvar, any): best vertices every NPRINT iterations, where they are wanted
      real(wp), allocatable :: way_objective(:)  !! shape (any)
      integer, allocatable :: way_iteration(:)   !! shape (any)
   contains
      procedure :: has_settled
   end type simplex_run_t

   !> Keeps the best vertex every so many iterations, and passes on what it sees.
   type, extends(observer_t) :: way_keeper_t
      integer :: every = 100                     !! NPRINT
      type(simplex_run_t), pointer :: run => null()
      class(observer_t), pointer :: next => null()
   contains
      procedure :: report
   end type way_keeper_t

   !> Asked whether two linkages are one by their dimensions alone.
   type, extends(starter_t) :: plain_starter_t
   contains
      procedure :: start
      procedure :: refine
   end type plain_starter_t

contains

   !> True if more than the one linkage of one simplex is wanted.
   pure logical function wants_several(set)
      type(data_set_t), intent(in) :: set

      wants_several = set%search%nstart > 1 .or. set%search%first > 1 .or. set%search%nbest > 1 .or. &
                      set%search%pareto /= pareto_none
   end function wants_several

   !> Search with one simplex. The problem must outlive the call of `observer`.
   subroutine run_simplex(set, vertices, problem, stop, run, observer, keep_way)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: vertices(:, :)       !! shape (nvar, any): supplied
      type(problem_t), intent(inout), target :: problem
      type(stop_t), intent(in) :: stop             !! asked after every iteration
      type(simplex_run_t), intent(inout), target :: run !! number and random integer are set
      class(observer_t), intent(inout), optional, target :: observer
      logical, intent(in), optional :: keep_way    !! keep the best vertex every NPRINT iterations; default false
      type(vertex_problem_t) :: search
      type(way_keeper_t) :: keeper

      allocate (run%way(size(problem%parameters%variables), 0), run%way_objective(0), run%way_iteration(0))
      call make_vertex_problem(set, problem, search)
      call start_simplex(set, search, vertices, run%integer, run%first, run%feasible, run%beginning)
      run%state%start = run%number
      if (.not. run%feasible) return
      run%last = run%first
      call search_few_positions(set, problem, search, stop, run, observer)
      keeper%every = set%limits%nprint
      if (present(observer)) keeper%next => observer
      if (present(keep_way)) then
         if (keep_way) keeper%run => run
      end if
      call search_simplex(rules_of(set), search, run%last, stop, run%state, keeper, made=(run%state%iteration), &
                          start=run%number)
   end subroutine run_simplex

   !> Search with NSTART simplexes, of which the first begins with ISTART and the others with random integers of their own streams.
   !> `found` are the NBEST different ones of their ends and of the vertices on their way, the best first.
   subroutine run_simplexes(set, vertices, problem, stop, runs, found, observer)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: vertices(:, :)       !! shape (nvar, any): supplied
      type(problem_t), intent(inout), target :: problem
      type(stop_t), intent(in) :: stop             !! asked after every iteration
      type(simplex_run_t), allocatable, intent(out) :: runs(:) !! shape (simplexes begun)
      type(result_t), intent(out) :: found
      class(observer_t), intent(inout), optional :: observer
      type(simplex_run_t), allocatable :: all_runs(:)
      logical :: done(set%search%nstart)
      integer :: i, begun

      allocate (all_runs(set%search%nstart))
      done = .false.
      begun = 0
      do i = 1, size(all_runs)
         if (stop%waiting()) exit
         begun = i
         all_runs(i)%number = set%search%first + i - 1
         all_runs(i)%integer = integer_of(set, all_runs(i)%number)
         call run_simplex(set, vertices, problem, stop, all_runs(i), observer, keep_way=.true.)
         done(i) = .not. stop%waiting() .or. all_runs(i)%has_settled()
         ! every simplex begins with the linkage given
         if (.not. all_runs(i)%feasible) exit
      end do
      runs = all_runs(:begun)
      found%starts = count(done)
      i = findloc(done, .false., dim=1)
      if (i > 0 .and. all(runs%feasible)) then
         found%next = set%search%first + i - 1
         found%left = size(done) - i + 1
      end if
      found%interrupted = stop%requested() .and. found%next > 0
      found%out_of_time = stop%late() .and. found%next > 0 .and. .not. found%interrupted
      found%evaluations = sum(runs%state%evaluations)
      allocate (found%by_default(size(problem%parameters%variables)), source=.false.)
      allocate (found%low(size(found%by_default)), source=-huge(1.0_wp))
      found%high = -found%low
      if (set%limits%limval == 1) then
         found%low = set%limits%oplow(:size(found%low))
         found%high = set%limits%ophigh(:size(found%high))
      end if
      call rank_linkages(set, problem, runs, found)
   end subroutine run_simplexes

   !> The random integer of a start: ISTART for the first. Neighbouring integers draw neighbouring numbers, so that the others are
   !> drawn themselves.
   pure integer function integer_of(set, number) result(drawn)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: number
      type(xoshiro_t) :: random
      real(wp) :: deviate

      drawn = set%method%istart
      if (number == 1) return
      call random%seed(set%method%istart, purpose_starts)
      call random%use_stream(number)
      call random%next(deviate)
      drawn = 2*int(deviate*real(most_odd, wp)) + 1
   end function integer_of

   !> Records of the starts, and the different linkages that they met, the best first.
   subroutine rank_linkages(set, problem, runs, found)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(simplex_run_t), intent(in) :: runs(:)
      type(result_t), intent(inout) :: found
      type(candidate_t), allocatable :: candidates(:)
      type(multistart_t) :: rules
      type(plain_starter_t) :: team(1)
      integer, allocatable :: kept(:), number(:), iteration(:)
      real(wp), allocatable :: given(:)
      integer :: i, k, n

      n = 0
      do i = 1, size(runs)
         if (runs(i)%feasible) n = n + 1 + size(runs(i)%way_objective)
      end do
      allocate (candidates(n), number(n), iteration(n), found%log(size(runs)))
      n = 0
      do i = 1, size(runs)
         associate (run => runs(i), record => found%log(i))
            record%number = run%number
            record%feasible = run%feasible
            record%evaluations = run%state%evaluations
            if (.not. run%feasible) cycle
            record%objective = run%last%f(run%last%best)
            record%feasible = record%objective < without_rates
            call add(run%last%v(:, run%last%best), record%objective, 0)
            do k = 1, size(run%way_objective)
               call add(run%way(:, k), run%way_objective(k), run%way_iteration(k))
            end do
         end associate
      end do
      found%feasible = count(found%log%feasible)
      rules%kept = set%search%nbest
      if (set%search%pareto /= pareto_none) rules%kept = max(rules%kept, most_weighed)
      rules%small = set%method%fmin
      call tell_apart(set, problem, maxval(problem%given%arcl), 0, .false., rules)
      call rules%keep_as_they_are(team, candidates, kept)
      given = problem%parameters%first_values(problem%given)
      allocate (found%best(size(kept)))
      do i = 1, size(kept)
         associate (one => found%best(i), candidate => candidates(kept(i)))
            one%values = candidate%x
            one%delt = problem%delt
            one%objective = candidate%objective
            one%start = number(kept(i))
            one%iteration = iteration(kept(i))
            one%distance = distance_of(candidate%x, given, lengths_among(problem))
         end associate
      end do

   contains

      subroutine add(x, objective, met_at)
         real(wp), intent(in) :: x(:), objective
         integer, intent(in) :: met_at

         n = n + 1
         candidates(n)%x = x
         candidates(n)%objective = objective
         candidates(n)%done = .true.
         candidates(n)%feasible = objective < without_rates
         number(n) = runs(i)%number
         iteration(n) = met_at
      end subroutine add
   end subroutine rank_linkages

   !> The simplex ended by itself: small, or good enough.
   elemental logical function has_settled(self)
      class(simplex_run_t), intent(in) :: self

      has_settled = self%state%reason == stop_converged .or. self%state%reason == stop_small_objective
   end function has_settled

   !> After an iteration.
   subroutine report(self, state, points, objectives)
      class(way_keeper_t), intent(inout) :: self
      type(search_state_t), intent(in) :: state
      real(wp), intent(in), optional :: points(:, :)
      real(wp), intent(in), optional :: objectives(:)
      real(wp), allocatable :: longer(:, :)
      integer :: best, n

      if (associated(self%next)) call self%next%report(state, points, objectives)
      if (.not. (associated(self%run) .and. present(points) .and. present(objectives))) return
      if (state%iteration == 0 .or. mod(state%iteration, self%every) /= 0) return
      best = minloc(objectives, dim=1)
      associate (run => self%run)
         n = size(run%way_objective)
         allocate (longer(size(points, 1), n + 1))
         longer(:, :n) = run%way
         longer(:, n + 1) = points(:, best)
         call move_alloc(longer, run%way)
         run%way_objective = [run%way_objective, objectives(best)]
         run%way_iteration = [run%way_iteration, state%iteration]
      end associate
   end subroutine report

   !> Search with few positions first, then with twice as many, as long as they are not all. Each simplex becomes the first of the
   !> next stage.
   subroutine search_few_positions(set, problem, search, stop, run, observer)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(vertex_problem_t), intent(inout) :: search  !! all positions; counts up
      type(stop_t), intent(in) :: stop
      type(simplex_run_t), intent(inout) :: run        !! `last` is a simplex that obeys; it still does afterwards
      class(observer_t), intent(inout), optional :: observer
      class(problem_t), allocatable, target :: part
      type(vertex_problem_t) :: few
      type(simplex_rules_t) :: rules
      real(wp), allocatable :: haven(:)
      real(wp) :: objective
      integer :: stage, worst

      associate (sizes => stage_sizes(set%search%few, problem%positions))
         if (size(sizes) == 1) return
         rules = rules_of(set)
         rules%small = max(rules%small, near)
         haven = run%last%v(:, run%last%best)
         objective = run%last%f(run%last%best)
         do stage = 1, size(sizes) - 1
            call take_positions(problem, positions_of_stage(problem, sizes(stage)), part)
            call make_vertex_problem(set, part, few)
            few%evaluations = search%evaluations
            few%counts = search%counts
            call settle_all(few, haven, run%last)
            call search_simplex(rules, few, run%last, stop, run%state, observer, made=(run%state%iteration), start=run%number)
            search%evaluations = few%evaluations
            search%counts = few%counts
         end do
         call settle_all(search, haven, run%last)
      end associate
      ! what few positions led to may be worse at all of them than what there was
      associate (last => run%last)
         if (last%f(last%best) <= objective) return
         worst = maxloc(last%f, dim=1)
         last%v(:, worst) = haven
         last%f(worst) = objective
         last%best = worst
      end associate
   end subroutine search_few_positions

   !> Make every vertex obey at the positions of a problem, the best first: the others move towards it where they must.
   subroutine settle_all(problem, haven, simplex)
      type(vertex_problem_t), intent(inout) :: problem
      real(wp), intent(in) :: haven(:)                 !! a linkage that obeys
      type(simplex_t), intent(inout) :: simplex
      integer :: k
      logical :: reached

      associate (best => simplex%best)
         call problem%settle(simplex%v(:, best), simplex%f(best), reached, towards=haven)
         do k = 1, size(simplex%f)
            if (k /= best) call problem%settle(simplex%v(:, k), simplex%f(k), reached, towards=simplex%v(:, best))
         end do
      end associate
      simplex%best = minloc(simplex%f, dim=1)
   end subroutine settle_all

   !> Nothing: the simplexes are made in their order.
   subroutine start(self, number, elite, candidate)
      class(plain_starter_t), intent(inout) :: self
      integer, intent(in) :: number
      real(wp), intent(in) :: elite(:, :)
      type(candidate_t), intent(inout) :: candidate

      associate (unused => self, unused_number => number, unused_elite => elite, unchanged => candidate)
      end associate
   end subroutine start

   !> Nothing: a simplex was searched to its end.
   subroutine refine(self, thorough, candidate)
      class(plain_starter_t), intent(inout) :: self
      logical, intent(in) :: thorough
      type(candidate_t), intent(inout) :: candidate

      associate (unused => self, unused_extent => thorough, unchanged => candidate)
      end associate
   end subroutine refine
end module psalm_simplex_search
