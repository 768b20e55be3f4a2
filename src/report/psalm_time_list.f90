!> Motion in time: listing, table, summary and remarks.
module psalm_time_list
   use psalm_column_names, only: by_time, drive_unit, input_name, input_unit, output_name, output_unit, per_time, rate_unit
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_error, only: problem_t
   use psalm_force_list, only: add_forces, list_sizing
   use psalm_group_words, only: the_group
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp, pi, degrees_per_radian
   use psalm_mechanism, only: mechanism_t
   use psalm_number_format, only: number_format_t, format_of, figure
   use psalm_position_table, only: add_joints, add_outputs
   use psalm_summary_text, only: add_line, plain_number
   use psalm_tables, only: table_t, tables_t, table_of
   use psalm_text, only: text_t, to_text, upper_case
   use psalm_time_study, only: time_study_t, time_closed, time_collapsed, time_crowded, time_tired, time_done, time_folded, &
                               time_jammed, time_massless, time_on_request, time_open, time_stiff, time_wound
   use psalm_time_motion, only: event_t, event_impact, event_rest, event_lift, event_stick, event_slip, &
                                event_on, event_off, event_change
   implicit none (type, external)
   private
   public :: report_time, summarise_time, ending_words

   character(*), parameter :: time_block = 'time', event_block = 'events'
   character(*), parameter :: of_motor = 'motor', no_stop = '-' !! in place of the name of a joint
   character(*), parameter :: event_words(*) = [character(6) :: &
                                                'impact', 'rest', 'lift', 'stick', 'slip', 'on', 'off', 'change'] !! by `event_...`
   character(*), parameter :: nl = new_line('a')
   integer, parameter :: rates_shown = 2
   integer, parameter :: most_exchanges = 3     !! of drives, that the summary has with their times
   integer, parameter :: most_passages = 3      !! of change points, likewise
   real(wp), parameter :: full_circle = 2.0_wp*pi

contains

   !> Listing and table; a remark and the exit status where the motion ends early.
   subroutine report_time(set, problem, study, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(time_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices

      if (study%rests) then
         call list_equilibria(set, problem%mechanism, study, devices%six)
         call put_equilibria(set, problem%mechanism, study, devices%cases(devices%last_case()))
      end if
      if (.not. study%moves) then
         if (study%ended == time_done) return
         call devices%note_violation()
         call devices%remark(set, 'there are no equilibria: '//reason_words(problem%mechanism, study))
         return
      end if
      call list_time(set, problem%mechanism, study, devices%six)
      call put_time(set, problem, study, devices%cases(devices%last_case()))
      if (study%stiff .and. study%ended /= time_stiff) call devices%remark(set, 'stability kept the steps of the motion short, '// &
         'as with a strong damper; with ISTIFF=1 of &TIME they may be longer')
      if (any(study%events%kind == event_change)) then
         call devices%remark(set, 'the motion goes straight on through change points, where the linkage could also fold')
         if (study%gap > 0.0_wp) call devices%remark(set, 'the linkage misses a change point that the motion passes by '// &
                                                     plain_number(study%gap)//' of its lengths, which is taken for rounding')
      end if
      if (study%ended == time_done) return
      call devices%note_violation()
      call devices%remark(set, 'the motion '//ending_words(problem%mechanism, study))
   end subroutine report_time

   !> How the motion ended before its time.
   function ending_words(mechanism, study) result(words)
      type(mechanism_t), intent(in) :: mechanism
      type(time_study_t), intent(in) :: study
      character(:), allocatable :: words

      words = 'ends at '//plain_number(study%stopped)//' s of '//plain_number(study%end)//' s: '//reason_words(mechanism, study)
   end function ending_words

   function reason_words(mechanism, study) result(words)
      type(mechanism_t), intent(in) :: mechanism
      type(time_study_t), intent(in) :: study
      character(:), allocatable :: words

      words = ''
      select case (study%ended)
      case (time_open)
         words = the_group(mechanism, study%loop)//' does not close beyond'
      case (time_folded)
         words = the_group(mechanism, study%loop)//' is at a change point, which is passed by one free drive alone, others at '// &
                 'rest, without larger groups and friction of joints'
      case (time_massless)
         words = 'some motion of the free drives moves no mass; give their links masses'
      case (time_collapsed)
         words = 'no step keeps the tolerance TTOL: a dead point of a drive (another drive may pass there), a change point '// &
                 '(passed by one free drive, others at rest, without larger groups and friction of joints), a very stiff '// &
                 'spring or damper, or TEND far too long'
      case (time_wound)
         words = 'torsional spring '//to_text(study%loop)//' is turned past half a turn from SFREE'
      case (time_closed)
         words = 'gas spring '//to_text(study%loop)//' has no room left: its length has come to SGASP'
      case (time_jammed)
         words = 'no force of friction of '//trim(study%stop_names(study%loop))// &
                 ' was found that agrees with the load that it makes'
      case (time_crowded)
         words = 'more events than NEVENT'
      case (time_tired)
         words = 'more steps than NTSTEP'
      case (time_stiff)
         words = 'stability keeps the steps so short, as with a very strong damper, that more than 100 000 would follow; '// &
                 'ISTIFF=1 of &TIME takes longer ones'
      case (time_on_request)
         words = 'the end was asked for'
      end select
   end function reason_words

   subroutine list_time(set, mechanism, study, text)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(time_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(number_format_t), allocatable :: format(:)
      type(number_format_t) :: of_time
      real(wp), allocatable :: column(:, :)
      character(:), allocatable :: line
      integer :: d, k, c, drives

      drives = size(study%free)
      allocate (column(size(study%time), 2*drives + 3), format(2*drives + 3))
      do d = 1, drives
         column(:, 2*d - 1) = study%drives(:, d, 0)
         column(:, 2*d) = study%drives(:, d, 1)
      end do
      column(:, 2*drives + 1) = study%forces%table%kinetic
      column(:, 2*drives + 2) = study%potential
      column(:, 2*drives + 3) = study%work - study%lost
      format = [(format_of(set%has_names(), column(:, c)), c=1, size(format))]
      of_time = format_of(set%has_names(), study%time)
      call text%add()
      call text%add(' MOTION IN TIME: SECONDS, DEGREES, RADIANS A SECOND, LENGTHS, JOULES')
      line = '           TIME'
      do d = 1, drives
         line = line//heading('INPUT', d)//heading('SPEED', d)
      end do
      call text%add(line//'        KINETIC      POTENTIAL      WORK DONE')
      do k = 1, size(study%time)
         line = figure(study%time(k), of_time)
         do c = 1, size(format)
            line = line//figure(column(k, c), format(c))
         end do
         call text%add(line)
      end do
      if (size(study%time) > 1) call list_sizing(study%forces, 'THE TIME ', text)
      if (size(study%events) > 0) call list_events()
      do k = 1, size(study%exchanges)
         call text%add(' COORDINATES FROM '//plain_number(study%exchanges(k)%time)//' S: '// &
                       upper_case(study%exchanges(k)%names)//', FOR THE DRIVES COME TO A DEAD POINT')
      end do
      if (study%ended /= time_done) call text%add(' THE MOTION '//upper_case(ending_words(mechanism, study)))

   contains

      !> Impacts, and when joints rest on their stops and leave them.
      subroutine list_events()
         type(number_format_t) :: of_event, formats(3)
         character(:), allocatable :: what
         integer :: e

         of_event = format_of(set%has_names(), study%events%time)
         formats(1) = format_of(set%has_names(), study%events%before)
         formats(2) = format_of(set%has_names(), study%events%after)
         formats(3) = format_of(set%has_names(), study%events%impulse)
         call text%add()
         call text%add(' EVENTS: SECONDS, RADIANS OR LENGTHS A SECOND, NEWTON METRE SECONDS OR NEWTON SECONDS')
         call text%add('           TIME         BEFORE          AFTER        IMPULSE   EVENT')
         do e = 1, size(study%events)
            associate (event => study%events(e))
               what = name_of(study, event)
               if (event%kind == event_change) what = 'POINT, STRAIGHT ON'
               call text%add(figure(event%time, of_event)//figure(event%before, formats(1))//figure(event%after, formats(2))// &
                             figure(event%impulse, formats(3))//'   '//upper_case(trim(event_words(event%kind)))//' '//what)
            end associate
         end do
      end subroutine list_events

      !> Of several drives with the name of each.
      function heading(word, drive) result(head)
         character(*), intent(in) :: word
         integer, intent(in) :: drive
         integer, parameter :: width = 15     ! characters
         character(width) :: head

         head = word
         if (drives > 1) head = word//' '//upper_case(trim(study%forces%drives(drive)))
         head = adjustr(head)
      end function heading
   end subroutine list_time

   !> Equilibria and their small oscillations.
   subroutine list_equilibria(set, mechanism, study, text)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(time_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(number_format_t), allocatable :: formats(:)
      real(wp), allocatable :: column(:, :)
      character(:), allocatable :: line
      character(15) :: head
      integer :: k, d, f, m

      f = size(study%free_drives)
      call text%add()
      call text%add(' EQUILIBRIA: DEGREES OR LENGTHS, JOULES; SMALL OSCILLATIONS: RADIANS A SECOND, GROWTH A SECOND')
      if (f > 1 .and. size(study%stop_names) > 0) call text%add(' OF SEVERAL FREE DRIVES ONLY THOSE BETWEEN THE STOPS, NOT ON THEM')
      if (study%equilibria%everywhere) call text%add(' NO FORCE ACTS ON THE FREE DRIVES, WHEREVER THEY ARE')
      if (size(study%equilibria%list) == 0) then
         if (.not. study%equilibria%everywhere) call text%add(' NONE FOUND')
         return
      end if
      allocate (column(size(study%equilibria%list), f + 1), formats(f + 1))
      line = ' NUMBER'
      do d = 1, f
         head = 'INPUT'
         if (size(study%free) > 1) head = 'INPUT '//upper_case(trim(study%forces%drives(study%free_drives(d))))
         line = line//adjustr(head)
         do k = 1, size(study%equilibria%list)
            column(k, d) = input_of(mechanism, study, k, d)
         end do
      end do
      column(:, f + 1) = study%equilibria%list%potential
      formats = [(format_of(set%has_names(), column(:, d)), d=1, f + 1)]
      call text%add(line//'      POTENTIAL   OSCILLATIONS')
      do k = 1, size(study%equilibria%list)
         line = repeat(' ', 7 - len(to_text(k)))//to_text(k)
         do d = 1, f + 1
            line = line//figure(column(k, d), formats(d))
         end do
         associate (one => study%equilibria%list(k))
            if (one%neutral()) then
               line = line//'   NEUTRAL'
            else
               line = line//'   '//trim(merge('STABLE  ', 'UNSTABLE', one%stable()))
            end if
            if (one%held_by > 0) line = line//', HELD BY STOP '//trim(study%stop_names(one%held_by))
            do m = 1, size(one%squares)
               if (one%squares(m) >= 0.0_wp) then
                  line = line//', '//plain_number(sqrt(one%squares(m)))//' RAD/S'
               else
                  line = line//', GROWTH '//plain_number(sqrt(-one%squares(m)))//' /S'
               end if
            end do
         end associate
         call text%add(line)
      end do
   end subroutine list_equilibria

   !> Input of a free drive at an equilibrium as `study%drives` has it: degrees or length.
   pure real(wp) function input_of(mechanism, study, number, free)
      type(mechanism_t), intent(in) :: mechanism
      type(time_study_t), intent(in) :: study
      integer, intent(in) :: number, free

      associate (d => study%free_drives(free))
         input_of = study%equilibria%list(number)%q(free)*merge(1.0_wp, degrees_per_radian, mechanism%actuators(d)%slides)
         if (d == 1) input_of = study%zero_input + input_of
      end associate
   end function input_of

   !> The tables `equilibria`, `small_motion` (undamped) and `small_motion_roots` (damped).
   subroutine put_equilibria(set, mechanism, study, tables)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(time_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer, allocatable :: of(:), mode(:)
      real(wp), allocatable :: value(:), other(:)
      character(:), allocatable :: name
      integer :: k, d, m, n

      n = size(study%equilibria%list)
      table = table_of('equilibria', 'a row for each equilibrium that was found', notes=set%title)
      call table%add('equilibrium', [(k, k=1, n)])
      do d = 1, size(study%free_drives)
         name = input_name()
         if (set%has_names()) name = input_name(set%sketch, study%free_drives(d))
         call table%add(name, [(input_of(mechanism, study, k, d), k=1, n)], &
                        trim(merge('length', 'deg   ', mechanism%actuators(study%free_drives(d))%slides)))
      end do
      call table%add('potential', study%equilibria%list%potential, 'J')
      call table%add('stable', [(study%equilibria%list(k)%stable(), k=1, n)])
      call table%add('stop', study%equilibria%list%held_by)
      call tables%put(table)
      of = [((k, m=1, size(study%equilibria%list(k)%squares)), k=1, n)]
      mode = [((m, m=1, size(study%equilibria%list(k)%squares)), k=1, n)]
      allocate (value(size(of)), other(size(of)))
      table = table_of('small_motion', 'a row for each equilibrium and mode, without damping', notes=set%title//nl// &
                       'square: of the angular frequency, below 0 where it grows; shapes: rates of the drives, radians or lengths')
      call table%add('equilibrium', of)
      call table%add('mode', mode)
      do m = 1, size(of)
         value(m) = study%equilibria%list(of(m))%squares(mode(m))
      end do
      call table%add('square', value, '1/s^2')
      call table%add('frequency', sqrt(max(0.0_wp, value))/full_circle, 'Hz')
      do d = 1, size(study%free_drives)
         do m = 1, size(of)
            value(m) = study%equilibria%list(of(m))%shapes(d, mode(m))
         end do
         name = input_name()
         if (set%has_names()) name = input_name(set%sketch, study%free_drives(d))
         call table%add('shape.'//name, value)
      end do
      call tables%put(table)
      of = [((k, m=1, size(study%equilibria%list(k)%roots)), k=1, n)]
      mode = [((m, m=1, size(study%equilibria%list(k)%roots)), k=1, n)]
      value = [(real(study%equilibria%list(of(m))%roots(mode(m)), wp), m=1, size(of))]
      other = [(aimag(study%equilibria%list(of(m))%roots(mode(m))), m=1, size(of))]
      table = table_of('small_motion_roots', 'a row for each equilibrium and root of its damped small motion', notes=set%title)
      call table%add('equilibrium', of)
      call table%add('growth', value, '1/s')
      call table%add('angular_frequency', other, 'rad/s')
      call table%add('damping_ratio', -value/max(hypotenuse(value, other), tiny(1.0_wp)))
      call tables%put(table)
   end subroutine put_equilibria

   !> Largest remainder of the balance, J.
   pure real(wp) function remainder(study)
      type(time_study_t), intent(in) :: study

      remainder = 0.0_wp
      if (size(study%balance) > 0) remainder = maxval(abs(study%balance))
   end function remainder

   !> The table `time`: times, drives, outputs, joints, forces, energies.
   subroutine put_time(set, problem, study, tables)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(time_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(:), allocatable :: name, words(:), stops(:)
      logical :: known(size(study%time), 0:rates_shown)
      integer :: d, o, c

      known = .true.
      table = table_of(time_block, 'a row for each time', notes=set%title//nl//'angles in degrees, their rates in radians a '// &
                       'second; balance: kinetic + potential - work + lost, less that at time 0')
      call table%add('time', study%time, 's')
      do d = 1, size(study%free)
         do o = 0, rates_shown
            if (set%has_names()) then
               name = input_name(set%sketch, d)
            else
               name = input_name()
            end if
            if (o > 0) then
               call table%add(by_time(name, o), study%drives(:, d, o), &
                              rate_unit(.not. problem%mechanism%actuators(d)%slides, per_time(), o))
            else if (set%has_names()) then
               call table%add(name, study%drives(:, d, o), drive_unit(set%sketch, d))
            else
               call table%add(name, study%drives(:, d, o), input_unit(problem%mechanism%sliding_input))
            end if
         end do
      end do
      if (set%has_names()) then
         call add_outputs(set%sketch, study%sketch, rates_shown, known, table)
         call add_joints(set%sketch, study%sketch, rates_shown, known, table)
      else if (.not. problem%mechanism%outputs(1)%stands_in) then
         associate (kind => problem%output%kind)
            do c = 1, kind%components
               call table%add(output_name(kind, c), study%output(:, c, 0), output_unit(c == kind%angle))
               do o = 1, rates_shown
                  call table%add(by_time(output_name(kind, c), o), study%output(:, c, o), &
                                 rate_unit(c == kind%angle, per_time(), o))
               end do
            end do
         end associate
      end if
      call add_forces(study%forces, table)
      do c = 1, size(study%stops, 2)
         call table%add(trim(merge('stop    ', 'friction', c <= study%smooth))//'.'//trim(study%stop_names(c)), &
                        study%stops(:, c), merge('N  ', 'N m', study%stop_slides(c)))
      end do
      call table%add('potential', study%potential, 'J')
      call table%add('lost', study%lost, 'J')
      call table%add('work', study%work, 'J')
      call table%add('balance', study%balance, 'J')
      call tables%put(table)
      if (size(study%stops, 2) + size(study%events) == 0) return
      table = table_of(event_block, 'a row for each event of the motion in time', notes=set%title//nl//'angles in radians')
      call table%add('time', study%events%time, 's')
      allocate (character(len(event_words)) :: words(size(study%events)))
      allocate (character(max(len(study%stop_names), len(of_motor))) :: stops(size(study%events)))
      do c = 1, size(study%events)
         words(c) = event_words(study%events(c)%kind)
         stops(c) = name_of(study, study%events(c))
      end do
      call table%add('event', words)
      call table%add('stop', stops)
      call table%add('before', study%events%before, 'rad/s, length/s')
      call table%add('after', study%events%after, 'rad/s, length/s')
      call table%add('impulse', study%events%impulse, 'N m s, N s')
      call tables%put(table)
   end subroutine put_time

   !> What an event happens to.
   pure function name_of(study, event) result(name)
      type(time_study_t), intent(in) :: study
      type(event_t), intent(in) :: event
      character(:), allocatable :: name

      if (event%stop > 0) then
         name = trim(study%stop_names(event%stop))
      else
         name = trim(merge(of_motor, no_stop//'    ', any(event%kind == [event_on, event_off])))
      end if
   end function name_of

   !> Lines of the summary.
   subroutine summarise_time(problem, study, text)
      type(problem_t), intent(in) :: problem
      type(time_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(:), allocatable :: words
      real(wp), parameter :: roundings = 100.0_wp   !! of the potential energy: less is none
      real(wp), allocatable :: passed(:)
      integer :: d, at, stop, first, rests

      if (study%rests) call summarise_equilibria()
      if (.not. study%moves) return
      words = '0 to '//plain_number(study%stopped)//' s in '//to_text(study%steps)// &
              trim(merge(' step ', ' steps', study%steps == 1))
      if (study%turnover > roundings*epsilon(1.0_wp)*maxval([0.0_wp, abs(study%potential)])) then
         words = words//'; energy in balance to '//plain_number(remainder(study)/study%turnover)
      else if (study%turnover > 0.0_wp) then
         words = words//'; no energy moves, but for rounding'
      end if
      call add_line('Motion', words, text)
      if (study%ended /= time_done) call add_line('Ends early', ending_words(problem%mechanism, study), text)
      if (size(study%exchanges) > 0) then
         words = 'the free drives'
         do d = 1, min(most_exchanges, size(study%exchanges))
            words = words//'; '//study%exchanges(d)%names//' from '//plain_number(study%exchanges(d)%time)//' s'
         end do
         if (size(study%exchanges) > most_exchanges) &
            words = words//'; '//to_text(size(study%exchanges) - most_exchanges)//' more exchanges'
         call add_line('Coordinates', words, text)
      end if
      if (any(study%events%kind == event_change)) then
         passed = pack(study%events%time, study%events%kind == event_change)
         words = trim(merge('change points at ', 'change point at  ', size(passed) > 1))
         do d = 1, min(most_passages, size(passed))
            words = words//trim(merge(', ', '  ', d > 1))//' '//plain_number(passed(d))
         end do
         words = words//' s'
         if (size(passed) > most_passages) words = words//' and '//to_text(size(passed) - most_passages)//' more'
         call add_line('Passes', words//', straight on', text)
      end if
      do d = 1, size(study%free)
         if (.not. study%free(d) .or. size(study%time) == 0) cycle
         at = maxloc(abs(study%drives(:, d, 1)), dim=1)
         words = plain_number(study%drives(at, d, 1))//trim(merge(' length units/s', ' rad/s         ', &
                                                                problem%mechanism%actuators(d)%slides))// &
                 ' at '//plain_number(study%time(at))//' s'
         if (size(study%free) > 1) words = trim(study%forces%drives(d))//' '//words
         call add_line('Greatest speed', words, text)
         call summarise_end(d)
      end do
      do stop = study%smooth + 1, size(study%stop_names)
         first = findloc(study%events%stop == stop .and. study%events%kind == event_stick, .true., dim=1, back=.true.)
         if (first == 0) cycle
         rests = count(study%events%stop == stop .and. study%events%kind == event_stick)
         words = 'from '//plain_number(study%events(first)%time)//' s'
         if (rests > 1) words = to_text(rests)//' times, at last '//words
         at = findloc(study%events%stop == stop .and. study%events%kind == event_slip, .true., dim=1, back=.true.)
         if (at > first) then
            words = words//' to '//plain_number(study%events(at)%time)//' s'
         else if (size(study%time) > 0) then
            words = words//', holds '//plain_number(abs(study%stops(size(study%time), stop)))// &
                    trim(merge(' N  ', ' N m', study%stop_slides(stop)))
         end if
         call add_line('Sticks '//trim(study%stop_names(stop)), words, text)
      end do
      do stop = 1, study%smooth
         first = findloc(study%events%stop == stop .and. study%events%kind == event_impact, .true., dim=1)
         rests = findloc(study%events%stop == stop .and. study%events%kind == event_rest, .true., dim=1, back=.true.)
         words = ''
         if (first > 0) words = 'hit first at '//plain_number(study%events(first)%time)//' s'
         if (rests > 0) then
            if (len(words) > 0) words = words//', '
            words = words//'rests from '//plain_number(study%events(rests)%time)//' s'
            at = findloc(study%events%stop == stop .and. study%events%kind == event_lift, .true., dim=1, back=.true.)
            if (at > rests) words = words//' to '//plain_number(study%events(at)%time)//' s'
         end if
         if (len(words) > 0) call add_line('Stop '//trim(study%stop_names(stop)), words, text)
      end do

   contains

      !> Where a drive stands from some time on, or keeps its speed: by the times that are listed.
      subroutine summarise_end(drive)
         integer, intent(in) :: drive
         real(wp), parameter :: steady = 0.01_wp   ! part of the speed
         real(wp), parameter :: none = 1.0e-9_wp   ! part of the greatest speed
         real(wp), parameter :: late = 0.9_wp      ! part of the time: what begins later says little
         character(:), allocatable :: name
         real(wp) :: last, greatest
         integer :: rows, from

         rows = size(study%time)
         if (study%ended /= time_done .or. rows < 2) return
         associate (speed => study%drives(:, drive, 1))
            last = speed(rows)
            greatest = maxval(abs(speed))
            if (abs(last) <= none*greatest) then
               from = findloc(abs(speed) <= none*greatest, .false., dim=1, back=.true.) + 1
            else
               from = findloc(abs(speed - last) <= steady*abs(last), .false., dim=1, back=.true.) + 1
            end if
         end associate
         if (from == 1 .or. study%time(from) > late*study%time(rows)) return
         name = ''
         if (size(study%free) > 1) name = trim(study%forces%drives(drive))//' '
         if (abs(last) <= none*greatest) then
            call add_line('Stands', name//'from '//plain_number(study%time(from))//' s', text)
         else
            call add_line('Steady speed', name//plain_number(last)// &
                          trim(merge(' length units/s', ' rad/s         ', problem%mechanism%actuators(drive)%slides))// &
                          ', within 1 per cent from '//plain_number(study%time(from))//' s', text)
         end if
      end subroutine summarise_end

      !> How many there are, and the frequencies of the stable ones.
      subroutine summarise_equilibria()
         integer :: k, m, stable

         associate (list => study%equilibria%list)
            stable = count([(list(k)%stable(), k=1, size(list))])
            words = to_text(size(list))//', '//to_text(stable)//' stable'
            if (study%equilibria%everywhere) words = 'everywhere: no force acts on the free drives'
            first = 0
            do k = 1, size(list)
               if (.not. list(k)%stable()) cycle
               do m = 1, size(list(k)%squares)
                  words = words//trim(merge(': ', ', ', first == 0))//' '//plain_number(sqrt(list(k)%squares(m)))
                  first = first + 1
               end do
            end do
            if (first > 0) words = words//' rad/s'
         end associate
         call add_line('Equilibria', words, text)
      end subroutine summarise_equilibria
   end subroutine summarise_time
end module psalm_time_list
