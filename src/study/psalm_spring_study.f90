!> Springs of a case (group SPRNGS): by search, or of zero free length through six positions. Data in, results out.
module psalm_spring_study
   use psalm_angles, only: degrees_of, nearest_difference
   use psalm_body_motion, only: body_motion_t, follow_bodies
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, motion_t
   use psalm_force_analysis, only: force_table_t, analyse_forces, loads_of_unit_wrenches, column_of_joint, column_drive
   use psalm_force_model, only: force_model_t, make_force_model, vertices_of, joint_at
   use psalm_kinds, only: wp, pi, full_turn, radians_per_degree, degrees_per_radian
   use psalm_locations, only: location_of_place, location_t, place_nowhere, place_right
   use psalm_mechanism, only: mechanism_t, joint_prismatic
   use psalm_place, only: place_t
   use psalm_spring_design_group, only: spring_design_group_t, spring_design_of, acts_between_points, acts_by_turning, &
                                        acts_along_slide
   use psalm_spring_exact, only: exact_spring_t, exact_task_t, prepare_exact, find_exact, columns_of_torque, exact_possible
   use psalm_spring_load, only: spring_limits_t, found_spring_t, load_with, criterion_of
   use psalm_spring_search, only: spring_search_t, search_springs
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_text, only: to_text
   use psalm_shown_input, only: reference_input
   implicit none (type, external)
   private
   public :: spring_study_t, spring_result_t, assess_springs, find_springs
   public :: unmade_not, unmade_wound, unmade_crooked

   integer, parameter :: steps_of_turn = 1024      !! of the torque, for EXACT

   ! why a spring cannot be made
   integer, parameter :: unmade_not = 0            !! it can
   integer, parameter :: unmade_wound = 1          !! torsional: its links turn round and round against each other
   integer, parameter :: unmade_crooked = 2        !! along a slide: the place does not go along a straight line
   real(wp), parameter :: rounding = 1.0e-6_wp     !! degrees
   real(wp), parameter :: crooked = 1.0e-6_wp      !! of the travel: a line that departs more from a straight one is none

   !> The line on which the second place goes in the first link.
   type :: slide_line_t
      real(wp) :: foot(2) = 0.0_wp                 !! on the line, next to the first place, in the axes of the first link, m
      real(wp) :: along(2) = 0.0_wp                !! unit vector, in these axes
   end type slide_line_t

   !> A spring as it is to be made.
   type :: spring_result_t
      integer :: acts = acts_between_points
      type(place_t) :: ends(2)                     !! as the group SPRING names them
      real(wp) :: at(2, 2) = 0.0_wp                !! the same ends, in the axes of their links, user's length
      real(wp) :: stiffness = 0.0_wp               !! N/m, N m/rad
      real(wp) :: free = 0.0_wp                    !! user's length; torsional: degrees
      real(wp) :: shortest = 0.0_wp, longest = 0.0_wp !! user's length; torsional: least and greatest angle, degrees
      real(wp) :: pull = 0.0_wp                    !! greatest amount, N, N m
      real(wp) :: from = 0.0_wp, preload = 0.0_wp  !! torsional: an angle amid all, degrees; moment there, N m
      real(wp) :: stress = 0.0_wp                  !! of a coil at the longest, Pa
      real(wp) :: coils = 0.0_wp                   !! that side by side have the stiffness
      real(wp) :: helix = 0.0_wp                   !! angle of the coil at the longest, degrees
   end type spring_result_t

   type :: spring_study_t
      integer :: failure = 0                       !! position that is not known; 0: none
      integer :: unmade = 0                        !! spring that cannot be made; 0: none
      integer :: why = unmade_not                  !! of which: unmade_...
      character(:), allocatable :: load            !! name of the load
      real(wp) :: before = 0.0_wp, after = 0.0_wp  !! the criterion, N or N m
      type(spring_result_t), allocatable :: springs(:)
      type(spring_search_t) :: search              !! how it was found; of no meaning for EXACT
      integer :: exact_state = exact_possible      !! why EXACT is of no use here
      type(exact_spring_t), allocatable :: phases(:) !! EXACT: springs at each phase, real or not
      real(wp), allocatable :: input(:)            !! shape (positions)
      real(wp), allocatable :: load_before(:, :), load_after(:, :) !! shape (positions, components)
      real(wp) :: coil_rate = 0.0_wp, wahl = 0.0_wp !! of a coil, N/m; stress factor
      logical :: found = .false.
   end type spring_study_t

contains

   !> Find what is wrong with the group before any work is done. Errors: ends that are no points of their links or are on the same
   !> link, a joint that is not there, a spring that would have neither place nor length to choose.
   subroutine assess_springs(set, mechanism, dimensions, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(diagnostics_t), intent(inout) :: findings
      type(spring_design_group_t) :: group
      type(diagnostics_t) :: unused
      type(force_model_t) :: model
      type(location_t) :: locations(2)
      integer :: k, states(2)

      group = spring_design_of(set)
      call make_force_model(set, mechanism, dimensions, model, unused)
      if (unused%failed()) return                  ! reported elsewhere
      do k = 1, size(group%first)
         call location_of_place(mechanism, dimensions, model%reference, group%first(k), locations(1), states(1))
         call location_of_place(mechanism, dimensions, model%reference, group%second(k), locations(2), states(2))
         if (states(1) /= place_right) call refuse('PLINK', k, 'the end is no point of the link; name another end or arc of it')
         if (states(2) /= place_right) call refuse('QLINK', k, 'the end is no point of the link; name another end or arc of it')
         if (locations(1)%body == locations(2)%body) &
            call refuse('QLINK', k, 'both ends are on the same link: it would have no effect')
      end do
      if (group%of_joint) then
         if (joint_at(mechanism, group%joint) == 0) call refuse('SJLINK', 1, 'there is no joint at this end of the arc')
      end if
      if (group%exact .and. mechanism%sliding_input) then
         call refuse('SMETH', 1, "'EXACT' needs a crank that turns; use 'SEARCH'")
      end if
      if (size(model%friction) > 0) then
         call set%origins%error(findings, 'FRICTN', '', 'loads with friction are not linear in those of springs: leave &FRICTN out')
      end if

   contains

      subroutine refuse(item, entry, text)
         character(*), intent(in) :: item, text
         integer, intent(in) :: entry

         call set%origins%error(findings, 'SPRNGS', item, 'entry '//to_text(entry)//': '//text, entry)
      end subroutine refuse
   end subroutine assess_springs

   !> Springs of a case that `assess_springs` found no fault with; weights that were found before act already.
   subroutine find_springs(set, given, dimensions, weights, study, stop)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: weights(:, :)        !! shape (4, bodies): added to the masses, about the references
      type(spring_study_t), intent(out) :: study
      type(stop_t), intent(in), optional :: stop   !! asked before each start: the best so far is there
      type(spring_design_group_t) :: group
      class(problem_t), allocatable :: problem      ! large: it would fill a small stack
      type(force_model_t) :: model
      type(motion_t) :: motion
      type(force_table_t) :: table
      type(diagnostics_t) :: unused
      type(spring_limits_t), allocatable :: allowed(:)
      type(slide_line_t), allocatable :: lines(:)
      type(found_spring_t), allocatable :: springs(:)
      integer, allocatable :: columns(:)
      integer :: k

      group = spring_design_of(set)
      allocate (problem, source=given)
      call make_force_model(set, problem%mechanism, dimensions, model, unused)
      model%inertia = model%inertia + weights
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(dimensions, motion)
      call analyse_forces(problem, model, set%pace(), set%change_of_pace(), motion%closed, motion%input, table)
      study%failure = findloc([(table%known(k), k=1, size(motion%input))], .false., dim=1)
      study%input = motion%input
      call choose_load(group, problem%mechanism, columns, study)
      if (study%failure > 0) return
      study%load_before = table%value(:, columns)
      call make_allowed(group, problem, dimensions, model, columns, allowed, lines, study)
      study%before = criterion_of(group%criterion, study%load_before)
      if (study%unmade > 0) return
      if (group%exact) then
         call find_exactly(set, group, problem, dimensions, model, springs, study)
      else
         call search_springs(study%load_before, allowed, group%criterion, group%starts, &
                             group%seed, study%search, stop)
         study%found = study%search%found
         springs = study%search%springs
      end if
      if (.not. study%found) return
      study%load_after = load_with(study%load_before, allowed, springs)
      study%after = criterion_of(group%criterion, study%load_after)
      do k = 1, size(springs)
         if (group%acts(k) == acts_along_slide) call hold_on_line(allowed(k), lines(k), springs(k))
      end do
      call describe(set, group, problem%mechanism, dimensions, model, allowed, springs, study)
   end subroutine find_springs

   !> The columns of the load that counts.
   subroutine choose_load(group, mechanism, columns, study)
      type(spring_design_group_t), intent(in) :: group
      type(mechanism_t), intent(in) :: mechanism
      integer, allocatable, intent(out) :: columns(:)
      type(spring_study_t), intent(inout) :: study
      integer :: j

      study%load = trim(merge('DRIVE FORCE ', 'DRIVE TORQUE', mechanism%sliding_input))
      columns = [column_drive]
      if (.not. group%of_joint) return
      j = joint_at(mechanism, group%joint)
      study%load = 'LOAD OF JOINT '//mechanism%joints(j)%name
      columns = [column_of_joint(j), column_of_joint(j) + 1]
      if (mechanism%joints(j)%kind == joint_prismatic) columns = columns(:1)
   end subroutine choose_load

   !> Where the ends may be, and what a wrench there does.
   subroutine make_allowed(group, problem, dimensions, model, columns, allowed, lines, study)
      type(spring_design_group_t), intent(in) :: group
      type(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: columns(:)
      type(spring_limits_t), allocatable, intent(out) :: allowed(:)
      type(slide_line_t), allocatable, intent(out) :: lines(:)
      type(spring_study_t), intent(inout) :: study
      type(body_motion_t) :: bodies
      type(location_t) :: location
      real(wp) :: along(2, 2)
      real(wp), allocatable :: slopes(:, :, :, :)
      integer :: k, e, state

      call follow_bodies(problem, model, bodies)
      allocate (allowed(size(group%first)), lines(size(group%first)))
      do k = 1, size(allowed)
         allowed(k)%reach = [group%first_reach(k), group%second_reach(k)]*model%metre
         allowed(k)%stiffest = group%stiffest(k)
         allowed(k)%free = [group%free_low(k), group%free_high(k)]*model%metre
         do e = 1, 2
            if (e == 1) call location_of_place(problem%mechanism, dimensions, model%reference, group%first(k), location, state)
            if (e == 2) call location_of_place(problem%mechanism, dimensions, model%reference, group%second(k), location, state)
            associate (path => allowed(k)%ends(e), b => location%body, at => location%at*model%metre)
               path%c = bodies%c(:, b)
               path%s = bodies%s(:, b)
               path%x = bodies%x(:, b) + at(1)*path%c - at(2)*path%s
               path%y = bodies%y(:, b) + at(1)*path%s + at(2)*path%c
               call loads_of_unit_wrenches(problem, model, [b], slopes)
               path%slope = slopes(:, columns, :, 1)
               along(:, e) = location%along
            end associate
         end do
         if (study%unmade > 0) return
         select case (group%acts(k))
         case (acts_by_turning)
            if (group%free_limited) allowed(k)%free = radians_per_degree*[group%free_low(k), group%free_high(k)]
            call make_torsional(along, group%free_limited, allowed(k), study%why)
         case (acts_along_slide)
            call make_sliding(group%free_limited, allowed(k), lines(k), study%why)
         end select
         if (study%why /= unmade_not) study%unmade = k
      end do
   end subroutine make_allowed

   !> The angle from the first arc to the second in place of a length. Where the links turn round and round against each other there
   !> is no such spring.
   subroutine make_torsional(along, limited, allowed, why)
      real(wp), intent(in) :: along(2, 2)            !! directions of the arcs, in the axes of their links
      logical, intent(in) :: limited                 !! the free angle has limits; else up to a turn beyond the angles that are met
      type(spring_limits_t), intent(inout) :: allowed
      integer, intent(out) :: why
      real(wp), allocatable :: angle(:)              !! degrees
      real(wp) :: a(2), b(2), step, greatest
      integer :: i

      allocate (angle(size(allowed%ends(1)%x)))
      greatest = 0.0_wp
      do i = 1, size(angle)
         a = direction(1)
         b = direction(2)
         angle(i) = degrees_of(a(1)*b(1) + a(2)*b(2), a(1)*b(2) - a(2)*b(1))
         if (i == 1) cycle
         step = nearest_difference(angle(i), angle(i - 1))
         angle(i) = angle(i - 1) + step
         greatest = max(greatest, abs(step))
      end do
      why = unmade_wound
      if (maxval(angle) - minval(angle) + greatest >= full_turn - rounding) return
      why = unmade_not
      if (.not. limited) allowed%free = radians_per_degree*[minval(angle) - full_turn, maxval(angle) + full_turn]
      allowed%coordinate = radians_per_degree*angle
      allowed%unit = allowed%ends(1)%slope(:, :, 3) - allowed%ends(2)%slope(:, :, 3)

   contains

      pure function direction(e)
         integer, intent(in) :: e
         real(wp) :: direction(2)

         associate (path => allowed%ends(e))
            direction = [path%c(i)*along(1, e) - path%s(i)*along(2, e), path%s(i)*along(1, e) + path%c(i)*along(2, e)]
         end associate
      end function direction
   end subroutine make_torsional

   !> The distance of the places along the slide in place of a length: positive on the side where the second place is on average.
   subroutine make_sliding(limited, allowed, line, why)
      logical, intent(in) :: limited                 !! the free distance has limits; else up to a travel beyond either end
      type(spring_limits_t), intent(inout) :: allowed
      type(slide_line_t), intent(out) :: line
      integer, intent(out) :: why
      real(wp), allocatable :: seen(:, :), ux(:), uy(:) !! the second place from the first, in the axes of the first link
      real(wp) :: travel, across, least, greatest
      integer :: c, far

      why = unmade_crooked
      associate (p => allowed%ends(1), q => allowed%ends(2))
         allocate (seen(size(p%x), 2))
         seen(:, 1) = p%c*(q%x - p%x) + p%s*(q%y - p%y)
         seen(:, 2) = p%c*(q%y - p%y) - p%s*(q%x - p%x)
         far = maxloc(hypotenuse(seen(:, 1) - seen(1, 1), seen(:, 2) - seen(1, 2)), dim=1)
         line%along = seen(far, :) - seen(1, :)
         travel = hypotenuse(line%along(1), line%along(2))
         if (.not. travel > crooked*maxval(abs(seen))) return
         line%along = line%along/travel
         across = maxval(abs((seen(:, 1) - seen(1, 1))*line%along(2) - (seen(:, 2) - seen(1, 2))*line%along(1)))
         if (across > crooked*travel) return
         why = unmade_not
         allowed%coordinate = seen(:, 1)*line%along(1) + seen(:, 2)*line%along(2)
         if (sum(allowed%coordinate) < 0.0_wp) then
            allowed%coordinate = -allowed%coordinate
            line%along = -line%along
         end if
         line%foot = seen(1, :) - allowed%coordinate(1)*line%along
         least = minval(allowed%coordinate)
         greatest = maxval(allowed%coordinate)
         if (.not. limited) allowed%free = [least - (greatest - least), greatest + (greatest - least)]
         ux = p%c*line%along(1) - p%s*line%along(2)
         uy = p%s*line%along(1) + p%c*line%along(2)
         allocate (allowed%unit(size(ux), size(p%slope, 2)))
         do c = 1, size(allowed%unit, 2)
            allowed%unit(:, c) = (p%slope(:, c, 1) - q%slope(:, c, 1))*ux + (p%slope(:, c, 2) - q%slope(:, c, 2))*uy + &
                                 (p%slope(:, c, 3) - q%slope(:, c, 3))*(q%x*uy - q%y*ux)
         end do
      end associate
   end subroutine make_sliding

   !> A spring along a slide as one between two points: its first end on the line, beyond all places of the second.
   pure subroutine hold_on_line(allowed, line, spring)
      type(spring_limits_t), intent(in) :: allowed
      type(slide_line_t), intent(in) :: line
      type(found_spring_t), intent(inout) :: spring
      real(wp) :: least, beyond

      least = minval(allowed%coordinate)
      beyond = min(least, spring%free) - (maxval(allowed%coordinate) - least)
      spring%at(:, 1) = line%foot + beyond*line%along
      spring%at(:, 2) = 0.0_wp
      spring%free = spring%free - beyond
   end subroutine hold_on_line

   !> The spring of zero free length with the least range, over phases of the six positions.
   subroutine find_exactly(set, group, given, dimensions, model, springs, study)
      type(data_set_t), intent(in) :: set
      type(spring_design_group_t), intent(in) :: group
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(found_spring_t), allocatable, intent(out) :: springs(:)
      type(spring_study_t), intent(inout) :: study
      class(problem_t), allocatable :: problem
      type(motion_t) :: motion
      type(force_table_t) :: table
      type(body_motion_t) :: bodies
      type(exact_task_t) :: task
      type(exact_spring_t) :: two(2), before(2)
      type(location_t) :: locations(2)
      ! large: they would fill a small stack
      real(wp), dimension(:), allocatable :: p1, p2, c, s, d1, d2, turn, x, y, vx, vy
      real(wp), allocatable :: ends(:, :, :), inputs(:)
      real(wp) :: phase, best, pull, least
      integer :: k, e, b, state, pick

      allocate (springs(1), study%phases(0))
      allocate (problem, source=given)
      allocate (ends(steps_of_turn, 2, 4), inputs(steps_of_turn))
      do k = 1, steps_of_turn
         inputs(k) = full_turn*real(k - 1, wp)/real(steps_of_turn, wp) - reference_input(problem%mechanism, dimensions)
      end do
      call problem%set_inputs(inputs)
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(dimensions, motion)
      call analyse_forces(problem, model, set%pace(), set%change_of_pace(), motion%closed, motion%input, table)
      study%failure = findloc([(table%known(k), k=1, steps_of_turn)], .false., dim=1)
      if (study%failure > 0) return
      call follow_bodies(problem, model, bodies)
      call location_of_place(problem%mechanism, dimensions, model%reference, group%first(1), locations(1), state)
      call location_of_place(problem%mechanism, dimensions, model%reference, group%second(1), locations(2), state)
      do e = 1, 2
         b = locations(e)%body
         associate (at => locations(e)%at*model%metre)
            x = at(1)*bodies%c(:, b) - at(2)*bodies%s(:, b)
            y = at(1)*bodies%s(:, b) + at(2)*bodies%c(:, b)
            ends(:, e, 1) = bodies%x(:, b) + x
            ends(:, e, 2) = bodies%y(:, b) + y
            ends(:, e, 3) = bodies%vx(:, b) - bodies%w(:, b)*y
            ends(:, e, 4) = bodies%vy(:, b) + bodies%w(:, b)*x
         end associate
      end do
      x = ends(:, 1, 1) - ends(:, 2, 1)
      y = ends(:, 1, 2) - ends(:, 2, 2)
      associate (cq => bodies%c(:, b), sq => bodies%s(:, b), wq => bodies%w(:, b), f => locations(1)%body)
         ! of the first link in the axes of the second
         vx = ends(:, 1, 3) - ends(:, 2, 3) + wq*y
         vy = ends(:, 1, 4) - ends(:, 2, 4) - wq*x
         p1 = cq*x + sq*y
         p2 = cq*y - sq*x
         d1 = cq*vx + sq*vy
         d2 = cq*vy - sq*vx
         c = bodies%c(:, f)*cq + bodies%s(:, f)*sq
         s = bodies%s(:, f)*cq - bodies%c(:, f)*sq
         turn = bodies%w(:, f) - wq
      end associate
      call prepare_exact(columns_of_torque(p1, p2, c, s, d1, d2, -s*turn, c*turn), table%value(:, column_drive), task)
      study%exact_state = task%state
      if (task%state /= exact_possible) return
      best = huge(1.0_wp)
      least = huge(1.0_wp)
      ! once round to let the six angles follow, and once more for the springs themselves
      do k = 1, 2*group%phases
         phase = real(modulo(k - 1, group%phases), wp)/real(group%phases, wp) + 2.5_wp
         if (k == 1) then
            call find_exact(task, phase, .true., two)
         else
            before = two
            call find_exact(task, phase, .true., two, before(1)%angles - &
                            merge(1.0_wp/6.0_wp, 0.0_wp, phase < before(1)%phase))
         end if
         if (k <= group%phases) cycle
         do pick = 1, 2
            study%phases = [study%phases, two(pick)]
            ! both of a phase have the same torque: the one with the smaller pull
            if (.not. allowed(two(pick))) cycle
            pull = two(pick)%stiffness*maxval(hypotenuse( &
                   p1 + c*two(pick)%at(1, 1) - s*two(pick)%at(2, 1) - two(pick)%at(1, 2), &
                   p2 + s*two(pick)%at(1, 1) + c*two(pick)%at(2, 1) - two(pick)%at(2, 2)))
            if (two(pick)%ratio > best .or. (two(pick)%ratio >= best .and. pull >= least)) cycle
            best = two(pick)%ratio
            least = pull
            springs(1)%at = two(pick)%at
            springs(1)%stiffness = two(pick)%stiffness
            study%found = .true.
         end do
      end do

   contains

      !> True for a spring within the limits.
      pure logical function allowed(design)
         type(exact_spring_t), intent(in) :: design
         real(wp) :: reach(2)

         reach = [group%first_reach(1), group%second_reach(1)]*model%metre
         allowed = design%real
         if (.not. allowed) return
         if (any(reach > 0.0_wp .and. sqrt(sum(design%at**2, dim=1)) > reach)) allowed = .false.
         if (group%stiffest(1) > 0.0_wp .and. design%stiffness > group%stiffest(1)) allowed = .false.
      end function allowed
   end subroutine find_exactly

   !> Springs as the group SPRING names them, their lengths, pulls and coils.
   subroutine describe(set, group, mechanism, dimensions, model, allowed, springs, study)
      type(data_set_t), intent(in) :: set
      type(spring_design_group_t), intent(in) :: group
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(spring_limits_t), intent(in) :: allowed(:)
      type(found_spring_t), intent(in) :: springs(:)
      type(spring_study_t), intent(inout) :: study
      type(location_t) :: location, bare
      type(place_t) :: place
      real(wp) :: z(size(study%input), 2, 2), length(size(study%input)), from(2), ratio
      integer :: k, e, state

      allocate (study%springs(size(springs)))
      do k = 1, size(springs)
         associate (result => study%springs(k), spring => springs(k))
            result%acts = group%acts(k)
            result%stiffness = spring%stiffness
            if (result%acts == acts_by_turning) then
               result%ends = [group%first(k), group%second(k)]
               do e = 1, 2
                  result%ends(e)%distance = 0.0_wp
                  result%ends(e)%angle = 0.0_wp
                  result%ends(e)%written = 0.0_wp
               end do
               result%free = degrees_per_radian*spring%free
               result%shortest = degrees_per_radian*minval(allowed(k)%coordinate)
               result%longest = degrees_per_radian*maxval(allowed(k)%coordinate)
               result%pull = maxval(abs(spring%stiffness*(allowed(k)%coordinate - spring%free)))
               result%from = 0.5_wp*(result%shortest + result%longest)
               result%preload = spring%stiffness*(radians_per_degree*result%from - spring%free)
               cycle
            end if
            result%free = spring%free/model%metre
            do e = 1, 2
               associate (path => allowed(k)%ends(e), at => spring%at(:, e))
                  z(:, 1, e) = path%x + at(1)*path%c - at(2)*path%s
                  z(:, 2, e) = path%y + at(1)*path%s + at(2)*path%c
                  if (e == 1) place = group%first(k)
                  if (e == 2) place = group%second(k)
                  call location_of_place(mechanism, dimensions, model%reference, place, location, state)
                  state = place_nowhere
                  if (allocated(set%traced)) &
                     call location_of_place(mechanism, dimensions, model%reference, set%traced%link_places(place%link), &
                                                           bare, state)
                  if (state == place_right) then
                     ! from the first joint of the link: the joint that was named need not be an end of an arc
                     place%joint = set%traced%link_places(place%link)%joint
                     place%line = set%traced%link_places(place%link)%line
                  else
                     place%distance = 0.0_wp
                     call location_of_place(mechanism, dimensions, model%reference, place, bare, state)
                  end if
                  from = location%at + at/model%metre - bare%at
                  result%at(:, e) = from
                  from = [from(1)*bare%along(1) + from(2)*bare%along(2), from(2)*bare%along(1) - from(1)*bare%along(2)]
                  place%distance = hypotenuse(from(1), from(2))
                  place%angle = 0.0_wp
                  if (place%distance > 0.0_wp) place%angle = degrees_of(from(1), from(2))
                  place%written = [place%distance, place%angle]
                  result%ends(e) = place
               end associate
            end do
            length = hypotenuse(z(:, 1, 2) - z(:, 1, 1), z(:, 2, 2) - z(:, 2, 1))
            result%shortest = minval(length)/model%metre
            result%longest = maxval(length)/model%metre
            result%pull = maxval(abs(spring%stiffness*(length - spring%free)))
            if (.not. group%wire > 0.0_wp) cycle
            ratio = group%coil/group%wire
            study%coil_rate = group%shear*group%wire**4/(8.0_wp*group%coil**3*group%turns)
            study%wahl = (4.0_wp*ratio - 1.0_wp)/(4.0_wp*ratio - 4.0_wp) + 0.615_wp/ratio
            result%coils = spring%stiffness/study%coil_rate
            result%stress = study%wahl*8.0_wp*study%coil_rate*(maxval(length) - spring%free)*group%coil/(pi*group%wire**3)
            result%helix = degrees_of(pi*group%coil*group%turns, maxval(length))
         end associate
      end do
   end subroutine describe
end module psalm_spring_study
