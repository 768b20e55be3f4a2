!> The dimensions of a linkage: the numbers that may vary while its topology stays.
module psalm_dimensions
   use psalm_kinds, only: wp
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
   end type dimensions_t
end module psalm_dimensions
