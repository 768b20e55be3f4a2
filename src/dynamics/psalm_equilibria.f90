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
   use psalm_lapack, only: general_eigenvalues, solve_general
   use psalm_linear, only: solve_positive
   use psalm_root, only: root_search_t, begin_search
   use psalm_symmetric_modes, only: modes_of
   implicit none (type, external)
   private
   public :: equilibria_t, find_equilibria

   integer, parameter :: steps_of_turn = 720         !! in which a turn is gone along
   integer, parameter :: most_halvings = 30          !! of the last step, to where the way ends
   integer, parameter :: most_iterations = 80        !! of Newton's method
   real(wp), parameter :: longest_move = 0.3_wp      !! of it: radians, or parts of the size
   real(wp), parameter :: found_at = 1.0e-13_wp      !! radians, or parts of the size: it has converged
   real(wp), parameter :: same_place = 1.0e-7_wp     !! so near two are one
   real(wp), parameter :: same_everywhere = 1.0e-11_wp !! part of the potential energy: forces on drives that count as none
   real(wp), parameter :: near = 5.0e-3_wp           !! steps of differences: radians, or parts of the size
   real(wp), parameter :: eighth(4) = [4.0_wp/5.0_wp, -1.0_wp/5.0_wp, 4.0_wp/105.0_wp, -1.0_wp/280.0_wp] !! of order 8
   real(wp), parameter :: plastic(6) = [0.618033988749894848_wp, 0.754877666246692760_wp, 0.819172513396164440_wp, &
                                       0.856674883854502874_wp, 0.881271461633569594_wp, 0.898653712628699293_wp]
                                                     !! by drives: root g of g**(-d - 1) = 1 + 1/g; powers spread starts

   !> Where a mechanism stays at rest.
   type :: equilibrium_t
      real(wp), allocatable :: q(:)                  !! shape (free drives): radians or user's lengths
      real(wp) :: potential = 0.0_wp                 !! J
      integer :: stop = 0                            !! that holds it, 0: none
      real(wp), allocatable :: squares(:)            !! shape (free drives): of the undamped angular frequencies, ascending
      real(wp), allocatable :: shapes(:, :)          !! shape (free drives, modes): rates of the drives, the largest 1
      complex(wp), allocatable :: roots(:)           !! shape (2 free drives): of damped motion, exp(root time)
   contains
      procedure :: stable
   end type equilibrium_t

   type :: equilibria_t
      type(equilibrium_t), allocatable :: list(:)    !! by their inputs, or as they were found
      logical :: everywhere = .false.                !! no force acts on the one free drive wherever it is
      logical :: whole_turn = .false.                !! of one freedom: the drive goes round a turn
   end type equilibria_t

contains

   !> It returns after a small push: all squares are positive, or a stop holds it.
   pure logical function stable(self)
      class(equilibrium_t), intent(in) :: self

      stable = self%stop > 0
      if (.not. stable) stable = all(self%squares > 0.0_wp)
   end function stable

   !> All that are found.
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
      real(wp) :: largest, energy
      integer :: way

      largest = 0.0_wp
      energy = 0.0_wp
      do way = 1, -1, -2
         allocate (one, source=motion)
         call follow(one, unit, real(way, wp), found, largest, energy)
         deallocate (one)
         if (found%whole_turn) exit
      end do
      found%everywhere = largest <= same_everywhere*energy
      if (found%everywhere) found%list = [equilibrium_t ::]
      call sort(found%list)
   end subroutine go_along

   !> One way from the drawing.
   subroutine follow(one, unit, way, found, largest, energy)
      type(free_motion_t), intent(inout) :: one
      real(wp), intent(in) :: unit, way              !! way: 1 or -1
      type(equilibria_t), intent(inout) :: found
      real(wp), intent(inout) :: largest, energy     !! force on the drive, and potential energy, so far
      real(wp) :: q(1), before(1), force(1), force_before(1), step, whole, start
      type(free_state_t) :: state
      integer :: k, halved, stop
      logical :: there

      start = one%start(one%free(1))
      whole = 2.0_wp*pi*unit
      step = way*whole/real(steps_of_turn, wp)
      q = start
      call force_at(one, q, force, there)
      if (.not. there) return
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
         stop = passed(one)
         if (stop > 0) then
            call meet(one, unit, stop, before(1), q(1), found)
            exit
         end if
         call one%describe(0.0_wp, q, 0.0_wp*q, 0.0_wp*q, state)
         energy = max(energy, abs(state%potential))
         largest = max(largest, abs(force(1)))
         if (force_before(1)*force(1) < 0.0_wp .or. .not. abs(force(1)) > 0.0_wp) then
            call refine(one, unit, before(1), force_before(1), q(1), force(1), found)
            call force_at(one, q, force, there)
         end if
         call one%anchor()
         if (halved == 0 .and. k == steps_of_turn) exit
      end do
      found%whole_turn = k == steps_of_turn .and. halved == 0 .and. stop == 0 .and. .not. one%slides(one%free(1))
   end subroutine follow

   !> Where the force on the drive is 0.
   subroutine refine(one, unit, first, value_first, second, value_second, found)
      type(free_motion_t), intent(inout) :: one
      real(wp), intent(in) :: unit, first, value_first, second, value_second
      type(equilibria_t), intent(inout) :: found
      type(root_search_t) :: search
      real(wp) :: x, force(1)
      logical :: there

      search = begin_search(first, value_first, second, value_second, epsilon(1.0_wp)*unit)
      do while (.not. search%done())
         x = search%next()
         call force_at(one, [x], force, there)
         if (.not. there) return
         call search%put(x, force(1))
      end do
      call keep(one, [search%root()], [unit], 0, found)
   end subroutine refine

   !> A stop that has been passed; 0: none.
   pure integer function passed(one)
      type(free_motion_t), intent(in) :: one

      do passed = size(one%stops), 1, -1
         if (one%place(passed) < one%stops(passed)%low .or. one%place(passed) > one%stops(passed)%high) return
      end do
   end function passed

   !> It rests on a stop that it is pressed to.
   subroutine meet(one, unit, stop, first, second, found)
      type(free_motion_t), intent(inout) :: one
      integer, intent(in) :: stop
      real(wp), intent(in) :: unit, first, second
      type(equilibria_t), intent(inout) :: found
      type(root_search_t) :: search
      real(wp) :: x, force(1), limit, from
      integer :: side
      logical :: there

      side = merge(side_high, side_low, one%place(stop) > one%stops(stop)%high)
      limit = merge(one%stops(stop)%high, one%stops(stop)%low, side == side_high)
      x = limit - one%place(stop)
      call force_at(one, [first], force, there)
      from = limit - one%place(stop)
      search = begin_search(first, from, second, x, epsilon(1.0_wp)*unit)
      do while (.not. search%done())
         x = search%next()
         call force_at(one, [x], force, there)
         call search%put(x, limit - one%place(stop))
      end do
      call force_at(one, [search%root()], force, there)
      if (real(side, wp)*force(1)*one%normal(stop, one%free(1)) > 0.0_wp) &
         call keep(one, [search%root()], [unit], stop, found)
   end subroutine meet

   !> Several freedoms: Newton's method from many starts.
   subroutine start_everywhere(motion, sizes, starts, found)
      class(free_motion_t), intent(inout) :: motion
      real(wp), intent(in) :: sizes(:)
      integer, intent(in) :: starts
      type(equilibria_t), intent(inout) :: found
      real(wp) :: q(size(sizes)), drawn(size(sizes)), spread_by
      integer :: k, d, descending
      logical :: there

      drawn = motion%start(motion%free)
      spread_by = plastic(min(size(sizes), size(plastic)))
      do k = 0, starts
         do descending = 0, 1
            do d = 1, size(q)
               q(d) = drawn(d)
               if (k > 0) q(d) = drawn(d) + sizes(d)*pi*(2.0_wp*modulo(0.5_wp + real(k, wp)*spread_by**d, 1.0_wp) - 1.0_wp)
            end do
            call settle_at(motion, sizes, descending == 1, q, there)
            if (.not. there) cycle
            if (is_new(q)) call keep(motion, q, sizes, 0, found)
         end do
      end do

   contains

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
      integer :: round
      logical :: positive

      do round = 1, most_iterations
         call stiffness_at(motion, q, sizes, k, there)
         if (.not. there) return
         call force_at(motion, q, force, there)
         if (.not. there) return
         h = motion%inertia(motion%free, :)
         if (descending) then
            mu = 0.0_wp
            do
               call solve_positive(k + mu*h, force, move, positive)
               if (positive) exit
               mu = max(4.0_wp*mu, maxval(abs(k))/maxval(abs(h))*epsilon(1.0_wp)**0.25_wp)
               if (.not. mu < huge(1.0_wp)) exit
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
   subroutine keep(motion, q, sizes, stop, found)
      class(free_motion_t), intent(inout) :: motion
      real(wp), intent(in) :: q(:), sizes(:)
      integer, intent(in) :: stop
      type(equilibria_t), intent(inout) :: found
      type(equilibrium_t) :: one
      type(free_state_t) :: state
      real(wp), dimension(size(q), size(q)) :: k, h, c, full
      real(wp) :: before(size(q)), after(size(q)), rate(size(q)), companion(2*size(q), 2*size(q))
      integer :: j, f
      logical :: there

      f = size(q)
      one%q = q
      one%stop = stop
      allocate (one%squares(0), one%shapes(f, 0), one%roots(0))
      if (stop == 0) then
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
         call modes_of(k, h, one%squares, one%shapes)
         companion = 0.0_wp
         do j = 1, f
            companion(j, f + j) = 1.0_wp
            call solve_general(h, -k(:, j), full(:, j), there)
            companion(f + 1:, j) = full(:, j)
            call solve_general(h, -c(:, j), full(:, j), there)
            companion(f + 1:, f + j) = full(:, j)
         end do
         deallocate (one%roots)
         allocate (one%roots(2*f))
         call general_eigenvalues(companion, one%roots, there)
      end if
      call force_at(motion, q, after, there)
      call motion%describe(0.0_wp, q, 0.0_wp*q, 0.0_wp*q, state)
      one%potential = state%potential
      found%list = [found%list, one]
   end subroutine keep

   !> Ascending inputs.
   pure subroutine sort(list)
      type(equilibrium_t), intent(inout) :: list(:)
      type(equilibrium_t) :: one
      integer :: i, j

      do i = 2, size(list)
         one = list(i)
         j = i - 1
         do while (j >= 1)
            if (list(j)%q(1) <= one%q(1)) exit
            list(j + 1) = list(j)
            j = j - 1
         end do
         list(j + 1) = one
      end do
   end subroutine sort
end module psalm_equilibria
