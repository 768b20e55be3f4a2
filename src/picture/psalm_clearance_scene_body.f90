!> How the scene of a joint with clearance is made. Only this knows what the group CLEAR has.
submodule(psalm_clearance_scene) psalm_clearance_scene_body
   use psalm_clearance_group, only: clearance_group_t, clearance_of
   use psalm_clearance_study, only: clearance_study_t, check_clearance, find_clearance
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: full_turn, pi, radians_per_degree
   use psalm_status, only: diagnostics_t
   implicit none (type, external)

contains

   module procedure make_clearance_scene
      type(clearance_group_t) :: clearance
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(clearance_study_t) :: study
      type(diagnostics_t) :: findings
      real(wp) :: place, part
      integer :: i, k, next, n

      found = .false.
      clearance = clearance_of(set)
      clearance%speeds = 0
      clearance%radii = 0
      call check_clearance(set, clearance, prepared, findings)
      if (findings%failed()) return
      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call find_clearance(set, clearance, problem, prepared%mechanism, prepared%given, study, &
                          stop)
      if (.not. (study%done .and. study%followed)) return
      found = .true.
      scene%name = trim(prepared%mechanism%joints(study%joint)%name)
      scene%point = prepared%mechanism%joints(study%joint)%point
      scene%diametral = clearance%diametral
      n = size(study%input)
      allocate (scene%pin(2, size(sweep)), scene%load(2, size(sweep)), scene%force(size(sweep)))
      do i = 1, size(sweep)
         place = real(n, wp)*modulo(study%crank%sense*(sweep(i) - study%input(1)), full_turn)/full_turn
         if (study%crank%varies) place = real(n, wp)*modulo(study%crank%time_of(sweep(i)) - &
                                                            study%crank%time_of(study%input(1)), 2.0_wp*pi)/(2.0_wp*pi)
         call between(place)
         scene%force(i) = study%force(k) + part*(study%force(next) - study%force(k))
         scene%pin(:, i) = (1.0_wp - part)*direction(study%pin(k)) + part*direction(study%pin(next))
         scene%pin(:, i) = scene%pin(:, i)/max(norm2(scene%pin(:, i)), tiny(1.0_wp))
         place = real(n, wp)*modulo(study%crank%sense*sweep(i), full_turn)/full_turn
         if (study%crank%varies) place = real(n, wp)*study%crank%time_of(sweep(i))/(2.0_wp*pi)
         call between(place)
         scene%load(:, i) = study%cycle%force(:, k) + part*(study%cycle%force(:, next) - study%cycle%force(:, k))
      end do

   contains

      !> Both positions of the turn beside a place.
      subroutine between(place)
         real(wp), intent(in) :: place

         k = modulo(int(place), n) + 1
         next = modulo(k, n) + 1
         part = place - aint(place)
      end subroutine between

      pure function direction(degrees) result(unit)
         real(wp), intent(in) :: degrees
         real(wp) :: unit(2)

         unit = [cos(radians_per_degree*degrees), sin(radians_per_degree*degrees)]
      end function direction
   end procedure make_clearance_scene
end submodule psalm_clearance_scene_body
