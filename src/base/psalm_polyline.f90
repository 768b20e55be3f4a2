!> Curves given by points: whether they close, their corners, points taken evenly along them, smoothing.
!>
!> A point is a row of numbers: coordinates first, and what goes with them (an input, a weight), which is interpolated with
!> them. Arc length is that of the straight pieces between the points.
module psalm_polyline
   use psalm_angles, only: degrees_of, nearest_difference
   use psalm_kinds, only: wp, half_turn
   implicit none (type, external)
   private
   public :: polyline_t, looks_closed, drop_repeats, find_corners, smooth, sample

   real(wp), parameter :: repeated = 1.0e-12_wp   !! of the curve's size: points no farther apart are one
   real(wp), parameter :: usual_gap = 1.5_wp      !! times the longest piece: a gap no longer closes a curve given by points

   !> A curve: shape (numbers of a point, points). A closed one does not repeat its first point.
   type :: polyline_t
      real(wp), allocatable :: at(:, :)
      integer :: coordinates = 2                  !! of the numbers: arc length is measured in these
      logical :: closed = .false.
      logical, allocatable :: corner(:)           !! shape (points)
   end type polyline_t

contains

   !> Length of the piece from a point to another.
   pure real(wp) function piece(line, from, to)
      type(polyline_t), intent(in) :: line
      integer, intent(in) :: from, to

      piece = sqrt(sum((line%at(:line%coordinates, to) - line%at(:line%coordinates, from))**2))
   end function piece

   !> Arc length from the first point to each; of a closed curve one more, the whole length.
   pure function arc_length(line) result(s)
      type(polyline_t), intent(in) :: line
      real(wp), allocatable :: s(:)
      integer :: n, i

      n = size(line%at, 2)
      allocate (s(merge(n + 1, n, line%closed)), source=0.0_wp)
      do i = 2, size(s)
         s(i) = s(i - 1) + piece(line, i - 1, merge(1, i, i > n))
      end do
   end function arc_length

   !> Longer side of the box of the points.
   pure real(wp) function extent(line)
      type(polyline_t), intent(in) :: line
      integer :: c

      extent = 0.0_wp
      do c = 1, line%coordinates
         extent = max(extent, maxval(line%at(c, :)) - minval(line%at(c, :)))
      end do
   end function extent

   !> True if the last point is the first one again, or so near it that the gap is one more piece.
   pure logical function looks_closed(line)
      type(polyline_t), intent(in) :: line
      integer :: n, i

      n = size(line%at, 2)
      looks_closed = .false.
      if (n < 4) return
      looks_closed = piece(line, n, 1) <= usual_gap*maxval([(piece(line, i, i + 1), i=1, n - 1)])
   end function looks_closed

   !> Leave out points that stand where the one before stands; of a closed curve the last one too, if it is the first again.
   pure subroutine drop_repeats(line)
      type(polyline_t), intent(inout) :: line
      logical, allocatable :: kept(:)
      real(wp) :: least
      integer :: i, last

      least = repeated*extent(line)
      allocate (kept(size(line%at, 2)), source=.true.)
      last = 1
      do i = 2, size(kept)
         kept(i) = piece(line, last, i) > least
         if (kept(i)) last = i
      end do
      if (line%closed .and. last > 1) kept(last) = piece(line, last, 1) > least
      line%at = line%at(:, pack([(i, i=1, size(kept))], kept))
   end subroutine drop_repeats

   !> A corner is where the direction turns by more than so many degrees. The ends of an open curve are none.
   pure subroutine find_corners(line, least_turn)
      type(polyline_t), intent(inout) :: line
      real(wp), intent(in) :: least_turn
      real(wp), allocatable :: direction(:)
      integer :: n, i, next

      n = size(line%at, 2)
      if (allocated(line%corner)) deallocate (line%corner)
      allocate (line%corner(n), source=.false.)
      allocate (direction(n), source=0.0_wp)
      if (least_turn >= half_turn .or. line%coordinates /= 2 .or. n < 3) return
      do i = 1, n
         next = merge(1, i + 1, i == n)
         direction(i) = degrees_of(line%at(1, next) - line%at(1, i), line%at(2, next) - line%at(2, i))
      end do
      do i = merge(1, 2, line%closed), merge(n, n - 1, line%closed)
         line%corner(i) = abs(nearest_difference(direction(i), direction(merge(n, i - 1, i == 1)))) > least_turn
      end do
   end subroutine find_corners

   !> Average every point over its neighbours along the curve as far as `width` to either side, with the weight (1 - u**2)**2 at
   !> the part u of it. Corners and ends stay; each stretch between two of them is averaged by itself, continued beyond them
   !> point-symmetrically, so that straight stretches stay straight to their ends. What is no coordinate stays.
   subroutine smooth(line, width)
      type(polyline_t), intent(inout) :: line
      real(wp), intent(in) :: width               !! above 0
      real(wp), allocatable :: s(:), new(:, :)
      real(wp) :: sum_of(line%coordinates), weights, here, half
      integer, allocatable :: stops(:)
      integer :: n, k, c

      n = size(line%at, 2)
      s = arc_length(line)
      new = line%at
      c = line%coordinates
      if (line%closed .and. .not. any(line%corner)) then
         half = min(width, 0.5_wp*s(n + 1))
         do k = 1, n
            call around(k)
            new(:c, k) = sum_of/weights
         end do
      else
         stops = pack([(k, k=1, n)], line%corner)
         if (.not. line%closed) stops = [1, stops, n]
         if (line%closed) stops = [stops, stops(1) + n]
         do k = 1, size(stops) - 1
            call stretch(stops(k), stops(k + 1))
         end do
      end if
      line%at = new

   contains

      !> Arc length to a point, counted on beyond the ends of a closed curve.
      pure real(wp) function s_of(i)
         integer, intent(in) :: i

         s_of = s(modulo(i - 1, n) + 1)
         if (i > n) s_of = s_of + s(n + 1)
         if (i < 1) s_of = s_of - s(n + 1)
      end function s_of

      pure function point(i)
         integer, intent(in) :: i
         real(wp) :: point(c)

         point = line%at(:c, modulo(i - 1, n) + 1)
      end function point

      !> Take a point in, that stands for so much of the curve.
      subroutine add(place, at, share)
         real(wp), intent(in) :: place, at(:), share
         real(wp) :: weight

         weight = share*max(1.0_wp - ((place - here)/width)**2, 0.0_wp)**2
         weights = weights + weight
         sum_of = sum_of + weight*at
      end subroutine add

      !> The neighbours of a point of a closed curve, no farther than half way round.
      subroutine around(i)
         integer, intent(in) :: i
         integer :: j

         sum_of = 0.0_wp
         weights = 0.0_wp
         here = s_of(i)
         do j = i, i - n + 1, -1
            if (here - s_of(j) > half .and. j < i) exit
            call add(s_of(j), point(j), s_of(j + 1) - s_of(j - 1))
         end do
         do j = i + 1, i + n - 1
            if (s_of(j) - here > half) exit
            call add(s_of(j), point(j), s_of(j + 1) - s_of(j - 1))
         end do
      end subroutine around

      subroutine stretch(from, to)
         integer, intent(in) :: from, to
         real(wp) :: first(c), last(c), share
         integer :: i, j

         first = point(from)
         last = point(to)
         do i = from + 1, to - 1
            sum_of = 0.0_wp
            weights = 0.0_wp
            here = s_of(i)
            do j = from, to
               share = s_of(min(j + 1, to)) - s_of(max(j - 1, from))
               if (j == from .or. j == to) share = 2.0_wp*share ! it has its other half beyond
               call add(s_of(j), point(j), share)
               if (j > from) call add(2.0_wp*s_of(from) - s_of(j), 2.0_wp*first - point(j), share)
               if (j < to) call add(2.0_wp*s_of(to) - s_of(j), 2.0_wp*last - point(j), share)
            end do
            new(:c, modulo(i - 1, n) + 1) = sum_of/weights
         end do
      end subroutine stretch
   end subroutine smooth

   !> So many points, evenly by arc length between corners, with a point at every corner and at the ends of an open curve. A closed
   !> curve is taken from its first corner on, or from its first point if it has none. `fits` is false if there are more corners
   !> and ends than points.
   pure subroutine sample(line, count, sampled, fits)
      type(polyline_t), intent(in) :: line
      integer, intent(in) :: count                !! 2 at least
      type(polyline_t), intent(out) :: sampled
      logical, intent(out) :: fits
      real(wp), allocatable :: s(:), stops(:), places(:)
      integer, allocatable :: pieces(:)
      real(wp) :: whole, place, part
      integer :: n, k, i, j, m, intervals

      n = size(line%at, 2)
      s = arc_length(line)
      whole = s(size(s))
      sampled%coordinates = line%coordinates
      sampled%closed = line%closed
      stops = pack(s(:n), line%corner)
      if (line%closed) then
         if (size(stops) == 0) stops = [s(1)]
         stops = [stops, stops(1) + whole]
         intervals = count
      else
         stops = [0.0_wp, stops, whole]
         intervals = count - 1
      end if
      m = size(stops) - 1
      fits = m <= intervals
      if (.not. fits) return
      pieces = shares(stops(2:) - stops(:m), intervals)
      allocate (places(0))
      do k = 1, m
         places = [places, (stops(k) + (stops(k + 1) - stops(k))*(real(i, wp)/real(pieces(k), wp)), i=0, pieces(k) - 1)]
      end do
      if (.not. line%closed) places = [places, whole]
      allocate (sampled%at(size(line%at, 1), count))
      allocate (sampled%corner(count), source=.false.)
      j = 1
      do i = 1, count
         place = places(i)
         if (place >= whole .and. line%closed) then
            place = place - whole
            j = 1
         end if
         do while (j < size(s) - 1)
            if (s(j + 1) > place) exit
            j = j + 1
         end do
         part = min(max((place - s(j))/(s(j + 1) - s(j)), 0.0_wp), 1.0_wp)
         associate (next => merge(1, j + 1, j == n))
            sampled%at(:, i) = (1.0_wp - part)*line%at(:, j) + part*line%at(:, next)
         end associate
      end do
   end subroutine sample

   !> Whole numbers, 1 at least, as nearly in proportion to the lengths as their sum allows: each further one goes where the
   !> intervals are longest.
   pure function shares(lengths, total) result(pieces)
      real(wp), intent(in) :: lengths(:)
      integer, intent(in) :: total                !! not below the number of lengths
      integer :: pieces(size(lengths))
      integer :: k

      pieces = max(1, int(lengths/sum(lengths)*real(total - size(lengths), wp)))
      do while (sum(pieces) > total)
         k = minloc(lengths/real(max(pieces - 1, 1), wp), dim=1, mask=pieces > 1)
         pieces(k) = pieces(k) - 1
      end do
      do while (sum(pieces) < total)
         k = maxloc(lengths/real(pieces, wp), dim=1)
         pieces(k) = pieces(k) + 1
      end do
   end function shares
end module psalm_polyline
