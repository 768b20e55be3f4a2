!> A dyad, the Assur group of two arcs p, q with p + q = h, where h = E - S joins its outer joints; and what its kinds are.
!>
!> The kinds are named by their three joints in the order S, common joint, E: R revolute, P prismatic. A dyad finds two
!> unknowns, directions or lengths, and has one closure measure, a number a position that says whether it can be assembled:
!> the squared distance of the outer joints (RRR, RPR), the offset of the outer joint from the slide's line (RRP), the sine
!> of the angle between the slides (PRP). Source of the kinds and their numbers: Oldham (1977), chapters 4 and 5.
module psalm_dyad
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: dyad_t, breach_t, form_of, form_t
   public :: assur_none, assur_rrr, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_prr, assur_rpp, assur_ppr, assur_prp
   public :: direction_found, direction_known, direction_of_partner
   public :: violation_none, violation_too_short, violation_too_long, violation_parallel, violation_angle_small, &
             violation_angle_large, violation_undetermined

   ! the numbers are those of JOINT in the thesis, as device 8 prints them
   integer, parameter :: assur_none = 0
   integer, parameter :: assur_rrr = 1              !! link p, link q
   integer, parameter :: assur_rpr = 2              !! slide p, guided by q at right angles to it
   integer, parameter :: assur_rpr_guide_first = 3  !! slide q, guided by p at right angles to it
   integer, parameter :: assur_rrp = 4              !! link p, slide q along a known direction
   integer, parameter :: assur_prr = 5              !! slide p along a known direction, link q
   integer, parameter :: assur_rpp = 6              !! slide p at right angles to slide q, which has a known direction
   integer, parameter :: assur_ppr = 7              !! slide q at right angles to slide p, which has a known direction
   integer, parameter :: assur_prp = 8              !! two slides along known directions

   integer, parameter :: direction_found = 1      !! the dyad finds the arc's direction
   integer, parameter :: direction_known = 2      !! it is known before: that of another arc, turned by a right angle
   integer, parameter :: direction_of_partner = 3 !! that of the other arc of the dyad, turned by a right angle

   integer, parameter :: violation_none = 0
   integer, parameter :: violation_too_short = 1    !! the dyad does not reach
   integer, parameter :: violation_too_long = 2     !! the difference of the links, or the guide, is too great
   integer, parameter :: violation_parallel = 3     !! two slides are parallel
   integer, parameter :: violation_angle_small = 4  !! closes, but the transmission angle is too small
   integer, parameter :: violation_angle_large = 5  !! closes, but the transmission angle is too large
   integer, parameter :: violation_undetermined = 6 !! the outer joints coincide: no direction is determined

   !> What is the same for all dyads of a kind.
   type :: form_t
      logical :: slides(2) = .false.      !! p, q: its length varies
      integer :: direction(2) = direction_found !! p, q: where its direction comes from
      integer :: power = 0                !! of the unit of length in the unit of the closure measure
      logical :: by_root = .true.         !! the sine of the transmission angle comes out of a square root
      logical :: may_fail = .true.        !! there are inputs at which the dyad cannot be assembled
   end type form_t

   type(form_t), parameter :: forms(0:8) = [ &
      form_t(may_fail=.false.), &
      form_t([.false., .false.], [direction_found, direction_found], 2), &
      form_t([.true., .false.], [direction_found, direction_of_partner], 2), &
      form_t([.false., .true.], [direction_found, direction_of_partner], 2), &
      form_t([.false., .true.], [direction_found, direction_known], 1), &
      form_t([.true., .false.], [direction_known, direction_found], 1), &
      form_t([.true., .true.], [direction_of_partner, direction_known], 0, .false., .false.), &
      form_t([.true., .true.], [direction_known, direction_of_partner], 0, .false., .false.), &
      form_t([.true., .true.], [direction_known, direction_known], 0, .false.)]

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
      real(wp) :: p = 0.0_wp, q = 0.0_wp            !! lengths
      real(wp) :: sign = 1.0_wp                     !! assembly mode
      real(wp) :: px = 1.0_wp, py = 0.0_wp          !! cosine, sine of the fixed angle from the unit vector to p
      real(wp) :: qx = 1.0_wp, qy = 0.0_wp          !! likewise q
      real(wp) :: closes_low = 0.0_wp, closes_high = 0.0_wp   !! limits of the measure: the dyad can be assembled
      real(wp) :: accepts_low = 0.0_wp, accepts_high = 0.0_wp !! and its transmission angle is within its limits
   end type dyad_t

   !> How a dyad fails at one position.
   type :: breach_t
      integer :: kind = violation_none
      real(wp) :: amount = 0.0_wp   !! length missing, or the transmission angle, degrees
      logical :: is_length = .false.
   end type breach_t

contains

   !> What a kind of dyad is like.
   pure type(form_t) function form_of(kind)
      integer, intent(in) :: kind  !! one of `assur_...`

      form_of = forms(kind)
   end function form_of
end module psalm_dyad
