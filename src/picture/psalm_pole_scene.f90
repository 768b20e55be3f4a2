!> What pictures show of four poses: the curves of the pivots, the poles, the best linkage, and what every pair of pivots is worth.
module psalm_pole_scene
   use psalm_angles, only: unit_vector
   use psalm_burmester, only: pin_pair_t
   use psalm_data_set, only: data_set_t
   use psalm_exact_group, only: exact_group_t, exact_of
   use psalm_exact_results, only: exact_result_t
   use psalm_exact_study, only: exact_study_t, find_exact, poses_of
   use psalm_kinds, only: wp, half_turn
   use psalm_pole_curves, only: curve_sample_t, pole_map_t, map_pairs, sample_curve
   implicit none (type, external)
   private
   public :: pole_scene_t, make_pole_scene, poses_drawn, rays_drawn

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

contains

   !> The scene of four poses that have passed `check_exact`. `drawn` false: their curves cannot be sampled.
   subroutine make_pole_scene(set, scene, drawn)
      type(data_set_t), intent(in) :: set
      type(pole_scene_t), intent(out) :: scene
      logical, intent(out) :: drawn
      type(exact_group_t) :: exact
      type(exact_study_t), allocatable :: study
      complex(wp) :: d(poses_drawn - 1), g(poses_drawn - 1), moved(poses_drawn), turned(poses_drawn)
      real(wp) :: c, s
      integer :: i, k

      exact = exact_of(set)
      allocate (study)
      call find_exact(set, study)
      drawn = .not. study%degenerate
      scene%title = set%title
      if (.not. drawn) return
      call poses_of(exact, scene%pose, d, g)
      do i = 1, poses_drawn
         call unit_vector(exact%angle(i), c, s)
         scene%axis(i) = cmplx(c, s, wp)
      end do
      moved = [(0.0_wp, 0.0_wp), d]
      turned = [(1.0_wp, 0.0_wp), 1.0_wp + g]
      do i = 1, poses_drawn
         do k = i + 1, poses_drawn
            if (.not. abs(turned(k) - turned(i)) > 0.0_wp) cycle
            scene%has_pole(i, k) = .true.
            scene%pole(i, k) = scene%pose(1) + moved(i) + turned(i)*(moved(i) - moved(k))/(turned(k) - turned(i))
         end do
      end do
      scene%base = 1 + maxloc(abs(g), dim=1)
      call sample_curve(d, g, rays_drawn, scene%curve)
      scene%lines = study%lines
      scene%has_best = size(study%results) > 0
      if (scene%has_best) scene%best = study%results(1)
      scene%has_map = size(study%lines) == 0
      if (.not. scene%has_map) return
      call map_pairs(scene%pose, d, g, exact%closed, scene%map)
      if (.not. scene%has_best) return
      scene%at = [place_of(scene%best%linkage%a), place_of(scene%best%linkage%b)]

   contains

      !> Where a pivot stands on the axes of the map.
      pure real(wp) function place_of(pivot)
         complex(wp), intent(in) :: pivot
         integer :: nearest

         nearest = minloc(abs(scene%pose(1) + study%curve%dyad%pivot - pivot), dim=1)
         place_of = study%curve(nearest)%ray + half_turn*real(study%curve(nearest)%branch - 1, wp)
      end function place_of
   end subroutine make_pole_scene
end module psalm_pole_scene
