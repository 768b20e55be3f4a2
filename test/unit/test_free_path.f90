!> Four-bars that timing points without prescribed timing: the coupler's motion, its derivatives, the linear unknowns, the search.
program test_free_path
   use check, only: checks_t
   use psalm_free_path, only: search_batch
   use psalm_kinds, only: wp, degrees_per_radian, full_turn
   use psalm_path_angles, only: angle_limits, keep_angles
   use psalm_path_fit, only: fitted_path_t, path_workspace_t, path_timing_t, prepare_path, set_points, trace_coupler, fit_linear, &
                             lengths_of
   use psalm_ring_match, only: ring_match_t, laid_t, prepare_ring, match_ring
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   type(checks_t) :: t
   integer :: i
   !> The 18 points of `data/path18.nml`.
   real(wp), parameter :: x(18) = [50, 40, 30, 20, 10, 5, 2, 0, 0, 3, 10, 15, 20, 30, 40, 50, 60, 60]/100.0_wp
   real(wp), parameter :: y(18) = [110, 110, 110, 100, 90, 75, 60, 50, 40, 30, 25, 20, 30, 40, 50, 70, 90, 100]/100.0_wp
   real(wp), parameter :: even(18) = 1.0_wp
   real(wp), parameter :: none(6) = 0.0_wp, box(6) = [50.0_wp, 50.0_wp, 50.0_wp, 50.0_wp, 50.0_wp, 10.0_wp]

   call coupler()
   call change_point()
   call derivatives()
   call linear_unknowns()
   call rings()
   call searches()
   call transmission()
   call shapes_at_the_limits()
   call both_limits()
   call t%report()

contains

   !> Points of a four-bar's curve, from any of them on and either way round, are passed by the same four-bar anywhere, in any size
   !> and direction, at the inputs of the points; with another output point it comes near them. Points of an open curve are no ring.
   subroutine rings()
      integer, parameter :: steps = 120, every = 3, n = steps/every
      complex(wp), parameter :: w1 = (0.7_wp, -1.9_wp), z0 = (31.0_wp, -12.0_wp), w = (0.4_wp, 0.8_wp)
      type(path_timing_t) :: shape
      type(fitted_path_t) :: path
      type(ring_match_t) :: ring
      type(laid_t) :: laid, found
      complex(wp) :: e(steps), v(steps), points(n)
      real(wp) :: want(n)
      integer :: first, way, k

      shape = path_timing_t(g=2.0_wp, sigma=1.2_wp, q=0.3_wp)
      call trace_coupler(shape, [(full_turn*real(k, wp)/real(steps, wp), k=0, steps - 1)], e, v)
      do way = 1, 2
         do first = 1, n, 7
            do k = 1, n
               associate (at => modulo(every*(first - 1 + merge(k - 1, 1 - k, way == 1)), steps))
                  points(k) = z0 + w1*(e(1 + at) + w*v(1 + at))
                  want(k) = real(at, wp)/real(steps, wp)
               end associate
            end do
            call set_points(real(points, wp), aimag(points), [(1.0_wp, k=1, n)], path)
            call prepare_ring(path, ring)
            call t%is_true(ring%applies, 'points of a closed curve are a ring')
            laid = laid_t()
            call match_ring(ring, path, e, v, w, 2, laid)
            call t%is_true(laid%way == way, 'the way round is found')
            ! marks of the curve lie between its points, on chords
            call t%is_true(laid%error < 1.0e-3_wp*real(n, wp), 'the linkage passes the points of its curve')
            call t%is_true(all(abs(modulo(laid%turns - want + 0.5_wp, 1.0_wp) - 0.5_wp) < 0.02_wp), 'at their inputs')
            call t%is_true(all((laid%turns(2:) - laid%turns(:n - 1))*merge(1.0_wp, -1.0_wp, way == 1) >= 0.0_wp), 'one way')
            call t%is_true(abs(laid%turns(n) - laid%turns(1)) < 1.0_wp, 'within a turn')
            call t%close_to(laid%w1, sqrt(real(w1*conjg(w1), wp)), 0.2_wp, 'its size')
            call t%close_to(laid%w2, sqrt(real(w1*w*conjg(w1*w), wp)), 0.2_wp, 'its output point')
         end do
      end do
      ! one way only, of points that go the other
      found = laid
      laid = laid_t()
      call match_ring(ring, path, e, v, w, 1, laid)
      call t%is_true(laid%way == 1 .and. laid%error > 3.0_wp*found%error, 'no way that is not asked for')
      laid = laid_t()
      call match_ring(ring, path, e, v, 2.5_wp*w, 2, laid)
      call t%is_true(laid%way == 2 .and. laid%error < 1.0e-2_wp*real(n, wp), 'another output point comes near')
      laid = laid_t()
      call match_ring(ring, path, spread((1.0_wp, 0.0_wp), 1, steps), spread((0.0_wp, 1.0_wp), 1, steps), w, 2, laid)
      call t%is_true(laid%error >= huge(1.0_wp), 'what stands still passes nothing')
      call set_points(real(points(:n/2), wp), aimag(points(:n/2)), [(1.0_wp, k=1, n/2)], path)
      call prepare_ring(path, ring)
      call t%is_true(.not. ring%applies, 'half of the curve is no ring')
   end subroutine rings

   !> Reference numbers of a closed form evaluated apart from this program, to ten digits.
   subroutine coupler()
      type(path_timing_t) :: shape
      complex(wp) :: e(1), v(1), turn(1), grow(1, 3)
      real(wp), parameter :: digits = 1.0e-6_wp

      shape = path_timing_t(g=2.0_wp, sigma=1.2_wp, q=0.3_wp)
      call trace_coupler(shape, [degrees_per_radian], e, v, turn, grow)
      call near(v(1), (1.78925607818_wp, 0.77528232708_wp), 1.0e-11_wp, 'the coupler')
      call near(turn(1), (0.175271_wp, -0.404504_wp), digits, 'its derivative by the crank')
      call near(grow(1, 1), (1.162828_wp, 1.089156_wp), digits, 'by the ground')
      call near(grow(1, 2), (1.278669_wp, 1.576371_wp), digits, 'by the sum of coupler and follower')
      call near(grow(1, 3), (0.840236_wp, -0.681555_wp), digits, 'by their difference')
      shape%side = -1.0_wp
      call trace_coupler(shape, [-degrees_per_radian], e, v)
      call near(v(1), (1.78925607818_wp, -0.77528232708_wp), 1.0e-11_wp, 'the mirror image: other assembly, other way round')
   end subroutine coupler

   !> A parallelogram that passes its change points: the coupler stays parallel to the ground.
   subroutine change_point()
      type(path_timing_t) :: shape
      complex(wp) :: e(36), v(36)

      shape = path_timing_t(g=2.0_wp, sigma=1.0_wp, q=1.0_wp)
      call trace_coupler(shape, [(full_turn*real(i, wp)/36.0_wp, i=1, 36)], e, v)
      ! right of the line for half a turn, left of it for the other: the coupler's projection alone is 2 throughout
      call t%is_true(all(abs(real(v(:17), wp) - 2.0_wp) < 1.0e-13_wp), 'change points: the coupler of a parallelogram')
      call t%is_true(all(abs(abs(v) - 2.0_wp) < 1.0e-13_wp), 'change points: its length')
   end subroutine change_point

   !> Against differences, over random shapes.
   subroutine derivatives()
      type(path_timing_t) :: shape, more, less
      type(xoshiro_t) :: random
      complex(wp) :: e(1), v(1), turn(1), grow(1, 3), after(1), before(1), want
      real(wp) :: u(4), step, worst, reach
      integer :: k, m

      call random%seed(7, purpose_starts)
      step = epsilon(1.0_wp)**(1.0_wp/3.0_wp)
      worst = 0.0_wp
      do k = 1, 200
         do m = 1, 4
            call random%next(u(m))
         end do
         shape = path_timing_t(g=0.3_wp + 3.0_wp*u(1), sigma=1.05_wp + u(2), q=1.6_wp*u(3) - 0.8_wp)
         if (abs(shape%g - 1.0_wp) < 0.1_wp) cycle
         call trace_coupler(shape, full_turn*u(4:), e, v, turn, grow)
         do m = 1, 4
            more = shape
            less = shape
            reach = 0.0_wp
            want = turn(1)
            if (m < 4) want = grow(1, min(m, 3))
            select case (m)
            case (1)
               more%g = shape%g*exp(step)
               less%g = shape%g*exp(-step)
            case (2)
               more%sigma = shape%sigma*exp(step)
               less%sigma = shape%sigma*exp(-step)
            case (3)
               more%q = shape%q + step
               less%q = shape%q - step
            case default
               reach = step*degrees_per_radian
            end select
            call trace_coupler(more, full_turn*u(4:) + reach, e, after)
            call trace_coupler(less, full_turn*u(4:) - reach, e, before)
            worst = max(worst, abs((after(1) - before(1))/(2.0_wp*step) - want)/(1.0_wp + abs(want)))
         end do
      end do
      call t%is_true(worst < 1000.0_wp*step**2, 'derivatives of the coupler against differences')
   end subroutine derivatives

   !> The least-squares problem of pivot, crank and coupler point, and what makes it a least one.
   subroutine linear_unknowns()
      type(fitted_path_t) :: path
      type(path_workspace_t) :: work
      type(path_timing_t) :: timing
      complex(wp) :: e(18), v(18), miss(18)

      call prepare_path(x, y, even, none, box, 1.0_wp, 1.0_wp, path, work)
      timing = path_timing_t(g=2.0_wp, sigma=1.2_wp, q=0.3_wp)
      timing%t = [(-20.0_wp*real(i - 1, wp), i=1, 18)]
      call trace_coupler(timing, timing%t, e, v)
      call fit_linear(path, e, v, timing, 0.0_wp)
      call near(path%size*(timing%z0 + path%centre), (-0.7458094018_wp, 0.2076158137_wp), 1.0e-9_wp, 'pivot')
      call near(path%size*timing%w1, (0.3567752003_wp, 0.1380722310_wp), 1.0e-9_wp, 'crank and ground line')
      call near(path%size*timing%w2, (0.5726631487_wp, -0.2097750781_wp), 1.0e-9_wp, 'coupler point')
      miss = timing%z0 + timing%w1*e + timing%w2*v - path%point
      call t%close_to(path%size**2*sum(real(miss, wp)**2 + aimag(miss)**2), 0.258055212_wp, 1.0e-8_wp, 'error of the linear fit')
      call t%is_true(abs(sum(conjg(e)*miss)) < 1.0e-12_wp .and. abs(sum(conjg(v)*miss)) < 1.0e-12_wp .and. &
                     abs(sum(miss)) < 1.0e-12_wp, 'errors are at right angles to the unknowns')
   end subroutine linear_unknowns

   !> The best known linkage for the 18 points, from five seeds; its bounds, order and turn.
   subroutine searches()
      type(fitted_path_t) :: path
      type(path_workspace_t) :: work
      type(path_timing_t) :: best, timing
      type(xoshiro_t) :: random
      integer :: seed, batch, reached
      real(wp), parameter :: known = 0.001772854210_wp

      call prepare_path(x, -y, even, none, box, 1.0_wp, 1.0_wp, path, work) ! mirrored: the crank falls
      reached = 0
      allocate (timing%t(18), source=0.0_wp)
      do seed = 1, 3
         call random%seed(seed, purpose_starts)
         best%error = huge(1.0_wp)
         do batch = 1, 100
            call random%use_stream(batch)
            call search_batch([path], random, work, timing)
            if (timing%worst > 1.0e-6_wp .or. timing%error > best%error) cycle
            best = timing
            if (best%error*path%size**2 < 1.001_wp*known) exit
         end do
         if (best%error*path%size**2 < 1.001_wp*known) reached = reached + 1
         call t%is_true(best%error*path%size**2 > 0.9999_wp*known, 'no linkage beats the best known')
         call t%is_true(all(best%t(2:) >= best%t(:17)) .and. best%t(18) - best%t(1) <= full_turn*(1.0_wp + 1.0e-12_wp), &
                        'the inputs rise, within one turn')
         call t%is_true(all(path%size*lengths_of(path, best) <= box*(1.0_wp + 1.0e-5_wp)), 'the bounds are kept')
         call t%is_true(best%sigma >= 1.0_wp .and. abs(best%q) <= 1.0_wp, 'the crank turns fully')
      end do
      call t%equal_integer(reached, 3, 'the best known linkage of the 18 points is found')
   end subroutine searches

   !> With a limit of the transmission angle no position of the turn passes it.
   subroutine transmission()
      type(fitted_path_t) :: path
      type(path_workspace_t) :: work
      type(path_timing_t) :: timing
      type(xoshiro_t) :: random
      complex(wp) :: e(360), v(360)
      real(wp) :: coupler, follower, cosine(360)
      real(wp), parameter :: least = 0.5_wp ! cosine of 60 degrees
      integer :: batch, kept

      call prepare_path(x, -y, even, none, box, least, 1.0_wp, path, work)
      allocate (timing%t(18), source=0.0_wp)
      call random%seed(1, purpose_starts)
      kept = 0
      do batch = 1, 12
         call random%use_stream(batch)
         call search_batch([path], random, work, timing)
         if (timing%worst > 1.0e-6_wp) cycle
         kept = kept + 1
         call trace_coupler(timing, [(real(i, wp), i=1, 360)], e, v)
         coupler = 0.5_wp*((timing%g + 1.0_wp)*timing%sigma + (timing%g - 1.0_wp)*timing%q)
         follower = 0.5_wp*((timing%g + 1.0_wp)*timing%sigma - (timing%g - 1.0_wp)*timing%q)
         cosine = (coupler**2 + follower**2 - abs(timing%g - e)**2)/(2.0_wp*coupler*follower)
         call t%is_true(maxval(abs(cosine)) <= least*(1.0_wp + 1.0e-5_wp), 'the least transmission angle is kept over the turn')
         call t%is_true(all(abs(abs(v) - coupler) < 1.0e-9_wp*coupler), 'the coupler keeps its length')
      end do
      call t%is_true(kept > 4, 'linkages with good transmission are found')
   end subroutine transmission

   !> Shapes that keep a limit against the law of cosines, where the joints are nearest and farthest; slopes against differences.
   subroutine shapes_at_the_limits()
      type(fitted_path_t) :: path
      type(path_timing_t) :: shape, more, less
      type(xoshiro_t) :: random
      real(wp) :: u(4), values(2), slopes(3, 2), after(2), before(2), unused(3, 2), coupler, follower, step, worst, steepest
      integer :: k, m, moved

      call random%seed(11, purpose_starts)
      step = epsilon(1.0_wp)**(1.0_wp/3.0_wp)
      worst = 0.0_wp
      steepest = 0.0_wp
      moved = 0
      do k = 1, 500
         do m = 1, 4
            call random%next(u(m))
         end do
         path%cosine = 0.3_wp + 0.69_wp*u(4)
         shape = path_timing_t(g=0.2_wp + 4.0_wp*u(1), sigma=1.0_wp + u(2)**3, q=2.0_wp*u(3) - 1.0_wp)
         if (abs(shape%g - 1.0_wp) < 0.01_wp) cycle
         less = shape
         call keep_angles(path, shape)
         if (abs(shape%sigma - less%sigma) + abs(shape%q - less%q) + abs(shape%g - less%g) > 0.0_wp) moved = moved + 1
         coupler = 0.5_wp*((shape%g + 1.0_wp)*shape%sigma + (shape%g - 1.0_wp)*shape%q)
         follower = 0.5_wp*((shape%g + 1.0_wp)*shape%sigma - (shape%g - 1.0_wp)*shape%q)
         associate (cosines => [(coupler**2 + follower**2 - (shape%g - 1.0_wp)**2)/(2.0_wp*coupler*follower), &
                                (coupler**2 + follower**2 - (shape%g + 1.0_wp)**2)/(2.0_wp*coupler*follower)])
            worst = max(worst, maxval(abs(cosines)) - path%cosine)
         end associate
         more = shape
         call keep_angles(path, more)
         call t%is_true(abs(more%sigma - shape%sigma) + abs(more%q - shape%q) <= 1.0e-7_wp, 'what keeps them stays')
         call angle_limits(path, shape, values, slopes)
         do m = 1, 3
            more = shape
            less = shape
            select case (m)
            case (1)
               more%g = shape%g*exp(step)
               less%g = shape%g*exp(-step)
            case (2)
               more%sigma = shape%sigma*exp(step)
               less%sigma = shape%sigma*exp(-step)
            case default
               more%q = shape%q + step
               less%q = shape%q - step
            end select
            call angle_limits(path, more, after, unused)
            call angle_limits(path, less, before, unused)
            after = (after - before)/(2.0_wp*step)
            steepest = max(steepest, maxval(abs(after - slopes(m, :))/(1.0_wp + abs(slopes(m, :)))))
         end do
      end do
      call t%is_true(moved > 100, 'many shapes are moved to the limits')
      call t%is_true(worst < 1.0e-12_wp, 'and keep them')
      call t%is_true(steepest < 1.0e5_wp*step**2, 'slopes of the limits against differences')
   end subroutine shapes_at_the_limits

   !> Twenty points (`data/paths/yu20a_angle.nml`): with a least angle of 40 degrees the best known linkage is at the limit twice a
   !> turn, its sum of squares found by other programs. A wider limit, from the same random numbers, is never worse.
   subroutine both_limits()
      type(fitted_path_t) :: paths(2)
      type(path_workspace_t) :: work
      type(path_timing_t) :: timing
      type(xoshiro_t) :: random
      real(wp), parameter :: points_x(20) = [-27.0_wp, -21.857_wp, -16.7_wp, -11.571_wp, -6.428_wp, -1.285_wp, 3.857_wp, 9.0_wp, &
                                             15.0_wp, 20.0_wp, 27.2_wp, 29.2_wp, 28.0_wp, 22.7_wp, 15.0_wp, 5.0_wp, -10.0_wp, &
                                             -22.0_wp, -28.0_wp, -29.0_wp]
      real(wp), parameter :: points_y(20) = [1.0_wp, -3.214_wp, -7.428_wp, -11.642_wp, -15.857_wp, -20.071_wp, -24.285_wp, &
                                             -28.5_wp, -29.9_wp, -30.0_wp, -25.0_wp, -20.0_wp, -10.0_wp, 2.0_wp, 10.6_wp, 16.5_wp, &
                                             19.6_wp, 17.0_wp, 11.0_wp, 5.0_wp]
      real(wp), parameter :: low(6) = [0.1_wp, 0.1_wp, 0.1_wp, 0.1_wp, 0.0_wp, 0.0_wp], high(6) = 500.0_wp
      real(wp), parameter :: known = 1.4555_wp
      integer, parameter :: least(*) = [60, 50, 45, 42, 40, 39, 38, 30, 10], asked = 40 ! degrees
      real(wp) :: cosine
      real(wp) :: found, before
      integer :: seed, batch, k

      allocate (timing%t(20), source=0.0_wp)
      do seed = 1, 5
         before = 0.5_wp*huge(before)
         do k = 1, size(least)
            if (seed > 1 .and. least(k) /= asked) cycle
            cosine = cos(real(least(k), wp)/degrees_per_radian)
            call prepare_path(points_x, points_y, spread(1.0_wp, 1, 20), low, high, cosine, 1.0_wp, paths(1), work)
            call prepare_path(points_x, -points_y, spread(1.0_wp, 1, 20), low, high, cosine, -1.0_wp, paths(2), work)
            call random%seed(seed, purpose_starts)
            found = huge(found)
            do batch = 1, 20
               call random%use_stream(batch)
               call search_batch(paths, random, work, timing)
               if (timing%worst <= 1.0e-6_wp) found = min(found, timing%error*paths(1)%size**2)
            end do
            call t%is_true(found <= before*(1.0_wp + 1.0e-6_wp), 'a wider limit of the transmission angle is never worse')
            before = found
            if (least(k) /= asked) cycle
            call t%is_true(found <= 1.01_wp*known, 'the best linkage at both limits is found')
            call t%is_true(found >= 0.999_wp*known, 'and none beats the best known')
         end do
      end do
   end subroutine both_limits

   subroutine near(got, want, tolerance, law)
      complex(wp), intent(in) :: got, want
      real(wp), intent(in) :: tolerance
      character(*), intent(in) :: law

      call t%close_to(real(got, wp), real(want, wp), tolerance, law//', real part')
      call t%close_to(aimag(got), aimag(want), tolerance, law//', imaginary part')
   end subroutine near
end program test_free_path
