!> Linkages side by side against one by one, bit for bit: whole data sets, with dimensions that vary a little and very much.
program test_linkage_lanes
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_angles, only: angles_between, angles_between_lanes, exact_unit_vectors, unit_vector
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp
   use psalm_lanes, only: lanes
   use psalm_linkage, only: block_length
   use psalm_linkage_lanes, only: linkage_lanes_t
   use psalm_mechanism, only: mechanism_t
   use psalm_output_kind, only: motion_angle, motion_distance, motion_point, motion_pose
   use psalm_parameters, only: parameters_t
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   use psalm_xoshiro, only: xoshiro_t, purpose_sample
   implicit none (type, external)
   !> Data sets as they are written: loops and sketches, larger groups, gears, several drives.
   character(*), parameter :: others(*) = [character(22) :: 'needle_table85', 'dwell', 'dwell_dyads', 'drive_haines', 'engine', &
      'four_bar_haines', 'hoecken', 'jansen', 'klann', 'line6', 'log10', 'path18', 'path5', 'peaucellier', 'quick_return', &
      'rig_coupler', 'sketch_four_bar', 'sketch_slider_crank', 'sewing_machine', 'wiper', 'watt_six_bar', 'stephenson1_six_bar', &
      'stephenson3_six_bar', 'excavator', 'geared_five_bar', 'toggle_press', 'suspension', 'braced_parallelogram', &
      'hard/carried_slides', 'hard/extreme_lengths', 'hard/kite', 'hard/parallel_slides', 'hard/toggle', 'hard/zero_guide']
   type(checks_t) :: t
   type(problem_t) :: problem
   type(data_set_t) :: set
   integer :: k, fitting, closed, failed, mixed
   integer, parameter :: motions(*) = [motion_point, motion_angle, motion_distance, motion_pose]

   call elementary()
   fitting = 0
   closed = 0
   failed = 0
   mixed = 0
   do k = 1, size(names)
      call load_case(names(k), problem, set, vary=.true.)
      call t%is_true(try(names(k), .true.), trim(names(k))//' goes side by side')
   end do
   do k = 1, size(motions)
      call load_case('needle', problem, set, vary=.true., motion=motions(k))
      call t%is_true(try('needle, MOTION='//to_text(motions(k)), .true.), 'every kind of output goes side by side')
   end do
   do k = 1, size(others)
      call try_others(others(k))
   end do
   call t%is_true(fitting > 30, 'most data sets go side by side', to_text(fitting))
   call t%is_true(closed > 1000 .and. failed > 1000, 'linkages that close and others', to_text(closed)//' '//to_text(failed))
   call t%is_true(mixed > 0, 'slides on both sides of each other')
   call t%report()

contains

   !> Every case of a file, with desired values where it has none.
   subroutine try_others(name)
      character(*), intent(in) :: name
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      type(problem_t) :: one
      logical :: fits
      integer :: n

      call read_cases('data/'//trim(name)//'.nml', sets, findings)
      call t%is_true(.not. findings%failed(), trim(name)//' is read')
      do n = 1, size(sets)
         call set_up(sets(n), mechanism, dimensions, parameters, findings)
         call make_problem(sets(n), mechanism, dimensions, parameters, one)
         if (one%positions > block_length) call one%keep_positions([(k, k=1, one%positions, 1 + one%positions/block_length)])
         problem = one
         fits = try(trim(name)//', case '//to_text(n), .false.)
         call t%is_true(fits .eqv. expected(), trim(name)//' goes side by side, or not')
      end do
   end subroutine try_others

   !> What is done side by side.
   logical function expected()
      integer :: step

      associate (link => problem%linkage)
         expected = problem%blocks() == 1 .and. size(link%seconds) == 0
         do step = 1, size(link%steps)
            expected = expected .and. .not. allocated(link%steps(step)%dyad%higher)
         end do
      end associate
   end function expected

   !> Batches of a problem against the same linkages one by one; true if it goes side by side.
   logical function try(name, by_values)
      character(*), intent(in) :: name
      logical, intent(in) :: by_values           !! dimensions are put in as values of the variables
      type(linkage_lanes_t), allocatable :: together
      type(dimensions_t) :: dimensions(lanes)
      type(xoshiro_t) :: random
      real(wp), allocatable :: values(:, :), miss(:, :, :), alone(:, :)
      real(wp) :: objective(lanes), single
      integer :: loop(lanes), single_loop, round, count, l, components
      logical :: same
      real(wp), parameter :: spread_of(0:4) = [1.0e-6_wp, 1.0e-3_wp, 0.05_wp, 0.3_wp, 1.0_wp]

      components = problem%output%kind%components
      if (.not. allocated(problem%wanted)) &
         call problem%set_desired(reshape([(0.1_wp*real(l, wp), l=1, problem%positions*components)], &
                                          [problem%positions, components]))
      allocate (together)
      call together%prepare(problem)
      try = together%fits
      if (try) fitting = fitting + 1
      allocate (miss(problem%positions, components, lanes), alone(problem%positions, components), source=0.0_wp)
      allocate (values(lanes, size(problem%parameters%variables)))
      call random%seed(7, purpose_sample)
      same = .true.
      do round = 1, 15
         count = merge(lanes, modulo(round, lanes) + 1, modulo(round, 2) == 0)
         do l = 1, count
            dimensions(l) = problem%given
            if (by_values) then
               call vary(random, spread_of(modulo(round, 5)), l, values)
               call problem%parameters%apply(values(l, :), dimensions(l))
            else
               call change(random, spread_of(modulo(round, 5)), dimensions(l))
               call together%put(l, dimensions(l))
            end if
         end do
         if (by_values) then
            do l = count + 1, lanes
               values(l, :) = values(1, :)
            end do
            call together%put_values(problem%parameters, values)
         end if
         call together%evaluate(problem, objective(:count), loop(:count))
         do l = 1, count
            call problem%evaluate(dimensions(l), single, single_loop)
            same = same .and. bits(single) == bits(objective(l)) .and. single_loop == loop(l)
            if (single_loop == 0) closed = closed + 1
            if (single_loop > 0) failed = failed + 1
            if (single_loop > 0 .and. abs(single) > 0.0_wp) mixed = mixed + 1
         end do
         miss = 0.0_wp
         call together%deviations(problem, miss, loop(:count))
         do l = 1, count
            call problem%deviations(dimensions(l), alone, single_loop)
            same = same .and. single_loop == loop(l)
            if (single_loop == 0) same = same .and. all(bits(miss(:, :, l)) == bits(alone))
         end do
      end do
      call t%is_true(same, name//': the bits of one by one')
   end function try

   !> Values of the variables around those given.
   subroutine vary(random, width, lane, values)
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(in) :: width
      integer, intent(in) :: lane
      real(wp), intent(inout) :: values(:, :)
      real(wp) :: deviates(size(values, 2))

      call random%next_many(size(values, 2), deviates)
      values(lane, :) = problem%parameters%first_values(problem%given)
      values(lane, :) = values(lane, :)*(1.0_wp + width*(deviates - 0.5_wp))
   end subroutine vary

   !> All dimensions of a linkage changed.
   subroutine change(random, width, dimensions)
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(in) :: width
      type(dimensions_t), intent(inout) :: dimensions
      real(wp) :: deviates(2*size(dimensions%arcl) + 5)

      call random%next_many(size(deviates), deviates)
      deviates = deviates - 0.5_wp
      associate (n => size(dimensions%arcl))
         dimensions%arcl = dimensions%arcl*(1.0_wp + width*deviates(:n))
         dimensions%gama = dimensions%gama + 10.0_wp*width*deviates(n + 1:2*n)
         dimensions%outlk = dimensions%outlk*(1.0_wp + width*deviates(2*n + 1))
         dimensions%outang = dimensions%outang + 10.0_wp*width*deviates(2*n + 2)
         dimensions%origlk = dimensions%origlk*(1.0_wp + width*deviates(2*n + 3))
         dimensions%origng = dimensions%origng + 10.0_wp*width*deviates(2*n + 4)
         dimensions%crnki = dimensions%crnki*(1.0_wp + width*deviates(2*n + 5))
      end associate
   end subroutine change

   !> Sines, cosines, angles and random numbers of many at once.
   subroutine elementary()
      integer, parameter :: n = 5003, positions = 5
      real(wp) :: degrees(n), x(n), y(n), c, s
      real(wp) :: rx(lanes, positions), ry(lanes, positions), angles(lanes, positions), alone(positions)
      real(wp) :: deviates(100), deviate
      type(xoshiro_t) :: first, second
      logical :: same
      integer :: i

      call first%seed(3, purpose_sample)
      call first%next_many(n, degrees)
      degrees = 2000.0_wp*(degrees - 0.5_wp)
      degrees(:10) = [0.0_wp, -0.0_wp, 30.0_wp, 90.0_wp, -90.0_wp, 359.75_wp, -0.25_wp, 1.0e12_wp, tiny(1.0_wp), 45.0_wp]
      degrees(11) = -1.0e-20_wp
      degrees(200) = 1.0e15_wp
      call exact_unit_vectors(n, degrees, x, y)
      same = .true.
      do i = 1, n
         call unit_vector(degrees(i), c, s)
         same = same .and. bits(c) == bits(x(i)) .and. bits(s) == bits(y(i))
      end do
      call t%is_true(same, 'cosines and sines of many angles')
      call exact_unit_vectors(lanes*positions, degrees, rx, ry)
      call angles_between_lanes(positions, rx, ry, x(50:), y(50:), x(3:), y(3:), angles)
      same = .true.
      do i = 1, lanes
         call angles_between(positions, rx(i, :), ry(i, :), x(49 + i), y(49 + i), x(3:), y(3:), alone)
         same = same .and. all(bits(alone) == bits(angles(i, :)))
      end do
      call t%is_true(same, 'angles between unit vectors')
      second = first
      call first%next_many(size(deviates), deviates)
      same = .true.
      do i = 1, size(deviates)
         call second%next(deviate)
         same = same .and. bits(deviate) == bits(deviates(i))
      end do
      call t%is_true(same .and. all(first%state == second%state), 'random numbers of many at once')
   end subroutine elementary

   elemental integer(int64) function bits(value)
      real(wp), intent(in) :: value

      bits = transfer(real(value, real64), bits)
   end function bits
end program test_linkage_lanes
