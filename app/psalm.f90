!> psalm: displacement analysis and dimensional synthesis of planar linkages from a namelist file.
program psalm
   use psalm_assembly_list, only: report_assemblies
   use psalm_assembly_study, only: assembly_study_t, study_assemblies
   use psalm_batch, only: csv_of_sketches, outputs_t, common_options, json_option, parts_options, run_file
   use psalm_console, only: arguments_t, path_progress_t, progress_t, begin, device4_of, show_findings
   use psalm_analysis, only: analysis_t, wanted_t, analyse, wanted_by
   use psalm_cases, only: resolve_drawn
   use psalm_chain_proof_study, only: chain_proof_t, prove_loops
   use psalm_chain_report, only: report_chain_proof, report_outputs, report_swept_outputs, several_outputs
   use psalm_chain_search_list, only: report_chain_search
   use psalm_chain_synthesis, only: chain_synthesis_t, synthesise_chain
   use psalm_chain_study, only: chain_study_t
   use psalm_check_list, only: list_input
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, header_of
   use psalm_error, only: problem_t, inputs_of, make_problem
   use psalm_exact_run, only: run_exact
   use psalm_exact_study, only: check_exact
   use psalm_family_list, only: report_family
   use psalm_family_study, only: family_t, find_family
   use psalm_finale, only: mark_beyond
   use psalm_kinds, only: wp
   use psalm_kind_choice, only: choice_t, look_at_choice
   use psalm_kind_search, only: kind_study_t, search_kinds, kinds_wanted, check_kinds
   use psalm_kinds_report, only: report_kinds, report_choice
   use psalm_linkage_kinds, only: linkage_kind_t
   use psalm_kept_groups, only: groups_for_loops
   use psalm_mark, only: mark_t
   use psalm_limits_group, only: proof_by_default
   use psalm_mechanism, only: mechanism_t
   use psalm_next_step, only: step_after_analysis, step_after_search
   use psalm_position_table, only: put_positions, put_sketch
   use psalm_preparation, only: prepared_t, prepare, threads_for, threads_wanted
   use psalm_proof_study, only: proof_study_t, study_proof, proof_wanted, no_proof
   use psalm_report, only: most_summarised, begin_search_report, report_search, report_analysis, report_found, &
                           report_tolerances, report_allocation, report_violations, report_summary, report_proof
   use psalm_search_log, only: search_log_t, begin_log
   use psalm_signals, only: signals_t, shield_threads
   use psalm_sketch_study, only: sketch_study_t, study_conditions, study_sketch, study_sweep
   use psalm_sketch_text, only: variant_t, variant_of
   use psalm_exact_group, only: exact_group_t, exact_of
   use psalm_source, only: line_t, read_lines
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_synthesis, only: synthesis_t, synthesise
   use psalm_system, only: write_standard_error
   use psalm_team, only: team_t
   use psalm_text, only: to_text
   use psalm_allocation, only: allocation_t, study_allocation
   use psalm_allocation_group, only: allocation_group_t, allocation_of
   use psalm_tolerance, only: tolerances_t, study_tolerances
   use psalm_type_search, only: share_starts, shares_starts
   use psalm_dimensions, only: dimensions_t
   implicit none (type, external)

   character(*), parameter :: nl = new_line('a')
   ! saved: procedures that are handed on then need no code on the stack
   type(outputs_t), save :: outputs
   type(arguments_t), save :: arguments
   type(signals_t), save, target :: signals
   type(team_t), save, target :: team
   type(stop_t), save :: stop
   logical, save :: finished
   integer, save :: code, i

   call team%start(signals)
   outputs = outputs_t(suffix='', endings=['.dev7', '.dev8', '.dev9'], of_search=['.dev1', '.dev2'], csv=csv_of_sketches)
   call begin('psalm', &
      'usage: psalm [options] [CASE.nml ...]'//nl// &
      nl//'Analyses the linkage of each case, or searches for better dimensions where the case has variables.'//nl// &
      'Without a file, or with -, the case is read from standard input.'//nl// &
      nl//'The listing goes to standard output; CASE.dev1, .dev2, .dev7, .dev8 and .dev9 in the folder of the case.'//nl// &
      nl//json_option// &
      '  --assemblies      list every way in which the links of a sketch can be put together'//nl// &
      '  --kinds           list the kinds of linkages that &KINDS asks for, without a search'//nl// &
      '  --links           device 7 has the equivalent &LINKS of a sketch, where they exist'//nl// &
      '  --device4 FILE    read supplied vertices (NGUESS) from FILE; default CASE.dev4'//nl// &
      '  --threads N       threads that share the work; default THREADS of the case, or 1'//nl// &
      parts_options// &
      common_options// &
      nl//'Exit status: 0 done; 1 done, but limits are violated or the search stopped before converging;'//nl// &
      '2 the input is wrong; 3 a file could not be read or written.'//nl, &
      [outputs%endings, outputs%of_search], arguments, finished)
   code = arguments%code
   if (finished) call team%leave(code)
   call stop%listen_to(signals)
   team%shares = team%shares .or. arguments%parts > 0 .or. arguments%merge .or. arguments%so_far .or. arguments%every > 0
   if (team%shares) call stop%share_with(team)
   do i = 1, size(arguments%files)
      call run_file(arguments, trim(arguments%files(i)), outputs, prepare_search, run_case, code, run_shared, &
                    team, why_undivided)
      if (asked_to_end() .or. arguments%no_place) exit ! a signal came: what is left is not begun
      call signals%release()
   end do
   call team%leave(code)

contains

   !> True if a signal came; where the work is shared, to one of those who share it. A part that ends where others are to go on is
   !> not asked to end.
   logical function asked_to_end()
      asked_to_end = signals%asked()
      if (team%shares) asked_to_end = stop%waiting() .and. .not. team%incomplete
   end function asked_to_end

   !> Why the work of these cases cannot be divided into parts; empty: it can.
   function why_undivided(sets) result(reason)
      type(data_set_t), intent(in) :: sets(:)
      character(:), allocatable :: reason
      integer :: k

      reason = ''
      if (any(sets%of_kinds)) then
         reason = 'a search over kinds of linkages (&KINDS) decides by what it has found which kind is searched next'
      else if (any([(shares_starts(sets(k)), k=1, size(sets))])) then
         reason = 'cases that share their starts (RANKING=2) decide by what was found which case is searched next'
      else if (any([(wants_every_six_bar(sets(k)), k=1, size(sets))])) then
         reason = 'the paths of six-bars (&EXACT) are shared by threads and by the ranks of an MPI job, not by parts'
      else if (.not. any([(is_numbered(sets(k)), k=1, size(sets))])) then
         reason = 'there is no numbered work in it: many starts (SOLVER of &SEARCH other than the simplex), a sample '// &
                  '(NTRIAL of &TOLER, ALTRY of &ALLOC) or paths (&EXACT)'
      end if
   end function why_undivided

   !> True if a case has work that is numbered.
   pure logical function is_numbered(set)
      type(data_set_t), intent(in) :: set

      is_numbered = is_sampled(set) .or. set%gives('EXACT') .or. &
                    (set%wants_search() .and. set%search%solver%many_starts)
   end function is_numbered

   !> True if all six-bars through the points of a function are wanted.
   pure logical function wants_every_six_bar(set)
      type(data_set_t), intent(in) :: set
      type(exact_group_t) :: exact

      wants_every_six_bar = set%gives('EXACT')
      if (.not. wants_every_six_bar) return
      exact = exact_of(set)
      wants_every_six_bar = exact%wants_every_six_bar()
   end function wants_every_six_bar

   !> True if linkages within their tolerances are drawn.
   pure logical function is_sampled(set)
      type(data_set_t), intent(in) :: set
      type(allocation_group_t) :: allocation

      allocation = allocation_of(set)
      is_sampled = set%toler%ntrial > 0 .or. allocation%trials > 0
   end function is_sampled

   subroutine prepare_search(file, set, prepared, findings, mark)
      character(*), intent(in) :: file
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(inout) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(mark_t), intent(inout) :: mark
      type(line_t), allocatable :: device4(:)
      integer :: l

      if (set%gives('EXACT')) then
         if (.not. findings%failed()) call check_exact(set, findings)
         return
      end if
      if (set%of_kinds) then
         if (.not. (findings%failed() .or. arguments%kinds)) call check_kinds(set, findings)
         return
      end if
      allocate (device4(0))
      if (set%method%nguess > 0) then
         call read_lines(device4_of(arguments, file), device4, findings)
         do l = 1, size(device4)
            call mark%add(device4(l)%text)
         end do
      end if
      if (.not. findings%failed()) call prepare(set, device4, prepared, findings)
   end subroutine prepare_search

   !> Cases that ask for kinds of linkages become the cases of what was found; with --kinds nothing is searched.
   subroutine run_kinds(sets, prepared, devices)
      type(data_set_t), allocatable, intent(inout) :: sets(:)
      type(prepared_t), allocatable, intent(inout) :: prepared(:)
      type(devices_t), intent(inout) :: devices
      type(data_set_t), allocatable :: more(:)
      type(prepared_t), allocatable :: ready(:)
      class(kind_study_t), allocatable :: study
      type(linkage_kind_t), allocatable :: kinds(:)
      type(choice_t), allocatable :: choices(:)
      integer :: k, threads

      allocate (more(0), ready(0))
      do k = 1, size(sets)
         if (.not. sets(k)%of_kinds) then
            call add_cases(sets(k:k), prepared(k:k), more, ready)
         else if (arguments%kinds) then
            call kinds_wanted(sets(k), kinds)
            call report_kinds(sets(k), kinds, devices)
         else
            allocate (study)
            call take_threads(sets(k), threads, devices)
            call search_kinds(sets(k), threads, stop, study)
            call look_at_choice(study, choices)
            call report_choice(sets(k), study, choices, devices)
            call add_cases(study%sets, study%prepared, more, ready)
            deallocate (study)
         end if
      end do
      call move_alloc(more, sets)
      call move_alloc(ready, prepared)
      sets%limits%last = [(0, k=1, size(sets) - 1), (1, k=1, min(1, size(sets)))]
   end subroutine run_kinds

   !> Cases at the end of a list. The only place that copies them here, because such code is long.
   subroutine add_cases(sets, prepared, more, ready)
      type(data_set_t), intent(in) :: sets(:)
      type(prepared_t), intent(in) :: prepared(:)
      type(data_set_t), allocatable, intent(inout) :: more(:)
      type(prepared_t), allocatable, intent(inout) :: ready(:)

      more = [more, sets]
      ready = [ready, prepared]
   end subroutine add_cases

   !> The search of cases that share their starts.
   subroutine run_shared(sets, prepared, devices)
      type(data_set_t), allocatable, intent(inout) :: sets(:)
      type(prepared_t), allocatable, intent(inout) :: prepared(:)
      type(devices_t), intent(inout) :: devices
      integer :: first, threads, k

      if (any(sets%of_kinds)) call run_kinds(sets, prepared, devices)

      first = findloc([(shares_starts(sets(k)), k=1, size(sets))], .true., dim=1)
      if (first == 0) return
      call take_threads(sets(first), threads, devices)
      call share_starts(sets, prepared, threads, stop)
   end subroutine run_shared

   !> The studies of a case, and what they have to report.
   recursive subroutine run_case(number, set, prepared, devices, stopped)
      integer, intent(in) :: number
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(devices_t), intent(inout) :: devices
      logical, intent(inout) :: stopped

      if (set%gives('EXACT')) then
         call run_exact_case(set, devices, stopped)
      else if (allocated(set%search_in_poses) .and. set%wants_search()) then
         call run_pose_search(number, set, devices, stopped)
      else
         call run_linkage(set, prepared, devices, stopped)
      end if
   end subroutine run_case

   !> Linkages that meet their conditions exactly.
   subroutine run_exact_case(set, devices, stopped)
      type(data_set_t), intent(in) :: set
      type(devices_t), intent(inout) :: devices
      logical, intent(inout) :: stopped
      type(path_progress_t), target :: paths
      type(stop_t) :: stop_reported
      integer :: threads

      call take_threads(set, threads, devices)
      call signals%hold(threads)
      paths%request => signals
      stop_reported = stop
      call stop_reported%listen_to(paths)
      call run_exact(set, threads, stop_reported, devices)
      if (paths%active) call write_standard_error(nl)
      stopped = asked_to_end()
   end subroutine run_exact_case

   !> The search and the studies of a linkage of loops.
   subroutine run_linkage(set, prepared, devices, stopped)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(devices_t), intent(inout) :: devices
      logical, intent(inout) :: stopped
      type(progress_t), target :: monitor
      ! allocated: together they would fill a small stack
      class(problem_t), allocatable, target :: problem
      type(synthesis_t), allocatable :: search
      type(analysis_t), allocatable :: analysis
      type(tolerances_t), allocatable :: tolerances
      type(allocation_t), allocatable :: allocation
      type(proof_study_t), allocatable :: proof
      type(variant_t), allocatable :: by_loops
      character(:), allocatable :: left_out
      logical :: plates
      real(wp), allocatable :: delt(:)    ! of a linkage with free timing; not allocated: absent where it is an argument
      type(dimensions_t) :: dimensions
      type(wanted_t) :: wanted
      type(search_log_t) :: log
      type(sketch_study_t) :: sketch
      type(sketch_study_t), allocatable :: swept
      logical :: searched
      integer :: threads

      allocate (problem, search, analysis)
      call take_threads(set, threads, devices)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call problem%set_threads(threads)
      call list_input(header_of('PSALM', devices%mark), set, problem, devices%eight)
      dimensions = prepared%given
      if (prepared%parameters%has_search()) call begin_search_report(set, devices)
      call begin_log(set, problem, monitor, log)
      call synthesise(set, prepared%vertices, problem, threads, stop, dimensions, search, log, prepared%found)
      if (prepared%parameters%has_search()) call report_search(set, search, log, devices)
      wanted = wanted_by(set)
      wanted%summary = arguments%json .or. (.not. arguments%quiet .and. devices%summarised < most_summarised)
      call analyse(set, problem, dimensions, wanted, analysis)
      call report_analysis(set, problem, analysis, prepared%warnings, devices)
      if (set%has_names()) then
         searched = set%wants_search()
         call study_sketch(set, problem, dimensions, analysis%motion%closed, 1.0_wp, 0.0_wp, sketch, searched, places_only=.true.)
         if (set%limits%icond /= 0) call study_conditions(set, problem, dimensions, sketch, searched)
         call put_sketch(set%sketch, sketch, 0, devices%cases(devices%last_case()), problem=problem)
         call report_outputs(set, sketch, analysis%motion%beyond, 0, devices)
         if (allocated(analysis%sweep) .and. several_outputs(set)) then
            allocate (swept)
            call study_sweep(set, problem, dimensions, analysis%sweep%closed, swept, searched)
            call report_swept_outputs(set, swept, devices)
         end if
      else
         call put_positions(problem, analysis%motion, devices%cases(devices%last_case()), analysis%condition)
      end if
      if (arguments%links .and. set%is_beyond_arrays()) &
         call devices%remark(set, 'device 7 has the sketch: &LINKS has no notation for its loops')
      if (arguments%links .and. set%is_drawn() .and. .not. set%is_beyond_arrays()) then
         by_loops = variant_of(set)
         by_loops%by_loops = .true.
         call groups_for_loops(set, by_loops%others, left_out, plates)
         if (len(left_out) > 0) &
            call devices%remark(set, 'device 7 has &LINKS without the groups that call joints by their names: '//left_out)
         if (plates) call devices%remark(set, 'device 7 has &LINKS without &PLATES: links by loops have no points beside their '// &
                                         'joints, or the unit of length is in &MASSES, which is left out')
         call report_found(set, problem, dimensions, search, devices, by_loops)
      else
         call report_found(set, problem, dimensions, search, devices)
      end if
      if (set%toler%given .or. set%gives('ALLOC')) then
         if (set%method%ifree /= 0 .and. size(search%found%best) > 0) delt = search%found%best(1)%delt
      end if
      if (set%toler%given) then
         allocate (tolerances)
         call study_tolerances(set, problem%mechanism, dimensions, threads, stop, tolerances, delt, problem, analysis%motion)
         call report_tolerances(set, problem%mechanism, tolerances, devices)
      end if
      if (set%gives('ALLOC')) then
         allocate (allocation)
         call study_allocation(set, problem%mechanism, dimensions, threads, stop, allocation, delt, problem, analysis%motion)
         call report_allocation(set, problem%mechanism%sliding_input, allocation, devices)
      end if
      if (set%gives('SWEEP')) call run_family(set, problem%mechanism, dimensions, devices)
      if (proof_wanted(set, prepared%parameters%has_search()) /= no_proof) then
         if (set%is_beyond_arrays()) then
            call prove_sketch(set, prepared%parameters%has_search(), devices)
         else
            allocate (proof)
            call study_proof(set, problem, dimensions, proof_wanted(set, prepared%parameters%has_search()), proof)
            call report_proof(set, problem%mechanism, proof, devices)
         end if
      end if
      call report_violations(set, problem, analysis, devices)
      if (allocated(analysis%summary)) then
         if (allocated(sketch%names)) then
            call report_summary(set, problem%mechanism, analysis%summary, analysis%motion, devices, sketch)
         else
            call report_summary(set, problem%mechanism, analysis%summary, analysis%motion, devices)
         end if
      end if
      if (search%many) then
         call devices%suggest(step_after_search(set, problem, search%found))
      else if (allocated(analysis%summary) .and. .not. prepared%parameters%has_search()) then
         call devices%suggest(step_after_analysis(set, analysis%summary))
      end if
      if (arguments%assemblies) call run_assemblies(set, devices)
      call mark_beyond(devices%published, devices%six)
      if (monitor%active) call write_standard_error(nl)
      stopped = asked_to_end()
   end subroutine run_linkage

   !> The output for several settings of an adjustable dimension.
   subroutine run_family(set, mechanism, dimensions, devices)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions   !! of a linkage described by its loops
      type(devices_t), intent(inout) :: devices
      type(family_t), allocatable :: family
      logical :: found

      allocate (family)
      call find_family(set, mechanism, dimensions, inputs_of(set), family, found)
      call report_family(set, family, found, devices)
   end subroutine run_family

   !> A search in the poses of the links, then the studies of the linkage it found.
   recursive subroutine run_pose_search(number, set, devices, stopped)
      integer, intent(in) :: number
      type(data_set_t), intent(in) :: set
      type(devices_t), intent(inout) :: devices
      logical, intent(inout) :: stopped
      type(progress_t), target :: monitor
      type(chain_synthesis_t), allocatable :: search
      class(data_set_t), allocatable :: found
      type(prepared_t), allocatable :: prepared
      type(diagnostics_t) :: findings
      type(line_t) :: none(0)
      integer :: threads

      allocate (search, prepared)
      call take_threads(set, threads, devices)
      findings%file = set%file
      call synthesise_chain(set, threads, stop, search, findings, monitor)
      if (monitor%active) call write_standard_error(nl)
      stopped = asked_to_end()
      if (.not. findings%failed()) then
         call report_chain_search(set, search, devices)
         allocate (found)
         call resolve_drawn(search%drawn, found, findings)
         if (.not. findings%failed()) call prepare(found, none, prepared, findings)
      end if
      if (findings%count > 0) call show_findings(findings)
      devices%code = max(devices%code, findings%exit_code())
      if (prepared%ready) call run_case(number, found, prepared, devices, stopped)
   end subroutine run_pose_search

   !> Every way in which the links of a sketch can be put together.
   subroutine run_assemblies(set, devices)
      type(data_set_t), intent(in) :: set
      type(devices_t), intent(inout) :: devices
      type(assembly_study_t), allocatable :: study

      if (.not. set%is_drawn()) then
         call devices%remark(set, '--assemblies lists those of a sketch (&CHAIN); this linkage is given by its loops')
         return
      end if
      allocate (study)
      call study_assemblies(set, study)
      if (study%valid) call report_assemblies(set, study, devices)
   end subroutine run_assemblies

   !> The proof of a sketch with a larger group, which is made in the poses of its links.
   subroutine prove_sketch(set, searched, devices)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: searched                !! there was a search: the sketch is not its result
      type(devices_t), intent(inout) :: devices
      type(chain_study_t), allocatable :: study
      type(chain_proof_t), allocatable :: proof
      logical :: valid

      if (searched) then
         if (set%limits%iproof /= proof_by_default) &
            call devices%remark(set, 'the result of a search over a group of more than two links is not proven here: run psalm '// &
                                'on device 7')
         return
      end if
      allocate (study, proof)
      call prove_loops(set, proof_wanted(set, .false.), study, proof, valid)
      if (valid) call report_chain_proof(set, study, proof, devices)
   end subroutine prove_sketch

   !> Threads for a case, which take no signals. With a search or a sample there is something to lose: then signals wait until it
   !> is written.
   subroutine take_threads(set, threads, devices)
      type(data_set_t), intent(in) :: set
      integer, intent(out) :: threads
      type(devices_t), intent(inout) :: devices
      integer :: wanted

      wanted = threads_wanted(set, arguments%threads)
      threads = threads_for(set, arguments%threads)
      if (threads < wanted) call devices%remark(set, 'cannot start '//to_text(wanted)//' threads, using '//to_text(threads)// &
                                                ' (the results are the same)')
      if (threads > 1) call shield_threads(threads)
      if (set%wants_search() .or. is_sampled(set)) call signals%hold(threads)
   end subroutine take_threads
end program psalm
