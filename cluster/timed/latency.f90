!> What a round of ranks costs besides its work: `mpiexec -n RANKS latency` prints one line of JSON with the number of ranks and the
!> seconds of one portion taken from the counter (all ranks at once), of a barrier, and of the exchange at the end of a round
!> (MPI_Allgatherv) for several sizes of what each rank has. The median of the repetitions, as rank 0 sees it.
program latency
   use, intrinsic :: iso_c_binding, only: c_ptr
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use mpi_f08
   implicit none (type, external)
   integer, parameter :: repetitions = 51, portions = 200
   integer, parameter :: sizes(*) = [8, 1024, 65536] ! numbers of each rank
   real(real64), allocatable :: mine(:), all_of_it(:)
   real(real64) :: seconds(repetitions), of_counter, of_barrier, of_exchange(size(sizes))
   integer, allocatable :: counts(:), offsets(:)
   integer :: rank, ranks, taken, i, k
   integer(MPI_ADDRESS_KIND) :: bytes
   integer(int64) :: clock
   type(MPI_Win) :: window
   type(c_ptr) :: memory

   call MPI_Init()
   call MPI_Comm_rank(MPI_COMM_WORLD, rank)
   call MPI_Comm_size(MPI_COMM_WORLD, ranks)
   bytes = 0
   if (rank == 0) bytes = storage_size(0)/8
   call MPI_Win_allocate(bytes, storage_size(0)/8, MPI_INFO_NULL, MPI_COMM_WORLD, memory, window)
   call MPI_Win_lock_all(0, window)
   call MPI_Barrier(MPI_COMM_WORLD)
   call system_clock(clock)
   do i = 1, portions
      call MPI_Fetch_and_op(1, taken, MPI_INTEGER, 0, 0_MPI_ADDRESS_KIND, MPI_SUM, window)
      call MPI_Win_flush(0, window)
   end do
   of_counter = since(clock)/portions
   call MPI_Barrier(MPI_COMM_WORLD)
   do i = 1, repetitions
      call system_clock(clock)
      call MPI_Barrier(MPI_COMM_WORLD)
      seconds(i) = since(clock)
   end do
   of_barrier = median(seconds)
   do k = 1, size(sizes)
      mine = [(real(i, real64), i=1, sizes(k))]
      counts = [(sizes(k), i=1, ranks)]
      offsets = [(sizes(k)*(i - 1), i=1, ranks)]
      allocate (all_of_it(sum(counts)))
      do i = 1, repetitions
         call MPI_Barrier(MPI_COMM_WORLD)
         call system_clock(clock)
         call MPI_Allgatherv(mine, sizes(k), MPI_REAL8, all_of_it, counts, offsets, MPI_REAL8, MPI_COMM_WORLD)
         seconds(i) = since(clock)
      end do
      of_exchange(k) = median(seconds)
      deallocate (all_of_it)
   end do
   if (rank == 0) then
      print '(a, i0, 2(a, es10.3), a, *(es10.3, :, ", "))', '{"ranks": ', ranks, ', "counter": ', of_counter, ', "barrier": ', &
         of_barrier, ', "exchange": [', of_exchange
      print '(a, *(i0, :, ", "))', '], "bytes": [', sizes*storage_size(mine)/8
      print '(a)', ']}'
   end if
   call MPI_Win_unlock_all(window)
   call MPI_Win_free(window)
   call MPI_Finalize()

contains

   real(real64) function since(clock)
      integer(int64), intent(in) :: clock
      integer(int64) :: now, rate

      call system_clock(now, rate)
      since = real(now - clock, real64)/real(rate, real64)
   end function since

   !> The median, by counting those that are less.
   pure real(real64) function median(values)
      real(real64), intent(in) :: values(:)
      integer :: k

      median = values(1)
      do k = 1, size(values)
         if (count(values < values(k)) <= size(values)/2 .and. count(values <= values(k)) > size(values)/2) median = values(k)
      end do
   end function median
end program latency
