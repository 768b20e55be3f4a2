!> Tolerances: what small deviations of the dimensions do to the output.
!>
!> Linear: the Jacobian times the tolerances, dimension by dimension; worst case (all add up) and root-sum-square over the
!> motion. Real: a Monte-Carlo sample of linkages whose dimensions deviate uniformly within their tolerances, with the thesis's
!> generator, shared out to threads in chunks that start where the sequence says: the same bits for any number of threads.
!> Source: Oldham (1977), section 8.2.5 and chapter 1.
module psalm_tolerance
   use psalm_data_set, only: data_set_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, motion_t, make_problem
   use psalm_finale, only: angle_text
   use psalm_stop, only: stop_t
   use psalm_kinds, only: wp, i8
   use psalm_linkage, only: padded
   use psalm_output_kind, only: output_kind_t
   use psalm_random, only: random_t
   use psalm_rates, only: form_frames, is_dead
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, find_jacobian
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t
   use psalm_text, only: text_t, full_precision, general, to_text
   use psalm_topology, only: topology_t, dimensions_t, variable_t, name_of, variable_length, variable_gama, variable_outlk, &
                             variable_outang, variable_origlk, variable_origng
   implicit none (type, external)
   private
   public :: tolerance_t, sample_t, find_tolerances, draw_sample, list_tolerances, plot_tolerances

   integer, parameter :: least_chunk = 1000     !! linkages of a chunk; sums are formed by chunk and added in order
   integer, parameter :: most_chunks = 1000     !! larger samples have larger chunks
   integer, parameter :: chunks_at_once = 4     !! of each thread: between these rounds sums are added
   integer, parameter :: solved_unasked = 20000 !! positions between two looks whether the sample must end
   integer, parameter :: most_named = 10        !! linkages of the sample that are named because they do not close

   !> The linear picture.
   type :: tolerance_t
      type(problem_t) :: problem                   !! every dimension with a tolerance is a variable
      type(problem_t) :: lean                      !! the same, for positions alone
      type(dimensions_t) :: dimensions             !! the nominal linkage
      type(motion_t) :: nominal                    !! its motion
      real(wp), allocatable :: tolerance(:)        !! shape (marble)
      real(wp), allocatable :: effect(:, :, :)     !! shape (positions, marble, components): change of the output with each
      real(wp), allocatable :: worst(:, :)         !! shape (positions, components): worst case
      real(wp), allocatable :: square(:, :)        !! shape (positions, components): root-sum-square
      logical, allocatable :: dead(:)              !! shape (positions): a dead point, where the effects are infinite
   end type tolerance_t

   !> The sample.
   type :: sample_t
      integer :: trials = 0                        !! linkages analysed: fewer than asked for if the sample had to end early
      logical :: any_closed = .false.              !! there is something to tell of
      integer :: open = 0                          !! linkages that do not close at some position
      integer :: named(most_named) = 0             !! the first of them
      integer :: loop(most_named) = 0              !! and the loop that fails
      real(wp), allocatable :: low(:, :), high(:, :), mean(:, :), deviation(:, :) !! shape (positions, components)
   end type sample_t

contains

   !> Jacobian and linear bands of a linkage. `dimensions` must close at every position.
   subroutine find_tolerances(set, dimensions, result, closes)
      type(data_set_t), intent(in) :: set
      type(dimensions_t), intent(in) :: dimensions
      type(tolerance_t), intent(out) :: result
      logical, intent(out) :: closes
      type(data_set_t) :: varied
      type(diagnostics_t) :: unheard
      type(topology_t) :: topology
      type(dimensions_t) :: given
      type(sensitivity_t) :: work
      integer :: v, marble, n

      varied = set
      varied%iva = merge(1, 0, set%tolarc > 0.0_wp)
      varied%ivg = merge(1, 0, set%tolgam > 0.0_wp)
      varied%ilkout = merge(1, 0, set%tolout > 0.0_wp)
      varied%ingout = merge(1, 0, set%toloua > 0.0_wp)
      varied%iorig = merge(1, 0, set%tolorl > 0.0_wp .or. set%tolora > 0.0_wp)
      varied%icrk = merge(1, 0, set%tolcrk > 0.0_wp)
      ! closure only; desired values play no part, but SETUP asks for them where there are variables
      varied%tangle = 90.0_wp
      varied%desired = .true.
      varied%limval = 0
      varied%var = 0.1_wp
      varied%nguess = 0
      if (set%ikin /= 0) then
         varied%ikin = 0
         varied%delt = [(real(v*set%ikin, wp), v=0, (359/abs(set%ikin)))]
         varied%ndes = size(varied%delt)
      end if
      varied%desx = spread(0.0_wp, 1, varied%ndes)
      varied%desy = varied%desx
      varied%desang = varied%desx
      varied%xmult = varied%desx + 1.0_wp
      varied%ymult = varied%xmult
      varied%anmult = varied%xmult
      call set_up(varied, topology, given, unheard)
      result%dimensions = dimensions
      call make_problem(varied, topology, dimensions, result%problem)
      result%lean = result%problem
      call result%problem%want_derivatives(.false.)
      result%problem%desired = .false.
      call result%problem%analyse(dimensions, result%nominal)
      closes = all(result%nominal%closed)
      if (.not. closes) return
      marble = size(topology%variables)
      n = result%problem%positions
      allocate (result%tolerance(marble), result%effect(n, marble, result%problem%output%kind%components))
      do v = 1, marble
         result%tolerance(v) = tolerance_of(set, topology%variables(v))
      end do
      call prepare_sensitivity(result%problem, work)
      call find_jacobian(result%problem, dimensions, work, result%effect)
      call find_dead(result%problem, dimensions, work, result%dead)
      do v = 1, marble
         result%effect(:, v, :) = result%effect(:, v, :)*result%tolerance(v)
      end do
      result%worst = sum(abs(result%effect), dim=2)
      result%square = sqrt(sum(result%effect**2, dim=2))
   end subroutine find_tolerances

   !> Positions at which some dyad is at a dead point.
   subroutine find_dead(problem, dimensions, work, dead)
      type(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(sensitivity_t), intent(inout) :: work
      logical, allocatable, intent(out) :: dead(:)
      integer :: block, offset, n, i, loop

      allocate (dead(problem%positions), source=.false.)
      call problem%bind(dimensions)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call form_frames(problem, work%rates, padded(n), fixed_too=.false.)
         do loop = 1, problem%topology%nloop
            if (problem%linkage%step_of_loop(loop) == 0) cycle
            do i = 1, n
               if (is_dead(problem, work%rates, loop, i)) dead(offset + i) = .true.
            end do
         end do
      end do
   end subroutine find_dead

   pure real(wp) function tolerance_of(set, variable) result(tolerance)
      type(data_set_t), intent(in) :: set
      type(variable_t), intent(in) :: variable

      select case (variable%kind)
      case (variable_length)
         tolerance = set%tolarc(variable%arc, variable%loop)
      case (variable_gama)
         tolerance = set%tolgam(variable%arc, variable%loop)
      case (variable_outlk)
         tolerance = set%tolout
      case (variable_outang)
         tolerance = set%toloua
      case (variable_origlk)
         tolerance = set%tolorl
      case (variable_origng)
         tolerance = set%tolora
      case default
         tolerance = set%tolcrk
      end select
   end function tolerance_of

   !> Analyse a sample of linkages.
   !>
   !> Linkage t takes its deviates from place (t-1) marble + 1 of the sequence that begins with ISTART. A sample that must end early
   !> has the linkages analysed so far.
   subroutine draw_sample(linear, trials, istart, threads, sample, interrupt)
      type(tolerance_t), intent(in) :: linear
      integer, intent(in) :: trials, istart, threads
      type(sample_t), intent(out) :: sample
      type(stop_t), intent(in), optional :: interrupt !! asked now and then
      type(stop_t) :: ending
      type(problem_t), allocatable :: workers(:)
      real(wp), allocatable :: low(:, :, :), high(:, :, :), total(:, :, :), squares(:, :, :) !! by chunk of a round
      integer, allocatable :: made(:), open(:), named(:, :), loop(:, :)
      integer :: chunk, chunks, before, at_once, k, t, n, i, closed, components

      if (present(interrupt)) ending = interrupt
      n = linear%problem%positions
      components = linear%problem%output%kind%components
      chunk = max(least_chunk, (trials - 1)/most_chunks + 1)
      chunks = (trials - 1)/chunk + 1
      allocate (workers(max(1, threads)))
      do t = 1, size(workers)
         workers(t) = linear%lean
         call workers(t)%set_inputs(linear%problem%delt)
         call workers(t)%set_desired(linear%nominal%actual, spread(spread(1.0_wp, 1, n), 2, components))
      end do
      at_once = min(chunks, chunks_at_once*size(workers))
      allocate (low(n, components, at_once), high(n, components, at_once))
      allocate (total(n, components, at_once), squares(n, components, at_once))
      allocate (made(at_once), open(at_once), named(most_named, at_once), loop(most_named, at_once), source=0)
      allocate (sample%low(n, components), source=huge(1.0_wp))
      allocate (sample%high(n, components), source=-huge(1.0_wp))
      allocate (sample%mean(n, components), sample%deviation(n, components), source=0.0_wp)
      do before = 0, chunks - 1, at_once
         !$omp parallel do num_threads(size(workers)) schedule(static) private(k)
         do t = 1, size(workers)
            do k = t, min(at_once, chunks - before), size(workers)
               call run_chunk(linear, workers(t), (before + k - 1)*chunk + 1, min(trials, (before + k)*chunk), istart, ending, &
                              low(:, :, k), high(:, :, k), total(:, :, k), squares(:, :, k), made(k), open(k), named(:, k), &
                              loop(:, k))
            end do
         end do
         !$omp end parallel do
         do k = 1, min(at_once, chunks - before)
            sample%low = min(sample%low, low(:, :, k))
            sample%high = max(sample%high, high(:, :, k))
            sample%mean = sample%mean + total(:, :, k)
            sample%deviation = sample%deviation + squares(:, :, k)
            do i = 1, min(open(k), most_named)
               if (sample%open + i > most_named) exit
               sample%named(sample%open + i) = named(i, k)
               sample%loop(sample%open + i) = loop(i, k)
            end do
            sample%trials = sample%trials + made(k)
            sample%open = sample%open + open(k)
         end do
         if (ending%waiting()) exit
      end do
      sample%any_closed = sample%open < sample%trials
      closed = max(1, sample%trials - sample%open)
      sample%mean = sample%mean/real(closed, wp)
      sample%deviation = sqrt(max(sample%deviation/real(closed, wp) - sample%mean**2, 0.0_wp))
   end subroutine draw_sample

   !> The linkages from one number to another.
   subroutine run_chunk(linear, problem, from, to, istart, ending, low, high, total, squares, made, open, named, loop)
      type(tolerance_t), intent(in) :: linear
      type(problem_t), intent(inout) :: problem
      integer, intent(in) :: from, to, istart
      type(stop_t), intent(in) :: ending
      real(wp), intent(out) :: low(:, :), high(:, :), total(:, :), squares(:, :) !! shape (positions, components)
      integer, intent(out) :: made, open, named(:), loop(:)
      type(dimensions_t) :: dimensions
      type(random_t) :: random
      real(wp), allocatable :: nominal(:), values(:), miss(:, :)
      real(wp) :: deviate
      integer :: t, v, failed, i, k, unasked

      low = huge(low)
      high = -huge(high)
      total = 0.0_wp
      squares = 0.0_wp
      open = 0
      named = 0
      loop = 0
      dimensions = linear%dimensions
      nominal = problem%topology%first_values(linear%dimensions)
      values = nominal
      allocate (miss(problem%positions, size(low, 2)), source=0.0_wp)
      random%state = int(istart, i8)
      call random%skip(int(from - 1, i8)*int(size(values), i8))
      unasked = max(1, solved_unasked/max(1, problem%positions))
      made = 0
      do t = from, to
         if (mod(t - from, unasked) == 0) then
            if (ending%waiting()) return
         end if
         made = made + 1
         do v = 1, size(values)
            call random%next(deviate)
            values(v) = nominal(v) + linear%tolerance(v)*(2.0_wp*deviate - 1.0_wp)
         end do
         call problem%topology%apply(values, dimensions)
         call problem%deviations(dimensions, miss, failed)
         if (failed > 0) then
            open = open + 1
            if (open <= most_named) then
               named(open) = t
               loop(open) = failed
            end if
            cycle
         end if
         do k = 1, size(low, 2)
            do i = 1, size(miss, 1)
               low(i, k) = merge(miss(i, k), low(i, k), miss(i, k) < low(i, k))
               high(i, k) = merge(miss(i, k), high(i, k), miss(i, k) > high(i, k))
               total(i, k) = total(i, k) + miss(i, k)
               squares(i, k) = squares(i, k) + miss(i, k)**2
            end do
         end do
      end do
   end subroutine run_chunk

   ! ---- listing -----------------------------------------------------------------------------------------------------

   !> Append the table of dimensions and the bands over the motion.
   subroutine list_tolerances(linear, sample, text)
      type(tolerance_t), intent(in) :: linear
      type(sample_t), intent(in) :: sample
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      real(wp), allocatable :: size_of(:)
      type(output_kind_t) :: kind
      integer :: v, i, k, worst

      kind = linear%problem%output%kind
      call text%add()
      call text%add(' EFFECT OF TOLERANCES ON THE OUTPUT')
      call text%add(' DIMENSION                          TOLERANCE  LARGEST EFFECT  AT POSITION')
      do v = 1, size(linear%tolerance)
         size_of = abs(linear%effect(:, v, 1))
         if (kind%components > 1) size_of = hypotenuse(linear%effect(:, v, 1), linear%effect(:, v, 2))
         worst = maxloc(size_of, dim=1)
         line = ' '//name_of(linear%problem%topology%variables(v))
         line = line//repeat(' ', max(1, 30 - len(line)))//general(linear%tolerance(v))
         if (kind%components > 1) then
            line = line//' '//general(size_of(worst))
         else
            line = line//' '//general(linear%effect(worst, v, 1))
         end if
         call text%add(line//'    '//to_text(worst))
      end do
      call text%add()
      if (kind%components == 2) then
         call text%add(' BANDS OF X, THEN OF Y (+-), AND WHAT THE SAMPLE DEVIATED')
      else if (kind%components == 3) then
         call text%add(' BANDS OF X, Y AND ANGLE (+-), AND WHAT THE SAMPLE DEVIATED')
      else
         call text%add(' BANDS OF THE OUTPUT (+-), AND WHAT THE SAMPLE DEVIATED')
      end if
      line = '          INPUT     WORST CASE ROOT SUM SQUARE'
      if (sample%any_closed) line = line//'         LOWEST        HIGHEST           MEAN   STD.DEVIATION'
      call text%add(line)
      do i = 1, size(linear%worst, 1)
         line = angle_text(linear%nominal%input(i))
         if (linear%dead(i)) then
            call text%add(line//'   DEAD POINT: THE EFFECTS ARE INFINITE')
            cycle
         end if
         do k = 1, kind%components
            if (k > 1) line = repeat(' ', 15)
            line = line//general(linear%worst(i, k))//' '//general(linear%square(i, k))
            if (sample%any_closed) line = line//general(sample%low(i, k))//general(sample%high(i, k))// &
                                          general(sample%mean(i, k))//' '//general(sample%deviation(i, k))
            call text%add(line)
         end do
      end do
      if (sample%trials == 0) return
      call text%add(' LINKAGES OF THE SAMPLE '//to_text(sample%trials)//', OF WHICH DO NOT CLOSE '//to_text(sample%open))
      do i = 1, min(sample%open, most_named)
         call text%add('   LINKAGE '//to_text(sample%named(i))//', LOOP '//to_text(sample%loop(i)))
      end do
      if (sample%open > most_named) call text%add('   AND '//to_text(sample%open - most_named)//' MORE')
   end subroutine list_tolerances

   !> A block of device 9: bands and sample at every position.
   subroutine plot_tolerances(title, linear, sample, text)
      character(*), intent(in) :: title
      type(tolerance_t), intent(in) :: linear
      type(sample_t), intent(in) :: sample
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: i, k

      if (text%length > 0) then
         call text%add()
         call text%add()
      end if
      line = '# input closed'
      do k = 1, linear%problem%output%kind%components
         line = line//' actual'//axis(k)//' worst_case'//axis(k)//' root_sum_square'//axis(k)
         if (sample%any_closed) line = line//' lowest'//axis(k)//' highest'//axis(k)//' mean'//axis(k)//' std_deviation'//axis(k)
      end do
      call text%add(line)
      call text%add('# '//title)
      call text%add('# tolerances: linear bands (+-), and deviations of a sample of '//to_text(sample%trials)//' linkages')
      do i = 1, size(linear%worst, 1)
         line = full_precision(linear%nominal%input(i))//' 1'
         do k = 1, linear%problem%output%kind%components
            line = line//' '//full_precision(linear%nominal%actual(i, k))
            if (linear%dead(i)) then
               line = line//' NaN NaN'
            else
               line = line//' '//full_precision(linear%worst(i, k))//' '//full_precision(linear%square(i, k))
            end if
            if (sample%any_closed) line = line//' '//full_precision(sample%low(i, k))//' '//full_precision(sample%high(i, k))// &
                                          ' '//full_precision(sample%mean(i, k))//' '//full_precision(sample%deviation(i, k))
         end do
         call text%add(line)
      end do

   contains

      pure function axis(k) result(suffix)
         integer, intent(in) :: k
         character(:), allocatable :: suffix

         suffix = trim(linear%problem%output%kind%suffix(k))
      end function axis
   end subroutine plot_tolerances
end module psalm_tolerance
