!> Results of ssics become texts of the devices, remarks for standard error and the exit status. Nothing is computed here.
module psalm_steady_report
   use psalm_crank_list, only: list_crank, put_crank_speed, remark_crank, no_cycle
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_drive_group, only: hill_group_t, hill_of, drive_group_t, drive_of
   use psalm_estimate_study, only: verdict_redesign
   use psalm_flex_group, only: flex_group_t, flex_of
   use psalm_flex_list, only: list_flexible, list_together, flexible_name
   use psalm_flex_study, only: flex_study_t
   use psalm_flex_table, only: put_flexible, put_together
   use psalm_coupled_hill, only: coupled_t
   use psalm_hill, only: hill_t
   use psalm_group_words, only: the_group
   use psalm_kinds, only: wp
   use psalm_link_cycle, only: link_cycle_t
   use psalm_steady_study, only: steady_study_t
   use psalm_mechanism, only: mechanism_t
   use psalm_number_format, only: in_sentence, number_words
   use psalm_text, only: lower_case, to_text
   use psalm_vibration_group, only: estimate_group_t, estimates_of, vibration_group_t, vibration_of
   use psalm_vibration_list, only: list_vibration, list_estimates, list_drive, list_hill, stability_words, coupled_words, link_words
   use psalm_vibration_study, only: much_mixed
   use psalm_vibration_table, only: put_vibration, put_estimates, put_drive, put_hill
   implicit none (type, external)
   private
   public :: report_steady

   real(wp), parameter :: enough = 1.0e-8_wp !! resolution of samples that leave nothing open
   real(wp), parameter :: enough_of_slide = 1.0e-4_wp !! where a shoe moves over elements, whose curvature has steps

contains

   !> All that a case asks for: listing, device 9, remarks, exit status.
   subroutine report_steady(set, mechanism, study, devices)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism   !! not used by Hill's equation alone, which has none
      type(steady_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      type(hill_group_t) :: hill
      type(drive_group_t) :: drive
      type(estimate_group_t) :: estimates
      type(vibration_group_t) :: vibration
      type(flex_group_t) :: flex
      integer :: k

      hill = hill_of(set)
      drive = drive_of(set)
      estimates = estimates_of(set)
      vibration = vibration_of(set)
      flex = flex_of(set)
      call devices%six%add(' '//set%title)
      if (.not. study%crank%known) then
         if (study%stopped) return
         call devices%six%add(' NO STEADY STATE: '//no_cycle)
         call devices%remark(set, no_cycle)
         call devices%note_violation()
         return
      end if
      call list_crank(set%has_names(), study%crank, devices%six)
      call put_crank_speed(study%crank, devices%cases(devices%last_case()))
      if (allocated(study%estimates)) then
         do k = 1, size(study%estimates)
            if (stuck(set, mechanism, study%estimates(k)%cycle, devices)) return
            if (study%estimates(k)%verdict /= verdict_redesign) cycle
            call devices%note_violation()
            call devices%remark(set, 'the link '//link_words(set, estimates%beams(k)%link, ' in loop ', 'of arc ')// &
                                ' is to be designed again: '//trim(merge('it buckles                               ', &
                                                                         'it bends by more than 0.025 of its length', &
                                                                         study%estimates(k)%buckles)))
         end do
         call remark_crank(set, study%crank, 'NEPNT', estimates%points, devices)
         call list_estimates(set, study%estimates, devices%six)
         call put_estimates(set, study%estimates, devices%cases(devices%last_case()))
      end if
      if (allocated(study%vibration)) then
         if (stuck(set, mechanism, study%vibration%cycle, devices)) return
         call list_vibration(set, study%vibration, devices%six)
         call put_vibration(study%vibration, devices%cases(devices%last_case()))
         do k = 1, size(study%vibration%modes)
            call remark_stability(set, 'mode '//to_text(k), study%vibration%modes(k)%hill, devices)
            if (study%vibration%modes(k)%least_stiffness >= 0.0_wp) cycle
            call devices%note_violation()
            call devices%remark(set, 'mode '//to_text(k)//': the link '// &
                                link_words(set, vibration%beam%link, ' in loop ', 'of arc ')//' buckles for a part of '// &
                                'the turn, most at '// &
                                number_words(set%has_names(), study%vibration%modes(k)%least_at)//' degrees after the reference')
         end do
         if (study%vibration%mixing > much_mixed) then
            call devices%remark(set, 'loads and springs on the link couple its modes: the deflection of a mode by itself is '// &
                                'rough, that of &ESTIM takes all together')
         end if
         if (study%vibration%resolution > enough) call coarse('NVPNT', vibration%points)
      end if
      if (allocated(study%flexible)) then
         do k = 1, size(study%flexible)
            if (stuck(set, mechanism, study%flexible(k)%cycle%turn, devices)) return
            call remark_flexible(set, study%flexible(k), devices)
         end do
         call list_flexible(set, mechanism, study%flexible, devices%six)
         call put_flexible(set, mechanism, study%flexible, devices%cases(devices%last_case()))
         if (any(study%flexible%resolution > merge(enough_of_slide, enough, study%flexible%link%slide > 0) .or. &
                 study%flexible%out%resolution > enough)) call coarse('NXPNT', flex%points)
      end if
      if (allocated(study%drive)) then
         if (stuck(set, mechanism, study%drive%turn, devices)) return
         call remark_crank(set, study%crank, 'NDPNT', drive%points, devices)
         call list_drive(set, study%drive, devices%six)
         call put_drive(study%drive, devices%cases(devices%last_case()))
         if (study%drive%found) then
            call remark_stability(set, 'the drive', study%drive%hill, devices)
            if (study%drive%loaded .and. study%drive%resolution > enough) call coarse('NDPNT', drive%points)
         else
            call devices%note_violation()
         end if
      end if
      if (allocated(study%together)) then
         call list_together(set, study%flexible, study%together, study%drive%greatest, devices%six)
         call put_together(set, study%flexible, study%together, study%drive%greatest, &
                           devices%cases(devices%last_case()))
         if (study%together%possible) then
            call remark_coupled(set, 'drive and links together', study%together%coupled, devices)
         else
            call devices%remark(set, 'drive and links were not solved together: the inertia at the crank is not positive')
         end if
      end if
      if (allocated(study%hill)) then
         call list_hill(set, study%hill, devices%six)
         call put_hill(study%hill, devices%cases(devices%last_case()))
         if (allocated(study%hill%coupled)) then
            call remark_coupled(set, 'Hill''s equations', study%hill%coupled, devices)
         else
            call remark_stability(set, 'Hill''s equation', study%hill%hill, devices)
         end if
         if (study%hill%resolution > enough) call coarse('NHILL', size(hill%c0))
      end if

   contains

      subroutine coarse(item, points)
         character(*), intent(in) :: item
         integer, intent(in) :: points

         if (any(set%loads%table > 0) .and. item /= 'NHILL') then
            call devices%remark(set, 'the tables of &LOADS have corners, and '//to_text(points)//' positions round them off; '// &
                                'more of them, by '//item//', round them less')
            return
         end if
         call devices%remark(set, to_text(points)//' positions do not show all of the coefficients; give '//item//' twice that')
      end subroutine coarse
   end subroutine report_steady

   !> What is wrong with a link of beam elements.
   subroutine remark_flexible(set, study, devices)
      type(data_set_t), intent(in) :: set
      type(flex_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: name

      name = 'the link '//flexible_name(set, study)
      if (.not. study%solved) then
         call devices%note_violation()
         call devices%remark(set, name//trim(merge(': how the slide holds it could not be found', &
                                                   ': its natural modes could not be found     ', study%not_held)))
         return
      end if
      if (study%least_stiffness < 0.0_wp) then
         call devices%note_violation()
         call devices%remark(set, name//' buckles for a part of the turn, most at '// &
                             number_words(set%has_names(), study%least_at)//' degrees after the reference')
      end if
      call remark_coupled(set, name, study%coupled, devices)
      if (study%leaves > 0.0_wp) then
         call devices%note_violation()
         call devices%remark(set, name//': its slide is beside its segments, by at most '// &
                             number_words(set%has_names(), study%leaves)//' m; draw segments where the shoe moves')
      end if
      if (study%out%left_out) return
      if (.not. study%out%solved) then
         call devices%note_violation()
         call devices%remark(set, name//', out of the plane: its natural modes could not be found')
         return
      end if
      if (study%out%least_stiffness < 0.0_wp) then
         call devices%note_violation()
         call devices%remark(set, name//' buckles out of the plane for a part of the turn, most at '// &
                             number_words(set%has_names(), study%out%least_at)//' degrees after the reference')
      end if
      if (study%out%solved_modes > 0) call remark_coupled(set, name//', out of the plane', study%out%coupled, devices)
   end subroutine remark_flexible

   subroutine remark_coupled(set, what, coupled, devices)
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: what
      type(coupled_t), intent(in) :: coupled
      type(devices_t), intent(inout) :: devices

      if (coupled%stable .or. (coupled%neutral .and. coupled%unique)) return
      call devices%note_violation()
      call devices%remark(set, what//': '//lower_case(coupled_words(coupled)))
   end subroutine remark_coupled

   subroutine remark_stability(set, what, hill, devices)
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: what
      type(hill_t), intent(in) :: hill
      type(devices_t), intent(inout) :: devices

      if (hill%stable .or. (hill%neutral .and. hill%unique)) return
      call devices%note_violation()
      call devices%remark(set, what//': '//lower_case(stability_words(hill)))
   end subroutine remark_stability

   !> True if the crank cannot turn, which is reported.
   logical function stuck(set, mechanism, cycle_of, devices)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(link_cycle_t), intent(in) :: cycle_of
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: words

      stuck = cycle_of%failure > 0
      if (.not. stuck) return
      words = 'the crank cannot make a full turn: the linkage does not close'
      if (cycle_of%closes) words = the_group(mechanism, cycle_of%loop)//' passes a dead point'
      words = words//' at'//in_sentence(set%has_names(), cycle_of%crank%input(cycle_of%failure))//' degrees after the reference'
      call devices%six%add(' NO STEADY STATE: '//words)
      call devices%remark(set, words)
      call devices%note_violation()
   end function stuck
end module psalm_steady_report
