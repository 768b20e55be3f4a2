!> A larger group with its numbers: its unknowns, and the rings of arcs that close it.
!>
!> `psalm_higher_group` solves it. Lengths are scaled as those of the linkage.
module psalm_group_rings
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: higher_t

   !> An arc of a ring, from the point at which the ring leaves what is known to that at which it comes back.
   type :: term_t
      integer :: ring = 0
      integer :: arc = 0                            !! sequential number
      integer :: root_x = 0, root_y = 0             !! rows of the unit vector it is turned from
      integer :: slide = 0                          !! row of a length that varies, 0: fixed
      integer :: turned = 0                         !! the unknown that is the direction of that unit vector, 0: it is known
      integer :: stretched = 0                      !! the unknown that is its length, 0: none
      real(wp) :: x = 1.0_wp, y = 0.0_wp            !! direction of the arc in the axes of that unit vector
      real(wp) :: length = 0.0_wp                   !! where it is fixed
   end type term_t

   !> A group of `unknowns` directions and lengths, closed by half as many rings.
   type :: higher_t
      integer :: unknowns = 0, rings = 0
      integer, allocatable :: arc(:)                !! shape (unknowns): the arcs they belong to
      integer, allocatable :: row(:)                !! shape (unknowns): row of a direction's cosine, or of a length
      integer, allocatable :: row_of_sine(:)        !! shape (unknowns): row of its sine; 0: a length
      integer, allocatable :: ends(:, :)            !! shape (4, rings): rows of x and y of the points a ring leads from and to
      type(term_t), allocatable :: terms(:)
      real(wp), allocatable :: drawn(:, :)          !! shape (2, unknowns): in the drawing, cosine and sine, or length and 0
      real(wp) :: size = 1.0_wp                     !! of the group: an angle of a radian counts as such a length
      ! while it is followed from input to input
      real(wp), allocatable :: now(:, :), before(:, :) !! shape (2, unknowns): where it stands, and where it stood before
      real(wp) :: sense = 0.0_wp                    !! sign of the determinant in the drawing
   end type higher_t
end module psalm_group_rings
