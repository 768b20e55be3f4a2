!> Shape of a cam from the motion of its follower: pitch curve, profile, cutter centre, curvature, pressure angle.
!>
!> Points are complex numbers. The cam turns about O by sense*th; seen from it the roller's centre c draws the pitch curve
!> z = (c - O) exp(-i sense th), and profile and cutter path are its parallels. A flat face with normal direction b at
!> distance h from O envelops the profile. Everything is in closed form from two derivatives of the follower's
!> motion. A cam that slides by X(th) has z = c - O - X, and all else is the same.
!> Source: Oldham (1977), 9.3.2; derivation in doc/theory/cams.md.
module psalm_cam_profile
   use psalm_angles, only: unit_vector, angles_of
   use psalm_cam_trace, only: cam_trace_t, fault_on_axis, fault_standstill
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp, radians_per_degree, right_angle
   implicit none (type, external)
   private
   public :: cam_axes_t, cam_points_t, roller_profile, flat_profile, side_of_centre, in_machine, mark_standstill

   !> Part of the distances at hand below which one, or a speed by radian of cam, is nothing: far above rounding,
   !> and far below what can be made: a base circle of 1 nm on a cam of 1 m.
   real(wp), parameter :: nothing = 1.0e-9_wp
   real(wp), parameter :: least_speed = 1.0e-100_wp   !! divides at a cusp between the angles assessed; its cube is a number

   !> Where the cam turns, or how it slides.
   type :: cam_axes_t
      complex(wp) :: centre = (0.0_wp, 0.0_wp)       !! O
      real(wp) :: sense = 1.0_wp                     !! +1: anticlockwise
      logical :: slides = .false.
      complex(wp) :: way = (0.0_wp, 0.0_wp)          !! of a cam that slides, by radian of cam; `centre` is where its origin begins
   contains
      procedure :: relative
      procedure :: velocity
   end type cam_axes_t

   !> The cam at a row of cam angles; points in cam axes.
   type :: cam_points_t
      complex(wp), allocatable :: pitch(:)           !! roller centre; of a face: as `profile`
      complex(wp), allocatable :: profile(:)         !! point of contact
      complex(wp), allocatable :: cutter(:)          !! centre of cutter or wheel
      complex(wp), allocatable :: normal(:)          !! unit vector out of the cam
      complex(wp), allocatable :: tangent(:)         !! unit vector of the way of the contact
      complex(wp), allocatable :: machine(:)         !! what a vector in cam axes is multiplied by in machine axes
      real(wp), allocatable :: radius(:)             !! rho: of curvature of the profile, above 0 where convex
      real(wp), allocatable :: bend(:)               !! curvature of the pitch curve, above 0 where convex; of a face 1/rho
      real(wp), allocatable :: pressure(:)           !! alpha, degrees
      real(wp), allocatable :: excursion(:)          !! of the contact along the face from the foot of the centre
      real(wp), allocatable :: on_face(:)            !! and from the face's own point
   end type cam_points_t

contains

   !> The follower's point and its first two derivatives as seen from the cam, still along machine axes.
   pure subroutine relative(self, angle, c, w, z1, z2)
      class(cam_axes_t), intent(in) :: self
      real(wp), intent(in) :: angle                  !! of the cam, degrees
      complex(wp), intent(in) :: c(0:)               !! the point and its derivatives, machine axes
      complex(wp), intent(out) :: w, z1, z2
      complex(wp) :: j

      w = c(0) - self%centre
      if (self%slides) then
         w = w - self%way*(angle*radians_per_degree)
         z1 = c(1) - self%way
         z2 = c(2)
         return
      end if
      j = cmplx(0.0_wp, self%sense, wp)
      z1 = c(1) - j*w
      z2 = c(2) - 2.0_wp*(j*c(1)) - w
   end subroutine relative

   !> Velocity of a point of the cam by radians of cam; `from_centre` along machine axes.
   elemental complex(wp) function velocity(self, from_centre)
      class(cam_axes_t), intent(in) :: self
      complex(wp), intent(in) :: from_centre

      velocity = cmplx(0.0_wp, self%sense, wp)*from_centre
      if (self%slides) velocity = self%way
   end function velocity

   !> A point of the cam in machine axes; `machine` as `cam_points_t` has it.
   elemental complex(wp) function in_machine(axes, angle, point, machine)
      type(cam_axes_t), intent(in) :: axes
      real(wp), intent(in) :: angle                  !! of the cam, degrees
      complex(wp), intent(in) :: point, machine

      in_machine = axes%centre + point*machine
      if (axes%slides) in_machine = in_machine + axes%way*(angle*radians_per_degree)
   end function in_machine

   !> +1 if the cam's centre lies to the left of the pitch curve's sense, else -1. The trace covers one turn.
   pure real(wp) function side_of_centre(states, axes) result(side)
      type(cam_trace_t), intent(in) :: states
      type(cam_axes_t), intent(in) :: axes
      complex(wp) :: w, v, unused
      real(wp) :: total, before, now, dth
      integer :: i

      total = 0.0_wp
      before = 0.0_wp
      do i = 1, size(states%angle)
         call axes%relative(states%angle(i), states%c(:, i), w, v, unused)
         now = aimag(conjg(v)*(-w))
         if (i > 1) then
            dth = states%angle(i) - states%angle(i - 1)
            total = total + 0.5_wp*(now + before)*dth
         end if
         before = now
      end do
      side = sign(1.0_wp, total)
   end function side_of_centre

   !> Faults of a roller's cam where it has no profile: its pitch curve meets the axis, or stands still. A number that is none is a
   !> fault too.
   pure subroutine mark_standstill(axes, states)
      type(cam_axes_t), intent(in) :: axes
      type(cam_trace_t), intent(inout) :: states
      complex(wp) :: w(size(states%angle)), v(size(states%angle)), unused
      real(wp) :: least
      integer :: i

      do i = 1, size(w)
         call axes%relative(states%angle(i), states%c(:, i), w(i), v(i), unused)
      end do
      least = nothing*max(maxval(abs(w)), maxval(abs(states%c(0, :))), abs(axes%centre))
      where (.not. abs(v) > least) states%fault = fault_standstill
      if (.not. axes%slides) then
         where (.not. abs(w) > least) states%fault = fault_on_axis
      end if
   end subroutine mark_standstill

   !> Profile of a roller, or of a knife edge with radius 0. No allocation but of `points`.
   pure subroutine roller_profile(states, axes, side, roller, cutter, points)
      type(cam_trace_t), intent(in) :: states
      type(cam_axes_t), intent(in) :: axes
      real(wp), intent(in) :: side                   !! eps: +1 centre to the left of the pitch curve
      real(wp), intent(in) :: roller, cutter         !! radii
      type(cam_points_t), intent(out) :: points
      complex(wp) :: w, z1, z2, n, e, push, f
      real(wp) :: speed, ec, es, across(size(states%angle)), along(size(states%angle)), size_f
      integer :: i

      call grow(size(states%angle), points)
      do i = 1, size(states%angle)
         call unit_vector(merge(0.0_wp, -axes%sense*states%angle(i), axes%slides), ec, es)
         e = cmplx(ec, es, wp)
         points%machine(i) = conjg(e)
         call axes%relative(states%angle(i), states%c(:, i), w, z1, z2)
         speed = max(hypotenuse(real(z1, wp), aimag(z1)), least_speed)
         n = (0.0_wp, 1.0_wp)*z1/speed
         points%bend(i) = side*aimag(conjg(z1)*z2)/speed**3
         points%radius(i) = radius_of(points%bend(i), roller)
         points%pitch(i) = w*e
         points%profile(i) = (w + side*roller*n)*e
         points%cutter(i) = (w + side*(roller - cutter)*n)*e
         points%normal(i) = -side*n*e
         points%tangent(i) = (0.0_wp, -1.0_wp)*n*e
         push = -side*n
         f = states%by_input(i)
         size_f = hypotenuse(real(f, wp), aimag(f))
         if (size_f > 0.0_wp) f = f/size_f
         f = push*conjg(f)
         across(i) = aimag(f)
         along(i) = real(f, wp)
      end do
      ! the line of travel has no sense: within a right angle
      across = sign(1.0_wp, along)*across
      call angles_of(size(across), abs(along), across, points%pressure)
   end subroutine roller_profile

   !> Radius of the profile beside a pitch curve of a curvature; the largest number where that is straight.
   elemental real(wp) function radius_of(bend, roller)
      real(wp), intent(in) :: bend, roller

      radius_of = huge(1.0_wp)
      if (abs(bend) > tiny(1.0_wp)) radius_of = 1.0_wp/bend - roller
   end function radius_of

   !> Profile of a flat face. The face's normal out of the cam stands at `face` from the line to its point.
   pure subroutine flat_profile(states, axes, face, cutter, points, possible)
      type(cam_trace_t), intent(in) :: states
      type(cam_axes_t), intent(in) :: axes
      real(wp), intent(in) :: face                   !! degrees: FACANG - FOLANG
      real(wp), intent(in) :: cutter                 !! radius of the wheel
      type(cam_points_t), intent(out) :: points
      logical, intent(out) :: possible(:)            !! false where the face turns with the cam
      complex(wp) :: u, e, g0, g1, g2, v, i1
      real(wp) :: c, s, h, x, relative, across(size(states%angle)), along(size(states%angle)), size_v
      integer :: i

      call grow(size(states%angle), points)
      i1 = (0.0_wp, 1.0_wp)
      call unit_vector(face, c, s)
      do i = 1, size(states%angle)
         u = states%direction(i)*cmplx(c, s, wp)
         associate (b => states%turning(:, i))
            ! the face's point seen from the centre in axes of the face
            g0 = conjg(u)*(states%c(0, i) - axes%centre)
            g1 = conjg(u)*states%c(1, i) - i1*(b(1)*g0)
            g2 = conjg(u)*states%c(2, i) - i1*(b(1)*(conjg(u)*states%c(1, i)) + b(2)*g0 + b(1)*g1)
            relative = b(1) - axes%sense
            possible(i) = abs(relative) > epsilon(1.0_wp)
            if (.not. possible(i)) relative = epsilon(1.0_wp)
            h = real(g0, wp)
            x = real(g1, wp)/relative
            points%radius(i) = h + (real(g2, wp)*relative - real(g1, wp)*b(2))/relative**3
         end associate
         call unit_vector(-axes%sense*states%angle(i), c, s)
         e = u*cmplx(c, s, wp)
         points%machine(i) = cmplx(c, -s, wp)
         call unit_vector(face, c, s)
         points%bend(i) = 1.0_wp/sign(max(abs(points%radius(i)), tiny(1.0_wp)), points%radius(i))
         points%profile(i) = cmplx(h, x, wp)*e
         points%pitch(i) = points%profile(i)
         points%cutter(i) = cmplx(h + cutter, x, wp)*e
         points%normal(i) = e
         points%tangent(i) = sign(1.0_wp, relative)*i1*e
         points%excursion(i) = x
         points%on_face(i) = x - aimag(g0)
         ! velocity of the point of the face that touches
         v = conjg(u)*states%by_input(i) + i1*states%turning_by_input(i)*cmplx(h - real(g0, wp), x - aimag(g0), wp)
         size_v = hypotenuse(real(v, wp), aimag(v))
         if (size_v > 0.0_wp) v = v/size_v
         across(i) = -aimag(v)
         along(i) = real(v, wp)
      end do
      across = sign(1.0_wp, along)*across
      call angles_of(size(across), abs(along), across, points%pressure)
      where (abs(points%pressure) > right_angle) points%pressure = right_angle
   end subroutine flat_profile

   pure subroutine grow(n, points)
      integer, intent(in) :: n
      type(cam_points_t), intent(inout) :: points

      allocate (points%pitch(n), points%profile(n), points%cutter(n), points%normal(n), points%machine(n), points%tangent(n))
      allocate (points%radius(n), points%bend(n), points%pressure(n))
      allocate (points%excursion(n), points%on_face(n), source=0.0_wp)
   end subroutine grow
end module psalm_cam_profile
