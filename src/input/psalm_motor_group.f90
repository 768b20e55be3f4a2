!> The group MOTOR: the torque that drives a crank, its flywheel, and what is asked of the motion that follows.
module psalm_motor_group
   use psalm_group, only: group_t, check_range, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: refuse_unless
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: motor_group_t, read_motor_group

   integer, parameter :: most_rows = 100000, most_turns = 100000 !! above these a number is taken for a slip of the pen

   type :: motor_group_t
      logical :: given = .false.                  !! the group was given
      real(wp) :: torque = 0.0_wp                 !! MTORQ: N m at rest
      real(wp) :: idle = 0.0_wp                   !! MSPEED: rad/s at which the torque has fallen to 0; 0: it is constant
      real(wp), allocatable :: speed(:)           !! MTABW, shape (rows): rad/s, ascending; in place of the line
      real(wp), allocatable :: table(:)           !! MTABT, shape (rows): N m
      real(wp) :: flywheel = 0.0_wp               !! FLYWHL: kg m2 on the crank
      real(wp) :: fluctuation = 0.0_wp            !! FLUCT: wanted, (greatest - least)/mean of both; 0: none
      real(wp) :: start = 0.0_wp                  !! WSTART: rad/s at which the run-up begins
      integer :: turns = 0                        !! NTURN: turns of the run-up
   end type motor_group_t

contains

   !> Read the group. Errors: numbers out of range, speeds of the table that do not ascend.
   subroutine read_motor_group(group, motor, findings)
      type(group_t), intent(inout) :: group
      type(motor_group_t), intent(inout) :: motor
      type(diagnostics_t), intent(inout) :: findings
      integer :: rows, last_speed, last_torque

      motor%given = group%line > 0
      call group%get_real('MTORQ', motor%torque, findings)
      call group%get_real('MSPEED', motor%idle, findings)
      if (motor%idle < 0.0_wp) call out_of(group, 'MSPEED', 'must not be negative (0: the torque is constant)', findings)
      rows = 0
      call group%get_integer('NMTAB', rows, findings)
      call check_range(group, 'NMTAB', rows, 0, most_rows, findings)
      rows = min(max(rows, 0), most_rows)
      allocate (motor%speed(rows), motor%table(rows), source=0.0_wp)
      call group%get_reals('MTABW', motor%speed, findings, last=last_speed)
      call group%get_reals('MTABT', motor%table, findings, last=last_torque)
      if (last_speed < rows .or. last_torque < rows) then
         call out_of(group, 'NMTAB', to_text(rows)//' speeds and torques are announced, but only '// &
                     to_text(min(last_speed, last_torque))//' given', findings)
      else if (rows > 1) then
         call refuse_unless([.true., motor%speed(2:) > motor%speed(:rows - 1)], group, 'MTABW', 'speeds must ascend', findings)
      end if
      call group%get_real('FLYWHL', motor%flywheel, findings)
      if (motor%flywheel < 0.0_wp) call out_of(group, 'FLYWHL', 'must not be negative', findings)
      call group%get_real('FLUCT', motor%fluctuation, findings)
      if (motor%fluctuation < 0.0_wp .or. motor%fluctuation >= 2.0_wp) then
         call out_of(group, 'FLUCT', 'must lie between 0 and 2: (greatest - least speed)/their mean', findings)
      end if
      call group%get_real('WSTART', motor%start, findings)
      if (motor%start < 0.0_wp) call out_of(group, 'WSTART', 'must not be negative', findings)
      call group%get_integer('NTURN', motor%turns, findings)
      call check_range(group, 'NTURN', motor%turns, 0, most_turns, findings)
   end subroutine read_motor_group
end module psalm_motor_group
