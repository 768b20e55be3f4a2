!> What the verbs of the library share: a case made ready for a study, what checks find, the report.
!>
!> A verb begins its frame, looks whether it is `ready`, studies, and concludes the report. Where a check of the study notes faults
!> in `noted`, it asks `fails`.
module psalm_study_frame
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use psalm_case, only: case_t, make_ready, of_text, set_of, tell
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, drawing_t
   use psalm_error, only: motion_t, problem_t
   use psalm_finale, only: describe_violation
   use psalm_kinds, only: wp
   use psalm_preparation, only: memory_need_t, prepared_t
   use psalm_search_group, only: most_search_threads
   use psalm_status, only: findings_t => diagnostics_t, exit_violation
   use psalm_tables, only: table_t, tables_t, for_plots, tables_of
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: frame_t, report_t, column_named, need_of_rates, no_report, warn, empty_motion, threads_of, may_share

   type(memory_need_t), parameter :: need_of_rates = memory_need_t(position=1000, arc=400)

   !> What the programs write for a case.
   type :: report_t
      character(:), allocatable :: listing         !! as the program prints it; of `summary` its text
      type(tables_t) :: tables                     !! columns by name
      character(:), allocatable :: data_set        !! the linkages found, in the notation of the manual; empty: none
      type(case_t), allocatable :: cases(:)        !! the same as cases, the best first
      type(drawing_t), allocatable :: files(:)     !! pictures and pages: ending of their name, content
      logical :: violated = .false.                !! closure or a limit is violated, or the study stopped early
   contains
      procedure :: find => find_table
      procedure :: column
   end type report_t

   !> A case in the hands of a verb.
   type :: frame_t
      class(data_set_t), allocatable :: set
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(devices_t) :: devices                   !! what is written on them is the report
      type(findings_t) :: noted                    !! by checks of the study
      logical :: ready = .false.                   !! without errors so far
   contains
      procedure :: begin
      procedure :: read
      procedure :: fails
      procedure :: conclude
      procedure :: end_early
   end type frame_t

contains

   !> Make a case ready: read, checked, its problem made. Errors: those of the case, and a group that is not there.
   subroutine begin(self, case, findings, report, group, every_loop, need, reader, does, turning)
      class(frame_t), intent(inout) :: self
      type(case_t), intent(in) :: case
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(inout), optional :: report   !! is empty then
      character(*), intent(in), optional :: group         !! that must be given
      logical, intent(in), optional :: every_loop         !! solve loops that the output does not depend on too
      type(memory_need_t), intent(in), optional :: need      !! for memory
      character(*), intent(in), optional :: reader        !! the program whose study it is; default psalm
      character(*), intent(in), optional :: does          !! what it does, for messages: 'bridge studies'
      logical, intent(in), optional :: turning            !! it needs a crank that turns

      if (present(report)) call no_report(report)
      call make_ready(case, self%set, self%prepared, self%problem, self%ready, findings, every_loop, need, reader, does, &
                      turning)
      if (self%ready) call take_up(self, findings, group)
   end subroutine begin

   !> Read a case that needs no linkage; or whose linkage the study prepares itself.
   subroutine read(self, case, findings, report, group, reader)
      class(frame_t), intent(inout) :: self
      type(case_t), intent(in) :: case
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(inout), optional :: report   !! is empty then
      character(*), intent(in), optional :: group         !! that must be given
      character(*), intent(in), optional :: reader        !! the program whose study it is; default psalm
      type(findings_t) :: own

      if (present(report)) call no_report(report)
      call set_of(case, self%set, own, reader)
      call tell(own, findings)
      self%ready = .not. own%failed()
      if (self%ready) call take_up(self, findings, group)
   end subroutine read

   subroutine take_up(self, findings, group)
      class(frame_t), intent(inout) :: self
      type(findings_t), intent(inout) :: findings
      character(*), intent(in), optional :: group

      self%noted%file = self%set%file
      if (present(group)) then
         self%ready = self%set%gives(group)
         if (.not. self%ready) call findings%error('the group is missing: it says what is wanted', line=self%set%title_line, &
                                                   group=group)
      end if
      call self%devices%begin_case(self%set%title, .false.)
   end subroutine take_up

   !> True if a check has noted errors; what it noted is reported.
   logical function fails(self, findings)
      class(frame_t), intent(inout) :: self
      type(findings_t), intent(inout) :: findings

      call tell(self%noted, findings)
      fails = self%noted%failed()
   end function fails

   !> The report is what the devices have received; remarks go to the findings, if these are given.
   subroutine conclude(self, report, findings)
      class(frame_t), intent(inout) :: self
      type(report_t), intent(inout), optional :: report
      type(findings_t), intent(inout), optional :: findings

      associate (devices => self%devices)
         if (present(findings)) call findings%append(devices%remarks)
         if (.not. present(report)) return
         report%listing = devices%six%content()
         report%data_set = devices%seven%content()
         if (allocated(devices%cases)) call devices%cases(1)%hand_over(report%tables)
         if (allocated(devices%drawings)) call move_alloc(devices%drawings, report%files)
         if (len(report%data_set) > 0) call of_text(report%data_set, report%cases)
         report%violated = report%violated .or. devices%code == exit_violation
      end associate
   end subroutine conclude

   !> The host asked for the end before there was a result.
   subroutine end_early(self, report, findings)
      class(frame_t), intent(inout) :: self
      type(report_t), intent(inout), optional :: report
      type(findings_t), intent(inout) :: findings

      self%ready = .false.
      if (present(report)) report%violated = .true.
      call findings%warning('the study was ended before it had a result')
   end subroutine end_early

   ! ---- what several verbs do -----------------------------------------------------------------------------------------

   !> A warning for every violation.
   subroutine warn(problem, motion, findings)
      use psalm_chain_report, only: unreached_words
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(findings_t), intent(inout) :: findings
      integer :: i

      do i = 1, size(motion%violations)
         call findings%warning(describe_violation(problem, motion%input, motion%violations(i), small=.true.))
      end do
      if (.not. allocated(motion%beyond)) return
      if (any(motion%beyond)) call findings%warning(unreached_words(motion%beyond))
   end subroutine warn

   pure subroutine empty_motion(motion)
      type(motion_t), intent(out) :: motion

      allocate (motion%closed(0), motion%input(0), motion%actual(0, 0), motion%error(0, 0))
      allocate (motion%violations(0), motion%crossings(0))
   end subroutine empty_motion

   pure integer function threads_of(threads)
      integer, intent(in), optional :: threads

      threads_of = 0
      if (present(threads)) threads_of = max(0, threads)
   end function threads_of

   !> False, with an error, if more threads are asked for than THREADS may be, or a negative number.
   logical function may_share(threads, findings)
      integer, intent(in), optional :: threads
      type(findings_t), intent(inout) :: findings

      may_share = .true.
      if (present(threads)) may_share = threads >= 0 .and. threads <= most_search_threads
      if (may_share) return
      if (threads < 0) then
         call findings%error(to_text(threads)//' threads are no number of them; give 0 for that of the case')
      else
         call findings%error(to_text(threads)//' threads are too many; give at most '//to_text(most_search_threads))
      end if
   end function may_share

   ! ---- reports -----------------------------------------------------------------------------------------------------

   !> A report with nothing in it.
   subroutine no_report(report)
      type(report_t), intent(inout) :: report

      report%listing = ''
      report%data_set = ''
      report%tables = tables_of('')
      if (.not. allocated(report%cases)) allocate (report%cases(0))
      if (.not. allocated(report%files)) allocate (report%files(0))
   end subroutine no_report

   !> Number of the table of that name, of those for other programs; 0: there is none.
   pure integer function find_table(self, name) result(place)
      class(report_t), intent(in) :: self
      character(*), intent(in) :: name

      do place = self%tables%count, 1, -1
         if (self%tables%tables(place)%audience /= for_plots .and. self%tables%tables(place)%block == name) return
      end do
   end function find_table

   !> The numbers of a column, shape (rows): `report%column('positions', 'P.x')`; NaN for what is not known, nothing if there is no
   !> such column.
   pure function column(self, table, name) result(values)
      class(report_t), intent(in) :: self
      character(*), intent(in) :: table, name
      real(wp), allocatable :: values(:)
      integer :: t, c

      allocate (values(0))
      t = self%find(table)
      if (t == 0) return
      c = column_named(self%tables%tables(t), name)
      if (c == 0) return
      associate (one => self%tables%tables(t)%columns(c))
         if (allocated(one%values)) values = merge(one%values, ieee_value(1.0_wp, ieee_quiet_nan), one%known)
      end associate
   end function column

   !> Number of the column of that name; 0: there is none.
   pure integer function column_named(table, name) result(place)
      type(table_t), intent(in) :: table
      character(*), intent(in) :: name

      do place = table%count, 1, -1
         if (table%columns(place)%name == name) return
      end do
   end function column_named
end module psalm_study_frame
