!> Linear algebra for the tens of unknowns a linkage has; by reflections: psalm_dense.
!>
!> Written out, because the library's routines (matmul too) choose their kernels by the processor, and with them the last digit.
module psalm_linear
   use psalm_kinds, only: wp, dp
   implicit none (type, external)
   private
   public :: solve_positive, solve_three, eliminate, eliminate_real, reduce_real, along_columns, product_of, triangle_of

   !> Product of two matrices, or of a matrix and a vector.
   interface product_of
      module procedure real_product, complex_product, complex_image
   end interface product_of

contains

   !> Solve a symmetric positive definite system by Cholesky's factors, in real64; the upper triangle is used.
   !>
   !> Errors: `positive_definite` is false if the matrix is not positive definite, with `least` if less than that part of an element
   !> of the diagonal is left as its pivot.
   pure subroutine solve_positive(matrix, right, solution, positive_definite, least)
      real(wp), intent(in) :: matrix(:, :)   !! shape (n, n)
      real(wp), intent(in) :: right(:)       !! shape (n)
      real(wp), intent(out) :: solution(:)   !! shape (n)
      logical, intent(out) :: positive_definite
      real(wp), intent(in), optional :: least
      real(dp) :: a(size(right), size(right)), b(size(right)) ! rows of the factor are columns of `a`
      real(dp) :: pivot
      integer :: i, j, n

      n = size(right)
      positive_definite = .false.
      solution = 0.0_wp
      do j = 1, n
         a(j:, j) = real(matrix(j, j:), dp)
      end do
      b = real(right, dp)
      do j = 1, n
         if (.not. a(j, j) > 0.0_dp) return
         if (present(least)) then
            if (.not. a(j, j) > real(least*matrix(j, j), dp)) return
         end if
         pivot = sqrt(a(j, j))
         a(j:, j) = a(j:, j)/pivot
         a(j, j) = pivot
         do i = j + 1, n
            call subtract(n - i + 1, a(i, j), a(i:, j), a(i:, i))
         end do
         b(j) = b(j)/pivot
         call subtract(n - j, b(j), a(j + 1:, j), b(j + 1:))
      end do
      do j = n, 1, -1
         do i = j + 1, n
            b(j) = b(j) - a(i, j)*b(i)
         end do
         b(j) = b(j)/a(j, j)
      end do
      positive_definite = .true.
      solution = real(b, wp)
   end subroutine solve_positive

   !> Take a multiple of one vector from another; as a procedure of its own no copy is made of what cannot overlap.
   pure subroutine subtract(n, factor, x, y)
      integer, intent(in) :: n
      real(dp), intent(in) :: factor, x(n)
      real(dp), intent(inout) :: y(n)

      y = y - factor*x
   end subroutine subtract

   !> Three equations by Cramer's rule. Errors: `regular` is false if they depend on each other.
   pure subroutine solve_three(matrix, right, x, regular)
      real(wp), intent(in) :: matrix(3, 3), right(3)
      real(wp), intent(out) :: x(3)
      logical, intent(out) :: regular
      real(wp) :: determinant, own(3, 3)
      integer :: k

      x = 0.0_wp
      determinant = determinant_of(matrix)
      regular = abs(determinant) > 0.0_wp
      if (.not. regular) return
      do k = 1, 3
         own = matrix
         own(:, k) = right
         x(k) = determinant_of(own)/determinant
      end do
   end subroutine solve_three

   pure real(wp) function determinant_of(m)
      real(wp), intent(in) :: m(3, 3)

      determinant_of = m(1, 1)*(m(2, 2)*m(3, 3) - m(2, 3)*m(3, 2)) - m(1, 2)*(m(2, 1)*m(3, 3) - m(2, 3)*m(3, 1)) + &
                       m(1, 3)*(m(2, 1)*m(3, 2) - m(2, 2)*m(3, 1))
   end function determinant_of

   !> Solve a square system for several right sides by Gauss's elimination with row pivots; the solutions take their place.
   !>
   !> Errors: `regular` is false for a singular matrix.
   pure subroutine eliminate(matrix, right, regular)
      complex(wp), intent(inout), contiguous :: matrix(:, :) !! shape (m, m); destroyed
      complex(wp), intent(inout), contiguous :: right(:, :)  !! shape (m, any)
      logical, intent(out) :: regular
      complex(wp) :: swap, factor, inverse
      real(wp) :: largest, here
      integer :: i, k, c, p, m

      m = size(matrix, 1)
      regular = .false.
      do k = 1, m
         p = k
         largest = abs(matrix(k, k)%re) + abs(matrix(k, k)%im)
         do i = k + 1, m
            here = abs(matrix(i, k)%re) + abs(matrix(i, k)%im)
            if (here <= largest) cycle
            largest = here
            p = i
         end do
         if (.not. (largest > tiny(1.0_wp) .and. largest < huge(1.0_wp))) return
         if (p /= k) then
            do c = k, m
               swap = matrix(k, c)
               matrix(k, c) = matrix(p, c)
               matrix(p, c) = swap
            end do
            do c = 1, size(right, 2)
               swap = right(k, c)
               right(k, c) = right(p, c)
               right(p, c) = swap
            end do
         end if
         inverse = 1.0_wp/matrix(k, k)
         matrix(k + 1:, k) = matrix(k + 1:, k)*inverse
         do c = k + 1, m
            factor = matrix(k, c)
            do i = k + 1, m
               matrix(i, c) = matrix(i, c) - matrix(i, k)*factor
            end do
         end do
         do c = 1, size(right, 2)
            factor = right(k, c)
            do i = k + 1, m
               right(i, c) = right(i, c) - matrix(i, k)*factor
            end do
         end do
         matrix(k, k) = inverse
      end do
      do c = 1, size(right, 2)
         do k = m, 1, -1
            right(k, c) = right(k, c)*matrix(k, k)
            do i = 1, k - 1
               right(i, c) = right(i, c) - matrix(i, k)*right(k, c)
            end do
         end do
      end do
      regular = .true.
   end subroutine eliminate

   !> The same in real numbers, for a few equations, and the determinant: 0 for a singular matrix, whose solutions mean nothing.
   pure subroutine eliminate_real(n, columns, matrix, right, determinant)
      integer, intent(in) :: n, columns
      real(wp), intent(inout) :: matrix(n, n)        !! destroyed
      real(wp), intent(inout) :: right(n, columns)
      real(wp), intent(out) :: determinant

      if (n == 4 .and. columns == 1) then
         call eliminate_four(matrix, right, determinant)
      else
         call eliminate_any(n, columns, matrix, right, determinant)
      end if
   end subroutine eliminate_real

   !> Four equations, as a group of four links has: columns are as long as a vector register. The same operations in the same order;
   !> rows that are done lose nothing.
   pure subroutine eliminate_four(matrix, right, determinant)
      real(wp), intent(inout) :: matrix(4, 4), right(4)
      real(wp), intent(out) :: determinant
      real(wp), parameter :: below(4, 4) = reshape([0, 1, 1, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0], [4, 4]) !! rows not done
      real(wp) :: a(4, 5), lost(4), swap, inverse(4)
      integer :: i, k, c, p

      a(:, :4) = matrix
      a(:, 5) = right
      determinant = 1.0_wp
      do k = 1, 4
         p = k
         do i = k + 1, 4
            if (abs(a(i, k)) > abs(a(p, k))) p = i
         end do
         determinant = determinant*a(p, k)
         if (.not. abs(a(p, k)) > tiny(1.0_wp)) then
            determinant = 0.0_wp
            return
         end if
         if (p /= k) then
            determinant = -determinant
            do c = k, 5
               swap = a(k, c)
               a(k, c) = a(p, c)
               a(p, c) = swap
            end do
         end if
         inverse(k) = 1.0_wp/a(k, k)
         lost = (a(:, k)*inverse(k))*below(:, k)
         do c = k + 1, 5
            a(:, c) = a(:, c) - lost*a(k, c)
         end do
      end do
      do k = 4, 1, -1
         a(k, 5) = a(k, 5)*inverse(k)
         do i = 1, k - 1
            a(i, 5) = a(i, 5) - a(i, k)*a(k, 5)
         end do
      end do
      right = a(:, 5)
   end subroutine eliminate_four

   pure subroutine eliminate_any(n, columns, matrix, right, determinant)
      integer, intent(in) :: n, columns
      real(wp), intent(inout) :: matrix(n, n), right(n, columns)
      real(wp), intent(out) :: determinant
      real(wp) :: swap, factor, inverse
      integer :: i, k, c, p

      determinant = 1.0_wp
      do k = 1, n
         p = k
         do i = k + 1, n
            if (abs(matrix(i, k)) > abs(matrix(p, k))) p = i
         end do
         determinant = determinant*matrix(p, k)
         if (.not. abs(matrix(p, k)) > tiny(1.0_wp)) then
            determinant = 0.0_wp
            return
         end if
         if (p /= k) then
            determinant = -determinant
            do c = k, n
               swap = matrix(k, c)
               matrix(k, c) = matrix(p, c)
               matrix(p, c) = swap
            end do
            do c = 1, columns
               swap = right(k, c)
               right(k, c) = right(p, c)
               right(p, c) = swap
            end do
         end if
         inverse = 1.0_wp/matrix(k, k)
         do i = k + 1, n
            matrix(i, k) = matrix(i, k)*inverse
         end do
         do c = k + 1, n
            factor = matrix(k, c)
            do i = k + 1, n
               matrix(i, c) = matrix(i, c) - matrix(i, k)*factor
            end do
         end do
         do c = 1, columns
            factor = right(k, c)
            do i = k + 1, n
               right(i, c) = right(i, c) - matrix(i, k)*factor
            end do
         end do
         matrix(k, k) = inverse
      end do
      do c = 1, columns
         do k = n, 1, -1
            right(k, c) = right(k, c)*matrix(k, k)
            do i = 1, k - 1
               right(i, c) = right(i, c) - matrix(i, k)*right(k, c)
            end do
         end do
      end do
   end subroutine eliminate_any

   !> The same for m equations with n <= m unknowns: where there are more, what makes the sum of the squares of what is left least,
   !> by Householder's reflections, and for the determinant the root of that of matrix'matrix. The first n rows of `right` get the
   !> solutions.
   pure subroutine reduce_real(m, n, columns, matrix, right, determinant)
      integer, intent(in) :: m, n, columns
      real(wp), intent(inout) :: matrix(m, n)        !! destroyed
      real(wp), intent(inout) :: right(m, columns)
      real(wp), intent(out) :: determinant
      real(wp) :: length, factor
      integer :: i, k, c

      if (m == n) then
         call eliminate_real(n, columns, matrix, right, determinant)
         return
      end if
      determinant = 1.0_wp
      do k = 1, n
         length = sqrt(sum(matrix(k:, k)**2))
         determinant = determinant*length
         if (.not. length > tiny(1.0_wp)) then
            determinant = 0.0_wp
            return
         end if
         length = sign(length, matrix(k, k))
         matrix(k, k) = matrix(k, k) + length
         ! the reflection is 1 - v v' / (length v(k))
         do c = k + 1, n
            factor = sum(matrix(k:, k)*matrix(k:, c))/(length*matrix(k, k))
            matrix(k:, c) = matrix(k:, c) - factor*matrix(k:, k)
         end do
         do c = 1, columns
            factor = sum(matrix(k:, k)*right(k:, c))/(length*matrix(k, k))
            right(k:, c) = right(k:, c) - factor*matrix(k:, k)
         end do
         matrix(k, k) = -length
      end do
      do c = 1, columns
         do k = n, 1, -1
            right(k, c) = right(k, c)/matrix(k, k)
            do i = 1, k - 1
               right(i, c) = right(i, c) - matrix(i, k)*right(k, c)
            end do
         end do
      end do
   end subroutine reduce_real

   !> Scalar products of a vector with the columns of a matrix; of a symmetric matrix its product with the vector.
   pure function along_columns(matrix, vector) result(products)
      real(wp), intent(in) :: matrix(:, :)   !! shape (n, m)
      real(wp), intent(in) :: vector(:)      !! shape (n)
      real(wp) :: products(size(matrix, 2))
      integer :: i

      do i = 1, size(products)
         products(i) = dot_product(vector, matrix(:, i))
      end do
   end function along_columns

   pure function real_product(a, b) result(c)
      real(wp), intent(in) :: a(:, :)      !! shape (n, m)
      real(wp), intent(in) :: b(:, :)      !! shape (m, l)
      real(wp) :: c(size(a, 1), size(b, 2))
      integer :: j, k

      c = 0.0_wp
      do j = 1, size(b, 2)
         do k = 1, size(b, 1)
            c(:, j) = c(:, j) + a(:, k)*b(k, j)
         end do
      end do
   end function real_product

   pure function complex_product(a, b) result(c)
      complex(wp), intent(in) :: a(:, :)   !! shape (n, m)
      complex(wp), intent(in) :: b(:, :)   !! shape (m, l)
      complex(wp) :: c(size(a, 1), size(b, 2))
      integer :: j

      do j = 1, size(b, 2)
         c(:, j) = complex_image(a, b(:, j))
      end do
   end function complex_product

   pure function complex_image(a, b) result(c)
      complex(wp), intent(in) :: a(:, :)   !! shape (n, m)
      complex(wp), intent(in) :: b(:)      !! shape (m)
      complex(wp) :: c(size(a, 1))
      integer :: k

      c = (0.0_wp, 0.0_wp)
      do k = 1, size(b)
         c = c + a(:, k)*b(k)
      end do
   end function complex_image

   !> The upper triangle R of a matrix by Householder's reflections: R'R is matrix'matrix. Shape of the result: (m, m).
   pure function triangle_of(matrix) result(r)
      real(wp), intent(in) :: matrix(:, :)   !! shape (n, m)
      real(wp) :: r(size(matrix, 2), size(matrix, 2))
      real(wp) :: a(max(size(matrix, 1), size(matrix, 2)), size(matrix, 2)), length, factor
      integer :: j, k, n, m

      n = size(a, 1)
      m = size(a, 2)
      a = 0.0_wp
      a(:size(matrix, 1), :) = matrix
      r = 0.0_wp
      do j = 1, m
         length = sqrt(sum(a(j:, j)**2))
         if (length <= 0.0_wp) then
            r(j, j:) = a(j, j:)
            cycle
         end if
         length = sign(length, -a(j, j))
         r(j, j) = length
         a(j, j) = a(j, j) - length
         factor = sum(a(j:, j)**2)
         do k = j + 1, m
            a(j:, k) = a(j:, k) - (2.0_wp*dot_product(a(j:, j), a(j:, k))/factor)*a(j:, j)
            r(j, k) = a(j, k)
         end do
      end do
   end function triangle_of
end module psalm_linear
