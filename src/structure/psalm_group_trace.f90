!> The rings of a larger group of a sketch: arcs with lengths and directions read off the drawing.
!>
!> A ring leads from what is known by a shortest chain of unknown links back to what is known; the links of that chain count as
!> known for the rings after it, until every pair of the group is in one. A slide is an arc of varying length from a point of one
!> link's line to one of the other's; it gives both links one direction. Source of the rings: ears of a graph (Whitney 1932).
module psalm_group_trace
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_closure, only: closure_t, state_t, row_pin, row_line, row_gear, row_turn, row_travel
   use psalm_kinds, only: wp, degrees_per_radian, half_turn
   use psalm_loop_trace, only: append_step, frame_axis
   use psalm_sketch, only: frame_link, drive_slides, drive_turns
   use psalm_sketch_paths, only: path_step_t, tracing_t, know, shortest, way_from
   use psalm_traced_loops, only: loops_t, traced_t, traced_gear_t, traced_pair_t, traced_ring_t, traced_link, traced_slide, &
                                 traced_crank, traced_actuator, traced_frame
   implicit none (type, external)
   private
   public :: trace_group, trace_driven, trace_input_alone

   !> A pair of two links.
   type :: pair_t
      integer :: links(2) = 0
      integer :: joint = 0, slide = 0       !! a pin, or a slide
      logical :: used = .false.             !! a ring passes it
   end type pair_t

   !> A chain of unknown links between two that are known: the pair before each link, and the one after the last.
   type :: ear_t
      integer :: first_link = 0, last_link = 0 !! known
      integer, allocatable :: links(:), pairs(:)
   end type ear_t

contains

   !> Trace all rings of a group. `why` tells what cannot be traced, or is empty.
   subroutine trace_group(closure, state, group, tracing, loops, why)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state           !! at the drawing
      integer, intent(in) :: group
      type(tracing_t), intent(inout) :: tracing
      type(loops_t), intent(inout) :: loops
      character(:), allocatable, intent(out) :: why
      type(pair_t), allocatable :: pairs(:)
      type(traced_gear_t), allocatable :: gears(:)
      type(ear_t) :: ear
      integer, allocatable :: along(:)             !! by slide: the drive along it, 0: none
      integer :: loop, first, from, k, unknowns, equations
      logical :: taken

      why = ''
      allocate (pairs(0), gears(0))
      allocate (along(size(closure%sketch%slides)), source=0)
      do k = 1, size(closure%groups(group)%rows)
         associate (row => closure%groups(group)%rows(k))
            select case (row%kind)
            case (row_pin)
               pairs = [pairs, pair_t(row%links, joint=row%which)]
            case (row_line)
               pairs = [pairs, pair_t(row%links, slide=row%which)]
            case (row_gear)
               associate (gear => closure%sketch%gears(row%which))
                  gears = [gears, traced_gear_t(0, gear%wheels, gear%carrier, gear%ratio, &
                                                centres=[centre_of(gear%wheels(1), gear%carrier), &
                                                         centre_of(gear%wheels(2), gear%carrier)])]
               end associate
            case (row_turn)
               ! links are the base and the one that is turned
               gears = [gears, traced_gear_t(0, row%links([2, 1]), frame_link, 0.0_wp, row%which)]
            case (row_travel)
               along(closure%sketch%drives(row%which)%slide) = row%which
            end select
         end associate
      end do
      loop = 1
      if (size(loops%arcs) > 0) loop = maxval(loops%arcs%loop) + 1
      first = size(loops%arcs)
      call place_line_points(closure, state, pairs, tracing, loops)
      do while (.not. all(pairs%used))
         from = 0
         if (size(loops%arcs) == 0 .and. .not. loops%floating) from = closure%sketch%drives(1)%link
         call find_ear(pairs, tracing%known, from, ear)
         if (size(ear%pairs) == 0 .and. from > 0) then
            ! the driven link has an arc of its own, whatever hangs on it
            call trace_ring(closure, state, loop, first, pairs, ear, along, gears, tracing, loops, taken, why)
            cycle
         end if
         if (size(ear%pairs) == 0) call find_branch(pairs, tracing%known, along, ear)
         if (size(ear%pairs) == 0) then
            why = 'links that are connected to each other only'
            return
         end if
         call trace_ring(closure, state, loop, first, pairs, ear, along, gears, tracing, loops, taken, why)
         if (len(why) > 0) return
         if (.not. taken) cycle
         pairs(ear%pairs)%used = .true.
         do k = 1, size(ear%links)
            call know(closure%sketch, ear%links(k), tracing)
            associate (joints => closure%sketch%links(ear%links(k))%joints)
               where (loops%joint_loop(joints) == 0) loops%joint_loop(joints) = loop
            end associate
         end do
      end do
      do k = 1, size(pairs)
         loops%pairs = [loops%pairs, traced_pair_t(loop, pairs(k)%links, pairs(k)%joint, pairs(k)%slide)]
      end do
      gears%loop = loop
      loops%gears = [loops%gears, gears]
      loops%longest = max(loops%longest, size(loops%arcs) - first)
      associate (arcs => loops%arcs(first + 1:))
         unknowns = count(arcs%kind == traced_link .or. arcs%kind == traced_slide .or. arcs%cylinder)
         equations = 2*count(loops%rings%loop == loop .and. loops%rings%closed) + size(gears)
         ! of links that brace each other there are more equations
         if (merge(unknowns > equations, unknowns /= equations, closure%sketch%over_braced)) &
            why = 'a group whose links have other unknowns than its rings find'
      end associate

   contains

      !> The joint of a wheel on its carrier; 0: there is none.
      pure integer function centre_of(wheel, carrier) result(centre)
         integer, intent(in) :: wheel, carrier
         integer :: j

         centre = 0
         associate (sketch => closure%sketch)
            do j = 1, size(sketch%joint_name)
               if (sketch%has_joint(wheel, j) .and. sketch%has_joint(carrier, j)) centre = j
            end do
         end associate
      end function centre_of
   end subroutine trace_group

   !> A loop for the link that the first drive moves on the frame, if no group hangs on it: an open ring.
   subroutine trace_input_alone(closure, state, tracing, loops, why)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state           !! at the drawing
      type(tracing_t), intent(inout) :: tracing
      type(loops_t), intent(inout) :: loops
      character(:), allocatable, intent(inout) :: why
      type(pair_t) :: pairs(0)
      type(traced_gear_t), allocatable :: gears(:)
      type(ear_t) :: ear
      integer :: along(size(closure%sketch%slides))
      logical :: taken

      along = 0
      allocate (ear%links(0), ear%pairs(0))
      allocate (gears(0))
      call trace_ring(closure, state, 1, 0, pairs, ear, along, gears, tracing, loops, taken, why)
      loops%longest = size(loops%arcs)
   end subroutine trace_input_alone

   !> A loop for a link that a drive after the first moves on the frame and no other loop runs through: an open ring to it.
   subroutine trace_driven(closure, drive, tracing, loops, why)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: drive
      type(tracing_t), intent(in) :: tracing
      type(loops_t), intent(inout) :: loops
      character(:), allocatable, intent(inout) :: why
      type(path_step_t), allocatable :: way(:)
      type(path_step_t) :: step
      integer :: first, k
      logical :: found

      first = size(loops%arcs)
      associate (of => closure%sketch%drives(drive), loop => maxval(loops%arcs%loop) + 1)
         if (of%kind == drive_turns) then
            step = path_step_t(of%link, of%joint, of%joint)
            associate (joints => closure%sketch%links(of%link)%joints)
               do k = 1, size(joints)
                  if (joints(k) /= of%joint) step%to = joints(k)
               end do
            end associate
         else
            k = findloc(tracing%pass(4, :tracing%passes), drive, dim=1)
            if (k > 0) step = path_step_t(0, tracing%pass(1, k), tracing%pass(2, k), 0, drive)
         end if
         found = step%from > 0
         if (found) call shortest(tracing, loops%start, step%from, .true., way, found)
         if (.not. found) then
            why = 'a driven link that no link leads to'
            return
         end if
         do k = 1, size(way)
            call append_step(closure, loop, first, way(k), loops)
         end do
         call append_step(closure, loop, first, step, loops)
         loops%rings = [loops%rings, traced_ring_t(loop, first + 1, size(loops%arcs), size(loops%arcs), .false.)]
      end associate
      loops%longest = max(loops%longest, size(loops%arcs) - first)
   end subroutine trace_driven

   !> Points for the lines of all slides of the group, one on either link, after those that are there.
   subroutine place_line_points(closure, state, pairs, tracing, loops)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(pair_t), intent(in) :: pairs(:)
      type(tracing_t), intent(inout) :: tracing
      type(loops_t), intent(inout) :: loops
      integer :: k, side

      do k = 1, size(pairs)
         if (pairs(k)%slide == 0) cycle
         do side = 1, 2
            call add_line_point(closure, state, pairs(k)%slide, side, tracing, loops)
         end do
      end do
   end subroutine place_line_points

   !> The point of a slide's line on its first or second link, noted as a point of that link.
   subroutine add_line_point(closure, state, slide, side, tracing, loops)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      integer, intent(in) :: slide, side
      type(tracing_t), intent(inout) :: tracing
      type(loops_t), intent(inout) :: loops
      real(wp) :: c, s

      associate (link => closure%sketch%slides(slide)%links(side))
         tracing%points = tracing%points + 1
         call unit_vector(state%phi(link, 0)*degrees_per_radian, c, s)
         loops%point(tracing%points) = state%t(link, 0) + cmplx(c, s, wp)*closure%slide_point(side, slide)
         tracing%on(tracing%points, link) = .true.
         loops%line_point(side, slide) = tracing%points
      end associate
   end subroutine add_line_point

   !> The shortest chain of unknown links; `from` (if it is not 0) is the known link that it must hang on.
   subroutine find_ear(pairs, known, from, ear)
      type(pair_t), intent(in) :: pairs(:)
      logical, intent(in) :: known(:)              !! by link
      integer, intent(in) :: from
      type(ear_t), intent(out) :: ear
      integer :: start, side, link, head, tail, k, other, queue(size(known)), reached_by(size(known)), length
      logical :: seen(size(known))

      allocate (ear%pairs(0), ear%links(0))
      length = size(known) + 1
      do start = 1, size(pairs)
         if (pairs(start)%used) cycle
         do side = 1, 2
            if (.not. known(pairs(start)%links(side))) cycle
            if (from > 0 .and. pairs(start)%links(side) /= from) cycle
            link = pairs(start)%links(3 - side)
            if (known(link)) then
               if (side == 2 .and. from == 0) cycle
               ear%links = [integer ::]
               ear%pairs = [start]
               ear%first_link = pairs(start)%links(side)
               ear%last_link = link
               return
            end if
            seen = .false.
            seen(link) = .true.
            queue(1) = link
            reached_by(link) = start
            head = 1
            tail = 1
            search: do while (head <= tail)
               do k = 1, size(pairs)
                  if (pairs(k)%used .or. all(pairs(k)%links /= queue(head)) .or. k == reached_by(queue(head))) cycle
                  other = sum(pairs(k)%links) - queue(head)
                  if (.not. known(other)) then
                     if (seen(other)) cycle
                     seen(other) = .true.
                     tail = tail + 1
                     queue(tail) = other
                     reached_by(other) = k
                     cycle
                  end if
                  call take(queue(head), k, other)
                  exit search
               end do
               head = head + 1
            end do search
         end do
      end do

   contains

      !> Note the chain that ends with a link and a pair to a known one, if none was shorter.
      subroutine take(last, pair, known_link)
         integer, intent(in) :: last, pair, known_link
         integer, allocatable :: links(:), way(:)
         integer :: here

         links = [last]
         way = [reached_by(last), pair]
         here = last
         do while (way(1) /= start)
            here = sum(pairs(way(1))%links) - here
            links = [here, links]
            way = [reached_by(here), way]
         end do
         if (size(links) >= length) return
         length = size(links)
         ear%links = links
         ear%pairs = way
         ear%first_link = pairs(start)%links(side)
         ear%last_link = known_link
      end subroutine take
   end subroutine find_ear

   !> A link that hangs on a known one by a pin, and gears or a drive turn it, or by a slide along which a drive moves it.
   pure subroutine find_branch(pairs, known, along, ear)
      type(pair_t), intent(in) :: pairs(:)
      logical, intent(in) :: known(:)              !! by link
      integer, intent(in) :: along(:)              !! by slide: the drive along it, 0: none
      type(ear_t), intent(out) :: ear
      integer :: k, side

      allocate (ear%pairs(0), ear%links(0))
      do k = 1, size(pairs)
         if (pairs(k)%used) cycle
         if (pairs(k)%slide > 0) then
            if (along(pairs(k)%slide) == 0) cycle
         end if
         do side = 1, 2
            if (.not. known(pairs(k)%links(side)) .or. known(pairs(k)%links(3 - side))) cycle
            ear%pairs = [k]
            ear%links = [pairs(k)%links(3 - side)]
            ear%first_link = pairs(k)%links(side)
            return
         end do
      end do
   end subroutine find_branch

   !> One ring: from the input pivot to the chain, along it, and back; of a branch to its end.
   subroutine trace_ring(closure, state, loop, first, pairs, ear, along, gears, tracing, loops, taken, why)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      integer, intent(in) :: loop, first           !! the loop, and how many arcs come before it
      type(pair_t), intent(in) :: pairs(:)
      type(ear_t), intent(in) :: ear
      integer, intent(in) :: along(:)              !! by slide: the drive along it, 0: none
      type(traced_gear_t), allocatable, intent(inout) :: gears(:) !! of the group: a ring of slides is one more
      type(tracing_t), intent(inout) :: tracing
      type(loops_t), intent(inout) :: loops
      logical, intent(out) :: taken                !! false: not the chain, but the driven link, which comes first
      character(:), allocatable, intent(inout) :: why
      type(path_step_t), allocatable :: out(:), back(:)
      type(traced_ring_t) :: ring
      logical :: from_right(size(ear%links)), found, ring_of_slides
      integer, allocatable :: at(:)
      integer :: i, k, n, begin

      associate (sketch => closure%sketch)
         n = size(ear%links)
         taken = .true.
         ring%loop = loop
         ring%first = size(loops%arcs) + 1
         if (ring%first == 1 .and. loops%floating) then
            loops%start = start_on_frame()
         else if (ring%first == 1 .and. sketch%drives(1)%kind == drive_slides) then
            call place_slider(1)
         end if
         if (ring%first == 1) then
            do k = 2, size(sketch%drives)
               if (sketch%drives(k)%kind == drive_slides .and. sketch%drives(k)%base == frame_link) call place_slider(k)
            end do
         end if
         ! the direction of a chain's end that slides on what is known comes from there
         from_right = .false.
         ring_of_slides = .false.
         if (size(ear%pairs) == 0) then
            call trace_input()
            return
         end if
         ring%closed = size(ear%pairs) > n
         if (.not. ring%closed) then
            call trace_branch()
            return
         end if
         if (pairs(ear%pairs(n + 1))%slide > 0) then
            do i = n, 1, -1
               from_right(i) = .true.
               if (pairs(ear%pairs(i))%slide == 0) exit
            end do
            ring_of_slides = i == 0
            if (ring_of_slides) then
               ! all links of the ring have the direction of the first known one, and so has the last
               from_right = .false.
               if (.not. ring%closed) why = 'slides that lead nowhere'
               if (len(why) > 0) return
               gears = [gears, traced_gear_t(0, [ear%first_link, ear%last_link], frame_link, 1.0_wp, of_slides=.true.)]
            end if
         end if
         call shortest(tracing, loops%start, point_on(ear%first_link, 1), .true., out, found)
         if (found) call way_from(tracing, loops%start, point_on(ear%last_link, n + 1), back, found)
         if (found .and. ring%first == 1 .and. .not. loops%floating) then
            found = size(out) > 0
            if (found) found = out(1)%arc > 0 .or. out(1)%link == sketch%drives(1)%link
            if (.not. found) then
               ! the chain begins at the pivot of the driven link, which no arc of it leads to
               taken = .false.
               call trace_input()
               return
            end if
         end if
         if (.not. found) then
            why = 'a group that no way leads to'
            return
         end if
         if (ring%first == 1 .and. .not. loops%floating) loops%axis(sketch%drives(1)%link) = 1
         do i = 1, size(out)
            call append_step(closure, loop, first, out(i), loops)
         end do
         if (ring%first == 1 .and. .not. loops%floating) call begin_with_input()
         begin = size(loops%arcs)
         do i = 1, n
            call add_slide_before(i)
            call add_vector(i)
         end do
         call add_slide_before(n + 1)
         ring%turn = max(begin, size(loops%arcs) - 1)
         do i = 1, size(back)
            call append_step(closure, loop, first, back(i), loops)
         end do
         ring%last = size(loops%arcs)
         ! links whose direction comes from behind have their axis now
         do k = begin + 1, ring%last
            associate (arc => loops%arcs(k))
               if (any(arc%kind == [traced_slide, traced_link, traced_actuator]) .or. arc%same .or. arc%against) cycle
               ! on the way back before the slide along which a drive moves the link
               if (arc%link /= frame_link .and. arc%reference == frame_axis) arc%reference = loops%axis(arc%link)
               do i = 1, n
                  if (arc%link == ear%links(i) .and. from_right(i)) arc%reference = loops%axis(arc%link)
               end do
            end associate
         end do
         if (ring%first == 1) call end_first_ring()
         call note_guides()
         loops%rings = [loops%rings, ring]
      end associate

   contains

      !> Slides take their direction from the arcs of their guides.
      subroutine note_guides()
         do k = ring%first, ring%last
            associate (arc => loops%arcs(k))
               if (arc%guide_link > 0 .and. .not. (arc%same .or. arc%against)) arc%reference = loops%axis(arc%guide_link)
            end associate
         end do
      end subroutine note_guides

      !> Where all rings begin if no link on the frame is driven first: a joint of the frame, of this ring if it has one.
      integer function start_on_frame() result(start)
         if (ear%first_link == frame_link) then
            start = point_on(frame_link, 1)
         else
            start = closure%sketch%links(frame_link)%joints(1)
         end if
      end function start_on_frame

      !> Forward arcs only: to the pin, and along the link to another joint of it, if there is one; or along a slide.
      subroutine trace_branch()
         type(traced_t) :: arc
         complex(wp) :: h

         call shortest(tracing, loops%start, point_on(ear%first_link, 1), .true., out, found)
         if (.not. found) then
            why = 'a link of a gear or a drive that no link leads to'
            return
         end if
         do i = 1, size(out)
            call append_step(closure, loop, first, out(i), loops)
         end do
         if (pairs(ear%pairs(1))%slide > 0) then
            call add_slide_before(1)
            call end_branch()
            return
         end if
         arc = traced_t(traced_link, loop, size(loops%arcs) - first + 1, ear%links(1), point_on(ear%links(1), 1))
         associate (joints => closure%sketch%links(ear%links(1))%joints)
            do i = 1, size(joints)
               if (joints(i) /= arc%ends(1)) arc%ends(2) = joints(i)
            end do
         end associate
         h = loops%point(arc%ends(2)) - loops%point(arc%ends(1))
         arc%length = abs(h)
         if (arc%length > 0.0_wp) arc%direction = degrees_of(h%re, h%im)
         loops%arcs = [loops%arcs, arc]
         loops%axis(ear%links(1)) = size(loops%arcs)
         call end_branch()
      end subroutine trace_branch

      !> The driven link alone: from where it is driven to another joint of it, if there is one.
      subroutine trace_input()
         integer :: to

         ring%closed = .false.
         associate (drive => closure%sketch%drives(1))
            loops%axis(drive%link) = 1
            to = loops%start
            if (drive%kind == drive_slides) then
               to = tracing%pass(2, 1)
               call append_step(closure, loop, first, path_step_t(0, loops%start, to, 1), loops)
            else
               at = pack(closure%sketch%links(drive%link)%joints, closure%sketch%links(drive%link)%joints /= to)
               if (size(at) > 0) to = at(1)
               call append_step(closure, loop, first, path_step_t(drive%link, loops%start, to), loops)
            end if
         end associate
         call begin_with_input()
         call end_branch()
      end subroutine trace_input

      !> If it is the first ring of all, an arc of the frame ends it.
      subroutine end_branch()
         ring%turn = size(loops%arcs)
         if (ring%first == 1) then
            call append_step(closure, loop, first, path_step_t(frame_link, loops%start, loops%start), loops)
            call end_first_ring()
         end if
         ring%last = size(loops%arcs)
         call note_guides()
         loops%rings = [loops%rings, ring]
      end subroutine end_branch

      !> The points of the line along which a drive moves a link on the frame. All rings begin at the first drive's on the frame.
      subroutine place_slider(drive)
         integer, intent(in) :: drive

         associate (slide => closure%sketch%drives(drive)%slide, slider => closure%sketch%drives(drive)%link)
            call add_line_point(closure, state, slide, position(frame_link, slide), tracing, loops)
            if (drive == 1) loops%start = tracing%points
            call add_line_point(closure, state, slide, position(slider, slide), tracing, loops)
            tracing%passes = tracing%passes + 1
            tracing%pass(:, tracing%passes) = [tracing%points - 1, tracing%points, merge(1, 0, drive == 1), &
                                               merge(0, drive, drive == 1)]
            ! and back to the frame
            tracing%passes = tracing%passes + 1
            tracing%pass(:, tracing%passes) = [tracing%points, tracing%points - 1, merge(-1, 0, drive == 1), &
                                               merge(0, -drive, drive == 1)]
         end associate
      end subroutine place_slider

      !> Which of a slide's two links a link is.
      pure integer function position(link, slide)
         integer, intent(in) :: link, slide

         position = findloc(closure%sketch%slides(slide)%links, link, dim=1)
      end function position

      !> The point of a link at the i-th pair of the chain.
      pure integer function point_on(link, pair)
         integer, intent(in) :: link, pair

         associate (of => pairs(ear%pairs(pair)))
            point_on = of%joint
            if (of%slide > 0) point_on = loops%line_point(position(link, of%slide), of%slide)
         end associate
      end function point_on

      pure integer function link_at(i)
         integer, intent(in) :: i                  !! 0 means the known link before the chain

         if (i == 0) then
            link_at = ear%first_link
         else if (i > n) then
            link_at = ear%last_link
         else
            link_at = ear%links(i)
         end if
      end function link_at

      !> The slide before the i-th link, if there is one: an arc of the link that takes its direction from the other.
      subroutine add_slide_before(i)
         integer, intent(in) :: i
         type(traced_t) :: arc
         integer :: body, guide
         logical :: from_last
         real(wp) :: turn

         associate (pair => pairs(ear%pairs(i)))
            if (pair%slide == 0) return
            body = link_at(i)
            guide = link_at(i - 1)
            from_last = ring_of_slides .and. i == n + 1
            ! between two links that are known: an arc of the one that the group finds
            if (from_last .and. n == 0) &
               from_last = closure%order%of_link(ear%first_link) >= closure%order%of_link(ear%last_link)
            if (i > 1 .and. .not. from_last) from_last = from_right(i - 1)
            if (from_last) then
               body = link_at(i - 1)
               guide = link_at(i)
            end if
            turn = state%phi(closure%sketch%slides(pair%slide)%links(1), 0)*degrees_per_radian
            arc = traced_t(traced_slide, loop, size(loops%arcs) - first + 1, body, &
                           [point_on(link_at(i - 1), i), point_on(link_at(i), i)])
            arc%direction = closure%sketch%slides(pair%slide)%angle + turn
            arc%slide = pair%slide
            arc%guide_link = guide
            arc%foot_last = guide == link_at(i)
            if (along(pair%slide) > 0) then
               arc%kind = traced_actuator
               arc%drive = along(pair%slide)
               ! the drive counts from its base to the link that it moves
               if (closure%sketch%drives(arc%drive)%link == link_at(i - 1)) arc%direction = arc%direction + half_turn
            end if
            loops%arcs = [loops%arcs, arc]
            if (loops%axis(body) == 0 .or. .not. ring_of_slides) loops%axis(body) = size(loops%arcs)
            if (arc%drive > 1) loops%seconds(arc%drive - 1)%arc = size(loops%arcs)
            call add_passes(arc%ends, size(loops%arcs))
         end associate
      end subroutine add_slide_before

      subroutine add_passes(ends, arc)
         integer, intent(in) :: ends(2), arc

         if (tracing%passes + 2 > size(tracing%pass, 2)) return
         tracing%pass(:, tracing%passes + 1) = [ends, arc, 0]
         tracing%pass(:, tracing%passes + 2) = [ends(2), ends(1), -arc, 0]
         tracing%passes = tracing%passes + 2
      end subroutine add_passes

      !> The vector on the i-th link from the pair before it to that after it.
      subroutine add_vector(i)
         integer, intent(in) :: i
         type(traced_t) :: arc
         integer :: ends(2)
         complex(wp) :: h
         logical :: own

         ends = [point_on(ear%links(i), i), point_on(ear%links(i), i + 1)]
         own = pairs(ear%pairs(i))%slide == 0 .and. .not. from_right(i)
         if (.not. own) then
            if (ends(1) == ends(2)) return
            ! with the axis of the frame for the moment where the link's own comes after it
            if (from_right(i)) loops%axis(ear%links(i)) = frame_axis
            call append_step(closure, loop, first, path_step_t(ear%links(i), ends(1), ends(2)), loops)
            return
         end if
         h = loops%point(ends(2)) - loops%point(ends(1))
         arc = traced_t(traced_link, loop, size(loops%arcs) - first + 1, ear%links(i), ends)
         arc%length = abs(h)
         if (arc%length > 0.0_wp) arc%direction = degrees_of(h%re, h%im)
         if (closure%cylinder(ear%links(i)) > 0) then
            arc%kind = traced_actuator
            arc%cylinder = .true.
            arc%drive = closure%cylinder(ear%links(i))
            arc%foot_last = closure%sketch%links(ear%links(i))%joints(1) == ends(1)
            if (arc%drive > 1) loops%seconds(arc%drive - 1)%arc = size(loops%arcs) + 1
         end if
         loops%arcs = [loops%arcs, arc]
         loops%axis(ear%links(i)) = size(loops%arcs)
         tracing%on(ends, ear%links(i)) = .true.
      end subroutine add_vector

      !> The first arc of all is the input.
      subroutine begin_with_input()
         associate (arc => loops%arcs(1), sketch => closure%sketch)
            if (sketch%drives(1)%kind == drive_turns) then
               arc%kind = traced_crank
               loops%input = arc%direction
            else
               arc%kind = traced_actuator
               arc%direction = sketch%slides(arc%slide)%angle
               arc%guide_link = frame_link
               loops%input = 0.0_wp
            end if
         end associate
      end subroutine begin_with_input

      !> The last arc of the first ring is the frame's own; others of the frame hang on it.
      subroutine end_first_ring()
         associate (last => size(loops%arcs))
            loops%arcs(last)%kind = traced_frame
            loops%arcs(last)%reference = 0
            loops%arcs(last)%same = .false.
            where (loops%axis == frame_axis) loops%axis = last
            where (loops%arcs%reference == frame_axis) loops%arcs%reference = last
         end associate
      end subroutine end_first_ring
   end subroutine trace_ring
end module psalm_group_trace
