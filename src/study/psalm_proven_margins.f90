!> How far a linkage is proven to stay inside the limits of its dyads, over a range in which it closes.
!>
!> Brackets of the least margins follow from brackets of the extremes; what is computed here is rounded outwards.
module psalm_proven_margins
   use psalm_angles, only: unit_vector
   use psalm_dimensions, only: dimensions_t
   use psalm_dyad_kind, only: assur_prp, assur_prr, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_rrr
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, right_angle
   use psalm_margins, only: margin_t, margin_angle, margin_guide, margin_offset, margin_slides, rounding, parallel
   use psalm_proof_ranges, only: proven_extreme_t, extreme_angle, extreme_slide, extreme_slides
   implicit none (type, external)
   private
   public :: proven_margin_t, prove_margins

   real(wp), parameter :: slack = 32.0_wp*epsilon(1.0_wp) !! covers what is rounded here, of the largest number involved
   real(wp), parameter :: straight = 180.0_wp

   !> Bracket of the least margin of a dyad.
   type :: proven_margin_t
      type(margin_t) :: margin = margin_t()  !! kind and loop; the margin is not above `high`, at the input `delt`
      real(wp) :: low = 0.0_wp, high = 0.0_wp !! degrees or length
      logical :: is_broken = .false.         !! proven: violated
   end type proven_margin_t

contains

   !> Margins of every dyad that the output or a clearance hangs on, as `inspect` has them.
   pure function prove_margins(problem, dimensions, needed, tangle, toggle, extremes) result(margins)
      type(problem_t), intent(in) :: problem        !! bound to the dimensions
      logical, intent(in) :: needed(:)              !! shape (nloop): which dyads are wanted
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: tangle                !! TANGLE, degrees
      real(wp), intent(in) :: toggle                !! TOGGLE where it is a constraint, else 0
      type(proven_extreme_t), intent(in) :: extremes(:)    !! of a linkage that closes everywhere
      type(proven_margin_t), allocatable :: margins(:)
      type(proven_margin_t) :: own
      real(wp) :: size, guide, link
      integer :: i

      allocate (margins(0))
      size = maxval(dimensions%arcl)
      do i = 1, ubound(extremes, 1)
         associate (extreme => extremes(i))
            if (.not. extreme%found .or. extreme%loop == 0) cycle
            if (.not. needed(extreme%loop)) cycle
            own = proven_margin_t()
            own%margin%which = extreme%loop
            own%margin%unit = 1.0_wp
            associate (group => problem%mechanism%groups(extreme%loop))
               select case (group%kind)
               case (assur_rrr)
                  own%margin%kind = margin_angle
                  call of_deviation(extreme, tangle, own)
               case (assur_prp)
                  if (extreme%kind /= extreme_slides) cycle
                  own%margin%kind = margin_slides
                  own%low = extreme%least_low + problem%slide_angle - right_angle - slack*right_angle
                  own%high = extreme%least_high + problem%slide_angle - right_angle + slack*right_angle
                  own%margin%delt = extreme%least_at
               case (assur_rpr, assur_rpr_guide_first)
                  guide = abs(dimensions%arcl(group%members(merge(2, 1, group%kind == assur_rpr))))
                  if (extreme%kind /= extreme_slide .or. guide + toggle <= 0.0_wp) cycle
                  own%margin%kind = margin_guide
                  own%margin%unit = size
                  own%low = beyond_guide(max(extreme%least_low, 0.0_wp), guide)
                  own%high = beyond_guide(extreme%least_high, guide)
                  call widen(own, max(guide, extreme%least_high) + toggle)
                  own%margin%delt = extreme%least_at
               case (assur_rrp, assur_prr)
                  if (extreme%kind /= extreme_angle) cycle
                  link = abs(dimensions%arcl(group%members(merge(1, 2, group%kind == assur_rrp))))
                  own%margin%kind = margin_offset
                  own%margin%unit = size
                  call of_deviation(extreme, right_angle, own)
                  own%low = beyond_offset(own%low, link)
                  own%high = beyond_offset(own%high, link)
                  call widen(own, link + toggle)
               case default
                  cycle
               end select
            end associate
         end associate
         own%margin%margin = own%high
         own%margin%least_allowed = -rounding*own%margin%unit
         if (own%margin%kind == margin_slides .and. problem%slide_angle >= right_angle) own%margin%least_allowed = parallel
         own%is_broken = own%high < own%margin%least_allowed
         margins = [margins, own]
      end do

   contains

      !> Link and guide: the joint's distance from the pivot of the slide, less the guide and TOGGLE.
      pure real(wp) function beyond_guide(slide, guide) result(margin)
         real(wp), intent(in) :: slide, guide

         margin = 0.0_wp
         if (slide > 0.0_wp) margin = slide*(slide/(guide + sqrt(slide*slide + guide*guide)))
         margin = margin - toggle
      end function beyond_guide

      !> Link and slide: the link less the offset and TOGGLE, `angle` degrees from the dead point.
      pure real(wp) function beyond_offset(angle, link) result(margin)
         real(wp), intent(in) :: angle, link
         real(wp) :: c, s

         call unit_vector(0.5_wp*max(angle, 0.0_wp), c, s)
         margin = 2.0_wp*link*s*s - toggle
      end function beyond_offset
   end function prove_margins

   !> Degrees that an angle stays within `allowed` of 90.
   pure subroutine of_deviation(extreme, allowed, own)
      type(proven_extreme_t), intent(in) :: extreme
      real(wp), intent(in) :: allowed
      type(proven_margin_t), intent(inout) :: own
      real(wp) :: below(2), above(2), rest

      rest = right_angle - allowed
      below = [extreme%least_low, extreme%least_high] - rest
      above = [straight - extreme%greatest_high, straight - extreme%greatest_low] - rest
      own%low = min(below(1), above(1))
      own%high = min(below(2), above(2))
      own%margin%delt = merge(extreme%least_at, extreme%greatest_at, below(2) <= above(2))
      if (rest > 0.0_wp) call widen(own, straight)
   end subroutine of_deviation

   pure subroutine widen(own, size)
      type(proven_margin_t), intent(inout) :: own
      real(wp), intent(in) :: size

      own%low = own%low - slack*size
      own%high = own%high + slack*size
   end subroutine widen
end module psalm_proven_margins
