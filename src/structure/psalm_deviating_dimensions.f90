!> Which dimensions of a case have a tolerance, as variables, and how large these are.
module psalm_deviating_dimensions
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t, variable_t, no_parameters, variable_crnki, variable_length, variable_gama, &
                               variable_outlk, variable_outang, variable_origlk, variable_origng
   use psalm_sketch, only: output_angle, output_pose
   use psalm_tolerance_group, only: tolerance_group_t
   implicit none (type, external)
   private
   public :: deviating_dimensions, tolerance_of, tolerances_apart

contains

   !> Every dimension with a tolerance as a variable.
   pure function deviating_dimensions(set, toler, mechanism) result(parameters)
      type(data_set_t), intent(in) :: set
      type(tolerance_group_t), intent(in) :: toler
      type(mechanism_t), intent(in) :: mechanism
      type(parameters_t) :: parameters
      logical :: pivot
      integer :: n

      pivot = max(tolerance_of_kind(set, toler, variable_origlk), tolerance_of_kind(set, toler, variable_origng)) > 0.0_wp
      parameters = no_parameters(mechanism)
      do n = 1, size(mechanism%arcs)
         associate (arc => mechanism%arcs(n))
            if (tolerance_of_kind(set, toler, variable_length, arc%loop, arc%place) > 0.0_wp) &
               call parameters%vary_length(mechanism, n)
         end associate
      end do
      if (tolerance_of_kind(set, toler, variable_outlk) > 0.0_wp) call parameters%vary(mechanism, variable_outlk)
      if (pivot) call parameters%vary(mechanism, variable_origlk)
      do n = 1, size(mechanism%arcs)
         associate (arc => mechanism%arcs(n))
            if (tolerance_of_kind(set, toler, variable_gama, arc%loop, arc%place) > 0.0_wp) &
               call parameters%vary_angle(mechanism, n)
         end associate
      end do
      if (tolerance_of_kind(set, toler, variable_outang) > 0.0_wp) call parameters%vary(mechanism, variable_outang)
      if (pivot) call parameters%vary(mechanism, variable_origng)
      if (toler%tolcrk > 0.0_wp) call parameters%vary(mechanism, variable_crnki)
   end function deviating_dimensions

   !> Tolerance of a variable.
   pure real(wp) function tolerance_of(set, toler, variable) result(tolerance)
      type(data_set_t), intent(in) :: set
      type(tolerance_group_t), intent(in) :: toler
      type(variable_t), intent(in) :: variable

      tolerance = tolerance_of_kind(set, toler, variable%kind, variable%loop, variable%arc)
   end function tolerance_of

   !> Tolerances of the distances and angles, in turn, of joints of a sketch that stand off the arcs. The one that the output arc
   !> ends at has those of that arc.
   pure function tolerances_apart(set, toler, joints, listed) result(tolerances)
      type(data_set_t), intent(in) :: set
      type(tolerance_group_t), intent(in) :: toler     !! of the case, or in their place
      integer, intent(in) :: joints                    !! how many
      integer, intent(in) :: listed                    !! which of them the output arc ends at; 0: none
      real(wp) :: tolerances(2*joints)

      tolerances(1::2) = toler%tollen
      tolerances(2::2) = toler%tolang
      if (listed == 0) return
      tolerances(2*listed - 1) = tolerance_of_kind(set, toler, variable_outlk)
      tolerances(2*listed) = tolerance_of_kind(set, toler, variable_outang)
   end function tolerances_apart

   !> Tolerance of a kind of dimension, of arcs that of one arc. Of a sketch one for all lengths and one for all angles.
   pure real(wp) function tolerance_of_kind(set, toler, kind, loop, place) result(tolerance)
      type(data_set_t), intent(in) :: set
      type(tolerance_group_t), intent(in) :: toler     !! of the case, or in their place
      integer, intent(in) :: kind                      !! one of `variable_...`
      integer, intent(in), optional :: loop, place     !! of an arc

      if (allocated(set%traced)) then
         tolerance = of_sketch(merge(1, 2, any(kind == [variable_length, variable_outlk, variable_origlk])))
         return
      end if
      select case (kind)
      case (variable_length)
         tolerance = toler%tolarc(place, loop)
      case (variable_gama)
         tolerance = toler%tolgam(place, loop)
      case (variable_outlk)
         tolerance = toler%tolout
      case (variable_outang)
         tolerance = toler%toloua
      case (variable_origlk)
         tolerance = toler%tolorl
      case (variable_origng)
         tolerance = toler%tolora
      case default
         tolerance = toler%tolcrk
      end select

   contains

      !> Of a length (1) or an angle (2): its own, else that of all.
      pure real(wp) function of_sketch(which)
         integer, intent(in) :: which
         real(wp) :: own
         logical :: is_direction              ! the first output is the angle of a line

         own = -1.0_wp
         of_sketch = merge(toler%tollen, toler%tolang, which == 1)
         select case (kind)
         case (variable_length, variable_gama)
            own = set%traced%arcs(set%traced%number_of(loop, place))%tolerances(which)
         case (variable_outlk, variable_outang)
            own = set%traced%of_output(which)
            ! of a joint of the loops or of a slide there is no line whose length or angle could deviate
            is_direction = .false.
            if (which == 2 .and. size(set%sketch%outputs) > 0) &
               is_direction = any(set%sketch%outputs(1)%kind == [output_angle, output_pose])
            if (set%traced%outlk <= 0.0_wp .and. .not. is_direction) of_sketch = 0.0_wp
         case (variable_origlk, variable_origng)
            of_sketch = 0.0_wp
            if (set%traced%origlk > 0.0_wp) of_sketch = toler%of_pivot(which)
         case default
            of_sketch = toler%tolcrk
         end select
         if (own >= 0.0_wp) of_sketch = own
      end function of_sketch
   end function tolerance_of_kind
end module psalm_deviating_dimensions
