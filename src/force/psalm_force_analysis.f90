!> The forces of a mechanism at a row of input positions: all of them, or the share of every source, or by unit masses.
module psalm_force_analysis
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t, mass_parameters
   use psalm_kinds, only: wp
   use psalm_kinetostatics, only: forces_t, prepare_forces, load_bodies, move_bodies, clear_wrenches, add_source, &
                                  find_location, sweep, rub, external_power, joint_rows, listed_rows, sources_of, &
                                  source_inertia
   use psalm_linkage, only: padded
   use psalm_mechanism, only: body_frame
   use psalm_rates, only: rates_t, prepare_rates, differentiate, is_dead
   use psalm_stop, only: stop_t, is_to_end
   implicit none (type, external)
   private
   public :: force_table_t, analyse_forces, share_of_sources, loads_of_unit_masses, loads_of_unit_wrenches, tilting_moments, &
             column_of_joint, column_of_other_drive, columns_of, take_columns
   public :: column_drive, column_fx, column_fy, column_moment

   integer, parameter :: column_drive = 1                    !! torque N m, or force N of a sliding input
   integer, parameter :: column_fx = 2, column_fy = 3        !! force of the mechanism on the frame, N
   integer, parameter :: column_moment = 4                   !! and its moment about the machine origin, N m
   integer, parameter :: fixed_columns = 4                   !! two columns for every joint follow
   integer, parameter :: components_of_wrench = 3            !! force x, force y, moment

   !> Forces at every position.
   type :: force_table_t
      real(wp), allocatable :: value(:, :)     !! shape (positions, columns); finite everywhere, of no meaning where not `known`
      logical, allocatable :: closed(:)        !! shape (positions): every loop closes
      integer, allocatable :: dead(:)          !! shape (positions): the loop that is at a dead point, 0: none
      integer, allocatable :: sweeps(:)        !! shape (positions): sweeps that friction took; 0: the mechanism locks itself,
                                               !! negative: a gas spring, of this number, has no room left
      logical, allocatable :: at_rest(:)       !! shape (positions): a joint with friction does not move: no friction there
      real(wp), allocatable :: kinetic(:)      !! shape (positions): kinetic energy, J
      real(wp), allocatable :: growth(:)       !! shape (positions): its growth, W
      real(wp), allocatable :: power(:)        !! shape (positions): power of weight, loads and springs, W
      real(wp), allocatable :: loss(:)         !! shape (positions): power lost in friction, W
   contains
      procedure :: known
      procedure :: at_rows
   end type force_table_t

contains

   !> True if the forces at a position are known.
   pure logical function known(self, k)
      class(force_table_t), intent(in) :: self
      integer, intent(in) :: k

      known = self%closed(k) .and. self%dead(k) == 0 .and. self%sweeps(k) > 0
   end function known

   !> Some of the positions. Power and loss, which a motion in time has not, are left out.
   pure function at_rows(self, rows) result(some)
      class(force_table_t), intent(in) :: self
      integer, intent(in) :: rows(:)
      type(force_table_t) :: some

      some%value = self%value(rows, :)
      some%closed = self%closed(rows)
      some%dead = self%dead(rows)
      some%sweeps = self%sweeps(rows)
      some%at_rest = self%at_rest(rows)
      some%kinetic = self%kinetic(rows)
      some%growth = self%growth(rows)
   end function at_rows

   !> Column of a drive: those after the first follow the joints.
   pure integer function column_of_other_drive(joints, drive) result(column)
      integer, intent(in) :: joints, drive     !! how many joints there are; 2 or more

      column = fixed_columns + 2*joints + drive - 1
   end function column_of_other_drive

   !> First of the two columns of a joint.
   pure integer function column_of_joint(joint)
      integer, intent(in) :: joint

      column_of_joint = fixed_columns + 2*joint - 1
   end function column_of_joint

   !> All forces. The problem is bound and its plan has every loop, every root and all vertices (`vertices_of`). What the host
   !> ends is not whole and of no use.
   subroutine analyse_forces(problem, model, speed, accel, closed, input, table, stop)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: speed, accel     !! of the input: rad/s or length/s, and per second
      logical, intent(in) :: closed(:)         !! shape (positions)
      real(wp), intent(in) :: input(:)         !! shape (positions): degrees or length
      type(force_table_t), intent(out) :: table
      type(stop_t), intent(in), optional :: stop !! asked before each block
      type(rates_t) :: rates
      type(forces_t) :: forces
      integer :: block, offset, n, source
      logical :: plain                         !! masses and weight only

      plain = size(model%loads) == 0 .and. size(model%springs) == 0 .and. size(model%friction) == 0
      call make_table(problem, table)
      table%closed = closed
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      do block = 1, problem%blocks()
         if (is_to_end(stop)) return
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         call note_dead(problem, rates, offset, n, table)
         if (plain) then
            call load_bodies(problem, model, rates, n, speed, accel, forces)
         else
            call move_bodies(problem, rates, n, speed, accel, forces)
            call clear_wrenches(n, forces)
            do source = source_inertia + 1, sources_of(model)
               call add_source(problem, model, source, input(offset + 1:offset + n), n, forces)
            end do
            call external_power(problem, n, forces)
            call add_source(problem, model, source_inertia, input(offset + 1:offset + n), n, forces)
         end if
         if (size(model%friction) > 0) then
            call rub(problem, model, rates, n, forces)
            table%sweeps(offset + 1:offset + n) = forces%sweeps(1:n)
            table%at_rest(offset + 1:offset + n) = forces%at_rest(1:n)
         else
            call sweep(problem, n, forces)
         end if
         call note_closed(problem, model, forces, n, table%sweeps(offset + 1:offset + n))
         call take_columns(problem, model, forces, n, table%value(offset + 1:offset + n, :))
         table%kinetic(offset + 1:offset + n) = forces%w%v(1:n, forces%kinetic)
         table%growth(offset + 1:offset + n) = forces%w%v(1:n, forces%growth)
         table%power(offset + 1:offset + n) = forces%w%v(1:n, forces%power)
         table%loss(offset + 1:offset + n) = forces%w%v(1:n, forces%loss)
      end do
   end subroutine analyse_forces

   !> Where gas springs have no room left the sweeps of a position count as minus the spring.
   subroutine note_closed(problem, model, forces, n, sweeps)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: n
      integer, intent(inout) :: sweeps(:)      !! shape (n)
      real(wp), dimension(padded(n)) :: ax, ay, bx, by
      integer :: k

      do k = 1, size(model%springs)
         associate (spring => model%springs(k))
            if (.not. spring%power > 0.0_wp) cycle
            call find_location(problem, forces, spring%ends(1), padded(n), ax, ay)
            call find_location(problem, forces, spring%ends(2), padded(n), bx, by)
            where (spring%is_closed(hypotenuse(bx(:n) - ax(:n), by(:n) - ay(:n))*forces%metre - spring%free*model%metre, &
                                    model%metre)) sweeps = -k
         end associate
      end do
   end subroutine note_closed

   !> What each source alone does, without friction: they add up. Shape of the result: (positions, columns, sources).
   subroutine share_of_sources(problem, model, speed, accel, input, shares)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: speed, accel
      real(wp), intent(in) :: input(:)
      real(wp), allocatable, intent(out) :: shares(:, :, :)
      type(rates_t) :: rates
      type(forces_t) :: forces
      integer :: block, offset, n, source

      allocate (shares(problem%positions, columns_of(problem), sources_of(model)), source=0.0_wp)
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         call move_bodies(problem, rates, n, speed, accel, forces)
         do source = 1, sources_of(model)
            call clear_wrenches(n, forces)
            call add_source(problem, model, source, input(offset + 1:offset + n), n, forces)
            call sweep(problem, n, forces)
            call take_columns(problem, model, forces, n, shares(offset + 1:offset + n, :, source))
         end do
      end do
   end subroutine share_of_sources

   !> Moments of inertia forces and weight out of the plane, on the frame about the axes x and y: shape (positions, 2), N m.
   !>
   !> A force F of an element at the height z has the moments -z F_y and z F_x: masses times their heights in place of masses give
   !> forces on the frame that are these moments. Loads and springs act in the plane. Source: Haines (about 1982), table 148a.
   subroutine tilting_moments(problem, model, speed, accel, closed, input, moments)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: speed, accel
      logical, intent(in) :: closed(:)
      real(wp), intent(in) :: input(:)
      real(wp), allocatable, intent(out) :: moments(:, :)
      type(force_model_t) :: raised
      type(force_table_t) :: table

      raised = model
      raised%inertia = 0.0_wp
      raised%inertia(:size(model%tilt, 1), :) = model%tilt
      deallocate (raised%loads, raised%springs, raised%friction)
      allocate (raised%loads(0), raised%springs(0), raised%friction(0))
      call analyse_forces(problem, raised, speed, accel, closed, input, table)
      allocate (moments(size(input), 2))
      moments(:, 1) = -table%value(:, column_fy)
      moments(:, 2) = table%value(:, column_fx)
   end subroutine tilting_moments

   !> Inertia forces of unit masses: every force of the mechanism is the sum over the bodies of these columns times the body's
   !> mass [kg], first moments [kg m] in the axes of its own arc, and moment of inertia [kg m2] about its reference.
   !>
   !> With `source` the weight of unit masses in place of their inertia.
   !> Shape of the result: (positions, columns, 4, bodies); that of the frame is zero. Source: Haines (about 1982), chapter 9.
   subroutine loads_of_unit_masses(problem, model, speed, accel, columns, source)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model   !! its masses do not matter
      real(wp), intent(in) :: speed, accel
      real(wp), allocatable, intent(out) :: columns(:, :, :, :)
      integer, intent(in), optional :: source    !! `source_inertia` (if absent) or `source_weight`
      type(force_model_t) :: unit
      type(rates_t) :: rates
      type(forces_t) :: forces
      real(wp) :: no_input(0)
      integer :: block, offset, n, body, parameter, which

      which = source_inertia
      if (present(source)) which = source
      unit = model
      allocate (columns(problem%positions, columns_of(problem), mass_parameters, size(model%reference)), source=0.0_wp)
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         call move_bodies(problem, rates, n, speed, accel, forces)
         do body = body_frame + 1, size(model%reference)
            do parameter = 1, mass_parameters
               unit%inertia = 0.0_wp
               unit%inertia(parameter, body) = 1.0_wp
               call clear_wrenches(n, forces)
               call add_source(problem, unit, which, no_input, n, forces)
               call sweep(problem, n, forces)
               call take_columns(problem, model, forces, n, columns(offset + 1:offset + n, :, parameter, body))
            end do
         end do
      end do
   end subroutine loads_of_unit_masses

   !> Loads by unit wrenches on bodies: newtons along the machine's axes through the input pivot, and a newton metre.
   !>
   !> Shape of the result: (positions, columns, 3, size(bodies)).
   subroutine loads_of_unit_wrenches(problem, model, bodies, columns)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model   !! its masses do not matter
      integer, intent(in) :: bodies(:)
      real(wp), allocatable, intent(out) :: columns(:, :, :, :)
      type(rates_t) :: rates
      type(forces_t) :: forces
      integer :: block, offset, n, b, k

      allocate (columns(problem%positions, columns_of(problem), components_of_wrench, size(bodies)), source=0.0_wp)
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         call move_bodies(problem, rates, n, 1.0_wp, 0.0_wp, forces)
         do b = 1, size(bodies)
            do k = 1, components_of_wrench
               call clear_wrenches(n, forces)
               associate (row => forces%bodies(bodies(b))%wrench + k - 1)
                  forces%w%v(:, row) = merge(1.0_wp/forces%metre, 1.0_wp, k == components_of_wrench)
               end associate
               call sweep(problem, n, forces)
               call take_columns(problem, model, forces, n, columns(offset + 1:offset + n, :, k, b))
            end do
         end do
      end do
   end subroutine loads_of_unit_wrenches

   pure integer function columns_of(problem)
      type(problem_t), intent(in) :: problem

      columns_of = fixed_columns + 2*size(problem%mechanism%joints) + size(problem%mechanism%actuators) - 1
   end function columns_of

   subroutine make_table(problem, table)
      type(problem_t), intent(in) :: problem
      type(force_table_t), intent(out) :: table

      associate (n => problem%positions)
         allocate (table%value(n, columns_of(problem)), source=0.0_wp)
         allocate (table%dead(n), source=0)
         allocate (table%sweeps(n), source=1)
         allocate (table%at_rest(n), source=.false.)
         allocate (table%kinetic(n), table%growth(n), table%power(n), table%loss(n), source=0.0_wp)
      end associate
   end subroutine make_table

   !> The lowest loop that is at a dead point.
   subroutine note_dead(problem, rates, offset, n, table)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: offset, n
      type(force_table_t), intent(inout) :: table
      integer :: i, loop

      do loop = problem%mechanism%nloop, 1, -1
         do i = 1, n
            if (is_dead(problem, rates, loop, i)) table%dead(offset + i) = loop
         end do
      end do
   end subroutine note_dead

   !> The columns at the first `n` positions of a block, moments about the machine origin.
   subroutine take_columns(problem, model, forces, n, value)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: n
      real(wp), intent(out) :: value(:, :)       !! shape (n, columns)
      integer :: j

      associate (w => forces%w%v, frame => forces%bodies(body_frame)%wrench, to_metres => forces%metre*forces%unit)
         value(:, column_drive) = w(1:n, forces%drive)
         value(:, column_fx) = w(1:n, frame)
         value(:, column_fy) = w(1:n, frame + 1)
         value(:, column_moment) = forces%metre*w(1:n, frame + 2) + to_metres*(problem%output%origin_x*w(1:n, frame + 1) - &
                                                                               problem%output%origin_y*w(1:n, frame))
      end associate
      do j = 1, size(forces%joints)
         value(:, column_of_joint(j):column_of_joint(j) + 1) = listed_rows(problem, model, forces, j, n)
      end do
      do j = 2, size(forces%drives)
         value(:, column_of_other_drive(size(forces%joints), j)) = forces%w%v(1:n, forces%drives(j))
      end do
      ! what a link takes from a pin does not depend on which link of the pin others hang on
      do j = 1, size(forces%shared, 2)
         associate (on => column_of_joint(forces%shared(1, j)))
            value(:, on:on + 1) = value(:, on:on + 1) - joint_rows(problem, forces, forces%shared(2, j), n)
         end associate
      end do
   end subroutine take_columns
end module psalm_force_analysis
