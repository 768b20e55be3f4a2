!> Searches from many starts by a team of threads: each start improved by itself, the best and distinct results kept.
!>
!> Starts may be made in stages: all at the first, the better half of a round at the second, and so on; each stage knows more of the
!> problem and is dearer. Source: successive halving, Jamieson and Talwalkar (2016).
!>
!> What a start leads to depends on its number and on the best results of the rounds before alone, and results are ranked
!> afterwards: the same input gives the same answer for any number of threads (unless time runs out).
module psalm_multistart
   use psalm_kinds, only: wp
   use psalm_solver, only: observer_t, search_state_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: starter_t, candidate_t, multistart_t
   public :: numbers_of, take_numbers, promise_of

   real(wp), parameter :: same = 1.0e-3_wp         !! relative difference of objectives that are the same
   real(wp), parameter :: tie = 1.0e-6_wp          !! and of those that count as equal
   real(wp), parameter :: along_valley = 10.0_wp   !! times as much must results differ whose objectives are the same
   real(wp), parameter :: alike = 0.1_wp           !! relative difference below which two results are one to draw near
   real(wp), parameter :: near = 0.05_wp           !! relative difference of objectives above which two results are not one
   integer, parameter :: most_rounds = 8           !! results of the rounds before are shown to the starts of the next
   integer, parameter :: least_of_round = 16       !! starts
   integer, parameter :: most_refinements = 64     !! times further results are searched on, because those before became one
   integer, parameter :: most_strayed = 16         !! results that strayed, after which no others are searched on in their place

   !> What one start led to.
   type :: candidate_t
      real(wp), allocatable :: x(:)        !! unknowns
      real(wp) :: objective = 0.0_wp
      real(wp) :: promise = 0.0_wp         !! stages: the less it is the sooner the start goes on to the next
      integer :: evaluations = 0, jacobians = 0
      logical :: done = .false.            !! the start was not cut short
      logical :: feasible = .false.        !! x obeys every constraint
      logical :: refused = .false.         !! the solver refuses the problem
      logical :: settled = .false.         !! it was searched on, so far that it shows where it leads
      logical :: refined = .false.         !! to its end
      logical :: strayed = .false.         !! out of its bounds: it is listed only if none stayed within
   end type candidate_t

   !> A member of the team: works by itself, on memory of its own.
   type, abstract :: starter_t
   contains
      procedure(start_i), deferred :: start
      procedure(refine_i), deferred :: refine
      procedure :: go_on
      procedure :: are_one
   end type starter_t

   abstract interface
      !> Make a start and improve it. Nothing but the number and `elite` may influence the result.
      subroutine start_i(self, number, elite, candidate)
         import :: starter_t, candidate_t, wp
         implicit none (type, external)
         class(starter_t), intent(inout) :: self
         integer, intent(in) :: number                  !! of the start; -j: the j-th supplied one
         real(wp), intent(in) :: elite(:, :)            !! shape (unknowns, any): the best results of the rounds before
         type(candidate_t), intent(inout) :: candidate
      end subroutine start_i

      !> Search on from a result, more finely.
      subroutine refine_i(self, thorough, candidate)
         import :: starter_t, candidate_t
         implicit none (type, external)
         class(starter_t), intent(inout) :: self
         logical, intent(in) :: thorough                !! to the end
         type(candidate_t), intent(inout) :: candidate
      end subroutine refine_i
   end interface

   !> What is asked of a search.
   type :: multistart_t
      integer :: supplied = 0              !! starts that are given, before the others
      integer :: starts = 1                !! others
      integer :: first = 1                 !! number of the first of these
      integer :: kept = 1                  !! results kept
      logical :: refines = .false.         !! the best are searched on
      integer :: refined = 8               !! how many, at least
      integer :: stages = 1                !! of a start
      logical, allocatable :: compared(:)  !! shape (unknowns): those that tell two results to draw near apart
      real(wp) :: small = 0.0_wp           !! objectives below it are alike
      ! two of the results kept are one if no unknown differs by more than both of these
      real(wp), allocatable :: relative(:) !! shape (unknowns): of the larger one
      real(wp), allocatable :: absolute(:) !! shape (unknowns)
      real(wp), allocatable :: period(:)   !! shape (unknowns): of unknowns that repeat themselves; 0: it does not
   contains
      procedure :: search
      procedure :: make_all
      procedure :: make_more
      procedure :: finish
      procedure :: keep_as_they_are
      procedure :: leading
      procedure :: number_of
   end type multistart_t

contains

   !> Search on from what a start led to in the stage before. By itself a start has one stage.
   subroutine go_on(self, stage, candidate)
      class(starter_t), intent(inout) :: self
      integer, intent(in) :: stage
      type(candidate_t), intent(inout) :: candidate

      associate (unused => self, unchanged => stage, same_candidate => candidate)
      end associate
   end subroutine go_on

   !> True if two results that differ in their unknowns are one all the same. By themselves they are not.
   logical function are_one(self, a, b)
      class(starter_t), intent(inout) :: self
      type(candidate_t), intent(in) :: a, b             !! their objectives are near each other

      are_one = .false.
      associate (unused => self, first => a, second => b)
      end associate
   end function are_one

   !> Number of the i-th start.
   pure integer function number_of(self, i)
      class(multistart_t), intent(in) :: self
      integer, intent(in) :: i

      number_of = merge(-i, self%first + i - self%supplied - 1, i <= self%supplied)
   end function number_of

   !> Make all starts and search on from the best. `best` are the places of the results kept, the best first.
   subroutine search(self, team, stop, candidates, best, observer)
      class(multistart_t), intent(in) :: self
      class(starter_t), intent(inout) :: team(:)        !! one for each thread
      type(stop_t), intent(in) :: stop                  !! asked before every start
      type(candidate_t), allocatable, intent(out) :: candidates(:) !! shape (supplied + starts)
      integer, allocatable, intent(out) :: best(:)
      class(observer_t), intent(inout), optional :: observer !! informed by the first of the team

      call self%make_all(team, stop, candidates, best, observer)
      call self%finish(team, stop, candidates, best)
   end subroutine search

   !> Make all starts. `best` are the places of the best results to search on from, the best first.
   subroutine make_all(self, team, stop, candidates, best, observer)
      class(multistart_t), intent(in) :: self
      class(starter_t), intent(inout) :: team(:)        !! one for each thread
      type(stop_t), intent(in) :: stop                  !! asked before every start
      type(candidate_t), allocatable, intent(out) :: candidates(:) !! shape (supplied + starts)
      integer, allocatable, intent(out) :: best(:)
      class(observer_t), intent(inout), optional :: observer !! informed by the first of the team
      type(search_state_t) :: state
      real(wp), allocatable :: elite(:, :)
      integer :: t, i, round, rounds, before, until

      allocate (candidates(self%supplied + self%starts), best(0))
      state%limit = size(candidates)
      state%best = huge(1.0_wp)
      rounds = min(most_rounds, max(1, self%starts/least_of_round))
      before = 0
      do round = 1, rounds
         until = self%supplied + (self%starts*round)/rounds
         allocate (elite(size(self%compared), size(best)))
         do i = 1, size(best)
            elite(:, i) = candidates(best(i))%x
         end do
         call stop%open_batch('starts', until - before)
         !$omp parallel do num_threads(size(team)) schedule(static)
         do t = 1, size(team)
            if (t == 1) then
               call make_starts(self, team(t), t, before, until, size(team), stop, elite, candidates, state, observer)
            else
               call make_starts(self, team(t), t, before, until, size(team), stop, elite, candidates)
            end if
         end do
         !$omp end parallel do
         call take_shared(stop, [(i, i=before + 1, until)], candidates)
         call go_through_stages(self, team, before + 1, until, stop, candidates)
         before = until
         deallocate (elite)
         call rank(self, max(self%refined, self%kept), candidates, best)
      end do
   end subroutine make_all

   !> Make so many starts more, those before being known; `best` becomes the places of the best of all. Each start sees the best
   !> results before all of these.
   subroutine make_more(self, team, more, stop, candidates, best)
      class(multistart_t), intent(inout) :: self
      class(starter_t), intent(inout) :: team(:)        !! one for each thread
      integer, intent(in) :: more
      type(stop_t), intent(in) :: stop                  !! asked before every start
      type(candidate_t), allocatable, intent(inout) :: candidates(:) !! shape (supplied + starts)
      integer, allocatable, intent(inout) :: best(:)
      type(candidate_t), allocatable :: longer(:)
      real(wp), allocatable :: elite(:, :)
      integer :: t, i, before

      before = size(candidates)
      allocate (longer(before + more))
      longer(:before) = candidates
      call move_alloc(longer, candidates)
      self%starts = self%starts + more
      allocate (elite(size(self%compared), size(best)))
      do i = 1, size(best)
         elite(:, i) = candidates(best(i))%x
      end do
      call stop%open_batch('starts', more)
      !$omp parallel do num_threads(size(team)) schedule(static)
      do t = 1, size(team)
         call make_starts(self, team(t), t, before, before + more, size(team), stop, elite, candidates)
      end do
      !$omp end parallel do
      call take_shared(stop, [(i, i=before + 1, before + more)], candidates)
      call go_through_stages(self, team, before + 1, before + more, stop, candidates)
      call rank(self, max(self%refined, self%kept), candidates, best)
   end subroutine make_more

   !> Take the starts `from` to `until` through the stages after the first: of those left the better half by what they promise, and
   !> the starts that were given.
   subroutine go_through_stages(rules, team, from, until, stop, candidates)
      type(multistart_t), intent(in) :: rules
      class(starter_t), intent(inout) :: team(:)
      integer, intent(in) :: from, until
      type(stop_t), intent(in) :: stop
      type(candidate_t), intent(inout) :: candidates(:)
      integer, allocatable :: left(:)
      integer :: stage, t, i

      left = [(i, i=from, until)]
      do stage = 2, rules%stages
         left = better_half(rules, candidates, left)
         call stop%open_batch('stage', size(left))
         !$omp parallel do num_threads(size(team)) schedule(static) private(i)
         do t = 1, size(team)
            i = t - size(team)
            do
               i = stop%next_item(i, size(team), size(left))
               if (i > size(left)) exit
               ! one that is cut short is not done with
               if (.not. stop%waiting()) call team(t)%go_on(stage, candidates(left(i)))
               if (stop%waiting()) candidates(left(i))%done = .false.
               if (candidates(left(i))%done) call stop%keep_item(i, numbers_of(candidates(left(i))))
            end do
         end do
         !$omp end parallel do
         call take_shared(stop, left, candidates)
      end do
   end subroutine go_through_stages

   !> The half of some starts, rounded up, that promises most, and those that were given.
   pure function better_half(rules, candidates, left) result(better)
      type(multistart_t), intent(in) :: rules
      type(candidate_t), intent(in) :: candidates(:)
      integer, intent(in) :: left(:)                    !! places
      integer, allocatable :: better(:)
      logical :: chosen(size(left))
      real(wp) :: promise(size(left))
      integer :: i

      promise = candidates(left)%promise
      chosen = [(rules%number_of(left(i)) <= 1, i=1, size(left))]
      do i = count(chosen) + 1, (size(left) + 1)/2
         chosen(minloc(promise, dim=1, mask=.not. chosen)) = .true.
      end do
      better = pack(left, chosen)
   end function better_half

   !> Search on from the best of the starts that were made, as far as that is wanted.
   subroutine finish(self, team, stop, candidates, best)
      class(multistart_t), intent(in) :: self
      class(starter_t), intent(inout) :: team(:)        !! one for each thread
      type(stop_t), intent(in) :: stop                  !! asked now and then
      type(candidate_t), intent(inout) :: candidates(:)
      integer, allocatable, intent(inout) :: best(:)    !! by `make_all`; becomes the places of the results kept
      logical, allocatable :: left(:), held(:)
      integer :: round, leader

      left = candidates%feasible
      leader = 0
      if (self%refines .and. .not. stop%waiting()) then
         call refine_all(team, best, .false., stop, candidates)
         leader = minloc(candidates%objective, dim=1, mask=left)
         ! what differed may have become one: others are searched on in its place, to the end if they still differ when settled
         do round = 1, most_refinements
            if (leader > 0) then
               if (candidates(leader)%strayed) leader = 0
            end if
            call keep_different(self, team(1), left .and. .not. candidates%strayed, leader, candidates, best)
            if (all(candidates(best)%refined) .or. stop%waiting() .or. count(candidates%strayed) > most_strayed) exit
            if (all(candidates(best)%settled)) then
               call refine_all(team, pack(best, .not. candidates(best)%refined), .true., stop, candidates)
            else
               call refine_all(team, pack(best, .not. candidates(best)%settled), .false., stop, candidates)
            end if
         end do
         if (.not. stop%waiting()) left = left .and. candidates%refined
         held = left .and. .not. candidates%strayed
         if (any(held)) left = held
      end if
      call keep_different(self, team(1), left, leader, candidates, best)
   end subroutine finish

   !> The places of the results kept where nothing is searched on.
   subroutine keep_as_they_are(self, team, candidates, best)
      class(multistart_t), intent(in) :: self
      class(starter_t), intent(inout) :: team(:)
      type(candidate_t), intent(in) :: candidates(:)
      integer, allocatable, intent(out) :: best(:)

      call keep_different(self, team(1), candidates%feasible, 0, candidates, best)
   end subroutine keep_as_they_are

   !> The places of the best results to search on from, as `make_all` gives them.
   pure function leading(self, candidates) result(best)
      class(multistart_t), intent(in) :: self
      type(candidate_t), intent(in) :: candidates(:)
      integer, allocatable :: best(:)

      call rank(self, max(self%refined, self%kept), candidates, best)
   end function leading

   !> Search on from some results.
   subroutine refine_all(team, which, thorough, stop, candidates)
      class(starter_t), intent(inout) :: team(:)
      integer, intent(in) :: which(:)
      logical, intent(in) :: thorough                   !! to the end
      type(stop_t), intent(in) :: stop
      type(candidate_t), intent(inout) :: candidates(:)
      integer :: t, i

      call stop%open_batch('refined', size(which))
      !$omp parallel do num_threads(size(team)) schedule(static) private(i)
      do t = 1, size(team)
         i = t - size(team)
         do
            i = stop%next_item(i, size(team), size(which))
            if (i > size(which)) exit
            call team(t)%refine(thorough, candidates(which(i)))
            if (.not. stop%waiting()) call stop%keep_item(i, numbers_of(candidates(which(i))))
         end do
      end do
      !$omp end parallel do
      call take_shared(stop, which, candidates)
      candidates(which)%settled = .true.
      candidates(which)%refined = thorough
   end subroutine refine_all

   !> What a candidate is, in numbers.
   pure function numbers_of(candidate) result(numbers)
      type(candidate_t), intent(in) :: candidate
      real(wp), allocatable :: numbers(:)
      real(wp), allocatable :: x(:)

      allocate (x(0))
      if (allocated(candidate%x)) x = candidate%x
      numbers = [candidate%objective, candidate%promise, real([candidate%evaluations, candidate%jacobians], wp), &
                 merge(1.0_wp, 0.0_wp, [candidate%done, candidate%feasible, candidate%refused, candidate%settled, &
                                        candidate%refined, candidate%strayed]), x]
   end function numbers_of

   !> End a batch of candidates and take those that others have made.
   subroutine take_shared(stop, which, candidates)
      type(stop_t), intent(in) :: stop
      integer, intent(in) :: which(:)                   !! places of the items
      type(candidate_t), intent(inout) :: candidates(:)
      real(wp), allocatable :: numbers(:)
      integer :: i

      if (.not. stop%is_shared()) return
      call stop%close_batch()
      do i = 1, size(which)
         call stop%take_item(i, numbers)
         if (.not. allocated(numbers)) cycle
         call take_numbers(numbers, candidates(which(i)))
      end do
   end subroutine take_shared

   !> The candidate that numbers describe: the reverse of `numbers_of`.
   pure subroutine take_numbers(numbers, candidate)
      real(wp), intent(in) :: numbers(:)
      type(candidate_t), intent(inout) :: candidate

      candidate%objective = numbers(1)
      candidate%promise = numbers(2)
      candidate%evaluations = nint(numbers(3))
      candidate%jacobians = nint(numbers(4))
      candidate%done = numbers(5) > 0.0_wp
      candidate%feasible = numbers(6) > 0.0_wp
      candidate%refused = numbers(7) > 0.0_wp
      candidate%settled = numbers(8) > 0.0_wp
      candidate%refined = numbers(9) > 0.0_wp
      candidate%strayed = numbers(10) > 0.0_wp
      candidate%x = numbers(11:)
   end subroutine take_numbers

   !> The least objective that starts came to; of a linkage that obeys not every constraint ten times as much and a handicap.
   pure real(wp) function promise_of(candidates, handicap) result(promise)
      type(candidate_t), intent(in) :: candidates(:)
      real(wp), intent(in) :: handicap
      real(wp), parameter :: times = 10.0_wp

      promise = huge(promise)
      if (any(candidates%done)) promise = minval(merge(candidates%objective, times*candidates%objective + handicap, &
                                                       candidates%feasible), mask=candidates%done)
   end function promise_of

   !> The starts of one member: first, first + step ... of those after `before`, up to `until`; or those that it gets where the work
   !> is shared.
   subroutine make_starts(rules, member, first, before, until, step, stop, elite, candidates, state, observer)
      type(multistart_t), intent(in) :: rules
      class(starter_t), intent(inout) :: member
      integer, intent(in) :: first, before, until, step
      type(stop_t), intent(in) :: stop
      real(wp), intent(in) :: elite(:, :)
      type(candidate_t), intent(inout) :: candidates(:)
      type(search_state_t), intent(inout), optional :: state
      class(observer_t), intent(inout), optional :: observer
      integer :: i, item

      item = first - step
      do
         if (stop%waiting()) return
         item = stop%next_item(item, step, until - before)
         i = before + item
         if (i > until) return
         call member%start(rules%number_of(i), elite, candidates(i))
         ! what a start that was cut short has is kept, but the start is not done with
         candidates(i)%done = .not. stop%waiting()
         if (candidates(i)%done) call stop%keep_item(item, numbers_of(candidates(i)))
         if (candidates(i)%refused) return
         if (.not. (present(observer) .and. present(state))) cycle
         state%iteration = i
         state%evaluations = state%evaluations + candidates(i)%evaluations*step*stop%members()
         if (candidates(i)%feasible) state%best = min(state%best, candidates(i)%objective)
         state%worst = state%best
         call observer%report(state)
      end do
   end subroutine make_starts

   !> Places of the best results to draw near. Two are one if the unknowns that are compared and the objectives agree.
   pure subroutine rank(rules, most, candidates, best)
      type(multistart_t), intent(in) :: rules
      integer, intent(in) :: most
      type(candidate_t), intent(in) :: candidates(:)
      integer, allocatable, intent(out) :: best(:)
      real(wp) :: objective(size(candidates))   ! together in memory: every process of a cluster ranks the results of all
      logical :: left(size(candidates))
      integer :: i, k

      allocate (best(0))
      left = candidates%feasible
      objective = candidates%objective
      do while (size(best) < most)
         i = minloc(objective, dim=1, mask=left)
         if (i == 0) exit
         best = [best, i]
         associate (next => candidates(i))
            do k = 1, size(left)
               if (.not. left(k)) cycle
               if (objective(k) - objective(i) > alike*max(objective(i), rules%small)) cycle
               left(k) = any(rules%compared .and. abs(candidates(k)%x - next%x) > alike*abs(next%x))
            end do
         end associate
         left(i) = .false.
      end do
   end subroutine rank

   !> Places of the results kept: the best, the best of those that differ from it, and so on.
   subroutine keep_different(rules, member, eligible, leader, candidates, best)
      type(multistart_t), intent(in) :: rules
      class(starter_t), intent(inout) :: member
      logical, intent(in) :: eligible(:)                !! shape (candidates)
      integer, intent(in) :: leader                     !! stands first unless another is better by more than rounding; 0: none
      type(candidate_t), intent(in) :: candidates(:)
      integer, allocatable, intent(out) :: best(:)
      logical :: left(size(candidates))
      integer :: i, k

      allocate (best(0))
      left = eligible
      do while (any(left) .and. size(best) < rules%kept)
         i = minloc(candidates%objective, dim=1, mask=left)
         if (size(best) == 0 .and. leader > 0) then
            if (candidates(leader)%objective <= max((1.0_wp + tie)*candidates(i)%objective, rules%small)) i = leader
         end if
         best = [best, i]
         left(i) = .false.
         do k = 1, size(left)
            if (.not. left(k)) cycle
            left(k) = differ(rules, candidates(i), candidates(k))
            if (.not. left(k)) cycle
            ! where each leads to is known only when it was searched on to its end
            if (.not. (candidates(i)%refined .and. candidates(k)%refined)) cycle
            if (candidates(k)%objective - candidates(i)%objective <= near*max(candidates(i)%objective, rules%small)) &
               left(k) = .not. member%are_one(candidates(i), candidates(k))
         end do
      end do
   end subroutine keep_different

   !> Two results are not one. Where the objectives are the same they must differ more, and not in periodic unknowns alone: else
   !> they are two of the many points of one valley, or one is the other turned.
   pure logical function differ(rules, a, b)
      type(multistart_t), intent(in) :: rules
      type(candidate_t), intent(in) :: a, b
      real(wp) :: change(size(a%x))
      logical :: beyond(size(a%x)), level

      change = a%x - b%x
      where (rules%period > 0.0_wp) change = change - rules%period*anint(change/max(rules%period, tiny(1.0_wp)))
      level = any(rules%relative > 0.0_wp) .and. abs(a%objective - b%objective) <= same*max(a%objective, b%objective, rules%small)
      associate (least => merge(along_valley, 1.0_wp, level)*rules%relative)
         beyond = abs(change) > max(least*max(abs(a%x), abs(b%x)), rules%absolute)
      end associate
      differ = any(beyond .and. rules%period <= 0.0_wp) .or. (any(beyond) .and. .not. level)
   end function differ
end module psalm_multistart
