!> From a sketch to the arrays of &LINKS, where they exist: what every program then works on.
!>
!> The drawing is assembled first (exact lengths may have moved it), then `psalm_sketch_loops` chooses loops and signs, and
!> outputs, variables, bounds and tolerances by name become those of arcs.
module psalm_sketch_case
   use psalm_angles, only: degrees_of, unit_vector, within_turn
   use psalm_assur_order, only: assur_order_t
   use psalm_case_group, only: place_visitor_t
   use psalm_closure, only: closure_t, state_t, make_closure, start_state, solve_group, place_points, rank_lost
   use psalm_constraint_group, only: range_positions
   use psalm_data_set, only: data_set_t
   use psalm_dense, only: factors_t
   use psalm_frame_places, only: part_frame_arcs
   use psalm_kinds, only: wp, degrees_per_radian, full_turn, half_turn
   use psalm_mechanism, only: at_start, at_finish
   use psalm_output_kind, only: output_kind_t, kind_of_output, motion_point, motion_angle, motion_distance, motion_slide, &
                                motion_pose
   use psalm_place, only: place_t, travel_t
   use psalm_sketch, only: sketch_t, sketch_output_t, variation_t, drive_turns, frame_link, output_point, output_angle, &
                           output_distance, slide_t, output_slide, output_pose, most_wished, vary_length, vary_angle, vary_place, &
                           vary_input, vary_all
   use psalm_sketch_check, only: check_sketch
   use psalm_sketch_loops, only: make_loops
   use psalm_status, only: diagnostics_t
   use psalm_text, only: text_t, to_text
   use psalm_traced_loops, only: loops_t, arc_with, traced_determined, traced_link, traced_slide, traced_crank, &
                                 traced_actuator, traced_frame
   implicit none (type, external)
   private
   public :: resolve_sketch, refuse_in_poses, assemble_sketch

   integer, parameter :: dimension_none = 0, dimension_length = 1, dimension_angle = 2, dimension_outlk = 3, dimension_outang = 4
   integer, parameter :: most_named = 12 !! lengths named in a message
   character(*), parameter :: no_dimension = 'dimensions that its loops do not have'

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

   !> The case with its loops, made of one whose linkage is a sketch. Errors: a sketch that is none, that does not close, or is not
   !> to be traced; dimensions to be searched that the loops have not. The case is then as it was read.
   subroutine resolve_sketch(as_read, set, findings, as_groups, as_given, in_poses)
      class(data_set_t), intent(in) :: as_read       !! without loops
      type(data_set_t), intent(out) :: set
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in), optional :: as_groups     !! trace dyads as larger groups
      logical, intent(in), optional :: as_given      !! nothing is searched: what only a search could not do is no trouble
      character(:), allocatable, intent(out), optional :: in_poses !! what varies that loops cannot vary, so that the search is one
                                                                   !! in poses; empty: nothing. There are no loops then
      character(:), allocatable :: why
      type(closure_t) :: closure
      type(state_t) :: state
      type(loops_t) :: loops
      type(diagnostics_t) :: of_search
      logical :: closes, given

      if (present(in_poses)) in_poses = ''
      select type (as_read)
      type is (data_set_t)
         set = as_read
      end select
      given = .false.
      if (present(as_given)) given = as_given
      call assemble_sketch(set, closure, state, closes, findings)
      if (.not. closes) return
      call make_loops(closure, state, loops, as_groups)
      if (.not. loops%found) then
         call set%origins%error(findings, 'CHAIN', 'LNK', 'no loops lead to every link of this sketch, for it has '//loops%why)
         return
      end if
      if (set%sketch%has_wishes() .or. wants_poses(set) .or. wants_travel(loops, set)) &
         call take_wishes(loops, state, closure%sketch, set)
      if (.not. given) then
         call part_frame_arcs(closure%sketch, loops, why)
         if (present(in_poses)) in_poses = why
         if (len(why) > 0) return
      end if
      ! exact lengths may have moved the joints, and slides with their links
      call move_slides(closure, state, set%sketch%slides)
      set%sketch%x = state%joint(:, 0)%re
      set%sketch%y = state%joint(:, 0)%im
      loops%chosen = words_of(loops, closure%sketch)
      call warn_of_idle_angle(loops, set, findings)
      call take_dimensions(loops)
      call fill_places(closure, loops, state, set)
      if (given) then
         call fill_output(loops, state, closure%sketch, set, of_search)
         call fill_variables(loops, closure%sketch, set, of_search)
         if (of_search%failed()) call loops%hold_all()
      else
         call fill_output(loops, state, closure%sketch, set, findings)
         call fill_variables(loops, closure%sketch, set, of_search)
         if (of_search%failed() .and. present(in_poses) .and. (set%sketch%has_wishes() .or. loops%are_beyond_arrays())) then
            in_poses = no_dimension
            return
         end if
         call findings%append(of_search)
      end if
      call fill_regions(loops, closure%sketch, set)
      call fill_tolerances(loops, closure%sketch, set, findings)
      loops%crank = crank_direction(loops, set%sketch)
      allocate (set%traced)
      set%traced = loops
   end subroutine resolve_sketch

   !> Direction of the crank in the drawing, whatever joint its loop goes through: from its drive to the joint that it shares with
   !> another link, of several to the first by the alphabet; of a crank without such a joint to any of its joints; of a crank
   !> without any that of its slide, of several of the first by the alphabet; degrees.
   pure real(wp) function crank_direction(loops, sketch) result(direction)
      type(loops_t), intent(in) :: loops
      type(sketch_t), intent(in) :: sketch
      integer :: joint, chosen, arc, k, guide
      logical :: shared, chosen_shared

      direction = loops%input
      arc = findloc(loops%arcs%kind == traced_crank .and. loops%arcs%drive == 1, .true., dim=1)
      if (loops%floating .or. sketch%drives(1)%kind /= drive_turns .or. arc == 0) return
      chosen = 0
      chosen_shared = .false.
      associate (drive => sketch%drives(1))
         do joint = 1, size(sketch%joint_name)
            if (joint == drive%joint .or. .not. sketch%has_joint(drive%link, joint)) cycle
            shared = size(sketch%links_of(joint)) > 1
            if (chosen > 0) then
               if (chosen_shared .and. .not. shared) cycle
               if ((chosen_shared .eqv. shared) .and. sketch%joint_name(joint) > sketch%joint_name(chosen)) cycle
            end if
            chosen = joint
            chosen_shared = shared
         end do
         if (chosen == 0) then
            guide = 0
            do k = 1, size(sketch%slides)
               if (.not. any(sketch%slides(k)%links == drive%link)) cycle
               if (guide > 0) then
                  if (sketch%slides(k)%name > sketch%slides(guide)%name) cycle
               end if
               guide = k
            end do
            if (guide > 0) direction = within_turn(sketch%slides(guide)%angle)
            return
         end if
         if (all(loops%arcs(arc)%ends == [drive%joint, chosen])) return
         direction = within_turn(degrees_of(sketch%x(chosen) - sketch%x(drive%joint), sketch%y(chosen) - sketch%y(drive%joint)))
      end associate
   end function crank_direction

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

   !> Only dyads have a transmission angle. TRMIN is refused where there is none.
   subroutine warn_of_idle_angle(loops, set, findings)
      type(loops_t), intent(in) :: loops
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      character(*), parameter :: why = 'has no effect: all links are in groups of more than two, which have no transmission '// &
                                       'angle (the margins of &CONSTR say how far these are from a dead point)'
      integer :: loop

      if (any([(loops%is_dyad(loop), loop=1, loops%loops)])) return
      if (set%limits%trmin_given .or. .not. set%limits%tangle_given) return
      call set%origins%warning(findings, 'LIMITS', 'TANGLE', why)
   end subroutine warn_of_idle_angle

   !> What a search in poses cannot do.
   subroutine refuse_in_poses(set, findings)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings

      if (set%constr%irange /= range_positions) call refuse('CONSTR', 'IRANGE', 'limits between the positions')
      if (set%method%ifree /= 0) call refuse('METHOD', 'IFREE', 'free timing')
      if (set%limits%trmin_given) call refuse(trim(merge('CONSTR', 'LIMITS', set%constr%gives_angle)), 'TRMIN', &
                                              'a least transmission angle')

   contains

      subroutine refuse(group, item, what)
         character(*), intent(in) :: group, item, what

         call set%origins%error(findings, group, item, what//' is for searches by loops; this one is made in the poses of the '// &
                                'links, for it varies '//set%search_in_poses//'; leave it out')
      end subroutine refuse
   end subroutine refuse_in_poses

   !> Check a sketch and put it together at the drawing.
   subroutine assemble_sketch(set, closure, state, sound, findings)
      type(data_set_t), intent(in) :: set
      type(closure_t), intent(out) :: closure
      type(state_t), intent(out) :: state        !! at the drawing
      logical, intent(out) :: sound
      type(diagnostics_t), intent(inout) :: findings
      type(assur_order_t) :: order
      type(factors_t) :: factors
      type(diagnostics_t) :: own
      logical :: closed
      integer :: g

      sound = .false.
      own%file = findings%file
      call check_sketch(set, order, own)
      call findings%append(own)
      if (own%failed()) return
      call make_closure(set%sketch, order, closure)
      call start_state(closure, state)
      do g = 1, size(closure%groups)
         if (size(closure%groups(g)%links) == 0) cycle
         call solve_group(closure, g, state, closed, factors)
         if (.not. closed .or. factors%reciprocal_condition < rank_lost) then
            call set%origins%error(findings, 'CHAIN', 'LNK', trouble(g, closed), closure%groups(g)%links(1))
            return
         end if
      end do
      call place_points(closure, state, 0)
      sound = .true.

   contains

      function trouble(group, closed) result(text)
         integer, intent(in) :: group
         logical, intent(in) :: closed
         character(:), allocatable :: text
         logical :: one
         integer :: k

         text = 'link'
         associate (links => closure%groups(group)%links)
            one = size(links) == 1
            if (.not. one) text = text//'s'
            do k = 1, size(links)
               text = text//' '//trim(set%sketch%links(links(k))%name)
               if (k < size(links)) text = text//','
            end do
         end associate
         if (.not. closed .and. size(set%sketch%length) > 0) then
            text = text//trim(merge(' does', ' do  ', one))//' not meet: with the lengths of LENP they cannot be put '// &
                   'together near the drawing'
         else
            text = text//trim(merge(' stands', ' stand ', one))//' at a dead point in the drawing, where two assemblies '// &
                   'meet; draw the linkage in another position'
         end if
      end function trouble
   end subroutine assemble_sketch

   !> The loops in words, arc by arc, for device 8.
   function words_of(loops, sketch) result(words)
      type(loops_t), intent(in) :: loops
      type(sketch_t), intent(in) :: sketch
      character(:), allocatable :: words
      type(text_t) :: text
      character(:), allocatable :: line
      integer :: k

      call text%add(' LOOPS CHOSEN FOR THE SKETCH, ARC BY ARC (A FOOT IS WHERE A GUIDE MEETS THE LINE OF A SLIDE)')
      line = ''
      do k = 1, size(loops%arcs)
         associate (arc => loops%arcs(k))
            if (arc%place == 1) line = '  LOOP '//to_text(arc%loop)//':'
            line = line//' '//loops%point_name(sketch%joint_name, arc%ends(1))//' TO '// &
                   loops%point_name(sketch%joint_name, arc%ends(2))//' ('//trim(sketch%links(arc%link)%name)
            if (arc%cylinder) then
               line = line//', STRETCHES'
            else if (arc%kind == traced_slide .or. arc%kind == traced_actuator) then
               line = line//', SLIDES'
            end if
            if (arc%kind == traced_link .or. arc%kind == traced_slide) line = line//merge(', +', ', -', arc%sign > 0)
            line = line//')'
            if (k < size(loops%arcs)) then
               if (loops%arcs(k + 1)%loop == arc%loop) line = line//','
            end if
            if (len(line) > 100 .or. k == size(loops%arcs)) then
               call text%add(line)
               line = '        '
            else if (loops%arcs(k + 1)%loop /= arc%loop) then
               call text%add(line)
            end if
         end associate
      end do
      words = text%content()
   end function words_of

   ! ---- dimensions ---------------------------------------------------------------------------------------------------

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
               arc%gama = clean(arc%direction)
            case (traced_link)
               if (.not. loops%is_dyad(arc%loop)) arc%gama = arc%direction
            case (traced_slide, traced_actuator)
               if (.not. arc%cylinder) arc%arcl = 0.0_wp
               if (arc%cylinder) arc%gama = arc%direction
               if (arc%guide_link > 0) arc%gama = clean(arc%direction - loops%arcs(arc%reference)%direction)
            case default
               if (.not. arc%same) arc%gama = clean(arc%direction - loops%arcs(arc%reference)%direction)
               if (arc%same) arc%arcl = loops%arcs(arc%reference)%arcl
            end select
         end associate
      end do
      loops%anchor = loops%input
      pivot = loops%point(loops%start)
      loops%origlk = abs(pivot)
      if (loops%origlk > 0.0_wp) loops%origng = degrees_of(pivot%re, pivot%im)
   end subroutine take_dimensions

   !> Slides where assembling has put them: the point that the second link carries, the direction that the first one has. What moved
   !> by rounding only stays to the bit.
   subroutine move_slides(closure, state, slides)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(slide_t), intent(inout) :: slides(:)
      real(wp), parameter :: still = 1.0e-12_wp !! of the drawing's size, and of a radian
      complex(wp) :: z
      real(wp) :: c, s
      integer :: k

      do k = 1, size(slides)
         associate (of => slides(k))
            call unit_vector(state%phi(of%links(2), 0)*degrees_per_radian, c, s)
            z = state%t(of%links(2), 0) + cmplx(c, s, wp)*closure%slide_point(2, k)
            if (abs(z - cmplx(of%x, of%y, wp)) > still*closure%size) then
               of%x = z%re
               of%y = z%im
            end if
            if (abs(state%phi(of%links(1), 0)) > still) of%angle = of%angle + state%phi(of%links(1), 0)*degrees_per_radian
         end associate
      end do
   end subroutine move_slides

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
            if (place%distance > 0.0_wp) place%angle = clean(degrees_of(z%re, z%im) - direction)
         end if
         place%arc = one%place
         place%loop = one%loop
         place%from_start = from_start
         place%turn = clean(direction - one%direction)
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

   !> The angle in 0 to 360 degrees; what differs from a multiple of 90 by a rounding is that.
   pure real(wp) function clean(angle)
      real(wp), intent(in) :: angle
      real(wp), parameter :: quarter = 90.0_wp, rounding = 64.0_wp*epsilon(1.0_wp)

      clean = within_turn(angle)
      if (abs(clean - quarter*anint(clean/quarter)) < rounding*full_turn) clean = quarter*anint(clean/quarter)
      if (clean >= full_turn) clean = 0.0_wp
   end function clean

   ! ---- output ------------------------------------------------------------------------------------------------------

   !> The first output that the arrays can tell; without one the first point of a single link, else the last moving joint.
   subroutine fill_output(loops, state, sketch, set, findings)
      type(loops_t), intent(inout) :: loops
      type(state_t), intent(in) :: state
      type(sketch_t), intent(in) :: sketch
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(sketch_output_t) :: shown
      logical :: done

      done = .false.
      if (size(sketch%outputs) > 0) then
         call put_output(loops, state, sketch, sketch%outputs(1), done)
         if (done) return
         if (set%method%desired) then
            call set%origins%error(findings, 'OUTPUTS', 'OUTPUT', 'the desired values of &METHOD are those of the first '// &
                                   'output, which '//trim(sketch%outputs(1)%name)//' cannot be here; give its values as DES1 '// &
                                   'of &OUTPUTS, or put a point, angle, distance from the origin or slide first', 1)
         end if
         if (set%toler%adjusted) call set%origins%error(findings, 'TOLER', 'ADJUST', 'ADJUST restores the first output, which '// &
            trim(sketch%outputs(1)%name)//' cannot be here; put a point, angle, distance from the origin or slide first', 1)
         loops%stand_in = trim(sketch%joint_name(default_joint(sketch)))
      end if
      shown%kind = output_point
      shown%joints(1) = default_joint(sketch)
      call put_output(loops, state, sketch, shown, done)
   end subroutine fill_output

   !> True if the first output is a pose that has desired values.
   pure logical function wants_poses(set)
      type(data_set_t), intent(in) :: set

      wants_poses = set%method%desired .and. size(set%sketch%outputs) > 0
      if (wants_poses) wants_poses = set%sketch%outputs(1)%kind == output_pose
   end function wants_poses

   !> True if the first output is a slide of a larger group that has desired values: those are of its travel, for the user knows no
   !> length of its arc.
   pure logical function wants_travel(loops, set)
      type(loops_t), intent(in) :: loops
      type(data_set_t), intent(in) :: set
      integer :: arc

      wants_travel = .false.
      if (.not. (loops%found .and. set%method%desired) .or. size(set%sketch%outputs) == 0) return
      if (set%sketch%outputs(1)%kind /= output_slide) return
      arc = findloc(loops%arcs%slide, set%sketch%outputs(1)%slide, dim=1)
      if (arc > 0) wants_travel = loops%arcs(arc)%guide_link > 0
   end function wants_travel

   !> Desired values of the first output are those of &METHOD, if the loops can tell it: DES1 is another word for DESX and DESY,
   !> or DESANG, DVEL1 and DACC1 for their derivatives. Not so of a slide, whose arc has another zero. Values of the others, and of
   !> a first one that is no output of the loops, are compared beside it.
   subroutine take_wishes(loops, state, sketch, set)
      type(loops_t), intent(inout) :: loops
      type(state_t), intent(in) :: state
      type(sketch_t), intent(in) :: sketch
      type(data_set_t), intent(inout) :: set
      logical :: told

      associate (first => sketch%outputs(1))
         told = first%kind /= output_slide
         if (told) call put_output(loops, state, sketch, first, told)
         if (told .and. (set%method%desired .neqv. first%is_wished())) then
            call give_to_method(set)
         else if (wants_travel(loops, set) .or. (set%method%desired .and. first%kind == output_pose .and. .not. told)) then
            call take_from_method(set)
         end if
      end associate
   end subroutine take_wishes

   !> Wishes of the first output as desired values of &METHOD.
   subroutine give_to_method(set)
      type(data_set_t), intent(inout) :: set
      type(output_kind_t) :: kind
      integer :: order

      kind = kind_of_output(set%sketch%outputs(1)%kind)
      associate (wishes => set%sketch%outputs(1)%wishes)
         if (allocated(wishes(0)%values)) then
            if (kind%components > 1) then
               set%method%desx = wishes(0)%values(1, :)
               set%method%desy = wishes(0)%values(2, :)
               set%method%xmult = wishes(0)%weights(1, :)
               set%method%ymult = wishes(0)%weights(2, :)
            end if
            if (kind%components /= 2) then
               set%method%desang = wishes(0)%values(kind%components, :)
               set%method%anmult = wishes(0)%weights(kind%components, :)
            end if
            deallocate (wishes(0)%values, wishes(0)%weights)
         end if
         do order = 1, most_wished
            if (.not. allocated(wishes(order)%values)) cycle
            if (.not. allocated(set%method%rate_wanted)) &
               allocate (set%method%rate_wanted(set%method%ndes, kind%components, most_wished), &
                         set%method%rate_weight(set%method%ndes, kind%components, most_wished), source=0.0_wp)
            set%method%rate_wanted(:, :, order) = transpose(wishes(order)%values)
            set%method%rate_weight(:, :, order) = transpose(wishes(order)%weights)
            deallocate (wishes(order)%values, wishes(order)%weights)
         end do
      end associate
      set%method%desired = .true.
   end subroutine give_to_method

   !> Desired poses or travels of &METHOD, and their derivatives, as wishes of the first output.
   subroutine take_from_method(set)
      type(data_set_t), intent(inout) :: set
      integer :: order

      associate (wishes => set%sketch%outputs(1)%wishes, method => set%method)
         method%desired = .false.
         if (set%sketch%outputs(1)%kind == output_slide) then
            wishes(0)%values = reshape(method%desang, [1, method%ndes])
            wishes(0)%weights = reshape(method%anmult, [1, method%ndes])
         else
            allocate (wishes(0)%values(3, method%ndes), wishes(0)%weights(3, method%ndes))
            wishes(0)%values(1, :) = method%desx + method%xadd
            wishes(0)%values(2, :) = method%desy + method%yadd
            wishes(0)%values(3, :) = method%desang
            wishes(0)%weights(1, :) = method%xmult
            wishes(0)%weights(2, :) = method%ymult
            wishes(0)%weights(3, :) = method%anmult
         end if
         if (.not. allocated(method%rate_wanted)) return
         do order = 1, most_wished
            if (.not. any(method%rate_weight(:, :, order) > 0.0_wp)) cycle
            wishes(order)%values = transpose(method%rate_wanted(:, :, order))
            wishes(order)%weights = transpose(method%rate_weight(:, :, order))
         end do
         deallocate (method%rate_wanted, method%rate_weight)
      end associate
   end subroutine take_from_method

   !> The joint that is shown of a sketch without outputs.
   pure integer function default_joint(sketch) result(joint)
      type(sketch_t), intent(in) :: sketch
      integer :: j

      joint = 1
      do j = 1, size(sketch%joint_name)
         if (.not. sketch%has_joint(frame_link, j)) joint = j
      end do
      do j = size(sketch%joint_name), 1, -1
         if (.not. sketch%has_joint(frame_link, j) .and. size(sketch%links_of(j)) == 1) joint = j
      end do
   end function default_joint

   !> Describe an output by an arc. `done` is false for one that the arrays cannot tell.
   subroutine put_output(loops, state, sketch, output, done)
      type(loops_t), intent(inout) :: loops
      type(state_t), intent(in) :: state
      type(sketch_t), intent(in) :: sketch
      type(sketch_output_t), intent(in) :: output
      logical, intent(out) :: done
      integer :: arc, k
      integer, allocatable :: links(:)
      complex(wp) :: h

      done = .false.
      loops%motion = motion_point
      loops%outlk = 0.0_wp
      loops%outang = 0.0_wp
      loops%output_joint = 0
      if (any(output%kind == [output_point, output_distance, output_pose])) loops%output_joint = output%joints(1)
      select case (output%kind)
      case (output_point, output_distance)
         if (output%kind == output_distance) then
            loops%motion = motion_distance
            if (output%joints(2) > 0) return
         end if
         links = sketch%links_of(output%joints(1))
         do k = size(links), 1, -1
            if (links(k) == frame_link .and. k > 1) cycle
            call from_arc_of(links(k))
            if (done) exit
         end do
      case (output_angle, output_pose)
         loops%motion = merge(motion_angle, motion_pose, output%kind == output_angle)
         k = merge(1, 2, output%kind == output_angle)
         do arc = 1, size(sketch%links)
            if (.not. sketch%has_joint(arc, output%joints(k)) .or. .not. sketch%has_joint(arc, output%joints(k + 1))) cycle
            if (output%kind == output_pose) then
               if (.not. sketch%has_joint(arc, output%joints(1))) return
               call from_arc_of(arc)
            else
               loops%output_arc = 0
               done = loops%axis(arc) > 0
               if (done) call name_arc(loops%axis(arc), .false.)
            end if
            if (.not. done) return
            h = state%joint(output%joints(k + 1), 0) - state%joint(output%joints(k), 0)
            if (output%kind == output_angle) loops%outang = clean(degrees_of(h%re, h%im) - direction())
            exit
         end do
         ! the direction of a pose is that of its output arc: only from the joint along the line
         if (output%kind == output_pose .and. done) done = abs(modulo(loops%outang + direction() - degrees_of(h%re, h%im) &
                                                                      + 180.0_wp, full_turn) - 180.0_wp) < 1.0e-9_wp
      case (output_slide)
         loops%motion = motion_slide
         do k = 1, size(loops%arcs)
            if (loops%arcs(k)%slide /= output%slide) cycle
            call name_arc(k, .false.)
            done = .true.
            return
         end do
      end select

   contains

      real(wp) function direction()
         direction = 0.0_wp
         if (loops%output_arc > 0) direction = loops%arcs(loops%output_arc)%direction
      end function direction

      subroutine name_arc(which, from_start)
         integer, intent(in) :: which
         logical, intent(in) :: from_start

         loops%output_arc = which
         loops%from_start = from_start
      end subroutine name_arc

      !> From an end of an arc of the link: the joint itself if it is one.
      subroutine from_arc_of(link)
         integer, intent(in) :: link
         integer :: point, found, chosen
         logical :: from_start, start_of_it
         complex(wp) :: v

         call arc_with(loops, link, output%joints(1), chosen, from_start)
         if (chosen == 0) then
            do point = 1, size(loops%point)
               call arc_with(loops, link, point, found, start_of_it)
               if (found == 0) cycle
               chosen = found
               from_start = start_of_it
               exit
            end do
         end if
         if (chosen == 0) return
         done = .true.
         call name_arc(chosen, from_start)
         point = loops%arcs(chosen)%ends(merge(1, 2, from_start))
         v = state%joint(output%joints(1), 0) - loops%point(point)
         loops%outlk = abs(v)
         if (point == output%joints(1)) loops%outlk = 0.0_wp
         if (loops%outlk > 0.0_wp) loops%outang = clean(degrees_of(v%re, v%im) - loops%arcs(chosen)%direction)
         if (output%kind == output_pose) then
            v = state%joint(output%joints(3), 0) - state%joint(output%joints(2), 0)
            if (loops%outlk == 0.0_wp) loops%outang = clean(degrees_of(v%re, v%im) - loops%arcs(chosen)%direction)
         end if
      end subroutine from_arc_of
   end subroutine put_output

   ! ---- variables ---------------------------------------------------------------------------------------------------

   !> What varies, from the names, and the bounds in the order of the listing.
   subroutine fill_variables(loops, sketch, set, findings)
      type(loops_t), intent(inout) :: loops
      type(sketch_t), intent(in) :: sketch
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      integer, parameter :: of_outlk = 1, of_origlk = 2, of_outang = 3, of_origng = 4, of_input = 5
      real(wp), allocatable :: low_length(:), high_length(:), low_angle(:), high_angle(:) !! by arc
      real(wp) :: low(of_input), high(of_input)
      integer :: k, n

      if (size(sketch%variations) == 0) return
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
      if (loops%outlk_varies) call bound(low(of_outlk), high(of_outlk))
      if (loops%pivot_varies) call bound(low(of_origlk), high(of_origlk))
      do n = 1, size(loops%arcs)
         if (loops%arcs(n)%angle_varies) call bound(low_angle(n), high_angle(n))
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
               call missing(which, dimension_words(sketch, one))
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

      !> All lengths and angles of arcs that are not zero, or another's, or the input; the output point on its link; the place
      !> of the whole; the reference input, unless timing is free.
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

   ! ---- dimensions by name ------------------------------------------------------------------------------------------

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
   subroutine locate_dimension(loops, one, what, arc, sense, zero)
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
   subroutine find_arc(loops, a, b, arc, forward)
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
      integer :: i, told

      have = ''
      told = 0
      do i = 1, size(loops%arcs)
         associate (arc => loops%arcs(i))
            if (arc%same .or. arc%against .or. any(arc%ends > size(sketch%joint_name)) .or. arc%length == 0.0_wp) cycle
            if (any(arc%kind == [traced_slide, traced_actuator])) cycle
            told = told + 1
            if (told > most_named) cycle
            have = have//', '//line_words(sketch, arc%ends)
         end associate
      end do
      if (told > most_named) have = have//' and '//to_text(told - most_named)//' more,'
      if (len(have) > 0) have = '; there are the lengths '//have(3:)//' and the angles between them'
      words = ' is no dimension of the loops'//have
   end function none_such
end module psalm_sketch_case
