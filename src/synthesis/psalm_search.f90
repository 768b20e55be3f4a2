!> Searches from many starts: the user's linkage, supplied ones and others drawn round it, each improved, the best kept.
!>
!> Start i takes its random numbers from a stream of its own, and the linkages found are ranked
!> afterwards: the same input gives the same answer for any number of threads (unless time runs out).
module psalm_search
   use psalm_constr, only: constraints_t, make_constraints, constrain
   use psalm_constraint_group, only: range_positions
   use psalm_data_set, only: data_set_t
   use psalm_elementary, only: fractional_power
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, full_turn, right_angle
   use psalm_margins, only: inspector_t, margin_t, prepare_inspector, inspect, is_violated
   use psalm_merit, only: merit_t, prepare_merit, set_extra, extra_positions
   use psalm_nlp, only: repair_count_t
   use psalm_solver, only: solver_t, ending_t, observer_t, search_state_t, stop_refused
   use psalm_solvers, only: new_solver
   use psalm_stop, only: stop_t
   use psalm_timing, only: timing_t, prepare_timing, find_timing
   use psalm_parameters, only: variable_length, variable_outlk, variable_origlk, variable_crnki, variable_gama, &
                               variable_outang, variable_origng
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: found_t, result_t, start_record_t, search_many

   real(wp), parameter :: same_linkage = 1.0e-3_wp !! relative difference below which two results are one
   real(wp), parameter :: alike = 0.1_wp           !! the same for linkages to draw near: they are to differ
   integer, parameter :: most_returns = 4          !! times a search goes back to work on what an inspection found
   real(wp), parameter :: rough = 1.0e-3_wp        !! relative gain of a step that ends the search of a start ...
   real(wp), parameter :: rough_free = 1.0e-5_wp   !! ... with free timing, whose valleys are long ...
   real(wp), parameter :: fine = 1.0e-9_wp         !! ... and that of the best, which are searched on
   integer, parameter :: most_rounds = 8           !! a later round draws every other start near the best so far
   real(wp), parameter :: wide = 10.0_wp           !! ratio of the bounds of a length above which ratios are drawn
   integer, parameter :: fineness = 5              !! near: by a half, a quarter ... a 32nd
   integer, parameter :: least_of_round = 16       !! starts
   integer, parameter :: least_refined = 8         !! starts searched on, at least
   real(wp), parameter :: worth_it = 1.0e-6_wp     !! relative gain for which another timing is tried

   !> A linkage found.
   type :: found_t
      real(wp), allocatable :: values(:)   !! shape (marble)
      real(wp), allocatable :: delt(:)     !! shape (positions): input increments (those given, but for free timing)
      real(wp) :: objective = 0.0_wp
      integer :: start = 0                 !! the start that led to it; -j: the j-th supplied vertex
      integer :: place = 0                 !! of its outcome
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
      type(start_record_t), allocatable :: log(:) !! of the starts made
   end type result_t

   !> What one start led to.
   type :: outcome_t
      real(wp), allocatable :: values(:), delt(:)
      real(wp) :: objective = 0.0_wp
      integer :: evaluations = 0, jacobians = 0
      logical :: done = .false., feasible = .false.
      logical :: refused = .false.         !! the solver refuses this problem
   end type outcome_t

   !> What one thread works with.
   type :: worker_t
      ! allocated: together they would fill a small stack
      type(problem_t), allocatable :: problem
      type(constraints_t), allocatable :: constraints
      type(merit_t), allocatable :: merit
      type(timing_t), allocatable :: timing
      type(inspector_t), allocatable :: inspector
      class(solver_t), allocatable :: solver
      type(stop_t) :: stop
      type(xoshiro_t) :: random
   end type worker_t

contains

   !> Search from the supplied vertices and NSTART starts. `first` is the user's linkage.
   subroutine search_many(set, problem, first, supplied, threads, stop, result, observer)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: first(:)          !! shape (marble)
      real(wp), intent(in) :: supplied(:, :)    !! shape (marble, supplied)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop         !! asked now and then
      type(result_t), intent(out) :: result
      class(observer_t), intent(inout), optional :: observer
      type(worker_t), allocatable, target :: workers(:)
      type(outcome_t), allocatable :: outcomes(:)
      type(search_state_t) :: state
      type(stop_t) :: ending
      real(wp), allocatable :: elite(:, :)
      integer :: t, i, extra, total, round, rounds, begin, until

      ending = stop
      call ending%limit_time(set%search%maxtime)
      allocate (result%best(0))
      begin = 0
      extra = size(supplied, 2)
      total = extra + set%search%nstart
      allocate (outcomes(total), workers(min(max(1, threads), total)))
      do t = 1, size(workers)
         allocate (workers(t)%problem, source=problem)
         allocate (workers(t)%constraints, workers(t)%merit, workers(t)%timing, workers(t)%inspector)
         call make_constraints(set, problem, workers(t)%constraints)
         call prepare_merit(set, problem, first, workers(t)%merit)
         workers(t)%stop = ending
         call workers(t)%random%seed(set%istart, purpose_starts)
         call new_solver(set%search%solver, workers(t)%solver)
         if (workers(t)%merit%free) call prepare_timing(problem, workers(t)%merit, workers(t)%timing)
         if (workers(t)%merit%irange /= range_positions) call prepare_inspector(set, problem, .true., workers(t)%inspector)
      end do
      state%limit = total
      state%best = huge(1.0_wp)
      rounds = min(most_rounds, max(1, set%search%nstart/least_of_round))
      do round = 1, rounds
         until = extra + (set%search%nstart*round)/rounds
         allocate (elite(size(first), size(result%best)))
         do i = 1, size(result%best)
            elite(:, i) = result%best(i)%values
         end do
         !$omp parallel do num_threads(size(workers)) schedule(static)
         do t = 1, size(workers)
            if (t == 1) then
               call make_starts(set, workers(t), begin + t, until, size(workers), first, supplied, elite, outcomes, state, observer)
            else
               call make_starts(set, workers(t), begin + t, until, size(workers), first, supplied, elite, outcomes)
            end if
         end do
         !$omp end parallel do
         begin = until
         deallocate (elite)
         call rank(set, is_length(problem), first, extra, max(least_refined, set%search%nbest), alike, outcomes, result%best)
      end do
      result%starts = count(outcomes%done)
      result%feasible = count(outcomes%feasible)
      result%refused = any(outcomes%refused)
      i = findloc(outcomes(extra + 1:)%done, .false., dim=1)
      if (i > 0) result%next = set%search%first + i - 1
      if (set%search%solver%refines .and. .not. ending%waiting()) then
         !$omp parallel do num_threads(size(workers)) schedule(static) private(i)
         do t = 1, size(workers)
            do i = t, size(result%best), size(workers)
               call refine(set, workers(t), first, outcomes(result%best(i)%place))
            end do
         end do
         !$omp end parallel do
      end if
      result%interrupted = ending%requested()
      result%out_of_time = ending%late() .and. .not. result%interrupted
      result%evaluations = sum(outcomes%evaluations)
      result%jacobians = sum(outcomes%jacobians)
      call record_starts(set, extra, outcomes, result%log)
      call rank(set, is_length(problem), first, extra, set%search%nbest, same_linkage, outcomes, result%best)
   end subroutine search_many

   !> The starts of one thread: from, from + step ... until.
   subroutine make_starts(set, worker, from, until, step, first, supplied, elite, outcomes, state, observer)
      type(data_set_t), intent(in) :: set
      type(worker_t), intent(inout), target :: worker
      integer, intent(in) :: from, until, step
      real(wp), intent(in) :: first(:), supplied(:, :), elite(:, :)
      type(outcome_t), intent(inout) :: outcomes(:)
      type(search_state_t), intent(inout), optional :: state
      class(observer_t), intent(inout), optional :: observer
      integer :: i, number

      do i = from, until, step
         if (worker%stop%waiting()) return
         number = start_number(set, size(supplied, 2), i)
         if (number < 0) then
            call one_start(set, worker, first, supplied(:, i), number, elite, outcomes(i))
         else
            call one_start(set, worker, first, first, number, elite, outcomes(i))
         end if
         ! what a start that was cut short has is kept, but the start is not done with
         outcomes(i)%done = .not. worker%stop%waiting()
         if (outcomes(i)%refused) return
         if (.not. present(observer)) cycle
         state%iteration = i
         state%evaluations = state%evaluations + outcomes(i)%evaluations*step
         if (outcomes(i)%feasible) state%best = min(state%best, outcomes(i)%objective)
         state%worst = state%best
         call observer%report(state)
      end do
   end subroutine make_starts

   !> What became of the starts that were made.
   pure subroutine record_starts(set, extra, outcomes, log)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: extra
      type(outcome_t), intent(in) :: outcomes(:)
      type(start_record_t), allocatable, intent(out) :: log(:)
      integer :: i, n

      allocate (log(count(outcomes%done .or. outcomes%feasible)))
      n = 0
      do i = 1, size(outcomes)
         if (.not. (outcomes(i)%done .or. outcomes(i)%feasible)) cycle
         n = n + 1
         log(n) = start_record_t(start_number(set, extra, i), outcomes(i)%feasible, outcomes(i)%objective, &
                                 outcomes(i)%evaluations, outcomes(i)%jacobians)
      end do
   end subroutine record_starts

   !> Number of the i-th start; supplied vertices have negative ones.
   pure integer function start_number(set, extra, i)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: extra, i

      start_number = merge(-i, set%search%first + i - extra - 1, i <= extra)
   end function start_number

   !> One start: draw it, make it close where that is easy, improve it, inspect it.
   subroutine one_start(set, worker, first, given, number, elite, outcome)
      type(data_set_t), intent(in) :: set
      type(worker_t), intent(inout), target :: worker
      real(wp), intent(in) :: first(:), given(:)       !! shape (marble): the user's linkage; the one to start from
      integer, intent(in) :: number                    !! 1: start from the user's; above: from one drawn; below: from `given`
      real(wp), intent(in) :: elite(:, :)              !! shape (marble, any): the best linkages of the rounds before
      type(outcome_t), intent(inout) :: outcome
      type(repair_count_t) :: counts
      real(wp), allocatable :: low(:), high(:), home(:)
      real(wp) :: objective
      logical :: closes
      integer :: before

      low = worker%merit%box_low
      high = worker%merit%box_high
      before = 0
      if (number > 1) then
         call draw(worker%random, low, high, low > 0.0_wp .and. high > wide*low .and. is_length(worker%problem), number, &
                   outcome%values)
         if (size(elite, 2) > 0 .and. mod(number, 2) == 1) then
            call draw_near(worker%problem, elite(:, 1 + mod(number/2, size(elite, 2))), low, high, 1 + mod(number/4, fineness), &
                           outcome%values)
         end if
         home = first
         call constrain(worker%problem, worker%constraints, home, objective, closes, before, counts)
         ! every other start keeps its own shape, closed or not; the others draw near the user's until they close
         if (mod(number, 2) == 0 .and. closes) call constrain(worker%problem, worker%constraints, outcome%values, objective, &
                                                              closes, before, counts, towards=home)
      else
         outcome%values = given
         call constrain(worker%problem, worker%constraints, outcome%values, objective, closes, before, counts)
         if (.not. closes) outcome%values = given
      end if
      worker%merit%evaluations = 0
      worker%merit%jacobians = 0
      worker%merit%delt = worker%problem%delt
      if (worker%merit%patrols) call set_extra(worker%merit, [real(wp) ::])
      if (worker%merit%free .and. number /= 1) call retime(worker, outcome%values)
      call work_on(set, worker, merge(rough_free, rough, worker%merit%free), number, outcome)
      call unwind(set, worker%problem, first, outcome%values)
      outcome%delt = worker%merit%delt
      outcome%evaluations = before + worker%merit%evaluations
      outcome%jacobians = worker%merit%jacobians
   end subroutine one_start

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
         case (variable_length, variable_outlk, variable_origlk)
            reach = abs(best(v))
         case default
            reach = right_angle
         end select
         if (problem%mechanism%sliding_input .and. problem%parameters%variables(v)%kind == variable_crnki) reach = abs(best(v))
         values(v) = best(v) + reach*deviate*0.5_wp**fineness
      end do
   end subroutine draw_near

   !> Angles without bounds are told within half a turn of the first ones.
   pure subroutine unwind(set, problem, first, values)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: first(:)
      real(wp), intent(inout) :: values(:)
      logical :: turns(size(values))

      if (set%limval /= 0) return
      associate (kind => problem%parameters%variables%kind)
         turns = kind == variable_gama .or. kind == variable_outang .or. kind == variable_origng .or. &
                 (kind == variable_crnki .and. .not. problem%mechanism%sliding_input)
      end associate
      where (turns) values = values - full_turn*anint((values - first)/full_turn)
   end subroutine unwind

   !> Search on from what a start led to.
   subroutine refine(set, worker, first, outcome)
      type(data_set_t), intent(in) :: set
      type(worker_t), intent(inout), target :: worker
      real(wp), intent(in) :: first(:)
      type(outcome_t), intent(inout) :: outcome
      type(outcome_t) :: finer

      finer%values = outcome%values
      worker%merit%delt = outcome%delt
      worker%merit%evaluations = outcome%evaluations
      worker%merit%jacobians = outcome%jacobians
      if (worker%merit%patrols) call set_extra(worker%merit, [real(wp) ::])
      call work_on(set, worker, fine, 1, finer)
      outcome%evaluations = worker%merit%evaluations
      outcome%jacobians = worker%merit%jacobians
      if (.not. finer%feasible .or. finer%objective > outcome%objective) return
      outcome%values = finer%values
      call unwind(set, worker%problem, first, outcome%values)
      outcome%delt = worker%merit%delt
      outcome%objective = finer%objective
   end subroutine refine

   !> The random linkage of a start, from the stream of its number.
   pure subroutine draw(random, low, high, by_ratio, number, values)
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(in) :: low(:), high(:)
      logical, intent(in) :: by_ratio(:)          !! shape (marble): in every other start all ratios are alike, not all lengths
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
   subroutine work_on(set, worker, least_gain, number, outcome)
      type(data_set_t), intent(in) :: set
      type(worker_t), intent(inout), target :: worker
      real(wp), intent(in) :: least_gain               !! of a step of least squares
      integer, intent(in) :: number
      type(outcome_t), intent(inout) :: outcome
      type(margin_t), allocatable :: margins(:)
      real(wp), allocatable :: extra(:), values(:), delt(:)
      real(wp) :: objective
      integer :: round
      logical :: feasible

      allocate (extra(0))
      call run_solver(outcome%values, outcome%objective, outcome%feasible)
      if (worker%merit%free .and. set%search%solver%refines) then
         do round = 1, most_returns
            values = outcome%values
            delt = worker%merit%delt
            call retime(worker, values)
            call run_solver(values, objective, feasible)
            if (feasible .and. (.not. outcome%feasible .or. objective < outcome%objective*(1.0_wp - worth_it))) then
               outcome%values = values
               outcome%objective = objective
               outcome%feasible = .true.
            else
               worker%merit%delt = delt
               exit
            end if
         end do
      end if
      if (worker%merit%irange == range_positions .or. .not. outcome%feasible) return
      do round = 1, most_returns
         call worker%problem%parameters%apply(outcome%values, worker%merit%dimensions)
         call inspect(worker%inspector, worker%merit%dimensions, worker%merit%delt, margins, hasty=.true.)
         outcome%feasible = .not. any(is_violated(margins))
         if (outcome%feasible) return
         if (size(extra) >= extra_positions) return
         extra = [extra, pack(margins%delt, is_violated(margins))]
         call set_extra(worker%merit, extra)
         call run_solver(outcome%values, outcome%objective, outcome%feasible)
         if (.not. outcome%feasible) return
      end do
      outcome%feasible = .false.

   contains

      subroutine run_solver(x, f, sound)
         real(wp), intent(inout) :: x(:)
         real(wp), intent(out) :: f
         logical, intent(out) :: sound
         type(ending_t) :: ending
         real(wp), allocatable :: point(:)

         if (set%search%maxeval > 0) worker%solver%most_evaluations = max(1, set%search%maxeval - worker%merit%evaluations)
         worker%solver%least_gain = least_gain
         worker%solver%seed = set%istart + number
         point = worker%merit%point(x, worker%merit%delt)
         call worker%solver%minimise(worker%merit, point, worker%stop, ending)
         x = point(:size(x))
         if (worker%merit%free) worker%merit%delt = point(size(x) + 1:)
         f = ending%objective
         sound = ending%feasible
         if (ending%reason == stop_refused) outcome%refused = .true.
      end subroutine run_solver
   end subroutine work_on

   !> Give the merit the timing that fits the linkage best, seen over the whole range of the input.
   subroutine retime(worker, values)
      type(worker_t), intent(inout) :: worker
      real(wp), intent(in) :: values(:)

      call worker%problem%parameters%apply(values, worker%merit%dimensions)
      call find_timing(worker%timing, worker%merit, worker%merit%delt)
   end subroutine retime

   !> Sort what was found and keep the best distinct linkages.
   !>
   !> Two results are one linkage if their lengths and objectives agree: it may stand turned in the machine.
   subroutine rank(set, lengths, first, extra, most, same, outcomes, best)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: lengths(:)           !! shape (marble): values to compare
      real(wp), intent(in) :: first(:)
      integer, intent(in) :: extra, most          !! supplied vertices; linkages to keep
      real(wp), intent(in) :: same                !! relative difference below which two are one
      type(outcome_t), intent(in) :: outcomes(:)
      type(found_t), allocatable, intent(out) :: best(:)
      logical :: left(size(outcomes))
      type(found_t) :: next
      integer :: i, k

      allocate (best(0))
      left = outcomes%feasible
      do while (any(left) .and. size(best) < most)
         i = minloc(outcomes%objective, dim=1, mask=left)
         next%values = outcomes(i)%values
         next%delt = outcomes(i)%delt
         next%objective = outcomes(i)%objective
         next%place = i
         next%start = start_number(set, extra, i)
         next%distance = maxval(abs(next%values - first)/max(abs(first), same_linkage))
         best = [best, next]
         do k = 1, size(left)
            if (.not. left(k)) cycle
            left(k) = any(lengths .and. abs(outcomes(k)%values - next%values) > same*abs(next%values)) .or. &
                      outcomes(k)%objective - next%objective > same*max(next%objective, set%fmin)
         end do
         left(i) = .false.
      end do
   end subroutine rank

   !> Which variables are lengths; all, if none is.
   pure function is_length(problem) result(lengths)
      type(problem_t), intent(in) :: problem
      logical, allocatable :: lengths(:)

      lengths = problem%parameters%variables%kind == variable_length .or. problem%parameters%variables%kind == variable_outlk
      if (.not. any(lengths)) lengths = .true.
   end function is_length
end module psalm_search
