!> How far two convex shapes of few corners are apart: a point or a segment, and a point, a segment or a box.
!>
!> The distance where they are apart; where they overlap the negative of the shortest way that parts them. Either is the distance
!> of the origin from the polygon of all differences of their points, whose sides are parallel to theirs.
module psalm_separation
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: find_separation

   integer, parameter :: box_corners = 4
   real(wp), parameter :: rounding = 64.0_wp*epsilon(1.0_wp) !! of the coordinates: overlapping by less is touching

contains

   !> Distance of two shapes, [length], and its gradient by their corners.
   pure subroutine find_separation(p, q, distance, by_p, by_q)
      real(wp), intent(in) :: p(:, :)              !! shape (2, 2): ends of a segment; equal: a point
      real(wp), intent(in) :: q(:, :)              !! shape (2, corners): 1 a point, 2 a segment, 4 a box, anticlockwise
      real(wp), intent(out) :: distance
      real(wp), intent(out) :: by_p(:, :), by_q(:, :) !! shapes of p and of q
      real(wp) :: normal(2)
      integer :: k, i, sides
      logical :: found

      sides = merge(box_corners, size(q, 2) - 1, size(q, 2) == box_corners)
      ! overlapping: the side with the shortest way out
      if (size(q, 2) > 1) then
         distance = -huge(1.0_wp)
         call find_normal(p(:, 1), p(:, 2), normal, found)
         if (found) then
            call part(p, 1, 2, q, normal, distance, by_p, by_q)
            call part(p, 1, 2, q, -normal, distance, by_p, by_q)
         end if
         do k = 1, sides
            call find_normal(q(:, k), q(:, next(k)), normal, found)
            if (.not. found) cycle
            call part(q, k, next(k), p, -normal, distance, by_q, by_p)
            if (sides == 1) call part(q, k, next(k), p, normal, distance, by_q, by_p)
         end do
         if (-huge(1.0_wp) < distance .and. distance < -rounding*max(maxval(abs(p)), maxval(abs(q)))) return
      end if
      ! apart: a corner of one is nearest to a side of the other
      distance = huge(1.0_wp)
      do k = 1, size(q, 2)
         call come_near(p, 1, 2, q, k, distance, by_p, by_q)
      end do
      do k = 1, sides
         do i = 1, 2
            call come_near(q, k, next(k), p, i, distance, by_q, by_p)
         end do
      end do

   contains

      pure integer function next(k)
         integer, intent(in) :: k

         next = 1 + modulo(k, size(q, 2))
      end function next
   end subroutine find_separation

   !> The gap between the side from corner i to corner j of one shape and all of the other, seen along the side's normal n from
   !> the other to it; kept where it is greater than `distance`.
   pure subroutine part(one, i, j, other, n, distance, by_one, by_other)
      real(wp), intent(in) :: one(:, :), other(:, :), n(2)
      integer, intent(in) :: i, j
      real(wp), intent(inout) :: distance, by_one(:, :), by_other(:, :)
      real(wp) :: gap(size(other, 2)), foot
      integer :: k

      gap = n(1)*(one(1, i) - other(1, :)) + n(2)*(one(2, i) - other(2, :))
      k = minloc(gap, dim=1)
      if (gap(k) <= distance) return
      distance = gap(k)
      foot = foot_of(other(:, k), one(:, i), one(:, j))
      by_one = 0.0_wp
      by_other = 0.0_wp
      by_one(:, i) = (1.0_wp - foot)*n
      by_one(:, j) = foot*n
      by_other(:, k) = -n
   end subroutine part

   !> Distance of corner k of the other shape from the side from corner i to corner j of one, kept where it is less than `distance`.
   pure subroutine come_near(one, i, j, other, k, distance, by_one, by_other)
      real(wp), intent(in) :: one(:, :), other(:, :)
      integer, intent(in) :: i, j, k
      real(wp), intent(inout) :: distance, by_one(:, :), by_other(:, :)
      real(wp) :: foot, way(2), apart

      foot = foot_of(other(:, k), one(:, i), one(:, j))
      way = other(:, k) - ((1.0_wp - foot)*one(:, i) + foot*one(:, j))
      apart = hypotenuse(way(1), way(2))
      if (apart >= distance) return
      distance = apart
      if (apart > 0.0_wp) way = way/apart
      by_one = 0.0_wp
      by_other = 0.0_wp
      by_other(:, k) = way
      by_one(:, i) = -(1.0_wp - foot)*way
      by_one(:, j) = by_one(:, j) - foot*way
   end subroutine come_near

   !> Unit normal to the right of the way from a to b.
   pure subroutine find_normal(a, b, normal, found)
      real(wp), intent(in) :: a(2), b(2)
      real(wp), intent(out) :: normal(2)
      logical, intent(out) :: found          !! a and b are not one point
      real(wp) :: length

      normal = [b(2) - a(2), a(1) - b(1)]
      length = hypotenuse(normal(1), normal(2))
      found = length > 0.0_wp
      if (found) normal = normal/length
   end subroutine find_normal

   !> Where the foot of the perpendicular from a point lies between a (0) and b (1), not beyond.
   pure real(wp) function foot_of(point, a, b) result(foot)
      real(wp), intent(in) :: point(2), a(2), b(2)
      real(wp) :: unit, side(2)

      side = b - a
      unit = maxval(abs(side))
      foot = 0.0_wp
      if (unit <= 0.0_wp) return
      ! no square of a length overflows
      side = side/unit
      foot = min(max(sum(((point - a)/unit)*side)/sum(side**2), 0.0_wp), 1.0_wp)
   end function foot_of
end module psalm_separation
