!> A dyad with its numbers, and how it can fail.
!>
!> It has one closure measure, a number a position that says whether it can be assembled: the squared distance of the outer
!> joints (RRR, RPR), the offset of the outer joint from the slide's line (RRP, PRR), the sine of the angle between the slides
!> (PRP). A larger group is kept here too, with its rings in place of p and q.
module psalm_dyad
   use psalm_dyad_kind, only: assur_none
   use psalm_group_rings, only: higher_t
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: dyad_t, tip_t, dyad_violation_t
   public :: violation_none, violation_too_short, violation_too_long, violation_parallel, violation_angle_small, &
             violation_angle_large, violation_undetermined, violation_slides, violation_toggle, &
             violation_group
   public :: least_square, no_distance, rounding

   integer, parameter :: violation_none = 0
   integer, parameter :: violation_too_short = 1    !! the dyad does not reach
   integer, parameter :: violation_too_long = 2     !! the difference of the links, or the guide, is too great
   integer, parameter :: violation_parallel = 3     !! two slides are parallel
   integer, parameter :: violation_angle_small = 4  !! closes, but the transmission angle is too small
   integer, parameter :: violation_angle_large = 5  !! closes, but the transmission angle is too large
   integer, parameter :: violation_undetermined = 6 !! the outer joints coincide: no direction is determined
   integer, parameter :: violation_slides = 7       !! closes, but the angle between the slides is too small
   integer, parameter :: violation_toggle = 8       !! closes, but with less length to spare than TOGGLE asks
   integer, parameter :: violation_group = 9        !! a larger group cannot follow from the drawing

   real(wp), parameter :: least_square = tiny(1.0_wp)**0.8_wp    !! guards a division; such a dyad is reported as open
   real(wp), parameter :: no_distance = 1.0e3_wp*epsilon(1.0_wp) !! of the links: outer joints so near each other coincide
   real(wp), parameter :: rounding = 64.0_wp*epsilon(1.0_wp)     !! relative width of a limit of closure

   !> A point at the end of an arc that hangs on the direction a dyad finds: made in the same pass, while the dyad divides.
   type :: tip_t
      integer :: from_x = 0, from_y = 0             !! rows of the point to start from
      integer :: to_x = 0, to_y = 0                 !! rows of the point made; 0: none
      real(wp) :: x = 0.0_wp, y = 0.0_wp            !! the arc in the axes of the direction found, sense included
   end type tip_t

   !> One dyad with its numbers. Components that begin with a row say where its quantities stand in the store.
   type :: dyad_t
      integer :: kind = assur_none
      integer :: s_x = 0, s_y = 0, e_x = 0, e_y = 0 !! rows of the outer joints
      integer :: p_x = 0, p_y = 0, q_x = 0, q_y = 0 !! rows of the unit vectors that p and q are turned from, found or known
      integer :: slide_p = 0, slide_q = 0           !! rows of lengths that vary, 0: fixed
      integer :: measure = 0                        !! row of the closure measure
      integer :: unknown(2) = 0                     !! rows of what it finds; an angle stands at the row of its cosine
      integer :: arc_p = 0, arc_q = 0               !! sequential numbers of its arcs
      logical :: wants_p = .true., wants_q = .true. !! something hangs on the direction found
      type(tip_t) :: tip = tip_t()                  !! point to be made with the one direction found
      real(wp) :: p = 0.0_wp, q = 0.0_wp            !! lengths
      real(wp) :: sign = 1.0_wp                     !! assembly mode
      real(wp) :: px = 1.0_wp, py = 0.0_wp          !! cosine, sine of the fixed angle from the unit vector to p
      real(wp) :: qx = 1.0_wp, qy = 0.0_wp          !! likewise q
      real(wp) :: closes_low = 0.0_wp, closes_high = 0.0_wp   !! limits of the measure (of two slides: of its amount): the dyad
                                                              !! can be assembled
      real(wp) :: accepts_low = 0.0_wp, accepts_high = 0.0_wp !! and is inside TANGLE or TOGGLE
      type(higher_t), allocatable :: higher         !! of a larger group, which has neither p nor q
   end type dyad_t

   !> How a dyad fails at one position.
   type :: dyad_violation_t
      integer :: kind = violation_none
      real(wp) :: amount = 0.0_wp   !! length missing, or the transmission angle, degrees
      logical :: is_length = .false.      !! the amount is a length, scaled as those of the dyad
   end type dyad_violation_t
end module psalm_dyad
