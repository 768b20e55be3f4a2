!> The motion of a sketch of any Assur groups along lines of its inputs, proven; and how far its outputs go.
!>
!> A line is covered by tubes (`psalm_proof_tube`), each joined to the one before it: what is covered closes for every input,
!> without a dead point, in the assembly of the drawing. Where tubes become too short the rest of the line is undecided. Outputs are
!> quadratics with a bound of their third derivative and of what a tube leaves open; the tube with the greatest upper bound is
!> halved until its bound and a value that is reached agree.
module psalm_proof_chain
   use psalm_closure, only: closure_t, state_t
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_proof_numbers, only: quadratic_t, find_numbers, is_angle, has_rate
   use psalm_proof_tube, only: tube_t, enclose, enclose_here, half_of, joins, prediction_at, enclose_turn, turning_point, &
                               leads_to, steepest
   use psalm_sketch, only: sketch_output_t
   implicit none (type, external)
   private
   public :: chain_tubes_t, path_segment_t, output_range_t, start_tubes, cover_segment, stands_as_drawn, is_on_motion, &
             bracket_outputs

   real(wp), parameter :: first_r = 0.01_wp      !! of a line
   real(wp), parameter :: least_r = 1.0e-13_wp   !! shorter tubes are not tried
   real(wp), parameter :: easy = 0.3_wp          !! a contraction below this lets the next tube be longer
   real(wp), parameter :: longer = 1.5_wp
   real(wp), parameter :: longest_turn = 0.01_wp !! of the drawing: how far a tube goes around a dead point
   real(wp), parameter :: shorter_turn = 0.2_wp
   integer, parameter :: turns_tried = 8
   integer, parameter :: most_tubes = 4000       !! of a line
   integer, parameter :: most_halvings = 4000
   integer, parameter :: most_of_rate = 200      !! halvings for a velocity ratio: where it is nearly constant, every tube counts
   integer, parameter :: tries = 60              !! of halving where a number is not bounded
   real(wp), parameter :: enough = 1.0e-11_wp    !! width of a bracket, of the drawing's size or a turn
   real(wp), parameter :: slack = 1.0e-12_wp     !! of a full turn, which is no number of the machine

   !> A line of the inputs.
   type :: path_segment_t
      real(wp), allocatable :: from(:), to(:)    !! shape (drives): radians or length from the drawing
      integer :: after = 0                       !! the segment at whose end it begins; 0: at the drawing
      real(wp) :: per = 0.0_wp                   !! of the way by the input, for velocity ratios; 0: there is no one input
      real(wp) :: reached = 0.0_wp               !! part of the way that is proven
      logical :: complete = .false.              !! all of it is
      logical :: turns_back = .false.            !! proven: a dead point, beyond which the inputs cannot go
      real(wp) :: dead_low = 0.0_wp, dead_high = 0.0_wp !! bracket of it, parts of the way
   end type path_segment_t

   !> Where a number is within a tube.
   type :: tube_span_t
      real(wp) :: value = 0.0_wp                 !! in the middle
      real(wp) :: low = 0.0_wp, high = 0.0_wp    !! bounds
      real(wp) :: open = 0.0_wp                  !! they are reached but for this
      real(wp) :: low_at = 0.0_wp, high_at = 0.0_wp !! of the way
      logical :: bounded = .false.
   end type tube_span_t

   !> A tube, the segment it is on and where the outputs are in it; angles go on from the tube before.
   type :: tube_part_t
      integer :: segment = 0
      type(tube_t) :: tube
      real(wp) :: per = 0.0_wp                   !! as of its segment
      type(tube_span_t), allocatable :: spans(:)      !! shape (numbers of all outputs, then their rates)
   end type tube_part_t

   !> All tubes of all segments.
   type :: chain_tubes_t
      type(tube_t) :: drawing
      type(tube_t), allocatable :: ends(:)       !! by segment, if all of it is proven
      type(tube_part_t), allocatable :: parts(:)      !! the first `count` are used
      integer :: count = 0
   end type chain_tubes_t

   !> Least and greatest value of a number over what is proven, each bracketed.
   type :: output_range_t
      logical :: bounded = .false.
      real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp !! bracket of the least, of the greatest value
      integer :: segment(2) = 0
      real(wp) :: way(2) = 0.0_wp                !! where it is: part of the way of the segment
   end type output_range_t

contains

   !> Begin at the drawing. `valid` is false where its own assembly cannot be proven.
   subroutine start_tubes(closure, start, segments, tubes, valid)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: start
      integer, intent(in) :: segments
      type(chain_tubes_t), intent(out) :: tubes
      logical, intent(out) :: valid

      call enclose_here(closure, start, 0.0_wp, tubes%drawing)
      valid = tubes%drawing%holds
      allocate (tubes%ends(segments), tubes%parts(0))
   end subroutine start_tubes

   !> Cover a segment as far as tubes lead.
   subroutine cover_segment(closure, outputs, number, segment, tubes)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      integer, intent(in) :: number              !! of the segment
      type(path_segment_t), intent(inout) :: segment
      type(chain_tubes_t), intent(inout) :: tubes
      type(tube_t) :: before, next
      type(state_t) :: state
      real(wp) :: r, end_of_before
      integer :: first

      if (segment%after == 0) then
         before = tubes%drawing
      else
         before = tubes%ends(segment%after)
      end if
      before%state%input(:, 0) = segment%from
      before%state%input(:, 1) = segment%to - segment%from
      before%state%input(:, 2:) = 0.0_wp
      ! rates of its own line
      call enclose_here(closure, before%state, 0.0_wp, next)
      if (.not. next%holds) return
      if (.not. joins(closure, before, 0.0_wp, next, 0.0_wp)) return
      before = next
      first = tubes%count
      end_of_before = 0.0_wp
      r = first_r
      do while (segment%reached < 1.0_wp)
         r = min(r, 0.5_wp*(1.0_wp - segment%reached))
         state = prediction_at(before, end_of_before + r)
         state%input(:, 0) = segment%from + (segment%reached + r)*(segment%to - segment%from)
         call enclose(closure, state, segment%reached + r, r, next)
         if (next%holds) next%holds = joins(closure, before, end_of_before, next, -r)
         if (.not. next%holds) r = 0.5_wp*r
         if ((.not. next%holds .and. r < least_r) .or. tubes%count - first >= most_tubes) then
            if (tubes%count > first) call turn_back(closure, before, end_of_before, segment)
            return
         end if
         if (.not. next%holds) cycle
         call add_part(closure, outputs, number, segment%per, next, tubes)
         before = next
         end_of_before = r
         segment%reached = segment%reached + 2.0_wp*r
         if (1.0_wp - segment%reached < least_r) segment%reached = 1.0_wp
         if (next%kappa < easy) r = longer*r
      end do
      state = prediction_at(before, end_of_before)
      state%input(:, 0) = segment%to
      call enclose_here(closure, state, 1.0_wp, tubes%ends(number))
      segment%complete = tubes%ends(number)%holds
      if (segment%complete) segment%complete = joins(closure, before, end_of_before, tubes%ends(number), 0.0_wp)
   end subroutine cover_segment

   !> Look whether the motion turns back behind the last tube of a segment.
   subroutine turn_back(closure, last, s, segment)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: last
      real(wp), intent(in) :: s                  !! its end, from its middle
      type(path_segment_t), intent(inout) :: segment
      type(tube_t) :: turn
      real(wp) :: r, low, high
      integer :: try
      logical :: turns

      r = longest_turn*closure%size
      do try = 1, turns_tried
         call enclose_turn(closure, prediction_at(last, s), segment%to - segment%from, segment%reached, &
                            steepest(closure, last), r, turn)
         call turning_point(turn, turns, low, high)
         if (turns) turns = leads_to(closure, last, s, turn)
         ! the shorter the tube, the tighter, as long as the end of the last one is in it
         if (turns .and. (.not. segment%turns_back .or. high < segment%dead_high)) then
            segment%turns_back = .true.
            segment%dead_low = low
            segment%dead_high = high
         end if
         r = shorter_turn*r
      end do
   end subroutine turn_back

   !> True if the linkage stands at the end of a segment as in the drawing, links turned by full turns not counted.
   logical function stands_as_drawn(closure, tubes, segment)
      type(closure_t), intent(in) :: closure
      type(chain_tubes_t), intent(in) :: tubes
      integer, intent(in) :: segment
      real(wp), parameter :: turn = 6.283185307179586_wp
      type(tube_t) :: end

      end = tubes%ends(segment)
      end%state%phi(:, 0) = end%state%phi(:, 0) - turn*anint((end%state%phi(:, 0) - tubes%drawing%state%phi(:, 0))/turn)
      end%off_t = end%off_t + slack*closure%size
      end%off_phi = end%off_phi + slack
      stands_as_drawn = joins(closure, end, 0.0_wp, tubes%drawing, 0.0_wp)
   end function stands_as_drawn

   !> True if a position, found at some part of the way of a segment that is proven there, is on the proven motion.
   logical function is_on_motion(closure, tubes, segment, way, state)
      type(closure_t), intent(in) :: closure
      type(chain_tubes_t), intent(in) :: tubes
      integer, intent(in) :: segment
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
            if (part%segment /= segment .or. abs(s) > part%tube%r + least_r) cycle
            is_on_motion = joins(closure, part%tube, s, here, 0.0_wp)
            if (is_on_motion) return
         end associate
      end do
   end function is_on_motion

   ! ---- outputs -----------------------------------------------------------------------------------------------------

   !> Add a tube and the ranges of the outputs in it.
   subroutine add_part(closure, outputs, segment, per, tube, tubes)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      integer, intent(in) :: segment
      real(wp), intent(in) :: per
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
         part%segment = segment
         part%per = per
         part%tube = tube
         call find_spans(closure, outputs, part%tube, per, part%spans)
         follows = .false.
         if (tubes%count > 1) follows = tubes%parts(tubes%count - 1)%segment == segment
         if (.not. follows) return
         do n = 1, size(part%spans)/2
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

   !> Where all numbers of all outputs are within a tube, then their rates by the input.
   subroutine find_spans(closure, outputs, tube, per, spans)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      type(tube_t), intent(in) :: tube
      real(wp), intent(in) :: per                !! of the way, by the input; 0: there is no one input
      type(tube_span_t), allocatable, intent(out) :: spans(:)
      type(quadratic_t), allocatable :: values(:), speeds(:)
      integer :: n

      call find_numbers(closure, outputs, tube, values, speeds)
      allocate (spans(size(values) + size(speeds)))
      do n = 1, size(values)
         if (values(n)%bounded) call set_span(values(n), tube, spans(n))
         speeds(n)%bounded = speeds(n)%bounded .and. abs(per) > 0.0_wp .and. has_rate(closure%sketch, outputs, n)
         speeds(n)%c = speeds(n)%c*per
         speeds(n)%error = speeds(n)%error*abs(per)
         if (speeds(n)%bounded) call set_span(speeds(n), tube, spans(size(values) + n))
      end do
   end subroutine find_spans

   !> The range of a quadratic with what it leaves out, over a tube.
   pure subroutine set_span(q, tube, span)
      type(quadratic_t), intent(in) :: q
      type(tube_t), intent(in) :: tube
      type(tube_span_t), intent(inout) :: span
      real(wp) :: at(3), y
      integer :: i

      span%bounded = .true.
      span%value = q%c(0)
      at = [-tube%r, tube%r, tube%r]
      if (abs(q%c(1)) < 2.0_wp*tube%r*abs(q%c(2))) at(3) = -0.5_wp*q%c(1)/q%c(2)
      span%low = huge(1.0_wp)
      span%high = -huge(1.0_wp)
      do i = 1, 3
         y = q%c(0) + at(i)*(q%c(1) + at(i)*q%c(2))
         if (y < span%low) span%low_at = tube%middle + at(i)
         span%low = min(span%low, y)
         if (y > span%high) span%high_at = tube%middle + at(i)
         span%high = max(span%high, y)
      end do
      span%low = span%low - q%error
      span%high = span%high + q%error
      span%open = 2.0_wp*q%error
   end subroutine set_span

   !> Brackets of the least and greatest value of every number over all tubes, which are halved where that helps.
   subroutine bracket_outputs(closure, outputs, per, tubes, ranges, speeds)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      real(wp), intent(in) :: per                !! unit of the input: 1 radian, or a length like those of the drawing; 0: no rates
      type(chain_tubes_t), intent(inout) :: tubes
      type(output_range_t), allocatable, intent(out) :: ranges(:) !! shape (numbers of all outputs)
      type(output_range_t), allocatable, intent(out) :: speeds(:) !! the same of their rates by the input
      type(output_range_t), allocatable :: all_ranges(:)

      allocate (ranges(0), speeds(0))
      if (tubes%count == 0) return
      allocate (all_ranges(size(tubes%parts(1)%spans)))
      call bracket_all(closure, outputs, per, tubes, all_ranges)
      ranges = all_ranges(:size(all_ranges)/2)
      speeds = all_ranges(size(all_ranges)/2 + 1:)
   end subroutine bracket_outputs

   subroutine bracket_all(closure, outputs, per, tubes, ranges)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      real(wp), intent(in) :: per
      type(chain_tubes_t), intent(inout) :: tubes
      type(output_range_t), intent(inout) :: ranges(:) !! shape (numbers of all outputs, then their rates)
      real(wp) :: unit
      integer :: n, halvings, allowed, at
      logical :: done

      halvings = 0
      allowed = most_halvings
      do n = 1, size(ranges)
         if (n > size(ranges)/2 .and. .not. per > 0.0_wp) exit
         if (n > size(ranges)/2) allowed = halvings + most_of_rate
         call make_bounded(n, ranges(n)%bounded)
         if (.not. ranges(n)%bounded) cycle
         if (n <= size(ranges)/2) then
            unit = merge(degrees_per_radian, closure%size, is_angle(outputs, n))
         else
            unit = merge(1.0_wp, closure%size, is_angle(outputs, n - size(ranges)/2))/per
         end if
         do
            call greatest(n, -1.0_wp, ranges(n)%low(1), ranges(n)%high(1), at)
            ranges(n)%segment(1) = tubes%parts(at)%segment
            ranges(n)%way(1) = tubes%parts(at)%spans(n)%low_at
            if (ranges(n)%high(1) - ranges(n)%low(1) <= enough*unit) exit
            call split(at, n, done)
            if (done) exit
         end do
         do
            call greatest(n, 1.0_wp, ranges(n)%low(2), ranges(n)%high(2), at)
            ranges(n)%segment(2) = tubes%parts(at)%segment
            ranges(n)%way(2) = tubes%parts(at)%spans(n)%high_at
            if (ranges(n)%high(2) - ranges(n)%low(2) <= enough*unit) exit
            call split(at, n, done)
            if (done) exit
         end do
      end do

   contains

      !> Halve tubes in which a number is not bounded; of a ratio one of them may be too long.
      subroutine make_bounded(number, bounded)
         integer, intent(in) :: number
         logical, intent(out) :: bounded
         integer :: i, try
         logical :: done

         do try = 0, tries
            bounded = .true.
            do i = 1, tubes%count
               bounded = tubes%parts(i)%spans(number)%bounded
               if (.not. bounded) exit
            end do
            if (bounded .or. number > size(ranges)/2 .or. try == tries) return
            call split(i, number, done)
            if (done) return
         end do
      end subroutine make_bounded

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
      subroutine split(at, number, done)
         integer, intent(in) :: at
         integer, intent(in) :: number           !! what is bracketed
         logical, intent(out) :: done
         type(tube_part_t) :: whole
         type(tube_t) :: halves(2)
         integer :: i, n

         whole = tubes%parts(at)
         halvings = halvings + 1
         done = halvings > allowed .or. whole%tube%r < least_r
         if (done) return
         call half_of(closure, whole%tube, -1, halves(1))
         call half_of(closure, whole%tube, 1, halves(2))
         done = .not. (halves(1)%holds .and. halves(2)%holds)
         if (done) return
         do i = 1, 2
            call add_part(closure, outputs, 0, whole%per, halves(i), tubes)
            do n = 1, size(whole%spans)/2
               if (is_angle(outputs, n)) call move_to(tubes%parts(tubes%count)%spans(n), whole%spans(n)%value)
            end do
            tubes%parts(tubes%count)%segment = whole%segment
            ! what is open falls like the third power of the width, until roundings are left
            associate (half => tubes%parts(tubes%count)%spans(number))
               done = half%bounded .and. half%open > 0.5_wp*whole%spans(number)%open
            end associate
         end do
         tubes%parts(at) = tubes%parts(tubes%count)
         tubes%count = tubes%count - 1
      end subroutine split
   end subroutine bracket_all
end module psalm_proof_chain
