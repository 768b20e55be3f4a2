!> The library as another program uses it: one module, no file, findings in place of failures.
program test_library
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use check, only: checks_t
   use psalm, only: find_forces, force_study_t, report_t, study, verbs
   use psalm, only: wp, case_t, analysis_t, wanted_t, synthesis_t, rate_study_t, tolerances_t, findings_t, ending_t, stop_t, &
                    new_case, read_file, read_text, analyse, synthesise, found_case, find_rates, find_tolerances, minimise, &
                    output_slide, output_point, ended_converged, ended_iterations, ended_on_request, ended_starts, &
                    ended_unmade
   use stopping_host, only: host_t
   use textbook, only: rosenbrock_t, rosen_suzuki_t, rosenbrock, rosen_suzuki
   implicit none (type, external)
   character, parameter :: nl = new_line('a')
   character(*), parameter :: links = ' &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4,'//nl//'  ILOOP=1,0,-4,1,'//nl// &
                              '  ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0,'//nl//'  NOUTLK=3,'//nl//'  NOUTLP=1 &END'//nl
   character(*), parameter :: method = ' &METHOD MOTION=3, IKIN=15 &END'//nl
   real(wp), parameter :: crank = 40.0_wp, rod = 140.0_wp, offset = 10.0_wp
   type(checks_t) :: t

   call in_memory()
   call from_text()
   call places()
   call incomplete()
   call changed()
   call rates()
   call units_of_speed()
   call searched()
   call searched_in_poses()
   call simplex()
   call ended()
   call own_problem()
   call tolerances()
   call forces_of_sketch()
   call sketch_in_memory()
   call opened()
   call texts()
   call every_verb()
   call t%report()

contains

   !> The slider-crank of the README.
   function slider_crank() result(case)
      type(case_t) :: case

      case = new_case('OFFSET SLIDER-CRANK')
      call case%add_loop([1, -2, 3, 4], [1, 0, -4, 1], [crank, rod, 0.0_wp, offset], [0.0_wp, 0.0_wp, 0.0_wp, 270.0_wp])
      call case%set_output(output_slide, arc=3, loop=1)
      call case%set_turn(15)
   end function slider_crank

   !> Its slide by the theorem of Pythagoras.
   elemental real(wp) function slide(degrees, radius)
      real(wp), intent(in) :: degrees, radius
      real(wp) :: angle

      angle = degrees*acos(-1.0_wp)/180.0_wp
      slide = radius*cos(angle) + sqrt(rod**2 - (radius*sin(angle) - offset)**2)
   end function slide

   subroutine in_memory()
      type(analysis_t), save :: analysis
      type(findings_t), save :: findings
      type(report_t), save :: report

      call analyse(slider_crank(), analysis, findings, report=report)
      call t%equal_integer(findings%count, 0, 'a case made in memory: no findings')
      call t%equal_integer(size(analysis%motion%input), 24, 'a turn in steps of 15 degrees')
      call t%close_to(maxval(abs(analysis%motion%actual(:, 1) - slide(analysis%motion%input, crank))), 0.0_wp, 1.0e-12_wp, &
                      'a case made in memory: the slide is that of a right triangle')
      call t%is_true(.not. analysis%is_violating() .and. all(analysis%motion%closed), 'it closes everywhere')
      call t%is_true(index(report%listing, '179.6424') > 0, 'its listing')
   end subroutine in_memory

   !> From text, from a file, in memory: the same bits.
   subroutine from_text()
      type(case_t), save :: made
      type(case_t), allocatable, save :: of_text(:), of_file(:), again(:)
      type(analysis_t), save :: one, two, three, four
      type(findings_t), save :: findings

      call read_text('OFFSET SLIDER-CRANK'//nl//links//method, of_text, findings)
      call read_file('data/dyad4_slider_crank.nml', of_file, findings)
      call t%is_true(size(of_text) == 1 .and. size(of_file) == 1, 'one case each')
      call t%equal_text(of_text(1)%title(), 'OFFSET SLIDER-CRANK', 'the title')
      call t%is_true(of_text(1)%loops() == 1 .and. of_text(1)%arcs(1) == 4, 'a loop of four arcs')
      call analyse(of_text(1), one, findings)
      call analyse(of_file(1), two, findings)
      made = slider_crank()
      call analyse(made, three, findings)
      call read_text(made%text(), again, findings)
      call analyse(again(1), four, findings)
      call t%equal_integer(findings%count, 0, 'no findings')
      call t%is_true(all(abs(one%motion%actual - two%motion%actual) <= 0.0_wp), 'text and file: the same bits')
      call t%is_true(all(abs(one%motion%actual - three%motion%actual) <= 0.0_wp), 'text and memory: the same bits')
      call t%is_true(all(abs(one%motion%actual - four%motion%actual) <= 0.0_wp), 'memory written and read: the same bits')
   end subroutine from_text

   !> Findings name the line of the text.
   subroutine places()
      type(case_t), allocatable, save :: cases(:)
      type(analysis_t), save :: analysis
      type(findings_t), save :: findings
      integer :: at

      at = index(links, 'NOUTLK=3')
      call read_text('A TITLE'//nl//links(:at + 6)//'9'//links(at + 8:)//method, cases, findings, name='engine')
      call t%equal_integer(findings%count, 0, 'an arc that is not there is found by a study')
      call analyse(cases(1), analysis, findings)
      call t%is_true(findings%failed() .and. findings%count == 1, 'one error')
      if (findings%count /= 1) return
      call t%equal_integer(findings%list(1)%line, 5, 'its line')
      call t%equal_text(findings%list(1)%item, 'NOUTLK', 'its item')
      call t%is_true(index(findings%list(1)%render(), 'engine:5: error: &LINKS NOUTLK: ') == 1, 'the finding in words', &
                     findings%list(1)%render())
   end subroutine places

   !> Whatever is missing or wrong comes back as a finding; results are empty.
   subroutine incomplete()
      type(case_t), save :: empty, some
      type(case_t), allocatable, save :: cases(:)
      type(findings_t), save :: findings, taken
      real(wp) :: none(0)

      call refused(empty, 'the case is empty', 'an empty case')
      call empty%set_item('LIMITS', 'TANGLE', 50.0_wp)
      call refused(empty, 'begin with new_case', 'an item of an empty case')
      call refused(new_case(), 'NLOOP', 'a case without loops')
      some = new_case('NO OUTPUT')
      call some%add_loop([1, -2, 3, 4], [1, 0, -4, 1])
      call refused(some, 'NOUTLK', 'a case without output')
      some = new_case('NO LENGTHS')
      call some%add_loop([1, -2, 3, 4], [1, 0, -4, 1])
      call some%set_output(output_slide, 3, 1)
      call some%set_turn(15)
      call refused(some, 'ARCL', 'a case without lengths')
      some = slider_crank()
      call some%add_loop([1, -2, 3], [1, 0, -4, 1])
      call refused(some, 'as many values', 'arrays of different size')
      some = slider_crank()
      call some%add_loop([1, -2, 3], [1, 0, 1], [ieee_value(1.0_wp, ieee_quiet_nan), 1.0_wp, 1.0_wp])
      call refused(some, 'loop 2: every length and angle must be a finite number', 'a length that is no number')
      some = slider_crank()
      call some%set_output(output_slide, 7, 3)
      call refused(some, 'NOUTL', 'an output that is not there')
      some = slider_crank()
      call some%set_turn(0)
      call refused(some, 'NDES', 'no input positions')
      call some%set_positions(none)
      call refused(some, 'NDES', 'input positions, but none')
      some = slider_crank()
      call some%set_item('LIMITS', 'TANGEL', 50.0_wp)
      call refused(some, "did you mean TANGLE?", 'an item that is not there')
      some = slider_crank()
      call some%set_item('LIMITZ', 'TANGLE', 50.0_wp)
      call refused(some, 'LIMITS', 'a group that is not there')
      some = slider_crank()
      call some%set_item('METHOD', 'CRNKI', ieee_value(1.0_wp, ieee_quiet_nan))
      call refused(some, 'CRNKI', 'a value that is no number')
      some = slider_crank()
      call some%set_length(1, 2, ieee_value(1.0_wp, ieee_positive_inf))
      call refused(some, 'finite', 'an infinite length')
      some = slider_crank()
      call some%set_length(1, 2, -1.0_wp)
      call refused(some, 'not negative', 'a negative length')
      some = slider_crank()
      call some%set_angle(2, 1, 1.0_wp)
      call refused(some, 'no arc 1 of loop 2', 'the angle of an arc that is not there')
      some = slider_crank()
      call some%vary(1, lengths=[5])
      call refused(some, 'no arc 5', 'a variable that is not there')
      some = slider_crank()
      call some%vary(2, angles=[1])
      call refused(some, 'no loop 2', 'a variable of a loop that is not there')
      some = slider_crank()
      call some%set_angle(2, 1, 1.0_wp)
      call some%set_length(1, 2, -1.0_wp)
      call some%take_back(1, taken)
      call t%equal_integer(taken%count, 1, 'one fault of two is taken back')
      if (taken%count == 1) call t%is_true(index(taken%list(1)%render(), 'not negative') > 0, 'it is the second', &
                                           taken%list(1)%render())
      call t%equal_integer(some%faults_made(), 1, 'the first stays')
      call refused(some, 'no arc 1 of loop 2', 'and is reported')
      call read_text('', cases, findings)
      call t%is_true(findings%failed() .and. size(cases) == 0, 'an empty text has no case')
      findings = findings_t()
      call read_text('A'//nl//links(:40), cases, findings)
      call t%is_true(findings%failed(), 'half a text')
      if (size(cases) > 0) call refused(cases(1), 'has errors', 'half a text')
      findings = findings_t()
      call read_file('data/no_such_file.nml', cases, findings)
      call t%finds(findings, 'cannot open', 'a file that is not there')
      call t%equal_integer(size(cases), 0, 'a file that is not there has no case')
      call read_file('data/needle.nml', cases, findings)
      call cases(1)%add_loop([1, -2, 3, 4], [1, 0, -4, 1])
      call refused(cases(1), 'add no loops', 'a loop of a case that was read')
   end subroutine incomplete

   !> Every verb refuses the case and leaves results that can be looked at.
   subroutine refused(case, words, law)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: words, law
      class(analysis_t), allocatable :: analysis
      type(rate_study_t) :: rates
      class(synthesis_t), allocatable :: search
      type(tolerances_t) :: tolerances
      type(findings_t) :: findings, of_rates, of_search, of_tolerances

      allocate (analysis, search)
      call analyse(case, analysis, findings)
      call t%finds(findings, words, law)
      call t%is_true(size(analysis%motion%input) == 0 .and. .not. analysis%is_violating(), law//': nothing was analysed')
      call find_rates(case, rates, of_rates)
      call synthesise(case, search, of_search)
      call find_tolerances(case, tolerances, of_tolerances)
      call t%is_true(findings%failed() .and. of_rates%failed() .and. of_search%failed() .and. of_tolerances%failed(), &
                     law//': every study tells')
      call t%is_true(size(rates%dead) == 0 .and. search%ending == ended_unmade .and. .not. tolerances%closes, &
                     law//': every result is empty')
   end subroutine refused

   !> Dimensions may be changed, of cases made and of cases read.
   subroutine changed()
      type(case_t) :: made
      type(case_t), allocatable :: cases(:)
      class(analysis_t), allocatable :: one, two
      type(findings_t) :: findings

      allocate (one, two)
      made = slider_crank()
      call read_text('A'//nl//links//method, cases, findings)
      call made%set_length(1, 1, 35.0_wp)
      call cases(1)%set_length(1, 1, 35.0_wp)
      call t%is_true(abs(made%length(1, 1) - 35.0_wp) + abs(cases(1)%length(1, 1) - 35.0_wp) <= 0.0_wp, 'the new length')
      call t%is_true(abs(made%angle(1, 4) - 270.0_wp) + abs(cases(1)%angle(1, 4) - 270.0_wp) <= 0.0_wp, 'the old angle')
      call t%is_true(abs(made%length(2, 1)) + abs(cases(1)%angle(1, 5)) <= 0.0_wp, 'an arc that is not there')
      call analyse(made, one, findings)
      call analyse(cases(1), two, findings)
      call t%close_to(maxval(abs(one%motion%actual(:, 1) - slide(one%motion%input, 35.0_wp))), 0.0_wp, 1.0e-12_wp, &
                      'a shorter crank')
      call t%is_true(all(abs(one%motion%actual - two%motion%actual) <= 0.0_wp), 'read or made: the same bits')
      ! a rod too short to reach: reported, not refused
      call made%set_length(1, 2, 40.0_wp)
      call analyse(made, one, findings)
      call t%is_true(.not. findings%failed() .and. one%is_violating() .and. .not. all(one%motion%closed), &
                     'a linkage that does not close is a result')
      call t%finds(findings, 'warning: loop 1, dyad of type 4', 'and a warning that names the loop')
      call made%set_angle(1, 4, 90.0_wp)
      call t%is_true(abs(made%angle(1, 4) - 90.0_wp) <= 0.0_wp, 'another angle')
   end subroutine changed

   !> Speed of the slide by a difference of positions.
   subroutine rates()
      type(case_t) :: case
      type(rate_study_t) :: rate_of
      type(findings_t) :: findings
      type(report_t) :: report
      real(wp), parameter :: speed = 3.0_wp, h = 1.0e-4_wp, per_degree = 57.295779513082320876798_wp
      integer :: k
      real(wp) :: difference

      case = slider_crank()
      call case%set_item('RATES', 'SPEED', speed)
      call case%set_item('RATES', 'UNITS', 'RAD/S')
      call find_rates(case, rate_of, findings, report)
      call t%equal_integer(findings%count, 0, 'rates: no findings')
      do k = 1, size(rate_of%dead)
         difference = (slide(rate_of%motion%input(k) + h, crank) - slide(rate_of%motion%input(k) - h, crank))/(2.0_wp*h)*per_degree
         call t%close_to(rate_of%by_time(1, 1, k), speed*difference, 1.0e-7_wp, 'velocity of the slide against a difference')
      end do
      call t%is_true(index(report%listing, 'SPEED OF THE INPUT') > 0, 'the listing of rates')
   end subroutine rates

   !> The same speed in each unit; units that do not fit the input.
   subroutine units_of_speed()
      type(case_t), save :: case
      type(rate_study_t), save :: rate_of
      type(findings_t), save :: findings
      character(*), parameter :: units(*) = [character(7) :: 'RAD/S', 'DEG/S', 'REV/S', 'REV/MIN', 'RPM']
      real(wp), parameter :: turn = 2.0_wp*acos(-1.0_wp)
      real(wp), parameter :: speeds(*) = [turn, 360.0_wp, 1.0_wp, 60.0_wp, 60.0_wp]
      real(wp), allocatable :: first(:, :, :)
      integer :: i

      do i = 1, size(units)
         case = slider_crank()
         call case%set_item('RATES', 'SPEED', speeds(i))
         call case%set_item('RATES', 'UNITS', trim(units(i)))
         call find_rates(case, rate_of, findings)
         call t%equal_integer(findings%count, 0, 'a speed in '//trim(units(i)))
         if (i == 1) first = rate_of%by_time
         call t%close_to(maxval(abs(rate_of%by_time - first))/maxval(abs(first)), 0.0_wp, 1.0e-14_wp, &
                         'one turn a second in '//trim(units(i)))
      end do
      call case%set_item('RATES', 'UNITS', 'LENGTH/S')
      call find_rates(case, rate_of, findings)
      call t%finds(findings, "a turning input an angular unit; found 'LENGTH/S'", 'a length for a turning input')
      findings = findings_t()
      call case%set_item('RATES', 'UNITS', 'MPH')
      call find_rates(case, rate_of, findings)
      call t%finds(findings, "is expected; found 'MPH'", 'a unit that is not there')
   end subroutine units_of_speed

   !> A search in memory, and what it found as a case.
   subroutine searched()
      type(case_t), save :: path, best
      type(synthesis_t), save :: search, shared
      type(analysis_t), save :: analysis
      type(findings_t), save :: findings
      type(wanted_t), save :: wanted
      integer :: k

      path = path_of_five_points()
      call synthesise(path, search, findings)
      call t%equal_integer(findings%count, 0, 'a search: no findings')
      call t%equal_integer(search%ending, ended_starts, 'all starts were made')
      call t%is_true(search%many .and. size(search%found%best) > 1 .and. .not. search%is_short(), 'several linkages')
      if (size(search%found%best) < 2) return
      do k = 1, 2
         best = found_case(path, search, k)
         call analyse(best, analysis, findings)
         call t%close_to(analysis%motion%total/search%found%best(k)%objective, 1.0_wp, 1.0e-6_wp, &
                         'the linkage found has the objective of its rank')
      end do
      best = found_case(path, search, 99)
      call t%is_true(abs(best%length(1, 1) - path%length(1, 1)) <= 0.0_wp, 'no such rank: the linkage as given')
      wanted%margins = .true.
      wanted%sweep = .true.
      wanted%summary = .true.
      wanted%conditions = .true.
      wanted%arcs = .true.
      call analyse(found_case(path, search), analysis, findings, wanted)
      call t%is_true(allocated(analysis%margins) .and. allocated(analysis%sweep) .and. allocated(analysis%summary) .and. &
                     allocated(analysis%condition) .and. allocated(analysis%arcs), 'all that is wanted')
      call t%is_true(size(analysis%sweep%input) == 360 .and. minval(analysis%condition) >= 1.0_wp, 'every degree; conditions')
      call t%close_to(analysis%arcs%length(1, 1), analysis%dimensions%arcl(1), 0.0_wp, 'arcs: the crank keeps its length')
      call synthesise(path, shared, findings, threads=3)
      call t%is_true(size(shared%found%best) == size(search%found%best), 'as many linkages for three threads')
      call t%is_true(all(abs(shared%found%best(1)%values - search%found%best(1)%values) <= 0.0_wp), 'and the same bits')
      call synthesise(slider_crank(), search, findings)
      call t%equal_integer(search%ending, ended_unmade, 'nothing varies: no search')
   end subroutine searched

   !> A length that no loop has varies: the search is made in the poses of the links, and what it found are cases all the same.
   subroutine searched_in_poses()
      character(*), parameter :: six_bar = 'SIX-BAR'//nl// &
         " &CHAIN JNT='A','B','C','D','P','Q','E', JX=0.,-4.,33.,90.,20.,80.,130., JY=0.,31.,82.,5.,95.,140.,60.,"//nl// &
         "  LNK='A D E','A B','B C P','C D','P Q','Q E', VARY='A B','B C','C D','P Q','Q E','C P' &END"//nl// &
         " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point Q' &END"//nl// &
         ' &METHOD NDES=3, DELT=0.,30.,60., DESX=80.5,70.1109,58.6497, DESY=139.7,132.1787,120.8354, VAR=0.5 &END'//nl// &
         " &SEARCH SOLVER='LSQ', NSTART=4, MAXEVAL=10, NBEST=4, DIFFER=0.001 &END"//nl
      type(case_t), allocatable, save :: cases(:)
      type(case_t), save :: found
      type(synthesis_t), save :: search
      type(analysis_t), save :: analysis, reported
      type(findings_t), save :: findings
      type(report_t), save :: report
      integer :: k

      call read_text(six_bar, cases, findings)
      call synthesise(cases(1), search, findings, report=report)
      call t%is_true(.not. findings%failed() .and. allocated(search%drawn), 'a search in poses')
      if (findings%failed()) return
      call t%is_true(size(search%found%best) > 1, 'found several linkages')
      call t%equal_integer(size(report%cases), size(search%found%best), 'which are cases of the report')
      call t%is_true(report%tables%tables(1)%rows == size(search%found%best), 'and rows of its first table')
      do k = 1, size(search%found%best)
         found = found_case(cases(1), search, k)
         call analyse(found, analysis, findings)
         call t%close_to(analysis%motion%total/search%found%best(k)%objective, 1.0_wp, 1.0e-6_wp, &
                         'the sketch found has the objective of its rank')
         call analyse(report%cases(k), reported, findings)
         call t%is_true(all(abs(reported%motion%actual - analysis%motion%actual) <= 0.0_wp), 'and is the case of the report')
      end do
      call t%is_true(report%cases(1)%text() /= report%cases(2)%text(), 'each is another')
      found = found_case(cases(1), search, 99)
      call t%is_true(found%text() == cases(1)%text(), 'no such rank: the sketch as given')
   end subroutine searched_in_poses

   !> A search by the simplex, and its best vertex as a case.
   subroutine simplex()
      type(case_t), allocatable :: cases(:)
      class(synthesis_t), allocatable :: search
      class(analysis_t), allocatable :: analysis
      type(findings_t) :: findings

      allocate (search, analysis)
      call read_file('data/needle.nml', cases, findings)
      call synthesise(cases(1), search, findings)
      call t%equal_integer(search%ending, ended_iterations, 'the simplex stops at NITER')
      call t%is_true(.not. search%many .and. search%is_short() .and. search%state%iteration == 2, 'after two iterations')
      call read_file('data/chain_short.nml', cases, findings)
      call synthesise(cases(1), search, findings)
      call t%equal_integer(search%ending, ended_converged, 'the simplex converges')
      call analyse(found_case(cases(1), search), analysis, findings)
      call t%close_to(analysis%motion%total, search%last%f(search%last%best), 1.0e-9_wp, 'the best vertex as a case')
      call analyse(cases(1), analysis, findings)
      call t%is_true(analysis%motion%total > search%last%f(search%last%best), 'is better than the linkage as given')
      call t%is_true(.not. findings%failed(), 'and nothing is wrong')
   end subroutine simplex

   !> A problem without a linkage; mistakes in asking for a solver are findings.
   subroutine own_problem()
      type(rosenbrock_t), save :: valley
      type(rosen_suzuki_t), save :: bowl
      type(ending_t), save :: ending
      type(findings_t), save :: findings
      type(host_t), target :: host
      type(stop_t), save :: stop
      real(wp) :: x(2), y(4)

      valley = rosenbrock()
      x = [-1.2_wp, 1.0_wp]
      call minimise(valley, 'lsq', x, ending, findings)
      call t%close_to(maxval(abs(x - 1.0_wp)), 0.0_wp, 1.0e-6_wp, 'the valley by least squares')
      call t%is_true(ending%feasible .and. findings%count == 0, 'without findings')
      bowl = rosen_suzuki()
      y = 0.0_wp
      call minimise(bowl, 'LD_SLSQP', y, ending, findings)
      call t%close_to(maxval(abs(y - [0.0_wp, 1.0_wp, 2.0_wp, -1.0_wp])), 0.0_wp, 1.0e-4_wp, 'the bowl by SLSQP')
      call t%equal_integer(findings%count, 0, 'no findings')
      call minimise(valley, 'LSX', x, ending, findings)
      call t%finds(findings, "no solver is called 'LSX'; did you mean 'LSQ'?", 'a solver that is not there')
      findings = findings_t()
      call minimise(valley, 'LSQ', y, ending, findings)
      call t%finds(findings, 'x needs a value for each of 2 unknowns', 'too many values')
      findings = findings_t()
      deallocate (valley%low)
      call minimise(valley, 'LSQ', x, ending, findings)
      call t%finds(findings, 'a bound for each core unknown', 'no bounds')
      findings = findings_t()
      host%wants_end = .true.
      call stop%listen_to(host)
      valley = rosenbrock()
      x = [-1.2_wp, 1.0_wp]
      call minimise(valley, 'SIMPLEX', x, ending, findings, stop)
      call t%is_true(maxval(abs(x - 1.0_wp)) > 0.1_wp, 'a host can end it')
   end subroutine own_problem

   function path_of_five_points() result(case)
      type(case_t) :: case

      case = new_case('FIVE POINTS')
      call case%add_loop([1, -2, -3, 4], [1, 0, 0, 1], [2.0_wp, 4.0_wp, 4.0_wp, 4.0_wp], [0.0_wp, 0.0_wp, 0.0_wp, 180.0_wp])
      call case%set_output(output_point, arc=-2, loop=1, length=3.0_wp, angle=50.0_wp)
      call case%set_positions([30.0_wp, 45.0_wp, 60.0_wp, 75.0_wp, 90.0_wp])
      call case%set_desired(x=[3.0_wp, 2.4_wp, 1.2_wp, 0.4_wp, 0.9_wp], y=[3.0_wp, 3.8_wp, 4.1_wp, 3.2_wp, 2.1_wp])
      call case%vary(1, lengths=[1, 2, 3, 4])
      call case%set_item('METHOD', 'ILKOUT', 1)
      call case%set_item('METHOD', 'INGOUT', 1)
      call case%set_item('METHOD', 'IORIG', 1)
      call case%set_item('SEARCH', 'SOLVER', 'LSQ')
      call case%set_item('SEARCH', 'NSTART', 40)
      call case%set_item('SEARCH', 'NBEST', 3)
   end function path_of_five_points

   !> A host can end a search.
   subroutine ended()
      type(host_t), target :: host
      type(stop_t) :: stop
      class(synthesis_t), allocatable :: search
      type(findings_t) :: findings

      allocate (search)
      host%wants_end = .true.
      call stop%listen_to(host)
      call synthesise(path_of_five_points(), search, findings, stop=stop)
      call t%equal_integer(search%ending, ended_on_request, 'ended by the host')
      call t%is_true(search%is_short() .and. search%found%starts == 0, 'before the first start was done')
      call ended_early('sweep', 'data/adjustable_stroke.nml', stop)
      call ended_early('proof', 'data/adjustable_stroke.nml', stop)
      call ended_early('proof', 'data/geared_five_bar.nml', stop)
      call ended_early('balance', 'data/muscle/haines_bodies.nml', stop)
      call ended_early('clearance', 'data/bridge/four_bar_haines.nml', stop)
      call ended_early('cams', 'data/calm/conjugate_cams.nml', stop)
   end subroutine ended

   !> A study that the host ends at once is done, but early: no errors, no tables, a warning.
   subroutine ended_early(verb, file, stop)
      character(*), intent(in) :: verb, file
      type(stop_t), intent(in) :: stop
      type(case_t), allocatable :: cases(:)
      type(report_t) :: report
      type(findings_t) :: reported

      call read_file(file, cases, reported)
      call study(cases(1), verb, report, reported, stop=stop)
      call t%is_true(report%violated .and. .not. reported%failed(), verb//' is ended by the host: '//file)
      if (reported%count > 0) call t%is_true(index(reported%list(reported%count)%text, 'ended before it had a result') > 0, &
                                            verb//': a warning')
      call t%equal_integer(report%tables%count, 0, verb//': no tables')
   end subroutine ended_early

   !> A tolerance of the crank alone: its effect is the derivative of the slide.
   subroutine tolerances()
      type(case_t) :: case
      type(tolerances_t) :: bands
      type(findings_t) :: findings
      real(wp), parameter :: tolerance = 1.0e-3_wp

      case = slider_crank()
      call case%set_item('TOLER', 'TOLARC', [tolerance, 0.0_wp, 0.0_wp, 0.0_wp])
      call case%set_item('TOLER', 'NTRIAL', 500)
      call find_tolerances(case, bands, findings, threads=1)
      call t%equal_integer(findings%count, 0, 'tolerances: no findings')
      call t%is_true(bands%closes .and. size(bands%linear%tolerance) == 1 .and. bands%sample%trials == 500, 'one tolerance')
      if (.not. bands%closes) return
      call t%close_to(maxval(abs(bands%linear%effect(:, 1, 1) - 0.5_wp*(slide(bands%linear%nominal%input, crank + tolerance) - &
                                                                       slide(bands%linear%nominal%input, crank - tolerance)))), &
                      0.0_wp, 1.0e-9_wp, 'the effect of the crank against a difference')
      call t%is_true(.not. bands%is_violating(), 'and every linkage of the sample closes')
   end subroutine tolerances

   !> A sketch of two drives has its forces and rates, and no motion from torque.
   subroutine forces_of_sketch()
      character, parameter :: nl = new_line('a')
      character(*), parameter :: text = 'TWO CRANKS'//nl// &
         " &CHAIN JNT='A','B','C','D','E', JX=0.,0.,4.,6.,6., JY=0.,2.,5.,2.,0., LNAME='frame','left','rod1','rod2','right', "// &
         "LNK='A E','A B','B C','C D','D E' &END"//nl//" &DRIVES DRIVE='A','E', DELT2=0.,10., DSPEED=0.,2. &END"//nl// &
         ' &METHOD NDES=2, DELT=0.,10. &END'//nl//' &RATES SPEED=3. &END'//nl// &
         " &MASSES NMASS=1, MNAME='rod1 C', MASS=2., GRAVY=-10. &END"//nl
      type(case_t), allocatable, save :: cases(:)
      type(force_study_t), save :: forces
      type(rate_study_t), save :: rates
      type(findings_t), save :: findings
      real(wp), allocatable :: of_unit_mass(:, :, :, :)
      integer :: k

      call read_text(text, cases, findings)
      call t%is_true(.not. findings%failed(), 'two cranks are read')
      call find_forces(cases(1), forces, findings, by_unit_mass=of_unit_mass)
      call t%equal_integer(size(forces%input), 2, 'forces of a sketch of two drives')
      if (size(forces%input) < 2) return
      do k = 1, 2
         call t%close_to(forces%drive_power(k), forces%table%growth(k) - forces%table%power(k), &
                         1.0e-12_wp*abs(forces%drive_power(k)), 'both drives together do the work')
      end do
      call t%equal_integer(size(of_unit_mass, 2), size(forces%table%value, 2), 'unit masses give every column')
      call find_rates(cases(1), rates, findings)
      call t%is_true(.not. findings%failed(), 'rates of a sketch of two drives')
      call t%equal_integer(size(rates%by_time, 3), 2, 'at both positions')
      call read_text(text//' &MOTOR MTORQ=1. &END'//nl, cases, findings)
      if (.not. findings%failed()) call find_forces(cases(1), forces, findings)
      call t%finds(findings, 'motion from torque needs one drive that all others follow', &
                   'several drives have no motion from torque')
   end subroutine forces_of_sketch

   !> The four-bar of data/sketch_four_bar.nml, made joint by joint.
   function four_bar() result(case)
      type(case_t) :: case

      case = new_case('FOUR-BAR FROM A SKETCH')
      call case%add_joint('A', 0.0_wp, 0.0_wp, fixed=.true.)
      call case%add_joint('B', -4.0_wp, 31.0_wp)
      call case%add_joint('C', 0.0_wp, 0.0_wp)
      call case%add_joint('D', 90.0_wp, 5.0_wp, fixed=.true.)
      call case%add_joint('P', 20.0_wp, 95.0_wp)
      call case%add_joint('C', 33.0_wp, 82.0_wp)
      call case%add_link('A B', 'crank')
      call case%add_link('B C P')
      call case%add_link('C D', 'rocker')
      call case%add_drive('A', 'frame', 'crank')
      call case%add_output('point P')
      call case%set_turn(15)
      call case%set_item('LIMITS', 'TANGLE', 80.0_wp)
   end function four_bar

   !> A sketch made in memory is the one of its file, to the last bit; its columns have names.
   subroutine sketch_in_memory()
      type(case_t), save :: made, slide, loaded
      type(case_t), allocatable, save :: read(:)
      type(analysis_t), save :: one, other
      type(findings_t), save :: findings
      type(report_t), save :: report
      real(wp), allocatable :: x(:)
      character(:), allocatable :: text
      integer :: k

      made = four_bar()
      call read_file('data/sketch_four_bar.nml', read, findings)
      call analyse(made, one, findings, report=report)
      call analyse(read(1), other, findings)
      call t%equal_integer(findings%count, 0, 'a sketch made in memory: no findings')
      call t%is_true(all(abs(one%motion%actual - other%motion%actual) <= 0.0_wp), 'sketch in memory and file: the same bits')
      call t%is_true(report%find('positions') > 0 .and. report%find('position') == 0, 'a table of positions')
      x = report%column('positions', 'P.x')
      call t%is_true(size(x) == 24 .and. size(report%column('positions', 'C.y')) == 24 .and. &
                     size(report%column('positions', 'Q.x')) == 0, 'joints by name')
      if (size(x) == 24) call t%is_true(all(abs(x - one%motion%actual(:, 1)) <= 1.0e-12_wp), 'the column of a joint is the output')
      slide = new_case('SLIDER')
      call slide%add_joint('O', 0.0_wp, 0.0_wp, fixed=.true.)
      call slide%add_joint('B', 40.0_wp, 0.0_wp)
      call slide%add_joint('C', 40.0_wp + sqrt(rod**2 - offset**2), offset)
      call slide%add_link('O B', 'crank')
      call slide%add_link('B C', 'rod')
      call slide%add_link('C', 'block')
      call slide%add_slide('frame', 'block', 40.0_wp + sqrt(rod**2 - offset**2), offset, 0.0_wp)
      call slide%add_drive('O')
      call slide%add_output('point C', 'pin')
      call slide%set_turn(15)
      call analyse(slide, one, findings)
      call t%equal_integer(findings%count, 0, 'a slide made in memory: no findings')
      if (findings%count > 0) return
      call t%close_to(maxval(abs(one%motion%actual(:, 1) - slide_of(one%motion%input))), 0.0_wp, 1.0e-9_wp, &
                      'its pin is where a right triangle has it')
      ! the frame, which the case has by its fixed joints, is a link of &CHAIN alone
      loaded = four_bar()
      call loaded%set_item('LOADS', 'LNAME', 'rocker C')
      text = loaded%text()
      k = index(text, ' &LOADS')
      call t%is_true(k > 0 .and. index(text(:k), "'frame'") > 0 .and. index(text(k:), "'frame'") == 0 .and. &
                     index(text(k:), "'rocker C'") > 0, 'links of loads are those that were given', text)
      call made%add_joint('E F', 1.0_wp, 2.0_wp)
      call refused(made, 'one word', 'a joint of two words')
   end subroutine sketch_in_memory

   elemental real(wp) function slide_of(degrees)
      real(wp), intent(in) :: degrees

      slide_of = slide(degrees, crank)
   end function slide_of

   !> An item of a case that was read; loops cannot be added to it.
   subroutine opened()
      type(case_t), allocatable, save :: cases(:)
      type(analysis_t), save :: analysis
      type(findings_t), save :: findings

      call read_file('data/dyad4_slider_crank.nml', cases, findings)
      call cases(1)%set_item('METHOD', 'IKIN', 90)
      call analyse(cases(1), analysis, findings)
      call t%equal_integer(findings%count, 0, 'an item of a case that was read: no findings')
      call t%equal_integer(size(analysis%motion%input), 4, 'an item of a case that was read counts')
      call t%close_to(cases(1)%length(1, 2), rod, 0.0_wp, 'its dimensions are still there')
      call cases(1)%set_length(1, 2, 150.0_wp)
      call cases(1)%set_item('METHOD', 'IKIN', 180)
      call analyse(cases(1), analysis, findings)
      call t%equal_integer(size(analysis%motion%input), 2, 'again an item')
      call t%close_to(analysis%motion%actual(1, 1), 40.0_wp + sqrt(150.0_wp**2 - offset**2), 1.0e-11_wp, &
                      'a changed length survives an item')
      call cases(1)%add_loop([1, -2, 3, 4], [1, 0, -4, 1])
      call refused(cases(1), 'add no loops', 'a loop for a case that was read')
   end subroutine opened

   !> The text of a case is the case: read again the same bits, changed dimensions included; of every case of a file.
   subroutine texts()
      character(*), parameter :: files(*) = [character(40) :: 'data/dyad4_slider_crank.nml', 'data/sketch_four_bar.nml', &
                                             'data/jansen.nml', 'data/textile.nml', 'data/four_bars.json', &
                                             'data/geared_five_bar.nml', 'data/landing_gear.nml']
      type(case_t), allocatable, save :: cases(:), again(:)
      type(analysis_t), save :: one, other
      type(findings_t), save :: findings
      integer :: i, k

      do i = 1, size(files)
         call read_file(trim(files(i)), cases, findings)
         do k = 1, size(cases)
            call read_text(cases(k)%text(), again, findings)
            call t%is_true(size(again) == 1, 'the text of one case: '//files(i))
            if (size(again) /= 1) cycle
            call analyse(cases(k), one, findings)
            call analyse(again(1), other, findings)
            call t%is_true(size(one%motion%actual) == size(other%motion%actual), 'as many results: '//files(i))
            if (size(one%motion%actual) /= size(other%motion%actual)) cycle
            call t%is_true(all(abs(one%motion%actual - other%motion%actual) <= 0.0_wp), &
                           'text read again: the same bits: '//files(i))
         end do
      end do
      call read_file('data/dyad4_slider_crank.nml', cases, findings)
      call cases(1)%set_length(1, 1, 35.0_wp)
      call cases(1)%set_angle(1, 4, 268.0_wp)
      call read_text(cases(1)%text(), again, findings)
      call t%is_true(size(again) == 1, 'the text of changed dimensions')
      if (size(again) /= 1) return
      call t%is_true(abs(again(1)%length(1, 1) - 35.0_wp) <= 0.0_wp .and. abs(again(1)%angle(1, 4) - 268.0_wp) <= 0.0_wp, &
                     'changed dimensions are in the text')
   end subroutine texts

   !> Every verb by its name, on a case that asks for it; and on one that does not.
   subroutine every_verb()
      type :: trial_t
         character(12) :: verb
         character(40) :: file
      end type trial_t
      type(trial_t), parameter :: trials(*) = [ &
         trial_t('analysis', 'data/textile.nml'), trial_t('summary', 'data/textile.nml'), &
         trial_t('tolerances', 'data/adjustable_stroke.nml'), trial_t('sweep', 'data/adjustable_stroke.nml'), &
         trial_t('allocation', 'data/cheapest_tolerances.nml'), &
         trial_t('synthesis', 'data/path5.nml'), trial_t('exact', 'data/exact/five_poses.nml'), &
         trial_t('kinds', 'data/types/kinds_for_corner.nml'), &
         trial_t('proof', 'data/geared_five_bar.nml'), trial_t('assemblies', 'data/sketch_four_bar.nml'), &
         trial_t('rates', 'data/engine.nml'), trial_t('forces', 'data/engine.nml'), trial_t('machine', 'data/engine.nml'), &
         trial_t('time', 'data/time/toggle.nml'), &
         trial_t('balance', 'data/muscle/haines_bodies.nml'), trial_t('springs', 'data/muscle/haines_spring.nml'), &
         trial_t('vibration', 'data/ssics/hill.nml'), trial_t('vibration', 'data/rig_coupler.nml'), &
         trial_t('cams', 'data/calm/conjugate_cams.nml'), trial_t('clearance', 'data/bridge/four_bar_haines.nml'), &
         trial_t('picture', 'data/jansen.nml'), trial_t('board', 'data/jansen.nml')]
      type(case_t), allocatable, save :: cases(:)
      type(case_t), save :: plain
      type(findings_t), save :: findings
      type(report_t), save :: report
      integer :: i

      plain = slider_crank()
      do i = 1, size(verbs)
         call t%is_true(any(trials%verb == verbs(i)%name), 'the verb '//trim(verbs(i)%name)//' is tried')
         findings = findings_t()
         call study(plain, trim(verbs(i)%name), report, findings)
         if (index(verbs(i)%groups, 'RATES') > 0 .or. verbs(i)%program == 'psalm') cycle
         if (verbs(i)%name == 'picture' .or. verbs(i)%name == 'forces') cycle
         call t%is_true(findings%failed(), 'a case that does not ask for '//trim(verbs(i)%name)//' is refused')
      end do
      do i = 1, size(trials)
         findings = findings_t()
         call read_file(trim(trials(i)%file), cases, findings)
         if (trials(i)%verb == 'kinds') call cases(1)%set_item('SEARCH', 'NSTART', 4)    ! linkages are found all the same
         call study(cases(1), trim(trials(i)%verb), report, findings)
         call t%is_true(.not. findings%failed(), trim(trials(i)%verb)//' of '//trim(trials(i)%file)//': no errors')
         call t%is_true(len(report%listing) > 0 .or. size(report%files) > 0, trim(trials(i)%verb)//': something to read')
         select case (trials(i)%verb)
         case ('picture', 'board', 'summary')
         case default
            call t%is_true(report%tables%count > 0, trim(trials(i)%verb)//': tables')
         end select
         select case (trials(i)%verb)
         case ('synthesis', 'exact', 'kinds', 'balance', 'springs')
            call t%is_true(size(report%cases) > 0, trim(trials(i)%verb)//': linkages as cases')
         end select
      end do
      findings = findings_t()
      call study(plain, 'analisys', report, findings)
      call t%is_true(findings%failed(), 'a verb that is not there')
      if (findings%count > 0) call t%is_true(index(findings%list(findings%count)%text, "did you mean 'analysis'?") > 0, &
                                             'the nearest verb is named')
   end subroutine every_verb
end program test_library
