!> Tables of the vibration of links, of flexible drives and of Hill's equation.
module psalm_vibration_table
   use psalm_crank_motion, only: crank_motion_t, constant_motion
   use psalm_data_set, only: data_set_t
   use psalm_drive_study, only: drive_study_t, hill_study_t, matters, least_drive_ratio
   use psalm_estimate_study, only: estimate_t, harmonics_estimated, rules
   use psalm_hill, only: hill_t
   use psalm_kinds, only: wp, full_turn
   use psalm_stability, only: boundaries_t
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: lower_case, to_text
   use psalm_vibration_group, only: estimate_group_t, estimates_of
   use psalm_vibration_list, only: first_good, link_words, root_of, stability_words, unstable_speeds, verdict_words
   use psalm_vibration_study, only: vibration_study_t, mode_t, harmonics_listed
   implicit none (type, external)
   private
   public :: put_vibration, put_estimates, put_drive, put_hill

   integer, parameter :: name_length = 80              !! characters of a word in a table

contains

   !> Tables vibration, modes, boundaries, boundary_series, multipliers, harmonics, response, speeds, unstable_speeds, chart.
   pure subroutine put_vibration(study, tables)
      type(vibration_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer, allocatable :: unique(:)
      integer :: j, p, k, n

      call put_link(study, tables)
      call put_modes(study%modes, tables)
      table = table_of('boundaries', 'a row for each boundary of stability of a mode')
      associate (modes => study%modes)
         call add_boundaries('mode', [(real(j, wp), j=1, size(modes))], modes%exact, .true., table)
         call add_range('omega2', [((modes(j)%exact%low(p), p=0, ubound(modes(j)%exact%low, 1)), j=1, size(modes))], &
                        [((modes(j)%exact%high(p), p=0, ubound(modes(j)%exact%low, 1)), j=1, size(modes))], table)
         call tables%put(table)
         call put_series(study, tables)
         table = table_of('multipliers', 'a row for each multiplier of a mode; mode 0: of all modes together')
         call table%add('mode', [((j, k=1, 2), j=1, size(modes)), (0, k=1, size(study%multipliers))])
         call add_complex([((modes(j)%hill%multipliers(k), k=1, 2), j=1, size(modes)), study%multipliers], table)
         call tables%put(table)
         table = table_of('harmonics', 'a row for each harmonic of the deflection of a mode')
         unique = pack([(j, j=1, size(modes))], modes%hill%unique)
         call table%add('mode', [((unique(j), n=0, harmonics_listed), j=1, size(unique))])
         call table%add('n', [((n, n=0, harmonics_listed), j=1, size(unique))])
         call table%add('amplitude', [((modes(unique(j))%amplitude(n), n=0, harmonics_listed), j=1, size(unique))], 'm')
         call tables%put(table)
      end associate
      call put_response('response', 'm', study%modes(1)%hill, study%cycle%length, study%cycle%crank, 1, tables)
      if (allocated(study%stresses)) then
         if (study%stresses%known) then
            associate (of => study%stresses)
               table = table_of('stresses', 'a row for each position: the greatest stresses along the link')
               call table%add('input', study%cycle%crank%input, 'deg')
               call table%add('bending', of%bending, 'Pa')
               call table%add('along', of%along, 'Pa')
               call table%add('both', of%both, 'Pa')
               call table%add('place', of%place)
               call tables%put(table)
            end associate
         end if
      end if
      if (size(study%speeds) > 0) then
         associate (rows => study%speeds)
            call put_speeds('speeds', 'm', rows%speed, rows%amplitude, rows%known, rows%stable, tables)
         end associate
      end if
      if (study%bands_known .and. size(study%speeds) > 0) then
         table = table_of('unstable_speeds', 'a row for each range of speeds at which mode 1 grows', audience=for_programs)
         call table%add('speed_from', study%bands%from, 'rad/s')
         call table%add('speed_to', study%bands%to, 'rad/s')
         call tables%put(table)
      end if
      if (size(study%chart) == 0) return
      table = table_of('chart', 'a row for each boundary of stability, as a speed, and factor on the masses')
      associate (rows => study%chart)
         call add_boundaries('e', rows%e, rows%exact, .false., table)
         call add_range('omega', [((root_of(rows(k)%exact%low(p)), p=0, ubound(rows(k)%exact%low, 1)), k=1, size(rows))], &
                        [((root_of(rows(k)%exact%high(p)), p=0, ubound(rows(k)%exact%low, 1)), k=1, size(rows))], table)
      end associate
      call tables%put(table)
   end subroutine put_vibration

   !> The link itself, and all modes together.
   pure subroutine put_link(study, tables)
      type(vibration_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of('vibration', 'one row: the link, and all modes together', audience=for_programs)
      associate (many => [size(study%modes) > 1])
         call table%add('length', [study%cycle%length], 'm')
         call table%add('mass', [study%cycle%mass], 'kg')
         call table%add('frequency', [study%frequency], 'rad/s')
         call table%add('frequency_per_speed', [study%ratio])
         call table%add('coupling', [study%mixing])
         call table%add('stable', [study%stable], known=many)
         call table%add('multipliers_found', [study%multipliers_found], known=many)
         call table%add('determinant_error', [study%determinant_error], known=many)
      end associate
      call tables%put(table)
   end subroutine put_link

   !> What becomes of each mode.
   pure subroutine put_modes(modes, tables)
      type(mode_t), intent(in) :: modes(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: j

      table = table_of('modes', 'a row for each mode', audience=for_programs)
      call table%add('mode', [(j, j=1, size(modes))])
      call add_periodic(modes%hill, table)
      call table%add('greatest', modes%greatest, 'm', modes%hill%unique)
      call table%add('buckles', modes%least_stiffness < 0.0_wp)
      call table%add('least_stiffness', modes%least_stiffness)
      call table%add('least_stiffness_at', modes%least_at, 'deg')
      call table%add('boundary_error', [(modes(j)%exact%error, j=1, size(modes))])
      associate (first => [(first_good(modes(j)), j=1, size(modes))])
         call table%add('series_from', first, known=[(first(j) <= ubound(modes(j)%exact%low, 1), j=1, size(modes))])
      end associate
      call tables%put(table)
   end subroutine put_modes

   !> The boundaries by Oldham's series, and the speeds at which the link as it is grows.
   pure subroutine put_series(study, tables)
      type(vibration_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      real(wp), allocatable :: speeds(:, :)
      integer, allocatable :: last(:)
      integer :: j, p, n

      associate (modes => study%modes)
         table = table_of('boundary_series', 'a row for each boundary of a mode: (13.27), (13.28), unstable speeds', &
                          audience=for_programs)
         call add_boundaries('mode', [(real(j, wp), j=1, size(modes))], modes%exact, .true., table)
         last = [(ubound(modes(j)%exact%low, 1), j=1, size(modes))]
         call add_range('first', [((modes(j)%first(1, p), p=0, last(j)), j=1, size(modes))], &
                        [((modes(j)%first(2, p), p=0, last(j)), j=1, size(modes))], table)
         call add_range('second', [((modes(j)%second(1, p), p=0, last(j)), j=1, size(modes))], &
                        [((modes(j)%second(2, p), p=0, last(j)), j=1, size(modes))], table)
      end associate
      allocate (speeds(2, sum(last + 1)))
      n = 0
      do j = 1, size(last)
         do p = 0, last(j)
            n = n + 1
            speeds(:, n) = unstable_speeds(study, j, p)
         end do
      end do
      call table%add('speed_from', speeds(1, :), 'rad/s')
      call table%add('speed_to', speeds(2, :), 'rad/s')
      call tables%put(table)
   end subroutine put_series

   !> What is found of a periodic solution: whether it is the response, and how far the integration is to be trusted.
   pure subroutine add_periodic(hill, table)
      type(hill_t), intent(in) :: hill(:)
      type(table_t), intent(inout) :: table
      character(name_length), allocatable :: words(:)
      integer :: k

      allocate (words(size(hill)))
      do k = 1, size(hill)
         words(k) = lower_case(stability_words(hill(k)))
      end do
      call table%add('verdict', words)
      call table%add('stable', hill%stable)
      call table%add('neutral', hill%neutral)
      call table%add('unique', hill%unique)
      call table%add('converged', hill%converged)
      call table%add('matrix_error', hill%error, known=.not. hill%grows_too_much)
      call table%add('determinant_error', hill%determinant_error, known=.not. hill%grows_too_much)
      call table%add('steps', hill%steps)
   end subroutine add_periodic

   !> The columns of a case and of the numbers of its boundaries.
   pure subroutine add_boundaries(name, values, boundaries, whole, table)
      character(*), intent(in) :: name
      real(wp), intent(in) :: values(:)              !! shape (cases)
      type(boundaries_t), intent(in) :: boundaries(:) !! the same shape
      logical, intent(in) :: whole                   !! the values are integers
      type(table_t), intent(inout) :: table
      integer :: k, p

      associate (each => [((values(k), p=0, ubound(boundaries(k)%low, 1)), k=1, size(values))])
         if (whole) then
            call table%add(name, nint(each))
         else
            call table%add(name, each)
         end if
      end associate
      call table%add('p', [((p, p=0, ubound(boundaries(k)%low, 1)), k=1, size(values))])
   end subroutine add_boundaries

   pure subroutine add_range(name, low, high, table)
      character(*), intent(in) :: name
      real(wp), intent(in) :: low(:), high(:)
      type(table_t), intent(inout) :: table

      call table%add(name//'_low', low)
      call table%add(name//'_high', high)
   end subroutine add_range

   pure subroutine add_complex(values, table)
      complex(wp), intent(in) :: values(:)
      type(table_t), intent(inout) :: table

      call table%add('re', real(values, wp))
      call table%add('im', aimag(values))
   end subroutine add_complex

   !> Greatest deflections at speeds.
   pure subroutine put_speeds(block, unit, speed, amplitude, known, stable, tables)
      character(*), intent(in) :: block
      character(*), intent(in) :: unit         !! of the amplitude
      real(wp), intent(in) :: speed(:), amplitude(:)
      logical, intent(in) :: known(:), stable(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of(block, 'a row for each speed: the greatest amplitude, and whether it settles')
      call table%add('speed', speed, 'rad/s')
      call table%add('amplitude', amplitude, unit, known)
      call table%add('stable', stable)
      call tables%put(table)
   end subroutine put_speeds

   !> Input in degrees from the reference position; derivatives by it, per radian, of a speed that varies by the mean turning.
   pure subroutine put_response(block, unit, hill, factor, crank, waves, tables)
      character(*), intent(in) :: block
      character(*), intent(in) :: unit         !! of y
      type(hill_t), intent(in) :: hill
      real(wp), intent(in) :: factor           !! y in this unit
      type(crank_motion_t), intent(in) :: crank
      integer, intent(in) :: waves             !! periods in a turn: y stands for that many times the deflection
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer, parameter :: most_rows = 16384  !! more steps than these are thinned evenly: a file of 24 MB is of no use
      real(wp), allocatable :: y(:, :)
      character(:), allocatable :: per
      real(wp) :: many
      integer :: stride

      allocate (y(0, 0:2))
      many = real(waves, wp)
      if (hill%unique) then
         stride = 1 + (size(hill%y) - 1)/most_rows
         do while (modulo(size(hill%y), stride) > 0)
            stride = stride + 1
         end do
         deallocate (y)
         allocate (y(size(hill%y)/stride, 0:2))
         y(:, 0) = factor*(hill%y(::stride)/many)
         y(:, 1) = factor*(crank%sense*hill%y1(::stride))
         y(:, 2) = factor*(hill%y2(::stride)*many)
      end if
      table = table_of(block, 'a row for each input of a period: the steady response and its derivatives')
      call table%add('input', steps_of_turn(size(y, 1), crank, waves), 'deg')
      per = unit
      if (len(unit) == 0) per = '1'
      call table%add('y', y(:, 0), unit)
      call table%add('y1', y(:, 1), per//'/rad')
      call table%add('y2', y(:, 2), per//'/rad^2')
      call tables%put(table)
   end subroutine put_response

   !> Inputs at equal steps of the time of a period from the reference position, degrees.
   pure function steps_of_turn(steps, crank, waves) result(input)
      integer, intent(in) :: steps, waves
      type(crank_motion_t), intent(in) :: crank
      real(wp) :: input(steps), whole(waves*steps)

      whole = crank%inputs(waves*steps)
      input = whole(:steps)
   end function steps_of_turn

   !> Tables estimates, estimate_rules and estimate_harmonics, for other programs.
   subroutine put_estimates(set, estimates, tables)
      type(data_set_t), intent(in) :: set
      type(estimate_t), intent(in) :: estimates(:)
      type(tables_t), intent(inout) :: tables
      type(estimate_group_t) :: group
      type(table_t) :: table
      character(name_length), allocatable :: links(:), verdicts(:)
      integer :: k, n

      group = estimates_of(set)
      table = table_of('estimates', 'a row for each link', audience=for_programs)
      associate (bent => .not. estimates%buckles)
         allocate (links(size(estimates)), verdicts(size(estimates)))
         do k = 1, size(estimates)
            links(k) = link_words(set, group%beams(k)%link, ' in loop ', 'arc ')
            verdicts(k) = lower_case(verdict_words(estimates(k)%verdict))
         end do
         call table%add('link', links)
         call table%add('verdict', verdicts)
         call table%add('length', [(estimates(k)%cycle%length, k=1, size(estimates))], 'm')
         call table%add('slenderness', estimates%slenderness)
         call table%add('frequency_per_speed', estimates%ratio)
         call table%add('fall_by_shear', estimates%shear_fall)
         call table%add('frequency_on_posts', estimates%post_ratio)
         call table%add('greatest_end_load', estimates%push, 'N')
         call table%add('euler_load', estimates%euler, 'N')
         call table%add('buckles', estimates%buckles)
         call table%add('deflection', estimates%deflection, 'm', bent)
         call table%add('deflection_at', estimates%at, known=bent)
         call table%add('deflection_mode1', estimates%first, 'm', bent)
         call table%add('deflection_mode2', estimates%second, 'm', bent)
         call table%add('deflection_at_rest', estimates%resting, 'm', bent .and. estimates%loaded)
         call table%add('dynamic_error', estimates%error, 'm', bent)
         call table%add('resonant_error', estimates%resonant, 'm', bent)
         call table%add('resonant_harmonic', estimates%harmonic)
         call table%add('magnified_by_impulses', estimates%magnifier, known=bent)
         call table%add('impact_jerk', estimates%jerk, 'm/s^3', estimates%jerk > 0.0_wp)
         call table%add('impact_time', estimates%impact_time, 's', estimates%jerk > 0.0_wp)
         call table%add('impact_speed', estimates%impact_speed, 'm/s', estimates%jerk > 0.0_wp)
         call table%add('impact_level', estimates%impact_level, 'm/s^2', estimates%jerk > 0.0_wp)
         call table%add('pins_nearer', estimates%shortened, 'm', bent)
         call table%add('straightened', estimates%straightened, known=bent)
         call table%add('acceleration', estimates%middle, 'm/s^2')
         call table%add('resonant_acceleration', estimates%amplitude, 'm/s^2')
         call table%add('resonant_bound', estimates%bound, 'm/s^2')
         call table%add('least_frequency_per_speed', estimates%strength, known=estimates%strength > 0.0_wp)
         call table%add('least_frequency_per_speed_of_tie_rod', estimates%tie_rod, known=estimates%strength > 0.0_wp)
      end associate
      call tables%put(table)
      call put_rules(links, estimates, tables)
      table = table_of('estimate_harmonics', 'a row for each link and harmonic of the acceleration of its middle', &
                       audience=for_programs)
      call table%add('link', [((k, n=1, harmonics_estimated), k=1, size(estimates))])
      call table%add('n', [((n, n=1, harmonics_estimated), k=1, size(estimates))])
      call table%add('amplitude', [(estimates(k)%amplitudes, k=1, size(estimates))], 'm/s^2')
      call table%add('bound', [(estimates(k)%bounds, k=1, size(estimates))], 'm/s^2')
      call tables%put(table)
   end subroutine put_estimates

   !> Haines's rules for a link that is rigid enough.
   pure subroutine put_rules(links, estimates, tables)
      character(*), intent(in) :: links(:)         !! names
      type(estimate_t), intent(in) :: estimates(:) !! the same shape
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      logical, allocatable :: measured(:)
      character(name_length) :: names(size(rules)), owners(size(rules)*size(links))
      integer :: k, n

      measured = [(estimates(k)%measured, k=1, size(estimates))]
      do k = 1, size(links)
         owners((k - 1)*size(rules) + 1:k*size(rules)) = links(k)
      end do
      table = table_of('estimate_rules', 'a row for each link and rule of Haines', audience=for_programs)
      do n = 1, size(rules)
         names(n) = lower_case(rules(n)%name)
      end do
      call table%add('link', pack(owners, measured))
      call table%add('rule', pack([(names, k=1, size(estimates))], measured))
      call table%add('value', pack([(estimates(k)%measures, k=1, size(estimates))], measured))
      call table%add('limit', pack([(rules%limit, k=1, size(estimates))], measured))
      call table%add('at_least', pack([(rules%at_least, k=1, size(estimates))], measured))
      call table%add('kept', pack([(estimates(k)%kept, k=1, size(estimates))], measured))
      call tables%put(table)
   end subroutine put_rules

   !> Tables drive, drive_inertia, drive_torque, drive_multipliers, drive_harmonics, drive_response, drive_speeds.
   pure subroutine put_drive(study, tables)
      type(drive_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      call put_crank(study, tables)
      table = table_of('drive_inertia', 'a row for each input of a period: the inertia that the crank feels')
      call table%add('input', steps_of_turn(size(study%inertia), study%turn%crank, study%waves), 'deg')
      call table%add('inertia', study%inertia, 'kg m^2')
      call tables%put(table)
      if (study%loaded) then
         table = table_of('drive_torque', 'a row for each input: the torque of weight, loads and springs, and that of '// &
                          'dampers at 1 rad/s')
         call table%add('input', steps_of_turn(size(study%torque), study%turn%crank, 1), 'deg')
         call table%add('torque', study%torque, 'N m')
         call table%add('viscous', study%viscous, 'N m s')
         call tables%put(table)
      end if
      if (.not. study%found) return
      table = table_of('drive_multipliers', 'a row for each multiplier', audience=for_programs)
      call add_complex(study%hill%multipliers, table)
      call tables%put(table)
      if (study%hill%unique) call put_swing(study, tables)
      call put_response('drive_response', 'rad', study%hill, 1.0_wp, study%turn%crank, study%waves, tables)
      if (size(study%speeds) == 0) return
      associate (rows => study%speeds)
         call put_speeds('drive_speeds', 'rad', rows%speed, rows%amplitude, rows%known, rows%stable, tables)
      end associate
   end subroutine put_drive

   !> The drive as a whole.
   pure subroutine put_crank(study, tables)
      type(drive_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of('drive', 'one row: the flexible drive', audience=for_programs)
      associate (found => [study%found], real_ratio => [study%found .and. study%ratio_real], &
                 offsets => [study%found .and. study%with_offsets%mean > 0.0_wp])
         call table%add('found', found)
         call table%add('massless', [study%massless])
         call table%add('inertia_mean', [study%of_crank%mean], 'kg m^2', found)
         call table%add('inertia_half_range', [study%of_crank%half_range], known=found)
         call table%add('inertia_steepest', [study%of_crank%steepest], known=found)
         call table%add('inertia_mean_with_offsets', [study%with_offsets%mean], 'kg m^2', offsets)
         call table%add('inertia_half_range_with_offsets', [study%with_offsets%half_range], known=offsets)
         call table%add('inertia_steepest_with_offsets', [study%with_offsets%steepest], known=offsets)
         call table%add('stiffness', [study%stiffness], 'N m/rad', found)
         call table%add('d', [study%d], known=found)
         call table%add('frequency_per_speed', [study%ratio], known=real_ratio)
         call table%add('least_frequency_per_speed', [study%least], known=real_ratio)
         call table%add('rigid_enough', [study%least >= least_drive_ratio], known=real_ratio)
         call table%add('greatest_swing', [study%greatest], 'rad', [study%found .and. study%hill%unique])
      end associate
      if (study%found) call add_periodic([study%hill], table)
      call tables%put(table)
   end subroutine put_crank

   !> Harmonics of the crank's swing and acceleration, and of the output's.
   pure subroutine put_swing(study, tables)
      type(drive_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(:), allocatable :: number
      integer :: k

      table = table_of('drive_harmonics', 'a row for each harmonic; accelerations over the squared speed', audience=for_programs)
      associate (last => ubound(study%swing, 1))
         call table%add('n', [(k, k=0, last)])
         call table%add('swing', study%swing, 'rad')
         call table%add('acceleration', study%acceleration, 'rad')
         call table%add('matters', [(matters(k, study%acceleration(k)), k=0, last)])
      end associate
      do k = 1, size(study%output, 2)
         number = ''
         if (size(study%output, 2) > 1) number = to_text(k)
         call table%add('output'//number, study%output(:, k))
         call table%add('output'//number//'_of_rigid_drive', study%rigid(:, k))
      end do
      call tables%put(table)
   end subroutine put_swing

   !> Tables hill, hill_multipliers, hill_harmonics, hill_response.
   pure subroutine put_hill(study, tables)
      type(hill_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: k

      if (allocated(study%coupled)) then
         call put_coupled_hill(study, tables)
         return
      end if
      table = table_of('hill', 'one row: a period of the equation, from (1, 0), from (0, 1) and from rest', audience=for_programs)
      call add_periodic([study%hill], table)
      call table%add('y_from_y', study%hill%transfer(1:1, 1))
      call table%add('y1_from_y', study%hill%transfer(2:2, 1))
      call table%add('y_from_y1', study%hill%transfer(1:1, 2))
      call table%add('y1_from_y1', study%hill%transfer(2:2, 2))
      call table%add('y_from_rest', study%hill%forced(1:1))
      call table%add('y1_from_rest', study%hill%forced(2:2))
      call table%add('start_y', study%hill%start(1:1), known=[study%hill%unique])
      call table%add('start_y1', study%hill%start(2:2), known=[study%hill%unique])
      call table%add('greatest', [study%greatest], known=[study%hill%unique])
      call tables%put(table)
      table = table_of('hill_multipliers', 'a row for each multiplier')
      call add_complex(study%hill%multipliers, table)
      call tables%put(table)
      table = table_of('hill_harmonics', 'a row for each harmonic of the steady response')
      call table%add('n', [(k, k=0, ubound(study%amplitude, 1))])
      call table%add('amplitude', study%amplitude, known=spread(study%hill%unique, 1, size(study%amplitude)))
      call tables%put(table)
      call put_response('hill_response', '', study%hill, 1.0_wp, constant_motion(1.0_wp), 1, tables)
   end subroutine put_hill

   !> Of several equations: tables hill_equations, hill_multipliers, hill_equation_harmonics, hill_equation_response.
   pure subroutine put_coupled_hill(study, tables)
      type(hill_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: n, i, k, last

      n = size(study%peaks)
      last = ubound(study%amplitudes, 1)
      associate (coupled => study%coupled)
         table = table_of('hill_equations', 'a row for each equation', audience=for_programs)
         call table%add('equation', [(i, i=1, n)])
         call table%add('stable', spread(coupled%stable, 1, n))
         call table%add('unique', spread(coupled%unique, 1, n))
         call table%add('matrix_error', spread(coupled%error, 1, n))
         call table%add('greatest', study%peaks, known=spread(coupled%unique, 1, n))
         call tables%put(table)
         table = table_of('hill_multipliers', 'a row for each multiplier')
         call add_complex(coupled%multipliers, table)
         call tables%put(table)
         table = table_of('hill_equation_harmonics', 'a row for each equation and harmonic of the steady response')
         call table%add('equation', [((i, k=0, last), i=1, n)])
         call table%add('n', [((k, k=0, last), i=1, n)])
         call table%add('amplitude', reshape(study%amplitudes, [n*(last + 1)]), known=spread(coupled%unique, 1, n*(last + 1)))
         call tables%put(table)
         if (.not. coupled%unique) return
         table = table_of('hill_equation_response', 'a row for each equation and input of a period')
         last = size(coupled%y, 1)
         call table%add('equation', [((i, k=1, last), i=1, n)])
         call table%add('input', [((full_turn*real(k - 1, wp)/real(last, wp), k=1, last), i=1, n)], 'deg')
         call table%add('y', reshape(coupled%y, [n*last]))
         call table%add('y1', reshape(coupled%y1, [n*last]), '1/rad')
         call table%add('y2', reshape(coupled%y2, [n*last]), '1/rad^2')
         call tables%put(table)
      end associate
   end subroutine put_coupled_hill
end module psalm_vibration_table
