!> Taylor models in quadruple precision, one box at a time: what is too narrow for the working precision.
module psalm_taylor_quad
   use psalm_quad, only: rk => qp, sqrt, unit_vector => unit_vector_quad
   implicit none (type, external)
   private
   public :: rk, lanes, degree, eps, up, down, smallest, rounding, pair_rounding
   public :: norm_of, pair_norm_of, pair_length, multiply, multiply_twice, range_of, reciprocal, square_root, turn_crank

   integer, parameter :: lanes = 1    !! boxes at a time
   integer, parameter :: degree = 5   !! of the polynomials, at least 2

   include 'taylor.inc'
end module psalm_taylor_quad
