!> A batch of random linkages that pass points with free timing: short descents of the better ones, longer ones of the best.
!>
!> It serves linkages of any dyads whose place, size, direction and output point are solved for (`psalm_linear_unknowns`): only
!> their proportions and the inputs are drawn. Where it is asked for, linkages that turn are drawn, and inputs follow from the
!> lengths of path and curve where that is closed. Batches are independent of each other. A four-bar has faster ones
!> (`psalm_free_path`).
module psalm_random_batch
   use psalm_angles, only: unit_vector
   use psalm_kinds, only: wp, full_turn
   use psalm_mechanism, only: arc_crank
   use psalm_merit, only: merit_t
   use psalm_error, only: problem_t
   use psalm_parameters, only: variable_aside, variable_length, variable_outlk, variable_origlk, variable_crnki
   use psalm_linear_unknowns, only: trace_linear
   use psalm_path_fit, only: square, fit_linear, error_of
   use psalm_solver, only: solver_t, ending_t
   use psalm_ring_match, only: ring_match_t, laid_t, prepare_ring, match_ring
   use psalm_samples, only: evaluate_samples, exceeds
   use psalm_stop, only: stop_t
   use psalm_timing, only: timing_t, find_timing
   use psalm_timing_draw, only: draw_spread, draw_jumps, draw_ratio, follow, uniform
   use psalm_xoshiro, only: xoshiro_t
   implicit none (type, external)
   private
   public :: draw_batch

   integer, parameter :: samples = 64, short = 16, medium = 3 !! of a batch; the best one is handed on
   integer, parameter :: hasty_samples = 24, hasty_short = 6 !! of a batch for a screening
   ! of a closed curve, where linkages that turn are drawn
   integer, parameter :: laid_samples = 256, hasty_laid = 64 !! compared by arc length ...
   integer, parameter :: of_laid = 2                 !! ... of which so many, for each that is improved, are compared in full
   integer, parameter :: arms = 4                    !! output points of each
   real(wp), parameter :: astray = 10.0_wp           !! times the error counts of what does not turn or violates bounds
   integer, parameter :: turning_tries = 64          !! of proportions until a linkage turns
   integer, parameter :: most_failures = 12          !! of a dyad in a row, then all is drawn again
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
   subroutine draw_batch(problem, merit, timing, ways, senses, solver, stop, seed, random, values, way, hasty, turning)
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
      logical, intent(in) :: turning                 !! of linkages that turn, compared with a closed curve by arc length
      type(trial_t), allocatable :: batch(:)
      type(trial_t) :: copy
      type(ring_match_t) :: ring
      integer, allocatable :: order(:)
      integer :: i, most, drawn, compared, few, fewer

      most = solver%most_evaluations
      few = merge(hasty_short, short, hasty)
      fewer = merge(1, medium, hasty)
      if (turning) call prepare_ring(merit%linear%path, ring)
      drawn = merge(hasty_samples, samples, hasty)
      if (ring%applies) drawn = merge(hasty_laid, laid_samples, hasty)
      solver%seed = seed
      solver%least_gain = gain
      allocate (batch(drawn))
      order = [(i, i=1, drawn)]
      compared = drawn
      if (ring%applies) then
         do i = 1, drawn
            call lay_one(batch(i))
         end do
         compared = min(drawn, of_laid*few)
         call rank(drawn, compared)
      else
         do i = 1, drawn
            call draw_one(i, batch(i))
         end do
      end if
      do i = 1, compared
         associate (one => batch(order(i)))
            merit%sense = senses(one%way)
            call merit%fit_linear(one%x)
            call assess(one)
         end associate
      end do
      call rank(compared, few)
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

      !> A linkage with a timing of random numbers.
      subroutine draw_one(i, one)
         integer, intent(in) :: i
         type(trial_t), intent(inout) :: one
         logical :: turns

         if (ways > 1 .and. uniform(random) < 0.5_wp) one%way = 2
         if (turning) then
            call draw_turning(problem, merit, timing(one%way), random, values, turns)
         else
            call draw_proportions(problem, merit, timing(one%way), random, values)
         end if
         if (modulo(i, 2) == 0) then
            call choose_timing(merit, timing(one%way), values, senses(one%way), random)
         else
            call draw_inputs(merit, senses(one%way), random)
         end if
         one%x = merit%point(values, merit%delt)
      end subroutine draw_one

      !> A linkage with the timing by which it meets the closed curve best, of several output points.
      subroutine lay_one(one)
         type(trial_t), intent(inout) :: one
         type(laid_t) :: laid
         complex(wp) :: joint(size(timing(1)%inputs)), arm(size(timing(1)%inputs))
         real(wp) :: c, s
         logical :: turns, fits
         integer :: m

         call draw_turning(problem, merit, timing(1), random, values, turns)
         associate (linear => merit%linear)
            call trace_linear([linear%outlk, linear%outang, linear%origlk, linear%origng], values, merit%dimensions, &
                              timing(1)%path, joint, arm)
            laid%turns = spread(0.0_wp, 1, merit%local)
            do m = 1, arms
               call unit_vector(full_turn*uniform(random), c, s)
               call match_ring(ring, linear%path, joint, arm, linear%path%size*draw_ratio(random, longest)*cmplx(c, s, wp), &
                               ways, laid)
            end do
            fits = turns .and. laid%w2 >= merit%low(linear%outlk) .and. laid%w2 <= merit%high(linear%outlk) .and. &
                   .not. any(linear%grows .and. (laid%w1*values < merit%low .or. laid%w1*values > merit%high))
            one%score = min(laid%error, huge(1.0_wp)/astray)
            if (.not. fits) one%score = astray*one%score
         end associate
         one%way = laid%way
         one%x = merit%point(values, timing(1)%inputs(1) + (senses(1)*full_turn)*laid%turns)
      end subroutine lay_one

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

   !> Random proportions with which the linkage closes all the way, within its limits, found dyad by dyad: what fails is drawn
   !> again, what it hangs on is kept.
   subroutine draw_turning(problem, merit, timing, random, values, turns)
      type(problem_t), intent(in) :: problem
      type(merit_t), intent(inout) :: merit
      type(timing_t), intent(inout) :: timing
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(out) :: values(:)             !! shape (nvar)
      logical, intent(out) :: turns                  !! found; else the last of those tried is given
      integer :: i, loop, before, failures

      values = problem%parameters%first_values(problem%given)
      before = 0
      failures = 0
      loop = 0                                       ! all are drawn
      do i = 1, turning_tries
         call draw_values(problem, merit, random, loop, values)
         values = min(max(values, merit%low), merit%high)
         call problem%parameters%apply(values, merit%dimensions)
         call evaluate_samples(timing%path, merit%dimensions)
         do loop = 1, size(merit%limit)
            if (exceeds(size(timing%path%k, 1), timing%path%k(:, loop), merit%limit(loop))) exit
         end do
         turns = loop > size(merit%limit)
         if (turns) return
         failures = merge(failures + 1, 1, loop == before)
         before = loop
         if (failures <= most_failures .and. any(problem%parameters%variables%loop == loop)) cycle
         loop = 0
         failures = 0
      end do
   end subroutine draw_turning

   !> Random proportions: the first with which the linkage closes all the way, or what comes nearest to it.
   subroutine draw_proportions(problem, merit, timing, random, values)
      type(problem_t), intent(in) :: problem
      type(merit_t), intent(inout) :: merit
      type(timing_t), intent(inout) :: timing
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(out) :: values(:)             !! shape (nvar)
      real(wp) :: trial(size(values)), open, least
      integer :: i

      least = huge(least)
      values = problem%parameters%first_values(problem%given)
      do i = 1, tries
         trial = values
         call draw_values(problem, merit, random, 0, trial)
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

   !> Draw the dimensions of a loop, or all of them.
   subroutine draw_values(problem, merit, random, loop, values)
      type(problem_t), intent(in) :: problem
      type(merit_t), intent(in) :: merit
      type(xoshiro_t), intent(inout) :: random
      integer, intent(in) :: loop                    !! 0: all
      real(wp), intent(inout) :: values(:)           !! shape (nvar)
      integer :: v

      do v = 1, size(values)
         associate (variable => problem%parameters%variables(v))
            if (loop > 0 .and. variable%loop /= loop) cycle
            select case (variable%kind)
            case (variable_length)
               values(v) = merit%linear%path%size*draw_ratio(random, longest)
               if (problem%mechanism%arcs(variable%n)%kind == arc_crank) values(v) = of_crank*values(v)
            case (variable_outlk)
               values(v) = merit%linear%path%size
            case (variable_origlk)
               values(v) = merit%linear%path%size*sqrt(square(merit%linear%path%centre))
            case (variable_aside, variable_crnki)
               cycle
            case default
               values(v) = full_turn*uniform(random)
            end select
         end associate
      end do
   end subroutine draw_values

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
