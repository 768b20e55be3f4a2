!> How families of curves are computed. Only this knows the group SWEEP.
submodule(psalm_family_study) psalm_family_study_body
   use psalm_error, only: problem_t, motion_t, new_problem
   use psalm_kinds, only: full_turn
   use psalm_output_kind, only: output_kind_t, output_kind
   use psalm_parameters, only: parameters_t, no_parameters, name_of, variable_outlk, variable_outang, variable_origlk, &
                               variable_origng, variable_crnki
   use psalm_sweep_group, only: sweep_group_t, sweep_of, swept_length, swept_angle, swept_outlk, swept_outang, swept_origlk, &
                                swept_origng
   implicit none (type, external)

contains

   module procedure find_family
      type(sweep_group_t) :: sweep
      type(parameters_t) :: parameters
      type(dimensions_t) :: changed
      class(problem_t), allocatable :: problem         ! large: it would fill a small stack
      type(motion_t) :: motion
      type(output_kind_t) :: kind
      integer :: k, c, n

      sweep = sweep_of(set)
      parameters = no_parameters(mechanism)
      select case (sweep%what)
      case (swept_length)
         n = 0
         if (set%sketch%given) then
            n = arc_between(set, sweep, mechanism)
         else if (sweep%arc <= mechanism%loops(sweep%loop)%arcs) then
            n = mechanism%seq(sweep%loop, sweep%arc)
         end if
         if (n > 0) call parameters%vary_length(mechanism, n)
      case (swept_angle)
         if (sweep%arc <= mechanism%loops(sweep%loop)%arcs) &
            call parameters%vary_angle(mechanism, mechanism%seq(sweep%loop, sweep%arc))
      case (swept_outlk)
         call parameters%vary(variable_outlk)
      case (swept_outang)
         call parameters%vary(variable_outang)
      case (swept_origlk)
         call parameters%vary(variable_origlk)
      case (swept_origng)
         call parameters%vary(variable_origng)
      case default
         call parameters%vary(variable_crnki)
      end select
      found = size(parameters%variables) == 1
      if (.not. found) return
      family%name = name_of(parameters%variables(1))
      if (set%sketch%given) family%name = 'LENGTH '//trim(set%sketch%joint_name(sweep%joints(1)))//' '// &
                                          trim(set%sketch%joint_name(sweep%joints(2)))
      family%setting = settings_of(sweep)
      allocate (problem)
      call new_problem(mechanism, dimensions, parameters, delt, .false., problem)
      kind = output_kind(problem%motion)
      allocate (family%closed(size(delt), size(family%setting)))
      allocate (family%actual(size(delt), kind%components, size(family%setting)))
      family%numbers = [character(number_name) :: ('OUTPUT'//kind%suffix(c), c=1, kind%components)]
      if (set%sketch%given .and. size(set%sketch%outputs) > 0) &
         family%numbers = [character(number_name) :: (trim(set%sketch%outputs(1)%name)//kind%suffix(c), c=1, kind%components)]
      if (allocated(set%stand_in)) &
         family%numbers = [character(number_name) :: ('point_'//set%stand_in//kind%suffix(c), c=1, kind%components)]
      family%angle = [(c == kind%angle, c=1, kind%components)]
      do k = 1, size(family%setting)
         changed = dimensions
         call parameters%apply(family%setting(k:k), changed)
         call problem%analyse(changed, motion)
         family%closed(:, k) = motion%closed
         family%actual(:, :, k) = motion%actual
         if (k == 1) family%input = motion%input
      end do
      call straighten(family)
   end procedure find_family

   !> The arc of the loops that runs between the joints of a sketch; number 0: there is none.
   pure integer function arc_between(set, sweep, mechanism) result(n)
      type(data_set_t), intent(in) :: set
      type(sweep_group_t), intent(in) :: sweep
      type(mechanism_t), intent(in) :: mechanism
      integer :: k

      n = 0
      if (.not. allocated(set%end_names)) return
      associate (names => set%sketch%joint_name(sweep%joints))
         do k = 1, size(mechanism%arcs)
            associate (ends => set%end_names(:, mechanism%arcs(k)%place, mechanism%arcs(k)%loop))
               if (all(ends == names) .or. all(ends == names(2:1:-1))) then
                  n = k
                  return
               end if
            end associate
         end do
      end associate
   end function arc_between

   pure function settings_of(sweep) result(setting)
      type(sweep_group_t), intent(in) :: sweep
      real(wp), allocatable :: setting(:)
      integer :: i

      associate (s => sweep)
         setting = [(s%low + (s%high - s%low)*(real(i, wp)/real(s%settings - 1, wp)), i=0, s%settings - 1)]
      end associate
   end function settings_of

   !> Angles without jumps of a turn, those of all settings nearest to each other.
   pure subroutine straighten(family)
      type(family_t), intent(inout) :: family
      real(wp) :: before
      integer :: c, k, i

      do c = 1, size(family%angle)
         if (.not. family%angle(c)) cycle
         do k = 1, size(family%setting)
            before = family%actual(1, c, 1)
            if (k > 1) before = family%actual(1, c, k - 1)
            do i = 1, size(family%input)
               if (.not. family%closed(i, k)) cycle
               associate (value => family%actual(i, c, k))
                  value = value + full_turn*anint((before - value)/full_turn)
                  before = value
               end associate
            end do
         end do
      end do
   end subroutine straighten
end submodule psalm_family_study_body
