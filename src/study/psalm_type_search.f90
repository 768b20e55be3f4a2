!> Which linkage? Cases that want the same output share their starts by what they promise.
!>
!> Successive halving: all cases are searched from few starts, the better half of them, by the best objective, from twice as many,
!> and so on until one is left, which has all of its starts. A case is searched afresh each time; only the starts of its last round
!> are searched on from, when all rounds are over. What is kept of a case is what it would find alone with as many starts.
!>
!> Source: Jamieson and Talwalkar, Non-stochastic best arm identification and hyperparameter optimization (2016).
module psalm_type_search
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp
   use psalm_preparation, only: prepared_t
   use psalm_search, only: search_t
   use psalm_search_group, only: ranking_shared
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: shares_starts, share_starts

   integer, parameter :: fewest_starts = 4      !! of a round: less says nothing about a kind of linkage

   !> A case in the running.
   type :: contender_t
      type(search_t), allocatable :: search     !! the starts of its last round are made
   end type contender_t

contains

   !> A case that takes part where starts are shared.
   pure logical function shares_starts(set)
      type(data_set_t), intent(in) :: set

      shares_starts = set%search%ranking == ranking_shared .and. .not. allocated(set%search_in_poses) .and. .not. set%gives('EXACT')
   end function shares_starts

   !> Search all cases that share their starts: `found` of those that take part becomes what their last round led to. When the host
   !> asks for the end, the rounds so far count.
   subroutine share_starts(sets, prepared, threads, stop)
      type(data_set_t), intent(in), target :: sets(:)
      type(prepared_t), intent(inout) :: prepared(:) !! shape (cases)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop             !! asked now and then
      type(contender_t) :: contenders(size(sets))
      class(problem_t), allocatable :: problem
      real(wp) :: best(size(sets))
      logical :: left(size(sets))
      integer :: rounds, round, starts, k

      do k = 1, size(sets)
         left(k) = shares_starts(sets(k)) .and. prepared(k)%parameters%has_search()
      end do
      rounds = 1
      do while (2**(rounds - 1) < count(left))
         rounds = rounds + 1
      end do
      best = huge(best)
      do round = 1, rounds
         do k = 1, size(sets)
            if (.not. left(k)) cycle
            if (round > 1 .and. stop%waiting()) exit
            if (allocated(contenders(k)%search)) deallocate (contenders(k)%search)
            allocate (contenders(k)%search, problem)
            associate (most => sets(k)%search%nstart)
               starts = min(most, max(fewest_starts, most/2**(rounds - round)))
            end associate
            call make_problem(sets(k), prepared(k)%mechanism, prepared(k)%given, prepared(k)%parameters, problem)
            call problem%set_threads(threads)
            call contenders(k)%search%make_starts(sets(k), problem, prepared(k)%parameters%first_values(prepared(k)%given), &
                                                  prepared(k)%vertices, threads, stop, starts=starts)
            best(k) = contenders(k)%search%least_objective()
            deallocate (problem)
         end do
         call keep_better_half(best, left)
      end do
      do k = 1, size(sets)
         if (.not. allocated(contenders(k)%search)) cycle
         if (.not. allocated(prepared(k)%found)) allocate (prepared(k)%found)
         call contenders(k)%search%finish(prepared(k)%found)
      end do
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
