!> A mechanism reduced to its crank: its inertia J, and the torque of weight, loads, springs and dampers there.
module psalm_reduced
   use psalm_error, only: problem_t, motion_t
   use psalm_force_analysis, only: force_table_t, analyse_forces, column_drive, column_of_other_drive
   use psalm_force_model, only: force_model_t, friction_t, load_t, spring_t, vertices_of
   use psalm_kinds, only: wp
   use psalm_spring_law, only: part_elastic, part_viscous
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: reduced_t, reduce_machine

   !> What the mechanism is for its crank, at a row of inputs.
   type :: reduced_t
      real(wp), allocatable :: inertia(:)    !! J, kg m2
      real(wp), allocatable :: slope(:)      !! J', kg m2/rad
      real(wp), allocatable :: torque(:)     !! of weight, loads and springs, N m
      real(wp), allocatable :: damping(:)    !! of dampers, N m s
      integer :: failure = 0                 !! first input at which the linkage does not close or is at a dead point; 0: none
   end type reduced_t

contains

   !> Inertia and torque on the crank at increments of the input. `problem` is left at these inputs. What the host ends is of no
   !> use.
   subroutine reduce_machine(problem, model, delt, reduced, stop)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: delt(:)               !! degrees from CRNKI
      type(reduced_t), intent(out) :: reduced
      type(stop_t), intent(in), optional :: stop    !! asked now and then
      type(force_model_t) :: only
      type(force_table_t) :: table
      type(motion_t) :: motion
      integer :: k

      call problem%set_inputs(delt)
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(problem%given, motion, stop=stop)
      ! masses alone: the drive at unit speed is half of J'
      only = model
      only%gravity = 0.0_wp
      only%loads = [load_t ::]
      only%springs = [spring_t ::]
      only%friction = [friction_t ::]
      call analyse_forces(problem, only, 1.0_wp, 0.0_wp, motion%closed, motion%input, table, stop)
      reduced%inertia = 2.0_wp*table%kinetic
      ! drives geared to the crank are moved through it
      reduced%slope = 2.0_wp*table%value(:, column_drive)*merge(model%metre, 1.0_wp, problem%mechanism%sliding_input)
      do k = 2, size(problem%mechanism%actuators)
         associate (actuator => problem%mechanism%actuators(k))
            reduced%slope = reduced%slope + 2.0_wp*actuator%by_first(1)*merge(model%metre, 1.0_wp, actuator%slides)* &
                            table%value(:, column_of_other_drive(size(problem%mechanism%joints), k))
         end associate
      end do
      reduced%failure = findloc([(table%known(k), k=1, size(delt))], .false., dim=1)
      ! everything else but dampers, at unit speed, where power is torque
      only = model
      only%friction = [friction_t ::]
      only%springs%part = part_elastic
      call analyse_forces(problem, only, 1.0_wp, 0.0_wp, motion%closed, motion%input, table, stop)
      reduced%torque = table%power
      only%gravity = 0.0_wp
      only%loads = [load_t ::]
      only%springs = model%springs
      only%springs%part = part_viscous
      call analyse_forces(problem, only, 1.0_wp, 0.0_wp, motion%closed, motion%input, table, stop)
      reduced%damping = -table%power
   end subroutine reduce_machine
end module psalm_reduced
