!> KALM: velocities, accelerations and jerks of the output, and on request of every joint and arc.
!>
!> Derivatives are taken with respect to the input (per radian, or per unit of length of a sliding input) and with respect to
!> time, for the speed and acceleration of the group RATES. Source: Haines (about 1982), section 15.1; Oldham (1977), 9.3.1.
module psalm_kalm
   use psalm_angles, only: degrees_of
   use psalm_check_list, only: list_input
   use psalm_data_set, only: data_set_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, motion_t, make_problem
   use psalm_finale, only: angle_text, describe_violation, describe_crossing
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_observable, only: at_origin
   use psalm_output_kind, only: motion_point, motion_distance, motion_pose
   use psalm_plan, only: step_point
   use psalm_rates, only: rates_t, prepare_rates, differentiate, output_rates, derivatives_of, is_dead, highest_order
   use psalm_run, only: devices_t, sum_up, header_of
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t, exit_violation
   use psalm_text, only: text_t, full_precision, general, lower_case, to_text
   use psalm_topology, only: topology_t, dimensions_t
   implicit none (type, external)
   private
   public :: run_kalm, in_time

   integer, parameter :: output_at_origin = -1 !! in place of a loop: the distance has no derivative
   integer, parameter :: most_told = 5 !! messages of one kind on standard error

   !> Derivatives of the output at all positions.
   type :: output_rates_t
      real(wp), allocatable :: d(:, :, :)           !! shape (3, components, positions): by the input
      real(wp), allocatable :: t(:, :, :)           !! shape (3, components, positions): by time
      integer, allocatable :: dead(:)               !! loop at a dead point, 0: none, or `output_at_origin`
   end type output_rates_t

contains

   !> Run a case that `check_case` found no fault with.
   subroutine run_kalm(set, devices)
      type(data_set_t), intent(in) :: set
      type(devices_t), intent(inout) :: devices
      type(diagnostics_t) :: findings
      type(topology_t) :: topology
      type(dimensions_t) :: dimensions
      type(problem_t) :: problem
      type(motion_t) :: motion
      type(output_rates_t) :: rates

      call set_up(set, topology, dimensions, findings)
      call make_problem(set, topology, dimensions, problem)
      call problem%want_derivatives(set%ktheta /= 0)
      call problem%analyse(dimensions, motion)
      call list_input(header_of('KALM', devices%mark), set, topology, dimensions, devices%eight)
      if (set%ktheta /= 0) then
         call devices%eight%add()
         call devices%eight%add(' ALL ARCS: LENGTH AND ANGLE, THEIR FIRST AND SECOND DERIVATIVES BY TIME (RADIANS)')
      end if
      call all_rates(set, problem, motion, rates, devices%eight)
      call list_rates(set, problem, motion, rates, devices%six)
      call write_table(set, problem, motion, rates, devices%nine)
      call note_trouble(set, problem, motion, rates, devices)
      if (devices%wants_summary) call sum_up(set, problem, dimensions, motion, devices)
   end subroutine run_kalm

   !> Derivatives by time from derivatives by the input that moves at a speed and an acceleration.
   pure function in_time(d, speed, accel) result(t)
      real(wp), intent(in) :: d(highest_order)  !! by the input
      real(wp), intent(in) :: speed, accel      !! of the input
      real(wp) :: t(highest_order)              !! by time

      t(1) = d(1)*speed
      t(2) = d(2)*speed**2 + d(1)*accel
      t(3) = d(3)*speed**3 + 3.0_wp*d(2)*speed*accel
   end function in_time

   subroutine all_rates(set, problem, motion, rates, device8)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(motion_t), intent(in) :: motion
      type(output_rates_t), intent(out) :: rates
      type(text_t), intent(inout) :: device8
      type(rates_t) :: block_rates
      integer :: block, offset, n, i, k, c, loop

      associate (m => problem%positions)
         allocate (rates%d(highest_order, problem%output%kind%components, m))
         allocate (rates%t(highest_order, problem%output%kind%components, m))
         allocate (rates%dead(m), source=0)
      end associate
      call prepare_rates(problem, block_rates)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, block_rates, n, highest_order)
         do i = 1, n
            k = offset + i
            call output_rates(problem, block_rates, i, highest_order, rates%d(:, :, k))
            do c = 1, problem%output%kind%components
               rates%t(:, c, k) = in_time(rates%d(:, c, k), set%speed, set%accel)
            end do
            do loop = problem%topology%nloop, 1, -1
               if (problem%linkage%step_of_loop(loop) == 0) cycle
               if (is_dead(problem, block_rates, loop, i)) rates%dead(k) = loop
            end do
            if (problem%motion == motion_distance .and. all(abs(rates%d(:, 1, k)) <= 0.0_wp)) then
               if (motion%actual(k, 1) <= at_origin*maxval(problem%given%arcl)) rates%dead(k) = output_at_origin
            end if
            if (set%ktheta /= 0) call list_position(set, problem, motion, block_rates, i, k, rates%dead(k), device8)
         end do
      end do
   end subroutine all_rates

   !> KTHETA: every arc and every joint at one position.
   subroutine list_position(set, problem, motion, rates, i, k, dead, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: i, k, dead
      type(text_t), intent(inout) :: text
      real(wp) :: x, y, length, angle(highest_order), slide(highest_order), px(highest_order), py(highest_order)
      integer :: loop, a, n, step
      character(:), allocatable :: name

      call text%add()
      call text%add(' INPUT'//general(motion%input(k)))
      if (.not. motion%closed(k) .or. dead /= 0) then
         call text%add(trim(merge(' DOES NOT CLOSE', ' DEAD POINT    ', .not. motion%closed(k))))
         return
      end if
      call text%add('  LOOP  ARC         LENGTH       VELOCITY   ACCELERATION          ANGLE       VELOCITY   ACCELERATION')
      do loop = 1, problem%topology%nloop
         do a = 1, problem%topology%loopl(loop)
            n = problem%topology%seq(loop, a)
            call problem%linkage%arc_at(problem%plan, n, i, x, y, length)
            slide = 0.0_wp
            if (problem%plan%length_slot(n) > 0) then
               slide = in_time(derivatives_of(rates, problem%linkage%slide(problem%plan%length_slot(n)), i)/problem%linkage%scale, &
                               set%speed, set%accel)
            end if
            angle = in_time(derivatives_of(rates, problem%linkage%root_x(problem%plan%root(n)), i), set%speed, set%accel)
            name = repeat(' ', 6 - len(to_text(loop)))//to_text(loop)//repeat(' ', 5 - len(to_text(a)))//to_text(a)
            call text%add(name//general(length)//general(slide(1))//general(slide(2))// &
                          general(degrees_of(x, y)*radians_per_degree)//general(angle(1))//general(angle(2)))
         end do
      end do
      call text%add('  JOINT AT THE END OF ARC     X              Y            VX             VY             AX             AY')
      do step = 1, size(problem%plan%steps)
         if (problem%plan%steps(step)%kind /= step_point) cycle
         associate (link => problem%linkage, point => problem%plan%steps(step)%to, arc => problem%plan%steps(step)%arc)
            px = in_time(derivatives_of(rates, link%point_x(point), i)/link%scale, set%speed, set%accel)
            py = in_time(derivatives_of(rates, link%point_y(point), i)/link%scale, set%speed, set%accel)
            loop = (arc - 1)/problem%topology%maxarc + 1
            name = ' LOOP '//to_text(loop)//' ARC '//to_text(arc - (loop - 1)*problem%topology%maxarc)
            call text%add(name//repeat(' ', max(1, 20 - len(name)))// &
                          general(link%store%v(i, link%point_x(point))/link%scale + problem%output%origin_x)// &
                          general(link%store%v(i, link%point_y(point))/link%scale + problem%output%origin_y)// &
                          general(px(1))//general(py(1))//general(px(2))//general(py(2)))
         end associate
      end do
   end subroutine list_position

   !> The listing: displacement, velocity, acceleration by time, velocity ratio and mechanical advantage.
   subroutine list_rates(set, problem, motion, rates, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(output_rates_t), intent(in) :: rates
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line, name
      integer :: k, c, order

      call text%add(' '//set%title)
      call text%add()
      line = trim(merge('LENGTH/S', 'RAD/S   ', problem%topology%sliding_input))
      name = ''
      if (.not. set%rates_given) then
         name = ' (NOT GIVEN: 1, CONSTANT)'
      else if (abs(set%accel) <= 0.0_wp) then
         name = ' (CONSTANT)'
      end if
      call text%add(' SPEED OF THE INPUT'//general(set%speed)//' '//line//name)
      if (abs(set%accel) > 0.0_wp) call text%add(' ACCELERATION OF THE INPUT'//general(set%accel)//' '//line//'**2')
      if (abs(set%accel) > 0.0_wp) call text%add(' THE SPEED IS THE SAME AT EVERY POSITION, THE ACCELERATION TOO')
      if (problem%output%kind%angle > 0) call text%add(' ANGLES IN DEGREES, THEIR RATES IN RADIANS')
      call text%add()
      line = merge('   INPUT LENGTH', '    CRANK ANGLE', problem%topology%sliding_input)
      if (problem%motion == motion_point) then
         line = line//'              X              Y             VX             VY             AX             AY          SPEED'
      else if (problem%motion == motion_pose) then
         line = line//'              X              Y          ANGLE             VX             VY        ANG.VEL.'// &
                '             AX             AY        ANG.ACC.          SPEED'
      else
         line = line//'         OUTPUT       VELOCITY   ACCELERATION           JERK VELOCITY RATIO MECH.ADVANTAGE'
      end if
      call text%add(line)
      do k = 1, size(motion%input)
         line = merge(general(motion%input(k)), angle_text(motion%input(k)), problem%topology%sliding_input)
         if (.not. motion%closed(k)) then
            line = line//'   DOES NOT CLOSE'
         else if (rates%dead(k) /= 0) then
            do c = 1, size(motion%actual, 2)
               line = line//general(motion%actual(k, c))
            end do
            line = line//'   '//dead_words(rates%dead(k))
         else if (size(motion%actual, 2) > 1) then
            do c = 1, size(motion%actual, 2)
               line = line//general(motion%actual(k, c))
            end do
            do order = 1, 2
               do c = 1, size(motion%actual, 2)
                  line = line//general(rates%t(order, c, k))
               end do
            end do
            line = line//general(hypotenuse(rates%t(1, 1, k), rates%t(1, 2, k)))
         else
            line = line//general(motion%actual(k, 1))//general(rates%t(1, 1, k))//general(rates%t(2, 1, k))// &
                   general(rates%t(3, 1, k))//general(rates%d(1, 1, k))
            if (abs(rates%d(1, 1, k)) > tiny(1.0_wp)**0.5_wp) then
               line = line//general(1.0_wp/rates%d(1, 1, k))
            else
               line = line//'       INFINITE'
            end if
         end if
         call text%add(line)
      end do
   end subroutine list_rates

   !> Device 9: the derivatives by the input and by time, 17 digits.
   subroutine write_table(set, problem, motion, rates, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(output_rates_t), intent(in) :: rates
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line, per
      integer :: k, c, order

      if (text%length > 0) then
         call text%add()
         call text%add()
      end if
      per = trim(merge('length', 'rad   ', problem%topology%sliding_input))
      line = '# input closed'
      do c = 1, size(motion%actual, 2)
         line = line//' actual'//trim(problem%output%kind%suffix(c))
      end do
      do order = 1, highest_order
         call name_columns(per, order)
      end do
      do order = 1, highest_order
         call name_columns('s', order)
      end do
      call text%add(line)
      call text%add('# '//set%title)
      call text%add('# derivatives per '//per//' of input and per second at input speed '//full_precision(set%speed)// &
                    ', acceleration '//full_precision(set%accel)//'; angles in degrees, their derivatives in radians')
      do k = 1, size(motion%input)
         line = full_precision(motion%input(k))//merge(' 1', ' 0', motion%closed(k))
         if (motion%closed(k)) then
            do c = 1, size(motion%actual, 2)
               line = line//' '//full_precision(motion%actual(k, c))
            end do
         else
            line = line//repeat(' NaN', size(motion%actual, 2))
         end if
         call add_values(rates%d(:, :, k))
         call add_values(rates%t(:, :, k))
         call text%add(line)
      end do

   contains

      subroutine name_columns(per, order)
         character(*), intent(in) :: per
         integer, intent(in) :: order
         character(:), allocatable :: power

         power = per
         if (order > 1) power = per//to_text(order)
         do c = 1, size(motion%actual, 2)
            if (size(motion%actual, 2) > 1) then
               line = line//' '//trim(problem%output%kind%suffix(c)(2:))//'_per_'//power
            else
               line = line//' actual_per_'//power
            end if
         end do
      end subroutine name_columns

      subroutine add_values(values)
         real(wp), intent(in) :: values(:, :)   !! shape (3, components)
         integer :: order
         logical :: known

         known = motion%closed(k) .and. rates%dead(k) == 0
         do order = 1, highest_order
            do c = 1, size(values, 2)
               line = line//' '//value_or_nan(values(order, c), known)
            end do
         end do
      end subroutine add_values
   end subroutine write_table

   pure function dead_words(dead) result(words)
      integer, intent(in) :: dead
      character(:), allocatable :: words

      if (dead == output_at_origin) then
         words = 'OUTPUT AT THE ORIGIN: RATES ARE NOT DEFINED'
      else
         words = 'DEAD POINT OF LOOP '//to_text(dead)//': RATES ARE INFINITE'
      end if
   end function dead_words

   pure function value_or_nan(value, known) result(text)
      real(wp), intent(in) :: value
      logical, intent(in) :: known
      character(:), allocatable :: text

      text = 'NaN'
      if (known) text = full_precision(value)
   end function value_or_nan

   !> Exit status 1 and remarks for open positions and dead points.
   subroutine note_trouble(set, problem, motion, rates, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(output_rates_t), intent(in) :: rates
      type(devices_t), intent(inout) :: devices
      integer :: k, told

      do k = 1, min(size(motion%crossings), most_told)
         call devices%notes%add(set%file//': '//trim(set%title)//': warning: '//describe_crossing(motion, motion%crossings(k)))
      end do
      if (.not. all(motion%closed)) then
         devices%code = max(devices%code, exit_violation)
         call devices%notes%add(set%file//': '//trim(set%title)//': the linkage does not close at '// &
                                to_text(count(.not. motion%closed))//' of '//to_text(size(motion%closed))//' positions')
         do k = 1, min(size(motion%violations), most_told)
            call devices%notes%add(set%file//':   '//describe_violation(problem, motion, motion%violations(k)))
         end do
      end if
      told = 0
      do k = 1, size(motion%input)
         if (rates%dead(k) == 0 .or. .not. motion%closed(k)) cycle
         devices%code = max(devices%code, exit_violation)
         told = told + 1
         if (told <= most_told) then
            call devices%notes%add(set%file//': '//trim(set%title)//': '//lower_case(dead_words(rates%dead(k)))// &
                                   ' at position '//to_text(k)//', input '//trim(adjustl(general(motion%input(k)))))
         end if
      end do
      if (told > most_told) call devices%notes%add(set%file//':   and '//to_text(told - most_told)//' more dead points')
   end subroutine note_trouble
end module psalm_kalm
