!> Desired values of several outputs of a sketch: how far they are missed, and how that changes with every variable.
!>
!> Those of the first output are the desired values of the problem itself; here are those of the others. Angles are in degrees.
!> Where the linkage does not close nothing is compared.
module psalm_output_wishes
   use psalm_angles, only: unit_vector
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, full_turn
   use psalm_parameters, only: variable_t, variable_crnki, variable_outang, variable_outlk
   use psalm_closure, only: most_orders
   use psalm_sensitivity, only: sensitivity_t, wanted_outputs_t, prepare_sensitivity, find_jacobian
   use psalm_sketch, only: sketch_output_t
   use psalm_sketch_motion, only: locate_sketch, find_places
   use psalm_sketch_outputs, only: names_of_numbers, values_of_outputs, name_room
   implicit none (type, external)
   private
   public :: output_wishes_t, prepare_output_wishes, find_output_wishes, differentiate_output_wishes, sum_of_wish_errors

   !> Room to work in, and the linkage looked at last. Numbers are those of all outputs with wishes, one after the other.
   type :: output_wishes_t
      class(problem_t), allocatable :: problem      !! finds every joint
      type(sensitivity_t) :: work
      type(wanted_outputs_t) :: wanted
      integer :: shown = 0                          !! of the joints that move: the first output, if it stands off its arc; 0: none
      character(name_room), allocatable :: names(:) !! by number
      logical, allocatable :: exists(:)             !! shape (positions): every loop closes
      real(wp), allocatable :: actual(:, :)         !! shape (positions, numbers)
      real(wp), allocatable :: miss(:, :)           !! the same shape: actual - desired
      real(wp), allocatable :: by(:, :, :)          !! shape (positions, variables, numbers): derivatives of `miss`
   end type output_wishes_t

contains

   !> Make ready for a problem with such wishes. With `timed` the input of every position is the last variable.
   subroutine prepare_output_wishes(set, problem, timed, derivatives, wishes)
      type(data_set_t), intent(in) :: set           !! a sketch with its loops
      type(problem_t), intent(in) :: problem
      logical, intent(in) :: timed
      logical, intent(in) :: derivatives            !! by the variables
      type(output_wishes_t), intent(out) :: wishes
      type(variable_t) :: input
      logical, allocatable :: turning(:)
      integer :: k

      allocate (wishes%problem, source=problem)
      if (allocated(wishes%problem%linkages)) deallocate (wishes%problem%linkages)
      if (timed) then
         input%kind = variable_crnki
         wishes%problem%parameters%variables = [problem%parameters%variables, input]
      end if
      associate (wanted => wishes%wanted, n => problem%positions)
         call locate_sketch(set, problem%mechanism, wanted%sketch, problem%given)
         allocate (wanted%outputs(0))
         do k = 1, size(set%sketch%outputs)
            if (set%sketch%outputs(k)%is_wished()) wanted%outputs = [wanted%outputs, set%sketch%outputs(k)]
         end do
         call names_of_numbers(wanted%outputs, wishes%names, turning, wanted%angle)
         wanted%numbers = size(wishes%names)
         do k = 1, size(wanted%sketch%moving)
            if (wanted%sketch%moving(k)%joint == set%traced%output_joint .and. problem%given%outlk > 0.0_wp) wishes%shown = k
         end do
         call wishes%problem%want_derivatives(.true., wanted%sketch%points)
         allocate (wishes%exists(n), source=.false.)
         allocate (wishes%actual(n, wanted%numbers), wishes%miss(n, wanted%numbers), source=0.0_wp)
      end associate
      if (.not. derivatives) return
      allocate (wishes%by(problem%positions, size(wishes%problem%parameters%variables), wishes%wanted%numbers), source=0.0_wp)
      call prepare_sensitivity(wishes%problem, wishes%work)
   end subroutine prepare_output_wishes

   !> What a linkage does of what is desired.
   subroutine find_output_wishes(wishes, dimensions)
      type(output_wishes_t), intent(inout) :: wishes
      type(dimensions_t), intent(in) :: dimensions
      complex(wp), allocatable :: joint(:, :, :)
      real(wp), allocatable :: moved(:, :, :)
      real(wp) :: values(wishes%wanted%numbers, 0:most_orders)
      integer :: block, offset, n, i, loop

      call place_first_output(wishes, dimensions)
      associate (problem => wishes%problem, wanted => wishes%wanted)
         allocate (joint(size(wanted%sketch%drawn), 0:most_orders, problem%linkage%room), source=(0.0_wp, 0.0_wp))
         allocate (moved(size(wanted%sketch%arcs), 0:most_orders, problem%linkage%room), source=0.0_wp)
         call problem%bind(dimensions)
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, n)
            call find_places(wanted%sketch, problem, n, joint(:, 0, :n), moved(:, 0, :n))
            do i = 1, n
               associate (exists => wishes%exists(offset + i), miss => wishes%miss(offset + i, :))
                  exists = all([(problem%linkage%closes(i, loop), loop=1, problem%mechanism%nloop)])
                  miss = 0.0_wp
                  if (.not. exists) cycle
                  call values_of_outputs(wanted%outputs, joint(:, :, i), moved(:, :, i), [0.0_wp, 0.0_wp], values)
                  wishes%actual(offset + i, :) = values(:, 0)
                  miss = values(:, 0) - problem%wish_values(offset + i, :)
                  where (wanted%angle) miss = miss - full_turn*anint(miss/full_turn)
               end associate
            end do
         end do
      end associate
   end subroutine find_output_wishes

   !> The same, and its changes with every variable.
   subroutine differentiate_output_wishes(wishes, dimensions)
      type(output_wishes_t), intent(inout) :: wishes
      type(dimensions_t), intent(in) :: dimensions
      real(wp) :: unused(size(wishes%by, 1), size(wishes%by, 2), wishes%problem%output%kind%components)
      integer :: v, k, nvar

      call find_output_wishes(wishes, dimensions)
      call find_jacobian(wishes%problem, dimensions, wishes%work, unused, wanted=wishes%wanted)
      nvar = size(wishes%by, 2)
      wishes%by = wishes%wanted%change(:, :nvar, :)
      do v = 1, nvar
         associate (kind => wishes%problem%parameters%variables(v)%kind)
            if (kind /= variable_outlk .and. kind /= variable_outang) cycle
            wishes%by(:, v, :) = 0.0_wp
            k = findloc(wishes%wanted%apart, wishes%shown, dim=1)
            if (wishes%shown == 0 .or. k == 0) cycle
            wishes%by(:, v, :) = wishes%wanted%change(:, nvar + 2*k - merge(1, 0, kind == variable_outlk), :)
         end associate
      end do
      do k = 1, size(wishes%exists)
         if (.not. wishes%exists(k)) wishes%by(k, :, :) = 0.0_wp
      end do
   end subroutine differentiate_output_wishes

   !> The joint that is the first output moves with OUTLK and OUTANG.
   subroutine place_first_output(wishes, dimensions)
      type(output_wishes_t), intent(inout) :: wishes
      type(dimensions_t), intent(in) :: dimensions
      real(wp) :: c, s

      if (wishes%shown == 0) return
      call unit_vector(dimensions%outang, c, s)
      wishes%wanted%sketch%moving(wishes%shown)%offset = dimensions%outlk*cmplx(c, s, wp)
   end subroutine place_first_output

   !> Sum of weight * miss**2 of the linkage looked at last.
   pure real(wp) function sum_of_wish_errors(wishes) result(total)
      type(output_wishes_t), intent(in) :: wishes

      total = sum(wishes%problem%wish_weights*wishes%miss**2)
   end function sum_of_wish_errors
end module psalm_output_wishes
