!> Extremes of a motion, all quantities at once, proven by branch and bound in quadruple precision.
module psalm_proof_extremes_quad
   use psalm_proof_groups_quad, only: numbers_t, models_t, evaluate
   use psalm_proof_plan, only: proof_plan_t
   use psalm_proof_quantity, only: quantity_t, quantity_measure, quantity_slide
   use psalm_quad, only: sqrt
   use psalm_taylor_quad, only: rk, lanes, degree, eps, up, smallest
   implicit none (type, external)
   private
   public :: place_t, greatest_t, find_greatest

   include 'proof_extremes.inc'
end module psalm_proof_extremes_quad
