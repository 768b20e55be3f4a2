!> Joints and slides of a sketch at the positions of a block that its loops have been solved at, with their derivatives by time.
!>
!> A joint is a point of the plan, or fixed on a link at a distance from one; joints of the frame stand still.
module psalm_sketch_motion
   use psalm_closure, only: most_orders
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_rates, only: rates_t, derivatives_of, in_time
   use psalm_rows, only: rows_t
   use psalm_sketch, only: most_targets
   implicit none (type, external)
   private
   public :: observe_sketch, find_places, find_changes, find_own_changes, find_rate_changes, find_own_rate_changes

contains

   !> Joints and slides at the first `n` positions of the block just solved and differentiated.
   subroutine observe_sketch(sketch, problem, rates, n, speed, accel, joint, moved)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: n
      real(wp), intent(in) :: speed, accel              !! of the input: radians or length a second
      complex(wp), intent(out) :: joint(:, 0:, :)       !! shape (joints, 0:most_orders, n): places and their derivatives by time
      real(wp), intent(out) :: moved(:, 0:, :)          !! shape (slides, 0:most_orders, n): travel from the drawing
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      complex(wp) :: z(most_orders), u
      real(wp) :: back, w(most_orders), x(most_orders), y(most_orders)
      integer :: k, m, row

      joint = (0.0_wp, 0.0_wp)
      moved = 0.0_wp
      call find_places(sketch, problem, n, joint(:, 0, :), moved(:, 0, :))
      associate (link => problem%linkage, plan => problem%plan)
         back = 1.0_wp/link%scale
         do k = 1, size(sketch%moving)
            associate (one => sketch%moving(k), point => plan%joint_points(k))
               do m = 1, n
                  x = derivatives_of(rates, link%point_x(point), m)*back
                  y = derivatives_of(rates, link%point_y(point), m)*back
                  z = cmplx(x, y, wp)
                  if (abs(one%offset) > 0.0_wp) then
                     u = offset_of(sketch, problem, k, m)
                     w = derivatives_of(rates, link%root_x(plan%root(one%arc)), m)
                     z(1) = z(1) + i*w(1)*u
                     z(2) = z(2) + cmplx(-w(1)**2, w(2), wp)*u
                     z(3) = z(3) + cmplx(-3.0_wp*w(1)*w(2), w(3) - w(1)**3, wp)*u
                  end if
                  joint(one%joint, 1:, m) = cmplx(in_time(z%re, speed, accel), in_time(z%im, speed, accel), wp)
               end do
            end associate
         end do
         do k = 1, size(sketch%arcs)
            if (sketch%arcs(k) == 0) cycle
            row = link%slide(plan%length_slot(sketch%arcs(k)))
            do m = 1, n
               moved(k, 1:, m) = sketch%sense(k)*in_time(derivatives_of(rates, row, m)*back, speed, accel)
            end do
         end do
      end associate
   end subroutine observe_sketch

   !> The places alone.
   subroutine find_places(sketch, problem, n, joint, moved)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: n
      complex(wp), intent(out) :: joint(:, :)           !! shape (joints, n)
      real(wp), intent(out) :: moved(:, :)              !! shape (slides, n)
      integer :: k, m

      moved = 0.0_wp
      associate (link => problem%linkage, plan => problem%plan)
         do m = 1, n
            joint(:, m) = sketch%drawn
            do k = 1, size(sketch%moving)
               joint(sketch%moving(k)%joint, m) = cmplx( &
                  link%store%v(m, link%point_x(plan%joint_points(k)))/link%scale + problem%output%origin_x, &
                  link%store%v(m, link%point_y(plan%joint_points(k)))/link%scale + problem%output%origin_y, wp) &
                  + offset_of(sketch, problem, k, m)
            end do
            do k = 1, size(sketch%arcs)
               if (sketch%arcs(k) == 0) cycle
               moved(k, m) = sketch%sense(k)*(link%store%v(m, link%slide(plan%length_slot(sketch%arcs(k))))/link%scale) &
                             + sketch%zero(k)
            end do
         end do
      end associate
   end subroutine find_places

   !> Changes of the places with a variable that changes the rows of the store by `d`.
   subroutine find_changes(sketch, problem, d, turn, origin, unit, n, joint, moved)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      type(rows_t), intent(in) :: d                     !! per radian of angles
      real(wp), intent(in) :: turn(:)                   !! shape (arcs): of their fixed angles
      complex(wp), intent(in) :: origin                 !! of the input pivot
      real(wp), intent(in) :: unit                      !! radians a unit of the variable is worth, or 1
      integer, intent(in) :: n
      complex(wp), intent(out) :: joint(:, :)           !! shape (joints, n)
      real(wp), intent(out) :: moved(:, :)              !! shape (slides, n)
      real(wp) :: back
      integer :: k, m

      joint = (0.0_wp, 0.0_wp)
      moved = 0.0_wp
      associate (link => problem%linkage, plan => problem%plan)
         back = unit/link%scale
         do m = 1, n
            do k = 1, size(sketch%moving)
               associate (one => sketch%moving(k), point => plan%joint_points(k))
                  joint(one%joint, m) = origin*unit + back*cmplx(d%v(m, link%point_x(point)), d%v(m, link%point_y(point)), wp) &
                                        + cmplx(0.0_wp, unit*(d%v(m, link%root_x(plan%root(one%arc))) + turn(one%arc)), wp) &
                                        *offset_of(sketch, problem, k, m)
               end associate
            end do
            do k = 1, size(sketch%arcs)
               if (sketch%arcs(k) == 0) cycle
               moved(k, m) = sketch%sense(k)*d%v(m, link%slide(plan%length_slot(sketch%arcs(k))))*back
            end do
         end do
      end associate
   end subroutine find_changes

   !> Changes of a joint's place with its own distance from the point of the plan, and with the angle of that line, by degrees.
   subroutine find_own_changes(sketch, problem, moving, position, along, across)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: moving                     !! of the joints that move: one with an offset
      integer, intent(in) :: position                   !! of the block
      complex(wp), intent(out) :: along, across
      complex(wp) :: u

      u = offset_of(sketch, problem, moving, position)
      along = u/abs(u)
      across = u*cmplx(0.0_wp, radians_per_degree, wp)
   end subroutine find_own_changes

   !> Changes of the places and of their derivatives by the input, with a variable that changes the rows of the store by `d`.
   subroutine find_rate_changes(sketch, problem, rates, d, turn, origin, unit, n, joint, moved)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates                !! by the input
      type(rows_t), intent(in) :: d(0:)                 !! by order; per radian of angles
      real(wp), intent(in) :: turn(:)                   !! shape (arcs): of their fixed angles
      complex(wp), intent(in) :: origin                 !! of the input pivot
      real(wp), intent(in) :: unit                      !! radians a unit of the variable is worth, or 1
      integer, intent(in) :: n
      complex(wp), intent(out) :: joint(:, 0:, :)       !! shape (joints, 0:most_targets, n)
      real(wp), intent(out) :: moved(:, 0:, :)          !! shape (slides, 0:most_targets, n)
      real(wp) :: h(0:most_targets)
      integer :: k, m, order, row

      joint = (0.0_wp, 0.0_wp)
      moved = 0.0_wp
      associate (link => problem%linkage, plan => problem%plan)
         do m = 1, n
            do k = 1, size(sketch%moving)
               associate (one => sketch%moving(k), point => plan%joint_points(k))
                  do order = 0, most_targets
                     joint(one%joint, order, m) = cmplx(d(order)%v(m, link%point_x(point)), d(order)%v(m, link%point_y(point)), &
                                                        wp)/link%scale
                  end do
                  joint(one%joint, 0, m) = joint(one%joint, 0, m) + origin
                  if (abs(one%offset) > 0.0_wp) then
                     row = link%root_x(plan%root(one%arc))
                     h = [(d(order)%v(m, row), order=0, most_targets)]
                     h(0) = h(0) + turn(one%arc)
                     joint(one%joint, :, m) = joint(one%joint, :, m) + turned_change(offset_of(sketch, problem, k, m), &
                                                                                     derivatives_of(rates, row, m), h)
                  end if
                  joint(one%joint, :, m) = joint(one%joint, :, m)*unit
               end associate
            end do
            do k = 1, size(sketch%arcs)
               if (sketch%arcs(k) == 0) cycle
               row = link%slide(plan%length_slot(sketch%arcs(k)))
               do order = 0, most_targets
                  moved(k, order, m) = sketch%sense(k)*d(order)%v(m, row)*(unit/link%scale)
               end do
            end do
         end do
      end associate
   end subroutine find_rate_changes

   !> Changes of a vector u exp(i theta) and of its derivatives by the input, where theta and its derivatives change by h.
   pure function turned_change(u, w, h) result(change)
      complex(wp), intent(in) :: u                      !! the vector
      real(wp), intent(in) :: w(:)                      !! derivatives of theta
      real(wp), intent(in) :: h(0:most_targets)
      complex(wp) :: change(0:most_targets)
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)

      change(0) = i*h(0)*u
      change(1) = i*(h(1)*u + w(1)*change(0))
      change(2) = i*h(2)*u + cmplx(-w(1)**2, w(2), wp)*change(0) - 2.0_wp*w(1)*h(1)*u
   end function turned_change

   !> Changes of a joint's place and of its derivatives by the input, with its own distance from the point of the plan, and with the
   !> angle of that line, by degrees.
   subroutine find_own_rate_changes(sketch, problem, rates, moving, position, along, across)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates                !! by the input
      integer, intent(in) :: moving                     !! of the joints that move: one with an offset
      integer, intent(in) :: position                   !! of the block
      complex(wp), intent(out) :: along(0:), across(0:) !! shape (0:most_targets)
      real(wp) :: w(most_orders)

      w = derivatives_of(rates, problem%linkage%root_x(problem%plan%root(sketch%moving(moving)%arc)), position)
      call find_own_changes(sketch, problem, moving, position, along(0), across(0))
      along = along(0)*[(1.0_wp, 0.0_wp), cmplx(0.0_wp, w(1), wp), cmplx(-w(1)**2, w(2), wp)]
      across = across(0)*[(1.0_wp, 0.0_wp), cmplx(0.0_wp, w(1), wp), cmplx(-w(1)**2, w(2), wp)]
   end subroutine find_own_rate_changes

   !> From the point of the plan to a joint at position m of the block.
   pure complex(wp) function offset_of(sketch, problem, moving, m) result(u)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: moving, m

      u = (0.0_wp, 0.0_wp)
      associate (one => sketch%moving(moving), link => problem%linkage)
         if (abs(one%offset) <= 0.0_wp) return
         associate (root => problem%plan%root(one%arc))
            u = one%offset*cmplx(link%x(one%arc), link%y(one%arc), wp)* &
                cmplx(link%store%v(m, link%root_x(root)), link%store%v(m, link%root_y(root)), wp)
         end associate
      end associate
   end function offset_of
end module psalm_sketch_motion
