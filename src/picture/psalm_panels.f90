!> Curves over the sweep of a scene beyond those of its output: outputs of a sketch, rates, bands of tolerance.
!>
!> Page and curves show the same panels. A panel has one scale and a few lines; where a value is not known - the linkage
!> does not close, or is at a dead point - there is a gap.
module psalm_panels
   use psalm_column_names, only: number_unit, output_unit, per_time, rate_unit
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_family_study, only: family_t, find_family
   use psalm_kinds, only: wp, full_turn
   use psalm_markup, only: sentence_case, short_number
   use psalm_mechanism, only: mechanism_t
   use psalm_dimensions, only: dimensions_t
   use psalm_output_kind, only: output_kind_t, motion_angle, motion_distance, motion_point, motion_pose
   use psalm_rate_study, only: rate_study_t, find_rates
   use psalm_row_study, only: solved_row_t
   use psalm_sketch, only: columns_of, drive_turns, output_angle, output_between, output_ratio
   use psalm_sketch_study, only: sketch_study_t
   use psalm_tolerance, only: deviating_t, tolerance_t, find_tolerances
   implicit none (type, external)
   private
   public :: panel_t, tolerance_band_t, add_rate_panels, add_study_panels, add_family_panels, find_band, flat
   public :: with_unit, begin_panel, add_line, group_position, group_rates, group_forces, group_energy, most_outputs

   integer, parameter :: name_length = 96      !! characters of a panel's name
   integer, parameter :: label_length = 32     !! characters of a line's name
   integer, parameter :: most_outputs = 6    !! of a sketch that are shown; CASE.csv has all
   real(wp), parameter :: flat = 1.0e-8_wp   !! a curve that varies by less than this part of its scale is constant
   real(wp), parameter :: absurd = 1.0e4_wp  !! rates above this times their scale are those beside a dead point: left out

   character(*), parameter :: group_position = 'position', group_rates = 'rates', group_forces = 'forces', group_energy = 'energy'

   !> A line of a panel.
   type :: panel_line_t
      character(label_length) :: label = ''
      real(wp), allocatable :: values(:)     !! shape (sweep)
      logical, allocatable :: known(:)       !! shape (sweep)
   end type panel_line_t

   !> Lines on one axis.
   type :: panel_t
      character(name_length) :: name = ''
      character(label_length) :: note = ''     !! speed of the input, for rates
      character(12) :: group = ''            !! one of `group_...`
      real(wp) :: scale = 0.0_wp             !! what is large: changes below `flat` times it are rounding
      type(panel_line_t), allocatable :: lines(:)
   end type panel_t

   !> Deviations of the output over the sweep, within the tolerances of the dimensions.
   type :: tolerance_band_t
      integer :: components = 0
      real(wp), allocatable :: square(:, :)  !! shape (sweep, components): root-sum-square
      real(wp), allocatable :: worst(:, :)   !! the same shape: worst case
      logical, allocatable :: known(:)       !! shape (sweep)
   end type tolerance_band_t

contains

   !> Velocity and acceleration of the output of a linkage of dyads, by time, for the speed of the group RATES (1 without it).
   subroutine add_rate_panels(set, row, dimensions, size_of, panels)
      type(data_set_t), intent(in) :: set
      type(solved_row_t), intent(in) :: row        !! the sweep
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: size_of              !! of the linkage
      type(panel_t), allocatable, intent(inout) :: panels(:)
      class(problem_t), allocatable :: problem     ! large: it would fill a small stack
      type(rate_study_t), allocatable :: rates
      logical, allocatable :: known(:)
      integer :: order, n

      allocate (rates)
      allocate (problem, source=row%problem)
      call find_rates(set, problem, dimensions, rates, every_arc=.false., motion=row%motion)
      known = rates%motion%closed .and. rates%dead == 0
      do order = 1, 2
         select case (problem%motion)
         case (motion_point, motion_pose)
            call begin_panel(head_of(order, 'the output point', .false.), group_rates, size_of*unit(order), panels)
            n = size(panels)
            call add_line('x', rates%by_time(order, 1, :), known, panels(n))
            call add_line('y', rates%by_time(order, 2, :), known, panels(n))
            if (problem%motion == motion_point) cycle
            call begin_panel(head_of(order, 'the pose', .true.), group_rates, unit(order), panels)
            call add_line('', rates%by_time(order, 3, :), known, panels(n + 1))
         case (motion_angle)
            call begin_panel(head_of(order, 'the output', .true.), group_rates, unit(order), panels)
            call add_line('', rates%by_time(order, 1, :), known, panels(size(panels)))
         case (motion_distance)
            call begin_panel(head_of(order, 'the distance', .false.), group_rates, size_of*unit(order), panels)
            call add_line('', rates%by_time(order, 1, :), known, panels(size(panels)))
         case default
            call begin_panel(head_of(order, 'the slide', .false.), group_rates, size_of*unit(order), panels)
            call add_line('', rates%by_time(order, 1, :), known, panels(size(panels)))
         end select
      end do

      do n = 1, size(panels)
         panels(n)%note = note_of(set, problem%mechanism%sliding_input)
      end do

   contains

      pure real(wp) function unit(order)
         integer, intent(in) :: order

         unit = unit_of(set, problem%mechanism%sliding_input, size_of, order)
      end function unit
   end subroutine add_rate_panels

   !> Outputs of a sketch from number `first` on, then velocities and accelerations of all.
   subroutine add_study_panels(set, study, first, size_of, panels)
      type(data_set_t), intent(in) :: set
      class(sketch_study_t), intent(in) :: study   !! over the sweep
      integer, intent(in) :: first                 !! output whose values are not shown yet
      real(wp), intent(in) :: size_of
      type(panel_t), allocatable, intent(inout) :: panels(:)
      logical, allocatable :: known(:)
      real(wp) :: scale
      integer :: k, c, n, order, column
      logical :: sliding

      sliding = set%sketch%drives(1)%kind /= drive_turns
      do order = 0, 2
         known = study%closed
         if (order > 0) known = known .and. .not. study%dead
         column = 0
         do k = 1, min(most_outputs, size(set%sketch%outputs))
            associate (output => set%sketch%outputs(k))
               column = column + columns_of(output)
               if (order == 0 .and. k < first) cycle
               if (order > 0 .and. output%kind == output_ratio) cycle
               if (order == 0) then
                  call begin_panel(with_unit(trim(output%name), &
                                             number_unit(set%sketch%outputs, column - columns_of(output) + 1, per_time(), 0)), &
                                   group_position, &
                                   merge(full_turn, size_of, any(output%kind == [output_angle, output_between])), panels)
                  if (output%kind == output_ratio) panels(size(panels))%scale = 1.0_wp
               else
                  scale = unit_of(set, sliding, size_of, order)
                  if (.not. any(output%kind == [output_angle, output_between])) scale = scale*size_of
                  call begin_panel(head_of(order, trim(output%name), any(output%kind == [output_angle, output_between])), &
                                   group_rates, scale, panels)
                  panels(size(panels))%note = note_of(set, sliding)
               end if
               n = size(panels)
               do c = 1, columns_of(output)
                  associate (name => study%names(column - columns_of(output) + c))
                     call add_line(trim(name(len_trim(output%name) + 2:)), &
                                   study%values(column - columns_of(output) + c, order, :), known, panels(n))
                  end associate
               end do
            end associate
         end do
      end do
   end subroutine add_study_panels

   !> The outputs for several settings of the dimension of the group SWEEP, a line for each.
   subroutine add_family_panels(set, mechanism, dimensions, delt, size_of, panels)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: delt(:)              !! increments of the sweep
      real(wp), intent(in) :: size_of              !! of the linkage
      type(panel_t), allocatable, intent(inout) :: panels(:)
      type(family_t), allocatable :: family
      logical :: found
      integer :: c, k

      allocate (family)
      call find_family(set, mechanism, dimensions, delt, family, found)
      if (.not. found) return
      do c = 1, min(most_outputs, size(family%numbers))
         if (set%has_names()) then
            call begin_panel(with_unit(trim(family%numbers(c))//' by '//family%name_in_sentence(), &
                                       output_unit(family%angle(c))), group_position, &
                             merge(full_turn, size_of, family%angle(c)), panels)
         else
            call begin_panel(with_unit(trim(sentence_case(trim(family%numbers(c))//' by '//family%name)), &
                                       output_unit(family%angle(c))), group_position, &
                             merge(full_turn, size_of, family%angle(c)), panels)
         end if
         do k = 1, size(family%setting)
            call add_line(short_number(family%setting(k), 5), family%actual(:, c, k), family%closed(:, k), panels(size(panels)))
         end do
      end do
   end subroutine add_family_panels

   !> What a rate of order 1 or 2 is measured by: of an angle, or of a length in units of the linkage.
   pure real(wp) function unit_of(set, sliding, size_of, order) result(unit)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: sliding
      real(wp), intent(in) :: size_of
      integer, intent(in) :: order
      real(wp) :: turning

      turning = 1.0_wp
      if (sliding .and. size_of > 0.0_wp) turning = 1.0_wp/size_of
      unit = abs(set%rates%speed)*turning
      if (order == 2) unit = unit**2 + abs(set%rates%accel)*turning
   end function unit_of

   pure function head_of(order, what, angular) result(name)
      integer, intent(in) :: order
      character(*), intent(in) :: what
      logical, intent(in) :: angular
      character(:), allocatable :: name

      name = with_unit(trim(merge('velocity    ', 'acceleration', order == 1))//' of '//what, rate_unit(angular, per_time(), order))
   end function head_of

   !> A name of an axis with its unit.
   pure function with_unit(name, unit) result(words)
      character(*), intent(in) :: name
      character(*), intent(in) :: unit       !! as tables have it; empty: none
      character(:), allocatable :: words

      words = name
      if (unit == 'deg') then
         words = words//', degrees'
      else if (len(unit) > 0) then
         words = words//', '//unit
      end if
   end function with_unit

   !> How fast the input moves.
   pure function note_of(set, sliding) result(note)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: sliding
      character(label_length) :: note

      note = 'input '//short_number(set%rates%speed, 4)//trim(merge(' length/s', ' rad/s   ', sliding))
   end function note_of

   !> Bands of the output where the sweep closes. `found` is false if there are no tolerances or it closes nowhere.
   subroutine find_band(set, mechanism, dimensions, delt, closed, band, found)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: delt(:)              !! increments of the sweep
      logical, intent(in) :: closed(:)
      type(tolerance_band_t), intent(out) :: band
      logical, intent(out) :: found
      type(deviating_t), allocatable :: deviating
      type(tolerance_t), allocatable :: linear
      type(output_kind_t) :: kind
      integer, allocatable :: at(:)
      integer :: i

      found = set%toler%given .and. any(closed)
      if (.not. found) return
      at = pack([(i, i=1, size(delt))], closed)
      allocate (deviating, linear)
      call find_tolerances(set, mechanism, dimensions, deviating, linear, found, delt(at), every_loop=.false.)
      if (found) found = size(linear%tolerance) > 0
      if (.not. found) return
      kind = linear%kind
      band%components = kind%components
      if (set%has_stand_in()) then
         ! of the first output itself
         found = linear%bands%known(1)
         if (.not. found) return
         band%components = min(2, columns_of(set%sketch%outputs(1)))
         linear%square = linear%bands%square(:, :band%components)
         linear%worst = linear%bands%worst(:, :band%components)
      end if
      allocate (band%square(size(delt), band%components), band%worst(size(delt), band%components), source=0.0_wp)
      allocate (band%known(size(delt)), source=.false.)
      band%square(at, :) = linear%square
      band%worst(at, :) = linear%worst
      band%known(at) = .not. linear%dead
   end subroutine find_band

   subroutine begin_panel(name, group, scale, panels)
      character(*), intent(in) :: name, group
      real(wp), intent(in) :: scale
      type(panel_t), allocatable, intent(inout) :: panels(:)
      type(panel_t), allocatable :: more(:)
      integer :: i

      allocate (more(size(panels) + 1))
      do i = 1, size(panels)
         more(i) = panels(i)
      end do
      associate (last => more(size(more)))
         last%name = name
         last%group = group
         last%scale = scale
         allocate (last%lines(0))
      end associate
      call move_alloc(more, panels)
   end subroutine begin_panel

   !> Append a line. Rates that are absurdly large stand beside a dead point; they would flatten all others.
   subroutine add_line(label, values, known, panel)
      character(*), intent(in) :: label
      real(wp), intent(in) :: values(:)
      logical, intent(in) :: known(:)
      type(panel_t), intent(inout) :: panel
      type(panel_line_t), allocatable :: more(:)
      integer :: i

      allocate (more(size(panel%lines) + 1))
      do i = 1, size(panel%lines)
         more(i) = panel%lines(i)
      end do
      associate (last => more(size(more)))
         last%label = label
         last%values = values
         last%known = known .and. abs(values) < huge(1.0_wp)
         if (panel%group == group_rates) last%known = last%known .and. abs(values) <= absurd*max(panel%scale, tiny(1.0_wp))
      end associate
      call move_alloc(more, panel%lines)
   end subroutine add_line
end module psalm_panels
