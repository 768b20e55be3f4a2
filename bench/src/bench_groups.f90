!> What a position costs where groups are larger than dyads, or gears and cylinders take part: blocks of positions, one thread.
module bench_groups
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
   character(*), parameter :: drive = " &DRIVES DRIVE='A' &END"//nl, method = ' &METHOD IKIN=90 &END'//nl
   character(*), parameter :: rest = drive//" &OUTPUTS OUTPUT='point I' &END"//nl//method
   character(*), parameter :: of_wheel = drive//" &OUTPUTS OUTPUT='angle W V' &END"//nl//method
   character(*), parameter :: chain = 'TEN-BAR'//nl//joints//', JX='//x//', JY='//y//','//nl//names//','//nl// &
                              " LNK='A D F H K',"//links//' &END'//nl
   character(*), parameter :: ten_bar = chain//rest, of_rocker = chain//drive//" &OUTPUTS OUTPUT='angle K I' &END"//nl//method
   character(*), parameter :: geared = 'TEN-BAR WITH A WHEEL'//nl//joints//",'W','V', JX="//x//',380.,380., JY='//y// &
                              ',-10.,20.,'//nl//names//",'wheel',"//nl//" LNK='A D F H K W',"//links//",'W V',"//nl// &
                              " GEARA='s4', GEARB='wheel', GCARR='frame', GTA=20.0, GTB="
   character(*), parameter :: whole = geared//'10.0 &END'//nl, broken = geared//'30.0 &END'//nl

contains

   !> linkage | groups | positions | ns per position
   subroutine measure_groups(folder, short)
      character(*), intent(in) :: folder                 !! of the data sets
      logical, intent(in) :: short                       !! one timing each: only whether it runs
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings

      call measure_text('ten-bar, a sketch', ten_bar, .false.)
      call measure_text('the same with a wheel in gear, 20 to 10 teeth', whole//rest, .false.)
      call measure_text('the same with a wheel in gear, 20 to 30 teeth', broken//rest, .false.)
      call measure_text('ten-bar, and the angle of its last link', of_rocker, .true.)
      call measure_text('with a wheel, 20 to 10 teeth, and the angle of the wheel', whole//of_wheel, .true.)
      call measure_text('with a wheel, 20 to 30 teeth, and the angle of the wheel', broken//of_wheel, .true.)
      call read_cases(folder//'/stephenson2_six_bar.nml', sets, findings)
      call measure('Stephenson II, a group of four links', sets, findings, -10.0_wp, .false., short)
      call read_cases(folder//'/excavator.nml', sets, findings)
      call measure('excavator, three cylinders', sets, findings, 0.1_wp, .false., short)

   contains

      subroutine measure_text(title, text, with_output)
         character(*), intent(in) :: title, text
         logical, intent(in) :: with_output

         call read_case_text(text, title, sets, findings, 'psalm')
         call measure(title, sets, findings, 360.0_wp, with_output, short)
      end subroutine measure_text
   end subroutine measure_groups

   !> Least time of one pass over positions that span so many degrees, or so much length, from the drawing on.
   subroutine measure(title, sets, findings, span, with_output, short)
      character(*), intent(in) :: title
      type(data_set_t), intent(in) :: sets(:)
      type(diagnostics_t), intent(inout) :: findings
      real(wp), intent(in) :: span
      logical, intent(in) :: with_output                 !! the output is found, too
      logical, intent(in) :: short
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      type(problem_t), allocatable :: problem
      real(dp) :: from, to, best
      integer :: sample, pass, passes, block, offset, n, i

      if (findings%failed()) error stop 'a sketch cannot be read'
      call set_up(sets(1), mechanism, dimensions, parameters, findings)
      if (findings%failed()) error stop 'a sketch is wrong'
      allocate (problem)
      call make_problem(sets(1), mechanism, dimensions, parameters, problem)
      call problem%set_inputs([(dimensions%drawn - dimensions%crnki + span*real(i, wp)/real(positions, wp), i=0, positions - 1)])
      call problem%bind(dimensions)
      best = huge(best)
      passes = merge(1, repeats, short)
      do sample = 1, merge(1, samples, short)
         call cpu_time(from)
         do pass = 1, passes
            do block = 1, problem%blocks()
               call problem%solve_block(block, offset, n)
               if (with_output) call problem%output_of(n)
               do i = 1, mechanism%nloop
                  if (.not. problem%linkage%closes(n, i)) error stop 'a sketch does not close'
               end do
            end do
         end do
         call cpu_time(to)
         best = min(best, to - from)
      end do
      print '(a,i0,a,i0,a,f0.1)', title//'|', mechanism%nloop, '|', positions, '|', &
         1.0e9_dp*best/(real(passes, dp)*real(positions, dp))
   end subroutine measure
end module bench_groups
