!> All solutions of a problem followed to another one, none lost that double and quadruple precision can follow.
!>
!> A path that does not arrive, or ends where another one did (one of both has jumped), is followed again the same way with more
!> care, at last in quadruple precision. Only the same way leads each start to its own end: another way exchanges the ends.
!> Two that share their legs even then differ in a turn of the coupler: the coupler point passes a given point in two positions.
!> In the end every path has arrived at a regular solution, is known to end at infinity or at a singular solution, or is unsettled.
module psalm_careful_tracking
   use psalm_kinds, only: wp
   use psalm_leg_lanes, only: problem_path_t
   use psalm_leg_problem, only: variables
   use psalm_monodromy, only: add_distinct, is_same, near, orbit_key, orbit_numbers
   use psalm_quad_path, only: follow_precisely, path_arrived, path_singular, path_to_infinity
   use psalm_stop, only: stop_t
   use psalm_tracker, only: track, tracked_t
   implicit none (type, external)
   private
   public :: ends_t, track_carefully, take_ends

   real(wp), parameter :: careful = 1.0e-5_wp        !! largest prediction error of a path that is followed again
   integer, parameter :: most_precise = 160          !! paths in quadruple precision: with more left the problem is degenerate
   real(wp), parameter :: unsettled = 1.0e-8_wp      !! last relative correction of an end that may be singular

   !> Distinct ends of the paths of one problem or, if it was followed several times, of all passes.
   !>
   !> Regular ends are united: each is a solution, whatever way led there. Of infinite and singular ends only the number of paths
   !> is known that lead there, so those are counted within one pass, the one that leaves the fewest paths unsettled.
   type :: ends_t
      complex(wp), allocatable :: regular(:, :)      !! shape (variables, count)
      complex(wp), allocatable :: singular(:, :)     !! shape (variables, count): finite, multiple or not isolated
      integer :: infinite = 0                        !! paths that end at infinity
      integer :: to_singular = 0                     !! paths that end at singular solutions
      integer :: shared = 0                          !! paths that end at the legs of another: they pass a point in two positions
      integer :: paths = 0                           !! all of a pass
      integer :: settled = -1                        !! paths of the pass whose end is known
      integer :: followed = 0                        !! paths of a pass that were followed as far as they lead, at most
      logical :: stopped = .false.                   !! the last pass was cut off
   contains
      procedure :: count_of => count_of_ends
      procedure :: complete => are_complete
   end type ends_t

contains

   !> How many distinct finite ends there are.
   pure integer function count_of_ends(self)
      class(ends_t), intent(in) :: self

      count_of_ends = size(self%regular, 2) + size(self%singular, 2)
   end function count_of_ends

   !> True if every path has its end: a regular one, a singular one, or none but infinity.
   pure logical function are_complete(self)
      class(ends_t), intent(in) :: self

      are_complete = self%paths > 0 .and. .not. self%stopped
      if (are_complete) are_complete = size(self%regular, 2) + self%shared + self%infinite + self%to_singular == &
                                       self%paths
   end function are_complete

   !> Add the ends of a pass.
   subroutine take_ends(path, tracked, orbits, ends)
      type(problem_path_t), intent(in) :: path
      type(tracked_t), intent(in) :: tracked
      logical, intent(in) :: orbits
      type(ends_t), intent(inout) :: ends
      complex(wp), allocatable :: own(:, :)
      integer :: known, shared

      if (.not. allocated(ends%regular)) allocate (ends%regular(variables, 0), ends%singular(variables, 0))
      call add_distinct(path%problem, tracked%ends, tracked%arrived .and. tracked%left <= unsettled, orbits, ends%regular)
      allocate (own(variables, 0))
      call add_distinct(path%problem, tracked%ends, tracked%arrived .and. tracked%left <= unsettled, orbits, own)
      shared = 0
      if (tracked%sure) shared = max(count(tracked%arrived .and. tracked%left <= unsettled) - size(own, 2), 0)
      known = size(own, 2) + shared + tracked%infinite + count(tracked%singular)
      ends%paths = size(tracked%arrived)
      ends%followed = max(ends%followed, tracked%followed)
      ends%stopped = tracked%stopped
      if (known <= ends%settled) return
      ends%settled = known
      ends%shared = shared
      ends%infinite = tracked%infinite
      ends%to_singular = count(tracked%singular)
      deallocate (ends%singular)
      allocate (ends%singular(variables, 0))
      call add_distinct(path%problem, tracked%ends, tracked%singular, orbits, ends%singular)
   end subroutine take_ends

   !> Follow solutions of the problem at t = 1 to that at t = 0. With `orbits` ends that exchange of the legs and cognates make of
   !> each other are one. A stop leaves the ends that were reached; none of them is sure then.
   subroutine track_carefully(path, starts, orbits, tracked, stop)
      type(problem_path_t), intent(in) :: path
      complex(wp), intent(in) :: starts(:, :)        !! shape (variables, count)
      logical, intent(in) :: orbits
      type(tracked_t), intent(out) :: tracked
      type(stop_t), intent(in), optional :: stop     !! asked before every step, and before every path in quadruple precision
      type(tracked_t) :: again
      integer, allocatable :: which(:)

      call track(path, starts, tracked, stop=stop)
      if (tracked%stopped) return
      which = doubtful_paths(tracked, orbits)
      tracked%sure = size(which) == 0
      if (tracked%sure) return
      call track(path, starts(:, which), again, careful, stop)
      tracked%steps = tracked%steps + again%steps
      tracked%stopped = again%stopped
      if (again%stopped) then
         tracked%followed = size(starts, 2) - size(which) + again%followed
         return
      end if
      tracked%ends(:, which) = again%ends
      tracked%arrived(which) = again%arrived
      tracked%reached(which) = again%reached
      tracked%left(which) = again%left
      tracked%last_place(:, which) = again%last_place
      tracked%last_t(which) = again%last_t
      call settle(path, starts, orbits, tracked, stop)
   end subroutine track_carefully

   !> Paths that did not arrive or ended where another one did, ends that may be singular, and singular ends that fewer paths have
   !> than close when t turns about 0.
   pure function doubtful_paths(tracked, orbits) result(which)
      type(tracked_t), intent(in) :: tracked
      logical, intent(in) :: orbits
      integer, allocatable :: which(:)
      complex(wp) :: keys(variables, size(tracked%arrived))
      real(wp) :: first(size(tracked%arrived))
      logical :: doubtful(size(tracked%arrived))
      integer :: i, k, together(size(tracked%arrived))

      doubtful = .not. (tracked%arrived .or. tracked%singular) .or. tracked%left > unsettled
      together = 1
      do i = 1, size(doubtful)
         if (.not. (tracked%arrived(i) .or. tracked%singular(i))) cycle
         keys(:, i) = tracked%ends(:, i)
         if (orbits) then
            keys(:, i) = (0.0_wp, 0.0_wp)
            keys(:orbit_numbers, i) = orbit_key(tracked%ends(:, i))
         end if
         first(i) = abs(keys(1, i))
         do k = 1, i - 1
            if (.not. (tracked%arrived(k) .or. tracked%singular(k))) cycle
            if (abs(first(k) - first(i)) > near*(first(k) + first(i))) cycle
            if (.not. is_same(keys(:, k), keys(:, i))) cycle
            if (tracked%singular(i) .and. tracked%singular(k)) then
               together(k) = together(k) + 1
               together(i) = together(i) + 1
            else
               doubtful(i) = .true.
               doubtful(k) = .true.
            end if
         end do
      end do
      where (tracked%singular .and. modulo(together, tracked%winding) /= 0) doubtful = .true.
      which = pack([(i, i=1, size(doubtful))], doubtful)
   end function doubtful_paths

   !> Follow what is still in doubt in quadruple precision, and what comes into doubt by that.
   subroutine settle(path, starts, orbits, tracked, stop)
      type(problem_path_t), intent(in) :: path
      complex(wp), intent(in) :: starts(:, :)        !! shape (variables, count)
      logical, intent(in) :: orbits
      type(tracked_t), intent(inout) :: tracked
      type(stop_t), intent(in), optional :: stop
      integer, allocatable :: which(:)
      complex(wp) :: reached(variables)
      logical :: certain(size(tracked%arrived)), from_start
      integer :: k, outcome

      certain = .false.
      do
         which = doubtful_paths(tracked, orbits)
         which = pack(which, .not. certain(which))
         tracked%sure = size(which) == 0
         if (size(which) == 0 .or. size(which) > most_precise) exit
         do k = 1, size(which)
            if (present(stop)) then
               tracked%stopped = stop%waiting()
               call stop%tell(size(starts, 2) - size(which) + k - 1, size(starts, 2))
            end if
            if (tracked%stopped) then
               tracked%followed = size(starts, 2) - size(which) + k - 1
               tracked%precise = tracked%precise + k - 1
               return
            end if
            associate (i => which(k))
               ! what got lost on its way, or came to a singular end, goes on from its last valid place; what came to another
               ! one's end begins afresh
               from_start = .not. tracked%reached(i) > 0.0_wp .and. (tracked%left(i) <= unsettled .or. .not. tracked%arrived(i))
               if (from_start) then
                  call follow_precisely(path, 1.0_wp, starts(:, i), reached, outcome, tracked%winding(i))
               else
                  call follow_precisely(path, tracked%last_t(i), tracked%last_place(:, i), reached, outcome, tracked%winding(i))
               end if
               tracked%ends(:, i) = reached
               tracked%reached(i) = 0.0_wp
               tracked%left(i) = 0.0_wp
               certain(i) = from_start .or. outcome == path_to_infinity
               tracked%arrived(i) = outcome == path_arrived
               tracked%singular(i) = outcome == path_singular
            end associate
            if (outcome == path_to_infinity) tracked%infinite = tracked%infinite + 1
         end do
         tracked%precise = tracked%precise + size(which)
      end do
   end subroutine settle
end module psalm_careful_tracking
