!> Bending of the coupler of a four-bar that runs fast.
program show_vibration
   use psalm, only: case_t, findings_t, report_t, find_vibration, steady_study_t, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(steady_study_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/rig_coupler.nml', cases, findings)
   if (.not. findings%failed()) call find_vibration(cases(1), result, findings, report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
end program show_vibration
