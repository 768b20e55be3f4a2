!> The data set of one mechanism: what the user wrote, checked item by item.
!>
!> A file becomes a list of data sets. Topology is assessed later, in `psalm_setup`; here each item is read, given its
!> default and checked by itself. Source of items and defaults: Oldham (1977), appendix B.
module psalm_data_set
   use psalm_case_group, only: section_t, surroundings_t
   use psalm_chain_group, only: read_chain_group
   use psalm_constraint_group, only: constraint_group_t, range_positions, read_constraint_group, read_least_angle
   use psalm_friction_group, only: friction_group_t, read_friction_group
   use psalm_drives_group, only: read_drives_group
   use psalm_group_table, only: everything, program_of, program_reads, is_users, nearest_group
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp, right_angle
   use psalm_kinds_defaults, only: complete_kinds_case
   use psalm_limits_group, only: limits_group_t, read_limits_group
   use psalm_links_group, only: links_group_t, read_links_group
   use psalm_load_group, only: load_group_t, read_load_group
   use psalm_mark, only: mark_t
   use psalm_mass_group, only: mass_group_t, read_mass_group
   use psalm_method_group, only: method_group_t, read_method_group, most_positions
   use psalm_output_kind, only: output_kind_t, output_kind, motion_angle, motion_distance, motion_pose, &
                                motion_slide
   use psalm_outputs_group, only: read_outputs_group
   use psalm_namelist, only: case_text_t, read_case
   use psalm_origin, only: origins_t, name_length
   use psalm_rates_group, only: rates_group_t, read_rates_group
   use psalm_search_group, only: search_group_t, read_search_group, pareto_largest
   use psalm_sketch, only: sketch_t, grid_digits, drive_turns, most_targets, output_angle, output_distance, output_pose, &
                           output_slide
   use psalm_source, only: line_t, read_lines, split_lines
   use psalm_spring_group, only: spring_group_t, read_spring_group
   use psalm_status, only: diagnostics_t
   use psalm_study_groups, only: study_groups
   use psalm_traced_loops, only: loops_t
   use psalm_number, only: parse_integer
   use psalm_number_format, only: number_words
   use psalm_text, only: text_t, to_text
   use psalm_tolerance_group, only: tolerance_group_t, read_tolerance_group
   use psalm_equal_items, only: read_equalities
   use psalm_target_items, only: read_targets, values_of, weights_of
   implicit none (type, external)
   private
   public :: data_set_t, read_data_sets, read_data_set_text
   public :: title_columns

   !> Groups that muscle writes itself, with what it found, and those that asked for it.
   character(name_length), parameter :: written_by_muscle(*) = [character(name_length) :: 'MASSES', 'SPRING', 'BALANC', 'SPRNGS']
   character(*), parameter :: searching_program = 'psalm'
   character(*), parameter :: group_of_kinds = 'KINDS'
   integer, parameter :: title_columns = 72        !! of a title, at most
   real(wp), parameter :: largest_machine = 20.0_wp !! metres; a larger one may have been drawn in millimetres
   real(wp), parameter :: largest_written_out = 1.0e6_wp !! metres; larger numbers have an exponent

   !> Everything the user can say to `psalm`. Angles in degrees, lengths in the user's one unit.
   type :: data_set_t
      character(:), allocatable :: title   !! at most 72 columns
      character(:), allocatable :: file    !! where it was read from
      integer :: title_line = 0            !! line of the title
      type(links_group_t) :: links         !! LINKS
      type(method_group_t) :: method       !! METHOD
      type(limits_group_t) :: limits       !! LIMITS
      type(search_group_t) :: search       !! SEARCH
      type(constraint_group_t) :: constr   !! CONSTR
      type(tolerance_group_t) :: toler     !! TOLER
      type(rates_group_t) :: rates         !! RATES (read for kalm only)
      type(sketch_t) :: sketch             !! CHAIN, DRIVES, OUTPUTS
      type(loops_t), allocatable :: traced !! its loops
      character(:), allocatable :: search_in_poses !! why its search is made in the poses of the links; not allocated: by loops
      type(mass_group_t) :: masses         !! MASSES (this and the next three are read for kalm and balm only)
      type(load_group_t) :: loads          !! LOADS
      type(spring_group_t) :: springs      !! SPRING
      type(friction_group_t) :: friction   !! FRICTN
      type(section_t), allocatable :: sections(:) !! the groups of the studies, each read by the study that it is for
      character(:), allocatable :: others  !! the groups that device 7 keeps as they are
      logical :: of_kinds = .false.        !! it has no linkage: kinds of them are searched (KINDS)
      character(:), allocatable :: curve   !! mark of the file that the desired values were read from
      character(:), allocatable :: skipped !! the groups that this program does not read, with those that do; empty: none
      type(origins_t) :: origins           !! where every value was written
   contains
      procedure :: is_beyond_arrays
      procedure :: loops
      procedure :: motion
      procedure :: has_stand_in
      procedure :: is_drawn
      procedure :: has_names
      procedure :: link_item
      procedure :: bound_items
      procedure :: counts_time
      procedure :: pace
      procedure :: change_of_pace
      procedure :: wants_search
      procedure :: place_of
      procedure :: gives
      procedure :: redraw
   end type data_set_t

contains

   !> How many loops there are to solve: those of &LINKS, or those traced in a sketch; 0: none.
   pure integer function loops(self)
      class(data_set_t), intent(in) :: self

      loops = self%links%nloop
      if (allocated(self%traced)) loops = self%traced%loops
   end function loops

   !> What is listed: one of `motion_...`.
   pure integer function motion(self)
      class(data_set_t), intent(in) :: self

      motion = self%method%motion
      if (allocated(self%traced)) motion = self%traced%motion
   end function motion

   !> True if a joint is listed for want of the first output.
   pure logical function has_stand_in(self)
      class(data_set_t), intent(in) :: self

      has_stand_in = .false.
      if (allocated(self%traced)) has_stand_in = allocated(self%traced%stand_in)
   end function has_stand_in

   !> True if the linkage is given by a drawing, in which its loops are traced.
   pure logical function is_drawn(self)
      class(data_set_t), intent(in) :: self

      is_drawn = self%sketch%given
   end function is_drawn

   !> True if joints, links and outputs have names, which items, listings, tables and messages call them by.
   pure logical function has_names(self)
      class(data_set_t), intent(in) :: self

      has_names = self%sketch%given
   end function has_names

   !> The item by which a group calls links: by their names, else by arcs.
   pure function link_item(self, letter) result(item)
      class(data_set_t), intent(in) :: self
      character, intent(in) :: letter            !! of the group
      character(5) :: item

      item = letter//merge('NAME', 'LINK', self%has_names())
   end function link_item

   !> The items that limit what a search may change, in words.
   pure function bound_items(self, last) result(words)
      class(data_set_t), intent(in) :: self
      character(*), intent(in) :: last           !! what stands between the last two
      character(:), allocatable :: words

      words = 'LIMVAL, OPLOW'//last//'OPHIGH'
      if (self%has_names()) words = 'VLOW'//last//'VHIGH'
   end function bound_items

   !> True if the first drive stands still while others move: rates are then counted by time, not by its input.
   pure logical function counts_time(self)
      class(data_set_t), intent(in) :: self
      integer :: d

      counts_time = self%sketch%given .and. .not. abs(self%rates%speed) > 0.0_wp
      if (.not. counts_time) return
      counts_time = any([(.not. self%sketch%drives(d)%geared .and. max(abs(self%sketch%drives(d)%speed), &
                                                                      abs(self%sketch%drives(d)%accel)) > 0.0_wp, &
                          d=2, size(self%sketch%drives))])
   end function counts_time

   !> Speed of what rates are counted by: of the first drive, radians or length a second; of time 1.
   pure real(wp) function pace(self)
      class(data_set_t), intent(in) :: self

      pace = self%rates%speed
      if (self%counts_time()) pace = 1.0_wp
   end function pace

   !> Its acceleration.
   pure real(wp) function change_of_pace(self)
      class(data_set_t), intent(in) :: self

      change_of_pace = self%rates%accel
      if (self%counts_time()) change_of_pace = 0.0_wp
   end function change_of_pace

   !> True if any dimension may vary (and IKIN does not override it).
   pure logical function wants_search(self)
      class(data_set_t), intent(in) :: self

      associate (method => self%method)
         wants_search = method%ikin == 0 .and. (any(method%iva /= 0) .or. any(method%ivg /= 0) .or. method%ilkout /= 0 .or. &
                                                method%ingout /= 0 .or. method%icrk /= 0 .or. method%iorig /= 0)
      end associate
      if (self%of_kinds) wants_search = self%method%ikin == 0
      if (.not. self%sketch%given .or. .not. allocated(self%sketch%variations)) return
      wants_search = self%method%ikin == 0 .and. size(self%sketch%variations) > 0
   end function wants_search

   !> The section that a group is; 0 if there is none.
   pure integer function place_of(self, name)
      class(data_set_t), intent(in) :: self
      character(*), intent(in) :: name           !! of the group

      place_of = 0
      if (allocated(self%sections)) place_of = findloc(self%sections%name == name, .true., dim=1)
   end function place_of

   !> True if a group of a study was given.
   pure logical function gives(self, name)
      class(data_set_t), intent(in) :: self
      character(*), intent(in) :: name           !! of the group
      integer :: k

      gives = .false.
      k = self%place_of(name)
      if (k > 0) gives = self%sections(k)%group%given
   end function gives

   !> A case like this one with another sketch, whose loops are not traced yet, and without &KINDS.
   subroutine redraw(self, title, sketch, method, search, set)
      class(data_set_t), intent(in) :: self
      character(*), intent(in) :: title
      type(sketch_t), intent(in) :: sketch
      type(method_group_t), intent(in) :: method
      type(search_group_t), intent(in) :: search
      type(data_set_t), intent(out) :: set
      integer :: k

      select type (self)
      type is (data_set_t)
         set = self
      end select
      set%title = title
      set%sketch = sketch
      set%sketch%given = .true.
      set%method = method
      set%search = search
      if (allocated(set%traced)) deallocate (set%traced)
      if (allocated(set%search_in_poses)) deallocate (set%search_in_poses)
      set%of_kinds = .false.
      k = set%place_of(group_of_kinds)
      if (k > 0) set%sections(k)%group%given = .false.
   end subroutine redraw

   !> Read every case of a file, up to the one with LAST=1.
   !>
   !> Errors: those of the file, of the notation and of each item, all collected in `findings`.
   subroutine read_data_sets(file, sets, findings, program, mark)
      character(*), intent(in) :: file                       !! name, `-` for standard input
      type(data_set_t), allocatable, intent(out) :: sets(:)  !! the cases
      type(diagnostics_t), intent(inout) :: findings
      character(*), intent(in), optional :: program          !! who reads; default psalm
      type(mark_t), intent(inout), optional :: mark          !! takes in the text
      type(line_t), allocatable :: lines(:)
      character(:), allocatable :: reader
      integer :: next

      reader = 'psalm'
      if (present(program)) reader = program
      allocate (sets(0))
      findings%file = file
      if (file == '-') findings%file = 'standard input'
      call read_lines(file, lines, findings)
      if (findings%failed()) return
      if (present(mark)) then
         do next = 1, size(lines)
            call mark%add(lines(next)%text)
         end do
      end if
      call read_all(lines, reader, sets, findings)
      if (.not. present(mark)) return
      do next = 1, size(sets)
         if (allocated(sets(next)%curve)) call mark%add(sets(next)%curve)
      end do
   end subroutine read_data_sets

   !> Read every case of a text in memory, in the manner of `read_data_sets`.
   subroutine read_data_set_text(text, name, sets, findings, program)
      character(*), intent(in) :: text                       !! lines, each ended by a line feed
      character(*), intent(in) :: name                       !! in the findings in place of a file
      type(data_set_t), allocatable, intent(out) :: sets(:)  !! the cases
      type(diagnostics_t), intent(inout) :: findings
      character(*), intent(in) :: program                    !! who reads
      type(line_t), allocatable :: lines(:)

      allocate (sets(0))
      findings%file = name
      call split_lines(text, lines)
      call read_all(lines, program, sets, findings)
   end subroutine read_data_set_text

   !> Read every case of some lines, up to the one with LAST=1.
   subroutine read_all(lines, reader, sets, findings)
      use psalm_json_case, only: is_json
      type(line_t), intent(in) :: lines(:)
      character(*), intent(in) :: reader                     !! program
      type(data_set_t), allocatable, intent(inout) :: sets(:) !! empty
      type(diagnostics_t), intent(inout) :: findings
      type(case_text_t) :: case
      integer :: next, count, more

      if (is_json(lines)) then
         call read_all_json(lines, reader, sets, findings)
         return
      end if
      next = 1
      count = 0
      do
         call read_case(lines, next, case, findings)
         if (case%line == 0) then
            if (count == 0) then
               call findings%error('the file is empty; a case is a title line followed by &LINKS or &CHAIN, &METHOD and &LIMITS')
            else
               call findings%error('LAST=0 declares another case, but the file ends here', line=size(lines))
            end if
            exit
         end if
         if (count == size(sets)) then
            ! cases are large: copying them takes half as long as reading them
            more = max(1, count)
            if (count > 0) more = max(more, 1 + cases_from(lines, next))
            call resize(sets, count + more)
         end if
         count = count + 1
         call read_set(case, reader, sets(count), findings)
         if (sets(count)%limits%last /= 0) exit
      end do
      if (count < size(sets)) call resize(sets, count)
   end subroutine read_all

   !> As many as asked for; the first keep what they are. The only place that copies cases here, because such code is long.
   subroutine resize(sets, count)
      type(data_set_t), allocatable, intent(inout) :: sets(:)
      integer, intent(in) :: count
      type(data_set_t), allocatable :: other(:)
      integer :: kept

      kept = min(count, size(sets))
      allocate (other(count))
      other(:kept) = sets(:kept)
      call move_alloc(other, sets)
   end subroutine resize

   !> How many cases there are from line `next` on, up to one without LAST=0.
   integer function cases_from(lines, next) result(count)
      type(line_t), intent(in) :: lines(:)
      integer, intent(in) :: next
      type(case_text_t) :: case
      type(diagnostics_t) :: unused
      integer :: at

      at = next
      count = 0
      do
         call read_case(lines, at, case, unused)
         if (case%line == 0) exit
         count = count + 1
         if (.not. another_follows(case)) exit
      end do
   end function cases_from

   !> True for LAST=0.
   pure logical function another_follows(case)
      type(case_text_t), intent(in) :: case
      character(:), allocatable :: reason
      integer :: i, k, last
      logical :: valid

      another_follows = .false.
      do i = 1, case%count
         associate (group => case%groups(i))
            if (group%name /= 'LIMITS') cycle
            do k = 1, group%count
               if (group%items(k)%name /= 'LAST' .or. group%items(k)%count == 0) cycle
               call parse_integer(group%text_of(group%values(group%items(k)%first)), last, valid, reason)
               another_follows = valid .and. last == 0
            end do
         end associate
      end do
   end function another_follows

   !> Read every case of a text in JSON. An array of cases has no LAST; it ends with the last.
   subroutine read_all_json(lines, reader, sets, findings)
      use psalm_json_case, only: read_json_cases
      type(line_t), intent(in) :: lines(:)
      character(*), intent(in) :: reader                     !! program
      type(data_set_t), allocatable, intent(inout) :: sets(:)
      type(diagnostics_t), intent(inout) :: findings
      type(case_text_t), allocatable :: cases(:)
      integer :: k

      call read_json_cases(lines, cases, findings)
      if (size(cases) == 0) return
      deallocate (sets)
      allocate (sets(size(cases)))
      do k = 1, size(cases)
         if (size(cases) > 1) findings%prefix = '/'//to_text(k - 1)
         call read_set(cases(k), reader, sets(k), findings)
         if (gives_last(cases(k))) call sets(k)%origins%warning(findings, 'LIMITS', 'LAST', &
                                                                'has no effect: in JSON several cases are an array')
         sets(k)%limits%last = merge(1, 0, k == size(cases))
      end do
      if (size(cases) > 1) deallocate (findings%prefix)

   contains

      pure logical function gives_last(case)
         type(case_text_t), intent(in) :: case
         integer :: i

         gives_last = .false.
         do i = 1, case%count
            if (case%groups(i)%name /= 'LIMITS') cycle
            gives_last = any(case%groups(i)%items(:case%groups(i)%count)%name == 'LAST')
         end do
      end function gives_last
   end subroutine read_all_json

   subroutine read_set(case, program, set, findings)
      use psalm_curve_group, only: expand_curve
      type(case_text_t), intent(inout) :: case
      character(*), intent(in) :: program
      type(data_set_t), intent(inout) :: set          !! as it is by default
      type(diagnostics_t), intent(inout) :: findings
      integer, parameter :: links = 1, method = 2, limits = 3, search = 4, constr = 5, toler = 6, rates = 7, chain = 8, &
                            drives = 9, outputs = 10, masses = 11, loads = 12, spring = 13, frictn = 14
      character(*), parameter :: own(*) = [character(name_length) :: 'LINKS', 'METHOD', 'LIMITS', 'SEARCH', 'CONSTR', &
                                           'TOLER', 'RATES', 'CHAIN', 'DRIVES', 'OUTPUTS', 'MASSES', 'LOADS', 'SPRING', &
                                           'FRICTN']
      character(name_length), allocatable :: names(:)
      class(surroundings_t), allocatable :: about  ! large, too
      type(group_t), allocatable :: groups(:)      ! large: they would fill a small stack
      type(diagnostics_t) :: unused
      logical :: shape_known, sketch_valid, by_cam
      integer :: i, line_of_plates

      call study_groups(set%sections)
      names = [character(name_length) :: own, set%sections%name]
      allocate (groups(size(names)))
      set%file = findings%file
      call set%origins%clear()
      set%title = case%title(:min(title_columns, len(case%title)))
      set%title_line = case%line
      if (len(case%title) > title_columns) then
         call findings%warning('the title is cut to its first '//to_text(title_columns)//' columns', line=case%line)
      end if
      call expand_curve(case, findings%file, set%curve, findings)
      set%of_kinds = (program == searching_program .or. program == everything) .and. &
                     any(case%groups(:case%count)%name == 'KINDS')
      if (set%of_kinds) call complete_kinds_case(case)
      call keep_others(case, program, set)
      call refuse_unknown(case, program, findings)
      do i = 1, size(names)
         if (reads_of(case, program, names(i))) then
            call case%take(trim(names(i)), groups(i))
         else
            call groups(i)%begin(trim(names(i)), 0)
         end if
      end do
      ! a group that is not there is read too: it is asked for its items, and `finish` knows all names
      call read_sketch(groups(chain), groups(outputs), set, sketch_valid, findings)
      if (groups(links)%line > 0) then
         call read_links_group(groups(links), set%links, shape_known, findings)
      else
         call read_links_group(groups(links), set%links, shape_known, unused)
      end if
      if (groups(method)%line > 0) then
         call read_method_group(groups(method), set%links%nloop, set%links%maxarc, shape_known, &
                                set%sketch%given .or. set%of_kinds, set%method, findings)
      else
         call read_method_group(groups(method), set%links%nloop, set%links%maxarc, shape_known, set%sketch%given, set%method, &
                                unused)
      end if
      if (program /= searching_program) set%method%nguess = 0      ! it reads no simplex
      call read_drives(groups(drives), sketch_valid, set, findings)
      call fill_grid(groups(method), groups(drives), set, findings)
      if (groups(outputs)%line > 0 .and. set%method%ikin == 0) then
         call read_targets(groups(outputs), set%method%ndes, set%sketch, findings)
         call read_equalities(groups(outputs), set%method%ndes, set%sketch, findings)
         call refuse_twice(groups(outputs), set, findings)
      else
         call read_targets(groups(outputs), 0, set%sketch, unused)
         call read_equalities(groups(outputs), 0, set%sketch, unused)
      end if
      if (set%sketch%given) call refuse_arcs(groups(method), groups(toler), groups(limits), findings)
      call read_limits_group(groups(limits), set%links%nloop, set%links%maxarc, set%limits, findings)
      call read_search_group(groups(search), set%search, findings)
      if (set%of_kinds .and. .not. set%search%solver%many_starts) then
         call out_of(groups(search), 'SOLVER', "a search among kinds (&KINDS) needs another SOLVER, as 'LSQ'", findings)
      else if (set%method%ifree /= 0 .and. .not. set%search%solver%many_starts) then
         call out_of(groups(method), 'IFREE', "IFREE=1 (free timing) needs the group &SEARCH with another SOLVER, as 'LSQ'", &
                     findings)
      end if
      if (set%method%ifree /= 0 .and. set%method%ikin == 0 .and. .not. set%wants_search()) then
         call out_of(groups(method), 'IFREE', 'free timing is a part of a search, but no dimension may vary', findings)
      end if
      call check_ways(groups(search), set, findings)
      call check_equalities(groups(outputs), groups(search), set, findings)
      call report_idle_items(groups(method), groups(limits), groups(search), groups(outputs), program == searching_program, set, &
                             findings)
      call read_constraint_group(groups(constr), set%links%nloop, set%links%maxarc, set%sketch, set%constr, findings)
      call settle_angle_limit(groups(limits), groups(constr), set, findings)
      call read_tolerance_group(groups(toler), set%links, set%method, set%sketch, set%toler, findings)
      if (set%method%isim /= 0 .and. set%method%ikin == 0) call check_similarity(groups(method), set, findings)
      call read_rates_group(groups(rates), sliding_input(set), set%rates, findings)
      call read_mass_group(groups(masses), set%links%ilink, set%sketch, set%masses, findings)
      call read_load_group(groups(loads), set%links%ilink, set%sketch, set%loads, findings)
      call read_spring_group(groups(spring), set%links%ilink, set%sketch, set%springs, findings)
      call read_friction_group(groups(frictn), set%links%ilink, set%sketch, set%friction, findings)
      allocate (about)
      line_of_plates = 0
      by_cam = .false.
      about%ilink = set%links%ilink
      about%sketch = set%sketch
      about%positions = merge(359/max(1, abs(set%method%ikin)) + 1, set%method%ndes, set%method%ikin /= 0)
      about%searched = set%wants_search()
      do i = 1, size(set%sections)
         call set%sections(i)%group%read(groups(size(own) + i), about, findings)
         if (set%sections(i)%name == 'PLATES') line_of_plates = groups(size(own) + i)%line
         if (index(set%sections(i)%name, 'CAM') == 1) by_cam = by_cam .or. groups(size(own) + i)%given('CAMRPM')
         ! the tables of all of them fill more memory than a small case needs otherwise; so the next one takes the place of this
         call groups(size(own) + i)%forget()
      end do
      ! where there are errors the group may stand under a misspelt name
      if ((size(set%masses%mass) > 0 .or. line_of_plates > 0) .and. &
          .not. (set%rates%given .or. set%gives('TIME') .or. by_cam .or. findings%failed())) then
         call findings%warning('there is no group &RATES: the input is taken to move at '// &
                               trim(merge('1 unit of length a second', '1 radian a second        ', sliding_input(set))), &
                               line=max(groups(masses)%line, line_of_plates), &
                               group=merge('MASSES', 'PLATES', groups(masses)%line > 0), &
                               item=trim(merge('NMASS ', 'PTHICK', groups(masses)%line > 0)))
      end if
      if (.not. findings%failed()) then
         call doubt_units(groups(masses), max(groups(loads)%line, line_of_plates), set, findings)
         call doubt_reference(groups(method), set, findings)
      end if
      do i = 1, size(groups)
         if (groups(i)%line > 0) call groups(i)%finish(groups, findings)
         call set%origins%append(groups(i)%origins)
      end do
   end subroutine read_set

   !> Masses or loads on a linkage of many metres, where the unit of length is not said: it may be drawn in millimetres.
   subroutine doubt_units(group, line_of_others, set, findings)
      type(group_t), intent(in) :: group             !! MASSES
      integer, intent(in) :: line_of_others          !! of LOADS or PLATES; 0: they are not given
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: extent
      character(:), allocatable :: metres

      if (size(set%masses%mass) == 0 .and. line_of_others == 0 .or. group%given('UNITL')) return
      extent = maxval(set%links%arcl)
      if (set%sketch%given .and. size(set%sketch%x) > 0) extent = max(maxval(set%sketch%x) - minval(set%sketch%x), &
                                                                      maxval(set%sketch%y) - minval(set%sketch%y))
      if (extent <= largest_machine) return
      if (extent < largest_written_out) then
         metres = to_text(nint(extent))
      else
         metres = number_words(extent)
      end if
      call findings%warning('missing: lengths are taken as metres, and this linkage is '//metres// &
                            ' m large; if it is drawn in millimetres, set UNITL=0.001', &
                            line=merge(group%line, line_of_others, group%line > 0), group='MASSES', item='UNITL')
   end subroutine doubt_units

   !> CRNKI of a sketch counts from the drawing, and DELT from there: who gives the crank's own angle turns it twice.
   subroutine doubt_reference(group, set, findings)
      type(group_t), intent(in) :: group             !! METHOD
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings

      if (.not. set%sketch%given .or. set%method%ikin /= 0 .or. .not. group%given('CRNKI') .or. set%wants_search()) return
      if (size(set%method%delt) == 0) return
      if (.not. abs(set%method%crnki) > 0.0_wp .or. .not. abs(set%method%delt(1)) > 0.0_wp) return
      call group%origins%warning(findings, 'METHOD', 'CRNKI', 'counts from the drawing in a sketch, and DELT from there: the '// &
                                 'first position is '//number_words(set%method%crnki + set%method%delt(1))//' from '// &
                                 'the drawing; leave CRNKI out if DELT is counted from the drawing')
   end subroutine doubt_reference

   !> The limit of transmission angles: TANGLE, the deviation from 90 degrees, or TRMIN of &LIMITS or &CONSTR, the least angle.
   !> A sketch that is analysed has a limit only if one is given.
   subroutine settle_angle_limit(limits, constr, set, findings)
      type(group_t), intent(inout) :: limits
      type(group_t), intent(in) :: constr
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: least

      least = set%constr%least_angle
      call read_least_angle(limits, least, findings)
      set%limits%trmin_given = limits%given('TRMIN') .or. constr%given('TRMIN')
      if (limits%given('TRMIN') .and. constr%given('TRMIN')) call out_of(constr, 'TRMIN', 'is given in &LIMITS too; '// &
                                                                        'leave one of the two out', findings)
      ! of several drives there is no way between the positions
      if (set%limits%trmin_given .and. set%constr%irange == range_positions .and. set%method%ikin == 0 .and. &
          varies(set) .and. count(.not. set%sketch%drives%geared) <= 1) then
         call findings%warning('TRMIN holds at the prescribed positions only; with IRANGE=1 or 2 of &CONSTR it holds between '// &
                               'them, too', line=max(limits%item_line('TRMIN'), constr%item_line('TRMIN')), &
                               group=trim(merge('LIMITS', 'CONSTR', limits%given('TRMIN'))), item='TRMIN')
      end if
      if (set%limits%trmin_given .and. limits%given('TANGLE')) then
         call limits%origins%error(findings, 'LIMITS', 'TANGLE', 'TANGLE, the largest deviation from 90 degrees, and TRMIN, '// &
                                   'the least angle, limit the same angle; leave one of them out')
      else if (set%limits%trmin_given) then
         set%limits%tangle = right_angle - least
         set%limits%tangle_given = .true.
      else if (set%sketch%given .and. .not. set%limits%tangle_given .and. (set%method%ikin /= 0 .or. .not. varies(set))) then
         set%limits%tangle = right_angle
      end if
   end subroutine settle_angle_limit

   !> What desired points of any place, size and direction need.
   subroutine check_similarity(group, set, findings)
      type(group_t), intent(in) :: group             !! METHOD
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(output_kind_t) :: kind
      integer, parameter :: fewest = 3               !! points: two are met by any linkage

      kind = output_kind(set%method%motion)
      if (.not. set%search%solver%many_starts) then
         call out_of(group, 'ISIM', "ISIM=1 (points of any place, size and direction) needs the group &SEARCH with another "// &
                     "SOLVER, as 'LSQ'", findings)
      else if (.not. set%wants_search() .and. .not. set%gives('KINDS')) then
         call out_of(group, 'ISIM', 'place, size and direction of the points are found by a search, but no dimension may vary', &
                     findings)
      else if (kind%components /= 2 .or. .not. set%method%desired) then
         call out_of(group, 'ISIM', 'has desired points of any place, size and direction, but there are no desired points of '// &
                     'the output (MOTION=0, DESX and DESY)', findings)
      else if (allocated(set%method%rate_desired) .or. set%sketch%has_targets()) then
         call out_of(group, 'ISIM', 'leaves the size of the points free: no derivatives and no other outputs can be desired '// &
                     'beside them', findings)
      else if (any(abs(set%method%xmult - set%method%ymult) > 0.0_wp)) then
         call out_of(group, 'ISIM', 'leaves the direction of the points free: XMULT and YMULT must be equal', findings)
      else if (set%method%ndes < fewest .or. .not. any(set%method%xmult > 0.0_wp)) then
         call out_of(group, 'ISIM', 'needs three points at least: two are met by any linkage', findings)
      else if (set%toler%in_objective > 0.0_wp) then
         call out_of(group, 'ISIM', 'leaves the size of the points free: deviations within tolerances (TOLOBJ) cannot be added '// &
                     'to their errors', findings)
      end if
   end subroutine check_similarity

   !> Outputs that are to be equal are compared at inputs that are known, of all positions.
   subroutine check_equalities(group, search, set, findings)
      type(group_t), intent(in) :: group             !! OUTPUTS
      type(group_t), intent(in) :: search            !! SEARCH
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings

      if (.not. allocated(set%sketch%equalities)) return
      if (set%method%ifree /= 0) call out_of(group, 'EQUAL', &
         'compares outputs at prescribed positions, but with IFREE=1 of &METHOD the inputs are unknown', findings, 1)
      if (set%search%few > 0) call out_of(group, 'EQUAL', 'names positions, and NFEW of &SEARCH leaves most of them out', &
                                          findings, 1)
      if (set%search%pareto == pareto_largest .and. .not. set%method%desired .and. size(set%sketch%target_columns()) == 0) &
         call out_of(search, 'PARETO', "'LARGEST' is the largest error of desired values, of which there are none", findings)
   end subroutine check_equalities

   !> Ways of searching that need other items.
   subroutine check_ways(group, set, findings)
      type(group_t), intent(in) :: group             !! SEARCH
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings

      if (set%search%few > 0) then
         if (set%method%ikin /= 0) then
            call out_of(group, 'NFEW', 'few positions first is a way to search, but IKIN asks for an analysis', findings)
         else if (.not. varies(set)) then
            call out_of(group, 'NFEW', 'few positions first is a way to search, but no dimension may vary', findings)
         else if (set%method%ifree /= 0) then
            call out_of(group, 'NFEW', 'few positions first needs prescribed timing: leave out NFEW, or IFREE of &METHOD', findings)
         else if (set%search%few >= set%method%ndes) then
            call out_of(group, 'NFEW', 'must be less than the number of positions, NDES='//to_text(set%method%ndes), findings)
         end if
      end if
      if (set%search%by_dyads) then
         if (set%method%ikin /= 0) then
            call out_of(group, 'IDYAD', 'dyad by dyad is a way to search, but IKIN asks for an analysis', findings)
         else if (.not. varies(set)) then
            call out_of(group, 'IDYAD', 'dyad by dyad is a way to search, but no dimension may vary', findings)
         else if (set%method%ifree /= 0) then
            call out_of(group, 'IDYAD', 'dyad by dyad needs prescribed timing: leave out IDYAD, or IFREE of &METHOD', findings)
         end if
      end if
   end subroutine check_ways

   !> Items that are given and have no effect, because of others.
   subroutine report_idle_items(method, limits, search, outputs, may_search, set, findings)
      type(group_t), intent(in) :: method, limits, search, outputs
      logical, intent(in) :: may_search              !! by the program that reads; others take what a search was given as it is
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      character(*), parameter :: of_positions(*) = [character(name_length) :: 'NDES', 'DELT', 'DESX', 'DESY', 'DESANG', 'XMULT', &
                                                    'YMULT', 'ANMULT', 'IFREE', 'ISIM']
      character(*), parameter :: of_points(*) = [character(name_length) :: 'DESX', 'DESY', 'XMULT', 'YMULT'], &
                                 of_angles(*) = [character(name_length) :: 'DESANG', 'ANMULT'], &
                                 of_weights(*) = [character(name_length) :: 'XMULT', 'YMULT', 'ANMULT'], &
                                 of_bounds(*) = [character(name_length) :: 'OPLOW', 'OPHIGH'], &
                                 of_simplex(*) = [character(name_length) :: 'BOUNCE', 'EXPAND', 'SNAKE', 'REDUCE', 'SHRINK', &
                                                  'NITER', 'NCHECK', 'SMALL', 'NVERT'], &
                                 of_searches(*) = [character(name_length) :: of_simplex, 'NGUESS', 'VAR', 'FMIN'], &
                                 of_ways(*) = [character(name_length) :: 'SOLVER', 'NSTART', 'FIRST', 'NBEST', 'DIFFER', 'PARETO', &
                                               'NEARLY', 'RANKING', 'MAXEVAL']
      type(output_kind_t) :: kind
      character(:), allocatable :: no_search

      if (set%method%ikin /= 0) then
         call idle(method, of_positions, 'IKIN asks for an analysis through one turn; leave IKIN out, or them')
         if (allocated(set%sketch%outputs)) call idle(outputs, wanted_of(size(set%sketch%outputs)), &
                                                      'IKIN asks for an analysis through one turn; leave IKIN out, or them')
      else
         kind = output_kind(set%method%motion)
         if (.not. (method%given('DESX') .or. method%given('DESY') .or. method%given('DESANG'))) then
            call idle(method, of_weights, 'there are no desired values')
         else if (kind%components == 1) then
            call idle(method, of_points, 'the output is an angle or a length, whose desired values are DESANG')
         else if (kind%components == 2) then
            call idle(method, of_angles, 'the output is a point, whose desired values are DESX and DESY')
         end if
      end if
      if (may_search .and. method%line > 0) then
         if (set%method%ikin /= 0 .or. .not. varies(set)) then
            no_search = 'it is for a search, but '// &
                        trim(merge('IKIN asks for an analysis', 'no dimension may vary    ', set%method%ikin /= 0))
            call idle(method, of_searches, no_search)
            call idle(search, of_ways, no_search)
         else if (set%search%solver%many_starts) then
            call idle(method, of_simplex, "it is for SOLVER='SIMPLEX', which this search does not have")
         end if
      end if
      if (set%limits%limval == 0 .and. set%method%var > 0.0_wp .and. varies(set)) call idle(limits, of_bounds, &
         'bounds hold with LIMVAL=1 (and are drawn from with VAR=0)')
      if (set%method%ifree == 0) call idle(search, [character(name_length) :: 'ORDER'], &
                                           'it is for free timing (IFREE=1 of &METHOD)')

   contains

      subroutine idle(group, items, reason)
         type(group_t), intent(in) :: group
         character(*), intent(in) :: items(:), reason
         character(:), allocatable :: others
         integer :: i, first

         first = 0
         others = ''
         do i = 1, size(items)
            if (.not. group%given(trim(items(i)))) cycle
            if (first == 0) then
               first = i
            else
               others = others//', '//trim(items(i))
            end if
         end do
         if (first == 0) return
         if (len(others) > 0) others = ' (nor '//others(3:)//')'
         call group%origins%warning(findings, trim(group%name), trim(items(first)), 'has no effect'//others//': '//reason)
      end subroutine idle
   end subroutine report_idle_items

   !> The items of &OUTPUTS that say what outputs are to be at prescribed positions.
   pure function wanted_of(outputs) result(items)
      integer, intent(in) :: outputs
      character(name_length), allocatable :: items(:)
      integer :: k, order

      allocate (items(0))
      do k = 1, outputs
         do order = lbound(values_of, 1), ubound(values_of, 1)
            items = [character(name_length) :: items, trim(values_of(order))//to_text(k), trim(weights_of(order))//to_text(k)]
         end do
      end do
      items = [character(name_length) :: items, 'EQUAL', 'EQORD', 'EQMULT', 'EQADD', 'EQWGT']
   end function wanted_of

   !> True if any dimension may vary; a sketch has its loops later.
   pure logical function varies(set)
      type(data_set_t), intent(in) :: set

      varies = set%wants_search()
      if (set%sketch%given) varies = size(set%sketch%variations) > 0
   end function varies

   !> The drawing and what is wanted of it, which says what desired values are of.
   subroutine read_sketch(chain, outputs, set, valid, findings)
      type(group_t), intent(inout) :: chain, outputs
      type(data_set_t), intent(inout) :: set
      logical, intent(out) :: valid
      type(diagnostics_t), intent(inout) :: findings
      type(diagnostics_t) :: own, unused

      own%file = findings%file
      call read_chain_group(chain, set%sketch, own)
      valid = chain%line > 0 .and. .not. own%failed()
      set%sketch%valid = valid
      if (chain%line > 0) then
         call findings%append(own)
      end if
      if (valid) then
         call read_outputs_group(outputs, set%sketch, findings)
      else
         ! names that are not there would be reported for every output again
         call read_outputs_group(outputs, set%sketch, unused)
         outputs%missing = outputs%missing(:0)
      end if
      if (chain%line == 0 .and. outputs%line > 0) call belongs_to_chain(outputs, findings)
      if (.not. valid) return
      if (size(set%sketch%outputs) == 0) return
      select case (set%sketch%outputs(1)%kind)
      case (output_angle)
         set%method%motion = motion_angle
      case (output_distance)
         set%method%motion = motion_distance
      case (output_slide)
         set%method%motion = motion_slide
      case (output_pose)
         set%method%motion = motion_pose
      end select
   end subroutine read_sketch

   !> What moves the sketch.
   subroutine read_drives(drives, valid, set, findings)
      type(group_t), intent(inout) :: drives
      logical, intent(in) :: valid
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(diagnostics_t) :: unused

      if (valid .and. drives%line > 0) then
         call read_drives_group(drives, set%method%ndes, set%sketch, findings)
         return
      end if
      call read_drives_group(drives, set%method%ndes, set%sketch, unused)
      drives%missing = drives%missing(:0)
      if (valid) then
         call set%origins%error(findings, 'CHAIN', '', "the sketch needs the group &DRIVES, which says what moves it: &DRIVES "// &
                                "DRIVE='A' &END")
      else if (drives%line > 0 .and. .not. set%sketch%given) then
         call belongs_to_chain(drives, findings)
      end if
   end subroutine read_drives

   subroutine belongs_to_chain(group, findings)
      type(group_t), intent(in) :: group
      type(diagnostics_t), intent(inout) :: findings

      call group%origins%error(findings, trim(group%name), '', 'belongs to the sketch of a group &CHAIN, which is missing')
   end subroutine belongs_to_chain

   !> The positions of a grid of strokes (NGRID), in place of those of &METHOD.
   subroutine fill_grid(method, drives, set, findings)
      use psalm_rate_items, only: gives_rates
      type(group_t), intent(inout) :: method
      type(group_t), intent(in) :: drives
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      character(4), parameter :: items(3) = ['NDES', 'DELT', 'IKIN']
      integer, allocatable :: counts(:), digits(:)
      integer :: i, k, d

      if (.not. set%sketch%given) return
      counts = set%sketch%drives%steps
      if (all(counts == 0) .or. findings%failed()) return
      do i = 1, size(items)
         if (.not. method%given(items(i))) cycle
         call method%origins%error(findings, 'METHOD', items(i), 'the grid NGRID of &DRIVES gives the positions; leave '// &
                                   items(i)//' out')
      end do
      if (set%method%desired .or. gives_rates(method)) &
         call drives%origins%error(findings, 'DRIVES', 'NGRID', 'desired values need positions of their own, NDES and DELT, '// &
                                   'not a grid')
      method%missing = pack(method%missing, method%missing%name /= 'NDES')
      where (counts == 0) counts = 1
      if (product(real(counts, wp)) > real(most_positions, wp)) then
         call drives%origins%error(findings, 'DRIVES', 'NGRID', 'the grid has more than '//to_text(most_positions)//' positions')
         return
      end if
      set%method%ndes = product(counts)
      deallocate (set%method%delt, set%method%desx, set%method%desy, set%method%desang, set%method%xmult, set%method%ymult, &
                  set%method%anmult)
      allocate (set%method%delt(set%method%ndes), set%method%desx(set%method%ndes), set%method%desy(set%method%ndes), &
                set%method%desang(set%method%ndes), source=0.0_wp)
      allocate (set%method%xmult(set%method%ndes), set%method%ymult(set%method%ndes), set%method%anmult(set%method%ndes), &
                source=1.0_wp)
      do d = 2, size(counts)
         if (.not. set%sketch%drives(d)%geared) allocate (set%sketch%drives(d)%delt(set%method%ndes))
      end do
      do k = 1, set%method%ndes
         digits = grid_digits(counts, k)
         do d = 1, size(counts)
            if (set%sketch%drives(d)%geared) cycle
            associate (drive => set%sketch%drives(d))
               if (d == 1) set%method%delt(k) = stroke(drive%low, drive%high, digits(d), counts(d))
               if (d > 1) drive%delt(k) = stroke(drive%low, drive%high, digits(d), counts(d))
            end associate
         end do
      end do

   contains

      !> One of `count` values from `low` to `high`, the ends exactly; zero where it is zero but for rounding.
      pure real(wp) function stroke(low, high, which, count)
         real(wp), intent(in) :: low, high
         integer, intent(in) :: which, count   !! 0 to count - 1
         real(wp), parameter :: roundings = 2.0_wp

         stroke = (low*real(count - 1 - which, wp) + high*real(which, wp))/real(count - 1, wp)
         if (abs(stroke) <= roundings*epsilon(stroke)*max(abs(low), abs(high))) stroke = 0.0_wp
      end function stroke
   end subroutine fill_grid

   !> The first output has its desired values in one of the two groups.
   subroutine refuse_twice(outputs, set, findings)
      type(group_t), intent(in) :: outputs
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      logical :: twice
      integer :: order

      if (size(set%sketch%outputs) == 0) return
      do order = 0, most_targets
         if (.not. allocated(set%sketch%outputs(1)%targets(order)%values)) cycle
         twice = order == 0 .and. set%method%desired
         if (order > 0 .and. allocated(set%method%rate_weight)) twice = any(set%method%rate_weight(:, :, order) > 0.0_wp)
         if (twice) call out_of(outputs, trim(values_of(order))//'1', 'is given, and the same of the first output in &METHOD: '// &
                                'leave one out', findings, 1)
      end do
   end subroutine refuse_twice

   !> Items that count arcs and loops have no meaning for a sketch.
   subroutine refuse_arcs(method, toler, limits, findings)
      type(group_t), intent(in) :: method, toler, limits
      type(diagnostics_t), intent(inout) :: findings
      character(*), parameter :: of_method(*) = [character(name_length) :: 'IVA', 'IVG', 'ILKOUT', 'INGOUT', 'ICRK', 'IORIG']
      character(*), parameter :: of_toler(*) = ['TOLARC', 'TOLGAM', 'TOLOUT', 'TOLOUA']
      integer :: i

      do i = 1, size(of_method)
         if (method%given(trim(of_method(i)))) call out_of(method, trim(of_method(i)), &
            'counts arcs of &LINKS; what of a sketch may '// &
                                                           "vary is named in &CHAIN, VARY='A B'", findings)
      end do
      if (method%given('ORIGLK') .or. method%given('ORIGNG')) call out_of(method, merge('ORIGLK', 'ORIGNG', &
         method%given('ORIGLK')), &
         'places the first joint of &LINKS; a sketch has its own coordinates', findings)
      if (method%given('MOTION')) call out_of(method, 'MOTION', &
         'belongs to &LINKS; what is wanted of a sketch is said in &OUTPUTS', &
                                              findings)
      do i = 1, size(of_toler)
         if (toler%given(of_toler(i))) &
            call out_of(toler, of_toler(i), 'counts arcs of &LINKS; for a sketch there are TOLLEN and TOLANG, and TOLNAM with '// &
                                            'TOLVAL for single dimensions', findings)
      end do
      if (limits%given('OPLOW') .or. limits%given('OPHIGH')) call out_of(limits, merge('OPLOW ', 'OPHIGH', &
         limits%given('OPLOW')), &
         'counts variables of &LINKS; a sketch has its bounds in &CHAIN, VLOW and VHIGH', findings)
   end subroutine refuse_arcs
   !> True if the input slides, as ILOOP or the drive of a sketch says.
   pure logical function sliding_input(set)
      type(data_set_t), intent(in) :: set

      sliding_input = .false.
      if (size(set%links%iloop) > 0) sliding_input = set%links%iloop(1, 1) < 0
      if (set%sketch%given .and. size(set%sketch%drives) > 0) sliding_input = set%sketch%drives(1)%kind /= drive_turns
   end function sliding_input

   !> Keep what `psalm` does not write to device 7 itself, and name what this program does not read.
   subroutine keep_others(case, program, set)
      type(case_text_t), intent(in) :: case
      character(*), intent(in) :: program
      type(data_set_t), intent(inout) :: set
      type(text_t) :: others
      integer :: i

      set%skipped = ''
      do i = 1, case%count
         associate (group => case%groups(i))
            select case (group%name)
            case ('LINKS', 'METHOD', 'LIMITS', 'SEARCH', 'CHAIN', 'DRIVES', 'OUTPUTS', 'KINDS')
               cycle
            end select
            if (.not. (program == 'muscle' .and. any(group%name == written_by_muscle))) call group%render(others)
            if (reads_of(case, program, group%name)) cycle
            if (len(set%skipped) > 0) set%skipped = set%skipped//', '
            set%skipped = set%skipped//'&'//trim(group%name)
            if (.not. is_users(group%name)) set%skipped = set%skipped//' ('//trim(program_of(group%name))//')'
         end associate
      end do
      set%others = others%content()
   end subroutine keep_others

   !> True if the program reads the group of this case: forces for clearances on the side of their load as well, the motor for
   !> its steady cycle.
   pure logical function reads_of(case, program, group)
      type(case_text_t), intent(in) :: case
      character(*), intent(in) :: program, group
      character(*), parameter :: of_forces(*) = [character(name_length) :: 'MASSES', 'PLATES', 'LOADS', 'SPRING', 'FRICTN', 'RATES']
      integer :: i

      reads_of = program_reads(program, group)
      if (group == 'MOTOR' .and. program_reads(program, 'CYCLE')) &
         reads_of = reads_of .or. any(case%groups(:case%count)%name == 'CYCLE')
      if (reads_of .or. .not. program_reads(program, 'ALLOC') .or. all(of_forces /= group)) return
      do i = 1, case%count
         if (case%groups(i)%name == 'ALLOC') &
            reads_of = reads_of .or. any(case%groups(i)%items(:case%groups(i)%count)%name == 'PLOAD')
      end do
   end function reads_of

   !> Groups that no program knows, and groups that are missing.
   subroutine refuse_unknown(case, program, findings)
      type(case_text_t), intent(in) :: case
      character(*), intent(in) :: program
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: name, near
      integer :: i
      logical :: meant_links, meant_method, searches, drawn

      drawn = .false.
      meant_links = any(case%groups(:case%count)%name == 'LINKS') .or. any(case%groups(:case%count)%name == 'CHAIN')
      do i = 1, case%count
         if (case%groups(i)%name == 'CHAIN' .and. any(case%groups(:case%count)%name == 'LINKS')) &
            call findings%error('describes the linkage, and so does &LINKS; leave one of both out', line=case%groups(i)%line, &
                                group='CHAIN')
         drawn = drawn .or. case%groups(i)%name == 'CHAIN'
      end do
      meant_method = any(case%groups(:case%count)%name == 'METHOD')
      do i = 1, case%count
         ! a grid of strokes has its own positions
         if (case%groups(i)%name == 'DRIVES' .and. drawn) &
            meant_method = meant_method .or. any(case%groups(i)%items(:case%groups(i)%count)%name == 'NGRID')
         name = trim(case%groups(i)%name)
         if (is_users(name) .or. len_trim(program_of(name)) > 0) cycle
         near = nearest_group(name)
         meant_links = meant_links .or. near == 'LINKS' .or. near == 'CHAIN'
         meant_method = meant_method .or. near == 'METHOD'
         if (len(near) > 0) then
            near = 'did you mean &'//near//trim(merge(', or &CHAIN of a sketch?', '?                       ', near == 'LINKS'))
         else
            near = 'a group of your own begins with &USER'
         end if
         call findings%error('unknown group &'//name//'; '//near, line=case%groups(i)%line)
      end do
      if (any(case%groups(:case%count)%name == 'EXACT')) then
         ! the linkage is what is sought
         if (program == everything) then
            if (.not. meant_links) return
         else if (.not. program_reads(program, 'EXACT')) then
            if (.not. meant_links) then
               call findings%error('asks the program psalm for linkages; use the cases of its device 7', line=case%line, &
                                   group='EXACT')
               return
            end if
         else
            do i = 1, case%count
               if (any(case%groups(i)%name == [character(name_length) :: 'LINKS', 'CHAIN', 'METHOD'])) call findings%error( &
                  'describes a linkage, but &EXACT asks for all that there are; leave one of both out', line=case%groups(i)%line, &
                  group=trim(case%groups(i)%name))
            end do
            return
         end if
      end if
      if (any(case%groups(:case%count)%name == 'KINDS')) then
         searches = program == searching_program .or. program == everything
         if (.not. (searches .or. meant_links)) then
            call findings%error('asks the program psalm for linkages; use the cases of its device 7', line=case%line, group='KINDS')
            return
         end if
         do i = 1, case%count
            if (any(case%groups(i)%name == [character(name_length) :: 'LINKS', 'CHAIN', 'DRIVES', 'OUTPUTS'])) then
               if (searches) call findings%error( &
                  'describes a linkage, but &KINDS asks which kind it is to be; leave one of both out', &
                  line=case%groups(i)%line, group=trim(case%groups(i)%name))
            end if
         end do
         meant_links = .true.
      end if
      ! Hill's equation from tables needs no linkage
      if (program_reads(program, 'HILL') .and. any(case%groups(:case%count)%name == 'HILL') .and. &
          .not. (meant_links .or. meant_method)) return
      if (case%count == 0) then
         call findings%error('no group is in the case that begins here; a case is a title line, then groups, each as '// &
                             '&METHOD IKIN=10 &END: a sketch (&CHAIN, &DRIVES, &OUTPUTS) or loops (&LINKS), and &METHOD', &
                             line=case%line)
         return
      end if
      if (.not. meant_links) call missing('LINKS', '; a linkage is described by a sketch (&CHAIN) or by its loops (&LINKS)')
      if (.not. meant_method) call missing('METHOD', '; it says for which positions, &METHOD IKIN=10 &END for every 10 degrees')

   contains

      subroutine missing(name, what)
         character(*), intent(in) :: name, what

         call findings%error('the group is missing in the case that begins here'//what, line=case%line, group=name)
      end subroutine missing
   end subroutine refuse_unknown

   !> True for a sketch that the arrays of &LINKS cannot tell.
   pure logical function is_beyond_arrays(self)
      class(data_set_t), intent(in) :: self

      is_beyond_arrays = allocated(self%traced)
      if (is_beyond_arrays) is_beyond_arrays = self%traced%are_beyond_arrays()
   end function is_beyond_arrays
end module psalm_data_set
