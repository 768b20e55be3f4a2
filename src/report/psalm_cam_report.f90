!> Results of calm become texts of the devices, remarks for standard error and the exit status. Nothing is computed here.
module psalm_cam_report
   use psalm_cam_list, only: list_cam, plot_cam, table_cam
   use psalm_cam_shape, only: measure_pressure
   use psalm_cam_study, only: cam_study_t
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_kinds, only: wp
   use psalm_text, only: general, to_text
   implicit none (type, external)
   private
   public :: report_cam

contains

   !> Listing, device 9, table, remarks, exit status.
   subroutine report_cam(set, studies, devices)
      type(data_set_t), intent(in) :: set
      type(cam_study_t), intent(in) :: studies(:)    !! the cam, and its conjugate or the outer wall of its track
      type(devices_t), intent(inout) :: devices
      integer :: k

      call devices%six%add(' '//set%title)
      do k = 1, size(studies)
         call list_cam(studies(k), devices%six)
         if (k == 1) then
            call plot_cam(studies(k), '', devices%nine)
            call devices%new_table(set%title)
            call table_cam(studies(k), devices%tables(size(devices%tables)))
         else
            call plot_cam(studies(k), '_'//to_text(k), devices%nine)
         end if
         call remark_faults(set, studies(k), devices)
      end do
   end subroutine report_cam

   !> What the cam cannot do.
   subroutine remark_faults(set, study, devices)
      type(data_set_t), intent(in) :: set
      type(cam_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices

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
      if (study%lost) call devices%remark(set, 'the follower leaves the cam at this speed')
      if (study%stressed) call devices%remark(set, 'the contact stress exceeds PHERTZ')
      if (study%steep) call devices%remark(set, 'the pressure angle,'//general(study%extremes(measure_pressure)%value)// &
                                           ' degrees, exceeds ALFMAX')
      if (study%sharp) call devices%remark(set, 'the radius of curvature is less than RHOMIN')
      if (study%face_short) call devices%remark(set, 'the face is shorter than the way of the contact')
   end subroutine remark_faults
end module psalm_cam_report
