!> Exact synthesis: dyads against the circle they are to describe, counts of solutions, cognates that draw one curve.
program test_exact
   use check, only: checks_t
   use psalm_angles, only: unit_vector
   use psalm_burmester, only: curve_point_t, pin_pair_t, dyads_t, five_poses, four_poses_curve, pin_for_pivot, &
                              polynomial_roots, slider_pin
   use psalm_certificate, only: certificate_t, certify_poses
   use psalm_defects, only: exact_linkage_t, verdict_t, cognates_of, assess, place_pins
   use psalm_exact_text, only: write_generator
   use psalm_function_points, only: generators_t, generator_t, plain_point, five_points, four_points, output_of, three_points
   use psalm_generic, only: generic_solutions
   use psalm_generic_counts, only: solutions_of
   use psalm_kinds, only: wp, full_turn, radians_per_degree
   use psalm_leg_lanes, only: problem_path_t
   use psalm_leg_problem, only: draw_problem, kind_point, kind_pose, kind_timed, leg_problem_t, make_problem, &
                               most_points, variables
   use psalm_monodromy, only: generic_t, solve_generic
   use psalm_quad_path, only: follow_precisely, path_arrived
   use psalm_six_bar_paths, only: polish
   use psalm_six_bar_problem, only: draw_six_bar, make_six_bar_problem, most_unknowns, order_legs, six_bar_data_t, &
                                    six_bar_problem_t, stephenson_2, stephenson_3, at_output, at_first_arm
   use psalm_six_bars, only: closing_links, find_stephenson, find_watt, most_links, six_bar_output, six_bar_t, six_bars_t
   use psalm_start_text, only: decode, decode_short, encode, encode_short
   use psalm_symmetric_points, only: leave_a_curve
   use psalm_text, only: text_t, to_text
   use psalm_tracker, only: track, tracked_t
   use psalm_desired_function, only: function_kind, desired_function_t
   use psalm_xoshiro, only: purpose_starts, xoshiro_t
   implicit none (type, external)
   type(checks_t) :: t
   real(wp), parameter :: tight = 1.0e-11_wp

   call five()
   call poses_close_to_each_other()
   call four()
   call small_and_large()
   call functions()
   call drawing_of_two_assemblies()
   call six_bars()
   call exchanged_legs()
   call counts()
   call every_count()
   call terms_along()
   call symmetric_tangents()
   call certificates()
   call cognates()
   call defects()
   call texts()
   call t%report()

contains

   !> Poses of a page of references.
   subroutine poses(d, g)
      complex(wp), intent(out) :: d(4), g(4)
      real(wp), parameter :: angle(4) = [-95.0_wp, 3.0_wp, -88.0_wp, 37.0_wp]
      real(wp) :: c, s
      integer :: j

      d = [(-0.22_wp, 0.35_wp), (-1.71_wp, 1.56_wp), (-1.97_wp, -0.05_wp), (-0.22_wp, 1.5_wp)]
      do j = 1, 4
         call unit_vector(angle(j), c, s)
         g(j) = cmplx(c, s, wp) - 1.0_wp
      end do
   end subroutine poses

   !> Largest change of the distance of a pin from its pivot.
   real(wp) function change_of(d, g, dyad)
      complex(wp), intent(in) :: d(:), g(:)
      type(pin_pair_t), intent(in) :: dyad

      change_of = maxval(abs(abs(d + (1.0_wp + g)*dyad%pin - dyad%pivot) - abs(dyad%pin - dyad%pivot)))
   end function change_of

   subroutine five()
      complex(wp) :: d(4), g(4)
      type(dyads_t) :: dyads
      integer :: k

      call poses(d, g)
      call five_poses(d, g, dyads)
      call t%equal_integer(dyads%count, 4, 'five poses: four dyads')
      do k = 1, dyads%count
         call t%close_to(change_of(d, g, dyads%list(k)), 0.0_wp, tight, 'five poses: the pin moves on a circle')
      end do
      ! a body that slides along without turning: every point is as good as any other
      call five_poses(d, spread((0.0_wp, 0.0_wp), 1, 4), dyads)
      call t%is_true(dyads%degenerate, 'five poses without turns are degenerate')
      ! a body that turns about a fixed point: every point moves on a circle about it
      call five_poses(-(0.7_wp, -0.3_wp)*g, g, dyads)
      call t%is_true(dyads%degenerate, 'five poses about one pivot are degenerate')
      ! a trammel: two points at a distance of 1 stay on two lines at right angles, the reference point on one of them; so do all
      ! points of the circle of which they are a diameter. Inverted, lines of the body pass through the points of a fixed circle
      d = cmplx(real(cmplx(cos(0.3_wp), sin(0.3_wp), wp)*(1.0_wp + conjg(g)), wp) - cos(0.3_wp), 0.0_wp, wp)
      call five_poses(d, g, dyads)
      call t%is_true(dyads%degenerate, 'five poses of a trammel are degenerate')
      call five_poses(-d/(1.0_wp + g), conjg(g), dyads)
      call t%is_true(dyads%degenerate, 'five poses of an inverted trammel are degenerate')
      d(2) = d(1)
      g(2) = g(1)
      call five_poses(d, g, dyads)
      call t%is_true(dyads%degenerate, 'equal poses are degenerate')
   end subroutine five

   !> Where the body hardly turns the equations say little of its pins, but what is found of them must be exact.
   subroutine poses_close_to_each_other()
      integer, parameter :: tries = 20000
      real(wp), parameter :: part = 0.005_wp            ! of a turn, and of the length 1
      complex(wp) :: d(4), g(4)
      type(dyads_t) :: dyads
      type(xoshiro_t) :: random
      real(wp) :: draw(3), worst
      integer :: i, j, k, found

      call random%seed(4, purpose_starts)
      worst = 0.0_wp
      found = 0
      do i = 1, tries
         do j = 1, 4
            do k = 1, 3
               call random%next(draw(k))
            end do
            draw = part*(draw - 0.5_wp)
            d(j) = cmplx(draw(1), draw(2), wp)
            draw(3) = full_turn*draw(3)*radians_per_degree
            g(j) = cmplx(-2.0_wp*sin(0.5_wp*draw(3))**2, sin(draw(3)), wp)
         end do
         call five_poses(d, g, dyads)
         found = found + dyads%count
         do k = 1, dyads%count
            worst = max(worst, change_of(d, g, dyads%list(k))/(abs(dyads%list(k)%pin) + abs(dyads%list(k)%pivot)))
         end do
      end do
      call t%is_true(found > tries, 'poses close to each other: there are dyads', to_text(found))
      call t%close_to(worst, 0.0_wp, 1.0e-14_wp, 'poses close to each other: pins move on circles')
   end subroutine poses_close_to_each_other

   !> The point that is on a line in four poses, of bodies of all sizes.
   subroutine small_and_large()
      complex(wp) :: d(4), g(4), pin, own
      logical :: exists
      integer :: power

      call poses(d, g)
      call slider_pin(d(:3), g(:3), pin, exists)
      do power = -15, 15, 6
         call slider_pin(10.0_wp**power*d(:3), g(:3), own, exists)
         call t%is_true(exists, 'four poses: a pin on a line, lengths times 10**'//to_text(power))
         call t%close_to(abs(own/10.0_wp**power - pin), 0.0_wp, tight, &
                         'four poses: the same pin, lengths times 10**'//to_text(power))
      end do
   end subroutine small_and_large

   subroutine four()
      complex(wp) :: d(4), g(4), pin, along, moved(3)
      type(curve_point_t) :: points(2)
      type(pin_pair_t) :: dyad
      real(wp) :: worst, c, s
      logical :: exists
      integer :: i, k, found

      call poses(d, g)
      worst = 0.0_wp
      found = 0
      do i = 1, 36
         call unit_vector(5.0_wp*real(i, wp), c, s)
         call four_poses_curve(d(:3), g(:3), cmplx(c, s, wp), points)
         do k = 1, 2
            if (.not. points(k)%exists) cycle
            found = found + 1
            worst = max(worst, change_of(d(:3), g(:3), points(k)%dyad)/(1.0_wp + abs(points(k)%dyad%pin)))
         end do
      end do
      call t%is_true(found > 20, 'four poses: the curve is there', to_text(found))
      call t%close_to(worst, 0.0_wp, 1.0e-9_wp, 'four poses: pins of the curve move on circles')
      call slider_pin(d(:3), g(:3), pin, exists)
      along = d(1) + pin*g(1)
      worst = maxval(abs(aimag(conjg(along)*(d(:3) + pin*g(:3)))))
      call t%is_true(exists, 'four poses: there is a pin on a line')
      call t%close_to(worst, 0.0_wp, tight, 'four poses: that pin moves on a line')
      ! a pose with the orientation of the first one: its pole with that is at infinity
      call slider_pin(d(:3), [(0.0_wp, 0.0_wp), g(2:3)], pin, exists)
      moved = d(:3) + pin*[(0.0_wp, 0.0_wp), g(2:3)]
      call t%is_true(exists, 'four poses, two of one orientation: there is a pin on a line')
      call t%close_to(maxval(abs(aimag(conjg(moved(1))*moved))), 0.0_wp, tight, &
                      'four poses, two of one orientation: it moves on a line')
      dyad%pivot = (0.3_wp, -0.4_wp)
      call pin_for_pivot(d(:2), g(:2), dyad, exists)
      call t%is_true(exists, 'three poses: a pivot has its pin')
      call t%close_to(change_of(d(:2), g(:2), dyad), 0.0_wp, tight, 'three poses: the pin moves about its pivot')
   end subroutine four

   subroutine functions()
      real(wp), parameter :: phi(5) = [2.0_wp, 18.0_wp, 45.0_wp, 70.0_wp, 88.0_wp]*radians_per_degree
      real(wp), parameter :: psi(5) = [1.7_wp, 14.5_wp, 37.0_wp, 63.0_wp, 87.0_wp]*radians_per_degree
      type(generators_t) :: found
      type(generator_t) :: one
      real(wp) :: worst
      logical :: exists
      integer :: k, i, valid

      valid = 0
      worst = 0.0_wp
      do i = 1, 2
         call five_points(plain_point(phi, psi), i == 2, found)
         do k = 1, found%count
            one = found%list(k)
            if (one%assembly == 0) cycle
            valid = valid + 1
            worst = max(worst, error_at_points(one, phi, psi))
         end do
         call t%is_true(found%count == 1 .or. found%count == 3, 'functions: one or three linkages', to_text(found%count))
      end do
      call t%is_true(valid > 0, 'functions: one stays in its assembly')
      call t%close_to(worst, 0.0_wp, 1.0e-10_wp, 'functions: five points are met')
      ! four of the five with a zero line of a linkage known
      call five_points(plain_point(phi, psi), .false., found)
      one = found%list(1)
      do i = 1, 2
         call four_points(plain_point(phi(:4), psi(:4)), .false., i == 2, merge(one%psi0, one%phi0, i == 2), found)
         worst = huge(1.0_wp)
         do k = 1, found%count
            worst = min(worst, abs(found%list(k)%r2 - one%r2) + abs(found%list(k)%r3 - one%r3) + abs(found%list(k)%r4 - one%r4))
         end do
         call t%close_to(worst, 0.0_wp, 1.0e-9_wp, 'functions: four points and a zero line')
      end do
      call three_points(plain_point(phi(:3) + 1.0_wp, psi(:3) + 0.7_wp), one, exists)
      call t%is_true(exists, 'functions: three points')
      worst = 0.0_wp
      if (one%assembly /= 0) worst = error_at_points(one, phi(:3) + 1.0_wp, psi(:3) + 0.7_wp)
      call t%close_to(worst, 0.0_wp, 1.0e-10_wp, 'functions: three points are met')
   end subroutine functions

   !> A linkage whose points lie on both assemblies is drawn at its first point, and its links have their lengths there.
   subroutine drawing_of_two_assemblies()
      real(wp), parameter :: frame = 3.0_wp
      type(generator_t) :: one
      real(wp) :: phi(3), psi(3), x(4), y(4)
      logical :: closes, slides
      integer :: k, side

      do side = 1, -1, -2
         do k = 1, 2
            slides = k == 2
            one = generator_t(slides=slides, r2=0.4_wp, r3=1.1_wp, r4=merge(0.2_wp, 0.9_wp, slides), phi0=0.5_wp, psi0=0.3_wp)
            phi = [0.2_wp, 0.9_wp, 1.5_wp]
            one%assembly = -side
            call output_of(one, phi(2), psi(2), closes)
            one%assembly = side
            call output_of(one, phi(1), psi(1), closes)
            call output_of(one, phi(3), psi(3), closes)
            one%assembly = 0
            call draw(one, frame, phi, psi, x(:4 - merge(1, 0, slides)), y(:4 - merge(1, 0, slides)))
            if (slides) then
               call t%close_to(norm2([x(3) - x(2), y(3) - y(2)]), one%r3, tight, 'two assemblies: coupler of a slider-crank')
               call t%close_to(x(3), psi(1) - one%psi0, tight, 'two assemblies: slider of a slider-crank')
            else
               call t%close_to(norm2([x(4) - x(3), y(4) - y(3)]), frame*one%r3, tight, 'two assemblies: coupler of a four-bar')
               call t%close_to(modulo(atan2(y(4) - y(2), x(4) - x(2)) - psi(1) - one%psi0 + 3.0_wp, &
                                      full_turn*radians_per_degree), 3.0_wp, tight, 'two assemblies: follower of a four-bar')
            end if
         end do
      end do
   end subroutine drawing_of_two_assemblies

   !> Joints of the case that is written of a linkage.
   subroutine draw(one, frame, phi, psi, x, y)
      type(generator_t), intent(in) :: one
      real(wp), intent(in) :: frame, phi(:), psi(:)
      real(wp), intent(out) :: x(:), y(:)
      type(text_t) :: text
      character(:), allocatable :: words
      integer :: at

      call write_generator('title', one, frame, phi, psi, 0, text)
      words = text%content()
      at = index(words, 'JX=')
      read (words(at + 3:), *) x
      at = index(words, 'JY=')
      read (words(at + 3:), *) y
   end subroutine draw

   !> A driver whose two closing links are known from elsewhere, and searches over a coarse grid.
   subroutine six_bars()
      real(wp), parameter :: phi(5) = [10.0_wp, 32.0_wp, 55.0_wp, 78.0_wp, 100.0_wp]*radians_per_degree
      real(wp), parameter :: psi(5) = [0.0_wp, 12.0_wp, 27.0_wp, 45.0_wp, 66.0_wp]*radians_per_degree
      type(six_bar_t) :: links(most_links)
      type(six_bars_t) :: found
      type(desired_function_t) :: wanted
      real(wp) :: worst, got, sine
      logical :: closes
      integer :: count_of_links, i, k

      call closing_links(generator_t(r2=0.4_wp, r3=1.1_wp, r4=0.9_wp, phi0=0.5_wp, assembly=1), (1.2_wp, -0.9_wp), phi, psi, &
                         links, count_of_links, closes)
      call t%is_true(closes, 'Stephenson III: the driver closes')
      call t%equal_integer(count_of_links, 2, 'Stephenson III: two closing links')
      call t%close_to(minval(abs(links(:2)%link - 0.634965126_wp)), 0.0_wp, 1.0e-8_wp, 'Stephenson III: one link')
      call t%close_to(minval(abs(links(:2)%link - 3.03080461_wp)), 0.0_wp, 1.0e-7_wp, 'Stephenson III: the other')
      call t%close_to(minval(abs(links(:2)%coupler_pin - (0.75866339_wp, -1.78243831_wp))), 0.0_wp, 1.0e-7_wp, &
                      'Stephenson III: its pin on the coupler')
      wanted%kind = function_kind('TABLE')
      wanted%continuous = .false.
      do k = 1, 2
         if (k == 1) call find_stephenson(wanted, phi, psi, 2, 3, 1.0_wp, 100.0_wp, found)
         if (k == 2) call find_watt(wanted, phi, psi, 3, 3, 1.0_wp, 100.0_wp, found)
         call t%is_true(size(found%best) > 0, 'six-bars: some are found', to_text(found%valid))
         worst = 0.0_wp
         do i = 1, size(found%best)*size(phi)
            call six_bar_output(found%best(1 + (i - 1)/size(phi)), phi(1 + modulo(i - 1, size(phi))), got, sine, closes)
            worst = max(worst, abs(sin(0.5_wp*(got - psi(1 + modulo(i - 1, size(phi)))))))
         end do
         call t%close_to(worst, 0.0_wp, 1.0e-8_wp, 'six-bars: five points are met')
      end do
   end subroutine six_bars

   !> Largest error of a linkage at points.
   real(wp) function error_at_points(own, phi, psi)
      type(generator_t), intent(in) :: own
      real(wp), intent(in) :: phi(:), psi(:)
      real(wp) :: got
      logical :: closes
      integer :: j

      error_at_points = 0.0_wp
      do j = 1, size(phi)
         call output_of(own, phi(j), got, closes)
         if (own%slides) then
            error_at_points = max(error_at_points, abs(got - psi(j)))
         else
            error_at_points = max(error_at_points, abs(sin(0.5_wp*(got - psi(j)))))
         end if
      end do
   end function error_at_points

   !> Four dyads make twelve labelled four-bars: the same number from the general system, by loops.
   subroutine counts()
      type(leg_problem_t) :: problem
      type(generic_t) :: generic
      complex(wp) :: roots(3)
      integer :: k

      call make_problem([kind_pose, kind_pose, kind_pose, kind_pose], .false., .false., .false., problem)
      call t%is_true(problem%is_square(), 'five poses: as many conditions as dimensions')
      call generic_solutions(problem, 12, generic)
      call t%equal_integer(size(generic%solutions, 2), 12, 'five poses: twelve labelled solutions, none of them kept')
      call solve_generic(problem, 2, .false., 12, generic)
      call t%equal_integer(size(generic%solutions, 2), 12, 'five poses: twelve labelled solutions by monodromy')
      call t%equal_integer(size(generic%solutions, 1), variables, 'five poses: numbers of a solution')
      call make_problem(spread(kind_point, 1, 7), .true., .false., .false., problem)
      call generic_solutions(problem, 558, generic)
      call t%equal_integer(size(generic%solutions, 2), 558, 'eight points by a slider-crank: 558 kept solutions')
      call t%equal_integer(generic%loops, 0, 'eight points by a slider-crank: found without a loop')
      call make_problem([kind_pose, kind_pose, (kind_point, k=1, 4)], .false., .false., .false., problem)
      call generic_solutions(problem, 402, generic)
      call t%equal_integer(size(generic%solutions, 2), 402, 'three poses and four points: 402 solutions of the kept ones')
      call polynomial_roots([(-6.0_wp, 0.0_wp), (11.0_wp, 0.0_wp), (-6.0_wp, 0.0_wp), (1.0_wp, 0.0_wp)], roots)
      call t%close_to(real(sum(roots), wp), 6.0_wp, 1.0e-12_wp, 'roots of a cubic: 1, 2, 3')
      call t%close_to(minval(abs(roots - 2.0_wp)), 0.0_wp, 1.0e-12_wp, 'roots of a cubic: 2')
   end subroutine counts

   !> Each of the 153 numbers of solutions that are kept for terms along the path is that of a problem that is possible.
   subroutine every_count()
      type(leg_problem_t) :: problem
      integer :: known, kind, m, q, given, a, b, c, d, k
      logical :: crank, follower

      known = 0
      do given = 0, 4                          ! both pivots, one or none; a slide, alone or with the crank's pivot
         do k = 0, merge(1, 0, given == 4)
            crank = merge(k == 1, btest(given, 0), given == 4)
            follower = given < 4 .and. btest(given, 1)
            do kind = kind_pose, kind_timed
               ! timed points have the numbers of poses unless the follower's pivot is given
               if (kind == kind_timed .and. .not. follower) cycle
               ! either pivot alone is given: the same but of timed points
               if (kind == kind_pose .and. follower .and. .not. crank) cycle
               do m = merge(1, 0, kind == kind_timed), 4
                  do q = 0, most_points - m
                     ! terms at the first point and the others, tangents alone (a) or with curvatures (b), and at points (c, d)
                     do a = 0, merge(m + 1, 0, m > 0)
                        do b = 0, merge(m + 1 - a, 0, m > 0)
                           do c = 0, merge(q, q + 1, m > 0)
                              do d = 0, merge(q, q + 1, m > 0) - c
                                 if (a + b + c + d == 0 .or. m + q + a + c + 2*(b + d) > most_points) cycle
                                 call make_problem([spread(kind, 1, m), spread(kind_point, 1, q)], given == 4, crank, follower, &
                                                   problem, [at(0, a, b), at(merge(m + 1, 0, m > 0), c, d)])
                                 if (problem%is_square() .and. solutions_of(problem) > 0) known = known + 1
                              end do
                           end do
                        end do
                     end do
                  end do
               end do
            end do
         end do
      end do
      call t%equal_integer(known, 153, 'tangents: problems of which the number of solutions is known')
   end subroutine every_count

   !> Points from one on, some with one term along the path, then some with two.
   pure function at(first, once, twice)
      integer, intent(in) :: first, once, twice
      integer :: at(once + 2*twice), k

      at(:once) = [(first + k - 1, k=1, once)]
      at(once + 1:) = [(first + once + (k - 1)/2, k=1, 2*twice)]
   end function at

   !> Tangents and curvatures: as many solutions as the table says, for every way the legs are written; a solution ends at the same
   !> place in quadruple precision, where the equations are written otherwise.
   subroutine terms_along()
      type(leg_problem_t) :: problem
      type(generic_t) :: generic
      type(problem_path_t) :: path
      type(tracked_t) :: tracked
      type(xoshiro_t) :: random
      complex(wp) :: unused(variables), reached(variables)
      real(wp) :: worst
      integer :: k, i, outcome, winding, arrived
      logical :: drawn
      character(*), parameter :: what(6) = [character(40) :: 'points, both pivots given', 'poses, the crank''s pivot given', &
                                            'timed points, the follower''s pivot given', 'a slide and poses', &
                                            'a slide and timed points', 'three poses']

      do k = 1, size(what)
         select case (k)
         case (1)
            call make_problem([kind_point, kind_point], .false., .true., .true., problem, [0, 2])
         case (2)
            call make_problem([kind_pose, kind_point], .false., .true., .false., problem, [0, 1, 1])
         case (3)
            call make_problem([kind_timed, kind_point], .false., .false., .true., problem, [1, 2, 2])
         case (4)
            call make_problem([kind_pose, kind_point, kind_point], .true., .false., .false., problem, [1, 2, 2])
         case (5)
            call make_problem([kind_timed, kind_timed, kind_point], .true., .false., .false., problem, [0, 0])
         case default
            call make_problem([kind_pose, kind_pose], .false., .false., .false., problem, [0, 1, 1, 2])
         end select
         call t%is_true(problem%is_square(), 'tangents, '//trim(what(k))//': as many conditions as dimensions')
         call solve_generic(problem, 3, .false., solutions_of(problem), generic)
         call t%is_true(solutions_of(problem) > 0, 'tangents, '//trim(what(k))//': the number is known')
         call t%equal_integer(size(generic%solutions, 2), solutions_of(problem), 'tangents, '//trim(what(k))//': all solutions')
         call random%seed(4, purpose_starts)
         path%problem = problem
         path%from = generic%data
         call draw_problem(problem, random, path%to, unused, drawn)
         call t%is_true(drawn, 'tangents, '//trim(what(k))//': another problem')
         if (.not. drawn) cycle
         call track(path, generic%solutions(:, :2), tracked)
         worst = 0.0_wp
         arrived = 0
         do i = 1, 2
            call follow_precisely(path, 1.0_wp, generic%solutions(:, i), reached, outcome, winding)
            if (.not. tracked%arrived(i)) cycle
            arrived = arrived + 1
            if (outcome /= path_arrived) worst = huge(1.0_wp)
            worst = max(worst, maxval(abs(reached - tracked%ends(:, i)))/maxval(abs(reached)))
         end do
         call t%is_true(arrived > 0, 'tangents, '//trim(what(k))//': a path arrives')
         call t%close_to(worst, 0.0_wp, 1.0e-10_wp, 'tangents, '//trim(what(k))//': the same end in quadruple precision')
      end do
   end subroutine terms_along

   !> Points with tangents and curvatures that are symmetric about a line leave a curve of linkages, others do not.
   subroutine symmetric_tangents()
      complex(wp), parameter :: points(5) = [(-1.0_wp, 0.0_wp), (1.0_wp, 0.0_wp), (-0.6_wp, 0.7_wp), (0.6_wp, 0.7_wp), &
                                             (0.0_wp, 1.3_wp)], none(0) = [complex(wp) ::]
      complex(wp) :: along(5)
      real(wp) :: bend(5)
      logical :: is_bent(5)

      bend = 0.0_wp
      is_bent = .false.
      along = (0.0_wp, 0.0_wp)
      along(1:2) = [(0.6_wp, 0.8_wp), (-0.6_wp, 0.8_wp)]
      along(3:4) = [(0.8_wp, 0.6_wp), (0.8_wp, -0.6_wp)]
      call t%is_true(leave_a_curve(points, none, .false., along, bend, is_bent), 'symmetric tangents: a curve')
      along(4) = (0.8_wp, 0.6_wp)
      call t%is_true(.not. leave_a_curve(points, none, .false., along, bend, is_bent), 'tangents that are not: none')
      along(3:5) = [(0.0_wp, 0.0_wp), (0.0_wp, 0.0_wp), (1.0_wp, 0.0_wp)]
      is_bent(1:2) = .true.
      ! the second is the mirror image of the first, which bends the other way
      bend(1:2) = [0.3_wp, -0.3_wp]
      call t%is_true(leave_a_curve(points, none, .false., along, bend, is_bent), 'symmetric curvatures: a curve')
      along(2) = -along(2)
      call t%is_true(.not. leave_a_curve(points, none, .false., along, bend, is_bent), 'in the other sense: none')
      bend(2) = 0.3_wp
      call t%is_true(leave_a_curve(points, none, .false., along, bend, is_bent), 'in the other sense bent alike: a curve')
      along(5) = (0.6_wp, 0.8_wp)
      call t%is_true(.not. leave_a_curve(points, none, .false., along, bend, is_bent), 'not at right angles to the line: none')
   end subroutine symmetric_tangents

   !> Krawczyk's test of the dyads of five poses: it holds for those there are, not for what is none, nor where two are one.
   subroutine certificates()
      real(wp), parameter :: angle(0:4) = [0.0_wp, -95.0_wp, 3.0_wp, -88.0_wp, 37.0_wp]
      complex(wp) :: d(4), g(4), ends(4, 6), p(0:4)
      complex(wp) :: no_poles(0)
      integer :: no_pose(0)
      type(dyads_t) :: dyads
      type(certificate_t) :: certificate

      call poses(d, g)
      p = [(0.0_wp, 0.0_wp), d]
      call five_poses(d, g, dyads)
      ends(:, :4) = dyads%ends
      call certify_poses(p, angle, no_poles, no_pose, ends(:, :4), spread(.true., 1, 4), certificate)
      call t%is_true(certificate%holds(), 'certificate: four dyads')
      call t%equal_integer(certificate%real_ones, 4, 'certificate: all of them real')
      ends(:, 5) = ends(:, 2)
      ends(:, 6) = [(3.0_wp, 1.0_wp), (3.0_wp, -1.0_wp), (-7.0_wp, 5.0_wp), (-7.0_wp, -5.0_wp)]
      call certify_poses(p, angle, no_poles, no_pose, ends, spread(.true., 1, 6), certificate)
      call t%equal_integer(certificate%proven, 5, 'certificate: not of what is no solution')
      call t%equal_integer(certificate%apart, 3, 'certificate: the same twice is not apart')
      ! poses whose orientations are mirrored have two real dyads and two that are not
      d = conjg(d)
      d(1) = d(1) + (0.9_wp, 0.4_wp)
      p = [(0.0_wp, 0.0_wp), d]
      call five_poses(d, g, dyads)
      call t%is_true(dyads%imaginary > 0, 'five poses with dyads that are not real')
      call certify_poses(p, angle, no_poles, no_pose, dyads%ends, spread(.false., 1, 4), certificate)
      call t%equal_integer(certificate%proven, 4, 'certificate: of those that are not real too')
      call t%equal_integer(certificate%not_real, dyads%imaginary, 'certificate: they are not real')
      ! two poses that are one leave a curve of dyads
      d(2) = d(1)
      g(2) = g(1)
      p = [(0.0_wp, 0.0_wp), d]
      call certify_poses(p, [angle(0), angle(1), angle(1), angle(3), angle(4)], no_poles, no_pose, dyads%ends, &
                         spread(.false., 1, 4), certificate)
      call t%equal_integer(certificate%proven, 0, 'certificate: nothing where a whole curve is good')
   end subroutine certificates

   !> A crank-rocker at eight crank angles.
   subroutine crank_rocker(one)
      type(exact_linkage_t), intent(out) :: one
      complex(wp) :: diagonal, direction
      real(wp) :: c, s, cosine
      integer :: i

      one%a = (0.0_wp, 0.0_wp)
      one%b = (3.0_wp, 0.5_wp)
      allocate (one%p(8), one%c(8), one%d(8), one%turn(8))
      do i = 1, 8
         call unit_vector(45.0_wp*real(i - 1, wp), c, s)
         one%c(i) = cmplx(c, s, wp)
         diagonal = one%b - one%c(i)
         cosine = (abs(diagonal)**2 + 3.0_wp**2 - 2.5_wp**2)/(2.0_wp*3.0_wp*abs(diagonal))
         direction = diagonal/abs(diagonal)*cmplx(cosine, sqrt(1.0_wp - cosine**2), wp)
         one%d(i) = one%c(i) + 3.0_wp*direction
         one%p(i) = one%c(i) + (1.2_wp, 0.9_wp)*direction
         one%turn(i) = direction
      end do
      one%turn = one%turn/one%turn(1)
   end subroutine crank_rocker

   subroutine cognates()
      type(exact_linkage_t) :: one, others(2), placed
      type(verdict_t) :: own, other
      integer :: k

      call crank_rocker(one)
      call assess(one, .true., own)
      call cognates_of(one, others)
      do k = 1, 2
         call t%close_to(maxval(abs(abs(others(k)%c - others(k)%a) - abs(others(k)%c(1) - others(k)%a))), 0.0_wp, tight, &
                         'cognate: its crank keeps its length')
         call t%close_to(maxval(abs(abs(others(k)%d - others(k)%b) - abs(others(k)%d(1) - others(k)%b))), 0.0_wp, tight, &
                         'cognate: its follower keeps its length')
         placed = others(k)
         call place_pins(others(k)%c(1), others(k)%d(1), placed)
         call t%close_to(maxval(abs(placed%c - others(k)%c) + abs(placed%d - others(k)%d)), 0.0_wp, tight, &
                         'cognate: its coupler is rigid')
         call assess(others(k), .true., other)
         call t%is_true(own%circuit .eqv. other%circuit, 'cognate: the same circuit')
         call t%is_true(own%order .eqv. other%order, 'cognate: the same order')
      end do
   end subroutine cognates

   subroutine defects()
      type(exact_linkage_t) :: one
      type(verdict_t) :: verdict
      complex(wp) :: direction

      call crank_rocker(one)
      call assess(one, .true., verdict)
      call t%is_true(verdict%class == 1, 'a crank-rocker has no defect')
      ! by the law of cosines, where crank and frame are in line
      call t%close_to(cos(verdict%transmission*radians_per_degree), &
                      max(abs(15.25_wp - (sqrt(9.25_wp) - 1.0_wp)**2), abs(15.25_wp - (sqrt(9.25_wp) + 1.0_wp)**2))/15.0_wp, &
                      1.0e-12_wp, 'least transmission angle of a crank-rocker')
      one%c(3:4) = one%c([4, 3])
      one%d(3:4) = one%d([4, 3])
      one%p(3:4) = one%p([4, 3])
      one%turn(3:4) = one%turn([4, 3])
      call assess(one, .true., verdict)
      call t%is_true(verdict%class == 4, 'two points exchanged: a defect of order')
      call crank_rocker(one)
      ! the other assembly at one point
      direction = (one%b - one%c(5))/abs(one%b - one%c(5))
      one%d(5) = one%c(5) + direction*conjg((one%d(5) - one%c(5))/direction)
      call assess(one, .true., verdict)
      call t%is_true(verdict%class == 5 .and. .not. verdict%circuit, 'the other assembly of a crank-rocker: a defect of circuit')
   end subroutine defects

   !> Legs of Stephenson II exchanged are the same linkage: another solution, put into the same order. Where their numbers are given
   !> they are not, nor are those of other types.
   subroutine exchanged_legs()
      integer, parameter :: exchanged(*) = [2, 1, 3, 5, 4, 7, 6, 8, 10, 9]
      logical :: free(most_unknowns), given(most_unknowns), drawn
      type(six_bar_problem_t) :: problem
      type(six_bar_data_t) :: data
      type(xoshiro_t) :: random
      complex(wp) :: x(10, 2), polished(10, 2)
      real(wp) :: left(2)
      integer :: i

      free = .false.
      given = free
      given(at_output) = .true.
      call make_six_bar_problem(stephenson_2, 10, free, 0, problem)
      call random%seed(1, purpose_starts)
      do i = 1, 100
         call draw_six_bar(problem, random, data, x(:, 1), drawn)
         if (drawn) exit
      end do
      call t%is_true(drawn, 'a Stephenson II is drawn')
      if (.not. drawn) return
      x(:, 2) = x(exchanged, 1)
      polished = x
      call polish(problem, data, polished, left)
      call t%is_true(all(abs(polished - x) <= 1.0e-9_wp*(1.0_wp + abs(x))), 'with its legs exchanged it is a solution, too')
      call order_legs(problem, x)
      call t%is_true(all(abs(x(:, 1) - x(:, 2)) <= 0.0_wp), 'both have one order')
      call t%is_true(any([(all(abs(x(:, 1) - polished(:, i)) < 1.0e-9_wp), i=1, 2)]), 'which is that of one of them')
      x(:, 2) = x(exchanged, 1)
      call make_six_bar_problem(stephenson_2, 7, given, at_first_arm, problem)
      polished = x
      call order_legs(problem, x)
      call t%is_true(all(abs(x - polished) <= 0.0_wp), 'legs with a given length keep their order')
      call make_six_bar_problem(stephenson_3, 10, free, 0, problem)
      call order_legs(problem, x)
      call t%is_true(all(abs(x - polished) <= 0.0_wp), 'those of Stephenson III, too')
   end subroutine exchanged_legs

   subroutine texts()
      real(wp), parameter :: values(6) = [0.0_wp, 1.0_wp, -0.7312345678_wp, 1.0e-9_wp, -7.3e11_wp, 1.0_wp - epsilon(1.0_wp)]
      integer :: i

      do i = 1, size(values)
         call t%close_to(decode(encode(values(i)))/max(abs(values(i)), 1.0e-30_wp), values(i)/max(abs(values(i)), 1.0e-30_wp), &
                         2.0_wp**(-28), 'a number as text')
         call t%close_to(decode_short(encode_short(values(i)))/max(abs(values(i)), 1.0e-30_wp), &
                         values(i)/max(abs(values(i)), 1.0e-30_wp), 2.0_wp**(-22), 'a number as short text')
      end do
   end subroutine texts
end program test_exact
