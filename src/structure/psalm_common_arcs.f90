!> Arcs that are the same line of the same link, in either sense of tracing.
module psalm_common_arcs
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_joints, only: joints_t, find_joints
   use psalm_kinds, only: wp, full_turn, half_turn
   use psalm_loop_messages, only: arc_warning, place_of
   use psalm_mechanism, only: mechanism_t, arc_determined
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: find_identical

contains

   !> Arcs that are the same line of the same link, in either sense of tracing.
   subroutine find_identical(set, mechanism, dimensions, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      type(dimensions_t), intent(inout) :: dimensions
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, n, m
      logical :: against, along
      type(joints_t) :: joints

      call find_joints(mechanism, dimensions, joints)
      mechanism%arcs%representative = [(n, n=1, size(mechanism%arcs))]
      do loop = 1, set%links%nloop
         do a = 1, mechanism%loops(loop)%arcs
            n = mechanism%seq(loop, a)
            associate (arc => mechanism%arcs(n))
               if (arc%kind /= arc_determined .or. arc%reference == 0) cycle
               m = arc%reference
               along = modulo(dimensions%gama(n), full_turn) == 0.0_wp
               against = abs(modulo(dimensions%gama(n), full_turn) - half_turn) == 0.0_wp
               if (arc%same) then
                  arc%representative = mechanism%arcs(m)%representative
                  arc%reversed = mechanism%arcs(m)%reversed
                  if (dimensions%gama(n) /= 0.0_wp) call arc_warning(set, 'GAMA', loop, a, 'is not used: ILINK is positive, '// &
                     'the arc has the direction of arc '//place_of(mechanism, m), findings)
                  if (dimensions%arcl(n) /= dimensions%arcl(m) .and. dimensions%arcl(n) /= 0.0_wp) then
                     call arc_warning(set, 'ARCL', loop, a, 'is not used: ILINK is positive, the arc has the length of arc '// &
                                      place_of(mechanism, m), findings)
                  end if
                  dimensions%arcl(n) = dimensions%arcl(m)
                  dimensions%gama(n) = 0.0_wp
               else if (against .and. dimensions%arcl(n) == dimensions%arcl(m) .and. m > 0 .and. &
                        .not. varies_alone(set, loop, a) .and. .not. mechanism%slides(m)) then
                  arc%representative = mechanism%arcs(m)%representative
                  arc%reversed = .not. mechanism%arcs(m)%reversed
                  call arc_warning(set, 'ILINK', loop, a, 'is identical with arc '//place_of(mechanism, m)// &
                                   ' but traced the other way', findings)
               else if (along .and. dimensions%arcl(n) == dimensions%arcl(m) .and. .not. varies_alone(set, loop, a) .and. &
                        .not. mechanism%slides(m) .and. joints%alike(n, m)) then
                  arc%representative = mechanism%arcs(m)%representative
                  arc%reversed = mechanism%arcs(m)%reversed
                  call arc_warning(set, 'ILINK', loop, a, 'is identical with arc '//place_of(mechanism, m)// &
                                   ' and is taken for it, as a positive ILINK would say', findings)
               end if
            end associate
         end do
      end do
      do loop = 1, set%links%nloop
         do a = 1, mechanism%loops(loop)%arcs
            n = mechanism%seq(loop, a)
            if (.not. joints%astray(n)) cycle
            call arc_warning(set, 'ILINK', loop, a, 'belongs to the link of arc '// &
                             place_of(mechanism, mechanism%arcs(n)%reference)// &
                             ', but it begins and ends at no joint of that link', findings)
         end do
      end do
   end subroutine find_identical

   !> True if the user lets this arc's own length or angle vary, so that it is not merely another arc turned round.
   pure logical function varies_alone(set, loop, a)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: loop, a

      varies_alone = .false.
      if (size(set%method%iva) > 0) varies_alone = set%method%ivg(a, loop) /= 0
   end function varies_alone
end module psalm_common_arcs
