!> The group CYCLE: a crank whose speed varies over the turn, for the studies of a steady state.
module psalm_cycle_group
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: refuse_unless
   use psalm_rule, only: rule_t, a_number, a_whole
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: cycle_items
   public :: cycle_group_t, cycle_of

   integer, parameter :: fewest = 3               !! speeds that make a harmonic

   type, extends(case_group_t) :: cycle_group_t
      real(wp), allocatable :: speed(:)           !! CYCW, shape (steps): their ratios count; none: &MOTOR has the speed
   contains
      procedure :: read => read_cycle
   end type cycle_group_t

   !> The items of the group.
   type(rule_t), parameter :: cycle_items(*) = [ &
      rule_t('NCYCW', a_whole, '', '', 'as many as CYCW has', '[0,720]', &
             'number of speeds; 0: the speed is that of the steady cycle of &MOTOR'), &
      rule_t('CYCW', a_number, 'NCYCW', '', '', '(0,)', &
             'speeds of the crank at equal steps of the input over a turn, from the reference position; only their '// &
             'ratios count: the mean over time is SPEED of &RATES', &
             'speeds must be above 0')]

contains

   !> The group as the case has it. Errors: fewer than three speeds, a speed that is not positive.
   subroutine read_cycle(self, group, about, findings)
      class(cycle_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings
      integer :: n, last

      associate (unused => about)
      end associate
      self%given = group%line > 0
      call group%follow(cycle_items)
      call take_count(group, 'NCYCW', n, findings)
      allocate (self%speed(n), source=0.0_wp)
      call group%get_reals('CYCW', self%speed, findings, last=last)
      if (n == 0) return
      if (last < n) then
         call out_of(group, 'NCYCW', to_text(n)//' speeds are announced, but only '//to_text(last)//' given', findings)
      else if (n < fewest) then
         call out_of(group, 'CYCW', 'at least '//to_text(fewest)//' speeds say how a turn goes; found '//to_text(n), findings)
      else
         call refuse_unless(self%speed > 0.0_wp, group, 'CYCW', 'speeds must be above 0', findings)
      end if
   end subroutine read_cycle

   !> The group CYCLE of a case; as it is by default where the case does not have it.
   pure function cycle_of(set) result(cycle_group)
      class(data_set_t), intent(in) :: set
      type(cycle_group_t) :: cycle_group
      integer :: k

      k = set%place_of('CYCLE')
      if (k > 0) then
         select type (group => set%sections(k)%group)
         type is (cycle_group_t)
            cycle_group = group
         end select
      end if
      if (.not. allocated(cycle_group%speed)) allocate (cycle_group%speed(0))
   end function cycle_of
end module psalm_cycle_group
