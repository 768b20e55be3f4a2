!> The search for better dimensions of a sketch in the poses of its links, from many starts, and the sketch that came of it.
module psalm_chain_synthesis
   use psalm_angles, only: unit_vector
   use psalm_chain_problem, only: chain_problem_t, make_chain_problem
   use psalm_chain_motion, only: chain_motion_t
   use psalm_chain_study, only: inputs_of_drives
   use psalm_closure, only: closure_t, state_t, travel
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, degrees_per_radian, full_turn, right_angle
   use psalm_method_group, only: method_group_t
   use psalm_multistart, only: multistart_t, starter_t, candidate_t
   use psalm_sketch, only: sketch_t, output_slide
   use psalm_sketch_assembly, only: assemble_sketch
   use psalm_solver, only: solver_t, ending_t, observer_t, stop_refused
   use psalm_solvers, only: new_solver
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
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

   !> A linkage found.
   type :: chain_found_t
      real(wp), allocatable :: x(:)              !! shape (unknowns)
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
      class(data_set_t), allocatable :: drawn    !! a case of the best linkage: drawn anew, without loops, nothing varying
   end type chain_synthesis_t

   type, extends(starter_t) :: chain_starter_t
      type(chain_problem_t) :: problem
      class(solver_t), allocatable :: solver
      real(wp), allocatable :: low(:), high(:)   !! where starts are drawn
      type(stop_t) :: stop
      type(xoshiro_t) :: random
      integer :: most = 0                        !! evaluations of a start
   contains
      procedure :: start
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
      else if (set%search%few > 0) then
         call set%origins%error(findings, 'SEARCH', 'NFEW', 'few positions first is for linkages that are traced in loops: '// &
                                'leave NFEW out')
      else if (set%search%by_dyads) then
         call set%origins%error(findings, 'SEARCH', 'IDYAD', 'dyad by dyad is for linkages that are traced in loops: leave '// &
                                'IDYAD out')
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
      allocate (team(min(max(1, threads), rules%starts)))
      do i = 1, size(team)
         call prepare_starter(set, result%problem, ending, team(i))
      end do
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
      if (size(best) == 0) return
      allocate (result%drawn)
      call draw_anew(set, result%problem, result%best(1)%x, result%drawn)
   end subroutine synthesise_chain

   subroutine prepare_starter(set, problem, stop, starter)
      type(data_set_t), intent(in) :: set
      type(chain_problem_t), intent(in) :: problem
      type(stop_t), intent(in) :: stop
      type(chain_starter_t), intent(inout) :: starter
      integer :: v
      real(wp) :: reach

      starter%problem = problem
      starter%stop = stop
      starter%most = set%search%maxeval
      call new_solver(set%search%solver, starter%solver)
      call starter%random%seed(set%method%istart, purpose_starts)
      allocate (starter%low(problem%core), starter%high(problem%core))
      do v = 1, problem%core
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
   end function are_one

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
      candidate%x = min(max(self%problem%first, self%problem%low), self%problem%high)
      if (number > 1) then
         call self%random%use_stream(number)
         do v = 1, size(candidate%x)
            call self%random%next(deviate)
            candidate%x(v) = self%low(v) + deviate*(self%high(v) - self%low(v))
         end do
         ! nearer to the drawing until it closes
         drawn = min(max(self%problem%first, self%problem%low), self%problem%high)
         call self%problem%settle(candidate%x, objective, feasible, towards=drawn)
      end if
      call improve(self, rough, number, candidate)
   end subroutine start

   subroutine refine(self, thorough, candidate)
      class(chain_starter_t), intent(inout) :: self
      logical, intent(in) :: thorough
      type(candidate_t), intent(inout) :: candidate
      type(candidate_t) :: finer

      finer = candidate
      call improve(self, merge(fine, settling, thorough), 1, finer)
      candidate%evaluations = candidate%evaluations + finer%evaluations
      candidate%jacobians = candidate%jacobians + finer%jacobians
      if (.not. finer%feasible .or. finer%objective > candidate%objective) return
      candidate%x = finer%x
      candidate%objective = finer%objective
   end subroutine refine

   subroutine improve(self, least_gain, number, candidate)
      class(chain_starter_t), intent(inout) :: self
      real(wp), intent(in) :: least_gain
      integer, intent(in) :: number
      type(candidate_t), intent(inout) :: candidate
      type(ending_t) :: ending

      self%problem%evaluations = 0
      self%problem%jacobians = 0
      self%solver%most_evaluations = self%most
      self%solver%least_gain = least_gain
      self%solver%seed = number
      call self%solver%minimise(self%problem, candidate%x, self%stop, ending)
      call self%problem%settle_signs(candidate%x)
      candidate%objective = ending%objective
      candidate%feasible = ending%feasible
      candidate%refused = ending%reason == stop_refused .and. number == 1
      candidate%evaluations = self%problem%evaluations
      candidate%jacobians = self%problem%jacobians
   end subroutine improve

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
      complex(wp) :: p
      real(wp) :: cosine, sine, moved
      logical :: reached
      integer :: s

      sketch = set%sketch
      method = set%method
      at_drawing = problem
      if (allocated(at_drawing%inputs)) deallocate (at_drawing%inputs)
      allocate (at_drawing%inputs(size(set%sketch%drives), 1), source=0.0_wp)
      at_drawing%of_input = 0
      call at_drawing%find_motion(x, closure, motion, reached)
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
               if (output%is_wished()) output%wishes(0)%values = output%wishes(0)%values - moved
               if (s == 1 .and. set%method%desired) method%desang = set%method%desang - moved
            end associate
         end do
         ! the lengths are in the coordinates now
         deallocate (sketch%length_of, sketch%length, sketch%variations)
         allocate (sketch%length_of(2, 0), sketch%length(0), sketch%variations(0))
      end associate
      if (problem%of_input > 0) method%crnki = x(problem%of_input)
      call set%redraw(set%title, sketch, method, set%search, drawn)
   end subroutine draw_anew
end module psalm_chain_synthesis
