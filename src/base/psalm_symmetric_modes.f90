!> Natural modes: K x = w2 H x for symmetric matrices, H positive definite, by Jacobi's rotations.
module psalm_symmetric_modes
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: modes_of

   integer, parameter :: most_sweeps = 60

contains

   !> Eigenvalues, ascending, and their vectors, whose largest component is 1. Source: Golub and Van Loan, Matrix Computations,
   !> 8.5 and 8.7.
   pure subroutine modes_of(k, h, squares, shapes)
      real(wp), intent(in) :: k(:, :), h(:, :)               !! shape (n, n)
      real(wp), allocatable, intent(out) :: squares(:)       !! shape (n)
      real(wp), allocatable, intent(out) :: shapes(:, :)     !! shape (n, n): vector, mode
      real(wp), dimension(size(k, 1), size(k, 1)) :: l, a, v
      integer :: i, j, n, best

      n = size(k, 1)
      l = 0.0_wp
      do j = 1, n
         l(j, j) = sqrt(h(j, j) - sum(l(j, :j - 1)**2))
         do i = j + 1, n
            l(i, j) = (h(i, j) - sum(l(i, :j - 1)*l(j, :j - 1)))/l(j, j)
         end do
      end do
      ! L**-1 K L**-T
      a = k
      do j = 1, n
         call forwards(l, a(:, j))
      end do
      a = transpose(a)
      do j = 1, n
         call forwards(l, a(:, j))
      end do
      call diagonalise(a, v)
      allocate (squares(n), shapes(n, n))
      do i = 1, n
         best = minloc([(a(j, j), j=1, n)], dim=1)
         squares(i) = a(best, best)
         a(best, best) = huge(1.0_wp)
         shapes(:, i) = v(:, best)
         do j = n, 1, -1
            shapes(j, i) = (shapes(j, i) - sum(l(j + 1:, j)*shapes(j + 1:, i)))/l(j, j)
         end do
         shapes(:, i) = shapes(:, i)/shapes(maxloc(abs(shapes(:, i)), dim=1), i)
      end do
   end subroutine modes_of

   !> L**-1 x in place.
   pure subroutine forwards(l, x)
      real(wp), intent(in) :: l(:, :)
      real(wp), intent(inout) :: x(:)
      integer :: i

      do i = 1, size(x)
         x(i) = (x(i) - sum(l(i, :i - 1)*x(:i - 1)))/l(i, i)
      end do
   end subroutine forwards

   !> Rotate a symmetric matrix to its diagonal; the columns of v are its vectors.
   pure subroutine diagonalise(a, v)
      real(wp), intent(inout) :: a(:, :)
      real(wp), intent(out) :: v(:, :)
      real(wp) :: t, c, s, tau, column(size(a, 1))
      integer :: p, q, round

      v = 0.0_wp
      do p = 1, size(a, 1)
         v(p, p) = 1.0_wp
      end do
      do round = 1, most_sweeps
         if (sum(a**2) - sum([(a(p, p)**2, p=1, size(a, 1))]) <= epsilon(1.0_wp)**2*sum(a**2)) exit
         do p = 1, size(a, 1) - 1
            do q = p + 1, size(a, 1)
               if (abs(a(p, q)) <= 0.0_wp) cycle
               tau = (a(q, q) - a(p, p))/(2.0_wp*a(p, q))
               t = sign(1.0_wp, tau)/(abs(tau) + sqrt(1.0_wp + tau**2))
               c = 1.0_wp/sqrt(1.0_wp + t**2)
               s = t*c
               column = a(:, p)
               a(:, p) = c*column - s*a(:, q)
               a(:, q) = s*column + c*a(:, q)
               column = a(p, :)
               a(p, :) = c*column - s*a(q, :)
               a(q, :) = s*column + c*a(q, :)
               column = v(:, p)
               v(:, p) = c*column - s*v(:, q)
               v(:, q) = s*column + c*v(:, q)
            end do
         end do
      end do
   end subroutine diagonalise
end module psalm_symmetric_modes
