!> How near joints and links of a sketch with larger groups come to regions and to each other, over what tubes prove.
!>
!> In a tube a joint goes along a quadratic but for its third derivative and for what the tube leaves open. Of two convex shapes the
!> distance is at least how far they are apart along any direction; along that of the distance in the middle of a tube the corners
!> go along quadratics, too. Of other clearances it is known that they change by no more than their points move. The tube with the
!> lowest bound is halved until the bound and a distance that is reached agree.
module psalm_chain_clearance_proof
   use psalm_clearances, only: clearance_t, find_corners, find_depth, points_of_clearance
   use psalm_closure, only: closure_t
   use psalm_constraint_group, only: region_box, region_circle
   use psalm_kinds, only: wp
   use psalm_proof_chain, only: chain_tubes_t
   use psalm_proof_numbers, only: play_of_joint
   use psalm_proof_clearance, only: nearest_t
   use psalm_proof_tube, only: tube_t, half_of, point_majorant, degree
   implicit none (type, external)
   private
   public :: bracket_clearance

   real(wp), parameter :: enough = 1.0e-7_wp     !! width of a bracket, of the drawing's size
   integer, parameter :: most_halvings = 2000, first_room = 64

   !> A tube of one's own, which may be halved.
   type :: part_t
      type(tube_t) :: tube
      integer :: segment = 0
      real(wp) :: low = 0.0_wp                   !! bound of the clearance
   end type part_t

contains

   !> The least clearance, bracketed, and where it is: `segment` and `way`, part of that segment.
   subroutine bracket_clearance(closure, clearance, tubes, nearest, segment, way)
      type(closure_t), intent(in) :: closure       !! of the tubes
      type(clearance_t), intent(in) :: clearance   !! its points are joints of the sketch
      type(chain_tubes_t), intent(in) :: tubes
      type(nearest_t), intent(out) :: nearest      !! without the place
      integer, intent(out) :: segment
      real(wp), intent(out) :: way
      type(part_t), allocatable :: parts(:), more(:)
      type(tube_t) :: halves(2)
      integer :: i, n, lowest

      segment = 0
      way = 0.0_wp
      nearest%found = tubes%count > 0
      if (.not. nearest%found) return
      n = tubes%count
      allocate (parts(n + first_room))
      do i = 1, n
         parts(i)%tube = tubes%parts(i)%tube
         parts(i)%segment = tubes%parts(i)%segment
         call bound(parts(i))
      end do
      do
         lowest = minloc(parts(:n)%low, dim=1)
         nearest%low = parts(lowest)%low
         if (nearest%high - nearest%low <= enough*closure%size .or. n >= tubes%count + most_halvings) exit
         call half_of(closure, parts(lowest)%tube, -1, halves(1))
         call half_of(closure, parts(lowest)%tube, 1, halves(2))
         if (.not. (halves(1)%holds .and. halves(2)%holds)) exit
         if (n == size(parts)) then
            allocate (more(2*n))
            more(:n) = parts
            call move_alloc(more, parts)
         end if
         n = n + 1
         parts(n)%segment = parts(lowest)%segment
         parts(lowest)%tube = halves(1)
         parts(n)%tube = halves(2)
         call bound(parts(lowest))
         call bound(parts(n))
      end do

   contains

      !> How far a joint may be from its quadratic anywhere in a tube.
      real(wp) function what_is_open(tube, joint)
         type(tube_t), intent(in) :: tube
         integer, intent(in) :: joint
         real(wp) :: p(0:degree)

         what_is_open = 0.0_wp
         if (joint == 0) return
         p = point_majorant(closure, tube, joint, closure%holder(joint))
         what_is_open = p(3)*tube%r**3/6.0_wp + play_of_joint(closure, tube, joint)
      end function what_is_open

      !> The lower bound over a tube; a distance that is reached in its middle.
      subroutine bound(part)
         type(part_t), intent(inout) :: part
         real(wp) :: at(2, points_of_clearance), by(2, points_of_clearance), moves(points_of_clearance), depth, value, play
         complex(wp) :: z(0:2, points_of_clearance)  ! places in the middle of the tube, and derivatives
         integer :: p

         z = (0.0_wp, 0.0_wp)
         moves = 0.0_wp
         associate (tube => part%tube, h => part%tube%r)
            do p = 1, points_of_clearance
               if (clearance%points(p) == 0) cycle
               z(:, p) = tube%state%joint(clearance%points(p), :2)
               moves(p) = h*(abs(z(1, p)) + 0.5_wp*h*abs(z(2, p)))
            end do
            at(1, :) = z(0, :)%re
            at(2, :) = z(0, :)%im
            call find_depth(clearance, at, depth, by)
            value = clearance%asked - depth
            play = max(what_is_open(tube, clearance%points(1)), what_is_open(tube, clearance%points(2)))
            if (clearance%region == 0) play = play + max(what_is_open(tube, clearance%points(3)), &
                                                         what_is_open(tube, clearance%points(4)))
            part%low = value - maxval(moves(:2))
            if (clearance%region == 0) part%low = part%low - maxval(moves(3:))
            if (is_of_convex_shapes()) part%low = max(part%low, apart_along(-sum(by(:, :2), dim=2), z, h))
            part%low = part%low - play
            if (value + play >= nearest%high) return
            nearest%high = value + play
            segment = part%segment
            way = tube%middle
         end associate
      end subroutine bound

      !> True of the distance of links from each other and from what they are to keep outside of.
      logical function is_of_convex_shapes()
         is_of_convex_shapes = clearance%region == 0
         if (is_of_convex_shapes .or. clearance%shape%stay_inside) return
         is_of_convex_shapes = clearance%shape%kind == region_circle .or. &
                               (clearance%shape%kind == region_box .and. clearance%segments(1) > 0)
      end function is_of_convex_shapes

      !> How far two shapes are apart at least along a direction, less half their widths, over a tube.
      real(wp) function apart_along(gradient, z, h) result(least)
         real(wp), intent(in) :: gradient(2)       !! of the distance by the place of the first shape
         complex(wp), intent(in) :: z(0:, :)       !! shape (0:2, points)
         real(wp), intent(in) :: h
         real(wp) :: normal(2), corners(2, points_of_clearance), w(0:2)
         integer :: i, j, n, order

         least = -huge(1.0_wp)
         if (.not. norm2(gradient) > 0.0_wp) return
         normal = gradient/norm2(gradient)
         least = huge(1.0_wp)
         n = 2
         if (clearance%region > 0) call find_corners(clearance%shape, corners, n)
         do i = 1, 2
            do j = 1, n
               do order = 0, 2
                  w(order) = normal(1)*z(order, i)%re + normal(2)*z(order, i)%im
                  if (clearance%region == 0) w(order) = w(order) - (normal(1)*z(order, 2 + j)%re + normal(2)*z(order, 2 + j)%im)
               end do
               if (clearance%region > 0) w(0) = w(0) - dot_product(normal, corners(:, j))
               ! the least of a quadratic: at an end, or where it turns
               if (abs(w(1)) < h*w(2)) then
                  least = min(least, w(0) - 0.5_wp*w(1)**2/w(2))
               else
                  least = min(least, w(0) - h*abs(w(1)) + 0.5_wp*h*h*w(2))
               end if
            end do
         end do
         least = least - clearance%reach
         if (clearance%region > 0 .and. clearance%shape%kind == region_circle) least = least - clearance%shape%at(3)
      end function apart_along
   end subroutine bracket_clearance
end module psalm_chain_clearance_proof
