!> How far things go while a linkage moves, proven: transmission angles, slides, the output point; and how large deviations of
!> the lengths may be.
!>
!> Extremes are found in the working precision; the places that may hold them are looked at again in quadruple precision.
module psalm_proof_ranges
   use psalm_kinds, only: wp
   use psalm_proof, only: proof_t, subject_t, rounded, piece_closes, piece_opens, cause_too_short, cause_link
   use psalm_proof_closure, only: piece_t, find_pieces
   use psalm_proof_extremes, only: place_t, greatest_t, find_greatest
   use psalm_proof_extremes_quad, only: fine_place_t => place_t, fine_greatest_t => greatest_t, find_fine_greatest => find_greatest
   use psalm_proof_groups, only: prepare_models
   use psalm_proof_quantity, only: quantity_t, quantity_measure, quantity_slide, quantity_point
   use psalm_quad, only: qp
   implicit none (type, external)
   private
   public :: extreme_t, prove_extremes, prove_tolerance
   public :: extreme_angle, extreme_slide, extreme_x, extreme_y

   integer, parameter :: extreme_angle = 1   !! transmission angle of a loop, degrees: between its links, or link and slide's normal
   integer, parameter :: extreme_slide = 2   !! a varying length
   integer, parameter :: extreme_x = 3       !! co-ordinates of the output point
   integer, parameter :: extreme_y = 4

   integer, parameter :: most_boxes = 4000, most_fine_boxes = 1000
   integer, parameter :: first_boxes = 8, most_halvings = 12
   real(qp), parameter :: degrees = 57.295779513082320876798154814105170332_qp !! of a radian

   !> Least and greatest value of a quantity over what closes, each bracketed.
   type :: extreme_t
      integer :: kind = 0                    !! one of `extreme_...`
      integer :: loop = 0                    !! of an angle or a slide
      integer :: arc = 0                     !! of a slide: sequential number
      integer :: place = 0                   !! of a slide: number in its loop
      real(wp) :: least_low = 0.0_wp, least_high = 0.0_wp, least_at = 0.0_wp
      real(wp) :: greatest_low = 0.0_wp, greatest_high = 0.0_wp, greatest_at = 0.0_wp
      logical :: found = .false.             !! the linkage closes somewhere
   end type extreme_t

contains

   !> All extremes over the range of a proof.
   subroutine prove_extremes(subject, proof, extremes, boxes)
      type(subject_t), intent(inout) :: subject          !! bound, of the same proof
      type(proof_t), intent(in) :: proof
      type(extreme_t), allocatable, intent(out) :: extremes(:)
      integer, intent(out) :: boxes(2)                   !! evaluated in working and in quadruple precision
      type(quantity_t), allocatable :: quantities(:)
      type(place_t), allocatable :: places(:)
      type(fine_place_t), allocatable :: fine(:)
      type(greatest_t), allocatable :: greatest(:)
      type(fine_greatest_t), allocatable :: fine_greatest(:)
      integer :: i

      call list_quantities(subject, extremes, quantities)
      boxes = 0
      if (size(extremes) == 0) return
      call list_places(proof, size(quantities), places)
      allocate (greatest(size(quantities)), fine_greatest(size(quantities)))
      call find_greatest(subject%plan, subject%numbers, quantities, most_boxes, subject%models, places, greatest, boxes(1))
      allocate (fine(size(places)))
      do i = 1, size(places)
         fine(i)%from = real(places(i)%from, qp)
         fine(i)%to = real(places(i)%to, qp)
         fine(i)%quantity = places(i)%quantity
         fine(i)%certain = places(i)%certain
      end do
      call find_fine_greatest(subject%plan, subject%fine_numbers, quantities, most_fine_boxes, subject%fine_models, fine, &
                              fine_greatest, boxes(2))
      do i = 1, size(extremes)
         call put_together(subject, quantities(2*i), fine_greatest(2*i - 1:2*i), real(greatest(2*i - 1:2*i)%low, qp), extremes(i))
      end do
   end subroutine prove_extremes

   !> What there is to be looked at: of each extreme the least value, then the greatest.
   subroutine list_quantities(subject, extremes, quantities)
      type(subject_t), intent(in) :: subject
      type(extreme_t), allocatable, intent(out) :: extremes(:)
      type(quantity_t), allocatable, intent(out) :: quantities(:)
      integer :: k, slot

      allocate (extremes(0), quantities(0))
      associate (plan => subject%plan)
         do k = 1, plan%nmeasures
            ! of two links the measure that grows with the angle between them, of link and slide likewise
            if (plan%cause_of(k) == cause_too_short) then
               call add(extreme_t(extreme_angle, plan%loop_of(k)), quantity_measure, k + 1)
            else if (plan%cause_of(k) == cause_link) then
               if (k == 1) then
                  call add(extreme_t(extreme_angle, plan%loop_of(k)), quantity_measure, k)
               else if (plan%loop_of(k - 1) /= plan%loop_of(k)) then
                  call add(extreme_t(extreme_angle, plan%loop_of(k)), quantity_measure, k)
               end if
            end if
         end do
         do k = 1, size(plan%steps)
            associate (step => plan%steps(k))
               if (.not. step%dyad) cycle
               slot = plan%slot(step%p)
               if (slot > 0) call add(extreme_t(extreme_slide, step%loop, step%p, step%places(1)), quantity_slide, slot)
               slot = plan%slot(step%q)
               if (slot > 0) call add(extreme_t(extreme_slide, step%loop, step%q, step%places(2)), quantity_slide, slot)
            end associate
         end do
      end associate
      if (size(subject%output_path) == 0) return
      call add(extreme_t(extreme_x), quantity_point, 1)
      call add(extreme_t(extreme_y), quantity_point, 2)

   contains

      subroutine add(extreme, kind, which)
         type(extreme_t), intent(in) :: extreme
         integer, intent(in) :: kind, which
         type(quantity_t) :: quantity

         quantity%kind = kind
         quantity%which = which
         if (kind == quantity_point) quantity%path = subject%output_path
         extremes = [extremes, extreme]
         quantity%sense = -1
         quantities = [quantities, quantity]
         quantity%sense = 1
         quantities = [quantities, quantity]
      end subroutine add
   end subroutine list_quantities

   !> The range of each quantity, in boxes: what closes, and what is undecided.
   pure subroutine list_places(proof, quantities, places)
      type(proof_t), intent(in) :: proof
      integer, intent(in) :: quantities
      type(place_t), allocatable, intent(out) :: places(:)
      type(place_t) :: place
      real(wp) :: step
      integer :: i, j, k, boxes

      allocate (places(0))
      do i = 1, size(proof%limits)
         associate (limit => proof%limits(i))
            if (limit%kind == piece_opens) cycle
            place%certain = limit%kind == piece_closes
            boxes = max(1, ceiling(real(first_boxes, wp)*(limit%to - limit%from)/(proof%to - proof%from)))
            step = (limit%to - limit%from)/real(boxes, wp)
            do j = 1, boxes
               place%from = limit%from + step*real(j - 1, wp)
               place%to = merge(limit%to, limit%from + step*real(j, wp), j == boxes)
               do k = 1, quantities
                  place%quantity = k
                  places = [places, place]
               end do
            end do
         end associate
      end do
   end subroutine list_places

   !> Brackets of one extreme in the user's unit.
   subroutine put_together(subject, quantity, greatest, known, extreme)
      type(subject_t), intent(in) :: subject
      type(quantity_t), intent(in) :: quantity
      type(fine_greatest_t), intent(in) :: greatest(2)   !! of the negative, of the quantity itself
      real(qp), intent(in) :: known(2)                   !! lower bounds of the working precision
      type(extreme_t), intent(inout) :: extreme
      real(qp) :: low(2), high(2)

      extreme%found = all(greatest%high > -0.001_qp*huge(1.0_wp)) .and. all(known > -0.001_qp*huge(1.0_wp))
      if (.not. extreme%found) return
      ! what was known before the second look is still true
      low = max(greatest%low, known)
      high = max(greatest%high, low)
      extreme%least_low = in_unit(-high(1), -1)
      extreme%least_high = in_unit(-low(1), 1)
      extreme%greatest_low = in_unit(low(2), -1)
      extreme%greatest_high = in_unit(high(2), 1)
      extreme%least_at = real(greatest(1)%at, wp)
      extreme%greatest_at = real(greatest(2)%at, wp)

   contains

      !> A value in degrees or the user's length, rounded down or up.
      real(wp) function in_unit(value, way)
         real(qp), intent(in) :: value
         integer, intent(in) :: way
         real(qp) :: sine, whole
         integer :: k

         if (extreme%kind /= extreme_angle) then
            in_unit = rounded(value/real(subject%numbers%scale, qp), way)
            return
         end if
         do k = 1, size(subject%plan%steps)
            associate (step => subject%plan%steps(k), length => subject%fine_numbers%length)
               if (.not. step%dyad .or. step%loop /= extreme%loop) cycle
               if (subject%plan%cause_of(quantity%which) == cause_link) then
                  whole = 2.0_qp*length(merge(step%q, step%p, subject%plan%slot(step%p) > 0))
               else
                  whole = 4.0_qp*length(step%p)*length(step%q)
               end if
            end associate
         end do
         ! the rounding of the library's function is far below that of the working precision
         sine = sqrt(min(max(value/whole, 0.0_qp), 1.0_qp))
         in_unit = rounded(2.0_qp*asin(sine)*degrees*(1.0_qp + real(way, qp)*1.0e-30_qp), way)
      end function in_unit
   end subroutine put_together

   !> How much all lengths may deviate, together, so that the linkage is still proven to close over the range.
   !>
   !> At most `largest`. Proven in the working precision.
   subroutine prove_tolerance(subject, from, to, largest, tolerance)
      type(subject_t), intent(inout) :: subject          !! bound
      real(wp), intent(in) :: from, to
      real(wp), intent(in) :: largest                    !! in the user's unit
      real(wp), intent(out) :: tolerance                 !! 0: not proven for any
      type(piece_t), allocatable :: pieces(:)
      real(wp) :: low, high, middle
      integer :: i, count

      low = 0.0_wp
      high = largest
      do i = 1, most_halvings
         middle = merge(high, 0.5_wp*(low + high), i == 1)
         call give_slack(middle*subject%numbers%scale)
         call find_pieces(subject%plan, subject%numbers, from, to, first_boxes, most_fine_boxes, subject%models, pieces, count)
         if (all(pieces%kind == piece_closes)) then
            low = middle
            if (i == 1) exit
         else
            high = middle
         end if
      end do
      call give_slack(0.0_wp)
      tolerance = low

   contains

      !> The frame's arcs are formed anew.
      subroutine give_slack(slack)
         real(wp), intent(in) :: slack

         subject%numbers%length_slack = slack
         call prepare_models(subject%plan, subject%numbers, subject%models)
      end subroutine give_slack
   end subroutine prove_tolerance
end module psalm_proof_ranges
