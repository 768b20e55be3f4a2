!> The joints of each link, as far as its arcs tell them.
!>
!> An arc of a link leads from joint to joint of that link: what begins elsewhere is no part of it, however right its
!> direction. Loops are followed from both ends, to their undetermined pair; each joint passed has coordinates in the
!> axes of every link that meets there. A joint that slides on a link has none, and a link with such a joint is not assessed.
module psalm_joints
   use psalm_angles, only: unit_vector
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t, arc_actuator, arc_crank, arc_determined, arc_link, arc_slide, body_frame
   implicit none (type, external)
   private
   public :: joints_t, find_joints

   real(wp), parameter :: same_place = 1.0e-3_wp !! joints nearer than so much of the longest arc are one: data are rounded

   !> A joint on one link.
   type :: seat_t
      integer :: node = 0          !! number of the joint
      integer :: body = body_frame
      real(wp) :: x = 0.0_wp, y = 0.0_wp !! in the axes of the body
   end type seat_t

   !> What is known of the joints.
   type :: joints_t
      logical, allocatable :: astray(:)    !! by sequential number: hangs on no joint of its link
      integer, allocatable :: start(:)     !! by sequential number: the joint it begins at; 0: not known
      integer, allocatable :: finish(:)    !! the joint it ends at
   contains
      procedure :: alike
   end type joints_t

contains

   !> True if both arcs lead from the same joint to the same joint.
   pure logical function alike(self, n, m)
      class(joints_t), intent(in) :: self
      integer, intent(in) :: n, m   !! sequential numbers

      alike = self%start(n) > 0 .and. self%start(n) == self%start(m) .and. &
              self%finish(n) > 0 .and. self%finish(n) == self%finish(m)
   end function alike

   !> Follow all loops.
   subroutine find_joints(mechanism, dimensions, joints)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(joints_t), intent(out) :: joints
      type(seat_t), allocatable :: seats(:)
      integer, allocatable :: next(:)       !! by seat: the seat of the same body before it, 0: none
      integer, allocatable :: last(:)       !! by body: its last seat
      logical, allocatable :: loose(:)      !! by body: a joint of it is not known
      real(wp), allocatable :: angle(:)     !! by sequential number: from the axes of its body, degrees
      real(wp), allocatable :: length(:)    !! by sequential number
      integer :: n, loop, a, nodes, filled, here, there, p, q
      real(wp) :: near

      n = size(mechanism%arcs)
      allocate (joints%astray(n), source=.false.)
      allocate (joints%start(n), joints%finish(n), source=0)
      allocate (angle(n), source=0.0_wp)
      length = dimensions%arcl
      allocate (last(size(mechanism%bodies)), source=0)
      allocate (loose(size(mechanism%bodies)), source=.false.)
      allocate (seats(64), next(64))
      near = same_place*maxval(dimensions%arcl)
      filled = 0
      nodes = 1
      call seat(1, body_frame, 0.0_wp, 0.0_wp)   ! the input pivot
      do loop = 1, mechanism%nloop
         do a = 1, mechanism%loops(loop)%arcs
            call find_place(mechanism%seq(loop, a))
         end do
         ! what slides on a link may carry an arc of the same direction, and belongs to it as little
         do a = 1, mechanism%loops(loop)%arcs
            n = mechanism%seq(loop, a)
            if (slides(n) .and. mechanism%arcs(n)%reference > 0) loose(mechanism%arcs(mechanism%arcs(n)%reference)%body) = .true.
         end do
         p = mechanism%place(1, loop)
         q = mechanism%place(2, loop)
         here = 1
         do a = 1, p
            here = follow(mechanism%seq(loop, a), here, 1.0_wp)
         end do
         there = 1
         do a = mechanism%loops(loop)%arcs, q + 1, -1
            there = follow(mechanism%seq(loop, a), there, -1.0_wp)
         end do
         n = mechanism%seq(loop, q)
         joints%start(n) = here
         joints%finish(n) = there
         if (mechanism%arcs(n)%kind == arc_link .and. here > 0 .and. there > 0) then
            call seat(here, mechanism%arcs(n)%body, 0.0_wp, 0.0_wp)
            call seat(there, mechanism%arcs(n)%body, length(n), 0.0_wp)
         else
            loose(mechanism%arcs(n)%body) = .true.
         end if
      end do

   contains

      !> Direction of an arc in the axes of its body, and its length.
      subroutine find_place(n)
         integer, intent(in) :: n

         angle(n) = mechanism%angle_on_body(n, dimensions)
         associate (arc => mechanism%arcs(n))
            if (arc%kind == arc_determined .and. arc%same .and. arc%reference > 0) length(n) = length(arc%reference)
         end associate
      end subroutine find_place

      !> The joint at the other end of an arc; 0 if it has no fixed place.
      integer function follow(n, from, sense)
         integer, intent(in) :: n, from
         real(wp), intent(in) :: sense   !! +1: along the arc, -1: against it
         integer :: s, root
         real(wp) :: c, d, x, y

         follow = 0
         root = mechanism%arcs(n)%body
         associate (arc => mechanism%arcs(n))
            if (slides(n)) then
               loose(root) = .true.
            else if (from == 0) then
               loose(root) = .true.
            else
               s = seat_of(from, root)
               if (s == 0 .and. (arc%kind == arc_crank .or. arc%kind == arc_link)) then
                  call seat(from, root, 0.0_wp, 0.0_wp)
                  s = filled
               end if
               if (s == 0) then
                  joints%astray(n) = .not. loose(root) .and. arc%kind == arc_determined
                  loose(root) = .true.
               else
                  call unit_vector(angle(n), c, d)
                  x = seats(s)%x + sense*length(n)*c
                  y = seats(s)%y + sense*length(n)*d
                  follow = node_at(root, x, y)
                  if (follow == 0) then
                     nodes = nodes + 1
                     follow = nodes
                     call seat(follow, root, x, y)
                  end if
               end if
            end if
         end associate
         if (sense > 0.0_wp) then
            joints%start(n) = from
            joints%finish(n) = follow
         else
            joints%start(n) = follow
            joints%finish(n) = from
         end if
      end function follow

      !> True for an arc whose length is a result, and for an arc that hangs on one.
      logical function slides(n)
         integer, intent(in) :: n

         slides = mechanism%arcs(n)%body /= body_frame
         if (slides) slides = any(mechanism%arcs(mechanism%bodies(mechanism%arcs(n)%body)%axis)%kind == [arc_slide, arc_actuator])
      end function slides

      subroutine seat(node, root, x, y)
         integer, intent(in) :: node, root
         real(wp), intent(in) :: x, y

         if (filled == size(seats)) then
            seats = [seats, seats]
            next = [next, next]
         end if
         filled = filled + 1
         seats(filled) = seat_t(node, root, x, y)
         next(filled) = last(root)
         last(root) = filled
      end subroutine seat

      !> The seat of a joint on a body; 0 if it has none there.
      integer function seat_of(node, root)
         integer, intent(in) :: node, root

         seat_of = last(root)
         do while (seat_of > 0)
            if (seats(seat_of)%node == node) return
            seat_of = next(seat_of)
         end do
      end function seat_of

      !> The joint of a body at a place; 0 if there is none.
      integer function node_at(root, x, y)
         integer, intent(in) :: root
         real(wp), intent(in) :: x, y
         integer :: s

         node_at = 0
         s = last(root)
         do while (s > 0)
            if (hypotenuse(seats(s)%x - x, seats(s)%y - y) <= near) node_at = seats(s)%node
            s = next(s)
         end do
      end function node_at
   end subroutine find_joints
end module psalm_joints
