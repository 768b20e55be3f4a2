!> The cheapest tolerances within the bands: those of any size by the convex problem, grades and steps by branch and bound.
module psalm_cheapest_tolerances
   use psalm_allocation_group, only: allocation_group_t, rule_worst, rule_yield
   use psalm_allocation_rule, only: allocated_band_t, band_rule_t
   use psalm_allocation_terms, only: costs_of, terms_t
   use psalm_choice, only: choice_solution_t, choosing_t, solve_choice
   use psalm_kinds, only: wp
   use psalm_separable, only: dual_value, inverse_power, separable_solution_t, separable_t, solve_separable
   use psalm_stop, only: stop_t
   use psalm_sum_law, only: half_width, law_normal
   use psalm_tolerance, only: allowance_t
   implicit none (type, external)
   private
   public :: cheapest_t, find_cheapest
   public :: limit_none, limit_least, limit_largest, wider, at_limit

   real(wp), parameter :: wider = 0.1_wp              !! part of all bands, for what wider ones save with steps
   integer, parameter :: limit_none = 0, limit_least = 1, limit_largest = 2
   real(wp), parameter :: at_limit = 1.0e-6_wp        !! part of a limit within which a tolerance is at it
   integer, parameter :: most_rounds = 100            !! of weights
   integer, parameter :: undamped = 8                 !! rounds that go all the way to the next weights
   real(wp), parameter :: kept_to = 1.0e-6_wp         !! part of a band that rounds which have ended may leave over
   real(wp), parameter :: end_of_rounds = 1.0e-6_wp   !! gap of correlated groups, of the cost, up to which they are solved
   real(wp), parameter :: aside = 1.0e-3_wp           !! part of a tolerance by which one goes to the other side of an edge
   real(wp), parameter :: same_plane = 1.0e-6_wp      !! of its largest slope: two planes are one
   real(wp), parameter :: rounding = 1.0e-12_wp       !! of the cost
   real(wp), parameter :: steady = 1.0e-9_wp          !! change of the cost between two rounds at which they end
   real(wp), parameter :: least_change = 1.0e-10_wp   !! part of the largest change below which a dimension has none

   !> What was found.
   type :: cheapest_t
      logical :: solved = .false.                     !! tolerances were found
      logical :: unsettled = .false.                  !! the rounds of a yield did not come to an end
      real(wp), allocatable :: tolerance(:), cost(:)  !! shape (dimensions)
      integer, allocatable :: limit(:)                !! shape (dimensions): one of `limit_...`
      integer, allocatable :: step(:)                 !! shape (dimensions): grade, or number of its step; 0: any tolerance
      real(wp) :: value = 0.0_wp, bound = 0.0_wp      !! cost of all, and what it cannot be below
      integer :: impossible = 0                       !! band that even the least tolerances do not keep; 0: there is none
      integer :: nodes = 0                            !! of the search for steps; 0: there was none
      logical :: proven = .true.                      !! nothing is cheaper
      real(wp), allocatable :: worth(:)               !! shape (dimensions): cost saved by a smaller effect, to first order, for the
                                                      !! whole effect; with steps 0
      real(wp) :: wider_saves = 0.0_wp                !! with steps: what all bands wider by `wider` save; below 0: not known
      integer :: without_step = 0                     !! dimension that has no step within its limits, or none with its class
   end type cheapest_t

   !> The search for grades and steps.
   type, extends(choosing_t) :: step_choice_t
      type(band_rule_t) :: rule
      real(wp), allocatable :: tolerance(:, :, :)     !! shape (options, unknowns, dimensions): 0 where the unknown is another
      integer, allocatable :: of_rest(:)              !! shape (dimensions): unknown of the rest; 0: none
      real(wp), allocatable :: change(:, :)           !! shape (dimensions, bands)
      real(wp), allocatable :: width(:)               !! shape (bands)
   contains
      procedure :: try => try_steps
   end type step_choice_t

contains

   !> Solve the problem and note how full the bands are.
   subroutine find_cheapest(asked, rule, allowance, terms, bands, stop, result)
      type(allocation_group_t), intent(in) :: asked
      type(band_rule_t), intent(in) :: rule
      type(allowance_t), intent(in) :: allowance
      type(terms_t), intent(in) :: terms
      type(allocated_band_t), intent(inout) :: bands(:)
      type(stop_t), intent(in) :: stop                !! asked now and then by the search for steps
      type(cheapest_t), intent(out) :: result
      real(wp) :: slope(size(terms%cost))
      type(allocated_band_t), allocatable :: allowed(:)
      type(cheapest_t) :: with_wider
      integer :: i, j

      allocate (with_wider%step(size(terms%cost)), source=0)
      allocate (result%step(size(terms%cost)), source=0)
      allocate (result%worth(size(terms%cost)), source=0.0_wp)
      if (any(terms%in_steps)) then
         call find_steps(asked, rule, allowance, terms, bands, stop, result)
      else if (rule%is_grouped()) then
         call find_steps(asked, rule, allowance, terms, bands, stop, result)
         if (result%solved) call settle(rule, allowance, terms, bands, result)
      else
         call find_any(asked, rule, allowance, terms, bands, result)
      end if
      if (.not. result%solved) return
      do j = 1, size(bands)
         call rule%reach(allowance%change(bands(j)%position, :, bands(j)%number), result%tolerance, bands(j)%used, slope)
         if (.not. rule%is_grouped()) result%worth = result%worth + bands(j)%price*slope*result%tolerance/bands(j)%width
         bands(j)%share = rule%share(allowance%change(bands(j)%position, :, bands(j)%number), result%tolerance, bands(j)%width)
      end do
      result%cost = costs_of(terms, result%tolerance)
      result%value = sum(result%cost)
      ! a choice that is proven costs its bound, but for the order in which costs are added
      if (any(terms%in_steps) .and. abs(result%value - result%bound) <= rounding*result%value) result%bound = result%value
      result%limit = [(limit_none, i=1, size(terms%cost))]
      where (result%tolerance >= (1.0_wp - at_limit)*terms%high) result%limit = limit_largest
      where (result%tolerance <= (1.0_wp + at_limit)*terms%low) result%limit = limit_least
      do i = 1, size(terms%cost)
         if (.not. terms%in_steps(i)) cycle
         result%limit(i) = limit_none
         if (result%tolerance(i) >= (1.0_wp - at_limit)*terms%step(terms%steps(i), i)) result%limit(i) = limit_largest
         if (result%tolerance(i) <= (1.0_wp + at_limit)*terms%step(1, i)) result%limit(i) = limit_least
      end do
      if (.not. any(terms%in_steps)) return
      allowed = bands
      allowed%width = (1.0_wp + wider)*bands%width
      call find_steps(asked, rule, allowance, terms, allowed, stop, with_wider)
      result%wider_saves = result%bound - with_wider%bound
      if (.not. (result%proven .and. with_wider%proven .and. with_wider%solved)) result%wider_saves = -1.0_wp
   end subroutine find_cheapest

   !> Tolerances of any size in correlated groups that were found by linear bands: bound and prices by the planes that touch there.
   subroutine settle(rule, allowance, terms, bands, result)
      type(band_rule_t), intent(in) :: rule
      type(allowance_t), intent(in) :: allowance
      type(terms_t), intent(in) :: terms
      type(allocated_band_t), intent(inout) :: bands(:)
      type(cheapest_t), intent(inout) :: result
      type(separable_t) :: planes
      type(separable_solution_t) :: solution
      real(wp), allocatable :: slopes(:, :)           !! shape (dimensions, planes)
      integer, allocatable :: of(:)                   !! shape (planes): their bands
      integer :: b, c, k, n

      allocate (planes%unknown(size(terms%cost)))
      call number_unknowns(terms%class, planes%unknown)
      n = maxval(planes%unknown)
      planes%cost = terms%cost
      planes%power = terms%power
      planes%low = [(maxval(terms%low, planes%unknown == c), c=1, n)]
      planes%high = max(planes%low, [(minval(terms%high, planes%unknown == c), c=1, n)])
      allocate (slopes(size(terms%cost), 0), of(0))
      do b = 1, size(bands)
         associate (change => allowance%change(bands(b)%position, :, bands(b)%number))
            call touch(change, result%tolerance)
            ! the worst case has an edge where what a group has in common cancels: a plane on either side
            do c = 1, merge(size(change), 0, rule%rule == rule_worst .or. rule%is_leaning())
               if (rule%group(c) == 0 .and. .not. rule%leans(c)) cycle
               call touch(change, result%tolerance*[(merge(1.0_wp + aside, 1.0_wp, k == c), k=1, size(change))])
               call touch(change, result%tolerance*[(merge(1.0_wp - aside, 1.0_wp, k == c), k=1, size(change))])
            end do
         end associate
      end do
      allocate (planes%share(n, size(of)), source=0.0_wp)
      do k = 1, size(of)
         do c = 1, size(terms%cost)
            associate (share => planes%share(planes%unknown(c), k))
               share = share + slopes(c, k)
            end associate
         end do
      end do
      call solve_separable(planes, solution)
      if (solution%solved) then
         do k = 1, size(of)
            bands(of(k))%price = bands(of(k))%price + solution%price(k)
            result%worth = result%worth + solution%price(k)*slopes(:, k)*result%tolerance
         end do
         result%bound = sum(terms%fixed) + solution%bound
      end if
      result%value = sum(costs_of(terms, result%tolerance))
      result%nodes = 0
      result%proven = .true.
      result%unsettled = .not. solution%solved .or. result%value - result%bound > end_of_rounds*result%value
      result%solved = .not. result%unsettled

   contains

      !> One more plane of band b, if it is none of those that it has.
      subroutine touch(change, tolerance)
         real(wp), intent(in) :: change(:), tolerance(:)
         real(wp) :: far, slope(size(change))
         integer :: p

         call rule%reach(change, tolerance, far, slope)
         slope = slope/bands(b)%width
         do p = 1, size(of)
            if (of(p) == b .and. all(abs(slopes(:, p) - slope) <= same_plane*maxval(abs(slope)))) return
         end do
         slopes = reshape([slopes, slope], [size(slope), size(of) + 1])
         of = [of, b]
      end subroutine touch
   end subroutine settle

   !> Tolerances of any size.
   subroutine find_any(asked, rule, allowance, terms, bands, result)
      type(allocation_group_t), intent(in) :: asked
      type(band_rule_t), intent(in) :: rule
      type(allowance_t), intent(in) :: allowance
      type(terms_t), intent(in) :: terms
      type(allocated_band_t), intent(inout) :: bands(:)
      type(cheapest_t), intent(inout) :: result
      type(separable_t) :: problem
      type(separable_solution_t) :: solution
      integer :: unknown(size(terms%cost)), j, k, n, rounds
      real(wp) :: weights(size(terms%cost), size(bands)), before, order, most, far, slope(size(terms%cost))

      call number_unknowns(terms%class, unknown)
      n = maxval(unknown)
      order = merge(1.0_wp, 2.0_wp, asked%rule == rule_worst)
      problem%cost = terms%cost
      problem%power = terms%power/order
      problem%unknown = unknown
      problem%low = [(maxval(terms%low, unknown == k), k=1, n)]**nint(order)
      problem%high = [(minval(terms%high, unknown == k), k=1, n)]**nint(order)
      problem%high = max(problem%low, problem%high)
      do j = 1, size(bands)
         associate (band => bands(j))
            weights(:, j) = abs(rule%counted(allowance%change(band%position, :, band%number)))
            most = maxval(weights(:, j))
            where (weights(:, j) < least_change*most) weights(:, j) = 0.0_wp
            if (order > 1.0_wp) weights(:, j) = weights(:, j)**2
         end associate
      end do
      before = huge(1.0_wp)
      do rounds = 1, merge(most_rounds, 1, asked%rule == rule_yield)
         call solve_with(weights)
         if (.not. solution%solved) exit
         result%tolerance = solution%x(unknown)
         if (order > 1.0_wp) result%tolerance = sqrt(result%tolerance)
         if (asked%rule /= rule_yield) exit
         if (abs(solution%value - before) <= steady*solution%value) exit
         before = solution%value
         call reweigh(rounds > undamped)
      end do
      result%impossible = solution%tightest
      result%solved = solution%solved
      if (.not. result%solved) return
      if (asked%rule == rule_yield) then
         result%unsettled = rounds > most_rounds
         do j = 1, size(bands)
            call rule%reach(allowance%change(bands(j)%position, :, bands(j)%number), result%tolerance, far, slope)
            if (far > (1.0_wp + kept_to)*bands(j)%width) result%unsettled = .true.
         end do
      end if
      result%solved = .not. result%unsettled
      if (.not. result%solved) return
      bands%price = order*solution%price
      result%bound = sum(terms%fixed) + solution%bound
      if (asked%rule == rule_yield .and. asked%law /= law_normal) result%bound = sum(terms%fixed) + bound_of_planes()

   contains

      !> The bound by the planes that touch the widths at the tolerances found, at the prices of the bands.
      real(wp) function bound_of_planes() result(bound)
         type(separable_t) :: planes
         integer :: b, c

         planes = problem
         planes%power = terms%power
         planes%low = sqrt(problem%low)
         planes%high = sqrt(problem%high)
         planes%share = 0.0_wp
         do b = 1, size(bands)
            call rule%reach(allowance%change(bands(b)%position, :, bands(b)%number), result%tolerance, far, slope)
            do c = 1, size(unknown)
               planes%share(unknown(c), b) = planes%share(unknown(c), b) + slope(c)/bands(b)%width
            end do
         end do
         bound = dual_value(planes, bands%price)
      end function bound_of_planes

      subroutine solve_with(weights)
         real(wp), intent(in) :: weights(:, :)
         integer :: c, b

         if (allocated(problem%share)) deallocate (problem%share)
         allocate (problem%share(n, size(weights, 2)), source=0.0_wp)
         do b = 1, size(weights, 2)
            do c = 1, size(unknown)
               problem%share(unknown(c), b) = problem%share(unknown(c), b) + weights(c, b)/bands(b)%width**nint(order)
            end do
         end do
         call solve_separable(problem, solution)
      end subroutine solve_with

      !> Weights whose sum has the value and the slopes of the width that holds the share; damped, halfway from those before.
      subroutine reweigh(damped)
         logical, intent(in) :: damped
         real(wp) :: width, slope(size(unknown)), effect(size(unknown)), next(size(unknown))
         integer :: b

         do b = 1, size(bands)
            effect = abs(allowance%change(bands(b)%position, :, bands(b)%number))
            where (effect < least_change*maxval(effect)) effect = 0.0_wp
            if (rule%is_round()) then
               call half_width(asked%law, effect*result%tolerance, asked%yield, width, slope, rule%disc)
            else
               call half_width(asked%law, effect*result%tolerance, asked%yield, width, slope)
            end if
            next = width*slope*effect/result%tolerance
            if (damped) next = 0.5_wp*(next + weights(:, b))
            weights(:, b) = next
         end do
      end subroutine reweigh
   end subroutine find_any

   !> The unknown of every dimension: one for each class, and one for each dimension that is in none.
   pure subroutine number_unknowns(class, unknown)
      integer, intent(in) :: class(:)                 !! shape (dimensions); 0: in none
      integer, intent(out) :: unknown(:)              !! the same shape: from 1 on
      integer :: i, k, n

      n = 0
      do i = 1, size(class)
         k = 0
         if (class(i) > 0) k = findloc(class(:i - 1), class(i), dim=1)
         if (k > 0) then
            unknown(i) = unknown(k)
         else
            n = n + 1
            unknown(i) = n
         end if
      end do
   end subroutine number_unknowns

   !> Grades and steps, and tolerances of any size beside them.
   subroutine find_steps(asked, rule, allowance, terms, bands, stop, result)
      type(allocation_group_t), intent(in) :: asked
      type(band_rule_t), intent(in) :: rule
      type(allowance_t), intent(in) :: allowance
      type(terms_t), intent(in) :: terms
      type(allocated_band_t), intent(in) :: bands(:)
      type(stop_t), intent(in) :: stop
      type(cheapest_t), intent(inout) :: result
      type(step_choice_t) :: problem
      type(choice_solution_t) :: solution
      integer, allocatable :: kinds(:, :)             !! shape (options, unknowns): grade or number of the step
      integer :: unknown(size(terms%cost)), of(size(terms%cost)), i, k, n, m, c, at
      real(wp) :: order

      call number_unknowns(terms%class, unknown)
      problem%rule = rule
      order = 1.0_wp
      if (rule%is_separable()) order = real(rule%order(), wp)
      ! discrete unknowns, then those of the rest
      n = 0
      m = 0
      of = 0
      allocate (problem%of_rest(size(unknown)), source=0)
      do i = 1, size(unknown)
         k = findloc(unknown(:i - 1), unknown(i), dim=1)
         if (terms%in_steps(i)) then
            if (k == 0) n = n + 1
            of(i) = n
            if (k > 0) of(i) = of(k)
         else
            if (k == 0) m = m + 1
            problem%of_rest(i) = m
            if (k > 0) problem%of_rest(i) = problem%of_rest(k)
         end if
      end do
      k = max(1, maxval(terms%steps))
      allocate (problem%options(n), source=0)
      allocate (kinds(k, n), source=0)
      allocate (problem%cost(k, n), source=0.0_wp)
      allocate (problem%tolerance(k, n, size(unknown)), source=0.0_wp)
      do c = 1, n
         i = findloc(of, c, dim=1)
         do k = 1, terms%steps(i)
            ! every dimension of the class must have it
            if (any([(of(at) == c .and. .not. any(terms%kind(:, at) == terms%kind(k, i)), at=1, size(of))])) cycle
            problem%options(c) = problem%options(c) + 1
            kinds(problem%options(c), c) = terms%kind(k, i)
            do at = 1, size(of)
               if (of(at) /= c) cycle
               associate (place => findloc(terms%kind(:, at), terms%kind(k, i), dim=1))
                  problem%tolerance(problem%options(c), c, at) = terms%step(place, at)
                  problem%cost(problem%options(c), c) = problem%cost(problem%options(c), c) + terms%step_cost(place, at)
               end associate
            end do
         end do
      end do
      if (any(problem%options == 0)) then
         result%without_step = findloc(of, findloc(problem%options, 0, dim=1), dim=1)
         return
      end if
      call make_rest()
      call make_bands()
      call solve_choice(problem, asked%most_nodes, stop, solution)
      result%nodes = solution%nodes
      result%proven = solution%proven
      result%solved = solution%found
      if (.not. solution%found) then
         if (solution%proven) result%impossible = fullest_band()
         return
      end if
      allocate (result%tolerance(size(unknown)), source=0.0_wp)
      do i = 1, size(unknown)
         if (of(i) > 0) then
            result%tolerance(i) = problem%tolerance(solution%option(of(i)), of(i), i)
            result%step(i) = kinds(solution%option(of(i)), of(i))
         else
            result%tolerance(i) = solution%x(problem%of_rest(i))
            if (order > 1.0_wp) result%tolerance(i) = sqrt(result%tolerance(i))
         end if
      end do
      result%bound = solution%bound + sum(terms%fixed, mask=of == 0)

   contains

      !> Costs and limits of the tolerances of any size.
      subroutine make_rest()
         integer, allocatable :: list(:)
         integer :: u

         list = pack([(u, u=1, size(unknown))], of == 0)
         associate (rest => problem%rest)
            rest%cost = terms%cost(list)
            rest%power = terms%power(list)/order
            rest%unknown = problem%of_rest(list)
            rest%low = [(maxval(terms%low, problem%of_rest == u), u=1, m)]**nint(order)
            rest%high = [(minval(terms%high, problem%of_rest == u), u=1, m)]**nint(order)
            rest%high = max(rest%low, rest%high)
         end associate
      end subroutine make_rest

      !> The bands: whole where they are sums over the dimensions, else planes that touch them.
      subroutine make_bands()
         real(wp), allocatable :: weight(:), slope(:), even(:)
         real(wp) :: most, far
         integer :: b, u, d

         allocate (problem%use(size(problem%cost, 1), n, size(bands)), problem%rest%share(m, size(bands)), source=0.0_wp)
         allocate (problem%change(size(unknown), size(bands)))
         problem%width = bands%width
         allocate (slope(size(unknown)))
         do b = 1, size(bands)
            associate (change => problem%change(:, b))
               change = allowance%change(bands(b)%position, :, bands(b)%number)
               most = maxval(abs(change))
               where (abs(change) < least_change*most) change = 0.0_wp
               if (rule%is_separable()) then
                  weight = rule%weights(change)/bands(b)%width**nint(order)
               else
                  even = merge(1.0_wp/abs(change), 0.0_wp, abs(change) > 0.0_wp)
                  call rule%reach(change, even, far, slope)
                  weight = slope/bands(b)%width
               end if
            end associate
            do d = 1, size(unknown)
               if (of(d) > 0) then
                  u = of(d)
                  problem%use(:, u, b) = problem%use(:, u, b) + weight(d)*problem%tolerance(:, u, d)**nint(order)
               else
                  u = problem%of_rest(d)
                  problem%rest%share(u, b) = problem%rest%share(u, b) + weight(d)
               end if
            end do
         end do
      end subroutine make_bands

      !> The band that the finest steps fill most.
      integer function fullest_band()
         real(wp) :: least(size(unknown)), slope(size(unknown)), full(size(bands))
         integer :: d, b

         do d = 1, size(unknown)
            least(d) = terms%low(d)
            if (of(d) > 0) least(d) = problem%tolerance(1, of(d), d)
         end do
         do b = 1, size(bands)
            call rule%reach(problem%change(:, b), least, full(b), slope)
         end do
         fullest_band = maxloc(full/bands%width, dim=1)
      end function fullest_band
   end subroutine find_steps

   !> How full the fullest band is, and the plane that touches it there.
   subroutine try_steps(self, part, x, fullest, use, share)
      class(step_choice_t), intent(in) :: self
      real(wp), intent(in) :: part(:, :)
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: fullest
      real(wp), allocatable, intent(out) :: use(:, :)
      real(wp), allocatable, intent(out) :: share(:)
      real(wp) :: tolerance(size(self%of_rest)), slope(size(self%of_rest)), of_fullest(size(self%of_rest)), far
      integer :: i, j, c, band

      fullest = 0.0_wp
      if (self%rule%is_separable()) return            ! the bands of the problem are all there is
      do i = 1, size(tolerance)
         if (self%of_rest(i) > 0) then
            tolerance(i) = x(self%of_rest(i))
         else
            tolerance(i) = sum(part*self%tolerance(:, :, i))
         end if
      end do
      band = 0
      do j = 1, size(self%width)
         call self%rule%reach(self%change(:, j), tolerance, far, slope)
         if (far/self%width(j) <= fullest) cycle
         fullest = far/self%width(j)
         of_fullest = slope/self%width(j)
         band = j
      end do
      if (band == 0) return
      allocate (use(size(self%cost, 1), size(self%options)), share(size(self%rest%low)), source=0.0_wp)
      do i = 1, size(tolerance)
         if (self%of_rest(i) > 0) then
            share(self%of_rest(i)) = share(self%of_rest(i)) + of_fullest(i)
         else
            do c = 1, size(self%options)
               use(:, c) = use(:, c) + of_fullest(i)*self%tolerance(:, c, i)
            end do
         end if
      end do
   end subroutine try_steps
end module psalm_cheapest_tolerances
