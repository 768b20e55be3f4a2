!> The sign of a sum, exactly: by sums and differences free of error.
module psalm_exact_sum
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: sign_of_sum

contains

   !> -1, 0 or +1, the sign of the exact sum of some numbers.
   !>
   !> The sum is kept as parts that do not overlap. Source: Shewchuk (1997), Adaptive precision floating-point arithmetic.
   pure integer function sign_of_sum(terms)
      real(wp), intent(in) :: terms(:)   !! no sum of them may overflow
      real(wp) :: parts(size(terms)), carry, sum, virtual
      integer :: i, k

      parts = 0.0_wp
      do i = 1, size(terms)
         carry = terms(i)
         do k = 1, i - 1
            sum = carry + parts(k)
            virtual = sum - carry
            parts(k) = (carry - (sum - virtual)) + (parts(k) - virtual)
            carry = sum
         end do
         parts(i) = carry
      end do
      sign_of_sum = 0
      do k = size(terms), 1, -1
         if (parts(k) > 0.0_wp) sign_of_sum = 1
         if (parts(k) < 0.0_wp) sign_of_sum = -1
         if (sign_of_sum /= 0) return
      end do
   end function sign_of_sum
end module psalm_exact_sum
