!> Everything that ssics studies in a case: what cannot be studied is found before any work is done. Data in, results out.
module psalm_steady_study
   use psalm_data_set, only: data_set_t
   use psalm_drive_study, only: drive_study_t, hill_study_t, find_drive, find_hill
   use psalm_error, only: problem_t
   use psalm_estimate_study, only: estimate_t, find_estimate
   use psalm_force_model, only: force_model_t, make_force_model
   use psalm_kinds, only: wp
   use psalm_link_cycle, only: check_link
   use psalm_preparation, only: prepared_t
   use psalm_status, only: diagnostics_t
   use psalm_vibration_study, only: vibration_study_t, find_vibration
   implicit none (type, external)
   private
   public :: steady_study_t, check_steady, find_steady

   !> What a case asks for is allocated.
   type :: steady_study_t
      type(estimate_t), allocatable :: estimates(:)
      type(vibration_study_t), allocatable :: vibration
      type(drive_study_t), allocatable :: drive
      type(hill_study_t), allocatable :: hill
   end type steady_study_t

contains

   !> Errors: no speed, groups of forces that do not fit, links that cannot vibrate, nothing asked for.
   subroutine check_steady(set, prepared, findings)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(force_model_t) :: model
      integer :: k

      call make_force_model(set, prepared%mechanism, prepared%given, model, findings)
      if (.not. (set%vibration%given .or. set%estimates%given .or. set%drive%given .or. set%hill%given)) then
         call findings%error('the case asks for nothing: give &ESTIM, &VIBR, &DRIVEL or &HILL', line=set%title_line)
         return
      end if
      if (findings%failed()) return
      if (set%vibration%given .or. set%estimates%given .or. set%drive%given) then
         if (.not. set%rates_given) then
            call findings%error('the group is missing: ssics needs the SPEED of the input', line=set%title_line, group='RATES')
         else if (.not. abs(set%speed) > 0.0_wp) then
            call findings%error('ssics needs a speed other than 0', line=set%origins%line('RATES', 'SPEED', 1), group='RATES', &
                                item='SPEED')
         else if (abs(set%accel) > 0.0_wp) then
            call findings%error('a steady state has a constant speed: no ACCEL', line=set%origins%line('RATES', 'ACCEL', 1), &
                                group='RATES', item='ACCEL')
         end if
      end if
      if (set%vibration%given) then
         call check_link(set, prepared%mechanism, model, set%vibration%beam, 'VIBR', item_of('V'), 1, findings)
      end if
      do k = 1, size(set%estimates%beams)
         call check_link(set, prepared%mechanism, model, set%estimates%beams(k), 'ESTIM', item_of('E'), k, findings)
      end do
      if (set%drive%given .and. prepared%mechanism%sliding_input) then
         call findings%error('a flexible drive needs a crank that turns; the input of this linkage slides', &
                             line=set%origins%line('DRIVEL', ''), group='DRIVEL')
      end if

   contains

      !> The item that names a link: of a sketch by its name.
      pure function item_of(letter) result(item)
         character, intent(in) :: letter
         character(:), allocatable :: item

         item = letter//'LINK'
         if (set%sketch%given) item = letter//'NAME'
      end function item_of
   end subroutine check_steady

   !> Studies of a case that `check_steady` found no fault with.
   subroutine find_steady(set, problem, prepared, study)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem     !! of no meaning without a linkage
      type(prepared_t), intent(in) :: prepared
      type(steady_study_t), intent(out) :: study
      type(force_model_t) :: model
      type(diagnostics_t) :: unused
      integer :: k

      if (set%nloop > 0) call make_force_model(set, prepared%mechanism, prepared%given, model, unused)
      if (set%estimates%given) then
         allocate (study%estimates(size(set%estimates%beams)))
         do k = 1, size(study%estimates)
            call find_estimate(set, problem, prepared%given, model, set%estimates%beams(k), study%estimates(k))
         end do
      end if
      if (set%vibration%given) then
         allocate (study%vibration)
         call find_vibration(set, problem, prepared%given, model, study%vibration)
      end if
      if (set%drive%given) then
         allocate (study%drive)
         call find_drive(set, problem, prepared%given, model, study%drive)
      end if
      if (set%hill%given) then
         allocate (study%hill)
         call find_hill(set, study%hill)
      end if
   end subroutine find_steady
end module psalm_steady_study
