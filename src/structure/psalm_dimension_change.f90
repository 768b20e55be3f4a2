!> A length or an angle of a link of a sketch, set in the dimensions of its loops: one joint moves on its link, nothing else does.
!>
!> The arcs of a link are vectors in its axes. One that ends at the joint grows by the way that the joint has gone, one that begins
!> there loses it; the angles that are counted from an arc follow its turn.
module psalm_dimension_change
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_sketch, only: frame_link, sketch_t, variation_t, vary_angle, vary_length
   use psalm_sketch_dimensions, only: dimension_words, none_such, quadrant_angle
   use psalm_sketch_mechanism, only: traced_dimensions
   use psalm_status, only: diagnostics_t
   use psalm_sweep_group, only: sweep_group_t, sweep_of
   use psalm_traced_loops, only: loops_t, traced_t, traced_actuator, traced_crank, traced_determined, traced_frame, traced_link, &
                                 traced_slide
   implicit none (type, external)
   private
   public :: set_dimension, check_sweep

contains

   !> Error: the dimension that SWEEP sets cannot be set by itself.
   subroutine check_sweep(loops, sketch, set, findings)
      type(loops_t), intent(in) :: loops
      type(sketch_t), intent(in) :: sketch
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(sweep_group_t) :: sweep
      type(dimensions_t) :: dimensions
      character(:), allocatable :: why

      if (.not. set%gives('SWEEP')) return
      sweep = sweep_of(set)
      if (all(sweep%dimension%kind /= [vary_length, vary_angle])) return
      dimensions = traced_dimensions(loops)
      call set_dimension(loops, sketch, sweep%dimension, sweep%low, dimensions, why)
      if (allocated(why)) call set%origins%error(findings, 'SWEEP', 'SWJNT', dimension_words(sketch, sweep%dimension)//why)
   end subroutine check_sweep

   !> Set a length or an angle: its last joint moves, along the line from the one before it or round that.
   subroutine set_dimension(loops, sketch, one, value, dimensions, why)
      type(loops_t), intent(in) :: loops
      type(sketch_t), intent(in) :: sketch
      type(variation_t), intent(in) :: one                !! `vary_length` or `vary_angle`
      real(wp), intent(in) :: value                       !! user's length, or degrees
      type(dimensions_t), intent(inout) :: dimensions     !! of the loops
      character(:), allocatable, intent(out) :: why       !! it cannot be set: the end of a sentence that begins with its name
      complex(wp) :: at(size(loops%point))                !! from `base`, in the drawn axes of the link
      logical :: known(size(loops%point)), depends
      real(wp) :: direction(size(loops%arcs)), turn(size(loops%arcs)), c, s
      complex(wp) :: line, way, rest, lengthened
      integer :: link, base, moved, last, n, k, guide
      logical :: leads(size(loops%arcs))                  !! a slide of the link is counted from an end of the arc

      last = merge(2, 4, one%kind == vary_length)
      base = one%joints(last - 1)
      moved = one%joints(last)
      do link = 1, size(sketch%links)
         if (all([(sketch%has_joint(link, one%joints(k)), k=1, last)])) exit
      end do
      if (link > size(sketch%links)) then
         why = none_such(loops, sketch)
         return
      end if
      if (one%kind == vary_angle .and. any(one%joints(:2) == moved)) then
         why = ' is between two lines that both move with joint '//trim(sketch%joint_name(moved))
         return
      end if
      direction = [(direction_of(n), n=1, size(direction))]
      call find_places()
      line = at(moved)
      if (.not. abs(line) > 0.0_wp) then
         why = ' is between joints at one place'
         return
      end if
      if (one%kind == vary_length) then
         way = line*((value - abs(line))/abs(line))
      else
         rest = at(one%joints(2)) - at(one%joints(1))
         call unit_vector(degrees_of(rest%re, rest%im) + value, c, s)
         way = abs(line)*cmplx(c, s, wp) - line
      end if

      leads = [(leads_to_slide(loops%arcs(n)), n=1, size(leads))]
      if (any(leads .and. ends_at(moved))) then
         why = ' would move joint '//trim(sketch%joint_name(moved))//', from which the line of a slide is counted'
         if (one%kind == vary_length .and. .not. any(leads .and. ends_at(base))) why = why//': name that joint first'
         return
      end if
      turn = 0.0_wp
      depends = .false.
      do n = 1, size(loops%arcs)
         associate (arc => loops%arcs(n))
            if (.not. is_fixed(arc) .or. all(arc%ends /= moved) .or. arc%ends(1) == arc%ends(2)) cycle
            depends = .true.
            rest = vector(dimensions%arcl(n), direction(n))
            lengthened = rest + merge(way, -way, arc%ends(2) == moved)
            dimensions%arcl(n) = abs(lengthened)
            if (any(arc%ends == base) .and. one%kind == vary_length) then
               dimensions%arcl(n) = value
            else if (abs(rest) > 0.0_wp) then
               rest = lengthened*conjg(rest)
               turn(n) = degrees_of(rest%re, rest%im)
            else
               turn(n) = degrees_of(lengthened%re, lengthened%im) - direction(n)
            end if
         end associate
      end do
      do n = 1, size(loops%arcs)
         if (loops%arcs(n)%kind /= traced_slide .or. loops%arcs(n)%guide_link > 0) cycle
         guide = findloc(loops%arcs%loop, loops%arcs(n)%loop, dim=1) + loops%arcs(n)%guide - 1
         if (.not. abs(turn(guide)) > 0.0_wp) cycle
         why = ' would turn an arc from which the line of a slide is counted'
         return
      end do
      call turn_arcs()
      do k = 1, size(loops%joint_places)
         associate (place => loops%joint_places(k))
            if (place%arc == 0) cycle
            call move_beside(loops%number_of(place%loop, place%arc), place%from_start, k, dimensions%aside_length(k), &
                             dimensions%aside_angle(k))
         end associate
      end do
      if (dimensions%outlk > 0.0_wp) call move_beside(loops%output_arc, loops%from_start, loops%output_joint, dimensions%outlk, &
                                                      dimensions%outang)
      if (link == frame_link .and. moved == loops%start) then
         depends = .true.
         rest = vector(dimensions%origlk, dimensions%origng) + way
         dimensions%origlk = abs(rest)
         dimensions%origng = degrees_of(rest%re, rest%im)
      end if
      if (.not. depends) why = none_such(loops, sketch)

   contains

      !> True of what keeps its length while the link moves.
      pure logical function is_fixed(arc)
         type(traced_t), intent(in) :: arc

         is_fixed = arc%link == link .and. all(arc%kind /= [traced_slide, traced_actuator])
      end function is_fixed

      pure function ends_at(joint)
         integer, intent(in) :: joint
         logical :: ends_at(size(loops%arcs))

         ends_at = loops%arcs%ends(1) == joint .or. loops%arcs%ends(2) == joint
      end function ends_at

      !> True if a slide of the link is counted from an end of an arc: the arc leads to its foot, or runs along it.
      pure logical function leads_to_slide(arc)
         type(traced_t), intent(in) :: arc

         leads_to_slide = is_fixed(arc) .and. any(arc%ends > size(loops%joint_loop))
         if (arc%slide > 0) leads_to_slide = any(sketch%slides(arc%slide)%links == link)
      end function leads_to_slide

      !> As drawn, but with the angles of the dimensions between arcs.
      pure recursive real(wp) function direction_of(n) result(angle)
         integer, intent(in) :: n

         associate (arc => loops%arcs(n))
            select case (arc%kind)
            case (traced_determined)
               angle = direction_of(arc%reference) + dimensions%gama(n)
            case (traced_frame)
               angle = dimensions%gama(n)
            case default
               angle = arc%direction
            end select
         end associate
      end function direction_of

      pure complex(wp) function vector(length, angle)
         real(wp), intent(in) :: length, angle   !! degrees
         real(wp) :: cosine, sine

         call unit_vector(angle, cosine, sine)
         vector = length*cmplx(cosine, sine, wp)
      end function vector

      !> Points of the link by the arcs that lead to them; those to which none leads as drawn.
      subroutine find_places()
         integer :: met, arc, joint

         at = loops%point - loops%point(base)
         known = .false.
         known(base) = .true.
         do
            met = count(known)
            do arc = 1, size(loops%arcs)
               if (.not. is_fixed(loops%arcs(arc))) cycle
               associate (ends => loops%arcs(arc)%ends)
                  call join(ends(1), ends(2), vector(dimensions%arcl(arc), direction(arc)))
               end associate
            end do
            do joint = 1, size(loops%joint_places)
               associate (place => loops%joint_places(joint))
                  if (place%arc == 0) cycle
                  call join_beside(loops%number_of(place%loop, place%arc), place%from_start, joint, &
                                   dimensions%aside_length(joint), dimensions%aside_angle(joint))
               end associate
            end do
            if (loops%output_joint > 0) call join_beside(loops%output_arc, loops%from_start, loops%output_joint, &
                                                         dimensions%outlk, dimensions%outang)
            if (count(known) == met) exit
         end do
      end subroutine find_places

      subroutine join_beside(arc, from_start, joint, length, angle)
         integer, intent(in) :: arc, joint
         logical, intent(in) :: from_start
         real(wp), intent(in) :: length, angle

         if (.not. is_fixed(loops%arcs(arc)) .or. .not. sketch%has_joint(link, joint)) return
         call join(loops%arcs(arc)%ends(merge(1, 2, from_start)), joint, vector(length, direction(arc) + angle))
      end subroutine join_beside

      subroutine join(first, second, between)
         integer, intent(in) :: first, second
         complex(wp), intent(in) :: between

         if (known(first) .and. .not. known(second)) then
            at(second) = at(first) + between
            known(second) = .true.
         else if (known(second) .and. .not. known(first)) then
            at(first) = at(second) - between
            known(first) = .true.
         end if
      end subroutine join

      !> Angles of arcs, and inputs that are directions of arcs.
      subroutine turn_arcs()
         real(wp) :: change
         integer :: arc

         do arc = 1, size(loops%arcs)
            associate (of => loops%arcs(arc))
               change = turn(arc)
               if (of%reference > 0 .and. (of%kind == traced_determined .or. of%guide_link > 0)) &
                  change = change - turn(of%reference)
               if (.not. abs(change) > 0.0_wp) cycle
               select case (of%kind)
               case (traced_crank)
                  if (of%drive > 1) dimensions%gama(arc) = dimensions%gama(arc) + change
                  if (of%drive > 1) cycle
                  dimensions%crnki = dimensions%crnki + change
                  dimensions%drawn = dimensions%drawn + change
                  dimensions%anchor = dimensions%anchor + change
               case (traced_link)
                  if (.not. loops%is_dyad(of%loop)) dimensions%gama(arc) = dimensions%gama(arc) + change
               case default
                  if (.not. of%same) dimensions%gama(arc) = quadrant_angle(dimensions%gama(arc) + change)
               end select
            end associate
         end do
      end subroutine turn_arcs

      !> A line from an end of an arc to a joint that may be none of its ends.
      subroutine move_beside(arc, from_start, joint, length, angle)
         integer, intent(in) :: arc, joint
         logical, intent(in) :: from_start
         real(wp), intent(inout) :: length, angle
         complex(wp) :: beside
         integer :: end

         if (.not. is_fixed(loops%arcs(arc)) .or. .not. length > 0.0_wp) return
         end = loops%arcs(arc)%ends(merge(1, 2, from_start))
         beside = vector(length, direction(arc) + angle)
         if (joint == moved) then
            depends = .true.
            beside = beside + way
            length = abs(beside)
            if (end == base .and. one%kind == vary_length) length = value
         end if
         if (end == moved) then
            depends = .true.
            beside = beside - way
            length = abs(beside)
            if (joint == base .and. one%kind == vary_length) length = value
         end if
         if (any([end, joint] == moved) .and. .not. (any([end, joint] == base) .and. one%kind == vary_length)) then
            angle = degrees_of(beside%re, beside%im) - (direction(arc) + turn(arc))
         else
            angle = angle - turn(arc)
         end if
      end subroutine move_beside
   end subroutine set_dimension
end module psalm_dimension_change
