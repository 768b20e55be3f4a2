!> How many linkages are evaluated side by side.
module psalm_lanes
   implicit none (type, external)
   private
   public :: lanes

   integer, parameter :: lanes = 8   !! numbers of real64 in a vector of 512 bits, a line of the cache
end module psalm_lanes
