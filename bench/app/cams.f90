!> Cost and accuracy of cams.
!>
!> usage: cams cost CASE.nml    seconds of motion | seconds of shape, at 3600 cam angles
!>        cams disc CASE.nml    largest relative errors of the profile | of the curvature of an eccentric disc
program cams
   use bench_cams, only: measure_cam, measure_disc
   implicit none (type, external)
   character(200) :: task, file

   call get_command_argument(1, task)
   call get_command_argument(2, file)
   select case (task)
   case ('cost')
      call measure_cam(trim(file))
   case ('disc')
      call measure_disc(trim(file))
   case default
      error stop 'usage: cams cost|disc CASE.nml'
   end select
end program cams
