!> Forces in a moving mechanism: drive, joints and frame, from the motion and what acts on its bodies.
!>
!> After `solve_block` and `differentiate` of a block of positions, sources - inertia, weight, loads, springs, friction - add their
!> wrenches to the bodies; `sweep` then goes through the groups against the order in which motion was found. Each dyad
!> passes the wrenches of its two bodies on to the bodies that carry it; what is left on the input link is held by the drive and
!> the input's joint. One 2 by 2 system a dyad, the same as for the rates. With friction, which depends on the forces,
!> the sweep is repeated until they do not change. Source: Oldham (1977), 15.1; derivation in `doc/theory/forces.md`.
module psalm_kinetostatics
   use psalm_angles, only: angles_between, nearest_difference
   use psalm_assur, only: react_dyad, rows_to_react
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t
   use psalm_force_kernels, only: load_body, move_axes, add_inertia, add_weight, add_force_at, add_couple, place_in_body, &
                                  velocity_in_body, power_of, add_wrench, drive_of_crank, drive_of_slide
   use psalm_force_model, only: force_model_t, friction_t, parameter_mass, parameter_mx, parameter_my, parameter_inertia
   use psalm_group_reactions, only: group_joint_t, group_couple_t, react_group
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_linkage, only: padded
   use psalm_locations, only: location_t
   use psalm_mechanism, only: mechanism_t, arc_actuator, at_finish, at_start, body_frame, joint_prismatic, joint_revolute
   use psalm_piecewise, only: interpolated
   use psalm_rates, only: rates_t
   use psalm_rows, only: rows_t, make_rows
   use psalm_wrench_kernels, only: opposite_force, opposite_across
   implicit none (type, external)
   private
   public :: forces_t, prepare_forces, load_bodies, move_bodies, clear_wrenches, add_source, sweep, rub, external_power, &
             find_location, grip_joint, friction_parts
   public :: couples_of_group, find_shoe
   public :: joint_rows, listed_rows, table_factors, sources_of, source_inertia, source_weight, first_load, first_spring

   integer, parameter :: source_inertia = 1, source_weight = 2 !! sources; loads and springs follow
   integer, parameter :: most_sweeps = 100           !! without convergence of friction by then it locks
   real(wp), parameter :: settled = 1.0e-13_wp       !! change of forces, of the largest, at which friction has converged
   real(wp), parameter :: rounding = 64.0_wp*epsilon(1.0_wp) !! part of the input's speed: a slower joint is at rest
   integer, parameter :: rows_of_wrench = 3          !! force x and y, moment
   integer, parameter :: rows_of_joint = 2           !! force x and y, or force across and couple

   !> Rows of a body in `forces_t`.
   type :: body_rows_t
      integer :: px = 0, py = 0, root_x = 0, root_y = 0 !! in the store: reference and root
      real(wp) :: c = 1.0_wp, s = 0.0_wp             !! from the root to the body's own arc
      integer :: wrench = 0                          !! first of its rows below
      integer :: ex = 0, ey = 0, vx = 0, vy = 0, ax = 0, ay = 0, w = 0, al = 0
   end type body_rows_t

   !> Room for one block of positions.
   type :: forces_t
      real(wp) :: metre = 1.0_wp                     !! metres in a store unit
      real(wp) :: unit = 1.0_wp                      !! store units in the user's unit of length
      real(wp) :: speed = 1.0_wp                     !! of the input: rad/s, or user's length/s
      type(body_rows_t), allocatable :: bodies(:)    !! the frame first
      integer, allocatable :: joints(:)              !! by joint: first of its rows
      integer, allocatable :: couples(:)             !! by joint: row of the couple of wheels in mesh, N times a store unit
      integer, allocatable :: shared(:, :)           !! shape (2, pairs): joints on one pin; the later link of the first is the
                                                     !! earlier of the second
      type(rows_t) :: w                              !! (position, row)
      integer :: drive = 0                           !! row of the first drive: torque N m, or force N
      integer, allocatable :: drives(:)              !! by drive: its row
      integer, allocatable :: along(:)               !! by joint: the drive along it, 0: none
      real(wp), allocatable :: along_sense(:)        !! by joint: -1 where that drive pushes against the joint's arc
      integer :: kinetic = 0, growth = 0             !! rows: kinetic energy J, power it takes up W
      integer :: power = 0                           !! row: power of weight, loads and springs, W
      integer :: scratch = 0                         !! first row of those that `react_dyad` needs
      integer :: loss = 0                            !! row: power lost in friction, W
      type(rows_t) :: given                          !! wrenches without friction
      integer, allocatable :: sweeps(:)              !! by position: sweeps that friction took; 0: it has not converged
      logical, allocatable :: at_rest(:)             !! by position: a joint with friction does not move
   end type forces_t

contains

   !> Allocate for a problem whose plan has all vertices (`vertices_of`), bound to its dimensions.
   subroutine prepare_forces(problem, model, forces)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(out) :: forces
      integer :: b, next, n, j

      associate (link => problem%linkage, mechanism => problem%mechanism)
         forces%unit = link%scale
         forces%metre = model%metre/link%scale
         allocate (forces%bodies(size(mechanism%bodies)), forces%joints(size(mechanism%joints)), &
                   forces%couples(size(mechanism%joints)))
         next = 1
         do b = 1, size(forces%bodies)
            associate (body => forces%bodies(b))
               body%px = link%point_x(problem%plan%joint_points(model%reference(b)))
               body%py = link%point_y(problem%plan%joint_points(model%reference(b)))
               body%wrench = next
               body%ex = next + rows_of_wrench
               body%ey = body%ex + 1
               body%vx = body%ey + 1
               body%vy = body%vx + 1
               body%ax = body%vy + 1
               body%ay = body%ax + 1
               body%w = body%ay + 1
               body%al = body%w + 1
               next = body%al + 1
               n = mechanism%bodies(b)%axis
               if (n == 0) cycle
               body%root_x = link%root_x(problem%plan%root(n))
               body%root_y = link%root_y(problem%plan%root(n))
               body%c = link%x(n)
               body%s = link%y(n)
            end associate
         end do
         do j = 1, size(forces%joints)
            forces%joints(j) = next
            forces%couples(j) = next + rows_of_joint
            next = next + rows_of_joint + 1
         end do
         forces%drives = [(next + j, j=0, size(mechanism%actuators) - 1)]
         forces%drive = next
         next = next + size(forces%drives)
         forces%kinetic = next
         forces%growth = next + 1
         forces%power = next + 2
         forces%loss = next + 3
         forces%scratch = next + 4
         call make_rows(link%capacity, forces%scratch + rows_to_react - 1, forces%w)
         call make_rows(link%capacity, rows_of_wrench*size(forces%bodies), forces%given)
         allocate (forces%sweeps(link%capacity), source=1)
         allocate (forces%at_rest(link%capacity), source=.false.)
         forces%w%v(:, forces%bodies(body_frame)%ex) = 1.0_wp
      end associate
      forces%shared = shared_pins(problem%mechanism)
      call find_drives_along(problem%mechanism, forces)
   end subroutine prepare_forces

   !> Joints along which a drive pushes.
   pure subroutine find_drives_along(mechanism, forces)
      type(mechanism_t), intent(in) :: mechanism
      type(forces_t), intent(inout) :: forces
      integer :: j

      allocate (forces%along(size(mechanism%joints)), source=0)
      allocate (forces%along_sense(size(mechanism%joints)), source=1.0_wp)
      do j = 1, size(mechanism%joints)
         associate (joint => mechanism%joints(j))
            if (joint%kind /= joint_prismatic) cycle
            associate (n => mechanism%arcs(joint%slide)%representative)
               if (mechanism%arcs(n)%kind /= arc_actuator) cycle
               forces%along(j) = mechanism%arcs(n)%drive
               ! the input is the arc's length, which leads to the body at its finish
               if (mechanism%body_at(n, at_finish) /= joint%bodies(2)) forces%along_sense(j) = -1.0_wp
            end associate
         end associate
      end do
   end subroutine find_drives_along

   !> Pairs of revolute joints on one pin, the later link of the first of which is the earlier of the second. Shape (2, pairs).
   pure function shared_pins(mechanism) result(pairs)
      type(mechanism_t), intent(in) :: mechanism
      integer, allocatable :: pairs(:, :)
      integer :: list(2, size(mechanism%joints))   ! each joint has one earlier link
      integer :: j, k, n

      n = 0
      associate (joints => mechanism%joints)
         do k = 1, size(joints)
            if (joints(k)%kind /= joint_revolute) cycle
            do j = 1, size(joints)
               if (j == k .or. joints(j)%kind /= joint_revolute .or. joints(j)%pin /= joints(k)%pin) cycle
               if (joints(j)%bodies(2) /= joints(k)%bodies(1)) cycle
               n = n + 1
               list(:, n) = [j, k]
               exit
            end do
         end do
      end associate
      pairs = list(:, :n)
   end function shared_pins

   !> Pose, speed and acceleration of every body at the first `n` positions of the block just solved and differentiated twice.
   subroutine move_bodies(problem, rates, n, speed, accel, forces)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: n
      real(wp), intent(in) :: speed, accel           !! of the input
      type(forces_t), intent(inout) :: forces
      integer :: b, m

      m = padded(n)
      forces%speed = speed
      do b = body_frame + 1, size(forces%bodies)
         associate (body => forces%bodies(b), w => forces%w%v, v => problem%linkage%store%v, d1 => rates%d(1)%v, &
                    d2 => rates%d(2)%v)
            call move_axes(m, v(1, body%root_x), v(1, body%root_y), body%c, body%s, d1(1, body%root_x), d2(1, body%root_x), &
                           d1(1, body%px), d1(1, body%py), d2(1, body%px), d2(1, body%py), speed, accel, w(1, body%ex), &
                           w(1, body%ey), w(1, body%vx), w(1, body%vy), w(1, body%ax), w(1, body%ay), w(1, body%w), w(1, body%al))
         end associate
      end do
   end subroutine move_bodies

   !> Wrenches of inertia and weight alone, energy and powers: all in one pass over the bodies, for mechanisms without loads,
   !> springs and friction. Of the poses of the bodies only the direction of a sliding input is kept, which the drive acts along.
   subroutine load_bodies(problem, model, rates, n, speed, accel, forces)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: n
      real(wp), intent(in) :: speed, accel           !! of the input
      type(forces_t), intent(inout) :: forces
      integer :: b, m

      m = padded(n)
      forces%speed = speed
      associate (frame => forces%bodies(body_frame)%wrench)
         forces%w%v(1:m, frame:frame + rows_of_wrench - 1) = 0.0_wp
      end associate
      forces%w%v(1:m, forces%kinetic) = 0.0_wp
      forces%w%v(1:m, forces%growth) = 0.0_wp
      forces%w%v(1:m, forces%power) = 0.0_wp
      forces%w%v(1:m, forces%loss) = 0.0_wp
      do b = body_frame + 1, size(forces%bodies)
         associate (body => forces%bodies(b), w => forces%w%v, v => problem%linkage%store%v, d1 => rates%d(1)%v, &
                    d2 => rates%d(2)%v, of => model%inertia(:, b))
            call load_body(m, forces%metre, of(parameter_mass), of(parameter_mx), of(parameter_my), of(parameter_inertia), &
                           model%gravity(1), model%gravity(2), v(1, body%root_x), v(1, body%root_y), body%c, body%s, &
                           d1(1, body%root_x), d2(1, body%root_x), v(1, body%px), v(1, body%py), d1(1, body%px), d1(1, body%py), &
                           d2(1, body%px), d2(1, body%py), speed, accel, w(1, body%wrench), w(1, body%wrench + 1), &
                           w(1, body%wrench + 2), w(1, forces%kinetic), w(1, forces%growth), w(1, forces%power))
         end associate
      end do
      do b = 1, size(problem%mechanism%actuators)
         associate (actuator => problem%mechanism%actuators(b))
            if (.not. actuator%slides .or. actuator%joint == 0) cycle
            associate (input => forces%bodies(problem%mechanism%arcs(actuator%arc)%body), w => forces%w%v, &
                       v => problem%linkage%store%v)
               w(1:m, input%ex) = input%c*v(1:m, input%root_x) - input%s*v(1:m, input%root_y)
               w(1:m, input%ey) = input%c*v(1:m, input%root_y) + input%s*v(1:m, input%root_x)
            end associate
         end associate
      end do
   end subroutine load_bodies

   !> No wrench on any body.
   pure subroutine clear_wrenches(n, forces)
      integer, intent(in) :: n
      type(forces_t), intent(inout) :: forces
      integer :: b, m

      m = padded(n)
      do b = 1, size(forces%bodies)
         associate (first => forces%bodies(b)%wrench)
            forces%w%v(1:m, first:first + rows_of_wrench - 1) = 0.0_wp
         end associate
      end do
      forces%w%v(1:m, forces%kinetic) = 0.0_wp
      forces%w%v(1:m, forces%growth) = 0.0_wp
      forces%w%v(1:m, forces%power) = 0.0_wp
      forces%w%v(1:m, forces%loss) = 0.0_wp
   end subroutine clear_wrenches

   ! ---- sources -----------------------------------------------------------------------------------------------------

   !> Number of sources: inertia, weight, then loads, then springs.
   pure integer function sources_of(model)
      type(force_model_t), intent(in) :: model

      sources_of = source_weight + size(model%loads) + size(model%springs)
   end function sources_of

   !> The source that is the first load.
   pure integer function first_load()
      first_load = source_weight + 1
   end function first_load

   !> The source that is the first spring.
   pure integer function first_spring(model)
      type(force_model_t), intent(in) :: model

      first_spring = source_weight + size(model%loads) + 1
   end function first_spring

   !> Add the wrenches of one source.
   subroutine add_source(problem, model, source, input, n, forces)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: source                  !! 1 to `sources_of`
      real(wp), intent(in) :: input(:)               !! shape (n): degrees or user's length
      integer, intent(in) :: n
      type(forces_t), intent(inout) :: forces
      integer :: m

      m = padded(n)
      if (source == source_inertia) then
         call add_all_inertia(problem, model, m, forces)
      else if (source == source_weight) then
         call add_all_weights(problem, model, m, forces)
      else if (source < first_spring(model)) then
         call add_load(problem, model, source - source_weight, input, n, forces)
      else
         call add_spring(problem, model, source - first_spring(model) + 1, m, forces)
      end if
   end subroutine add_source

   subroutine add_all_inertia(problem, model, m, forces)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: m
      type(forces_t), intent(inout) :: forces
      integer :: b

      do b = body_frame + 1, size(forces%bodies)
         associate (body => forces%bodies(b), w => forces%w%v, v => problem%linkage%store%v, of => model%inertia(:, b))
            if (all(abs(of) <= 0.0_wp)) cycle
            call add_inertia(m, forces%metre, of(parameter_mass), of(parameter_mx), of(parameter_my), of(parameter_inertia), &
                             v(1, body%px), v(1, body%py), w(1, body%vx), w(1, body%vy), w(1, body%ax), w(1, body%ay), &
                             w(1, body%ex), w(1, body%ey), w(1, body%w), w(1, body%al), w(1, body%wrench), w(1, body%wrench + 1), &
                             w(1, body%wrench + 2), w(1, forces%kinetic), w(1, forces%growth))
         end associate
      end do
   end subroutine add_all_inertia

   subroutine add_all_weights(problem, model, m, forces)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: m
      type(forces_t), intent(inout) :: forces
      integer :: b

      if (all(abs(model%gravity) <= 0.0_wp)) return
      do b = body_frame + 1, size(forces%bodies)
         associate (body => forces%bodies(b), w => forces%w%v, v => problem%linkage%store%v, of => model%inertia(:, b))
            call add_weight(m, forces%metre, of(parameter_mass), of(parameter_mx), of(parameter_my), model%gravity(1), &
                            model%gravity(2), v(1, body%px), v(1, body%py), w(1, body%ex), w(1, body%ey), w(1, body%wrench), &
                            w(1, body%wrench + 1), w(1, body%wrench + 2))
         end associate
      end do
   end subroutine add_all_weights

   !> Position of a place on a body.
   subroutine find_location(problem, forces, location, m, zx, zy)
      type(problem_t), intent(in) :: problem
      type(forces_t), intent(in) :: forces
      type(location_t), intent(in) :: location
      integer, intent(in) :: m
      real(wp), intent(out) :: zx(m), zy(m)

      associate (body => forces%bodies(location%body), w => forces%w%v, v => problem%linkage%store%v)
         call place_in_body(m, location%at*forces%unit, v(1, body%px), v(1, body%py), w(1, body%ex), w(1, body%ey), zx, zy)
      end associate
   end subroutine find_location

   subroutine add_load(problem, model, which, input, n, forces)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: which, n
      real(wp), intent(in) :: input(:)
      type(forces_t), intent(inout) :: forces
      real(wp), dimension(padded(n)) :: zx, zy, rx, ry, factor
      integer :: m

      m = padded(n)
      associate (load => model%loads(which), body => forces%bodies(model%loads(which)%location%body), w => forces%w%v)
         factor = 1.0_wp
         if (load%table > 0) then
            factor(:n) = table_factors(model, load%table, input, .not. problem%mechanism%sliding_input)
            factor(n + 1:) = factor(n)
         end if
         call find_location(problem, forces, load%location, m, zx, zy)
         if (load%turns) then
            rx = factor*(load%force(1)*w(1:m, body%ex) - load%force(2)*w(1:m, body%ey))
            ry = factor*(load%force(1)*w(1:m, body%ey) + load%force(2)*w(1:m, body%ex))
         else
            rx = factor*load%force(1)
            ry = factor*load%force(2)
         end if
         call add_force_at(m, 1.0_wp, zx, zy, rx, ry, w(1, body%wrench), w(1, body%wrench + 1), w(1, body%wrench + 2))
         call add_couple(m, load%moment/forces%metre, factor, w(1, body%wrench + 2))
      end associate
   end subroutine add_load

   !> What a table multiplies loads by, at the inputs or, of a table over the time, at the time of the model.
   pure function table_factors(model, table, input, turning) result(factors)
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: table
      real(wp), intent(in) :: input(:)
      logical, intent(in) :: turning                 !! inputs are degrees of a turn
      real(wp) :: factors(size(input))

      if (model%timed) then
         factors = interpolated(model%table_input, model%table_factor(:, table), spread(model%time, 1, size(input)), .false.)
      else
         factors = interpolated(model%table_input, model%table_factor(:, table), input, turning)
      end if
   end function table_factors

   subroutine add_spring(problem, model, which, m, forces)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: which, m
      type(forces_t), intent(inout) :: forces
      real(wp), dimension(m) :: ax, ay, bx, by, cx, cy, dx, dy, pull
      real(wp) :: length, gap(2), speed
      integer :: i

      associate (spring => model%springs(which), w => forces%w%v, v => problem%linkage%store%v, &
                 a => forces%bodies(model%springs(which)%ends(1)%body), b => forces%bodies(model%springs(which)%ends(2)%body))
         if (spring%torsional) then
            call turn(a, spring%ends(1)%along, ax, ay)
            call turn(b, spring%ends(2)%along, bx, by)
            call angles_between(m, ax, ay, 1.0_wp, 0.0_wp, bx, by, pull)
            pull = spring%pull(radians_per_degree*nearest_difference(pull, spring%free), w(1:m, b%w) - w(1:m, a%w), 1.0_wp)/ &
                   forces%metre
            call add_couple(m, 1.0_wp, pull, w(1, a%wrench + 2))
            call add_couple(m, -1.0_wp, pull, w(1, b%wrench + 2))
            return
         end if
         call find_location(problem, forces, spring%ends(1), m, ax, ay)
         call find_location(problem, forces, spring%ends(2), m, bx, by)
         call velocity_in_body(m, ax, ay, v(1, a%px), v(1, a%py), w(1, a%vx), w(1, a%vy), w(1, a%w), cx, cy)
         call velocity_in_body(m, bx, by, v(1, b%px), v(1, b%py), w(1, b%vx), w(1, b%vy), w(1, b%w), dx, dy)
         do i = 1, m
            gap = [bx(i) - ax(i), by(i) - ay(i)]
            length = hypotenuse(gap(1), gap(2))
            ! a spring of no length has no direction; one of no free length has no force there
            gap = gap/max(length, tiny(1.0_wp))
            speed = forces%metre*(gap(1)*(dx(i) - cx(i)) + gap(2)*(dy(i) - cy(i)))
            pull(i) = spring%pull(length*forces%metre - spring%free*model%metre, speed, model%metre)
            cx(i) = pull(i)*gap(1)
            cy(i) = pull(i)*gap(2)
         end do
         call add_force_at(m, 1.0_wp, ax, ay, cx, cy, w(1, a%wrench), w(1, a%wrench + 1), w(1, a%wrench + 2))
         call add_force_at(m, -1.0_wp, bx, by, cx, cy, w(1, b%wrench), w(1, b%wrench + 1), w(1, b%wrench + 2))
      end associate

   contains

      !> Direction of the arc by which a place was named.
      subroutine turn(body, along, x, y)
         type(body_rows_t), intent(in) :: body
         real(wp), intent(in) :: along(2)
         real(wp), intent(out) :: x(m), y(m)

         x = along(1)*forces%w%v(1:m, body%ex) - along(2)*forces%w%v(1:m, body%ey)
         y = along(1)*forces%w%v(1:m, body%ey) + along(2)*forces%w%v(1:m, body%ex)
      end subroutine turn
   end subroutine add_spring

   !> Power of the wrenches that are on the bodies now, into the row `power`.
   subroutine external_power(problem, n, forces)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: n
      type(forces_t), intent(inout) :: forces
      integer :: b

      do b = body_frame + 1, size(forces%bodies)
         associate (body => forces%bodies(b), w => forces%w%v, v => problem%linkage%store%v)
            call power_of(padded(n), forces%metre, v(1, body%px), v(1, body%py), w(1, body%vx), w(1, body%vy), w(1, body%w), &
                          w(1, body%wrench), w(1, body%wrench + 1), w(1, body%wrench + 2), w(1, forces%power))
         end associate
      end do
   end subroutine external_power

   ! ---- solution ----------------------------------------------------------------------------------------------------

   !> Forces of all joints, of the drive, and on the frame, from the wrenches on the bodies, which are used up: that of the frame
   !> becomes all that the mechanism does to the frame, the drive's reaction included.
   subroutine sweep(problem, n, forces)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: n
      type(forces_t), intent(inout) :: forces
      integer :: loop, m, p, q, b, d

      m = padded(n)
      associate (mechanism => problem%mechanism, link => problem%linkage, w => forces%w%v, f => forces%bodies)
         ! what acts on all bodies together: forces between them cancel, however large they are beside a dead point
         do b = body_frame + 1, size(f)
            call add_wrench(m, w(1, f(b)%wrench), w(1, f(b)%wrench + 1), w(1, f(b)%wrench + 2), w(1, f(body_frame)%wrench), &
                            w(1, f(body_frame)%wrench + 1), w(1, f(body_frame)%wrench + 2))
         end do
         do loop = mechanism%nloop, 1, -1
            if (.not. mechanism%is_dyad(loop)) then
               call sweep_group(problem, loop, m, forces)
               cycle
            end if
            p = f(mechanism%arcs(mechanism%groups(loop)%members(1))%body)%wrench
            q = f(mechanism%arcs(mechanism%groups(loop)%members(2))%body)%wrench
            associate (joints => mechanism%groups(loop)%joints)
               call react_dyad(m, link%steps(link%step_of_loop(loop))%dyad, link%store, p, q, forces%joints(joints(1)), &
                               forces%joints(joints(2)), forces%joints(joints(3)), forces%scratch, forces%w)
               call pass_on(p, mechanism%joints(joints(1))%bodies(1))
               call pass_on(q, mechanism%joints(joints(3))%bodies(1))
            end associate
         end do
         do d = 1, size(mechanism%actuators)
            if (mechanism%actuators(d)%joint == 0) cycle
            associate (input => f(mechanism%arcs(mechanism%actuators(d)%arc)%body), drive => forces%drives(d), &
                       row => forces%joints(mechanism%actuators(d)%joint), &
                       point => problem%plan%joint_points(mechanism%joints(mechanism%actuators(d)%joint)%point))
               if (mechanism%joints(mechanism%actuators(d)%joint)%kind == joint_prismatic) then
                  call drive_of_slide(m, w(1, input%ex), w(1, input%ey), w(1, input%wrench), w(1, input%wrench + 1), w(1, drive))
                  ! its arc leads back to the frame
                  if (mechanism%arcs(mechanism%actuators(d)%arc)%foot == at_finish) w(1:m, drive) = -w(1:m, drive)
                  call opposite_across(m, link%store%v(1, link%point_x(point)), link%store%v(1, link%point_y(point)), &
                                       w(1, input%ex), w(1, input%ey), w(1, input%wrench), w(1, input%wrench + 1), &
                                       w(1, input%wrench + 2), w(1, row), w(1, row + 1))
               else
                  ! the pivot of the first is the origin of the store
                  w(1:m, input%wrench + 2) = w(1:m, input%wrench + 2) - &
                                             (link%store%v(1:m, link%point_x(point))*w(1:m, input%wrench + 1) - &
                                              link%store%v(1:m, link%point_y(point))*w(1:m, input%wrench))
                  call drive_of_crank(m, forces%metre, w(1, input%wrench + 2), w(1, drive))
                  call opposite_force(m, w(1, input%wrench), w(1, input%wrench + 1), w(1, row), w(1, row + 1))
               end if
            end associate
         end do
      end associate

   contains

      subroutine pass_on(from, body)
         integer, intent(in) :: from, body

         if (body == body_frame) return
         associate (w => forces%w%v, to => forces%bodies(body)%wrench)
            call add_wrench(m, w(1, from), w(1, from + 1), w(1, from + 2), w(1, to), w(1, to + 1), w(1, to + 2))
         end associate
      end subroutine pass_on
   end subroutine sweep

   !> Forces of the joints of a larger group, which pass on what acts on its links.
   subroutine sweep_group(problem, loop, n, forces)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: loop, n
      type(forces_t), intent(inout) :: forces
      type(group_joint_t), allocatable :: joints(:)
      type(group_couple_t), allocatable :: couples(:)
      integer, allocatable :: links(:)
      integer :: j, k, d

      associate (mechanism => problem%mechanism, link => problem%linkage, group => problem%mechanism%groups(loop))
         ! in a ring of slides a link has two unknown arcs
         allocate (links(0))
         do j = 1, size(group%members)
            associate (body => mechanism%arcs(group%members(j))%body)
               if (all(links /= body)) links = [links, body]
            end associate
         end do
         do d = 1, size(mechanism%actuators)
            ! what a drive moves along a link has no unknown
            associate (actuator => mechanism%actuators(d))
               if (actuator%joint > 0 .or. actuator%arc == 0) cycle
               if (mechanism%arcs(actuator%arc)%loop /= loop) cycle
               if (mechanism%is_cylinder(actuator%arc)) then
                  call take_rod(actuator%arc, forces%drives(d))
               else
                  links = [links, mechanism%arcs(actuator%arc)%body]
               end if
            end associate
         end do
         allocate (joints(size(group%joints)))
         do j = 1, size(joints)
            associate (own => joints(j), joint => mechanism%joints(group%joints(j)))
               own%slides = joint%kind == joint_prismatic
               own%x = link%point_x(problem%plan%joint_points(joint%point))
               own%y = link%point_y(problem%plan%joint_points(joint%point))
               own%force = forces%joints(group%joints(j))
               do k = 1, 2
                  own%links(k) = findloc(links, barrel_of(joint%bodies(k)), dim=1)
                  if (own%links(k) == 0 .and. joint%bodies(k) /= body_frame) own%wrenches(k) = forces%bodies(joint%bodies(k))%wrench
               end do
               if (.not. own%slides) cycle
               own%root_x = link%root_x(problem%plan%root(joint%slide))
               own%root_y = link%root_y(problem%plan%root(joint%slide))
               own%c = link%x(joint%slide)
               own%s = link%y(joint%slide)
               d = forces%along(group%joints(j))
               if (d > 0) own%drive = forces%drives(d)
               own%sense = forces%along_sense(group%joints(j))
            end associate
         end do
         call couples_of_group(problem, forces, loop, couples)
         do j = 1, size(couples)
            do k = 1, size(couples(j)%bodies)
               if (couples(j)%bodies(k) == 0) cycle
               couples(j)%links(k) = findloc(links, couples(j)%bodies(k), dim=1)
               if (couples(j)%links(k) == 0) couples(j)%wrenches(k) = forces%bodies(couples(j)%bodies(k))%wrench
            end do
         end do
         call react_group(n, joints, couples, forces%bodies(links)%wrench, link%store, forces%w)
         do j = 1, size(couples)
            if (couples(j)%drive > 0) forces%w%v(1:n, couples(j)%drive) = forces%w%v(1:n, couples(j)%drive)*forces%metre
         end do
         call take_pushes()
      end associate

   contains

      !> The body of a cylinder that stands in the equilibrium for its rod too.
      pure integer function barrel_of(body)
         integer, intent(in) :: body

         barrel_of = body
         associate (of => problem%mechanism%bodies(body))
            if (of%is_rod) barrel_of = problem%mechanism%arcs(of%axis)%body
         end associate
      end function barrel_of

      !> Along a cylinder its drive holds what acts on the rod; for the equilibrium of the group barrel and rod are one.
      subroutine take_rod(arc, drive)
         integer, intent(in) :: arc, drive         !! the drive's row

         associate (w => forces%w%v, rod => forces%bodies(problem%mechanism%arcs(arc)%rod), &
                    barrel => forces%bodies(problem%mechanism%arcs(arc)%body)%wrench)
            w(1:n, drive) = 0.0_wp
            call push(arc, drive, w(1:n, rod%wrench:rod%wrench + 1))
            w(1:n, barrel:barrel + 2) = w(1:n, barrel:barrel + 2) + w(1:n, rod%wrench:rod%wrench + 2)
         end associate
      end subroutine take_rod

      !> A force on the rod of a cylinder, which its drive bears.
      subroutine push(arc, drive, force)
         integer, intent(in) :: arc, drive
         real(wp), intent(in) :: force(:, :)       !! shape (n, 2)
         real(wp) :: sense

         associate (v => problem%linkage%store%v, w => forces%w%v, rod => forces%bodies(problem%mechanism%arcs(arc)%rod))
            sense = merge(1.0_wp, -1.0_wp, problem%mechanism%arcs(arc)%foot == at_finish)
            w(1:n, drive) = w(1:n, drive) - sense*(force(:, 1)*v(1:n, rod%root_x) + force(:, 2)*v(1:n, rod%root_y))
         end associate
      end subroutine push

      !> What the joints of the group do to rods.
      subroutine take_pushes()
         integer :: side, arc

         do j = 1, size(joints)
            associate (joint => problem%mechanism%joints(problem%mechanism%groups(loop)%joints(j)), row => joints(j)%force)
               do side = 1, 2
                  associate (of => problem%mechanism%bodies(joint%bodies(side)))
                     if (.not. of%is_rod .or. joints(j)%links(side) == 0) cycle
                     arc = of%axis
                     call push(arc, forces%drives(problem%mechanism%arcs(arc)%drive), &
                               merge(1.0_wp, -1.0_wp, side == 2)*forces%w%v(1:n, row:row + 1))
                  end associate
               end do
            end associate
         end do
      end subroutine take_pushes
   end subroutine sweep_group

   !> Drives between links of a group, and its wheels in mesh, without their links in it.
   subroutine couples_of_group(problem, forces, loop, couples)
      type(problem_t), intent(in) :: problem
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: loop
      type(group_couple_t), allocatable, intent(out) :: couples(:)
      integer :: t, c, k

      if (.not. allocated(problem%mechanism%groups(loop)%ties)) then
         allocate (couples(0))
         return
      end if
      associate (ties => problem%mechanism%groups(loop)%ties, link => problem%linkage)
         allocate (couples(count(.not. ties%of_slides)))
         c = 0
         do t = 1, size(ties)
            if (ties(t)%of_slides) cycle
            c = c + 1
            associate (own => couples(c), tie => ties(t))
               own%factors = tie%factors
               if (tie%drive > 0) own%drive = forces%drives(tie%drive)
               do k = 1, size(tie%axes)
                  if (tie%axes(k) > 0) own%bodies(k) = problem%mechanism%arcs(tie%axes(k))%body
               end do
               if (tie%joint == 0) cycle
               own%force = forces%joints(tie%joint)
               own%couple = forces%couples(tie%joint)
               own%ratio = tie%factors(1)
               if (any(tie%centre == 0)) cycle
               do k = 1, 2
                  associate (point => problem%plan%joint_points(problem%mechanism%arcs(tie%centre(k))%ends(tie%centre_end(k))))
                     own%centres(2*k - 1:2*k) = [link%point_x(point), link%point_y(point)]
                  end associate
               end do
            end associate
         end do
      end associate
   end subroutine couples_of_group

   !> Forces of a joint in the units of listings: N, and N m for the couple of a prismatic joint. Shape of the result: (n, 2).
   pure function joint_rows(problem, forces, joint, n) result(values)
      type(problem_t), intent(in) :: problem
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: joint, n
      real(wp) :: values(n, rows_of_joint)

      values = forces%w%v(1:n, forces%joints(joint):forces%joints(joint) + 1)
      if (problem%mechanism%joints(joint)%kind == joint_prismatic) values(:, 2) = values(:, 2)*forces%metre
   end function joint_rows

   !> The same as listings print them: of a sketch by the order of its links, of a slide about the middle of its shoe.
   function listed_rows(problem, model, forces, joint, n) result(values)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: joint, n
      real(wp) :: values(n, rows_of_joint)
      real(wp), dimension(n) :: x, y, reach, aside

      values = joint_rows(problem, forces, joint, n)
      associate (shoe => model%shoes(joint))
         if (shoe%given) then
            call find_shoe(problem, model, forces, joint, n, x, y, reach, aside)
            values(:, 2) = values(:, 2) - values(:, 1)*reach*forces%metre
            if (forces%along(joint) > 0) values(:, 2) = values(:, 2) - &
                                                        forces%w%v(1:n, forces%drives(forces%along(joint)))*aside*forces%metre
         end if
         ! the force across turns with the line, the couple does not
         if (shoe%order*shoe%sense < 0.0_wp) values(:, 1) = -values(:, 1)
         if (shoe%order < 0.0_wp) values(:, 2) = -values(:, 2)
      end associate
   end function listed_rows

   !> The middle of the shoe of a prismatic joint, and how far along the joint's arc it is from the foot; of a driven slide the
   !> drive has a lever `aside` too, for it pushes along the arc's line. Store units.
   subroutine find_shoe(problem, model, forces, joint, n, x, y, reach, aside)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: joint, n
      real(wp), intent(out) :: x(n), y(n), reach(n), aside(n)
      real(wp), dimension(n) :: ex, ey
      real(wp) :: at(2)
      integer :: foot

      associate (location => model%shoes(joint)%location, link => problem%linkage, v => problem%linkage%store%v, &
                 of => problem%mechanism%joints(joint), body => forces%bodies(model%shoes(joint)%location%body))
         ! not of `move_bodies`, which is left out for masses alone
         ex = 1.0_wp
         ey = 0.0_wp
         if (location%body /= body_frame) then
            ex = body%c*v(1:n, body%root_x) - body%s*v(1:n, body%root_y)
            ey = body%c*v(1:n, body%root_y) + body%s*v(1:n, body%root_x)
         end if
         at = location%at*forces%unit
         x = v(1:n, body%px) + (at(1)*ex - at(2)*ey)
         y = v(1:n, body%py) + (at(1)*ey + at(2)*ex)
         foot = problem%plan%joint_points(of%point)
         associate (root => problem%plan%root(of%slide))
            ex = link%x(of%slide)*v(1:n, link%root_x(root)) - link%y(of%slide)*v(1:n, link%root_y(root))
            ey = link%x(of%slide)*v(1:n, link%root_y(root)) + link%y(of%slide)*v(1:n, link%root_x(root))
         end associate
         reach = (x - v(1:n, link%point_x(foot)))*ex + (y - v(1:n, link%point_y(foot)))*ey
         aside = 0.0_wp
         if (forces%along(joint) > 0) aside = forces%along_sense(joint)* &
                                              ((x - v(1:n, link%point_x(foot)))*ey - (y - v(1:n, link%point_y(foot)))*ex)
      end associate
   end subroutine find_shoe

   !> Put a force along a slide, or a couple in a pin, on both bodies of a joint: of a slide at the middle of its shoe, which a
   !> sketch has, or at its foot.
   subroutine grip_joint(problem, model, joint, bodies, m, value, forces)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: joint, bodies(2)        !! the force acts on the second body, its opposite on the first
      integer, intent(in) :: m                       !! positions, padded
      real(wp), intent(in) :: value(m)               !! N along the slide, or N m
      type(forces_t), intent(inout) :: forces
      real(wp), dimension(m) :: rx, ry, x, y, reach, aside
      integer :: slide, root

      associate (of => problem%mechanism%joints(joint), w => forces%w%v, store => problem%linkage%store%v, &
                 link => problem%linkage, a => forces%bodies(bodies(1))%wrench, &
                 b => forces%bodies(bodies(2))%wrench)
         if (of%kind /= joint_prismatic) then
            call add_couple(m, 1.0_wp/forces%metre, value, w(1, b + 2))
            call add_couple(m, -1.0_wp/forces%metre, value, w(1, a + 2))
            return
         end if
         slide = of%slide
         root = problem%plan%root(slide)
         rx = value*(link%x(slide)*store(1:m, link%root_x(root)) - link%y(slide)*store(1:m, link%root_y(root)))
         ry = value*(link%x(slide)*store(1:m, link%root_y(root)) + link%y(slide)*store(1:m, link%root_x(root)))
         if (model%shoes(joint)%given) then
            call find_shoe(problem, model, forces, joint, m, x, y, reach, aside)
         else
            associate (foot => problem%plan%joint_points(of%point))
               x = store(1:m, link%point_x(foot))
               y = store(1:m, link%point_y(foot))
            end associate
         end if
         call add_force_at(m, 1.0_wp, x, y, rx, ry, w(1, b), w(1, b + 1), w(1, b + 2))
         call add_force_at(m, -1.0_wp, x, y, rx, ry, w(1, a), w(1, a + 1), w(1, a + 2))
      end associate
   end subroutine grip_joint

   !> What friction of an entry grows with, linear in the forces of a sweep: of a pin its force times its radius, N m, x and y; of a
   !> slide the force across, N, or, of a shoe with a length, those at its two ends.
   subroutine friction_parts(problem, model, entry, forces, parts)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: entry
      type(forces_t), intent(in) :: forces
      real(wp), intent(out) :: parts(2)
      real(wp) :: couple, radius
      real(wp), dimension(padded(1)) :: x, y, reach, aside
      integer :: j

      associate (of => model%friction(entry), w => forces%w%v, row => forces%joints(model%friction(entry)%joint), &
                 joints => problem%mechanism%joints)
         radius = of%radius*model%metre
         if (joints(of%joint)%kind == joint_prismatic) then
            parts = [w(1, row), 0.0_wp]
            if (.not. radius > 0.0_wp) return
            couple = w(1, row + 1)
            if (model%shoes(of%joint)%given) then
               call find_shoe(problem, model, forces, of%joint, padded(1), x, y, reach, aside)
               couple = couple - w(1, row)*reach(1)
               if (forces%along(of%joint) > 0) couple = couple - w(1, forces%drives(forces%along(of%joint)))*aside(1)
            end if
            couple = couple*forces%metre/(2.0_wp*radius)
            parts = [0.5_wp*w(1, row) + couple, 0.5_wp*w(1, row) - couple]
         else if (of%all_of_pin) then
            parts = 0.0_wp
            do j = 1, size(joints)
               if (joints(j)%kind /= joint_revolute .or. joints(j)%pin /= joints(of%joint)%pin) cycle
               if (joints(j)%bodies(2) == of%bodies(2)) parts = parts + w(1, forces%joints(j):forces%joints(j) + 1)
               if (joints(j)%bodies(1) == of%bodies(2)) parts = parts - w(1, forces%joints(j):forces%joints(j) + 1)
            end do
            parts = radius*parts
         else
            parts = radius*w(1, row:row + 1)
         end if
      end associate
   end subroutine friction_parts

   !> Sweep with friction: forces of the joints make friction, which is a load in the next sweep.
   !>
   !> The wrenches are those of all other sources. A position that has settled is not touched again, so that its digits do not
   !> depend on those beside it. `sweeps` is 0 where friction does not settle: the mechanism locks itself.
   subroutine rub(problem, model, rates, n, forces, grips)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: n
      type(forces_t), intent(inout) :: forces
      real(wp), allocatable, intent(out), optional :: grips(:, :) !! (position, entry): friction force N or couple N m on the second
                                              !! body
      real(wp), allocatable :: grip(:, :)     !! (position, entry): friction force N or couple N m that acts now
      real(wp), allocatable :: fresh(:, :)    !! (position, entry)
      real(wp), allocatable :: slip(:, :)     !! (position, entry): speed of the second body in the first, m/s or rad/s
      real(wp), allocatable :: shoe(:, :, :)  !! (position, x y reach aside, entry): middle of a sketch's shoe
      real(wp), allocatable :: largest(:), change(:)
      logical, allocatable :: moves(:)
      real(wp) :: still_there
      integer :: m, k, i, round, b

      m = padded(n)
      allocate (grip(m, size(model%friction)), source=0.0_wp)
      allocate (fresh(m, size(model%friction)), slip(m, size(model%friction)))
      allocate (largest(m), change(m), moves(m))
      do k = 1, size(model%friction)
         call find_slip(model%friction(k), slip(:, k))
      end do
      allocate (shoe(m, 4, size(model%friction)), source=0.0_wp)
      do k = 1, size(model%friction)
         if (model%shoes(model%friction(k)%joint)%given) &
            call find_shoe(problem, model, forces, model%friction(k)%joint, m, shoe(:, 1, k), shoe(:, 2, k), shoe(:, 3, k), &
                           shoe(:, 4, k))
      end do
      ! what does not move is at rest but for rounding
      do k = 1, size(model%friction)
         if (problem%mechanism%joints(model%friction(k)%joint)%kind == joint_prismatic) then
            still_there = rounding*forces%metre*abs(forces%speed)* &
                          merge(forces%unit, maxval(problem%linkage%length), problem%mechanism%sliding_input)
         else
            still_there = rounding*abs(forces%speed)/ &
                          merge(maxval(problem%linkage%length)/forces%unit, 1.0_wp, problem%mechanism%sliding_input)
         end if
         where (abs(slip(:, k)) <= still_there) slip(:, k) = 0.0_wp
      end do
      forces%at_rest(1:m) = any(abs(slip) <= 0.0_wp, dim=2)
      forces%sweeps(1:m) = 0
      do b = 1, size(forces%bodies)
         associate (from => forces%bodies(b)%wrench, to => rows_of_wrench*(b - 1) + 1)
            forces%given%v(1:m, to:to + 2) = forces%w%v(1:m, from:from + 2)
         end associate
      end do
      do round = 1, most_sweeps
         do b = 1, size(forces%bodies)
            associate (to => forces%bodies(b)%wrench, from => rows_of_wrench*(b - 1) + 1)
               forces%w%v(1:m, to:to + 2) = forces%given%v(1:m, from:from + 2)
            end associate
         end do
         do k = 1, size(model%friction)
            call grip_joint(problem, model, model%friction(k)%joint, model%friction(k)%bodies, m, grip(:, k), forces)
         end do
         call sweep(problem, n, forces)
         do k = 1, size(model%friction)
            call friction_of(k, fresh(:, k))
         end do
         change = maxval(abs(fresh - grip), dim=2)
         largest = maxval(abs(fresh), dim=2)
         moves = forces%sweeps(1:m) == 0
         where (moves .and. change <= settled*largest) forces%sweeps(1:m) = round
         if (all(forces%sweeps(1:n) > 0)) exit
         do k = 1, size(model%friction)
            where (forces%sweeps(1:m) == 0) grip(:, k) = fresh(:, k)
         end do
      end do
      forces%w%v(1:m, forces%loss) = 0.0_wp
      do k = 1, size(model%friction)
         do i = 1, m
            forces%w%v(i, forces%loss) = forces%w%v(i, forces%loss) + abs(grip(i, k)*slip(i, k))
         end do
      end do
      if (present(grips)) call move_alloc(grip, grips)

   contains

      !> Speed of the second body of a joint in the first: of a pin the turn, of a prismatic joint along its arc.
      subroutine find_slip(friction, speed)
         type(friction_t), intent(in) :: friction
         real(wp), intent(out) :: speed(m)
         integer :: slot

         associate (of => problem%mechanism%joints(friction%joint), w => forces%w%v)
            if (of%kind == joint_prismatic) then
               slot = problem%plan%length_slot(of%slide)
               speed = rates%d(1)%v(1:m, problem%linkage%slide(slot))*forces%speed*forces%metre
               if (problem%mechanism%arcs(of%slide)%foot /= at_start) speed = -speed
               if (of%bodies(2) /= problem%mechanism%arcs(of%slide)%body) speed = -speed
            else
               speed = w(1:m, forces%bodies(friction%bodies(2))%w) - w(1:m, forces%bodies(friction%bodies(1))%w)
            end if
         end associate
      end subroutine find_slip

      !> Friction on the second body, from the forces of the joint: newtons along the slide, or newton metres.
      subroutine friction_of(entry, value)
         integer, intent(in) :: entry
         real(wp), intent(out) :: value(m)
         real(wp) :: load, couple, radius, pin(rows_of_joint)

         associate (of => model%friction(entry), w => forces%w%v, row => forces%joints(model%friction(entry)%joint))
            radius = of%radius*model%metre
            do i = 1, m
               if (problem%mechanism%joints(of%joint)%kind == joint_prismatic) then
                  load = abs(w(i, row))
                  if (radius > 0.0_wp) then
                     couple = w(i, row + 1) - w(i, row)*shoe(i, 3, entry)
                     if (forces%along(of%joint) > 0) couple = couple - w(i, forces%drives(forces%along(of%joint)))*shoe(i, 4, entry)
                     couple = couple*forces%metre/(2.0_wp*radius)
                     load = abs(0.5_wp*w(i, row) + couple) + abs(0.5_wp*w(i, row) - couple)
                  end if
               else
                  pin = w(i, row:row + 1)
                  if (of%all_of_pin) pin = force_of_pin(of, i)
                  load = radius*hypotenuse(pin(1), pin(2))
               end if
               value(i) = 0.0_wp
               if (abs(slip(i, entry)) > 0.0_wp) value(i) = -sign(of%coefficient*load + of%grip, slip(i, entry))
            end do
         end associate
      end subroutine friction_of

      !> What the second body takes from its pin at a position, from all joints there.
      pure function force_of_pin(of, position) result(force)
         type(friction_t), intent(in) :: of
         integer, intent(in) :: position
         real(wp) :: force(rows_of_joint)
         integer :: j

         force = 0.0_wp
         associate (joints => problem%mechanism%joints)
            do j = 1, size(joints)
               if (joints(j)%kind /= joint_revolute .or. joints(j)%pin /= joints(of%joint)%pin) cycle
               associate (row => forces%joints(j))
                  if (joints(j)%bodies(2) == of%bodies(2)) force = force + forces%w%v(position, row:row + 1)
                  if (joints(j)%bodies(1) == of%bodies(2)) force = force - forces%w%v(position, row:row + 1)
               end associate
            end do
         end associate
      end function force_of_pin

   end subroutine rub
end module psalm_kinetostatics
