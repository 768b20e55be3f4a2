!> Multipliers of several coupled modes q'' + C q' + K(x) q = 0 with K of period 2 pi: they show combination resonances, which
!> the boundaries of single modes do not.
!>
!> Magnus's series of fourth order with two Gauss points a step and the matrix exponential by scaling and squaring; the
!> number of steps is doubled until the period's matrix does not change any more.
module psalm_floquet
   use psalm_kinds, only: wp, pi
   use psalm_linear, only: product_of
   use psalm_lapack, only: general_eigenvalues
   use psalm_periodic, only: periodic_t
   implicit none (type, external)
   private
   public :: coupled_multipliers

   integer, parameter :: fewest_steps = 128, most_steps = 2**15
   real(wp), parameter :: gauss = 0.288675134594812882254574390250978728_wp !! sqrt(3)/6

contains

   !> Multipliers, the largest modulus first. Errors: `ok` false if the tolerance is not reached or the eigenvalues fail.
   subroutine coupled_multipliers(stiffness, damping, tolerance, multipliers, error, ok)
      type(periodic_t), intent(in) :: stiffness(:, :) !! K, shape (n, n)
      real(wp), intent(in) :: damping(:)              !! diagonal of C, shape (n)
      real(wp), intent(in) :: tolerance               !! of the period's matrix, relative to its largest element
      complex(wp), intent(out) :: multipliers(:)      !! shape (2 n)
      real(wp), intent(out) :: error                  !! estimate, as the tolerance
      logical, intent(out) :: ok
      real(wp) :: before(size(multipliers), size(multipliers)), now(size(multipliers), size(multipliers))
      logical :: reached
      integer :: steps

      steps = fewest_steps
      before = period(stiffness, damping, steps)
      do
         steps = 2*steps
         now = period(stiffness, damping, steps)
         if (.not. all(abs(now) <= huge(1.0_wp))) then
            ! what grows beyond all numbers in a turn does so with shorter steps, too
            ok = .false.
            error = 1.0_wp
            multipliers = 0.0_wp
            return
         end if
         ! of fourth order: with the extrapolation the error left is far below the change
         error = maxval(abs(now - before))/(15.0_wp*maxval(abs(now)))
         reached = error <= tolerance
         if (reached .or. steps >= most_steps) exit
         before = now
      end do
      now = now + (now - before)/15.0_wp
      call general_eigenvalues(now, multipliers, ok)
      ok = ok .and. reached
   end subroutine coupled_multipliers

   function period(stiffness, damping, steps) result(matrix)
      type(periodic_t), intent(in) :: stiffness(:, :)
      real(wp), intent(in) :: damping(:)
      integer, intent(in) :: steps
      real(wp) :: matrix(2*size(damping), 2*size(damping))
      real(wp) :: k(steps, 2, size(damping), size(damping)), h
      real(wp), dimension(2*size(damping), 2*size(damping)) :: a1, a2, exponent
      integer :: i, j, n, step, side

      n = size(damping)
      h = 2.0_wp*pi/real(steps, wp)
      do j = 1, n
         do i = 1, n
            do side = 1, 2
               k(:, side, i, j) = stiffness(i, j)%values(steps, 0.5_wp + real(2*side - 3, wp)*gauss)
            end do
         end do
      end do
      matrix = 0.0_wp
      a1 = 0.0_wp
      do i = 1, 2*n
         matrix(i, i) = 1.0_wp
      end do
      do i = 1, n
         a1(i, n + i) = 1.0_wp
         a1(n + i, n + i) = -damping(i)
      end do
      a2 = a1
      do step = 1, steps
         a1(n + 1:, :n) = -k(step, 1, :, :)
         a2(n + 1:, :n) = -k(step, 2, :, :)
         exponent = 0.5_wp*h*(a1 + a2) + sqrt(3.0_wp)/12.0_wp*h*h*(product_of(a2, a1) - product_of(a1, a2))
         matrix = product_of(exponential(exponent), matrix)
      end do
   end function period

   !> By Taylor's series of 12 terms after scaling to a norm below a half, then squaring.
   pure function exponential(a) result(e)
      real(wp), intent(in) :: a(:, :)
      real(wp) :: e(size(a, 1), size(a, 1)), x(size(a, 1), size(a, 1)), term(size(a, 1), size(a, 1))
      integer :: i, squarings
      integer, parameter :: terms = 14 ! 0.5**15/15! is below epsilon

      squarings = max(0, 2 + exponent(maxval(sum(abs(a), dim=1))))
      x = a/2.0_wp**squarings
      e = x
      term = x
      do i = 2, terms
         term = product_of(term, x)/real(i, wp)
         e = e + term
      end do
      do i = 1, squarings
         e = 2.0_wp*e + product_of(e, e) ! of e - 1, which keeps the digits of small exponents
      end do
      do i = 1, size(a, 1)
         e(i, i) = e(i, i) + 1.0_wp
      end do
   end function exponential
end module psalm_floquet
