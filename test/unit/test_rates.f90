!> Derivatives by the input: against differences of positions, and in the differentiated loop equations.
!>
!> Runs in real64, and in real128 where differences are good to many more digits than are asked for.
program test_rates
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp, dp, radians_per_degree
   use psalm_observable, only: at_origin
   use psalm_output_kind, only: motion_point, motion_angle, motion_pose, motion_distance
   use psalm_rates, only: rates_t, prepare_rates, differentiate, output_rates, is_dead, highest_order
   implicit none (type, external)
   logical, parameter :: quad = precision(1.0_wp) > precision(1.0_dp)
   type(checks_t) :: t
   integer :: k

   do k = 1, size(names)
      call against_differences(names(k))
      call loop_equations(names(k))
   end do
   call against_differences('hard/chain64')
   do k = 1, 7
      call against_differences('hard/carried_slides', k)
      call loop_equations('hard/carried_slides', k)
   end do
   call pose_rates('needle')
   call pose_rates('dyad4_slider_crank')
   call known_rates()
   call dead_points()
   call hardly_a_link()
   call corner_of_distance()
   call t%report()

contains

   !> Central differences of sixth order of the output and its lower derivatives.
   subroutine against_differences(name, which)
      character(*), intent(in) :: name
      integer, intent(in), optional :: which    !! case of the file
      class(problem_t), allocatable :: problem
      type(problem_t) :: shifted
      class(data_set_t), allocatable :: set
      real(wp), allocatable :: values(:, :, :), x(:, :), y(:, :)
      real(wp) :: step, unit, worst(highest_order), size_of(highest_order), difference(2), tolerance
      integer :: i, k, n, order
      real(wp), parameter :: weight(3) = [0.75_wp, -0.15_wp, 1.0_wp/60.0_wp]

      allocate (problem, set)
      call load_case(name, problem, set, n=which)
      call problem%want_derivatives(.false.)
      n = min(problem%positions, problem%linkage%capacity)
      allocate (values(0:highest_order - 1, 2*n, -3:3), x(highest_order, n), y(highest_order, n))
      unit = merge(1.0_wp, radians_per_degree, problem%mechanism%sliding_input)
      step = merge(1.0e-4_wp, 1.0e-2_wp, quad)*merge(maxval(abs(problem%delt)), 1.0_wp, problem%mechanism%sliding_input)
      do k = -3, 3
         shifted = problem
         call shifted%set_inputs(problem%delt + real(k, wp)*step/unit)
         call shifted%want_derivatives(.false.)
         call take(shifted, n, values(:, :, k))
      end do
      call take_rates(problem, n, x, y)
      worst = 0.0_wp
      size_of = 0.0_wp
      do order = 1, highest_order
         do i = 1, n
            difference = 0.0_wp
            do k = 1, 3
               associate (ahead => values(order - 1, 2*i - 1:2*i, k), behind => values(order - 1, 2*i - 1:2*i, -k))
                  if (order == 1 .and. problem%motion == motion_angle) then
                     difference(1) = difference(1) + weight(k)*near(ahead(1) - behind(1))
                  else
                     difference = difference + weight(k)*(ahead - behind)
                  end if
               end associate
            end do
            difference = difference/step
            worst(order) = max(worst(order), abs(difference(1) - x(order, i)), abs(difference(2) - y(order, i)))
            size_of(order) = max(size_of(order), abs(x(order, i)), abs(y(order, i)))
         end do
         tolerance = merge(1.0e-9_wp, 2.0e-5_wp, quad)
         call t%close_to(worst(order)/size_of(order), 0.0_wp, tolerance, trim(name)//': derivative against differences')
      end do
   end subroutine against_differences

   pure real(wp) function near(angle)
      real(wp), intent(in) :: angle

      near = atan2(sin(angle), cos(angle))
   end function near

   !> Output and its first two derivatives at every position.
   subroutine take(problem, n, values)
      type(problem_t), intent(inout) :: problem
      integer, intent(in) :: n
      real(wp), intent(out) :: values(0:, :)
      type(rates_t) :: rates
      real(wp) :: d(highest_order, problem%output%kind%components)
      integer :: offset, m, i, c

      call prepare_rates(problem, rates)
      call problem%bind(problem%given)
      call problem%solve_block(1, offset, m)
      call problem%output_of(m)
      call differentiate(problem, rates, m, highest_order)
      do i = 1, n
         call output_rates(problem, rates, i, highest_order, d)
         values(:, 2*i) = 0.0_wp
         do c = 1, size(d, 2)
            values(0, 2*i - 2 + c) = problem%output%actual(c, i, problem%linkage)
            if (c == problem%output%kind%angle) values(0, 2*i - 2 + c) = values(0, 2*i - 2 + c)*radians_per_degree
            values(1:2, 2*i - 2 + c) = d(1:2, c)
         end do
      end do
   end subroutine take

   subroutine take_rates(problem, n, x, y)
      type(problem_t), intent(inout) :: problem
      integer, intent(in) :: n
      real(wp), intent(out) :: x(:, :), y(:, :)
      type(rates_t) :: rates
      real(wp) :: d(highest_order, problem%output%kind%components)
      integer :: offset, m, i

      call prepare_rates(problem, rates)
      call problem%bind(problem%given)
      call problem%solve_block(1, offset, m)
      call differentiate(problem, rates, m, highest_order)
      do i = 1, n
         call output_rates(problem, rates, i, highest_order, d)
         x(:, i) = d(:, 1)
         y(:, i) = 0.0_wp
         if (size(d, 2) > 1) y(:, i) = d(:, 2)
      end do
   end subroutine take_rates

   !> The first and second derivative of the sum of a loop's arcs is zero.
   subroutine loop_equations(name, which)
      character(*), intent(in) :: name
      integer, intent(in), optional :: which    !! case of the file
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(rates_t) :: rates
      real(wp) :: sum1(2), sum2(2), x, y, length, w1, w2, l1, l2, worst, size_of
      integer :: offset, n, i, loop, a, arc, root, slide

      allocate (problem, set)
      call load_case(name, problem, set, n=which, everything=.true.)
      call problem%want_derivatives(.true.)
      call prepare_rates(problem, rates)
      call problem%bind(problem%given)
      call problem%solve_block(1, offset, n)
      call differentiate(problem, rates, n, 2)
      worst = 0.0_wp
      do i = 1, n
         do loop = 1, problem%mechanism%nloop
            sum1 = 0.0_wp
            sum2 = 0.0_wp
            size_of = 0.0_wp
            do a = 1, problem%mechanism%loops(loop)%arcs
               arc = problem%mechanism%seq(loop, a)
               call problem%linkage%arc_at(problem%plan, arc, i, x, y, length)
               root = problem%linkage%root_x(problem%plan%root(arc))
               w1 = rates%d(1)%v(i, root)
               w2 = rates%d(2)%v(i, root)
               l1 = 0.0_wp
               l2 = 0.0_wp
               if (problem%plan%length_slot(arc) > 0) then
                  slide = problem%linkage%slide(problem%plan%length_slot(arc))
                  l1 = rates%d(1)%v(i, slide)
                  l2 = rates%d(2)%v(i, slide)
               end if
               sum1 = sum1 + l1*[x, y] + w1*length*[-y, x]
               sum2 = sum2 + (l2 - w1*w1*length)*[x, y] + (2.0_wp*w1*l1 + w2*length)*[-y, x]
               size_of = size_of + abs(l2) + w1*w1*abs(length) + abs(2.0_wp*w1*l1) + abs(w2*length) + abs(l1) + abs(w1*length)
            end do
            worst = max(worst, maxval(abs(sum1))/size_of, maxval(abs(sum2))/size_of)
         end do
      end do
      ! relative to the sum of the terms: far inside 64 epsilon times the condition number
      call t%close_to(worst/epsilon(1.0_wp), 0.0_wp, 64.0_wp, trim(name)//': differentiated loop equations')
   end subroutine loop_equations

   !> A pose is the output point and the angle of the output arc: values and derivatives are those of the two, bit for bit.
   subroutine pose_rates(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: pose, alone
      class(data_set_t), allocatable :: set
      type(motion_t) :: whole, part
      type(rates_t) :: rates
      real(wp), allocatable :: d(:, :, :), one(:, :, :)
      integer :: kind, n

      allocate (pose, alone, set)
      call load_case(name, pose, set, motion=motion_pose)
      n = pose%positions
      allocate (d(highest_order, 3, n))
      call pose%want_derivatives(.false.)
      pose%desired = .false.
      call pose%analyse(pose%given, whole)
      call take_all(pose, rates, d)
      do kind = motion_point, motion_angle
         call load_case(name, alone, set, motion=kind)
         call alone%want_derivatives(.false.)
         alone%desired = .false.
         call alone%analyse(alone%given, part)
         allocate (one(highest_order, alone%output%kind%components, n))
         call take_all(alone, rates, one)
         if (kind == motion_point) then
            call t%is_true(all(abs(whole%actual(:, :2) - part%actual) <= 0.0_wp), trim(name)//': the point of a pose')
            call t%is_true(all(abs(d(:, :2, :) - one) <= 0.0_wp), trim(name)//': derivatives of the point of a pose')
         else
            call t%is_true(all(abs(whole%actual(:, 3) - part%actual(:, 1)) <= 0.0_wp), trim(name)//': the angle of a pose')
            call t%is_true(all(abs(d(:, 3, :) - one(:, 1, :)) <= 0.0_wp), trim(name)//': derivatives of the angle of a pose')
         end if
         deallocate (one)
      end do
   end subroutine pose_rates

   !> Derivatives of all components at the positions of the first block.
   subroutine take_all(problem, rates, d)
      type(problem_t), intent(inout) :: problem
      type(rates_t), intent(out) :: rates
      real(wp), intent(out) :: d(:, :, :)
      integer :: offset, m, i

      d = 0.0_wp
      call prepare_rates(problem, rates)
      call problem%bind(problem%given)
      call problem%solve_block(1, offset, m)
      call differentiate(problem, rates, m, highest_order)
      do i = 1, m
         call output_rates(problem, rates, i, highest_order, d(:, :, i))
      end do
   end subroutine take_all

   subroutine known_rates()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      real(wp), allocatable :: x(:, :), y(:, :), a(:)
      integer :: n

      call load_case('dyad6_scotch_yoke', problem, set)
      call problem%want_derivatives(.false.)
      n = problem%positions
      allocate (x(3, n), y(3, n))
      call take_rates(problem, n, x, y)
      a = problem%delt*radians_per_degree
      call t%close_to(maxval(abs(x(1, :) + 40.0_wp*sin(a))), 0.0_wp, 1.0e-13_wp, 'Scotch yoke: velocity')
      call t%close_to(maxval(abs(x(2, :) + 40.0_wp*cos(a))), 0.0_wp, 1.0e-13_wp, 'Scotch yoke: acceleration')
      call t%close_to(maxval(abs(x(3, :) - 40.0_wp*sin(a))), 0.0_wp, 1.0e-13_wp, 'Scotch yoke: jerk')
      call load_case('actuator_rapson_slide', problem, set)
      call problem%want_derivatives(.false.)
      n = problem%positions
      call take_rates(problem, n, x, y)
      a = problem%delt
      call t%close_to(maxval(abs(x(1, :n) + 500.0_wp/(a**2 + 500.0_wp**2))), 0.0_wp, 1.0e-15_wp, 'Rapson slide: velocity')
      call t%close_to(maxval(abs(x(2, :n) - 1000.0_wp*a/(a**2 + 500.0_wp**2)**2)), 0.0_wp, 1.0e-17_wp, &
                      'Rapson slide: acceleration')
   end subroutine known_rates

   !> At a dead point the rates are infinite: reported, finite numbers, no trap.
   subroutine dead_points()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(rates_t), save :: rates
      integer :: offset, n, i

      call load_case('hard/parallelogram', problem, set)
      call problem%want_derivatives(.false.)
      call prepare_rates(problem, rates)
      call problem%bind(problem%given)
      call problem%solve_block(1, offset, n)
      call differentiate(problem, rates, n, highest_order)
      do i = 1, n
         ! a millionth of a degree beside it is a dead point to the rounding of real64
         if (.not. quad .and. (i == 3 .or. i == 5)) cycle
         call t%is_true(is_dead(problem, rates, 1, i) .eqv. (i == 4 .or. i == 11), 'only the change points are dead points')
      end do
      call t%is_true(all([(all(abs(rates%d(i)%v) <= huge(1.0_wp)), i=1, highest_order)]), 'numbers stay finite at a dead point')
   end subroutine dead_points

   !> A pair of links that does not close because one is hardly any: its rates mean nothing, but the arithmetic goes on.
   subroutine hardly_a_link()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(rates_t), save :: rates
      integer :: offset, n, i

      call load_case('dyad1_crank_rocker', problem, set)
      call problem%want_derivatives(.false.)
      call prepare_rates(problem, rates)
      problem%given%arcl(2) = 1.0e-150_wp
      call problem%bind(problem%given)
      call problem%solve_block(1, offset, n)
      call differentiate(problem, rates, n, highest_order)
      call t%is_true(all([(all(abs(rates%d(i)%v) <= huge(1.0_wp)), i=1, highest_order)]), 'numbers stay finite by hardly a link')
   end subroutine hardly_a_link

   !> A distance that is rounding of the long arm it is measured by has no rate; ten times as far off it has.
   subroutine corner_of_distance()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(motion_t), save :: motion
      real(wp), parameter :: arm = 1.0e6_wp, part(2) = [0.1_wp, 10.0_wp]
      integer, parameter :: here = 3
      real(wp), allocatable :: x(:, :), y(:, :)
      real(wp) :: away, upwards
      integer :: k

      do k = 1, size(part)
         ! the point at the end of the arm, straight above at one position
         call load_case('dyad1_crank_rocker', problem, set, motion=motion_angle)
         problem%given%outlk = arm
         call problem%analyse(problem%given, motion)
         upwards = problem%given%outang + 90.0_wp - motion%actual(here, 1)
         call load_case('dyad1_crank_rocker', problem, set, motion=motion_point)
         problem%given%outlk = arm
         problem%given%outang = upwards
         call problem%analyse(problem%given, motion)
         away = part(k)*at_origin*2.0_wp*arm
         call load_case('dyad1_crank_rocker', problem, set, motion=motion_distance)
         problem%given%outlk = arm
         problem%given%outang = upwards
         associate (px => motion%actual(here, 1), py => motion%actual(here, 2) - away)
            problem%given%origlk = hypot(px, py)
            problem%given%origng = atan2(-py, -px)/radians_per_degree
         end associate
         call problem%want_derivatives(.false.)
         allocate (x(highest_order, problem%positions), y(highest_order, problem%positions))
         call take_rates(problem, problem%positions, x, y)
         call t%is_true(all(abs(x(:, here)) <= 0.0_wp) .eqv. k == 1, 'rates of a distance that is rounding')
         deallocate (x, y)
      end do
   end subroutine corner_of_distance
end program test_rates
