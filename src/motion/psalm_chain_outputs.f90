!> Outputs of a sketch that is solved in the poses of its links.
module psalm_chain_outputs
   use psalm_closure, only: closure_t, state_t, most_orders, travel
   use psalm_kinds, only: wp
   use psalm_sketch, only: sketch_output_t, output_slide
   use psalm_sketch_outputs, only: values_of_outputs
   implicit none (type, external)
   private
   public :: output_at

contains

   !> Values and derivatives of all numbers of all outputs: angles in degrees, their rates in radians.
   pure subroutine output_at(closure, state, outputs, values)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(sketch_output_t), intent(in) :: outputs(:)
      real(wp), intent(out) :: values(:, 0:)       !! shape (numbers of all outputs, 0:most_orders)
      real(wp) :: moved(size(closure%sketch%slides), 0:most_orders)
      complex(wp) :: z
      integer :: k, order

      moved = 0.0_wp
      do k = 1, size(outputs)
         if (outputs(k)%kind /= output_slide) cycle
         do order = 0, most_orders
            z = travel(closure, state, outputs(k)%slide, order)
            moved(outputs(k)%slide, order) = z%re
         end do
      end do
      call values_of_outputs(outputs, state%joint, moved, [maxval(abs(state%phi(:, 1))), &
                             max(maxval(abs(state%joint(:, 1))), maxval(abs(state%t(:, 1))))], values)
   end subroutine output_at
end module psalm_chain_outputs
