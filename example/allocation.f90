!> The cheapest tolerances that keep a slider within its band; then those of a press, proven.
program show_allocation
   use psalm, only: case_t, findings_t, report_t, find_allocation, allocation_t, band_certified, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(allocation_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/cheapest_tolerances.nml', cases, findings)
   if (.not. findings%failed()) call find_allocation(cases(1), result, findings, report=report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
   call read_file('data/certified_tolerances.nml', cases, findings)
   call find_allocation(cases(1), result, findings)
   if (findings%failed()) error stop 1
   print '(i0,a,i0,a,f8.5)', count(result%proof%verdict == band_certified), ' of ', size(result%bands), &
      ' bands are certified, all tolerances times', result%scaled
end program show_allocation
