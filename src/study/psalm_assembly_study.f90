!> All assemblies of a sketch as it is drawn, for `psalm --assemblies`.
module psalm_assembly_study
   use psalm_assemblies, only: assemblies_t, find_assemblies
   use psalm_closure, only: closure_t, state_t
   use psalm_data_set, only: data_set_t
   use psalm_sketch_assembly, only: assemble_sketch
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: assembly_study_t, study_assemblies

   integer, parameter :: most_listed = 1000   !! assemblies

   type :: assembly_study_t
      logical :: valid = .false.
      type(closure_t) :: closure
      type(assemblies_t) :: found
   end type assembly_study_t

contains

   !> Find them at the inputs of the drawing.
   subroutine study_assemblies(set, study, stop)
      type(data_set_t), intent(in) :: set
      type(assembly_study_t), intent(out) :: study
      type(stop_t), intent(in), optional :: stop   !! asked now and then: the assemblies so far are there
      type(state_t) :: drawn
      type(diagnostics_t) :: findings

      call assemble_sketch(set, study%closure, drawn, study%valid, findings)
      if (study%valid) call find_assemblies(study%closure, drawn, most_listed, study%found, stop)
   end subroutine study_assemblies
end module psalm_assembly_study
