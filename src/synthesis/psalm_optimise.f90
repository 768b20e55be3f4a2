!> A search by an algorithm of NLopt, on the merit of `psalm_merit`.
!>
!> Algorithms that take nonlinear constraints get every one of them; the others minimise the merit with a weight of the
!> violations that grows until they vanish. What a global algorithm finds is made to obey by a local one that takes
!> constraints, COBYLA or SLSQP.
module psalm_optimise
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_loc, c_ptr
   use psalm_kinds, only: wp
   use psalm_lsq, only: put_in_order
   use psalm_merit, only: merit_t, measure, form_equations, obeys, violations, count_violations, &
                          squared_violations
   use psalm_nlopt, only: nlopt_t, is_global, needs_gradient, takes_constraints, refused
   implicit none (type, external)
   private
   public :: optimise

   integer, parameter :: weights = 6                  !! weights of the violations tried, each 100 times the one before
   real(wp), parameter :: weight_step = 100.0_wp
   real(wp), parameter :: global_weight = 1.0e4_wp    !! first weight of a global algorithm, in first objectives
   integer, parameter :: usual_evaluations = 2000     !! for each unknown and one more, where MAXEVAL is not given
   real(wp), parameter :: care = 1.0e6_wp             !! first objectives a violation of 1 counts as, among linkages to keep
   real(wp), parameter :: ftol = 1.0e-10_wp, xtol = 1.0e-9_wp
   real(wp), parameter :: unbounded = 0.5_wp*huge(1.0_wp) !! bounds beyond it are none
   real(wp), parameter :: tolerance = 1.0e-8_wp       !! of the constraints: less than they are aimed inside their limits

   !> What the functions NLopt calls need.
   type :: context_t
      type(merit_t), pointer :: merit => null()
      type(nlopt_t) :: optimiser
      real(wp) :: weight = 0.0_wp, care = 0.0_wp
      real(wp), allocatable :: values(:), delt(:)
      real(wp), allocatable :: slopes(:, :), limits(:)
      real(wp), allocatable :: kept(:), kept_delt(:)  !! lowest merit seen
      real(wp) :: lowest = huge(1.0_wp)
      real(wp), allocatable :: obedient(:), obedient_delt(:) !! lowest objective seen where nothing is violated
      real(wp) :: least = huge(1.0_wp)                !! of these; over all runs
      integer :: last = huge(1)                       !! evaluation after which a stop is forced
      logical :: converged = .false.                  !! the last run ended by itself
   end type context_t

contains

   !> Improve a linkage. `feasible` tells whether the result obeys every constraint at the positions looked at.
   subroutine optimise(algorithm, merit, values, box_low, box_high, seed, most_evaluations, objective, feasible, sound)
      character(*), intent(in) :: algorithm              !! NLopt's name
      type(merit_t), intent(inout), target :: merit
      real(wp), intent(inout) :: values(:)               !! shape (marble)
      real(wp), intent(in) :: box_low(:), box_high(:)    !! shape (marble): a global algorithm searches here, within the bounds
      integer, intent(in) :: seed                        !! of algorithms that draw lots
      integer, intent(in) :: most_evaluations            !! 0: the usual number
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      logical, intent(out) :: sound                      !! false: NLopt refuses the algorithm for this problem
      type(context_t), target :: context
      real(wp) :: total
      integer :: n, round, rounds, last, share

      feasible = .false.
      values = min(max(values, merit%low), merit%high)
      if (is_global(algorithm)) values = min(max(values, box_low), box_high)
      n = size(values)
      if (merit%free) n = n + size(merit%delt)
      merit%order_weighs = merit%ordered
      context%merit => merit
      context%values = values
      context%delt = merit%delt
      share = merge(most_evaluations, usual_evaluations*(n + 1), most_evaluations > 0)
      last = merit%evaluations + share
      call measure(merit, values, merit%delt, 0.0_wp, total, objective)
      call keep(context, total, objective, squared_violations(merit))
      context%care = care*max(objective, merit%small)
      if (takes_constraints(algorithm)) then
         call run(algorithm, context, box_low, box_high, seed, last, sound)
         call settle()
      else if (is_global(algorithm)) then
         context%weight = max(objective, merit%small)*global_weight
         call run(algorithm, context, box_low, box_high, seed, last - share/weights, sound)
         call settle()
         context%weight = 0.0_wp
         if (sound .and. .not. feasible .and. .not. merit%interrupt%waiting()) then
            call run(trim(merge('LD_SLSQP ', 'LN_COBYLA', needs_gradient(algorithm))), context, box_low, box_high, seed, last, &
                     sound)
            call settle()
         end if
      else
         context%weight = max(objective, merit%small)
         rounds = weights
         do round = 1, rounds
            call run(algorithm, context, box_low, box_high, seed, &
                     merit%evaluations + max(1, (last - merit%evaluations)/(rounds + 1 - round)), sound)
            call settle()
            if (.not. sound .or. merit%evaluations >= last .or. merit%interrupt%waiting()) exit
            if (feasible .and. context%converged) exit
            if (.not. feasible) context%weight = context%weight*weight_step
         end do
      end if

   contains

      subroutine settle()
         values = context%kept
         merit%delt = context%kept_delt
         if (merit%ordered) call put_in_order(merit%delt, merit%sense, merit%span)
         call obeys(merit, values, merit%delt, objective, feasible)
         if (feasible .and. objective <= context%least .or. .not. allocated(context%obedient)) return
         values = context%obedient
         merit%delt = context%obedient_delt
         call obeys(merit, values, merit%delt, objective, feasible)
      end subroutine settle
   end subroutine optimise

   !> One optimisation with one weight.
   subroutine run(algorithm, context, box_low, box_high, seed, last, sound)
      character(*), intent(in) :: algorithm
      type(context_t), intent(inout), target :: context
      real(wp), intent(in) :: box_low(:), box_high(:)
      integer, intent(in) :: seed, last
      logical, intent(out) :: sound
      real(c_double), allocatable :: x(:), low(:), high(:)
      real(c_double) :: least
      integer :: status, marble, n, m

      marble = size(context%values)
      n = marble
      if (context%merit%free) n = n + size(context%delt)
      m = 0
      if (takes_constraints(algorithm)) m = count_violations(context%merit)
      context%limits = spread(0.0_wp, 1, m)
      context%slopes = reshape([real(wp) ::], [n, merge(m, 0, needs_gradient(algorithm))], pad=[0.0_wp])
      allocate (x(n), low(n), high(n))
      call pack_up(context%merit, context%values, context%merit%delt, x)
      ! what NLopt takes for no bound at all
      low = -infinity()
      high = infinity()
      where (context%merit%low > -unbounded) low(:marble) = real(context%merit%low, c_double)
      where (context%merit%high < unbounded) high(:marble) = real(context%merit%high, c_double)
      if (is_global(algorithm)) then
         low(:marble) = max(low(:marble), real(box_low, c_double))
         high(:marble) = min(high(:marble), real(box_high, c_double))
         low(marble + 1:) = x(marble + 1:) - real(context%merit%reach, c_double)
         high(marble + 1:) = x(marble + 1:) + real(context%merit%reach, c_double)
      end if
      x = min(max(x, low), high)
      context%lowest = huge(1.0_wp)
      context%kept = context%values
      context%kept_delt = context%merit%delt
      context%last = last
      call context%optimiser%open(algorithm, n, seed, sound)
      if (sound) call context%optimiser%set_bounds(low, high, sound)
      if (sound .and. m > 0) call context%optimiser%set_constraints(m, constraint_values, c_loc(context), &
                                                                    real(tolerance, c_double), sound)
      if (sound) then
         call context%optimiser%set_limits(real(ftol, c_double), real(xtol, c_double), max(1, last - context%merit%evaluations))
         call context%optimiser%minimise(merit_value, c_loc(context), x, least, status)
         sound = .not. refused(status)
         context%converged = context%merit%evaluations < last
      end if
      call context%optimiser%close()
      context%values = context%kept
   end subroutine run

   pure real(c_double) function infinity()
      use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_positive_inf

      infinity = ieee_value(1.0_c_double, ieee_positive_inf)
   end function infinity

   pure subroutine pack_up(merit, values, delt, x)
      type(merit_t), intent(in) :: merit
      real(wp), intent(in) :: values(:), delt(:)
      real(c_double), intent(out) :: x(:)

      x(:size(values)) = real(values, c_double)
      if (merit%free) x(size(values) + 1:) = real(delt, c_double)
   end subroutine pack_up

   pure subroutine unpack(context, x, values, delt)
      type(context_t), intent(in) :: context
      real(c_double), intent(in) :: x(:)
      real(wp), intent(inout) :: values(:), delt(:)

      values = real(x(:size(values)), wp)
      if (context%merit%free) delt = real(x(size(values) + 1:), wp)
   end subroutine unpack

   !> The merit, for NLopt.
   real(c_double) function merit_value(n, x, gradient, data) bind(c)
      integer(c_int), value :: n
      real(c_double), intent(in) :: x(n)
      type(c_ptr), value :: gradient, data
      type(context_t), pointer :: context
      real(c_double), pointer :: slope(:)
      real(wp) :: total, objective
      integer :: marble

      call c_f_pointer(data, context)
      call unpack(context, x, context%values, context%delt)
      associate (merit => context%merit)
         call measure(merit, context%values, context%delt, context%weight, total, objective)
         merit_value = real(total, c_double)
         call keep(context, total, objective, squared_violations(merit))
         if (c_associated(gradient)) then
            call c_f_pointer(gradient, slope, [int(n)])
            call form_equations(merit, context%values, context%delt, context%weight)
            marble = size(context%values)
            slope(:marble) = real(2.0_wp*merit%gradient, c_double)
            if (merit%free) slope(marble + 1:) = real(2.0_wp*merit%edge_gradient, c_double)
         end if
         if (merit%evaluations >= context%last .or. merit%interrupt%waiting()) call context%optimiser%force_stop()
      end associate
   end function merit_value

   !> Remember the best linkage: violations count for more than in the merit.
   subroutine keep(context, total, objective, violated)
      type(context_t), intent(inout) :: context
      real(wp), intent(in) :: total, objective, violated

      if (violated <= 0.0_wp .and. objective < context%least) then
         context%least = objective
         context%obedient = context%values
         context%obedient_delt = context%delt
      end if
      if (total + context%care*violated >= context%lowest) return
      context%lowest = total + context%care*violated
      context%kept = context%values
      context%kept_delt = context%delt
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
      real(wp) :: total, objective

      call c_f_pointer(data, context)
      call unpack(context, x, context%values, context%delt)
      associate (merit => context%merit)
         if (c_associated(gradient)) then
            call c_f_pointer(gradient, slopes, [int(n), int(m)])
            call form_equations(merit, context%values, context%delt, 0.0_wp)
            call violations(merit, context%limits, context%slopes)
            slopes = real(context%slopes, c_double)
         else
            call measure(merit, context%values, context%delt, 0.0_wp, total, objective)
            merit%evaluations = merit%evaluations - 1
            call violations(merit, context%limits)
         end if
         values = real(context%limits, c_double)
      end associate
   end subroutine constraint_values
end module psalm_optimise
