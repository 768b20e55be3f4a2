!> The groups DRIVEL (a linkage driven through a flexible shaft) and HILL (a forced Hill equation given by tables).
module psalm_drive_group
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp
   use psalm_rule, only: rule_t, a_flag, a_number, a_whole
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: shaft_items, hill_items
   public :: drive_group_t, hill_group_t, drive_of, hill_of

   integer, parameter :: most_equations = 10    !! of HILL

   type, extends(case_group_t) :: drive_group_t
      real(wp) :: stiffness = 0.0_wp           !! DSTIF: of the shaft, N m/rad
      real(wp) :: ratio = 0.0_wp               !! DMEAN: mean of frequency/speed, in place of the stiffness; 0: not given
      real(wp) :: damping = 0.0_wp             !! DDAMP: C = viscous coefficient/sqrt(S J0)
      real(wp) :: extra = 0.0_wp               !! DEXTRA: inertia that turns with the crank, kg m2
      real(wp) :: ripple = 0.0_wp              !! DRIPPL: J = DEXTRA (1 + DRIPPL sin 2 phi), in place of the linkage's; 0: not given
      logical :: offsets = .true.              !! DOFFS=0: first moments of the masses dropped, as the thesis has it
      integer :: harmonics = 12                !! NDHARM: that are listed
      real(wp) :: slowest = 0.0_wp, fastest = 0.0_wp !! DSPLOW, DSPHGH: rad/s
      integer :: speeds = 0                    !! NDSPED: speeds in this range
      integer :: points = 256                  !! NDPNT: positions in a turn
   contains
      procedure :: read => read_drive
   end type drive_group_t

   type, extends(case_group_t) :: hill_group_t
      real(wp), allocatable :: c1(:), c0(:), p(:) !! HC1, HC0, HP, shape (NHILL): at equal steps of one period of 2 pi
      integer :: equations = 1                 !! NHEQN
      real(wp), allocatable :: damping(:, :, :), stiffness(:, :, :) !! HMC1, HMC0 of several equations: shape (NHILL, NHEQN,
                                               !! NHEQN), positions, equation, unknown
      real(wp), allocatable :: load(:, :)      !! HMP: shape (NHILL, NHEQN)
      real(wp) :: tolerance = 1.0e-10_wp       !! HTOL
      integer :: harmonics = 12                !! NHHARM: that are listed
   contains
      procedure :: read => read_hill
   end type hill_group_t

   !> The items of the group.
   type(rule_t), parameter :: shaft_items(*) = [ &
      rule_t('DSTIF', a_number, '', 'N m/rad', '', '', &
             'stiffness of the shaft; or DMEAN'), &
      rule_t('DMEAN', a_number, '', '', '', '', &
             'mean over the turn of the drive''s frequency/speed: the stiffness follows'), &
      rule_t('DDAMP', a_number, '', '', '0', '[0,)', &
             'viscous coefficient/sqrt(stiffness * mean inertia): twice the part of critical'), &
      rule_t('DEXTRA', a_number, '', 'kg m2', '0', '[0,)', &
             'inertia that turns with the crank'), &
      rule_t('DRIPPL', a_number, '', '', '0', '[0,1)', &
             'in place of the linkage''s inertia DEXTRA * (1 + DRIPPL sin 2 phi), phi from the reference '// &
             'position; multipliers are then of half a turn'), &
      rule_t('DOFFS', a_flag, '', '', '1', '', &
             '0: leave the offsets of the centres of mass out, as the thesis''s case study did; the right '// &
             'inertia is listed as well'), &
      rule_t('DSPLOW', a_number, '', 'rad/s', '0', '', &
             'range of speeds: the lowest'), &
      rule_t('DSPHGH', a_number, '', 'rad/s', '0', '', &
             'the highest speed'), &
      rule_t('NDSPED', a_whole, '', '', '0', '[0,10000]', &
             'number of speeds in this range'), &
      rule_t('NDHARM', a_whole, '', '', '12', '[0,1000]', &
             'harmonics listed'), &
      rule_t('NDPNT', a_whole, '', '', '256', '[16,4096]', &
             'positions in a turn')]

   !> The items of the group.
   type(rule_t), parameter :: hill_items(*) = [ &
      rule_t('NHILL', a_whole, '', '', 'as many as the longest item has', '[1,4096]', &
             'number of values, at equal steps from 0'), &
      rule_t('HC1', a_number, 'NHILL', '', '0', '', &
             'c1'), &
      rule_t('HC0', a_number, 'NHILL', '', '0', '', &
             'c0'), &
      rule_t('HP', a_number, 'NHILL', '', '0', '', &
             'p'), &
      rule_t('NHEQN', a_whole, '', '', '1', '[1,10]', &
             'number of equations; of several HMC1, HMC0 and HMP take the place of HC1, HC0 and HP, and NHILL is required'), &
      rule_t('HMC1', a_number, 'n', '', '0', '', &
             'C1 of several equations: NHILL values of element (1,1), then of (1,2) ..., row by row'), &
      rule_t('HMC0', a_number, 'n', '', '0', '', &
             'C0, in the same order'), &
      rule_t('HMP', a_number, 'n', '', '0', '', &
             'p: NHILL values of each equation'), &
      rule_t('HTOL', a_number, '', '', '1E-10', '[1E-14,)', &
             'relative error of the matrix of a period', &
             'must be at least 1E-14'), &
      rule_t('NHHARM', a_whole, '', '', '12', '[0,1000]', &
             'harmonics listed')]

contains

   !> Read the group DRIVEL. Errors: numbers out of range, both a stiffness and a mean ratio or neither.
   subroutine read_drive_group(group, drive, findings)
      type(group_t), intent(inout) :: group
      type(drive_group_t), intent(inout) :: drive
      type(diagnostics_t), intent(inout) :: findings

      drive%given = group%line > 0
      call group%follow(shaft_items)
      call take(group, 'DSTIF', drive%stiffness, findings)
      call take(group, 'DMEAN', drive%ratio, findings)
      call take(group, 'DDAMP', drive%damping, findings)
      call take(group, 'DEXTRA', drive%extra, findings)
      call take(group, 'DRIPPL', drive%ripple, findings)
      call take(group, 'DOFFS', drive%offsets, findings)
      call take(group, 'NDHARM', drive%harmonics, findings)
      call take(group, 'DSPLOW', drive%slowest, findings)
      call take(group, 'DSPHGH', drive%fastest, findings)
      call take(group, 'NDSPED', drive%speeds, findings)
      call take(group, 'NDPNT', drive%points, findings)
      if (.not. drive%given) return
      if (group%given('DSTIF') .eqv. group%given('DMEAN')) then
         call out_of(group, 'DSTIF', &
               'give either the stiffness of the shaft (DSTIF) or the mean ratio of its frequency '// &
                     'to the speed (DMEAN)', findings)
      else if (group%given('DSTIF') .and. .not. drive%stiffness > 0.0_wp) then
         call out_of(group, 'DSTIF', 'must be above 0', findings)
      else if (group%given('DMEAN') .and. .not. drive%ratio > 0.0_wp) then
         call out_of(group, 'DMEAN', 'must be above 0', findings)
      end if
      if (drive%ripple > 0.0_wp .and. .not. drive%extra > 0.0_wp) then
         call required(group, 'DEXTRA', 'missing; DRIPPL makes it vary')
      end if
      if (drive%speeds > 0) then
         if (.not. drive%slowest > 0.0_wp) call out_of(group, 'DSPLOW', 'speeds must be above 0', findings)
         if (drive%fastest < drive%slowest) call out_of(group, 'DSPHGH', 'must not be below DSPLOW', findings)
      end if
   end subroutine read_drive_group

   !> Read the group HILL. Errors: tables that are too short, a tolerance out of reach.
   subroutine read_hill_group(group, hill, findings)
      type(group_t), intent(inout) :: group
      type(hill_group_t), intent(inout) :: hill
      type(diagnostics_t), intent(inout) :: findings
      integer :: n, last(3)

      hill%given = group%line > 0
      call group%follow(hill_items)
      call take_count(group, 'NHILL', n, findings)
      allocate (hill%c1(n), hill%c0(n), hill%p(n), source=0.0_wp)
      call take(group, 'HC1', hill%c1, findings, last=last(1))
      call take(group, 'HC0', hill%c0, findings, last=last(2))
      call take(group, 'HP', hill%p, findings, last=last(3))
      call take(group, 'NHEQN', hill%equations, findings)
      call read_matrices(group, n, hill, findings)
      call take(group, 'HTOL', hill%tolerance, findings)
      call take(group, 'NHHARM', hill%harmonics, findings)
      if (.not. hill%given) return
      if (n == 0 .and. hill%equations <= 1) call required(group, 'HC0', 'missing; the tables have no values')
      call check_table('HC1', last(1))
      call check_table('HC0', last(2))
      call check_table('HP', last(3))

   contains

      subroutine check_table(item, last)
         character(*), intent(in) :: item
         integer, intent(in) :: last

         if (group%given(item) .and. last < n) then
            call out_of(group, item, to_text(n)//' values are announced by NHILL, but only '//to_text(last)//' given', findings)
         end if
      end subroutine check_table
   end subroutine read_hill_group

   !> Tables of several equations. Errors: those of one equation beside them, tables that are too short.
   subroutine read_matrices(group, n, hill, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: n                 !! NHILL
      type(hill_group_t), intent(inout) :: hill
      type(diagnostics_t), intent(inout) :: findings
      character(*), parameter :: single(3) = [character(3) :: 'HC1', 'HC0', 'HP'], &
                                 several(3) = [character(4) :: 'HMC1', 'HMC0', 'HMP']
      real(wp), allocatable :: values(:)
      integer :: k, m, last

      m = min(max(hill%equations, 1), most_equations)
      allocate (hill%damping(n, m, m), hill%stiffness(n, m, m), hill%load(n, m), source=0.0_wp)
      do k = 1, size(several)
         if (m == 1) then
            if (group%given(trim(several(k)))) call out_of(group, trim(several(k)), 'is for several equations; give NHEQN', &
                                                           findings)
         end if
         allocate (values(n*m*merge(1, m, k == 3)), source=0.0_wp)
         call take(group, trim(several(k)), values, findings, last=last)
         if (m > 1) then
            if (group%given(trim(several(k))) .and. last /= size(values)) &
               call out_of(group, trim(several(k)), to_text(size(values))//' values are expected, NHILL of each '// &
                           'element; there are '//to_text(last), findings)
            if (group%given(trim(single(k)))) call out_of(group, trim(single(k)), 'is for one equation; of several give '// &
                trim(several(k)), findings)
         end if
         select case (k)
         case (1)
            hill%damping = reshape(values, [n, m, m], order=[1, 3, 2])
         case (2)
            hill%stiffness = reshape(values, [n, m, m], order=[1, 3, 2])
         case default
            hill%load = reshape(values, [n, m])
         end select
         deallocate (values)
      end do
      if (m > 1 .and. .not. group%given('NHILL')) call required(group, 'NHILL', 'missing; of several equations it says '// &
                                                                'how many values each element has')
   end subroutine read_matrices

   !> The group as the case has it.
   subroutine read_drive(self, group, about, findings)
      class(drive_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      associate (unused => about)
      end associate
      call read_drive_group(group, self, findings)
   end subroutine read_drive

   !> The group DRIVEL of a case; as it is by default where the case does not have it.
   pure function drive_of(set) result(drive)
      class(data_set_t), intent(in) :: set
      type(drive_group_t) :: drive
      integer :: k

      k = set%place_of('DRIVEL')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (drive_group_t)
         drive = group
      end select
   end function drive_of

   !> The group as the case has it.
   subroutine read_hill(self, group, about, findings)
      class(hill_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      associate (unused => about)
      end associate
      call read_hill_group(group, self, findings)
   end subroutine read_hill

   !> The group HILL of a case; as it is by default where the case does not have it.
   pure function hill_of(set) result(hill)
      class(data_set_t), intent(in) :: set
      type(hill_group_t) :: hill
      integer :: k

      k = set%place_of('HILL')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (hill_group_t)
         hill = group
      end select
   end function hill_of
end module psalm_drive_group
