!> How far things go while a linkage moves, proven: transmission angles, slides, the output point; and how large deviations of
!> the lengths may be.
!>
!> Extremes are found in the working precision; places whose brackets would show in what is printed are looked at again in
!> quadruple precision.
module psalm_proof_ranges
   use psalm_angles, only: degrees_of
   use psalm_kinds, only: wp, right_angle
   use psalm_proof, only: proof_t, proof_linkage_t, rounded, piece_closes, piece_opens, cause_too_short, cause_link, &
                          cause_parallel
   use psalm_proof_extremes, only: place_t, greatest_t, find_greatest
   use psalm_proof_extremes_quad, only: fine_place_t => place_t, fine_greatest_t => greatest_t, find_fine_greatest => find_greatest
   use psalm_proof_groups, only: prepare_models
   use psalm_proof_plan, only: least_sine
   use psalm_proof_quantity, only: quantity_t, quantity_measure, quantity_slide, quantity_point
   use psalm_quad, only: qp, arc_sine_quad, sqrt
   implicit none (type, external)
   private
   public :: proven_extreme_t, prove_extremes, prove_tolerance, list_places
   public :: extreme_angle, extreme_slide, extreme_x, extreme_y, extreme_output, extreme_distance, extreme_ratio, &
             extreme_slides

   integer, parameter :: extreme_angle = 1   !! transmission angle of a loop, degrees: between its links, or link and slide's normal
   integer, parameter :: extreme_slide = 2   !! a varying length
   integer, parameter :: extreme_x = 3       !! coordinates of the output point
   integer, parameter :: extreme_y = 4
   integer, parameter :: extreme_output = 5  !! angle of the output; one that swings through 360 goes on beyond it
   integer, parameter :: extreme_distance = 6 !! of the output point from the origin
   integer, parameter :: extreme_ratio = 7   !! velocity ratio: rate of the output by the input, radians or lengths
   integer, parameter :: extreme_slides = 8  !! angle between two slides, 0 to 90 degrees

   integer, parameter :: most_boxes = 4000, most_fine_boxes = 1000
   integer, parameter :: first_boxes = 8, most_halvings = 12
   real(wp), parameter :: enough = 1.0e-13_wp  !! width of a bracket, of 1 or the value in the longest arc
   real(wp), parameter :: narrow = 1.0e-9_wp   !! a bracket narrower than this does not show
   real(wp), parameter :: straight = 180.0_wp
   real(qp), parameter :: of_arc_sine = 1.0e-30_qp !! relative error of the arc sine, generously

   !> Least and greatest value of a quantity over what closes, each bracketed.
   type :: proven_extreme_t
      integer :: kind = 0                    !! one of `extreme_...`
      integer :: loop = 0                    !! of an angle or a slide
      integer :: arc = 0                     !! of a slide: sequential number
      integer :: place = 0                   !! of a slide: number in its loop
      real(wp) :: least_low = 0.0_wp, least_high = 0.0_wp, least_at = 0.0_wp
      real(wp) :: greatest_low = 0.0_wp, greatest_high = 0.0_wp, greatest_at = 0.0_wp
      logical :: found = .false.             !! the linkage closes somewhere
   end type proven_extreme_t

contains

   !> All extremes over the range of a proof.
   subroutine prove_extremes(linkage, proof, extremes, boxes)
      type(proof_linkage_t), intent(inout) :: linkage          !! bound, of the same proof
      type(proof_t), intent(in) :: proof
      type(proven_extreme_t), allocatable, intent(out) :: extremes(:)
      integer, intent(out) :: boxes(2)                   !! evaluated in working and in quadruple precision
      type(quantity_t), allocatable :: quantities(:)
      type(place_t), allocatable :: places(:)
      type(greatest_t), allocatable :: greatest(:)
      integer :: i

      call list_quantities(linkage, extremes, quantities)
      boxes = 0
      if (size(extremes) == 0) return
      call list_places(proof, places)
      allocate (greatest(size(quantities)))
      call find_greatest(linkage%plan, linkage%numbers, quantities, enough, most_boxes, linkage%models, places, greatest, boxes(1))
      do i = 1, size(extremes)
         call put_together(linkage, quantities(2*i), greatest(2*i - 1:2*i), extremes(i))
      end do
      if (any(is_wide(extremes))) call look_again(linkage, quantities, places, greatest, extremes, boxes(2))
   end subroutine prove_extremes

   !> True for brackets that show in the digits printed.
   elemental logical function is_wide(extreme)
      type(proven_extreme_t), intent(in) :: extreme

      is_wide = extreme%found .and. (wide(extreme%least_low, extreme%least_high) .or. &
                                     wide(extreme%greatest_low, extreme%greatest_high))

   contains

      pure logical function wide(low, high)
         real(wp), intent(in) :: low, high

         wide = high - low > narrow*max(abs(low), abs(high), 1.0_wp)
      end function wide
   end function is_wide

   !> Look in quadruple precision at the places that hold extremes whose brackets are wide.
   subroutine look_again(linkage, quantities, places, greatest, extremes, boxes)
      type(proof_linkage_t), intent(inout) :: linkage
      type(quantity_t), intent(in) :: quantities(:)
      type(place_t), intent(in) :: places(:)             !! what may hold them
      type(greatest_t), intent(in) :: greatest(:)
      type(proven_extreme_t), intent(inout) :: extremes(:)
      integer, intent(out) :: boxes
      type(fine_place_t), allocatable :: fine(:)
      type(fine_greatest_t) :: fine_greatest(size(quantities))
      integer :: i, n

      allocate (fine(size(places)))
      n = 0
      do i = 1, size(places)
         if (.not. is_wide(extremes((places(i)%quantity + 1)/2))) cycle
         n = n + 1
         fine(n)%from = real(places(i)%from, qp)
         fine(n)%to = real(places(i)%to, qp)
         fine(n)%quantity = places(i)%quantity
         fine(n)%certain = places(i)%certain
      end do
      fine = fine(:n)
      call find_fine_greatest(linkage%plan, linkage%fine_numbers, quantities, real(enough, qp), most_fine_boxes, &
                              linkage%fine_models, fine, fine_greatest, boxes)
      do i = 1, size(extremes)
         if (is_wide(extremes(i))) call put_fine_together(linkage, quantities(2*i), fine_greatest(2*i - 1:2*i), &
                                                          real(greatest(2*i - 1:2*i)%low, qp), extremes(i))
      end do
   end subroutine look_again

   !> What there is to be looked at: of each extreme the least value, then the greatest.
   subroutine list_quantities(linkage, extremes, quantities)
      type(proof_linkage_t), intent(in) :: linkage
      type(proven_extreme_t), allocatable, intent(out) :: extremes(:)
      type(quantity_t), allocatable, intent(out) :: quantities(:)
      type(proven_extreme_t) :: list(linkage%plan%nmeasures + 2*size(linkage%plan%steps) + 2)
      integer :: kinds(size(list)), which(size(list)), k, n, slot

      n = 0
      associate (plan => linkage%plan)
         do k = 1, plan%nmeasures
            ! of two links the measure that grows with the angle between them, of link and slide likewise
            if (plan%cause_of(k) == cause_too_short) then
               call add(proven_extreme_t(extreme_angle, plan%loop_of(k)), quantity_measure, k + 1)
            else if (plan%cause_of(k) == cause_link) then
               if (k == 1) then
                  call add(proven_extreme_t(extreme_angle, plan%loop_of(k)), quantity_measure, k)
               else if (plan%loop_of(k - 1) /= plan%loop_of(k)) then
                  call add(proven_extreme_t(extreme_angle, plan%loop_of(k)), quantity_measure, k)
               end if
            else if (plan%cause_of(k) == cause_parallel) then
               call add(proven_extreme_t(extreme_slides, plan%loop_of(k)), quantity_measure, k)
            end if
         end do
         do k = 1, size(plan%steps)
            associate (step => plan%steps(k))
               if (.not. step%dyad) cycle
               slot = plan%slot(step%p)
               if (slot > 0) call add(proven_extreme_t(extreme_slide, step%loop, step%p, step%places(1)), quantity_slide, slot)
               slot = plan%slot(step%q)
               if (slot > 0) call add(proven_extreme_t(extreme_slide, step%loop, step%q, step%places(2)), quantity_slide, slot)
            end associate
         end do
      end associate
      if (size(linkage%output_path) > 0) then
         call add(proven_extreme_t(extreme_x), quantity_point, 1)
         call add(proven_extreme_t(extreme_y), quantity_point, 2)
      end if
      extremes = list(:n)
      allocate (quantities(2*n))
      do k = 1, n
         quantities(2*k - 1:2*k)%kind = kinds(k)
         quantities(2*k - 1:2*k)%which = which(k)
         quantities(2*k - 1)%sense = -1
         quantities(2*k)%sense = 1
         if (kinds(k) /= quantity_point) cycle
         quantities(2*k - 1)%path = linkage%output_path
         quantities(2*k)%path = linkage%output_path
      end do

   contains

      subroutine add(extreme, kind, number)
         type(proven_extreme_t), intent(in) :: extreme
         integer, intent(in) :: kind, number

         n = n + 1
         list(n) = extreme
         kinds(n) = kind
         which(n) = number
      end subroutine add
   end subroutine list_quantities

   !> The range in boxes, for all quantities: what closes, and what is undecided.
   pure subroutine list_places(proof, places)
      type(proof_t), intent(in) :: proof
      type(place_t), allocatable, intent(out) :: places(:)
      integer :: parts(size(proof%limits)), i, j, n

      do i = 1, size(parts)
         parts(i) = 0
         associate (limit => proof%limits(i))
            if (limit%kind /= piece_opens) &
               parts(i) = max(1, ceiling(real(first_boxes, wp)*(limit%to - limit%from)/(proof%to - proof%from)))
         end associate
      end do
      allocate (places(sum(parts)))
      n = 0
      do i = 1, size(parts)
         associate (limit => proof%limits(i))
            do j = 1, parts(i)
               n = n + 1
               places(n)%certain = limit%kind == piece_closes
               places(n)%from = limit%from + (limit%to - limit%from)*(real(j - 1, wp)/real(parts(i), wp))
               places(n)%to = limit%to
               if (j > 1) places(n - 1)%to = places(n)%from
            end do
         end associate
      end do
   end subroutine list_places

   !> Brackets of one extreme in the user's unit.
   pure subroutine put_together(linkage, quantity, greatest, extreme)
      type(proof_linkage_t), intent(in) :: linkage
      type(quantity_t), intent(in) :: quantity
      type(greatest_t), intent(in) :: greatest(2)        !! of the negative, of the quantity itself
      type(proven_extreme_t), intent(inout) :: extreme

      extreme%found = all(greatest%found)
      if (.not. extreme%found) return
      extreme%least_low = in_unit(-greatest(1)%high, -1)
      extreme%least_high = in_unit(-greatest(1)%low, 1)
      extreme%greatest_low = in_unit(greatest(2)%low, -1)
      extreme%greatest_high = in_unit(greatest(2)%high, 1)
      extreme%least_at = greatest(1)%at
      extreme%greatest_at = greatest(2)%at

   contains

      !> A value in degrees or the user's length, rounded down or up.
      pure real(wp) function in_unit(value, way)
         real(wp), intent(in) :: value
         integer, intent(in) :: way
         real(wp), parameter :: slack = 16.0_wp*epsilon(1.0_wp)
         real(wp) :: square, sine

         if (extreme%kind == extreme_slides) then
            sine = min(max((value + least_sine)*(1.0_wp + real(way, wp)*slack), 0.0_wp), 1.0_wp)
            in_unit = min(degrees_of(sqrt((1.0_wp - sine)*(1.0_wp + sine)), sine)*(1.0_wp + real(way, wp)*slack), right_angle)
            return
         end if
         if (extreme%kind /= extreme_angle) then
            in_unit = value/linkage%numbers%scale      ! a power of two
            return
         end if
         square = value/real(whole_of(linkage, quantity, extreme), wp)*(1.0_wp + real(way, wp)*slack) + real(way, wp)*tiny(1.0_wp)
         square = min(max(square, 0.0_wp), 1.0_wp)
         in_unit = min(2.0_wp*degrees_of(sqrt(1.0_wp - square), sqrt(square))*(1.0_wp + real(way, wp)*slack), straight)
      end function in_unit
   end subroutine put_together

   !> The same after the second look.
   pure subroutine put_fine_together(linkage, quantity, greatest, known, extreme)
      type(proof_linkage_t), intent(in) :: linkage
      type(quantity_t), intent(in) :: quantity
      type(fine_greatest_t), intent(in) :: greatest(2)   !! of the negative, of the quantity itself
      real(qp), intent(in) :: known(2)                   !! lower bounds of the working precision
      type(proven_extreme_t), intent(inout) :: extreme
      real(qp) :: low(2), high(2)

      ! what was known before the second look is still true
      low = max(greatest%low, known)
      high = max(greatest%high, low)
      extreme%least_low = in_unit(-high(1), -1)
      extreme%least_high = in_unit(-low(1), 1)
      extreme%greatest_low = in_unit(low(2), -1)
      extreme%greatest_high = in_unit(high(2), 1)
      if (greatest(1)%low > known(1)) extreme%least_at = real(greatest(1)%at, wp)
      if (greatest(2)%low > known(2)) extreme%greatest_at = real(greatest(2)%at, wp)

   contains

      pure real(wp) function in_unit(value, way)
         real(qp), intent(in) :: value
         integer, intent(in) :: way
         real(qp) :: sine

         if (extreme%kind == extreme_slides) then
            sine = min(max(value + real(least_sine, qp), 0.0_qp), 1.0_qp)
            in_unit = min(rounded(arc_sine_quad(sine)*(1.0_qp + real(way, qp)*of_arc_sine), way), right_angle)
            return
         end if
         if (extreme%kind /= extreme_angle) then
            in_unit = rounded(value/real(linkage%numbers%scale, qp), way)
            return
         end if
         ! its rounding is far below that of the working precision
         sine = sqrt(min(max(value/whole_of(linkage, quantity, extreme), 0.0_qp), 1.0_qp))
         in_unit = min(rounded(2.0_qp*arc_sine_quad(sine)*(1.0_qp + real(way, qp)*of_arc_sine), way), straight)
      end function in_unit
   end subroutine put_fine_together

   !> What the measure of a transmission angle would be at 180 degrees.
   pure real(qp) function whole_of(linkage, quantity, extreme) result(whole)
      type(proof_linkage_t), intent(in) :: linkage
      type(quantity_t), intent(in) :: quantity
      type(proven_extreme_t), intent(in) :: extreme
      integer :: k

      whole = 1.0_qp
      do k = 1, size(linkage%plan%steps)
         associate (step => linkage%plan%steps(k), length => linkage%fine_numbers%length)
            if (.not. step%dyad .or. step%loop /= extreme%loop) cycle
            if (linkage%plan%cause_of(quantity%which) == cause_link) then
               whole = 2.0_qp*length(merge(step%q, step%p, linkage%plan%slot(step%p) > 0))
            else
               whole = 4.0_qp*length(step%p)*length(step%q)
            end if
         end associate
      end do
   end function whole_of

   !> How much all lengths may deviate, together, so that the linkage is still proven to close over the range.
   !>
   !> At most `largest`. Proven in the working precision.
   subroutine prove_tolerance(linkage, from, to, largest, tolerance)
      use psalm_proof_closure, only: piece_t, find_pieces
      type(proof_linkage_t), intent(inout) :: linkage          !! bound
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
         call give_slack(middle*linkage%numbers%scale)
         call find_pieces(linkage%plan, linkage%numbers, from, to, first_boxes, most_fine_boxes, linkage%models, pieces, count)
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

         linkage%numbers%length_slack = slack
         call prepare_models(linkage%plan, linkage%numbers, linkage%models)
      end subroutine give_slack
   end subroutine prove_tolerance
end module psalm_proof_ranges
