!> Assur groups of more than two links, and those of two that are no dyad: positions by Newton's method, derivatives by its matrix.
!>
!> The unknowns are directions of links and lengths along slides. Each ring of arcs is one vector equation: from the point where it
!> leaves what is known, along its arcs, to the point where it comes back. A correction turns a unit vector by a fraction of two
!> polynomials, so that no trigonometric function is needed. The measure of a group is the determinant of its matrix over the
!> product of the lengths of the columns: 1 where all columns stand square to each other, 0 at a dead point; of a dyad of links it
!> is the sine of the transmission angle. A position that is not reached has a negative one. Source: Allgower and Georg (1990),
!> chapter 6.
module psalm_higher_group
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_arc_kernels, only: difference
   use psalm_frames, only: frames_t, arc_rate, form_arc, rows_of_arc
   use psalm_group_rings, only: higher_t
   use psalm_kinds, only: wp, degrees_per_radian, pi, radians_per_degree
   use psalm_linear, only: reduce_real
   use psalm_rows, only: rows_t
   use psalm_wheel_kernels, only: highest_at_once, make_series, turn_by_power
   implicit none (type, external)
   private
   public :: keep_state, put_state, predict, correct, is_trusted
   public :: rows_of_higher, form_higher, differentiate_higher, solve_higher, is_dead_higher, bounds_higher
   public :: closure_of_higher, change_of_higher, gaps_of_ties, add_gaps_of_phase, put_known_turns, keep_known_turns
   public :: find_turns, turn_wheel, keep_turns
   public :: dead_measure, correction_t

   real(wp), parameter :: dead_measure = 64.0_wp*epsilon(1.0_wp)**0.75_wp !! at and below it a group is at a dead point
   real(wp), parameter :: trusted = 0.15_wp  !! first correction against the prediction, or second correction against the first
   real(wp), parameter :: contraction = 0.5_wp !! second correction against the first at a double root; beyond it more
   real(wp), parameter :: farthest = 0.3_wp  !! radians, or parts of the group's size: longer predictions are not believed
   real(wp), parameter :: nearest = 0.1_wp   !! likewise: a first correction below it that the second confirms is believed
   real(wp), parameter :: fits = 1.0e-9_wp   !! parts of the size: so far links that brace each other may be from meeting
   integer, parameter :: most_steps = 20     !! of Newton's method
   integer, parameter :: most_small = 12     !! equations and unknowns of groups that need no memory of their own
   integer, parameter :: highest_power = 64  !! of a direction: wheels with greater ratios are turned by angles
   real(wp), parameter :: whole = 64.0_wp*epsilon(1.0_wp) !! so far from a whole number, in parts of it, a ratio is one by rounding
   real(wp), parameter :: rounding_of_factor = 2.0_wp !! in epsilons, of a product of two unit vectors, and its share of the square

   !> What Newton's method found at a position. Moves and corrections are the largest of all unknowns: radians, parts of the size.
   type :: correction_t
      logical :: converged = .false.
      real(wp) :: moved = 0.0_wp             !! by the prediction
      real(wp) :: first = 0.0_wp, second = 0.0_wp
      real(wp) :: determinant = 0.0_wp       !! over the lengths of the columns
   end type correction_t

contains

   !> Note the unknowns at a position of a block: cosine and sine, or length and 0; of a direction its turn, too.
   pure subroutine keep_state(higher, store, i)
      type(higher_t), intent(inout) :: higher
      type(rows_t), intent(in) :: store
      integer, intent(in) :: i
      integer :: j

      do j = 1, higher%unknowns
         associate (state => higher%now(:, j))
            state(1) = store%v(i, higher%row(j))
            state(2:) = 0.0_wp
            if (higher%row_of_sine(j) > 0) state(2) = store%v(i, higher%row_of_sine(j))
            if (higher%row_of_turn(j) > 0) state(3) = store%v(i, higher%row_of_turn(j))
         end associate
      end do
   end subroutine keep_state

   !> Put the unknowns back where the group stands.
   pure subroutine put_state(higher, store, i)
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(inout) :: store
      integer, intent(in) :: i
      integer :: j

      do j = 1, higher%unknowns
         store%v(i, higher%row(j)) = higher%now(1, j)
         if (higher%row_of_sine(j) > 0) store%v(i, higher%row_of_sine(j)) = higher%now(2, j)
         if (higher%row_of_turn(j) > 0) store%v(i, higher%row_of_turn(j)) = higher%now(3, j)
      end do
   end subroutine put_state

   !> Go on as from where the group stood before to where it stands, `ratio` times as far.
   pure subroutine predict(higher, ratio, store, i, moved)
      type(higher_t), intent(in) :: higher
      real(wp), intent(in) :: ratio
      type(rows_t), intent(inout) :: store
      integer, intent(in) :: i
      real(wp), intent(out) :: moved               !! largest change
      real(wp) :: cosine, sine, half, turn, vector(2)
      integer :: j

      moved = 0.0_wp
      associate (now => higher%now, before => higher%before, v => store%v)
         do j = 1, higher%unknowns
            if (higher%row_of_turn(j) > 0) then
               turn = now(3, j) + ratio*(now(3, j) - before(3, j))
               v(i, higher%row_of_turn(j)) = turn
               call unit_vector(higher%drawn_angle(j) + turn*degrees_per_radian, v(i, higher%row(j)), v(i, higher%row_of_sine(j)))
               moved = max(moved, abs(turn - now(3, j)))
            else if (higher%row_of_sine(j) > 0) then
               cosine = now(1, j)*before(1, j) + now(2, j)*before(2, j)
               sine = now(2, j)*before(1, j) - now(1, j)*before(2, j)
               half = ratio*sine/(1.0_wp + max(cosine, 0.0_wp))
               vector = turned(now(1:2, j), half)
               v(i, higher%row(j)) = vector(1)
               v(i, higher%row_of_sine(j)) = vector(2)
               moved = max(moved, 2.0_wp*abs(half))
            else
               v(i, higher%row(j)) = now(1, j) + ratio*(now(1, j) - before(1, j))
               moved = max(moved, abs(v(i, higher%row(j)) - now(1, j))/max(higher%size, abs(now(1, j))))
            end if
         end do
      end associate
   end subroutine predict

   !> A unit vector turned by twice the angle whose tangent is `half`; its length is put right to first order.
   pure function turned(vector, half) result(new)
      real(wp), intent(in) :: vector(2), half
      real(wp) :: new(2)
      real(wp) :: factor

      factor = 1.0_wp/(1.0_wp + half*half)
      new(1) = factor*((1.0_wp - half*half)*vector(1) - 2.0_wp*half*vector(2))
      new(2) = factor*((1.0_wp - half*half)*vector(2) + 2.0_wp*half*vector(1))
      new = new*(1.5_wp - 0.5_wp*(new(1)*new(1) + new(2)*new(2)))
   end function turned

   !> Newton's method at position i from the state that stands there; it ends where the next correction would be below rounding.
   pure subroutine correct(higher, store, i, result)
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(inout) :: store
      integer, intent(in) :: i
      type(correction_t), intent(inout) :: result  !! `moved` is kept
      real(wp) :: scratch(most_small*(most_small + 1))
      real(wp), allocatable :: large(:)

      associate (m => higher%equations, n => higher%unknowns)
         if (m == 4 .and. n == 4) then
            ! loops of known length
            call correct_with(higher, store, i, result, 4, 4, scratch, scratch(17))
         else if (max(m, n) <= most_small) then
            call correct_with(higher, store, i, result, m, n, scratch, scratch(m*n + 1))
         else
            allocate (large(m*(n + 1)))
            call correct_with(higher, store, i, result, m, n, large, large(m*n + 1))
         end if
      end associate
   end subroutine correct

   !> The same with room for matrix and right side: nothing is allocated.
   pure subroutine correct_with(higher, store, i, result, m, n, matrix, right)
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(inout) :: store
      integer, intent(in) :: i
      type(correction_t), intent(inout) :: result
      integer, intent(in) :: m, n                  !! equations, unknowns
      real(wp), intent(inout) :: matrix(m, n), right(m, 1)
      real(wp) :: vector(2)
      real(wp) :: largest, before, product, determinant, scaling
      integer :: step, j

      result%converged = .false.
      before = huge(1.0_wp)
      do step = 1, most_steps
         call equations(higher, store, i, m, n, matrix, right)
         product = 1.0_wp
         do j = 1, n
            product = product*sum(matrix(:, j)**2)
         end do
         call reduce_real(m, n, 1, matrix, right, determinant)
         if (.not. abs(determinant) > 0.0_wp) return
         result%determinant = determinant/sqrt(product)
         largest = 0.0_wp
         do j = 1, n
            ! a length that runs far out is changed by a part of itself
            scaling = 1.0_wp
            if (higher%row_of_sine(j) == 0) scaling = higher%size/max(higher%size, abs(store%v(i, higher%row(j))))
            largest = max(largest, abs(right(j, 1))*scaling)
         end do
         if (.not. largest < huge(1.0_wp)) return
         if (step == 1) result%first = largest
         if (step == 2) result%second = largest
         do j = 1, n
            if (higher%row_of_turn(j) > 0) then
               associate (turn => store%v(i, higher%row_of_turn(j)))
                  turn = turn + right(j, 1)
                  call unit_vector(higher%drawn_angle(j) + turn*degrees_per_radian, store%v(i, higher%row(j)), &
                                   store%v(i, higher%row_of_sine(j)))
               end associate
            else if (higher%row_of_sine(j) > 0) then
               vector = turned([store%v(i, higher%row(j)), store%v(i, higher%row_of_sine(j))], 0.5_wp*right(j, 1))
               store%v(i, higher%row(j)) = vector(1)
               store%v(i, higher%row_of_sine(j)) = vector(2)
            else
               store%v(i, higher%row(j)) = store%v(i, higher%row(j)) + right(j, 1)*higher%size
            end if
         end do
         if (step == 1) result%second = 0.0_wp
         ! the error goes like the square of the correction, over the measure
         if (largest**2 <= epsilon(1.0_wp)*abs(result%determinant) .or. &
             (largest < sqrt(epsilon(1.0_wp)) .and. largest > 0.5_wp*before)) then
            result%converged = m == n
            if (result%converged) return
            call equations(higher, store, i, m, n, matrix, right)
            result%converged = maxval(abs(right)) <= fits
            return
         end if
         if (step > 2 .and. largest > before) return
         before = largest
      end do
   end subroutine correct_with

   !> True if what Newton's method found is the continuation of the position before.
   pure logical function is_trusted(result, sense)
      type(correction_t), intent(in) :: result
      real(wp), intent(in) :: sense                !! sign of the determinant there; 0: not known

      is_trusted = result%converged .and. abs(result%determinant) > dead_measure .and. sense*result%determinant >= 0.0_wp .and. &
                   result%moved < farthest
      if (.not. is_trusted) return
      is_trusted = (result%first <= trusted*result%moved .and. result%second <= contraction*result%first) .or. &
                   (result%first <= nearest .and. result%second <= trusted*result%first)
   end function is_trusted

   !> Matrix and right side of the correction at position i, lengths in parts of the group's size.
   pure subroutine equations(higher, store, i, m, n, matrix, right)
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(in) :: store
      integer, intent(in) :: i
      integer, intent(in) :: m, n                  !! equations, unknowns
      real(wp), intent(out) :: matrix(m, n), right(m)
      real(wp) :: x, y, length, back
      integer :: k, r, j

      back = 1.0_wp/higher%size
      matrix = 0.0_wp
      do r = 1, higher%rings
         right(2*r - 1) = (store%v(i, higher%ends(3, r)) - store%v(i, higher%ends(1, r)))*back
         right(2*r) = (store%v(i, higher%ends(4, r)) - store%v(i, higher%ends(2, r)))*back
      end do
      do k = 1, size(higher%terms)
         associate (term => higher%terms(k))
            x = term%x*store%v(i, term%root_x) - term%y*store%v(i, term%root_y)
            y = term%x*store%v(i, term%root_y) + term%y*store%v(i, term%root_x)
            r = 2*term%ring
            if (term%stretched > 0) then
               matrix(r - 1, term%stretched) = matrix(r - 1, term%stretched) + x
               matrix(r, term%stretched) = matrix(r, term%stretched) + y
            end if
            length = term%length*back
            if (term%slide > 0) length = store%v(i, term%slide)*back
            x = x*length
            y = y*length
            if (term%turned > 0) then
               matrix(r - 1, term%turned) = matrix(r - 1, term%turned) - y
               matrix(r, term%turned) = matrix(r, term%turned) + x
            end if
            right(r - 1) = right(r - 1) - x
            right(r) = right(r) - y
         end associate
      end do
      do k = 1, size(higher%ties)
         associate (tie => higher%ties(k))
            r = 2*higher%rings + k
            right(r) = 0.0_wp
            if (tie%drive > 0) right(r) = store%v(i, tie%drive)
            do j = 1, size(tie%rows)
               if (tie%rows(j) > 0) right(r) = right(r) - tie%factors(j)*store%v(i, tie%rows(j))
               if (tie%unknown(j) > 0) matrix(r, tie%unknown(j)) = matrix(r, tie%unknown(j)) + tie%factors(j)
            end do
         end associate
      end do
   end subroutine equations

   pure subroutine put_identity(matrix)
      real(wp), intent(out) :: matrix(:, :)
      integer :: j

      matrix = 0.0_wp
      do j = 1, size(matrix, 1)
         matrix(j, j) = 1.0_wp
      end do
   end subroutine put_identity

   !> Ties alone make linear equations of turns, always the same: how the unknown ones follow from the known ones and the drives.
   pure subroutine find_turns(higher)
      type(higher_t), intent(inout) :: higher
      real(wp) :: matrix(higher%equations, higher%unknowns), inverse(higher%equations, higher%equations), lengths, determinant
      integer :: t, j, i

      if (higher%equations /= higher%unknowns) return
      matrix = 0.0_wp
      do t = 1, size(higher%ties)
         associate (tie => higher%ties(t))
            do j = 1, size(tie%rows)
               if (tie%unknown(j) > 0) matrix(t, tie%unknown(j)) = matrix(t, tie%unknown(j)) + tie%factors(j)
            end do
         end associate
      end do
      lengths = product(sum(matrix**2, dim=1))
      call put_identity(inverse)
      call reduce_real(higher%equations, higher%unknowns, higher%equations, matrix, inverse, determinant)
      if (.not. abs(determinant) > dead_measure*sqrt(lengths)) return
      higher%tie_measure = abs(determinant)/sqrt(lengths)
      higher%by_tie = inverse
      allocate (higher%by_known(higher%unknowns, size(higher%known)), source=0.0_wp)
      do t = 1, size(higher%ties)
         associate (tie => higher%ties(t), times => higher%by_known)
            do j = 1, size(tie%rows)
               if (tie%unknown(j) > 0 .or. tie%rows(j) == 0) cycle
               i = findloc(higher%known%row, tie%rows(j), dim=1)
               times(:, i) = times(:, i) - inverse(:, t)*tie%factors(j)
            end do
         end associate
      end do
      if (any(higher%ties%drive > 0)) return
      associate (times => higher%by_known)
         allocate (higher%series(size(times, 1), size(times, 2)))
         do i = 1, size(times, 2)
            do j = 1, size(times, 1)
               higher%series(j, i) = make_series(times(j, i))
            end do
         end do
         if (any(abs(times) > real(highest_power, wp))) return
         if (any(abs(times - anint(times)) > whole*max(abs(times), 1.0_wp))) return
         higher%powers = nint(times)
      end associate
   end subroutine find_turns

   !> Directions of a wheel whose ratios are whole numbers: products of powers of known directions, each counted from the drawing.
   pure subroutine turn_wheel(n, higher, j, store, stays)
      integer, intent(in) :: n, j                  !! positions, the unknown
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(inout) :: store
      logical, intent(in), optional :: stays(n)    !! where it stands as drawn
      integer :: k

      if (.not. present(stays) .and. count(higher%powers(j, :) /= 0) == 1) then
         k = findloc(higher%powers(j, :) /= 0, .true., dim=1)
         if (abs(higher%powers(j, k)) <= highest_at_once) then
            associate (known => higher%known(k), v => store%v)
               call turn_by_power(n, v(1, known%root_x), v(1, known%root_y), known%drawn, higher%powers(j, k), &
                                  higher%drawn(:2, j), v(1, higher%row(j)), v(1, higher%row_of_sine(j)))
            end associate
            return
         end if
      end if
      call multiply_directions(n, higher, j, store, stays)
   end subroutine turn_wheel

   !> The same for any powers of any number of known directions.
   pure subroutine multiply_directions(n, higher, j, store, stays)
      integer, intent(in) :: n, j
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(inout) :: store
      logical, intent(in), optional :: stays(n)
      real(wp) :: ux(n), uy(n), t, sense
      integer :: i, k, power

      associate (x => store%v(1:n, higher%row(j)), y => store%v(1:n, higher%row_of_sine(j)), v => store%v)
         x = higher%drawn(1, j)
         y = higher%drawn(2, j)
         do k = 1, size(higher%powers, 2)
            power = abs(higher%powers(j, k))
            sense = real(sign(1, higher%powers(j, k)), wp)
            associate (known => higher%known(k))
               do i = 1, n
                  ux(i) = v(i, known%root_x)*known%drawn(1) + v(i, known%root_y)*known%drawn(2)
                  uy(i) = sense*(v(i, known%root_y)*known%drawn(1) - v(i, known%root_x)*known%drawn(2))
               end do
            end associate
            if (present(stays)) then
               where (stays)
                  ux = 1.0_wp
                  uy = 0.0_wp
               end where
            end if
            do while (power > 0)
               if (modulo(power, 2) == 1) then
                  do i = 1, n
                     t = x(i)*ux(i) - y(i)*uy(i)
                     y(i) = y(i)*ux(i) + x(i)*uy(i)
                     x(i) = t
                  end do
               end if
               power = power/2
               if (power == 0) exit
               do i = 1, n
                  t = (ux(i) - uy(i))*(ux(i) + uy(i))
                  uy(i) = 2.0_wp*ux(i)*uy(i)
                  ux(i) = t
               end do
            end do
         end do
         ! what is left of the length of a direction grows with the power
         do i = 1, n
            t = 1.5_wp - 0.5_wp*(x(i)**2 + y(i)**2)
            x(i) = x(i)*t
            y(i) = y(i)*t
         end do
      end associate
   end subroutine multiply_directions

   !> Turns of the directions that are known at position i, each less than half a turn from where the group stands. `moved` is the
   !> largest change, radians.
   pure subroutine put_known_turns(higher, store, i, moved)
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(inout) :: store
      integer, intent(in) :: i
      real(wp), intent(out) :: moved
      real(wp) :: change
      integer :: k

      moved = 0.0_wp
      do k = 1, size(higher%known)
         associate (known => higher%known(k))
            associate (x => store%v(i, known%root_x), y => store%v(i, known%root_y))
               change = degrees_of(x*known%now(1) + y*known%now(2), y*known%now(1) - x*known%now(2))/degrees_per_radian
            end associate
            store%v(i, known%row) = known%now(3) + change
            moved = max(moved, abs(change))
         end associate
      end do
   end subroutine put_known_turns

   !> Note where the known directions stand at position i.
   pure subroutine keep_known_turns(higher, store, i)
      type(higher_t), intent(inout) :: higher
      type(rows_t), intent(in) :: store
      integer, intent(in) :: i
      integer :: k

      do k = 1, size(higher%known)
         associate (known => higher%known(k))
            known%now = [store%v(i, known%root_x), store%v(i, known%root_y), store%v(i, known%row)]
         end associate
      end do
   end subroutine keep_known_turns

   !> Note where a group stands at position i of a block.
   !>
   !> The rows of turns of ties alone may be out by less than half a turn there, and those of whole ratios by anything: of them the
   !> whole turns count, the rest follows from the directions.
   pure subroutine keep_turns(higher, store, i)
      type(higher_t), intent(inout) :: higher
      type(rows_t), intent(in) :: store
      integer, intent(in) :: i
      real(wp) :: turn
      integer :: k, t

      call keep_state(higher, store, i)
      call keep_known_turns(higher, store, i)
      if (.not. allocated(higher%by_known)) return
      higher%now(3, :) = 0.0_wp
      do k = 1, size(higher%known)
         associate (now => higher%known(k)%now, drawn => higher%known(k)%drawn)
            turn = degrees_of(now(1)*drawn(1) + now(2)*drawn(2), now(2)*drawn(1) - now(1)*drawn(2))*radians_per_degree
            now(3) = turn + 2.0_wp*pi*anint((now(3) - turn)/(2.0_wp*pi))
            higher%now(3, :) = higher%now(3, :) + higher%by_known(:, k)*now(3)
         end associate
      end do
      do t = 1, size(higher%ties)
         if (higher%ties(t)%drive > 0) higher%now(3, :) = higher%now(3, :) + higher%by_tie(:, t)*store%v(i, higher%ties(t)%drive)
      end do
   end subroutine keep_turns

   ! ---- derivatives -------------------------------------------------------------------------------------------------

   !> Rows that a group takes in the frames: the vectors of its arcs, the inverse of its matrix by rows, its measure.
   pure integer function rows_of_higher(higher)
      type(higher_t), intent(in) :: higher

      rows_of_higher = rows_of_arc*size(higher%terms) + higher%unknowns*higher%equations + 1
   end function rows_of_higher

   pure integer function inverse_row(higher, at)
      type(higher_t), intent(in) :: higher
      integer, intent(in) :: at

      inverse_row = at + rows_of_arc*size(higher%terms)
   end function inverse_row

   pure integer function measure_row(higher, at)
      type(higher_t), intent(in) :: higher
      integer, intent(in) :: at

      measure_row = inverse_row(higher, at) + higher%unknowns*higher%equations
   end function measure_row

   !> Vectors of all arcs and the inverse of the matrix (0 at a dead point), into the rows from `at` on.
   subroutine form_higher(n, higher, angle_x, angle_y, length, store, at, frames)
      integer, intent(in) :: n, at
      type(higher_t), intent(in) :: higher
      real(wp), intent(in) :: angle_x(:), angle_y(:), length(:) !! by arc: cosine, sine of its fixed angle; length
      type(rows_t), intent(in) :: store
      type(frames_t), intent(inout) :: frames
      real(wp) :: matrix(higher%equations, higher%unknowns), inverse(higher%equations, higher%equations), product, determinant
      integer :: i, j, k, row, different

      do k = 1, size(higher%terms)
         associate (term => higher%terms(k))
            call form_arc(n, store, term%root_x, term%root_y, angle_x(term%arc), angle_y(term%arc), length(term%arc), term%slide, &
                          frames, at + rows_of_arc*(k - 1))
         end associate
      end do
      ! ties alone are alike at every position
      different = merge(min(1, n), n, higher%rings == 0)
      do i = 1, different
         call equations(higher, store, i, higher%equations, higher%unknowns, matrix, inverse(:, 1))
         product = 1.0_wp
         do j = 1, higher%unknowns
            product = product*sum(matrix(:, j)**2)
         end do
         call put_identity(inverse)
         call reduce_real(higher%equations, higher%unknowns, higher%equations, matrix, inverse, determinant)
         determinant = abs(determinant)/max(sqrt(product), tiny(1.0_wp))
         if (.not. determinant > dead_measure) inverse = 0.0_wp
         row = inverse_row(higher, at)
         do j = 1, higher%unknowns
            ! of lengths and turns by lengths that are not divided by the size, and by turns
            if (higher%row_of_sine(j) > 0) inverse(j, :2*higher%rings) = inverse(j, :2*higher%rings)/higher%size
            if (higher%row_of_sine(j) == 0) inverse(j, 2*higher%rings + 1:) = inverse(j, 2*higher%rings + 1:)*higher%size
            frames%work%v(i, row:row + higher%equations - 1) = inverse(j, :)
            row = row + higher%equations
         end do
         frames%work%v(i, row) = determinant
      end do
      if (different == n) return
      do k = inverse_row(higher, at), measure_row(higher, at)
         frames%work%v(2:n, k) = frames%work%v(1, k)
      end do
   end subroutine form_higher

   !> True at a dead point: the matrix has no inverse at position i, rates are infinite.
   pure logical function is_dead_higher(higher, frames, at, i)
      type(higher_t), intent(in) :: higher
      type(frames_t), intent(in) :: frames
      integer, intent(in) :: at, i

      is_dead_higher = .not. frames%work%v(i, measure_row(higher, at)) > dead_measure
   end function is_dead_higher

   !> Unknown changes from what is left of each ring by the changes that are known.
   pure subroutine solve_higher(n, higher, at, frames, gap, d)
      integer, intent(in) :: n, at
      type(higher_t), intent(in) :: higher
      type(frames_t), intent(in) :: frames
      real(wp), intent(in) :: gap(:, :)            !! shape (n, equations): x and y of each ring, turns of ties
      type(rows_t), intent(inout) :: d             !! at the rows of the unknowns
      integer :: i, j, k, row

      row = inverse_row(higher, at)
      do j = 1, higher%unknowns
         associate (to => d%v(:, higher%row(j)), w => frames%work%v)
            d%v(1:n, higher%row(j)) = 0.0_wp
            do k = 1, higher%equations
               do i = 1, n
                  d%v(i, higher%row(j)) = d%v(i, higher%row(j)) + w(i, row)*gap(i, k)
               end do
               row = row + 1
            end do
         end associate
      end do
   end subroutine solve_higher

   !> Derivatives of the unknowns by the input, orders 1 to `orders`; the frames are formed before.
   subroutine differentiate_higher(n, orders, higher, at, frames, d)
      integer, intent(in) :: n, orders, at
      type(higher_t), intent(in) :: higher
      type(frames_t), intent(in) :: frames
      type(rows_t), intent(inout) :: d(:)          !! by order
      real(wp) :: gap(n, higher%equations), tx(n), ty(n)
      integer :: order, j, k, r

      do order = 1, orders
         do j = 1, higher%unknowns
            d(order)%v(1:n, higher%row(j)) = 0.0_wp
         end do
         do r = 1, higher%rings
            associate (v => d(order)%v)
               call difference(n, v(1, higher%ends(1, r)), v(1, higher%ends(2, r)), v(1, higher%ends(3, r)), &
                               v(1, higher%ends(4, r)), gap(:, 2*r - 1), gap(:, 2*r))
            end associate
         end do
         do k = 1, size(higher%terms)
            associate (term => higher%terms(k))
               r = 2*term%ring
               call arc_rate(frames, d, n, order, -1.0_wp, at + rows_of_arc*(k - 1), term%root_x, term%slide, gap(:, r - 1), &
                             gap(:, r), tx, ty)
               gap(:, r - 1) = tx
               gap(:, r) = ty
            end associate
         end do
         call gaps_of_ties(n, higher, d(order), gap)
         call solve_higher(n, higher, at, frames, gap, d(order))
      end do
   end subroutine differentiate_higher

   !> What the known changes of turns leave of each tie; rows of unknown changes hold zero.
   pure subroutine gaps_of_ties(n, higher, d, gap)
      integer, intent(in) :: n
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(in) :: d
      real(wp), intent(inout) :: gap(:, :)         !! shape (n, equations)
      integer :: k, r, j

      do k = 1, size(higher%ties)
         r = 2*higher%rings + k
         gap(:, r) = 0.0_wp
         associate (tie => higher%ties(k))
            if (tie%drive_root > 0) gap(:, r) = d%v(1:n, tie%drive_root)
            do j = 1, size(tie%roots)
               if (tie%roots(j) > 0 .and. tie%unknown(j) == 0) gap(:, r) = gap(:, r) - tie%factors(j)*d%v(1:n, tie%roots(j))
            end do
         end associate
      end do
   end subroutine gaps_of_ties

   !> What is left of each tie where the direction grows from which the turns of an unknown arc are counted, per radian.
   pure subroutine add_gaps_of_phase(n, higher, arc, gap)
      integer, intent(in) :: n
      type(higher_t), intent(in) :: higher
      integer, intent(in) :: arc                   !! sequential number; of no unknown: nothing is left
      real(wp), intent(inout) :: gap(:, :)         !! shape (n, equations)
      integer :: k, r, j, unknown

      unknown = findloc(higher%arc, arc, dim=1)
      if (unknown == 0) return
      do k = 1, size(higher%ties)
         r = 2*higher%rings + k
         associate (tie => higher%ties(k))
            do j = 1, size(tie%unknown)
               if (tie%unknown(j) == unknown) gap(:n, r) = gap(:n, r) + tie%factors(j)
            end do
         end associate
      end do
   end subroutine add_gaps_of_phase

   !> How far a group is from a dead point: 1 less its measure, at positions that are not reached 1 less that in the store.
   pure subroutine closure_of_higher(n, higher, store, measure, k)
      integer, intent(in) :: n
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(in) :: store
      integer, intent(in) :: measure               !! row of the measure: not to the last digits where it was reached
      real(wp), intent(out) :: k(:)                !! shape (n)
      real(wp) :: matrix(higher%equations, higher%unknowns), right(higher%equations, 1), product, determinant
      integer :: i, j
      logical :: known

      known = .false.
      do i = 1, n
         k(i) = 1.0_wp - store%v(i, measure)
         if (store%v(i, measure) <= 0.0_wp) cycle
         if (known) then
            ! ties alone are alike at every position
            k(i) = 1.0_wp - abs(determinant)/max(sqrt(product), tiny(1.0_wp))
            cycle
         end if
         known = higher%rings == 0
         call equations(higher, store, i, higher%equations, higher%unknowns, matrix, right(:, 1))
         product = 1.0_wp
         do j = 1, higher%unknowns
            product = product*sum(matrix(:, j)**2)
         end do
         call reduce_real(higher%equations, higher%unknowns, 0, matrix, right, determinant)
         k(i) = 1.0_wp - abs(determinant)/max(sqrt(product), tiny(1.0_wp))
      end do
   end subroutine closure_of_higher

   !> Change of the measure with a variable, from the changes of all rows.
   !>
   !> The logarithm of a determinant changes by the trace of the inverse times the change of the matrix.
   subroutine change_of_higher(n, higher, store, d, turn, stretch, dk)
      integer, intent(in) :: n
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(in) :: store
      type(rows_t), intent(in) :: d                !! changes of all rows, per radian for angles
      real(wp), intent(in) :: turn(:), stretch(:)  !! by arc: how its fixed angle turns, its length grows with the variable
      real(wp), intent(out) :: dk(:)               !! shape (n)
      real(wp) :: matrix(higher%equations, higher%unknowns), inverse(higher%equations, higher%equations), &
                  change(higher%equations, higher%unknowns), product, determinant, x, y, u, v, length, grows, turns, total
      integer :: i, j, k, r

      if (higher%rings == 0) then
         dk(:n) = 0.0_wp
         return
      end if
      do i = 1, n
         call equations(higher, store, i, higher%equations, higher%unknowns, matrix, inverse(:, 1))
         change = 0.0_wp
         do k = 1, size(higher%terms)
            associate (term => higher%terms(k))
               r = 2*term%ring
               x = term%x*store%v(i, term%root_x) - term%y*store%v(i, term%root_y)
               y = term%x*store%v(i, term%root_y) + term%y*store%v(i, term%root_x)
               length = term%length
               grows = stretch(term%arc)
               turns = d%v(i, term%root_x) + turn(term%arc)
               if (term%slide > 0) then
                  length = store%v(i, term%slide)
                  grows = d%v(i, term%slide)
               end if
               if (term%stretched > 0) then
                  change(r - 1, term%stretched) = change(r - 1, term%stretched) - turns*y
                  change(r, term%stretched) = change(r, term%stretched) + turns*x
               end if
               if (term%turned > 0) then
                  ! the column is i times the vector
                  u = grows*x - turns*length*y
                  v = grows*y + turns*length*x
                  change(r - 1, term%turned) = change(r - 1, term%turned) - v/higher%size
                  change(r, term%turned) = change(r, term%turned) + u/higher%size
               end if
            end associate
         end do
         total = 0.0_wp
         product = 1.0_wp
         do j = 1, higher%unknowns
            length = sum(matrix(:, j)**2)
            product = product*length
            total = total - sum(matrix(:, j)*change(:, j))/max(length, tiny(1.0_wp))
         end do
         call put_identity(inverse)
         call reduce_real(higher%equations, higher%unknowns, higher%equations, matrix, inverse, determinant)
         dk(i) = 0.0_wp
         if (.not. abs(determinant) > 0.0_wp) cycle
         do j = 1, higher%unknowns
            do k = 1, higher%equations
               total = total + inverse(j, k)*change(k, j)
            end do
         end do
         dk(i) = total*abs(determinant)/max(sqrt(product), tiny(1.0_wp))
      end do
   end subroutine change_of_higher

   !> First-order bounds of the errors of the unknowns at position i, in units of epsilon.
   pure subroutine bounds_higher(higher, store, i, row, angle, worst, bound)
      type(higher_t), intent(in) :: higher
      type(rows_t), intent(in) :: store
      integer, intent(in) :: i
      real(wp), intent(in) :: row(:)               !! bounds of what is known, by row of the store
      real(wp), intent(in) :: angle(:)             !! by arc: its fixed angle, radians
      real(wp), intent(in) :: worst                !! larger factors say nothing more
      real(wp), intent(out) :: bound(:)            !! the first `unknowns` are set
      real(wp) :: matrix(higher%equations, higher%unknowns), inverse(higher%equations, higher%equations), &
                  gap(higher%equations), length, determinant
      integer :: j, k, r

      call equations(higher, store, i, higher%equations, higher%unknowns, matrix, gap)
      call put_identity(inverse)
      call reduce_real(higher%equations, higher%unknowns, higher%equations, matrix, inverse, determinant)
      if (.not. abs(determinant) > 0.0_wp) inverse = worst
      do r = 1, higher%rings
         gap(2*r) = row(higher%ends(1, r)) + row(higher%ends(3, r))
      end do
      do k = 1, size(higher%terms)
         associate (term => higher%terms(k))
            length = abs(term%length)
            if (term%slide > 0) length = abs(store%v(i, term%slide))
            r = 2*term%ring
            gap(r) = gap(r) + length*(2.0_wp + abs(angle(term%arc)))
            if (term%turned == 0) gap(r) = gap(r) + length*row(term%root_x)
            if (term%slide > 0 .and. term%stretched == 0) gap(r) = gap(r) + row(term%slide)
         end associate
      end do
      do r = 1, higher%rings
         gap(2*r) = gap(2*r)/higher%size
         gap(2*r - 1) = gap(2*r)
      end do
      do k = 1, size(higher%ties)
         r = 2*higher%rings + k
         gap(r) = 1.0_wp
         associate (tie => higher%ties(k))
            do j = 1, size(tie%rows)
               if (tie%rows(j) == 0) cycle
               if (allocated(higher%powers)) then
                  ! each factor of a product of directions is rounded, but no turn is
                  gap(r) = gap(r) + rounding_of_factor*abs(tie%factors(j))
               else
                  gap(r) = gap(r) + abs(tie%factors(j)*store%v(i, tie%rows(j)))
               end if
               if (tie%unknown(j) == 0) gap(r) = gap(r) + abs(tie%factors(j))*row(tie%roots(j))
            end do
            if (tie%drive > 0) gap(r) = gap(r) + abs(store%v(i, tie%drive))
         end associate
      end do
      do j = 1, higher%unknowns
         bound(j) = min(sum(abs(inverse(j, :))*gap), worst) + 1.0_wp
         if (higher%row_of_sine(j) == 0) bound(j) = bound(j)*higher%size
      end do
   end subroutine bounds_higher
end module psalm_higher_group
