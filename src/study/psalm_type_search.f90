!> Which linkage? Cases that want the same output share their starts by what they promise.
!>
!> Successive halving: all cases are searched from few starts, the better half of them, by the best objective, from twice as many,
!> and so on until one is left, which has all of its starts. A case is searched afresh each time: what is kept of it is what
!> it would find alone with as many starts as its last round had.
!>
!> Source: Jamieson and Talwalkar, Non-stochastic best arm identification and hyperparameter optimization (2016).
module psalm_type_search
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp
   use psalm_preparation, only: prepared_t
   use psalm_search, only: result_t, search_many
   use psalm_search_group, only: ranking_shared
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: shared_search_t, shares_starts, share_starts

   !> What the search of a case found in its last round.
   type :: shared_search_t
      logical :: takes_part = .false.
      integer :: starts = 0                !! of that round
      type(result_t) :: found
   end type shared_search_t

contains

   !> A case that takes part where starts are shared.
   pure logical function shares_starts(set)
      type(data_set_t), intent(in) :: set

      shares_starts = set%search%ranking == ranking_shared .and. .not. allocated(set%no_loops) .and. .not. set%exact%given
   end function shares_starts

   !> Search all cases that share their starts; `search` is for each case of the file. NSTART of those that take part becomes what
   !> their last round had. When the host asks for the end, the rounds so far count.
   subroutine share_starts(sets, prepared, threads, stop, search)
      type(data_set_t), intent(inout) :: sets(:)
      type(prepared_t), intent(in) :: prepared(:)  !! shape (cases)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop             !! asked now and then
      type(shared_search_t), allocatable, intent(out) :: search(:) !! shape (cases)
      type(data_set_t), allocatable :: set
      type(problem_t), allocatable :: problem
      real(wp) :: best(size(sets))
      logical :: left(size(sets))
      integer :: rounds, round, k

      allocate (search(size(sets)))
      do k = 1, size(sets)
         search(k)%takes_part = shares_starts(sets(k)) .and. prepared(k)%parameters%has_search()
      end do
      left = search%takes_part
      rounds = 1
      do while (2**(rounds - 1) < count(left))
         rounds = rounds + 1
      end do
      best = huge(best)
      do round = 1, rounds
         do k = 1, size(sets)
            if (.not. left(k)) cycle
            if (round > 1 .and. stop%waiting()) exit
            allocate (set, source=sets(k))
            allocate (problem)
            set%search%nstart = max(1, sets(k)%search%nstart/2**(rounds - round))
            call make_problem(set, prepared(k)%mechanism, prepared(k)%given, prepared(k)%parameters, problem)
            call problem%set_threads(threads)
            call search_many(set, problem, prepared(k)%parameters%first_values(prepared(k)%given), prepared(k)%vertices, threads, &
                             stop, search(k)%found)
            search(k)%starts = set%search%nstart
            best(k) = huge(best)
            if (size(search(k)%found%best) > 0) best(k) = search(k)%found%best(1)%objective
            deallocate (set, problem)
         end do
         call keep_better_half(best, left)
      end do
      where (search%takes_part) sets%search%nstart = search%starts
   end subroutine share_starts

   !> Of those left the better half, rounded up; of equals the first.
   pure subroutine keep_better_half(best, left)
      real(wp), intent(in) :: best(:)
      logical, intent(inout) :: left(:)
      logical :: kept(size(left))
      integer :: i, k

      kept = .false.
      do i = 1, (count(left) + 1)/2
         k = minloc(best, dim=1, mask=left .and. .not. kept)
         kept(k) = .true.
      end do
      left = kept
   end subroutine keep_better_half
end module psalm_type_search
