!> What an exact linkage is worth: defects of circuit, branch and order, turning crank, transmission angle, longest link,
!> sensitivity.
!>
!> A linkage may meet all points and yet not in one assembly, or not in their order. Circuit: it must be taken apart between two
!> points. Branch: the driven side must be led through a dead point. Order: the points are passed in another one. Sources: Filemon
!> (1972); Chase and Mirth (1993) for circuits and branches; Waldron (1976) for the order.
module psalm_defects
   use psalm_angles, only: degrees_of
   use psalm_kinds, only: wp, pi, half_turn, right_angle
   implicit none (type, external)
   private
   public :: exact_linkage_t, verdict_t, assess, with_other_driver, change_of_lengths, cognates_of, crank_angles, class_names, &
             place_pins

   integer, parameter :: classes = 5
   !> Of the linkages in the order in which they are ranked.
   character(*), parameter :: class_names(classes) = [character(24) :: 'no defect, turning crank', 'no defect, rocking crank', &
                                                      'defect of branch', 'defect of order', 'defect of circuit']
   integer, parameter :: dimensions = 9              !! of a four-bar: two pivots, three lengths, the coupler point

   !> A four-bar or slider-crank and its places at all points.
   type :: exact_linkage_t
      logical :: slides = .false.                    !! in place of the follower a slider on a fixed line holds the coupler's pin
      logical :: swings = .false.                    !! or a line of the coupler slides in a block that turns about b
      complex(wp) :: a = (0.0_wp, 0.0_wp), b = (0.0_wp, 0.0_wp) !! fixed pivots; of a slider b is not used
      complex(wp) :: guide = (1.0_wp, 0.0_wp)        !! direction of the slide, of the coupler's line at the first point
      complex(wp), allocatable :: p(:), c(:), d(:)   !! coupler point and both pins at every point; of a block d is b
      complex(wp), allocatable :: turn(:)            !! of the coupler from the first point
   end type exact_linkage_t

   type :: verdict_t
      logical :: circuit = .false., branch = .false., order = .false. !! true: no defect
      logical :: crank = .false.                     !! the driver turns fully
      real(wp) :: transmission = 0.0_wp              !! least angle, degrees: over the turn, of a rocking driver at the points
      real(wp) :: longest = 0.0_wp                   !! link, over the size of the path
      real(wp) :: sensitivity = 0.0_wp               !! of the path: standard deviation for errors of 1 in every dimension
      integer :: class = classes
   end type verdict_t

contains

   !> Places of both pins from those at the first point.
   pure subroutine place_pins(c, d, one)
      complex(wp), intent(in) :: c, d                !! pins at the first point
      type(exact_linkage_t), intent(inout) :: one    !! whose points and turns are known

      one%c = one%p + one%turn*(c - one%p(1))
      one%d = one%p + one%turn*(d - one%p(1))
      if (one%swings) one%d = one%b
   end subroutine place_pins

   !> The same four-bar driven at the other fixed pivot.
   pure function with_other_driver(one) result(other)
      type(exact_linkage_t), intent(in) :: one
      type(exact_linkage_t) :: other

      other = one
      other%a = one%b
      other%b = one%a
      other%c = one%d
      other%d = one%c
   end function with_other_driver

   !> The two other four-bars that draw the same curve (Roberts and Chebyshev), the points in the same order.
   pure subroutine cognates_of(one, others)
      type(exact_linkage_t), intent(in) :: one
      type(exact_linkage_t), intent(out) :: others(2)
      complex(wp) :: shape, third

      shape = (one%p(1) - one%c(1))/(one%d(1) - one%c(1))
      third = one%a + shape*(one%b - one%a)
      others(1)%a = one%a
      others(1)%b = third
      others(1)%p = one%p
      others(1)%c = one%a + one%p - one%c
      others(1)%d = others(1)%c + shape*(one%p - others(1)%c)
      others(1)%turn = (one%c - one%a)/(one%c(1) - one%a)
      others(2)%a = third
      others(2)%b = one%b
      others(2)%p = one%p
      others(2)%d = one%b + one%p - one%d
      others(2)%c = one%p + shape*(others(2)%d - one%p)
      others(2)%turn = (one%d - one%b)/(one%d(1) - one%b)
   end subroutine cognates_of

   !> Assess a linkage driven at a. `closed`: the last point is followed by the first.
   pure subroutine assess(one, closed, verdict)
      type(exact_linkage_t), intent(in) :: one
      logical, intent(in) :: closed
      type(verdict_t), intent(out) :: verdict
      real(wp) :: size, lengths(4)
      integer :: i

      size = maxval(abs(one%p - sum(one%p)/real(ubound(one%p, 1), wp)))
      if (one%slides) then
         call assess_slider(one, closed, verdict)
         lengths = [abs(one%c(1) - one%a), abs(one%d(1) - one%c(1)), abs(one%p(1) - one%c(1)), &
                    abs(aimag(conjg(one%guide)*(one%d(1) - one%a)))]
      else if (one%swings) then
         call assess_block(one, closed, verdict)
         lengths = [abs(one%c(1) - one%a), abs(one%b - one%a), abs(one%p(1) - one%c(1)), &
                    abs(aimag(conjg(one%guide)*(one%b - one%c(1))))]
      else
         call assess_four_bar(one, closed, verdict)
         lengths = [abs(one%c(1) - one%a), abs(one%d(1) - one%c(1)), abs(one%d(1) - one%b), abs(one%b - one%a)]
      end if
      if (size > 0.0_wp) verdict%longest = maxval(lengths)/size
      verdict%sensitivity = 0.0_wp
      do i = 1, ubound(one%p, 1)
         verdict%sensitivity = verdict%sensitivity + variance_at(one, i)/real(ubound(one%p, 1), wp)
      end do
      verdict%sensitivity = sqrt(verdict%sensitivity)
      if (.not. verdict%circuit) then
         verdict%class = 5
      else if (.not. verdict%order) then
         verdict%class = 4
      else if (.not. verdict%branch) then
         verdict%class = 3
      else
         verdict%class = merge(1, 2, verdict%crank)
      end if
   end subroutine assess

   pure subroutine assess_four_bar(one, closed, verdict)
      type(exact_linkage_t), intent(in) :: one
      logical, intent(in) :: closed
      type(verdict_t), intent(inout) :: verdict
      integer, parameter :: crank = 1, coupler = 2, follower = 3, frame = 4
      real(wp) :: r(4), along(ubound(one%p, 1)), limit, cosine
      logical :: far(ubound(one%p, 1)), near(ubound(one%p, 1))
      integer :: shortest, n, i

      n = ubound(one%p, 1)
      r = [abs(one%c(1) - one%a), abs(one%d(1) - one%c(1)), abs(one%d(1) - one%b), abs(one%b - one%a)]
      shortest = minloc(r, dim=1)
      far = aimag(conjg(one%c - one%d)*(one%b - one%d)) > 0.0_wp
      near = aimag(conjg(one%c - one%a)*(one%b - one%a)) > 0.0_wp
      if (2.0_wp*(minval(r) + maxval(r)) < sum(r)) then
         verdict%crank = shortest == crank .or. shortest == frame
         if (verdict%crank) then
            verdict%circuit = all(far .eqv. far(1))
            along = arguments((one%c - one%a)/(one%b - one%a))
         else
            verdict%circuit = all(near .eqv. near(1))
            if (shortest == follower) along = arguments(one%b - one%d)
            if (shortest == coupler) along = arguments(one%d - one%c)
         end if
         verdict%order = in_order(along, 2.0_wp*pi, closed)
      else
         verdict%circuit = .true.
         along = arguments(swing_of(one))
         limit = 2.0_wp*pi
         where (.not. far) along = limit - along
         verdict%order = in_order(along, 2.0_wp*limit, closed .or. any(far .neqv. far(1)))
      end if
      verdict%branch = verdict%circuit .and. all(far .eqv. far(1))
      if (verdict%crank) then
         verdict%transmission = right_angle
         do i = -1, 1, 2
            cosine = (r(coupler)**2 + r(follower)**2 - (r(frame) + real(i, wp)*r(crank))**2)/(2.0_wp*r(coupler)*r(follower))
            verdict%transmission = min(verdict%transmission, acute(cosine))
         end do
      else
         verdict%transmission = right_angle
         do i = 1, n
            cosine = real(conjg(one%c(i) - one%d(i))*(one%b - one%d(i)), wp)/(r(coupler)*r(follower))
            verdict%transmission = min(verdict%transmission, acute(cosine))
         end do
      end if
   end subroutine assess_four_bar

   pure subroutine assess_slider(one, closed, verdict)
      type(exact_linkage_t), intent(in) :: one
      logical, intent(in) :: closed
      type(verdict_t), intent(inout) :: verdict
      real(wp) :: crank, rod, offset, along(ubound(one%p, 1)), across
      logical :: ahead(ubound(one%p, 1))
      complex(wp) :: relative(ubound(one%p, 1))
      integer :: i

      crank = abs(one%c(1) - one%a)
      rod = abs(one%d(1) - one%c(1))
      offset = aimag(conjg(one%guide)*(one%d(1) - one%a))
      ahead = real(conjg(one%guide)*(one%d - one%c), wp) > 0.0_wp
      verdict%crank = crank + abs(offset) < rod
      if (verdict%crank) then
         verdict%circuit = all(ahead .eqv. ahead(1))
         relative = (one%c - one%a)*conjg(one%guide)
         along = arguments(relative)
         verdict%order = in_order(along, 2.0_wp*pi, closed)
         across = crank + abs(offset)
         verdict%transmission = acute(across/rod)
      else
         ! a rod too short swings the crank about the side of the slide, or where it is short of both sides stays on one of them
         verdict%circuit = .true.
         if (has_two_sides(crank, rod, offset)) then
            relative = (one%c - one%a)*conjg(one%guide)
            verdict%circuit = all(real(relative, wp) > 0.0_wp) .or. all(real(relative, wp) < 0.0_wp)
         end if
         along = arguments(swing_of(one))
         where (.not. ahead) along = 2.0_wp*pi - along
         verdict%order = in_order(along, 4.0_wp*pi, closed .or. any(ahead .neqv. ahead(1)))
         verdict%transmission = right_angle
         do i = 1, ubound(one%p, 1)
            across = aimag(conjg(one%guide)*(one%d(i) - one%c(i)))
            verdict%transmission = min(verdict%transmission, acute(across/rod))
         end do
      end if
      verdict%branch = verdict%circuit .and. all(ahead .eqv. ahead(1))
   end subroutine assess_slider

   !> True if a crank that rocks does so on one side of the pivot, seen along the slide, or on the other, but not across.
   pure logical function has_two_sides(crank, rod, offset)
      real(wp), intent(in) :: crank, rod, offset

      has_two_sides = abs(offset) <= rod .and. crank + rod >= abs(offset) .and. crank - abs(offset) > rod
   end function has_two_sides

   !> The coupler's line goes through a block: it closes where the crank's pin is no nearer to b than the line.
   pure subroutine assess_block(one, closed, verdict)
      type(exact_linkage_t), intent(in) :: one
      logical, intent(in) :: closed
      type(verdict_t), intent(inout) :: verdict
      real(wp) :: crank, frame, offset, along(ubound(one%p, 1)), nearest
      logical :: ahead(ubound(one%p, 1))

      crank = abs(one%c(1) - one%a)
      frame = abs(one%b - one%a)
      offset = abs(aimag(conjg(one%guide)*(one%b - one%c(1))))
      ahead = real(conjg(one%guide*one%turn)*(one%b - one%c), wp) > 0.0_wp
      verdict%crank = abs(frame - crank) > offset
      if (verdict%crank) then
         verdict%circuit = all(ahead .eqv. ahead(1))
         along = arguments((one%c - one%a)/(one%b - one%a))
         verdict%order = in_order(along, 2.0_wp*pi, closed)
         nearest = abs(frame - crank)
      else
         ! the crank swings about the side turned away from b; where it ends, both ways of the line through the block meet
         verdict%circuit = .true.
         along = arguments(swing_of(one))
         where (.not. ahead) along = 2.0_wp*pi - along
         verdict%order = in_order(along, 4.0_wp*pi, closed .or. any(ahead .neqv. ahead(1)))
         nearest = minval(abs(one%b - one%c))
      end if
      verdict%branch = verdict%circuit .and. all(ahead .eqv. ahead(1))
      verdict%transmission = acute(offset/nearest)
   end subroutine assess_block

   !> Places of a crank that rocks, turned so that its swing does not pass the direction of -1.
   pure function swing_of(one) result(relative)
      type(exact_linkage_t), intent(in) :: one
      complex(wp) :: relative(ubound(one%p, 1))
      real(wp) :: crank, coupler, follower, frame, offset

      crank = abs(one%c(1) - one%a)
      coupler = abs(one%d(1) - one%c(1))
      if (one%slides) then
         offset = aimag(conjg(one%guide)*(one%d(1) - one%a))
         relative = (one%c - one%a)*conjg(one%guide)
         if (has_two_sides(crank, coupler, offset)) then
            if (real(relative(1), wp) < 0.0_wp) relative = -relative
         else
            ! about the side of the slide
            relative = relative*cmplx(0.0_wp, -sign(1.0_wp, offset), wp)
         end if
         return
      end if
      relative = (one%c - one%a)/(one%b - one%a)
      if (one%swings) then
         relative = -relative
         return
      end if
      follower = abs(one%d(1) - one%b)
      frame = abs(one%b - one%a)
      ! to both sides of the frame's line, to where coupler and follower are stretched or folded
      if (abs(frame - crank) < abs(coupler - follower) .or. abs(frame - crank) > coupler + follower) relative = -relative
   end function swing_of

   !> Largest change of a length that is to be constant over the points.
   pure real(wp) function change_of_lengths(one)
      type(exact_linkage_t), intent(in) :: one

      change_of_lengths = maxval(abs(abs(one%c - one%a) - abs(one%c(1) - one%a)))
      if (one%slides) then
         change_of_lengths = max(change_of_lengths, maxval(abs(aimag(conjg(one%guide)*(one%d - one%d(1))))))
      else if (one%swings) then
         change_of_lengths = max(change_of_lengths, maxval(abs(aimag(conjg(one%guide*one%turn)*(one%b - one%c)) - &
                                                               aimag(conjg(one%guide)*(one%b - one%c(1))))))
      else
         change_of_lengths = max(change_of_lengths, maxval(abs(abs(one%d - one%b) - abs(one%d(1) - one%b))))
      end if
   end function change_of_lengths

   !> Arguments of complex numbers, radians.
   elemental real(wp) function arguments(z)
      complex(wp), intent(in) :: z

      arguments = atan2(aimag(z), real(z, wp))
   end function arguments

   !> True if numbers that count along a circuit of some length go once round at most, in either sense.
   pure logical function in_order(along, around, closed)
      real(wp), intent(in) :: along(:), around
      logical, intent(in) :: closed
      real(wp), parameter :: slack = 1.0e-9_wp
      real(wp) :: up, down
      integer :: i, n, next

      n = size(along)
      up = 0.0_wp
      down = 0.0_wp
      do i = 1, merge(n, n - 1, closed)
         next = 1 + modulo(i, n)
         up = up + modulo(along(next) - along(i), around)
         down = down + modulo(along(i) - along(next), around)
      end do
      in_order = min(up, down) < around*(1.0_wp + slack)
   end function in_order

   !> Angle from 0 to 90 degrees of which this is the cosine, or minus the cosine.
   pure real(wp) function acute(cosine)
      real(wp), intent(in) :: cosine
      real(wp) :: c

      c = min(abs(cosine), 1.0_wp)
      acute = degrees_of(c, sqrt((1.0_wp - c)*(1.0_wp + c)))
   end function acute

   !> Sum of the squared shifts of the path, square to it, for a change of 1 in every dimension, at point i.
   pure real(wp) function variance_at(one, i)
      type(exact_linkage_t), intent(in) :: one
      integer, intent(in) :: i
      complex(wp) :: crank, coupler, point, reaction, along, pin(dimensions), own(dimensions), unit_crank, unit_coupler
      real(wp) :: own_right(dimensions), lever, turn(dimensions), length
      integer :: k

      variance_at = 0.0_wp
      crank = one%c(i) - one%a
      coupler = one%d(i) - one%c(i)
      point = one%p(i) - one%c(i)
      unit_crank = crank/abs(crank)
      unit_coupler = coupler/abs(coupler)
      if (one%slides) then
         reaction = (0.0_wp, 1.0_wp)*one%guide
      else if (one%swings) then
         reaction = (0.0_wp, 1.0_wp)*one%guide*one%turn(i)
      else
         reaction = (one%d(i) - one%b)/abs(one%d(i) - one%b)
      end if
      ! pivot a in x and y, the crank, the coupler, the coupler point along and across; then what holds the far pin
      pin = [(1.0_wp, 0.0_wp), (0.0_wp, 1.0_wp), unit_crank, unit_coupler, ((0.0_wp, 0.0_wp), k=5, dimensions)]
      own = [(1.0_wp, 0.0_wp), (0.0_wp, 1.0_wp), unit_crank, (0.0_wp, 0.0_wp), unit_coupler, (0.0_wp, 1.0_wp)*unit_coupler, &
             ((0.0_wp, 0.0_wp), k=7, dimensions)]
      ! a line has no length
      if (one%swings) pin(4) = (0.0_wp, 0.0_wp)
      own_right = 0.0_wp
      own_right(7) = 1.0_wp
      if (.not. one%slides) own_right(8:) = [real(reaction, wp), aimag(reaction)]
      lever = real(conjg(reaction)*(0.0_wp, 1.0_wp)*coupler, wp)
      if (.not. abs(lever) > 0.0_wp) then
         variance_at = huge(1.0_wp)
         return
      end if
      turn = (own_right - real(conjg(reaction)*pin, wp))/lever
      own = own + (0.0_wp, 1.0_wp)*point*turn
      along = (0.0_wp, 1.0_wp)*crank
      along = along - (0.0_wp, 1.0_wp)*point*real(conjg(reaction)*along, wp)/lever
      length = abs(along)
      if (length > 0.0_wp) then
         variance_at = sum(aimag(conjg(along/length)*own)**2)
      else
         variance_at = sum(abs(own)**2)
      end if
   end function variance_at

   !> Angles of the crank at all points from the first, degrees. Of a crank that turns: in the order of the points where they go one
   !> way, else each the nearest to the one before. Of one that rocks: within its swing.
   pure function crank_angles(one, closed) result(degrees)
      type(exact_linkage_t), intent(in) :: one
      logical, intent(in) :: closed
      real(wp) :: degrees(ubound(one%p, 1))
      type(verdict_t) :: verdict
      complex(wp) :: step
      real(wp) :: up(ubound(one%p, 1)), down(ubound(one%p, 1))
      integer :: i, n

      n = ubound(one%p, 1)
      call assess(one, closed, verdict)
      if (.not. verdict%crank .and. verdict%circuit) then
         associate (swing => swing_of(one))
            degrees = degrees_of(real(swing, wp), aimag(swing))
         end associate
         degrees = degrees - degrees(1)
         return
      end if
      degrees(1) = 0.0_wp
      up(1) = 0.0_wp
      down(1) = 0.0_wp
      do i = 2, n
         step = of_unit_size(one%c(i) - one%a)*conjg(of_unit_size(one%c(i - 1) - one%a))
         degrees(i) = degrees_of(real(step, wp), aimag(step))
         up(i) = up(i - 1) + modulo(degrees(i), 2.0_wp*half_turn)
         down(i) = down(i - 1) - modulo(-degrees(i), 2.0_wp*half_turn)
         degrees(i) = degrees(i - 1) + degrees(i)
      end do
      if (.not. closed) return
      if (up(n) < 2.0_wp*half_turn) degrees = up
      if (down(n) > -2.0_wp*half_turn) degrees = down
   end function crank_angles

   !> A vector divided by a power of two, so that products of two are numbers.
   elemental complex(wp) function of_unit_size(vector)
      complex(wp), intent(in) :: vector
      integer :: e

      e = exponent(max(abs(real(vector, wp)), abs(aimag(vector))))
      of_unit_size = cmplx(scale(real(vector, wp), -e), scale(aimag(vector), -e), wp)
   end function of_unit_size
end module psalm_defects
