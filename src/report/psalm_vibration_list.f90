!> Vibration of links, flexible drives and Hill's equation in the listing.
module psalm_vibration_list
   use psalm_data_set, only: data_set_t
   use psalm_drive_group, only: hill_group_t, hill_of, drive_group_t, drive_of
   use psalm_drive_study, only: drive_study_t, hill_study_t, inertia_t, matters, least_drive_ratio, small_swing
   use psalm_estimate_study, only: estimate_t, verdict_rigid, verdict_closer, harmonics_estimated, stubby, rules
   use psalm_hill, only: hill_t
   use psalm_kinds, only: wp, pi
   use psalm_place, only: place_t
   use psalm_stability, only: boundaries_t
   use psalm_text, only: text_t, general, to_text
   use psalm_vibration_group, only: estimate_group_t, estimates_of, vibration_group_t, vibration_of
   use psalm_vibration_study, only: vibration_study_t, mode_t, harmonics_listed
   implicit none (type, external)
   private
   public :: list_vibration, list_estimates, list_drive, list_hill, stability_words, link_words, verdict_words, &
             first_good, unstable_speeds, root_of

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
         associate (rows => study%speeds)
            call list_speeds(rows%speed, rows%amplitude, rows%known, rows%stable .or. .not. rows%grows, text)
         end associate
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

      function speeds_of(p) result(line)
         integer, intent(in) :: p
         character(:), allocatable :: line
         real(wp) :: speeds(2)

         speeds = unstable_speeds(study, set%rates%speed, j, p)
         line = '           NONE'
         if (speeds(1) >= huge(1.0_wp)) return
         line = general(speeds(1))
         if (speeds(2) >= huge(1.0_wp)) then
            line = line//'            ALL'
         else
            line = line//general(speeds(2))
         end if
      end function speeds_of
   end subroutine list_vibration

   !> Speeds between two boundaries of a mode, of the link as it is, at which it grows. Below a boundary of p = 0 lie the speeds
   !> above it.
   pure function unstable_speeds(study, speed, mode, p) result(speeds)
      type(vibration_study_t), intent(in) :: study
      real(wp), intent(in) :: speed          !! of RATES
      integer, intent(in) :: mode, p
      real(wp) :: speeds(2)                  !! from and to, rad/s; huge: there are none, or all above the first
      real(wp) :: base

      base = speed**2*study%ratio**2 ! squared first frequency of the link at rest
      speeds = huge(1.0_wp)
      associate (low => study%modes(mode)%exact%low(p), high => study%modes(mode)%exact%high(p))
         if (high <= 0.0_wp) return
         speeds(1) = sqrt(base/high)
         if (p > 0 .and. low > 0.0_wp) speeds(2) = sqrt(base/low)
      end associate
   end function unstable_speeds

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

   !> A row for each speed: rad/s, revolutions per minute, amplitude. All arguments have the shape (speeds).
   subroutine list_speeds(speed, amplitude, known, settles, text)
      real(wp), intent(in) :: speed(:), amplitude(:)
      logical, intent(in) :: known(:), settles(:)
      type(text_t), intent(inout) :: text
      integer :: k

      do k = 1, size(speed)
         call text%add(repeat(' ', 18)//general(speed(k))//general(speed(k)*rpm_per_speed)// &
                       amplitude_text(known(k), settles(k), amplitude(k)))
      end do
   end subroutine list_speeds

   !> Root with the sign, as the thesis's chart has it.
   elemental real(wp) function root_of(square)
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
            call text%add(' LINK '//link_words(set, beam%link, ' IN LOOP ', 'OF ARC ')//': '//verdict_words(e%verdict))
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

   pure function verdict_words(number) result(words)
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
   end function verdict_words

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
      associate (rows => study%speeds)
         call list_speeds(rows%speed, rows%amplitude, rows%known, rows%stable .or. .not. rows%grows, text)
      end associate

   contains

      subroutine list_inertia(head, of)
         character(*), intent(in) :: head
         type(inertia_t), intent(in) :: of

         call text%add(head//'MEAN INERTIA AT THE CRANK'//general(of%mean)//', HALF ITS RANGE OVER THE MEAN'// &
                       general(of%half_range)//', GREATEST SLOPE/(2 MEAN)'//general(of%steepest))
      end subroutine list_inertia
   end subroutine list_drive

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
