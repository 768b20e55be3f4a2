!> A four-bar whose crank turns fully and whose coupler point passes points: its motion, its linear unknowns, its bounds.
!>
!> In the complex plane, with the crank of length 1 and its angle t counted from the ground line,
!>
!>    P(t) = z0 + w1 e(t) + w2 v(t),   e = exp(i t),   v = h (a +- i R) the coupler,   h = g - e, g the ground's length,
!>
!> is the point's path. The ground pivot z0, crank and ground line w1 and the coupler point w2 enter linearly: for a given shape
!> and given inputs the best ones solve a least-squares problem. S and D, sum and difference of coupler and follower, give the
!> shape: the crank turns fully if S = (g + 1) sigma with sigma >= 1 and D = (g - 1) q with abs(q) <= 1, a box, so that no
!> position ever fails to close. Angles are in degrees. Source of the elimination: Golub and Pereyra (1973).
module psalm_path_fit
   use psalm_angles, only: unit_vector
   use psalm_kinds, only: wp, full_turn
   implicit none (type, external)
   private
   public :: fitted_path_t, path_timing_t, path_workspace_t, set_points, prepare_path, trace_coupler, trace_at, halve, fit_linear, &
             error_of, &
             lengths_of, find_violations, weigh
   public :: square, dot
   public :: at_ground, at_crank, at_coupler, at_follower, at_point, at_pivot
   public :: unknowns, shape_g, shape_s, shape_q, column_turn, column_miss, lanes, rows_most, places, samples

   ! lengths that have bounds
   integer, parameter :: at_ground = 1, at_crank = 2, at_coupler = 3, at_follower = 4, at_point = 5, at_pivot = 6
   integer, parameter :: unknowns = 9                !! z0, w1, w2 (two each), then ln g, ln sigma, q
   integer, parameter :: shape_g = 7, shape_s = 8, shape_q = 9
   integer, parameter :: column_turn = 10, column_miss = 11 !! of the normal equations: dP/dt, what a point is missed by
   integer, parameter :: lanes = 12                  !! columns, rounded up for the processor
   integer, parameter :: rows_most = 12              !! bounds, both sides
   integer, parameter :: places = 96                 !! of the crank when a timing is looked for
   integer, parameter :: samples = 64                !! of a batch
   real(wp), parameter :: least_corner = 1.0e-3_wp   !! of a straight way, in 1 - cosine of the turn
   real(wp), parameter :: singular = 1.0e-14_wp      !! relative determinant below which e and v say the same

   !> What is to be visited, scaled to a mean radius of 1 about the mean.
   type :: fitted_path_t
      integer :: n = 0
      complex(wp), allocatable :: point(:)           !! shape (n)
      real(wp), allocatable :: weight(:)             !! shape (n), their mean is 1
      real(wp), allocatable :: chord(:)              !! shape (n): to the next point, the last one's to the first
      real(wp), allocatable :: corner(:)             !! shape (n): how sharply the way, taken as a ring, turns there; sum 1
      complex(wp) :: centre = (0.0_wp, 0.0_wp)       !! mean of the points given, in their unit
      real(wp) :: size = 1.0_wp                      !! what they were divided by
      real(wp) :: weight_scale = 1.0_wp              !! what the weights were divided by
      real(wp) :: low(6) = 0.0_wp, high(6) = huge(1.0_wp) !! lengths: ground, crank, coupler, follower, coupler point, pivot
      real(wp) :: cosine = 1.0_wp                    !! of the least transmission angle; 1: any
      real(wp) :: side = 1.0_wp                      !! the assembly, +1 with the coupler's end left of the line from crank pin
                                                     !! to follower's pivot, -1 right
   end type fitted_path_t

   !> A linkage that passes the points.
   type :: path_timing_t
      integer :: way = 1                             !! which of several paths, in other directions or assemblies
      real(wp) :: g = 2.0_wp, sigma = 1.2_wp, q = 0.0_wp, side = 1.0_wp
      complex(wp) :: z0 = (0.0_wp, 0.0_wp), w1 = (1.0_wp, 0.0_wp), w2 = (0.0_wp, 0.0_wp)
      real(wp), allocatable :: t(:)                  !! shape (n), rising, degrees from the ground line
      real(wp) :: error = huge(1.0_wp)               !! weighted sum of squares
      real(wp) :: violation = 0.0_wp                 !! sum of squared relative violations
      real(wp) :: worst = 0.0_wp                     !! largest violation
   end type path_timing_t

   !> Room to work in; one object serves one thread.
   type :: path_workspace_t
      complex(wp), allocatable :: e(:), v(:), turn(:) !! shape (n): e, v, dv/dt
      complex(wp), allocatable :: grow(:, :)         !! shape (n, 3): dv by ln g, ln sigma, q
      real(wp), allocatable :: b(:, :)               !! shape (lanes, groups): products of dP/dt with all columns
      integer, allocatable :: group(:)               !! shape (n): inputs that move as one
      real(wp), allocatable :: level(:)              !! shape (n): pooling
      integer, allocatable :: last(:)
      complex(wp), allocatable :: half(:), half_next(:) !! shape (n): unit vectors at half the inputs
      complex(wp), allocatable :: e_round(:), v_round(:), half_round(:) !! shape (places)
      real(wp), allocatable :: cost(:, :)            !! shape (2*places, n): the turn twice
      real(wp), allocatable :: least(:, :)           !! shape (places, n)
      type(path_timing_t), allocatable :: batch(:)   !! shape (samples)
      real(wp), allocatable :: score(:)              !! shape (samples)
      type(path_timing_t) :: now, next, other, copy
   end type path_workspace_t

contains

   !> Scale points and bounds, and make room.
   subroutine prepare_path(x, y, weight, low, high, cosine, side, path, work)
      real(wp), intent(in) :: x(:), y(:), weight(:)  !! shape (n), in order
      real(wp), intent(in) :: low(6), high(6)        !! lengths, as `fitted_path_t` has them, in the unit of the points
      real(wp), intent(in) :: cosine                 !! of the least transmission angle
      real(wp), intent(in) :: side                   !! assembly, as `fitted_path_t` has it
      type(fitted_path_t), intent(out) :: path
      type(path_workspace_t), intent(out) :: work
      integer :: i

      call set_points(x, y, weight, path)
      path%low = low/path%size
      path%high = min(high/path%size, sqrt(huge(1.0_wp)))
      path%cosine = cosine
      path%side = side
      associate (n => path%n)
         allocate (work%e(n), work%v(n), work%turn(n), work%grow(n, 3), work%b(lanes, n), work%group(n), &
                   work%level(n), work%last(n), work%e_round(places), work%v_round(places), work%cost(2*places, n), &
                   work%least(places, n), work%half(n), work%half_next(n), work%half_round(places), &
                   work%batch(samples), work%score(samples))
         call halve([(full_turn*(real(i, wp)/real(places, wp)), i=0, places - 1)], work%half_round)
         do i = 1, samples
            allocate (work%batch(i)%t(n), source=0.0_wp)
         end do
         work%now = work%batch(1)
         work%next = work%batch(1)
         work%other = work%batch(1)
         work%copy = work%batch(1)
      end associate
   end subroutine prepare_path

   !> Scale points.
   subroutine set_points(x, y, weight, path)
      real(wp), intent(in) :: x(:), y(:), weight(:)  !! shape (n), in order
      type(fitted_path_t), intent(out) :: path

      path%n = size(x)
      path%weight_scale = sum(weight)/real(path%n, wp)
      path%weight = weight/path%weight_scale
      path%point = cmplx(x, y, wp)
      path%centre = sum(path%weight*path%point)/real(path%n, wp)
      path%point = path%point - path%centre
      path%size = sqrt(sum(path%weight*square(path%point))/real(path%n, wp))
      path%point = path%point/path%size
      path%centre = path%centre/path%size
      path%chord = sqrt(square(cshift(path%point, 1) - path%point))
      associate (to => cshift(path%point, 1) - path%point, from => path%point - cshift(path%point, -1))
         path%corner = 1.0_wp - dot(from, to)/max(sqrt(square(from)*square(to)), tiny(1.0_wp)**0.25_wp) + least_corner
      end associate
      path%corner = path%corner/sum(path%corner)
   end subroutine set_points

   elemental real(wp) function square(z)
      complex(wp), intent(in) :: z

      square = real(z, wp)**2 + aimag(z)**2
   end function square

   !> Real part of conj(a)*b: the scalar product of two vectors.
   elemental real(wp) function dot(a, b)
      complex(wp), intent(in) :: a, b

      dot = real(a, wp)*real(b, wp) + aimag(a)*aimag(b)
   end function dot

   !> e and v at inputs, and the derivatives of v where they are asked for.
   pure subroutine trace_coupler(shape, t, e, v, turn, grow)
      type(path_timing_t), intent(in) :: shape
      real(wp), intent(in) :: t(:)                   !! degrees
      complex(wp), intent(out) :: e(:), v(:)         !! shape (size(t))
      complex(wp), intent(out), optional :: turn(:)  !! dv/dt, per radian
      complex(wp), intent(out), optional :: grow(:, :) !! shape (size(t), 3): by ln g, ln sigma, q; both or neither
      complex(wp) :: half(size(t))

      call halve(t, half)
      if (present(turn) .and. present(grow)) then
         call trace_at(shape, half, e, v, turn, grow)
      else
         call trace_at(shape, half, e, v)
      end if
   end subroutine trace_coupler

   !> Unit vectors at half the inputs: the slow part of a trace, kept where the same inputs are traced twice.
   pure subroutine halve(t, half)
      real(wp), intent(in) :: t(:)                   !! degrees
      complex(wp), intent(out) :: half(:)            !! shape (size(t))
      real(wp) :: c, s
      integer :: k

      do k = 1, size(t)
         call unit_vector(0.5_wp*t(k), c, s)
         half(k) = cmplx(c, s, wp)
      end do
   end subroutine halve

   !> The same as `trace_coupler`, from the unit vectors at half the inputs.
   pure subroutine trace_at(shape, half, e, v, turn, grow)
      type(path_timing_t), intent(in) :: shape
      complex(wp), intent(in) :: half(:)
      complex(wp), intent(out) :: e(:), v(:)         !! shape (size(half))
      complex(wp), intent(out), optional :: turn(:), grow(:, :) !! as `trace_coupler` has them
      complex(wp) :: h, bend
      real(wp) :: c, s, cc, ss, d2, x, y, a, r, sd, over, ax, rx, above, below, out_x, out_y, d1
      integer :: k

      associate (g => shape%g, sigma => shape%sigma, q => shape%q)
         sd = sigma*q*(g - 1.0_wp)*(g + 1.0_wp)
         out_x = (sigma - 1.0_wp)*(sigma + 1.0_wp)
         out_y = (1.0_wp - q)*(1.0_wp + q)
         above = (g + 1.0_wp)**2
         below = (g - 1.0_wp)**2
         do k = 1, size(half)
            c = real(half(k), wp)
            s = aimag(half(k))
            cc = 4.0_wp*g*c*c
            ss = 4.0_wp*g*s*s
            e(k) = cmplx((c - s)*(c + s), 2.0_wp*c*s, wp)
            d2 = max(below + ss, tiny(1.0_wp)**0.25_wp)
            x = above*out_x + cc
            y = below*out_y + ss
            over = 0.5_wp/d2
            a = 0.5_wp + sd*over
            r = shape%side*sqrt(x*y)*over
            h = g - e(k)
            bend = cmplx(a, r, wp)
            v(k) = h*bend
            if (.not. present(turn)) cycle
            ! a root at its zero has no slope: kept finite
            x = 0.5_wp/(x + singular*(x + y) + tiny(1.0_wp)**0.25_wp)
            y = 0.5_wp/(y + singular*(x + y) + tiny(1.0_wp)**0.25_wp)
            d1 = 4.0_wp*g*s*c
            ax = -sd*d1*2.0_wp*over*over
            rx = r*(-d1*x + d1*y - 2.0_wp*d1*over)
            turn(k) = cmplx(aimag(e(k)), -real(e(k), wp), wp)*bend + h*cmplx(ax, rx, wp)
            d1 = 2.0_wp*g*(g - 1.0_wp) + ss
            ax = over*(2.0_wp*sigma*q*g*g - sd*d1*2.0_wp*over)
            rx = r*((2.0_wp*g*(g + 1.0_wp)*out_x + cc)*x + (2.0_wp*g*(g - 1.0_wp)*out_y + ss)*y - 2.0_wp*d1*over)
            grow(k, 1) = h*cmplx(ax, rx, wp) + g*bend
            grow(k, 2) = h*cmplx(over*sd, r*(2.0_wp*above*sigma**2)*x, wp)
            grow(k, 3) = h*cmplx(over*sigma*(g - 1.0_wp)*(g + 1.0_wp), -r*(2.0_wp*q*below)*y, wp)
         end do
      end associate
   end subroutine trace_at

   !> The best z0, w1, w2 of a shape and its inputs.
   pure subroutine fit_linear(path, e, v, timing, slack)
      type(fitted_path_t), intent(in) :: path
      complex(wp), intent(in) :: e(:), v(:)
      type(path_timing_t), intent(inout) :: timing
      real(wp), intent(in) :: slack                  !! ridge
      complex(wp) :: mean_e, mean_v, c, p, q
      real(wp) :: a, b, determinant
      integer :: k

      mean_e = (0.0_wp, 0.0_wp)
      mean_v = mean_e
      do k = 1, path%n
         mean_e = mean_e + path%weight(k)*e(k)
         mean_v = mean_v + path%weight(k)*v(k)
      end do
      mean_e = mean_e/real(path%n, wp)
      mean_v = mean_v/real(path%n, wp)
      a = slack
      b = slack
      c = (0.0_wp, 0.0_wp)
      p = c
      q = c
      do k = 1, path%n
         associate (w => path%weight(k), ek => e(k) - mean_e, vk => v(k) - mean_v)
            a = a + w*square(ek)
            b = b + w*square(vk)
            c = c + w*conjg(ek)*vk
            p = p + w*conjg(ek)*path%point(k)
            q = q + w*conjg(vk)*path%point(k)
         end associate
      end do
      determinant = max(a*b - square(c), singular*a*b, tiny(1.0_wp))
      timing%w1 = (b*p - c*q)/determinant
      timing%w2 = (a*q - conjg(c)*p)/determinant
      timing%z0 = -timing%w1*mean_e - timing%w2*mean_v ! the points' mean is zero
   end subroutine fit_linear

   !> Weighted sum of the squared distances.
   pure real(wp) function error_of(path, e, v, timing) result(error)
      type(fitted_path_t), intent(in) :: path
      complex(wp), intent(in) :: e(:), v(:)
      type(path_timing_t), intent(in) :: timing
      integer :: k

      error = 0.0_wp
      do k = 1, path%n
         error = error + path%weight(k)*square(timing%z0 + timing%w1*e(k) + timing%w2*v(k) - path%point(k))
      end do
   end function error_of

   !> Ground, crank, coupler, follower, distance of the coupler point from the crank pin, of the crank's pivot from the origin.
   pure function lengths_of(path, timing) result(lengths)
      type(fitted_path_t), intent(in) :: path
      type(path_timing_t), intent(in) :: timing
      real(wp) :: lengths(6), crank, half_sum, half_difference

      crank = sqrt(square(timing%w1))
      half_sum = 0.5_wp*(timing%g + 1.0_wp)*timing%sigma
      half_difference = 0.5_wp*(timing%g - 1.0_wp)*timing%q
      lengths = [timing%g*crank, crank, crank*(half_sum + half_difference), crank*(half_sum - half_difference), &
                 sqrt(square(timing%w2))*(half_sum + half_difference), sqrt(square(timing%z0 + path%centre))]
   end function lengths_of

   !> Relative violations of the bounds that are violated, and their derivatives by the unknowns.
   pure subroutine find_violations(path, timing, margin, count, amount, rows)
      type(fitted_path_t), intent(in) :: path
      type(path_timing_t), intent(in) :: timing
      real(wp), intent(in) :: margin                 !! how far inside the bounds, relatively
      integer, intent(out) :: count
      real(wp), intent(out) :: amount(rows_most)
      real(wp), intent(out), optional :: rows(unknowns, rows_most)
      real(wp) :: lengths(6)
      integer :: k

      lengths = lengths_of(path, timing)
      count = 0
      do k = 1, 6
         if (lengths(k) > path%high(k)*(1.0_wp - margin)) then
            count = count + 1
            amount(count) = lengths(k)/path%high(k) - (1.0_wp - margin)
            if (present(rows)) rows(:, count) = slope_of_length(k)/path%high(k)
         else if (lengths(k) < path%low(k)*(1.0_wp + margin)) then
            count = count + 1
            amount(count) = (1.0_wp + margin) - lengths(k)/path%low(k)
            if (present(rows)) rows(:, count) = -slope_of_length(k)/path%low(k)
         end if
      end do

   contains

      pure function slope_of_length(which) result(slope)
         integer, intent(in) :: which
         real(wp) :: slope(unknowns), crank, arm, ds, dd
         complex(wp) :: from

         slope = 0.0_wp
         crank = sqrt(square(timing%w1))
         ! halves of S and D
         ds = 0.5_wp*(timing%g + 1.0_wp)*timing%sigma
         dd = 0.5_wp*(timing%g - 1.0_wp)*timing%q
         if (which <= at_follower) then
            slope(3) = lengths(which)*real(timing%w1, wp)/max(crank, tiny(1.0_wp))**2
            slope(4) = lengths(which)*aimag(timing%w1)/max(crank, tiny(1.0_wp))**2
         end if
         arm = crank
         if (which == at_point) then
            arm = sqrt(square(timing%w2))
            slope(5) = lengths(which)*real(timing%w2, wp)/max(arm, tiny(1.0_wp))**2
            slope(6) = lengths(which)*aimag(timing%w2)/max(arm, tiny(1.0_wp))**2
         end if
         select case (which)
         case (at_ground)
            slope(shape_g) = lengths(which)
         case (at_coupler, at_point)
            slope(shape_g) = 0.5_wp*arm*timing%g*(timing%sigma + timing%q)
            slope(shape_s) = arm*ds
            slope(shape_q) = 0.5_wp*arm*(timing%g - 1.0_wp)
         case (at_follower)
            slope(shape_g) = 0.5_wp*arm*timing%g*(timing%sigma - timing%q)
            slope(shape_s) = arm*ds
            slope(shape_q) = -0.5_wp*arm*(timing%g - 1.0_wp)
         case (at_pivot)
            from = timing%z0 + path%centre
            slope(1) = real(from, wp)/max(lengths(which), tiny(1.0_wp))
            slope(2) = aimag(from)/max(lengths(which), tiny(1.0_wp))
         end select
      end function slope_of_length
   end subroutine find_violations

   !> Error and violations of a timing whose linear unknowns are set.
   pure subroutine weigh(path, e, v, margin, timing)
      type(fitted_path_t), intent(in) :: path
      complex(wp), intent(in) :: e(:), v(:)
      real(wp), intent(in) :: margin
      type(path_timing_t), intent(inout) :: timing
      real(wp) :: amount(rows_most)
      integer :: count

      timing%error = error_of(path, e, v, timing)
      call find_violations(path, timing, margin, count, amount)
      timing%violation = sum(amount(:count)**2)
      timing%worst = 0.0_wp
      if (count > 0) timing%worst = maxval(amount(:count))
   end subroutine weigh
end module psalm_path_fit
