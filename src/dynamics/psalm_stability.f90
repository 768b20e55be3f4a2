!> Boundaries between the stable and the unstable in Q'' + (W + f(x)) Q = 0, f of period 2 pi: the values of W that are eigenvalues
!> of -d2/dx2 - f with period 2 pi (p even) or 4 pi (p odd), where p counts the half waves of the free motion in a turn.
!>
!> W is the squared ratio of the link's frequency to the speed. Exact boundaries are those of one Hermitian matrix (Hill's
!> determinant); the series of Oldham (13.27), (13.28) are for comparison.
module psalm_stability
   use psalm_kinds, only: wp
   use psalm_lapack, only: hermitian_eigenvalues
   use psalm_periodic, only: periodic_t
   implicit none (type, external)
   private
   public :: boundaries_t, stability_boundaries, series_boundaries

   type :: boundaries_t
      real(wp), allocatable :: low(:), high(:) !! W, from index 0: unstable between low(p) and high(p); of p = 0 below both
      real(wp) :: error = 0.0_wp               !! what the last enlargement of the matrix moved, absolute
      logical :: converged = .false.
      integer :: waves = 0                     !! harmonics in the matrix
   end type boundaries_t

   integer, parameter :: fewest_waves = 24, most_waves = 384
   real(wp), parameter :: deepest = real(most_waves, wp)**4 !! change of f beyond which no matrix is large enough: the free motion
                                              !! in a hollow of this depth is a few times its fourth root wide, in waves
   real(wp), parameter :: target = 1.0e-11_wp !! of the change at the last enlargement, relative to the largest boundary

contains

   !> Boundaries 0..last. Errors: `converged` false if the largest matrix does not give them to 1e-11, or its eigenvalues fail.
   function stability_boundaries(f, last) result(b)
      type(periodic_t), intent(in) :: f
      integer, intent(in) :: last !! the largest p wanted, at least 0
      type(boundaries_t) :: b
      real(wp) :: before(0:2*last), now(0:2*last)
      integer :: waves, n
      logical :: ok, is_hopeless

      allocate (b%low(0:last), b%high(0:last))
      waves = max(fewest_waves, (last + 1)/2 + min(f%highest(target), most_waves/4))
      call eigenvalues(f, last, waves, before, ok)
      is_hopeless = sum([(f%amplitude(n), n=1, f%highest())]) > deepest
      now = before
      if (.not. ok) b%error = huge(1.0_wp)
      do while (ok)
         waves = waves + waves/2
         call eigenvalues(f, last, waves, now, ok)
         b%error = maxval(abs(now - before))
         b%converged = ok .and. b%error <= target*max(1.0_wp, maxval(abs(now)))
         if (b%converged .or. is_hopeless .or. waves > most_waves) exit
         before = now
      end do
      b%waves = waves
      b%low = now(0::2)
      b%high(0) = now(0)
      b%low(1:) = now(1::2)
      b%high(1:) = now(2::2)
   end function stability_boundaries

   !> The lowest eigenvalues in the order p = 0, 1, 1, 2, 2 ...: even p from the integers, odd p from the half integers.
   subroutine eigenvalues(f, last, waves, values, ok)
      type(periodic_t), intent(in) :: f
      integer, intent(in) :: last, waves
      real(wp), intent(out) :: values(0:) !! shape (0:2 last)
      logical, intent(out) :: ok
      complex(wp) :: matrix(2*waves + 1, 2*waves + 1)
      real(wp) :: spectrum(2*waves + 1)
      integer :: odd, n, i, j, p

      ok = .true.
      values = 0.0_wp
      do odd = 0, min(1, last)
         n = 2*waves + 1 - odd
         do j = 1, n
            do i = 1, j
               matrix(i, j) = -f%coefficient(i - j)
            end do
            matrix(j, j) = matrix(j, j) + (real(j - 1 - waves, wp) + 0.5_wp*real(odd, wp))**2
         end do
         call hermitian_eigenvalues(matrix(:n, :n), spectrum(:n), ok)
         if (.not. ok) return
         if (odd == 0) values(0) = spectrum(1)
         do p = 2 - odd, last, 2
            values(2*p - 1:2*p) = spectrum(p:p + 1) ! of the integers the first stands alone
         end do
      end do
   end subroutine eigenvalues

   !> Oldham's boundaries: order 1 his (13.27), order 2 (13.28); W(1) <= W(2). The error grows as the square or the cube of f.
   pure function series_boundaries(f, p, order) result(w)
      type(periodic_t), intent(in) :: f
      integer, intent(in) :: p     !! 0, 1, 2 ...
      integer, intent(in) :: order !! 1 or 2
      real(wp) :: w(2)
      complex(wp) :: b
      real(wp) :: s
      integer :: n, last

      last = f%highest()
      b = merge(f%coefficient(p), (0.0_wp, 0.0_wp), p > 0)
      s = 0.0_wp
      if (order > 1) then
         do n = 1, last
            if (n /= p) s = s + 2.0_wp*abs(f%coefficient(n))**2/real(p*p - n*n, wp)
         end do
         if (p > 0) then
            s = s - abs(f%coefficient(p))**2/(2.0_wp*real(p*p, wp))
            do n = 1, p - 1
               b = b - f%coefficient(n)*f%coefficient(p - n)/real(n*(p - n), wp)
            end do
            do n = 1, last
               b = b + 2.0_wp*f%coefficient(-n)*f%coefficient(p + n)/real(n*(p + n), wp)
            end do
         end if
      end if
      w = 0.25_wp*real(p*p, wp) - f%mean() + s + [-abs(b), abs(b)]
   end function series_boundaries
end module psalm_stability
