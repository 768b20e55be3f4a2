!> Vectors of the plane in axes that are turned; an axis is the unit vector of their x direction.
module psalm_axes
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: into_axes, out_of_axes, quarter_turn

contains

   !> Components along the axes of a vector.
   pure function into_axes(axis, vector) result(own)
      real(wp), intent(in) :: axis(2), vector(2)
      real(wp) :: own(2)

      own = [axis(1)*vector(1) + axis(2)*vector(2), axis(1)*vector(2) - axis(2)*vector(1)]
   end function into_axes

   !> The vector whose components along the axes are given.
   pure function out_of_axes(axis, own) result(vector)
      real(wp), intent(in) :: axis(2), own(2)
      real(wp) :: vector(2)

      vector = [axis(1)*own(1) - axis(2)*own(2), axis(1)*own(2) + axis(2)*own(1)]
   end function out_of_axes

   !> A vector turned by 90 degrees anticlockwise.
   pure function quarter_turn(vector) result(turned)
      real(wp), intent(in) :: vector(2)
      real(wp) :: turned(2)

      turned = [-vector(2), vector(1)]
   end function quarter_turn
end module psalm_axes
