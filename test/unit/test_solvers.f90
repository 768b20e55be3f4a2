!> Solvers and many starts on problems of the literature, without any linkage.
program test_solvers
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, c_null_char, c_ptr
   use, intrinsic :: ieee_exceptions, only: ieee_all, ieee_set_flag, ieee_set_halting_mode
   use check, only: checks_t
   use climber, only: climber_t
   use psalm_kinds, only: wp
   use psalm_multistart, only: candidate_t, multistart_t
   use psalm_nlp, only: nlp_t, normal_equations_t
   use psalm_solver, only: solver_t, ending_t, stop_refused, stop_interrupted, stop_converged
   use psalm_solver_kind, only: solver_kind_t, find_solver, solver_names, plain_name, family_unknown, family_simplex, &
                                family_least_squares, family_nlopt
   use psalm_solvers, only: new_solver
   use psalm_stop, only: stop_t
   use psalm_text, only: to_text
   use psalm_xoshiro, only: purpose_starts
   use watcher, only: watcher_t, bare_t, bare
   use textbook, only: rosenbrock_t, rosen_suzuki_t, hock_schittkowski_100_t, circle_t, timed_circle_t, rosenbrock, himmelblau, &
                       rosen_suzuki, hock_schittkowski_100, circle, timed_circle, whole_circle_t, whole_circle, contradiction_t, &
                       contradiction
   implicit none (type, external)
   type(checks_t) :: t
   character(:), allocatable :: name
   integer :: k, made
   !> Algorithms whose random or coarse search comes near a minimum only.
   character(*), parameter :: coarse(*) = [character(16) :: 'GN_ESCH', 'GN_ISRES']
   !> Not in every build of NLopt.
   character(*), parameter :: left_out(*) = [character(16) :: 'GD_STOGO', 'GD_STOGO_RAND', 'LD_LBFGS_NOCEDAL', 'GN_AGS']

   ! some of NLopt's algorithms divide by zero on their way
   call ieee_set_halting_mode(ieee_all, .false.)
   call names()
   made = 0
   associate (all_names => solver_names())
      do k = 1, size(all_names)
         name = trim(all_names(k))
         call unconstrained(name, made)
         call constrained(name)
      end do
      call t%is_true(made >= size(all_names) - size(left_out), 'every solver was tried')
   end associate
   call no_sum_of_squares()
   call local_unknowns()
   call elimination()
   call nothing_obeys()
   call evaluations()
   call reports()
   call function_alone()
   call gradient_of_squares()
   call stops()
   call many_starts()
   call ieee_set_flag(ieee_all, .false.)
   call t%report()

contains

   !> Names, and what each says.
   subroutine names()
      type(solver_kind_t) :: kind
      integer :: i

      call t%is_true(family_of('LD_SLSPQ') == family_unknown, 'a name that no solver has')
      call t%is_true(family_of('simplex') == family_simplex .and. family_of('LSQ') == family_least_squares, &
                     'SIMPLEX and LSQ')
      call t%equal_text(plain_name('nlopt_gn_crs2_lm'), 'GN_CRS2_LM', 'a plain name')
      call t%is_true(family_of('nlopt_ld_mma') == family_nlopt, 'NLOPT_ may stand before a name')
      kind = find_solver('GN_CRS2_LM')
      call t%is_true(kind%global .and. .not. kind%uses_gradient .and. .not. kind%takes_constraints, 'what GN_CRS2_LM can do')
      kind = find_solver('LD_SLSQP')
      call t%is_true(kind%uses_gradient .and. kind%takes_constraints .and. .not. kind%global, 'what LD_SLSQP can do')
      kind = find_solver('GD_MLSL')
      call t%is_true(kind%global .and. kind%uses_gradient .and. kind%calls_another, 'what GD_MLSL can do')
      ! NLopt's own list
      associate (known => algorithm_names())
         call t%is_true(size(known) > 30, 'NLopt has algorithms')
         do i = 1, size(known)
            call t%is_true(family_of(known(i)) == family_nlopt, 'NLopt''s '//trim(known(i))//' is known')
         end do
      end associate
   end subroutine names

   !> The names of all algorithms that the library has.
   function algorithm_names() result(known)
      integer, parameter :: name_length = 32        !! characters of the longest name, and some
      integer, parameter :: most_algorithms = 200 !! a bound for the search of their names
      character(name_length), allocatable :: known(:)
      character(kind=c_char), pointer :: letters(:)
      type(c_ptr) :: address
      integer :: i, k
      interface
         type(c_ptr) function nlopt_algorithm_to_string(algorithm) bind(c)
            import :: c_int, c_ptr
            implicit none (type, external)
            integer(c_int), value :: algorithm
         end function nlopt_algorithm_to_string
      end interface

      allocate (known(0))
      do i = 0, most_algorithms
         address = nlopt_algorithm_to_string(int(i, c_int))
         if (.not. c_associated(address)) exit
         call c_f_pointer(address, letters, [name_length])
         known = [character(name_length) :: known, '']
         do k = 1, name_length
            if (letters(k) == c_null_char) exit
            known(size(known))(k:k) = letters(k)
         end do
      end do
   end function algorithm_names

   integer function family_of(name)
      character(*), intent(in) :: name
      type(solver_kind_t) :: kind

      kind = find_solver(name)
      family_of = kind%family
   end function family_of

   subroutine run(name, problem, x, ending, stop)
      character(*), intent(in) :: name
      class(nlp_t), intent(inout) :: problem
      real(wp), intent(inout) :: x(:)
      type(ending_t), intent(out) :: ending
      type(stop_t), intent(in), optional :: stop
      class(solver_t), allocatable :: solver
      type(stop_t) :: never

      call new_solver(find_solver(name), solver)
      solver%seed = 7
      if (present(stop)) then
         call solver%minimise(problem, x, stop, ending)
      else
         call solver%minimise(problem, x, never, ending)
      end if
   end subroutine run

   !> Rosenbrock's valley.
   subroutine unconstrained(name, made)
      character(*), intent(in) :: name
      integer, intent(inout) :: made
      type(rosenbrock_t) :: problem
      type(ending_t) :: ending
      real(wp) :: x(2)

      problem = rosenbrock()
      x = [-1.2_wp, 1.0_wp]
      call run(name, problem, x, ending)
      if (ending%reason == stop_refused) then
         call t%is_true(any(left_out == name), name//' is made')
         return
      end if
      made = made + 1
      call t%is_true(ending%feasible, name//', Rosenbrock: within bounds')
      if (any(coarse == name)) then
         call t%is_true(ending%objective < 0.2_wp, name//', Rosenbrock: near the minimum')
      else
         call t%close_to(ending%objective, 0.0_wp, 1.0e-5_wp, name//', Rosenbrock: the minimum')
         call t%close_to(maxval(abs(x - 1.0_wp)), 0.0_wp, 1.0e-2_wp, name//', Rosenbrock: its place')
      end if
   end subroutine unconstrained

   !> The problem of Rosen and Suzuki, by the solvers that take constraints.
   subroutine constrained(name)
      character(*), intent(in) :: name
      type(rosen_suzuki_t) :: problem
      type(ending_t) :: ending
      type(solver_kind_t) :: kind
      real(wp) :: x(4), c(3)
      real(wp), parameter :: added = 79.875_wp

      kind = find_solver(name)
      if (kind%family == family_nlopt .and. .not. kind%takes_constraints) return
      ! their local solver takes equalities out only
      if (index(name, 'AUGLAG_EQ') > 0) return
      problem = rosen_suzuki()
      x = 0.0_wp
      call run(name, problem, x, ending)
      call problem%constraints_at(x, c)
      call t%is_true(ending%feasible .and. all(c <= 0.0_wp), name//', Rosen-Suzuki: every constraint is kept')
      if (any(coarse == name) .or. kind%family == family_simplex) then
         call t%is_true(ending%objective - added < -30.0_wp .and. ending%objective - added >= -44.0_wp, &
                        name//', Rosen-Suzuki: near the minimum')
      else
         call t%close_to(ending%objective - added, -44.0_wp, 1.0e-6_wp, name//', Rosen-Suzuki: the minimum')
         call t%close_to(maxval(abs(x - [0.0_wp, 1.0_wp, 2.0_wp, -1.0_wp])), 0.0_wp, 1.0e-3_wp, name//', Rosen-Suzuki: its place')
      end if
   end subroutine constrained

   !> Problem 100 of Hock and Schittkowski; least squares refuses it.
   subroutine no_sum_of_squares()
      type(hock_schittkowski_100_t) :: problem
      type(ending_t) :: ending
      real(wp) :: x(7)
      real(wp), parameter :: first(7) = [1.0_wp, 2.0_wp, 0.0_wp, 4.0_wp, 0.0_wp, 1.0_wp, 1.0_wp]
      character(*), parameter :: able(*) = [character(9) :: 'LD_SLSQP', 'LD_MMA', 'LN_COBYLA']
      integer :: i

      problem = hock_schittkowski_100()
      x = first
      call run('LSQ', problem, x, ending)
      call t%is_true(ending%reason == stop_refused .and. all(abs(x - first) <= 0.0_wp), 'least squares needs a sum of squares')
      do i = 1, size(able)
         problem = hock_schittkowski_100()
         x = first
         call run(trim(able(i)), problem, x, ending)
         call t%is_true(ending%feasible .and. ending%reason == stop_converged, trim(able(i))//', problem 100: converged')
         call t%close_to(ending%objective, 680.6300573_wp, 1.0e-7_wp, trim(able(i))//', problem 100: the minimum')
      end do
   end subroutine no_sum_of_squares

   !> A circle through scattered points: with the place of each as a local unknown, and without.
   subroutine local_unknowns()
      real(wp), parameter :: px(*) = [1.0_wp, 2.0_wp, 5.0_wp, 7.0_wp, 9.0_wp, 3.0_wp], &
                             py(*) = [7.0_wp, 6.0_wp, 8.0_wp, 7.0_wp, 5.0_wp, 7.0_wp]
      ! Gander, Golub and Strebel (1994), Least-squares fitting of circles and ellipses: their geometric fit
      real(wp), parameter :: published(3) = [4.7398_wp, 2.9835_wp, 4.7142_wp]
      type(circle_t) :: plain
      type(timed_circle_t) :: timed
      type(ending_t) :: one, two
      real(wp) :: x(3), y(3 + size(px))

      plain = circle(px, py)
      x = [5.0_wp, 3.0_wp, 4.0_wp]
      call run('LSQ', plain, x, one)
      call t%close_to(maxval(abs(x - published)), 0.0_wp, 6.0e-5_wp, 'the circle nearest to six points')
      timed = timed_circle(px, py)
      y(:3) = [5.0_wp, 3.0_wp, 4.0_wp]
      y(4:) = atan2(py - 3.0_wp, px - 5.0_wp)
      call run('LSQ', timed, y, two)
      call t%close_to(two%objective, one%objective, 1.0e-8_wp, 'local unknowns: the same minimum')
      call t%close_to(maxval(abs(y(:3) - x)), 0.0_wp, 1.0e-3_wp, 'local unknowns: the same circle')
      call run('LD_LBFGS', timed, y, two)
      call t%close_to(two%objective, one%objective, 1.0e-8_wp, 'local unknowns: by their gradient too')
   end subroutine local_unknowns

   !> Local unknowns taken out of the equations or left in them: the same steps, one by one and to the end.
   subroutine elimination()
      real(wp), parameter :: turn(*) = [0.3_wp, 1.1_wp, 1.9_wp, 3.0_wp, 4.4_wp, 5.6_wp]
      type(timed_circle_t) :: timed
      type(whole_circle_t) :: whole
      class(solver_t), allocatable :: solver
      type(ending_t) :: one, two
      type(stop_t) :: never
      real(wp) :: x(3 + size(turn)), y(3 + size(turn))
      integer :: steps

      call new_solver(find_solver('LSQ'), solver)
      do steps = 1, 5
         ! the points lie on a circle: no residual is left in the end
         timed = timed_circle(4.0_wp + 2.5_wp*cos(turn), 1.0_wp + 2.5_wp*sin(turn))
         whole = whole_circle(timed%px, timed%py)
         timed%floor = 1.0e-20_wp
         whole%floor = 1.0e-20_wp
         x(:3) = [3.5_wp, 1.4_wp, 2.0_wp]
         x(4:) = turn + 0.2_wp
         y = x
         ! two evaluations before the first step, one for each; in the end as many as it takes
         solver%most_evaluations = merge(steps + 2, 0, steps < 5)
         call solver%minimise(timed, x, never, one)
         call solver%minimise(whole, y, never, two)
         call t%close_to(maxval(abs(x - y)), 0.0_wp, 1.0e-9_wp, 'local unknowns eliminated or not: the same step')
         call t%equal_integer(timed%evaluations, whole%evaluations, 'local unknowns eliminated or not: as many evaluations')
         call t%equal_integer(one%reason, two%reason, 'local unknowns eliminated or not: the same end')
      end do
      call t%close_to(maxval(abs(x(:3) - [4.0_wp, 1.0_wp, 2.5_wp])), 0.0_wp, 1.0e-9_wp, 'the circle the points lie on')
   end subroutine elimination

   !> Constraints that nothing obeys: what comes back violates them next to least, and is marked as violating them.
   subroutine nothing_obeys()
      type(contradiction_t) :: problem
      type(ending_t) :: ending
      real(wp) :: x(2), c(1)
      integer :: i
      character(*), parameter :: some(*) = [character(9) :: 'LN_COBYLA', 'LD_SLSQP', 'LN_SBPLX', 'LD_LBFGS', 'LSQ']

      do i = 1, size(some)
         problem = contradiction()
         x = [8.0_wp, -6.0_wp]
         call run(trim(some(i)), problem, x, ending)
         call problem%constraints_at(x, c)
         call t%is_true(.not. ending%feasible, trim(some(i))//': told where nothing obeys')
         call t%close_to(c(1), 1.0_wp, 0.01_wp, trim(some(i))//': where nothing obeys, the least violation')
      end do
   end subroutine nothing_obeys

   !> No more evaluations than a search is given: one more is the verdict on what it found.
   subroutine evaluations()
      type(rosenbrock_t) :: problem
      type(ending_t) :: ending
      type(stop_t) :: never
      class(solver_t), allocatable :: solver
      real(wp) :: x(2)
      integer :: i
      integer, parameter :: given = 30
      !> Those of Luksan may make one more before they look whether they are to stop.
      character(*), parameter :: tardy(*) = [character(26) :: 'LD_LBFGS', 'LD_VAR1', 'LD_VAR2', 'LD_TNEWTON', &
                                             'LD_TNEWTON_RESTART', 'LD_TNEWTON_PRECOND_RESTART']

      associate (all_names => solver_names())
         do i = 1, size(all_names)
            if (family_of(all_names(i)) == family_simplex) cycle
            problem = rosenbrock()
            x = [-1.2_wp, 1.0_wp]
            call new_solver(find_solver(trim(all_names(i))), solver)
            solver%most_evaluations = given
            call solver%minimise(problem, x, never, ending)
            if (ending%reason == stop_refused) cycle
            call t%is_true(problem%evaluations <= given + merge(2, 1, any(tardy == all_names(i))), &
                           trim(all_names(i))//': evaluations', to_text(problem%evaluations))
         end do
      end associate
   end subroutine evaluations

   !> What is reported to an observer: counts that grow, and in the end the objective of what is found.
   subroutine reports()
      type(rosenbrock_t) :: problem
      type(ending_t) :: ending
      type(stop_t) :: never
      type(watcher_t) :: watcher, fresh
      class(solver_t), allocatable :: solver
      real(wp) :: x(2)
      integer :: i
      character(*), parameter :: some(*) = [character(10) :: 'LSQ', 'SIMPLEX', 'LD_SLSQP', 'LN_SBPLX', 'GN_CRS2_LM']

      do i = 1, size(some)
         problem = rosenbrock()
         x = [-1.2_wp, 1.0_wp]
         watcher = fresh
         call new_solver(find_solver(trim(some(i))), solver)
         call solver%minimise(problem, x, never, ending, watcher)
         call t%is_true(watcher%reports > 0 .and. watcher%in_order, trim(some(i))//': reports in order')
         call t%close_to(watcher%last%best, ending%objective, 1.0e-12_wp, trim(some(i))//': the best that is reported')
         call t%is_true(watcher%last%evaluations <= problem%evaluations .and. watcher%last%iteration <= watcher%last%limit, &
                        trim(some(i))//': counts that are reported')
      end do
   end subroutine reports

   !> A function without gradient or squares: for some solvers enough, refused by the others.
   subroutine function_alone()
      type(bare_t) :: problem
      type(normal_equations_t) :: equations
      type(ending_t) :: ending
      real(wp) :: x(2), none(0), slopes(2, 0)
      integer :: i
      character(*), parameter :: able(*) = [character(10) :: 'SIMPLEX', 'LN_SBPLX', 'LN_COBYLA', 'GN_CRS2_LM'], &
                                 unable(*) = [character(8) :: 'LSQ', 'LD_SLSQP', 'LD_MMA']

      do i = 1, size(able)
         problem = bare()
         x = [4.0_wp, -3.0_wp]
         call run(trim(able(i)), problem, x, ending)
         call t%is_true(ending%feasible, trim(able(i))//', a function alone: within bounds')
         call t%close_to(maxval(abs(x - [1.0_wp, 2.0_wp])), 0.0_wp, 1.0e-3_wp, trim(able(i))//', a function alone: its minimum')
      end do
      do i = 1, size(unable)
         problem = bare()
         x = [1.5_wp, -3.0_wp]
         call run(trim(unable(i)), problem, x, ending)
         call t%is_true(ending%reason == stop_refused .and. problem%evaluations == 0, &
                        trim(unable(i))//': needs more than a function')
      end do
      ! what it does not give is nothing
      call problem%linearise(x, 1.0_wp, equations)
      call t%is_true(all(abs(equations%gradient) <= 0.0_wp) .and. size(equations%gradient) == 2, 'a function alone: no gradient')
      call problem%constrain(x, none, slopes)
      call t%equal_integer(problem%count_constraints(), size(none), 'a function alone: no constraint')
   end subroutine function_alone

   !> Objective and gradient of a sum of squares, made from its residuals.
   subroutine gradient_of_squares()
      type(rosenbrock_t) :: problem
      real(wp) :: f, gradient(2)
      real(wp), parameter :: x(2) = [-1.2_wp, 1.0_wp]

      problem = rosenbrock()
      call problem%objective_at(x, f, gradient)
      call t%close_to(f, 24.2_wp, 1.0e-12_wp, 'Rosenbrock at the usual start')
      call t%close_to(gradient(1), -400.0_wp*x(1)*(x(2) - x(1)**2) - 2.0_wp*(1.0_wp - x(1)), 1.0e-12_wp, 'its gradient, x1')
      call t%close_to(gradient(2), 200.0_wp*(x(2) - x(1)**2), 1.0e-12_wp, 'its gradient, x2')
   end subroutine gradient_of_squares

   !> A search ends when it must.
   subroutine stops()
      type(rosenbrock_t) :: problem
      type(ending_t) :: ending
      type(stop_t) :: late
      real(wp) :: x(2)
      integer :: i
      character(*), parameter :: some(*) = [character(9) :: 'SIMPLEX', 'LSQ', 'LD_SLSQP', 'GN_ISRES']

      do i = 1, size(some)
         problem = rosenbrock()
         x = [-1.2_wp, 1.0_wp]
         call late%limit_time(1.0e-9_wp)
         call run(trim(some(i)), problem, x, ending, late)
         call t%equal_integer(ending%reason, stop_interrupted, trim(some(i))//': ends when time is up')
         call t%is_true(problem%evaluations < 20, trim(some(i))//': soon')
      end do
   end subroutine stops
   !> Himmelblau's four minima from forty starts, by one thread and by three.
   subroutine many_starts()
      type(climber_t), allocatable :: team(:)
      type(candidate_t), allocatable :: one(:), three(:)
      type(multistart_t) :: rules
      type(stop_t) :: never, late
      integer, allocatable :: best(:), best3(:)
      integer :: threads, i, k

      rules%starts = 40
      rules%first = 5
      rules%kept = 10
      rules%refines = .true.
      rules%compared = [.true., .true.]
      rules%relative = [0.05_wp, 0.05_wp]
      rules%absolute = [0.0_wp, 0.0_wp]
      rules%period = [0.0_wp, 0.0_wp]
      rules%small = 1.0e-3_wp
      do threads = 1, 3, 2
         allocate (team(threads))
         do i = 1, threads
            team(i)%problem = himmelblau()
            call team(i)%random%seed(19, purpose_starts)
         end do
         if (threads == 1) call rules%search(team, never, one, best)
         if (threads == 3) call rules%search(team, never, three, best3)
         deallocate (team)
      end do
      call t%equal_integer(size(best), 4, 'four minima are told apart')
      call t%is_true(size(best3) == size(best), 'as many for any number of threads')
      if (size(best3) /= size(best)) return
      call t%is_true(all(best3 == best), 'the same starts for any number of threads')
      do i = 1, size(one)
         call t%is_true(all(abs(one(i)%x - three(i)%x) <= 0.0_wp), 'the same bits for any number of threads')
      end do
      do i = 1, size(best)
         call t%close_to(one(best(i))%objective, 0.0_wp, 1.0e-12_wp, 'each is a minimum')
         do k = 1, i - 1
            call t%is_true(any(abs(one(best(i))%x - one(best(k))%x) > 1.0_wp), 'and another one')
         end do
      end do
      call t%is_true(all(one(best)%refined), 'what is kept was searched on')
      call t%equal_integer(kept(rules, [2.0_wp, 2.0_wp], [0.0_wp, 0.0_wp]), 1, 'differences of no account make one of them')
      ! the minima (3, 2), (-2.805, 3.131), (-3.779, -3.283), (3.584, -1.848): the first and the last are 3.85 apart in y
      call t%equal_integer(kept(rules, [0.9_wp, 0.5_wp], [0.0_wp, 3.85_wp]), 3, 'periodic: the first and the last are one')
      call t%equal_integer(rules%number_of(1), 5, 'starts are numbered from FIRST on')
      call late%limit_time(1.0e-9_wp)
      allocate (team(1))
      team(1)%problem = himmelblau()
      call rules%search(team, late, one, best)
      call t%is_true(.not. any(one%done) .and. size(best) == 0, 'no start is made when time is up')
   end subroutine many_starts

   !> Results kept where only larger differences than these count: of themselves, or absolute ones where an unknown is periodic.
   integer function kept(rules, least, period)
      type(multistart_t), intent(in) :: rules
      real(wp), intent(in) :: least(2), period(2)
      type(multistart_t) :: looser
      type(climber_t) :: team(1)
      type(candidate_t), allocatable :: starts(:)
      type(stop_t) :: never
      integer, allocatable :: best(:)

      looser = rules
      looser%relative = merge(least, 0.0_wp, all(period <= 0.0_wp))
      looser%absolute = merge(0.0_wp, least, all(period <= 0.0_wp))
      looser%period = period
      team(1)%problem = himmelblau()
      call team(1)%random%seed(19, purpose_starts)
      call looser%search(team, never, starts, best)
      kept = size(best)
   end function kept
end program test_solvers
