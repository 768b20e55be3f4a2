!> Ways of searching: few positions first, dyad by dyad.
program test_ways
   use cases, only: load_case
   use check, only: checks_t
   use psalm_constraint_group, only: range_positions
   use psalm_data_set, only: data_set_t
   use psalm_dyad_groups, only: dyads_of_variables
   use psalm_error, only: problem_t
   use psalm_few_positions, only: spread_order, stage_sizes, positions_of_stage, take_positions
   use psalm_kinds, only: wp
   use psalm_merit, only: merit_t, prepare_merit, hold, let_go
   use psalm_nlp, only: normal_equations_t
   use psalm_parameters, only: variable_length, variable_gama, variable_outang
   use psalm_search, only: result_t, search_many
   use psalm_solver_kind, only: find_solver
   use psalm_stop, only: stop_t
   use psalm_synthesis, only: synthesis_t, synthesise
   use psalm_dimensions, only: dimensions_t
   implicit none (type, external)
   type(checks_t) :: t

   call sizes()
   call spread_positions()
   call part_of_a_problem()
   call dyads()
   call held()
   call stages_of_a_search()
   call every_dyad()
   call stages_of_the_simplex()
   call t%report()

contains

   subroutine sizes()
      call t%is_true(all(stage_sizes(5, 18) == [5, 10, 18]), 'five positions first, then ten, then all')
      call t%is_true(all(stage_sizes(9, 18) == [9, 18]), 'twice nine are all')
      call t%is_true(all(stage_sizes(0, 18) == [18]), 'all at once')
   end subroutine sizes

   !> Each position taken is as far from those before it as any left; on a circle the last is near the first.
   subroutine spread_positions()
      real(wp) :: delt(20), nearest(20)
      integer :: order(20), i, k
      logical :: far

      delt = [(0.05_wp*real(i*i, wp), i=0, 19)]
      order = spread_order(delt, spread(.true., 1, 20), .false.)
      far = .true.
      do k = 2, 20
         do i = 1, 20
            nearest(i) = minval(abs(delt(i) - delt(order(:k - 1))))
         end do
         far = far .and. nearest(order(k)) >= maxval(nearest)
      end do
      call t%is_true(far .and. order(1) == 1 .and. order(2) == 20, 'each position is as far as can be from those before it')
      order(:18) = spread_order([(20.0_wp*real(i, wp), i=0, 17)], spread(.true., 1, 18), .true.)
      call t%is_true(all(order(:2) == [1, 10]), 'of a turn the second is half a turn away')
      order(:4) = spread_order([0.0_wp, 10.0_wp, 20.0_wp, 30.0_wp], [.false., .true., .true., .false.], .false.)
      call t%is_true(all(order(:4) == [2, 3, 1, 4]), 'positions without weight come last')
   end subroutine spread_positions

   !> Errors at some of the positions are those that the whole problem has there.
   subroutine part_of_a_problem()
      type(problem_t), save :: problem
      class(problem_t), allocatable :: part
      type(data_set_t), save :: set
      integer, allocatable :: which(:)
      real(wp) :: miss(20, 1), miss_of_part(5, 1)
      integer :: loop

      call load_case('needle', problem, set)
      which = positions_of_stage(problem, 5)
      call t%is_true(size(which) == 5 .and. all(which(2:) > which(:4)), 'five positions in their order')
      call take_positions(problem, which, part)
      call problem%deviations(problem%given, miss, loop)
      call part%deviations(problem%given, miss_of_part, loop)
      call t%is_true(all(abs(miss_of_part - miss(which, :)) <= 0.0_wp), 'the same errors there')
      call t%is_true(all(abs(part%weight(:5, :) - problem%weight(which, :)) <= 0.0_wp), 'and the same weights')
   end subroutine part_of_a_problem

   !> The needle linkage has four dyads, and dimensions of each vary.
   subroutine dyads()
      type(problem_t) :: problem
      type(data_set_t) :: set
      integer :: v

      call load_case('needle', problem, set)
      associate (variables => problem%parameters%variables, of => dyads_of_variables(problem%mechanism, problem%parameters))
         call t%equal_integer(maxval(of), 4, 'four dyads')
         do v = 1, size(of)
            select case (variables(v)%kind)
            case (variable_length, variable_gama)
               call t%equal_integer(of(v), variables(v)%loop, 'an arc belongs to the dyad of its loop')
            case (variable_outang)
               call t%equal_integer(of(v), 4, 'the output arc to that of the last')
            case default
               call t%equal_integer(of(v), 1, 'the reference input to the first')
            end select
         end do
      end associate
   end subroutine dyads

   !> Held variables have no part in the normal equations; those of the others are what they were.
   subroutine held()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(merit_t), save :: merit
      type(normal_equations_t), save :: whole, part
      real(wp), allocatable :: x(:)
      integer, allocatable :: left(:)
      logical, allocatable :: off(:)
      integer :: v

      call load_case('needle', problem, set)
      x = problem%parameters%first_values(problem%given)
      call prepare_merit(set, problem, x, merit)
      call merit%linearise(x, 1.0_wp, whole)
      off = dyads_of_variables(problem%mechanism, problem%parameters) /= 2
      left = pack([(v, v=1, size(x))], .not. off)
      call hold(merit, off)
      call merit%linearise(x, 1.0_wp, part)
      call t%is_true(all(abs(part%gradient(left) - whole%gradient(left)) <= 0.0_wp) .and. &
                     all(abs(part%matrix(left, left) - whole%matrix(left, left)) <= 0.0_wp), 'one dyad of the equations')
      call t%is_true(count(abs(part%gradient) > 0.0_wp) == size(left) .and. &
                     count(abs(part%matrix) > 0.0_wp) <= size(left)**2, 'and nothing else')
      call let_go(merit)
      call merit%linearise(x, 1.0_wp, part)
      call t%is_true(all(abs(part%matrix - whole%matrix) <= 0.0_wp), 'all of it again')
   end subroutine held

   !> LSQ: the objective is that of all positions; any number of threads gives the same.
   subroutine stages_of_a_search()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(result_t), save :: found, again
      type(dimensions_t), save :: dimensions
      real(wp) :: objective
      integer :: loop, way

      call load_case('needle', problem, set)
      set%search%solver = find_solver('LSQ')
      set%search%nstart = 8
      do way = 1, 2
         set%search%few = merge(5, 0, way == 1)
         set%search%by_dyads = way == 2
         call search(set, problem, 1, found)
         call search(set, problem, 2, again)
         call t%is_true(size(found%best) == 1 .and. size(again%best) == 1, 'a linkage is found')
         if (size(found%best) < 1 .or. size(again%best) < 1) return
         call t%is_true(all(abs(found%best(1)%values - again%best(1)%values) <= 0.0_wp) .and. &
                        found%evaluations == again%evaluations, 'the same one by two threads')
         dimensions = problem%given
         call problem%parameters%apply(found%best(1)%values, dimensions)
         call problem%evaluate(dimensions, objective, loop)
         call t%is_true(loop == 0 .and. abs(objective - found%best(1)%objective) <= 1.0e-12_wp*objective, &
                        'assessed at all positions')
         call t%is_true(objective <= 0.4467_wp, 'as good as all at once')
      end do
   end subroutine stages_of_a_search

   !> Dyad by dyad, hardly improved (MAXEVAL=1): both dyads are drawn by even starts, which are made to close, as by odd ones, which
   !> are drawn near a good linkage once there are some.
   subroutine every_dyad()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(result_t), save :: found
      real(wp), allocatable :: home(:)
      integer, allocatable :: dyads(:)
      logical :: alone(2)
      integer :: i, d

      call load_case('dwell_dyads', problem, set)
      set%constr%irange = range_positions
      problem%tangle = 89.0_wp
      set%search%nstart = 60
      set%search%nbest = 60
      set%search%maxeval = 1
      set%search%differ = 1.0e-9_wp
      call search(set, problem, 1, found)
      home = problem%parameters%first_values(problem%given)
      dyads = dyads_of_variables(problem%mechanism, problem%parameters)
      alone = .false.
      do i = 1, size(found%best)
         if (modulo(found%best(i)%start, 2) == 1) cycle
         associate (new => abs(found%best(i)%values - home) > 0.0_wp)
            do d = 1, 2
               if (any(new .and. dyads == d) .and. .not. any(new .and. dyads /= d)) alone(d) = .true.
            end do
         end associate
      end do
      call t%is_true(all(alone), 'even starts draw one dyad and the other')
   end subroutine every_dyad

   subroutine search(set, problem, threads, result)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: threads
      type(result_t), intent(out) :: result
      type(stop_t) :: never
      real(wp) :: none(size(problem%parameters%variables), 0)

      call search_many(set, problem, problem%parameters%first_values(problem%given), none, threads, never, result)
   end subroutine search

   !> The simplex: what it ends with obeys at all positions and is no worse than the given linkage.
   subroutine stages_of_the_simplex()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(synthesis_t), save :: result, again
      type(dimensions_t), save :: dimensions, plain
      type(stop_t), save :: never
      real(wp) :: objective, before
      integer :: loop

      call load_case('needle_nelder_mead', problem, set)
      set%search%few = 5
      dimensions = problem%given
      call synthesise(set, reshape([real(wp) ::], [size(problem%parameters%variables), 0]), problem, 1, never, dimensions, result)
      call problem%evaluate(dimensions, objective, loop)
      call t%is_true(loop == 0, 'the simplex ends with a linkage that obeys at all positions')
      call t%is_true(abs(objective - result%state%best) <= 1.0e-12_wp*objective, 'whose objective is that of all positions')
      call t%is_true(objective < 2.0_wp, 'and lower than what the coefficients of the thesis reached')
      set%search%few = 0
      plain = problem%given
      call synthesise(set, reshape([real(wp) ::], [size(problem%parameters%variables), 0]), problem, 1, never, plain, again)
      call t%is_true(again%state%iteration > result%state%iteration, 'from fewer iterations than without')
      call t%is_true(result%state%iteration <= set%method%niter, 'the iterations of all stages count')
      ! begun with what was found, one position first leads far away
      problem%given = dimensions
      before = objective
      set%search%few = 1
      call synthesise(set, reshape([real(wp) ::], [size(problem%parameters%variables), 0]), problem, 1, never, dimensions, again)
      call problem%evaluate(dimensions, objective, loop)
      call t%is_true(loop == 0 .and. objective <= before, 'what few positions lead to is no worse than the given linkage')
   end subroutine stages_of_the_simplex
end program test_ways
