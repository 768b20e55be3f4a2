!> What a slider-crank does over a turn of its crank, in words.
program show_summary
   use psalm, only: case_t, findings_t, report_t, summarise, summary_t, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(summary_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/dyad4_slider_crank.nml', cases, findings)
   if (.not. findings%failed()) call summarise(cases(1), result, findings, report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
end program show_summary
