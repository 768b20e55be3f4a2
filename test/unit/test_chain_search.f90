!> Searches over sketches in poses: exact derivatives against differences, the same optimum as by loops, regions, messages.
program test_chain_search
   use check, only: checks_t
   use poses, only: read_in_poses
   use psalm_cases, only: read_case_text
   use psalm_chain_problem, only: chain_problem_t, make_chain_problem, unknown_name
   use psalm_chain_study, only: chain_study_t, study_chain, inputs_of_drives
   use psalm_chain_synthesis, only: chain_synthesis_t, synthesise_chain
   use psalm_clearances, only: clearance_t, list_clearances
   use psalm_closure, only: closure_t, state_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp
   use psalm_output_targets, only: output_targets_t, prepare_output_targets, find_output_targets, differentiate_output_targets
   use psalm_parameters, only: variable_aside, variable_aside_angle, words_of
   use psalm_place, only: beside_t
   use psalm_preparation, only: prepared_t, prepare
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples, linearise_samples
   use psalm_sketch_assembly, only: assemble_sketch
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_synthesis, only: synthesis_t, synthesise
   use psalm_dimensions, only: dimensions_t
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   !> Stephenson's second six-bar driven in its five-bar loop.
   character(*), parameter :: six_bar = " &CHAIN JNT='A','B','C','D','E','F','G', JX=0.0,0.0,40.0,80.0,45.0,85.0,100.0,"//nl// &
      " JY=0.0,30.0,60.0,55.0,30.0,20.0,0.0, LNAME='frame','crank','left','top','right','tie',"//nl// &
      " LNK='A G','A B','B C E','C D','D F G','E F', VARY='A B','C D','E F','B E','angle B C B E','place G','place A','input'"
   character(*), parameter :: four_bar = " &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0,"//nl// &
      " JY=0.0,31.0,82.0,5.0,95.0, LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D',"//nl// &
      " VARY='A B','B C','C D','B P','angle B C B P','place D','input' &END &DRIVES DRIVE='A' &END"//nl
   character(*), parameter :: limits = " &LIMITS TANGLE=89.0, TOGGLE=0.0 &END"//nl
   type(checks_t) :: t

   call derivatives()
   call dimensions_of_a_drawing()
   call same_as_loops()
   call timing_and_range()
   call off_the_arcs()
   call regions()
   call one_valley()
   call floating_cylinder()
   call refused()
   call t%report()

contains

   subroutine read_one(text, set, findings)
      character(*), intent(in) :: text
      type(data_set_t), intent(out) :: set
      type(diagnostics_t), intent(out) :: findings
      type(data_set_t), allocatable :: sets(:)

      call read_case_text(text, 'test', sets, findings, 'psalm')
      set = sets(1)
   end subroutine read_one

   !> Every derivative by every unknown against central differences: places, angles, ratios, first and second derivatives.
   subroutine derivatives()
      type(data_set_t) :: set
      type(diagnostics_t) :: findings
      type(chain_problem_t) :: problem
      type(closure_t) :: closure
      type(state_t) :: state
      real(wp), allocatable :: r(:), up(:), down(:), jacobian(:, :), x(:), slope(:)
      real(wp) :: worst
      real(wp), parameter :: h = 1.0e-4_wp
      character(:), allocatable :: failure
      integer :: which, v
      logical :: valid

      call read_one('DERIVATIVES'//nl//six_bar//" &END &DRIVES DRIVE='A' &END"//nl// &
                    " &OUTPUTS OUTPUT='point D','angle G D','distance B F','y E','ratio y_E distance_B_F',"//nl// &
                    ' DES1=6*0.0, DES2=3*0.0, DES3=3*1.0, DES5=3*0.0, DVEL1=6*1.0, DVEL2=3*0.1, DVEL3=3*0.0, DACC1=6*0.0,'//nl// &
                    ' DACC2=3*0.0, DACC3=3*1.0, WVEL1=2.0 &END &METHOD NDES=3, DELT=-12.0,-15.0,-20.0, IFREE=1 &END'//nl// &
                    " &SEARCH SOLVER='LSQ' &END &CONSTR IRANGE=1 &END"//nl, set, findings)
      call t%equal_integer(findings%count, 0, 'desired derivatives are read')
      if (findings%failed()) return
      call assemble_sketch(set, closure, state, valid, findings)
      call make_chain_problem(set, closure, state, inputs_of_drives(set, .true.), problem, failure, which)
      call t%equal_integer(which, 0, 'all variables vary')
      call t%equal_integer(problem%core, 13, 'eight variables have ten unknowns, and three inputs follow')
      call t%equal_text(unknown_name(set%sketch, 7), 'direction of G', 'the second number of a place')
      allocate (r(problem%residuals), up(problem%residuals), down(problem%residuals), jacobian(problem%residuals, problem%core))
      x = problem%first*1.003_wp
      call problem%residuals_at(x, r, jacobian)
      do v = 1, problem%core
         x(v) = x(v) + h
         call problem%residuals_at(x, up)
         x(v) = x(v) - 2.0_wp*h
         call problem%residuals_at(x, down)
         slope = 8.0_wp*(up - down)
         x(v) = x(v) - h
         call problem%residuals_at(x, down)
         x(v) = x(v) + 4.0_wp*h
         call problem%residuals_at(x, up)
         x(v) = x(v) - 2.0_wp*h
         slope = (slope - (up - down))/(12.0_wp*h)
         worst = maxval(abs(slope - jacobian(:, v)))/max(1.0_wp, maxval(abs(jacobian(:, v))))
         call t%close_to(worst, 0.0_wp, 2.0e-6_wp, 'derivatives by '//unknown_name(set%sketch, v))
      end do
      call slopes(problem, x)
   end subroutine derivatives

   !> The dimensions of a drawing give it again, an angle being counted from a line named backwards; so does a length backwards in
   !> the opposite direction, from which another angle is counted, and it is shown by a positive one. The range of the inputs does
   !> not begin at the drawing.
   subroutine dimensions_of_a_drawing()
      character(*), parameter :: coupler = " &CHAIN JNT='A','B','C','D','P','Q', JX=0.0,-4.0,33.0,90.0,20.0,50.0,"//nl// &
         " JY=0.0,31.0,82.0,5.0,95.0,110.0, LNK='A D','A B','B C P Q','C D', VARY='B C','B P','angle C B B P','B Q','angle B P B Q'"
      type(data_set_t), save :: set
      type(diagnostics_t), save :: findings
      type(chain_problem_t), save :: problem
      type(closure_t), save :: closure
      type(state_t), save :: state
      real(wp), allocatable :: r(:), x(:)
      character(:), allocatable :: failure
      integer :: which
      logical :: valid

      call read_one('A DRAWING'//nl//coupler//" &END &DRIVES DRIVE='A' &END"//nl// &
                    " &OUTPUTS OUTPUT='x P','y P','x Q','y Q', DES1=20.0, DES2=95.0, DES3=50.0, DES4=110.0 &END"//nl// &
                    " &METHOD NDES=1, DELT=0.0 &END &SEARCH SOLVER='LSQ' &END &CONSTR IRANGE=1 &END"//nl, set, findings)
      call t%equal_integer(findings%count, 0, 'a drawing is read')
      if (findings%failed()) return
      call assemble_sketch(set, closure, state, valid, findings)
      call make_chain_problem(set, closure, state, inputs_of_drives(set, .true.), problem, failure, which)
      call t%equal_integer(which, 0, 'all its variables vary')
      call t%is_true(all([(problem%is_length(which), which=1, problem%variables)] .eqv. &
                         [.true., .true., .false., .true., .false.]), 'lengths and angles')
      allocate (r(problem%residuals))
      x = problem%first
      call problem%residuals_at(x, r)
      call t%close_to(maxval(abs(r)), 0.0_wp, 1.0e-9_wp, 'the dimensions of a drawing give it again')
      x(2) = -x(2)
      x(3) = x(3) + 180.0_wp
      x(5) = x(5) - 180.0_wp
      call problem%residuals_at(x, r)
      call t%close_to(maxval(abs(r)), 0.0_wp, 1.0e-9_wp, 'and so does a length backwards')
      call problem%settle_signs(x)
      call t%close_to(maxval(abs(x - problem%first)), 0.0_wp, 1.0e-9_wp, 'which is shown by a positive one')
      problem%delt = [5.0_wp, 10.0_wp]
      call problem%set_range(x)
      call t%close_to(minval(problem%between), 5.0_wp, 1.0e-12_wp, 'the range begins at the least input')
      call t%close_to(maxval(problem%between), 10.0_wp, 1.0e-12_wp, 'and ends at the greatest')
      call read_one('A CIRCLE'//nl//six_bar(:index(six_bar, 'VARY') - 1)//"VARY='B C','C B' &END &DRIVES DRIVE='A' &END"//nl// &
                    " &OUTPUTS OUTPUT='point D', DES1=80.0,55.0 &END &METHOD NDES=1, DELT=0.0 &END"//nl, set, findings)
      call assemble_sketch(set, closure, state, valid, findings)
      call make_chain_problem(set, closure, state, inputs_of_drives(set, .true.), problem, failure, which)
      call t%equal_integer(which, 2, 'two joints that are counted from each other')
      call t%equal_text(failure, 'joint B is counted from C, and that in the end from B', 'what is wrong with them')
   end subroutine dimensions_of_a_drawing

   !> Slopes of constraints at the positions and over the range against central differences, where they were found.
   subroutine slopes(problem, x)
      type(chain_problem_t), intent(in) :: problem
      real(wp), intent(in) :: x(:)
      real(wp), parameter :: h = 1.0e-4_wp
      real(wp) :: c(problem%inequalities), up(problem%inequalities), down(problem%inequalities)
      real(wp) :: by(size(x), problem%inequalities), moved(size(x)), worst
      integer :: v

      call problem%constraints_at(x, c, by)
      worst = 0.0_wp
      do v = 1, size(x)
         moved = x
         moved(v) = x(v) + h
         call problem%constraints_at(moved, up)
         moved(v) = x(v) - h
         call problem%constraints_at(moved, down)
         worst = max(worst, maxval(abs((up - down)/(2.0_wp*h) - by(v, :)), mask=any(abs(by) > 0.0_wp, dim=1)))
      end do
      call t%is_true(count(any(abs(by) > 0.0_wp, dim=1)) > 3, 'constraints over the range have slopes')
      call t%close_to(worst, 0.0_wp, 1.0e-5_wp, 'slopes of constraints')
   end subroutine slopes

   !> Free timing and constraints over a full turn: the same optimum by loops and in poses.
   subroutine timing_and_range()
      character(*), parameter :: sketch = " &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0,"//nl// &
         " JY=0.0,24.0,82.0,5.0,95.0, LNK='A D','A B','B C P','C D',"//nl// &
         " VARY='A B','B C','C D','B P','angle B C B P','place D' &END"//nl// &
         " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point P' &END"//nl
      character(*), parameter :: points = ', NDES=12, DELT=0.,30.,60.,90.,120.,150.,180.,210.,240.,270.,300.,330.,'//nl// &
         ' DESX=20.5,13.6591,5.9076,-2.213,-6.8939,-9.3947,-10.997,-8.1958,-1.4281,8.2893,19.6619,24.5661,'//nl// &
         ' DESY=92.,85.8572,76.9971,67.5083,59.1688,53.2403,50.9029,53.7396,63.1528,77.147,88.7486,93.5215 &END'//nl// &
         " &SEARCH SOLVER='LSQ' &END"//nl
      character(*), parameter :: asked(*) = [character(60) :: ' &METHOD IFREE=1', &
                                             ' &CONSTR IRANGE=2, TRMIN=45. &END &METHOD IFREE=0', &
                                             ' &CONSTR IRANGE=2, TRMIN=45. &END &METHOD IFREE=1', &
                                             ' &CONSTR IRANGE=1, TRMIN=50. &END &METHOD IFREE=0']
      type(data_set_t), save :: set
      type(diagnostics_t), save :: findings
      type(prepared_t), save :: prepared
      type(problem_t), save :: problem
      type(synthesis_t), save :: by_loops
      type(chain_synthesis_t), save :: by_poses
      type(dimensions_t), save :: dimensions
      type(line_t), save :: none(0)
      type(stop_t), save :: stop
      integer :: k

      do k = 1, size(asked)
         call read_one('BY LOOPS'//nl//sketch//trim(asked(k))//points, set, findings)
         call t%equal_integer(findings%count, 0, 'read:'//trim(asked(k)))
         call prepare(set, none, prepared, findings)
         call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
         dimensions = prepared%given
         call synthesise(set, prepared%vertices, problem, 1, stop, dimensions, by_loops)
         call read_in_poses('BY POSES'//nl//sketch//trim(asked(k))//points, set, findings)
         call synthesise_chain(set, 1, stop, by_poses, findings)
         call t%is_true(size(by_loops%found%best) > 0 .and. size(by_poses%best) > 0, 'both find a linkage:'//trim(asked(k)))
         if (size(by_loops%found%best) == 0 .or. size(by_poses%best) == 0) cycle
         call t%close_to(by_poses%best(1)%objective/by_loops%found%best(1)%objective, 1.0_wp, 1.0e-5_wp, &
                         'the same optimum:'//trim(asked(k)))
         if (index(asked(k), 'IFREE=1') == 0) cycle
         call t%close_to(maxval(abs(by_poses%drawn%method%delt - by_loops%found%best(1)%delt)), 0.0_wp, 2.0e-2_wp, &
                         'the same inputs:'//trim(asked(k)))
         call t%equal_integer(by_poses%drawn%method%ifree, 0, 'which the case of the linkage found has')
      end do
   end subroutine timing_and_range

   !> A four-bar has loops and poses: what another one does is found again by either, the desired values being those of &METHOD or
   !> of &OUTPUTS.
   subroutine same_as_loops()
      type(data_set_t), save :: set
      type(diagnostics_t), save :: findings
      type(prepared_t), save :: prepared
      type(problem_t), save :: problem
      type(synthesis_t), save :: by_loops
      type(chain_synthesis_t), save :: by_poses
      type(chain_study_t), save :: other, study
      type(dimensions_t), save :: dimensions
      type(line_t), save :: none(0)
      type(stop_t), save :: stop
      character(*), parameter :: method = ' &METHOD NDES=6, DELT=0.0,20.0,40.0,60.0,80.0,100.0', &
                                 search = " &SEARCH SOLVER='LSQ' &END"//nl
      character(200) :: x, y

      call read_one('THE OTHER'//nl//" &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,34.0,91.0,21.0,"//nl// &
                    " JY=0.0,29.0,80.0,5.0,92.0, LNK='A D','A B','B C P','C D' &END &DRIVES DRIVE='A' &END"//nl// &
                    " &OUTPUTS OUTPUT='point P' &END"//nl//method//' &END'//nl, set, findings)
      call study_chain(set, 1.0_wp, 0.0_wp, other)
      write (x, '(6(f0.8,","))') other%values(1, 0, :)
      write (y, '(6(f0.8,","))') other%values(2, 0, :)
      call read_one('BY LOOPS'//nl//four_bar//" &OUTPUTS OUTPUT='point P' &END"//nl//search//method//', DESX='//trim(x)//nl// &
                    ' DESY='//trim(y)//' &END'//nl//limits, set, findings)
      call t%is_true(.not. allocated(set%search_in_poses), 'desired values of &METHOD leave a four-bar its loops')
      call prepare(set, none, prepared, findings)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      dimensions = prepared%given
      call synthesise(set, prepared%vertices, problem, 1, stop, dimensions, by_loops)
      call read_in_poses('BY POSES'//nl//four_bar// &
                         " &OUTPUTS OUTPUT='x P','y P',"//nl//' DES1='//trim(x)//nl//' DES2='//trim(y)// &
                    ' &END'//nl//search// &
                    method//' &END'//nl//limits, set, findings)
      call synthesise_chain(set, 1, stop, by_poses, findings)
      call t%is_true(size(by_loops%found%best) > 0 .and. size(by_poses%best) > 0, 'both find a linkage')
      if (size(by_loops%found%best) == 0 .or. size(by_poses%best) == 0) return
      call t%is_true(by_poses%first_objective > 1.0_wp, 'the drawing is another linkage')
      call t%is_true(by_loops%found%best(1)%objective < 1.0e-9_wp, 'found by loops')
      call t%is_true(by_poses%best(1)%objective < 1.0e-7_wp, 'found by poses')
      call t%close_to(by_poses%best(1)%x(1), 29.274562336609_wp, 1.0e-5_wp, 'the crank is that of the other linkage')
      call study_chain(by_poses%drawn, 1.0_wp, 0.0_wp, study)
      call t%close_to(maxval(abs(study%values(:, 0, :) - other%values(:, 0, :))), 0.0_wp, 1.0e-4_wp, &
                      'the sketch drawn anew does what the other one does')
   end subroutine same_as_loops

   !> A joint off the arcs: its distance and angle vary by loops. Derivatives against differences, and either route finds the
   !> same optimum.
   subroutine off_the_arcs()
      character(*), parameter :: links = " LNK='A D','A B','B C P Q','C D'", &
         method = ' &METHOD NDES=6, DELT=0.,20.,40.,60.,80.,100. &END'//nl//" &SEARCH SOLVER='LSQ' &END"//nl
      type(data_set_t), save :: set
      type(diagnostics_t), save :: findings
      type(prepared_t), save :: prepared
      type(problem_t), save :: problem
      type(synthesis_t), save :: by_loops
      type(chain_synthesis_t), save :: by_poses
      type(chain_study_t), save :: other
      type(dimensions_t), save :: dimensions
      type(line_t), save :: none(0)
      type(stop_t), save :: stop
      character(:), allocatable :: text
      character(400) :: p, q

      call read_one('THE OTHER'//nl//" &CHAIN JNT='A','B','C','D','P','Q', JX=0.,-4.,34.,91.,21.,46.,"//nl// &
                    ' JY=0.,29.,80.,5.,92.,101.,'//links//" &END &DRIVES DRIVE='A' &END"//nl// &
                    " &OUTPUTS OUTPUT='point P','point Q' &END"//nl//method, set, findings)
      call study_chain(set, 1.0_wp, 0.0_wp, other)
      write (p, '(12(f0.8,","))') other%values(1:2, 0, :)
      write (q, '(12(f0.8,","))') other%values(3:4, 0, :)
      text = " &CHAIN JNT='A','B','C','D','P','Q', JX=0.,-4.,33.,90.,20.,45., JY=0.,31.,82.,5.,95.,103.,"//links//','//nl// &
             " VARY='A B','B C','C D','B P','angle B C B P','B Q','angle C B B Q','place D' &END &DRIVES DRIVE='A' &END"//nl// &
             " &OUTPUTS OUTPUT='point P','point Q', DES1="//trim(p)//nl//' DES2='//trim(q)//nl//' &END'//nl//method//limits
      call read_one('BY LOOPS'//nl//text, set, findings)
      call t%is_true(.not. findings%failed() .and. .not. allocated(set%search_in_poses), 'off the arcs: by loops')
      if (findings%failed()) return
      call prepare(set, none, prepared, findings)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      associate (variables => problem%parameters%variables)
         call t%equal_integer(count(variables%kind == variable_aside), 1, 'a distance off the arcs')
         call t%equal_integer(count(variables%kind == variable_aside_angle), 1, 'and an angle')
         call t%equal_text(words_of(variables(findloc(variables%kind, variable_aside, dim=1))), 'length B Q', 'their names')
      end associate
      dimensions = prepared%given
      call synthesise(set, prepared%vertices, problem, 1, stop, dimensions, by_loops)
      call read_in_poses('BY POSES'//nl//text, set, findings)
      call synthesise_chain(set, 1, stop, by_poses, findings)
      call t%is_true(size(by_loops%found%best) > 0 .and. size(by_poses%best) > 0, 'off the arcs: both find a linkage')
      if (size(by_loops%found%best) == 0 .or. size(by_poses%best) == 0) return
      call t%close_to(by_poses%best(1)%objective/by_loops%found%best(1)%objective, 1.0_wp, 1.0e-4_wp, &
                      'off the arcs: the same optimum')
      call t%is_true(by_loops%found%best(1)%objective < 1.0e-2_wp*by_poses%first_objective, 'which is better than the drawing')
      ! the angle of 'B Q' is given from C B, half a turn from where the other is counted
      call read_one('CHANGES'//nl//text(:index(text, ' DES1') - 1)//' DES1=12*50., DES2=12*60., DVEL2=12*10. &END'//nl//method// &
                    " &CONSTR RKIND=3, RPLACE=0.,0.,1.,0., RJNT='Q' &END"//nl, set, findings)
      call prepare(set, none, prepared, findings)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call compare_changes(set, problem)
   end subroutine off_the_arcs

   !> Changes of desired outputs, of their rates and of the joint of a region against central differences.
   subroutine compare_changes(set, problem)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      real(wp), parameter :: h = 1.0e-5_wp
      type(output_targets_t), allocatable :: targets
      type(sample_set_t), allocatable :: samples
      type(clearance_t), allocatable :: clearances(:)
      type(beside_t), allocatable :: beside(:)
      type(dimensions_t) :: dimensions
      integer, allocatable :: joints(:, :)
      real(wp), allocatable :: by(:, :, :), up(:, :), joint_by(:, :, :, :), joint_up(:, :, :), values(:), moved(:)
      integer :: v

      allocate (targets, samples)
      call prepare_output_targets(set, problem, .false., .true., targets)
      call list_clearances(set%constr, problem%mechanism, problem%given%outlk <= 0.0_wp, clearances, joints, beside)
      call t%equal_integer(size(joints, 2), 1, 'one joint has a region')
      call prepare_samples(problem, problem%delt, .false., joints, .true., samples, beside)
      dimensions = problem%given
      values = problem%parameters%first_values(dimensions)
      call differentiate_output_targets(targets, dimensions)
      call linearise_samples(samples, dimensions)
      by = targets%by
      joint_by = samples%djoints
      do v = 1, size(values)
         moved = values
         moved(v) = values(v) + h
         call problem%parameters%apply(moved, dimensions)
         call find_output_targets(targets, dimensions)
         call evaluate_samples(samples, dimensions)
         up = targets%miss
         joint_up = samples%joints
         moved(v) = values(v) - h
         call problem%parameters%apply(moved, dimensions)
         call find_output_targets(targets, dimensions)
         call evaluate_samples(samples, dimensions)
         call t%close_to(maxval(abs((up - targets%miss)/(2.0_wp*h) - by(:, v, :))), 0.0_wp, 1.0e-6_wp, &
                         'outputs by '//words_of(problem%parameters%variables(v)))
         call t%close_to(maxval(abs((joint_up - samples%joints)/(2.0_wp*h) - joint_by(:, :, :, v))), 0.0_wp, 1.0e-6_wp, &
                         'the joint of a region by '//words_of(problem%parameters%variables(v)))
      end do
   end subroutine compare_changes

   !> A region is kept by the search.
   subroutine regions()
      type(data_set_t) :: set
      type(diagnostics_t) :: findings, refused
      type(chain_synthesis_t) :: free, kept, in_stages
      type(chain_study_t) :: study
      type(stop_t) :: stop
      character(16) :: place
      real(wp) :: edge
      integer :: k
      character(*), parameter :: wanted = " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point D',"// &
         ' DES1=72.,51.5,71.,51.,70.,50.,69.,50. &END &METHOD NDES=4, DELT=-12.0,-14.0,-16.0,-18.0 &END'//nl// &
         " &SEARCH SOLVER='LSQ' &END"//nl

      call read_one('FREE'//nl//six_bar(:index(six_bar, 'VARY') - 1)//" VARY='A B','C D','E F' &END"//wanted, set, findings)
      call synthesise_chain(set, 1, stop, free, findings)
      call t%equal_integer(size(free%best), 1, 'a search without regions')
      if (size(free%best) == 0) return
      call study_chain(free%drawn, 1.0_wp, 0.0_wp, study)
      edge = maxval([(study%motion%states(k)%joint(3, 0)%im, k=1, 4)]) - 0.2_wp
      write (place, '(f0.6)') edge
      call read_one('KEPT'//nl//six_bar(:index(six_bar, 'VARY') - 1)//" VARY='A B','C D','E F' &END"//wanted// &
                    " &CONSTR NREGN=1, RKIND=2, RJNT='C', RPLACE=0.0,"//trim(place)//',0.0,0.0 &END'//nl, set, findings)
      call t%equal_integer(findings%count, 0, 'a region of a joint by its name')
      call synthesise_chain(set, 1, stop, kept, findings)
      call t%equal_integer(size(kept%best), 1, 'a search with a region')
      if (size(kept%best) == 0) return
      call study_chain(kept%drawn, 1.0_wp, 0.0_wp, study)
      call t%is_true(all([(study%motion%states(k)%joint(3, 0)%im, k=1, 4)] < edge + 1.0e-6_wp), 'C keeps below the edge')
      call t%is_true(kept%best(1)%objective < kept%first_objective, 'and comes nearer to what is wanted')
      set%search%few = 2
      set%search%nstart = 2
      call synthesise_chain(set, 1, stop, in_stages, findings)
      call t%equal_integer(size(in_stages%best), 1, 'a search with few positions first')
      if (size(in_stages%best) == 0) return
      call t%close_to(in_stages%best(1)%objective, kept%best(1)%objective, 0.01_wp, 'leads to the same valley')
      call t%equal_integer(in_stages%starts, 2, 'whose starts')
      call t%is_true(in_stages%evaluations > kept%evaluations, 'are made in stages')
      set%search%few = 0
      set%search%by_dyads = .true.
      call synthesise_chain(set, 1, stop, kept, refused)
      call t%finds(refused, '&SEARCH IDYAD: a search in the poses of links does not take the linkage apart into dyads', &
                   'IDYAD is refused')
   end subroutine regions

   !> Where a joint is that nothing is wanted of but to stay in a half-plane changes no objective: all starts end in one valley, and
   !> one linkage is listed.
   subroutine one_valley()
      type(data_set_t), save :: set
      type(diagnostics_t), save :: findings
      type(chain_synthesis_t), save :: search
      type(stop_t), save :: stop

      call read_one('VALLEY'//nl//" &CHAIN JNT='A','B','C','D','E','F','G','P', JX=0.0,0.0,40.0,80.0,45.0,85.0,100.0,-28.7,"//nl// &
                    " JY=0.0,30.0,60.0,55.0,30.0,20.0,0.0,21.3, LNAME='frame','crank','left','top','right','tie',"//nl// &
                    " LNK='A G','A B','B C E P','C D','D F G','E F', VARY='E F','B P','angle B C B P' &END"//nl// &
                    " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point D', DES1=72.,51.5,69.,50. &END"//nl// &
                    " &METHOD NDES=2, VAR=0.5, DELT=-12.0,-18.0 &END"//nl// &
                    " &SEARCH SOLVER='LSQ', NSTART=8, NBEST=8, DIFFER=0.001 &END"//nl// &
                    " &CONSTR NREGN=1, RKIND=2, RJNT='P', RPLACE=-15.0,0.0,-90.0,0.0 &END"//nl, set, findings)
      call t%is_true(.not. findings%failed(), 'a joint that nothing depends on')
      call synthesise_chain(set, 1, stop, search, findings)
      call t%is_true(search%feasible > 1, 'several starts lead to a linkage')
      call t%equal_integer(size(search%best), 1, 'linkages that differ in what does not count are one')
   end subroutine one_valley

   !> Several drives, one of them a floating cylinder: what a linkage of known dimensions does is found again.
   subroutine floating_cylinder()
      type(data_set_t), save :: set
      type(diagnostics_t), save :: findings
      type(chain_study_t), save :: study
      type(chain_synthesis_t), save :: search
      type(stop_t), save :: stop
      character(*), parameter :: rest = " JY=1.5,1.0,3.4,3.9,3.2,3.9,3.7,1.9,1.6,2.3,2.4,0.5,"//nl// &
         " LNAME='base','boom','stick','tie','rocker','bucket', LNK='AB','ACDE','EFGHK','HJ','JI','KIT',"//nl// &
         " VARY='A C','H J','K T','angle K I K T' &END"//nl// &
         " &DRIVES DRIVE='BC','DF','GJ', DELT2=0.0,0.1,0.2,0.0, DELT3=0.0,-0.1,0.0,0.1 &END"//nl// &
         ' &METHOD NDES=4, DELT=0.0,0.05,0.1,0.15 &END'//nl
      character(200) :: targets

      call read_one('EXCAVATOR'//nl//" &CHAIN JNT='A','B','C','D','E','F','G','H','I','J','K','T',"//nl// &
                    ' JX=0.0,0.5,2.6,2.9,5.2,4.6,5.0,6.0,6.6,6.3,5.9,7.0,'//rest//" &OUTPUTS OUTPUT='point T' &END"//nl, &
                    set, findings)
      call study_chain(set, 1.0_wp, 0.0_wp, study)
      write (targets, '(8(f0.9,","))') study%values(:, 0, :)
      call read_one('EXCAVATOR'//nl//" &CHAIN JNT='A','B','C','D','E','F','G','H','I','J','K','T',"//nl// &
                    ' JX=0.0,0.5,2.6,2.9,5.2,4.6,5.0,6.0,6.6,6.3,5.9,7.1,'//rest//" &OUTPUTS OUTPUT='point T',"//nl// &
                    ' DES1='//trim(targets)//" &END &SEARCH SOLVER='LSQ' &END &LIMITS TANGLE=90.0 &END"//nl, set, findings)
      call t%is_true(.not. findings%failed(), 'an excavator with desired places')
      call synthesise_chain(set, 1, stop, search, findings)
      call t%equal_integer(size(search%best), 1, 'the excavator: a linkage is found')
      if (size(search%best) == 0) return
      call t%is_true(search%best(1)%objective < 1.0e-3_wp*search%first_objective, 'it comes near to what was wanted')
   end subroutine floating_cylinder

   subroutine refused()
      call reported(" &END &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point D', DES1=1.0,2.0 &END &METHOD NDES=2, DELT=0.0,1.0 &END", &
                'have 4 values, but only 2 given')
      call reported(" &END &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point D', WVEL1=1.0 &END &METHOD NDES=1, DELT=0.0 &END", &
                'weighs DVEL1, which is not given')
      call reported(" &END &DRIVES DRIVE='A' &END &METHOD NDES=1, DELT=0.0 &END &CONSTR NREGN=1, RKIND=3, "// &
                'RPLACE=0.,0.,1.,0. &END', 'the joint that it is for is missing')
      call reported(" &END &DRIVES DRIVE='A' &END &METHOD NDES=1, DELT=0.0 &END &CONSTR NREGN=1, RKIND=3, RJNT='Q', "// &
                'RPLACE=0.,0.,1.,0. &END', "no joint is called 'Q'")
      call reported(" &END &DRIVES DRIVE='A' &END &METHOD NDES=1, DELT=0.0 &END &CONSTR NSEG=1, SJNT='A Q' &END", &
                "no joint is called 'Q'")
      call reported(" &END &DRIVES DRIVE='A' &END &METHOD NDES=1, DELT=0.0 &END &CONSTR NSEG=1, SJNT='A' &END", &
                "two joints are expected, as 'A B'; found 'A'")
      call reported(" &END &DRIVES DRIVE='A' &END &METHOD NDES=1, DELT=0.0 &END &CONSTR NSEG=2, SJNT='A D' &END", &
                'the two joints between which it lies are missing')
      call reported(" &END &DRIVES DRIVE='A' &END &METHOD NDES=1, DELT=0.0 &END &CONSTR NSEG=1, SLINK=1,2, SLOOP=1,1 &END", &
                'the joints of a sketch are named, SJNT')
   end subroutine refused

   subroutine reported(rest, words)
      character(*), intent(in) :: rest, words
      type(data_set_t) :: set
      type(diagnostics_t) :: findings

      call read_one('REFUSED'//nl//six_bar//rest//nl, set, findings)
      call t%equal_integer(findings%count, 1, 'one message: '//words)
      call t%finds(findings, words, 'message')
   end subroutine reported
end program test_chain_search
