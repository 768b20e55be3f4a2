!> How larger groups are followed from input to input.
!>
!> Newton's method jumps to another assembly where its start is far off. A position is accepted only where it is the continuation
!> of the one before, by the signs that `is_trusted` knows; else the way there is walked in shorter steps. Where these become too
!> short a group stands at a dead point. What a turning input does not reach one way it may reach the other way round. Every block
!> is followed from the drawing, so that its bits do not depend on the blocks before it. A motion in time goes on from where it is
!> (`follow_from`).
submodule(psalm_linkage) psalm_linkage_walk
   use psalm_higher_group, only: correct, correction_t, dead_measure, is_trusted, keep_known_turns, keep_turns, keep_state, &
                                 predict, put_known_turns, put_state, turn_wheel
   use psalm_wheel_kernels, only: fill_pieces, piece, ratio_series_t, reach_long, reach_short, turn_from_middle
   use psalm_angles, only: angles_of, degrees_of, unit_vectors
   use psalm_kinds, only: full_turn, half_turn, radians_per_degree
   implicit none (type, external)

   real(wp), parameter :: least_step = 1.0e-9_wp !! of the way
   integer, parameter :: most_tries = 4000      !! of steps on one way: one that needs more is not gone
   real(wp), parameter :: easy = 0.02_wp        !! of the corrections: below it the next step is twice as long
   real(wp), parameter :: farthest_turn = 1.0_wp   !! radians that a link whose turn counts may turn in a step
   real(wp), parameter :: farthest_input = 45.0_wp !! degrees that the input may turn in such a step
   real(wp), parameter :: same_line = 1.0e-9_wp !! deviation of steps of several inputs in one direction, of their length
   integer, parameter :: most_pieces = block_length/piece !! of a block of wheels
   integer, parameter :: most_known = 4      !! known directions that wheels are turned by in pieces
   real(wp), parameter :: not_reached = -1.0_wp !! measure of a larger group that cannot be put together

   !> Where the walk along the positions of a block has come. Inputs: increments, shape (drives).
   type :: walk_t
      integer :: last = 0                       !! the position where it stands; 0: the drawing
      real(wp), allocatable :: here(:), before(:) !! inputs where it stands, and where it stood before
      logical :: known = .false.                !! there is a `before`
      real(wp) :: offset = 0.0_wp               !! whole turns of the first input that it is off those of the positions
      real(wp) :: ends(2) = [-huge(1.0_wp), huge(1.0_wp)] !! first inputs that it cannot reach, if there is no other
      real(wp) :: way = 0.0_wp                  !! part of the way to the next position that was gone
   end type walk_t

contains

   pure module subroutine follow_group(self, k, n, path, more, closed)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k
      integer, intent(in) :: n
      real(wp), intent(in) :: path(n)
      real(wp), intent(in), optional :: more(:, :, :)
      logical, intent(inout) :: closed
      integer :: first

      first = 1
      if (allocated(self%steps(k)%dyad%higher%powers)) then
         call follow_wheels(self, k, n, closed)
      else
         if (self%steps(k)%dyad%higher%rings == 0) &
            call follow_ties(self, k, n, path, closed .or. all_close_before(self, k, n), first)
         if (first > n) return
         call follow_path(self, k, n, path, first, more)
         associate (dyad => self%steps(k)%dyad)
            closed = closed .and. all_between(self, n, self%steps(k)%loop, dyad%closes_low, dyad%closes_high)
         end associate
      end if
   end subroutine follow_group

   !> Each position from the one before, the first from the drawing; positions before `first` are found already and stay.
   pure subroutine follow_path(self, k, n, path, first, more)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k
      integer, intent(in) :: n
      real(wp), intent(in) :: path(n)
      integer, intent(inout) :: first           !! the first that is not found yet
      real(wp), intent(in), optional :: more(:, :, :)
      type(walk_t) :: walk
      type(correction_t) :: found
      real(wp) :: inputs(1 + size(self%seconds))
      integer :: i
      logical :: valid, reached

      call start(self, k, walk, valid)
      do while (first <= n)
         i = first
         first = first + 1
         reached = .false.
         walk%way = 0.0_wp
         if (valid) then
            inputs(1) = path(i)
            if (present(more)) inputs(2:) = more(i, 1, :)
            if (closes_before(self, k, i)) call reach(self, k, i, inputs, walk, found, reached)
         end if
         associate (higher => self%steps(k)%dyad%higher, measure => self%store%v(i, self%steps(k)%dyad%measure))
            if (reached) then
               measure = abs(found%determinant)
            else
               call put_state(higher, self%store, i)
               measure = not_reached*(1.0_wp - walk%way) - dead_measure
            end if
         end associate
         ! the first position tells how often links have turned; turns at the others are sums
         if (i == 1 .and. reached .and. self%steps(k)%dyad%higher%rings == 0) then
            call note_turns(self%steps(k)%dyad%higher, path(1))
            call follow_ties(self, k, n, path, all_close_before(self, k, n), first)
         end if
      end do
   end subroutine follow_path

   !> Wheels whose ratios are whole numbers stand where their directions say, whatever way they came. Where a group before does not
   !> close they stand as drawn.
   pure subroutine follow_wheels(self, k, n, closed)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k
      integer, intent(in) :: n
      logical, intent(in) :: closed             !! every group before closes everywhere
      logical :: stays(block_length)
      integer :: i, j

      associate (higher => self%steps(k)%dyad%higher, measure => self%steps(k)%dyad%measure)
         self%store%v(1:n, measure) = higher%tie_measure
         if (closed) then
            do j = 1, higher%unknowns
               call turn_wheel(n, higher, j, self%store)
            end do
            return
         end if
         do i = 1, n
            stays(i) = .not. closes_before(self, k, i)
            if (stays(i)) self%store%v(i, measure) = not_reached - dead_measure
         end do
         do j = 1, higher%unknowns
            call turn_wheel(n, higher, j, self%store, stays(:n))
         end do
      end associate
   end subroutine follow_wheels

   !> Ties alone make linear equations: turns of wheels are sums of turns of links, which go on from the position found last, of the
   !> block before perhaps: only whole turns are taken from there, so that no digit depends on it. `first` is the next position that
   !> is not found: 1 where a link turns too far between two positions, or a group before does not close.
   pure subroutine follow_ties(self, k, n, path, closed, first)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k
      integer, intent(in) :: n
      real(wp), intent(in) :: path(n)
      logical, intent(in) :: closed             !! every group that it depends on closes everywhere
      integer, intent(inout) :: first
      real(wp), allocatable :: kept(:)          ! only the first block needs it
      logical :: found

      associate (higher => self%steps(k)%dyad%higher)
         if (.not. (higher%follows .and. allocated(higher%by_known))) return
         higher%follows = closed .and. (self%sliding_input .or. &
                                        .not. (abs(path(1) - higher%last) > farthest_input .or. leaps(n, path, farthest_input)))
         if (.not. higher%follows) return
         if (first > 1) kept = self%store%v(first - 1, :)
         call turn_in_pieces(n, higher, self%store, found)
         if (.not. found .and. higher%follows) call turn_each(n, higher, self%store, higher%follows)
         if (.not. higher%follows) then
            ! what was tried may have written over the position that is found
            if (first > 1) self%store%v(first - 1, :) = kept
            return
         end if
         self%store%v(1:n, self%steps(k)%dyad%measure) = higher%tie_measure
         higher%last = path(n)
      end associate
      first = n + 1
   end subroutine follow_ties

   !> Turns of known directions by their angles at every position, and what follows from them. `follows` is false where one turns
   !> too far between two positions.
   pure subroutine turn_each(n, higher, store, follows)
      integer, intent(in) :: n
      type(higher_t), intent(inout) :: higher
      type(rows_t), intent(inout) :: store
      logical, intent(out) :: follows
      real(wp) :: angle(block_length), turn(block_length)
      integer :: j, i, t

      follows = .true.
      associate (v => store%v)
         do i = 1, size(higher%known)
            associate (known => higher%known(i))
               call angles_of(n, v(1:n, known%root_x), v(1:n, known%root_y), angle)
               call unwind(n, angle, known, turn)
               follows = follows .and. .not. (abs(turn(1) - known%turn) > farthest_turn*degrees_per_radian .or. &
                                              leaps(n, turn, farthest_turn*degrees_per_radian))
               v(1:n, known%row) = turn(:n)*radians_per_degree
               known%angle = angle(n)
               known%turn = turn(n)
            end associate
         end do
         if (.not. follows) return
         do j = 1, higher%unknowns
            turn(:n) = 0.0_wp
            do i = 1, size(higher%known)
               turn(:n) = turn(:n) + higher%by_known(j, i)*v(1:n, higher%known(i)%row)
            end do
            do t = 1, size(higher%ties)
               if (higher%ties(t)%drive > 0) turn(:n) = turn(:n) + higher%by_tie(j, t)*v(1:n, higher%ties(t)%drive)
            end do
            v(1:n, higher%row_of_turn(j)) = turn(:n)
            angle(:n) = higher%drawn_angle(j) + turn(:n)*degrees_per_radian
            call unit_vectors(n, angle, v(1:n, higher%row(j)), v(1:n, higher%row_of_sine(j)))
         end do
      end associate
   end subroutine turn_each

   !> The same by angles in the middle of pieces, and from there by series of the sine of the angle to the middle. The rows of turns
   !> hold those of the middles. `found` is false where links turn too far in a piece, where drives take part, and where there are
   !> more than a few known directions: the block alone decides that. `higher%follows` is false where a link turns too far from
   !> where it stood before.
   pure subroutine turn_in_pieces(n, higher, store, found)
      integer, intent(in) :: n
      type(higher_t), intent(inout) :: higher
      type(rows_t), intent(inout) :: store
      logical, intent(out) :: found
      real(wp), parameter :: far = 0.5_wp*farthest_turn*degrees_per_radian !! from middle to middle: the ends are not twice as far
      real(wp), parameter :: least_cosine = cos(0.5_wp*farthest_turn) !! from the first position to the first middle: not so far
      real(wp), dimension(most_pieces, most_known) :: x, y, angle, turn
      real(wp), dimension(most_pieces) :: sum, angle_of_wheel, wx, wy
      integer :: middle, i, j, p

      found = .false.
      if (.not. allocated(higher%series) .or. size(higher%known) > most_known) return
      do i = 1, size(higher%known)
         associate (known => higher%known(i))
            do p = 1, most_pieces
               middle = min(piece*(p - 1) + piece/2, n)    ! after the last one nothing changes
               x(p, i) = store%v(middle, known%root_x)
               y(p, i) = store%v(middle, known%root_y)
            end do
            call angles_of(most_pieces, x(:, i), y(:, i), angle(:, i))
            call unwind(most_pieces, angle(:, i), known, turn(:, i))
            if (store%v(1, known%root_x)*x(1, i) + store%v(1, known%root_y)*y(1, i) < least_cosine .or. &
                leaps(most_pieces, turn(:, i), far)) return
            higher%follows = higher%follows .and. .not. abs(turn(1, i) - known%turn) > farthest_turn*degrees_per_radian
         end associate
      end do
      if (.not. higher%follows) return
      do j = 1, higher%unknowns
         sum = 0.0_wp
         do i = 1, size(higher%known)
            sum = sum + higher%by_known(j, i)*turn(:, i)
         end do
         angle_of_wheel = higher%drawn_angle(j) + sum
         call unit_vectors(most_pieces, angle_of_wheel, wx, wy)
         call turn_on(n, higher, j, x, y, turn, wx, wy, store, found)
         if (.not. found) return
         sum = sum*radians_per_degree
         call fill_all(n, sum, store%v(1, higher%row_of_turn(j)))
      end do
      do i = 1, size(higher%known)
         associate (known => higher%known(i))
            sum = turn(:, i)*radians_per_degree
            call fill_all(n, sum, store%v(1, known%row))
            known%angle = angle(most_pieces, i)
            known%turn = turn(most_pieces, i)
         end associate
      end do
      found = .true.
   end subroutine turn_in_pieces

   !> The direction of a wheel in pieces from their middles on.
   pure subroutine turn_on(n, higher, j, x, y, turn, wx, wy, store, found)
      integer, intent(in) :: n, j               !! positions, the unknown
      type(higher_t), intent(in) :: higher
      real(wp), dimension(most_pieces, most_known), intent(in) :: x, y, turn !! known directions in the middles, degrees turned
      real(wp), dimension(most_pieces), intent(in) :: wx, wy !! its direction in the middles
      type(rows_t), intent(inout) :: store
      logical, intent(out) :: found
      real(wp) :: ux(block_length), uy(block_length), one(most_pieces), zero(most_pieces), farthest, t
      integer :: i, l, reach
      logical :: first

      associate (row => higher%row(j), sine => higher%row_of_sine(j), v => store%v)
         first = .true.
         found = .true.
         do i = 1, size(higher%known)
            if (.not. abs(higher%by_known(j, i)) > 0.0_wp) cycle
            associate (known => higher%known(i), series => higher%series(j, i))
               farthest = 0.5_wp*radians_per_degree*maxval(abs(turn(2:, i) - turn(:most_pieces - 1, i)))
               do reach = merge(reach_short, reach_long, farthest < series%farthest(reach_short)), reach_long
                  if (first) then
                     call turn_all(n, v(1, known%root_x), v(1, known%root_y), series, reach, x(1, i), y(1, i), wx, wy, &
                                   v(1, row), v(1, sine), found)
                  else
                     one = 1.0_wp
                     zero = 0.0_wp
                     call turn_all(n, v(1, known%root_x), v(1, known%root_y), series, reach, x(1, i), y(1, i), one, zero, ux, uy, &
                                   found)
                  end if
                  if (found) exit
               end do
            end associate
            if (.not. found) return
            if (.not. first) then
               do l = 1, n
                  t = v(l, row)*ux(l) - v(l, sine)*uy(l)
                  v(l, sine) = v(l, sine)*ux(l) + v(l, row)*uy(l)
                  v(l, row) = t
               end do
            end if
            first = .false.
         end do
         if (.not. first) return
         v(1:n, row) = wx(1)
         v(1:n, sine) = wy(1)
      end associate
   end subroutine turn_on

   !> Whole pieces, and what is left of the last one with its last position repeated.
   pure subroutine turn_all(n, x, y, series, reach, mx, my, wx, wy, tx, ty, near)
      integer, intent(in) :: n, reach
      real(wp), intent(in) :: x(n), y(n)
      type(ratio_series_t), intent(in) :: series
      real(wp), intent(in) :: mx(*), my(*), wx(*), wy(*) !! by piece
      real(wp), intent(inout) :: tx(n), ty(n)
      logical, intent(out) :: near
      real(wp), dimension(piece) :: lx, ly, ux, uy
      integer :: pieces, done

      pieces = n/piece
      done = piece*pieces
      call turn_from_middle(pieces, x, y, series, reach, mx, my, wx, wy, tx, ty, near)
      if (done == n .or. .not. near) return
      lx = x(n)
      ly = y(n)
      lx(:n - done) = x(done + 1:)
      ly(:n - done) = y(done + 1:)
      call turn_from_middle(1, lx, ly, series, reach, mx(pieces + 1), my(pieces + 1), wx(pieces + 1), wy(pieces + 1), ux, uy, near)
      tx(done + 1:) = ux(:n - done)
      ty(done + 1:) = uy(:n - done)
   end subroutine turn_all

   !> Every position gets the value of its piece.
   pure subroutine fill_all(n, values, row)
      integer, intent(in) :: n
      real(wp), intent(in) :: values(*)         !! by piece
      real(wp), intent(inout) :: row(n)

      call fill_pieces(n/piece, values, row)
      if (modulo(n, piece) > 0) row(n - modulo(n, piece) + 1:) = values(n/piece + 1)
   end subroutine fill_all

   !> True if every group that a step depends on closes at the first `n` positions of the block.
   pure logical function all_close_before(self, k, n)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: k, n
      integer :: m

      all_close_before = .true.
      do m = 1, size(self%steps(k)%needs)
         associate (step => self%steps(self%steps(k)%needs(m)))
            if (step%kind == step_dyad) all_close_before = &
               all_close_before .and. all_between(self, n, step%loop, step%dyad%closes_low, step%dyad%closes_high)
         end associate
      end do
   end function all_close_before

   !> Where the known directions stand at the first position of a block.
   pure subroutine note_turns(higher, path)
      type(higher_t), intent(inout) :: higher
      real(wp), intent(in) :: path
      integer :: j

      do j = 1, size(higher%known)
         associate (known => higher%known(j))
            known%drawn_turn = degrees_of(known%drawn(1), known%drawn(2))
            known%angle = degrees_of(known%now(1), known%now(2))
            known%turn = known%now(3)*degrees_per_radian
         end associate
      end do
      higher%last = path
      higher%follows = .true.
   end subroutine note_turns

   !> Turns since the drawing, without jumps, from directions of -180 to 180 degrees.
   pure subroutine unwind(n, angle, known, turn)
      integer, intent(in) :: n
      real(wp), intent(in) :: angle(n)
      type(known_turn_t), intent(in) :: known      !! as it stood before
      real(wp), intent(out) :: turn(n)
      real(wp) :: rounds
      integer :: i

      rounds = anint((known%turn - (known%angle - known%drawn_turn))/full_turn) - anint((angle(1) - known%angle)/full_turn)
      turn = angle - known%drawn_turn + rounds*full_turn
      if (.not. leaps(n, angle, half_turn)) return
      do i = 2, n
         rounds = rounds - anint((angle(i) - angle(i - 1))/full_turn)
         turn(i) = angle(i) - known%drawn_turn + rounds*full_turn
      end do
   end subroutine unwind

   !> True if any step from one value to the next is greater than a limit. Counted in integers as wide as reals: it runs in vector
   !> registers.
   pure logical function leaps(n, values, limit)
      integer, intent(in) :: n
      real(wp), intent(in) :: values(n), limit
      integer(i8) :: beyond
      integer :: i

      beyond = 0
      do i = 2, n
         beyond = beyond + merge(1_i8, 0_i8, abs(values(i) - values(i - 1)) > limit)
      end do
      leaps = beyond > 0
   end function leaps

   !> Put a larger group, and those that it depends on, together in the drawing, or where they are followed from.
   pure subroutine start(self, k, walk, valid)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k
      type(walk_t), intent(inout) :: walk
      logical, intent(out) :: valid
      real(wp) :: unused
      integer :: m

      do m = 1, size(self%steps(k)%needs)
         call put_at_start(self%steps(self%steps(k)%needs(m)))
      end do
      call put_at_start(self%steps(k))
      walk%last = 0
      walk%here = [self%drawn, self%seconds%drawn]
      if (allocated(self%from)) walk%here = self%from
      walk%known = .false.
      call solve_between(self, k, walk%here, .false., valid, unused)
   end subroutine start

   pure subroutine put_at_start(step)
      type(bound_step_t), intent(inout) :: step
      integer :: i

      if (.not. allocated(step%dyad%higher)) return
      associate (higher => step%dyad%higher)
         higher%now = higher%drawn
         if (allocated(higher%from)) higher%now = higher%from
         higher%sense = 0.0_wp
         do i = 1, size(higher%known)
            higher%known(i)%now = [higher%known(i)%drawn, 0.0_wp]
            if (allocated(higher%from)) higher%known(i)%now = higher%known(i)%from
         end do
      end associate
   end subroutine put_at_start

   !> Go to position i of the block, if need be the other way round.
   pure subroutine reach(self, k, i, inputs, walk, found, reached)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k, i
      real(wp), intent(in) :: inputs(:)         !! shape (drives)
      type(walk_t), intent(inout) :: walk
      type(correction_t), intent(out) :: found
      logical, intent(out) :: reached
      type(walk_t) :: stands
      real(wp) :: offset, other(1)
      logical :: valid

      reached = .false.
      if (is_open(walk, inputs)) then
         ! from the drawing where that is nearer: the shorter the way, the fewer places to go astray
         if (abs(walk%offset) > 0.0_wp .or. is_nearer_to_drawing(self, walk, inputs)) call start(self, k, walk, valid)
         walk%offset = 0.0_wp
         call go_to(self, k, i, inputs, walk, found, reached)
      end if
      if (.not. reached .and. size(inputs) > 1 .and. walk%last > 0 .and. .not. allocated(self%from)) then
         ! of several inputs the way from the drawing is another one
         stands = walk
         call start(self, k, walk, valid)
         call go_to(self, k, i, inputs, walk, found, reached)
         if (reached) return
         walk = stands
         call go_back(self, k, walk)
      end if
      ! wheels stand elsewhere after a turn
      if (reached .or. self%one_way .or. self%sliding_input .or. self%tied .or. size(inputs) > 1 .or. allocated(self%from)) return
      offset = -sign(full_turn, inputs(1) - self%drawn)
      other = inputs(1) + offset
      if (.not. is_open(walk, other)) return
      if (abs(walk%offset - offset) > 0.0_wp) call start(self, k, walk, valid)
      walk%offset = offset
      call go_to(self, k, i, other, walk, found, reached)
   end subroutine reach

   !> From where the walk stands: at once, else in steps.
   pure subroutine go_to(self, k, i, target, walk, found, reached)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k, i
      real(wp), intent(in) :: target(:)
      type(walk_t), intent(inout) :: walk
      type(correction_t), intent(inout) :: found
      logical, intent(out) :: reached

      call step_to(self, k, i, target, walk, found, reached)
      if (.not. reached) call walk_to(self, k, i, target, walk, found, reached)
   end subroutine go_to

   !> True if the drawing is nearer to a target than where the walk stands.
   pure logical function is_nearer_to_drawing(self, walk, target)
      class(linkage_t), intent(in) :: self
      type(walk_t), intent(in) :: walk
      real(wp), intent(in) :: target(:)
      real(wp) :: from_drawing, from_here
      integer :: d

      is_nearer_to_drawing = .false.
      if (walk%last == 0) return
      from_drawing = (target(1) - self%drawn)**2
      from_here = (target(1) - walk%here(1))**2
      do d = 2, size(target)
         from_drawing = from_drawing + (target(d) - self%seconds(d - 1)%drawn)**2
         from_here = from_here + (target(d) - walk%here(d))**2
      end do
      is_nearer_to_drawing = from_drawing < from_here
   end function is_nearer_to_drawing

   !> False where the walk is known to end before.
   pure logical function is_open(walk, target)
      type(walk_t), intent(in) :: walk
      real(wp), intent(in) :: target(:)

      is_open = size(target) > 1
      if (.not. is_open) is_open = target(1) > walk%ends(1) .and. target(1) < walk%ends(2)
   end function is_open

   !> By prediction and correction at once.
   pure subroutine step_to(self, k, i, target, walk, found, reached)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k, i
      real(wp), intent(in) :: target(:)
      type(walk_t), intent(inout) :: walk
      type(correction_t), intent(inout) :: found
      logical, intent(out) :: reached
      real(wp) :: ratio, turned
      logical :: ahead

      reached = .false.
      associate (higher => self%steps(k)%dyad%higher)
         if (size(higher%known) > 0) then
            ! a link may turn round unseen between positions far apart
            if (.not. self%sliding_input .and. abs(target(1) - walk%here(1)) > farthest_input) return
            call put_known_turns(higher, self%store, i, turned)
            if (turned > farthest_turn) return
         end if
         found%moved = 0.0_wp
         ahead = walk%known
         if (ahead) call look_ahead(walk, target, ahead, ratio)
         if (ahead) then
            call predict(higher, ratio, self%store, i, found%moved)
         else
            call put_state(higher, self%store, i)
         end if
         call correct(higher, self%store, i, found)
         reached = is_trusted(found, higher%sense)
         if (.not. reached) return
         higher%before = higher%now
         call keep_state(higher, self%store, i)
         call keep_known_turns(higher, self%store, i)
      end associate
      walk%before = walk%here
      walk%here = target
      walk%known = any(abs(walk%here - walk%before) > 0.0_wp)
      walk%last = i
   end subroutine step_to

   !> Does a target lie on the line of the step before, and how far, in parts of that step?
   pure subroutine look_ahead(walk, target, ahead, ratio)
      type(walk_t), intent(in) :: walk
      real(wp), intent(in) :: target(:)
      logical, intent(out) :: ahead
      real(wp), intent(out) :: ratio
      real(wp) :: across, along, off, farthest, step, next
      integer :: d

      across = 0.0_wp
      along = 0.0_wp
      do d = 1, size(target)
         step = walk%here(d) - walk%before(d)
         across = across + step*(target(d) - walk%here(d))
         along = along + step**2
      end do
      ratio = 0.0_wp
      ahead = along > 0.0_wp                ! else steps so short that their squares are nothing
      if (.not. ahead) return
      ratio = across/along
      off = 0.0_wp
      farthest = 0.0_wp
      do d = 1, size(target)
         next = target(d) - walk%here(d)
         off = max(off, abs(next - ratio*(walk%here(d) - walk%before(d))))
         farthest = max(farthest, abs(next))
      end do
      ahead = off <= same_line*farthest
   end subroutine look_ahead

   !> In steps between the positions.
   pure subroutine walk_to(self, k, i, target, walk, found, reached)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k, i
      real(wp), intent(in) :: target(:)
      type(walk_t), intent(inout) :: walk
      type(correction_t), intent(inout) :: found
      logical, intent(out) :: reached
      real(wp) :: turned, stopped

      call go_back(self, k, walk)
      call walk_between(self, k, walk%here, target, reached, walk%way)
      if (reached) then
         ! the rows of the block may differ by rounding from those between
         associate (higher => self%steps(k)%dyad%higher)
            call put_known_turns(higher, self%store, i, turned)
            call put_state(higher, self%store, i)
            call correct(higher, self%store, i, found)
            reached = found%converged .and. abs(found%determinant) > dead_measure
            call keep_state(higher, self%store, i)
            call keep_known_turns(higher, self%store, i)
         end associate
         walk%here = target
         walk%last = i
         walk%known = .false.
         return
      end if
      ! nothing beyond where it stopped can be reached this way
      stopped = walk%here(1) + walk%way*(target(1) - walk%here(1))
      if (target(1) > stopped) walk%ends(2) = min(walk%ends(2), stopped)
      if (target(1) < stopped) walk%ends(1) = max(walk%ends(1), stopped)
      call go_back(self, k, walk)
   end subroutine walk_to

   !> Put a larger group, and those that it depends on, where the walk stands.
   pure subroutine go_back(self, k, walk)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k
      type(walk_t), intent(inout) :: walk
      integer :: m
      logical :: valid

      walk%known = .false.
      if (walk%last == 0) then
         call start(self, k, walk, valid)
         return
      end if
      do m = 1, size(self%steps(k)%needs)
         associate (step => self%steps(self%steps(k)%needs(m)))
            if (allocated(step%dyad%higher)) call keep_turns(step%dyad%higher, self%store, walk%last)
         end associate
      end do
      call keep_turns(self%steps(k)%dyad%higher, self%store, walk%last)
   end subroutine go_back

   !> True if every group that a step depends on closes at position i of the block.
   pure logical function closes_before(self, k, i)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: k, i
      integer :: m

      closes_before = .true.
      do m = 1, size(self%steps(k)%needs)
         associate (step => self%steps(self%steps(k)%needs(m)))
            if (step%kind == step_dyad) closes_before = closes_before .and. self%closes(i, step%loop)
         end associate
      end do
   end function closes_before

   !> Walk from one input to another in steps as long as can be trusted. `now` of the larger group, and of those that it depends on,
   !> tells where they stand.
   pure subroutine walk_between(self, k, from, to, reached, way)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k
      real(wp), intent(in) :: from(:), to(:)    !! inputs
      logical, intent(out) :: reached
      real(wp), intent(out) :: way              !! part of the way that was gone
      real(wp) :: step, longest, worst, next(size(to))
      integer :: tries
      logical :: valid

      reached = .false.
      way = 0.0_wp
      tries = 0
      longest = 1.0_wp
      if (.not. self%sliding_input .and. size(self%steps(k)%dyad%higher%known) > 0) &
         longest = min(1.0_wp, farthest_input/max(abs(to(1) - from(1)), tiny(1.0_wp)))
      step = longest
      do while (way < 1.0_wp)
         ! every step may be good, but too short
         if (step < longest .and. tries > most_tries) return
         step = min(step, 1.0_wp - way)
         do
            next = to
            if (way + step < 1.0_wp) next = from + (way + step)*(to - from)
            call solve_between(self, k, next, .true., valid, worst)
            tries = tries + 1
            if (valid) exit
            step = 0.5_wp*step
            if (step < least_step .or. tries > most_tries) return
         end do
         way = way + step
         if (way > 1.0_wp - 0.5_wp*least_step) way = 1.0_wp
         if (worst < easy) step = min(2.0_wp*step, longest)
      end do
      reached = .true.
   end subroutine walk_between

   !> A step and all that it depends on at an input between positions. Where that is valid, `now` of the larger groups goes there.
   pure subroutine solve_between(self, k, here, trusting, valid, worst)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: k
      real(wp), intent(in) :: here(:)           !! inputs
      logical, intent(in) :: trusting           !! groups must be continued from where they stood, else only be closed
      logical, intent(out) :: valid
      real(wp), intent(out) :: worst            !! largest second correction against the first
      integer :: m

      worst = 0.0_wp
      valid = .true.
      call put_input(self, here)
      do m = 1, size(self%steps(k)%needs)
         call step_between(self, self%steps(k)%needs(m), trusting, valid, worst)
         if (.not. valid) return
      end do
      call step_between(self, k, trusting, valid, worst)
      if (.not. valid) return
      do m = 1, size(self%steps(k)%needs)
         call keep_between(self%steps(self%steps(k)%needs(m)), self%between)
      end do
      call keep_between(self%steps(k), self%between)
   end subroutine solve_between

   pure subroutine step_between(self, j, trusting, valid, worst)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: j
      logical, intent(in) :: trusting
      logical, intent(inout) :: valid
      real(wp), intent(inout) :: worst

      if (allocated(self%steps(j)%dyad%higher)) then
         call group_between(self%steps(j)%dyad%higher, self%between, trusting, valid, worst)
      else if (self%steps(j)%kind == step_dyad) then
         call dyad_between(self, self%steps(j), valid)
      else
         call solve_point(1, self%steps(j), self%between)
      end if
   end subroutine step_between

   pure subroutine keep_between(step, between)
      type(bound_step_t), intent(inout) :: step
      type(rows_t), intent(in) :: between

      if (.not. allocated(step%dyad%higher)) return
      call keep_state(step%dyad%higher, between, 1)
      call keep_known_turns(step%dyad%higher, between, 1)
   end subroutine keep_between

   pure subroutine put_input(self, here)
      class(linkage_t), intent(inout) :: self
      real(wp), intent(in) :: here(:)
      real(wp) :: c, s, more(1, 3, size(self%seconds))
      integer :: d

      associate (v => self%between%v)
         if (.not. self%sliding_input) then
            call unit_vector(here(1), c, s)
            v(1, self%root_x(root_crank)) = self%crank_x*c - self%crank_y*s
            v(1, self%root_y(root_crank)) = self%crank_y*c + self%crank_x*s
         else if (self%input_slot > 0) then
            v(1, self%slide(self%input_slot)) = (self%reference_length + here(1))*self%scale
         end if
         if (self%first_turn > 0) v(1, self%first_turn) = (here(1) - self%drawn)*radians_per_degree
      end associate
      do d = 1, size(self%seconds)
         more(1, 1, d) = here(1 + d)
         call unit_vector(here(1 + d), more(1, 2, d), more(1, 3, d))
      end do
      call put_seconds(self, 1, more, self%between)
   end subroutine put_input

   pure subroutine group_between(higher, between, trusting, valid, worst)
      type(higher_t), intent(inout) :: higher
      type(rows_t), intent(inout) :: between
      logical, intent(in) :: trusting
      logical, intent(out) :: valid
      real(wp), intent(inout) :: worst
      type(correction_t) :: found
      real(wp) :: turned

      call put_known_turns(higher, between, 1, turned)
      call put_state(higher, between, 1)
      call correct(higher, between, 1, found)
      if (trusting) then
         valid = is_trusted(found, higher%sense) .and. turned < farthest_turn
      else
         valid = found%converged .and. abs(found%determinant) > dead_measure
         higher%sense = sign(1.0_wp, found%determinant)
      end if
      if (found%first > 0.0_wp) worst = max(worst, found%second/found%first)
   end subroutine group_between

   pure subroutine dyad_between(self, step, valid)
      class(linkage_t), intent(inout) :: self
      type(bound_step_t), intent(in) :: step
      logical, intent(out) :: valid
      real(wp) :: measure

      call solve_dyad(1, step%dyad, self%between)
      measure = self%between%v(1, step%dyad%measure)
      if (self%two_slides(step%loop)) measure = abs(measure)
      valid = measure >= step%dyad%closes_low .and. measure <= step%dyad%closes_high
   end subroutine dyad_between
end submodule psalm_linkage_walk
