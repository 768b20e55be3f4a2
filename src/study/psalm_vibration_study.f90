!> Vibration of a link of a moving linkage: what the group VIBR asks for. Data in, results out.
!>
!> Boundaries of stability of every mode by itself, multipliers of all modes together at the speed of RATES, steady response,
!> a table over speeds, and the chart of boundaries against the inertia of the other links. Source: Oldham, chapters 13 and 14.
module psalm_vibration_study
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_floquet, only: coupled_multipliers
   use psalm_force_model, only: force_model_t
   use psalm_hill, only: hill_t, solve_hill
   use psalm_kinds, only: wp
   use psalm_link_cycle, only: link_cycle_t, find_link_cycle, moving_link
   use psalm_link_vibration, only: moving_link_t, mode_stiffness, mode_force, coupling, first_frequency, timoshenko_factor
   use psalm_periodic, only: periodic_t, periodic_constant, periodic_from_samples
   use psalm_stability, only: boundaries_t, stability_boundaries, series_boundaries
   implicit none (type, external)
   private
   public :: vibration_study_t, mode_t, speed_row_t, chart_row_t, find_vibration, mode_factor, harmonics_listed

   integer, parameter :: harmonics_listed = 12
   real(wp), parameter :: tolerance = 1.0e-10_wp          !! of a period's matrix
   real(wp), parameter :: coupled_tolerance = 1.0e-9_wp   !! of that of several modes
   real(wp), parameter :: table_tolerance = 1.0e-7_wp     !! in the table over speeds

   !> One mode by itself at the given speed.
   type :: mode_t
      type(boundaries_t) :: exact                !! of the squared ratio of the link's first frequency to the speed
      real(wp), allocatable :: first(:, :), second(:, :) !! shape (2, 0:last): by Oldham's (13.27) and (13.28)
      type(hill_t) :: hill                       !! steady response, in lengths of the link
      real(wp), allocatable :: amplitude(:)      !! shape (0:harmonics_listed): harmonics of it, m
      real(wp) :: least_stiffness = 0.0_wp       !! least of W j**4 + f_j over the turn: below 0 the link buckles for a while
      real(wp) :: least_at = 0.0_wp              !! degrees from the reference position
   end type mode_t

   type :: speed_row_t
      real(wp) :: speed = 0.0_wp                 !! rad/s
      real(wp) :: amplitude = 0.0_wp             !! greatest deflection of mode 1, m; of the periodic solution
      logical :: known = .false.                 !! there is one
      logical :: stable = .false.
   end type speed_row_t

   type :: chart_row_t
      real(wp) :: e = 0.0_wp
      type(boundaries_t) :: exact
   end type chart_row_t

   type :: vibration_study_t
      type(link_cycle_t) :: cycle
      real(wp) :: frequency = 0.0_wp             !! first of the link at rest, rad/s, with shear if asked for
      real(wp) :: ratio = 0.0_wp                 !! to the speed
      type(mode_t), allocatable :: modes(:)
      complex(wp), allocatable :: multipliers(:) !! of all modes together, the largest first
      real(wp) :: multiplier_error = 0.0_wp
      logical :: multipliers_found = .false.
      logical :: stable = .false.                !! all modes together
      type(speed_row_t), allocatable :: speeds(:)
      type(chart_row_t), allocatable :: chart(:)
      real(wp) :: resolution = 0.0_wp            !! what the positions leave open of the coefficients
   end type vibration_study_t

contains

   !> Squared frequency of mode j over that of Euler's first: j**4, less with shear.
   pure real(wp) function mode_factor(set, length, j)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: length !! m
      integer, intent(in) :: j

      mode_factor = real(j, wp)**4
      associate (beam => set%vibration%beam)
         if (beam%shear_ratio > 0.0_wp) mode_factor = mode_factor*timoshenko_factor(j, length/beam%gyration, beam%shear_ratio)
      end associate
   end function mode_factor

   !> Vibration of a link that `check_link` found no fault with. `study%cycle%trouble` tells where the crank cannot turn: then
   !> there is nothing else.
   subroutine find_vibration(set, given, dimensions, model, study)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(vibration_study_t), intent(out) :: study
      type(moving_link_t) :: link
      type(periodic_t) :: f
      real(wp) :: w, speed, euler
      integer :: i, j

      associate (v => set%vibration, beam => set%vibration%beam)
         call find_link_cycle(given, dimensions, model, beam, v%points, study%cycle)
         allocate (study%modes(0), study%speeds(0), study%chart(0), study%multipliers(0))
         if (study%cycle%trouble > 0) return
         speed = abs(set%speed)
         euler = first_frequency(study%cycle%length, beam%gyration, beam%modulus, beam%density)
         study%frequency = euler*sqrt(mode_factor(set, study%cycle%length, 1))
         study%ratio = study%frequency/speed
         w = (euler/speed)**2
         link = moving_link(study%cycle, speed, 1.0_wp)
         deallocate (study%modes)
         allocate (study%modes(v%modes))
         do j = 1, v%modes
            call find_mode(set, link, j, w, study%cycle%length, study%modes(j))
         end do
         f = mode_stiffness(link, 1)
         study%resolution = f%resolution()
         call find_multipliers(set, link, w, study)
         deallocate (study%speeds)
         allocate (study%speeds(v%speeds))
         do i = 1, v%speeds
            call find_speed(set, study%cycle, euler, v%slowest + (v%fastest - v%slowest)*part(i, v%speeds), study%speeds(i))
         end do
         if (v%greatest_e > 0.0_wp) then
            deallocate (study%chart)
            allocate (study%chart(v%in_chart))
            do i = 1, v%in_chart
               study%chart(i)%e = v%greatest_e*part(i, v%in_chart)
               link = moving_link(study%cycle, 0.0_wp, study%chart(i)%e/v%given_e)
               study%chart(i)%exact = stability_boundaries(mode_stiffness(link, 1), v%last)
            end do
         end if
      end associate
   end subroutine find_vibration

   !> Part of a range at which row i of n stands.
   pure real(wp) function part(i, n)
      integer, intent(in) :: i, n

      part = 0.0_wp
      if (n > 1) part = real(i - 1, wp)/real(n - 1, wp)
   end function part

   subroutine find_mode(set, link, j, w, length, mode)
      type(data_set_t), intent(in) :: set
      type(moving_link_t), intent(in) :: link
      integer, intent(in) :: j
      real(wp), intent(in) :: w       !! squared ratio of Euler's first frequency to the speed
      real(wp), intent(in) :: length  !! m
      type(mode_t), intent(out) :: mode
      type(periodic_t) :: f, c0, y
      real(wp) :: stiffness
      real(wp), allocatable :: over_turn(:)
      integer :: p, n

      f = mode_stiffness(link, j)
      stiffness = w*mode_factor(set, length, j)
      c0 = f%plus(periodic_constant(stiffness))
      mode%exact = stability_boundaries(f, set%vibration%last)
      allocate (mode%first(2, 0:set%vibration%last), mode%second(2, 0:set%vibration%last))
      do p = 0, set%vibration%last
         mode%first(:, p) = series_boundaries(f, p, 1)
         mode%second(:, p) = series_boundaries(f, p, 2)
      end do
      over_turn = c0%values(set%vibration%points)
      mode%least_stiffness = minval(over_turn)
      mode%least_at = 360.0_wp*real(minloc(over_turn, 1) - 1, wp)/real(size(over_turn), wp)
      mode%hill = solve_hill(periodic_constant(2.0_wp*set%vibration%beam%damping*sqrt(stiffness)), c0, mode_force(link, j), &
            tolerance)
      allocate (mode%amplitude(0:harmonics_listed), source=0.0_wp)
      if (.not. mode%hill%unique) return
      y = periodic_from_samples(mode%hill%y)
      do n = 0, harmonics_listed
         mode%amplitude(n) = length*y%amplitude(n)
      end do
   end subroutine find_mode

   !> All modes together, with what couples them.
   subroutine find_multipliers(set, link, w, study)
      type(data_set_t), intent(in) :: set
      type(moving_link_t), intent(in) :: link
      real(wp), intent(in) :: w
      type(vibration_study_t), intent(inout) :: study
      type(periodic_t) :: k(set%vibration%modes, set%vibration%modes)
      real(wp) :: damping(set%vibration%modes), stiffness
      integer :: i, j

      do j = 1, size(damping)
         do i = 1, size(damping)
            k(i, j) = coupling(link, i, j)
         end do
         stiffness = w*mode_factor(set, study%cycle%length, j)
         k(j, j) = k(j, j)%plus(periodic_constant(stiffness))
         damping(j) = 2.0_wp*set%vibration%beam%damping*sqrt(stiffness)
      end do
      deallocate (study%multipliers)
      allocate (study%multipliers(2*size(damping)))
      call coupled_multipliers(k, damping, coupled_tolerance, study%multipliers, study%multiplier_error, study%multipliers_found)
      study%stable = study%multipliers_found .and. maxval(abs(study%multipliers)) < 1.0_wp - 16.0_wp*study%multiplier_error
   end subroutine find_multipliers

   !> Mode 1 at another speed.
   subroutine find_speed(set, cycle_of, euler, speed, row)
      type(data_set_t), intent(in) :: set
      type(link_cycle_t), intent(in) :: cycle_of
      real(wp), intent(in) :: euler   !! first frequency of the slender link, rad/s
      real(wp), intent(in) :: speed
      type(speed_row_t), intent(out) :: row
      type(moving_link_t) :: link
      type(periodic_t) :: f
      type(hill_t) :: hill
      real(wp) :: stiffness

      link = moving_link(cycle_of, speed, 1.0_wp)
      f = mode_stiffness(link, 1)
      stiffness = (euler/speed)**2*mode_factor(set, cycle_of%length, 1)
      hill = solve_hill(periodic_constant(2.0_wp*set%vibration%beam%damping*sqrt(stiffness)), &
                        f%plus(periodic_constant(stiffness)), mode_force(link, 1), table_tolerance)
      row%speed = speed
      row%stable = hill%stable
      row%known = hill%unique
      if (hill%unique) row%amplitude = cycle_of%length*maxval(abs(hill%y))
   end subroutine find_speed
end module psalm_vibration_study
