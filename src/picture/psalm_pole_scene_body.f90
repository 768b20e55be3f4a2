!> How the scene of four poses is made. Only this knows what the group EXACT has.
submodule(psalm_pole_scene) psalm_pole_scene_body
   use psalm_angles, only: unit_vector
   use psalm_exact_group, only: exact_group_t, exact_of
   use psalm_exact_study, only: exact_study_t, check_exact, find_exact, leaves_curves, poses_of
   use psalm_kinds, only: half_turn
   use psalm_pole_curves, only: map_pairs, sample_curve
   implicit none (type, external)

contains

   module procedure asks_for_poles
      type(exact_group_t) :: exact

      exact = exact_of(set)
      asks_for_poles = leaves_curves(exact)
      if (asks_for_poles) asks_for_poles = size(exact%x) == poses_drawn
   end procedure asks_for_poles

   module procedure check_poles

      call check_exact(set, findings)
   end procedure check_poles

   module procedure make_pole_scene
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
   end procedure make_pole_scene
end submodule psalm_pole_scene_body
