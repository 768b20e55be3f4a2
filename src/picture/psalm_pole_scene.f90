!> What pictures show of four poses: the curves of the pivots, the poles, the best linkage, and what every pair of pivots is worth.
module psalm_pole_scene
   use psalm_burmester, only: pin_pair_t
   use psalm_data_set, only: data_set_t
   use psalm_exact_results, only: exact_result_t
   use psalm_kinds, only: wp
   use psalm_pole_curves, only: curve_sample_t, pole_map_t
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: pole_scene_t, asks_for_poles, check_poles, make_pole_scene, poses_drawn, rays_drawn

   integer, parameter :: poses_drawn = 4
   integer, parameter :: rays_drawn = 360            !! of the curves

   type :: pole_scene_t
      character(:), allocatable :: title
      complex(wp) :: pose(poses_drawn) = (0.0_wp, 0.0_wp), axis(poses_drawn) = (1.0_wp, 0.0_wp) !! reference point, direction
      complex(wp) :: pole(poses_drawn, poses_drawn) = (0.0_wp, 0.0_wp) !! of each two poses
      logical :: has_pole(poses_drawn, poses_drawn) = .false. !! false too where both are the same
      integer :: base = 2                            !! rays begin at the pole of pose 1 and this one
      type(curve_sample_t), allocatable :: curve(:)  !! branch by branch, from the first pose's point
      logical :: has_best = .false.
      type(exact_result_t) :: best
      type(pin_pair_t), allocatable :: lines(:)          !! a slide, if one is asked for
      logical :: has_map = .false.
      type(pole_map_t) :: map
      real(wp) :: at(2) = 0.0_wp                     !! the best pair on the axes of the map: rays, degrees; of branch 2 180 more
   end type pole_scene_t

   interface
      !> True if &EXACT asks for four poses that leave curves.
      module pure logical function asks_for_poles(set)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
      end function asks_for_poles

      !> Errors: poses that are the same, and what else &EXACT cannot ask for.
      module subroutine check_poles(set, findings)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(diagnostics_t), intent(inout) :: findings
      end subroutine check_poles

      !> The scene of four poses that have passed `check_poles`. `drawn` false: their curves cannot be sampled.
      module subroutine make_pole_scene(set, scene, drawn)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(pole_scene_t), intent(out) :: scene
         logical, intent(out) :: drawn
      end subroutine make_pole_scene
   end interface
end module psalm_pole_scene
