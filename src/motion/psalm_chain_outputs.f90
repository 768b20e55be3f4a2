!> Outputs of a sketch: values and rates from the places of joints.
!>
!> A line from joint to joint is z = r exp(i theta); the derivatives of log z hold those of its length in their real, those
!> of its direction in their imaginary parts.
module psalm_chain_outputs
   use psalm_angles, only: degrees_of
   use psalm_closure, only: closure_t, state_t, most_orders, travel
   use psalm_kinds, only: wp, degrees_per_radian, full_turn
   use psalm_sketch, only: sketch_output_t, output_point, output_angle, output_distance, output_slide, output_between, &
                           output_pose, output_ratio, output_x, output_y, columns_of
   implicit none (type, external)
   private
   public :: column_name, output_at, unwrap

   real(wp), parameter :: at_rest = 1.0e-12_wp     !! of the largest rate: a slower output stands still but for rounding

contains

   !> Name of a number of an output.
   pure function column_name(output, column) result(name)
      type(sketch_output_t), intent(in) :: output
      integer, intent(in) :: column
      character(:), allocatable :: name

      name = trim(output%name)
      if (columns_of(output) == 1) return
      select case (column)
      case (1)
         name = name//'.x'
      case (2)
         name = name//'.y'
      case default
         name = name//'.angle'
      end select
   end function column_name

   !> Values and derivatives of all numbers of all outputs: angles in degrees, their rates in radians.
   pure subroutine output_at(closure, state, outputs, values)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(sketch_output_t), intent(in) :: outputs(:)
      real(wp), intent(out) :: values(:, 0:)       !! shape (numbers of all outputs, 0:most_orders)
      complex(wp) :: z(0:most_orders), l(0:most_orders), m(0:most_orders)
      real(wp) :: a(0:most_orders), b(0:most_orders), ratio(0:most_orders)
      integer :: first(size(outputs))
      integer :: k, n, order

      n = 1
      do k = 1, size(outputs)
         first(k) = n
         associate (output => outputs(k))
            select case (output%kind)
            case (output_point, output_pose)
               values(n, :) = state%joint(output%joints(1), :)%re
               values(n + 1, :) = state%joint(output%joints(1), :)%im
               if (output%kind == output_pose) then
                  l = logarithm(state%joint(output%joints(3), :) - state%joint(output%joints(2), :))
                  values(n + 2, :) = l%im
                  values(n + 2, 0) = l(0)%im*degrees_per_radian
               end if
            case (output_x)
               values(n, :) = state%joint(output%joints(1), :)%re
            case (output_y)
               values(n, :) = state%joint(output%joints(1), :)%im
            case (output_angle)
               l = logarithm(state%joint(output%joints(2), :) - state%joint(output%joints(1), :))
               values(n, :) = l%im
               values(n, 0) = l(0)%im*degrees_per_radian
            case (output_between)
               l = logarithm(state%joint(output%joints(2), :) - state%joint(output%joints(1), :))
               m = logarithm(state%joint(output%joints(4), :) - state%joint(output%joints(3), :))
               values(n, :) = m%im - l%im
               values(n, 0) = (m(0)%im - l(0)%im)*degrees_per_radian
               values(n, 0) = values(n, 0) - full_turn*anint(values(n, 0)/full_turn)
            case (output_distance)
               z = state%joint(output%joints(1), :)
               if (output%joints(2) > 0) z = state%joint(output%joints(2), :) - z
               l = logarithm(z)
               associate (r => abs(z(0)))
                  values(n, 0) = r
                  values(n, 1) = r*l(1)%re
                  values(n, 2) = r*(l(1)%re**2 + l(2)%re)
                  values(n, 3) = r*(l(1)%re**3 + 3.0_wp*l(1)%re*l(2)%re + l(3)%re)
               end associate
            case (output_slide)
               do order = 0, most_orders
                  m(order) = travel(closure, state, output%slide, order)
               end do
               values(n, :) = m%re
            case (output_ratio)
               a = values(first(output%outputs(1)), :)
               b = values(first(output%outputs(2)), :)
               call quotient(a, b, at_rest*largest_rate(state, outputs(output%outputs(2))), ratio)
               values(n, :) = ratio
            end select
         end associate
         n = n + columns_of(outputs(k))
      end do
   end subroutine output_at

   !> The largest rate that an output of this kind could have: of any link, or of any joint and drive.
   pure real(wp) function largest_rate(state, output)
      type(state_t), intent(in) :: state
      type(sketch_output_t), intent(in) :: output

      if (output%kind == output_angle .or. output%kind == output_between) then
         largest_rate = maxval(abs(state%phi(:, 1)))
      else
         largest_rate = max(maxval(abs(state%joint(:, 1))), maxval(abs(state%t(:, 1))))
      end if
   end function largest_rate

   !> Ratio of two rates and its derivatives, as far as the rates' are known; where the second output stands still it is given as
   !> huge: there is none.
   pure subroutine quotient(a, b, rest, ratio)
      real(wp), intent(in) :: a(0:most_orders), b(0:most_orders)
      real(wp), intent(in) :: rest            !! a rate that is none
      real(wp), intent(out) :: ratio(0:most_orders)

      ratio = 0.0_wp
      if (abs(b(1)) <= max(rest, tiny(1.0_wp)*max(1.0_wp, abs(a(1))))) then
         ratio(0) = huge(1.0_wp)
         return
      end if
      ratio(0) = a(1)/b(1)
      ratio(1) = (a(2) - ratio(0)*b(2))/b(1)
      ratio(2) = (a(3) - 2.0_wp*ratio(1)*b(2) - ratio(0)*b(3))/b(1)
   end subroutine quotient

   !> Derivatives of log z from those of z; for the zero vector all are 0.
   pure function logarithm(z) result(l)
      complex(wp), intent(in) :: z(0:most_orders)
      complex(wp) :: l(0:most_orders)

      l = (0.0_wp, 0.0_wp)
      if (z(0) == (0.0_wp, 0.0_wp)) return
      l(0) = cmplx(0.0_wp, degrees_of(z(0)%re, z(0)%im)/degrees_per_radian, wp)
      l(1) = z(1)/z(0)
      l(2) = z(2)/z(0) - l(1)**2
      l(3) = z(3)/z(0) - 3.0_wp*l(1)*l(2) - l(1)**3
   end function logarithm

   !> Angles of a row of positions without jumps of a turn.
   pure subroutine unwrap(values)
      real(wp), intent(inout) :: values(:)         !! degrees
      integer :: k

      do k = 2, size(values)
         values(k) = values(k) - full_turn*anint((values(k) - values(k - 1))/full_turn)
      end do
   end subroutine unwrap
end module psalm_chain_outputs
