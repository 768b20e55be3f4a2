!> Border to LAPACK, in real64: eigenvalues, and linear systems.
module psalm_lapack
   use psalm_kinds, only: wp, dp
   use psalm_sort, only: ascending
   implicit none (type, external)
   private
   public :: hermitian_eigenvalues, general_eigenvalues, natural_modes, solve_general

   interface
      subroutine zheev(jobz, uplo, n, a, lda, w, work, lwork, rwork, info)
         import :: dp
         implicit none (type, external)
         character, intent(in) :: jobz, uplo
         integer, intent(in) :: n, lda, lwork
         complex(dp), intent(inout) :: a(lda, *)
         real(dp), intent(out) :: w(*)
         complex(dp), intent(inout) :: work(*)
         real(dp), intent(inout) :: rwork(*)
         integer, intent(out) :: info
      end subroutine zheev

      subroutine dgeev(jobvl, jobvr, n, a, lda, wr, wi, vl, ldvl, vr, ldvr, work, lwork, info)
         import :: dp
         implicit none (type, external)
         character, intent(in) :: jobvl, jobvr
         integer, intent(in) :: n, lda, ldvl, ldvr, lwork
         real(dp), intent(inout) :: a(lda, *)
         real(dp), intent(out) :: wr(*), wi(*)
         real(dp), intent(inout) :: vl(ldvl, *), vr(ldvr, *), work(*)
         integer, intent(out) :: info
      end subroutine dgeev

      subroutine dsygv(itype, jobz, uplo, n, a, lda, b, ldb, w, work, lwork, info)
         import :: dp
         implicit none (type, external)
         integer, intent(in) :: itype, n, lda, ldb, lwork
         character, intent(in) :: jobz, uplo
         real(dp), intent(inout) :: a(lda, *), b(ldb, *), work(*)
         real(dp), intent(out) :: w(*)
         integer, intent(out) :: info
      end subroutine dsygv

      pure subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: dp
         implicit none (type, external)
         integer, intent(in) :: n, nrhs, lda, ldb
         real(dp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgesv
   end interface

   integer, parameter :: block = 32 !! columns that the library handles at a time: room for its work array

contains

   !> Eigenvalues of a Hermitian matrix, ascending; the upper triangle is used. Errors: `ok` false if the library does not
   !> converge.
   subroutine hermitian_eigenvalues(matrix, values, ok)
      complex(wp), intent(in) :: matrix(:, :) !! shape (n, n)
      real(wp), intent(out) :: values(:)      !! shape (n)
      logical, intent(out) :: ok
      complex(dp) :: a(size(values), size(values)), work((block + 1)*size(values))
      real(dp) :: w(size(values)), rwork(3*size(values))
      integer :: info, n

      n = size(values)
      a = cmplx(matrix, kind=dp)
      call zheev('N', 'U', n, a, n, w, work, size(work), rwork, info)
      values = real(w, wp)
      ok = info == 0
   end subroutine hermitian_eigenvalues

   !> Eigenvalues of a real matrix, the largest modulus first. Errors: `ok` false if the library does not converge, or if an element
   !> is no finite number: the library would end the program.
   subroutine general_eigenvalues(matrix, values, ok)
      real(wp), intent(in) :: matrix(:, :)    !! shape (n, n)
      complex(wp), intent(out) :: values(:)   !! shape (n)
      logical, intent(out) :: ok
      real(dp) :: a(size(values), size(values)), work((block + 1)*size(values)), none(1, 1)
      real(dp) :: wr(size(values)), wi(size(values))
      integer :: info, n

      n = size(values)
      values = (0.0_wp, 0.0_wp)
      ok = .false.
      a = real(matrix, dp)
      if (.not. all(abs(a) <= huge(1.0_dp))) return
      call dgeev('N', 'N', n, a, n, wr, wi, none, 1, none, 1, work, size(work), info)
      ok = info == 0
      values = cmplx(wr, wi, wp)
      values = values(ascending(-abs(values)))
   end subroutine general_eigenvalues

   !> Natural modes: K x = w2 H x for symmetric matrices, H positive definite; w2 ascending. Errors: `ok` false if H is not positive
   !> definite, or an element of K no finite number.
   subroutine natural_modes(k, h, squares, shapes, ok)
      real(wp), intent(in) :: k(:, :), h(:, :)  !! shape (n, n)
      real(wp), intent(out) :: squares(:)       !! shape (n): w2
      real(wp), intent(out) :: shapes(:, :)     !! shape (n, n): vector, mode; the largest component of a vector is 1
      logical, intent(out) :: ok
      real(dp) :: a(size(squares), size(squares)), b(size(squares), size(squares)), w(size(squares)), &
                  work((block + 2)*size(squares))
      integer :: info, n, i
      integer, parameter :: of_first_kind = 1   ! K x = w2 H x

      n = size(squares)
      squares = 0.0_wp
      shapes = 0.0_wp
      ok = .false.
      a = real(k, dp)
      b = real(h, dp)
      if (.not. all(abs(a) <= huge(1.0_dp))) return
      call dsygv(of_first_kind, 'V', 'U', n, a, n, b, n, w, work, size(work), info)
      ok = info == 0
      if (.not. ok) return
      squares = real(w, wp)
      do i = 1, n
         shapes(:, i) = real(a(:, i)/a(maxloc(abs(a(:, i)), dim=1), i), wp)
      end do
   end subroutine natural_modes

   !> Solve matrix*x = right. Errors: `ok` false if the matrix is singular.
   pure subroutine solve_general(matrix, right, x, ok)
      real(wp), intent(in) :: matrix(:, :) !! shape (n, n)
      real(wp), intent(in) :: right(:)     !! shape (n)
      real(wp), intent(out) :: x(:)        !! shape (n)
      logical, intent(out) :: ok
      real(dp) :: a(size(x), size(x)), b(size(x), 1)
      integer :: pivots(size(x)), info, n

      n = size(x)
      a = real(matrix, dp)
      b(:, 1) = real(right, dp)
      call dgesv(n, 1, a, n, pivots, b, n, info)
      x = real(b(:, 1), wp)
      ok = info == 0
   end subroutine solve_general
end module psalm_lapack
