!> What a position costs where groups are larger than dyads, or gears and cylinders take part: blocks of positions, one thread.
module bench_groups
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_cases, only: read_case_text, read_cases
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp, dp
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: measure_groups

   character, parameter :: nl = new_line('a')
   integer, parameter :: positions = 12800
   integer, parameter :: samples = 7                     !! timings of which the best counts
   integer, parameter :: repeats = 20                    !! passes of a timing
   character(*), parameter :: joints = " &CHAIN JNT='A','B','C','D','E','F','G','H','I','K'"
   character(*), parameter :: x = '0.,0.,80.,100.,160.,180.,240.,260.,320.,340.', y = '0.,20.,60.,-10.,70.,-10.,70.,-10.,70.,-10.'
   character(*), parameter :: names = " LNAME='frame','crank','r1','s1','r2','s2','r3','s3','r4','s4'"
   character(*), parameter :: links = "'A B','B C','C D','C E','E F','E G','G H','G I','I K'"
   character(*), parameter :: rest = " &DRIVES DRIVE='A' &END"//nl//" &OUTPUTS OUTPUT='point I' &END"//nl// &
                              ' &METHOD IKIN=90 &END'//nl
   character(*), parameter :: ten_bar = 'TEN-BAR'//nl//joints//', JX='//x//', JY='//y//','//nl//names//','//nl// &
                              " LNK='A D F H K',"//links//' &END'//nl//rest
   character(*), parameter :: geared = 'TEN-BAR WITH A WHEEL'//nl//joints//",'W','V', JX="//x//',380.,380., JY='//y// &
                              ',-10.,20.,'//nl//names//",'wheel',"//nl//" LNK='A D F H K W',"//links//",'W V',"//nl// &
                              " GEARA='s4', GEARB='wheel', GCARR='frame', GTA=20.0, GTB="
   character(*), parameter :: whole = geared//'10.0 &END'//nl//rest, broken = geared//'30.0 &END'//nl//rest

contains

   !> linkage | groups | positions | ns per position
   subroutine measure_groups(folder)
      character(*), intent(in) :: folder                 !! of the data sets
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings

      call read_case_text(ten_bar, 'ten-bar', sets, findings, 'psalm')
      call measure('ten-bar, a sketch', sets, findings, 360.0_wp)
      call read_case_text(whole, 'ten-bar with a wheel', sets, findings, 'psalm')
      call measure('the same with a wheel in gear, 20 to 10 teeth', sets, findings, 360.0_wp)
      call read_case_text(broken, 'ten-bar with a wheel', sets, findings, 'psalm')
      call measure('the same with a wheel in gear, 20 to 30 teeth', sets, findings, 360.0_wp)
      call read_cases(folder//'/stephenson2_six_bar.nml', sets, findings)
      call measure('Stephenson II, a group of four links', sets, findings, -10.0_wp)
      call read_cases(folder//'/excavator.nml', sets, findings)
      call measure('excavator, three cylinders', sets, findings, 0.1_wp)
   end subroutine measure_groups

   !> Least time of one pass over positions that span so many degrees, or so much length, from the drawing on.
   subroutine measure(title, sets, findings, span)
      character(*), intent(in) :: title
      type(data_set_t), intent(in) :: sets(:)
      type(diagnostics_t), intent(inout) :: findings
      real(wp), intent(in) :: span
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      type(problem_t), allocatable :: problem
      real(dp) :: from, to, best
      integer :: sample, pass, block, offset, n, i

      if (findings%failed()) error stop 'a sketch cannot be read'
      call set_up(sets(1), mechanism, dimensions, parameters, findings)
      if (findings%failed()) error stop 'a sketch is wrong'
      allocate (problem)
      call make_problem(sets(1), mechanism, dimensions, parameters, problem)
      call problem%set_inputs([(dimensions%drawn - dimensions%crnki + span*real(i, wp)/real(positions, wp), i=0, positions - 1)])
      call problem%bind(dimensions)
      best = huge(best)
      do sample = 1, samples
         call cpu_time(from)
         do pass = 1, repeats
            do block = 1, problem%blocks()
               call problem%solve_block(block, offset, n)
               do i = 1, mechanism%nloop
                  if (.not. problem%linkage%closes(n, i)) error stop 'a sketch does not close'
               end do
            end do
         end do
         call cpu_time(to)
         best = min(best, to - from)
      end do
      print '(a,i0,a,i0,a,f0.1)', title//'|', mechanism%nloop, '|', positions, '|', &
         1.0e9_dp*best/(real(repeats, dp)*real(positions, dp))
   end subroutine measure
end module bench_groups
