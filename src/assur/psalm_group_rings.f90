!> A larger group with its numbers: its unknowns, and the rings of arcs that close it.
!>
!> `psalm_higher_group` solves it. Lengths are scaled as those of the linkage.
module psalm_group_rings
   use psalm_kinds, only: wp
   use psalm_wheel_kernels, only: ratio_series_t
   implicit none (type, external)
   private
   public :: higher_t, known_turn_t

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

   !> Turns of links, radians since the drawing, that depend on each other: the sum of `factors` times those in `rows` is the
   !> drive's.
   type :: turn_tie_t
      real(wp) :: factors(3) = 0.0_wp
      integer :: rows(3) = 0                        !! rows of the turns, 0: none
      integer :: roots(3) = 0                       !! rows of the cosines of these directions, where their changes stand
      integer :: unknown(3) = 0                     !! the unknown that it is, 0: it is known
      integer :: drive = 0                          !! row of the drive's turn, 0: none
      integer :: drive_root = 0                     !! where its changes stand
   end type turn_tie_t

   !> A direction known before the group whose turn a tie needs.
   type :: known_turn_t
      integer :: row = 0                            !! of the turn
      integer :: root_x = 0, root_y = 0             !! of the direction
      integer :: arc = 0                            !! an arc that is turned from it,
      real(wp) :: drawn_angle = 0.0_wp              !! and where that points in the drawing, degrees
      real(wp) :: drawn(2) = 0.0_wp                 !! the direction in the drawing
      real(wp) :: now(3) = 0.0_wp                   !! direction and turn where the group stands,
      real(wp) :: from(3) = 0.0_wp                  !! and where it is followed from, if that is not the drawing
      real(wp) :: drawn_turn = 0.0_wp               !! ties alone: the direction in the drawing, degrees
      real(wp) :: angle = 0.0_wp, turn = 0.0_wp     !! at the last position found of ties alone: of the direction, and from the
                                                    !! drawing, degrees
   end type known_turn_t

   !> A group of `unknowns` directions and lengths: two equations a ring, one a tie. Where there are more of them than unknowns,
   !> special lengths must fulfil them all.
   type :: higher_t
      integer :: unknowns = 0, rings = 0
      integer :: equations = 0                      !! as many as unknowns; of links that brace each other (KOVER) more
      integer, allocatable :: arc(:)                !! shape (unknowns): the arcs they belong to
      integer, allocatable :: row(:)                !! shape (unknowns): row of a direction's cosine, or of a length
      integer, allocatable :: row_of_sine(:)        !! shape (unknowns): row of its sine; 0: a length
      integer, allocatable :: row_of_turn(:)        !! shape (unknowns): row of its turn, 0: no tie needs it
      type(turn_tie_t), allocatable :: ties(:)
      type(known_turn_t), allocatable :: known(:)
      ! ties alone that tell the turns of all unknowns; else not allocated
      real(wp), allocatable :: by_known(:, :)       !! shape (unknowns, known): times a known turn that each of them takes
      real(wp), allocatable :: by_tie(:, :)         !! shape (unknowns, ties): times the drive of a tie
      type(ratio_series_t), allocatable :: series(:, :) !! shape (unknowns, known): of these times, if no drive takes part
      integer, allocatable :: powers(:, :)          !! shape (unknowns, known): these times, if they are whole: no turn needs to be
                                                    !! known then; else not allocated
      real(wp) :: tie_measure = 0.0_wp              !! closure measure: that of their matrix
      real(wp), allocatable :: drawn_angle(:)       !! shape (unknowns): direction in the drawing, degrees; lengths: 0
      integer, allocatable :: ends(:, :)            !! shape (4, rings): rows of x and y of the points a ring leads from and to
      type(term_t), allocatable :: terms(:)
      real(wp), allocatable :: drawn(:, :)          !! shape (3, unknowns): in the drawing, cosine, sine and turn, or length and 0
      real(wp) :: size = 1.0_wp                     !! of the group: an angle of a radian counts as such a length
      ! while it is followed from input to input
      real(wp), allocatable :: now(:, :), before(:, :) !! shape (3, unknowns): where it stands, and where it stood before
      real(wp), allocatable :: from(:, :)           !! shape as `now`: where it is followed from, if that is not the drawing
      real(wp) :: sense = 0.0_wp                    !! sign of the determinant in the drawing
      logical :: follows = .false.                  !! ties alone: they were found up to this input, with these dimensions
      real(wp) :: last = 0.0_wp                     !! increment of the input there
   end type higher_t
end module psalm_group_rings
