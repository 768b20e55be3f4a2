!> A joint with clearance: where its pin loses contact.
program show_clearance
   use psalm, only: case_t, findings_t, report_t, find_clearance, clearance_study_t, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(clearance_study_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/bridge/four_bar_haines.nml', cases, findings)
   if (.not. findings%failed()) call find_clearance(cases(1), result, findings, report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
end program show_clearance
