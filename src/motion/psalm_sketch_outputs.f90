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
                           output_pose, output_ratio, output_x, output_y, columns_of, most_targets
   implicit none (type, external)
   private
   public :: names_of_numbers, values_of_outputs, change_of_values, unwrap, name_length

   integer, parameter :: name_length = 48            !! characters of a column's name
   real(wp), parameter :: at_rest = 1.0e-12_wp     !! of the largest rate: a slower output stands still but for rounding

contains

   !> Names of the numbers of all outputs, which of them are angles that may turn on, and which are any angles.
   pure subroutine names_of_numbers(outputs, names, turning, angles)
      type(sketch_output_t), intent(in) :: outputs(:)
      character(name_length), allocatable, intent(out) :: names(:)
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

   !> How values and derivatives change where the places and their derivatives change: of values as `values_of_outputs` has them, a
   !> change each, of angles in degrees, of their rates in radians; of a ratio, that of its value.
   pure subroutine change_of_values(outputs, joint, joint_change, moved_change, values, change)
      type(sketch_output_t), intent(in) :: outputs(:)
      complex(wp), intent(in) :: joint(:, 0:)          !! shape (joints, 0:most_orders): places
      complex(wp), intent(in) :: joint_change(:, 0:)   !! shape (joints, 0:most_targets)
      real(wp), intent(in) :: moved_change(:, 0:)      !! shape (slides, 0:most_targets): of the travel
      real(wp), intent(in) :: values(:, 0:)            !! shape (numbers of all outputs, 0:most_orders)
      real(wp), intent(out) :: change(:, 0:)           !! shape (numbers of all outputs, 0:most_targets)
      complex(wp) :: z(0:most_orders), dz(0:most_targets), l(0:most_orders), dl(0:most_targets), dm(0:most_targets)
      integer :: first(size(outputs))
      integer :: k, n

      n = 1
      change = 0.0_wp
      do k = 1, size(outputs)
         first(k) = n
         associate (output => outputs(k))
            select case (output%kind)
            case (output_point, output_pose)
               change(n, :) = joint_change(output%joints(1), :)%re
               change(n + 1, :) = joint_change(output%joints(1), :)%im
               if (output%kind == output_pose) then
                  dl = change_along(output%joints(2), output%joints(3))
                  change(n + 2, :) = dl%im*[degrees_per_radian, 1.0_wp, 1.0_wp]
               end if
            case (output_x)
               change(n, :) = joint_change(output%joints(1), :)%re
            case (output_y)
               change(n, :) = joint_change(output%joints(1), :)%im
            case (output_angle)
               dl = change_along(output%joints(1), output%joints(2))
               change(n, :) = dl%im*[degrees_per_radian, 1.0_wp, 1.0_wp]
            case (output_between)
               dl = change_along(output%joints(1), output%joints(2))
               dm = change_along(output%joints(3), output%joints(4))
               change(n, :) = (dm%im - dl%im)*[degrees_per_radian, 1.0_wp, 1.0_wp]
            case (output_distance)
               z = joint(output%joints(1), :)
               dz = joint_change(output%joints(1), :)
               if (output%joints(2) > 0) then
                  z = joint(output%joints(2), :) - z
                  dz = joint_change(output%joints(2), :) - dz
               end if
               l = logarithm(z)
               dl = change_of_logarithm(z, dz, l)
               associate (r => abs(z(0)))
                  change(n, 0) = r*dl(0)%re
                  change(n, 1) = r*(dl(0)%re*l(1)%re + dl(1)%re)
                  change(n, 2) = r*(dl(0)%re*(l(1)%re**2 + l(2)%re) + 2.0_wp*l(1)%re*dl(1)%re + dl(2)%re)
               end associate
            case (output_slide)
               change(n, :) = moved_change(output%slide, :)
            case (output_ratio)
               associate (a => first(output%outputs(1)), b => first(output%outputs(2)))
                  if (values(n, 0) < huge(1.0_wp)) change(n, 0) = (change(a, 1) - values(n, 0)*change(b, 1))/values(b, 1)
               end associate
            end select
         end associate
         n = n + columns_of(outputs(k))
      end do

   contains

      !> Change of the logarithm of the line between two joints.
      pure function change_along(from, to)
         integer, intent(in) :: from, to
         complex(wp) :: change_along(0:most_targets), line(0:most_orders)

         line = joint(to, :) - joint(from, :)
         change_along = change_of_logarithm(line, joint_change(to, :) - joint_change(from, :), logarithm(line))
      end function change_along
   end subroutine change_of_values

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

   !> Changes of the derivatives of log z where those of z change; for the zero vector all are 0.
   pure function change_of_logarithm(z, dz, l) result(dl)
      complex(wp), intent(in) :: z(0:most_orders)
      complex(wp), intent(in) :: dz(0:most_targets)
      complex(wp), intent(in) :: l(0:most_orders)  !! derivatives of log z
      complex(wp) :: dl(0:most_targets)

      dl = (0.0_wp, 0.0_wp)
      if (z(0) == (0.0_wp, 0.0_wp)) return
      dl(0) = dz(0)/z(0)
      dl(1) = dz(1)/z(0) - l(1)*dl(0)
      dl(2) = dz(2)/z(0) - (l(2) + l(1)**2)*dl(0) - 2.0_wp*l(1)*dl(1)
   end function change_of_logarithm

   !> Angles of a row of positions without jumps of a turn.
   pure subroutine unwrap(values)
      real(wp), intent(inout) :: values(:)         !! degrees
      integer :: k

      do k = 2, size(values)
         values(k) = values(k) - full_turn*anint((values(k) - values(k - 1))/full_turn)
      end do
   end subroutine unwrap
end module psalm_sketch_outputs
