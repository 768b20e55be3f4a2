!> The one LAPACK routine the searches use, in the working precision of the rest (LAPACK itself computes in real64).
module psalm_lapack
   use psalm_kinds, only: wp, dp
   implicit none (type, external)
   private
   public :: solve_positive

   interface
      subroutine dposv(uplo, n, nrhs, a, lda, b, ldb, info)
         import :: dp
         implicit none (type, external)
         character(1), intent(in) :: uplo
         integer, intent(in) :: n, nrhs, lda, ldb
         real(dp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: info
      end subroutine dposv
   end interface

contains

   !> Solve a symmetric positive definite system by Cholesky's factors; the upper triangle is used.
   !>
   !> Errors: `sound` is false if the matrix is not positive definite.
   subroutine solve_positive(matrix, right, solution, sound)
      real(wp), intent(in) :: matrix(:, :)   !! shape (n, n)
      real(wp), intent(in) :: right(:)       !! shape (n)
      real(wp), intent(out) :: solution(:)   !! shape (n)
      logical, intent(out) :: sound
      real(dp) :: a(size(right), size(right)), b(size(right), 1)
      integer :: info

      a = real(matrix, dp)
      b(:, 1) = real(right, dp)
      call dposv('U', size(right), 1, a, size(right), b, size(right), info)
      sound = info == 0
      solution = real(b(:, 1), wp)
   end subroutine solve_positive
end module psalm_lapack
