!> The kinematic chain of a mechanism: its points and the bars between them.
!>
!> Many loops run through the same points; here every point and every arc that is really there stands once, whatever loops
!> trace it. Nothing but topology: coordinates come later.
module psalm_chain
   use psalm_mechanism, only: mechanism_t, ring_t, bar_t, point_t, pivot
   implicit none (type, external)
   private
   public :: find_points

   !> Points and bars while they are made; only the first `points` and `bars` are valid.
   type :: chain_t
      type(point_t), allocatable :: point(:)
      type(bar_t), allocatable :: bar(:)
      integer :: points = 0, bars = 0
      integer, allocatable :: last(:)     !! by point: the last bar that ends there, as 2*bar - 1 (start) or 2*bar (finish)
      integer, allocatable :: before(:)   !! by end of a bar: the end noted before it at the same point, 0: none
   end type chain_t

contains

   !> Trace all loops: points, bars, and the ends of every arc.
   pure subroutine find_points(mechanism)
      type(mechanism_t), intent(inout) :: mechanism
      type(chain_t) :: chain
      integer :: capacity, loop, n, start, finish, p, q

      ! every arc but one of each ring makes at most one point
      capacity = size(mechanism%arcs) + 1
      allocate (chain%point(capacity), chain%bar(capacity))
      allocate (chain%last(capacity), chain%before(2*capacity), source=0)
      chain%points = pivot
      do loop = 1, mechanism%nloop
         if (.not. mechanism%is_dyad(loop)) then
            call trace_rings(mechanism, loop, chain)
            cycle
         end if
         p = mechanism%groups(loop)%members(1)
         q = mechanism%groups(loop)%members(2)
         start = pivot
         do n = mechanism%seq(loop, 1), p - 1
            call walk(mechanism, n, 1, chain, start)
         end do
         finish = pivot
         do n = mechanism%seq(loop, mechanism%loops(loop)%arcs), q + 1, -1
            call walk(mechanism, n, -1, chain, finish)
         end do
         call add_point(chain, point_t(start, p, 1, loop))
         call add_bar(chain, bar_t(p, [start, chain%points]))
         call run_along(mechanism, p, chain%bars, .false., chain)
         call add_bar(chain, bar_t(q, [chain%points, finish]))
         call run_along(mechanism, q, chain%bars, .false., chain)
      end do
      mechanism%points = chain%point(:chain%points)
      mechanism%bars = chain%bar(:chain%bars)
   end subroutine find_points

   !> The rings of a larger group. The last arc of a ring that is traced backwards ends at the point to which the forward arcs lead.
   pure subroutine trace_rings(mechanism, loop, chain)
      type(mechanism_t), intent(inout) :: mechanism
      integer, intent(in) :: loop
      type(chain_t), intent(inout) :: chain
      type(ring_t) :: ring
      integer :: r, n, meeting, finish, arc

      do r = 1, size(mechanism%loops(loop)%rings)
         ring = mechanism%loops(loop)%rings(r)
         meeting = pivot
         do n = ring%first, ring%turn
            call walk(mechanism, n, 1, chain, meeting)
         end do
         finish = pivot
         do n = ring%last, merge(ring%turn + 2, ring%turn + 1, ring%closed), -1
            call walk(mechanism, n, -1, chain, finish)
         end do
         n = ring%turn + 1
         if (n > ring%last .or. .not. ring%closed) cycle
         arc = mechanism%arcs(n)%representative
         if (arc == n) then
            call add_bar(chain, bar_t(n, [meeting, finish]))
            call run_along(mechanism, n, chain%bars, .false., chain)
         else
            call walk(mechanism, n, -1, chain, finish)
         end if
      end do
   end subroutine trace_rings

   !> From a point along an arc (sense +1) or against it (-1) to the next point.
   pure subroutine walk(mechanism, n, sense, chain, point)
      type(mechanism_t), intent(inout) :: mechanism
      integer, intent(in) :: n, sense
      type(chain_t), intent(inout) :: chain
      integer, intent(inout) :: point
      integer :: arc, way, bar, this_end, near

      if (mechanism%arcs(n)%leads_nowhere) then
         call add_bar(chain, bar_t(n, [point, point]))
         call run_along(mechanism, n, chain%bars, .false., chain)
         return
      end if
      arc = mechanism%arcs(n)%representative
      way = merge(-sense, sense, mechanism%arcs(n)%reversed)
      near = merge(1, 2, way == 1)        ! the end of the bar the walk begins at
      this_end = chain%last(point)
      do while (this_end > 0)
         bar = (this_end + 1)/2
         if (chain%bar(bar)%arc == arc .and. this_end == 2*bar - 2 + near) exit
         this_end = chain%before(this_end)
      end do
      if (this_end == 0) then
         call add_point(chain, point_t(point, arc, way))
         call add_bar(chain, bar_t(arc, merge([point, chain%points], [chain%points, point], way == 1)))
         bar = chain%bars
      end if
      call run_along(mechanism, n, bar, mechanism%arcs(n)%reversed, chain)
      point = chain%bar(bar)%ends(3 - near)
   end subroutine walk

   !> Note which bar an arc runs along.
   pure subroutine run_along(mechanism, n, bar, reversed, chain)
      type(mechanism_t), intent(inout) :: mechanism
      integer, intent(in) :: n, bar
      logical, intent(in) :: reversed
      type(chain_t), intent(in) :: chain

      mechanism%arcs(n)%bar = bar
      mechanism%arcs(n)%ends = chain%bar(bar)%ends
      if (reversed) mechanism%arcs(n)%ends = mechanism%arcs(n)%ends([2, 1])
   end subroutine run_along

   pure subroutine add_point(chain, point)
      type(chain_t), intent(inout) :: chain
      type(point_t), intent(in) :: point

      chain%points = chain%points + 1
      chain%point(chain%points) = point
   end subroutine add_point

   pure subroutine add_bar(chain, bar)
      type(chain_t), intent(inout) :: chain
      type(bar_t), intent(in) :: bar
      integer :: which, this_end

      chain%bars = chain%bars + 1
      chain%bar(chain%bars) = bar
      do which = 1, 2
         this_end = 2*chain%bars - 2 + which
         chain%before(this_end) = chain%last(bar%ends(which))
         chain%last(bar%ends(which)) = this_end
      end do
   end subroutine add_bar
end module psalm_chain
