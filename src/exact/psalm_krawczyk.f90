!> Krawczyk's test in discs: that a solution of polynomial equations exists, alone in its discs, and whether it is real.
!>
!> Sources: Krawczyk (1969); Rump (1999) for discs; Breiding, Rose and Timme (2023) for the test of reality.
module psalm_krawczyk
   use psalm_kinds, only: wp, dp
   use psalm_product_sums, only: most_factors, product_sums_t
   use psalm_quad, only: qp
   implicit none (type, external)
   private
   public :: examine

   integer, parameter :: cp = wp
   !> A kind of at least 18 digits: that of x87 where there is one.
   integer, parameter :: fp = merge(wp, selected_real_kind(18), precision(1.0_wp) >= 18)

   include 'krawczyk.inc'
end module psalm_krawczyk
