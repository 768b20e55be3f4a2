!> Links of a linkage as frames of beam elements: what the group FLEX says, put on the bodies of the mechanism.
module psalm_flexible_link
   use psalm_axes, only: into_axes, out_of_axes
   use psalm_beam_elements, only: beam_frame_t, element_t, station_t, assemble, mass_of_frame, gauss_places, gauss_points
   use psalm_body_points, only: locate_point
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_flex_group, only: flex_group_t, section_of_beam_t
   use psalm_frame_out_of_plane, only: torsion_of_rectangle, torsion_of_solid
   use psalm_force_model, only: force_model_t, parameter_mass, parameter_mx, parameter_my, parameter_inertia
   use psalm_kinds, only: wp
   use psalm_link_cycle, only: is_turned_by_drive
   use psalm_locations, only: location_t, location_of_place, place_right
   use psalm_mechanism, only: mechanism_t, body_frame, joint_gear, joint_prismatic, joint_revolute
   use psalm_place, only: place_t
   use psalm_sort, only: ascending
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: flexible_link_t, attached_t, make_flexible_links, add_flexible_links

   real(wp), parameter :: same_place = 1.0e-6_wp  !! of the size of a link: two places so near are one
   integer, parameter :: most_elements = 120      !! of a link: its modes are found from dense matrices
   real(wp), parameter :: semicircle = 0.5_wp     !! height of an arc over its chord: more is not read

   !> A mass, a load or the end of a spring, on a rigid bracket at a node.
   type :: attached_t
      integer :: entry = 0              !! of its group
      integer :: end = 0                !! of a spring: which of its ends
      integer :: node = 0
      real(wp) :: reach(2) = 0.0_wp     !! from the node, in the frame's axes, m
   end type attached_t

   type :: flexible_link_t
      integer :: body = 0
      integer :: first = 0              !! its first segment of the group
      integer, allocatable :: segments(:)
      type(beam_frame_t) :: frame
      real(wp) :: origin(2) = 0.0_wp    !! of the frame's axes, from the body's reference in the axes of its own arc, m
      real(wp) :: axis(2) = [1.0_wp, 0.0_wp] !! direction of its x axis there
      integer :: held(2) = 0            !! nodes: the first held, the second on the x axis; 0: the first is clamped
      integer, allocatable :: joints(:), nodes(:) !! pins of the mechanism on it, and their nodes
      integer :: slide = 0              !! joint of the mechanism in which it slides, or a shoe on it; 0: none
      type(attached_t), allocatable :: masses(:), loads(:), springs(:)
      real(wp) :: own(4) = 0.0_wp       !! mass, first moments and inertia of its segments, as of a force model
   end type flexible_link_t

   !> A segment in the axes of its body.
   type :: beam_segment_t
      real(wp) :: from(2) = 0.0_wp, to(2) = 0.0_wp !! m
      real(wp) :: half = 0.0_wp         !! half the angle of the arc, with its sign; 0: straight
      real(wp), allocatable :: breaks(:) !! parts of it at which there must be nodes
   end type beam_segment_t

contains

   !> Links in the order of their first segments.
   !>
   !> Errors: places that are none or on several links; the frame, wheels, slides; joints off the segments; segments apart; joints
   !> to be held that are not there or not known; masses by plates; friction; dampers on the link; a spring between its points.
   subroutine make_flexible_links(set, mechanism, dimensions, model, flex, links, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(flex_group_t), intent(in) :: flex
      type(flexible_link_t), allocatable, intent(out) :: links(:)
      type(diagnostics_t), intent(inout) :: findings
      type(location_t) :: starts(size(flex%starts)), finishes(size(flex%starts)), held(size(flex%held))
      type(flexible_link_t) :: link
      integer :: k, body
      logical :: good, all_good

      allocate (links(0))
      all_good = .true.
      do k = 1, size(starts)
         call locate(flex%starts(k), set%link_item('X'), k, starts(k), good)
         all_good = all_good .and. good
         call locate(flex%ends(k), set%link_item('Y'), k, finishes(k), good)
         all_good = all_good .and. good
         if (.not. all_good) cycle
         if (starts(k)%body /= finishes(k)%body) then
            call refuse(set%link_item('Y'), k, 'the segment begins on one link and ends on another')
            all_good = .false.
         end if
      end do
      do k = 1, size(held)
         call locate(flex%held(k), held_item(set), k, held(k), good)
         all_good = all_good .and. good
         if (all(starts%body /= held(k)%body) .and. all_good) then
            call refuse(held_item(set), k, 'no segment is on this link')
            all_good = .false.
         end if
      end do
      if (.not. all_good) return
      if (mechanism%sliding_input) then
         call refuse(set%link_item('X'), 1, 'vibration needs a crank that turns; the input of this linkage slides')
         return
      end if
      if (size(model%friction) > 0) then
         call refuse(set%link_item('X'), 1, 'the equations of a flexible link are linear, but friction changes its sign with '// &
                     'the motion of the joint; leave &FRICTN out')
         return
      end if
      do k = 1, size(starts)
         body = starts(k)%body
         if (any(starts(:k - 1)%body == body)) cycle
         call make_link(body, k, link, good)
         if (good) links = [links, link]
      end do

   contains

      subroutine refuse(item, entry, text)
         character(*), intent(in) :: item, text
         integer, intent(in) :: entry

         call set%origins%error(findings, 'FLEX', trim(item), 'entry '//to_text(entry)//': '//text, entry)
      end subroutine refuse

      subroutine locate(place, item, entry, location, good)
         type(place_t), intent(in) :: place
         character(*), intent(in) :: item
         integer, intent(in) :: entry
         type(location_t), intent(out) :: location
         logical, intent(out) :: good
         integer :: state

         call location_of_place(mechanism, dimensions, model%reference, place, location, state)
         good = state == place_right
         if (.not. good) call refuse(item, entry, 'is no place on a link that loops lead to')
      end subroutine locate

      !> One link, of whose body `first` is the first segment.
      subroutine make_link(body, first, link, good)
         integer, intent(in) :: body, first
         type(flexible_link_t), intent(out) :: link
         logical, intent(out) :: good
         type(beam_segment_t), allocatable :: segments(:)
         real(wp), allocatable :: joints(:, :)       ! shape (2, joints of the link): in the axes of its body, m
         character(:), allocatable :: item
         real(wp) :: size_of
         integer :: j, s

         item = set%link_item('X')
         link%body = body
         link%first = first
         link%segments = pack([(j, j=1, size(starts))], starts%body == body)
         call check_body(body, first, good)
         if (.not. good) return
         link%joints = pack([(j, j=1, size(mechanism%joints))], [(any(mechanism%joints(j)%bodies == body) .and. &
                                                                  mechanism%joints(j)%kind /= joint_prismatic, &
                                                                  j=1, size(mechanism%joints))])
         if (size(link%joints) == 0) then
            good = .false.
            call refuse(item, first, 'the link has no pin: only links with pins, and at most one slide, are treated')
            return
         end if
         link%slide = slide_of(body)
         allocate (joints(2, size(link%joints)), segments(size(link%segments)))
         do j = 1, size(link%joints)
            call locate_point(mechanism, dimensions, body, model%reference(body), mechanism%joints(link%joints(j))%point, &
                              joints(:, j))
         end do
         joints = model%metre*joints
         size_of = 0.0_wp
         do s = 1, size(segments)
            segments(s)%from = model%metre*starts(link%segments(s))%at
            segments(s)%to = model%metre*finishes(link%segments(s))%at
            size_of = max(size_of, maxval(abs(segments(s)%to - segments(1)%from)), maxval(abs(segments(s)%from - segments(1)%from)))
         end do
         do s = 1, size(segments)
            associate (segment => segments(s), chord => sqrt(sum((segments(s)%to - segments(s)%from)**2)), &
                       rise => model%metre*flex%rise(link%segments(s)))
               good = chord > same_place*size_of
               if (.not. good) then
                  call refuse(item, link%segments(s), 'the segment has no length')
                  return
               end if
               good = abs(rise) <= semicircle*chord*(1.0_wp + same_place)
               if (.not. good) then
                  call refuse('XRISE', link%segments(s), 'an arc is at most a semicircle: its height is at most half its '// &
                              'chord; make two of it')
                  return
               end if
               segment%half = 2.0_wp*atan(2.0_wp*rise/chord)
               segment%breaks = [0.0_wp, 1.0_wp]
            end associate
         end do
         call break_segments(segments, joints, same_place*size_of, good)
         if (.not. good) then
            call refuse(item, first, off_segments(link, segments, joints, same_place*size_of))
            return
         end if
         call list_attached(body, link)
         call break_at_attached(link, segments)
         call make_elements(flex, segments, link, same_place*size_of)
         good = size(link%frame%elements) <= most_elements
         if (.not. good) then
            call refuse('NXELEM', first, 'the link has '//to_text(size(link%frame%elements))//' elements; more than '// &
                        to_text(most_elements)//' are not solved')
            return
         end if
         good = is_connected(link%frame)
         if (.not. good) then
            call refuse(item, first, 'the segments of the link do not hang together: their ends, or places on them, must meet')
            return
         end if
         link%nodes = [(nearest_node(link%frame%x, joints(:, j)), j=1, size(link%joints))]
         call choose_held(body, first, link, good)
         if (.not. good) return
         call settle_axes(link)
         call assemble(link%frame)
         link%own = moved_parameters(mass_of_frame(link%frame), link%origin, link%axis)
      end subroutine make_link

      !> What no frame of beams can be.
      subroutine check_body(body, first, good)
         integer, intent(in) :: body, first
         logical, intent(out) :: good
         integer :: k

         good = .false.
         if (body == body_frame) then
            call refuse(set%link_item('X'), first, 'is on the frame, which does not move')
            return
         end if
         if (is_turned_by_drive(mechanism, body)) then
            call refuse(set%link_item('X'), first, 'a drive turns the link against another that moves: this is not treated')
            return
         end if
         do k = 1, size(mechanism%joints)
            associate (joint => mechanism%joints(k))
               if (.not. any(joint%bodies == body)) cycle
               if (joint%kind == joint_gear) then
                  call refuse(set%link_item('X'), first, 'the link is a wheel: only links with pins are treated')
                  return
               else if (joint%kind == joint_prismatic) then
                  if (slide_of(body) /= k) then
                     call refuse(set%link_item('X'), first, 'the link has a second slide, joint '//joint%name//': at most one '// &
                                 'is treated')
                     return
                  else if (.not. model%shoes(k)%given) then
                     call refuse(set%link_item('X'), first, 'the link slides at joint '//joint%name//', but loops do not say '// &
                                 'where its shoe is; give the linkage as a sketch (&CHAIN)')
                     return
                  else if (.not. is_block(sum(joint%bodies) - body)) then
                     call refuse(set%link_item('X'), first, 'the slide at joint '//joint%name//' holds the slope of the '// &
                                 'link: its other part is no block on a pin; this is not treated')
                     return
                  else if (any(mechanism%actuators%joint == k)) then
                     call refuse(set%link_item('X'), first, 'a drive moves the link along joint '//joint%name//': this is not '// &
                                 'treated')
                     return
                  end if
               end if
            end associate
         end do
         if (allocated(model%plates)) then
            if (any(model%plates%body == body)) then
               call refuse(set%link_item('X'), first, '&PLATES has this link: its mass follows from its segments')
               return
            end if
         end if
         do k = 1, size(model%springs)
            associate (spring => model%springs(k))
               if (all(spring%ends%body /= body)) cycle
               if (all(spring%ends%body == body)) then
                  call refuse(set%link_item('X'), first, 'spring '//to_text(k)//' of &SPRING joins two points of this link: '// &
                              'give it as a segment')
                  return
               end if
               if (spring%damps()) then
                  call refuse(set%link_item('X'), first, '&SPRING has damper '//to_text(k)//' on this link; give the damping '// &
                              'of the modes by XZETA, XALPHA, XBETA, or put the damper on another link')
                  return
               end if
               if (spring%torsional .and. spring%side /= 0) then
                  call refuse(set%link_item('X'), first, 'torsional spring '//to_text(k)//' of &SPRING acts on one side only '// &
                              '(SSIDE) and on this link: the equations of a flexible link are linear')
                  return
               end if
            end associate
         end do
         good = .true.
      end subroutine check_body

      !> True if a body has a slide and a pin, or several on one axis: it turns as the slide does.
      pure logical function is_block(body)
         integer, intent(in) :: body
         integer :: j, pin

         pin = 0
         is_block = body /= body_frame
         if (.not. is_block) return
         do j = 1, size(mechanism%joints)
            associate (joint => mechanism%joints(j))
               if (all(joint%bodies /= body) .or. joint%kind == joint_prismatic) cycle
               is_block = is_block .and. joint%kind == joint_revolute .and. (pin == 0 .or. joint%pin == pin)
               pin = joint%pin
            end associate
         end do
         is_block = is_block .and. pin > 0 .and. count([(any(mechanism%joints(j)%bodies == body) .and. &
                                                         mechanism%joints(j)%kind == joint_prismatic, &
                                                         j=1, size(mechanism%joints))]) == 1
      end function is_block

      !> The first slide of a body.
      pure integer function slide_of(body)
         integer, intent(in) :: body

         do slide_of = 1, size(mechanism%joints)
            associate (joint => mechanism%joints(slide_of))
               if (joint%kind == joint_prismatic .and. any(joint%bodies == body)) return
            end associate
         end do
         slide_of = 0
      end function slide_of

      !> Masses, loads and ends of springs on the link; `reach` is their place in the axes of the body still.
      subroutine list_attached(body, link)
         integer, intent(in) :: body
         type(flexible_link_t), intent(inout) :: link
         integer :: k, e

         allocate (link%masses(0), link%loads(0), link%springs(0))
         do k = 1, size(model%centres)
            if (model%centres(k)%body == body) link%masses = [link%masses, attached_t(k, 0, 0, model%metre*model%centres(k)%at)]
         end do
         do k = 1, size(model%loads)
            associate (at => model%loads(k)%location)
               if (at%body == body) link%loads = [link%loads, attached_t(k, 0, 0, model%metre*at%at)]
            end associate
         end do
         do k = 1, size(model%springs)
            do e = 1, 2
               associate (at => model%springs(k)%ends(e))
                  if (at%body == body) link%springs = [link%springs, attached_t(k, e, 0, model%metre*at%at)]
               end associate
            end do
         end do
      end subroutine list_attached

      !> Joints that are not on the segments, in words.
      function off_segments(link, segments, joints, near) result(words)
         type(flexible_link_t), intent(in) :: link
         type(beam_segment_t), intent(in) :: segments(:)
         real(wp), intent(in) :: joints(:, :), near
         character(:), allocatable :: words
         integer :: j

         words = ''
         do j = 1, size(link%joints)
            if (distance_to(segments, joints(:, j)) <= near) cycle
            words = 'joint '//mechanism%joints(link%joints(j))%name//' of the link is on none of its segments'
            return
         end do
      end function off_segments

      !> The joints that hold the link: as given; a driven link is clamped at its pivot, a link with two joints is held there.
      subroutine choose_held(body, first, link, good)
         integer, intent(in) :: body, first
         type(flexible_link_t), intent(inout) :: link
         logical, intent(out) :: good
         integer, allocatable :: asked(:)
         integer :: k, n

         asked = pack([(k, k=1, size(held))], held%body == body)
         good = size(asked) <= 2
         if (.not. good) then
            call refuse(held_item(set), asked(3), 'a link is held at two joints, or clamped at one')
            return
         end if
         if (size(asked) > 0) then
            do k = 1, size(asked)
               n = nearest_node(link%frame%x, model%metre*held(asked(k))%at)
               good = any(link%nodes == n) .and. all(link%held /= n)
               if (.not. good) then
                  call refuse(held_item(set), asked(k), 'is no joint of the link, or stands twice')
                  return
               end if
               link%held(k) = n
            end do
            return
         end if
         do k = 1, size(mechanism%actuators)
            associate (a => mechanism%actuators(k))
               if (a%joint == 0 .or. a%slides) cycle
               n = findloc(link%joints, a%joint, dim=1)
               if (n == 0) cycle
               link%held(1) = link%nodes(n)
               return
            end associate
         end do
         n = count([(all(link%nodes(:k - 1) /= link%nodes(k)), k=1, size(link%nodes))])
         good = n == 2
         if (n == 1 .and. link%slide > 0) then
            good = .true.
            link%held(1) = link%nodes(1)
            return
         end if
         if (good) then
            link%held(1) = link%nodes(1)
            link%held(2) = link%nodes(findloc(link%nodes /= link%nodes(1), .true., dim=1))
            return
         end if
         call refuse(set%link_item('X'), first, 'the link has '//to_text(n)//' pins: name in '//held_item(set)//' the two '// &
                     'between which it bends, or one at which it is clamped')
      end subroutine choose_held
   end subroutine make_flexible_links

   pure function held_item(set) result(item)
      type(data_set_t), intent(in) :: set
      character(:), allocatable :: item

      item = 'XH'//merge('NAME', 'LINK', set%has_names())
   end function held_item

   !> Put the masses of the segments on the bodies, but for the body of `beyond`.
   pure subroutine add_flexible_links(links, beyond, model)
      type(flexible_link_t), intent(in) :: links(:)
      integer, intent(in) :: beyond              !! 0: none
      type(force_model_t), intent(inout) :: model
      integer :: k

      do k = 1, size(links)
         if (links(k)%body == beyond) cycle
         model%inertia(:, links(k)%body) = model%inertia(:, links(k)%body) + links(k)%own
      end do
   end subroutine add_flexible_links

   ! ---- segments ----------------------------------------------------------------------------------------------------

   !> A point of a segment.
   pure function point_at(segment, s) result(x)
      type(beam_segment_t), intent(in) :: segment
      real(wp), intent(in) :: s         !! part of it
      real(wp) :: x(2), e(2), chord, radius, angle

      if (.not. abs(segment%half) > 0.0_wp .or. s <= 0.0_wp .or. s >= 1.0_wp) then
         x = segment%from + min(max(s, 0.0_wp), 1.0_wp)*(segment%to - segment%from)
         return
      end if
      chord = sqrt(sum((segment%to - segment%from)**2))
      e = (segment%to - segment%from)/chord
      radius = 0.5_wp*chord/sin(segment%half)
      angle = segment%half*(2.0_wp*s - 1.0_wp)
      x = 0.5_wp*(segment%from + segment%to) + radius*sin(angle)*e + radius*(cos(angle) - cos(segment%half))*[-e(2), e(1)]
   end function point_at

   !> The part of a segment that is nearest to a point.
   pure real(wp) function part_near(segment, x) result(s)
      type(beam_segment_t), intent(in) :: segment
      real(wp), intent(in) :: x(2)
      real(wp) :: e(2), d(2), chord, radius

      chord = sqrt(sum((segment%to - segment%from)**2))
      e = (segment%to - segment%from)/chord
      if (.not. abs(segment%half) > 0.0_wp) then
         s = sum((x - segment%from)*e)/chord
      else
         radius = 0.5_wp*chord/sin(segment%half)
         d = x - 0.5_wp*(segment%from + segment%to) + radius*cos(segment%half)*[-e(2), e(1)]
         s = atan2(sign(1.0_wp, radius)*sum(d*e), sign(1.0_wp, radius)*(d(2)*e(1) - d(1)*e(2)))
         s = 0.5_wp*(s/segment%half + 1.0_wp)
      end if
      s = min(max(s, 0.0_wp), 1.0_wp)
   end function part_near

   pure real(wp) function distance_to(segments, x)
      type(beam_segment_t), intent(in) :: segments(:)
      real(wp), intent(in) :: x(2)
      integer :: s

      distance_to = huge(1.0_wp)
      do s = 1, size(segments)
         distance_to = min(distance_to, sqrt(sum((point_at(segments(s), part_near(segments(s), x)) - x)**2)))
      end do
   end function distance_to

   !> Nodes where joints, and ends of segments, are on segments. `good` is false where a joint is on none.
   subroutine break_segments(segments, joints, near, good)
      type(beam_segment_t), intent(inout) :: segments(:)
      real(wp), intent(in) :: joints(:, :)       !! shape (2, joints)
      real(wp), intent(in) :: near               !! m
      logical, intent(out) :: good
      integer :: j, s

      good = .true.
      do j = 1, size(joints, 2)
         good = good .and. distance_to(segments, joints(:, j)) <= near
         call break_at(joints(:, j))
      end do
      do s = 1, size(segments)
         call break_at(segments(s)%from)
         call break_at(segments(s)%to)
      end do

   contains

      subroutine break_at(x)
         real(wp), intent(in) :: x(2)
         integer :: i

         do i = 1, size(segments)
            if (distance_to(segments(i:i), x) <= near) segments(i)%breaks = [segments(i)%breaks, part_near(segments(i), x)]
         end do
      end subroutine break_at
   end subroutine break_segments

   !> A node at the place nearest to each mass, load and end of a spring.
   pure subroutine break_at_attached(link, segments)
      type(flexible_link_t), intent(in) :: link
      type(beam_segment_t), intent(inout) :: segments(:)
      type(attached_t), allocatable :: all(:)
      real(wp) :: distances(size(segments))
      integer :: k, s

      all = [link%masses, link%loads, link%springs]
      do k = 1, size(all)
         distances = [(distance_to(segments(s:s), all(k)%reach), s=1, size(segments))]
         s = minloc(distances, dim=1)
         segments(s)%breaks = [segments(s)%breaks, part_near(segments(s), all(k)%reach)]
      end do
   end subroutine break_at_attached

   !> Nodes and elements, in the axes of the body still, and the nodes of what is attached.
   subroutine make_elements(flex, segments, link, near)
      type(flex_group_t), intent(in) :: flex
      type(beam_segment_t), intent(in) :: segments(:)
      type(flexible_link_t), intent(inout) :: link
      real(wp), intent(in) :: near               !! m: nodes so near are one
      real(wp), allocatable :: breaks(:)
      type(element_t) :: element
      real(wp) :: parts(2)
      integer :: s, b, i, many, g

      allocate (link%frame%x(2, 0), link%frame%elements(0))
      do s = 1, size(segments)
         breaks = segments(s)%breaks(ascending(segments(s)%breaks))
         breaks = pack(breaks, [.true., breaks(2:) - breaks(:size(breaks) - 1) > same_place])
         if (1.0_wp - breaks(size(breaks)) <= same_place) breaks(size(breaks)) = 1.0_wp
         do b = 1, size(breaks) - 1
            many = max(1, ceiling(real(flex%elements, wp)*(breaks(b + 1) - breaks(b)) - same_place))
            do i = 1, many
               parts = breaks(b) + (breaks(b + 1) - breaks(b))*[real(i - 1, wp), real(i, wp)]/real(many, wp)
               associate (k => link%segments(s))
                  element%segment = k
                  element%from = parts(1)
                  element%to = parts(2)
                  element%modulus = flex%modulus(k)
                  element%density = flex%density(k)
                  element%shear = 0.5_wp*flex%modulus(k)/(1.0_wp + flex%poisson(k))
                  element%at = [(station_at(flex%sections(:, k), parts(1) + (parts(2) - parts(1))*gauss_places(g)), &
                                 g=1, gauss_points)]
                  element%node = [(station_at(flex%sections(:, k), parts(g)), g=1, 2)]
               end associate
               element%nodes = [(node_at(point_at(segments(s), parts(g))), g=1, 2)]
               link%frame%elements = [link%frame%elements, element]
            end do
         end do
      end do
      link%masses = at_nodes(link%masses)
      link%loads = at_nodes(link%loads)
      link%springs = at_nodes(link%springs)

   contains

      integer function node_at(x)
         real(wp), intent(in) :: x(2)

         do node_at = 1, size(link%frame%x, 2)
            if (maxval(abs(link%frame%x(:, node_at) - x)) <= near) return
         end do
         link%frame%x = reshape([link%frame%x, x], [2, node_at])
      end function node_at

      function at_nodes(list) result(placed)
         type(attached_t), intent(in) :: list(:)
         type(attached_t) :: placed(size(list))
         integer :: k

         placed = list
         do k = 1, size(list)
            placed(k)%node = nearest_node(link%frame%x, list(k)%reach)
            placed(k)%reach = list(k)%reach - link%frame%x(:, placed(k)%node)
         end do
      end function at_nodes
   end subroutine make_elements

   !> The section at a part of a segment.
   pure type(station_t) function station_at(sections, s) result(station)
      type(section_of_beam_t), intent(in) :: sections(2)
      real(wp), intent(in) :: s
      real(wp) :: depth, width, area, gyration, across, torsion

      depth = sections(1)%depth + s*(sections(2)%depth - sections(1)%depth)
      width = sections(1)%width + s*(sections(2)%width - sections(1)%width)
      area = sections(1)%area + s*(sections(2)%area - sections(1)%area)
      gyration = sections(1)%gyration + s*(sections(2)%gyration - sections(1)%gyration)
      across = sections(1)%gyration_across + s*(sections(2)%gyration_across - sections(1)%gyration_across)
      torsion = sections(1)%torsion + s*(sections(2)%torsion - sections(1)%torsion)
      if (width > 0.0_wp) then
         area = depth*width
         torsion = torsion_of_rectangle(depth, width)
      else if (.not. torsion > 0.0_wp) then
         torsion = torsion_of_solid(area, area*(gyration**2 + across**2))
      end if
      station = station_t(area=area, inertia=area*gyration**2, depth=depth, across=area*across**2, &
                          polar=area*(gyration**2 + across**2), torsion=torsion)
   end function station_at

   pure integer function nearest_node(x, place)
      real(wp), intent(in) :: x(:, :)            !! shape (2, nodes)
      real(wp), intent(in) :: place(2)

      nearest_node = minloc((x(1, :) - place(1))**2 + (x(2, :) - place(2))**2, dim=1)
   end function nearest_node

   !> True if elements lead from any node to any other.
   pure logical function is_connected(frame)
      type(beam_frame_t), intent(in) :: frame
      logical :: reached(size(frame%x, 2)), more
      integer :: e

      reached = .false.
      reached(1) = .true.
      more = .true.
      do while (more)
         more = .false.
         do e = 1, size(frame%elements)
            associate (nodes => frame%elements(e)%nodes)
               if (reached(nodes(1)) .eqv. reached(nodes(2))) cycle
               reached(nodes) = .true.
               more = .true.
            end associate
         end do
      end do
      is_connected = all(reached)
   end function is_connected

   !> Turn all places into the frame's own axes: from the first held node, along the line to the second, or to the farthest joint.
   pure subroutine settle_axes(link)
      type(flexible_link_t), intent(inout) :: link
      real(wp) :: far(2)
      integer :: n, k

      associate (x => link%frame%x)
         link%origin = x(:, link%held(1))
         n = link%held(2)
         if (n == 0) then
            n = link%nodes(maxloc([((x(1, link%nodes(k)) - link%origin(1))**2 + (x(2, link%nodes(k)) - link%origin(2))**2, &
                                    k=1, size(link%nodes))], dim=1))
            if (n == link%held(1)) n = maxloc((x(1, :) - link%origin(1))**2 + (x(2, :) - link%origin(2))**2, dim=1)
         end if
         far = x(:, n) - link%origin
         link%axis = far/sqrt(sum(far**2))
         do n = 1, size(x, 2)
            x(:, n) = into_axes(link%axis, x(:, n) - link%origin)
         end do
      end associate
      do k = 1, size(link%masses)
         link%masses(k)%reach = into_axes(link%axis, link%masses(k)%reach)
      end do
      do k = 1, size(link%loads)
         link%loads(k)%reach = into_axes(link%axis, link%loads(k)%reach)
      end do
      do k = 1, size(link%springs)
         link%springs(k)%reach = into_axes(link%axis, link%springs(k)%reach)
      end do
   end subroutine settle_axes

   !> Mass, first moments and inertia about the reference of the body in its axes, from those about an origin in axes of its own.
   pure function moved_parameters(own, origin, axis) result(moved)
      real(wp), intent(in) :: own(4), origin(2), axis(2)
      real(wp) :: moved(4), first(2)

      first = out_of_axes(axis, own(2:3))
      moved(parameter_mass) = own(1)
      moved(parameter_mx) = first(1) + own(1)*origin(1)
      moved(parameter_my) = first(2) + own(1)*origin(2)
      moved(parameter_inertia) = own(4) + 2.0_wp*(first(1)*origin(1) + first(2)*origin(2)) + own(1)*sum(origin**2)
   end function moved_parameters
end module psalm_flexible_link
