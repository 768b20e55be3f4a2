!> Where the loops of a sketch have its parts: arcs for links, joints and slides, for masses, loads, springs, friction and weights,
!> for regions and for the links that must not meet.
module psalm_sketch_places
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_case_group, only: place_visitor_t
   use psalm_closure, only: closure_t, state_t
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_mechanism, only: at_start, at_finish
   use psalm_place, only: place_t, travel_t
   use psalm_sketch, only: sketch_t, frame_link, output_point
   use psalm_sketch_dimensions, only: quadrant_angle
   use psalm_traced_loops, only: loops_t, arc_with
   implicit none (type, external)
   private
   public :: fill_places, fill_regions

   !> Gives places on a sketch their arcs.
   type, extends(place_visitor_t) :: placing_t
      type(loops_t), pointer :: loops => null()
      type(state_t), pointer :: state => null()  !! at the drawing
      type(sketch_t), pointer :: sketch => null()
   contains
      procedure :: place => put_point
      procedure :: joint => put_joint
      procedure :: line => put_line
   end type placing_t

contains

   !> Arcs for the links, and for the places of masses, loads, springs, friction and weights, which are given by names.
   subroutine fill_places(closure, loops, state, set)
      type(closure_t), intent(in) :: closure
      type(loops_t), intent(inout), target :: loops
      type(state_t), intent(in), target :: state
      type(data_set_t), intent(inout), target :: set
      type(placing_t) :: placing
      integer :: k

      placing%loops => loops
      placing%state => state
      placing%sketch => set%sketch

      allocate (loops%link_places(size(set%sketch%links)))
      do k = 1, size(set%sketch%links)
         associate (place => loops%link_places(k), joints => set%sketch%links(k)%joints)
            place%link = k
            if (size(joints) > 0) place%joint = joints(1)
            if (size(joints) > 1) place%line = joints(:2)
            call placing%place(place)
         end associate
      end do
      allocate (loops%joint_places(size(set%sketch%joint_name)), loops%travels(size(set%sketch%slides)))
      do k = 1, size(loops%joint_places)
         call put_joint_place(k, loops%joint_places(k))
      end do
      do k = 1, size(loops%travels)
         call put_travel(k, loops%travels(k))
      end do
      do k = 1, size(set%masses%places)
         call placing%place(set%masses%places(k))
      end do
      do k = 1, size(set%loads%places)
         call placing%place(set%loads%places(k))
      end do
      do k = 1, size(set%springs%first)
         call placing%place(set%springs%first(k))
         call placing%place(set%springs%second(k))
      end do
      do k = 1, size(set%friction%joints)
         call placing%joint(set%friction%joints(k))
      end do
      do k = 1, size(set%sections)
         call set%sections(k)%group%visit_places(placing)
      end do
      loops%pin_holders = closure%holder
      allocate (loops%shoes(size(set%sketch%slides)))
      allocate (loops%line_senses(size(set%sketch%slides)), source=1)
      do k = 1, size(loops%shoes)
         call put_shoe(k, loops%shoes(k), loops%line_senses(k))
      end do

   contains

      !> Where the loops have a joint: at an end of an arc, if there is one, else counted from one of a link that has it.
      subroutine put_joint_place(joint, place)
         integer, intent(in) :: joint
         type(place_t), intent(inout) :: place
         integer, allocatable :: links(:)
         integer :: l, arc
         logical :: from_start

         place%joint = joint
         place%link = frame_link
         if (set%sketch%has_joint(frame_link, joint)) then
            ! without an arc that ends there no dimension of the loops moves it
            call arc_with(loops, frame_link, joint, arc, from_start)
            if (arc > 0) call placing%place(place)
            return
         end if
         links = set%sketch%links_of(joint)
         place%link = links(1)
         do l = 1, size(links)
            call arc_with(loops, links(l), joint, arc, from_start)
            if (arc == 0) cycle
            place%link = links(l)
            exit
         end do
         call placing%place(place)
      end subroutine put_joint_place

      !> The travel of a slide by the length of its arc, which leads from a point of one of its links to one of the other.
      subroutine put_travel(slide, travelled)
         integer, intent(in) :: slide
         type(travel_t), intent(inout) :: travelled
         complex(wp) :: direction
         real(wp) :: c, s, line
         integer :: arc

         arc = findloc(loops%arcs%slide, slide, dim=1)
         if (arc == 0) return
         associate (of => closure%sketch%slides(slide), one => loops%arcs(arc))
            travelled%arc = one%place
            travelled%loop = one%loop
            call unit_vector(one%direction, c, s)
            direction = cmplx(c, s, wp)
            call unit_vector(of%angle + state%phi(of%links(1), 0)*degrees_per_radian, c, line)
            if (real(conjg(direction)*cmplx(c, line, wp), wp) < 0.0_wp) travelled%sense = -1.0_wp
            if (.not. (loops%on(one%ends(2), of%links(2)) .and. loops%on(one%ends(1), of%links(1)))) &
               travelled%sense = -travelled%sense
            travelled%zero = -travelled%sense*real(conjg(direction)*(loops%point(one%ends(2)) - loops%point(one%ends(1))), wp)
         end associate
      end subroutine put_travel

      !> The point of a slide on its second link, as assembled, and the sense of its arc. Of the frame it is counted from the
      !> origin of the drawing, and no arc is chosen.
      subroutine put_shoe(slide, shoe, sense)
         integer, intent(in) :: slide
         type(place_t), intent(inout) :: shoe
         integer, intent(inout) :: sense
         complex(wp) :: z, h
         real(wp) :: line, c, s
         integer :: arc

         associate (of => closure%sketch%slides(slide))
            shoe%link = of%links(2)
            call unit_vector(state%phi(shoe%link, 0)*degrees_per_radian, c, s)
            z = state%t(shoe%link, 0) + cmplx(c, s, wp)*closure%slide_point(2, slide)
            arc = findloc(loops%arcs%slide, slide, dim=1)
            line = of%angle + state%phi(of%links(1), 0)*degrees_per_radian
            if (arc > 0) then
               call unit_vector(loops%arcs(arc)%direction - line, c, s)
               if (c < 0.0_wp) sense = -1
            end if
         end associate
         line = 0.0_wp
         if (shoe%link /= frame_link) then
            associate (joints => set%sketch%links(shoe%link)%joints)
               if (size(joints) > 0) shoe%joint = joints(1)
               if (size(joints) > 1) shoe%line = joints(:2)
            end associate
            line = state%phi(shoe%link, 0)*degrees_per_radian
            if (shoe%line(1) > 0) then
               h = state%joint(shoe%line(2), 0) - state%joint(shoe%line(1), 0)
               line = degrees_of(h%re, h%im)
            end if
            z = z - state%t(shoe%link, 0)
            if (shoe%joint > 0) z = z + (state%t(shoe%link, 0) - state%joint(shoe%joint, 0))
         end if
         shoe%distance = abs(z)
         if (shoe%distance > 0.0_wp) shoe%angle = degrees_of(z%re, z%im) - line
         if (shoe%link /= frame_link) call placing%place(shoe)
      end subroutine put_shoe
   end subroutine fill_places

   !> An arc of the link, if there is one that begins or ends at the joint.
   subroutine put_point(self, place)
      class(placing_t), intent(in) :: self
      type(place_t), intent(inout) :: place
      integer :: arc, point, found
      logical :: from_start, start_of_it
      real(wp) :: direction, c, s
      complex(wp) :: h, z

      place%written = [place%distance, place%angle]
      h = (1.0_wp, 0.0_wp)
      if (place%line(1) > 0) h = self%state%joint(place%line(2), 0) - self%state%joint(place%line(1), 0)
      direction = degrees_of(h%re, h%im)
      if (place%line(1) == 0) direction = self%state%phi(place%link, 0)*degrees_per_radian
      arc = 0
      if (place%joint > 0) call arc_with(self%loops, place%link, place%joint, arc, from_start)
      if (arc == 0) then
         do point = 1, size(self%loops%point)
            call arc_with(self%loops, place%link, point, found, start_of_it)
            if (found == 0) cycle
            arc = found
            from_start = start_of_it
            exit
         end do
      end if
      if (arc == 0) return
      associate (one => self%loops%arcs(arc))
         point = one%ends(merge(at_start, at_finish, from_start))
         if (point /= place%joint) then
            call unit_vector(direction + place%angle, c, s)
            z = self%state%t(place%link, 0)
            if (place%joint > 0) z = self%state%joint(place%joint, 0)
            z = z + place%distance*cmplx(c, s, wp) - self%loops%point(point)
            place%distance = abs(z)
            place%angle = 0.0_wp
            if (place%distance > 0.0_wp) place%angle = quadrant_angle(degrees_of(z%re, z%im) - direction)
         end if
         place%arc = one%place
         place%loop = one%loop
         place%from_start = from_start
         place%turn = quadrant_angle(direction - one%direction)
      end associate
   end subroutine put_point

   !> The arc of the link between two joints of it; none if no loop runs there.
   subroutine put_line(self, place)
      class(placing_t), intent(in) :: self
      type(place_t), intent(inout) :: place
      integer :: k

      do k = 1, size(self%loops%arcs)
         associate (arc => self%loops%arcs(k))
            if (arc%link /= place%link .or. arc%slide > 0) cycle
            if (.not. (any(arc%ends == place%line(1)) .and. any(arc%ends == place%line(2)))) cycle
            place%arc = arc%place
            place%loop = arc%loop
            return
         end associate
      end do
   end subroutine put_line

   !> The end of an arc, or a sliding arc.
   subroutine put_joint(self, place)
      class(placing_t), intent(in) :: self
      type(place_t), intent(inout) :: place
      integer, allocatable :: links(:)
      integer :: k, arc

      if (place%slide > 0) then
         k = findloc(self%loops%arcs%slide, place%slide, dim=1)
         if (k == 0) return
         place%loop = self%loops%arcs(k)%loop
         place%arc = self%loops%arcs(k)%place
         return
      end if
      links = self%sketch%links_of(place%joint)
      if (place%link > 0) links = [place%link]
      do k = size(links), 1, -1
         call arc_with(self%loops, links(k), place%joint, arc, place%from_start)
         if (arc == 0) cycle
         place%loop = self%loops%arcs(arc)%loop
         place%arc = self%loops%arcs(arc)%place
         return
      end do
   end subroutine put_joint

   !> The joints of regions and of links as ends of arcs, as the output point, or as points beside ends of arcs.
   subroutine fill_regions(loops, sketch, set)
      type(loops_t), intent(in) :: loops
      type(sketch_t), intent(in) :: sketch
      type(data_set_t), intent(inout) :: set
      integer :: r, k

      if (.not. set%constr%given) return
      do r = 1, size(set%constr%regions)
         associate (region => set%constr%regions(r))
            if (region%segment == 0) call place(region%joint, region%loop, region%arc, region%place)
         end associate
      end do
      do r = 1, size(set%constr%segments)
         associate (segment => set%constr%segments(r))
            do k = 1, 2
               call place(segment%joints(k), segment%loops(k), segment%arcs(k), segment%places(k))
            end do
         end associate
      end do

   contains

      subroutine place(joint, loop, arc, beside)
         integer, intent(in) :: joint
         integer, intent(inout) :: loop, arc
         type(place_t), intent(inout) :: beside
         complex(wp) :: away
         integer :: n

         if (is_output(joint)) return
         do n = 1, size(loops%arcs)
            if (all(loops%arcs(n)%ends /= joint)) cycle
            loop = loops%arcs(n)%loop
            arc = loops%arcs(n)%place
            if (loops%arcs(n)%ends(2) /= joint) arc = arc - 1
            return
         end do
         beside = loops%joint_places(joint)
         loop = beside%loop
         arc = beside%arc
         if (beside%arc == 0) then
            ! it stands still, as the input pivot does
            loop = 1
            away = cmplx(set%sketch%x(joint), set%sketch%y(joint), wp) - loops%point(loops%start)
            beside%link = frame_link
            beside%distance = abs(away)
            beside%angle = degrees_of(away%re, away%im)
         end if
      end subroutine place

      logical function is_output(joint)
         integer, intent(in) :: joint

         is_output = .false.
         if (size(sketch%outputs) > 0) is_output = sketch%outputs(1)%kind == output_point .and. &
                                                   sketch%outputs(1)%joints(1) == joint
      end function is_output
   end subroutine fill_regions
end module psalm_sketch_places
