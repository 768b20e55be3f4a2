!> Velocity and acceleration of the piston of a slider-crank at 3000 revolutions a minute: a case from text in memory.
program rates_of_piston
   use psalm, only: case_t, rate_study_t, findings_t, read_text, find_rates
   implicit none (type, external)
   character, parameter :: nl = new_line('a')
   character(*), parameter :: text = &
      'OFFSET SLIDER-CRANK'//nl// &
      ' &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1,'//nl// &
      '  ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END'//nl// &
      ' &METHOD MOTION=3, IKIN=45 &END'//nl// &
      " &RATES SPEED=3000.0, UNITS='REV/MIN' &END"//nl
   type(case_t), allocatable :: cases(:)
   type(rate_study_t) :: rates
   type(findings_t) :: findings
   integer :: i

   call read_text(text, cases, findings)
   if (.not. findings%failed()) call find_rates(cases(1), rates, findings)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', '   crank     piston       velocity   acceleration'
   do i = 1, size(rates%dead)
      print '(f8.1, f11.4, 2es15.6)', rates%motion%input(i), rates%motion%actual(i, 1), rates%by_time(1:2, 1, i)
   end do
end program rates_of_piston
