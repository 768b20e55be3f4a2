!> Loops for a sketch: the arrays ILINK, ILOOP, ARCL, GAMA of a chain of dyads, lengths, angles and signs read off the drawing.
!>
!> Each dyad closes one loop: from the input pivot on the fewest arcs through links that are known to the dyad, through its two
!> links, and back by the fewest arcs to the frame. A slide is passed along only, never against its sense, for the arrays know
!> no other; a chain that needs that, a drive that is not on the frame and a group that is no dyad have no such arrays.
!> Source: Oldham (1977), 15.1, the choice of minimal loops; signs: doc/manual.md, How a linkage is described.
module psalm_sketch_loops
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_closure, only: closure_t, state_t, row_pin, row_line
   use psalm_kinds, only: wp, half_turn, right_angle, degrees_per_radian
   use psalm_sketch, only: sketch_t, frame_link, drive_slides, drive_turns
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: loops_t, traced_t, make_loops, arc_with
   public :: traced_determined, traced_link, traced_slide, traced_crank, traced_actuator, traced_frame

   integer, parameter :: traced_determined = 1
   integer, parameter :: traced_link = 2
   integer, parameter :: traced_slide = 3
   integer, parameter :: traced_crank = 4
   integer, parameter :: traced_actuator = 5
   integer, parameter :: traced_frame = 6      !! the last arc of loop 1, counted from the machine's x axis

   real(wp), parameter :: no_length = 1.0e-13_wp  !! of the drawing's size: a guide without length
   integer, parameter :: frame_axis = -1          !! reference that is not known before loop 1 is done

   !> One arc of a loop.
   type :: traced_t
      integer :: kind = traced_determined
      integer :: loop = 0, place = 0
      integer :: link = 0                   !! the link it is fixed in
      integer :: ends(2) = 0                !! points
      integer :: reference = 0              !! arc it hangs on
      logical :: same = .false., against = .false. !! it is that arc, traced the same way or the other
      integer :: guide = 0                  !! slides: the place of the guide in the loop
      integer :: sign = 1
      integer :: slide = 0                  !! the slide of the sketch that it runs along
      real(wp) :: length = 0.0_wp
      real(wp) :: direction = 0.0_wp        !! in the drawing, degrees
   end type traced_t

   !> The loops found.
   type :: loops_t
      logical :: found = .false.
      character(:), allocatable :: why      !! what there are no arrays for
      type(traced_t), allocatable :: arcs(:)
      integer :: loops = 0, longest = 0
      complex(wp), allocatable :: point(:)  !! places of the points: the joints, then feet of slides
      integer :: start = 0                  !! the point that all loops begin at
      integer, allocatable :: axis(:)       !! by link: its first arc
      real(wp) :: input = 0.0_wp            !! CRNKI in the drawing
      logical, allocatable :: on(:, :)      !! shape (points, links): the point is fixed in the link
      integer, allocatable :: joint_loop(:) !! by joint: the loop whose dyad places it
   end type loops_t

   !> A step of a path: an arc of a link, or a slide passed again.
   type :: step_t
      integer :: link = 0
      integer :: from = 0, to = 0
      integer :: arc = 0                    !! of a slide
   end type step_t

   !> A dyad in one sense of tracing: S side, inner pair, E side.
   type :: dyad_t
      integer :: links(2) = 0               !! S side, E side
      integer :: joint(2) = 0, slide(2) = 0 !! outer pairs: a joint or a slide
      integer :: known(2) = 0               !! the known links there
      integer :: inner_joint = 0, inner_slide = 0
   end type dyad_t

   !> What is known on the way.
   type :: survey_t
      logical, allocatable :: on(:, :)      !! shape (points, links): the point is fixed in the link
      logical, allocatable :: known(:)      !! by link
      integer :: points = 0
      integer :: pass(3, 1000) = 0          !! slides that can be passed: from, to, arc
      integer :: passes = 0
   end type survey_t

contains

   !> Choose the loops. `state` is the sketch as assembled.
   subroutine make_loops(closure, state, loops)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(loops_t), intent(out) :: loops
      type(survey_t) :: survey
      type(dyad_t) :: dyad
      integer, allocatable :: order(:)
      integer :: k, g, crank, room
      logical :: valid

      loops%why = ''
      associate (sketch => closure%sketch, groups => closure%order%groups)
         if (size(sketch%drives) /= 1) then
            loops%why = 'several drives'
         else if (sketch%drives(1)%base /= frame_link .or. all(sketch%drives(1)%kind /= [drive_turns, drive_slides])) then
            loops%why = 'a drive that is not on the frame'
         else if (size(sketch%gears) > 0) then
            loops%why = 'gears'
         else if (sketch%over_braced) then
            loops%why = 'special dimensions (KOVER)'
         end if
         do g = 1, size(groups)
            if (len(loops%why) == 0 .and. groups(g)%order > 2) loops%why = 'a group of '//to_text(groups(g)%order)//' links'
         end do
         if (len(loops%why) > 0) return
         room = size(sketch%joint_name) + 2*size(sketch%links) + 1
         allocate (survey%on(room, size(sketch%links)), source=.false.)
         allocate (survey%known(size(sketch%links)), source=.false.)
         allocate (loops%axis(size(sketch%links)), loops%joint_loop(size(sketch%joint_name)), source=0)
         allocate (loops%point(room), source=(0.0_wp, 0.0_wp))
         allocate (loops%arcs(0))
         survey%points = size(sketch%joint_name)
         loops%point(:survey%points) = state%joint(:, 0)
         crank = sketch%drives(1)%link
         call know(sketch, frame_link, survey)
         call know(sketch, crank, survey)
         loops%start = sketch%drives(1)%joint
         loops%axis(frame_link) = frame_axis
         if (sketch%drives(1)%kind == drive_slides) loops%axis(crank) = frame_axis
         call dyads_in_order(closure, crank, order)
         do k = 1, size(order)
            call understand(closure, order(k), survey, dyad, valid)
            if (valid) call close_loop(closure, state, dyad, survey, loops, valid)
            if (.not. valid) then
               loops%why = 'a slide passed against its sense'
               if (k == 1) loops%why = 'the first dyad, which does not hang on the driven link by a joint'
               return
            end if
            call know(sketch, dyad%links(1), survey)
            call know(sketch, dyad%links(2), survey)
            if (dyad%inner_joint > 0) loops%joint_loop(dyad%inner_joint) = k
         end do
         loops%on = survey%on
         loops%loops = size(order)
         loops%found = loops%loops > 0
         if (.not. loops%found) loops%why = 'no dyad'
      end associate
   end subroutine make_loops

   !> The dyads, the first being one that hangs on the driven link.
   subroutine dyads_in_order(closure, crank, order)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: crank
      integer, allocatable, intent(out) :: order(:)
      integer :: g, k

      allocate (order(0))
      do g = 1, size(closure%groups)
         if (closure%order%groups(g)%order == 2) order = [order, g]
      end do
      do k = 1, size(order)
         if (.not. touches(order(k))) cycle
         order = [order(k), order(:k - 1), order(k + 1:)]
         return
      end do

   contains

      logical function touches(group)
         integer, intent(in) :: group
         integer :: r

         touches = .false.
         do r = 1, size(closure%groups(group)%rows)
            touches = touches .or. any(closure%groups(group)%rows(r)%links == crank)
         end do
      end function touches
   end subroutine dyads_in_order

   !> A link whose place is known, and its joints.
   subroutine know(sketch, link, survey)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: link
      type(survey_t), intent(inout) :: survey

      survey%known(link) = .true.
      survey%on(sketch%links(link)%joints, link) = .true.
   end subroutine know

   !> The pairs of a dyad. `valid` is false where a group of two links is no dyad of one inner and two outer pairs.
   subroutine understand(closure, group, survey, dyad, valid)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: group
      type(survey_t), intent(in) :: survey
      type(dyad_t), intent(out) :: dyad
      logical, intent(out) :: valid
      integer :: r, side, other, pairs

      valid = size(closure%groups(group)%links) == 2
      if (.not. valid) return
      dyad%links = closure%groups(group)%links
      pairs = 0
      do r = 1, size(closure%groups(group)%rows)
         associate (row => closure%groups(group)%rows(r))
            if (row%kind /= row_pin .and. row%kind /= row_line) cycle
            pairs = pairs + 1
            if (all([(any(dyad%links == row%links(side)), side=1, 2)])) then
               if (row%kind == row_pin) dyad%inner_joint = row%which
               if (row%kind == row_line) dyad%inner_slide = row%which
               cycle
            end if
            other = merge(1, 2, any(dyad%links == row%links(2)))
            side = findloc(dyad%links, row%links(3 - other), dim=1)
            if (dyad%known(side) > 0) valid = .false.
            dyad%known(side) = row%links(other)
            if (row%kind == row_pin) dyad%joint(side) = row%which
            if (row%kind == row_line) dyad%slide(side) = row%which
         end associate
      end do
      valid = valid .and. pairs == 3 .and. all(dyad%known > 0) .and. (dyad%inner_joint > 0 .neqv. dyad%inner_slide > 0)
      if (valid) valid = all(survey%known(dyad%known))
   end subroutine understand

   ! ---- one loop ----------------------------------------------------------------------------------------------------

   !> Trace the loop of a dyad, in the sense that takes fewer arcs.
   subroutine close_loop(closure, state, dyad, survey, loops, valid)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(dyad_t), intent(inout) :: dyad
      type(survey_t), intent(inout) :: survey
      type(loops_t), intent(inout) :: loops
      logical, intent(out) :: valid
      type(survey_t) :: surveys(2)
      type(loops_t) :: tried(2)
      logical :: sound(2)
      integer :: way

      do way = 1, 2
         tried(way) = loops
         surveys(way) = survey
         call trace(closure, state, turned_round(dyad, way == 2), surveys(way), tried(way), sound(way))
      end do
      valid = any(sound)
      if (.not. valid) return
      way = merge(1, 2, sound(1))
      if (all(sound)) way = merge(1, 2, size(tried(1)%arcs) <= size(tried(2)%arcs))
      dyad = turned_round(dyad, way == 2)
      survey = surveys(way)
      loops = tried(way)
   end subroutine close_loop

   pure type(dyad_t) function turned_round(dyad, round) result(other)
      type(dyad_t), intent(in) :: dyad
      logical, intent(in) :: round

      other = dyad
      if (.not. round) return
      other%links = dyad%links(2:1:-1)
      other%joint = dyad%joint(2:1:-1)
      other%slide = dyad%slide(2:1:-1)
      other%known = dyad%known(2:1:-1)
   end function turned_round

   subroutine trace(closure, state, dyad, survey, loops, valid)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(dyad_t), intent(in) :: dyad
      type(survey_t), intent(inout) :: survey
      type(loops_t), intent(inout) :: loops
      logical, intent(out) :: valid
      type(step_t), allocatable :: out(:), back(:)
      integer :: loop, s, e, inner, foot(2), guide, first, i, last_guide
      real(wp) :: p_direction, q_direction, sense
      complex(wp) :: d, x

      loop = 1
      if (size(loops%arcs) > 0) loop = maxval(loops%arcs%loop) + 1
      first = size(loops%arcs)
      foot = 0
      inner = dyad%inner_joint
      valid = .false.
      if (loop == 1 .and. closure%sketch%drives(1)%kind == drive_slides) then
         if (dyad%joint(1) == 0) return
         if (.not. survey%on(dyad%joint(1), closure%sketch%drives(1)%link)) return
         call place_actuator()
      end if
      if (dyad%inner_slide > 0 .and. dyad%slide(1) > 0) return   ! PPR: the other sense is RPP
      ! feet of guides on the lines of outer slides
      if (dyad%slide(1) > 0) then
         call way_out(survey, loops, dyad%known(1), s, out, valid)
         if (.not. valid) return
         foot(1) = foot_of(slide_line(dyad%slide(1)), z(inner), s, dyad%known(1))
         out = [out, step_t(dyad%known(1), s, foot(1))]
      else
         s = dyad%joint(1)
         call shortest(survey, [loops%start], s, .true., out, valid)
         if (.not. valid) return
      end if
      if (dyad%slide(2) > 0) then
         call way_back(survey, loops, dyad%known(2), e, back, valid)
         if (.not. valid) return
         x = z(max(inner, 1))
         if (dyad%inner_slide > 0) x = crossing()
         if (dyad%inner_slide > 0) then
            foot(2) = e
            if (dyad%known(2) /= frame_link .or. .not. last_guides()) back = [step_t(dyad%known(2), e, e), back]
         else
            foot(2) = foot_of(slide_line(dyad%slide(2)), x, e, dyad%known(2))
            if (dyad%known(2) == frame_link .and. .not. last_guides()) then
               ! the last frame arc guides the actuator: this slide has a guide of its own, without length
               back(1)%from = foot(2)
               back = [step_t(frame_link, foot(2), foot(2)), back]
            else if (dyad%known(2) == frame_link) then
               back(1)%from = foot(2)
            else
               back = [step_t(dyad%known(2), foot(2), e), back]
            end if
         end if
      else
         e = dyad%joint(2)
         call way_from(survey, loops, e, back, valid)
         if (.not. valid) return
      end if
      if (loop == 1) then
         valid = size(out) == 1
         if (valid) valid = out(1)%arc > 0 .or. out(1)%link == closure%sketch%drives(1)%link
         if (.not. valid) return
      end if
      do i = 1, size(out)
         call add_step(out(i))
      end do
      if (loop == 1 .and. closure%sketch%drives(1)%kind == drive_turns) loops%arcs(first + 1)%kind = traced_crank
      if (loop == 1 .and. closure%sketch%drives(1)%kind == drive_turns) loops%axis(closure%sketch%drives(1)%link) = first + 1
      if (loop == 1) loops%input = loops%arcs(first + 1)%direction
      select case (merge(4, 0, dyad%inner_slide > 0) + merge(2, 0, dyad%slide(1) > 0) + merge(1, 0, dyad%slide(2) > 0))
      case (0)  ! RRR
         sense = -side_of(z(s), z(e), z(inner))
         call add_link(dyad%links(1), s, inner, sense)
         call add_link(dyad%links(2), inner, e, sense)
         call add_back()
      case (1)  ! RRP
         d = slide_line(dyad%slide(2))
         q_direction = toward(inner, foot(2), d)
         guide = size(loops%arcs) - first + 3
         sense = guide_sense(q_direction, foot(2), back(1)%to)
         call add_link(dyad%links(1), s, inner, ahead(inner, s, q_direction))
         call add_slide(dyad%links(2), inner, foot(2), q_direction, guide, sense, dyad%slide(2))
         survey%on(foot(2), dyad%known(2)) = .true.
         call add_back(q_direction + sense*right_angle)
      case (2)  ! PRR
         d = slide_line(dyad%slide(1))
         p_direction = toward(foot(1), inner, d)
         guide = size(loops%arcs) - first
         sense = guide_sense_before(p_direction, s, foot(1))
         call set_guide_direction(p_direction - sense*right_angle)
         call add_slide(dyad%links(1), foot(1), inner, p_direction, guide, sense, dyad%slide(1))
         call add_link(dyad%links(2), inner, e, ahead(inner, e, p_direction))
         survey%on(foot(1), dyad%known(1)) = .true.
         call add_back()
      case (3)  ! PRP
         d = slide_line(dyad%slide(1))
         p_direction = toward(foot(1), inner, d)
         guide = size(loops%arcs) - first
         sense = guide_sense_before(p_direction, s, foot(1))
         call set_guide_direction(p_direction - sense*right_angle)
         call add_slide(dyad%links(1), foot(1), inner, p_direction, guide, sense, dyad%slide(1))
         d = slide_line(dyad%slide(2))
         q_direction = toward(inner, foot(2), d)
         guide = size(loops%arcs) - first + 2
         sense = guide_sense(q_direction, foot(2), back(1)%to)
         call add_slide(dyad%links(2), inner, foot(2), q_direction, guide, sense, dyad%slide(2))
         survey%on(foot(1), dyad%known(1)) = .true.
         survey%on(foot(2), dyad%known(2)) = .true.
         call add_back(q_direction + sense*right_angle)
      case (4)  ! RPR: the slide runs through S, its guide leads to E
         d = slide_line(dyad%inner_slide)
         foot(1) = foot_of(d, z(s), e, dyad%links(2))
         p_direction = toward(s, foot(1), d)
         sense = guide_sense(p_direction, foot(1), e)
         guide = size(loops%arcs) - first + 2
         call add_slide(dyad%links(1), s, foot(1), p_direction, guide, sense, dyad%inner_slide)
         call add_link(dyad%links(2), foot(1), e, sense)
         loops%arcs(size(loops%arcs))%direction = p_direction + sense*right_angle
         if (loops%arcs(size(loops%arcs))%length <= no_length*closure%size) loops%arcs(size(loops%arcs))%length = 0.0_wp
         call add_back()
      case (5)  ! RPP: both directions are those of the known link of E
         d = slide_line(dyad%inner_slide)
         foot(1) = new_point(x)
         survey%on(foot(1), dyad%links(2)) = .true.
         p_direction = toward(s, foot(1), d)
         call add_step(step_t(dyad%known(2), s, s), p_direction - right_angle)
         guide = size(loops%arcs) - first
         call add_slide(dyad%links(1), s, foot(1), p_direction, guide, 1.0_wp, dyad%inner_slide)
         q_direction = toward(foot(1), e, slide_line(dyad%slide(2)))
         guide = size(loops%arcs) - first + 2
         call add_slide(dyad%links(2), foot(1), e, q_direction, guide, 1.0_wp, dyad%slide(2))
         call add_back(q_direction + right_angle)
      case default
         valid = .false.
         return
      end select
      if (loop == 1) then
         last_guide = size(loops%arcs)
         loops%arcs(last_guide)%kind = traced_frame
         loops%arcs(last_guide)%reference = 0
         loops%arcs(last_guide)%same = .false.
         where (loops%axis == frame_axis) loops%axis = last_guide
         where (loops%arcs%reference == frame_axis) loops%arcs%reference = last_guide
         if (closure%sketch%drives(1)%kind == drive_slides) then
            loops%arcs(first + 1)%guide = last_guide - first
            d = slide_line(closure%sketch%drives(1)%slide)
            if (closure%sketch%slides(closure%sketch%drives(1)%slide)%links(1) /= frame_link) d = -d
            p_direction = degrees_of(d%re, d%im)
            loops%arcs(first + 1)%direction = p_direction
            ! the guide is passed before the slide
            sense = 1.0_wp
            if (loops%arcs(last_guide)%length > 0.0_wp) then
               x = z(loops%arcs(last_guide)%ends(2)) - z(loops%arcs(last_guide)%ends(1))
               sense = sign(1.0_wp, aimag(conjg(x)*d))
            end if
            loops%arcs(last_guide)%direction = p_direction - sense*right_angle
            loops%arcs(first + 1)%sign = nint(sense)
            x = z(loops%arcs(first + 1)%ends(2)) - z(loops%arcs(first + 1)%ends(1))
            loops%input = real(conjg(d)*x, wp)
         end if
      end if
      loops%longest = max(loops%longest, size(loops%arcs) - first)
      valid = .true.

   contains

      complex(wp) function z(point)
         integer, intent(in) :: point

         z = loops%point(point)
      end function z

      !> Direction of a slide's line as assembled, a unit vector.
      complex(wp) function slide_line(slide)
         integer, intent(in) :: slide
         real(wp) :: c, t

         call unit_vector(closure%sketch%slides(slide)%angle &
                          + state%phi(closure%sketch%slides(slide)%links(1), 0)*degrees_per_radian, c, t)
         slide_line = cmplx(c, t, wp)
      end function slide_line

      integer function new_point(place)
         complex(wp), intent(in) :: place

         survey%points = survey%points + 1
         new_point = survey%points
         loops%point(new_point) = place
      end function new_point

      !> The foot, on the line through a place along d, of the perpendicular from a point; a point of the link `owner`.
      integer function foot_of(direction, through, from, owner) result(point)
         complex(wp), intent(in) :: direction, through
         integer, intent(in) :: from, owner

         point = new_point(through + direction*real(conjg(direction)*(z(from) - through), wp))
         survey%on(point, owner) = .true.
      end function foot_of

      !> Where the line of the inner slide through S meets the line of the outer slide through the point it is counted from.
      complex(wp) function crossing()
         complex(wp) :: d1, d2, h

         d1 = slide_line(dyad%inner_slide)
         d2 = slide_line(dyad%slide(2))
         h = z(e) - z(s)
         crossing = z(s) + d1*(aimag(conjg(d2)*h)/aimag(conjg(d2)*d1))
      end function crossing

      !> Direction from a point to another along a line, degrees; that of the line where they are one.
      real(wp) function toward(from, to, direction)
         integer, intent(in) :: from, to
         complex(wp), intent(in) :: direction
         complex(wp) :: along

         along = direction
         if (real(conjg(direction)*(z(to) - z(from)), wp) < -no_length*closure%size) along = -direction
         toward = degrees_of(along%re, along%im)
      end function toward

      !> +1 if the guide from the foot leads to the left of the slide's direction, or has no length.
      real(wp) function guide_sense(direction, from, to)
         real(wp), intent(in) :: direction
         integer, intent(in) :: from, to
         real(wp) :: c, t

         guide_sense = 1.0_wp
         if (abs(z(to) - z(from)) <= no_length*closure%size) return
         call unit_vector(direction, c, t)
         guide_sense = sign(1.0_wp, aimag(cmplx(c, -t, wp)*(z(to) - z(from))))
      end function guide_sense

      !> The same for a guide that leads to the foot: its direction and a right angle anticlockwise are that of the slide.
      real(wp) function guide_sense_before(direction, from, to)
         real(wp), intent(in) :: direction
         integer, intent(in) :: from, to

         guide_sense_before = 1.0_wp
         if (abs(z(to) - z(from)) > no_length*closure%size) guide_sense_before = -guide_sense(direction, from, to)
      end function guide_sense_before

      !> +1 if a point lies on the left of the line from another to a third.
      real(wp) function side_of(from, to, point)
         complex(wp), intent(in) :: from, to, point

         side_of = sign(1.0_wp, aimag(conjg(to - from)*(point - from)))
      end function side_of

      !> +1 if a joint lies ahead, in the slide's direction, of the foot of the link's other joint.
      real(wp) function ahead(joint, other, direction)
         integer, intent(in) :: joint, other
         real(wp), intent(in) :: direction
         real(wp) :: c, t

         call unit_vector(direction, c, t)
         ahead = sign(1.0_wp, real(cmplx(c, -t, wp)*(z(joint) - z(other)), wp))
      end function ahead

      !> True if the last frame arc may guide a slide of the dyad: loop 1 of a sliding input needs it for that.
      logical function last_guides()
         last_guides = loop > 1 .or. closure%sketch%drives(1)%kind == drive_turns
      end function last_guides

      !> The start of all loops of a sliding input: the foot, on the line through the first dyad's joint, of the last frame joint.
      subroutine place_actuator()
         complex(wp) :: line
         integer :: anchor

         line = slide_line(closure%sketch%drives(1)%slide)
         anchor = dyad%joint(1)
         if (dyad%joint(2) > 0 .and. dyad%known(2) == frame_link) anchor = dyad%joint(2)
         if (anchor == dyad%joint(1) .and. size(closure%sketch%links(frame_link)%joints) > 0) &
            anchor = closure%sketch%links(frame_link)%joints(1)
         loops%start = foot_of(line, z(dyad%joint(1)), anchor, frame_link)
         survey%passes = survey%passes + 1
         survey%pass(:, survey%passes) = [loops%start, dyad%joint(1), 1]
      end subroutine place_actuator

      ! ---- arcs

      !> Append an arc of a link, or a slide passed again.
      subroutine add_step(step, direction)
         type(step_t), intent(in) :: step
         real(wp), intent(in), optional :: direction !! of an arc without length
         type(traced_t) :: arc
         complex(wp) :: h
         integer :: k

         arc%loop = loop
         arc%place = size(loops%arcs) - first + 1
         arc%link = step%link
         arc%ends = [step%from, step%to]
         if (step%arc > 0 .and. size(loops%arcs) == 0) then
            arc%kind = traced_actuator
            arc%link = closure%sketch%drives(1)%link
            arc%slide = closure%sketch%drives(1)%slide
            loops%arcs = [loops%arcs, arc]
            return
         end if
         if (step%arc > 0) then
            arc%reference = step%arc
            arc%same = .true.
            arc%link = loops%arcs(step%arc)%link
            arc%direction = loops%arcs(step%arc)%direction
            loops%arcs = [loops%arcs, arc]
            return
         end if
         h = z(step%to) - z(step%from)
         arc%length = abs(h)
         if (arc%length <= no_length*closure%size) arc%length = 0.0_wp
         if (present(direction)) then
            arc%direction = direction
         else if (arc%length > 0.0_wp) then
            arc%direction = degrees_of(h%re, h%im)
         end if
         arc%reference = loops%axis(step%link)
         do k = 1, size(loops%arcs)
            associate (old => loops%arcs(k))
               if (old%link /= step%link .or. old%same .or. old%kind == traced_slide .or. old%kind == traced_actuator) cycle
               if (arc%length == 0.0_wp) cycle
               if (all(old%ends == arc%ends)) then
                  arc%same = .true.
                  arc%reference = k
                  arc%length = old%length
                  arc%direction = old%direction
                  exit
               else if (all(old%ends == arc%ends(2:1:-1))) then
                  arc%against = .true.
                  arc%reference = k
                  arc%length = old%length
                  arc%direction = old%direction + half_turn
                  exit
               end if
            end associate
         end do
         loops%arcs = [loops%arcs, arc]
      end subroutine add_step

      !> The arcs after the dyad; the first has a given direction, square to its slide, or none.
      subroutine add_back(direction)
         real(wp), intent(in), optional :: direction
         integer :: k

         do k = 1, size(back)
            if (k == 1 .and. present(direction)) then
               call add_step(back(k), direction)
            else
               call add_step(back(k))
            end if
         end do
      end subroutine add_back

      !> The guide just traced is square to its slide.
      subroutine set_guide_direction(direction)
         real(wp), intent(in) :: direction

         loops%arcs(size(loops%arcs))%direction = direction
         if (loop == 1) loops%input = direction
      end subroutine set_guide_direction

      subroutine add_link(link, from, to, sense)
         integer, intent(in) :: link, from, to
         real(wp), intent(in) :: sense
         type(traced_t) :: arc
         complex(wp) :: h

         h = z(to) - z(from)
         arc = traced_t(traced_link, loop, size(loops%arcs) - first + 1, link, [from, to])
         arc%length = abs(h)
         arc%direction = degrees_of(h%re, h%im)
         arc%sign = nint(sense)
         loops%arcs = [loops%arcs, arc]
         loops%axis(link) = size(loops%arcs)
         survey%on(from, link) = .true.
         survey%on(to, link) = .true.
      end subroutine add_link

      subroutine add_slide(link, from, to, direction, guide_place, sense, slide)
         integer, intent(in) :: link, from, to, guide_place, slide
         real(wp), intent(in) :: direction, sense
         type(traced_t) :: arc

         arc = traced_t(traced_slide, loop, size(loops%arcs) - first + 1, link, [from, to])
         arc%direction = direction
         arc%guide = guide_place
         arc%sign = nint(sense)
         arc%slide = slide
         loops%arcs = [loops%arcs, arc]
         loops%axis(link) = size(loops%arcs)
         if (survey%passes < size(survey%pass, 2)) then
            survey%passes = survey%passes + 1
            survey%pass(:, survey%passes) = [from, to, size(loops%arcs)]
         end if
      end subroutine add_slide
   end subroutine trace

   ! ---- paths -------------------------------------------------------------------------------------------------------

   !> The point of a known link from which a guide leads to a slide, and the way there from the input pivot.
   subroutine way_out(survey, loops, link, point, steps, found)
      type(survey_t), intent(in) :: survey
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: link
      integer, intent(out) :: point
      type(step_t), allocatable, intent(out) :: steps(:)
      logical, intent(out) :: found
      type(step_t), allocatable :: way(:)
      logical :: there
      integer :: p

      found = .false.
      point = 0
      allocate (steps(0))
      do p = 1, survey%points
         if (.not. survey%on(p, link)) cycle
         call shortest(survey, [loops%start], p, .true., way, there)
         if (.not. there) cycle
         if (found) then
            if (size(way) >= size(steps)) cycle
         end if
         found = .true.
         point = p
         steps = way
      end do
   end subroutine way_out

   !> The same for the way back to the frame.
   subroutine way_back(survey, loops, link, point, steps, found)
      type(survey_t), intent(in) :: survey
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: link
      integer, intent(out) :: point
      type(step_t), allocatable, intent(out) :: steps(:)
      logical, intent(out) :: found
      type(step_t), allocatable :: way(:)
      logical :: there
      integer :: p

      found = .false.
      point = 0
      allocate (steps(0))
      if (link == frame_link) then
         point = loops%start
         steps = [step_t(frame_link, point, point)]
         found = .true.
         return
      end if
      do p = 1, survey%points
         if (.not. survey%on(p, link)) cycle
         call way_from(survey, loops, p, way, there)
         if (.not. there) cycle
         if (found) then
            if (size(way) >= size(steps)) cycle
         end if
         found = .true.
         point = p
         steps = way
      end do
   end subroutine way_back

   !> From a point to the frame, not through it, and along the frame to the input pivot.
   subroutine way_from(survey, loops, from, steps, found)
      type(survey_t), intent(in) :: survey
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: from
      type(step_t), allocatable, intent(out) :: steps(:)
      logical, intent(out) :: found
      type(step_t), allocatable :: way(:)
      logical :: there
      integer :: p

      found = .false.
      allocate (steps(0))
      do p = 1, survey%points
         if (.not. survey%on(p, frame_link)) cycle
         call shortest(survey, [from], p, .false., way, there)
         if (.not. there) cycle
         way = [way, step_t(frame_link, p, loops%start)]
         if (found) then
            if (size(way) >= size(steps)) cycle
         end if
         found = .true.
         steps = way
      end do
   end subroutine way_from

   !> Fewest arcs from a point to another through links that are known (breadth first).
   subroutine shortest(survey, from, to, through_frame, steps, found)
      type(survey_t), intent(in) :: survey
      integer, intent(in) :: from(1), to
      logical, intent(in) :: through_frame
      type(step_t), allocatable, intent(out) :: steps(:)
      logical, intent(out) :: found
      type(step_t) :: reached_by(survey%points)
      integer :: queue(survey%points), head, tail, link, p, k
      logical :: seen(survey%points)

      allocate (steps(0))
      seen = .false.
      seen(from(1)) = .true.
      queue(1) = from(1)
      head = 1
      tail = 1
      do while (head <= tail .and. .not. seen(to))
         associate (here => queue(head))
            do link = 1, size(survey%known)
               if (.not. survey%known(link) .or. .not. survey%on(here, link)) cycle
               if (link == frame_link .and. .not. through_frame) cycle
               do p = 1, survey%points
                  if (seen(p) .or. .not. survey%on(p, link)) cycle
                  seen(p) = .true.
                  tail = tail + 1
                  queue(tail) = p
                  reached_by(p) = step_t(link, here, p)
               end do
            end do
            do k = 1, survey%passes
               p = survey%pass(2, k)
               if (survey%pass(1, k) /= here .or. seen(p)) cycle
               seen(p) = .true.
               tail = tail + 1
               queue(tail) = p
               reached_by(p) = step_t(0, here, p, survey%pass(3, k))
            end do
         end associate
         head = head + 1
      end do
      found = seen(to)
      if (.not. found) return
      p = to
      do while (p /= from(1))
         steps = [reached_by(p), steps]
         p = reached_by(p)%from
      end do
   end subroutine shortest

   !> The first arc of a link that begins (`from_start`) or ends at a point; 0: none does.
   pure subroutine arc_with(loops, link, point, arc, from_start)
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: link, point
      integer, intent(out) :: arc
      logical, intent(out) :: from_start
      integer :: k

      arc = 0
      from_start = .false.
      do k = 1, size(loops%arcs)
         associate (one => loops%arcs(k))
            if (one%link /= link .or. one%same .or. one%against) cycle
            if (.not. loops%on(point, link)) return
            if (one%ends(2) == point) then
               arc = k
               from_start = .false.
               return
            end if
            if (one%ends(1) == point .and. arc == 0) then
               arc = k
               from_start = .true.
            end if
         end associate
      end do
   end subroutine arc_with
end module psalm_sketch_loops
