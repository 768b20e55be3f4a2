!> Where the centre of a cam may lie for a pressure angle: a convex polygon, exact for any linkage, and in it the smallest cam.
!>
!> Relative to the cam the roller moves, measured along its line of travel f, with V = (c' - j c + j O)/f, linear in the centre O:
!> |alpha| <= limit is for each cam angle |Re V| <= tan(limit) s Im V, two half-planes, s = +-1 the side of the path on which the
!> cam lies. Source: derivation in doc/theory.md.
module psalm_cam_centres
   use psalm_angles, only: unit_vector
   use psalm_cam_motion, only: cam_trace_t
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: centres_t, admissible_centres

   real(wp), parameter :: rounding = 1.0e-12_wp !! of corners, in sizes of the follower's path
   real(wp), parameter :: far = 1.0e4_wp      !! the box that is cut, in sizes of the follower's path

   !> The polygon of one side, anticlockwise; without corners where there is no centre.
   type :: centres_t
      complex(wp), allocatable :: corners(:)
      complex(wp) :: smallest = (0.0_wp, 0.0_wp) !! the centre of the smallest cam
      real(wp) :: base = 0.0_wp                  !! its pitch curve's least radius
      logical :: open = .false.                  !! the polygon goes on to infinity
   end type centres_t

contains

   !> Admissible centres on one side.
   subroutine admissible_centres(states, wanted, sense, side, limit, centres)
      type(cam_trace_t), intent(in) :: states
      logical, intent(in) :: wanted(:)           !! cam angles at which the limit is to be kept
      real(wp), intent(in) :: sense              !! +1: the cam turns anticlockwise
      real(wp), intent(in) :: side               !! s
      real(wp), intent(in) :: limit              !! degrees
      type(centres_t), intent(out) :: centres
      complex(wp), allocatable :: polygon(:)
      complex(wp) :: f, g, v0, middle
      real(wp) :: c, s, tangent, size_of_path, box, size_f
      integer :: i, way

      call unit_vector(limit, c, s)
      tangent = s/c
      middle = sum(states%c(0, :))/real(size(states%angle), wp)
      size_of_path = maxval(hypotenuse(real(states%c(0, :) - middle, wp), aimag(states%c(0, :) - middle)))
      box = far*size_of_path
      polygon = middle + box*[(-1.0_wp, -1.0_wp), (1.0_wp, -1.0_wp), (1.0_wp, 1.0_wp), (-1.0_wp, 1.0_wp)]
      do i = 1, size(states%angle)
         if (.not. wanted(i)) cycle
         f = states%by_input(i)
         size_f = hypotenuse(real(f, wp), aimag(f))
         f = f/size_f
         ! V = v0 + g O
         g = cmplx(0.0_wp, sense, wp)*conjg(f)
         v0 = (states%c(1, i) - cmplx(0.0_wp, sense, wp)*states%c(0, i))*conjg(f)
         do way = -1, 1, 2
            ! tangent s Im V - way Re V >= 0: a (x) + b (y) + d >= 0 with O = x + i y
            call cut(polygon, half(g), half(g*(0.0_wp, 1.0_wp)), half(v0), rounding*size_of_path)
            if (size(polygon) == 0) exit
         end do
         if (size(polygon) == 0) exit
      end do
      centres%corners = polygon
      if (size(polygon) == 0) return
      centres%open = any(max(abs(real(polygon - middle, wp)), abs(aimag(polygon - middle))) > 0.5_wp*box)
      call find_smallest(states, centres)

   contains

      pure real(wp) function half(value)
         complex(wp), intent(in) :: value

         half = tangent*side*aimag(value) - real(way, wp)*real(value, wp)
      end function half
   end subroutine admissible_centres

   !> Keep the part of a convex polygon where a x + b y + d >= 0.
   pure subroutine cut(polygon, a, b, d, near)
      complex(wp), allocatable, intent(inout) :: polygon(:)
      real(wp), intent(in) :: a, b, d
      real(wp), intent(in) :: near               !! corners no farther apart are one
      complex(wp) :: kept(2*size(polygon))
      real(wp) :: value(size(polygon))
      integer :: n, m, i, next

      n = size(polygon)
      value = a*real(polygon, wp) + b*aimag(polygon) + d
      if (all(value >= 0.0_wp)) return
      m = 0
      do i = 1, n
         next = modulo(i, n) + 1
         if (value(i) >= 0.0_wp) call keep(polygon(i), near, kept, m)
         if (value(i)*value(next) < 0.0_wp) &
            call keep(polygon(i) + (value(i)/(value(i) - value(next)))*(polygon(next) - polygon(i)), near, kept, m)
      end do
      if (m < 3) m = 0
      polygon = kept(:m)
   end subroutine cut

   !> A further corner, unless it is the last one again.
   pure subroutine keep(corner, near, kept, m)
      complex(wp), intent(in) :: corner
      real(wp), intent(in) :: near
      complex(wp), intent(inout) :: kept(:)
      integer, intent(inout) :: m

      if (m > 0) then
         if (abs(real(corner - kept(m), wp)) + abs(aimag(corner - kept(m))) <= near) return
      end if
      m = m + 1
      kept(m) = corner
   end subroutine keep

   !> The centre with the least pitch radius: of the points of the polygon nearest to the ends of the roller's way that which is
   !> nearest to its whole way.
   pure subroutine find_smallest(states, centres)
      type(cam_trace_t), intent(in) :: states
      type(centres_t), intent(inout) :: centres
      complex(wp) :: ends(2), nearest
      real(wp) :: base
      integer :: k

      ends(1) = states%c(0, minloc(states%q(0, :), dim=1))
      ends(2) = states%c(0, maxloc(states%q(0, :), dim=1))
      centres%base = huge(1.0_wp)
      do k = 1, 2
         nearest = nearest_of(centres%corners, ends(k))
         base = minval(hypotenuse(real(states%c(0, :) - nearest, wp), aimag(states%c(0, :) - nearest)))
         ! the end is the lowest place only if no other is nearer
         if (abs(base - hypotenuse(real(ends(k) - nearest, wp), aimag(ends(k) - nearest))) > 1.0e-9_wp*base) cycle
         if (base >= centres%base) cycle
         centres%base = base
         centres%smallest = nearest
      end do
   end subroutine find_smallest

   !> The point of a convex polygon nearest to a point outside; the point itself if it lies within.
   pure complex(wp) function nearest_of(corners, point) result(nearest)
      complex(wp), intent(in) :: corners(:), point
      complex(wp) :: edge, foot
      real(wp) :: share, least, r
      integer :: i
      logical :: within

      within = .true.
      least = huge(1.0_wp)
      nearest = point
      do i = 1, size(corners)
         edge = corners(modulo(i, size(corners)) + 1) - corners(i)
         within = within .and. aimag(conjg(edge)*(point - corners(i))) >= 0.0_wp
         share = real(conjg(edge)*(point - corners(i)), wp)/max(real(conjg(edge)*edge, wp), tiny(1.0_wp))
         foot = corners(i) + min(max(share, 0.0_wp), 1.0_wp)*edge
         r = hypotenuse(real(point - foot, wp), aimag(point - foot))
         if (r >= least) cycle
         least = r
         nearest = foot
      end do
      if (within) nearest = point
   end function nearest_of
end module psalm_cam_centres
