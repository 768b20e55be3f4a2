!> The cheapest choice within bands: one option of every discrete unknown, and continuous unknowns beside them.
!>
!> minimise  sum_c cost(option_c, c) + cost of the rest  so that  sum_c use(option_c, c, j) + sum_i share(i, j) x_i <= 1 for every
!> band j. The rest is that of `psalm_separable`. A problem may have bands that are not linear, if every one of them is convex:
!> `try` says how full the bands are with a choice, and gives a linear band that every choice within them keeps and that this one
!> does not.
!>
!> Branch and bound. The bound of a node is the dual function: at prices of the bands that are not negative, every unknown takes
!> what is cheapest for it alone; it holds whatever the prices are. They come from the barrier method for the dual of the linear
!> relaxation, whose multipliers are the parts of the options. Source: Fisher (1981), The Lagrangian relaxation method for solving
!> integer programming problems, Management Science 27; Boyd and Vandenberghe (2004), Convex optimization, sections 5.2 and 11.3;
!> Kelley (1960), The cutting-plane method for solving convex programs.
module psalm_choice
   use psalm_kinds, only: wp
   use psalm_linear, only: solve_positive
   use psalm_separable, only: cheapest, own_cost, own_curve, separable_solution_t, separable_t, solve_separable
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: choosing_t, choice_solution_t, solve_choice

   real(wp), parameter :: kept_to = 1.0e-9_wp        !! part of a band by which a choice may exceed it: rounding
   real(wp), parameter :: same_cost = 1.0e-9_wp      !! of the cost: what saves less is not looked for
   real(wp), parameter :: first_barrier = 0.1_wp     !! of the cost, by term of the barrier
   real(wp), parameter :: last_barrier = 1.0e-9_wp
   real(wp), parameter :: next_barrier = 0.1_wp
   real(wp), parameter :: warm_barrier = 1.0e-3_wp   !! where the prices of the node above are known
   real(wp), parameter :: to_the_edge = 0.95_wp      !! part of the way to where a term of the barrier ends
   real(wp), parameter :: centred = 0.1_wp           !! Newton's decrement, of the barrier, at which it is narrowed
   real(wp), parameter :: overshot = 0.5_wp          !! of the slope along a step that its end may have against it
   integer, parameter :: first_stack = 64            !! nodes
   integer, parameter :: most_newton = 30            !! steps at one barrier
   integer, parameter :: most_halvings = 30
   integer, parameter :: most_root_cuts = 30         !! linear bands that the relaxation of the whole problem shows
   real(wp), parameter :: shown = 1.0e-4_wp          !! part of a band by which it must be exceeded for that
   integer, parameter :: most_cuts = 60              !! for the rest of one choice
   real(wp), parameter :: nearly = 1.0e-3_wp         !! part of a band by which it may be exceeded where the rest is drawn back
   integer, parameter :: most_backs = 14             !! halvings of that way
   real(wp), parameter :: end_of_cuts = 1.0e-8_wp    !! of the cost: the rest of a choice is solved
   integer, parameter :: looked = 50                 !! nodes between two looks at the stop
   integer, parameter :: repaired = 20               !! nodes between two searches from a node's parts of the options

   !> The problem.
   type, abstract :: choosing_t
      integer, allocatable :: options(:)             !! shape (unknowns)
      real(wp), allocatable :: cost(:, :)            !! shape (options, unknowns)
      real(wp), allocatable :: use(:, :, :)          !! shape (options, unknowns, bands): not negative for linear bands
      type(separable_t) :: rest                      !! its `share` has the same bands
   contains
      procedure(try), deferred :: try
   end type choosing_t

   !> The solution.
   type :: choice_solution_t
      integer, allocatable :: option(:)              !! shape (unknowns)
      real(wp), allocatable :: x(:)                  !! of the rest
      real(wp) :: value = huge(1.0_wp)
      real(wp) :: bound = -huge(1.0_wp)              !! no choice within the bands costs less
      integer :: nodes = 0
      logical :: found = .false.                     !! there is one
      logical :: proven = .false.                    !! the search has ended: nothing is cheaper, or nothing keeps the bands
      real(wp) :: left = huge(1.0_wp)                !! bound of choices whose rest was not solved to the end
   end type choice_solution_t

   abstract interface
      !> How full the fullest band is with parts of the options, of a choice 0 and 1; 1: full. Above that, a linear band that all
      !> choices within the bands keep and these parts do not. Without `use` (not allocated) the bands of the problem say all.
      subroutine try(self, part, x, fullest, use, share)
         import :: choosing_t, wp
         implicit none (type, external)
         class(choosing_t), intent(in) :: self
         real(wp), intent(in) :: part(:, :)              !! shape (options, unknowns)
         real(wp), intent(in) :: x(:)
         real(wp), intent(out) :: fullest
         real(wp), allocatable, intent(out) :: use(:, :) !! shape (options, unknowns)
         real(wp), allocatable, intent(out) :: share(:)  !! shape (unknowns of the rest)
      end subroutine try
   end interface

   !> A node of the search: what is still allowed.
   type :: choice_node_t
      logical, allocatable :: allowed(:, :)          !! shape (options, unknowns)
      real(wp), allocatable :: price(:)              !! shape (bands)
      real(wp) :: bound = -huge(1.0_wp)
   end type choice_node_t

contains

   !> Solve a problem. Unknowns have one option at least. `most_nodes` and the stop end the search early: what was found then is not
   !> `proven`, and `bound` has what is.
   subroutine solve_choice(problem, most_nodes, stop, solution)
      class(choosing_t), intent(inout) :: problem      !! gets the linear bands that `try` finds
      integer, intent(in) :: most_nodes
      type(stop_t), intent(in) :: stop
      type(choice_solution_t), intent(out) :: solution
      type(choice_node_t), allocatable :: stack(:), more(:)
      type(choice_node_t) :: node
      real(wp), allocatable :: part(:, :)
      integer, allocatable :: option(:)
      integer :: depth, c, k
      logical :: ended, within

      call thin_out(problem)
      allocate (stack(first_stack))
      allocate (solution%option(size(problem%options)), source=1)
      allocate (solution%x(size(problem%rest%low)), source=0.0_wp)
      allocate (stack(1)%allowed(size(problem%cost, 1), size(problem%options)))
      do c = 1, size(problem%options)
         stack(1)%allowed(:, c) = [(k <= problem%options(c), k=1, size(problem%cost, 1))]
      end do
      allocate (stack(1)%price(size(problem%use, 3)), source=0.0_wp)
      depth = 1
      ended = .false.
      do while (depth > 0)
         if (solution%nodes >= most_nodes) ended = .true.
         if (mod(solution%nodes, looked) == looked - 1) ended = ended .or. stop%waiting()
         if (ended) exit
         solution%nodes = solution%nodes + 1
         node = stack(depth)
         depth = depth - 1
         if (is_out(node%bound)) cycle
         call strip(problem, node, within)
         if (.not. within) cycle
         call bound_node(problem, node, limit(), part)
         if (is_out(node%bound)) cycle
         if (mod(solution%nodes, repaired) == 1) then
            call cut_node(problem, node, limit(), merge(most_root_cuts, 1, solution%nodes == 1), part)
            if (is_out(node%bound)) cycle
         end if
         if (all(count(node%allowed, dim=1) == 1)) then
            call close_choice(problem, [(findloc(node%allowed(:, c), .true., dim=1), c=1, size(problem%options))], solution)
            cycle
         end if
         if (mod(solution%nodes, repaired) == 1 .or. .not. solution%found) then
            option = rounded(problem, part)
            ! the rest fills the bands beside it
            if (size(problem%rest%low) > 0) call close_choice(problem, option, solution)
            call repair(problem, node, option)
            call close_choice(problem, option, solution)
         end if
         if (depth + size(problem%cost, 1) > size(stack)) then
            allocate (more(2*size(stack) + size(problem%cost, 1)))
            more(:depth) = stack(:depth)
            call move_alloc(more, stack)
         end if
         call branch()
      end do
      solution%proven = .not. ended .and. solution%left >= (1.0_wp - end_of_cuts)*solution%value
      solution%bound = solution%value
      if (solution%proven) return
      solution%bound = min(solution%bound, solution%left)
      do k = 1, depth
         solution%bound = min(solution%bound, stack(k)%bound)
      end do

   contains

      !> What a node must stay below.
      pure real(wp) function limit()
         limit = huge(1.0_wp)
         if (solution%found) limit = (1.0_wp - same_cost)*solution%value
      end function limit

      pure logical function is_out(bound)
         real(wp), intent(in) :: bound

         is_out = bound >= limit()
      end function is_out

      !> Two nodes of a node: the unknown whose option is least decided, below its mean option and above it. The likelier one is
      !> searched first.
      subroutine branch()
         real(wp) :: mean, spread, widest
         integer :: unknown, cut, i, lower
         logical :: low_first

         widest = -1.0_wp
         unknown = 0
         cut = 0
         low_first = .true.
         do i = 1, size(problem%options)
            if (count(node%allowed(:, i)) < 2) cycle
            spread = 1.0_wp - maxval(part(:, i))
            if (spread <= widest) cycle
            widest = spread
            unknown = i
         end do
         mean = sum(part(:, unknown)*[(real(k, wp), k=1, size(part, 1))])
         lower = findloc(node%allowed(:, unknown), .true., dim=1)
         cut = max(lower, min(int(mean), findloc(node%allowed(:, unknown), .true., dim=1, back=.true.) - 1))
         low_first = sum(part(:cut, unknown)) >= 0.5_wp
         do i = 1, 2
            depth = depth + 1
            stack(depth) = node
            if ((i == 2) .eqv. low_first) then
               stack(depth)%allowed(cut + 1:, unknown) = .false.
            else
               stack(depth)%allowed(:cut, unknown) = .false.
            end if
         end do
      end subroutine branch
   end subroutine solve_choice

   !> Take out options that overfill a linear band even if all others take what uses least of it.
   pure subroutine strip(problem, node, within)
      class(choosing_t), intent(in) :: problem
      type(choice_node_t), intent(inout) :: node
      logical, intent(out) :: within                 !! every unknown has an option left
      real(wp) :: least(size(problem%options)), total
      integer :: j, c, k, i
      logical :: changed

      within = .true.
      do
         changed = .false.
         do j = 1, size(problem%use, 3)
            do c = 1, size(least)
               least(c) = minval(problem%use(:, c, j), mask=node%allowed(:, c))
            end do
            total = sum(least)
            do i = 1, size(problem%rest%low)
               total = total + min(problem%rest%share(i, j)*problem%rest%low(i), problem%rest%share(i, j)*problem%rest%high(i))
            end do
            do c = 1, size(least)
               do k = 1, problem%options(c)
                  if (.not. node%allowed(k, c)) cycle
                  if (total - least(c) + problem%use(k, c, j) <= 1.0_wp + kept_to) cycle
                  node%allowed(k, c) = .false.
                  changed = .true.
               end do
               if (.not. any(node%allowed(:, c))) then
                  within = .false.
                  return
               end if
            end do
         end do
         if (.not. changed) exit
      end do
   end subroutine strip

   !> The bound of a node, and the parts of the options in its relaxation. It ends where the bound is at the limit.
   subroutine bound_node(problem, node, limit, part)
      class(choosing_t), intent(in) :: problem
      type(choice_node_t), intent(inout) :: node
      real(wp), intent(in) :: limit
      real(wp), allocatable, intent(out) :: part(:, :) !! shape (options, unknowns)
      integer, allocatable :: bands(:)
      real(wp), allocatable :: y(:), trial(:), gradient(:), at_trial(:), hessian(:, :), step(:), best(:)
      real(wp) :: barrier, scale, far, slope, bound
      integer :: m, n, j, c, newton, halving, terms
      logical :: regular, warm

      n = size(problem%options)
      if (size(node%price) < size(problem%use, 3)) node%price = [node%price, &
         [(0.0_wp, j=1, size(problem%use, 3) - size(node%price))]]
      warm = any(node%price > 0.0_wp)
      bands = pack([(j, j=1, size(node%price))], [(can_fill(j), j=1, size(node%price))])
      m = size(bands)
      terms = m + count(node%allowed)
      allocate (y(m + n), gradient(m + n), at_trial(m + n), hessian(m + n, m + n), step(m + n))
      node%bound = max(node%bound, dual(problem, node%allowed, node%price))
      scale = cost_scale(problem, node%allowed)
      best = node%price
      if (m > 0 .and. node%bound < limit) then
         barrier = merge(warm_barrier, first_barrier, warm)*scale/real(terms, wp)
         y(:m) = max(node%price(bands), barrier)
         call lower_unknowns()
         do while (barrier*real(terms, wp) > last_barrier*scale)
            do newton = 1, most_newton
               call find_slopes(y, barrier, gradient, hessian)
               call solve_positive(hessian, gradient, step, regular)
               if (.not. regular) exit
               slope = sum(gradient*step)
               if (slope <= centred*barrier) exit
               far = min(1.0_wp, to_the_edge*reach(y, step))
               do halving = 1, most_halvings
                  trial = y + far*step
                  call find_slopes(trial, barrier, at_trial)
                  if (sum(at_trial*step) >= -overshot*slope) exit
                  far = 0.5_wp*far
               end do
               y = trial
            end do
            best(bands) = y(:m)
            bound = dual(problem, node%allowed, best)
            if (bound > node%bound) then
               node%bound = bound
               node%price = best
            end if
            if (node%bound >= limit) exit
            barrier = next_barrier*barrier
         end do
         barrier = barrier/next_barrier
         part = barrier/max(slack(y), tiny(1.0_wp))
      else
         allocate (part(size(problem%cost, 1), n), source=0.0_wp)
         do c = 1, n
            part(minloc(problem%cost(:, c), mask=node%allowed(:, c), dim=1), c) = 1.0_wp
         end do
      end if
      where (.not. node%allowed) part = 0.0_wp
      do c = 1, n
         part(:, c) = part(:, c)/max(sum(part(:, c)), tiny(1.0_wp))
      end do

   contains

      !> True if something could fill the band.
      pure logical function can_fill(j)
         integer, intent(in) :: j
         real(wp) :: most
         integer :: i

         most = 0.0_wp
         do i = 1, n
            most = most + maxval(problem%use(:, i, j), mask=node%allowed(:, i))
         end do
         do i = 1, size(problem%rest%low)
            most = most + max(problem%rest%share(i, j)*problem%rest%low(i), problem%rest%share(i, j)*problem%rest%high(i))
         end do
         can_fill = most > 1.0_wp
      end function can_fill

      !> Of every allowed option what it costs with its prices, less what its unknown costs at least.
      pure function slack(at)
         real(wp), intent(in) :: at(:)
         real(wp) :: slack(size(problem%cost, 1), n)
         integer :: i, b

         do i = 1, n
            slack(:, i) = problem%cost(:, i) - at(m + i)
            do b = 1, m
               slack(:, i) = slack(:, i) + at(b)*problem%use(:, i, bands(b))
            end do
         end do
         where (.not. node%allowed) slack = huge(1.0_wp)
      end function slack

      !> Where the costs of the unknowns begin.
      subroutine lower_unknowns()
         real(wp) :: at_zero(size(problem%cost, 1), n)
         integer :: i

         y(m + 1:) = 0.0_wp
         at_zero = slack(y)
         do i = 1, n
            y(m + i) = minval(at_zero(:, i)) - barrier*real(count(node%allowed(:, i)), wp)
         end do
      end subroutine lower_unknowns

      !> Slopes of the dual with its barrier, and less its second derivatives.
      pure subroutine find_slopes(at, barrier, slopes, curves)
         real(wp), intent(in) :: at(:), barrier
         real(wp), intent(out) :: slopes(:)
         real(wp), intent(out), optional :: curves(:, :)
         real(wp) :: left(size(problem%cost, 1), n), weight, x, by_weight, own(m)
         integer :: i, k, b

         left = slack(at)
         slopes(:m) = -1.0_wp + barrier/at(:m)
         slopes(m + 1:) = 1.0_wp
         if (present(curves)) then
            curves = 0.0_wp
            do b = 1, m
               curves(b, b) = barrier/at(b)**2
            end do
         end if
         do i = 1, n
            do k = 1, problem%options(i)
               if (.not. node%allowed(k, i)) cycle
               weight = barrier/left(k, i)
               own = problem%use(k, i, bands)
               slopes(:m) = slopes(:m) + weight*own
               slopes(m + i) = slopes(m + i) - weight
               if (.not. present(curves)) cycle
               by_weight = weight/left(k, i)
               do b = 1, m
                  curves(:b, b) = curves(:b, b) + by_weight*own(b)*own(:b)
               end do
               curves(:m, m + i) = curves(:m, m + i) - by_weight*own
               curves(m + i, m + i) = curves(m + i, m + i) + by_weight
            end do
         end do
         do i = 1, size(problem%rest%low)
            own = problem%rest%share(i, bands)
            weight = sum(own*at(:m))
            x = cheapest(problem%rest, i, weight)
            slopes(:m) = slopes(:m) + x*own
            if (.not. present(curves) .or. x <= problem%rest%low(i) .or. x >= problem%rest%high(i)) cycle
            by_weight = 1.0_wp/own_curve(problem%rest, i, x)
            do b = 1, m
               curves(:b, b) = curves(:b, b) + by_weight*own(b)*own(:b)
            end do
         end do
      end subroutine find_slopes

      !> How far a step may go until a term of the barrier ends.
      pure real(wp) function reach(at, by)
         real(wp), intent(in) :: at(:), by(:)
         real(wp), dimension(size(problem%cost, 1), n) :: left, change
         integer :: i, k, b

         reach = huge(1.0_wp)
         do b = 1, m
            if (by(b) < 0.0_wp) reach = min(reach, -at(b)/by(b))
         end do
         left = slack(at)
         do i = 1, n
            change(:, i) = -by(m + i)
            do b = 1, m
               change(:, i) = change(:, i) + by(b)*problem%use(:, i, bands(b))
            end do
            do k = 1, problem%options(i)
               if (node%allowed(k, i) .and. change(k, i) < 0.0_wp) reach = min(reach, -left(k, i)/change(k, i))
            end do
         end do
      end function reach
   end subroutine bound_node

   !> Linear bands that the parts of the options of a node exceed.
   subroutine cut_node(problem, node, limit, most, part)
      class(choosing_t), intent(inout) :: problem
      type(choice_node_t), intent(inout) :: node
      real(wp), intent(in) :: limit
      integer, intent(in) :: most
      real(wp), allocatable, intent(inout) :: part(:, :) !! shape (options, unknowns)
      real(wp), allocatable :: use(:, :), share(:)
      real(wp) :: fullest
      integer :: k, i

      do k = 1, most
         call problem%try(part, [(cheapest(problem%rest, i, sum(problem%rest%share(i, :)*node%price)), &
                                  i=1, size(problem%rest%low))], fullest, use, share)
         if (fullest <= 1.0_wp + shown .or. .not. allocated(use)) exit
         call add_band(problem, use, share)
         call bound_node(problem, node, limit, part)
         if (node%bound >= limit) exit
      end do
   end subroutine cut_node

   !> The dual function: at prices that are not negative nothing that is allowed and within the bands costs less.
   pure real(wp) function dual(problem, allowed, price)
      class(choosing_t), intent(in) :: problem
      logical, intent(in) :: allowed(:, :)
      real(wp), intent(in) :: price(:)
      real(wp) :: each(size(problem%cost, 1)), weight, x
      integer :: c, i, j

      dual = -sum(price)
      do c = 1, size(problem%options)
         each = problem%cost(:, c)
         do j = 1, size(price)
            if (price(j) > 0.0_wp) each = each + price(j)*problem%use(:, c, j)
         end do
         dual = dual + minval(each, mask=allowed(:, c))
      end do
      do i = 1, size(problem%rest%low)
         weight = sum(problem%rest%share(i, :)*price)
         x = cheapest(problem%rest, i, weight)
         dual = dual + weight*x + own_cost(problem%rest, i, x)
      end do
   end function dual

   !> What costs are measured by.
   pure real(wp) function cost_scale(problem, allowed) result(scale)
      class(choosing_t), intent(in) :: problem
      logical, intent(in) :: allowed(:, :)
      integer :: c, i

      scale = 0.0_wp
      do c = 1, size(problem%options)
         scale = scale + maxval(abs(problem%cost(:, c)), mask=allowed(:, c))
      end do
      do i = 1, size(problem%rest%low)
         scale = scale + own_cost(problem%rest, i, problem%rest%high(i))
      end do
      scale = max(scale, tiny(1.0_wp))
   end function cost_scale

   !> The parts of a choice.
   pure function one_of_each(problem, option) result(part)
      class(choosing_t), intent(in) :: problem
      integer, intent(in) :: option(:)
      real(wp) :: part(size(problem%cost, 1), size(option))
      integer :: c

      part = 0.0_wp
      do c = 1, size(option)
         part(option(c), c) = 1.0_wp
      end do
   end function one_of_each

   !> The option of every unknown that has most of it.
   pure function rounded(problem, part) result(option)
      class(choosing_t), intent(in) :: problem
      real(wp), intent(in) :: part(:, :)
      integer :: option(size(problem%options))

      option = maxloc(part, dim=1)
   end function rounded

   !> Change options until the linear bands are kept, by what costs least for what it frees of the fullest band; then take what
   !> saves most as long as they stay kept. The rest is thought to be where the prices of the node have it.
   subroutine repair(problem, node, option)
      class(choosing_t), intent(in) :: problem
      type(choice_node_t), intent(in) :: node
      integer, intent(inout) :: option(:)
      real(wp) :: used(size(problem%use, 3)), change, gain, best
      integer :: c, k, j, to(2), step

      do j = 1, size(used)
         used(j) = sum([(problem%use(option(c), c, j), c=1, size(option))])
      end do
      do c = 1, size(problem%rest%low)
         associate (share => problem%rest%share(c, :))
            used = used + share*cheapest(problem%rest, c, sum(share(:size(node%price))*node%price))
         end associate
      end do
      do step = 1, size(problem%cost)
         if (size(used) == 0) exit
         j = maxloc(used, dim=1)
         if (used(j) <= 1.0_wp + kept_to) exit
         to = 0
         best = huge(1.0_wp)
         do c = 1, size(option)
            do k = 1, problem%options(c)
               change = problem%use(option(c), c, j) - problem%use(k, c, j)
               if (.not. node%allowed(k, c) .or. .not. change > 0.0_wp) cycle
               gain = (problem%cost(k, c) - problem%cost(option(c), c))/change
               if (gain >= best) cycle
               best = gain
               to = [k, c]
            end do
         end do
         if (to(1) == 0) return
         call take(to)
      end do
      do step = 1, size(problem%cost)
         to = 0
         best = 0.0_wp
         do c = 1, size(option)
            do k = 1, problem%options(c)
               gain = problem%cost(option(c), c) - problem%cost(k, c)
               if (.not. node%allowed(k, c) .or. gain <= best) cycle
               if (any(used + problem%use(k, c, :) - problem%use(option(c), c, :) > 1.0_wp + kept_to)) cycle
               best = gain
               to = [k, c]
            end do
         end do
         if (to(1) == 0) exit
         call take(to)
      end do

   contains

      subroutine take(which)
         integer, intent(in) :: which(2)

         used = used + problem%use(which(1), which(2), :) - problem%use(option(which(2)), which(2), :)
         option(which(2)) = which(1)
      end subroutine take
   end subroutine repair

   !> A whole choice: the rest beside it, and whether it keeps the bands. Linear bands that it shows are added to the problem.
   subroutine close_choice(problem, option, solution)
      class(choosing_t), intent(inout) :: problem
      integer, intent(in) :: option(:)
      type(choice_solution_t), intent(inout) :: solution
      type(separable_t) :: rest
      type(separable_solution_t) :: of_rest
      real(wp), allocatable :: use(:, :), share(:), x(:)
      real(wp) :: room, fullest, value, fixed
      integer :: cut, j, c, bands

      fixed = sum([(problem%cost(option(c), c), c=1, size(option))])
      do cut = 1, most_cuts
         x = problem%rest%low
         value = fixed
         rest = problem%rest
         bands = 0
         do j = 1, size(problem%use, 3)
            room = 1.0_wp - sum([(problem%use(option(c), c, j), c=1, size(option))])
            if (room < -kept_to) then
               if (any(problem%rest%share(:, j) < 0.0_wp)) solution%left = min(solution%left, fixed)
               return
            end if
            if (size(x) == 0) cycle
            if (.not. any(problem%rest%share(:, j) > 0.0_wp)) cycle
            if (room <= kept_to) then
               if (any(problem%rest%share(:, j) < 0.0_wp)) solution%left = min(solution%left, fixed)
               return
            end if
            bands = bands + 1
            rest%share(:, bands) = problem%rest%share(:, j)/room
         end do
         if (size(x) > 0) then
            rest%share = rest%share(:, :bands)
            call solve_separable(rest, of_rest)
            if (.not. of_rest%solved) then
               if (of_rest%tightest == 0) solution%left = min(solution%left, fixed)
               return
            end if
            x = of_rest%x
            value = fixed + of_rest%value
         end if
         if (solution%found .and. value >= (1.0_wp - end_of_cuts)*solution%value) then
            if (cut > 1 .or. value >= (1.0_wp - same_cost)*solution%value) return
         end if
         call problem%try(one_of_each(problem, option), x, fullest, use, share)
         if (fullest <= 1.0_wp + kept_to) then
            call take(x, value)
            return
         end if
         if (.not. allocated(use)) return
         if (fullest <= 1.0_wp + nearly .and. size(x) > 0) call draw_back()
         call add_band(problem, use, share)
         if (size(x) == 0) return
      end do
      solution%left = min(solution%left, value)

   contains

      subroutine take(at, costs)
         real(wp), intent(in) :: at(:), costs

         if (solution%found .and. costs >= solution%value) return
         solution%option = option
         solution%x = at
         solution%value = costs
         solution%found = .true.
      end subroutine take

      !> The rest on the way back to its lower bounds, where the bands are kept.
      subroutine draw_back()
         real(wp) :: at(size(x)), inside, outside, part, costs
         real(wp), allocatable :: no_use(:, :), no_share(:)
         integer :: k, i

         inside = 0.0_wp
         outside = 1.0_wp
         part = 1.0_wp - 2.0_wp*(fullest - 1.0_wp)
         do k = 1, most_backs
            at = problem%rest%low + part*(x - problem%rest%low)
            call problem%try(one_of_each(problem, option), at, fullest, no_use, no_share)
            if (fullest <= 1.0_wp + kept_to) then
               inside = part
            else
               outside = part
            end if
            part = 0.5_wp*(inside + outside)
         end do
         if (.not. inside > 0.0_wp) return
         at = problem%rest%low + inside*(x - problem%rest%low)
         costs = fixed
         do i = 1, size(at)
            costs = costs + own_cost(problem%rest, i, at(i))
         end do
         call take(at, costs)
      end subroutine draw_back
   end subroutine close_choice

   !> Leave out linear bands that another one implies.
   pure subroutine thin_out(problem)
      class(choosing_t), intent(inout) :: problem
      logical :: kept(size(problem%use, 3))
      integer, allocatable :: list(:)
      integer :: i, j

      kept = .true.
      do i = 1, size(kept)
         do j = 1, size(kept)
            if (i == j .or. .not. kept(j)) cycle
            if (all(problem%use(:, :, i) <= problem%use(:, :, j)) .and. &
                all(problem%rest%share(:, i) <= problem%rest%share(:, j))) then
               kept(i) = .false.
               exit
            end if
         end do
      end do
      list = pack([(i, i=1, size(kept))], kept)
      problem%use = problem%use(:, :, list)
      problem%rest%share = problem%rest%share(:, list)
   end subroutine thin_out

   !> One more linear band.
   subroutine add_band(problem, use, share)
      class(choosing_t), intent(inout) :: problem
      real(wp), intent(in) :: use(:, :), share(:)
      real(wp), allocatable :: uses(:, :, :), shares(:, :)
      integer :: m

      m = size(problem%use, 3)
      allocate (uses(size(use, 1), size(use, 2), m + 1), shares(size(share), m + 1))
      uses(:, :, :m) = problem%use
      uses(:, :, m + 1) = use
      shares(:, :m) = problem%rest%share
      shares(:, m + 1) = share
      call move_alloc(uses, problem%use)
      call move_alloc(shares, problem%rest%share)
   end subroutine add_band
end module psalm_choice
