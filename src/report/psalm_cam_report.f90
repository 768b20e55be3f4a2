!> Results of calm become texts of the devices, remarks for standard error and the exit status. Nothing is computed here.
module psalm_cam_report
   use psalm_cam_list, only: list_cam, plot_cam, table_cam
   use psalm_cam_shape, only: measure_pressure
   use psalm_cam_study, only: cam_study_t
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_kinds, only: wp
   use psalm_text, only: general
   implicit none (type, external)
   private
   public :: report_cam

contains

   !> Listing, device 9, table, remarks, exit status.
   subroutine report_cam(set, study, devices)
      type(data_set_t), intent(in) :: set
      type(cam_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices

      call devices%six%add(' '//set%title)
      call list_cam(set, study, devices%six)
      call plot_cam(study, devices%nine)
      call devices%new_table(set%title)
      call table_cam(study, devices%tables(size(devices%tables)))
      if (.not. study%is_violating()) return
      call devices%note_violation()
      if (study%undercut .and. study%shape%flat) call devices%remark(set, 'the profile would be hollow, and a flat face cannot '// &
         'follow a hollow; the least base radius is'//general(study%least_base))
      if (study%undercut .and. .not. study%shape%flat) call devices%remark(set, 'undercut: the pitch curve is sharper than the '// &
                                                                           'roller')
      if (study%roller%depth > 0.0_wp) call devices%remark(set, 'the profile crosses itself at'//general(study%roller%at)// &
         ' degrees: the roller is too large')
      if (study%gouge .or. study%cutter%depth > 0.0_wp) call devices%remark(set, 'the cutter is larger than a hollow of the '// &
                                                                            'profile')
      if (study%steep) call devices%remark(set, 'the pressure angle,'//general(study%extremes(measure_pressure)%value)// &
                                           ' degrees, exceeds ALFMAX')
      if (study%sharp) call devices%remark(set, 'the radius of curvature is less than RHOMIN')
      if (study%face_short) call devices%remark(set, 'the face is shorter than the way of the contact')
   end subroutine report_cam
end module psalm_cam_report
