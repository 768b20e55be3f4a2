!> Vibration of links, flexible drives and Hill's equation in the listing.
module psalm_vibration_list
   use psalm_columns, only: right_column
   use psalm_coupled_hill, only: coupled_t, fastest
   use psalm_data_set, only: data_set_t
   use psalm_drive_group, only: hill_group_t, hill_of, drive_group_t, drive_of
   use psalm_drive_study, only: drive_study_t, hill_study_t, inertia_t, matters, least_drive_ratio, small_swing
   use psalm_estimate_study, only: estimate_t, verdict_rigid, verdict_closer, harmonics_estimated, stubby, rules
   use psalm_hill, only: hill_t, most_damping
   use psalm_kinds, only: wp, pi
   use psalm_number_format, only: error_words, figure, figures_of, format_of, in_a_row, in_sentence, number_format_t
   use psalm_place, only: place_t
   use psalm_stability, only: boundaries_t
   use psalm_text, only: text_t, to_text
   use psalm_vibration_group, only: estimate_group_t, estimates_of, vibration_group_t, vibration_of
   use psalm_vibration_study, only: vibration_study_t, chart_row_t, mode_t
   implicit none (type, external)
   private
   public :: list_vibration, list_estimates, list_drive, list_hill, stability_words, coupled_words, link_words, verdict_words, &
             list_harmonics, first_good, unstable_speeds, root_of

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
      type(number_format_t) :: of_speed
      character(15), allocatable :: columns(:, :), band(:, :), chart(:, :)
      logical :: named
      integer :: j, p, k

      vibration = vibration_of(set)
      named = set%has_names()
      call text%add()
      call text%add(' VIBRATION OF THE LINK '//link_words(set, vibration%beam%link, ' IN LOOP ', 'OF ARC ')// &
                    ': SI UNITS, SPEEDS IN RAD/S')
      call text%add(' LENGTH'//in_sentence(named, study%cycle%length)//'  MASS'//in_sentence(named, study%cycle%mass))
      call text%add(' FIRST FREQUENCY AT REST'//in_sentence(named, study%frequency)//', RATIO TO THE SPEED'// &
                    in_sentence(named, study%ratio))
      do j = 1, size(study%modes)
         associate (mode => study%modes(j))
            call text%add()
            call text%add(' MODE '//to_text(j)//': '//stability_words(mode%hill))
            if (mode%least_stiffness < 0.0_wp) then
               call text%add(' BUCKLED FOR A PART OF THE TURN: THE END LOAD EXCEEDS EULER''S LOAD, MOST AT INPUT'// &
                             in_sentence(named, mode%least_at)//' AFTER THE REFERENCE')
            end if
            call text%add(' BOUNDARIES OF STABILITY, SQUARED RATIO OF THE FIRST FREQUENCY TO THE SPEED (ERROR'// &
                          error_words(named, mode%exact%error)//')')
            call text%add('     P          EXACT FROM             TO    BY (13.27) FROM             TO    BY (13.28) FROM'// &
                          '             TO   UNSTABLE SPEEDS FROM         TO')
            columns = boundary_columns(named, mode)
            of_speed = format_of(named, [(unstable_speeds(study, j, p), p=0, ubound(mode%exact%low, 1))])
            do p = 0, ubound(mode%exact%low, 1)
               call text%add(right_column(p, 6)//'     '//in_a_row(columns(:2, p + 1))//'     '// &
                             in_a_row(columns(3:4, p + 1))//'     '//in_a_row(columns(5:, p + 1))//'      '//speeds_of(p))
            end do
            p = first_good(mode)
            if (p <= ubound(mode%exact%low, 1)) then
               call text%add(' THESE ARE SERIES FOR SMALL COEFFICIENTS: (13.28) IS WITHIN 1 PER CENT FROM P = '//to_text(p)//' ON')
            else
               call text%add(' THESE ARE SERIES FOR SMALL COEFFICIENTS: (13.28) IS WITHIN 1 PER CENT AT NONE OF THE LAST P')
            end if
            call text%add(' MULTIPLIERS'//both_multipliers(named, mode%hill))
            call list_accuracy(named, mode%hill, text)
            if (mode%hill%unique) then
               call text%add(' HARMONICS OF THE DEFLECTION'//trim(merge('                       ', ' (NOT THE STEADY STATE)', &
                                                                        mode%hill%stable .or. mode%hill%neutral)))
               call list_harmonics(named, mode%amplitude, text)
               call text%add(' GREATEST'//in_sentence(named, mode%greatest))
            end if
         end associate
      end do
      if (study%mixing > 0.0_wp) then
         call text%add()
         call text%add(' EACH MODE IS TAKEN BY ITSELF; LOADS AND SPRINGS ON THE LINK COUPLE THEM BY'// &
                       in_sentence(named, study%mixing)// &
                       ' OF THEIR STIFFNESS')
      end if
      if (size(study%modes) > 1) then
         call text%add()
         call text%add(' ALL MODES TOGETHER: '//trim(merge('STABLE    ', 'NOT STABLE', study%stable)))
         do k = 1, size(study%multipliers)
            call text%add('   MULTIPLIER'//multiplier(named, study%multipliers(k), study%multiplier_error))
         end do
         call text%add(' THEIR PRODUCT AGAINST THAT OF THE DAMPING: ERROR'//error_words(named, study%determinant_error))
         if (.not. study%multipliers_found) call text%add(' THE MULTIPLIERS ARE NOT ACCURATE: TOO MUCH GROWTH IN A TURN')
      end if
      if (allocated(study%stresses)) call list_stresses(set, study, text)
      if (size(study%speeds) > 0) then
         call text%add()
         call text%add(' MODE 1 OVER SPEEDS:      RAD/S            RPM     DEFLECTION')
         associate (rows => study%speeds)
            call list_speeds(named, rows%speed, rows%amplitude, rows%known, rows%stable .or. .not. rows%grows, text)
         end associate
         call text%add(' LARGEST ERROR OF A DETERMINANT'//error_words(named, maxval(study%speeds%determinant_error)))
         call text%add()
         if (.not. study%bands_known) then
            call text%add(' STOPPED BY REQUEST BEFORE IT WAS KNOWN WHERE MODE 1 GROWS')
         else if (size(study%bands) == 0) then
            call text%add(' MODE 1 GROWS AT NONE OF THESE SPEEDS')
         else
            call text%add(' MODE 1 GROWS AT SPEEDS FROM           TO   (RPM        FROM             TO)')
            allocate (band(4, size(study%bands)))
            band(1, :) = figures_of(named, study%bands%from)
            band(2, :) = figures_of(named, study%bands%to)
            band(3, :) = figures_of(named, study%bands%from*rpm_per_speed)
            band(4, :) = figures_of(named, study%bands%to*rpm_per_speed)
            do k = 1, size(study%bands)
               call text%add(repeat(' ', 14)//in_a_row(band(:2, k))//'     '//in_a_row(band(3:, k)))
            end do
         end if
      end if
      if (size(study%chart) > 0) then
         call text%add()
         call text%add(' CHART OF STABILITY: FREQUENCY/SPEED FROM WHICH MODE 1 IS STABLE, IN A GAP WIDER THAN 0.1, THAN 0.25')
         call text%add(' (DEVICE 9 HAS ALL BOUNDARIES); BESIDE IT THE RULE OF THUMB (14.15), 1.4 + 0.85 E')
         call text%add('              E            0.1           0.25        (14.15)')
         chart = chart_columns(named, study%chart)
         do k = 1, size(study%chart)
            call text%add(in_a_row(chart(k, :)))
         end do
      end if

   contains

      function speeds_of(p) result(line)
         integer, intent(in) :: p
         character(:), allocatable :: line
         real(wp) :: speeds(2)

         speeds = unstable_speeds(study, j, p)
         line = '           NONE'
         if (speeds(1) >= huge(1.0_wp)) return
         line = figure(speeds(1), of_speed)
         if (speeds(2) >= huge(1.0_wp)) then
            line = line//'            ALL'
         else
            line = line//figure(speeds(2), of_speed)
         end if
      end function speeds_of
   end subroutine list_vibration

   !> The greatest stresses, and the strain against its limit.
   subroutine list_stresses(set, study, text)
      type(data_set_t), intent(in) :: set
      type(vibration_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(vibration_group_t) :: vibration
      character(*), parameter :: names(3) = [character(32) :: ' BENDING', ' ALONG THE LINK', ' BOTH TOGETHER']
      character(15) :: columns(3, 3)
      logical :: named
      integer :: k

      vibration = vibration_of(set)
      named = set%has_names()
      call text%add()
      call text%add(' STRESSES, PA: GREATEST OVER THE TURN AND ALONG THE LINK, BENDING OF '//to_text(size(study%modes))//' MODES')
      associate (of => study%stresses)
         if (.not. of%known) then
            call text%add(' NOT KNOWN: A MODE HAS NO STEADY STATE')
            return
         end if
         call text%add('                                        STRESS   AT INPUT FROM    AT PART OF')
         call text%add('                                              THE REFERENCE    THE LENGTH')
         columns(:, 1) = figures_of(named, [of%bending(of%worst(1)), of%along(of%worst(2)), of%both(of%worst(3))])
         columns(:, 2) = figures_of(named, of%at)
         columns(:, 3) = figures_of(named, of%where)
         do k = 1, size(names)
            call text%add(names(k)//in_a_row(columns(k, :)))
         end do
         if (vibration%beam%strain > 0.0_wp) call text%add(' STRAIN'// &
            in_sentence(named, of%both(of%worst(3))/vibration%beam%modulus)//', THE MATERIAL BEARS'// &
            in_sentence(named, vibration%beam%strain))
      end associate
   end subroutine list_stresses

   !> Speeds between two boundaries of a mode, of the link as it is, at which it grows. Below a boundary of p = 0 lie the speeds
   !> above it.
   pure function unstable_speeds(study, mode, p) result(speeds)
      type(vibration_study_t), intent(in) :: study
      integer, intent(in) :: mode, p
      real(wp) :: speeds(2)                  !! from and to, rad/s; huge: there are none, or all above the first
      real(wp) :: base

      base = study%cycle%crank%speed**2*study%ratio**2 ! squared first frequency of the link at rest
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
   subroutine list_accuracy(named, hill, text)
      logical, intent(in) :: named
      type(hill_t), intent(in) :: hill
      type(text_t), intent(inout) :: text

      if (hill%grows_too_much) return
      call text%add(' OF A TURN: ERROR OF ITS MATRIX'//error_words(named, hill%error)// &
                    ', OF ITS DETERMINANT AGAINST EXP(-INTEGRAL C1)'// &
                    error_words(named, hill%determinant_error)//', '//to_text(hill%steps)//' STEPS')
   end subroutine list_accuracy

   !> Boundaries of a mode as columns: exact, by the series of first and of second order, from and to each; shape (6, boundaries).
   pure function boundary_columns(named, mode) result(columns)
      logical, intent(in) :: named
      type(mode_t), intent(in) :: mode
      character(15) :: columns(6, size(mode%exact%low))

      columns(1, :) = figures_of(named, mode%exact%low, error=mode%exact%error)
      columns(2, :) = figures_of(named, mode%exact%high, error=mode%exact%error)
      columns(3, :) = figures_of(named, mode%first(1, :))
      columns(4, :) = figures_of(named, mode%first(2, :))
      columns(5, :) = figures_of(named, mode%second(1, :))
      columns(6, :) = figures_of(named, mode%second(2, :))
   end function boundary_columns

   !> The chart of stability as columns: E, lower ends of the first gaps wider than 0.1 and 0.25, rule of thumb; shape (rows, 4).
   pure function chart_columns(named, chart) result(columns)
      logical, intent(in) :: named
      type(chart_row_t), intent(in) :: chart(:)
      character(15) :: columns(size(chart), 4)
      real(wp), parameter :: widths(2) = [0.1_wp, 0.25_wp]
      real(wp) :: ends(size(chart))
      integer :: k, w

      columns(:, 1) = figures_of(named, chart%e)
      do w = 1, size(widths)
         do k = 1, size(chart)
            ends(k) = gap_end(chart(k)%exact, widths(w))
         end do
         columns(:, 1 + w) = figures_of(named, ends, ends < huge(1.0_wp))
         where (.not. ends < huge(1.0_wp)) columns(:, 1 + w) = '           NONE'
      end do
      columns(:, 4) = figures_of(named, 1.4_wp + 0.85_wp*chart%e)
   end function chart_columns

   !> Lower end of the first stable gap that is wider, in frequency/speed; huge: there is none.
   pure real(wp) function gap_end(b, width)
      type(boundaries_t), intent(in) :: b
      real(wp), intent(in) :: width
      integer :: p

      do p = 0, ubound(b%low, 1) - 1
         if (b%low(p + 1) <= 0.0_wp) cycle
         gap_end = max(root_of(b%high(p)), 0.0_wp)
         if (root_of(b%low(p + 1)) - gap_end > width) return
      end do
      gap_end = huge(1.0_wp)
   end function gap_end

   !> Columns of harmonics, each a row; shape (columns, harmonics).
   pure function harmonic_columns(named, values) result(columns)
      logical, intent(in) :: named
      real(wp), intent(in) :: values(:, :)     !! shape (harmonics, columns)
      character(15) :: columns(size(values, 2), size(values, 1))
      integer :: c

      do c = 1, size(values, 2)
         columns(c, :) = figures_of(named, values(:, c), all_count=.true.)
      end do
   end function harmonic_columns

   !> A row for each harmonic from 0.
   subroutine list_harmonics(named, amplitude, text)
      logical, intent(in) :: named
      real(wp), intent(in) :: amplitude(0:)
      type(text_t), intent(inout) :: text
      character(15) :: columns(0:ubound(amplitude, 1))
      integer :: n

      columns = figures_of(named, amplitude, all_count=.true.)
      do n = 0, ubound(amplitude, 1)
         call text%add(right_column(n, 6)//columns(n))
      end do
   end subroutine list_harmonics

   !> A row for each speed: rad/s, revolutions per minute, amplitude. All arguments have the shape (speeds).
   subroutine list_speeds(named, speed, amplitude, known, settles, text)
      logical, intent(in) :: named
      real(wp), intent(in) :: speed(:), amplitude(:)
      logical, intent(in) :: known(:), settles(:)
      type(text_t), intent(inout) :: text
      character(15) :: columns(size(speed), 3)
      integer :: k

      columns(:, 1) = figures_of(named, speed)
      columns(:, 2) = figures_of(named, speed*rpm_per_speed)
      columns(:, 3) = figures_of(named, amplitude, known, all_count=.true.)
      where (.not. known) columns(:, 3) = '           NONE'
      do k = 1, size(speed)
         call text%add(repeat(' ', 18)//in_a_row(columns(k, :))//trim(merge('   NOT STABLE', '             ', .not. settles(k))))
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

      if (hill%too_stiff) then
         words = 'TOO STIFF TO BE FOLLOWED: C1 IS ABOVE '//to_text(nint(most_damping))
      else
         words = solution_words(hill%grows_too_much, hill%unique, hill%stable, hill%neutral, hill%converged)
      end if
   end function stability_words

   !> Is the periodic solution what the link, or the system, does?
   pure function coupled_words(coupled) result(words)
      type(coupled_t), intent(in) :: coupled
      character(:), allocatable :: words

      if (coupled%too_fast) then
         words = 'TOO STIFF TO BE FOLLOWED: MORE THAN '//to_text(nint(fastest))//' WAVES IN A TURN, OR TOO STRONG A DAMPING '// &
                 'OR COUPLING'
      else
         words = solution_words(coupled%grows_too_much, coupled%unique, coupled%stable, coupled%neutral, coupled%converged)
      end if
   end function coupled_words

   !> The same of any number of equations that were followed, or grow too much.
   pure function solution_words(grows_too_much, unique, stable, neutral, converged) result(words)
      logical, intent(in) :: grows_too_much, unique, stable, neutral, converged !! as of `hill_t` and `coupled_t`
      character(:), allocatable :: words

      if (grows_too_much) then
         words = 'UNSTABLE: IT GROWS TOO MUCH IN A TURN TO BE FOLLOWED'
         return
      else if (.not. unique .and. converged .and. .not. (stable .or. neutral)) then
         ! a multiplier is 1, or its difference from 1 is lost beside the largest
         words = 'UNSTABLE, AND THE PERIODIC SOLUTION IS NOT KNOWN'
      else if (.not. unique) then
         words = 'NO UNIQUE PERIODIC SOLUTION: A MULTIPLIER IS 1'
      else if (stable) then
         words = 'STABLE'
      else if (neutral) then
         words = 'NEITHER GROWS NOR DIES: WITHOUT DAMPING NO STEADY STATE IS REACHED'
      else
         words = 'UNSTABLE: THE PERIODIC SOLUTION IS NOT THE RESPONSE'
      end if
      if (.not. converged) words = words//' (NOT CONVERGED)'
   end function solution_words

   !> Both multipliers of Hill's equation.
   pure function both_multipliers(named, hill) result(text)
      logical, intent(in) :: named
      type(hill_t), intent(in) :: hill
      character(:), allocatable :: text
      real(wp) :: error

      error = hill%error*maxval(abs(hill%transfer))
      text = multiplier(named, hill%multipliers(1), error)//trim(merge(',', ' ', named))// &
             multiplier(named, hill%multipliers(2), error)
   end function both_multipliers

   !> A multiplier in a sentence: of loops its two parts, of a sketch as a complex number.
   pure function multiplier(named, value, error) result(text)
      logical, intent(in) :: named
      complex(wp), intent(in) :: value
      real(wp), intent(in) :: error            !! of the matrix that it is an eigenvalue of
      character(:), allocatable :: text

      if (named) then
         text = in_sentence(named, real(value, wp), error)//merge(' -', ' +', aimag(value) < 0.0_wp)// &
                in_sentence(named, abs(aimag(value)), error)//' I'
      else
         text = in_sentence(named, real(value, wp))//in_sentence(named, aimag(value))
      end if
   end function multiplier

   ! ---- estimates ---------------------------------------------------------------------------------------------------

   !> The group ESTIM: a paragraph for each link, its verdict first.
   subroutine list_estimates(set, estimates, text)
      type(data_set_t), intent(in) :: set
      type(estimate_t), intent(in) :: estimates(:)
      type(text_t), intent(inout) :: text
      type(estimate_group_t) :: group
      character(15) :: measures(size(rules)), columns(2, harmonics_estimated)
      logical :: named
      integer :: k, n

      group = estimates_of(set)
      named = set%has_names()
      call text%add()
      call text%add(' ESTIMATES OF LINK VIBRATION: SI UNITS')
      do k = 1, size(estimates)
         associate (e => estimates(k), beam => group%beams(k))
            call text%add()
            call text%add(' LINK '//link_words(set, beam%link, ' IN LOOP ', 'OF ARC ')//': '//verdict_words(e%verdict))
            call text%add('   LENGTH, SLENDERNESS'//in_sentence(named, e%cycle%length)//in_sentence(named, e%slenderness))
            call text%add('   FIRST FREQUENCY/SPEED'//in_sentence(named, e%ratio)//', FALL BY SHEAR AND ROTARY INERTIA'// &
                          in_sentence(named, e%shear_fall)//', ON POSTS OF ITS OWN SECTION'//in_sentence(named, e%post_ratio))
            if (e%slenderness < stubby) call text%add('   A STUBBY LINK: BENDING ALONE DOES NOT TELL WHAT IT DOES')
            call text%add('   GREATEST END LOAD, EULER''S LOAD'//in_sentence(named, e%push)//in_sentence(named, e%euler))
            if (e%buckles) then
               call text%add('   THE END LOAD EXCEEDS EULER''S LOAD: THE LINK BUCKLES')
            else
               call text%add('   QUASI-STATIC DEFLECTION'//in_sentence(named, e%deflection)//' AT'//in_sentence(named, e%at)// &
                             ' OF THE LENGTH, IN MODE 1'//in_sentence(named, e%first)//', IN MODE 2'//in_sentence(named, e%second))
               if (e%loaded) call text%add('   UNDER WEIGHT, LOADS AND SPRINGS WITH THE MACHINE AT REST'// &
                   in_sentence(named, e%resting))
               call text%add('   DYNAMIC ERROR OF ALL HARMONICS'//in_sentence(named, e%error)//', OF HARMONIC '// &
                             to_text(e%harmonic)//' NEAREST RESONANCE'//in_sentence(named, e%resonant)// &
                             ' (IMPULSES ONCE A TURN MAGNIFY BY'//in_sentence(named, e%magnifier)//')')
               call text%add('   BOTH TOGETHER'//in_sentence(named, e%deflection + e%error))
               call text%add('   ITS PINS COME NEARER BY'//in_sentence(named, e%shortened)// &
                             '; TURNING STRAIGHTENS IT BY THE PART'// &
                             in_sentence(named, e%straightened))
            end if
            call text%add('   HAINES''S RULES FOR A LINK THAT IS RIGID ENOUGH           IS   RULE')
            measures = figures_of(named, e%measures, e%measured, all_count=.true.)
            do n = 1, size(rules)
               if (.not. e%measured(n)) cycle
               call text%add('     '//rules(n)%name//measures(n)//'   '//rules(n)%words// &
                             trim(merge('  KEPT  ', '  BROKEN', e%kept(n))))
            end do
            if (e%jerk > 0.0_wp) then
               call text%add('   IMPACT ACROSS THE CLEARANCE: RELATIVE ACCELERATION GROWS BY'//in_sentence(named, e%jerk)// &
                             ' M/S3, IN'//in_sentence(named, e%impact_time)//' S TO'//in_sentence(named, e%impact_speed)//' M/S;')
               call text%add('   IN EACH HARMONIC OF THE ACCELERATION'//in_sentence(named, e%impact_level)//' M/S2')
            else if (e%clearance > 0.0_wp .and. .not. e%buckles) then
               call text%add('   IMPACT IS NOT ESTIMATED: NO PIN OF THE LINK CAN BE TAKEN APART, OR NOTHING BENDS THE LINK')
            end if
            call text%add('   ACCELERATION OF THE MIDDLE'//in_sentence(named, e%middle)//', IN THAT HARMONIC'// &
                          in_sentence(named, e%amplitude)// &
                          ', ITS BOUND'//in_sentence(named, e%bound))
            if (e%strength > 0.0_wp) call text%add('   LEAST FREQUENCY/SPEED THAT STRENGTH ALLOWS'// &
                in_sentence(named, e%strength)// &
                                                   ', OF A TIE ROD'//in_sentence(named, e%tie_rod))
            call text%add('   HARMONICS OF THAT ACCELERATION, AND THEIR BOUNDS FROM RANGE AND VARIATION')
            columns = harmonic_columns(named, reshape([e%amplitudes, e%bounds], [harmonics_estimated, 2]))
            do n = 1, harmonics_estimated
               call text%add(right_column(n, 6)//in_a_row(columns(:, n)))
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
      character(15), allocatable :: columns(:, :)
      logical :: named
      integer :: n

      drive = drive_of(set)
      named = set%has_names()
      call text%add()
      call text%add(' FLEXIBLE DRIVE: SI UNITS, SPEEDS IN RAD/S')
      if (.not. drive%offsets) call text%add(' OFFSETS OF THE CENTRES OF MASS DROPPED (DOFFS=0)')
      if (study%massless) then
         call text%add(' NO INERTIA AT THE CRANK SOMEWHERE: GIVE &MASSES OR DEXTRA')
         return
      else if (.not. study%found) then
         call text%add(' NO STIFFNESS GIVES THE MEAN RATIO'//in_sentence(named, drive%ratio)// &
                       ': D**2 + J''''/(2 J0) WOULD BE NEGATIVE')
         return
      end if
      call list_inertia(' ', study%of_crank)
      if (study%with_offsets%mean > 0.0_wp) call list_inertia(' WITH THE OFFSETS: ', study%with_offsets)
      call text%add(' STIFFNESS'//in_sentence(named, study%stiffness)//'  D'//in_sentence(named, study%d)//'  C'// &
                    in_sentence(named, drive%damping))
      if (study%ratio_real) then
         call text%add(' MEAN RATIO OF THE FREQUENCY TO THE SPEED'//in_sentence(named, study%ratio)// &
                       ' (RESONANCE AT WHOLE NUMBERS, BANDS OF'// &
                       ' INSTABILITY AT WHOLE AND HALF ONES)')
         call text%add(' LEAST RATIO OF THE TURN'//in_sentence(named, study%least)// &
                       ', OF A DRIVE RIGID ENOUGH BY HAINES''S RULE AT LEAST '// &
                       to_text(nint(least_drive_ratio))//trim(merge('  KEPT  ', '  BROKEN', study%least >= least_drive_ratio)))
      else
         call text%add(' THE RATIO OF THE FREQUENCY TO THE SPEED IS NOT REAL ALL OVER THE TURN: IT SAYS NOTHING')
      end if
      if (study%loaded) then
         call text%add(' TORQUE OF WEIGHT, LOADS AND SPRINGS ON THE CRANK, IN THE SENSE OF ITS TURNING: FROM'// &
                       in_sentence(named, minval(study%torque))//' TO'//in_sentence(named, maxval(study%torque))//', MEAN'// &
                       in_sentence(named, sum(study%torque)/real(size(study%torque), wp)))
         if (any(abs(study%viscous) > 0.0_wp)) call text%add(' TORQUE OF DAMPERS AGAINST IT AT 1 RAD/S: FROM'// &
                                                             in_sentence(named, minval(study%viscous))//' TO'// &
                              in_sentence(named, maxval(study%viscous)))
      end if
      call text%add(' '//stability_words(study%hill))
      if (.not. study%hill%grows_too_much) &
         call text%add(' MULTIPLIERS'//both_multipliers(named, study%hill)// &
                    trim(merge(' (OF HALF A TURN)', '                 ', drive%ripple > 0.0_wp)))
      call list_accuracy(named, study%hill, text)
      if (study%hill%unique) then
         call text%add(' HARMONICS OF THE CRANK''S SWING, RAD, AND OF ITS ACCELERATION/SPEED**2 (*: IT MATTERS FOR THE OUTPUTS)'// &
                       trim(merge('; OF THE OUTPUT''S, AND OF THAT WITH A RIGID DRIVE', repeat(' ', 49), &
                                  size(study%output, 2) > 0)))
         allocate (columns(2 + 2*size(study%output, 2), 0:drive%harmonics))
         columns(:2, :) = harmonic_columns(named, reshape([study%swing, study%acceleration], [drive%harmonics + 1, 2]))
         columns(3::2, :) = harmonic_columns(named, study%output)
         columns(4::2, :) = harmonic_columns(named, study%rigid)
         do n = 0, drive%harmonics
            call text%add(trim(right_column(n, 6)//in_a_row(columns(:2, n))// &
                               merge(' *', '  ', matters(n, study%acceleration(n)))//in_a_row(columns(3:, n))))
         end do
         call text%add(' GREATEST SWING'//in_sentence(named, study%greatest))
         if (study%greatest > small_swing) call text%add(' THE EQUATION IS LINEAR IN THE SWING: ABOVE 0.1 RAD IT IS ROUGH')
      end if
      if (size(study%speeds) == 0) return
      call text%add(' OVER SPEEDS:             RAD/S            RPM          SWING')
      associate (rows => study%speeds)
         call list_speeds(named, rows%speed, rows%amplitude, rows%known, rows%stable .or. .not. rows%grows, text)
      end associate

   contains

      subroutine list_inertia(head, of)
         character(*), intent(in) :: head
         type(inertia_t), intent(in) :: of

         call text%add(head//'MEAN INERTIA AT THE CRANK'//in_sentence(named, of%mean)//', HALF ITS RANGE OVER THE MEAN'// &
                       in_sentence(named, of%half_range)//', GREATEST SLOPE/(2 MEAN)'//in_sentence(named, of%steepest))
      end subroutine list_inertia
   end subroutine list_drive

   !> The group HILL.
   subroutine list_hill(set, study, text)
      type(data_set_t), intent(in) :: set
      type(hill_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(hill_group_t) :: hill
      logical :: named

      hill = hill_of(set)
      named = set%has_names()
      call text%add()
      if (allocated(study%coupled)) then
         call list_coupled_hill(named, size(hill%load, 1), study, text)
         return
      end if
      call text%add(' HILL''S EQUATION Y'''' + C1 Y'' + C0 Y = P FROM TABLES OF '//to_text(size(hill%c0))//' VALUES')
      call text%add(' '//stability_words(study%hill))
      if (.not. study%hill%grows_too_much) then
         call text%add(' MULTIPLIERS'//both_multipliers(named, study%hill))
         call text%add(' PERIOD: FREE      '//in_sentence(named, study%hill%transfer(1, 1))// &
                       in_sentence(named, study%hill%transfer(1, 2)))
         call text%add('                   '//in_sentence(named, study%hill%transfer(2, 1))// &
                       in_sentence(named, study%hill%transfer(2, 2)))
         call text%add('         FROM REST '//in_sentence(named, study%hill%forced(1))//in_sentence(named, study%hill%forced(2)))
      end if
      call list_accuracy(named, study%hill, text)
      if (.not. study%hill%unique) return
      call text%add(' STEADY STATE AT 0'//in_sentence(named, study%hill%start(1))//in_sentence(named, study%hill%start(2))// &
                    ', GREATEST'// &
                    in_sentence(named, study%greatest))
      call list_harmonics(named, study%amplitude, text)
   end subroutine list_hill

   !> Several equations of Hill.
   subroutine list_coupled_hill(named, values, study, text)
      logical, intent(in) :: named
      integer, intent(in) :: values              !! of each table
      type(hill_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: i

      call text%add(' '//to_text(size(study%peaks))//' EQUATIONS OF HILL Y'''' + C1 Y'' + C0 Y = P FROM TABLES OF '// &
                    to_text(values)//' VALUES')
      associate (coupled => study%coupled)
         call text%add(' '//coupled_words(coupled))
         if (coupled%grows_too_much) return
         do i = 1, size(coupled%multipliers)
            call text%add('   MULTIPLIER'//multiplier(named, coupled%multipliers(i), coupled%error))
         end do
         call text%add(' OF A PERIOD: ERROR OF ITS MATRIX'//error_words(named, coupled%error)// &
                       ', OF THE PRODUCT AGAINST EXP(-INTEGRAL TRACE C1)'//error_words(named, coupled%determinant_error)//', '// &
                       to_text(coupled%steps)//' STEPS')
         if (.not. coupled%unique) return
         do i = 1, size(study%peaks)
            call text%add(' EQUATION '//to_text(i)//': AT 0'//in_sentence(named, coupled%y(1, i))// &
                          in_sentence(named, coupled%y1(1, i))//', GREATEST'//in_sentence(named, study%peaks(i)))
            call list_harmonics(named, study%amplitudes(:, i), text)
         end do
      end associate
   end subroutine list_coupled_hill

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
