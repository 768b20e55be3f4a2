!> A spring that makes the range of the drive torque of a four-bar least.
program show_springs
   use psalm, only: case_t, findings_t, report_t, find_springs, muscle_study_t, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(muscle_study_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/muscle/haines_spring.nml', cases, findings)
   if (.not. findings%failed()) call find_springs(cases(1), result, findings, report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
end program show_springs
