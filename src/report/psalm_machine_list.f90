!> Motion from torque in the listing.
module psalm_machine_list
   use psalm_columns, only: right_column
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, full_turn
   use psalm_machine, only: cycle_found, cycle_grows, cycle_falls, cycle_stalls, cycle_any_speed
   use psalm_machine_study, only: machine_study_t
   use psalm_motor_group, only: motor_group_t, motor_of
   use psalm_number_format, only: error_words, figures_of, in_sentence
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: list_machine, put_machine, cycle_words

   integer, parameter :: listed = 24         !! speeds of the cycle that are listed

contains

   !> Inertia, steady cycle, run-up and flywheel.
   subroutine list_machine(set, study, text)
      type(data_set_t), intent(in) :: set
      type(machine_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(motor_group_t) :: motor
      character(15) :: angle(0:listed), speed(0:listed)
      character(15), allocatable :: of_turn(:, :)
      logical :: named
      integer :: k, step

      motor = motor_of(set)
      named = set%has_names()
      call text%add()
      call text%add(' MOTION FROM TORQUE: KG M2, N M, RAD/S, SECONDS; ANGLES IN DEGREES FROM THE REFERENCE INPUT')
      if (.not. study%turns) then
         call text%add(' '//cycle_words(named, study))
         return
      end if
      call text%add(' INERTIA AT THE CRANK'//in_sentence(named, study%inertia_least)//' TO'// &
                    in_sentence(named, study%inertia_greatest))
      call text%add(' STEADY CYCLE: '//cycle_words(named, study))
      if (study%cycle%state == cycle_found .or. study%cycle%state == cycle_any_speed) then
         associate (of => study%cycle)
            call text%add(' LEAST SPEED'//in_sentence(named, of%least)//' AT'//in_sentence(named, of%least_at)//', GREATEST'// &
                          in_sentence(named, of%greatest)//' AT'//in_sentence(named, of%greatest_at))
            call text%add(' MEAN SPEED'//in_sentence(named, of%mean)//', TIME OF A TURN'//in_sentence(named, of%period)// &
                          ', FLUCTUATION'//in_sentence(named, 2.0_wp*(of%greatest - of%least)/(of%greatest + of%least)))
            call text%add(' ESTIMATED ERROR OF THE SPEEDS, RELATIVE'//error_words(named, of%error))
            call text%add('          ANGLE          SPEED')
            step = ubound(of%speed, 1)/listed
            angle = figures_of(named, [(full_turn*real(k, wp)/real(listed, wp), k=0, listed)])
            speed = figures_of(named, of%speed(0:step*listed:step))
            do k = 0, listed
               call text%add(angle(k)//speed(k))
            end do
         end associate
      end if
      if (motor%fluctuation > 0.0_wp) then
         if (study%flywheel < 0.0_wp) then
            call text%add(' NO FLYWHEEL GIVES THE FLUCTUATION'//in_sentence(named, motor%fluctuation))
         else
            call text%add(' FLYWHEEL FOR THE FLUCTUATION'//in_sentence(named, motor%fluctuation)//':'// &
                          in_sentence(named, study%flywheel)//' KG M2')
         end if
      end if
      if (motor%turns == 0) return
      call text%add(' RUN-UP FROM THE SPEED'//in_sentence(named, motor%start))
      call text%add('           TURN      TIME AFTER    SPEED AFTER  LEAST SPEED IN  GREATEST IN IT')
      associate (of => study%run)
         allocate (of_turn(size(of%time), 4))
         of_turn(:, 1) = figures_of(named, of%time)
         of_turn(:, 2) = figures_of(named, of%speed)
         of_turn(:, 3) = figures_of(named, of%least)
         of_turn(:, 4) = figures_of(named, of%greatest)
      end associate
      do k = 1, size(of_turn, 1)
         call text%add(right_column(k, 15)//' '//of_turn(k, 1)//of_turn(k, 2)//' '//of_turn(k, 3)//' '//of_turn(k, 4))
      end do
      if (.not. study%run%computed) then
         call text%add(' THE RUN-UP COULD NOT BE COMPUTED; A FLYWHEEL (FLYWHL) OR SMOOTHER TABLES OF TORQUE MAY HELP')
         return
      end if
      if (size(study%run%time) > 0) call text%add(' ESTIMATED ERROR, RELATIVE'//error_words(named, study%run%error))
      if (study%run%stopped_at >= 0.0_wp) call text%add(' IT STOPS AT'//in_sentence(named, study%run%stopped_at))
   end subroutine list_machine

   !> How the steady cycle was found, or why not.
   function cycle_words(named, study) result(words)
      logical, intent(in) :: named               !! joints have names: a sketch
      type(machine_study_t), intent(in) :: study
      character(:), allocatable :: words

      if (.not. study%turns) then
         words = 'THE CRANK DOES NOT TURN FULLY, OR PASSES A DEAD POINT, AT '//to_text(study%failure_at)// &
                 ' DEGREES FROM THE REFERENCE INPUT'
         if (study%massless) words = 'NOTHING HAS INERTIA AT '//to_text(study%failure_at)//' DEGREES FROM THE REFERENCE INPUT'
         return
      end if
      select case (study%cycle%state)
      case (cycle_found)
         words = 'TORQUE AND SPEED ARE IN BALANCE'
      case (cycle_any_speed)
         words = 'NO WORK OVER A TURN AT ANY SPEED; AT THE REFERENCE INPUT THE SPEED OF THE INPUT IS TAKEN'
      case (cycle_grows)
         words = 'THERE IS NONE, THE SPEED GROWS WITH EVERY TURN'
      case (cycle_falls)
         words = 'THERE IS NONE, THE TORQUE DOES NOT OVERCOME THE LOADS'
      case (cycle_stalls)
         words = 'THERE IS NONE, THE MACHINE STOPS AT'//in_sentence(named, study%cycle%stopped_at)//' DEGREES'
      case default
         words = 'COULD NOT BE COMPUTED; A FLYWHEEL (FLYWHL) OR SMOOTHER TABLES OF TORQUE MAY HELP'
      end select
   end function cycle_words

   !> Tables for other programs: machine (one row), machine_cycle, run_up.
   subroutine put_machine(study, tables)
      type(machine_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      logical :: steady
      integer :: k

      steady = study%turns .and. (study%cycle%state == cycle_found .or. study%cycle%state == cycle_any_speed)
      table = table_of('machine', 'one row: the machine with its motor', audience=for_programs)
      call table%add('turns', [study%turns])
      call table%add('inertia_least', [study%inertia_least], 'kg m^2', [study%turns])
      call table%add('inertia_greatest', [study%inertia_greatest], 'kg m^2', [study%turns])
      call table%add('steady', [steady])
      associate (of => study%cycle)
         call table%add('speed_least', [of%least], 'rad/s', [steady])
         call table%add('speed_greatest', [of%greatest], 'rad/s', [steady])
         call table%add('speed_mean', [of%mean], 'rad/s', [steady])
         call table%add('period', [of%period], 's', [steady])
         call table%add('error', [of%error], known=[steady])
      end associate
      call table%add('flywheel', [study%flywheel], 'kg m^2', [study%wants_flywheel .and. study%flywheel >= 0.0_wp])
      call tables%put(table)
      if (steady) then
         table = table_of('machine_cycle', 'a row for each angle of the crank from the reference input', audience=for_programs)
         associate (steps => ubound(study%cycle%speed, 1))
            call table%add('angle', [(full_turn*real(k, wp)/real(steps, wp), k=0, steps)], 'deg')
            call table%add('speed', study%cycle%speed, 'rad/s')
         end associate
         call tables%put(table)
      end if
      if (.not. (study%turns .and. study%runs_up)) return
      table = table_of('run_up', 'a row for each turn', audience=for_programs)
      associate (of => study%run)
         call table%add('turn', [(k, k=1, size(of%time))])
         call table%add('time', of%time, 's')
         call table%add('speed', of%speed, 'rad/s')
         call table%add('speed_least', of%least, 'rad/s')
         call table%add('speed_greatest', of%greatest, 'rad/s')
      end associate
      call tables%put(table)
   end subroutine put_machine
end module psalm_machine_list
