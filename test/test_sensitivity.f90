!> Jacobian and gradient: against differences of positions, and against each other, for every kind of variable.
program test_sensitivity
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_data_set, only: data_set_t, motion_point, motion_angle
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp, dp
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, find_jacobian, find_gradient
   use psalm_text, only: to_text
   use psalm_topology, only: dimensions_t
   implicit none (type, external)
   logical, parameter :: quad = precision(1.0_wp) > precision(1.0_dp)
   type(checks_t) :: t
   logical :: met(7) = .false. !! kinds of variables met
   integer :: k

   do k = 1, size(names)
      call one_case(names(k), .true.)
   end do
   call one_case('needle', .false.)
   call one_case('suspension', .true.)
   call t%is_true(all(met), 'every kind of variable was tried')
   call t%report()

contains

   subroutine one_case(name, vary)
      character(*), intent(in) :: name
      logical, intent(in) :: vary
      type(problem_t) :: problem
      type(data_set_t) :: set
      type(sensitivity_t) :: work
      type(motion_t) :: motion
      real(wp), allocatable :: dx(:, :), dy(:, :), gradient(:), values(:)
      real(wp) :: objective, expected, size_of, tolerance, worst
      integer :: v, marble

      if (vary) then
         call load_case(name, problem, set, vary=.true.)
      else
         call load_case(name, problem, set)
      end if
      call problem%want_derivatives(.false.)
      marble = size(problem%topology%variables)
      met(problem%topology%variables%kind) = .true.
      allocate (dx(problem%positions, marble), dy(problem%positions, marble), gradient(marble))
      call prepare_sensitivity(problem, work)
      values = problem%topology%first_values(problem%given)
      call problem%analyse(problem%given, motion)
      if (.not. all(motion%closed)) then
         call t%is_true(name == 'suspension', trim(name)//': closes')
         return
      end if
      call find_jacobian(problem, problem%given, work, dx, dy)
      call find_gradient(problem, problem%given, work, objective, gradient)
      call t%close_to(objective, motion%total, 1.0e-12_wp, trim(name)//': the gradient''s objective is that of the listing')
      tolerance = merge(1.0e-9_wp, 1.0e-6_wp, quad)
      do v = 1, marble
         call difference(problem, values, v, dx(:, v), dy(:, v), worst)
         call t%close_to(worst, 0.0_wp, tolerance, trim(name)//': Jacobian of variable '//to_text(v)//', kind '// &
                         to_text(problem%topology%variables(v)%kind))
         associate (n => problem%positions)
            expected = -2.0_wp*sum(problem%weight(:n)*motion%error*dx(:, v))
            size_of = 2.0_wp*sum(abs(problem%weight(:n)*motion%error*dx(:, v)))
            if (problem%motion == motion_point) then
               expected = expected - 2.0_wp*sum(problem%weight_y(:n)*motion%error_y*dy(:, v))
               size_of = size_of + 2.0_wp*sum(abs(problem%weight_y(:n)*motion%error_y*dy(:, v)))
            end if
         end associate
         call t%close_to((gradient(v) - expected)/max(size_of, 1.0e-3_wp), 0.0_wp, 1.0e-11_wp, &
                         trim(name)//': gradient and Jacobian agree, variable '//to_text(v))
      end do
   end subroutine one_case

   !> Worst difference between a column of the Jacobian and central differences of fourth order, relative to its largest entry.
   subroutine difference(problem, values, v, dx, dy, worst)
      type(problem_t), intent(inout) :: problem
      real(wp), intent(in) :: values(:)
      integer, intent(in) :: v
      real(wp), intent(in) :: dx(:), dy(:)
      real(wp), intent(out) :: worst
      type(motion_t) :: motion(-2:2)
      type(dimensions_t) :: dimensions
      real(wp) :: changed(size(values)), step
      real(wp), allocatable :: nx(:), ny(:)
      integer :: k

      step = merge(1.0e-6_wp, 1.0e-3_wp, quad)*max(1.0_wp, 0.1_wp*abs(values(v)))
      do k = -2, 2
         changed = values
         changed(v) = values(v) + real(k, wp)*step
         dimensions = problem%given
         call problem%topology%apply(changed, dimensions)
         call problem%analyse(dimensions, motion(k))
      end do
      nx = (8.0_wp*apart(problem, motion(1)%actual, motion(-1)%actual) &
            - apart(problem, motion(2)%actual, motion(-2)%actual))/(12.0_wp*step)
      ny = (8.0_wp*(motion(1)%actual_y - motion(-1)%actual_y) - (motion(2)%actual_y - motion(-2)%actual_y))/(12.0_wp*step)
      worst = maxval(abs(nx - dx))
      if (problem%motion == motion_point) worst = max(worst, maxval(abs(ny - dy)))
      worst = worst/max(maxval(abs(dx)), maxval(abs(dy)), 1.0e-3_wp)
   end subroutine difference

   !> Difference of two rows of outputs; of angles to the nearest turn.
   function apart(problem, a, b) result(d)
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: a(:), b(:)
      real(wp) :: d(size(a))

      d = a - b
      if (problem%motion == motion_angle) d = d - 360.0_wp*anint(d/360.0_wp)
   end function apart
end program test_sensitivity
