!> A joint with clearance in the listing, on device 9, in remarks and in the exit status. Nothing is computed here.
module psalm_clearance_report
   use psalm_clearance_group, only: clearance_group_t, clearance_of, losses_any
   use psalm_clearance_study, only: clearance_study_t, flypast_of_joint_t, verdict_kept, verdict_lost
   use psalm_crank_list, only: list_crank, put_crank_speed, remark_crank, no_cycle
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_flypast_chart, only: chart_t, pulse_numbers
   use psalm_group_words, only: the_group
   use psalm_kinds, only: wp, degrees_per_radian, pi
   use psalm_mechanism, only: mechanism_t
   use psalm_number_format, only: figures_of, in_a_row, in_sentence
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t, lower_case, to_text
   implicit none (type, external)
   private
   public :: report_clearance

   integer, parameter :: name_length = 48              !! characters of a verdict in a table
   character(*), parameter :: pulse_names(pulse_numbers) = [character(7) :: 't_peak', 'force', 'height', 'width', 'growth', &
                                                            'decay', 'impulse'] !! as of `pulse_numbers`
   real(wp), parameter :: rpm_per_speed = 30.0_wp/pi !! revolutions per minute of 1 rad/s

contains

   !> Listing, device 9, remarks, exit status.
   subroutine report_clearance(set, mechanism, study, devices)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(clearance_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      type(clearance_group_t) :: clearance
      logical :: named
      integer :: k

      clearance = clearance_of(set)
      call devices%six%add(' '//set%title)
      if (hindered(set, mechanism, study, devices)) return
      named = set%has_names()
      call list_crank(named, study%crank, devices%six)
      call put_crank_speed(study%crank, devices%cases(devices%last_case()))
      call remark_crank(set, study%crank, 'NCPNT', clearance%points, devices)
      call list_minima(mechanism, named, study, devices%six)
      call list_following(named, study, devices%six)
      call list_speeds(named, study, devices%six)
      call list_charts(named, study, devices%six)
      call put_clearance(study, devices%cases(devices%last_case()))
      do k = 1, size(study%minima)
         if (study%minima(k)%verdict == verdict_kept) cycle
         if (clearance%counted == losses_any .or. study%minima(k)%in_passage()) then
            call devices%note_violation()
            call devices%remark(set, 'joint '//mechanism%joints(study%joint)%name//' loses contact near input'// &
                                in_sentence(named, study%minima(k)%input)//' degrees after the reference')
         else
            call devices%remark(set, 'joint '//mechanism%joints(study%joint)%name//' loses contact after the passage near input'// &
                                in_sentence(named, study%minima(k)%input)//' degrees after the reference; with '// &
                                'CLOSS=''PASSAGE'' that does not count')
         end if
      end do
      if (.not. study%followed) then
         call devices%note_violation()
         call devices%remark(set, 'the contact could not be followed through the turn: the load is zero where it '// &
                             'begins; give CBEGIN')
      end if
   end subroutine report_clearance

   !> True if there is nothing to report but what hinders.
   logical function hindered(set, mechanism, study, devices)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(clearance_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: words

      hindered = .true.
      if (.not. study%crank%known) then
         words = no_cycle
         if (study%stopped) words = 'stopped by request before the speed of the crank was known'
      else if (study%load%failure > 0) then
         words = 'the crank cannot make a full turn: the linkage does not close'
         if (study%load%closes) words = the_group(mechanism, study%load%loop)//' passes a dead point'
         words = words//at_position(study%load%failure)
      else if (study%load%loose > 0) then
         words = 'with joint '//mechanism%joints(study%joint)%name//' taken apart the links are not held'// &
                 at_position(study%load%loose)
      else if (study%massless) then
         words = 'nothing moves with the pin of joint '//mechanism%joints(study%joint)%name//' but links without mass: give &MASSES'
      else if (study%rank_one) then
         words = 'the inertia at joint '//mechanism%joints(study%joint)%name//' is almost of one direction only, its links '// &
                 'in line or one of them without mass: the study of contact does not hold'
      else
         hindered = .false.
         return
      end if
      call devices%six%add(' NO STUDY OF CONTACT: '//words)
      call devices%remark(set, words)
      call devices%note_violation()

   contains

      function at_position(position) result(text)
         integer, intent(in) :: position
         character(:), allocatable :: text

         text = ' at'//in_sentence(set%has_names(), study%load%crank%input(position))//' degrees after the reference'
      end function at_position
   end function hindered

   subroutine list_minima(mechanism, named, study, text)
      type(mechanism_t), intent(in) :: mechanism
      logical, intent(in) :: named
      type(clearance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15), allocatable :: columns(:, :)
      integer :: k

      call text%add()
      call text%add(' JOINT '//mechanism%joints(study%joint)%name//' WITH CLEARANCE: SI UNITS, ANGLES IN DEGREES')
      call text%add(' DIAMETRAL CLEARANCE'//in_sentence(named, study%diametral))
      call text%add(' MINIMA OF THE NOMINAL LOAD, EACH AS A FLYPAST; H2 AND AN IMPACT COUNT IN THE SENSE IN WHICH THE LOAD TURNS')
      call text%add('     INPUT          LOAD           RATE           M0             EPS            H1             H2'// &
                    '       VERDICT')
      associate (m => study%minima)
         allocate (columns(size(m), 7))
         columns(:, 1) = figures_of(named, m%input)
         columns(:, 2) = figures_of(named, m%load, all_count=.true.)
         columns(:, 3) = figures_of(named, m%rate, all_count=.true.)
         columns(:, 4) = figures_of(named, m%mass)
         columns(:, 5) = figures_of(named, m%h3, all_count=.true.)
         columns(:, 6) = figures_of(named, m%h1, all_count=.true.)
         columns(:, 7) = figures_of(named, m%h2)
      end associate
      do k = 1, size(study%minima)
         associate (m => study%minima(k))
            call text%add(in_a_row(columns(k, :))//'   '//verdict(m))
            if (m%verdict == verdict_lost .and. m%flight%ok) then
               call text%add('   LOST AT T ='//in_sentence(named, m%contact%loss(1))//', FLIGHT OF'// &
                             in_sentence(named, m%duration)//' S, IMPACT AT'// &
                             in_sentence(named, m%across)//' M/S ACROSS,'//in_sentence(named, m%along)//' ALONG THE WALL, INDEX'// &
                             in_sentence(named, m%flight%index)//', IMPULSE'//in_sentence(named, m%impulse))
            end if
            if (m%pulse%known) then
               call text%add('   PULSE IF CONTACT IS KEPT: GREATEST FORCE'//in_sentence(named, m%pulse%force)//', HEIGHT'// &
                             in_sentence(named, m%pulse%height)//', WIDTH'//in_sentence(named, m%pulse%width)//' S, GROWTH'// &
                             in_sentence(named, m%pulse%growth)//', DECAY'//in_sentence(named, m%pulse%decay)//' N/S, IMPULSE'// &
                             in_sentence(named, m%pulse%impulse))
               if (m%cycles > 0.0_wp) call text%add('   ITS WIDTH IS'//in_sentence(named, m%cycles)// &
                  ' PERIODS OF THE LINKS; IT BENDS OR STRETCHES THEM BY'//in_sentence(named, m%shock)//' TIMES WHAT ITS HEIGHT '// &
                  'DOES AT REST')
            end if
            if (m%clearance > 0.0_wp) call text%add('   CONTACT IS KEPT UP TO A DIAMETRAL CLEARANCE OF'// &
                                                          in_sentence(named, m%clearance))
            if (any(m%more > 0.0_wp)) call text%add('   PRELOAD THAT KEEPS CONTACT IN THE PASSAGE'// &
                                                    in_sentence(named, m%more(1))// &
                                                    ', ALSO AFTER IT'//in_sentence(named, m%more(2)))
         end associate
      end do
      if (size(study%minima) == 0) call text%add(' NONE')
      if (study%critical_clearance > 0.0_wp) then
         call text%add(' CRITICAL DIAMETRAL CLEARANCE OF THE TURN'//in_sentence(named, study%critical_clearance))
      end if
      call text%add(' MEASUREMENTS CONFIRM LOSSES IN THE PASSAGE AT A DIAMETRAL CLEARANCE OF 0.25 MM; TERMINAL LOSSES AND SMALLER')
      call text%add(' CLEARANCES ARE NOT CONFIRMED: THERE THE VERDICT IS ON THE SAFE SIDE')
   end subroutine list_minima

   pure function verdict(m) result(words)
      type(flypast_of_joint_t), intent(in) :: m
      character(:), allocatable :: words

      select case (m%verdict)
      case (verdict_kept)
         words = 'CONTACT KEPT'
      case (verdict_lost)
         words = 'CONTACT LOST, TERMINAL (MINIMUM '//to_text(m%contact%at)//')'
         if (m%contact%at == 1) words = 'CONTACT LOST IN THE PASSAGE'
      case default
         words = 'CONTACT LOST: THE LOAD PASSES THROUGH ZERO'
      end select
   end function verdict

   !> The same in a table.
   pure function verdict_name(m) result(words)
      type(flypast_of_joint_t), intent(in) :: m
      character(name_length) :: words

      words = lower_case(verdict(m))
   end function verdict_name

   subroutine list_following(named, study, text)
      logical, intent(in) :: named
      type(clearance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15), dimension(size(study%least)) :: at, force
      integer :: k

      call text%add()
      if (.not. study%followed) then
         call text%add(' THE CONTACT COULD NOT BE FOLLOWED: THE LOAD IS ZERO WHERE IT BEGINS')
         return
      end if
      call text%add(' CONTACT FOLLOWED THROUGH A TURN FROM'//in_sentence(named, study%input(1))//': LEAST FORCE'// &
                    in_sentence(named, minval(study%force))//', GREATEST LAG'//in_sentence(named, maxval(abs(study%lag))))
      if (study%loses) call text%add(' ITS FORCE BECOMES NEGATIVE FIRST AT INPUT'//in_sentence(named, study%loss))
      call text%add(' MINIMA OF THE FORCE:     INPUT          FORCE')
      at = figures_of(named, study%crank%input_at(study%least%input))
      force = figures_of(named, study%least%force, all_count=.true.)
      do k = 1, size(study%least)
         call text%add(repeat(' ', 18)//at(k)//force(k))
      end do
   end subroutine list_following

   subroutine list_speeds(named, study, text)
      logical, intent(in) :: named
      type(clearance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15) :: columns(size(study%speeds), 3)
      integer :: k

      if (size(study%speeds) == 0) return
      columns(:, 1) = figures_of(named, study%speeds%speed)
      columns(:, 2) = figures_of(named, study%speeds%speed*rpm_per_speed)
      columns(:, 3) = figures_of(named, study%speeds%least, all_count=.true.)
      call text%add()
      call text%add(' OVER SPEEDS:             RAD/S            RPM     LEAST LOAD   MINIMA THAT LOSE CONTACT, IN THE PASSAGE')
      do k = 1, size(study%speeds)
         associate (row => study%speeds(k))
            call text%add(repeat(' ', 18)//in_a_row(columns(k, :))//'   '//to_text(row%lost)//', '//to_text(row%in_passage))
         end associate
      end do
      if (study%critical_speed > 0.0_wp) call text%add(' CONTACT IS KEPT UP TO THE SPEED'//in_sentence(named, study%critical_speed))
   end subroutine list_speeds

   !> The standard charts: on how many radial lines contact is lost, is lost in several ranges, and how far out.
   subroutine list_charts(named, study, text)
      logical, intent(in) :: named
      type(clearance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer, allocatable :: counted(:, :)
      character(15), allocatable :: h3(:), h1(:)
      real(wp), allocatable :: farthest(:)
      integer :: k, i

      if (.not. allocated(study%chart%h3)) return
      call text%add()
      call text%add(' CHARTS: H3, RADIAL LINES, THOSE ON WHICH CONTACT IS LOST, IN SEVERAL RANGES OF H1, LARGEST H1 OF A LOSS')
      associate (chart => study%chart)
         allocate (counted(size(chart%h2), size(chart%h3)), farthest(size(chart%h3)))
         farthest = 0.0_wp
         do k = 1, size(chart%h3)
            do i = 1, size(chart%h2)
               associate (ranges => chart%lines(i, k)%ranges)
                  counted(i, k) = size(ranges)
                  if (size(ranges) > 0) farthest(k) = max(farthest(k), ranges(size(ranges))%to)
               end associate
            end do
         end do
         h3 = figures_of(named, chart%h3)
         h1 = figures_of(named, farthest)
      end associate
      do k = 1, size(h3)
         call text%add(h3(k)//'   '//to_text(size(counted, 1))//'   '//to_text(count(counted(:, k) > 0))//'   '// &
                       to_text(count(counted(:, k) > 1))//h1(k))
      end do
   end subroutine list_charts

   !> Tables clearance, minima, losses, following, least_forces, speeds, flight, cycle, and of charts threshold and chart.
   pure subroutine put_clearance(study, tables)
      type(clearance_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: k

      table = table_of('clearance', 'one row: the joint with clearance', audience=for_programs)
      call table%add('diametral', [study%diametral], 'm')
      call table%add('critical_diametral', [study%critical_clearance], 'm', [study%critical_clearance > 0.0_wp])
      call table%add('critical_speed', [study%critical_speed], 'rad/s', [study%critical_speed > 0.0_wp])
      call table%add('followed', [study%followed])
      call table%add('first_loss_at', [study%loss], 'deg', [study%followed .and. study%loses])
      call tables%put(table)
      table = table_of('minima', 'a row for each minimum of the load')
      associate (m => study%minima)
         call table%add('input', m%input, 'deg')
         call table%add('load', m%load, 'N')
         call table%add('rate', m%rate, 'N/s')
         call table%add('m0', m%mass, 'kg')
         call table%add('eps', m%h3)
         call table%add('h1', m%h1)
         call table%add('h2', m%h2, 'deg')
         call table%add('h3', m%h3)
         call table%add('kept', m%verdict == verdict_kept)
      end associate
      call tables%put(table)
      table = table_of('losses', 'a row for each minimum of the load: what the verdict is about', audience=for_programs)
      associate (m => study%minima)
         call table%add('input', m%input, 'deg')
         call table%add('verdict', [(verdict_name(m(k)), k=1, size(m))])
         call table%add('kept_up_to_diametral', m%clearance, 'm', m%clearance > 0.0_wp)
      end associate
      call tables%put(table)
      table = table_of('preload', 'a row for each minimum of the load: H1 from which on contact is kept, and the load '// &
                       'that it lacks')
      associate (m => study%minima)
         call table%add('input', m%input, 'deg')
         call table%add('h1', m%h1)
         call table%add('h1_passage', m%border(1))
         call table%add('h1_any', m%border(2))
         call table%add('more_passage', m%more(1), 'N')
         call table%add('more_any', m%more(2), 'N')
      end associate
      call tables%put(table)
      table = table_of('pulse', 'a row for each minimum of the load that a pulse follows if contact is kept')
      associate (m => study%minima(pack([(k, k=1, size(study%minima))], study%minima%pulse%known)))
         call table%add('input', m%input, 'deg')
         call table%add('t_peak', m%pulse%at, 's')
         call table%add('force', m%pulse%force, 'N')
         call table%add('height', m%pulse%height, 'N')
         call table%add('width', m%pulse%width, 's')
         call table%add('growth', m%pulse%growth, 'N/s')
         call table%add('decay', m%pulse%decay, 'N/s')
         call table%add('impulse', m%pulse%impulse, 'N s')
         if (any(m%cycles > 0.0_wp)) then
            call table%add('cycles', m%cycles)
            call table%add('shock', m%shock)
         end if
      end associate
      call tables%put(table)
      table = table_of('following', 'a row for each input, contact followed')
      if (study%followed) then
         call table%add('input', study%input, 'deg')
         call table%add('lag', study%lag, 'deg')
         call table%add('force', study%force, 'N')
      else
         call table%add('input', [real(wp) ::], 'deg')
         call table%add('lag', [real(wp) ::], 'deg')
         call table%add('force', [real(wp) ::], 'N')
      end if
      call tables%put(table)
      if (study%followed) then
         table = table_of('least_forces', 'a row for each minimum of the force, contact followed', audience=for_programs)
         call table%add('input', study%crank%input_at(study%least%input), 'deg')
         call table%add('force', study%least%force, 'N')
         call tables%put(table)
      end if
      if (size(study%speeds) > 0) then
         table = table_of('speeds', 'a row for each speed: the least load, minima at which contact is lost', audience=for_programs)
         call table%add('speed', study%speeds%speed, 'rad/s')
         call table%add('least_load', study%speeds%least, 'N')
         call table%add('lost', study%speeds%lost)
         call table%add('lost_in_passage', study%speeds%in_passage)
         call tables%put(table)
      end if
      table = table_of('flight', 'a row for each minimum at which contact is lost', &
                       notes='run of gi and vt: in the sense in which the load turns at the minimum')
      associate (m => study%minima(pack([(k, k=1, size(study%minima))], &
                                        study%minima%verdict == verdict_lost .and. study%minima%flight%ok)))
         call table%add('t_loss', m%loss, 's')
         call table%add('duration', m%duration, 's')
         call table%add('gi', m%flight%angle*degrees_per_radian, 'deg')
         call table%add('vn', m%across, 'm/s')
         call table%add('vt', m%along, 'm/s')
         call table%add('index', m%flight%index)
         call table%add('impulse', m%impulse, 'N s')
      end associate
      call tables%put(table)
      table = table_of('cycle', 'a row for each input: load without clearance, inertia that moves with the pin')
      call table%add('input', study%cycle%input, 'deg')
      call table%add('fx', study%cycle%force(1, :), 'N')
      call table%add('fy', study%cycle%force(2, :), 'N')
      call table%add('m_uu', study%load%tensor(1, :), 'kg')
      call table%add('m_uv', study%load%tensor(2, :), 'kg')
      call table%add('m_vv', study%load%tensor(3, :), 'kg')
      call tables%put(table)
      if (allocated(study%chart%h3)) call put_chart(study%chart, tables)
   end subroutine put_clearance

   pure subroutine put_chart(chart, tables)
      type(chart_t), intent(in) :: chart
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: i, j, n

      associate (lines => chart%lines, ranks => size(chart%h3), angles => size(chart%h2), radii => size(chart%h1))
         table = table_of('threshold_passage', 'a row for each range of H1 within which contact is lost in the passage')
         call table%add('h3', [(((chart%h3(n), j=1, size(lines(i, n)%passage)), i=1, angles), n=1, ranks)])
         call table%add('h2', [(((chart%h2(i)*degrees_per_radian, j=1, size(lines(i, n)%passage)), i=1, angles), n=1, ranks)], &
                        'deg')
         call table%add('from', [((lines(i, n)%passage%from, i=1, angles), n=1, ranks)])
         call table%add('to', [((lines(i, n)%passage%to, i=1, angles), n=1, ranks)])
         call tables%put(table)
         table = table_of('threshold', 'a row for each range of H1 within which contact is lost')
         call table%add('h3', [(((chart%h3(n), j=1, size(lines(i, n)%ranges)), i=1, angles), n=1, ranks)])
         call table%add('h2', [(((chart%h2(i)*degrees_per_radian, j=1, size(lines(i, n)%ranges)), i=1, angles), n=1, ranks)], 'deg')
         call table%add('from', [((lines(i, n)%ranges%from, i=1, angles), n=1, ranks)])
         call table%add('to', [((lines(i, n)%ranges%to, i=1, angles), n=1, ranks)])
         call table%add('minimum', [((lines(i, n)%ranges%minimum, i=1, angles), n=1, ranks)])
         call tables%put(table)
         table = table_of('chart', 'a row for each point of the charts')
         call table%add('h3', [(((chart%h3(n), j=1, radii), i=1, angles), n=1, ranks)])
         call table%add('h2', [(((chart%h2(i)*degrees_per_radian, j=1, radii), i=1, angles), n=1, ranks)], 'deg')
         call table%add('h1', [(((chart%h1(j), j=1, radii), i=1, angles), n=1, ranks)])
         call table%add('minimum', reshape(chart%lost(:radii, :angles, :ranks), [radii*angles*ranks]))
         call table%add('index', reshape(chart%index(:radii, :angles, :ranks), [radii*angles*ranks]))
         call tables%put(table)
         table = table_of('chart_pulse', 'a row for each point of the charts: the pulse if contact is kept, in parts of the '// &
                          'least load and of T')
         call table%add('h3', [(((chart%h3(n), j=1, radii), i=1, angles), n=1, ranks)])
         call table%add('h2', [(((chart%h2(i)*degrees_per_radian, j=1, radii), i=1, angles), n=1, ranks)], 'deg')
         call table%add('h1', [(((chart%h1(j), j=1, radii), i=1, angles), n=1, ranks)])
         do j = 1, pulse_numbers
            call table%add(trim(pulse_names(j)), reshape(chart%pulse(j, :radii, :angles, :ranks), [radii*angles*ranks]), &
                           known=reshape(chart%pulse(3, :radii, :angles, :ranks), [radii*angles*ranks]) > 0.0_wp)
         end do
         call tables%put(table)
      end associate
   end subroutine put_chart
end module psalm_clearance_report
