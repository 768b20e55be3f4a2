!> Two conjugate cams that swing a follower.
program show_cams
   use psalm, only: case_t, findings_t, report_t, find_cams, cams_t, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(cams_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/calm/conjugate_cams.nml', cases, findings)
   if (.not. findings%failed()) call find_cams(cases(1), result, findings, report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
end program show_cams
