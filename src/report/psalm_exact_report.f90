!> Exact linkages in words: listing, device 7 with a case for each, device 9 with the block exact.
module psalm_exact_report
   use psalm_columns, only: right_column
   use psalm_data_set, only: data_set_t, title_columns
   use psalm_defects, only: class_names, exact_linkage_t
   use psalm_devices, only: devices_t, header_of
   use psalm_exact_group, only: exact_group_t, exact_of, exact_kinds
   use psalm_exact_study, only: exact_study_t, obeys_transmission, results_of, way_burmester, way_curves, way_generators, &
                                way_every_six_bar, way_guided, way_legs, way_minimax, way_nine, way_six_bars, &
                                way_subsets
   use psalm_exact_text, only: links_of_stephenson_2, links_of_stephenson_3, links_of_watt_2, write_generator, write_guided, &
                               write_linkage, write_six_bar
   use psalm_function_points, only: generator_t
   use psalm_guided_six_bars, only: body_names
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_number_format, only: error_words, figures_of, in_a_row, in_sentence, number_words
   use psalm_six_bar_motion, only: joints_of
   use psalm_six_bar_problem, only: number_name, stephenson_2, type_names, watt_2
   use psalm_six_bars, only: six_bar_joints
   use psalm_proof_list, only: shown
   use psalm_proof_study, only: proof_of_turn
   use psalm_tables, only: table_t, tables_t, table_of
   use psalm_text, only: text_t, rank_column, to_text
   implicit none (type, external)
   private
   public :: report_exact, write_case

   integer, parameter :: valid_classes = 2           !! the first classes of psalm_defects: linkages without a defect
   integer, parameter :: samples = 21                !! positions of a generator with the least largest error
   character(*), parameter :: none_listed = 'none of these linkages is listed: change a pose or point'
   real(wp), parameter :: poor_transmission = 10.0_wp !! degrees, below which the best linkage is doubted

contains

   !> What was found of a case.
   subroutine report_exact(set, study, devices)
      type(data_set_t), intent(in) :: set
      type(exact_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      type(exact_group_t) :: exact
      type(table_t) :: table

      exact = exact_of(set)
      call devices%six%add()
      call devices%six%add(' '//set%title)
      call devices%six%add()
      call devices%six%add(' EXACT SYNTHESIS: '//trim(exact_kinds(exact%kind)))
      call devices%eight%add(header_of('PSALM', devices%mark))
      call devices%eight%add(' '//set%title)
      call devices%eight%add(' &EXACT asks for linkages; there is no linkage to set up')
      if (exact%certify .and. .not. study%examined) call devices%remark(set, &
         'CERTIFY examines complete lists of solutions; there is none here')
      if (exact%has_least_transmission .and. .not. obeys_transmission(study)) call devices%remark(set, &
         'TRMIN has no effect here: it bounds four-bars, slider-cranks and six-bars that generate functions')
      if (study%flat > 0) call devices%six%add('  '//to_text(study%flat)//' linkages left out: transmission angle less than'// &
                                               in_sentence(.true., exact%least_transmission)//' (TRMIN)')
      if (study%stopped) call devices%note_violation()
      select case (study%way)
      case (way_generators)
         call report_generators(set, exact, study, devices)
      case (way_minimax)
         call report_minimax(set, exact, study, devices)
      case (way_six_bars)
         call report_six_bars(set, exact, study, devices)
      case (way_every_six_bar)
         call report_every_six_bar(set, exact, study, devices)
      case (way_subsets)
         call report_subsets(set, exact, study, devices)
      case (way_guided)
         call report_guided(set, exact, study, devices)
      case default
         call report_linkages(set, exact, study, devices)
      end select
      if (shown_of(set, study) == 0) then
         ! nothing of an earlier run stays
         call devices%seven%add('! '//trim(set%title)//': no linkage was found')
         table = list_of(set)
         call table%add('rank', [integer ::])
         call devices%cases(devices%last_case())%put(table)
      end if
      if (allocated(study%curve)) then
         if (size(study%curve) > 0) call put_curve_points(set, exact, study, devices%cases(devices%last_case()))
      end if
      if (allocated(study%proofs) .and. results_of(study) > 0) call report_proofs(set, study, devices)
   end subroutine report_exact

   !> Points of the curves of four poses: fixed pivot and, in the first pose, pin.
   subroutine put_curve_points(set, exact, study, tables)
      type(data_set_t), intent(in) :: set
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      complex(wp) :: first

      first = cmplx(exact%x(1), exact%y(1), wp)
      table = table_of('exact_curves', 'a row for each point of the curves of pivots', notes=set%title)
      call table%add('ray', study%curve%ray)
      call table%add('branch', study%curve%branch)
      call add_point('a', first + study%curve%dyad%pivot, table)
      call add_point('c', first + study%curve%dyad%pin, table)
      call tables%put(table)
   end subroutine put_curve_points

   !> What is proven of the motion of the results listed.
   subroutine report_proofs(set, study, devices)
      type(data_set_t), intent(in) :: set
      type(exact_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: line, turns
      type(table_t) :: table
      integer, allocatable :: known(:)
      integer :: i, unproven, skipped, count

      count = shown_of(set, study)
      call devices%six%add()
      call devices%six%add('  PROVEN OVER THE MOTION, CRANK ANGLES FROM THE FIRST POSITION')
      call devices%six%add('  RANK TURNS FULLY  CLOSES BETWEEN    CLOSES FROM             TO   TRANSMISSION')
      associate (proofs => study%proofs(:count))
         known = pack([(i, i=1, size(proofs))], proofs%known)
      end associate
      table = table_of('exact_proof', 'a row for each result whose motion is proven', notes=set%title)
      associate (proofs => study%proofs(known))
         call table%add('rank', known)
         call table%add('turns', proofs%turns, spread(set%limits%iproof == proof_of_turn, 1, size(known)))
         call table%add('closes', proofs%closes)
         call table%add('from', proofs%from, 'deg')
         call table%add('to', proofs%to, 'deg')
         call table%add('transmission', proofs%transmission, 'deg', proofs%transmits)
      end associate
      call devices%cases(devices%last_case())%put(table)
      unproven = 0
      skipped = 0
      do i = 1, count
         associate (own => study%proofs(i))
            if (.not. own%closes) unproven = unproven + 1
            if (own%known) then
               turns = word(own%turns, 12)
               ! of a part of a turn no other crank angles were looked at
               if (set%limits%iproof /= proof_of_turn) turns = repeat(' ', len(turns) - 1)//'-'
               line = rank_column(i)//turns//word(own%closes, 16)//in_column(shown(own%from, 1))//in_column(shown(own%to, -1))
               if (own%transmits) line = line//in_column(shown(own%transmission, -1))
               call devices%six%add(line)
            else if (own%skipped) then
               skipped = skipped + 1
               call devices%six%add(rank_column(i)//'  nothing: not examined')
            else
               call devices%six%add(rank_column(i)//'  nothing: different assemblies at the positions')
            end if
         end associate
      end do
      if (skipped > 0) then
         call devices%remark(set, reason_of(study)//': the motion of '//to_text(skipped)// &
                             ' of the linkages listed was not examined')
         call devices%note_violation()
      end if
      if (unproven > 0) call devices%remark(set, to_text(unproven)//' of the linkages listed'// &
                                            trim(merge(' is ', ' are', unproven == 1))// &
                                            ' not proven to close between the positions')
   end subroutine report_proofs

   !> Why not everything was done.
   pure function reason_of(study) result(text)
      type(exact_study_t), intent(in) :: study
      character(:), allocatable :: text

      text = 'stopped by request'
      if (study%out_of_time) text = 'stopped after MAXTIME'
   end function reason_of

   !> The verdict on the list: how many there can be, how many were found, whether that is all.
   function sentence_of(study) result(text)
      type(exact_study_t), intent(in) :: study
      character(:), allocatable :: text
      character(:), allocatable :: what
      integer :: at_infinity, missing

      ! of dyads those are among the ends
      at_infinity = merge(study%infinite, 0, study%way == way_nine .or. study%way == way_legs)
      what = 'ends'
      if (study%way == way_burmester) what = 'dyads'
      if (study%degenerate) then
         text = 'degenerate: the poses or points leave infinitely many linkages'
      else if (study%stopped) then
         text = 'not complete: '//reason_of(study)//', '//to_text(study%followed)//' of '// &
                to_text(max(study%paths, study%expected))//' paths followed'
      else if (study%symmetric) then
         text = 'not complete: infinitely many are symmetric as the points are; '//to_text(study%ends)//' of '// &
                to_text(study%expected)//' '//what//' distinct'//other_ends()
      else if (study%complete) then
         text = 'complete: '//to_text(study%ends)//' of '//to_text(study%expected)//' '//what//' distinct'
         ! of six-bars the real ones alone are examined
         if (study%examined .and. study%certificate%holds() .and. study%way /= way_every_six_bar) then
            text = text//', certified'
            if (study%certificate%examined < study%ends) text = text//' but those with a pivot at infinity'
         end if
         text = text//other_ends()
      else if (study%expected > 0 .and. study%ends > study%expected) then
         text = 'not complete: '//to_text(study%ends)//' ends, more than the '//to_text(study%expected)//' that there are'
      else if (study%expected > 0) then
         missing = study%expected - study%ends - study%merged - at_infinity
         if (missing > 0) then
            text = 'not complete: '//to_text(missing)//' of '//to_text(study%expected)//' '//what// &
                   ' missing (at infinity or singular)'
         else
            text = 'not complete: some of '//to_text(study%expected)//' '//what//' are not settled (at infinity or singular)'
         end if
      else
         text = 'the number of ends is not known for these conditions; '//to_text(study%ends)//' of '//to_text(study%generic)// &
                ' of a generic problem found'
      end if

   contains

      function other_ends() result(words)
         character(:), allocatable :: words

         words = ''
         if (at_infinity > 0) words = ', '//to_text(at_infinity)//' at infinity'
         if (study%singular > 0) words = words//', singular: '//to_text(study%singular)
         if (study%merged > 0) words = words//', '//to_text(study%merged)//' end where others do'
      end function other_ends
   end function sentence_of

   subroutine report_linkages(set, exact, study, devices)
      type(data_set_t), intent(in) :: set
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: line
      type(table_t) :: table
      complex(wp) :: far(2)
      complex(wp), allocatable :: far_sides(:), places(:, :)
      character(15), allocatable :: columns(:, :)
      integer :: i, k, shown

      associate (six => devices%six)
         if (study%way == way_curves) then
            call add_curves(exact, study, six)
         else
            call six%add('  '//sentence_of(study))
            line = '  '//to_text(study%real_ends)//' real, '//to_text(study%linkages)//' linkages'
            if (study%cognates) line = '  '//to_text(study%real_ends)//' real, with their cognates '// &
                                       to_text(study%linkages)//' linkages'
            if (study%infinite > 0 .and. study%way == way_burmester) line = line//'; '//to_text(study%infinite)// &
                                                                          ' with a pivot at infinity'
            call six%add(line)
            if (study%examined) call add_certificate(study, six)
            do k = 1, size(class_names)
               i = count(study%results%verdict%class == k)
               if (i > 0) call six%add('  '//repeat(' ', 6 - len(to_text(i)))//to_text(i)//' '//trim(class_names(k)))
            end do
         end if
         if (.not. study%complete .and. study%way /= way_curves) then
            call devices%remark(set, sentence_of(study))
            call devices%note_violation()
         end if
         shown = shown_of(set, study)
         if (shown == 0) then
            if (study%flat > 0) then
               call devices%remark(set, 'no linkage has a transmission angle of TRMIN or more: give a smaller one, or free '// &
                                        'something (fewer points or poses, no PIVOTS)')
            else if (study%stopped) then
               call devices%remark(set, 'no real linkage was found so far')
            else if (study%degenerate .and. study%way == way_curves) then
               call devices%remark(set, degenerate_curves(exact, study))
            else if (study%degenerate) then
               call devices%remark(set, none_listed)
            else
               call devices%remark(set, 'no real linkage passes these points')
            end if
            call devices%note_violation()
            return
         end if
         if (all(study%results(:shown)%verdict%class > valid_classes)) call devices%remark(set, 'every linkage listed has a '// &
            'defect: try other or fewer points or poses (four poses leave curves of pivots), other PIVOTS or none, a six-bar '// &
            '(ARM), or a search with these values as desired ones')
         call six%add()
         call six%add('  RANK CIRCUIT ORDER BRANCH CRANK   TRANSMISSION   LONGEST LINK    SENSITIVITY        CLOSURE')
         associate (own => study%results(:shown)%verdict)
            columns = in_columns(reshape([own%transmission, own%longest, own%sensitivity], [shown, 3]))
         end associate
         do i = 1, shown
            associate (own => study%results(i)%verdict)
               call six%add(rank_column(i)//word(own%circuit, 8)//word(own%order, 6)//word(own%branch, 7)// &
                            word(own%crank, 6)//in_a_row(columns(:, i))// &
                            right_column(error_words(.true., study%results(i)%closure), 15))
            end associate
         end do
         call six%add()
         call six%add('  RANK             A X            A Y            B X            B Y            C X            C Y'// &
                      '            D X            D Y')
         allocate (places(4, shown))
         do i = 1, shown
            associate (l => study%results(i)%linkage)
               far = far_side(l)
               places(:, i) = [l%a, far(1), l%c(1), far(2)]
            end associate
         end do
         call list_places(places, six)
      end associate
      table = list_of(set)
      associate (results => study%results(:shown), verdicts => study%results(:shown)%verdict)
         call table%add('rank', [(i, i=1, shown)])
         call table%add('circuit', verdicts%circuit)
         call table%add('order', verdicts%order)
         call table%add('branch', verdicts%branch)
         call table%add('crank', verdicts%crank)
         call table%add('transmission', verdicts%transmission, 'deg')
         call table%add('longest', verdicts%longest, 'length')
         call table%add('sensitivity', verdicts%sensitivity)
         far_sides = [(far_side(results(i)%linkage), i=1, shown)]
         call add_point('a', results%linkage%a, table)
         call add_point('b', far_sides(1::2), table)
         call add_point('c', [(results(i)%linkage%c(1), i=1, shown)], table)
         call add_point('d', far_sides(2::2), table)
      end associate
      call devices%cases(devices%last_case())%put(table)
      do i = 1, shown
         call devices%seven%add('! rank '//to_text(i)//': '//trim(class_names(study%results(i)%verdict%class)))
         call write_case(set, study, i, merge(set%limits%last, 0, i == shown), devices%seven)
      end do
   end subroutine report_linkages

   !> What is listed under B and D: pivot and pin; of a slider the direction of the slide and the pin, of a block its pivot and
   !> the direction of the coupler's line.
   pure function far_side(one) result(far)
      type(exact_linkage_t), intent(in) :: one
      complex(wp) :: far(2)

      far = [one%b, one%d(1)]
      if (one%slides) far(1) = one%guide
      if (one%swings) far(2) = one%guide
   end function far_side

   !> What the curves of three or four poses leave.
   subroutine add_curves(exact, study, six)
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(in) :: study
      type(text_t), intent(inout) :: six
      character(:), allocatable :: what
      complex(wp) :: place

      what = merge('slider-cranks                 ', 'cranks with a swinging block  ', exact%slider)
      what = trim(what)
      if (study%degenerate) then
         call six%add('  '//degenerate_curves(exact, study))
      else if (size(study%lines) == 0) then
         call six%add('  four poses leave curves of pivots: '//to_text(study%ends)//' points of them, '// &
                      to_text(study%linkages)//' four-bars, the best are listed')
      else if (size(study%lines) == 1) then
         place = cmplx(exact%x(1), exact%y(1), wp)
         if (exact%slider) then
            place = place + study%lines(1)%pin
            call six%add('  one point of the body is on a straight line in four poses:'//in_sentence(.true., real(place, wp))// &
                         in_sentence(.true., aimag(place)))
         else
            place = place + study%lines(1)%pivot
            call six%add('  one fixed point is on a straight line of the body in four poses:'// &
                         in_sentence(.true., real(place, wp))// &
                         in_sentence(.true., aimag(place)))
         end if
         call six%add('  and curves of pivots: '//to_text(study%ends)//' points of them, '//to_text(study%linkages)//' '// &
                      what//', the best are listed')
      else
         call six%add('  three poses and a pivot leave a circle of slides: '//to_text(size(study%lines))//' points of it, '// &
                      to_text(study%linkages)//' '//what//', the best are listed')
      end if
   end subroutine add_curves

   !> What Krawczyk's test proves.
   subroutine add_certificate(study, six)
      type(exact_study_t), intent(in) :: study
      type(text_t), intent(inout) :: six

      associate (c => study%certificate)
         call six%add('  certified: '//to_text(c%proven)//' of '//to_text(c%examined)//' exist, '//to_text(c%apart)// &
                      ' apart from all others; '//to_text(c%real_ones)//' of '//to_text(study%real_ends)//' are real, '// &
                      to_text(c%not_real)//' are not')
         if (.not. c%holds()) call six%add('  of the others nothing is proven: they are singular, or nearly so')
      end associate
   end subroutine add_certificate

   !> Why three or four poses leave no curves.
   pure function degenerate_curves(exact, study) result(text)
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(in) :: study
      character(:), allocatable :: text

      if ((exact%slider .or. exact%block) .and. size(study%lines) == 0) then
         text = 'degenerate: no single point is on a straight line in these poses, or a whole line of them'
      else if (size(exact%x) == 3) then
         text = 'degenerate: no pin goes with this pivot'
      else
         text = 'degenerate: the curves of the four poses cannot be drawn from a pole'
      end if
   end function degenerate_curves

   subroutine report_generators(set, exact, study, devices)
      type(data_set_t), intent(in) :: set
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      type(table_t) :: table
      character(15), allocatable :: columns(:, :)
      integer :: k

      call devices%six%add('  '//sentence_of(study))
      call devices%six%add('  '//to_text(study%real_ends)//' real')
      if (study%examined) call add_certificate(study, devices%six)
      if (.not. study%complete) then
         call devices%remark(set, sentence_of(study))
         call devices%note_violation()
      end if
      if (study%generators%count == 0) then
         if (study%degenerate) then
            call devices%remark(set, none_listed)
         else
            call devices%remark(set, 'no real linkage passes these points')
         end if
         call devices%note_violation()
         return
      end if
      call devices%six%add()
      call devices%six%add(head_of(study%wanted%slides)//'  ASSEMBLY')
      associate (found => study%generators%list(:study%generators%count))
         table = list_of(set)
         call table%add('rank', [(k, k=1, size(found))])
         call table%add('assembly', found%assembly)
         call add_generators(found, table)
         call table%add('opens', found%opens)
         call devices%cases(devices%last_case())%put(table)
      end associate
      columns = columns_of(study%generators%list(:study%generators%count), exact%frame)
      do k = 1, study%generators%count
         associate (one => study%generators%list(k))
            call devices%six%add(rank_column(k)//in_a_row(columns(:, k))//'  '//assembly_word(one))
            call devices%seven%add('! rank '//to_text(k)//': assembly '//assembly_word(one))
            call write_case(set, study, k, merge(set%limits%last, 0, k == study%generators%count), devices%seven)
         end associate
      end do
   end subroutine report_generators

   subroutine report_minimax(set, exact, study, devices)
      type(data_set_t), intent(in) :: set
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      type(table_t) :: table
      character(15), allocatable :: columns(:, :), error(:, :)
      character(:), allocatable :: unit
      integer :: k, shown

      unit = trim(merge('per cent of the travel', 'degrees               ', study%wanted%slides))
      call devices%six%add('  largest error least: '//to_text(size(study%approximations))//' local optima; errors in '//unit)
      if (study%too_long > 0) call devices%six%add('  '//to_text(study%too_long)//' starts ran to links longer than RLONG')
      shown = shown_of(set, study)
      if (shown == 0) then
         call devices%remark(set, 'no linkage was found whose errors alternate')
         call devices%note_violation()
         return
      end if
      call devices%six%add()
      call devices%six%add(head_of(study%wanted%slides)//'          ERROR  SENSE  ALTERNATES')
      associate (best => study%approximations(:shown))
         table = list_of(set)
         call table%add('rank', [(k, k=1, shown)])
         call table%add('error', best%error, trim(merge('percent', 'deg    ', study%wanted%slides)))
         call table%add('sense', best%sense)
         call table%add('alternates', best%alternates)
         call add_generators(best%linkage, table)
         call devices%cases(devices%last_case())%put(table)
      end associate
      columns = columns_of(study%approximations(:shown)%linkage, exact%frame)
      error = in_columns(reshape(study%approximations(:shown)%error, [shown, 1]))
      do k = 1, shown
         associate (best => study%approximations(k))
            call devices%six%add(rank_column(k)//in_a_row(columns(:, k))//error(1, k)//'     '// &
                                 merge('+', '-', best%sense > 0)//'  '//word(best%alternates, 10))
            call devices%seven%add('! rank '//to_text(k)//': largest error '//number_words(best%error)//' '//unit)
            call write_case(set, study, k, merge(set%limits%last, 0, k == shown), devices%seven)
         end associate
      end do
   end subroutine report_minimax

   !> Four-bars refined over more points than can be met.
   subroutine report_subsets(set, exact, study, devices)
      type(data_set_t), intent(in) :: set
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      type(table_t) :: table
      character(15), allocatable :: columns(:, :)
      integer :: i, shown

      associate (found => study%subsets, six => devices%six)
         call six%add('  '//to_text(found%sets)//' sets of nine points, '//to_text(found%complete)//' of them with all '// &
                      'four-bars; '//to_text(found%starts)//' starts with a turning crank')
         if (found%stopped) then
            call six%add('  not complete: '//reason_of(study)//', '//to_text(exact%subsets)//' sets were asked for')
            call devices%remark(set, reason_of(study)//': '//to_text(found%sets)//' of '//to_text(exact%subsets)// &
                                ' sets of nine points searched')
         end if
         shown = shown_of(set, study)
         if (shown == 0 .and. study%flat > 0) then
            call devices%remark(set, 'no linkage has a transmission angle of TRMIN or more: give a smaller one, '// &
                                'or search with these points as desired ones (IFREE=1), which keeps TRMIN')
            call devices%note_violation()
            return
         else if (shown == 0 .and. found%stopped) then
            call devices%remark(set, 'no linkage was found so far')
            return
         else if (shown == 0) then
            call devices%remark(set, 'no four-bar through nine of these points has a crank that turns')
            call devices%note_violation()
            return
         end if
         call six%add()
         call six%add('  RANK ORDER   DISTANCE RMS   BEFORE REFINED   TRANSMISSION   LONGEST LINK    SENSITIVITY')
         associate (r => found%results(:shown))
            columns = in_columns(reshape([r%after, r%before, r%verdict%transmission, r%verdict%longest, r%verdict%sensitivity], &
                                         [shown, 5]))
         end associate
         do i = 1, shown
            call six%add(rank_column(i)//word(found%results(i)%verdict%order, 6)//columns(1, i)//'  '//in_a_row(columns(2:, i)))
         end do
         associate (least => found%results(1)%verdict%transmission)
            if (least < poor_transmission .and. .not. exact%has_least_transmission) call devices%remark(set, 'the best linkage '// &
               'has a transmission angle of'//in_sentence(.true., least)//' degrees: leave such ones out by TRMIN, or search '// &
               'with these points as desired ones (IFREE=1), which keeps TRMIN')
         end associate
         table = list_of(set)
         associate (results => found%results(:shown), verdicts => found%results(:shown)%verdict)
            call table%add('rank', [(i, i=1, shown)])
            call table%add('order', verdicts%order)
            call table%add('distance', results%after, 'length')
            call table%add('before', results%before, 'length')
            call table%add('transmission', verdicts%transmission, 'deg')
            call table%add('longest', verdicts%longest, 'length')
            call table%add('sensitivity', verdicts%sensitivity)
            call add_point('a', results%linkage%a, table)
            call add_point('b', results%linkage%b, table)
            call add_point('c', [(results(i)%linkage%c(1), i=1, shown)], table)
            call add_point('d', [(results(i)%linkage%d(1), i=1, shown)], table)
         end associate
         call devices%cases(devices%last_case())%put(table)
         do i = 1, shown
            call devices%seven%add('! rank '//to_text(i)//': distance '//number_words(found%results(i)%after))
            call write_case(set, study, i, merge(set%limits%last, 0, i == shown), devices%seven)
         end do
      end associate
   end subroutine report_subsets

   !> Six-bars: joints at the first point.
   subroutine report_six_bars(set, exact, study, devices)
      type(data_set_t), intent(in) :: set
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      complex(wp), allocatable :: joints(:, :)
      type(table_t) :: table
      integer :: k, shown

      associate (found => study%six_bars, six => devices%six)
         call six%add('  '//to_text(found%drivers)//' drivers close, '//to_text(found%linkages)//' closing linkages, '// &
                      to_text(found%valid)//' stay assembled on one branch')
         if (found%stopped) then
            call six%add('  not complete: '//reason_of(study)//', '//to_text(found%tried)//' of '//to_text(found%planned)// &
                         ' drivers of the grid tried')
            call devices%remark(set, reason_of(study)//': '//to_text(found%tried)//' of '//to_text(found%planned)// &
                                ' drivers of the grid tried')
         end if
         shown = shown_of(set, study)
         if (shown == 0 .and. found%stopped) then
            call devices%remark(set, 'no linkage was found so far')
            return
         else if (shown == 0) then
            if (found%valid > 0) then
               call devices%remark(set, 'no six-bar of this grid is left: '//left_out(found%too_long, found%flat))
            else if (found%too_long > 0) then
               call devices%remark(set, 'no six-bar of this grid meets the points on one branch; not looked at: '// &
                                   left_out(found%too_long, 0))
            else
               call devices%remark(set, 'no six-bar of this grid meets the points on one branch')
            end if
            call devices%note_violation()
            return
         end if
         allocate (joints(7, shown))
         do k = 1, shown
            joints(:, k) = exact%frame*six_bar_joints(found%best(k), study%phi(1))
         end do
         associate (best => found%best(:shown))
            call list_six_bars(set, study, best%transmission, best%longest, best%error, joints, devices, table)
         end associate
         call devices%cases(devices%last_case())%put(table)
      end associate
   end subroutine report_six_bars

   !> All six-bars through the points of a function.
   subroutine report_every_six_bar(set, exact, study, devices)
      type(data_set_t), intent(in) :: set
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      complex(wp), allocatable :: joints(:, :)
      type(table_t) :: table
      character(:), allocatable :: about
      integer :: i, k, shown

      about = ''
      if (.not. study%every%certain) about = 'about '
      associate (every => study%every, six => devices%six)
         call six%add('  '//trim(type_names(every%problem%type))//' through '//to_text(every%problem%points + 1)//' points')
         if (study%stopped .and. study%paths == 0 .and. every%known < every%expected) then
            call six%add('  not complete: '//reason_of(study)//' while the start set was made, '//to_text(every%known)//' of '// &
                         about//to_text(every%expected)//' solutions known')
         else
            call six%add('  '//sentence_of(study))
            if (every%found%lost_far + every%found%lost_near > 0) call six%add('  paths lost: '// &
               to_text(every%found%lost_far)//' far away, '//to_text(every%found%lost_near)//' at singular places')
            call six%add('  '//to_text(study%real_ends)//' real; without a defect: '//to_text(every%by_input)// &
                         ' driven at the input, '//to_text(every%by_output)//' at the output')
            if (study%examined) then
               associate (own => study%certificate)
                  call six%add('  certified: of '//to_text(own%examined)//' real ones '//to_text(own%proven)//' exist, '// &
                               to_text(own%apart)//' apart from all others, '//to_text(own%real_ones)//' are real')
               end associate
            end if
            if (study%wanted%continuous) call six%add('  '//to_text(every%over_range)//' reach both ends of the range')
            if (every%too_long > 0) call six%add('  '//to_text(every%too_long)//' left out: a link longer than RLONG')
            if (every%flat > 0) call six%add('  '//to_text(every%flat)//' left out: transmission angle less than'// &
                                             in_sentence(.true., exact%least_transmission)//' (TRMIN)')
            if (every%minimax) call six%add('  largest error made less: '//to_text(size(every%best))//' linkages, '// &
                                            to_text(count(every%best%alternates))//' of them local optima; '// &
                                            to_text(every%unrefined)//' exact ones lead to none')
         end if
         if (.not. study%complete) then
            call devices%remark(set, sentence_of(study))
            call devices%note_violation()
         end if
         shown = shown_of(set, study)
         if (shown == 0 .and. study%stopped) then
            call devices%remark(set, 'no linkage was found so far')
            return
         else if (shown == 0) then
            if (every%over_range > 0) then
               call devices%remark(set, 'no six-bar that meets the points on one branch is left: '// &
                                   left_out(every%too_long, every%flat))
            else if (every%by_input > 0) then
               call devices%remark(set, 'no six-bar that meets the points on one branch reaches both ends of the range')
            else
               call devices%remark(set, 'no six-bar meets the points on one branch')
            end if
            call devices%note_violation()
            return
         end if
         allocate (joints(7, shown))
         do k = 1, shown
            joints(:, k) = exact%frame*joints_of(every%problem, every%best(k), third_pivot(exact))
         end do
         associate (best => every%best(:shown))
            call list_six_bars(set, study, best%transmission, best%longest, best%error, joints, devices, table, best%by_output)
            if (every%minimax) then
               call table%add('before', best%before*degrees_per_radian, 'deg')
               call table%add('alternates', best%alternates)
            end if
            do i = 1, every%problem%unknowns
               call table%add('number_'//number_name(i, every%problem%type)//'x', real(best%x(i), wp))
               call table%add('number_'//number_name(i, every%problem%type)//'y', aimag(best%x(i)))
            end do
         end associate
         call devices%cases(devices%last_case())%put(table)
      end associate
   end subroutine report_every_six_bar

   !> Links of a type of six-bar as a sketch has them.
   pure function links_of(type) result(links)
      integer, intent(in) :: type
      character(len(links_of_watt_2)) :: links

      select case (type)
      case (watt_2)
         links = links_of_watt_2
      case (stephenson_2)
         links = links_of_stephenson_2
      case default
         links = links_of_stephenson_3
      end select
   end function links_of

   !> Where the third fixed pivot of Watt II is drawn, over the frame from A.
   pure complex(wp) function third_pivot(exact)
      type(exact_group_t), intent(in) :: exact

      third_pivot = (2.0_wp, 0.0_wp)
      if (exact%crank_pivot) third_pivot = cmplx(exact%pivots(1), exact%pivots(2), wp)/exact%frame
   end function third_pivot

   !> What has removed six-bars.
   pure function left_out(too_long, flat) result(text)
      integer, intent(in) :: too_long, flat
      character(:), allocatable :: text

      text = ''
      if (too_long > 0) text = to_text(too_long)//' with a link longer than RLONG'
      if (too_long > 0 .and. flat > 0) text = text//', '
      if (flat > 0) text = text//to_text(flat)//' with a transmission angle less than TRMIN'
   end function left_out

   !> Ranked six-bars in the listing, as cases on device 7 and as a table.
   subroutine list_six_bars(set, study, transmission, longest, error, joints, devices, table, by_output)
      type(data_set_t), intent(in) :: set
      type(exact_study_t), intent(in) :: study
      real(wp), intent(in) :: transmission(:), longest(:), error(:) !! degrees, length, radians
      complex(wp), intent(in) :: joints(:, :)       !! at the first point: A to E, G, H; shape (7, six-bars)
      type(devices_t), intent(inout) :: devices
      type(table_t), intent(out) :: table
      logical, intent(in), optional :: by_output(:) !! without a defect driven at the output, too
      character(*), parameter :: names(3:7) = ['c', 'd', 'e', 'g', 'h']
      character(15), allocatable :: columns(:, :)
      character(:), allocatable :: line
      integer :: i, k, shown
      logical :: with_error

      shown = size(error)
      ! a table wants its entries only: where they are met there is no error
      with_error = study%wanted%continuous .or. study%every%minimax
      associate (six => devices%six)
         call six%add()
         line = '  RANK   TRANSMISSION   LONGEST LINK'
         if (with_error) line = line//'     ERROR (DEG)'
         if (study%every%minimax) line = line//'        AS EXACT  ALTERNATES'
         if (present(by_output)) line = line//'  DRIVEN AT'
         call six%add(line)
         if (study%every%minimax) then
            columns = in_columns(reshape([transmission, longest, error*degrees_per_radian, &
                                          study%every%best(:shown)%before*degrees_per_radian], [shown, 4]))
         else
            columns = in_columns(reshape([transmission, longest, error*degrees_per_radian], [shown, 3]))
         end if
         do k = 1, shown
            line = rank_column(k)//in_a_row(columns(:2, k))
            if (with_error) line = line//' '//columns(3, k)
            if (study%every%minimax) line = line//' '//columns(4, k)//'  '//word(study%every%best(k)%alternates, 10)
            if (present(by_output)) line = line//'  '//trim(merge('either', 'input ', by_output(k)))
            call six%add(line)
         end do
         call six%add()
         call six%add('  RANK  JOINTS C, D, E, G, H: X, Y')
         call list_places(joints(3:, :), six)
         do k = 1, shown
            call devices%seven%add('! rank '//to_text(k)//': least transmission angle '// &
                                   number_words(transmission(k))//' degrees')
            call write_case(set, study, k, merge(set%limits%last, 0, k == shown), devices%seven)
         end do
      end associate
      table = list_of(set)
      call table%add('rank', [(k, k=1, shown)])
      call table%add('transmission', transmission, 'deg')
      call table%add('longest', longest, 'length')
      if (with_error) call table%add('error', error*degrees_per_radian, 'deg')
      do i = 3, size(joints, 1)
         call add_point(names(i), joints(i, :), table)
      end do
   end subroutine list_six_bars

   !> How many results are listed.
   pure integer function shown_of(set, study)
      type(data_set_t), intent(in) :: set
      type(exact_study_t), intent(in) :: study
      type(exact_group_t) :: exact

      exact = exact_of(set)
      shown_of = min(results_of(study), exact%listed)
   end function shown_of

   !> Append a result as a case with a sketch.
   subroutine write_case(set, study, rank, last, text)
      type(data_set_t), intent(in) :: set
      type(exact_study_t), intent(in) :: study
      integer, intent(in) :: rank, last              !! LAST of the case
      type(text_t), intent(inout) :: text
      type(exact_group_t) :: exact
      character(:), allocatable :: title
      real(wp) :: phi(samples), psi(samples)
      integer :: i

      exact = exact_of(set)
      title = title_of(set, rank)
      select case (study%way)
      case (way_generators)
         call write_generator(title, study%generators%list(rank), exact%frame, study%phi, study%psi, last, text)
      case (way_minimax)
         associate (best => study%approximations(rank))
            do i = 1, samples
               phi(i) = study%wanted%input_at(real(i - 1, wp)/real(samples - 1, wp))
               psi(i) = study%wanted%output_at(real(i - 1, wp)/real(samples - 1, wp))*real(best%sense*study%wanted%sense, wp)
            end do
            call write_generator(title, best%linkage, exact%frame, phi, psi, last, text)
         end associate
      case (way_six_bars)
         associate (one => study%six_bars%best(rank))
            call write_six_bar(title, merge(links_of_watt_2, links_of_stephenson_3, one%watt), &
                               exact%frame*six_bar_joints(one, study%phi(1)), study%phi, last, text)
         end associate
      case (way_every_six_bar)
         associate (every => study%every)
            associate (joints => exact%frame*joints_of(every%problem, every%best(rank), third_pivot(exact)))
               if (every%minimax .and. study%wanted%continuous) then
                  call write_six_bar(title, links_of(every%problem%type), joints, &
                                     study%wanted%input_at([(real(i - 1, wp)/real(samples - 1, wp), i=1, samples)]), last, text)
               else
                  call write_six_bar(title, links_of(every%problem%type), joints, study%phi, last, text)
               end if
            end associate
         end associate
      case (way_subsets)
         call write_linkage(title, study%subsets%results(rank)%linkage, exact, last, text)
      case (way_guided)
         call write_guided(title, study%guided%list(rank), exact, last, text)
      case default
         call write_linkage(title, study%results(rank)%linkage, exact, last, text)
      end select
   end subroutine write_case

   !> Six-bars of a chain and two links: between which bodies, and their joints in the first pose.
   subroutine report_guided(set, exact, study, devices)
      type(data_set_t), intent(in) :: set
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      complex(wp) :: first
      complex(wp), allocatable :: places(:, :)
      character(15), allocatable :: columns(:, :)
      type(table_t) :: table
      character(*), parameter :: names(2, 2) = reshape(['g', 'w', 'h', 'k'], [2, 2])
      character(:), allocatable :: line
      integer :: k, i, shown

      associate (found => study%guided, six => devices%six)
         call six%add('  '//to_text(found%pairs)//' six-bars, '//to_text(found%valid)// &
                      ' of them come from the first pose to all others')
         shown = shown_of(set, study)
         if (found%valid == 0) then
            call devices%remark(set, 'no six-bar of this chain comes from the first pose to all others')
            call devices%note_violation()
         end if
         if (shown == 0) return
         first = cmplx(exact%x(1), exact%y(1), wp)
         call six%add()
         call six%add('  RANK SOUND   FASTEST LINK   LONGEST LINK  FIRST LINK     SECOND LINK')
         columns = in_columns(reshape([found%list(:shown)%fastest, found%list(:shown)%longest], [shown, 2]))
         do k = 1, shown
            associate (one => found%list(k))
               call six%add(rank_column(k)//word(one%valid, 6)//in_a_row(columns(:, k))//'  '// &
                            between(one%links(1)%from, one%links(1)%to)//'  '//between(one%links(2)%from, one%links(2)%to))
            end associate
         end do
         call six%add()
         call six%add('  RANK  ENDS OF BOTH LINKS G, W AND H, K: X, Y')
         table = list_of(set)
         associate (list => found%list(:shown))
            call table%add('rank', [(k, k=1, shown)])
            call table%add('sound', list%valid)
            call table%add('fastest', list%fastest)
            call table%add('longest', list%longest, 'length')
            do i = 1, 2
               call table%add('from'//to_text(i), list%links(i)%from)
               call table%add('to'//to_text(i), list%links(i)%to)
            end do
            do i = 1, 2
               call add_point(names(1, i), first + list%links(i)%pivot, table)
               call add_point(names(2, i), first + list%links(i)%pin, table)
            end do
         end associate
         call devices%cases(devices%last_case())%put(table)
         allocate (places(4, shown))
         do k = 1, shown
            associate (one => found%list(k))
               places(:, k) = first + [(one%links(i)%pivot, one%links(i)%pin, i=1, 2)]
            end associate
         end do
         call list_places(places, six)
         do k = 1, shown
            line = '! rank '//to_text(k)
            if (.not. found%list(k)%valid) line = line//': it does not come to all poses'
            call devices%seven%add(line)
            call write_case(set, study, k, merge(set%limits%last, 0, k == shown), devices%seven)
         end do
      end associate

   contains

      !> Two bodies as a column.
      pure function between(from, to) result(column)
         integer, intent(in) :: from, to
         character(13) :: column

         column = trim(body_names(from))//' - '//trim(body_names(to))
      end function between
   end subroutine report_guided

   function title_of(set, rank) result(title)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: rank
      character(:), allocatable :: title

      title = ', RANK '//to_text(rank)
      title = trim(set%title(:min(len(set%title), title_columns - len(title))))//title
   end function title_of

   !> Heading of the numbers of a function generator.
   function head_of(slides) result(text)
      logical, intent(in) :: slides
      character(:), allocatable :: text

      if (slides) then
         text = '  RANK           CRANK        COUPLER         OFFSET           PHI0      SLIDE AT 0'
      else
         text = '  RANK           CRANK        COUPLER       FOLLOWER           PHI0           PSI0'
      end if
   end function head_of

   !> The numbers of function generators as columns; shape (5, linkages).
   pure function columns_of(list, frame) result(columns)
      type(generator_t), intent(in) :: list(:)
      real(wp), intent(in) :: frame
      character(15) :: columns(5, size(list))
      real(wp), dimension(size(list)) :: scale, zero

      scale = merge(1.0_wp, frame, list%slides)
      zero = merge(-list%psi0, list%psi0*degrees_per_radian, list%slides)
      columns = in_columns(reshape([scale*list%r2, scale*list%r3, scale*list%r4, list%phi0*degrees_per_radian, zero], &
                                   [size(list), 5]))
   end function columns_of

   !> Numbers of a list as columns, as those of sketches: every linkage found is one. Shape (columns, linkages).
   pure function in_columns(values) result(columns)
      real(wp), intent(in) :: values(:, :)      !! shape (linkages, columns)
      character(15) :: columns(size(values, 2), size(values, 1))
      integer :: c

      do c = 1, size(values, 2)
         columns(c, :) = figures_of(.true., values(:, c), all_count=.true.)
      end do
   end function in_columns

   !> A row for each linkage: x and y of its joints.
   subroutine list_places(places, six)
      complex(wp), intent(in) :: places(:, :)   !! shape (joints, linkages)
      type(text_t), intent(inout) :: six
      character(15) :: columns(2*size(places, 1), size(places, 2))
      integer :: j, k

      do j = 1, size(places, 1)
         columns(2*j - 1, :) = figures_of(.true., real(places(j, :), wp))
         columns(2*j, :) = figures_of(.true., aimag(places(j, :)))
      end do
      do k = 1, size(places, 2)
         call six%add(rank_column(k)//in_a_row(columns(:, k)))
      end do
   end subroutine list_places

   !> Columns of function generators: lengths over the frame, of a slider-crank of the user.
   pure subroutine add_generators(list, table)
      type(generator_t), intent(in) :: list(:)
      type(table_t), intent(inout) :: table
      character(:), allocatable :: length, place

      length = ''
      place = 'rad'
      if (any(list%slides)) then
         length = 'length'
         place = length
      end if
      call table%add('r2', list%r2, length)
      call table%add('r3', list%r3, length)
      call table%add('r4', list%r4, length)
      call table%add('phi0', list%phi0, 'rad')
      call table%add('psi0', list%psi0, place)
   end subroutine add_generators

   !> The table of the results, without columns.
   pure function list_of(set) result(table)
      type(data_set_t), intent(in) :: set
      type(table_t) :: table

      table = table_of('exact', 'a row for each linkage listed', notes=set%title)
   end function list_of

   function word(valid, width) result(text)
      logical, intent(in) :: valid
      integer, intent(in) :: width
      character(:), allocatable :: text

      text = repeat(' ', width - 3)//merge('yes', ' no', valid)
   end function word

   !> The assembly of a function generator, and whether it cannot be moved from point to point.
   function assembly_word(one) result(text)
      type(generator_t), intent(in) :: one
      character(:), allocatable :: text

      select case (one%assembly)
      case (1)
         text = '+'
      case (-1)
         text = '-'
      case default
         text = 'changes between the points'
      end select
      if (one%opens .and. one%assembly /= 0) text = text//', opens between the points'
   end function assembly_word

   !> A number, rounded already, at the end of a column.
   pure function in_column(number) result(text)
      character(*), intent(in) :: number
      character(15) :: text

      text = number
      text = adjustr(text)
   end function in_column

   !> Two columns of a joint.
   pure subroutine add_point(name, places, table)
      character(*), intent(in) :: name
      complex(wp), intent(in) :: places(:)
      type(table_t), intent(inout) :: table

      call table%add(name//'x', real(places, wp), 'length')
      call table%add(name//'y', aimag(places), 'length')
   end subroutine add_point
end module psalm_exact_report
