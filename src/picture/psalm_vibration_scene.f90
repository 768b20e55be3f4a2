!> What pictures show of a vibrating link: how it is bent over the sweep, and what ssics finds over speeds and for the chart.
module psalm_vibration_scene
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, make_problem
   use psalm_force_model, only: force_model_t, make_force_model
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_mechanism, only: mechanism_t
   use psalm_periodic, only: periodic_t, periodic_from_samples
   use psalm_preparation, only: prepared_t
   use psalm_status, only: diagnostics_t
   use psalm_steady_study, only: steady_groups_t, check_steady, model_with_links
   use psalm_vibration_group, only: vibration_of
   use psalm_vibration_study, only: vibration_study_t, find_vibration
   implicit none (type, external)
   private
   public :: vibration_scene_t, make_vibration_scene

   real(wp), parameter :: drawn_part = 0.12_wp !! of the link's length: its greatest deflection as drawn, about

   type :: vibration_scene_t
      type(vibration_study_t) :: study
      integer :: bar = 0                         !! the link
      logical :: reversed = .false.              !! the bar runs against the arc
      real(wp), allocatable :: deflection(:, :)  !! shape (sweep, modes): of each mode, user's length, to the left of the arc
      real(wp) :: factor = 1.0_wp                !! it is drawn that many times larger
      real(wp) :: given_e = 1.0_wp, greatest_e = 0.0_wp !! of the chart
      real(wp) :: metre = 1.0_wp                 !! metres in the user's unit of length
      logical :: settles = .false.               !! the deflection is what the link does
   end type vibration_scene_t

contains

   !> Of a case with the group VIBR. Errors: `found` false if ssics would refuse it, or there is no periodic deflection.
   subroutine make_vibration_scene(set, prepared, sweep, scene, found)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      real(wp), intent(in) :: sweep(:)           !! increments of the input, degrees
      type(vibration_scene_t), intent(out) :: scene
      logical, intent(out) :: found
      type(steady_groups_t) :: alone
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(force_model_t) :: model
      type(diagnostics_t) :: findings
      type(periodic_t) :: q
      real(wp) :: largest
      integer :: j, n

      found = .false.
      alone%vibration = vibration_of(set)
      allocate (alone%estimates%beams(0))
      call check_steady(set, alone, prepared, findings)
      if (findings%failed()) return
      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call make_force_model(set, prepared%mechanism, prepared%given, model, findings)
      n = prepared%mechanism%seq(alone%vibration%beam%link%loop, alone%vibration%beam%link%arc)
      model = model_with_links(set, prepared%mechanism, prepared%given, n, model)
      call find_vibration(set, problem, prepared%given, model, scene%study)
      if (size(scene%study%modes) == 0) return
      scene%metre = model%metre
      scene%given_e = alone%vibration%given_e
      scene%greatest_e = alone%vibration%greatest_e
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
            scene%deflection(:, j) = q%at(scene%study%cycle%sense*radians_per_degree*sweep)
         end associate
      end do
      largest = maxval(sum(abs(scene%deflection), dim=2))
      if (largest > 0.0_wp) scene%factor = round_down(drawn_part*scene%study%cycle%length/scene%metre/largest)
   end subroutine make_vibration_scene

   !> The next 1, 2 or 5 times a power of ten below; at least 1.
   pure real(wp) function round_down(value)
      real(wp), intent(in) :: value
      real(wp) :: power

      round_down = 1.0_wp
      if (value <= 1.0_wp) return
      power = 10.0_wp**floor(log10(value))
      round_down = power
      if (value >= 2.0_wp*power) round_down = 2.0_wp*power
      if (value >= 5.0_wp*power) round_down = 5.0_wp*power
   end function round_down
end module psalm_vibration_scene
