!> Torque and bearing loads of a slider-crank at 3000 revolutions a minute, and how much of the torque is the piston's mass.
program forces_of_engine
   use psalm, only: wp, case_t, force_study_t, findings_t, read_text, find_forces
   implicit none (type, external)
   character, parameter :: nl = new_line('a')
   character(*), parameter :: text = &
      'OFFSET SLIDER-CRANK'//nl// &
      ' &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1,'//nl// &
      '  ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END'//nl// &
      ' &METHOD MOTION=3, IKIN=45 &END'//nl// &
      " &RATES SPEED=3000.0, UNITS='REV/MIN' &END"//nl// &
      ' &MASSES NMASS=2, MLINK=-2,-3, MLOOP=1,1, MASS=0.5,0.8, MDIST=45.0,0.0, MINERT=0.0015,0.0, UNITL=0.001 &END'//nl
   integer, parameter :: piston = 4   ! bodies: frame, crank, rod, piston
   type(case_t), allocatable :: cases(:)
   type(force_study_t) :: forces
   type(findings_t) :: findings
   real(wp), allocatable :: of_unit_mass(:, :, :, :)
   integer :: i

   call read_text(text, cases, findings)
   if (.not. findings%failed()) call find_forces(cases(1), forces, findings, by_unit_mass=of_unit_mass)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   print '(a)', '   crank     torque        by piston'
   do i = 1, size(forces%input)
      print '(f8.1, 2es15.6)', forces%input(i), forces%table%value(i, 1), 0.8_wp*of_unit_mass(i, 1, 1, piston)
   end do
   do i = 1, size(forces%sizing)
      print '(2a, es15.6)', forces%sizing(i)%name, ' peak', forces%sizing(i)%peak
   end do
end program forces_of_engine
