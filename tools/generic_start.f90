!> Makes generated/src/psalm_generic_start.f90: all solutions of two generic problems of two legs, from nothing.
!>
!> Eight points by a slider-crank (558 solutions), and three poses and four points by a four-bar (402, of which one of two with
!> exchanged legs is kept), as psalm_generic draws them. tools/make_generic compiles and runs it. Messages go to standard error.
program generic_start
   use, intrinsic :: iso_fortran_env, only: error_unit
   use psalm_kinds, only: wp
   use psalm_leg_problem, only: kind_point, kind_pose, leg_problem_t, make_problem
   use psalm_monodromy, only: generic_t, is_same, solve_generic, swap_legs
   use psalm_start_text, only: characters_short, encode_short
   implicit none (type, external)
   integer, parameter :: seed = 1, lines_a_table = 200
   integer, parameter :: of_slider = 558, of_poses = 402 !! test/published/exact.py has the counts
   type(leg_problem_t) :: problem

   print '(a)', '!> Solutions of two generic problems of two legs, as text of psalm_start_text in single precision.'
   print '(a)', '!>'
   print '(a)', '!> Made by tools/make_generic; not to be edited.'
   print '(a)', 'module psalm_generic_start'
   print '(a)', '   implicit none (type, external)'
   print '(a)', '   private'
   print '(a)', '   public :: slider_line, slider_stored, poses_line, poses_stored'
   print '(a)', ''
   call make_problem(spread(kind_point, 1, 7), .true., .false., .false., problem)
   call write_tables('slider', of_slider)
   call make_problem([kind_pose, kind_pose, kind_point, kind_point, kind_point, kind_point], .false., .false., .false., problem)
   call write_tables('poses', of_poses)
   print '(a)', ''
   print '(a)', 'contains'
   call write_function('slider', of_slider)
   call write_function('poses', of_poses/2)
   print '(a)', 'end module psalm_generic_start'

contains

   subroutine write_tables(name, expected)
      character(*), intent(in) :: name
      integer, intent(in) :: expected
      type(generic_t) :: generic
      character(:), allocatable :: line
      logical, allocatable :: kept(:)
      integer, allocatable :: order(:)
      integer :: i, k, first, last

      call solve_generic(problem, seed, .false., expected, generic)
      write (error_unit, '(a,i0,a,i0,a)') name//': ', size(generic%solutions, 2), ' solutions in ', generic%loops, ' loops'
      if (size(generic%solutions, 2) /= expected) error stop 'not all solutions were found'
      allocate (kept(expected), source=.true.)
      if (problem%is_symmetric()) then
         do i = 1, expected
            do k = 1, i - 1
               if (is_same(generic%solutions(:, k), swap_legs(generic%solutions(:, i), problem%differences))) kept(i) = .false.
            end do
         end do
      end if
      order = pack([(i, i=1, expected)], kept)
      print '(a,i0)', '   integer, parameter :: '//name//'_stored = ', size(order)
      print '(a,i0)', '   integer, parameter :: '//name//'_length = ', 2*problem%unknowns*characters_short
      do first = 1, size(order), lines_a_table
         last = min(size(order), first + lines_a_table - 1)
         print '(a,i0,a,i0,a)', '   character('//name//'_length), parameter :: '//name, (first - 1)/lines_a_table, '(', &
            last - first + 1, ') = [ &'
         do i = first, last
            line = ''
            do k = 1, problem%unknowns
               associate (value => generic%solutions(problem%free(k), order(i)))
                  line = line//encode_short(real(value, wp))//encode_short(aimag(value))
               end associate
            end do
            print '(a)', "      '"//line//"'"//trim(merge(']  ', ', &', i == last))
         end do
      end do
   end subroutine write_tables

   subroutine write_function(name, stored)
      character(*), intent(in) :: name
      integer, intent(in) :: stored
      integer :: i, tables

      tables = (stored - 1)/lines_a_table
      print '(a)', ''
      print '(a)', '   !> A solution as text.'
      print '(a)', '   pure function '//name//'_line(number) result(line)'
      print '(a)', '      integer, intent(in) :: number                  !! 1 to `'//name//'_stored`'
      print '(a)', '      character('//name//'_length) :: line'
      print '(a)', ''
      print '(a,i0,a)', '      select case ((number - 1)/', lines_a_table, ')'
      do i = 0, tables - 1
         print '(a,i0,a)', '      case (', i, ')'
         print '(a,i0,a,i0,a)', '         line = '//name, i, '(number - ', i*lines_a_table, ')'
      end do
      print '(a)', '      case default'
      print '(a,i0,a,i0,a)', '         line = '//name, tables, '(number - ', tables*lines_a_table, ')'
      print '(a)', '      end select'
      print '(a)', '   end function '//name//'_line'
   end subroutine write_function
end program generic_start
