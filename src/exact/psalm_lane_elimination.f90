!> Systems of complex equations, several side by side, real and imaginary parts apart: vectors as long as the processor has them.
module psalm_lane_elimination
   use psalm_kinds, only: wp
   use psalm_leg_problem, only: variables
   implicit none (type, external)
   private
   public :: lanes, eliminate

   integer, parameter :: lanes = 8

contains

   !> Solve n equations with some right sides in every lane, partial pivoting. Element (column, row); the solutions replace the
   !> right sides.
   pure subroutine eliminate(n, sides, mr, mi)
      integer, intent(in) :: n, sides
      real(wp), intent(inout) :: mr(lanes, variables + 2, variables), mi(lanes, variables + 2, variables)
      real(wp), dimension(lanes) :: pr, pi, fr, fi, best, square
      real(wp) :: keep
      integer :: pivot(lanes), k, r, c, l

      do k = 1, n
         pivot = k
         !$omp simd
         do l = 1, lanes
            best(l) = mr(l, k, k)**2 + mi(l, k, k)**2
         end do
         do r = k + 1, n
            !$omp simd
            do l = 1, lanes
               square(l) = mr(l, k, r)**2 + mi(l, k, r)**2
               pivot(l) = merge(r, pivot(l), square(l) > best(l))
               best(l) = max(best(l), square(l))
            end do
         end do
         do l = 1, lanes
            if (pivot(l) == k) cycle
            do c = k, n + sides
               keep = mr(l, c, k)
               mr(l, c, k) = mr(l, c, pivot(l))
               mr(l, c, pivot(l)) = keep
               keep = mi(l, c, k)
               mi(l, c, k) = mi(l, c, pivot(l))
               mi(l, c, pivot(l)) = keep
            end do
         end do
         !$omp simd
         do l = 1, lanes
            best(l) = 1.0_wp/max(best(l), tiny(1.0_wp))
            pr(l) = mr(l, k, k)*best(l)
            pi(l) = -mi(l, k, k)*best(l)
         end do
         do c = k + 1, n + sides
            !$omp simd
            do l = 1, lanes
               fr(l) = mr(l, c, k)*pr(l) - mi(l, c, k)*pi(l)
               mi(l, c, k) = mr(l, c, k)*pi(l) + mi(l, c, k)*pr(l)
               mr(l, c, k) = fr(l)
            end do
         end do
         do r = k + 1, n
            fr = mr(:, k, r)
            fi = mi(:, k, r)
            do c = k + 1, n + sides
               !$omp simd
               do l = 1, lanes
                  mr(l, c, r) = mr(l, c, r) - (fr(l)*mr(l, c, k) - fi(l)*mi(l, c, k))
                  mi(l, c, r) = mi(l, c, r) - (fr(l)*mi(l, c, k) + fi(l)*mr(l, c, k))
               end do
            end do
         end do
      end do
      do k = n, 2, -1
         do c = n + 1, n + sides
            do r = 1, k - 1
               !$omp simd
               do l = 1, lanes
                  mr(l, c, r) = mr(l, c, r) - (mr(l, k, r)*mr(l, c, k) - mi(l, k, r)*mi(l, c, k))
                  mi(l, c, r) = mi(l, c, r) - (mr(l, k, r)*mi(l, c, k) + mi(l, k, r)*mr(l, c, k))
               end do
            end do
         end do
      end do
   end subroutine eliminate
end module psalm_lane_elimination
