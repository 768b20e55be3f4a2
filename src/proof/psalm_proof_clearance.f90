!> How near joints and links come to regions and to each other while a linkage moves, proven.
!>
!> The signed distance of two convex shapes is the greatest, over all directions, of the gap that a direction shows between them.
!> Any direction gives a lower bound over a box of the input: the best at its middle, the normals of the segments, which turn with
!> them, and the way between the corners that are nearest at the middle, which may be a third link of constant length. Moving
!> corners by e changes the signed distance by e at most: its value at a place of a box is an upper bound there. Branch and bound,
!> in the working precision.
module psalm_proof_clearance
   use psalm_kinds, only: wp
   use psalm_proof, only: proof_t, proof_linkage_t
   use psalm_proof_extremes, only: place_t
   use psalm_proof_groups, only: models_t, evaluate, add_up
   use psalm_proof_ranges, only: list_places
   use psalm_separation, only: find_separation
   use psalm_taylor, only: lanes, degree, eps, up, smallest, pair_rounding, pair_norm_of, multiply_twice, range_of
   implicit none (type, external)
   private
   public :: step_path_t, keeping_t, nearest_t, prove_clearance
   public :: apart_from_link, apart_from_corners, within_edges, within_circle

   integer, parameter :: apart_from_link = 1    !! from a segment that moves
   integer, parameter :: apart_from_corners = 2 !! from a box (four corners) or a point that stand still
   integer, parameter :: within_edges = 3       !! to the right of lines that stand still
   integer, parameter :: within_circle = 4

   integer, parameter :: most_corners = 4
   integer, parameter :: most_boxes = 20000
   real(wp), parameter :: enough = 2.0e-12_wp   !! width of a bracket that need not be narrower; the longest arc is 1 to 2
   real(wp), parameter :: finest = 1.0e-14_wp   !! part of the range that is not halved
   real(wp), parameter :: unbounded = 1.0e30_wp

   !> Steps from the machine's origin to a point.
   type :: step_path_t
      integer, allocatable :: steps(:)
   end type step_path_t

   !> A segment or a joint, and what it keeps from.
   type :: keeping_t
      integer :: kind = 0                       !! one of `apart_...`, `within_...`
      type(step_path_t) :: ends(2), others(2)        !! of the segment (a joint: both the same), of the other one
      integer :: corners = 0                    !! corners, or edges
      real(wp) :: corner(2, most_corners) = 0.0_wp !! anticlockwise; a point of each edge
      real(wp) :: normal(2, most_corners) = 0.0_wp !! of the edges: unit vectors away from what is forbidden
      real(wp) :: radius = 0.0_wp               !! of the circle, or round the corners
      real(wp) :: reach = 0.0_wp                !! half the widths of the segments
   end type keeping_t

   !> Least clearance over what closes, bracketed: distance less half the widths; negative where they overlap.
   type :: nearest_t
      real(wp) :: low = -huge(1.0_wp), high = huge(1.0_wp)
      real(wp) :: at = 0.0_wp                   !! an input where it is at most `high`
      logical :: found = .false.                !! the linkage closes somewhere
   end type nearest_t

   !> Differences of the points of two shapes over a row of boxes.
   type :: shapes_t
      integer :: p = 0, q = 0                   !! points of each
      real(wp) :: w(lanes, 0:degree, 2, 2, most_corners) = 0.0_wp !! point i of the first less point k of the second
      real(wp) :: e(lanes, 2, most_corners) = 0.0_wp
      real(wp) :: side(lanes, 0:degree, 2, 2) = 0.0_wp !! from point 1 to point 2 of either
      real(wp) :: side_e(lanes, 2) = 0.0_wp
   end type shapes_t

contains

   !> The least clearance over the range of a proof.
   subroutine prove_clearance(linkage, proof, keeping, nearest)
      type(proof_linkage_t), intent(inout) :: linkage  !! bound, of the same proof
      type(proof_t), intent(in) :: proof
      type(keeping_t), intent(in) :: keeping     !! in the user's unit
      type(nearest_t), intent(out) :: nearest
      type(place_t), allocatable :: places(:), next(:)
      type(keeping_t) :: own
      type(shapes_t), allocatable :: shapes
      real(wp) :: m(lanes), r(lanes), low(lanes), high(lanes), at(lanes)
      real(wp), allocatable :: bounds(:)
      integer :: k, i, n, taken, count
      logical :: final

      own = keeping
      associate (scale => linkage%numbers%scale)
         own%corner = keeping%corner*scale
         own%radius = keeping%radius*scale
         own%reach = keeping%reach*scale
      end associate
      allocate (shapes)
      call list_places(proof, places)
      nearest%low = huge(1.0_wp)
      count = 0
      do while (size(places) > 0)
         final = count + 2*size(places) > most_boxes
         allocate (bounds(size(places)))
         do k = 1, size(places), lanes
            taken = min(lanes, size(places) - k + 1)
            do i = 1, lanes
               associate (place => places(k + min(i, taken) - 1))
                  m(i) = 0.5_wp*(place%from + place%to)
                  r(i) = max(place%to - m(i), m(i) - place%from)*(1.0_wp + 2.0_wp*eps)
               end associate
            end do
            call evaluate(linkage%plan, linkage%numbers, m, r, linkage%models)
            call bound(own, linkage%models, shapes, low, high, at)
            do i = 1, taken
               bounds(k + i - 1) = low(i)
               if (.not. (places(k + i - 1)%certain .and. high(i) < nearest%high)) cycle
               nearest%high = high(i)
               nearest%at = min(max(m(i) + r(i)*at(i), places(k + i - 1)%from), places(k + i - 1)%to)
               nearest%found = .true.
            end do
         end do
         count = count + size(places)
         allocate (next(2*size(places)))
         n = 0
         do k = 1, size(places)
            associate (place => places(k))
               if (bounds(k) >= nearest%high - enough .or. final .or. &
                   place%to - place%from <= finest*(proof%to - proof%from)) then
                  nearest%low = min(nearest%low, bounds(k))
               else
                  next(n + 1:n + 2) = place
                  next(n + 1)%to = 0.5_wp*(place%from + place%to)
                  next(n + 2)%from = next(n + 1)%to
                  n = n + 2
               end if
            end associate
         end do
         places = next(:n)
         deallocate (next, bounds)
      end do
      nearest%low = min(nearest%low, nearest%high)
      if (.not. nearest%found) return
      associate (scale => linkage%numbers%scale)
         nearest%low = nearest%low/scale        ! a power of two
         nearest%high = nearest%high/scale
      end associate
   end subroutine prove_clearance

   !> Bounds of a clearance over boxes: it is nowhere below `low`, and at most `high` at the place `at`, -1 to 1, of each.
   subroutine bound(keeping, models, shapes, low, high, at)
      type(keeping_t), intent(in) :: keeping
      type(models_t), intent(in) :: models
      type(shapes_t), intent(inout) :: shapes
      real(wp), intent(out) :: low(lanes), high(lanes), at(lanes)
      real(wp) :: s(lanes), gap, away, rest(2), u(2, lanes), slip
      integer :: l, near(2, lanes), unused(2)

      call form_shapes(keeping, models, shapes)
      do l = 1, lanes
         call value_at(keeping, shapes, l, 0.0_wp, high(l), u(:, l), near(:, l))
      end do
      at = 0.0_wp
      select case (keeping%kind)
      case (within_edges)
         call bound_edges(keeping, shapes, low, s)
      case (within_circle)
         call bound_circle(keeping, shapes, low, s)
      case default
         call bound_gap(shapes, u, low, s)
         call follow_corners(shapes, near, low)
         call turn_with(shapes, 1, low)
         if (keeping%kind == apart_from_link) call turn_with(shapes, 2, low)
      end select
      do l = 1, lanes
         call value_at(keeping, shapes, l, s(l), gap, rest, unused)
         if (gap < high(l)) then
            high(l) = gap
            at(l) = s(l)
         end if
         away = keeping%reach
         if (keeping%kind /= within_edges .and. keeping%kind /= within_circle) away = away + keeping%radius
         slip = 4.0_wp*eps*(away + abs(low(l)) + abs(high(l)))
         low(l) = (low(l) - away) - slip
         high(l) = (high(l) - away) + slip
         ! what is not bounded is not compared
         if (.not. (maxval(shapes%e(l, :shapes%p, :shapes%q)) < unbounded .and. abs(low(l)) < unbounded .and. &
                    abs(high(l)) < unbounded)) then
            low(l) = -huge(1.0_wp)
            high(l) = huge(1.0_wp)
         end if
      end do
   end subroutine bound

   !> Models of the differences of all points.
   subroutine form_shapes(keeping, models, shapes)
      type(keeping_t), intent(in) :: keeping
      type(models_t), intent(in) :: models
      type(shapes_t), intent(inout) :: shapes
      real(wp) :: norm(lanes)
      integer :: i, k

      shapes%p = 2
      shapes%q = merge(2, keeping%corners, keeping%kind == apart_from_link)
      call difference(keeping%ends(2)%steps, keeping%ends(1)%steps, models, shapes%side(:, :, :, 1), shapes%side_e(:, 1))
      if (keeping%kind == apart_from_link) then
         call difference(keeping%others(2)%steps, keeping%others(1)%steps, models, shapes%side(:, :, :, 2), shapes%side_e(:, 2))
         do k = 1, 2
            do i = 1, 2
               call difference(keeping%ends(i)%steps, keeping%others(k)%steps, models, shapes%w(:, :, :, i, k), &
                               shapes%e(:, i, k))
            end do
         end do
         return
      end if
      do i = 1, 2
         call difference(keeping%ends(i)%steps, [integer ::], models, shapes%w(:, :, :, i, 1), shapes%e(:, i, 1))
         call pair_norm_of(shapes%w(:, :, 1, i, 1), shapes%w(:, :, 2, i, 1), norm)
         do k = shapes%q, 1, -1
            shapes%w(:, :, :, i, k) = shapes%w(:, :, :, i, 1)
            shapes%w(:, 0, 1, i, k) = shapes%w(:, 0, 1, i, 1) - keeping%corner(1, k)
            shapes%w(:, 0, 2, i, k) = shapes%w(:, 0, 2, i, 1) - keeping%corner(2, k)
            shapes%e(:, i, k) = (shapes%e(:, i, 1) + 2.0_wp*eps*(norm + sum(abs(keeping%corner(:, k)))))*up
         end do
      end do
   end subroutine form_shapes

   !> One point less another: what their paths share cancels.
   subroutine difference(to, from, models, vector, e)
      integer, intent(in) :: to(:), from(:)      !! steps to each; of `from` none: the origin
      type(models_t), intent(in) :: models
      real(wp), intent(out) :: vector(lanes, 0:degree, 2), e(lanes)
      integer :: shared

      shared = 0
      do while (shared < min(size(to), size(from)))
         if (to(shared + 1) /= from(shared + 1)) exit
         shared = shared + 1
      end do
      call add_up(models, [to(shared + 1:), from(shared + 1:)], [spread(1, 1, size(to) - shared), &
                                                                 spread(-1, 1, size(from) - shared)], &
                  vector(:, :, 1), vector(:, :, 2), e)
   end subroutine difference

   !> Distance at place s of a box, rounded down, the direction that parts the shapes there, and the corners it is between.
   pure subroutine value_at(keeping, shapes, l, s, distance, u, near)
      type(keeping_t), intent(in) :: keeping
      type(shapes_t), intent(in) :: shapes
      integer, intent(in) :: l                   !! lane
      real(wp), intent(in) :: s
      real(wp), intent(out) :: distance, u(2)
      integer, intent(out) :: near(2)            !! of the first and of the second shape; about
      real(wp) :: w(2, 2, most_corners), p(2, 2), q(2, most_corners), by_p(2, 2), by_q(2, most_corners), value
      integer :: i, k, n

      do k = 1, shapes%q
         do i = 1, 2
            w(:, i, k) = shapes%w(l, degree, :, i, k)
            do n = degree - 1, 0, -1
               w(:, i, k) = w(:, i, k)*s + shapes%w(l, n, :, i, k)
            end do
         end do
      end do
      u = 0.0_wp
      near = 1
      distance = huge(1.0_wp)
      select case (keeping%kind)
      case (within_edges)
         do k = 1, shapes%q
            value = min(sum(keeping%normal(:, k)*w(:, 1, k)), sum(keeping%normal(:, k)*w(:, 2, k)))
            distance = min(distance, value)
         end do
      case (within_circle)
         distance = keeping%radius - sqrt(max(sum(w(:, 1, 1)**2), sum(w(:, 2, 1)**2)))
      case default
         p = w(:, :, 1)
         do k = 1, shapes%q
            q(:, k) = w(:, 1, 1) - w(:, 1, k)
         end do
         call find_separation(p, q(:, :shapes%q), distance, by_p, by_q(:, :shapes%q))
         u = by_p(:, 1) + by_p(:, 2)
         near = [maxloc(sum(abs(by_p), dim=1), dim=1), maxloc(sum(abs(by_q(:, :shapes%q)), dim=1), dim=1)]
      end select
      ! rounding of the polynomials too
      distance = distance + (maxval(shapes%e(l, :2, :shapes%q)) + 64.0_wp*eps &
                             *(maxval(sum(abs(shapes%w(l, :, 1, :, :shapes%q)), dim=1)) &
                               + maxval(sum(abs(shapes%w(l, :, 2, :, :shapes%q)), dim=1)) + keeping%radius))*up
   end subroutine value_at

   !> The gap that a direction of each box shows.
   pure subroutine bound_gap(shapes, u, low, s)
      type(shapes_t), intent(in) :: shapes
      real(wp), intent(in) :: u(2, lanes)        !! unit vectors; 0: none is known
      real(wp), intent(out) :: low(lanes)
      real(wp), intent(out) :: s(lanes)          !! where the gap is least, about
      integer :: i, k

      low = huge(1.0_wp)
      s = 0.0_wp
      do k = 1, shapes%q
         do i = 1, shapes%p
            call take_corner(shapes, i, k, u, low, s)
         end do
      end do
      where (abs(u(1, :)) + abs(u(2, :)) < 0.5_wp) low = -huge(1.0_wp)
   end subroutine bound_gap

   !> Keep the lower of two bounds: the one kept and that of the way from one corner to another along a direction.
   pure subroutine take_corner(shapes, i, k, u, low, s)
      type(shapes_t), intent(in) :: shapes
      integer, intent(in) :: i, k                !! the corners
      real(wp), intent(in) :: u(2, lanes)
      real(wp), intent(inout) :: low(lanes), s(lanes)
      real(wp) :: c(lanes, 0:degree), norm(lanes), first(lanes), last(lanes)
      integer :: j

      associate (x => shapes%w(:, :, 1, i, k), y => shapes%w(:, :, 2, i, k))
         do j = 0, degree
            c(:, j) = u(1, :)*shapes%w(:, j, 1, i, k) + u(2, :)*shapes%w(:, j, 2, i, k)
         end do
         call pair_norm_of(x, y, norm)
      end associate
      call range_of(c, (shapes%e(:, i, k) + 8.0_wp*eps*norm)*up + smallest, first, last)
      call take_lowest(c, first, low, s)
   end subroutine take_corner

   !> Keep the lower of two bounds, and the place in the box where its polynomial is least.
   pure subroutine take_lowest(c, first, low, s)
      real(wp), intent(in) :: c(lanes, 0:degree), first(lanes)
      real(wp), intent(inout) :: low(lanes), s(lanes)
      integer :: l

      do l = 1, lanes
         if (first(l) >= low(l)) cycle
         low(l) = first(l)
         s(l) = merge(-1.0_wp, 1.0_wp, c(l, 1) > 0.0_wp)
         if (2.0_wp*c(l, 2) > abs(c(l, 1))) s(l) = -c(l, 1)/(2.0_wp*c(l, 2))
      end do
   end subroutine take_lowest

   !> The gap along the way between two corners, which turns with it: min (w . v)/|w| over all differences v of corners.
   pure subroutine follow_corners(shapes, near, low)
      type(shapes_t), intent(in) :: shapes
      integer, intent(in) :: near(2, lanes)      !! the corners, in every box its own
      real(wp), intent(inout) :: low(lanes)
      real(wp), dimension(lanes, 0:degree) :: x, y, c
      real(wp), dimension(lanes) :: ew, e, first, last, least, most, longest, nw, nv, gap
      integer :: i, k, l

      do l = 1, lanes
         x(l, :) = shapes%w(l, :, 1, near(1, l), near(2, l))
         y(l, :) = shapes%w(l, :, 2, near(1, l), near(2, l))
         ew(l) = shapes%e(l, near(1, l), near(2, l))
      end do
      call multiply_twice(x, x, 1.0_wp, y, y, c, e)
      call pair_norm_of(x, y, nw)
      e = (e + pair_rounding*nw*nw)*up + smallest
      call range_of(c, e, first, last)
      gap = sqrt(max(first, 0.0_wp))*(1.0_wp - 4.0_wp*eps) - ew*up
      longest = sqrt(max(last, 0.0_wp))*up + ew*up
      do k = 1, shapes%q
         do i = 1, shapes%p
            associate (u => shapes%w(:, :, 1, i, k), v => shapes%w(:, :, 2, i, k), w_e => shapes%e(:, i, k))
               call multiply_twice(x, u, 1.0_wp, y, v, c, e)
               call pair_norm_of(u, v, nv)
               e = (e + pair_rounding*nw*nv + nw*w_e + nv*ew + ew*w_e)*up + smallest
            end associate
            call range_of(c, e, least, most)
            do l = 1, lanes
               if (i == near(1, l) .and. k == near(2, l)) cycle
               gap(l) = min(gap(l), (least(l)/longest(l))*(1.0_wp - sign(8.0_wp*eps, least(l))))
            end do
         end do
      end do
      where (first > 0.0_wp .and. gap > 0.0_wp) low = max(low, gap)
   end subroutine follow_corners

   !> The gap along the normals of a segment, which turn with it; where it is the better bound it is kept.
   pure subroutine turn_with(shapes, which, low)
      type(shapes_t), intent(in) :: shapes
      integer, intent(in) :: which               !! 1: the normals of the first segment, 2: of the second
      real(wp), intent(inout) :: low(lanes)
      real(wp), dimension(lanes, 0:degree) :: c
      real(wp), dimension(lanes) :: e, first, last, least, most, shortest, longest, na, nw, right, left
      integer :: n, i, k

      associate (x => shapes%side(:, :, 1, which), y => shapes%side(:, :, 2, which), side_e => shapes%side_e(:, which))
         call multiply_twice(x, x, 1.0_wp, y, y, c, e)
         call pair_norm_of(x, y, na)
         e = (e + pair_rounding*na*na)*up + smallest
         call range_of(c, e, first, last)
         shortest = sqrt(max(first, 0.0_wp))*(1.0_wp - 4.0_wp*eps) - side_e*up
         longest = sqrt(max(last, 0.0_wp))*up + side_e*up
         right = huge(1.0_wp)
         left = huge(1.0_wp)
         do n = 1, merge(shapes%q, shapes%p, which == 1)
            i = merge(1, n, which == 1)
            k = merge(n, 1, which == 1)
            associate (u => shapes%w(:, :, 1, i, k), v => shapes%w(:, :, 2, i, k), w_e => shapes%e(:, i, k))
               call multiply_twice(x, v, -1.0_wp, y, u, c, e)
               call pair_norm_of(u, v, nw)
               e = (e + pair_rounding*na*nw + na*w_e + nw*side_e + side_e*w_e)*up + smallest
            end associate
            call range_of(c, e, least, most)
            right = min(right, least)
            left = min(left, -most)
         end do
      end associate
      right = max(right, left)
      where (shortest > 0.0_wp .and. right > 0.0_wp)
         low = max(low, (right/longest)*(1.0_wp - 8.0_wp*eps))
      end where
      where (shortest > 0.0_wp .and. .not. right > 0.0_wp) low = max(low, (right/shortest)*(1.0_wp + 8.0_wp*eps))
   end subroutine turn_with

   !> Distance from lines to the right of which both ends stay.
   pure subroutine bound_edges(keeping, shapes, low, s)
      type(keeping_t), intent(in) :: keeping
      type(shapes_t), intent(in) :: shapes
      real(wp), intent(out) :: low(lanes), s(lanes)
      integer :: i, k

      low = huge(1.0_wp)
      s = 0.0_wp
      do k = 1, shapes%q
         do i = 1, shapes%p
            call take_corner(shapes, i, k, spread(keeping%normal(:, k), 2, lanes), low, s)
         end do
      end do
   end subroutine bound_edges

   !> Distance from a circle inside of which both ends stay.
   pure subroutine bound_circle(keeping, shapes, low, s)
      type(keeping_t), intent(in) :: keeping
      type(shapes_t), intent(in) :: shapes
      real(wp), intent(out) :: low(lanes), s(lanes)
      real(wp) :: c(lanes, 0:degree), e(lanes), norm(lanes), first(lanes), last(lanes)
      integer :: i

      low = huge(1.0_wp)
      s = 0.0_wp
      do i = 1, shapes%p
         associate (x => shapes%w(:, :, 1, i, 1), y => shapes%w(:, :, 2, i, 1))
            call multiply_twice(x, x, 1.0_wp, y, y, c, e)
            call pair_norm_of(x, y, norm)
         end associate
         e = (e + pair_rounding*norm*norm)*up + smallest
         call range_of(c, e, first, last)
         last = sqrt(max(last, 0.0_wp))*(1.0_wp + 4.0_wp*eps) + shapes%e(:, i, 1)
         call take_lowest(-c, (keeping%radius - last) - 2.0_wp*eps*(keeping%radius + last), low, s)
      end do
   end subroutine bound_circle
end module psalm_proof_clearance
