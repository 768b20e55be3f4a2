!> Constraints of a synthesis: past closing, over the range of the input, forbidden regions; timing; NLopt; the end of a study.
program test_constraints
   use, intrinsic :: iso_fortran_env, only: int64
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_constraint_group, only: region_t, region_box, region_half_plane, region_circle, range_turn, range_inputs, &
                                     range_positions, segment_t, every_segment
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_margins, only: inspector_t, margin_t, prepare_inspector, inspect, is_violated, margin_angle, margin_slides, &
                            margin_clearance
   use psalm_merit, only: merit_t, prepare_merit, put_in_order
   use psalm_nlp, only: normal_equations_t
   use psalm_place, only: beside_t
   use psalm_solver_kind, only: find_solver
   use psalm_regions, only: find_region_depth, check_regions
   use psalm_search, only: result_t, search_many
   use psalm_status, only: diagnostics_t
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples, linearise_samples
   use psalm_stop, only: stop_t
   use psalm_text, only: to_text
   use psalm_timing, only: timing_t, prepare_timing, find_timing
   use psalm_dimensions, only: dimensions_t
   use stopping_host, only: host_t
   implicit none (type, external)

   type(checks_t) :: t
   integer :: k

   do k = 1, size(names)
      call derivatives_past_closing(names(k))
   end do
   call across_closing()
   call regions()
   call gradients()
   call whole_turn()
   call box_of_slider()
   call parallel_slides()
   call angle_between_positions()
   call touched_region()
   call impossible_regions()
   do k = 1, size(names)
      call finite_store(names(k))
   end do
   call order()
   call timing()
   call timing_of_angles()
   call solvers()
   call interruption()
   call t%report()

contains

   !> Derivatives of output, constraints and joints against central differences, at positions that close and that do not.
   subroutine derivatives_past_closing(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      class(sample_set_t), allocatable :: samples
      type(dimensions_t) :: dimensions
      real(wp), allocatable :: values(:), changed(:), ahead(:, :, :), near(:, :)
      real(wp), allocatable :: joints(:, :, :, :)
      real(wp) :: step, worst, worst_open, size_of, difference
      type(beside_t) :: beside(2)
      integer :: v, i, joint(2, 2), opened

      allocate (problem, set, samples)
      call load_case(name, problem, set, vary=.true.)
      problem%toggle = 0.5_wp
      joint = reshape([1, 1, 1, problem%mechanism%place(1, 1)], [2, 2])
      ! a point of the frame, and one beside an arc that moves
      beside(1) = beside_t(0, 12.0_wp, 40.0_wp)
      beside(2) = beside_t(problem%mechanism%seq(1, problem%mechanism%place(1, 1)), 7.0_wp, -25.0_wp)
      call prepare_samples(problem, problem%delt, .false., joint, .true., samples, beside)
      values = problem%parameters%first_values(problem%given)
      dimensions = problem%given
      ! the first variable length is made a third longer: some positions of some linkages open
      values(1) = values(1)*4.0_wp/3.0_wp
      call problem%parameters%apply(values, dimensions)
      call linearise_samples(samples, dimensions)
      opened = count(.not. samples%closed)
      near = abs(abs(samples%k) - 1.0_wp)
      worst = 0.0_wp
      worst_open = 0.0_wp
      size_of = max(maxval(abs(samples%dk), mask=spread(near > 0.02_wp, 3, samples%columns)), 1.0e-3_wp)
      associate (dk => samples%dk, closed => samples%closed, n => size(samples%closed))
         allocate (ahead(n, size(samples%k, 2), 2), joints(n, 2, 2, 2))
         do v = 1, samples%columns
            step = 1.0e-5_wp*max(1.0_wp, 0.1_wp*abs(values(v)))
            changed = values
            changed(v) = values(v) + step
            call observe(samples, problem, changed, dimensions, ahead(:, :, 1), joints(:, :, :, 1))
            changed(v) = values(v) - step
            call observe(samples, problem, changed, dimensions, ahead(:, :, 2), joints(:, :, :, 2))
            do i = 1, n
               if (any(near(i, :) <= 0.02_wp)) cycle ! beside the kink
               difference = maxval(abs((ahead(i, :, 1) - ahead(i, :, 2))/(2.0_wp*step) - dk(i, :, v)))/size_of
               difference = max(difference, &
                                maxval(abs((joints(i, :, :, 1) - joints(i, :, :, 2))/(2.0_wp*step) - samples%djoints(i, :, :, v))) &
                                /max(1.0_wp, maxval(abs(samples%djoints(i, :, :, v)))))
               if (closed(i)) then
                  worst = max(worst, difference)
               else
                  worst_open = max(worst_open, difference)
               end if
            end do
         end do
      end associate
      call t%close_to(worst, 0.0_wp, 1.0e-5_wp, trim(name)//': derivatives of constraints and joints')
      if (opened > 0) call t%close_to(worst_open, 0.0_wp, 1.0e-4_wp, trim(name)//': past closing too')

   end subroutine derivatives_past_closing

   !> Constraints and joints of a changed linkage.
   subroutine observe(samples, problem, values, dimensions, k, joints)
      type(sample_set_t), intent(in) :: samples
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: values(:)
      type(dimensions_t), intent(inout) :: dimensions
      real(wp), intent(out) :: k(:, :), joints(:, :, :)
      type(sample_set_t) :: other

      other = samples
      call problem%parameters%apply(values, dimensions)
      call evaluate_samples(other, dimensions)
      k = other%k
      joints = other%joints
   end subroutine observe

   !> Output and constraints are continuous where a dyad opens: the merit has no jump.
   subroutine across_closing()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(merit_t), save :: merit
      real(wp), allocatable :: values(:)
      real(wp) :: total, before, objective, violation, step
      integer :: i
      logical :: opened

      call load_case('needle', problem, set)
      values = problem%parameters%first_values(problem%given)
      call prepare_merit(set, problem, values, merit)
      opened = .false.
      step = 0.0_wp
      before = 0.0_wp
      do i = 0, 2000
         values(1) = 95.0_wp - 0.04_wp*real(i, wp)
         call merit%measure(values, objective, violation)
         total = objective + violation
         if (i > 0) step = max(step, abs(total - before)/max(1.0_wp, total))
         before = total
         opened = opened .or. .not. all(merit%main%closed)
      end do
      call t%is_true(opened, 'the needle linkage opens on the way')
      call t%is_true(step < 0.2_wp, 'the merit makes no jump where it opens')
   end subroutine across_closing

   !> Depths and gradients of the three kinds of region.
   subroutine regions()
      type(region_t) :: region
      real(wp) :: depth, gx, gy, ahead, behind, unused(2), x, y
      integer :: kind, side, i
      real(wp), parameter :: h = 1.0e-6_wp

      region%kind = region_box
      region%at = [1.0_wp, 2.0_wp, 5.0_wp, 4.0_wp]
      call find_region_depth(region, 2.0_wp, 2.5_wp, depth, gx, gy)
      call t%close_to(depth, 0.5_wp, 1.0e-14_wp, 'box: half a unit inside')
      call find_region_depth(region, 7.0_wp, 3.0_wp, depth, gx, gy)
      call t%close_to(depth, -2.0_wp, 1.0e-14_wp, 'box: two units outside')
      region%kind = region_half_plane
      region%at = [0.0_wp, 1.0_wp, 90.0_wp, 0.0_wp]
      call find_region_depth(region, -3.0_wp, 9.0_wp, depth, gx, gy)
      call t%close_to(depth, 3.0_wp, 1.0e-14_wp, 'half-plane: its left is forbidden')
      region%kind = region_circle
      region%at = [1.0_wp, 1.0_wp, 2.0_wp, 0.0_wp]
      call find_region_depth(region, 4.0_wp, 5.0_wp, depth, gx, gy)
      call t%close_to(depth, -3.0_wp, 1.0e-14_wp, 'circle: three units outside')
      region%stay_inside = .true.
      call find_region_depth(region, 4.0_wp, 5.0_wp, depth, gx, gy)
      call t%close_to(depth, 3.0_wp, 1.0e-14_wp, 'circle: outside forbidden')
      region%at = [1.0_wp, 2.0_wp, 3.0_wp, 4.5_wp]
      do kind = region_box, region_circle
         do side = 1, 2
            region%kind = kind
            region%stay_inside = side == 2
            do i = 1, 5
               x = -1.3_wp + 1.1_wp*real(i, wp)
               y = 6.1_wp - 1.7_wp*real(i, wp)
               call find_region_depth(region, x, y, depth, gx, gy)
               call find_region_depth(region, x + h, y, ahead, unused(1), unused(2))
               call find_region_depth(region, x - h, y, behind, unused(1), unused(2))
               call t%close_to(gx, (ahead - behind)/(2.0_wp*h), 1.0e-8_wp, 'region '//to_text(kind)//': gradient, x')
               call find_region_depth(region, x, y + h, ahead, unused(1), unused(2))
               call find_region_depth(region, x, y - h, behind, unused(1), unused(2))
               call t%close_to(gy, (ahead - behind)/(2.0_wp*h), 1.0e-8_wp, 'region '//to_text(kind)//': gradient, y')
            end do
         end do
      end do
   end subroutine regions

   !> Gradient of the merit, and slopes of single constraints, against differences: violated angles, regions, range, free timing.
   subroutine gradients()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(merit_t), save :: merit
      type(normal_equations_t), save :: equations
      real(wp), allocatable :: values(:), x(:), gradient(:), ahead(:), behind(:), slopes(:, :)
      real(wp) :: up, down, worst
      integer :: v, variant, n
      real(wp), parameter :: h = 1.0e-5_wp, weight = 3.0_wp

      do variant = 1, 6
         if (variant <= 2 .or. variant > 4) then
            call load_case('path18', problem, set)
            deallocate (set%constr%regions)
            allocate (set%constr%regions(2))
            set%constr%regions(1) = region_t(region_circle, .true., [0.3_wp, 0.6_wp, 0.2_wp, 0.0_wp], 0, 0)
            set%constr%regions(2) = region_t(region_box, .false., [-2.0_wp, 0.0_wp, 2.0_wp, 2.0_wp], 2, 1)
            set%limits%tangle = 20.0_wp
            if (variant > 4) then
               call make_links_wide(set)
               ! no two links in one line, where the nearer side changes
               call problem%move_inputs(problem%delt + 3.7_wp)
            end if
         else
            ! two slides, out of their limits and past parallel
            call load_case('dyad8_tangent_mechanism', problem, set, vary=.true.)
            problem%slide_angle = 20.0_wp
            call problem%move_inputs(problem%delt + 43.3_wp)
         end if
         set%method%ifree = merge(1, 0, mod(variant, 2) == 1)
         set%constr%irange = merge(range_turn, range_inputs, variant <= 2 .or. variant > 4)
         if (mod(variant, 2) == 1) set%constr%irange = range_positions
         values = problem%parameters%first_values(problem%given)
         call prepare_merit(set, problem, values, merit)
         x = merit%point(values, merit%delt)
         call merit%linearise(x, weight, equations)
         gradient = [equations%gradient, equations%edge_gradient]
         n = merit%count_constraints()
         allocate (ahead(n), behind(n), slopes(size(x), n))
         call merit%constrain(x, ahead, slopes)
         call t%is_true(any(ahead > 0.0_wp), 'constraints are violated here')
         worst = 0.0_wp
         do v = 1, size(slopes, 1)
            call change(merit, x, v, h, weight, up, ahead)
            call change(merit, x, v, -h, weight, down, behind)
            worst = max(worst, abs((up - down)/(2.0_wp*h) - 2.0_wp*gradient(v))/max(1.0_wp, abs(gradient(v))))
            worst = max(worst, maxval(abs((ahead - behind)/(2.0_wp*h) - slopes(v, :))))
         end do
         call t%close_to(worst, 0.0_wp, 1.0e-5_wp, 'gradient of merit and constraints, variant '//to_text(variant))
         deallocate (ahead, behind, slopes)
      end do

   end subroutine gradients

   !> The crank and a wall of the frame, the coupler and a post, and a box for both: all too near each other.
   subroutine make_links_wide(set)
      type(data_set_t), intent(inout) :: set

      set%constr%segments = [segment_t([1, 0], [1, 1], [0, 0], 0.05_wp, 0.0_wp, 0), &
                             segment_t([1, 0], [1, 0], [0, 0], 0.1_wp, 0.2_wp, 0), &
                             segment_t([2, 3], [1, 1], [0, 0], 0.1_wp, 0.0_wp, 0), &
                             segment_t([0, 3], [1, 1], [0, 0], 0.3_wp, 0.1_wp, 0)]
      set%constr%regions(1)%segment = every_segment
      set%constr%regions(2)%clearance = 0.1_wp
      set%constr%regions = [set%constr%regions, &
                            region_t(region_circle, .false., [0.2_wp, 0.3_wp, 0.1_wp, 0.0_wp], segment=2, clearance=0.05_wp), &
                            region_t(region_box, .false., [0.1_wp, 0.1_wp, 0.4_wp, 0.5_wp], segment=every_segment)]
   end subroutine make_links_wide

   !> Merit and constraints with one unknown changed: a dimension or an input.
   subroutine change(merit, x, v, by, weight, total, each)
      type(merit_t), intent(inout) :: merit
      real(wp), intent(in) :: x(:), by, weight
      integer, intent(in) :: v
      real(wp), intent(out) :: total, each(:)
      real(wp) :: changed(size(x)), objective, violation

      changed = x
      changed(v) = x(v) + by
      call merit%measure(changed, objective, violation)
      total = objective + weight*violation
      call merit%constrain(changed, each)
   end subroutine change

   !> The least margin of a crank-rocker is where crank and frame are in line: cos mu = (p^2 + q^2 - (d -+ a)^2)/(2 p q).
   subroutine whole_turn()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(inspector_t), save :: inspector
      type(margin_t), allocatable, save :: margins(:)
      real(wp) :: a, p, q, d, least
      integer :: i

      call load_case('dyad1_crank_rocker', problem, set)
      set%constr%irange = range_turn
      call prepare_inspector(set, problem, .true., inspector)
      call inspect(inspector, problem%given, problem%delt, margins)
      a = problem%given%arcl(1)
      p = problem%given%arcl(2)
      q = problem%given%arcl(3)
      d = problem%given%arcl(4)
      least = set%limits%tangle - max(off_square(p, q, d - a), off_square(p, q, d + a))
      call t%equal_integer(margins(1)%kind, margin_angle, 'a link pair has an angle margin')
      call t%close_to(margins(1)%margin, least, 1.0e-7_wp, 'least margin of a crank-rocker over its turn')
      ! two valleys of almost the same depth, the one nearly on a step, the other between two
      set%constr%irange = range_inputs
      call prepare_inspector(set, problem, .true., inspector)
      do i = -1, 1, 2
         problem%given%arcl(2) = 1.3_wp*problem%given%arcl(1)
         problem%given%arcl(4) = 2.1_wp*problem%given%arcl(1)
         problem%given%arcl(3) = sqrt(a**2 + problem%given%arcl(4)**2 - problem%given%arcl(2)**2 + 1.0e-7_wp*a**2*real(i, wp))
         problem%given%crnki = -10.0_wp
         call inspect(inspector, problem%given, problem%delt, margins)
         associate (h => problem%given%arcl(4), p => problem%given%arcl(2), q => problem%given%arcl(3))
            least = set%limits%tangle - max(off_square(p, q, h - a), off_square(p, q, h + a))
         end associate
         call t%close_to(margins(1)%margin, least, 1.0e-8_wp, 'the deeper of two valleys is found')
      end do
      call load_case('dyad1_crank_rocker', problem, set)
      set%constr%irange = range_positions
      deallocate (set%constr%regions)
      allocate (set%constr%regions(1))
      set%constr%regions(1) = region_t(region_circle, .true., [0.0_wp, 0.0_wp, 0.5_wp*a, 0.0_wp], 1, 1)
      call prepare_inspector(set, problem, .true., inspector)
      call inspect(inspector, problem%given, problem%delt, margins)
      margins = pack(margins, margins%kind == margin_clearance)
      call t%close_to(margins(1)%margin, -0.5_wp*a, 1.0e-12_wp, 'the crank pin is half a crank outside its circle')
      call t%is_true(is_violated(margins(1)), 'and that is a violation')

   end subroutine whole_turn

   !> A slider that runs along the edge of its box and just beyond the next one: at the stretched crank, between two steps.
   subroutine box_of_slider()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(inspector_t), save :: inspector
      type(margin_t), allocatable, save :: margins(:)
      real(wp) :: farthest

      call load_case('dyad4_slider_crank', problem, set)
      set%constr%irange = range_turn
      deallocate (set%constr%regions)
      allocate (set%constr%regions(1))
      associate (arcl => problem%given%arcl)
         farthest = sqrt((arcl(1) + arcl(2))**2 - arcl(4)**2)
         set%constr%regions(1) = region_t(region_box, .true., [-1.0e3_wp, -arcl(4) - 1.0e-5_wp, farthest - 1.0e-4_wp, &
                                                              arcl(4) + 1.0e-5_wp], 2, 1)
      end associate
      call prepare_inspector(set, problem, .true., inspector)
      call inspect(inspector, problem%given, problem%delt, margins)
      margins = pack(margins, margins%kind == margin_clearance)
      call t%equal_integer(size(margins), 1, 'one margin for a box')
      call t%close_to(margins(1)%margin, -1.0e-4_wp, 1.0e-7_wp, 'a short trespass over one edge, running along another')
   end subroutine box_of_slider

   !> A slotted arm on a straight guide: the angle between the slides is 90 degrees less that of the arm.
   subroutine parallel_slides()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(inspector_t), save :: inspector
      type(margin_t), allocatable, save :: margins(:)
      real(wp), allocatable :: values(:), delt(:)
      type(merit_t), save :: merit
      type(timing_t), save :: whole
      real(wp) :: objective
      integer :: loop, far
      logical :: valid

      call load_case('dyad8_tangent_mechanism', problem, set)
      do far = 0, 1
         call problem%set_inputs([-60.0_wp, 0.0_wp, merge(60.0_wp, 89.0_wp, far == 0)])
         call problem%set_desired(reshape([0.0_wp, 0.0_wp, 0.0_wp], [3, 1]))
         set%constr%irange = range_inputs
         call prepare_inspector(set, problem, .true., inspector)
         call inspect(inspector, problem%given, problem%delt, margins)
         call t%equal_integer(margins(1)%kind, margin_slides, 'two slides have a margin')
         call t%close_to(margins(1)%margin, merge(30.0_wp, 1.0_wp, far == 0), 1.0e-9_wp, 'angle left between the slides')
         call t%is_true(.not. any(is_violated(margins)), 'not parallel yet')
         call problem%move_inputs([-60.0_wp, 0.0_wp, 91.0_wp])
         call inspect(inspector, problem%given, problem%delt, margins)
         call t%close_to(margins(1)%margin, -1.0_wp, 1.0e-9_wp, 'past parallel')
         call t%is_true(is_violated(margins(1)), 'is told, whatever the prescribed positions are')
         call problem%evaluate(problem%given, objective, loop)
         call t%equal_integer(loop, 1, 'an evaluation tells positions on both sides of parallel')
      end do
      ! the limit of TANGLE, where it was given
      problem%slide_angle = 50.0_wp
      call problem%set_inputs([-20.0_wp, 0.0_wp, 45.0_wp])
      call problem%set_desired(reshape([0.0_wp, 0.0_wp, 0.0_wp], [3, 1]))
      call prepare_inspector(set, problem, .true., inspector)
      call inspect(inspector, problem%given, problem%delt, margins)
      call t%close_to(margins(1)%margin, 5.0_wp, 1.0e-9_wp, 'an angle of 45 degrees where 40 are asked for')
      call problem%evaluate(problem%given, objective, loop)
      call t%equal_integer(loop, 0, 'an evaluation accepts it')
      call problem%set_inputs([-20.0_wp, 0.0_wp, 51.0_wp])
      call problem%set_desired(reshape([0.0_wp, 0.0_wp, 0.0_wp], [3, 1]))
      call problem%evaluate(problem%given, objective, loop)
      call t%equal_integer(loop, 1, 'and 39 degrees not')
      ! the range passes parallel slides though no position is on the other side
      call load_case('dyad8_tangent_mechanism', problem, set, vary=.true.)
      set%constr%irange = range_turn
      values = problem%parameters%first_values(problem%given)
      call prepare_merit(set, problem, values, merit)
      call merit%accept(values, objective, valid)
      call t%is_true(.not. valid, 'a search sees parallel slides between the prescribed positions')
      set%constr%irange = range_inputs
      call prepare_merit(set, problem, values, merit)
      call merit%accept(values, objective, valid)
      call t%is_true(valid, 'and accepts a range without')
      ! free timing keeps to one side
      set%constr%irange = range_positions
      set%method%ifree = 1
      set%search%order = 0
      problem%wanted(:problem%positions, 1) = 100.0_wp
      problem%wanted(1, 1) = -120.0_wp
      call prepare_merit(set, problem, values, merit)
      call prepare_timing(problem, merit, whole)
      allocate (delt(problem%positions))
      call find_timing(whole, merit, delt)
      call problem%move_inputs(delt)
      call problem%evaluate(problem%given, objective, loop)
      call t%equal_integer(loop, 0, 'a free timing stays on one side of parallel')
   end subroutine parallel_slides

   !> An angle out of its limits between the prescribed positions: a search over the range does not accept it.
   subroutine angle_between_positions()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(merit_t), save :: merit
      real(wp), allocatable :: values(:)
      real(wp) :: objective
      logical :: valid

      ! the transmission angle is 48.6 degrees at 0 degrees of the crank, above 55 from 33 degrees on
      call load_case('dyad1_crank_rocker', problem, set, vary=.true.)
      set%limits%tangle = 35.0_wp
      problem%tangle = 35.0_wp
      call problem%set_inputs([60.0_wp, 120.0_wp, 180.0_wp, 240.0_wp, 300.0_wp])
      call problem%set_desired(reshape(spread(100.0_wp, 1, 5), [5, 1]))
      values = problem%parameters%first_values(problem%given)
      set%constr%irange = range_turn
      call prepare_merit(set, problem, values, merit)
      call merit%accept(values, objective, valid)
      call t%is_true(all(merit%range%closed) .and. .not. valid, 'an angle out of its limits between the positions')
      set%constr%irange = range_positions
      call prepare_merit(set, problem, values, merit)
      call merit%accept(values, objective, valid)
      call t%is_true(valid, 'which nobody asked about')
   end subroutine angle_between_positions

   !> A forbidden region that is touched within rounding of the longest link is none that is entered.
   subroutine touched_region()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(inspector_t), save :: inspector
      type(margin_t), allocatable, save :: margins(:)
      real(wp), parameter :: depth(2) = [5.0e-8_wp, 5.0e-7_wp] !! the rod is 140 long, rounding 1e-9 of it
      integer :: i

      do i = 1, size(depth)
         call load_case('dyad4_slider_crank', problem, set)
         set%constr%irange = range_positions
         deallocate (set%constr%regions)
         allocate (set%constr%regions(1))
         ! all that lies to the right of where the slider is farthest at the prescribed positions, at 0 degrees
         associate (arcl => problem%given%arcl)
            set%constr%regions(1) = region_t(region_half_plane, .false., &
               [arcl(1) + sqrt(arcl(2)**2 - arcl(4)**2) - depth(i), 0.0_wp, -90.0_wp, 0.0_wp], 2, 1)
         end associate
         call prepare_inspector(set, problem, .true., inspector)
         call inspect(inspector, problem%given, problem%delt, margins)
         margins = pack(margins, margins%kind == margin_clearance)
         call t%close_to(margins(1)%margin, -depth(i), 1.0e-12_wp, 'depth of a slider in a region')
         call t%is_true(is_violated(margins(1)) .eqv. i == 2, 'a violation only beyond rounding')
      end do
   end subroutine touched_region

   !> What only the topology shows: a full turn of a sliding input, a joint that is not there.
   subroutine impossible_regions()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(diagnostics_t), save :: findings

      call load_case('actuator_davis_steering', problem, set)
      set%constr%irange = range_turn
      set%constr%regions = [region_t(region_circle, .false., [0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], 9, 1)]
      call check_regions(set%constr, problem%mechanism, findings)
      call t%finds(findings, 'IRANGE=2 needs a turning input', 'a full turn of a sliding input')
      call t%finds(findings, 'region 1: loop 1 has ', 'a region for a joint that is not there')
   end subroutine impossible_regions

   !> Whatever the lengths are, what is found is finite, open dyads included.
   subroutine finite_store(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(dimensions_t) :: dimensions
      real(wp), parameter :: factors(7) = [1.0_wp, 1.0e-2_wp, epsilon(1.0_wp), tiny(1.0_wp)**0.5_wp, tiny(1.0_wp)**0.9_wp, &
                                           3.0_wp, 1.0e3_wp]
      integer :: trial, i, block, offset, n
      logical :: finite

      allocate (problem, set)
      call load_case(name, problem, set, everything=.true.)
      dimensions = problem%given
      finite = .true.
      do trial = 1, 200
         do i = 1, size(dimensions%arcl)
            dimensions%arcl(i) = problem%given%arcl(i)*factors(1 + modulo(trial*(i + 3) + i*i + trial*trial, size(factors)))
         end do
         call problem%bind(dimensions)
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, n)
            finite = finite .and. all(abs(problem%linkage%store%v) <= huge(1.0_wp))
         end do
      end do
      call t%is_true(finite, trim(name)//': finite numbers for any lengths')
   end subroutine finite_store

   !> Degrees the angle between two links is off 90 when the ends are h apart.
   pure real(wp) function off_square(p, q, h)
      real(wp), intent(in) :: p, q, h

      off_square = asin(abs((p*p + q*q - h*h)/(2.0_wp*p*q)))*degrees_per_radian
   end function off_square

   !> Inputs in order: the nearest ones that never go back.
   subroutine order()
      real(wp) :: delt(5)

      delt = [1.0_wp, 3.0_wp, 2.0_wp, 2.5_wp, 7.0_wp]
      call put_in_order(delt, 1.0_wp, 360.0_wp)
      call t%close_to(maxval(abs(delt - [1.0_wp, 2.5_wp, 2.5_wp, 2.5_wp, 7.0_wp])), 0.0_wp, 1.0e-14_wp, &
                       'means of those that go back')
      delt = -[1.0_wp, 3.0_wp, 2.0_wp, 2.5_wp, 700.0_wp]
      call put_in_order(delt, -1.0_wp, 360.0_wp)
      call t%close_to(maxval(abs(delt + [1.0_wp, 2.5_wp, 2.5_wp, 2.5_wp, 361.0_wp])), 0.0_wp, 1.0e-13_wp, &
                       'downwards, within a turn')
   end subroutine order

   !> Timing over the whole path: points of the path itself are found again, in order and not.
   subroutine timing()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      class(merit_t), allocatable :: merit
      type(timing_t) :: whole
      real(wp), allocatable :: delt(:), places(:)
      integer :: ordered, i
      logical :: rises

      allocate (problem, set, merit)
      call load_case('line6', problem, set)
      places = [(12.0_wp + 51.0_wp*real(i, wp), i=0, problem%positions - 1)]
      do ordered = 0, 1
         call load_case('line6', problem, set)
         set%search%order = ordered
         call problem%set_inputs(places)
         call problem%linkage%prepare(problem%mechanism, problem%plan, problem%tangle, problem%slide_angle, problem%spare, &
                                      problem%delt)
         call points_of_itself(problem)
         call problem%move_inputs([(10.0_wp*real(i, wp), i=1, size(places))])
         call prepare_merit(set, problem, problem%parameters%first_values(problem%given), merit)
         call prepare_timing(problem, merit, whole)
         allocate (delt(size(places)))
         call find_timing(whole, merit, delt)
         call t%is_true(all(abs(modulo(delt - places + 180.0_wp, 360.0_wp) - 180.0_wp) <= 3.0_wp), &
                        'each point of the path is found within a step')
         rises = all(delt(2:) >= delt(:size(delt) - 1)) .and. delt(size(delt)) - delt(1) <= 360.0_wp
         if (ordered == 1) call t%is_true(rises, 'and in order')
         deallocate (delt)
      end do
   end subroutine timing

   !> Free timing of angles: whole turns in what is wanted change nothing, and the angle is met within a step.
   subroutine timing_of_angles()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(merit_t), save :: merit
      type(timing_t), save :: whole
      type(sample_set_t), save :: samples
      real(wp), allocatable :: delt(:), found(:, :), wanted(:)
      integer :: turns, i

      call load_case('dyad1_crank_rocker', problem, set, vary=.true.)
      allocate (found(problem%positions, 0:1))
      call prepare_samples(problem, problem%delt, .false., reshape([integer ::], [2, 0]), .false., samples)
      call evaluate_samples(samples, problem%given)
      do turns = 0, 1
         wanted = samples%out(:, 1) + 360.0_wp*[(real(turns*(mod(i, 5) - 2), wp), i=1, problem%positions)]
         call problem%set_desired(reshape(wanted, [size(wanted), 1]))
         call prepare_merit(set, problem, problem%parameters%first_values(problem%given), merit)
         call prepare_timing(problem, merit, whole)
         allocate (delt(problem%positions))
         call find_timing(whole, merit, delt)
         found(:, turns) = delt
         deallocate (delt)
      end do
      call t%is_true(all(abs(found(:, 1) - found(:, 0)) <= 0.0_wp), 'whole turns of a wanted angle do not change the timing')
      wanted = samples%out(:, 1)
      call prepare_samples(problem, found(:, 1), .false., reshape([integer ::], [2, 0]), .false., samples)
      call evaluate_samples(samples, problem%given)
      call t%is_true(all(abs(samples%out(:, 1) - wanted) <= 2.0_wp), 'each angle is met within a step')
      call t%is_true(maxval(wanted) - minval(wanted) > 30.0_wp, 'angles that differ')
   end subroutine timing_of_angles

   !> Make the points a linkage goes through the desired ones.
   subroutine points_of_itself(problem)
      type(problem_t), intent(inout) :: problem
      class(sample_set_t), allocatable :: samples

      allocate (samples)
      call prepare_samples(problem, problem%delt, .false., reshape([integer ::], [2, 0]), .false., samples)
      call evaluate_samples(samples, problem%given)
      call problem%set_desired(samples%out)
   end subroutine points_of_itself

   !> NLopt: the same answer for any number of threads.
   subroutine solvers()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(result_t), save :: one, two
      type(stop_t), save :: never
      real(wp), allocatable :: first(:), none(:, :)

      call load_case('path5', problem, set)
      first = problem%parameters%first_values(problem%given)
      allocate (none(size(first), 0))
      set%search%solver = find_solver('LD_SLSQP')
      set%search%nstart = 9
      set%search%nbest = 3
      call search_many(set, problem, first, none, 1, never, one)
      call search_many(set, problem, first, none, 3, never, two)
      call t%is_true(size(one%best) == size(two%best) .and. size(one%best) > 0, 'SLSQP: as many linkages for any number of threads')
      if (size(one%best) /= size(two%best)) return
      do k = 1, size(one%best)
         call t%is_true(all(abs(one%best(k)%values - two%best(k)%values) <= 0.0_wp), 'SLSQP: the same linkages')
      end do
      call t%is_true(one%best(1)%objective < 1.0e-6_wp, 'SLSQP: five timed points to the best known')
   end subroutine solvers

   !> A study is to end when its host says so, or when its time is up.
   subroutine interruption()
      type(stop_t), save :: stop, copy
      type(host_t), target :: host
      integer(int64) :: now, before

      call t%is_true(.not. stop%waiting(), 'a token of nobody never asks for the end')
      call stop%listen_to(host)
      copy = stop
      call t%is_true(.not. copy%waiting(), 'the host is content')
      host%wants_end = .true.
      call t%is_true(copy%requested() .and. copy%waiting() .and. .not. copy%late(), 'a copy hears the host')
      host%wants_end = .false.
      call copy%limit_time(1.0e-9_wp)
      call system_clock(before)
      do
         call system_clock(now)
         if (now > before + 1) exit
      end do
      call t%is_true(copy%late() .and. copy%waiting() .and. .not. copy%requested(), 'time is up')
      call t%is_true(.not. stop%late(), 'only that of the copy')
      call copy%limit_time(0.0_wp)
      call t%is_true(.not. copy%waiting(), 'no limit any more')
      ! more seconds than the clock can count
      call copy%limit_time(1.0e20_wp)
      call t%is_true(.not. copy%waiting(), 'a limit beyond the end of the clock')
   end subroutine interruption
end program test_constraints
