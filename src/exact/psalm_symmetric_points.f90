!> Points that lie symmetrically about a line: they may leave a whole curve of linkages.
module psalm_symmetric_points
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: leave_a_curve

   real(wp), parameter :: on_line = 1.0e-7_wp        !! distance of a point from a mirror image or the line, over the size of all
   integer, parameter :: lengths = 4                 !! crank, both parts of the coupler, follower (the place of the slide)

contains

   !> True if points that are met in any order and time are symmetric about a line and leave a curve of linkages that are symmetric
   !> about it, too: both pivots on the line, the coupler point on the line through the coupler's joints. The mirror image of a
   !> position of such a linkage is another of its positions, so it meets both points of a pair where it meets one. Each pair and
   !> each point on the line is one condition, for four lengths and a place on the line for each pivot that is free. A slide at
   !> right angles to the line does as the pivot; its place is one of the lengths.
   pure logical function leave_a_curve(points, given, slides)
      complex(wp), intent(in) :: points(:)           !! distinct
      complex(wp), intent(in) :: given(:)            !! pivots that were given
      logical, intent(in) :: slides                  !! the follower is a slide
      complex(wp) :: foot, along
      integer :: i, k, on, free

      free = lengths - size(given) + merge(1, 2, slides)
      leave_a_curve = .true.
      do i = 1, min(2, size(points))   ! with two points on the line there is no curve
         do k = i + 1, size(points)
            foot = 0.5_wp*(points(i) + points(k))
            along = (0.0_wp, 1.0_wp)*(points(k) - points(i))
            along = along/abs(along)
            if (.not. are_mirrored()) cycle
            on = count(abs(aimag((points - foot)*conjg(along))) <= tolerance())
            if (on + (size(points) - on)/2 < free) return
         end do
      end do
      leave_a_curve = .false.

   contains

      !> True if each point has its mirror image among them and the pivots are on the line.
      pure logical function are_mirrored()
         complex(wp) :: image
         integer :: j

         are_mirrored = all(abs(aimag((given - foot)*conjg(along))) <= tolerance())
         do j = 1, size(points)
            if (.not. are_mirrored) return
            image = foot + along*conjg((points(j) - foot)*conjg(along))
            are_mirrored = minval(abs(points - image)) <= tolerance()
         end do
      end function are_mirrored

      pure real(wp) function tolerance()
         tolerance = on_line*maxval(abs(points - points(1)))
      end function tolerance
   end function leave_a_curve
end module psalm_symmetric_points
