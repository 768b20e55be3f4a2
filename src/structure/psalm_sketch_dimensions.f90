!> Dimensions of a sketch as those of its loops: lengths and angles of the arcs, what varies with its bounds, tolerances by name.
module psalm_sketch_dimensions
   use psalm_angles, only: degrees_of, within_turn
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, full_turn, half_turn
   use psalm_output_kind, only: motion_point, motion_distance, motion_pose
   use psalm_sketch, only: sketch_t, variation_t, frame_link, vary_length, vary_angle, vary_place, vary_input, vary_all
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   use psalm_traced_loops, only: loops_t, traced_gear_t, arc_with, traced_determined, traced_link, traced_slide, traced_crank, &
                                 traced_actuator, traced_frame
   implicit none (type, external)
   private
   public :: take_dimensions, fill_variables, fill_tolerances, quadrant_angle, dimension_words, none_such

   integer, parameter :: dimension_none = 0, dimension_length = 1, dimension_angle = 2, dimension_outlk = 3, dimension_outang = 4
   integer, parameter :: most_named = 12 !! lengths named in a message

contains

   !> Lengths and angles of the arcs, and where the input pivot is.
   subroutine take_dimensions(loops)
      type(loops_t), intent(inout) :: loops
      complex(wp) :: pivot
      integer :: k

      do k = 1, size(loops%arcs)
         associate (arc => loops%arcs(k))
            arc%arcl = arc%length
            select case (arc%kind)
            case (traced_crank)
               if (arc%drive > 1) arc%gama = arc%direction
            case (traced_frame)
               arc%gama = quadrant_angle(arc%direction)
            case (traced_link)
               if (.not. loops%is_dyad(arc%loop)) arc%gama = arc%direction
            case (traced_slide, traced_actuator)
               if (.not. arc%cylinder) arc%arcl = 0.0_wp
               if (arc%cylinder) arc%gama = arc%direction
               if (arc%guide_link > 0) arc%gama = quadrant_angle(arc%direction - loops%arcs(arc%reference)%direction)
            case default
               if (.not. arc%same) arc%gama = quadrant_angle(arc%direction - loops%arcs(arc%reference)%direction)
               if (arc%same) arc%arcl = loops%arcs(arc%reference)%arcl
            end select
         end associate
      end do
      loops%anchor = loops%input
      pivot = loops%point(loops%start)
      loops%origlk = abs(pivot)
      if (loops%origlk > 0.0_wp) loops%origng = degrees_of(pivot%re, pivot%im)
   end subroutine take_dimensions

   !> What varies, from the names, and the bounds in the order of the listing.
   subroutine fill_variables(loops, sketch, set, findings)
      type(loops_t), intent(inout) :: loops
      type(sketch_t), intent(in) :: sketch
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      integer, parameter :: of_outlk = 1, of_origlk = 2, of_outang = 3, of_origng = 4, of_input = 5
      real(wp), allocatable :: low_length(:), high_length(:), low_angle(:), high_angle(:) !! by arc
      real(wp), allocatable :: low_aside(:, :), high_aside(:, :) !! by joint: distance and angle of those off the arcs
      real(wp) :: low(of_input), high(of_input)
      integer :: k, n

      if (size(sketch%variations) == 0) return
      allocate (loops%aside_varies(2, size(sketch%joint_name)), source=.false.)
      allocate (low_aside(2, size(sketch%joint_name)), high_aside(2, size(sketch%joint_name)), source=0.0_wp)
      allocate (low_length(size(loops%arcs)), high_length(size(loops%arcs)), low_angle(size(loops%arcs)), &
                high_angle(size(loops%arcs)), source=0.0_wp)
      low = 0.0_wp
      high = 0.0_wp
      do k = 1, size(sketch%variations)
         call place_variation(sketch%variations(k), k)
      end do
      if (.not. any(sketch%variations%bounded)) return
      set%limits%limval = 1
      if (allocated(set%limits%oplow)) deallocate (set%limits%oplow, set%limits%ophigh)
      allocate (set%limits%oplow(0), set%limits%ophigh(0))
      do n = 1, size(loops%arcs)
         if (loops%arcs(n)%length_varies) call bound(low_length(n), high_length(n))
      end do
      do n = 1, size(low_aside, 2)
         if (loops%aside_varies(1, n)) call bound(low_aside(1, n), high_aside(1, n))
      end do
      if (loops%outlk_varies) call bound(low(of_outlk), high(of_outlk))
      if (loops%pivot_varies) call bound(low(of_origlk), high(of_origlk))
      do n = 1, size(loops%arcs)
         if (loops%arcs(n)%angle_varies) call bound(low_angle(n), high_angle(n))
      end do
      do n = 1, size(low_aside, 2)
         if (loops%aside_varies(2, n)) call bound(low_aside(2, n), high_aside(2, n))
      end do
      if (loops%outang_varies) call bound(low(of_outang), high(of_outang))
      if (loops%pivot_varies) call bound(low(of_origng), high(of_origng))
      if (loops%input_varies) call bound(low(of_input), high(of_input))
      set%limits%low_given = size(set%limits%oplow)
      set%limits%high_given = size(set%limits%ophigh)

   contains

      subroutine bound(lowest, highest)
         real(wp), intent(in) :: lowest, highest

         set%limits%oplow = [set%limits%oplow, lowest]
         set%limits%ophigh = [set%limits%ophigh, highest]
      end subroutine bound

      subroutine place_variation(one, which)
         type(variation_t), intent(in) :: one
         integer, intent(in) :: which
         integer :: arc, what
         real(wp) :: sense, zero, bounds(2)
         logical :: forward

         select case (one%kind)
         case (vary_all)
            call vary_every(one)
         case (vary_input)
            loops%input_varies = .true.
            low(of_input) = loops%input + one%low(1)
            high(of_input) = loops%input + one%high(1)
         case (vary_place)
            if (one%joints(1) == loops%start) then
               loops%pivot_varies = .true.
               low([of_origlk, of_origng]) = one%low
               high([of_origlk, of_origng]) = one%high
               return
            end if
            call find_arc(loops, one%joints(1), loops%start, arc, forward)
            if (arc == 0) then
               call missing(which, 'the place of joint '//trim(sketch%joint_name(one%joints(1))))
               return
            end if
            loops%arcs(arc)%length_varies = .true.
            loops%arcs(arc)%angle_varies = .true.
            low_length(arc) = one%low(1)
            high_length(arc) = one%high(1)
            call angle_bounds(arc, one%low(2), one%high(2), merge(0.0_wp, 180.0_wp, .not. forward))
         case (vary_length, vary_angle)
            call locate_dimension(loops, one, what, arc, sense, zero)
            bounds = sense*[one%low(1), one%high(1)] + zero
            bounds = [minval(bounds), maxval(bounds)]
            select case (what)
            case (dimension_none)
               call place_aside(one, which)
            case (dimension_outlk)
               loops%outlk_varies = .true.
               low(of_outlk) = bounds(1)
               high(of_outlk) = bounds(2)
            case (dimension_outang)
               loops%outang_varies = .true.
               low(of_outang) = bounds(1)
               high(of_outang) = bounds(2)
            case (dimension_length)
               loops%arcs(arc)%length_varies = .true.
               low_length(arc) = bounds(1)
               high_length(arc) = bounds(2)
            case default
               loops%arcs(arc)%angle_varies = .true.
               low_angle(arc) = bounds(1)
               high_angle(arc) = bounds(2)
            end select
         end select
      end subroutine place_variation

      !> A joint off the arcs: its distance from the end of an arc of its link, or the angle of that line from the arc.
      subroutine place_aside(one, which)
         type(variation_t), intent(in) :: one
         integer, intent(in) :: which
         integer :: joint, base, arc, part
         logical :: from_start, found
         real(wp) :: zero, bounds(2)

         part = merge(1, 2, one%kind == vary_length)
         call find_aside(loops, sketch, one, joint, base, arc, found)
         if (found) call rebase(loops, joint, base, arc, from_start, found)
         if (.not. found) then
            call missing(which, dimension_words(sketch, one))
            return
         end if
         loops%aside_varies(part, joint) = .true.
         zero = 0.0_wp
         if (one%kind == vary_angle) then
            ! given from the first line to the second, counted from the direction of the arc to the line from its end
            if (loops%arcs(arc)%ends(1) /= one%joints(1)) zero = half_turn
            if (one%joints(3) == joint) zero = zero + half_turn
         end if
         bounds = [one%low(1), one%high(1)] + zero
         associate (angle => loops%joint_places(joint)%angle)
            if (one%bounded .and. part == 2) angle = angle + full_turn*anint((0.5_wp*sum(bounds) - angle)/full_turn)
         end associate
         low_aside(part, joint) = bounds(1)
         high_aside(part, joint) = bounds(2)
      end subroutine place_aside

      !> All lengths and angles of arcs that are not zero, or another's, or the input; the output point on its link; the place
      !> of the whole; how wheels in gear stand to each other; the reference input, unless timing is free.
      subroutine vary_every(one)
         type(variation_t), intent(in) :: one
         real(wp), parameter :: far = 100.0_wp  ! times the longest length: bound of the distance of the input pivot
         real(wp), parameter :: angles = 720.0_wp
         integer :: i

         do i = 1, size(loops%arcs)
            associate (arc => loops%arcs(i))
               if (arc%same .or. arc%against .or. any(arc%kind == [traced_slide, traced_actuator])) cycle
               arc%length_varies = arc%length > 0.0_wp
               arc%angle_varies = arc%kind == traced_determined .or. arc%kind == traced_frame
            end associate
         end do
         do i = 1, size(loops%gears)
            call vary_phase(loops%gears(i))
         end do
         loops%outlk_varies = loops%outlk > 0.0_wp
         loops%outang_varies = loops%outlk_varies
         loops%pivot_varies = any(loops%motion == [motion_point, motion_distance, motion_pose])
         loops%input_varies = set%method%ifree == 0
         low_length = one%low(1)
         high_length = one%high(1)
         low_angle = -angles
         high_angle = angles
         low = [one%low(1), 0.0_wp, -angles, -angles, -angles]
         high = [one%high(1), far*one%high(1), angles, angles, angles]
         if (loops%sliding) then
            low(of_input) = -far*one%high(1)
            high(of_input) = far*one%high(1)
         end if
      end subroutine vary_every

      !> How the wheels of a gear pair stand to each other: the direction, in the drawing, of one that its group finds.
      subroutine vary_phase(gear)
         type(traced_gear_t), intent(in) :: gear
         integer :: side, arc

         if (gear%drive > 0 .or. gear%of_slides) return
         do side = size(gear%wheels), 1, -1
            arc = loops%axis(gear%wheels(side))
            if (arc <= 0) cycle
            if (loops%arcs(arc)%kind /= traced_link .or. loops%arcs(arc)%loop /= gear%loop) cycle
            loops%arcs(arc)%angle_varies = .true.
            return
         end do
      end subroutine vary_phase

      !> Bounds of a direction from the pivot, for a frame arc that is traced against it when `turn` is 180.
      subroutine angle_bounds(arc, lowest, highest, turn)
         integer, intent(in) :: arc
         real(wp), intent(in) :: lowest, highest, turn
         real(wp) :: zero

         zero = turn
         if (loops%arcs(arc)%kind /= traced_frame) zero = turn - loops%arcs(loops%arcs(arc)%reference)%direction
         low_angle(arc) = lowest + zero
         high_angle(arc) = highest + zero
      end subroutine angle_bounds

      subroutine missing(which, what)
         integer, intent(in) :: which
         character(*), intent(in) :: what

         call set%origins%error(findings, 'CHAIN', 'VARY', what//none_such(loops, sketch), which)
      end subroutine missing
   end subroutine fill_variables

   !> The joint off the arcs that a length or an angle is of, what it is counted from, and the arc of an angle (0: any). Not
   !> found: the output of the loops, whose own dimensions these are; joints whose line leads to no arc.
   pure subroutine find_aside(loops, sketch, one, joint, base, arc, found)
      type(loops_t), intent(in) :: loops
      type(sketch_t), intent(in) :: sketch
      type(variation_t), intent(in) :: one  !! `vary_length` or `vary_angle`
      integer, intent(out) :: joint, base, arc
      logical, intent(out) :: found
      integer :: line(2)
      logical :: forward

      arc = 0
      line = one%joints(1:2)
      found = .true.
      if (one%kind == vary_angle) then
         line = one%joints(3:4)
         call find_arc(loops, one%joints(1), one%joints(2), arc, forward)
         found = arc > 0
      end if
      joint = line(2)
      base = line(1)
      if (.not. is_aside(joint)) then
         joint = line(1)
         base = line(2)
      end if
      found = found .and. is_aside(joint)
      if (found .and. arc > 0) found = any(loops%arcs(arc)%ends == base) .and. loops%on(joint, loops%arcs(arc)%link)

   contains

      pure logical function is_aside(joint)
         integer, intent(in) :: joint

         associate (place => loops%joint_places(joint))
            is_aside = place%arc > 0 .and. place%distance > 0.0_wp .and. joint /= loops%output_joint .and. &
                       size(sketch%links_of(joint)) == 1 .and. .not. sketch%has_joint(frame_link, joint)
         end associate
      end function is_aside
   end subroutine find_aside

   !> Let a joint off the arcs be counted from an end of an arc of its link, and from the direction of that arc, unless one of its
   !> dimensions varies already that is counted otherwise.
   pure subroutine rebase(loops, joint, base, arc, from_start, found)
      type(loops_t), intent(inout) :: loops
      integer, intent(in) :: joint, base
      integer, intent(inout) :: arc         !! 0: any that ends there
      logical, intent(out) :: from_start
      logical, intent(out) :: found
      integer :: now, link
      logical :: counted
      complex(wp) :: z

      associate (place => loops%joint_places(joint))
         now = loops%number_of(place%loop, place%arc)
         counted = any(loops%aside_varies(:, joint))
         if (counted) then
            from_start = place%from_start
            found = loops%arcs(now)%ends(merge(1, 2, from_start)) == base .and. (arc == 0 .or. arc == now .or. &
                                                                                   .not. loops%aside_varies(2, joint))
            if (.not. found) return
            if (arc == 0) arc = now
         else
            found = .true.
         end if
         link = place%link
         if (arc == 0) then
            call arc_with(loops, link, base, arc, from_start)
            found = arc > 0
            if (.not. found) return
         else
            from_start = loops%arcs(arc)%ends(1) == base
         end if
         z = loops%point(joint) - loops%point(base)
         place%loop = loops%arcs(arc)%loop
         place%arc = loops%arcs(arc)%place
         place%from_start = from_start
         place%distance = abs(z)
         place%turn = 0.0_wp
         place%angle = quadrant_angle(degrees_of(z%re, z%im) - loops%arcs(arc)%direction)
      end associate
   end subroutine rebase

   !> Tolerances that single dimensions have by their names, for the arcs of the loops; those of arcs that repeat them, too.
   subroutine fill_tolerances(loops, sketch, set, findings)
      type(loops_t), intent(inout) :: loops
      type(sketch_t), intent(in) :: sketch
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: sense, zero
      integer :: i, k, what, arc

      do i = 1, size(set%toler%named)
         associate (one => set%toler%named(i), tolerance => set%toler%of_named(i))
            call locate_dimension(loops, one, what, arc, sense, zero)
            select case (what)
            case (dimension_none)
               call set%origins%error(findings, 'TOLER', 'TOLNAM', dimension_words(sketch, one)//none_such(loops, sketch), i)
            case (dimension_outlk)
               loops%of_output(1) = tolerance
            case (dimension_outang)
               loops%of_output(2) = tolerance
            case default
               k = merge(1, 2, what == dimension_length)
               where (repeats(loops, arc)) loops%arcs%tolerances(k) = tolerance
               if (k == 1 .and. tolerance >= loops%arcs(arc)%length) call set%origins%error(findings, 'TOLER', 'TOLVAL', &
                  'the tolerance of a length is not smaller than the length', i)
            end select
         end associate
      end do
   end subroutine fill_tolerances

   !> By arc: it is the given one, or repeats it.
   pure function repeats(loops, arc)
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: arc
      logical :: repeats(size(loops%arcs))
      integer :: n, k

      do n = 1, size(repeats)
         k = n
         do while (k > 0)
            if (.not. (loops%arcs(k)%same .or. loops%arcs(k)%against)) exit
            k = loops%arcs(k)%reference
         end do
         repeats(n) = k == arc
      end do
   end function repeats

   !> Where the loops have a length or an angle: as given times `sense`, plus `zero` degrees.
   pure subroutine locate_dimension(loops, one, what, arc, sense, zero)
      type(loops_t), intent(in) :: loops
      type(variation_t), intent(in) :: one  !! `vary_length` or `vary_angle`
      integer, intent(out) :: what          !! one of `dimension_...`
      integer, intent(out) :: arc
      real(wp), intent(out) :: sense, zero
      integer :: other
      logical :: forward, other_forward

      what = dimension_none
      sense = 1.0_wp
      zero = 0.0_wp
      call find_arc(loops, one%joints(1), one%joints(2), arc, forward)
      if (one%kind == vary_length) then
         if (is_output(one%joints(1:2)) .or. is_output(one%joints(2:1:-1))) then
            what = dimension_outlk
         else if (arc > 0) then
            what = dimension_length
         end if
         return
      end if
      if (arc > 0 .and. is_output(one%joints(3:4))) then
         if (arc == loops%output_arc) then
            what = dimension_outang
            zero = merge(0.0_wp, half_turn, forward)
            return
         end if
      end if
      call find_arc(loops, one%joints(3), one%joints(4), other, other_forward)
      if (arc == 0 .or. other == 0) return
      zero = merge(0.0_wp, half_turn, forward .eqv. other_forward)
      if (counts_from(arc, other)) then
         what = dimension_angle
         sense = -1.0_wp
      else if (counts_from(other, arc)) then
         what = dimension_angle
         arc = other
      end if

   contains

      pure logical function is_output(joints)
         integer, intent(in) :: joints(2)

         is_output = all(joints == loops%output_line())
      end function is_output

      !> True if the angle of an arc is that from another.
      pure logical function counts_from(arc, other)
         integer, intent(in) :: arc, other

         counts_from = loops%arcs(arc)%kind == traced_determined .and. loops%arcs(arc)%reference == other
      end function counts_from
   end subroutine locate_dimension

   !> The arc between two joints of a link as it was first traced, and whether it leads from the first to the second.
   pure subroutine find_arc(loops, a, b, arc, forward)
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: a, b
      integer, intent(out) :: arc
      logical, intent(out) :: forward
      integer :: i

      arc = 0
      forward = .true.
      do i = 1, size(loops%arcs)
         if (loops%arcs(i)%same .or. loops%arcs(i)%against) cycle
         if (any(loops%arcs(i)%kind == [traced_slide, traced_actuator])) cycle
         if (all(loops%arcs(i)%ends == [a, b])) then
            arc = i
            return
         else if (all(loops%arcs(i)%ends == [b, a])) then
            arc = i
            forward = .false.
            return
         end if
      end do
   end subroutine find_arc

   !> A length or an angle in words.
   pure function dimension_words(sketch, one) result(words)
      type(sketch_t), intent(in) :: sketch
      type(variation_t), intent(in) :: one
      character(:), allocatable :: words

      words = 'the length '//line_words(sketch, one%joints(1:2))
      if (one%kind == vary_angle) words = 'the angle from '//line_words(sketch, one%joints(1:2))//' to '// &
                                          line_words(sketch, one%joints(3:4))
   end function dimension_words

   pure function line_words(sketch, joints) result(words)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: joints(2)
      character(:), allocatable :: words

      words = trim(sketch%joint_name(joints(1)))//' '//trim(sketch%joint_name(joints(2)))
   end function line_words

   !> What is wrong with a dimension that the loops do not have, and those that they have.
   function none_such(loops, sketch) result(words)
      type(loops_t), intent(in) :: loops
      type(sketch_t), intent(in) :: sketch
      character(:), allocatable :: words
      character(:), allocatable :: have
      integer :: i, reported

      have = ''
      reported = 0
      do i = 1, size(loops%arcs)
         associate (arc => loops%arcs(i))
            if (arc%same .or. arc%against .or. any(arc%ends > size(sketch%joint_name)) .or. arc%length == 0.0_wp) cycle
            if (any(arc%kind == [traced_slide, traced_actuator])) cycle
            reported = reported + 1
            if (reported > most_named) cycle
            have = have//', '//line_words(sketch, arc%ends)
         end associate
      end do
      if (reported > most_named) have = have//' and '//to_text(reported - most_named)//' more,'
      if (len(have) > 0) have = '; there are the lengths '//have(3:)//' and the angles between them'
      words = ' is no dimension of the loops'//have
   end function none_such

   !> The angle in 0 to 360 degrees; what differs from a multiple of 90 by a rounding is that.
   pure real(wp) function quadrant_angle(angle) result(rounded)
      real(wp), intent(in) :: angle
      real(wp), parameter :: quarter = 90.0_wp, rounding = 64.0_wp*epsilon(1.0_wp)

      rounded = within_turn(angle)
      if (abs(rounded - quarter*anint(rounded/quarter)) < rounding*full_turn) rounded = quarter*anint(rounded/quarter)
      if (rounded >= full_turn) rounded = 0.0_wp
   end function quadrant_angle
end module psalm_sketch_dimensions
