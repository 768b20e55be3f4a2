!> The motion of a sketch of any Assur groups, proven: tubes around a predicted motion that hold exactly one solution each.
!>
!> The inputs go along a straight line, by its way s. In a box |s| <= r around a position the poses are predicted by a cubic
!> y(s). With C the inverse of the matrix of all equations in the middle, z -> z - C F(z, s) maps |z - y(s)| <= d, component by
!> component, into itself when |C F(y)| + K d <= d, K >= |I - C F'| over the tube (Krawczyk's test): for every s there is then
!> exactly one assembly in the tube, and the matrix is regular, so that no dead point is met and no other assembly reached.
!> F(y(s), s) is its Taylor polynomial of degree 3 with a bound of the fourth derivative; both bounds and the changes of the
!> matrix come from majorants of exp(i phi), roundings from the sizes of what is added. All groups are tested together: one
!> after the other, each granted the tubes of those before it, the tubes of a long chain grow by every matrix. A box is joined
!> to the one before it when the end of that one's tube lies where the assembly of this one is the only one.
!>
!> Around a dead point the way takes the place of one coordinate among the unknowns, and that coordinate goes along.
!> Source: Krawczyk (1969); Neumaier (1990), section 5.1.
module psalm_proof_tube
   use psalm_chain_motion, only: differentiate
   use psalm_closure, only: closure_t, state_t, matrix_of, most_orders, place_points, residuals, solve_group, &
                           local_point, &
                            row_pin, row_angle, row_line, row_gear, row_turn, rank_lost
   use psalm_elementary, only: hypotenuse
   use psalm_dense, only: factors_t, factorise, solve
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: tube_t, in_one_group, enclose, enclose_here, part_of, half_of, joins, prediction_at
   public :: enclose_turn, turning_point, leads_to, steepest
   public :: point_majorant, travel_majorant, rates, size_of, rounding, outwards, degree

   integer, parameter :: degree = 4                       !! of the remainder
   real(wp), parameter :: rounding = 16.0_wp*epsilon(1.0_wp) !! of a sum of few terms of a size, generously
   real(wp), parameter :: outwards = 1.0_wp + 1.0e-10_wp  !! takes up roundings of bounds
   real(wp), parameter :: most_kappa = 0.8_wp
   integer, parameter :: newton_steps = 4                 !! from a place very near
   integer, parameter :: turning_steps = 5                !! towards the dead point
   integer, parameter :: tries = 5                        !! widths of a tube
   real(wp), parameter :: choose(0:4, 0:4) = reshape([real(wp) :: 1, 1, 1, 1, 1, 0, 1, 2, 3, 4, 0, 0, 1, 3, 6, &
                                                      0, 0, 0, 1, 4, 0, 0, 0, 0, 1], [5, 5]) !! binomial coefficients (n, k)

   !> A box of the way and its tube.
   type :: tube_t
      real(wp) :: middle = 0.0_wp, r = 0.0_wp             !! of the way
      type(state_t) :: state                              !! predicted at the middle, with its derivatives by the way
      real(wp), allocatable :: off_t(:), off_phi(:)       !! by link: how far the poses may lie from the prediction
      real(wp), allocatable :: rate_t(:), rate_phi(:)     !! by link: how far their derivatives by the way may lie from its own
      real(wp) :: kappa = 0.0_wp                          !! norm of K
      integer :: pinned = 0                               !! around a dead point: the coordinate that goes along (of its link x, y,
                                                          !! turn times size); the way of the inputs is unknown. 0: elsewhere
      real(wp), allocatable :: direction(:)               !! with `pinned`: rates of the inputs by their way
      real(wp) :: way(0:3) = 0.0_wp                       !! the way and its derivatives by the coordinate
      real(wp) :: off_way = 0.0_wp                        !! how far the way may lie from that
      logical :: holds = .false.
   end type tube_t

contains

   !> Modulus, the same on every processor.
   elemental real(wp) function size_of(z)
      complex(wp), intent(in) :: z

      size_of = hypotenuse(z%re, z%im)
   end function size_of

   ! ---- majorants ---------------------------------------------------------------------------------------------------

   !> Bounds of exp(i phi) and its derivatives over the box, orders 0 to 4.
   pure function majorant_of(tube, link) result(e)
      type(tube_t), intent(in) :: tube
      integer, intent(in) :: link
      real(wp) :: e(0:degree)
      real(wp) :: f(3)

      f = rates(abs(tube%state%phi(link, 1:)), tube%r)
      e = [1.0_wp, f(1), f(1)**2 + f(2), f(1)**3 + 3.0_wp*f(1)*f(2) + f(3), &
           f(1)**4 + 6.0_wp*f(1)**2*f(2) + 3.0_wp*f(2)**2 + 4.0_wp*f(1)*f(3)]
   end function majorant_of

   !> Bounds of the derivatives of a cubic over |s| <= r, from those in the middle.
   pure function rates(d, r) result(f)
      real(wp), intent(in) :: d(3), r
      real(wp) :: f(3)

      f = [d(1) + r*(d(2) + 0.5_wp*r*d(3)), d(2) + r*d(3), d(3)]
   end function rates

   !> How far a cubic goes from its middle.
   pure real(wp) function way_of(d, r)
      real(wp), intent(in) :: d(3), r

      way_of = r*(d(1) + 0.5_wp*r*(d(2) + r*d(3)/3.0_wp))
   end function way_of

   !> Bounds of a joint as a link carries it: derivatives 1 to 4 of its place over the box (0: distance from the link's origin).
   pure function point_majorant(closure, tube, joint, link) result(z)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      integer, intent(in) :: joint, link
      real(wp) :: z(0:degree)
      real(wp) :: e(0:degree), p(0:degree)
      complex(wp) :: local(0:most_orders)
      integer :: k

      e = majorant_of(tube, link)
      local = local_point(closure, tube%state, joint, link)
      p(0) = size_of(local(0)) + way_of(size_of(local(1:)), tube%r)
      p(1:3) = rates(size_of(local(1:)), tube%r)
      p(4) = 0.0_wp
      z(0) = p(0)
      do k = 1, degree
         z(k) = sum(choose(k, :k)*p(:k)*e(k:0:-1))
      end do
      z(1:3) = z(1:3) + rates(size_of(tube%state%t(link, 1:)), tube%r)
   end function point_majorant

   !> Bounds of the displacement along a slide, orders 0 to 4.
   pure function travel_majorant(closure, tube, slide) result(z)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      integer, intent(in) :: slide
      real(wp) :: z(0:degree)
      real(wp) :: a(0:degree), e(0:degree), of_first(3), of_second(3), q
      integer :: k

      associate (first => closure%sketch%slides(slide)%links(1), second => closure%sketch%slides(slide)%links(2), &
                 state => tube%state)
         q = size_of(closure%slide_point(2, slide))
         e = majorant_of(tube, second)
         of_first = rates(size_of(state%t(first, 1:)), tube%r)
         of_second = rates(size_of(state%t(second, 1:)), tube%r)
         a = q*e
         a(0) = q + size_of(state%t(second, 0) - state%t(first, 0)) + way_of(size_of(state%t(first, 1:)), tube%r) &
                + way_of(size_of(state%t(second, 1:)), tube%r)
         a(1:3) = a(1:3) + of_first + of_second
         e = majorant_of(tube, first)
      end associate
      do k = 0, degree
         z(k) = sum(choose(k, :k)*a(:k)*e(k:0:-1))
      end do
      z(0) = z(0) + size_of(closure%slide_point(1, slide))
   end function travel_majorant

   !> Bounds of an equation (of a pin: of its two) and its derivatives over the box; of order 0 the size of what is added.
   pure function row_majorant(closure, tube, k) result(z)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      integer, intent(in) :: k
      real(wp) :: z(0:degree)
      real(wp) :: f(3)

      associate (state => tube%state, row => closure%groups(1)%rows(k), scale => closure%size)
         associate (a => row%links(1), b => row%links(2), n => row%which)
            select case (row%kind)
            case (row_pin)
               z = point_majorant(closure, tube, n, a) + point_majorant(closure, tube, n, b)
               z(0) = z(0) + size_of(state%t(a, 0)) + size_of(state%t(b, 0))
            case (row_angle)
               z = linear([a, b], [1.0_wp, 1.0_wp])
            case (row_turn)
               z = linear([a, b], [1.0_wp, 1.0_wp])
               f = rates(abs(state%input(n, 1:)), tube%r)
               z(0) = z(0) + scale*abs(state%input(n, 0))
               z(1:3) = z(1:3) + scale*f
            case (row_gear)
               associate (gear => closure%sketch%gears(n))
                  z = linear([a, b, gear%carrier], [abs(gear%ratio), 1.0_wp, 1.0_wp + abs(gear%ratio)])
               end associate
            case (row_line)
               z = travel_majorant(closure, tube, n)
               z(0) = z(0) + size_of(state%t(a, 0)) + size_of(state%t(b, 0))
            case default
               z = travel_majorant(closure, tube, closure%sketch%drives(n)%slide)
               z(0) = z(0) + size_of(state%t(a, 0)) + size_of(state%t(b, 0)) + abs(state%input(n, 0))
               z(1:3) = z(1:3) + rates(abs(state%input(n, 1:)), tube%r)
            end select
         end associate
      end associate

   contains

      pure function linear(links, factors) result(sums)
         integer, intent(in) :: links(:)
         real(wp), intent(in) :: factors(:)
         real(wp) :: sums(0:degree)
         integer :: i

         sums = 0.0_wp
         do i = 1, size(links)
            sums(0) = sums(0) + closure%size*factors(i)*abs(tube%state%phi(links(i), 0))
            sums(1:3) = sums(1:3) + closure%size*factors(i)*rates(abs(tube%state%phi(links(i), 1:)), tube%r)
         end do
      end function linear
   end function row_majorant

   ! ---- one box -----------------------------------------------------------------------------------------------------

   !> A closure with all equations in one group.
   pure subroutine in_one_group(closure, whole)
      type(closure_t), intent(in) :: closure
      type(closure_t), intent(out) :: whole
      integer :: g

      whole = closure
      deallocate (whole%groups)
      allocate (whole%groups(1))
      associate (all => whole%groups(1))
         allocate (all%rows(0), all%links(0))
         do g = 1, size(closure%groups)
            all%rows = [all%rows, closure%groups(g)%rows]
            all%links = [all%links, closure%groups(g)%links]
            all%equations = all%equations + closure%groups(g)%equations
         end do
      end associate
   end subroutine in_one_group

   !> Enclose the motion while the way changes by at most `r`, around a state whose rates of input are by the way.
   !>
   !> The state is corrected first; `holds` of the tube tells whether the test does.
   subroutine enclose(closure, state, middle, r, tube)
      type(closure_t), intent(in) :: closure       !! in one group
      type(state_t), intent(in) :: state
      real(wp), intent(in) :: middle, r
      type(tube_t), intent(out) :: tube
      type(factors_t) :: factors
      logical :: closed, dead

      tube%middle = middle
      tube%r = r
      tube%state = state
      allocate (tube%off_t(size(closure%origin)), tube%off_phi(size(closure%origin)), source=0.0_wp)
      call solve_group(closure, 1, tube%state, closed, factors)
      if (.not. closed) return
      call place_points(closure, tube%state, 0)
      call differentiate(closure, most_orders, tube%state, dead)
      if (.not. dead) call test(closure, tube)
   end subroutine enclose

   !> Enclose the motion around a dead point, in the direction of its inputs given: a coordinate goes `r` to either side.
   !>
   !> The middle is moved to where the way is greatest or least.
   subroutine enclose_turn(closure, state, direction, way, pinned, r, tube)
      type(closure_t), intent(in) :: closure       !! in one group
      type(state_t), intent(in) :: state           !! near it
      real(wp), intent(in) :: direction(:)         !! shape (drives)
      real(wp), intent(in) :: way                  !! at the state
      integer, intent(in) :: pinned
      real(wp), intent(in) :: r                    !! length; of a turn radians times size
      type(tube_t), intent(out) :: tube
      real(wp) :: shift
      integer :: round
      logical :: dead

      tube%state = state
      tube%r = r
      tube%pinned = pinned
      tube%direction = direction
      tube%way(0) = way
      allocate (tube%off_t(size(closure%origin)), tube%off_phi(size(closure%origin)), source=0.0_wp)
      do round = 1, turning_steps
         call correct(closure, tube, dead)
         if (dead) return
         if (abs(tube%way(2)) <= 0.0_wp) return
         if (round == turning_steps) exit
         shift = -tube%way(1)/tube%way(2)
         tube%state = prediction_at(tube, shift)
         tube%state%input(:, 0) = tube%state%input(:, 0) + 0.5_wp*shift**2*(tube%state%input(:, 2) &
                                                                           + shift*tube%state%input(:, 3)/3.0_wp)
         tube%way(0) = tube%way(0) + shift*(tube%way(1) + 0.5_wp*shift*(tube%way(2) + shift*tube%way(3)/3.0_wp))
      end do
      call test(closure, tube)
   end subroutine enclose_turn

   !> Newton's method with the pinned coordinate held, then the derivatives by it.
   subroutine correct(closure, tube, dead)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(inout) :: tube
      logical, intent(out) :: dead
      type(factors_t) :: factors
      real(wp) :: step(closure%groups(1)%equations)
      integer :: round, order

      do round = 1, newton_steps
         call factorise(matrix_for(closure, tube), factors)
         dead = factors%reciprocal_condition <= rank_lost
         if (dead) return
         step = solve(factors, -residuals(closure, tube%state, 1, 0))
         call add(step, 0)
      end do
      call factorise(matrix_for(closure, tube), factors)
      tube%state%t(:, 1:) = (0.0_wp, 0.0_wp)
      tube%state%phi(:, 1:) = 0.0_wp
      tube%state%input(:, 1:) = 0.0_wp
      tube%way(1:) = 0.0_wp
      do order = 1, most_orders
         if (order == 1) then
            ! the coordinate itself
            associate (link => closure%groups(1)%links((tube%pinned + 2)/3))
               select case (modulo(tube%pinned, 3))
               case (1)
                  tube%state%t(link, 1) = (1.0_wp, 0.0_wp)
               case (2)
                  tube%state%t(link, 1) = (0.0_wp, 1.0_wp)
               case default
                  tube%state%phi(link, 1) = 1.0_wp/closure%size
               end select
            end associate
         end if
         step = solve(factors, -residuals(closure, tube%state, 1, order))
         call add(step, order)
      end do
      do order = 0, most_orders
         call place_points(closure, tube%state, order)
      end do

   contains

      !> Add a solution to the derivatives of an order; that of the pinned coordinate is the way's.
      subroutine add(step, order)
         real(wp), intent(in) :: step(:)
         integer, intent(in) :: order
         real(wp) :: own(size(step))
         integer :: i

         own = step
         own(tube%pinned) = 0.0_wp
         associate (links => closure%groups(1)%links, state => tube%state)
            do i = 1, size(links)
               state%t(links(i), order) = state%t(links(i), order) + cmplx(own(3*i - 2), own(3*i - 1), wp)
               state%phi(links(i), order) = state%phi(links(i), order) + own(3*i)/closure%size
            end do
            tube%way(order) = tube%way(order) + step(tube%pinned)
            state%input(:, order) = state%input(:, order) + step(tube%pinned)*tube%direction
         end associate
      end subroutine add
   end subroutine correct

   !> True if the motion of a tube turns back in its way, within the tube; `low` and `high` then bracket the greatest way.
   pure subroutine turning_point(tube, turns, low, high)
      type(tube_t), intent(in) :: tube             !! made by `enclose_turn`
      logical, intent(out) :: turns
      real(wp), intent(out) :: low, high
      real(wp) :: bend, ends(2)

      low = 0.0_wp
      high = 0.0_wp
      associate (w => tube%way, r => tube%r)
         ! w <= w0 + w1 s - bend s**2/2
         bend = -w(2) - abs(w(3))*r/3.0_wp
         turns = tube%holds .and. bend > 0.0_wp
         if (.not. turns) return
         low = w(0) - tube%off_way - rounding*abs(w(0))
         high = w(0) + (w(1)**2/(2.0_wp*bend))*outwards + tube%off_way + rounding*abs(w(0))
         ends = w(0) + [-r, r]*w(1) - 0.5_wp*r**2*bend + tube%off_way
         turns = maxval(ends) < low
      end associate
   end subroutine turning_point

   !> True if the end of a tube, at s from its middle, is on the motion of one around a dead point.
   logical function leads_to(closure, one, s, turn)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: one, turn
      real(wp), intent(in) :: s
      type(state_t) :: end_of_one, of_turn
      complex(wp) :: d
      real(wp) :: s_turn, open, distance, f(3)
      real(wp), allocatable :: inverse(:, :), k(:, :)
      integer :: i

      end_of_one = prediction_at(one, s)
      leads_to = .false.
      associate (links => closure%groups(1)%links, link => closure%groups(1)%links((turn%pinned + 2)/3))
         d = end_of_one%t(link, 0) - turn%state%t(link, 0)
         open = one%off_t(link)
         select case (modulo(turn%pinned, 3))
         case (1)
            s_turn = d%re
         case (2)
            s_turn = d%im
         case default
            s_turn = closure%size*(end_of_one%phi(link, 0) - turn%state%phi(link, 0))
            open = closure%size*one%off_phi(link)
         end select
         open = open + rounding*(closure%size + abs(s_turn))
         if (.not. abs(s_turn) + open <= turn%r) return
         of_turn = prediction_at(turn, s_turn)
         f = rates(abs(turn%way(1:)), turn%r)
         distance = abs(one%middle + s - way_at(s_turn)) + f(1)*open + turn%off_way
         do i = 1, size(links)
            d = end_of_one%t(links(i), 0) - of_turn%t(links(i), 0)
            f = rates(size_of(turn%state%t(links(i), 1:)), turn%r)
            distance = max(distance, size_of(d) + one%off_t(links(i)) + f(1)*open + turn%off_t(links(i)))
            f = rates(abs(turn%state%phi(links(i), 1:)), turn%r)
            distance = max(distance, closure%size*(abs(end_of_one%phi(links(i), 0) - of_turn%phi(links(i), 0)) &
                                                   + one%off_phi(links(i)) + f(1)*open + turn%off_phi(links(i))))
         end do
         distance = distance*outwards + rounding*closure%size
         allocate (inverse, source=inverse_of(closure, turn))
         k = contraction(closure, turn, inverse, spread(distance, 1, 3*size(links)))
      end associate
      leads_to = norm_of(k) < 1.0_wp

   contains

      pure real(wp) function way_at(s)
         real(wp), intent(in) :: s

         associate (w => turn%way)
            way_at = w(0) + s*(w(1) + 0.5_wp*s*(w(2) + s*w(3)/3.0_wp))
         end associate
      end function way_at
   end function leads_to

   !> Enclose the assembly at a state, without motion.
   subroutine enclose_here(closure, state, middle, tube)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      real(wp), intent(in) :: middle
      type(tube_t), intent(out) :: tube

      call enclose(closure, state, middle, 0.0_wp, tube)
   end subroutine enclose_here

   !> A part of a box, `r` to either side of a place s from its middle; the assembly is the same as in the whole.
   subroutine part_of(closure, whole, s, r, part)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: whole
      real(wp), intent(in) :: s, r
      type(tube_t), intent(out) :: part
      type(state_t) :: state

      state = prediction_at(whole, s)
      call enclose(closure, state, whole%middle + s, r, part)
      if (part%holds) part%holds = joins(closure, whole, s, part, 0.0_wp)
   end subroutine part_of

   !> One half of a box, before (-1) or after (+1) its middle.
   subroutine half_of(closure, whole, side, half)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: whole
      integer, intent(in) :: side
      type(tube_t), intent(out) :: half

      call part_of(closure, whole, 0.5_wp*whole%r*real(side, wp), 0.5_wp*whole%r, half)
   end subroutine half_of

   !> The prediction of a box at s from its middle.
   pure function prediction_at(tube, s) result(state)
      type(tube_t), intent(in) :: tube
      real(wp), intent(in) :: s
      type(state_t) :: state

      state = tube%state
      associate (m => tube%state)
         state%t(:, 0) = m%t(:, 0) + s*(m%t(:, 1) + 0.5_wp*s*(m%t(:, 2) + s*m%t(:, 3)/3.0_wp))
         state%phi(:, 0) = m%phi(:, 0) + s*(m%phi(:, 1) + 0.5_wp*s*(m%phi(:, 2) + s*m%phi(:, 3)/3.0_wp))
         state%input(:, 0) = m%input(:, 0) + s*m%input(:, 1)
      end associate
   end function prediction_at

   !> True if the assembly of one tube at s from its middle is that of another at s from its own.
   logical function joins(closure, one, s, other, s_other)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: one, other
      real(wp), intent(in) :: s, s_other
      type(state_t) :: end_of_one, end_of_other
      complex(wp) :: d
      real(wp) :: distance, turn
      real(wp), allocatable :: inverse(:, :), k(:, :)
      integer :: i

      end_of_one = prediction_at(one, s)
      end_of_other = prediction_at(other, s_other)
      distance = 0.0_wp
      associate (links => closure%groups(1)%links)
         do i = 1, size(links)
            d = end_of_one%t(links(i), 0) - end_of_other%t(links(i), 0)
            turn = end_of_one%phi(links(i), 0) - end_of_other%phi(links(i), 0)
            ! the neighbourhood must hold both assemblies
            distance = max(distance, size_of(d) + one%off_t(links(i)) + rounding*size_of(end_of_one%t(links(i), 0)), &
                           closure%size*(abs(turn) + one%off_phi(links(i)) + rounding*abs(end_of_one%phi(links(i), 0))), &
                           other%off_t(links(i)), closure%size*other%off_phi(links(i)))
         end do
         distance = distance*outwards
         allocate (inverse, source=inverse_of(closure, other))
         k = contraction(closure, other, inverse, spread(distance, 1, 3*size(links)))
      end associate
      joins = norm_of(k) < 1.0_wp
   end function joins

   !> Krawczyk's test; `holds` becomes true with it.
   subroutine test(closure, tube)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(inout) :: tube
      real(wp), allocatable :: inverse(:, :), bound(:), k(:, :)
      real(wp), allocatable :: defect(:), radii(:), next(:)
      integer :: try, i

      associate (all => closure%groups(1))
         if (all%equations /= 3*size(all%links)) return
         inverse = inverse_of(closure, tube)
         if (size(inverse) == 0) return
         bound = equations_bound(closure, tube, 0)
         defect = bound
         do i = 1, size(bound)
            defect(i) = sum(abs(inverse(i, :))*bound)*outwards
         end do
         if (.not. maxval(defect) < closure%size) return
         radii = 2.0_wp*defect
         do try = 1, tries
            k = contraction(closure, tube, inverse, radii)
            tube%kappa = norm_of(k)
            if (.not. tube%kappa < most_kappa) return
            next = defect
            do i = 1, size(radii)
               next(i) = (defect(i) + sum(k(i, :)*radii))*outwards
            end do
            tube%holds = count(next > radii) == 0
            if (tube%holds) exit
            radii = 1.2_wp*max(next, radii/1.2_wp)
         end do
         if (.not. tube%holds) return
         if (tube%pinned > 0) then
            tube%off_way = radii(tube%pinned)*outwards
            radii(tube%pinned) = 0.0_wp
         end if
         do i = 1, size(all%links)
            tube%off_t(all%links(i)) = hypotenuse(radii(3*i - 2), radii(3*i - 1))*outwards
            tube%off_phi(all%links(i)) = radii(3*i)/closure%size*outwards
         end do
         if (tube%pinned == 0) call bound_rates(closure, inverse, k, tube)
      end associate
   end subroutine test

   !> How far the derivatives by the way may lie from those of the prediction, in a tube that holds.
   !>
   !> With F(z, s) = 0 and the prediction y, M (z' - y') = -(M y' + F_s) at z. At y the right side is a derivative of the equations
   !> along the prediction; from there to z its matrix changes, and F_s where a cylinder turns.
   pure subroutine bound_rates(closure, inverse, k, tube)
      type(closure_t), intent(in) :: closure
      real(wp), intent(in) :: inverse(:, :)     !! shape (equations, equations)
      real(wp), intent(in) :: k(:, :)           !! bounds |I - C F'| over the tube
      type(tube_t), intent(inout) :: tube
      integer, parameter :: rounds = 2          !! of making the bound tighter
      real(wp), dimension(size(inverse, 1)) :: bound, speeds, defect, next, tighter
      real(wp) :: change(size(inverse, 1), size(inverse, 1)), f(3)
      complex(wp) :: p(0:most_orders)
      integer :: i, j, m, round

      allocate (tube%rate_t(size(closure%origin)), tube%rate_phi(size(closure%origin)), source=0.0_wp)
      associate (links => closure%groups(1)%links, rows => closure%groups(1)%rows)
         do i = 1, size(links)
            f = rates(size_of(tube%state%t(links(i), 1:)), tube%r)
            speeds(3*i - 2:3*i - 1) = f(1)
            f = rates(abs(tube%state%phi(links(i), 1:)), tube%r)
            speeds(3*i) = closure%size*f(1)
         end do
         change = matrix_change(closure, tube, tube%off_t, tube%off_phi, 0.0_wp, .true.)
         bound = equations_bound(closure, tube, 1)
         do i = 1, size(bound)
            bound(i) = bound(i) + sum(change(i, :)*speeds)
         end do
         m = 1
         do i = 1, size(rows)
            if (rows(i)%kind == row_pin) then
               do j = 1, 2
                  if (closure%cylinder(rows(i)%links(j)) == 0) cycle
                  p = local_point(closure, tube%state, rows(i)%which, rows(i)%links(j))
                  f = rates(size_of(p(1:)), tube%r)
                  bound(m:m + 1) = bound(m:m + 1) + f(1)*tube%off_phi(rows(i)%links(j))
               end do
               m = m + 1
            end if
            m = m + 1
         end do
         do i = 1, size(bound)
            defect(i) = sum(abs(inverse(i, :))*bound)*outwards
         end do
         next = maxval(defect)/(1.0_wp - tube%kappa)*outwards
         do round = 1, rounds
            do i = 1, size(bound)
               tighter(i) = (defect(i) + sum(k(i, :)*next))*outwards
            end do
            next = min(next, tighter)
         end do
         do i = 1, size(links)
            tube%rate_t(links(i)) = hypotenuse(next(3*i - 2), next(3*i - 1))*outwards
            tube%rate_phi(links(i)) = next(3*i)/closure%size*outwards
         end do
      end associate
   end subroutine bound_rates

   !> Largest row sum.
   pure real(wp) function norm_of(k)
      real(wp), intent(in) :: k(:, :)

      norm_of = huge(1.0_wp)
      if (size(k) > 0) norm_of = maxval(sum(k, dim=2))*outwards
   end function norm_of

   !> The coordinate that moves fastest with the way.
   pure integer function steepest(closure, tube) result(which)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      real(wp) :: rate, most
      integer :: i

      which = 1
      most = -1.0_wp
      associate (links => closure%groups(1)%links, state => tube%state)
         do i = 1, size(links)
            rate = abs(state%t(links(i), 1)%re)
            if (rate > most) which = 3*i - 2
            most = max(most, rate)
            rate = abs(state%t(links(i), 1)%im)
            if (rate > most) which = 3*i - 1
            most = max(most, rate)
            rate = closure%size*abs(state%phi(links(i), 1))
            if (rate > most) which = 3*i
            most = max(most, rate)
         end do
      end associate
   end function steepest

   !> The matrix in the middle of a box; where a coordinate is pinned, its column is that of the way.
   function matrix_for(closure, tube) result(matrix)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      real(wp), allocatable :: matrix(:, :)
      type(state_t) :: held

      matrix = matrix_of(closure, tube%state, 1)
      if (tube%pinned == 0) return
      held = tube%state
      held%t(:, 1:) = (0.0_wp, 0.0_wp)
      held%phi(:, 1:) = 0.0_wp
      held%input(:, 1:) = 0.0_wp
      held%input(:, 1) = tube%direction
      matrix(:, tube%pinned) = residuals(closure, held, 1, 1)
   end function matrix_for

   !> Inverse of the matrix in the middle of a box; of size 0 if there is none.
   function inverse_of(closure, tube) result(inverse)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      real(wp), allocatable :: inverse(:, :)
      type(factors_t) :: factors
      real(wp), allocatable :: unit(:)
      integer :: n, i

      n = closure%groups(1)%equations
      call factorise(matrix_for(closure, tube), factors)
      if (factors%reciprocal_condition <= rank_lost**2) then
         allocate (inverse(0, 0))
         return
      end if
      allocate (inverse(n, n), unit(n))
      do i = 1, n
         unit = 0.0_wp
         unit(i) = 1.0_wp
         inverse(:, i) = solve(factors, unit)
      end do
   end function inverse_of

   !> Bounds of the equations along the prediction, or of their first derivative by the way.
   pure function equations_bound(closure, tube, first) result(bound)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      integer, intent(in) :: first              !! 0, or 1: of the derivative
      real(wp) :: bound(closure%groups(1)%equations)
      real(wp) :: derivative(size(bound), 0:3), z(0:degree), angles, power
      integer :: k, m, order, count

      do order = first, 3
         derivative(:, order) = abs(residuals(closure, tube%state, 1, order))
      end do
      m = 1
      associate (rows => closure%groups(1)%rows)
         do k = 1, size(rows)
            z = row_majorant(closure, tube, k)
            angles = 1.0_wp + maxval(abs(tube%state%phi(rows(k)%links, 0)))
            count = merge(2, 1, rows(k)%kind == row_pin)
            power = 1.0_wp
            bound(m:m + count - 1) = 0.0_wp
            do order = first, 3
               bound(m:m + count - 1) = bound(m:m + count - 1) + (derivative(m:m + count - 1, order) &
                                                                  + rounding*angles*z(order))*power
               power = power*tube%r/real(order - first + 1, wp)
            end do
            bound(m:m + count - 1) = bound(m:m + count - 1) + z(4)*power
            m = m + count
         end do
      end associate
   end function equations_bound

   !> Bounds of the entries of I - C F' over the tube of the given half widths; of size 0 without C.
   function contraction(closure, tube, inverse, radii) result(bound)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      real(wp), intent(in) :: inverse(:, :)     !! shape (equations, equations)
      real(wp), intent(in) :: radii(:)          !! shape (equations)
      real(wp), allocatable :: bound(:, :)
      real(wp), allocatable :: matrix(:, :), change(:, :)
      real(wp) :: away_t(size(closure%origin)), away_phi(size(closure%origin)), own(size(radii)), angles, of_way
      integer :: n, i, j

      if (size(inverse) == 0) then
         allocate (bound(0, 0))
         return
      end if
      away_t = 0.0_wp
      away_phi = 0.0_wp
      own = radii
      of_way = 0.0_wp
      if (tube%pinned > 0) then
         of_way = radii(tube%pinned)
         own(tube%pinned) = 0.0_wp
      end if
      associate (links => closure%groups(1)%links, state => tube%state)
         do i = 1, size(links)
            away_t(links(i)) = way_of(size_of(state%t(links(i), 1:)), tube%r) + hypotenuse(own(3*i - 2), own(3*i - 1))
            away_phi(links(i)) = way_of(abs(state%phi(links(i), 1:)), tube%r) + own(3*i)/closure%size
         end do
      end associate
      matrix = matrix_for(closure, tube)
      n = size(matrix, 1)
      angles = 1.0_wp + maxval(abs(tube%state%phi(:, 0)))
      change = matrix_change(closure, tube, away_t, away_phi, of_way, .false.) + rounding*(angles + real(n, wp))*abs(matrix)
      allocate (bound(n, n))
      do j = 1, n
         do i = 1, n
            bound(i, j) = abs(sum(inverse(i, :)*matrix(:, j)) - merge(1.0_wp, 0.0_wp, i == j)) &
                          + sum(abs(inverse(i, :))*change(:, j))
         end do
      end do
   end function contraction

   !> How much the entries of the matrix change, when poses are `away` from the middle of the box, or, with the way the same, from
   !> the prediction.
   pure function matrix_change(closure, tube, away_t, away_phi, of_way, same_way) result(change)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      real(wp), intent(in) :: away_t(:), away_phi(:) !! shape (links)
      real(wp), intent(in) :: of_way                 !! by this much the way, where it is unknown, may lie elsewhere
      logical, intent(in) :: same_way                !! cylinders are as long as they are in the prediction
      real(wp) :: change(closure%groups(1)%equations, 3*size(closure%groups(1)%links))
      real(wp) :: z(0:degree), q
      integer :: k, m, slide

      change = 0.0_wp
      m = 1
      associate (rows => closure%groups(1)%rows, scale => closure%size)
         do k = 1, size(rows)
            associate (a => rows(k)%links(1), b => rows(k)%links(2), n => rows(k)%which)
               select case (rows(k)%kind)
               case (row_pin)
                  call add_pin(a, change)
                  call add_pin(b, change)
                  m = m + 1
               case (row_angle, row_turn, row_gear)
                  ! these entries are constant
               case default
                  slide = n
                  if (rows(k)%kind /= row_line) slide = closure%sketch%drives(n)%slide
                  associate (first => closure%sketch%slides(slide)%links(1), second => closure%sketch%slides(slide)%links(2))
                     z = travel_majorant(closure, tube, slide)
                     q = size_of(closure%slide_point(2, slide))
                     call add(second, away_phi(first), q*(away_phi(first) + away_phi(second))/scale, change)
                     call add(first, away_phi(first), (z(0)*away_phi(first) + away_t(first) + away_t(second) &
                                                       + q*away_phi(second))/scale, change)
                  end associate
               end select
            end associate
            m = m + 1
         end do
      end associate

   contains

      pure subroutine add_pin(link, change)
         integer, intent(in) :: link
         real(wp), intent(inout) :: change(:, :)
         complex(wp) :: p(0:most_orders)
         real(wp) :: by_turn, longer
         integer :: c

         c = 3*findloc(closure%groups(1)%links, link, dim=1)
         if (c == 0) return
         p = local_point(closure, tube%state, closure%groups(1)%rows(k)%which, link)
         longer = way_of(size_of(p(1:)), tube%r)
         if (tube%pinned > 0 .and. closure%cylinder(link) > 0) then
            associate (rate => abs(tube%direction(closure%cylinder(link))))
               longer = longer + rate*of_way
               change(m:m + 1, tube%pinned) = change(m:m + 1, tube%pinned) + rate*away_phi(link)
            end associate
         end if
         by_turn = ((size_of(p(0)) + longer)*away_phi(link) + merge(0.0_wp, longer, same_way))/closure%size
         if (c /= tube%pinned) change(m:m + 1, c) = change(m:m + 1, c) + by_turn
      end subroutine add_pin

      pure subroutine add(link, by_place, by_turn, change)
         integer, intent(in) :: link
         real(wp), intent(in) :: by_place, by_turn
         real(wp), intent(inout) :: change(:, :)
         integer :: c

         c = 3*findloc(closure%groups(1)%links, link, dim=1)
         if (c == 0) return
         ! the column of the pinned coordinate is that of the way, which is constant here
         if (c - 2 /= tube%pinned) change(m, c - 2) = change(m, c - 2) + by_place
         if (c - 1 /= tube%pinned) change(m, c - 1) = change(m, c - 1) + by_place
         if (c /= tube%pinned) change(m, c) = change(m, c) + by_turn
      end subroutine add
   end function matrix_change
end module psalm_proof_tube
