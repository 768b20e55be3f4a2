!> SETUP: the topology arrays become arcs, dyads and variables, and every mistake in them is found.
!>
!> What the thesis prints on device 8 (LOOPL, LARCX, LARCD, LARCF, IDENTA, variable numbers, JOINT) is here under its own
!> names; everything else is held by arc. Arc numbers run from 1 in a loop; a sequential number is
!> n = (loop-1)*MAXARC + arc. Source: Oldham (1977), chapter 4 and appendices B2 and C.
module psalm_setup
   use psalm_data_set, only: data_set_t
   use psalm_dyad_kind, only: assur_none, direction_known, form_of, form_t, kind_of_dyad
   use psalm_joints, only: joints_t, find_joints
   use psalm_kinds, only: wp, full_turn, half_turn
   use psalm_origin, only: origin_t
   use psalm_output_kind, only: motion_slide
   use psalm_status, only: diagnostics_t, level_error, level_warning
   use psalm_text, only: general, lower_case, to_text
   use psalm_topology, only: topology_t, dimensions_t, variable_t, arc_absent, arc_determined, arc_link, arc_slide, arc_crank, &
                             arc_actuator, name_of, variable_length, variable_outlk, variable_origlk, variable_gama, &
                             variable_outang, variable_origng, variable_crnki
   implicit none (type, external)
   private
   public :: set_up

   integer, parameter :: most_named = 40 !! variables named in one message

contains

   !> Understand a data set: topology, dimensions, variables.
   !>
   !> Errors: all fatal conditions of the topology, found before returning (in `findings`); warnings as well.
   subroutine set_up(set, topology, dimensions, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(out) :: topology
      type(dimensions_t), intent(out) :: dimensions
      type(diagnostics_t), intent(inout) :: findings
      logical :: sound

      topology%nloop = set%nloop
      topology%maxarc = set%maxarc
      allocate (topology%arcs(set%nloop*set%maxarc), topology%variables(0))
      allocate (topology%loopl(set%nloop), topology%joint(set%nloop), source=0)
      allocate (topology%larcx(2, set%nloop), source=0)
      allocate (topology%larcd(size(topology%arcs)), topology%larcf(size(topology%arcs)), source=0)
      allocate (topology%identa(size(topology%arcs)), source=0)
      allocate (topology%length_variable(size(topology%arcs)), topology%angle_variable(size(topology%arcs)), source=0)
      dimensions%arcl = reshape(set%arcl, [size(set%arcl)])
      dimensions%gama = reshape(set%gama, [size(set%gama)])
      dimensions%outlk = set%outlk
      dimensions%outang = set%outang
      dimensions%origlk = set%origlk
      dimensions%origng = set%origng
      dimensions%crnki = set%crnki
      if (set%nloop == 0) return

      call classify_arcs(set, topology, sound, findings)
      if (.not. sound) return
      call find_dyads(set, topology, dimensions, findings)
      if (findings%failed()) return
      call find_identical(set, topology, dimensions, findings)
      call index_arcs(topology)
      call find_output(set, topology, findings)
      if (set%ikin == 0) call find_variables(set, topology, findings)
      call check_dimensions(set, topology, dimensions, findings)
      call find_repeated(set, findings)
   end subroutine set_up

   ! ---- arcs --------------------------------------------------------------------------------------------------------

   !> Tell determined, undetermined, absent arcs and the input apart, and check every reference.
   subroutine classify_arcs(set, topology, sound, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(inout) :: topology
      logical, intent(out) :: sound  !! every loop has its arcs in order, so that dyads can be looked for
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, n

      sound = .true.
      do loop = 1, set%nloop
         n = 0
         do a = 1, set%maxarc
            if (set%ilink(a, loop) /= 0) n = a
         end do
         topology%loopl(loop) = n
         do a = 1, n
            if (set%ilink(a, loop) == 0) then
               call complain(set, 'ILINK', loop, a, 'is 0 (no arc), but arcs follow in this loop', findings)
               sound = .false.
            end if
         end do
         do a = n + 1, set%maxarc
            if (set%iloop(a, loop) /= 0) then
               call complain(set, 'ILOOP', loop, a, 'must be 0, because ILINK says there is no such arc', findings)
            end if
         end do
         if (n < 3) then
            call complain(set, 'ILINK', loop, 0, 'has fewer than three arcs', findings)
            sound = .false.
         end if
      end do
      if (.not. sound) return
      call find_misplaced_frame(set, topology, sound, findings)
      if (.not. sound) return
      do loop = 1, set%nloop
         do a = 1, topology%loopl(loop)
            call classify(set, topology, loop, a, findings)
         end do
         call check_frame_end(set, topology, loop, findings)
      end do
   end subroutine classify_arcs

   !> A frame arc that is not the last of loop 1: everything else that looks wrong then follows from it.
   subroutine find_misplaced_frame(set, topology, sound, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(in) :: topology
      logical, intent(inout) :: sound
      type(diagnostics_t), intent(inout) :: findings
      integer :: a, n

      n = topology%loopl(1)
      if (set%iloop(n, 1) == 1) return
      do a = 2, n - 1
         if (abs(set%ilink(a, 1)) /= a .or. set%iloop(a, 1) /= 1) cycle
         sound = .false.
         call complain(set, 'ILINK', 1, a, 'is measured from the machine''s x axis, as the frame arc is: the frame arc must '// &
                       'come last in its loop, as arc '//to_text(n), findings)
         return
      end do
   end subroutine find_misplaced_frame

   subroutine classify(set, topology, loop, a, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(inout) :: topology
      integer, intent(in) :: loop, a
      type(diagnostics_t), intent(inout) :: findings
      integer :: link, other, n

      n = topology%loopl(loop)
      link = set%ilink(a, loop)
      other = set%iloop(a, loop)
      associate (arc => topology%arcs(topology%seq(loop, a)))
         arc%sign = sign(1, link)
         if (loop == 1 .and. a == 1) then
            if (abs(link) /= 1) call complain(set, 'ILINK', 1, 1, 'must be 1 (the input link)', findings)
            if (other == 1) then
               arc%kind = arc_crank
               if (link /= 1) call complain(set, 'ILINK', 1, 1, 'must be +1 for a turning input link', findings)
            else if (other < 0 .and. -other <= n .and. -other > 1) then
               arc%kind = arc_actuator
               arc%reference = topology%seq(1, -other)
               arc%turn = arc%sign
               topology%sliding_input = .true.
            else
               arc%kind = arc_crank
               call complain(set, 'ILOOP', 1, 1, 'must be 1 for a turning input link, or minus the number of the frame '// &
                             'arc that guides a sliding one; found '//to_text(other), findings)
            end if
            return
         end if
         if (other == 0) then
            arc%kind = arc_link
            if (abs(link) /= a) call complain(set, 'ILINK', loop, a, 'must be +-'//to_text(a)// &
                                              ', its own number, because ILOOP says it is undetermined; found '// &
                                              to_text(link), findings)
         else if (other < 0) then
            arc%kind = arc_slide
            if (abs(link) /= a) call complain(set, 'ILINK', loop, a, 'must be +-'//to_text(a)// &
                                              ', its own number, because ILOOP says it slides; found '//to_text(link), findings)
            if (-other > n) then
               call complain(set, 'ILOOP', loop, a, 'names guide '//to_text(-other)//', but the loop has only '// &
                             to_text(n)//' arcs', findings)
            else if (-other == a) then
               call complain(set, 'ILOOP', loop, a, 'names the slide itself as its guide', findings)
            else
               arc%reference = topology%seq(loop, -other)
               arc%turn = slide_turn(arc%sign, a, -other)
            end if
         else
            arc%kind = arc_determined
            arc%same = link > 0
            call check_reference(set, topology, loop, a, findings)
         end if
      end associate
   end subroutine classify

   !> Direction of a slide against its guide: +1 for 90 degrees anticlockwise.
   !>
   !> The right angle is turned through in loop order: a guide before the slide gives +s, a guide after it -s. The loop is a
   !> ring: for a slide that leaves the input pivot, a frame arc comes before it.
   pure integer function slide_turn(s, slide, guide)
      integer, intent(in) :: s, slide, guide
      logical :: before

      before = guide < slide .or. (slide == 1 .and. guide > 2)
      slide_turn = merge(s, -s, before)
   end function slide_turn

   subroutine check_reference(set, topology, loop, a, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(inout) :: topology
      integer, intent(in) :: loop, a
      type(diagnostics_t), intent(inout) :: findings
      integer :: named, in_loop

      named = abs(set%ilink(a, loop))
      in_loop = set%iloop(a, loop)
      if (in_loop > loop) then
         call complain(set, 'ILOOP', loop, a, 'refers to loop '//to_text(in_loop)//', which is not yet determined', findings)
         return
      end if
      if (named > topology%loopl(in_loop)) then
         call complain(set, 'ILINK', loop, a, 'refers to arc '//to_text(named)//' of loop '//to_text(in_loop)// &
                       ', which does not exist', findings)
         return
      end if
      associate (arc => topology%arcs(topology%seq(loop, a)))
         if (loop == 1 .and. a == topology%loopl(1) .and. named == a) then
            arc%frame = .true.
            arc%same = .false.
            return
         end if
         if (in_loop == loop) then
            if (named == a) then
               call complain(set, 'ILINK', loop, a, 'refers to itself; only the last arc of loop 1 is measured from the '// &
                             'machine''s x axis', findings)
               return
            end if
            if (loop == 1 .and. named == topology%loopl(1)) then
               arc%frame = .true.
            else if (named > a .or. set%iloop(named, loop) <= 0) then
               call complain(set, 'ILINK', loop, a, 'refers to arc '//to_text(named)//' of its own loop, which is not yet '// &
                             'determined', findings)
               return
            end if
            if (.not. is_guide(set, loop, a, topology%loopl(loop)) .and. &
                .not. is_guide(set, loop, named, topology%loopl(loop))) then
               call complain(set, 'ILINK', loop, a, 'is common with arc '//to_text(named)//' of the same loop; two arcs of '// &
                             'one link make one arc, unless one of them guides a slide', findings)
            end if
         end if
         arc%reference = topology%seq(in_loop, named)
         if (topology%arcs(arc%reference)%frame) arc%frame = .true.
      end associate
   end subroutine check_reference

   !> True if the arc guides a slide of its loop.
   pure logical function is_guide(set, loop, a, n)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: loop, a, n

      is_guide = any(set%iloop(:n, loop) == -a)
   end function is_guide

   !> The last arc of every loop belongs to the frame.
   subroutine check_frame_end(set, topology, loop, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(in) :: topology
      integer, intent(in) :: loop
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: missing
      integer :: n

      n = topology%loopl(loop)
      missing = ''
      if (set%iloop(n, loop) <= 0) missing = '; the frame arc seems to be missing'
      associate (arc => topology%arcs(topology%seq(loop, n)))
         ! the frame's own arc hangs on the x axis, not on another arc of the frame
         if (arc%frame .and. (loop > 1 .or. abs(set%ilink(n, 1)) == n)) return
         if (loop == 1) then
            call complain(set, 'ILINK', 1, n, 'is the last arc of loop 1, the frame: ILINK='//to_text(n)// &
                          ' and ILOOP=1 are expected, its direction in GAMA'//missing, findings)
         else
            call complain(set, 'ILINK', loop, n, 'is the last arc of its loop and must belong to the frame: refer to arc '// &
                          to_text(topology%loopl(1))//' of loop 1 or to another frame arc'//missing, findings)
         end if
      end associate
   end subroutine check_frame_end

   ! ---- dyads -------------------------------------------------------------------------------------------------------

   !> The undetermined pair of every loop and its type.
   subroutine find_dyads(set, topology, dimensions, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(inout) :: topology
      type(dimensions_t), intent(in) :: dimensions
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, n, found, p, q

      do loop = 1, set%nloop
         found = 0
         n = topology%loopl(loop)
         do a = 1, n
            select case (topology%arcs(topology%seq(loop, a))%kind)
            case (arc_link, arc_slide)
               found = found + 1
               if (found <= 2) topology%larcx(found, loop) = a
            end select
         end do
         if (found /= 2) then
            call complain(set, 'ILOOP', loop, 0, 'has '//to_text(found)//' undetermined arcs (ILOOP 0 or negative); '// &
                          'it must have two', findings)
            cycle
         end if
         p = topology%larcx(1, loop)
         q = topology%larcx(2, loop)
         if (q /= p + 1) then
            call complain(set, 'ILOOP', loop, 0, 'has its undetermined arcs '//to_text(p)//' and '//to_text(q)// &
                          ' apart; they must be adjacent', findings)
            cycle
         end if
         topology%arcs(topology%seq(loop, p))%dyad = 1
         topology%arcs(topology%seq(loop, q))%dyad = 2
         topology%joint(loop) = kind_of_dyad(topology%arcs(topology%seq(loop, p):topology%seq(loop, q))%kind == arc_slide, &
                                             [-set%iloop(p, loop) == q, -set%iloop(q, loop) == p])
         if (topology%joint(loop) == assur_none) then
            call complain(set, 'ILOOP', loop, 0, 'has an undetermined pair that is none of the eight dyads: two slides that '// &
                          'guide each other', findings)
         end if
         call check_closure_entries(set, topology, dimensions, loop, p, q, findings)
      end do
      call check_order(set, topology, findings)
   end subroutine find_dyads

   !> Types 1, 2, 3: both entries state the same fact and must agree, unless the guide has no length.
   subroutine check_closure_entries(set, topology, dimensions, loop, p, q, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(in) :: topology
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: loop, p, q
      type(diagnostics_t), intent(inout) :: findings

      type(form_t) :: form
      integer :: guide

      form = form_of(topology%joint(loop))
      if (any(form%direction == direction_known)) return
      guide = guide_of_dyad(topology, loop)
      if (guide > 0) then
         if (dimensions%arcl(topology%seq(loop, guide)) <= 0.0_wp) return
      end if
      if (sign(1, set%ilink(p, loop)) /= sign(1, set%ilink(q, loop))) then
         call complain(set, 'ILINK', loop, 0, 'has undetermined arcs '//to_text(p)//' and '//to_text(q)//' of opposite sign; '// &
                       'for this dyad both are positive when the joint they share lies to the right of the line from the '// &
                       'start of the first to the finish of the second', findings)
      end if
   end subroutine check_closure_entries

   !> Arc of a loop that guides its partner in an RPR dyad; 0: the loop's dyad is another.
   pure integer function guide_of_dyad(topology, loop) result(guide)
      type(topology_t), intent(in) :: topology
      integer, intent(in) :: loop
      type(form_t) :: form

      guide = 0
      form = form_of(topology%joint(loop))
      if (count(form%slides) == 1 .and. .not. any(form%direction == direction_known)) &
         guide = topology%larcx(findloc(form%slides, .false., dim=1), loop)
   end function guide_of_dyad

   !> Determined arcs of a loop may not hang on the loop's own unknowns, and guides must be known or be the partner.
   subroutine check_order(set, topology, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(in) :: topology
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, guide

      do loop = 1, set%nloop
         do a = 1, topology%loopl(loop)
            associate (arc => topology%arcs(topology%seq(loop, a)))
               if (arc%kind == arc_actuator) then
                  guide = -set%iloop(a, loop)
                  if (.not. topology%arcs(topology%seq(loop, guide))%frame) then
                     call complain(set, 'ILOOP', loop, a, 'names arc '//to_text(guide)//' as the guide of the sliding input, '// &
                                   'but that is not a frame arc', findings)
                  end if
               end if
            end associate
         end do
      end do
   end subroutine check_order

   ! ---- identical arcs ----------------------------------------------------------------------------------------------

   !> Arcs that are the same line of the same link, in either sense of tracing.
   subroutine find_identical(set, topology, dimensions, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(inout) :: topology
      type(dimensions_t), intent(inout) :: dimensions
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, n, m
      logical :: against, along
      type(joints_t) :: joints

      call find_joints(topology, dimensions, joints)
      topology%arcs%representative = [(n, n=1, size(topology%arcs))]
      do loop = 1, set%nloop
         do a = 1, topology%loopl(loop)
            n = topology%seq(loop, a)
            associate (arc => topology%arcs(n))
               if (arc%kind /= arc_determined .or. arc%reference == 0) cycle
               m = arc%reference
               along = modulo(dimensions%gama(n), full_turn) == 0.0_wp
               against = abs(modulo(dimensions%gama(n), full_turn) - half_turn) == 0.0_wp
               if (arc%same) then
                  arc%representative = topology%arcs(m)%representative
                  arc%reversed = topology%arcs(m)%reversed
                  if (dimensions%gama(n) /= 0.0_wp) call arc_warning(set, 'GAMA', loop, a, 'is not used: ILINK is positive, '// &
                     'the arc has the direction of arc '//place(topology, m), findings)
                  if (dimensions%arcl(n) /= dimensions%arcl(m) .and. dimensions%arcl(n) /= 0.0_wp) then
                     call arc_warning(set, 'ARCL', loop, a, 'is not used: ILINK is positive, the arc has the length of arc '// &
                                      place(topology, m), findings)
                  end if
                  dimensions%arcl(n) = dimensions%arcl(m)
                  dimensions%gama(n) = 0.0_wp
               else if (against .and. dimensions%arcl(n) == dimensions%arcl(m) .and. m > 0 .and. &
                        .not. varies_alone(set, loop, a) .and. has_length(topology%arcs(topology%arcs(m)%representative)%kind)) then
                  arc%representative = topology%arcs(m)%representative
                  arc%reversed = .not. topology%arcs(m)%reversed
                  call arc_warning(set, 'ILINK', loop, a, 'is identical with arc '//place(topology, m)// &
                                   ' but traced the other way', findings)
               else if (along .and. dimensions%arcl(n) == dimensions%arcl(m) .and. .not. varies_alone(set, loop, a) .and. &
                        has_length(topology%arcs(topology%arcs(m)%representative)%kind) .and. joints%alike(n, m)) then
                  arc%representative = topology%arcs(m)%representative
                  arc%reversed = topology%arcs(m)%reversed
                  call arc_warning(set, 'ILINK', loop, a, 'is identical with arc '//place(topology, m)// &
                                   ' and is taken for it, as a positive ILINK would say', findings)
               end if
            end associate
         end do
      end do
      do loop = 1, set%nloop
         do a = 1, topology%loopl(loop)
            n = topology%seq(loop, a)
            if (.not. joints%astray(n)) cycle
            call arc_warning(set, 'ILINK', loop, a, 'belongs to the link of arc '//place(topology, topology%arcs(n)%reference)// &
                             ', but it begins and ends at no joint of that link', findings)
         end do
      end do
   end subroutine find_identical

   !> True if the user lets this arc's own length or angle vary, so that it is not merely another arc turned round.
   pure logical function varies_alone(set, loop, a)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: loop, a

      varies_alone = .false.
      if (size(set%iva) > 0) varies_alone = set%ivg(a, loop) /= 0
   end function varies_alone

   pure logical function has_length(kind)
      integer, intent(in) :: kind

      has_length = kind /= arc_slide .and. kind /= arc_actuator
   end function has_length

   !> The arrays that device 8 shows.
   pure subroutine index_arcs(topology)
      type(topology_t), intent(inout) :: topology
      integer :: alike(size(topology%arcs))  !! by representative: arcs it stands for
      integer :: loop, a, n, m

      alike = 0
      do n = 1, size(topology%arcs)
         associate (arc => topology%arcs(n))
            if (arc%kind /= arc_absent) alike(arc%representative) = alike(arc%representative) + 1
         end associate
      end do
      do loop = 1, topology%nloop
         do a = 1, topology%loopl(loop)
            n = topology%seq(loop, a)
            associate (arc => topology%arcs(n))
               m = arc%reference
               if (m == 0 .and. (arc%kind == arc_crank .or. arc%kind == arc_determined)) m = n
               topology%larcd(n) = m
               if (m > 0) topology%larcf(n) = last_arc_of(m)
               if (alike(arc%representative) > 1) topology%identa(n) = arc%representative
            end associate
         end do
      end do

   contains

      pure integer function last_arc_of(n)
         integer, intent(in) :: n
         integer :: loop

         loop = (n - 1)/topology%maxarc + 1
         last_arc_of = topology%seq(loop, topology%loopl(loop))
      end function last_arc_of
   end subroutine index_arcs

   ! ---- output and variables ----------------------------------------------------------------------------------------

   subroutine find_output(set, topology, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(inout) :: topology
      type(diagnostics_t), intent(inout) :: findings

      if (set%noutlp < 1 .or. set%noutlp > set%nloop) then
         call findings%error('must name a loop from 1 to '//to_text(set%nloop)//'; found '//to_text(set%noutlp), &
                             line=set%origins%line('LINKS', 'NOUTLP', 1), group='LINKS', item='NOUTLP')
         return
      end if
      if (set%noutlk == 0 .or. abs(set%noutlk) > topology%loopl(set%noutlp)) then
         call findings%error('must name an arc from 1 to '//to_text(topology%loopl(set%noutlp))//' of loop '// &
                             to_text(set%noutlp)//'; found '//to_text(set%noutlk), &
                             line=set%origins%line('LINKS', 'NOUTLK', 1), group='LINKS', item='NOUTLK')
         return
      end if
      topology%output_arc = topology%seq(set%noutlp, abs(set%noutlk))
      topology%output_from_start = set%noutlk < 0
      if (set%motion == motion_slide) then
         associate (arc => topology%arcs(topology%arcs(topology%output_arc)%representative))
            if (arc%kind /= arc_slide .and. arc%kind /= arc_actuator) then
               call findings%error('MOTION=3 needs a sliding arc, but arc '//place(topology, topology%output_arc)// &
                                   ' does not slide', line=set%origins%line('LINKS', 'NOUTLK', 1), group='LINKS', item='NOUTLK')
            end if
         end associate
      end if
      if (set%ikin /= 0 .and. topology%sliding_input) then
         call findings%error('IKIN sweeps a full turn; with a sliding input give NDES and DELT', &
                             line=set%origins%line('METHOD', 'IKIN', 1), group='METHOD', item='IKIN')
      end if
   end subroutine find_output

   !> Number the variables: IVA row by row, ILKOUT, IORIG distance, IVG, INGOUT, IORIG angle, ICRK.
   subroutine find_variables(set, topology, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(inout) :: topology
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, n, m

      if (size(set%iva) == 0) return
      do loop = 1, set%nloop
         do a = 1, set%maxarc
            if (set%iva(a, loop) == 0) cycle
            n = topology%seq(loop, a)
            associate (arc => topology%arcs(n))
               if (arc%kind == arc_absent) then
                  call arc_warning(set, 'IVA', loop, a, 'does not exist and cannot vary', findings)
               else if (.not. has_length(topology%arcs(arc%representative)%kind)) then
                  call arc_warning(set, 'IVA', loop, a, 'slides: its length is a result and cannot vary', findings)
               else if (topology%length_variable(arc%representative) > 0 .or. arc%representative /= n) then
                  call arc_warning(set, 'IVA', loop, a, 'is identical with arc '//place(topology, arc%representative)// &
                                   '; the two lengths cannot vary independently', findings)
                  if (topology%length_variable(arc%representative) == 0) call add_length(arc%representative)
               else
                  call add_length(n)
               end if
            end associate
         end do
      end do
      if (set%ilkout /= 0) call add(variable_outlk)
      if (set%iorig /= 0) call add(variable_origlk)
      do loop = 1, set%nloop
         do a = 1, set%maxarc
            if (set%ivg(a, loop) == 0) cycle
            n = topology%seq(loop, a)
            associate (arc => topology%arcs(n))
               m = n
               if (arc%same .and. arc%reference > 0) m = angle_owner(n)
               if (arc%kind == arc_absent) then
                  call arc_warning(set, 'IVG', loop, a, 'does not exist and cannot vary', findings)
               else if (topology%arcs(m)%kind /= arc_determined) then
                  call arc_warning(set, 'IVG', loop, a, 'has no fixed angle: its direction is a result and cannot vary', findings)
               else if (m /= n) then
                  call arc_warning(set, 'IVG', loop, a, 'is identical with arc '//place(topology, m)// &
                                   '; the two angles cannot vary independently', findings)
                  if (topology%angle_variable(m) == 0) call add_angle(m)
               else if (topology%angle_variable(n) == 0) then
                  call add_angle(n)
               end if
            end associate
         end do
      end do
      if (set%ingout /= 0) call add(variable_outang)
      if (set%iorig /= 0) call add(variable_origng)
      if (set%icrk /= 0) call add(variable_crnki)

   contains

      !> The arc whose GAMA gives the direction of an arc with positive ILINK.
      pure integer function angle_owner(n)
         integer, intent(in) :: n

         angle_owner = n
         do while (topology%arcs(angle_owner)%same .and. topology%arcs(angle_owner)%reference > 0)
            angle_owner = topology%arcs(angle_owner)%reference
         end do
      end function angle_owner

      subroutine add(kind, n)
         integer, intent(in) :: kind
         integer, intent(in), optional :: n
         type(variable_t) :: variable

         variable%kind = kind
         if (present(n)) then
            variable%loop = (n - 1)/topology%maxarc + 1
            variable%arc = n - (variable%loop - 1)*topology%maxarc
         end if
         topology%variables = [topology%variables, variable]
      end subroutine add

      subroutine add_length(n)
         integer, intent(in) :: n

         call add(variable_length, n)
         where (topology%arcs%representative == n .and. topology%arcs%kind /= arc_absent)
            topology%length_variable = size(topology%variables)
         end where
      end subroutine add_length

      subroutine add_angle(n)
         integer, intent(in) :: n
         integer :: i

         call add(variable_gama, n)
         do i = 1, size(topology%arcs)
            if (topology%arcs(i)%kind == arc_determined) then
               if (angle_owner(i) == n) topology%angle_variable(i) = size(topology%variables)
            end if
         end do
      end subroutine add_angle
   end subroutine find_variables

   !> Lengths that must be there, bounds that must be given.
   subroutine check_dimensions(set, topology, dimensions, findings)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(in) :: topology
      type(dimensions_t), intent(in) :: dimensions
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, n, guide, marble

      do loop = 1, set%nloop
         do a = 1, topology%loopl(loop)
            n = topology%seq(loop, a)
            guide = guide_of_dyad(topology, loop)
            select case (topology%arcs(n)%kind)
            case (arc_link)
               if (dimensions%arcl(n) == 0.0_wp .and. a /= guide) then
                  call complain(set, 'ARCL', loop, a, 'is an undetermined link and needs a positive length', findings)
               end if
            case (arc_slide, arc_actuator)
               if (dimensions%arcl(n) /= 0.0_wp) then
                  call arc_warning(set, 'ARCL', loop, a, 'slides: the length given is not used', findings)
               end if
            end select
         end do
      end do
      marble = size(topology%variables)
      if (marble == 0) return
      if (.not. set%desired) then
         call findings%error('a search needs desired values (DESX and DESY, or DESANG)', line=set%origins%line('METHOD', ''), &
                             group='METHOD')
      end if
      if (set%limval == 1 .or. set%var == 0.0_wp) then
         if (min(set%low_given, set%high_given) < marble) then
            if (set%low_given < marble) call short('OPLOW', set%low_given)
            if (set%high_given < marble) call short('OPHIGH', set%high_given)
            return
         end if
         if (set%low_given > marble) call long('OPLOW', set%low_given)
         if (set%high_given > marble) call long('OPHIGH', set%high_given)
         do n = 1, marble
            associate (variable => topology%variables(n))
               if (set%oplow(n) > set%ophigh(n)) then
                  call of_variable('OPLOW', n, 'the lower limit '//limit(set%oplow(n))//' of the '// &
                                   lower_case(name_of(variable))//' is above its upper limit '//limit(set%ophigh(n)))
               else if (variable%kind == variable_length .and. set%ophigh(n) <= 0.0_wp) then
                  call of_variable('OPHIGH', n, 'a length needs an upper limit above zero; found '//limit(set%ophigh(n))// &
                                   ' for the '//lower_case(name_of(variable)))
               end if
            end associate
         end do
      end if
      if (set%nguess > marble + 1) then
         call findings%error('a simplex of '//to_text(marble)//' variables has '//to_text(marble + 1)//' vertices; found '// &
                             to_text(set%nguess), line=set%origins%line('METHOD', 'NGUESS', 1), group='METHOD', item='NGUESS')
      end if

   contains

      subroutine of_variable(item, which, text)
         character(*), intent(in) :: item, text
         integer, intent(in) :: which

         call findings%error(text, line=set%origins%line('LIMITS', item, which), group='LIMITS', item=item)
      end subroutine of_variable

      pure function limit(value) result(text)
         real(wp), intent(in) :: value
         character(:), allocatable :: text

         text = trim(adjustl(general(value, 'E')))
      end function limit

      subroutine short(item, got)
         character(*), intent(in) :: item
         integer, intent(in) :: got
         character(:), allocatable :: names
         integer :: i

         names = lower_case(name_of(topology%variables(1)))
         do i = 2, min(marble, most_named)
            names = names//', '//lower_case(name_of(topology%variables(i)))
         end do
         if (marble > most_named) names = names//' and so on'
         call of_variable(item, 1, 'OPLOW and OPHIGH must give a value for each of the '//to_text(marble)//' variables; found '// &
                          to_text(got)//'. The variables are '//names)
      end subroutine short

      subroutine long(item, got)
         character(*), intent(in) :: item
         integer, intent(in) :: got

         call findings%warning(to_text(got)//' limits are given, but there are only '//to_text(marble)// &
                               ' variables; the others are not used', line=set%origins%line('LIMITS', item, marble + 1), &
                               group='LIMITS', item=item)
      end subroutine long
   end subroutine check_dimensions

   !> A position given twice counts twice, and has two desired values.
   subroutine find_repeated(set, findings)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      real(wp), allocatable :: sorted(:)
      integer :: i, first, second

      if (set%ikin /= 0 .or. set%ifree /= 0 .or. set%ndes < 2) return
      if (all(set%delt(2:) > set%delt(:set%ndes - 1)) .or. all(set%delt(2:) < set%delt(:set%ndes - 1))) return
      sorted = set%delt
      call sort(sorted)
      do i = 2, set%ndes
         if (sorted(i) == sorted(i - 1)) exit
      end do
      if (i > set%ndes) return
      first = findloc(set%delt, sorted(i), dim=1)
      second = first + findloc(set%delt(first + 1:), sorted(i), dim=1)
      call findings%warning('positions '//to_text(first)//' and '//to_text(second)//' have the same input '// &
                            trim(adjustl(general(sorted(i), 'E'))), line=set%origins%line('METHOD', 'DELT', second), &
                            group='METHOD', item='DELT')
   end subroutine find_repeated

   !> Put numbers in rising order (heap sort).
   subroutine sort(values)
      real(wp), intent(inout) :: values(:)
      integer :: first, last
      real(wp) :: largest

      do first = size(values)/2, 1, -1
         call sift(first, size(values))
      end do
      do last = size(values), 2, -1
         largest = values(1)
         values(1) = values(last)
         values(last) = largest
         call sift(1, last - 1)
      end do

   contains

      subroutine sift(from, to)
         integer, intent(in) :: from, to
         integer :: node, child
         real(wp) :: value

         node = from
         value = values(node)
         do while (2*node <= to)
            child = 2*node
            if (child < to) then
               if (values(child + 1) > values(child)) child = child + 1
            end if
            if (values(child) <= value) exit
            values(node) = values(child)
            node = child
         end do
         values(node) = value
      end subroutine sift
   end subroutine sort

   ! ---- messages ----------------------------------------------------------------------------------------------------

   subroutine complain(set, item, loop, a, text, findings)
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: item, text
      integer, intent(in) :: loop, a
      type(diagnostics_t), intent(inout) :: findings
      type(origin_t) :: origin

      if (.not. findings%told_enough(level_error, 'LINKS', item)) &
         origin = set%origins%of('LINKS', item, (loop - 1)*set%maxarc + max(a, 1))
      call findings%error(subject(loop, a)//text, line=origin%line, group='LINKS', item=item)
   end subroutine complain

   subroutine arc_warning(set, item, loop, a, text, findings)
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: item, text
      integer, intent(in) :: loop, a
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: group
      type(origin_t) :: origin

      group = 'LINKS'
      if (item == 'IVA' .or. item == 'IVG') group = 'METHOD'
      if (.not. findings%told_enough(level_warning, group, item)) &
         origin = set%origins%of(group, item, (loop - 1)*set%maxarc + a)
      call findings%warning(subject(loop, a)//text, line=origin%line, group=group, item=item)
   end subroutine arc_warning

   pure function subject(loop, a) result(text)
      integer, intent(in) :: loop, a
      character(:), allocatable :: text

      if (a == 0) then
         text = 'loop '//to_text(loop)//' '
      else
         text = 'arc '//to_text(a)//' of loop '//to_text(loop)//' '
      end if
   end function subject

   pure function place(topology, n) result(text)
      type(topology_t), intent(in) :: topology
      integer, intent(in) :: n
      character(:), allocatable :: text
      integer :: loop

      loop = (n - 1)/topology%maxarc + 1
      text = to_text(n - (loop - 1)*topology%maxarc)//' of loop '//to_text(loop)
   end function place
end module psalm_setup
