!> Springs that make a load least: the drive's or a joint's, its range, its RMS or its greatest amount.
!>
!> A spring of stiffness S and free length L pulls its ends together with S (l - L) = S l - k, k = S L. For given places of its ends
!> every load is linear in S and k, and the least range, RMS or amount is a convex problem. The search goes by tangents of the
!> places: the load is linear in their moves too, to first order, so that each step is convex with moves of limited length; from
!> many starts. Where the places are given one step is the global optimum, with the bound that proves it.
module psalm_spring_search
   use psalm_conic, only: conic_t, conic_solution_t, solve_conic
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   use psalm_linear, only: triangle_of
   use psalm_spring_design_group, only: criterion_range, criterion_rms, criterion_peak
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: spring_room_t, spring_path_t, found_spring_t, spring_search_t, search_springs, load_with, criterion_of

   integer, parameter :: each = 6                  !! unknowns of a spring: x, y of either end, S, k
   integer, parameter :: most_steps = 80
   real(wp), parameter :: least_move = 1.0e-7_wp   !! of the reach: the search ends with such moves
   real(wp), parameter :: least_gain = 1.0e-10_wp  !! relative gain of a step that is one of the last
   real(wp), parameter :: stiffest_of_all = 1.0e3_wp !! bare loads over reaches: no spring is stiffer, where the user sets no limit
   real(wp), parameter :: as_low = 1.0e-6_wp       !! relative difference of values that are the same optimum

   !> How one end of a spring moves, and what a wrench there does to the load.
   type :: spring_path_t
      real(wp), allocatable :: x(:), y(:)          !! shape (positions): place from which the end is counted, m
      real(wp), allocatable :: c(:), s(:)          !! direction of its link's axes
      real(wp), allocatable :: slope(:, :, :)      !! shape (positions, components, 3): load by force x, y, moment
   end type spring_path_t

   !> Room for a spring.
   type :: spring_room_t
      type(spring_path_t) :: ends(2)
      real(wp) :: reach(2) = 0.0_wp                !! of the ends, m; 0: given
      real(wp) :: stiffest = 0.0_wp                !! N/m; 0: no limit
      real(wp) :: free(2) = 0.0_wp                 !! least and greatest free length, m
   end type spring_room_t

   type :: found_spring_t
      real(wp) :: at(2, 2) = 0.0_wp                !! x, y of the ends, from where they are counted, in the axes of their links, m
      real(wp) :: stiffness = 0.0_wp               !! N/m
      real(wp) :: free = 0.0_wp                    !! m
   end type found_spring_t

   type :: spring_search_t
      type(found_spring_t), allocatable :: springs(:)
      real(wp) :: value = huge(1.0_wp)             !! of the criterion, N or N m
      real(wp) :: bound = 0.0_wp                   !! where the places are given: no springs there have less
      real(wp) :: gap = 0.0_wp, residual = 0.0_wp
      integer :: starts = 0, ended_here = 0
      logical :: convex = .false.
      logical :: found = .false.
   end type spring_search_t

contains

   !> The criterion of a load. Shape of `load`: (positions, components).
   pure real(wp) function criterion_of(criterion, load) result(value)
      integer, intent(in) :: criterion
      real(wp), intent(in) :: load(:, :)

      select case (criterion)
      case (criterion_range)
         value = maxval(load(:, 1)) - minval(load(:, 1))
      case (criterion_rms)
         value = sqrt(sum(load**2)/real(size(load), wp))
      case default
         value = sqrt(maxval(sum(load**2, dim=2)))
      end select
   end function criterion_of

   !> The load with springs. Shape: (positions, components).
   pure function load_with(bare, rooms, springs) result(load)
      real(wp), intent(in) :: bare(:, :)
      type(spring_room_t), intent(in) :: rooms(:)
      type(found_spring_t), intent(in) :: springs(:)
      real(wp), allocatable :: load(:, :)
      integer :: k

      load = bare
      do k = 1, size(springs)
         call add_spring(rooms(k), springs(k), load)
      end do
   end function load_with

   !> Load of one spring, and with `slopes` its derivatives by the unknowns, shape (positions, components, 6).
   pure subroutine add_spring(room, spring, load, slopes)
      type(spring_room_t), intent(in) :: room
      type(found_spring_t), intent(in) :: spring
      real(wp), intent(inout) :: load(:, :)
      real(wp), intent(out), optional :: slopes(:, :, :)
      real(wp) :: z(2, 2), gap(2), force(2), length, factor, per_length, axes(2, 2, 2), dgap(2), dforce(2), dz(2), k
      integer :: i, e, c

      k = spring%stiffness*spring%free
      do i = 1, size(load, 1)
         do e = 1, 2
            associate (path => room%ends(e))
               axes(:, 1, e) = [path%c(i), path%s(i)]
               axes(:, 2, e) = [-path%s(i), path%c(i)]
               z(:, e) = [path%x(i), path%y(i)] + axes(:, 1, e)*spring%at(1, e) + axes(:, 2, e)*spring%at(2, e)
            end associate
         end do
         gap = z(:, 2) - z(:, 1)
         length = max(hypotenuse(gap(1), gap(2)), tiny(1.0_wp)**0.25_wp)
         per_length = k/length
         factor = spring%stiffness - per_length
         force = factor*gap
         load(i, :) = load(i, :) + effect(force, z)
         if (.not. present(slopes)) cycle
         do e = 1, 2
            do c = 1, 2
               dz = axes(:, c, e)
               dgap = merge(dz, -dz, e == 2)
               dforce = factor*dgap + (per_length/length**2*dot_product(gap, dgap))*gap
               slopes(i, :, 2*(e - 1) + c) = effect(dforce, z) + &
                                             merge(1.0_wp, -1.0_wp, e == 1)*room%ends(e)%slope(i, :, 3)* &
                                             (dz(1)*force(2) - dz(2)*force(1))
            end do
         end do
         slopes(i, :, 5) = effect(gap, z)
         slopes(i, :, 6) = effect(-gap/length, z)
      end do

   contains

      !> What a pull on the first end, and its opposite on the second, does to the load.
      pure function effect(pull, z)
         real(wp), intent(in) :: pull(2), z(2, 2)
         real(wp) :: effect(size(load, 2))

         associate (p => room%ends(1)%slope(i, :, :), q => room%ends(2)%slope(i, :, :))
            effect = (p(:, 1) - q(:, 1))*pull(1) + (p(:, 2) - q(:, 2))*pull(2) + &
                     p(:, 3)*(z(1, 1)*pull(2) - z(2, 1)*pull(1)) - q(:, 3)*(z(1, 2)*pull(2) - z(2, 2)*pull(1))
         end associate
      end function effect
   end subroutine add_spring

   !> The best springs from many starts; the first start is `begin`, if there is one.
   subroutine search_springs(bare, rooms, criterion, starts, seed, search, begin)
      real(wp), intent(in) :: bare(:, :)           !! shape (positions, components): the load without these springs
      type(spring_room_t), intent(in) :: rooms(:)
      integer, intent(in) :: criterion, starts, seed
      type(spring_search_t), intent(out) :: search
      type(found_spring_t), intent(in), optional :: begin(:)
      type(spring_search_t) :: tried
      type(found_spring_t) :: springs(size(rooms))
      type(xoshiro_t) :: random
      real(wp) :: values(starts)
      integer :: start, k, made

      call random%seed(seed, purpose_starts)
      made = 0
      search%springs = springs
      do start = 1, starts
         call random%use_stream(start)
         do k = 1, size(rooms)
            call draw(random, rooms(k), springs(k))
         end do
         if (start == 1 .and. present(begin)) springs = begin
         call go_by_tangents(bare, rooms, criterion, springs, tried)
         if (.not. tried%found) cycle
         made = made + 1
         values(made) = tried%value
         if (tried%value < search%value) search = tried
         if (tried%convex) exit
      end do
      search%starts = made
      search%ended_here = count(values(:made) <= search%value*(1.0_wp + as_low))
   end subroutine search_springs

   !> Ends anywhere within their reach, a free length anywhere between its limits; stiffness comes with the first step.
   subroutine draw(random, room, spring)
      type(xoshiro_t), intent(inout) :: random
      type(spring_room_t), intent(in) :: room
      type(found_spring_t), intent(out) :: spring
      real(wp) :: draw_now
      integer :: e, c

      do e = 1, 2
         do
            do c = 1, 2
               call random%next(draw_now)
               spring%at(c, e) = 2.0_wp*draw_now - 1.0_wp
            end do
            if (sum(spring%at(:, e)**2) <= 1.0_wp) exit
         end do
         spring%at(:, e) = room%reach(e)*spring%at(:, e)
      end do
      call random%next(draw_now)
      spring%free = room%free(1) + draw_now*(room%free(2) - room%free(1))
   end subroutine draw

   !> A local optimum from a start.
   subroutine go_by_tangents(bare, rooms, criterion, begin, best)
      real(wp), intent(in) :: bare(:, :)
      type(spring_room_t), intent(in) :: rooms(:)
      integer, intent(in) :: criterion
      type(found_spring_t), intent(in) :: begin(:)
      type(spring_search_t), intent(out) :: best
      type(spring_search_t) :: tried
      type(found_spring_t) :: springs(size(begin))
      real(wp) :: move, gain
      integer :: step, k

      springs = begin
      best%springs = springs
      best%convex = all([(rooms(k)%reach, k=1, size(rooms))] <= 0.0_wp)
      move = 0.0_wp    ! first the best stiffness for these places
      do step = 1, most_steps
         call solve_step(bare, rooms, criterion, springs, move, tried)
         if (.not. tried%found) then
            if (step == 1) return
            move = 0.25_wp*move
            if (move < least_move) exit
            cycle
         end if
         tried%value = criterion_of(criterion, load_with(bare, rooms, tried%springs))
         if (step == 1 .or. tried%value < best%value) then
            gain = huge(1.0_wp)
            if (step > 1) gain = (best%value - tried%value)/max(best%value, tiny(1.0_wp))
            tried%convex = best%convex
            best = tried
            springs = tried%springs
            if (best%convex) exit
            if (gain <= least_gain .and. move < 1.0e-2_wp) exit
            move = min(1.0_wp, max(2.0_wp*move, 0.25_wp))
         else
            move = 0.25_wp*move
            if (move < least_move) exit
         end if
      end do
   end subroutine go_by_tangents

   !> The convex problem of one step: springs whose ends move at most `move` reaches.
   subroutine solve_step(bare, rooms, criterion, springs, move, result)
      real(wp), intent(in) :: bare(:, :)
      type(spring_room_t), intent(in) :: rooms(:)
      integer, intent(in) :: criterion
      type(found_spring_t), intent(in) :: springs(:)
      real(wp), intent(in) :: move
      type(spring_search_t), intent(out) :: result
      type(conic_t) :: problem
      type(conic_solution_t) :: solution
      real(wp) :: constant(size(bare, 1), size(bare, 2)), slopes(size(bare, 1), size(bare, 2), each)
      real(wp) :: unit, stiff(size(rooms)), length(size(rooms)), limit, value
      real(wp), allocatable :: rows(:, :), triangle(:, :), scales(:)
      integer, allocatable :: column(:, :), sizes(:)
      integer :: k, e, c, n, tau, level, row, cone, positions, comps, i, lines

      positions = size(bare, 1)
      comps = size(bare, 2)
      unit = criterion_of(criterion, bare)
      result%springs = springs
      if (.not. unit > 0.0_wp) then
         ! there is nothing to be made less
         result%found = .true.
         result%springs%stiffness = 0.0_wp
         return
      end if
      ! unknowns: moves of the ends in reaches, S and k/length in stiff; then the level of a range, and tau
      allocate (column(each, size(rooms)), source=0)
      n = 0
      do k = 1, size(rooms)
         do e = 1, 2
            if (.not. (rooms(k)%reach(e) > 0.0_wp .and. move > 0.0_wp)) cycle
            column(2*e - 1:2*e, k) = [n + 1, n + 2]
            n = n + 2
         end do
         column(5, k) = n + 1
         n = n + 1
         if (rooms(k)%free(2) > rooms(k)%free(1)) then
            column(6, k) = n + 1
            n = n + 1
         end if
      end do
      level = 0
      if (criterion == criterion_range) level = n + 1
      if (criterion == criterion_range) n = n + 1
      n = n + 1
      tau = n
      allocate (scales(n), source=1.0_wp)
      allocate (rows(positions*comps, n + 1), source=0.0_wp)
      constant = load_with(bare, rooms, springs)
      do k = 1, size(rooms)
         slopes = 0.0_wp
         call add_slopes(rooms(k), springs(k), slopes)
         if (column(6, k) == 0) then
            ! the free length is given: k follows from S
            slopes(:, :, 5) = slopes(:, :, 5) + rooms(k)%free(1)*slopes(:, :, 6)
            slopes(:, :, 6) = 0.0_wp
         end if
         ! a stiffness whose load is of the size of what is to be made less
         length(k) = max(maxval(rooms(k)%reach), rooms(k)%free(2))
         if (.not. length(k) > 0.0_wp) length(k) = 1.0_wp
         stiff(k) = unit/max(maxval(abs(slopes(:, :, 5))), tiny(1.0_wp)/epsilon(1.0_wp))
         do e = 1, each
            if (column(e, k) == 0) cycle
            select case (e)
            case (1, 2)
               scales(column(e, k)) = rooms(k)%reach(1)
            case (3, 4)
               scales(column(e, k)) = rooms(k)%reach(2)
            case (5)
               scales(column(e, k)) = stiff(k)
            case default
               scales(column(e, k)) = stiff(k)*length(k)
            end select
            rows(:, column(e, k)) = reshape(slopes(:, :, e), [positions*comps])*scales(column(e, k))/unit
         end do
         ! S and k are unknowns themselves, not their changes
         constant = constant - springs(k)%stiffness*slopes(:, :, 5) - springs(k)%stiffness*springs(k)%free*slopes(:, :, 6)
      end do
      rows(:, n + 1) = reshape(constant, [positions*comps])/unit
      if (level > 0) rows(:, level) = -1.0_wp
      lines = 1
      do k = 1, size(rooms)
         lines = lines + 2
         if (column(6, k) > 0) lines = lines + 2
      end do
      if (criterion == criterion_range .or. (criterion == criterion_peak .and. comps == 1)) lines = lines + 2*positions
      allocate (sizes(0))
      do k = 1, size(rooms)
         do e = 1, 2
            if (column(2*e, k) > 0) sizes = [sizes, 3, 3]
         end do
      end do
      if (criterion == criterion_rms) sizes = [sizes, n + 2]
      if (criterion == criterion_peak .and. comps == 2) sizes = [sizes, spread(3, 1, positions)]
      problem%lines = lines
      problem%cones = sizes
      allocate (problem%q(n), problem%g(lines + sum(sizes), n), problem%h(lines + sum(sizes)), source=0.0_wp)
      problem%q(tau) = 1.0_wp
      row = 1
      problem%g(1, tau) = 1.0_wp
      problem%h(1) = 1.0e3_wp
      do k = 1, size(rooms)
         limit = stiffest_of_all
         if (rooms(k)%stiffest > 0.0_wp) limit = rooms(k)%stiffest/stiff(k)
         problem%g(row + 1, column(5, k)) = -1.0_wp
         problem%g(row + 2, column(5, k)) = 1.0_wp
         problem%h(row + 2) = limit
         row = row + 2
         if (column(6, k) == 0) cycle
         problem%g(row + 1, column(5, k)) = rooms(k)%free(1)/length(k)
         problem%g(row + 1, column(6, k)) = -1.0_wp
         problem%g(row + 2, column(5, k)) = -rooms(k)%free(2)/length(k)
         problem%g(row + 2, column(6, k)) = 1.0_wp
         row = row + 2
      end do
      cone = lines
      do k = 1, size(rooms)
         do e = 1, 2
            if (column(2*e, k) == 0) cycle
            problem%h(cone + 1) = 1.0_wp + 1.0e-9_wp
            problem%h(cone + 4) = move
            do c = 1, 2
               problem%h(cone + 1 + c) = springs(k)%at(c, e)/rooms(k)%reach(e)
               problem%g(cone + 1 + c, column(2*e - 2 + c, k)) = -1.0_wp
               problem%g(cone + 4 + c, column(2*e - 2 + c, k)) = -1.0_wp
            end do
            cone = cone + 6
         end do
      end do
      if (criterion == criterion_rms) then
         triangle = triangle_of(rows/sqrt(real(positions*comps, wp)))
         problem%g(cone + 1, tau) = -1.0_wp
         problem%g(cone + 2:cone + n + 2, :) = -triangle(:, :n)
         problem%h(cone + 2:cone + n + 2) = triangle(:, n + 1)
      else if (comps == 2) then
         do i = 1, positions
            problem%g(cone + 1, tau) = -1.0_wp
            problem%g(cone + 2:cone + 3, :) = -rows([i, positions + i], :n)
            problem%h(cone + 2:cone + 3) = rows([i, positions + i], n + 1)
            cone = cone + 3
         end do
      else
         problem%g(row + 1:row + positions, :) = rows(:, :n)
         problem%h(row + 1:row + positions) = -rows(:, n + 1)
         problem%g(row + positions + 1:row + 2*positions, :) = -rows(:, :n)
         problem%h(row + positions + 1:row + 2*positions) = rows(:, n + 1)
         problem%g(row + 1:row + 2*positions, tau) = -1.0_wp
      end if
      call solve_conic(problem, solution)
      result%found = solution%solved
      if (.not. solution%solved) return
      do k = 1, size(rooms)
         associate (spring => result%springs(k))
            do e = 1, 4
               if (column(e, k) == 0) cycle
               associate (at => spring%at(modulo(e - 1, 2) + 1, (e + 1)/2))
                  at = at + scales(column(e, k))*solution%x(column(e, k))
               end associate
            end do
            spring%stiffness = max(0.0_wp, scales(column(5, k))*solution%x(column(5, k)))
            spring%free = rooms(k)%free(1)
            if (column(6, k) > 0 .and. spring%stiffness > 0.0_wp) then
               value = scales(column(6, k))*solution%x(column(6, k))/spring%stiffness
               spring%free = min(max(value, rooms(k)%free(1)), rooms(k)%free(2))
            end if
         end associate
      end do
      result%gap = solution%gap
      result%residual = solution%residual
      result%bound = max(0.0_wp, solution%bound)*unit
      if (criterion == criterion_range) result%bound = 2.0_wp*result%bound
   end subroutine solve_step

   !> Derivatives alone.
   pure subroutine add_slopes(room, spring, slopes)
      type(spring_room_t), intent(in) :: room
      type(found_spring_t), intent(in) :: spring
      real(wp), intent(out) :: slopes(:, :, :)
      real(wp) :: load(size(slopes, 1), size(slopes, 2))

      load = 0.0_wp
      call add_spring(room, spring, load, slopes)
   end subroutine add_slopes
end module psalm_spring_search
