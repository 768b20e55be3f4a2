!> Potential energy of weight and springs at a position of the block that the forces were found at.
module psalm_potential
   use psalm_angles, only: degrees_of, nearest_difference
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t, spring_t, parameter_mass, parameter_mx, parameter_my
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_kinetostatics, only: forces_t, find_location
   use psalm_mechanism, only: body_frame
   implicit none (type, external)
   private
   public :: potential_energy, stretch_of, torsion

contains

   !> J, from the input pivot and the free lengths. The bodies have been moved (`move_bodies`).
   real(wp) function potential_energy(problem, model, forces) result(energy)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(in) :: forces
      real(wp) :: ex, ey
      integer :: b, k

      energy = 0.0_wp
      associate (w => forces%w%v, v => problem%linkage%store%v)
         do b = body_frame + 1, size(forces%bodies)
            associate (body => forces%bodies(b), of => model%inertia(:, b), g => model%gravity)
               ex = w(1, body%ex)
               ey = w(1, body%ey)
               energy = energy - of(parameter_mass)*forces%metre*(g(1)*v(1, body%px) + g(2)*v(1, body%py)) &
                        - g(1)*(of(parameter_mx)*ex - of(parameter_my)*ey) - g(2)*(of(parameter_mx)*ey + of(parameter_my)*ex)
            end associate
         end do
         do k = 1, size(model%springs)
            associate (spring => model%springs(k))
               energy = energy + spring%energy(stretch_of(problem, model, spring, forces), model%metre)
            end associate
         end do
      end associate
   end function potential_energy

   !> Length of a spring less its free one, metres; of a torsional one its angle, radians.
   real(wp) function stretch_of(problem, model, spring, forces) result(stretch)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(spring_t), intent(in) :: spring
      type(forces_t), intent(in) :: forces
      real(wp), dimension(1) :: ax, ay, bx, by

      if (spring%torsional) then
         stretch = torsion(spring, forces)
      else
         call find_location(problem, forces, spring%ends(1), 1, ax, ay)
         call find_location(problem, forces, spring%ends(2), 1, bx, by)
         stretch = hypotenuse(bx(1) - ax(1), by(1) - ay(1))*forces%metre - spring%free*model%metre
      end if
   end function stretch_of

   !> How far a torsional spring is turned from SFREE, radians, within half a turn.
   pure real(wp) function torsion(spring, forces)
      type(spring_t), intent(in) :: spring
      type(forces_t), intent(in) :: forces
      real(wp) :: ex, ey, fx, fy

      call direction(spring%ends(1)%body, spring%ends(1)%along, ex, ey)
      call direction(spring%ends(2)%body, spring%ends(2)%along, fx, fy)
      torsion = radians_per_degree*nearest_difference(degrees_of(ex*fx + ey*fy, ex*fy - ey*fx), spring%free)

   contains

      !> Direction of the arc by which a place was named.
      pure subroutine direction(body, along, x, y)
         integer, intent(in) :: body
         real(wp), intent(in) :: along(2)
         real(wp), intent(out) :: x, y

         associate (c => forces%w%v(1, forces%bodies(body)%ex), s => forces%w%v(1, forces%bodies(body)%ey))
            x = along(1)*c - along(2)*s
            y = along(1)*s + along(2)*c
         end associate
      end subroutine direction
   end function torsion
end module psalm_potential
