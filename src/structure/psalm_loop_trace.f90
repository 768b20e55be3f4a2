!> One loop of a sketch: the arcs that close a dyad, with lengths, directions and signs read off the drawing.
!>
!> From the input pivot on the fewest arcs through links that are known to the dyad, through its two links, and back by the fewest
!> arcs to the frame. Source: Oldham (1977), 15.1; signs: doc/guide/loops.md.
module psalm_loop_trace
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_closure, only: closure_t, state_t
   use psalm_kinds, only: wp, half_turn, right_angle, degrees_per_radian
   use psalm_sketch, only: frame_link, drive_slides, drive_turns
   use psalm_sketch_paths, only: path_step_t, tracing_t, nearest_point, way_from, shortest
   use psalm_traced_loops, only: loops_t, traced_t, traced_link, traced_slide, traced_crank, traced_actuator, traced_frame
   implicit none (type, external)
   private
   public :: traced_dyad_t, close_loop, append_step, frame_axis

   real(wp), parameter :: no_length = 1.0e-13_wp  !! of the drawing's size: a guide without length
   integer, parameter :: frame_axis = -1          !! reference that is not known before loop 1 is done

   !> A dyad in one sense of tracing: S side, inner pair, E side.
   type :: traced_dyad_t
      integer :: links(2) = 0               !! S side, E side
      integer :: joint(2) = 0, slide(2) = 0 !! outer pairs: a joint or a slide
      integer :: known(2) = 0               !! the known links there
      integer :: inner_joint = 0, inner_slide = 0
   end type traced_dyad_t

contains

   !> Trace the loop of a dyad, in the sense that takes fewer arcs.
   subroutine close_loop(closure, state, dyad, tracing, loops, valid)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(traced_dyad_t), intent(inout) :: dyad
      type(tracing_t), intent(inout) :: tracing
      type(loops_t), intent(inout) :: loops
      logical, intent(out) :: valid
      type(tracing_t), allocatable :: tracings(:)   ! large: they would fill a small stack
      type(loops_t), allocatable :: tried(:)
      logical :: found(2)
      integer :: way

      allocate (tracings(2), tried(2))
      do way = 1, 2
         tried(way) = loops
         tracings(way) = tracing
         call trace(closure, state, turned_round(dyad, way == 2), tracings(way), tried(way), found(way))
      end do
      valid = any(found)
      if (.not. valid) return
      way = merge(1, 2, found(1))
      if (all(found)) way = merge(1, 2, size(tried(1)%arcs) <= size(tried(2)%arcs))
      dyad = turned_round(dyad, way == 2)
      tracing = tracings(way)
      loops = tried(way)
   end subroutine close_loop

   pure type(traced_dyad_t) function turned_round(dyad, round) result(other)
      type(traced_dyad_t), intent(in) :: dyad
      logical, intent(in) :: round

      other = dyad
      if (.not. round) return
      other%links = dyad%links(2:1:-1)
      other%joint = dyad%joint(2:1:-1)
      other%slide = dyad%slide(2:1:-1)
      other%known = dyad%known(2:1:-1)
   end function turned_round

   subroutine trace(closure, state, dyad, tracing, loops, valid)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(traced_dyad_t), intent(in) :: dyad
      type(tracing_t), intent(inout) :: tracing
      type(loops_t), intent(inout) :: loops
      logical, intent(out) :: valid
      type(path_step_t), allocatable :: out(:), back(:)
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
         if (.not. tracing%on(dyad%joint(1), closure%sketch%drives(1)%link)) return
         call place_actuator()
      end if
      if (dyad%inner_slide > 0 .and. dyad%slide(1) > 0) return   ! PPR: the other sense is RPP
      ! feet of guides on the lines of outer slides
      if (dyad%slide(1) > 0) then
         call nearest_point(tracing, loops%start, dyad%known(1), .true., s, out, valid)
         if (.not. valid) return
         foot(1) = foot_of(slide_line(dyad%slide(1)), z(inner), s, dyad%known(1))
         out = [out, path_step_t(dyad%known(1), s, foot(1))]
      else
         s = dyad%joint(1)
         call shortest(tracing, loops%start, s, .true., out, valid)
         if (.not. valid) return
      end if
      if (dyad%slide(2) > 0) then
         call nearest_point(tracing, loops%start, dyad%known(2), .false., e, back, valid)
         if (.not. valid) return
         x = z(max(inner, 1))
         if (dyad%inner_slide > 0) x = crossing()
         if (dyad%inner_slide > 0) then
            foot(2) = e
            if (dyad%known(2) /= frame_link .or. .not. last_guides()) back = [path_step_t(dyad%known(2), e, e), back]
         else
            foot(2) = foot_of(slide_line(dyad%slide(2)), x, e, dyad%known(2))
            if (dyad%known(2) == frame_link .and. .not. last_guides()) then
               ! the last frame arc guides the actuator and has no length: this slide has a guide of its own
               back = [path_step_t(frame_link, foot(2), e), path_step_t(frame_link, e, e)]
            else if (dyad%known(2) == frame_link) then
               back(1)%from = foot(2)
            else
               back = [path_step_t(dyad%known(2), foot(2), e), back]
            end if
         end if
      else
         e = dyad%joint(2)
         call way_from(tracing, loops%start, e, back, valid)
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
         tracing%on(foot(2), dyad%known(2)) = .true.
         call add_back(q_direction + sense*right_angle)
      case (2)  ! PRR
         d = slide_line(dyad%slide(1))
         p_direction = toward(foot(1), inner, d)
         guide = size(loops%arcs) - first
         sense = guide_sense_before(p_direction, s, foot(1))
         call set_guide_direction(p_direction - sense*right_angle)
         call add_slide(dyad%links(1), foot(1), inner, p_direction, guide, sense, dyad%slide(1))
         call add_link(dyad%links(2), inner, e, ahead(inner, e, p_direction))
         tracing%on(foot(1), dyad%known(1)) = .true.
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
         tracing%on(foot(1), dyad%known(1)) = .true.
         tracing%on(foot(2), dyad%known(2)) = .true.
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
         tracing%on(foot(1), dyad%links(2)) = .true.
         p_direction = toward(s, foot(1), d)
         call add_step(path_step_t(dyad%known(2), s, s), p_direction - right_angle)
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

         tracing%points = tracing%points + 1
         new_point = tracing%points
         loops%point(new_point) = place
      end function new_point

      !> The foot, on the line through a place along d, of the perpendicular from a point; a point of the link `owner`.
      integer function foot_of(direction, through, from, owner) result(point)
         complex(wp), intent(in) :: direction, through
         integer, intent(in) :: from, owner

         point = new_point(through + direction*real(conjg(direction)*(z(from) - through), wp))
         tracing%on(point, owner) = .true.
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
         tracing%passes = tracing%passes + 1
         tracing%pass(:, tracing%passes) = [loops%start, dyad%joint(1), 1, 0]
      end subroutine place_actuator

      ! ---- arcs

      !> Append an arc of a link, or a slide passed again.
      subroutine add_step(step, direction)
         type(path_step_t), intent(in) :: step
         real(wp), intent(in), optional :: direction !! of an arc without length

         call append_step(closure, loop, first, step, loops, direction)
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
         tracing%on(from, link) = .true.
         tracing%on(to, link) = .true.
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
         if (tracing%passes < size(tracing%pass, 2)) then
            tracing%passes = tracing%passes + 1
            tracing%pass(:, tracing%passes) = [from, to, size(loops%arcs), 0]
         end if
      end subroutine add_slide
   end subroutine trace

   !> Append an arc of a link to a loop, or a slide passed again: along it, or against it where the arc of the step is negative.
   subroutine append_step(closure, loop, first, step, loops, direction)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: loop, first           !! the loop, and how many arcs come before it
      type(path_step_t), intent(in) :: step
      type(loops_t), intent(inout) :: loops
      real(wp), intent(in), optional :: direction  !! of an arc without length
      type(traced_t) :: arc
      complex(wp) :: h
      integer :: k, passed

      arc%loop = loop
      arc%place = size(loops%arcs) - first + 1
      arc%link = step%link
      arc%ends = [step%from, step%to]
      if (step%arc > 0 .and. size(loops%arcs) == 0 .and. .not. loops%floating) then
         arc%kind = traced_actuator
         arc%link = closure%sketch%drives(1)%link
         arc%slide = closure%sketch%drives(1)%slide
         loops%arcs = [loops%arcs, arc]
         return
      end if
      passed = step%arc
      if (step%drive /= 0) then
         passed = loops%seconds(abs(step%drive) - 1)%arc
         if (passed == 0) then
            ! a link that a drive after the first moves along the frame
            arc%kind = traced_actuator
            arc%drive = abs(step%drive)
            arc%link = closure%sketch%drives(arc%drive)%link
            arc%slide = closure%sketch%drives(arc%drive)%slide
            arc%guide_link = frame_link
            arc%foot_last = step%drive < 0
            arc%reference = loops%axis(frame_link)
            arc%direction = closure%sketch%slides(arc%slide)%angle
            if (arc%foot_last) arc%direction = arc%direction + half_turn
            loops%arcs = [loops%arcs, arc]
            loops%axis(arc%link) = size(loops%arcs)
            loops%seconds(arc%drive - 1)%arc = size(loops%arcs)
            return
         end if
         if (loops%arcs(passed)%ends(1) /= step%from) passed = -passed
      end if
      if (passed /= 0) then
         arc%reference = abs(passed)
         arc%same = passed > 0
         arc%against = passed < 0
         arc%link = loops%arcs(abs(passed))%link
         arc%direction = loops%arcs(abs(passed))%direction
         if (arc%against) arc%direction = arc%direction + half_turn
         loops%arcs = [loops%arcs, arc]
         return
      end if
      h = loops%point(step%to) - loops%point(step%from)
      arc%length = abs(h)
      if (arc%length <= no_length*closure%size) arc%length = 0.0_wp
      if (present(direction)) then
         arc%direction = direction
      else if (arc%length > 0.0_wp) then
         arc%direction = degrees_of(h%re, h%im)
      end if
      if (loops%axis(step%link) == 0 .and. loops%drive_of(step%link) > 1) then
         ! the first arc of a link that a drive after the first turns is its crank
         arc%kind = traced_crank
         arc%drive = loops%drive_of(step%link)
         loops%arcs = [loops%arcs, arc]
         loops%axis(step%link) = size(loops%arcs)
         loops%seconds(arc%drive - 1)%arc = size(loops%arcs)
         return
      end if
      arc%reference = loops%axis(step%link)
      do k = 1, size(loops%arcs)
         associate (old => loops%arcs(k))
            if (old%link /= step%link .or. old%same .or. old%kind == traced_slide) cycle
            if (old%kind == traced_actuator .and. .not. old%cylinder) cycle
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
   end subroutine append_step
end module psalm_loop_trace
