!> The studies of the library by their names. Data in, results out: nothing is printed, no file is written, no signal is touched.
!>
!> Every verb takes a case and gives its result as a type, with names of joints, links and outputs in it. Whatever is wrong with the
!> case comes back as findings; the result is then empty. With `report` it also gives what the programs of the suite write: listing,
!> tables, pictures, the linkages found as cases for the next study. `study` calls any verb by its name.
module psalm_verbs
   use psalm_allocation, only: allocation_t
   use psalm_analysis, only: analysis_t
   use psalm_assembly_study, only: assembly_study_t
   use psalm_case, only: case_t
   use psalm_clearance_study, only: clearance_study_t
   use psalm_devices, only: drawing_t
   use psalm_exact_study, only: exact_study_t
   use psalm_family_study, only: family_t
   use psalm_force_study, only: force_study_t
   use psalm_force_verbs, only: find_rates, find_forces, find_machine, find_time, find_balance, find_springs, &
                                find_vibration, find_clearance
   use psalm_kind_search, only: kind_study_t
   use psalm_machine_study, only: machine_study_t
   use psalm_motion_verbs, only: analyse, summarise, find_tolerances, find_allocation, find_family, proven_t, prove, find_assemblies
   use psalm_muscle_study, only: muscle_study_t
   use psalm_rate_study, only: rate_study_t
   use psalm_search_verbs, only: synthesise, find_exact, find_kinds
   use psalm_shape_verbs, only: cams_t, find_cams, draw, make_board
   use psalm_solver, only: observer_t
   use psalm_status, only: findings_t => diagnostics_t
   use psalm_steady_study, only: steady_study_t
   use psalm_stop, only: stop_t
   use psalm_study_frame, only: report_t, no_report
   use psalm_summary, only: summary_t
   use psalm_synthesis, only: synthesis_t
   use psalm_text, only: lower_case, nearest_name
   use psalm_time_study, only: time_study_t
   use psalm_tolerance, only: tolerances_t
   implicit none (type, external)
   private
   public :: verb_t, verbs, study

   integer, parameter :: verb_length = 12, program_length = 6, groups_length = 36, table_length = 10

   !> A verb: its name, the program of the suite that has it, the groups that ask for it (none: every case may be asked), and the
   !> table that its report is about (none: the first).
   type :: verb_t
      character(verb_length) :: name
      character(program_length) :: program
      character(groups_length) :: groups
      character(table_length) :: table
   end type verb_t

   !> All verbs that `study` knows.
   type(verb_t), parameter :: verbs(*) = [ &
      verb_t('analysis', 'psalm', '', 'positions'), &
      verb_t('summary', 'psalm', '', ''), &
      verb_t('tolerances', 'psalm', 'TOLER', ''), &
      verb_t('allocation', 'psalm', 'ALLOC', ''), &
      verb_t('sweep', 'psalm', 'SWEEP', ''), &
      verb_t('synthesis', 'psalm', 'SEARCH', 'found'), &
      verb_t('exact', 'psalm', 'EXACT', ''), &
      verb_t('kinds', 'psalm', 'KINDS', 'found'), &
      verb_t('proof', 'psalm', 'LIMITS CONSTR', ''), &
      verb_t('assemblies', 'psalm', 'CHAIN', ''), &
      verb_t('rates', 'kalm', 'RATES', 'positions'), &
      verb_t('forces', 'kalm', 'MASSES PLATES LOADS SPRING FRICTN', 'positions'), &
      verb_t('machine', 'kalm', 'MOTOR', 'positions'), &
      verb_t('time', 'kalm', 'TIME STOPS', 'time'), &
      verb_t('balance', 'muscle', 'BALANC', ''), &
      verb_t('springs', 'muscle', 'SPRNGS', ''), &
      verb_t('vibration', 'ssics', 'ESTIM VIBR FLEX DRIVEL HILL', ''), &
      verb_t('cams', 'calm', 'CAM CAM2', ''), &
      verb_t('clearance', 'bridge', 'CLEAR', ''), &
      verb_t('picture', 'balm', 'DXF', ''), &
      verb_t('board', 'balm', 'CHAIN', '')]

contains

   !> Any verb by its name: its report. `brief`: analysis, rates and forces give tables alone, no listing.
   subroutine study(case, verb, report, findings, threads, stop, monitor, brief)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: verb                    !! a name of `verbs`
      type(report_t), intent(out) :: report
      type(findings_t), intent(inout) :: findings
      integer, intent(in), optional :: threads            !! that share the work; default THREADS of the case, or 1
      type(stop_t), intent(in), optional :: stop          !! by which the host can end every study that may take long
      class(observer_t), intent(inout), optional :: monitor !! informed of the progress of a search
      logical, intent(in), optional :: brief
      type(analysis_t), allocatable :: analysis
      type(tolerances_t), allocatable :: tolerances
      type(allocation_t), allocatable :: allocation
      type(family_t), allocatable :: family
      type(kind_study_t), allocatable :: kinds
      type(synthesis_t), allocatable :: synthesis
      type(exact_study_t), allocatable :: exact
      type(proven_t), allocatable :: proven
      type(assembly_study_t), allocatable :: assemblies
      type(rate_study_t), allocatable :: rates
      type(force_study_t), allocatable :: forces
      type(machine_study_t), allocatable :: machine
      type(time_study_t), allocatable :: time
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
         call analyse(case, analysis, findings, report=report, brief=brief, stop=stop)
      case ('summary')
         allocate (summary)
         call summarise(case, summary, findings, report)
      case ('tolerances')
         allocate (tolerances)
         call find_tolerances(case, tolerances, findings, threads, stop, report)
      case ('allocation')
         allocate (allocation)
         call find_allocation(case, allocation, findings, threads, stop, report)
      case ('sweep')
         allocate (family)
         call find_family(case, family, findings, report, stop)
      case ('synthesis')
         allocate (synthesis)
         call synthesise(case, synthesis, findings, threads, stop, monitor, report)
      case ('kinds')
         allocate (kinds)
         call find_kinds(case, kinds, findings, threads, stop, report)
      case ('exact')
         allocate (exact)
         call find_exact(case, exact, findings, stop, report, threads)
      case ('proof')
         allocate (proven)
         call prove(case, proven, findings, report, stop)
      case ('assemblies')
         allocate (assemblies)
         call find_assemblies(case, assemblies, findings, report, stop)
      case ('rates')
         allocate (rates)
         call find_rates(case, rates, findings, report, brief, stop)
      case ('forces')
         allocate (forces)
         call find_forces(case, forces, findings, report, brief=brief, stop=stop)
      case ('machine')
         allocate (machine)
         call find_machine(case, machine, findings, report, stop)
      case ('time')
         allocate (time)
         call find_time(case, time, findings, report, stop)
      case ('balance')
         allocate (muscle)
         call find_balance(case, muscle, findings, report, stop)
      case ('springs')
         allocate (muscle)
         call find_springs(case, muscle, findings, report, stop)
      case ('vibration')
         allocate (steady)
         call find_vibration(case, steady, findings, report, stop)
      case ('cams')
         allocate (cams)
         call find_cams(case, cams, findings, report, stop)
      case ('clearance')
         allocate (clearance)
         call find_clearance(case, clearance, findings, report, stop)
      case ('picture')
         call draw(case, files, findings, report, stop)
      case ('board')
         call make_board(case, files, findings, report)
      case default
         near = nearest_name(lower_case(verb), verbs%name)
         if (len(near) > 0) near = "; did you mean '"//near//"'?"
         call findings%error("no study is called '"//verb//"'"//near)
         call no_report(report)
      end select
   end subroutine study
end module psalm_verbs
