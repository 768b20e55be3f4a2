!> Least squares from many starts: constraints and their derivatives, published problems, the same answer for all threads.
program test_lsq
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp
   use psalm_linear, only: solve_positive
   use psalm_margins, only: inspector_t, margin_t, prepare_inspector, inspect, is_violated
   use psalm_search, only: result_t, search_many
   use psalm_solver_kind, only: find_solver
   use psalm_stop, only: stop_t
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, find_jacobian, block_constraints
   use psalm_text, only: to_text
   use psalm_dimensions, only: dimensions_t
   implicit none (type, external)
   type(checks_t) :: t
   integer :: k

   call equations()
   do k = 1, size(names)
      call constraint_derivatives(names(k))
   end do
   call published('needle', 1, 1.49_wp)
   call published('needle', 60, 0.4467_wp)
   call published('suspension', 4, 1.0e-6_wp)
   call published('chain_short', 1, 0.25423_wp)
   call published('chain_long', 1, 0.21607_wp)
   call published('brake_reaction', 8, 28.54_wp)
   call bounds()
   call threads()
   call t%report()

contains

   !> A search from the linkage of the data set.
   subroutine search(set, problem, threads, found)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: threads
      type(result_t), intent(out) :: found
      type(stop_t) :: never
      real(wp) :: none(size(problem%parameters%variables), 0)

      call search_many(set, problem, problem%parameters%first_values(problem%given), none, threads, never, found)
   end subroutine search

   subroutine equations()
      real(wp) :: x(2)
      logical :: valid

      call solve_positive(reshape([4.0_wp, 1.0_wp, 1.0_wp, 3.0_wp], [2, 2]), [1.0_wp, 2.0_wp], x, valid)
      call t%is_true(valid, 'a positive definite system')
      call t%close_to(x(1), 1.0_wp/11.0_wp, 1.0e-14_wp, 'its first unknown')
      call t%close_to(x(2), 7.0_wp/11.0_wp, 1.0e-14_wp, 'its second unknown')
      call solve_positive(reshape([1.0_wp, 2.0_wp, 2.0_wp, 1.0_wp], [2, 2]), [1.0_wp, 2.0_wp], x, valid)
      call t%is_true(.not. valid, 'a matrix that is not positive definite is told')
   end subroutine equations

   !> Derivatives of the constraints against central differences.
   subroutine constraint_derivatives(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(sensitivity_t) :: work
      type(dimensions_t) :: dimensions
      real(wp), allocatable :: dout(:, :, :), dk(:, :, :), ahead(:, :), behind(:, :), values(:), changed(:)
      real(wp) :: step, worst, size_of
      integer :: v, nvar

      allocate (problem, set)
      call load_case(name, problem, set, vary=.true.)
      call problem%want_derivatives(.false.)
      nvar = size(problem%parameters%variables)
      associate (n => problem%positions, loops => problem%mechanism%nloop)
         allocate (dout(n, nvar, problem%output%kind%components), dk(n, loops, nvar))
         allocate (ahead(n, loops), behind(n, loops))
      end associate
      call prepare_sensitivity(problem, work)
      call find_jacobian(problem, problem%given, work, dout, dk)
      values = problem%parameters%first_values(problem%given)
      worst = 0.0_wp
      size_of = max(maxval(abs(dk)), 1.0e-3_wp)
      do v = 1, nvar
         step = 1.0e-5_wp*max(1.0_wp, 0.1_wp*abs(values(v)))
         changed = values
         changed(v) = values(v) + step
         dimensions = problem%given
         call problem%parameters%apply(changed, dimensions)
         call problem%bind(dimensions)
         call find_constraints(problem, ahead)
         changed(v) = values(v) - step
         call problem%parameters%apply(changed, dimensions)
         call problem%bind(dimensions)
         call find_constraints(problem, behind)
         worst = max(worst, maxval(abs((ahead - behind)/(2.0_wp*step) - dk(:, :, v))))
      end do
      call t%close_to(worst/size_of, 0.0_wp, 1.0e-6_wp, trim(name)//': derivatives of the constraints')
   end subroutine constraint_derivatives

   !> How near each dyad is to its limit, at every position of the linkage that is bound.
   subroutine find_constraints(problem, k)
      type(problem_t), intent(inout) :: problem
      real(wp), intent(out) :: k(:, :)              !! shape (positions, nloop)
      integer :: block, offset, n

      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call block_constraints(problem, n, k(offset + 1:offset + n, :))
      end do
   end subroutine find_constraints

   !> The search reaches the value and breaks no constraint.
   subroutine published(name, starts, value)
      character(*), intent(in) :: name
      integer, intent(in) :: starts
      real(wp), intent(in) :: value
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(result_t) :: found
      type(dimensions_t) :: dimensions
      type(motion_t) :: motion
      class(inspector_t), allocatable :: inspector
      type(margin_t), allocatable :: margins(:)
      character(:), allocatable :: label

      allocate (problem, set, inspector)
      label = name//', '//to_text(starts)//' starts: '
      call load_case(name, problem, set)
      set%search%solver = find_solver('LSQ')
      set%search%nstart = starts
      call search(set, problem, 1, found)
      call t%is_true(size(found%best) == 1, label//'a linkage is found')
      if (size(found%best) < 1) return
      call t%is_true(found%best(1)%objective <= value, label//'as good as '//to_text(nint(1.0e6_wp*value))//'e-6')
      dimensions = problem%given
      call problem%parameters%apply(found%best(1)%values, dimensions)
      call problem%analyse(dimensions, motion)
      call t%equal_integer(size(motion%violations), 0, label//'no constraint is violated')
      call t%close_to(motion%total, found%best(1)%objective, 1.0e-10_wp, label//'analysis and search agree')
      call prepare_inspector(set, problem, .true., inspector)
      call inspect(inspector, dimensions, problem%delt, margins)
      call t%is_true(.not. any(is_violated(margins)), label//'no margin is negative')
      call t%is_true(all(dimensions%arcl >= 0.0_wp), label//'lengths are positive')
   end subroutine published

   subroutine bounds()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(result_t) :: found

      allocate (problem, set)
      call load_case('chain_short', problem, set)
      set%search%solver = find_solver('LSQ')
      set%limits%limval = 1
      set%limits%oplow(:2) = [320.0_wp, 70.0_wp]
      set%limits%ophigh(:2) = [330.0_wp, 72.0_wp]
      call search(set, problem, 1, found)
      call t%is_true(size(found%best) == 1, 'within bounds: a linkage is found')
      call t%close_to(found%best(1)%values(1), 330.0_wp - set%limits%stepin, 1.0e-9_wp, 'the best lies at the bound')
      call t%is_true(found%best(1)%values(2) > 70.0_wp .and. found%best(1)%values(2) < 72.0_wp, 'and within the other')
   end subroutine bounds

   subroutine threads()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(result_t) :: one, two
      integer :: i

      allocate (problem, set)
      call load_case('path18', problem, set)
      set%search%solver = find_solver('LSQ')
      set%search%nstart = 21
      set%search%nbest = 5
      call search(set, problem, 1, one)
      call search(set, problem, 3, two)
      call t%equal_integer(size(two%best), size(one%best), 'as many linkages for any number of threads')
      do i = 1, size(one%best)
         call t%is_true(all(abs(one%best(i)%values - two%best(i)%values) <= 0.0_wp), 'the same linkages for any number of threads')
         if (i > 1) call t%is_true(one%best(i)%objective >= one%best(i - 1)%objective, 'ranked by objective')
      end do
      call t%is_true(size(one%best) > 1, 'several linkages are kept')
      set%search%maxtime = 1.0e-9_wp
      call search(set, problem, 1, one)
      call t%is_true(one%out_of_time .and. one%starts == 0 .and. one%next == 1, 'MAXTIME ends the search and tells where to go on')
   end subroutine threads
end program test_lsq
