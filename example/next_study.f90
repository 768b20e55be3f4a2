!> One study feeds the next without a file: a search finds a linkage, masses are given to it, its forces are found.
program show_next_study
   use psalm, only: wp, case_t, findings_t, force_study_t, report_t, synthesis_t, find_forces, read_file, synthesise
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(case_t) :: found
   type(synthesis_t), allocatable :: synthesis
   type(force_study_t) :: forces
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   allocate (synthesis)
   call read_file('data/path5.nml', cases, findings)
   if (.not. findings%failed()) call synthesise(cases(1), synthesis, findings, report=report)
   if (findings%failed() .or. size(report%cases) == 0) error stop 1
   found = report%cases(1)
   call found%set_item('RATES', 'SPEED', 10.0_wp)
   call found%set_item('MASSES', 'MLINK', [-2])
   call found%set_item('MASSES', 'MLOOP', [1])
   call found%set_item('MASSES', 'MASS', [0.5_wp])
   call found%set_item('MASSES', 'MDIST', [0.5_wp])
   call find_forces(found, forces, findings)
   do i = 1, findings%count
      if (findings%list(i)%level == 2) print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a, i0)', 'linkages found ', size(report%cases)
   print '(a, es15.6)', 'largest torque ', maxval(abs(forces%table%value(:, 1)))
end program show_next_study
