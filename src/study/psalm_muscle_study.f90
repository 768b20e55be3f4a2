!> Everything that muscle finds for a case: what cannot be studied is found before any work is done. Data in, results out.
module psalm_muscle_study
   use psalm_balance_study, only: balance_study_t, assess_balance, find_balance
   use psalm_clearance_group, only: clearance_of
   use psalm_clearance_study, only: check_clearance
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: mass_parameters
   use psalm_kinds, only: wp
   use psalm_preparation, only: prepared_t
   use psalm_spring_study, only: spring_study_t, assess_springs, find_springs
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t, is_to_end
   implicit none (type, external)
   private
   public :: muscle_study_t, check_muscle, find_muscle

   !> What a case asks for is allocated.
   type :: muscle_study_t
      type(balance_study_t), allocatable :: balance
      type(spring_study_t), allocatable :: springs
      logical :: stopped = .false.               !! the host asked for the end: springs are the best so far, weights are not there
   end type muscle_study_t

contains

   !> Errors: nothing asked for, groups that do not fit the linkage. A warning of a group that has no effect.
   subroutine check_muscle(set, prepared, findings)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(diagnostics_t), intent(inout) :: findings

      if (.not. (set%gives('BALANC') .or. set%gives('SPRNGS'))) then
         call findings%error('the case asks for nothing: give &BALANC or &SPRNGS', line=set%title_line)
         return
      end if
      if (set%gives('BALANC') .and. .not. set%masses%given) then
         call findings%error('the group is missing: there are no masses to balance', line=set%title_line, group='MASSES')
      end if
      if (set%gives('BALANC') .and. set%gives('CLEAR')) then
         call check_clearance(set, clearance_of(set), prepared, findings)
      else if (set%gives('CYCLE')) then
         call set%origins%warning(findings, 'CYCLE', '', 'has no effect: weights and springs are found at constant speed; a '// &
                                  'speed that varies is for a joint with clearance, &CLEAR with &BALANC')
      end if
      if (set%gives('BALANC')) call assess_balance(set, prepared%mechanism, prepared%given, findings)
      if (set%gives('SPRNGS')) call assess_springs(set, prepared%mechanism, prepared%given, findings)
   end subroutine check_muscle

   !> Studies of a case that `check_muscle` found no fault with.
   subroutine find_muscle(set, problem, prepared, study, stop)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(prepared_t), intent(in) :: prepared
      type(muscle_study_t), intent(out) :: study
      type(stop_t), intent(in), optional :: stop !! asked now and then
      real(wp), allocatable :: weights(:, :)

      if (set%gives('BALANC')) then
         allocate (study%balance)
         call find_balance(set, problem, prepared%given, study%balance, stop)
         study%stopped = study%balance%stopped
         if (study%stopped) then
            deallocate (study%balance)
            return
         end if
      end if
      if (.not. set%gives('SPRNGS')) return
      allocate (weights(mass_parameters, size(prepared%mechanism%bodies)), source=0.0_wp)
      if (allocated(study%balance)) call study%balance%take_weights(weights)
      allocate (study%springs)
      call find_springs(set, problem, prepared%given, weights, study%springs, stop)
      study%stopped = is_to_end(stop)
   end subroutine find_muscle
end module psalm_muscle_study
