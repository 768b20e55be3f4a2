!> kalm: velocities and accelerations of planar linkages from a namelist file.
program kalm
   use psalm_console, only: arguments_t, begin, show_findings, write_devices
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_kalm, only: run_kalm
   use psalm_kinds, only: wp
   use psalm_run, only: devices_t, check_case
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_system, only: write_standard_error
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   type(arguments_t) :: arguments
   logical :: finished
   integer :: code, i

   call begin('kalm', &
      'usage: kalm [options] [CASE.nml ...]'//nl// &
      nl//'Displacement, velocity, acceleration and jerk of the output of each case, at its positions. The group'//nl// &
      '&RATES gives the SPEED, ACCEL and UNITS of the input; without it the input moves at 1 rad/s or 1 length/s.'//nl// &
      nl//'The listing goes to standard output; CASE.kalm.dev8 (input; with KTHETA=1 all arcs and joints) and'//nl// &
      'CASE.kalm.dev9 beside the case.'//nl// &
      nl//'  --output-dir DIR  put the device files into DIR'//nl// &
      '  --quiet           no remarks on standard error, errors only'//nl// &
      '  --version         print the version'//nl// &
      '  --help            print this text'//nl// &
      nl//'Exit status: 0 done; 1 done, but the linkage does not close somewhere or passes a dead point;'//nl// &
      '2 the input is wrong; 3 a file could not be read or written.'//nl, &
      arguments, finished)
   code = arguments%code
   if (finished) stop code, quiet=.true.
   do i = 1, size(arguments%files)
      call run_file(trim(arguments%files(i)))
   end do
   stop code, quiet=.true.

contains

   subroutine run_file(file)
      character(*), intent(in) :: file
      type(diagnostics_t) :: findings
      type(data_set_t), allocatable :: sets(:)
      type(line_t) :: none(0)
      real(wp), allocatable :: vertices(:, :)
      type(devices_t) :: devices
      integer :: k

      call read_data_sets(file, sets, findings, rates=.true.)
      do k = 1, size(sets)
         sets(k)%nguess = 0
         if (.not. findings%failed()) call check_case(sets(k), none, vertices, findings)
      end do
      if (findings%failed() .or. .not. arguments%quiet) call show_findings(findings)
      code = max(code, findings%exit_code())
      if (findings%failed()) return
      devices%wants_summary = .not. arguments%quiet
      do k = 1, size(sets)
         call run_kalm(sets(k), devices)
      end do
      if (.not. arguments%quiet) call write_standard_error(devices%notes%content()//devices%summary%content())
      code = max(code, devices%code)
      call write_devices(file, arguments%output_dir, '.kalm', devices, .not. arguments%quiet, code)
   end subroutine run_file
end program kalm
