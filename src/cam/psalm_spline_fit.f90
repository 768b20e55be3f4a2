!> Periodic B-splines on even knots by least squares, with bounds on their first two derivatives.
!>
!> The fit is a quadratic program in the control values: the normal equations, and one inequality for each bound at each place of a
!> grid, solved by the dual method of Goldfarb and Idnani, Mathematical Programming 27 (1983) 1-33. Bounds that are exceeded
!> between the places are drawn in until they are kept everywhere. Basis: Cox and de Boor.
module psalm_spline_fit
   use psalm_dense, only: factors_t, factorise, solve
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: fit_spline, basis_of

   integer, parameter :: places = 16             !! of the grid in every piece
   integer, parameter :: finer = 4               !! times as many where the bounds are assessed
   integer, parameter :: tightenings = 8
   real(wp), parameter :: well_posed = 1.0e-12_wp !! reciprocal condition below which points are missing
   real(wp), parameter :: kept = 1.0e-9_wp       !! part of a bound by which it may be exceeded
   real(wp), parameter :: nothing = 1.0e-13_wp   !! relative size of a direction that is rounding

contains

   !> Coefficients of the pieces in u = 0 ... 1, by powers. Errors: `found` is false where points are missing, or the program for
   !> the bounds does not end.
   subroutine fit_spline(at, values, weight, period, degree, bounds, pieces, found)
      real(wp), intent(in) :: at(:), values(:), weight(:) !! shape (n); 0 <= at < period
      real(wp), intent(in) :: period
      integer, intent(in) :: degree
      real(wp), intent(in) :: bounds(2)              !! of the first and second derivative by `at`; 0: none
      real(wp), intent(out) :: pieces(0:, :)         !! shape (0:degree, number of pieces)
      logical, intent(out) :: found
      real(wp) :: basis(0:degree, 0:degree), row(0:degree), normal(size(pieces, 2), size(pieces, 2)), right(size(pieces, 2)), &
                  control(size(pieces, 2)), middle, u, width, tight(2), most(2)
      type(factors_t) :: factors
      integer :: m, i, j, k, piece, round

      m = size(pieces, 2)
      width = period/real(m, wp)
      basis = basis_of(degree)
      middle = sum(values)/real(size(values), wp)
      normal = 0.0_wp
      right = 0.0_wp
      do i = 1, size(at)
         piece = min(int(at(i)/width), m - 1)
         u = at(i)/width - real(piece, wp)
         row = matvec(u)
         do j = 0, degree
            associate (column => 1 + modulo(piece + j, m))
               right(column) = right(column) + weight(i)*row(j)*(values(i) - middle)
               do k = 0, degree
                  normal(1 + modulo(piece + k, m), column) = normal(1 + modulo(piece + k, m), column) + weight(i)*row(j)*row(k)
               end do
            end associate
         end do
      end do
      pieces = 0.0_wp
      call factorise(normal, factors)
      found = factors%reciprocal_condition > well_posed
      if (.not. found) return
      control = solve(factors, right)
      call expand()
      tight = bounds
      do round = 1, tightenings
         most = [greatest(1), greatest(2)]
         if (all(most <= bounds*(1.0_wp + kept) .or. .not. bounds > 0.0_wp)) return
         where (most > bounds .and. round > 1 .and. bounds > 0.0_wp) tight = tight*(bounds/most)
         control = solve(factors, right)
         call obey(factors, basis, degree, width, tight, control, found)
         if (.not. found) return
         call expand()
      end do

   contains

      pure function matvec(u) result(row)
         real(wp), intent(in) :: u
         real(wp) :: row(0:degree)
         integer :: power

         row = 0.0_wp
         do power = degree, 0, -1
            row = row*u + basis(power, :)
         end do
      end function matvec

      !> Control values to powers.
      subroutine expand()
         integer :: i, j

         pieces = 0.0_wp
         do i = 1, m
            do j = 0, degree
               pieces(:, i) = pieces(:, i) + basis(:, j)*control(1 + modulo(i - 1 + j, m))
            end do
            pieces(0, i) = pieces(0, i) + middle
         end do
      end subroutine expand

      !> Greatest size of a derivative on a grid finer than that of the bounds.
      pure real(wp) function greatest(order)
         integer, intent(in) :: order
         integer :: i, k

         greatest = 0.0_wp
         do i = 1, m
            do k = 0, places*finer
               greatest = max(greatest, abs(derivative(pieces(:, i), order, real(k, wp)/real(places*finer, wp))))
            end do
         end do
         greatest = greatest/width**order
      end function greatest
   end subroutine fit_spline

   !> Derivative of a polynomial by powers.
   pure real(wp) function derivative(c, order, u)
      real(wp), intent(in) :: c(0:), u
      integer, intent(in) :: order
      integer :: power, k
      real(wp) :: factor

      derivative = 0.0_wp
      do power = size(c) - 1, order, -1
         factor = c(power)
         do k = 0, order - 1
            factor = factor*real(power - k, wp)
         end do
         derivative = derivative*u + factor
      end do
   end function derivative

   !> Powers of u of the B-splines of a degree that are not zero on a piece of even knots: (power, control value from the first on).
   pure function basis_of(degree) result(basis)
      integer, intent(in) :: degree
      real(wp) :: basis(0:degree, 0:degree)
      real(wp) :: last(0:degree, -1:degree)
      integer :: p, j

      basis = 0.0_wp
      basis(0, 0) = 1.0_wp
      do p = 1, degree
         last = 0.0_wp
         last(:, 0:p - 1) = basis(:, 0:p - 1)
         do j = 0, p
            basis(:, j) = real(p - j, wp)*last(:, j - 1) + real(1 + j, wp)*last(:, j)
            basis(1:, j) = basis(1:, j) + last(:degree - 1, j - 1) - last(:degree - 1, j)
            basis(:, j) = basis(:, j)/real(p, wp)
         end do
      end do
   end function basis_of

   !> Move the control values from the least of x N x/2 - r x to the least under the bounds, with as few of them active as matter.
   subroutine obey(factors, basis, degree, width, bounds, control, found)
      type(factors_t), intent(in) :: factors         !! of N
      integer, intent(in) :: degree
      real(wp), intent(in) :: basis(0:degree, 0:degree), width, bounds(2)
      real(wp), intent(inout) :: control(:)
      logical, intent(out) :: found
      real(wp), allocatable :: active(:, :), inverse(:, :), multiplier(:), share(:), small(:, :)
      real(wp) :: a(size(control)), b, h(size(control)), z(size(control)), over, full, part, step, own
      type(factors_t) :: of_small
      integer :: m, round, j, k, drop

      m = size(control)
      allocate (active(m, 0), inverse(m, 0), multiplier(0))
      do round = 1, 20*m
         call worst(a, b, over)
         found = over <= kept*b
         if (found) return
         h = solve(factors, a)
         own = 0.0_wp
         do
            allocate (share(size(multiplier)))
            z = h
            if (size(multiplier) > 0) then
               allocate (small(size(multiplier), size(multiplier)))
               do j = 1, size(multiplier)
                  do k = 1, size(multiplier)
                     small(k, j) = sum(active(:, k)*inverse(:, j))
                  end do
                  share(j) = sum(active(:, j)*h)
               end do
               call factorise(small, of_small)
               share = solve(of_small, share)
               do j = 1, size(multiplier)
                  z = z - share(j)*inverse(:, j)
               end do
               deallocate (small)
            end if
            full = huge(1.0_wp)
            if (sum(a*z) > nothing*sum(a*h)) full = over/sum(a*z)
            part = huge(1.0_wp)
            drop = 0
            do j = 1, size(share)
               if (share(j) <= 0.0_wp) cycle
               if (multiplier(j)/share(j) >= part) cycle
               part = multiplier(j)/share(j)
               drop = j
            end do
            step = min(full, part)
            found = step < huge(1.0_wp)
            if (.not. found) return
            if (full < huge(1.0_wp)) control = control - step*z
            multiplier = multiplier - step*share
            own = own + step
            over = over - step*merge(sum(a*z), 0.0_wp, full < huge(1.0_wp))
            deallocate (share)
            if (full <= part) exit
            multiplier = [multiplier(:drop - 1), multiplier(drop + 1:)]
            active = reshape([active(:, :drop - 1), active(:, drop + 1:)], [m, size(multiplier)])
            inverse = reshape([inverse(:, :drop - 1), inverse(:, drop + 1:)], [m, size(multiplier)])
         end do
         multiplier = [multiplier, own]
         active = reshape([active, a], [m, size(multiplier)])
         inverse = reshape([inverse, h], [m, size(multiplier)])
      end do
      found = .false.

   contains

      !> The bound that is exceeded most: a . control <= b is by `over` wrong.
      subroutine worst(a, b, over)
         real(wp), intent(out) :: a(:), b, over
         real(wp) :: row(0:degree), value, excess
         integer :: order, i, j, k

         a = 0.0_wp
         b = 1.0_wp
         over = 0.0_wp
         excess = 0.0_wp
         do order = 1, 2
            if (.not. bounds(order) > 0.0_wp) cycle
            do k = 0, places - 1
               do j = 0, degree
                  row(j) = derivative(basis(:, j), order, real(k, wp)/real(places, wp))/width**order
               end do
               do i = 1, m
                  value = 0.0_wp
                  do j = 0, degree
                     value = value + row(j)*control(1 + modulo(i - 1 + j, m))
                  end do
                  if (abs(value)/bounds(order) - 1.0_wp <= excess) cycle
                  excess = abs(value)/bounds(order) - 1.0_wp
                  over = abs(value) - bounds(order)
                  b = bounds(order)
                  a = 0.0_wp
                  do j = 0, degree
                     a(1 + modulo(i - 1 + j, m)) = a(1 + modulo(i - 1 + j, m)) + sign(1.0_wp, value)*row(j)
                  end do
               end do
            end do
         end do
      end subroutine worst
   end subroutine obey
end module psalm_spline_fit
