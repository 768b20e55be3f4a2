!> Cams: a disc that is a circle by another route, laws against themselves, splines against their conditions.
program test_cam
   use cases, only: load_case
   use check, only: checks_t
   use psalm_angles, only: unit_vector
   use psalm_arc_path, only: circle_arc_t, sampled_curve_t, fit_arcs, deviation_of, chords_needed
   use psalm_cam_contact, only: line_stress
   use psalm_cam_data, only: cam_group_t
   use psalm_cam_kind, only: law_names, has_zones, zones_of, law_kind
   use psalm_cam_law, only: law_t, law_joint_t, make_law, law_made, law_velocity_jumps, law_singular, law_jerk_jumps, &
                            highest_law_order
   use psalm_cam_interference, only: sample_pair_t, near_pairs, fit_least
   use psalm_cam_trace, only: cam_trace_t
   use psalm_cam_profile, only: cam_axes_t, cam_points_t, roller_profile, flat_profile, side_of_centre
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, new_problem
   use psalm_kinds, only: wp, full_turn, radians_per_degree
   use psalm_mechanism, only: output_t
   use psalm_output_kind, only: motion_pose
   use psalm_periodic_spline, only: periodic_spline, quintic_hermite, septic_hermite
   use psalm_rates, only: rates_t, prepare_rates, differentiate, output_rates, highest_order
   use psalm_spline_fit, only: basis_of, fit_spline
   use psalm_xoshiro, only: xoshiro_t, purpose_sample
   implicit none (type, external)
   type(checks_t) :: t

   call eccentric_disc()
   call law_derivatives()
   call laws_that_cannot_be()
   call splines()
   call fits()
   call polynomials()
   call flat_face_of_a_circle()
   call interference()
   call pairs_without_blocks()
   call arcs_of_an_ellipse()
   call stress()
   call flexible_drive()
   call t%report()

contains

   !> A crank-rocker is a round disc, eccentric by the crank, under a roller on the rocker: whatever the follower's motion, the
   !> profile must be that circle, and the pressure angle the complement of the transmission angle.
   subroutine eccentric_disc()
      integer, parameter :: n = 120
      real(wp), parameter :: roller = 25.0_wp, crank = 40.0_wp, coupler = 120.0_wp, rocker = 80.0_wp, frame = 130.0_wp
      class(problem_t), allocatable :: given, problem
      class(data_set_t), allocatable :: set
      type(rates_t) :: rates
      type(cam_trace_t) :: states
      type(cam_points_t) :: points
      real(wp) :: delt(n), d(highest_order, 3), round, straight, bend, x, y, diagonal, cosine, sine
      integer :: block, offset, m, i
      real(wp) :: side

      allocate (given, problem, set)
      call load_case('dyad1_crank_rocker', given, set)
      ! the start of the rocker's arc is the pin of the coupler
      given%mechanism%outputs = [output_t(motion_pose, 3, .true.)]
      delt = [(full_turn*real(i - 1, wp)/real(n, wp), i=1, n)]
      given%given%crnki = 0.0_wp
      given%given%outlk = 0.0_wp
      call new_problem(given%mechanism, given%given, given%parameters, delt, .false., problem)
      call problem%want_derivatives(.false.)
      call problem%bind(problem%given)
      call prepare_rates(problem, rates)
      states%angle = delt
      allocate (states%c(0:3, n), states%by_input(n), states%direction(n), source=(0.0_wp, 0.0_wp))
      allocate (states%turning(3, n), states%turning_by_input(n), source=0.0_wp)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, m)
         call problem%output_of(m)
         call differentiate(problem, rates, m, highest_order)
         do i = 1, m
            call output_rates(problem, rates, i, highest_order, d)
            states%c(0, offset + i) = cmplx(problem%output%actual(1, i, problem%linkage), &
                                            problem%output%actual(2, i, problem%linkage), wp)
            states%c(1:3, offset + i) = cmplx(d(:, 1), d(:, 2), wp)
            states%by_input(offset + i) = cmplx(d(1, 1), d(1, 2), wp)
         end do
      end do
      side = side_of_centre(states, cam_axes_t())
      call roller_profile(states, cam_axes_t(), side, roller, roller, points)
      round = maxval(abs(abs(points%profile - crank) - (coupler - roller)))
      bend = maxval(abs(points%bend*coupler - 1.0_wp))
      straight = 0.0_wp
      do i = 1, n
         ! transmission angle from the diagonal of the four-bar, by the law of cosines
         call unit_vector(delt(i), x, y)
         diagonal = crank**2 + frame**2 - 2.0_wp*crank*frame*x
         cosine = (coupler**2 + rocker**2 - diagonal)/(2.0_wp*coupler*rocker)
         call unit_vector(points%pressure(i), x, sine)
         ! cosine of the transmission angle is the sine of the pressure angle
         straight = max(straight, abs(abs(sine) - abs(cosine)))
      end do
      call t%is_true(abs(side) > 0.0_wp, 'eccentric disc: the centre is on one side')
      call t%close_to(round/coupler, 0.0_wp, 1.0e-13_wp, 'eccentric disc: the profile is a circle')
      call t%close_to(bend, 0.0_wp, 1.0e-12_wp, 'eccentric disc: its curvature')
      call t%close_to(straight, 0.0_wp, 1.0e-13_wp, 'eccentric disc: the pressure angle is what the transmission angle lacks')
   end subroutine eccentric_disc

   !> A rise of a law, a dwell, and back.
   subroutine make_cam(law, cam)
      integer, intent(in) :: law
      type(cam_group_t), intent(out) :: cam

      cam%finish = [100.0_wp, 150.0_wp, 300.0_wp, 360.0_wp]
      cam%output = [3.0_wp, 3.0_wp, -1.0_wp, -1.0_wp]
      cam%start = -1.0_wp
      cam%law = [law, law_kind('DWELL'), law, law_kind('DWELL')]
      allocate (cam%velocity(4), cam%acceleration(4), cam%jerk(4), cam%zones(7, 4), source=0.0_wp)
      allocate (cam%table(0), cam%table_at(0))
      if (.not. has_zones(law)) return
      cam%zones(:, 1) = zones_of(law)
      cam%zones(:, 3) = zones_of(law)
   end subroutine make_cam

   !> Every derivative is that of the one before, within each piece; the ends are met.
   subroutine law_derivatives()
      type(cam_group_t) :: cam
      type(law_t) :: law
      type(law_joint_t), allocatable :: joints(:)
      real(wp) :: y(0:highest_law_order), ahead(0:highest_law_order), behind(0:highest_law_order), h, worst, scale
      integer :: k, p, i, order

      do k = 1, size(law_names)
         if (k == law_kind('DWELL') .or. k == law_kind('RAMP')) cycle
         call make_cam(k, cam)
         cam%acceleration = 0.0_wp
         call make_law(cam, law)
         call t%equal_integer(law%state, law_made, trim(law_names(k))//': can be made')
         do order = 1, highest_law_order
            worst = 0.0_wp
            scale = 0.0_wp
            do p = 1, size(law%pieces)
               h = 1.0e-4_wp*law%pieces(p)%width
               do i = 1, 9
                  associate (at => law%pieces(p)%start + law%pieces(p)%width*0.1_wp*real(i, wp))
                     y = law%evaluate(at, p)
                     ahead = law%evaluate(at + h, p)
                     behind = law%evaluate(at - h, p)
                  end associate
                  worst = max(worst, abs((ahead(order - 1) - behind(order - 1))/(2.0_wp*h*radians_per_degree) - y(order)))
                  scale = max(scale, abs(y(order)), abs(y(order - 1)))
               end do
            end do
            call t%close_to(worst/max(scale, 1.0_wp), 0.0_wp, 1.0e-6_wp, trim(law_names(k))//': derivative against differences')
         end do
         allocate (joints(size(law%pieces)))
         joints = law%joints()
         worst = 0.0_wp
         do p = 1, size(joints)
            worst = max(worst, abs(joints(p)%jump(0)), abs(joints(p)%jump(1)))
         end do
         call t%close_to(worst, 0.0_wp, 1.0e-13_wp, trim(law_names(k))//': no jump of place or velocity')
         y = law%evaluate(100.0_wp, law%piece_at(100.0_wp))
         call t%close_to(y(0), 3.0_wp, 0.0_wp, trim(law_names(k))//': it ends where it is to end')
         deallocate (joints)
      end do
   end subroutine law_derivatives

   subroutine laws_that_cannot_be()
      type(cam_group_t) :: cam
      type(law_t) :: law

      call make_cam(law_kind('RAMP'), cam)
      call make_law(cam, law)
      call t%equal_integer(law%state, law_velocity_jumps, 'a ramp beside a dwell')
      call make_cam(law_kind('TRIG'), cam)
      cam%zones(:, 1) = [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
      call make_law(cam, law)
      call t%equal_integer(law%state, law_singular, 'zones that cannot accelerate')
   end subroutine laws_that_cannot_be

   !> Splines keep what they are: of period, smooth, near; a coarse mesh of uneven steps.
   subroutine splines()
      real(wp), parameter :: at(8) = [0.0_wp, 20.0_wp, 75.0_wp, 130.0_wp, 180.0_wp, 200.0_wp, 260.0_wp, 310.0_wp]
      real(wp), parameter :: values(8) = [1.0_wp, 1.5_wp, 0.7_wp, -2.0_wp, -1.0_wp, -0.9_wp, 0.3_wp, 0.2_wp]
      real(wp), allocatable :: c(:, :)
      real(wp) :: jump, step, before, after, worst, integral(2)
      integer :: degree, k, next, order, m, run
      logical :: found

      do degree = 3, 5, 2
         do run = 1, 2
            call periodic_spline(at, values, full_turn, degree, merge(0.0_wp, 0.3_wp, run == 1), c, found)
            call t%is_true(found, 'spline: found')
            worst = 0.0_wp
            do k = 1, size(at)
               next = modulo(k, size(at)) + 1
               step = modulo(at(next) - at(k), full_turn)
               do order = 0, degree - 1
                  before = derivative(c(:, k), order, 1.0_wp)/step**order
                  after = derivative(c(:, next), order, 0.0_wp)/modulo(at(modulo(next, size(at)) + 1) - at(next), full_turn)**order
                  jump = abs(before - after)*100.0_wp**order
                  worst = max(worst, jump)
               end do
            end do
            call t%close_to(worst, 0.0_wp, 1.0e-8_wp, 'spline: continuous to its last derivative but one')
            worst = maxval(abs(c(0, :) - values))
            if (run == 1) call t%close_to(worst, 0.0_wp, 1.0e-14_wp, 'spline: through the points')
            if (run == 2) call t%is_true(worst <= 0.3_wp .and. worst > 0.29_wp, 'spline: the tolerance is kept and used')
            ! roughness by Simpson's rule, enough for squares of polynomials of degree 2
            integral(run) = 0.0_wp
            m = (degree + 1)/2
            do k = 1, size(at)
               step = modulo(at(modulo(k, size(at)) + 1) - at(k), full_turn)
               integral(run) = integral(run) + (derivative(c(:, k), m, 0.0_wp)**2 + 4.0_wp*derivative(c(:, k), m, 0.5_wp)**2 &
                                                + derivative(c(:, k), m, 1.0_wp)**2)/(6.0_wp*step**(2*m - 1))
            end do
         end do
         call t%is_true(integral(2) < 0.5_wp*integral(1), 'spline: smoother with a tolerance')
      end do
   end subroutine splines

   !> The basis is a partition of unity, nowhere negative; a curve of the basis is found again; a constant keeps any bounds.
   subroutine fits()
      integer, parameter :: n = 40, m = 8
      real(wp) :: basis(0:5, 0:5), control(m), at(n), values(n), pieces(0:5, m), u, row(0:5), worst
      integer :: degree, i, j, piece
      logical :: found

      do degree = 3, 5, 2
         associate (b => basis(0:degree, 0:degree))
            b = basis_of(degree)
            do i = 0, 4
               u = 0.25_wp*real(i, wp)
               row(:degree) = [(derivative(b(:, j), 0, u), j=1, degree + 1)]
               call t%close_to(sum(row(:degree)), 1.0_wp, 1.0e-15_wp, 'basis: its sum is 1')
               call t%is_true(all(row(:degree) >= 0.0_wp), 'basis: nowhere negative')
            end do
         end associate
      end do
      control = [1.0_wp, -2.0_wp, 0.5_wp, 3.0_wp, 2.5_wp, -1.0_wp, 0.0_wp, 4.0_wp]
      do i = 1, n
         at(i) = full_turn*(real(i - 1, wp) + 0.3_wp*real(modulo(i, 3), wp))/real(n, wp)
         piece = int(at(i)*real(m, wp)/full_turn)
         u = at(i)*real(m, wp)/full_turn - real(piece, wp)
         values(i) = sum([(control(1 + modulo(piece + j, m))*derivative(basis(:, j), 0, u), j=0, 5)])
      end do
      call fit_spline(at, values, [(real(modulo(i, 4) + 1, wp), i=1, n)], full_turn, 5, [0.0_wp, 0.0_wp], pieces, found)
      call t%is_true(found, 'fit: found')
      worst = 0.0_wp
      do i = 1, m
         do j = 0, 5
            u = sum([(control(1 + modulo(i - 1 + piece, m))*derivative(basis(:, piece), j, 0.0_wp), piece=0, 5)])
            worst = max(worst, abs(derivative(pieces(:, i), j, 0.0_wp) - u))
         end do
      end do
      call t%close_to(worst, 0.0_wp, 1.0e-9_wp, 'fit: a curve of the basis is found again')
      call fit_spline(at, values, [(1.0_wp, i=1, n)], full_turn, 5, [1.0e-3_wp, 1.0e-5_wp], pieces, found)
      worst = maxval(abs([((derivative(pieces(:, i), 1, 0.02_wp*real(j, wp))*real(m, wp)/full_turn, i=1, m), j=0, 50)]))
      call t%is_true(found .and. worst <= 1.0e-3_wp*(1.0_wp + 1.0e-6_wp), 'fit: a narrow bound of the slope is kept')
      worst = maxval(abs([((derivative(pieces(:, i), 2, 0.02_wp*real(j, wp))*(real(m, wp)/full_turn)**2, i=1, m), j=0, 50)]))
      call t%is_true(worst <= 1.0e-5_wp*(1.0_wp + 1.0e-6_wp), 'fit: a narrow bound of the second derivative is kept')
      call fit_spline(at(:5), values(:5), [(1.0_wp, i=1, 5)], full_turn, 5, [0.0_wp, 0.0_wp], pieces, found)
      call t%is_true(.not. found, 'fit: too few points')
   end subroutine fits

   !> Derivative of a polynomial by its own variable.
   pure real(wp) function derivative(c, order, u) result(d)
      real(wp), intent(in) :: c(:)
      integer, intent(in) :: order
      real(wp), intent(in) :: u
      integer :: power, k
      real(wp) :: factor

      d = 0.0_wp
      do power = size(c) - 1, order, -1
         factor = 1.0_wp
         do k = 0, order - 1
            factor = factor*real(power - k, wp)
         end do
         d = d*u + factor*c(power + 1)
      end do
   end function derivative

   subroutine polynomials()
      real(wp), parameter :: ends(8) = [0.3_wp, -1.1_wp, 2.0_wp, 0.7_wp, 1.9_wp, 0.4_wp, -3.0_wp, 5.0_wp]
      real(wp) :: c5(6), c7(8)
      integer :: order

      c5 = quintic_hermite(ends(1), ends(2), ends(3), ends(5), ends(6), ends(7))
      c7 = septic_hermite(ends(1), ends(2), ends(3), ends(4), ends(5), ends(6), ends(7), ends(8))
      do order = 0, 3
         call t%close_to(derivative(c7, order, 0.0_wp), ends(order + 1), 1.0e-14_wp, 'degree 7: its beginning')
         call t%close_to(derivative(c7, order, 1.0_wp), ends(order + 5), 1.0e-12_wp, 'degree 7: its end')
         if (order == 3) cycle
         call t%close_to(derivative(c5, order, 0.0_wp), ends(order + 1), 1.0e-14_wp, 'degree 5: its beginning')
         call t%close_to(derivative(c5, order, 1.0_wp), ends(order + 5), 1.0e-13_wp, 'degree 5: its end')
      end do
   end subroutine polynomials

   !> A disc of radius R, eccentric by e, lifts a flat face by e sin th: its radius of curvature is R at every angle.
   subroutine flat_face_of_a_circle()
      integer, parameter :: n = 36
      real(wp), parameter :: disc = 30.0_wp, e = 7.0_wp
      type(cam_trace_t) :: states
      type(cam_points_t) :: points
      logical :: possible(n)
      real(wp) :: c, s
      integer :: i

      states%angle = [(10.0_wp*real(i, wp), i=1, n)]
      allocate (states%c(0:3, n), source=(0.0_wp, 0.0_wp))
      allocate (states%by_input(n), source=(0.0_wp, 1.0_wp))
      allocate (states%direction(n), source=(0.0_wp, 1.0_wp))
      allocate (states%turning(3, n), states%turning_by_input(n), source=0.0_wp)
      do i = 1, n
         call unit_vector(states%angle(i), c, s)
         states%c(:, i) = (0.0_wp, 1.0_wp)*[disc + e*s, e*c, -e*s, -e*c]
      end do
      call flat_profile(states, cam_axes_t(), 0.0_wp, 5.0_wp, points, possible)
      call t%is_true(all(possible), 'a flat face on a disc: possible')
      call t%close_to(maxval(abs(points%radius - disc))/disc, 0.0_wp, 1.0e-14_wp, 'a flat face on a disc: radius of curvature')
      call t%close_to(maxval(abs(abs(points%profile - e) - disc))/disc, 0.0_wp, 1.0e-14_wp, 'a flat face on a disc: the disc')
      call t%close_to(maxval(abs(abs(points%cutter - e) - disc - 5.0_wp))/disc, 0.0_wp, 1.0e-14_wp, &
                      'a flat face on a disc: centre of the wheel')
      call t%close_to(maxval(abs(points%pressure)), 0.0_wp, 0.0_wp, 'a flat face square to its travel: no pressure angle')
   end subroutine flat_face_of_a_circle

   !> Samples are left out in blocks: the pairs are those that are found one by one.
   subroutine pairs_without_blocks()
      integer, parameter :: n = 333, shapes = 60
      real(wp), parameter :: radius = 12.0_wp
      type(xoshiro_t) :: random
      type(sample_pair_t), allocatable :: pairs(:)
      complex(wp) :: contour(n), centres(n), tangent(n)
      real(wp) :: phase, lobes(4), c, s, angle, r, dr, limit
      integer :: i, k, m, o, shape, found, missing, length
      logical :: open

      call random%seed(5, purpose_sample)
      found = 0
      missing = 0
      length = 0
      do shape = 1, shapes
         do m = 1, size(lobes)
            call random%next(lobes(m))
         end do
         call random%next(phase)
         open = mod(shape, 3) == 0
         do i = 1, n
            ! an open curve is two thirds of a turn
            angle = full_turn*(phase + real(i, wp)/real(n, wp)*merge(2.0_wp/3.0_wp, 1.0_wp, open))
            r = 40.0_wp
            dr = 0.0_wp
            do m = 1, size(lobes)
               call unit_vector(angle*real(m + 1, wp), c, s)
               r = r + 12.0_wp*lobes(m)*c
               dr = dr - 12.0_wp*lobes(m)*s*real(m + 1, wp)
            end do
            call unit_vector(angle, c, s)
            centres(i) = r*cmplx(c, s, wp)
            tangent(i) = cmplx(dr, r, wp)*cmplx(c, s, wp)
            tangent(i) = tangent(i)/abs(tangent(i))
         end do
         contour = centres + (0.0_wp, 1.0_wp)*tangent*radius
         call near_pairs(contour, centres, tangent, radius, open, pairs)
         length = length + size(pairs)
         limit = radius + 0.5_wp*(longest(contour, open) + longest(centres, open))
         do k = 1, n
            do i = 1, n
               if (size_of(contour(i) - centres(k)) >= limit .or. turns_less(tangent, open, i, k, 1) .or. &
                   turns_less(tangent, open, i, k, -1)) cycle
               if (any([((size_of(contour(1 + modulo(i - 1 + m, n)) - centres(1 + modulo(k - 1 + o, n))) < &
                          size_of(contour(i) - centres(k)), m=-1, 1), o=-1, 1)])) cycle
               found = found + 1
               if (.not. any(pairs%at == i .and. pairs%by == k)) missing = missing + 1
            end do
         end do
      end do
      call t%is_true(found > shapes, 'curves that come near to themselves: some pairs to look at')
      call t%equal_integer(missing, 0, 'none is left out with its block')
      call t%equal_integer(length, found, 'and none is there besides')
   end subroutine pairs_without_blocks

   !> From sample i to sample k the curve, going ahead (way 1) or back (-1), turns by less than a right angle all the way.
   pure logical function turns_less(tangent, open, i, k, way)
      complex(wp), intent(in) :: tangent(:)
      logical, intent(in) :: open
      integer, intent(in) :: i, k, way
      integer :: at, n

      n = size(tangent)
      turns_less = .false.
      at = i
      do while (at /= k)
         if (open .and. (at + way < 1 .or. at + way > n)) return
         at = 1 + modulo(at - 1 + way, n)
         if (real(conjg(tangent(i))*tangent(at), wp) <= 0.0_wp) return
      end do
      turns_less = .true.
   end function turns_less

   !> As the code under test has it: a distance within one rounding of a limit is to fall on the same side.
   pure real(wp) function size_of(z)
      complex(wp), intent(in) :: z

      size_of = sqrt(real(z, wp)**2 + aimag(z)**2)
   end function size_of

   pure real(wp) function longest(points, open)
      complex(wp), intent(in) :: points(:)
      logical, intent(in) :: open
      integer :: i

      longest = 0.0_wp
      if (.not. open) longest = size_of(points(1) - points(size(points)))
      do i = 2, size(points)
         longest = max(longest, size_of(points(i) - points(i - 1)))
      end do
   end function longest

   !> A circle under a roller: no pair may meet. A curve of centres that comes back beside itself: one does.
   subroutine interference()
      integer, parameter :: n = 400
      complex(wp) :: contour(n), centres(n), tangent(n), d
      type(sample_pair_t), allocatable :: pairs(:)
      real(wp) :: c, s, f(-1:1, -1:1), move(2), waist
      integer :: i, k

      do i = 1, n
         call unit_vector(full_turn*real(i, wp)/real(n, wp), c, s)
         contour(i) = 50.0_wp*cmplx(c, s, wp)
         centres(i) = 60.0_wp*cmplx(c, s, wp)
         tangent(i) = (0.0_wp, 1.0_wp)*cmplx(c, s, wp)
      end do
      call near_pairs(contour, centres, tangent, 10.0_wp, .false., pairs)
      call t%equal_integer(size(pairs), 0, 'a circle under a roller: no pair to look at')
      ! an oval of Cassini with a waist narrower than the rollers that stand on both of its sides
      do k = 1, 2
         waist = merge(4.0_wp, 30.0_wp, k == 1)
         do i = 1, n
            call unit_vector(full_turn*real(i, wp)/real(n, wp), c, s)
            centres(i) = cmplx(60.0_wp*c, s*(waist + 40.0_wp*c**2), wp)
            d = cmplx(-60.0_wp*s, c*(waist + 40.0_wp*c**2) - 80.0_wp*c*s**2, wp)
            tangent(i) = d/abs(d)
         end do
         contour = centres + (0.0_wp, 1.0_wp)*tangent*10.0_wp
         call near_pairs(contour, centres, tangent, 10.0_wp, .false., pairs)
         call t%is_true(size(pairs) > 0 .eqv. k == 1, 'rollers on both sides of a waist meet where it is narrow')
      end do
      ! a quadratic is fitted exactly
      do i = -1, 1
         do k = -1, 1
            f(i, k) = 7.0_wp + 2.0_wp*(real(i, wp) - 0.3_wp)**2 + 0.7_wp*(real(i, wp) - 0.3_wp)*(real(k, wp) + 0.2_wp) &
                      + 3.0_wp*(real(k, wp) + 0.2_wp)**2
         end do
      end do
      move = fit_least(f)
      call t%close_to(move(1), 0.3_wp, 1.0e-13_wp, 'the least of a quadratic, one way')
      call t%close_to(move(2), -0.2_wp, 1.0e-13_wp, 'the least of a quadratic, the other way')
   end subroutine interference

   !> Arcs keep within their tolerance of an ellipse, which they touch at their ends; a circle is made of few.
   subroutine arcs_of_an_ellipse()
      integer, parameter :: n = 2000
      real(wp), parameter :: tolerance = 1.0e-3_wp
      type(sampled_curve_t) :: curve
      type(circle_arc_t), allocatable :: arcs(:)
      integer, allocatable :: last_sample(:)
      real(wp) :: c, s, minor, worst, kink, bend(0:n)
      integer :: i, k, m
      logical :: found

      do m = 1, 2
         minor = merge(30.0_wp, 50.0_wp, m == 1)
         allocate (curve%point(n + 1), curve%tangent(n + 1), curve%break(n + 1))
         curve%break = .false.
         do i = 0, n
            call unit_vector(full_turn*real(i, wp)/real(n, wp), c, s)
            curve%point(i + 1) = cmplx(50.0_wp*c, minor*s, wp)
            curve%tangent(i + 1) = cmplx(-50.0_wp*s, minor*c, wp)/sqrt((50.0_wp*s)**2 + (minor*c)**2)
            bend(i) = 50.0_wp*minor/sqrt((50.0_wp*s)**2 + (minor*c)**2)**3
         end do
         curve%break(n/2 + 1) = .true.
         call fit_arcs(curve, tolerance, arcs, last_sample, found)
         call t%is_true(found, 'arcs: found')
         worst = 0.0_wp
         k = 1
         do i = 0, n
            if (i + 1 > last_sample(k)) k = k + 1
            worst = max(worst, abs(deviation_of(arcs(2*k - 1:2*k), curve%point(i + 1))))
         end do
         call t%is_true(worst <= tolerance, 'arcs: the tolerance is kept')
         kink = maxval(abs(arcs(2:)%start - arcs(:size(arcs) - 1)%finish))
         call t%close_to(kink, 0.0_wp, 0.0_wp, 'arcs: each begins where the last one ends')
         call t%is_true(any(last_sample == n/2 + 1), 'arcs: none runs over a break')
         if (m == 1) then
            call t%is_true(worst > 0.3_wp*tolerance, 'arcs: the tolerance is used')
            call t%is_true(10*size(arcs) < 3*nint(chords_needed(curve%point, bend, tolerance)), 'arcs: fewer than chords')
         else
            call t%close_to(worst, 0.0_wp, 1.0e-12_wp, 'arcs: a circle is exact')
            call t%is_true(size(arcs) <= 16, 'arcs: a circle needs few')
         end if
         deallocate (curve%point, curve%tangent, curve%break)
      end do
   end subroutine arcs_of_an_ellipse

   !> A rise of 20 in 90 degrees, at 30: frequency ratio 10, damping 0.05.
   subroutine flexible_drive()
      type(cam_group_t) :: cam
      type(law_t) :: law
      real(wp) :: y(0:highest_law_order)

      call make_cam(law_kind('POLY345'), cam)
      cam%finish(1) = 90.0_wp
      cam%start = 0.0_wp
      cam%output = [20.0_wp, 20.0_wp, 0.0_wp, 0.0_wp]
      call make_law(cam, law)
      y = law%evaluate(30.0_wp, 1)
      call t%close_to(y(0), 4.19753086_wp, 1.0e-8_wp, 'flexible drive: what the load is to do')
      law%lag = 0.01_wp
      law%inertia = 0.01_wp
      y = law%evaluate(30.0_wp, 1)
      call t%close_to(y(0), 4.74641204_wp, 1.0e-8_wp, 'flexible drive: what the cam does')
      cam%frequency = 10.0_wp
      call make_law(cam, law)
      call t%equal_integer(law%state, law_jerk_jumps, 'flexible drive: a law with steps of jerk')
   end subroutine flexible_drive

   !> 500 N on 10 mm, roller of 8 mm on a cam of 25 mm, convex and hollow: published formula, worked out by hand.
   subroutine stress()
      real(wp), parameter :: modulus(2) = 206.0e9_wp, poisson(2) = 0.3_wp

      call t%close_to(line_stress(5.0e4_wp, 1.0_wp/0.008_wp + 1.0_wp/0.025_wp, modulus, poisson), 545.192602e6_wp, 1.0e-9_wp, &
                      'stress of a roller on a convex cam')
      call t%close_to(line_stress(5.0e4_wp, 1.0_wp/0.008_wp - 1.0_wp/0.025_wp, modulus, poisson), 391.306845e6_wp, 1.0e-9_wp, &
                      'stress of a roller in a hollow')
      call t%close_to(line_stress(-1.0_wp, 1.0_wp, modulus, poisson), 0.0_wp, 0.0_wp, 'no stress without contact')
   end subroutine stress
end program test_cam
