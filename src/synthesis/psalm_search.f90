!> Searches from many starts: the user's linkage and others drawn round it, each improved by least squares, the best kept.
!>
!> Start i takes its random numbers from a place of the sequence that depends on i alone, and the linkages found are ranked
!> afterwards: the same input gives the same answer for any number of threads (unless time runs out).
module psalm_search
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_constr, only: constraints_t, repair_count_t, make_constraints, constrain
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, dp, i8, degrees_per_radian, right_angle
   use psalm_lsq, only: lsq_t, prepare_lsq, improve
   use psalm_random, only: random_t
   use psalm_start, only: random_limits
   use psalm_text, only: text_t, general, to_text
   use psalm_topology, only: dimensions_t, variable_length, variable_outlk
   implicit none (type, external)
   private
   public :: found_t, result_t, search_many, transmission_margin

   real(wp), parameter :: same_linkage = 1.0e-3_wp !! relative difference below which two results are one

   !> A linkage found.
   type :: found_t
      real(wp), allocatable :: values(:)   !! shape (marble)
      real(wp), allocatable :: delt(:)     !! shape (positions): input increments (those given, but for free timing)
      real(wp) :: objective = 0.0_wp
      integer :: start = 0                 !! the start that led to it
      real(wp) :: distance = 0.0_wp        !! from the first linkage: largest relative change of a value
   end type found_t

   !> What a search from many starts found.
   type :: result_t
      type(found_t), allocatable :: best(:) !! shape (at most NBEST): distinct, the best first
      integer :: starts = 0                !! starts made
      integer :: feasible = 0              !! of which led to a linkage that obeys every constraint
      integer :: evaluations = 0, jacobians = 0
      logical :: out_of_time = .false.     !! MAXTIME passed before NSTART was reached
   end type result_t

   !> What one thread works with.
   type :: worker_t
      type(problem_t) :: problem
      type(constraints_t) :: constraints
      type(lsq_t) :: lsq
   end type worker_t

contains

   !> Search from NSTART starts. `first` is the user's linkage (or the first supplied vertex).
   subroutine search_many(set, problem, first, threads, result, device1)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: first(:)          !! shape (marble)
      integer, intent(in) :: threads
      type(result_t), intent(out) :: result
      type(text_t), intent(inout) :: device1
      type(worker_t), allocatable :: workers(:)
      real(wp), allocatable :: values(:, :), delt(:, :), objective(:)
      logical, allocatable :: feasible(:), done(:)
      integer, allocatable :: evaluations(:), jacobians(:)
      integer(int64) :: begun
      integer :: t, i

      call system_clock(begun)
      allocate (workers(min(max(1, threads), set%nstart)))
      do t = 1, size(workers)
         workers(t)%problem = problem
         call make_constraints(set, problem, workers(t)%constraints)
         call prepare_lsq(set, problem, first, workers(t)%lsq)
      end do
      allocate (values(size(first), set%nstart), objective(set%nstart), source=0.0_wp)
      allocate (delt(problem%positions, set%nstart), source=0.0_wp)
      allocate (feasible(set%nstart), done(set%nstart), source=.false.)
      allocate (evaluations(set%nstart), jacobians(set%nstart), source=0)
      !$omp parallel do num_threads(size(workers)) schedule(static) private(i)
      do t = 1, size(workers)
         do i = t, set%nstart, size(workers)
            if (i > size(workers) .and. time_is_up(set, begun)) exit
            call one_start(set, workers(t), first, i, values(:, i), delt(:, i), objective(i), feasible(i), evaluations(i), &
                           jacobians(i))
            done(i) = .true.
         end do
      end do
      !$omp end parallel do
      result%starts = count(done)
      result%feasible = count(feasible)
      result%evaluations = sum(evaluations)
      result%jacobians = sum(jacobians)
      result%out_of_time = .not. all(done)
      do i = 1, set%nstart
         if (.not. done(i)) cycle
         if (feasible(i)) then
            call device1%add(' START '//to_text(i)//'  OBJECTIVE'//general(objective(i))//'  EVALUATIONS '// &
                             to_text(evaluations(i))//'  JACOBIANS '//to_text(jacobians(i)))
         else
            call device1%add(' START '//to_text(i)//'  NO LINKAGE THAT OBEYS THE CONSTRAINTS')
         end if
      end do
      call rank(set, is_length(problem), first, values, delt, objective, feasible, result%best)
   end subroutine search_many

   logical function time_is_up(set, begun)
      type(data_set_t), intent(in) :: set
      integer(int64), intent(in) :: begun
      integer(int64) :: now, rate

      time_is_up = .false.
      if (set%maxtime <= 0.0_wp) return
      call system_clock(now, rate)
      time_is_up = real(now - begun, dp)/real(rate, dp) > real(set%maxtime, dp)
   end function time_is_up

   !> Start i: draw it, make it close, improve it.
   subroutine one_start(set, worker, first, i, values, delt, objective, feasible, evaluations, jacobians)
      type(data_set_t), intent(in) :: set
      type(worker_t), intent(inout) :: worker
      real(wp), intent(in) :: first(:)
      integer, intent(in) :: i
      real(wp), intent(out) :: values(:), delt(:), objective
      logical, intent(out) :: feasible
      integer, intent(out) :: evaluations, jacobians
      type(random_t) :: random
      type(repair_count_t) :: counts
      real(wp), allocatable :: low(:), high(:), home(:)
      real(wp) :: deviate
      integer :: v

      evaluations = 0
      jacobians = 0
      home = first
      call constrain(worker%problem, worker%constraints, home, objective, feasible, evaluations, counts)
      values = home
      if (i > 1) then
         call random_limits(set, first, low, high)
         random%state = int(set%istart, i8)
         call random%skip(int(i - 2, i8)*int(size(first), i8))
         do v = 1, size(first)
            call random%next(deviate)
            values(v) = low(v) + deviate*(high(v) - low(v))
         end do
         if (feasible) then
            call constrain(worker%problem, worker%constraints, values, objective, feasible, evaluations, counts, towards=home)
         else
            call constrain(worker%problem, worker%constraints, values, objective, feasible, evaluations, counts)
         end if
      end if
      worker%lsq%evaluations = 0
      worker%lsq%jacobians = 0
      ! a start that closes but breaks another limit may still lead somewhere
      worker%lsq%delt = worker%problem%delt
      call improve(worker%lsq, values, objective, feasible)
      delt = worker%lsq%delt
      evaluations = evaluations + worker%lsq%evaluations
      jacobians = worker%lsq%jacobians
   end subroutine one_start

   !> Sort what was found and keep the best distinct linkages.
   !>
   !> Two results are one linkage if their lengths and objectives agree: it may stand turned in the machine.
   subroutine rank(set, lengths, first, values, delt, objective, feasible, best)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: lengths(:)           !! shape (marble): values to compare
      real(wp), intent(in) :: first(:), values(:, :), delt(:, :), objective(:)
      logical, intent(in) :: feasible(:)
      type(found_t), allocatable, intent(out) :: best(:)
      logical :: left(size(feasible))
      type(found_t) :: next
      integer :: i, k

      allocate (best(0))
      left = feasible
      do while (any(left) .and. size(best) < set%nbest)
         i = minloc(objective, dim=1, mask=left)
         next%values = values(:, i)
         next%delt = delt(:, i)
         next%objective = objective(i)
         next%start = i
         next%distance = maxval(abs(values(:, i) - first)/max(abs(first), same_linkage))
         best = [best, next]
         do k = 1, size(left)
            if (.not. left(k)) cycle
            left(k) = any(lengths .and. abs(values(:, k) - next%values) > same_linkage*abs(next%values)) .or. &
                      objective(k) - next%objective > same_linkage*max(next%objective, set%fmin)
         end do
         left(i) = .false.
      end do
   end subroutine rank

   !> Which variables are lengths; all, if none is.
   pure function is_length(problem) result(lengths)
      type(problem_t), intent(in) :: problem
      logical, allocatable :: lengths(:)

      lengths = problem%topology%variables%kind == variable_length .or. problem%topology%variables%kind == variable_outlk
      if (.not. any(lengths)) lengths = .true.
   end function is_length

   !> Degrees that the worst transmission angle is inside its limits, over all link pairs that are solved and all positions.
   !>
   !> 90 if there is no link pair.
   real(wp) function transmission_margin(problem, dimensions) result(margin)
      type(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      integer :: block, offset, n, i, loop
      real(wp) :: cosine

      margin = right_angle
      call problem%bind(dimensions)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         do loop = 1, problem%topology%nloop
            if (problem%linkage%step_of_loop(loop) == 0 .or. problem%topology%joint(loop) /= 1) cycle
            associate (dyad => problem%linkage%steps(problem%linkage%step_of_loop(loop)), row => problem%linkage%reach(loop))
               do i = 0, n - 1
                  cosine = (dyad%p**2 + dyad%q**2 - problem%linkage%store(row + i))/(2.0_wp*dyad%p*dyad%q)
                  margin = min(margin, problem%tangle - asin(min(1.0_wp, abs(cosine)))*degrees_per_radian)
               end do
            end associate
         end do
      end do
   end function transmission_margin
end module psalm_search
