!> Links with a width: distances of segments and boxes against the greatest gap over all directions, least clearances against
!> cases solved by hand.
program test_links
   use cases, only: load_case
   use check, only: checks_t
   use psalm_constraint_group, only: region_t, segment_t, region_box, region_half_plane, region_circle, range_turn
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp
   use psalm_margins, only: inspector_t, margin_t, prepare_inspector, inspect, margin_clearance
   use psalm_proof_study, only: proof_study_t, study_proof, proof_of_turn
   use psalm_separation, only: find_separation
   use psalm_text, only: to_text
   use psalm_xoshiro, only: xoshiro_t
   implicit none (type, external)

   integer, parameter :: directions = 720, draws = 300
   real(wp), parameter :: pi = acos(-1.0_wp)
   type(checks_t) :: t

   call separations()
   call touching()
   call solved_by_hand()
   call stretched_and_folded()
   call worst_corner()
   call t%report()

contains

   !> Signed distance and gradient of random shapes: apart, near and overlapping.
   subroutine separations()
      type(xoshiro_t) :: stream
      real(wp) :: p(2, 2), q(2, 4), distance, by_p(2, 2), by_q(2, 4), worst, slope, ahead, behind
      real(wp), parameter :: h = 1.0e-6_wp
      integer, parameter :: corners(4) = [1, 2, 4, 4]
      integer :: k, kind, n, i, j, overlapping

      call stream%seed(19, 1)
      worst = 0.0_wp
      slope = 0.0_wp
      overlapping = 0
      do k = 1, draws
         kind = 1 + modulo(k, 4)
         n = corners(kind)
         call draw(stream, p)
         call draw(stream, q)
         if (kind == 4) p(:, 2) = p(:, 1)
         if (n == 4) q = reshape([q(1, 1), q(2, 1), q(1, 1) + 0.8_wp, q(2, 1), q(1, 1) + 0.8_wp, q(2, 1) + 0.5_wp, &
                                  q(1, 1), q(2, 1) + 0.5_wp], [2, 4])
         call find_separation(p, q(:, :n), distance, by_p, by_q(:, :n))
         if (distance < 0.0_wp) overlapping = overlapping + 1
         worst = max(worst, abs(distance - widest_gap(p, q(:, :n))))
         do i = 1, 2
            do j = 1, 2
               if (kind == 4 .and. j == 2) cycle
               call move(p, q(:, :n), i, j, h, ahead)
               call move(p, q(:, :n), i, j, -h, behind)
               slope = max(slope, abs((ahead - behind)/(2.0_wp*h) - merge(sum(by_p(i, :)), by_p(i, j), kind == 4)))
            end do
         end do
         slope = max(slope, maxval(abs(sum(by_p, dim=2) + sum(by_q(:, :n), dim=2))))
      end do
      call t%is_true(overlapping > draws/20, 'some shapes overlap')
      call t%close_to(worst, 0.0_wp, 1.0e-9_wp, 'signed distance is the greatest gap over all directions')
      call t%close_to(slope, 0.0_wp, 1.0e-5_wp, 'gradient of the signed distance')
   end subroutine separations

   !> The distance with one coordinate changed; a point is moved as a whole.
   subroutine move(p, q, i, j, by, moved)
      real(wp), intent(in) :: p(2, 2), q(:, :), by
      integer, intent(in) :: i, j
      real(wp), intent(out) :: moved
      real(wp) :: changed(2, 2), unused(2, 2), rest(2, size(q, 2))

      changed = p
      changed(i, j) = p(i, j) + by
      if (all(abs(p(:, 1) - p(:, 2)) <= 0.0_wp)) changed = spread(changed(:, j), 2, 2)
      call find_separation(changed, q, moved, unused, rest)
   end subroutine move

   subroutine draw(stream, points)
      type(xoshiro_t), intent(inout) :: stream
      real(wp), intent(out) :: points(:, :)
      integer :: i, j

      do j = 1, size(points, 2)
         do i = 1, 2
            call stream%next(points(i, j))
         end do
      end do
      points = 2.0_wp*points - 1.0_wp
   end subroutine draw

   !> Greatest gap between two shapes over all directions: even ones, then golden section about the best.
   pure real(wp) function widest_gap(p, q) result(widest)
      real(wp), intent(in) :: p(:, :), q(:, :)
      real(wp), parameter :: golden = 0.5_wp*(sqrt(5.0_wp) - 1.0_wp)
      real(wp) :: gaps(directions), low, high, one, other
      integer :: k, m, round

      gaps = [(gap(p, q, 2.0_wp*pi*real(k, wp)/real(directions, wp)), k=1, directions)]
      widest = -huge(1.0_wp)
      do m = 1, directions
         if (gaps(m) < maxval(gaps) - 0.05_wp) cycle
         low = 2.0_wp*pi*real(m - 1, wp)/real(directions, wp)
         high = 2.0_wp*pi*real(m + 1, wp)/real(directions, wp)
         do round = 1, 45
            one = high - golden*(high - low)
            other = low + golden*(high - low)
            if (gap(p, q, one) > gap(p, q, other)) then
               high = other
            else
               low = one
            end if
         end do
         widest = max(widest, gap(p, q, 0.5_wp*(low + high)))
      end do
   end function widest_gap

   !> What a direction shows of it.
   pure real(wp) function gap(p, q, angle)
      real(wp), intent(in) :: p(:, :), q(:, :), angle

      gap = minval(cos(angle)*p(1, :) + sin(angle)*p(2, :)) - maxval(cos(angle)*q(1, :) + sin(angle)*q(2, :))
   end function gap

   !> Segments in one line, with ends in common, crossing at right angles.
   subroutine touching()
      call between([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [3.0_wp, 0.0_wp, 5.0_wp, 0.0_wp], 2.0_wp, 'one behind the other')
      call between([0.1_wp, 0.3_wp, 0.7_wp, 2.1_wp], [0.7_wp, 2.1_wp, 5.0_wp, 0.3_wp], 0.0_wp, 'a common end')
      call between([0.0_wp, 0.0_wp, 3.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 2.0_wp, 0.0_wp], 0.0_wp, 'one upon the other')
      call between([-1.0_wp, 0.0_wp, 3.0_wp, 0.0_wp], [0.0_wp, -2.0_wp, 0.0_wp, 0.5_wp], -0.5_wp, 'a cross')
      call between([0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], [3.0_wp, 4.0_wp, 3.0_wp, 4.0_wp], 5.0_wp, 'two points')
   end subroutine touching

   subroutine between(one, other, distance, what)
      real(wp), intent(in) :: one(4), other(4), distance
      character(*), intent(in) :: what
      real(wp) :: found, by_p(2, 2), by_q(2, 2)

      call find_separation(reshape(one, [2, 2]), reshape(other, [2, 2]), found, by_p, by_q)
      call t%close_to(found, distance, 1.0e-15_wp, what)
   end subroutine between

   !> A crank of length a that turns fully, in regions whose distance from its circle is known.
   subroutine solved_by_hand()
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      real(wp) :: a, least(9)
      real(wp), parameter :: half = 1.5_wp

      allocate (set, problem)
      call load_case('dyad1_crank_rocker', problem, set)
      a = problem%given%arcl(1)
      set%constr%irange = range_turn
      set%constr%segments = [segment_t([0, 1], [1, 1], [0, 0], 2.0_wp*half)]
      set%constr%regions = [region_t(region_circle, .false., [0.0_wp, -3.0_wp*a, 0.5_wp*a, 0.0_wp], segment=1), &
                            region_t(region_circle, .true., [0.0_wp, 0.25_wp*a, 2.0_wp*a, 0.0_wp], segment=1), &
                            region_t(region_half_plane, .false., [0.0_wp, 2.0_wp*a, 0.0_wp, 0.0_wp], segment=1), &
                            region_t(region_half_plane, .false., [0.0_wp, 2.0_wp*a, 0.0_wp, 0.0_wp], arc=1, loop=1), &
                            region_t(region_box, .false., [2.0_wp*a, -a, 3.0_wp*a, a], segment=1), &
                            region_t(region_box, .false., [1.5_wp*a, 2.0_wp*a, 3.0_wp*a, 4.0_wp*a], segment=1), &
                            region_t(region_box, .true., [-4.0_wp*a, -3.0_wp*a, 3.0_wp*a, 2.0_wp*a], segment=1), &
                            region_t(region_circle, .false., [0.6_wp*a, 0.0_wp, 0.1_wp*a, 0.0_wp], arc=1, loop=1), &
                            region_t(region_circle, .false., [0.0_wp, 0.7_wp*a, 0.1_wp*a, 0.0_wp], segment=1)]
      least = [1.5_wp*a - half, 0.75_wp*a - half, a - half, a, a - half, 1.5_wp*a - half, a - half, 0.3_wp*a, &
               -0.1_wp*a - half]
      set%constr%regions(3)%clearance = 0.5_wp*a
      call compare(set, problem, least, 'a crank')
      ! what it must not be proven to break, what it must
      set%constr%regions(3)%clearance = a - half - 1.0e-6_wp
      call assess(set, problem, [.false., .false., .false., .false., .false., .false., .false., .false., .true.])
      set%constr%regions(3)%clearance = a - half + 1.0e-6_wp
      call assess(set, problem, [.false., .false., .true., .false., .false., .false., .false., .false., .true.])
   end subroutine solved_by_hand

   !> The pin between coupler and rocker comes nearest to the crank's pivot where crank and coupler are in line, folded, and goes
   !> farthest from it where they are stretched.
   subroutine stretched_and_folded()
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      real(wp) :: least

      allocate (set, problem)
      call load_case('dyad1_crank_rocker', problem, set)
      set%constr%irange = range_turn
      associate (arcl => problem%given%arcl)
         set%constr%regions = [region_t(region_circle, .false., [0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], arc=2, loop=1), &
                               region_t(region_circle, .true., [0.0_wp, 0.0_wp, 2.0_wp*arcl(2), 0.0_wp], arc=2, loop=1)]
         least = arcl(2) - arcl(1) - 1.0_wp
         call compare(set, problem, [least, arcl(2) - arcl(1)], 'crank and coupler in line')
      end associate
   end subroutine stretched_and_folded

   !> A crank-rocker opens where crank and frame in line are as long as both links: all four are off by a fourth of the difference.
   subroutine worst_corner()
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      type(proof_study_t), allocatable :: study
      real(wp) :: exact

      allocate (set, problem)
      call load_case('dyad1_crank_rocker', problem, set)
      exact = 0.25_wp*(problem%given%arcl(2) + problem%given%arcl(3) - problem%given%arcl(1) - problem%given%arcl(4))
      set%limits%iproof = proof_of_turn
      allocate (study)
      call study_proof(set, problem, problem%given, proof_of_turn, study)
      call t%close_to(study%worst_corner, exact, 1.0e-9_wp*exact, 'the worst corner of a single loop')
      call t%is_true(study%tolerance <= exact .and. study%tolerance > 0.99_wp*exact, 'what is proven comes near to it, from below')
   end subroutine worst_corner

   !> Least clearances, proven and looked for, against known ones.
   subroutine compare(set, problem, least, what)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: least(:)
      character(*), intent(in) :: what
      type(proof_study_t), allocatable :: study
      type(inspector_t), allocatable :: inspector
      type(margin_t), allocatable :: margins(:)
      real(wp), parameter :: near = 1.0e-9_wp
      integer :: k

      allocate (study, inspector)
      call study_proof(set, problem, problem%given, proof_of_turn, study)
      call prepare_inspector(set, problem, .true., inspector)
      call inspect(inspector, problem%given, problem%delt, margins)
      margins = pack(margins, margins%kind == margin_clearance)
      call t%equal_integer(size(study%kept), size(least), 'all clearances are proven')
      call t%equal_integer(size(margins), size(least), 'all clearances have margins')
      do k = 1, size(least)
         associate (nearest => study%kept(k)%nearest, scale => maxval(problem%given%arcl))
            call t%is_true(nearest%low <= least(k) + 1.0e-14_wp*scale .and. nearest%high >= least(k) - 1.0e-14_wp*scale, &
                           what//', clearance '//to_text(k)//': the bracket holds the least')
            call t%close_to(nearest%high - nearest%low, 0.0_wp, near*scale, what//', clearance '//to_text(k)//': narrow')
            call t%close_to(margins(k)%margin, least(k) - study%kept(k)%clearance%asked, 2.0e-6_wp*scale, &
                            what//', clearance '//to_text(k)//': its margin')
         end associate
      end do
   end subroutine compare

   !> What is proven to be broken.
   subroutine assess(set, problem, broken)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      logical, intent(in) :: broken(:)
      type(proof_study_t), allocatable :: study

      allocate (study)
      call study_proof(set, problem, problem%given, proof_of_turn, study)
      call t%is_true(all(study%kept%is_broken .eqv. broken), 'what is proven to be broken is broken, and nothing else')
      call t%is_true(study%is_violating(), 'a broken clearance is a violation')
      call t%is_true(.not. study%is_open(), 'and the linkage closes')
   end subroutine assess
end program test_links
