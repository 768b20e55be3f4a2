!> How families of curves are computed. Only this knows the group SWEEP.
submodule(psalm_family_study) psalm_family_study_body
   use psalm_column_names, only: output_name
   use psalm_dimension_change, only: set_dimension
   use psalm_error, only: problem_t, motion_t, new_problem, own_inputs_at, follows_drawing
   use psalm_kinds, only: full_turn
   use psalm_output_kind, only: output_kind_t, output_kind
   use psalm_parameters, only: parameters_t, no_parameters, name_of, variable_outlk, variable_outang, variable_origlk, &
                               variable_origng, variable_crnki, variable_gama
   use psalm_sweep_group, only: sweep_group_t, sweep_of, swept_length, swept_angle, swept_outlk, swept_outang, swept_origlk, &
                                swept_origng
   use psalm_sketch, only: sketch_t, variation_t, vary_angle
   use psalm_sketch_mechanism, only: traced_dimensions
   use psalm_stop, only: is_to_end, tell_host
   use psalm_sketch_study, only: sketch_study_t, study_sketch
   implicit none (type, external)

contains

   module procedure sets_one_of
      type(sweep_group_t) :: sweep
      type(dimensions_t) :: drawn, changed
      character(:), allocatable :: why
      real(wp) :: settings(2)
      integer :: k

      sets_one_of = .false.
      if (.not. set%gives('SWEEP')) return
      sweep = sweep_of(set)
      drawn = traced_dimensions(set%traced)
      ! one of them may be as drawn
      settings = [sweep%low, sweep%high]
      do k = 1, size(settings)
         changed = drawn
         call set_dimension(set%traced, set%sketch, sweep%dimension, settings(k), changed, why)
         if (allocated(why)) return
         sets_one_of = sets_one_of .or. any(which .and. (abs(changed%arcl - drawn%arcl) > 0.0_wp .or. &
                                                         abs(changed%gama - drawn%gama) > 0.0_wp))
      end do
   end procedure sets_one_of

   module procedure find_family
      type(sweep_group_t) :: sweep
      type(parameters_t) :: parameters
      type(dimensions_t) :: changed
      class(problem_t), allocatable :: problem         ! large: it would fill a small stack
      type(motion_t) :: motion
      type(output_kind_t) :: kind
      logical :: by_name                               ! a sketch: all its outputs
      character(:), allocatable :: why
      integer :: k, c

      sweep = sweep_of(set)
      parameters = no_parameters(mechanism)
      if (set%has_names()) then
         changed = dimensions
         call set_dimension(set%traced, set%sketch, sweep%dimension, sweep%low, changed, why)
         found = .not. allocated(why)
         if (.not. found) return
         family%name = named(set%sketch, sweep%dimension)
         family%sets_angle = sweep%dimension%kind == vary_angle
      else
         call vary_by_arc(mechanism, sweep, parameters)
         found = size(parameters%variables) == 1
         if (.not. found) return
         family%name = name_of(parameters%variables(1))
         family%sets_angle = any(parameters%variables(1)%kind == [variable_gama, variable_outang, variable_origng]) .or. &
                             (parameters%variables(1)%kind == variable_crnki .and. .not. mechanism%sliding_input)
      end if
      family%setting = settings_of(sweep)
      allocate (problem)
      call new_problem(mechanism, dimensions, parameters, delt, mechanism%whole, problem, own_inputs_at(set, delt))
      problem%followed = follows_drawing(set, mechanism)
      kind = output_kind(problem%motion)
      allocate (family%closed(size(delt), size(family%setting)))
      allocate (family%beyond(size(delt), size(family%setting)), source=.false.)
      allocate (family%actual(size(delt), kind%components, size(family%setting)))
      family%numbers = [character(number_name) :: ('OUTPUT'//kind%suffix(c), c=1, kind%components)]
      allocate (family%columns(kind%components))
      do c = 1, kind%components
         family%columns(c) = output_name(kind, c)
      end do
      family%angle = [(c == kind%angle, c=1, kind%components)]
      family%slides = mechanism%sliding_input
      by_name = size(set%sketch%outputs) > 0
      do k = 1, size(family%setting)
         family%stopped = is_to_end(stop)
         if (family%stopped) exit
         changed = dimensions
         if (set%has_names()) then
            call set_dimension(set%traced, set%sketch, sweep%dimension, family%setting(k), changed, why)
         else
            call parameters%apply([family%setting(k)], changed)
         end if
         call problem%analyse(changed, motion)
         family%closed(:, k) = motion%closed
         if (allocated(motion%beyond)) family%beyond(:, k) = motion%beyond
         if (k == 1) family%input = motion%input
         if (by_name) then
            call take_outputs(set, problem, changed, motion, k, family)
         else
            family%actual(:, :, k) = motion%actual
         end if
         call tell_host(stop, k, size(family%setting))
      end do
      if (family%stopped) then
         family%setting = family%setting(:k - 1)
         family%closed = family%closed(:, :k - 1)
         family%beyond = family%beyond(:, :k - 1)
         family%actual = family%actual(:, :, :k - 1)
         if (k == 1) return
      end if
      call straighten(family)
   end procedure find_family

   !> All outputs of a sketch for setting k; the first as the listing has it, if it has it.
   subroutine take_outputs(set, problem, dimensions, motion, k, family)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: k
      type(family_t), intent(inout) :: family
      type(sketch_study_t), allocatable :: study       ! large: it would fill a small stack
      integer :: n

      allocate (study)
      call study_sketch(set, problem, dimensions, motion%closed, 1.0_wp, 0.0_wp, study, changed=.true., places_only=.true.)
      if (k == 1) then
         family%numbers = [character(number_name) :: (study%names(n), n=1, size(study%names))]
         family%columns = family%numbers
         family%angle = study%angles
         deallocate (family%actual)
         allocate (family%actual(size(motion%closed), size(study%names), size(family%setting)), source=0.0_wp)
      end if
      ! a ratio to what stands still has no value
      family%closed(:, k) = motion%closed .and. all(study%values(:, 0, :) < huge(1.0_wp), dim=1)
      family%actual(:, :, k) = transpose(study%values(:, 0, :))
      if (.not. set%has_stand_in()) family%actual(:, :size(motion%actual, 2), k) = motion%actual
   end subroutine take_outputs

   !> Vary what SWHAT names of a linkage of loops; nothing if it is no dimension.
   subroutine vary_by_arc(mechanism, sweep, parameters)
      type(mechanism_t), intent(in) :: mechanism
      type(sweep_group_t), intent(in) :: sweep
      type(parameters_t), intent(inout) :: parameters

      select case (sweep%what)
      case (swept_length, swept_angle)
         if (sweep%arc > mechanism%loops(sweep%loop)%arcs) return
         associate (n => mechanism%seq(sweep%loop, sweep%arc))
            if (sweep%what == swept_length) call parameters%vary_length(mechanism, n)
            if (sweep%what == swept_angle) call parameters%vary_angle(mechanism, n)
         end associate
      case (swept_outlk)
         call parameters%vary(mechanism, variable_outlk)
      case (swept_outang)
         call parameters%vary(mechanism, variable_outang)
      case (swept_origlk)
         call parameters%vary(mechanism, variable_origlk)
      case (swept_origng)
         call parameters%vary(mechanism, variable_origng)
      case default
         call parameters%vary(mechanism, variable_crnki)
      end select
   end subroutine vary_by_arc

   !> `LENGTH D E`, `ANGLE C D D E`.
   pure function named(sketch, dimension) result(name)
      type(sketch_t), intent(in) :: sketch
      type(variation_t), intent(in) :: dimension
      character(:), allocatable :: name
      integer :: k

      name = 'LENGTH'
      if (dimension%kind == vary_angle) name = 'ANGLE'
      do k = 1, count(dimension%joints > 0)
         name = name//' '//trim(sketch%joint_name(dimension%joints(k)))
      end do
   end function named

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
