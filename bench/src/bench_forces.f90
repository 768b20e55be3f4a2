!> What forces cost: drive, frame and all joints of a mechanism with masses and weight, beside its motion.
module bench_forces
   use, intrinsic :: iso_fortran_env, only: int64
   use bench_measure, only: load, names, titles
   use psalm_data_set, only: data_set_t, read_data_set_text
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_force_model, only: force_model_t, make_force_model, vertices_of
   use psalm_kinds, only: wp, dp
   use psalm_kinetostatics, only: forces_t, prepare_forces, load_bodies, sweep
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   use psalm_rates, only: rates_t, prepare_rates, differentiate
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: measure_forces

   integer, parameter :: positions(3) = [180, 10000, 1000000]
   integer(int64), parameter :: work_of_a_sample = 2000000_int64 !! dyads times positions of one timing
   integer, parameter :: samples = 7                     !! timings of which the best counts

contains

   !> linkage | dyads | positions | ns per dyad and position of positions, velocities and accelerations | of forces after them
   subroutine measure_forces(short)
      logical, intent(in) :: short                      !! the fewest positions only
      type(problem_t), allocatable :: problem
      type(data_set_t) :: set
      integer :: k, m, most

      most = merge(1, size(positions), short)
      do k = 1, size(names)
         if (index(names(k), 'hard/') == 1) cycle   ! arcs there hang on no joint: motion can be had, forces cannot
         do m = 1, most
            if (allocated(problem)) deallocate (problem)
            allocate (problem)
            call load(k, positions(m), .true., problem, set=set)
            call measure(trim(titles(k)), set, problem)
         end do
      end do
      do m = 1, most
         if (allocated(problem)) deallocate (problem)
         allocate (problem)
         call load_row(positions(m), set, problem)
         call measure('64 four-bars on one crank', set, problem)
      end do
   end subroutine measure_forces

   subroutine measure(title, set, problem)
      character(*), intent(in) :: title
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(force_model_t) :: model
      type(diagnostics_t) :: findings
      real(dp) :: motion, whole, scale
      integer :: b

      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%bind(problem%given)
      call make_force_model(set, problem%mechanism, problem%given, model, findings)
      if (findings%failed()) error stop 'a linkage cannot have forces'
      model%gravity = [0.0_wp, -9.81_wp]
      do b = 2, size(model%reference)
         model%inertia(:, b) = [1.0_wp, 0.1_wp, 0.2_wp, 0.5_wp]*real(b, wp)
      end do
      motion = seconds(problem, model, .false.)
      whole = seconds(problem, model, .true.)
      scale = 1.0e9_dp/(real(problem%mechanism%nloop, dp)*real(problem%positions, dp))
      print '(a,i0,a,i0,2(a,f0.3))', title//'|', problem%mechanism%nloop, '|', problem%positions, '|', motion*scale, '|', &
         (whole - motion)*scale
   end subroutine measure

   !> 64 four-bars side by side on one crank, at n positions through one turn.
   subroutine load_row(n, set, problem)
      integer, intent(in) :: n
      type(data_set_t), intent(out) :: set
      type(problem_t), intent(out) :: problem
      character(*), parameter :: nl = new_line('a')
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      integer :: i

      call read_data_set_text('FOUR-BARS ON ONE CRANK'//nl// &
         ' &LINKS NLOOP=64, MAXARC=4, ILINK=1,-2,-3,4, '//repeat('1,-2,-3,-4, ', 63)//nl// &
         '  ILOOP='//repeat('1,0,0,1, ', 64)//nl//'  ARCL='//repeat('40.,120.,80.,130., ', 64)//nl// &
         '  GAMA=3*0.,180., '//repeat('3*0.,5., ', 63)//' NOUTLK=3, NOUTLP=64 &END'//nl// &
         ' &METHOD MOTION=1, IKIN=90 &END'//nl//' &LIMITS TANGLE=90., KTHETA=1 &END'//nl, 'a row of four-bars', sets, findings, &
         'kalm')
      if (findings%failed()) error stop 'the row of four-bars cannot be read'
      call set_up(sets(1), mechanism, dimensions, parameters, findings)
      if (findings%failed()) error stop 'the row of four-bars is wrong'
      call make_problem(sets(1), mechanism, dimensions, parameters, problem)
      call problem%set_inputs([(360.0_wp*real(i, wp)/real(n, wp), i=0, n - 1)])
      set = sets(1)
   end subroutine load_row

   !> Least time of one pass over all positions, of the processor.
   real(dp) function seconds(problem, model, with_forces)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      logical, intent(in) :: with_forces
      type(rates_t) :: rates
      type(forces_t) :: forces
      real(wp) :: total
      real(dp) :: from, to
      integer :: sample, repeat, i, block, offset, n

      total = 0.0_wp
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      repeat = int(max(1_int64, work_of_a_sample/(int(problem%positions, int64)*problem%mechanism%nloop)))
      seconds = huge(seconds)
      do sample = 1, samples
         call cpu_time(from)
         do i = 1, repeat
            do block = 1, problem%blocks()
               call problem%solve_block(block, offset, n)
               call differentiate(problem, rates, n, 2)
               if (.not. with_forces) cycle
               call load_bodies(problem, model, rates, n, 10.0_wp, 1.0_wp, forces)
               call sweep(problem, n, forces)
               total = total + forces%w%v(1, forces%drive)
            end do
         end do
         call cpu_time(to)
         seconds = min(seconds, (to - from)/real(repeat, dp))
      end do
      if (with_forces .and. abs(total) <= 0.0_wp) error stop 'nothing was computed'
   end function seconds
end module bench_forces
