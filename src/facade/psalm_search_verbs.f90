!> Verbs that look for linkages: searches for dimensions, among kinds, exact synthesis; and for problems of the caller's own.
module psalm_search_verbs
   use psalm_case, only: case_t, make_ready, of_text
   use psalm_cases, only: resolve_drawn
   use psalm_chain_search_list, only: report_chain_search
   use psalm_chain_synthesis, only: chain_synthesis_t, synthesise_chain
   use psalm_data_set, only: data_set_t
   use psalm_data_set_text, only: write_data_set
   use psalm_devices, only: devices_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_exact_report, only: report_exact
   use psalm_exact_run, only: study_all_exact
   use psalm_exact_study, only: exact_study_t, check_exact
   use psalm_kind_choice, only: choice_t, look_at_choice
   use psalm_kind_search, only: kind_study_t, search_kinds, check_kinds, kinds_request
   use psalm_kinds, only: wp
   use psalm_kinds_report, only: report_choice, put_kinds
   use psalm_nlp, only: nlp_t
   use psalm_preparation, only: prepared_t, prepare, threads_for
   use psalm_report, only: begin_search_report, report_found, report_search
   use psalm_search, only: distance_of
   use psalm_search_log, only: search_log_t
   use psalm_sketch_text, only: variant_t, variant_of, take_found
   use psalm_solver, only: observer_t, solver_t, ending_t, stop_refused
   use psalm_solver_kind, only: solver_kind_t, find_solver, solver_names, family_unknown
   use psalm_solvers, only: new_solver
   use psalm_source, only: line_t
   use psalm_status, only: findings_t => diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_study_frame, only: frame_t, report_t, threads_of, may_share
   use psalm_synthesis, only: synthesis_t, study_synthesis => synthesise
   use psalm_tables, only: table_t, tables_t, table_of
   use psalm_text, only: text_t, nearest_name, upper_case, to_text
   implicit none (type, external)
   private
   public :: synthesise, found_case, find_exact, find_kinds, minimise

contains

   !> Search for better dimensions. `found_case`, or the report, makes cases of what was found.
   !>
   !> A search for dimensions that loops have not is made in the poses of the links: of such a one `synthesis%found%best` has values
   !> and objectives, and `synthesis%drawn` the linkages as sketches.
   subroutine synthesise(case, synthesis, findings, threads, stop, monitor, report)
      type(case_t), intent(in) :: case
      type(synthesis_t), intent(out) :: synthesis
      type(findings_t), intent(inout) :: findings
      integer, intent(in), optional :: threads            !! that share the work; default THREADS of the case, or 1
      type(stop_t), intent(in), optional :: stop          !! by which the host can end the search
      class(observer_t), intent(inout), optional :: monitor !! informed of progress
      type(report_t), intent(out), optional :: report     !! listing: the ranking; the linkages found
      type(frame_t) :: frame
      type(dimensions_t) :: dimensions
      type(search_log_t) :: log
      type(stop_t) :: ending
      real(wp), allocatable :: none(:, :)
      integer :: team

      allocate (synthesis%found%best(0), synthesis%ranked(0), synthesis%simplexes(0))
      call frame%begin(case, findings, report)
      if (frame%ready) frame%ready = may_share(threads, findings)
      if (.not. frame%ready) return
      if (present(stop)) ending = stop
      team = threads_for(frame%set, threads_of(threads))
      if (allocated(frame%set%search_in_poses) .and. frame%set%wants_search()) then
         call search_poses(frame%set, team, ending, synthesis, findings, monitor, frame%devices)
         call frame%conclude(report, findings)
         return
      end if
      call frame%problem%set_threads(team)
      dimensions = frame%problem%given
      allocate (none(size(frame%problem%parameters%variables), 0))
      call study_synthesis(frame%set, none, frame%problem, team, ending, dimensions, synthesis, monitor)
      if (.not. present(report)) return
      call begin_search_report(frame%set, frame%devices)
      if (frame%problem%parameters%has_search()) call report_search(frame%set, synthesis, log, frame%devices)
      call report_found(frame%set, frame%problem, dimensions, synthesis, frame%devices)
      call put_found(synthesis, frame%devices%cases(1))
      call frame%conclude(report, findings)
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
            if (size(synthesis%simplexes) > 0) call table%add('iteration', best%iteration)
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
      logical, allocatable :: lengths(:)
      integer :: i, last

      allocate (search)
      call synthesise_chain(set, threads, stop, search, findings, monitor)
      if (findings%failed()) return
      synthesis%many = .true.
      synthesis%found%starts = search%starts
      synthesis%found%feasible = search%feasible
      synthesis%found%evaluations = search%evaluations
      synthesis%found%refused = search%refused
      synthesis%found%interrupted = search%stopped
      last = size(search%best)
      lengths = [(search%problem%is_length(i), i=1, search%problem%variables)]
      deallocate (synthesis%found%best)
      allocate (synthesis%found%best(last), synthesis%drawn(last))
      do i = 1, last
         synthesis%found%best(i)%values = search%best(i)%x(:search%problem%variables)
         synthesis%found%best(i)%delt = search%problem%increments(search%best(i)%x)
         synthesis%found%best(i)%objective = search%best(i)%objective
         synthesis%found%best(i)%start = search%best(i)%start
         synthesis%found%best(i)%distance = distance_of(synthesis%found%best(i)%values, &
                                                        search%problem%first(:search%problem%variables), lengths)
         allocate (data_set_t :: synthesis%drawn(i)%set)
         call search%draw(set, i, synthesis%drawn(i)%set)
      end do
      call put_found(synthesis, devices%cases(1))
      call report_chain_search(set, search, devices)
      do i = 1, last
         call write_drawn(synthesis%drawn(i)%set, i == last, devices%seven, findings)
      end do
      if (last == 0) call write_drawn(search%drawn, .true., devices%seven, findings)
   end subroutine search_poses

   !> Write a sketch that was drawn anew as a data set. Errors: it has no loops.
   subroutine write_drawn(drawn, last, text, findings)
      class(data_set_t), intent(in) :: drawn
      logical, intent(in) :: last                         !! of its file
      type(text_t), intent(inout) :: text
      type(findings_t), intent(inout) :: findings
      class(data_set_t), allocatable :: found
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(variant_t) :: variant
      type(line_t) :: none(0)

      allocate (found, prepared, problem)
      call resolve_drawn(drawn, found, findings)
      if (findings%failed()) return
      call prepare(found, none, prepared, findings)
      if (.not. prepared%ready) return
      call make_problem(found, prepared%mechanism, prepared%given, prepared%parameters, problem)
      variant = variant_of(found)
      variant%last = merge(1, 0, last)
      call write_data_set(found, problem, prepared%given, text, variant)
   end subroutine write_drawn

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
      if (allocated(synthesis%drawn)) then
         if (which < 1 .or. which > size(synthesis%drawn)) return
         call write_drawn(synthesis%drawn(which)%set, .true., text, findings)
         call take()
         return
      end if
      call make_ready(case, set, prepared, problem, ready, findings)
      if (.not. ready) return
      dimensions = problem%given
      variant = variant_of(set)
      if (synthesis%many) then
         if (which >= 1 .and. which <= size(synthesis%found%best)) then
            if (size(synthesis%found%best(which)%values) /= size(problem%parameters%variables)) return
            call problem%parameters%apply(synthesis%found%best(which)%values, dimensions)
            call take_found(set, synthesis%found%best(which), variant)
         end if
      else if (allocated(synthesis%last%v) .and. which == 1) then
         call problem%parameters%apply(synthesis%last%v(:, synthesis%last%best), dimensions)
      end if
      call write_data_set(set, problem, dimensions, text, variant)
      call take()

   contains

      subroutine take()

         call of_text(text%content(), cases)
         if (size(cases) == 1) found = cases(1)
      end subroutine take
   end function found_case

   !> All linkages that the group EXACT asks for.
   subroutine find_exact(case, exact, findings, stop, report, threads)
      type(case_t), intent(in) :: case
      type(exact_study_t), intent(out) :: exact           !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; what was found so far is there
      type(report_t), intent(out), optional :: report     !! listing, tables, the linkages
      integer, intent(in), optional :: threads            !! that share the paths of six-bars; default THREADS of the case, or 1
      type(frame_t) :: frame
      type(stop_t) :: ending

      call frame%read(case, findings, report, 'EXACT')
      if (frame%ready) frame%ready = may_share(threads, findings)
      if (.not. frame%ready) return
      call check_exact(frame%set, frame%noted)
      if (frame%fails(findings)) return
      if (present(stop)) ending = stop
      call study_all_exact(frame%set, threads_for(frame%set, threads_of(threads)), ending, exact)
      if (.not. present(report)) return
      call report_exact(frame%set, exact, frame%devices)
      call frame%conclude(report, findings)
   end subroutine find_exact

   !> Which kind of linkage does what is wanted, the group KINDS: all kinds share the time of one search.
   !>
   !> The report has a table of the kinds, one of the best linkages, and these as cases, the best first.
   subroutine find_kinds(case, kinds, findings, threads, stop, report)
      type(case_t), intent(in) :: case
      type(kind_study_t), intent(out) :: kinds            !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      integer, intent(in), optional :: threads            !! that share the work; default THREADS of the case, or 1
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; what was found so far is there
      type(report_t), intent(out), optional :: report     !! listing, tables, the linkages
      type(frame_t) :: frame
      class(problem_t), allocatable :: problem
      type(choice_t), allocatable :: choices(:)
      type(dimensions_t) :: dimensions
      type(variant_t) :: variant
      type(stop_t) :: ending
      integer :: k

      allocate (kinds%kinds(0), kinds%looked(0), kinds%sets(0), kinds%prepared(0))
      call frame%read(case, findings, report, 'KINDS')
      if (frame%ready) frame%ready = may_share(threads, findings)
      if (.not. frame%ready) return
      call check_kinds(frame%set, frame%noted)
      if (frame%fails(findings)) return
      if (present(stop)) ending = stop
      deallocate (kinds%kinds, kinds%looked, kinds%sets, kinds%prepared)
      call search_kinds(frame%set, threads_for(frame%set, threads_of(threads)), ending, kinds)
      if (.not. present(report)) return
      call look_at_choice(kinds, choices)
      call report_choice(frame%set, kinds, choices, frame%devices)
      call put_kinds(kinds, choices, frame%devices%cases(1))
      if (kinds%ending == kinds_request) call frame%devices%note_violation()
      do k = 1, size(kinds%sets)
         associate (set => kinds%sets(k), prepared => kinds%prepared(k))
            allocate (problem)
            call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
            dimensions = prepared%given
            call prepared%parameters%apply(prepared%found%best(1)%values, dimensions)
            variant = variant_of(set)
            variant%delt = prepared%found%best(1)%delt
            variant%last = merge(1, 0, k == size(kinds%sets))
            call write_data_set(set, problem, dimensions, frame%devices%seven, variant)
            deallocate (problem)
         end associate
      end do
      call frame%conclude(report, findings)
   end subroutine find_kinds

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
      class(observer_t), intent(inout), optional :: observer !! informed of progress
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
end module psalm_search_verbs
