!> Derivatives of the output by the input that are wanted: what they are, how far they miss, how that changes with every variable.
!>
!> Angles are in radians in derivatives, per radian of a crank or per length of a sliding input. Where the linkage does not close,
!> or a dyad is at a dead point, there are none: they count as zero, and so do their changes.
module psalm_desired_rates
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp
   use psalm_linkage, only: padded
   use psalm_output_kind, only: most_rates
   use psalm_parameters, only: variable_t, variable_crnki
   use psalm_rate_changes, only: change_rates
   use psalm_rates, only: prepare_rates, differentiate, form_frames, output_rates, is_dead, highest_order
   use psalm_rows, only: rows_t, make_rows, clear_rows
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, unit_of, clear_changes
   implicit none (type, external)
   private
   public :: desired_rates_t, prepare_desired_rates, find_desired_rates, differentiate_desired_rates, sum_of_rate_errors, &
             all_rates_exist, add_rates_to_motion

   !> Room to work in, and the linkage looked at last.
   type :: desired_rates_t
      class(problem_t), allocatable :: problem     !! finds everything that derivatives need
      type(sensitivity_t) :: work                  !! its rates are those by the input
      type(rows_t) :: change(0:most_rates)         !! changes with one variable of positions, first and second derivatives
      logical, allocatable :: exists(:)            !! shape (positions): it closes, and is not at a dead point
      real(wp), allocatable :: actual(:, :, :)     !! shape (positions, components, most_rates)
      real(wp), allocatable :: miss(:, :, :)       !! the same shape: actual - desired
      real(wp), allocatable :: by(:, :, :, :)      !! shape (positions, variables, components, most_rates): derivatives of `miss`
   end type desired_rates_t

contains

   !> Make ready for a problem in which derivatives are wanted. With `timed` the input of every position is the last variable.
   subroutine prepare_desired_rates(problem, timed, derivatives, wanted)
      type(problem_t), intent(in) :: problem
      logical, intent(in) :: timed
      logical, intent(in) :: derivatives           !! by the variables
      type(desired_rates_t), intent(out) :: wanted
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
            call make_rows(link%capacity, size(link%store%v, 2), wanted%change(order))
         end do
      end associate
   end subroutine prepare_desired_rates

   !> Derivatives of a linkage by the input, and by how much they miss.
   subroutine find_desired_rates(wanted, dimensions)
      type(desired_rates_t), intent(inout) :: wanted
      type(dimensions_t), intent(in) :: dimensions
      integer :: block, offset, n

      call wanted%problem%bind(dimensions)
      do block = 1, wanted%problem%blocks()
         call wanted%problem%solve_block(block, offset, n)
         call rates_of_block(wanted, offset, n)
      end do
   end subroutine find_desired_rates

   !> The same, and their changes with every variable.
   subroutine differentiate_desired_rates(wanted, dimensions)
      type(desired_rates_t), intent(inout) :: wanted
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
            call change_rates(wanted%problem, wanted%work, v, padded(n), wanted%change)
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
   end subroutine differentiate_desired_rates

   !> Derivatives by the input at the positions of the block just solved.
   subroutine rates_of_block(wanted, offset, n)
      type(desired_rates_t), intent(inout) :: wanted
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
               wanted%miss(offset + i, :, order) = values(order, :) - problem%rate_desired(offset + i, :, order)
            end do
         end do
      end associate
   end subroutine rates_of_block

   !> Sum of weight * miss**2 of the linkage looked at last; of one order if it is given.
   pure real(wp) function sum_of_rate_errors(wanted, order) result(total)
      type(desired_rates_t), intent(in) :: wanted
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
      type(desired_rates_t), intent(in) :: wanted
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
      class(desired_rates_t), allocatable :: wanted  ! in memory of its own: it would fill a small stack
      integer :: order

      allocate (wanted)
      call prepare_desired_rates(problem, .false., .false., wanted)
      call find_desired_rates(wanted, dimensions)
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
end module psalm_desired_rates
