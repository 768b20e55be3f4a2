!> PSALM as a library: the one module that another program uses.
!>
!> A `case_t` is a linkage and what is asked of it. It is read from a file (`read_file`), from text in memory (`read_text`), or made
!> by `new_case` and its verbs; what is not given has the default of the manual. The verbs `analyse`, `synthesise`, `find_rates`,
!> `find_forces` and `find_tolerances` study it: data in, results out. Nothing is printed, no file is written, no signal is touched.
!> Whatever is wrong with a case comes back as findings, each with its line and a text; results are then empty.
!>
!> Lengths are in the user's one unit, angles in degrees, rates of angles in radians.
module psalm
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use psalm_analysis, only: analysis_t, wanted_t, study_analysis => analyse
   use psalm_cases, only: read_cases, read_case_text
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t, violation_t, make_problem
   use psalm_finale, only: in_columns, list_results, mark_beyond, describe_violation
   use psalm_group_table, only: everything
   use psalm_kinds, only: wp
   use psalm_margin_list, only: describe_margin
   use psalm_margins, only: margin_t, is_violated
   use psalm_output_kind, only: output_point => motion_point, output_angle => motion_angle, output_distance => motion_distance, &
                                output_slide => motion_slide, output_pose => motion_pose
   use psalm_preparation, only: demand_t, prepared_t, prepare, threads_for
   use psalm_search_group, only: most_search_threads
   use psalm_rate_list, only: list_rates
   use psalm_chain_report, only: unreached_words
   use psalm_force_list, only: list_forces
   use psalm_force_study, only: force_study_t, study_forces => find_forces
   use psalm_rate_study, only: rate_study_t, study_rates => find_rates
   use psalm_search, only: found_t
   use psalm_nlp, only: nlp_t, plain_nlp_t
   use psalm_solver, only: observer_t, search_state_t, solver_t, ending_t, stop_refused
   use psalm_solver_kind, only: solver_kind_t, find_solver, solver_names, family_unknown
   use psalm_solvers, only: new_solver
   use psalm_source, only: line_t
   use psalm_status, only: findings_t => diagnostics_t, finding_t, level_error, level_warning
   use psalm_stop, only: stop_t, stop_request_t
   use psalm_synthesis, only: synthesis_t, study_synthesis => synthesise, ended_unmade, ended_infeasible, ended_converged, &
                              ended_small_objective, ended_iterations, ended_starts, ended_time, ended_on_request, ended_refused, &
                              ended_without_rates
   use psalm_text, only: text_t, full_precision, lower_case, nearest_name, upper_case, to_text
   use psalm_tolerance, only: tolerances_t, study_tolerances
   use psalm_dimensions, only: dimensions_t
   use psalm_version, only: version
   implicit none (type, external)
   private
   public :: wp, version
   public :: case_t, new_case, read_file, read_text
   public :: output_point, output_angle, output_distance, output_slide, output_pose
   public :: findings_t, finding_t, level_error, level_warning
   public :: analyse, analysis_t, wanted_t, motion_t, violation_t, margin_t
   public :: synthesise, synthesis_t, found_t, found_case
   public :: ended_unmade, ended_infeasible, ended_converged, ended_small_objective, ended_iterations, ended_starts, ended_time, &
             ended_on_request, ended_refused, ended_without_rates
   public :: find_rates, rate_study_t
   public :: find_forces, force_study_t
   public :: find_tolerances, tolerances_t
   public :: minimise, nlp_t, plain_nlp_t, ending_t
   public :: stop_t, stop_request_t, observer_t, search_state_t

   integer, parameter :: name_length = 31 !! longest name of a group or an item
   integer, parameter :: line_room = 100  !! columns of a line of values
   character(*), parameter :: memory_name = 'case in memory' !! in findings in place of a file

   !> One loop as given to `add_loop`.
   type :: given_loop_t
      integer, allocatable :: ilink(:), iloop(:), iva(:), ivg(:)
      real(wp), allocatable :: length(:), angle(:)
   end type given_loop_t

   !> An item of the notation, with its values as text.
   type :: given_item_t
      character(name_length) :: group = '', name = ''
      character(:), allocatable :: values
   end type given_item_t

   !> A linkage and what is asked of it.
   type :: case_t
      private
      character(:), allocatable :: heading           !! title of a case made in memory
      type(given_loop_t), allocatable :: parts(:)          !! its loops
      type(given_item_t), allocatable :: items(:)          !! its other items
      class(data_set_t), allocatable :: set           !! a case that was read
      type(findings_t) :: faults                     !! of the verbs that made it; told by every study
   contains
      procedure :: add_loop
      procedure :: set_output
      procedure :: set_turn
      procedure :: set_positions
      procedure :: set_desired
      procedure :: vary
      procedure, private :: set_integers, set_reals, set_integer, set_real, set_word
      generic :: set_item => set_integers, set_reals, set_integer, set_real, set_word
      procedure :: set_length
      procedure :: set_angle
      procedure :: length => length_of_arc
      procedure :: angle => angle_of_arc
      procedure :: loops
      procedure :: arcs
      procedure :: title
      procedure :: text => text_of_case
      procedure :: faults_made
      procedure :: take_back
   end type case_t

contains

   ! ---- cases -------------------------------------------------------------------------------------------------------

   !> Read all cases of a file. With an error in `findings` no case of it can be studied.
   subroutine read_file(file, cases, findings)
      character(*), intent(in) :: file                       !! its name; `-`: standard input
      type(case_t), allocatable, intent(out) :: cases(:)
      type(findings_t), intent(inout) :: findings
      type(data_set_t), allocatable :: sets(:)
      type(findings_t) :: own

      call read_cases(file, sets, own, program=everything)
      call take_sets(sets, own, cases, findings)
   end subroutine read_file

   !> Read all cases of a text in the notation of the manual. With an error in `findings` no case of it can be studied.
   subroutine read_text(text, cases, findings, name)
      character(*), intent(in) :: text                       !! lines, each ended by a line feed
      type(case_t), allocatable, intent(out) :: cases(:)
      type(findings_t), intent(inout) :: findings
      character(*), intent(in), optional :: name             !! in findings in place of a file
      type(data_set_t), allocatable :: sets(:)
      type(findings_t) :: own
      character(:), allocatable :: file

      file = memory_name
      if (present(name)) file = name
      call read_case_text(text, file, sets, own, everything)
      call take_sets(sets, own, cases, findings)
   end subroutine read_text

   subroutine take_sets(sets, own, cases, findings)
      type(data_set_t), intent(in) :: sets(:)
      type(findings_t), intent(in) :: own                    !! of reading them
      type(case_t), allocatable, intent(out) :: cases(:)
      type(findings_t), intent(inout) :: findings
      integer :: k

      allocate (cases(size(sets)))
      do k = 1, size(sets)
         allocate (cases(k)%set, source=sets(k))
         cases(k)%faults%file = sets(k)%file
         if (own%failed()) call cases(k)%faults%error('the text of this case has errors', line=sets(k)%title_line)
      end do
      call tell(own, findings)
   end subroutine take_sets

   !> A case to be made in memory: add loops, then say what the output is and at which inputs it is wanted.
   function new_case(title) result(case)
      character(*), intent(in), optional :: title
      type(case_t) :: case

      case%heading = 'CASE'
      case%faults%file = memory_name
      if (present(title)) then
         if (has_control(title) .or. index(adjustl(title), '&') == 1) then
            call case%faults%error("a title is one line that does not begin with '&'")
         else
            case%heading = trim(title)
         end if
      end if
      allocate (case%parts(0), case%items(0))
   end function new_case

   !> Add a loop, arc by arc from the input pivot back to it along the frame, as ILINK and ILOOP of the manual have it.
   subroutine add_loop(self, ilink, iloop, length, angle)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: ilink(:), iloop(:)           !! shape (arcs): arc numbers; loop or guide numbers
      real(wp), intent(in), optional :: length(:)         !! shape (arcs): lengths; 0 if absent
      real(wp), intent(in), optional :: angle(:)          !! shape (arcs): angles; 0 if absent
      type(given_loop_t), allocatable :: more(:)
      type(given_loop_t) :: new
      logical :: fits

      if (.not. is_open(self)) return
      fits = size(ilink) == size(iloop)
      if (present(length)) fits = fits .and. size(length) == size(ilink)
      if (present(angle)) fits = fits .and. size(angle) == size(ilink)
      if (.not. fits) then
         call self%faults%error('loop '//to_text(size(self%parts) + 1)//': ilink, iloop, length and angle must have as many values')
         return
      end if
      new%ilink = ilink
      new%iloop = iloop
      allocate (new%iva(size(ilink)), new%ivg(size(ilink)), source=0)
      allocate (new%length(size(ilink)), new%angle(size(ilink)), source=0.0_wp)
      if (present(length)) new%length = length
      if (present(angle)) new%angle = angle
      if (.not. all(ieee_is_finite(new%length) .and. ieee_is_finite(new%angle))) then
         call self%faults%error('loop '//to_text(size(self%parts) + 1)//': every length and angle must be a finite number')
         return
      end if
      allocate (more(size(self%parts) + 1))
      more(:size(self%parts)) = self%parts
      more(size(more)) = new
      call move_alloc(more, self%parts)
   end subroutine add_loop

   !> Say what the output is, and on which arc it hangs.
   subroutine set_output(self, kind, arc, loop, length, angle)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: kind                         !! one of `output_...`
      integer, intent(in) :: arc, loop                    !! negative arc: measured from its start
      real(wp), intent(in), optional :: length, angle     !! of the output arc, in the axes of the arc; 0 if absent

      call self%set_item('METHOD', 'MOTION', kind)
      call self%set_item('LINKS', 'NOUTLK', arc)
      call self%set_item('LINKS', 'NOUTLP', loop)
      if (present(length)) call self%set_item('LINKS', 'OUTLK', length)
      if (present(angle)) call self%set_item('LINKS', 'OUTANG', angle)
   end subroutine set_output

   !> Ask for a full turn of the crank in steps of whole degrees.
   subroutine set_turn(self, step)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: step                         !! degrees; negative: clockwise

      call self%set_item('METHOD', 'IKIN', step)
   end subroutine set_turn

   !> Ask for input positions.
   subroutine set_positions(self, increments, reference)
      class(case_t), intent(inout) :: self
      real(wp), intent(in) :: increments(:)               !! from the reference position: degrees, or length of a sliding input
      real(wp), intent(in), optional :: reference         !! reference input; 0 if absent

      call self%set_item('METHOD', 'NDES', size(increments))
      call self%set_item('METHOD', 'DELT', increments)
      if (present(reference)) call self%set_item('METHOD', 'CRNKI', reference)
   end subroutine set_positions

   !> Say what is desired at the input positions: x and y of a point, or the angle, distance or length; of a pose all three.
   subroutine set_desired(self, x, y, value)
      class(case_t), intent(inout) :: self
      real(wp), intent(in), optional :: x(:), y(:)        !! shape (positions)
      real(wp), intent(in), optional :: value(:)          !! shape (positions): angle, distance or length

      if (present(x)) call self%set_item('METHOD', 'DESX', x)
      if (present(y)) call self%set_item('METHOD', 'DESY', y)
      if (present(value)) call self%set_item('METHOD', 'DESANG', value)
   end subroutine set_desired

   !> Let lengths or angles of a loop vary in a search.
   subroutine vary(self, loop, lengths, angles)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: loop
      integer, intent(in), optional :: lengths(:), angles(:) !! numbers of arcs

      if (.not. is_open(self)) return
      if (loop < 1 .or. loop > size(self%parts)) then
         call self%faults%error('vary: there is no loop '//to_text(loop))
         return
      end if
      associate (part => self%parts(loop))
         if (present(lengths)) call mark(lengths, part%iva)
         if (present(angles)) call mark(angles, part%ivg)
      end associate

   contains

      subroutine mark(arcs, flags)
         integer, intent(in) :: arcs(:)
         integer, intent(inout) :: flags(:)
         integer :: i

         do i = 1, size(arcs)
            if (arcs(i) < 1 .or. arcs(i) > size(flags)) then
               call self%faults%error('vary: loop '//to_text(loop)//' has no arc '//to_text(arcs(i)))
            else
               flags(arcs(i)) = 1
            end if
         end do
      end subroutine mark
   end subroutine vary

   !> Give any item of the notation its values: `call case%set_item('LIMITS', 'TANGLE', 60.0_wp)`.
   subroutine set_integers(self, group, item, values)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      integer, intent(in) :: values(:)
      type(text_t) :: text
      integer :: i

      do i = 1, size(values)
         call put(to_text(values(i)), text)
      end do
      call take_item(self, group, item, text%content())
   end subroutine set_integers

   !> Reals, in the manner of `set_integers`.
   subroutine set_reals(self, group, item, values)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      real(wp), intent(in) :: values(:)
      type(text_t) :: text
      integer :: i

      if (.not. all(ieee_is_finite(values))) then
         call self%faults%error('every value must be a finite number', group=printable(group), item=printable(item))
         return
      end if
      do i = 1, size(values)
         call put(full_precision(values(i)), text)
      end do
      call take_item(self, group, item, text%content())
   end subroutine set_reals

   subroutine set_integer(self, group, item, value)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      integer, intent(in) :: value

      call set_integers(self, group, item, [value])
   end subroutine set_integer

   subroutine set_real(self, group, item, value)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      real(wp), intent(in) :: value

      call set_reals(self, group, item, [value])
   end subroutine set_real

   subroutine set_word(self, group, item, value)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      character(*), intent(in) :: value

      character(:), allocatable :: quoted
      integer :: i

      if (has_control(value)) then
         call self%faults%error('a word must not have line breaks or other control characters', group=printable(group), &
                                item=printable(item))
         return
      end if
      ! an apostrophe within quotes is written twice
      quoted = ''
      do i = 1, len(value)
         quoted = quoted//value(i:i)
         if (value(i:i) == "'") quoted = quoted//"'"
      end do
      call take_item(self, group, item, "  '"//quoted//"',"//new_line('a'))
   end subroutine set_word

   !> True if a text has characters that end a line or cannot be seen.
   pure logical function has_control(text)
      character(*), intent(in) :: text
      integer :: i

      has_control = .false.
      do i = 1, len(text)
         has_control = has_control .or. iachar(text(i:i)) < iachar(' ') .or. iachar(text(i:i)) == 127
      end do
   end function has_control

   !> A name for a finding: in capitals, as long as a name may be, what cannot be seen as a question mark.
   pure function printable(name) result(text)
      character(*), intent(in) :: name
      character(:), allocatable :: text
      integer :: i

      text = upper_case(name(:min(len(name), name_length)))
      do i = 1, len(text)
         if (has_control(text(i:i))) text(i:i) = '?'
      end do
   end function printable

   !> True for a letter followed by letters, digits and underscores; of an item an index may follow: DESX(3).
   pure logical function is_name(text, indexed)
      character(*), intent(in) :: text
      logical, intent(in) :: indexed
      character(*), parameter :: letters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZ', further = letters//'0123456789_', inner = '0123456789,: '
      character(:), allocatable :: name
      integer :: last

      is_name = len(text) > 0 .and. len(text) <= name_length
      if (.not. is_name) return
      name = upper_case(text)
      last = verify(name, further) - 1
      if (last < 0) last = len(name)
      is_name = last > 0 .and. scan(name(1:1), letters) == 1
      if (.not. is_name .or. last == len(name)) return
      is_name = indexed .and. name(last + 1:last + 1) == '(' .and. name(len(name):) == ')'
      if (is_name) is_name = len(name) > last + 2 .and. verify(name(last + 2:len(name) - 1), inner) == 0
   end function is_name

   !> A value on the last line of a text, or on a new one.
   subroutine put(value, text)
      character(*), intent(in) :: value
      type(text_t), intent(inout) :: text

      call text%add('  '//value//',')
   end subroutine put

   subroutine take_item(self, group, item, values)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item, values
      type(given_item_t), allocatable :: more(:)
      integer :: i, n

      if (.not. is_open(self)) return
      if (.not. is_name(group, .false.) .or. .not. is_name(item, .true.)) then
         call self%faults%error("'"//printable(group)//"', '"//printable(item)//"': the names of a group and an item are "// &
                                'letters and digits, at most '//to_text(name_length)//' of them, and begin with a letter')
         return
      end if
      do i = 1, size(self%items)
         if (self%items(i)%group /= upper_case(group) .or. self%items(i)%name /= upper_case(item)) cycle
         self%items(i)%values = values
         return
      end do
      n = size(self%items) + 1
      allocate (more(n))
      more(:n - 1) = self%items
      more(n)%group = upper_case(group)
      more(n)%name = upper_case(item)
      more(n)%values = values
      call move_alloc(more, self%items)
   end subroutine take_item

   !> How many faults of its own the case has: made by the verbs that fill and change it. Every study reports them.
   pure integer function faults_made(self)
      class(case_t), intent(in) :: self

      faults_made = self%faults%count
   end function faults_made

   !> Take back faults beyond the first `kept`, for a host that reports them at once; nothing came of the calls that made them.
   subroutine take_back(self, kept, findings)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: kept
      type(findings_t), intent(inout) :: findings
      integer :: i

      do i = kept + 1, self%faults%count
         call findings%add(self%faults%list(i))
      end do
      self%faults%count = min(kept, self%faults%count)
   end subroutine take_back

   !> True if the case is being made in memory; else that is a fault of whoever wants to add to it.
   logical function is_open(self)
      class(case_t), intent(inout) :: self

      is_open = allocated(self%parts)
      if (is_open) return
      if (allocated(self%set)) then
         call self%faults%error('loops and items are added to a case of new_case only; this one was read')
      else
         call self%faults%error('the case is empty; begin with new_case')
      end if
   end function is_open

   ! ---- looking at a case and changing its dimensions ---------------------------------------------------------------

   !> Number of loops.
   pure integer function loops(self)
      class(case_t), intent(in) :: self

      loops = 0
      if (allocated(self%parts)) loops = size(self%parts)
      if (allocated(self%set)) loops = self%set%loops()
   end function loops

   !> Number of arcs of a loop, padding of ILINK included; 0 if there is no such loop.
   pure integer function arcs(self, loop)
      class(case_t), intent(in) :: self
      integer, intent(in) :: loop

      arcs = 0
      if (loop < 1 .or. loop > self%loops()) return
      if (allocated(self%set)) then
         arcs = self%set%links%maxarc
         if (allocated(self%set%traced)) arcs = self%set%traced%longest
      else
         arcs = size(self%parts(loop)%ilink)
      end if
   end function arcs

   !> Title.
   pure function title(self)
      class(case_t), intent(in) :: self
      character(:), allocatable :: title

      title = ''
      if (allocated(self%heading)) title = self%heading
      if (allocated(self%set)) title = self%set%title
   end function title

   !> Length of an arc; 0 if there is no such arc.
   pure real(wp) function length_of_arc(self, loop, arc) result(length)
      class(case_t), intent(in) :: self
      integer, intent(in) :: loop, arc
      integer :: n

      length = 0.0_wp
      if (arc < 1 .or. arc > self%arcs(loop)) return
      if (allocated(self%set)) then
         if (allocated(self%set%traced)) then
            n = self%set%traced%number_of(loop, arc)
            if (n > 0) length = self%set%traced%arcs(n)%arcl
         else
            length = self%set%links%arcl(arc, loop)
         end if
      else
         length = self%parts(loop)%length(arc)
      end if
   end function length_of_arc

   !> Angle of an arc, degrees; 0 if there is no such arc.
   pure real(wp) function angle_of_arc(self, loop, arc) result(angle)
      class(case_t), intent(in) :: self
      integer, intent(in) :: loop, arc
      integer :: n

      angle = 0.0_wp
      if (arc < 1 .or. arc > self%arcs(loop)) return
      if (allocated(self%set)) then
         if (allocated(self%set%traced)) then
            n = self%set%traced%number_of(loop, arc)
            if (n > 0) angle = self%set%traced%arcs(n)%gama
         else
            angle = self%set%links%gama(arc, loop)
         end if
      else
         angle = self%parts(loop)%angle(arc)
      end if
   end function angle_of_arc

   !> Change the length of an arc.
   subroutine set_length(self, loop, arc, value)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: loop, arc
      real(wp), intent(in) :: value

      if (.not. may_change(self, loop, arc, value)) return
      if (value < 0.0_wp) then
         call self%faults%error('arc '//to_text(arc)//' of loop '//to_text(loop)//': a length is not negative')
      else if (allocated(self%set)) then
         if (allocated(self%set%traced)) then
            self%set%traced%arcs(self%set%traced%number_of(loop, arc))%arcl = value
         else
            self%set%links%arcl(arc, loop) = value
         end if
      else
         self%parts(loop)%length(arc) = value
      end if
   end subroutine set_length

   !> Change the angle of an arc, degrees.
   subroutine set_angle(self, loop, arc, value)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: loop, arc
      real(wp), intent(in) :: value

      if (.not. may_change(self, loop, arc, value)) return
      if (allocated(self%set)) then
         if (allocated(self%set%traced)) then
            self%set%traced%arcs(self%set%traced%number_of(loop, arc))%gama = value
         else
            self%set%links%gama(arc, loop) = value
         end if
      else
         self%parts(loop)%angle(arc) = value
      end if
   end subroutine set_angle

   logical function may_change(self, loop, arc, value)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: loop, arc
      real(wp), intent(in) :: value

      may_change = arc >= 1 .and. arc <= self%arcs(loop)
      if (may_change .and. allocated(self%set)) then
         if (allocated(self%set%traced)) may_change = self%set%traced%number_of(loop, arc) > 0
      end if
      if (.not. may_change) then
         call self%faults%error('there is no arc '//to_text(arc)//' of loop '//to_text(loop))
      else if (.not. ieee_is_finite(value)) then
         call self%faults%error('arc '//to_text(arc)//' of loop '//to_text(loop)//': a dimension must be a finite number')
         may_change = .false.
      end if
   end function may_change

   !> A case made in memory, in the notation of the manual; findings name lines of this text. Empty for a case that was read.
   function text_of_case(self) result(content)
      class(case_t), intent(in) :: self
      character(:), allocatable :: content
      type(text_t) :: text
      character(name_length), allocatable :: groups(:)
      integer :: maxarc, i, k

      content = ''
      if (.not. allocated(self%parts)) return
      maxarc = 0
      do i = 1, size(self%parts)
         maxarc = max(maxarc, size(self%parts(i)%ilink))
      end do
      groups = [character(name_length) :: 'LINKS', 'METHOD']
      do i = 1, size(self%items)
         if (all(groups /= self%items(i)%group)) groups = [character(name_length) :: groups, self%items(i)%group]
      end do
      call text%add(self%heading)
      do k = 1, size(groups)
         call text%add(' &'//trim(groups(k)))
         if (groups(k) == 'LINKS') then
            call text%add('  NLOOP='//to_text(size(self%parts))//', MAXARC='//to_text(maxarc)//',')
            call add_rows('ILINK')
            call add_rows('ILOOP')
            call add_rows('ARCL')
            call add_rows('GAMA')
         else if (groups(k) == 'METHOD') then
            call add_rows('IVA')
            call add_rows('IVG')
         end if
         do i = 1, size(self%items)
            if (self%items(i)%group /= groups(k)) cycle
            call text%add('  '//trim(self%items(i)%name)//'=')
            call text%add_text(self%items(i)%values)
         end do
         call text%add(' &END')
      end do
      content = text%content()

   contains

      !> An array over loops and arcs.
      subroutine add_rows(name)
         character(*), intent(in) :: name
         character(:), allocatable :: line
         integer :: loop, a

         do loop = 1, size(self%parts)
            line = '  '
            if (loop == 1) line = '  '//name//'='
            associate (part => self%parts(loop))
               do a = 1, maxarc
                  if (len(line) > line_room) then
                     call text%add(line)
                     line = '  '
                  end if
                  if (a > size(part%ilink)) then
                     line = line//'0,'
                     cycle
                  end if
                  select case (name)
                  case ('ILINK')
                     line = line//to_text(part%ilink(a))//','
                  case ('ILOOP')
                     line = line//to_text(part%iloop(a))//','
                  case ('IVA')
                     line = line//to_text(part%iva(a))//','
                  case ('IVG')
                     line = line//to_text(part%ivg(a))//','
                  case ('ARCL')
                     line = line//full_precision(part%length(a))//','
                  case default
                     line = line//full_precision(part%angle(a))//','
                  end select
               end do
            end associate
            call text%add(line)
         end do
      end subroutine add_rows
   end function text_of_case

   ! ---- studies -----------------------------------------------------------------------------------------------------

   !> Analyse a case as given: what it does at its input positions.
   !>
   !> Findings: errors of the case, and a warning for every violation of closure or a limit.
   subroutine analyse(case, analysis, findings, wanted, listing)
      type(case_t), intent(in) :: case
      type(analysis_t), intent(out) :: analysis           !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(wanted_t), intent(in), optional :: wanted      !! what is wanted besides the motion
      character(:), allocatable, intent(out), optional :: listing !! the listing of psalm
      type(wanted_t) :: all_wanted
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      type(text_t) :: text
      logical :: ready
      integer :: published, i

      if (present(wanted)) all_wanted = wanted
      call make_ready(case, set, problem, ready, findings, every_loop=all_wanted%arcs)
      call empty_motion(analysis%motion)
      if (.not. ready) return
      call study_analysis(set, problem, problem%given, all_wanted, analysis)
      call warn(problem, analysis%motion, findings)
      if (allocated(analysis%margins)) then
         do i = 1, size(analysis%margins)
            if (is_violated(analysis%margins(i))) call findings%warning('violated: '// &
               lower_case(describe_margin(set, problem, analysis%dimensions, analysis%margins(i))))
         end do
      end if
      if (.not. present(listing)) return
      call list_results(set, problem, analysis%dimensions, analysis%motion, text, published)
      call mark_beyond(published, text)
      listing = text%content()
   end subroutine analyse

   !> Search for better dimensions. `found_case` makes a case of what was found.
   subroutine synthesise(case, synthesis, findings, threads, stop, monitor)
      type(case_t), intent(in) :: case
      type(synthesis_t), intent(out) :: synthesis
      type(findings_t), intent(inout) :: findings
      integer, intent(in), optional :: threads            !! that share the work; default THREADS of the case, or 1
      type(stop_t), intent(in), optional :: stop          !! by which the host can end the search
      class(observer_t), intent(inout), optional :: monitor !! told of progress
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      type(dimensions_t) :: dimensions
      type(stop_t) :: ending
      real(wp), allocatable :: none(:, :)
      logical :: ready
      integer :: team

      allocate (synthesis%found%best(0), synthesis%ranked(0))
      if (.not. may_share(threads, findings)) return
      call make_ready(case, set, problem, ready, findings)
      if (.not. ready) return
      if (present(stop)) ending = stop
      team = threads_for(set, threads_of(threads))
      call problem%set_threads(team)
      dimensions = problem%given
      allocate (none(size(problem%parameters%variables), 0))
      call study_synthesis(set, none, problem, team, ending, dimensions, synthesis, monitor)
   end subroutine synthesise

   !> The linkage of a rank as a case without variables; the user's own if the search found none of that rank.
   function found_case(case, synthesis, rank) result(found)
      type(case_t), intent(in) :: case                    !! the one that was searched
      type(synthesis_t), intent(in) :: synthesis
      integer, intent(in), optional :: rank               !! 1, the best, if absent
      type(case_t) :: found
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      type(dimensions_t) :: dimensions
      integer :: which
      logical :: ready

      which = 1
      if (present(rank)) which = rank
      call make_ready(case, set, problem, ready, found%faults)
      call move_alloc(set, found%set)
      if (.not. ready) return
      dimensions = problem%given
      if (synthesis%many) then
         if (which >= 1 .and. which <= size(synthesis%found%best)) then
            call problem%parameters%apply(synthesis%found%best(which)%values, dimensions)
            found%set%method%delt = synthesis%found%best(which)%delt
         end if
      else if (allocated(synthesis%last%v) .and. which == 1) then
         call problem%parameters%apply(synthesis%last%v(:, synthesis%last%best), dimensions)
      end if
      associate (to => found%set)
         to%method%ifree = 0
         if (allocated(to%traced)) then
            call to%traced%take_dimensions(dimensions)
            to%method%crnki = dimensions%crnki - dimensions%drawn
            return
         end if
         to%links%arcl = in_columns(problem%mechanism, dimensions%arcl, to%links%arcl)
         to%links%gama = in_columns(problem%mechanism, dimensions%gama, to%links%gama)
         to%links%outlk = dimensions%outlk
         to%links%outang = dimensions%outang
         to%method%origlk = dimensions%origlk
         to%method%origng = dimensions%origng
         to%method%crnki = dimensions%crnki
         to%method%iva = 0
         to%method%ivg = 0
         to%method%ilkout = 0
         to%method%ingout = 0
         to%method%icrk = 0
         to%method%iorig = 0
      end associate
   end function found_case

   !> Velocities, accelerations and jerks of a case as given.
   subroutine find_rates(case, rates, findings, listing)
      type(case_t), intent(in) :: case
      type(rate_study_t), intent(out) :: rates            !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      character(:), allocatable, intent(out), optional :: listing !! the listing of kalm
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      type(text_t) :: text
      logical :: ready

      call empty_motion(rates%motion)
      allocate (rates%by_input(0, 0, 0), rates%by_time(0, 0, 0), rates%dead(0))
      call make_ready(case, set, problem, ready, findings)
      if (.not. ready) return
      call study_rates(set, problem, problem%given, rates)
      call warn(problem, rates%motion, findings)
      if (.not. present(listing)) return
      call list_rates(set, problem, rates, text)
      listing = text%content()
   end subroutine find_rates

   !> Forces of a case with masses, loads or springs: drive, frame, every joint, at the positions of the case.
   !>
   !> With `by_unit_mass` also the inertia forces of unit masses, in which every force is linear: shape (positions, columns, 4,
   !> bodies), see `loads_of_unit_masses`. Columns:
   !> drive, force x and y and moment on the frame, two for each joint, then further drives.
   subroutine find_forces(case, forces, findings, listing, by_unit_mass)
      type(case_t), intent(in) :: case
      type(force_study_t), intent(out) :: forces          !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      character(:), allocatable, intent(out), optional :: listing !! the part of kalm's listing
      real(wp), allocatable, intent(out), optional :: by_unit_mass(:, :, :, :)
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      type(text_t) :: text
      logical :: ready

      allocate (forces%input(0), forces%table%value(0, 0))
      if (present(by_unit_mass)) allocate (by_unit_mass(0, 0, 0, 0))
      call make_ready(case, set, problem, ready, findings)
      if (ready) then
         call study_forces(set, problem, problem%given, forces, by_unit_mass)
      else
         return
      end if
      if (.not. forces%all_known()) call findings%warning('forces are not known at every position: the linkage does not '// &
                                                          'close, is at a dead point, or friction locks it')
      if (.not. present(listing)) return
      call list_forces(set, forces, text)
      listing = text%content()
   end subroutine find_forces

   !> What the tolerances of the group TOLER do to the output of a case as given.
   subroutine find_tolerances(case, tolerances, findings, threads, stop)
      type(case_t), intent(in) :: case
      type(tolerances_t), intent(out) :: tolerances       !! empty if the case has errors or does not close
      type(findings_t), intent(inout) :: findings
      integer, intent(in), optional :: threads            !! that share the work; default THREADS of the case, or 1
      type(stop_t), intent(in), optional :: stop          !! by which the host can end the sample
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      type(stop_t) :: ending
      logical :: ready

      if (.not. may_share(threads, findings)) return
      call make_ready(case, set, problem, ready, findings)
      if (.not. ready) return
      if (present(stop)) ending = stop
      call study_tolerances(set, problem%mechanism, problem%given, threads_for(set, threads_of(threads)), ending, tolerances)
      if (.not. tolerances%closes) call findings%warning('no tolerances, because the linkage does not close everywhere')
   end subroutine find_tolerances

   ! ---- problems of one's own ---------------------------------------------------------------------------------------

   !> Minimise a problem of the caller's own from x: an extension of `plain_nlp_t`, say, with `core`, `low` and `high` set.
   !>
   !> Findings: sizes that do not fit, a solver that is not there; a warning if the solver cannot work on this problem, or if the
   !> search ended at a point that does not obey every constraint.
   subroutine minimise(problem, solver, x, ending, findings, stop, observer)
      class(nlp_t), intent(inout) :: problem
      character(*), intent(in) :: solver                  !! its name, as SOLVER of the manual
      real(wp), intent(inout) :: x(:)                     !! shape (unknowns)
      type(ending_t), intent(out) :: ending
      type(findings_t), intent(inout) :: findings
      type(stop_t), intent(in), optional :: stop          !! by which the host can end the search
      class(observer_t), intent(inout), optional :: observer !! told of progress
      class(solver_t), allocatable :: by
      type(solver_kind_t) :: kind
      type(stop_t) :: limited
      character(:), allocatable :: near
      logical :: fits

      fits = allocated(problem%low) .and. allocated(problem%high) .and. problem%unknowns() > 0 .and. size(x) == problem%unknowns()
      if (fits) fits = size(problem%low) == problem%core .and. size(problem%high) == problem%core
      if (.not. fits) call findings%error('minimise: x needs a value for each of '//to_text(problem%unknowns())// &
                                          ' unknowns, and low and high a bound for each core unknown')
      kind = find_solver(solver)
      if (kind%family == family_unknown) then
         near = nearest_name(upper_case(solver), solver_names())
         if (len(near) > 0) near = "; did you mean '"//near//"'?"
         call findings%error("minimise: no solver is called '"//solver//"'"//near)
         fits = .false.
      end if
      if (.not. fits) return
      if (present(stop)) limited = stop
      call new_solver(kind, by)
      call by%minimise(problem, x, limited, ending, observer)
      if (ending%reason == stop_refused) then
         call findings%warning('minimise: '//trim(kind%name)//' cannot work on this problem')
      else if (.not. ending%feasible) then
         call findings%warning('minimise: the search ended at a point that violates a constraint')
      end if
   end subroutine minimise

   ! ---- what the studies share --------------------------------------------------------------------------------------

   !> Data set and problem of a case; whatever is wrong is told.
   subroutine make_ready(case, set, problem, ready, findings, every_loop)
      type(case_t), intent(in) :: case
      class(data_set_t), allocatable, intent(out) :: set
      class(problem_t), allocatable, intent(out) :: problem
      logical, intent(out) :: ready
      type(findings_t), intent(inout) :: findings
      logical, intent(in), optional :: every_loop         !! solve loops that the output does not depend on too
      type(data_set_t), allocatable :: sets(:)
      type(prepared_t) :: prepared
      type(findings_t) :: own
      type(line_t) :: no_vertices(0)
      logical :: everywhere

      ready = .false.
      everywhere = .false.
      if (present(every_loop)) everywhere = every_loop
      own%file = memory_name
      if (allocated(case%set)) then
         allocate (set, source=case%set)
         own%file = set%file
      else if (allocated(case%parts)) then
         call read_case_text(case%text(), memory_name, sets, own, everything)
         if (size(sets) > 0) allocate (set, source=sets(1))
      else
         call own%error('the case is empty; begin with new_case, read_file or read_text')
      end if
      call tell(case%faults, own)
      if (.not. own%failed() .and. allocated(set)) then
         if (everywhere) call prepare(set, no_vertices, prepared, own, demand_t(ktheta_only=.false.))
         if (.not. everywhere) call prepare(set, no_vertices, prepared, own)
         ready = prepared%ready
      end if
      call tell(own, findings)
      if (.not. ready) return
      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem, &
                        all_arcs=everywhere .or. set%limits%ktheta /= 0)
   end subroutine make_ready

   !> Add what was found elsewhere, with the name of its file.
   subroutine tell(own, findings)
      type(findings_t), intent(in) :: own
      type(findings_t), intent(inout) :: findings

      if (allocated(own%file)) findings%file = own%file
      call findings%append(own)
   end subroutine tell

   !> A warning for every violation.
   subroutine warn(problem, motion, findings)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(findings_t), intent(inout) :: findings
      integer :: i

      do i = 1, size(motion%violations)
         call findings%warning(lower_case(describe_violation(problem, motion, motion%violations(i))))
      end do
      if (.not. allocated(motion%beyond)) return
      if (any(motion%beyond)) call findings%warning(unreached_words(motion%beyond))
   end subroutine warn

   pure integer function threads_of(threads)
      integer, intent(in), optional :: threads

      threads_of = 0
      if (present(threads)) threads_of = max(0, threads)
   end function threads_of

   !> False, with an error, if more threads are asked for than THREADS may be.
   logical function may_share(threads, findings)
      integer, intent(in), optional :: threads
      type(findings_t), intent(inout) :: findings

      may_share = .true.
      if (present(threads)) may_share = threads <= most_search_threads
      if (.not. may_share) call findings%error(to_text(threads)//' threads are too many; give at most '// &
                                               to_text(most_search_threads))
   end function may_share

   pure subroutine empty_motion(motion)
      type(motion_t), intent(out) :: motion

      allocate (motion%closed(0), motion%input(0), motion%actual(0, 0), motion%error(0, 0))
      allocate (motion%violations(0), motion%crossings(0))
   end subroutine empty_motion
end module psalm
