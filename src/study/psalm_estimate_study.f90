!> Does the bending of a link matter? What the group ESTIM asks for, for every link by itself. Data in, results out.
!> Source: Haines, chapter 2, with his bounds of chapter 1.
module psalm_estimate_study
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t
   use psalm_harmonic_bounds, only: extent_t, extent_of, harmonic_bound
   use psalm_kinds, only: wp
   use psalm_link_cycle, only: link_cycle_t, find_link_cycle
   use psalm_periodic, only: periodic_t, periodic_from_samples
   use psalm_vibration_estimates, only: euler_load, frequency_ratio, static_deflection, dynamic_error, impulse_magnifier, &
      frequency_fall, strength_ratio, tie_rod_ratio, straightening, foreshortening_sine, post_support_of_slenderness
   use psalm_vibration_group, only: beam_t
   implicit none (type, external)
   private
   public :: estimate_t, find_estimate, harmonics_estimated, stubby
   public :: verdict_rigid, verdict_closer, verdict_redesign

   integer, parameter :: verdict_rigid = 1, verdict_closer = 2, verdict_redesign = 3
   real(wp), parameter :: rigid_part = 1.0e-3_wp   !! deflection over length below which a link is rigid enough
   real(wp), parameter :: large_part = 1.0e-2_wp   !! and above which it is to be designed again
   real(wp), parameter :: small_load = 0.9_wp      !! of Euler's load: nearer to buckling it is to be designed again
   real(wp), parameter :: stubby = 5.0_wp          !! slenderness below which Ritz's estimate on posts is not accurate
   integer, parameter :: harmonics_estimated = 12
   integer, parameter :: extents_used = 4          !! of the acceleration and three derivatives

   type :: estimate_t
      type(link_cycle_t) :: cycle
      real(wp) :: slenderness = 0.0_wp
      real(wp) :: euler = 0.0_wp                 !! Euler's load, N
      real(wp) :: push = 0.0_wp                  !! greatest compression, N; negative: always pulled
      real(wp) :: relief = 1.0_wp                !! least H = 1 - load/Euler's load
      real(wp) :: ratio = 0.0_wp                 !! W: first frequency over speed
      real(wp) :: shear_fall = 0.0_wp            !! relative fall of the first frequency by shear and rotary inertia
      real(wp) :: post_ratio = 1.0_wp            !! first frequency on posts of its own section over that on rigid ones
      real(wp) :: middle = 0.0_wp                !! greatest transverse acceleration of the middle, m/s2
      real(wp) :: deflection = 0.0_wp            !! quasi-static, of mode 1, m
      real(wp) :: resonant = 0.0_wp              !! of the harmonic nearest resonance, dynamic error, m
      integer :: harmonic = 0                    !! its number
      real(wp) :: amplitude = 0.0_wp             !! of the acceleration in it, m/s2
      real(wp) :: bound = 0.0_wp                 !! and its bound from range and variation, m/s2
      real(wp) :: magnifier = 1.0_wp             !! of impulses once a turn
      real(wp) :: strength = 0.0_wp              !! least W that strength allows; 0: not known
      real(wp) :: tie_rod = 0.0_wp               !! the same of a tie rod
      real(wp) :: ends = 0.0_wp                  !! greatest transverse acceleration of the ends about the middle, m/s2
      real(wp) :: second = 0.0_wp                !! quasi-static deflection of mode 2, m
      real(wp) :: straightened = 0.0_wp          !! part of the deflection that turning takes away
      real(wp) :: shortened = 0.0_wp             !! of the distance of the pins by the deflection, m
      real(wp) :: amplitudes(harmonics_estimated) = 0.0_wp !! of the acceleration of the middle, m/s2
      real(wp) :: bounds(harmonics_estimated) = 0.0_wp     !! of these, from range and variation
      integer :: verdict = verdict_rigid
   end type estimate_t

contains

   subroutine find_estimate(set, given, dimensions, model, beam, estimate)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(beam_t), intent(in) :: beam
      type(estimate_t), intent(out) :: estimate
      type(periodic_t) :: acceleration, derived
      type(extent_t) :: extents(0:extents_used - 1)
      real(wp), allocatable :: middle(:), pull(:)
      real(wp) :: speed, stiffness, delta
      integer :: k, points

      points = set%estimates%points
      call find_link_cycle(given, dimensions, model, beam, points, sign(1.0_wp, set%speed), estimate%cycle)
      if (estimate%cycle%trouble > 0) return
      speed = abs(set%speed)
      stiffness = beam%modulus*beam%area*beam%gyration**2
      associate (c => estimate%cycle, e => estimate)
         middle = speed**2*(c%across + 0.5_wp*c%length*c%turning)
         pull = speed**2*(c%own + c%others) + c%fixed
         e%slenderness = c%length/beam%gyration
         e%euler = euler_load(stiffness, c%length)
         e%push = -minval(pull)
         e%relief = 1.0_wp - max(e%push, 0.0_wp)/e%euler
         e%ratio = frequency_ratio(stiffness, c%length, c%mass, speed)
         e%shear_fall = frequency_fall(e%slenderness, beam%shear_ratio)
         call post_support_of_slenderness(e%slenderness, delta, e%post_ratio)
         e%magnifier = impulse_magnifier(beam%damping, e%ratio)
         e%middle = maxval(abs(middle))
         e%ends = 0.5_wp*c%length*speed**2*maxval(abs(c%turning))
         e%straightened = straightening(speed*maxval(abs(c%speed)), speed, e%ratio)
         if (beam%depth > 0.0_wp .and. beam%strain > 0.0_wp) then
            e%tie_rod = tie_rod_ratio(maxval(abs(speed**2*c%along))/speed**2, c%length, beam%strain)
            e%strength = strength_ratio(0.5_wp*beam%depth, beam%gyration, beam%modulus, beam%density, e%middle/speed**2, speed, &
                                        beam%strain)
         end if
         acceleration = periodic_from_samples(middle)
         do k = 0, extents_used - 1
            derived = acceleration%derivative(k)
            extents(k) = extent_of(derived%values(points))
         end do
         e%harmonic = max(1, nint(e%ratio))
         e%amplitude = acceleration%amplitude(e%harmonic)
         e%bound = harmonic_bound(e%harmonic, extents)
         do k = 1, harmonics_estimated
            e%amplitudes(k) = acceleration%amplitude(k)
            e%bounds(k) = harmonic_bound(k, extents)
         end do
         if (e%relief > 0.0_wp) then
            e%second = abs(static_deflection(2, e%ends, speed, e%ratio, 1.0_wp - 0.25_wp*(1.0_wp - e%relief)))
            e%deflection = abs(static_deflection(1, e%middle, speed, e%ratio, e%relief))
            e%resonant = abs(static_deflection(1, e%amplitude, speed, e%ratio, e%relief)) &
                         *dynamic_error(e%harmonic, 1, e%ratio, max(beam%damping, epsilon(1.0_wp)), .false.)
            e%shortened = foreshortening_sine*(e%deflection + e%resonant)**2/c%length
         end if
         if (e%relief <= 1.0_wp - small_load .or. e%deflection + e%resonant > large_part*c%length) then
            e%verdict = verdict_redesign
         else if (e%deflection + e%resonant > rigid_part*c%length) then
            e%verdict = verdict_closer
         end if
      end associate
   end subroutine find_estimate
end module psalm_estimate_study
