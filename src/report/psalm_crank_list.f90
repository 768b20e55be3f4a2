!> A crank whose speed varies over the turn, in the listing and as a table.
module psalm_crank_list
   use psalm_crank_motion, only: crank_motion_t
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_kinds, only: wp, pi
   use psalm_number_format, only: error_words, in_sentence
   use psalm_tables, only: table_t, tables_t, table_of
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: list_crank, put_crank_speed, remark_crank, no_cycle

   real(wp), parameter :: enough = 1.0e-8_wp     !! what positions may leave open of the speed
   integer, parameter :: steps = 360             !! of a turn in the table
   character(*), parameter :: no_cycle = 'the machine of &MOTOR has no steady cycle; kalm lists how it runs'

contains

   !> Mean, range and errors; nothing of a constant speed.
   subroutine list_crank(named, crank, text)
      logical, intent(in) :: named
      type(crank_motion_t), intent(in) :: crank
      type(text_t), intent(inout) :: text

      if (.not. crank%varies) return
      call text%add()
      call text%add(' THE SPEED OF THE CRANK VARIES OVER THE TURN, AS '// &
                    trim(merge('THE STEADY CYCLE OF &MOTOR', 'CYCW SAYS                 ', crank%by_motor))//': SI UNITS')
      call text%add(' MEAN OVER TIME'//in_sentence(named, crank%speed)//', FROM'//in_sentence(named, crank%least)//' TO'// &
                    in_sentence(named, crank%greatest)//', FLUCTUATION'// &
                    in_sentence(named, 2.0_wp*(crank%greatest - crank%least)/(crank%greatest + crank%least)))
      if (crank%by_motor) call text%add(' ERROR OF THE SPEED OVER THE MEAN'//error_words(named, crank%speed_error)// &
                                        ', OF ITS ACCELERATION OVER THE GREATEST'//error_words(named, crank%acceleration_error))
   end subroutine list_crank

   !> A remark where the positions of a study are too few for the speed of the crank.
   subroutine remark_crank(set, crank, item, points, devices)
      type(data_set_t), intent(in) :: set
      type(crank_motion_t), intent(in) :: crank
      character(*), intent(in) :: item           !! that gives the positions
      integer, intent(in) :: points
      type(devices_t), intent(inout) :: devices

      if (crank%left_open(points) <= enough) return
      call devices%remark(set, to_text(points)//' positions do not show how the speed of the crank varies; give '//item// &
                          ' twice that')
   end subroutine remark_crank

   !> Table crank_speed, of a speed that varies.
   pure subroutine put_crank_speed(crank, tables)
      type(crank_motion_t), intent(in) :: crank
      type(tables_t), intent(inout) :: tables
      type(crank_motion_t) :: turn
      type(table_t) :: table
      integer :: k

      if (.not. crank%varies) return
      turn = crank%at_steps(steps)
      table = table_of('crank_speed', 'a row for each step of time: the crank, its speed and acceleration in the sense of turning')
      call table%add('time', [(2.0_wp*pi*real(k - 1, wp)/(real(steps, wp)*crank%speed), k=1, steps)], 's')
      call table%add('input', turn%input, 'deg')
      call table%add('speed', crank%speed*turn%rate, 'rad/s')
      call table%add('acceleration', crank%speed**2*turn%push, 'rad/s^2')
      call tables%put(table)
   end subroutine put_crank_speed
end module psalm_crank_list
