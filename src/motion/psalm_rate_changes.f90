!> Changes of positions and of their first and second derivatives by the input with a variable.
!>
!> The matrix of a dyad is the same in every order of its derivatives by the input and by a dimension. So for each variable the plan
!> is gone through once for positions, once for first and once for second derivatives by the input. Derivation:
!> `doc/theory/rates.md`, Sensitivities.
module psalm_rate_changes
   use psalm_arc_kernels, only: add_arc_change, add_change_of_rate, difference, solve_columns
   use psalm_dyad, only: dyad_t
   use psalm_error, only: problem_t
   use psalm_frames, only: rows_of_arc, matrix_row
   use psalm_group_rings, only: higher_t
   use psalm_higher_group, only: gaps_of_ties, add_gaps_of_phase, solve_higher
   use psalm_kinds, only: wp
   use psalm_linkage, only: put_driven_lengths
   use psalm_output_kind, only: most_rates
   use psalm_parameters, only: variable_crnki, variable_gama
   use psalm_plan, only: step_point
   use psalm_rows, only: rows_t
   use psalm_sensitivity, only: sensitivity_t
   implicit none (type, external)
   private
   public :: change_rates

contains

   !> Changes of every root, point and slide with a variable (per radian for angles), and of their derivatives by the input.
   subroutine change_rates(problem, work, v, n, change)
      type(problem_t), intent(in) :: problem
      type(sensitivity_t), intent(in) :: work      !! its rates are those by the input, its frames formed
      integer, intent(in) :: v, n                  !! variable; positions, padded
      type(rows_t), intent(inout) :: change(0:)    !! by order; zero where the variable changes it
      real(wp) :: tx(n), ty(n)
      integer :: k, order

      associate (link => problem%linkage)
         if (problem%parameters%variables(v)%kind == variable_crnki) then
            do k = 1, size(link%input_row)
               change(0)%v(1:n, link%input_row(k)) = link%input_rate(k)
            end do
         end if
         call put_driven_lengths(link, n, work%stretch(:, v), change(0))
         do k = 1, size(link%steps)
            if (.not. work%moves(k, v)) cycle
            do order = 0, most_rates
               if (problem%plan%steps(k)%kind == step_point) then
                  associate (step => link%steps(k), d => change(order)%v)
                     call add_arc(problem, work, change, v, n, order, 1.0_wp, work%rates%place(k), step%root_x, step%slide_row, &
                                  step%arc, d(1, step%from_x), d(1, step%from_y), tx, ty)
                     d(1:n, step%to_x) = tx
                     d(1:n, step%to_y) = ty
                  end associate
               else if (allocated(link%steps(k)%dyad%higher)) then
                  call change_of_group(problem, work, link%steps(k)%dyad%higher, work%rates%place(k), v, n, order, change)
               else
                  call change_of_dyad(problem, work, link%steps(k)%dyad, work%rates%place(k), v, n, order, change)
               end if
            end do
         end do
      end associate
   end subroutine change_rates

   !> One dyad, one order. The rows of its unknowns hold zero before.
   subroutine change_of_dyad(problem, work, dyad, at, v, n, order, change)
      type(problem_t), intent(in) :: problem
      type(sensitivity_t), intent(in) :: work
      type(dyad_t), intent(in) :: dyad
      integer, intent(in) :: at, v, n, order       !! first row of the dyad's frame; variable; positions, padded; order
      type(rows_t), intent(inout) :: change(0:)
      real(wp) :: gx(n), gy(n), tx(n), ty(n)

      associate (w => work%rates%frames%work%v, m => at + matrix_row, d => change(order)%v)
         call difference(n, d(1, dyad%s_x), d(1, dyad%s_y), d(1, dyad%e_x), d(1, dyad%e_y), gx, gy)
         call add_arc(problem, work, change, v, n, order, -1.0_wp, at, dyad%p_x, dyad%slide_p, dyad%arc_p, gx, gy, tx, ty)
         call add_arc(problem, work, change, v, n, order, -1.0_wp, at + rows_of_arc, dyad%q_x, dyad%slide_q, dyad%arc_q, &
                      tx, ty, gx, gy)
         call solve_columns(n, w(1, m), w(1, m + 1), w(1, m + 2), w(1, m + 3), gx, gy, d(1, dyad%unknown(1)), d(1, dyad%unknown(2)))
      end associate
   end subroutine change_of_dyad

   !> One larger group, one order. The rows of its unknowns hold zero before.
   subroutine change_of_group(problem, work, higher, at, v, n, order, change)
      type(problem_t), intent(in) :: problem
      type(sensitivity_t), intent(in) :: work
      type(higher_t), intent(in) :: higher
      integer, intent(in) :: at, v, n, order
      type(rows_t), intent(inout) :: change(0:)
      real(wp) :: gap(n, higher%equations), tx(n), ty(n)
      integer :: r, k

      associate (d => change(order)%v)
         do r = 1, higher%rings
            call difference(n, d(1, higher%ends(1, r)), d(1, higher%ends(2, r)), d(1, higher%ends(3, r)), d(1, higher%ends(4, r)), &
                            gap(:, 2*r - 1), gap(:, 2*r))
         end do
      end associate
      do k = 1, size(higher%terms)
         associate (term => higher%terms(k), x => gap(:, 2*higher%terms(k)%ring - 1), y => gap(:, 2*higher%terms(k)%ring))
            call add_arc(problem, work, change, v, n, order, -1.0_wp, at + rows_of_arc*(k - 1), term%root_x, term%slide, &
                         term%arc, x, y, tx, ty)
            x = tx
            y = ty
         end associate
      end do
      call gaps_of_ties(n, higher, change(order), gap)
      associate (variable => problem%parameters%variables(v))
         if (order == 0 .and. variable%kind == variable_gama) call add_gaps_of_phase(n, higher, variable%n, gap)
      end associate
      call solve_higher(n, higher, at, work%rates%frames, gap, change(order))
   end subroutine change_of_group

   !> t = f + factor * change of an arc with variable v: of its vector, or of its first or second derivative by the input.
   subroutine add_arc(problem, work, change, v, n, order, factor, at, root, slide, arc, fx, fy, tx, ty)
      type(problem_t), intent(in) :: problem
      type(sensitivity_t), intent(in) :: work
      type(rows_t), intent(in) :: change(0:)
      integer, intent(in) :: v, n, order, at, root, slide, arc
      real(wp), intent(in) :: factor
      real(wp), intent(in) :: fx(n), fy(n)
      real(wp), intent(out) :: tx(n), ty(n)
      real(wp) :: h(n, 0:most_rates), g(n, 0:most_rates), l(n, most_rates)
      integer :: k

      g = 0.0_wp
      l = 0.0_wp
      do k = 0, most_rates
         h(:, k) = change(k)%v(1:n, root)
         if (slide > 0) g(:, k) = change(k)%v(1:n, slide)
      end do
      do k = 1, most_rates
         if (slide > 0) l(:, k) = work%rates%d(k)%v(1:n, slide)
      end do
      associate (w => work%rates%frames%work%v, d => work%rates%d, turn => work%turn(arc, v), &
                 stretch => work%stretch(arc, v)*problem%linkage%scale)
         if (order == 0) then
            call add_arc_change(n, factor, fx, fy, w(1, at), w(1, at + 1), w(1, at + 4), h(:, 0), g(:, 0), turn, stretch, tx, ty)
         else
            call add_change_of_rate(n, order, factor, fx, fy, w(1, at), w(1, at + 1), w(1, at + 4), d(1)%v(1, root), &
                                    d(2)%v(1, root), l(:, 1), l(:, 2), h(:, 0), h(:, 1), h(:, 2), g(:, 0), g(:, 1), g(:, 2), &
                                    turn, stretch, tx, ty)
         end if
      end associate
   end subroutine add_arc
end module psalm_rate_changes
