!> All solutions of a problem followed to another one, none lost that double and quadruple precision can follow.
!>
!> A path that does not arrive, or ends where another one did (one of both has jumped), is followed again the same way with more
!> care, at last in quadruple precision. Only the same way leads each start to its own end: another way exchanges the ends.
module psalm_careful_tracking
   use psalm_kinds, only: wp
   use psalm_leg_lanes, only: path_t
   use psalm_leg_problem, only: variables
   use psalm_monodromy, only: is_same, near, orbit_key
   use psalm_quad_path, only: follow_precisely, path_arrived, path_to_infinity
   use psalm_tracker, only: track, tracked_t
   implicit none (type, external)
   private
   public :: track_carefully

   real(wp), parameter :: careful = 1.0e-5_wp        !! largest prediction error of a path that is followed again
   integer, parameter :: most_precise = 16           !! paths in quadruple precision: with more left the problem is degenerate

contains

   !> Follow solutions of the problem at t = 1 to that at t = 0. With `orbits` ends that exchange of the legs and cognates make of
   !> each other are one.
   subroutine track_carefully(path, starts, orbits, tracked)
      type(path_t), intent(in) :: path
      complex(wp), intent(in) :: starts(:, :)        !! shape (variables, count)
      logical, intent(in) :: orbits
      type(tracked_t), intent(out) :: tracked
      type(tracked_t) :: again
      integer, allocatable :: which(:)

      call track(path, starts, tracked)
      which = doubtful_paths(tracked, orbits)
      if (size(which) == 0) return
      call track(path, starts(:, which), again, careful)
      tracked%steps = tracked%steps + again%steps
      tracked%ends(:, which) = again%ends
      tracked%arrived(which) = again%arrived
      tracked%reached(which) = again%reached
      call settle(path, starts, orbits, tracked)
   end subroutine track_carefully

   !> Paths that did not arrive or ended where another one did.
   pure function doubtful_paths(tracked, orbits) result(which)
      type(tracked_t), intent(in) :: tracked
      logical, intent(in) :: orbits
      integer, allocatable :: which(:)
      complex(wp) :: keys(variables, size(tracked%arrived))
      real(wp) :: first(size(tracked%arrived))
      logical :: doubtful(size(tracked%arrived))
      integer :: i, k

      doubtful = .not. tracked%arrived
      do i = 1, size(doubtful)
         if (.not. tracked%arrived(i)) cycle
         keys(:, i) = tracked%ends(:, i)
         if (orbits) keys(:, i) = [orbit_key(tracked%ends(:, i)), orbit_key(tracked%ends(:, i))]
         first(i) = abs(keys(1, i))
         do k = 1, i - 1
            if (.not. tracked%arrived(k)) cycle
            if (abs(first(k) - first(i)) > near*(first(k) + first(i))) cycle
            if (.not. is_same(keys(:, k), keys(:, i))) cycle
            doubtful(i) = .true.
            doubtful(k) = .true.
         end do
      end do
      which = pack([(i, i=1, size(doubtful))], doubtful)
   end function doubtful_paths

   !> Follow what is still in doubt in quadruple precision, and what comes into doubt by that.
   subroutine settle(path, starts, orbits, tracked)
      type(path_t), intent(in) :: path
      complex(wp), intent(in) :: starts(:, :)        !! shape (variables, count)
      logical, intent(in) :: orbits
      type(tracked_t), intent(inout) :: tracked
      integer, allocatable :: which(:)
      complex(wp) :: reached(variables)
      logical :: certain(size(tracked%arrived)), from_start
      integer :: k, outcome

      certain = .false.
      do
         which = doubtful_paths(tracked, orbits)
         which = pack(which, .not. certain(which))
         if (size(which) == 0 .or. size(which) > most_precise) exit
         do k = 1, size(which)
            associate (v => tracked%ends(:, which(k)), t => tracked%reached(which(k)))
               ! what got lost on its way is brought to its end; what came to another one's begins afresh
               from_start = .not. t > 0.0_wp
               if (from_start) then
                  call follow_precisely(path, 1.0_wp, starts(:, which(k)), reached, outcome)
               else
                  call follow_precisely(path, t, v, reached, outcome)
               end if
               v = reached
               t = 0.0_wp
               certain(which(k)) = from_start .or. outcome == path_to_infinity
               tracked%arrived(which(k)) = outcome == path_arrived
            end associate
            if (outcome == path_to_infinity) tracked%infinite = tracked%infinite + 1
         end do
         tracked%precise = tracked%precise + size(which)
      end do
   end subroutine settle
end module psalm_careful_tracking
