!> Kernels of what acts on bodies: inertia, weight, loads, springs; for one block of positions.
!>
!> Wrenches are in newtons and newtons times the store's unit of length, moments about the input pivot. A body has a reference
!> point P, whose position, velocity and acceleration are in store units, an axis e (unit vector) and the angular speed and
!> acceleration w, al. All arrays have the shape (n).
module psalm_force_kernels
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: load_body, move_axes, add_inertia, add_weight, add_force_at, add_couple, add_wrench
   public :: place_in_body, velocity_in_body, power_of
   public :: drive_of_crank, drive_of_slide

contains

   !> Axis of a body, turned from its root, and the derivatives by time of its angle and its reference from those by the input.
   pure subroutine move_axes(n, rx, ry, c, s, r1, r2, x1, y1, x2, y2, speed, accel, ex, ey, vx, vy, ax, ay, w, al)
      integer, intent(in) :: n
      real(wp), intent(in) :: rx(n), ry(n), c, s          !! root; cosine, sine of the fixed angle
      real(wp), intent(in) :: r1(n), r2(n), x1(n), y1(n), x2(n), y2(n) !! by the input, orders 1 and 2: angle, reference
      real(wp), intent(in) :: speed, accel                !! of the input
      real(wp), intent(out) :: ex(n), ey(n), vx(n), vy(n), ax(n), ay(n), w(n), al(n)
      real(wp) :: square
      integer :: i

      square = speed*speed
      do i = 1, n
         ex(i) = c*rx(i) - s*ry(i)
         ey(i) = c*ry(i) + s*rx(i)
         w(i) = r1(i)*speed
         al(i) = r2(i)*square + r1(i)*accel
         vx(i) = x1(i)*speed
         vy(i) = y1(i)*speed
         ax(i) = x2(i)*square + x1(i)*accel
         ay(i) = y2(i)*square + y1(i)*accel
      end do
   end subroutine move_axes

   !> Inertia and weight of a body in one pass: `move_axes`, `add_inertia`, `add_weight` and the power of the weight, without rows
   !> for what lies between. The wrench is set, energy and powers are added to.
   pure subroutine load_body(n, metre, mass, mx, my, inertia, gx, gy, rx, ry, c, s, r1, r2, px, py, x1, y1, x2, y2, speed, accel, &
                             fx, fy, m, kinetic, growth, power)
      integer, intent(in) :: n
      real(wp), intent(in) :: metre                       !! metres in a store unit
      real(wp), intent(in) :: mass, mx, my, inertia       !! kg, kg m, kg m2: about the reference, in the axes of the body
      real(wp), intent(in) :: gx, gy                      !! gravity
      real(wp), intent(in) :: rx(n), ry(n), c, s          !! root; cosine, sine of the fixed angle to the body's axis
      real(wp), intent(in) :: r1(n), r2(n), px(n), py(n), x1(n), y1(n), x2(n), y2(n) !! angle, reference: by the input
      real(wp), intent(in) :: speed, accel                !! of the input
      real(wp), intent(out) :: fx(n), fy(n), m(n)
      real(wp), intent(inout) :: kinetic(n), growth(n), power(n) !! J; W; W
      real(wp) :: mxr, myr, square, unit_mass, w, al, vx, vy, ax, ay, sx, sy, qx, qy, couple, weight
      integer :: i

      ! first moment in the axes of the root
      mxr = mx*c - my*s
      myr = mx*s + my*c
      square = speed*speed
      unit_mass = mass*metre
      do i = 1, n
         sx = mxr*rx(i) - myr*ry(i)
         sy = mxr*ry(i) + myr*rx(i)
         w = r1(i)*speed
         al = r2(i)*square + r1(i)*accel
         vx = x1(i)*speed
         vy = y1(i)*speed
         ax = x2(i)*square + x1(i)*accel
         ay = y2(i)*square + y1(i)*accel
         qx = al*sy + w*w*sx - unit_mass*ax
         qy = w*w*sy - al*sx - unit_mass*ay
         couple = (sy*ax - sx*ay) - inertia/metre*al
         weight = (sx*gy - sy*gx)/metre
         kinetic(i) = kinetic(i) + 0.5_wp*(unit_mass*metre*(vx*vx + vy*vy) + inertia*w*w) + metre*w*(vy*sx - vx*sy)
         growth(i) = growth(i) - metre*(qx*vx + qy*vy + couple*w)
         power(i) = power(i) + metre*(mass*(gx*vx + gy*vy) + weight*w)
         qx = qx + mass*gx
         qy = qy + mass*gy
         fx(i) = qx
         fy(i) = qy
         m(i) = px(i)*qy - py(i)*qx + (couple + weight)
      end do
   end subroutine load_body

   !> D'Alembert's wrench of a body, its kinetic energy and the power it takes up.
   pure subroutine add_inertia(n, metre, mass, mx, my, inertia, px, py, vx, vy, ax, ay, ex, ey, w, al, fx, fy, m, kinetic, growth)
      integer, intent(in) :: n
      real(wp), intent(in) :: metre                       !! metres in a store unit
      real(wp), intent(in) :: mass, mx, my, inertia       !! kg, kg m, kg m2: first moments in the axes of e, about P
      real(wp), intent(in) :: px(n), py(n), vx(n), vy(n), ax(n), ay(n), ex(n), ey(n), w(n), al(n)
      real(wp), intent(inout) :: fx(n), fy(n), m(n)
      real(wp), intent(inout) :: kinetic(n), growth(n)    !! J; W
      real(wp) :: sx, sy, rx, ry, couple
      integer :: i

      do i = 1, n
         sx = mx*ex(i) - my*ey(i)
         sy = mx*ey(i) + my*ex(i)
         rx = -(mass*metre*ax(i) - al(i)*sy - w(i)*w(i)*sx)
         ry = -(mass*metre*ay(i) + al(i)*sx - w(i)*w(i)*sy)
         couple = -(inertia/metre*al(i) + (sx*ay(i) - sy*ax(i)))
         fx(i) = fx(i) + rx
         fy(i) = fy(i) + ry
         m(i) = m(i) + (px(i)*ry - py(i)*rx) + couple
         kinetic(i) = kinetic(i) + 0.5_wp*(mass*metre*metre*(vx(i)*vx(i) + vy(i)*vy(i)) + inertia*w(i)*w(i)) + &
                      metre*w(i)*(vy(i)*sx - vx(i)*sy)
         growth(i) = growth(i) - metre*(rx*vx(i) + ry*vy(i) + couple*w(i))
      end do
   end subroutine add_inertia

   !> Weight of a body.
   pure subroutine add_weight(n, metre, mass, mx, my, gx, gy, px, py, ex, ey, fx, fy, m)
      integer, intent(in) :: n
      real(wp), intent(in) :: metre, mass, mx, my, gx, gy
      real(wp), intent(in) :: px(n), py(n), ex(n), ey(n)
      real(wp), intent(inout) :: fx(n), fy(n), m(n)
      integer :: i

      do i = 1, n
         fx(i) = fx(i) + mass*gx
         fy(i) = fy(i) + mass*gy
         m(i) = m(i) + mass*(px(i)*gy - py(i)*gx) + ((mx*ex(i) - my*ey(i))*gy - (mx*ey(i) + my*ex(i))*gx)/metre
      end do
   end subroutine add_weight

   !> factor times a force at the place z.
   pure subroutine add_force_at(n, factor, zx, zy, rx, ry, fx, fy, m)
      integer, intent(in) :: n
      real(wp), intent(in) :: factor
      real(wp), intent(in) :: zx(n), zy(n), rx(n), ry(n)
      real(wp), intent(inout) :: fx(n), fy(n), m(n)
      integer :: i

      do i = 1, n
         fx(i) = fx(i) + factor*rx(i)
         fy(i) = fy(i) + factor*ry(i)
         m(i) = m(i) + factor*(zx(i)*ry(i) - zy(i)*rx(i))
      end do
   end subroutine add_force_at

   pure subroutine add_couple(n, factor, couple, m)
      integer, intent(in) :: n
      real(wp), intent(in) :: factor, couple(n)
      real(wp), intent(inout) :: m(n)
      integer :: i

      do i = 1, n
         m(i) = m(i) + factor*couple(i)
      end do
   end subroutine add_couple

   !> Position of a place fixed in a body.
   pure subroutine place_in_body(n, at, px, py, ex, ey, zx, zy)
      integer, intent(in) :: n
      real(wp), intent(in) :: at(2)                       !! in the axes of e, store units
      real(wp), intent(in) :: px(n), py(n), ex(n), ey(n)
      real(wp), intent(out) :: zx(n), zy(n)
      integer :: i

      do i = 1, n
         zx(i) = px(i) + at(1)*ex(i) - at(2)*ey(i)
         zy(i) = py(i) + at(1)*ey(i) + at(2)*ex(i)
      end do
   end subroutine place_in_body

   !> Its velocity.
   pure subroutine velocity_in_body(n, zx, zy, px, py, vx, vy, w, ux, uy)
      integer, intent(in) :: n
      real(wp), intent(in) :: zx(n), zy(n), px(n), py(n), vx(n), vy(n), w(n)
      real(wp), intent(out) :: ux(n), uy(n)
      integer :: i

      do i = 1, n
         ux(i) = vx(i) - w(i)*(zy(i) - py(i))
         uy(i) = vy(i) + w(i)*(zx(i) - px(i))
      end do
   end subroutine velocity_in_body

   !> Power of a wrench on a body, added.
   pure subroutine power_of(n, metre, px, py, vx, vy, w, fx, fy, m, power)
      integer, intent(in) :: n
      real(wp), intent(in) :: metre
      real(wp), intent(in) :: px(n), py(n), vx(n), vy(n), w(n), fx(n), fy(n), m(n)
      real(wp), intent(inout) :: power(n)
      integer :: i

      do i = 1, n
         power(i) = power(i) + metre*(fx(i)*vx(i) + fy(i)*vy(i) + (m(i) - (px(i)*fy(i) - py(i)*fx(i)))*w(i))
      end do
   end subroutine power_of

   pure subroutine add_wrench(n, fx, fy, m, gx, gy, l)
      integer, intent(in) :: n
      real(wp), intent(in) :: fx(n), fy(n), m(n)
      real(wp), intent(inout) :: gx(n), gy(n), l(n)
      integer :: i

      do i = 1, n
         gx(i) = gx(i) + fx(i)
         gy(i) = gy(i) + fy(i)
         l(i) = l(i) + m(i)
      end do
   end subroutine add_wrench

   !> Torque of the drive of a crank about the origin against the wrench on it, newton metres.
   pure subroutine drive_of_crank(n, metre, m, drive)
      integer, intent(in) :: n
      real(wp), intent(in) :: metre, m(n)
      real(wp), intent(out) :: drive(n)
      integer :: i

      do i = 1, n
         drive(i) = -metre*m(i)
      end do
   end subroutine drive_of_crank

   !> Force of the drive along the direction u of a sliding input.
   pure subroutine drive_of_slide(n, ux, uy, fx, fy, drive)
      integer, intent(in) :: n
      real(wp), intent(in) :: ux(n), uy(n), fx(n), fy(n)
      real(wp), intent(out) :: drive(n)
      integer :: i

      do i = 1, n
         drive(i) = -(ux(i)*fx(i) + uy(i)*fy(i))
      end do
   end subroutine drive_of_slide
end module psalm_force_kernels
