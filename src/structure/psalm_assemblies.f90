!> All assemblies of a sketch at given inputs: every way in which its links can be put together.
!>
!> Groups are taken in the order of their solution, each with every assembly of those before it. In a group a link stands at t and
!> is turned by z = exp(i phi). Joints and driven slides are linear in t and z, and with t and z conjugated they are linear
!> in their conjugates, taken for unknowns of their own; what remains is bilinear: z w = 1 for every direction, and that nothing
!> moves across a slide. The roots of these equations whose conjugates are conjugates are the assemblies; Newton's method
!> gives them their last digits. Source: Wampler (1996), isotropic coordinates; Oldham (1977), 15.1, for what is wanted.
module psalm_assemblies
   use psalm_angles, only: degrees_of
   use psalm_bilinear, only: bilinear_roots_t, find_bilinear_roots, null_space
   use psalm_closure, only: closure_t, state_t, solve_group, place_points, local_point, turned, most_orders, rank_lost, &
                            row_angle, row_gear, row_line, row_pin, row_travel, row_turn
   use psalm_dense, only: factors_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_linear, only: product_of
   use psalm_sketch, only: frame_link
   use psalm_stop, only: stop_t, is_to_end
   implicit none (type, external)
   private
   public :: assemblies_t, group_assemblies_t, find_assemblies, find_group_assemblies

   real(wp), parameter :: real_root = 1.0e-6_wp     !! conjugates differ by less: the root is real
   real(wp), parameter :: at_infinity = 1.0e-8_wp   !! last coordinate of a root that is not finite
   real(wp), parameter :: one_assembly = 1.0e-7_wp  !! of the drawing's size: poses nearer to each other are one
   integer, parameter :: most_loops = 6             !! of a group: C(12, 6) = 924 paths

   !> The assemblies of one group, all else where it is.
   type :: group_assemblies_t
      type(state_t), allocatable :: states(:)
      logical, allocatable :: dead(:)                !! it stands at a dead point, where two assemblies meet
      logical :: known = .false.                     !! the group's equations are bilinear
      logical :: complete = .false.                  !! no root can be missing
      integer :: finite = 0                          !! finite roots, complex ones too
   end type group_assemblies_t

   !> The assemblies of a sketch.
   type :: assemblies_t
      type(state_t), allocatable :: states(:)        !! the drawing's first
      logical, allocatable :: dead(:)
      integer, allocatable :: per_group(:)           !! shape (groups): real assemblies, all else as it is drawn
      logical :: complete = .true.                   !! none can be missing
      logical :: more = .false.                      !! there are more than were asked for
      logical :: stopped = .false.                   !! the host asked for the end: those so far
      integer :: unknown = 0                         !! a group that has equations of another kind; 0: none
   end type assemblies_t

contains

   !> All assemblies with the inputs of `drawn`, at most `most` of them.
   subroutine find_assemblies(closure, drawn, most, found, stop)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: drawn
      integer, intent(in) :: most
      type(assemblies_t), intent(out) :: found
      type(stop_t), intent(in), optional :: stop     !! asked before each path of a group: the assemblies so far are there

      allocate (found%states(0), found%dead(0), found%per_group(size(closure%groups)))
      found%per_group = 0
      call extend(1, drawn, .false., .true.)

   contains

      recursive subroutine extend(group, state, dead, as_drawn)
         integer, intent(in) :: group
         type(state_t), intent(in) :: state
         logical, intent(in) :: dead, as_drawn
         type(group_assemblies_t) :: here
         type(state_t) :: last
         integer :: k

         if (group > size(closure%groups)) then
            if (size(found%states) >= most) then
               found%more = .true.
               return
            end if
            last = state
            call place_points(closure, last, 0)
            found%states = [found%states, last]
            found%dead = [found%dead, dead]
            return
         end if
         if (found%more) return
         found%stopped = found%stopped .or. is_to_end(stop)
         if (found%stopped) return
         call find_group_assemblies(closure, group, state, here, stop)
         found%stopped = found%stopped .or. is_to_end(stop)
         if (.not. here%known) found%unknown = group
         found%complete = found%complete .and. here%complete
         if (as_drawn) found%per_group(group) = size(here%states)
         do k = 1, size(here%states)
            call extend(group + 1, here%states(k), dead .or. here%dead(k), as_drawn .and. k == 1)
         end do
      end subroutine extend
   end subroutine find_assemblies

   !> All assemblies of one group; the one nearest to where it stands in `state` comes first, the others as they are found.
   subroutine find_group_assemblies(closure, group, state, found, stop)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: group
      type(state_t), intent(in) :: state
      type(group_assemblies_t), intent(out) :: found
      type(stop_t), intent(in), optional :: stop     !! asked before each path; the assembly of `state` is there in any case
      complex(wp), allocatable :: forms(:, :, :), places(:, :), turns(:, :)
      type(bilinear_roots_t) :: roots
      type(state_t) :: nearest
      integer :: k, n, best
      real(wp) :: least, distance

      allocate (found%states(0), found%dead(0))
      if (size(closure%groups(group)%links) == 0) then
         found%states = [state]
         found%dead = [.false.]
         found%known = .true.
         found%complete = .true.
         return
      end if
      call make_forms(closure, group, state, forms, places, turns, found%known)
      if (.not. found%known) then
         ! what stands there is the one that is known
         call keep(state)
         return
      end if
      n = size(forms, 3)/2
      if (n == 0) then
         call take([(1.0_wp, 0.0_wp)], [(1.0_wp, 0.0_wp)])
         found%complete = .true.
      else
         call find_bilinear_roots(forms, roots, stop)
         found%complete = roots%complete
         do k = 1, size(roots%simple)
            call take(roots%x(:, k), roots%y(:, k))
         end do
         ! its path may not have been followed yet
         if (is_to_end(stop)) call keep(state)
      end if
      best = 0
      least = huge(least)
      do k = 1, size(found%states)
         distance = separation(found%states(k), state)
         if (distance >= least) cycle
         least = distance
         best = k
      end do
      if (best <= 1) return
      nearest = found%states(best)
      found%states = [nearest, found%states(:best - 1), found%states(best + 1:)]
      found%dead = [found%dead(best), found%dead(:best - 1), found%dead(best + 1:)]

   contains

      !> Take a root if it is finite and real.
      subroutine take(x, y)
         complex(wp), intent(in) :: x(:), y(:)
         complex(wp) :: t(size(places, 1)), z(size(turns, 1)), w(size(turns, 1)), one, other
         type(state_t) :: new
         integer :: l

         associate (links => closure%groups(group)%links, m => size(places, 1))
            ! the last form is that of the number 1
            one = sum(turns(size(turns, 1), :)*x)
            other = sum(conjg(turns(size(turns, 1), :))*y)
            if (abs(one) < at_infinity .or. abs(other) < at_infinity) return
            found%finite = found%finite + 1
            do l = 1, m
               t(l) = sum(places(l, :)*x)/one
               z(l) = sum(turns(l, :)*x)/one
               w(l) = sum(conjg(turns(l, :))*y)/other
            end do
            if (any(abs(conjg(z(:m)) - w(:m)) > real_root) .or. any(abs(abs(z(:m)) - 1.0_wp) > real_root)) return
            new = state
            do l = 1, m
               new%t(links(l), 0) = t(l)*closure%size
               new%phi(links(l), 0) = state%phi(links(l), 0) + angle_between(turned(state%phi(links(l), 0)), z(l))
            end do
            call settle_turns(closure, group, new)
            call keep(new)
         end associate
      end subroutine take

      !> Give an assembly its last digits and list it, unless it is there.
      subroutine keep(given)
         type(state_t), intent(in) :: given
         type(state_t) :: new
         type(factors_t) :: factors
         logical :: closed
         integer :: l

         new = given
         call solve_group(closure, group, new, closed, factors)
         if (.not. closed) return
         if (separation(new, given) > sqrt(one_assembly)) return
         do l = 1, size(found%states)
            if (separation(new, found%states(l)) < one_assembly) return
         end do
         found%states = [found%states, new]
         found%dead = [found%dead, factors%reciprocal_condition < rank_lost]
      end subroutine keep

      !> Largest difference of the group's poses, of the drawing's size.
      pure real(wp) function separation(a, b)
         type(state_t), intent(in) :: a, b
         integer :: l

         separation = 0.0_wp
         associate (links => closure%groups(group)%links)
            do l = 1, size(links)
               separation = max(separation, abs(a%t(links(l), 0) - b%t(links(l), 0))/closure%size, &
                                abs(turned(a%phi(links(l), 0)) - turned(b%phi(links(l), 0))))
            end do
         end associate
      end function separation
   end subroutine find_group_assemblies

   !> Angle from one direction to another, radians in -pi to pi.
   pure real(wp) function angle_between(from, to)
      complex(wp), intent(in) :: from, to
      complex(wp) :: ratio

      ratio = conjg(from)*to
      angle_between = degrees_of(ratio%re, ratio%im)*radians_per_degree
   end function angle_between

   !> Links whose directions a slide or a drive ties differ by just that angle, not by full turns too.
   subroutine settle_turns(closure, group, state)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: group
      type(state_t), intent(inout) :: state
      logical :: settled(size(closure%origin))
      integer :: r, round
      real(wp) :: offset

      associate (links => closure%groups(group)%links, rows => closure%groups(group)%rows)
         settled = .true.
         settled(links) = .false.
         do round = 1, size(links) + 1
            do r = 1, size(rows)
               if (rows(r)%kind /= row_angle .and. rows(r)%kind /= row_turn) cycle
               offset = 0.0_wp
               if (rows(r)%kind == row_turn) offset = state%input(rows(r)%which, 0)
               associate (a => rows(r)%links(1), b => rows(r)%links(2))
                  if (settled(a) .and. .not. settled(b)) then
                     state%phi(b, 0) = state%phi(a, 0) + offset
                     settled(b) = .true.
                  else if (settled(b) .and. .not. settled(a)) then
                     state%phi(a, 0) = state%phi(b, 0) - offset
                     settled(a) = .true.
                  end if
               end associate
            end do
            ! a set of links that are tied to each other only begins with one of them
            if (all(settled)) exit
            if (round > 1) settled(links(findloc(settled(links), .false., dim=1))) = .true.
         end do
      end associate
   end subroutine settle_turns

   !> The bilinear equations of a group, and its places and directions as forms of their unknowns.
   !>
   !> `places` and `turns` have a row for each link of the group; `turns` a last one for the number 1. Lengths are in the
   !> drawing's size. `known` is false for gears and where special lengths make equations depend on each other.
   subroutine make_forms(closure, group, state, forms, places, turns, known)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: group
      type(state_t), intent(in) :: state
      complex(wp), allocatable, intent(out) :: forms(:, :, :) !! shape (n+1, n+1, 2n)
      complex(wp), allocatable, intent(out) :: places(:, :), turns(:, :) !! shape (links, n+1), (links + 1, n+1)
      logical, intent(out) :: known
      complex(wp), allocatable :: linear(:, :), space(:, :), d(:), z(:)
      complex(wp) :: factor(size(closure%origin)), along
      integer :: family(size(closure%origin)), column(size(closure%origin))
      integer :: r, k, m, last, equations, unknowns, slide, fixed
      logical :: valid

      associate (links => closure%groups(group)%links, rows => closure%groups(group)%rows)
         known = all(rows%kind /= row_gear)
         if (.not. known) return
         call find_classes()
         ! unknowns: places of links, one direction for each class that is not known, 1
         column = 0
         m = size(links)
         fixed = family(frame_link)
         do k = 1, size(links)
            if (family(links(k)) == fixed) cycle
            if (any(family(links(:k - 1)) == family(links(k)))) cycle
            m = m + 1
            where (family == family(links(k))) column = m
         end do
         last = m + 1
         allocate (linear(0, last))
         do r = 1, size(rows)
            select case (rows(r)%kind)
            case (row_pin)
               d = point(rows(r)%links(2), rows(r)%which) - point(rows(r)%links(1), rows(r)%which)
               call add_linear(d)
            case (row_travel)
               slide = closure%sketch%drives(rows(r)%which)%slide
               along = state%input(rows(r)%which, 0)*closure%line(slide)/closure%size
               if (closure%sketch%slides(slide)%links(1) /= rows(r)%links(1)) along = -along
               d = displacement(slide) - along*direction(closure%sketch%slides(slide)%links(1))
               call add_linear(d)
            end select
         end do
         call null_space(linear, space, valid)
         unknowns = size(space, 2) - 1
         equations = m - size(links) + count([(rows(r)%kind == row_line .and. .not. is_driven(r), r=1, size(rows))])
         known = valid .and. equations == 2*unknowns .and. unknowns <= most_loops
         if (.not. known) return
         allocate (places(size(links), unknowns + 1), turns(size(links) + 1, unknowns + 1))
         do k = 1, size(links)
            places(k, :) = space(k, :)
            z = direction(links(k))
            turns(k, :) = product_of(transpose(space), z)
         end do
         turns(size(links) + 1, :) = space(last, :)
         allocate (forms(unknowns + 1, unknowns + 1, 2*unknowns))
         equations = 0
         do k = size(links) + 1, m
            equations = equations + 1
            forms(:, :, equations) = outer(space(k, :), conjg(space(k, :))) - outer(space(last, :), conjg(space(last, :)))
         end do
         do r = 1, size(rows)
            if (rows(r)%kind /= row_line .or. is_driven(r)) cycle
            equations = equations + 1
            slide = rows(r)%which
            d = product_of(transpose(space), displacement(slide))
            z = product_of(transpose(space), direction(closure%sketch%slides(slide)%links(1)))*closure%line(slide)
            forms(:, :, equations) = outer(d, conjg(z)) - outer(z, conjg(d))
         end do
      end associate

   contains

      pure function outer(a, b) result(product)
         complex(wp), intent(in) :: a(:), b(:)
         complex(wp) :: product(size(a), size(b))
         integer :: c

         do c = 1, size(b)
            product(:, c) = a*b(c)
         end do
      end function outer

      !> Links that have one direction but for a known angle: z = factor * direction of the class.
      subroutine find_classes()
         integer :: a, b, q, old
         complex(wp) :: ratio, turn

         family = [(q, q=1, size(family))]
         factor = (1.0_wp, 0.0_wp)
         do q = 1, size(family)
            if (any(closure%groups(group)%links == q)) cycle
            family(q) = family(frame_link)
            factor(q) = turned(state%phi(q, 0))
         end do
         associate (rows => closure%groups(group)%rows)
            do q = 1, size(rows)
               if (rows(q)%kind /= row_angle .and. rows(q)%kind /= row_turn) cycle
               a = rows(q)%links(1)
               b = rows(q)%links(2)
               if (family(a) == family(b)) cycle
               turn = (1.0_wp, 0.0_wp)
               if (rows(q)%kind == row_turn) turn = turned(state%input(rows(q)%which, 0))
               ! z_b = turn z_a; the class of links that are placed stays
               if (family(b) == family(frame_link)) then
                  old = family(a)
                  ratio = factor(b)/turn/factor(a)
                  where (family == old) factor = factor*ratio
                  where (family == old) family = family(b)
               else
                  old = family(b)
                  ratio = factor(a)*turn/factor(b)
                  where (family == old) factor = factor*ratio
                  where (family == old) family = family(a)
               end if
            end do
         end associate
      end subroutine find_classes

      subroutine add_linear(row)
         complex(wp), intent(in) :: row(:)
         complex(wp), allocatable :: more(:, :)

         allocate (more(size(linear, 1) + 1, last))
         more(:size(linear, 1), :) = linear
         more(size(more, 1), :) = row
         call move_alloc(more, linear)
      end subroutine add_linear

      !> z of a link as a form of the unknowns.
      function direction(link) result(form)
         integer, intent(in) :: link
         complex(wp), allocatable :: form(:)

         allocate (form(last), source=(0.0_wp, 0.0_wp))
         if (family(link) == fixed) then
            form(last) = factor(link)
         else
            form(column(link)) = factor(link)
         end if
      end function direction

      !> Place of a link's origin.
      function origin(link) result(form)
         integer, intent(in) :: link
         complex(wp), allocatable :: form(:)
         integer :: q

         allocate (form(last), source=(0.0_wp, 0.0_wp))
         q = findloc(closure%groups(group)%links, link, dim=1)
         if (q > 0) then
            form(q) = (1.0_wp, 0.0_wp)
         else
            form(last) = state%t(link, 0)/closure%size
         end if
      end function origin

      !> Place of a joint of a link.
      function point(link, joint) result(form)
         integer, intent(in) :: link, joint
         complex(wp), allocatable :: form(:)
         complex(wp) :: p(0:most_orders)

         p = local_point(closure, state, joint, link)
         form = origin(link) + direction(link)*(p(0)/closure%size)
      end function point

      !> From the point of a slide's line in its first link to that in its second.
      function displacement(slide) result(form)
         integer, intent(in) :: slide
         complex(wp), allocatable :: form(:)

         associate (a => closure%sketch%slides(slide)%links(1), b => closure%sketch%slides(slide)%links(2))
            form = origin(b) + direction(b)*(closure%slide_point(2, slide)/closure%size) &
                   - origin(a) - direction(a)*(closure%slide_point(1, slide)/closure%size)
         end associate
      end function displacement

      !> The slide of a row is driven in this group: a linear equation tells all of its displacement.
      logical function is_driven(row)
         integer, intent(in) :: row
         integer :: q

         is_driven = .false.
         associate (rows => closure%groups(group)%rows)
            do q = 1, size(rows)
               if (rows(q)%kind /= row_travel) cycle
               if (closure%sketch%drives(rows(q)%which)%slide == rows(row)%which) is_driven = .true.
            end do
         end associate
      end function is_driven
   end subroutine make_forms
end module psalm_assemblies
