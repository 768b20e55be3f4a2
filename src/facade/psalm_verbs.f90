!> The studies of the library, a verb each: data in, results out. Nothing is printed, no file is written, no signal is touched.
!>
!> Every verb takes a case and gives its result as a type, with names of joints, links and outputs in it. Whatever is wrong with the
!> case comes back as findings; the result is then empty. With `report` it also gives what the programs of the suite write: listing,
!> tables, pictures, the linkages found as cases for the next study. `study` calls any verb by its name.
module psalm_verbs
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use psalm_analysis, only: analysis_t, wanted_t, study_analysis => analyse, wanted_by
   use psalm_assembly_list, only: report_assemblies
   use psalm_assembly_study, only: assembly_study_t, study_assemblies
   use psalm_board, only: write_board
   use psalm_cam_code, only: write_cam_code
   use psalm_cam_data, only: cam_group_t
   use psalm_cam_dxf, only: write_cam_dxf
   use psalm_cam_group, only: cams_of
   use psalm_cam_page, only: write_cam_page
   use psalm_cam_report, only: report_cam, report_cam_search => report_search
   use psalm_cam_scene, only: cam_scene_t, make_cam_scene
   use psalm_cam_search, only: cam_search_t, search_cam
   use psalm_cam_study, only: cam_study_t, cam_role_t, check_cam, find_cam, parts_of
   use psalm_cam_svg, only: write_cam_svg
   use psalm_case, only: case_t, make_ready, of_text, set_of, tell
   use psalm_cases, only: resolve_drawn
   use psalm_chain_proof_study, only: chain_proof_t, prove_loops
   use psalm_chain_report, only: report_chain_proof, report_outputs, report_still_drives, unreached_words
   use psalm_chain_search_list, only: report_chain_search
   use psalm_chain_study, only: chain_study_t
   use psalm_chain_synthesis, only: chain_synthesis_t, synthesise_chain
   use psalm_clearance_group, only: clearance_of
   use psalm_clearance_report, only: report_clearance
   use psalm_clearance_study, only: clearance_study_t, check_clearance, study_clearance => find_clearance
   use psalm_clearance_svg, only: write_clearance_svg
   use psalm_data_set, only: data_set_t
   use psalm_data_set_text, only: write_data_set
   use psalm_devices, only: devices_t, drawing_t
   use psalm_dimensions, only: dimensions_t
   use psalm_drawing, only: picture_t, draw_file
   use psalm_error, only: problem_t, motion_t, inputs_of, make_problem
   use psalm_exact_run, only: study_all_exact
   use psalm_exact_report, only: report_exact
   use psalm_exact_study, only: exact_study_t, check_exact
   use psalm_family_list, only: report_family
   use psalm_family_study, only: family_t, study_family => find_family
   use psalm_finale, only: describe_violation, mark_beyond
   use psalm_force_study, only: force_study_t, study_forces => find_forces
   use psalm_kinds, only: wp
   use psalm_machine_study, only: machine_study_t, study_machine => find_machine
   use psalm_margin_list, only: describe_margin
   use psalm_margins, only: is_violated
   use psalm_muscle_report, only: report_muscle
   use psalm_muscle_study, only: muscle_study_t, check_muscle, study_muscle => find_muscle
   use psalm_nlp, only: nlp_t
   use psalm_picture_report, only: report_picture
   use psalm_picture_study, only: pictured_t, make_scenes
   use psalm_position_table, only: put_positions, put_rates, put_sketch
   use psalm_preparation, only: demand_t, prepared_t, prepare, threads_for
   use psalm_proof_study, only: proof_study_t, study_proof, proof_wanted, no_proof, proof_of_inputs
   use psalm_rate_study, only: rate_study_t, study_rates => find_rates
   use psalm_report, only: begin_search_report, report_analysis, report_found, report_proof, report_rates, report_search, &
                           report_summary, report_tolerances, report_violations
   use psalm_search_group, only: most_search_threads
   use psalm_search_log, only: search_log_t, begin_log
   use psalm_sketch_study, only: sketch_study_t, study_sketch
   use psalm_sketch_text, only: variant_t, variant_of
   use psalm_solver, only: observer_t, search_state_t, solver_t, ending_t, stop_refused
   use psalm_solver_kind, only: solver_kind_t, find_solver, solver_names, family_unknown
   use psalm_solvers, only: new_solver
   use psalm_source, only: line_t, split_lines
   use psalm_status, only: findings_t => diagnostics_t, exit_violation
   use psalm_steady_report, only: report_steady
   use psalm_steady_study, only: steady_study_t, check_steady, study_steady => find_steady
   use psalm_stop, only: stop_t
   use psalm_summary, only: summary_t, study_summary => summarise
   use psalm_synthesis, only: synthesis_t, study_synthesis => synthesise
   use psalm_tables, only: table_t, tables_t, for_plots, table_of, tables_of
   use psalm_text, only: text_t, lower_case, nearest_name, upper_case, to_text
   use psalm_tolerance, only: tolerances_t, study_tolerances
   implicit none (type, external)
   private
   public :: report_t, column_named, verb_t, verbs, study
   public :: analyse, find_rates, find_forces, find_machine, find_tolerances, find_family, synthesise, found_case, find_exact, &
             proven_t, prove, find_assemblies, find_balance, find_springs, cams_t, find_cams, find_vibration, find_clearance, &
             summarise, draw, make_board, minimise

   integer, parameter :: verb_length = 12, program_length = 6, groups_length = 30
   integer, parameter :: accelerations = 2     !! orders of rates in tables
   type(demand_t), parameter :: demand_of_psalm = demand_t(), demand_of_rates = demand_t(position=1000, arc=400), &
                                demand_of_muscle = demand_t(position=4000, arc=1000)

   !> A verb: its name, the program of the suite that has it, the groups that ask for it (none: every case may be asked).
   type :: verb_t
      character(verb_length) :: name
      character(program_length) :: program
      character(groups_length) :: groups
   end type verb_t

   !> All verbs that `study` knows.
   type(verb_t), parameter :: verbs(*) = [ &
      verb_t('analysis', 'psalm', ''), &
      verb_t('summary', 'psalm', ''), &
      verb_t('tolerances', 'psalm', 'TOLER'), &
      verb_t('sweep', 'psalm', 'SWEEP'), &
      verb_t('synthesis', 'psalm', 'SEARCH'), &
      verb_t('exact', 'psalm', 'EXACT'), &
      verb_t('proof', 'psalm', 'LIMITS CONSTR'), &
      verb_t('assemblies', 'psalm', 'CHAIN'), &
      verb_t('rates', 'kalm', 'RATES'), &
      verb_t('forces', 'kalm', 'MASSES LOADS SPRING FRICTN'), &
      verb_t('machine', 'kalm', 'MOTOR'), &
      verb_t('balance', 'muscle', 'BALANC'), &
      verb_t('springs', 'muscle', 'SPRNGS'), &
      verb_t('vibration', 'ssics', 'ESTIM VIBR DRIVEL HILL'), &
      verb_t('cams', 'calm', 'CAM CAM2'), &
      verb_t('clearance', 'bridge', 'CLEAR'), &
      verb_t('picture', 'balm', 'DXF'), &
      verb_t('board', 'balm', 'CHAIN')]

   !> What the programs write for a case.
   type :: report_t
      character(:), allocatable :: listing         !! as the program prints it; of `summary` its text
      type(tables_t) :: tables                     !! columns by name
      character(:), allocatable :: data_set        !! the linkages found, in the notation of the manual; empty: none
      type(case_t), allocatable :: cases(:)        !! the same as cases, the best first
      type(drawing_t), allocatable :: files(:)     !! pictures and pages: ending of their name, content
      logical :: violated = .false.                !! closure or a limit is violated, or the study stopped early
   contains
      procedure :: find => find_table
      procedure :: column
   end type report_t

   !> What is proven of a motion.
   type :: proven_t
      type(proof_study_t), allocatable :: loops    !! of dyads
      type(chain_proof_t), allocatable :: poses    !! of a sketch with larger groups
      type(chain_study_t), allocatable :: chain    !! its positions
   end type proven_t

   !> Cams: the first, and its conjugate or the outer wall of its track, or the second one.
   type :: cams_t
      type(cam_study_t), allocatable :: parts(:)
      type(cam_search_t), allocatable :: search    !! what a search for radii and pivots changed
   end type cams_t

contains

   !> Any verb by its name: its report. `brief`: analysis, rates and forces give tables alone, no listing.
   subroutine study(case, verb, report, findings, threads, stop, monitor, brief)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: verb                    !! a name of `verbs`
      type(report_t), intent(out) :: report
      type(findings_t), intent(inout) :: findings
      integer, intent(in), optional :: threads            !! that share the work; default THREADS of the case, or 1
      type(stop_t), intent(in), optional :: stop          !! by which the host can end a search, a sample, an exact synthesis
      class(observer_t), intent(inout), optional :: monitor !! told of the progress of a search
      logical, intent(in), optional :: brief
      type(analysis_t), allocatable :: analysis
      type(tolerances_t), allocatable :: tolerances
      type(family_t), allocatable :: family
      type(synthesis_t), allocatable :: synthesis
      type(exact_study_t), allocatable :: exact
      type(proven_t), allocatable :: proven
      type(assembly_study_t), allocatable :: assemblies
      type(rate_study_t), allocatable :: rates
      type(force_study_t), allocatable :: forces
      type(machine_study_t), allocatable :: machine
      type(muscle_study_t), allocatable :: muscle
      type(steady_study_t), allocatable :: steady
      type(cams_t), allocatable :: cams
      type(clearance_study_t), allocatable :: clearance
      type(summary_t), allocatable :: summary
      type(drawing_t), allocatable :: files(:)
      character(:), allocatable :: near

      select case (verb)
      case ('analysis')
         allocate (analysis)
         call analyse(case, analysis, findings, report=report, brief=brief)
      case ('summary')
         allocate (summary)
         call summarise(case, summary, findings, report)
      case ('tolerances')
         allocate (tolerances)
         call find_tolerances(case, tolerances, findings, threads, stop, report)
      case ('sweep')
         allocate (family)
         call find_family(case, family, findings, report)
      case ('synthesis')
         allocate (synthesis)
         call synthesise(case, synthesis, findings, threads, stop, monitor, report)
      case ('exact')
         allocate (exact)
         call find_exact(case, exact, findings, stop, report)
      case ('proof')
         allocate (proven)
         call prove(case, proven, findings, report)
      case ('assemblies')
         allocate (assemblies)
         call find_assemblies(case, assemblies, findings, report)
      case ('rates')
         allocate (rates)
         call find_rates(case, rates, findings, report, brief)
      case ('forces')
         allocate (forces)
         call find_forces(case, forces, findings, report, brief=brief)
      case ('machine')
         allocate (machine)
         call find_machine(case, machine, findings, report)
      case ('balance')
         allocate (muscle)
         call find_balance(case, muscle, findings, report)
      case ('springs')
         allocate (muscle)
         call find_springs(case, muscle, findings, report)
      case ('vibration')
         allocate (steady)
         call find_vibration(case, steady, findings, report)
      case ('cams')
         allocate (cams)
         call find_cams(case, cams, findings, report)
      case ('clearance')
         allocate (clearance)
         call find_clearance(case, clearance, findings, report)
      case ('picture')
         call draw(case, files, findings, report)
      case ('board')
         call make_board(case, files, findings, report)
      case default
         near = nearest_name(lower_case(verb), verbs%name)
         if (len(near) > 0) near = "; did you mean '"//near//"'?"
         call findings%error("no study is called '"//verb//"'"//near)
         call no_report(report)
      end select
   end subroutine study

   ! ---- psalm -------------------------------------------------------------------------------------------------------

   !> Analyse a case as given: what it does at its input positions.
   !>
   !> Findings: errors of the case, and a warning for every violation of closure or a limit.
   subroutine analyse(case, analysis, findings, wanted, report, brief)
      type(case_t), intent(in) :: case
      type(analysis_t), intent(out) :: analysis           !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(wanted_t), intent(in), optional :: wanted      !! what is wanted besides the motion; of a report as the case says
      type(report_t), intent(out), optional :: report     !! tables: inputs, outputs, of a sketch all joints
      logical, intent(in), optional :: brief              !! no listing
      type(wanted_t) :: all_wanted
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(sketch_study_t) :: sketch
      type(table_t) :: totals
      type(devices_t) :: devices
      logical :: ready, short
      integer :: i

      if (present(report)) call no_report(report)
      if (present(wanted)) all_wanted = wanted
      call make_ready(case, set, prepared, problem, ready, findings, every_loop=all_wanted%arcs, demand=demand_of_psalm)
      call empty_motion(analysis%motion)
      if (.not. ready) return
      short = .false.
      if (present(brief)) short = brief
      if (present(report) .and. .not. present(wanted) .and. .not. short) all_wanted = wanted_by(set)
      call study_analysis(set, problem, problem%given, all_wanted, analysis)
      call warn(problem, analysis%motion, findings)
      if (allocated(analysis%margins)) then
         do i = 1, size(analysis%margins)
            if (is_violated(analysis%margins(i))) call findings%warning('violated: '// &
               lower_case(describe_margin(set, problem, analysis%dimensions, analysis%margins(i))))
         end do
      end if
      if (.not. present(report)) return
      call devices%begin_case(set%title, .false.)
      if (set%sketch%given) then
         call study_sketch(set, problem, prepared%given, analysis%motion%closed, 1.0_wp, 0.0_wp, sketch)
         call put_sketch(set%sketch, sketch, 0, devices%cases(1))
      else
         call put_positions(problem, analysis%motion, devices%cases(1), analysis%condition)
      end if
      if (.not. short) then
         call report_analysis(set, problem, analysis, prepared%warnings, devices)
         if (set%sketch%given) call report_outputs(set, sketch, analysis%motion%beyond, 0, devices)
         call mark_beyond(devices%published, devices%six)
      end if
      if (analysis%is_violating()) call devices%note_violation()
      totals = table_of('totals', 'the whole motion')
      call totals%add('objective', [analysis%motion%total])
      call totals%add('positions', [size(analysis%motion%input)])
      call totals%add('closed', [count(analysis%motion%closed)])
      call devices%cases(1)%put(totals)
      call conclude(devices, report)
   end subroutine analyse

   !> What a linkage does over the whole range of its input: where it closes, dead points, stroke, time ratio, extremes.
   subroutine summarise(case, summary, findings, report)
      type(case_t), intent(in) :: case
      type(summary_t), intent(out) :: summary             !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! listing: the summary in words
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(analysis_t), allocatable :: analysis
      type(sketch_study_t) :: sketch
      type(devices_t) :: devices
      logical :: ready

      if (present(report)) call no_report(report)
      call make_ready(case, set, prepared, problem, ready, findings)
      if (.not. ready) return
      allocate (analysis)
      call study_analysis(set, problem, problem%given, wanted_t(), analysis)
      call study_summary(problem, problem%given, analysis%motion, summary)
      if (.not. present(report)) return
      if (set%sketch%given) then
         call study_sketch(set, problem, prepared%given, analysis%motion%closed, 1.0_wp, 0.0_wp, sketch)
         call report_summary(set, summary, analysis%motion, devices, sketch)
      else
         call report_summary(set, summary, analysis%motion, devices)
      end if
      call devices%six%add_text(devices%summary%content())
      call conclude(devices, report, findings)
   end subroutine summarise

   !> What the tolerances of the group TOLER do to the output of a case as given.
   subroutine find_tolerances(case, tolerances, findings, threads, stop, report)
      type(case_t), intent(in) :: case
      type(tolerances_t), intent(out) :: tolerances       !! empty if the case has errors or does not close
      type(findings_t), intent(inout) :: findings
      integer, intent(in), optional :: threads            !! that share the work; default THREADS of the case, or 1
      type(stop_t), intent(in), optional :: stop          !! by which the host can end the sample
      type(report_t), intent(out), optional :: report     !! tables: bands of the output
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(devices_t) :: devices
      type(stop_t) :: ending
      logical :: ready

      if (present(report)) call no_report(report)
      if (.not. may_share(threads, findings)) return
      call make_ready(case, set, prepared, problem, ready, findings)
      if (.not. ready) return
      if (present(stop)) ending = stop
      call study_tolerances(set, problem%mechanism, problem%given, threads_for(set, threads_of(threads)), ending, tolerances)
      if (.not. tolerances%closes) call findings%warning('no tolerances, because the linkage does not close everywhere')
      if (.not. present(report)) return
      call devices%begin_case(set%title, .false.)
      if (tolerances%closes) call report_tolerances(set, problem%mechanism%sliding_input, tolerances, devices)
      if (.not. tolerances%closes) call devices%note_violation()
      call conclude(devices, report, findings)
   end subroutine find_tolerances

   !> The output for the settings of an adjustable dimension, the group SWEEP.
   subroutine find_family(case, family, findings, report)
      type(case_t), intent(in) :: case
      type(family_t), intent(out) :: family               !! empty if the case has errors, or the dimension cannot be set
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: the output for every setting
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(devices_t) :: devices
      logical :: ready, found

      if (present(report)) call no_report(report)
      call make_ready(case, set, prepared, problem, ready, findings)
      if (ready) ready = is_given(set, 'SWEEP', findings)
      if (.not. ready) return
      call study_family(set, problem%mechanism, problem%given, inputs_of(set), family, found)
      call devices%begin_case(set%title, .false.)
      call report_family(set, family, found, devices)
      call conclude(devices, report, findings)
   end subroutine find_family

   !> Search for better dimensions. `found_case`, or the report, makes cases of what was found.
   !>
   !> A search for dimensions that loops have not is made in the poses of the links: of such a one `synthesis%found%best` has values
   !> and objectives, and the report its best linkage.
   subroutine synthesise(case, synthesis, findings, threads, stop, monitor, report)
      type(case_t), intent(in) :: case
      type(synthesis_t), intent(out) :: synthesis
      type(findings_t), intent(inout) :: findings
      integer, intent(in), optional :: threads            !! that share the work; default THREADS of the case, or 1
      type(stop_t), intent(in), optional :: stop          !! by which the host can end the search
      class(observer_t), intent(inout), optional :: monitor !! told of progress
      type(report_t), intent(out), optional :: report     !! listing: the ranking; the linkages found
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(dimensions_t) :: dimensions
      type(devices_t) :: devices
      type(search_log_t) :: log
      type(stop_t) :: ending
      real(wp), allocatable :: none(:, :)
      logical :: ready
      integer :: team

      if (present(report)) call no_report(report)
      allocate (synthesis%found%best(0), synthesis%ranked(0))
      if (.not. may_share(threads, findings)) return
      call make_ready(case, set, prepared, problem, ready, findings)
      if (.not. ready) return
      if (present(stop)) ending = stop
      team = threads_for(set, threads_of(threads))
      if (allocated(set%search_in_poses) .and. set%wants_search()) then
         call search_poses(set, team, ending, synthesis, findings, monitor, devices)
         call conclude(devices, report, findings)
         return
      end if
      call problem%set_threads(team)
      dimensions = problem%given
      allocate (none(size(problem%parameters%variables), 0))
      call study_synthesis(set, none, problem, team, ending, dimensions, synthesis, monitor)
      if (.not. present(report)) return
      call devices%begin_case(set%title, .false.)
      call begin_search_report(set, devices)
      if (problem%parameters%has_search()) call report_search(set, synthesis, log, devices)
      call report_found(set, problem, dimensions, synthesis, devices)
      call put_found(synthesis, devices%cases(1))
      call conclude(devices, report, findings)
   end subroutine synthesise

   !> The linkages found, best first.
   subroutine put_found(synthesis, tables)
      type(synthesis_t), intent(in) :: synthesis
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: i

      table = table_of('found', 'a row for each linkage found, the best first')
      if (synthesis%many) then
         associate (best => synthesis%found%best)
            call table%add('rank', [(i, i=1, size(best))])
            call table%add('objective', best%objective)
            call table%add('start', best%start)
            call table%add('distance', best%distance)
         end associate
      else if (allocated(synthesis%last%f)) then
         call table%add('rank', [1])
         call table%add('objective', [synthesis%last%f(synthesis%last%best)])
      else
         call table%add('rank', [integer ::])
         call table%add('objective', [real(wp) ::])
      end if
      call tables%put(table)
   end subroutine put_found

   !> A search in the poses of the links.
   subroutine search_poses(set, threads, stop, synthesis, findings, monitor, devices)
      class(data_set_t), intent(in) :: set
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      type(synthesis_t), intent(inout) :: synthesis
      type(findings_t), intent(inout) :: findings
      class(observer_t), intent(inout), optional :: monitor
      type(devices_t), intent(inout) :: devices
      type(chain_synthesis_t), allocatable :: search
      type(data_set_t), allocatable :: found
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(line_t) :: none(0)
      integer :: i

      allocate (search)
      call synthesise_chain(set, threads, stop, search, findings, monitor)
      if (findings%failed()) return
      synthesis%many = .true.
      synthesis%found%starts = search%starts
      synthesis%found%feasible = search%feasible
      synthesis%found%evaluations = search%evaluations
      synthesis%found%refused = search%refused
      synthesis%found%interrupted = search%stopped
      deallocate (synthesis%found%best)
      allocate (synthesis%found%best(size(search%best)))
      do i = 1, size(search%best)
         synthesis%found%best(i)%values = search%best(i)%x
         synthesis%found%best(i)%objective = search%best(i)%objective
         synthesis%found%best(i)%start = search%best(i)%start
      end do
      call devices%begin_case(set%title, .false.)
      call report_chain_search(set, search, devices)
      call put_found(synthesis, devices%cases(1))
      if (size(search%best) == 0) return
      allocate (found, prepared, problem)
      call resolve_drawn(search%drawn, found, findings)
      if (findings%failed()) return
      call prepare(found, none, prepared, findings)
      if (.not. prepared%ready) return
      call make_problem(found, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call write_data_set(found, problem, prepared%given, devices%seven)
   end subroutine search_poses

   !> The linkage of a rank as a case without variables; the user's own if the search found none of that rank.
   function found_case(case, synthesis, rank) result(found)
      type(case_t), intent(in) :: case                    !! the one that was searched
      type(synthesis_t), intent(in) :: synthesis
      integer, intent(in), optional :: rank               !! 1, the best, if absent
      type(case_t) :: found
      type(case_t), allocatable :: cases(:)
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(findings_t) :: findings
      type(dimensions_t) :: dimensions
      type(variant_t) :: variant
      type(text_t) :: text
      integer :: which
      logical :: ready

      found = case
      which = 1
      if (present(rank)) which = rank
      call make_ready(case, set, prepared, problem, ready, findings)
      if (.not. ready) return
      dimensions = problem%given
      variant = variant_of(set)
      if (synthesis%many) then
         if (which >= 1 .and. which <= size(synthesis%found%best)) then
            if (size(synthesis%found%best(which)%values) /= size(problem%parameters%variables)) return
            call problem%parameters%apply(synthesis%found%best(which)%values, dimensions)
            variant%delt = synthesis%found%best(which)%delt
         end if
      else if (allocated(synthesis%last%v) .and. which == 1) then
         call problem%parameters%apply(synthesis%last%v(:, synthesis%last%best), dimensions)
      end if
      call write_data_set(set, problem, dimensions, text, variant)
      call of_text(text%content(), cases)
      if (size(cases) == 1) found = cases(1)
   end function found_case

   !> All linkages that the group EXACT asks for.
   subroutine find_exact(case, exact, findings, stop, report)
      type(case_t), intent(in) :: case
      type(exact_study_t), intent(out) :: exact           !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; what was found so far is there
      type(report_t), intent(out), optional :: report     !! listing, tables, the linkages
      class(data_set_t), allocatable :: set
      type(findings_t) :: own
      type(devices_t) :: devices
      type(stop_t) :: ending

      if (present(report)) call no_report(report)
      call set_of(case, set, own)
      if (.not. own%failed()) then
         if (is_given(set, 'EXACT', own)) call check_exact(set, own)
      end if
      call tell(own, findings)
      if (own%failed()) return
      if (present(stop)) ending = stop
      call study_all_exact(set, ending, exact)
      if (.not. present(report)) return
      call devices%begin_case(set%title, .false.)
      call report_exact(set, exact, devices)
      call conclude(devices, report, findings)
   end subroutine find_exact

   !> What can be proven of the motion over the range that IPROOF names, or between the inputs of the case.
   subroutine prove(case, proven, findings, report)
      type(case_t), intent(in) :: case
      type(proven_t), intent(out) :: proven               !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: pieces of the range, extremes
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(devices_t) :: devices
      logical :: ready, sound
      integer :: range

      if (present(report)) call no_report(report)
      call make_ready(case, set, prepared, problem, ready, findings)
      if (.not. ready) return
      call devices%begin_case(set%title, .false.)
      range = proof_wanted(set, .false.)
      if (range == no_proof) range = proof_of_inputs
      if (set%is_beyond_arrays()) then
         allocate (proven%chain, proven%poses)
         call prove_loops(set, range, proven%chain, proven%poses, sound)
         if (sound) call report_chain_proof(set, proven%chain, proven%poses, devices)
      else
         allocate (proven%loops)
         call study_proof(set, problem, problem%given, range, proven%loops)
         call report_proof(set, proven%loops, devices)
      end if
      call conclude(devices, report, findings)
   end subroutine prove

   !> Every way in which the links of a sketch can be put together.
   subroutine find_assemblies(case, assemblies, findings, report)
      type(case_t), intent(in) :: case
      type(assembly_study_t), intent(out) :: assemblies   !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: joints of every assembly
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(devices_t) :: devices
      logical :: ready

      if (present(report)) call no_report(report)
      call make_ready(case, set, prepared, problem, ready, findings)
      if (ready .and. .not. set%sketch%given) then
         call findings%error('assemblies are those of a sketch (&CHAIN); this linkage is given by its loops')
         ready = .false.
      end if
      if (.not. ready) return
      call study_assemblies(set, assemblies)
      if (.not. present(report)) return
      call devices%begin_case(set%title, .false.)
      if (assemblies%sound) call report_assemblies(set, assemblies, devices)
      call conclude(devices, report, findings)
   end subroutine find_assemblies

   ! ---- kalm --------------------------------------------------------------------------------------------------------

   !> Velocities, accelerations and jerks of a case as given.
   subroutine find_rates(case, rates, findings, report, brief)
      type(case_t), intent(in) :: case
      type(rate_study_t), intent(out) :: rates            !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: inputs, outputs and joints with their rates
      logical, intent(in), optional :: brief              !! no listing
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      logical :: ready

      if (present(report)) call no_report(report)
      call empty_motion(rates%motion)
      allocate (rates%by_input(0, 0, 0), rates%by_time(0, 0, 0), rates%dead(0))
      call make_ready(case, set, prepared, problem, ready, findings, demand=demand_of_rates, reader='kalm')
      if (.not. ready) return
      call study_rates(set, problem, problem%given, rates)
      call warn(problem, rates%motion, findings)
      if (present(report)) call report_dynamics(set, problem, rates, report, findings, brief)
   end subroutine find_rates

   !> Forces of a case with masses, loads or springs: drive, frame, every joint, at the positions of the case.
   !>
   !> With `by_unit_mass` also the inertia forces of unit masses, in which every force is linear: shape (positions, columns, 4,
   !> bodies), see `loads_of_unit_masses`. Columns:
   !> drive, force x and y and moment on the frame, two for each joint, then further drives.
   subroutine find_forces(case, forces, findings, report, by_unit_mass, brief)
      type(case_t), intent(in) :: case
      type(force_study_t), intent(out) :: forces          !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: those of `find_rates` with the forces
      real(wp), allocatable, intent(out), optional :: by_unit_mass(:, :, :, :)
      logical, intent(in), optional :: brief              !! no listing
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(rate_study_t), allocatable :: rates
      logical :: ready

      if (present(report)) call no_report(report)
      allocate (forces%input(0), forces%table%value(0, 0))
      if (present(by_unit_mass)) allocate (by_unit_mass(0, 0, 0, 0))
      call make_ready(case, set, prepared, problem, ready, findings, demand=demand_of_rates, reader='kalm')
      if (.not. ready) return
      call study_forces(set, problem, problem%given, forces, by_unit_mass)
      if (.not. forces%all_known()) call findings%warning('forces are not known at every position: the linkage does not '// &
                                                          'close, is at a dead point, or friction locks it')
      if (.not. present(report)) return
      allocate (rates)
      call study_rates(set, problem, problem%given, rates)
      call report_dynamics(set, problem, rates, report, findings, brief, forces)
   end subroutine find_forces

   !> Motion from torque, the group MOTOR: steady cycle, run-up, flywheel.
   subroutine find_machine(case, machine, findings, report)
      type(case_t), intent(in) :: case
      type(machine_study_t), intent(out) :: machine       !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: forces, and the cycle
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(rate_study_t), allocatable :: rates
      type(force_study_t), allocatable :: forces
      logical :: ready

      if (present(report)) call no_report(report)
      call make_ready(case, set, prepared, problem, ready, findings, demand=demand_of_rates, reader='kalm')
      if (ready) ready = is_given(set, 'MOTOR', findings)
      if (.not. ready) return
      allocate (forces)
      call study_forces(set, problem, problem%given, forces)
      call study_machine(set, problem, forces%model, machine)
      if (.not. present(report)) return
      allocate (rates)
      call study_rates(set, problem, problem%given, rates)
      call report_dynamics(set, problem, rates, report, findings, .false., forces, machine)
   end subroutine find_machine

   !> What kalm writes.
   subroutine report_dynamics(set, problem, rates, report, findings, brief, forces, machine)
      class(data_set_t), intent(in) :: set
      class(problem_t), intent(in) :: problem
      type(rate_study_t), intent(in) :: rates
      type(report_t), intent(inout) :: report
      type(findings_t), intent(inout) :: findings
      logical, intent(in), optional :: brief
      type(force_study_t), intent(in), optional :: forces
      type(machine_study_t), intent(in), optional :: machine
      type(devices_t) :: devices
      type(sketch_study_t) :: sketch
      logical :: short

      short = .false.
      if (present(brief)) short = brief
      call devices%begin_case(set%title, .false.)
      if (set%sketch%given) then
         call study_sketch(set, problem, problem%given, rates%motion%closed, set%pace(), set%change_of_pace(), sketch)
         call put_sketch(set%sketch, sketch, accelerations, devices%cases(1), forces)
         call report_still_drives(set, devices)
      end if
      if (short) then
         if (.not. set%sketch%given) call put_rates(set%title, set%rates%speed, set%rates%accel, problem, rates, .true., &
                                                    devices%cases(1), forces)
      else
         call report_rates(set, problem, rates, devices, forces, machine)
         if (set%sketch%given) call report_outputs(set, sketch, rates%motion%beyond, accelerations, devices)
      end if
      if (rates%is_violating()) call devices%note_violation()
      if (present(forces)) then
         if (.not. forces%all_known()) call devices%note_violation()
      end if
      if (present(machine)) then
         call conclude(devices, report, findings)
      else
         call conclude(devices, report)
      end if
   end subroutine report_dynamics

   ! ---- muscle, ssics, calm, bridge ---------------------------------------------------------------------------------

   !> Counterweights, the group BALANC; springs too, if the case has SPRNGS.
   subroutine find_balance(case, muscle, findings, report)
      type(case_t), intent(in) :: case
      type(muscle_study_t), intent(out) :: muscle         !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables; the linkage with its weights

      call find_what_balances(case, 'BALANC', muscle, findings, report)
   end subroutine find_balance

   !> Springs, the group SPRNGS; counterweights too, if the case has BALANC.
   subroutine find_springs(case, muscle, findings, report)
      type(case_t), intent(in) :: case
      type(muscle_study_t), intent(out) :: muscle         !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables; the linkage with its springs

      call find_what_balances(case, 'SPRNGS', muscle, findings, report)
   end subroutine find_springs

   subroutine find_what_balances(case, group, muscle, findings, report)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: group
      type(muscle_study_t), intent(inout) :: muscle
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(devices_t) :: devices
      type(findings_t) :: own
      logical :: ready

      if (present(report)) call no_report(report)
      call make_ready(case, set, prepared, problem, ready, findings, demand=demand_of_muscle, reader='muscle')
      if (ready) ready = is_given(set, group, findings)
      if (.not. ready) return
      own%file = set%file
      call check_muscle(set, prepared, own)
      call tell(own, findings)
      if (own%failed()) return
      call study_muscle(set, problem, prepared, muscle)
      if (.not. present(report)) return
      call devices%begin_case(set%title, .false.)
      call report_muscle(set, problem, prepared, muscle, devices)
      call conclude(devices, report, findings)
   end subroutine find_what_balances

   !> Vibration and stability: the groups ESTIM, VIBR, DRIVEL and HILL; what a case asks for is allocated.
   subroutine find_vibration(case, steady, findings, report)
      type(case_t), intent(in) :: case
      type(steady_study_t), intent(out) :: steady         !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: responses, boundaries of stability
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(devices_t) :: devices
      type(findings_t) :: own
      logical :: ready

      if (present(report)) call no_report(report)
      call set_of(case, set, own, 'ssics')
      if (own%failed()) then
         call tell(own, findings)
         return
      end if
      if (set%loops() == 0 .and. set%gives('HILL')) then
         ! Hill's equation alone
         allocate (prepared, problem)
      else
         call make_ready(case, set, prepared, problem, ready, findings, demand=demand_of_rates, reader='ssics', &
                         does='ssics studies', turning=.true.)
         if (.not. ready) return
         own = findings_t()
         own%file = set%file
         call check_steady(set, prepared, own)
         call tell(own, findings)
         if (own%failed()) return
      end if
      call study_steady(set, problem, prepared, steady)
      if (.not. present(report)) return
      call devices%begin_case(set%title, .false.)
      call report_steady(set, steady, devices)
      call conclude(devices, report, findings)
   end subroutine find_vibration

   !> The cam that makes the output follow a law, the group CAM.
   subroutine find_cams(case, cams, findings, report)
      type(case_t), intent(in) :: case
      type(cams_t), intent(out) :: cams                   !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: profiles; files: .dxf, .svg, .html, with KGCODE .nc
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(cam_group_t), allocatable :: groups(:)
      type(cam_role_t), allocatable :: roles(:)
      type(cam_scene_t), allocatable :: scene
      type(text_t) :: drawing, picture, page, code
      type(devices_t) :: devices
      type(findings_t) :: own
      logical :: ready
      integer :: k

      if (present(report)) call no_report(report)
      allocate (cams%parts(0))
      call make_ready(case, set, prepared, problem, ready, findings, demand=demand_of_rates, reader='calm')
      if (.not. ready) return
      groups = cams_of(set)
      own%file = set%file
      call check_cam(set, groups, prepared, own)
      call tell(own, findings)
      if (own%failed()) return
      call devices%begin_case(set%title, .false.)
      roles = parts_of(groups)
      if (size(groups(1)%variations) > 0) then
         allocate (cams%search)
         call search_cam(set, groups, prepared, cams%search)
         call report_cam_search(set, groups(1), cams%search, devices)
      end if
      deallocate (cams%parts)
      allocate (cams%parts(size(roles)))
      do k = 1, size(roles)
         call find_cam(set, groups, prepared, roles(k), cams%parts(k))
      end do
      if (.not. present(report)) return
      call report_cam(set, groups(1), cams%parts, devices)
      allocate (scene)
      call make_cam_scene(set, prepared, cams%parts, scene)
      call write_cam_dxf(cams%parts, scene%linkage, drawing)
      call devices%add_drawing('.dxf', drawing%content())
      call write_cam_svg(set%title, cams%parts, scene, picture)
      call devices%add_drawing('.svg', picture%content())
      call write_cam_page(set%title, cams%parts, scene, page)
      call devices%add_drawing('.html', page%content())
      if (groups(1)%code) then
         do k = 1, size(cams%parts)
            call write_cam_code(set%title, cams%parts(k), code)
         end do
         call devices%add_drawing('.nc', code%content())
      end if
      call conclude(devices, report, findings)
   end subroutine find_cams

   !> A joint with clearance, the group CLEAR: loss of contact, flight, impact.
   subroutine find_clearance(case, clearance, findings, report)
      type(case_t), intent(in) :: case
      type(clearance_study_t), intent(out) :: clearance   !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: load of the joint, flights; files: .svg
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(text_t) :: picture
      type(devices_t) :: devices
      type(findings_t) :: own
      logical :: ready

      if (present(report)) call no_report(report)
      call make_ready(case, set, prepared, problem, ready, findings, demand=demand_of_rates, reader='bridge', &
                      does='bridge studies', turning=.true.)
      if (.not. ready) return
      own%file = set%file
      call check_clearance(set, clearance_of(set), prepared, own)
      call tell(own, findings)
      if (own%failed()) return
      call study_clearance(set, clearance_of(set), problem, prepared%mechanism, prepared%given, clearance)
      if (.not. present(report)) return
      call devices%begin_case(set%title, .false.)
      call report_clearance(set, prepared%mechanism, clearance, devices)
      if (clearance%done) then
         call write_clearance_svg(set%title, clearance, picture)
         call devices%add_drawing('.svg', picture%content())
      end if
      call conclude(devices, report, findings)
   end subroutine find_clearance

   ! ---- balm --------------------------------------------------------------------------------------------------------

   !> Pictures of a case as given: .svg, .dxf, with FLAT of the group DXF .flat.dxf, and .html, the moving page.
   subroutine draw(case, files, findings, report)
      type(case_t), intent(in) :: case
      type(drawing_t), allocatable, intent(out) :: files(:) !! ending and content; empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report
      class(data_set_t), allocatable :: set
      type(data_set_t), allocatable :: sets(:)
      type(pictured_t), allocatable :: cases(:)
      type(picture_t), allocatable :: pictures(:)
      type(devices_t) :: devices
      type(findings_t) :: own, of_picture
      integer :: k

      if (present(report)) call no_report(report)
      allocate (files(0))
      call set_of(case, set, own, 'balm')
      call tell(own, findings)
      if (own%failed()) return
      allocate (sets(1))
      select type (set)
      type is (data_set_t)
         sets(1) = set
      end select
      of_picture%file = set%file
      call make_scenes(sets, of_picture, cases)
      call tell(of_picture, findings)
      if (of_picture%failed()) return
      call devices%begin_case(set%title, .false.)
      call report_picture(sets(1), cases(1), devices)
      call draw_file(cases, .false., .true., '', pictures)
      do k = 1, size(pictures)
         call devices%add_drawing(trim(pictures(k)%ending), pictures(k)%content)
      end do
      if (allocated(devices%drawings)) files = devices%drawings
      call conclude(devices, report, findings)
   end subroutine draw

   !> The drawing board with the sketch of a case: .edit.html.
   subroutine make_board(case, files, findings, report)
      type(case_t), intent(in) :: case
      type(drawing_t), allocatable, intent(out) :: files(:) !! ending and content; empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report
      class(data_set_t), allocatable :: set
      type(line_t), allocatable :: lines(:)
      type(devices_t) :: devices
      type(findings_t) :: own
      type(text_t) :: page

      if (present(report)) call no_report(report)
      allocate (files(0))
      call set_of(case, set, own, 'balm')
      if (.not. own%failed()) then
         if (.not. set%sketch%given) call own%error('the drawing board takes sketches (&CHAIN), but this linkage is described '// &
                                                    'by its loops (&LINKS)', line=set%title_line)
      end if
      call tell(own, findings)
      if (own%failed()) return
      call split_lines(case%text(), lines)
      call write_board('Drawing board', 'sketch.nml', lines, page)
      call devices%add_drawing('.edit.html', page%content())
      files = devices%drawings
      call conclude(devices, report, findings)
   end subroutine make_board

   ! ---- problems of one's own ---------------------------------------------------------------------------------------

   !> Minimise a problem of the caller's own from x: an extension of `plain_nlp_t`, say, with `core`, `low` and `high` set.
   !>
   !> Findings: sizes that do not fit, a solver that is not there; a warning if the solver cannot work on this problem, or if the
   !> search ended at a point that does not obey every constraint.
   subroutine minimise(problem, solver, x, ending, findings, stop, observer)
      class(nlp_t), intent(inout) :: problem
      character(*), intent(in) :: solver                  !! its name, as SOLVER of the manual
      real(wp), intent(inout) :: x(:)                     !! shape (unknowns)
      type(ending_t), intent(out) :: ending
      type(findings_t), intent(inout) :: findings
      type(stop_t), intent(in), optional :: stop          !! by which the host can end the search
      class(observer_t), intent(inout), optional :: observer !! told of progress
      class(solver_t), allocatable :: by
      type(solver_kind_t) :: kind
      type(stop_t) :: limited
      character(:), allocatable :: near
      logical :: fits

      fits = allocated(problem%low) .and. allocated(problem%high) .and. problem%unknowns() > 0 .and. size(x) == problem%unknowns()
      if (fits) fits = size(problem%low) == problem%core .and. size(problem%high) == problem%core
      if (.not. fits) call findings%error('minimise: x needs a value for each of '//to_text(problem%unknowns())// &
                                          ' unknowns, and low and high a bound for each core unknown')
      kind = find_solver(solver)
      if (kind%family == family_unknown) then
         near = nearest_name(upper_case(solver), solver_names())
         if (len(near) > 0) near = "; did you mean '"//near//"'?"
         call findings%error("minimise: no solver is called '"//solver//"'"//near)
         fits = .false.
      end if
      if (.not. fits) return
      if (present(stop)) limited = stop
      call new_solver(kind, by)
      call by%minimise(problem, x, limited, ending, observer)
      if (ending%reason == stop_refused) then
         call findings%warning('minimise: '//trim(kind%name)//' cannot work on this problem')
      else if (.not. ending%feasible) then
         call findings%warning('minimise: the search ended at a point that violates a constraint')
      end if
   end subroutine minimise

   ! ---- reports -----------------------------------------------------------------------------------------------------

   !> Number of the table of that name, of those for other programs; 0: there is none.
   pure integer function find_table(self, name) result(place)
      class(report_t), intent(in) :: self
      character(*), intent(in) :: name

      do place = self%tables%count, 1, -1
         if (self%tables%tables(place)%audience /= for_plots .and. self%tables%tables(place)%block == name) return
      end do
   end function find_table

   !> The numbers of a column, shape (rows): `report%column('positions', 'P.x')`; NaN for what is not known, nothing if there is no
   !> such column.
   pure function column(self, table, name) result(values)
      class(report_t), intent(in) :: self
      character(*), intent(in) :: table, name
      real(wp), allocatable :: values(:)
      integer :: t, c

      allocate (values(0))
      t = self%find(table)
      if (t == 0) return
      c = column_named(self%tables%tables(t), name)
      if (c == 0) return
      associate (one => self%tables%tables(t)%columns(c))
         if (allocated(one%values)) values = merge(one%values, ieee_value(1.0_wp, ieee_quiet_nan), one%known)
      end associate
   end function column

   !> Number of the column of that name; 0: there is none.
   pure integer function column_named(table, name) result(place)
      type(table_t), intent(in) :: table
      character(*), intent(in) :: name

      do place = table%count, 1, -1
         if (table%columns(place)%name == name) return
      end do
   end function column_named

   ! ---- what the verbs share ----------------------------------------------------------------------------------------

   !> A report with nothing in it.
   subroutine no_report(report)
      type(report_t), intent(inout) :: report

      report%listing = ''
      report%data_set = ''
      report%tables = tables_of('')
      if (.not. allocated(report%cases)) allocate (report%cases(0))
      if (.not. allocated(report%files)) allocate (report%files(0))
   end subroutine no_report

   !> The report is what the devices have received; remarks go to the findings, if these are given.
   subroutine conclude(devices, report, findings)
      type(devices_t), intent(inout) :: devices
      type(report_t), intent(inout), optional :: report
      type(findings_t), intent(inout), optional :: findings

      if (present(findings)) call findings%append(devices%remarks)
      if (.not. present(report)) return
      report%listing = devices%six%content()
      report%data_set = devices%seven%content()
      if (allocated(devices%cases)) report%tables = devices%cases(1)
      if (allocated(devices%drawings)) call move_alloc(devices%drawings, report%files)
      if (len(report%data_set) > 0) call of_text(report%data_set, report%cases)
      report%violated = devices%code == exit_violation
   end subroutine conclude

   !> True if a group of a study was given; else that is an error.
   logical function is_given(set, group, findings)
      class(data_set_t), intent(in) :: set
      character(*), intent(in) :: group
      type(findings_t), intent(inout) :: findings

      is_given = set%gives(group)
      if (.not. is_given) call findings%error('the group is missing: it says what is wanted', line=set%title_line, group=group)
   end function is_given

   !> A warning for every violation.
   subroutine warn(problem, motion, findings)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(findings_t), intent(inout) :: findings
      integer :: i

      do i = 1, size(motion%violations)
         call findings%warning(lower_case(describe_violation(problem, motion, motion%violations(i))))
      end do
      if (.not. allocated(motion%beyond)) return
      if (any(motion%beyond)) call findings%warning(unreached_words(motion%beyond))
   end subroutine warn

   pure integer function threads_of(threads)
      integer, intent(in), optional :: threads

      threads_of = 0
      if (present(threads)) threads_of = max(0, threads)
   end function threads_of

   !> False, with an error, if more threads are asked for than THREADS may be.
   logical function may_share(threads, findings)
      integer, intent(in), optional :: threads
      type(findings_t), intent(inout) :: findings

      may_share = .true.
      if (present(threads)) may_share = threads <= most_search_threads
      if (.not. may_share) call findings%error(to_text(threads)//' threads are too many; give at most '// &
                                               to_text(most_search_threads))
   end function may_share

   pure subroutine empty_motion(motion)
      type(motion_t), intent(out) :: motion

      allocate (motion%closed(0), motion%input(0), motion%actual(0, 0), motion%error(0, 0))
      allocate (motion%violations(0), motion%crossings(0))
   end subroutine empty_motion
end module psalm_verbs
