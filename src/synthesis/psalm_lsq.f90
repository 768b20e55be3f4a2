!> Least squares with the exact Jacobian: the method of Levenberg and Marquardt, with every constraint.
!>
!> Violated constraints enter as squares whose weight grows until they vanish; a search may pass through linkages that do not
!> close and come back. Bounds and positive lengths: values stop at them, and a value that wants to pass its bound is held
!> there. Source of the method: Levenberg (1944), Marquardt (1963), the damping of Nielsen (1999).
!>
!> With free timing the unknown inputs are eliminated one by one (a division each) before the equations of the dimensions are
!> solved. Inputs that must follow each other are put in order after every step.
module psalm_lsq
   use psalm_kinds, only: wp
   use psalm_linear, only: solve_positive, along_columns
   use psalm_merit, only: merit_t, measure, form_equations, obeys
   implicit none (type, external)
   private
   public :: improve, put_in_order

   integer, parameter :: rough_iterations = 400      !! the same where the search is a rough one
   real(wp), parameter :: rough = 1.0e-6_wp          !! least gain of such a search
   integer, parameter :: most_iterations = 5000      !! for one weight of the violations
   integer, parameter :: weights = 6                 !! weights of the violations tried, each 100 times the one before
   real(wp), parameter :: weight_step = 100.0_wp
   integer, parameter :: most_idle = 4               !! steps of too small a gain in a row that end the search
   real(wp), parameter :: slow_gain = 0.1_wp         !! relative gain of a step below which second derivatives are believed
   real(wp), parameter :: least_angle = 1.0e-6_wp    !! cosine below which a step teaches nothing about them
   real(wp), parameter :: first_damping = 1.0e-2_wp
   real(wp), parameter :: largest_damping = 1.0e12_wp

contains

   !> Improve a linkage. `feasible` tells whether the result obeys every constraint at the positions looked at.
   subroutine improve(merit, values, least_gain, most_evaluations, objective, feasible)
      type(merit_t), intent(inout) :: merit
      real(wp), intent(inout) :: values(:)          !! shape (marble)
      real(wp), intent(in) :: least_gain            !! relative gain of a step below which it is one of the last
      integer, intent(in) :: most_evaluations       !! at most about so many more evaluations
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      real(wp) :: weight, total
      integer :: round, last

      merit%order_weighs = .false.
      last = merit%evaluations + min(most_evaluations, huge(1) - merit%evaluations)
      values = min(max(values, merit%low), merit%high)
      call measure(merit, values, merit%delt, 0.0_wp, total, objective)
      weight = max(objective, merit%small)
      feasible = .false.
      do round = 1, weights
         call descend(merit, values, weight, least_gain, last)
         call obeys(merit, values, merit%delt, objective, feasible)
         if (feasible .or. merit%evaluations >= last .or. merit%interrupt%waiting()) return
         weight = weight*weight_step
      end do
   end subroutine improve

   !> Descend to a minimum of the merit for one weight of the violations.
   subroutine descend(merit, values, weight, least_gain, last)
      type(merit_t), intent(inout) :: merit
      real(wp), intent(inout) :: values(:)
      real(wp), intent(in) :: weight, least_gain
      integer, intent(in) :: last                   !! evaluation to stop at
      real(wp) :: trial(size(values)), step(size(values)), right(size(values)), damped(size(values), size(values))
      real(wp) :: trial_delt(size(merit%delt)), turn(size(merit%delt))
      real(wp) :: bend(size(values), size(values)), before(size(values))
      real(wp) :: total, trial_total, objective, damping, growth, gain, promised
      logical :: held(size(values)), sound, slow
      integer :: iteration, idle, v

      call measure(merit, values, merit%delt, weight, total, objective)
      damping = first_damping
      growth = 2.0_wp
      idle = 0
      bend = 0.0_wp
      slow = .false.
      call form_equations(merit, values, merit%delt, weight)
      do iteration = 1, merge(rough_iterations, most_iterations, least_gain > rough)
         if (merit%evaluations >= last .or. merit%interrupt%waiting()) return
         ! a value at its bound that wants to pass it is held
         held = (values <= merit%low .and. merit%gradient > 0.0_wp) .or. (values >= merit%high .and. merit%gradient < 0.0_wp)
         damped = merit%matrix
         if (slow) damped = damped + bend
         right = -merit%gradient
         if (merit%free) call eliminate(merit, damping, damped, right)
         do v = 1, size(values)
            damped(v, v) = damped(v, v) + merit%matrix(v, v)*damping + tiny(1.0_wp)**0.25_wp
            if (.not. held(v)) cycle
            damped(:, v) = 0.0_wp
            damped(v, :) = 0.0_wp
            damped(v, v) = 1.0_wp
            right(v) = 0.0_wp
         end do
         call solve_positive(damped, right, step, sound)
         trial_total = huge(trial_total)
         if (sound) then
            trial = min(max(values + step, merit%low), merit%high)
            step = trial - values
            trial_delt = merit%delt
            if (merit%free) then
               trial_delt = merit%delt - (merit%edge_gradient + along_columns(merit%border, step))/damped_edge(merit, damping)
               if (merit%ordered) call put_in_order(trial_delt, merit%sense, merit%span)
            end if
            call measure(merit, trial, trial_delt, weight, trial_total, objective)
         end if
         if (trial_total < total) then
            ! against what the linear model promised
            promised = -2.0_wp*dot_product(merit%gradient, step) - dot_product(step, along_columns(merit%matrix, step))
            if (slow) promised = promised - dot_product(step, along_columns(bend, step))
            if (merit%free) then
               turn = trial_delt - merit%delt
               promised = promised - 2.0_wp*dot_product(merit%edge_gradient + along_columns(merit%border, step), turn) &
                          - sum(merit%edge*turn**2)
               merit%delt = trial_delt
            end if
            gain = 2.0_wp
            if (total - trial_total < 2.0_wp*promised) gain = (total - trial_total)/promised
            idle = merge(idle + 1, 0, total - trial_total <= least_gain*total)
            values = trial
            slow = .not. merit%free .and. total - trial_total < slow_gain*total
            total = trial_total
            if (idle >= most_idle .or. total <= merit%floor) return
            damping = damping*max(1.0_wp/3.0_wp, 1.0_wp - (2.0_wp*min(gain, 2.0_wp) - 1.0_wp)**3)
            growth = 2.0_wp
            before = merit%gradient
            call form_equations(merit, values, merit%delt, weight)
            call learn_bend(merit%matrix, step, merit%gradient - before, bend)
         else if (slow) then
            slow = .false.
            damping = damping*growth
         else
            damping = damping*growth
            growth = 2.0_wp*growth
            if (damping > largest_damping) return
         end if
      end do
   end subroutine descend

   !> What the squares of first derivatives leave out of the second derivatives, learned from the last step (symmetric rank one).
   !>
   !> Source: the structured secant methods, Dennis, Gay and Welsch (1981); the update is that of Broyden and others (1967).
   pure subroutine learn_bend(matrix, step, change, bend)
      real(wp), intent(in) :: matrix(:, :)          !! shape (marble, marble): J^T J after the step
      real(wp), intent(in) :: step(:), change(:)    !! shape (marble): of the values, of the gradient
      real(wp), intent(inout) :: bend(:, :)         !! shape (marble, marble)
      real(wp) :: missing(size(step)), along
      integer :: v

      missing = change - along_columns(matrix + bend, step)
      along = dot_product(missing, step)
      if (abs(along) <= least_angle*sqrt(sum(missing**2)*sum(step**2))) return
      do v = 1, size(step)
         bend(:, v) = bend(:, v) + missing*(missing(v)/along)
      end do
   end subroutine learn_bend

   !> Second derivative of the merit by each input position, damped.
   pure function damped_edge(merit, damping) result(edge)
      type(merit_t), intent(in) :: merit
      real(wp), intent(in) :: damping
      real(wp) :: edge(size(merit%edge))

      edge = merit%edge*(1.0_wp + damping) + tiny(1.0_wp)**0.25_wp
   end function damped_edge

   !> Take the input positions out of the equations of the dimensions.
   subroutine eliminate(merit, damping, matrix, right)
      type(merit_t), intent(in) :: merit
      real(wp), intent(in) :: damping
      real(wp), intent(inout) :: matrix(:, :), right(:)
      real(wp) :: edge(size(merit%edge))
      integer :: i, a

      edge = damped_edge(merit, damping)
      do i = 1, size(edge)
         right = right + merit%border(:, i)*(merit%edge_gradient(i)/edge(i))
         do a = 1, size(right)
            matrix(:, a) = matrix(:, a) - merit%border(:, i)*(merit%border(a, i)/edge(i))
         end do
      end do
   end subroutine eliminate

   !> The nearest inputs (least squares) that never go back, within one turn: neighbours that do are given their mean.
   pure subroutine put_in_order(delt, sense, span)
      real(wp), intent(inout) :: delt(:)            !! shape (positions): input increments, degrees or length
      real(wp), intent(in) :: sense                 !! +1: they grow, -1: they fall
      real(wp), intent(in) :: span                  !! most between the first and the last
      real(wp) :: level(size(delt))
      integer :: members(size(delt))
      integer :: i, groups, at

      groups = 0
      do i = 1, size(delt)
         groups = groups + 1
         level(groups) = sense*delt(i)
         members(groups) = 1
         do while (groups > 1)
            if (level(groups - 1) <= level(groups)) exit
            level(groups - 1) = (members(groups - 1)*level(groups - 1) + members(groups)*level(groups)) &
                                /real(members(groups - 1) + members(groups), wp)
            members(groups - 1) = members(groups - 1) + members(groups)
            groups = groups - 1
         end do
      end do
      at = 0
      do i = 1, groups
         delt(at + 1:at + members(i)) = sense*level(i)
         at = at + members(i)
      end do
      delt = sense*min(sense*delt, sense*delt(1) + span)
   end subroutine put_in_order
end module psalm_lsq
