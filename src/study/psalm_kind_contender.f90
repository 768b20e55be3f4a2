!> An assembly of a kind of linkages in the running of a search over kinds: its screening, more starts, the search of its best to
!> the end. Here, where the work is shared, these are numbered items of batches: a screening and the last search are one item for
!> each assembly, and every start is one (all starts of an assembly that is searched in stages).
!>
!> A host that shares has all results on every process. So an assembly has its results alone there, and every thread has one search
!> at its desk, prepared for the assembly of its last item. Without such a host every assembly keeps a search of its own
!> (`psalm_kind_search`). Both come to the same results.
module psalm_kind_contender
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp
   use psalm_multistart, only: candidate_t, numbers_of, take_numbers, promise_of
   use psalm_preparation, only: prepared_t
   use psalm_search, only: search_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: kind_contender_t, prepare_search, screen_shared, search_shared, finish_shared, hits_of

   type :: kind_contender_t
      integer :: kind = 0
      type(data_set_t), pointer :: set => null()
      class(prepared_t), allocatable :: prepared
      type(search_t), allocatable :: search    !! not allocated where the work is shared
      type(candidate_t), allocatable :: candidates(:) !! what its starts came to, where the work is shared
      real(wp) :: best = huge(1.0_wp)          !! objective
      real(wp) :: promise = huge(1.0_wp)       !! what it is ranked by before the rounds end
      integer :: starts = 0                    !! searched to their ends
      logical :: screened = .false.
      integer, allocatable :: signs(:)         !! of its loops: which assembly it is
   end type kind_contender_t

   !> An item of a round: some starts of an assembly.
   type :: portion_t
      integer :: of = 0                        !! number of the assembly
      integer :: before = 0                    !! starts of it in the same batch that belong to other items
      integer :: starts = 0
   end type portion_t

contains

   !> A search of an assembly. Without `screenings` no start is made.
   subroutine prepare_search(one, stop, screenings, search)
      type(kind_contender_t), intent(in) :: one      !! NSTART of its set is 1
      type(stop_t), intent(in) :: stop          !! asked while the screenings are made
      integer, intent(in) :: screenings         !! starts that are cut short
      type(search_t), allocatable, intent(out) :: search
      class(problem_t), allocatable :: problem

      allocate (search, problem)
      call make_problem(one%set, one%prepared%mechanism, one%prepared%given, one%prepared%parameters, problem)
      call problem%set_threads(1)
      call search%make_starts(one%set, problem, one%prepared%parameters%first_values(one%prepared%given), &
                              one%prepared%vertices, 1, stop, starts=screenings, hasty=.true.)
   end subroutine prepare_search

   !> How many starts led to the best objective, but for a part of it.
   pure integer function hits_of(one, part) result(hits)
      type(kind_contender_t), intent(in) :: one
      real(wp), intent(in) :: part

      hits = 0
      if (allocated(one%search)) then
         hits = one%search%hits(part)
      else if (allocated(one%candidates)) then
         hits = count(one%candidates%feasible .and. one%candidates%objective <= (1.0_wp + part)*one%best)
      end if
   end function hits_of

   !> Few random linkages of each.
   subroutine screen_shared(contenders, threads, stop, handicap)
      type(kind_contender_t), intent(inout) :: contenders(:)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      real(wp), intent(in) :: handicap          !! of linkages that do not obey
      real(wp), allocatable :: numbers(:)
      integer :: i, t

      do i = 1, size(contenders)
         contenders(i)%set%search%nstart = 1
      end do
      call stop%open_batch('screenings', size(contenders))
      !$omp parallel do num_threads(threads) schedule(static)
      do t = 1, threads
         call screen_some(contenders, stop)
      end do
      !$omp end parallel do
      call stop%close_batch()
      do i = 1, size(contenders)
         call stop%take_item(i, numbers)
         if (.not. allocated(numbers)) cycle
         allocate (contenders(i)%candidates(0))
         call add_results(contenders(i), numbers)
         contenders(i)%screened = .true.
         call rate(contenders(i), handicap)
      end do
   end subroutine screen_shared

   !> The screenings of one thread.
   subroutine screen_some(contenders, stop)
      type(kind_contender_t), intent(in) :: contenders(:)
      type(stop_t), intent(in) :: stop
      type(search_t), allocatable :: search
      type(candidate_t), allocatable :: candidates(:)
      integer :: i

      do
         if (stop%waiting()) return
         i = stop%next_item(0, 1, size(contenders))
         if (i > size(contenders)) return
         call prepare_search(contenders(i), stop%within_item(), 1, search)
         if (stop%waiting()) return
         call search%made(candidates)
         call stop%keep_item(i, packed(candidates))
      end do
   end subroutine screen_some

   !> So many starts more of each of those left.
   subroutine search_shared(contenders, left, starts, most, threads, stop, handicap)
      type(kind_contender_t), intent(inout) :: contenders(:)
      logical, intent(in) :: left(:)
      integer, intent(in) :: starts, most       !! at this time, and of an assembly in all
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      real(wp), intent(in) :: handicap          !! as `screen_shared` has it
      type(portion_t), allocatable :: portions(:)
      type(candidate_t), allocatable :: blank(:)
      real(wp), allocatable :: numbers(:)
      integer :: i, k, t, before, wanted

      allocate (portions(0))
      do k = 1, size(contenders)
         if (.not. left(k)) cycle
         wanted = min(starts, most - contenders(k)%starts)
         if (contenders(k)%set%search%few > 0) then
            portions = [portions, portion_t(k, 0, wanted)]
         else
            portions = [portions, (portion_t(k, i - 1, 1), i=1, wanted)]
         end if
      end do
      call stop%open_batch('kinds', size(portions))
      !$omp parallel do num_threads(threads) schedule(static)
      do t = 1, threads
         call search_some(contenders, portions, stop)
      end do
      !$omp end parallel do
      call stop%close_batch()
      do i = 1, size(portions)
         associate (one => contenders(portions(i)%of))
            call stop%take_item(i, numbers)
            if (allocated(numbers)) then
               call add_results(one, numbers)
            else
               ! cut short: nothing is known of these starts
               before = size(one%candidates)
               allocate (blank(before + portions(i)%starts))
               blank(:before) = one%candidates
               call move_alloc(blank, one%candidates)
            end if
            one%starts = one%starts + portions(i)%starts
            call rate(one, handicap)
         end associate
      end do
   end subroutine search_shared

   !> The starts of one thread.
   subroutine search_some(contenders, portions, stop)
      type(kind_contender_t), intent(in) :: contenders(:)
      type(portion_t), intent(in) :: portions(:)
      type(stop_t), intent(in) :: stop
      type(search_t), allocatable :: desk
      type(candidate_t), allocatable :: candidates(:)
      integer :: i, at, before

      at = 0
      do
         if (stop%waiting()) return
         i = stop%next_item(0, 1, size(portions))
         if (i > size(portions)) return
         associate (portion => portions(i), one => contenders(portions(i)%of))
            if (portion%of /= at) call prepare_search(one, stop%within_item(), 0, desk)
            at = portion%of
            call desk%end_by(stop%within_item())
            before = size(one%candidates) + portion%before
            allocate (candidates(before))
            candidates(:size(one%candidates)) = one%candidates
            call desk%go_on_from(candidates)
            call desk%make_more_starts(portion%starts)
            if (stop%waiting()) return
            call desk%made(candidates)
            call stop%keep_item(i, packed(candidates(before + 1:)))
            deallocate (candidates)
         end associate
      end do
   end subroutine search_some

   !> Search on from the best of those chosen, and note what was found.
   subroutine finish_shared(contenders, chosen, threads, stop)
      type(kind_contender_t), intent(inout) :: contenders(:)
      integer, intent(in) :: chosen(:)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      type(search_t), allocatable :: search
      real(wp), allocatable :: numbers(:)
      integer :: k, t, count

      call stop%open_batch('finished', size(chosen))
      !$omp parallel do num_threads(threads) schedule(static)
      do t = 1, threads
         call finish_some(contenders, chosen, stop)
      end do
      !$omp end parallel do
      call stop%close_batch()
      do k = 1, size(chosen)
         associate (one => contenders(chosen(k)))
            call stop%take_item(k, numbers)
            call prepare_search(one, stop%within_item(), 0, search)
            call search%end_by(stop%within_item())
            if (allocated(numbers)) then
               count = nint(numbers(1))
               deallocate (one%candidates)
               allocate (one%candidates(0))
               call add_results(one, numbers(count + 2:))
               call search%go_on_from(one%candidates, nint(numbers(2:count + 1)))
            else
               call search%go_on_from(one%candidates)
               call search%search_on(further=.false.)
            end if
            allocate (one%prepared%found)
            call search%report(one%prepared%found)
         end associate
      end do
   end subroutine finish_shared

   !> The last searches of one thread.
   subroutine finish_some(contenders, chosen, stop)
      type(kind_contender_t), intent(in) :: contenders(:)
      integer, intent(in) :: chosen(:)
      type(stop_t), intent(in) :: stop
      type(search_t), allocatable :: search
      type(candidate_t), allocatable :: candidates(:)
      integer, allocatable :: best(:)
      integer :: i

      do
         if (stop%waiting()) return
         i = stop%next_item(0, 1, size(chosen))
         if (i > size(chosen)) return
         call prepare_search(contenders(chosen(i)), stop%within_item(), 0, search)
         call search%end_by(stop%within_item())
         call search%go_on_from(contenders(chosen(i))%candidates)
         call search%search_on(further=.true.)
         if (stop%waiting()) return
         call search%made(candidates, best)
         call stop%keep_item(i, [real(size(best), wp), real(best, wp), packed(candidates)])
      end do
   end subroutine finish_some

   !> What is ranked of an assembly, from the results of its starts.
   pure subroutine rate(one, handicap)
      type(kind_contender_t), intent(inout) :: one
      real(wp), intent(in) :: handicap

      one%best = minval(one%candidates%objective, mask=one%candidates%feasible)
      one%promise = promise_of(one%candidates, handicap)
   end subroutine rate

   !> Candidates in numbers, each after how many numbers it has.
   pure function packed(candidates) result(numbers)
      type(candidate_t), intent(in) :: candidates(:)
      real(wp), allocatable :: numbers(:)
      integer :: i

      allocate (numbers(0))
      do i = 1, size(candidates)
         associate (one => numbers_of(candidates(i)))
            numbers = [numbers, real(size(one), wp), one]
         end associate
      end do
   end function packed

   !> Append the candidates that numbers describe.
   pure subroutine add_results(one, numbers)
      type(kind_contender_t), intent(inout) :: one
      real(wp), intent(in) :: numbers(:)       !! by `packed`
      type(candidate_t), allocatable :: longer(:)
      integer :: at, length, made

      made = 0
      at = 1
      do while (at <= size(numbers))
         made = made + 1
         at = at + 1 + nint(numbers(at))
      end do
      allocate (longer(size(one%candidates) + made))
      longer(:size(one%candidates)) = one%candidates
      made = size(one%candidates)
      call move_alloc(longer, one%candidates)
      at = 1
      do while (at <= size(numbers))
         made = made + 1
         length = nint(numbers(at))
         call take_numbers(numbers(at + 1:at + length), one%candidates(made))
         at = at + 1 + length
      end do
   end subroutine add_results
end module psalm_kind_contender
