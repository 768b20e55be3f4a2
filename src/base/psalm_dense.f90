!> Small dense systems by Householder's reflections: square ones, and those with more equations than unknowns in the sense of
!> least squares.
!>
!> Written out, so that the digits do not depend on the machine's library. Source: Golub and Van Loan (1983), chapter 6.
module psalm_dense
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: factors_t, factorise, solve, solve_transposed

   !> A matrix as Q R, and what that tells of it.
   type :: factors_t
      real(wp), allocatable :: q(:, :)     !! shape (m, n): reflections below, R above the diagonal
      real(wp), allocatable :: tau(:), diagonal(:) !! shape (n)
      real(wp) :: reciprocal_condition = 0.0_wp !! an estimate from R, 0 for a singular matrix
      real(wp) :: sense = 1.0_wp           !! square matrices: sign of the determinant
   end type factors_t

contains

   !> Factorise a matrix of m rows and n <= m columns.
   pure subroutine factorise(matrix, factors)
      real(wp), intent(in) :: matrix(:, :)         !! shape (m, n)
      type(factors_t), intent(out) :: factors
      real(wp) :: norm, s
      integer :: m, n, j, k

      m = size(matrix, 1)
      n = size(matrix, 2)
      factors%q = matrix
      allocate (factors%tau(n), factors%diagonal(n), source=0.0_wp)
      associate (a => factors%q)
         do j = 1, n
            norm = sqrt(sum(a(j:, j)**2))
            factors%diagonal(j) = norm
            if (norm == 0.0_wp) then
               factors%sense = 0.0_wp
               cycle
            end if
            if (j == m) then
               ! the last row of a square matrix needs no reflection
               factors%diagonal(j) = a(j, j)
            else
               norm = sign(norm, a(j, j))
               factors%diagonal(j) = -norm
               a(j, j) = a(j, j) + norm
               factors%tau(j) = 1.0_wp/(norm*a(j, j))
               do k = j + 1, n
                  s = sum(a(j:, j)*a(j:, k))*factors%tau(j)
                  a(j:, k) = a(j:, k) - s*a(j:, j)
               end do
               factors%sense = -factors%sense
            end if
            factors%sense = sign(1.0_wp, factors%diagonal(j))*factors%sense
         end do
      end associate
      factors%reciprocal_condition = reciprocal_condition_of(factors)
   end subroutine factorise

   !> 1 over the product of the norms of R and of its inverse (largest column sums); 0 if R is singular.
   pure real(wp) function reciprocal_condition_of(factors) result(reciprocal)
      type(factors_t), intent(in) :: factors
      real(wp), allocatable :: column(:)
      real(wp) :: largest, largest_of_inverse
      integer :: n, j, i

      n = size(factors%diagonal)
      reciprocal = 0.0_wp
      if (any(factors%diagonal == 0.0_wp)) return
      allocate (column(n))
      largest = 0.0_wp
      largest_of_inverse = 0.0_wp
      do j = 1, n
         largest = max(largest, abs(factors%diagonal(j)) + sum(abs(factors%q(:j - 1, j))))
         column = 0.0_wp
         column(j) = 1.0_wp
         do i = j, 1, -1
            column(i) = column(i)/factors%diagonal(i)
            column(:i - 1) = column(:i - 1) - column(i)*factors%q(:i - 1, i)
         end do
         largest_of_inverse = max(largest_of_inverse, sum(abs(column)))
      end do
      reciprocal = 1.0_wp/(largest*largest_of_inverse)
   end function reciprocal_condition_of

   !> x that makes A x - right smallest. R must not be singular.
   pure function solve(factors, right) result(x)
      type(factors_t), intent(in) :: factors
      real(wp), intent(in) :: right(:)             !! shape (m)
      real(wp) :: x(size(factors%diagonal))
      real(wp) :: y(size(right))
      integer :: n, i

      n = size(x)
      y = right
      do i = 1, n
         if (factors%tau(i) == 0.0_wp) cycle
         y(i:) = y(i:) - (sum(factors%q(i:, i)*y(i:))*factors%tau(i))*factors%q(i:, i)
      end do
      x = y(:n)
      do i = n, 1, -1
         x(i) = x(i)/factors%diagonal(i)
         x(:i - 1) = x(:i - 1) - x(i)*factors%q(:i - 1, i)
      end do
   end function solve

   !> The shortest y with A^T y = right. R must not be singular.
   pure function solve_transposed(factors, right) result(y)
      type(factors_t), intent(in) :: factors
      real(wp), intent(in) :: right(:)             !! shape (n)
      real(wp) :: y(size(factors%q, 1))
      integer :: n, i

      n = size(right)
      y = 0.0_wp
      do i = 1, n
         y(i) = (right(i) - sum(factors%q(:i - 1, i)*y(:i - 1)))/factors%diagonal(i)
      end do
      do i = n, 1, -1
         if (factors%tau(i) == 0.0_wp) cycle
         y(i:) = y(i:) - (sum(factors%q(i:, i)*y(i:))*factors%tau(i))*factors%q(i:, i)
      end do
   end function solve_transposed
end module psalm_dense
