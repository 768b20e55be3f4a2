!> Place, size, direction and output point of a linkage solved for: by linkages that go through the points, and against the merit.
program test_linear_unknowns
   use check, only: checks_t
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp, full_turn
   use psalm_linear_unknowns, only: linear_unknowns_t, prepare_linear_unknowns, solve_linear_unknowns
   use psalm_merit, only: merit_t, prepare_merit, eliminate_linear
   use psalm_preparation, only: prepared_t, prepare
   use psalm_source, only: line_t
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples
   use psalm_status, only: diagnostics_t
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   type(checks_t) :: t
   type(data_set_t), allocatable :: sets(:)
   type(diagnostics_t) :: findings
   integer :: k

   call read_cases('data/types/ten_for_corner.nml', sets, findings)
   call t%is_true(size(sets) == 10, 'ten kinds of linkage')
   do k = 1, size(sets)
      call back_to_points(sets(k))
   end do
   call fixed_frame(sets(5))
   call t%report()

contains

   subroutine make(set, problem, merit)
      type(data_set_t), intent(inout) :: set
      type(problem_t), intent(out) :: problem
      type(merit_t), intent(out) :: merit
      class(prepared_t), allocatable :: prepared
      type(line_t), allocatable :: none(:)

      allocate (prepared, none(0))
      call prepare(set, none, prepared, findings)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call prepare_merit(set, problem, problem%parameters%first_values(problem%given), merit)
   end subroutine make

   !> Points on the curve of the given linkage are wanted; enlarged, turned and moved elsewhere, with a wrong output point, it comes
   !> back to them. And no other place, size, direction or output point of a distorted one is better than the one solved for.
   subroutine back_to_points(set)
      type(data_set_t), intent(inout) :: set
      class(problem_t), allocatable :: problem
      class(merit_t), allocatable :: merit
      class(sample_set_t), allocatable :: samples
      type(linear_unknowns_t), allocatable :: linear
      type(xoshiro_t) :: random
      real(wp), allocatable :: values(:), first(:), x(:), near(:), delt(:)
      real(wp) :: objective, other, violation, deviate
      integer :: i, v, trial, which(4)
      logical, allocatable :: lengths(:)
      logical :: solved

      allocate (problem, merit, samples, linear)
      call make(set, problem, merit)
      first = problem%parameters%first_values(problem%given)
      call prepare_samples(problem, problem%delt, .false., reshape([integer ::], [2, 0]), .false., samples)
      call evaluate_samples(samples, problem%given)
      problem%wanted(:problem%positions, :) = samples%out
      call prepare_linear_unknowns(problem, .true., merit%low, merit%high, linear)
      call t%is_true(linear%applies, trim(set%title)//': it applies')
      if (.not. linear%applies) return
      values = first
      where (linear%grows) values = 0.6_wp*values
      where (linear%turns) values = values + 111.0_wp
      values(linear%origlk) = 7.0_wp
      values(linear%outlk) = 3.0_wp
      values(linear%outang) = 200.0_wp
      delt = problem%delt + 111.0_wp
      call solve_linear_unknowns(linear, merit%low, merit%high, values, delt, solved)
      lengths = linear%grows
      lengths([linear%outlk, linear%origlk]) = .true.
      call t%is_true(solved, trim(set%title)//': solved')
      call t%is_true(all(abs(values - first) < 1.0e-8_wp*maxval(abs(first)) .or. .not. lengths), &
                     trim(set%title)//': back to its lengths')
      call t%is_true(all(abs(modulo(values - first + 0.5_wp*full_turn, full_turn) - 0.5_wp*full_turn) < 1.0e-7_wp .or. lengths), &
                     trim(set%title)//': and angles')
      ! the minimum: by the merit, with the points of the data set
      call eliminate_linear(merit)
      x = merit%point(first, problem%delt)
      call merit%fit_linear(x)
      call merit%measure(x, objective, violation)
      call random%seed(3, purpose_starts)
      do trial = 1, 20
         near = x
         call random%next(deviate)
         associate (growth => 1.0_wp + 0.02_wp*(deviate - 0.5_wp))
            where (merit%linear%grows) near(:merit%core) = growth*near(:merit%core)
         end associate
         call random%next(deviate)
         where (merit%linear%turns) near(:merit%core) = near(:merit%core) + (deviate - 0.5_wp)
         near(merit%core + 1:) = near(merit%core + 1:) + (deviate - 0.5_wp)
         which = [merit%linear%origlk, merit%linear%origng, merit%linear%outlk, merit%linear%outang]
         do i = 1, size(which)
            v = which(i)
            call random%next(deviate)
            near(v) = near(v) + 0.1_wp*(deviate - 0.5_wp)
         end do
         call merit%measure(near, other, violation)
         if (other < objective) exit
      end do
      call t%is_true(trial > 20, trim(set%title)//': no neighbour is better')
   end subroutine back_to_points

   !> Where the frame of the second loop has a direction of its own that does not vary, the whole cannot be turned.
   subroutine fixed_frame(set)
      type(data_set_t), intent(in) :: set
      class(data_set_t), allocatable :: fixed
      class(problem_t), allocatable :: problem
      class(merit_t), allocatable :: merit

      allocate (problem, merit)
      allocate (fixed, source=set)
      fixed%method%ivg = 0
      fixed%limits%oplow = -1.0e3_wp
      fixed%limits%ophigh = 1.0e3_wp
      call make(fixed, problem, merit)
      call eliminate_linear(merit)
      call t%is_true(.not. allocated(merit%linear), 'a frame whose direction is given is not turned')
   end subroutine fixed_frame
end program test_linear_unknowns
