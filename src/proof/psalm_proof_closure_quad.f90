!> Where a linkage closes, proven by branch and bound in quadruple precision, as in `psalm_proof_closure`.
module psalm_proof_closure_quad
   use psalm_proof_groups_quad, only: numbers_t, models_t, evaluate
   use psalm_proof_pieces, only: piece_closes, piece_opens, piece_undecided
   use psalm_proof_plan, only: proof_plan_t
   use psalm_quad, only: sqrt
   use psalm_taylor_quad, only: rk, lanes, degree, eps, up
   implicit none (type, external)
   private
   public :: piece_t, find_pieces, join_pieces

   include 'proof_closure.inc'
end module psalm_proof_closure_quad
