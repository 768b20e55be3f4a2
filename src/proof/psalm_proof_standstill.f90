!> Where outputs, links and slides of a sketch stand still for an instant, and where an output dwells, proven over tubes.
!>
!> In a tube a rate is a quadratic with a bound of what that leaves out (`psalm_proof_numbers`): but for two short parts at most its
!> sign is known. These are enclosed by shorter tubes, where less is left out, until rounding is all that is left. What remains
!> are brackets of the dead points: elsewhere there is none. Within a bracket neither their number nor their order is claimed.
module psalm_proof_standstill
   use psalm_closure, only: closure_t, row_angle, row_turn
   use psalm_kinds, only: wp, full_turn, right_angle
   use psalm_proof_chain, only: chain_tubes_t
   use psalm_proof_motion, only: proven_dead_point_t, quantity_output, quantity_turning, quantity_sliding, time_ratio_of
   use psalm_proof_numbers, only: quadratic_t, find_numbers, rate_of_link, rate_of_slide, is_angle, has_rate
   use psalm_proof_tube, only: tube_t, part_of, rounding
   use psalm_sketch, only: sketch_output_t, frame_link, drive_slides
   implicit none (type, external)
   private
   public :: chain_way_t, chain_movement_t, prove_standstill

   integer, parameter :: is_positive = 1, is_negative = -1, is_undecided = 0
   integer, parameter :: most_enclosures = 400     !! for the dead points of one quantity
   integer, parameter :: most_cuts = 10            !! of two quadratics and their bounds, and both ends
   real(wp), parameter :: narrow = 1.0e-15_wp      !! of a segment: shorter parts are not enclosed
   real(wp), parameter :: gain_enough = 0.5_wp     !! a shorter tube must leave out less than this part
   real(wp), parameter :: at_rest = 1.0e-9_wp      !! of the fastest: what is slower everywhere is not looked at more closely
   real(wp), parameter :: one_place = 1.0e-8_wp    !! of a segment: brackets below it have one value of the output

   !> How parts of the way of a segment are reported: base + gain*way. Segments of one run follow each other.
   type :: chain_way_t
      real(wp) :: base = 0.0_wp, gain = 1.0_wp
      integer :: run = 1
   end type chain_way_t

   !> Places between which an output stays within an amount of its value at a dead point.
   type :: chain_dwell_t
      integer :: number = 0
      real(wp) :: from = 0.0_wp, to = 0.0_wp       !! proven; over 360: through the end of the turn
      real(wp) :: at = 0.0_wp                      !! the dead point
   end type chain_dwell_t

   type :: chain_movement_t
      type(proven_dead_point_t), allocatable :: dead(:) !! loop 0; place: number of all outputs, link or slide
      type(chain_dwell_t), allocatable :: dwells(:)
      real(wp), allocatable :: time_ratio(:)       !! by number: lower bound, as of `movement_t`; 0: none
      logical, allocatable :: turns_fully(:)       !! by number: an angle that goes on and on
   end type chain_movement_t

   !> What is to be positive.
   type :: chain_signal_t
      integer :: quantity = 0                         !! of a rate: `quantity_...`; 0: an output within `amount` of `reference`
      integer :: which = 0
      real(wp) :: reference = 0.0_wp, amount = 0.0_wp
   end type chain_signal_t

   !> A part of a run where the sign is one.
   type :: signed_piece_t
      real(wp) :: from = 0.0_wp, to = 0.0_wp
      integer :: kind = is_undecided
      integer :: run = 1
   end type signed_piece_t

   !> A search for signs.
   type :: sign_search_t
      type(chain_signal_t) :: signal
      type(signed_piece_t), allocatable :: pieces(:)      !! the first `count` are used
      integer :: count = 0
      integer :: left = 0                          !! tubes that may still be made
      real(wp) :: size = 0.0_wp                    !! of the numbers by which places are reported
   end type sign_search_t

contains

   !> Everything over what the tubes cover.
   subroutine prove_standstill(closure, outputs, tubes, ways, closed_turn, amount, movement)
      type(closure_t), intent(in) :: closure       !! of the tubes
      type(sketch_output_t), intent(in) :: outputs(:)
      type(chain_tubes_t), intent(in) :: tubes
      type(chain_way_t), intent(in) :: ways(:)     !! by segment
      logical, intent(in) :: closed_turn           !! a full turn, after which everything stands as before
      real(wp), intent(in) :: amount               !! of a dwell, degrees or length; 0: none are looked for
      type(chain_movement_t), intent(out) :: movement
      type(proven_dead_point_t), allocatable :: own(:)
      integer, allocatable :: turning(:)
      real(wp) :: fastest
      integer :: n, k

      allocate (movement%dead(0), movement%dwells(0))
      n = 0
      if (tubes%count > 0) n = size(tubes%parts(1)%spans)/2
      allocate (movement%time_ratio(n), source=0.0_wp)
      allocate (movement%turns_fully(n), source=.false.)
      if (tubes%count == 0) return
      fastest = fastest_of(closure, tubes)
      do k = 1, n
         if (.not. has_rate(closure%sketch, outputs, k)) cycle
         call find_dead(chain_signal_t(quantity_output, k), merge(fastest, fastest*closure%size, is_angle(outputs, k)), own)
         movement%dead = [movement%dead, own]
         if (closed_turn) movement%time_ratio(k) = time_ratio_of(own)
         if (closed_turn .and. is_angle(outputs, k)) movement%turns_fully(k) = goes_round(k)
         if (amount > 0.0_wp .and. .not. (is_angle(outputs, k) .and. amount >= right_angle)) call find_dwells(k, own)
      end do
      turning = turning_links(closure)
      do k = 1, size(turning)
         call find_dead(chain_signal_t(quantity_turning, turning(k)), fastest, own)
         movement%dead = [movement%dead, own]
      end do
      do k = 1, size(closure%sketch%slides)
         if (any(closure%sketch%drives%kind == drive_slides .and. closure%sketch%drives%slide == k)) cycle
         call find_dead(chain_signal_t(quantity_sliding, k), fastest*closure%size, own)
         movement%dead = [movement%dead, own]
      end do

   contains

      !> Brackets of all places where a rate vanishes.
      subroutine find_dead(signal, unit, dead)
         type(chain_signal_t), intent(in) :: signal
         real(wp), intent(in) :: unit              !! the fastest rate that anything of the kind may have
         type(proven_dead_point_t), allocatable, intent(out) :: dead(:)
         type(sign_search_t) :: search
         type(proven_dead_point_t) :: point
         integer :: i, first, last

         search%signal = signal
         search%left = merge(most_enclosures, 0, rate_of(signal) > at_rest*unit)
         call find_pieces(search)
         allocate (dead(0))
         point%kind = signal%quantity
         point%place = signal%which
         associate (pieces => search%pieces)
            do i = 1, search%count
               if (pieces(i)%kind /= is_undecided) cycle
               point%low = pieces(i)%from
               point%high = pieces(i)%to
               first = neighbour(search, i, -1)
               last = neighbour(search, i, 1)
               if (closed_turn .and. i == 1 .and. search%count > 2) then
                  first = search%count
                  if (pieces(first)%kind == is_undecided) first = first - 1
               end if
               if (closed_turn .and. i == search%count .and. search%count > 2) then
                  if (pieces(1)%kind == is_undecided) cycle ! reported at its beginning
                  last = 1
               end if
               point%reverses = .false.
               point%at_end = first == 0 .or. last == 0
               if (.not. point%at_end) point%reverses = pieces(first)%kind /= pieces(last)%kind
               dead = [dead, point]
            end do
            ! a sign that changes at the end of the turn without a bracket there: it is the end itself
            if (closed_turn .and. search%count > 1) then
               first = pieces(1)%kind
               last = pieces(search%count)%kind
               if (first*last < 0) then
                  point%low = pieces(1)%from
                  point%high = pieces(1)%from
                  point%reverses = .true.
                  point%at_end = .false.
                  dead = [point, dead]
               end if
            end if
         end associate
      end subroutine find_dead

      !> The greatest rate in the middle of a tube.
      real(wp) function rate_of(signal)
         type(chain_signal_t), intent(in) :: signal
         type(quadratic_t) :: q(2)
         integer :: i, count

         rate_of = 0.0_wp
         do i = 1, tubes%count
            call evaluate(closure, outputs, signal, tubes%parts(i)%tube, 1.0_wp, q, count)
            rate_of = max(rate_of, abs(q(1)%c(0)))
         end do
      end function rate_of

      !> Signs over all tubes, in the order of the places.
      subroutine find_pieces(search)
         type(sign_search_t), intent(inout) :: search
         integer :: i

         allocate (search%pieces(2*tubes%count))
         search%size = maxval(abs(ways%base) + abs(ways%gain))
         do i = 1, tubes%count
            associate (part => tubes%parts(i))
               call examine(closure, outputs, part%tube, ways(part%segment), -part%tube%r, part%tube%r, huge(1.0_wp), search)
            end associate
         end do
         call put_in_order(search)
      end subroutine find_pieces

      !> True of an angle that after a turn of the input is another one by full turns.
      logical function goes_round(number)
         integer, intent(in) :: number
         integer :: i, first, last

         first = 1
         last = 1
         do i = 2, tubes%count
            if (tubes%parts(i)%tube%middle < tubes%parts(first)%tube%middle) first = i
            if (tubes%parts(i)%tube%middle > tubes%parts(last)%tube%middle) last = i
         end do
         goes_round = abs(tubes%parts(last)%spans(number)%value - tubes%parts(first)%spans(number)%value) > 0.5_wp*full_turn
      end function goes_round

      !> Round each dead point of an output the places over which it stays within the amount of its value there.
      subroutine find_dwells(number, dead)
         integer, intent(in) :: number
         type(proven_dead_point_t), intent(in) :: dead(:)
         type(sign_search_t) :: search
         type(chain_dwell_t) :: dwell
         real(wp) :: doubt
         integer :: d, i, segment
         logical :: known

         do d = 1, size(dead)
            dwell%number = number
            dwell%at = 0.5_wp*(dead(d)%low + dead(d)%high)
            search = sign_search_t(signal=chain_signal_t(0, number), left=most_enclosures)
            call find_value(number, dead(d), search%signal%reference, doubt, segment, known)
            search%signal%amount = amount - doubt
            if (.not. known .or. search%signal%amount <= 0.0_wp) cycle
            call find_pieces(search)
            associate (pieces => search%pieces, last => search%count)
               do i = 1, last
                  if (pieces(i)%kind /= is_positive .or. pieces(i)%run /= ways(segment)%run) cycle
                  if (pieces(i)%from > dead(d)%high .or. pieces(i)%to < dead(d)%low) cycle
                  dwell%from = pieces(i)%from
                  dwell%to = pieces(i)%to
                  if (closed_turn .and. last > 1 .and. pieces(1)%kind == is_positive .and. pieces(last)%kind == is_positive) then
                     if (i == 1) dwell%to = dwell%to + full_turn
                     if (i == 1) dwell%from = pieces(last)%from
                     if (i == last) dwell%to = pieces(1)%to + full_turn
                  end if
                  if (any(movement%dwells%number == number .and. abs(movement%dwells%from - dwell%from) <= 0.0_wp)) cycle
                  movement%dwells = [movement%dwells, dwell]
               end do
            end associate
         end do
      end subroutine find_dwells

      !> The value of an output at a dead point, and how far it may be from it.
      subroutine find_value(number, dead, value, doubt, segment, known)
         integer, intent(in) :: number
         type(proven_dead_point_t), intent(in) :: dead
         real(wp), intent(out) :: value, doubt
         integer, intent(out) :: segment
         logical, intent(out) :: known
         type(quadratic_t), allocatable :: values(:), speeds(:)
         type(tube_t) :: part
         real(wp) :: s, r
         integer :: i

         known = .false.
         value = 0.0_wp
         doubt = 0.0_wp
         segment = 1
         do i = 1, tubes%count
            segment = tubes%parts(i)%segment
            associate (tube => tubes%parts(i)%tube, way => ways(segment))
               if (dead%high - dead%low > one_place*abs(way%gain)) cycle
               s = (0.5_wp*(dead%low + dead%high) - way%base)/way%gain - tube%middle
               if (abs(s) > tube%r + narrow) cycle
               s = max(-tube%r, min(tube%r, s))
               r = 0.5_wp*(dead%high - dead%low)/abs(way%gain) + rounding*(1.0_wp + abs(way%base/way%gain))
               call part_of(closure, tube, s, r, part)
               if (.not. part%holds) cycle
               call find_numbers(closure, outputs, part, values, speeds)
               known = values(number)%bounded
               value = values(number)%c(0)
               doubt = values(number)%error + r*(abs(values(number)%c(1)) + r*abs(values(number)%c(2)))
               if (known) return
            end associate
         end do
      end subroutine find_value
   end subroutine prove_standstill

   !> The piece before (-1) or after (+1) one on the same run; 0: there is none.
   pure integer function neighbour(search, i, by)
      type(sign_search_t), intent(in) :: search
      integer, intent(in) :: i, by

      neighbour = i + by
      if (neighbour < 1 .or. neighbour > search%count) then
         neighbour = 0
      else if (search%pieces(neighbour)%run /= search%pieces(i)%run) then
         neighbour = 0
      end if
   end function neighbour

   !> Links whose turning is asked for: none that is as the frame's or the drive's, and of several that turn as one the first.
   pure function turning_links(closure) result(links)
      type(closure_t), intent(in) :: closure       !! in one group
      integer, allocatable :: links(:)
      integer :: like(size(closure%origin))
      integer :: i, k, g, low, high

      like = [(i, i=1, size(like))]
      do g = 1, size(closure%groups)
         associate (rows => closure%groups(g)%rows)
            do k = 1, size(rows)
               ! what a drive turns against the frame turns with the input
               if (rows(k)%kind /= row_angle .and. .not. (rows(k)%kind == row_turn .and. any(rows(k)%links == frame_link))) cycle
               low = minval(like(rows(k)%links))
               high = maxval(like(rows(k)%links))
               where (like == high) like = low
            end do
         end associate
      end do
      links = pack([(i, i=1, size(like))], [(like(i) == i .and. i /= frame_link, i=1, size(like))])
   end function turning_links

   !> The fastest turning of a link, or motion of its origin in parts of the drawing, in the middle of any tube.
   pure real(wp) function fastest_of(closure, tubes) result(fastest)
      type(closure_t), intent(in) :: closure
      type(chain_tubes_t), intent(in) :: tubes
      integer :: i

      fastest = 0.0_wp
      do i = 1, tubes%count
         associate (state => tubes%parts(i)%tube%state)
            fastest = max(fastest, maxval(abs(state%phi(:, 1))), maxval(abs(state%t(:, 1)%re))/closure%size, &
                          maxval(abs(state%t(:, 1)%im))/closure%size)
         end associate
      end do
   end function fastest_of

   ! ---- signs -------------------------------------------------------------------------------------------------------

   !> The quadratics that are to be positive, in a tube.
   subroutine evaluate(closure, outputs, signal, tube, sense, q, count)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      type(chain_signal_t), intent(in) :: signal
      type(tube_t), intent(in) :: tube
      real(wp), intent(in) :: sense                !! -1 where the way goes against the places
      type(quadratic_t), intent(out) :: q(2)
      integer, intent(out) :: count
      type(quadratic_t), allocatable :: values(:), speeds(:)

      count = 1
      select case (signal%quantity)
      case (quantity_turning)
         q(1) = rate_of_link(tube, signal%which)
      case (quantity_sliding)
         q(1) = rate_of_slide(closure, tube, signal%which)
      case default
         call find_numbers(closure, outputs, tube, values, speeds)
         if (signal%quantity == quantity_output) then
            q(1) = speeds(signal%which)
         else
            count = 2
            q = values(signal%which)
            q%c(0) = q%c(0) - signal%reference
            if (is_angle(outputs, signal%which)) q%c(0) = q%c(0) - full_turn*anint(q%c(0)/full_turn)
            q%error = q%error + rounding*abs(signal%reference)
            q(1)%c = -q(1)%c
            q%c(0) = q%c(0) + signal%amount
            return
         end if
      end select
      q(1)%c = sense*q(1)%c
   end subroutine evaluate

   !> Signs from a to b, counted from the middle of a tube; what is undecided is enclosed more closely.
   recursive subroutine examine(closure, outputs, tube, way, a, b, before, search)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      type(tube_t), intent(in) :: tube
      type(chain_way_t), intent(in) :: way
      real(wp), intent(in) :: a, b
      real(wp), intent(in) :: before               !! what the tube of which this one is a part left out
      type(sign_search_t), intent(inout) :: search
      type(quadratic_t) :: q(2)
      real(wp) :: cuts(most_cuts), middle, error, from
      integer :: i, n, count, kind, kind_before
      logical :: bounded

      call evaluate(closure, outputs, search%signal, tube, sign(1.0_wp, way%gain), q, count)
      bounded = all(q(:count)%bounded)
      error = huge(1.0_wp)
      if (.not. bounded) then
         call go_on(a, b)
         return
      end if
      do i = 1, count
         q(i)%error = q(i)%error + rounding*sum(abs(q(i)%c)*[1.0_wp, tube%r, tube%r**2])
      end do
      error = maxval(q(:count)%error)
      n = 2
      cuts(:2) = [a, b]
      do i = 1, count
         call add_roots(q(i)%c, -q(i)%error)
         call add_roots(q(i)%c, q(i)%error)
      end do
      call sort(cuts(:n))
      from = cuts(1)
      kind_before = 2
      do i = 1, n - 1
         middle = 0.5_wp*(cuts(i) + cuts(i + 1))
         kind = kind_at(middle)
         if (i > 1 .and. kind /= kind_before) then
            call finish(from, cuts(i), kind_before)
            from = cuts(i)
         end if
         kind_before = kind
      end do
      call finish(from, cuts(n), kind_before)

   contains

      !> Roots of a quadratic and a number, between a and b.
      subroutine add_roots(c, shift)
         real(wp), intent(in) :: c(0:2), shift
         real(wp) :: square, w, roots(2), far
         integer :: k, found

         found = 0
         far = 2.0_wp*max(abs(a), abs(b))
         square = c(1)**2 - 4.0_wp*c(2)*(c(0) + shift)
         if (square < 0.0_wp) return
         ! the one without cancellation first
         w = -0.5_wp*(c(1) + sign(sqrt(square), c(1)))
         if (abs(w) > 0.0_wp .and. abs(c(0) + shift) <= abs(w)*far) then
            found = 1
            roots(1) = (c(0) + shift)/w
         end if
         if (abs(c(2)) > 0.0_wp .and. abs(w) <= abs(c(2))*far) then
            found = found + 1
            roots(found) = w/c(2)
         end if
         do k = 1, found
            if (roots(k) <= a .or. roots(k) >= b) cycle
            n = n + 1
            cuts(n) = roots(k)
         end do
      end subroutine add_roots

      !> The sign at a place.
      pure integer function kind_at(s)
         real(wp), intent(in) :: s
         real(wp) :: value
         integer :: k

         kind_at = is_positive
         do k = 1, count
            value = q(k)%c(0) + s*(q(k)%c(1) + s*q(k)%c(2))
            if (value < -q(k)%error) then
               kind_at = is_negative
               return
            end if
            if (value <= q(k)%error) kind_at = is_undecided
         end do
      end function kind_at

      !> A part is decided, or looked at more closely.
      subroutine finish(low, high, sign)
         real(wp), intent(in) :: low, high
         integer, intent(in) :: sign

         if (sign == is_undecided) then
            call go_on(low, high)
         else
            call add_piece(search, way, tube%middle + low, tube%middle + high, sign)
         end if
      end subroutine finish

      !> Enclose a part by shorter tubes, as long as that helps.
      subroutine go_on(low, high)
         real(wp), intent(in) :: low, high
         real(wp) :: ends(3), s, r
         type(tube_t) :: part
         integer :: k, parts

         if (high - low <= narrow .or. search%left <= 0 .or. (bounded .and. error > gain_enough*before)) then
            call add_piece(search, way, tube%middle + low, tube%middle + high, is_undecided)
            return
         end if
         parts = merge(2, 1, high - low > tube%r)
         ends = [low, merge(0.5_wp*(low + high), high, parts == 2), high]
         do k = 1, parts
            s = 0.5_wp*(ends(k) + ends(k + 1))
            r = 0.5_wp*(ends(k + 1) - ends(k))
            search%left = search%left - 1
            call part_of(closure, tube, s, r*(1.0_wp + 1.0e-3_wp) + rounding, part)
            if (part%holds) then
               ! the middle of the part is rounded, too
               s = part%middle - tube%middle
               call examine(closure, outputs, part, way, ends(k) - s, ends(k + 1) - s, error, search)
            else
               call add_piece(search, way, tube%middle + ends(k), tube%middle + ends(k + 1), is_undecided)
            end if
         end do
      end subroutine go_on
   end subroutine examine

   !> Add a piece from one part of the way to another.
   subroutine add_piece(search, way, from, to, kind)
      type(sign_search_t), intent(inout) :: search
      type(chain_way_t), intent(in) :: way
      real(wp), intent(in) :: from, to
      integer, intent(in) :: kind
      type(signed_piece_t), allocatable :: more(:)

      if (search%count == size(search%pieces)) then
         allocate (more(2*search%count))
         more(:search%count) = search%pieces
         call move_alloc(more, search%pieces)
      end if
      search%count = search%count + 1
      associate (piece => search%pieces(search%count), ends => way%base + way%gain*[from, to])
         piece = signed_piece_t(minval(ends), maxval(ends), kind, way%run)
      end associate
   end subroutine add_piece

   !> Sort the pieces by run and place, join neighbours of one kind, and let what is claimed give way for roundings.
   subroutine put_in_order(search)
      type(sign_search_t), intent(inout) :: search
      type(signed_piece_t) :: moved
      real(wp) :: pad
      integer :: i, k

      associate (pieces => search%pieces)
         do i = 2, search%count
            moved = pieces(i)
            do k = i - 1, 1, -1
               if (pieces(k)%run < moved%run) exit
               if (pieces(k)%run == moved%run .and. &
                   pieces(k)%from + pieces(k)%to <= moved%from + moved%to) exit
               pieces(k + 1) = pieces(k)
            end do
            pieces(k + 1) = moved
         end do
         k = min(1, search%count)
         do i = 2, search%count
            if (pieces(i)%kind == pieces(k)%kind .and. pieces(i)%run == pieces(k)%run) then
               pieces(k)%to = max(pieces(k)%to, pieces(i)%to)
            else
               k = k + 1
               pieces(k) = pieces(i)
            end if
         end do
         search%count = k
         do i = 1, search%count
            pad = rounding*search%size
            if (pieces(i)%kind /= is_undecided) pad = -pad
            if (neighbour(search, i, -1) > 0) pieces(i)%from = pieces(i)%from - pad
            if (neighbour(search, i, 1) > 0) pieces(i)%to = pieces(i)%to + pad
         end do
      end associate
   end subroutine put_in_order

   !> Ascending, in place.
   pure subroutine sort(values)
      real(wp), intent(inout) :: values(:)
      real(wp) :: moved
      integer :: i, k

      do i = 2, size(values)
         moved = values(i)
         do k = i - 1, 1, -1
            if (values(k) <= moved) exit
            values(k + 1) = values(k)
         end do
         values(k + 1) = moved
      end do
   end subroutine sort
end module psalm_proof_standstill
