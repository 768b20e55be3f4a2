!> The forced Hill equation, boundaries of stability, vibrating links, flexible drives, estimates: laws, and figures computed
!> independently of this code (theory after Haines and Oldham; four-bar 1:5:2:5 of Oldham's chapter 14).
program test_vibration
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_positive_inf
   use check, only: checks_t
   use psalm_flexible_drive, only: drive_coefficients, drive_response, mean_ratio, ratio_for_mean
   use psalm_floquet, only: coupled_multipliers
   use psalm_harmonic_bounds, only: extent_t, extent_of, harmonic_bound
   use psalm_hill, only: hill_t, solve_hill, greatest_of
   use psalm_kinds, only: wp, pi
   use psalm_lapack, only: general_eigenvalues
   use psalm_link_vibration, only: moving_link_t, mode_stiffness, coupling, mode_force, timoshenko_factor
   use psalm_periodic, only: periodic_t, periodic_from_samples, periodic_constant
   use psalm_stability, only: boundaries_t, stability_boundaries, series_boundaries
   use psalm_vibration_estimates, only: impulse_magnifier, straightening, foreshortening_sine, frequency_fall, tie_rod_ratio, &
                                        repeated_magnifier, step_error, impact_speed, impact_time, &
                                        post_support_of_slenderness, dynamic_error, strength_ratio, magnification
   implicit none (type, external)
   real(wp), parameter :: crank = 1.0_wp, coupler = 5.0_wp, rocker = 2.0_wp, frame = 5.0_wp !! of Oldham's rig
   ! what acts on a link of length 1 in `acting_on_link`
   real(wp), parameter :: force(2) = [0.7_wp, -0.4_wp], moment = 0.3_wp, fixed(2) = [0.9_wp, -0.6_wp]
   real(wp), parameter :: place = 0.37_wp, height = 0.21_wp, spring = 1.3_wp, free = 0.5_wp, torsion = 0.8_wp
   type(checks_t) :: t
   type(periodic_t) :: no_damping

   no_damping = periodic_constant(0.0_wp)
   call series()
   call constant_coefficients()
   call damped_determinant()
   call drives()
   call boundaries()
   call table_of_the_rig()
   call floquet()
   call response()
   call coupled_modes()
   call acting_on_link()
   call greatest()
   call bounds()
   call estimates()
   call impulses()
   call end_loads()
   call coefficients_of_the_rig()
   call mathieu()
   call series_errors()
   call narrow_and_wide()
   call speeds_of_the_rig()
   call t%report()

contains

   !> mean + sum cosines(n) cos(n x) + sines(n) sin(n x)
   pure function periodic_from_harmonics(mean, cosines, sines) result(f)
      real(wp), intent(in) :: mean
      real(wp), intent(in) :: cosines(:), sines(:) !! shape (m)
      type(periodic_t) :: f
      real(wp) :: samples(2*size(cosines) + 1), x
      integer :: i, n

      do i = 1, size(samples)
         x = 2.0_wp*pi*real(i - 1, wp)/real(size(samples), wp)
         samples(i) = mean + sum([(cosines(n)*cos(real(n, wp)*x) + sines(n)*sin(real(n, wp)*x), n=1, size(cosines))])
      end do
      f = periodic_from_samples(samples)
   end function periodic_from_harmonics

   subroutine series()
      type(periodic_t) :: f, d
      real(wp) :: x(15), want(15)
      integer :: i, n
      integer, parameter :: counts(4) = [15, 14, 13, 12]

      do i = 1, size(counts)
         n = counts(i)
         x(:n) = [(2.0_wp*pi*real(n - 1, wp)/real(counts(i), wp), n=1, counts(i))]
         n = counts(i)
         want(:n) = 1.0_wp + cos(x(:n) - 0.3_wp) + 0.25_wp*sin(4.0_wp*x(:n))
         f = periodic_from_samples(want(:n))
         call t%close_to(maxval(abs(f%values(n) - want(:n))), 0.0_wp, 1.0e-14_wp, 'a series gives its samples back')
         call t%close_to(f%amplitude(1), 1.0_wp, 1.0e-14_wp, 'amplitude of a shifted cosine')
         call t%close_to(f%amplitude(4), 0.25_wp, 1.0e-14_wp, 'amplitude of the fourth harmonic')
         call t%equal_integer(f%highest(1.0e-12_wp), 4, 'highest harmonic')
         d = f%derivative(2)
         call t%close_to(d%at(0.7_wp), -cos(0.4_wp) - 4.0_wp*sin(2.8_wp), 1.0e-12_wp, 'second derivative')
         want(:3) = f%values(3, 0.5_wp)
         call t%close_to(want(2), f%at(pi), 1.0e-14_wp, 'values at shifted places')
      end do
   end subroutine series

   !> y'' + 2 c W y' + W**2 y = W**2 cos(j x): the response is known.
   subroutine constant_coefficients()
      type(hill_t) :: hill
      type(periodic_t) :: y
      real(wp) :: r, cosines(5)
      real(wp), parameter :: w = 10.0_wp, c = 0.01_wp
      integer :: j

      do j = 1, 5
         cosines = 0.0_wp
         cosines(j) = w**2
         hill = solve_hill(periodic_constant(2.0_wp*c*w), periodic_constant(w**2), &
                           periodic_from_harmonics(0.0_wp, cosines(:j), 0.0_wp*cosines(:j)), 1.0e-12_wp)
         y = periodic_from_samples(hill%y)
         r = real(j, wp)/w
         call t%close_to(y%amplitude(j), 1.0_wp/hypot(1.0_wp - r*r, 2.0_wp*c*r), 1.0e-11_wp, 'magnifier of a constant coefficient')
         call t%is_true(hill%stable .and. hill%unique .and. hill%converged, 'a damped system settles')
      end do
      hill = solve_hill(no_damping, periodic_constant(w**2), periodic_from_harmonics(0.0_wp, [1.0_wp], [0.0_wp]), 1.0e-12_wp)
      call t%is_true(.not. hill%unique .and. hill%neutral .and. .not. hill%stable, &
                     'undamped with a whole ratio: no unique periodic solution')
      call t%is_true(.not. allocated(hill%y), 'no response where there is none')
      hill = solve_hill(no_damping, periodic_constant(w**2 + 0.5_wp), periodic_from_harmonics(0.0_wp, [1.0_wp], &
            [0.0_wp]), 1.0e-12_wp)
      call t%is_true(hill%unique .and. hill%neutral, 'undamped beside it: a unique one, that does not settle')
      call t%close_to(hill%y(1), 1.0_wp/(w**2 - 0.5_wp), 1.0e-12_wp, 'and its size')
      hill = solve_hill(no_damping, periodic_constant(-4.0_wp), periodic_constant(1.0_wp), 1.0e-12_wp)
      call t%close_to(real(hill%multipliers(1), wp), exp(4.0_wp*pi), 1.0e-11_wp, 'growth of a buckled link')
      call t%close_to(real(hill%multipliers(2), wp)*exp(4.0_wp*pi), 1.0_wp, 1.0e-11_wp, 'the small multiplier keeps its digits')
      call t%is_true(.not. hill%stable .and. hill%unique, 'buckled is unstable')
      call t%close_to(maxval(abs(hill%y + 0.25_wp)), 0.0_wp, 1.0e-9_wp, 'the periodic solution of a buckled link is constant')
   end subroutine constant_coefficients

   !> The determinant of a period is exp(-integral c1); the solution closes and obeys superposition.
   subroutine damped_determinant()
      type(hill_t) :: one, two, both
      type(periodic_t) :: c1, c0, p, q

      c1 = periodic_from_harmonics(0.05_wp, [0.02_wp, 0.01_wp], [0.01_wp, 0.0_wp])
      c0 = periodic_from_harmonics(9.3_wp, [2.0_wp, 0.3_wp], [1.0_wp, 0.2_wp])
      p = periodic_from_harmonics(1.0_wp, [0.5_wp], [0.2_wp])
      q = periodic_from_harmonics(0.0_wp, [0.0_wp, 0.5_wp], [0.1_wp, 0.2_wp])
      one = solve_hill(c1, c0, p, 1.0e-12_wp)
      two = solve_hill(c1, c0, q, 1.0e-12_wp)
      both = solve_hill(c1, c0, p%plus(q), 1.0e-12_wp)
      call t%close_to(one%determinant_error, 0.0_wp, 1.0e-12_wp, 'determinant of a period')
      call t%close_to(maxval(abs(one%start + two%start - both%start)), 0.0_wp, 1.0e-12_wp, 'superposition of the forces')
      call t%close_to(one%start(1), one%transfer(1, 1)*one%start(1) + one%transfer(1, 2)*one%start(2) + one%forced(1), &
                      1.0e-12_wp, 'the periodic solution closes')
   end subroutine damped_determinant

   !> J = 1 + f sin x: figures of Haines's table 38b and their neighbours, computed independently.
   subroutine drives()
      type(hill_t) :: hill
      type(periodic_t) :: inertia, y2, c1, c0, p
      real(wp) :: d, ratio
      integer :: i
      logical :: ok
      integer, parameter :: n(6) = [1, 4, 5, 6, 7, 10]
      real(wp), parameter :: want(6) = [0.018964_wp, 0.012985_wp, 0.005232_wp, 0.022989_wp, 0.027995_wp, 0.010714_wp]
      integer, parameter :: m(3) = [5, 6, 10]
      real(wp), parameter :: plain(3) = [0.567839_wp, 0.015156_wp, 0.000172_wp]

      inertia = periodic_from_harmonics(3.0_wp, [0.0_wp], [2.1_wp])
      hill = drive_response(inertia, 4.41665_wp, 0.02_wp, 1.0e-12_wp)
      call t%close_to(hill%transfer(1, 1), 0.67736022_wp, 1.0e-6_wp, 'drive: period, 1 1')
      call t%close_to(hill%transfer(1, 2), -0.00257828_wp, 1.0e-6_wp, 'drive: period, 1 2')
      call t%close_to(hill%transfer(2, 1), 0.05049258_wp, 1.0e-6_wp, 'drive: period, 2 1')
      call t%close_to(hill%transfer(2, 2), 0.67847730_wp, 1.0e-6_wp, 'drive: period, 2 2')
      call t%close_to(hill%forced(1), -0.00637739_wp, 1.0e-6_wp, 'drive: forced from rest')
      call t%close_to(hill%forced(2), 0.00096822_wp, 1.0e-6_wp, 'drive: forced from rest, rate')
      call t%close_to(hill%start(1), -0.01976554_wp, 1.0e-6_wp, 'drive: start of the steady state')
      call t%close_to(hill%start(2), -0.00009266_wp, 1.0e-6_wp, 'drive: its rate')
      call t%close_to(abs(hill%multipliers(1)), 0.6780145_wp, 1.0e-6_wp, 'drive: multiplier')
      call t%close_to(exp(-2.0_wp*pi*0.02_wp*4.41665_wp/sqrt(1.0_wp - 0.49_wp)), abs(hill%multipliers(1)*hill%multipliers(2)), &
                      1.0e-12_wp, 'drive: determinant in closed form')
      y2 = periodic_from_samples(hill%y2)
      do i = 1, size(n)
         call t%close_to(y2%amplitude(n(i)), want(i), 1.0e-6_wp, 'drive: harmonic of the acceleration')
      end do
      call drive_coefficients(inertia, 5.0_wp, 0.02_wp, c1, c0, p)
      hill = solve_hill(periodic_constant(0.1_wp), periodic_constant(25.0_wp), p, 1.0e-12_wp)
      y2 = periodic_from_samples(hill%y2)
      do i = 1, size(m)
         call t%close_to(y2%amplitude(m(i)), plain(i), 1.0e-6_wp, 'drive: the same with a constant frequency')
      end do
      hill = drive_response(inertia, 0.86_wp, 0.0_wp, 1.0e-12_wp)
      call t%close_to(real(hill%multipliers(1), wp), 1.149572_wp, 1.0e-6_wp, 'drive: unstable, growing')
      call t%close_to(real(hill%multipliers(2), wp), 0.869889_wp, 1.0e-6_wp, 'drive: unstable, dying')
      call t%is_true(.not. hill%stable .and. allocated(hill%y), 'an unstable drive has its periodic solution, and the flag')
      hill = drive_response(inertia, 0.86_wp, 0.02_wp, 1.0e-12_wp)
      call t%close_to(real(hill%multipliers(1), wp), 1.065893_wp, 1.0e-6_wp, 'drive: damped and unstable still')
      call ratio_for_mean(inertia, 5.0_wp, d, ok, passes=1)
      call t%close_to(d, 4.41843_wp, 1.0e-5_wp, 'drive: D for a mean ratio, one pass')
      call ratio_for_mean(inertia, 5.0_wp, d, ok)
      call t%close_to(d, 4.41665_wp, 1.0e-5_wp, 'drive: D for a mean ratio')
      call mean_ratio(inertia, d, ratio, ok)
      call t%close_to(ratio, 5.0_wp, 1.0e-12_wp, 'drive: and that ratio comes back')
      call ratio_for_mean(inertia, 2.0_wp, d, ok)
      call t%close_to(d, 1.75055_wp, 1.0e-5_wp, 'drive: D for a mean ratio of 2')
      call mean_ratio(inertia, 0.1_wp, ratio, ok)
      call t%is_true(.not. ok, 'drive: no mean ratio where its root is not real')
      inertia = periodic_from_harmonics(1.0_wp, [0.0_wp], [0.4_wp])
      call ratio_for_mean(inertia, 5.0_wp, d, ok, passes=1)
      call t%close_to(d, 4.83847_wp, 1.0e-5_wp, 'drive: f = 0.4, one pass')
      call ratio_for_mean(inertia, 5.0_wp, d, ok)
      call t%close_to(d, 4.83834_wp, 1.0e-5_wp, 'drive: f = 0.4')
      hill = drive_response(inertia, 0.46_wp, 0.02_wp, 1.0e-12_wp)
      call t%close_to(real(hill%multipliers(1), wp), -1.3455280_wp, 1.0e-6_wp, 'drive: period doubling')
      call t%close_to(real(hill%multipliers(2), wp), -0.6977759_wp, 1.0e-6_wp, 'drive: period doubling, the other')
   end subroutine drives

   !> Coupler of the rig with an end inertia of e: f = e g + h.
   function rig(e) result(link)
      real(wp), intent(in) :: e
      type(moving_link_t) :: link
      integer, parameter :: n = 256
      real(wp), dimension(n) :: tension, along, across, turning, squared
      real(wp) :: phi, diagonal, th2, th3, w2, w3, a2, a3, between
      integer :: i

      do i = 1, n
         phi = 2.0_wp*pi*real(i - 1, wp)/real(n, wp)
         diagonal = hypot(frame - crank*cos(phi), crank*sin(phi))
         th2 = atan2(-crank*sin(phi), frame - crank*cos(phi)) &
               + acos((coupler**2 + diagonal**2 - rocker**2)/(2.0_wp*coupler*diagonal))
         th3 = atan2(crank*sin(phi) + coupler*sin(th2), crank*cos(phi) + coupler*cos(th2) - frame)
         between = th3 - th2
         w2 = -crank*sin(phi - th3)/(coupler*sin(th2 - th3))
         w3 = crank*sin(phi - th2)/(rocker*sin(th3 - th2))
         a2 = (-crank*cos(phi - th3) - coupler*w2**2*cos(th2 - th3) + rocker*w3**2)/(coupler*sin(th2 - th3))
         a3 = (crank*cos(phi - th2) + coupler*w2**2 - rocker*w3**2*cos(th3 - th2))/(rocker*sin(th3 - th2))
         along(i) = -crank*cos(phi - th2)/coupler
         across(i) = -crank*sin(phi - th2)/coupler
         turning(i) = a2
         squared(i) = w2**2
         ! at the finish: across from the link's own moments about its start, along from the rocker's moments
         tension(i) = end_pull(e, between, across(i), a2, a3)
      end do
      link = moving_link_t(periodic_from_samples(tension), periodic_from_samples(along), periodic_from_samples(across), &
                           periodic_from_samples(turning), periodic_from_samples(squared))
   end function rig

   !> Force on the coupler's finish along it, of unit mass, length and speed. About its start: across + turning/3 acts at the
   !> end across the link (S); the rocker's inertia e m2 l2 l3: e a3 = -(S cos + pull*...) turned by the angle between.
   pure real(wp) function end_pull(e, between, across, turning, a3)
      real(wp), intent(in) :: e, between, across, turning, a3
      real(wp) :: shear

      shear = 0.5_wp*across + turning/3.0_wp
      ! moment of -(pull, shear) on the rocker about its pivot, over its length: pull*sin(between) - shear*cos(between) = e a3
      end_pull = (e*a3 + shear*cos(between))/sin(between)
   end function end_pull

   subroutine boundaries()
      type(moving_link_t) :: link
      type(periodic_t) :: f
      type(boundaries_t) :: b
      real(wp) :: got(2)
      integer :: i
      integer, parameter :: p(8) = [3, 4, 3, 4, 8, 5, 6, 12]
      real(wp), parameter :: e(8) = [0.5_wp, 1.0_wp, 1.43_wp, 1.43_wp, 1.43_wp, 2.14_wp, 4.0_wp, 4.0_wp]
      real(wp), parameter :: exact(2, 8) = reshape([1.577985_wp, 1.790064_wp, 2.158611_wp, 2.334173_wp, 1.197983_wp, 2.157100_wp, &
         2.184880_wp, 2.536476_wp, 4.032150_wp, 4.034855_wp, 2.788220_wp, 3.076894_wp, 3.427178_wp, 3.882587_wp, 6.071699_wp, &
         6.072352_wp], [2, 8])
      real(wp), parameter :: first(2, 8) = reshape([1.277369_wp, 1.582795_wp, 1.840775_wp, 1.979160_wp, 0.825435_wp, 1.684991_wp, &
         1.773594_wp, 1.968477_wp, 3.937292_wp, 3.939323_wp, 2.297643_wp, 2.402251_wp, 2.739676_wp, 2.794889_wp, 5.887128_wp, &
         5.887186_wp], [2, 8])
      real(wp), parameter :: second(2, 8) = reshape([1.534160_wp, 2.053997_wp, 1.973790_wp, 2.754167_wp, 1.432952_wp, &
            3.887215_wp, &
         1.952728_wp, 3.315359_wp, 4.040082_wp, 4.057566_wp, 2.779510_wp, 3.636295_wp, 3.826922_wp, 4.734531_wp, 6.103495_wp, &
         6.104813_wp], [2, 8])

      link = rig(1.0_wp)
      f = mode_stiffness(link, 1)
      call t%close_to(f%at(pi/3.0_wp), 3.3769118207_wp + 0.5613726489_wp, 1.0e-9_wp, 'rig: stiffness of mode 1 at 60 degrees')
      f = mode_force(link, 1)
      call t%close_to(coupler*f%at(pi/3.0_wp), 0.4959376181_wp, 1.0e-9_wp, 'rig: force of mode 1 at 60 degrees')
      f = mode_force(link, 2)
      call t%close_to(coupler*f%at(pi/3.0_wp), 0.2200069922_wp, 1.0e-9_wp, 'rig: force of mode 2 at 60 degrees')
      do i = 1, size(p)
         link = rig(e(i))
         f = mode_stiffness(link, 1)
         b = stability_boundaries(f, 16)
         call t%is_true(b%converged, 'boundaries converge')
         got = speed_ratio([b%low(p(i)), b%high(p(i))])
         call t%close_to(maxval(abs(got - exact(:, i))), 0.0_wp, 1.0e-6_wp, 'boundaries of the rig')
         got = speed_ratio(series_boundaries(f, p(i), 1))
         call t%close_to(maxval(abs(got - first(:, i))), 0.0_wp, 1.0e-6_wp, 'boundaries by (13.27)')
         got = speed_ratio(series_boundaries(f, p(i), 2))
         call t%close_to(maxval(abs(got - second(:, i))), 0.0_wp, 1.0e-6_wp, 'boundaries by (13.28)')
         call on_the_boundary(f, b%low(p(i)), p(i))
         call on_the_boundary(f, b%high(p(i)), p(i))
      end do
      b = stability_boundaries(periodic_constant(0.25_wp), 4)
      call t%close_to(maxval(abs(b%low - [-0.25_wp, 0.0_wp, 0.75_wp, 2.0_wp, 3.75_wp])), 0.0_wp, 1.0e-12_wp, &
                      'boundaries of a constant: p**2/4 less it')
   end subroutine boundaries

   elemental real(wp) function speed_ratio(w)
      real(wp), intent(in) :: w

      speed_ratio = sign(sqrt(abs(w)), w)
   end function speed_ratio

   !> The trace of a period is 2 (p even) or -2 (p odd).
   subroutine on_the_boundary(f, w, p)
      type(periodic_t), intent(in) :: f
      real(wp), intent(in) :: w
      integer, intent(in) :: p
      type(hill_t) :: hill

      hill = solve_hill(no_damping, f%plus(periodic_constant(w)), periodic_constant(0.0_wp), 1.0e-13_wp)
      call t%close_to(hill%transfer(1, 1) + hill%transfer(2, 2), 2.0_wp*(-1.0_wp)**p, &
                      1.0e-8_wp*max(1.0_wp, maxval(abs(hill%transfer))), 'trace of a period on a boundary')
   end subroutine on_the_boundary

   !> Oldham's table 14.2: speeds of large response lie near a boundary; all nine.
   subroutine table_of_the_rig()
      real(wp), parameter :: e(9) = [1.43_wp, 1.43_wp, 1.43_wp, 1.43_wp, 1.43_wp, 1.43_wp, 2.14_wp, 2.14_wp, 2.14_wp]
      real(wp), parameter :: ratio(9) = [7.96_wp, 5.42_wp, 5.08_wp, 4.42_wp, 3.98_wp, 3.62_wp, 5.3_wp, 4.54_wp, 3.98_wp]
      real(wp), parameter :: far(9) = [0.022_wp, 0.074_wp, 0.079_wp, 0.093_wp, 0.052_wp, 0.047_wp, 0.211_wp, 0.014_wp, 0.112_wp]
      integer, parameter :: nearest(9) = [16, 11, 10, 9, 8, 7, 11, 9, 8]
      type(boundaries_t) :: b
      real(wp) :: distance(0:20)
      integer :: i

      do i = 1, size(e)
         b = stability_boundaries(mode_stiffness(rig(e(i)), 1), 20)
         distance = min(abs(speed_ratio(b%low) - ratio(i)), abs(speed_ratio(b%high) - ratio(i)))
         call t%equal_integer(minloc(distance, 1) - 1, nearest(i), 'table 14.2: the nearest boundary')
         call t%close_to(minval(distance), far(i), 6.0e-4_wp, 'table 14.2: its distance')
      end do
   end subroutine table_of_the_rig

   subroutine floquet()
      call multipliers(1.43_wp, 1.90_wp, 0.0_wp, (-93.477457_wp, 0.0_wp), (-0.010698_wp, 0.0_wp))
      call multipliers(1.43_wp, 1.90_wp, 0.015_wp, (-78.248962_wp, 0.0_wp), (-0.0089327_wp, 0.0_wp))
      call multipliers(1.43_wp, 2.62_wp, 0.0_wp, (-0.4595887_wp, 0.8881319_wp), (-0.4595887_wp, -0.8881319_wp))
      call multipliers(1.43_wp, 2.62_wp, 0.015_wp, (-0.3559717_wp, 0.6953786_wp), (-0.3559717_wp, -0.6953786_wp))
      call multipliers(2.14_wp, 3.0_wp, 0.0_wp, (-4.7892127_wp, 0.0_wp), (-0.2088026_wp, 0.0_wp))
      call multipliers(2.14_wp, 3.0_wp, 0.015_wp, (-3.6191898_wp, 0.0_wp), (-0.1569643_wp, 0.0_wp))
      call multipliers(3.0_wp, 3.5_wp, 0.0_wp, (5.9430138_wp, 0.0_wp), (0.1682648_wp, 0.0_wp))
   end subroutine floquet

   subroutine multipliers(e, ratio, zeta, larger, smaller)
      real(wp), intent(in) :: e, ratio, zeta
      complex(wp), intent(in) :: larger, smaller
      type(hill_t) :: hill
      type(periodic_t) :: f, k(1, 1)
      complex(wp) :: mu(2)
      real(wp) :: error
      logical :: ok

      f = mode_stiffness(rig(e), 1)
      k(1, 1) = f%plus(periodic_constant(ratio**2))
      hill = solve_hill(periodic_constant(2.0_wp*zeta*ratio), k(1, 1), periodic_constant(0.0_wp), 1.0e-12_wp)
      call t%close_to(abs(hill%multipliers(1) - larger), 0.0_wp, 1.0e-6_wp, 'multiplier of the rig')
      call t%close_to(abs(hill%multipliers(2) - smaller), 0.0_wp, 1.0e-6_wp, 'multiplier of the rig, the other')
      call coupled_multipliers(k, [2.0_wp*zeta*ratio], 1.0e-10_wp, mu, error, ok)
      call t%is_true(ok, 'multipliers of one mode by the way of many converge')
      call t%close_to(min(abs(mu(1) - hill%multipliers(1)), abs(mu(1) - hill%multipliers(2)))/abs(mu(1)), 0.0_wp, 1.0e-8_wp, &
                      'multipliers of one mode by the way of many')
      call general_eigenvalues(reshape([ieee_value(1.0_wp, ieee_positive_inf), 0.0_wp, 0.0_wp, 1.0_wp], [2, 2]), mu, ok)
      call t%is_true(.not. ok, 'eigenvalues of what overflowed: told, the program goes on')
   end subroutine multipliers

   !> Steady response of mode 1, damping 0.015, in crank lengths: harmonics 0 to 4 and the peak.
   subroutine response()
      real(wp), parameter :: e(4) = [1.43_wp, 1.43_wp, 2.14_wp, 2.14_wp], ratio(4) = [7.96_wp, 5.42_wp, 4.54_wp, 3.98_wp]
      real(wp), parameter :: want(6, 4) = reshape([0.00066304_wp, 0.00989766_wp, 0.00587075_wp, 0.00124876_wp, 0.00069942_wp, &
         0.01570017_wp, 0.00185077_wp, 0.02195717_wp, 0.01295317_wp, 0.00144098_wp, 0.00219761_wp, 0.03316020_wp, &
         0.00298214_wp, 0.03452901_wp, 0.02203020_wp, 0.00569794_wp, 0.00261001_wp, 0.05902324_wp, &
         0.00458197_wp, 0.05038680_wp, 0.01958674_wp, 0.03753181_wp, 0.02907862_wp, 0.12099531_wp], [6, 4])
      type(moving_link_t) :: link
      type(hill_t) :: hill
      type(periodic_t) :: f, p, q
      integer :: i, n

      do i = 1, size(e)
         link = rig(e(i))
         f = mode_stiffness(link, 1)
         p = mode_force(link, 1)
         hill = solve_hill(periodic_constant(0.03_wp*ratio(i)), f%plus(periodic_constant(ratio(i)**2)), &
               p%scaled(coupler), 1.0e-12_wp)
         q = periodic_from_samples(hill%y)
         do n = 0, 4
            call t%close_to(q%amplitude(n), want(n + 1, i), 1.0e-7_wp, 'response of the rig: harmonic')
         end do
         call t%close_to(maxval(abs(hill%y)), want(6, i), 1.2e-5_wp, 'response of the rig: peak')
         if (i == 2) then
            call t%close_to(hill%y(1), -0.0201364776_wp, 1.0e-9_wp, 'response of the rig at 0')
            call t%close_to(hill%y1(1), 0.0138438405_wp, 1.0e-9_wp, 'response of the rig at 0, slope')
         end if
      end do
   end subroutine response

   !> Four modes coupled: the boundary at 2.536476 moves to 2.537462.
   subroutine coupled_modes()
      type(moving_link_t) :: link
      integer, parameter :: modes = 4
      type(periodic_t) :: k(modes, modes)
      complex(wp) :: mu(2*modes)
      real(wp) :: error
      integer :: i, j, side
      real(wp), parameter :: ratio(2) = [2.5372_wp, 2.5377_wp]
      logical :: ok

      link = rig(1.43_wp)
      do side = 1, 2
         do j = 1, modes
            do i = 1, modes
               k(i, j) = coupling(link, i, j)
            end do
            k(j, j) = k(j, j)%plus(periodic_constant(ratio(side)**2*real(j**4, wp)))
         end do
         call coupled_multipliers(k, [(0.0_wp, i=1, modes)], 1.0e-9_wp, mu, error, ok)
         call t%is_true(ok, 'multipliers of four modes converge')
         call t%close_to(abs(product(mu)), 1.0_wp, 1.0e-7_wp, 'their product is 1 without damping')
         call t%is_true((abs(mu(1)) > 1.001_wp) .eqv. (side == 1), 'the boundary of four coupled modes lies between')
      end do
   end subroutine coupled_modes

   subroutine bounds()
      integer, parameter :: n = 4096
      real(wp) :: samples(n)
      type(extent_t) :: extents(0:1), square(0:0)
      type(periodic_t) :: f, d
      integer :: i, j
      real(wp) :: phi

      samples = [(merge(1.0_wp, -1.0_wp, i <= n/2), i=1, n)]
      square(0) = extent_of(samples)
      f = periodic_from_samples(samples)
      do j = 1, 15, 2
         call t%close_to(harmonic_bound(j, square), 4.0_wp/(pi*real(j, wp)), 1.0e-12_wp, 'square wave: the bound is attained')
         phi = pi*real(j, wp)/real(n, wp) ! samples overshoot by x/sin x
         call t%close_to(f%amplitude(j), harmonic_bound(j, square)*phi/sin(phi), 1.0e-12_wp, &
                         'square wave: the harmonic is within it')
      end do
      square(0) = extent_of(0.0_wp*samples + 3.0_wp)
      call t%close_to(harmonic_bound(1, square), 0.0_wp, 0.0_wp, 'a constant has no harmonics')
      ! angular acceleration of the rocker, four-bar 1:2:2:2
      do i = 1, n
         phi = 2.0_wp*pi*real(i - 1, wp)/real(n, wp)
         samples(i) = rocker_angle(phi)
      end do
      f = periodic_from_samples(samples)
      d = f%derivative(2)
      extents(0) = extent_of(d%values(n))
      call t%close_to(d%amplitude(5), 0.15742_wp, 2.0e-4_wp, 'bounds: the fifth harmonic')
      d = d%derivative(1)
      extents(1) = extent_of(d%values(n))
      call t%close_to(extents(0)%range, 2.7356_wp, 2.0e-4_wp, 'bounds: range of the acceleration')
      call t%close_to(extents(0)%variation, 2.7537_wp, 2.0e-4_wp, 'bounds: variation of the acceleration')
      call t%close_to(extents(1)%range, 8.0165_wp, 2.0e-4_wp, 'bounds: range of its derivative')
      call t%close_to(extents(1)%variation, 9.1292_wp, 2.0e-4_wp, 'bounds: variation of its derivative')
      d = f%derivative(2)
      do j = 1, 40
         call t%is_true(d%amplitude(j) <= harmonic_bound(j, extents), 'a harmonic is below its bound')
      end do
   end subroutine bounds

   !> Angle of the rocker (length 2) from its pivot: direction to the crank pin less the angle at the pivot.
   pure real(wp) function rocker_angle(phi)
      real(wp), intent(in) :: phi
      real(wp) :: x, y

      x = cos(phi) - 2.0_wp
      y = sin(phi)
      rocker_angle = pi + atan2(-y, -x) - acos(0.25_wp*hypot(x, y))
   end function rocker_angle

   !> Forces and stiffnesses of the modes by a load and a spring on a bracket against differences of their energy, the link bent
   !> without stretching.
   subroutine acting_on_link()
      type(moving_link_t) :: link
      type(periodic_t) :: of
      real(wp), parameter :: step = 3.0e-4_wp
      real(wp) :: q(3), gap(2), length, pull, slope, bend
      integer :: i, j

      link = moving_link_t(no_damping%scaled(0.0_wp), no_damping, no_damping, no_damping, no_damping)
      gap = fixed - [place, height]
      length = norm2(gap)
      gap = gap/length
      pull = spring*(length - free)
      allocate (link%acting(1))
      associate (a => link%acting(1))
         a%place = place
         a%height = height
         a%along = periodic_constant(force(1) + pull*gap(1))
         a%across = periodic_constant(force(2) + pull*gap(2))
         a%moment = periodic_constant(moment)
         a%spring = [periodic_constant(pull/length + (spring - pull/length)*gap(1)**2), &
                     periodic_constant((spring - pull/length)*gap(1)*gap(2)), &
                     periodic_constant(pull/length + (spring - pull/length)*gap(2)**2)]
         a%torsion = torsion
      end associate
      do i = 1, 3
         q = 0.0_wp
         q(i) = step
         slope = (energy(q) - energy(-q))/(2.0_wp*step)
         of = mode_force(link, i)
         call t%close_to(of%mean(), -2.0_wp*slope, 3.0e-5_wp, 'force of a mode by what acts on the link')
         do j = 1, 3
            q = 0.0_wp
            q(i) = q(i) + step
            q(j) = q(j) + step
            bend = energy(q) + energy(-q)
            q = 0.0_wp
            q(i) = q(i) + step
            q(j) = q(j) - step
            bend = (bend - energy(q) - energy(-q))/(4.0_wp*step**2)
            of = coupling(link, i, j)
            call t%close_to(of%mean(), 2.0_wp*bend, 3.0e-4_wp, 'stiffness of modes by what acts on the link')
         end do
      end do
   end subroutine acting_on_link

   !> Potential energy of load, couple and springs.
   pure real(wp) function energy(amplitudes)
      real(wp), intent(in) :: amplitudes(3)
      integer, parameter :: parts = 200
      real(wp) :: at(2), angle, weight
      integer :: k

      at = 0.0_wp
      do k = 0, parts ! Simpson's rule
         weight = merge(4.0_wp, 2.0_wp, modulo(k, 2) == 1)
         if (k == 0 .or. k == parts) weight = 1.0_wp
         angle = angle_at(place*real(k, wp)/real(parts, wp), amplitudes)
         at = at + weight*place/real(3*parts, wp)*[cos(angle), sin(angle)]
      end do
      angle = angle_at(place, amplitudes)
      at = at + height*[-sin(angle), cos(angle)]
      energy = -dot_product(force, at) - moment*angle + 0.5_wp*torsion*angle**2 + 0.5_wp*spring*(norm2(fixed - at) - free)**2
   end function energy

   pure real(wp) function angle_at(x, amplitudes)
      real(wp), intent(in) :: x, amplitudes(3)
      integer :: n

      angle_at = asin(sum([(amplitudes(n)*real(n, wp)*pi*cos(real(n, wp)*pi*x), n=1, 3)]))
   end function angle_at

   !> The greatest between the steps: cos(3 x - 0.1) + 0.2 cos(x), by y'' + y'/2 + 40 y = p.
   subroutine greatest()
      type(hill_t) :: hill
      type(periodic_t) :: p
      real(wp) :: x, best
      integer :: i
      real(wp), parameter :: c = 0.1_wp

      ! p = y'' + y'/2 + 40 y: 31 cos(3x-c) - 1.5 sin(3x-c) + 0.2 (39 cos x - 0.5 sin x)
      p = periodic_from_harmonics(0.0_wp, [7.8_wp, 0.0_wp, 31.0_wp*cos(c) + 1.5_wp*sin(c)], &
                                  [-0.1_wp, 0.0_wp, 31.0_wp*sin(c) - 1.5_wp*cos(c)])
      hill = solve_hill(periodic_constant(0.5_wp), periodic_constant(40.0_wp), p, 1.0e-10_wp)
      best = 0.0_wp
      do i = -2000, 2000
         x = c/3.0_wp + 1.0e-5_wp*real(i, wp)
         best = max(best, cos(3.0_wp*x - c) + 0.2_wp*cos(x))
      end do
      call t%close_to(greatest_of(hill), best, 1.0e-9_wp, 'the greatest of a solution lies between its steps')
   end subroutine greatest

   subroutine estimates()
      real(wp) :: delta, ratio
      integer :: i
      real(wp), parameter :: s(10) = [39.887_wp, 28.545_wp, 23.569_wp, 20.626_wp, 18.629_wp, 17.163_wp, 16.027_wp, 15.114_wp, &
         14.359_wp, 13.721_wp]
      real(wp), parameter :: r(10) = [0.988_wp, 0.975_wp, 0.964_wp, 0.953_wp, 0.942_wp, 0.931_wp, 0.921_wp, 0.911_wp, &
         0.902_wp, 0.893_wp]

      call t%close_to(impulse_magnifier(0.01_wp, 10.0_wp), 1.34684_wp, 1.0e-5_wp, 'impulse magnifier')
      call t%close_to(impulse_magnifier(0.01_wp, 20.0_wp), 1.75658_wp, 1.0e-5_wp, 'impulse magnifier of twice the ratio')
      call t%close_to(impulse_magnifier(0.0_wp, 20.0_wp), 1.0_wp, 0.0_wp, 'impulse magnifier without damping')
      call t%close_to(impulse_magnifier(1.591e-6_wp, 10.0_wp), impulse_magnifier(1.592e-6_wp, 10.0_wp), 1.0e-7_wp, &
                      'the series joins the closed form')
      call t%close_to(repeated_magnifier(0.01_wp, 10.0_wp)*0.2_wp*acos(-1.0_wp), impulse_magnifier(0.01_wp, 10.0_wp), 1.0e-12_wp, &
                      'steps once a turn at resonance')
      call t%close_to(step_error(10, 1.0_wp, 0.75_wp, 0.01_wp, 10.0_wp), 89.790_wp, 1.0e-5_wp, 'step of the end load, (10E)')
      call t%close_to(impact_speed(2.0_wp, 3.0_wp), 1.650964_wp*2.0_wp**(2.0_wp/3.0_wp)*3.0_wp**(1.0_wp/3.0_wp), 1.0e-6_wp, &
                      'speed of an impact')
      call t%close_to(impact_time(2.0_wp, 3.0_wp)**3, 12.0_wp*1.0_wp/3.0_wp, 1.0e-12_wp, 'time of an impact, e = 1')
      call t%close_to(foreshortening_sine, 2.467401_wp, 1.0e-6_wp, 'foreshortening of a half sine')
      call t%close_to(straightening(1.0_wp, 1.0_wp, 1.0_wp), 0.558073_wp, 1.0e-5_wp, 'straightening')
      call t%close_to(frequency_fall(35.0_wp, 2.6_wp/0.851_wp), 0.016336_wp, 1.0e-4_wp, 'shear and rotary inertia')
      call t%close_to(tie_rod_ratio(1.0_wp, 10.0_wp, 0.001_wp), 10.0_wp, 1.0e-12_wp, 'tie rod')
      call t%close_to(dynamic_error(1, 1, 10.0_wp, 0.01_wp, .false.), 0.010101_wp, 1.0e-6_wp, 'damper on the error alone')
      call t%close_to(dynamic_error(1, 1, 10.0_wp, 0.01_wp, .true.), 0.010301_wp, 1.0e-6_wp, 'damper on the whole motion')
      call t%close_to(1.0_wp/sqrt(timoshenko_factor(1, 13.0_wp*sqrt(12.0_wp), 2.6_wp/0.8495_wp)) - 1.0_wp, 0.009797_wp, &
            1.0e-6_wp, &
                      'Timoshenko against Euler')
      do i = 1, size(s)
         call post_support_of_slenderness(s(i), delta, ratio)
         call t%close_to(delta, 0.02_wp*real(i, wp), 2.0e-5_wp, 'posts: displacement of the ends')
         call t%close_to(ratio, r(i), 5.0e-4_wp, 'posts: frequency')
      end do
   end subroutine estimates

   !> A blow once a turn: what is left of the blows before, exactly and by the magnifier; strength.
   subroutine impulses()
      real(wp), parameter :: c = 0.01_wp, w = 10.0_wp
      integer, parameter :: n = 20000
      type(hill_t) :: hill
      real(wp) :: start(2), determinant, single, periodic, x, decay, sine, cosine, damped
      real(wp) :: length, modulus, density, gyration, half, strain, acceleration, speed, moment
      integer :: i

      hill = solve_hill(periodic_constant(2.0_wp*c*w), periodic_constant(w**2), periodic_constant(0.0_wp), 1.0e-12_wp)
      associate (m => hill%transfer)
         determinant = (1.0_wp - m(1, 1))*(1.0_wp - m(2, 2)) - m(1, 2)*m(2, 1)
         start = [m(1, 2), 1.0_wp - m(1, 1)]/determinant ! (1 - m) start = (0, 1)
      end associate
      damped = w*sqrt(1.0_wp - c*c)
      single = 0.0_wp
      periodic = 0.0_wp
      do i = 0, n
         x = 2.0_wp*pi*real(i, wp)/real(n, wp)
         decay = exp(-c*w*x)
         sine = sin(damped*x)
         cosine = cos(damped*x)
         single = max(single, abs(decay*sine/damped))
         periodic = max(periodic, abs(decay*(start(1)*cosine + (start(2) + c*w*start(1))/damped*sine)))
      end do
      ! against the resonant harmonic alone, 1/(2 pi c W**2): the magnifier, but for what dies until the peak
      call t%close_to(2.0_wp*pi*c*w**2*periodic, 1.32592_wp, 1.0e-5_wp, 'peak of a periodic impulse over its resonant harmonic')
      call t%close_to(periodic/single, 1.0_wp/(1.0_wp - exp(-2.0_wp*pi*c*w)), 1.0e-4_wp, 'and over the peak of one')
      ! the strain in a uniform link under its own inertia is the limit: by the bending moment m A L/8
      length = 0.4_wp
      modulus = 2.0e11_wp
      density = 7800.0_wp
      half = 0.004_wp
      gyration = half/sqrt(3.0_wp)
      speed = 120.0_wp
      acceleration = 0.07_wp*speed**2
      moment = density*acceleration*length**2/8.0_wp ! of a unit of area
      strain = moment*half/(modulus*gyration**2)
      call t%close_to(strength_ratio(half, gyration, modulus, density, acceleration/speed**2, speed, strain), &
                      pi**2*gyration*sqrt(modulus/density)/(length**2*speed), 1.0e-12_wp, 'strength of a uniform link')
      call t%close_to(dynamic_error(40, 2, 10.0_wp, 0.01_wp, .false.), 50.0_wp, 1.0e-12_wp, &
                      'mode 2 resounds at four times the ratio')
      call t%close_to(magnification(1.0_wp, 0.02_wp), 25.0_wp, 1.0e-12_wp, 'magnification at resonance')
   end subroutine impulses

   !> A coupler under an end load, y'' + 2 c W Q y' + W**2 Q y = W**2 P: Haines, 8c. Largest |y - P/Q|.
   subroutine end_loads()
      real(wp), parameter :: none(2) = 0.0_wp, load(2) = [0.2_wp, 0.06_wp]
      integer :: k
      real(wp), parameter :: plain(4) = [0.010301_wp, 0.041874_wp, 0.333570_wp, 50.01_wp]
      real(wp), parameter :: loaded(3) = [0.014074_wp, 0.056040_wp, 0.501873_wp]
      integer, parameter :: j(4) = [1, 2, 5, 10]
      real(wp) :: many(20), r
      complex(wp) :: h

      do k = 1, 4
         r = 0.1_wp*real(j(k), wp)
         h = 1.0_wp/cmplx(1.0_wp - r*r, 0.02_wp*r, wp)
         call t%close_to(end_load_error(none, j(k)), abs(h - 1.0_wp), 1.0e-4_wp, 'end load: constant, in closed form')
         call t%close_to(end_load_error(none, j(k)), plain(k), 1.0e-3_wp, 'end load: constant')
      end do
      do k = 1, 3
         call t%close_to(end_load_error(load, j(k)), loaded(k), 1.0e-3_wp, 'end load: varying')
      end do
      many = 0.0003_wp
      call t%close_to(end_load_error(many, 0), 0.02025_wp, 1.0e-3_wp, 'end load: twenty small harmonics, constant force')
      call t%close_to(end_load_error(many, 1), 0.02930_wp, 1.0e-3_wp, 'end load: twenty small harmonics')
      call t%is_true(end_load_error([1.2_wp], 1) > 1.0_wp, 'end load beyond that of Euler for a part of the turn')
   end subroutine end_loads

   real(wp) function end_load_error(cosines, j) result(largest)
      real(wp), intent(in) :: cosines(:) !! of Q, whose mean is 1
      integer, intent(in) :: j           !! P = cos(j x)
      real(wp), parameter :: w = 10.0_wp, c = 0.01_wp
      type(periodic_t) :: q, p, y
      type(hill_t) :: hill
      integer, parameter :: n = 4096
      real(wp) :: wave(max(1, j))

      q = periodic_from_harmonics(1.0_wp, cosines, 0.0_wp*cosines)
      wave = 0.0_wp
      if (j > 0) wave(j) = 1.0_wp
      p = periodic_from_harmonics(merge(1.0_wp, 0.0_wp, j == 0), wave, 0.0_wp*wave)
      hill = solve_hill(q%scaled(2.0_wp*c*w), q%scaled(w*w), p%scaled(w*w), 1.0e-11_wp)
      y = periodic_from_samples(hill%y)
      largest = maxval(abs(y%values(n) - p%values(n)/q%values(n)))
   end function end_load_error

   !> Harmonics of the stiffness e g + h of the rig, and how fast they fall.
   subroutine coefficients_of_the_rig()
      type(periodic_t) :: f0, f1
      complex(wp), parameter :: a(2) = [(2.7977091923_wp, -1.0613066894_wp), (0.9250411217_wp, -0.4872215178_wp)]
      complex(wp), parameter :: b(2) = [(0.5331110785_wp, -0.1806779064_wp), (0.1433147233_wp, -0.0249328614_wp)]
      integer :: n

      f0 = mode_stiffness(rig(0.0_wp), 1)
      f1 = mode_stiffness(rig(1.0_wp), 1)
      call t%close_to(f1%mean() - f0%mean(), 0.3313828327_wp, 1.0e-9_wp, 'rig: mean of g')
      call t%close_to(f0%mean(), 0.0158537268_wp, 1.0e-8_wp, 'rig: mean of h')
      do n = 1, 2
         call t%close_to(abs(f1%coefficient(n) - f0%coefficient(n) - a(n)), 0.0_wp, 1.0e-9_wp, 'rig: harmonic of g')
         call t%close_to(abs(f0%coefficient(n) - b(n)), 0.0_wp, 1.0e-9_wp, 'rig: harmonic of h')
      end do
      call t%is_true(abs(f1%coefficient(32) - f0%coefficient(32)) < 2.0e-14_wp*abs(a(1)), 'rig: the 32nd harmonic of g')
      call t%is_true(abs(f0%coefficient(32)) < 2.0e-14_wp*abs(b(1)), 'rig: the 32nd harmonic of h')
   end subroutine coefficients_of_the_rig

   !> y'' + (a - 2 q cos 2 z) y = 0 at q = 1: characteristic values of Abramowitz and Stegun, table 20.1. With x = 2 z it is
   !> W = a/4, f = -(q/2) cos x.
   subroutine mathieu()
      type(boundaries_t) :: b
      type(periodic_t) :: f
      real(wp), parameter :: low(0:2) = [-0.4551386041_wp, -0.1102488169_wp, 3.9170247730_wp]
      real(wp), parameter :: high(1:2) = [1.8591080725_wp, 4.3713009827_wp]

      f = periodic_from_harmonics(0.0_wp, [-0.5_wp], [0.0_wp])
      b = stability_boundaries(f, 2)
      call t%close_to(maxval(abs(4.0_wp*b%low - low)), 0.0_wp, 1.0e-10_wp, 'Mathieu: lower boundaries')
      call t%close_to(maxval(abs(4.0_wp*b%high(1:) - high)), 0.0_wp, 1.0e-10_wp, 'Mathieu: upper boundaries')
   end subroutine mathieu

   !> The error of (13.28) falls as the cube of f, that of (13.27) as the square.
   subroutine series_errors()
      real(wp), parameter :: part(4) = [0.04_wp, 0.02_wp, 0.01_wp, 0.005_wp]
      real(wp), parameter :: want(4) = [7.6e-4_wp, 9.1e-5_wp, 1.1e-5_wp, 1.4e-6_wp]
      type(periodic_t) :: f
      type(boundaries_t) :: b
      real(wp) :: first(4), second(4)
      integer :: i

      do i = 1, 4
         f = mode_stiffness(rig(1.0_wp), 1)
         f = f%scaled(part(i))
         b = stability_boundaries(f, 1)
         first(i) = maxval(abs(series_boundaries(f, 1, 1) - [b%low(1), b%high(1)]))
         second(i) = maxval(abs(series_boundaries(f, 1, 2) - [b%low(1), b%high(1)]))
         call t%is_true(second(i) > 0.8_wp*want(i) .and. second(i) < 1.2_wp*want(i), 'error of (13.28)')
      end do
      call t%is_true(all(first(1:3)/first(2:4) > 3.5_wp .and. first(1:3)/first(2:4) < 4.5_wp), 'error of (13.27): the square')
      call t%is_true(all(second(1:3)/second(2:4) > 7.0_wp .and. second(1:3)/second(2:4) < 9.0_wp), 'error of (13.28): the cube')
   end subroutine series_errors

   !> Very narrow tongues keep their width; very large coefficients make the matrix larger.
   subroutine narrow_and_wide()
      type(boundaries_t) :: b, larger
      type(periodic_t) :: f
      real(wp), parameter :: e(3) = [0.5_wp, 1.43_wp, 4.0_wp], want(3) = [1.3e-6_wp, 7.4e-6_wp, 6.5e-4_wp]
      real(wp) :: width
      integer :: i

      do i = 1, 3
         b = stability_boundaries(mode_stiffness(rig(e(i)), 1), 12)
         width = sqrt(b%high(12)) - sqrt(b%low(12))
         call t%is_true(abs(width/want(i) - 1.0_wp) < 0.05_wp, 'width of a narrow tongue')
      end do
      f = mode_stiffness(rig(200.0_wp), 1)
      b = stability_boundaries(f, 20)
      call t%is_true(b%converged .and. b%waves > 60, 'boundaries at e = 200 converge')
      larger = stability_boundaries(f, 60)
      call t%close_to(maxval(abs(b%high - larger%high(:20)))/abs(b%high(0)), 0.0_wp, 1.0e-12_wp, 'and do not depend on the matrix')
   end subroutine narrow_and_wide

   !> Unstable speeds of the rig at 19.9 Hz, rev/min; gaps between them; the trace where half harmonics were seen.
   subroutine speeds_of_the_rig()
      type(boundaries_t) :: b
      type(hill_t) :: hill
      type(periodic_t) :: f
      real(wp), parameter :: rpm(2, 4:8) = reshape([470.73_wp, 546.48_wp, 424.82_wp, 446.71_wp, 378.37_wp, 384.51_wp, 334.16_wp, &
                                                    335.12_wp, 295.92_wp, 296.12_wp], [2, 5])
      real(wp), parameter :: e(8) = [0.5_wp, 1.0_wp, 1.5_wp, 2.0_wp, 2.5_wp, 3.0_wp, 3.5_wp, 4.0_wp]
      real(wp), parameter :: gap(8) = [1.790_wp, 2.334_wp, 2.566_wp, 3.026_wp, 3.475_wp, 3.629_wp, 4.054_wp, 4.187_wp]
      integer :: p, i

      f = mode_stiffness(rig(1.43_wp), 1)
      b = stability_boundaries(f, 20)
      do p = 4, 8
         call t%close_to(60.0_wp*19.9_wp/sqrt(b%high(p)), rpm(1, p), 2.0e-5_wp, 'rig: an unstable band begins')
         call t%close_to(60.0_wp*19.9_wp/sqrt(b%low(p)), rpm(2, p), 2.0e-5_wp, 'rig: and ends')
      end do
      do i = 1, size(e)
         b = stability_boundaries(mode_stiffness(rig(e(i)), 1), 20)
         do p = 0, 19
            if (speed_ratio(b%low(p + 1)) - max(speed_ratio(b%high(p)), 0.0_wp) > 0.1_wp .and. b%low(p + 1) > 0.0_wp) exit
         end do
         call t%close_to(max(speed_ratio(b%high(p)), 0.0_wp), gap(i), 1.0e-3_wp, 'rig: the first gap wider than 0.1')
      end do
      f = mode_stiffness(rig(2.14_wp), 1)
      hill = solve_hill(no_damping, f%plus(periodic_constant(4.54_wp**2)), periodic_constant(0.0_wp), 1.0e-12_wp)
      call t%close_to(hill%transfer(1, 1) + hill%transfer(2, 2), -1.98999_wp, 1.0e-5_wp, 'rig: near period doubling at 175 rev/min')
   end subroutine speeds_of_the_rig
end program test_vibration
