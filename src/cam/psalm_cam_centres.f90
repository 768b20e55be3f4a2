!> Where the centre of a cam may lie for a pressure angle: a convex polygon, exact for any linkage, and in it the smallest cam.
!>
!> Relative to the cam the roller moves, measured along its line of travel f, with V = (c' - j c + j O)/f, linear in the centre O:
!> |alpha| <= limit is for each cam angle |Re V| <= tan(limit) s Im V, two half-planes, s = +-1 the side of the path on which the
!> cam lies. Source: derivation in doc/theory/cams.md.
module psalm_cam_centres
   use psalm_angles, only: unit_vector
   use psalm_cam_trace, only: cam_trace_t
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: centres_t, admissible_centres, tightest_angles, sharpen_centres

   real(wp), parameter :: rounding = 1.0e-12_wp !! of corners, in sizes of the follower's path
   real(wp), parameter :: same_base = 1.0e-9_wp !! relative difference of radii that is rounding
   real(wp), parameter :: far = 1.0e4_wp      !! the box that is cut, in sizes of the follower's path

   !> The polygon of one side, anticlockwise; without corners where there is no centre.
   type :: centres_t
      complex(wp), allocatable :: corners(:)
      complex(wp) :: smallest = (0.0_wp, 0.0_wp) !! the centre of the smallest cam
      real(wp) :: base = 0.0_wp                  !! its pitch curve's least radius
      logical :: open = .false.                  !! the polygon goes on to infinity
      complex(wp) :: ends(2) = (0.0_wp, 0.0_wp)  !! of the roller's way
      real(wp) :: near = 0.0_wp                  !! corners no farther apart are one
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
      complex(wp) :: middle
      real(wp) :: size_of_path, box, tangent
      integer :: i

      tangent = tangent_of(limit)
      middle = sum(states%c(0, :))/real(size(states%angle), wp)
      size_of_path = maxval(hypotenuse(real(states%c(0, :) - middle, wp), aimag(states%c(0, :) - middle)))
      box = far*size_of_path
      polygon = middle + box*[(-1.0_wp, -1.0_wp), (1.0_wp, -1.0_wp), (1.0_wp, 1.0_wp), (-1.0_wp, 1.0_wp)]
      do i = 1, size(states%angle)
         if (wanted(i)) call cut_both(states, i, sense, side, tangent, rounding*size_of_path, polygon)
         if (size(polygon) == 0) exit
      end do
      centres%corners = polygon
      if (size(polygon) == 0) return
      centres%open = any(max(abs(real(polygon - middle, wp)), abs(aimag(polygon - middle))) > 0.5_wp*box)
      centres%near = rounding*size_of_path
      call find_ends(states, centres)
      call find_smallest(states, centres)
   end subroutine admissible_centres

   !> Cam angles between the samples at which the limit is tightest for the smallest cam: for either half-plane the least of every
   !> run of wanted samples on one piece of the law, by a parabola.
   pure subroutine tightest_angles(states, piece, wanted, sense, side, limit, centres, angle, of_piece)
      type(cam_trace_t), intent(in) :: states
      integer, intent(in) :: piece(:)            !! of the law, by sample
      logical, intent(in) :: wanted(:)
      real(wp), intent(in) :: sense, side, limit
      type(centres_t), intent(in) :: centres
      real(wp), allocatable, intent(out) :: angle(:)
      integer, allocatable, intent(out) :: of_piece(:)
      real(wp) :: slack(2, size(piece)), tangent, bend, step
      integer :: first, last, way, i

      allocate (angle(0), of_piece(0))
      if (size(centres%corners) == 0) return
      tangent = tangent_of(limit)
      do i = 1, size(piece)
         do way = 1, 2
            slack(way, i) = slack_of(states, i, sense, side, tangent, way, centres%smallest)
         end do
      end do
      first = 1
      do while (first <= size(piece))
         last = first
         do while (last < size(piece))
            if (piece(last + 1) /= piece(first)) exit
            last = last + 1
         end do
         do way = 1, 2
            if (.not. wanted(first)) exit
            i = first - 1 + minloc(slack(way, first:last), dim=1)
            if (i == first .or. i == last) cycle
            bend = slack(way, i - 1) - 2.0_wp*slack(way, i) + slack(way, i + 1)
            if (.not. bend > 0.0_wp) cycle
            step = 0.5_wp*(slack(way, i - 1) - slack(way, i + 1))/bend
            angle = [angle, states%angle(i) + step*(states%angle(i + 1) - states%angle(i))]
            of_piece = [of_piece, piece(first)]
         end do
         first = last + 1
      end do
   end subroutine tightest_angles

   !> Cut with the half-planes of further cam angles.
   pure subroutine sharpen_centres(states, more, sense, side, limit, centres)
      type(cam_trace_t), intent(in) :: states    !! of the turn
      type(cam_trace_t), intent(in) :: more      !! at the angles
      real(wp), intent(in) :: sense, side, limit
      type(centres_t), intent(inout) :: centres
      integer :: i

      do i = 1, size(more%angle)
         call cut_both(more, i, sense, side, tangent_of(limit), centres%near, centres%corners)
         if (size(centres%corners) == 0) return
      end do
      call find_smallest(states, centres)
   end subroutine sharpen_centres

   pure real(wp) function tangent_of(limit)
      real(wp), intent(in) :: limit              !! degrees
      real(wp) :: c, s

      call unit_vector(limit, c, s)
      tangent_of = s/c
   end function tangent_of

   !> How far within one of the two half-planes of a cam angle a centre lies, times a factor: tangent s Im V -+ Re V.
   pure real(wp) function slack_of(states, i, sense, side, tangent, way, centre) result(slack)
      type(cam_trace_t), intent(in) :: states
      integer, intent(in) :: i, way              !! sample; 1 or 2
      real(wp), intent(in) :: sense, side, tangent
      complex(wp), intent(in) :: centre
      complex(wp) :: g, v0

      call line_of_travel(states, i, sense, g, v0)
      slack = half(v0 + g*centre, side, tangent, way)
   end function slack_of

   !> V = v0 + g O at a sample.
   pure subroutine line_of_travel(states, i, sense, g, v0)
      type(cam_trace_t), intent(in) :: states
      integer, intent(in) :: i
      real(wp), intent(in) :: sense
      complex(wp), intent(out) :: g, v0
      complex(wp) :: f

      f = states%by_input(i)
      f = f/hypotenuse(real(f, wp), aimag(f))
      g = cmplx(0.0_wp, sense, wp)*conjg(f)
      v0 = (states%c(1, i) - cmplx(0.0_wp, sense, wp)*states%c(0, i))*conjg(f)
   end subroutine line_of_travel

   pure real(wp) function half(value, side, tangent, way)
      complex(wp), intent(in) :: value
      real(wp), intent(in) :: side, tangent
      integer, intent(in) :: way

      half = tangent*side*aimag(value) - real(2*way - 3, wp)*real(value, wp)
   end function half

   !> Keep what obeys both half-planes of a sample: with O = x + i y each is a x + b y + d >= 0.
   pure subroutine cut_both(states, i, sense, side, tangent, near, polygon)
      type(cam_trace_t), intent(in) :: states
      integer, intent(in) :: i
      real(wp), intent(in) :: sense, side, tangent, near
      complex(wp), allocatable, intent(inout) :: polygon(:)
      complex(wp) :: g, v0
      integer :: way

      call line_of_travel(states, i, sense, g, v0)
      do way = 1, 2
         if (size(polygon) == 0) return
         call cut(polygon, half(g, side, tangent, way), half(g*(0.0_wp, 1.0_wp), side, tangent, way), &
                  half(v0, side, tangent, way), near)
      end do
   end subroutine cut_both

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

   pure subroutine find_ends(states, centres)
      type(cam_trace_t), intent(in) :: states
      type(centres_t), intent(inout) :: centres

      centres%ends(1) = states%c(0, minloc(states%q(0, :), dim=1))
      centres%ends(2) = states%c(0, maxloc(states%q(0, :), dim=1))
   end subroutine find_ends

   !> The centre with the least pitch radius: of the points of the polygon nearest to the ends of the roller's way that which is
   !> nearest to its whole way.
   pure subroutine find_smallest(states, centres)
      type(cam_trace_t), intent(in) :: states
      type(centres_t), intent(inout) :: centres
      complex(wp) :: nearest
      real(wp) :: base
      integer :: k

      centres%base = huge(1.0_wp)
      do k = 1, 2
         nearest = nearest_of(centres%corners, centres%ends(k))
         base = minval(hypotenuse(real(states%c(0, :) - nearest, wp), aimag(states%c(0, :) - nearest)))
         ! the end is the lowest place only if no other is nearer
         if (abs(base - hypotenuse(real(centres%ends(k) - nearest, wp), aimag(centres%ends(k) - nearest))) > same_base*base) cycle
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
