!> All four-bars that carry a body through five poses.
program show_exact
   use psalm, only: case_t, findings_t, report_t, find_exact, exact_study_t, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(exact_study_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/exact/five_poses.nml', cases, findings)
   if (.not. findings%failed()) call find_exact(cases(1), result, findings, report=report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
end program show_exact
