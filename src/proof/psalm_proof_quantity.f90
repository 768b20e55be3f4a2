!> Quantities of a motion whose extremes are proven.
module psalm_proof_quantity
   implicit none (type, external)
   private
   public :: quantity_t, quantity_measure, quantity_slide, quantity_point

   integer, parameter :: quantity_measure = 1  !! a closure measure
   integer, parameter :: quantity_slide = 2    !! a varying length
   integer, parameter :: quantity_point = 3    !! a coordinate of a point from the input pivot

   type :: quantity_t
      integer :: kind = 0                      !! one of `quantity_...`
      integer :: which = 0                     !! measure, or varying length; of a point 1 for x, 2 for y
      integer :: sense = 1                     !! +1: greatest value, -1: the negative of the least
      integer, allocatable :: path(:)          !! of a point: the steps to it
   end type quantity_t
end module psalm_proof_quantity
