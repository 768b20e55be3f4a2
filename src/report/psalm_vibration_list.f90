!> Vibration of links, flexible drives and Hill's equation in the listing and on device 9.
module psalm_vibration_list
   use psalm_data_set, only: data_set_t
   use psalm_drive_group, only: hill_group_t, hill_of, drive_group_t, drive_of
   use psalm_drive_study, only: drive_study_t, hill_study_t, inertia_t, matters, least_drive_ratio, small_swing
   use psalm_estimate_study, only: estimate_t, verdict_rigid, verdict_closer, harmonics_estimated, stubby, rules
   use psalm_hill, only: hill_t
   use psalm_kinds, only: wp, pi, full_turn
   use psalm_place, only: place_t
   use psalm_stability, only: boundaries_t
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t, general, lower_case, to_text
   use psalm_vibration_group, only: estimate_group_t, estimates_of, vibration_group_t, vibration_of
   use psalm_vibration_study, only: vibration_study_t, mode_t, harmonics_listed
   implicit none (type, external)
   private
   public :: list_vibration, put_vibration, put_estimates, list_estimates, list_drive, put_drive, list_hill, put_hill, &
             stability_words, link_words

   integer, parameter :: name_room = 80              !! characters of a word in a table
   real(wp), parameter :: close_series = 0.01_wp     !! of a boundary: Oldham's (13.28) is close to it
   real(wp), parameter :: rpm_per_speed = 30.0_wp/pi !! revolutions per minute of 1 rad/s

contains

   ! ---- vibration of a link -----------------------------------------------------------------------------------------

   !> The group VIBR.
   subroutine list_vibration(set, study, text)
      type(data_set_t), intent(in) :: set
      type(vibration_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(vibration_group_t) :: vibration
      integer :: j, p, k, n

      vibration = vibration_of(set)
      call text%add()
      call text%add(' VIBRATION OF THE LINK '//link_words(set, vibration%beam%link, ' IN LOOP ', 'OF ARC ')// &
                    ': SI UNITS, SPEEDS IN RAD/S')
      call text%add(' LENGTH'//general(study%cycle%length)//'  MASS'//general(study%cycle%mass))
      call text%add(' FIRST FREQUENCY AT REST'//general(study%frequency)//', RATIO TO THE SPEED'//general(study%ratio))
      do j = 1, size(study%modes)
         associate (mode => study%modes(j))
            call text%add()
            call text%add(' MODE '//to_text(j)//': '//stability_words(mode%hill))
            if (mode%least_stiffness < 0.0_wp) then
               call text%add(' BUCKLED FOR A PART OF THE TURN: THE END LOAD EXCEEDS EULER''S LOAD, MOST AT INPUT'// &
                             general(mode%least_at)//' AFTER THE REFERENCE')
            end if
            call text%add(' BOUNDARIES OF STABILITY, SQUARED RATIO OF THE FIRST FREQUENCY TO THE SPEED (ERROR'// &
                          general(mode%exact%error)//')')
            call text%add('     P          EXACT FROM             TO    BY (13.27) FROM             TO    BY (13.28) FROM'// &
                          '             TO   UNSTABLE SPEEDS FROM         TO')
            do p = 0, ubound(mode%exact%low, 1)
               call text%add(repeat(' ', 6 - len(to_text(p)))//to_text(p)//'     '// &
                             general(mode%exact%low(p))//general(mode%exact%high(p))//'     '// &
                             general(mode%first(1, p))//general(mode%first(2, p))//'     '// &
                             general(mode%second(1, p))//general(mode%second(2, p))//'      '//speeds_of(p))
            end do
            p = first_good(mode)
            if (p <= ubound(mode%exact%low, 1)) then
               call text%add(' THESE ARE SERIES FOR SMALL COEFFICIENTS: (13.28) IS WITHIN 1 PER CENT FROM P = '//to_text(p)//' ON')
            else
               call text%add(' THESE ARE SERIES FOR SMALL COEFFICIENTS: (13.28) IS WITHIN 1 PER CENT AT NONE OF THE LAST P')
            end if
            call text%add(' MULTIPLIERS'//multiplier(mode%hill%multipliers(1))//multiplier(mode%hill%multipliers(2)))
            call list_accuracy(mode%hill, text)
            if (mode%hill%unique) then
               call text%add(' HARMONICS OF THE DEFLECTION'//trim(merge('                       ', ' (NOT THE STEADY STATE)', &
                                                                        mode%hill%stable .or. mode%hill%neutral)))
               do n = 0, harmonics_listed
                  call text%add(repeat(' ', 6 - len(to_text(n)))//to_text(n)//general(mode%amplitude(n)))
               end do
               call text%add(' GREATEST'//general(mode%greatest))
            end if
         end associate
      end do
      if (study%mixing > 0.0_wp) then
         call text%add()
         call text%add(' EACH MODE IS TAKEN BY ITSELF; LOADS AND SPRINGS ON THE LINK COUPLE THEM BY'//general(study%mixing)// &
                       ' OF THEIR STIFFNESS')
      end if
      if (size(study%modes) > 1) then
         call text%add()
         call text%add(' ALL MODES TOGETHER: '//trim(merge('STABLE    ', 'NOT STABLE', study%stable)))
         do k = 1, size(study%multipliers)
            call text%add('   MULTIPLIER'//multiplier(study%multipliers(k)))
         end do
         call text%add(' THEIR PRODUCT AGAINST THAT OF THE DAMPING: ERROR'//general(study%determinant_error))
         if (.not. study%multipliers_found) call text%add(' THE MULTIPLIERS ARE NOT ACCURATE: TOO MUCH GROWTH IN A TURN')
      end if
      if (size(study%speeds) > 0) then
         call text%add()
         call text%add(' MODE 1 OVER SPEEDS:      RAD/S            RPM     DEFLECTION')
         do k = 1, size(study%speeds)
            associate (row => study%speeds(k))
               call text%add(repeat(' ', 18)//general(row%speed)//general(row%speed*rpm_per_speed)// &
                             amplitude_text(row%known, row%stable .or. .not. row%grows, row%amplitude))
            end associate
         end do
         call text%add(' LARGEST ERROR OF A DETERMINANT'//general(maxval(study%speeds%determinant_error)))
         call text%add()
         if (size(study%bands) == 0) then
            call text%add(' MODE 1 GROWS AT NONE OF THESE SPEEDS')
         else
            call text%add(' MODE 1 GROWS AT SPEEDS FROM           TO   (RPM        FROM             TO)')
            do k = 1, size(study%bands)
               associate (b => study%bands(k))
                  call text%add(repeat(' ', 14)//general(b%from)//general(b%to)//'     '//general(b%from*rpm_per_speed)// &
                                general(b%to*rpm_per_speed))
               end associate
            end do
         end if
      end if
      if (size(study%chart) > 0) then
         call text%add()
         call text%add(' CHART OF STABILITY: FREQUENCY/SPEED FROM WHICH MODE 1 IS STABLE, IN A GAP WIDER THAN 0.1, THAN 0.25')
         call text%add(' (DEVICE 9 HAS ALL BOUNDARIES); BESIDE IT THE RULE OF THUMB (14.15), 1.4 + 0.85 E')
         call text%add('              E            0.1           0.25        (14.15)')
         do k = 1, size(study%chart)
            associate (row => study%chart(k))
               call text%add(general(row%e)//gap_text(row%exact, 0.1_wp)//gap_text(row%exact, 0.25_wp)// &
                             general(1.4_wp + 0.85_wp*row%e))
            end associate
         end do
      end if

   contains

      !> Speeds between two boundaries, of the link as it is. Below a boundary of p = 0 lie the speeds above it.
      function speeds_of(p) result(line)
         integer, intent(in) :: p
         character(:), allocatable :: line
         real(wp) :: low, high, base

         base = set%rates%speed**2*study%ratio**2 ! squared first frequency of the link at rest
         low = study%modes(j)%exact%low(p)
         high = study%modes(j)%exact%high(p)
         if (high <= 0.0_wp) then
            line = '           NONE'
         else if (p == 0) then
            line = general(sqrt(base/high))//'            ALL'
         else if (low <= 0.0_wp) then
            line = general(sqrt(base/high))//'            ALL'
         else
            line = general(sqrt(base/high))//general(sqrt(base/low))
         end if
      end function speeds_of
   end subroutine list_vibration

   !> The p from which on the series of second order is close to the exact boundaries; beyond the last if it never is.
   pure integer function first_good(mode) result(p)
      type(mode_t), intent(in) :: mode
      real(wp) :: exact(2)

      do p = ubound(mode%exact%low, 1), 0, -1
         exact = [mode%exact%low(p), mode%exact%high(p)]
         if (any(abs(mode%second(:, p) - exact) > close_series*abs(exact))) exit
      end do
      p = p + 1
   end function first_good

   !> How far the integration over a turn is to be trusted.
   subroutine list_accuracy(hill, text)
      type(hill_t), intent(in) :: hill
      type(text_t), intent(inout) :: text

      if (hill%grows_too_much) return
      call text%add(' OF A TURN: ERROR OF ITS MATRIX'//general(hill%error)//', OF ITS DETERMINANT AGAINST EXP(-INTEGRAL C1)'// &
                    general(hill%determinant_error)//', '//to_text(hill%steps)//' STEPS')
   end subroutine list_accuracy

   !> Lower end of the first stable gap that is wider, in frequency/speed.
   function gap_text(b, width) result(text)
      type(boundaries_t), intent(in) :: b
      real(wp), intent(in) :: width
      character(:), allocatable :: text
      integer :: p

      text = '           NONE'
      do p = 0, ubound(b%low, 1) - 1
         if (b%low(p + 1) <= 0.0_wp) cycle
         if (root_of(b%low(p + 1)) - max(root_of(b%high(p)), 0.0_wp) <= width) cycle
         text = general(max(root_of(b%high(p)), 0.0_wp))
         return
      end do
   end function gap_text

   !> Root with the sign, as the thesis's chart has it.
   pure real(wp) function root_of(square)
      real(wp), intent(in) :: square

      root_of = sign(sqrt(abs(square)), square)
   end function root_of

   !> Is the response what the machine does?
   pure function stability_words(hill) result(words)
      type(hill_t), intent(in) :: hill
      character(:), allocatable :: words

      if (hill%grows_too_much) then
         words = 'UNSTABLE: IT GROWS TOO MUCH IN A TURN TO BE FOLLOWED'
      else if (.not. hill%unique) then
         words = 'NO UNIQUE PERIODIC SOLUTION: A MULTIPLIER IS 1'
      else if (hill%stable) then
         words = 'STABLE'
      else if (hill%neutral) then
         words = 'NEITHER GROWS NOR DIES: WITHOUT DAMPING NO STEADY STATE IS REACHED'
      else
         words = 'UNSTABLE: THE PERIODIC SOLUTION IS NOT THE RESPONSE'
      end if
      if (.not. hill%converged .and. .not. hill%grows_too_much) words = words//' (NOT CONVERGED)'
   end function stability_words

   pure function multiplier(value) result(text)
      complex(wp), intent(in) :: value
      character(:), allocatable :: text

      text = general(real(value, wp))//general(aimag(value))
   end function multiplier

   pure function amplitude_text(known, stable, amplitude) result(text)
      logical, intent(in) :: known, stable
      real(wp), intent(in) :: amplitude
      character(:), allocatable :: text

      text = '           NONE'
      if (known) text = general(amplitude)
      if (.not. stable) text = text//'   NOT STABLE'
   end function amplitude_text

   !> Tables boundaries, multipliers, harmonics, response, speeds, chart.
   subroutine put_vibration(study, tables)
      type(vibration_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer, allocatable :: unique(:)
      integer :: j, p, k, n

      table = table_of('boundaries', 'a row for each boundary of stability of a mode')
      associate (modes => study%modes)
         call add_boundaries('mode', [(real(j, wp), j=1, size(modes))], modes%exact, .true., table)
         call add_range('omega2', [((modes(j)%exact%low(p), p=0, ubound(modes(j)%exact%low, 1)), j=1, size(modes))], &
                        [((modes(j)%exact%high(p), p=0, ubound(modes(j)%exact%low, 1)), j=1, size(modes))], table)
         call tables%put(table)
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
      call put_response('response', 'm', study%modes(1)%hill, study%cycle%length, study%cycle%sense, 1, tables)
      if (size(study%speeds) > 0) then
         associate (rows => study%speeds)
            call put_speeds('speeds', 'm', rows%speed, rows%amplitude, rows%known, rows%stable, tables)
         end associate
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

   !> Input in degrees from the reference position; derivatives by it, per radian.
   pure subroutine put_response(block, unit, hill, factor, sense, waves, tables)
      character(*), intent(in) :: block
      character(*), intent(in) :: unit         !! of y
      type(hill_t), intent(in) :: hill
      real(wp), intent(in) :: factor           !! y in this unit
      real(wp), intent(in) :: sense            !! 1 or -1
      integer, intent(in) :: waves             !! periods in a turn: y stands for that many times the deflection
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      real(wp), allocatable :: y(:, :)
      character(:), allocatable :: per
      real(wp) :: many

      allocate (y(0, 0:2))
      many = real(waves, wp)
      if (hill%unique) then
         deallocate (y)
         allocate (y(size(hill%y), 0:2))
         y(:, 0) = factor*(hill%y/many)
         y(:, 1) = factor*(sense*hill%y1)
         y(:, 2) = factor*(hill%y2*many)
      end if
      table = table_of(block, 'a row for each input of a period: the steady response and its derivatives')
      call table%add('input', steps_of_turn(size(y, 1), sense, waves), 'deg')
      per = unit
      if (len(unit) == 0) per = '1'
      call table%add('y', y(:, 0), unit)
      call table%add('y1', y(:, 1), per//'/rad')
      call table%add('y2', y(:, 2), per//'/rad^2')
      call tables%put(table)
   end subroutine put_response

   !> Equal steps of a period of the turn from the reference position, degrees.
   pure function steps_of_turn(steps, sense, waves) result(input)
      integer, intent(in) :: steps, waves
      real(wp), intent(in) :: sense
      real(wp) :: input(steps)
      integer :: i

      input = [(sense*full_turn*real(i - 1, wp)/real(waves*steps, wp), i=1, steps)]
   end function steps_of_turn

   ! ---- estimates ---------------------------------------------------------------------------------------------------

   !> The group ESTIM: a paragraph for each link, its verdict first.
   subroutine list_estimates(set, estimates, text)
      type(data_set_t), intent(in) :: set
      type(estimate_t), intent(in) :: estimates(:)
      type(text_t), intent(inout) :: text
      type(estimate_group_t) :: group
      integer :: k, n

      group = estimates_of(set)
      call text%add()
      call text%add(' ESTIMATES OF LINK VIBRATION: SI UNITS')
      do k = 1, size(estimates)
         associate (e => estimates(k), beam => group%beams(k))
            call text%add()
            call text%add(' LINK '//link_words(set, beam%link, ' IN LOOP ', 'OF ARC ')//': '//verdict(e%verdict))
            call text%add('   LENGTH, SLENDERNESS'//general(e%cycle%length)//general(e%slenderness))
            call text%add('   FIRST FREQUENCY/SPEED'//general(e%ratio)//', FALL BY SHEAR AND ROTARY INERTIA'// &
                          general(e%shear_fall)//', ON POSTS OF ITS OWN SECTION'//general(e%post_ratio))
            if (e%slenderness < stubby) call text%add('   A STUBBY LINK: BENDING ALONE DOES NOT TELL WHAT IT DOES')
            call text%add('   GREATEST END LOAD, EULER''S LOAD'//general(e%push)//general(e%euler))
            if (e%buckles) then
               call text%add('   THE END LOAD EXCEEDS EULER''S LOAD: THE LINK BUCKLES')
            else
               call text%add('   QUASI-STATIC DEFLECTION'//general(e%deflection)//' AT'//general(e%at)// &
                             ' OF THE LENGTH, IN MODE 1'//general(e%first)//', IN MODE 2'//general(e%second))
               if (e%loaded) call text%add('   UNDER WEIGHT, LOADS AND SPRINGS WITH THE MACHINE AT REST'//general(e%resting))
               call text%add('   DYNAMIC ERROR OF ALL HARMONICS'//general(e%error)//', OF HARMONIC '// &
                             to_text(e%harmonic)//' NEAREST RESONANCE'//general(e%resonant)// &
                             ' (IMPULSES ONCE A TURN MAGNIFY BY'//general(e%magnifier)//')')
               call text%add('   BOTH TOGETHER'//general(e%deflection + e%error))
               call text%add('   ITS PINS COME NEARER BY'//general(e%shortened)//'; TURNING STRAIGHTENS IT BY THE PART'// &
                             general(e%straightened))
            end if
            call text%add('   HAINES''S RULES FOR A LINK THAT IS RIGID ENOUGH           IS   RULE')
            do n = 1, size(rules)
               if (.not. e%measured(n)) cycle
               call text%add('     '//rules(n)%name//general(e%measures(n))//'   '//rules(n)%words// &
                             trim(merge('  KEPT  ', '  BROKEN', e%kept(n))))
            end do
            call text%add('   ACCELERATION OF THE MIDDLE'//general(e%middle)//', IN THAT HARMONIC'//general(e%amplitude)// &
                          ', ITS BOUND'//general(e%bound))
            if (e%strength > 0.0_wp) call text%add('   LEAST FREQUENCY/SPEED THAT STRENGTH ALLOWS'//general(e%strength)// &
                                                   ', OF A TIE ROD'//general(e%tie_rod))
            call text%add('   HARMONICS OF THAT ACCELERATION, AND THEIR BOUNDS FROM RANGE AND VARIATION')
            do n = 1, harmonics_estimated
               call text%add(repeat(' ', 6 - len(to_text(n)))//to_text(n)//general(e%amplitudes(n))//general(e%bounds(n)))
            end do
         end associate
      end do
   end subroutine list_estimates

   pure function verdict(number) result(words)
      integer, intent(in) :: number
      character(:), allocatable :: words

      select case (number)
      case (verdict_rigid)
         words = 'RIGID ENOUGH'
      case (verdict_closer)
         words = 'LOOK CLOSER (&VIBR)'
      case default
         words = 'REDESIGN'
      end select
   end function verdict

   ! ---- drives and tables -------------------------------------------------------------------------------------------

   !> The group DRIVEL.
   subroutine list_drive(set, study, text)
      type(data_set_t), intent(in) :: set
      type(drive_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(drive_group_t) :: drive
      character(:), allocatable :: line
      integer :: n, k

      drive = drive_of(set)
      call text%add()
      call text%add(' FLEXIBLE DRIVE: SI UNITS, SPEEDS IN RAD/S')
      if (.not. drive%offsets) call text%add(' OFFSETS OF THE CENTRES OF MASS DROPPED (DOFFS=0)')
      if (study%massless) then
         call text%add(' NO INERTIA AT THE CRANK SOMEWHERE: GIVE &MASSES OR DEXTRA')
         return
      else if (.not. study%found) then
         call text%add(' NO STIFFNESS GIVES THE MEAN RATIO'//general(drive%ratio)//': D**2 + J''''/(2 J0) WOULD BE NEGATIVE')
         return
      end if
      call list_inertia(' ', study%of_crank)
      if (study%with_offsets%mean > 0.0_wp) call list_inertia(' WITH THE OFFSETS: ', study%with_offsets)
      call text%add(' STIFFNESS'//general(study%stiffness)//'  D'//general(study%d)//'  C'//general(drive%damping))
      if (study%ratio_real) then
         call text%add(' MEAN RATIO OF THE FREQUENCY TO THE SPEED'//general(study%ratio)// &
                       ' (RESONANCE AT WHOLE NUMBERS, BANDS OF'// &
                       ' INSTABILITY AT WHOLE AND HALF ONES)')
         call text%add(' LEAST RATIO OF THE TURN'//general(study%least)//', OF A DRIVE RIGID ENOUGH BY HAINES''S RULE AT LEAST '// &
                       to_text(nint(least_drive_ratio))//trim(merge('  KEPT  ', '  BROKEN', study%least >= least_drive_ratio)))
      else
         call text%add(' THE RATIO OF THE FREQUENCY TO THE SPEED IS NOT REAL ALL OVER THE TURN: IT SAYS NOTHING')
      end if
      if (study%loaded) then
         call text%add(' TORQUE OF WEIGHT, LOADS AND SPRINGS ON THE CRANK, IN THE SENSE OF ITS TURNING: FROM'// &
                       general(minval(study%torque))//' TO'//general(maxval(study%torque))//', MEAN'// &
                       general(sum(study%torque)/real(size(study%torque), wp)))
         if (any(abs(study%viscous) > 0.0_wp)) call text%add(' TORQUE OF DAMPERS AGAINST IT AT 1 RAD/S: FROM'// &
                                                             general(minval(study%viscous))//' TO'//general(maxval(study%viscous)))
      end if
      call text%add(' '//stability_words(study%hill))
      call text%add(' MULTIPLIERS'//multiplier(study%hill%multipliers(1))//multiplier(study%hill%multipliers(2))// &
                    trim(merge(' (OF HALF A TURN)', '                 ', drive%ripple > 0.0_wp)))
      call list_accuracy(study%hill, text)
      if (study%hill%unique) then
         call text%add(' HARMONICS OF THE CRANK''S SWING, RAD, AND OF ITS ACCELERATION/SPEED**2 (*: IT MATTERS FOR THE OUTPUTS)'// &
                       trim(merge('; OF THE OUTPUT''S, AND OF THAT WITH A RIGID DRIVE', repeat(' ', 49), &
                                  size(study%output, 2) > 0)))
         do n = 0, drive%harmonics
            line = repeat(' ', 6 - len(to_text(n)))//to_text(n)//general(study%swing(n))//general(study%acceleration(n))// &
                   merge(' *', '  ', matters(n, study%acceleration(n)))
            do k = 1, size(study%output, 2)
               line = line//general(study%output(n, k))//general(study%rigid(n, k))
            end do
            call text%add(trim(line))
         end do
         call text%add(' GREATEST SWING'//general(study%greatest))
         if (study%greatest > small_swing) call text%add(' THE EQUATION IS LINEAR IN THE SWING: ABOVE 0.1 RAD IT IS ROUGH')
      end if
      if (size(study%speeds) == 0) return
      call text%add(' OVER SPEEDS:             RAD/S            RPM          SWING')
      do k = 1, size(study%speeds)
         associate (row => study%speeds(k))
            call text%add(repeat(' ', 18)//general(row%speed)//general(row%speed*rpm_per_speed)// &
                          amplitude_text(row%known, row%stable .or. .not. row%grows, row%amplitude))
         end associate
      end do

   contains

      subroutine list_inertia(head, of)
         character(*), intent(in) :: head
         type(inertia_t), intent(in) :: of

         call text%add(head//'MEAN INERTIA AT THE CRANK'//general(of%mean)//', HALF ITS RANGE OVER THE MEAN'// &
                       general(of%half_range)//', GREATEST SLOPE/(2 MEAN)'//general(of%steepest))
      end subroutine list_inertia
   end subroutine list_drive

   !> Tables drive_inertia, drive_torque, drive_response, drive_speeds.
   pure subroutine put_drive(study, tables)
      type(drive_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of('drive_inertia', 'a row for each input of a period: the inertia that the crank feels')
      call table%add('input', steps_of_turn(size(study%inertia), study%turn%sense, study%waves), 'deg')
      call table%add('inertia', study%inertia, 'kg m^2')
      call tables%put(table)
      if (study%loaded) then
         table = table_of('drive_torque', 'a row for each input: the torque of weight, loads and springs, and that of '// &
                          'dampers at 1 rad/s')
         call table%add('input', steps_of_turn(size(study%torque), study%turn%sense, 1), 'deg')
         call table%add('torque', study%torque, 'N m')
         call table%add('viscous', study%viscous, 'N m s')
         call tables%put(table)
      end if
      if (.not. study%found) return
      call put_response('drive_response', 'rad', study%hill, 1.0_wp, study%turn%sense, study%waves, tables)
      if (size(study%speeds) == 0) return
      associate (rows => study%speeds)
         call put_speeds('drive_speeds', 'rad', rows%speed, rows%amplitude, rows%known, rows%stable, tables)
      end associate
   end subroutine put_drive

   !> Tables estimates and estimate_harmonics, for other programs.
   subroutine put_estimates(set, estimates, tables)
      type(data_set_t), intent(in) :: set
      type(estimate_t), intent(in) :: estimates(:)
      type(tables_t), intent(inout) :: tables
      type(estimate_group_t) :: group
      type(table_t) :: table
      character(name_room), allocatable :: links(:), verdicts(:)
      integer :: k, n

      group = estimates_of(set)
      table = table_of('estimates', 'a row for each link', audience=for_programs)
      associate (bent => .not. estimates%buckles)
         allocate (links(size(estimates)), verdicts(size(estimates)))
         do k = 1, size(estimates)
            links(k) = link_words(set, group%beams(k)%link, ' in loop ', 'arc ')
            verdicts(k) = lower_case(verdict(estimates(k)%verdict))
         end do
         call table%add('link', links)
         call table%add('verdict', verdicts)
         call table%add('length', [(estimates(k)%cycle%length, k=1, size(estimates))], 'm')
         call table%add('slenderness', estimates%slenderness)
         call table%add('frequency_per_speed', estimates%ratio)
         call table%add('fall_by_shear', estimates%shear_fall)
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
         call table%add('acceleration', estimates%middle, 'm/s^2')
         call table%add('least_frequency_per_speed', estimates%strength, known=estimates%strength > 0.0_wp)
      end associate
      call tables%put(table)
      table = table_of('estimate_harmonics', 'a row for each link and harmonic of the acceleration of its middle', &
                       audience=for_programs)
      call table%add('link', [((k, n=1, harmonics_estimated), k=1, size(estimates))])
      call table%add('n', [((n, n=1, harmonics_estimated), k=1, size(estimates))])
      call table%add('amplitude', [(estimates(k)%amplitudes, k=1, size(estimates))], 'm/s^2')
      call table%add('bound', [(estimates(k)%bounds, k=1, size(estimates))], 'm/s^2')
      call tables%put(table)
   end subroutine put_estimates

   !> The group HILL.
   subroutine list_hill(set, study, text)
      type(data_set_t), intent(in) :: set
      type(hill_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(hill_group_t) :: hill
      integer :: n

      hill = hill_of(set)
      call text%add()
      call text%add(' HILL''S EQUATION Y'''' + C1 Y'' + C0 Y = P FROM TABLES OF '//to_text(size(hill%c0))//' VALUES')
      call text%add(' '//stability_words(study%hill))
      call text%add(' MULTIPLIERS'//multiplier(study%hill%multipliers(1))//multiplier(study%hill%multipliers(2)))
      call text%add(' PERIOD: FREE      '//general(study%hill%transfer(1, 1))//general(study%hill%transfer(1, 2)))
      call text%add('                   '//general(study%hill%transfer(2, 1))//general(study%hill%transfer(2, 2)))
      call text%add('         FROM REST '//general(study%hill%forced(1))//general(study%hill%forced(2)))
      call list_accuracy(study%hill, text)
      if (.not. study%hill%unique) return
      call text%add(' STEADY STATE AT 0'//general(study%hill%start(1))//general(study%hill%start(2))//', GREATEST'// &
                    general(study%greatest))
      do n = 0, hill%harmonics
         call text%add(repeat(' ', 6 - len(to_text(n)))//to_text(n)//general(study%amplitude(n)))
      end do
   end subroutine list_hill

   !> Tables hill_multipliers, hill_harmonics, hill_response.
   pure subroutine put_hill(study, tables)
      type(hill_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: k

      table = table_of('hill_multipliers', 'a row for each multiplier')
      call add_complex(study%hill%multipliers, table)
      call tables%put(table)
      table = table_of('hill_harmonics', 'a row for each harmonic of the steady response')
      call table%add('n', [(k, k=0, ubound(study%amplitude, 1))])
      call table%add('amplitude', study%amplitude, known=spread(study%hill%unique, 1, size(study%amplitude)))
      call tables%put(table)
      call put_response('hill_response', '', study%hill, 1.0_wp, 1.0_wp, 1, tables)
   end subroutine put_hill

   !> What a link is called: its arc and loop, of a sketch its name.
   pure function link_words(set, place, loop, arc) result(words)
      type(data_set_t), intent(in) :: set
      type(place_t), intent(in) :: place
      character(*), intent(in) :: loop, arc     !! the words before these numbers
      character(:), allocatable :: words

      words = arc//to_text(place%arc)//loop//to_text(place%loop)
      if (place%link > 0) words = trim(set%sketch%links(place%link)%name)
   end function link_words
end module psalm_vibration_list
