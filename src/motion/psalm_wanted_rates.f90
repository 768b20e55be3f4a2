!> Derivatives of the output by the input that are wanted: what they are, how far they miss, how that changes with every variable.
!>
!> The matrix of a dyad is the same in every order of its derivatives by the input and by a dimension. So for each variable the plan
!> is gone through once for positions, once for first and once for second derivatives by the input. Angles are in radians in
!> derivatives, per radian of a crank or per length of a sliding input. Where the linkage does not close, or a dyad is at a dead
!> point, there are none: they count as zero, and so do their changes. Derivation: `doc/theory.md`, Sensitivities.
module psalm_wanted_rates
   use psalm_arc_kernels, only: add_arc_change, add_change_of_rate, difference, solve_columns
   use psalm_dyad, only: dyad_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp
   use psalm_frames, only: rows_of_arc, matrix_row
   use psalm_group_rings, only: higher_t
   use psalm_higher_group, only: gaps_of_ties, solve_higher
   use psalm_linkage, only: padded, put_driven_lengths
   use psalm_output_kind, only: most_rates
   use psalm_parameters, only: variable_t, variable_crnki
   use psalm_plan, only: step_point
   use psalm_rates, only: prepare_rates, differentiate, form_frames, output_rates, is_dead, highest_order
   use psalm_rows, only: rows_t, make_rows, clear_rows
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, unit_of, clear_changes
   implicit none (type, external)
   private
   public :: wanted_rates_t, prepare_wanted_rates, find_wanted_rates, differentiate_wanted_rates, sum_of_rate_errors, &
             all_rates_exist, add_rates_to_motion

   !> Room to work in, and the linkage looked at last.
   type :: wanted_rates_t
      class(problem_t), allocatable :: problem     !! finds everything that derivatives need
      type(sensitivity_t) :: work                  !! its rates are those by the input
      type(rows_t) :: change(0:most_rates)         !! changes with one variable of positions, first and second derivatives
      logical, allocatable :: exists(:)            !! shape (positions): it closes, and is not at a dead point
      real(wp), allocatable :: actual(:, :, :)     !! shape (positions, components, most_rates)
      real(wp), allocatable :: miss(:, :, :)       !! the same shape: actual - desired
      real(wp), allocatable :: by(:, :, :, :)      !! shape (positions, variables, components, most_rates): derivatives of `miss`
   end type wanted_rates_t

contains

   !> Make ready for a problem in which derivatives are wanted. With `timed` the input of every position is the last variable.
   subroutine prepare_wanted_rates(problem, timed, derivatives, wanted)
      type(problem_t), intent(in) :: problem
      logical, intent(in) :: timed
      logical, intent(in) :: derivatives           !! by the variables
      type(wanted_rates_t), intent(out) :: wanted
      type(variable_t) :: input
      integer :: order

      allocate (wanted%problem, source=problem)
      if (allocated(wanted%problem%linkages)) deallocate (wanted%problem%linkages)
      if (timed) then
         input%kind = variable_crnki
         wanted%problem%parameters%variables = [problem%parameters%variables, input]
      end if
      call wanted%problem%want_derivatives(.false.)
      associate (n => problem%positions, components => problem%output%kind%components, &
                 columns => size(wanted%problem%parameters%variables), link => wanted%problem%linkage)
         allocate (wanted%exists(n), source=.false.)
         allocate (wanted%actual(n, components, most_rates), wanted%miss(n, components, most_rates), source=0.0_wp)
         if (.not. derivatives) then
            call prepare_rates(wanted%problem, wanted%work%rates)
            return
         end if
         allocate (wanted%by(n, columns, components, most_rates), source=0.0_wp)
         call prepare_sensitivity(wanted%problem, wanted%work)
         do order = 0, most_rates
            call make_rows(link%room, size(link%store%v, 2), wanted%change(order))
         end do
      end associate
   end subroutine prepare_wanted_rates

   !> Derivatives of a linkage by the input, and by how much they miss.
   subroutine find_wanted_rates(wanted, dimensions)
      type(wanted_rates_t), intent(inout) :: wanted
      type(dimensions_t), intent(in) :: dimensions
      integer :: block, offset, n

      call wanted%problem%bind(dimensions)
      do block = 1, wanted%problem%blocks()
         call wanted%problem%solve_block(block, offset, n)
         call rates_of_block(wanted, offset, n)
      end do
   end subroutine find_wanted_rates

   !> The same, and their changes with every variable.
   subroutine differentiate_wanted_rates(wanted, dimensions)
      type(wanted_rates_t), intent(inout) :: wanted
      type(dimensions_t), intent(in) :: dimensions
      integer :: block, offset, n, v, i, order

      call wanted%problem%bind(dimensions)
      do block = 1, wanted%problem%blocks()
         call wanted%problem%solve_block(block, offset, n)
         call rates_of_block(wanted, offset, n)
         call form_frames(wanted%problem, wanted%work%rates, padded(n), fixed_too=.true.)
         do order = 0, most_rates
            call clear_rows(wanted%change(order))
         end do
         do v = 1, size(wanted%by, 2)
            call change_of(v, padded(n), wanted)
            associate (problem => wanted%problem)
               do i = 1, n
                  wanted%by(offset + i, v, :, :) = 0.0_wp
                  if (.not. wanted%exists(offset + i)) cycle
                  call problem%output%change_of_rates(problem%linkage, wanted%change, wanted%work%rates%d, i, &
                                                      problem%parameters%variables(v)%kind, &
                                                      wanted%work%turn(problem%mechanism%outputs(1)%arc, v), unit_of(problem, v), &
                                                      wanted%by(offset + i, v, :, :))
               end do
               do order = 0, most_rates
                  call clear_changes(problem, v, padded(n), wanted%work%moves(:, v), wanted%change(order))
               end do
            end associate
         end do
      end do
   end subroutine differentiate_wanted_rates

   !> Derivatives by the input at the positions of the block just solved.
   subroutine rates_of_block(wanted, offset, n)
      type(wanted_rates_t), intent(inout) :: wanted
      integer, intent(in) :: offset, n
      real(wp) :: values(highest_order, size(wanted%actual, 2))
      integer :: i, order, loop

      associate (problem => wanted%problem, exists => wanted%exists)
         call differentiate(problem, wanted%work%rates, n, most_rates)
         do i = 1, n
            exists(offset + i) = .true.
            do loop = 1, problem%mechanism%nloop
               if (problem%linkage%step_of_loop(loop) == 0) cycle
               if (.not. problem%linkage%closes(i, loop) .or. is_dead(problem, wanted%work%rates, loop, i)) &
                  exists(offset + i) = .false.
            end do
            values = 0.0_wp
            if (exists(offset + i)) call output_rates(problem, wanted%work%rates, i, most_rates, values)
            do order = 1, most_rates
               wanted%actual(offset + i, :, order) = values(order, :)
               wanted%miss(offset + i, :, order) = values(order, :) - problem%rate_wanted(offset + i, :, order)
            end do
         end do
      end associate
   end subroutine rates_of_block

   !> Sum of weight * miss**2 of the linkage looked at last; of one order if it is given.
   pure real(wp) function sum_of_rate_errors(wanted, order) result(total)
      type(wanted_rates_t), intent(in) :: wanted
      integer, intent(in), optional :: order
      integer :: o, c

      total = 0.0_wp
      do o = 1, most_rates
         if (present(order)) then
            if (o /= order) cycle
         end if
         do c = 1, size(wanted%miss, 2)
            total = total + sum(wanted%problem%rate_weight(:, c, o)*wanted%miss(:, c, o)**2)
         end do
      end do
   end function sum_of_rate_errors

   !> True if the linkage looked at last has derivatives wherever one is wanted.
   pure logical function all_rates_exist(wanted)
      type(wanted_rates_t), intent(in) :: wanted
      integer :: i

      all_rates_exist = .true.
      do i = 1, size(wanted%exists)
         if (.not. wanted%exists(i) .and. any(wanted%problem%rate_weight(i, :, :) > 0.0_wp)) all_rates_exist = .false.
      end do
   end function all_rates_exist

   !> Put the derivatives that are wanted into the motion of an analysis, and their part into the objective.
   subroutine add_rates_to_motion(problem, dimensions, motion)
      type(problem_t), intent(in) :: problem       !! in which derivatives are wanted
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(inout) :: motion
      class(wanted_rates_t), allocatable :: wanted  ! in memory of its own: it would fill a small stack
      integer :: order

      allocate (wanted)
      call prepare_wanted_rates(problem, .false., .false., wanted)
      call find_wanted_rates(wanted, dimensions)
      ! a loop that the output does not need may be open
      wanted%exists = wanted%exists .and. motion%closed
      allocate (motion%part(0:most_rates))
      motion%part(0) = motion%total
      motion%rates = wanted%actual
      motion%has_rates = wanted%exists
      motion%rate_error = -wanted%miss
      do order = 1, most_rates
         ! what does not exist is not compared
         where (.not. spread(wanted%exists, 2, size(wanted%miss, 2)) .or. problem%rate_weight(:, :, order) <= 0.0_wp)
            wanted%miss(:, :, order) = 0.0_wp
            motion%rate_error(:, :, order) = 0.0_wp
         end where
         motion%part(order) = sum_of_rate_errors(wanted, order)
      end do
      motion%total = motion%part(0) + sum_of_rate_errors(wanted)
   end subroutine add_rates_to_motion

   ! ---- changes with a variable -------------------------------------------------------------------------------------

   !> Changes of every root, point and slide with a variable (per radian for angles), and of their derivatives by the input.
   subroutine change_of(v, n, wanted)
      integer, intent(in) :: v, n                  !! variable; positions, padded
      type(wanted_rates_t), intent(inout) :: wanted
      real(wp) :: tx(n), ty(n)
      integer :: k, order

      associate (link => wanted%problem%linkage)
         if (wanted%problem%parameters%variables(v)%kind == variable_crnki) then
            do k = 1, size(link%input_row)
               wanted%change(0)%v(1:n, link%input_row(k)) = link%input_rate(k)
            end do
         end if
         call put_driven_lengths(link, n, wanted%work%stretch(:, v), wanted%change(0))
         do k = 1, size(link%steps)
            if (.not. wanted%work%moves(k, v)) cycle
            do order = 0, most_rates
               if (wanted%problem%plan%steps(k)%kind == step_point) then
                  associate (step => link%steps(k), d => wanted%change(order)%v)
                     call add_arc(wanted, v, n, order, 1.0_wp, wanted%work%rates%place(k), step%root_x, step%slide_row, step%arc, &
                                  d(1, step%from_x), d(1, step%from_y), tx, ty)
                     d(1:n, step%to_x) = tx
                     d(1:n, step%to_y) = ty
                  end associate
               else if (allocated(link%steps(k)%dyad%higher)) then
                  call change_of_group(link%steps(k)%dyad%higher, wanted%work%rates%place(k), v, n, order, wanted)
               else
                  call change_of_dyad(link%steps(k)%dyad, wanted%work%rates%place(k), v, n, order, wanted)
               end if
            end do
         end do
      end associate
   end subroutine change_of

   !> One dyad, one order. The rows of its unknowns hold zero before.
   subroutine change_of_dyad(dyad, at, v, n, order, wanted)
      type(dyad_t), intent(in) :: dyad
      integer, intent(in) :: at, v, n, order       !! first row of the dyad's frame; variable; positions, padded; order
      type(wanted_rates_t), intent(inout) :: wanted
      real(wp) :: gx(n), gy(n), tx(n), ty(n)

      associate (w => wanted%work%rates%frames%work%v, m => at + matrix_row, d => wanted%change(order)%v)
         call difference(n, d(1, dyad%s_x), d(1, dyad%s_y), d(1, dyad%e_x), d(1, dyad%e_y), gx, gy)
         call add_arc(wanted, v, n, order, -1.0_wp, at, dyad%p_x, dyad%slide_p, dyad%arc_p, gx, gy, tx, ty)
         call add_arc(wanted, v, n, order, -1.0_wp, at + rows_of_arc, dyad%q_x, dyad%slide_q, dyad%arc_q, tx, ty, gx, gy)
         call solve_columns(n, w(1, m), w(1, m + 1), w(1, m + 2), w(1, m + 3), gx, gy, d(1, dyad%unknown(1)), d(1, dyad%unknown(2)))
      end associate
   end subroutine change_of_dyad

   !> One larger group, one order. The rows of its unknowns hold zero before.
   subroutine change_of_group(higher, at, v, n, order, wanted)
      type(higher_t), intent(in) :: higher
      integer, intent(in) :: at, v, n, order
      type(wanted_rates_t), intent(inout) :: wanted
      real(wp) :: gap(n, higher%equations), tx(n), ty(n)
      integer :: r, k

      associate (d => wanted%change(order)%v)
         do r = 1, higher%rings
            call difference(n, d(1, higher%ends(1, r)), d(1, higher%ends(2, r)), d(1, higher%ends(3, r)), d(1, higher%ends(4, r)), &
                            gap(:, 2*r - 1), gap(:, 2*r))
         end do
      end associate
      do k = 1, size(higher%terms)
         associate (term => higher%terms(k), x => gap(:, 2*higher%terms(k)%ring - 1), y => gap(:, 2*higher%terms(k)%ring))
            call add_arc(wanted, v, n, order, -1.0_wp, at + rows_of_arc*(k - 1), term%root_x, term%slide, term%arc, x, y, tx, ty)
            x = tx
            y = ty
         end associate
      end do
      call gaps_of_ties(n, higher, wanted%change(order), gap)
      call solve_higher(n, higher, at, wanted%work%rates%frames, gap, wanted%change(order))
   end subroutine change_of_group

   !> t = f + factor * change of an arc with variable v: of its vector, or of its first or second derivative by the input.
   subroutine add_arc(wanted, v, n, order, factor, at, root, slide, arc, fx, fy, tx, ty)
      type(wanted_rates_t), intent(in) :: wanted
      integer, intent(in) :: v, n, order, at, root, slide, arc
      real(wp), intent(in) :: factor
      real(wp), intent(in) :: fx(n), fy(n)
      real(wp), intent(out) :: tx(n), ty(n)
      real(wp) :: h(n, 0:most_rates), g(n, 0:most_rates), l(n, most_rates)
      integer :: k

      g = 0.0_wp
      l = 0.0_wp
      do k = 0, most_rates
         h(:, k) = wanted%change(k)%v(1:n, root)
         if (slide > 0) g(:, k) = wanted%change(k)%v(1:n, slide)
      end do
      do k = 1, most_rates
         if (slide > 0) l(:, k) = wanted%work%rates%d(k)%v(1:n, slide)
      end do
      associate (w => wanted%work%rates%frames%work%v, d => wanted%work%rates%d, turn => wanted%work%turn(arc, v), &
                 stretch => wanted%work%stretch(arc, v)*wanted%problem%linkage%scale)
         if (order == 0) then
            call add_arc_change(n, factor, fx, fy, w(1, at), w(1, at + 1), w(1, at + 4), h(:, 0), g(:, 0), turn, stretch, tx, ty)
         else
            call add_change_of_rate(n, order, factor, fx, fy, w(1, at), w(1, at + 1), w(1, at + 4), d(1)%v(1, root), &
                                    d(2)%v(1, root), l(:, 1), l(:, 2), h(:, 0), h(:, 1), h(:, 2), g(:, 0), g(:, 1), g(:, 2), &
                                    turn, stretch, tx, ty)
         end if
      end associate
   end subroutine add_arc
end module psalm_wanted_rates
