!> Motion in time: what the group TIME asks for. Data in, results out.
module psalm_time_study
   use psalm_closure, only: most_orders
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_equilibria, only: equilibria_t, find_equilibria
   use psalm_force_model, only: moving_pair, vertices_of
   use psalm_force_study, only: force_study_t, size_up, take_motors_off
   use psalm_free_motion, only: free_motion_t, free_state_t, make_free_motion
   use psalm_joint_stops, only: joint_stop_t, make_stops, rubbing_joints
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_mechanism, only: mechanism_t
   use psalm_motor_group, only: motor_group_t, motor_of
   use psalm_rates, only: differentiate, prepare_rates, output_rates, highest_order
   use psalm_shown_input, only: reference_input
   use psalm_sketch_motion, only: observe_sketch
   use psalm_sketch_outputs, only: names_of_numbers, values_of_outputs
   use psalm_sketch_study, only: sketch_study_t
   use psalm_status, only: diagnostics_t
   use psalm_time_group, only: time_group_t, time_of
   use psalm_stops_group, only: stops_group_t, stops_of
   use psalm_time_motion, only: time_motion_t, event_t, begin_motion
   use psalm_stiff_steps, only: stiff_steps_there
   use psalm_stop, only: stop_t, tell_host
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: time_study_t, find_time, check_time, increments_of
   public :: time_done, time_open, time_massless, time_collapsed, time_wound, time_crowded, time_on_request, time_jammed, &
             time_folded, time_stiff, time_closed, time_tired

   integer, parameter :: rates_shown = 2          !! orders of rates of drives and outputs

   integer, parameter :: time_done = 0            !! it came to its end
   integer, parameter :: time_open = 1            !! a loop does not close beyond: its drives are at a dead point, or another one is
   integer, parameter :: time_massless = 2        !! the free drives move no mass
   integer, parameter :: time_collapsed = 3       !! no step keeps the tolerance
   integer, parameter :: time_wound = 4           !! a torsional spring is turned past half a turn of SFREE
   integer, parameter :: time_crowded = 5         !! more events than NEVENT
   integer, parameter :: time_on_request = 6      !! the host asked for the end
   integer, parameter :: time_stiff = 7           !! a strong damper keeps steps short, too many would follow
   integer, parameter :: time_closed = 10         !! a gas spring has no room left
   integer, parameter :: time_folded = 9          !! this loop passed a change point and folded
   integer, parameter :: time_tired = 11          !! more steps than NTSTEP
   integer, parameter :: time_jammed = 8          !! friction of a joint has no force that agrees with its load

   !> Free drives, some of which took the place of others.
   type :: drive_exchange_t
      real(wp) :: time = 0.0_wp                   !! s
      character(:), allocatable :: names          !! of all free drives from then on, with commas
   end type drive_exchange_t

   !> The motion at the times that were asked for, up to where it ended.
   type :: time_study_t
      integer :: ended = time_done
      integer :: loop = 0                         !! `time_open`: the loop; `time_wound`, `time_closed`: the spring;
                                                  !! `time_jammed`: its joint
      real(wp) :: stopped = 0.0_wp                !! s: where it ended
      real(wp) :: end = 0.0_wp                    !! s: where it was to end
      integer :: steps = 0
      logical :: stiff = .false.                  !! a strong damper kept steps short
      logical, allocatable :: free(:)             !! by drive: it moves freely
      real(wp), allocatable :: time(:)            !! shape (rows): s
      real(wp), allocatable :: drives(:, :, :)    !! shape (rows, drives, 0:2): as shown, degrees or length; by time, radians
      real(wp), allocatable :: output(:, :, :)    !! shape (rows, components, 0:2), of &LINKS
      type(sketch_study_t) :: sketch              !! of a sketch: its outputs and joints
      type(force_study_t) :: forces               !! as those of positions
      real(wp), allocatable :: potential(:)       !! shape (rows): of weight and springs, J
      real(wp), allocatable :: work(:)            !! put in by loads, motor and drives that are not free, J
      real(wp), allocatable :: lost(:)            !! in dampers and impacts, J
      real(wp), allocatable :: balance(:)         !! kinetic + potential - work + lost, less that at time 0, J
      integer :: smooth = 0                       !! stops; joints with friction follow them
      character(:), allocatable :: stop_names(:)
      logical, allocatable :: stop_slides(:)      !! by stop
      real(wp), allocatable :: stops(:, :)        !! shape (rows, stops): their forces, N m or N, forwards
      type(event_t), allocatable :: events(:)
      logical, allocatable :: turned(:, :)        !! shape (rows, loops): its dyad is not in the assembly of the drawing, as beyond
                                                  !! a change point; not allocated: nowhere, or drives were exchanged before
      real(wp) :: gap = 0.0_wp                    !! part of the lengths by which the linkage misses a change point that it passes
      real(wp), allocatable :: jump_time(:)       !! shape (impacts): s; those at one time are one
      real(wp), allocatable :: jumps(:, :, :)     !! shape (impacts, drives, 3): place as shown, rate before, after
      logical :: moves = .true.                   !! motion was asked for, not equilibria alone
      logical :: rests = .false.                  !! equilibria were asked for
      type(equilibria_t) :: equilibria
      type(drive_exchange_t), allocatable :: exchanges(:) !! of drives
      real(wp) :: zero_input = 0.0_wp             !! input of the first drive as shown where its increment is 0
      integer, allocatable :: free_drives(:)      !! numbers of the free drives
      real(wp) :: turnover = 0.0_wp               !! largest of these energies, J
   end type time_study_t

contains

   !> What a case with TIME cannot have, or needs. Errors only.
   subroutine check_time(set, mechanism, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(diagnostics_t), intent(inout) :: findings
      type(time_group_t) :: time
      type(motor_group_t) :: motor
      type(stops_group_t) :: stops
      integer :: k, joint, bodies(2)

      if (set%gives('STOPS') .and. .not. set%gives('TIME')) call set%origins%error(findings, 'STOPS', '', 'stops are for '// &
         'motion in time; give &TIME too')
      if (.not. set%gives('TIME')) then
         if (set%friction%at_rest_given) call set%origins%error(findings, 'FRICTN', 'FSTAT', 'the coefficient at rest is for '// &
                                                               'motion in time; give &TIME, or leave FSTAT out')
         return
      end if
      time = time_of(set)
      if (.not. set%masses%given) call set%origins%error(findings, 'TIME', '', 'motion in time needs masses: give &MASSES')
      if (time%stiff) then
         if (.not. stiff_steps_there()) call set%origins%error(findings, 'TIME', 'ISTIFF', 'needs the library CVODE of '// &
                                                              'SUNDIALS, version 6 or 7, which is not installed')
      end if
      if (time%equilibria) then
         if (set%friction%given) call set%origins%error(findings, 'TIME', 'IEQUIL', 'with friction a mechanism stays at rest '// &
                                                       'in whole ranges; leave &FRICTN or IEQUIL out')
         if (.not. any(free_drives(set, time))) call set%origins%error(findings, 'TIME', 'IEQUIL', 'equilibria need a free drive')
         if (moves(set, time)) call set%origins%error(findings, 'TIME', 'IEQUIL', 'equilibria need the drives that are '// &
                                                     'not free at rest; their speeds (&RATES, DSPEED, DACCEL) must be 0')
      end if
      stops = stops_of(set)
      do k = 1, size(stops%joints)
         call moving_pair(set, mechanism, stops%joints(k), joint, bodies)
         if (joint == 0) call set%origins%error(findings, 'STOPS', set%link_item('ST'), 'entry '//to_text(k)//': there is no '// &
                                                'joint at this end of the arc', k)
      end do
      if (set%gives('MOTOR')) then
         motor = motor_of(set)
         if (motor%turns > 0) call set%origins%error(findings, 'MOTOR', 'NTURN', 'with &TIME the run-up is the '// &
                                                     'motion itself; leave NTURN out')
         if (motor%start > 0.0_wp) call set%origins%error(findings, 'MOTOR', 'WSTART', 'with &TIME the speed at '// &
                                                              'time 0 is VSTART')
         if (motor%fluctuation > 0.0_wp) call set%origins%error(findings, 'MOTOR', 'FLUCT', 'the flywheel of a '// &
                                                                    'steady cycle is found without &TIME')
         if (set%is_drawn()) then
            associate (free => free_drives(set, time))
               if (.not. free(motor%drive)) then
                  call set%origins%error(findings, 'MOTOR', trim(merge('     ', 'MNAME', motor%drive == 1)), 'the motor turns '// &
                                         'drive '//trim(set%sketch%drives(motor%drive)%name)//', which is not free (FREE of &TIME)')
               else if (mechanism%actuators(motor%drive)%slides) then
                  call set%origins%error(findings, 'MOTOR', 'MNAME', 'a motor turns a crank; drive '// &
                                         trim(set%sketch%drives(motor%drive)%name)//' slides')
               end if
            end associate
         end if
      end if
      if (set%is_drawn()) then
         if (any(free_drives(set, time) .and. abs(set%sketch%drives%speed) + abs(set%sketch%drives%accel) > 0.0_wp)) &
            call set%origins%warning(findings, 'DRIVES', 'DSPEED', 'DSPEED and DACCEL of a free drive '// &
                                     '(FREE of &TIME) are for the positions only; in time it starts with VSTART')
      end if
      if (.not. allocated(time%started) .and. size(time%rates) > count(free_drives(set, time))) &
         call set%origins%error(findings, 'TIME', 'VSTART', 'more speeds are given than there are free drives')
   end subroutine check_time

   !> True if a drive that is not free moves.
   pure logical function moves(set, time)
      type(data_set_t), intent(in) :: set
      type(time_group_t), intent(in) :: time
      logical, allocatable :: given(:)

      moves = .false.
      if (.not. allocated(time%free)) return
      given = .not. (free_drives(set, time) .or. set%sketch%drives%geared)
      moves = given(1) .and. abs(set%rates%speed) + abs(set%rates%accel) > 0.0_wp
      associate (others => set%sketch%drives(2:))
         moves = moves .or. any(given(2:) .and. abs(others%speed) + abs(others%accel) > 0.0_wp)
      end associate
   end function moves

   !> The drives that move freely; those that follow the first are not counted.
   pure function free_drives(set, time) result(free)
      type(data_set_t), intent(in) :: set
      type(time_group_t), intent(in) :: time
      logical, allocatable :: free(:)

      if (.not. set%is_drawn()) then
         free = [.true.]
      else if (allocated(time%free)) then
         free = time%free
      else
         free = .not. set%sketch%drives%geared
      end if
   end function free_drives

   !> Follow a case that `check_time` found no fault with.
   subroutine find_time(set, given, dimensions, forces, study, stop, times)
      use psalm_time_chart, only: time_chart_t, list_drives, exchange_drives
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_study_t), intent(in) :: forces         !! at the positions: names, model
      type(time_study_t), intent(out) :: study
      type(stop_t), intent(in), optional :: stop        !! asked before every step; the times so far are there then
      real(wp), intent(in), optional :: times(:)        !! s, ascending, the first 0: in place of those of the case
      class(problem_t), allocatable :: problem          ! large, as the others are: they would fill a small stack
      type(time_chart_t), allocatable :: chart, of_case
      type(time_motion_t), allocatable :: moving
      type(time_group_t) :: time
      type(stops_group_t) :: named
      type(joint_stop_t), allocatable :: stops(:), rubbing(:)
      type(free_state_t) :: state
      type(free_motion_t), allocatable :: still
      real(wp), allocatable :: start(:), speed(:), accel(:), own(:, :), speeds(:)
      complex(wp), allocatable :: places(:, :, :)
      real(wp), allocatable :: moved(:, :, :)
      real(wp) :: first_energy
      integer :: k, row, drives
      logical :: valid

      time = time_of(set)
      if (present(times)) time%times = times
      study%free = free_drives(set, time)
      study%end = time%times(size(time%times))
      study%moves = study%end > 0.0_wp
      if (.not. study%moves) study%end = 1.0_wp
      study%forces = forces
      drives = size(given%mechanism%actuators)
      call set_motion_up()
      study%free_drives = moving%motion%free
      study%zero_input = reference_input(given%mechanism, dimensions)
      if (time%equilibria) then
         study%rests = .true.
         allocate (still, source=moving%motion)
         call find_equilibria(still, moving%sizes(), time%starts, study%equilibria)
         deallocate (still)
      end if
      if (time%stiff) allocate (moving%stiff)
      call begin_motion(speeds, study%end, time%tolerance, time%events, time%steps, moving, valid)
      allocate (study%exchanges(0))
      if (set%has_names()) then
         call list_drives(set, chart, moving)
         ! what is shown by the drives of the case needs their assemblies, too
         if (present(times) .and. allocated(moving%joints)) then
            allocate (of_case)
            allocate (of_case%shown, source=chart%shown)
            of_case%rates = chart%rates
            of_case%sketch = chart%sketch
         end if
      end if
      call make_rows(size(time%times))
      row = 0
      if (valid) then
         do k = 1, size(time%times)
            do
               call moving%advance_to(time%times(k), valid)
               if (.not. moving%poor) exit
               call exchange()
            end do
            if (.not. valid) exit
            call moving%observe(state)
            row = k
            call keep()
            if (allocated(of_case) .and. size(study%exchanges) > 0) then
               call match_assembly(valid)
               if (.not. valid) then
                  row = k - 1
                  exit
               end if
            end if
            call tell_host(stop, k, size(time%times))
         end do
      end if
      study%stopped = moving%time
      study%steps = moving%steps
      study%stiff = moving%held
      study%gap = moving%gap
      if (associated(moving%stiff)) then
         call moving%stiff%close()
         deallocate (moving%stiff)
      end if
      if (.not. valid) then
         study%ended = time_collapsed
         if (moving%motion%massless .and. .not. moving%near_line()) study%ended = time_massless
         study%loop = moving%motion%open_loop
         if (study%loop > 0) study%ended = time_open
         if (moving%motion%wound > 0) then
            study%ended = time_wound
            study%loop = moving%motion%wound
         end if
         if (moving%motion%closed > 0) then
            study%ended = time_closed
            study%loop = moving%motion%closed
         end if
         if (moving%motion%jammed > 0) then
            study%ended = time_jammed
            study%loop = moving%motion%jammed
         end if
         if (moving%folded > 0) then
            study%ended = time_folded
            study%loop = moving%folded
         end if
         if (moving%crowded) study%ended = time_crowded
         if (moving%tired) study%ended = time_tired
         if (moving%endless) study%ended = time_stiff
         if (moving%asked) study%ended = time_on_request
      end if
      study%events = moving%events
      call keep_jumps()
      if (allocated(study%forces%tilt)) deallocate (study%forces%tilt)   ! of the drive at its speed
      call make_rows(row)
      if (row > 0) study%turnover = max(maxval(abs(study%forces%table%kinetic)), &
                                        maxval(abs(study%potential - study%potential(1))), maxval(abs(study%work)), &
                                        maxval(abs(study%lost)))
      study%forces%drive_power = [real(wp) ::]
      call size_up(study%forces, in_time=.true.)

   contains

      !> The problem twice: for the motion, with all vertices, and for what is shown.
      subroutine set_motion_up()
         integer :: d, width

         allocate (start(drives), speed(drives), accel(drives), source=0.0_wp)
         if (given%mechanism%from_drawing) start(1) = -given%mechanism%reference
         allocate (own(1, drives - 1), source=0.0_wp)
         allocate (problem, source=given)
         if (allocated(problem%linkages)) deallocate (problem%linkages)
         call problem%set_inputs(start(:1), own)
         allocate (chart)
         allocate (chart%shown, source=problem)
         call problem%want_derivatives(.true., vertices_of(problem%mechanism))
         call problem%bind(dimensions)
         if (set%has_names()) then
            chart%sketch = set%traced%moving
            call chart%shown%want_derivatives(.true., chart%sketch%points)
         else
            call chart%shown%want_derivatives(.true.)
         end if
         call chart%shown%bind(dimensions)
         allocate (chart%rates)
         call prepare_rates(chart%shown, chart%rates)
         if (.not. problem%mechanism%sliding_input) start(1) = start(1)/degrees_per_radian
         speed(1) = set%rates%speed
         accel(1) = set%rates%accel
         if (set%is_drawn()) then
            do d = 2, drives
               speed(d) = set%sketch%drives(d)%speed
               accel(d) = set%sketch%drives(d)%accel
            end do
         end if
         where (study%free .or. problem%mechanism%actuators%geared)
            speed = 0.0_wp
            accel = 0.0_wp
         end where
         allocate (moving)
         if (present(stop)) moving%host = stop
         allocate (moving%motion)
         call make_stops(set, problem, stops)
         call rubbing_joints(forces%model, problem, rubbing)
         named = stops_of(set)
         study%smooth = size(stops)
         stops = [stops, rubbing]
         call make_free_motion(problem, forces%model, motor_of(set), study%free, start, speed, accel, stops, moving%motion, &
                               at_rest=set%friction%at_rest, smooth=study%smooth)
         width = maxval([len(named%names), (len(problem%mechanism%joints(rubbing(d)%joint)%name), d=1, size(rubbing))])
         allocate (character(width) :: study%stop_names(size(stops)))
         study%stop_names(:study%smooth) = named%names
         do d = 1, size(rubbing)
            study%stop_names(study%smooth + d) = problem%mechanism%joints(rubbing(d)%joint)%name
         end do
         study%stop_slides = stops%slides
         allocate (speeds(size(moving%motion%free)), source=0.0_wp)
         do d = 1, size(time%rates)
            if (allocated(time%started)) then
               speeds(findloc(moving%motion%free, time%started(d), dim=1)) = time%rates(d)
            else
               speeds(d) = time%rates(d)
            end if
         end do
         allocate (places(0, 0:most_orders, 1), moved(0, 0:most_orders, 1))
         if (.not. set%has_names()) return
         deallocate (places, moved)
         allocate (places(size(chart%sketch%drawn), 0:most_orders, 1), moved(size(set%sketch%slides), 0:most_orders, 1))
         call names_of_numbers(set%sketch%outputs, study%sketch%names, study%sketch%angles)
      end subroutine set_motion_up

      !> Room for so many rows; those that are there are kept.
      subroutine make_rows(rows)
         integer, intent(in) :: rows

         if (.not. allocated(study%time)) then
            allocate (study%time(rows), study%potential(rows), study%work(rows), study%lost(rows), study%balance(rows), &
                      source=0.0_wp)
            allocate (study%stops(rows, size(stops)), source=0.0_wp)
            allocate (study%drives(rows, drives, 0:rates_shown), source=0.0_wp)
            allocate (study%output(rows, given%output%kind%components, 0:rates_shown), source=0.0_wp)
            if (set%has_names()) then
               allocate (study%sketch%values(size(study%sketch%names), 0:most_orders, rows), source=0.0_wp)
               allocate (study%sketch%joints(size(set%sketch%joint_name), 0:most_orders, rows), source=(0.0_wp, 0.0_wp))
            end if
            associate (columns => size(forces%table%value, 2), table => study%forces%table)
               deallocate (table%value, table%kinetic, table%growth)
               allocate (table%value(rows, columns), table%kinetic(rows), table%growth(rows), source=0.0_wp)
               table%dead = spread(0, 1, rows)
            end associate
         else
            study%time = study%time(:rows)
            study%potential = study%potential(:rows)
            study%work = study%work(:rows)
            study%lost = study%lost(:rows)
            study%balance = study%balance(:rows)
            study%stops = study%stops(:rows, :)
            if (allocated(study%turned)) study%turned = study%turned(:rows, :)
            call keep_orders()
            study%forces%table%value = study%forces%table%value(:rows, :)
            study%forces%table%kinetic = study%forces%table%kinetic(:rows)
            study%forces%table%dead = study%forces%table%dead(:rows)
            study%forces%table%growth = study%forces%table%growth(:rows)
         end if
         associate (table => study%forces%table)
            table%closed = spread(.true., 1, rows)
            table%sweeps = spread(1, 1, rows)
            table%at_rest = spread(.false., 1, rows)
         end associate
         study%sketch%closed = spread(.true., 1, rows)
         study%sketch%dead = spread(.false., 1, rows)
         study%forces%input = study%time
      end subroutine make_rows

      !> Other drives take the place of the free ones; where that cannot be the motion goes on with these as far as it comes.
      subroutine exchange()
         integer :: better(size(moving%motion%free)), d
         type(drive_exchange_t) :: one
         real(wp) :: share
         logical :: done

         moving%poor = .false.
         call moving%compare_drives(share, better)
         call moving%observe(state)
         call exchange_drives(set, given%mechanism, chart, moving, better, state, done)
         if (.not. done) then
            deallocate (moving%joints)
            return
         end if
         call list_drives(chart%set, chart, moving)
         one%time = moving%time
         one%names = ''
         do d = 1, size(better)
            if (d > 1) one%names = one%names//', '
            one%names = one%names//chart%set%sketch%drive_label(moving%motion%free(d))
         end do
         study%exchanges = [study%exchanges, one]
      end subroutine exchange

      subroutine keep()
         real(wp) :: inputs(drives), values(highest_order, given%output%kind%components)
         real(wp) :: largest(2)
         integer :: d, r, c

         study%time(row) = time%times(row)
         inputs = state%input
         where (.not. moving%motion%slides) inputs = inputs*degrees_per_radian
         if (allocated(state%named)) then
            study%drives(row, :, 1:) = state%named(:, 1:)
            study%drives(row, :, 0) = (start + state%named(:, 0))* &
                                      merge(1.0_wp, degrees_per_radian, given%mechanism%actuators%slides)
         else
            study%drives(row, :, 1) = state%rate
            study%drives(row, :, 2) = state%accel
            study%drives(row, :, 0) = inputs
         end if
         study%drives(row, 1, 0) = study%zero_input + study%drives(row, 1, 0)
         do d = 2, drives
            if (given%mechanism%actuators(d)%geared) study%drives(row, d, 0) = &
               set%sketch%drives(d)%ratio*study%drives(row, 1, 0) + set%sketch%drives(d)%phase
         end do
         associate (shown => chart%shown)
            call chart%solve_shown(moving%motion, state)
            if (set%has_names()) then
               call observe_sketch(chart%sketch, shown, chart%rates, 1, 1.0_wp, 0.0_wp, places, moved)
               if (allocated(chart%travelled)) moved(:, 0, 1) = moved(:, 0, 1) + chart%travelled
               study%sketch%joints(:, :, row) = places(:size(study%sketch%joints, 1), :, 1)
               largest = 0.0_wp
               do r = 1, size(shown%linkage%root_x)
                  largest(1) = max(largest(1), abs(chart%rates%d(1)%v(1, shown%linkage%root_x(r))))
               end do
               largest(2) = max(maxval(abs(study%sketch%joints(:, 1, row))), maxval(abs(moved(:, 1, 1))))
               call values_of_outputs(set%sketch%outputs, study%sketch%joints(:, :, row), moved(:, :, 1), largest, &
                                      study%sketch%values(:, :, row))
            else
               call shown%output_of(1)
               call output_rates(shown, chart%rates, 1, rates_shown, values)
               do c = 1, size(study%output, 2)
                  study%output(row, c, 0) = shown%output%actual(c, 1, shown%linkage)
                  study%output(row, c, 1:) = values(:rates_shown, c)
               end do
            end if
         end associate
         associate (table => study%forces%table)
            table%value(row, :) = chart%columns_of_case(given%mechanism, study%free, state)
            if (.not. set%masses%motor_on_frame) call take_motors_off(given%mechanism, table%value(row:row, :))
            table%kinetic(row) = state%kinetic
            table%growth(row) = state%growth
            table%dead(row) = state%undetermined
            if (moving%motion%passages > 0 .and. .not. allocated(chart%set)) call note_assembly()
            study%potential(row) = state%potential
            study%stops(row, :) = state%stops(:size(stops))
            study%work(row) = moving%work()
            study%lost(row) = moving%lost()
            if (row == 1) first_energy = state%kinetic + state%potential
            study%balance(row) = state%kinetic + state%potential - study%work(row) + study%lost(row) - first_energy
         end associate
      end subroutine keep

      !> Which dyads are not in the assembly of the drawing.
      subroutine note_assembly()
         integer :: loop, k

         if (.not. allocated(study%turned)) allocate (study%turned(size(study%time), given%mechanism%nloop), source=.false.)
         associate (link => moving%motion%problem%linkage)
            do loop = 1, given%mechanism%nloop
               k = link%step_of_loop(loop)
               if (k > 0) study%turned(row, loop) = link%steps(k)%dyad%sign*real(given%mechanism%groups(loop)%sign, wp) < 0.0_wp
            end do
         end associate
      end subroutine note_assembly

      !> The assembly of the dyads of the case in which its drives lead to what the exchanged ones have: that of the row before, or
      !> with some of its dyads in the other one. `found` is false where there is none, as in a larger group.
      subroutine match_assembly(found)
         logical, intent(out) :: found
         integer, parameter :: most_loops = 10
         real(wp), parameter :: near = 1.0e-6_wp       ! part of the size: beside a dead point a drive loses half the digits
         logical :: tried(given%mechanism%nloop), best(given%mechanism%nloop)
         real(wp) :: least, distance, size_of_all
         integer :: code, loop

         if (.not. allocated(study%turned)) allocate (study%turned(size(study%time), size(tried)), source=.false.)
         best = study%turned(max(1, row - 1), :)
         size_of_all = maxval(abs(study%sketch%joints(:, 0, row) - study%sketch%joints(1, 0, row)))
         least = distance_of(best)
         if (least > near*size_of_all .and. size(tried) <= most_loops) then
            do code = 1, 2**size(tried) - 1
               tried = [(btest(code, loop - 1), loop=1, size(tried))]
               tried = tried .neqv. study%turned(max(1, row - 1), :)
               distance = distance_of(tried)
               if (distance >= least) cycle
               least = distance
               best = tried
            end do
         end if
         found = least <= near*size_of_all
         study%turned(row, :) = best
      end subroutine match_assembly

      !> How far joints are off if the dyads of the case are in an assembly.
      real(wp) function distance_of(assembly) result(distance)
         logical, intent(in) :: assembly(:)
         complex(wp) :: at(size(of_case%sketch%drawn), 0:most_orders, 1)
         real(wp) :: travel(size(set%sketch%slides), 0:most_orders, 1), inputs(drives)
         integer :: offset, n

         inputs = (start + state%named(:, 0))*merge(1.0_wp, degrees_per_radian, given%mechanism%actuators%slides)
         associate (shown => of_case%shown)
            call shown%set_turned(reshape(assembly, [1, size(assembly)]))
            if (drives > 1) shown%own_delt(1, :) = inputs(2:)
            call shown%move_inputs(inputs(:1))
            call shown%solve_block(1, offset, n)
            call differentiate(shown, of_case%rates, n, 1)
            call observe_sketch(of_case%sketch, shown, of_case%rates, n, 1.0_wp, 0.0_wp, at, travel)
         end associate
         associate (joints => study%sketch%joints(:, 0, row))
            distance = maxval(abs(at(:size(joints), 0, 1) - joints))
         end associate
      end function distance_of

      !> Rates of the drives before and after impacts.
      subroutine keep_jumps()
         integer :: j

         allocate (study%jump_time(moving%jumped), study%jumps(moving%jumped, drives, 3))
         do j = 1, moving%jumped
            study%jump_time(j) = moving%jumps(1, j)
            study%jumps(j, :, :) = reshape(moving%jumps(2:, j), [drives, 3])
            ! with other drives those of the case are counted from time 0
            if (size(study%exchanges) > 0) then
               if (study%jump_time(j) > study%exchanges(1)%time) study%jumps(j, :, 1) = study%jumps(j, :, 1) + start
            end if
            call show_places(study%jumps(j, :, 1))
         end do
      end subroutine keep_jumps

      !> Increments of the drives, radians or lengths, become their places as shown.
      subroutine show_places(places)
         real(wp), intent(inout) :: places(:)             !! shape (drives)
         integer :: d

         where (.not. given%mechanism%actuators%slides) places = places*degrees_per_radian
         places(1) = study%zero_input + places(1)
         do d = 2, drives
            if (given%mechanism%actuators(d)%geared) places(d) = set%sketch%drives(d)%ratio*places(1) + set%sketch%drives(d)%phase
         end do
      end subroutine show_places

      !> Rows of what has orders, which count from 0.
      subroutine keep_orders()
         real(wp), allocatable :: numbers(:, :, :)
         complex(wp), allocatable :: joints(:, :, :)

         allocate (numbers(row, drives, 0:rates_shown))
         numbers = study%drives(:row, :, :)
         call move_alloc(numbers, study%drives)
         allocate (numbers(row, size(study%output, 2), 0:rates_shown))
         numbers = study%output(:row, :, :)
         call move_alloc(numbers, study%output)
         if (.not. set%has_names()) return
         allocate (numbers(size(study%sketch%values, 1), 0:most_orders, row))
         numbers = study%sketch%values(:, :, :row)
         call move_alloc(numbers, study%sketch%values)
         allocate (joints(size(study%sketch%joints, 1), 0:most_orders, row))
         joints = study%sketch%joints(:, :, :row)
         call move_alloc(joints, study%sketch%joints)
      end subroutine keep_orders
   end subroutine find_time

   !> Increments of the drives at the times, degrees or length: of the first from the reference position, of others from the
   !> drawing.
   pure function increments_of(study) result(increments)
      type(time_study_t), intent(in) :: study
      real(wp) :: increments(size(study%time), size(study%free))  !! shape (rows, drives)

      increments = study%drives(:, :, 0)
      increments(:, 1) = increments(:, 1) - study%zero_input
   end function increments_of
end module psalm_time_study
