!> Paths without prescribed timing: a row of a table for each data set. usage: paths CASE.nml ...
program paths
   use bench_paths, only: measure_path
   implicit none (type, external)
   character(200) :: file
   integer :: i

   do i = 1, command_argument_count()
      call get_command_argument(i, file)
      call measure_path(trim(file))
   end do
end program paths
