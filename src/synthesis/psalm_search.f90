!> Linkages from many starts: the user's linkage, supplied ones and others drawn round it, each improved, the best kept.
!>
!> `psalm_multistart` makes the starts and ranks what they lead to; here is what a start of a linkage is: draw it, make it close
!> where that is easy, improve it, look for a better timing, inspect the range of its input. Start i takes its random numbers
!> from a stream of its own.
module psalm_search
   use psalm_constr, only: constraints_t, make_constraints, constrain
   use psalm_constraint_group, only: range_positions, range_turn
   use psalm_data_set, only: data_set_t
   use psalm_dyad_groups, only: dyads_of_variables
   use psalm_elementary, only: fractional_power
   use psalm_error, only: problem_t
   use psalm_few_positions, only: stage_sizes, positions_of_stage, take_positions
   use psalm_free_start, only: free_start_t, prepare_free_start, make_free_start
   use psalm_kinds, only: wp, degrees_per_radian, full_turn, right_angle
   use psalm_margins, only: inspector_t, margin_t, prepare_inspector, inspect, is_violated
   use psalm_merit, only: merit_t, prepare_merit, eliminate_linear, forget_sides, hold, hold_place, let_go, set_range, &
                          extra_positions
   use psalm_multistart, only: candidate_t, multistart_t, starter_t, promise_of
   use psalm_nlp, only: repair_count_t
   use psalm_search_group, only: order_either, pareto_none
   use psalm_solver, only: solver_t, ending_t, observer_t, stop_refused
   use psalm_solvers, only: new_solver
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples
   use psalm_stop, only: stop_t
   use psalm_timing, only: timing_t, prepare_timing, find_timing
   use psalm_parameters, only: variable_length, variable_outlk, variable_origlk, variable_crnki, variable_gama, &
                               variable_outang, variable_origng, variable_aside, variable_aside_angle
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: found_t, result_t, start_record_t, search_t, search_many, distance_of, lengths_among, place_desired, tell_apart

   real(wp), parameter :: least_value = 1.0e-3_wp  !! of the first linkage: a smaller one counts as zero
   integer, parameter :: most_returns = 4          !! times a search goes back to work on what an inspection found
   real(wp), parameter :: rough = 1.0e-3_wp        !! relative gain of a step that ends the search of a start ...
   real(wp), parameter :: rough_free = 1.0e-5_wp   !! ... with free timing, whose valleys are long ...
   real(wp), parameter :: settling = 1.0e-5_wp     !! ... that of further results that may be listed ...
   real(wp), parameter :: fine = 1.0e-9_wp         !! ... and that of the best, which are searched on
   integer, parameter :: short_descent = 20        !! evaluations that tell a good start where linear unknowns are solved for
   real(wp), parameter :: wide = 10.0_wp           !! ratio of the bounds of a length above which ratios are drawn
   integer, parameter :: fineness = 5              !! near: by a half, a quarter ... a 32nd
   real(wp), parameter :: negligible = 1.0e-2_wp   !! of the longest given arc: such lengths tell no linkages apart by their ratio
   integer, parameter :: few_refined = 3           !! results of batches searched on, at least: most of the work is done there
   integer, parameter :: most_weighed = 100        !! linkages that a list of PARETO is chosen from, at least
   real(wp), parameter :: worth_it = 1.0e-6_wp     !! relative gain for which another timing is tried
   real(wp), parameter :: alike = 1.0e-2_wp        !! relative difference of objectives of linkages that may be the same
   real(wp), parameter :: same_place = 1.0e-4_wp   !! of the linkage's size: joints no farther apart are at one place
   real(wp), parameter :: ridge = 1.0e-2_wp        !! relative rise of the objective that parts two valleys
   integer, parameter :: steps_between = 8         !! in which the way from one linkage to another is looked at

   !> A linkage found.
   type :: found_t
      real(wp), allocatable :: values(:)   !! shape (nvar)
      real(wp), allocatable :: delt(:)     !! shape (positions): input increments (those given, but for free timing)
      real(wp), allocatable :: desired(:, :) !! shape (positions, 2): where the desired points lie; not allocated: as given
      real(wp) :: objective = 0.0_wp
      integer :: start = 0                 !! the start that led to it; -j: the j-th supplied vertex
      integer :: iteration = 0             !! of the simplex, which met it on its way; 0: it is what the start ended with
      real(wp) :: distance = 0.0_wp        !! from the first linkage: largest relative change of a value
   end type found_t

   !> What became of a start, for the log.
   type :: start_record_t
      integer :: number = 0                !! of the start; -j: the j-th supplied vertex
      logical :: feasible = .false.        !! it led to a linkage that obeys every constraint
      real(wp) :: objective = 0.0_wp       !! of which
      integer :: evaluations = 0, jacobians = 0
   end type start_record_t

   !> What a search from many starts found.
   type :: result_t
      type(found_t), allocatable :: best(:) !! shape (at most NBEST): distinct, the best first
      integer :: starts = 0                !! starts made
      integer :: feasible = 0              !! of which led to a linkage that obeys every constraint
      integer :: evaluations = 0, jacobians = 0
      logical :: out_of_time = .false.     !! MAXTIME passed before all starts were made
      logical :: interrupted = .false.     !! a signal came before
      logical :: refused = .false.         !! the solver refuses this problem
      integer :: next = 0                  !! first start not made; 0: all were
      integer :: left = 0                  !! from there on
      type(start_record_t), allocatable :: log(:) !! of the starts made
      logical, allocatable :: by_default(:) !! shape (nvar): bounds that were not given, of arcs' lengths
      real(wp), allocatable :: low(:), high(:) !! shape (nvar): bounds
   end type result_t

   !> What one thread works with.
   type, extends(starter_t) :: worker_t
      type(data_set_t), pointer :: set => null()  !! the caller's
      real(wp), allocatable :: first(:)           !! shape (nvar): the user's linkage
      real(wp), allocatable :: home(:)            !! shape (nvar): the same, made to obey
      logical :: closes = .false.                 !! it could be
      integer :: spent = 0                        !! evaluations that took
      real(wp), allocatable :: supplied(:, :)     !! shape (nvar, supplied)
      ! allocated, and by their classes: doc/develop/architecture.md, where a large object stands
      class(problem_t), allocatable :: problem
      class(constraints_t), allocatable :: constraints
      class(merit_t), allocatable :: merit
      class(sample_set_t), allocatable :: places     !! where the joints of two linkages are compared
      ! by its base class, as a team is
      class(starter_t), allocatable :: few(:)     !! shape (stages - 1): who makes the stages of a start but its last
      logical :: early = .false.                  !! this is one of those: some of the positions are looked at
      integer :: stage = 1                        !! MAXEVAL is allowed for each stage of a start so far
      integer, allocatable :: dyads(:)            !! shape (nvar): the dyad each variable belongs to
      type(timing_t), allocatable :: timing(:)    !! shape (2): with the input going the way of DELT, the other way
      class(inspector_t), allocatable :: inspector
      type(free_start_t), allocatable :: free_start(:) !! shape (2): the same
      real(wp) :: sense = 1.0_wp                  !! of DELT
      integer :: way = 1                          !! 1 if the input goes the way of DELT, 2 if the other way
      logical :: batches = .false.                !! starts are the best of batches of random linkages
      logical :: hasty = .false.                  !! a start is one of a screening: little is drawn, nothing is searched to its end
      logical :: among_kinds = .false.            !! it searches one of several kinds
      logical :: turning = .false.                !! batches are of linkages that turn
      class(solver_t), allocatable :: solver
      type(stop_t) :: stop
      type(xoshiro_t) :: random
   contains
      procedure :: start => start_in_stages
      procedure :: go_on
      procedure :: are_one
      procedure :: refine
      procedure :: stages
   end type worker_t

   !> A search whose starts are made at one time and which is finished at another.
   type :: search_t
      private
      ! by its base class: what compilers make of taking a whole worker apart is then made once
      class(starter_t), allocatable :: team(:)
      type(candidate_t), allocatable :: candidates(:)
      integer, allocatable :: best(:)             !! places of the best
      logical :: free = .false.                   !! free timing
      logical, allocatable :: by_default(:)       !! as `result_t` has them
      real(wp), allocatable :: low(:), high(:), first(:)
      logical, allocatable :: lengths(:)          !! shape (nvar): the variable is a length, no angle
      real(wp), allocatable :: delt(:)            !! shape (positions): those given
      type(multistart_t) :: rules
      type(stop_t) :: ending
   contains
      procedure :: make_starts
      procedure :: make_more_starts
      procedure :: share_among
      procedure :: end_by
      procedure :: hits
      procedure :: least_objective
      procedure :: promise
      procedure :: made
      procedure :: go_on_from
      procedure :: search_on
      procedure :: finish
      procedure :: report
   end type search_t

contains

   !> Search from the supplied vertices and NSTART starts. `first` is the user's linkage.
   subroutine search_many(set, problem, first, supplied, threads, stop, result, observer)
      type(data_set_t), intent(in), target :: set
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: first(:)          !! shape (nvar)
      real(wp), intent(in) :: supplied(:, :)    !! shape (nvar, supplied)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop          !! asked now and then
      type(result_t), intent(out) :: result
      class(observer_t), intent(inout), optional :: observer
      type(search_t), allocatable :: search     ! in memory of its own: it would fill a small stack

      allocate (search)
      call search%make_starts(set, problem, first, supplied, threads, stop, observer)
      call search%finish(result)
   end subroutine search_many

   !> Make all starts; the best are not searched on from.
   subroutine make_starts(self, set, problem, first, supplied, threads, stop, observer, starts, hasty)
      class(search_t), intent(inout) :: self
      type(data_set_t), intent(in), target :: set !! must live until the search is finished
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: first(:)          !! shape (nvar)
      real(wp), intent(in) :: supplied(:, :)    !! shape (nvar, supplied)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop          !! asked now and then
      class(observer_t), intent(inout), optional :: observer
      integer, intent(in), optional :: starts   !! in place of NSTART
      logical, intent(in), optional :: hasty    !! a screening: these starts are cut short
      integer :: t

      self%ending = stop
      call self%ending%limit_time(set%search%maxtime)
      self%rules%supplied = size(supplied, 2)
      self%rules%starts = set%search%nstart
      if (present(starts)) self%rules%starts = starts
      self%rules%first = set%search%first
      self%rules%kept = set%search%nbest
      if (set%search%pareto /= pareto_none) self%rules%kept = max(self%rules%kept, most_weighed)
      self%rules%refines = set%search%solver%refines
      self%rules%small = set%method%fmin
      t = self%rules%supplied + self%rules%starts
      if (present(hasty)) t = threads ! more starts will follow
      call gather(min(max(1, threads), max(1, t)), self%team)
      select type (team => self%team)
      type is (worker_t)
         do t = 1, size(team)
            team(t)%among_kinds = present(hasty)
            call prepare_worker(set, problem, first, supplied, self%ending, team(t))
            call prepare_stages(set, problem, first, supplied, self%ending, team(t))
            if (present(hasty)) team(t)%hasty = hasty
         end do
         associate (merit => team(1)%merit)
            self%rules%compared = [is_length(problem), spread(.false., 1, merit%local)]
            call tell_apart(set, problem, merit%size, merit%local, merit%free, self%rules)
            if (team(1)%batches) self%rules%refined = few_refined
            self%rules%stages = team(1)%stages()
            self%free = merit%free
            self%by_default = merit%by_default
            self%low = merit%default_low
            self%high = merit%default_high
         end associate
      end select
      self%first = first
      self%lengths = lengths_among(problem)
      self%delt = problem%delt
      call self%rules%make_all(self%team, self%ending, self%candidates, self%best, observer)
   end subroutine make_starts

   !> Workers with nothing to do yet. A procedure of its own: compilers write out how a whole worker is taken apart wherever some
   !> are allocated.
   subroutine gather(count, team)
      integer, intent(in) :: count
      class(starter_t), allocatable, intent(out) :: team(:)
      class(worker_t), allocatable :: one     ! by whose type they come from one procedure, not from code that is repeated here

      allocate (one)
      allocate (team(count), mold=one)
   end subroutine gather

   !> Make so many starts more, to their ends.
   subroutine make_more_starts(self, more)
      class(search_t), intent(inout) :: self    !! starts were made
      integer, intent(in) :: more
      integer :: t

      select type (team => self%team)
      type is (worker_t)
         do t = 1, size(team)
            team(t)%hasty = .false.
         end do
      end select
      call self%rules%make_more(self%team, more, self%ending, self%candidates, self%best)
   end subroutine make_more_starts

   !> Share what follows among so many threads. The team is made anew: no member remembers anything of its starts.
   subroutine share_among(self, threads)
      class(search_t), intent(inout) :: self    !! starts were made
      integer, intent(in) :: threads
      class(starter_t), allocatable :: before(:)
      integer :: t

      if (size(self%team) == threads) return
      call move_alloc(self%team, before)
      call gather(threads, self%team)
      select type (before)
      type is (worker_t)
         select type (team => self%team)
         type is (worker_t)
            associate (one => before(1))
               do t = 1, size(team)
                  team(t)%among_kinds = one%among_kinds
                  call prepare_worker(one%set, one%problem, one%first, one%supplied, self%ending, team(t))
                  call prepare_stages(one%set, one%problem, one%first, one%supplied, self%ending, team(t))
               end do
            end associate
         end select
      end select
   end subroutine share_among

   !> Let it end by this from now on.
   subroutine end_by(self, stop)
      class(search_t), intent(inout) :: self    !! starts were made
      type(stop_t), intent(in) :: stop
      integer :: t

      self%ending = stop
      select type (team => self%team)
      type is (worker_t)
         do t = 1, size(team)
            team(t)%stop = stop
         end do
      end select
   end subroutine end_by

   !> How many starts led to the best objective, but for a part of it.
   pure integer function hits(self, part)
      class(search_t), intent(in) :: self
      real(wp), intent(in) :: part

      hits = 0
      if (size(self%best) == 0) return
      hits = count(self%candidates%feasible .and. self%candidates%objective <= (1.0_wp + part)*self%least_objective())
   end function hits

   !> Objective of the best linkage so far; huge if there is none.
   pure real(wp) function least_objective(self)
      class(search_t), intent(in) :: self

      least_objective = huge(least_objective)
      if (size(self%best) > 0) least_objective = self%candidates(self%best(1))%objective
   end function least_objective

   !> The least objective that starts came to; of a linkage that obeys not every constraint ten times as much and a handicap.
   pure real(wp) function promise(self, handicap)
      class(search_t), intent(in) :: self
      real(wp), intent(in) :: handicap

      promise = promise_of(self%candidates, handicap)
   end function promise

   !> What became of the starts so far.
   pure subroutine made(self, candidates, best)
      class(search_t), intent(in) :: self       !! starts were made
      type(candidate_t), allocatable, intent(out) :: candidates(:)
      integer, allocatable, intent(out), optional :: best(:) !! places of the best

      candidates = self%candidates
      if (present(best)) best = self%best
   end subroutine made

   !> Take the place of a search that came to these results.
   pure subroutine go_on_from(self, candidates, best)
      class(search_t), intent(inout) :: self    !! starts were made, or none (`starts` = 0)
      type(candidate_t), intent(in) :: candidates(:)
      integer, intent(in), optional :: best(:)  !! places of the results kept; without it: of those to search on from

      self%candidates = candidates
      self%rules%starts = size(candidates) - self%rules%supplied
      if (present(best)) then
         self%best = best
      else
         self%best = self%rules%leading(candidates)
      end if
   end subroutine go_on_from

   !> Search on from the best starts, or keep them as they are.
   subroutine search_on(self, further)
      class(search_t), intent(inout) :: self    !! its starts are made
      logical, intent(in) :: further

      if (further) then
         call self%rules%finish(self%team, self%ending, self%candidates, self%best)
      else
         call self%rules%keep_as_they_are(self%team, self%candidates, self%best)
      end if
   end subroutine search_on

   !> Search on from the best starts, and tell what was found.
   subroutine finish(self, result)
      class(search_t), intent(inout) :: self    !! its starts are made
      type(result_t), intent(out) :: result

      call self%search_on(further=.true.)
      call self%report(result)
   end subroutine finish

   !> What was found, when its best starts were searched on from.
   subroutine report(self, result)
      class(search_t), intent(in) :: self
      type(result_t), intent(out) :: result
      integer :: i

      associate (candidates => self%candidates, ending => self%ending, first => self%first)
         result%by_default = self%by_default
         result%low = self%low
         result%high = self%high
         result%starts = count(candidates%done)
         result%feasible = count(candidates%feasible)
         result%refused = any(candidates%refused)
         i = findloc(candidates(self%rules%supplied + 1:)%done, .false., dim=1)
         if (i > 0) then
            result%next = self%rules%first + i - 1
            result%left = self%rules%starts - i + 1
         end if
         result%interrupted = ending%requested()
         result%out_of_time = ending%late() .and. .not. result%interrupted
         result%evaluations = sum(candidates%evaluations)
         result%jacobians = sum(candidates%jacobians)
         call record_starts(self%rules, candidates, result%log)
         allocate (result%best(size(self%best)))
         do i = 1, size(self%best)
            associate (found => result%best(i), candidate => candidates(self%best(i)))
               found%values = candidate%x(:size(first))
               found%delt = self%delt
               if (self%free) found%delt = candidate%x(size(first) + 1:)
               found%objective = candidate%objective
               found%start = self%rules%number_of(self%best(i))
               found%distance = distance_of(found%values, first, self%lengths)
            end associate
         end do
      end associate
   end subroutine report

   !> Give a problem the desired points where they lie for a linkage.
   subroutine place_desired(found, problem)
      type(found_t), intent(in) :: found
      type(problem_t), intent(inout) :: problem
      real(wp), allocatable :: weight(:, :)

      if (.not. allocated(found%desired)) return
      weight = problem%weight(:problem%positions, :)
      call problem%set_desired(found%desired, weight)
   end subroutine place_desired

   !> Distance of a linkage from the first one: the largest change of a value, relative to what it was; of one that was zero,
   !> relative to the longest length, or to a radian.
   pure real(wp) function distance_of(values, first, lengths) result(distance)
      real(wp), intent(in) :: values(:), first(:)
      logical, intent(in) :: lengths(:)          !! the value is a length; others are angles in degrees
      real(wp) :: unit(size(first))

      unit = degrees_per_radian
      where (lengths) unit = max(least_value, maxval(abs(first), mask=lengths))
      where (abs(first) >= least_value) unit = abs(first)
      distance = maxval(abs(values - first)/unit)
   end function distance_of

   !> Which variables are lengths; the others are angles.
   pure function lengths_among(problem) result(lengths)
      type(problem_t), intent(in) :: problem
      logical :: lengths(size(problem%parameters%variables))

      associate (kind => problem%parameters%variables%kind)
         lengths = kind == variable_length .or. kind == variable_outlk .or. kind == variable_origlk .or. &
                   kind == variable_aside .or. (kind == variable_crnki .and. problem%mechanism%sliding_input)
      end associate
   end function lengths_among

   !> What makes two linkages different: a length that differs by DIFFER of itself, an angle that differs by DIFFER radians; inputs
   !> of free timing do not.
   pure subroutine tell_apart(set, problem, size_of_linkage, inputs, free, rules)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: size_of_linkage    !! in the user's unit of length
      integer, intent(in) :: inputs              !! that are unknowns after the dimensions
      logical, intent(in) :: free                !! free timing
      type(multistart_t), intent(inout) :: rules
      logical :: lengths(size(problem%parameters%variables))
      integer :: v, n

      n = size(problem%parameters%variables)
      lengths = lengths_among(problem)
      allocate (rules%relative(n + inputs), rules%period(n + inputs), source=0.0_wp)
      allocate (rules%absolute(n + inputs), source=huge(1.0_wp))
      do v = 1, n
         associate (kind => problem%parameters%variables(v)%kind)
            if (lengths(v)) then
               rules%relative(v) = set%search%differ
               rules%absolute(v) = set%search%differ*negligible*size_of_linkage
            else
               rules%absolute(v) = set%search%differ*degrees_per_radian
               rules%period(v) = full_turn
            end if
            ! with free timing the inputs take up what the reference input says
            if (kind == variable_crnki .and. free) rules%absolute(v) = huge(1.0_wp)
         end associate
      end do
   end subroutine tell_apart

   subroutine prepare_worker(set, problem, first, supplied, ending, worker)
      type(data_set_t), intent(in), target :: set
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: first(:), supplied(:, :)
      type(stop_t), intent(in) :: ending
      type(worker_t), intent(inout) :: worker
      type(repair_count_t) :: counts
      real(wp) :: objective
      integer :: way, loop

      worker%set => set
      worker%first = first
      worker%supplied = supplied
      worker%stop = ending
      allocate (worker%problem, source=problem)
      allocate (worker%constraints, worker%merit, worker%timing(2), worker%inspector, worker%free_start(2))
      call make_constraints(set, problem, worker%constraints)
      worker%home = first
      call constrain(worker%problem, worker%constraints, worker%home, objective, worker%closes, worker%spent, counts)
      call prepare_merit(set, problem, first, worker%merit)
      call new_solver(set%search%solver, worker%solver)
      call worker%random%seed(set%method%istart, purpose_starts)
      worker%sense = worker%merit%sense
      do way = merge(2, 1, goes_either_way(worker)), 1, -1
         call go(worker, way)
         if (worker%merit%free) call prepare_timing(problem, worker%merit, worker%timing(way))
         if (set%search%solver%refines) call prepare_free_start(problem, worker%merit, worker%free_start(way))
      end do
      if (set%search%solver%refines .and. .not. worker%free_start(1)%applies) call eliminate_linear(worker%merit)
      ! the linkage itself can lie anywhere, in any size: the points need not
      if (set%limits%limval /= 1 .and. (worker%free_start(1)%applies .or. allocated(worker%merit%linear))) &
         call hold_place(worker%merit)
      worker%dyads = dyads_of_variables(problem%mechanism, problem%parameters)
      worker%batches = allocated(worker%merit%linear) .and. worker%merit%free .and. worker%merit%ordered .and. &
                       worker%merit%irange == range_turn
      worker%turning = worker%among_kinds .and. all([(problem%mechanism%is_dyad(loop), loop=1, problem%mechanism%nloop)])
      if (worker%merit%irange /= range_positions) call prepare_inspector(set, problem, .true., worker%inspector)
   end subroutine prepare_worker

   !> Those who make the stages of a start but its last.
   subroutine prepare_stages(set, problem, first, supplied, ending, worker)
      type(data_set_t), intent(in), target :: set
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: first(:), supplied(:, :)
      type(stop_t), intent(in) :: ending
      type(worker_t), intent(inout) :: worker
      class(problem_t), allocatable :: part
      integer :: stage

      associate (sizes => stage_sizes(set%search%few, problem%positions))
         call gather(size(sizes) - 1, worker%few)
         worker%stage = size(sizes)
         select type (few => worker%few)
         type is (worker_t)
            do stage = 1, size(few)
               call take_positions(problem, positions_of_stage(problem, sizes(stage)), part)
               call prepare_worker(set, part, first, supplied, ending, few(stage))
               few(stage)%early = .true.
               few(stage)%among_kinds = worker%among_kinds
               few(stage)%stage = stage
            end do
         end select
      end associate
   end subroutine prepare_stages

   !> Points in their order may be visited with the input going either way.
   pure logical function goes_either_way(worker)
      class(worker_t), intent(in) :: worker

      goes_either_way = worker%merit%ordered .and. worker%set%search%order == order_either
   end function goes_either_way

   !> Let the input go that way from now on.
   pure subroutine go(worker, way)
      class(worker_t), intent(inout) :: worker
      integer, intent(in) :: way                !! 1 for the way of DELT, 2 for the other

      worker%way = way
      worker%merit%sense = merge(worker%sense, -worker%sense, way == 1)
   end subroutine go

   !> What became of the starts that were made.
   pure subroutine record_starts(rules, candidates, log)
      type(multistart_t), intent(in) :: rules
      type(candidate_t), intent(in) :: candidates(:)
      type(start_record_t), allocatable, intent(out) :: log(:)
      integer :: i, n

      allocate (log(count(candidates%done .or. candidates%feasible)))
      n = 0
      do i = 1, size(candidates)
         if (.not. (candidates(i)%done .or. candidates(i)%feasible)) cycle
         n = n + 1
         log(n) = start_record_t(rules%number_of(i), candidates(i)%feasible, candidates(i)%objective, &
                                 candidates(i)%evaluations, candidates(i)%jacobians)
      end do
   end subroutine record_starts

   !> One start, or the first stage of it: few positions are looked at then.
   subroutine start_in_stages(self, number, elite, candidate)
      class(worker_t), intent(inout) :: self
      integer, intent(in) :: number
      real(wp), intent(in) :: elite(:, :)
      type(candidate_t), intent(inout) :: candidate

      if (self%early .or. self%stages() == 1) then
         call one_start(self, number, elite, candidate)
      else
         call self%few(1)%start(number, elite, candidate)
         call assess(self, candidate)
      end if
   end subroutine start_in_stages

   !> Stages of a start.
   pure integer function stages(self)
      class(worker_t), intent(in) :: self

      stages = 1
      if (allocated(self%few)) stages = 1 + size(self%few)
   end function stages

   !> Improve what a start led to with the positions of the next stage; what does not obey is not taken if what was there does.
   subroutine go_on(self, stage, candidate)
      class(worker_t), intent(inout) :: self
      integer, intent(in) :: stage
      type(candidate_t), intent(inout) :: candidate
      type(candidate_t) :: further
      real(wp), allocatable :: values(:)

      further%done = candidate%done
      call forget_sides(self%merit)
      if (stage < self%stages()) then
         further%x = candidate%x
         further%evaluations = candidate%evaluations
         further%jacobians = candidate%jacobians
         call self%few(stage)%go_on(stage, further)
         call assess(self, further)
      else
         values = candidate%x
         self%merit%evaluations = candidate%evaluations
         self%merit%jacobians = candidate%jacobians
         if (self%merit%has_range) call set_range(self%merit, [real(wp) ::])
         call improve(self, rough, 1, values, further)
         call put_down(self, values, 0, further)
      end if
      if (further%feasible .or. self%early .or. .not. candidate%feasible) then
         candidate = further
      else
         candidate%evaluations = further%evaluations
         candidate%jacobians = further%jacobians
      end if
   end subroutine go_on

   !> What a linkage that few positions led to is worth at all of them.
   subroutine assess(worker, candidate)
      class(worker_t), intent(inout) :: worker
      type(candidate_t), intent(inout) :: candidate
      type(margin_t), allocatable :: margins(:)
      real(wp) :: violation

      associate (merit => worker%merit)
         call forget_sides(merit)
         merit%evaluations = candidate%evaluations
         if (merit%has_range) call set_range(merit, [real(wp) ::])
         call merit%measure(candidate%x, candidate%promise, violation)
         candidate%promise = candidate%promise + max(candidate%promise, merit%small)*violation
         call merit%accept(candidate%x, candidate%objective, candidate%feasible)
         if (candidate%feasible .and. merit%irange /= range_positions) then
            call inspect(worker%inspector, merit%dimensions, merit%delt, margins, hasty=.true.)
            candidate%feasible = .not. any(is_violated(margins))
         end if
         candidate%evaluations = merit%evaluations
      end associate
   end subroutine assess

   !> Two linkages are one if their joints are at the same places at the same inputs, whatever the numbers say (a pivot at a
   !> negative distance, in the opposite direction), or if no ridge of the objective lies between them: one of them is then not yet
   !> at the bottom of the valley that they share.
   logical function are_one(self, a, b)
      class(worker_t), intent(inout) :: self
      type(candidate_t), intent(in) :: a, b
      real(wp) :: between(size(a%x)), other(size(a%x)), objective, violation, highest
      integer :: v, step

      are_one = have_same_places(self, a, b)
      if (are_one) return
      associate (merit => self%merit)
         call forget_sides(merit)
         other = b%x
         do v = 1, merit%core
            select case (self%problem%parameters%variables(v)%kind)
            case (variable_gama, variable_outang, variable_origng, variable_aside_angle)
               other(v) = other(v) + full_turn*anint((a%x(v) - other(v))/full_turn)
            end select
         end do
         if (merit%free) then
            if (goes_either_way(self)) then
               if (way_of(self, a%x) /= way_of(self, b%x)) return
               call go(self, way_of(self, a%x))
            end if
            merit%delt = a%x(merit%core + 1:)
            if (.not. self%problem%mechanism%sliding_input) other(merit%core + 1:) = other(merit%core + 1:) + full_turn &
               *anint((reference_of(a%x) + a%x(merit%core + 1) - reference_of(other) - other(merit%core + 1))/full_turn)
         end if
         if (merit%has_range) call set_range(merit, [real(wp) ::])
         highest = (1.0_wp + ridge)*max(a%objective, b%objective)
         do step = 1, steps_between - 1
            between = a%x + (other - a%x)*(real(step, wp)/real(steps_between, wp))
            call merit%fit_linear(between)
            call merit%measure(between, objective, violation)
            if (.not. objective + max(objective, merit%small)*violation <= highest) return
         end do
         are_one = .true.
      end associate

   contains

      !> The reference input of a linkage.
      real(wp) function reference_of(x)
         real(wp), intent(in) :: x(:)                  !! unknowns

         call self%problem%parameters%apply(x(:self%merit%core), self%merit%dimensions)
         reference_of = self%merit%dimensions%crnki
      end function reference_of
   end function are_one

   !> Which way the input goes.
   pure integer function way_of(worker, x)
      class(worker_t), intent(in) :: worker
      real(wp), intent(in) :: x(:)                     !! unknowns, inputs of free timing included

      way_of = merge(1, 2, worker%sense*(x(size(x)) - x(worker%merit%core + 1)) >= 0.0_wp)
   end function way_of

   !> The joints of two linkages are at the same places, at two inputs.
   logical function have_same_places(self, a, b) result(same)
      class(worker_t), intent(inout) :: self
      type(candidate_t), intent(in) :: a, b
      integer, allocatable :: joints(:, :)
      real(wp), allocatable :: first(:, :, :)
      real(wp) :: delt(2), reference
      logical :: closed(2)
      integer :: loop, arc

      same = .false.
      if (abs(a%objective - b%objective) > alike*max(a%objective, b%objective)) return
      associate (merit => self%merit, loops => self%problem%mechanism%loops)
         delt = [self%problem%delt(1), self%problem%delt((size(self%problem%delt) + 1)/2)]
         if (merit%free) delt = [a%x(merit%core + 1), a%x(merit%core + (merit%local + 1)/2)]
         if (.not. allocated(self%places)) then
            joints = reshape([((loop, arc, arc=1, loops(loop)%arcs), loop=1, size(loops))], [2, sum(loops%arcs)])
            allocate (self%places)
            call prepare_samples(self%problem, delt, .false., joints, .false., self%places)
         end if
         call self%places%problem%move_inputs(delt)
         call self%problem%parameters%apply(a%x(:merit%core), merit%dimensions)
         reference = merit%dimensions%crnki
         call evaluate_samples(self%places, merit%dimensions)
         first = self%places%joints
         closed = self%places%closed
         call self%problem%parameters%apply(b%x(:merit%core), merit%dimensions)
         call self%places%problem%move_inputs(delt + (reference - merit%dimensions%crnki))
         call evaluate_samples(self%places, merit%dimensions)
         same = all(closed .and. self%places%closed)
         if (same) same = all(abs(self%places%joints - first) <= same_place*merit%size)
      end associate
   end function have_same_places

   !> One start: draw it, make it close where that is easy, improve it, inspect it.
   subroutine one_start(self, number, elite, candidate)
      class(worker_t), intent(inout) :: self
      integer, intent(in) :: number                    !! 1: start from the user's; above: from one drawn; below: from a supplied
      real(wp), intent(in) :: elite(:, :)              !! shape (unknowns, any): the best linkages of the rounds before
      type(candidate_t), intent(inout) :: candidate
      type(repair_count_t) :: counts
      real(wp), allocatable :: values(:), home(:), x(:)
      real(wp) :: objective
      logical :: closes
      integer :: before

      if (goes_either_way(self)) call go(self, merge(2, 1, number > 1 .and. mod(number/2, 2) == 1))
      if (number > 1 .and. self%free_start(1)%applies) then
         call start_freely(self, number, candidate)
         return
      end if
      if (number > 1 .and. self%batches) then
         call start_with_batch(self, number, candidate)
         return
      end if
      before = 0
      associate (low => self%merit%box_low, high => self%merit%box_high, nvar => size(self%first))
         if (number > 1) then
            call draw(self%random, low, high, low > 0.0_wp .and. high > wide*low .and. is_length(self%problem), number, values)
            if (size(elite, 2) > 0 .and. mod(number, 2) == 1) then
               call draw_near(self%problem, elite(:nvar, elite_of_start(self, number, size(elite, 2))), low, high, &
                              1 + mod(number/4, fineness), values)
            end if
            if (self%set%search%by_dyads) call draw_one_dyad(self, number, elite, values)
            before = self%spent
            ! every other start keeps its own shape, closed or not; the others draw near the user's until they close
            if (mod(number, 2) == 0 .and. self%closes) call constrain(self%problem, self%constraints, values, objective, closes, &
                                                                      before, counts, towards=self%home)
         else
            home = self%first
            if (number < 0) home = self%supplied(:, -number)
            values = home
            call constrain(self%problem, self%constraints, values, objective, closes, before, counts)
            if (.not. closes) values = home
         end if
      end associate
      self%merit%evaluations = 0
      self%merit%jacobians = 0
      call look_from_first_input(self)
      if (self%merit%free .and. number /= 1) call retime(self, values)
      if (number > 1 .and. self%set%search%by_dyads) then
         call hold(self%merit, self%dyads /= dyad_of_start(self, number))
         call improve(self, rough, number, values, candidate, short_descent)
         call let_go(self%merit)
      end if
      if (number > 1) then
         x = self%merit%point(values, self%merit%delt)
         call self%merit%fit_linear(x)
         values = x(:self%merit%core)
         if (self%merit%free) self%merit%delt = x(self%merit%core + 1:)
      end if
      if (self%hasty .or. (number > 1 .and. allocated(self%merit%linear) .and. .not. self%merit%free)) then
         call improve(self, rough, number, values, candidate, short_descent)
      else
         call improve(self, merge(rough_free, rough, self%merit%free), number, values, candidate)
      end if
      call put_down(self, values, before, candidate)
   end subroutine one_start

   !> The input positions given, and the range looked at from them on: what a start before left is forgotten.
   subroutine look_from_first_input(worker)
      class(worker_t), intent(inout) :: worker

      call forget_sides(worker%merit)
      worker%merit%delt = worker%problem%delt
      if (worker%merit%has_range) call set_range(worker%merit, [real(wp) ::])
   end subroutine look_from_first_input

   !> The dyad that a start draws: each in turn, for two starts, since every other start draws near a linkage known.
   pure integer function dyad_of_start(worker, number)
      class(worker_t), intent(in) :: worker
      integer, intent(in) :: number                    !! above 1

      dyad_of_start = 1 + mod(number/2 - 1, maxval(worker%dyads))
   end function dyad_of_start

   !> Which of the best linkages so far a start begins with or draws near; dyad by dyad the same for all of the dyads.
   pure integer function elite_of_start(worker, number, known)
      class(worker_t), intent(in) :: worker
      integer, intent(in) :: number, known             !! the start, above 1; linkages, 1 at least

      elite_of_start = 1 + mod(number/2, known)
      if (worker%set%search%by_dyads) elite_of_start = 1 + mod((number/2 - 1)/maxval(worker%dyads), known)
   end function elite_of_start

   !> Keep what was drawn for one dyad; the others become those of a linkage known: the given one, or one of the best so far.
   pure subroutine draw_one_dyad(worker, number, elite, values)
      class(worker_t), intent(in) :: worker
      integer, intent(in) :: number
      real(wp), intent(in) :: elite(:, :)              !! shape (unknowns, any)
      real(wp), intent(inout) :: values(:)             !! shape (nvar): all were drawn
      real(wp) :: known(size(values))

      known = worker%home
      if (size(elite, 2) > 0) known = elite(:size(values), elite_of_start(worker, number, size(elite, 2)))
      where (worker%dyads /= dyad_of_start(worker, number)) values = known
   end subroutine draw_one_dyad

   !> The best linkage of a batch whose proportions and inputs alone are drawn, improved.
   subroutine start_with_batch(self, number, candidate)
      use psalm_random_batch, only: draw_batch
      class(worker_t), intent(inout) :: self
      integer, intent(in) :: number
      type(candidate_t), intent(inout) :: candidate
      real(wp) :: values(size(self%first))

      self%merit%evaluations = 0
      self%merit%jacobians = 0
      call look_from_first_input(self)
      call self%random%use_stream(number)
      call draw_batch(self%problem, self%merit, self%timing, merge(2, 1, goes_either_way(self)), [self%sense, -self%sense], &
                      self%solver, self%stop, self%set%method%istart + number, self%random, values, self%way, self%hasty, &
                      self%turning)
      if (self%hasty) then
         call weigh(self, values, candidate)
      else
         call improve(self, rough_free, number, values, candidate)
      end if
      call put_down(self, values, 0, candidate)
   end subroutine start_with_batch

   !> The linkage of a start, and what it cost.
   subroutine put_down(worker, values, before, candidate)
      class(worker_t), intent(inout) :: worker
      real(wp), intent(inout) :: values(:)
      integer, intent(in) :: before                    !! evaluations made before those that the merit has counted
      type(candidate_t), intent(inout) :: candidate

      call unwind(worker, values)
      candidate%x = worker%merit%point(values, worker%merit%delt)
      candidate%evaluations = before + worker%merit%evaluations
      candidate%jacobians = worker%merit%jacobians
   end subroutine put_down

   !> The best linkage of a batch of random four-bars that pass the points; what is refined of them is decided later.
   subroutine start_freely(self, number, candidate)
      class(worker_t), intent(inout) :: self
      integer, intent(in) :: number
      type(candidate_t), intent(inout) :: candidate
      real(wp) :: values(size(self%first))
      logical :: made

      self%merit%evaluations = 0
      self%merit%jacobians = 0
      call look_from_first_input(self)
      call self%random%use_stream(number)
      call make_free_start(self%problem, self%merit, self%random, self%free_start(self%way), values, self%merit%delt, made)
      values = min(max(values, self%merit%low), self%merit%high)
      call weigh(self, values, candidate)
      candidate%feasible = candidate%feasible .and. made
      call put_down(self, values, 0, candidate)
   end subroutine start_freely

   !> What a linkage is worth as it is, at the merit's inputs.
   subroutine weigh(worker, values, candidate)
      class(worker_t), intent(inout) :: worker
      real(wp), intent(in) :: values(:)
      type(candidate_t), intent(inout) :: candidate
      type(margin_t), allocatable :: margins(:)

      candidate%x = worker%merit%point(values, worker%merit%delt)
      call worker%merit%accept(candidate%x, candidate%objective, candidate%feasible)
      if (.not. candidate%feasible .or. worker%merit%irange == range_positions) return
      call inspect(worker%inspector, worker%merit%dimensions, worker%merit%delt, margins, hasty=.true.)
      candidate%feasible = .not. any(is_violated(margins))
   end subroutine weigh

   !> Turn a random linkage within the box into one near a given one: every value within 1/2**fineness of itself, or of a right
   !> angle.
   pure subroutine draw_near(problem, best, low, high, fineness, values)
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: best(:), low(:), high(:)
      integer, intent(in) :: fineness
      real(wp), intent(inout) :: values(:)
      real(wp) :: reach, deviate
      integer :: v

      do v = 1, size(values)
         deviate = 0.0_wp
         if (abs(high(v) - low(v)) > 0.0_wp) deviate = 2.0_wp*(values(v) - low(v))/(high(v) - low(v)) - 1.0_wp
         select case (problem%parameters%variables(v)%kind)
         case (variable_length, variable_outlk, variable_origlk, variable_aside)
            reach = abs(best(v))
         case default
            reach = right_angle
         end select
         if (problem%mechanism%sliding_input .and. problem%parameters%variables(v)%kind == variable_crnki) reach = abs(best(v))
         values(v) = best(v) + reach*deviate*0.5_wp**fineness
      end do
   end subroutine draw_near

   !> The input pivot at a positive distance, as far as the bounds allow: at a negative one it lies in the opposite direction.
   pure subroutine turn_pivot(worker, values)
      class(worker_t), intent(in) :: worker
      real(wp), intent(inout) :: values(:)
      integer :: distance, direction
      real(wp) :: turned

      associate (kind => worker%problem%parameters%variables%kind, low => worker%merit%low, high => worker%merit%high)
         distance = findloc(kind, variable_origlk, dim=1)
         direction = findloc(kind, variable_origng, dim=1)
         if (min(distance, direction) == 0) return
         if (values(distance) >= 0.0_wp .or. -values(distance) > high(distance)) return
         turned = values(direction) + sign(0.5_wp*full_turn, worker%first(direction) - values(direction))
         if (turned < low(direction) .or. turned > high(direction)) return
         values(distance) = -values(distance)
         values(direction) = turned
      end associate
   end subroutine turn_pivot

   !> Angles without bounds are reported within half a turn of the first ones; so are those that linear unknowns turn, as
   !> far as their bounds allow.
   pure subroutine unwind(worker, values)
      class(worker_t), intent(in) :: worker
      real(wp), intent(inout) :: values(:)
      real(wp) :: near(size(values))
      logical :: turns(size(values))

      call turn_pivot(worker, values)
      if (worker%set%limits%limval /= 0 .and. .not. allocated(worker%merit%linear)) return
      associate (kind => worker%problem%parameters%variables%kind)
         turns = kind == variable_gama .or. kind == variable_outang .or. kind == variable_origng .or. &
                 kind == variable_aside_angle .or. &
                 (kind == variable_crnki .and. .not. worker%problem%mechanism%sliding_input)
      end associate
      near = values - full_turn*anint((values - worker%first)/full_turn)
      where (turns .and. near >= worker%merit%low .and. near <= worker%merit%high) values = near
   end subroutine unwind

   !> Search on from what a start led to.
   subroutine refine(self, thorough, candidate)
      class(worker_t), intent(inout) :: self
      logical, intent(in) :: thorough
      type(candidate_t), intent(inout) :: candidate
      type(candidate_t) :: finer
      real(wp), allocatable :: values(:)

      call forget_sides(self%merit)
      values = candidate%x(:self%merit%core)
      if (self%merit%free) self%merit%delt = candidate%x(self%merit%core + 1:)
      if (goes_either_way(self)) then
         associate (delt => self%merit%delt)
            call go(self, merge(1, 2, self%sense*(delt(size(delt)) - delt(1)) >= 0.0_wp))
         end associate
      end if
      self%merit%evaluations = candidate%evaluations
      self%merit%jacobians = candidate%jacobians
      if (self%merit%has_range) call set_range(self%merit, [real(wp) ::])
      self%solver%hasty = .true.
      call improve(self, merge(fine, settling, thorough), 1, values, finer)
      self%solver%hasty = .false.
      if (finer%feasible .and. finer%objective <= candidate%objective) then
         call unwind(self, values)
         candidate%x = self%merit%point(values, self%merit%delt)
         candidate%objective = finer%objective
      end if
      if (thorough) call hold_default_bounds(self, candidate)
      candidate%evaluations = self%merit%evaluations
      candidate%jacobians = self%merit%jacobians
   end subroutine refine

   !> A result whose lengths have run away, though the data set gives no bounds, is searched on within the default ones.
   subroutine hold_default_bounds(worker, candidate)
      class(worker_t), intent(inout) :: worker
      type(candidate_t), intent(inout) :: candidate
      type(candidate_t) :: held
      real(wp), allocatable :: low(:), high(:), values(:)

      associate (merit => worker%merit)
         values = candidate%x(:merit%core)
         if (.not. any(merit%by_default .and. (values < merit%default_low .or. values > merit%default_high))) return
         low = merit%low
         high = merit%high
         merit%low = merit%default_low
         merit%high = merit%default_high
         values = min(max(values, merit%low), merit%high)
         if (merit%free) merit%delt = candidate%x(merit%core + 1:)
         if (merit%has_range) call set_range(merit, [real(wp) ::])
         held = candidate
         call improve(worker, fine, 1, values, held)
         merit%low = low
         merit%high = high
         ! a search that had to end before it began knows nothing of the linkage within the bounds
         if (worker%stop%waiting()) return
         ! where none obeys within the bounds the result stays as it is: it does
         candidate%strayed = candidate%feasible .and. .not. held%feasible
         if (candidate%strayed) return
         call unwind(worker, values)
         candidate = held
         candidate%x = merit%point(values, merit%delt)
      end associate
   end subroutine hold_default_bounds

   !> The random linkage of a start, from the stream of its number.
   pure subroutine draw(random, low, high, by_ratio, number, values)
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(in) :: low(:), high(:)
      logical, intent(in) :: by_ratio(:)          !! shape (nvar): in every other start all ratios are alike, not all lengths
      integer, intent(in) :: number
      real(wp), allocatable, intent(out) :: values(:)
      real(wp) :: deviate
      integer :: v

      allocate (values(size(low)))
      call random%use_stream(number)
      do v = 1, size(low)
         call random%next(deviate)
         values(v) = low(v) + deviate*(high(v) - low(v))
         if (by_ratio(v) .and. mod(number, 2) == 1) values(v) = low(v)*fractional_power(high(v)/low(v), deviate)
      end do
   end subroutine draw

   !> Improve, look for a better timing, inspect the range of the input; go back to work on what is found.
   subroutine improve(worker, least_gain, number, found, candidate, most)
      class(worker_t), intent(inout) :: worker
      real(wp), intent(in) :: least_gain               !! of a step of least squares
      integer, intent(in) :: number
      real(wp), intent(inout) :: found(:)              !! shape (nvar): the linkage; its input increments are the merit's
      type(candidate_t), intent(inout) :: candidate
      integer, intent(in), optional :: most            !! evaluations of each descent
      type(margin_t), allocatable :: margins(:)
      real(wp), allocatable :: extra(:), values(:), delt(:)
      real(wp) :: objective
      integer :: round
      logical :: feasible

      allocate (extra(0))
      call run_solver(found, candidate%objective, candidate%feasible)
      if (worker%early) return
      if (worker%merit%free .and. worker%set%search%solver%refines) then
         do round = 1, most_returns
            values = found
            delt = worker%merit%delt
            call retime(worker, values)
            call run_solver(values, objective, feasible)
            if (feasible .and. (.not. candidate%feasible .or. objective < candidate%objective*(1.0_wp - worth_it))) then
               found = values
               candidate%objective = objective
               candidate%feasible = .true.
            else
               worker%merit%delt = delt
               exit
            end if
         end do
      end if
      if (worker%merit%irange == range_positions .or. .not. candidate%feasible) return
      do round = 0, most_returns
         call worker%problem%parameters%apply(found, worker%merit%dimensions)
         call inspect(worker%inspector, worker%merit%dimensions, worker%merit%delt, margins, hasty=.true.)
         candidate%feasible = .not. any(is_violated(margins))
         if (candidate%feasible) return
         if (round == most_returns .or. size(extra) >= extra_positions) return
         extra = [extra, pack(margins%delt, is_violated(margins))]
         call set_range(worker%merit, extra)
         call run_solver(found, candidate%objective, candidate%feasible)
         if (.not. candidate%feasible) return
      end do

   contains

      subroutine run_solver(x, f, valid)
         real(wp), intent(inout) :: x(:)
         real(wp), intent(out) :: f
         logical, intent(out) :: valid
         type(ending_t) :: ending
         real(wp), allocatable :: point(:)

         worker%solver%most_evaluations = 0
         if (present(most)) worker%solver%most_evaluations = most
         associate (limit => int(min(real(worker%stage, wp)*real(worker%set%search%maxeval, wp), real(huge(1), wp))))
            if (limit > 0) worker%solver%most_evaluations = min(max(1, limit - worker%merit%evaluations), &
                                                       merge(worker%solver%most_evaluations, huge(1), present(most)))
         end associate
         worker%solver%least_gain = least_gain
         worker%solver%seed = worker%set%method%istart + number
         point = worker%merit%point(x, worker%merit%delt)
         call worker%solver%minimise(worker%merit, point, worker%stop, ending)
         x = point(:size(x))
         if (worker%merit%free) worker%merit%delt = point(size(x) + 1:)
         f = ending%objective
         valid = ending%feasible
         if (ending%reason == stop_refused) candidate%refused = .true.
      end subroutine run_solver
   end subroutine improve

   !> Give the merit the timing that fits the linkage best, seen over the whole range of the input.
   subroutine retime(worker, values)
      class(worker_t), intent(inout) :: worker
      real(wp), intent(in) :: values(:)

      call worker%problem%parameters%apply(values, worker%merit%dimensions)
      call find_timing(worker%timing(worker%way), worker%merit, worker%merit%delt)
   end subroutine retime

   !> Which variables are lengths; all, if none is.
   pure function is_length(problem) result(lengths)
      type(problem_t), intent(in) :: problem
      logical, allocatable :: lengths(:)

      lengths = problem%parameters%variables%kind == variable_length .or. problem%parameters%variables%kind == variable_outlk .or. &
                problem%parameters%variables%kind == variable_aside
      if (.not. any(lengths)) lengths = .true.
   end function is_length
end module psalm_search
