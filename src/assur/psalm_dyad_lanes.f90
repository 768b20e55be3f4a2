!> The numbers of a dyad in several linkages of one topology, side by side.
!>
!> What the linkages have in common - kind, rows, assembly - is in the `dyad_t` of any of them.
module psalm_dyad_lanes
   use psalm_kinds, only: wp
   use psalm_lanes, only: lanes
   implicit none (type, external)
   private
   public :: dyad_lanes_t

   !> Components as those of `dyad_t` and `tip_t`, by lane.
   type :: dyad_lanes_t
      real(wp) :: p(lanes) = 0.0_wp, q(lanes) = 0.0_wp
      real(wp) :: px(lanes) = 1.0_wp, py(lanes) = 0.0_wp, qx(lanes) = 1.0_wp, qy(lanes) = 0.0_wp
      real(wp) :: tip_x(lanes) = 0.0_wp, tip_y(lanes) = 0.0_wp
      real(wp) :: accepts_low(lanes) = 0.0_wp, accepts_high(lanes) = 0.0_wp
   end type dyad_lanes_t
end module psalm_dyad_lanes
