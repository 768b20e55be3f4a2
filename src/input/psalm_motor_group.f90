!> The group MOTOR: the torque that drives a crank, its flywheel, and what is asked of the motion that follows.
module psalm_motor_group
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: refuse_unless
   use psalm_rule, only: rule_t, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: motor_items
   public :: motor_group_t, motor_of

   type, extends(case_group_t) :: motor_group_t
      real(wp) :: torque = 0.0_wp                 !! MTORQ: N m at rest
      real(wp) :: idle = 0.0_wp                   !! MSPEED: rad/s at which the torque has fallen to 0; 0: it is constant
      real(wp), allocatable :: speed(:)           !! MTABW, shape (rows): rad/s, ascending; in place of the line
      real(wp), allocatable :: table(:)           !! MTABT, shape (rows): N m
      integer :: drive = 1                        !! MNAME: the drive that it turns
      real(wp) :: from = 0.0_wp, until = huge(1.0_wp) !! MTON, MTOFF: s, with TIME
      logical :: switched = .false.               !! one of them is given
      real(wp) :: flywheel = 0.0_wp               !! FLYWHL: kg m2 on the crank
      real(wp) :: fluctuation = 0.0_wp            !! FLUCT: wanted, (greatest - least)/mean of both; 0: none
      real(wp) :: start = 0.0_wp                  !! WSTART: rad/s at which the run-up begins
      integer :: turns = 0                        !! NTURN: turns of the run-up
   contains
      procedure :: read => read_motor
   end type motor_group_t

   !> The items of the group.
   type(rule_t), parameter :: motor_items(*) = [ &
      rule_t('MTORQ', a_number, '', 'N m', '0', '', &
             'torque of the motor at rest; loads on the crank are given in &LOADS'), &
      rule_t('MSPEED', a_number, '', 'rad/s', '0', '[0,)', &
             'speed at which it has fallen to nothing in a straight line; 0: it is constant', &
             'must not be negative (0: the torque is constant)'), &
      rule_t('NMTAB', a_whole, '', '', 'as many as MTABW has', '[0,100000]', &
             'in place of the line: number of speeds'), &
      rule_t('MTABW', a_number, 'NMTAB', 'rad/s', '', '', &
             'the speeds, in ascending order'), &
      rule_t('MTABT', a_number, 'NMTAB', 'N m', '', '', &
             'the torques'), &
      rule_t('MNAME', a_text, '1', '', 'the first drive', '', &
             'of a sketch with &TIME: name of the drive that the motor turns, with its flywheel'), &
      rule_t('MTON', a_number, '', 's', '0', '[0,)', &
             'with &TIME: the motor has its torque from this time', &
             'a time is not negative'), &
      rule_t('MTOFF', a_number, '', 's', 'never', '(0,)', &
             'with &TIME: it has none from this time'), &
      rule_t('FLYWHL', a_number, '', 'kg m2', '0', '[0,)', &
             'flywheel on the crank'), &
      rule_t('FLUCT', a_number, '', '', '0', '[0,2)', &
             'the flywheel is wanted with which the steady cycle fluctuates so much: (greatest - least '// &
             'speed)/mean of both', &
             'must lie between 0 and 2: (greatest - least speed)/their mean'), &
      rule_t('WSTART', a_number, '', 'rad/s', '0', '[0,)', &
             'run-up: speed at the reference input; 0: from rest'), &
      rule_t('NTURN', a_whole, '', '', '0', '[0,100000]', &
             'turns of the run-up')]

contains

   !> Read the group. Errors: numbers out of range, speeds of the table that do not ascend.
   subroutine read_motor_group(group, sketch, motor, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(in) :: sketch
      type(motor_group_t), intent(inout) :: motor
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      integer :: rows, last_speed, last_torque, d

      motor%given = group%line > 0
      call group%follow(motor_items)
      call take(group, 'MTORQ', motor%torque, findings)
      call take(group, 'MSPEED', motor%idle, findings)
      call take_count(group, 'NMTAB', rows, findings)
      allocate (motor%speed(rows), motor%table(rows), source=0.0_wp)
      call group%get_reals('MTABW', motor%speed, findings, last=last_speed)
      call group%get_reals('MTABT', motor%table, findings, last=last_torque)
      if (last_speed < rows .or. last_torque < rows) then
         call out_of(group, 'NMTAB', to_text(rows)//' speeds and torques are announced, but only '// &
                     to_text(min(last_speed, last_torque))//' given', findings)
      else if (rows > 1) then
         call refuse_unless([.true., motor%speed(2:) > motor%speed(:rows - 1)], group, 'MTABW', 'speeds must ascend', findings)
      end if
      call group%get_texts('MNAME', names, findings)
      if (size(names) > 0) then
         motor%drive = 0
         if (sketch%given) then
            do d = 1, size(sketch%drives)
               if (sketch%drive_label(d) == trim(adjustl(names(1)))) motor%drive = d
            end do
         end if
         if (size(names) > 1) then
            call out_of(group, 'MNAME', 'there is one motor; found '//to_text(size(names))//' names', findings, 2)
         else if (motor%drive == 0) then
            call out_of(group, 'MNAME', "there is no drive '"//trim(adjustl(names(1)))//"' in &DRIVES", findings, 1)
         end if
         motor%drive = max(1, motor%drive)
      end if
      call take(group, 'MTON', motor%from, findings)
      call take(group, 'MTOFF', motor%until, findings)
      motor%switched = group%given('MTON') .or. group%given('MTOFF')
      if (.not. motor%until > motor%from) call out_of(group, 'MTOFF', 'the motor must be switched off after it is switched '// &
                                                      'on (MTON)', findings)
      call take(group, 'FLYWHL', motor%flywheel, findings)
      call take(group, 'FLUCT', motor%fluctuation, findings)
      call take(group, 'WSTART', motor%start, findings)
      call take(group, 'NTURN', motor%turns, findings)
   end subroutine read_motor_group

   !> The group as the case has it.
   subroutine read_motor(self, group, about, findings)
      class(motor_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_motor_group(group, about%sketch, self, findings)
   end subroutine read_motor

   !> The group MOTOR of a case; as it is by default where the case does not have it.
   pure function motor_of(set) result(motor)
      class(data_set_t), intent(in) :: set
      type(motor_group_t) :: motor
      integer :: k

      k = set%place_of('MOTOR')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (motor_group_t)
         motor = group
      end select
   end function motor_of
end module psalm_motor_group
