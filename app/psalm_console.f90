!> What the programs of the suite share at the console: arguments, messages, files of the devices, the progress line.
module psalm_console
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: dp
   use psalm_number, only: parse_integer
   use psalm_run, only: devices_t, version
   use psalm_simplx, only: search_monitor_t, search_state_t
   use psalm_status, only: diagnostics_t, exit_bad_input, exit_file_trouble
   use psalm_system, only: error_is_terminal, make_directory, write_standard_error, write_standard_output, write_whole_file
   use psalm_text, only: to_text, general
   implicit none (type, external)
   private
   public :: arguments_t, progress_t, begin, show_findings, stem_of, write_devices

   integer, parameter :: most_threads = 1024

   !> The command line.
   type :: arguments_t
      character(:), allocatable :: program       !! name of the program
      character(:), allocatable :: files(:)      !! cases, `-` for standard input
      character(:), allocatable :: output_dir    !! empty: beside the case
      character(:), allocatable :: device4       !! empty: CASE.dev4
      integer :: threads = 0                     !! 0: not given
      logical :: curves = .false., assemblies = .false. !! balm: curves by gnuplot; the other assembly of each pair
      logical :: quiet = .false., help = .false., version = .false.
      integer :: code = 0                        !! exit status that bad arguments lead to
   end type arguments_t

   !> Progress line on a terminal, at most ten times a second.
   type, extends(search_monitor_t) :: progress_t
      integer(int64) :: started = 0_int64, shown = 0_int64
      logical :: active = .false.
   contains
      procedure :: report => show_progress
   end type progress_t

contains

   !> What every program does first: read the command line, answer --help and --version, refuse mistakes.
   !>
   !> `finished` is true if there is nothing left to do; the program then ends with `arguments%code`.
   subroutine begin(program, help, arguments, finished)
      character(*), intent(in) :: program, help         !! name of the program; text of --help
      type(arguments_t), intent(out) :: arguments
      logical, intent(out) :: finished
      logical :: done

      call read_arguments(program, arguments)
      finished = .true.
      if (arguments%code == exit_bad_input) return
      if (arguments%help .or. arguments%version) then
         if (arguments%help) then
            call write_standard_output(help, done)
         else
            call write_standard_output(program//' '//version//new_line('a'), done)
         end if
         if (.not. done) arguments%code = exit_file_trouble
         return
      end if
      call check_names(arguments)
      finished = arguments%code == exit_bad_input
   end subroutine begin

   !> Read the command line. Mistakes are told on standard error.
   subroutine read_arguments(program, arguments)
      character(*), intent(in) :: program               !! name of the program
      type(arguments_t), intent(out) :: arguments
      character(:), allocatable :: word, number, reason
      character(:), allocatable :: more(:)
      integer :: i
      logical :: only_files, valid

      arguments%program = program
      allocate (character(1) :: arguments%files(0))
      arguments%output_dir = ''
      arguments%device4 = ''
      only_files = .false.
      i = 0
      do while (i < command_argument_count())
         i = i + 1
         word = argument(i)
         if (only_files .or. word == '-' .or. word(:min(1, len(word))) /= '-') then
            allocate (character(max(len(word), len(arguments%files))) :: more(size(arguments%files) + 1))
            more(:size(arguments%files)) = arguments%files
            more(size(more)) = word
            call move_alloc(more, arguments%files)
            cycle
         end if
         select case (word)
         case ('--')
            only_files = .true.
         case ('--help', '-h')
            arguments%help = .true.
         case ('--version')
            arguments%version = .true.
         case ('--quiet', '-q')
            arguments%quiet = .true.
         case ('--curves', '--assemblies')
            if (program /= 'balm') then
               call say(program, "unknown option '"//word//"'; see --help")
               arguments%code = exit_bad_input
            end if
            arguments%curves = arguments%curves .or. word == '--curves'
            arguments%assemblies = arguments%assemblies .or. word == '--assemblies'
         case ('--output-dir')
            call value_of(program, word, i, arguments%output_dir, arguments%code)
         case ('--threads')
            number = ''
            call value_of(program, word, i, number, arguments%code)
            call parse_integer(number, arguments%threads, valid, reason)
            if (len(number) > 0 .and. (.not. valid .or. arguments%threads < 1 .or. arguments%threads > most_threads)) then
               call say(program, "--threads wants a number from 1 to "//to_text(most_threads)//"; found '"//number//"'")
               arguments%code = exit_bad_input
            end if
         case ('--device4')
            call value_of(program, word, i, arguments%device4, arguments%code)
         case default
            call say(program, "unknown option '"//word//"'; see --help")
            arguments%code = exit_bad_input
         end select
      end do
      if (size(arguments%files) == 0) arguments%files = ['-']
   end subroutine read_arguments

   !> Two cases whose devices would have the same names would overwrite each other.
   subroutine check_names(arguments)
      type(arguments_t), intent(inout) :: arguments
      integer :: i, k

      do i = 2, size(arguments%files)
         do k = 1, i - 1
            if (stem_of(arguments%files(i), arguments%output_dir) /= stem_of(arguments%files(k), arguments%output_dir)) cycle
            call say(arguments%program, "'"//trim(arguments%files(k))//"' and '"//trim(arguments%files(i))// &
                     "' would write the same files '"// &
                     stem_of(arguments%files(i), arguments%output_dir)//".dev7' and so on; rename one or run them apart")
            arguments%code = exit_bad_input
            return
         end do
      end do
   end subroutine check_names

   function argument(i) result(word)
      integer, intent(in) :: i
      character(:), allocatable :: word
      integer :: length

      call get_command_argument(i, length=length)
      allocate (character(length) :: word)
      call get_command_argument(i, value=word)
   end function argument

   subroutine value_of(program, option, i, value, code)
      character(*), intent(in) :: program, option
      integer, intent(inout) :: i
      character(:), allocatable, intent(inout) :: value
      integer, intent(inout) :: code

      i = i + 1
      if (i <= command_argument_count()) then
         value = argument(i)
         if (len(value) > 0) return
      end if
      call say(program, option//' wants a value; see --help')
      code = exit_bad_input
   end subroutine value_of

   !> A line on standard error.
   subroutine say(program, text)
      character(*), intent(in) :: program, text

      call write_standard_error(program//': '//text//new_line('a'))
   end subroutine say

   !> Errors and warnings on standard error, one a line.
   subroutine show_findings(findings)
      type(diagnostics_t), intent(in) :: findings
      integer :: i

      do i = 1, findings%count
         call write_standard_error(findings%list(i)%render()//new_line('a'))
      end do
   end subroutine show_findings

   !> Write the files of the devices, then the listing; the exit status is raised if something cannot be written.
   subroutine write_devices(file, output_dir, suffix, devices, tell, code)
      character(*), intent(in) :: file, output_dir
      character(*), intent(in) :: suffix      !! between the case's name and .devN
      type(devices_t), intent(in) :: devices
      logical, intent(in) :: tell             !! name the files on standard error
      integer, intent(inout) :: code
      character(:), allocatable :: stem, written
      logical :: done

      stem = stem_of(file, output_dir)//suffix
      written = ''
      if (len(output_dir) > 0) call make_directory(output_dir)
      if (devices%one%length > 0) call write_one('1', 'search', devices%one%content())
      if (devices%two%length > 0) call write_one('2', 'first simplex', devices%two%content())
      if (devices%seven%length > 0) call write_one('7', 'linkage as a data set', devices%seven%content())
      if (devices%eight%length > 0) call write_one('8', 'input as read', devices%eight%content())
      if (devices%nine%length > 0) call write_one('9', 'table for plotting', devices%nine%content())
      if (tell .and. len(written) > 0) call write_standard_error('Written: '//stem//written//new_line('a'))
      call write_standard_output(devices%six%content(), done)
      if (.not. done) then
         call write_standard_error('cannot write the listing to standard output'//new_line('a'))
         code = exit_file_trouble
      end if

   contains

      subroutine write_one(number, purpose, text)
         character(*), intent(in) :: number, purpose, text

         call write_whole_file(stem//'.dev'//number, text, done)
         if (done) then
            if (len(written) > 0) written = written//', '
            written = written//'.dev'//number//' ('//purpose//')'
            return
         end if
         call write_standard_error("cannot write '"//stem//'.dev'//number//"'"//new_line('a'))
         code = exit_file_trouble
      end subroutine write_one
   end subroutine write_devices

   !> Name of the devices' files without `.devN`: that of the case without its ending.
   pure function stem_of(file, output_dir) result(stem)
      character(*), intent(in) :: file, output_dir
      character(:), allocatable :: stem
      integer :: slash, dot

      stem = trim(file)
      if (stem == '-') stem = 'psalm'
      slash = index(stem, '/', back=.true.)
      dot = index(stem, '.', back=.true.)
      if (dot > slash + 1) stem = stem(:dot - 1)
      if (len(output_dir) > 0) stem = output_dir//'/'//stem(slash + 1:)
   end function stem_of

   subroutine show_progress(self, state)
      class(progress_t), intent(inout) :: self
      type(search_state_t), intent(in) :: state
      integer(int64) :: now, rate
      real(dp) :: seconds
      character(110) :: line         ! a longer one is cut

      if (.not. self%active) then
         if (.not. error_is_terminal()) return
         call system_clock(self%started)
         self%shown = self%started
         self%active = .true.
      end if
      call system_clock(now, rate)
      if (now - self%shown < rate/10) return
      self%shown = now
      seconds = real(now - self%started, dp)/real(rate, dp)
      line = 'iteration '//to_text(state%iteration)//' of '//to_text(state%limit)
      if (state%best < huge(state%best)) line = trim(line)//'  best '//trim(adjustl(general(state%best)))
      if (state%worst > state%best) line = trim(line)//'  worst '//trim(adjustl(general(state%worst)))
      line = trim(line)//'  '//to_text(count_of(real(state%evaluations, dp)/seconds))//' evaluations/s  '// &
             to_text(count_of(seconds*real(state%limit - state%iteration, dp)/real(max(1, state%iteration), dp)))//' s left at most'
      call write_standard_error(achar(13)//line)

   contains

      pure integer function count_of(number)
         real(dp), intent(in) :: number

         count_of = nint(min(number, 1.0e9_dp))
      end function count_of
   end subroutine show_progress
end module psalm_console
