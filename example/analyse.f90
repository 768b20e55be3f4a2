!> A slider-crank made in memory, analysed over a turn of its crank.
program analyse_slider_crank
   use psalm, only: wp, case_t, analysis_t, findings_t, new_case, analyse, output_slide
   implicit none (type, external)
   type(case_t) :: slider_crank
   type(analysis_t) :: analysis
   type(findings_t) :: findings
   integer :: i

   slider_crank = new_case('OFFSET SLIDER-CRANK')
   call slider_crank%add_loop(ilink=[1, -2, 3, 4], iloop=[1, 0, -4, 1], length=[40.0_wp, 140.0_wp, 0.0_wp, 10.0_wp], &
                              angle=[0.0_wp, 0.0_wp, 0.0_wp, 270.0_wp])
   call slider_crank%set_output(output_slide, arc=3, loop=1)
   call slider_crank%set_turn(15)
   call analyse(slider_crank, analysis, findings)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   do i = 1, size(analysis%motion%input)
      print '(f8.1, f12.4)', analysis%motion%input(i), analysis%motion%actual(i, 1)
   end do
end program analyse_slider_crank
