!> How the scene of a vibrating link is made. Only this knows what the group VIBR has.
submodule(psalm_vibration_scene) psalm_vibration_scene_body
   use psalm_crank_motion, only: crank_motion_t
   use psalm_crank_study, only: find_crank
   use psalm_error, only: problem_t, make_problem
   use psalm_force_model, only: force_model_t, make_force_model
   use psalm_kinds, only: radians_per_degree
   use psalm_periodic, only: periodic_t, periodic_from_samples
   use psalm_plot, only: round_down
   use psalm_status, only: diagnostics_t
   use psalm_steady_study, only: check_steady, make_model_with_links
   use psalm_stop, only: is_to_end
   use psalm_vibration_group, only: vibration_group_t, vibration_of
   use psalm_vibration_study, only: find_vibration
   implicit none (type, external)

   real(wp), parameter :: drawn_part = 0.12_wp !! of the link's length: its greatest deflection as drawn, about

contains

   module procedure make_vibration_scene
      type(vibration_group_t) :: vibration
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      class(force_model_t), allocatable :: bare, model, complete
      type(crank_motion_t) :: crank
      type(diagnostics_t) :: findings
      type(periodic_t) :: q
      real(wp) :: largest
      integer :: j, n

      found = .false.
      vibration = vibration_of(set)
      call check_steady(set, prepared, findings, vibration_alone=.true.)
      if (findings%failed()) return
      allocate (problem, bare)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call make_force_model(set, prepared%mechanism, prepared%given, bare, findings)
      n = prepared%mechanism%seq(vibration%beam%link%loop, vibration%beam%link%arc)
      call make_model_with_links(set, prepared%mechanism, prepared%given, n, bare, model)
      call make_model_with_links(set, prepared%mechanism, prepared%given, 0, bare, complete)
      call find_crank(set, problem, complete, crank, stop)
      if (.not. crank%known) return
      call find_vibration(set, problem, prepared%given, model, crank, scene%study, stop)
      if (size(scene%study%modes) == 0 .or. is_to_end(stop)) return
      scene%metre = model%metre
      scene%bar = prepared%mechanism%arcs(n)%bar
      scene%reversed = prepared%mechanism%arcs(n)%reversed
      scene%settles = .true.
      allocate (scene%deflection(size(sweep), size(scene%study%modes)), source=0.0_wp)
      do j = 1, size(scene%study%modes)
         associate (hill => scene%study%modes(j)%hill)
            scene%settles = scene%settles .and. (hill%stable .or. hill%neutral) .and. hill%unique
            if (.not. hill%unique) cycle
            found = .true.
            q = periodic_from_samples(scene%study%cycle%length/scene%metre*hill%y)
            if (crank%varies) then
               scene%deflection(:, j) = q%at(crank%time_of(sweep))
            else
               scene%deflection(:, j) = q%at(crank%sense*radians_per_degree*sweep)
            end if
         end associate
      end do
      largest = maxval(sum(abs(scene%deflection), dim=2))
      if (largest > 0.0_wp) scene%factor = round_down(drawn_part*scene%study%cycle%length/scene%metre/largest)
   end procedure make_vibration_scene
end submodule psalm_vibration_scene_body
