!> Equilibrium positions of a mechanism with free drives, and small oscillations about them.
!>
!> Q(q) = 0 by virtual work, at rest. With one freedom the way of its drive is gone along, and every change of the sign of Q is
!> refined. With several Newton's method starts from the drawing and from points spread over the ranges of the drives, once towards
!> lower potential (K + mu H) and once without that, which leads to saddles too. Small motion: H u'' + C u' + K u = 0 with
!> K = -dQ/dq and C = -dQ/dq' by differences of order 8 and 2; at rest the second have no error, for Q has no term of third order
!> in q'.
module psalm_equilibria
   use psalm_free_motion, only: free_motion_t, free_state_t
   use psalm_joint_stops, only: side_low, side_high
   use psalm_kinds, only: wp, pi
   use psalm_lapack, only: general_eigenvalues, natural_modes, solve_general
   use psalm_linear, only: solve_positive
   use psalm_root, only: root_search_t, begin_search
   use psalm_sort, only: ascending
   implicit none (type, external)
   private
   public :: equilibria_t, find_equilibria

   integer, parameter :: steps_of_turn = 720         !! in which a turn is gone along
   integer, parameter :: most_halvings = 30          !! of the last step, to where the way ends
   integer, parameter :: most_iterations = 80        !! of Newton's method
   integer, parameter :: most_raises = 60            !! of mu, until K + mu H is positive definite
   real(wp), parameter :: longest_move = 0.3_wp      !! of it: radians, or parts of the size
   real(wp), parameter :: found_at = 1.0e-13_wp      !! radians, or parts of the size: it has converged
   real(wp), parameter :: same_place = 1.0e-7_wp     !! so near two are one
   real(wp), parameter :: same_everywhere = 1.0e-11_wp !! part of the potential energy: forces on drives that count as none
   real(wp), parameter :: no_stiffness = 1.0e-9_wp   !! part of the largest square: less is rounding of the differences
   real(wp), parameter :: same_turn = 1.0e-9_wp      !! part of the largest force: after a turn all is as it was
   real(wp), parameter :: near = 5.0e-3_wp           !! steps of differences: radians, or parts of the size
   real(wp), parameter :: eighth(4) = [4.0_wp/5.0_wp, -1.0_wp/5.0_wp, 4.0_wp/105.0_wp, -1.0_wp/280.0_wp] !! of order 8
   real(wp), parameter :: plastic(6) = [0.618033988749894848_wp, 0.754877666246692760_wp, 0.819172513396164440_wp, &
                                       0.856674883854502874_wp, 0.881271461633569594_wp, 0.898653712628699293_wp]
                                                     !! by drives: root g of g**(-d - 1) = 1 + 1/g; powers spread starts

   !> Where a mechanism stays at rest.
   type :: equilibrium_t
      real(wp), allocatable :: q(:)                  !! shape (free drives): radians or user's lengths
      real(wp) :: potential = 0.0_wp                 !! J
      integer :: held_by = 0                         !! the stop that holds it, 0: none
      real(wp), allocatable :: squares(:)            !! shape (free drives): of the undamped angular frequencies, ascending
      real(wp), allocatable :: shapes(:, :)          !! shape (free drives, modes): rates of the drives, the largest 1
      complex(wp), allocatable :: roots(:)           !! shape (2 free drives): of damped motion, exp(root time)
   contains
      procedure :: stable
      procedure :: neutral
   end type equilibrium_t

   type :: equilibria_t
      type(equilibrium_t), allocatable :: list(:)    !! by their inputs, or as they were found
      logical :: everywhere = .false.                !! no force acts on the free drives wherever they are
      logical :: whole_turn = .false.                !! of one freedom: the drive goes round a turn
   end type equilibria_t

contains

   !> It returns after a small push: all squares are positive, or a stop holds it.
   pure logical function stable(self)
      class(equilibrium_t), intent(in) :: self

      stable = self%held_by > 0
      if (.not. stable) stable = all(self%squares > 0.0_wp)
   end function stable

   !> It does not return, and does not go away: its potential is level to second order. Others may lie beside it.
   pure logical function neutral(self)
      class(equilibrium_t), intent(in) :: self

      neutral = self%held_by == 0 .and. .not. self%stable() .and. all(self%squares >= 0.0_wp)
   end function neutral

   !> All that are found; none where nothing moves at the drawing (`begin_motion` says why).
   subroutine find_equilibria(motion, sizes, starts, found)
      class(free_motion_t), intent(inout) :: motion
      real(wp), intent(in) :: sizes(:)               !! shape (free drives): a radian, or the size of the linkage
      integer, intent(in) :: starts                  !! besides the drawing
      type(equilibria_t), intent(out) :: found

      allocate (found%list(0))
      if (size(sizes) == 1) then
         call go_along(motion, sizes(1), found)
      else if (size(sizes) > 1) then
         call start_everywhere(motion, sizes, starts, found)
      end if
   end subroutine find_equilibria

   !> Forces on the free drives at rest; `there` is false where the linkage does not close.
   subroutine force_at(motion, q, force, there, v)
      class(free_motion_t), intent(inout) :: motion
      real(wp), intent(in) :: q(:)
      real(wp), intent(out) :: force(:)
      logical, intent(out) :: there
      real(wp), intent(in), optional :: v(:)         !! rates of the free drives; default: 0
      real(wp) :: a(size(q)), rate(size(q)), unused, nor_this

      rate = 0.0_wp
      if (present(v)) rate = v
      call motion%accelerate(0.0_wp, q, rate, a, unused, nor_this, there)
      force = motion%acting
   end subroutine force_at

   !> One freedom: along the way of the drive, forwards round a turn, or as far as it goes, and backwards.
   subroutine go_along(motion, unit, found)
      class(free_motion_t), intent(inout) :: motion
      real(wp), intent(in) :: unit
      type(equilibria_t), intent(inout) :: found
      type(free_motion_t), allocatable :: one
      real(wp) :: largest, energy, force(1)
      logical :: there
      integer :: way

      call force_at(motion, [motion%start(motion%free(1))], force, there)
      if (.not. there) return
      largest = 0.0_wp
      energy = 0.0_wp
      do way = 1, -1, -2
         allocate (one, source=motion)
         call follow(one, unit, real(way, wp), found, largest, energy)
         deallocate (one)
         ! backwards there may be a stop before a turn is done
         if (found%whole_turn .and. size(motion%stops) == 0) exit
      end do
      found%everywhere = largest <= same_everywhere*energy
      if (found%everywhere) found%list = [equilibrium_t ::]
      found%list = found%list(ascending([(found%list(way)%q(1), way=1, size(found%list))]))
   end subroutine go_along

   !> One way from the drawing.
   subroutine follow(one, unit, way, found, largest, energy)
      type(free_motion_t), intent(inout) :: one
      real(wp), intent(in) :: unit, way              !! way: 1 or -1
      type(equilibria_t), intent(inout) :: found
      real(wp), intent(inout) :: largest, energy     !! force on the drive, and potential energy, so far
      real(wp) :: q(1), before(1), force(1), force_before(1), force_first(1), step, whole, start
      integer :: k, halved, met
      logical :: there, pressed, closed

      start = one%start(one%free(1))
      whole = 2.0_wp*pi*unit
      step = way*whole/real(steps_of_turn, wp)
      q = start
      call look()
      force_first = force
      ! on the way round a turn it is found at the end
      if (way < 0.0_wp .and. .not. abs(force(1)) > 0.0_wp) call keep_once(q(1))
      call one%anchor()
      halved = 0
      do k = 1, steps_of_turn + most_halvings
         before = q
         force_before = force
         q = before + step
         if (halved == 0) q = start + real(k, wp)*step
         call force_at(one, q, force, there)
         if (.not. there) then
            ! nearer to where the way ends
            halved = halved + 1
            if (halved > most_halvings) exit
            step = 0.5_wp*step
            q = before
            force = force_before
            cycle
         end if
         call come_to_stop(one, unit, before(1), q(1), met, pressed)
         call look()
         closed = halved == 0 .and. k == steps_of_turn .and. met == 0 .and. .not. one%slides(one%free(1))
         if (closed) closed = abs(force(1) - force_first(1)) <= same_turn*largest
         found%whole_turn = found%whole_turn .or. closed
         ! the same rounding at both ends of a turn, so that what lies there is found once
         if (closed) force = force_first
         if (force_before(1)*force(1) < 0.0_wp .or. (abs(force_before(1)) > 0.0_wp .and. .not. abs(force(1)) > 0.0_wp)) &
            call refine(before(1), force_before(1), q(1), force(1))
         if (pressed) call keep(one, q, [unit], met, found)
         if (met > 0 .or. (halved == 0 .and. k == steps_of_turn)) exit
         call force_at(one, q, force, there)
         call one%anchor()
      end do

   contains

      !> Force on the drive at q, and the largest so far.
      subroutine look()
         type(free_state_t) :: state

         call force_at(one, q, force, there)
         call one%describe(0.0_wp, q, 0.0_wp*q, 0.0_wp*q, state)
         energy = max(energy, abs(state%potential))
         largest = max(largest, abs(force(1)))
      end subroutine look

      !> Where the force on the drive is 0.
      subroutine refine(first, value_first, second, value_second)
         real(wp), intent(in) :: first, value_first, second, value_second
         type(root_search_t) :: search
         real(wp) :: x, value(1)
         logical :: closes

         search = begin_search(first, value_first, second, value_second, epsilon(1.0_wp)*unit)
         do while (.not. search%done())
            x = search%next()
            call force_at(one, [x], value, closes)
            if (.not. closes) return
            call search%put(x, value(1))
         end do
         call keep_once(search%root())
      end subroutine refine

      !> Backwards, what the whole turn forwards has seen is no other.
      subroutine keep_once(place)
         real(wp), intent(in) :: place
         integer :: i

         if (found%whole_turn .and. way < 0.0_wp) then
            do i = 1, size(found%list)
               if (abs(modulo(place - found%list(i)%q(1) + pi, 2.0_wp*pi) - pi) <= same_place) return
            end do
         end if
         call keep(one, [place], [unit], 0, found)
      end subroutine keep_once
   end subroutine follow

   !> The first stop on the way from `first` to q, where the linkage is: q is put there. `pressed`: the force holds it there.
   subroutine come_to_stop(one, unit, first, q, met, pressed)
      type(free_motion_t), intent(inout) :: one
      real(wp), intent(in) :: unit, first
      real(wp), intent(inout) :: q
      integer, intent(out) :: met                    !! 0: none
      logical, intent(out) :: pressed
      type(root_search_t) :: search
      real(wp), dimension(size(one%stops)) :: place
      real(wp) :: x, from, force(1), limit, last
      integer :: side, k
      logical :: there

      met = 0
      pressed = .false.
      place = one%place
      last = q
      do k = 1, size(place)
         if (place(k) > one%stops(k)%high) then
            side = side_high
            limit = one%stops(k)%high
         else if (place(k) < one%stops(k)%low) then
            side = side_low
            limit = one%stops(k)%low
         else
            cycle
         end if
         call force_at(one, [first], force, there)
         from = limit - one%place(k)
         search = begin_search(first, from, last, limit - place(k), epsilon(1.0_wp)*unit)
         do while (.not. search%done())
            x = search%next()
            call force_at(one, [x], force, there)
            call search%put(x, limit - one%place(k))
         end do
         if (met > 0 .and. abs(search%root() - first) >= abs(q - first)) cycle
         q = search%root()
         met = k
         call force_at(one, [q], force, there)
         pressed = real(side, wp)*force(1)*one%normal(k, one%free(1)) > 0.0_wp
      end do
   end subroutine come_to_stop

   !> Several freedoms: Newton's method from many starts.
   subroutine start_everywhere(motion, sizes, starts, found)
      class(free_motion_t), intent(inout) :: motion
      real(wp), intent(in) :: sizes(:)
      integer, intent(in) :: starts
      type(equilibria_t), intent(inout) :: found
      real(wp) :: q(size(sizes)), force(size(sizes)), largest, energy
      type(free_state_t) :: state
      integer :: k, descending
      logical :: there

      largest = 0.0_wp
      energy = 0.0_wp
      do k = 0, starts
         q = start_of(k)
         call force_at(motion, q, force, there)
         if (.not. there) then
            if (k == 0) return
            cycle
         end if
         call motion%describe(0.0_wp, q, 0.0_wp*q, 0.0_wp*q, state)
         energy = max(energy, abs(state%potential))
         largest = max(largest, maxval(abs(force)*sizes))
         if (largest > same_everywhere*energy) exit
      end do
      found%everywhere = largest <= same_everywhere*energy
      if (found%everywhere) return
      do k = 0, starts
         do descending = 0, 1
            q = start_of(k)
            call settle_at(motion, sizes, descending == 1, q, there)
            if (.not. there) cycle
            if (is_new(q)) call keep(motion, q, sizes, 0, found)
         end do
      end do

   contains

      !> The drawing (0), or a place of those that are spread over the ranges of the drives.
      pure function start_of(number) result(place)
         integer, intent(in) :: number
         real(wp) :: place(size(sizes)), spread_by
         integer :: d

         place = motion%start(motion%free)
         if (number == 0) return
         spread_by = plastic(min(size(sizes), size(plastic)))
         do d = 1, size(place)
            place(d) = place(d) + sizes(d)*pi*(2.0_wp*modulo(0.5_wp + real(number, wp)*spread_by**d, 1.0_wp) - 1.0_wp)
         end do
      end function start_of

      !> Angles that differ by whole turns are the same.
      logical function is_new(place)
         real(wp), intent(in) :: place(:)
         real(wp) :: apart(size(place))
         integer :: i

         is_new = .false.
         do i = 1, size(found%list)
            apart = abs(place - found%list(i)%q)
            where (.not. motion%slides(motion%free)) apart = abs(modulo(apart + pi, 2.0_wp*pi) - pi)
            if (all(apart <= same_place*sizes)) return
         end do
         is_new = all(motion%place >= motion%stops%low) .and. all(motion%place <= motion%stops%high)
      end function is_new
   end subroutine start_everywhere

   !> Newton's method from a place; `there` is true where it found an equilibrium.
   subroutine settle_at(motion, sizes, descending, q, there)
      class(free_motion_t), intent(inout) :: motion
      real(wp), intent(in) :: sizes(:)
      logical, intent(in) :: descending              !! the potential falls
      real(wp), intent(inout) :: q(:)
      logical, intent(out) :: there
      real(wp), dimension(size(q), size(q)) :: k, h
      real(wp) :: force(size(q)), move(size(q)), mu, most
      integer :: round, raise
      logical :: positive

      do round = 1, most_iterations
         call stiffness_at(motion, q, sizes, k, there)
         if (.not. there) return
         call force_at(motion, q, force, there)
         if (.not. there) return
         h = motion%inertia(motion%free, :)
         if (descending) then
            mu = 0.0_wp
            do raise = 1, most_raises
               call solve_positive(k + mu*h, force, move, positive)
               if (positive) exit
               mu = max(4.0_wp*mu, maxval(abs(k))/maxval(abs(h))*epsilon(1.0_wp)**0.25_wp)
            end do
         else
            call solve_general(k, force, move, positive)
         end if
         there = positive
         if (.not. there) return
         most = maxval(abs(move)/sizes)
         q = q + move*min(1.0_wp, longest_move/max(most, tiny(1.0_wp)))
         if (most <= found_at) exit
      end do
      ! rounding may keep the last moves above the tolerance
      there = most <= sqrt(found_at)*epsilon(1.0_wp)**0.25_wp
      if (there) call force_at(motion, q, force, there)
   end subroutine settle_at

   !> K = -dQ/dq.
   subroutine stiffness_at(motion, q, sizes, k, there)
      class(free_motion_t), intent(inout) :: motion
      real(wp), intent(in) :: q(:), sizes(:)
      real(wp), intent(out) :: k(:, :)
      logical, intent(out) :: there
      real(wp) :: before(size(q)), after(size(q)), place(size(q)), step
      integer :: j, n

      k = 0.0_wp
      do j = 1, size(q)
         step = near*sizes(j)
         do n = 1, size(eighth)
            place = q
            place(j) = q(j) - real(n, wp)*step
            call force_at(motion, place, before, there)
            if (.not. there) return
            place(j) = q(j) + real(n, wp)*step
            call force_at(motion, place, after, there)
            if (.not. there) return
            k(:, j) = k(:, j) - eighth(n)*(after - before)/step
         end do
      end do
      k = 0.5_wp*(k + transpose(k))
   end subroutine stiffness_at

   !> Add an equilibrium with its small oscillations.
   subroutine keep(motion, q, sizes, held_by, found)
      class(free_motion_t), intent(inout) :: motion
      real(wp), intent(in) :: q(:), sizes(:)
      integer, intent(in) :: held_by                 !! a stop, 0: none
      type(equilibria_t), intent(inout) :: found
      type(equilibrium_t) :: one
      type(free_state_t) :: state
      real(wp), dimension(size(q), size(q)) :: k, h, c, full
      real(wp) :: before(size(q)), after(size(q)), rate(size(q)), companion(2*size(q), 2*size(q))
      integer :: j, f
      logical :: there

      f = size(q)
      one%q = q
      one%held_by = held_by
      if (held_by > 0) then
         allocate (one%squares(0), one%shapes(f, 0), one%roots(0))
      else
         call stiffness_at(motion, q, sizes, k, there)
         if (.not. there) return
         do j = 1, f
            rate = 0.0_wp
            rate(j) = sizes(j)
            call force_at(motion, q, after, there, rate)
            call force_at(motion, q, before, there, -rate)
            c(:, j) = -0.5_wp*(after - before)/sizes(j)
         end do
         call force_at(motion, q, after, there)
         h = motion%inertia(motion%free, :)
         allocate (one%squares(f), one%shapes(f, f))
         call natural_modes(k, h, one%squares, one%shapes, there)
         if (.not. there) return
         where (abs(one%squares) <= no_stiffness*maxval(abs(one%squares))) one%squares = 0.0_wp
         companion = 0.0_wp
         do j = 1, f
            companion(j, f + j) = 1.0_wp
            call solve_general(h, -k(:, j), full(:, j), there)
            companion(f + 1:, j) = full(:, j)
            call solve_general(h, -c(:, j), full(:, j), there)
            companion(f + 1:, f + j) = full(:, j)
         end do
         allocate (one%roots(2*f))
         call general_eigenvalues(companion, one%roots, there)
      end if
      call force_at(motion, q, after, there)
      call motion%describe(0.0_wp, q, 0.0_wp*q, 0.0_wp*q, state)
      one%potential = state%potential
      found%list = [found%list, one]
   end subroutine keep
end module psalm_equilibria
