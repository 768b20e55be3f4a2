!> Verbs about the motion of a linkage as given: what it does at its positions and over its range, what is proven of it, how it
!> can be put together, how tolerances and settings change it, which tolerances are the cheapest.
module psalm_motion_verbs
   use psalm_allocation, only: allocation_t, study_allocation
   use psalm_analysis, only: analysis_t, wanted_t, study_analysis => analyse, wanted_by
   use psalm_assembly_list, only: report_assemblies
   use psalm_assembly_study, only: assembly_study_t, study_assemblies
   use psalm_case, only: case_t
   use psalm_chain_proof_study, only: chain_proof_t, prove_loops
   use psalm_chain_report, only: report_chain_proof, report_outputs
   use psalm_chain_study, only: chain_study_t
   use psalm_error, only: inputs_of
   use psalm_family_list, only: report_family
   use psalm_family_study, only: family_t, study_family => find_family
   use psalm_finale, only: mark_beyond
   use psalm_kinds, only: wp
   use psalm_margin_list, only: describe_margin
   use psalm_margins, only: is_violated
   use psalm_position_table, only: put_positions, put_sketch
   use psalm_preparation, only: memory_need_t, threads_for
   use psalm_proof_study, only: proof_study_t, study_proof, proof_wanted, no_proof, proof_of_inputs
   use psalm_report, only: report_allocation, report_analysis, report_proof, report_summary, report_tolerances
   use psalm_sketch_study, only: sketch_study_t, study_conditions, study_sketch
   use psalm_status, only: findings_t => diagnostics_t
   use psalm_stop, only: stop_t, is_to_end
   use psalm_study_frame, only: frame_t, report_t, warn, empty_motion, threads_of, may_share
   use psalm_summary, only: summary_t
   use psalm_tables, only: table_t, table_of
   use psalm_tolerance, only: tolerances_t, study_tolerances
   implicit none (type, external)
   private
   public :: analyse, summarise, find_tolerances, find_allocation, find_family, proven_t, prove, find_assemblies

   type(memory_need_t), parameter :: need_of_psalm = memory_need_t()

   !> What is proven of a motion.
   type :: proven_t
      type(proof_study_t), allocatable :: loops    !! of dyads
      type(chain_proof_t), allocatable :: poses    !! of a sketch with larger groups
      type(chain_study_t), allocatable :: chain    !! its positions
   end type proven_t

contains

   !> Analyse a case as given: what it does at its input positions.
   !>
   !> Findings: errors of the case, and a warning for every violation of closure or a limit.
   subroutine analyse(case, analysis, findings, wanted, report, brief, stop)
      type(case_t), intent(in) :: case
      type(analysis_t), intent(out) :: analysis           !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(wanted_t), intent(in), optional :: wanted      !! what is wanted besides the motion; of a report as the case says
      type(report_t), intent(out), optional :: report     !! tables: inputs, outputs, of a sketch all joints
      logical, intent(in), optional :: brief              !! no listing
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; then there is no result
      type(wanted_t) :: all_wanted
      type(frame_t) :: frame
      type(sketch_study_t) :: sketch
      type(table_t) :: totals
      logical :: short
      integer :: i

      if (present(wanted)) all_wanted = wanted
      call frame%begin(case, findings, report, every_loop=all_wanted%arcs, need=need_of_psalm)
      call no_analysis(analysis)
      if (.not. frame%ready) return
      short = .false.
      if (present(brief)) short = brief
      if (present(report) .and. .not. present(wanted) .and. .not. short) all_wanted = wanted_by(frame%set)
      call study_analysis(frame%set, frame%problem, frame%problem%given, all_wanted, analysis, stop)
      if (is_to_end(stop)) then
         call no_analysis(analysis)
         call frame%end_early(report, findings)
         return
      end if
      call warn(frame%problem, analysis%motion, findings)
      if (allocated(analysis%margins)) then
         do i = 1, size(analysis%margins)
            if (is_violated(analysis%margins(i))) call findings%warning('violated: '// &
               describe_margin(frame%set, frame%problem, analysis%dimensions, analysis%margins(i), small=.true.))
         end do
      end if
      if (.not. present(report)) return
      if (frame%set%has_names()) then
         call study_sketch(frame%set, frame%problem, frame%prepared%given, analysis%motion%closed, 1.0_wp, 0.0_wp, sketch, &
                           places_only=.true.)
         if (frame%set%limits%icond /= 0) call study_conditions(frame%set, frame%problem, frame%prepared%given, sketch)
         call put_sketch(frame%set%sketch, sketch, 0, frame%devices%cases(1), problem=frame%problem)
      else
         call put_positions(frame%problem, analysis%motion, frame%devices%cases(1), analysis%condition)
      end if
      if (.not. short) then
         call report_analysis(frame%set, frame%problem, analysis, frame%prepared%warnings, frame%devices)
         if (frame%set%has_names()) call report_outputs(frame%set, sketch, analysis%motion%beyond, 0, frame%devices)
         call mark_beyond(frame%devices%published, frame%devices%six)
      end if
      if (analysis%is_violating()) call frame%devices%note_violation()
      totals = table_of('totals', 'the whole motion')
      call totals%add('objective', [analysis%motion%total])
      call totals%add('positions', [size(analysis%motion%input)])
      call totals%add('closed', [count(analysis%motion%closed)])
      call frame%devices%cases(1)%put(totals)
      call frame%conclude(report)
   end subroutine analyse

   subroutine no_analysis(analysis)
      type(analysis_t), intent(out) :: analysis

      call empty_motion(analysis%motion)
   end subroutine no_analysis

   !> What a linkage does over the whole range of its input: where it closes, dead points, stroke, time ratio, extremes.
   subroutine summarise(case, summary, findings, report)
      type(case_t), intent(in) :: case
      type(summary_t), intent(out) :: summary             !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! listing: the summary in words
      type(frame_t) :: frame
      type(analysis_t), allocatable :: analysis
      type(sketch_study_t) :: sketch

      call frame%begin(case, findings, report)
      if (.not. frame%ready) return
      allocate (analysis)
      call study_analysis(frame%set, frame%problem, frame%problem%given, wanted_t(summary=.true.), analysis)
      summary = analysis%summary
      if (.not. present(report)) return
      if (frame%set%has_names()) then
         call study_sketch(frame%set, frame%problem, frame%prepared%given, analysis%motion%closed, 1.0_wp, 0.0_wp, sketch, &
                           places_only=.true.)
         call report_summary(frame%set, frame%problem%mechanism, summary, analysis%motion, frame%devices, sketch)
      else
         call report_summary(frame%set, frame%problem%mechanism, summary, analysis%motion, frame%devices)
      end if
      call frame%devices%six%add_text(frame%devices%summary%content())
      call frame%conclude(report, findings)
   end subroutine summarise

   !> What the tolerances of the group TOLER do to the output of a case as given.
   subroutine find_tolerances(case, tolerances, findings, threads, stop, report)
      type(case_t), intent(in) :: case
      type(tolerances_t), intent(out) :: tolerances       !! empty if the case has errors or does not close
      type(findings_t), intent(inout) :: findings
      integer, intent(in), optional :: threads            !! that share the work; default THREADS of the case, or 1
      type(stop_t), intent(in), optional :: stop          !! by which the host can end the sample
      type(report_t), intent(out), optional :: report     !! tables: bands of the output
      type(frame_t) :: frame
      type(stop_t) :: ending

      call frame%begin(case, findings, report)
      if (frame%ready) frame%ready = may_share(threads, findings)
      if (.not. frame%ready) return
      if (present(stop)) ending = stop
      call study_tolerances(frame%set, frame%problem%mechanism, frame%problem%given, &
                            threads_for(frame%set, threads_of(threads)), ending, tolerances)
      if (.not. tolerances%closes) call findings%warning('no tolerances, because the linkage does not close everywhere')
      if (.not. present(report)) return
      if (tolerances%closes) call report_tolerances(frame%set, frame%problem%mechanism, tolerances, frame%devices)
      if (.not. tolerances%closes) call frame%devices%note_violation()
      call frame%conclude(report, findings)
   end subroutine find_tolerances

   !> The cheapest tolerances within the bands of the group ALLOC, of a case as given.
   subroutine find_allocation(case, allocation, findings, threads, stop, report)
      type(case_t), intent(in) :: case
      type(allocation_t), intent(out) :: allocation       !! empty if the case has errors or does not close
      type(findings_t), intent(inout) :: findings
      integer, intent(in), optional :: threads            !! that share the work; default THREADS of the case, or 1
      type(stop_t), intent(in), optional :: stop          !! by which the host can end the sample
      type(report_t), intent(out), optional :: report     !! tables: tolerances and bands
      type(frame_t) :: frame
      type(stop_t) :: ending

      call frame%begin(case, findings, report, 'ALLOC')
      if (frame%ready) frame%ready = may_share(threads, findings)
      if (.not. frame%ready) return
      if (present(stop)) ending = stop
      call study_allocation(frame%set, frame%problem%mechanism, frame%problem%given, &
                            threads_for(frame%set, threads_of(threads)), ending, allocation)
      call report_allocation(frame%set, frame%problem%mechanism%sliding_input, allocation, frame%devices)
      if (.not. allocation%closes) call frame%devices%note_violation()
      call frame%conclude(report, findings)
   end subroutine find_allocation

   !> The output for the settings of an adjustable dimension, the group SWEEP.
   subroutine find_family(case, family, findings, report, stop)
      type(case_t), intent(in) :: case
      type(family_t), intent(out) :: family               !! empty if the case has errors, or the dimension cannot be set
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: the output for every setting
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; the settings so far are there
      type(frame_t) :: frame
      logical :: found

      call frame%begin(case, findings, report, 'SWEEP')
      if (.not. frame%ready) return
      call study_family(frame%set, frame%problem%mechanism, frame%problem%given, inputs_of(frame%set), family, found, &
                        stop)
      if (family%stopped .and. found) then
         if (size(family%setting) == 0) then
            call frame%end_early(report, findings)
            return
         end if
         call frame%devices%note_violation()
      end if
      if (.not. present(report)) return
      call report_family(frame%set, family, found, frame%devices)
      call frame%conclude(report, findings)
   end subroutine find_family

   !> What can be proven of the motion over the range that IPROOF names, or between the inputs of the case.
   subroutine prove(case, proven, findings, report, stop)
      type(case_t), intent(in) :: case
      type(proven_t), intent(out) :: proven               !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: pieces of the range, extremes
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; then nothing is proven
      type(frame_t) :: frame
      logical :: valid
      integer :: range

      call frame%begin(case, findings, report)
      if (.not. frame%ready) return
      range = proof_wanted(frame%set, .false.)
      if (range == no_proof) range = proof_of_inputs
      if (frame%set%is_beyond_arrays()) then
         allocate (proven%chain, proven%poses)
         call prove_loops(frame%set, range, proven%chain, proven%poses, valid, stop)
         if (proven%poses%stopped) then
            deallocate (proven%chain, proven%poses)
            call frame%end_early(report, findings)
            return
         end if
         if (valid .and. present(report)) call report_chain_proof(frame%set, proven%chain, proven%poses, frame%devices)
      else
         allocate (proven%loops)
         call study_proof(frame%set, frame%problem, frame%problem%given, range, proven%loops, stop)
         if (proven%loops%stopped) then
            deallocate (proven%loops)
            call frame%end_early(report, findings)
            return
         end if
         if (present(report)) call report_proof(frame%set, frame%problem%mechanism, proven%loops, frame%devices)
      end if
      call frame%conclude(report, findings)
   end subroutine prove

   !> Every way in which the links of a sketch can be put together.
   subroutine find_assemblies(case, assemblies, findings, report, stop)
      type(case_t), intent(in) :: case
      type(assembly_study_t), intent(out) :: assemblies   !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: joints of every assembly
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; the assemblies so far are there
      type(frame_t) :: frame

      call frame%begin(case, findings, report)
      if (frame%ready .and. .not. frame%set%is_drawn()) then
         call findings%error('assemblies are those of a sketch (&CHAIN); this linkage is given by its loops')
         frame%ready = .false.
      end if
      if (.not. frame%ready) return
      call study_assemblies(frame%set, assemblies, stop)
      if (assemblies%found%stopped) then
         if (size(assemblies%found%states) == 0) then
            call frame%end_early(report, findings)
            return
         end if
         call frame%devices%note_violation()
      end if
      if (.not. present(report)) return
      if (assemblies%valid) call report_assemblies(frame%set, assemblies, frame%devices)
      call frame%conclude(report, findings)
   end subroutine find_assemblies
end module psalm_motion_verbs
