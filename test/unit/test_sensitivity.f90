!> The Jacobian against differences of positions, for every kind of variable.
program test_sensitivity
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp, dp
   use psalm_output_kind, only: motion_pose
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, find_jacobian
   use psalm_text, only: to_text
   use psalm_dimensions, only: dimensions_t
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
   call one_case('needle', .true., motion_pose)
   call one_case('dyad4_slider_crank', .true., motion_pose)
   do k = 1, 7
      call one_case('hard/carried_slides', .true., n=k)
   end do
   call t%is_true(all(met), 'every kind of variable was tried')
   call t%report()

contains

   subroutine one_case(name, vary, motion_wanted, n)
      character(*), intent(in) :: name
      logical, intent(in) :: vary
      integer, intent(in), optional :: motion_wanted   !! in place of MOTION
      integer, intent(in), optional :: n               !! case of the file
      type(problem_t) :: problem
      type(data_set_t) :: set
      type(sensitivity_t) :: work
      type(motion_t) :: motion
      real(wp), allocatable :: dout(:, :, :), values(:)
      real(wp) :: tolerance, worst
      integer :: v, nvar

      if (vary) then
         call load_case(name, problem, set, n=n, vary=.true., motion=motion_wanted)
      else
         call load_case(name, problem, set)
      end if
      call problem%want_derivatives(.false.)
      nvar = size(problem%parameters%variables)
      met(problem%parameters%variables%kind) = .true.
      allocate (dout(problem%positions, nvar, problem%output%kind%components))
      call prepare_sensitivity(problem, work)
      values = problem%parameters%first_values(problem%given)
      call problem%analyse(problem%given, motion)
      if (.not. all(motion%closed)) then
         call t%is_true(name == 'suspension', trim(name)//': closes')
         return
      end if
      call find_jacobian(problem, problem%given, work, dout)
      tolerance = merge(1.0e-9_wp, 1.0e-6_wp, quad)
      do v = 1, nvar
         call difference(problem, values, v, dout(:, v, :), worst)
         call t%close_to(worst, 0.0_wp, tolerance, trim(name)//': Jacobian of variable '//to_text(v)//', kind '// &
                         to_text(problem%parameters%variables(v)%kind))
      end do
   end subroutine one_case

   !> Worst difference between a column of the Jacobian and central differences of fourth order, relative to its largest entry.
   subroutine difference(problem, values, v, dout, worst)
      type(problem_t), intent(inout) :: problem
      real(wp), intent(in) :: values(:)
      integer, intent(in) :: v
      real(wp), intent(in) :: dout(:, :)
      real(wp), intent(out) :: worst
      type(motion_t) :: motion(-2:2)
      type(dimensions_t) :: dimensions
      real(wp) :: changed(size(values)), step
      real(wp), allocatable :: expected(:)
      integer :: k, c

      step = merge(1.0e-6_wp, 1.0e-3_wp, quad)*max(1.0_wp, 0.1_wp*abs(values(v)))
      do k = -2, 2
         changed = values
         changed(v) = values(v) + real(k, wp)*step
         dimensions = problem%given
         call problem%parameters%apply(changed, dimensions)
         call problem%analyse(dimensions, motion(k))
      end do
      worst = 0.0_wp
      do c = 1, size(dout, 2)
         expected = (8.0_wp*apart(problem, c, motion(1)%actual(:, c), motion(-1)%actual(:, c)) &
                     - apart(problem, c, motion(2)%actual(:, c), motion(-2)%actual(:, c)))/(12.0_wp*step)
         worst = max(worst, maxval(abs(expected - dout(:, c))))
      end do
      worst = worst/max(maxval(abs(dout)), 1.0e-3_wp)
   end subroutine difference

   !> Difference of two rows of outputs; of angles to the nearest turn.
   function apart(problem, component, a, b) result(d)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: component
      real(wp), intent(in) :: a(:), b(:)
      real(wp) :: d(size(a))

      d = a - b
      if (component == problem%output%kind%angle) d = d - 360.0_wp*anint(d/360.0_wp)
   end function apart
end program test_sensitivity
