!> The optimization variables of a case, of loop arrays from IVA, IVG, ILKOUT, INGOUT, IORIG and ICRK.
module psalm_variables
   use psalm_data_set, only: data_set_t
   use psalm_loop_messages, only: arc_warning, place_of
   use psalm_mechanism, only: mechanism_t, arc_determined
   use psalm_parameters, only: parameters_t, no_parameters, variable_crnki, variable_origlk, variable_origng, &
                               variable_outang, variable_outlk, variable_aside, variable_aside_angle
   use psalm_status, only: diagnostics_t
   use psalm_traced_loops, only: traced_link
   implicit none (type, external)
   private
   public :: find_variables

contains

   !> Number the variables: IVA row by row, ILKOUT, IORIG distance, IVG, INGOUT, IORIG angle, ICRK.
   subroutine find_variables(set, mechanism, parameters, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(parameters_t), intent(out) :: parameters
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a

      parameters = no_parameters(mechanism)
      if (allocated(set%traced) .and. set%method%ikin == 0) call take_traced(set, mechanism, parameters)
      if (set%method%ikin /= 0 .or. size(set%method%iva) == 0) return
      do loop = 1, set%links%nloop
         do a = 1, set%links%maxarc
            if (set%method%iva(a, loop) /= 0) call let_length_vary(set, mechanism, loop, a, parameters, findings)
         end do
      end do
      if (set%method%ilkout /= 0) call parameters%vary(mechanism, variable_outlk)
      if (set%method%iorig /= 0) call parameters%vary(mechanism, variable_origlk)
      do loop = 1, set%links%nloop
         do a = 1, set%links%maxarc
            if (set%method%ivg(a, loop) /= 0) call let_angle_vary(set, mechanism, loop, a, parameters, findings)
         end do
      end do
      if (set%method%ingout /= 0) call parameters%vary(mechanism, variable_outang)
      if (set%method%iorig /= 0) call parameters%vary(mechanism, variable_origng)
      if (set%method%icrk /= 0) call parameters%vary(mechanism, variable_crnki)
   end subroutine find_variables

   !> What varies of the loops of a sketch, in the same order.
   subroutine take_traced(set, mechanism, parameters)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(parameters_t), intent(inout) :: parameters
      integer :: n

      associate (traced => set%traced)
         do n = 1, size(traced%arcs)
            if (traced%arcs(n)%length_varies) call parameters%vary_length(mechanism, n)
         end do
         call take_aside(variable_aside)
         if (traced%outlk_varies) call parameters%vary(mechanism, variable_outlk)
         if (traced%pivot_varies) call parameters%vary(mechanism, variable_origlk)
         do n = 1, size(traced%arcs)
            if (.not. traced%arcs(n)%angle_varies) cycle
            if (traced%arcs(n)%kind == traced_link) then
               call parameters%vary_phase(mechanism, n)
            else
               call parameters%vary_angle(mechanism, n)
            end if
         end do
         call take_aside(variable_aside_angle)
         if (traced%outang_varies) call parameters%vary(mechanism, variable_outang)
         if (traced%pivot_varies) call parameters%vary(mechanism, variable_origng)
         if (traced%input_varies) call parameters%vary(mechanism, variable_crnki)
      end associate

   contains

      !> Distances, or angles, of joints off the arcs.
      subroutine take_aside(kind)
         integer, intent(in) :: kind
         integer :: joint

         if (.not. allocated(set%traced%aside_varies)) return
         do joint = 1, size(set%traced%aside_varies, 2)
            if (.not. set%traced%aside_varies(merge(1, 2, kind == variable_aside), joint)) cycle
            associate (place => set%traced%joint_places(joint))
               call parameters%vary_aside(mechanism, kind, joint, set%traced%number_of(place%loop, place%arc), place%from_start, &
                                          trim(set%sketch%joint_name(joint)))
            end associate
         end do
      end subroutine take_aside
   end subroutine take_traced

   subroutine let_length_vary(set, mechanism, loop, a, parameters, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop, a
      type(parameters_t), intent(inout) :: parameters
      type(diagnostics_t), intent(inout) :: findings
      integer :: n, first

      if (a > mechanism%loops(loop)%arcs) then
         call arc_warning(set, 'IVA', loop, a, 'does not exist and cannot vary', findings)
         return
      end if
      n = mechanism%seq(loop, a)
      if (mechanism%slides(n)) then
         call arc_warning(set, 'IVA', loop, a, 'slides: its length is a result and cannot vary', findings)
         return
      end if
      first = mechanism%arcs(n)%representative
      if (parameters%length_variable(first) > 0 .or. first /= n) then
         call arc_warning(set, 'IVA', loop, a, 'is identical with arc '//place_of(mechanism, first)// &
                          '; the two lengths cannot vary independently', findings)
      end if
      call parameters%vary_length(mechanism, n)
   end subroutine let_length_vary

   subroutine let_angle_vary(set, mechanism, loop, a, parameters, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop, a
      type(parameters_t), intent(inout) :: parameters
      type(diagnostics_t), intent(inout) :: findings
      integer :: n, owner

      if (a > mechanism%loops(loop)%arcs) then
         call arc_warning(set, 'IVG', loop, a, 'does not exist and cannot vary', findings)
         return
      end if
      n = mechanism%seq(loop, a)
      owner = mechanism%angle_owner(n)
      if (mechanism%arcs(owner)%kind /= arc_determined) then
         call arc_warning(set, 'IVG', loop, a, 'has no fixed angle: its direction is a result and cannot vary', findings)
         return
      end if
      if (owner /= n) then
         call arc_warning(set, 'IVG', loop, a, 'is identical with arc '//place_of(mechanism, owner)// &
                          '; the two angles cannot vary independently', findings)
      end if
      call parameters%vary_angle(mechanism, n)
   end subroutine let_angle_vary
end module psalm_variables
