!> The outline of a link, what lies within half its width of the plate between its joints: its pieces, area and moments.
module psalm_link_outline
   use psalm_angles, only: degrees_of
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp, pi, radians_per_degree
   implicit none (type, external)
   private
   public :: outline_t, outline_of, spine_of, convex_hull
   public :: area_moments, moments_of, disc_moments, moment_area, moment_x, moment_y, moment_polar

   real(wp), parameter :: flat = 1.0e-3_wp !! a hull with less area than this times its width squared is a line

   integer, parameter :: area_moments = 4  !! of a region: its
   integer, parameter :: moment_area = 1, moment_x = 2, moment_y = 3, moment_polar = 4 !! area, first moments, polar second moment

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

   !> Joints round the outline of a set of points, anticlockwise; size 0 if they lie on a line.
   function convex_hull(joints, x, y) result(hull)
      integer, intent(in) :: joints(:)
      real(wp), intent(in) :: x(:), y(:)       !! shape as `joints`
      integer, allocatable :: hull(:)
      integer :: order(size(joints)), chain(2*size(joints)), i, k, first, count
      real(wp) :: u(size(joints)), v(size(joints)), width

      allocate (hull(0))
      width = max(maxval(x) - minval(x), maxval(y) - minval(y))
      if (size(joints) < 3 .or. width <= 0.0_wp) return
      u = (x - minval(x))/width
      v = (y - minval(y))/width
      order = [(i, i=1, size(joints))]
      do i = 2, size(order)
         do k = i, 2, -1
            if (u(order(k)) > u(order(k - 1)) .or. (u(order(k)) >= u(order(k - 1)) .and. v(order(k)) >= v(order(k - 1)))) exit
            order([k - 1, k]) = order([k, k - 1])
         end do
      end do
      count = 0
      first = 1
      do i = 1, size(order)
         call push(order(i))
      end do
      first = count
      do i = size(order) - 1, 1, -1
         call push(order(i))
      end do
      count = count - 1
      if (count < 3 .or. area() < flat) return
      hull = joints(chain(:count))

   contains

      !> Put a point on the outline; points it leaves to its right go.
      subroutine push(point)
         integer, intent(in) :: point

         do while (count > first)
            associate (a => chain(count - 1), b => chain(count))
               if ((u(b) - u(a))*(v(point) - v(b)) - (v(b) - v(a))*(u(point) - u(b)) > flat*flat) exit
            end associate
            count = count - 1
         end do
         count = count + 1
         chain(count) = point
      end subroutine push

      pure real(wp) function area()
         integer :: m

         area = 0.0_wp
         do m = 1, count
            associate (a => chain(m), b => chain(modulo(m, count) + 1))
               area = area + 0.5_wp*(u(a)*v(b) - u(b)*v(a))
            end associate
         end do
      end function area
   end function convex_hull

   !> Area, first moments and polar second moment, about the origin, of what `outline_of` encloses.
   !>
   !> The region is the polygon of the corners, a rectangle along each side and a sector about each corner: exact.
   pure function moments_of(x, y, distance) result(moments)
      real(wp), intent(in) :: x(:), y(:)   !! corners as `outline_of` has them
      real(wp), intent(in) :: distance
      real(wp) :: moments(area_moments)
      real(wp) :: normal(2, size(x)), length, cross, angle, sector(2), middle(2)
      integer :: i, next, before, n

      n = size(x)
      moments = 0.0_wp
      if (n == 1) then
         moments = disc_moments(x(1), y(1), distance)
         return
      end if
      do i = 2, n - 1   ! triangles about the first corner
         associate (p => [x(i) - x(1), y(i) - y(1)], q => [x(i + 1) - x(1), y(i + 1) - y(1)])
            cross = p(1)*q(2) - p(2)*q(1)
            middle = (p + q)/3.0_wp
            call add(moments, 0.5_wp*cross, [x(1), y(1)], 0.5_wp*cross*middle, &
                     cross*(p(1)**2 + p(2)**2 + p(1)*q(1) + p(2)*q(2) + q(1)**2 + q(2)**2)/12.0_wp)
         end associate
      end do
      if (distance <= 0.0_wp) return
      do i = 1, n
         next = modulo(i, n) + 1
         length = hypotenuse(x(next) - x(i), y(next) - y(i))
         normal(:, i) = [y(next) - y(i), x(i) - x(next)]/length
         middle = 0.5_wp*[x(i) + x(next), y(i) + y(next)] + 0.5_wp*distance*normal(:, i)
         call add(moments, length*distance, middle, [0.0_wp, 0.0_wp], length*distance*(length**2 + distance**2)/12.0_wp)
      end do
      do i = 1, n
         before = modulo(i - 2, n) + 1
         associate (from => normal(:, before), to => normal(:, i))
            angle = 2.0_wp*radians_per_degree*degrees_of(hypotenuse(from(1) + to(1), from(2) + to(2)), &
                                                         hypotenuse(from(1) - to(1), from(2) - to(2)))
            sector = distance**3/3.0_wp*[to(2) - from(2), from(1) - to(1)]
         end associate
         call add(moments, 0.5_wp*distance**2*angle, [x(i), y(i)], sector, 0.25_wp*distance**4*angle)
      end do

   contains

      !> A part by its moments about a point.
      pure subroutine add(moments, area, at, first, polar)
         real(wp), intent(inout) :: moments(area_moments)
         real(wp), intent(in) :: area, at(2), first(2), polar

         moments(moment_area) = moments(moment_area) + area
         moments(moment_x) = moments(moment_x) + first(1) + area*at(1)
         moments(moment_y) = moments(moment_y) + first(2) + area*at(2)
         moments(moment_polar) = moments(moment_polar) + polar + 2.0_wp*(at(1)*first(1) + at(2)*first(2)) + &
                                 area*(at(1)**2 + at(2)**2)
      end subroutine add
   end function moments_of

   !> The same of a disc.
   pure function disc_moments(x, y, radius) result(moments)
      real(wp), intent(in) :: x, y, radius
      real(wp) :: moments(area_moments)

      moments(moment_area) = pi*radius**2
      moments(moment_x) = moments(moment_area)*x
      moments(moment_y) = moments(moment_area)*y
      moments(moment_polar) = moments(moment_area)*(x**2 + y**2 + 0.5_wp*radius**2)
   end function disc_moments
end module psalm_link_outline
