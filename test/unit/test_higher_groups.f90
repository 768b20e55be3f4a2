!> Larger groups against dyads: every dyad solved as a group by Newton's method gives the positions, rates and derivatives that its
!> closed form gives.
program test_higher_groups
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_angles, only: degrees_of
   use psalm_condition, only: condition_t, prepare_condition, condition_at
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_dyad_kind, only: assur_higher
   use psalm_error, only: problem_t, motion_t, make_problem
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, ring_t, arc_link, arc_slide
   use psalm_rates, only: rates_t, prepare_rates, differentiate, output_rates, highest_order
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, find_jacobian, block_constraints
   use psalm_text, only: to_text
   implicit none (type, external)
   type(checks_t) :: t
   integer :: k

   do k = 1, size(names)
      call one_case(names(k))
   end do
   call one_case('suspension')
   do k = 1, 7
      call one_case('hard/carried_slides', n=k)
   end do
   call t%report()

contains

   subroutine one_case(name, n)
      character(*), intent(in) :: name
      integer, intent(in), optional :: n           !! case of the file
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: dyads, groups
      type(motion_t) :: by_dyads, by_groups
      type(mechanism_t) :: mechanism
      type(dimensions_t) :: dimensions
      character(:), allocatable :: what
      integer :: near
      real(wp) :: size_of

      allocate (set, dyads, groups)
      what = trim(name)
      if (present(n)) what = what//' '//to_text(n)
      call load_case(name, dyads, set, n=n, everything=.true., vary=.true.)
      call dyads%analyse(dyads%given, by_dyads)
      near = minloc(abs(dyads%delt), dim=1, mask=by_dyads%closed)
      if (near == 0) return
      mechanism = dyads%mechanism
      dimensions = dyads%given
      call draw(dyads, near, mechanism, dimensions)
      call make_problem(set, mechanism, dimensions, dyads%parameters, groups)
      call groups%analyse(dimensions, by_groups)
      size_of = maxval(abs(by_dyads%actual)) + maxval(dimensions%arcl)
      ! where dyads close again beyond a dead point a group does not follow
      call t%is_true(all(by_dyads%closed .or. .not. by_groups%closed), what//': a group closes where its dyad does')
      ! the crank of the textile linkage passes a change point, where a group stops
      if (all(by_dyads%closed) .and. name /= 'textile') call t%is_true(all(by_groups%closed), what//': it closes everywhere', &
                                               to_text(count(by_groups%closed))//' of '//to_text(size(by_groups%closed)))
      call t%close_to(maxval(abs(by_groups%actual - by_dyads%actual), mask=spread(by_groups%closed, 2, size(by_dyads%actual, 2))), &
                      0.0_wp, 1.0e-9_wp*size_of, what//': the same positions')
      if (.not. all(by_groups%closed)) return
      call compare_rates(dyads, groups, dimensions, what)
      call compare_condition(dyads, groups, dimensions, what)
      call compare_derivatives(dyads, groups, dimensions, what)
   end subroutine one_case

   !> Make every dyad a group, drawn at one of the positions.
   subroutine draw(problem, position, mechanism, dimensions)
      type(problem_t), intent(inout) :: problem
      integer, intent(in) :: position
      type(mechanism_t), intent(inout) :: mechanism
      type(dimensions_t), intent(inout) :: dimensions
      real(wp) :: x, y, length
      integer :: block, offset, n, loop, j

      block = (position - 1)/problem%linkage%capacity + 1
      call problem%solve_block(block, offset, n)
      dimensions%anchor = dimensions%crnki + problem%delt(position)
      do loop = 1, mechanism%nloop
         associate (group => mechanism%groups(loop), of => mechanism%loops(loop))
            group%kind = assur_higher
            of%rings = [ring_t(of%first, group%members(1), of%first + of%arcs - 1)]
            do j = 1, size(group%members)
               call problem%linkage%arc_at(problem%plan, group%members(j), position - offset, x, y, length)
               if (mechanism%arcs(group%members(j))%kind == arc_link) dimensions%gama(group%members(j)) = degrees_of(x, y)
               if (mechanism%arcs(group%members(j))%kind == arc_slide) dimensions%arcl(group%members(j)) = length
            end do
         end associate
      end do
   end subroutine draw

   subroutine compare_rates(dyads, groups, dimensions, what)
      type(problem_t), intent(inout) :: dyads, groups
      type(dimensions_t), intent(in) :: dimensions
      character(*), intent(in) :: what
      type(rates_t), allocatable :: one, other
      real(wp) :: a(highest_order, dyads%output%kind%components), b(highest_order, dyads%output%kind%components), worst, largest
      integer :: offset, n, i

      allocate (one, other)
      call prepare_rates(dyads, one)
      call prepare_rates(groups, other)
      call dyads%bind(dyads%given)
      call groups%bind(dimensions)
      call dyads%solve_block(1, offset, n)
      call groups%solve_block(1, offset, n)
      call differentiate(dyads, one, n, highest_order)
      call differentiate(groups, other, n, highest_order)
      worst = 0.0_wp
      largest = 1.0_wp
      do i = 1, n
         call output_rates(dyads, one, i, highest_order, a)
         call output_rates(groups, other, i, highest_order, b)
         largest = max(largest, maxval(abs(a)))
         worst = max(worst, maxval(abs(a - b)))
      end do
      call t%close_to(worst, 0.0_wp, 1.0e-8_wp*largest, what//': the same rates')
   end subroutine compare_rates

   subroutine compare_condition(dyads, groups, dimensions, what)
      type(problem_t), intent(inout) :: dyads, groups
      type(dimensions_t), intent(in) :: dimensions
      character(*), intent(in) :: what
      type(condition_t) :: one, other
      real(wp) :: a, b, low, high
      integer :: offset, n, i

      call prepare_condition(dyads%linkage, one)
      call prepare_condition(groups%linkage, other)
      call dyads%bind(dyads%given)
      call groups%bind(dimensions)
      call dyads%solve_block(1, offset, n)
      call groups%solve_block(1, offset, n)
      low = huge(1.0_wp)
      high = 0.0_wp
      do i = 1, n
         call condition_at(dyads, i, offset + i, one, a)
         call condition_at(groups, i, offset + i, other, b)
         low = min(low, b/a)
         high = max(high, b/a)
      end do
      call t%is_true(low > 0.05_wp .and. high < 20.0_wp, what//': condition numbers of one size')
   end subroutine compare_condition

   !> The Jacobian against that of the dyads, the change of the measures against differences.
   subroutine compare_derivatives(dyads, groups, dimensions, what)
      type(problem_t), intent(inout) :: dyads, groups
      type(dimensions_t), intent(in) :: dimensions
      character(*), intent(in) :: what
      type(sensitivity_t), allocatable :: one, other
      real(wp), allocatable :: a(:, :, :), b(:, :, :), dk(:, :, :), values(:), low(:, :), high(:, :)
      real(wp) :: step, worst
      integer :: nvar, v

      call dyads%want_derivatives(.true.)
      call groups%want_derivatives(.true.)
      nvar = size(dyads%parameters%variables)
      allocate (one, other)
      call prepare_sensitivity(dyads, one)
      call prepare_sensitivity(groups, other)
      associate (n => dyads%positions, components => dyads%output%kind%components)
         allocate (a(n, nvar, components), b(n, nvar, components), dk(n, groups%mechanism%nloop, nvar))
         allocate (low(n, groups%mechanism%nloop), high(n, groups%mechanism%nloop))
      end associate
      call find_jacobian(dyads, dyads%given, one, a)
      call find_jacobian(groups, dimensions, other, b, dk)
      call t%close_to(maxval(abs(a - b)), 0.0_wp, 1.0e-8_wp*max(1.0_wp, maxval(abs(a))), what//': the same Jacobian')
      values = groups%parameters%first_values(dimensions)
      do v = 1, nvar
         step = 1.0e-6_wp*max(1.0_wp, abs(values(v)))
         call measures_at(groups, dimensions, values, v, values(v) - step, low)
         call measures_at(groups, dimensions, values, v, values(v) + step, high)
         worst = maxval(abs((high - low)/(2.0_wp*step) - dk(:, :, v)))
         call t%close_to(worst, 0.0_wp, 1.0e-5_wp*max(1.0_wp, maxval(abs(dk(:, :, v)))), what//': change of the measures with '// &
                         'variable '//to_text(v))
      end do
   end subroutine compare_derivatives

   !> The measures of all groups with one variable changed.
   subroutine measures_at(groups, dimensions, values, v, value, k)
      type(problem_t), intent(inout) :: groups
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: values(:), value
      integer, intent(in) :: v
      real(wp), intent(out) :: k(:, :)
      type(dimensions_t) :: changed
      real(wp) :: x(size(values))
      integer :: block, offset, n

      x = values
      x(v) = value
      changed = dimensions
      call groups%parameters%apply(x, changed)
      call groups%bind(changed)
      do block = 1, groups%blocks()
         call groups%solve_block(block, offset, n)
         call block_constraints(groups, n, k(offset + 1:offset + n, :))
      end do
   end subroutine measures_at
end program test_higher_groups
