!> The motion of a sketch of any Assur groups along lines of its inputs, proven; and how far its outputs go.
!>
!> A line is covered by tubes (`psalm_proof_tube`), each joined to the one before it: what is covered closes for every input,
!> without a dead point, in the assembly of the drawing. Where tubes become too short the rest of the line is undecided. Outputs are
!> quadratics with a bound of their third derivative and of what a tube leaves open; the tube with the greatest upper bound is
!> halved until its bound and a value that is reached agree.
module psalm_proof_chain
   use psalm_chain_outputs, only: output_at
   use psalm_closure, only: closure_t, state_t, most_orders
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_proof_tube, only: tube_t, enclose, enclose_here, half_of, joins, prediction_at, enclose_turn, turning_point, &
                               leads_to, steepest, point_majorant, travel_majorant, rounding, degree
   use psalm_sketch, only: sketch_output_t, output_point, output_angle, output_distance, output_slide, output_between, &
                           output_pose, output_ratio, output_x, output_y, columns_of
   implicit none (type, external)
   private
   public :: chain_tubes_t, leg_t, output_range_t, start_tubes, cover_leg, stands_as_drawn, is_on_motion, bracket_outputs, &
             play_of_joint

   real(wp), parameter :: first_r = 0.01_wp      !! of a line
   real(wp), parameter :: least_r = 1.0e-13_wp   !! shorter tubes are not tried
   real(wp), parameter :: easy = 0.3_wp          !! a contraction below this lets the next tube be longer
   real(wp), parameter :: longer = 1.5_wp
   real(wp), parameter :: longest_turn = 0.01_wp !! of the drawing: how far a tube goes around a dead point
   real(wp), parameter :: shorter_turn = 0.2_wp
   integer, parameter :: turns_tried = 8
   integer, parameter :: most_tubes = 4000       !! of a line
   integer, parameter :: most_halvings = 4000
   real(wp), parameter :: enough = 1.0e-11_wp    !! width of a bracket, of the drawing's size or a turn
   real(wp), parameter :: slack = 1.0e-12_wp     !! of a full turn, which is no number of the machine

   !> A line of the inputs.
   type :: leg_t
      real(wp), allocatable :: from(:), to(:)    !! shape (drives): radians or length from the drawing
      integer :: after = 0                       !! the leg at whose end it begins; 0: at the drawing
      real(wp) :: reached = 0.0_wp               !! part of the way that is proven
      logical :: complete = .false.              !! all of it is
      logical :: turns_back = .false.            !! proven: a dead point, beyond which the inputs cannot go
      real(wp) :: dead_low = 0.0_wp, dead_high = 0.0_wp !! bracket of it, parts of the way
   end type leg_t

   !> Where a number is within a tube.
   type :: tube_span_t
      real(wp) :: value = 0.0_wp                 !! in the middle
      real(wp) :: low = 0.0_wp, high = 0.0_wp    !! bounds
      real(wp) :: open = 0.0_wp                  !! they are reached but for this
      real(wp) :: low_at = 0.0_wp, high_at = 0.0_wp !! of the way
      logical :: bounded = .false.
   end type tube_span_t

   !> A tube, the leg it is on and where the outputs are in it; angles go on from the tube before.
   type :: tube_part_t
      integer :: leg = 0
      type(tube_t) :: tube
      type(tube_span_t), allocatable :: spans(:)      !! shape (numbers of all outputs)
   end type tube_part_t

   !> All tubes of all legs.
   type :: chain_tubes_t
      type(tube_t) :: drawing
      type(tube_t), allocatable :: ends(:)       !! by leg, if all of it is proven
      type(tube_part_t), allocatable :: parts(:)      !! the first `count` are used
      integer :: count = 0
   end type chain_tubes_t

   !> Least and greatest value of a number over what is proven, each bracketed.
   type :: output_range_t
      logical :: bounded = .false.
      real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp !! bracket of the least, of the greatest value
      integer :: leg(2) = 0
      real(wp) :: way(2) = 0.0_wp                !! where it is: part of the way of the leg
   end type output_range_t

contains

   !> Begin at the drawing. `sound` is false where its own assembly cannot be proven.
   subroutine start_tubes(closure, start, legs, tubes, sound)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: start
      integer, intent(in) :: legs
      type(chain_tubes_t), intent(out) :: tubes
      logical, intent(out) :: sound

      call enclose_here(closure, start, 0.0_wp, tubes%drawing)
      sound = tubes%drawing%holds
      allocate (tubes%ends(legs), tubes%parts(0))
   end subroutine start_tubes

   !> Cover a leg as far as tubes lead.
   subroutine cover_leg(closure, outputs, number, leg, tubes)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      integer, intent(in) :: number              !! of the leg
      type(leg_t), intent(inout) :: leg
      type(chain_tubes_t), intent(inout) :: tubes
      type(tube_t) :: before, next
      type(state_t) :: state
      real(wp) :: r, end_of_before
      integer :: first

      if (leg%after == 0) then
         before = tubes%drawing
      else
         before = tubes%ends(leg%after)
      end if
      before%state%input(:, 0) = leg%from
      before%state%input(:, 1) = leg%to - leg%from
      before%state%input(:, 2:) = 0.0_wp
      ! rates of its own line
      call enclose_here(closure, before%state, 0.0_wp, next)
      if (.not. next%holds) return
      if (.not. joins(closure, before, 0.0_wp, next, 0.0_wp)) return
      before = next
      first = tubes%count
      end_of_before = 0.0_wp
      r = first_r
      do while (leg%reached < 1.0_wp)
         r = min(r, 0.5_wp*(1.0_wp - leg%reached))
         state = prediction_at(before, end_of_before + r)
         state%input(:, 0) = leg%from + (leg%reached + r)*(leg%to - leg%from)
         call enclose(closure, state, leg%reached + r, r, next)
         if (next%holds) next%holds = joins(closure, before, end_of_before, next, -r)
         if (.not. next%holds) then
            r = 0.5_wp*r
            if (r < least_r .or. tubes%count - first >= most_tubes) then
               if (tubes%count > first) call turn_back(closure, before, end_of_before, leg)
               return
            end if
            cycle
         end if
         call add_part(closure, outputs, number, next, tubes)
         before = next
         end_of_before = r
         leg%reached = leg%reached + 2.0_wp*r
         if (1.0_wp - leg%reached < least_r) leg%reached = 1.0_wp
         if (next%kappa < easy) r = longer*r
      end do
      state = prediction_at(before, end_of_before)
      state%input(:, 0) = leg%to
      call enclose_here(closure, state, 1.0_wp, tubes%ends(number))
      leg%complete = tubes%ends(number)%holds
      if (leg%complete) leg%complete = joins(closure, before, end_of_before, tubes%ends(number), 0.0_wp)
   end subroutine cover_leg

   !> Look whether the motion turns back behind the last tube of a leg.
   subroutine turn_back(closure, last, s, leg)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: last
      real(wp), intent(in) :: s                  !! its end, from its middle
      type(leg_t), intent(inout) :: leg
      type(tube_t) :: turn
      real(wp) :: r, low, high
      integer :: try
      logical :: turns

      r = longest_turn*closure%size
      do try = 1, turns_tried
         call enclose_turn(closure, prediction_at(last, s), leg%to - leg%from, leg%reached, steepest(closure, last), r, turn)
         call turning_point(turn, turns, low, high)
         if (turns) turns = leads_to(closure, last, s, turn)
         ! the shorter the tube, the tighter, as long as the end of the last one is in it
         if (turns .and. (.not. leg%turns_back .or. high < leg%dead_high)) then
            leg%turns_back = .true.
            leg%dead_low = low
            leg%dead_high = high
         end if
         r = shorter_turn*r
      end do
   end subroutine turn_back

   !> True if the linkage stands at the end of a leg as in the drawing, links turned by full turns not counted.
   logical function stands_as_drawn(closure, tubes, leg)
      type(closure_t), intent(in) :: closure
      type(chain_tubes_t), intent(in) :: tubes
      integer, intent(in) :: leg
      real(wp), parameter :: turn = 6.283185307179586_wp
      type(tube_t) :: end

      end = tubes%ends(leg)
      end%state%phi(:, 0) = end%state%phi(:, 0) - turn*anint((end%state%phi(:, 0) - tubes%drawing%state%phi(:, 0))/turn)
      end%off_t = end%off_t + slack*closure%size
      end%off_phi = end%off_phi + slack
      stands_as_drawn = joins(closure, end, 0.0_wp, tubes%drawing, 0.0_wp)
   end function stands_as_drawn

   !> True if a position, found at some part of the way of a leg that is proven there, is on the proven motion.
   logical function is_on_motion(closure, tubes, leg, way, state)
      type(closure_t), intent(in) :: closure
      type(chain_tubes_t), intent(in) :: tubes
      integer, intent(in) :: leg
      real(wp), intent(in) :: way
      type(state_t), intent(in) :: state
      type(tube_t) :: here
      real(wp) :: s
      integer :: i

      is_on_motion = .false.
      call enclose_here(closure, state, way, here)
      if (.not. here%holds) return
      do i = 1, tubes%count
         associate (part => tubes%parts(i))
            s = way - part%tube%middle
            if (part%leg /= leg .or. abs(s) > part%tube%r + least_r) cycle
            is_on_motion = joins(closure, part%tube, s, here, 0.0_wp)
            if (is_on_motion) return
         end associate
      end do
   end function is_on_motion

   ! ---- outputs -----------------------------------------------------------------------------------------------------

   !> Add a tube and the ranges of the outputs in it.
   subroutine add_part(closure, outputs, leg, tube, tubes)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      integer, intent(in) :: leg
      type(tube_t), intent(in) :: tube
      type(chain_tubes_t), intent(inout) :: tubes
      type(tube_part_t), allocatable :: more(:)
      real(wp) :: before
      logical :: follows
      integer :: n

      if (tubes%count == size(tubes%parts)) then
         allocate (more(2*size(tubes%parts) + 64))
         more(:tubes%count) = tubes%parts
         call move_alloc(more, tubes%parts)
      end if
      tubes%count = tubes%count + 1
      associate (part => tubes%parts(tubes%count))
         part%leg = leg
         part%tube = tube
         call find_spans(closure, outputs, part%tube, part%spans)
         follows = .false.
         if (tubes%count > 1) follows = tubes%parts(tubes%count - 1)%leg == leg
         if (.not. follows) return
         do n = 1, size(part%spans)
            if (.not. is_angle(outputs, n)) cycle
            before = tubes%parts(tubes%count - 1)%spans(n)%value
            call move_to(part%spans(n), before)
         end do
      end associate
   end subroutine add_part

   !> Move an angle by full turns next to a value.
   pure subroutine move_to(span, value)
      type(tube_span_t), intent(inout) :: span
      real(wp), intent(in) :: value
      real(wp), parameter :: turn = 360.0_wp
      real(wp) :: shift

      shift = turn*anint((value - span%value)/turn)
      span%value = span%value + shift
      span%low = span%low + shift
      span%high = span%high + shift
   end subroutine move_to

   !> True if a number of all outputs is an angle.
   pure logical function is_angle(outputs, number)
      type(sketch_output_t), intent(in) :: outputs(:)
      integer, intent(in) :: number
      integer :: k, n

      is_angle = .false.
      n = 0
      do k = 1, size(outputs)
         if (number <= n + columns_of(outputs(k))) then
            is_angle = outputs(k)%kind == output_angle .or. outputs(k)%kind == output_between .or. &
                       (outputs(k)%kind == output_pose .and. number == n + 3)
            return
         end if
         n = n + columns_of(outputs(k))
      end do
   end function is_angle

   !> Where all numbers of all outputs are within a tube.
   subroutine find_spans(closure, outputs, tube, spans)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      type(tube_t), intent(in) :: tube
      type(tube_span_t), allocatable, intent(out) :: spans(:)
      real(wp), allocatable :: values(:, :)
      real(wp) :: z(0:degree), l(3), third, error, q, low
      integer :: k, n, numbers

      numbers = 0
      do k = 1, size(outputs)
         numbers = numbers + columns_of(outputs(k))
      end do
      allocate (spans(numbers), values(numbers, 0:most_orders))
      call output_at(closure, tube%state, outputs, values)
      n = 1
      do k = 1, size(outputs)
         associate (output => outputs(k), joints => outputs(k)%joints)
            select case (output%kind)
            case (output_point, output_pose, output_x, output_y)
               z = point_majorant(closure, tube, joints(1), closure%holder(joints(1)))
               error = play_of_joint(closure, tube, joints(1))
               call set_span(n, z(3), error, 1.0_wp)
               if (output%kind == output_point .or. output%kind == output_pose) &
                  call set_span(n + 1, z(3), error, 1.0_wp)
               if (output%kind == output_pose) then
                  call bound_line(joints(2), joints(3), l, third, error, low)
                  if (low > 0.0_wp) call set_span(n + 2, third, error, degrees_per_radian)
               end if
            case (output_angle)
               call bound_line(joints(1), joints(2), l, third, error, low)
               if (low > 0.0_wp) call set_span(n, third, error, degrees_per_radian)
            case (output_between)
               call bound_line(joints(1), joints(2), l, third, error, low)
               q = third
               z(0) = error
               if (low > 0.0_wp) then
                  call bound_line(joints(3), joints(4), l, third, error, low)
                  if (low > 0.0_wp) call set_span(n, third + q, error + z(0), degrees_per_radian)
               end if
            case (output_distance)
               call bound_line(joints(1), joints(2), l, third, error, low)
               if (low > 0.0_wp) then
                  q = play_of_joint(closure, tube, joints(1))
                  if (joints(2) > 0) q = q + play_of_joint(closure, tube, joints(2))
                  ! the length is not greater than that in the middle and the way
                  z(0) = values(n, 0)*(1.0_wp + tube%r*l(1)*exp_bound(tube%r*l(1)))
                  call set_span(n, z(0)*(l(1)**3 + 3.0_wp*l(1)*l(2) + l(3)), q, 1.0_wp)
               end if
            case (output_slide)
               z = travel_majorant(closure, tube, output%slide)
               associate (a => closure%sketch%slides(output%slide)%links(1), b => closure%sketch%slides(output%slide)%links(2))
                  q = hypotenuse(closure%slide_point(2, output%slide)%re, closure%slide_point(2, output%slide)%im)
                  error = tube%off_t(a) + tube%off_t(b) + z(0)*tube%off_phi(a) + q*tube%off_phi(b)
                  error = error + rounding*(z(0) + maxval(abs(tube%state%t([a, b], 0)%re)) &
                                            + maxval(abs(tube%state%t([a, b], 0)%im)))
               end associate
               call set_span(n, z(3), error, 1.0_wp)
            case (output_ratio)
               ! a ratio of rates may be infinite; it is not bounded here
            end select
         end associate
         n = n + columns_of(outputs(k))
      end do

   contains

      !> 1 + x + ... for the bound of a length that grows by a relative rate; x is well below 1 where tubes hold.
      pure real(wp) function exp_bound(x)
         real(wp), intent(in) :: x

         exp_bound = 1.0_wp/max(1.0_wp - x, tiny(1.0_wp))
      end function exp_bound

      !> The line from joint to joint (0: the origin): bounds of the derivatives of the logarithm of its vector, the third of its
      !> direction, what is open of that (radians), and the least length.
      pure subroutine bound_line(from, to, l, third, error, low)
         integer, intent(in) :: from, to
         real(wp), intent(out) :: l(3), third, error, low
         real(wp) :: p(0:degree), z(3), play
         complex(wp) :: vector
         integer :: link

         p = point_majorant(closure, tube, from, closure%holder(from))
         z = p(1:3)
         play = play_of_joint(closure, tube, from)
         vector = tube%state%joint(from, 0)
         if (to > 0) then
            p = point_majorant(closure, tube, to, closure%holder(to))
            z = z + p(1:3)
            play = play + play_of_joint(closure, tube, to)
            vector = tube%state%joint(to, 0) - vector
         end if
         low = hypotenuse(vector%re, vector%im) - tube%r*z(1) - play
         l = 0.0_wp
         third = 0.0_wp
         error = 0.0_wp
         if (low <= 0.0_wp) return
         l(1) = z(1)/low
         l(2) = z(2)/low + l(1)**2
         l(3) = z(3)/low + 3.0_wp*l(1)*l(2) + l(1)**3
         third = l(3)
         error = play/low
         if (to == 0) return
         ! of two joints of one link the direction is the link's
         do link = 1, size(closure%sketch%links)
            if (.not. closure%sketch%has_joint(link, from) .or. .not. closure%sketch%has_joint(link, to)) cycle
            third = abs(tube%state%phi(link, 3))
            error = tube%off_phi(link) + rounding*(1.0_wp + abs(tube%state%phi(link, 0)))
            return
         end do
      end subroutine bound_line

      !> The range of a quadratic with a bound of the third derivative, over the box.
      subroutine set_span(number, third, error, unit)
         integer, intent(in) :: number
         real(wp), intent(in) :: third, error         !! in radians
         real(wp), intent(in) :: unit                 !! of the value
         real(wp) :: at(3), y, more
         integer :: i

         associate (span => spans(number), value => values(number, 0), rate => values(number, 1), change => values(number, 2))
            span%bounded = .true.
            span%value = value
            more = (error + third*tube%r**3/6.0_wp)*unit + rounding*abs(value)
            at = [-tube%r, tube%r, tube%r]
            if (abs(rate) < tube%r*abs(change)) at(3) = -rate/change
            span%low = huge(1.0_wp)
            span%high = -huge(1.0_wp)
            do i = 1, 3
               y = value + unit*at(i)*(rate + 0.5_wp*at(i)*change)
               if (y < span%low) span%low_at = tube%middle + at(i)
               span%low = min(span%low, y)
               if (y > span%high) span%high_at = tube%middle + at(i)
               span%high = max(span%high, y)
            end do
            span%low = span%low - more
            span%high = span%high + more
            span%open = 2.0_wp*more
         end associate
      end subroutine set_span
   end subroutine find_spans

   !> How far a joint may lie from its prediction, roundings included.
   pure real(wp) function play_of_joint(closure, tube, joint) result(play)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      integer, intent(in) :: joint
      real(wp) :: p(0:degree)

      associate (link => closure%holder(joint))
         p = point_majorant(closure, tube, joint, link)
         play = tube%off_t(link) + p(0)*tube%off_phi(link) &
                + rounding*(abs(tube%state%t(link, 0)%re) + abs(tube%state%t(link, 0)%im) &
                            + p(0)*(1.0_wp + abs(tube%state%phi(link, 0))))
      end associate
   end function play_of_joint

   !> Brackets of the least and greatest value of every number over all tubes, which are halved where that helps.
   subroutine bracket_outputs(closure, outputs, tubes, ranges)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      type(chain_tubes_t), intent(inout) :: tubes
      type(output_range_t), allocatable, intent(out) :: ranges(:) !! shape (numbers of all outputs)
      real(wp) :: unit
      integer :: n, halvings, at
      logical :: done

      if (tubes%count == 0) then
         allocate (ranges(0))
         return
      end if
      allocate (ranges(size(tubes%parts(1)%spans)))
      halvings = 0
      do n = 1, size(ranges)
         ranges(n)%bounded = is_bounded(n)
         if (.not. ranges(n)%bounded) cycle
         unit = merge(degrees_per_radian, closure%size, is_angle(outputs, n))
         do
            call greatest(n, -1.0_wp, ranges(n)%low(1), ranges(n)%high(1), at)
            ranges(n)%leg(1) = tubes%parts(at)%leg
            ranges(n)%way(1) = tubes%parts(at)%spans(n)%low_at
            if (ranges(n)%high(1) - ranges(n)%low(1) <= enough*unit) exit
            call split(at, done)
            if (done) exit
         end do
         do
            call greatest(n, 1.0_wp, ranges(n)%low(2), ranges(n)%high(2), at)
            ranges(n)%leg(2) = tubes%parts(at)%leg
            ranges(n)%way(2) = tubes%parts(at)%spans(n)%high_at
            if (ranges(n)%high(2) - ranges(n)%low(2) <= enough*unit) exit
            call split(at, done)
            if (done) exit
         end do
      end do

   contains

      logical function is_bounded(number)
         integer, intent(in) :: number
         integer :: i

         is_bounded = .true.
         do i = 1, tubes%count
            is_bounded = is_bounded .and. tubes%parts(i)%spans(number)%bounded
         end do
      end function is_bounded

      !> Bracket of the greatest (+1) or least (-1) value and the tube that bounds it.
      subroutine greatest(number, sense, low, high, at)
         integer, intent(in) :: number
         real(wp), intent(in) :: sense
         real(wp), intent(out) :: low, high
         integer, intent(out) :: at
         real(wp) :: bound, here, most
         integer :: i

         bound = -huge(1.0_wp)
         most = -huge(1.0_wp)
         at = 1
         do i = 1, tubes%count
            associate (span => tubes%parts(i)%spans(number))
               here = merge(span%high, -span%low, sense > 0.0_wp)
               most = max(most, here - span%open)
               if (here > bound) at = i
               bound = max(bound, here)
            end associate
         end do
         low = merge(most, -bound, sense > 0.0_wp)
         high = merge(bound, -most, sense > 0.0_wp)
      end subroutine greatest

      !> Put two halves in the place of a tube. `done`: nothing can be gained any more.
      subroutine split(at, done)
         integer, intent(in) :: at
         logical, intent(out) :: done
         type(tube_part_t) :: whole
         type(tube_t) :: halves(2)
         integer :: i, n

         whole = tubes%parts(at)
         halvings = halvings + 1
         done = halvings > most_halvings .or. whole%tube%r < least_r
         if (done) return
         call half_of(closure, whole%tube, -1, halves(1))
         call half_of(closure, whole%tube, 1, halves(2))
         done = .not. (halves(1)%holds .and. halves(2)%holds)
         if (done) return
         do i = 1, 2
            call add_part(closure, outputs, 0, halves(i), tubes)
            do n = 1, size(whole%spans)
               if (is_angle(outputs, n)) call move_to(tubes%parts(tubes%count)%spans(n), whole%spans(n)%value)
            end do
            tubes%parts(tubes%count)%leg = whole%leg
         end do
         tubes%parts(at) = tubes%parts(tubes%count)
         tubes%count = tubes%count - 1
      end subroutine split
   end subroutine bracket_outputs
end module psalm_proof_chain
