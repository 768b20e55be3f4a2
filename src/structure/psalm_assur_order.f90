!> Assur groups of a sketch, in the order in which they are solved.
!>
!> With the drives held, each equation is paid by one of its two ends and none pays more than its unknowns (augmenting paths).
!> An arrow leads from who pays to the other end; the strongly connected components are the Assur groups, whatever payment was
!> found (Dulmage and Mendelsohn 1958), and their topological order is the order of solution. Source: Oldham (1977), 3.3.
!>
!> Links of a part that is braced twice are one group: where some of them are at a change point, the others still hold them.
module psalm_assur_order
   use psalm_freedom, only: bracing_t
   use psalm_sketch, only: sketch_t, frame_link
   use psalm_sketch_graph, only: graph_t, make_graph, tie_drive
   implicit none (type, external)
   private
   public :: assur_order_t, find_assur_groups

   !> One group: what it finds and by which equations.
   type :: assur_group_t
      integer, allocatable :: links(:)       !! that it places
      integer, allocatable :: joints(:)      !! that it places
      integer, allocatable :: equations(:)   !! of the graph
      integer :: order &
         = 0                   !! links less drives held in it: 0 a driven link, 2 a dyad, 4 a triad
      integer, allocatable :: needs(:)       !! groups that must be solved before
   end type assur_group_t

   type :: assur_order_t
      logical :: valid = .false.             !! every unknown is found by one equation
      type(assur_group_t), allocatable :: groups(:)
      integer, allocatable :: of_link(:), of_joint(:) !! the group that places it; 0: the frame
   end type assur_order_t

contains

   !> Decompose. `valid` is false where the mechanism is loose or over-braced; `psalm_freedom` then has the words.
   !> Equations that others imply are left out where `braced` says so.
   function find_assur_groups(sketch, braced) result(order)
      type(sketch_t), intent(in) :: sketch
      type(bracing_t), intent(in), optional :: braced(:)
      type(assur_order_t) :: order
      type(graph_t) :: graph
      integer, allocatable :: payer(:, :)    !! shape (3, equations): equations paid by each end
      integer, allocatable :: spent(:), component(:), place(:)
      logical, allocatable :: seen(:), placed(:)
      integer :: i, k, components, group, best
      logical :: found

      graph = make_graph(sketch)
      graph%unknowns(frame_link) = 0
      if (present(braced)) then
         do i = 1, size(braced)
            associate (count => graph%equations(braced(i)%equation)%count)
               count = count - braced(i)%count
            end associate
         end do
      end if
      allocate (payer(3, size(graph%equations)), source=0)
      allocate (spent(graph%nodes()), source=0)
      order%valid = .true.
      do i = 1, size(graph%equations)
         do k = 1, graph%equations(i)%count
            allocate (seen(graph%nodes()), source=.false.)
            call pay(graph, i, payer, spent, seen, found)
            deallocate (seen)
            order%valid = order%valid .and. found
         end do
      end do
      order%valid = order%valid .and. all(spent == graph%unknowns)
      allocate (order%of_link(graph%links), order%of_joint(graph%joints), source=0)
      if (.not. order%valid) then
         allocate (order%groups(0))
         return
      end if
      if (present(braced)) then
         call find_components(graph, payer, component, components, braced)
      else
         call find_components(graph, payer, component, components)
      end if
      ! components in order, of those that are ready the one with the lowest link first
      allocate (place(components), source=0)
      allocate (placed(components), source=.false.)
      placed(component(frame_link)) = .true.
      do group = 1, components - 1
         best = 0
         do i = 1, components
            if (placed(i)) cycle
            if (.not. is_ready(i)) cycle
            if (best == 0) then
               best = i
            else if (findloc(component, i, dim=1) < findloc(component, best, dim=1)) then
               best = i
            end if
         end do
         placed(best) = .true.
         place(best) = group
      end do
      call fill_groups()

   contains

      !> True if what a component depends on is placed.
      pure logical function is_ready(which)
         integer, intent(in) :: which
         integer :: e, side, other

         is_ready = .true.
         do e = 1, size(graph%equations)
            do side = 1, 3
               if (payer(side, e) == 0) cycle
               if (component(graph%equations(e)%nodes(side)) /= which) cycle
               do other = 1, 3
                  if (graph%equations(e)%nodes(other) == 0) cycle
                  if (component(graph%equations(e)%nodes(other)) == which) cycle
                  is_ready = is_ready .and. placed(component(graph%equations(e)%nodes(other)))
               end do
            end do
         end do
      end function is_ready

      subroutine fill_groups()
         integer :: e, side, node, other, end_of

         allocate (order%groups(components - 1))
         do node = 1, size(order%groups)
            associate (g => order%groups(node))
               allocate (g%links(0), g%joints(0), g%equations(0), g%needs(0))
            end associate
         end do
         do node = 1, graph%nodes()
            group = place(component(node))
            if (group == 0) cycle
            if (node <= graph%links) then
               order%groups(group)%links = [order%groups(group)%links, node]
               order%groups(group)%order = order%groups(group)%order + 1
               order%of_link(node) = group
            else
               order%groups(group)%joints = [order%groups(group)%joints, node - graph%links]
               order%of_joint(node - graph%links) = group
            end if
         end do
         do e = 1, size(graph%equations)
            do side = 1, 3
               if (payer(side, e) == 0) cycle
               group = place(component(graph%equations(e)%nodes(side)))
               associate (g => order%groups(group))
                  if (all(g%equations /= e)) then
                     g%equations = [g%equations, e]
                     if (graph%equations(e)%kind == tie_drive) g%order = g%order - 1
                  end if
                  do end_of = 1, 3
                     if (graph%equations(e)%nodes(end_of) == 0) cycle
                     other = place(component(graph%equations(e)%nodes(end_of)))
                     if (other > 0 .and. other /= group .and. all(g%needs /= other)) g%needs = [g%needs, other]
                  end do
               end associate
            end do
         end do
      end subroutine fill_groups
   end function find_assur_groups

   !> Let one of an equation's ends pay for it, after others have changed who pays for theirs.
   pure recursive subroutine pay(graph, equation, payer, spent, seen, found)
      type(graph_t), intent(in) :: graph
      integer, intent(in) :: equation
      integer, intent(inout) :: payer(:, :), spent(:)
      logical, intent(inout) :: seen(:)
      logical, intent(out) :: found
      integer :: side, node, i, which

      found = .false.
      do side = 1, 3
         node = graph%equations(equation)%nodes(side)
         if (node == 0) cycle
         if (seen(node)) cycle
         seen(node) = .true.
         if (spent(node) < graph%unknowns(node)) then
            found = .true.
         else
            do i = 1, size(graph%equations)
               which = findloc(graph%equations(i)%nodes, node, dim=1)
               if (which == 0) cycle
               if (payer(which, i) == 0) cycle
               payer(which, i) = payer(which, i) - 1
               spent(node) = spent(node) - 1
               call pay(graph, i, payer, spent, seen, found)
               if (found) exit
               payer(which, i) = payer(which, i) + 1
               spent(node) = spent(node) + 1
            end do
         end if
         if (.not. found) cycle
         payer(side, equation) = payer(side, equation) + 1
         spent(node) = spent(node) + 1
         return
      end do
   end subroutine pay

   !> Strongly connected components (Tarjan 1972).
   subroutine find_components(graph, payer, component, components, braced)
      type(graph_t), intent(in) :: graph
      integer, intent(in) :: payer(:, :)
      integer, allocatable, intent(out) :: component(:) !! by node
      integer, intent(out) :: components
      type(bracing_t), intent(in), optional :: braced(:)
      integer, allocatable :: number(:), low(:), stack(:)
      integer :: counter, height, node

      allocate (component(graph%nodes()), number(graph%nodes()), low(graph%nodes()), stack(graph%nodes()), source=0)
      components = 0
      counter = 0
      height = 0
      do node = 1, graph%nodes()
         if (number(node) == 0) call visit(node)
      end do

   contains

      recursive subroutine visit(node)
         integer, intent(in) :: node
         integer :: e, side, other, end_of, top

         counter = counter + 1
         number(node) = counter
         low(node) = counter
         height = height + 1
         stack(height) = node
         do e = 1, size(graph%equations)
            side = findloc(graph%equations(e)%nodes, node, dim=1)
            if (side == 0) cycle
            if (payer(side, e) == 0) cycle
            do end_of = 1, 3
               other = graph%equations(e)%nodes(end_of)
               if (other > 0 .and. other /= node) call follow(node, other)
            end do
         end do
         if (present(braced) .and. node <= graph%links) then
            do e = 1, size(braced)
               if (.not. holds(braced(e), node)) cycle
               do other = 1, graph%links
                  if (other /= node .and. holds(braced(e), other)) call follow(node, other)
               end do
            end do
         end if
         if (low(node) /= number(node)) return
         components = components + 1
         do
            top = stack(height)
            height = height - 1
            component(top) = components
            if (top == node) exit
         end do
      end subroutine visit

      recursive subroutine follow(node, other)
         integer, intent(in) :: node, other

         if (number(other) == 0) then
            call visit(other)
            low(node) = min(low(node), low(other))
         else if (component(other) == 0) then
            low(node) = min(low(node), number(other))
         end if
      end subroutine follow

      !> True if a link belongs to a part that is braced twice, and is no link that is driven on the frame.
      pure logical function holds(part, link)
         type(bracing_t), intent(in) :: part
         integer, intent(in) :: link
         integer :: e

         holds = part%part(link) .and. link /= frame_link
         do e = 1, size(graph%equations)
            associate (tie => graph%equations(e))
               if (tie%kind == tie_drive .and. tie%nodes(1) == frame_link .and. tie%nodes(2) == link) holds = .false.
            end associate
         end do
      end function holds
   end subroutine find_components
end module psalm_assur_order
