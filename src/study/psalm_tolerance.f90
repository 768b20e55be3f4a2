!> What small deviations of the dimensions do to the output.
!>
!> Linear: the Jacobian times the tolerances, dimension by dimension; worst case (all add up) and root-sum-square over the
!> motion. Real: a Monte-Carlo sample of linkages whose dimensions deviate within their tolerances, uniformly if nothing else is
!> asked for, shared out to threads in chunks, whose random numbers are streams of their own: the same bits for any number of
!> threads.
!> Source: Oldham (1977), section 8.2.5 and chapter 1.
module psalm_tolerance
   use psalm_angles, only: nearest_difference, unit_vector
   use psalm_closure, only: most_orders
   use psalm_column_names, only: output_name
   use psalm_adjustment, only: adjustment_t, find_adjustments
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t, inputs_of, new_problem, own_inputs_at, follows_drawing
   use psalm_stop, only: stop_t
   use psalm_joint_location, only: locate_sketch
   use psalm_joint_play, only: play_t, play_anywhere, play_loaded
   use psalm_kinds, only: wp, full_turn
   use psalm_lanes, only: lanes
   use psalm_linkage, only: padded
   use psalm_linkage_lanes, only: linkage_lanes_t
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_output_kind, only: output_kind_t
   use psalm_proof_deviation, only: deviation_model_t, enclosure_t, make_deviation_model, enclose_number, enclose_unknowns
   use psalm_rates, only: form_frames, is_dead
   use psalm_sample_sums, only: enter_sample
   use psalm_sensitivity, only: sensitivity_t, wanted_outputs_t, prepare_sensitivity, find_jacobian
   use psalm_sketch, only: sketch_t, sketch_output_t, output_angle, output_pose, output_ratio, columns_of
   use psalm_sketch_motion, only: find_places
   use psalm_sketch_outputs, only: names_of_numbers, name_length, values_of_outputs
   use psalm_deviating_dimensions, only: deviating_dimensions, tolerance_of, tolerances_apart
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t, variable_t, no_parameters, name_of, variable_crnki, variable_length, variable_gama, &
                               variable_outlk, variable_outang, variable_origlk, variable_origng
   use psalm_sum_law, only: law_uniform, law_triangle, law_normal, normal_of_disc, standard_normal
   use psalm_tolerance_group, only: tolerance_group_t
   use psalm_xoshiro, only: xoshiro_t, purpose_sample
   implicit none (type, external)
   private
   public :: tolerances_t, tolerance_t, sample_t, deviating_t, study_tolerances, find_tolerances, draw_sample
   public :: enclose_bands, find_deviations
   public :: add_plays, column_length, allowance_t, allowances_of, names_of_tolerances, dimensions_to_allot, allot, correlate

   integer, parameter :: linkages_of_stream = 1000 !! of the random numbers
   integer, parameter :: least_chunk = 1000     !! linkages of a chunk; sums are formed by chunk and added in order
   integer, parameter :: most_chunks = 1000     !! larger samples have larger chunks
   integer, parameter :: chunks_at_once = 4     !! of each thread: between these rounds sums are added
   integer, parameter :: numbers_at_once = 5000000 !! of all chunks between them, where a sample is shared
   integer, parameter :: solved_unasked = 20000 !! positions between two looks whether the sample must end
   integer, parameter :: most_named = 10        !! linkages of the sample that are named because they do not close
   integer, parameter :: column_length = 120      !! characters of the name of a dimension
   integer, parameter :: halvings = 40            !! of the range of a factor that is looked for

   !> The linkage with every dimension that has a tolerance as a variable.
   type :: deviating_t
      private
      class(problem_t), allocatable :: problem     !! for derivatives
      class(problem_t), allocatable :: lean        !! the same, for positions alone
      type(sampled_t), allocatable :: outputs      !! of a sketch; not allocated: the first output alone
   end type deviating_t

   !> All outputs of a sketch, for the sample.
   type :: sampled_t
      type(sketch_motion_t) :: sketch              !! its points are in the plan of the lean problem
      type(sketch_output_t), allocatable :: outputs(:)
      logical, allocatable :: known(:)             !! shape (numbers): it is no ratio of rates
      logical, allocatable :: angle(:)             !! shape (numbers): deviations are degrees
      integer, allocatable :: apart(:)             !! joints that move and stand off the arcs: they deviate by themselves
      integer :: listed = 0                        !! the one of these that is the output of the loops, which OUTLK and OUTANG move
      real(wp), allocatable :: along(:), turn(:)   !! tolerances of their distances and angles, length and degrees
      real(wp), allocatable :: nominal(:, :)       !! shape (positions, numbers)
   end type sampled_t

   !> Bands of all outputs of a sketch. Columns are the dimensions with a tolerance, then those of joints that stand off the arcs:
   !> their distance and their angle.
   type :: output_bands_t
      character(name_length), allocatable :: names(:) !! of the numbers
      logical, allocatable :: known(:)             !! shape (numbers): it is no ratio of rates
      logical, allocatable :: turns(:)             !! shape (numbers): deviations are degrees
      real(wp), allocatable :: worst(:, :)         !! shape (positions, numbers): worst case
      real(wp), allocatable :: square(:, :)        !! the same shape: root-sum-square
      real(wp), allocatable :: effect(:, :)        !! shape (columns, numbers): largest amount over the positions
      integer, allocatable :: apart(:)             !! joints of the sketch that stand off the arcs
      real(wp), allocatable :: of_apart(:)         !! tolerances of their distances and angles, in turn
      real(wp), allocatable :: change(:, :, :)     !! shape (positions, columns, numbers): change of the outputs with each
   end type output_bands_t

   !> The linear picture.
   type :: tolerance_t
      type(dimensions_t) :: dimensions             !! the nominal linkage
      type(motion_t) :: nominal                    !! its motion
      type(output_kind_t) :: kind                  !! of the output
      type(variable_t), allocatable :: variables(:) !! shape (nvar): the dimensions with a tolerance
      real(wp), allocatable :: tolerance(:)        !! shape (nvar)
      real(wp), allocatable :: effect(:, :, :)     !! shape (positions, nvar, components): change of the output with each
      real(wp), allocatable :: worst(:, :)         !! shape (positions, components): worst case
      real(wp), allocatable :: square(:, :)        !! shape (positions, components): root-sum-square
      logical, allocatable :: dead(:)              !! shape (positions): a dead point, where the effects are infinite
      type(output_bands_t), allocatable :: bands   !! of a sketch: all its outputs
      integer :: law = law_uniform                 !! of the deviations of a sample: one of `law_...`
      integer, allocatable :: group(:)             !! shape (nvar): correlated group of each; 0: none. Not allocated: there are none
      real(wp), allocatable :: own(:), common(:)   !! shape (nvar): parts of the tolerance: own deviation, that of its group
      type(play_t), allocatable :: plays(:)        !! joints with clearance, whose effects a sample adds; not allocated: none
      real(wp), allocatable :: clearance(:)        !! shape (plays), user's length
   end type tolerance_t

   !> The dimensions to which tolerances can be allotted.
   type :: allowance_t
      character(column_length), allocatable :: names(:) !! shape (dimensions), of listings
      integer, allocatable :: column(:)            !! shape (dimensions): of the tolerances; clearances, the last, have none
      logical, allocatable :: is_angle(:)          !! shape (dimensions): its tolerance is in degrees
      real(wp), allocatable :: size(:)             !! shape (dimensions): the length; of angles 0
      real(wp), allocatable :: given(:)            !! shape (dimensions): tolerance that the case has
      character(name_length), allocatable :: numbers(:) !! shape (numbers): of the outputs
      logical, allocatable :: known(:)             !! shape (numbers): its changes are
      logical, allocatable :: turns(:)             !! shape (numbers): degrees
      real(wp), allocatable :: change(:, :, :)     !! shape (positions, dimensions, numbers): by a tolerance of 1
      type(play_t), allocatable :: plays(:)        !! joints with clearance; not allocated: none
   end type allowance_t

   !> The sample.
   type :: sample_t
      integer :: trials = 0                        !! linkages analysed: fewer than asked for if the sample had to end early
      logical :: any_closed = .false.              !! there is something to tell of
      integer :: open = 0                          !! linkages that do not close at some position
      integer :: named(most_named) = 0             !! the first of them
      integer :: loop(most_named) = 0              !! and the loop that fails
      real(wp), allocatable :: low(:, :), high(:, :), mean(:, :), deviation(:, :) !! shape (positions, columns): components of the
                                                   !! first output; of a sketch then the numbers of all outputs
      integer :: kept = 0                          !! linkages within all bands of a sample that has some
      real(wp), allocatable :: beyond(:, :)        !! the same shape: linkages beyond the band, or that do not close
   end type sample_t

   !> Results.
   type :: tolerances_t
      logical :: closes = .false.                  !! the nominal linkage closes everywhere; else there is nothing more
      type(tolerance_t) :: linear
      type(sample_t) :: sample
      type(adjustment_t), allocatable :: adjustments(:) !! ADJUST=1 and no dead point
      integer :: trials = 0                        !! linkages of the sample that were asked for
      logical :: out_of_time = .false.             !! MAXTIME passed
   contains
      procedure :: is_violating
   end type tolerances_t

contains

   !> Bands of the output within the tolerances of the dimensions, and the sample if one is asked for (NTRIAL).
   subroutine study_tolerances(set, mechanism, dimensions, threads, stop, result, delt, given, analysed)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions !! the nominal linkage
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop             !! asked now and then by the sample
      type(tolerances_t), intent(out) :: result
      real(wp), intent(in), optional :: delt(:)    !! increments of the input in place of those of the case
      type(problem_t), intent(in), optional :: given    !! see `find_tolerances`
      type(motion_t), intent(in), optional :: analysed
      type(deviating_t), allocatable :: deviating
      type(stop_t) :: limited

      limited = stop
      call limited%limit_time(set%search%maxtime)
      result%trials = set%toler%ntrial
      allocate (deviating)
      call find_tolerances(set, mechanism, dimensions, deviating, result%linear, result%closes, delt, given=given, &
                           analysed=analysed)
      if (result%closes .and. set%toler%adjusted) then
         if (.not. any(result%linear%dead)) result%adjustments = find_adjustments(result%linear%effect, result%linear%tolerance)
      end if
      if (.not. result%closes .or. set%toler%ntrial == 0) return
      call draw_sample(deviating, result%linear, set%toler%ntrial, set%method%istart, threads, result%sample, limited)
      result%out_of_time = limited%late()
   end subroutine study_tolerances

   !> True if the bands are infinite somewhere, or the sample ended early or has linkages that do not close.
   pure logical function is_violating(self)
      class(tolerances_t), intent(in) :: self

      is_violating = .false.
      if (.not. self%closes) return
      is_violating = any(self%linear%dead) .or. self%sample%trials < self%trials .or. self%sample%open > 0
   end function is_violating

   !> Jacobian and linear bands of a linkage. `dimensions` must close at every position.
   subroutine find_tolerances(set, mechanism, dimensions, deviating, result, closes, delt, every_loop, of_lengths, given, &
                              analysed)
      type(data_set_t), intent(in) :: set          !! its tolerances and input positions
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(deviating_t), intent(out) :: deviating
      type(tolerance_t), intent(out) :: result
      logical, intent(out) :: closes
      real(wp), intent(in), optional :: delt(:)    !! increments of the input in place of those of the case
      logical, intent(in), optional :: every_loop  !! and not those of the output alone; without it as KTHETA says
      real(wp), intent(in), optional :: of_lengths !! tolerance of all lengths where the case has no tolerances
      type(problem_t), intent(in), optional :: given !! a problem of this linkage that has been analysed
      type(motion_t), intent(in), optional :: analysed !! its motion; both arguments or neither
      type(parameters_t) :: parameters
      type(tolerance_group_t) :: toler
      real(wp), allocatable :: inputs(:)
      type(wanted_outputs_t), allocatable :: wanted ! of a sketch; large as well
      logical, allocatable :: turning(:)
      logical :: everywhere, by_name
      type(sensitivity_t), allocatable :: work   ! large: it would fill a small stack
      integer :: v, nvar, n

      result%dimensions = dimensions
      toler = tolerances_of(set, of_lengths)
      parameters = deviating_dimensions(set, toler, mechanism)
      allocate (deviating%problem)
      if (present(delt)) then
         inputs = delt
      else
         inputs = inputs_of(set)
      end if
      everywhere = set%limits%ktheta /= 0
      if (present(every_loop)) everywhere = every_loop
      call new_problem(mechanism, dimensions, parameters, inputs, everywhere, deviating%problem, own_inputs_at(set, inputs))
      deviating%problem%followed = follows_drawing(set, mechanism)
      allocate (deviating%lean, source=deviating%problem)
      by_name = size(set%sketch%outputs) > 0
      if (by_name) then
         allocate (wanted)
         call locate_sketch(set, wanted%sketch, dimensions)
         wanted%outputs = set%sketch%outputs
         call deviating%problem%want_derivatives(.true., wanted%sketch%points)
      else
         call deviating%problem%want_derivatives(.false.)
      end if
      if (is_known()) then
         result%nominal = analysed
         call deviating%problem%bind(dimensions)
      else
         call deviating%problem%analyse(dimensions, result%nominal)
      end if
      closes = all(result%nominal%closed)
      if (.not. closes) return
      result%variables = parameters%variables
      result%kind = deviating%problem%output%kind
      nvar = size(parameters%variables)
      n = deviating%problem%positions
      allocate (result%tolerance(nvar), result%effect(n, nvar, deviating%problem%output%kind%components))
      do v = 1, nvar
         result%tolerance(v) = tolerance_of(set, toler, parameters%variables(v))
      end do
      allocate (work)
      call prepare_sensitivity(deviating%problem, work)
      if (by_name) then
         allocate (result%bands)
         call names_of_numbers(wanted%outputs, result%bands%names, turning, wanted%angle)
         wanted%numbers = size(result%bands%names)
         call find_jacobian(deviating%problem, dimensions, work, result%effect, wanted=wanted)
         call make_bands(set, toler, result%tolerance, dimensions, wanted, result%bands)
         call prepare_sampled(set, dimensions, wanted, result%bands, deviating)
      else
         call find_jacobian(deviating%problem, dimensions, work, result%effect)
      end if
      call find_dead(deviating%problem, dimensions, work, result%dead)
      do v = 1, nvar
         result%effect(:, v, :) = result%effect(:, v, :)*result%tolerance(v)
      end do
      result%worst = sum(abs(result%effect), dim=2)
      result%square = sqrt(sum(result%effect**2, dim=2))

   contains

      !> True if it has been analysed with these loops at these inputs. Angles with desired values are within half a turn of them.
      logical function is_known()
         is_known = .false.
         if (.not. (present(given) .and. present(analysed))) return
         if (given%desired .or. size(given%delt) /= size(inputs)) return
         is_known = all(abs(given%delt - inputs) <= 0.0_wp) .and. all(given%plan%solved .eqv. deviating%problem%plan%solved)
      end function is_known
   end subroutine find_tolerances

   !> Bands of all outputs from their changes with every dimension.
   subroutine make_bands(set, toler, tolerance, dimensions, wanted, bands)
      type(data_set_t), intent(in) :: set
      type(tolerance_group_t), intent(in) :: toler
      real(wp), intent(in) :: tolerance(:)         !! shape (nvar)
      type(dimensions_t), intent(in) :: dimensions
      type(wanted_outputs_t), intent(in) :: wanted
      type(output_bands_t), intent(inout) :: bands
      real(wp), allocatable :: all_tolerances(:), effect(:, :, :)
      integer :: column, k, n

      bands%apart = wanted%sketch%moving(wanted%apart)%joint
      bands%of_apart = tolerances_apart(set, toler, size(bands%apart), listed_of(set, dimensions, bands%apart))
      all_tolerances = [tolerance, bands%of_apart]
      bands%change = wanted%change
      bands%turns = wanted%angle
      effect = wanted%change
      do column = 1, size(effect, 2)
         effect(:, column, :) = effect(:, column, :)*all_tolerances(column)
      end do
      bands%worst = sum(abs(effect), dim=2)
      bands%square = sqrt(sum(effect**2, dim=2))
      bands%effect = maxval(abs(effect), dim=1)
      allocate (bands%known(size(bands%names)), source=.true.)
      n = 0
      do k = 1, size(wanted%outputs)
         n = n + columns_of(wanted%outputs(k))
         if (wanted%outputs(k)%kind == output_ratio) bands%known(n) = .false.
      end do
   end subroutine make_bands

   !> Make the sample ready for all outputs of a sketch, with their values on the nominal linkage.
   subroutine prepare_sampled(set, dimensions, wanted, bands, deviating)
      type(data_set_t), intent(in) :: set
      type(dimensions_t), intent(in) :: dimensions
      type(wanted_outputs_t), intent(in) :: wanted
      type(output_bands_t), intent(in) :: bands
      type(deviating_t), intent(inout) :: deviating
      complex(wp), allocatable :: joint(:, :)
      real(wp), allocatable :: moved(:, :)
      integer :: k

      allocate (deviating%outputs)
      associate (all => deviating%outputs)
         all%sketch = wanted%sketch
         all%outputs = wanted%outputs
         all%known = bands%known
         all%angle = wanted%angle
         all%along = bands%of_apart(1::2)
         all%turn = bands%of_apart(2::2)
         all%apart = pack([(k, k=1, size(all%sketch%moving))], abs(all%sketch%moving%offset) > 0.0_wp)
         all%listed = listed_of(set, dimensions, all%sketch%moving(all%apart)%joint)
         call deviating%lean%want_derivatives(.true., all%sketch%points)
         call deviating%lean%bind(dimensions)
         allocate (all%nominal(deviating%lean%positions, size(bands%known)))
         allocate (joint(size(all%sketch%drawn), deviating%lean%linkage%capacity))
         allocate (moved(size(all%sketch%arcs), deviating%lean%linkage%capacity))
         call find_numbers(all, all%sketch, joint, moved, deviating%lean, .false., all%nominal)
      end associate
   end subroutine prepare_sampled

   !> Numbers of all outputs at every position of a bound problem; of ratios 0.
   subroutine find_numbers(all, sketch, joint, moved, problem, solved, numbers)
      type(sampled_t), intent(in) :: all
      type(sketch_motion_t), intent(in) :: sketch  !! with the offsets of this linkage
      complex(wp), intent(out) :: joint(:, :)      !! shape (joints, capacity of a block): to work in
      real(wp), intent(out) :: moved(:, :)         !! shape (slides, capacity)
      class(problem_t), intent(inout) :: problem
      logical, intent(in) :: solved                !! the last block is
      real(wp), intent(out) :: numbers(:, :)       !! shape (positions, numbers)
      complex(wp) :: place(size(sketch%drawn), 0:most_orders)
      real(wp) :: travel(size(sketch%arcs), 0:most_orders)
      real(wp) :: values(size(numbers, 2), 0:most_orders)
      real(wp), parameter :: any_rate(2) = 1.0_wp
      integer :: block, offset, n, i

      place = (0.0_wp, 0.0_wp)
      travel = 0.0_wp
      n = problem%positions
      offset = 0
      do block = 1, problem%blocks()
         if (.not. (solved .and. problem%blocks() == 1)) call problem%solve_block(block, offset, n)
         call find_places(sketch, problem, n, joint(:, :n), moved(:, :n))
         do i = 1, n
            place(:, 0) = joint(:, i)
            travel(:, 0) = moved(:, i)
            call values_of_outputs(all%outputs, place, travel, any_rate, values)
            numbers(offset + i, :) = merge(values(:, 0), 0.0_wp, all%known)
         end do
      end do
   end subroutine find_numbers

   !> Joints that stand off the arcs: their distances and angles deviate, too; the output of the loops is where its dimensions are.
   subroutine move_apart(all, dimensions, law, random, sketch)
      type(sampled_t), intent(in) :: all
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: law
      type(xoshiro_t), intent(inout) :: random
      type(sketch_motion_t), intent(inout) :: sketch
      real(wp) :: deviate(2), c, s
      integer :: k

      do k = 1, size(all%apart)
         call next_deviation(random, law, deviate(1))
         call next_deviation(random, law, deviate(2))
         associate (nominal => all%sketch%moving(all%apart(k))%offset, offset => sketch%moving(all%apart(k))%offset)
            if (k == all%listed) then
               call unit_vector(dimensions%outang, c, s)
               offset = dimensions%outlk*cmplx(c, s, wp)
            else
               call unit_vector(deviate(2)*all%turn(k), c, s)
               offset = nominal*(1.0_wp + deviate(1)*all%along(k)/abs(nominal))*cmplx(c, s, wp)
            end if
         end associate
      end do
   end subroutine move_apart

   !> A deviation as part of its tolerance, from -1 to 1; a normal one is beyond it now and then.
   pure subroutine next_deviation(random, law, deviation)
      type(xoshiro_t), intent(inout) :: random
      integer, intent(in) :: law                   !! one of `law_...`
      real(wp), intent(out) :: deviation
      real(wp) :: deviate, second

      call random%next(deviate)
      select case (law)
      case (law_triangle)
         call random%next(second)
         deviation = deviate + second - 1.0_wp
      case (law_normal)
         deviation = standard_normal(deviate)
      case default
         deviation = 2.0_wp*deviate - 1.0_wp
      end select
   end subroutine next_deviation

   !> The next deviations: those that `next_deviation` gives one by one.
   pure subroutine next_deviations(random, law, n, deviations)
      type(xoshiro_t), intent(inout) :: random
      integer, intent(in) :: law                   !! one of `law_...`
      integer, intent(in) :: n
      real(wp), intent(out) :: deviations(n)
      integer :: v

      if (law == law_uniform) then
         call random%next_many(n, deviations)
         deviations = 2.0_wp*deviations - 1.0_wp
         return
      end if
      do v = 1, n
         call next_deviation(random, law, deviations(v))
      end do
   end subroutine next_deviations

   !> A place in a disc of the radius 1, uniformly; with normal deviations both coordinates have the variance of that.
   pure subroutine next_gap(random, law, gap)
      type(xoshiro_t), intent(inout) :: random
      integer, intent(in) :: law                   !! one of `law_...`
      real(wp), intent(out) :: gap(2)
      real(wp) :: deviate(2)

      call random%next(deviate(1))
      call random%next(deviate(2))
      if (law == law_normal) then
         gap = normal_of_disc*standard_normal(deviate)
      else
         call unit_vector(full_turn*deviate(1), gap(1), gap(2))
         gap = sqrt(deviate(2))*gap
      end if
   end subroutine next_gap

   ! ---- dimensions with tolerances ------------------------------------------------------------------------------------

   !> The tolerances of a case; where it has none, one for all lengths.
   pure function tolerances_of(set, of_lengths) result(toler)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in), optional :: of_lengths
      type(tolerance_group_t) :: toler

      toler = set%toler
      if (.not. present(of_lengths) .or. toler%given) return
      toler%tollen = of_lengths
      toler%tolarc = of_lengths
      if (set%links%outlk > 0.0_wp) toler%tolout = of_lengths
      if (set%method%origlk > 0.0_wp) toler%tolorl = of_lengths
      toler%of_pivot(1) = of_lengths
   end function tolerances_of

   !> Names of the columns of changes: of the variables, then of distance and angle of each joint that stands off the arcs.
   pure function names_of_tolerances(sketch, variables, apart) result(names)
      type(sketch_t), intent(in) :: sketch
      type(variable_t), intent(in) :: variables(:)
      integer, intent(in) :: apart(:)              !! joints of the sketch
      character(column_length), allocatable :: names(:) !! shape (columns)
      integer :: v, k

      allocate (names(size(variables) + 2*size(apart)))
      do v = 1, size(variables)
         names(v) = name_of(variables(v))
      end do
      do k = 1, size(apart)
         v = size(variables) + 2*k - 1
         names(v) = 'DISTANCE OF JOINT '//trim(sketch%joint_name(apart(k)))//' ON ITS LINK'
         names(v + 1) = 'ANGLE OF JOINT '//trim(sketch%joint_name(apart(k)))//' ON ITS LINK'
      end do
   end function names_of_tolerances

   !> What tolerances can be allotted to in a case: names and kinds, before anything is analysed.
   subroutine dimensions_to_allot(set, mechanism, dimensions, names, is_angle)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      character(column_length), allocatable, intent(out) :: names(:)
      logical, allocatable, intent(out) :: is_angle(:)
      type(tolerance_group_t) :: toler
      type(parameters_t) :: parameters
      type(sketch_motion_t) :: sketch
      integer, allocatable :: apart(:), list(:)
      integer :: listed, v

      toler = tolerances_of(set, 1.0_wp)
      parameters = deviating_dimensions(set, toler, mechanism)
      allocate (apart(0))
      if (size(set%sketch%outputs) > 0) then
         call locate_sketch(set, sketch, dimensions)
         apart = pack(sketch%moving%joint, abs(sketch%moving%offset) > 0.0_wp)
      end if
      listed = listed_of(set, dimensions, apart)
      list = allotted_columns([(tolerance_of(set, toler, parameters%variables(v)), v=1, size(parameters%variables))], &
                              listed, tolerances_apart(set, toler, size(apart), listed))
      names = names_of_tolerances(set%sketch, parameters%variables, apart)
      names = names(list)
      is_angle = angles_of(parameters%variables, size(apart), mechanism%sliding_input)
      is_angle = is_angle(list)
   end subroutine dimensions_to_allot

   !> Columns to which tolerances can be allotted: those that have one. The pivot of the input deviates by both its numbers if
   !> either has a tolerance; the other is left out here. The joint that the output arc ends at has the tolerances of that arc.
   pure function allotted_columns(tolerance, listed, of_apart) result(list)
      real(wp), intent(in) :: tolerance(:)         !! of the variables
      integer, intent(in) :: listed                !! joint off the arcs that the output arc ends at; 0: none
      real(wp), intent(in) :: of_apart(:)          !! tolerances of their distances and angles, in turn
      integer, allocatable :: list(:)
      integer :: v, k

      list = pack([(v, v=1, size(tolerance))], tolerance > 0.0_wp)
      do k = 1, size(of_apart)
         if ((k + 1)/2 /= listed .and. of_apart(k) > 0.0_wp) list = [list, size(tolerance) + k]
      end do
   end function allotted_columns

   !> Which of the joints off the arcs the output arc ends at; 0: none.
   pure integer function listed_of(set, dimensions, apart) result(listed)
      type(data_set_t), intent(in) :: set
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: apart(:)

      listed = 0
      if (dimensions%outlk > 0.0_wp .and. size(apart) > 0) listed = findloc(apart, set%traced%output_joint, dim=1)
   end function listed_of

   !> Which columns are angles.
   pure function angles_of(variables, apart, sliding_input) result(is_angle)
      type(variable_t), intent(in) :: variables(:)
      integer, intent(in) :: apart                 !! number of joints off the arcs
      logical, intent(in) :: sliding_input
      logical, allocatable :: is_angle(:)
      integer :: v, k

      is_angle = [(any(variables(v)%kind == [variable_gama, variable_outang, variable_origng]) .or. &
                   (variables(v)%kind == variable_crnki .and. .not. sliding_input), v=1, size(variables)), &
                  ([.false., .true.], k=1, apart)]
   end function angles_of

   !> Dimensions to which tolerances can be allotted, and how the outputs change with each.
   subroutine allowances_of(set, sliding_input, deviating, linear, allowance)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: sliding_input
      type(deviating_t), intent(in) :: deviating
      type(tolerance_t), intent(in) :: linear
      type(allowance_t), intent(out) :: allowance
      real(wp), allocatable :: sizes(:), given(:)
      integer, allocatable :: apart(:)
      integer :: v, k, nvar, listed

      nvar = size(linear%variables)
      allocate (apart(0), sizes(nvar))
      do v = 1, nvar
         associate (one => linear%variables(v), dimensions => linear%dimensions)
            select case (one%kind)
            case (variable_length)
               sizes(v) = dimensions%arcl(one%n)
            case (variable_outlk)
               sizes(v) = dimensions%outlk
            case (variable_origlk)
               sizes(v) = dimensions%origlk
            case default
               sizes(v) = 0.0_wp
            end select
         end associate
      end do
      given = linear%tolerance
      listed = 0
      if (allocated(linear%bands)) then
         apart = linear%bands%apart
         given = [given, linear%bands%of_apart]
         listed = deviating%outputs%listed
         associate (all => deviating%outputs)
            do k = 1, size(apart)
               sizes = [sizes, abs(all%sketch%moving(all%apart(k))%offset), 0.0_wp]
            end do
         end associate
         allowance%column = allotted_columns(linear%tolerance, listed, linear%bands%of_apart)
      else
         allowance%column = allotted_columns(linear%tolerance, listed, [real(wp) ::])
      end if
      associate (list => allowance%column)
         allowance%names = names_of_tolerances(set%sketch, linear%variables, apart)
         allowance%names = allowance%names(list)
         allowance%is_angle = angles_of(linear%variables, size(apart), sliding_input)
         allowance%is_angle = allowance%is_angle(list)
         allowance%size = sizes(list)
         allowance%given = given(list)
         if (allocated(linear%bands)) then
            allowance%numbers = linear%bands%names
            allowance%known = linear%bands%known
            allowance%turns = linear%bands%turns
            allowance%change = linear%bands%change(:, list, :)
            do v = 1, size(list)
               if (listed == 0 .or. list(v) > nvar) exit
               k = nvar + 2*listed
               select case (linear%variables(list(v))%kind)
               case (variable_outlk)
                  allowance%change(:, v, :) = linear%bands%change(:, k - 1, :)
               case (variable_outang)
                  allowance%change(:, v, :) = linear%bands%change(:, k, :)
               end select
            end do
         else
            allocate (allowance%numbers(linear%kind%components))
            do k = 1, linear%kind%components
               allowance%numbers(k) = output_name(linear%kind, k)
            end do
            allowance%known = [(.true., k=1, linear%kind%components)]
            allowance%turns = [(k == linear%kind%angle, k=1, linear%kind%components)]
            allowance%change = linear%effect(:, list, :)
            do v = 1, size(list)
               allowance%change(:, v, :) = allowance%change(:, v, :)/linear%tolerance(list(v))
            end do
         end if
      end associate
   end subroutine allowances_of

   !> Clearances of joints as further dimensions, which come last.
   subroutine add_plays(plays, allowance)
      type(play_t), intent(in) :: plays(:)
      type(allowance_t), intent(inout) :: allowance
      character(column_length), allocatable :: names(:)
      real(wp), allocatable :: change(:, :, :)
      logical, allocatable :: is_angle(:)
      integer :: k, n

      if (size(plays) == 0) return
      n = size(allowance%names)
      allocate (names(n + size(plays)), is_angle(n + size(plays)))
      allocate (change(size(allowance%change, 1), n + size(plays), size(allowance%change, 3)))
      names(:n) = allowance%names
      names(n + 1:) = plays%name
      is_angle(:n) = allowance%is_angle
      is_angle(n + 1:) = .false.
      change(:, :n, :) = allowance%change
      do k = 1, size(plays)
         change(:, n + k, :) = plays(k)%change
      end do
      call move_alloc(names, allowance%names)
      call move_alloc(is_angle, allowance%is_angle)
      call move_alloc(change, allowance%change)
      allowance%size = [allowance%size, [(0.0_wp, k=1, size(plays))]]
      allowance%given = [allowance%given, plays%given]
      allowance%plays = plays
   end subroutine add_plays

   !> Give dimensions other tolerances, and the deviations of a sample a law.
   subroutine allot(allowance, allotted, law, deviating, linear)
      type(allowance_t), intent(in) :: allowance
      real(wp), intent(in) :: allotted(:)          !! shape (dimensions)
      integer, intent(in) :: law                   !! one of `law_...`
      type(deviating_t), intent(inout) :: deviating
      type(tolerance_t), intent(inout) :: linear
      real(wp), allocatable :: tolerance(:)
      integer :: nvar, v

      nvar = size(linear%variables)
      tolerance = linear%tolerance
      if (allocated(linear%bands)) tolerance = [tolerance, linear%bands%of_apart]
      tolerance(allowance%column) = allotted(:size(allowance%column))
      if (allocated(allowance%plays)) then
         linear%plays = allowance%plays
         linear%clearance = allotted(size(allowance%column) + 1:)
      end if
      do v = 1, nvar
         if (linear%tolerance(v) > 0.0_wp) &
            linear%effect(:, v, :) = linear%effect(:, v, :)*(tolerance(v)/linear%tolerance(v))
      end do
      linear%tolerance = tolerance(:nvar)
      linear%worst = sum(abs(linear%effect), dim=2)
      linear%square = sqrt(sum(linear%effect**2, dim=2))
      linear%law = law
      if (.not. allocated(linear%bands)) return
      linear%bands%of_apart = tolerance(nvar + 1:)
      deviating%outputs%along = tolerance(nvar + 1::2)
      deviating%outputs%turn = tolerance(nvar + 2::2)
   end subroutine allot

   !> Correlate the deviations of a sample: parts of the tolerances that dimensions have for themselves and with their group.
   pure subroutine correlate(allowance, group, own, common, linear)
      type(allowance_t), intent(in) :: allowance
      integer, intent(in) :: group(:)              !! shape (dimensions); 0: none
      real(wp), intent(in) :: own(:), common(:)    !! shape (dimensions)
      type(tolerance_t), intent(inout) :: linear
      integer :: nvar, k

      nvar = size(linear%variables)
      linear%group = [(0, k=1, nvar)]
      linear%own = [(1.0_wp, k=1, nvar)]
      linear%common = [(0.0_wp, k=1, nvar)]
      do k = 1, size(allowance%column)
         if (allowance%column(k) > nvar) cycle
         linear%group(allowance%column(k)) = abs(group(k))
         linear%own(allowance%column(k)) = own(k)
         linear%common(allowance%column(k)) = common(k)
      end do
   end subroutine correlate

   ! ---- proven --------------------------------------------------------------------------------------------------------

   !> How far numbers of outputs go at positions for every linkage within tolerances, proven to second order; and by which factor
   !> all tolerances would have to be multiplied for the bands to be kept, 0: none was found.
   subroutine enclose_bands(deviating, linear, allowance, tolerance, position, number, width, low, high, known, factor)
      type(deviating_t), intent(in) :: deviating
      type(tolerance_t), intent(in) :: linear
      type(allowance_t), intent(in) :: allowance
      real(wp), intent(in) :: tolerance(:)         !! shape (dimensions)
      integer, intent(in) :: position(:), number(:) !! shape (bands)
      real(wp), intent(in) :: width(:)             !! shape (bands): to either side
      real(wp), intent(out) :: low(:), high(:)     !! shape (bands)
      logical, intent(out) :: known(:)             !! shape (bands): something can be said
      real(wp), intent(out) :: factor              !! 1 at most
      class(problem_t), allocatable :: problem     ! large, as the work room: they would fill a small stack
      type(sensitivity_t), allocatable :: work
      type(deviation_model_t), allocatable :: model
      real(wp), allocatable :: all_tolerances(:)
      integer, allocatable :: own_column(:, :), list(:)
      integer :: block, offset, n, i, k

      low = -huge(1.0_wp)
      high = huge(1.0_wp)
      known = .false.
      factor = 1.0_wp
      allocate (problem, source=deviating%problem)
      allocate (work, model)
      call prepare_sensitivity(problem, work)
      n = size(linear%variables)
      if (allocated(linear%bands)) n = n + size(linear%bands%of_apart)
      allocate (all_tolerances(n), source=0.0_wp)
      all_tolerances(allowance%column) = tolerance
      if (allocated(deviating%outputs)) call find_columns()
      call problem%bind(linear%dimensions)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call problem%output_of(n)
         do i = 1, n
            list = pack([(k, k=1, size(position))], position == offset + i)
            if (size(list) == 0) cycle
            if (allocated(deviating%outputs)) then
               call make_deviation_model(problem, work, i, size(all_tolerances), model, deviating%outputs%sketch, &
                                         deviating%outputs%outputs, own_column)
            else
               call make_deviation_model(problem, work, i, size(all_tolerances), model)
            end if
            call bound(1.0_wp)
            if (.not. is_kept()) call look_for_factor()
         end do
      end do

   contains

      !> Columns of the dimensions of joints that stand off the arcs; of that which the output arc ends at those of this arc.
      subroutine find_columns()
         integer :: m

         associate (all => deviating%outputs)
            allocate (own_column(2, size(all%sketch%moving)), source=0)
            do m = 1, size(all%apart)
               own_column(:, all%apart(m)) = size(linear%variables) + [2*m - 1, 2*m]
               if (m /= all%listed) cycle
               own_column(:, all%apart(m)) = [findloc(linear%variables%kind, variable_outlk, dim=1), &
                                              findloc(linear%variables%kind, variable_outang, dim=1)]
            end do
         end associate
      end subroutine find_columns

      !> Bounds at this position for a part of all tolerances.
      subroutine bound(part)
         real(wp), intent(in) :: part
         type(enclosure_t) :: enclosure
         integer :: b

         call enclose_unknowns(model, part*all_tolerances, enclosure)
         do b = 1, size(list)
            call enclose_number(model, number(list(b)), enclosure, low(list(b)), high(list(b)), known(list(b)))
         end do
      end subroutine bound

      logical function is_kept()
         is_kept = all(known(list) .and. max(-low(list), high(list)) <= width(list))
      end function is_kept

      !> The largest part of all tolerances that keeps the bands here; the bounds stay those of the whole.
      subroutine look_for_factor()
         real(wp) :: of_whole(2, size(list)), least, most
         logical :: was_known(size(list))
         integer :: step

         of_whole(1, :) = low(list)
         of_whole(2, :) = high(list)
         was_known = known(list)
         least = 0.0_wp
         most = factor
         call bound(most)
         if (is_kept()) least = most
         do step = 1, merge(0, halvings, least > 0.0_wp)
            call bound(0.5_wp*(least + most))
            if (is_kept()) then
               least = 0.5_wp*(least + most)
            else
               most = 0.5_wp*(least + most)
            end if
         end do
         factor = min(factor, least)
         low(list) = of_whole(1, :)
         high(list) = of_whole(2, :)
         known(list) = was_known
      end subroutine look_for_factor
   end subroutine enclose_bands

   !> How far all numbers go for one linkage, in the order of the columns of a sample; `closes` is false if it does not everywhere.
   subroutine find_deviations(deviating, linear, deviation, miss, closes)
      type(deviating_t), intent(in) :: deviating
      type(tolerance_t), intent(in) :: linear
      real(wp), intent(in) :: deviation(:)         !! of the variables, then of joints that stand off the arcs
      real(wp), allocatable, intent(out) :: miss(:, :) !! shape (positions, columns)
      logical, intent(out) :: closes
      class(problem_t), allocatable :: problem
      type(sketch_motion_t) :: sketch
      type(dimensions_t) :: dimensions
      complex(wp), allocatable :: joint(:, :)
      real(wp), allocatable :: moved(:, :)
      real(wp) :: c, s
      integer :: n, components, columns, failed, k, nvar

      allocate (problem, source=deviating%lean)
      n = problem%positions
      components = problem%output%kind%components
      columns = components
      nvar = size(linear%variables)
      if (allocated(deviating%outputs)) columns = columns + size(deviating%outputs%known)
      allocate (miss(n, columns), source=0.0_wp)
      call problem%set_inputs(deviating%problem%delt)
      call problem%set_desired(linear%nominal%actual, spread(spread(1.0_wp, 1, n), 2, components))
      dimensions = linear%dimensions
      call problem%parameters%apply(problem%parameters%first_values(linear%dimensions) + deviation(:nvar), dimensions)
      call problem%deviations(dimensions, miss(:, :components), failed)
      closes = failed == 0
      if (.not. closes .or. .not. allocated(deviating%outputs)) return
      associate (all => deviating%outputs)
         sketch = all%sketch
         do k = 1, size(all%apart)
            associate (nominal => all%sketch%moving(all%apart(k))%offset, offset => sketch%moving(all%apart(k))%offset)
               if (k == all%listed) then
                  call unit_vector(dimensions%outang, c, s)
                  offset = dimensions%outlk*cmplx(c, s, wp)
               else
                  call unit_vector(deviation(nvar + 2*k), c, s)
                  offset = nominal*(1.0_wp + deviation(nvar + 2*k - 1)/abs(nominal))*cmplx(c, s, wp)
               end if
            end associate
         end do
         allocate (joint(size(sketch%drawn), problem%linkage%capacity), moved(size(sketch%arcs), problem%linkage%capacity))
         call find_numbers(all, sketch, joint, moved, problem, .true., miss(:, components + 1:))
         do k = 1, size(all%known)
            if (all%angle(k)) then
               miss(:, components + k) = nearest_difference(miss(:, components + k), all%nominal(:, k))
            else
               miss(:, components + k) = miss(:, components + k) - all%nominal(:, k)
            end if
         end do
      end associate
   end subroutine find_deviations

   !> Positions at which some dyad is at a dead point.
   subroutine find_dead(problem, dimensions, work, dead)
      type(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(sensitivity_t), intent(inout) :: work
      logical, allocatable, intent(out) :: dead(:)
      integer :: block, offset, n, i, loop

      allocate (dead(problem%positions), source=.false.)
      call problem%bind(dimensions)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call form_frames(problem, work%rates, padded(n), fixed_too=.false.)
         do loop = 1, problem%mechanism%nloop
            if (problem%linkage%step_of_loop(loop) == 0) cycle
            do i = 1, n
               if (is_dead(problem, work%rates, loop, i)) dead(offset + i) = .true.
            end do
         end do
      end do
   end subroutine find_dead

   !> Analyse a sample of linkages.
   !>
   !> Every `linkages_of_stream` linkages take their deviates from a stream of their own, so that a sample is the beginning of each
   !> larger one. A sample that must end early has the linkages analysed so far.
   subroutine draw_sample(deviating, linear, trials, istart, threads, sample, interrupt, within)
      type(deviating_t), intent(in) :: deviating
      type(tolerance_t), intent(in) :: linear
      integer, intent(in) :: trials, istart, threads
      type(sample_t), intent(out) :: sample
      type(stop_t), intent(in), optional :: interrupt !! asked now and then
      real(wp), intent(in), optional :: within(:, :) !! shape (positions, columns): bands, to count linkages that keep them
      type(stop_t) :: ending
      type(problem_t), allocatable :: workers(:)
      type(xoshiro_t), allocatable :: random(:)
      real(wp), allocatable :: low(:, :, :), high(:, :, :), total(:, :, :), squares(:, :, :) !! by chunk of a round
      real(wp), allocatable :: beyond(:, :, :), band(:, :)
      integer, allocatable :: made(:), unclosed(:), kept(:), named(:, :), loop(:, :)
      integer :: chunk, chunks, before, at_once, of_round, k, t, n, i, closed, components, columns

      if (present(interrupt)) ending = interrupt
      n = deviating%problem%positions
      components = deviating%problem%output%kind%components
      columns = components
      if (allocated(deviating%outputs)) columns = components + size(deviating%outputs%known)
      ! whole streams
      chunk = linkages_of_stream*(1 + (max(least_chunk, (trials - 1)/most_chunks + 1) - 1)/linkages_of_stream)
      chunks = (trials - 1)/chunk + 1
      allocate (workers(max(1, threads)), random(max(1, threads)))
      do t = 1, size(workers)
         workers(t) = deviating%lean
         call random(t)%seed(istart, purpose_sample)
         call workers(t)%set_inputs(deviating%problem%delt)
         call workers(t)%set_desired(linear%nominal%actual, spread(spread(1.0_wp, 1, n), 2, components))
      end do
      at_once = min(chunks, chunks_at_once*size(workers))
      ! those who share a sample must have the same rounds, and as few as they can
      if (ending%is_shared()) at_once = min(chunks, max(chunks_at_once, numbers_at_once/(n*columns)))
      allocate (low(n, columns, at_once), high(n, columns, at_once))
      allocate (total(n, columns, at_once), squares(n, columns, at_once), beyond(n, columns, at_once))
      allocate (band(n, columns), source=huge(1.0_wp))
      if (present(within)) band = within
      allocate (made(at_once), unclosed(at_once), kept(at_once), named(most_named, at_once), loop(most_named, at_once), source=0)
      allocate (sample%low(n, columns), source=huge(1.0_wp))
      allocate (sample%high(n, columns), source=-huge(1.0_wp))
      allocate (sample%mean(n, columns), sample%deviation(n, columns), sample%beyond(n, columns), source=0.0_wp)
      do before = 0, chunks - 1, at_once
         of_round = min(at_once, chunks - before)
         made = 0
         call ending%open_batch('samples', of_round)
         !$omp parallel do num_threads(size(workers)) schedule(static) private(k)
         do t = 1, size(workers)
            k = t - size(workers)
            do
               k = ending%next_item(k, size(workers), of_round)
               if (k > of_round) exit
               call run_chunk(deviating, linear, workers(t), random(t), (before + k - 1)*chunk + 1, &
                              min(trials, (before + k)*chunk), ending, band, low(:, :, k), high(:, :, k), total(:, :, k), &
                              squares(:, :, k), beyond(:, :, k), made(k), unclosed(k), kept(k), named(:, k), loop(:, k))
               if (ending%is_shared() .and. made(k) == min(trials, (before + k)*chunk) - (before + k - 1)*chunk) &
                  call ending%keep_item(k, [low(:, :, k), high(:, :, k), total(:, :, k), squares(:, :, k), beyond(:, :, k), &
                                            real([made(k), unclosed(k), kept(k), named(:, k), loop(:, k)], wp)])
            end do
         end do
         !$omp end parallel do
         call take_shared()
         do k = 1, of_round
            if (made(k) == 0) cycle
            sample%low = min(sample%low, low(:, :, k))
            sample%high = max(sample%high, high(:, :, k))
            sample%mean = sample%mean + total(:, :, k)
            sample%deviation = sample%deviation + squares(:, :, k)
            sample%beyond = sample%beyond + beyond(:, :, k)
            sample%kept = sample%kept + kept(k)
            do i = 1, min(unclosed(k), most_named)
               if (sample%open + i > most_named) exit
               sample%named(sample%open + i) = named(i, k)
               sample%loop(sample%open + i) = loop(i, k)
            end do
            sample%trials = sample%trials + made(k)
            sample%open = sample%open + unclosed(k)
         end do
         call ending%tell(sample%trials, trials)
         if (ending%waiting()) exit
      end do
      sample%any_closed = sample%open < sample%trials
      closed = max(1, sample%trials - sample%open)
      sample%mean = sample%mean/real(closed, wp)
      sample%deviation = sqrt(max(sample%deviation/real(closed, wp) - sample%mean**2, 0.0_wp))

   contains

      !> End the batch and take the chunks that others have made.
      subroutine take_shared()
         real(wp), allocatable :: numbers(:)
         integer :: c, first

         call ending%close_batch()
         do c = 1, of_round
            call ending%take_item(c, numbers)
            if (.not. allocated(numbers)) cycle
            low(:, :, c) = reshape(numbers(:n*columns), [n, columns])
            high(:, :, c) = reshape(numbers(n*columns + 1:2*n*columns), [n, columns])
            total(:, :, c) = reshape(numbers(2*n*columns + 1:3*n*columns), [n, columns])
            squares(:, :, c) = reshape(numbers(3*n*columns + 1:4*n*columns), [n, columns])
            beyond(:, :, c) = reshape(numbers(4*n*columns + 1:5*n*columns), [n, columns])
            first = 5*n*columns + 3
            made(c) = nint(numbers(first - 2))
            unclosed(c) = nint(numbers(first - 1))
            kept(c) = nint(numbers(first))
            named(:, c) = nint(numbers(first + 1:first + most_named))
            loop(:, c) = nint(numbers(first + most_named + 1:first + 2*most_named))
         end do
      end subroutine take_shared
   end subroutine draw_sample

   !> The linkages from one number to another.
   subroutine run_chunk(deviating, linear, problem, random, from, to, ending, band, low, high, total, squares, beyond, made, &
                        open, kept, named, loop)
      type(deviating_t), intent(in) :: deviating
      type(tolerance_t), intent(in) :: linear
      type(problem_t), intent(inout) :: problem
      type(xoshiro_t), intent(inout) :: random
      integer, intent(in) :: from, to             !! `from` begins a stream
      type(stop_t), intent(in) :: ending
      real(wp), intent(in), contiguous :: band(:, :) !! shape (positions, columns): largest amounts
      real(wp), intent(out), contiguous :: low(:, :), high(:, :), total(:, :), squares(:, :), beyond(:, :) !! the same shape
      integer, intent(out) :: made, open, kept, named(:), loop(:)
      type(linkage_lanes_t), allocatable :: side_by_side ! large: it would fill a small stack
      type(dimensions_t) :: dimensions
      type(sketch_motion_t), allocatable :: sketch
      complex(wp), allocatable :: joint(:, :)
      real(wp), allocatable :: nominal(:), values(:, :), deviations(:, :), miss(:, :, :), moved(:, :), of_group(:)
      real(wp) :: deviation
      logical :: within
      integer :: t, l, failed(lanes), most, together, unasked, first

      low = huge(low)
      high = -huge(high)
      total = 0.0_wp
      squares = 0.0_wp
      beyond = 0.0_wp
      open = 0
      kept = 0
      named = 0
      loop = 0
      dimensions = linear%dimensions
      nominal = problem%parameters%first_values(linear%dimensions)
      values = spread(nominal, 1, lanes)
      allocate (deviations(size(nominal), lanes))
      allocate (miss(problem%positions, size(low, 2), lanes), source=0.0_wp)
      first = size(linear%effect, 3)
      if (allocated(deviating%outputs)) then
         sketch = deviating%outputs%sketch
         allocate (joint(size(sketch%drawn), problem%linkage%capacity), moved(size(sketch%arcs), problem%linkage%capacity))
      end if
      unasked = max(1, solved_unasked/max(1, problem%positions))
      if (allocated(linear%group)) allocate (of_group(maxval(linear%group)))
      allocate (side_by_side)
      call side_by_side%prepare(problem)
      ! gaps are drawn of linkages that close, outputs found where the linkage has just been solved
      most = 1
      if (side_by_side%fits .and. .not. (allocated(sketch) .or. allocated(linear%plays))) most = lanes
      made = 0
      t = from
      do while (t <= to)
         if (mod(t - from, unasked) == 0) then
            if (ending%waiting()) return
         end if
         together = min(most, to - t + 1, unasked - mod(t - from, unasked), linkages_of_stream - mod(t - 1, linkages_of_stream))
         if (mod(t - 1, linkages_of_stream) == 0) call random%use_stream((t - 1)/linkages_of_stream)
         call draw(together)
         if (most > 1) then
            call side_by_side%put_values(problem%parameters, values)
            call side_by_side%deviations(problem, miss, failed(:together))
         else
            call problem%parameters%apply(values(1, :), dimensions)
            if (allocated(sketch)) call move_apart(deviating%outputs, dimensions, linear%law, random, sketch)
            call problem%deviations(dimensions, miss(:, :first, 1), failed(1))
         end if
         do l = 1, together
            made = made + 1
            if (failed(l) > 0) then
               open = open + 1
               beyond = beyond + 1.0_wp
               if (open <= most_named) then
                  named(open) = t + l - 1
                  loop(open) = failed(l)
               end if
               cycle
            end if
            if (allocated(sketch)) call miss_of_outputs()
            if (allocated(linear%plays)) call add_gaps()
            call enter_sample(size(low), miss(1, 1, l), band, low, high, total, squares, beyond, within)
            if (within) kept = kept + 1
         end do
         t = t + together
      end do

   contains

      !> Dimensions of the next linkages, into the first lanes.
      subroutine draw(count)
         integer, intent(in) :: count
         integer :: lane, v

         if (allocated(linear%group)) then
            do lane = 1, count
               call next_of_groups()
               call next_deviations(random, linear%law, size(nominal), deviations(:, lane))
               deviations(:, lane) = linear%own*deviations(:, lane)
               do v = 1, size(nominal)
                  if (linear%group(v) > 0) &
                     deviations(v, lane) = deviations(v, lane) + linear%common(v)*of_group(linear%group(v))
               end do
            end do
         else
            call next_deviations(random, linear%law, size(nominal)*count, deviations)
         end if
         do v = 1, size(nominal)
            values(:count, v) = nominal(v) + linear%tolerance(v)*deviations(v, :count)
         end do
      end subroutine draw

      !> What the groups have in common.
      subroutine next_of_groups()
         integer :: g

         do g = 1, size(of_group)
            call next_deviation(random, linear%law, of_group(g))
         end do
      end subroutine next_of_groups

      !> What gaps in joints do to the outputs, to first order.
      subroutine add_gaps()
         real(wp) :: gap(2)
         integer :: p

         do p = 1, size(linear%plays)
            associate (play => linear%plays(p), columns => miss(:, size(miss, 2) - size(linear%plays(p)%change, 2) + 1:, 1))
               if (play%kind == play_loaded) then
                  call next_deviation(random, linear%law, deviation)
                  columns = columns + 0.5_wp*(1.0_wp + deviation)*linear%clearance(p)*play%change
               else
                  if (play%kind == play_anywhere) then
                     call next_gap(random, linear%law, gap)
                  else
                     gap = 0.0_wp
                     call next_deviation(random, linear%law, gap(1))
                  end if
                  gap = linear%clearance(p)*gap
                  columns = columns + (gap(1)*play%by_gap(1, :, :) + gap(2)*play%by_gap(2, :, :))
               end if
            end associate
         end do
      end subroutine add_gaps

      !> Deviations of all outputs.
      subroutine miss_of_outputs()
         integer :: number

         associate (all => deviating%outputs)
            call find_numbers(all, sketch, joint, moved, problem, .true., miss(:, first + 1:, 1))
            do number = 1, size(all%known)
               if (all%angle(number)) then
                  miss(:, first + number, 1) = nearest_difference(miss(:, first + number, 1), all%nominal(:, number))
               else
                  miss(:, first + number, 1) = miss(:, first + number, 1) - all%nominal(:, number)
               end if
            end do
         end associate
      end subroutine miss_of_outputs
   end subroutine run_chunk
end module psalm_tolerance
