!> How things move, proven: all dead points of links and slides, and of the output its velocity ratio, swing, time ratio and dwells.
!>
!> A dead point is a root of a rate: where none is bracketed there is none. Between two of them a direction turns one way, so its
!> extremes lie there or at the ends of the range. All in the working precision.
module psalm_proof_motion
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_dyad_kind, only: assur_rrr
   use psalm_kinds, only: wp, full_turn, degrees_per_radian, right_angle
   use psalm_output_kind, only: motion_angle, motion_distance, motion_slide, motion_pose
   use psalm_plan, only: root_frame, root_crank
   use psalm_proof, only: proof_t, proof_linkage_t, piece_closes, piece_undecided
   use psalm_proof_plan, only: proof_plan_t
   use psalm_proof_quantity, only: quantity_t, quantity_measure
   use psalm_proof_rate_extremes, only: place_t, greatest_t, find_greatest
   use psalm_proof_rates, only: rate_models_t, signal_t, prepare_rates, choose_signals, evaluate_rates, signal_turn, signal_slide, &
                                signal_away, signal_turn_sign, signal_slide_sign, signal_square, signal_depart, &
                                signal_turned_by, signal_turned_less, signal_longer, signal_farther, unbounded
   use psalm_proof_signs, only: piece_t, find_pieces
   use psalm_stop, only: stop_t, is_to_end
   use psalm_taylor, only: lanes
   implicit none (type, external)
   private
   public :: movement_t, proven_dead_point_t, bracket_t, prove_movement, time_ratio_of, &
             quantity_output, quantity_turning, quantity_sliding

   integer, parameter :: quantity_output = 1   !! the output itself
   integer, parameter :: quantity_turning = 2  !! a link, its direction
   integer, parameter :: quantity_sliding = 3  !! a slide, its length

   integer, parameter :: first_boxes = 8, most_boxes = 4000, most_points = 4000
   real(wp), parameter :: enough = 1.0e-12_wp  !! width of a bracket of a rate
   real(wp), parameter :: quarter = 1.5_wp     !! radians that a direction may turn between two points looked at
   real(wp), parameter :: rounding = 16.0_wp*epsilon(1.0_wp)

   !> A bracket of a value, and an input where it is taken.
   type :: bracket_t
      real(wp) :: low = 0.0_wp, high = 0.0_wp, at = 0.0_wp
   end type bracket_t

   !> An input at which something stands still for an instant.
   type :: proven_dead_point_t
      integer :: kind = quantity_output
      integer :: loop = 0, place = 0       !! of a link: loop and number in the loop
      real(wp) :: low = 0.0_wp, high = 0.0_wp !! bracket of the input
      logical :: reverses = .true.         !! false: it may stand still there, or not, but does not turn back
      logical :: at_end = .false.          !! at an end of the range: whether it turns back is not known
   end type proven_dead_point_t

   !> Inputs between which the output stays within an amount of its value at a dead point.
   type :: dwell_t
      real(wp) :: from = 0.0_wp, to = 0.0_wp !! proven; over 360: through the end of the turn
      real(wp) :: slack = 0.0_wp            !! it goes on for less than this at either end
      real(wp) :: at = 0.0_wp              !! the dead point
   end type dwell_t

   type :: movement_t
      type(proven_dead_point_t), allocatable :: dead(:) !! by what moves, in the order of the input
      logical :: has_ratio = .false.       !! velocity ratio: rate of the output by the input, radians or lengths
      type(bracket_t) :: ratio(2)             !! least and greatest
      logical :: ratio_bounded = .false.
      logical :: has_output = .false.      !! extremes of the output: angle in degrees, or distance
      logical :: is_angle = .false., turns_fully = .false.
      type(bracket_t) :: output(2)            !! least and greatest; an angle goes on beyond 360
      logical :: has_time_ratio = .false.
      real(wp) :: time_ratio = 0.0_wp      !! lower bound of the crank angle of the slower stroke over that of the faster one
      type(dwell_t), allocatable :: dwells(:)
   end type movement_t

   !> What the search works with.
   type :: proof_models_t
      type(proof_plan_t) :: plan           !! every direction wanted
      type(rate_models_t) :: models
   end type proof_models_t

contains

   !> Everything over what closes. What the host ends is not whole and of no use.
   subroutine prove_movement(linkage, proof, dwell, movement, stop)
      type(proof_linkage_t), intent(in) :: linkage          !! bound, of the same proof
      type(proof_t), intent(in) :: proof
      real(wp), intent(in) :: dwell                   !! amount of a dwell, degrees or length; 0: none are looked for
      type(movement_t), intent(out) :: movement
      type(stop_t), intent(in), optional :: stop      !! asked before each quantity
      type(proof_models_t) :: moving
      type(signal_t) :: rate, sign
      type(proven_dead_point_t), allocatable :: own(:)
      integer :: k
      logical :: moves

      allocate (movement%dead(0), movement%dwells(0))
      if (.not. any(proof%limits%kind == piece_closes)) return
      ! a link without length has no direction
      do k = 1, size(linkage%plan%steps)
         associate (step => linkage%plan%steps(k))
            if (step%dyad .and. step%kind == assur_rrr) then
               if (min(linkage%numbers%length(step%p), linkage%numbers%length(step%q)) <= 0.0_wp) return
            end if
         end associate
      end do
      moving%plan = linkage%plan
      do k = 1, size(moving%plan%steps)
         moving%plan%steps(k)%wants = .true.
      end do
      call prepare_rates(moving%plan, linkage%numbers, moving%models)
      call find_output(linkage, rate, sign, moves)
      if (moves) then
         call find_dead_points(linkage, proof, moving, sign, quantity_output, 0, 0, own)
         movement%dead = own
         if (is_to_end(stop)) return
         call find_ratio(linkage, proof, moving, rate, movement)
         if (is_to_end(stop)) return
         if (linkage%output_motion == motion_distance) call find_distance(linkage, proof, moving, movement)
         if (rate%kind == signal_turn) call follow_angle(linkage, proof, moving, rate%which, own, movement)
         call find_time_ratio(proof, own, movement)
         if (dwell > 0.0_wp) call find_dwells(linkage, proof, moving, rate, own, dwell, movement)
      end if
      do k = 1, size(linkage%plan%steps)
         associate (step => linkage%plan%steps(k))
            if (.not. step%dyad) cycle
            if (is_to_end(stop)) return
            call add_link(step%p, step%loop, step%places(1))
            if (linkage%plan%root(step%q) /= linkage%plan%root(step%p)) then
               call add_link(step%q, step%loop, step%places(2))
            else if (linkage%plan%slot(step%q) > 0) then
               call add_slide(step%q, step%loop, step%places(2))
            end if
         end associate
      end do

   contains

      !> Dead points of an arc that a dyad has found the direction or the length of.
      subroutine add_link(arc, loop, place)
         integer, intent(in) :: arc, loop, place
         integer :: i

         associate (plan => linkage%plan)
            if (plan%slot(arc) > 0) call add_slide(arc, loop, place)
            ! the direction of a slide may be that of another link
            do i = 1, size(plan%steps)
               if (.not. plan%steps(i)%dyad .or. plan%steps(i)%loop == loop) cycle
               if (plan%root(arc) == plan%root(plan%steps(i)%p) .or. plan%root(arc) == plan%root(plan%steps(i)%q)) then
                  if (plan%slot(arc) > 0) return
               end if
            end do
            if (plan%root(arc) == root_frame .or. plan%root(arc) == root_crank) return
            sign = signal_t(signal_turn_sign, plan%root(arc))
            call find_dead_points(linkage, proof, moving, sign, quantity_turning, loop, place, own)
            movement%dead = [movement%dead, own]
         end associate
      end subroutine add_link

      subroutine add_slide(arc, loop, place)
         integer, intent(in) :: arc, loop, place

         sign = signal_t(signal_slide_sign, linkage%plan%slot(arc))
         call find_dead_points(linkage, proof, moving, sign, quantity_sliding, loop, place, own)
         movement%dead = [movement%dead, own]
      end subroutine add_slide
   end subroutine prove_movement

   !> The rate of the output, and what has its sign.
   pure subroutine find_output(linkage, rate, sign, moves)
      type(proof_linkage_t), intent(in) :: linkage
      type(signal_t), intent(out) :: rate, sign
      logical, intent(out) :: moves

      moves = .true.
      select case (linkage%output_motion)
      case (motion_angle, motion_pose)
         associate (root => linkage%plan%root(linkage%output_arc))
            rate = signal_t(signal_turn, root)
            sign = signal_t(signal_turn_sign, root)
            moves = root /= root_frame .and. root /= root_crank
         end associate
      case (motion_slide)
         associate (slot => linkage%plan%slot(linkage%output_arc))
            rate = signal_t(signal_slide, slot)
            sign = signal_t(signal_slide_sign, slot)
            moves = slot > 0 .and. .not. (linkage%plan%sliding_input .and. slot == linkage%plan%input_slot)
         end associate
      case (motion_distance)
         rate%kind = signal_depart
         rate%path = linkage%output_path
         sign%kind = signal_away
         sign%path = linkage%output_path
      case default
         moves = .false.
      end select
   end subroutine find_output

   !> Every input at which a signal vanishes, bracketed.
   subroutine find_dead_points(linkage, proof, moving, sign, kind, loop, place, dead)
      type(proof_linkage_t), intent(in) :: linkage
      type(proof_t), intent(in) :: proof
      type(proof_models_t), intent(inout) :: moving
      type(signal_t), intent(in) :: sign
      integer, intent(in) :: kind, loop, place
      type(proven_dead_point_t), allocatable, intent(out) :: dead(:)
      type(piece_t), allocatable :: pieces(:)
      type(proven_dead_point_t) :: point
      integer :: i, k, boxes, before, first
      logical :: joined

      allocate (dead(0))
      call choose_signals([sign], moving%models)
      point%kind = kind
      point%loop = loop
      point%place = place
      joined = wraps(proof)
      first = 0
      do i = 1, size(proof%limits)
         if (proof%limits(i)%kind /= piece_closes) cycle
         call find_pieces(moving%plan, linkage%numbers, proof%limits(i)%from, proof%limits(i)%to, first_boxes, most_boxes, &
                          moving%models, pieces, boxes)
         do k = 1, size(pieces)
            if (pieces(k)%kind /= piece_undecided) cycle
            point%low = pieces(k)%from
            point%high = pieces(k)%to
            point%reverses = .false.
            point%at_end = k == 1 .or. k == size(pieces)
            if (.not. point%at_end) point%reverses = pieces(k - 1)%kind /= pieces(k + 1)%kind
            dead = [dead, point]
         end do
         if (.not. joined) cycle
         ! a bracket at the end of a turn goes on at its beginning
         if (i == 1) then
            first = pieces(1)%kind
            if (first == piece_undecided .and. size(pieces) > 1) first = pieces(2)%kind
         end if
         if (i < size(proof%limits)) cycle
         before = pieces(size(pieces))%kind
         if (before == piece_undecided .and. size(pieces) > 1) before = pieces(size(pieces) - 1)%kind
         if (size(dead) < 1 .or. first == piece_undecided .or. before == piece_undecided) cycle
         if (dead(1)%low > proof%from .and. dead(size(dead))%high < proof%to) cycle
         if (size(dead) > 1 .and. dead(1)%low <= proof%from) then
            if (dead(size(dead))%high >= proof%to) dead = dead(2:)
         end if
         associate (at_end => dead(merge(size(dead), 1, dead(size(dead))%high >= proof%to)))
            at_end%reverses = first /= before
            at_end%at_end = .false.
         end associate
      end do
   end subroutine find_dead_points

   !> True if the range is a full turn that closes at its ends.
   pure logical function wraps(proof)
      type(proof_t), intent(in) :: proof

      wraps = proof%turns .and. proof%to - proof%from >= full_turn .and. proof%limits(1)%kind == piece_closes .and. &
              proof%limits(size(proof%limits))%kind == piece_closes
   end function wraps

   !> Least and greatest value of a signal over what closes, in the unit of the models.
   subroutine bracket_signal(linkage, proof, moving, signal, spans, bounded)
      type(proof_linkage_t), intent(in) :: linkage
      type(proof_t), intent(in) :: proof
      type(proof_models_t), intent(inout) :: moving
      type(signal_t), intent(in) :: signal
      type(bracket_t), intent(out) :: spans(2)
      logical, intent(out) :: bounded
      type(place_t), allocatable :: places(:)
      type(greatest_t) :: greatest(2)
      type(quantity_t) :: quantities(2)
      integer :: i, k, boxes

      call choose_signals([signal], moving%models)
      quantities%kind = quantity_measure
      quantities%which = 1
      quantities%sense = [-1, 1]
      allocate (places(first_boxes*count(proof%limits%kind == piece_closes)))
      k = 0
      do i = 1, size(proof%limits)
         associate (limit => proof%limits(i))
            if (limit%kind /= piece_closes) cycle
            places(k + 1:k + first_boxes)%from = limit%from + (limit%to - limit%from)*[(real(boxes, wp)/real(first_boxes, wp), &
                                                                                       boxes=0, first_boxes - 1)]
            places(k + 1:k + first_boxes - 1)%to = places(k + 2:k + first_boxes)%from
            places(k + first_boxes)%to = limit%to
            k = k + first_boxes
         end associate
      end do
      call find_greatest(moving%plan, linkage%numbers, quantities, enough, most_boxes, moving%models, places, greatest, boxes)
      spans(1) = bracket_t(-greatest(1)%high, -greatest(1)%low, greatest(1)%at)
      spans(2) = bracket_t(greatest(2)%low, greatest(2)%high, greatest(2)%at)
      bounded = all(greatest%found) .and. greatest(1)%high < unbounded .and. greatest(2)%high < unbounded
   end subroutine bracket_signal

   !> Velocity ratio.
   subroutine find_ratio(linkage, proof, moving, rate, movement)
      type(proof_linkage_t), intent(in) :: linkage
      type(proof_t), intent(in) :: proof
      type(proof_models_t), intent(inout) :: moving
      type(signal_t), intent(in) :: rate
      type(movement_t), intent(inout) :: movement

      call bracket_signal(linkage, proof, moving, rate, movement%ratio, movement%ratio_bounded)
      movement%has_ratio = .true.
      if (rate%kind == signal_turn) return
      movement%ratio%low = movement%ratio%low/linkage%numbers%scale
      movement%ratio%high = movement%ratio%high/linkage%numbers%scale
   end subroutine find_ratio

   !> Extremes of the distance of the output point from the origin.
   subroutine find_distance(linkage, proof, moving, movement)
      type(proof_linkage_t), intent(in) :: linkage
      type(proof_t), intent(in) :: proof
      type(proof_models_t), intent(inout) :: moving
      type(movement_t), intent(inout) :: movement
      type(signal_t) :: square
      logical :: bounded

      square%kind = signal_square
      square%path = linkage%output_path
      call bracket_signal(linkage, proof, moving, square, movement%output, bounded)
      movement%output%low = sqrt(max(movement%output%low, 0.0_wp))*(1.0_wp - rounding)/linkage%numbers%scale
      movement%output%high = sqrt(max(movement%output%high, 0.0_wp))*(1.0_wp + rounding)/linkage%numbers%scale
      movement%has_output = bounded
   end subroutine find_distance

   !> Extremes of an angle: followed from dead point to dead point, so that it may go on beyond a turn.
   subroutine follow_angle(linkage, proof, moving, root, dead, movement)
      type(proof_linkage_t), intent(in) :: linkage
      type(proof_t), intent(in) :: proof
      type(proof_models_t), intent(inout) :: moving
      integer, intent(in) :: root
      type(proven_dead_point_t), intent(in) :: dead(:)
      type(movement_t), intent(inout) :: movement
      real(wp), allocatable :: critical(:), half(:), inputs(:), spread(:), angle(:), error(:)
      real(wp) :: fastest, per, shift
      integer :: i, j, k, n, steps

      movement%is_angle = .true.
      if (count(proof%limits%kind == piece_closes) /= 1 .or. .not. movement%ratio_bounded) return
      i = findloc(proof%limits%kind, piece_closes, dim=1)
      critical = [proof%limits(i)%from, 0.5_wp*(dead%low + dead%high), proof%limits(i)%to]
      half = [0.0_wp, 0.5_wp*(dead%high - dead%low), 0.0_wp]
      fastest = max(-movement%ratio(1)%low, movement%ratio(2)%high)
      per = merge(degrees_per_radian, 1.0_wp, proof%turns) ! of the input, for which the fastest rate holds
      if (fastest*(proof%limits(i)%to - proof%limits(i)%from)/per > quarter*real(most_points, wp)) return
      allocate (inputs(0), spread(0))
      do k = 1, size(critical) - 1
         steps = 1 + int(fastest*(critical(k + 1) - critical(k))/(per*quarter))
         inputs = [inputs, critical(k), [(critical(k) + (critical(k + 1) - critical(k))*(real(j, wp)/real(steps, wp)), &
                                          j=1, steps - 1)]]
         spread = [spread, half(k), [(-1.0_wp, j=1, steps - 1)]]
      end do
      n = size(inputs) + 1
      inputs = [inputs, critical(size(critical))]
      spread = [spread, 0.0_wp]
      allocate (angle(n), error(n))
      call find_angles(linkage, moving, root, inputs, angle, error)
      if (any(error >= 1.0_wp)) return
      do k = 2, n
         angle(k) = angle(k) - full_turn*anint((angle(k) - angle(k - 1))/full_turn)
      end do
      movement%turns_fully = wraps(proof) .and. abs(angle(n) - angle(1)) > right_angle
      movement%has_output = .true.
      if (movement%turns_fully) return
      error = (error + fastest*max(spread, 0.0_wp)/per)*degrees_per_radian*(1.0_wp + rounding) + rounding*(abs(angle) + full_turn)
      movement%output(1) = bracket_t(huge(1.0_wp), huge(1.0_wp), 0.0_wp)
      movement%output(2) = bracket_t(-huge(1.0_wp), -huge(1.0_wp), 0.0_wp)
      do k = 1, n
         if (spread(k) < 0.0_wp) cycle
         associate (least => movement%output(1), greatest => movement%output(2))
            if (angle(k) + error(k) < least%high) least%at = inputs(k)
            least%high = min(least%high, angle(k) + error(k))
            least%low = min(least%low, angle(k) - error(k))
            if (angle(k) - error(k) > greatest%low) greatest%at = inputs(k)
            greatest%low = max(greatest%low, angle(k) - error(k))
            greatest%high = max(greatest%high, angle(k) + error(k))
         end associate
      end do
      shift = full_turn*real(floor(movement%output(1)%high/full_turn), wp)
      movement%output%low = movement%output%low - shift
      movement%output%high = movement%output%high - shift
   end subroutine follow_angle

   !> Angles of the output at some inputs, -180 to 180 degrees, and by how much they may be wrong, radians.
   subroutine find_angles(linkage, moving, root, inputs, angle, error)
      type(proof_linkage_t), intent(in) :: linkage
      type(proof_models_t), intent(inout) :: moving
      integer, intent(in) :: root
      real(wp), intent(in) :: inputs(:)
      real(wp), intent(out) :: angle(:), error(:)
      real(wp) :: m(lanes), r(lanes), x, y
      integer :: k, i

      r = 0.0_wp
      associate (c => linkage%output_x, s => linkage%output_y)
         do k = 1, size(inputs), lanes
            do i = 1, lanes
               m(i) = inputs(min(k + i - 1, size(inputs)))
            end do
            call evaluate_rates(moving%plan, linkage%numbers, m, r, moving%models)
            do i = 1, min(lanes, size(inputs) - k + 1)
               x = moving%models%base%root(i, 0, 1, root)
               y = moving%models%base%root(i, 0, 2, root)
               angle(k + i - 1) = degrees_of(c*x - s*y, s*x + c*y)
               ! a chord below half of the radius is at most a twentieth shorter than its arc
               error(k + i - 1) = min(1.1_wp*(moving%models%base%root_e(i, root) + rounding), 2.0_wp)
               if (error(k + i - 1) > 0.5_wp) error(k + i - 1) = 2.0_wp
            end do
         end do
      end associate
   end subroutine find_angles

   !> Crank angle of the slower stroke over that of the faster one, of an output with two strokes.
   pure subroutine find_time_ratio(proof, dead, movement)
      type(proof_t), intent(in) :: proof
      type(proven_dead_point_t), intent(in) :: dead(:)
      type(movement_t), intent(inout) :: movement

      if (.not. proof%turns .or. .not. proof%closes_everywhere() .or. proof%to - proof%from < full_turn) return
      movement%time_ratio = time_ratio_of(dead)
      movement%has_time_ratio = movement%time_ratio > 0.0_wp
   end subroutine find_time_ratio

   !> A lower bound of that ratio, from all dead points in a full turn; 0: there are not two strokes.
   pure real(wp) function time_ratio_of(dead) result(ratio)
      type(proven_dead_point_t), intent(in) :: dead(:)
      real(wp) :: low, high

      ratio = 0.0_wp
      if (size(dead) /= 2) return
      if (.not. all(dead%reverses)) return
      low = (dead(2)%low - dead(1)%high)*(1.0_wp - rounding)
      high = (dead(2)%high - dead(1)%low)*(1.0_wp + rounding)
      if (low + high > full_turn) then
         ratio = low/(full_turn - low)*(1.0_wp - rounding)
      else
         ratio = (full_turn - high)/high*(1.0_wp - rounding)
      end if
      ratio = max(ratio, 1.0_wp)
   end function time_ratio_of

   !> Round each dead point of the output the inputs over which the output stays within an amount of its value there.
   subroutine find_dwells(linkage, proof, moving, rate, dead, amount, movement)
      type(proof_linkage_t), intent(in) :: linkage
      type(proof_t), intent(in) :: proof
      type(proof_models_t), intent(inout) :: moving
      type(signal_t), intent(in) :: rate
      type(proven_dead_point_t), intent(in) :: dead(:)
      real(wp), intent(in) :: amount
      type(movement_t), intent(inout) :: movement
      type(signal_t), allocatable :: signals(:)
      type(piece_t), allocatable :: pieces(:)
      type(dwell_t) :: dwell
      integer :: d, i, k, boxes, last
      logical :: held

      do d = 1, size(dead)
         if (dead(d)%high - dead(d)%low > 1.0e-6_wp) cycle
         call refer_to(linkage, moving, rate, dead(d), movement, amount, signals)
         if (size(signals) == 0) cycle
         call choose_signals(signals, moving%models)
         do i = 1, size(proof%limits)
            associate (limit => proof%limits(i))
               if (limit%kind /= piece_closes .or. dead(d)%high < limit%from .or. dead(d)%low > limit%to) cycle
               call find_pieces(moving%plan, linkage%numbers, limit%from, limit%to, first_boxes, most_boxes, &
                                moving%models, pieces, &
                                boxes)
               last = size(pieces)
               do k = 1, last
                  if (pieces(k)%kind /= piece_closes) cycle
                  if (pieces(k)%from > dead(d)%high .or. pieces(k)%to < dead(d)%low) cycle
                  dwell%from = pieces(k)%from
                  dwell%to = pieces(k)%to
                  dwell%at = 0.5_wp*(dead(d)%low + dead(d)%high)
                  dwell%slack = 0.0_wp
                  if (k > 1) dwell%slack = pieces(k - 1)%to - pieces(k - 1)%from
                  if (k < last) dwell%slack = max(dwell%slack, pieces(k + 1)%to - pieces(k + 1)%from)
                  if (wraps(proof) .and. k == last .and. k > 1 .and. pieces(1)%kind == piece_closes .and. &
                      i == size(proof%limits) .and. i == 1) dwell%to = pieces(1)%to + full_turn
                  if (wraps(proof) .and. k == 1 .and. last > 1 .and. pieces(last)%kind == piece_closes .and. &
                      i == size(proof%limits) .and. i == 1) then
                     dwell%to = dwell%to + full_turn
                     dwell%from = pieces(last)%from
                  end if
                  held = any(abs(movement%dwells%from - dwell%from) <= 0.0_wp .and. &
                             abs(movement%dwells%to - dwell%to) <= 0.0_wp)
                  if (.not. held) movement%dwells = [movement%dwells, dwell]
               end do
            end associate
         end do
      end do
   end subroutine find_dwells

   !> Signals that are positive where the output is within an amount of its value at a dead point.
   subroutine refer_to(linkage, moving, rate, dead, movement, amount, signals)
      type(proof_linkage_t), intent(in) :: linkage
      type(proof_models_t), intent(inout) :: moving
      type(signal_t), intent(in) :: rate
      type(proven_dead_point_t), intent(in) :: dead
      type(movement_t), intent(in) :: movement
      real(wp), intent(in) :: amount
      type(signal_t), allocatable, intent(out) :: signals(:)
      type(signal_t) :: each
      real(wp) :: m(lanes), r(lanes), cosine, sine
      integer :: k

      allocate (signals(0))
      m = 0.5_wp*(dead%low + dead%high)
      r = max(dead%high - m, m - dead%low)*(1.0_wp + rounding)
      select case (rate%kind)
      case (signal_turn)
         if (amount >= right_angle) return
         call evaluate_rates(moving%plan, linkage%numbers, m, r, moving%models)
         call take_direction()
         call unit_vector(amount, cosine, sine)
         each%which = rate%which
         each%amount = sine
         each%kind = signal_turned_by
         signals = [each, each, each]
         signals(2)%sense = -1.0_wp
         signals(3)%kind = signal_turned_less
      case (signal_slide)
         call evaluate_rates(moving%plan, linkage%numbers, m, r, moving%models)
         each%which = rate%which
         each%kind = signal_longer
         each%reference(1) = moving%models%base%slide(1, 0, rate%which)
         each%doubt = sum(abs(moving%models%base%slide(1, 1:, rate%which))) + moving%models%base%slide_e(1, rate%which)
         each%amount = amount*linkage%numbers%scale
         signals = [each, each]
         signals(2)%sense = -1.0_wp
      case default
         if (.not. movement%has_output) return
         each%kind = signal_square
         each%path = linkage%output_path
         call choose_signals([each], moving%models)
         call evaluate_rates(moving%plan, linkage%numbers, m, r, moving%models)
         if (moving%models%low(1, 1) <= 0.0_wp) return
         each%kind = signal_farther
         each%reference(1) = sqrt(moving%models%g(1, 0, 1))
         each%doubt = (moving%models%high(1, 1) - moving%models%low(1, 1))/sqrt(moving%models%low(1, 1)) &
                      + rounding*each%reference(1)
         each%amount = amount*linkage%numbers%scale
         signals = [each, each]
         signals(2)%sense = -1.0_wp
      end select

   contains

      subroutine take_direction()
         associate (root => moving%models%base%root(1, :, :, rate%which))
            each%reference = [moving%models%base%root(1, 0, 1, rate%which), moving%models%base%root(1, 0, 2, rate%which)]
            each%doubt = moving%models%base%root_e(1, rate%which)
            do k = 1, ubound(moving%models%base%root, 2)
               each%doubt = each%doubt + abs(root(k + 1, 1)) + abs(root(k + 1, 2))
            end do
         end associate
      end subroutine take_direction
   end subroutine refer_to
end module psalm_proof_motion
