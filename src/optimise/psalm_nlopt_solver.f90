!> A search by an algorithm of NLopt.
!>
!> Algorithms that take nonlinear constraints get every one of them; the others minimise the merit with a weight of the
!> violations that grows until they vanish. What a global algorithm finds is made to obey by a local one that takes
!> constraints, COBYLA or SLSQP.
module psalm_nlopt_solver
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_positive_inf
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_loc, c_ptr
   use psalm_kinds, only: wp
   use psalm_nlopt, only: nlopt_t, refused
   use psalm_nlp, only: nlp_t, normal_equations_t
   use psalm_solver, only: solver_t, ending_t, observer_t, search_state_t, stop_converged, stop_evaluations, stop_interrupted, &
                           stop_refused
   use psalm_solver_kind, only: solver_kind_t, find_solver
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: nlopt_solver_t

   integer, parameter :: weights = 6                  !! weights of the violations tried, each 100 times the one before
   real(wp), parameter :: weight_step = 100.0_wp
   real(wp), parameter :: global_weight = 1.0e4_wp    !! first weight of a global algorithm, in first objectives
   integer, parameter :: usual_evaluations = 2000     !! for each unknown and one more
   real(wp), parameter :: care = 1.0e6_wp             !! first objectives a violation of 1 counts as, among points to keep
   real(wp), parameter :: ftol = 1.0e-10_wp, xtol = 1.0e-9_wp
   real(wp), parameter :: unbounded = 0.5_wp*huge(1.0_wp) !! bounds beyond it are none
   real(wp), parameter :: tolerance = 1.0e-8_wp       !! of the constraints: less than they are aimed inside their limits
   character(*), parameter :: local_with_gradient = 'LD_SLSQP', local_without = 'LN_COBYLA' !! that take constraints

   type, extends(solver_t) :: nlopt_solver_t
      type(solver_kind_t) :: kind
   contains
      procedure :: minimise
   end type nlopt_solver_t

   interface nlopt_solver_t
      procedure make_solver
   end interface nlopt_solver_t

   !> What the functions NLopt calls need.
   type :: context_t
      class(nlp_t), pointer :: problem => null()
      type(stop_t), pointer :: stop => null()
      type(nlopt_t) :: optimiser
      type(normal_equations_t) :: equations
      real(wp) :: weight = 0.0_wp, care = 0.0_wp
      real(wp), allocatable :: x(:)
      real(wp), allocatable :: slopes(:, :), limits(:)
      real(wp), allocatable :: kept(:)                !! lowest merit seen
      real(wp) :: lowest = huge(1.0_wp)
      real(wp), allocatable :: obedient(:)            !! lowest objective seen where nothing is violated
      real(wp) :: least = huge(1.0_wp)                !! of these; over all runs
      integer :: last = huge(1)                       !! evaluation after which a stop is forced
      logical :: converged = .false.                  !! the last run ended by itself
   end type context_t

contains

   pure type(nlopt_solver_t) function make_solver(kind) result(solver)
      type(solver_kind_t), intent(in) :: kind

      solver%kind = kind
   end function make_solver

   !> Improve x. Refused: what NLopt cannot do, an algorithm with gradients for a problem without.
   subroutine minimise(self, problem, x, stop, ending, observer)
      class(nlopt_solver_t), intent(inout) :: self
      class(nlp_t), intent(inout), target :: problem
      real(wp), intent(inout) :: x(:)                    !! shape (core + local)
      type(stop_t), intent(in), target :: stop
      type(ending_t), intent(out) :: ending
      class(observer_t), intent(inout), optional :: observer
      type(context_t), target :: context
      type(search_state_t) :: state
      real(wp) :: low(size(x)), high(size(x)), violation
      integer :: round, last, share
      logical :: valid

      ending%reason = stop_refused
      if (self%kind%uses_gradient .and. .not. problem%has_gradient) return
      problem%projects = .false.
      associate (core => problem%core)
         x(:core) = min(max(x(:core), problem%low), problem%high)
         call problem%search_box(x, low, high)
         if (self%kind%global) x(:core) = min(max(x(:core), low(:core)), high(:core))
      end associate
      context%problem => problem
      context%stop => stop
      context%x = x
      share = merge(self%most_evaluations, usual_evaluations*(size(x) + 1), self%most_evaluations > 0)
      last = problem%evaluations + share
      call problem%measure(x, ending%objective, violation)
      call keep(context, ending%objective, ending%objective, violation)
      context%care = care*max(ending%objective, problem%small)
      state%limit = 1
      if (self%kind%takes_constraints) then
         call run(self%kind, self%seed, context, last, valid)
         call settle(1)
      else if (self%kind%global) then
         context%weight = max(ending%objective, problem%small)*global_weight
         call run(self%kind, self%seed, context, last - share/weights, valid)
         call settle(1)
         context%weight = 0.0_wp
         if (valid .and. .not. ending%feasible .and. .not. stop%waiting()) then
            call run(find_solver(merge(local_with_gradient//' ', local_without, self%kind%uses_gradient)), self%seed, context, &
                     last, valid)
            call settle(2)
         end if
      else
         context%weight = max(ending%objective, problem%small)
         state%limit = weights
         do round = 1, weights
            call run(self%kind, self%seed, context, &
                     problem%evaluations + max(1, (last - problem%evaluations)/(weights + 1 - round)), valid)
            call settle(round)
            if (.not. valid .or. problem%evaluations >= last .or. stop%waiting()) exit
            if (ending%feasible .and. context%converged) exit
            if (.not. ending%feasible) context%weight = context%weight*weight_step
         end do
      end if
      ending%reason = merge(stop_converged, stop_evaluations, context%converged)
      if (stop%waiting()) ending%reason = stop_interrupted
      if (.not. valid) ending%reason = stop_refused

   contains

      !> The best of what was seen, as it is to be.
      subroutine settle(round)
         integer, intent(in) :: round

         x = context%kept
         call problem%project(x)
         call problem%accept(x, ending%objective, ending%feasible)
         if (.not. (ending%feasible .and. ending%objective <= context%least) .and. allocated(context%obedient)) then
            x = context%obedient
            call problem%accept(x, ending%objective, ending%feasible)
         end if
         context%x(problem%core + 1:) = x(problem%core + 1:)
         if (.not. present(observer)) return
         state%iteration = round
         state%evaluations = problem%evaluations
         state%best = ending%objective
         state%worst = ending%objective
         call observer%report(state)
      end subroutine settle
   end subroutine minimise

   !> One optimisation with one weight, from `context%x`.
   subroutine run(kind, seed, context, last, valid)
      type(solver_kind_t), intent(in) :: kind
      integer, intent(in) :: seed, last
      type(context_t), intent(inout), target :: context
      logical, intent(out) :: valid
      real(c_double), allocatable :: x(:), low(:), high(:)
      real(wp) :: box_low(size(context%x)), box_high(size(context%x))
      real(c_double) :: least
      integer :: status, core, n, m

      core = context%problem%core
      n = size(context%x)
      m = 0
      if (kind%takes_constraints) m = context%problem%count_constraints()
      context%limits = spread(0.0_wp, 1, m)
      context%slopes = reshape([real(wp) ::], [n, merge(m, 0, kind%uses_gradient)], pad=[0.0_wp])
      allocate (x(n), low(n), high(n))
      x = real(context%x, c_double)
      ! what NLopt takes for no bound at all
      high = ieee_value(1.0_c_double, ieee_positive_inf)
      low = -high
      where (context%problem%low > -unbounded) low(:core) = real(context%problem%low, c_double)
      where (context%problem%high < unbounded) high(:core) = real(context%problem%high, c_double)
      if (kind%global) then
         call context%problem%search_box(context%x, box_low, box_high)
         where (box_low > -unbounded) low = max(low, real(box_low, c_double))
         where (box_high < unbounded) high = min(high, real(box_high, c_double))
      end if
      x = min(max(x, low), high)
      context%lowest = huge(1.0_wp)
      context%kept = context%x
      context%last = last
      call context%optimiser%open(kind, n, seed, valid)
      if (valid) call context%optimiser%set_bounds(low, high, valid)
      if (valid .and. m > 0) call context%optimiser%set_constraints(m, constraint_values, c_loc(context), &
                                                                    real(tolerance, c_double), valid)
      if (valid) then
         call context%optimiser%set_limits(real(ftol, c_double), real(xtol, c_double), max(1, last - context%problem%evaluations))
         call context%optimiser%minimise(merit_value, c_loc(context), x, least, status)
         valid = .not. refused(status)
         context%converged = context%problem%evaluations < last
      end if
      call context%optimiser%close()
      context%x = context%kept
   end subroutine run

   !> The merit, for NLopt.
   real(c_double) function merit_value(n, x, gradient, data) bind(c)
      integer(c_int), value :: n
      real(c_double), intent(in) :: x(n)
      type(c_ptr), value :: gradient, data
      type(context_t), pointer :: context
      real(c_double), pointer :: slope(:)
      real(wp) :: total, objective, violation
      integer :: core

      call c_f_pointer(data, context)
      context%x = real(x, wp)
      associate (problem => context%problem)
         call problem%measure(context%x, objective, violation)
         total = objective
         if (context%weight > 0.0_wp) total = total + context%weight*violation
         merit_value = real(total, c_double)
         call keep(context, total, objective, violation)
         if (c_associated(gradient)) then
            call c_f_pointer(gradient, slope, [int(n)])
            call problem%linearise(context%x, context%weight, context%equations)
            core = problem%core
            slope(:core) = real(2.0_wp*context%equations%gradient, c_double)
            slope(core + 1:) = real(2.0_wp*context%equations%edge_gradient, c_double)
         end if
         if (problem%evaluations >= context%last .or. context%stop%waiting()) call context%optimiser%force_stop()
      end associate
   end function merit_value

   !> Remember the best point: violations count for more than in the merit.
   subroutine keep(context, total, objective, violation)
      type(context_t), intent(inout) :: context
      real(wp), intent(in) :: total, objective, violation

      if (violation <= 0.0_wp .and. objective < context%least) then
         context%least = objective
         context%obedient = context%x
      end if
      if (total + context%care*violation >= context%lowest) return
      context%lowest = total + context%care*violation
      context%kept = context%x
   end subroutine keep

   !> Every constraint, for NLopt.
   subroutine constraint_values(m, values, n, x, gradient, data) bind(c)
      integer(c_int), value :: m
      real(c_double), intent(out) :: values(m)
      integer(c_int), value :: n
      real(c_double), intent(in) :: x(n)
      type(c_ptr), value :: gradient, data
      type(context_t), pointer :: context
      real(c_double), pointer :: slopes(:, :)

      call c_f_pointer(data, context)
      context%x = real(x, wp)
      if (c_associated(gradient)) then
         call c_f_pointer(gradient, slopes, [int(n), int(m)])
         call context%problem%constrain(context%x, context%limits, context%slopes)
         slopes = real(context%slopes, c_double)
      else
         call context%problem%constrain(context%x, context%limits)
      end if
      values = real(context%limits, c_double)
   end subroutine constraint_values
end module psalm_nlopt_solver
