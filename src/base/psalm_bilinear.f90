!> All roots of bilinear equations by homotopy.
!>
!> 2n equations x^T M_j y = 0 in x and y, each of n+1 homogeneous unknowns, have C(2n, n) roots (Bezout's number of two
!> groups of unknowns). A start system g of the same form, each equation a product of a random linear form in x and one in y,
!> has as many that are written down at once; they are followed to those of f along H = (1-t) gamma g + t f, t from 0 to 1, by
!> cubic prediction from two points and Newton's method. Random coordinates keep the paths away from infinity and, with the
!> complex gamma, from each other. That two paths have run together shows by equal ends; all are then followed again in
!> shorter steps. Source: Morgan and Sommese (1987), homotopies of several groups of variables; Sommese and Wampler (2005).
module psalm_bilinear
   use psalm_kinds, only: wp
   use psalm_linear, only: eliminate, product_of
   use psalm_stop, only: stop_t, is_to_end, tell_host
   use psalm_xoshiro, only: xoshiro_t, purpose_sample
   implicit none (type, external)
   private
   public :: bilinear_roots_t, find_bilinear_roots, null_space

   integer, parameter :: most_steps = 2000          !! of a path
   integer, parameter :: rounds = 4                 !! of all paths, each in shorter steps
   real(wp), parameter :: trusted = 2.0e-2_wp       !! first correction, against the point
   real(wp), parameter :: easy = 1.0e-3_wp          !! below this the next step is longer
   real(wp), parameter :: converged = 1.0e-6_wp     !! second correction of a step that is taken
   real(wp), parameter :: first_step = 2.0e-2_wp, least_step = 1.0e-9_wp !! of t
   real(wp), parameter :: longer = 1.6_wp, shorter = 0.5_wp
   real(wp), parameter :: settled = 1.0e-9_wp       !! last correction at a simple root
   real(wp), parameter :: same = 1.0e-6_wp          !! distance of roots that are one
   integer, parameter :: seed = 19

   !> What was found.
   type :: bilinear_roots_t
      complex(wp), allocatable :: x(:, :), y(:, :)  !! shape (n+1, paths): of length 1
      logical, allocatable :: simple(:)             !! shape (paths): the path ends in a root that stands alone
      logical :: complete = .false.                 !! all ends are simple and differ: these are all roots
      integer :: steps = 0                          !! of all paths
   end type bilinear_roots_t

contains

   !> Follow all paths. Equal input gives equal roots, to the last bit.
   subroutine find_bilinear_roots(forms, roots, stop)
      complex(wp), intent(in) :: forms(:, :, :)     !! shape (n+1, n+1, 2n): M_j
      type(bilinear_roots_t), intent(out) :: roots
      type(stop_t), intent(in), optional :: stop    !! asked before each path: the ends so far are there
      complex(wp) :: a(size(forms, 1), size(forms, 1), size(forms, 3)), d(size(forms, 1), size(forms, 1), size(forms, 3))
      complex(wp) :: to_x(size(forms, 1), size(forms, 1)), to_y(size(forms, 1), size(forms, 1))
      complex(wp) :: alpha(size(forms, 1), size(forms, 3)), beta(size(forms, 1), size(forms, 3))
      complex(wp) :: v(size(forms, 3)), point(size(forms, 1)), gamma(1)
      integer :: chosen(size(forms, 3)/2)
      type(xoshiro_t) :: random
      logical :: simple
      integer :: n, j, k, paths, round

      n = size(forms, 3)/2
      call random%seed(seed, purpose_sample)
      paths = binomial(2*n, n)
      allocate (roots%x(n + 1, paths), roots%y(n + 1, paths), roots%simple(paths))
      do round = 1, rounds
         call random_frame(random, to_x)
         call random_frame(random, to_y)
         call draw(random, gamma)
         do j = 1, 2*n
            call draw(random, alpha(:, j))
            call draw(random, beta(:, j))
            d(:, :, j) = product_of(transpose(to_x), product_of(forms(:, :, j), to_y))
            d(:, :, j) = d(:, :, j)/sqrt(sum(abs(d(:, :, j))**2))
            do k = 1, n + 1
               a(:, k, j) = gamma(1)*alpha(:, j)*beta(k, j)
            end do
            a(:, :, j) = a(:, :, j)/sqrt(sum(abs(a(:, :, j))**2))
            d(:, :, j) = d(:, :, j) - a(:, :, j)
         end do
         chosen = [(j, j=1, n)]
         do k = 1, paths
            if (is_to_end(stop)) then
               roots%x = roots%x(:, :k - 1)
               roots%y = roots%y(:, :k - 1)
               roots%simple = roots%simple(:k - 1)
               roots%complete = .false.
               return
            end if
            call begin(alpha(:, chosen), v(:n))
            call begin(beta(:, pack([(j, j=1, 2*n)], [(all(chosen /= j), j=1, 2*n)])), v(n + 1:))
            call follow_path(a, d, 0.25_wp**(round - 1), v, simple, roots%steps)
            point = product_of(to_x, [(1.0_wp, 0.0_wp), v(:n)])
            roots%x(:, k) = point/sqrt(sum(abs(point)**2))
            point = product_of(to_y, [(1.0_wp, 0.0_wp), v(n + 1:)])
            roots%y(:, k) = point/sqrt(sum(abs(point)**2))
            roots%simple(k) = simple
            call next_choice(chosen, 2*n)
            call tell_host(stop, k, paths)
         end do
         roots%complete = all(roots%simple)
         if (.not. any_equal(roots)) exit
         roots%complete = .false.
      end do
   end subroutine find_bilinear_roots

   !> n over k.
   pure integer function binomial(n, k)
      integer, intent(in) :: n, k
      integer :: i

      binomial = 1
      do i = 1, k
         binomial = (binomial*(n - k + i))/i
      end do
   end function binomial

   !> The next selection in the order of the dictionary.
   pure subroutine next_choice(chosen, most)
      integer, intent(inout) :: chosen(:)
      integer, intent(in) :: most
      integer :: i, k

      do i = size(chosen), 1, -1
         if (chosen(i) == most - size(chosen) + i) cycle
         chosen(i) = chosen(i) + 1
         chosen(i + 1:) = [(chosen(i) + k, k=1, size(chosen) - i)]
         return
      end do
   end subroutine next_choice

   !> Numbers in the square of half width 1 about 0.
   subroutine draw(random, values)
      type(xoshiro_t), intent(inout) :: random
      complex(wp), intent(out) :: values(:)
      real(wp) :: re, im
      integer :: i

      do i = 1, size(values)
         call random%next(re)
         call random%next(im)
         values(i) = cmplx(2.0_wp*re - 1.0_wp, 2.0_wp*im - 1.0_wp, wp)
      end do
   end subroutine draw

   !> Columns of length 1, square to each other, in random directions.
   subroutine random_frame(random, frame)
      type(xoshiro_t), intent(inout) :: random
      complex(wp), intent(out) :: frame(:, :)
      integer :: k

      do k = 1, size(frame, 2)
         call draw(random, frame(:, k))
         call square_to(frame(:, :k - 1), frame(:, k))
      end do
   end subroutine random_frame

   !> Take out of a vector what lies along others, of length 1 and square to each other, and give it length 1. `left` is the part
   !> that was left.
   subroutine square_to(others, vector, left)
      complex(wp), intent(in) :: others(:, :)
      complex(wp), intent(inout) :: vector(:)
      real(wp), intent(out), optional :: left
      real(wp) :: before
      integer :: twice, k

      before = sqrt(sum(abs(vector)**2))
      do twice = 1, 2
         do k = 1, size(others, 2)
            vector = vector - dot_product(others(:, k), vector)*others(:, k)
         end do
      end do
      if (present(left)) left = sqrt(sum(abs(vector)**2))/max(before, tiny(1.0_wp))
      vector = vector/max(sqrt(sum(abs(vector)**2)), tiny(1.0_wp))
   end subroutine square_to

   !> Directions in which the rows of a matrix vanish, as columns of length 1, square to each other and turned at random.
   !>
   !> `valid` is false where the rows depend on each other.
   subroutine null_space(rows, space, valid)
      complex(wp), intent(in) :: rows(:, :)          !! shape (r, m)
      complex(wp), allocatable, intent(out) :: space(:, :) !! shape (m, m - r)
      logical, intent(out) :: valid
      complex(wp) :: basis(size(rows, 2), size(rows, 2))
      type(xoshiro_t) :: random
      real(wp) :: left
      integer :: k

      valid = size(rows, 1) <= size(rows, 2)
      if (.not. valid) return
      call random%seed(seed, purpose_sample)
      do k = 1, size(rows, 2)
         if (k <= size(rows, 1)) then
            basis(:, k) = conjg(rows(k, :))
         else
            call draw(random, basis(:, k))
         end if
         call square_to(basis(:, :k - 1), basis(:, k), left)
         if (left < sqrt(epsilon(1.0_wp))) valid = .false.
      end do
      space = basis(:, size(rows, 1) + 1:)
   end subroutine null_space

   !> The point at which n linear forms vanish, with first coordinate 1.
   subroutine begin(forms, point)
      complex(wp), intent(in) :: forms(:, :)         !! shape (n+1, n)
      complex(wp), intent(out) :: point(:)           !! shape (n)
      complex(wp) :: matrix(size(point), size(point)), right(size(point), 1)
      logical :: valid

      matrix = transpose(forms(2:, :))
      right(:, 1) = -forms(1, :)
      call eliminate(matrix, right, valid)
      point = right(:, 1)
   end subroutine begin

   !> Two ends that are one root although either stands alone: a path has changed to another.
   pure logical function any_equal(roots)
      type(bilinear_roots_t), intent(in) :: roots
      integer :: i, k

      any_equal = .false.
      do i = 1, size(roots%simple)
         do k = 1, i - 1
            if (.not. (roots%simple(i) .and. roots%simple(k))) cycle
            if (apart(roots%x(:, i), roots%x(:, k)) < same .and. apart(roots%y(:, i), roots%y(:, k)) < same) any_equal = .true.
         end do
      end do
   end function any_equal

   !> Sine of the angle between two directions of length 1.
   pure real(wp) function apart(a, b)
      complex(wp), intent(in) :: a(:), b(:)

      apart = sqrt(sum(abs(a - dot_product(b, a)*b)**2))
   end function apart

   ! ---- one path ----------------------------------------------------------------------------------------------------

   !> Follow a root of a to one of a + d.
   subroutine follow_path(a, d, caution, v, simple, steps)
      complex(wp), intent(in), contiguous :: a(:, :, :), d(:, :, :)
      real(wp), intent(in) :: caution               !! 1: as usual; less: in shorter steps
      complex(wp), intent(inout) :: v(:)            !! shape (2n)
      logical, intent(out) :: simple
      integer, intent(inout) :: steps
      complex(wp) :: slope(size(v)), before(size(v)), slope_before(size(v)), next(size(v)), slope_next(size(v)), step(size(v))
      real(wp) :: t, h, h_before, first, second, s
      logical :: valid, have_before
      integer :: i

      t = 0.0_wp
      h = first_step*caution
      h_before = 0.0_wp
      have_before = .false.
      simple = .false.
      next = v
      call correct(a, d, t, next, step, slope, valid)
      if (.not. valid) return
      before = v
      slope_before = slope
      do i = 1, most_steps
         if (t >= 1.0_wp) exit
         h = min(h, 1.0_wp - t)
         next = v + h*slope
         if (have_before) then
            ! the cubic through both points with their slopes
            s = h/h_before
            next = next + s**2*(3.0_wp + 2.0_wp*s)*(before - v) + h*s*((1.0_wp + s)*slope_before + (2.0_wp + s)*slope)
         end if
         call correct(a, d, t + h, next, step, slope_next, valid)
         if (valid) then
            first = size_of(step)/(1.0_wp + size_of(v))
            valid = first < trusted*caution
         end if
         if (valid) then
            call correct(a, d, t + h, next, step, slope_next, valid)
            second = size_of(step)/(1.0_wp + size_of(v))
            valid = valid .and. second < converged
         end if
         if (.not. valid) then
            h = shorter*h
            if (h < least_step) then
               simple = .false.
               return
            end if
            cycle
         end if
         steps = steps + 1
         before = v
         slope_before = slope
         h_before = h
         have_before = .true.
         v = next
         slope = slope_next
         t = merge(1.0_wp, t + h, t + h > 1.0_wp - 0.5_wp*least_step)
         if (first < easy*caution) h = longer*h
      end do
      if (t < 1.0_wp) return
      do i = 1, 3
         next = v
         call correct(a, d, 1.0_wp, next, step, slope, valid)
         if (.not. valid) return
         v = next
      end do
      simple = size_of(step) < settled*(1.0_wp + size_of(v))
   end subroutine follow_path

   pure real(wp) function size_of(v)
      complex(wp), intent(in) :: v(:)

      size_of = maxval(abs(v%re) + abs(v%im))
   end function size_of

   !> One step of Newton's method at t, and the slope of the path where the step began.
   subroutine correct(a, d, t, v, step, slope, valid)
      complex(wp), intent(in), contiguous :: a(:, :, :), d(:, :, :)
      real(wp), intent(in) :: t
      complex(wp), intent(inout) :: v(:)
      complex(wp), intent(out) :: step(:), slope(:)
      logical, intent(out) :: valid
      complex(wp) :: matrix(size(v), size(v)), right(size(v), 2)
      complex(wp) :: x(size(a, 1)), y(size(a, 1)), by_x(size(a, 1)), form(size(a, 1)), value, rate
      integer :: j, k, n

      n = size(a, 1) - 1
      x(1) = (1.0_wp, 0.0_wp)
      y(1) = (1.0_wp, 0.0_wp)
      x(2:) = v(:n)
      y(2:) = v(n + 1:)
      do j = 1, 2*n
         by_x = (0.0_wp, 0.0_wp)
         value = (0.0_wp, 0.0_wp)
         rate = (0.0_wp, 0.0_wp)
         do k = 1, n + 1
            form = a(:, k, j) + t*d(:, k, j)
            by_x = by_x + form*y(k)
            rate = rate + sum(x*d(:, k, j))*y(k)
            if (k > 1) matrix(j, n + k - 1) = sum(x*form)
         end do
         value = sum(x*by_x)
         matrix(j, :n) = by_x(2:)
         right(j, 1) = -value
         right(j, 2) = -rate
      end do
      call eliminate(matrix, right, valid)
      step = right(:, 1)
      slope = right(:, 2)
      if (valid) v = v + step
   end subroutine correct
end module psalm_bilinear
