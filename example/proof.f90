!> What can be proven of the motion of a geared five-bar between its inputs.
program show_proof
   use psalm, only: case_t, findings_t, report_t, prove, proven_t, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(proven_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/geared_five_bar.nml', cases, findings)
   if (.not. findings%failed()) call prove(cases(1), result, findings, report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
end program show_proof
