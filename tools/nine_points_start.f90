!> Makes generated/src/psalm_nine_points_start.f90: all solutions of one nine-point problem, from nothing.
!>
!> A generic problem is solved by monodromy, its 1442 orbits are followed to the points of a disturbed oval, and one of each pair of
!> conjugate orbits is written in single precision. tools/make_nine_points compiles and runs it. Messages go to standard error.
program nine_points_start
   use, intrinsic :: iso_fortran_env, only: error_unit
   use psalm_kinds, only: wp, pi
   use psalm_leg_lanes, only: problem_path_t
   use psalm_leg_problem, only: kind_point, leg_problem_t, make_problem, most_points, variables
   use psalm_monodromy, only: add_distinct, generic_t, is_same, orbit_key, orbit_numbers, solve_generic
   use psalm_start_text, only: characters_a_number, encode
   use psalm_tracker, only: polish, track, tracked_t
   implicit none (type, external)
   integer, parameter :: orbits = 1442               !! Wampler, Morgan and Sommese (1992)
   integer, parameter :: seed = 1, lines_a_table = 200
   type(leg_problem_t) :: problem
   type(generic_t) :: generic
   type(problem_path_t) :: path
   type(tracked_t) :: tracked
   complex(wp), allocatable :: found(:, :), keys(:, :), conjugate(:, :)
   complex(wp) :: point(0:most_points)
   real(wp), allocatable :: left(:)
   integer, allocatable :: partner(:)
   integer :: i, k, pass, alone, kept, table, first, last
   real(wp) :: turn
   integer, allocatable :: order(:)

   call make_problem(spread(kind_point, 1, most_points), .false., .false., .false., problem)
   call solve_generic(problem, seed, .true., orbits, generic)
   write (error_unit, '(i0,a,i0,a)') size(generic%solutions, 2), ' orbits of a generic problem in ', generic%loops, ' loops'
   do i = 0, most_points
      turn = 2.0_wp*pi*real(i, wp)/real(most_points + 1, wp)
      point(i) = cmplx(1.2_wp*cos(turn) + 0.21_wp*cos(2.0_wp*turn + 0.4_wp), &
                       0.9_wp*sin(turn) + 0.13_wp*sin(3.0_wp*turn + 1.1_wp), wp)
   end do
   path%problem = problem
   path%from = generic%data
   path%to%d = point(1:) - point(0)
   path%to%dh = conjg(path%to%d)
   allocate (found(variables, 0))
   do pass = 1, 6
      if (size(found, 2) >= orbits) exit
      ! another pass begins at the same problem, scaled
      call another_way(pass)
      call add_distinct(problem, tracked%ends, tracked%arrived, .true., found)
      write (error_unit, '(i0,a)') size(found, 2), ' orbits of the oval'
   end do
   if (size(found, 2) /= orbits) error stop 'not all orbits were found'
   path%from = path%to
   allocate (left(orbits), keys(orbit_numbers, orbits), conjugate(orbit_numbers, orbits), partner(orbits))
   call polish(path, found, left)
   do i = 1, orbits
      keys(:, i) = orbit_key(found(:, i))
      conjugate(:, i) = conjg(keys([2, 1, 4, 3, 6, 5], i))
   end do
   partner = 0
   do i = 1, orbits
      do k = 1, orbits
         if (is_same(keys(:, k), conjugate(:, i))) partner(i) = k
      end do
      if (partner(i) == 0) error stop 'an orbit has no conjugate'
   end do
   alone = count(partner == [(i, i=1, orbits)])
   order = [pack([(i, i=1, orbits)], partner == [(i, i=1, orbits)]), pack([(i, i=1, orbits)], partner > [(i, i=1, orbits)])]
   kept = size(order)
   write (error_unit, '(i0,a,i0,a,es9.2)') alone, ' orbits are their own conjugates, ', kept - alone, ' pairs; last correction ', &
      maxval(left)
   call write_module()

contains

   subroutine another_way(pass)
      use psalm_leg_problem, only: leg_data_t
      use psalm_monodromy, only: scale_problem, scale_solutions
      integer, intent(in) :: pass
      type(leg_data_t) :: scaled
      complex(wp), allocatable :: starts(:, :)
      complex(wp) :: l, m

      l = exp(cmplx(0.0_wp, 0.7_wp*real(pass, wp), wp))
      m = exp(cmplx(0.0_wp, 1.3_wp*real(pass, wp), wp))
      starts = generic%solutions
      call scale_problem(problem, generic%data, l, m, scaled)
      call scale_solutions(problem, l, m, starts)
      path%from = scaled
      call track(path, starts, tracked)
   end subroutine another_way

   subroutine write_module()
      character(characters_a_number*2*variables) :: line

      print '(a)', '!> All 1442 orbits of a nine-point problem, one of each pair of conjugate ones, as text of psalm_start_text.'
      print '(a)', '!>'
      print '(a)', '!> Made by tools/make_nine_points; not to be edited.'
      print '(a)', 'module psalm_nine_points_start'
      print '(a)', '   use, intrinsic :: iso_fortran_env, only: real64'
      print '(a)', '   implicit none (type, external)'
      print '(a)', '   private'
      print '(a)', '   public :: start_points, start_line, own_conjugates, stored'
      print '(a)', ''
      print '(a,i0,a)', '   integer, parameter :: own_conjugates = ', alone, ' !! the first ones: their own conjugates'
      print '(a,i0,a)', '   integer, parameter :: stored = ', kept, ' !! orbits that are here'
      print '(a,i0,a)', '   integer, parameter :: line_length = ', len(line), ' !! characters of a solution'
      print '(a,i0,a)', '   integer, parameter :: lines_a_table = ', lines_a_table, ''
      print '(a)', '   complex(real64), parameter :: start_points(0:8) = [ &'
      do i = 0, most_points
         print '(a,es24.17,a,es24.17,a)', '      (', real(point(i), wp), '_real64, ', aimag(point(i)), &
            '_real64)'//merge(' ]', ', ', i == most_points)//trim(merge('  ', ' &', i == most_points))
      end do
      table = 0
      do first = 1, kept, lines_a_table
         table = table + 1
         last = min(kept, first + lines_a_table - 1)
         print '(a,i0,a,i0,a)', '   character(line_length), parameter :: table', table, '(', last - first + 1, ') = [ &'
         do i = first, last
            line = ''
            do k = 1, variables
               associate (value => found(k, order(i)))
                  line((2*k - 2)*characters_a_number + 1:2*k*characters_a_number) = encode(real(value, wp))//encode(aimag(value))
               end associate
            end do
            print '(a)', "      '"//line//"'"//trim(merge(']  ', ', &', i == last))
         end do
      end do
      print '(a)', ''
      print '(a)', 'contains'
      print '(a)', ''
      print '(a)', '   !> A stored solution as text.'
      print '(a)', '   pure function start_line(number) result(line)'
      print '(a)', '      integer, intent(in) :: number                  !! 1 to `stored`'
      print '(a)', '      character(line_length) :: line'
      print '(a)', ''
      print '(a)', '      select case ((number - 1)/lines_a_table)'
      do i = 1, table - 1
         print '(a,i0,a)', '      case (', i - 1, ')'
         print '(a,i0,a,i0,a)', '         line = table', i, '(number - ', (i - 1)*lines_a_table, ')'
      end do
      print '(a)', '      case default'
      print '(a,i0,a,i0,a)', '         line = table', table, '(number - ', (table - 1)*lines_a_table, ')'
      print '(a)', '      end select'
      print '(a)', '   end function start_line'
      print '(a)', 'end module psalm_nine_points_start'
   end subroutine write_module
end program nine_points_start
