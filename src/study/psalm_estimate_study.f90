!> Does the bending of a link matter? What the group ESTIM asks for, for every link by itself. Data in, results out.
!>
!> The quasi-static deflection is that of (13.24) without Q_j'', with what couples the modes: sum of (j**4 W**2 [j = k] + K_jk) Q_k
!> = p_j, of inertia, weight, loads and springs at each position. The dynamic error is that of mode 1: the sum of Haines's (25c)
!> over the harmonics of this deflection, the harmonic nearest resonance times his magnifier of impulses (26c). The error by changes
!> of the end load takes the harmonic nearest resonance as that of a step once a turn (10E), the error by impact the clearance of
!> the pins and the greatest rate at which the relative acceleration of a pin that is set free changes (2J). The rules of the
!> verdict are his (2B, 2G, 2M). Source: Haines, chapter 2, with his bounds of chapter 1.
module psalm_estimate_study
   use psalm_crank_motion, only: crank_motion_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t
   use psalm_harmonic_bounds, only: extent_t, extent_of, harmonic_bound
   use psalm_joint_load, only: joint_load_t, find_joint_load
   use psalm_angles, only: unit_vector
   use psalm_kinds, only: wp, half_turn
   use psalm_linear, only: solve_positive
   use psalm_link_cycle, only: link_cycle_t, add_uniform_link, find_link_cycle, moving_link
   use psalm_link_vibration, only: moving_link_t, coupling, mode_force
   use psalm_mechanism, only: mechanism_t, at_finish, joint_revolute
   use psalm_periodic, only: periodic_t, periodic_from_samples
   use psalm_vibration_estimates, only: euler_load, frequency_ratio, dynamic_error, impulse_magnifier, frequency_fall, &
      strength_ratio, tie_rod_ratio, straightening, foreshortening_sine, post_support_of_slenderness, step_error, impact_time, &
      impact_speed, impact_level, impact_error
   use psalm_beam, only: beam_t
   implicit none (type, external)
   private
   public :: estimate_t, find_estimate, harmonics_estimated, stubby, rules, assess_estimates
   public :: verdict_rigid, verdict_closer, verdict_redesign

   integer, parameter :: verdict_rigid = 1, verdict_closer = 2, verdict_redesign = 3
   !> What a link is measured by: Haines's rules of 2M, the end load of 2G, the deflection of 2B.
   type :: assessing_rule_t
      character(40) :: name
      logical :: at_least
      real(wp) :: limit
      character(14) :: words
   end type assessing_rule_t

   type(assessing_rule_t), parameter :: rules(8) = [ &
      assessing_rule_t('FIRST FREQUENCY/SPEED', .true., 10.0_wp, 'AT LEAST 10'), &
      assessing_rule_t('AXIAL FREQUENCY/SPEED WITH WHAT IT MOVES', .true., 10.0_wp, 'AT LEAST 10'), &
      assessing_rule_t('FREQUENCY/SPEED APART FROM A NEIGHBOUR''S', .true., 3.0_wp, 'AT LEAST 3'), &
      assessing_rule_t('END LOAD/EULER''S LOAD', .false., 0.25_wp, 'AT MOST 0.25'), &
      assessing_rule_t('DYNAMIC ERROR/QUASI-STATIC DEFLECTION', .false., 0.1_wp, 'AT MOST 0.1'), &
      assessing_rule_t('ERROR BY STEPS OF END LOAD/DEFLECTION', .false., 0.1_wp, 'AT MOST 0.1'), &
      assessing_rule_t('ERROR BY IMPACT IN A PIN/DEFLECTION', .false., 0.1_wp, 'AT MOST 0.1'), &
      assessing_rule_t('DEFLECTION/LENGTH', .false., 0.025_wp, 'AT MOST 0.025')]
   integer, parameter :: rule_frequency = 1, rule_axial = 2, rule_apart = 3, rule_load = 4, rule_error = 5, rule_step = 6, &
                         rule_impact = 7, rule_deflection = 8
   real(wp), parameter :: stubby = 5.0_wp          !! slenderness below which Ritz's estimate on posts is not accurate
   integer, parameter :: harmonics_estimated = 12
   integer, parameter :: extents_used = 4          !! of the acceleration and three derivatives
   integer, parameter :: modes_summed = 24         !! of the quasi-static deflection: of a single force it is then 1e-5 too small
   integer, parameter :: samples = 64             !! parts of the link, at which it is looked for

   type :: estimate_t
      type(link_cycle_t) :: cycle
      real(wp) :: slenderness = 0.0_wp
      real(wp) :: euler = 0.0_wp                 !! Euler's load, N
      real(wp) :: push = 0.0_wp                  !! greatest compression, mean of both ends, N; negative: always pulled
      logical :: buckles = .false.               !! at a position, running or at rest
      real(wp) :: ratio = 0.0_wp                 !! W: first frequency over speed
      real(wp) :: held_ratio = 0.0_wp            !! the same with the mean of all that stiffens or relieves mode 1
      real(wp) :: shear_fall = 0.0_wp            !! relative fall of the first frequency by shear and rotary inertia
      real(wp) :: post_ratio = 1.0_wp            !! first frequency on posts of its own section over that on rigid ones
      real(wp) :: middle = 0.0_wp                !! greatest transverse acceleration of the middle, m/s2
      real(wp) :: deflection = 0.0_wp            !! quasi-static, m
      real(wp) :: at = 0.0_wp                    !! place of it from the start, part of the length
      real(wp) :: resting = 0.0_wp               !! the same of weight, loads and springs with the machine at rest, m
      logical :: loaded = .false.                !! there are such, across the link
      real(wp) :: first = 0.0_wp                 !! quasi-static deflection of mode 1, m
      real(wp) :: error = 0.0_wp                 !! dynamic error of all harmonics, m
      real(wp) :: resonant = 0.0_wp              !! that of the harmonic nearest resonance alone, m
      integer :: harmonic = 0                    !! its number
      real(wp) :: amplitude = 0.0_wp             !! of the acceleration in it, m/s2
      real(wp) :: bound = 0.0_wp                 !! and its bound from range and variation, m/s2
      real(wp) :: magnifier = 1.0_wp             !! of impulses once a turn
      real(wp) :: strength = 0.0_wp              !! least W that strength allows; 0: not known
      real(wp) :: tie_rod = 0.0_wp               !! the same of a tie rod
      real(wp) :: ends = 0.0_wp                  !! greatest transverse acceleration of the ends about the middle, m/s2
      real(wp) :: second = 0.0_wp                !! quasi-static deflection of mode 2, m
      real(wp) :: clearance = 0.0_wp             !! of its pins, m; 0: not known
      real(wp) :: jerk = 0.0_wp                  !! greatest rate of the relative acceleration of a pin that is set free, m/s3
      real(wp) :: impact_time = 0.0_wp           !! across the clearance with it, s
      real(wp) :: impact_speed = 0.0_wp          !! m/s
      real(wp) :: impact_level = 0.0_wp          !! of every harmonic of the acceleration, once a turn, m/s2
      real(wp) :: straightened = 0.0_wp          !! part of the deflection that turning takes away
      real(wp) :: shortened = 0.0_wp             !! of the distance of the pins by the deflection, m
      real(wp) :: amplitudes(harmonics_estimated) = 0.0_wp !! of the acceleration of the middle, m/s2
      real(wp) :: bounds(harmonics_estimated) = 0.0_wp     !! of these, from range and variation
      logical :: measured(size(rules)) = .false. !! by rule: it has something to assess
      real(wp) :: measures(size(rules)) = 0.0_wp !! by rule
      logical :: kept(size(rules)) = .false.     !! by rule
      integer :: verdict = verdict_rigid
   end type estimate_t

contains

   subroutine find_estimate(given, dimensions, model, beam, clearance, points, crank, estimate)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(beam_t), intent(in) :: beam
      real(wp), intent(in) :: clearance          !! of its pins, diametral, m; 0: not known
      integer, intent(in) :: points              !! positions in a turn
      type(crank_motion_t), intent(in) :: crank  !! known
      type(estimate_t), intent(out) :: estimate
      type(moving_link_t) :: link
      type(periodic_t) :: acceleration, derived
      type(extent_t) :: extents(0:extents_used - 1)
      real(wp), allocatable :: middle(:), pull(:)
      real(wp) :: speed, stiffness, delta
      integer :: k

      call find_link_cycle(given, dimensions, model, beam, points, crank, estimate%cycle)
      if (estimate%cycle%failure > 0) return
      speed = crank%speed
      stiffness = beam%modulus*beam%area*beam%gyration**2
      associate (c => estimate%cycle, e => estimate)
         middle = speed**2*(c%across + 0.5_wp*c%length*c%turning)
         ! at the middle: the mean of the pulls at both ends
         pull = speed**2*(c%own + c%others) + c%fixed + speed*c%viscous &
                + 0.5_wp*c%mass*(c%weight_along - speed**2*(c%along - 0.5_wp*c%length*c%speed**2))
         do k = 1, size(c%acting)
            pull = pull + 0.5_wp*c%acting(k)%along
         end do
         e%loaded = size(c%acting) > 0 .or. any(abs(c%weight_across) > 0.0_wp)
         e%slenderness = c%length/beam%gyration
         e%euler = euler_load(stiffness, c%length)
         e%push = -minval(pull)
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
         do k = 1, harmonics_estimated
            e%amplitudes(k) = acceleration%amplitude(k)
            e%bounds(k) = harmonic_bound(k, extents)
         end do
         link = moving_link(c, speed, 1.0_wp)
         call deflect(link, beam%damping, e)
         e%amplitude = acceleration%amplitude(e%harmonic)
         e%bound = harmonic_bound(e%harmonic, extents)
         e%shortened = foreshortening_sine*(e%deflection + e%error)**2/c%length
         if (e%loaded) call rest(speed, e)
      end associate
      call find_axial(given, dimensions, model, beam, speed, estimate)
      estimate%clearance = clearance
      if (estimate%buckles .or. .not. estimate%deflection > 0.0_wp) return
      if (minval(pull) > -estimate%euler) then
         derived = periodic_from_samples(pull/estimate%euler)
         estimate%measured(rule_step) = .true.
         if (estimate%harmonic <= derived%highest()) &
            estimate%measures(rule_step) = step_error(estimate%harmonic, derived%amplitude(estimate%harmonic), &
                                                   1.0_wp + minval(pull)/estimate%euler, beam%damping, estimate%held_ratio)
      end if
      if (clearance > 0.0_wp) call find_impact(given, dimensions, model, beam, speed, estimate)
   end subroutine find_estimate

   !> Impact across the clearance of a pin of the link, once a turn, if contact is lost at the worst place: the members of the pin,
   !> set free, accelerate against each other by what its force would have prevented. Nothing is measured where the pins are no
   !> hinges of two links, or the rest of the linkage has more than the freedoms of a pin.
   subroutine find_impact(given, dimensions, model, beam, speed, e)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model   !! without the mass of the link
      type(beam_t), intent(in) :: beam
      real(wp), intent(in) :: speed              !! rad/s
      type(estimate_t), intent(inout) :: e
      type(force_model_t) :: with_link
      type(joint_load_t) :: load
      integer :: n, j

      with_link = model
      call add_uniform_link(given%mechanism, dimensions, beam, 0, with_link)
      associate (mechanism => given%mechanism)
         n = mechanism%seq(beam%link%loop, beam%link%arc)
         do j = 1, size(mechanism%joints)
            associate (joint => mechanism%joints(j))
               if (joint%kind /= joint_revolute .or. all(joint%bodies /= mechanism%arcs(n)%body) .or. &
                   all(mechanism%arcs(n)%ends /= joint%point)) cycle
            end associate
            call find_joint_load(given, dimensions, with_link, j, size(e%cycle%own), e%cycle%crank, load)
            if (load%failure > 0 .or. load%loose > 0) cycle
            if (any(load%tensor(1, :)*load%tensor(3, :) <= load%tensor(2, :)**2)) cycle
            e%jerk = max(e%jerk, jerk_of(load, speed))
         end do
      end associate
      if (.not. e%jerk > 0.0_wp) return
      e%impact_time = impact_time(e%clearance, e%jerk)
      e%impact_speed = impact_speed(e%clearance, e%jerk)
      e%impact_level = impact_level(e%impact_speed, speed)
      e%measured(rule_impact) = .true.
      e%measures(rule_impact) = impact_error(e%impact_speed, speed, beam%damping, e%held_ratio)/e%deflection
   end subroutine find_impact

   !> Greatest rate of M**-1 R, m/s3.
   real(wp) function jerk_of(load, speed) result(jerk)
      type(joint_load_t), intent(in) :: load
      real(wp), intent(in) :: speed              !! rad/s
      type(periodic_t) :: part
      real(wp) :: force(2, size(load%inertia, 2)), free(size(load%inertia, 2), 2)

      force = speed**2*load%inertia + load%fixed
      associate (m => load%tensor)
         free(:, 1) = (m(3, :)*force(1, :) - m(2, :)*force(2, :))/(m(1, :)*m(3, :) - m(2, :)**2)
         free(:, 2) = (m(1, :)*force(2, :) - m(2, :)*force(1, :))/(m(1, :)*m(3, :) - m(2, :)**2)
      end associate
      part = periodic_from_samples(free(:, 1))
      part = part%derivative(1)
      free(:, 1) = part%values(size(free, 1))
      part = periodic_from_samples(free(:, 2))
      part = part%derivative(1)
      free(:, 2) = part%values(size(free, 1))
      jerk = speed*sqrt(maxval(free(:, 1)**2 + free(:, 2)**2))
   end function jerk_of

   !> The link as a light spring between its pins, with the masses that it moves when its length changes and the crank is held:
   !> the least frequency of a turn over the speed. Nothing is measured where its finish is no pin of two links, or the rest of
   !> the linkage has more than this freedom.
   subroutine find_axial(given, dimensions, model, beam, speed, e)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model   !! without the mass of the link
      type(beam_t), intent(in) :: beam
      real(wp), intent(in) :: speed              !! rad/s
      type(estimate_t), intent(inout) :: e
      type(joint_load_t) :: load
      real(wp), allocatable :: mass(:)
      integer :: n, j, pin

      pin = 0
      associate (mechanism => given%mechanism)
         n = mechanism%seq(beam%link%loop, beam%link%arc)
         do j = 1, size(mechanism%joints)
            associate (joint => mechanism%joints(j))
               if (joint%kind /= joint_revolute .or. joint%point /= mechanism%arcs(n)%ends(at_finish)) cycle
               if (pin > 0) return
               pin = j
               if (all(joint%bodies /= mechanism%arcs(n)%body)) return
            end associate
         end do
      end associate
      if (pin == 0) return
      call find_joint_load(given, dimensions, model, pin, size(e%cycle%own), e%cycle%crank, load)
      if (load%failure > 0 .or. load%loose > 0) return
      associate (u => e%cycle%direction, m => load%tensor)
         mass = u(1, :)**2*m(1, :) + 2.0_wp*u(1, :)*u(2, :)*m(2, :) + u(2, :)**2*m(3, :)
      end associate
      if (.not. maxval(mass) > 0.0_wp) return
      e%measured(rule_axial) = .true.
      e%measures(rule_axial) = sqrt(beam%modulus*beam%area/(e%cycle%length*maxval(mass)))/speed
   end subroutine find_axial

   !> Quasi-static deflection and its dynamic error.
   subroutine deflect(link, damping, e)
      type(moving_link_t), intent(in) :: link
      real(wp), intent(in) :: damping
      type(estimate_t), intent(inout) :: e
      type(periodic_t) :: first
      real(wp) :: modes(size(e%cycle%own), modes_summed), error, hold
      integer :: n

      call bend(link, e, modes, hold)
      e%held_ratio = sqrt(max(hold, 0.0_wp))
      e%harmonic = max(1, nint(e%held_ratio))
      if (e%buckles) return
      e%first = maxval(abs(modes(:, 1)))
      e%second = maxval(abs(modes(:, 2)))
      call find_greatest(modes, e%deflection, e%at)
      first = periodic_from_samples(modes(:, 1))
      do n = 1, first%highest()
         error = first%amplitude(n)*dynamic_error(n, 1, e%held_ratio, max(damping, epsilon(1.0_wp)), .false.)
         if (n == e%harmonic) then
            error = error*e%magnifier
            e%resonant = error
         end if
         e%error = e%error + error
      end do
   end subroutine deflect

   !> What weight, loads and springs bend when the machine stands still, in the worst of the positions.
   subroutine rest(speed, e)
      real(wp), intent(in) :: speed              !! rad/s
      type(estimate_t), intent(inout) :: e
      type(link_cycle_t) :: still
      real(wp) :: modes(size(e%cycle%own), modes_summed), at, hold

      still = e%cycle
      still%own = 0.0_wp
      still%others = 0.0_wp
      still%viscous = 0.0_wp
      still%along = 0.0_wp
      still%across = 0.0_wp
      still%turning = 0.0_wp
      still%speed = 0.0_wp
      call bend(moving_link(still, speed, 1.0_wp), e, modes, hold)
      if (.not. e%buckles) call find_greatest(modes, e%resting, at)
   end subroutine rest

   !> Static deflection of all modes together at every position. `e%buckles` is set where a position is not stable.
   subroutine bend(link, e, modes, hold)
      type(moving_link_t), intent(in) :: link
      type(estimate_t), intent(inout) :: e
      real(wp), intent(out) :: modes(:, :)       !! shape (positions, modes), m
      real(wp), intent(out) :: hold              !! mean stiffness of mode 1, as a squared ratio of frequency to speed
      type(periodic_t) :: of
      real(wp), allocatable :: stiffness(:, :, :) !! shape (modes, modes, positions), upper triangle
      real(wp) :: force(size(modes, 2), size(modes, 1))
      integer :: i, j, points
      logical :: stands

      points = size(modes, 1)
      allocate (stiffness(size(modes, 2), size(modes, 2), points), source=0.0_wp)
      do j = 1, size(modes, 2)
         do i = 1, j
            of = coupling(link, i, j)
            stiffness(i, j, :) = of%values(points)
         end do
         stiffness(j, j, :) = stiffness(j, j, :) + real(j, wp)**4*e%ratio**2
         of = mode_force(link, j)
         force(j, :) = e%cycle%length*of%values(points)
      end do
      hold = sum(stiffness(1, 1, :))/real(points, wp)
      do i = 1, points
         call solve_positive(stiffness(:, :, i), force(:, i), modes(i, :), stands)
         if (.not. stands) e%buckles = .true.
      end do
   end subroutine bend

   !> Greatest amount of a deflection over link and turn, by the parabola through a sample and its neighbours.
   pure subroutine find_greatest(modes, greatest, at)
      real(wp), intent(in) :: modes(:, :)        !! shape (positions, modes)
      real(wp), intent(out) :: greatest          !! m
      real(wp), intent(out) :: at                !! from the start, part of the length
      real(wp) :: shapes(size(modes, 2), 0:samples), bent(0:samples), left, right, cosine
      integer :: i, j, s

      do s = 0, samples
         do j = 1, size(modes, 2)
            call unit_vector(half_turn*real(j*s, wp)/real(samples, wp), cosine, shapes(j, s))
         end do
      end do
      greatest = 0.0_wp
      at = 0.5_wp
      do i = 1, size(modes, 1)
         do s = 0, samples
            bent(s) = abs(dot_product(modes(i, :), shapes(:, s)))
         end do
         s = maxloc(bent, 1) - 1
         if (bent(s) <= greatest) cycle
         greatest = bent(s)
         at = real(s, wp)/real(samples, wp)
         if (s == 0 .or. s == samples) cycle
         left = bent(s) - bent(s - 1)
         right = bent(s) - bent(s + 1)
         greatest = bent(s) + (left - right)**2/(8.0_wp*(left + right))
         at = at + 0.5_wp*(left - right)/(left + right)/real(samples, wp)
      end do
   end subroutine find_greatest

   !> Haines's rules for all links, after the frequencies of those that share a pin are compared. A link that buckles, or bends
   !> further than his typical links, is to be designed again.
   pure subroutine assess_estimates(mechanism, beams, estimates)
      type(mechanism_t), intent(in) :: mechanism
      type(beam_t), intent(in) :: beams(:)
      type(estimate_t), intent(inout) :: estimates(:) !! in the order of `beams`
      real(wp) :: apart
      integer :: bodies(size(beams)), j, k, n

      bodies = [(mechanism%arcs(mechanism%seq(beams(k)%link%loop, beams(k)%link%arc))%body, k=1, size(beams))]
      do k = 1, size(beams)
         associate (e => estimates(k))
            if (e%cycle%failure > 0) cycle
            do n = 1, size(beams)
               if (bodies(n) == bodies(k)) cycle
               if (.not. any([(any(mechanism%joints(j)%bodies == bodies(k)) .and. any(mechanism%joints(j)%bodies == bodies(n)), &
                               j=1, size(mechanism%joints))])) cycle
               apart = abs(e%ratio - estimates(n)%ratio)
               if (e%measured(rule_apart)) apart = min(apart, e%measures(rule_apart))
               e%measured(rule_apart) = .true.
               e%measures(rule_apart) = apart
            end do
            e%measured(rule_frequency) = .true.
            e%measures(rule_frequency) = e%ratio
            e%measured(rule_load) = .true.
            e%measures(rule_load) = max(e%push, 0.0_wp)/e%euler
            e%measured([rule_error, rule_deflection]) = .not. e%buckles
            if (e%deflection > 0.0_wp) e%measures(rule_error) = e%error/e%deflection
            e%measures(rule_deflection) = (e%deflection + e%error)/e%cycle%length
            e%kept = merge(e%measures >= rules%limit, e%measures <= rules%limit, rules%at_least) .or. .not. e%measured
            if (e%buckles .or. .not. e%kept(rule_deflection)) then
               e%verdict = verdict_redesign
            else if (.not. all(e%kept)) then
               e%verdict = verdict_closer
            end if
         end associate
      end do
   end subroutine assess_estimates
end module psalm_estimate_study
