!> The group RATES: speed and acceleration of the input, in the units named.
module psalm_rates_group
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp, full_turn, radians_per_degree
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: rates_group_t, read_rates_group

   real(wp), parameter :: fastest = 1.0e30_wp      !! above this SPEED and ACCEL are taken for slips of the pen

   !> Speed and acceleration of the input; as they are by default where the program does not read the group.
   type :: rates_group_t
      real(wp) :: speed = 1.0_wp           !! of the input: rad/s, or length/s
      real(wp) :: accel = 0.0_wp           !! of the input: rad/s**2, or length/s**2
      logical :: given = .false.
   end type rates_group_t

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
      units = trim(merge('LENGTH/S', 'RAD/S   ', sliding))
      call group%get_real('SPEED', rates%speed, findings)
      call group%get_real('ACCEL', rates%accel, findings)
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
      if (abs(rates%speed) > fastest) call out_of(group, 'SPEED', 'is implausibly large (limit 1e30)', findings)
      if (abs(rates%accel) > fastest) call out_of(group, 'ACCEL', 'is implausibly large (limit 1e30)', findings)
      rates%speed = rates%speed*unit
      rates%accel = rates%accel*unit
   end subroutine read_rates_group
end module psalm_rates_group
