!> A batch of random linkages that pass points with free timing: short descents of the better ones, longer ones of the best.
!>
!> It serves linkages of any dyads whose place, size, direction and output point are solved for (`psalm_linear_unknowns`): only
!> their proportions and the inputs are drawn. Strict halving of cheap descents does more than good first linkages. Batches are
!> independent of each other. A four-bar has faster ones (`psalm_free_path`).
module psalm_random_batch
   use psalm_kinds, only: wp, full_turn
   use psalm_mechanism, only: arc_crank
   use psalm_merit, only: merit_t
   use psalm_error, only: problem_t
   use psalm_parameters, only: variable_aside, variable_length, variable_outlk, variable_origlk, variable_crnki
   use psalm_linear_unknowns, only: trace_linear
   use psalm_path_fit, only: square, fit_linear, error_of
   use psalm_solver, only: solver_t, ending_t
   use psalm_samples, only: evaluate_samples
   use psalm_stop, only: stop_t
   use psalm_timing, only: timing_t, find_timing
   use psalm_timing_draw, only: draw_spread, draw_jumps, draw_ratio, follow, uniform
   use psalm_xoshiro, only: xoshiro_t
   implicit none (type, external)
   private
   public :: draw_batch

   integer, parameter :: samples = 64, short = 16, medium = 3 !! of a batch; the best one is handed on
   integer, parameter :: hasty_samples = 24, hasty_short = 6 !! of a batch for a screening
   integer, parameter :: timings = 24                !! tried of every other linkage
   integer, parameter :: tries = 16                  !! of proportions with which the linkage closes all the way
   integer, parameter :: short_steps = 8, medium_steps = 40 !! evaluations of a descent
   real(wp), parameter :: gain = 1.0e-3_wp           !! relative, of a step that ends a descent
   real(wp), parameter :: longest = 10.0_wp          !! ratio of the lengths drawn
   real(wp), parameter :: of_crank = 0.5_wp          !! cranks are short: more linkages turn
   real(wp), parameter :: loose = 0.01_wp            !! weight of violations against errors as large as the path

   !> A linkage on trial.
   type :: trial_t
      real(wp), allocatable :: x(:)
      real(wp) :: score = huge(1.0_wp)
      integer :: way = 1
   end type trial_t

contains

   !> Draw a batch. The inputs go one of the ways that `timing` is prepared for; the merit is left as the best needs it.
   subroutine draw_batch(problem, merit, timing, ways, senses, solver, stop, seed, random, values, way, hasty)
      type(problem_t), intent(in) :: problem
      type(merit_t), intent(inout) :: merit          !! linear unknowns are eliminated; its range is that of the inputs given
      type(timing_t), intent(inout) :: timing(:)     !! shape (2)
      integer, intent(in) :: ways                    !! 1: one way only, the first
      real(wp), intent(in) :: senses(2)              !! of the inputs, either way
      class(solver_t), intent(inout) :: solver
      type(stop_t), intent(in) :: stop
      integer, intent(in) :: seed                    !! of the solver
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(out) :: values(:)             !! shape (nvar)
      integer, intent(out) :: way
      logical, intent(in) :: hasty                   !! a small batch, for a screening
      type(trial_t) :: batch(samples), copy
      integer :: i, order(samples), most, drawn, few, fewer

      most = solver%most_evaluations
      drawn = merge(hasty_samples, samples, hasty)
      few = merge(hasty_short, short, hasty)
      fewer = merge(1, medium, hasty)
      solver%seed = seed
      solver%least_gain = gain
      do i = 1, drawn
         batch(i)%way = 1
         if (ways > 1 .and. uniform(random) < 0.5_wp) batch(i)%way = 2
         call draw_proportions(problem, merit, timing(batch(i)%way), random, values)
         if (modulo(i, 2) == 0) then
            call choose_timing(merit, timing(batch(i)%way), values, senses(batch(i)%way), random)
         else
            call draw_inputs(merit, senses(batch(i)%way), random)
         end if
         batch(i)%x = merit%point(values, merit%delt)
         merit%sense = senses(batch(i)%way)
         call merit%fit_linear(batch(i)%x)
         call assess(batch(i))
      end do
      order = [(i, i=1, samples)]
      call rank(drawn, few)
      do i = 1, few
         call descend_twice(batch(order(i)), short_steps)
      end do
      call rank(few, fewer)
      do i = 1, fewer
         call descend_twice(batch(order(i)), medium_steps)
      end do
      call rank(fewer, 1)
      associate (best => batch(order(1)))
         values = best%x(:merit%core)
         merit%delt = best%x(merit%core + 1:)
         way = best%way
         merit%sense = senses(way)
      end associate
      solver%most_evaluations = most

   contains

      !> Errors in sizes of the path, and violations.
      subroutine assess(one)
         type(trial_t), intent(inout) :: one
         real(wp) :: objective, violation

         call merit%measure(one%x, objective, violation)
         associate (path => merit%linear%path)
            one%score = objective/(path%weight_scale*path%size**2) + loose*real(path%n, wp)*violation
         end associate
      end subroutine assess

      !> The best `wanted` of the first `among` in the order so far.
      subroutine rank(among, wanted)
         integer, intent(in) :: among, wanted
         integer :: k, m, swap

         do k = 1, wanted
            m = k - 1 + minloc(batch(order(k:among))%score, dim=1)
            swap = order(k)
            order(k) = order(m)
            order(m) = swap
         end do
      end subroutine rank

      !> Descend, then from a better timing too; the better is kept.
      subroutine descend_twice(one, steps)
         type(trial_t), intent(inout) :: one
         integer, intent(in) :: steps

         merit%sense = senses(one%way)
         call descend(one, steps)
         copy = one
         call problem%parameters%apply(copy%x(:merit%core), merit%dimensions)
         call find_timing(timing(copy%way), merit, copy%x(merit%core + 1:))
         call descend(copy, steps)
         if (copy%score < one%score) one = copy
      end subroutine descend_twice

      subroutine descend(one, steps)
         type(trial_t), intent(inout) :: one
         integer, intent(in) :: steps
         type(ending_t) :: ending

         solver%most_evaluations = steps
         call solver%minimise(merit, one%x, stop, ending)
         call assess(one)
      end subroutine descend
   end subroutine draw_batch

   !> Random proportions: the first with which the linkage closes all the way, or what comes nearest to it.
   subroutine draw_proportions(problem, merit, timing, random, values)
      type(problem_t), intent(in) :: problem
      type(merit_t), intent(inout) :: merit
      type(timing_t), intent(inout) :: timing
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(out) :: values(:)             !! shape (nvar)
      real(wp) :: trial(size(values)), open, least
      integer :: i, v

      least = huge(least)
      values = problem%parameters%first_values(problem%given)
      do i = 1, tries
         do v = 1, size(values)
            associate (variable => problem%parameters%variables(v))
               select case (variable%kind)
               case (variable_length)
                  trial(v) = merit%linear%path%size*draw_ratio(random, longest)
                  if (problem%mechanism%arcs(variable%n)%kind == arc_crank) trial(v) = of_crank*trial(v)
               case (variable_aside)
                  trial(v) = values(v)
               case (variable_outlk)
                  trial(v) = merit%linear%path%size
               case (variable_origlk)
                  trial(v) = merit%linear%path%size*sqrt(square(merit%linear%path%centre))
               case (variable_crnki)
                  trial(v) = values(v)
               case default
                  trial(v) = full_turn*uniform(random)
               end select
            end associate
         end do
         trial = min(max(trial, merit%low), merit%high)
         call problem%parameters%apply(trial, merit%dimensions)
         call evaluate_samples(timing%path, merit%dimensions)
         open = sum(max(abs(timing%path%k) - 1.0_wp, 0.0_wp)**2)
         if (open >= least) cycle
         least = open
         values = trial
         if (.not. least > 0.0_wp) exit
      end do
   end subroutine draw_proportions

   !> Of several random timings the one with which the path, placed and enlarged as it fits best, comes nearest to the points, seen
   !> at the steps of the range.
   subroutine choose_timing(merit, timing, values, sense, random)
      type(merit_t), intent(inout) :: merit
      type(timing_t), intent(inout) :: timing
      real(wp), intent(in) :: values(:)              !! shape (nvar): the linkage
      real(wp), intent(in) :: sense
      type(xoshiro_t), intent(inout) :: random
      complex(wp) :: joint(size(timing%inputs)), arm(size(timing%inputs)), e(merit%local), v(merit%local)
      real(wp) :: best(merit%local), error, least
      integer :: step(merit%local), m, k

      associate (linear => merit%linear)
         call trace_linear([linear%outlk, linear%outang, linear%origlk, linear%origng], values, merit%dimensions, timing%path, &
                           joint, arm)
         least = huge(least)
         do m = 1, timings
            call draw_inputs(merit, sense, random)
            do k = 1, size(step)
               step(k) = nearest_step(timing%inputs, merit%delt(k))
            end do
            e = joint(step)
            v = arm(step)
            call fit_linear(linear%path, e, v, linear%fit, 0.0_wp)
            error = error_of(linear%path, e, v, linear%fit)
            if (m > 1 .and. .not. error < least) cycle
            least = error
            best = merit%delt
         end do
      end associate
      merit%delt = best
   end subroutine choose_timing

   !> The step of a path over a turn that is nearest to an input.
   pure integer function nearest_step(inputs, input) result(step)
      real(wp), intent(in) :: inputs(:), input

      step = 1 + modulo(nint((input - inputs(1))/(inputs(2) - inputs(1))), size(inputs))
   end function nearest_step

   !> Random inputs, in order, into the merit.
   subroutine draw_inputs(merit, sense, random)
      type(merit_t), intent(inout) :: merit
      real(wp), intent(in) :: sense
      type(xoshiro_t), intent(inout) :: random
      real(wp) :: gap(merit%local)

      if (uniform(random) < 0.5_wp) then
         call draw_spread(merit%linear%path, random, gap)
      else
         call draw_jumps(merit%linear%path, random, gap)
      end if
      call follow(gap, full_turn*uniform(random), merit%delt)
      merit%delt = sense*merit%delt
   end subroutine draw_inputs
end module psalm_random_batch
