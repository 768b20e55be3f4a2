!> Positions of one linkage, as `bench/packages` compares them with those of other packages.
module bench_positions
   use, intrinsic :: iso_fortran_env, only: int64, output_unit
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp, dp, full_turn
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: measure_positions

   integer(int64), parameter :: work_of_a_sample = 4000000_int64 !! dyads times positions of one timing
   integer, parameter :: samples = 7                             !! timings of which the best counts
contains

   !> The sketch of a file at n positions through one turn from the drawing on, output a point: prints dyads and nanoseconds of the
   !> processor per dyad and position; output points go into another file as a stream of x and y.
   subroutine measure_positions(file, n, out_file)
      character(*), intent(in) :: file, out_file
      integer, intent(in) :: n
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      type(problem_t) :: problem
      real(wp), allocatable :: x(:), y(:)
      real(dp) :: from, to, best
      integer :: sample, repeat, repeats, i, dyads, unit

      call read_cases(file, sets, findings)
      if (findings%failed()) error stop 'a data set cannot be read'
      call set_up(sets(1), mechanism, dimensions, parameters, findings)
      if (findings%failed()) error stop 'a data set is wrong'
      call make_problem(sets(1), mechanism, dimensions, parameters, problem)
      call problem%set_inputs([(dimensions%drawn - dimensions%crnki + full_turn*real(i, wp)/real(n, wp), i=0, n - 1)])
      dyads = count(problem%plan%solved)
      repeats = int(max(1_int64, work_of_a_sample/(int(n, int64)*dyads)))
      best = huge(best)
      do sample = 1, samples
         call cpu_time(from)
         do repeat = 1, repeats
            call solve_all(problem)
         end do
         call cpu_time(to)
         best = min(best, (to - from)/real(repeats, dp))
      end do
      allocate (x(n), y(n))
      call solve_all(problem, x, y)
      open (newunit=unit, file=out_file, access='stream', form='unformatted', status='replace')
      write (unit) (real(x(i), dp), real(y(i), dp), i=1, n)
      close (unit)
      write (output_unit, '(i0,a,f0.4)') dyads, '|', best*1.0e9_dp/real(dyads, dp)/real(n, dp)
   end subroutine measure_positions

   !> All positions and the output at them, block after block; the output points if they are wanted.
   subroutine solve_all(problem, x, y)
      type(problem_t), intent(inout) :: problem
      real(wp), intent(out), optional :: x(:), y(:)  !! shape (positions)
      integer :: block, offset, n

      call problem%bind(problem%given)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call problem%output_of(n)
         if (.not. present(x)) cycle
         associate (link => problem%linkage)
            x(offset + 1:offset + n) = link%store%v(1:n, link%out(1))
            y(offset + 1:offset + n) = link%store%v(1:n, link%out(2))
         end associate
      end do
   end subroutine solve_all
end module bench_positions
