!> The kinematic chain of a linkage: joints and the bars between them.
!>
!> Many loops run through the same joints; here every joint and every arc that is really there stands once, whatever loops
!> trace it. Nothing but topology: co-ordinates come later.
module psalm_chain
   use psalm_topology, only: topology_t
   implicit none (type, external)
   private
   public :: chain_t, make_chain

   !> Joints by number, the input pivot being joint 1; bars by number.
   type :: chain_t
      integer :: joints = 0, bars = 0
      ! how a joint is reached: from a joint before it, along (+1) or against (-1) an arc
      integer, allocatable :: from(:), arc(:), way(:)
      integer, allocatable :: pair_loop(:)           !! by joint: it is the joint shared by the pair of this loop; 0: it is not
      integer, allocatable :: start(:), finish(:)    !! by bar: its joints, in the sense of its arc
      integer, allocatable :: bar_arc(:)             !! by bar: sequential number of the arc (the representative)
      integer, allocatable :: bar_of(:)              !! by sequential number: the bar the arc runs along, 0: no such arc
      integer, allocatable :: outer(:, :)            !! shape (2, nloop): start S of p and finish E of q
      integer, allocatable :: shared(:)              !! by loop: the joint shared by p and q
   contains
      procedure :: ends_of
   end type chain_t

contains

   !> Trace all loops.
   pure function make_chain(topology) result(chain)
      type(topology_t), intent(in) :: topology
      type(chain_t) :: chain
      integer :: room, loop, a, start, finish, p, q

      room = size(topology%arcs) + 1
      allocate (chain%from(room), chain%arc(room), chain%way(room), chain%pair_loop(room), chain%start(room), chain%finish(room), &
                chain%bar_arc(room), chain%bar_of(size(topology%arcs)), source=0)
      allocate (chain%outer(2, topology%nloop), chain%shared(topology%nloop), source=0)
      chain%joints = 1
      do loop = 1, topology%nloop
         p = topology%seq(loop, topology%larcx(1, loop))
         q = topology%seq(loop, topology%larcx(2, loop))
         start = 1
         do a = 1, topology%larcx(1, loop) - 1
            call walk(topology, topology%seq(loop, a), 1, chain, start)
         end do
         finish = 1
         do a = topology%loopl(loop), topology%larcx(2, loop) + 1, -1
            call walk(topology, topology%seq(loop, a), -1, chain, finish)
         end do
         chain%outer(:, loop) = [start, finish]
         call add_joint(chain, start, p, 1)
         chain%pair_loop(chain%joints) = loop
         chain%shared(loop) = chain%joints
         call add_bar(chain, start, chain%joints, p)
         chain%bar_of(p) = chain%bars
         call add_bar(chain, chain%joints, finish, q)
         chain%bar_of(q) = chain%bars
      end do
   end function make_chain

   !> From a joint along an arc (sense +1) or against it (-1) to the next joint.
   pure subroutine walk(topology, n, sense, chain, joint)
      type(topology_t), intent(in) :: topology
      integer, intent(in) :: n, sense
      type(chain_t), intent(inout) :: chain
      integer, intent(inout) :: joint
      integer :: arc, way, bar

      arc = topology%arcs(n)%representative
      way = merge(-sense, sense, topology%arcs(n)%reversed)
      do bar = 1, chain%bars
         if (chain%bar_arc(bar) /= arc) cycle
         if (way == 1 .and. chain%start(bar) == joint) then
            chain%bar_of(n) = bar
            joint = chain%finish(bar)
            return
         else if (way == -1 .and. chain%finish(bar) == joint) then
            chain%bar_of(n) = bar
            joint = chain%start(bar)
            return
         end if
      end do
      call add_joint(chain, joint, arc, way)
      if (way == 1) then
         call add_bar(chain, joint, chain%joints, arc)
      else
         call add_bar(chain, chain%joints, joint, arc)
      end if
      chain%bar_of(n) = chain%bars
      joint = chain%joints
   end subroutine walk

   pure subroutine add_joint(chain, from, arc, way)
      type(chain_t), intent(inout) :: chain
      integer, intent(in) :: from, arc, way

      chain%joints = chain%joints + 1
      chain%from(chain%joints) = from
      chain%arc(chain%joints) = arc
      chain%way(chain%joints) = way
   end subroutine add_joint

   pure subroutine add_bar(chain, start, finish, arc)
      type(chain_t), intent(inout) :: chain
      integer, intent(in) :: start, finish, arc

      chain%bars = chain%bars + 1
      chain%start(chain%bars) = start
      chain%finish(chain%bars) = finish
      chain%bar_arc(chain%bars) = arc
   end subroutine add_bar

   !> Start and finish of an arc as its own loop traces it.
   pure subroutine ends_of(self, topology, n, start, finish)
      class(chain_t), intent(in) :: self
      type(topology_t), intent(in) :: topology
      integer, intent(in) :: n               !! sequential number
      integer, intent(out) :: start, finish  !! joints

      start = self%start(self%bar_of(n))
      finish = self%finish(self%bar_of(n))
      if (topology%arcs(n)%reversed) then
         start = self%finish(self%bar_of(n))
         finish = self%start(self%bar_of(n))
      end if
   end subroutine ends_of
end module psalm_chain
