!> Forces: tables of an independent method, Newton and Euler for every link, power, momentum, virtual work, friction, balance.
!>
!> Reference tables: two independent computations agree on them (dyad by dyad; maximal coordinates with multipliers, 70 digits).
module force_checks
   use cases, only: load_case
   use check, only: checks_t
   use psalm_cases, only: read_case_text
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t, make_problem
   use psalm_force_analysis, only: force_table_t, analyse_forces, loads_of_unit_masses, column_of_joint, column_drive, column_fx, &
                                   column_fy, column_moment
   use psalm_force_model, only: force_model_t, make_force_model, vertices_of, parameter_mass, parameter_mx, parameter_my, &
                                parameter_inertia
   use psalm_kinds, only: wp, pi
   use, intrinsic :: iso_fortran_env, only: real128
   use psalm_load_group, only: load_group_t
   use psalm_motor_group, only: motor_group_t, motor_of
   use psalm_machine, only: machine_t, cycle_t, machine_run_t, make_machine, steady_cycle, run_up, &
                            flywheel_for, cycle_found, cycle_any_speed, cycle_grows
   use psalm_mechanism, only: mechanism_t, at_start, body_frame, joint_prismatic
   use psalm_output_kind, only: motion_point
   use psalm_parameters, only: parameters_t
   use psalm_reduced, only: reduced_t, reduce_machine
   use psalm_rates, only: rates_t, prepare_rates, differentiate, output_rates, highest_order
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   real(wp), parameter :: speed_600 = 20.0_wp*pi       !! 600 rev/min
   private
   public :: reference_table, reference_joints, unit_columns, every_link_in_equilibrium, power_balance, virtual_work, &
             friction_reference, counterweights, motion_from_torque, near_a_dead_point, momentum_and_energy, scaling_of_speed, &
             shift_and_turn, order_of_loops, units_and_sizes, table_begun_elsewhere

   type(checks_t), public :: t

contains

   !> Masses by a rule: link number n, in the order input, p, q of each loop, has .1 n kg, its centre 10 n units at 10 n degrees
   !> from its own arc, from its own end, and n 1E-4 kg m2.
   subroutine rule_masses(problem, set)
      type(problem_t), intent(in) :: problem
      type(data_set_t), intent(inout) :: set
      integer :: n, k

      n = size(problem%mechanism%bodies) - 1
      deallocate (set%masses%places, set%masses%mass, set%masses%inertia)
      allocate (set%masses%places(n))
      set%masses%given = .true.
      set%masses%metre = 0.001_wp
      set%masses%mass = [(0.1_wp*real(k, wp), k=1, n)]
      set%masses%inertia = [(1.0e-4_wp*real(k, wp), k=1, n)]
      do k = 1, n
         associate (arc => problem%mechanism%arcs(problem%mechanism%bodies(k + 1)%axis), place => set%masses%places(k))
            place%arc = arc%place
            place%loop = arc%loop
            place%from_start = arc%foot /= at_start
            place%distance = 10.0_wp*real(k, wp)
            place%angle = 10.0_wp*real(k, wp)
         end associate
      end do
   end subroutine rule_masses

   !> Forces at increments of the input.
   subroutine forces_at(problem, set, delt, table, model)
      type(problem_t), intent(inout) :: problem
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: delt(:)
      type(force_table_t), intent(out) :: table
      type(force_model_t), intent(out) :: model
      type(diagnostics_t) :: findings
      type(motion_t) :: motion

      call make_force_model(set, problem%mechanism, problem%given, model, findings)
      call t%is_true(.not. findings%failed(), 'no fault is found with the groups of forces')
      call problem%set_inputs(delt)
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(problem%given, motion)
      call analyse_forces(problem, model, set%rates%speed, set%rates%accel, motion%closed, motion%input, table)
   end subroutine forces_at

   subroutine reference_table()
      call one('dyad1_crank_rocker', 60, [0.848637945_wp, 49.8138567_wp, 27.4658626_wp, -2.49489456_wp, 1.03159372_wp])
      call one('dyad2_oscillating_cylinder', 60, [0.0520217721_wp, 18.6332518_wp, 23.0139602_wp, -0.0353928779_wp, 0.565706977_wp])
      call one('dyad3_quick_return', 60, [0.266786916_wp, 38.9681087_wp, 68.4630574_wp, -1.20488476_wp, 4.01143609_wp])
      call one('dyad4_slider_crank', 60, [0.901570747_wp, 38.0378549_wp, 27.2661063_wp, 0.200199766_wp, 1.66656782_wp])
      call one('dyad5_turning_block', 60, [-0.984333524_wp, -53.9916571_wp, 15.3559693_wp, 1.79442992_wp, 2.50253176_wp])
      call one('dyad6_scotch_yoke', 60, [0.820543501_wp, 40.828659_wp, 31.0612078_wp, -0.1285698_wp, 1.5593975_wp])
      call one('dyad7_oldham_coupling', 60, [-0.0967751118_wp, -7.88467247_wp, -40.019256_wp, -0.171875691_wp, 1.83902627_wp])
      call one('dyad8_tangent_mechanism', 30, [40.4705191_wp, 12.6881188_wp, -294.832334_wp, -34.0647662_wp, 19.6691919_wp])
      call one('needle', 60, [-10.8235921_wp, -100.559514_wp, 167.806634_wp, 29.2962373_wp, 4.72413161_wp])
      call one('textile', 60, [0.968291647_wp, 78.0782652_wp, -0.45077263_wp, -0.486391388_wp, 2.16564244_wp])
      call one('dwell', 60, [-0.0681702661_wp, -10.4210334_wp, 8.05975366_wp, 0.00531702615_wp, 0.573741819_wp])
      call one('brake_reaction', 5, [-144.127591_wp, 2634.29374_wp, 306.675852_wp, 88.6406309_wp, 585.481889_wp])
      call one('actuator_rapson_slide', 100, [0.000130990287_wp, -0.000174628014_wp, -0.000321809685_wp, -1.86882975e-5_wp, &
                                              0.00150409519_wp])
   end subroutine reference_table

   subroutine one(name, delta, want)
      character(*), intent(in) :: name
      integer, intent(in) :: delta
      real(wp), intent(in) :: want(5)
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table
      type(force_model_t) :: model
      integer :: c

      allocate (problem, set)
      call load_case(name, problem, set)
      call rule_masses(problem, set)
      set%rates%speed = merge(100.0_wp, speed_600, problem%mechanism%sliding_input)
      set%rates%accel = 0.0_wp
      call forces_at(problem, set, [real(delta, wp)], table, model)
      do c = 1, 4
         call t%close_to(table%value(1, c)/want(c), 1.0_wp, 1.0e-8_wp, name//': drive, force and moment on the frame')
      end do
      call t%close_to(table%kinetic(1)/want(5), 1.0_wp, 1.0e-8_wp, name//': kinetic energy')
   end subroutine one

   !> Joints of the same independent computation.
   subroutine reference_joints()
      call joint('dyad4_slider_crank', 60, 'S1', [-36.6876135_wp, -18.4662732_wp])
      call joint('dyad4_slider_crank', 60, 'M1', [-19.8988751_wp, 5.09007527_wp])
      call joint('dyad4_slider_crank', 60, 'E1', [5.09007527_wp, -1.10177051_wp])
      call joint('dyad2_oscillating_cylinder', 60, 'S1', [-13.0675996_wp, -19.1656283_wp])
      call joint('dyad2_oscillating_cylinder', 60, 'M1', [-3.63315404_wp, 0.476472173_wp])
      call joint('dyad2_oscillating_cylinder', 60, 'E1', [-4.2154108_wp, -0.138574118_wp])
      call joint('dyad6_scotch_yoke', 60, 'M1', [23.6870506_wp, 0.336667942_wp])
      call joint('dyad6_scotch_yoke', 60, 'E1', [0.0_wp, -0.691973701_wp])
      call joint('dyad7_oldham_coupling', 60, 'S1', [-11.7175124_wp, -0.0967751118_wp])
      call joint('dyad7_oldham_coupling', 60, 'M1', [-3.89845107_wp, 0.0155938043_wp])
      call joint('dyad7_oldham_coupling', 60, 'E1', [3.37615766_wp, 33.5813503_wp])
      call joint('dyad8_tangent_mechanism', 30, 'S1', [336.950983_wp, 40.4705191_wp])
      call joint('dyad8_tangent_mechanism', 30, 'M1', [-158.324997_wp, 182.343_wp])
      call joint('dyad8_tangent_mechanism', 30, 'E1', [158.324997_wp, -6.40575294_wp])
      call joint('needle', 60, 'E4', [-27.4166907_wp, 10.0636424_wp])
      call joint('needle', 60, 'M3', [1017.98965_wp, 268.71672_wp])
      call joint('needle', 60, 'S4', [61.2587509_wp, -35.911844_wp])
   end subroutine reference_joints

   subroutine joint(name, delta, which, want)
      character(*), intent(in) :: name, which
      integer, intent(in) :: delta
      real(wp), intent(in) :: want(2)
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table
      type(force_model_t) :: model
      integer :: j, c

      allocate (problem, set)
      call load_case(name, problem, set)
      call rule_masses(problem, set)
      set%rates%speed = speed_600
      call forces_at(problem, set, [real(delta, wp)], table, model)
      do j = 1, size(problem%mechanism%joints)
         if (problem%mechanism%joints(j)%name /= which) cycle
         c = column_of_joint(j)
         call t%close_to(norm2(table%value(1, c:c + 1) - want)/norm2(want), 0.0_wp, 1.0e-8_wp, name//' '//which)
         return
      end do
      call t%is_true(.false., name//' has a joint '//which)
   end subroutine joint

   !> Loads are linear in the masses: unit columns of the rod of the slider-crank about its start, and their sum.
   subroutine unit_columns()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table
      type(force_model_t) :: model
      real(wp), allocatable :: columns(:, :, :, :)
      real(wp), parameter :: want(4, 4) = reshape([0.0_wp, 37.9658319_wp, 27.8561306_wp, -141.852024_wp, &
                                                   78.9568352_wp, -90.1946546_wp, 976.837501_wp, 0.0_wp, &
                                                   136.75725_wp, -976.837501_wp, -90.1946546_wp, 0.0_wp, &
                                                   0.0_wp, 132.106975_wp, -89.2964978_wp, -977.462877_wp], [4, 4])
      real(wp) :: total
      integer :: c

      allocate (problem, set)
      call load_case('dyad4_slider_crank', problem, set)
      call rule_masses(problem, set)
      set%rates%speed = speed_600
      call forces_at(problem, set, [60.0_wp], table, model)
      call loads_of_unit_masses(problem, model, set%rates%speed, set%rates%accel, columns)
      do c = 1, 4
         call t%close_to(maxval(abs(columns(1, c, :, 3) - want(:, c)))/maxval(abs(want(:, c))), 0.0_wp, 1.0e-8_wp, &
                         'unit columns of the rod of the slider-crank')
      end do
      do c = 1, size(table%value, 2)
         total = sum(columns(1, c, :, :)*model%inertia)
         call t%close_to(total, table%value(1, c), 1.0e-13_wp, 'unit columns times masses are the loads')
      end do
   end subroutine unit_columns

   !> Masses, weight, a load, a spring and a damper, so that every source takes part.
   subroutine load_up(problem, set)
      type(problem_t), intent(in) :: problem
      type(data_set_t), intent(inout) :: set

      call rule_masses(problem, set)
      set%masses%gravity = [0.7_wp, -9.81_wp]
      set%rates%speed = merge(100.0_wp, speed_600, problem%mechanism%sliding_input)
      set%rates%accel = 3.0_wp*set%rates%speed
      call put_loads(set%loads, set)
      associate (n => size(set%masses%places))
         set%springs%first = set%masses%places([n, 1])
         set%springs%second = set%masses%places([max(n - 1, 1), n])
      end associate
      set%springs%torsional = [.false., .true.]
      set%springs%stiffness = [200.0_wp, 0.3_wp]
      set%springs%free = [15.0_wp, 41.3_wp]   ! nowhere half a turn from it
      set%springs%preload = [2.0_wp, 0.1_wp]
      set%springs%damping = [0.5_wp, 0.002_wp]
      set%springs%drag = [0.0_wp, 0.0_wp]
      set%springs%power = [0.0_wp, 0.0_wp]
      set%springs%closed = [0.0_wp, 0.0_wp]
      set%springs%side = [0, 0]
      set%springs%table = [0, 0]
   end subroutine load_up

   !> A constant load and one that turns with its link.
   subroutine put_loads(loads, set)
      type(load_group_t), intent(inout) :: loads
      type(data_set_t), intent(in) :: set

      associate (n => size(set%masses%places))
         loads%places = set%masses%places([n, max(n - 1, 1)])
      end associate
      loads%force = reshape([30.0_wp, -20.0_wp, 5.0_wp, 11.0_wp], [2, 2])
      loads%moment = [0.2_wp, -0.7_wp]
      loads%turns = [.false., .true.]
      loads%table = [0, 0]
   end subroutine put_loads

   !> Newton and Euler for each link alone: reactions of its joints, inertia from the acceleration of the centre of mass, weight,
   !> loads, springs. Nothing of the sweep is used but its result.
   subroutine every_link_in_equilibrium(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table
      type(force_model_t) :: model
      type(rates_t) :: rates
      real(wp), allocatable :: delt(:)
      real(wp), allocatable :: rest(:, :, :)  !! (force x, y, moment about the input pivot; body; position)
      real(wp) :: worst, largest, reach, unit
      integer :: offset, n, i, j, b

      allocate (problem, set)
      call load_case(name, problem, set)
      call load_up(problem, set)
      delt = problem%delt(:min(problem%positions, 72))
      call forces_at(problem, set, delt, table, model)
      unit = model%metre/problem%linkage%scale
      call prepare_rates(problem, rates)
      call problem%solve_block(1, offset, n)
      call differentiate(problem, rates, n, 2)
      allocate (rest(3, size(problem%mechanism%bodies), n), source=0.0_wp)
      do i = 1, n
         do b = body_frame + 1, size(problem%mechanism%bodies)
            call add_inertia_of(b)
         end do
         call add_loads_and_springs()
         do j = 1, size(problem%mechanism%joints)
            call add_joint(j)
         end do
         rest(3, 2, i) = rest(3, 2, i) + merge(0.0_wp, table%value(i, column_drive), problem%mechanism%sliding_input)
         rest(3, 1, i) = rest(3, 1, i) - merge(0.0_wp, table%value(i, column_drive), problem%mechanism%sliding_input)
         if (problem%mechanism%sliding_input) call add_drive_force()
         ! the frame holds what the mechanism does to it
         rest(:2, 1, i) = rest(:2, 1, i) - table%value(i, column_fx:column_fy)
         rest(3, 1, i) = rest(3, 1, i) - (table%value(i, column_moment) - model%metre* &
                                          (problem%output%origin_x*table%value(i, column_fy) - &
                                           problem%output%origin_y*table%value(i, column_fx)))
      end do
      do i = 1, n
         if (.not. table%known(i)) cycle
         largest = maxval(abs(table%value(i, :)))
         ! moments are compared with the largest load on the arm of the whole linkage
         reach = max(1.0_wp, sum(problem%given%arcl)*model%metre)
         worst = max(maxval(abs(rest(1:2, :, i))), maxval(abs(rest(3, :, i)))/reach)
         call t%is_true(worst <= 1.0e-13_wp*largest, trim(name)//': each link is in equilibrium', text_of(worst/largest))
      end do

   contains

      pure function of_row(row) result(value)
         integer, intent(in) :: row
         real(wp) :: value

         value = problem%linkage%store%v(i, row)*unit
      end function of_row

      !> Reference, its velocity and acceleration, axis, angular speed and acceleration of a body.
      subroutine move(b, p, v, a, e, w, al)
         integer, intent(in) :: b
         real(wp), intent(out) :: p(2), v(2), a(2), e(2), w, al
         integer :: px, py, root, axis

         px = problem%linkage%point_x(problem%plan%joint_points(model%reference(b)))
         py = problem%linkage%point_y(problem%plan%joint_points(model%reference(b)))
         p = [of_row(px), of_row(py)]
         v = 0.0_wp
         a = 0.0_wp
         e = [1.0_wp, 0.0_wp]
         w = 0.0_wp
         al = 0.0_wp
         axis = problem%mechanism%bodies(b)%axis
         if (axis == 0) return
         v = [rates%d(1)%v(i, px), rates%d(1)%v(i, py)]*set%rates%speed*unit
         a = ([rates%d(2)%v(i, px), rates%d(2)%v(i, py)]*set%rates%speed**2 + [rates%d(1)%v(i, px), &
                                                            rates%d(1)%v(i, py)]*set%rates%accel)*unit
         call problem%linkage%arc_at(problem%plan, axis, i, e(1), e(2), w)
         root = problem%linkage%root_x(problem%plan%root(axis))
         w = rates%d(1)%v(i, root)*set%rates%speed
         al = rates%d(2)%v(i, root)*set%rates%speed**2 + rates%d(1)%v(i, root)*set%rates%accel
      end subroutine move

      pure function turn(x, e) result(y)
         real(wp), intent(in) :: x(2), e(2)
         real(wp) :: y(2)

         y = [x(1)*e(1) - x(2)*e(2), x(1)*e(2) + x(2)*e(1)]
      end function turn

      subroutine add_at(b, z, f, moment)
         integer, intent(in) :: b
         real(wp), intent(in) :: z(2), f(2), moment

         rest(:, b, i) = rest(:, b, i) + [f, z(1)*f(2) - z(2)*f(1) + moment]
      end subroutine add_at

      subroutine add_inertia_of(b)
         integer, intent(in) :: b
         real(wp) :: p(2), v(2), a(2), e(2), w, al, r(2), centre(2)

         associate (of => model%inertia(:, b))
            call move(b, p, v, a, e, w, al)
            centre = of(parameter_mx:parameter_my)/of(parameter_mass)
            r = turn(centre, e)
            a = a + [-al*r(2) - w**2*r(1), al*r(1) - w**2*r(2)]
            call add_at(b, p + r, of(parameter_mass)*(model%gravity - a), &
                        -(of(parameter_inertia) - of(parameter_mass)*sum(centre**2))*al)
         end associate
      end subroutine add_inertia_of

      subroutine add_loads_and_springs()
         real(wp) :: p(2), v(2), a(2), e(2), w, al, z(2, 2), vz(2, 2), ends(2, 2), speeds(2), gap(2), length, pull
         integer :: l, s, k

         do l = 1, size(model%loads)
            associate (load => model%loads(l))
               call move(load%location%body, p, v, a, e, w, al)
               if (load%turns) then
                  call add_at(load%location%body, p + turn(load%location%at, e)*model%metre, turn(load%force, e), load%moment)
               else
                  call add_at(load%location%body, p + turn(load%location%at, e)*model%metre, load%force, load%moment)
               end if
            end associate
         end do
         do s = 1, size(model%springs)
            associate (spring => model%springs(s))
               do k = 1, 2
                  call move(spring%ends(k)%body, p, v, a, e, w, al)
                  z(:, k) = p + turn(spring%ends(k)%at, e)*model%metre
                  vz(:, k) = v + w*[-(z(2, k) - p(2)), z(1, k) - p(1)]
                  ends(:, k) = turn(spring%ends(k)%along, e)
                  speeds(k) = w
               end do
               if (spring%torsional) then
                  gap = turn(ends(:, 2), [ends(1, 1), -ends(2, 1)])
                  pull = atan2(gap(2), gap(1)) - spring%free*pi/180.0_wp
                  pull = atan2(sin(pull), cos(pull))
                  pull = spring%preload + spring%stiffness*pull + spring%damping*(speeds(2) - speeds(1))
                  call add_at(spring%ends(1)%body, z(:, 1), [0.0_wp, 0.0_wp], pull)
                  call add_at(spring%ends(2)%body, z(:, 2), [0.0_wp, 0.0_wp], -pull)
               else
                  gap = z(:, 2) - z(:, 1)
                  length = norm2(gap)
                  pull = spring%preload + spring%stiffness*(length - spring%free*model%metre) + &
                         spring%damping*dot_product(gap, vz(:, 2) - vz(:, 1))/length
                  call add_at(spring%ends(1)%body, z(:, 1), pull*gap/length, 0.0_wp)
                  call add_at(spring%ends(2)%body, z(:, 2), -pull*gap/length, 0.0_wp)
               end if
            end associate
         end do
      end subroutine add_loads_and_springs

      subroutine add_joint(j)
         integer, intent(in) :: j
         real(wp) :: z(2), u(2), f(2), couple, length
         integer :: point

         associate (joint => problem%mechanism%joints(j), value => table%value(i, column_of_joint(j):column_of_joint(j) + 1))
            point = problem%plan%joint_points(joint%point)
            z = [of_row(problem%linkage%point_x(point)), of_row(problem%linkage%point_y(point))]
            f = value
            couple = 0.0_wp
            if (joint%kind == joint_prismatic) then
               call problem%linkage%arc_at(problem%plan, joint%slide, i, u(1), u(2), length)
               f = value(1)*[-u(2), u(1)]
               couple = value(2)
            end if
            call add_at(joint%bodies(2), z, f, couple)
            call add_at(joint%bodies(1), z, -f, -couple)
         end associate
      end subroutine add_joint

      subroutine add_drive_force()
         real(wp) :: u(2), length

         call problem%linkage%arc_at(problem%plan, 1, i, u(1), u(2), length)
         call add_at(2, [0.0_wp, 0.0_wp], table%value(i, column_drive)*u, 0.0_wp)
         call add_at(1, [0.0_wp, 0.0_wp], -table%value(i, column_drive)*u, 0.0_wp)
      end subroutine add_drive_force
   end subroutine every_link_in_equilibrium

   !> Force and moment on the frame are what weight and loads do less the growth of momentum and of angular momentum, and the power
   !> that bodies take up is the growth of their kinetic energy: all three differenced over nine positions at a constant speed.
   subroutine momentum_and_energy(name)
      character(*), intent(in) :: name
      real(wp), parameter :: weight(4) = [0.8_wp, -0.2_wp, 4.0_wp/105.0_wp, -1.0_wp/280.0_wp]
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table
      type(force_model_t) :: model
      type(rates_t) :: rates
      real(wp) :: step, middle, total(4, -4:4), want(4), got(4), largest
      integer :: s, offset, n, l

      allocate (problem, set)
      call load_case(name, problem, set)
      call load_up(problem, set)
      set%springs%first = set%springs%first(:0)
      set%springs%second = set%springs%second(:0)
      set%rates%accel = 0.0_wp
      middle = problem%delt(1)
      step = merge(2.0e-3_wp*maxval(problem%given%arcl), 0.25_wp, problem%mechanism%sliding_input)
      call forces_at(problem, set, [(middle + real(s, wp)*step, s=-4, 4)], table, model)
      if (.not. all([(table%known(s), s=1, 9)])) return
      call prepare_rates(problem, rates)
      call problem%solve_block(1, offset, n)
      call differentiate(problem, rates, n, 2)
      do s = -4, 4
         total(:, s) = momenta(s + 5)
      end do
      if (.not. problem%mechanism%sliding_input) step = step*pi/180.0_wp
      want = 0.0_wp
      do s = 1, 4
         want = want + weight(s)*(total(:, s) - total(:, -s))*(set%rates%speed/step)
      end do
      want(:3) = -want(:3)
      call add_outside()
      got = [table%value(5, [column_fx, column_fy, column_moment]), table%growth(5)]
      largest = max(norm2(want(:2)), abs(want(3)))
      call t%is_true(norm2(got(:2) - want(:2)) <= 1.0e-8_wp*largest, trim(name)//': momentum', text_of(norm2(got(:2) - want(:2))))
      call t%is_true(abs(got(3) - want(3)) <= 1.0e-8_wp*largest, trim(name)//': angular momentum', text_of(got(3) - want(3)))
      call t%is_true(abs(got(4) - want(4)) <= 1.0e-8_wp*max(abs(want(4)), maxval(table%kinetic)*set%rates%speed/ &
                                                            merge(maxval(problem%given%arcl), 1.0_wp, &
                                                                  problem%mechanism%sliding_input)), &
                     trim(name)//': power is the growth of the kinetic energy', text_of(got(4) - want(4)))

   contains

      !> Momentum, angular momentum about the machine origin, kinetic energy at a position.
      function momenta(i) result(sums)
         integer, intent(in) :: i
         real(wp) :: sums(4), z(2), v(2), w, centre(2), inertia
         integer :: b

         sums = 0.0_wp
         do b = body_frame + 1, size(problem%mechanism%bodies)
            associate (of => model%inertia(:, b))
               centre = of(parameter_mx:parameter_my)/of(parameter_mass)
               inertia = of(parameter_inertia) - of(parameter_mass)*sum(centre**2)
               call follow(b, i, centre, z, v, w)
               sums(1:2) = sums(1:2) + of(parameter_mass)*v
               sums(3) = sums(3) + of(parameter_mass)*(z(1)*v(2) - z(2)*v(1)) + inertia*w
               sums(4) = sums(4) + 0.5_wp*(of(parameter_mass)*sum(v**2) + inertia*w**2)
            end associate
         end do
      end function momenta

      !> A place of a body, metres from the machine origin, its velocity, and the angular speed.
      subroutine follow(b, i, at, z, v, w)
         integer, intent(in) :: b, i
         real(wp), intent(in) :: at(2)
         real(wp), intent(out) :: z(2), v(2), w
         real(wp) :: e(2), r(2), length, unit
         integer :: px, py, axis

         unit = model%metre/problem%linkage%scale
         px = problem%linkage%point_x(problem%plan%joint_points(model%reference(b)))
         py = problem%linkage%point_y(problem%plan%joint_points(model%reference(b)))
         axis = problem%mechanism%bodies(b)%axis
         e = [1.0_wp, 0.0_wp]
         w = 0.0_wp
         if (axis > 0) then
            call problem%linkage%arc_at(problem%plan, axis, i, e(1), e(2), length)
            w = rates%d(1)%v(i, problem%linkage%root_x(problem%plan%root(axis)))*set%rates%speed
         end if
         r = [at(1)*e(1) - at(2)*e(2), at(1)*e(2) + at(2)*e(1)]
         z = [problem%linkage%store%v(i, px), problem%linkage%store%v(i, py)]*unit + r + &
             [problem%output%origin_x, problem%output%origin_y]*model%metre
         v = w*[-r(2), r(1)]
         if (axis > 0) v = v + [rates%d(1)%v(i, px), rates%d(1)%v(i, py)]*set%rates%speed*unit
      end subroutine follow

      !> Weight and loads at the middle position.
      subroutine add_outside()
         real(wp) :: z(2), v(2), w, f(2), e(2), length
         integer :: b

         do b = body_frame + 1, size(problem%mechanism%bodies)
            associate (m => model%inertia(parameter_mass, b))
               call follow(b, 5, model%inertia(parameter_mx:parameter_my, b)/m, z, v, w)
               want(:2) = want(:2) + m*model%gravity
               want(3) = want(3) + m*(z(1)*model%gravity(2) - z(2)*model%gravity(1))
            end associate
         end do
         do l = 1, size(model%loads)
            associate (load => model%loads(l))
               call follow(load%location%body, 5, load%location%at*model%metre, z, v, w)
               f = load%force
               if (load%turns) then
                  call problem%linkage%arc_at(problem%plan, problem%mechanism%bodies(load%location%body)%axis, 5, e(1), e(2), &
                                              length)
                  f = [f(1)*e(1) - f(2)*e(2), f(1)*e(2) + f(2)*e(1)]
               end if
               want(:2) = want(:2) + f
               want(3) = want(3) + z(1)*f(2) - z(2)*f(1) + load%moment
            end associate
         end do
      end subroutine add_outside
   end subroutine momentum_and_energy

   !> At twice the speed, without weight and loads, every load is four times as large; the loads of the links' masses, one link at
   !> a time, add up to those of all.
   subroutine scaling_of_speed(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table, faster, of_one
      type(force_model_t) :: model
      real(wp), allocatable :: sums(:, :), delt(:), mass(:), inertia(:)
      real(wp) :: largest
      integer :: b

      allocate (problem, set)
      call load_case(name, problem, set)
      call rule_masses(problem, set)
      set%rates%speed = speed_600
      set%rates%accel = 0.0_wp
      delt = problem%delt(:min(problem%positions, 12))
      call forces_at(problem, set, delt, table, model)
      set%rates%speed = 2.0_wp*speed_600
      call forces_at(problem, set, delt, faster, model)
      largest = maxval(abs(table%value))
      call t%is_true(maxval(abs(faster%value - 4.0_wp*table%value)) <= 1.0e-14_wp*largest, trim(name)//': loads by the speed', &
                     text_of(maxval(abs(faster%value - 4.0_wp*table%value))/largest))
      set%rates%speed = speed_600
      mass = set%masses%mass
      inertia = set%masses%inertia
      allocate (sums(size(table%value, 1), size(table%value, 2)), source=0.0_wp)
      do b = 1, size(mass)
         set%masses%mass = 0.0_wp
         set%masses%inertia = 0.0_wp
         set%masses%mass(b) = mass(b)
         set%masses%inertia(b) = inertia(b)
         call forces_at(problem, set, delt, of_one, model)
         sums = sums + of_one%value
      end do
      call t%is_true(maxval(abs(sums - table%value)) <= 1.0e-12_wp*largest, trim(name)//': loads of one mass at a time add up', &
                     text_of(maxval(abs(sums - table%value))/largest))
   end subroutine scaling_of_speed

   !> The whole machine turned about the machine origin and then shifted: forces turn along, the moment on the frame moves by the
   !> shift x force, drives and what slides bear stay.
   subroutine shift_and_turn(name)
      character(*), intent(in) :: name
      real(wp), parameter :: angle = 37.0_wp
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table, moved
      type(force_model_t) :: model
      real(wp), allocatable :: delt(:)
      real(wp) :: c, s, shift(2), before(2), largest, want(2), worst
      integer :: k, n, j

      allocate (problem, set)
      call load_case(name, problem, set)
      call load_up(problem, set)
      delt = problem%delt(:min(problem%positions, 12))
      call forces_at(problem, set, delt, table, model)
      before = [problem%output%origin_x, problem%output%origin_y]
      c = cos(angle*pi/180.0_wp)
      s = sin(angle*pi/180.0_wp)
      shift = [31.0_wp, -17.0_wp]
      associate (given => problem%given, arcs => problem%mechanism%arcs)
         do n = 1, size(arcs)
            if (arcs(n)%reference == 0 .and. arcs(n)%frame .and. .not. arcs(n)%same) given%gama(n) = given%gama(n) + angle
         end do
         if (.not. problem%mechanism%sliding_input) given%crnki = given%crnki + angle
         want = turn(before) + shift
         given%origlk = norm2(want)
         given%origng = atan2(want(2), want(1))*180.0_wp/pi
      end associate
      set%masses%gravity = turn(set%masses%gravity)
      do k = 1, size(set%loads%turns)
         if (.not. set%loads%turns(k)) set%loads%force(:, k) = turn(set%loads%force(:, k))
      end do
      call forces_at(problem, set, delt, moved, model)
      worst = 0.0_wp
      largest = maxval(abs(table%value))
      do k = 1, size(delt)
         if (.not. (table%known(k) .and. moved%known(k))) cycle
         worst = max(worst, abs(moved%value(k, column_drive) - table%value(k, column_drive)))
         want = turn(table%value(k, column_fx:column_fy))
         worst = max(worst, norm2(moved%value(k, column_fx:column_fy) - want))
         worst = max(worst, abs(moved%value(k, column_moment) - table%value(k, column_moment) - &
                                model%metre*(shift(1)*want(2) - shift(2)*want(1))))
         do j = 1, size(problem%mechanism%joints)
            want = table%value(k, column_of_joint(j):column_of_joint(j) + 1)
            if (problem%mechanism%joints(j)%kind /= joint_prismatic) want = turn(want)
            worst = max(worst, norm2(moved%value(k, column_of_joint(j):column_of_joint(j) + 1) - want))
         end do
      end do
      call t%is_true(any([(table%known(k), k=1, size(delt))]), trim(name)//': forces are known')
      call t%is_true(worst <= 1.0e-11_wp*largest, trim(name)//': shifted and turned', text_of(worst/largest))

   contains

      pure function turn(v) result(w)
         real(wp), intent(in) :: v(2)
         real(wp) :: w(2)

         w = [c*v(1) - s*v(2), s*v(1) + c*v(2)]
      end function turn
   end subroutine shift_and_turn

   !> Millimetres and metres give the same newtons; a load of 1e-12 N has the digits of one of 1e6 N; a mechanism without masses and
   !> loads has no forces.
   subroutine units_and_sizes()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: small, large, none
      type(force_model_t) :: model
      real(wp), parameter :: at(3) = [20.0_wp, 140.0_wp, 260.0_wp]
      integer :: k

      allocate (problem, set)
      call load_case('dyad4_slider_crank', problem, set)
      call rule_masses(problem, set)
      set%rates%speed = speed_600
      call forces_at(problem, set, at, small, model)
      problem%given%arcl = 0.001_wp*problem%given%arcl
      set%masses%places%distance = 0.001_wp*set%masses%places%distance
      set%masses%metre = 1.0_wp
      call forces_at(problem, set, at, large, model)
      call t%is_true(maxval(abs(small%value - large%value)) <= 1.0e-14_wp*maxval(abs(small%value)), 'millimetres and metres', &
                     text_of(maxval(abs(small%value - large%value))))
      call load_case('dyad4_slider_crank', problem, set)
      call rule_masses(problem, set)
      set%masses%mass = 0.0_wp
      set%masses%inertia = 0.0_wp
      call forces_at(problem, set, at, none, model)
      call t%is_true(maxval(abs(none%value)) <= 0.0_wp, 'no masses, no forces')
      call put_loads(set%loads, set)
      set%loads%turns = .false.
      set%loads%moment = 0.0_wp
      set%loads%force = reshape([1.0e-12_wp, 0.0_wp, 0.0_wp, 0.0_wp], [2, 2])
      call forces_at(problem, set, at, small, model)
      set%loads%force = reshape([1.0e6_wp, 0.0_wp, 0.0_wp, 0.0_wp], [2, 2])
      call forces_at(problem, set, at, large, model)
      do k = 1, size(at)
         call t%is_true(maxval(abs(1.0e18_wp*small%value(k, :) - large%value(k, :))) <= 1.0e-9_wp, 'loads of any size', &
                        text_of(maxval(abs(1.0e18_wp*small%value(k, :) - large%value(k, :)))))
      end do
   end subroutine units_and_sizes

   !> Two four-bars on one crank, in either order: nothing but the names of the joints changes.
   subroutine order_of_loops()
      character(*), parameter :: nl = new_line('a')
      character(*), parameter :: rest = ' NOUTLK=2, NOUTLP=1 &END'//nl//' &METHOD NDES=4, DELT=10.,100.,190.,280. &END'//nl
      character(*), parameter :: first = 'TWO FOUR-BARS'//nl//' &LINKS NLOOP=2, MAXARC=4, ILINK=1,2,3,4, 1,2,3,-4, '// &
         'ILOOP=1,0,0,1, 1,0,0,1, ARCL=30.,100.,80.,120., 0.,110.,90.,130., GAMA=0.,0.,0.,180., 0.,0.,0.,90.,'//rest
      character(*), parameter :: second = 'TWO FOUR-BARS'//nl//' &LINKS NLOOP=2, MAXARC=4, ILINK=1,2,3,4, 1,2,3,-4, '// &
         'ILOOP=1,0,0,1, 1,0,0,1, ARCL=30.,110.,90.,130., 0.,100.,80.,120., GAMA=0.,0.,0.,270., 0.,0.,0.,-90.,'//rest
      type(force_table_t) :: a, b
      real(wp) :: largest
      integer :: k

      call find(first, [2, 1, 3], a)
      call find(second, [1, 2, 3], b)
      largest = maxval(abs(a%value))
      call t%is_true(all([(a%known(k) .and. b%known(k), k=1, 4)]), 'two four-bars on a crank close')
      call t%is_true(maxval(abs(a%value(:, :4) - b%value(:, :4))) <= 1.0e-13_wp*largest, 'drive and frame: order of loops')
      ! joints IN, S1 M1 E1, S2 M2 E2
      call t%is_true(maxval(abs(a%value(:, 5:6) - b%value(:, 5:6))) <= 1.0e-13_wp*largest, 'crank: order of loops')
      call t%is_true(maxval(abs(a%value(:, 7:12) - b%value(:, 13:18))) <= 1.0e-13_wp*largest, 'joints: order of loops')
      call t%is_true(maxval(abs(a%value(:, 13:18) - b%value(:, 7:12))) <= 1.0e-13_wp*largest, 'joints: order of loops')

   contains

      !> The couplers have 1 and 2 kg, the crank 3.
      subroutine find(text, mass_of, table)
         character(*), intent(in) :: text
         integer, intent(in) :: mass_of(3)     !! of the couplers of loop 1 and 2, of the crank
         type(force_table_t), intent(out) :: table
         type(data_set_t), allocatable :: sets(:)
         type(diagnostics_t) :: findings
         class(problem_t), allocatable :: problem
         type(mechanism_t) :: mechanism
         type(parameters_t) :: parameters
         type(dimensions_t) :: dimensions
         type(force_model_t) :: model
         integer :: n

      allocate (problem)
         call read_case_text(text, 'case', sets, findings, 'psalm')
         call t%is_true(.not. findings%failed(), 'two four-bars are read')
         call set_up(sets(1), mechanism, dimensions, parameters, findings)
         call make_problem(sets(1), mechanism, dimensions, parameters, problem)
         associate (masses => sets(1)%masses)
            deallocate (masses%places)
            allocate (masses%places(3))
            masses%places%arc = [2, 2, 1]
            masses%places%loop = [1, 2, 1]
            masses%places%from_start = .true.
            masses%places%distance = [(20.0_wp*real(mass_of(n), wp), n=1, 3)]
            masses%mass = real(mass_of, wp)
            masses%inertia = 0.001_wp*masses%mass
            masses%metre = 0.001_wp
            masses%given = .true.
         end associate
         sets(1)%rates%speed = speed_600
         call forces_at(problem, sets(1), [10.0_wp, 100.0_wp, 190.0_wp, 280.0_wp], table, model)
      end subroutine find
   end subroutine order_of_loops

   pure function text_of(value) result(text)
      real(wp), intent(in) :: value
      character(12) :: text

      write (text, '(es10.3)') value
   end function text_of

   !> Drive times speed + power of weight, loads and springs = growth of the kinetic energy; and with steady speed and no loads
   !> the mean torque over a turn is nothing.
   subroutine power_balance(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table
      type(force_model_t) :: model
      real(wp), allocatable :: power(:), gap(:), delt(:)
      integer :: i

      allocate (problem, set)
      call load_case(name, problem, set)
      call load_up(problem, set)
      delt = problem%delt
      call forces_at(problem, set, delt, table, model)
      power = table%value(:, column_drive)*set%rates%speed
      if (problem%mechanism%sliding_input) power = power*model%metre
      gap = power + table%power - table%growth
      where (.not. [(table%known(i), i=1, size(gap))])
         gap = 0.0_wp
         power = 0.0_wp
      end where
      call t%is_true(maxval(abs(gap)) <= 1.0e-12_wp*max(maxval(abs(power)), maxval(abs(table%growth)), maxval(abs(table%power))), &
                     trim(name)//': power balance', text_of(maxval(abs(gap))/maxval(abs(power))))
      if (problem%mechanism%sliding_input) return
      call load_case(name, problem, set)
      call rule_masses(problem, set)
      set%rates%speed = speed_600
      set%rates%accel = 0.0_wp
      call forces_at(problem, set, [(5.0_wp*real(i, wp), i=0, 71)], table, model)
      if (name(:4) /= 'dyad' .or. .not. all([(table%known(i), i=1, 72)])) return
      call t%is_true(abs(sum(table%value(:, column_drive))) <= 1.0e-9_wp*maxval(abs(table%value(:, column_drive)))*72.0_wp, &
                     trim(name)//': no mean torque over a turn', text_of(sum(table%value(:, column_drive))))
   end subroutine power_balance

   !> No masses, one load at the output point: the drive is minus the load times the derivative of that point by the input.
   subroutine virtual_work(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table
      type(force_model_t) :: model
      type(rates_t) :: rates
      real(wp) :: d(highest_order, 2), want, size_of
      real(wp), parameter :: force(2) = [13.0_wp, -7.0_wp]
      integer :: i, offset, n

      allocate (problem, set)
      call load_case(name, problem, set, motion=motion_point)
      set%masses%given = .true.
      deallocate (set%loads%places)
      allocate (set%loads%places(1))
      associate (place => set%loads%places(1))
         place%arc = abs(set%links%noutlk)
         place%loop = set%links%noutlp
         place%from_start = set%links%noutlk < 0
         place%distance = set%links%outlk
         place%angle = set%links%outang
         associate (arc => problem%mechanism%arcs(problem%mechanism%seq(place%loop, place%arc)))
            if (arc%foot == merge(1, 2, place%from_start)) return   ! no point of that link
         end associate
      end associate
      set%loads%force = reshape(force, [2, 1])
      set%loads%moment = [0.0_wp]
      set%loads%turns = [.false.]
      set%loads%table = [0]
      call forces_at(problem, set, problem%delt(:min(problem%positions, 72)), table, model)
      call prepare_rates(problem, rates)
      call problem%solve_block(1, offset, n)
      call differentiate(problem, rates, n, 2)
      size_of = norm2(force)*maxval(problem%given%arcl)*set%masses%metre
      do i = 1, n
         call output_rates(problem, rates, i, 2, d)
         want = -dot_product(force, d(1, :))
         call t%is_true(abs(table%value(i, column_drive) - want) <= 1.0e-12_wp*size_of, trim(name)//': virtual work', &
                        text_of((table%value(i, column_drive) - want)/size_of))
      end do
   end subroutine virtual_work

   !> Friction of the slider-crank, against an independent computation; and the power that it takes.
   subroutine friction_reference()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table
      type(force_model_t) :: model
      integer :: m

      allocate (problem, set)
      call load_case('dyad4_slider_crank', problem, set)
      call rule_masses(problem, set)
      set%rates%speed = speed_600
      deallocate (set%friction%joints)
      allocate (set%friction%joints(4))
      set%friction%joints%arc = [1, 1, 2, 3]
      set%friction%joints%loop = 1
      set%friction%joints%from_start = [.true., .false., .false., .false.]
      set%friction%coefficient = spread(0.1_wp, 1, 4)
      set%friction%grip = spread(0.0_wp, 1, 4)
      set%friction%others = spread(0, 1, 4)
      set%friction%from = spread(0.0_wp, 1, 4)
      set%friction%until = spread(huge(1.0_wp), 1, 4)
      set%friction%radius = [15.0_wp, 20.0_wp, 10.0_wp, 30.0_wp]
      call forces_at(problem, set, [60.0_wp], table, model)
      m = column_of_joint(3)
      call t%close_to(table%value(1, column_drive), 1.247565899_wp, 1.0e-8_wp, 'torque with friction')
      call t%close_to(table%loss(1), 21.739516525_wp, 1.0e-8_wp, 'power lost in friction')
      call t%close_to(table%value(1, m), -24.3407440_wp, 1.0e-8_wp, 'force in a pin with friction')
      call t%close_to(table%value(1, m + 1), 6.7124838_wp, 1.0e-8_wp, 'force in a pin with friction')
      call t%close_to(table%value(1, column_of_joint(4) + 1), -1.3325607_wp, 1.0e-7_wp, 'couple in a guide with friction')
      call t%is_true(table%sweeps(1) > 10 .and. table%sweeps(1) <= 25, 'sweeps that friction takes')
      call t%close_to(table%value(1, column_drive)*speed_600, table%growth(1) + table%loss(1), 1.0e-12_wp, &
                      'drive power = kinetic energy + friction')
      set%friction%coefficient = spread(2.0_wp, 1, 4)
      call forces_at(problem, set, [60.0_wp], table, model)
      call t%is_true(.not. table%known(1), 'friction that locks the linkage is told')
   end subroutine friction_reference

   !> Three rows printed by Haines: RMS loads of a four-bar linkage bare, with interim and with final counterweights. The speed is
   !> held by a flywheel elsewhere, the crank is massless.
   subroutine counterweights()
      real(wp), parameter :: discs(4, 3, 2) = reshape([ &
         -0.0064679_wp, -0.0014698_wp, 0.1_wp, 0.05_wp, -0.0062665_wp, -0.0525577_wp, 0.05293_wp, 0.02_wp, &
         -0.0337734_wp, 0.0347102_wp, 0.0484297_wp, 0.05_wp, &
         -0.0064660_wp, -0.0014741_wp, 0.1_wp, 0.05_wp, -0.0067098_wp, -0.052621_wp, 0.052928_wp, 0.02_wp, &
         -0.034016_wp, 0.034550_wp, 0.048442_wp, 0.05_wp], [4, 3, 2])

      call row('bare', discs(:, :0, 1), [16.494_wp, 1.2499_wp, 0.49955_wp, 8.7821_wp, 21.069_wp, 8.7821_wp, 21.069_wp, 2.2400_wp, &
                                        11.197_wp, 7.8765_wp, 4.9995_wp])
      call row('interim', discs(:, :, 1), [0.14484_wp, 1.5111_wp, 0.49657_wp, 24.456_wp, 6.0748_wp, 67.344_wp, 58.829_wp, &
                                           11.416_wp, 12.009_wp, 24.417_wp, 6.0446_wp])
      call row('final', discs(:, :, 2), [0.0_wp, 1.5393_wp, 0.49247_wp, 24.483_wp, 6.1571_wp, 67.509_wp, 58.854_wp, 11.471_wp, &
                                        12.051_wp, 24.483_wp, 6.1572_wp])
   end subroutine counterweights

   !> All printed digits, as far as the printed weights tell them: half a unit of the last digit, and what the rounding of the
   !> weights does.
   subroutine row(name, discs, want)
      character(*), intent(in) :: name
      real(wp), intent(in) :: discs(:, :)      !! x, y, radius, thickness in the axes of crank, coupler, rocker
      real(wp), intent(in) :: want(11)         !! force, moment, torque, then x and y of four joints
      real(wp), parameter :: density = 7833.0_wp
      real(wp), parameter :: last_digit = 0.5e-7_wp, last_digits = 0.5e-6_wp !! of the weights' places, metres
      real(wp) :: got(11), moved(11), tolerance(11), other(size(discs, 1), size(discs, 2))
      integer :: i, j

      call find_loads(discs, got)
      tolerance = 0.5_wp*10.0_wp**(floor(log10(max(want, 1.0e-4_wp))) - 4)
      where (want <= 0.0_wp) tolerance = 1.0e-4_wp
      do j = 1, size(discs, 2)
         do i = 1, 3
            if (i == 3 .and. (j == 1)) cycle      ! a round figure
            other = discs
            other(i, j) = other(i, j) + merge(last_digit, last_digits, name == 'interim' .or. j == 1 .or. (i == 1 .and. j == 2))
            call find_loads(other, moved)
            tolerance = tolerance + abs(moved - got)
         end do
      end do
      do i = 1, 11
         call t%is_true(abs(got(i) - want(i)) <= tolerance(i), 'RMS loads printed by Haines, '//name, &
                        text_of(got(i) - want(i))//text_of(tolerance(i)))
      end do

   contains

      !> RMS of force, moment, torque, and of each joint's force in x and y.
      subroutine find_loads(discs, got)
         real(wp), intent(in) :: discs(:, :)
         real(wp), intent(out) :: got(11)
         class(problem_t), allocatable :: problem
         class(data_set_t), allocatable :: set
         type(force_table_t) :: table
         type(force_model_t) :: model
         integer :: i, j, c

      allocate (problem, set)
         call load_case('four_bar_haines', problem, set)
         set%rates%speed = 10.0_wp*pi
         call put_masses(set, discs)
         call forces_at(problem, set, [(5.0_wp*real(i, wp), i=0, 71)], table, model)
         associate (v => table%value)
            got(1) = sqrt(sum(v(:, column_fx:column_fy)**2)/144.0_wp)
            got(2) = sqrt(sum((v(:, column_moment) + v(:, column_drive))**2)/72.0_wp)
            got(3) = sqrt(sum(v(:, column_drive)**2)/72.0_wp)
            do j = 1, 4
               c = column_of_joint(j)
               got(2*j + 2) = sqrt(sum(v(:, c)**2)/72.0_wp)
               got(2*j + 3) = sqrt(sum(v(:, c + 1)**2)/72.0_wp)
            end do
         end associate
      end subroutine find_loads

      subroutine put_masses(set, discs)
         type(data_set_t), intent(inout) :: set
         real(wp), intent(in) :: discs(:, :)
         real(wp) :: x, y
         integer :: n, k

         n = 2 + size(discs, 2)
         deallocate (set%masses%places)
         allocate (set%masses%places(n))
         set%masses%given = .true.
         set%masses%places%loop = 1
         set%masses%places%arc = [2, 3, (k, k=1, size(discs, 2))]
         set%masses%places%from_start = [.true., .false., (k < 3, k=1, size(discs, 2))]
         set%masses%places%distance = [0.1_wp, 0.1375_wp, (norm2(discs(1:2, k)), k=1, size(discs, 2))]
         set%masses%places%angle = [0.0_wp, 180.0_wp, (0.0_wp, k=1, size(discs, 2))]
         set%masses%mass = [0.33235_wp, 0.47445_wp, (density*pi*discs(3, k)**2*discs(4, k), k=1, size(discs, 2))]
         set%masses%inertia = [0.001278_wp, 0.00405_wp, (0.0_wp, k=1, size(discs, 2))]
         do k = 1, size(discs, 2)
            x = discs(1, k)
            y = discs(2, k)
            if (k == 3) then     ! the arc leads from the coupler to the frame, the author's axis the other way
               x = -x
               y = -y
            end if
            set%masses%places(k + 2)%angle = atan2(y, x)*180.0_wp/pi
            set%masses%inertia(k + 2) = 0.5_wp*set%masses%mass(k + 2)*discs(3, k)**2
         end do
      end subroutine put_masses
   end subroutine row

   !> Motion from torque of the slider-crank, against an independent computation.
   subroutine motion_from_torque()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_model_t) :: model
      type(motor_group_t) :: motor
      type(machine_t) :: machine
      type(cycle_t) :: cycle
      type(machine_run_t) :: run
      type(reduced_t) :: reduced
      type(diagnostics_t) :: findings
      real(wp) :: wheel

      allocate (problem, set)
      call load_case('dyad4_slider_crank', problem, set)
      call rule_masses(problem, set)
      call make_force_model(set, problem%mechanism, problem%given, model, findings)
      call reduce_machine(problem, model, [0.0_wp, 60.0_wp], reduced)
      call t%close_to(reduced%inertia(1)/0.000371760464_wp, 1.0_wp, 1.0e-7_wp, 'inertia at the crank')
      call t%close_to(reduced%inertia(2)/0.000844293120_wp, 1.0_wp, 1.0e-7_wp, 'inertia at the crank')
      call t%close_to(reduced%slope(2)/0.000456741076_wp, 1.0_wp, 1.0e-7_wp, 'its derivative')
      motor = motor_of(set)
      call make_machine(problem, model, motor, machine)
      call steady_cycle(machine, 100.0_wp, cycle)
      call t%equal_integer(cycle%state, cycle_any_speed, 'a free run has any speed')
      call t%close_to(cycle%greatest/cycle%least, 1.641207883_wp, 1.0e-7_wp, 'speed ratio of a free run')
      call extremes_of_speed(cycle)
      call flywheel_for(machine, 0.02_wp, 100.0_wp, wheel)
      call t%close_to(wheel/0.014844012_wp, 1.0_wp, 1.0e-7_wp, 'flywheel of a free run')
      machine%motor%torque = 1.0_wp
      machine%motor%turns = 1
      call run_up(problem, model, machine, run)
      call t%close_to(run%time(1)/0.0852432063_wp, 1.0_wp, 1.0e-7_wp, 'time of the first turn from rest')
      call t%close_to(run%speed(1)/183.854105_wp, 1.0_wp, 1.0e-7_wp, 'speed after it')
      call steady_cycle(machine, 100.0_wp, cycle)
      call t%equal_integer(cycle%state, cycle_grows, 'a constant torque without resistance has no steady cycle')
      ! the motor line, and a resistance as a load on the crank
      set%loads%places = set%masses%places(1:1)
      set%loads%force = reshape([0.0_wp, 0.0_wp], [2, 1])
      set%loads%moment = [-5.0_wp]
      set%loads%turns = [.false.]
      set%loads%table = [0]
      motor%torque = 20.0_wp
      motor%idle = 100.0_wp
      call make_force_model(set, problem%mechanism, problem%given, model, findings)
      call make_machine(problem, model, motor, machine)
      call steady_cycle(machine, 100.0_wp, cycle)
      call t%equal_integer(cycle%state, cycle_found, 'a falling motor line has a steady cycle')
      call t%close_to(cycle%speed(0)/81.33487238_wp, 1.0_wp, 1.0e-7_wp, 'speed at the reference position')
      call t%close_to(cycle%least/67.849771_wp, 1.0_wp, 1.0e-7_wp, 'least speed')
      call t%close_to(cycle%greatest/85.741334_wp, 1.0_wp, 1.0e-7_wp, 'greatest speed')
      call t%close_to(cycle%period/0.084192208_wp, 1.0_wp, 1.0e-7_wp, 'time of a turn')
      call t%close_to(cycle%mean/74.629059387_wp, 1.0_wp, 1.0e-7_wp, 'mean speed')
   end subroutine motion_from_torque

   !> The greatest and the least speed lie within half a step of the largest and the smallest value, on the side of the neighbour
   !> that is nearer to it.
   subroutine extremes_of_speed(cycle)
      type(cycle_t), intent(in) :: cycle
      real(wp) :: off, rise
      integer :: k, n

      n = size(cycle%speed) - 1
      k = maxloc(cycle%speed(:n - 1), dim=1) - 1
      rise = cycle%speed(modulo(k + 1, n)) - cycle%speed(modulo(k - 1, n))
      off = beside(cycle%greatest_at, k)
      call t%is_true(abs(off) <= 0.5_wp .and. off*rise > 0.0_wp, 'where the speed is greatest')
      k = minloc(cycle%speed(:n - 1), dim=1) - 1
      rise = cycle%speed(modulo(k + 1, n)) - cycle%speed(modulo(k - 1, n))
      off = beside(cycle%least_at, k)
      call t%is_true(abs(off) <= 0.5_wp .and. off*rise < 0.0_wp, 'where the speed is least')

   contains

      !> Steps from step k to an angle.
      pure real(wp) function beside(angle, k)
         real(wp), intent(in) :: angle
         integer, intent(in) :: k
         real(wp), parameter :: turn = 360.0_wp

         beside = (modulo(angle - turn*real(k, wp)/real(n, wp) + 0.5_wp*turn, turn) - 0.5_wp*turn)*real(n, wp)/turn
      end function beside
   end subroutine extremes_of_speed

   !> A load on the slide of a slider-crank whose rod comes square to the slide at a crank angle of 30 degrees: the force in the
   !> rod is load/cos(beta), sin(beta) = (crank/rod) sin(angle), in quadruple precision. A relative change of a dimension changes
   !> it by tan(beta)**2 of that, three dimensions take part. At 30 degrees the loop is named.
   subroutine near_a_dead_point()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_table_t) :: table
      type(force_model_t) :: model
      real(wp), parameter :: offset(5) = [10.0_wp, 1.0e-1_wp, 1.0e-3_wp, 1.0e-5_wp, 1.0e-7_wp], load = 100.0_wp
      real(real128) :: degree, sine, cosine, want, got
      real(wp) :: condition
      integer :: k

      allocate (problem, set)
      degree = acos(-1.0_real128)/180.0_real128
      call load_case('dyad4_slider_crank', problem, set)
      associate (arcl => problem%given%arcl)
         arcl(1) = 60.0_wp
         arcl(2) = 30.0_wp
         arcl(4) = 0.0_wp
      end associate
      set%masses%given = .true.
      deallocate (set%loads%places)
      allocate (set%loads%places(1))
      set%loads%places(1)%arc = 3
      set%loads%places(1)%loop = 1
      set%loads%places(1)%from_start = .true.
      set%loads%force = reshape([load, 0.0_wp], [2, 1])
      set%loads%moment = [0.0_wp]
      set%loads%turns = [.true.]
      set%loads%table = [0]
      call forces_at(problem, set, [30.0_wp - offset, 30.0_wp], table, model)
      do k = 1, size(offset)
         sine = 2.0_real128*sin(real(30.0_wp - offset(k), real128)*degree)
         cosine = sqrt((1.0_real128 - sine)*(1.0_real128 + sine))
         want = load/cosine
         condition = real(3.0_real128*(sine/cosine)**2, wp) + 1.0_wp
         associate (m => table%value(k, column_of_joint(3):column_of_joint(3) + 1))
            got = sqrt(real(m(1), real128)**2 + real(m(2), real128)**2)
         end associate
         call t%is_true(table%known(k), 'forces are known beside a dead point')
         call t%is_true(abs(got/want - 1.0_real128) <= 16.0_wp*epsilon(1.0_wp)*condition, 'error of a force beside a dead point', &
                        text_of(real(abs(got/want - 1.0_real128), wp)/(epsilon(1.0_wp)*condition)))
      end do
      call t%equal_integer(table%dead(size(offset) + 1), 1, 'the loop at a dead point is named')
      call t%is_true(.not. table%known(size(offset) + 1), 'no forces are known there')
      call t%is_true(all(abs(table%value) < huge(1.0_wp)), 'and none is NaN')
   end subroutine near_a_dead_point

   !> A table over a full turn of the crank gives the same forces from whichever row it begins.
   subroutine table_begun_elsewhere()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(force_model_t) :: model, other
      type(force_table_t) :: one, two
      type(motion_t) :: motion
      integer :: k, n
      integer, parameter :: first = 4
      real(wp), parameter :: turn = 360.0_wp

      allocate (problem, set)
      call load_case('dyad4_slider_crank', problem, set)
      call load_up(problem, set)
      call forces_at(problem, set, [(10.0_wp*real(k, wp), k=0, 35)], one, model)
      model%loads%table = 1
      model%table_input = [0.0_wp, 60.0_wp, 95.0_wp, 120.0_wp, 200.0_wp, 300.0_wp, turn]
      n = size(model%table_input)
      model%table_factor = reshape([0.95_wp, 0.3_wp, -0.2_wp, 0.0_wp, 0.6_wp, 1.0_wp, 0.95_wp], [n, 1])
      other = model
      other%table_input = [model%table_input(first:), model%table_input(2:first) + turn]
      other%table_factor = model%table_factor([(k, k=first, n), (k, k=2, first)], :)
      call problem%analyse(problem%given, motion)
      call analyse_forces(problem, model, set%rates%speed, set%rates%accel, motion%closed, motion%input, one)
      call analyse_forces(problem, other, set%rates%speed, set%rates%accel, motion%closed, motion%input, two)
      call t%is_true(other%table_input(1) > 90.0_wp, 'a table that begins elsewhere')
      call t%close_to(maxval(abs(two%value - one%value))/maxval(abs(one%value)), 0.0_wp, 1.0e-12_wp, &
                      'a table over a turn gives the same forces wherever it begins')
   end subroutine table_begun_elsewhere
end module force_checks
