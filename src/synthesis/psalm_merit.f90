!> Linkage synthesis as an optimisation problem: errors and violated constraints of a linkage, past closing too, with their
!> derivatives.
!>
!> The merit is the objective plus a weight times the squared violations of closure, transmission angles, TOGGLE and clearances,
!> at the prescribed positions and, if asked for, over the whole range of the input. With free timing (IFREE) every
!> input position is a local unknown; it meets only its own position's errors.
module psalm_merit
   use psalm_angles, only: unit_vector
   use psalm_clearances, only: clearance_t, list_clearances, find_depth, points_of_clearance
   use psalm_constraint_group, only: range_positions, range_inputs, range_turn
   use psalm_data_set, only: data_set_t
   use psalm_dyad_kind, only: assur_prp, assur_rrr, form_of, form_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, degrees_per_radian, full_turn, right_angle
   use psalm_linear_unknowns, only: linear_unknowns_t, prepare_linear_unknowns, solve_linear_unknowns
   use psalm_nlp, only: nlp_t, normal_equations_t
   use psalm_output_targets, only: output_targets_t, prepare_output_targets, find_output_targets, differentiate_output_targets, &
                                  sum_of_desired_errors
   use psalm_output_kind, only: motion_point, motion_angle, most_rates
   use psalm_place, only: beside_t
   use psalm_search_group, only: order_free
   use psalm_similarity, only: similarity_t, fit_similarity, errors_of, take_out_similarity
   use psalm_sort, only: pool_rising
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples, linearise_samples, exceeds
   use psalm_desired_rates, only: desired_rates_t, prepare_desired_rates, find_desired_rates, differentiate_desired_rates, &
                                 sum_of_rate_errors, all_rates_exist
   use psalm_dimensions, only: dimensions_t
   use psalm_tolerance_spread, only: tolerance_spread_t, prepare_spread, find_spread, differentiate_spread, sum_of_spread
   use psalm_parameters, only: variable_aside, variable_length, variable_outlk
   implicit none (type, external)
   private
   public :: merit_t, prepare_merit, eliminate_linear, hold, let_go, put_in_order
   public :: constraint_inputs, set_range, extra_positions, forget_sides, least_margin, hold_place

   integer, parameter :: range_steps = 120           !! steps the range of the input is looked at in
   integer, parameter :: most_few = 40               !! places of it at which derivatives are found alone
   integer, parameter :: extra_positions = 8         !! further inputs where a violation was found between the steps
   real(wp), parameter :: least_margin = 0.02_wp     !! of the given linkage's: nearer to a dead point no larger group is brought
   real(wp), parameter :: slack = 1.0e-7_wp          !! constraints are aimed this far inside their limits
   real(wp), parameter :: longest = 1.0e4_wp         !! times the longest given arc: no variable length grows beyond it
   real(wp), parameter :: least_length = 1.0e-6_wp   !! of the first value: what positive means
   ! where no bounds are given, lengths of arcs are kept between these times the size of the problem ...
   real(wp), parameter :: default_low = 0.02_wp, default_high = 5.0_wp
   real(wp), parameter :: of_first = 0.5_wp          !! ... but from half of the given length to twice it at least

   !> A problem made ready, with room to work in. One object serves one thread.
   type, extends(nlp_t) :: merit_t
      ! in memory of their own, for objects this large fill a small stack
      class(sample_set_t), allocatable :: main           !! the prescribed positions
      class(sample_set_t), allocatable :: range          !! where else constraints hold: over the range of the inputs
      class(sample_set_t), allocatable :: few            !! those of them where constraints are violated, if they are few
      logical :: has_range = .false.                 !! there are such places
      class(desired_rates_t), allocatable :: rates     !! derivatives of the output by the input, where they are wanted
      class(tolerance_spread_t), allocatable :: tolerances !! how far the output spreads within tolerances, where that counts
      class(output_targets_t), allocatable :: targets   !! desired values of further outputs, where there are any
      class(problem_t), allocatable :: final          !! with the user's limits: what counts in the end
      type(dimensions_t) :: dimensions
      real(wp), allocatable :: limit(:)              !! by loop: of abs(k)
      type(clearance_t), allocatable :: clearances(:) !! their points are joints of `range`
      real(wp) :: size = 1.0_wp                      !! of the linkage: makes lengths comparable
      integer :: irange = range_positions
      logical :: free = .false.                      !! free timing
      logical :: ordered = .false.                   !! free timing: inputs go one way
      real(wp) :: sense = 1.0_wp                     !! which
      real(wp) :: span = full_turn                   !! and no further than this
      logical, allocatable :: by_default(:)          !! shape (nvar): lengths of arcs without given bounds
      real(wp), allocatable :: default_low(:), default_high(:) !! shape (nvar): bounds a result keeps, theirs included
      real(wp), allocatable :: box_low(:), box_high(:) !! shape (nvar): a global algorithm searches here, within the bounds
      real(wp) :: reach = full_turn                  !! how far it moves an input
      real(wp), allocatable :: late(:)               !! shape (positions): how far each input is past the next, radians or sizes
      real(wp), allocatable :: delt(:)               !! shape (positions): input increments
      real(wp), allocatable :: seen(:)               !! the point that the prescribed positions were last looked at for
      logical :: similar = .false.                   !! place, size and direction of the desired points are free
      type(similarity_t) :: similarity               !! of the linkage looked at last
      complex(wp), allocatable :: shape_error(:)     !! shape (positions): its errors then, in the size of the desired points
      class(linear_unknowns_t), allocatable :: linear !! dimensions that are solved for after every step, where it is asked for
   contains
      procedure :: point
      procedure :: measure
      procedure :: linearise
      procedure :: count_constraints
      procedure :: constrain
      procedure :: accept
      procedure :: project
      procedure :: fit_linear
      procedure :: search_box
   end type merit_t

contains

   !> Make a search ready. `first` is the linkage the bounds of lengths are derived from where none are given.
   subroutine prepare_merit(set, problem, first, merit)
      use psalm_start, only: random_limits
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem        !! with desired values
      real(wp), intent(in) :: first(:)              !! shape (nvar)
      type(merit_t), intent(out) :: merit
      class(problem_t), allocatable :: plain
      integer, allocatable :: joints(:, :)
      type(beside_t), allocatable :: beside(:)
      real(wp) :: cosine, sine, unused, reach
      real(wp), allocatable :: measure(:)            !! by loop: of larger groups as given
      integer :: nvar, n, loop

      nvar = size(problem%parameters%variables)
      n = problem%positions
      allocate (merit%main, merit%range)
      allocate (merit%final, source=problem)
      call merit%final%set_inputs(problem%delt)
      call copy_desired(problem, merit%final)
      merit%free = set%method%ifree /= 0
      merit%similar = set%method%isim /= 0
      if (merit%similar) allocate (merit%shape_error(n), source=(0.0_wp, 0.0_wp))
      merit%core = nvar
      merit%local = merge(n, 0, merit%free)
      merit%has_gradient = .true.
      merit%is_sum_of_squares = .true.
      merit%ordered = merit%free .and. set%search%order /= order_free
      if (n > 1) merit%sense = sign(1.0_wp, problem%delt(2) - problem%delt(1))
      if (problem%mechanism%sliding_input) then
         merit%span = huge(1.0_wp)
         merit%reach = maxval(problem%delt) - minval(problem%delt)
      end if
      allocate (merit%late(n), source=0.0_wp)
      merit%delt = problem%delt
      merit%irange = set%constr%irange
      merit%dimensions = problem%given
      merit%size = max(maxval(problem%given%arcl), tiny(1.0_wp)**0.25_wp)
      allocate (plain, source=problem)
      plain%tangle = right_angle
      plain%spare = 0.0_wp
      plain%slide_angle = right_angle
      call prepare_samples(plain, problem%delt, merit%free, reshape([integer ::], [2, 0]), .true., merit%main)
      call copy_desired(problem, merit%main%problem)
      merit%main%leading = n
      merit%floor = sum(merit%main%problem%weight(:n, 1))*(epsilon(1.0_wp)*merit%size)**2
      if (merit%similar) merit%floor = sum(merit%main%problem%weight(:n, 1))*(epsilon(1.0_wp)*extent_of_desired(problem))**2
      merit%small = max(1.0e-2_wp*sum(merit%main%problem%weight(:n, 1)) &
                        *merge(1.0_wp, merit%size, problem%motion == motion_angle)**2, sqrt(tiny(1.0_wp)))
      if (allocated(problem%rate_desired)) call want_rates(problem, merit)
      if (allocated(problem%target_values)) call want_outputs(set, problem, merit)
      if (set%toler%in_objective > 0.0_wp) then
         allocate (merit%tolerances)
         if (allocated(merit%targets)) then
            call prepare_spread(set, merit%main%problem, merit%main%columns, merit%size, merit%tolerances, &
                                merit%targets%problem%target_weights)
         else
            call prepare_spread(set, merit%main%problem, merit%main%columns, merit%size, merit%tolerances)
         end if
      end if
      call list_clearances(set%constr, problem%mechanism, problem%given%outlk <= 0.0_wp, merit%clearances, joints, beside)
      merit%has_range = merit%irange /= range_positions .or. size(merit%clearances) > 0
      if (merit%has_range) then
         plain%motion = motion_point
         call prepare_samples(plain, constraint_inputs(merit%irange, problem, problem%delt, range_steps, extra_positions), &
                              merit%free .and. merit%irange == range_positions, joints, .true., merit%range, &
                              beside)
         if (size(merit%clearances) == 0 .and. merit%range%problem%positions > most_few .and. .not. merit%range%timed) then
            allocate (merit%few)
            call prepare_samples(plain, merit%range%problem%delt(:most_few), .false., joints, .true., merit%few, beside)
         end if
      end if
      merit%low = spread(-huge(1.0_wp), 1, nvar)
      merit%high = -merit%low
      if (set%limits%limval == 1) then
         ! a narrow box is not turned over
         merit%low = set%limits%oplow(:nvar) + min(set%limits%stepin, 0.25_wp*(set%limits%ophigh(:nvar) - set%limits%oplow(:nvar)))
         merit%high = set%limits%ophigh(:nvar) - min(set%limits%stepin, 0.25_wp*(set%limits%ophigh(:nvar) - &
                                                            set%limits%oplow(:nvar)))
      end if
      where (problem%parameters%variables%kind == variable_length .or. problem%parameters%variables%kind == variable_outlk .or. &
             problem%parameters%variables%kind == variable_aside)
         merit%low = max(merit%low, least_length*abs(first))
         merit%high = min(merit%high, max(longest, maxval(abs(first))/merit%size)*merit%size)
      end where
      merit%by_default = set%limits%limval /= 1 .and. problem%parameters%variables%kind == variable_length
      reach = max(merit%size, extent_of_desired(problem))
      merit%default_low = merit%low
      merit%default_high = merit%high
      where (merit%by_default)
         merit%default_low = max(merit%low, min(reach*default_low, of_first*abs(first)))
         merit%default_high = min(merit%high, max(reach*default_high, abs(first)/of_first))
      end where
      call random_limits(set, first, merit%box_low, merit%box_high)
      call unit_vector(right_angle - set%limits%tangle, cosine, unused)
      call unit_vector(right_angle - problem%slide_angle, unused, sine)
      call given_measures(problem, measure)
      allocate (merit%limit(problem%mechanism%nloop))
      do loop = 1, problem%mechanism%nloop
         merit%limit(loop) = 1.0_wp - slack
         if (.not. problem%mechanism%is_dyad(loop)) merit%limit(loop) = merit%limit(loop) - least_margin*measure(loop)
         if (problem%mechanism%groups(loop)%kind == assur_rrr) merit%limit(loop) = cosine - slack
         if (problem%mechanism%groups(loop)%kind == assur_prp) merit%limit(loop) = 1.0_wp - sine - slack
      end do
   end subroutine prepare_merit

   !> How far larger groups of the linkage given are from a dead point where a search begins to follow them; 0: of dyads, and of
   !> groups that cannot be put together there.
   subroutine given_measures(problem, measure)
      class(problem_t), intent(in) :: problem
      real(wp), allocatable, intent(out) :: measure(:) !! by loop: the closure measure
      class(problem_t), allocatable :: scout
      integer :: offset, n, loop

      associate (mechanism => problem%mechanism)
         allocate (measure(mechanism%nloop), source=0.0_wp)
         if (all([(mechanism%is_dyad(loop), loop=1, mechanism%nloop)])) return
         allocate (scout, source=problem)
         call scout%set_inputs([problem%given%anchor - problem%given%crnki])
         call scout%bind(problem%given)
         call scout%solve_block(1, offset, n)
         do loop = 1, mechanism%nloop
            if (mechanism%is_dyad(loop) .or. scout%linkage%step_of_loop(loop) == 0) cycle
            measure(loop) = max(scout%linkage%store%v(1, scout%linkage%measure(loop)), 0.0_wp)
         end do
      end associate
   end subroutine given_measures

   !> Derivatives of the output by the input are wanted too.
   subroutine want_rates(problem, merit)
      type(problem_t), intent(in) :: problem
      class(merit_t), intent(inout) :: merit
      real(wp) :: unit, weight

      allocate (merit%rates)
      call prepare_desired_rates(problem, merit%free, .true., merit%rates)
      ! what a derivative is compared with: a radian or the linkage's size, per radian or per size
      unit = merge(1.0_wp, merit%size, problem%motion == motion_angle)
      if (problem%mechanism%sliding_input) unit = unit/merit%size
      weight = sum(problem%rate_weight)
      merit%floor = merit%floor + weight*(epsilon(1.0_wp)*unit)**2
      merit%small = max(merit%small, 1.0e-2_wp*weight*unit**2)
   end subroutine want_rates

   !> Values of further outputs are wanted too.
   subroutine want_outputs(set, problem, merit)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      class(merit_t), intent(inout) :: merit
      real(wp) :: unit
      integer :: k

      allocate (merit%targets)
      call prepare_output_targets(set, problem, merit%free, .true., merit%targets)
      do k = 1, size(problem%target_weights, 2)
         associate (weight => sum(problem%target_weights(:, k)))
            unit = merge(merit%size, 1.0_wp, merit%targets%is_length(k))
            if (problem%mechanism%sliding_input) unit = unit/product(spread(merit%size, 1, merit%targets%order(k)))
            merit%floor = merit%floor + weight*(epsilon(1.0_wp)*unit)**2
            merit%small = max(merit%small, 1.0e-2_wp*weight*unit**2)
         end associate
      end do
      do k = 1, size(merit%targets%relations)
         associate (of => merit%targets%relations(k))
            unit = merge(merit%size, 1.0_wp, merit%targets%is_length(of%columns(1)))
            if (problem%mechanism%sliding_input) unit = unit/product(spread(merit%size, 1, of%order))
            merit%floor = merit%floor + of%weight*(epsilon(1.0_wp)*unit)**2
            merit%small = max(merit%small, 1.0e-2_wp*of%weight*unit**2)
         end associate
      end do
   end subroutine want_outputs

   !> Largest difference of desired values that are lengths; 0 if they are angles.
   pure real(wp) function extent_of_desired(problem) result(extent)
      type(problem_t), intent(in) :: problem
      integer :: c

      extent = 0.0_wp
      do c = 1, problem%output%kind%components
         if (c == problem%output%kind%angle) cycle
         associate (wanted => problem%wanted(:problem%positions, c))
            extent = max(extent, maxval(wanted) - minval(wanted))
         end associate
      end do
   end function extent_of_desired

   subroutine copy_desired(from, to)
      type(problem_t), intent(in) :: from
      type(problem_t), intent(inout) :: to

      associate (n => from%positions)
         call to%set_desired(from%wanted(:n, :), from%weight(:n, :))
      end associate
   end subroutine copy_desired

   !> Inputs at which constraints hold beside the prescribed ones: the prescribed ones themselves, or even steps over the range and
   !> `extra` more that can be moved.
   pure function constraint_inputs(irange, problem, delt, steps, extra) result(inputs)
      integer, intent(in) :: irange                  !! IRANGE
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: delt(:)                !! shape (positions): prescribed increments
      integer, intent(in) :: steps, extra
      real(wp), allocatable :: inputs(:)
      real(wp) :: from, to
      integer :: i

      if (irange == range_positions) then
         inputs = delt
         return
      end if
      from = minval(delt)
      to = maxval(delt)
      if (irange == range_turn .and. .not. problem%mechanism%sliding_input) to = from + full_turn
      inputs = [(from + (to - from)*(real(i, wp)/real(steps, wp)), i=0, steps), spread(from, 1, extra)]
   end function constraint_inputs

   !> Move the samples over the range: its even steps to the range of the inputs, its further positions to where violations
   !> were found.
   subroutine set_range(merit, extra)
      class(merit_t), intent(inout) :: merit
      real(wp), intent(in) :: extra(:)               !! shape (at most extra_positions): inputs
      real(wp), allocatable :: inputs(:)
      integer :: n

      inputs = constraint_inputs(merit%irange, merit%final, merit%delt, range_steps, extra_positions)
      n = min(size(extra), extra_positions)
      if (merit%irange /= range_positions) inputs(range_steps + 2:range_steps + 1 + n) = extra(:n)
      call merit%range%problem%move_inputs(inputs)
   end subroutine set_range

   !> Forget on which side of each other two slides were in the linkages looked at so far.
   !>
   !> Seen from the other side closure is rounded otherwise: a start would depend on those before it.
   pure subroutine forget_sides(merit)
      class(merit_t), intent(inout) :: merit

      merit%main%problem%side = 1.0_wp
   end subroutine forget_sides

   !> The unknowns of a linkage: values of the variables and, with free timing, input increments.
   pure function point(self, values, delt) result(x)
      class(merit_t), intent(in) :: self
      real(wp), intent(in) :: values(:)              !! shape (nvar)
      real(wp), intent(in) :: delt(:)                !! shape (positions)
      real(wp) :: x(self%core + self%local)

      x(:self%core) = values
      x(self%core + 1:) = delt(:self%local)
   end function point

   !> Put a point in: the linkage and, with free timing, its input increments.
   subroutine put_in(merit, x)
      class(merit_t), intent(inout) :: merit
      real(wp), intent(in) :: x(:)

      associate (values => x(:merit%core), delt => x(merit%core + 1:))
         if (merit%free) call merit%main%problem%move_inputs(delt)
         if (merit%has_range .and. merit%range%timed) call merit%range%problem%move_inputs(delt)
         if (allocated(merit%rates) .and. merit%free) call merit%rates%problem%move_inputs(delt)
         if (allocated(merit%targets) .and. merit%free) call merit%targets%problem%move_inputs(delt)
         if (allocated(merit%tolerances) .and. merit%free) call merit%tolerances%problem%move_inputs(delt)
         if (order_weighs(merit)) merit%late = (merit%sense*(delt - cshift(delt, 1)) &
                                                - [spread(0.0_wp, 1, size(delt) - 1), merit%span])/unit_of_input(merit)
         ! the variables of `final` are the user's; those of a set of samples may have one more for the input
         call merit%final%parameters%apply(values, merit%dimensions)
      end associate
   end subroutine put_in

   !> Disorder of the inputs counts as a violation.
   pure logical function order_weighs(merit)
      class(merit_t), intent(in) :: merit

      order_weighs = merit%ordered .and. .not. merit%projects
   end function order_weighs

   !> What counts as much as a radian of the crank.
   pure real(wp) function unit_of_input(merit)
      class(merit_t), intent(in) :: merit

      unit_of_input = merge(merit%size, degrees_per_radian, merit%final%mechanism%sliding_input)
   end function unit_of_input

   !> Objective, and sum of the squared violations.
   subroutine measure(self, x, objective, violation)
      class(merit_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)                   !! shape (nvar, or nvar + positions)
      real(wp), intent(out) :: objective, violation

      call see(self, x)
      self%evaluations = self%evaluations + 1
      objective = sum_of_errors(self)
      violation = squared_violations(self)
   end subroutine measure

   subroutine see(merit, x)
      class(merit_t), intent(inout) :: merit
      real(wp), intent(in) :: x(:)

      call put_in(merit, x)
      call evaluate_samples(merit%main, merit%dimensions)
      if (merit%similar) call compare_shapes(merit)
      if (allocated(merit%rates)) call find_desired_rates(merit%rates, merit%dimensions)
      if (allocated(merit%targets)) call find_output_targets(merit%targets, merit%dimensions)
      if (allocated(merit%tolerances)) call find_spread(merit%tolerances, merit%dimensions)
      merit%seen = x
      if (merit%has_range) call look_over_range(merit)
   end subroutine see

   !> Errors of the linkage last looked at against desired points of any place, size and direction.
   subroutine compare_shapes(merit)
      class(merit_t), intent(inout) :: merit

      associate (weight => merit%main%problem%weight(:merit%main%problem%positions, 1), actual => actual_points(merit), &
                 desired => desired_points(merit))
         call fit_similarity(actual, desired, weight, merit%similarity)
         merit%shape_error = errors_of(merit%similarity, actual, desired)
      end associate
   end subroutine compare_shapes

   pure function actual_points(merit) result(points)
      class(merit_t), intent(in) :: merit
      complex(wp) :: points(merit%main%problem%positions)

      points = cmplx(merit%main%out(:, 1), merit%main%out(:, 2), wp) + desired_points(merit)
   end function actual_points

   pure function desired_points(merit) result(points)
      class(merit_t), intent(in) :: merit
      complex(wp) :: points(merit%main%problem%positions)

      associate (wanted => merit%main%problem%wanted(:merit%main%problem%positions, :))
         points = cmplx(wanted(:, 1), wanted(:, 2), wp)
      end associate
   end function desired_points

   !> Look at the samples over the range, with two slides on the side of each other that the prescribed positions say.
   subroutine look_over_range(merit)
      class(merit_t), intent(inout) :: merit

      merit%range%problem%side = merit%main%problem%side
      call evaluate_samples(merit%range, merit%dimensions)
   end subroutine look_over_range

   !> The objective of the linkage last looked at.
   pure real(wp) function sum_of_errors(merit)
      class(merit_t), intent(in) :: merit
      integer :: c

      associate (problem => merit%main%problem, n => merit%main%problem%positions)
         sum_of_errors = 0.0_wp
         if (merit%similar) then
            sum_of_errors = sum(problem%weight(:n, 1)*(merit%shape_error%re**2 + merit%shape_error%im**2))
            return
         end if
         do c = 1, size(merit%main%out, 2)
            sum_of_errors = sum_of_errors + sum(problem%weight(:n, c)*merit%main%out(:, c)**2)
         end do
      end associate
      if (allocated(merit%rates)) sum_of_errors = sum_of_errors + sum_of_rate_errors(merit%rates)
      if (allocated(merit%targets)) sum_of_errors = sum_of_errors + sum_of_desired_errors(merit%targets)
      if (allocated(merit%tolerances)) sum_of_errors = sum_of_errors + sum_of_spread(merit%tolerances)
   end function sum_of_errors

   !> Sum of the squared violations of the linkage last looked at.
   pure real(wp) function squared_violations(merit) result(total)
      class(merit_t), intent(in) :: merit
      real(wp) :: depth, pull(2, points_of_clearance)
      integer :: i, r

      total = squared_angles(merit%main, merit%limit)
      if (order_weighs(merit)) total = total + sum(max(merit%late, 0.0_wp)**2)
      if (.not. merit%has_range) return
      total = total + squared_angles(merit%range, merit%limit)
      do r = 1, size(merit%clearances)
         do i = 1, merit%range%problem%positions
            call depth_at(merit, r, i, depth, pull)
            total = total + max(depth, 0.0_wp)**2
         end do
      end do
   end function squared_violations

   pure real(wp) function squared_angles(samples, limit) result(total)
      type(sample_set_t), intent(in) :: samples
      real(wp), intent(in) :: limit(:)
      integer :: loop

      total = 0.0_wp
      do loop = 1, size(limit)
         if (.not. exceeds(size(samples%k, 1), samples%k(:, loop), limit(loop))) cycle
         total = total + sum(max(abs(samples%k(:, loop)) - limit(loop), 0.0_wp)**2)
      end do
   end function squared_angles

   !> How far short clearance r falls at position i of the samples over the range, in sizes of the linkage, and its gradient by
   !> its points.
   pure subroutine depth_at(merit, r, i, depth, pull)
      class(merit_t), intent(in) :: merit
      integer, intent(in) :: r, i
      real(wp), intent(out) :: depth, pull(:, :)
      real(wp) :: at(2, points_of_clearance)
      integer :: k

      do k = 1, points_of_clearance
         associate (joint => merit%clearances(r)%points(k))
            if (joint == 0) then
               at(:, k) = merit%range%out(i, 1:2)
            else
               at(:, k) = merit%range%joints(i, :, joint)
            end if
         end associate
      end do
      call find_depth(merit%clearances(r), at, depth, pull)
      depth = depth/merit%size + slack
      pull = pull/merit%size
   end subroutine depth_at

   !> Gradient and matrices of the normal equations: J^T W r and J^T W J of errors and violations.
   subroutine linearise(self, x, weight, equations)
      class(merit_t), intent(inout) :: self
      real(wp), intent(in) :: x(:), weight
      type(normal_equations_t), intent(inout) :: equations
      integer :: held(self%core), holds             ! variables whose derivatives count as zero
      integer :: r, a, b, order
      logical :: seen

      seen = self%main%solved .and. allocated(self%seen)
      if (seen) seen = all(x <= self%seen .and. x >= self%seen)
      call put_in(self, x)
      call linearise_samples(self%main, self%dimensions, seen, self%limit)
      self%seen = x
      self%jacobians = self%jacobians + 1
      call equations%clear(self%core, self%local)
      holds = 0
      if (allocated(self%main%held)) then
         holds = count(self%main%held(:self%core))
         held(:holds) = pack([(a, a=1, self%core)], self%main%held(:self%core))
      end if
      associate (nvar => self%core, main => self%main, n => self%main%problem%positions)
         if (self%similar) then
            call add_shape(self, equations)
         else
            do r = 1, size(main%out, 2)
               call add_errors(nvar, main%problem%weight(:n, r), main%out(:, r), main%dout(:, :, r), equations)
            end do
         end if
         if (allocated(self%rates)) then
            call differentiate_desired_rates(self%rates, self%dimensions)
            associate (rates => self%rates)
               rates%by(:, held(:holds), :, :) = 0.0_wp
               do order = 1, most_rates
                  do r = 1, size(rates%miss, 2)
                     call add_errors(nvar, rates%problem%rate_weight(:, r, order), rates%miss(:, r, order), &
                                     rates%by(:, :, r, order), equations)
                  end do
               end do
            end associate
         end if
         if (allocated(self%targets)) then
            call differentiate_output_targets(self%targets, self%dimensions)
            associate (targets => self%targets)
               targets%by(:, held(:holds), :) = 0.0_wp
               do r = 1, size(targets%miss, 2)
                  call add_errors(nvar, targets%problem%target_weights(:, r), targets%miss(:, r), targets%by(:, :, r), equations)
               end do
               if (size(targets%relations) > 0) then
                  targets%difference_by(:, held(:holds)) = 0.0_wp
                  call add_errors(nvar, [targets%relations%weight], targets%difference, targets%difference_by, equations)
               end if
            end associate
         end if
         if (allocated(self%tolerances)) then
            call differentiate_spread(self%tolerances, self%final%parameters, x(:nvar), self%dimensions)
            associate (tolerances => self%tolerances)
               tolerances%by(:, held(:holds), :, :) = 0.0_wp
               do r = 1, size(tolerances%miss, 3)
                  do b = 1, size(tolerances%miss, 2)
                     call add_errors(nvar, tolerances%weight(:, r), tolerances%miss(:, b, r), tolerances%by(:, :, b, r), equations)
                  end do
               end do
            end associate
         end if
         call add_angles(main, self%limit, size(main%k, 1), nvar, weight, equations)
         if (order_weighs(self)) then
            associate (pull => (weight*self%sense/unit_of_input(self))*max(self%late, 0.0_wp))
               equations%edge_gradient = equations%edge_gradient + pull - cshift(pull, -1)
            end associate
         end if
         if (self%has_range) call add_range(self, weight, equations)
         do a = 1, nvar
            do b = 1, a - 1
               equations%matrix(a, b) = equations%matrix(b, a)
            end do
         end do
      end associate
   end subroutine linearise

   !> Errors against desired points of any place, size and direction, these eliminated.
   subroutine add_shape(merit, equations)
      class(merit_t), intent(inout) :: merit
      type(normal_equations_t), intent(inout) :: equations
      complex(wp) :: error(merit%main%problem%positions), by(merit%main%problem%positions, merit%core)
      complex(wp) :: tangent(merit%main%problem%positions)
      real(wp) :: columns(merit%main%problem%positions, merit%main%columns, 2)

      associate (main => merit%main, nvar => merit%core, u => merit%similarity%u, n => merit%main%problem%positions)
         call compare_shapes(merit)
         error = merit%shape_error
         by = u*cmplx(main%dout(:, :nvar, 1), main%dout(:, :nvar, 2), wp)
         if (merit%free) then
            tangent = u*cmplx(main%dout(:, nvar + 1, 1), main%dout(:, nvar + 1, 2), wp)
            call take_out_similarity(actual_points(merit), main%problem%weight(:n, 1), error, by, tangent)
            columns(:, nvar + 1, 1) = tangent%re
            columns(:, nvar + 1, 2) = tangent%im
         else
            call take_out_similarity(actual_points(merit), main%problem%weight(:n, 1), error, by)
         end if
         columns(:, :nvar, 1) = by%re
         columns(:, :nvar, 2) = by%im
         call add_errors(nvar, main%problem%weight(:n, 1), real(error, wp), columns(:, :, 1), equations)
         call add_errors(nvar, main%problem%weight(:n, 2), aimag(error), columns(:, :, 2), equations)
      end associate
   end subroutine add_shape

   !> What is violated over the range. Where nothing is, no derivatives are needed.
   subroutine add_range(merit, weight, equations)
      class(merit_t), intent(inout) :: merit
      real(wp), intent(in) :: weight
      type(normal_equations_t), intent(inout) :: equations
      integer :: i, r
      real(wp) :: depth, pull(2, points_of_clearance)
      real(wp) :: row(merit%core)
      logical, allocatable :: violated(:)

      call look_over_range(merit)
      if (size(merit%clearances) == 0 .and. .not. squared_angles(merit%range, merit%limit) > 0.0_wp) return
      if (allocated(merit%few)) then
         violated = [(any(abs(merit%range%k(i, :)) > merit%limit), i=1, size(merit%range%k, 1))]
         if (count(violated) <= most_few) then
            ! of the places not needed the last one is taken again
            associate (places => pack([(i, i=1, size(violated))], violated))
               call merit%few%problem%move_inputs(merit%range%problem%delt(places([(min(i, size(places)), i=1, most_few)])))
            end associate
            merit%few%problem%side = merit%main%problem%side
            call linearise_samples(merit%few, merit%dimensions)
            call add_angles(merit%few, merit%limit, count(violated), merit%core, weight, equations)
            return
         end if
      end if
      call linearise_samples(merit%range, merit%dimensions)
      call add_angles(merit%range, merit%limit, size(merit%range%k, 1), merit%core, weight, equations)
      do r = 1, size(merit%clearances)
         do i = 1, merit%range%problem%positions
            call depth_at(merit, r, i, depth, pull)
            if (depth <= 0.0_wp) cycle
            row = slope(merit, r, i, pull, 1, merit%core)
            call add_row(equations, weight, depth, row)
            if (merit%range%timed) call add_timing(equations, i, weight, depth, row, &
                                                    sum(slope(merit, r, i, pull, merit%core + 1, merit%core + 1)))
         end do
      end do
   end subroutine add_range

   !> Derivatives of a clearance's shortfall by the variables `from` to `to`.
   pure function slope(merit, r, i, pull, from, to) result(row)
      class(merit_t), intent(in) :: merit
      integer, intent(in) :: r, i, from, to
      real(wp), intent(in) :: pull(:, :)
      real(wp) :: row(to - from + 1)
      integer :: k

      row = 0.0_wp
      do k = 1, points_of_clearance
         if (all(abs(pull(:, k)) <= 0.0_wp)) cycle
         associate (joint => merit%clearances(r)%points(k))
            if (joint == 0) then
               row = row + pull(1, k)*merit%range%dout(i, from:to, 1) + pull(2, k)*merit%range%dout(i, from:to, 2)
            else
               row = row + pull(1, k)*merit%range%djoints(i, 1, joint, from:to) &
                     + pull(2, k)*merit%range%djoints(i, 2, joint, from:to)
            end if
         end associate
      end do
   end function slope

   !> Errors of one coordinate at all positions. Only the upper triangle of the matrix is added to.
   subroutine add_errors(nvar, weight, error, d, equations)
      integer, intent(in) :: nvar
      real(wp), intent(in), contiguous :: weight(:), error(:) !! shape (positions)
      real(wp), intent(in), contiguous :: d(:, :)    !! shape (positions, columns)
      type(normal_equations_t), intent(inout) :: equations
      real(wp) :: weighted(size(error))
      integer :: a, b, i

      do a = 1, nvar
         weighted = weight*error
         equations%gradient(a) = equations%gradient(a) + product_of(size(error), weighted, d(:, a))
         weighted = weight*d(:, a)
         do b = 1, a
            equations%matrix(b, a) = equations%matrix(b, a) + product_of(size(error), weighted, d(:, b))
         end do
      end do
      if (size(equations%edge) == 0) return
      do i = 1, size(error)
         call add_timing(equations, i, weight(i), error(i), d(i, :nvar), d(i, nvar + 1))
      end do
   end subroutine add_errors

   !> Sum of a*b in a fixed order: eight partial sums, so that it runs in vector lanes.
   pure real(wp) function product_of(n, a, b)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(n), b(n)
      integer, parameter :: lanes = 8
      real(wp) :: part(lanes)
      integer :: i

      part = 0.0_wp
      do i = 1, n - lanes + 1, lanes
         part = part + a(i:i + lanes - 1)*b(i:i + lanes - 1)
      end do
      product_of = ((part(1) + part(2)) + (part(3) + part(4))) + ((part(5) + part(6)) + (part(7) + part(8)))
      do i = n - modulo(n, lanes) + 1, n
         product_of = product_of + a(i)*b(i)
      end do
   end function product_of

   !> Violations of closure, transmission angles, angles between slides and TOGGLE at the positions of a set of samples.
   subroutine add_angles(samples, limit, positions, nvar, weight, equations)
      type(sample_set_t), intent(in) :: samples
      real(wp), intent(in) :: limit(:)               !! shape (loops)
      integer, intent(in) :: positions               !! of the samples that count, the first ones
      integer, intent(in) :: nvar
      real(wp), intent(in) :: weight
      type(normal_equations_t), intent(inout) :: equations
      real(wp) :: over
      integer :: loop, i

      do loop = 1, size(limit)
         if (.not. exceeds(positions, samples%k(:, loop), limit(loop))) cycle
         do i = 1, positions
            over = abs(samples%k(i, loop)) - limit(loop)
            if (over <= 0.0_wp) cycle
            over = sign(over, samples%k(i, loop))
            call add_row(equations, weight, over, samples%dk(i, loop, :nvar))
            if (samples%timed) call add_timing(equations, i, weight, over, samples%dk(i, loop, :nvar), &
                                               samples%dk(i, loop, nvar + 1))
         end do
      end do
   end subroutine add_angles

   !> One residual of the dimensions.
   pure subroutine add_row(equations, weight, residual, d)
      type(normal_equations_t), intent(inout) :: equations
      real(wp), intent(in) :: weight, residual, d(:)
      integer :: a

      do a = 1, size(d)
         equations%gradient(a) = equations%gradient(a) + weight*residual*d(a)
         equations%matrix(:a, a) = equations%matrix(:a, a) + weight*d(a)*d(:a)
      end do
   end subroutine add_row

   !> The part of a residual that hangs on the input of position i.
   pure subroutine add_timing(equations, i, weight, residual, d, turn)
      type(normal_equations_t), intent(inout) :: equations
      integer, intent(in) :: i
      real(wp), intent(in) :: weight, residual, d(:), turn   !! `turn` is the derivative by the input

      equations%edge(i) = equations%edge(i) + weight*turn**2
      equations%edge_gradient(i) = equations%edge_gradient(i) + weight*turn*residual
      equations%border(:, i) = equations%border(:, i) + weight*turn*d
   end subroutine add_timing

   !> True if a linkage obeys every constraint at the positions looked at; `objective` is the user's.
   subroutine accept(self, x, objective, feasible)
      class(merit_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      integer :: loop, i, r
      real(wp) :: depth, pull(2, points_of_clearance)

      call put_in(self, x)
      if (self%free) call self%final%move_inputs(x(self%core + 1:))
      call self%final%evaluate(self%dimensions, objective, loop)
      self%evaluations = self%evaluations + 1
      feasible = loop == 0
      if (allocated(self%rates)) then
         call find_desired_rates(self%rates, self%dimensions)
         objective = objective + sum_of_rate_errors(self%rates)
         feasible = feasible .and. all_rates_exist(self%rates)
      end if
      if (allocated(self%targets)) then
         call find_output_targets(self%targets, self%dimensions)
         objective = objective + sum_of_desired_errors(self%targets)
         feasible = feasible .and. all(self%targets%exists)
      end if
      if (allocated(self%tolerances)) then
         call find_spread(self%tolerances, self%dimensions)
         objective = objective + sum_of_spread(self%tolerances)
      end if
      if (self%similar .or. feasible) call evaluate_samples(self%main, self%dimensions)
      if (self%similar) then
         call compare_shapes(self)
         objective = sum_of_errors(self)
      end if
      feasible = feasible .and. objective <= huge(objective)  ! lengths of 1E-310 have no direction
      if (.not. feasible) return
      self%seen = x
      feasible = keeps_limits(self%main, self%limit)
      if (.not. (feasible .and. self%has_range)) return
      call look_over_range(self)
      feasible = all(self%range%closed) .and. keeps_limits(self%range, self%limit)
      do r = 1, size(self%clearances)
         do i = 1, self%range%problem%positions
            call depth_at(self, r, i, depth, pull)
            if (depth > slack) feasible = .false.
         end do
      end do
   end subroutine accept

   pure logical function keeps_limits(samples, limit)
      type(sample_set_t), intent(in) :: samples
      real(wp), intent(in) :: limit(:)
      integer :: loop

      keeps_limits = .true.
      do loop = 1, size(limit)
         if (any(abs(samples%k(:, loop)) > limit(loop) + slack)) keeps_limits = .false.
      end do
   end function keeps_limits

   ! ---- constraints one by one, for solvers that take them ---------------------------------------------------------

   !> How many constraints `constrain` gives.
   integer function count_constraints(self)
      class(merit_t), intent(in) :: self

      count_constraints = of_samples(self%main)
      if (order_weighs(self)) count_constraints = count_constraints + size(self%late)
      if (self%has_range) count_constraints = count_constraints + of_samples(self%range) &
                                            + size(self%clearances)*self%range%problem%positions

   contains

      pure integer function of_samples(samples)
         type(sample_set_t), intent(in) :: samples
         integer :: loop

         of_samples = samples%problem%positions*sum([(ways(samples, loop), loop=1, size(self%limit))])
      end function of_samples
   end function count_constraints

   !> In how many ways a dyad that is solved may fail to close: none of type 6 or 7 does, two slides are parallel one way.
   pure integer function ways(samples, loop)
      type(sample_set_t), intent(in) :: samples
      integer, intent(in) :: loop
      type(form_t) :: form

      form = form_of(samples%problem%mechanism%groups(loop)%kind)
      ways = merge(form%ways, 0, samples%problem%linkage%step_of_loop(loop) > 0)
   end function ways

   !> Every constraint, aimed at <= 0, and with `slopes` its derivatives by dimensions and input positions.
   subroutine constrain(self, x, values, slopes)
      class(merit_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)                   !! shape (nvar, or nvar + positions)
      real(wp), intent(out) :: values(:)             !! shape (count_constraints)
      real(wp), intent(out), optional :: slopes(:, :) !! shape (nvar, or nvar + positions; count_constraints)
      real(wp) :: depth, pull(2, points_of_clearance)
      integer :: next, r, i, nvar

      if (present(slopes)) then
         call put_in(self, x)
         call linearise_samples(self%main, self%dimensions)
         self%seen = x
         if (self%has_range) then
            self%range%problem%side = self%main%problem%side
            call linearise_samples(self%range, self%dimensions)
         end if
         self%jacobians = self%jacobians + 1
         slopes = 0.0_wp
      else
         call see(self, x)
      end if
      nvar = self%core
      next = 0
      call of_samples(self%main)
      if (order_weighs(self)) then
         do i = 1, size(self%late)
            next = next + 1
            values(next) = self%late(i)
            if (.not. present(slopes)) cycle
            slopes(nvar + i, next) = self%sense/unit_of_input(self)
            slopes(nvar + 1 + modulo(i, size(self%late)), next) = -self%sense/unit_of_input(self)
         end do
      end if
      if (.not. self%has_range) return
      call of_samples(self%range)
      do r = 1, size(self%clearances)
         do i = 1, self%range%problem%positions
            call depth_at(self, r, i, depth, pull)
            next = next + 1
            values(next) = depth
            if (.not. present(slopes)) cycle
            slopes(:nvar, next) = slope(self, r, i, pull, 1, nvar)
            if (self%range%timed) slopes(nvar + i, next) = sum(slope(self, r, i, pull, nvar + 1, nvar + 1))
         end do
      end do

   contains

      subroutine of_samples(samples)
         type(sample_set_t), intent(in) :: samples
         integer :: loop, k, way
         real(wp) :: side

         do loop = 1, size(self%limit)
            do k = 1, size(samples%k, 1)
               do way = 1, ways(samples, loop)
                  side = merge(1.0_wp, -1.0_wp, way == 1)
                  next = next + 1
                  values(next) = side*samples%k(k, loop) - self%limit(loop)
                  if (.not. present(slopes)) cycle
                  slopes(:nvar, next) = side*samples%dk(k, loop, :nvar)
                  if (samples%timed) slopes(nvar + k, next) = side*samples%dk(k, loop, nvar + 1)
               end do
            end do
         end do
      end subroutine of_samples
   end subroutine constrain
   ! ---- free timing -----------------------------------------------------------------------------------------------------

   !> Inputs that must follow each other are put in order.
   subroutine project(self, x)
      class(merit_t), intent(in) :: self
      real(wp), intent(inout) :: x(:)                !! shape (nvar, or nvar + positions)

      if (self%ordered) call put_in_order(x(self%core + 1:), self%sense, self%span)
   end subroutine project

   !> From now on solve for the dimensions that enter the output linearly, where the linkage has them.
   !>
   !> Not where constraints hold in a part of the turn that hangs on free inputs: it would turn with them; nor where derivatives or
   !> further outputs are wanted.
   subroutine eliminate_linear(merit)
      class(merit_t), intent(inout) :: merit

      if (size(merit%clearances) > 0 .or. (merit%free .and. merit%irange == range_inputs) .or. allocated(merit%rates)) return
      if (allocated(merit%targets) .or. allocated(merit%tolerances)) return
      allocate (merit%linear)
      call prepare_linear_unknowns(merit%final, merit%free, merit%low, merit%high, merit%linear)
      if (.not. merit%linear%applies) deallocate (merit%linear)
   end subroutine eliminate_linear

   !> From now on the desired points stay where they are.
   pure subroutine hold_place(merit)
      class(merit_t), intent(inout) :: merit

      merit%similar = .false.
   end subroutine hold_place

   !> From now on these variables stay what they are: they are no unknowns of least squares.
   subroutine hold(merit, held)
      class(merit_t), intent(inout) :: merit
      logical, intent(in) :: held(:)                 !! shape (nvar)

      merit%main%held = [held, spread(.false., 1, merit%main%columns - size(held))]
      if (merit%has_range) merit%range%held = [held, spread(.false., 1, merit%range%columns - size(held))]
      if (allocated(merit%few)) merit%few%held = held
   end subroutine hold

   !> All of them vary again.
   subroutine let_go(merit)
      class(merit_t), intent(inout) :: merit

      if (allocated(merit%main%held)) deallocate (merit%main%held)
      if (merit%has_range) then
         if (allocated(merit%range%held)) deallocate (merit%range%held)
      end if
      if (.not. allocated(merit%few)) return
      if (allocated(merit%few%held)) deallocate (merit%few%held)
   end subroutine let_go

   !> Give these dimensions their best values.
   subroutine fit_linear(self, x)
      class(merit_t), intent(inout) :: self
      real(wp), intent(inout) :: x(:)                !! shape (nvar + positions)
      real(wp) :: delt(self%final%positions)
      logical :: solved

      if (.not. allocated(self%linear) .or. allocated(self%main%held)) return
      delt = self%delt
      if (self%free) delt = x(self%core + 1:)
      call solve_linear_unknowns(self%linear, self%low, self%high, x(:self%core), delt, solved)
      x(self%core + 1:) = delt(:self%local)
   end subroutine fit_linear

   !> Where a global search looks: the box that random linkages are drawn from, and inputs within `reach`.
   subroutine search_box(self, x, low, high)
      class(merit_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: low(:), high(:)

      low = x - self%reach
      high = x + self%reach
      low(:self%core) = self%box_low
      high(:self%core) = self%box_high
   end subroutine search_box

   !> The nearest inputs (least squares) that never go back, within one turn: neighbours that do are given their mean.
   pure subroutine put_in_order(delt, sense, span)
      real(wp), intent(inout) :: delt(:)            !! shape (positions): input increments, degrees or length
      real(wp), intent(in) :: sense                 !! +1: they grow, -1: they fall
      real(wp), intent(in) :: span                  !! most between the first and the last
      real(wp) :: level(size(delt))
      integer :: last(size(delt)), pools, i, at

      level = sense*delt
      call pool_rising(level, last, pools)
      at = 1
      do i = 1, pools
         delt(at:last(i)) = sense*level(i)
         at = last(i) + 1
      end do
      delt = sense*min(sense*delt, sense*delt(1) + span)
   end subroutine put_in_order
end module psalm_merit
