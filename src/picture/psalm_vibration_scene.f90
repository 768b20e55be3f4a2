!> What pictures show of a vibrating link: how it is bent over the sweep, and what ssics finds over speeds and for the chart.
module psalm_vibration_scene
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_preparation, only: prepared_t
   use psalm_stop, only: stop_t
   use psalm_vibration_study, only: vibration_study_t
   implicit none (type, external)
   private
   public :: vibration_scene_t, make_vibration_scene

   type :: vibration_scene_t
      type(vibration_study_t) :: study
      integer :: bar = 0                         !! the link
      logical :: reversed = .false.              !! the bar runs against the arc
      real(wp), allocatable :: deflection(:, :)  !! shape (sweep, modes): of each mode, user's length, to the left of the arc
      real(wp) :: factor = 1.0_wp                !! it is drawn that many times larger
      real(wp) :: metre = 1.0_wp                 !! metres in the user's unit of length
      logical :: settles = .false.               !! the deflection is what the link does
   end type vibration_scene_t

   interface
      !> Of a case with the group VIBR. Errors: `found` false if ssics would refuse it, or there is no periodic deflection.
      module subroutine make_vibration_scene(set, prepared, sweep, scene, found, stop)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(prepared_t), intent(in) :: prepared
         real(wp), intent(in) :: sweep(:)           !! increments of the input, degrees
         type(vibration_scene_t), intent(out) :: scene
         logical, intent(out) :: found
         type(stop_t), intent(in), optional :: stop !! asked now and then; nothing is found then
      end subroutine make_vibration_scene
   end interface
end module psalm_vibration_scene
