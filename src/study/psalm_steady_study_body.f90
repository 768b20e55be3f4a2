!> Which study is made for which of the groups ESTIM, VIBR, FLEX, DRIVEL and HILL.
submodule(psalm_steady_study) psalm_steady_study_body
   use psalm_crank_motion, only: constant_motion
   use psalm_crank_study, only: check_crank, find_crank
   use psalm_drive_group, only: drive_group_t, hill_group_t, drive_of, hill_of
   use psalm_drive_links_study, only: drive_links_fit, find_drive_links
   use psalm_drive_study, only: find_drive, find_hill
   use psalm_estimate_study, only: find_estimate, assess_estimates
   use psalm_flex_group, only: flex_group_t, flex_of
   use psalm_flex_study, only: find_flex
   use psalm_flexible_link, only: flexible_link_t, make_flexible_links, add_flexible_links
   use psalm_force_model, only: make_force_model
   use psalm_kinds, only: wp
   use psalm_link_cycle, only: check_link, add_uniform_link
   use psalm_stop, only: is_to_end
   use psalm_vibration_group, only: estimate_group_t, vibration_group_t, estimates_of, vibration_of
   use psalm_vibration_study, only: find_vibration
   implicit none (type, external)

   !> Groups of a case that ask for studies.
   type :: steady_groups_t
      type(estimate_group_t) :: estimates
      type(vibration_group_t) :: vibration
      type(flex_group_t) :: flex
      type(drive_group_t) :: drive
      type(hill_group_t) :: hill
   end type steady_groups_t

contains

   !> All that a case asks for.
   pure function steady_groups_of(set) result(asked)
      type(data_set_t), intent(in) :: set
      type(steady_groups_t) :: asked

      asked%estimates = estimates_of(set)
      asked%vibration = vibration_of(set)
      asked%flex = flex_of(set)
      asked%drive = drive_of(set)
      asked%hill = hill_of(set)
   end function steady_groups_of

   module procedure check_steady
      type(steady_groups_t) :: asked
      type(force_model_t) :: model
      type(flexible_link_t), allocatable :: links(:)
      integer :: k

      asked = steady_groups_of(set)
      if (present(vibration_alone)) then
         if (vibration_alone) then
            asked%estimates%given = .false.
            asked%estimates%beams = asked%estimates%beams(:0)
            asked%flex%given = .false.
            asked%drive%given = .false.
            asked%hill%given = .false.
         end if
      end if
      if (set%loops() > 0) call make_force_model(set, prepared%mechanism, prepared%given, model, findings)
      if (.not. (asked%vibration%given .or. asked%estimates%given .or. asked%flex%given .or. asked%drive%given .or. &
                 asked%hill%given)) then
         call findings%error('the case asks for nothing: give &ESTIM, &VIBR, &FLEX, &DRIVEL or &HILL', line=set%title_line)
         return
      end if
      if (findings%failed()) return
      if (asked%vibration%given .or. asked%estimates%given .or. asked%flex%given .or. asked%drive%given) then
         if (.not. set%rates%given) then
            call findings%error('the group is missing: ssics needs the SPEED of the input', line=set%title_line, group='RATES')
         else if (.not. abs(set%rates%speed) > 0.0_wp) then
            call set%origins%error(findings, 'RATES', 'SPEED', 'ssics needs a speed other than 0', 1)
         else if (abs(set%rates%accel) > 0.0_wp) then
            call set%origins%error(findings, 'RATES', 'ACCEL', 'a steady state has a constant speed: no ACCEL', 1)
         else
            call check_crank(set, findings)
         end if
      else if (set%gives('CYCLE')) then
         call set%origins%error(findings, 'CYCLE', '', 'there is no crank in &HILL; leave &CYCLE out')
      end if
      if (asked%drive%given .and. asked%drive%ripple > 0.0_wp .and. set%gives('CYCLE')) then
         call set%origins%error(findings, 'CYCLE', '', 'DRIPPL of &DRIVEL has a period of half a turn, the speed of a whole '// &
                                'one; leave one of them out')
      end if
      if (set%loops() == 0) then
         if (asked%vibration%given .or. asked%estimates%given .or. asked%flex%given .or. &
             (asked%drive%given .and. .not. asked%drive%ripple > 0.0_wp)) &
            call findings%error('the group is missing; &VIBR, &ESTIM, &FLEX and &DRIVEL without DRIPPL need a linkage, '// &
                                '&CHAIN or &LINKS', line=set%title_line, group='LINKS')
         return   ! Hill's equation alone
      end if
      if (asked%vibration%given) then
         call check_link(set, prepared%mechanism, prepared%given, model, asked%vibration%beam, 'VIBR', &
                         set%link_item('V'), 1, findings)
      end if
      do k = 1, size(asked%estimates%beams)
         call check_link(set, prepared%mechanism, prepared%given, model, asked%estimates%beams(k), 'ESTIM', set%link_item('E'), k, &
                         findings)
      end do
      if (asked%flex%given) call make_flexible_links(set, prepared%mechanism, prepared%given, model, asked%flex, links, findings)
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
   end procedure check_steady

   module procedure find_steady
      type(steady_groups_t) :: asked
      class(force_model_t), allocatable :: model, with_links   ! large: they would fill a small stack
      type(diagnostics_t) :: unused
      integer :: k

      allocate (model)
      asked = steady_groups_of(set)
      if (set%loops() > 0) call make_force_model(set, prepared%mechanism, prepared%given, model, unused)
      if (set%gives('CYCLE')) then
         call make_model_with_links(set, prepared%mechanism, prepared%given, 0, model, with_links)
         call find_crank(set, problem, with_links, study%crank, stop)
         study%stopped = is_to_end(stop)
         if (study%stopped .or. .not. study%crank%known) return
      else
         study%crank = constant_motion(set%rates%speed)
      end if
      if (asked%estimates%given) then
         allocate (study%estimates(size(asked%estimates%beams)))
         do k = 1, size(study%estimates)
            study%stopped = is_to_end(stop)
            if (study%stopped) then
               deallocate (study%estimates)
               return
            end if
            associate (link => asked%estimates%beams(k)%link)
               call make_model_with_links(set, prepared%mechanism, prepared%given, &
                                          prepared%mechanism%seq(link%loop, link%arc), model, with_links)
            end associate
            call find_estimate(problem, prepared%given, with_links, asked%estimates%beams(k), &
                               asked%estimates%clearance(k), asked%estimates%points, study%crank, study%estimates(k))
         end do
         call assess_estimates(prepared%mechanism, asked%estimates%beams, study%estimates)
      end if
      if (asked%vibration%given) then
         allocate (study%vibration)
         associate (link => asked%vibration%beam%link)
            call make_model_with_links(set, prepared%mechanism, prepared%given, &
                                       prepared%mechanism%seq(link%loop, link%arc), model, with_links)
         end associate
         call find_vibration(set, problem, prepared%given, with_links, study%crank, study%vibration, stop)
         study%stopped = is_to_end(stop)
         if (study%stopped) then
            if (.not. study%vibration%found) deallocate (study%vibration)
            return
         end if
      end if
      if (asked%flex%given) then
         call find_links()
         if (study%stopped) return
      end if
      if (asked%drive%given) then
         allocate (study%drive)
         call make_model_with_links(set, prepared%mechanism, prepared%given, 0, model, with_links)
         call find_drive(set, problem, prepared%given, with_links, study%crank, study%drive, stop)
         study%stopped = is_to_end(stop)
         if (study%stopped) then
            if (.not. study%drive%found) deallocate (study%drive)
            return
         end if
      end if
      if (allocated(study%drive) .and. allocated(study%flexible)) then
         if (drive_links_fit(asked%drive, study%drive, study%flexible)) then
            allocate (study%together)
            call find_drive_links(set, study%drive, study%flexible, study%together)
         end if
      end if
      if (asked%hill%given) then
         study%stopped = is_to_end(stop)
         if (study%stopped) return
         allocate (study%hill)
         call find_hill(set, study%hill)
      end if

   contains

      !> The links of beam elements.
      subroutine find_links()
         type(flexible_link_t), allocatable :: links(:)
         integer :: l

         call make_flexible_links(set, prepared%mechanism, prepared%given, model, asked%flex, links, unused)
         allocate (study%flexible(size(links)))
         do l = 1, size(links)
            call make_model_with_links(set, prepared%mechanism, prepared%given, &
                                       prepared%mechanism%bodies(links(l)%body)%axis, model, with_links)
            call add_flexible_links(links(l:l), 0, with_links)
            call find_flex(set, problem, prepared%given, with_links, links(l), study%crank, study%flexible(l), stop)
            study%stopped = is_to_end(stop)
            if (study%stopped) then
               deallocate (study%flexible)
               return
            end if
         end do
      end subroutine find_links
   end procedure find_steady

   module procedure make_model_with_links
      type(estimate_group_t) :: estimates
      type(vibration_group_t) :: vibration
      type(flex_group_t) :: flex
      type(flexible_link_t), allocatable :: links(:)
      type(diagnostics_t) :: unused
      integer :: beyond, n

      estimates = estimates_of(set)
      vibration = vibration_of(set)
      flex = flex_of(set)
      allocate (all, source=model)
      beyond = 0
      if (arc > 0) beyond = mechanism%arcs(arc)%body
      if (flex%given) then
         call make_flexible_links(set, mechanism, dimensions, model, flex, links, unused)
         call add_flexible_links(links, beyond, all)
      end if
      do n = 1, size(estimates%beams)
         call add_uniform_link(mechanism, dimensions, estimates%beams(n), beyond, all)
      end do
      if (vibration%given) call add_uniform_link(mechanism, dimensions, vibration%beam, beyond, all)
   end procedure make_model_with_links
end submodule psalm_steady_study_body
