!> What pictures show of a joint with clearance: where its pin stands in its hole over the sweep, load and force of contact.
module psalm_clearance_scene
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_preparation, only: prepared_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: clearance_scene_t, make_clearance_scene

   !> Arrays have the shape (sweep).
   type :: clearance_scene_t
      character(:), allocatable :: name          !! of the joint
      integer :: point = 0                       !! of the mechanism, where it is
      real(wp) :: diametral = 0.0_wp             !! clearance, user's length
      real(wp), allocatable :: pin(:, :)         !! shape (2, sweep): direction of the pin in its hole, unit vectors
      real(wp), allocatable :: load(:, :)        !! shape (2, sweep): without clearance, N
      real(wp), allocatable :: force(:)          !! of contact, N; below zero contact would be lost
   end type clearance_scene_t

   interface
      !> Of a case with the group CLEAR. Errors: `found` false if bridge would refuse it, or the contact cannot be followed.
      module subroutine make_clearance_scene(set, prepared, sweep, scene, found, stop)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(prepared_t), intent(in) :: prepared
         real(wp), intent(in) :: sweep(:)           !! increments of the input, degrees
         type(clearance_scene_t), intent(out) :: scene
         logical, intent(out) :: found
         type(stop_t), intent(in), optional :: stop !! asked now and then; nothing is found then
      end subroutine make_clearance_scene
   end interface
end module psalm_clearance_scene
