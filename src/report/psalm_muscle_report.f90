!> Results of muscle become texts of the devices, remarks for standard error and the exit status. Nothing is computed here.
module psalm_muscle_report
   use psalm_balance_group, only: balance_group_t, balance_of
   use psalm_balance_list, only: list_balance, list_of_names
   use psalm_balance_study, only: balance_study_t, outcome_t
   use psalm_balance_table, only: put_balance
   use psalm_data_set, only: data_set_t
   use psalm_data_set_text, only: write_data_set
   use psalm_devices, only: devices_t
   use psalm_error, only: problem_t
   use psalm_muscle_study, only: muscle_study_t
   use psalm_preparation, only: prepared_t
   use psalm_spring_list, only: list_springs, put_springs, write_springs
   use psalm_spring_study, only: spring_study_t, spring_result_t
   use psalm_text, only: to_text
   use psalm_weight_text, only: write_masses
   implicit none (type, external)
   private
   public :: report_muscle

contains

   !> All that a case asks for: listing, device 7, device 9, JSON, remarks, exit status.
   subroutine report_muscle(set, problem, prepared, study, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(prepared_t), intent(in) :: prepared
      type(muscle_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      type(balance_group_t) :: group
      type(outcome_t) :: none
      type(spring_result_t), allocatable :: springs(:)

      group = balance_of(set)
      call devices%six%add(' '//set%title)
      if (allocated(study%balance)) then
         if (study%balance%failure > 0) then
            call devices%six%add(' NO FORCES AT POSITION '//to_text(study%balance%failure)// &
                                   ': THE LINKAGE DOES NOT CLOSE OR IS AT A DEAD POINT')
            call devices%remark(set, 'position '//to_text(study%balance%failure)// &
                                ': the linkage does not close or is at a dead point; kalm reports which')
            call devices%note_violation()
         else
            call remark_balance(set, group, study%balance, devices)
            call list_balance(set, study%balance, devices%six)
            call put_balance(set%masses%metre, study%balance, devices%cases(devices%last_case()))
         end if
      end if
      if (allocated(study%springs)) call report_springs(set, study%springs, devices)
      call write_data_set(set, problem, prepared%given, devices%seven)
      allocate (none%weights(0))
      if (allocated(study%balance)) then
         call write_masses(set, prepared%mechanism, study%balance%chosen_outcome(), devices%seven)
      else if (set%masses%given) then
         call write_masses(set, prepared%mechanism, none, devices%seven)
      end if
      allocate (springs(0))
      if (allocated(study%springs)) then
         if (study%springs%found) springs = study%springs%springs
      end if
      call write_springs(set, springs, devices%seven)
   end subroutine report_muscle

   !> Springs: listing, device 9, JSON, remarks.
   subroutine report_springs(set, study, devices)
      type(data_set_t), intent(in) :: set
      type(spring_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices

      if (study%failure > 0) then
         call devices%six%add(' NO SPRINGS: THE LINKAGE DOES NOT CLOSE, OR IS AT A DEAD POINT, AT POSITION '// &
                              to_text(study%failure))
         call devices%remark(set, 'position '//to_text(study%failure)// &
                             ': the linkage does not close or is at a dead point; kalm reports which')
         call devices%note_violation()
         return
      end if
      call list_springs(set, study, devices%six)
      call put_springs(study, devices%cases(devices%last_case()))
      if (study%found) return
      call devices%remark(set, 'there is no such spring; see the listing')
      call devices%note_violation()
   end subroutine report_springs

   !> What a user must not overlook.
   subroutine remark_balance(set, group, study, devices)
      type(data_set_t), intent(in) :: set
      type(balance_group_t), intent(in) :: group
      type(balance_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: words

      if (.not. study%feasible) then
         words = 'no weights on the links allowed balance the shaking force completely'
         if (size(study%adrift) > 0) words = words//'; connected to the frame by slides only: '//list_of_names(study, study%adrift)
         if (size(study%out_of_reach) > 0) words = words//'; cannot be balanced: '//list_of_names(study, study%out_of_reach)
         call devices%remark(set, words)
         call devices%note_violation()
      else if (study%filtered > 0 .and. size(study%designs) == 0) then
         call devices%remark(set, 'in every design that is balanced completely the joint with clearance loses contact')
         call devices%note_violation()
      else if (study%number > 0 .and. size(study%designs) == 0 .and. .not. study%already) then
         call devices%remark(set, 'complete force balance is possible, but not within the limits of the weights')
         call devices%note_violation()
      end if
      if (group%wants_optimum() .and. .not. allocated(study%optimum)) then
         call devices%remark(set, 'there are no weights within WREACH, WMOST, the limits of centres and MAXF, MAXM, MAXT, '// &
                             'BMAX for the composite')
         call devices%note_violation()
      else if (study%optimum_loses) then
         call devices%remark(set, 'with the weights of the least composite the joint with clearance loses contact, against WCLEAR')
         call devices%note_violation()
      end if
   end subroutine remark_balance
end module psalm_muscle_report
