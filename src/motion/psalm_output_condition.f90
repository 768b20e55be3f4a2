!> Condition numbers of all outputs of a sketch, from the bounds that `psalm_condition` carries along the plan.
!>
!> A joint's bound is that of its point of the plan and, where it stands off the arcs, that of the line to it; the bound of a line
!> is that of both its ends. Points, distances and travel are relative to what they are, angles to a radian, as the first output's.
module psalm_output_condition
   use psalm_condition, only: condition_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_sketch, only: sketch_output_t, output_point, output_angle, output_distance, output_slide, output_between, &
                           output_pose, output_ratio, output_x, output_y
   use psalm_moving_joints, only: sketch_motion_t
   implicit none (type, external)
   private
   public :: output_conditions

   real(wp), parameter :: worst = 1.0_wp/epsilon(1.0_wp) !! no digit is left

contains

   !> Condition number of every output at a position of the block just solved; of a ratio of rates, whose bound is not found, huge.
   pure subroutine output_conditions(outputs, sketch, problem, condition, joint, moved, numbers)
      type(sketch_output_t), intent(in) :: outputs(:)
      type(sketch_motion_t), intent(in) :: sketch      !! its points are in the plan
      class(problem_t), intent(in) :: problem
      type(condition_t), intent(in) :: condition       !! of the position
      complex(wp), intent(in) :: joint(:)              !! shape (joints): places there
      real(wp), intent(in) :: moved(:)                 !! shape (slides): travel there
      real(wp), intent(out) :: numbers(:)              !! shape (outputs)
      real(wp) :: bound(0:size(joint))                 !! by joint: user's length, in units of epsilon; 0: the origin of the machine
      real(wp) :: length
      integer :: k

      bound = 0.0_wp
      bound(1:) = abs(joint)
      associate (link => problem%linkage, plan => problem%plan)
         do k = 1, size(sketch%moving)
            associate (one => sketch%moving(k))
               bound(one%joint) = condition%row(link%point_x(plan%joint_points(k)))/link%scale + abs(joint(one%joint))
               if (abs(one%offset) > 0.0_wp) bound(one%joint) = bound(one%joint) + abs(one%offset)* &
                                                                (condition%row(link%root_x(plan%root(one%arc))) + 2.0_wp &
                                                                 + abs(link%angle(one%arc))*radians_per_degree)
            end associate
         end do
         do k = 1, size(outputs)
            associate (j => outputs(k)%joints)
               select case (outputs(k)%kind)
               case (output_point, output_x, output_y)
                  numbers(k) = 1.0_wp + ratio(bound(j(1)), abs(joint(j(1))))
               case (output_pose)
                  numbers(k) = 1.0_wp + max(ratio(bound(j(1)), abs(joint(j(1)))), turn(j(2), j(3)))
               case (output_angle)
                  numbers(k) = 1.0_wp + turn(j(1), j(2))
               case (output_between)
                  numbers(k) = 1.0_wp + turn(j(1), j(2)) + turn(j(3), j(4))
               case (output_distance)
                  length = abs(joint(j(1)))
                  if (j(2) > 0) length = abs(joint(j(2)) - joint(j(1)))
                  numbers(k) = 1.0_wp + ratio(bound(j(1)) + bound(j(2)), length)
               case (output_slide)
                  associate (arc => sketch%arcs(outputs(k)%slide), zero => abs(sketch%zero(outputs(k)%slide)))
                     numbers(k) = worst
                     if (arc > 0) numbers(k) = 1.0_wp + ratio(condition%row(link%slide(plan%length_slot(arc)))/link%scale + zero, &
                                                             max(abs(moved(outputs(k)%slide)), zero))
                  end associate
               case (output_ratio)
                  numbers(k) = huge(1.0_wp)
                  cycle
               end select
               numbers(k) = min(numbers(k), worst)
            end associate
         end do
      end associate

   contains

      !> Bound of the direction from a joint to another, radians.
      pure real(wp) function turn(from, to)
         integer, intent(in) :: from, to

         turn = ratio(bound(from) + bound(to), abs(joint(to) - joint(from)))
      end function turn

      !> a/b, but no more than `worst`.
      pure real(wp) function ratio(a, b)
         real(wp), intent(in) :: a, b                  !! a >= 0, b >= 0

         ratio = worst
         if (b*worst > a) ratio = a/b
      end function ratio
   end subroutine output_conditions
end module psalm_output_condition
