!> The group METHOD: the positions, what is wanted of the output there, what may vary, how the thesis's search goes.
!> Source of items and defaults: Oldham (1977), appendix B.
module psalm_method_group
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_group, only: group_t, check_flags, out_of, required
   use psalm_kinds, only: wp
   use psalm_links_group, only: original_arcs
   use psalm_output_kind, only: output_kind_t, output_kind, motion_point, motion_pose
   use psalm_rule, only: rule_t, a_flag, a_number, a_whole
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: method_items
   public :: method_group_t, read_method_group, default_niter, most_positions

   integer, parameter :: most_positions = 10000000 !! above this NDES is taken for a slip of the pen
   integer(int64), parameter :: bytes_of_position = 10*storage_size(1.0_wp)/8 !! of a case: seven arrays, and copies on the way
   integer, parameter :: default_niter = 2         !! the thesis's: enough to look at the start of a search

   !> Positions, targets, variables and the simplex. Angles in degrees, lengths in the user's one unit.
   type :: method_group_t
      integer, allocatable :: iva(:, :), ivg(:, :) !! shape (maxarc, nloop)
      integer :: ilkout = 0, ingout = 0, icrk = 0, iorig = 0
      integer :: ifree = 0                 !! the search finds every input position too
      integer :: isim = 0                  !! place, size and direction of the desired points are free
      integer :: ikin = 0
      integer :: ndes = 0
      logical :: desired = .false.         !! desired values were given
      real(wp) :: crnki = 0.0_wp
      real(wp), allocatable :: delt(:)     !! shape (ndes)
      integer :: motion = motion_point
      real(wp) :: xadd = 0.0_wp, yadd = 0.0_wp
      real(wp), allocatable :: desx(:), desy(:), desang(:)       !! shape (ndes)
      real(wp), allocatable :: xmult(:), ymult(:), anmult(:)     !! shape (ndes)
      real(wp), allocatable :: rate_desired(:, :, :) !! shape (ndes, components, most_rates): derivatives of the output by the
                                           !! input; not allocated: none is wanted
      real(wp), allocatable :: rate_weight(:, :, :) !! the same shape: their weights, 0 where none is wanted
      real(wp) :: origlk = 0.0_wp, origng = 0.0_wp
      real(wp) :: var = 0.1_wp
      integer :: istart = 19
      integer :: nguess = 0
      integer :: nvert = 0                 !! vertices of the simplex; 0: one more than variables
      real(wp) :: bounce = 3.0_wp, expand = 2.0_wp, snake = 0.5_wp, reduce = 0.25_wp, shrink = 0.5_wp
      integer :: niter = default_niter, ncheck = 1
      real(wp) :: fmin = 0.0_wp, small = 0.001_wp
   contains
      procedure :: turn_begins
      procedure :: vertices
   end type method_group_t

   real(wp), parameter :: most_desired = 10.0_wp**min(100, range(1.0_wp) - 25) !! its square has a number, too

   !> The items of the group.
   type(rule_t), parameter :: method_items(*) = [ &
      rule_t('MOTION', a_whole, '', '', '0; of a sketch by &OUTPUTS', '[0,4]', &
             'what is wanted: 0 x and y of the output point, 1 angle of the output arc from the x axis, 2 '// &
             'distance of the output point from the machine origin, 3 length of the sliding arc NOUTLK, 4 pose: '// &
             'place of the output point and angle of the output arc together'), &
      rule_t('IKIN', a_whole, '', 'degrees', '0', '[-360,360]', &
             'analyse every IKIN degrees through one turn from CRNKI; variables and desired values are then '// &
             'ignored'), &
      rule_t('NDES', a_whole, '', '', '', '[1,10000000]', &
             'number of prescribed positions; as many as DELT has, where it is not given; with IKIN none is '// &
             'needed'), &
      rule_t('DELT', a_number, 'NDES', '', '0', '', &
             'increments of the input from CRNKI, degrees or length'), &
      rule_t('CRNKI', a_number, '', '', '0', '', &
             'reference input: angle of the crank from the x axis, or input length; of a sketch, counted from the drawing'), &
      rule_t('DESX', a_number, 'NDES', 'length', '0', '[-1e100,1e100]', &
             'desired x of the output point relative to XADD, MOTION 0 and 4'), &
      rule_t('DESY', a_number, 'NDES', 'length', '0', '[-1e100,1e100]', &
             'desired y of the output point relative to YADD, MOTION 0 and 4'), &
      rule_t('XADD', a_number, '', 'length', '0', '', &
             'added to every DESX'), &
      rule_t('YADD', a_number, '', 'length', '0', '', &
             'added to every DESY'), &
      rule_t('DESANG', a_number, 'NDES', '', '', '[-1e100,1e100]', &
             'desired angle, distance or length, MOTION 1, 2, 3; angle of the pose, MOTION 4'), &
      rule_t('XMULT', a_number, '1 or NDES', '', '1', '', &
             'weights of the squared errors of x'), &
      rule_t('YMULT', a_number, '1 or NDES', '', '1', '', &
             'weights of the squared errors of y'), &
      rule_t('ANMULT', a_number, '1 or NDES', '', '1', '', &
             'weights of the squared errors of DESANG'), &
      rule_t('DVELX', a_number, 'NDES', '', '', '', &
             'desired first derivative of x by the input, per radian or per unit of a sliding input; see '// &
             '[below](#derivatives-as-desired-values)'), &
      rule_t('DVELY', a_number, 'NDES', '', '', '', &
             'desired first derivative of y'), &
      rule_t('DVELANG', a_number, 'NDES', '', '', '', &
             'desired first derivative of the angle, distance or length; angles in radians'), &
      rule_t('DACCX', a_number, 'NDES', '', '', '', &
             'desired second derivative of x'), &
      rule_t('DACCY', a_number, 'NDES', '', '', '', &
             'desired second derivative of y'), &
      rule_t('DACCANG', a_number, 'NDES', '', '', '', &
             'desired second derivative of the angle, distance or length'), &
      rule_t('WVELX', a_number, '1 or NDES', '', '1', '', &
             'weights of the squared errors of DVELX: one, or one for each position'), &
      rule_t('WVELY', a_number, '1 or NDES', '', '1', '', &
             'weights of those of DVELY'), &
      rule_t('WVELANG', a_number, '1 or NDES', '', '1', '', &
             'weights of those of DVELANG'), &
      rule_t('WACCX', a_number, '1 or NDES', '', '1', '', &
             'weights of those of DACCX'), &
      rule_t('WACCY', a_number, '1 or NDES', '', '1', '', &
             'weights of those of DACCY'), &
      rule_t('WACCANG', a_number, '1 or NDES', '', '1', '', &
             'weights of those of DACCANG'), &
      rule_t('ORIGLK', a_number, '', 'length', '0', '', &
             'distance of the input pivot from the machine origin'), &
      rule_t('ORIGNG', a_number, '', 'degrees', '0', '', &
             'direction of the input pivot from the machine origin'), &
      rule_t('IVA', a_flag, 'NLOOP*MAXARC', '', '0', '', &
             '1 where the length of an arc may vary, like ILINK'), &
      rule_t('IVG', a_flag, 'NLOOP*MAXARC', '', '0', '', &
             '1 where the angle of an arc may vary, like ILINK'), &
      rule_t('ILKOUT', a_flag, '', '', '0', '', &
             '1: OUTLK may vary'), &
      rule_t('INGOUT', a_flag, '', '', '0', '', &
             '1: OUTANG may vary'), &
      rule_t('ICRK', a_flag, '', '', '0', '', &
             '1: CRNKI may vary'), &
      rule_t('IORIG', a_flag, '', '', '0', '', &
             '1: ORIGLK and ORIGNG may vary'), &
      rule_t('IFREE', a_flag, '', '', '0', '', &
             '1: free timing, the search finds every input position too (DELT is where it starts); not with '// &
             'SOLVER=''SIMPLEX'''), &
      rule_t('ISIM', a_flag, '', '', '0', '', &
             '1: place, size and direction of the desired points are free, the search finds them too; the output is a point '// &
             '(MOTION=0); not with SOLVER=''SIMPLEX'''), &
      rule_t('NITER', a_whole, '', '', '2', '[0,)', &
             'iteration limit'), &
      rule_t('NCHECK', a_whole, '', '', '1', '[1,)', &
             'test of convergence every NCHECK iterations'), &
      rule_t('FMIN', a_number, '', '', '0', '', &
             'stop below this objective'), &
      rule_t('SMALL', a_number, '', '', '0.001', '[0,)', &
             'relative size of a converged simplex'), &
      rule_t('VAR', a_number, '', '', '0.1', '[0,1]', &
             'first simplex within (1-VAR) to (1+VAR) times the given values; 0: within OPLOW to OPHIGH', &
             'must be from 0.0 to 1.0'), &
      rule_t('ISTART', a_whole, '', '', '19', '[1,999999999]', &
             'start of the random numbers, odd, up to nine digits'), &
      rule_t('NGUESS', a_whole, '', '', '0', '[0,10000000]', &
             'vertices supplied on device 4'), &
      rule_t('NVERT', a_whole, '', '', 'variables + 1', '[2,100000]', &
             'vertices of the simplex. Where variables have bounds (LIMVAL=1) more of them, as twice the number of variables, '// &
             'keep it from flattening against a bound (Box''s complex)'), &
      rule_t('BOUNCE', a_number, '', '', '3', '(1,)', &
             'coefficient of reflection', &
             'must be above 1 (2 reflects by the full distance)'), &
      rule_t('EXPAND', a_number, '', '', '2', '(1,)', &
             'coefficient of expansion'), &
      rule_t('SNAKE', a_number, '', '', '0.5', '[0,)', &
             'coefficient of translation'), &
      rule_t('REDUCE', a_number, '', '', '0.25', '(0,1)', &
             'coefficient of contraction'), &
      rule_t('SHRINK', a_number, '', '', '0.5', '(0,1)', &
             'coefficient of shrinkage')]

contains

   !> Where the turn begins that is shown of a sketch: the whole degree at or below its least input, so that a turn later is exact.
   pure real(wp) function turn_begins(self)
      class(method_group_t), intent(in) :: self
      real(wp) :: least

      least = 0.0_wp
      if (self%ikin < 0) then
         least = real(self%ikin*(359/abs(self%ikin)), wp)
      else if (self%ikin == 0 .and. size(self%delt) > 0) then
         least = minval(self%delt)
      end if
      least = self%crnki + least
      turn_begins = least - modulo(least, 1.0_wp)
   end function turn_begins

   !> Vertices of a simplex of so many variables.
   pure integer function vertices(self, variables)
      class(method_group_t), intent(in) :: self
      integer, intent(in) :: variables

      vertices = variables + 1
      if (self%nvert > 0) vertices = self%nvert
   end function vertices

   !> Read the group. Errors: numbers out of range, fewer or more values than NDES.
   subroutine read_method_group(group, nloop, maxarc, shape_known, of_sketch, method, findings)
      use psalm_system, only: memory_to_be_had
      type(group_t), intent(inout) :: group
      integer, intent(in) :: nloop, maxarc           !! of &LINKS; 0 if they are not valid
      logical, intent(in) :: shape_known             !! they are
      logical, intent(in) :: of_sketch               !! the linkage is one
      type(method_group_t), intent(inout) :: method  !! MOTION as the outputs of a sketch have it
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: integers(:)
      integer :: n

      call group%follow(method_items)
      n = nloop*maxarc
      allocate (integers(max(n, merge(0, original_arcs, shape_known))), source=0)
      call group%get_integers('IVA', integers, findings, maxarc, filler=.true.)
      method%iva = reshape(integers(:n), [maxarc, nloop])
      integers = 0
      call group%get_integers('IVG', integers, findings, maxarc, filler=.true.)
      method%ivg = reshape(integers(:n), [maxarc, nloop])
      call check_flags(group, 'IVA', method%iva, findings)
      call check_flags(group, 'IVG', method%ivg, findings)
      call take(group, 'ILKOUT', method%ilkout, findings)
      call take(group, 'INGOUT', method%ingout, findings)
      call take(group, 'ICRK', method%icrk, findings)
      call take(group, 'IORIG', method%iorig, findings)
      call take(group, 'IFREE', method%ifree, findings)
      call take(group, 'ISIM', method%isim, findings)
      call take(group, 'IKIN', method%ikin, findings)
      call take_count(group, 'NDES', method%ndes, findings)
      if (group%given('NDES') .or. method%ndes > 0) then
         if (.not. memory_to_be_had(bytes_of_position*int(method%ndes, int64))) then
            call findings%failure('not enough memory for NDES='//to_text(method%ndes)//' positions')
            method%ndes = 0
         end if
      else if (method%ikin == 0) then
         call required(group, 'NDES', 'the number of prescribed positions is required (or IKIN for an analysis through one turn)')
      end if
      call take(group, 'CRNKI', method%crnki, findings)
      call take(group, 'MOTION', method%motion, findings)
      method%motion = min(max(method%motion, motion_point), motion_pose)
      call take(group, 'XADD', method%xadd, findings)
      call take(group, 'YADD', method%yadd, findings)
      call take(group, 'ORIGLK', method%origlk, findings)
      call take(group, 'ORIGNG', method%origng, findings)
      call read_positions(group, of_sketch, method, findings)
      call take(group, 'VAR', method%var, findings)
      call take(group, 'ISTART', method%istart, findings)
      if (method%istart > 0 .and. mod(method%istart, 2) == 0) then
         call group%origins%warning(findings, 'METHOD', 'ISTART', 'the random integer must be odd; '//to_text(method%istart + 1)// &
                                    ' is used', 1)
         method%istart = method%istart + 1
      end if
      call take(group, 'NGUESS', method%nguess, findings)
      call take(group, 'NVERT', method%nvert, findings)
      call take(group, 'BOUNCE', method%bounce, findings)
      call take(group, 'EXPAND', method%expand, findings)
      call take(group, 'SNAKE', method%snake, findings)
      call take(group, 'REDUCE', method%reduce, findings)
      call take(group, 'SHRINK', method%shrink, findings)
      call take(group, 'NITER', method%niter, findings)
      call take(group, 'NCHECK', method%ncheck, findings)
      call take(group, 'FMIN', method%fmin, findings)
      call take(group, 'SMALL', method%small, findings)
   end subroutine read_method_group

   !> Increments, desired values and weights: as many as NDES, and fillers up to the size of the original program's arrays
   !> (`161*0.0`, weights `181*1.0`). With IKIN they are not used, and may be any number.
   subroutine read_positions(group, of_sketch, method, findings)
      use psalm_rate_items, only: read_rate_items
      type(group_t), intent(inout) :: group
      logical, intent(in) :: of_sketch
      type(method_group_t), intent(inout) :: method
      type(diagnostics_t), intent(inout) :: findings
      type(output_kind_t) :: kind
      integer :: n, got_x, got_y, got_angle

      n = method%ndes
      allocate (method%delt(n), method%desx(n), method%desy(n), method%desang(n), source=0.0_wp)
      allocate (method%xmult(n), method%ymult(n), method%anmult(n), source=1.0_wp)
      call read_position_array('DELT', method%delt)
      call read_position_array('DESX', method%desx, got_x)
      call read_position_array('DESY', method%desy, got_y)
      call read_position_array('DESANG', method%desang, got_angle)
      call read_position_array('XMULT', method%xmult)
      call read_position_array('YMULT', method%ymult)
      call read_position_array('ANMULT', method%anmult)
      kind = output_kind(method%motion)
      method%desired = .false.
      if (kind%components > 1) method%desired = got_x > 0 .or. got_y > 0
      if (kind%components /= 2) method%desired = method%desired .or. got_angle > 0
      if (method%desired .and. method%ikin == 0) then
         if (kind%components > 1 .and. got_x == 0) call short('DESX', 0)
         if (kind%components > 1 .and. got_y == 0) call short('DESY', 0)
         if (kind%components == 3 .and. got_angle == 0) call short('DESANG', 0)
      end if
      call check_weights('XMULT', method%xmult)
      call check_weights('YMULT', method%ymult)
      call check_weights('ANMULT', method%anmult)
      call read_rate_items(group, method%motion, merge(0, n, method%ikin /= 0), method%rate_desired, method%rate_weight, findings)
      if (allocated(method%rate_desired) .and. .not. method%desired) &
         call group%origins%error(findings, 'METHOD', '', 'derivatives are desired in addition to values ('// &
                                  trim(merge('DESANG       ', 'DESX and DESY', kind%components == 1))//'), which are missing; '// &
                                  'where derivatives alone count, give the values weights of 0'// &
                                  trim(merge('; with DES1 ... of &OUTPUTS give DVEL1 ... there', repeat(' ', 48), of_sketch)))

   contains

      subroutine read_position_array(name, values, got)
         character(*), intent(in) :: name
         real(wp), intent(inout) :: values(:)
         integer, intent(out), optional :: got
         integer :: last, needed, beyond

         call group%get_reals(name, values, findings, last=last, needed=needed, beyond=beyond, as_written=.true., &
                              any_filler=index(name, 'MULT') > 0)
         if (present(got)) got = last
         if (index(name, 'DES') == 1 .and. any(abs(values) > most_desired)) &
            call out_of(group, name, 'is implausibly large (limit 1e100)', findings, &
                        findloc(abs(values) > most_desired, .true., dim=1))
         if (n == 0 .or. method%ikin /= 0) return
         if (beyond > 0) then
            call findings%error('NDES='//to_text(n)//' positions are declared, but '//to_text(needed)// &
                                ' values given; set NDES='//to_text(needed)//' or leave the others out', line=beyond, &
                                group='METHOD', item=name)
         else if (last > 0 .and. last < n .and. index(name, 'MULT') == 0) then
            call short(name, last)
         end if
      end subroutine read_position_array

      subroutine short(name, got)
         character(*), intent(in) :: name
         integer, intent(in) :: got

         call findings%error('NDES='//to_text(n)//' positions are declared, but only '//to_text(got)//' values given', &
                             line=max(group%item_line(name), group%item_line('NDES')), group='METHOD', item=name)
      end subroutine short

      subroutine check_weights(name, values)
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:)
         integer :: negative

         negative = findloc(values < 0.0_wp, .true., dim=1)
         if (negative > 0) call out_of(group, name, 'weights must not be negative', findings, negative)
      end subroutine check_weights
   end subroutine read_positions
end module psalm_method_group
