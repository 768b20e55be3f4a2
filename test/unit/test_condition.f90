!> Condition numbers against the derivatives by every dimension: never below what these make of one epsilon, nor far above.
!>
!> Source of the laws: the number is a bound of the first-order effect of a relative change of every dimension and of the
!> input (`doc/theory/positions.md`, Condition), carried along by absolute values. Away from dead points absolute values give
!> away a small factor in each loop.
program test_condition
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_condition, only: condition_t, prepare_condition, condition_at
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_output_kind, only: motion_point, motion_angle
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, find_jacobian
   implicit none (type, external)

   real(wp), parameter :: given_away(2) = [30.0_wp, 7.5_wp] !! largest bound over effect: several loops, one loop
   real(wp), parameter :: nothing = 1.0e-9_wp               !! an output below this has no relative error worth the name
   type(checks_t) :: t
   integer :: k

   do k = 1, size(names)
      call bound_of(names(k))
   end do
   call bound_of('dyad1_crank_rocker', near_toggle=1.0e-6_wp)
   call t%report()

contains

   subroutine bound_of(name, near_toggle)
      character(*), intent(in) :: name
      real(wp), intent(in), optional :: near_toggle !! what coupler and follower are longer than their outer joints are apart
      type(problem_t) :: problem
      type(data_set_t) :: set
      type(sensitivity_t) :: work
      type(motion_t) :: motion
      type(condition_t) :: condition
      real(wp), allocatable :: dout(:, :, :), values(:)
      real(wp) :: number, effect, least, most
      integer :: block, offset, n, i, loops

      call load_case(name, problem, set, vary=.true.)
      if (present(near_toggle)) then
         ! crank and frame in one line at the sixth position, 185 degrees on
         problem%given%crnki = -5.0_wp
         problem%given%arcl(4) = problem%given%arcl(2) + problem%given%arcl(3) - problem%given%arcl(1) - near_toggle
      end if
      call problem%want_derivatives(.false.)
      values = problem%parameters%first_values(problem%given)
      allocate (dout(problem%positions, size(values), problem%output%kind%components))
      call prepare_sensitivity(problem, work)
      call problem%analyse(problem%given, motion)
      call find_jacobian(problem, problem%given, work, dout)
      call prepare_condition(problem%linkage, condition)
      least = huge(least)
      most = 0.0_wp
      loops = count(problem%plan%solved)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call problem%output_of(n)
         do i = 1, n
            if (problem%motion /= motion_angle .and. abs(motion%actual(offset + i, 1)) < nothing*maxval(abs(motion%actual))) cycle
            call condition_at(problem, i, offset + i, condition, number)
            associate (k => offset + i)
               select case (problem%motion)
               case (motion_point)
                  effect = sum(hypot(dout(k, :, 1), dout(k, :, 2))*abs(values)) &
                           /hypot(motion%actual(k, 1), motion%actual(k, 2))
               case (motion_angle)
                  effect = sum(abs(dout(k, :, 1)*values))*radians_per_degree
               case default
                  effect = sum(abs(dout(k, :, 1)*values))/abs(motion%actual(k, 1))
               end select
            end associate
            least = min(least, number/(1.0_wp + effect))
            most = max(most, number/(1.0_wp + effect))
         end do
      end do
      call t%is_true(least >= 1.0_wp, trim(name)//': the condition number covers the effect of every dimension')
      call t%is_true(most <= given_away(merge(1, 2, loops > 1)), trim(name)//': it does not give away much')
   end subroutine bound_of
end program test_condition
