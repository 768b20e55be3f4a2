!> The equations of two legs along a path of problems, linearised for several paths side by side.
!>
!> A path leads straight from one problem to another: t = 1 to t = 0. The turns of the coupler are unknowns of their own, but each
!> meets the equations of its point only: a combination of these that is free of them is left, as many rows as unknowns in the
!> legs. A term along the path meets the turns of its point and of the terms before it besides: what their changes owe to the legs
!> is put in their place. Arrays have the lanes first; every lane has a t of its own.
module psalm_leg_lanes
   use psalm_kinds, only: wp
   use psalm_lane_elimination, only: lanes, eliminate
   use psalm_leg_problem, only: leg_problem_t, leg_data_t, kind_point, kind_pose, kind_rate, kind_timed, variables, most_order, &
                                most_points, at_x, at_xh, at_a, at_ah, at_y, at_yh, at_b, at_bh
   implicit none (type, external)
   private
   public :: lanes, state_size, problem_path_t, work_t, linearise, solve_lanes, set_given

   integer, parameter :: state_size = variables + 2*most_points !! legs, then all g, then all gh
   integer, parameter :: of_value = variables + 1, of_rate = variables + 2 !! behind what a change owes to the legs

   !> From one problem to another.
   type :: problem_path_t
      type(leg_problem_t) :: problem
      type(leg_data_t) :: from, to                   !! at t = 1 and t = 0
   end type problem_path_t

   !> Terms of the series at a point, in every lane.
   type :: series_t
      complex(wp), dimension(lanes, 0:most_order) :: g, gh, d, dh
      complex(wp), dimension(0:most_order) :: dd = (0.0_wp, 0.0_wp), ddh = (0.0_wp, 0.0_wp) !! of d, dh by t
   end type series_t

   !> What linearising leaves for the way back to the turns.
   type :: work_t
      ! matrix and right sides: real and imaginary parts apart
      real(wp) :: mr(lanes, variables + 2, variables), mi(lanes, variables + 2, variables)
      complex(wp) :: full(lanes, variables), right(lanes, 2) !! a row before it is put into the matrix
      complex(wp) :: leg_a(lanes, 4, most_points)    !! by the numbers of leg a
      complex(wp) :: leg_b(lanes, variables, most_points) !! by all numbers
      complex(wp) :: u(lanes, 3, most_points), w(lanes, 3, most_points), n(lanes, 3, most_points) !! by g and gh; across both
      complex(wp) :: value(lanes, 3, most_points), rate(lanes, 2, most_points) !! of the equations, and by t
      real(wp) :: scale(lanes, variables)            !! of the columns
      complex(wp) :: dg(lanes, variables + 2, most_points), dgh(lanes, variables + 2, most_points) !! of terms along the path and
                                                     !! their points: the change of g, by all numbers, of the correction and by t
      integer :: rows = 0
      ! of a term along the path: here, for they would fill a small stack
      type(series_t) :: series
      complex(wp) :: equations(lanes, variables + 2, 3)
      complex(wp) :: before_u(lanes, 2, most_order), before_w(lanes, 2, most_order) !! by turns i terms before
   end type work_t

contains

   !> Pivots that are given, at the t of every lane.
   pure subroutine set_given(path, t, z)
      type(problem_path_t), intent(in) :: path
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(inout) :: z(lanes, state_size)
      integer :: k

      do k = 1, variables
         if (any(path%problem%free(:path%problem%unknowns) == k)) cycle
         z(:, k) = t*path%from%pivot(k) + (1.0_wp - t)*path%to%pivot(k)
      end do
   end subroutine set_given

   !> Matrix, right sides of the correction and of dz/dt at z, for every lane.
   pure subroutine linearise(path, t, z, work)
      type(problem_path_t), intent(in) :: path
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: z(lanes, state_size)
      type(work_t), intent(inout) :: work
      integer :: j, l

      work%rows = 0
      do j = 1, variables
         !$omp simd
         do l = 1, lanes
            work%scale(l, j) = max(abs(real(z(l, j), wp)) + abs(aimag(z(l, j))), tiny(1.0_wp))
         end do
      end do
      do j = 1, path%problem%points
         select case (path%problem%kind(j))
         case (kind_point)
            call linearise_point(path, j, t, z, work)
         case (kind_pose)
            call linearise_pose(path, j, t, z, work)
         case (kind_timed)
            call linearise_timed(path, j, t, z, work)
         case (kind_rate)
            call linearise_term(path, j, t, z, work)
         end select
         if (path%problem%continued(j) .and. path%problem%kind(j) /= kind_rate) call keep_changes(path, j, t, z, work)
      end do
   end subroutine linearise

   !> Values of both legs at a point, and their derivatives by their own numbers, by g and gh and by t.
   pure subroutine linearise_legs(path, j, t, z, work)
      type(problem_path_t), intent(in) :: path
      integer, intent(in) :: j
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: z(lanes, state_size)
      type(work_t), intent(inout) :: work
      complex(wp) :: d, dh, dd, ddh, g, gh, xgh, y, yh
      integer :: l, at_g, at_gh

      at_g = variables + j
      at_gh = variables + most_points + j
      dd = path%from%d(j) - path%to%d(j)
      ddh = path%from%dh(j) - path%to%dh(j)
      work%leg_b(:, :4, j) = (0.0_wp, 0.0_wp)
      call linearise_leg(path, j, t, z(:, at_g), z(:, at_gh), z(:, at_x), z(:, at_xh), z(:, at_a), z(:, at_ah), &
                         work%leg_a(:, :, j), work%u(:, 1, j), work%w(:, 1, j), work%value(:, 1, j), work%rate(:, 1, j))
      if (path%problem%slides) then
         !$omp simd
         do l = 1, lanes
            d = path%to%d(j) + t(l)*dd
            dh = path%to%dh(j) + t(l)*ddh
            g = z(l, at_g)
            gh = z(l, at_gh)
            xgh = z(l, at_yh)*gh + dh
            work%u(l, 2, j) = z(l, at_y)
            work%w(l, 2, j) = -z(l, at_b)*z(l, at_yh)
            work%leg_b(l, 5, j) = g
            work%leg_b(l, 6, j) = -z(l, at_b)*gh
            work%leg_b(l, 7, j) = -xgh
            work%leg_b(l, 8, j) = (0.0_wp, 0.0_wp)
            work%value(l, 2, j) = d + z(l, at_y)*g - z(l, at_b)*xgh
            work%rate(l, 2, j) = dd - z(l, at_b)*ddh
         end do
      else if (path%problem%differences) then
         ! leg b less leg a: nothing cancels where both are nearly the same
         !$omp simd
         do l = 1, lanes
            d = path%to%d(j) + t(l)*dd
            dh = path%to%dh(j) + t(l)*ddh
            g = z(l, at_g)
            gh = z(l, at_gh)
            y = z(l, at_x) + z(l, at_y)
            yh = z(l, at_xh) + z(l, at_yh)
            work%u(l, 2, j) = (z(l, at_ah) - dh)*z(l, at_y) + z(l, at_bh)*y
            work%w(l, 2, j) = (z(l, at_a) - d)*z(l, at_yh) + z(l, at_b)*yh
            work%leg_b(l, 1, j) = z(l, at_bh)*g
            work%leg_b(l, 2, j) = z(l, at_b)*gh
            work%leg_b(l, 3, j) = z(l, at_yh)*gh
            work%leg_b(l, 4, j) = z(l, at_y)*g
            work%leg_b(l, 5, j) = (z(l, at_ah) + z(l, at_bh) - dh)*g - dh
            work%leg_b(l, 6, j) = (z(l, at_a) + z(l, at_b) - d)*gh - d
            work%leg_b(l, 7, j) = yh*gh + dh
            work%leg_b(l, 8, j) = y*g + d
            work%value(l, 2, j) = work%u(l, 2, j)*g + work%w(l, 2, j)*gh + (z(l, at_bh) - z(l, at_yh))*d + &
                                  (z(l, at_b) - z(l, at_y))*dh
            work%rate(l, 2, j) = -ddh*(z(l, at_y)*g + z(l, at_y) - z(l, at_b)) - dd*(z(l, at_yh)*gh + z(l, at_yh) - z(l, at_bh))
         end do
      else
         call linearise_leg(path, j, t, z(:, at_g), z(:, at_gh), z(:, at_y), z(:, at_yh), z(:, at_b), z(:, at_bh), &
                            work%leg_b(:, 5:8, j), work%u(:, 2, j), work%w(:, 2, j), work%value(:, 2, j), work%rate(:, 2, j))
      end if
      !$omp simd
      do l = 1, lanes
         g = z(l, at_g)
         gh = z(l, at_gh)
         work%u(l, 3, j) = gh + 1.0_wp
         work%w(l, 3, j) = g + 1.0_wp
         work%value(l, 3, j) = g*gh + g + gh
      end do
   end subroutine linearise_legs

   !> One leg with two pins: the equation of its length, by x, xh, a, ah, by g and gh, and by t.
   pure subroutine linearise_leg(path, j, t, g, gh, x, xh, a, ah, row, u, w, value, rate)
      type(problem_path_t), intent(in) :: path
      integer, intent(in) :: j
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: g(lanes), gh(lanes)
      complex(wp), intent(in) :: x(lanes), xh(lanes), a(lanes), ah(lanes) !! moving pin and pivot
      complex(wp), intent(out) :: row(lanes, 4), u(lanes), w(lanes), value(lanes), rate(lanes)
      complex(wp) :: d, dh, dd, ddh, xg, xgh
      integer :: l

      dd = path%from%d(j) - path%to%d(j)
      ddh = path%from%dh(j) - path%to%dh(j)
      !$omp simd
      do l = 1, lanes
         d = path%to%d(j) + t(l)*dd
         dh = path%to%dh(j) + t(l)*ddh
         xg = x(l)*g(l) + d
         xgh = xh(l)*gh(l) + dh
         u(l) = (ah(l) - dh)*x(l)
         w(l) = (a(l) - d)*xh(l)
         row(l, 1) = (ah(l) - dh)*g(l) - dh
         row(l, 2) = (a(l) - d)*gh(l) - d
         row(l, 3) = xgh
         row(l, 4) = xg
         value(l) = u(l)*g(l) + w(l)*gh(l) + (ah(l) - xh(l))*d + (a(l) - x(l))*dh - d*dh
         rate(l) = -ddh*(xg + x(l) - a(l)) - dd*(xgh + xh(l) - ah(l))
      end do
   end subroutine linearise_leg

   !> The row of a point: both legs and the modulus of the turn, combined so that neither g nor gh is left.
   pure subroutine linearise_point(path, j, t, z, work)
      type(problem_path_t), intent(in) :: path
      integer, intent(in) :: j
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: z(lanes, state_size)
      type(work_t), intent(inout) :: work
      integer :: k, l

      call linearise_legs(path, j, t, z, work)
      !$omp simd
      do l = 1, lanes
         work%n(l, 1, j) = work%u(l, 2, j)*work%w(l, 3, j) - work%u(l, 3, j)*work%w(l, 2, j)
         work%n(l, 2, j) = work%u(l, 3, j)*work%w(l, 1, j) - work%u(l, 1, j)*work%w(l, 3, j)
         work%n(l, 3, j) = work%u(l, 1, j)*work%w(l, 2, j) - work%u(l, 2, j)*work%w(l, 1, j)
      end do
      do k = 1, 4
         !$omp simd
         do l = 1, lanes
            work%full(l, k) = work%n(l, 1, j)*work%leg_a(l, k, j) + work%n(l, 2, j)*work%leg_b(l, k, j)
            work%full(l, 4 + k) = work%n(l, 2, j)*work%leg_b(l, 4 + k, j)
         end do
      end do
      !$omp simd
      do l = 1, lanes
         work%right(l, 1) = -(work%n(l, 1, j)*work%value(l, 1, j) + work%n(l, 2, j)*work%value(l, 2, j) + &
                              work%n(l, 3, j)*work%value(l, 3, j))
         work%right(l, 2) = -(work%n(l, 1, j)*work%rate(l, 1, j) + work%n(l, 2, j)*work%rate(l, 2, j))
      end do
      call put_row(path, work)
   end subroutine linearise_point

   !> The two rows of a pose, whose turn goes along the path too.
   pure subroutine linearise_pose(path, j, t, z, work)
      type(problem_path_t), intent(in) :: path
      integer, intent(in) :: j
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: z(lanes, state_size)
      type(work_t), intent(inout) :: work
      complex(wp) :: given(lanes, state_size), turn(lanes), by_t

      given = z
      by_t = path%from%turn(j) - path%to%turn(j)
      turn = exp(path%to%turn(j) + t*by_t)
      given(:, variables + j) = turn - 1.0_wp
      given(:, variables + most_points + j) = 1.0_wp/turn - 1.0_wp
      call linearise_legs(path, j, t, given, work)
      work%rate(:, 1, j) = work%rate(:, 1, j) + by_t*(work%u(:, 1, j)*turn - work%w(:, 1, j)/turn)
      work%rate(:, 2, j) = work%rate(:, 2, j) + by_t*(work%u(:, 2, j)*turn - work%w(:, 2, j)/turn)
      work%full = (0.0_wp, 0.0_wp)
      work%full(:, :4) = work%leg_a(:, :, j)
      work%right(:, 1) = -work%value(:, 1, j)
      work%right(:, 2) = -work%rate(:, 1, j)
      call put_row(path, work)
      work%full = work%leg_b(:, :, j)
      work%right(:, 1) = -work%value(:, 2, j)
      work%right(:, 2) = -work%rate(:, 2, j)
      call put_row(path, work)
   end subroutine linearise_pose

   !> The two rows of a timed point: the crank's turn gives g and gh, the modulus of the coupler's turn and leg b are left.
   pure subroutine linearise_timed(path, j, t, z, work)
      type(problem_path_t), intent(in) :: path
      integer, intent(in) :: j
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: z(lanes, state_size)
      type(work_t), intent(inout) :: work
      complex(wp), dimension(lanes) :: d, dh, f, fh, q, crank, crankh, product, across, acrossh
      complex(wp) :: by_t, dd, ddh

      call linearise_legs(path, j, t, z, work)
      by_t = path%from%turn(j) - path%to%turn(j)
      dd = path%from%d(j) - path%to%d(j)
      ddh = path%from%dh(j) - path%to%dh(j)
      d = path%to%d(j) + t*dd
      dh = path%to%dh(j) + t*ddh
      q = exp(path%to%turn(j) + t*by_t)
      f = q - 1.0_wp
      fh = 1.0_wp/q - 1.0_wp
      associate (x => z(:, at_x), xh => z(:, at_xh), a => z(:, at_a), ah => z(:, at_ah), g => z(:, variables + j), &
                 gh => z(:, variables + most_points + j), n => work%n(:, :, j))
         ! crank: x g - (x - a) f + d; its values and rates stand where those of leg a stood, its numbers likewise
         crank = x - a
         crankh = xh - ah
         work%value(:, 1, j) = x*g - crank*f + d
         n(:, 1) = xh*gh - crankh*fh + dh
         work%rate(:, 1, j) = dd - crank*q*by_t
         n(:, 2) = ddh + crankh*by_t/q
         work%leg_a(:, 1, j) = g - f
         work%leg_a(:, 2, j) = gh - fh
         work%leg_a(:, 3, j) = f
         work%leg_a(:, 4, j) = fh
         product = x*xh
         across = work%u(:, 3, j)*xh
         acrossh = work%w(:, 3, j)*x
         work%full = (0.0_wp, 0.0_wp)
         work%full(:, at_x) = -across*(g - f)
         work%full(:, at_a) = -across*f
         work%full(:, at_xh) = -acrossh*(gh - fh)
         work%full(:, at_ah) = -acrossh*fh
         work%right(:, 1) = across*work%value(:, 1, j) + acrossh*n(:, 1) - work%value(:, 3, j)*product
         work%right(:, 2) = across*work%rate(:, 1, j) + acrossh*n(:, 2)
         call put_row(path, work)
         across = work%u(:, 2, j)*xh
         acrossh = work%w(:, 2, j)*x
         work%full(:, at_x) = -across*(g - f)
         work%full(:, at_a) = -across*f
         work%full(:, at_xh) = -acrossh*(gh - fh)
         work%full(:, at_ah) = -acrossh*fh
         work%full(:, 5) = work%leg_b(:, 5, j)*product
         work%full(:, 6) = work%leg_b(:, 6, j)*product
         work%full(:, 7) = work%leg_b(:, 7, j)*product
         work%full(:, 8) = work%leg_b(:, 8, j)*product
         work%right(:, 1) = across*work%value(:, 1, j) + acrossh*n(:, 1) - work%value(:, 2, j)*product
         work%right(:, 2) = across*work%rate(:, 1, j) + acrossh*n(:, 2) - work%rate(:, 2, j)*product
         call put_row(path, work)
      end associate
   end subroutine linearise_timed

   !> What the changes of a point's turns owe to the legs, for the terms along the path there.
   pure subroutine keep_changes(path, j, t, z, work)
      type(problem_path_t), intent(in) :: path
      integer, intent(in) :: j
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: z(lanes, state_size)
      type(work_t), intent(inout) :: work
      complex(wp) :: equations(lanes, variables + 2, 3), by_t, turn(lanes)

      select case (path%problem%kind(j))
      case (kind_pose)
         by_t = path%from%turn(j) - path%to%turn(j)
         turn = exp(path%to%turn(j) + t*by_t)
         work%dg(:, :, j) = (0.0_wp, 0.0_wp)
         work%dgh(:, :, j) = (0.0_wp, 0.0_wp)
         work%dg(:, of_rate, j) = by_t*turn
         work%dgh(:, of_rate, j) = -by_t/turn
      case (kind_timed)
         work%dg(:, :, j) = (0.0_wp, 0.0_wp)
         work%dgh(:, :, j) = (0.0_wp, 0.0_wp)
         associate (x => z(:, at_x), xh => z(:, at_xh))
            work%dg(:, at_x, j) = -work%leg_a(:, 1, j)/x
            work%dg(:, at_a, j) = -work%leg_a(:, 3, j)/x
            work%dg(:, of_value, j) = -work%value(:, 1, j)/x
            work%dg(:, of_rate, j) = -work%rate(:, 1, j)/x
            work%dgh(:, at_xh, j) = -work%leg_a(:, 2, j)/xh
            work%dgh(:, at_ah, j) = -work%leg_a(:, 4, j)/xh
            work%dgh(:, of_value, j) = -work%n(:, 1, j)/xh
            work%dgh(:, of_rate, j) = -work%n(:, 2, j)/xh
         end associate
      case default
         equations = (0.0_wp, 0.0_wp)
         equations(:, :4, 1) = work%leg_a(:, :, j)
         equations(:, :variables, 2) = work%leg_b(:, :, j)
         equations(:, of_value, :) = work%value(:, :, j)
         equations(:, of_rate, :2) = work%rate(:, :, j)
         call resolve(equations, j, work)
      end select
   end subroutine keep_changes

   !> The changes of g and gh by the rest of their three equations.
   pure subroutine resolve(equations, j, work)
      complex(wp), intent(in) :: equations(lanes, variables + 2, 3)
      integer, intent(in) :: j
      type(work_t), intent(inout) :: work
      complex(wp), dimension(lanes) :: a1, a2, a3, b1, b2, b3 !! by the rests of the three equations
      complex(wp) :: n1, n2, n3, u1, u2, u3, w1, w2, w3
      real(wp) :: square
      integer :: k, l

      !$omp simd
      do l = 1, lanes
         n1 = work%n(l, 1, j)
         n2 = work%n(l, 2, j)
         n3 = work%n(l, 3, j)
         square = -1.0_wp/max(real(n1, wp)**2 + aimag(n1)**2 + real(n2, wp)**2 + aimag(n2)**2 + real(n3, wp)**2 + &
                              aimag(n3)**2, tiny(1.0_wp))
         n1 = square*conjg(n1)
         n2 = square*conjg(n2)
         n3 = square*conjg(n3)
         u1 = work%u(l, 1, j)
         u2 = work%u(l, 2, j)
         u3 = work%u(l, 3, j)
         w1 = work%w(l, 1, j)
         w2 = work%w(l, 2, j)
         w3 = work%w(l, 3, j)
         a1(l) = n3*w2 - n2*w3
         a2(l) = n1*w3 - n3*w1
         a3(l) = n2*w1 - n1*w2
         b1(l) = n2*u3 - n3*u2
         b2(l) = n3*u1 - n1*u3
         b3(l) = n1*u2 - n2*u1
      end do
      do k = 1, variables + 2
         !$omp simd
         do l = 1, lanes
            work%dg(l, k, j) = a1(l)*equations(l, k, 1) + a2(l)*equations(l, k, 2) + a3(l)*equations(l, k, 3)
            work%dgh(l, k, j) = b1(l)*equations(l, k, 1) + b2(l)*equations(l, k, 2) + b3(l)*equations(l, k, 3)
         end do
      end do
   end subroutine resolve

   !> The terms at the point of a term along the path, up to its own.
   pure subroutine series_of(path, j, t, z, series)
      type(problem_path_t), intent(in) :: path
      integer, intent(in) :: j
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: z(lanes, state_size)
      type(series_t), intent(out) :: series
      complex(wp) :: turn(lanes)
      integer :: i

      series%g = (0.0_wp, 0.0_wp)
      series%gh = (0.0_wp, 0.0_wp)
      series%d = (0.0_wp, 0.0_wp)
      series%dh = (0.0_wp, 0.0_wp)
      do i = 0, path%problem%order(j)
         associate (own => path%problem%chain(i, j))
            if (own == 0) cycle
            if (path%problem%kind(own) == kind_pose) then
               turn = exp(path%to%turn(own) + t*(path%from%turn(own) - path%to%turn(own)))
               series%g(:, i) = turn - 1.0_wp
               series%gh(:, i) = 1.0_wp/turn - 1.0_wp
            else
               series%g(:, i) = z(:, variables + own)
               series%gh(:, i) = z(:, variables + most_points + own)
            end if
            series%dd(i) = path%from%d(own) - path%to%d(own)
            series%ddh(i) = path%from%dh(own) - path%to%dh(own)
            series%d(:, i) = path%to%d(own) + t*series%dd(i)
            series%dh(:, i) = path%to%dh(own) + t*series%ddh(i)
         end associate
      end do
   end subroutine series_of

   !> The row of a term along the path: both legs and the modulus of the turn, combined so that neither g nor gh is left.
   pure subroutine linearise_term(path, j, t, z, work)
      type(problem_path_t), intent(in) :: path
      integer, intent(in) :: j
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: z(lanes, state_size)
      type(work_t), intent(inout) :: work
      integer :: i, k, l, m

      m = path%problem%order(j)
      associate (s => work%series, equations => work%equations, u => work%before_u, w => work%before_w)
         call series_of(path, j, t, z, s)
         equations = (0.0_wp, 0.0_wp)
         call leg_of_term(m, s, z(:, at_x), z(:, at_xh), z(:, at_a), z(:, at_ah), equations(:, :4, 1), &
                          equations(:, of_value, 1), equations(:, of_rate, 1))
         work%u(:, 1, j) = (z(:, at_ah) - s%dh(:, 0))*z(:, at_x)
         work%w(:, 1, j) = (z(:, at_a) - s%d(:, 0))*z(:, at_xh)
         do i = 1, m
            u(:, 1, i) = -s%dh(:, i)*z(:, at_x)
            w(:, 1, i) = -s%d(:, i)*z(:, at_xh)
         end do
         u(:, 2, :) = (0.0_wp, 0.0_wp)
         w(:, 2, :) = (0.0_wp, 0.0_wp)
         if (path%problem%slides) then
            work%u(:, 2, j) = z(:, at_y)
            work%w(:, 2, j) = -z(:, at_b)*z(:, at_yh)
            equations(:, at_y, 2) = s%g(:, m)
            equations(:, at_yh, 2) = -z(:, at_b)*s%gh(:, m)
            equations(:, at_b, 2) = -(s%dh(:, m) + z(:, at_yh)*s%gh(:, m))
            equations(:, of_value, 2) = s%d(:, m) + z(:, at_y)*s%g(:, m) + z(:, at_b)*equations(:, at_b, 2)
            equations(:, of_rate, 2) = s%dd(m) - z(:, at_b)*s%ddh(m)
         else
            if (path%problem%differences) then
               call difference_of_term(m, s, z, equations(:, :, 2), work%u(:, 2, j), work%w(:, 2, j))
            else
               call leg_of_term(m, s, z(:, at_y), z(:, at_yh), z(:, at_b), z(:, at_bh), equations(:, at_y:at_bh, 2), &
                                equations(:, of_value, 2), equations(:, of_rate, 2))
               work%u(:, 2, j) = (z(:, at_bh) - s%dh(:, 0))*z(:, at_y)
               work%w(:, 2, j) = (z(:, at_b) - s%d(:, 0))*z(:, at_yh)
            end if
            do i = 1, m
               u(:, 2, i) = -s%dh(:, i)*z(:, at_y)
               w(:, 2, i) = -s%d(:, i)*z(:, at_yh)
            end do
         end if
         work%u(:, 3, j) = s%gh(:, 0) + 1.0_wp
         work%w(:, 3, j) = s%g(:, 0) + 1.0_wp
         equations(:, of_value, 3) = s%g(:, m) + s%gh(:, m)
         do i = 0, m
            equations(:, of_value, 3) = equations(:, of_value, 3) + s%g(:, i)*s%gh(:, m - i)
         end do
         do i = 0, m - 1
            associate (before => path%problem%chain(i, j))
               if (before == 0) cycle
               do k = 1, variables + 2
                  !$omp simd
                  do l = 1, lanes
                     equations(l, k, 1) = equations(l, k, 1) + u(l, 1, m - i)*work%dg(l, k, before) + &
                                          w(l, 1, m - i)*work%dgh(l, k, before)
                     equations(l, k, 2) = equations(l, k, 2) + u(l, 2, m - i)*work%dg(l, k, before) + &
                                          w(l, 2, m - i)*work%dgh(l, k, before)
                     equations(l, k, 3) = equations(l, k, 3) + s%gh(l, m - i)*work%dg(l, k, before) + &
                                          s%g(l, m - i)*work%dgh(l, k, before)
                  end do
               end do
            end associate
         end do
         associate (own_u => work%u(:, :, j), own_w => work%w(:, :, j))
            work%n(:, 1, j) = own_u(:, 2)*own_w(:, 3) - own_u(:, 3)*own_w(:, 2)
            work%n(:, 2, j) = own_u(:, 3)*own_w(:, 1) - own_u(:, 1)*own_w(:, 3)
            work%n(:, 3, j) = own_u(:, 1)*own_w(:, 2) - own_u(:, 2)*own_w(:, 1)
         end associate
         call resolve(equations, j, work)
         do k = 1, variables + 2
            equations(:, k, 1) = work%n(:, 1, j)*equations(:, k, 1) + work%n(:, 2, j)*equations(:, k, 2) + &
                                 work%n(:, 3, j)*equations(:, k, 3)
         end do
         work%full = equations(:, :variables, 1)
         work%right(:, 1) = -equations(:, of_value, 1)
         work%right(:, 2) = -equations(:, of_rate, 1)
      end associate
      call put_row(path, work)
   end subroutine linearise_term

   !> A term along the path of the equation of a leg with two pins: by x, xh, a, ah, its value, and by t.
   pure subroutine leg_of_term(m, s, x, xh, a, ah, row, value, rate)
      integer, intent(in) :: m
      type(series_t), intent(in) :: s
      complex(wp), intent(in) :: x(lanes), xh(lanes), a(lanes), ah(lanes)
      complex(wp), intent(out) :: row(lanes, 4), value(lanes), rate(lanes)
      complex(wp) :: by_d(lanes), by_dh(lanes)
      integer :: i

      row(:, 1) = ah*s%g(:, m) - s%dh(:, m)
      row(:, 2) = a*s%gh(:, m) - s%d(:, m)
      row(:, 3) = xh*s%gh(:, m) + s%dh(:, m)
      row(:, 4) = x*s%g(:, m) + s%d(:, m)
      value = a*row(:, 3) + ah*row(:, 4) - xh*s%d(:, m) - x*s%dh(:, m)
      rate = (0.0_wp, 0.0_wp)
      do i = 0, m
         row(:, 1) = row(:, 1) - s%dh(:, i)*s%g(:, m - i)
         row(:, 2) = row(:, 2) - s%d(:, i)*s%gh(:, m - i)
         by_dh = x*s%g(:, m - i) + s%d(:, m - i)
         by_d = xh*s%gh(:, m - i) + s%dh(:, m - i)
         value = value - s%dh(:, i)*by_dh - s%d(:, i)*xh*s%gh(:, m - i)
         if (i == m) then
            by_dh = by_dh + x - a
            by_d = by_d + xh - ah
         end if
         rate = rate - s%ddh(i)*by_dh - s%dd(i)*by_d
      end do
   end subroutine leg_of_term

   !> The same of leg b less leg a, by all numbers, with the derivatives by the turns of the same term.
   pure subroutine difference_of_term(m, s, z, row, u, w)
      integer, intent(in) :: m
      type(series_t), intent(in) :: s
      complex(wp), intent(in) :: z(lanes, state_size)
      complex(wp), intent(inout) :: row(lanes, variables + 2)
      complex(wp), intent(out) :: u(lanes), w(lanes)
      complex(wp) :: y(lanes), yh(lanes)
      integer :: i

      y = z(:, at_x) + z(:, at_y)
      yh = z(:, at_xh) + z(:, at_yh)
      u = (z(:, at_ah) - s%dh(:, 0))*z(:, at_y) + z(:, at_bh)*y
      w = (z(:, at_a) - s%d(:, 0))*z(:, at_yh) + z(:, at_b)*yh
      row(:, at_x) = z(:, at_bh)*s%g(:, m)
      row(:, at_xh) = z(:, at_b)*s%gh(:, m)
      row(:, at_a) = z(:, at_yh)*s%gh(:, m)
      row(:, at_ah) = z(:, at_y)*s%g(:, m)
      row(:, at_y) = (z(:, at_ah) + z(:, at_bh))*s%g(:, m) - s%dh(:, m)
      row(:, at_yh) = (z(:, at_a) + z(:, at_b))*s%gh(:, m) - s%d(:, m)
      row(:, at_b) = yh*s%gh(:, m) + s%dh(:, m)
      row(:, at_bh) = y*s%g(:, m) + s%d(:, m)
      row(:, of_value) = (z(:, at_ah)*z(:, at_y) + z(:, at_bh)*y)*s%g(:, m) + &
                         (z(:, at_a)*z(:, at_yh) + z(:, at_b)*yh)*s%gh(:, m) + &
                         (z(:, at_bh) - z(:, at_yh))*s%d(:, m) + (z(:, at_b) - z(:, at_y))*s%dh(:, m)
      row(:, of_rate) = s%ddh(m)*(z(:, at_b) - z(:, at_y)) + s%dd(m)*(z(:, at_bh) - z(:, at_yh))
      do i = 0, m
         row(:, at_y) = row(:, at_y) - s%dh(:, i)*s%g(:, m - i)
         row(:, at_yh) = row(:, at_yh) - s%d(:, i)*s%gh(:, m - i)
         row(:, of_value) = row(:, of_value) - s%dh(:, i)*z(:, at_y)*s%g(:, m - i) - s%d(:, i)*z(:, at_yh)*s%gh(:, m - i)
         row(:, of_rate) = row(:, of_rate) - s%ddh(i)*z(:, at_y)*s%g(:, m - i) - s%dd(i)*z(:, at_yh)*s%gh(:, m - i)
      end do
   end subroutine difference_of_term

   !> Put a row into the matrix: given pivots go to the right, columns and row are scaled.
   pure subroutine put_row(path, work)
      type(problem_path_t), intent(in) :: path
      type(work_t), intent(inout) :: work
      real(wp) :: largest(lanes)
      integer :: r, c, k, l, n

      n = path%problem%unknowns
      work%rows = work%rows + 1
      r = work%rows
      if (n < variables) then
         do k = 1, variables
            if (any(path%problem%free(:n) == k)) cycle
            work%right(:, 2) = work%right(:, 2) - work%full(:, k)*(path%from%pivot(k) - path%to%pivot(k))
         end do
      end if
      largest = 0.0_wp
      do c = 1, n
         k = path%problem%free(c)
         !$omp simd
         do l = 1, lanes
            work%mr(l, c, r) = real(work%full(l, k), wp)*work%scale(l, k)
            work%mi(l, c, r) = aimag(work%full(l, k))*work%scale(l, k)
            largest(l) = max(largest(l), abs(work%mr(l, c, r)) + abs(work%mi(l, c, r)))
         end do
      end do
      !$omp simd
      do l = 1, lanes
         largest(l) = 1.0_wp/max(largest(l), tiny(1.0_wp))
         work%mr(l, n + 1, r) = real(work%right(l, 1), wp)
         work%mi(l, n + 1, r) = aimag(work%right(l, 1))
         work%mr(l, n + 2, r) = real(work%right(l, 2), wp)
         work%mi(l, n + 2, r) = aimag(work%right(l, 2))
      end do
      do c = 1, n + 2
         !$omp simd
         do l = 1, lanes
            work%mr(l, c, r) = work%mr(l, c, r)*largest(l)
            work%mi(l, c, r) = work%mi(l, c, r)*largest(l)
         end do
      end do
   end subroutine put_row

   !> Corrections of all numbers, and their derivatives by t; relative sizes of the corrections. Destroys the matrix.
   pure subroutine solve_lanes(path, t, z, work, tangents, step, tangent, size_of_step)
      type(problem_path_t), intent(in) :: path
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: z(lanes, state_size)
      type(work_t), intent(inout) :: work
      logical, intent(in) :: tangents                !! wanted
      complex(wp), intent(inout) :: step(lanes, state_size), tangent(lanes, state_size)
      real(wp), intent(out) :: size_of_step(lanes)
      integer :: n, c, k, l, j
      real(wp) :: largest(lanes)

      n = path%problem%unknowns
      call eliminate(n, merge(2, 1, tangents), work%mr, work%mi)
      step(:, :variables) = (0.0_wp, 0.0_wp)
      largest = 0.0_wp
      do c = 1, n
         k = path%problem%free(c)
         !$omp simd
         do l = 1, lanes
            largest(l) = max(largest(l), abs(work%mr(l, n + 1, c)) + abs(work%mi(l, n + 1, c)))
            step(l, k) = work%scale(l, k)*cmplx(work%mr(l, n + 1, c), work%mi(l, n + 1, c), wp)
         end do
      end do
      call turns_back(path, t, z, work, work%value, of_value, step, largest)
      size_of_step = largest
      if (.not. tangents) return
      do k = 1, variables
         tangent(:, k) = path%from%pivot(k) - path%to%pivot(k)
      end do
      do c = 1, n
         k = path%problem%free(c)
         !$omp simd
         do l = 1, lanes
            tangent(l, k) = work%scale(l, k)*cmplx(work%mr(l, n + 2, c), work%mi(l, n + 2, c), wp)
         end do
      end do
      do j = 1, path%problem%points
         work%value(:, 1:2, j) = work%rate(:, :, j)
         work%value(:, 3, j) = (0.0_wp, 0.0_wp)
         if (path%problem%kind(j) == kind_timed) work%n(:, 1, j) = work%n(:, 2, j)
      end do
      call turns_back(path, t, z, work, work%value, of_rate, tangent, largest)
   end subroutine solve_lanes

   !> Changes of the turns that belong to changes of the legs; `largest` grows to their relative sizes.
   pure subroutine turns_back(path, t, z, work, value, side, change, largest)
      type(problem_path_t), intent(in) :: path
      real(wp), intent(in) :: t(lanes)
      complex(wp), intent(in) :: z(lanes, state_size), value(lanes, 3, most_points)
      type(work_t), intent(in) :: work
      integer, intent(in) :: side                    !! of_value or of_rate
      complex(wp), intent(inout) :: change(lanes, state_size)
      real(wp), intent(inout) :: largest(lanes)
      complex(wp) :: r1, r2, r3, u1, u2, u3, w1, w2, w3, n1, n2, n3, turn, by_t
      real(wp) :: square
      real(wp) :: squares(lanes)
      integer :: j, k, l, at_g, at_gh

      squares = 0.0_wp
      do j = 1, path%problem%points
         at_g = variables + j
         at_gh = variables + most_points + j
         select case (path%problem%kind(j))
         case (kind_pose)
            ! known: moved there at once
            by_t = path%from%turn(j) - path%to%turn(j)
            do l = 1, lanes
               turn = exp(path%to%turn(j) + t(l)*by_t)
               change(l, at_g) = turn - 1.0_wp - z(l, at_g)
               change(l, at_gh) = 1.0_wp/turn - 1.0_wp - z(l, at_gh)
            end do
            cycle
         case (kind_timed)
            !$omp simd
            do l = 1, lanes
               change(l, at_g) = -(value(l, 1, j) + work%leg_a(l, 1, j)*change(l, at_x) + &
                                   work%leg_a(l, 3, j)*change(l, at_a))/z(l, at_x)
               change(l, at_gh) = -(work%n(l, 1, j) + work%leg_a(l, 2, j)*change(l, at_xh) + &
                                    work%leg_a(l, 4, j)*change(l, at_ah))/z(l, at_xh)
            end do
         case (kind_rate)
            change(:, at_g) = work%dg(:, side, j)
            change(:, at_gh) = work%dgh(:, side, j)
            do k = 1, variables
               !$omp simd
               do l = 1, lanes
                  change(l, at_g) = change(l, at_g) + work%dg(l, k, j)*change(l, k)
                  change(l, at_gh) = change(l, at_gh) + work%dgh(l, k, j)*change(l, k)
               end do
            end do
         case default
            !$omp simd
            do l = 1, lanes
               u1 = work%u(l, 1, j)
               u2 = work%u(l, 2, j)
               u3 = work%u(l, 3, j)
               w1 = work%w(l, 1, j)
               w2 = work%w(l, 2, j)
               w3 = work%w(l, 3, j)
               n1 = conjg(work%n(l, 1, j))
               n2 = conjg(work%n(l, 2, j))
               n3 = conjg(work%n(l, 3, j))
               r1 = -(value(l, 1, j) + work%leg_a(l, 1, j)*change(l, 1) + work%leg_a(l, 2, j)*change(l, 2) + &
                      work%leg_a(l, 3, j)*change(l, 3) + work%leg_a(l, 4, j)*change(l, 4))
               r2 = -(value(l, 2, j) + work%leg_b(l, 1, j)*change(l, 1) + work%leg_b(l, 2, j)*change(l, 2) + &
                      work%leg_b(l, 3, j)*change(l, 3) + work%leg_b(l, 4, j)*change(l, 4) + work%leg_b(l, 5, j)*change(l, 5) + &
                      work%leg_b(l, 6, j)*change(l, 6) + work%leg_b(l, 7, j)*change(l, 7) + work%leg_b(l, 8, j)*change(l, 8))
               r3 = -value(l, 3, j)
               square = 1.0_wp/max(real(n1, wp)**2 + aimag(n1)**2 + real(n2, wp)**2 + aimag(n2)**2 + real(n3, wp)**2 + &
                                   aimag(n3)**2, tiny(1.0_wp))
               change(l, at_g) = square*(n1*(r2*w3 - r3*w2) + n2*(r3*w1 - r1*w3) + n3*(r1*w2 - r2*w1))
               change(l, at_gh) = square*(n1*(u2*r3 - u3*r2) + n2*(u3*r1 - u1*r3) + n3*(u1*r2 - u2*r1))
            end do
         end select
         !$omp simd
         do l = 1, lanes
            squares(l) = max(squares(l), relative_square(change(l, at_g), z(l, at_g)), &
                             relative_square(change(l, at_gh), z(l, at_gh)))
         end do
      end do
      largest = max(largest, sqrt(squares))
   end subroutine turns_back

   !> Square of a change of a turn over 1 + |turn|**2.
   elemental real(wp) function relative_square(change, turn)
      complex(wp), intent(in) :: change, turn

      relative_square = (real(change, wp)**2 + aimag(change)**2)/(1.0_wp + real(turn, wp)**2 + aimag(turn)**2)
   end function relative_square
end module psalm_leg_lanes
