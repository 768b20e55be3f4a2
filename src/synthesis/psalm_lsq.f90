!> Least squares with the exact Jacobian: the method of Levenberg and Marquardt, with every constraint of CONSTR.
!>
!> Transmission angles and closure margins enter as squared violations whose weight grows until they vanish; a step to a
!> linkage that does not close is refused like one that does not improve. Bounds and positive lengths: values stop at them,
!> and a value that wants to pass its bound is held there. Source of the method: Levenberg (1944), Marquardt (1963), the
!> damping of Nielsen (1999).
!>
!> With free timing (IFREE) every input position is an unknown too. It meets only its own position's errors, so these unknowns
!> are eliminated one by one (a division each) before the equations of the dimensions are solved.
module psalm_lsq
   use psalm_angles, only: unit_vector
   use psalm_data_set, only: data_set_t, motion_point
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, right_angle
   use psalm_lapack, only: solve_positive
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, find_jacobian, find_constraints
   use psalm_topology, only: dimensions_t, variable_t, variable_length, variable_outlk, variable_crnki
   implicit none (type, external)
   private
   public :: lsq_t, prepare_lsq, improve

   integer, parameter :: most_iterations = 400       !! for one weight of the violations
   integer, parameter :: weights = 6                 !! weights of the violations tried, each 100 times the one before
   real(wp), parameter :: weight_step = 100.0_wp
   real(wp), parameter :: slack = 1.0e-7_wp          !! constraints are aimed this far inside their limits
   real(wp), parameter :: no_better = 1.0e-9_wp      !! relative gain of a step below which it is one of the last
   integer, parameter :: most_idle = 4               !! such steps in a row end the search
   real(wp), parameter :: first_damping = 1.0e-2_wp
   real(wp), parameter :: largest_damping = 1.0e12_wp
   real(wp), parameter :: least_length = 1.0e-6_wp   !! of the first value: what positive means

   !> A problem made ready, with room to work in. One object serves one thread.
   type :: lsq_t
      type(problem_t) :: problem                     !! closure only: transmission angles are constraints here
      type(problem_t) :: judge                       !! with the user's limits: what counts in the end
      type(sensitivity_t) :: work
      type(dimensions_t) :: dimensions
      real(wp), allocatable :: low(:), high(:)       !! shape (marble): bounds
      real(wp), allocatable :: limit(:)              !! by loop: of abs(k)
      real(wp), allocatable :: dx(:, :), dy(:, :), k(:, :), dk(:, :, :), miss(:, :)
      real(wp), allocatable :: matrix(:, :), gradient(:)
      logical :: free = .false.                      !! free timing
      real(wp), allocatable :: delt(:)               !! shape (positions): input increments, found with free timing
      real(wp), allocatable :: border(:, :)          !! shape (marble, positions): timing against dimensions
      real(wp), allocatable :: edge(:), edge_gradient(:) !! shape (positions): timing against itself, and its gradient
      integer :: evaluations = 0, jacobians = 0
   end type lsq_t

contains

   !> Make a search ready. `first` is the linkage the bounds of lengths are derived from where none are given.
   subroutine prepare_lsq(set, problem, first, lsq)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem        !! with desired values
      real(wp), intent(in) :: first(:)              !! shape (marble)
      type(lsq_t), intent(out) :: lsq
      integer :: marble, n, loop
      real(wp) :: cosine, unused
      type(variable_t) :: input

      marble = size(problem%topology%variables)
      n = problem%positions
      lsq%judge = problem
      call lsq%judge%set_inputs(problem%delt)
      call copy_desired(problem, lsq%judge)
      lsq%problem = problem
      lsq%problem%tangle = right_angle
      lsq%free = set%ifree /= 0
      lsq%delt = problem%delt
      if (lsq%free) then
         ! one more column: the input of each position
         input%kind = variable_crnki
         lsq%problem%topology%variables = [problem%topology%variables, input]
         allocate (lsq%border(marble, n), lsq%edge(n), lsq%edge_gradient(n), source=0.0_wp)
      end if
      call lsq%problem%set_inputs(problem%delt)
      call lsq%problem%want_derivatives(.false.)
      call copy_desired(problem, lsq%problem)
      call prepare_sensitivity(lsq%problem, lsq%work)
      lsq%dimensions = problem%given
      lsq%low = spread(-huge(1.0_wp), 1, marble)
      lsq%high = -lsq%low
      if (set%limval == 1) then
         lsq%low = set%oplow(:marble) + set%stepin
         lsq%high = set%ophigh(:marble) - set%stepin
      end if
      where (problem%topology%variables%kind == variable_length .or. problem%topology%variables%kind == variable_outlk)
         lsq%low = max(lsq%low, least_length*abs(first))
      end where
      call unit_vector(right_angle - set%tangle, cosine, unused)
      allocate (lsq%limit(problem%topology%nloop))
      do loop = 1, problem%topology%nloop
         lsq%limit(loop) = merge(cosine, 1.0_wp, problem%topology%joint(loop) == 1) - slack
      end do
      associate (columns => size(lsq%problem%topology%variables))
         allocate (lsq%dx(n, columns), lsq%dy(n, columns), lsq%k(n, problem%topology%nloop), &
                   lsq%dk(n, problem%topology%nloop, columns), lsq%miss(n, 2), source=0.0_wp)
      end associate
      allocate (lsq%matrix(marble, marble), lsq%gradient(marble), source=0.0_wp)
   end subroutine prepare_lsq

   subroutine copy_desired(from, to)
      type(problem_t), intent(in) :: from
      type(problem_t), intent(inout) :: to

      associate (n => from%positions)
         if (from%motion == motion_point) then
            call to%set_desired(from%wanted(:n), from%weight(:n), from%wanted_y(:n), from%weight_y(:n))
         else
            call to%set_desired(from%wanted(:n), from%weight(:n))
         end if
      end associate
   end subroutine copy_desired

   !> Improve a linkage that closes at every position. `feasible` tells whether the result obeys every constraint.
   subroutine improve(lsq, values, objective, feasible)
      type(lsq_t), intent(inout) :: lsq
      real(wp), intent(inout) :: values(:)          !! shape (marble)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      real(wp) :: weight, merit
      integer :: round, loop
      logical :: closed

      values = min(max(values, lsq%low), lsq%high)
      feasible = .false.
      call measure(lsq, values, lsq%delt, 0.0_wp, merit, objective, closed)
      if (.not. closed) return
      weight = max(objective, tiny(1.0_wp)**0.5_wp)
      do round = 1, weights
         call descend(lsq, values, weight)
         call lsq%judge%topology%apply(values, lsq%dimensions)
         if (lsq%free) call lsq%judge%move_inputs(lsq%delt)
         call lsq%judge%evaluate(lsq%dimensions, objective, loop)
         lsq%evaluations = lsq%evaluations + 1
         feasible = loop == 0
         if (feasible) return
         weight = weight*weight_step
      end do
   end subroutine improve

   !> Put values and, with free timing, input increments in.
   subroutine put_in(lsq, values, delt)
      type(lsq_t), intent(inout) :: lsq
      real(wp), intent(in) :: values(:), delt(:)

      if (lsq%free) call lsq%problem%move_inputs(delt)
      ! the judge's variables are the user's; here one more may stand for the input
      call lsq%judge%topology%apply(values, lsq%dimensions)
   end subroutine put_in

   !> Objective, and merit: objective + weight * squared violations. `closed` is false where the linkage does not close.
   subroutine measure(lsq, values, delt, weight, merit, objective, closed)
      type(lsq_t), intent(inout) :: lsq
      real(wp), intent(in) :: values(:), delt(:), weight
      real(wp), intent(out) :: merit, objective
      logical, intent(out) :: closed
      integer :: loop

      call put_in(lsq, values, delt)
      call lsq%problem%deviations(lsq%dimensions, lsq%miss, loop)
      lsq%evaluations = lsq%evaluations + 1
      closed = loop == 0
      objective = huge(objective)
      merit = huge(merit)
      if (.not. closed) return
      associate (n => lsq%problem%positions)
         objective = sum(lsq%problem%weight(:n)*lsq%miss(:, 1)**2)
         if (lsq%problem%motion == motion_point) objective = objective + sum(lsq%problem%weight_y(:n)*lsq%miss(:, 2)**2)
      end associate
      merit = objective
      if (weight <= 0.0_wp) return
      call find_constraints(lsq%problem, lsq%k)
      do loop = 1, size(lsq%limit)
         merit = merit + weight*sum(max(abs(lsq%k(:, loop)) - lsq%limit(loop), 0.0_wp)**2)
      end do
   end subroutine measure

   !> Descend to a minimum of the merit for one weight of the violations.
   subroutine descend(lsq, values, weight)
      type(lsq_t), intent(inout) :: lsq
      real(wp), intent(inout) :: values(:)
      real(wp), intent(in) :: weight
      real(wp) :: trial(size(values)), step(size(values)), right(size(values)), damped(size(values), size(values))
      real(wp) :: trial_delt(size(lsq%delt)), turn(size(lsq%delt))
      real(wp) :: merit, trial_merit, objective, damping, growth, gain, promised
      logical :: held(size(values)), sound, closed
      integer :: iteration, idle, v

      call measure(lsq, values, lsq%delt, weight, merit, objective, closed)
      if (.not. closed) return
      damping = first_damping
      growth = 2.0_wp
      idle = 0
      call form_equations(lsq, values, weight)
      do iteration = 1, most_iterations
         ! a value at its bound that wants to pass it is held
         held = (values <= lsq%low .and. lsq%gradient > 0.0_wp) .or. (values >= lsq%high .and. lsq%gradient < 0.0_wp)
         damped = lsq%matrix
         right = -lsq%gradient
         if (lsq%free) call eliminate(lsq, damping, damped, right)
         do v = 1, size(values)
            damped(v, v) = damped(v, v) + lsq%matrix(v, v)*damping + tiny(1.0_wp)**0.25_wp
            if (.not. held(v)) cycle
            damped(:, v) = 0.0_wp
            damped(v, :) = 0.0_wp
            damped(v, v) = 1.0_wp
            right(v) = 0.0_wp
         end do
         call solve_positive(damped, right, step, sound)
         trial = min(max(values + step, lsq%low), lsq%high)
         step = trial - values
         trial_delt = lsq%delt
         if (lsq%free) trial_delt = lsq%delt - (lsq%edge_gradient + matmul(step, lsq%border))/damped_edge(lsq, damping)
         trial_merit = huge(trial_merit)
         if (sound) call measure(lsq, trial, trial_delt, weight, trial_merit, objective, closed)
         if (trial_merit < merit) then
            ! against what the linear model promised
            promised = -2.0_wp*dot_product(lsq%gradient, step) - dot_product(step, matmul(lsq%matrix, step))
            if (lsq%free) then
               turn = trial_delt - lsq%delt
               promised = promised - 2.0_wp*dot_product(lsq%edge_gradient + matmul(step, lsq%border), turn) &
                          - sum(lsq%edge*turn**2)
               lsq%delt = trial_delt
            end if
            gain = (merit - trial_merit)/max(promised, tiny(1.0_wp))
            idle = merge(idle + 1, 0, merit - trial_merit <= no_better*merit)
            values = trial
            merit = trial_merit
            if (idle >= most_idle) return
            damping = damping*max(1.0_wp/3.0_wp, 1.0_wp - (2.0_wp*min(gain, 2.0_wp) - 1.0_wp)**3)
            growth = 2.0_wp
            call form_equations(lsq, values, weight)
         else
            damping = damping*growth
            growth = 2.0_wp*growth
            if (damping > largest_damping) return
         end if
      end do
   end subroutine descend

   !> Second derivative of the merit by each input position, damped.
   pure function damped_edge(lsq, damping) result(edge)
      type(lsq_t), intent(in) :: lsq
      real(wp), intent(in) :: damping
      real(wp) :: edge(size(lsq%edge))

      edge = lsq%edge*(1.0_wp + damping) + tiny(1.0_wp)**0.25_wp
   end function damped_edge

   !> Take the input positions out of the equations of the dimensions.
   subroutine eliminate(lsq, damping, matrix, right)
      type(lsq_t), intent(in) :: lsq
      real(wp), intent(in) :: damping
      real(wp), intent(inout) :: matrix(:, :), right(:)
      real(wp) :: edge(size(lsq%edge))
      integer :: i, a

      edge = damped_edge(lsq, damping)
      do i = 1, size(edge)
         right = right + lsq%border(:, i)*(lsq%edge_gradient(i)/edge(i))
         do a = 1, size(right)
            matrix(:, a) = matrix(:, a) - lsq%border(:, i)*(lsq%border(a, i)/edge(i))
         end do
      end do
   end subroutine eliminate

   !> Gradient and matrix of the normal equations: J^T W r and J^T W J of errors and violations.
   subroutine form_equations(lsq, values, weight)
      type(lsq_t), intent(inout) :: lsq
      real(wp), intent(in) :: values(:), weight
      integer :: loop, i, a, b
      real(wp) :: over

      call put_in(lsq, values, lsq%delt)
      call lsq%problem%deviations(lsq%dimensions, lsq%miss, loop)
      call find_jacobian(lsq%problem, lsq%dimensions, lsq%work, lsq%dx, lsq%dy, lsq%k, lsq%dk)
      lsq%jacobians = lsq%jacobians + 1
      associate (n => lsq%problem%positions, w => lsq%problem%weight, u => lsq%problem%weight_y)
         do a = 1, size(values)
            lsq%gradient(a) = sum(w(:n)*lsq%miss(:, 1)*lsq%dx(:, a))
            do b = 1, a
               lsq%matrix(b, a) = sum(w(:n)*lsq%dx(:, a)*lsq%dx(:, b))
            end do
            if (lsq%problem%motion /= motion_point) cycle
            lsq%gradient(a) = lsq%gradient(a) + sum(u(:n)*lsq%miss(:, 2)*lsq%dy(:, a))
            do b = 1, a
               lsq%matrix(b, a) = lsq%matrix(b, a) + sum(u(:n)*lsq%dy(:, a)*lsq%dy(:, b))
            end do
         end do
      end associate
      do loop = 1, size(lsq%limit)
         do i = 1, size(lsq%k, 1)
            over = abs(lsq%k(i, loop)) - lsq%limit(loop)
            if (over <= 0.0_wp) cycle
            over = sign(over, lsq%k(i, loop))
            do a = 1, size(values)
               lsq%gradient(a) = lsq%gradient(a) + weight*over*lsq%dk(i, loop, a)
               do b = 1, a
                  lsq%matrix(b, a) = lsq%matrix(b, a) + weight*lsq%dk(i, loop, a)*lsq%dk(i, loop, b)
               end do
            end do
         end do
      end do
      if (lsq%free) call form_border(lsq, size(values), weight)
      do a = 1, size(values)
         do b = 1, a - 1
            lsq%matrix(a, b) = lsq%matrix(b, a)
         end do
      end do
   end subroutine form_equations

   !> The equations of the input positions: each against itself and against the dimensions.
   subroutine form_border(lsq, marble, weight)
      type(lsq_t), intent(inout) :: lsq
      integer, intent(in) :: marble
      real(wp), intent(in) :: weight
      real(wp) :: over
      integer :: i, loop, t

      t = marble + 1
      do i = 1, size(lsq%delt)
         lsq%edge(i) = lsq%problem%weight(i)*lsq%dx(i, t)**2
         lsq%edge_gradient(i) = lsq%problem%weight(i)*lsq%dx(i, t)*lsq%miss(i, 1)
         lsq%border(:, i) = lsq%problem%weight(i)*lsq%dx(i, t)*lsq%dx(i, :marble)
         if (lsq%problem%motion == motion_point) then
            lsq%edge(i) = lsq%edge(i) + lsq%problem%weight_y(i)*lsq%dy(i, t)**2
            lsq%edge_gradient(i) = lsq%edge_gradient(i) + lsq%problem%weight_y(i)*lsq%dy(i, t)*lsq%miss(i, 2)
            lsq%border(:, i) = lsq%border(:, i) + lsq%problem%weight_y(i)*lsq%dy(i, t)*lsq%dy(i, :marble)
         end if
         do loop = 1, size(lsq%limit)
            over = abs(lsq%k(i, loop)) - lsq%limit(loop)
            if (over <= 0.0_wp) cycle
            over = sign(over, lsq%k(i, loop))
            lsq%edge(i) = lsq%edge(i) + weight*lsq%dk(i, loop, t)**2
            lsq%edge_gradient(i) = lsq%edge_gradient(i) + weight*over*lsq%dk(i, loop, t)
            lsq%border(:, i) = lsq%border(:, i) + weight*lsq%dk(i, loop, t)*lsq%dk(i, loop, :marble)
         end do
      end do
   end subroutine form_border
end module psalm_lsq
