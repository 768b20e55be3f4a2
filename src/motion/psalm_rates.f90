!> Derivatives of a linkage with respect to its input: first, second and third, of every root, point and slide.
!>
!> The plan that found the positions is gone through again, once for each order: each dyad's unknown derivatives obey two
!> linear equations whose matrix is the same in every order and is inverted once. Input: the crank angle in radians, or the
!> sliding input's length. Closed forms, no differencing. Source: Haines (about 1982), section 15.1; derivation in
!> `doc/theory/rates.md`.
module psalm_rates
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp
   use psalm_arc_kernels, only: turn_point_twice, turn_point_third, slide_point_twice
   use psalm_assur, only: form_dyad, differentiate_dyad, is_dead_dyad, is_orthogonal
   use psalm_higher_group, only: differentiate_higher, form_higher, rows_of_higher
   use psalm_frames, only: frames_t, make_frames, form_arc, arc_rate, rows_of_arc, rows_of_dyad, sine_row
   use psalm_linkage, only: bound_step_t, padded
   use psalm_plan, only: step_point
   use psalm_rows, only: rows_t, make_rows
   implicit none (type, external)
   private
   public :: rates_t, prepare_rates, differentiate, form_frames, output_rates, is_dead, highest_order
   public :: derivatives_of, in_time

   integer, parameter :: highest_order = 3

   !> Derivatives of one block of positions.
   type :: rates_t
      type(rows_t) :: d(highest_order)    !! by order: at the rows of the store the derivatives of a root's angle (at the row of
                                          !! its cosine), of points, of slides
      type(frames_t) :: frames            !! vectors of arcs and matrices of dyads
      integer, allocatable :: place(:)    !! by step: its first row in `frames`
   end type rates_t

contains

   !> Allocate for a problem (after `want_derivatives`).
   subroutine prepare_rates(problem, rates)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(out) :: rates
      integer :: k, rows, order

      allocate (rates%place(size(problem%plan%steps)))
      rows = 0
      do k = 1, size(problem%plan%steps)
         rates%place(k) = rows + 1
         associate (step => problem%linkage%steps(k))
            if (step%kind == step_point) then
               rows = rows + rows_of_arc
            else if (allocated(step%dyad%higher)) then
               rows = rows + rows_of_higher(step%dyad%higher)
            else
               rows = rows + rows_of_dyad
            end if
         end associate
      end do
      call make_frames(problem%linkage%capacity, rows, rates%frames)
      do k = 1, size(rates%place)
         if (is_orthogonal(problem%linkage%steps(k)%dyad%kind)) rates%frames%work%v(:, rates%place(k) + sine_row) = 1.0_wp
      end do
      do order = 1, highest_order
         call make_rows(problem%linkage%capacity, size(problem%linkage%store%v, 2), rates%d(order))
      end do
   end subroutine prepare_rates

   !> Arc vectors of all steps and inverse matrices of all dyads, for the block just solved.
   subroutine form_frames(problem, rates, n, fixed_too)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(inout) :: rates
      integer, intent(in) :: n            !! positions, padded
      logical, intent(in) :: fixed_too    !! arcs of the frame as well
      integer :: k

      do k = 1, size(problem%linkage%steps)
         if (problem%linkage%steps(k)%fixed .and. .not. fixed_too) cycle
         call form_step(problem, rates, k, n)
      end do
   end subroutine form_frames

   !> Arc vectors of one step, and the inverse matrix if it is a dyad.
   subroutine form_step(problem, rates, k, n)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(inout) :: rates
      integer, intent(in) :: k, n         !! step; positions, padded

      associate (step => problem%linkage%steps(k), link => problem%linkage)
         if (step%kind == step_point) then
            ! a varying length takes the arc's direction, a fixed one its vector
            call form_arc(n, link%store, step%root_x, step%root_y, step%sign*link%x(step%arc), step%sign*link%y(step%arc), &
                          link%length(step%arc), step%slide_row, rates%frames, rates%place(k))
         else if (allocated(step%dyad%higher)) then
            call form_higher(n, step%dyad%higher, link%x, link%y, link%length, link%store, rates%place(k), rates%frames)
         else
            call form_dyad(n, step%dyad, link%x, link%y, link%store, rates%place(k), rates%frames)
         end if
      end associate
   end subroutine form_step

   !> Derivatives by the input up to `orders` (2 or 3) for the first `n` positions of the block just solved.
   subroutine differentiate(problem, rates, n, orders, drive)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(inout) :: rates
      integer, intent(in) :: n, orders
      integer, intent(in), optional :: drive !! by this drive alone, the others at rest; else by the first, with what moves with it
      real(wp) :: rate(3), unit
      integer :: m, k, d, rows(2)

      m = padded(n)
      associate (link => problem%linkage)
         do d = 1, size(link%drive_rate, 2)
            call link%rows_of_drive(d, rows, unit)
            do k = 1, size(rows)
               rate = link%drive_rate(:, d)
               if (present(drive)) rate = merge([1.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, d == drive)
               if (rows(k) > 0) call set_input(rows(k), rate*unit)
            end do
         end do
         do k = 1, size(link%steps)
            associate (step => link%steps(k))
               if (allocated(step%dyad%higher)) then
                  call form_step(problem, rates, k, m)
                  call differentiate_higher(m, orders, step%dyad%higher, rates%place(k), rates%frames, rates%d)
               else if (step%kind /= step_point) then
                  call differentiate_dyad(m, orders, step%dyad, link%x, link%y, link%store, rates%place(k), rates%frames, rates%d)
               else if (.not. step%fixed) then
                  call point_rates(problem, step, k, m, orders, rates)
               end if
            end associate
         end do
      end associate

   contains

      subroutine set_input(row, rate)
         integer, intent(in) :: row
         real(wp), intent(in) :: rate(:)

         rates%d(1)%v(1:m, row) = rate(1)
         rates%d(2)%v(1:m, row) = rate(2)
         rates%d(3)%v(1:m, row) = rate(3)
      end subroutine set_input
   end subroutine differentiate

   !> One point, all orders.
   subroutine point_rates(problem, step, k, n, orders, rates)
      type(problem_t), intent(in) :: problem
      type(bound_step_t), intent(in) :: step
      integer, intent(in) :: k, n, orders
      type(rates_t), intent(inout) :: rates
      integer :: order

      associate (d1 => rates%d(1)%v, d2 => rates%d(2)%v, d3 => rates%d(3)%v, v => problem%linkage%store%v, &
                 fx => step%from_x, fy => step%from_y, tx => step%to_x, ty => step%to_y, rx => step%root_x, ry => step%root_y, &
                 slide => step%slide_row)
         if (slide == 0) then
            call turn_point_twice(n, step%x, step%y, d1(1, fx), d1(1, fy), d2(1, fx), d2(1, fy), v(1, rx), v(1, ry), d1(1, rx), &
                                  d2(1, rx), d1(1, tx), d1(1, ty), d2(1, tx), d2(1, ty))
            if (orders == 3) call turn_point_third(n, step%x, step%y, d3(1, fx), d3(1, fy), v(1, rx), v(1, ry), d1(1, rx), &
                                                   d2(1, rx), d3(1, rx), d3(1, tx), d3(1, ty))
         else if (orders == 2) then
            call slide_point_twice(n, step%x, step%y, d1(1, fx), d1(1, fy), d2(1, fx), d2(1, fy), v(1, rx), v(1, ry), d1(1, rx), &
                                   d2(1, rx), v(1, slide), d1(1, slide), d2(1, slide), d1(1, tx), d1(1, ty), d2(1, tx), d2(1, ty))
         else
            call form_step(problem, rates, k, n)
            do order = 1, orders
               associate (d => rates%d(order)%v)
                  call arc_rate(rates%frames, rates%d, n, order, 1.0_wp, rates%place(k), rx, slide, d(1, fx), d(1, fy), d(1, tx), &
                                d(1, ty))
               end associate
            end do
         end if
      end associate
   end subroutine point_rates

   !> Derivatives by time from derivatives by the input that moves at a speed and an acceleration.
   pure function in_time(d, speed, accel) result(t)
      real(wp), intent(in) :: d(highest_order)    !! by the input
      real(wp), intent(in) :: speed, accel      !! of the input
      real(wp) :: t(highest_order)                !! by time

      t(1) = d(1)*speed
      t(2) = d(2)*speed**2 + d(1)*accel
      t(3) = d(3)*speed**3 + 3.0_wp*d(2)*speed*accel
   end function in_time

   !> Derivatives, orders 1 to 3, of a row of the store at position `i` of the block.
   pure function derivatives_of(rates, row, i) result(d)
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: row, i
      real(wp) :: d(highest_order)
      integer :: order

      do order = 1, highest_order
         d(order) = rates%d(order)%v(i, row)
      end do
   end function derivatives_of

   !> True where the matrix of a loop's dyad has no inverse at position `i` of the block: a dead point, rates are infinite.
   pure logical function is_dead(problem, rates, loop, i)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: loop, i

      associate (k => problem%linkage%step_of_loop(loop))
         is_dead = is_dead_dyad(problem%linkage%steps(k)%dyad, rates%frames, rates%place(k), i)
      end associate
   end function is_dead

   !> Derivatives of the output's components at position `i` of the block, orders 1 to `orders`: see `psalm_observable`.
   subroutine output_rates(problem, rates, i, orders, values)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: i, orders
      real(wp), intent(out) :: values(:, :)  !! shape (3, components)

      call problem%output%rates(problem%linkage, rates%d, i, orders, values)
   end subroutine output_rates
end module psalm_rates
