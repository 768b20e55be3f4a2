!> Every solver on every data set, from a hundred starts each; and what an iteration of least squares costs.
!>
!> usage: account runs DIRECTORY SEEDS     set | solver | seed | objective (or -1: no linkage) | evaluations | seconds
!>        account scaling DIRECTORY [short]  positions | microseconds of a Jacobian | of an iteration of least squares;
!>                                         short: the fewest positions only
!>        account first DIRECTORY          needle linkage from the published start: least gain of a step | objective | ms
program account
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_constr, only: vertex_problem_t, make_vertex_problem
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp, dp
   use psalm_least_squares, only: least_squares_t
   use psalm_merit, only: merit_t, prepare_merit
   use psalm_search, only: result_t, search_many
   use psalm_setup, only: set_up
   use psalm_simplx, only: simplex_t, search_simplex
   use psalm_solver, only: ending_t, search_state_t
   use psalm_solver_kind, only: solver_kind_t, find_solver
   use psalm_start, only: beginning_t, rules_of, start_simplex
   use psalm_samples, only: linearise_samples
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t, variable_length, variable_outlk, variable_origlk
   implicit none (type, external)

   character(*), parameter :: sets(*) = [character(20) :: 'needle_search', 'needle_unweighted', 'suspension', 'chain_short', &
      'chain_long', 'brake_reaction', 'path18', 'path5', 'log10', 'striking', 'slider_linear', 'dwell', 'line6']
   character(*), parameter :: solvers(*) = [character(20) :: 'SIMPLEX', 'LSQ', 'LD_SLSQP', 'LD_LBFGS', 'LD_AUGLAG', &
      'LN_COBYLA', 'LN_BOBYQA', 'LN_SBPLX', 'LN_NELDERMEAD', 'LN_PRAXIS', 'GN_CRS2_LM', 'GN_ISRES', 'GN_DIRECT_L', 'GD_MLSL_LDS']
   integer, parameter :: most_evaluations = 5000
   real(wp), parameter :: most_seconds = 0.5_wp
   integer, parameter :: most_iterations = 5000      !! of the simplex
   integer, parameter :: repeats = 5
   real(wp), parameter :: longest = 10.0_wp          !! times the longest arc of the data set: bound of lengths where none is given
   real(wp), parameter :: widest = 3600.0_wp         !! likewise of angles, degrees
   character(200) :: task, directory, word
   integer :: seeds

   call get_command_argument(1, task)
   call get_command_argument(2, directory)
   call get_command_argument(3, word)
   select case (task)
   case ('runs')
      read (word, *) seeds
      call all_runs()
   case ('scaling')
      call scaling()
   case ('first')
      call first_start()
   case default
      error stop 'usage: account runs DIRECTORY SEEDS | scaling DIRECTORY | first DIRECTORY'
   end select

contains

   subroutine load(name, set, problem)
      character(*), intent(in) :: name
      type(data_set_t), intent(out) :: set
      type(problem_t), intent(out) :: problem
      type(data_set_t), allocatable :: all_sets(:)
      type(diagnostics_t) :: findings
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      integer :: v

      call read_data_sets(trim(directory)//'/'//trim(name)//'.nml', all_sets, findings)
      if (.not. findings%failed()) then
         set = all_sets(1)
         call set_up(set, mechanism, dimensions, parameters, findings)
      end if
      if (findings%failed()) error stop 'a data set cannot be read'
      call make_problem(set, mechanism, dimensions, parameters, problem)
      if (set%limits%limval /= 0) return
      ! some searches run away to links of infinite length, which are slides
      set%limits%limval = 1
      do v = 1, size(parameters%variables)
         set%limits%oplow(v) = -widest
         set%limits%ophigh(v) = widest
         if (all(parameters%variables(v)%kind /= [variable_length, variable_outlk, variable_origlk])) cycle
         set%limits%oplow(v) = 0.0_wp
         set%limits%ophigh(v) = longest*maxval(dimensions%arcl)
      end do
   end subroutine load

   real(dp) function seconds()
      integer(int64) :: now, rate

      call system_clock(now, rate)
      seconds = real(now, dp)/real(rate, dp)
   end function seconds

   subroutine all_runs()
      type(data_set_t) :: set
      type(problem_t) :: problem
      type(solver_kind_t) :: kind
      integer :: s, k, seed, evaluations
      real(dp) :: begun
      real(wp) :: objective

      do s = 1, size(sets)
         do k = 1, size(solvers)
            call load(sets(s), set, problem)
            ! the simplex of the thesis knows no free timing
            kind = find_solver(solvers(k))
            if (set%method%ifree /= 0 .and. .not. kind%many_starts) cycle
            do seed = 1, seeds
               set%method%istart = 19 + 2*seed
               begun = seconds()
               if (.not. kind%many_starts) then
                  call run_simplex(set, problem, objective, evaluations)
               else
                  set%search%solver = kind
                  call run_other(set, problem, objective, evaluations)
               end if
               print '(a,"|",a,"|",i0,"|",es14.7,"|",i0,"|",es10.3)', trim(sets(s)), trim(solvers(k)), seed, objective, &
                  evaluations, seconds() - begun
            end do
         end do
      end do
   end subroutine all_runs

   subroutine run_simplex(given, given_problem, objective, evaluations)
      type(data_set_t), intent(in) :: given
      type(problem_t), intent(in) :: given_problem
      real(wp), intent(out) :: objective
      integer, intent(out) :: evaluations
      type(data_set_t) :: set
      type(problem_t), target :: problem
      type(vertex_problem_t) :: vertices
      type(simplex_t) :: simplex
      type(search_state_t) :: state
      type(beginning_t) :: beginning
      type(stop_t) :: never
      real(wp) :: none(size(given_problem%parameters%variables), 0)
      logical :: feasible

      set = given
      set%method%niter = most_iterations
      set%method%fmin = 0.0_wp
      problem = given_problem
      call make_vertex_problem(set, problem, vertices)
      call start_simplex(set, vertices, none, set%method%istart, simplex, feasible, beginning)
      objective = -1.0_wp
      evaluations = vertices%evaluations
      if (.not. feasible) return
      call search_simplex(rules_of(set), vertices, simplex, never, state)
      objective = state%best
      evaluations = vertices%evaluations
   end subroutine run_simplex

   subroutine run_other(given, problem, objective, evaluations)
      type(data_set_t), intent(in) :: given
      type(problem_t), intent(in) :: problem
      real(wp), intent(out) :: objective
      integer, intent(out) :: evaluations
      type(data_set_t) :: set
      type(result_t) :: result
      type(stop_t) :: never
      real(wp) :: none(size(problem%parameters%variables), 0)

      set = given
      set%search%nstart = 1
      set%search%first = 2             ! a linkage drawn as the simplex draws its vertices
      set%search%nbest = 1
      set%search%maxeval = most_evaluations
      set%search%maxtime = most_seconds
      call search_many(set, problem, problem%parameters%first_values(problem%given), none, 1, never, result)
      objective = -1.0_wp
      if (size(result%best) > 0) objective = result%best(1)%objective
      evaluations = result%evaluations + result%jacobians
   end subroutine run_other

   !> Positions of the needle linkage repeated: what the Jacobian costs, what a whole iteration.
   subroutine scaling()
      type(data_set_t) :: set
      type(problem_t) :: problem
      type(merit_t) :: merit
      real(wp), allocatable :: first(:), values(:)
      type(least_squares_t) :: solver
      type(ending_t) :: ending
      type(stop_t) :: never
      real(dp) :: begun, jacobian, iteration
      integer :: n, power, i, k, calls

      do power = 0, merge(0, 3, word == 'short')
         call load('needle_search', set, problem)
         n = 20*10**power
         associate (delt => [(problem%delt(1 + mod(i, 20)), i=0, n - 1)], &
                    wanted => [(problem%wanted(1 + mod(i, 20), 1), i=0, n - 1)], &
                    weight => [(problem%weight(1 + mod(i, 20), 1), i=0, n - 1)])
            call problem%set_inputs(delt)
            call problem%set_desired(reshape(wanted, [n, 1]), reshape(weight, [n, 1]))
         end associate
         first = problem%parameters%first_values(problem%given)
         jacobian = huge(jacobian)
         iteration = huge(iteration)
         do k = 1, repeats
            call prepare_merit(set, problem, first, merit)
            calls = max(1, 20000/n)
            begun = seconds()
            do i = 1, calls
               call linearise_samples(merit%main, merit%dimensions)
            end do
            jacobian = min(jacobian, (seconds() - begun)/real(calls, dp))
            values = first
            begun = seconds()
            call solver%minimise(merit, values, never, ending)
            iteration = min(iteration, (seconds() - begun)/real(merit%jacobians, dp))
         end do
         print '(i0,"|",f0.2,"|",f0.2)', n, 1.0e6_dp*jacobian, 1.0e6_dp*iteration
      end do
   end subroutine scaling

   !> Needle linkage from the published start: how low, how soon.
   subroutine first_start()
      type(data_set_t) :: set
      type(problem_t) :: problem
      type(merit_t) :: merit
      real(wp), allocatable :: first(:), values(:)
      type(least_squares_t) :: solver
      type(ending_t) :: ending
      type(stop_t) :: never
      real(dp) :: begun, least
      integer :: digits, k

      do digits = 2, 8, 2
         call load('needle_search', set, problem)
         first = problem%parameters%first_values(problem%given)
         least = huge(least)
         do k = 1, repeats
            begun = seconds()
            call prepare_merit(set, problem, first, merit)
            values = first
            solver%least_gain = 10.0_wp**(-digits)
            call solver%minimise(merit, values, never, ending)
            least = min(least, seconds() - begun)
         end do
         if (.not. ending%feasible) ending%objective = -1.0_wp
         print '(es7.1,"|",f0.6,"|",f0.2)', 10.0_wp**(-digits), ending%objective, 1.0e3_dp*least
      end do
   end subroutine first_start
end program account
