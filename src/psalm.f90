!> PSALM as a library: the one module that another program uses.
!>
!> A `case_t` is a linkage and what is asked of it. It is read from a file (`read_file`), from text in memory (`read_text`), or made
!> by `new_case` and its verbs: joints and links of a sketch, loops, any item of the manual; what is not given has the default of
!> the manual. The verbs study it: data in, results out. Nothing is printed, no file is written, no signal is touched. Whatever is
!> wrong with a case comes back as findings, each with its line and a text; results are then empty.
!>
!> Lengths are in the user's one unit, angles in degrees, rates of angles in radians.
module psalm
   use psalm_allocation, only: allocation_t
   use psalm_allocation_proof, only: band_certified, band_undecided, band_violated
   use psalm_analysis, only: analysis_t, wanted_t
   use psalm_assembly_study, only: assembly_study_t
   use psalm_case, only: case_t, new_case, read_file, read_text
   use psalm_clearance_study, only: clearance_study_t
   use psalm_devices, only: drawing_t
   use psalm_error, only: motion_t, violation_t
   use psalm_exact_study, only: exact_study_t
   use psalm_family_study, only: family_t
   use psalm_force_study, only: force_study_t
   use psalm_force_verbs, only: find_balance, find_clearance, find_forces, find_machine, find_rates, find_springs, find_time, &
                                find_vibration
   use psalm_kind_search, only: kind_study_t
   use psalm_kinds, only: wp
   use psalm_machine_study, only: machine_study_t
   use psalm_margins, only: margin_t
   use psalm_motion_verbs, only: analyse, find_allocation, find_assemblies, find_family, find_tolerances, prove, proven_t, summarise
   use psalm_muscle_study, only: muscle_study_t
   use psalm_nlp, only: nlp_t, plain_nlp_t
   use psalm_output_kind, only: output_point => motion_point, output_angle => motion_angle, output_distance => motion_distance, &
                                output_slide => motion_slide, output_pose => motion_pose
   use psalm_rate_study, only: rate_study_t
   use psalm_search, only: found_t
   use psalm_search_verbs, only: find_exact, find_kinds, found_case, minimise, synthesise
   use psalm_shape_verbs, only: cams_t, draw, find_cams, make_board
   use psalm_solver, only: ending_t, observer_t, search_state_t
   use psalm_status, only: findings_t => diagnostics_t, finding_t, level_error, level_remark, level_warning
   use psalm_steady_study, only: steady_study_t
   use psalm_stop, only: stop_t, stop_request_t
   use psalm_study_frame, only: column_named, report_t
   use psalm_summary, only: summary_t
   use psalm_synthesis, only: synthesis_t, ended_unmade, ended_infeasible, ended_converged, ended_small_objective, &
                              ended_iterations, ended_starts, ended_time, ended_on_request, ended_refused, ended_without_rates
   use psalm_tables, only: column_t, table_t, tables_t, table_for_plots => for_plots, table_kind_flag => kind_flag, &
                           table_kind_whole => kind_whole, table_kind_word => kind_word
   use psalm_time_study, only: time_study_t
   use psalm_tolerance, only: tolerances_t
   use psalm_verbs, only: study, verb_t, verbs
   use psalm_version, only: version
   implicit none (type, external)
   private
   public :: wp, version
   ! cases
   public :: case_t, new_case, read_file, read_text
   public :: output_point, output_angle, output_distance, output_slide, output_pose
   public :: findings_t, finding_t, level_error, level_remark, level_warning
   ! studies: the verb, its result
   public :: analyse, analysis_t, wanted_t, motion_t, violation_t, margin_t
   public :: summarise, summary_t
   public :: find_rates, rate_study_t
   public :: find_forces, force_study_t
   public :: find_machine, machine_study_t
   public :: find_time, time_study_t
   public :: find_tolerances, tolerances_t
   public :: find_allocation, allocation_t
   public :: band_certified, band_undecided, band_violated   !! of `proof%verdict` of an `allocation_t`
   public :: find_family, family_t
   public :: synthesise, synthesis_t, found_t, found_case
   public :: ended_unmade, ended_infeasible, ended_converged, ended_small_objective, ended_iterations, ended_starts, ended_time, &
             ended_on_request, ended_refused, ended_without_rates
   public :: find_exact, exact_study_t
   public :: find_kinds, kind_study_t
   public :: prove, proven_t
   public :: find_assemblies, assembly_study_t
   public :: find_balance, find_springs, muscle_study_t
   public :: find_vibration, steady_study_t
   public :: find_cams, cams_t
   public :: find_clearance, clearance_study_t
   public :: draw, make_board, drawing_t
   ! any study by its name
   public :: study, report_t, verb_t, verbs
   public :: tables_t, table_t, column_t, column_named, table_for_plots, table_kind_flag, table_kind_whole, table_kind_word
   ! problems of one's own
   public :: minimise, nlp_t, plain_nlp_t, ending_t
   public :: stop_t, stop_request_t, observer_t, search_state_t
end module psalm
