!> Cost of exact synthesis on one thread; bench/exact compiles it with the modules of src/exact and writes doc/measured/exact.md.
!>
!> usage: exact [short]; short: one problem of each kind in place of many, no tables of six-bars and of generic problems
program exact
   use psalm_burmester, only: dyads_t, five_poses
   use psalm_certificate, only: certificate_t, certify_legs
   use psalm_careful_tracking, only: track_carefully
   use psalm_generic, only: generic_solutions
   use psalm_kinds, only: wp, pi, radians_per_degree
   use psalm_leg_lanes, only: problem_path_t
   use psalm_leg_problem, only: kind_point, kind_pose, kind_timed, leg_data_t, leg_problem_t, make_problem, most_points, &
                                random_unit, turns_of, variables
   use psalm_minimax, only: approximation_t, approximate
   use psalm_monodromy, only: add_distinct, generic_t, scale_problem, scale_solutions, solve_generic
   use psalm_nine_points, only: in_place, nine_point_orbits, nine_points_t, solve_nine_points
   use psalm_six_bars, only: find_stephenson, find_watt, six_bars_t
   use psalm_tracker, only: tracked_t
   use psalm_desired_function, only: function_kind, desired_function_t
   use psalm_xoshiro, only: purpose_starts, xoshiro_t
   implicit none (type, external)
   type(xoshiro_t) :: random
   integer :: problems = 200, pose_problems = 200000
   integer, parameter :: seed = 7
   character(8) :: word
   logical :: short

   call get_command_argument(1, word)
   short = word == 'short'
   if (short) then
      problems = 1
      pose_problems = 1000
   end if
   call random%seed(seed, purpose_starts)
   print '(a)', '# Exact synthesis, measured', '', 'Written by `bench/exact`: one thread, processor time.', ''
   call measure_nine_points()
   call measure_certificate()
   call measure_poses()
   call measure_functions()
   if (.not. short) then
      call measure_six_bars()
      call measure_rows()
   end if

contains

   real(wp) function deviate()
      call random%next(deviate)
   end function deviate

   !> Random problems: points of disturbed ovals, random points, points of a circle's arc disturbed by a tenth.
   subroutine measure_nine_points()
      type(nine_points_t) :: found
      complex(wp) :: p(0:8)
      real(wp) :: from, to, total, longest, turn
      integer :: k, i, whole, first, missing

      total = 0.0_wp
      longest = 0.0_wp
      whole = 0
      first = 0
      missing = 0
      do k = 1, problems
         do i = 0, 8
            select case (mod(k, 3))
            case (0)
               turn = 2.0_wp*pi*(real(i, wp) + 0.5_wp*deviate())/9.0_wp
               p(i) = cmplx((1.0_wp + 0.3_wp*deviate())*cos(turn), (0.6_wp + 0.3_wp*deviate())*sin(turn), wp)
            case (1)
               p(i) = cmplx(deviate(), deviate(), wp)
            case default
               turn = 0.3_wp*real(i, wp)
               p(i) = (1.0_wp + 0.1_wp*deviate())*cmplx(cos(turn), sin(turn), wp)
            end select
         end do
         call cpu_time(from)
         call solve_nine_points(p, 1, found)
         call cpu_time(to)
         total = total + to - from
         longest = max(longest, to - from)
         if (size(found%solutions, 2) == nine_point_orbits) then
            whole = whole + 1
            if (found%passes == 1) first = first + 1
         else
            missing = max(missing, nine_point_orbits - size(found%solutions, 2))
         end if
      end do
      print '(a)', '## Nine points', ''
      print '(i0,a,i0,a,i0,a)', problems, ' random problems (ovals, random points, arcs): ', whole, &
         ' complete (1442 ends), ', first, ' of them in the first pass;'
      print '(a,i0,a)', 'where it is not complete at most ', missing, ' ends are missing.'
      print '(a,f0.3,a,f0.3,a)', 'Mean ', total/real(problems, wp), ' s, longest ', longest, ' s.'
      print '(a)', ''
   end subroutine measure_nine_points

   !> Krawczyk's test of all ends of one problem.
   subroutine measure_certificate()
      complex(wp), parameter :: p(0:8) = [(0.25_wp, 0.0_wp), (0.52_wp, 0.1_wp), (0.8_wp, 0.7_wp), (1.2_wp, 1.0_wp), &
                                          (1.4_wp, 1.3_wp), (1.1_wp, 1.48_wp), (0.7_wp, 1.4_wp), &
                                          (0.2_wp, 1.0_wp), (0.02_wp, 0.4_wp)]
      real(wp), parameter :: within = 1.0e-6_wp
      type(nine_points_t) :: found
      type(leg_data_t) :: data
      type(certificate_t) :: certificate
      complex(wp), allocatable :: own(:, :), turns(:, :), partners(:, :)
      logical, allocatable :: likely(:)
      complex(wp) :: first
      real(wp) :: from, to
      integer :: i, n

      call solve_nine_points(p, 1, found)
      n = size(found%solutions, 2)
      allocate (own(variables, n), turns(most_points, n), partners(most_points, n), likely(n))
      first = p(found%order(0) - 1)
      data%d = p(found%order(1:) - 1) - first
      data%dh = conjg(data%d)
      do i = 1, n
         own(:, i) = in_place(found, found%solutions(:, i))
         call turns_of(found%path%problem, data, own(:, i), turns(:, i), partners(:, i))
         likely(i) = maxval(abs(own(2::2, i) - conjg(own(1::2, i)))) < within*maxval(abs(own(:, i)))
      end do
      call cpu_time(from)
      call certify_legs(found%path%problem, p(found%order - 1), [(0.0_wp, i=0, most_points)], [first, first], own, turns, &
                        partners, likely, .true., certificate)
      call cpu_time(to)
      print '(a,i0,a,i0,a,i0,a,f0.2,a)', 'Certificate of the nine points of data/exact/nine_points.nml: ', certificate%proven, &
         ' of 1442 ends exist, ', certificate%apart, ' apart from all others, ', certificate%real_ones, ' real; ', to - from, ' s.'
      print '(a)', ''
   end subroutine measure_certificate

   !> Six-bars through five points of a function.
   subroutine measure_six_bars()
      real(wp), parameter :: phi(5) = radians_per_degree*[10.0_wp, 32.0_wp, 55.0_wp, 78.0_wp, 100.0_wp]
      real(wp), parameter :: psi(5) = radians_per_degree*[0.0_wp, 12.0_wp, 27.0_wp, 45.0_wp, 66.0_wp]
      integer, parameter :: grid = 6, kept = 10
      real(wp), parameter :: least_angle = 20.0_wp, longest = 10.0_wp
      type(desired_function_t) :: wanted
      type(six_bars_t) :: found
      real(wp) :: from, to
      integer :: k

      wanted%continuous = .false.
      print '(a)', '## Six-bars through five points of a function', ''
      print '(a)', '| kind | drivers | closing linkages | on one branch | s |', '| --- | --- | --- | --- | --- |'
      do k = 1, 2
         call cpu_time(from)
         if (k == 1) call find_stephenson(wanted, phi, psi, grid, kept, least_angle, longest, found)
         if (k == 2) call find_watt(wanted, phi, psi, 2*grid, kept, least_angle, longest, found)
         call cpu_time(to)
         print '(3a,i0,a,i0,a,i0,a,f0.2,a)', '| ', merge('Stephenson III', 'Watt II       ', k == 1), ' | ', found%drivers, ' | ', &
            found%linkages, ' | ', found%valid, ' | ', to - from, ' |'
      end do
      print '(a)', ''
   end subroutine measure_six_bars

   subroutine measure_poses()
      type(dyads_t) :: dyads
      complex(wp) :: d(4), g(4)
      real(wp) :: from, to, total, worst, turn
      integer :: k, i, counted(0:4)

      counted = 0
      total = 0.0_wp
      worst = 0.0_wp
      do k = 1, pose_problems
         do i = 1, 4
            turn = 2.0_wp*pi*deviate()
            d(i) = cmplx(2.0_wp*deviate() - 1.0_wp, 2.0_wp*deviate() - 1.0_wp, wp)
            g(i) = cmplx(cos(turn), sin(turn), wp) - 1.0_wp
         end do
         call cpu_time(from)
         call five_poses(d, g, dyads)
         call cpu_time(to)
         total = total + to - from
         counted(dyads%count) = counted(dyads%count) + 1
         worst = max(worst, dyads%residual)
      end do
      print '(a)', '## Five poses', ''
      print '(i0,a,f0.1,a,es8.1,a)', pose_problems, ' random problems: ', total/real(pose_problems, wp)*1.0e6_wp, &
         ' us each (with two calls of the clock); worst residual ', worst, '.'
      print '(a,3(f0.1,a))', '0, 2 and 4 real dyads in ', percent(counted(0)), ', ', percent(counted(2)), ' and ', &
         percent(counted(4)), ' per cent.'
      print '(a)', ''
   end subroutine measure_poses

   real(wp) function percent(number)
      integer, intent(in) :: number

      percent = 100.0_wp*real(number, wp)/real(pose_problems, wp)
   end function percent

   subroutine measure_functions()
      print '(a)', '## Least largest error', ''
      print '(a)', '| function | x | input, output | largest error | optima | s |', '| --- | --- | --- | --- | --- | --- |'
      call one('LOG10', 1.0_wp, 2.0_wp, 0.0_wp, 60.0_wp, 90.0_wp, .false.)
      call one('LOG10', 1.0_wp, 2.0_wp, 0.0_wp, 60.0_wp, 60.0_wp, .false.)
      call one('LOG10', 1.0_wp, 10.0_wp, 0.0_wp, 60.0_wp, 90.0_wp, .false.)
      call one('SIN', 0.0_wp, 90.0_wp, 0.0_wp, 120.0_wp, 60.0_wp, .false.)
      call one('SIN', 0.0_wp, 90.0_wp, 0.0_wp, 90.0_wp, 90.0_wp, .false.)
      call one('TAN', 0.0_wp, 45.0_wp, 0.0_wp, 90.0_wp, 90.0_wp, .false.)
      call one('EXP', 0.0_wp, 1.0_wp, 0.0_wp, 90.0_wp, 90.0_wp, .false.)
      call one('POWER', 0.0_wp, 1.0_wp, 2.0_wp, 90.0_wp, 90.0_wp, .false.)
      call one('POWER', 0.0_wp, 1.0_wp, 1.5_wp, 90.0_wp, 90.0_wp, .false.)
      call one('POWER', 1.0_wp, 2.0_wp, -1.0_wp, 90.0_wp, 90.0_wp, .false.)
      call one('LOG10', 1.0_wp, 2.0_wp, 0.0_wp, 60.0_wp, 1.0_wp, .true.)
      call one('LOG10', 1.0_wp, 10.0_wp, 0.0_wp, 90.0_wp, 1.0_wp, .true.)
      call one('POWER', 1.0_wp, 2.0_wp, -1.0_wp, 90.0_wp, 1.0_wp, .true.)
      print '(a)', ''
   end subroutine measure_functions

   subroutine one(name, low, high, power, swing_in, swing_out, slides)
      character(*), intent(in) :: name
      real(wp), intent(in) :: low, high, power, swing_in, swing_out
      logical, intent(in) :: slides
      type(desired_function_t) :: wanted
      type(approximation_t), allocatable :: found(:)
      character(:), allocatable :: unit
      real(wp) :: from, to
      integer :: too_long

      wanted%kind = function_kind(name)
      wanted%low = low
      wanted%high = high
      wanted%power = power
      wanted%swing_in = swing_in*radians_per_degree
      wanted%swing_out = swing_out*merge(1.0_wp, radians_per_degree, slides)
      wanted%slides = slides
      call cpu_time(from)
      call approximate(wanted, 100.0_wp, found, too_long)
      call cpu_time(to)
      unit = trim(merge('per cent of the travel', 'degrees               ', slides))
      if (size(found) == 0) return
      print '(3a,f0.1,a,f0.1,a,f0.0,a,f0.0,a,es14.8,3a,i0,a,f0.2,a)', '| ', name, ' | ', low, ' to ', high, ' | ', swing_in, ', ', &
         swing_out, ' | ', found(1)%error, ' ', unit, ' | ', size(found), ' | ', to - from, ' |'
   end subroutine one

   subroutine measure_rows()
      print '(a)', '## Generic problems of two dyads, all solutions found anew', ''
      print '(a)', '| beyond the first point | solutions | loops | s |', '| --- | --- | --- | --- |'
      call row('4 points, both pivots given', [kind_point, kind_point, kind_point, kind_point], .false., .true., .true.)
      call row('4 timed points', [kind_timed, kind_timed, kind_timed, kind_timed], .false., .false., .false.)
      call row('3 poses, 2 points', [kind_pose, kind_pose, kind_pose, kind_point, kind_point], .false., .false., .false.)
      call row('2 poses, 4 points', [kind_pose, kind_pose, kind_point, kind_point, kind_point, kind_point], .false., .false., &
               .false.)
      call row('slider-crank, 7 points', spread(kind_point, 1, 7), .true., .false., .false.)
      print '(a)', '', '## Random problems of two dyads, from the stored solutions', ''
      print '(a)', '| beyond the first point | problems | ends | complete | s each |', '| --- | --- | --- | --- | --- |'
      call asked('2 poses, 4 points', [kind_pose, kind_pose, kind_point, kind_point, kind_point, kind_point], .false., 402)
      call asked('slider-crank, 7 points', spread(kind_point, 1, 7), .true., 558)
   end subroutine measure_rows

   subroutine row(name, kinds, slides, crank_given, follower_given)
      character(*), intent(in) :: name
      integer, intent(in) :: kinds(:)
      logical, intent(in) :: slides, crank_given, follower_given
      type(leg_problem_t) :: problem
      type(generic_t) :: generic
      real(wp) :: from, to

      call make_problem(kinds, slides, crank_given, follower_given, problem)
      call cpu_time(from)
      call solve_generic(problem, 1, .false., 0, generic)
      call cpu_time(to)
      print '(3a,i0,a,i0,a,f0.2,a)', '| ', name, ' | ', size(generic%solutions, 2), ' | ', generic%loops, ' | ', to - from, ' |'
   end subroutine row

   !> Random real problems: kept solutions loaded and followed.
   subroutine asked(name, kinds, slides, expected)
      character(*), intent(in) :: name
      integer, intent(in) :: kinds(:), expected
      logical, intent(in) :: slides
      integer, parameter :: count = 20
      type(problem_path_t) :: path
      type(generic_t) :: generic
      type(leg_data_t) :: wanted
      type(tracked_t) :: tracked
      complex(wp), allocatable :: starts(:, :), found(:, :)
      complex(wp) :: l, m
      real(wp) :: from, to
      integer :: k, i, complete

      call make_problem(kinds, slides, .false., .false., path%problem)
      complete = 0
      call cpu_time(from)
      do k = 1, count
         wanted = leg_data_t()
         do i = 1, size(kinds)
            wanted%d(i) = cmplx(2.0_wp*deviate() - 1.0_wp, 2.0_wp*deviate() - 1.0_wp, wp)
            wanted%dh(i) = conjg(wanted%d(i))
            wanted%turn(i) = cmplx(0.0_wp, 2.0_wp*pi*deviate(), wp)
         end do
         call generic_solutions(path%problem, expected, generic)
         l = random_unit(random)
         m = random_unit(random)
         starts = generic%solutions
         call scale_problem(path%problem, generic%data, l, m, path%from)
         call scale_solutions(path%problem, l, m, starts)
         path%to = wanted
         call track_carefully(path, starts, .false., tracked)
         if (allocated(found)) deallocate (found)
         allocate (found(variables, 0))
         call add_distinct(path%problem, tracked%ends, tracked%arrived, .false., found)
         if (size(found, 2) == expected) complete = complete + 1
      end do
      call cpu_time(to)
      print '(3a,i0,a,i0,a,i0,a,f0.2,a)', '| ', name, ' | ', count, ' | ', expected, ' | ', complete, ' | ', &
         (to - from)/real(count, wp), ' |'
   end subroutine asked
end program exact
