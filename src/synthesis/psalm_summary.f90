!> What a linkage does over the range of its input, in a few numbers: where it closes, what kind of four-bar its loops are, its
!> least transmission angle, range and dead points of the output, errors at the prescribed positions.
!>
!> The input is swept in steps of half a degree (a sliding input: 720 steps of its range); ends, extremes and narrow gaps between
!> the steps are then found by looking ever more closely. That is a search, no proof.
module psalm_summary
   use psalm_angles, only: arc_sine, nearest_difference
   use psalm_column_names, only: number_unit, output_unit, per_input
   use psalm_data_set, only: data_set_t
   use psalm_dyad_kind, only: assur_higher, assur_prr, assur_rrp, assur_rrr, form_of, form_t
   use psalm_elementary, only: hypotenuse
   use psalm_exact_sum, only: sign_of_sum
   use psalm_error, only: problem_t, motion_t
   use psalm_equal_items, only: equality_words
   use psalm_kinds, only: wp, full_turn, right_angle
   use psalm_output_kind, only: motion_point, motion_angle, motion_pose, most_rates
   use psalm_output_targets, only: both_exist, output_targets_t, compare_with_targets, target_group_t, target_groups, first_target
   use psalm_plan, only: root_crank, root_frame
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples
   use psalm_sketch_outputs, only: name_length
   use psalm_sweep, only: sweep_sense
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t
   use psalm_shown_input, only: input_in_turn, reference_input
   implicit none (type, external)
   private
   public :: summary_t, loop_kind_t, range_t, summarise, kinds_of, kind_of_four_bar
   public :: kind_none, kind_crank_rocker, kind_double_crank, kind_double_rocker, kind_rocker_crank, kind_triple_rocker, &
             kind_change_point, kind_slider_turning, kind_slider_swinging
   public :: unit_width

   integer, parameter :: kind_none = 0
   integer, parameter :: kind_crank_rocker = 1    !! the crank turns fully, the follower swings
   integer, parameter :: kind_double_crank = 2    !! both turn fully
   integer, parameter :: kind_double_rocker = 3   !! both swing, the coupler turns fully
   integer, parameter :: kind_rocker_crank = 4    !! the follower turns fully, the input link swings
   integer, parameter :: kind_triple_rocker = 5   !! nothing turns fully
   integer, parameter :: kind_change_point = 6    !! the links can lie in one line
   integer, parameter :: kind_slider_turning = 7  !! slider-crank whose crank turns fully
   integer, parameter :: kind_slider_swinging = 8 !! slider-crank whose crank does not

   integer, parameter :: unit_width = 20                !! characters of a unit
   integer, parameter :: steps = 720, steps_of_refinement = 16
   integer, parameter :: refinements = 10              !! closer looks: the last at 1e-11 of a step
   real(wp), parameter :: rounding = 8.0_wp*epsilon(1.0_wp)
   real(wp), parameter :: rounding_of_angle = 1.0e-4_wp !! degrees; near 0 half of the digits are lost
   real(wp), parameter :: rounding_of_input = 1.0e-9_wp !! degrees
   real(wp), parameter :: far = 1.0e6_wp          !! times the longest arc: the output runs to infinity
   real(wp), parameter :: most_of_turn = 300.0_wp !! inputs over more than this are meant for a full turn, degrees
   real(wp), parameter :: still = 1.0e-9_wp       !! relative change of the output that is none
   real(wp), parameter :: near_toggle = 0.9_wp    !! sine of the deviation from 90 degrees above which a gap is looked for

   !> A range of inputs, or of outputs.
   type :: range_t
      real(wp) :: low = 0.0_wp, high = 0.0_wp
   end type range_t

   !> What a loop is by the rule of Grashof.
   type :: loop_kind_t
      integer :: loop = 0
      integer :: kind = kind_none
   end type loop_kind_t

   !> Errors of derivatives by the input that are wanted; of points the length of the difference, angles in radians.
   type :: rate_errors_t
      integer :: compared = 0                         !! positions at which one is wanted and exists
      real(wp) :: rms = 0.0_wp, largest = 0.0_wp
      integer :: worst = 0                            !! position of the largest
      logical :: of_angle = .false.                   !! of the angle of a pose, of whose point none are wanted
   end type rate_errors_t

   !> Errors of an output of a sketch, or of a derivative of it.
   type :: target_errors_t
      character(name_length) :: name = ''               !! of the output
      integer :: number = 0                           !! the first of its numbers, counted through those of all outputs
      integer :: order = 0                            !! derivative
      integer :: compared = 0                         !! positions at which a value is wanted and exists
      real(wp) :: rms = 0.0_wp, largest = 0.0_wp      !! of points their distance; of angles degrees, their derivatives in radians
      character(unit_width) :: unit = ''               !! of these
      integer :: worst = 0                            !! position of the largest
      real(wp) :: worst_input = 0.0_wp
   end type target_errors_t

   !> How far outputs are from what they are to be equal to.
   type :: equal_errors_t
      character(:), allocatable :: words              !! of EQUAL
      logical :: known = .false.                      !! both exist, at every position
      real(wp) :: largest = 0.0_wp                    !! degrees of angles, their derivatives in radians
   end type equal_errors_t

   type :: summary_t
      logical :: sliding_input = .false.
      integer :: motion = motion_point                !! MOTION: what the output is
      logical :: at_positions = .false.               !! of several drives: only the positions were looked at
      logical :: everywhere = .false.                 !! closes over the whole turn, or the whole range of a sliding input
      type(range_t), allocatable :: closing(:)         !! inputs from .. to, as the input increases
      integer :: undetermined_loop = 0                !! loop of a dyad whose outer joints coincide over a range, 0: none
      integer :: undetermined_joints(2) = 0           !! of a sketch: these joints, 0: none
      type(range_t) :: undetermined                    !! the first such range of inputs
      logical :: others_open = .false.                !! these are less than what the output itself depends on closes over
      logical :: output_everywhere = .false.          !! that closes over the whole turn or range
      logical :: partial = .false.                    !! angle, output and dead points are those over the prescribed inputs only
      type(range_t) :: prescribed                      !! these inputs
      logical :: unbounded = .false.                  !! the output runs to infinity
      logical :: turns = .false.                      !! the output angle turns fully
      type(loop_kind_t), allocatable :: kinds(:)
      integer :: angle_loop = 0                       !! loop of the least transmission angle, 0: there is none
      real(wp) :: angle = right_angle                 !! the least one, degrees from the line of the links
      real(wp) :: angle_input = 0.0_wp                !! at the positions only: the number of the position
      integer :: group_loop = 0                       !! loop of the larger group nearest to a dead point, 0: there is none
      real(wp) :: group_measure = 1.0_wp              !! its measure there: 1 at best, 0 at a dead point
      real(wp) :: group_input = 0.0_wp
      real(wp) :: least_asked = 0.0_wp                !! TRMIN, degrees; 0: it is not given
      type(range_t) :: output, output_y                !! range of the output; the second is y of MOTION 0
      real(wp), allocatable :: reverses(:)            !! inputs at which the output reverses
      integer :: compared = 0                         !! closed positions with desired values
      real(wp) :: rms = 0.0_wp, largest = 0.0_wp      !! errors there
      character(unit_width) :: error_unit = ''         !! of these
      integer :: worst = 0                            !! position of the largest
      real(wp) :: worst_input = 0.0_wp
      type(target_errors_t), allocatable :: targets(:)   !! by output; not allocated: there are no desired values of such
      type(equal_errors_t), allocatable :: equals(:)   !! not allocated: no outputs are to be equal
      logical :: of_targets = .false.                  !! the errors above are those of the first of these
      type(rate_errors_t) :: rates(most_rates)        !! of first and second derivatives by the input
   end type summary_t

contains

   !> Summary of a linkage. `motion` is what it does at the prescribed positions, `desired_values` what it does there of the
   !> desired values
   !> of further outputs; without these it is found here, if there are any.
   subroutine summarise(set, problem, dimensions, motion, summary, targets)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(in) :: motion
      type(summary_t), intent(out) :: summary
      class(output_targets_t), intent(in), optional :: targets    !! compared at the positions
      class(output_targets_t), allocatable :: own                ! large: it would fill a small stack

      call summarise_range(problem, dimensions, motion, summary)
      if (.not. allocated(problem%target_values)) return
      if (present(targets)) then
         call summarise_targets(set, targets, motion, summary)
         return
      end if
      allocate (own)
      call compare_with_targets(set, problem, dimensions, motion%closed, own)
      call summarise_targets(set, own, motion, summary)
   end subroutine summarise

   !> The summary but for what is desired of further outputs.
   subroutine summarise_range(problem, dimensions, motion, summary)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(in) :: motion
      type(summary_t), intent(out) :: summary
      class(problem_t), allocatable :: plain          ! in memory of their own: they would fill a small stack
      class(sample_set_t), allocatable :: fine, refinement
      type(summary_t) :: part, whole
      real(wp), allocatable :: inputs(:), gaps(:)
      integer :: none(2, 0), i
      integer, parameter :: any_joint(2, 1) = 1       ! with a joint wanted every loop is solved

      summary%sliding_input = problem%mechanism%sliding_input
      if (problem%trmin_given) summary%least_asked = right_angle - problem%tangle
      ! of a pose the point is reported
      summary%motion = merge(motion_point, problem%motion, problem%motion == motion_pose)
      call errors(problem, motion, summary)
      if (allocated(motion%rates)) call errors_of_rates(problem, motion, summary%rates)
      allocate (fine, refinement)
      allocate (plain, source=problem)
      plain%tangle = right_angle
      plain%spare = 0.0_wp
      plain%toggle = 0.0_wp
      if (problem%has_own_inputs()) then
         call look_at_positions()
         return
      end if
      inputs = [(real(i, wp)/real(steps, wp), i=0, steps)]
      associate (low => minval(problem%delt), high => maxval(problem%delt))
         if (summary%sliding_input) then
            call sweep(low + (high - low)*inputs, .false., none, summary)
         else
            call sweep(problem%delt(1) + sweep_sense(problem)*full_turn*inputs, .true., none, summary)
            summary%partial = .not. summary%everywhere .and. high > low .and. high - low < most_of_turn
         end if
         if (summary%partial) then
            part%sliding_input = summary%sliding_input
            part%motion = summary%motion
            call sweep(low + (high - low)*inputs, .false., none, part)
            summary%prescribed = range_t(input_of(problem, dimensions, low), input_of(problem, dimensions, high))
            summary%angle = part%angle
            summary%angle_loop = part%angle_loop
            summary%angle_input = part%angle_input
            summary%group_loop = part%group_loop
            summary%group_measure = part%group_measure
            summary%group_input = part%group_input
            summary%output = part%output
            summary%output_y = part%output_y
            summary%reverses = part%reverses
         end if
      end associate
      if (problem%motion /= motion_angle) summary%unbounded = max(-summary%output%low, summary%output%high, &
         -summary%output_y%low, summary%output_y%high) > far*maxval(dimensions%arcl)
      summary%kinds = kinds_of(fine%problem, dimensions, .false.)
      if (all(problem%plan%solved)) return
      ! a mechanism closes where all of its loops do
      whole%sliding_input = summary%sliding_input
      whole%motion = summary%motion
      associate (low => minval(problem%delt), high => maxval(problem%delt))
         if (summary%sliding_input) then
            call sweep(low + (high - low)*inputs, .false., any_joint, whole)
         else
            call sweep(problem%delt(1) + sweep_sense(problem)*full_turn*inputs, .true., any_joint, whole)
         end if
      end associate
      summary%output_everywhere = summary%everywhere
      summary%others_open = closed_length(whole) < closed_length(summary)
      if (.not. summary%others_open) return
      summary%everywhere = whole%everywhere
      summary%closing = whole%closing
      if (summary%undetermined_loop > 0) return
      summary%undetermined_loop = whole%undetermined_loop
      summary%undetermined_joints = whole%undetermined_joints
      summary%undetermined = whole%undetermined

   contains

      !> What the positions themselves tell.
      subroutine look_at_positions()
         integer :: loop

         summary%at_positions = .true.
         summary%everywhere = all(motion%closed)
         allocate (summary%closing(0), summary%reverses(0), summary%kinds(0))
         call prepare_samples(plain, problem%delt, .false., any_joint, .false., fine)
         call evaluate_samples(fine, dimensions)
         do i = 1, size(motion%closed)
            if (.not. motion%closed(i)) cycle
            do loop = 1, problem%mechanism%nloop
               associate (sine => min(abs(fine%k(i, loop)), 1.0_wp))
                  if (.not. problem%mechanism%is_closed(loop)) then
                     cycle
                  else if (.not. problem%mechanism%is_dyad(loop)) then
                     call enter_group(summary, loop, 1.0_wp - sine, real(i, wp))
                  else if (has_angle(problem%mechanism, loop) .and. (summary%angle_loop == 0 .or. &
                                                                     angle_of(sine) < summary%angle)) then
                     summary%angle = angle_of(sine)
                     summary%angle_loop = loop
                     summary%angle_input = real(i, wp)
                  end if
               end associate
            end do
         end do
      end subroutine look_at_positions

      !> Length of the range over which something closes.
      pure real(wp) function closed_length(found)
         type(summary_t), intent(in) :: found

         if (found%sliding_input) then
            closed_length = sum(found%closing%high - found%closing%low)
         else
            closed_length = sum(modulo(found%closing%high - found%closing%low, full_turn))
         end if
         if (found%everywhere) closed_length = huge(closed_length)
      end function closed_length

      !> Angle, closing and output over a row of inputs.
      subroutine sweep(row, turn, joints, found)
         real(wp), intent(in) :: row(:)
         logical, intent(in) :: turn        !! the row is a full turn: its end is its beginning
         integer, intent(in) :: joints(:, :) !! none: what the output does not depend on is left out
         type(summary_t), intent(inout) :: found
         real(wp), allocatable :: all_inputs(:)
         integer, allocatable :: loops(:)   !! by input: the loop that is undetermined there

         allocate (found%reverses(0), found%closing(0))
         call prepare_samples(plain, row, .false., joints, .false., fine)
         call prepare_samples(plain, row(:steps_of_refinement + 1), .false., joints, .false., refinement)
         call look(fine, dimensions, loops)
         call least_angle(fine, refinement, dimensions, found, gaps)
         if (size(gaps) > 0) then
            all_inputs = row
            call insert(gaps, all_inputs)
            call prepare_samples(plain, all_inputs, .false., joints, .false., fine)
            call look(fine, dimensions, loops)
            do i = 1, size(gaps)
               where (abs(all_inputs - gaps(i)) <= 0.0_wp) fine%closed = .false.
            end do
         end if
         if (any(loops > 0)) call note_undetermined(fine, dimensions, loops, turn, found)
         call follow(fine, refinement, dimensions, turn, found)
         if (found%undetermined_loop > 0) call meet_ends(found)
         if (row(2) >= row(1)) return
         do i = 1, size(found%closing)
            found%closing(i) = range_t(found%closing(i)%high, found%closing(i)%low)
         end do
         found%undetermined = range_t(found%undetermined%high, found%undetermined%low)
      end subroutine sweep
   end subroutine summarise_range

   !> See where it closes. Where the outer joints of a dyad coincide it does not: rounding would decide from step to step.
   subroutine look(samples, dimensions, loops)
      type(sample_set_t), intent(inout) :: samples
      type(dimensions_t), intent(in) :: dimensions
      integer, allocatable, intent(out) :: loops(:) !! by position: the loop that is undetermined, 0: none

      call evaluate_samples(samples, dimensions)
      allocate (loops(size(samples%closed)))
      call samples%problem%find_undetermined(loops)
      samples%closed = samples%closed .and. loops == 0
   end subroutine look

   !> The first range of the sweep that is undetermined; of a turn it may begin before the end and go on at the beginning.
   subroutine note_undetermined(fine, dimensions, loops, turn, summary)
      type(sample_set_t), intent(in) :: fine
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: loops(:)
      logical, intent(in) :: turn
      type(summary_t), intent(inout) :: summary
      integer :: n, begin, last, i

      n = size(loops)
      begin = findloc(loops > 0, .true., dim=1)
      if (begin == 1 .and. turn .and. any(loops == 0)) &
         begin = modulo(findloc(loops(:n - 1) > 0, .false., dim=1, back=.true.), n - 1) + 1
      last = begin
      do while (loops(modulo(last, n) + 1) > 0 .and. last < 2*n)
         if (.not. turn .and. last == n) exit
         last = last + 1
      end do
      last = modulo(last - 1, n) + 1
      summary%undetermined_loop = loops(begin)
      associate (mechanism => fine%problem%mechanism)
         summary%undetermined_joints = [(mechanism%arcs(mechanism%groups(loops(begin))%members(i))%joints(i), i=1, 2)]
      end associate
      summary%undetermined = range_t(input_of(fine%problem, dimensions, fine%problem%delt(begin)), &
                                    input_of(fine%problem, dimensions, fine%problem%delt(last)))
   end subroutine note_undetermined

   !> An undetermined range begins and ends where a range that closes does.
   pure subroutine meet_ends(summary)
      type(summary_t), intent(inout) :: summary
      real(wp), parameter :: step = full_turn/real(steps, wp)
      integer :: i

      if (summary%sliding_input) return
      do i = 1, size(summary%closing)
         associate (closing => summary%closing(i), range => summary%undetermined)
            if (abs(nearest_difference(range%low, closing%high)) <= step) range%low = closing%high
            if (abs(nearest_difference(range%high, closing%low)) <= step) range%high = closing%low
         end associate
      end do
   end subroutine meet_ends

   !> Root mean square and largest error; of points their distance.
   pure subroutine errors(problem, motion, summary)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(summary_t), intent(inout) :: summary
      real(wp), allocatable :: miss(:)

      summary%error_unit = output_unit(summary%motion == motion_angle)
      summary%compared = count(motion%closed)
      if (.not. problem%desired) summary%compared = 0
      if (summary%compared == 0) return
      miss = abs(motion%error(:, 1))
      if (size(motion%error, 2) > 1) miss = hypotenuse(motion%error(:, 1), motion%error(:, 2))
      summary%worst = maxloc(miss, dim=1, mask=motion%closed)
      summary%worst_input = motion%input(summary%worst)
      summary%largest = miss(summary%worst)
      if (summary%largest <= 0.0_wp) return
      ! relative to the largest, for squares of extreme lengths overflow
      summary%rms = summary%largest*sqrt(sum((miss/summary%largest)**2, mask=motion%closed)/real(summary%compared, wp))
   end subroutine errors

   !> Errors of the outputs of a sketch that have desired values of their own. Where there are no others those of the first of these
   !> are the errors of the linkage.
   pure subroutine summarise_targets(set, targets, motion, summary)
      type(data_set_t), intent(in) :: set
      class(output_targets_t), intent(in) :: targets    !! compared at the positions
      type(motion_t), intent(in) :: motion            !! at the same positions
      type(summary_t), intent(inout) :: summary
      type(target_group_t), allocatable :: groups(:)
      real(wp), allocatable :: miss(:)
      logical, allocatable :: counts(:)
      integer :: k, c

      groups = target_groups(set%sketch)
      allocate (summary%targets(size(groups)))
      do k = 1, size(groups)
         associate (errors => summary%targets(k), group => groups(k))
            errors%name = group%name
            errors%number = group%number
            errors%order = group%order
            errors%unit = number_unit(set%sketch%outputs, group%number, per_input(summary%sliding_input), group%order)
            allocate (miss(size(targets%miss, 1)), source=0.0_wp)
            allocate (counts(size(miss)), source=.false.)
            do c = 1, size(group%columns)
               associate (n => group%columns(c))
                  where (targets%exists(:, n) .and. targets%problem%target_weights(:, n) > 0.0_wp)
                     miss = hypotenuse(miss, targets%miss(:, n))
                     counts = .true.
                  end where
               end associate
            end do
            errors%compared = count(counts)
            if (errors%compared > 0) then
               errors%worst = maxloc(miss, dim=1, mask=counts)
               errors%worst_input = motion%input(errors%worst)
               errors%largest = miss(errors%worst)
               if (errors%largest > 0.0_wp) errors%rms = errors%largest*sqrt(sum((miss/errors%largest)**2, mask=counts) &
                                                                             /real(errors%compared, wp))
            end if
            deallocate (miss, counts)
         end associate
      end do
      if (allocated(set%sketch%equalities)) then
         allocate (summary%equals(size(set%sketch%equalities)))
         do k = 1, size(summary%equals)
            summary%equals(k)%words = equality_words(set%sketch, k)
            summary%equals(k)%known = all([(both_exist(targets, c) .or. targets%relations(c)%equality /= k, &
                                                 c=1, size(targets%relations))])
            summary%equals(k)%largest = maxval(abs(targets%difference), mask=targets%relations%equality == k)
         end do
      end if
      if (.not. targets%problem%blank .or. size(groups) == 0) return
      summary%of_targets = .true.
      associate (first => summary%targets(first_target(groups)))
         summary%compared = first%compared
         summary%rms = first%rms
         summary%largest = first%largest
         summary%error_unit = first%unit
         summary%worst = first%worst
         summary%worst_input = first%worst_input
      end associate
   end subroutine summarise_targets

   !> The same of derivatives by the input, where they are wanted; of a pose those of its point, or of its angle if those alone are.
   pure subroutine errors_of_rates(problem, motion, rates)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion           !! with derivatives
      type(rate_errors_t), intent(inout) :: rates(:) !! by order
      real(wp), allocatable :: miss(:)
      logical, allocatable :: counts(:)
      integer :: order, angle

      angle = size(motion%rates, 2)
      do order = 1, size(rates)
         counts = motion%has_rates .and. any(problem%rate_weight(:, :min(2, size(motion%rates, 2)), order) > 0.0_wp, dim=2)
         rates(order)%of_angle = angle > 2 .and. .not. any(counts)
         if (rates(order)%of_angle) counts = motion%has_rates .and. problem%rate_weight(:, angle, order) > 0.0_wp
         rates(order)%compared = count(counts)
         if (rates(order)%compared == 0) cycle
         miss = abs(motion%rate_error(:, 1, order))
         if (rates(order)%of_angle) then
            miss = abs(motion%rate_error(:, angle, order))
         else if (angle > 1) then
            miss = hypotenuse(motion%rate_error(:, 1, order), motion%rate_error(:, 2, order))
         end if
         rates(order)%worst = maxloc(miss, dim=1, mask=counts)
         rates(order)%largest = miss(rates(order)%worst)
         if (rates(order)%largest <= 0.0_wp) cycle
         rates(order)%rms = rates(order)%largest*sqrt(sum((miss/rates(order)%largest)**2, mask=counts) &
                                                      /real(rates(order)%compared, wp))
      end do
   end subroutine errors_of_rates

   !> Least transmission angle where the linkage closes, and inputs between the steps at which it does not.
   subroutine least_angle(fine, refinement, dimensions, summary, gaps)
      type(sample_set_t), intent(inout) :: fine, refinement
      type(dimensions_t), intent(in) :: dimensions
      type(summary_t), intent(inout) :: summary
      real(wp), allocatable, intent(out) :: gaps(:)
      real(wp), allocatable :: sine(:)
      real(wp) :: at, worst, enough
      type(form_t) :: form
      integer :: loop, i, n

      allocate (gaps(0))
      n = size(fine%closed)
      worst = -1.0_wp
      associate (mechanism => fine%problem%mechanism)
         do loop = 1, mechanism%nloop
            if (fine%problem%linkage%step_of_loop(loop) == 0 .or. .not. mechanism%is_closed(loop)) cycle
            form = form_of(mechanism%groups(loop)%kind)
            select case (merge(form%ways, 2, mechanism%is_dyad(loop)))
            case (2)
               sine = abs(fine%k(:, loop))
               do i = 1, n
                  if (.not. fine%closed(i)) cycle
                  if (has_angle(mechanism, loop)) call enter(loop, min(sine(i), 1.0_wp), fine%problem%delt(i))
                  enough = max(worst, near_toggle)
                  if (.not. mechanism%is_dyad(loop)) then
                     call enter_group(summary, loop, 1.0_wp - sine(i), fine%problem%delt(i))
                     enough = min(near_toggle, 1.0_wp - summary%group_measure)
                  end if
                  ! a peak may be higher between the steps
                  if (sine(i) < enough - 2.0_wp*abs(sine(max(i - 1, 1)) - sine(min(i + 1, n)))) cycle
                  if (sine(i) < sine(max(i - 1, 1)) .or. sine(i) < sine(min(i + 1, n))) cycle
                  call climb(loop, i)
               end do
            case (1)
               call cross(loop)
            end select
         end do
      end associate
      if (summary%angle_loop > 0) summary%angle_input = input_of(fine%problem, dimensions, summary%angle_input)
      if (summary%group_loop > 0) summary%group_input = input_of(fine%problem, dimensions, summary%group_input)

   contains

      subroutine enter(which, value, delt)
         integer, intent(in) :: which
         real(wp), intent(in) :: value, delt

         if (value <= worst) return
         worst = value
         summary%angle = angle_of(value)
         summary%angle_loop = which
         summary%angle_input = delt
      end subroutine enter

      !> The peak between the neighbours of step `from`.
      subroutine climb(which, from)
         integer, intent(in) :: which, from
         real(wp) :: reach, best
         integer :: round, j

         at = fine%problem%delt(from)
         reach = abs(fine%problem%delt(2) - fine%problem%delt(1))
         do round = 1, refinements/2
            call aim(refinement, dimensions, fine, at - reach, at + reach)
            best = -1.0_wp
            do j = 1, steps_of_refinement + 1
               if (abs(refinement%k(j, which)) <= best) cycle
               best = abs(refinement%k(j, which))
               at = refinement%problem%delt(j)
               if (.not. refinement%closed(j)) then
                  gaps = [gaps, at]
                  return
               end if
            end do
            reach = 2.0_wp*reach/real(steps_of_refinement, wp)
         end do
         if (has_angle(fine%problem%mechanism, which)) call enter(which, min(best, 1.0_wp), at)
         if (.not. fine%problem%mechanism%is_dyad(which)) call enter_group(summary, which, 1.0_wp - best, at)
      end subroutine climb

      !> Two slides are parallel where the sine of their angle changes its sign.
      subroutine cross(which)
         integer, intent(in) :: which
         real(wp) :: sines(n), part(steps_of_refinement + 1)
         integer :: j, round, m

         call fine%problem%bind(dimensions)
         call fine%problem%measure_of(which, sines)
         do j = 1, n - 1
            if (sines(j)*sines(j + 1) > 0.0_wp) cycle
            call aim(refinement, dimensions, fine, fine%problem%delt(j), fine%problem%delt(j + 1))
            do round = 1, refinements
               call refinement%problem%measure_of(which, part)
               do m = 1, steps_of_refinement - 1
                  if (part(m)*part(m + 1) <= 0.0_wp) exit
               end do
               at = refinement%problem%delt(m)
               if (abs(part(m + 1)) < abs(part(m))) at = refinement%problem%delt(m + 1)
               call aim(refinement, dimensions, fine, refinement%problem%delt(m), refinement%problem%delt(m + 1))
            end do
            if (size(gaps) > 0) then
               if (abs(gaps(size(gaps)) - at) <= abs(fine%problem%delt(2) - fine%problem%delt(1))) cycle
            end if
            gaps = [gaps, at]
         end do
      end subroutine cross
   end subroutine least_angle

   !> The larger group that comes nearest to a dead point.
   pure subroutine enter_group(summary, loop, measure, input)
      type(summary_t), intent(inout) :: summary
      integer, intent(in) :: loop
      real(wp), intent(in) :: measure, input

      if (measure > summary%group_measure) return
      summary%group_measure = max(measure, 0.0_wp)
      summary%group_loop = loop
      summary%group_input = input
   end subroutine enter_group

   !> Link pairs and links on slides have a transmission angle.
   pure logical function has_angle(mechanism, loop)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop

      has_angle = any(mechanism%groups(loop)%kind == [assur_rrr, assur_rrp, assur_prr])
   end function has_angle

   !> Transmission angle of a sine of its deviation from 90 degrees; stretched or folded links are so but for rounding.
   pure real(wp) function angle_of(sine)
      real(wp), intent(in) :: sine

      angle_of = right_angle - arc_sine(min(sine, 1.0_wp))
      if (angle_of < rounding_of_angle) angle_of = 0.0_wp
   end function angle_of

   !> Look at even steps between two inputs, within the range of the sweep unless it is a turn.
   subroutine aim(refinement, dimensions, fine, from, to)
      type(sample_set_t), intent(inout) :: refinement
      type(dimensions_t), intent(in) :: dimensions
      type(sample_set_t), intent(in) :: fine
      real(wp), intent(in) :: from, to
      real(wp) :: low, high
      integer :: i

      low = from
      high = to
      if (abs(fine%problem%delt(size(fine%closed)) - fine%problem%delt(1)) < full_turn .or. &
          fine%problem%mechanism%sliding_input) then
         low = min(max(from, minval(fine%problem%delt)), maxval(fine%problem%delt))
         high = min(max(to, minval(fine%problem%delt)), maxval(fine%problem%delt))
      end if
      call refinement%problem%move_inputs([(low + (high - low)*(real(i, wp)/real(steps_of_refinement, wp)), i=0, &
                                           steps_of_refinement)])
      call evaluate_samples(refinement, dimensions)
   end subroutine aim

   !> Put further inputs among those of a sweep.
   pure subroutine insert(more, inputs)
      real(wp), intent(in) :: more(:)
      real(wp), allocatable, intent(inout) :: inputs(:)
      real(wp) :: sense
      integer :: i, k

      sense = sign(1.0_wp, inputs(2) - inputs(1))
      do i = 1, size(more)
         k = count(sense*inputs < sense*more(i))
         if (k < size(inputs)) then
            if (abs(inputs(k + 1) - more(i)) <= 0.0_wp) cycle
         end if
         inputs = [inputs(:k), more(i), inputs(k + 1:)]
      end do
   end subroutine insert

   !> Ranges in which the linkage closes, and what the output does there.
   subroutine follow(fine, refinement, dimensions, turn, summary)
      type(sample_set_t), intent(inout) :: fine, refinement
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in) :: turn
      type(summary_t), intent(inout) :: summary
      real(wp) :: from, to, height, before, turned
      logical :: first
      integer :: i, n, begin, start, direction, last_direction, first_direction

      n = size(fine%closed)
      summary%everywhere = all(fine%closed)
      first = .true.
      start = 1
      ! the sweep of a turn ends where it began: begin with an open input, if there is one
      if (turn .and. .not. summary%everywhere) then
         start = max(1, findloc(fine%closed(:n - 1), .false., dim=1))
         call rotate(fine, start)
      end if
      begin = 0
      do i = 1, n
         if (.not. fine%closed(i)) cycle
         if (begin == 0) begin = i
         if (i < n) then
            if (fine%closed(i + 1)) cycle
         end if
         call one_span()
         begin = 0
      end do

   contains

      !> Closes from step `begin` to step i.
      subroutine one_span()
         integer :: j

         from = fine%problem%delt(begin)
         to = fine%problem%delt(i)
         before = fine%out(begin, 1)
         call enter(before, second(fine, begin))
         if (begin > 1) call find_end(fine%problem%delt(begin - 1), from, before)
         last_direction = 0
         first_direction = 0
         before = fine%out(begin, 1)
         height = before
         turned = 0.0_wp
         do j = begin + 1, i
            turned = step_between(fine%out(j - 1, 1), fine%out(j, 1))
            height = height + turned
            call enter(height, second(fine, j))
            if (j < i) call enter(height, summit([second(fine, j - 1), second(fine, j), second(fine, j + 1)]))
            direction = 0
            if (abs(turned) > still*size_of(fine, dimensions)) direction = nint(sign(1.0_wp, turned))
            if (direction == 0) cycle
            if (first_direction == 0) first_direction = direction
            if (last_direction*direction < 0) call peak(j - 1, height - turned, last_direction)
            last_direction = direction
         end do
         if (i < n) call find_end(fine%problem%delt(i + 1), to, height)
         ! a turn goes on at its beginning
         if (summary%everywhere .and. turn) then
            if (first_direction*last_direction < 0) call peak(n, height, last_direction)
            call enter(height, summit([second(fine, n - 1), second(fine, n), second(fine, 2)]))
            if (summary%motion == motion_angle) summary%turns = abs(height - fine%out(1, 1)) > right_angle
         end if
         summary%closing = [summary%closing, &
                            range_t(input_of(fine%problem, dimensions, from), input_of(fine%problem, dimensions, to))]
      end subroutine one_span

      pure real(wp) function step_between(a, b)
         real(wp), intent(in) :: a, b

         step_between = b - a
         if (summary%motion == motion_angle) step_between = nearest_difference(b, a)
      end function step_between

      subroutine enter(value, y)
         real(wp), intent(in) :: value, y

         if (first) then
            summary%output = range_t(value, value)
            summary%output_y = range_t(y, y)
            first = .false.
         end if
         summary%output = range_t(min(summary%output%low, value), max(summary%output%high, value))
         summary%output_y = range_t(min(summary%output_y%low, y), max(summary%output_y%high, y))
      end subroutine enter

      !> Where it ceases to close between a closed input and an open one; the output there.
      subroutine find_end(open, closed, value)
         real(wp), intent(in) :: open, value
         real(wp), intent(inout) :: closed
         real(wp) :: beyond, there(2)
         real(wp), allocatable :: near(:) ! by loop, there
         logical :: undetermined         ! beyond the end joints coincide
         integer :: round, j, loops(steps_of_refinement + 1)

         undetermined = .false.
         beyond = open
         do round = 1, refinements
            call aim(refinement, dimensions, fine, closed, beyond)
            call refinement%problem%find_undetermined(loops)
            if (round == 1) undetermined = loops(size(loops)) > 0
            if (undetermined) refinement%closed = refinement%closed .and. loops == 0
            ! nearer to its end than rounding allows a larger group may stop elsewhere when it is followed again
            if (any(refinement%problem%mechanism%groups%kind == assur_higher) .and. .not. refinement%closed(1)) exit
            do j = 1, steps_of_refinement
               if (.not. refinement%closed(j + 1)) exit
            end do
            j = min(j, steps_of_refinement)
            closed = refinement%problem%delt(j)
            beyond = refinement%problem%delt(j + 1)
            there = [refinement%out(j, 1), second(refinement, j)]
            near = abs(refinement%k(j, :))
         end do
         if (.not. allocated(near)) return
         call enter(value + step_between(value, there(1)), there(2))
         do round = 1, refinement%problem%mechanism%nloop
            if (refinement%problem%linkage%step_of_loop(round) == 0) cycle
            if (.not. refinement%problem%mechanism%is_dyad(round)) &
               call enter_group(summary, round, 1.0_wp - near(round), input_of(fine%problem, dimensions, closed))
            if (.not. has_angle(refinement%problem%mechanism, round)) cycle
            if (angle_of(near(round)) >= summary%angle) cycle
            summary%angle = angle_of(near(round))
            summary%angle_loop = round
            summary%angle_input = input_of(fine%problem, dimensions, closed)
         end do
      end subroutine find_end

      !> The extreme of the output near step j.
      subroutine peak(j, value, up)
         integer, intent(in) :: j, up
         real(wp), intent(in) :: value
         real(wp) :: at, reach, best, here, y
         integer :: round, m

         at = fine%problem%delt(j)
         reach = abs(fine%problem%delt(2) - fine%problem%delt(1))
         best = 0.0_wp
         y = second(fine, j)
         do round = 1, refinements/2
            call aim(refinement, dimensions, fine, at - reach, at + reach)
            do m = 1, steps_of_refinement + 1
               if (.not. refinement%closed(m)) cycle
               here = real(up, wp)*step_between(value, refinement%out(m, 1))
               if (here <= best) cycle
               best = here
               at = refinement%problem%delt(m)
               y = second(refinement, m)
            end do
            reach = 2.0_wp*reach/real(steps_of_refinement, wp)
         end do
         call enter(value + real(up, wp)*best, y)
         if (summary%motion /= motion_point) summary%reverses = [summary%reverses, input_of(fine%problem, dimensions, at)]
      end subroutine peak
   end subroutine follow

   !> Vertex of the parabola through three even steps, if the middle one is the highest or lowest.
   pure real(wp) function summit(y)
      real(wp), intent(in) :: y(3)
      real(wp) :: bend

      summit = y(2)
      bend = (y(3) - y(2)) - (y(2) - y(1))
      if ((y(3) - y(2))*(y(2) - y(1)) < 0.0_wp) summit = y(2) - (y(3) - y(1))**2/(8.0_wp*bend)
   end function summit

   !> Let the sweep of a turn begin at another step.
   subroutine rotate(fine, start)
      type(sample_set_t), intent(inout) :: fine
      integer, intent(in) :: start
      real(wp) :: turn
      integer :: n, c

      n = size(fine%closed)
      turn = fine%problem%delt(n) - fine%problem%delt(1)
      fine%problem%delt = [fine%problem%delt(start:n - 1), fine%problem%delt(:start) + turn]
      fine%closed = [fine%closed(start:n - 1), fine%closed(:start)]
      fine%out = reshape([(fine%out(start:n - 1, c), fine%out(:start, c), c=1, size(fine%out, 2))], shape(fine%out))
   end subroutine rotate

   !> Second component of the output, 0 if there is none.
   pure real(wp) function second(samples, i)
      type(sample_set_t), intent(in) :: samples
      integer, intent(in) :: i

      second = 0.0_wp
      if (size(samples%out, 2) > 1) second = samples%out(i, 2)
   end function second

   !> What a change of the output is compared with: a turn, or the longest arc.
   pure real(wp) function size_of(fine, dimensions)
      type(sample_set_t), intent(in) :: fine
      type(dimensions_t), intent(in) :: dimensions

      size_of = full_turn
      if (fine%problem%motion /= motion_angle) size_of = maxval(dimensions%arcl)
   end function size_of

   pure real(wp) function input_of(problem, dimensions, delt)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: delt

      input_of = reference_input(problem%mechanism, dimensions) + delt
      if (problem%mechanism%sliding_input) return
      if (abs(input_of - anint(input_of)) < rounding_of_input) input_of = anint(input_of)
      input_of = input_in_turn(problem%mechanism, input_of)
   end function input_of

   !> Loops that are a four-bar or a slider-crank driven at the input crank.
   !>
   !> `exactly`: four-bars of four lengths as given alone, of which no rounding is forgiven.
   function kinds_of(problem, dimensions, exactly) result(kinds)
      type(problem_t), intent(in) :: problem       !! bound to the dimensions
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in) :: exactly
      type(loop_kind_t), allocatable :: kinds(:)
      real(wp) :: crank, frame, x, y, c, s, across, link
      integer :: loop, p, q, a

      allocate (kinds(0))
      if (problem%mechanism%sliding_input) return
      associate (mechanism => problem%mechanism, plan => problem%plan)
         do loop = 1, mechanism%nloop
            if (problem%linkage%step_of_loop(loop) == 0 .or. .not. mechanism%is_dyad(loop)) cycle
            p = mechanism%place(1, loop)
            q = mechanism%place(2, loop)
            if (p < 2) cycle
            if (any(plan%root([(mechanism%seq(loop, a), a=1, p - 1)]) /= root_crank)) cycle
            if (any(plan%root([(mechanism%seq(loop, a), a=q + 1, mechanism%loops(loop)%arcs)]) /= root_frame)) cycle
            if (exactly .and. (p /= 2 .or. q /= mechanism%loops(loop)%arcs - 1 .or. mechanism%groups(loop)%kind /= assur_rrr)) cycle
            call sum_of_arcs(loop, 1, p - 1, crank, x, y)
            call sum_of_arcs(loop, q + 1, mechanism%loops(loop)%arcs, frame, x, y)
            link = dimensions%arcl(mechanism%seq(loop, p))
            select case (mechanism%groups(loop)%kind)
            case (assur_rrr)
               kinds = [kinds, loop_kind_t(loop, kind_of_four_bar(crank, link, dimensions%arcl(mechanism%seq(loop, q)), frame, &
                                                                  exactly))]
            case (assur_rrp)
               c = problem%linkage%x(mechanism%seq(loop, q))
               s = problem%linkage%y(mechanism%seq(loop, q))
               across = abs(c*y - s*x)
               kinds = [kinds, loop_kind_t(loop, merge(kind_slider_turning, kind_slider_swinging, &
                                                       crank + across <= link*(1.0_wp + rounding)))]
            end select
         end do
      end associate

   contains

      !> Length and components of consecutive arcs of one body, in the axes of their root.
      pure subroutine sum_of_arcs(which, from, to, length, sx, sy)
         integer, intent(in) :: which, from, to
         real(wp), intent(out) :: length, sx, sy
         integer :: a, n

         sx = 0.0_wp
         sy = 0.0_wp
         do a = from, to
            n = problem%mechanism%seq(which, a)
            sx = sx + problem%linkage%x(n)*dimensions%arcl(n)
            sy = sy + problem%linkage%y(n)*dimensions%arcl(n)
         end do
         length = hypotenuse(sx, sy)
         if (from == to) length = dimensions%arcl(problem%mechanism%seq(which, from))
      end subroutine sum_of_arcs
   end function kinds_of

   !> Kind of a four-bar by the rule of Grashof: shortest and longest link against the other two.
   pure integer function kind_of_four_bar(crank, coupler, follower, frame, exactly) result(kind)
      real(wp), intent(in) :: crank, coupler, follower, frame   !! lengths; the input turns the crank
      logical, intent(in) :: exactly                            !! else sums equal but for rounding are equal
      real(wp) :: links(4), signs(4), excess

      links = [crank, coupler, follower, frame]
      if (exactly) then
         signs = -1.0_wp
         signs(minloc(links, dim=1)) = 1.0_wp
         signs(maxloc(links, dim=1, back=.true.)) = 1.0_wp
         excess = real(sign_of_sum(signs*links), wp)
      else
         excess = 2.0_wp*(minval(links) + maxval(links)) - sum(links)
         if (abs(excess) <= rounding*sum(links)) excess = 0.0_wp
      end if
      if (abs(excess) <= 0.0_wp) then
         kind = kind_change_point
      else if (excess > 0.0_wp) then
         kind = kind_triple_rocker
      else
         select case (minloc(links, dim=1))
         case (1)
            kind = kind_crank_rocker
         case (2)
            kind = kind_double_rocker
         case (3)
            kind = kind_rocker_crank
         case default
            kind = kind_double_crank
         end select
      end if
   end function kind_of_four_bar
end module psalm_summary
