!> What the programs with a listing do alike: read a file of cases, prepare and study each, write what they say.
module psalm_batch
   use psalm_cases, only: read_cases
   use psalm_console, only: arguments_t, begin_mark, prepare_outputs, say, show_findings, stem_of, write_devices
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_mark, only: mark_t
   use psalm_preparation, only: prepared_t
   use psalm_status, only: diagnostics_t, exit_bad_input, exit_done, exit_violation
   use psalm_system, only: write_standard_error
   use psalm_team, only: team_t
   use psalm_text, only: to_text
   use psalm_work_parts, only: all_of_it, known_only, one_part, part_name
   implicit none (type, external)
   private
   public :: csv_of_sketches, csv_always
   public :: outputs_t, prepare_case, study_case, common_options, json_option, parts_options, run_file, run_files, ending_of_case

   integer, parameter :: ending_length = 16
   integer, parameter :: csv_asked = 0               !! with --json
   integer, parameter :: csv_of_sketches = 1         !! of sketches always
   integer, parameter :: csv_always = 2
   character(*), parameter :: nl = new_line('a')

   !> Options that every program has, for its `--help`.
   character(*), parameter :: common_options = &
      '  --output-dir DIR  put the files into DIR'//nl// &
      '  --quiet           no remarks on standard error, errors only'//nl// &
      '  --items [GROUP]   print the groups that a case may have, or the items of one; --items=json: a JSON schema'//nl// &
      '  --version         print the version, the commit it was built from, compiler and instruction set'//nl// &
      '  --help            print this text'//nl

   !> That of the programs that compute.
   character(*), parameter :: json_option = &
      '  --json            all tables of every case as CSV and JSON: CASE.csv, CASE.BLOCK.csv, CASE.json'//nl

   !> Those of the programs whose work can be divided.
   character(*), parameter :: parts_options = &
      '  --part K/N        make the K-th of N parts of the numbered work: CASE.partK'//nl// &
      '  --merge, --resume go on from all CASE.partK that there are, to the end'//nl// &
      '  --so-far          report what they have, without going on'//nl// &
      '  --checkpoint S    write what was made every S seconds: CASE.part1, to resume from'//nl

   !> Files that a program writes beside a case.
   type :: outputs_t
      character(:), allocatable :: suffix            !! between the name of the case and the endings
      character(5), allocatable :: endings(:)        !! of every run
      character(5), allocatable :: of_search(:)      !! of a run that searches, besides
      character(5), allocatable :: of_case(:)        !! of each case; from the second on with its number
      integer :: csv = csv_asked                     !! when the main table of a case is written as CSV
   end type outputs_t

   abstract interface
      !> Prepare one case of a file; what else is read is added to the mark of the run.
      subroutine prepare_case(file, set, prepared, findings, mark)
         import :: data_set_t, diagnostics_t, mark_t, prepared_t
         implicit none (type, external)
         character(*), intent(in) :: file
         type(data_set_t), intent(in) :: set
         type(prepared_t), intent(inout) :: prepared
         type(diagnostics_t), intent(inout) :: findings
         type(mark_t), intent(inout) :: mark
      end subroutine prepare_case

      !> Study one case and report; `stopped` if the next is not to be begun.
      subroutine study_case(number, set, prepared, devices, stopped)
         import :: data_set_t, devices_t, prepared_t
         implicit none (type, external)
         integer, intent(in) :: number               !! of the case in its file
         type(data_set_t), intent(in) :: set
         type(prepared_t), intent(in) :: prepared
         type(devices_t), intent(inout) :: devices
         logical, intent(inout) :: stopped
      end subroutine study_case

      !> What the cases of a file have in common.
      subroutine study_cases(sets, prepared, devices)
         import :: data_set_t, devices_t, prepared_t
         implicit none (type, external)
         type(data_set_t), allocatable, intent(inout) :: sets(:)
         type(prepared_t), allocatable, intent(inout) :: prepared(:) !! shape (cases)
         type(devices_t), intent(inout) :: devices
      end subroutine study_cases

      !> Why the work of the cases of a file cannot be divided into parts; empty: it can.
      function assess_cases(sets) result(reason)
         import :: data_set_t
         implicit none (type, external)
         type(data_set_t), intent(in) :: sets(:)
         character(:), allocatable :: reason
      end function assess_cases
   end interface

contains

   !> Ending of a file that belongs to one case of several.
   pure function ending_of_case(number, ending) result(text)
      integer, intent(in) :: number
      character(*), intent(in) :: ending
      character(ending_length) :: text

      text = ending
      if (number > 1) text = '-'//to_text(number)//ending
   end function ending_of_case

   !> Run the cases of all files of the command line.
   subroutine run_files(arguments, outputs, prepare_it, study, code, team, divided)
      type(arguments_t), intent(inout) :: arguments
      type(outputs_t), intent(in) :: outputs
      procedure(prepare_case) :: prepare_it
      procedure(study_case) :: study
      integer, intent(inout) :: code                 !! exit status
      class(team_t), intent(inout), optional :: team !! who does the numbered work
      procedure(assess_cases), optional :: divided    !! given with the team
      integer :: i

      do i = 1, size(arguments%files)
         call run_file(arguments, trim(arguments%files(i)), outputs, prepare_it, study, code, team=team, divided=divided)
         if (arguments%no_place) exit
      end do
   end subroutine run_files

   !> Run all cases of a file. Mistakes are reported, and the exit status is raised.
   subroutine run_file(arguments, file, outputs, prepare_it, study, code, together, team, divided)
      type(arguments_t), intent(inout) :: arguments
      character(*), intent(in) :: file
      type(outputs_t), intent(in) :: outputs
      procedure(prepare_case) :: prepare_it
      procedure(study_case) :: study
      integer, intent(inout) :: code                 !! exit status
      procedure(study_cases), optional :: together   !! before the first case
      class(team_t), intent(inout), optional :: team !! who does the numbered work
      procedure(assess_cases), optional :: divided    !! given with the team
      type(diagnostics_t) :: findings
      type(data_set_t), allocatable :: sets(:)
      type(prepared_t), allocatable :: prepared(:)
      type(devices_t) :: devices
      type(mark_t) :: mark
      character(:), allocatable :: stem
      character(ending_length), allocatable :: endings(:)
      logical :: ready, stopped, shared
      integer :: k, i, written

      mark = begin_mark(arguments%program)
      call read_cases(file, sets, findings, program=arguments%program, mark=mark)
      allocate (prepared(size(sets)))
      do k = 1, size(sets)
         call prepare_it(file, sets(k), prepared(k), findings, mark)
      end do
      if (findings%failed() .or. .not. arguments%quiet) call show_findings(findings)
      code = max(code, findings%exit_code())
      if (findings%failed()) return
      stem = stem_of(file, arguments%output_dir)//outputs%suffix
      endings = [character(ending_length) :: outputs%endings]
      if (any([(sets(k)%wants_search(), k=1, size(sets))])) endings = [character(ending_length) :: endings, outputs%of_search]
      do k = 1, size(sets)
         if (arguments%json .or. in_file(sets(k))) endings = [character(ending_length) :: endings, ending_of_case(k, '.csv')]
      end do
      if (arguments%json) endings = [character(ending_length) :: endings, '.json']
      if (allocated(outputs%of_case)) then
         do k = 1, size(sets)
            endings = [character(ending_length) :: endings, (ending_of_case(k, outputs%of_case(i)), i=1, size(outputs%of_case))]
         end do
      end if
      call prepare_outputs(arguments, stem, endings, ready, code)
      if (.not. ready) return
      devices%mark = mark%name()
      stopped = .false.
      shared = .false.
      if (present(team)) shared = team%shares
      if (shared) then
         call begin_parts(arguments, stem, devices%mark, divided(sets), team, ready, code)
         if (.not. ready) return
      end if
      if (present(together)) call together(sets, prepared, devices)
      do k = 1, size(sets)
         if (shared) then
            ! what all have in common is not made yet
            if (team%mode == one_part .and. team%incomplete .and. k == 1) exit
            call team%begin_case(k)
         end if
         call devices%begin_case(trim(sets(k)%title), in_file(sets(k)))
         call study(k, sets(k), prepared(k), devices, stopped)
         if (stopped) exit
      end do
      if (shared) then
         call end_parts(arguments, team, code)
         if (team%mode == one_part .or. .not. team%delivers) return
      end if
      if (.not. arguments%quiet) then
         call show_findings(devices%remarks)
         call write_standard_error(devices%summary%content())
      end if
      code = max(code, devices%code)
      written = code
      call write_devices(arguments, stem, devices, written)
      if (shared) then
         if (team%mode == all_of_it .and. .not. team%ever_short .and. written == code) call team%remove_files()
      end if
      code = written
      if (allocated(devices%next) .and. .not. arguments%quiet) call write_standard_error('Next: '//devices%next//nl)

   contains

      !> True if the main table of a case goes into a CSV file without being asked for.
      logical function in_file(set)
         type(data_set_t), intent(in) :: set

         in_file = outputs%csv == csv_always .or. (outputs%csv == csv_of_sketches .and. (set%has_names() .or. set%of_kinds))
      end function in_file
   end subroutine run_file

   !> Before the numbered work of a file: what other runs have made of it.
   subroutine begin_parts(arguments, stem, mark, reason, team, ready, code)
      type(arguments_t), intent(in) :: arguments
      character(*), intent(in) :: stem, mark
      character(*), intent(in) :: reason             !! why the cases cannot be divided; empty: they can
      class(team_t), intent(inout) :: team
      logical, intent(out) :: ready                  !! false: what hinders was reported
      integer, intent(inout) :: code
      character(:), allocatable :: message
      integer :: files

      ready = .false.
      if (arguments%parts > 0 .and. .not. team%takes_part) then
         call say(arguments%program, 'cannot make a part: the ranks of this job share all parts; leave --part out')
         code = max(code, exit_bad_input)
         return
      end if
      if (arguments%every > 0) team%every = arguments%every
      team%mode = all_of_it
      if (arguments%parts > 0) then
         team%mode = one_part
         team%part = arguments%part
         team%parts = arguments%parts
      else if (arguments%so_far) then
         team%mode = known_only
      end if
      call team%begin(stem, mark, arguments%inputs)
      message = ''
      if (team%mode == one_part .and. len(reason) > 0) message = 'cannot make a part: '//reason
      if (len(message) == 0) then
         call team%read_parts(files, message)
         if (len(message) == 0 .and. files == 0 .and. (arguments%merge .or. arguments%so_far)) then
            message = "nothing to go on from: there is no file '"//part_name(stem, 1)//"', nor of another part"
         else if (len(message) == 0 .and. files > 0 .and. team%mode == all_of_it .and. .not. arguments%merge) then
            message = "an earlier run has left '"//part_name(stem, 1)//"' or files of other parts: go on from them with "// &
                      "--resume, or remove them"
         end if
      end if
      ready = len(message) == 0
      if (ready) return
      call say(arguments%program, message)
      code = max(code, exit_bad_input)
   end subroutine begin_parts

   !> After the work of a file: what is left to others, or to another run, is written.
   subroutine end_parts(arguments, team, code)
      type(arguments_t), intent(in) :: arguments
      class(team_t), intent(inout) :: team
      integer, intent(inout) :: code
      character(:), allocatable :: text

      if (team%mode == known_only) then
         if (team%ever_short) code = max(code, exit_violation)
         return
      end if
      if (team%mode == all_of_it .and. .not. team%ever_short) return
      if (team%mode == one_part .and. team%opened == 0) then
         call say(arguments%program, 'no part is written: the case came to no numbered work, a run without --part does all of it')
         code = max(code, exit_bad_input)
         return
      end if
      call team%write_file()
      if (team%code /= exit_done) then
         call say(arguments%program, team%message)
         code = max(code, team%code)
         return
      end if
      if (arguments%quiet .or. .not. team%delivers) return
      text = 'Written: '//part_name(team%stem, team%part)
      if (team%mode == one_part) text = text//' ('//to_text(team%made)//' items of part '//to_text(team%part)//' of '// &
                                        to_text(team%parts)//')'
      call write_standard_error(text//nl)
      if (team%mode == all_of_it) then
         text = arguments%program//' --resume goes on from there'
      else if (team%ever_incomplete) then
         text = 'when all parts are made, the parts once more for the next '// &
                'round, or --merge, which makes what is left itself'
      else
         text = 'all is made: --merge'
      end if
      call write_standard_error('Next: '//text//nl)
   end subroutine end_parts
end module psalm_batch
