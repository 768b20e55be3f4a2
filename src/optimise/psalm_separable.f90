!> Separable convex problems: what is cheapest within linear bands.
!>
!> minimise  sum_m cost_m x_c(m)**(-power_m)  so that  sum_c share_cj x_c <= 1 for every band j  and  low <= x <= high, where every
!> term m belongs to one unknown c(m). With x = t it is the allocation of tolerances t in the worst case, with x = t**2 that for
!> root-sum-squares. Primal-dual interior-point method from a feasible point; the dual function, which has a closed form but for one
!> equation an unknown, gives a lower bound of the cost whatever prices of the bands it is asked at. No random numbers and no
!> function but square roots. Source: Boyd and Vandenberghe (2004), Convex optimization, sections 5.2 and 11.7.
module psalm_separable
   use psalm_elementary, only: fractional_power
   use psalm_kinds, only: wp
   use psalm_linear, only: solve_positive
   implicit none (type, external)
   private
   public :: separable_t, separable_solution_t, solve_separable, dual_value, inverse_power, cheapest, own_cost, own_curve

   integer, parameter :: most_iterations = 200
   real(wp), parameter :: wanted = 1.0e-10_wp        !! gap at which it ends, of the cost
   real(wp), parameter :: enough = 1.0e-6_wp         !! at which, making no headway any more, it has still solved the problem
   real(wp), parameter :: narrowing = 10.0_wp        !! by how much one iteration is to narrow the gap
   real(wp), parameter :: loose = 10.0_wp            !! slopes that are left, of the gap, up to which it is narrowed
   real(wp), parameter :: to_the_edge = 0.99_wp      !! part of the way to a bound that is gone
   real(wp), parameter :: least_decrease = 0.01_wp   !! of the residual, of what its slope promises
   real(wp), parameter :: no_room = 1.0e-12_wp       !! of a band
   real(wp), parameter :: smaller = 0.1_wp           !! part of what the cost is measured by at which it is measured anew
   integer, parameter :: most_halvings = 40
   integer, parameter :: most_newton = 100

   !> The problem. Costs and powers are above 0, lower bounds at least 0. Shares are at least 0 but for bands that all lower bounds
   !> together keep.
   type :: separable_t
      real(wp), allocatable :: cost(:)               !! shape (terms)
      real(wp), allocatable :: power(:)              !! shape (terms)
      integer, allocatable :: unknown(:)             !! shape (terms)
      real(wp), allocatable :: share(:, :)           !! shape (unknowns, bands)
      real(wp), allocatable :: low(:), high(:)       !! shape (unknowns)
   end type separable_t

   !> Its solution.
   type :: separable_solution_t
      real(wp), allocatable :: x(:)                  !! shape (unknowns)
      real(wp), allocatable :: price(:)              !! shape (bands): cost saved by a band wider by its whole width, to first order
      real(wp) :: value = huge(1.0_wp)               !! cost
      real(wp) :: bound = -huge(1.0_wp)              !! nothing within the bands costs less
      integer :: tightest = 0                        !! band that even the lower bounds do not keep; 0: there is none
      integer :: iterations = 0
      logical :: solved = .false.
   end type separable_solution_t

contains

   !> Solve a problem. Not solved: a band is not kept even at the lower bounds (`tightest`), or rounding prevents it.
   pure subroutine solve_separable(problem, solution)
      type(separable_t), intent(in) :: problem
      type(separable_solution_t), intent(out) :: solution
      logical :: held(size(problem%low)), tight(size(problem%share, 2))
      real(wp) :: least(size(problem%share, 2))
      integer :: c, j

      solution%x = problem%low
      allocate (solution%price(size(problem%share, 2)), source=0.0_wp)
      do j = 1, size(least)
         least(j) = sum(min(problem%share(:, j)*problem%low, problem%share(:, j)*problem%high))
      end do
      if (size(least) > 0) then
         j = maxloc(least, dim=1)
         if (least(j) > 1.0_wp + no_room) then
            solution%tightest = j
            return
         end if
      end if
      ! where the lower bounds fill a band, nothing that shares in it can grow
      tight = least >= 1.0_wp - no_room
      do c = 1, size(held)
         held(c) = problem%high(c) <= problem%low(c) .or. any(tight .and. problem%share(c, :) > 0.0_wp)
      end do
      where (.not. held) solution%x = problem%high
      if (all(uses(problem, solution%x) <= 1.0_wp .or. tight)) then
         solution%value = cost_of(problem, solution%x)
         solution%bound = solution%value
         solution%solved = .true.
         return
      end if
      call go_inside(problem, held, tight, solution)
   end subroutine solve_separable

   !> The method of interior points, over the unknowns that are not held and the bands that have room.
   pure subroutine go_inside(problem, held, tight, solution)
      type(separable_t), intent(in) :: problem
      logical, intent(in) :: held(:), tight(:)
      type(separable_solution_t), intent(inout) :: solution
      integer, allocatable :: of(:), bands(:)
      real(wp), allocatable :: share(:, :), x(:), low(:), high(:), capacity(:)
      real(wp), allocatable :: slope(:), curve(:), hessian(:, :), right(:), dx(:), slack(:), price(:), at_low(:), at_high(:)
      real(wp), allocatable :: d_price(:), d_low(:), d_high(:), trial(:), all_x(:), prices(:)
      logical, allocatable :: bounded(:)
      real(wp) :: scale, centre, step, before, after, value, bound, best
      logical :: regular
      integer :: n, m, k, c, j, halving

      of = pack([(c, c=1, size(held))], .not. held)
      bands = pack([(j, j=1, size(tight))], .not. tight)
      n = size(of)
      m = size(bands)
      all_x = solution%x
      allocate (prices(size(tight)), source=0.0_wp)
      low = problem%low(of)
      high = problem%high(of)
      bounded = low > 0.0_wp
      capacity = [(1.0_wp - sum(merge(problem%share(:, bands(j))*all_x, 0.0_wp, held)), j=1, m)]
      share = problem%share(of, bands)
      x = start_of(share, capacity, low, high)
      all_x(of) = x
      scale = cost_of(problem, all_x)
      allocate (slope(n), curve(n), hessian(n, n), right(n), dx(n), trial(n))
      slack = capacity - used(share, x)
      price = 1.0_wp/slack/real(m + 2*n, wp)
      at_low = merge(1.0_wp/(x - low), 0.0_wp, bounded)/real(m + 2*n, wp)
      at_high = 1.0_wp/(high - x)/real(m + 2*n, wp)
      best = huge(1.0_wp)
      do k = 1, most_iterations
         solution%iterations = k
         centre = sum(price*slack) + sum(at_low*(x - low)) + sum(at_high*(high - x))
         call find_slopes(slope, curve)
         trial = x
         ! where an unknown is still far from its place, the gap must not run ahead of it
         if (norm(slopes_left()) <= loose*centre) centre = centre/narrowing
         centre = centre/real(m + 2*n, wp)
         hessian = 0.0_wp
         do j = 1, m
            call add_square(price(j)/slack(j), share(:, j), hessian)
         end do
         do c = 1, n
            hessian(c, c) = hessian(c, c) + curve(c) + at_high(c)/(high(c) - x(c))
            if (bounded(c)) hessian(c, c) = hessian(c, c) + at_low(c)/(x(c) - low(c))
         end do
         right = -slope - centre/(high - x)
         where (bounded) right = right + centre/(x - low)
         do j = 1, m
            right = right - share(:, j)*(centre/slack(j))
         end do
         call solve_positive(hessian, right, dx, regular)
         if (.not. regular) exit
         d_price = (centre + price*used(share, dx))/slack - price
         d_high = (centre + at_high*dx)/(high - x) - at_high
         d_low = merge((centre - at_low*dx)/(x - low) - at_low, 0.0_wp, bounded)
         step = min(1.0_wp, to_the_edge*reach(price, d_price), to_the_edge*reach(at_high, d_high), &
                    to_the_edge*reach(at_low, d_low), to_the_edge*reach(slack, -used(share, dx)), &
                    to_the_edge*reach(high - x, -dx), to_the_edge*reach(x - low, dx))
         before = residual()
         do halving = 1, most_halvings
            x = trial + step*dx
            slack = capacity - used(share, x)
            price = price + step*d_price
            at_low = at_low + step*d_low
            at_high = at_high + step*d_high
            call find_slopes(slope, curve)
            after = residual()
            if (after <= (1.0_wp - least_decrease*step)*before .or. halving == most_halvings) exit
            price = price - step*d_price
            at_low = at_low - step*d_low
            at_high = at_high - step*d_high
            step = 0.5_wp*step
         end do
         all_x(of) = x
         prices(bands) = price*scale
         value = cost_of(problem, all_x)
         bound = dual_value(problem, prices, held, all_x)
         if (value - bound < best) then
            best = value - bound
            solution%x = all_x
            solution%price = prices
            solution%value = value
            solution%bound = bound
         end if
         if (best <= wanted*value .or. halving == most_halvings) exit
         if (value < smaller*scale) then
            price = price*scale/value
            at_low = at_low*scale/value
            at_high = at_high*scale/value
            scale = value
         end if
      end do
      solution%solved = best <= enough*solution%value

   contains

      !> First and second derivatives of the cost, of its scale.
      pure subroutine find_slopes(slope, curve)
         real(wp), intent(out) :: slope(:), curve(:) !! shape (unknowns that are not held)
         integer :: term, at
         real(wp) :: part

         slope = 0.0_wp
         curve = 0.0_wp
         do term = 1, size(problem%cost)
            at = findloc(of, problem%unknown(term), dim=1)
            if (at == 0) cycle
            part = problem%power(term)*problem%cost(term)*inverse_power(x(at), problem%power(term))/(scale*x(at))
            slope(at) = slope(at) - part
            curve(at) = curve(at) + part*(problem%power(term) + 1.0_wp)/x(at)
         end do
      end subroutine find_slopes

      !> What is left of the slopes of the cost and the prices together, times where each unknown began.
      pure function slopes_left() result(left)
         real(wp) :: left(n)
         integer :: j

         left = slope + at_high - at_low
         do j = 1, m
            left = left + share(:, j)*price(j)
         end do
         left = left*trial
      end function slopes_left

      !> How far the conditions of the optimum are missed.
      pure real(wp) function residual()
         residual = norm([slopes_left(), price*slack - centre, at_high*(high - x) - centre, &
                          merge(at_low*(x - low) - centre, 0.0_wp, bounded)])
      end function residual
   end subroutine go_inside

   !> A point inside all bands and bounds, near the scale of every unknown: half of its bounds, or half of an equal part of what the
   !> lower bounds leave of the band that limits it most.
   pure function start_of(share, capacity, low, high) result(x)
      real(wp), intent(in) :: share(:, :), capacity(:), low(:), high(:)
      real(wp), allocatable :: x(:)
      real(wp) :: left
      integer :: c, j

      x = high - low
      do j = 1, size(capacity)
         left = (capacity(j) - sum(share(:, j)*low))/real(max(1, count(share(:, j) > 0.0_wp)), wp)
         do c = 1, size(x)
            if (share(c, j)*x(c) > left) x(c) = left/share(c, j)
         end do
      end do
      x = low + 0.5_wp*x
   end function start_of

   !> What is used of every band.
   pure function uses(problem, x)
      type(separable_t), intent(in) :: problem
      real(wp), intent(in) :: x(:)                   !! shape (unknowns)
      real(wp) :: uses(size(problem%share, 2))       !! shape (bands)

      uses = used(problem%share, x)
   end function uses

   pure function used(share, x)
      real(wp), intent(in) :: share(:, :), x(:)
      real(wp) :: used(size(share, 2))
      integer :: j

      do j = 1, size(used)
         used(j) = sum(share(:, j)*x)
      end do
   end function used

   pure real(wp) function cost_of(problem, x) result(cost)
      type(separable_t), intent(in) :: problem
      real(wp), intent(in) :: x(:)
      integer :: term

      cost = 0.0_wp
      do term = 1, size(problem%cost)
         cost = cost + problem%cost(term)*inverse_power(x(problem%unknown(term)), problem%power(term))
      end do
   end function cost_of

   !> The dual function: at prices of the bands that are not negative no x within bands and bounds costs less.
   pure real(wp) function dual_value(problem, price, held, at) result(value)
      type(separable_t), intent(in) :: problem
      real(wp), intent(in) :: price(:)               !! shape (bands)
      logical, intent(in), optional :: held(:)       !! shape (unknowns): cannot be but
      real(wp), intent(in), optional :: at(:)        !! what they are here
      real(wp) :: weight, x
      integer :: c

      value = -sum(price)
      do c = 1, size(problem%low)
         weight = sum(problem%share(c, :)*price)
         x = cheapest(problem, c, weight)
         if (present(held) .and. present(at)) then
            if (held(c)) x = at(c)
         end if
         value = value + weight*x + own_cost(problem, c, x)
      end do
   end function dual_value

   !> The cost of the terms of one unknown.
   pure real(wp) function own_cost(problem, c, x) result(cost)
      type(separable_t), intent(in) :: problem
      integer, intent(in) :: c
      real(wp), intent(in) :: x
      integer :: term

      cost = 0.0_wp
      do term = 1, size(problem%cost)
         if (problem%unknown(term) == c) cost = cost + problem%cost(term)*inverse_power(x, problem%power(term))
      end do
   end function own_cost

   !> The second derivative of the terms of one unknown.
   pure real(wp) function own_curve(problem, c, x) result(curve)
      type(separable_t), intent(in) :: problem
      integer, intent(in) :: c
      real(wp), intent(in) :: x
      integer :: term

      curve = 0.0_wp
      do term = 1, size(problem%cost)
         if (problem%unknown(term) == c) curve = curve + problem%power(term)*(problem%power(term) + 1.0_wp)*problem%cost(term)* &
            inverse_power(x, problem%power(term))/x**2
      end do
   end function own_curve

   !> Where the terms of an unknown and its price together cost least. Their slope rises and is concave: from the left Newton's
   !> method never passes the zero.
   pure real(wp) function cheapest(problem, c, weight) result(x)
      type(separable_t), intent(in) :: problem
      integer, intent(in) :: c
      real(wp), intent(in) :: weight
      real(wp) :: slope, curve, part, next
      integer :: term, k

      x = problem%high(c)
      if (.not. weight > 0.0_wp) return
      x = max(problem%low(c), tiny(1.0_wp))
      do term = 1, size(problem%cost)
         if (problem%unknown(term) == c) x = max(x, inverse_power(weight/(problem%cost(term)*problem%power(term)), &
                                                                  1.0_wp/(problem%power(term) + 1.0_wp)))
      end do
      do k = 1, most_newton
         if (x >= problem%high(c)) exit
         slope = weight
         curve = 0.0_wp
         do term = 1, size(problem%cost)
            if (problem%unknown(term) /= c) cycle
            part = problem%power(term)*problem%cost(term)*inverse_power(x, problem%power(term))/x
            slope = slope - part
            curve = curve + part*(problem%power(term) + 1.0_wp)/x
         end do
         if (slope >= 0.0_wp) exit
         next = x - slope/curve
         if (.not. next > x) exit
         x = next
      end do
      x = min(x, problem%high(c))
   end function cheapest

   !> How far one may go until something that is above 0 is 0; of nothing any way.
   pure real(wp) function reach(value, change)
      real(wp), intent(in) :: value(:), change(:)
      integer :: i

      reach = huge(1.0_wp)
      do i = 1, size(value)
         if (change(i) < 0.0_wp) reach = min(reach, -value(i)/change(i))
      end do
   end function reach

   pure real(wp) function norm(v)
      real(wp), intent(in) :: v(:)

      norm = sqrt(sum(v**2))
   end function norm

   !> Add a multiple of v v' to the upper triangle of a matrix.
   pure subroutine add_square(factor, v, matrix)
      real(wp), intent(in) :: factor, v(:)
      real(wp), intent(inout) :: matrix(:, :)
      integer :: i

      do i = 1, size(v)
         matrix(:i, i) = matrix(:i, i) + factor*v(i)*v(:i)
      end do
   end subroutine add_square

   !> x**(-power) for x and power above 0, the same digits on every processor.
   elemental real(wp) function inverse_power(x, power) result(value)
      real(wp), intent(in) :: x, power

      value = 1.0_wp/(x**int(power)*fractional_power(x, power - real(int(power), wp)))
   end function inverse_power
end module psalm_separable
