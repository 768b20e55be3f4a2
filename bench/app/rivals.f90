!> Paths without prescribed timing by NLopt: a row of a table for each data set.
!>
!> usage: rivals SECONDS [CASE.nml BEST] ...; BEST is the best sum of squares known.
program rivals
   use bench_path_rivals, only: measure_rivals
   use psalm_kinds, only: wp
   implicit none (type, external)
   character(200) :: file, word
   real(wp) :: seconds, best
   integer :: i

   call get_command_argument(1, word)
   read (word, *) seconds
   do i = 2, command_argument_count() - 1, 2
      call get_command_argument(i, file)
      call get_command_argument(i + 1, word)
      read (word, *) best
      call measure_rivals(trim(file), best, seconds)
   end do
end program rivals
