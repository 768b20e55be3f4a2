!> Least squares with the exact Jacobian: the method of Levenberg and Marquardt, with every constraint.
!>
!> Violated constraints enter as squares whose weight grows until they vanish; a search may pass through points that violate
!> them and come back. Bounds: values stop at them, and a value that wants to pass its bound is held there.
!> Source of the method: Levenberg (1944), Marquardt (1963), the damping of Nielsen (1999); of linear unknowns, Golub and
!> Pereyra (1973).
!>
!> Local unknowns are eliminated one by one (a division each) before the equations of the core ones are solved. What the
!> problem projects is projected after every step; unknowns that enter residuals linearly are then given their best values.
module psalm_least_squares
   use psalm_kinds, only: wp
   use psalm_linear, only: solve_positive, along_columns
   use psalm_nlp, only: nlp_t, normal_equations_t
   use psalm_solver, only: solver_t, ending_t, observer_t, search_state_t, stop_converged, stop_evaluations, stop_interrupted, &
                           stop_iterations, stop_refused, stop_small_objective
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: least_squares_t

   integer, parameter :: rough_iterations = 400      !! the same where the search is a rough one
   real(wp), parameter :: rough = 1.0e-6_wp          !! least gain of such a search
   integer, parameter :: most_iterations = 5000      !! for one weight of the violations
   integer, parameter :: between_questions = 8       !! iterations until it is asked again whether the search is to stop
   integer, parameter :: weights = 6                 !! weights of the violations tried, each 100 times the one before
   real(wp), parameter :: weight_step = 100.0_wp
   real(wp), parameter :: loose = 1.0e-5_wp          !! least gain at the first weight where the search is hasty
   integer, parameter :: most_idle = 4               !! steps of too small a gain in a row that end the search
   real(wp), parameter :: slow_gain = 0.1_wp         !! relative gain of a step below which second derivatives are believed
   real(wp), parameter :: least_angle = 1.0e-6_wp    !! cosine below which a step teaches nothing about them
   real(wp), parameter :: first_damping = 1.0e-2_wp
   real(wp), parameter :: largest_damping = 1.0e12_wp
   real(wp), parameter :: least_damping = 1.0e-30_wp !! no digit of a step shows less; from zero it could not grow again

   type, extends(solver_t) :: least_squares_t
      type(normal_equations_t), private :: equations
   contains
      procedure :: minimise
   end type least_squares_t

contains

   !> Improve x. Refused: a problem that is no sum of squares.
   subroutine minimise(self, problem, x, stop, ending, observer)
      class(least_squares_t), intent(inout) :: self
      class(nlp_t), intent(inout), target :: problem
      real(wp), intent(inout) :: x(:)               !! shape (core + local)
      type(stop_t), intent(in), target :: stop
      type(ending_t), intent(out) :: ending
      class(observer_t), intent(inout), optional :: observer
      type(search_state_t) :: state
      real(wp) :: weight, violation, gain
      integer :: round, last

      ending%reason = stop_refused
      if (.not. problem%is_sum_of_squares) return
      problem%projects = .true.
      last = huge(last)
      if (self%most_evaluations > 0) last = problem%evaluations + min(self%most_evaluations, huge(1) - problem%evaluations)
      associate (core => problem%core)
         x(:core) = min(max(x(:core), problem%low), problem%high)
      end associate
      call problem%measure(x, ending%objective, violation)
      weight = max(ending%objective, problem%small)
      state%limit = weights
      do round = 1, weights
         ! what violates constraints by the first weight may lie in a long flat valley, which the next leaves anyway
         gain = self%least_gain
         if (self%hasty .and. round == 1) gain = max(gain, loose)
         call descend(problem, self%equations, x, weight, gain, last, stop, ending%reason)
         call problem%accept(x, ending%objective, ending%feasible)
         if (ending%feasible .and. gain > self%least_gain) then
            call descend(problem, self%equations, x, weight, self%least_gain, last, stop, ending%reason)
            call problem%accept(x, ending%objective, ending%feasible)
         end if
         if (present(observer)) then
            state%iteration = round
            state%evaluations = problem%evaluations
            state%best = ending%objective
            state%worst = ending%objective
            call observer%report(state)
         end if
         if (ending%feasible) exit
         if (problem%evaluations >= last) ending%reason = stop_evaluations
         if (stop%waiting()) ending%reason = stop_interrupted
         if (ending%reason == stop_evaluations .or. ending%reason == stop_interrupted) exit
         weight = weight*weight_step
      end do
   end subroutine minimise

   !> Descend to a minimum of the merit for one weight of the violations.
   subroutine descend(problem, equations, x, weight, least_gain, last, stop, reason)
      class(nlp_t), intent(inout) :: problem
      type(normal_equations_t), intent(inout) :: equations
      real(wp), intent(inout) :: x(:)
      real(wp), intent(in) :: weight, least_gain
      integer, intent(in) :: last                   !! evaluation to stop at
      type(stop_t), intent(in) :: stop
      integer, intent(out) :: reason                !! one of `stop_...`
      real(wp) :: trial(size(x)), turn(problem%local)
      real(wp) :: step(problem%core), moved(problem%core), right(problem%core), damped(problem%core, problem%core)
      real(wp) :: bend(problem%core, problem%core), before(problem%core)
      real(wp) :: total, trial_total, damping, growth, gain, promised
      logical :: held(problem%core), valid, slow, free
      integer :: iteration, idle, v, core

      core = problem%core
      free = problem%local > 0
      call weigh(problem, x, weight, total)
      damping = first_damping
      growth = 2.0_wp
      idle = 0
      bend = 0.0_wp
      slow = .false.
      call problem%linearise(x, weight, equations)
      do iteration = 1, merge(rough_iterations, most_iterations, least_gain > rough)
         reason = stop_evaluations
         if (problem%evaluations >= last) return
         reason = stop_interrupted
         if (mod(iteration, between_questions) == 1) then
            if (stop%waiting()) return
         end if
         ! a value at its bound that wants to pass it is held
         held = (x(:core) <= problem%low .and. equations%gradient > 0.0_wp) .or. &
                (x(:core) >= problem%high .and. equations%gradient < 0.0_wp)
         damped = equations%matrix
         if (slow) damped = damped + bend
         right = -equations%gradient
         if (free) call eliminate(equations, damping, damped, right)
         do v = 1, core
            damped(v, v) = damped(v, v) + equations%matrix(v, v)*damping + tiny(1.0_wp)**0.25_wp
            if (.not. held(v)) cycle
            damped(:, v) = 0.0_wp
            damped(v, :) = 0.0_wp
            damped(v, v) = 1.0_wp
            right(v) = 0.0_wp
         end do
         call solve_positive(damped, right, step, valid)
         trial_total = huge(trial_total)
         if (valid) then
            trial(:core) = min(max(x(:core) + step, problem%low), problem%high)
            step = trial(:core) - x(:core)
            if (free) then
               trial(core + 1:) = x(core + 1:) - (equations%edge_gradient + along_columns(equations%border, step)) &
                                  /damped_edge(equations, damping)
            end if
            call problem%project(trial)
            turn = trial(core + 1:) - x(core + 1:)
            call problem%fit_linear(trial)
            call weigh(problem, trial, weight, trial_total)
         end if
         if (trial_total < total) then
            ! against what the linear model promised
            promised = -2.0_wp*dot_product(equations%gradient, step) - dot_product(step, along_columns(equations%matrix, step))
            if (slow) promised = promised - dot_product(step, along_columns(bend, step))
            if (free) then
               promised = promised - 2.0_wp*dot_product(equations%edge_gradient + along_columns(equations%border, step), turn) &
                          - sum(equations%edge*turn**2)
            end if
            gain = 2.0_wp
            if (total - trial_total < 2.0_wp*promised) gain = (total - trial_total)/promised
            idle = merge(idle + 1, 0, total - trial_total <= least_gain*total)
            moved = trial(:core) - x(:core)
            x = trial
            slow = .not. free .and. total - trial_total < slow_gain*total
            total = trial_total
            reason = stop_converged
            if (idle >= most_idle) return
            reason = stop_small_objective
            if (total <= problem%floor) return
            damping = max(least_damping, damping*max(1.0_wp/3.0_wp, 1.0_wp - (2.0_wp*min(gain, 2.0_wp) - 1.0_wp)**3))
            growth = 2.0_wp
            before = equations%gradient
            call problem%linearise(x, weight, equations)
            call learn_bend(equations%matrix, moved, equations%gradient - before, bend)
         else if (slow) then
            slow = .false.
            damping = damping*growth
         else
            damping = damping*growth
            growth = 2.0_wp*growth
            reason = stop_converged
            if (damping > largest_damping) return
         end if
      end do
      reason = stop_iterations
   end subroutine descend

   !> The merit of a point.
   subroutine weigh(problem, x, weight, total)
      class(nlp_t), intent(inout) :: problem
      real(wp), intent(in) :: x(:), weight
      real(wp), intent(out) :: total
      real(wp) :: objective, violation

      call problem%measure(x, objective, violation)
      total = objective + weight*violation
   end subroutine weigh

   !> What the squares of first derivatives leave out of the second derivatives, learned from the last step (symmetric rank one).
   !>
   !> Source: the structured secant methods, Dennis, Gay and Welsch (1981); the update is that of Broyden and others (1967).
   pure subroutine learn_bend(matrix, step, change, bend)
      real(wp), intent(in) :: matrix(:, :)          !! shape (core, core): J^T J after the step
      real(wp), intent(in) :: step(:), change(:)    !! shape (core): of the values, of the gradient
      real(wp), intent(inout) :: bend(:, :)         !! shape (core, core)
      real(wp) :: missing(size(step)), along
      integer :: v

      missing = change - along_columns(matrix + bend, step)
      along = dot_product(missing, step)
      if (abs(along) <= least_angle*sqrt(sum(missing**2)*sum(step**2))) return
      do v = 1, size(step)
         bend(:, v) = bend(:, v) + missing*(missing(v)/along)
      end do
   end subroutine learn_bend

   !> Second derivative of the merit by each local unknown, damped.
   pure function damped_edge(equations, damping) result(edge)
      type(normal_equations_t), intent(in) :: equations
      real(wp), intent(in) :: damping
      real(wp) :: edge(size(equations%edge))

      edge = equations%edge*(1.0_wp + damping) + tiny(1.0_wp)**0.25_wp
   end function damped_edge

   !> Take the local unknowns out of the equations of the core ones.
   subroutine eliminate(equations, damping, matrix, right)
      type(normal_equations_t), intent(in) :: equations
      real(wp), intent(in) :: damping
      real(wp), intent(inout) :: matrix(:, :), right(:)
      real(wp) :: edge(size(equations%edge))
      integer :: i, a

      edge = damped_edge(equations, damping)
      do i = 1, size(edge)
         right = right + equations%border(:, i)*(equations%edge_gradient(i)/edge(i))
         do a = 1, size(right)
            matrix(:, a) = matrix(:, a) - equations%border(:, i)*(equations%border(a, i)/edge(i))
         end do
      end do
   end subroutine eliminate
end module psalm_least_squares
