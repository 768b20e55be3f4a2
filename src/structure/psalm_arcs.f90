!> The arcs of the loop arrays: what ILINK and ILOOP say of each, and whether it can be so.
!>
!> Arc numbers run from 1 in a loop. Source: Oldham (1977), chapter 4 and appendix B2.
module psalm_arcs
   use psalm_data_set, only: data_set_t
   use psalm_loop_messages, only: complain
   use psalm_mechanism, only: mechanism_t, actuator_t, arc_crank, arc_actuator, arc_determined, arc_link, arc_slide
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: classify_arcs

contains

   !> Tell determined, undetermined, absent arcs and the input apart, and check every reference.
   subroutine classify_arcs(set, mechanism, valid, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      logical, intent(out) :: valid  !! every loop has its arcs in order, so that dyads can be looked for
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, n

      call lay_out(set, mechanism)
      valid = .true.
      do loop = 1, set%links%nloop
         n = mechanism%loops(loop)%arcs
         do a = 1, n
            if (set%links%ilink(a, loop) == 0) then
               call complain(set, 'ILINK', loop, a, 'is 0 (no arc), but arcs follow in this loop', findings)
               valid = .false.
            end if
         end do
         do a = n + 1, set%links%maxarc
            if (set%links%iloop(a, loop) /= 0) then
               call complain(set, 'ILOOP', loop, a, 'must be 0, because ILINK says there is no such arc', findings)
            end if
         end do
         if (n < 3) then
            call complain(set, 'ILINK', loop, 0, 'has fewer than three arcs', findings)
            valid = .false.
         end if
      end do
      if (.not. valid) return
      call find_misplaced_frame(set, mechanism, valid, findings)
      if (.not. valid) return
      do loop = 1, set%links%nloop
         do a = 1, mechanism%loops(loop)%arcs
            call classify(set, mechanism, loop, a, findings)
         end do
         call check_frame_end(set, mechanism, loop, findings)
      end do
      mechanism%sliding_input = mechanism%arcs(1)%kind == arc_actuator
      mechanism%actuators = [actuator_t(joint=1, arc=1, slides=mechanism%sliding_input)]
   end subroutine classify_arcs

   !> Number the arcs, loop after loop: those that are there, without the rest of each row of the arrays.
   pure subroutine lay_out(set, mechanism)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      integer :: loop, a, next

      mechanism%nloop = set%links%nloop
      allocate (mechanism%loops(set%links%nloop), mechanism%groups(set%links%nloop))
      next = 1
      do loop = 1, set%links%nloop
         mechanism%loops(loop)%first = next
         mechanism%loops(loop)%arcs = findloc(set%links%ilink(:, loop) /= 0, .true., dim=1, back=.true.)
         next = next + mechanism%loops(loop)%arcs
      end do
      allocate (mechanism%arcs(next - 1))
      do loop = 1, set%links%nloop
         do a = 1, mechanism%loops(loop)%arcs
            mechanism%arcs(mechanism%seq(loop, a))%loop = loop
            mechanism%arcs(mechanism%seq(loop, a))%place = a
         end do
      end do
   end subroutine lay_out

   !> A frame arc that is not the last of loop 1: everything else that looks wrong then follows from it.
   subroutine find_misplaced_frame(set, mechanism, valid, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      logical, intent(inout) :: valid
      type(diagnostics_t), intent(inout) :: findings
      integer :: a, n

      n = mechanism%loops(1)%arcs
      if (set%links%iloop(n, 1) == 1) return
      do a = 2, n - 1
         if (abs(set%links%ilink(a, 1)) /= a .or. set%links%iloop(a, 1) /= 1) cycle
         valid = .false.
         call complain(set, 'ILINK', 1, a, 'is measured from the machine''s x axis, as the frame arc is: the frame arc must '// &
                       'come last in its loop, as arc '//to_text(n), findings)
         return
      end do
   end subroutine find_misplaced_frame

   subroutine classify(set, mechanism, loop, a, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      integer, intent(in) :: loop, a
      type(diagnostics_t), intent(inout) :: findings
      integer :: link, other, n

      n = mechanism%loops(loop)%arcs
      link = set%links%ilink(a, loop)
      other = set%links%iloop(a, loop)
      associate (arc => mechanism%arcs(mechanism%seq(loop, a)))
         if (loop == 1 .and. a == 1) then
            if (abs(link) /= 1) call complain(set, 'ILINK', 1, 1, 'must be 1 (the input link)', findings)
            if (other == 1) then
               arc%kind = arc_crank
               if (link /= 1) call complain(set, 'ILINK', 1, 1, 'must be +1 for a turning input link', findings)
            else if (other < 0 .and. -other <= n .and. -other > 1) then
               arc%kind = arc_actuator
               arc%reference = mechanism%seq(1, -other)
               arc%turn = sign(1, link)
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
               arc%reference = mechanism%seq(loop, -other)
               arc%turn = slide_turn(sign(1, link), a, -other)
            end if
         else
            arc%kind = arc_determined
            arc%same = link > 0
            call check_reference(set, mechanism, loop, a, findings)
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

   subroutine check_reference(set, mechanism, loop, a, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      integer, intent(in) :: loop, a
      type(diagnostics_t), intent(inout) :: findings
      integer :: named, in_loop

      named = abs(set%links%ilink(a, loop))
      in_loop = set%links%iloop(a, loop)
      if (in_loop > loop) then
         call complain(set, 'ILOOP', loop, a, 'refers to loop '//to_text(in_loop)//', which is not yet determined', findings)
         return
      end if
      if (named > mechanism%loops(in_loop)%arcs) then
         call complain(set, 'ILINK', loop, a, 'refers to arc '//to_text(named)//' of loop '//to_text(in_loop)// &
                       ', which does not exist', findings)
         return
      end if
      associate (arc => mechanism%arcs(mechanism%seq(loop, a)))
         if (loop == 1 .and. a == mechanism%loops(1)%arcs .and. named == a) then
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
            if (loop == 1 .and. named == mechanism%loops(1)%arcs) then
               arc%frame = .true.
            else if (named > a .or. set%links%iloop(named, loop) <= 0) then
               call complain(set, 'ILINK', loop, a, 'refers to arc '//to_text(named)//' of its own loop, which is not yet '// &
                             'determined', findings)
               return
            end if
            if (.not. is_guide(set, loop, a, mechanism%loops(loop)%arcs) .and. &
                .not. is_guide(set, loop, named, mechanism%loops(loop)%arcs)) then
               call complain(set, 'ILINK', loop, a, 'is common with arc '//to_text(named)//' of the same loop; two arcs of '// &
                             'one link make one arc, unless one of them guides a slide', findings)
            end if
         end if
         arc%reference = mechanism%seq(in_loop, named)
         if (mechanism%arcs(arc%reference)%frame) arc%frame = .true.
      end associate
   end subroutine check_reference

   !> True if the arc guides a slide of its loop.
   pure logical function is_guide(set, loop, a, n)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: loop, a, n

      is_guide = any(set%links%iloop(:n, loop) == -a)
   end function is_guide

   !> The last arc of every loop belongs to the frame.
   subroutine check_frame_end(set, mechanism, loop, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: missing
      integer :: n

      n = mechanism%loops(loop)%arcs
      missing = ''
      if (set%links%iloop(n, loop) <= 0) missing = '; the frame arc seems to be missing'
      associate (arc => mechanism%arcs(mechanism%seq(loop, n)))
         ! the frame's own arc hangs on the x axis, not on another arc of the frame
         if (arc%frame .and. (loop > 1 .or. abs(set%links%ilink(n, 1)) == n)) return
         if (loop == 1) then
            call complain(set, 'ILINK', 1, n, 'is the last arc of loop 1, the frame: ILINK='//to_text(n)// &
                          ' and ILOOP=1 are expected, its direction in GAMA'//missing, findings)
         else
            call complain(set, 'ILINK', loop, n, 'is the last arc of its loop and must belong to the frame: refer to arc '// &
                          to_text(mechanism%loops(1)%arcs)//' of loop 1 or to another frame arc'//missing, findings)
         end if
      end associate
   end subroutine check_frame_end
end module psalm_arcs
