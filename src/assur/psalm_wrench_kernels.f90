!> Kernels of forces: wrenches (force, and moment about the origin) of bodies, and the joints that pass them on.
!>
!> A revolute joint passes on a force through its centre, a prismatic one a force N across the slide at its foot and a couple m
!> about the foot. The free motion of a joint is where it passes nothing on: the turn about a pin, the way along a slide. The
!> wrench of a body in that direction is its *free component*. All arrays have the shape (n).
module psalm_wrench_kernels
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: moment_about, force_along, pass_force, pass_across, opposite_force, opposite_across

contains

   !> Moment of a wrench about a point: the free component of a pin.
   pure subroutine moment_about(n, x, y, fx, fy, m, t)
      integer, intent(in) :: n
      real(wp), intent(in) :: x(n), y(n), fx(n), fy(n), m(n)
      real(wp), intent(out) :: t(n)
      integer :: i

      do i = 1, n
         t(i) = m(i) - (x(i)*fy(i) - y(i)*fx(i))
      end do
   end subroutine moment_about

   !> Component of a force along a direction: the free component of a slide.
   pure subroutine force_along(n, ux, uy, fx, fy, t)
      integer, intent(in) :: n
      real(wp), intent(in) :: ux(n), uy(n), fx(n), fy(n)
      real(wp), intent(out) :: t(n)
      integer :: i

      do i = 1, n
         t(i) = ux(i)*fx(i) + uy(i)*fy(i)
      end do
   end subroutine force_along

   !> A force r at the end of the vector a from the point s: taken from the wrench on p, added to that on q.
   pure subroutine pass_force(n, sx, sy, ax, ay, rx, ry, px, py, pm, qx, qy, qm)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ax(n), ay(n), rx(n), ry(n)
      real(wp), intent(inout) :: px(n), py(n), pm(n), qx(n), qy(n), qm(n)
      real(wp) :: moment
      integer :: i

      do i = 1, n
         moment = (sx(i) + ax(i))*ry(i) - (sy(i) + ay(i))*rx(i)
         px(i) = px(i) - rx(i)
         py(i) = py(i) - ry(i)
         pm(i) = pm(i) - moment
         qx(i) = qx(i) + rx(i)
         qy(i) = qy(i) + ry(i)
         qm(i) = qm(i) + moment
      end do
   end subroutine pass_force

   !> The same for a force `across` at right angles to the direction u, at the same place, and a couple.
   pure subroutine pass_across(n, sx, sy, ax, ay, ux, uy, across, couple, px, py, pm, qx, qy, qm)
      integer, intent(in) :: n
      real(wp), intent(in) :: sx(n), sy(n), ax(n), ay(n), ux(n), uy(n), across(n), couple(n)
      real(wp), intent(inout) :: px(n), py(n), pm(n), qx(n), qy(n), qm(n)
      real(wp) :: moment, rx, ry
      integer :: i

      do i = 1, n
         rx = -across(i)*uy(i)
         ry = across(i)*ux(i)
         moment = (sx(i) + ax(i))*ry - (sy(i) + ay(i))*rx + couple(i)
         px(i) = px(i) - rx
         py(i) = py(i) - ry
         pm(i) = pm(i) - moment
         qx(i) = qx(i) + rx
         qy(i) = qy(i) + ry
         qm(i) = qm(i) + moment
      end do
   end subroutine pass_across

   !> Force of a pin that holds a body against the wrench on it.
   pure subroutine opposite_force(n, fx, fy, rx, ry)
      integer, intent(in) :: n
      real(wp), intent(in) :: fx(n), fy(n)
      real(wp), intent(out) :: rx(n), ry(n)
      integer :: i

      do i = 1, n
         rx(i) = -fx(i)
         ry(i) = -fy(i)
      end do
   end subroutine opposite_force

   !> Force across and couple about its foot of a slide along u that holds a body against the wrench on it.
   pure subroutine opposite_across(n, x, y, ux, uy, fx, fy, m, across, couple)
      integer, intent(in) :: n
      real(wp), intent(in) :: x(n), y(n), ux(n), uy(n), fx(n), fy(n), m(n)
      real(wp), intent(out) :: across(n), couple(n)
      integer :: i

      do i = 1, n
         across(i) = fx(i)*uy(i) - fy(i)*ux(i)
         couple(i) = (x(i)*fy(i) - y(i)*fx(i)) - m(i)
      end do
   end subroutine opposite_across
end module psalm_wrench_kernels
