!> Positions of whole linkages: laws that hold for every data set, and motions known in closed form.
program test_positions
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp, radians_per_degree, degrees_per_radian
   use psalm_linkage, only: block_length
   use psalm_output_kind, only: motion_point, motion_angle
   use psalm_plan, only: step_point
   use psalm_dimensions, only: dimensions_t
   implicit none (type, external)
   type(checks_t) :: t
   integer :: k

   do k = 1, size(names)
      call loops_close(names(k))
      call scaling(names(k))
      call turning(names(k))
      call blocks(names(k))
      call fixed_points(names(k))
   end do
   do k = 1, 7
      call loops_close('hard/carried_slides', k)
   end do
   call points_of_links('needle')
   call points_of_links('hard/chain64')
   call known_motions()
   call measures()
   call steering()
   call open_loop()
   call many_turns()
   call copied_slide()
   call textile_slides()
   call t%report()

contains

   !> The arcs of every loop add up to zero.
   subroutine loops_close(name, which)
      character(*), intent(in) :: name
      integer, intent(in), optional :: which    !! case of the file
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      integer :: block, offset, n, i, loop, a
      real(wp) :: x, y, worst, size_of, c, s, length

      allocate (problem, set)
      call load_case(name, problem, set, n=which, everything=.true.)
      call problem%bind(problem%given)
      worst = 0.0_wp
      size_of = maxval(problem%given%arcl)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         do i = 1, n
            do loop = 1, problem%mechanism%nloop
               x = 0.0_wp
               y = 0.0_wp
               do a = 1, problem%mechanism%loops(loop)%arcs
                  call problem%linkage%arc_at(problem%plan, problem%mechanism%seq(loop, a), i, c, s, length)
                  x = x + length*c
                  y = y + length*s
               end do
               worst = max(worst, hypot(x, y)/size_of)
            end do
         end do
      end do
      call t%close_to(worst, 0.0_wp, 1.0e-14_wp, trim(name)//': the arcs of every loop add up to zero')
   end subroutine loops_close

   !> Square of the distance of the outer joints of a crank-rocker by the law of cosines, lengths of any size.
   subroutine measures()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(dimensions_t), save :: dimensions
      real(wp), parameter :: factors(3) = [1.0_wp, tiny(1.0_wp)**0.4_wp, huge(1.0_wp)**0.4_wp]
      real(wp), allocatable :: measure(:)
      integer :: i

      call load_case('dyad1_crank_rocker', problem, set)
      dimensions = problem%given
      allocate (measure(problem%positions))
      do i = 1, size(factors)
         dimensions%arcl = problem%given%arcl*factors(i)
         call problem%bind(dimensions)
         call problem%measure_of(1, measure)
         associate (a => problem%given%arcl(1), d => problem%given%arcl(4))
            call t%close_to(maxval(abs(measure/factors(i)/factors(i) &
                                       /(a**2 + d**2 - 2.0_wp*a*d*cos(problem%delt*radians_per_degree)) - 1.0_wp)), &
                            0.0_wp, 1.0e-13_wp, 'closure measure of a crank-rocker by the law of cosines')
         end associate
      end do
   end subroutine measures

   !> Points of the frame are found once for all positions, and no others: what is not fixed moves.
   subroutine fixed_points(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      integer :: k, offset, n, wrong
      real(wp) :: way

      allocate (problem, set)
      call load_case(name, problem, set, everything=.true.)
      call problem%bind(problem%given)
      call problem%solve_block(1, offset, n)
      wrong = 0
      associate (link => problem%linkage)
         do k = 1, size(problem%plan%steps)
            associate (step => problem%plan%steps(k))
               if (step%kind /= step_point) cycle
               if (link%length(step%arc) <= 0.0_wp .and. problem%plan%length_slot(step%arc) == 0) cycle ! a joint on a joint
               associate (x => link%store%v(1:n, link%point_x(step%to)), &
                          y => link%store%v(1:n, link%point_y(step%to)))
                  way = max(maxval(x) - minval(x), maxval(y) - minval(y))
               end associate
               if (step%fixed .eqv. way > 1.0e-9_wp*maxval(problem%given%arcl)) wrong = wrong + 1
            end associate
         end do
      end associate
      call t%is_true(n > 1, trim(name)//': several positions in a block')
      call t%equal_integer(wrong, 0, trim(name)//': a point is fixed or moves')
   end subroutine fixed_points

   !> Points made in the pass that finds their link are those made afterwards, to the last bit, whether the linkage closes or not.
   subroutine points_of_links(name)
      character(*), intent(in) :: name
      real(wp), parameter :: cranks(3) = [1.0_wp, 1.5_wp, 20.0_wp] !! times the crank's length: with the longer ones it opens
      class(problem_t), allocatable :: problem, all_directions
      class(data_set_t), allocatable :: set
      type(motion_t) :: motion, other
      type(dimensions_t) :: dimensions
      integer :: i

      allocate (problem, all_directions, set)
      call load_case(name, problem, set, motion=motion_point)
      call load_case(name, all_directions, set, motion=motion_point)
      call all_directions%want_derivatives(.false.)
      call t%is_true(any(problem%linkage%steps%maker > 0), trim(name)//': points made with a link')
      call t%is_true(all(all_directions%linkage%steps%maker == 0), trim(name)//': none where both directions are found')
      dimensions = problem%given
      do i = 1, size(cranks)
         dimensions%arcl(1) = problem%given%arcl(1)*cranks(i)
         call problem%analyse(dimensions, motion)
         call all_directions%analyse(dimensions, other)
         call t%is_true(all(motion%closed .eqv. other%closed) .and. .not. any(abs(motion%actual - other%actual) > 0.0_wp), &
                        trim(name)//': the same points either way')
      end do
      call t%is_true(.not. all(motion%closed), trim(name)//': with a long crank it opens')
   end subroutine points_of_links

   !> Lengths times a factor: angles stay, lengths follow.
   subroutine scaling(name)
      character(*), intent(in) :: name
      real(wp), parameter :: factors(3) = [8.0_wp, 2.0_wp**(-480), 2.0_wp**480]
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(motion_t) :: before, after
      type(dimensions_t) :: scaled
      real(wp) :: factor
      integer :: i

      allocate (problem, set)
      call load_case(name, problem, set)
      call problem%analyse(problem%given, before)
      do i = 1, size(factors)
         if (problem%mechanism%sliding_input .and. i > 1) cycle
         scaled = problem%given
         scaled%arcl = scaled%arcl*factors(i)
         scaled%outlk = scaled%outlk*factors(i)
         scaled%origlk = scaled%origlk*factors(i)
         if (problem%mechanism%sliding_input) then
            scaled%crnki = scaled%crnki*factors(i)
            call problem%set_inputs(set%method%delt*factors(i))
         else
            problem%desired = .false.
         end if
         call problem%analyse(scaled, after)
         factor = factors(i)
         if (problem%motion == motion_angle) then
            call t%close_to(maxval(abs(sin((after%actual - before%actual)*radians_per_degree))), 0.0_wp, 1.0e-13_wp, &
                            trim(name)//': angles do not depend on the unit of length')
         else
            call t%close_to(maxval(abs(after%actual/factor - before%actual))/maxval(abs(before%actual)), 0.0_wp, &
                            1.0e-13_wp, trim(name)//': lengths scale')
         end if
      end do
   end subroutine scaling

   !> The whole linkage turned: the output turns with it.
   subroutine turning(name)
      character(*), intent(in) :: name
      real(wp), parameter :: turn = 37.0_wp
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(motion_t) :: before, after
      type(dimensions_t) :: turned
      real(wp) :: c, s

      allocate (problem, set)
      call load_case(name, problem, set)
      problem%desired = .false.
      turned = problem%given
      if (.not. problem%mechanism%sliding_input) turned%crnki = turned%crnki + turn
      turned%origng = turned%origng + turn
      associate (frame => problem%mechanism%loops(1)%arcs)
         turned%gama(frame) = turned%gama(frame) + turn
      end associate
      call problem%analyse(problem%given, before)
      call problem%analyse(turned, after)
      select case (problem%motion)
      case (motion_angle)
         call t%close_to(maxval(abs(sin((after%actual - before%actual - turn)*radians_per_degree))), 0.0_wp, 1.0e-13_wp, &
                         trim(name)//': the output angle turns with the machine')
      case (motion_point)
         c = cos(turn*radians_per_degree)
         s = sin(turn*radians_per_degree)
         call t%close_to(maxval(abs(after%actual(:, 1) - (c*before%actual(:, 1) - s*before%actual(:, 2)))) &
                         /maxval(abs(before%actual(:, 1))), 0.0_wp, 1.0e-13_wp, &
                         trim(name)//': the output point turns with the machine')
      case default
         call t%close_to(maxval(abs(after%actual - before%actual))/maxval(abs(before%actual)), 0.0_wp, 1.0e-13_wp, &
                         trim(name)//': a distance does not turn')
      end select
   end subroutine turning

   !> A position has the same bits wherever it stands in the row.
   subroutine blocks(name)
      character(*), intent(in) :: name
      integer, parameter :: lengths(5) = [1, block_length - 1, block_length, block_length + 1, 3*block_length + 5]
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(motion_t) :: single, row
      real(wp) :: at
      integer :: i
      logical :: same

      allocate (problem, set)
      call load_case(name, problem, set)
      at = problem%delt(size(problem%delt)/2 + 1)
      call problem%set_inputs([at])
      call problem%analyse(problem%given, single)
      same = .true.
      do i = 1, size(lengths)
         call problem%set_inputs(spread(at, 1, lengths(i)))
         call problem%analyse(problem%given, row)
         same = same .and. all(abs(row%actual(:, 1) - single%actual(1, 1)) <= 0.0_wp)
      end do
      call t%is_true(same, trim(name)//': the same bits at any place of any number of positions')
   end subroutine blocks

   subroutine known_motions()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(motion_t), save :: motion
      real(wp), allocatable :: a(:)

      call load_case('dyad4_slider_crank', problem, set)
      call problem%analyse(problem%given, motion)
      a = motion%input*radians_per_degree
      call same_as(motion, 40.0_wp*cos(a) + sqrt(140.0_wp**2 - (40.0_wp*sin(a) - 10.0_wp)**2), 'offset slider-crank')
      call load_case('dyad6_scotch_yoke', problem, set)
      call problem%analyse(problem%given, motion)
      call same_as(motion, 40.0_wp*cos(a), 'Scotch yoke: a cosine')
      call load_case('dyad7_oldham_coupling', problem, set)
      call problem%analyse(problem%given, motion)
      call same_as(motion, -8.0_wp*sin(a), 'Oldham coupling: a sine')
      call load_case('dyad2_oscillating_cylinder', problem, set)
      call problem%analyse(problem%given, motion)
      call same_as(motion, sqrt(120.0_wp**2 + 30.0_wp**2 - 2.0_wp*120.0_wp*30.0_wp*cos(a) - 15.0_wp**2), &
                   'oscillating cylinder: cosine rule and Pythagoras')
      call load_case('dyad3_quick_return', problem, set)
      call problem%analyse(problem%given, motion)
      call same_as(motion, modulo(atan2(200.0_wp + 100.0_wp*sin(a), 100.0_wp*cos(a))*degrees_per_radian, 360.0_wp), &
                   'quick-return lever')
      call load_case('dyad8_tangent_mechanism', problem, set)
      call problem%analyse(problem%given, motion)
      call same_as(motion, 100.0_wp*tan(set%method%delt*radians_per_degree), 'tangent mechanism')
      call load_case('actuator_rapson_slide', problem, set)
      call problem%analyse(problem%given, motion)
      call same_as(motion, atan2(500.0_wp, set%method%delt)*degrees_per_radian, 'Rapson slide')
      call load_case('dyad5_turning_block', problem, set)
      call problem%analyse(problem%given, motion)
      ! the crank pin lies on the slot's line, 10 from the driver's shaft
      associate (b => motion%actual(:, 1)*radians_per_degree)
         call t%close_to(maxval(abs((25.0_wp + 60.0_wp*cos(b))*cos(a) + 60.0_wp*sin(b)*sin(a) - 10.0_wp)), 0.0_wp, 1.0e-12_wp, &
                         'turning block: the pin stays in the slot')
      end associate
   end subroutine known_motions

   subroutine same_as(motion, want, name)
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: want(:)
      character(*), intent(in) :: name

      call t%close_to(maxval(abs(motion%actual(:, 1) - want))/maxval(abs(want)), 0.0_wp, 4.0e-15_wp, name)
   end subroutine same_as

   !> Ackermann: the cotangents of the wheel angles differ by track over wheelbase.
   subroutine steering()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(motion_t) :: left, right
      real(wp) :: worst
      integer :: i

      allocate (problem, set)
      call load_case('actuator_davis_steering', problem, set, 1)
      call problem%analyse(problem%given, left)
      call load_case('actuator_davis_steering', problem, set, 2)
      call problem%analyse(problem%given, right)
      worst = 0.0_wp
      do i = 1, size(set%method%delt)
         if (abs(set%method%delt(i)) < 1.0_wp) cycle
         worst = max(worst, abs(1.0_wp/tan(left%actual(i, 1)*radians_per_degree) &
                                - 1.0_wp/tan(right%actual(i, 1)*radians_per_degree) &
                                + 1200.0_wp/2700.0_wp))
      end do
      call t%close_to(worst, 0.0_wp, 1.0e-9_wp, 'Davis steering gear meets the condition of Ackermann')
   end subroutine steering

   !> A loop that does not close is named with positions and amount; other positions are not disturbed.
   subroutine open_loop()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(motion_t), save :: motion
      type(dimensions_t), save :: changed

      call load_case('dyad4_slider_crank', problem, set)
      changed = problem%given
      changed%arcl(2) = 35.0_wp
      call problem%analyse(changed, motion)
      call t%is_true(.not. all(motion%closed) .and. any(motion%closed), 'a connecting rod that is too short opens some positions')
      call t%equal_integer(size(motion%violations), 1, 'consecutive positions make one message')
      call t%equal_integer(count(.not. motion%closed), motion%violations(1)%last - motion%violations(1)%first + 1, 'all of them')
      call t%close_to(motion%violations(1)%amount, 15.0_wp, 1.0e-13_wp, 'by how much: 40 + 10 - 35 at worst')
      call t%is_true(all(abs(motion%actual) < 1.0e6_wp), 'open positions hold finite numbers')
   end subroutine open_loop

   !> No digit is lost to a million turns of the crank.
   subroutine many_turns()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(motion_t), save :: before, after

      call load_case('needle', problem, set)
      problem%desired = .false.
      call problem%analyse(problem%given, before)
      call problem%set_inputs(set%method%delt + 360.0e6_wp)
      call problem%analyse(problem%given, after)
      call t%is_true(all(abs(after%actual - before%actual) <= 0.0_wp), 'a million turns of the crank change no bit')
   end subroutine many_turns

   !> An arc of no length beside the copy of a slide is not that slide.
   subroutine copied_slide()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(motion_t) :: none, little

      allocate (problem, set)
      call load_case('hard/copied_slide', problem, set)
      call problem%analyse(problem%given, none)
      problem%given%arcl(problem%mechanism%seq(2, 2)) = 1.0e-9_wp
      call problem%analyse(problem%given, little)
      call t%close_to(maxval(abs(none%actual - little%actual)), 0.0_wp, 1.0e-8_wp, 'an arc of no length on the copy of a slide')
      call t%close_to(none%actual(1, 1), 250.26778_wp, 1.0e-7_wp, 'its first position')
   end subroutine copied_slide

   !> The sliding lengths of the textile linkage, computed elsewhere with 40 digits.
   subroutine textile_slides()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      real(wp) :: want(7), worst, x, y, length
      integer :: unit, i, k, offset, n, status
      integer, parameter :: loops(4) = [2, 2, 4, 4], arcs(4) = [2, 3, 3, 4]

      call load_case('textile', problem, set)
      call problem%bind(problem%given)
      call problem%solve_block(1, offset, n)
      open (newunit=unit, file='data/reference/textile-output.txt', action='read', status='old')
      read (unit, *)
      worst = 0.0_wp
      do i = 1, n
         read (unit, *, iostat=status) want
         if (status /= 0) worst = 1.0_wp
         do k = 1, 4
            call problem%linkage%arc_at(problem%plan, problem%mechanism%seq(loops(k), arcs(k)), i, x, y, length)
            worst = max(worst, abs(length/want(3 + k) - 1.0_wp))
         end do
      end do
      close (unit)
      call t%close_to(worst, 0.0_wp, 1.0e-12_wp, 'sliding lengths of the textile linkage')
   end subroutine textile_slides
end program test_positions
