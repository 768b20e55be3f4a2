!> A four-bar from its drawing: joints, links, a drive, an output; the path of the coupler point P by its name.
program analyse_sketch
   use psalm, only: wp, case_t, analysis_t, findings_t, report_t, new_case, analyse
   implicit none (type, external)
   type(case_t) :: four_bar
   type(analysis_t) :: analysis
   type(findings_t) :: findings
   type(report_t) :: report
   integer :: i

   four_bar = new_case('FOUR-BAR FROM A SKETCH')
   call four_bar%add_joint('A', 0.0_wp, 0.0_wp, fixed=.true.)
   call four_bar%add_joint('B', -4.0_wp, 31.0_wp)
   call four_bar%add_joint('C', 33.0_wp, 82.0_wp)
   call four_bar%add_joint('D', 90.0_wp, 5.0_wp, fixed=.true.)
   call four_bar%add_joint('P', 20.0_wp, 95.0_wp)
   call four_bar%add_link('A B', 'crank')
   call four_bar%add_link('B C P', 'coupler')
   call four_bar%add_link('C D', 'rocker')
   call four_bar%add_drive('A')
   call four_bar%add_output('point P')
   call four_bar%set_turn(15)
   call analyse(four_bar, analysis, findings, report=report)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   associate (input => report%column('positions', 'input'), x => report%column('positions', 'P.x'), &
              y => report%column('positions', 'P.y'))
      print '(f8.1, 2f15.8)', (input(i), x(i), y(i), i=1, size(input))
   end associate
end program analyse_sketch
