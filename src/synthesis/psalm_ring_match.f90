!> How well a random linkage whose crank turns can trace a closed curve, at little cost: the path of its output point and the
!> desired curve are compared at the same parts of their lengths, from every start and either way round.
!>
!> Let J(t) and u(t) be as in `psalm_linear_unknowns`; w = w2/w1 is drawn, and J + w u is the path but for its place, size and
!> direction. At even parts of the length of path and curve, the sum of squared distances is least, over place, size and direction,
!> where the correlation of the two rows of complex numbers is largest: one number for each start. For the best start the points are
!> passed where path and curve have the same part of their lengths behind them. With these inputs z0, w1, w2 are solved for, which
!> gives a better w, and so on. What lies between two neighbouring points counts as the points do.
module psalm_ring_match
   use psalm_kinds, only: wp
   use psalm_path_fit, only: fitted_path_t, path_timing_t, fit_linear, error_of, square
   implicit none (type, external)
   private
   public :: ring_match_t, laid_t, prepare_ring, match_ring

   integer, parameter :: marks = 40                  !! even parts of the length of path and curve
   integer, parameter :: passes = 3                  !! at most, each with a better w
   real(wp), parameter :: widest_gap = 4.0_wp        !! from the last point of a closed curve to the first, in mean distances
   real(wp), parameter :: worth = 0.98_wp            !! of the error before: what another pass is made for

   type :: ring_match_t
      logical :: applies = .false.                   !! the points lie on a closed curve
      real(wp), allocatable :: part(:)               !! shape (n): of the length, from the first point to each
      real(wp) :: x(marks, 2) = 0.0_wp, y(marks, 2) = 0.0_wp !! the curve at even parts, either way; mean 0
   end type ring_match_t

   !> A linkage that passes the points.
   type :: laid_t
      real(wp) :: error = huge(1.0_wp)               !! weighted sum of squares, in sizes of the points; huge: it does not move
      integer :: way = 1                             !! 1: the points in their order, 2: against it
      real(wp), allocatable :: turns(:)              !! shape (n): of the crank from the first step; they rise, or fall (way 2)
      real(wp) :: w1 = 0.0_wp, w2 = 0.0_wp           !! sizes of these, in the unit of the points
   end type laid_t

contains

   !> Lay out the desired curve. It is a polygon through the points.
   subroutine prepare_ring(path, ring)
      type(fitted_path_t), intent(in) :: path
      type(ring_match_t), intent(out) :: ring
      real(wp) :: length, at, t
      complex(wp) :: point(marks)
      integer :: k, m

      allocate (ring%part(path%n))
      length = sum(path%chord)
      ring%applies = length > 0.0_wp
      if (ring%applies) ring%applies = path%chord(path%n) <= widest_gap*length/real(path%n, wp)
      if (.not. ring%applies) return
      ring%part(1) = 0.0_wp
      do k = 2, path%n
         ring%part(k) = ring%part(k - 1) + path%chord(k - 1)/length
      end do
      k = 1
      do m = 1, marks
         at = real(m - 1, wp)/real(marks, wp)
         do while (k < path%n)
            if (ring%part(k + 1) > at) exit
            k = k + 1
         end do
         t = 0.0_wp
         if (path%chord(k) > 0.0_wp) t = min((at - ring%part(k))*length/path%chord(k), 1.0_wp)
         associate (next => 1 + modulo(k, path%n))
            point(m) = path%point(k) + t*(path%point(next) - path%point(k))
         end associate
      end do
      point = point - sum(point)/real(marks, wp)
      ring%x(:, 1) = real(point, wp)
      ring%y(:, 1) = aimag(point)
      do m = 1, marks
         ring%x(m, 2) = ring%x(1 + modulo(1 - m, marks), 1)
         ring%y(m, 2) = ring%y(1 + modulo(1 - m, marks), 1)
      end do
   end subroutine prepare_ring

   !> The inputs at which a linkage passes the points best. `laid` is replaced if that is better than what it has.
   subroutine match_ring(ring, path, joint, arm, ratio, ways, laid)
      type(ring_match_t), intent(in) :: ring         !! it applies
      type(fitted_path_t), intent(in) :: path
      complex(wp), intent(in) :: joint(:), arm(:)    !! shape (steps of a turn): J, u
      complex(wp), intent(in) :: ratio               !! w to begin with
      integer, intent(in) :: ways                    !! 1: in the order of the points only
      type(laid_t), intent(inout) :: laid
      complex(wp) :: e(path%n), v(path%n), w
      real(wp) :: turns(path%n), along(0:size(joint)), before, error
      type(path_timing_t) :: fit
      integer :: pass, way, first

      w = ratio
      before = huge(before)
      do pass = 1, passes
         call measure_length(joint, arm, w, along)
         if (.not. along(size(joint)) > 0.0_wp) return
         call lay_on(ring, joint, arm, w, along, ways, first, way)
         call pass_points(ring, joint, arm, along, first, way, e, v, turns)
         call fit_linear(path, e, v, fit, 0.0_wp)
         error = error_of(path, e, v, fit)
         if (error < laid%error) then
            laid%error = error
            laid%way = way
            laid%turns = turns
            laid%w1 = path%size*sqrt(square(fit%w1))
            laid%w2 = path%size*sqrt(square(fit%w2))
         end if
         if (.not. (error < worth*before .and. square(fit%w1) > 0.0_wp)) return
         before = error
         w = fit%w2/fit%w1
      end do
   end subroutine match_ring

   !> Length of the path from its first step to each.
   pure subroutine measure_length(joint, arm, w, along)
      complex(wp), intent(in) :: joint(:), arm(:)
      complex(wp), intent(in) :: w
      real(wp), intent(out) :: along(0:)             !! shape (steps + 1)
      real(wp) :: x(size(joint) + 1), y(size(joint) + 1), step(size(joint))
      integer :: j, n

      n = size(joint)
      do j = 1, n
         x(j) = real(joint(j), wp) + real(w, wp)*real(arm(j), wp) - aimag(w)*aimag(arm(j))
         y(j) = aimag(joint(j)) + real(w, wp)*aimag(arm(j)) + aimag(w)*real(arm(j), wp)
      end do
      x(n + 1) = x(1)
      y(n + 1) = y(1)
      do j = 1, n
         step(j) = sqrt((x(j + 1) - x(j))**2 + (y(j + 1) - y(j))**2)
      end do
      along(0) = 0.0_wp
      do j = 1, n
         along(j) = along(j - 1) + step(j)
      end do
   end subroutine measure_length

   !> The start, in even parts of the length, and the way for which the curves agree best.
   pure subroutine lay_on(ring, joint, arm, w, along, ways, first, way)
      type(ring_match_t), intent(in) :: ring
      complex(wp), intent(in) :: joint(:), arm(:)
      complex(wp), intent(in) :: w
      real(wp), intent(in) :: along(0:)              !! shape (steps + 1)
      integer, intent(in) :: ways
      integer, intent(out) :: first, way
      real(wp) :: x(2*marks), y(2*marks), re(marks), im(marks), part, best ! the path twice, correlations
      complex(wp) :: p, q
      integer :: m, j, k, next

      j = 1
      do m = 1, marks
         call find_place(along, along(size(joint))*real(m - 1, wp)/real(marks, wp), j, part)
         next = 1 + modulo(j, size(joint))
         p = joint(j) + w*arm(j)
         q = joint(next) + w*arm(next)
         x(m) = real(p, wp) + part*(real(q, wp) - real(p, wp))
         y(m) = aimag(p) + part*(aimag(q) - aimag(p))
      end do
      x(marks + 1:) = x(:marks)
      y(marks + 1:) = y(:marks)
      best = -1.0_wp
      first = 1
      way = 1
      do k = 1, ways
         re = 0.0_wp
         im = 0.0_wp
         do j = 1, marks
            do m = 1, marks
               re(m) = re(m) + x(m + j - 1)*ring%x(j, k) + y(m + j - 1)*ring%y(j, k)
               im(m) = im(m) + x(m + j - 1)*ring%y(j, k) - y(m + j - 1)*ring%x(j, k)
            end do
         end do
         re = re**2 + im**2
         m = maxloc(re, dim=1)
         if (re(m) <= best) cycle
         best = re(m)
         first = m
         way = k
      end do
   end subroutine lay_on

   !> J and u where the points are passed, and the inputs there in turns, rising for the first way, falling for the other.
   pure subroutine pass_points(ring, joint, arm, along, first, way, e, v, turns)
      type(ring_match_t), intent(in) :: ring
      complex(wp), intent(in) :: joint(:), arm(:)
      real(wp), intent(in) :: along(0:)
      integer, intent(in) :: first, way
      complex(wp), intent(out) :: e(:), v(:)         !! shape (n)
      real(wp), intent(out) :: turns(:)              !! shape (n)
      real(wp) :: at, part, whole
      integer :: i, j, next

      j = 1
      do i = 1, size(turns)
         at = real(first - 1, wp)/real(marks, wp) + merge(ring%part(i), 1.0_wp - ring%part(i), way == 1)
         whole = aint(at)
         at = (at - whole)*along(size(joint))
         if (at < along(j - 1) .or. way == 2) j = 1
         call find_place(along, at, j, part)
         next = 1 + modulo(j, size(joint))
         e(i) = joint(j) + part*(joint(next) - joint(j))
         v(i) = arm(j) + part*(arm(next) - arm(j))
         turns(i) = whole + (real(j - 1, wp) + part)/real(size(joint), wp)
      end do
   end subroutine pass_points

   !> The step in which a length is reached, and at what part of it; from step j on.
   pure subroutine find_place(along, length, j, part)
      real(wp), intent(in) :: along(0:), length
      integer, intent(inout) :: j
      real(wp), intent(out) :: part

      do while (j < ubound(along, 1))
         if (along(j) > length) exit
         j = j + 1
      end do
      part = 0.0_wp
      if (along(j) > along(j - 1)) part = min(max((length - along(j - 1))/(along(j) - along(j - 1)), 0.0_wp), 1.0_wp)
   end subroutine find_place
end module psalm_ring_match
