!> The Assur group of every loop: its two unknown arcs, their kind and their assembly mode.
!>
!> Source: Oldham (1977), chapter 4.
module psalm_loop_groups
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_dyad_kind, only: assur_none, direction_known, form_of, form_t, kind_of_dyad, sign_of_dyad
   use psalm_kinds, only: wp
   use psalm_loop_messages, only: complain
   use psalm_mechanism, only: mechanism_t, arc_actuator, arc_link, arc_slide
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: find_groups, guide_of_dyad

contains

   !> The undetermined pair of every loop, its kind and its assembly mode.
   subroutine find_groups(set, mechanism, dimensions, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, n, found, p, q

      do loop = 1, set%links%nloop
         found = 0
         n = mechanism%loops(loop)%arcs
         do a = 1, n
            select case (mechanism%arcs(mechanism%seq(loop, a))%kind)
            case (arc_link, arc_slide)
               found = found + 1
               if (found == 1) p = a
               if (found == 2) q = a
            end select
         end do
         if (found /= 2) then
            call complain(set, 'ILOOP', loop, 0, 'has '//to_text(found)//' undetermined arcs (ILOOP 0 or negative); '// &
                          'it must have two', findings)
            cycle
         end if
         if (q /= p + 1) then
            call complain(set, 'ILOOP', loop, 0, 'has its undetermined arcs '//to_text(p)//' and '//to_text(q)// &
                          ' apart; they must be adjacent', findings)
            cycle
         end if
         call make_group(set, loop, mechanism%seq(loop, p), mechanism%seq(loop, q), mechanism)
         if (mechanism%groups(loop)%kind == assur_none) then
            call complain(set, 'ILOOP', loop, 0, 'has an undetermined pair that is none of the eight dyads: two slides that '// &
                          'guide each other', findings)
         end if
         call check_closure_entries(set, mechanism, dimensions, loop, p, q, findings)
      end do
      call check_order(set, mechanism, findings)
   end subroutine find_groups

   !> The group of two unknown arcs.
   pure subroutine make_group(set, loop, p, q, mechanism)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: loop, p, q
      type(mechanism_t), intent(inout) :: mechanism

      mechanism%arcs(p)%dyad = 1
      mechanism%arcs(q)%dyad = 2
      associate (group => mechanism%groups(loop), arc_p => mechanism%arcs(p), arc_q => mechanism%arcs(q))
         group%loop = loop
         group%members = [p, q]
         group%kind = kind_of_dyad([arc_p%kind, arc_q%kind] == arc_slide, &
                                   [-set%links%iloop(arc_p%place, loop) == arc_q%place, -set%links%iloop(arc_q%place, loop) == &
                                    arc_p%place])
         group%sign = sign_of_dyad(group%kind, sign(1, set%links%ilink(arc_p%place, loop)), sign(1, set%links%ilink(arc_q%place, &
                                                            loop)), &
                                   arc_p%turn, arc_q%turn)
      end associate
   end subroutine make_group

   !> Types 1, 2, 3: both entries state the same fact and must agree, unless the guide has no length.
   subroutine check_closure_entries(set, mechanism, dimensions, loop, p, q, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: loop, p, q
      type(diagnostics_t), intent(inout) :: findings

      type(form_t) :: form
      integer :: guide

      form = form_of(mechanism%groups(loop)%kind)
      if (any(form%direction == direction_known)) return
      guide = guide_of_dyad(mechanism, loop)
      if (guide > 0) then
         if (dimensions%arcl(mechanism%seq(loop, guide)) <= 0.0_wp) return
      end if
      if (sign(1, set%links%ilink(p, loop)) /= sign(1, set%links%ilink(q, loop))) then
         call complain(set, 'ILINK', loop, 0, 'has undetermined arcs '//to_text(p)//' and '//to_text(q)//' of opposite sign; '// &
                       'for this dyad both are positive when the joint they share lies to the right of the line from the '// &
                       'start of the first to the finish of the second', findings)
      end if
   end subroutine check_closure_entries

   !> Arc of a loop that guides its partner in an RPR dyad; 0: the loop's dyad is another.
   pure integer function guide_of_dyad(mechanism, loop) result(guide)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop
      type(form_t) :: form

      guide = 0
      form = form_of(mechanism%groups(loop)%kind)
      if (count(form%slides) == 1 .and. .not. any(form%direction == direction_known)) &
         guide = mechanism%place(findloc(form%slides, .false., dim=1), loop)
   end function guide_of_dyad

   !> Determined arcs of a loop may not hang on the loop's own unknowns, and guides must be known or be the partner.
   subroutine check_order(set, mechanism, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, guide

      do loop = 1, set%links%nloop
         do a = 1, mechanism%loops(loop)%arcs
            associate (arc => mechanism%arcs(mechanism%seq(loop, a)))
               if (arc%kind == arc_actuator) then
                  guide = mechanism%arcs(arc%reference)%place
                  if (.not. mechanism%arcs(arc%reference)%frame) then
                     call complain(set, 'ILOOP', loop, a, 'names arc '//to_text(guide)//' as the guide of the sliding input, '// &
                                   'but that is not a frame arc', findings)
                  end if
               end if
            end associate
         end do
      end do
   end subroutine check_order
end module psalm_loop_groups
