!> Where a linkage closes, proven by branch and bound in the working precision.
!>
!> A box of the input over which every closure measure is positive closes, one over which a measure is negative is open. A root
!> of a measure needs no derivative of the linkage: the polynomial of a model brackets it, and the bracket becomes a box, as long
!> as it is wide or a few times.
!> The procedures are in `proof_closure.inc`; `psalm_proof_closure_quad` is the same in quadruple precision.
module psalm_proof_closure
   use psalm_proof_groups, only: numbers_t, models_t, evaluate
   use psalm_proof_pieces, only: piece_closes, piece_opens, piece_undecided
   use psalm_proof_plan, only: proof_plan_t
   use psalm_taylor, only: rk, lanes, degree, eps, up
   implicit none (type, external)
   private
   public :: piece_t, find_pieces

   include 'proof_closure.inc'
end module psalm_proof_closure
