!> Speed against error.
!>
!> usage: bench reference FILE         output points of every linkage (to be run in the build of quadruple precision)
!>        bench run FILE LABEL OUT     measure this build against FILE, append lines to OUT:
!>          label | method | linkage | dyads | positions | ns per dyad and position | largest relative error
!>          (the error at 180 positions only, else -1)
!>        bench pruning                ns per position: chain of 64 loops, output at the second | two loops alone
!>        bench derivatives            linkage | with velocities and accelerations / positions alone | ns per dyad, position;
!>                                     needle | us of an objective | us of a Jacobian | gradient / objective
!>        bench forces [short]         linkage | dyads | positions | ns per dyad and position: motion | forces after it;
!>                                     short: the fewest positions only
!>        bench groups FOLDER [short]  linkage | groups | positions | ns per position: larger groups, gears, cylinders; FOLDER: data
!>        bench evaluate20, evaluate10240   ten evaluations of the needle linkage, for counting instructions
!>        bench objective              positions | microseconds per evaluation | ns per dyad and position
!>        bench lanes                  linkages a call | microseconds a linkage: objective of the needle, 20 positions
program bench
   use bench_forces, only: measure_forces
   use bench_groups, only: measure_groups
   use bench_measure, only: write_reference, measure_all, measure_objective, measure_lanes, measure_pruning, evaluate_needle, &
                            measure_derivatives
   implicit none (type, external)
   character(200) :: task, file, label, out

   call get_command_argument(1, task)
   call get_command_argument(2, file)
   call get_command_argument(3, label)
   call get_command_argument(4, out)
   select case (task)
   case ('reference')
      call write_reference(trim(file))
   case ('run')
      call measure_all(trim(file), trim(label), trim(out))
   case ('objective')
      call measure_objective()
   case ('lanes')
      call measure_lanes()
   case ('pruning')
      call measure_pruning()
   case ('derivatives')
      call measure_derivatives()
   case ('forces')
      call measure_forces(file == 'short')
   case ('groups')
      call measure_groups(trim(file), label == 'short')
   case ('evaluate20')
      call evaluate_needle(20)
   case ('evaluate10240')
      call evaluate_needle(10240)
   case default
      error stop 'usage: bench reference FILE | run FILE LABEL OUT | objective'
   end select
end program bench
