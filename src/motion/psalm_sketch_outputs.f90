!> Outputs of a sketch: values and rates from the places of joints, however these were found.
!>
!> The one place that knows what each kind is computed from. A line from joint to joint is z = r exp(i theta); the derivatives of
!> log z hold those of its length in their real, those of its direction in their imaginary parts.
module psalm_sketch_outputs
   use psalm_angles, only: degrees_of
   use psalm_closure, only: most_orders
   use psalm_kinds, only: wp, degrees_per_radian, full_turn
   use psalm_output_kind, only: output_kind_t, kind_of_output
   use psalm_sketch, only: sketch_output_t, output_point, output_angle, output_distance, output_slide, output_between, &
                           output_pose, output_ratio, output_x, output_y, columns_of
   implicit none (type, external)
   private
   public :: names_of_numbers, values_of_outputs, unwrap, name_room

   integer, parameter :: name_room = 48            !! characters of a column's name
   real(wp), parameter :: at_rest = 1.0e-12_wp     !! of the largest rate: a slower output stands still but for rounding

contains

   !> Names of the numbers of all outputs, which of them are angles that may turn on, and which are any angles.
   pure subroutine names_of_numbers(outputs, names, turning, angles)
      type(sketch_output_t), intent(in) :: outputs(:)
      character(name_room), allocatable, intent(out) :: names(:)
      logical, allocatable, intent(out) :: turning(:)
      logical, allocatable, intent(out), optional :: angles(:)
      type(output_kind_t) :: kind
      integer :: k, c, n

      n = 0
      do k = 1, size(outputs)
         n = n + columns_of(outputs(k))
      end do
      allocate (names(n), turning(n))
      if (present(angles)) allocate (angles(n))
      n = 0
      do k = 1, size(outputs)
         kind = kind_of_output(outputs(k)%kind)
         do c = 1, kind%components
            n = n + 1
            names(n) = outputs(k)%name
            if (kind%components > 1) names(n) = trim(names(n))//'.'//kind%suffix(c)(2:)
            if (present(angles)) angles(n) = c == kind%angle
            turning(n) = c == kind%angle .and. outputs(k)%kind /= output_between
         end do
      end do
   end subroutine names_of_numbers

   !> Values and derivatives of all numbers of all outputs at a position: angles in degrees, their rates in radians.
   pure subroutine values_of_outputs(outputs, joint, moved, largest, values)
      type(sketch_output_t), intent(in) :: outputs(:)
      complex(wp), intent(in) :: joint(:, 0:)      !! shape (joints, 0:most_orders): places
      real(wp), intent(in) :: moved(:, 0:)         !! shape (slides, 0:most_orders): travel of those that outputs name
      real(wp), intent(in) :: largest(2)           !! largest rates: of any link, radians; of any joint and slide
      real(wp), intent(out) :: values(:, 0:)       !! shape (numbers of all outputs, 0:most_orders)
      complex(wp) :: z(0:most_orders), l(0:most_orders), m(0:most_orders)
      real(wp) :: a(0:most_orders), b(0:most_orders), ratio(0:most_orders)
      integer :: first(size(outputs))
      integer :: k, n

      n = 1
      do k = 1, size(outputs)
         first(k) = n
         associate (output => outputs(k))
            select case (output%kind)
            case (output_point, output_pose)
               values(n, :) = joint(output%joints(1), :)%re
               values(n + 1, :) = joint(output%joints(1), :)%im
               if (output%kind == output_pose) then
                  l = logarithm(joint(output%joints(3), :) - joint(output%joints(2), :))
                  values(n + 2, :) = l%im
                  values(n + 2, 0) = l(0)%im*degrees_per_radian
               end if
            case (output_x)
               values(n, :) = joint(output%joints(1), :)%re
            case (output_y)
               values(n, :) = joint(output%joints(1), :)%im
            case (output_angle)
               l = logarithm(joint(output%joints(2), :) - joint(output%joints(1), :))
               values(n, :) = l%im
               values(n, 0) = l(0)%im*degrees_per_radian
            case (output_between)
               l = logarithm(joint(output%joints(2), :) - joint(output%joints(1), :))
               m = logarithm(joint(output%joints(4), :) - joint(output%joints(3), :))
               values(n, :) = m%im - l%im
               values(n, 0) = (m(0)%im - l(0)%im)*degrees_per_radian
               values(n, 0) = values(n, 0) - full_turn*anint(values(n, 0)/full_turn)
            case (output_distance)
               z = joint(output%joints(1), :)
               if (output%joints(2) > 0) z = joint(output%joints(2), :) - z
               l = logarithm(z)
               associate (r => abs(z(0)))
                  values(n, 0) = r
                  values(n, 1) = r*l(1)%re
                  values(n, 2) = r*(l(1)%re**2 + l(2)%re)
                  values(n, 3) = r*(l(1)%re**3 + 3.0_wp*l(1)%re*l(2)%re + l(3)%re)
               end associate
            case (output_slide)
               values(n, :) = moved(output%slide, :)
            case (output_ratio)
               a = values(first(output%outputs(1)), :)
               b = values(first(output%outputs(2)), :)
               call quotient(a, b, at_rest*rate_like(outputs(output%outputs(2))), ratio)
               values(n, :) = ratio
            end select
         end associate
         n = n + columns_of(outputs(k))
      end do

   contains

      !> The largest rate that an output of this kind could have.
      pure real(wp) function rate_like(output)
         type(sketch_output_t), intent(in) :: output
         type(output_kind_t) :: kind

         kind = kind_of_output(output%kind)
         rate_like = largest(merge(1, 2, kind%components == 1 .and. kind%angle == 1))
      end function rate_like
   end subroutine values_of_outputs

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
end module psalm_sketch_outputs
