!> The data set of one mechanism: what the user wrote, checked item by item.
!>
!> A file becomes a list of data sets. Topology is judged later, in `psalm_setup`; here each item is read, given its
!> default and checked by itself. Source of items and defaults: Oldham (1977), appendix B.
module psalm_data_set
   use psalm_kinds, only: wp, full_turn, half_turn, radians_per_degree
   use psalm_constraint_group, only: constraint_group_t, read_constraint_group
   use psalm_group, only: group_t, read_flag, check_flags, check_range, out_of, required
   use psalm_namelist, only: case_text_t, read_case
   use psalm_search_group, only: search_group_t, read_search_group
   use psalm_source, only: line_t, read_lines
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text, edit_distance
   implicit none (type, external)
   private
   public :: data_set_t, read_data_sets
   public :: title_columns
   public :: motion_point, motion_angle, motion_distance, motion_slide

   integer, parameter :: motion_point = 0     !! MOTION 0: x and y of the output point
   integer, parameter :: motion_angle = 1     !! MOTION 1: angle of the output arc
   integer, parameter :: motion_distance = 2  !! MOTION 2: distance of the output point from the origin
   integer, parameter :: motion_slide = 3     !! MOTION 3: length of a sliding arc

   integer, parameter :: original_arcs = 100      !! entries of the thesis's arc arrays: fillers up to here are usual
   integer, parameter :: most_loops = 100000      !! above this NLOOP is taken for a slip of the pen
   integer, parameter :: most_arcs = 10000000     !! likewise NLOOP times MAXARC
   integer, parameter :: most_positions = 10000000 !! likewise NDES
   integer, parameter :: largest_istart = 999999999 !! nine digits
   integer, parameter :: most_trials = 1000000000  !! likewise NTRIAL
   real(wp), parameter :: fastest = 1.0e30_wp      !! likewise SPEED and ACCEL
   integer, parameter :: title_columns = 72        !! of a title, at most

   !> Everything the user can say to `psalm`. Angles in degrees, lengths in the user's one unit.
   type :: data_set_t
      character(:), allocatable :: title   !! at most 72 columns
      character(:), allocatable :: file    !! where it was read from
      integer :: title_line = 0            !! line of the title
      ! LINKS
      integer :: nloop = 0, maxarc = 0
      integer, allocatable :: ilink(:, :)  !! shape (maxarc, nloop): arc numbers
      integer, allocatable :: iloop(:, :)  !! shape (maxarc, nloop): loop or guide numbers
      real(wp), allocatable :: arcl(:, :)  !! shape (maxarc, nloop): lengths
      real(wp), allocatable :: gama(:, :)  !! shape (maxarc, nloop): angles
      integer :: noutlk = 0, noutlp = 0
      real(wp) :: outlk = 0.0_wp, outang = 0.0_wp
      ! METHOD
      integer, allocatable :: iva(:, :), ivg(:, :) !! shape (maxarc, nloop)
      integer :: ilkout = 0, ingout = 0, icrk = 0, iorig = 0
      integer :: ifree = 0                 !! the search finds every input position too
      integer :: ikin = 0
      integer :: ndes = 0
      logical :: desired = .false.         !! desired values were given
      real(wp) :: crnki = 0.0_wp
      real(wp), allocatable :: delt(:)     !! shape (ndes)
      integer :: motion = motion_point
      real(wp) :: xadd = 0.0_wp, yadd = 0.0_wp
      real(wp), allocatable :: desx(:), desy(:), desang(:)       !! shape (ndes)
      real(wp), allocatable :: xmult(:), ymult(:), anmult(:)     !! shape (ndes)
      real(wp) :: origlk = 0.0_wp, origng = 0.0_wp
      real(wp) :: var = 0.1_wp
      integer :: istart = 19
      integer :: nguess = 0
      real(wp) :: bounce = 3.0_wp, expand = 2.0_wp, snake = 0.5_wp, reduce = 0.25_wp, shrink = 0.5_wp
      integer :: niter = 2, ncheck = 1
      real(wp) :: fmin = 0.0_wp, small = 0.001_wp
      ! LIMITS
      real(wp) :: tangle = 50.0_wp, toggle = 0.1_wp
      logical :: tangle_given = .false.                !! then it holds for the angle between two slides too
      integer :: limval = 0
      real(wp), allocatable :: oplow(:), ophigh(:) !! shape (values given, at least the number of variables)
      integer :: bounds_given = 0                  !! values given in both OPLOW and OPHIGH
      real(wp) :: stepin = 0.001_wp
      integer :: ktheta = 0
      integer :: icond = 0                         !! condition number of every position on device 9
      integer :: nviol = 30
      integer :: nprint = 100, nprt = 20
      integer :: iplot = 0
      integer :: last = 1
      type(search_group_t) :: search       !! SEARCH
      type(constraint_group_t) :: constr   !! CONSTR
      ! TOLER
      logical :: tolerances = .false.              !! the group was given
      real(wp), allocatable :: tolarc(:, :), tolgam(:, :) !! shape (maxarc, nloop): of ARCL and GAMA
      real(wp) :: tolout = 0.0_wp, toloua = 0.0_wp !! of OUTLK, OUTANG
      real(wp) :: tolorl = 0.0_wp, tolora = 0.0_wp !! of ORIGLK, ORIGNG
      real(wp) :: tolcrk = 0.0_wp                  !! of CRNKI
      integer :: ntrial = 0                        !! linkages of the Monte-Carlo sample
      ! RATES (read for kalm only)
      real(wp) :: speed = 1.0_wp           !! of the input: rad/s, or length/s
      real(wp) :: accel = 0.0_wp           !! of the input: rad/s**2, or length/s**2
      logical :: rates_given = .false.
      character(:), allocatable :: others  !! the groups of other programs, as text
      ! where the groups stand, for messages
      integer :: links_line = 0, method_line = 0, limits_line = 0
   contains
      procedure :: wants_search
   end type data_set_t

contains

   !> True if any dimension may vary (and IKIN does not override it).
   pure logical function wants_search(self)
      class(data_set_t), intent(in) :: self

      wants_search = self%ikin == 0 .and. (any(self%iva /= 0) .or. any(self%ivg /= 0) .or. self%ilkout /= 0 .or. &
                                           self%ingout /= 0 .or. self%icrk /= 0 .or. self%iorig /= 0)
   end function wants_search

   !> Read every case of a file, up to the one with LAST=1.
   !>
   !> Errors: those of the file, of the notation and of each item, all collected in `findings`.
   subroutine read_data_sets(file, sets, findings, rates)
      character(*), intent(in) :: file                       !! name, `-` for standard input
      type(data_set_t), allocatable, intent(out) :: sets(:)  !! the cases
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in), optional :: rates                 !! read the group RATES too
      type(line_t), allocatable :: lines(:)
      type(case_text_t) :: case
      type(data_set_t) :: set
      type(data_set_t), allocatable :: more(:)
      integer :: next

      allocate (sets(0))
      findings%file = file
      if (file == '-') findings%file = 'standard input'
      call read_lines(file, lines, findings)
      if (findings%failed()) return
      next = 1
      do
         call read_case(lines, next, case, findings)
         if (case%line == 0) then
            if (size(sets) == 0) then
               call findings%error('the file is empty; a case is a title line followed by &LINKS, &METHOD and &LIMITS')
            else
               call findings%error('LAST=0 announces another case, but the file ends here', line=size(lines))
            end if
            return
         end if
         call read_set(case, set, findings)
         if (present(rates)) then
            if (rates) call read_rates(case, set, findings)
         end if
         set%file = findings%file
         allocate (more(size(sets) + 1))
         more(:size(sets)) = sets
         more(size(more)) = set
         call move_alloc(more, sets)
         if (set%last /= 0) exit
      end do
   end subroutine read_data_sets

   subroutine read_set(case, set, findings)
      type(case_text_t), intent(in) :: case
      type(data_set_t), intent(out) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(group_t) :: links, method, limits, group, toler
      logical :: shape_known
      integer :: i

      set%title = case%title(:min(title_columns, len(case%title)))
      set%title_line = case%line
      if (len(case%title) > title_columns) then
         call findings%warning('the title is cut to its first '//to_text(title_columns)//' columns', line=case%line)
      end if
      links = case%take('LINKS')
      method = case%take('METHOD')
      limits = case%take('LIMITS')
      set%links_line = links%line
      set%method_line = method%line
      set%limits_line = limits%line
      call explain_missing(case, links, .true., findings)
      call explain_missing(case, method, .true., findings)
      call explain_missing(case, limits, .false., findings)
      if (links%line > 0) then
         call read_links(links, set, shape_known, findings)
      else
         shape_known = .false.
         allocate (set%ilink(0, 0), set%iloop(0, 0), set%arcl(0, 0), set%gama(0, 0))
      end if
      if (method%line > 0) then
         call read_method(method, set, shape_known, findings)
      else
         allocate (set%iva(0, 0), set%ivg(0, 0))
      end if
      call read_limits(limits, set, findings)
      group = case%take('SEARCH')
      call read_search_group(group, set%search, findings)
      if (set%ifree /= 0 .and. set%search%solver == 'SIMPLEX') then
         call findings%error("IFREE=1 (free timing) needs the group &SEARCH with another SOLVER, as 'LSQ'", line=set%method_line, &
                             group='METHOD', item='IFREE')
      end if
      if (set%ifree /= 0 .and. set%ikin == 0 .and. .not. set%wants_search()) then
         call findings%error('free timing is a part of a search, but no dimension may vary', line=set%method_line, group='METHOD', &
                             item='IFREE')
      end if
      group = case%take('CONSTR')
      call read_constraint_group(group, set%nloop, set%maxarc, set%constr, findings)
      toler = case%take('TOLER')
      call read_tolerances(toler, set, findings)
      set%others = ''
      do i = 1, case%count
         select case (case%groups(i)%name)
         case ('LINKS', 'METHOD', 'LIMITS', 'SEARCH')
            continue
         case default
            set%others = set%others//case%groups(i)%render()
         end select
      end do
   end subroutine read_set

   !> Group TOLER: tolerances of dimensions, one for all or one for each, and the size of the sample.
   subroutine read_tolerances(group, set, findings)
      type(group_t), intent(inout) :: group
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      real(wp), allocatable :: reals(:)
      real(wp) :: of_lengths, of_angles
      integer :: n

      n = set%nloop*set%maxarc
      allocate (set%tolarc(set%maxarc, set%nloop), set%tolgam(set%maxarc, set%nloop), source=0.0_wp)
      set%tolerances = group%line > 0
      if (.not. set%tolerances) return
      of_lengths = 0.0_wp
      of_angles = 0.0_wp
      call group%get_real('TOLLEN', of_lengths, findings)
      call group%get_real('TOLANG', of_angles, findings)
      allocate (reals(n), source=of_lengths)
      call group%get_reals('TOLARC', reals, findings, set%maxarc, excess=0)
      set%tolarc = reshape(reals, [set%maxarc, set%nloop])
      reals = of_angles
      call group%get_reals('TOLGAM', reals, findings, set%maxarc, excess=0)
      set%tolgam = reshape(reals, [set%maxarc, set%nloop])
      if (set%outlk > 0.0_wp) set%tolout = of_lengths
      set%toloua = of_angles
      if (set%origlk > 0.0_wp) set%tolorl = of_lengths
      if (set%origlk > 0.0_wp) set%tolora = of_angles
      call group%get_real('TOLOUT', set%tolout, findings)
      call group%get_real('TOLOUA', set%toloua, findings)
      call group%get_real('TOLORL', set%tolorl, findings)
      call group%get_real('TOLORA', set%tolora, findings)
      call group%get_real('TOLCRK', set%tolcrk, findings)
      call group%get_integer('NTRIAL', set%ntrial, findings)
      call check_range(group, 'NTRIAL', set%ntrial, 0, most_trials, findings)
      if (any(set%tolarc >= set%arcl .and. set%arcl > 0.0_wp)) then
         call findings%error('the tolerance of a length is not smaller than the length', line=group%line, group='TOLER')
      end if
      if (any(set%tolgam > half_turn) .or. max(set%toloua, set%tolora) > half_turn) then
         call findings%error('the tolerance of an angle is more than 180 degrees', line=group%line, group='TOLER')
      end if
      if (any(set%tolarc < 0.0_wp) .or. any(set%tolgam < 0.0_wp) .or. min(set%tolout, set%toloua, set%tolorl, set%tolora, &
                                                                         set%tolcrk) < 0.0_wp) then
         call findings%error('a tolerance is negative; it is the largest deviation to either side', line=group%line, &
                             group='TOLER')
      end if
      call group%finish(findings)
   end subroutine read_tolerances

   !> A group that is absent but required, or absent while a misspelt one stands there.
   subroutine explain_missing(case, group, required, findings)
      type(case_text_t), intent(in) :: case
      type(group_t), intent(in) :: group
      logical, intent(in) :: required
      type(diagnostics_t), intent(inout) :: findings
      integer :: i
      integer, parameter :: slip = 2 !! letters that a misspelt name may differ by

      if (group%line > 0) return
      do i = 1, case%count
         if (edit_distance(trim(case%groups(i)%name), trim(group%name)) <= slip) then
            call findings%error('unknown group &'//trim(case%groups(i)%name)//', while &'//trim(group%name)// &
                                ' is missing; did you mean &'//trim(group%name)//'?', line=case%groups(i)%line)
            return
         end if
      end do
      if (required) call findings%error('the group is missing in the case that begins here', line=case%line, &
                                        group=trim(group%name))
   end subroutine explain_missing

   subroutine read_links(group, set, shape_known, findings)
      type(group_t), intent(inout) :: group
      type(data_set_t), intent(inout) :: set
      logical, intent(out) :: shape_known
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: integers(:)
      real(wp), allocatable :: reals(:)
      integer :: n, highest, row, column

      call group%get_integer('NLOOP', set%nloop, findings)
      call group%get_integer('MAXARC', set%maxarc, findings)
      call check_range(group, 'NLOOP', set%nloop, 1, most_loops, findings, required=.true.)
      call check_range(group, 'MAXARC', set%maxarc, 3, most_arcs, findings, required=.true.)
      shape_known = set%nloop >= 1 .and. set%nloop <= most_loops .and. set%maxarc >= 3 .and. set%maxarc <= most_arcs
      if (shape_known) shape_known = set%maxarc <= most_arcs/set%nloop
      n = 0
      if (shape_known) then
         n = set%nloop*set%maxarc
      else
         set%nloop = 0
         set%maxarc = 0
      end if
      allocate (integers(max(n, merge(0, original_arcs, shape_known))), source=0)
      allocate (reals(size(integers)), source=0.0_wp)
      call group%get_integers('ILINK', integers, findings, set%maxarc, excess=0, last=highest)
      if (highest == 0) call required(group, 'ILINK', findings)
      set%ilink = reshape(integers(:n), [set%maxarc, set%nloop])
      integers = 0
      call group%get_integers('ILOOP', integers, findings, set%maxarc, excess=0, last=highest)
      if (highest == 0) call required(group, 'ILOOP', findings)
      set%iloop = reshape(integers(:n), [set%maxarc, set%nloop])
      call group%get_reals('ARCL', reals, findings, set%maxarc, excess=0)
      set%arcl = reshape(reals(:n), [set%maxarc, set%nloop])
      reals = 0.0_wp
      call group%get_reals('GAMA', reals, findings, set%maxarc, excess=0)
      set%gama = reshape(reals(:n), [set%maxarc, set%nloop])
      do row = 1, set%nloop
         do column = 1, set%maxarc
            if (set%arcl(column, row) < 0.0_wp) then
               call findings%error('length of arc '//to_text(column)//' in loop '//to_text(row)// &
                                   ' is negative; lengths are positive, directions go into GAMA and ILINK', &
                                   line=group%item_line('ARCL'), group='LINKS', item='ARCL')
            end if
         end do
      end do
      call group%get_integer('NOUTLK', set%noutlk, findings)
      call group%get_integer('NOUTLP', set%noutlp, findings)
      call group%get_real('OUTLK', set%outlk, findings)
      call group%get_real('OUTANG', set%outang, findings)
      if (.not. group%given('NOUTLK')) call required(group, 'NOUTLK', findings)
      if (.not. group%given('NOUTLP')) call required(group, 'NOUTLP', findings)
      if (set%outlk < 0.0_wp) call findings%error('the length is negative; turn OUTANG by 180 instead', &
                                                  line=group%item_line('OUTLK'), group='LINKS', item='OUTLK')
      call group%finish(findings)
   end subroutine read_links

   subroutine read_method(group, set, shape_known, findings)
      type(group_t), intent(inout) :: group
      type(data_set_t), intent(inout) :: set
      logical, intent(in) :: shape_known
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: integers(:)
      integer :: n

      n = set%nloop*set%maxarc
      allocate (integers(max(n, merge(0, original_arcs, shape_known))), source=0)
      call group%get_integers('IVA', integers, findings, set%maxarc, excess=0)
      set%iva = reshape(integers(:n), [set%maxarc, set%nloop])
      integers = 0
      call group%get_integers('IVG', integers, findings, set%maxarc, excess=0)
      set%ivg = reshape(integers(:n), [set%maxarc, set%nloop])
      call check_flags(group, 'IVA', set%iva, findings)
      call check_flags(group, 'IVG', set%ivg, findings)
      call read_flag(group, 'ILKOUT', set%ilkout, findings)
      call read_flag(group, 'INGOUT', set%ingout, findings)
      call read_flag(group, 'ICRK', set%icrk, findings)
      call read_flag(group, 'IORIG', set%iorig, findings)
      call read_flag(group, 'IFREE', set%ifree, findings)
      call group%get_integer('IKIN', set%ikin, findings)
      call check_range(group, 'IKIN', set%ikin, -360, 360, findings)
      call group%get_integer('NDES', set%ndes, findings)
      if (group%given('NDES')) then
         call check_range(group, 'NDES', set%ndes, 1, most_positions, findings)
         if (set%ndes < 1 .or. set%ndes > most_positions) set%ndes = 0
      else if (set%ikin == 0) then
         call findings%error('the number of prescribed positions is required (or IKIN for an analysis through one turn)', &
                             line=group%line, group='METHOD', item='NDES')
      end if
      call group%get_real('CRNKI', set%crnki, findings)
      call group%get_integer('MOTION', set%motion, findings)
      call check_range(group, 'MOTION', set%motion, motion_point, motion_slide, findings)
      call group%get_real('XADD', set%xadd, findings)
      call group%get_real('YADD', set%yadd, findings)
      call group%get_real('ORIGLK', set%origlk, findings)
      call group%get_real('ORIGNG', set%origng, findings)
      call read_positions(group, set, findings)
      call group%get_real('VAR', set%var, findings)
      if (set%var < 0.0_wp .or. set%var > 1.0_wp) call findings%error('must lie in 0.0 to 1.0', &
                                                                    line=group%item_line('VAR'), group='METHOD', item='VAR')
      call group%get_integer('ISTART', set%istart, findings)
      call check_range(group, 'ISTART', set%istart, 1, largest_istart, findings)
      if (set%istart > 0 .and. mod(set%istart, 2) == 0) then
         call findings%warning('the random integer must be odd; '//to_text(set%istart + 1)//' is used', &
                               line=group%item_line('ISTART'), group='METHOD', item='ISTART')
         set%istart = set%istart + 1
      end if
      call group%get_integer('NGUESS', set%nguess, findings)
      call check_range(group, 'NGUESS', set%nguess, 0, most_arcs, findings)
      call group%get_real('BOUNCE', set%bounce, findings)
      call group%get_real('EXPAND', set%expand, findings)
      call group%get_real('SNAKE', set%snake, findings)
      call group%get_real('REDUCE', set%reduce, findings)
      call group%get_real('SHRINK', set%shrink, findings)
      if (set%bounce <= 1.0_wp) call out_of(group, 'BOUNCE', 'must be above 1 (2 reflects by the full distance)', findings)
      if (set%expand <= 1.0_wp) call out_of(group, 'EXPAND', 'must be above 1', findings)
      if (set%snake < 0.0_wp) call out_of(group, 'SNAKE', 'must not be negative', findings)
      if (set%reduce <= 0.0_wp .or. set%reduce >= 1.0_wp) call out_of(group, 'REDUCE', 'must lie between 0 and 1', findings)
      if (set%shrink <= 0.0_wp .or. set%shrink >= 1.0_wp) call out_of(group, 'SHRINK', 'must lie between 0 and 1', findings)
      call group%get_integer('NITER', set%niter, findings)
      call check_range(group, 'NITER', set%niter, 0, huge(1), findings)
      call group%get_integer('NCHECK', set%ncheck, findings)
      call check_range(group, 'NCHECK', set%ncheck, 1, huge(1), findings)
      call group%get_real('FMIN', set%fmin, findings)
      call group%get_real('SMALL', set%small, findings)
      if (set%small < 0.0_wp) call out_of(group, 'SMALL', 'must not be negative', findings)
      call group%finish(findings)
   end subroutine read_method

   !> Increments, desired values and weights: as many as NDES, more are ignored.
   subroutine read_positions(group, set, findings)
      type(group_t), intent(inout) :: group
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      integer :: n, got_x, got_y, got_angle

      n = set%ndes
      allocate (set%delt(n), set%desx(n), set%desy(n), set%desang(n), source=0.0_wp)
      allocate (set%xmult(n), set%ymult(n), set%anmult(n), source=1.0_wp)
      call read_position_array('DELT', set%delt)
      call read_position_array('DESX', set%desx, got_x)
      call read_position_array('DESY', set%desy, got_y)
      call read_position_array('DESANG', set%desang, got_angle)
      call read_position_array('XMULT', set%xmult)
      call read_position_array('YMULT', set%ymult)
      call read_position_array('ANMULT', set%anmult)
      if (set%motion == motion_point) then
         set%desired = got_x > 0 .or. got_y > 0
         if (set%desired .and. set%ikin == 0) then
            if (got_x == 0) call short('DESX', 0)
            if (got_y == 0) call short('DESY', 0)
         end if
      else
         set%desired = got_angle > 0
      end if
      if (any(set%xmult < 0.0_wp)) call out_of(group, 'XMULT', 'weights must not be negative', findings)
      if (any(set%ymult < 0.0_wp)) call out_of(group, 'YMULT', 'weights must not be negative', findings)
      if (any(set%anmult < 0.0_wp)) call out_of(group, 'ANMULT', 'weights must not be negative', findings)

   contains

      subroutine read_position_array(name, values, got)
         character(*), intent(in) :: name
         real(wp), intent(inout) :: values(:)
         integer, intent(out), optional :: got
         integer :: last

         call group%get_reals(name, values, findings, excess=1, last=last)
         if (present(got)) got = last
         if (last > 0 .and. last < n .and. set%ikin == 0) then
            if (index(name, 'MULT') == 0) call short(name, last)
         end if
      end subroutine read_position_array

      subroutine short(name, got)
         character(*), intent(in) :: name
         integer, intent(in) :: got

         call findings%error('NDES='//to_text(n)//' positions are announced, but only '//to_text(got)//' values given', &
                             line=max(group%item_line(name), group%item_line('NDES')), group='METHOD', item=name)
      end subroutine short
   end subroutine read_positions

   subroutine read_limits(group, set, findings)
      type(group_t), intent(inout) :: group
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      integer :: room, low, high

      call group%get_real('TANGLE', set%tangle, findings)
      set%tangle_given = group%given('TANGLE')
      if (set%tangle <= 0.0_wp .or. set%tangle > 90.0_wp) then
         call out_of(group, 'TANGLE', 'must lie between 0 and 90 degrees', findings)
      end if
      call group%get_real('TOGGLE', set%toggle, findings)
      if (set%toggle < 0.0_wp) call out_of(group, 'TOGGLE', 'must not be negative', findings)
      call read_flag(group, 'LIMVAL', set%limval, findings)
      room = 2*set%nloop*set%maxarc + 5
      allocate (set%oplow(room), set%ophigh(room), source=0.0_wp)
      call group%get_reals('OPLOW', set%oplow, findings, excess=0, last=low)
      call group%get_reals('OPHIGH', set%ophigh, findings, excess=0, last=high)
      set%bounds_given = min(low, high)
      call group%get_real('STEPIN', set%stepin, findings)
      if (set%stepin < 0.0_wp) call out_of(group, 'STEPIN', 'must not be negative', findings)
      call read_flag(group, 'KTHETA', set%ktheta, findings)
      call read_flag(group, 'ICOND', set%icond, findings)
      call group%get_integer('NVIOL', set%nviol, findings)
      call check_range(group, 'NVIOL', set%nviol, 0, huge(1), findings)
      call group%get_integer('NPRINT', set%nprint, findings)
      call check_range(group, 'NPRINT', set%nprint, 1, huge(1), findings)
      call group%get_integer('NPRT', set%nprt, findings)
      call check_range(group, 'NPRT', set%nprt, 1, huge(1), findings)
      call read_flag(group, 'IPLOT', set%iplot, findings)
      call read_flag(group, 'LAST', set%last, findings)
      call group%finish(findings)
   end subroutine read_limits

   !> Group RATES: speed and acceleration of the input, in the units named.
   subroutine read_rates(case, set, findings)
      type(case_text_t), intent(in) :: case
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(group_t) :: group
      character(:), allocatable :: units
      real(wp) :: unit
      logical :: sliding

      group = case%take('RATES')
      set%rates_given = group%line > 0
      sliding = .false.
      if (size(set%iloop) > 0) sliding = set%iloop(1, 1) < 0
      units = trim(merge('LENGTH/S', 'RAD/S   ', sliding))
      call group%get_real('SPEED', set%speed, findings)
      call group%get_real('ACCEL', set%accel, findings)
      call group%get_word('UNITS', units, findings)
      unit = 1.0_wp
      select case (units)
      case ('RAD/S', 'LENGTH/S')
         continue
      case ('DEG/S')
         unit = radians_per_degree
      case ('REV/S')
         unit = full_turn*radians_per_degree
      case ('REV/MIN', 'RPM')
         unit = full_turn*radians_per_degree/60.0_wp
      case default
         call out_of(group, 'UNITS', "one of 'RAD/S', 'DEG/S', 'REV/S', 'REV/MIN', 'LENGTH/S' is expected; found '"//units//"'", &
                     findings)
      end select
      if (sliding .neqv. units == 'LENGTH/S') then
         call out_of(group, 'UNITS', "a sliding input has 'LENGTH/S', a turning one an angle a time; found '"//units//"'", findings)
      end if
      if (abs(set%speed) > fastest) call out_of(group, 'SPEED', 'is out of all reason', findings)
      if (abs(set%accel) > fastest) call out_of(group, 'ACCEL', 'is out of all reason', findings)
      set%speed = set%speed*unit
      set%accel = set%accel*unit
      call group%finish(findings)
   end subroutine read_rates
end module psalm_data_set
