!> The solution plan: what must be computed, in order, for the output a linkage is wanted for.
!>
!> Every arc has a direction: that of a *root* turned by a fixed angle. Roots are the frame's x axis, the crank and, per
!> dyad, the links whose direction the dyad finds. Every joint is a *point*: an earlier point plus or minus an arc. Equal
!> points are made once, though many loops run through them. Loops the output does not depend on are not in the plan
!> (unless everything is asked for).
module psalm_plan
   use psalm_dyad_kind, only: direction_found, direction_known, direction_of_partner, form_of, form_t
   use psalm_kinds, only: wp
   use psalm_output_kind, only: output_kind_t, output_kind
   use psalm_mechanism, only: mechanism_t, linkage_group_t, ring_t, arc_determined, arc_link, arc_slide, arc_crank, arc_actuator
   implicit none (type, external)
   private
   public :: plan_t, make_plan
   public :: step_point, step_dyad, root_frame, root_crank, origin

   integer, parameter :: step_point = 1  !! point = point +- arc
   integer, parameter :: step_dyad = 2   !! solve a loop: a dyad or a larger group

   integer, parameter :: root_frame = 1  !! the root that is the machine's x axis
   integer, parameter :: root_crank = 2  !! the root that is the input link
   integer, parameter :: origin = 0      !! the point that is the input pivot

   !> A ring of a larger group without the arcs that are known before it.
   type :: open_ring_t
      integer :: from = 0, to = 0          !! points that the rest leads from and to
      integer :: first = 0, last = 0       !! sequential numbers of the arcs of the rest
   end type open_ring_t

   !> One step of the plan.
   type :: step_t
      integer :: kind = 0
      integer :: loop = 0       !! of a dyad, its loop
      integer :: from = 0       !! point step: point to start from; dyad: point S
      integer :: to = 0         !! point step: point made; dyad: point E
      integer :: arc = 0        !! point step: sequential number of the arc
      integer :: sense = 1      !! point step: +1 along the arc, -1 against it
      logical :: fixed = .false. !! point step: the point belongs to the frame
      type(open_ring_t), allocatable :: rings(:) !! of a larger group
   end type step_t

   type :: plan_t
      integer :: nroots = 2                    !! roots, frame and crank included
      integer :: npoints = 0                   !! points, the origin not counted
      integer :: nlengths = 0                  !! varying lengths
      integer, allocatable :: root(:)          !! by sequential number: root of the arc's direction
      integer, allocatable :: base(:)          !! by sequential number: arc its angle is counted from, 0: from the root
      integer, allocatable :: quarter(:)       !! by sequential number: right angles to add to it
      logical, allocatable :: takes_gama(:)    !! by sequential number: GAMA is to be added to it
      integer, allocatable :: order(:)         !! arcs in an order in which `base` comes first
      integer, allocatable :: length_slot(:)   !! by sequential number: varying length, 0: ARCL
      integer, allocatable :: root_loop(:)     !! by root: the loop that finds it, 0: none
      logical, allocatable :: solved(:)        !! by loop: it is in the plan
      type(step_t), allocatable :: steps(:)
      integer, allocatable :: dyad_root(:, :)  !! shape (2, nloop): roots found by the dyad, 0: none
      integer, allocatable :: drive_root(:)    !! by actuator: the root that it turns, 0: none
      integer, allocatable :: drive_slot(:)    !! by actuator: the varying length that it sets, 0: none
      integer :: output_point = origin         !! point the output arc starts from
      logical, allocatable :: used(:)          !! by root: something after its dyad needs it
      integer, allocatable :: joint_points(:)  !! points of the joints that were asked for
   end type plan_t

contains

   !> Compile the plan for one kind of output.
   function make_plan(mechanism, motion, everything, all_roots, joints) result(plan)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: motion        !! MOTION
      logical, intent(in) :: everything    !! solve every loop, wanted or not
      logical, intent(in) :: all_roots     !! find both directions of every link pair (derivatives and tables need them)
      integer, intent(in), optional :: joints(:, :) !! shape (2, joints): loop and arc; the finish of the arc is wanted (arc 0:
                                           !! the input pivot); their loops must be solved
      type(plan_t) :: plan
      type(output_kind_t) :: kind
      type(ring_t) :: ring
      integer :: loop, a, n, point

      call assign_roots(mechanism, plan)
      allocate (plan%solved(mechanism%nloop), source=everything)
      call mark_output(mechanism, motion, plan)
      do loop = mechanism%nloop, 1, -1
         if (.not. plan%solved(loop)) cycle
         do a = 1, mechanism%loops(loop)%arcs
            call mark_arc(mechanism, mechanism%seq(loop, a), loop, plan)
         end do
         if (.not. allocated(mechanism%groups(loop)%ties)) cycle
         do a = 1, size(mechanism%groups(loop)%ties)
            associate (arcs => mechanism%groups(loop)%ties(a)%arcs)
               do n = 1, size(arcs)
                  if (arcs(n) > 0) call mark_arc(mechanism, arcs(n), loop, plan)
               end do
            end associate
         end do
      end do
      allocate (plan%steps(0))
      do loop = 1, mechanism%nloop
         if (.not. plan%solved(loop)) cycle
         if (mechanism%is_dyad(loop)) then
            call add_loop(mechanism, loop, plan)
         else
            call add_higher_group(mechanism, loop, plan)
         end if
      end do
      kind = output_kind(motion)
      if (kind%has_point) call add_output(mechanism, plan)
      allocate (plan%joint_points(0))
      if (present(joints)) then
         do a = 1, size(joints, 2)
            n = mechanism%seq(joints(1, a), joints(2, a))
            ring = mechanism%ring_of(joints(1, a), max(n, mechanism%loops(joints(1, a))%first))
            call add_joint(mechanism, ring, n, n <= ring%turn, plan, point)
            plan%joint_points = [plan%joint_points, point]
         end do
      end if
      call mark_roots(mechanism, all_roots, plan)
   end function make_plan

   !> A dyad need not find directions that nothing hangs on.
   pure subroutine mark_roots(mechanism, all_roots, plan)
      type(mechanism_t), intent(in) :: mechanism
      logical, intent(in) :: all_roots
      type(plan_t), intent(inout) :: plan
      integer :: k, n, which

      allocate (plan%used(plan%nroots), source=all_roots)
      plan%used(plan%root(mechanism%outputs(1)%arc)) = .true.
      do k = 1, size(plan%steps)
         associate (step => plan%steps(k))
            if (step%kind == step_point) then
               plan%used(plan%root(step%arc)) = .true.
            else if (allocated(step%rings)) then
               do which = 1, size(step%rings)
                  do n = step%rings(which)%first, step%rings(which)%last
                     plan%used(plan%root(n)) = .true.
                  end do
               end do
               call mark_ties(mechanism%groups(step%loop), plan)
            else
               do which = 1, 2
                  n = mechanism%groups(step%loop)%members(which)
                  ! the direction of a slide is wanted by its own dyad, that of a link only by what hangs on it
                  if (plan%root_loop(plan%root(n)) /= step%loop) plan%used(plan%root(n)) = .true.
               end do
            end if
         end associate
      end do
   end subroutine mark_roots

   !> The directions that a larger group's ties need.
   pure subroutine mark_ties(group, plan)
      type(linkage_group_t), intent(in) :: group
      type(plan_t), intent(inout) :: plan
      integer :: i, j

      if (.not. allocated(group%ties)) return
      do i = 1, size(group%ties)
         do j = 1, size(group%ties(i)%arcs)
            if (group%ties(i)%arcs(j) > 0) plan%used(plan%root(group%ties(i)%arcs(j))) = .true.
         end do
      end do
   end subroutine mark_ties

   ! ---- directions --------------------------------------------------------------------------------------------------

   !> Root and angle rule of every arc.
   subroutine assign_roots(mechanism, plan)
      type(mechanism_t), intent(in) :: mechanism
      type(plan_t), intent(inout) :: plan
      type(form_t) :: form
      integer :: loop, a, n, count, p, q

      n = size(mechanism%arcs)
      allocate (plan%root(n), plan%base(n), plan%quarter(n), plan%length_slot(n), source=0)
      allocate (plan%takes_gama(n), source=.false.)
      allocate (plan%order(n), source=0)
      allocate (plan%root_loop(2 + size(mechanism%actuators) + &
                               sum([(size(mechanism%groups(loop)%members), loop=1, mechanism%nloop)])), source=0)
      allocate (plan%drive_root(size(mechanism%actuators)), plan%drive_slot(size(mechanism%actuators)), source=0)
      allocate (plan%dyad_root(2, mechanism%nloop), source=0)
      count = 0
      do loop = 1, mechanism%nloop
         if (mechanism%is_dyad(loop)) then
            call place_dyad()
         else
            associate (members => mechanism%groups(loop)%members)
               do a = 1, size(members)
                  if (any(mechanism%arcs(members(a))%kind == [arc_link, arc_actuator])) call found_by_group(members(a))
               end do
            end associate
            do a = 1, mechanism%loops(loop)%arcs
               call place_arc(mechanism%seq(loop, a))
            end do
         end if
         do a = 1, mechanism%loops(loop)%arcs
            n = mechanism%seq(loop, a)
            select case (mechanism%arcs(n)%kind)
            case (arc_slide, arc_actuator)
               plan%nlengths = plan%nlengths + 1
               plan%length_slot(n) = plan%nlengths
               if (mechanism%arcs(n)%kind == arc_actuator) plan%drive_slot(mechanism%arcs(n)%drive) = plan%nlengths
            case (arc_determined)
               plan%length_slot(n) = plan%length_slot(mechanism%arcs(n)%representative)
            end select
         end do
      end do
      plan%order = plan%order(:count)

   contains

      !> The arcs of a loop that closes a dyad.
      subroutine place_dyad()
         do a = 1, mechanism%loops(loop)%arcs
            n = mechanism%seq(loop, a)
            if (mechanism%arcs(n)%dyad == 0) call place_arc(n)
         end do
         p = mechanism%groups(loop)%members(1)
         q = mechanism%groups(loop)%members(2)
         form = form_of(mechanism%groups(loop)%kind)
         call direct(1)
         call direct(2)
         if (form%direction(1) == direction_of_partner) call turned(p, q, mechanism%arcs(p)%turn)
         if (form%direction(2) == direction_of_partner) call turned(q, p, merge(mechanism%arcs(q)%turn, -mechanism%arcs(p)%turn, &
                                                                                form%slides(2)))
      end subroutine place_dyad

      !> Direction of arc p (1) or q (2) of the dyad, unless it hangs on the other.
      subroutine direct(which)
         integer, intent(in) :: which

         associate (arc => merge(p, q, which == 1))
            select case (form%direction(which))
            case (direction_found)
               call found_by_group(arc)
               plan%dyad_root(which, loop) = plan%nroots
            case (direction_known)
               call turned(arc, mechanism%arcs(arc)%reference, mechanism%arcs(arc)%turn)
            end select
         end associate
      end subroutine direct

      !> A determined arc or the input, after the arc it hangs on (a later one of its loop, if that is a frame arc).
      recursive subroutine place_arc(n)
         integer, intent(in) :: n

         if (plan%root(n) > 0) return
         associate (arc => mechanism%arcs(n))
            if (arc%reference > 0) call place_arc(arc%reference)
            select case (arc%kind)
            case (arc_crank)
               if (arc%drive == 1) then
                  plan%drive_root(1) = root_crank
               else if (plan%drive_root(arc%drive) == 0) then
                  plan%nroots = plan%nroots + 1
                  plan%drive_root(arc%drive) = plan%nroots
               end if
               plan%root(n) = plan%drive_root(arc%drive)
            case (arc_actuator, arc_slide)
               if (arc%turn /= 0) then
                  call turned(n, arc%reference, arc%turn)
                  return
               end if
               plan%root(n) = plan%root(arc%reference)
               plan%base(n) = arc%reference
               plan%takes_gama(n) = .true.
            case default
               if (arc%reference == 0) then
                  plan%root(n) = root_frame
               else
                  plan%root(n) = plan%root(arc%reference)
                  plan%base(n) = arc%reference
               end if
               plan%takes_gama(n) = .not. arc%same
            end select
         end associate
         count = count + 1
         plan%order(count) = n
      end subroutine place_arc

      subroutine turned(n, reference, quarters)
         integer, intent(in) :: n, reference, quarters

         plan%root(n) = plan%root(reference)
         plan%base(n) = reference
         plan%quarter(n) = quarters
         count = count + 1
         plan%order(count) = n
      end subroutine turned

      subroutine found_by_group(n)
         integer, intent(in) :: n

         plan%nroots = plan%nroots + 1
         plan%root(n) = plan%nroots
         plan%root_loop(plan%nroots) = loop
         count = count + 1
         plan%order(count) = n
      end subroutine found_by_group
   end subroutine assign_roots

   ! ---- what is wanted ----------------------------------------------------------------------------------------------

   !> Mark the loops that find an arc's direction and length, apart from the loop `within` itself.
   pure subroutine mark_arc(mechanism, n, within, plan)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: n, within
      type(plan_t), intent(inout) :: plan
      integer :: loop

      loop = plan%root_loop(plan%root(n))
      if (loop > 0 .and. loop /= within) plan%solved(loop) = .true.
      if (plan%length_slot(n) > 0) then
         loop = mechanism%loop_of(mechanism%arcs(n)%representative)
         if (loop /= within .and. mechanism%arcs(mechanism%arcs(n)%representative)%kind == arc_slide) plan%solved(loop) = .true.
      end if
   end subroutine mark_arc

   pure subroutine mark_output(mechanism, motion, plan)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: motion
      type(plan_t), intent(inout) :: plan
      type(output_kind_t) :: kind
      type(ring_t) :: ring
      integer :: last, n
      logical :: forwards

      call mark_arc(mechanism, mechanism%outputs(1)%arc, 0, plan)
      kind = output_kind(motion)
      if (.not. kind%has_point) return
      call output_chain(mechanism, ring, last, forwards)
      if (forwards) then
         do n = ring%first, last
            call mark_arc(mechanism, n, 0, plan)
         end do
      else
         do n = ring%last, last + 1, -1
            call mark_arc(mechanism, n, 0, plan)
         end do
      end if
   end subroutine mark_output

   !> The joint the output arc starts from is the finish of arc `last`: reached forwards from the pivot, or backwards.
   pure subroutine output_chain(mechanism, ring, last, forwards)
      type(mechanism_t), intent(in) :: mechanism
      type(ring_t), intent(out) :: ring
      integer, intent(out) :: last         !! sequential number
      logical, intent(out) :: forwards

      associate (output => mechanism%outputs(1))
         ring = mechanism%ring_of(mechanism%loop_of(output%arc), output%arc)
         last = output%arc
         if (output%from_start) last = last - 1
         forwards = last <= ring%turn
      end associate
   end subroutine output_chain

   ! ---- steps -------------------------------------------------------------------------------------------------------

   pure subroutine add_loop(mechanism, loop, plan)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop
      type(plan_t), intent(inout) :: plan
      integer :: a, start, finish
      type(step_t) :: step

      start = origin
      do a = 1, mechanism%place(1, loop) - 1
         call add_point(mechanism, start, mechanism%seq(loop, a), 1, plan, start)
      end do
      finish = origin
      do a = mechanism%loops(loop)%arcs, mechanism%place(2, loop) + 1, -1
         call add_point(mechanism, finish, mechanism%seq(loop, a), -1, plan, finish)
      end do
      step%kind = step_dyad
      step%loop = loop
      step%from = start
      step%to = finish
      plan%steps = [plan%steps, step]
   end subroutine add_loop

   !> A larger group: of each ring the arcs that are known before it are left to points.
   pure subroutine add_higher_group(mechanism, loop, plan)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop
      type(plan_t), intent(inout) :: plan
      type(step_t) :: step
      integer :: r, n, closed

      step%kind = step_dyad
      step%loop = loop
      associate (rings => mechanism%loops(loop)%rings)
         allocate (step%rings(count(rings%closed)))
         closed = 0
         do r = 1, size(rings)
            if (.not. rings(r)%closed) cycle
            closed = closed + 1
            associate (open => step%rings(closed))
               open%from = origin
               open%first = rings(r)%first
               do n = rings(r)%first, rings(r)%last
                  if (is_found_here(n)) exit
                  call add_point(mechanism, open%from, n, 1, plan, open%from)
                  open%first = n + 1
               end do
               open%to = origin
               open%last = rings(r)%last
               do n = rings(r)%last, open%first, -1
                  if (is_found_here(n)) exit
                  call add_point(mechanism, open%to, n, -1, plan, open%to)
                  open%last = n - 1
               end do
            end associate
         end do
      end associate
      plan%steps = [plan%steps, step]

   contains

      !> True if the group finds the direction or the length of an arc.
      pure logical function is_found_here(n)
         integer, intent(in) :: n
         integer :: length

         is_found_here = plan%root_loop(plan%root(n)) == loop
         length = mechanism%arcs(n)%representative
         if (mechanism%arcs(length)%kind == arc_slide) is_found_here = is_found_here .or. mechanism%arcs(length)%loop == loop
      end function is_found_here
   end subroutine add_higher_group

   pure subroutine add_output(mechanism, plan)
      type(mechanism_t), intent(in) :: mechanism
      type(plan_t), intent(inout) :: plan
      type(ring_t) :: ring
      integer :: last
      logical :: forwards

      call output_chain(mechanism, ring, last, forwards)
      call add_joint(mechanism, ring, last, forwards, plan, plan%output_point)
   end subroutine add_output

   !> The point at the finish of an arc, reached forwards from the pivot or backwards.
   pure subroutine add_joint(mechanism, ring, last, forwards, plan, point)
      type(mechanism_t), intent(in) :: mechanism
      type(ring_t), intent(in) :: ring
      integer, intent(in) :: last          !! sequential number of the arc; the one before the ring's first: the pivot
      logical, intent(in) :: forwards
      type(plan_t), intent(inout) :: plan
      integer, intent(out) :: point
      integer :: n, next

      next = origin
      if (forwards) then
         do n = ring%first, last
            call add_point(mechanism, next, n, 1, plan, next)
         end do
      else
         do n = ring%last, last + 1, -1
            call add_point(mechanism, next, n, -1, plan, next)
         end do
      end if
      point = next
   end subroutine add_joint

   !> The point at the other end of an arc; an equal point that is already made serves again.
   pure subroutine add_point(mechanism, from, n, sense, plan, to)
      type(mechanism_t), intent(in) :: mechanism
      integer, value :: from               !! point to start from
      integer, intent(in) :: n, sense      !! arc, +1 along it, -1 against it
      type(plan_t), intent(inout) :: plan
      integer, intent(inout) :: to         !! the point
      integer :: i, arc, way
      type(step_t) :: step

      arc = mechanism%arcs(n)%representative
      way = merge(-sense, sense, mechanism%arcs(n)%reversed)
      do i = 1, size(plan%steps)
         associate (old => plan%steps(i))
            if (old%kind == step_point) then
               if (old%arc /= arc) cycle
               if (old%from == from .and. old%sense == way) then
                  to = old%to
                  return
               else if (old%to == from .and. old%sense == -way) then
                  to = old%from
                  return
               end if
            end if
         end associate
      end do
      call other_side(mechanism, from, arc, way, plan, to)
      if (to >= 0) return
      plan%npoints = plan%npoints + 1
      step%kind = step_point
      step%from = from
      step%to = plan%npoints
      step%arc = arc
      step%sense = way
      step%fixed = plan%root(arc) == root_frame .and. plan%length_slot(arc) == 0 .and. is_fixed(plan, from)
      plan%steps = [plan%steps, step]
      to = plan%npoints
   end subroutine add_point

   !> The joint of a solved dyad is reached from S along p or from E against q: the same point; -1 if not made yet.
   pure subroutine other_side(mechanism, from, arc, way, plan, to)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: from, arc, way
      type(plan_t), intent(in) :: plan
      integer, intent(out) :: to
      integer :: i, j, loop, p, q, partner

      to = -1
      if (mechanism%arcs(arc)%dyad == 0) return
      loop = mechanism%loop_of(arc)
      if (.not. mechanism%is_dyad(loop)) return
      p = mechanism%groups(loop)%members(1)
      q = mechanism%groups(loop)%members(2)
      do i = 1, size(plan%steps)
         if (plan%steps(i)%kind /= step_dyad .or. plan%steps(i)%loop /= loop) cycle
         associate (dyad => plan%steps(i))
            if (arc == p .and. way == 1 .and. from == dyad%from) then
               partner = q
            else if (arc == q .and. way == -1 .and. from == dyad%to) then
               partner = p
            else
               return
            end if
            do j = i + 1, size(plan%steps)
               associate (made => plan%steps(j))
                  if (made%kind /= step_point .or. made%arc /= partner) cycle
                  if (partner == q .and. made%from == dyad%to .and. made%sense == -1) to = made%to
                  if (partner == p .and. made%from == dyad%from .and. made%sense == 1) to = made%to
                  if (to >= 0) return
               end associate
            end do
            return
         end associate
      end do
   end subroutine other_side

   pure logical function is_fixed(plan, point)
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: point
      integer :: i

      is_fixed = point == origin
      do i = 1, size(plan%steps)
         if (plan%steps(i)%kind == step_point .and. plan%steps(i)%to == point) is_fixed = plan%steps(i)%fixed
      end do
   end function is_fixed
end module psalm_plan
