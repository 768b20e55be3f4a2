!> What the benchmark measures: positions of five linkages by every method, and the objective of the needle linkage.
module bench_measure
   use, intrinsic :: iso_fortran_env, only: int64, real128
   use bench_loops, only: loops_t, make_loops, first_unknowns
   use bench_rivals, only: direct_1977, newton_raphson, integrate_velocities
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp, dp, radians_per_degree
   use psalm_lanes, only: lanes
   use psalm_linkage_lanes, only: linkage_lanes_t
   use psalm_output_kind, only: motion_point
   use psalm_rates, only: rates_t, prepare_rates, differentiate
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, find_jacobian
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   implicit none (type, external)
   private
   public :: load, names, titles
   public :: write_reference, measure_all, measure_objective, measure_lanes, measure_pruning, evaluate_needle, measure_derivatives

   character(*), parameter :: names(*) = [character(24) :: 'dyad1_crank_rocker', 'hard/pruned64', 'needle', 'textile', &
                                          'hard/chain64']
   character(*), parameter :: titles(*) = [character(24) :: 'four-bar', 'six-bar', 'ten-bar (needle)', &
                                           'ten-bar with slides', 'chain of 64 dyads']
   integer, parameter :: positions(4) = [20, 180, 10000, 1000000]
   integer, parameter :: reference_positions = 180
   integer(int64), parameter :: most_rival_work = 4000000_int64  !! dyads times positions that a rival is timed with
   integer(int64), parameter :: most_quad_work = 50000_int64     !! the same for quadruple precision
   integer(int64), parameter :: work_of_a_sample = 4000000_int64 !! dyads times positions of one timing
   integer, parameter :: samples = 7                     !! timings of which the best counts
contains

   !> The k-th linkage at n positions through one turn, output a point, closure only.
   subroutine load(k, n, everything, problem, as_written, set)
      integer, intent(in) :: k, n
      logical, intent(in) :: everything
      type(problem_t), intent(out) :: problem
      logical, intent(in), optional :: as_written
      type(data_set_t), intent(out), optional :: set
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      integer :: i

      call read_data_sets('../data/'//trim(names(k))//'.nml', sets, findings)
      if (findings%failed()) error stop 'a data set cannot be read'
      sets(1)%method%motion = motion_point
      if (present(as_written)) sets(1)%method%motion = 1
      sets(1)%limits%tangle = 90.0_wp
      sets(1)%limits%ktheta = merge(1, 0, everything)
      if (sets(1)%links%outlk <= 0.0_wp) sets(1)%links%outlk = 50.0_wp
      if (names(k) == 'hard/pruned64') then
         ! the two loops that matter, so that every method solves the same
         sets(1)%links%nloop = 2
         sets(1)%links%ilink = sets(1)%links%ilink(:, :2)
         sets(1)%links%iloop = sets(1)%links%iloop(:, :2)
         sets(1)%links%arcl = sets(1)%links%arcl(:, :2)
         sets(1)%links%gama = sets(1)%links%gama(:, :2)
         sets(1)%method%iva = sets(1)%method%iva(:, :2)
         sets(1)%method%ivg = sets(1)%method%ivg(:, :2)
      end if
      call set_up(sets(1), mechanism, dimensions, parameters, findings)
      if (findings%failed()) error stop 'a data set is wrong'
      call make_problem(sets(1), mechanism, dimensions, parameters, problem)
      call problem%set_inputs([(360.0_wp*real(i, wp)/real(n, wp), i=0, n - 1)])
      if (present(set)) set = sets(1)
   end subroutine load

   subroutine points_of(problem, x, y)
      type(problem_t), intent(inout) :: problem
      real(wp), intent(out) :: x(:), y(:)
      integer :: block, offset, n

      call problem%bind(problem%given)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call problem%output_of(n)
         associate (link => problem%linkage)
            x(offset + 1:offset + n) = link%store%v(1:n, link%out(1))
            y(offset + 1:offset + n) = link%store%v(1:n, link%out(2))
         end associate
      end do
   end subroutine points_of

   !> Output points of all linkages, to be run in quadruple precision.
   subroutine write_reference(file)
      character(*), intent(in) :: file
      type(problem_t) :: problem
      real(wp) :: x(reference_positions), y(reference_positions)
      integer :: i, k, unit

      open (newunit=unit, file=file, status='replace')
      do k = 1, size(names)
         call load(k, reference_positions, .false., problem)
         call points_of(problem, x, y)
         do i = 1, reference_positions
            write (unit, '(2es45.35)') x(i), y(i)
         end do
      end do
      close (unit)
   end subroutine write_reference

   !> Measure everything against a reference; append lines to a file.
   subroutine measure_all(reference_file, label, out_file)
      character(*), intent(in) :: reference_file, label, out_file
      real(real128) :: exact(2, reference_positions, size(names))
      integer :: k, unit

      open (newunit=unit, file=reference_file, status='old', action='read')
      read (unit, *) exact
      close (unit)
      open (newunit=unit, file=out_file, position='append')
      do k = 1, size(names)
         call measure(k, exact, label, unit)
      end do
      close (unit)
   end subroutine measure_all

   !> Product and rivals on one linkage.
   subroutine measure(k, exact, label, unit)
      integer, intent(in) :: k, unit
      real(real128), intent(in) :: exact(:, :, :)
      character(*), intent(in) :: label
      type(problem_t) :: problem, whole
      type(loops_t) :: loops
      real(wp), allocatable :: x(:), y(:), cranks(:), start(:)
      integer :: m, n, dyads, i, offset, got
      real(dp) :: seconds

      do m = 1, size(positions)
         n = positions(m)
         call load(k, n, .false., problem)
         dyads = count(problem%plan%solved)
         if (precision(1.0_wp) > precision(1.0_dp) .and. int(n, int64)*dyads > most_quad_work) cycle
         allocate (x(n), y(n), source=0.0_wp)
         call time_positions(problem, dyads, seconds)
         call points_of(problem, x, y)
         call report('positions', seconds)
         if (kind(1.0_wp) /= dp .or. int(n, int64)*dyads > most_rival_work) then
            deallocate (x, y)
            cycle
         end if
         call load(k, n, .true., whole)
         call whole%bind(whole%given)
         call whole%solve_block(1, offset, got)
         call make_loops(whole, loops)
         cranks = loops%crank + whole%delt*radians_per_degree
         allocate (start(2*loops%nloop))
         call first_unknowns(whole, loops, start)
         call time_rival(1, 0.0_wp)
         call time_rival(2, 1.0e-8_wp)
         call time_rival(2, 1.0e-13_wp)
         do i = 6, 12, 3
            call time_rival(3, 10.0_wp**(-i))
         end do
         deallocate (x, y, cranks, start)
      end do

   contains

      subroutine time_rival(method, tolerance)
         integer, intent(in) :: method
         real(wp), intent(in) :: tolerance
         integer(int64) :: from, to, rate
         real(dp) :: best
         integer :: sample, repeat, repeats
         logical :: done
         character(40) :: name

         repeats = int(max(1_int64, work_of_a_sample/(10_int64*n*dyads)))
         best = huge(best)
         done = .true.
         do sample = 1, merge(3, 1, n < 100000)
            call system_clock(from, rate)
            do repeat = 1, repeats
               select case (method)
               case (1)
                  call direct_1977(loops, cranks, x, y)
               case (2)
                  call newton_raphson(loops, cranks, start, tolerance, x, y)
               case default
                  call integrate_velocities(loops, cranks, start, tolerance, x, y, done)
               end select
            end do
            call system_clock(to)
            best = min(best, real(to - from, dp)/real(rate, dp)/real(repeats, dp))
         end do
         select case (method)
         case (1)
            name = 'direct formulas of 1977'
         case (2)
            write (name, '(a,es6.0)') 'Newton-Raphson, ', tolerance
         case default
            write (name, '(a,es6.0)') 'Adams integration, ', tolerance
         end select
         if (done) call report(trim(name), best)
      end subroutine time_rival

      subroutine report(method, seconds)
         character(*), intent(in) :: method
         real(dp), intent(in) :: seconds
         real(real128) :: worst
         integer :: i

         worst = -1.0_real128
         if (n == reference_positions) then
            do i = 1, n
               worst = max(worst, hypot(real(x(i), real128) - exact(1, i, k), real(y(i), real128) - exact(2, i, k)) &
                           /hypot(exact(1, i, k), exact(2, i, k)))
            end do
         end if
         write (unit, '(2a,i0,a,i0,a,f0.4,a,es10.2)') trim(label)//'|'//method//'|'//trim(titles(k)), '|', dyads, '|', n, '|', &
            seconds*1.0e9_dp/real(dyads, dp)/real(n, dp), '|', real(worst, dp)
      end subroutine report
   end subroutine measure

   subroutine time_positions(problem, dyads, best)
      type(problem_t), intent(inout) :: problem
      integer, intent(in) :: dyads
      real(dp), intent(out) :: best
      integer(int64) :: from, to, rate
      integer :: sample, repeat, repeats, block, offset, n

      repeats = int(max(1_int64, work_of_a_sample/(int(problem%positions, int64)*dyads)))
      if (precision(1.0_wp) > precision(1.0_dp)) repeats = 1 + repeats/100
      best = huge(best)
      do sample = 1, samples
         call system_clock(from, rate)
         do repeat = 1, repeats
            call problem%bind(problem%given)
            do block = 1, problem%blocks()
               call problem%solve_block(block, offset, n)
               call problem%output_of(n)
            end do
         end do
         call system_clock(to)
         best = min(best, real(to - from, dp)/real(rate, dp)/real(repeats, dp))
      end do
   end subroutine time_positions

   !> The objective of the needle linkage as a search sees it: 16 variables change, 20 positions.
   subroutine measure_objective()
      type(problem_t) :: problem
      type(dimensions_t) :: dimensions
      integer(int64) :: from, to, rate
      integer :: sample, i, loop, m, n, repeats
      real(wp) :: objective, total
      real(dp) :: best

      do m = 1, size(positions)
         n = positions(m)
         call load(3, n, .false., problem, as_written=.true.)
         call problem%set_desired(reshape([(147.0_wp + real(mod(i, 5), wp), i=1, n)], [n, 1]))
         dimensions = problem%given
         repeats = max(1, 2000000/n)
         best = huge(best)
         total = 0.0_wp
         do sample = 1, samples
            call system_clock(from, rate)
            do i = 1, repeats
               dimensions%gama = problem%given%gama*(1.0_wp + 1.0e-9_wp*real(i, wp))
               dimensions%arcl = problem%given%arcl*(1.0_wp + 1.0e-9_wp*real(i, wp))
               dimensions%crnki = problem%given%crnki + 1.0e-9_wp*real(i, wp)
               dimensions%outang = problem%given%outang + 1.0e-9_wp*real(i, wp)
               call problem%evaluate(dimensions, objective, loop)
               total = total + objective
            end do
            call system_clock(to)
            best = min(best, real(to - from, dp)/real(rate, dp)/real(repeats, dp))
         end do
         if (total <= 0.0_wp) error stop 'no objective'
         print '(i0,a,f0.4,a,f0.4)', n, '|', best*1.0e6_dp, '|', best*1.0e9_dp/real(4*n, dp)
      end do
   end subroutine measure_objective

   !> The objective of the needle linkage as it is written, 20 positions, whose variables change all: one by one, then several
   !> linkages a call.
   subroutine measure_lanes()
      type(problem_t) :: problem
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      type(linkage_lanes_t), allocatable :: side_by_side
      real(wp), allocatable :: first(:), values(:, :)
      real(wp) :: objective(lanes), total
      real(dp) :: from, to, best
      integer :: loop(lanes), count, sample, i, l
      integer, parameter :: calls = 20000

      call read_data_sets('../data/needle.nml', sets, findings)
      call set_up(sets(1), mechanism, dimensions, parameters, findings)
      call make_problem(sets(1), mechanism, dimensions, parameters, problem)
      first = parameters%first_values(dimensions)
      values = spread(first, 1, lanes)
      allocate (side_by_side)
      call side_by_side%prepare(problem)
      total = 0.0_wp
      count = 1
      do while (count <= lanes)
         best = huge(best)
         do sample = 1, samples
            call cpu_time(from)
            do i = 1, calls
               do l = 1, count
                  values(l, :) = first*(1.0_wp + 1.0e-9_wp*real(i + l, wp))
               end do
               if (count == 1) then
                  call parameters%apply(values(1, :), dimensions)
                  call problem%evaluate(dimensions, objective(1), loop(1))
               else
                  call side_by_side%put_values(parameters, values)
                  call side_by_side%evaluate(problem, objective(:count), loop(:count))
               end if
               total = total + sum(objective(:count))
            end do
            call cpu_time(to)
            best = min(best, (to - from)/real(calls*count, dp))
         end do
         print '(i0,a,f0.4)', count, '|', best*1.0e6_dp
         count = 2*count
      end do
      if (total <= 0.0_wp) error stop 'no objective'
   end subroutine measure_lanes

   !> Positions of the chain of 64 loops whose output hangs on the second, and of its two loops alone: ns per position.
   subroutine measure_pruning()
      type(problem_t) :: chain, pair
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      real(dp) :: of_chain, of_pair
      integer :: i
      integer, parameter :: n = 10000

      call read_data_sets('../data/hard/pruned64.nml', sets, findings)
      call set_up(sets(1), mechanism, dimensions, parameters, findings)
      sets(1)%method%motion = motion_point
      call make_problem(sets(1), mechanism, dimensions, parameters, chain)
      call chain%set_inputs([(360.0_wp*real(i, wp)/real(n, wp), i=0, n - 1)])
      call load(2, n, .false., pair)
      call time_positions(chain, 2, of_chain)
      call time_positions(pair, 2, of_pair)
      print '(f0.4,a,f0.4)', of_chain*1.0e9_dp/real(n, dp), '|', of_pair*1.0e9_dp/real(n, dp)
   end subroutine measure_pruning

   !> Ten evaluations of the needle linkage at 20 positions, or at 10240, for counting instructions.
   subroutine evaluate_needle(n)
      integer, intent(in) :: n
      type(problem_t) :: problem
      integer :: i, loop
      real(wp) :: objective

      call load(3, n, .false., problem, as_written=.true.)
      call problem%set_desired(reshape([(147.0_wp + real(mod(i, 5), wp), i=1, n)], [n, 1]))
      do i = 1, 10
         call problem%evaluate(problem%given, objective, loop)
      end do
      if (loop /= 0) error stop 'the needle linkage does not close'
   end subroutine evaluate_needle

   !> Derivatives: positions with velocities and accelerations against positions alone, ten-bars and chain, 10000 positions;
   !> Jacobian and gradient of the needle linkage's 16 variables at 20 positions against one evaluation of its objective.
   subroutine measure_derivatives()
      type(problem_t) :: problem
      type(rates_t) :: rates
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      type(sensitivity_t) :: work
      real(wp), allocatable :: dout(:, :, :)
      real(wp) :: total
      real(dp) :: alone, with_rates, jacobian
      integer :: k, sample, i, block, offset, n
      integer(int64) :: from, to, rate
      integer, parameter :: positions_of_rates = 10000, repeats = 20000

      do k = 3, size(names)
         call load(k, positions_of_rates, .false., problem)
         call time_positions(problem, count(problem%plan%solved), alone)
         call problem%want_derivatives(.false.)
         call prepare_rates(problem, rates)
         with_rates = huge(with_rates)
         do sample = 1, samples
            call system_clock(from, rate)
            do i = 1, 20
               call problem%bind(problem%given)
               do block = 1, problem%blocks()
                  call problem%solve_block(block, offset, n)
                  call problem%output_of(n)
                  call differentiate(problem, rates, n, 2)
               end do
            end do
            call system_clock(to)
            with_rates = min(with_rates, real(to - from, dp)/real(rate, dp)/20.0_dp)
         end do
         print '(a,f0.3,a,f0.3)', trim(titles(k))//'|', with_rates/alone, '|', &
            with_rates*1.0e9_dp/real(positions_of_rates, dp)/real(count(problem%plan%solved), dp)
      end do
      call read_data_sets('../data/needle.nml', sets, findings)
      call set_up(sets(1), mechanism, dimensions, parameters, findings)
      call make_problem(sets(1), mechanism, dimensions, parameters, problem)
      call problem%want_derivatives(.false.)
      call prepare_sensitivity(problem, work)
      allocate (dout(problem%positions, size(parameters%variables), problem%output%kind%components))
      jacobian = huge(jacobian)
      total = 0.0_wp
      do sample = 1, samples
         call system_clock(from, rate)
         do i = 1, repeats
            call change()
            call find_jacobian(problem, dimensions, work, dout)
            total = total + dout(1, 1, 1)
         end do
         call system_clock(to)
         jacobian = min(jacobian, real(to - from, dp)/real(rate, dp)/real(repeats, dp))
      end do
      if (abs(total) <= 0.0_wp) error stop 'nothing was computed'
      print '(a,f0.3)', 'needle|', jacobian*1.0e6_dp

   contains

      subroutine change()
         dimensions%gama = problem%given%gama*(1.0_wp + 1.0e-9_wp*real(i, wp))
         dimensions%arcl = problem%given%arcl*(1.0_wp + 1.0e-9_wp*real(i, wp))
         dimensions%crnki = problem%given%crnki + 1.0e-9_wp*real(i, wp)
         dimensions%outang = problem%given%outang + 1.0e-9_wp*real(i, wp)
      end subroutine change
   end subroutine measure_derivatives
end module bench_measure
