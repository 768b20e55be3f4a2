!> Whether the loops that were chosen for a sketch are the sketch: solved at the drawing they must give its joints.
!>
!> The loops are translated by rules for each kind of dyad (`psalm_loop_trace`); the joints come from the equations in the poses of
!> the links. Two ways to the same numbers: a rule that is wrong for some sketch shows here, and not in a result.
module psalm_loop_check
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, new_problem
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   use psalm_rates, only: rates_t, prepare_rates, differentiate, highest_order
   use psalm_setup, only: set_up
   use psalm_sketch, only: frame_link
   use psalm_sketch_motion, only: observe_sketch
   use psalm_status, only: diagnostics_t, level_error
   implicit none (type, external)
   private
   public :: check_loops

   real(wp), parameter :: one_place = 1.0e-6_wp !! of the drawing's size: near a dead point half of the digits are lost

contains

   !> Solve the loops of a sketch at the drawing and compare all joints and slides.
   subroutine check_loops(set, why)
      type(data_set_t), intent(in) :: set                !! a sketch with its loops
      character(:), allocatable, intent(out) :: why      !! what it has that loops cannot describe; empty: the loops are right
      type(mechanism_t) :: mechanism
      type(dimensions_t) :: dimensions
      type(parameters_t) :: parameters
      type(diagnostics_t) :: findings
      class(problem_t), allocatable :: problem
      type(rates_t), allocatable :: rates
      complex(wp), allocatable :: joint(:, :, :)
      real(wp), allocatable :: moved(:, :, :)
      real(wp) :: extent
      integer :: k, offset, n

      why = ''
      call set_up(set, mechanism, dimensions, parameters, findings)
      do k = 1, findings%count
         if (findings%list(k)%level /= level_error) cycle
         ! the arrays are not the user's: what is wrong with them is no message. Everything else is reported later
         if (findings%list(k)%group == 'LINKS') why = 'links for which there are no loops'
         return
      end do
      if (any(set%traced%joint_places%arc == 0 .and. set%traced%joint_places%link /= frame_link) .or. &
          any(set%traced%travels%arc == 0)) then
         why = 'links for which there are no loops'
         return
      end if
      allocate (problem, rates)
      dimensions%crnki = dimensions%drawn
      ! with a phase the drawing is no position of the motion
      mechanism%actuators%phase = 0.0_wp
      call new_problem(mechanism, dimensions, parameters, [0.0_wp], .true., problem)
      associate (sketch => set%traced%moving)
         call problem%want_derivatives(.true., sketch%points)
         call problem%bind(dimensions)
         call problem%solve_block(1, offset, n)
         call prepare_rates(problem, rates)
         call differentiate(problem, rates, n, highest_order)
         allocate (joint(size(sketch%drawn), 0:highest_order, n), moved(size(sketch%arcs), 0:highest_order, n))
         call observe_sketch(sketch, problem, rates, n, 1.0_wp, 0.0_wp, joint, moved)
         associate (x => [set%sketch%x, set%sketch%slides%x], y => [set%sketch%y, set%sketch%slides%y])
            extent = max(maxval(x) - minval(x), maxval(y) - minval(y))
            if (extent <= 0.0_wp) extent = max(maxval(abs(x)), maxval(abs(y)))
         end associate
         if (all(abs(joint(:, 0, 1) - sketch%drawn) <= one_place*extent) .and. &
             all(abs(moved(:, 0, 1)) <= one_place*extent)) return
      end associate
      why = 'links whose loops do not give the drawing'
   end subroutine check_loops
end module psalm_loop_check
