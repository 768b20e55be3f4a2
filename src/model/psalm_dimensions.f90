!> The dimensions of a linkage: the numbers that may vary while its topology stays.
module psalm_dimensions
   use psalm_kinds, only: wp
   use psalm_place, only: beside_t
   implicit none (type, external)
   private
   public :: dimensions_t

   !> One linkage of a given topology. Lengths in the user's unit, angles in degrees.
   type :: dimensions_t
      real(wp), allocatable :: arcl(:), gama(:)  !! by arc: length, and angle from the arc it hangs on; of an unknown arc of a
                                                 !! larger group length and direction at `anchor`
      real(wp) :: outlk = 0.0_wp, outang = 0.0_wp
      real(wp) :: origlk = 0.0_wp, origng = 0.0_wp
      real(wp) :: crnki = 0.0_wp
      real(wp) :: drawn = 0.0_wp                 !! CRNKI in the drawing
      real(wp) :: anchor = 0.0_wp                !! CRNKI at which unknown arcs of larger groups are as given
      real(wp), allocatable :: aside_length(:), aside_angle(:) !! by joint of a sketch: of one that is no end of an arc the distance
                                                 !! from the end of an arc, and the angle of that line from the arc
   contains
      procedure :: put_aside
   end type dimensions_t

contains

   !> Lines to joints of a sketch off the arcs, as these dimensions have them.
   elemental subroutine put_aside(self, beside)
      class(dimensions_t), intent(in) :: self
      type(beside_t), intent(inout) :: beside

      if (.not. allocated(self%aside_length) .or. beside%joint == 0 .or. beside%arc == 0) return
      beside%distance = self%aside_length(beside%joint)
      beside%angle = self%aside_angle(beside%joint)
   end subroutine put_aside
end module psalm_dimensions
