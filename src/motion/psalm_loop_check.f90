!> Whether the loops that were chosen for a sketch are the sketch: solved at the drawing they must give its joints.
!>
!> The loops are translated by rules for each kind of dyad (`psalm_loop_trace`); the joints come from the equations in the poses of
!> the links. Two ways to the same numbers: a rule that is wrong for some sketch shows here, and not in a result.
module psalm_loop_check
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, new_problem
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, at_finish
   use psalm_parameters, only: parameters_t
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t, level_error
   implicit none (type, external)
   private
   public :: check_loops

   real(wp), parameter :: one_place = 1.0e-6_wp !! of the drawing's size: near a dead point half of the digits are lost

contains

   !> Solve the loops of a sketch at the drawing and compare all joints.
   subroutine check_loops(set, why)
      type(data_set_t), intent(in) :: set                !! a sketch with its loops
      character(:), allocatable, intent(out) :: why      !! what it has that loops cannot describe; empty: the loops are right
      type(mechanism_t) :: mechanism
      type(dimensions_t) :: dimensions
      type(parameters_t) :: parameters
      type(diagnostics_t) :: findings
      class(problem_t), allocatable :: problem
      integer, allocatable :: joints(:, :)               !! shape (2, ends): loop and arc
      integer :: loop, a, k, offset, n, joint
      real(wp) :: extent

      why = ''
      call set_up(set, mechanism, dimensions, parameters, findings)
      do k = 1, findings%count
         if (findings%list(k)%level /= level_error) cycle
         ! the arrays are not the user's: what is wrong with them is no message. Everything else is reported later
         if (findings%list(k)%group == 'LINKS') why = 'links for which there are no loops'
         return
      end do
      allocate (problem)
      dimensions%crnki = set%crnki_of_drawing
      call new_problem(mechanism, dimensions, parameters, [0.0_wp], .true., problem)
      allocate (joints(2, 0))
      do loop = 1, mechanism%nloop
         do a = 1, mechanism%loops(loop)%arcs - 1
            if (len_trim(set%end_names(at_finish, a, loop)) > 0) joints = reshape([joints, loop, a], [2, size(joints, 2) + 1])
         end do
      end do
      call problem%want_derivatives(.true., joints)
      call problem%bind(dimensions)
      call problem%solve_block(1, offset, n)
      extent = max(maxval(set%sketch%x) - minval(set%sketch%x), maxval(set%sketch%y) - minval(set%sketch%y))
      do k = 1, size(joints, 2)
         joint = set%sketch%joint_called(trim(set%end_names(at_finish, joints(2, k), joints(1, k))))
         associate (link => problem%linkage, point => problem%plan%joint_points(k))
            if (hypotenuse(link%store%v(1, link%point_x(point))/link%scale + problem%output%origin_x - set%sketch%x(joint), &
                      link%store%v(1, link%point_y(point))/link%scale + problem%output%origin_y - set%sketch%y(joint)) &
                <= one_place*extent) cycle
         end associate
         why = 'links whose loops do not give the drawing'
         return
      end do
   end subroutine check_loops
end module psalm_loop_check
