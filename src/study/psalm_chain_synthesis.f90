!> The search for better dimensions of a sketch in the poses of its links, from many starts, and the sketch that came of it.
module psalm_chain_synthesis
   use psalm_angles, only: nearest_difference, unit_vector
   use psalm_chain_problem, only: chain_problem_t, make_chain_problem
   use psalm_chain_motion, only: chain_motion_t
   use psalm_chain_study, only: inputs_of_drives
   use psalm_closure, only: closure_t, state_t, most_orders, travel
   use psalm_constraint_group, only: range_positions
   use psalm_data_set, only: data_set_t
   use psalm_few_positions, only: positions_far_apart, stage_sizes
   use psalm_equalities, only: move_constants
   use psalm_kinds, only: wp, degrees_per_radian, full_turn, right_angle
   use psalm_method_group, only: method_group_t
   use psalm_multistart, only: multistart_t, starter_t, candidate_t
   use psalm_merit, only: extra_positions
   use psalm_search_group, only: order_either
   use psalm_simplx, only: simplex_solver_t
   use psalm_sketch, only: sketch_t, drive_turns, output_slide
   use psalm_sketch_assembly, only: assemble_sketch
   use psalm_solver, only: solver_t, ending_t, observer_t, stop_refused
   use psalm_solvers, only: new_solver
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_similarity, only: similarity_t, time_similar
   use psalm_text, only: to_text
   use psalm_timing_order, only: choose_inputs, inputs_of_path, never, steps_of_path
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: chain_synthesis_t, synthesise_chain

   real(wp), parameter :: rough = 1.0e-5_wp      !! relative gain of a step that ends a start
   real(wp), parameter :: settling = 1.0e-5_wp   !! of one that may be listed
   real(wp), parameter :: fine = 1.0e-10_wp      !! and of one that ends the search on the best
   real(wp), parameter :: same_place = 1.0e-4_wp !! of the linkage's size: joints no farther apart are at one place
   real(wp), parameter :: ridge = 1.0e-2_wp      !! relative rise of the objective that parts two valleys
   integer, parameter :: steps_between = 8       !! in which the way from one linkage to another is looked at
   integer, parameter :: most_returns = 4        !! times a search goes back to work: on a timing, or on what an inspection found
   real(wp), parameter :: worth_it = 1.0e-6_wp   !! relative gain for which another timing is tried

   !> A linkage found.
   type :: chain_found_t
      real(wp), allocatable :: x(:)              !! shape (unknowns): dimensions, then inputs of free timing
      real(wp) :: objective = 0.0_wp
      integer :: start = 0                       !! number of the start that led to it
   end type chain_found_t

   !> Results.
   type :: chain_synthesis_t
      type(chain_problem_t) :: problem
      real(wp) :: first_objective = 0.0_wp       !! of the drawing
      logical :: first_feasible = .false.
      type(chain_found_t), allocatable :: best(:)
      integer :: starts = 0, feasible = 0        !! made; that led to a linkage that obeys
      integer :: evaluations = 0
      logical :: refused = .false.               !! the solver does not work on this problem
      logical :: stopped = .false.               !! before all starts were made
      class(data_set_t), allocatable :: drawn    !! a case of the best linkage, or of the given one if none was found: drawn anew,
                                                 !! without loops, nothing varying
   contains
      procedure :: draw
   end type chain_synthesis_t

   type, extends(starter_t) :: chain_starter_t
      type(chain_problem_t) :: problem
      type(chain_problem_t), allocatable :: stages(:) !! shape (stages of a start): the problem at the positions of each; last all
      class(solver_t), allocatable :: solver
      real(wp), allocatable :: low(:), high(:)   !! where starts are drawn
      type(stop_t) :: stop
      type(xoshiro_t) :: random
      integer :: most = 0                        !! evaluations of a start
      logical :: either_way = .false.            !! points in their order may be visited with the input going either way
      real(wp) :: sense = 1.0_wp                 !! of DELT
      logical :: turns = .true.                  !! the input does
   contains
      procedure :: start
      procedure :: go_on
      procedure :: are_one
      procedure :: refine
   end type chain_starter_t

contains

   !> Search. `findings` tell variables that cannot vary so.
   subroutine synthesise_chain(set, threads, stop, result, findings, observer)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      type(chain_synthesis_t), intent(out) :: result
      type(diagnostics_t), intent(inout) :: findings
      class(observer_t), intent(inout), optional :: observer
      type(closure_t) :: closure
      type(state_t) :: drawn
      type(chain_starter_t), allocatable :: team(:)
      type(candidate_t), allocatable :: candidates(:)
      type(multistart_t) :: rules
      type(stop_t) :: ending
      integer, allocatable :: best(:)
      character(:), allocatable :: failure
      logical :: valid
      integer :: which, i

      allocate (result%best(0))
      call assemble_sketch(set, closure, drawn, valid, findings)
      if (.not. valid) return
      call make_chain_problem(set, closure, drawn, inputs_of_drives(set, .true.), result%problem, failure, which)
      if (which > 0) then
         call set%origins%error(findings, 'CHAIN', 'VARY', failure, which)
      else if (result%problem%residuals == 0) then
         call set%origins%error(findings, 'CHAIN', 'VARY', 'variables without desired values: give DESX, DESY or DESANG of the '// &
                                'first output in &METHOD, or DES1, DES2 ... in &OUTPUTS', 1)
      else if (set%search%solver%global .and. any(result%problem%high >= huge(1.0_wp))) then
         call set%origins%error(findings, 'SEARCH', 'SOLVER', 'this solver searches a box: give the bounds of all variables, '// &
                                'VLOW and VHIGH of &CHAIN')
      else if (set%method%nvert > 0 .and. set%method%nvert <= result%problem%core) then
         call set%origins%error(findings, 'METHOD', 'NVERT', 'a simplex of '//to_text(result%problem%core)//' variables, free '// &
                                'inputs among them, needs at least '//to_text(result%problem%core + 1)//' vertices; found '// &
                                to_text(set%method%nvert), 1)
      else if (set%search%by_dyads) then
         call set%origins%error(findings, 'SEARCH', 'IDYAD', 'a search in the poses of links does not take the linkage apart '// &
                                'into dyads: leave IDYAD out')
      end if
      if (findings%failed()) return
      call result%problem%accept(result%problem%first, result%first_objective, result%first_feasible)
      ending = stop
      call ending%limit_time(set%search%maxtime)
      rules%starts = set%search%nstart
      rules%first = set%search%first
      rules%kept = set%search%nbest
      rules%refines = .true.
      rules%small = set%method%fmin
      allocate (rules%compared(result%problem%core), source=.true.)
      allocate (rules%relative(result%problem%core), source=set%search%differ)
      allocate (rules%absolute(result%problem%core), rules%period(result%problem%core), source=0.0_wp)
      do i = 1, result%problem%core
         if (any(result%problem%moved%of_length == i)) cycle
         rules%relative(i) = 0.0_wp
         rules%absolute(i) = set%search%differ*degrees_per_radian
         rules%period(i) = full_turn
      end do
      ! inputs tell no two linkages apart, nor with free timing where they count from
      associate (variables => result%problem%variables, of_input => result%problem%of_input)
         rules%compared(variables + 1:) = .false.
         rules%absolute(variables + 1:) = huge(1.0_wp)
         if (result%problem%free .and. of_input > 0) rules%absolute(of_input) = huge(1.0_wp)
      end associate
      allocate (team(min(max(1, threads), rules%starts)))
      do i = 1, size(team)
         call prepare_starter(set, result%problem, ending, team(i))
      end do
      rules%stages = size(team(1)%stages)
      call rules%search(team, ending, candidates, best, observer)
      result%starts = count(candidates%done)
      result%feasible = count(candidates%feasible)
      result%refused = any(candidates%refused)
      result%stopped = .not. all(candidates%done)
      result%evaluations = sum(candidates%evaluations)
      deallocate (result%best)
      allocate (result%best(size(best)))
      do i = 1, size(best)
         result%best(i)%x = candidates(best(i))%x
         result%best(i)%objective = candidates(best(i))%objective
         result%best(i)%start = rules%number_of(best(i))
      end do
      allocate (result%drawn)
      if (size(best) > 0) then
         call draw_anew(set, result%problem, result%best(1)%x, result%drawn)
      else
         call draw_anew(set, result%problem, result%problem%first, result%drawn)
      end if
   end subroutine synthesise_chain

   !> A case of the linkage of a rank, 1 to size(best), as `drawn` is one of the best.
   subroutine draw(self, set, rank, drawn)
      class(chain_synthesis_t), intent(in) :: self
      type(data_set_t), intent(in) :: set        !! the one that was searched
      integer, intent(in) :: rank
      type(data_set_t), intent(out) :: drawn

      call draw_anew(set, self%problem, self%best(rank)%x, drawn)
   end subroutine draw

   subroutine prepare_starter(set, problem, stop, starter)
      type(data_set_t), intent(in) :: set
      type(chain_problem_t), intent(in) :: problem
      type(stop_t), intent(in) :: stop
      type(chain_starter_t), intent(inout) :: starter
      integer :: v, stage
      real(wp) :: reach
      logical :: weighs(size(problem%delt))

      starter%problem = problem
      weighs = any(any(problem%weight > 0.0_wp, dim=1), dim=1)
      associate (sizes => stage_sizes(set%search%few, size(problem%delt)), &
                 turns => set%sketch%drives(1)%kind == drive_turns)
         allocate (starter%stages(size(sizes)))
         do stage = 1, size(sizes)
            call problem%at_positions(positions_far_apart(problem%delt, weighs, turns, sizes(stage)), starter%stages(stage))
         end do
      end associate
      starter%stop = stop
      starter%most = set%search%maxeval
      starter%either_way = problem%ordered .and. set%search%order == order_either
      starter%sense = problem%sense
      starter%turns = set%sketch%drives(1)%kind == drive_turns
      call new_solver(set%search%solver, starter%solver)
      select type (solver => starter%solver)
      type is (simplex_solver_t)
         solver%vertices = set%method%nvert
      end select
      call starter%random%seed(set%method%istart, purpose_starts)
      allocate (starter%low(problem%core), starter%high(problem%core))
      starter%low = problem%first
      starter%high = problem%first
      do v = 1, problem%variables
         reach = set%method%var*abs(problem%first(v))
         if (.not. any(problem%moved%of_length == v)) reach = set%method%var*right_angle
         starter%low(v) = max(problem%low(v), problem%first(v) - reach)
         starter%high(v) = min(problem%high(v), problem%first(v) + reach)
         if (problem%low(v) <= -huge(1.0_wp)) cycle
         starter%low(v) = problem%low(v)
         starter%high(v) = problem%high(v)
      end do
   end subroutine prepare_starter

   !> Two linkages are one if their joints are at the same places at the first position, or if no ridge of the objective lies
   !> between them.
   logical function are_one(self, a, b)
      class(chain_starter_t), intent(inout) :: self
      type(candidate_t), intent(in) :: a, b
      complex(wp) :: first(size(self%problem%start%joint, 1)), second(size(first))
      real(wp) :: other(size(a%x)), objective, violation
      logical :: reached(2)
      integer :: v, step

      if (self%either_way) then
         if (abs(way_of(self, a%x) - way_of(self, b%x)) > 0.0_wp) then
            are_one = .false.
            return
         end if
         self%problem%sense = way_of(self, a%x)
      end if
      call self%problem%set_range(a%x)
      call find_joints(a%x, first, reached(1))
      call find_joints(b%x, second, reached(2))
      are_one = .false.
      if (all(reached)) are_one = all(abs(first - second) <= same_place*self%problem%drawn%size)
      if (are_one) return
      other = b%x
      do v = 1, size(other)
         if (.not. any(self%problem%moved%of_angle == v)) cycle
         other(v) = other(v) + full_turn*anint((a%x(v) - other(v))/full_turn)
      end do
      if (self%problem%free .and. self%turns) then
         associate (n => self%problem%variables)
            other(n + 1:) = other(n + 1:) + full_turn*anint((reference_of(a%x) - reference_of(other))/full_turn)
         end associate
      end if
      do step = 1, steps_between - 1
         call self%problem%measure(a%x + (other - a%x)*(real(step, wp)/real(steps_between, wp)), objective, violation)
         if (.not. objective + max(objective, self%problem%small)*violation <= &
             (1.0_wp + ridge)*max(a%objective, b%objective)) return
      end do
      are_one = .true.

   contains

      subroutine find_joints(x, joints, reached)
         real(wp), intent(in) :: x(:)
         complex(wp), intent(out) :: joints(:)
         logical, intent(out) :: reached
         type(closure_t) :: closure
         type(chain_motion_t) :: motion

         joints = (0.0_wp, 0.0_wp)
         call self%problem%find_motion(x, closure, motion, reached)
         if (reached) joints = motion%states(1)%joint(:, 0)
      end subroutine find_joints

      !> The first input, from the drawing.
      pure real(wp) function reference_of(x)
         real(wp), intent(in) :: x(:)

         reference_of = x(self%problem%variables + 1)
         if (self%problem%of_input > 0) reference_of = reference_of + x(self%problem%of_input)
      end function reference_of
   end function are_one

   !> Which way free inputs go.
   pure real(wp) function way_of(self, x) result(sense)
      class(chain_starter_t), intent(in) :: self
      real(wp), intent(in) :: x(:)               !! unknowns

      sense = sign(1.0_wp, x(size(x)) - x(self%problem%variables + 1))
   end function way_of

   !> One start: the drawing, or a linkage drawn at random within the bounds, or within VAR of the drawing.
   subroutine start(self, number, elite, candidate)
      class(chain_starter_t), intent(inout) :: self
      integer, intent(in) :: number
      real(wp), intent(in) :: elite(:, :)
      type(candidate_t), intent(inout) :: candidate
      real(wp) :: deviate, objective, drawn(self%problem%core)
      logical :: feasible
      integer :: v

      associate (unused => elite)
      end associate
      self%problem = self%stages(1)
      self%problem%sense = self%sense
      if (self%either_way .and. number > 1 .and. mod(number/2, 2) == 1) self%problem%sense = -self%sense
      call self%problem%set_range(self%problem%first)
      candidate%x = min(max(self%problem%first, self%problem%low), self%problem%high)
      if (number > 1) then
         call self%random%use_stream(number)
         do v = 1, self%problem%variables
            call self%random%next(deviate)
            candidate%x(v) = self%low(v) + deviate*(self%high(v) - self%low(v))
         end do
         ! nearer to the drawing until it closes; the drawing itself may not obey between the positions, nor go this way
         drawn = min(max(self%problem%first, self%problem%low), self%problem%high)
         self%problem%looks_between = .false.
         call self%problem%settle(candidate%x, objective, feasible, towards=drawn)
         self%problem%looks_between = .true.
         if (self%problem%free) call retime(self, candidate%x)
      end if
      call improve(self, rough, number, candidate)
      call assess(self, candidate)
   end subroutine start

   !> Search on with the positions of the next stage; what does not obey is not taken if what was there does.
   subroutine go_on(self, stage, candidate)
      class(chain_starter_t), intent(inout) :: self
      integer, intent(in) :: stage
      type(candidate_t), intent(inout) :: candidate
      type(candidate_t) :: further

      further = candidate
      self%problem = self%stages(stage)
      call self%problem%set_range(further%x)
      call improve(self, rough, 1, further)
      further%evaluations = further%evaluations + candidate%evaluations
      further%jacobians = further%jacobians + candidate%jacobians
      call assess(self, further)
      if (further%feasible .or. .not. candidate%feasible) then
         candidate = further
      else
         candidate%evaluations = further%evaluations
         candidate%jacobians = further%jacobians
      end if
   end subroutine go_on

   !> What a linkage that some of the positions led to is worth at all of them.
   subroutine assess(self, candidate)
      class(chain_starter_t), intent(inout) :: self
      type(candidate_t), intent(inout) :: candidate
      real(wp), allocatable :: violated(:)
      real(wp) :: violation

      if (size(self%problem%delt) == size(self%stages(size(self%stages))%delt)) return
      self%problem = self%stages(size(self%stages))
      call self%problem%set_range(candidate%x)
      call self%problem%measure(candidate%x, candidate%promise, violation)
      candidate%promise = candidate%promise + max(candidate%promise, self%problem%small)*violation
      call self%problem%accept(candidate%x, candidate%objective, candidate%feasible)
      if (candidate%feasible .and. self%problem%irange /= range_positions) then
         call self%problem%find_violations(candidate%x, violated)
         candidate%feasible = size(violated) == 0
      end if
      candidate%evaluations = candidate%evaluations + self%problem%evaluations
   end subroutine assess

   subroutine refine(self, thorough, candidate)
      class(chain_starter_t), intent(inout) :: self
      logical, intent(in) :: thorough
      type(candidate_t), intent(inout) :: candidate
      type(candidate_t) :: finer

      finer = candidate
      self%problem%sense = self%sense
      if (self%either_way) self%problem%sense = way_of(self, candidate%x)
      call self%problem%set_range(candidate%x)
      self%solver%hasty = .true.
      call improve(self, merge(fine, settling, thorough), 1, finer)
      self%solver%hasty = .false.
      candidate%evaluations = candidate%evaluations + finer%evaluations
      candidate%jacobians = candidate%jacobians + finer%jacobians
      if (.not. finer%feasible .or. finer%objective > candidate%objective) return
      candidate%x = finer%x
      candidate%objective = finer%objective
   end subroutine refine

   !> Improve, look for a better timing, inspect the range of the input; go back to work on what is found.
   subroutine improve(self, least_gain, number, candidate)
      class(chain_starter_t), intent(inout) :: self
      real(wp), intent(in) :: least_gain
      integer, intent(in) :: number
      type(candidate_t), intent(inout) :: candidate
      real(wp), allocatable :: x(:), violated(:), extra(:)
      real(wp) :: objective
      logical :: feasible, refused
      integer :: round

      self%problem%evaluations = 0
      self%problem%jacobians = 0
      call run_solver(candidate%x, candidate%objective, candidate%feasible, candidate%refused)
      if (self%problem%free) then
         do round = 1, most_returns
            x = candidate%x
            call retime(self, x)
            call run_solver(x, objective, feasible, refused)
            if (.not. feasible) exit
            if (candidate%feasible .and. objective >= candidate%objective*(1.0_wp - worth_it)) exit
            candidate%x = x
            candidate%objective = objective
            candidate%feasible = .true.
         end do
      end if
      if (self%problem%irange /= range_positions .and. candidate%feasible) then
         allocate (extra(0))
         do round = 1, most_returns + 1         ! the last looks at what the solver found at last
            ! with free timing the range has moved with the inputs
            call self%problem%set_range(candidate%x, extra)
            call self%problem%find_violations(candidate%x, violated)
            candidate%feasible = size(violated) == 0
            if (candidate%feasible .or. round > most_returns .or. size(extra) >= extra_positions) exit
            extra = [extra, violated]
            call self%problem%set_range(candidate%x, extra)
            call run_solver(candidate%x, candidate%objective, feasible, refused)
            if (.not. feasible) exit
         end do
      end if
      call self%problem%settle_signs(candidate%x)
      candidate%evaluations = self%problem%evaluations
      candidate%jacobians = self%problem%jacobians

   contains

      subroutine run_solver(x, objective, feasible, refused)
         real(wp), intent(inout) :: x(:)
         real(wp), intent(out) :: objective
         logical, intent(out) :: feasible, refused
         type(ending_t) :: ending

         self%solver%most_evaluations = 0
         if (self%most > 0) self%solver%most_evaluations = max(1, self%most - self%problem%evaluations)
         self%solver%least_gain = least_gain
         self%solver%seed = number
         call self%solver%minimise(self%problem, x, self%stop, ending)
         objective = ending%objective
         feasible = ending%feasible
         refused = ending%reason == stop_refused .and. number == 1
      end subroutine run_solver
   end subroutine improve

   !> Give a linkage the inputs that fit it best, seen over the whole range.
   subroutine retime(self, x)
      class(chain_starter_t), intent(inout) :: self
      real(wp), intent(inout) :: x(:)
      real(wp) :: inputs(steps_of_path), cost(steps_of_path, size(self%problem%inputs, 2)), best
      real(wp) :: values(size(self%problem%wanted, 1), 0:most_orders, steps_of_path)
      logical :: known(steps_of_path)
      integer :: k, n, order, i

      associate (problem => self%problem)
         inputs = inputs_of_path(problem%delt, problem%sense, self%turns)
         call problem%find_path(x, inputs, values, known)
         if (.not. any(known)) return
         if (problem%similar) then
            call time_similar(cmplx(values(1, 0, :), values(2, 0, :), wp), known, inputs, &
                              cmplx(problem%wanted(1, 0, :), problem%wanted(2, 0, :), wp), problem%weight(1, 0, :), self%turns, &
                              problem%ordered, problem%sense, x(problem%variables + 1:), cost, best)
            return
         end if
         cost = 0.0_wp
         do k = 1, size(cost, 2)
            do order = 0, ubound(problem%weight, 2)
               do n = 1, size(values, 1)
                  if (problem%weight(n, order, k) <= 0.0_wp) cycle
                  do i = 1, steps_of_path
                     ! a ratio may have no value
                     cost(i, k) = cost(i, k) + problem%weight(n, order, k)* &
                                  min(abs(miss(values(n, order, i), problem%wanted(n, order, k), &
                                               order == 0 .and. problem%angle(n))), sqrt(never))**2
                  end do
               end do
            end do
            where (.not. known .or. .not. cost(:, k) < never) cost(:, k) = never
         end do
         call choose_inputs(inputs, cost, self%turns, problem%ordered, problem%sense, x(problem%variables + 1:), best)
      end associate

   contains

      pure real(wp) function miss(value, wanted, is_angle)
         real(wp), intent(in) :: value, wanted
         logical, intent(in) :: is_angle

         miss = value - wanted
         if (is_angle) miss = nearest_difference(value, wanted)
      end function miss
   end subroutine retime

   !> The data set with the joints and slides where the linkage found has them, its drives as in the drawing.
   subroutine draw_anew(set, problem, x, drawn)
      type(data_set_t), intent(in) :: set
      type(chain_problem_t), intent(in) :: problem
      real(wp), intent(in) :: x(:)
      type(data_set_t), intent(out) :: drawn
      type(sketch_t) :: sketch
      type(method_group_t) :: method
      type(chain_problem_t) :: at_drawing
      type(closure_t) :: closure
      type(chain_motion_t) :: motion
      type(similarity_t) :: similarity
      complex(wp) :: p
      complex(wp), allocatable :: points(:)
      real(wp) :: cosine, sine, moved
      logical :: reached
      integer :: s

      sketch = set%sketch
      method = set%method
      at_drawing = problem
      if (allocated(at_drawing%inputs)) deallocate (at_drawing%inputs)
      at_drawing%delt = [0.0_wp]
      allocate (at_drawing%inputs(size(set%sketch%drives), 1), source=0.0_wp)
      at_drawing%of_input = 0
      at_drawing%free = .false.
      call at_drawing%find_motion(x, closure, motion, reached)
      deallocate (sketch%variations)
      allocate (sketch%variations(0))
      if (.not. reached) then
         call set%redraw(set%title, sketch, method, set%search, drawn)
         return
      end if
      associate (state => motion%states(1))
         sketch%x = state%joint(:, 0)%re
         sketch%y = state%joint(:, 0)%im
         do s = 1, size(sketch%slides)
            associate (slide => sketch%slides(s), link => sketch%slides(s)%links(1))
               call unit_vector(state%phi(link, 0)*degrees_per_radian, cosine, sine)
               p = state%t(link, 0) + cmplx(cosine, sine, wp)*closure%slide_point(1, s)
               slide%x = p%re
               slide%y = p%im
               slide%angle = slide%angle + state%phi(link, 0)*degrees_per_radian
            end associate
         end do
         ! travel is counted from the new drawing
         do s = 1, size(sketch%outputs)
            associate (output => sketch%outputs(s))
               if (output%kind /= output_slide) cycle
               moved = real(travel(closure, state, output%slide, 0), wp)
               if (output%has_target()) output%targets(0)%values = output%targets(0)%values - moved
               call move_constants(sketch, s, moved)
               if (s == 1 .and. set%method%desired) method%desang = set%method%desang - moved
            end associate
         end do
         ! the lengths are in the coordinates now
         deallocate (sketch%length_of, sketch%length)
         allocate (sketch%length_of(2, 0), sketch%length(0))
      end associate
      if (problem%of_input > 0) method%crnki = x(problem%of_input)
      if (problem%free) then
         method%delt = problem%increments(x)
         method%ifree = 0
      end if
      if (problem%similar) then
         call problem%find_similarity(x, similarity, reached)
         points = similarity%placed(cmplx(method%desx + method%xadd, method%desy + method%yadd, wp))
         method%desx = points%re - method%xadd
         method%desy = points%im - method%yadd
         method%isim = 0
      end if
      call set%redraw(set%title, sketch, method, set%search, drawn)
   end subroutine draw_anew
end module psalm_chain_synthesis
