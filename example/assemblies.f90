!> Every way in which the links of a triad can be put together.
program show_assemblies
   use psalm, only: case_t, findings_t, report_t, find_assemblies, assembly_study_t, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(assembly_study_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/triad_six_assemblies.nml', cases, findings)
   if (.not. findings%failed()) call find_assemblies(cases(1), result, findings, report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
end program show_assemblies
