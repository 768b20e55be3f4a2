!> Everything that ssics studies in a case: what cannot be studied is found before any work is done. Data in, results out.
module psalm_steady_study
   use psalm_crank_motion, only: crank_motion_t
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_drive_links_study, only: drive_links_t
   use psalm_drive_study, only: drive_study_t, hill_study_t
   use psalm_error, only: problem_t
   use psalm_estimate_study, only: estimate_t
   use psalm_flex_study, only: flex_study_t
   use psalm_force_model, only: force_model_t
   use psalm_mechanism, only: mechanism_t
   use psalm_preparation, only: prepared_t
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_vibration_study, only: vibration_study_t
   implicit none (type, external)
   private
   public :: steady_study_t, check_steady, find_steady, make_model_with_links

   !> What a case asks for is allocated.
   type :: steady_study_t
      type(crank_motion_t) :: crank                  !! if it is not known there is nothing else
      type(estimate_t), allocatable :: estimates(:)
      type(vibration_study_t), allocatable :: vibration
      type(flex_study_t), allocatable :: flexible(:)
      type(drive_study_t), allocatable :: drive
      type(drive_links_t), allocatable :: together   !! drive and links of beam elements
      type(hill_study_t), allocatable :: hill
      logical :: stopped = .false.                   !! the host asked for the end: what was found so far
   contains
      procedure :: is_empty
   end type steady_study_t

   interface
      !> Errors: no speed, groups of forces that do not fit, links that cannot vibrate, nothing asked for.
      module subroutine check_steady(set, prepared, findings, vibration_alone)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(prepared_t), intent(in) :: prepared
         type(diagnostics_t), intent(inout) :: findings
         logical, intent(in), optional :: vibration_alone !! only what &VIBR asks for is to be studied
      end subroutine check_steady

      !> Studies of a case that `check_steady` found no fault with.
      module subroutine find_steady(set, problem, prepared, study, stop)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(problem_t), intent(in) :: problem     !! of no meaning without a linkage
         type(prepared_t), intent(in) :: prepared
         type(steady_study_t), intent(out) :: study
         type(stop_t), intent(in), optional :: stop !! asked now and then
      end subroutine find_steady

      !> The force model with the masses of the links of ESTIM, VIBR and FLEX, but for the link of an arc, which is studied.
      module subroutine make_model_with_links(set, mechanism, dimensions, arc, model, all)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(mechanism_t), intent(in) :: mechanism
         type(dimensions_t), intent(in) :: dimensions
         integer, intent(in) :: arc                 !! 0: none
         type(force_model_t), intent(in) :: model
         class(force_model_t), allocatable, intent(out) :: all
      end subroutine make_model_with_links
   end interface

contains

   !> True if nothing was found.
   pure logical function is_empty(self)
      class(steady_study_t), intent(in) :: self

      is_empty = .not. (allocated(self%estimates) .or. allocated(self%vibration) .or. allocated(self%flexible) .or. &
                        allocated(self%drive) .or. allocated(self%hill))
   end function is_empty
end module psalm_steady_study
