!> What a study of forces has to report, on all devices.
module psalm_force_report
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, most_reported
   use psalm_force_list, only: list_forces, list_joint_forces, list_shares, put_forces, failure_at
   use psalm_force_study, only: force_study_t
   use psalm_link_load_list, only: list_link_loads, put_link_loads
   use psalm_input_text, only: position_words
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: report_forces

contains

   !> Forces: listing, device 8, tables, remarks.
   subroutine report_forces(set, forces, devices)
      type(data_set_t), intent(in) :: set
      type(force_study_t), intent(in) :: forces
      type(devices_t), intent(inout) :: devices
      integer, allocatable :: resting(:)
      integer :: k, reported

      call list_forces(set, forces, devices%six)
      call put_forces(set, forces, devices%cases(devices%last_case()))
      if (set%limits%ktheta /= 0) call list_joint_forces(forces, devices%eight)
      if (set%masses%shares /= 0) call list_shares(forces, devices%eight)
      if (allocated(forces%loads)) then
         call list_link_loads(forces, devices%eight)
         call put_link_loads(forces, devices%cases(devices%last_case()))
      end if
      if (.not. forces%all_known()) call devices%note_violation()
      resting = pack([(k, k=1, size(forces%input))], [(forces%table%at_rest(k) .and. forces%table%known(k), &
                                                       k=1, size(forces%input))])
      if (size(resting) > 0) call devices%remark(set, 'at '//to_text(size(resting))//' positions, first at '// &
                                                 position_words(set, resting(1), forces%input(resting(1)))// &
                                                 ', a joint with friction does not move and has none')
      reported = 0
      do k = 1, size(forces%input)
         if (forces%table%known(k) .or. .not. forces%table%closed(k)) cycle   ! what is open is reported with the rates
         reported = reported + 1
         if (reported <= most_reported) call devices%remark(set, failure_at(forces, k, small=.true.)//' at '// &
                                                    position_words(set, k, forces%input(k)))
      end do
      if (reported > most_reported) call devices%detail(set, 'and '//to_text(reported - most_reported)// &
                                                       ' more positions without forces')
   end subroutine report_forces
end module psalm_force_report
