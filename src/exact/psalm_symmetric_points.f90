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
   !> right angles to the line does as the pivot; its place is one of the lengths. A tangent and a curvature of both points of a
   !> pair are one condition each; on the line the path is at right angles to it, and a curvature is one.
   pure logical function leave_a_curve(points, given, slides, along, bend, is_bent)
      complex(wp), intent(in) :: points(:)           !! distinct
      complex(wp), intent(in) :: given(:)            !! pivots that were given
      logical, intent(in) :: slides                  !! the follower is a slide
      complex(wp), intent(in) :: along(:)            !! shape (points): directions of the path, 0 where none is given
      real(wp), intent(in) :: bend(:)                !! shape (points): curvatures
      logical, intent(in) :: is_bent(:)              !! shape (points): those that are given
      complex(wp) :: foot, line
      integer :: i, k, conditions, free

      free = lengths - size(given) + merge(1, 2, slides)
      leave_a_curve = .true.
      do i = 1, size(points)
         do k = i + 1, size(points)
            ! between both points, or through them
            line = (points(k) - points(i))/abs(points(k) - points(i))
            foot = points(i)
            call count_conditions(conditions)
            if (conditions < free) return
            foot = 0.5_wp*(points(i) + points(k))
            line = (0.0_wp, 1.0_wp)*line
            call count_conditions(conditions)
            if (conditions < free) return
         end do
      end do
      leave_a_curve = .false.

   contains

      !> What the points ask of linkages that are symmetric about the line; a large number if they are not symmetric.
      pure subroutine count_conditions(number)
         integer, intent(out) :: number
         complex(wp) :: image
         integer :: j, m, terms

         number = huge(1)
         if (.not. all(abs(aimag((given - foot)*conjg(line))) <= tolerance())) return
         number = 0
         do j = 1, size(points)
            image = foot + line*conjg((points(j) - foot)*conjg(line))
            m = minloc(abs(points - image), dim=1)
            terms = max(terms_at(j), terms_at(m))
            if (.not. (abs(points(m) - image) <= tolerance() .and. fits(j, m))) then
               number = huge(1)
               return
            end if
            if (m == j) then
               number = number + 1 + max(terms - 1, 0)
            else if (m > j) then
               number = number + 1 + terms
            end if
         end do
      end subroutine count_conditions

      !> Derivatives given at a point.
      pure integer function terms_at(j)
         integer, intent(in) :: j

         terms_at = 0
         if (abs(along(j)) > 0.0_wp) terms_at = merge(2, 1, is_bent(j))
      end function terms_at

      !> True if tangent and curvature at one point are the mirror image of those at the other, as far as both have some. The image
      !> of a path bends the other way.
      pure logical function fits(j, m)
         integer, intent(in) :: j, m
         complex(wp) :: turned

         fits = terms_at(j) == 0 .or. terms_at(m) == 0
         if (fits) return
         turned = along(m)*conjg(line*conjg(along(j)*conjg(line)))
         if (m == j) turned = (0.0_wp, 1.0_wp)*along(j)*conjg(line)
         fits = abs(aimag(turned)) <= on_line
         if (.not. fits .or. m == j .or. min(terms_at(j), terms_at(m)) < 2) return
         fits = abs(bend(m) + sign(1.0_wp, real(turned, wp))*bend(j)) <= on_line*max(abs(bend(j)), abs(bend(m)))
      end function fits

      pure real(wp) function tolerance()
         tolerance = on_line*maxval(abs(points - points(1)))
      end function tolerance
   end function leave_a_curve
end module psalm_symmetric_points
