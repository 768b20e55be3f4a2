!> Positions of the linkage of a file through one turn: dyads | nanoseconds per dyad and position, time of the processor.
!>
!> usage: positions FILE N OUT; OUT gets the output points, a stream of x and y.
program positions
   use bench_positions, only: measure_positions
   implicit none (type, external)
   character(400) :: file, number, out
   integer :: n

   call get_command_argument(1, file)
   call get_command_argument(2, number)
   call get_command_argument(3, out)
   read (number, *) n
   call measure_positions(trim(file), n, trim(out))
end program positions
