!> Which kind of four-link draws a path with a corner: pins alone, or one slide.
program show_kinds
   use psalm, only: case_t, findings_t, report_t, find_kinds, kind_study_t, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(kind_study_t) :: result
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   call read_file('data/types/kinds_for_corner.nml', cases, findings)
   if (.not. findings%failed()) call find_kinds(cases(1), result, findings, report=report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', report%listing
   print '(a)', 'the best as a case: '//report%cases(1)%title()
end program show_kinds
