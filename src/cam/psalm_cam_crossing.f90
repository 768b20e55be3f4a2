!> Which branch of the linkage each segment of a law goes on, and what happens at the dead points between them.
!>
!> The law rests at a dead point q* of the output, y' = 0 and F' = 0. With y'' > 0 the input has q' = +-sqrt(y''/F''): it passes; to
!> turn back its velocity would have to jump. Where y'' and y''' vanish q - q* goes with the square of the cam angle: the input
!> comes to rest and turns back, or passes if the user says so. In between (y'' = 0, y''' not) its acceleration is infinite.
!> Next to the dead point the input is solved for as a distance from it. Source: Oldham (1977), 9.3.2; derivation in
!> doc/theory/cams.md.
module psalm_cam_crossing
   use psalm_cam_data, only: cam_group_t
   use psalm_cam_kind, only: law_dwell
   use psalm_cam_law, only: law_t, make_law, highest_law_order
   use psalm_cam_branch, only: moved_problem_t, followed_t, branch_t, branch_end_t, find_branch, find_dead_point, rise_from
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_rates, only: highest_order
   implicit none (type, external)
   private
   public :: ways_t, plan_ways, next_dead_point, solve_near, no_point
   public :: ways_found, ways_jump, ways_infinite, ways_end, ways_apart

   integer, parameter :: most_branches = 4          !! passed one after the other to either side
   integer, parameter :: no_point = huge(1)
   integer, parameter :: rounds = 6                  !! of Newton's method from a start that is a few percent off
   real(wp), parameter :: near_enough = 1.0e-6_wp    !! part of the range of outputs within which one is taken for the dead point's
   real(wp), parameter :: step_beyond = 1.0e-2_wp    !! part of a branch, from its dead point into the next branch
   real(wp), parameter :: settled = 1.0e-10_wp       !! part of the greatest that is rounding
   real(wp), parameter :: same = 1.0e-6_wp           !! relative difference of accelerations that are the same
   real(wp), parameter :: near_point = 2.0e-2_wp     !! part of a branch next to a dead point
   real(wp), parameter :: at_point = 1.0e-4_wp       !! radians of cam from the dead point within which its series serves

   !> How the planning ended.
   integer, parameter :: ways_found = 0, ways_jump = 1 !! the input's velocity would jump
   integer, parameter :: ways_infinite = 2           !! the input's acceleration would be infinite
   integer, parameter :: ways_end = 3                !! beyond the dead point there is nothing to go on
   integer, parameter :: ways_apart = 4              !! after a turn the input is not where it was

   !> A dead point that the law comes to and leaves.
   type :: cam_crossing_t
      real(wp) :: angle = 0.0_wp                     !! cam angle as it leaves, degrees
      real(wp) :: q = 0.0_wp, f = 0.0_wp             !! input and output there
      logical :: passed = .false.                    !! else it turns back
   end type cam_crossing_t

   type :: ways_t
      type(branch_t) :: branches(-most_branches:most_branches) !! 0: about the reference position; by rising input
      type(branch_end_t) :: points(-most_branches - 1:most_branches) !! number k lies between the branches k and k + 1
      ! by segment of the law
      integer, allocatable :: on(:)                  !! its branch
      integer, allocatable :: begins(:), ends(:), rests(:) !! dead point at its beginning, at its end, where it rests; no_point
      integer, allocatable :: begin_order(:), end_order(:) !! lowest derivative of the law there: 2 or 4
      type(cam_crossing_t), allocatable :: crossings(:)
      integer :: state = ways_found
      real(wp) :: faulty_at = 0.0_wp                 !! cam angle, degrees
   end type ways_t

contains

   !> Plan the way of a law; `ways%branches(0)` is known. The law is made anew where it comes so near to dead points that it is to
   !> rest at them.
   subroutine plan_ways(cam, quantity, what, law, ways)
      type(cam_group_t), intent(in) :: cam
      type(moved_problem_t), intent(inout) :: quantity
      type(followed_t), intent(in) :: what
      type(law_t), intent(inout) :: law
      type(ways_t), intent(inout) :: ways
      type(cam_group_t) :: given
      real(wp) :: value(0:size(cam%finish)), greatest(4)
      integer :: n, k, s, point, before, after
      logical :: met

      n = size(law%segments)
      allocate (ways%on(n), source=0)
      allocate (ways%begins(n), ways%ends(n), ways%rests(n), source=no_point)
      allocate (ways%begin_order(n), ways%end_order(n), source=0)
      allocate (ways%crossings(0))
      if (size(cam%finish) == 0 .or. cam%slides .or. cam%frequency > 0.0_wp .or. size(ways%branches(0)%q) == 0) return
      do k = 1, 2
         call find_dead_point(quantity, what, ways%branches(0), k, ways%points(k - 2))
      end do
      value = [cam%start, cam%output]
      given = cam
      greatest = [(law%greatest(k), k=1, 4)]
      met = .false.
      s = 0
      before = findloc(cam%law /= law_dwell, .true., dim=1, back=.true.)
      do k = 1, n
         point = touched(value(k - 1), s)
         if (cam%law(k) == law_dwell) then
            ways%on(k) = s
            ways%rests(k) = point
            if (point == no_point) cycle
            call rest_at(k - 1, point)
            call rest_at(k, point)
            cycle
         end if
         if (point /= no_point .and. rests(k, .false.)) then
            ways%begins(k) = point
            call rest_at(k - 1, point)
            if (k > 1) call leave(point, before, k, s)
            if (ways%state /= ways_found) return
         end if
         ways%on(k) = s
         point = touched(value(k), s)
         if (point /= no_point .and. rests(k, .true.)) then
            ways%ends(k) = point
            call rest_at(k, point)
         end if
         before = k
      end do
      if (.not. met) return
      after = s
      if (cam%law(1) /= law_dwell .and. ways%begins(1) /= no_point) call leave(ways%begins(1), before, 1, after)
      if (ways%state /= ways_found) return
      if (after /= 0) then
         ways%state = ways_apart
         return
      end if
      call make_law(given, law)

   contains

      !> The dead point at an end of a branch whose output a value is.
      pure integer function touched(value, s)
         real(wp), intent(in) :: value
         integer, intent(in) :: s
         integer :: k

         touched = no_point
         associate (branch => ways%branches(s))
            do k = s - 1, s
               if (.not. ways%points(k)%found) cycle
               if (abs(value - ways%points(k)%f) <= near_enough*abs(branch%f(size(branch%f)) - branch%f(1))) touched = k
            end do
         end associate
      end function touched

      !> Derivatives of the law at the beginning or the end of a segment.
      pure function ending(k, at_end) result(y)
         integer, intent(in) :: k
         logical, intent(in) :: at_end
         real(wp) :: y(0:highest_law_order)
         integer :: piece

         piece = findloc(law%pieces%segment, k, dim=1, back=at_end)
         y = law%evaluate(merge(law%segments(k)%finish, law%segments(k)%start, at_end), piece)
      end function ending

      pure logical function rests(k, at_end)
         integer, intent(in) :: k
         logical, intent(in) :: at_end
         real(wp) :: y(0:highest_law_order)

         y = ending(k, at_end)
         rests = abs(y(1)) <= settled*greatest(1)
      end function rests

      !> The end of a segment, 0: the beginning of the first, is to have the output of a dead point.
      subroutine rest_at(k, point)
         integer, intent(in) :: k, point

         met = .true.
         if (k > 0) given%output(k) = ways%points(point)%f
         if (k == 0 .or. k == n) given%start = ways%points(point)%f
         if (k == 0) given%output(n) = ways%points(point)%f
      end subroutine rest_at

      !> The lowest order of the law that does not vanish at an end of a segment, or 0 if the input's acceleration is infinite.
      pure integer function order_of(y)
         real(wp), intent(in) :: y(0:)

         order_of = 2
         if (abs(y(2)) > settled*greatest(2)) return
         order_of = 0
         if (abs(y(3)) <= settled*greatest(3) .and. abs(y(4)) > settled*greatest(4)) order_of = 4
      end function order_of

      !> Leave a dead point that segment `from` came to with segment `to`: which branch is next.
      subroutine leave(point, from, to, s)
         integer, intent(in) :: point, from, to
         integer, intent(inout) :: s
         real(wp) :: came(0:highest_law_order), goes(0:highest_law_order)
         logical :: at_once
         type(cam_crossing_t) :: crossing

         came = ending(from, .true.)
         goes = ending(to, .false.)
         ways%faulty_at = law%segments(to)%start
         ways%end_order(from) = order_of(came)
         ways%begin_order(to) = order_of(goes)
         if (min(ways%end_order(from), ways%begin_order(to)) == 0) then
            ways%state = ways_infinite
            return
         end if
         crossing = cam_crossing_t(law%segments(to)%start, ways%points(point)%q, ways%points(point)%f, cam%through)
         if (max(ways%end_order(from), ways%begin_order(to)) == 2) then
            at_once = modulo(to - from, n) == modulo(1, n)
            crossing%passed = .true.
            if (.not. at_once .or. abs(came(2) - goes(2)) > same*max(abs(came(2)), abs(goes(2)))) ways%state = ways_jump
         else if (ways%end_order(from) /= ways%begin_order(to)) then
            ways%state = ways_jump
         end if
         if (ways%state /= ways_found) return
         ways%crossings = [ways%crossings, crossing]
         if (crossing%passed) call cross(point, s)
      end subroutine leave

      subroutine cross(point, s)
         integer, intent(in) :: point
         integer, intent(inout) :: s
         integer :: next, which

         next = merge(s + 1, s - 1, point == s)
         if (abs(next) > most_branches) then
            ways%state = ways_end
            return
         end if
         associate (branch => ways%branches(next), dead => ways%points(point))
            if (.not. allocated(branch%q)) then
               call find_branch(quantity, what, dead%q + real(next - s, wp)*step_beyond*dead%extent/what%input_unit(), branch, &
                                 dead%f)
               if (size(branch%q) == 0) then
                  ways%state = ways_end
                  return
               end if
               which = merge(2, 1, next > s)
               call find_dead_point(quantity, what, branch, which, ways%points(merge(next, next - 1, next > s)))
            end if
         end associate
         s = next
      end subroutine cross
   end subroutine plan_ways

   !> The dead point near which a cam angle leaves the input, and how far from it: radians or length, with its sign. no_point: none.
   subroutine next_dead_point(ways, law, what, angle, piece, point, distance, at_end)
      type(ways_t), intent(in) :: ways
      type(law_t), intent(in) :: law
      type(followed_t), intent(in) :: what
      real(wp), intent(in) :: angle                  !! degrees
      integer, intent(in) :: piece
      integer, intent(out) :: point
      real(wp), intent(out) :: distance
      logical, intent(out) :: at_end                 !! the dead point is at the end of the segment
      real(wp) :: y(0:highest_law_order), square

      point = no_point
      distance = 0.0_wp
      associate (k => law%pieces(piece)%segment)
         at_end = .false.
         if (ways%begins(k) == no_point .and. ways%ends(k) == no_point) return
         at_end = ways%ends(k) /= no_point .and. &
                  (ways%begins(k) == no_point .or. angle - law%segments(k)%start > law%segments(k)%finish - angle)
         ! only the first or the last piece reaches it
         if (findloc(law%pieces%segment, k, dim=1, back=at_end) /= piece) return
         if (at_end) then
            point = ways%ends(k)
         else
            point = ways%begins(k)
         end if
         if (point == no_point) return
         associate (dead => ways%points(point))
            y = rise_of_law(ways, law, angle, piece, at_end)
            square = 2.0_wp*y(0)*what%output_unit()/dead%d(2)
            if (square >= 0.0_wp .and. square < (near_point*dead%extent)**2) then
               distance = sqrt(square)*merge(1.0_wp, -1.0_wp, ways%on(k) > point)
            else
               point = no_point
            end if
         end associate
      end associate
   end subroutine next_dead_point

   pure function rise_of_law(ways, law, angle, piece, at_end) result(y)
      type(ways_t), intent(in) :: ways
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: angle
      integer, intent(in) :: piece
      logical, intent(in) :: at_end
      real(wp) :: y(0:highest_law_order)

      associate (k => law%pieces(piece)%segment)
         if (at_end) then
            y = law%evaluate_from_rest(angle, piece, .true., ways%end_order(k))
         else
            y = law%evaluate_from_rest(angle, piece, .false., ways%begin_order(k))
         end if
      end associate
   end function rise_of_law

   !> Inputs near dead points, with derivatives: Newton's method in the distance, and next to the dead point itself its series.
   subroutine solve_near(ways, law, quantity, what, angle, piece, point, at_end, first, q, shut)
      type(ways_t), intent(in) :: ways
      type(law_t), intent(in) :: law
      type(moved_problem_t), intent(inout) :: quantity
      type(followed_t), intent(in) :: what
      real(wp), intent(in) :: angle(:)               !! shape (n)
      integer, intent(in) :: piece(:), point(:)
      logical, intent(in) :: at_end(:)
      real(wp), intent(in) :: first(:)               !! distances as `next_dead_point` has them
      real(wp), intent(out) :: q(0:, :)              !! shape (0:3, n): input, the user's unit; derivatives, radians or length
      logical, intent(out) :: shut(:)                !! the loops close there
      type(branch_end_t) :: dead(size(angle))
      real(wp) :: y(0:highest_law_order, size(angle)), value(quantity%problem%output%kind%components, size(angle)), &
                  d(highest_order, size(value, 1), size(angle)), rise(size(angle)), slope(size(angle)), &
                  distance(size(angle))
      integer :: i, round

      dead = ways%points(point)
      distance = first
      do i = 1, size(angle)
         y(:, i) = rise_of_law(ways, law, angle(i), piece(i), at_end(i))*what%output_unit()
      end do
      do round = 0, rounds
         call quantity%move(dead%q + distance/what%input_unit(), highest_order, value, d, shut)
         associate (f => d(:, what%component, :))
            call rise_from(dead, distance, f(1, :), f(2, :), f(3, :), rise, slope)
         end associate
         if (round == rounds) exit
         where (abs(slope) > 0.0_wp) distance = distance - (rise - y(0, :))/slope
      end do
      do i = 1, size(angle)
         associate (f => d(:, what%component, i), finish => law%segments(law%pieces(piece(i))%segment)%finish, &
                    start => law%segments(law%pieces(piece(i))%segment)%start)
            if (abs(angle(i) - merge(finish, start, at_end(i)))*radians_per_degree < at_point) then
               q(:, i) = series(i, merge(finish, start, at_end(i)))
               cycle
            end if
            q(0, i) = dead(i)%q + distance(i)/what%input_unit()
            q(1, i) = y(1, i)/slope(i)
            q(2, i) = (y(2, i) - f(2)*q(1, i)**2)/slope(i)
            q(3, i) = (y(3, i) - 3.0_wp*f(2)*q(1, i)*q(2, i) - f(3)*q(1, i)**3)/slope(i)
         end associate
      end do

   contains

      !> Taylor's series of the input about the dead point.
      function series(i, joint) result(q)
         integer, intent(in) :: i
         real(wp), intent(in) :: joint               !! cam angle of the dead point
         real(wp) :: q(0:3)
         real(wp) :: y(0:highest_law_order), t, side, q1, q2, q3

         t = (angle(i) - joint)*radians_per_degree
         side = merge(1.0_wp, -1.0_wp, ways%on(law%pieces(piece(i))%segment) > point(i))
         y = rise_of_law(ways, law, joint, piece(i), at_end(i))*what%output_unit()
         associate (f => dead(i)%d)
            if (abs(y(2)) > 0.0_wp) then
               q1 = side*merge(-1.0_wp, 1.0_wp, at_end(i))*sqrt(y(2)/f(2))
               q2 = (y(3) - f(3)*q1**3)/(3.0_wp*f(2)*q1)
               q3 = (y(4) - f(4)*q1**4 - 6.0_wp*f(3)*q1**2*q2 - 3.0_wp*f(2)*q2**2)/(4.0_wp*f(2)*q1)
            else
               q1 = 0.0_wp
               q2 = side*sqrt(y(4)/(3.0_wp*f(2)))
               q3 = 0.1_wp*y(5)/(f(2)*q2)
            end if
         end associate
         q = [dead(i)%q + t*(q1 + t*(0.5_wp*q2 + t*q3/6.0_wp))/what%input_unit(), q1 + t*(q2 + 0.5_wp*t*q3), q2 + t*q3, q3]
      end function series
   end subroutine solve_near
end module psalm_cam_crossing
