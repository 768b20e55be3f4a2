!> Tolerances: the linear bands against linkages that really deviate, and a sample that does not depend on threads.
program test_tolerance
   use cases, only: load_case
   use check, only: checks_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp
   use psalm_tolerance, only: deviating_t, tolerance_t, sample_t, find_tolerances, draw_sample
   use psalm_dimensions, only: dimensions_t
   use psalm_xoshiro, only: xoshiro_t, purpose_sample
   implicit none (type, external)
   type(checks_t) :: t

   call bands('needle', 0.01_wp, 0.005_wp)
   call bands('suspension', 0.0_wp, 0.0_wp)
   call bands('dyad4_slider_crank', 0.01_wp, 0.0_wp)
   call bands('textile', 0.001_wp, 0.001_wp)
   call one_dimension()
   call streams()
   call open_linkages()
   call without_outputs()
   call t%report()

contains

   subroutine set_tolerances(set, of_lengths, of_angles)
      type(data_set_t), intent(inout) :: set
      real(wp), intent(in) :: of_lengths, of_angles

      set%toler%given = .true.
      set%toler%tolarc = of_lengths
      set%toler%tolgam = of_angles
      set%toler%toloua = of_angles
   end subroutine set_tolerances

   !> Small tolerances: spread of the sample is root-sum-square over sqrt(3), and all of it lies in the worst-case band.
   subroutine bands(name, of_lengths, of_angles)
      character(*), intent(in) :: name
      real(wp), intent(in) :: of_lengths, of_angles
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      class(deviating_t), allocatable :: deviating
      class(tolerance_t), allocatable :: linear
      type(sample_t) :: sample, shared
      logical :: closes
      integer, parameter :: trials = 20500

      allocate (problem, set, deviating, linear)
      call load_case(name, problem, set)
      call set_tolerances(set, of_lengths, of_angles)
      call find_tolerances(set, problem%mechanism, problem%given, deviating, linear, closes)
      if (name == 'suspension') then
         call t%is_true(.not. closes, 'a linkage that does not close has no tolerances')
         return
      end if
      call t%is_true(closes, name//': closes')
      call draw_sample(deviating, linear, trials, 19, 1, sample)
      call t%equal_integer(sample%open, 0, name//': every linkage of the sample closes')
      call t%is_true(all(abs(sample%deviation*sqrt(3.0_wp) - linear%square) <= 0.03_wp*linear%square + 1.0e-12_wp), &
                     name//': spread of the sample is that of the linear band')
      call t%is_true(all(sample%high <= 1.02_wp*linear%worst + 1.0e-12_wp .and. &
                         sample%low >= -1.02_wp*linear%worst - 1.0e-12_wp), name//': the sample lies in the worst case')
      call t%is_true(all(linear%square <= linear%worst*(1.0_wp + 1.0e-12_wp)), name//': root sum square is below the worst case')
      call draw_sample(deviating, linear, 1, 19, 1, shared)
      call t%is_true(all(abs(shared%mean - shared%low) <= 0.0_wp) .and. all(abs(shared%mean - shared%high) <= 0.0_wp) .and. &
                     any(abs(shared%mean) > 0.0_wp), name//': the mean of one linkage is that linkage')
      call draw_sample(deviating, linear, trials, 19, 3, shared)
      call t%is_true(all(abs(sample%mean - shared%mean) + abs(sample%deviation - shared%deviation) + &
                         abs(sample%low - shared%low) <= 0.0_wp), name//': the same bits for any number of threads')
   end subroutine bands

   !> A sketch that names no output: its last joint is the output, and no output is looked at that is not there.
   subroutine without_outputs()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      class(deviating_t), allocatable :: deviating
      class(tolerance_t), allocatable :: named, nameless
      logical :: closes

      allocate (problem, set, deviating, named, nameless)
      call load_case('sketch_slider_crank', problem, set)
      set%toler%given = .true.
      set%toler%tollen = 0.01_wp
      set%toler%tolang = 0.01_wp
      call find_tolerances(set, problem%mechanism, problem%given, deviating, named, closes)
      set%sketch%outputs = set%sketch%outputs(:0)
      call find_tolerances(set, problem%mechanism, problem%given, deviating, nameless, closes)
      call t%is_true(closes, 'a sketch without outputs: closes')
      call t%equal_integer(size(nameless%worst), size(named%worst), 'a sketch without outputs: as many bands')
      call t%is_true(all(abs(nameless%worst - named%worst) <= 0.0_wp), 'a sketch without outputs: the bands of its last joint')
   end subroutine without_outputs

   !> One dimension alone: its effect is a difference of two linkages.
   subroutine one_dimension()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(deviating_t), save :: deviating
      type(tolerance_t), save :: linear
      type(motion_t), save :: plus, minus
      type(dimensions_t), save :: dimensions
      logical :: closes
      real(wp), parameter :: tolerance = 1.0e-3_wp

      call load_case('dyad4_slider_crank', problem, set)
      set%toler%given = .true.
      set%toler%tolarc(2, 1) = tolerance
      call find_tolerances(set, problem%mechanism, problem%given, deviating, linear, closes)
      call t%equal_integer(size(linear%tolerance), 1, 'one tolerance, one variable')
      dimensions = problem%given
      dimensions%arcl(2) = problem%given%arcl(2) + tolerance
      call problem%analyse(dimensions, plus)
      dimensions%arcl(2) = problem%given%arcl(2) - tolerance
      call problem%analyse(dimensions, minus)
      call t%close_to(maxval(abs((plus%actual(:, 1) - minus%actual(:, 1))/2.0_wp - linear%effect(:, 1, 1))), 0.0_wp, 1.0e-10_wp, &
                      'the effect of one dimension')
   end subroutine one_dimension

   !> Linkages 1 and 1001 of a sample are those of the first numbers of streams 0 and 1.
   subroutine streams()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(deviating_t), save :: deviating
      type(tolerance_t), save :: linear
      type(sample_t), save :: before, sample
      type(motion_t), save :: motion
      type(dimensions_t), save :: dimensions
      type(xoshiro_t), save :: random
      logical :: closes
      real(wp) :: deviate
      real(wp), allocatable :: deviation(:)
      integer :: stream
      integer, parameter :: of_stream = 1000, seed = 19
      real(wp), parameter :: tolerance = 0.5_wp

      call load_case('dyad4_slider_crank', problem, set)
      set%toler%given = .true.
      set%toler%tolarc(2, 1) = tolerance
      call find_tolerances(set, problem%mechanism, problem%given, deviating, linear, closes)
      call random%seed(seed, purpose_sample)
      do stream = 0, 1
         call draw_sample(deviating, linear, stream*of_stream + 1, seed, 1, sample)
         deviation = sample%mean(:, 1)*real(sample%trials, wp)
         if (stream > 0) then
            call draw_sample(deviating, linear, stream*of_stream, seed, 1, before)
            deviation = deviation - before%mean(:, 1)*real(before%trials, wp)
         end if
         call random%use_stream(stream)
         call random%next(deviate)
         dimensions = problem%given
         dimensions%arcl(2) = problem%given%arcl(2) + tolerance*(2.0_wp*deviate - 1.0_wp)
         call problem%analyse(dimensions, motion)
         call t%close_to(maxval(abs(deviation - (motion%actual(:, 1) - linear%nominal%actual(:, 1)))), 0.0_wp, 1.0e-10_wp, &
                         'the first linkage of a stream')
      end do
   end subroutine streams

   !> Linkages of the sample that do not close are counted and named.
   subroutine open_linkages()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(deviating_t), save :: deviating
      type(tolerance_t), save :: linear
      type(sample_t), save :: sample
      logical :: closes

      call load_case('hard/toggle', problem, set, 3)
      call set_tolerances(set, 1.0e-3_wp, 0.0_wp)
      call find_tolerances(set, problem%mechanism, problem%given, deviating, linear, closes)
      call t%is_true(closes, 'near toggle: the nominal linkage closes')
      call draw_sample(deviating, linear, 2000, 19, 2, sample)
      call t%is_true(sample%open > 0 .and. sample%open < 2000, 'near toggle: some linkages of the sample do not close')
      call t%is_true(sample%named(1) > 0 .and. sample%loop(1) == 1, 'near toggle: they are named')
   end subroutine open_linkages
end program test_tolerance
