!> Extremes of signals of the rates, proven by branch and bound.
module psalm_proof_rate_extremes
   use psalm_proof_groups, only: numbers_t
   use psalm_proof_plan, only: proof_plan_t
   use psalm_proof_quantity, only: quantity_t, quantity_measure, quantity_slide
   use psalm_proof_rates, only: models_t => rate_models_t, evaluate => evaluate_rates
   use psalm_taylor, only: rk, lanes, degree, eps, up, smallest
   implicit none (type, external)
   private
   public :: place_t, greatest_t, find_greatest

   include 'proof_extremes.inc'
end module psalm_proof_rate_extremes
