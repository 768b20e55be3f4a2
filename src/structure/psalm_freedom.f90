!> Degree of freedom of a sketch, and in words what is loose and what is braced twice.
!>
!> The pebble game: a link holds three pebbles, a joint two; an equation is free of the others if four pebbles can be gathered at
!> its two ends, and then takes one of them. It finds over-braced parts although the total may be right. Source: Jacobs and
!> Thorpe (1995) for bars, here for links, joints and slides; Oldham (1977), 3.1 and 3.2 for what is to be reported.
module psalm_freedom
   use psalm_sketch, only: sketch_t, frame_link, drive_stretches
   use psalm_sketch_graph, only: graph_t, make_graph
   implicit none (type, external)
   private
   public :: freedom_t, bracing_t, find_freedom

   integer, parameter :: whole_plane = 3  !! unknowns of a rigid body

   !> An equation that others imply.
   type :: bracing_t
      integer :: equation = 0               !! of the graph
      integer :: count = 0                  !! how many of its equations the others imply
      logical, allocatable :: part(:)       !! by link: the part that is rigid without it
   end type bracing_t

   type :: freedom_t
      integer :: links = 0, pairs = 0       !! links; turning pairs (n-1 of a joint of n links) and slides
      integer :: count = 0                  !! 3 (links-1) - 2 pairs - gears + cylinders
      integer :: freedom = 0                !! what the pebbles tell, drives free
      integer :: left = 0                   !! with all drives held
      logical, allocatable :: loose(:)      !! by link: still moves with all drives held
      type(bracing_t), allocatable :: braced(:)
   end type freedom_t

   !> The game: where the pebbles are.
   type :: game_t
      integer, allocatable :: free(:)       !! by node
      integer, allocatable :: from(:), to(:) !! by equation accepted: the node that pays for it, the other one
      integer :: paid = 0
   end type game_t

contains

   !> Play the game.
   pure function find_freedom(sketch) result(found)
      type(sketch_t), intent(in) :: sketch
      type(freedom_t) :: found
      type(graph_t) :: graph
      type(game_t) :: game
      type(bracing_t) :: one
      logical, allocatable :: reached(:)
      integer :: i, k, total
      logical :: gathered

      graph = make_graph(sketch)
      allocate (game%free(graph%nodes()), source=graph%unknowns)
      total = sum(graph%equations%count)
      allocate (game%from(total), game%to(total), source=0)
      allocate (found%braced(0))
      found%links = graph%links
      do i = 1, graph%joints
         found%pairs = found%pairs + max(0, size(sketch%links_of(i)) - 1)
      end do
      found%pairs = found%pairs + size(sketch%slides)
      found%count = whole_plane*(found%links - 1) - 2*found%pairs - size(sketch%gears) + &
                    count(sketch%drives%kind == drive_stretches)
      allocate (found%loose(graph%links), source=.false.)
      do i = 1, size(graph%equations)
         associate (equation => graph%equations(i))
            do k = 1, equation%count
               call gather(game, equation%nodes(:2), gathered, reached)
               if (.not. gathered) then
                  one = bracing_t(i, equation%count - k + 1, reached(:graph%links))
                  found%braced = [found%braced, one]   ! of a constructor within a constructor gfortran 12 loses the memory
                  exit
               end if
               game%free(equation%nodes(1)) = game%free(equation%nodes(1)) - 1
               game%paid = game%paid + 1
               game%from(game%paid) = equation%nodes(1)
               game%to(game%paid) = equation%nodes(2)
            end do
         end associate
      end do
      found%left = sum(game%free) - whole_plane
      ! a cylinder that is held pays for what it drives
      found%freedom = found%left + size(sketch%drives) - count([(graph%equations(found%braced(i)%equation)%drive > 0, &
                                                                 i=1, size(found%braced))])
      do i = 1, graph%links
         if (i == frame_link .or. found%left == 0) cycle
         call gather(game, [frame_link, i], gathered, reached)
         found%loose(i) = gathered
      end do
   end function find_freedom

   !> Bring four pebbles to two nodes, at least one of them to the first. Failing that, `reached` are the nodes that are rigid
   !> with them.
   pure subroutine gather(game, ends, gathered, reached)
      type(game_t), intent(inout) :: game
      integer, intent(in) :: ends(2)
      logical, intent(out) :: gathered
      logical, allocatable, intent(out) :: reached(:)
      logical, allocatable :: seen(:)
      integer :: which
      logical :: found

      allocate (reached(size(game%free)), source=.false.)
      reached(ends) = .true.
      each_end: do which = 1, 2
         do
            gathered = sum(game%free(ends)) > whole_plane .and. game%free(ends(1)) > 0
            if (gathered) return
            allocate (seen(size(game%free)), source=.false.)
            seen(ends) = .true.
            call fetch(game, ends(which), seen, found)
            if (.not. found) then
               reached = reached .or. seen
               deallocate (seen)
               exit
            end if
            deallocate (seen)
         end do
      end do each_end
      gathered = sum(game%free(ends)) > whole_plane .and. game%free(ends(1)) > 0
   end subroutine gather

   !> One more pebble for a node, from along the equations that it pays for.
   pure recursive subroutine fetch(game, node, seen, found)
      type(game_t), intent(inout) :: game
      integer, intent(in) :: node
      logical, intent(inout) :: seen(:)
      logical, intent(out) :: found
      integer :: i, other

      found = .false.
      do i = 1, game%paid
         if (game%from(i) /= node) cycle
         other = game%to(i)
         if (seen(other)) cycle
         seen(other) = .true.
         found = game%free(other) > 0
         if (.not. found) call fetch(game, other, seen, found)
         if (.not. found) cycle
         ! the other node pays instead
         game%free(other) = game%free(other) - 1
         game%from(i) = other
         game%to(i) = node
         game%free(node) = game%free(node) + 1
         return
      end do
   end subroutine fetch
end module psalm_freedom
