!> The parts of a linkage as drawn: joints, bars, rigid bodies, slides, pairs of undetermined arcs.
module psalm_parts
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, at_finish, at_start
   use psalm_plan, only: plan_t, root_frame
   implicit none (type, external)
   private
   public :: ghost_t
   public :: drawn_joint_t, drawn_bar_t, drawn_body_t, drawn_slide_t, drawn_dyad_t, wheel_t, output_curve_t, drive_part_t, &
             edge_t, find_slides

   !> The linkage once more, in grey: an equilibrium.
   type :: ghost_t
      character(12) :: name = ''              !! its number
      logical :: stable = .true.
      real(wp), allocatable :: x(:), y(:)     !! by joint, machine axes
      logical, allocatable :: known(:)
   end type ghost_t

   type :: drawn_joint_t
      character(:), allocatable :: name       !! letter; empty: a corner of one body, no joint
      logical :: turning = .false.            !! revolute
      logical :: slides = .false.             !! prismatic: a block sits here
      logical :: fixed = .false.              !! on the frame
   end type drawn_joint_t

   !> An arc, or several arcs that are the same.
   type :: drawn_bar_t
      integer :: start = 0, finish = 0        !! joints
      integer :: loop = 0, arc = 0            !! the first arc along it; 0: the output arc
      character(:), allocatable :: others     !! the other arcs along it, in words
      integer :: slide = 0                    !! number of the slide, 0: fixed length
      integer :: body = 0                     !! rigid body it belongs to, 0: none
      real(wp) :: length = 0.0_wp             !! fixed length
      logical :: cylinder = .false.           !! a drive changes its length
      real(wp) :: barrel = 0.0_wp             !! of a cylinder: length of the thick part, from the start
   end type drawn_bar_t

   type :: drawn_body_t
      integer, allocatable :: joints(:)
      integer, allocatable :: hull(:)         !! joints round its outline, size 0: no plate
      logical :: frame = .false.
      character(:), allocatable :: name       !! of a link of a sketch; else not allocated
      real(wp) :: width = 0.0_wp, hole = 0.0_wp !! of a plate: of the link, of the holes at its joints
   end type drawn_body_t

   type :: drawn_slide_t
      integer :: bar = 0
      integer :: of = 0                       !! slide of the sketch
      integer :: guide = 0, block = 0         !! joints: where the guide meets the line, and what moves along it
      real(wp) :: sense = 1.0_wp              !! +1: the arc leads from guide to block
      logical :: still = .false.              !! its direction is that of the frame
      real(wp) :: low = 0.0_wp, high = 0.0_wp !! reach of the rail, from the guide along sense times the arc's direction
   end type drawn_slide_t

   !> The undetermined arcs of a loop.
   type :: drawn_dyad_t
      character(:), allocatable :: name       !! `loop 2`, or of a sketch `joints B, C, D`
      integer :: joint_type = 0               !! dyad, 1 to 8; 9: a larger group
      integer :: start = 0, shared = 0, finish = 0 !! joints S, common joint, E
      integer :: bars(2) = 0                  !! p and q
   end type drawn_dyad_t

   !> A gear wheel.
   type :: wheel_t
      integer :: body = 0
      integer :: centre = 0, rim = 0          !! joints: where it turns, and a point of its pitch circle
      real(wp) :: radius = 0.0_wp
   end type wheel_t

   !> A number of an output along both rows of positions.
   type :: output_curve_t
      character(:), allocatable :: name
      logical :: angle = .false.              !! degrees
      real(wp), allocatable :: prescribed(:), sweep(:) !! valid where the linkage closes
   end type output_curve_t

   !> A drive along both rows of positions.
   type :: drive_part_t
      character(:), allocatable :: name
      logical :: turning = .false.            !! degrees, else length
      real(wp), allocatable :: prescribed(:), sweep(:)
   end type drive_part_t

   !> A curve that bounds what the output reaches.
   type :: edge_t
      real(wp), allocatable :: x(:), y(:)
   end type edge_t

contains

   !> Every bar of varying length, with the points of the chain for joints.
   pure subroutine find_slides(mechanism, plan, slides)
      type(mechanism_t), intent(in) :: mechanism
      type(plan_t), intent(in) :: plan
      type(drawn_slide_t), allocatable, intent(out) :: slides(:)
      type(drawn_slide_t) :: slide
      integer :: b, n

      allocate (slides(0))
      do b = 1, size(mechanism%bars)
         n = mechanism%bars(b)%arc
         if (.not. mechanism%slides(n)) cycle
         associate (ends => mechanism%bars(b)%ends, foot => mechanism%arcs(n)%foot)
            slide%bar = b
            slide%guide = ends(foot)
            slide%block = ends(at_start + at_finish - foot)
            slide%sense = merge(1.0_wp, -1.0_wp, foot == at_start)
            slide%still = plan%root(n) == root_frame
         end associate
         slides = [slides, slide]
      end do
   end subroutine find_slides
end module psalm_parts
