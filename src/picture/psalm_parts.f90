!> The parts of a linkage as drawn: joints, bars, rigid bodies, slides, pairs of undetermined arcs.
module psalm_parts
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, at_finish, at_start
   use psalm_plan, only: plan_t, root_frame
   implicit none (type, external)
   private
   public :: ghost_t
   public :: drawn_joint_t, drawn_bar_t, drawn_body_t, drawn_slide_t, drawn_dyad_t, wheel_t, output_curve_t, drive_part_t, &
             edge_t, find_slides, convex_hull

   real(wp), parameter :: flat = 1.0e-3_wp !! a hull with less area than this times its width squared is a line

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

   !> Joints round the outline of a set of points, anticlockwise; size 0 if they lie on a line.
   function convex_hull(joints, x, y) result(hull)
      integer, intent(in) :: joints(:)
      real(wp), intent(in) :: x(:), y(:)       !! shape as `joints`
      integer, allocatable :: hull(:)
      integer :: order(size(joints)), chain(2*size(joints)), i, k, first, count
      real(wp) :: u(size(joints)), v(size(joints)), width

      allocate (hull(0))
      width = max(maxval(x) - minval(x), maxval(y) - minval(y))
      if (size(joints) < 3 .or. width <= 0.0_wp) return
      u = (x - minval(x))/width
      v = (y - minval(y))/width
      order = [(i, i=1, size(joints))]
      do i = 2, size(order)
         do k = i, 2, -1
            if (u(order(k)) > u(order(k - 1)) .or. (u(order(k)) >= u(order(k - 1)) .and. v(order(k)) >= v(order(k - 1)))) exit
            order([k - 1, k]) = order([k, k - 1])
         end do
      end do
      count = 0
      first = 1
      do i = 1, size(order)
         call push(order(i))
      end do
      first = count
      do i = size(order) - 1, 1, -1
         call push(order(i))
      end do
      count = count - 1
      if (count < 3 .or. area() < flat) return
      hull = joints(chain(:count))

   contains

      !> Put a point on the outline; points it leaves to its right go.
      subroutine push(point)
         integer, intent(in) :: point

         do while (count > first)
            associate (a => chain(count - 1), b => chain(count))
               if ((u(b) - u(a))*(v(point) - v(b)) - (v(b) - v(a))*(u(point) - u(b)) > flat*flat) exit
            end associate
            count = count - 1
         end do
         count = count + 1
         chain(count) = point
      end subroutine push

      pure real(wp) function area()
         integer :: m

         area = 0.0_wp
         do m = 1, count
            associate (a => chain(m), b => chain(modulo(m, count) + 1))
               area = area + 0.5_wp*(u(a)*v(b) - u(b)*v(a))
            end associate
         end do
      end function area
   end function convex_hull
end module psalm_parts
