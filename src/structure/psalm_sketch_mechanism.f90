!> The arcs and groups of a mechanism from the traced loops of a sketch.
module psalm_sketch_mechanism
   use psalm_dyad_kind, only: assur_higher, kind_of_dyad, sign_of_dyad
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, actuator_t, joined_t, ring_t, tie_t, at_finish, at_start, arc_actuator, arc_crank, &
                              arc_determined, arc_link, arc_slide
   use psalm_sketch, only: frame_link
   use psalm_traced_loops, only: loops_t, traced_gear_t, traced_pair_t, traced_t, traced_actuator, traced_crank, &
                                 traced_frame, traced_link, traced_slide
   implicit none (type, external)
   private
   public :: take_traced_loops, traced_dimensions

contains

   !> Arcs, loops, groups and the actuator. Larger groups must have been traced; representatives are set, too.
   pure subroutine take_traced_loops(traced, mechanism)
      type(loops_t), intent(in) :: traced
      type(mechanism_t), intent(inout) :: mechanism
      integer :: loop, n

      mechanism%nloop = traced%loops
      allocate (mechanism%loops(traced%loops), mechanism%groups(traced%loops), mechanism%arcs(size(traced%arcs)))
      do loop = 1, traced%loops
         mechanism%loops(loop)%first = findloc(traced%arcs%loop, loop, dim=1)
         mechanism%loops(loop)%arcs = count(traced%arcs%loop == loop)
      end do
      do n = 1, size(traced%arcs)
         call take_arc(traced, n, mechanism)
      end do
      do loop = 1, traced%loops
         if (traced%is_dyad(loop)) then
            call take_dyad(traced, loop, mechanism)
         else
            call take_group(traced, loop, mechanism)
         end if
      end do
      mechanism%sliding_input = traced%sliding
      mechanism%floating_input = traced%floating
      mechanism%actuators = [actuator_t(joint=1, arc=1, slides=traced%sliding)]
      if (traced%floating) then
         n = findloc(traced%arcs%kind == traced_actuator .and. traced%arcs%drive == 1, .true., dim=1)
         mechanism%actuators(1) = actuator_t(arc=n, slides=traced%sliding)
      end if
      do n = 1, size(traced%seconds)
         associate (second => traced%seconds(n))
            mechanism%actuators = [mechanism%actuators, actuator_t(arc=second%arc, slides=second%slides, geared=second%geared, &
                                                                   ratio=second%ratio, phase=second%phase)]
            if (second%pair%links(2) > 0) mechanism%actuators(n + 1)%pair = pair_of(traced, second%pair)
         end associate
      end do
   end subroutine take_traced_loops

   !> The dimensions as drawn; the reference input is that of the drawing.
   pure type(dimensions_t) function traced_dimensions(traced) result(dimensions)
      type(loops_t), intent(in) :: traced

      dimensions%arcl = traced%arcs%arcl
      dimensions%gama = traced%arcs%gama
      dimensions%outlk = traced%outlk
      dimensions%outang = traced%outang
      dimensions%origlk = traced%origlk
      dimensions%origng = traced%origng
      dimensions%crnki = traced%input
      dimensions%drawn = traced%input
      dimensions%anchor = traced%anchor
      dimensions%aside_length = traced%joint_places%distance
      dimensions%aside_angle = traced%joint_places%turn + traced%joint_places%angle
   end function traced_dimensions

   pure subroutine take_arc(traced, n, mechanism)
      type(loops_t), intent(in) :: traced
      integer, intent(in) :: n
      type(mechanism_t), intent(inout) :: mechanism

      associate (of => traced%arcs(n), arc => mechanism%arcs(n))
         arc%loop = of%loop
         arc%place = of%place
         arc%representative = n
         arc%link = of%link
         arc%joints = merge(of%ends, 0, of%ends <= size(traced%joint_loop))
         arc%marks = merge(of%ends, 0, traced%on(of%ends, of%link))
         arc%rail = of%slide
         select case (of%kind)
         case (traced_crank)
            arc%kind = arc_crank
            arc%drive = of%drive
         case (traced_actuator)
            arc%kind = arc_actuator
            arc%drive = of%drive
            if (.not. of%cylinder) call take_guide(traced, of, arc%reference, arc%turn)
            if (of%cylinder .or. (of%guide_link > 0 .and. n > 1)) arc%foot = merge(at_finish, at_start, of%foot_last)
         case (traced_link)
            arc%kind = arc_link
         case (traced_slide)
            arc%kind = arc_slide
            call take_guide(traced, of, arc%reference, arc%turn)
            if (of%guide_link > 0) arc%foot = merge(at_finish, at_start, of%foot_last)
            ! a right angle is turned through in loop order: a guide after the slide gives the other sense
            if (of%guide_link == 0 .and. of%guide > of%place .and. .not. (of%place == 1 .and. of%guide > 2)) arc%turn = -arc%turn
         case (traced_frame)
            arc%kind = arc_determined
            arc%frame = .true.
         case default
            arc%kind = arc_determined
            arc%reference = of%reference
            arc%same = of%same
            arc%frame = of%link == frame_link
            arc%leads_nowhere = of%ends(1) == of%ends(2)
            if (of%same .or. of%against) then
               arc%representative = mechanism%arcs(of%reference)%representative
               arc%reversed = mechanism%arcs(of%reference)%reversed .neqv. of%against
            end if
         end select
      end associate
   end subroutine take_arc

   !> The arc that guides a slide, and the right angle from it; 0: any angle.
   pure subroutine take_guide(traced, arc, guide, turn)
      type(loops_t), intent(in) :: traced
      type(traced_t), intent(in) :: arc
      integer, intent(out) :: guide, turn

      turn = 0
      guide = arc%reference
      if (arc%guide_link > 0) return
      guide = findloc(traced%arcs%loop, arc%loop, dim=1) + arc%guide - 1
      turn = arc%sign
   end subroutine take_guide

   pure subroutine take_dyad(traced, loop, mechanism)
      type(loops_t), intent(in) :: traced
      integer, intent(in) :: loop
      type(mechanism_t), intent(inout) :: mechanism
      integer :: p, q

      p = mechanism%loops(loop)%first
      do while (all(mechanism%arcs(p)%kind /= [arc_link, arc_slide]))
         p = p + 1
      end do
      q = p + 1
      mechanism%arcs(p)%dyad = 1
      mechanism%arcs(q)%dyad = 2
      associate (group => mechanism%groups(loop), one => traced%arcs(p), other => traced%arcs(q))
         group%loop = loop
         group%members = [p, q]
         group%kind = kind_of_dyad([one%kind, other%kind] == traced_slide, [one%guide == other%place, other%guide == one%place])
         group%sign = sign_of_dyad(group%kind, one%sign, other%sign, mechanism%arcs(p)%turn, mechanism%arcs(q)%turn)
      end associate
   end subroutine take_dyad

   pure subroutine take_group(traced, loop, mechanism)
      type(loops_t), intent(in) :: traced
      integer, intent(in) :: loop
      type(mechanism_t), intent(inout) :: mechanism
      integer :: n, r

      associate (group => mechanism%groups(loop), of => mechanism%loops(loop))
         group%kind = assur_higher
         group%loop = loop
         group%members = pack([(n, n=of%first, of%first + of%arcs - 1)], &
                              [(any(mechanism%arcs(n)%kind == [arc_link, arc_slide]) .or. traced%arcs(n)%cylinder, &
                                n=of%first, of%first + of%arcs - 1)])
         do n = 1, size(group%members)
            mechanism%arcs(group%members(n))%dyad = n
         end do
         allocate (of%rings(0))
         do r = 1, size(traced%rings)
            associate (ring => traced%rings(r))
               if (ring%loop == loop) of%rings = [of%rings, ring_t(ring%first, ring%turn, ring%last, ring%closed)]
            end associate
         end do
         allocate (group%ties(0))
         do n = 1, size(traced%gears)
            if (traced%gears(n)%loop == loop) group%ties = [group%ties, tie_of(traced, traced%gears(n))]
         end do
         if (size(group%ties) == 0) deallocate (group%ties)
         allocate (group%pairs(0))
         do n = 1, size(traced%pairs)
            if (traced%pairs(n)%loop == loop) group%pairs = [group%pairs, pair_of(traced, traced%pairs(n))]
         end do
      end associate
   end subroutine take_group

   !> A gear pair: ratio (a - c) = b - c. A drive: a - b is its turn.
   pure type(tie_t) function tie_of(traced, gear) result(tie)
      type(loops_t), intent(in) :: traced
      type(traced_gear_t), intent(in) :: gear
      integer :: links(3), k

      do k = 1, 2
         call find_end(traced, 0, gear%centres(k), tie%centre(k), tie%centre_end(k))
      end do
      links = [gear%wheels, gear%carrier]
      tie%factors = [gear%ratio, -1.0_wp, 1.0_wp - gear%ratio]
      tie%drive = gear%drive
      tie%of_slides = gear%of_slides
      if (gear%drive > 0) tie%factors = [1.0_wp, -1.0_wp, 0.0_wp]
      do k = 1, size(links)
         tie%arcs(k) = turning_arc(traced, links(k))
         if (tie%arcs(k) > 0) tie%drawn(k) = traced%arcs(tie%arcs(k))%direction
         if (links(k) /= frame_link) tie%axes(k) = axis_of(traced, links(k))
      end do
   end function tie_of

   !> An arc whose direction is found or an input and that turns as a link does: of one that slides on another, that of the guide.
   !> 0: the link does not turn.
   pure integer function turning_arc(traced, link) result(arc)
      type(loops_t), intent(in) :: traced
      integer, intent(in) :: link
      integer :: here

      arc = 0
      here = link
      do while (here /= frame_link)
         arc = axis_of(traced, here)
         associate (of => traced%arcs(arc))
            if (of%cylinder .or. all(of%kind /= [traced_slide, traced_actuator])) return
            if (of%guide_link > 0) then
               here = of%guide_link
            else
               here = traced%arcs(findloc(traced%arcs%loop, of%loop, dim=1) + of%guide - 1)%link
            end if
         end associate
      end do
      arc = 0
   end function turning_arc

   !> An arc that tells where a link points: of the driven link the first of all.
   pure integer function axis_of(traced, link) result(arc)
      type(loops_t), intent(in) :: traced
      integer, intent(in) :: link

      arc = findloc(traced%arcs%link, link, dim=1)
      if (arc /= 1) arc = traced%axis(link)
   end function axis_of

   !> A pair by arcs: one of each link, and one that ends where they meet.
   pure type(joined_t) function pair_of(traced, pair)
      type(loops_t), intent(in) :: traced
      type(traced_pair_t), intent(in) :: pair
      integer :: n, side

      do side = 1, 2
         pair_of%axes(side) = axis_of(traced, pair%links(side))
      end do
      if (pair%slide > 0) then
         n = findloc(traced%arcs%slide == pair%slide .and. traced%arcs%guide_link > 0, .true., dim=1)
         pair_of%slide = n
         pair_of%arc = n
         pair_of%end = merge(at_finish, at_start, traced%arcs(n)%foot_last)
         return
      end if
      call find_end(traced, pair%loop, pair%joint, pair_of%arc, pair_of%end)
   end function pair_of

   !> An arc of a loop (0: of any) that ends at a joint; 0: none does.
   pure subroutine find_end(traced, loop, joint, arc, end)
      type(loops_t), intent(in) :: traced
      integer, intent(in) :: loop, joint
      integer, intent(out) :: arc, end

      end = at_start
      do arc = 1, size(traced%arcs)
         associate (of => traced%arcs(arc))
            if (all([0, of%loop] /= loop) .or. all(of%ends /= joint)) cycle
            end = merge(at_start, at_finish, of%ends(1) == joint)
            return
         end associate
      end do
      arc = 0
   end subroutine find_end
end module psalm_sketch_mechanism
