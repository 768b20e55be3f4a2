!> Models of the dyads and of a whole linkage in quadruple precision.
module psalm_proof_groups_quad
   use psalm_dyad_kind, only: assur_prp, assur_ppr, assur_rpp, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_prr, assur_rrr
   use psalm_plan, only: root_crank, root_frame
   use psalm_proof_plan, only: proof_plan_t, proof_step_t, least_sine, measures_of
   use psalm_quad, only: sqrt
   use psalm_taylor_quad, only: rk, lanes, degree, eps, up, down, smallest, rounding, pair_rounding, norm_of, pair_norm_of, &
                           pair_length, multiply, multiply_twice, range_of, reciprocal, square_root, turn_crank
   implicit none (type, external)
   private
   public :: numbers_t, models_t, prepare_models, evaluate, add_up, direct

   real(rk), parameter :: near_zero = 1.0e-12_rk        !! of the squared links: outer joints that may coincide
   real(rk), parameter :: smallest_length = 1.0e-30_rk  !! guards a division where a tolerance is as long as a link

   include 'proof_groups.inc'
end module psalm_proof_groups_quad
