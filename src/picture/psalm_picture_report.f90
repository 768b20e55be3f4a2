!> Remarks and exit status of the cases that are drawn.
module psalm_picture_report
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, most_reported
   use psalm_pictured, only: pictured_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: report_picture

contains

   !> Exit status 1 and remarks where a linkage does not close or exceeds limits.
   subroutine report_picture(set, case, devices)
      type(data_set_t), intent(in) :: set
      type(pictured_t), intent(in) :: case
      type(devices_t), intent(inout) :: devices
      integer :: i

      if (.not. case%scene%valid) return
      associate (scene => case%scene, prescribed => case%scene%prescribed)
         if (size(case%undrawn) > 0 .or. prescribed%violated .or. size(scene%breaches) > 0) call devices%note_violation()
         do i = 1, size(case%undrawn)
            call devices%remark(set, case%undrawn(i)%text, 'all positions')
         end do
         do i = 1, size(scene%breaches)
            call devices%remark(set, scene%breaches(i)%text)
         end do
         if (.not. prescribed%violated) return
         if (.not. all(prescribed%closed)) call devices%remark(set, 'the linkage does not close at '// &
            to_text(count(.not. prescribed%closed))//' of '//to_text(prescribed%n)//' positions')
         do i = 1, min(size(prescribed%words), most_reported)
            call devices%detail(set, prescribed%words(i)%text)
         end do
         if (size(prescribed%words) > most_reported) &
            call devices%detail(set, 'and '//to_text(size(prescribed%words) - most_reported)//' more in the pictures')
      end associate
   end subroutine report_picture
end module psalm_picture_report
