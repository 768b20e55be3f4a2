!> Taylor models in the working precision, several boxes at a time in vector registers.
!>
!> The arithmetic itself is in `taylor.inc`; `psalm_taylor_quad` is the same in quadruple precision. Source of models with the
!> roundings in the radius: Revol, Makino and Berz (2005).
module psalm_taylor
   use psalm_angles, only: unit_vector
   use psalm_kinds, only: rk => wp
   implicit none (type, external)
   private
   public :: rk, lanes, degree, eps, up, down, smallest, rounding, pair_rounding
   public :: norm_of, pair_norm_of, pair_length, multiply, multiply_twice, range_of, reciprocal, square_root, turn_crank

   integer, parameter :: lanes = 8    !! boxes at a time
   integer, parameter :: degree = 4   !! of the polynomials, at least 2

   include 'taylor.inc'
end module psalm_taylor
