!> Everything that ssics studies in a case: what cannot be studied is found before any work is done. Data in, results out.
module psalm_steady_study
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_drive_group, only: hill_group_t, hill_of, drive_group_t, drive_of
   use psalm_drive_study, only: drive_study_t, hill_study_t, find_drive, find_hill
   use psalm_error, only: problem_t
   use psalm_estimate_study, only: estimate_t, find_estimate, judge_estimates
   use psalm_force_model, only: force_model_t, make_force_model
   use psalm_kinds, only: wp
   use psalm_link_cycle, only: check_link, add_uniform_link
   use psalm_mechanism, only: mechanism_t
   use psalm_preparation, only: prepared_t
   use psalm_status, only: diagnostics_t
   use psalm_vibration_group, only: estimate_group_t, estimates_of, vibration_group_t, vibration_of
   use psalm_vibration_study, only: vibration_study_t, find_vibration
   implicit none (type, external)
   private
   public :: steady_study_t, steady_groups_t, steady_groups_of, check_steady, find_steady, model_with_links

   !> Groups of a case that ask for studies.
   type :: steady_groups_t
      type(estimate_group_t) :: estimates
      type(vibration_group_t) :: vibration
      type(drive_group_t) :: drive
      type(hill_group_t) :: hill
   end type steady_groups_t

   !> What a case asks for is allocated.
   type :: steady_study_t
      type(estimate_t), allocatable :: estimates(:)
      type(vibration_study_t), allocatable :: vibration
      type(drive_study_t), allocatable :: drive
      type(hill_study_t), allocatable :: hill
   end type steady_study_t

contains

   !> All that a case asks for.
   pure function steady_groups_of(set) result(asked)
      type(data_set_t), intent(in) :: set
      type(steady_groups_t) :: asked

      asked%estimates = estimates_of(set)
      asked%vibration = vibration_of(set)
      asked%drive = drive_of(set)
      asked%hill = hill_of(set)
   end function steady_groups_of

   !> Errors: no speed, groups of forces that do not fit, links that cannot vibrate, nothing asked for.
   subroutine check_steady(set, asked, prepared, findings)
      type(data_set_t), intent(in) :: set
      type(steady_groups_t), intent(in) :: asked !! what is to be studied
      type(prepared_t), intent(in) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(force_model_t) :: model
      integer :: k

      call make_force_model(set, prepared%mechanism, prepared%given, model, findings)
      if (.not. (asked%vibration%given .or. asked%estimates%given .or. asked%drive%given .or. asked%hill%given)) then
         call findings%error('the case asks for nothing: give &ESTIM, &VIBR, &DRIVEL or &HILL', line=set%title_line)
         return
      end if
      if (findings%failed()) return
      if (asked%vibration%given .or. asked%estimates%given .or. asked%drive%given) then
         if (.not. set%rates%given) then
            call findings%error('the group is missing: ssics needs the SPEED of the input', line=set%title_line, group='RATES')
         else if (.not. abs(set%rates%speed) > 0.0_wp) then
            call set%origins%error(findings, 'RATES', 'SPEED', 'ssics needs a speed other than 0', 1)
         else if (abs(set%rates%accel) > 0.0_wp) then
            call set%origins%error(findings, 'RATES', 'ACCEL', 'a steady state has a constant speed: no ACCEL', 1)
         end if
      end if
      if (asked%vibration%given) then
         call check_link(set, prepared%mechanism, prepared%given, model, asked%vibration%beam, 'VIBR', item_of('V'), 1, findings)
      end if
      do k = 1, size(asked%estimates%beams)
         call check_link(set, prepared%mechanism, prepared%given, model, asked%estimates%beams(k), 'ESTIM', item_of('E'), k, &
                         findings)
      end do
      if (asked%drive%given .and. prepared%mechanism%sliding_input) then
         call set%origins%error(findings, 'DRIVEL', '', 'a flexible drive needs a crank that turns; the input of this linkage '// &
                                'slides')
      end if
      if (asked%drive%given .and. size(model%friction) > 0) then
         call set%origins%error(findings, 'FRICTN', '', 'the equation of a flexible drive is linear, but friction changes its '// &
                                'sign with the motion of the joint; leave &FRICTN out, or give its losses as a moment in &LOADS')
      end if
      if (asked%drive%given .and. asked%drive%ripple > 0.0_wp) then
         if (size(model%loads) > 0) call refuse_load('LOADS', 'loads')
         if (size(model%springs) > 0) call refuse_load('SPRING', 'springs')
         if (any(abs(model%gravity) > 0.0_wp)) call refuse_load('MASSES', 'gravity')
      end if

   contains

      !> With DRIPPL there is no linkage to act on.
      subroutine refuse_load(group, what)
         character(*), intent(in) :: group, what

         call set%origins%error(findings, group, '', 'DRIPPL of &DRIVEL puts an inertia in place of the linkage: '//what// &
                                ' would act on nothing; leave one of them out')
      end subroutine refuse_load

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
      type(steady_groups_t) :: asked
      type(force_model_t) :: model, with_links
      type(diagnostics_t) :: unused
      integer :: k

      asked = steady_groups_of(set)
      if (set%links%nloop > 0) call make_force_model(set, prepared%mechanism, prepared%given, model, unused)
      if (asked%estimates%given) then
         allocate (study%estimates(size(asked%estimates%beams)))
         do k = 1, size(study%estimates)
            associate (link => asked%estimates%beams(k)%link)
               with_links = model_with_links(set, prepared%mechanism, prepared%given, prepared%mechanism%seq(link%loop, link%arc), &
                                             model)
            end associate
            call find_estimate(set, problem, prepared%given, with_links, asked%estimates%beams(k), study%estimates(k))
         end do
         call judge_estimates(prepared%mechanism, asked%estimates%beams, study%estimates)
      end if
      if (asked%vibration%given) then
         allocate (study%vibration)
         associate (link => asked%vibration%beam%link)
            with_links = model_with_links(set, prepared%mechanism, prepared%given, prepared%mechanism%seq(link%loop, link%arc), &
                                          model)
         end associate
         call find_vibration(set, problem, prepared%given, with_links, study%vibration)
      end if
      if (asked%drive%given) then
         allocate (study%drive)
         with_links = model_with_links(set, prepared%mechanism, prepared%given, 0, model)
         call find_drive(set, problem, prepared%given, with_links, study%drive)
      end if
      if (asked%hill%given) then
         allocate (study%hill)
         call find_hill(set, study%hill)
      end if
   end subroutine find_steady

   !> The force model with the masses of the uniform links of all groups, but for the link of an arc, which is studied.
   pure function model_with_links(set, mechanism, dimensions, arc, model) result(all)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: arc                 !! 0: none
      type(force_model_t), intent(in) :: model
      type(estimate_group_t) :: estimates
      type(vibration_group_t) :: vibration
      type(force_model_t) :: all
      integer :: beyond, n

      estimates = estimates_of(set)
      vibration = vibration_of(set)
      all = model
      beyond = 0
      if (arc > 0) beyond = mechanism%arcs(arc)%body
      do n = 1, size(estimates%beams)
         call add_uniform_link(mechanism, dimensions, estimates%beams(n), beyond, all)
      end do
      if (vibration%given) call add_uniform_link(mechanism, dimensions, vibration%beam, beyond, all)
   end function model_with_links
end module psalm_steady_study
