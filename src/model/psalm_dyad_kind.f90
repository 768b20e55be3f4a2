!> Kinds of dyads, the Assur groups of two arcs p, q with p + q = h, where h = E - S joins the outer joints.
!>
!> The kinds are named by their three joints in the order S, common joint, E: R revolute, P prismatic. A dyad finds two
!> unknowns, directions or lengths. Source of the kinds and their numbers: Oldham (1977), chapters 4 and 5.
module psalm_dyad_kind
   implicit none (type, external)
   private
   public :: form_t, form_of, kind_of_dyad, sign_of_dyad
   public :: assur_none, assur_rrr, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_prr, assur_rpp, assur_ppr, assur_prp
   public :: assur_higher
   public :: direction_found, direction_known, direction_of_partner

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

   integer, parameter :: assur_higher = 9           !! a group of more links than two, or of arcs of any direction: no dyad

   integer, parameter :: direction_found = 1      !! the dyad finds the arc's direction
   integer, parameter :: direction_known = 2      !! it is known before: that of another arc, turned by a right angle
   integer, parameter :: direction_of_partner = 3 !! that of the other arc of the dyad, turned by a right angle

   !> What is the same for all dyads of a kind.
   type :: form_t
      logical :: slides(2) = .false.      !! p, q: its length varies
      integer :: direction(2) = direction_found !! p, q: where its direction comes from
      integer :: power = 0                !! of the unit of length in the unit of the closure measure
      logical :: by_root = .true.         !! the sine of the transmission angle comes out of a square root
      integer :: ways = 2                 !! in how many ways it may fail to close: above or below limits of its closure measure
   end type form_t

   type(form_t), parameter :: forms(0:9) = [ &
      form_t(ways=0), &
      form_t([.false., .false.], [direction_found, direction_found], 2), &
      form_t([.true., .false.], [direction_found, direction_of_partner], 2), &
      form_t([.false., .true.], [direction_found, direction_of_partner], 2), &
      form_t([.false., .true.], [direction_found, direction_known], 1), &
      form_t([.true., .false.], [direction_known, direction_found], 1), &
      form_t([.true., .true.], [direction_of_partner, direction_known], 0, .false., 0), &
      form_t([.true., .true.], [direction_known, direction_of_partner], 0, .false., 0), &
      form_t([.true., .true.], [direction_known, direction_known], 0, .false., 1), &
      form_t(ways=1)]

contains

   !> What a kind of dyad is like.
   pure type(form_t) function form_of(kind)
      integer, intent(in) :: kind  !! one of `assur_...`

      form_of = forms(kind)
   end function form_of

   !> Kind of a dyad from what slides and what guides what; `assur_none` if two slides guide each other.
   pure integer function kind_of_dyad(slides, guided_by_partner) result(kind)
      logical, intent(in) :: slides(2)             !! p, q: its length varies
      logical, intent(in) :: guided_by_partner(2)  !! p, q: the other arc of the dyad guides it

      if (.not. any(slides)) then
         kind = assur_rrr
      else if (slides(1) .and. .not. slides(2)) then
         kind = merge(assur_rpr, assur_prr, guided_by_partner(1))
      else if (slides(2) .and. .not. slides(1)) then
         kind = merge(assur_rpr_guide_first, assur_rrp, guided_by_partner(2))
      else if (all(guided_by_partner)) then
         kind = assur_none
      else if (guided_by_partner(1)) then
         kind = assur_rpp
      else if (guided_by_partner(2)) then
         kind = assur_ppr
      else
         kind = assur_prp
      end if
   end function kind_of_dyad

   !> Assembly mode, +1 or -1, from the signs of both arcs and, for a slide, the sense of the right angle to its guide.
   pure integer function sign_of_dyad(kind, sign_p, sign_q, turn_p, turn_q)
      integer, intent(in) :: kind
      integer, intent(in) :: sign_p, sign_q        !! of ILINK
      integer, intent(in) :: turn_p, turn_q        !! +1 if the slide is anticlockwise from its guide

      select case (kind)
      case (assur_rrr, assur_rrp)
         sign_of_dyad = sign_p
      case (assur_rpr)
         sign_of_dyad = -turn_p
      case (assur_rpr_guide_first)
         sign_of_dyad = turn_q
      case (assur_prr)
         sign_of_dyad = sign_q
      case default
         sign_of_dyad = 1
      end select
   end function sign_of_dyad
end module psalm_dyad_kind
