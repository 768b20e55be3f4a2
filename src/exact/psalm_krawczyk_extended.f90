!> Krawczyk's test in extended precision: for solutions whose equations are too badly conditioned for psalm_krawczyk.
module psalm_krawczyk_extended
   use psalm_kinds, only: wp, dp
   use psalm_product_sums, only: most_factors, product_sums_t
   use psalm_quad, only: qp
   implicit none (type, external)
   private
   public :: examine

   !> A kind of at least 18 digits: that of x87 where there is one.
   integer, parameter :: cp = merge(wp, selected_real_kind(18), precision(1.0_wp) >= 18)
   integer, parameter :: fp = qp

   include 'krawczyk.inc'
end module psalm_krawczyk_extended
