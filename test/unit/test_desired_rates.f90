!> Derivatives of the output as wanted values: how they change with every variable against differences and against rates of the next
!> order, gradients of searches, the same linkages as by a sketch in poses, the notation.
program test_desired_rates
   use cases, only: load_case, names
   use check, only: checks_t
   use poses, only: read_in_poses
   use psalm_analysis, only: analysis_t, analyse, wanted_t
   use psalm_cases, only: read_case_text
   use psalm_chain_study, only: chain_study_t, study_chain
   use psalm_chain_synthesis, only: chain_synthesis_t, synthesise_chain
   use psalm_data_set, only: data_set_t
   use psalm_data_set_text, only: write_data_set
   use psalm_constr, only: vertex_problem_t, make_vertex_problem
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_merit, only: merit_t, prepare_merit
   use psalm_nlp, only: normal_equations_t
   use psalm_output_kind, only: motion_point, motion_angle, motion_distance, motion_pose, most_rates
   use psalm_parameters, only: variable_length, variable_outlk, variable_origlk, variable_crnki
   use psalm_preparation, only: prepared_t, prepare
   use psalm_rates, only: rates_t, prepare_rates, differentiate, output_rates, highest_order
   use psalm_solver_kind, only: find_solver
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_synthesis, only: synthesis_t, synthesise
   use psalm_text, only: text_t, to_text
   use psalm_desired_rates, only: desired_rates_t, prepare_desired_rates, find_desired_rates, differentiate_desired_rates
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   !> A crank-rocker; the rocker's angle at three crank angles.
   character(*), parameter :: four_bar = 'FOUR-BAR'//nl//' &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1,'//nl// &
      ' ARCL=40.0,120.0,80.0,130.0, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1, OUTANG=180.0 &END'//nl// &
      ' &METHOD NDES=3, DELT=60.0,100.0,140.0, IVA=0,1,1,0, NITER=400, SMALL=1.0E-9, MOTION=1'
   type(checks_t) :: t
   integer :: k

   do k = 1, size(names)
      call changes(names(k))
   end do
   call changes('needle', motion=motion_pose)
   call changes('needle', motion=motion_distance)
   call changes('textile', motion=motion_distance)
   call changes('dyad4_slider_crank', motion=motion_pose)
   do k = 1, 7
      call changes('hard/carried_slides', n=k)
   end do
   call of_any_size('needle', motion_angle)
   call of_any_size('needle', motion_point)
   call of_any_size('textile', motion_point)
   call of_any_size('actuator_rapson_slide')
   call of_any_size('dyad4_slider_crank')
   call gradient('needle', .false.)
   call gradient('needle', .true.)
   call gradient('textile', .true.)
   call gradient('actuator_rapson_slide', .true.)
   call gradient_of_wheels('wheels on the frame', 'crank', 'wheel', 'frame', '20.0, GTB=20.0', 14)
   call gradient_of_wheels('a wheel on the crank', 'frame', 'first', 'crank', '40.0, GTB=-20.0', 14)
   call gradient_of_wheels('wheels of a group', 'crank', 'second', 'first', '20.0, GTB=20.0', 14)
   call as_in_poses("'point P'", motion_point)
   call as_in_poses("'angle C D'", motion_angle)
   call as_in_poses("'distance P'", motion_distance)
   call as_in_poses("'pose C coupler'", motion_pose)
   call scotch_yoke()
   call solvers()
   call without_derivatives()
   call notation()
   call t%report()

contains

   !> Lengths 2**300 times as long: the same digits but for the power of two that belongs to each derivative.
   subroutine of_any_size(name, motion)
      character(*), intent(in) :: name
      integer, intent(in), optional :: motion
      integer, parameter :: power = 300
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(desired_rates_t) :: own, large
      type(dimensions_t) :: dimensions
      integer :: v, order, by_input, by_this, of_output
      logical :: same

      allocate (problem, set)
      call load_case(name, problem, set, vary=.true., motion=motion)
      call let_want(problem)
      call prepare_desired_rates(problem, .false., .true., own)
      call differentiate_desired_rates(own, problem%given)
      dimensions = problem%given
      dimensions%arcl = scale(dimensions%arcl, power)
      dimensions%outlk = scale(dimensions%outlk, power)
      dimensions%origlk = scale(dimensions%origlk, power)
      if (problem%mechanism%sliding_input) then
         dimensions%crnki = scale(dimensions%crnki, power)
         call problem%set_inputs(scale(problem%delt(:problem%positions), power))
         call let_want(problem)
      end if
      call prepare_desired_rates(problem, .false., .true., large)
      call differentiate_desired_rates(large, dimensions)
      call t%is_true(all(own%exists) .and. all(large%exists), name//': derivatives of lengths beyond the plain ones exist')
      of_output = merge(0, 1, problem%motion == motion_angle)
      associate (kinds => problem%parameters%variables%kind)
         do order = 1, most_rates
            by_input = merge(order, 0, problem%mechanism%sliding_input)
            same = all(abs(scale(large%actual(:, :, order), (by_input - of_output)*power) - own%actual(:, :, order)) <= 0.0_wp)
            call t%is_true(same, name//': derivatives of lengths beyond the plain ones, order '//to_text(order))
            same = .true.
            do v = 1, size(kinds)
               by_this = merge(1, 0, is_length(problem, kinds(v)))
               same = same .and. all(abs(scale(large%by(:, v, :, order), (by_input + by_this - of_output)*power) - &
                                         own%by(:, v, :, order)) <= 0.0_wp)
            end do
            call t%is_true(same, name//': their changes, order '//to_text(order))
         end do
      end associate
   end subroutine of_any_size

   pure logical function is_length(problem, kind)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: kind

      is_length = any(kind == [variable_length, variable_outlk, variable_origlk]) .or. &
                  (kind == variable_crnki .and. problem%mechanism%sliding_input)
   end function is_length

   !> Changes of both derivatives with every variable, and with the input, where the next order of the rates is known.
   subroutine changes(name, motion, n)
      character(*), intent(in) :: name
      integer, intent(in), optional :: motion, n
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(desired_rates_t) :: wanted, moved
      type(rates_t) :: rates
      type(dimensions_t) :: dimensions
      real(wp), allocatable :: values(:), changed(:), slope(:, :, :)
      real(wp) :: step, worst(most_rates), size_of(most_rates), of_order(highest_order, 3), unit
      integer :: v, j, i, order, block, offset, m, components
      real(wp), parameter :: weight(3) = [0.75_wp, -0.15_wp, 1.0_wp/60.0_wp]
      character(:), allocatable :: label

      allocate (problem, set)
      call load_case(name, problem, set, n=n, vary=.true., motion=motion)
      label = trim(name)//', MOTION='//to_text(problem%motion)//': '
      call let_want(problem)
      call prepare_desired_rates(problem, .true., .true., wanted)
      call prepare_desired_rates(problem, .false., .false., moved)
      call differentiate_desired_rates(wanted, problem%given)
      call t%is_true(all(wanted%exists), label//'derivatives exist')
      components = size(wanted%actual, 2)
      values = problem%parameters%first_values(problem%given)
      do v = 1, size(values)
         step = 2.0e-4_wp*max(1.0_wp, 0.1_wp*abs(values(v)))
         slope = 0.0_wp*wanted%actual
         do j = -3, 3
            if (j == 0) cycle
            changed = values
            changed(v) = values(v) + real(j, wp)*step
            dimensions = problem%given
            call problem%parameters%apply(changed, dimensions)
            call find_desired_rates(moved, dimensions)
            slope = slope + weight(abs(j))*sign(1.0_wp, real(j, wp))*moved%actual/step
         end do
         do order = 1, most_rates
            worst(order) = maxval(abs(slope(:, :, order) - wanted%by(:, v, :, order))) &
                           /max(maxval(abs(wanted%by(:, v, :, order))), 1.0e-2_wp*maxval(abs(wanted%actual(:, :, order))), &
                                1.0e-6_wp)
            call t%close_to(worst(order), 0.0_wp, 1.0e-6_wp, label//'order '//to_text(order)//', variable '//to_text(v)// &
                            ', kind '//to_text(problem%parameters%variables(v)%kind))
         end do
      end do
      ! with the input: the rates of the next order, from closed forms of their own
      call problem%want_derivatives(.false.)
      call prepare_rates(problem, rates)
      unit = merge(1.0_wp, radians_per_degree, problem%mechanism%sliding_input)
      worst = 0.0_wp
      size_of = 1.0e-3_wp
      call problem%bind(problem%given)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, m)
         call differentiate(problem, rates, m, highest_order)
         do i = 1, m
            call output_rates(problem, rates, i, highest_order, of_order(:, :components))
            do order = 1, most_rates
               worst(order) = max(worst(order), maxval(abs(wanted%by(offset + i, size(values) + 1, :, order) &
                                                           - unit*of_order(order + 1, :components))))
               size_of(order) = max(size_of(order), maxval(abs(unit*of_order(order + 1, :components))))
            end do
         end do
      end do
      do order = 1, most_rates
         call t%close_to(worst(order)/size_of(order), 0.0_wp, 1.0e-10_wp, label//'with the input, order '//to_text(order))
      end do
   end subroutine changes

   !> Some derivative is wanted at every position.
   subroutine let_want(problem)
      type(problem_t), intent(inout) :: problem
      integer :: i, c, order

      associate (n => problem%positions, components => problem%output%kind%components)
         allocate (problem%rate_desired(n, components, most_rates), problem%rate_weight(n, components, most_rates))
         do order = 1, most_rates
            do c = 1, components
               problem%rate_desired(:, c, order) = [(0.1_wp*real(i + c, wp), i=1, n)]
               problem%rate_weight(:, c, order) = [(real(order, wp)*(1.0_wp + 0.2_wp*real(i, wp)), i=1, n)]
            end do
         end do
      end associate
   end subroutine let_want

   !> The gradient of a search against differences of its objective.
   subroutine gradient(name, free)
      character(*), intent(in) :: name
      logical, intent(in) :: free
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set

      allocate (problem, set)
      call load_case(name, problem, set, vary=.true.)
      call let_want(problem)
      set%method%ifree = merge(1, 0, free)
      set%search%solver = find_solver('LSQ')
      call gradient_of(name, set, problem)
   end subroutine gradient

   !> The same of a five-bar with a gear pair, all of whose dimensions vary, how the wheels stand to each other among them.
   subroutine gradient_of_wheels(name, first, second, carrier, teeth, unknowns)
      character(*), intent(in) :: name, first, second, carrier, teeth
      integer, intent(in) :: unknowns                !! lengths and angles, and three inputs
      class(data_set_t), allocatable :: set
      type(diagnostics_t) :: findings
      type(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(line_t) :: none(0)

      allocate (set, problem)
      allocate (prepared)
      call read_one('GEARS'//nl//" &CHAIN JNT='A','B','C','D','E','P', JX=0.0,1.0,4.0,6.0,5.0,3.0, JY=0.0,1.0,4.0,1.0,0.0,5.0,"// &
                    nl//" LNAME='frame','crank','first','second','wheel', LNK='A E','A B','B C P','C D','D E',"//nl// &
                    " GEARA='"//first//"', GEARB='"//second//"', GCARR='"//carrier//"', GTA="//teeth//", VARY='all' &END"//nl// &
                    " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point P' &END"//nl// &
                    ' &METHOD NDES=3, DELT=-5.0,2.0,9.0, IFREE=1, DESX=3.0,2.9,2.8, DESY=5.1,5.2,5.2,'//nl// &
                    ' DVELX=3*-0.5, DVELY=3*0.2, WVELX=3*1.0, WVELY=3*1.0 &END'//nl// &
                    " &SEARCH SOLVER='LSQ' &END"//nl, set, findings)
      call t%equal_integer(findings%count, 0, name//': read')
      call prepare(set, none, prepared, findings)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call t%equal_integer(size(prepared%parameters%variables) + problem%positions, unknowns, name//': unknowns')
      call gradient_of(name, set, problem)
   end subroutine gradient_of_wheels

   subroutine gradient_of(name, set, problem)
      character(*), intent(in) :: name
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      class(merit_t), allocatable :: merit
      type(normal_equations_t) :: equations
      real(wp), allocatable :: x(:), moved(:), slope(:)
      real(wp) :: step, ahead, behind, unused, difference
      integer :: v

      allocate (merit)
      call prepare_merit(set, problem, problem%parameters%first_values(problem%given), merit)
      x = merit%point(problem%parameters%first_values(problem%given), problem%delt)
      call merit%linearise(x, 0.0_wp, equations)
      slope = 2.0_wp*[equations%gradient, equations%edge_gradient]
      call t%equal_integer(size(slope), size(x), name//': a slope for every unknown')
      do v = 1, size(x)
         step = 1.0e-6_wp*max(1.0_wp, abs(x(v)))
         moved = x
         moved(v) = x(v) + step
         call merit%measure(moved, ahead, unused)
         moved(v) = x(v) - step
         call merit%measure(moved, behind, unused)
         difference = (ahead - behind)/(2.0_wp*step)
         call t%close_to((difference - slope(v))/maxval(abs(slope)), 0.0_wp, 1.0e-6_wp, &
                         name//': gradient, unknown '//to_text(v))
      end do
   end subroutine gradient_of

   subroutine read_one(text, set, findings)
      character(*), intent(in) :: text
      type(data_set_t), intent(out) :: set
      type(diagnostics_t), intent(out) :: findings
      type(data_set_t), allocatable :: sets(:)

      call read_case_text(text, 'test', sets, findings, 'psalm')
      if (size(sets) > 0) set = sets(1)
   end subroutine read_one

   !> A four-bar sketch: its loops, with derivatives wanted, and its poses have the same objective and lead to the same linkage.
   !> What is wanted is what another four-bar does, second derivatives a little falsified, so that not all can be met.
   subroutine as_in_poses(output, motion)
      character(*), intent(in) :: output
      integer, intent(in) :: motion
      class(data_set_t), allocatable :: set, in_poses, again
      type(text_t) :: text
      real(wp) :: before
      type(diagnostics_t) :: findings
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      class(synthesis_t), allocatable :: by_loops
      class(chain_synthesis_t), allocatable :: by_poses
      class(chain_study_t), allocatable :: other
      type(dimensions_t) :: dimensions
      class(analysis_t), allocatable :: analysis
      type(line_t) :: none(0)
      type(stop_t) :: stop
      character(*), parameter :: links = " LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D',"//nl, &
         drive = " &END &DRIVES DRIVE='A' &END"//nl, &
         method = ' &METHOD NDES=5, DELT=0.0,20.0,40.0,60.0,80.0', &
         rest = " &SEARCH SOLVER='LSQ' &END &LIMITS TANGLE=89.0, TOGGLE=0.0 &END"//nl, &
         layout = '(1000(es23.15,","))'
      character(*), parameter :: items(0:most_rates, 3) = reshape([character(7) :: 'DESX', 'DVELX', 'DACCX', 'DESY', 'DVELY', &
                                                                   'DACCY', 'DESANG', 'DVELANG', 'DACCANG'], [3, 3])
      character(1000) :: targets(0:most_rates), row
      character(:), allocatable :: method_items
      character(:), allocatable :: sketch
      integer :: order, c, columns, which

      allocate (set, in_poses, again, prepared, problem, by_loops, by_poses, other, analysis)
      sketch = links//" VARY='A B','B C','C D','input'"//drive
      if (motion == motion_pose) sketch = links//" VARY='A B','B C','C D','place D','input'"//drive
      if (motion == motion_point .or. motion == motion_distance) sketch = links// &
         " VARY='A B','B C','C D','B P','angle B C B P','place D','input'"//drive
      call read_one('THE OTHER'//nl//" &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,34.0,91.0,21.0,"//nl// &
                    ' JY=0.0,29.0,80.0,5.0,92.0,'//sketch//' &OUTPUTS OUTPUT='//output//' &END'//nl//method//' &END'//nl, set, &
                    findings)
      call study_chain(set, 1.0_wp, 0.0_wp, other)
      columns = size(other%values, 1)
      method_items = ''
      do order = 0, most_rates
         other%values(:, order, :) = other%values(:, order, :)*merge(1.0_wp, 1.05_wp, order < 2)
         write (targets(order), layout) other%values(:, order, :)
         do c = 1, columns
            write (row, layout) other%values(c, order, :)
            which = merge(size(items, 2), c, columns == 1)
            method_items = method_items//' '//trim(items(order, which))//'='//trim(row)//nl
            if (order == 1) method_items = method_items//' W'//items(1, which)(2:)//'=2.0'//nl
            if (order == 2) method_items = method_items//' W'//items(2, which)(2:)//'=1.0,0.0,3.0,0.5,1.0'//nl
         end do
      end do
      call read_one('BY POSES'//nl//" &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0, JY=0.0,31.0,82.0,5.0,95.0,"// &
                    sketch//' &OUTPUTS OUTPUT='//output//', DES1='//trim(targets(0))//nl//' DVEL1='//trim(targets(1))//nl// &
                    ' DACC1='//trim(targets(2))//nl//' WVEL1=2.0, WACC1=1.0,0.0,3.0,0.5,1.0 &END'//nl//method//' &END'//nl//rest, &
                    in_poses, findings)
      call t%is_true(.not. findings%failed(), output//': a sketch with derivatives')
      call read_one('BY LOOPS'//nl//" &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0, JY=0.0,31.0,82.0,5.0,95.0,"// &
                    sketch//' &OUTPUTS OUTPUT='//output//' &END'//nl//method//','//nl//method_items//' &END'//nl//rest, set, &
                    findings)
      call t%equal_integer(findings%count, 0, output//': its loops are read')
      call t%is_true(.not. allocated(set%search_in_poses), output//': a sketch with loops')
      call t%equal_integer(set%method%motion, motion, output//': what is wanted of its loops')
      call prepare(set, none, prepared, findings)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      dimensions = prepared%given
      call analyse(set, problem, dimensions, wanted_t(), analysis)
      call synthesise(set, prepared%vertices, problem, 1, stop, dimensions, by_loops)
      call synthesise_chain(in_poses, 1, stop, by_poses, findings)
      call t%is_true(size(by_loops%found%best) == 1 .and. size(by_poses%best) == 1, output//': both find a linkage', &
                     to_text(size(by_loops%found%best))//' by loops, '//to_text(size(by_poses%best))//' by poses')
      if (size(by_loops%found%best) /= 1 .or. size(by_poses%best) /= 1) return
      call t%close_to(analysis%motion%total/by_poses%first_objective, 1.0_wp, 1.0e-10_wp, output//': objective of the drawing')
      call t%is_true(minval(analysis%motion%part) > 0.0_wp, output//': values and both derivatives have a part in it')
      call t%close_to(sum(analysis%motion%part), analysis%motion%total, 1.0e-13_wp, output//': which add up')
      call t%is_true(by_poses%best(1)%objective < 0.1_wp*by_poses%first_objective, output//': the search gains')
      call t%close_to(by_loops%found%best(1)%objective/by_poses%best(1)%objective, 1.0_wp, 1.0e-5_wp, &
                      output//': least objective by loops and by poses')
      call t%close_to(dimensions%arcl(1)/by_poses%best(1)%x(1), 1.0_wp, 1.0e-3_wp, output//': the crank is the same')
      call analyse(set, problem, dimensions, wanted_t(), analysis)
      call t%close_to(analysis%motion%total/by_loops%found%best(1)%objective, 1.0_wp, 1.0e-9_wp, &
                      output//': the listing has the objective of the search')
      ! device 7 holds the sketch that was found, with what is wanted of it
      call write_data_set(set, problem, dimensions, text)
      call read_one(text%content(), again, findings)
      call t%equal_integer(findings%count, 0, output//': device 7 is read again')
      call t%is_true(all(abs(again%method%rate_desired - set%method%rate_desired) <= 0.0_wp .and. abs(again%method%rate_weight - &
                                                            set%method%rate_weight) &
                         <= 0.0_wp), output//': and wants the same')
      ! &METHOD says the same to a sketch in poses
      call read_in_poses('IN POSES BY &METHOD'//nl//" &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0,"//nl// &
                         ' JY=0.0,31.0,82.0,5.0,95.0,'//sketch//' &OUTPUTS OUTPUT='//output// &
                    ",'y C', WGT2=0.0, DES2=5*0.0 &END"//nl//method//','//nl//method_items//' &END'//nl//rest, in_poses, findings)
      before = by_poses%first_objective
      call synthesise_chain(in_poses, 1, stop, by_poses, findings)
      call t%close_to(by_poses%first_objective/before, 1.0_wp, 1.0e-12_wp, output//': derivatives of &METHOD in poses')
   end subroutine as_in_poses

   !> A closed form: the travel of a Scotch yoke is r cos a, the squares of its speed and acceleration add up to that of r.
   subroutine scotch_yoke()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(desired_rates_t), save :: wanted
      real(wp) :: r
      integer :: i

      call load_case('dyad6_scotch_yoke', problem, set, vary=.true.)
      call let_want(problem)
      call prepare_desired_rates(problem, .false., .false., wanted)
      call find_desired_rates(wanted, problem%given)
      r = problem%given%arcl(1)
      do i = 1, problem%positions
         call t%close_to(hypot(wanted%actual(i, 1, 1), wanted%actual(i, 1, 2)), r, 1.0e-12_wp, &
                         'a Scotch yoke: speed and acceleration')
      end do
   end subroutine scotch_yoke

   !> A linkage at a dead point is refused where a derivative is wanted there; what is open has no derivatives.
   subroutine without_derivatives()
      type(data_set_t), save :: set
      type(diagnostics_t), save :: findings
      type(prepared_t), save :: prepared
      type(problem_t), target :: problem
      type(merit_t), save :: merit
      type(analysis_t), save :: analysis
      type(line_t), save :: none(0)
      type(vertex_problem_t), save :: vertex
      real(wp), allocatable :: first(:)
      real(wp) :: objective
      logical :: feasible
      integer :: k
      character(*), parameter :: rest = '100.0,180.0, DESANG=3*100.0, IVA=0,1,1,0, MOTION=1, DVELANG=0.0,0.0', &
         ending = ' &END &LIMITS TANGLE=90.0 &END'//nl
      character(*), parameter :: last(2) = [character(4) :: ',', ',0.0']

      do k = 1, 2
         ! outstretched at 180 degrees: 120 + 50 = 40 + 130
         call read_one(lengths('120.0,50.0')//rest//trim(last(k))//ending, set, findings)
         call prepare(set, none, prepared, findings)
         call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
         first = problem%parameters%first_values(prepared%given)
         call prepare_merit(set, problem, first, merit)
         call merit%accept(merit%point(first, problem%delt), objective, feasible)
         call t%is_true(feasible .eqv. k == 1, 'a dead point is accepted only where no derivative is wanted')
         call make_vertex_problem(set, problem, vertex)
         call vertex%accept(first, objective, feasible)
         call t%is_true(objective < 1.0e9_wp .eqv. k == 1, 'the same by the simplex')
         call analyse(set, problem, prepared%given, wanted_t(), analysis)
         call t%is_true(all(analysis%motion%closed) .and. .not. analysis%motion%has_rates(3), 'it closes without derivatives')
         call t%close_to(sum(analysis%motion%part), analysis%motion%total, 1.0e-14_wp, 'and what does not exist has no error')
      end do
      call read_one(lengths('110.0,50.0')//rest//',0.0'//ending, set, findings)
      call prepare(set, none, prepared, findings)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call analyse(set, problem, prepared%given, wanted_t(), analysis)
      call t%is_true(.not. (analysis%motion%closed(3) .or. analysis%motion%has_rates(3)), 'open: no derivatives')
      call t%close_to(maxval(abs(analysis%motion%rate_error(3, :, :))), 0.0_wp, 0.0_wp, 'and no error of them')
   end subroutine without_derivatives

   !> The case with other lengths, up to the last of its inputs.
   function lengths(those) result(text)
      character(*), intent(in) :: those
      character(:), allocatable :: text
      integer :: at

      at = index(four_bar, '120.0,80.0')
      text = four_bar(:at - 1)//those//four_bar(at + len('120.0,80.0'):index(four_bar, 'DELT=') + len('DELT=60.0,') - 1)
   end function lengths

   !> Every way to search meets values and slopes of a known crank-rocker, two lengths of which are sought.
   subroutine solvers()
      type(data_set_t), save :: set
      type(diagnostics_t), save :: findings
      type(prepared_t), save :: prepared
      type(problem_t), save :: problem
      type(synthesis_t), save :: found
      type(dimensions_t), save :: dimensions
      type(analysis_t), save :: analysis
      type(line_t), save :: none(0)
      type(stop_t), save :: stop
      type(text_t), save :: text
      character(:), allocatable :: targets
      character(*), parameter :: ways(4) = [character(60) :: '', " &SEARCH SOLVER='LSQ' &END", " &SEARCH SOLVER='LD_SLSQP' &END", &
         " &SEARCH SOLVER='LN_SBPLX', MAXEVAL=4000 &END"]
      character(400) :: line
      integer :: k

      call read_one(four_bar//' &END'//nl, set, findings)
      set%method%desired = .true.
      call prepare(set, none, prepared, findings)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      problem%rate_desired = reshape(spread(0.0_wp, 1, 6), [3, 1, 2])
      problem%rate_weight = problem%rate_desired + 1.0_wp
      call analyse(set, problem, prepared%given, wanted_t(), analysis)
      write (line, '(a,3(f0.9,","),a,3(f0.9,","),a,f0.9,",,",f0.9)') ', DESANG=', analysis%motion%actual(:, 1), ' DVELANG=', &
         analysis%motion%rates(:, 1, 1), ' DACCANG=', analysis%motion%rates(1, 1, 2), analysis%motion%rates(3, 1, 2)
      targets = trim(line)//', WVELANG=500.0, WACCANG=100.0,1.0,50.0'
      do k = 1, size(ways)
         call read_one(changed_length(four_bar)//targets//' &END &LIMITS TANGLE=80.0 &END'//trim(ways(k))//nl, set, findings)
         call t%is_true(.not. findings%failed(), 'a crank-rocker with slopes is read')
         if (findings%failed()) return
         call t%close_to(set%method%rate_weight(2, 1, 2), 0.0_wp, 0.0_wp, 'a value that is left out is not wanted')
         call t%close_to(set%method%rate_weight(3, 1, 1), 500.0_wp, 0.0_wp, 'one weight for all')
         call prepare(set, none, prepared, findings)
         call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
         dimensions = prepared%given
         call synthesise(set, prepared%vertices, problem, 1, stop, dimensions, found)
         call t%close_to(dimensions%arcl(2), 120.0_wp, 1.0e-5_wp, 'coupler found by way '//to_text(k))
         call t%close_to(dimensions%arcl(3), 80.0_wp, 1.0e-5_wp, 'rocker found by way '//to_text(k))
      end do
      ! device 7 says the same
      call write_data_set(set, problem, dimensions, text)
      call analyse(set, problem, dimensions, wanted_t(), analysis)
      call read_one(text%content(), set, findings)
      call t%is_true(.not. findings%failed(), 'device 7 is read again')
      call prepare(set, none, prepared, findings)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call t%is_true(all(abs(problem%rate_weight(:, 1, 2) - [100.0_wp, 0.0_wp, 50.0_wp]) <= 0.0_wp), 'its weights are the same')
      call t%close_to(maxval(abs(problem%rate_desired - set%method%rate_desired)), 0.0_wp, 0.0_wp, 'and what is wanted')
   end subroutine solvers

   !> The case with the lengths that vary given wrong.
   function changed_length(text) result(other)
      character(*), intent(in) :: text
      character(:), allocatable :: other
      integer :: at

      at = index(text, '120.0,80.0')
      other = text(:at - 1)//'126.0,77.0'//text(at + len('120.0,80.0'):)
   end function changed_length

   subroutine notation()
      call reported(', DESANG=3*1.0, DVELANG=4*1.0', '4 values given')
      call reported(', DESANG=3*1.0, WVELANG=1.0', 'weighs DVELANG, which is not given')
      call reported(', DESANG=3*1.0, DVELANG=3*0.0, WVELANG=1.0,2.0', 'is one weight, or one for each of NDES=3 positions; found 2')
      call reported(', DESANG=3*1.0, DACCANG=3*0.0, WACCANG=1.0,-2.0,1.0', 'weights must not be negative')
      call reported(', DESANG=3*1.0, DVELX=3*0.0', 'is of no use: MOTION=1 has the derivatives DVELANG, DACCANG')
      call reported(', DVELANG=3*0.0', 'derivatives are desired in addition to values (DESANG), which are missing')
   end subroutine notation

   subroutine reported(items, words)
      character(*), intent(in) :: items, words
      class(data_set_t), allocatable :: set
      type(diagnostics_t) :: findings

      allocate (set)
      call read_one(four_bar//items//' &END'//nl, set, findings)
      call t%equal_integer(findings%count, 1, 'one message: '//words)
      call t%finds(findings, words, 'message')
   end subroutine reported
end program test_desired_rates
