!> The one real kind of the suite, and the constants every room needs.
!>
!> `wp` is real64; the same sources build in real32 or real128 with `-DREAL32` or `-DREAL128`. This is the only
!> preprocessed file.
module psalm_kinds
   use, intrinsic :: iso_fortran_env, only: real32, real64, real128, int32, int64
   implicit none (type, external)
   private
   public :: wp, dp, i8, pi, radians_per_degree, degrees_per_radian, half_turn, full_turn, right_angle

#if defined(REAL32)
   integer, parameter :: wp = real32  !! working precision
#elif defined(REAL128)
   integer, parameter :: wp = real128 !! working precision
#else
   integer, parameter :: wp = real64  !! working precision
#endif
   integer, parameter :: dp = real64  !! precision of what is printed in the thesis's columns, and of clocks
   integer, parameter :: i8 = int64   !! integers of at least 63 bits: counters, the random sequence

   real(wp), parameter :: pi = 3.14159265358979323846264338327950288_wp
   real(wp), parameter :: radians_per_degree = pi/180.0_wp
   real(wp), parameter :: degrees_per_radian = 180.0_wp/pi
   real(wp), parameter :: right_angle = 90.0_wp   !! degrees
   real(wp), parameter :: half_turn = 180.0_wp    !! degrees
   real(wp), parameter :: full_turn = 360.0_wp    !! degrees
end module psalm_kinds
