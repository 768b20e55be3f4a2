!> The input as it is shown: from where it counts. One zero for listing, summary, tables, messages, proofs and pictures.
!>
!> Of a mechanism given by its arcs it is the crank's angle from the machine's x axis, in a turn from 0; of a drawn one it counts
!> from the drawing, as it was given.
module psalm_shown_input
   use psalm_angles, only: within_turn
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   implicit none (type, external)
   private
   public :: reference_input, zero_input, input_at, input_in_turn, shows_crank, crank_angle_at

contains

   !> The reference input as shown: degrees or length.
   pure real(wp) function reference_input(mechanism, dimensions)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions

      reference_input = dimensions%crnki
      if (mechanism%from_drawing) reference_input = mechanism%reference
   end function reference_input

   !> The crank's angle from the x axis, or the length of the actuator, where the input as shown is zero.
   pure real(wp) function zero_input(mechanism, dimensions)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions

      zero_input = 0.0_wp
      if (mechanism%from_drawing) zero_input = dimensions%crnki - mechanism%reference
   end function zero_input

   !> The input as shown where an increment is: degrees or length.
   pure elemental real(wp) function input_at(mechanism, dimensions, increment)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: increment     !! from the reference position

      input_at = reference_input(mechanism, dimensions) + increment
      if (.not. (mechanism%sliding_input .or. mechanism%from_drawing)) input_at = within_turn(input_at)
   end function input_at

   !> An input of a full turn, in the turn that is shown.
   pure elemental real(wp) function input_in_turn(mechanism, input)
      type(mechanism_t), intent(in) :: mechanism
      real(wp), intent(in) :: input         !! as shown

      input_in_turn = input
      if (mechanism%sliding_input) return
      input_in_turn = mechanism%first_input + within_turn(input - mechanism%first_input)
   end function input_in_turn

   !> True if the crank's angle from the x axis is shown beside inputs that count from the drawing.
   pure logical function shows_crank(mechanism)
      type(mechanism_t), intent(in) :: mechanism

      shows_crank = mechanism%from_drawing .and. .not. (mechanism%sliding_input .or. mechanism%floating_input)
   end function shows_crank

   !> The crank's angle from the x axis where an increment is: degrees in a turn.
   pure elemental real(wp) function crank_angle_at(mechanism, dimensions, increment)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: increment     !! from the reference position

      crank_angle_at = within_turn(dimensions%crnki + mechanism%crank_turn + increment)
   end function crank_angle_at
end module psalm_shown_input
