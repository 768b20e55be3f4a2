!> Where a roller cuts into the profile it is to touch, or a cutter into what it is to leave, by looking at the whole turn: what
!> curvature alone does not show.
!>
!> A circle of radius r about the point p(a) of the contour touches the curve of the centres at m(a). As long as that curve does
!> not turn by more than a right angle and is nowhere sharper than r towards p, it stays outside the circle: with x along the
!> tangent and the slope angle s, d(sin s)/dx <= 1/r. Curvature is assessed elsewhere, so such pairs are left out. All others whose
!> samples are nearer than r and half a step of each are refined on the closed forms: no crossing lies between the samples.
module psalm_cam_interference
   use psalm_cam_profile, only: cam_points_t
   use psalm_cam_shape, only: cam_shape_t, samples_t, measure
   use psalm_cam_trace, only: cam_trace_t
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp, full_turn
   implicit none (type, external)
   private
   public :: interference_t, sample_pair_t, find_interference, near_pairs, fit_least

   integer, parameter :: block_length = 32       !! samples that are compared at once
   real(wp), parameter :: safely = 1.0e-9_wp     !! of a sine: a block may turn so near to a right angle
   integer, parameter :: refinements = 3         !! stencils of a pair, each finer
   real(wp), parameter :: finer = 0.05_wp        !! by this
   real(wp), parameter :: rounding = 1.0e-9_wp   !! depth that is none
   real(wp), parameter :: relative_rounding = 1.0e-12_wp

   !> A circle that cuts into the contour it is to touch.
   type :: interference_t
      real(wp) :: depth = 0.0_wp                 !! 0: nowhere
      real(wp) :: at = 0.0_wp, by = 0.0_wp       !! cam angles of the point lost and of the circle there
   end type interference_t

   !> A sample of the contour and one of the centres.
   type :: sample_pair_t
      integer :: at = 0, by = 0
   end type sample_pair_t

contains

   !> The deepest cut of circles about the cutter centres, or about the roller centres, into the profile.
   subroutine find_interference(shape, samples, of_cutter, found)
      type(cam_shape_t), intent(inout) :: shape
      type(samples_t), intent(in) :: samples
      logical, intent(in) :: of_cutter
      type(interference_t), intent(out) :: found
      type(sample_pair_t), allocatable :: pairs(:)
      complex(wp), allocatable :: centres(:)
      integer, allocatable :: kept(:)
      real(wp) :: radius, depth, a, b, step
      integer :: i, k, round

      radius = merge(shape%cutter, shape%roller, of_cutter)
      if (.not. radius > 0.0_wp) return
      ! without doubles: the end of a piece is the beginning of the next
      kept = pack([(i, i=1, size(samples%angle))], [samples%piece(2:) == samples%piece(:size(samples%piece) - 1), &
                                                           shape%axes%slides])
      centres = centres_of(samples%points, of_cutter)
      call near_pairs(samples%points%profile(kept), centres(kept), samples%points%tangent(kept), radius, shape%axes%slides, &
                      pairs)
      do k = 1, size(pairs)
         a = samples%angle(kept(pairs(k)%at))
         b = samples%angle(kept(pairs(k)%by))
         step = full_turn/real(size(kept), wp)
         do round = 1, refinements
            call refine(a, b, step)
            step = finer*step
         end do
         depth = radius - distance_of(a, b)
         if (depth <= max(rounding, relative_rounding*radius) .or. depth <= found%depth) cycle
         found = interference_t(depth, within(a), within(b))
      end do

   contains

      !> An angle of the turn; of a cam that slides one between its ends.
      elemental real(wp) function within(angle)
         real(wp), intent(in) :: angle

         within = modulo(angle, full_turn)
         if (shape%axes%slides) within = min(max(angle, 0.0_wp), full_turn)
      end function within

      !> The least distance near two cam angles, by a quadratic through three by three of them.
      subroutine refine(a, b, step)
         real(wp), intent(inout) :: a, b
         real(wp), intent(in) :: step
         type(cam_trace_t) :: states
         type(cam_points_t) :: points
         logical, allocatable :: possible(:)
         complex(wp), allocatable :: m(:)
         real(wp) :: angle(6), square(-1:1, -1:1), move(2)
         integer :: i, k

         angle = within([a - step, a, a + step, b - step, b, b + step])
         call measure(shape, angle, shape%motion%law%piece_at(angle), states, points, possible)
         m = centres_of(points, of_cutter)
         do k = -1, 1
            do i = -1, 1
               square(i, k) = real((points%profile(2 + i) - m(5 + k))*conjg(points%profile(2 + i) - m(5 + k)), wp)
            end do
         end do
         move = fit_least(square)
         a = a + step*move(1)
         b = b + step*move(2)
      end subroutine refine

      real(wp) function distance_of(a, b) result(distance)
         real(wp), intent(in) :: a, b
         type(cam_trace_t) :: states
         type(cam_points_t) :: points
         logical, allocatable :: possible(:)
         complex(wp), allocatable :: m(:)
         complex(wp) :: line
         real(wp) :: angle(2)

         angle = within([a, b])
         call measure(shape, angle, shape%motion%law%piece_at(angle), states, points, possible)
         m = centres_of(points, of_cutter)
         line = points%profile(1) - m(2)
         distance = hypotenuse(real(line, wp), aimag(line))
      end function distance_of
   end subroutine find_interference

   pure function centres_of(points, of_cutter) result(centres)
      type(cam_points_t), intent(in) :: points
      logical, intent(in) :: of_cutter
      complex(wp), allocatable :: centres(:)

      if (of_cutter) then
         centres = points%cutter
      else
         centres = points%pitch
      end if
   end function centres_of

   !> Where a quadratic through three by three values is least, in steps from the middle, at most one each way.
   pure function fit_least(f) result(move)
      real(wp), intent(in) :: f(-1:1, -1:1)
      real(wp) :: move(2)
      real(wp) :: g(2), h(3), det

      g = 0.5_wp*[f(1, 0) - f(-1, 0), f(0, 1) - f(0, -1)]
      h = [f(1, 0) - 2.0_wp*f(0, 0) + f(-1, 0), f(0, 1) - 2.0_wp*f(0, 0) + f(0, -1), &
           0.25_wp*(f(1, 1) - f(1, -1) - f(-1, 1) + f(-1, -1))]
      det = h(1)*h(2) - h(3)**2
      if (h(1) > 0.0_wp .and. det > 0.0_wp) then
         move = -[h(2)*g(1) - h(3)*g(2), h(1)*g(2) - h(3)*g(1)]/det
      else
         move = -sign(1.0_wp, g)*min(1.0_wp, abs(g)/max(maxval(abs(f)), tiny(1.0_wp)))
      end if
      move = min(max(move, -1.0_wp), 1.0_wp)
   end function fit_least

   !> Pairs of a point and a centre that may be nearer than the radius between the samples, the nearest of their neighbourhood each.
   !> The samples are a closed curve, without doubles, or an open one.
   pure subroutine near_pairs(contour, centres, tangent, radius, open, pairs)
      complex(wp), intent(in) :: contour(:), centres(:) !! shape (n): of one and the same cam angle
      complex(wp), intent(in) :: tangent(:)             !! unit vectors of both
      real(wp), intent(in) :: radius
      logical, intent(in) :: open
      type(sample_pair_t), allocatable, intent(out) :: pairs(:)
      integer :: behind(size(centres)), ahead(size(centres)) !! samples about each that the touching circle cannot meet
      complex(wp), allocatable :: middle(:, :)
      real(wp), allocatable :: round(:, :)
      real(wp) :: limit, gap
      integer :: n, blocks, b, c, i, k

      n = size(centres)
      allocate (pairs(0))
      call find_reach(tangent, open, behind, ahead)
      limit = radius + 0.5_wp*(longest_step(contour, open) + longest_step(centres, open))
      blocks = (n + block_length - 1)/block_length
      allocate (middle(2, blocks), round(2, blocks))
      do b = 1, blocks
         associate (first => (b - 1)*block_length + 1, last => min(b*block_length, n))
            call enclose(contour(first:last), middle(1, b), round(1, b))
            call enclose(centres(first:last), middle(2, b), round(2, b))
         end associate
      end do
      do c = 1, blocks
         do b = 1, blocks
            gap = size_of(middle(1, b) - middle(2, c)) - round(1, b) - round(2, c)
            if (gap >= limit .or. is_within_reach(b, c)) cycle
            do k = (c - 1)*block_length + 1, min(c*block_length, n)
               do i = (b - 1)*block_length + 1, min(b*block_length, n)
                  if (modulo(k - i, n) <= ahead(i) .or. modulo(i - k, n) <= behind(i)) cycle
                  if (size_of(contour(i) - centres(k)) >= limit) cycle
                  if (is_least(i, k)) pairs = [pairs, sample_pair_t(i, k)]
               end do
            end do
         end do
      end do

   contains

      !> All centres of block c belong to those that the touching circles of block b cannot meet.
      pure logical function is_within_reach(b, c) result(within)
         integer, intent(in) :: b, c
         integer :: first(2), last(2), least(2)

         first = ([b, c] - 1)*block_length + 1
         last = min([b, c]*block_length, n)
         least = [minval(ahead(first(1):last(1))), minval(behind(first(1):last(1)))]
         if (b == c) then
            within = minval(least) >= last(1) - first(1)
            return
         end if
         ! no further than that, and not once round between first and last
         within = modulo(last(2) - first(1), n) <= least(1) .and. modulo(first(2) - last(1), n) <= modulo(last(2) - first(1), n)
         within = within .or. (modulo(last(1) - first(2), n) <= least(2) .and. &
                               modulo(first(1) - last(2), n) <= modulo(last(1) - first(2), n))
      end function is_within_reach

      !> Nearer than its eight neighbours.
      pure logical function is_least(i, k)
         integer, intent(in) :: i, k
         real(wp) :: here
         integer :: di, dk

         here = size_of(contour(i) - centres(k))
         is_least = .false.
         do dk = -1, 1
            do di = -1, 1
               if (size_of(contour(1 + modulo(i - 1 + di, n)) - centres(1 + modulo(k - 1 + dk, n))) < here) return
            end do
         end do
         is_least = .true.
      end function is_least
   end subroutine near_pairs

   !> Samples ahead and behind of each before the curve has turned by a right angle.
   pure subroutine find_reach(tangent, open, behind, ahead)
      complex(wp), intent(in) :: tangent(:)
      logical, intent(in) :: open
      integer, intent(out) :: behind(:), ahead(:)
      complex(wp), allocatable :: mean(:)            !! by block
      real(wp), allocatable :: spread(:)             !! sine of the largest angle from it; above 1: the block turns too far
      integer :: n, i, b, length

      n = size(tangent)
      allocate (mean((n + block_length - 1)/block_length), spread((n + block_length - 1)/block_length))
      do b = 1, size(mean)
         associate (t => tangent((b - 1)*block_length + 1:min(b*block_length, n)))
            mean(b) = sum(t)
            spread(b) = 2.0_wp
            if (.not. size_of(mean(b)) > 0.0_wp) cycle
            mean(b) = mean(b)/size_of(mean(b))
            if (all(real(conjg(mean(b))*t, wp) > 0.0_wp)) spread(b) = maxval(abs(aimag(conjg(mean(b))*t)))
         end associate
      end do
      do i = 1, n
         ahead(i) = 0
         do while (ahead(i) < merge(n - i, n - 1, open))
            ! a whole block, or the next sample
            length = whole(i, 1 + modulo(i + ahead(i), n), 1, merge(n - i, n - 1, open) - ahead(i))
            if (length == 0) then
               if (real(conjg(tangent(i))*tangent(1 + modulo(i + ahead(i), n)), wp) <= 0.0_wp) exit
               length = 1
            end if
            ahead(i) = ahead(i) + length
         end do
         behind(i) = 0
         do while (behind(i) < merge(i - 1, n - 1, open))
            length = whole(i, 1 + modulo(i - 2 - behind(i), n), -1, merge(i - 1, n - 1, open) - behind(i))
            if (length == 0) then
               if (real(conjg(tangent(i))*tangent(1 + modulo(i - 2 - behind(i), n)), wp) <= 0.0_wp) exit
               length = 1
            end if
            behind(i) = behind(i) + length
         end do
      end do

   contains

      !> Samples of the block that begins at `at`, or going back ends there, if none is a right angle from sample i; else 0.
      pure integer function whole(i, at, way, most)
         integer, intent(in) :: i, at, way, most
         integer :: b, first, last

         whole = 0
         b = (at - 1)/block_length + 1
         first = (b - 1)*block_length + 1
         last = min(b*block_length, n)
         if (at /= merge(first, last, way > 0) .or. last - first + 1 > most) return
         if (real(conjg(tangent(i))*mean(b), wp) > spread(b) + safely) whole = last - first + 1
      end function whole
   end subroutine find_reach

   pure real(wp) function size_of(z)
      complex(wp), intent(in) :: z

      size_of = sqrt(real(z, wp)**2 + aimag(z)**2)
   end function size_of

   pure real(wp) function longest_step(points, open) result(step)
      complex(wp), intent(in) :: points(:)
      logical, intent(in) :: open
      integer :: i

      step = 0.0_wp
      if (.not. open) step = size_of(points(1) - points(size(points)))
      do i = 2, size(points)
         step = max(step, size_of(points(i) - points(i - 1)))
      end do
   end function longest_step

   !> A circle that holds some points.
   pure subroutine enclose(points, middle, radius)
      complex(wp), intent(in) :: points(:)
      complex(wp), intent(out) :: middle
      real(wp), intent(out) :: radius
      integer :: i

      middle = sum(points)/real(size(points), wp)
      radius = 0.0_wp
      do i = 1, size(points)
         radius = max(radius, size_of(points(i) - middle))
      end do
   end subroutine enclose
end module psalm_cam_interference
