!> The group RATES: speed and acceleration of the input, in the units named.
module psalm_rates_group
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp, full_turn, radians_per_degree
   use psalm_rule, only: rule_t, a_number, a_word
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   implicit none (type, external)
   private
   public :: rate_items
   public :: rates_group_t, read_rates_group

   !> Speed and acceleration of the input; as they are by default where the program does not read the group.
   type :: rates_group_t
      real(wp) :: speed = 1.0_wp           !! of the input: rad/s, or length/s
      real(wp) :: accel = 0.0_wp           !! of the input: rad/s**2, or length/s**2
      logical :: given = .false.
   end type rates_group_t

   real(wp), parameter :: slowest = 0.1_wp**min(100, range(1.0_wp) - 25)

   !> The items of the group.
   type(rule_t), parameter :: rate_items(*) = [ &
      rule_t('SPEED', a_number, '', '', '1', '[-1e30,1e30]', &
             'speed of the input, in UNITS', &
             'is implausibly large (limit 1e30)'), &
      rule_t('ACCEL', a_number, '', '', '0', '[-1e30,1e30]', &
             'its acceleration (units of SPEED per second); the speed is the same at every position', &
             'is implausibly large (limit 1e30)'), &
      rule_t('UNITS', a_word, '', '', 'RAD/S, of a slide LENGTH/S', 'RAD/S DEG/S REV/S REV/MIN RPM LENGTH/S', &
             'units of SPEED and, per second, of ACCEL; a sliding input has ''LENGTH/S''')]

contains

   !> Read the group. Errors: units of the other kind of input, implausible values.
   subroutine read_rates_group(group, sliding, rates, findings)
      type(group_t), intent(inout) :: group
      logical, intent(in) :: sliding          !! the input slides
      type(rates_group_t), intent(inout) :: rates
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: units
      real(wp) :: unit

      rates%given = group%line > 0
      call group%follow(rate_items)
      units = trim(merge('LENGTH/S', 'RAD/S   ', sliding))
      call take(group, 'SPEED', rates%speed, findings)
      call take(group, 'ACCEL', rates%accel, findings)
      call group%get_word('UNITS', units, findings)
      unit = 1.0_wp
      select case (units)
      case ('RAD/S', 'LENGTH/S')
         continue
      case ('DEG/S')
         unit = radians_per_degree
      case ('REV/S')
         unit = full_turn*radians_per_degree
      case ('REV/MIN', 'RPM')
         unit = full_turn*radians_per_degree/60.0_wp
      case default
         call out_of(group, 'UNITS', "one of 'RAD/S', 'DEG/S', 'REV/S', 'REV/MIN', 'LENGTH/S' is expected; found '"//units//"'", &
                     findings)
      end select
      if (sliding .neqv. units == 'LENGTH/S') then
         call out_of(group, 'UNITS', "a sliding input needs 'LENGTH/S', a turning input an angular unit; found '"// &
                     units//"'", findings)
      end if
      if (abs(rates%speed) > 0.0_wp .and. abs(rates%speed) < slowest) call out_of(group, 'SPEED', 'is so small that its square '// &
                                                                              'is lost (limit 1e-100, or 0)', findings)
      rates%speed = rates%speed*unit
      rates%accel = rates%accel*unit
   end subroutine read_rates_group
end module psalm_rates_group
