!> The equations of a sketch as a graph: who has how many unknowns, and which equations tie which two of them.
!>
!> A link has three unknowns, the place of a joint two. That a link has a joint is two equations, a slide two, a gear pair one,
!> a drive one. A slide that closes a ring of slides adds one equation only, for the directions agree already (the wedge).
!> Source: Oldham (1977), chapter 3; Tay (1989) for joints of many links.
module psalm_sketch_graph
   use psalm_sketch, only: sketch_t, drive_slides, drive_stretches, drive_turns
   implicit none (type, external)
   private
   public :: graph_t, make_graph
   public :: tie_joint, tie_slide, tie_gear, tie_drive

   integer, parameter :: tie_joint = 1  !! a link has a joint
   integer, parameter :: tie_slide = 2
   integer, parameter :: tie_gear = 3
   integer, parameter :: tie_drive = 4

   !> Equations between two nodes.
   type :: equation_t
      integer :: nodes(3) = 0          !! two; of a gear pair the third is its carrier
      integer :: count = 0             !! how many
      integer :: kind = 0              !! one of `tie_...`
      integer :: which = 0             !! joint, slide, gear, drive
      integer :: drive = 0             !! the drive it holds: `tie_drive`, and the joints of a cylinder; 0: none
      logical :: closes_ring = .false. !! slide whose direction the other slides of a ring give
   end type equation_t

   !> Nodes: the links, then the joints.
   type :: graph_t
      integer :: links = 0, joints = 0
      integer, allocatable :: unknowns(:)       !! by node
      type(equation_t), allocatable :: equations(:)
   contains
      procedure :: nodes
      procedure :: joint_node
   end type graph_t

contains

   !> Number of nodes.
   pure integer function nodes(self)
      class(graph_t), intent(in) :: self

      nodes = self%links + self%joints
   end function nodes

   !> Node of a joint.
   pure integer function joint_node(self, joint)
      class(graph_t), intent(in) :: self
      integer, intent(in) :: joint

      joint_node = self%links + joint
   end function joint_node

   !> The graph of a sketch. Equations that hold a drive come last; with KOVER=1 first.
   pure function make_graph(sketch) result(graph)
      type(sketch_t), intent(in) :: sketch
      type(graph_t) :: graph
      integer, allocatable :: ring(:), cylinder_of(:)
      integer :: i, j, pass
      type(equation_t) :: new

      graph%links = size(sketch%links)
      graph%joints = size(sketch%joint_name)
      allocate (graph%unknowns(graph%links + graph%joints))
      graph%unknowns(:graph%links) = 3
      graph%unknowns(graph%links + 1:) = 2
      allocate (graph%equations(0))
      allocate (cylinder_of(graph%links), source=0)
      do i = 1, size(sketch%drives)
         if (sketch%drives(i)%kind == drive_stretches) cylinder_of(sketch%drives(i)%link) = i
      end do
      do pass = 1, 2
         do i = 1, graph%links
            if ((cylinder_of(i) == 0) .neqv. pass == 1) cycle
            do j = 1, size(sketch%links(i)%joints)
               graph%equations = [graph%equations, equation_t([i, graph%joint_node(sketch%links(i)%joints(j)), 0], 2, tie_joint, &
                                                              sketch%links(i)%joints(j), cylinder_of(i))]
            end do
         end do
         if (pass == 2) exit
         ring = [(i, i=1, graph%links)]
         do i = 1, size(sketch%slides)
            associate (links => sketch%slides(i)%links)
               new = equation_t([links, 0], 2, tie_slide, i)
               if (ring(links(1)) == ring(links(2))) then
                  new%count = 1
                  new%closes_ring = .true.
               else
                  where (ring == ring(links(2))) ring = ring(links(1))
               end if
               graph%equations = [graph%equations, new]
            end associate
         end do
         do i = 1, size(sketch%gears)
            graph%equations = [graph%equations, equation_t([sketch%gears(i)%wheels, sketch%gears(i)%carrier], 1, tie_gear, i)]
         end do
      end do
      do i = 1, size(sketch%drives)
         associate (drive => sketch%drives(i))
            if (drive%kind == drive_turns .or. drive%kind == drive_slides) &
               graph%equations = [graph%equations, equation_t([drive%base, drive%link, 0], 1, tie_drive, i, i)]
         end associate
      end do
      ! what moves thanks to special dimensions is driven all the same: what is superfluous then is no drive
      if (sketch%over_braced) graph%equations = [pack(graph%equations, graph%equations%drive > 0), &
                                                 pack(graph%equations, graph%equations%drive == 0)]
   end function make_graph
end module psalm_sketch_graph
