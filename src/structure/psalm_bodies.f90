!> Rigid bodies and joints of a mechanism, from its topology alone.
!>
!> The frame, the input link and the two links of each dyad are bodies. A determined arc belongs to the body of the arc it
!> hangs on, so that a link that appears as several arcs in several loops is one body. A sliding arc belongs to the body that
!> slides; its foot, the end at which its guide meets it, is a point of the guide's body. Two bodies on a prismatic joint
!> have the same direction and are two bodies all the same. Source: Oldham (1977), section 15.1.
module psalm_bodies
   use psalm_dyad_kind, only: direction_known, form_of, form_t
   use psalm_mechanism, only: mechanism_t, body_t, joint_t, joined_t, arc_determined, arc_slide, arc_crank, at_start, at_finish, &
                              body_frame, joint_gear, joint_prismatic, joint_revolute, pivot
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: assign_bodies, find_joints_of_bodies

   integer, parameter :: body_input = 2    !! the input link, if there is one

   !> Points of bodies while they are found: a list for each point.
   type :: seats_t
      integer, allocatable :: body(:)      !! by seat
      integer, allocatable :: before(:)    !! by seat: the seat noted before it at the same point, 0: none
      integer, allocatable :: last(:)      !! by point: its last seat
      integer :: count = 0
   end type seats_t

contains

   !> The bodies, and which of them every arc belongs to.
   pure subroutine assign_bodies(mechanism)
      type(mechanism_t), intent(inout) :: mechanism
      integer :: n, loop, which, body

      allocate (mechanism%bodies(body_input + sum([(size(mechanism%groups(loop)%members), loop=1, mechanism%nloop)]) + &
                                 size(mechanism%actuators)))
      mechanism%bodies(body_frame)%name = 'frame'
      body = body_frame
      if (.not. mechanism%floating_input) then
         mechanism%bodies(body_input)%name = trim(merge('crank', 'input', mechanism%arcs(1)%kind == arc_crank))
         mechanism%bodies(body_input)%axis = 1
         body = body_input
      end if
      do loop = 1, mechanism%nloop
         do which = 1, size(mechanism%groups(loop)%members)
            n = mechanism%groups(loop)%members(which)
            if (second_of(n) > 0) then
               mechanism%arcs(n)%body = second_of(n)
               cycle
            end if
            body = body + 1
            mechanism%bodies(body)%axis = n
            mechanism%bodies(body)%name = 'arc '//to_text(mechanism%arcs(n)%place)//' of loop '//to_text(loop)
         end do
      end do
      do which = merge(1, 2, mechanism%floating_input), size(mechanism%actuators)
         n = mechanism%actuators(which)%arc
         if (n == 0) cycle
         body = body + 1
         mechanism%bodies(body)%axis = n
         if (mechanism%is_cylinder(n)) then
            mechanism%bodies(body)%is_rod = .true.
            mechanism%bodies(body)%name = 'rod '//to_text(which)
            mechanism%arcs(n)%rod = body
            cycle
         end if
         mechanism%bodies(body)%name = trim(merge('input', 'crank', mechanism%actuators(which)%slides))//' '//to_text(which)
      end do
      mechanism%bodies = mechanism%bodies(:body)
      do body = body_input, size(mechanism%bodies)
         if (.not. mechanism%bodies(body)%is_rod) mechanism%arcs(mechanism%bodies(body)%axis)%body = body
      end do
      do n = 1, size(mechanism%arcs)
         if (mechanism%arcs(n)%kind /= arc_determined) cycle
         mechanism%arcs(n)%body = body_frame
         if (.not. mechanism%arcs(n)%frame) mechanism%arcs(n)%body = mechanism%arcs(mechanism%arcs(n)%reference)%body
      end do
      call list_arcs(mechanism)

   contains

      !> The body of an arc's link, if a link of a sketch has another unknown arc before: it slides in a ring of slides. 0: none.
      pure integer function second_of(arc) result(earlier)
         integer, intent(in) :: arc

         if (mechanism%arcs(arc)%kind == arc_slide .and. mechanism%arcs(arc)%link > 0) then
            do earlier = body, body_input, -1
               if (mechanism%bodies(earlier)%axis == 0) cycle
               if (mechanism%arcs(mechanism%bodies(earlier)%axis)%link == mechanism%arcs(arc)%link) return
            end do
         end if
         earlier = 0
      end function second_of
   end subroutine assign_bodies

   !> The arcs of every body.
   pure subroutine list_arcs(mechanism)
      type(mechanism_t), intent(inout) :: mechanism
      integer :: members(size(mechanism%bodies)), n, body

      members = 0
      do n = 1, size(mechanism%arcs)
         body = mechanism%arcs(n)%body
         members(body) = members(body) + 1
      end do
      do body = 1, size(mechanism%bodies)
         allocate (mechanism%bodies(body)%arcs(members(body)))
      end do
      members = 0
      do n = 1, size(mechanism%arcs)
         body = mechanism%arcs(n)%body
         members(body) = members(body) + 1
         mechanism%bodies(body)%arcs(members(body)) = n
      end do
   end subroutine list_arcs

   !> Feet of slides, points of bodies, and the joints between them. The chain must be there.
   pure subroutine find_joints_of_bodies(mechanism)
      type(mechanism_t), intent(inout) :: mechanism
      integer :: loop

      call find_feet(mechanism)
      call find_points_of_bodies(mechanism)
      allocate (mechanism%joints(merge(0, 1, mechanism%floating_input)))
      if (.not. mechanism%floating_input) call add_input_joint(mechanism)
      call add_joints_of_drives(mechanism)
      do loop = 1, mechanism%nloop
         if (mechanism%is_dyad(loop)) then
            call add_joints_of_dyad(mechanism, loop)
         else
            call add_joints_of_group(mechanism, loop)
         end if
      end do
   end subroutine find_joints_of_bodies

   !> The end at which its guide meets a slide: that of the prismatic joint. One guided by its partner slides in the common joint
   !> of the two, one of known direction in the outer joint, the actuator in the input pivot.
   pure subroutine find_feet(mechanism)
      type(mechanism_t), intent(inout) :: mechanism
      type(form_t) :: form
      integer :: n, slide

      do n = 1, size(mechanism%arcs)
         if (.not. mechanism%slides(n)) cycle
         slide = mechanism%arcs(n)%representative
         if (mechanism%arcs(slide)%turn == 0 .and. mechanism%arcs(slide)%foot > 0) then
            mechanism%arcs(n)%foot = mechanism%arcs(slide)%foot
            if (n == slide) cycle
         else
            mechanism%arcs(n)%foot = at_start
         end if
         if (mechanism%arcs(slide)%turn /= 0 .and. mechanism%arcs(slide)%kind == arc_slide) then
            associate (which => mechanism%arcs(slide)%dyad)
               form = form_of(mechanism%groups(mechanism%arcs(slide)%loop)%kind)
               if ((form%direction(which) == direction_known) .neqv. which == 1) mechanism%arcs(n)%foot = at_finish
            end associate
         end if
         if (mechanism%arcs(n)%reversed) mechanism%arcs(n)%foot = at_start + at_finish - mechanism%arcs(n)%foot
      end do
   end subroutine find_feet

   ! ---- points ------------------------------------------------------------------------------------------------------

   !> The points of every body. An arc of a sketch has joints of its link; a determined arc, and one that repeats a slide, adds
   !> its ends where one of them is known to be a point of its body; one of which neither is ever known is only
   !> parallel to its body. (A slide may be repeated anywhere: its copy on a frame pivot, say, has its moving end where its original
   !> has its foot.)
   pure subroutine find_points_of_bodies(mechanism)
      type(mechanism_t), intent(inout) :: mechanism
      type(seats_t) :: seats
      integer :: n, ends(2), bodies(2)
      logical :: more

      allocate (seats%body(2*size(mechanism%arcs) + 1), seats%before(2*size(mechanism%arcs) + 1), source=0)
      allocate (seats%last(size(mechanism%points)), source=0)
      call seat(seats, body_frame, pivot)
      do n = 1, size(mechanism%arcs)
         associate (arc => mechanism%arcs(n))
            if (arc%kind == arc_determined .or. arc%representative /= n) cycle
            call ends_and_bodies(n, ends, bodies)
            ! that a foot is a point of its guide is for the guide's own arcs to say
            if (arc%foot /= at_start) call seat(seats, bodies(1), ends(1))
            if (arc%foot /= at_finish) call seat(seats, bodies(2), ends(2))
         end associate
         mechanism%arcs(n)%attached = .true.
      end do
      more = .true.
      do while (more)
         more = .false.
         do n = 1, size(mechanism%arcs)
            if (mechanism%arcs(n)%attached) cycle
            call ends_and_bodies(n, ends, bodies)
            if (.not. (is_seated(seats, bodies(1), ends(1)) .or. is_seated(seats, bodies(2), ends(2)) .or. &
                       joins_points(n))) cycle
            call seat(seats, bodies(1), ends(1))
            call seat(seats, bodies(2), ends(2))
            mechanism%arcs(n)%attached = .true.
            more = .true.
         end do
      end do
      call list_points(seats, mechanism%bodies)

   contains

      !> The points at the ends of an arc, and the bodies they are points of: the foot of a slide is one of its guide's.
      pure subroutine ends_and_bodies(n, ends, bodies)
         integer, intent(in) :: n
         integer, intent(out) :: ends(2), bodies(2)

         ends = mechanism%arcs(n)%ends
         bodies = mechanism%arcs(n)%body
         if (mechanism%arcs(n)%foot > 0) bodies(mechanism%arcs(n)%foot) = mechanism%guide_of(n)
      end subroutine ends_and_bodies

      !> True of an arc of a sketch from or to a point of its link.
      pure logical function joins_points(n)
         integer, intent(in) :: n

         associate (arc => mechanism%arcs(n))
            joins_points = arc%foot == 0 .and. any(arc%marks > 0)
         end associate
      end function joins_points
   end subroutine find_points_of_bodies

   pure subroutine seat(seats, body, point)
      type(seats_t), intent(inout) :: seats
      integer, intent(in) :: body, point

      if (is_seated(seats, body, point)) return
      seats%count = seats%count + 1
      seats%body(seats%count) = body
      seats%before(seats%count) = seats%last(point)
      seats%last(point) = seats%count
   end subroutine seat

   pure logical function is_seated(seats, body, point)
      type(seats_t), intent(in) :: seats
      integer, intent(in) :: body, point
      integer :: s

      is_seated = .true.
      s = seats%last(point)
      do while (s > 0)
         if (seats%body(s) == body) return
         s = seats%before(s)
      end do
      is_seated = .false.
   end function is_seated

   !> Points body by body, in rising order.
   pure subroutine list_points(seats, bodies)
      type(seats_t), intent(in) :: seats
      type(body_t), intent(inout) :: bodies(:)
      integer :: filled(size(bodies)), point, s, body

      filled = 0
      do s = 1, seats%count
         filled(seats%body(s)) = filled(seats%body(s)) + 1
      end do
      do body = 1, size(bodies)
         allocate (bodies(body)%points(filled(body)))
      end do
      filled = 0
      do point = 1, size(seats%last)
         s = seats%last(point)
         do while (s > 0)
            body = seats%body(s)
            filled(body) = filled(body) + 1
            bodies(body)%points(filled(body)) = point
            s = seats%before(s)
         end do
      end do
   end subroutine list_points

   ! ---- joints ------------------------------------------------------------------------------------------------------

   !> The joint of the first actuator, between frame and input link.
   pure subroutine add_input_joint(mechanism)
      type(mechanism_t), intent(inout) :: mechanism

      associate (joint => mechanism%joints(1))
         joint%name = 'IN'
         joint%bodies = [body_frame, body_input]
         joint%arc = 1
         joint%end = at_start
         joint%point = pivot
         joint%pin = pivot
         if (mechanism%sliding_input) then
            joint%kind = joint_prismatic
            joint%slide = 1
         end if
         joint%attached = .true.
      end associate
   end subroutine add_input_joint

   !> Joints of drives after the first that move links on the frame.
   pure subroutine add_joints_of_drives(mechanism)
      type(mechanism_t), intent(inout) :: mechanism
      integer :: d, body

      do d = 2, size(mechanism%actuators)
         associate (pair => mechanism%actuators(d)%pair)
            if (pair%arc == 0) cycle
            mechanism%joints = [mechanism%joints, joint_t()]
            mechanism%actuators(d)%joint = size(mechanism%joints)
            body = mechanism%arcs(mechanism%actuators(d)%arc)%body
            call set_joint(mechanism, size(mechanism%joints), 'IN', d, [body_frame, body], pair%arc, pair%end, pair%slide)
            mechanism%joints(size(mechanism%joints))%group = 0
         end associate
      end do
   end subroutine add_joints_of_drives

   !> The three joints of a dyad: S at the start of p, M between p and q, E at the finish of q.
   pure subroutine add_joints_of_dyad(mechanism, loop)
      type(mechanism_t), intent(inout) :: mechanism
      integer, intent(in) :: loop
      type(form_t) :: form
      integer :: p, q, first, before, after, guide

      p = mechanism%groups(loop)%members(1)
      q = mechanism%groups(loop)%members(2)
      form = form_of(mechanism%groups(loop)%kind)
      first = size(mechanism%joints) + 1
      mechanism%joints = [mechanism%joints, joint_t(), joint_t(), joint_t()]
      mechanism%groups(loop)%joints = [first, first + 1, first + 2]
      before = body_frame
      if (mechanism%arcs(p)%place > 1) before = mechanism%body_at(p - 1, at_finish)
      after = mechanism%body_at(q + 1, at_start)
      guide = merge(p, 0, form%slides(1) .and. form%direction(1) == direction_known)
      if (guide > 0) before = mechanism%guide_of(p)
      call set_joint(mechanism, first, 'S', loop, [before, mechanism%arcs(p)%body], p, at_start, guide)
      guide = merge(q, 0, form%slides(2) .and. form%direction(2) == direction_known)
      if (guide > 0) after = mechanism%guide_of(q)
      call set_joint(mechanism, first + 2, 'E', loop, [after, mechanism%arcs(q)%body], q, at_finish, guide)
      guide = 0
      if (form%slides(1) .and. form%direction(1) /= direction_known) guide = p
      if (form%slides(2) .and. form%direction(2) /= direction_known) guide = q
      call set_joint(mechanism, first + 1, 'M', loop, [mechanism%arcs(p)%body, mechanism%arcs(q)%body], p, at_finish, guide)
   end subroutine add_joints_of_dyad

   !> The joints of a larger group.
   pure subroutine add_joints_of_group(mechanism, loop)
      type(mechanism_t), intent(inout) :: mechanism
      integer, intent(in) :: loop
      integer :: k, first

      first = size(mechanism%joints)
      associate (pairs => mechanism%groups(loop)%pairs)
         mechanism%joints = [mechanism%joints, (joint_t(), k=1, size(pairs))]
         mechanism%groups(loop)%joints = [(first + k, k=1, size(pairs))]
         do k = 1, size(pairs)
            call set_joint(mechanism, first + k, 'G'//to_text(k)//'.', loop, bodies_of(pairs(k)), pairs(k)%arc, pairs(k)%end, &
                           pairs(k)%slide)
         end do
      end associate
      if (.not. allocated(mechanism%groups(loop)%ties)) return
      associate (ties => mechanism%groups(loop)%ties)
         do k = 1, size(ties)
            if (ties(k)%drive > 0 .or. ties(k)%of_slides) cycle
            mechanism%joints = [mechanism%joints, joint_t()]
            ties(k)%joint = size(mechanism%joints)
            associate (joint => mechanism%joints(size(mechanism%joints)))
               joint%name = 'T'//to_text(k)//'.'//to_text(loop)
               joint%kind = joint_gear
               joint%bodies = [body_of_axis(ties(k)%axes(1)), body_of_axis(ties(k)%axes(2))]
               joint%arc = maxval(ties(k)%axes(:2))
               joint%point = pivot
               if (ties(k)%centre(1) > 0) joint%point = mechanism%arcs(ties(k)%centre(1))%ends(ties(k)%centre_end(1))
               joint%group = loop
               joint%attached = .true.
            end associate
         end do
      end associate

   contains

      pure integer function body_of_axis(arc) result(body)
         integer, intent(in) :: arc

         body = body_frame
         if (arc > 0) body = mechanism%arcs(arc)%body
      end function body_of_axis

      !> The bodies of a pair: what is at the foot of a cylinder is on its rod.
      pure function bodies_of(pair) result(bodies)
         type(joined_t), intent(in) :: pair
         integer :: bodies(2), side

         do side = 1, 2
            associate (arc => mechanism%arcs(pair%axes(side)))
               bodies(side) = arc%body
               if (arc%rod == 0) cycle
               if (mechanism%arcs(pair%arc)%ends(pair%end) == arc%ends(arc%foot)) bodies(side) = arc%rod
            end associate
         end do
      end function bodies_of
   end subroutine add_joints_of_group

   pure subroutine set_joint(mechanism, number, letter, loop, bodies, arc, end, slide)
      type(mechanism_t), intent(inout) :: mechanism
      integer, intent(in) :: number
      character(*), intent(in) :: letter
      integer, intent(in) :: loop, bodies(2), arc, end
      integer, intent(in) :: slide      !! the arc it slides along, 0: it turns
      integer :: carrier

      associate (joint => mechanism%joints(number))
         joint%name = letter//to_text(loop)
         joint%kind = merge(joint_prismatic, joint_revolute, slide > 0)
         joint%bodies = bodies
         joint%arc = arc
         joint%end = end
         joint%point = mechanism%arcs(arc)%ends(end)
         joint%pin = joint%point
         joint%slide = slide
         joint%group = loop
      end associate
      if (slide > 0) then
         carrier = mechanism%guide_of(slide)
         mechanism%joints(number)%attached = mechanism%has_point(carrier, mechanism%joints(number)%point)
      else
         ! a joint of a sketch may be several points of the loops
         mechanism%joints(number)%attached = (mechanism%has_point(bodies(1), mechanism%joints(number)%point) .and. &
                                              mechanism%has_point(bodies(2), mechanism%joints(number)%point)) .or. &
                                             mechanism%arcs(arc)%joints(end) > 0
      end if
   end subroutine set_joint
end module psalm_bodies
