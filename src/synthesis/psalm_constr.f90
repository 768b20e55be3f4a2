!> CONSTR makes a vertex of the simplex obey the constraints.
!>
!> Bounds are clipped. A dyad that does not close, or whose transmission angle is out of limits, is repaired by changing
!> its own variable lengths; where that is impossible the vertex moves a quarter of the way towards a linkage known to be
!> feasible, and everything starts again. Source: Oldham (1977), sections 6.3 and 6.4.3. Difference from the thesis: the
!> lowest offending loop is repaired over all positions, then evaluation restarts; the thesis goes position by position.
module psalm_constr
   use psalm_assur, only: repair_dyad
   use psalm_data_set, only: data_set_t
   use psalm_dyad, only: violation_none
   use psalm_error, only: problem_t, violation_t
   use psalm_kinds, only: wp
   use psalm_nlp, only: nlp_t, repair_count_t, failure_t, quarter, most_moves
   use psalm_dimensions, only: dimensions_t
   use psalm_parameters, only: variable_aside, variable_length, variable_outlk
   use psalm_output_targets, only: output_targets_t, prepare_output_targets, find_output_targets, sum_of_desired_errors
   use psalm_shown_input, only: input_at
   use psalm_desired_rates, only: desired_rates_t, prepare_desired_rates, find_desired_rates, sum_of_rate_errors, all_rates_exist
   implicit none (type, external)
   private
   public :: constraints_t, vertex_problem_t, make_constraints, make_vertex_problem, constrain, without_rates

   real(wp), parameter :: without_rates = huge(1.0_wp)**0.25_wp !! objective where a derivative that is wanted is infinite
   integer, parameter :: repairs_per_loop = 4    !! repairs before a pair of loops that undo each other gives up

   !> Limits on the variables, and room to work in.
   type :: constraints_t
      logical :: bounded = .false.                !! LIMVAL
      real(wp), allocatable :: low(:), high(:)    !! shape (nvar): OPLOW, OPHIGH
      logical, allocatable :: positive(:)         !! shape (nvar): a length
      real(wp) :: step_in = 0.0_wp                !! STEPIN
      type(dimensions_t) :: dimensions            !! the vertex as a linkage
      real(wp), allocatable :: reach(:)           !! shape (positions)
      integer :: passed_over = 0                  !! NVIOL: of an iteration so many violations are counted only
   end type constraints_t

   !> The search by the thesis's simplex as an optimisation problem: an objective, and vertices that are repaired.
   type, extends(nlp_t) :: vertex_problem_t
      type(problem_t), pointer :: problem => null() !! the caller's
      type(constraints_t) :: constraints
      class(desired_rates_t), allocatable :: rates    !! derivatives of the output by the input, where they are wanted
      class(output_targets_t), allocatable :: targets  !! desired values of further outputs, where there are any
   contains
      procedure :: measure
      procedure :: accept
      procedure :: settle
   end type vertex_problem_t

contains

   !> Constraints of a data set for a problem.
   subroutine make_constraints(set, problem, constraints)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(constraints_t), intent(out) :: constraints
      integer :: nvar

      nvar = size(problem%parameters%variables)
      constraints%bounded = set%limits%limval == 1
      if (constraints%bounded) then
         constraints%low = set%limits%oplow(:nvar)
         constraints%high = set%limits%ophigh(:nvar)
      end if
      constraints%positive = problem%parameters%variables%kind == variable_length .or. &
                             problem%parameters%variables%kind == variable_outlk .or. &
                             problem%parameters%variables%kind == variable_aside
      constraints%step_in = set%limits%stepin
      constraints%passed_over = set%limits%nviol
      constraints%dimensions = problem%given
      allocate (constraints%reach(problem%positions), source=0.0_wp)
   end subroutine make_constraints

   !> The search by the simplex of a problem, which must outlive it.
   subroutine make_vertex_problem(set, problem, search)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in), target :: problem
      type(vertex_problem_t), intent(out) :: search

      search%problem => problem
      call make_constraints(set, problem, search%constraints)
      if (allocated(problem%rate_desired)) then
         allocate (search%rates)
         call prepare_desired_rates(problem, .false., .false., search%rates)
      end if
      if (allocated(problem%target_values)) then
         allocate (search%targets)
         call prepare_output_targets(set, problem, .false., .false., search%targets)
      end if
      search%core = size(problem%parameters%variables)
      allocate (search%counts%failures(problem%mechanism%nloop))
      search%low = spread(-huge(1.0_wp), 1, search%core)
      search%high = -search%low
      if (search%constraints%bounded) then
         search%low = search%constraints%low
         search%high = search%constraints%high
      end if
   end subroutine make_vertex_problem

   !> Objective, and 1 where the linkage does not obey: how much it violates is not measured.
   subroutine measure(self, x, objective, violation)
      class(vertex_problem_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective, violation
      logical :: feasible

      call self%accept(x, objective, feasible)
      violation = merge(0.0_wp, 1.0_wp, feasible)
   end subroutine measure

   !> Does a vertex, as it is, close within its limits and bounds?
   subroutine accept(self, x, objective, feasible)
      class(vertex_problem_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      integer :: loop

      call self%problem%parameters%apply(x, self%constraints%dimensions)
      call self%problem%evaluate(self%constraints%dimensions, objective, loop)
      self%evaluations = self%evaluations + 1
      feasible = loop == 0 .and. .not. any(x < self%low .or. x > self%high)
      if (loop == 0) call add_rate_errors(self, objective)
      feasible = feasible .and. objective <= huge(objective)
   end subroutine accept

   !> Add the errors of derivatives and of further outputs, where they are wanted, to the objective of the linkage just evaluated.
   subroutine add_rate_errors(search, objective)
      class(vertex_problem_t), intent(inout) :: search
      real(wp), intent(inout) :: objective

      if (allocated(search%targets)) then
         call find_output_targets(search%targets, search%constraints%dimensions)
         objective = objective + sum_of_desired_errors(search%targets)
      end if
      if (.not. allocated(search%rates)) return
      call find_desired_rates(search%rates, search%constraints%dimensions)
      objective = objective + sum_of_rate_errors(search%rates)
      if (.not. all_rates_exist(search%rates)) objective = without_rates
   end subroutine add_rate_errors

   !> Make a vertex obey.
   subroutine settle(self, x, objective, feasible, towards)
      class(vertex_problem_t), intent(inout) :: self
      real(wp), intent(inout) :: x(:)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      real(wp), intent(in), optional :: towards(:)

      call constrain(self%problem, self%constraints, x, objective, feasible, self%evaluations, self%counts, towards)
      if (feasible) call add_rate_errors(self, objective)
   end subroutine settle

   !> Objective of a vertex, altered where the constraints demand it.
   !>
   !> With `towards`, a vertex whose demands conflict moves towards it; without, `feasible` is false then.
   subroutine constrain(problem, constraints, values, objective, feasible, evaluations, counts, towards)
      type(problem_t), intent(inout) :: problem
      type(constraints_t), intent(inout) :: constraints
      real(wp), intent(inout) :: values(:)             !! shape (nvar)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      integer, intent(inout) :: evaluations            !! counts up
      type(repair_count_t), intent(inout) :: counts    !! counts up
      real(wp), intent(in), optional :: towards(:)     !! shape (nvar): a feasible vertex
      integer :: loop, repairs, moves
      logical :: repaired

      moves = 0
      each_place: do
         repairs = 0
         call clip(constraints, values, counts%clips)
         do
            call problem%parameters%apply(values, constraints%dimensions)
            call problem%evaluate(constraints%dimensions, objective, loop)
            evaluations = evaluations + 1
            feasible = loop == 0
            if (feasible) return
            counts%calls = counts%calls + 1
            counts%loop = loop
            if (allocated(counts%failures)) call note_failure(problem, constraints, loop, counts%failures)
            repairs = repairs + 1
            if (repairs > repairs_per_loop*problem%mechanism%nloop) exit
            call repair(problem, constraints, loop, values, repaired)
            if (.not. repaired) exit
            counts%repairs = counts%repairs + 1
         end do
         if (.not. present(towards)) return
         moves = moves + 1
         if (moves > most_moves) then
            values = towards
         else
            values = values + quarter*(towards - values)
         end if
         if (moves > most_moves + 1) return
         counts%moves = counts%moves + 1
      end do each_place
   end subroutine constrain

   !> Count a violation; beyond those that are passed over find out how bad it is.
   subroutine note_failure(problem, constraints, loop, failures)
      type(problem_t), intent(inout) :: problem          !! bound to the linkage
      type(constraints_t), intent(in) :: constraints
      integer, intent(in) :: loop
      type(failure_t), intent(inout) :: failures(:)      !! shape (loops)
      type(violation_t) :: violation
      real(wp) :: input(1)

      associate (failure => failures(loop))
         failure%times = failure%times + 1
         if (sum(failures%times) <= constraints%passed_over) return
         call problem%worst_of(loop, violation)
         if (violation%kind == violation_none) return    ! two slides on the other side of each other
         if (failure%kind /= violation_none) then
            if (.not. problem%is_worse(violation%kind, violation%amount, failure%kind, failure%amount)) return
         end if
         failure%kind = violation%kind
         failure%amount = violation%amount
         input = input_at(problem%mechanism, constraints%dimensions, problem%delt([violation%worst]))
         failure%place = input(1)
      end associate
   end subroutine note_failure

   !> Put values that are out of bounds a little inside; lengths stay positive.
   pure subroutine clip(constraints, values, clips)
      type(constraints_t), intent(in) :: constraints
      real(wp), intent(inout) :: values(:)
      integer, intent(inout) :: clips
      integer :: i
      real(wp) :: before

      do i = 1, size(values)
         before = values(i)
         if (constraints%bounded) then
            associate (low => constraints%low(i), high => constraints%high(i), step => constraints%step_in)
               if (values(i) < low) values(i) = min(low + step, 0.5_wp*(low + high))
               if (values(i) > high) values(i) = max(high - step, 0.5_wp*(low + high))
            end associate
         end if
         if (constraints%positive(i) .and. values(i) <= 0.0_wp) values(i) = max(constraints%step_in, epsilon(1.0_wp))
         if (values(i) /= before) clips = clips + 1
      end do
   end subroutine clip

   !> Change the variable lengths of the dyad of `loop` so that it is accepted at every position.
   subroutine repair(problem, constraints, loop, values, repaired)
      type(problem_t), intent(inout) :: problem
      type(constraints_t), intent(inout) :: constraints
      integer, intent(in) :: loop
      real(wp), intent(inout) :: values(:)
      logical, intent(out) :: repaired
      integer :: vp, vq
      real(wp) :: lengths(2)

      repaired = .false.
      ! lengths of a larger group have no closed form
      if (.not. problem%mechanism%is_dyad(loop)) return
      associate (mechanism => problem%mechanism, parameters => problem%parameters, reach => constraints%reach, &
                 arcl => constraints%dimensions%arcl)
         associate (arc_p => mechanism%groups(loop)%members(1), arc_q => mechanism%groups(loop)%members(2))
            vp = parameters%length_variable(arc_p)
            vq = parameters%length_variable(arc_q)
            lengths = arcl([arc_p, arc_q])
         end associate
         if (vp == 0 .and. vq == 0) return
         call problem%measure_of(loop, reach)
         call repair_dyad(mechanism%groups(loop)%kind, reach, problem%tangle, problem%toggle, [vp, vq] > 0, lengths, repaired)
      end associate
      if (.not. repaired) return
      if (vp > 0) call change(vp, lengths(1))
      if (vq > 0) call change(vq, lengths(2))

   contains

      subroutine change(variable, value)
         integer, intent(in) :: variable
         real(wp), intent(in) :: value

         if (constraints%bounded) then
            if (value < constraints%low(variable) .or. value > constraints%high(variable)) repaired = .false.
         end if
         values(variable) = value
      end subroutine change
   end subroutine repair
end module psalm_constr
