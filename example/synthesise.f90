!> A search from many starts, and the linkage it found as a case of its own. From the top of the checkout.
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
      call analyse(found_case(cases(1), search), analysis, findings)
   end if
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(i0, a, i0, a)', search%found%starts, ' starts, ', search%found%feasible, ' led to a linkage'
   print '(a, es14.6)', 'objective', analysis%motion%total
   do i = 1, size(analysis%motion%input)
      print '(f8.1, 2f12.6)', analysis%motion%input(i), analysis%motion%actual(i, :)
   end do
end program synthesise_path
