!> Results of studies become texts of the devices, remarks for standard error and the exit status. Nothing is computed here.
module psalm_report
   use psalm_adjustment_list, only: list_adjustments, put_adjustments
   use psalm_allocation, only: allocation_t
   use psalm_allocation_proof, only: band_undecided, band_violated
   use psalm_allocation_list, only: list_allocation, put_allocation
   use psalm_allocation_terms, only: item_name
   use psalm_cheapest_tolerances, only: limit_least
   use psalm_analysis, only: analysis_t
   use psalm_chain_report, only: range_lines, report_unreached, several_outputs
   use psalm_check_list, only: list_arcs, list_reference_joints, list_setup
   use psalm_data_set, only: data_set_t, title_columns
   use psalm_data_set_text, only: write_vertices, write_data_set
   use psalm_devices, only: devices_t, most_reported
   use psalm_warnings, only: describe_short_links, words_at_rest
   use psalm_angles, only: degrees_of
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, motion_t, desired_of
   use psalm_finale, only: list_results, describe_violation, describe_crossing
   use psalm_force_report, only: report_forces
   use psalm_force_study, only: force_study_t
   use psalm_input_text, only: position_words, zero_words
   use psalm_constraint_group, only: range_positions
   use psalm_dyad_kind, only: assur_rrr
   use psalm_kinds, only: wp, full_turn, right_angle
   use psalm_machine_list, only: list_machine, put_machine, cycle_words
   use psalm_machine_study, only: machine_study_t
   use psalm_margin_list, only: list_margins, put_margins, describe_margin
   use psalm_margins, only: is_violated
   use psalm_group_words, only: the_group
   use psalm_mechanism, only: mechanism_t
   use psalm_method_group, only: default_niter
   use psalm_position_table, only: plot_positions, plot_desired_rates, put_rates, positions_block
   use psalm_proof_list, only: list_proof, put_proof, describe_proof
   use psalm_proof_study, only: proof_study_t
   use psalm_rate_list, only: list_rates, list_all_rates, dead_point_words
   use psalm_rate_study, only: rate_study_t
   use psalm_ranking_list, only: list_ranking, put_ranking, bounds_reached, add_to_ranking, add_share, list_common_ranking
   use psalm_search, only: found_t, result_t
   use psalm_search_group, only: ranking_none, ranking_shared
   use psalm_search_log, only: search_log_t, log_beginning, log_starts
   use psalm_similarity, only: similarity_t, fit_similarity
   use psalm_sketch_study, only: sketch_study_t
   use psalm_sketch_text, only: variant_t, variant_of, take_found
   use psalm_status, only: diagnostics_t
   use psalm_summary, only: summary_t
   use psalm_summary_table, only: put_arcs, put_arc_rates, put_dimensions, put_output_ranges, put_simplex, put_starts, &
                                  put_simplexes, put_summary, put_violations, put_desired_errors
   use psalm_summary_text, only: plain_number, write_summary, write_desired_errors
   use psalm_synthesis, only: synthesis_t, ended_infeasible, ended_small_objective, ended_iterations, ended_time, &
                              ended_on_request, ended_without_rates
   use psalm_number_format, only: number_words
   use psalm_text, only: text_t, lower_case, to_text
   use psalm_tables, only: tables_t
   use psalm_tolerance, only: tolerances_t
   use psalm_tolerance_list, only: list_tolerances, list_sample, put_tolerances, list_output_bands, put_output_bands
   use psalm_dimensions, only: dimensions_t
   use psalm_target_list, only: list_output_targets, put_output_targets
   implicit none (type, external)
   private
   public :: begin_search_report, report_search, report_analysis, report_found, report_tolerances, report_allocation, &
             report_violations, report_rates, report_summary, report_proof
   public :: most_summarised

   real(wp), parameter :: rounding = 1.0e-9_wp  !! of the sum of the steps between positions
   integer, parameter :: most_summarised = 10 !! cases of a file whose summary is written

contains

   ! ---- synthesis ---------------------------------------------------------------------------------------------------

   !> Head the log of a search.
   subroutine begin_search_report(set, devices)
      type(data_set_t), intent(in) :: set
      type(devices_t), intent(inout) :: devices

      call devices%one%add(' '//set%title)
      if (.not. set%search%solver%many_starts) call devices%two%add(' '//set%title)
   end subroutine begin_search_report

   !> How the search went: devices 1, 2 and 7, remarks.
   subroutine report_search(set, search, log, devices)
      type(data_set_t), intent(in) :: set
      type(synthesis_t), intent(in) :: search
      type(search_log_t), intent(in) :: log              !! of the simplex, which it watched
      type(devices_t), intent(inout) :: devices
      integer :: i

      if (search%is_short()) call devices%note_violation()
      if (search%many .and. size(search%simplexes) == 0) then
         call log_starts(set%has_names(), search%found%log, devices%one)
         call report_starts(set, search, devices)
         return
      end if
      do i = 1, size(search%simplexes)
         associate (one => search%simplexes(i))
            if (search%many) call devices%one%add(' START '//to_text(one%number)//'  RANDOM INTEGER '//to_text(one%integer))
            if (search%many) call devices%two%add(' START '//to_text(one%number))
            call log_beginning(one%beginning, devices%one, devices%two)
         end associate
      end do
      if (search%ending == ended_infeasible) then
         call devices%remark(set, 'the given linkage violates closure or transmission limits and cannot be repaired; no search '// &
                             'was made')
      else
         if (log%device1%length > 0) call devices%one%add_text(log%device1%content())
         if (search%many) then
            call put_simplexes(search%simplexes, devices%cases(devices%last_case()))
            call log_starts(set%has_names(), search%found%log, devices%one)
            call report_starts(set, search, devices)
            return
         end if
         associate (one => search%simplexes(1))
            call write_vertices('I', one%first%v, one%first%f, devices%seven)
            call write_vertices('F', one%last%v, one%last%f, devices%seven)
         end associate
         call report_simplex(set, search, devices)
      end if
   end subroutine report_search

   subroutine report_simplex(set, search, devices)
      type(data_set_t), intent(in) :: set
      type(synthesis_t), intent(in) :: search
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: line, reason, resume

      resume = ' (to go on, give this device 7 as device 4 with NGUESS='//to_text(size(search%simplexes(1)%last%f))//')'
      select case (search%ending)
      case (ended_iterations)
         reason = 'stopped at NITER before converging'
      case (ended_time)
         reason = 'MAXTIME passed'//resume
      case (ended_on_request)
         reason = 'interrupted'//resume
      case (ended_small_objective)
         reason = 'the objective is below FMIN'
      case (ended_without_rates)
         reason = 'no linkage has the desired derivatives: with each that was tried a position is at a limit of closure'
      case default
         reason = 'the simplex has converged'
      end select
      associate (state => search%simplexes(1)%state)
         line = to_text(state%iteration)//' iterations, '//to_text(state%evaluations)//' evaluations, '// &
                to_text(state%counts%calls)//' violations met, '//to_text(state%counts%repairs)//' repairs, '// &
                to_text(state%counts%moves)//' moves; best objective '//number_words(set%has_names(), state%best)
      end associate
      call put_simplex(search%simplexes(1)%state, reason, devices%cases(devices%last_case()))
      call devices%one%add(' '//line//'; '//reason)
      call devices%remark(set, reason//' after '//line)
      if (search%ending == ended_iterations .and. set%method%niter == default_niter) call devices%remark(set, &
         'NITER='//to_text(set%method%niter)//' is for looking at the start; set NITER in &METHOD to some thousands')
   end subroutine report_simplex

   subroutine report_starts(set, search, devices)
      type(data_set_t), intent(in) :: set
      type(synthesis_t), intent(in) :: search
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: line, resume
      real(wp), allocatable :: vertices(:, :)
      integer :: i

      associate (found => search%found)
         if (size(search%simplexes) > 0) then
            line = to_text(found%starts)//trim(merge(' simplex  ', ' simplexes', found%starts == 1))//', '// &
                   to_text(count(search%simplexes%has_settled()))//' converged, '//to_text(found%evaluations)//' evaluations'
         else
            line = to_text(found%starts)//' starts, '//to_text(found%feasible)//' led to a linkage, '// &
                   to_text(found%evaluations)//' evaluations, '//to_text(found%jacobians)//' Jacobians'
         end if
         if (size(found%best) == 0) then
            line = 'no linkage that obeys the constraints was found; what is listed is the one given: '//line
         else
            line = line//'; best objective '//number_words(set%has_names(), found%best(1)%objective)
         end if
         if (found%out_of_time) line = 'MAXTIME passed before the search was done: '//line
         if (found%refused) line = 'NLopt refuses '//trim(set%search%solver%name)//' for this problem: '//line
         if (found%interrupted) line = 'interrupted: '//line
         if (found%next > 0) then
            resume = 'FIRST='//to_text(found%next)//', NSTART='//to_text(max(1, found%left))
            if (size(search%simplexes) > 0) then
               resume = 'to go on, give '//resume
            else
               resume = 'to go on, give this device 7 as device 4 with NGUESS='//to_text(size(found%best))//', '//resume
            end if
            call devices%remark(set, resume)
            call devices%seven%add('! '//resume)
         end if
         if (size(found%best) > 0) then
            allocate (vertices(size(found%best(1)%values), size(found%best)))
            do i = 1, size(found%best)
               vertices(:, i) = found%best(i)%values
            end do
            call write_vertices('F', vertices, found%best%objective, devices%seven)
         end if
         if (size(found%best) > 0) call report_place(set, found%best(1), devices)
         call put_starts(found, devices%cases(devices%last_case()))
         call devices%one%add(' '//line)
         call devices%remark(set, line)
      end associate
   end subroutine report_starts

   !> Where desired points of any place, size and direction lie for the best linkage.
   subroutine report_place(set, best, devices)
      type(data_set_t), intent(in) :: set
      type(found_t), intent(in) :: best
      type(devices_t), intent(inout) :: devices
      type(similarity_t) :: similarity
      real(wp), allocatable :: wanted(:, :), weight(:, :)

      if (.not. allocated(best%desired)) return
      call desired_of(set, wanted, weight)
      call fit_similarity(cmplx(wanted(:, 1), wanted(:, 2), wp), cmplx(best%desired(:, 1), best%desired(:, 2), wp), &
                          weight(:, 1), similarity)
      associate (u => similarity%u, s => similarity%s, named => set%has_names())
         call devices%remark(set, 'ISIM: the desired points are '//number_words(named, hypotenuse(u%re, u%im))// &
                             ' times as large, turned by '//number_words(named, degrees_of(u%re, u%im))// &
                             ' degrees about the origin and moved by '//number_words(named, s%re)//', '//number_words(named, s%im))
      end associate
   end subroutine report_place

   !> The linkages found: their ranking in the listing, their data sets on device 7. Without a search from many starts that of
   !> the linkage.
   subroutine report_found(set, problem, dimensions, search, devices, variant)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(synthesis_t), intent(in) :: search
      type(devices_t), intent(inout) :: devices
      type(variant_t), intent(in), optional :: variant !! what is written otherwise on device 7

      if (size(search%ranked) > 0) then
         call list_ranking(set, problem, search%found, search%ranked, devices%six)
         call put_ranking(set, problem, search%found, search%ranked, devices%cases(devices%last_case()))
      end if
      if (set%search%ranking /= ranking_none) call add_to_ranking(set, search%found, search%ranked, devices%ranking)
      if (set%search%ranking == ranking_shared) call add_share(set, search%found, devices%shares)
      if (set%limits%last /= 0 .and. allocated(devices%ranking)) call list_common_ranking(devices%ranking, devices%shares, &
                                                            devices%six)
      if (search%many) call note_default_bounds(set, problem, search%found, devices)
      call write_found(set, problem, dimensions, search%found, variant, devices%seven)
   end subroutine report_found

   !> A length of the best linkage that stands at a bound which the data set did not give.
   subroutine note_default_bounds(set, problem, found, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(result_t), intent(in) :: found
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: words

      if (size(found%best) == 0) return
      words = bounds_reached(set, problem, found)
      if (len(words) > 0) call devices%remark(set, words)
   end subroutine note_default_bounds

   subroutine write_found(set, problem, dimensions, found, variant, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(result_t), intent(in) :: found
      type(variant_t), intent(in), optional :: variant
      type(text_t), intent(inout) :: text
      type(variant_t) :: one
      type(dimensions_t) :: each
      character(:), allocatable :: rank
      integer :: i

      one = variant_of(set)
      if (present(variant)) one = variant
      if (size(found%best) <= 1) then
         if (size(found%best) == 1) call take_found(set, found%best(1), one)
         call write_data_set(set, problem, dimensions, text, one)
         return
      end if
      each = dimensions
      do i = 1, size(found%best)
         call problem%parameters%apply(found%best(i)%values, each)
         call take_found(set, found%best(i), one)
         one%last = merge(set%limits%last, 0, i == size(found%best))
         rank = ', RANK '//to_text(i)
         one%title = trim(set%title(:min(len(set%title), title_columns - len(rank))))//rank
         call text%add('! rank '//to_text(i)//', objective '//number_words(found%best(i)%objective))
         call write_data_set(set, problem, each, text, one)
      end do
   end subroutine write_found

   ! ---- analysis ----------------------------------------------------------------------------------------------------

   !> The listing of the linkage and its motion, the check list after the input, tables for plotting; remarks on margins.
   subroutine report_analysis(set, problem, analysis, warnings, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem             !! bound to the linkage
      type(analysis_t), intent(in) :: analysis
      type(diagnostics_t), intent(in) :: warnings        !! of SETUP
      type(devices_t), intent(inout) :: devices
      real(wp), allocatable :: condition(:)   ! not allocated: an absent argument
      integer :: i

      if (set%limits%icond /= 0) condition = analysis%condition
      call list_results(set, problem, analysis%dimensions, analysis%motion, devices%six, devices%published, condition)
      if (allocated(analysis%targets)) then
         call list_output_targets(analysis%targets, problem%blank, devices%six)
         call put_output_targets(analysis%targets, devices%cases(devices%last_case()))
      end if
      call put_dimensions(problem%mechanism, analysis%dimensions, devices%cases(devices%last_case()))
      call put_violations(problem, analysis%motion, devices%cases(devices%last_case()))
      call list_setup(set, problem, devices%eight)
      if (len(set%skipped) > 0) call devices%eight%add(' GROUPS THAT PSALM DOES NOT READ: '//set%skipped)
      call list_reference_joints(problem%mechanism, analysis%warnings, devices%eight)
      do i = 1, warnings%count
         call devices%eight%add(' '//warnings%list(i)%render())
      end do
      if (allocated(analysis%arcs)) then
         call list_arcs(problem%mechanism, analysis%motion, analysis%arcs, analysis%condition, devices%eight)
         call put_arcs(problem%mechanism, analysis%motion, analysis%arcs, analysis%condition, devices%cases(devices%last_case()))
      end if
      if (allocated(analysis%margins)) call report_margins(set, problem, analysis, devices)
      call plot_motion(set, problem, analysis, devices%cases(devices%last_case()))
   end subroutine report_analysis

   subroutine report_margins(set, problem, analysis, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(analysis_t), intent(in) :: analysis
      type(devices_t), intent(inout) :: devices
      integer :: i

      call list_margins(set, problem, analysis%dimensions, analysis%margins, devices%six)
      call put_margins(set, problem, analysis%dimensions, analysis%margins, devices%cases(devices%last_case()))
      do i = 1, size(analysis%margins)
         if (.not. is_violated(analysis%margins(i))) cycle
         call devices%note_violation()
         call devices%remark(set, 'violated: '//describe_margin(set, problem, analysis%dimensions, analysis%margins(i), &
                                                                      small=.false.))
      end do
   end subroutine report_margins

   !> Device 9: the prescribed positions, and with IPLOT every degree in the direction of the first two.
   subroutine plot_motion(set, problem, analysis, tables)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(analysis_t), intent(in) :: analysis
      type(tables_t), intent(inout) :: tables
      real(wp), allocatable :: condition(:), sweep_condition(:)   ! not allocated: absent arguments

      if (set%limits%icond /= 0) then
         condition = analysis%condition
         if (allocated(analysis%sweep)) sweep_condition = analysis%sweep_condition
      end if
      call plot_positions(set%title, positions_block, problem, analysis%motion, tables, condition)
      if (allocated(analysis%sweep)) &
         call plot_positions(set%title, 'every_position', problem, analysis%sweep, tables, sweep_condition)
      if (allocated(analysis%motion%rates)) call plot_desired_rates(set%title, problem, analysis%motion, tables)
   end subroutine plot_motion

   !> Remarks and exit status where limits are violated, and on what makes the result doubtful.
   subroutine report_violations(set, problem, analysis, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(analysis_t), intent(in) :: analysis
      type(devices_t), intent(inout) :: devices

      associate (motion => analysis%motion)
         call report_crossings(set, problem, motion, devices)
         if (size(motion%violations) > 0) then
            call devices%note_violation()
            call report_open(set, problem, motion, devices)
            if (size(motion%violations) > most_reported) call devices%detail(set, 'and '// &
               to_text(size(motion%violations) - most_reported)//' more in the listing')
         end if
         if (allocated(motion%beyond)) call report_unreached(set, motion%beyond, devices)
      end associate
      if (.not. allocated(analysis%warnings)) return
      if (size(analysis%warnings%short) > 0) call devices%remark(set, describe_short_links(set, problem%mechanism, &
                                                                                         analysis%dimensions, analysis%warnings))
      if (analysis%warnings%at_rest) call devices%remark(set, words_at_rest)
   end subroutine report_violations

   subroutine report_crossings(set, problem, motion, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(devices_t), intent(inout) :: devices
      integer :: i

      do i = 1, min(size(motion%crossings), most_reported)
         call devices%remark(set, 'warning: '//describe_crossing(problem, motion, motion%crossings(i)))
      end do
   end subroutine report_crossings

   !> How often the linkage does not close, and the first violations.
   subroutine report_open(set, problem, motion, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(devices_t), intent(inout) :: devices
      integer :: i, open

      open = count(.not. motion%closed)
      if (allocated(motion%beyond)) open = open - count(motion%beyond)
      if (open > 0) call devices%remark(set, 'the linkage does not close at '//to_text(open)//' of '// &
                                        to_text(size(motion%closed))//' positions')
      if (size(motion%violations) > 0 .and. len(zero_words(set)) > 0) call devices%detail(set, 'inputs '//zero_words(set))
      do i = 1, min(size(motion%violations), most_reported)
         call devices%detail(set, describe_violation(problem, motion%input, motion%violations(i)))
      end do
   end subroutine report_open

   !> What the linkage does over the range of its input: tables, and in words for the first cases of a file.
   subroutine report_summary(set, mechanism, summary, motion, devices, study)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(summary_t), intent(in) :: summary
      type(motion_t), intent(in) :: motion         !! at the prescribed positions
      type(devices_t), intent(inout) :: devices
      type(sketch_study_t), intent(in), optional :: study !! of a sketch: all its outputs

      call put_summary(mechanism, summary, motion, set%has_stand_in(), devices%cases(devices%last_case()))
      if (present(study)) call put_output_ranges(study, devices%cases(devices%last_case()))
      call put_desired_errors(summary, devices%cases(devices%last_case()))
      call remark_between(set, mechanism, summary, motion, devices)
      if (devices%summarised == most_summarised) return
      devices%summarised = devices%summarised + 1
      if (present(study)) then
         call write_summary(set%title, mechanism, summary, devices%summary, zero_words(set), count(motion%closed), &
                            size(motion%closed), coincident_words(), set%has_stand_in())
         call range_lines(set, study, devices%summary)
      else
         call write_summary(set%title, mechanism, summary, devices%summary, zero_words(set), coincident=coincident_words())
      end if
      call write_desired_errors(summary, devices%summary)
      if (devices%summarised == most_summarised .and. set%limits%last == 0) &
         call devices%summary%add('Further cases of the file are not summarised')

   contains

      !> The outer joints of the dyad that is undetermined, by name if they have names.
      function coincident_words() result(words)
         character(:), allocatable :: words

         words = ''
         if (summary%undetermined_loop == 0) return
         words = 'the outer joints of '//the_group(mechanism, summary%undetermined_loop)
         if (any(summary%undetermined_joints == 0)) return
         associate (names => set%sketch%joint_name(summary%undetermined_joints))
            words = 'joints '//trim(names(1))//' and '//trim(names(2))
         end associate
      end function coincident_words
   end subroutine report_summary

   !> A limit of the transmission angle that is kept at the positions and not between them. TANGLE limits pairs of links; the
   !> angle of the summary is that between the positions if these go round, if the input slides, or if the linkage closes in part.
   subroutine remark_between(set, mechanism, summary, motion, devices)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(summary_t), intent(in) :: summary
      type(motion_t), intent(in) :: motion
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: words
      integer :: n

      if (.not. set%limits%tangle_given .or. set%constr%irange /= range_positions) return
      if (summary%angle_loop == 0 .or. summary%at_positions .or. .not. all(motion%closed) .or. size(motion%violations) > 0) return
      if (mechanism%groups(summary%angle_loop)%kind /= assur_rrr) return
      n = size(motion%input)
      if (.not. (summary%partial .or. summary%sliding_input)) then
         if (real(n, wp)*(maxval(motion%input) - minval(motion%input)) < full_turn*real(n - 1, wp)*(1.0_wp - rounding)) return
      end if
      associate (least => right_angle - set%limits%tangle)
         if (.not. summary%angle < least) return
         words = 'the transmission angle falls to '//plain_number(summary%angle)//' degrees between the '// &
                 'positions, at input '//plain_number(summary%angle_input)//'; '// &
                 trim(merge('TRMIN ', 'TANGLE', set%limits%trmin_given))//' keeps it above '//plain_number(least)//' at them'
         call devices%remark(set, words)
      end associate
   end subroutine remark_between

   !> What is proven of the motion over the range of the input: listing, device 9, remarks and exit status.
   subroutine report_proof(set, mechanism, study, devices)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices

      if (study%empty) then
         if (set%limits%iproof > 0) call devices%remark(set, &
                                                        'IPROOF proves the motion between the inputs, but all inputs are the same')
         return
      end if
      call list_proof(set, mechanism, study, devices%six)
      call put_proof(set%title, mechanism, study, devices%cases(devices%last_case()))
      if (.not. study%is_violating()) return
      call devices%note_violation()
      if (study%is_open()) call devices%remark(set, describe_proof(study))
      if (any(study%margins%is_broken)) call devices%remark(set, to_text(count(study%margins%is_broken))//' of '// &
         to_text(size(study%margins))//' margins are proven to be violated; see the end of the listing')
      if (any(study%kept%is_broken)) call devices%remark(set, to_text(count(study%kept%is_broken))//' of '// &
         to_text(size(study%kept))//' clearances are proven to be less than asked; see the end of the listing')
   end subroutine report_proof

   ! ---- tolerances --------------------------------------------------------------------------------------------------

   !> Bands of the output within the tolerances of the dimensions.
   subroutine report_tolerances(set, mechanism, result, devices)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(tolerances_t), intent(in) :: result
      type(devices_t), intent(inout) :: devices

      if (.not. result%closes) then
         call devices%remark(set, 'no tolerances, because the linkage does not close everywhere')
         return
      end if
      if (result%is_violating()) call devices%note_violation()
      if (.not. set%has_stand_in()) then
         call list_tolerances(mechanism, result%linear, result%sample, devices%six)
         call put_tolerances(set%title, mechanism%sliding_input, result%linear, result%sample, devices%cases(devices%last_case()))
      end if
      if (several_outputs(set) .and. allocated(result%linear%bands)) then
         call list_output_bands(set%sketch, result%linear, result%sample, devices%six)
         call put_output_bands(set%sketch, result%linear, result%sample, devices%cases(devices%last_case()))
      end if
      if (set%has_stand_in()) call list_sample(mechanism, result%sample, devices%six)
      if (allocated(result%adjustments)) then
         call list_adjustments(set%has_names(), result%linear, result%adjustments, set%toler%outtol, devices%six)
         call put_adjustments(result%linear, result%adjustments, devices%cases(devices%last_case()))
      end if
      if (any(result%linear%dead)) call devices%remark(set, 'dead point at position '// &
         to_text(findloc(result%linear%dead, .true., dim=1))//': effects of tolerances are infinite there')
      if (result%sample%trials < result%trials) call devices%remark(set, &
         trim(merge('MAXTIME passed', 'interrupted   ', result%out_of_time))//': the sample has '// &
         to_text(result%sample%trials)//' of '//to_text(result%trials)//' linkages')
      if (result%sample%open > 0) call devices%remark(set, to_text(result%sample%open)//' of '// &
         to_text(result%sample%trials)//' linkages within the tolerances do not close')
   end subroutine report_tolerances

   !> The allocation in the listing and in tables; remarks on what is not kept.
   subroutine report_allocation(set, sliding_input, result, devices)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: sliding_input
      type(allocation_t), intent(in) :: result
      type(devices_t), intent(inout) :: devices
      integer :: j, missed

      if (.not. result%closes) then
         call devices%remark(set, 'no tolerances are allotted, because the linkage does not close everywhere')
         return
      end if
      if (result%is_violating()) call devices%note_violation()
      if (any(result%dead)) call devices%remark(set, 'dead point at position '// &
         to_text(findloc(result%dead, .true., dim=1))//': effects of tolerances are infinite there, and the bands leave it out')
      if (.not. result%solved) then
         if (result%without_step > 0) then
            call devices%remark(set, 'no tolerances are allotted: '//item_name(result%names(result%without_step))// &
                                ' has no grade or step within its limits (ALMIN, ALMAX), or none in common with its class')
         else if (.not. result%proven) then
            call devices%remark(set, 'no tolerances are allotted: '//search_ended()//' before it found any')
         else if (result%impossible > 0) then
            associate (band => result%bands(result%impossible))
               call devices%remark(set, 'no tolerances are allotted: the least ones let '// &
                                   trim(result%numbers(band%number))//' leave its band at position '//to_text(band%position))
            end associate
         else if (result%unsettled) then
            call devices%remark(set, 'no tolerances are allotted: the widths that hold ALYLD do not settle; another ALYLD, '// &
                                'or ALRULE=''RSS''')
         else
            call devices%remark(set, 'no tolerances are allotted: rounding prevents it')
         end if
         return
      end if
      call list_allocation(set%has_names(), result, devices%six)
      call put_allocation(sliding_input, result, devices%cases(devices%last_case()))
      do j = 1, size(result%plays)
         associate (play => result%plays(j))
            if (play%turns(1) == 0) cycle
            if (play%turns(1) == play%turns(2)) then
               call devices%remark(set, item_name(play%name)//': there is no load at position '//to_text(play%turns(1))// &
                                   ' that could press the gap to one side (PLOAD); it is taken to lie anywhere')
            else
               call devices%remark(set, item_name(play%name)//': the load turns over between positions '// &
                                   to_text(play%turns(1))//' and '//to_text(play%turns(2))//', so that the gap does not '// &
                                   'stay on one side (PLOAD); it is taken to lie anywhere')
            end if
         end associate
      end do
      if (.not. result%proven) call devices%remark(set, search_ended()//': the tolerances of &ALLOC keep the bands, but '// &
                                                   'cheaper ones may cost '//number_words(result%bound)//' in place of '// &
                                                   number_words(result%value))
      if (result%proof%asked) call report_proof_of_bands()
      if (result%trials == 0) return
      if (result%sample%trials < result%trials) call devices%remark(set, &
         trim(merge('MAXTIME passed', 'interrupted   ', result%out_of_time))//': the sample of &ALLOC has '// &
         to_text(result%sample%trials)//' of '//to_text(result%trials)//' linkages')
      missed = findloc([(.not. result%is_kept(j), j=1, size(result%bands))], .true., dim=1)
      if (missed == 0) return
      associate (band => result%bands(missed))
         call devices%remark(set, 'the linear bands are not those of the linkage: of '//to_text(result%sample%trials)// &
                             ' linkages '//to_text(nint(result%sample%beyond(band%position, result%columns(missed))))// &
                             ' leave the band of '//trim(result%numbers(band%number))//' at position '//to_text(band%position)// &
                             ', by up to '//number_words(beyond(missed)))
      end associate

   contains

      !> Why the search for grades and steps ended early.
      function search_ended() result(words)
         character(:), allocatable :: words

         words = 'the search for grades and steps ended at node '//to_text(result%nodes)
         if (result%out_of_time) words = 'MAXTIME passed: '//words
      end function search_ended

      !> How far the sample leaves a band.
      pure real(wp) function beyond(j)
         integer, intent(in) :: j

         associate (at => result%bands(j)%position, column => result%columns(j))
            beyond = max(result%sample%high(at, column), -result%sample%low(at, column)) - result%bands(j)%width
         end associate
      end function beyond

      !> Remarks on bands that are not certified.
      subroutine report_proof_of_bands()
         integer :: k

         associate (proof => result%proof)
            k = findloc(proof%verdict, band_violated, dim=1)
            if (k > 0) then
               associate (band => result%bands(k))
                  if (proof%corner(k) < huge(1.0_wp)) then
                     call devices%remark(set, 'a linkage within the tolerances leaves the band of '// &
                                         trim(result%numbers(band%number))//' at position '//to_text(band%position)//': it '// &
                                         'deviates by '//number_words(proof%corner(k)))
                  else
                     call devices%remark(set, 'a linkage within the tolerances does not close, at a corner of '// &
                                         'the band of '//trim(result%numbers(band%number))//' at position '//to_text(band%position))
                  end if
               end associate
            end if
            k = findloc(proof%verdict, band_undecided, dim=1)
            if (k > 0) call devices%remark(set, 'not certified: the band of '// &
                                           trim(result%numbers(result%bands(k)%number))//' at position '// &
                                           to_text(result%bands(k)%position)//', and '// &
                                           to_text(count(proof%verdict == band_undecided) - 1)//' more')
            if (any(result%limit == limit_least) .and. result%scaled < 1.0_wp) call devices%remark(set, &
               'ALPROF=''SCALE'' makes tolerances smaller than their least (ALMIN)')
         end associate
      end subroutine report_proof_of_bands
   end subroutine report_allocation

   ! ---- rates -------------------------------------------------------------------------------------------------------

   !> The listing of kalm, all arcs with KTHETA, the table; remarks on open positions and dead points.
   subroutine report_rates(set, problem, rates, devices, forces, machine)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(rate_study_t), intent(in) :: rates
      type(devices_t), intent(inout) :: devices
      type(force_study_t), intent(in), optional :: forces       !! if the case has masses, loads or springs
      type(machine_study_t), intent(in), optional :: machine    !! if it has a motor
      integer :: k, reported

      call put_dimensions(problem%mechanism, rates%dimensions, devices%cases(devices%last_case()))
      call put_violations(problem, rates%motion, devices%cases(devices%last_case()))
      if (allocated(rates%arcs)) then
         call list_all_rates(problem, rates, devices%eight)
         call put_arc_rates(problem%mechanism, rates, devices%cases(devices%last_case()))
      end if
      call list_rates(set, problem, rates, devices%six)
      call put_rates(set%title, set%rates%speed, set%rates%accel, problem, rates, .not. set%has_names(), &
                     devices%cases(devices%last_case()), forces)
      if (present(forces)) call report_forces(set, forces, devices)
      if (present(machine)) call report_machine(set, machine, devices)
      if (rates%is_violating()) call devices%note_violation()
      call report_crossings(set, problem, rates%motion, devices)
      if (.not. all(rates%motion%closed)) call report_open(set, problem, rates%motion, devices)
      if (allocated(rates%motion%beyond)) call report_unreached(set, rates%motion%beyond, devices)
      reported = 0
      do k = 1, size(rates%dead)
         if (rates%dead(k) == 0 .or. .not. rates%motion%closed(k)) cycle
         reported = reported + 1
         if (reported <= most_reported) call devices%remark(set, dead_point_words(problem%mechanism, rates%dead(k))//' at '// &
                                                    position_words(set, k, rates%motion%input(k)))
      end do
      if (reported > most_reported) call devices%detail(set, 'and '//to_text(reported - most_reported)//' more dead points')
   end subroutine report_rates

   !> Motion from torque.
   subroutine report_machine(set, machine, devices)
      type(data_set_t), intent(in) :: set
      type(machine_study_t), intent(in) :: machine
      type(devices_t), intent(inout) :: devices

      call list_machine(set, machine, devices%six)
      call put_machine(machine, devices%cases(devices%last_case()))
      if (machine%is_complete()) return
      call devices%note_violation()
      call devices%remark(set, 'motion from torque: '//lower_case(cycle_words(set%has_names(), machine)))
   end subroutine report_machine
end module psalm_report
