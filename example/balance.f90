!> Counterweights of a four-bar.
program show_balance
   use psalm, only: case_t, findings_t, report_t, find_balance, muscle_study_t, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(muscle_study_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/muscle/haines_bodies.nml', cases, findings)
   if (.not. findings%failed()) call find_balance(cases(1), result, findings, report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
end program show_balance
