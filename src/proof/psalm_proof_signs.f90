!> Where signals of the rates are positive and where they are negative, proven by branch and bound.
!>
!> The search is that of closure: "closes" is positive, all signals; "opens" is negative. What is left are the brackets of the
!> roots.
module psalm_proof_signs
   use psalm_proof_groups, only: numbers_t
   use psalm_proof_pieces, only: piece_closes, piece_opens, piece_undecided
   use psalm_proof_plan, only: proof_plan_t
   use psalm_proof_rates, only: models_t => rate_models_t, evaluate => evaluate_rates
   use psalm_taylor, only: rk, lanes, degree, eps, up
   implicit none (type, external)
   private
   public :: piece_t, find_pieces

   include 'proof_closure.inc'
end module psalm_proof_signs
