!> Five points with prescribed timing (Wampler and others): a case from text in memory, searched from many starts; what was found is
!> analysed as a case of its own.
program synthesise_path
   use psalm, only: case_t, analysis_t, synthesis_t, findings_t, read_file, synthesise, found_case, analyse
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(synthesis_t) :: search
   type(analysis_t) :: analysis
   type(findings_t) :: findings
   integer :: i

   call read_file('data/path5.nml', cases, findings)
   if (.not. findings%failed()) then
      call synthesise(cases(1), search, findings)
      print '(i0,a,i0,a)', search%found%starts, ' starts, ', search%found%feasible, ' feasible'
      call analyse(found_case(cases(1), search), analysis, findings)
      print '(a,es10.3)', 'objective ', analysis%motion%total
   end if
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
end program synthesise_path
