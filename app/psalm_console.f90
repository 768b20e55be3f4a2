!> What the programs of the suite share at the console: arguments, messages, files of the devices, the progress line.
module psalm_console
   use, intrinsic :: iso_c_binding, only: c_char, c_null_char, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_devices, only: devices_t
   use psalm_files, only: exchange_t, check_target, directory_of
   use psalm_item_list, only: list_groups, list_items, why_no_group, write_schema
   use psalm_kinds, only: dp, wp
   use psalm_mark, only: mark_t
   use psalm_number, only: parse_integer
   use psalm_robot_formats, only: robot_formats_t
   use psalm_solver, only: observer_t, search_state_t
   use psalm_status, only: diagnostics_t, exit_bad_input, exit_done, exit_file_error
   use psalm_system, only: identity_t, begin_program, error_is_terminal, error_text, identity_of, identity_of_open, &
                           make_directories, same_file, standard_error, standard_input, standard_output, write_standard_error, &
                           write_standard_output
   use psalm_stop, only: stop_request_t
   use psalm_tables, only: for_plots
   use psalm_table_csv, only: write_csv
   use psalm_table_json, only: write_json
   use psalm_text, only: text_t, general, to_text
   use psalm_version, only: version, words_of_build
   implicit none (type, external)
   private
   public :: arguments_t, progress_t, path_progress_t, begin, begin_mark, device4_of, prepare_outputs, say, show_findings, &
             stem_of, write_devices

   interface
      !> Names of environment variables that the run-time libraries would not have understood and have not seen.
      subroutine c_set_aside(text, room) bind(c, name='psalm_set_aside')
         import :: c_char, c_size_t
         implicit none (type, external)
         character(kind=c_char), intent(inout) :: text(*)
         integer(c_size_t), value :: room
      end subroutine c_set_aside
   end interface

   integer, parameter :: most_threads = 1024
   integer, parameter :: longest_names = 256
   character(*), parameter :: nl = new_line('a')

   !> The command line.
   type :: arguments_t
      character(:), allocatable :: program       !! name of the program
      character(:), allocatable :: files(:)      !! cases, `-` for standard input
      character(:), allocatable :: output_dir    !! empty: beside the case
      character(:), allocatable :: device4       !! empty: CASE.dev4
      integer :: threads = 0                     !! 0: not given
      logical :: json = .false.                  !! all tables of every case as CSV and JSON
      logical :: edit = .false., no_case = .false. !! balm: the drawing board; no case is named
      logical :: sheet = .false.            !! balm: a page of all cases, moving
      logical :: kinds = .false.            !! psalm: kinds of linkages are listed, not searched
      logical :: curves = .false., assemblies = .false. !! curves too; psalm, balm: all assemblies
      logical :: phase = .false.                   !! balm: phase planes too
      logical :: animate = .false.                 !! balm: an SVG that moves
      type(robot_formats_t) :: robots              !! balm: models of the bodies for other programs
      ! psalm, bridge: numbered work
      integer :: part = 0, parts = 0             !! --part K/N; 0: not given
      logical :: merge = .false., so_far = .false. !! go on from files of parts; report what they have
      integer :: every = 0                       !! seconds between two files; 0: not given
      logical :: links = .false.                 !! psalm: sketches as &LINKS on device 7
      logical :: quiet = .false., help = .false., version = .false.
      logical :: items = .false., schema = .false. !! the items of a case are asked for, as a list or as a schema
      character(:), allocatable :: group         !! those of this group; empty: of all
      type(identity_t), allocatable :: inputs(:) !! of all files that are read, and of the standard streams
      integer :: code = 0                        !! exit status that bad arguments lead to
      logical :: no_place = .false.              !! the directory for the outputs cannot be made: no further case is begun
   end type arguments_t

   !> Progress line on a terminal, at most ten times a second.
   type, extends(observer_t) :: progress_t
      integer(int64) :: started = 0_int64, shown = 0_int64
      logical :: active = .false.
   contains
      procedure :: report => show_progress
   end type progress_t

   !> The same for studies that follow paths; what ends them is another's.
   type, extends(stop_request_t) :: path_progress_t
      class(stop_request_t), pointer :: request => null()
      integer(int64) :: shown = 0_int64
      integer :: most = 0                             !! paths that were shown: threads may come one after another
      logical :: active = .false.
   contains
      procedure :: asked => ask_other
      procedure :: reported => show_paths
   end type path_progress_t

contains

   !> What every program does first: read the command line, answer --help and --version, refuse mistakes.
   !>
   !> `finished` is true if there is nothing left to do; the program then ends with `arguments%code`.
   subroutine begin(program, help, endings, arguments, finished)
      character(*), intent(in) :: program, help         !! name of the program; text of --help
      character(*), intent(in) :: endings(:)            !! of the files that it may write for a case
      type(arguments_t), intent(out) :: arguments
      logical, intent(out) :: finished
      logical :: done

      call begin_program()
      call read_arguments(program, arguments)
      finished = .true.
      if (arguments%code == exit_bad_input) return
      if (arguments%help .or. arguments%version) then
         if (arguments%help) then
            call write_standard_output(help, done)
         else
            call write_standard_output(program//' '//version//new_line('a')//words_of_build()//new_line('a'), done)
         end if
         if (.not. done) arguments%code = exit_file_error
         return
      end if
      if (arguments%items) then
         call tell_items(arguments)
         return
      end if
      if (.not. arguments%quiet) call tell_set_aside(program)
      call find_inputs(arguments)
      call check_names(arguments)
      call check_inputs(arguments, endings)
      finished = arguments%code == exit_bad_input
   end subroutine begin

   !> The items that a case may have, on standard output.
   subroutine tell_items(arguments)
      type(arguments_t), intent(inout) :: arguments
      type(text_t) :: text
      character(:), allocatable :: reason
      logical :: done

      reason = ''
      if (arguments%schema) then
         call write_schema(arguments%program, version, text)
      else if (len(arguments%group) == 0) then
         call list_groups(arguments%program, text)
      else
         reason = why_no_group(arguments%program, arguments%group)
         if (len(reason) == 0) call list_items(arguments%group, text)
      end if
      if (len(reason) > 0) then
         call say(arguments%program, reason)
         arguments%code = exit_bad_input
         return
      end if
      call write_standard_output(text%content(), done)
      if (.not. done) arguments%code = exit_file_error
   end subroutine tell_items

   !> A remark on environment variables that are not understood.
   subroutine tell_set_aside(program)
      character(*), intent(in) :: program
      character(longest_names, kind=c_char) :: names
      integer :: length

      names = c_null_char
      call c_set_aside(names, int(longest_names, c_size_t))
      length = index(names, c_null_char) - 1
      if (length > 0) call say(program, names(:length)//' in the environment: without effect, for the value is not understood '// &
                               'or not used')
   end subroutine tell_set_aside

   !> Identities of what the program reads, and of files that standard output and standard error go to.
   subroutine find_inputs(arguments)
      type(arguments_t), intent(inout) :: arguments
      integer :: i

      associate (files => arguments%files)
         allocate (arguments%inputs(2*size(files) + 3))
         do i = 1, size(files)
            if (trim(files(i)) == '-') then
               arguments%inputs(i) = identity_of_open(standard_input)
            else
               arguments%inputs(i) = identity_of(trim(files(i)))
            end if
            arguments%inputs(size(files) + i) = identity_of(device4_of(arguments, trim(files(i))))
         end do
         arguments%inputs(2*size(files) + 1:) = [identity_of_open(standard_output), identity_of_open(standard_error), &
                                                 identity_of(arguments%device4)]
      end associate
   end subroutine find_inputs

   !> No output may be an input: refuse before any work.
   subroutine check_inputs(arguments, endings)
      type(arguments_t), intent(inout) :: arguments
      character(*), intent(in) :: endings(:)
      character(:), allocatable :: message
      integer :: i, k, code

      do i = 1, size(arguments%files)
         do k = 1, size(endings)
            call check_target(stem_of(trim(arguments%files(i)), arguments%output_dir)//trim(endings(k)), arguments%inputs, &
                              message, code)
            if (code /= exit_bad_input) cycle
            call say(arguments%program, message)
            arguments%code = exit_bad_input
         end do
      end do
   end subroutine check_inputs

   !> Device 4 of a case.
   pure function device4_of(arguments, file) result(device4)
      type(arguments_t), intent(in) :: arguments
      character(*), intent(in) :: file
      character(:), allocatable :: device4

      device4 = arguments%device4
      if (len(device4) == 0) device4 = stem_of(file, '')//'.dev4'
   end function device4_of

   !> The mark of a run, to which its input is to be added: program, version and kind of the numbers.
   function begin_mark(program) result(mark)
      character(*), intent(in) :: program
      type(mark_t) :: mark

      call mark%add(program//' '//version//' '//to_text(storage_size(1.0_wp)))
   end function begin_mark

   !> Make the directory for the outputs of a case and see whether they may be written, before any work is done.
   subroutine prepare_outputs(arguments, stem, endings, ready, code)
      type(arguments_t), intent(inout) :: arguments
      character(*), intent(in) :: stem                  !! of the outputs' names
      character(*), intent(in) :: endings(:)
      logical, intent(out) :: ready                     !! false: what hinders was reported
      integer, intent(inout) :: code                    !! exit status, raised then
      character(:), allocatable :: message
      integer :: k, error, reason

      ready = .true.
      if (len(arguments%output_dir) > 0) then
         call make_directories(arguments%output_dir, error)
         if (error /= 0) then
            call say(arguments%program, "cannot make the directory '"//arguments%output_dir//"'"//error_text(error))
            arguments%no_place = .true.
            ready = .false.
            code = exit_file_error
            return
         end if
      end if
      do k = 1, size(endings)
         call check_target(stem//trim(endings(k)), arguments%inputs, message, reason)
         if (reason == exit_done) cycle
         call say(arguments%program, message)
         ready = .false.
         code = max(code, reason)
      end do
   end subroutine prepare_outputs

   !> Read the command line. Mistakes are reported on standard error.
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
      arguments%group = ''
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
         case ('--curves', '--assemblies', '--edit', '--animate', '--phase', '--sheet', '--mjcf', '--sdf', &
               '--urdf', '--freecad')
            if (program /= 'balm' .and. .not. (program == 'ssics' .and. word == '--curves') .and. &
                .not. (program == 'psalm' .and. word == '--assemblies')) then
               call say(program, "'"//word//"' is an option of balm"// &
                        trim(merge(' and ssics', '          ', word == '--curves'))// &
                        trim(merge(' and psalm', '          ', word == '--assemblies'))//'; see --help')
               arguments%code = exit_bad_input
            end if
            arguments%edit = arguments%edit .or. word == '--edit'
            arguments%curves = arguments%curves .or. word == '--curves'
            arguments%assemblies = arguments%assemblies .or. word == '--assemblies'
            arguments%animate = arguments%animate .or. word == '--animate' .or. word == '--sheet'
            arguments%phase = arguments%phase .or. word == '--phase'
            arguments%sheet = arguments%sheet .or. word == '--sheet'
            arguments%robots%mjcf = arguments%robots%mjcf .or. word == '--mjcf'
            arguments%robots%sdf = arguments%robots%sdf .or. word == '--sdf'
            arguments%robots%urdf = arguments%robots%urdf .or. word == '--urdf'
            arguments%robots%freecad = arguments%robots%freecad .or. word == '--freecad'
         case ('--links')
            if (program /= 'psalm') then
               call say(program, "unknown option '"//word//"'; see --help")
               arguments%code = exit_bad_input
            end if
            arguments%links = .true.
         case ('--kinds')
            if (program /= 'psalm') then
               call say(program, "unknown option '"//word//"'; see --help")
               arguments%code = exit_bad_input
            end if
            arguments%kinds = .true.
         case ('--merge', '--resume', '--so-far', '--part', '--checkpoint')
            if (all(program /= ['psalm ', 'bridge'])) then
               call say(program, "'"//word//"' is an option of psalm and bridge; see --help")
               arguments%code = exit_bad_input
            end if
            arguments%merge = arguments%merge .or. any(word == ['--merge ', '--resume'])
            arguments%so_far = arguments%so_far .or. word == '--so-far'
            number = ''
            if (word == '--part' .or. word == '--checkpoint') call value_of(program, word, i, number, arguments%code)
            if (word == '--part' .and. len(number) > 0) call read_part(number, arguments)
            if (word == '--checkpoint' .and. len(number) > 0) then
               call parse_integer(number, arguments%every, valid, reason)
               if (.not. valid .or. arguments%every < 1) then
                  call say(program, "--checkpoint expects a whole number of seconds; found '"//number//"'")
                  arguments%code = exit_bad_input
               end if
            end if
         case ('--json')
            arguments%json = program /= 'balm'
            if (.not. arguments%json) then
               call say(program, '--json is an option of the programs that compute: psalm (positions, with IPLOT=1 the whole '// &
                        'turn), kalm (rates, forces, motion in time), muscle, ssics, bridge, calm')
               arguments%code = exit_bad_input
            end if
         case ('--items')
            arguments%items = .true.
            if (i < command_argument_count()) then
               word = argument(i + 1)
               if (index(word, '-') /= 1) then
                  arguments%group = word(index(word, '&') + 1:)
                  i = i + 1
               end if
            end if
         case ('--items=json')
            arguments%items = .true.
            arguments%schema = .true.
         case ('--output-dir')
            call value_of(program, word, i, arguments%output_dir, arguments%code)
         case ('--threads')
            number = ''
            call value_of(program, word, i, number, arguments%code)
            call parse_integer(number, arguments%threads, valid, reason)
            if (len(number) > 0 .and. (.not. valid .or. arguments%threads < 1 .or. arguments%threads > most_threads)) then
               call say(program, "--threads expects an integer from 1 to "//to_text(most_threads)//"; found '"//number//"'")
               arguments%code = exit_bad_input
            end if
         case ('--device4')
            call value_of(program, word, i, arguments%device4, arguments%code)
         case default
            call say(program, "unknown option '"//word//"'; see --help")
            arguments%code = exit_bad_input
         end select
      end do
      arguments%no_case = size(arguments%files) == 0
      if (arguments%edit .and. (arguments%curves .or. arguments%assemblies .or. arguments%animate .or. &
                                arguments%phase .or. arguments%robots%any())) then
         call say(program, '--edit makes the drawing board and no pictures or models; leave --curves, --assemblies, --animate, '// &
                  '--phase, --mjcf, --sdf, --urdf and --freecad out')
         arguments%code = exit_bad_input
      end if
      if (count([arguments%parts > 0, arguments%merge, arguments%so_far]) > 1) then
         call say(program, '--part makes a part, --merge (or --resume) goes on from all that were made, --so-far makes nothing '// &
                  'more: one of them at a time')
         arguments%code = exit_bad_input
      end if
      if (arguments%no_case) arguments%files = ['-']
   end subroutine read_arguments

   !> K/N.
   subroutine read_part(text, arguments)
      character(*), intent(in) :: text
      type(arguments_t), intent(inout) :: arguments
      character(:), allocatable :: reason
      logical :: valid(2)
      integer :: slash

      slash = index(text, '/')
      valid = .false.
      if (slash > 0) then
         call parse_integer(text(:slash - 1), arguments%part, valid(1), reason)
         call parse_integer(text(slash + 1:), arguments%parts, valid(2), reason)
      end if
      if (all(valid) .and. arguments%part >= 1 .and. arguments%part <= arguments%parts) return
      call say(arguments%program, "--part expects K/N, the K-th of N parts, as 3/16; found '"//text//"'")
      arguments%code = exit_bad_input
   end subroutine read_part

   !> Two cases whose devices would have the same names would overwrite each other.
   subroutine check_names(arguments)
      type(arguments_t), intent(inout) :: arguments
      integer :: i, k

      do i = 2, size(arguments%files)
         do k = 1, i - 1
            if (.not. same_stem(stem_of(arguments%files(i), arguments%output_dir), &
                                stem_of(arguments%files(k), arguments%output_dir))) cycle
            call say(arguments%program, "'"//trim(arguments%files(k))//"' and '"//trim(arguments%files(i))// &
                     "' would write the same files '"// &
                     stem_of(arguments%files(i), arguments%output_dir)//".dev7' and so on; rename one or run them apart")
            arguments%code = exit_bad_input
            return
         end do
      end do
   end subroutine check_names

   !> True if two stems name the same files: the same name in the same directory, however that is written.
   logical function same_stem(one, other)
      character(*), intent(in) :: one, other

      same_stem = one == other
      if (same_stem .or. name_in_directory(one) /= name_in_directory(other)) return
      same_stem = same_file(identity_of(directory_of(one)), identity_of(directory_of(other)))
   end function same_stem

   pure function name_in_directory(path) result(name)
      character(*), intent(in) :: path
      character(:), allocatable :: name

      name = path(index(path, '/', back=.true.) + 1:)
   end function name_in_directory

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
      call say(program, option//' expects a value; see --help')
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
   subroutine write_devices(arguments, stem, devices, code)
      type(arguments_t), intent(in) :: arguments
      character(*), intent(in) :: stem        !! of the files' names
      type(devices_t), intent(in) :: devices
      integer, intent(inout) :: code
      type(exchange_t) :: files
      character(:), allocatable :: nine, written
      logical :: done
      integer :: first_line, k

      written = ''
      call files%begin(directory_of(stem), arguments%inputs)
      if (devices%one%length > 0) call add('1', 'search', '! run '//devices%mark//nl//devices%one%content())
      if (devices%two%length > 0) call add('2', 'first simplex', '! run '//devices%mark//nl//devices%two%content())
      if (devices%seven%length > 0) call add('7', 'linkage as a data set', '! run '//devices%mark//nl//devices%seven%content())
      if (devices%eight%length > 0) call add('8', 'input as read', devices%eight%content()) ! has the mark in its header
      nine = devices%nine()
      if (len(nine) > 0) then
         ! the first line names the columns, where programs that plot look for them
         first_line = index(nine, nl)
         call add('9', 'table for plotting', nine(:first_line)//'# run '//devices%mark//nl//nine(first_line + 1:))
      end if
      call add_tables()
      if (allocated(devices%drawings)) then
         do k = 1, size(devices%drawings)
            call files%add(stem//devices%drawings(k)%ending, devices%drawings(k)%content)
            written = written//', '//devices%drawings(k)%ending
         end do
      end if
      call files%finish()
      if (files%code /= exit_done) then
         call say(arguments%program, files%message)
         code = max(code, files%code)
      else if (.not. arguments%quiet .and. len(written) > 0) then
         call write_standard_error('Written: '//stem//written//nl)
      end if
      call write_standard_output(devices%six%content(), done)
      if (done) return
      call say(arguments%program, 'cannot write the listing to standard output')
      code = exit_file_error

   contains

      !> Tables for other programs: one CSV file each, all of them as JSON.
      subroutine add_tables()
         type(text_t) :: text
         character(:), allocatable :: ending
         integer :: i, t

         if (.not. devices%has_tables()) return
         do i = 1, devices%last_case()
            do t = 1, devices%cases(i)%count
               associate (table => devices%cases(i)%tables(t))
                  if (table%audience == for_plots) cycle
                  if (.not. (arguments%json .or. (table%main .and. devices%cases(i)%in_file))) cycle
                  ending = '.csv'
                  if (.not. table%main) ending = '.'//table%block//ending
                  if (i > 1) ending = '-'//to_text(i)//ending
                  text%length = 0
                  call write_csv(table, text)
                  call files%add(stem//ending, text%content())
                  written = written//', '//ending
               end associate
            end do
         end do
         if (.not. arguments%json) return
         text%length = 0
         call write_json(devices%cases(:devices%last_case()), arguments%program, version, devices%mark, text)
         call files%add(stem//'.json', text%content())
         written = written//', .json (all tables)'
      end subroutine add_tables

      subroutine add(number, purpose, text)
         character(*), intent(in) :: number, purpose, text

         call files%add(stem//'.dev'//number, text)
         if (len(written) > 0) written = written//', '
         written = written//'.dev'//number//' ('//purpose//')'
      end subroutine add
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

   subroutine show_progress(self, state, points, objectives)
      class(progress_t), intent(inout) :: self
      type(search_state_t), intent(in) :: state
      real(wp), intent(in), optional :: points(:, :), objectives(:) ! not shown
      integer(int64) :: now, rate
      real(dp) :: seconds
      character(110) :: line         ! a longer one is cut

      associate (unused => present(points) .or. present(objectives))
      end associate
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

   logical function ask_other(self) result(asked)
      class(path_progress_t), intent(in) :: self

      asked = .false.
      if (associated(self%request)) asked = self%request%asked()
   end function ask_other

   subroutine show_paths(self, done, of)
      class(path_progress_t), intent(inout) :: self
      integer, intent(in) :: done, of
      integer(int64) :: now, rate
      character(60) :: line

      call system_clock(now, rate)
      if (.not. self%active) then
         if (.not. error_is_terminal()) return
         self%active = .true.
      else if (now - self%shown < rate/10 .or. done < self%most) then
         return
      end if
      self%shown = now
      self%most = done
      line = 'path '//to_text(done)//' of '//to_text(of)
      call write_standard_error(achar(13)//line)
   end subroutine show_paths
end module psalm_console
