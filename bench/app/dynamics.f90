!> Cost and accuracy of the studies of dynamics.
!>
!> usage: dynamics chart CASE.nml    seconds of a chart of 200 x 200 points | points | error of a boundary | points integrated |
!>                                   seconds for these | points where both disagree
program dynamics
   use bench_dynamics, only: measure_chart
   implicit none (type, external)
   character(200) :: task, file

   call get_command_argument(1, task)
   call get_command_argument(2, file)
   select case (task)
   case ('chart')
      call measure_chart(trim(file))
   case default
      error stop 'usage: dynamics chart CASE.nml'
   end select
end program dynamics
