!> The outline of a link: what lies within half its width of the plate between its joints.
module psalm_link_outline
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   use psalm_parts, only: convex_hull
   implicit none (type, external)
   private
   public :: outline_t, outline_of, spine_of

   !> A closed line of straight pieces and arcs, anticlockwise.
   type :: outline_t
      real(wp), allocatable :: x(:), y(:)
      real(wp), allocatable :: bulge(:)    !! tangent of a quarter of the angle of the arc from a vertex to the next; 0: straight
   end type outline_t

contains

   !> Numbers of the points that the plate is spanned by, anticlockwise: its corners; of points on a line the two outermost, of
   !> points at one place a single one.
   function spine_of(x, y) result(spine)
      real(wp), intent(in) :: x(:), y(:)   !! at least one
      integer, allocatable :: spine(:)
      real(wp) :: farthest, away
      integer :: i, k, ends(2)

      spine = convex_hull([(i, i=1, size(x))], x, y)
      if (size(spine) > 0) return
      farthest = 0.0_wp
      ends = 1
      do i = 1, size(x)
         do k = i + 1, size(x)
            away = hypotenuse(x(k) - x(i), y(k) - y(i))
            if (away <= farthest) cycle
            farthest = away
            ends = [i, k]
         end do
      end do
      spine = ends
      if (farthest <= 0.0_wp) spine = ends(:1)
   end function spine_of

   !> The outline at a distance round the corners, with an arc about each.
   pure function outline_of(x, y, distance) result(outline)
      real(wp), intent(in) :: x(:), y(:)   !! corners, anticlockwise; two are the ends of a bar, one is the centre of a disc
      real(wp), intent(in) :: distance     !! 0: the corners themselves
      type(outline_t) :: outline
      real(wp) :: normal(2, size(x)), length
      integer :: i, before, n

      n = size(x)
      if (n == 1) then
         outline%x = [x(1) - distance, x(1) + distance]
         outline%y = [y(1), y(1)]
         outline%bulge = [1.0_wp, 1.0_wp]
         return
      end if
      if (distance <= 0.0_wp) then
         outline%x = x
         outline%y = y
         allocate (outline%bulge(n), source=0.0_wp)
         return
      end if
      do i = 1, n
         associate (next => modulo(i, n) + 1)
            length = hypotenuse(x(next) - x(i), y(next) - y(i))
            normal(:, i) = [y(next) - y(i), x(i) - x(next)]/length
         end associate
      end do
      allocate (outline%x(2*n), outline%y(2*n), outline%bulge(2*n), source=0.0_wp)
      do i = 1, n
         before = modulo(i - 2, n) + 1
         outline%x(2*i - 1:2*i) = x(i) + distance*[normal(1, before), normal(1, i)]
         outline%y(2*i - 1:2*i) = y(i) + distance*[normal(2, before), normal(2, i)]
         ! tan(a/4) from the half angle: the arc turns by the angle a between the normals, at most 180 degrees
         associate (c => hypotenuse(normal(1, before) + normal(1, i), normal(2, before) + normal(2, i)), &
                    s => hypotenuse(normal(1, before) - normal(1, i), normal(2, before) - normal(2, i)))
            outline%bulge(2*i - 1) = s/(2.0_wp + c)
         end associate
      end do
   end function outline_of
end module psalm_link_outline
