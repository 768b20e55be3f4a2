!> The groups DRIVEL (a linkage driven through a flexible shaft) and HILL (a forced Hill equation given by tables).
module psalm_drive_group
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, check_range, out_of, read_flag, required
   use psalm_kinds, only: wp
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: drive_group_t, hill_group_t, drive_of, hill_of

   integer, parameter :: fewest_points = 16, most_points = 4096, most_speeds = 10000, most_harmonics = 1000
   real(wp), parameter :: finest = 1.0e-14_wp !! least tolerance that can be asked for

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
      real(wp) :: tolerance = 1.0e-10_wp       !! HTOL
      integer :: harmonics = 12                !! NHHARM: that are listed
   contains
      procedure :: read => read_hill
   end type hill_group_t

contains

   !> Read the group DRIVEL. Errors: numbers out of range, both a stiffness and a mean ratio or neither.
   subroutine read_drive_group(group, drive, findings)
      type(group_t), intent(inout) :: group
      type(drive_group_t), intent(inout) :: drive
      type(diagnostics_t), intent(inout) :: findings
      integer :: offsets

      drive%given = group%line > 0
      call group%get_real('DSTIF', drive%stiffness, findings)
      call group%get_real('DMEAN', drive%ratio, findings)
      call group%get_real('DDAMP', drive%damping, findings)
      call group%get_real('DEXTRA', drive%extra, findings)
      call group%get_real('DRIPPL', drive%ripple, findings)
      offsets = 1
      call read_flag(group, 'DOFFS', offsets, findings)
      drive%offsets = offsets == 1
      call group%get_integer('NDHARM', drive%harmonics, findings)
      call check_range(group, 'NDHARM', drive%harmonics, 0, most_harmonics, findings)
      call group%get_real('DSPLOW', drive%slowest, findings)
      call group%get_real('DSPHGH', drive%fastest, findings)
      call group%get_integer('NDSPED', drive%speeds, findings)
      call check_range(group, 'NDSPED', drive%speeds, 0, most_speeds, findings)
      call group%get_integer('NDPNT', drive%points, findings)
      call check_range(group, 'NDPNT', drive%points, fewest_points, most_points, findings)
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
      if (drive%damping < 0.0_wp) call out_of(group, 'DDAMP', 'must not be negative', findings)
      if (drive%extra < 0.0_wp) call out_of(group, 'DEXTRA', 'must not be negative', findings)
      if (drive%ripple < 0.0_wp .or. drive%ripple >= 1.0_wp) call out_of(group, 'DRIPPL', 'must lie between 0 and 1', findings)
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
      n = 0
      call group%get_integer('NHILL', n, findings)
      group%count_missing = .not. group%given('NHILL')
      if (hill%given) call check_range(group, 'NHILL', n, 1, most_points, findings, must_be=.true.)
      n = min(max(n, 0), most_points)
      allocate (hill%c1(n), hill%c0(n), hill%p(n), source=0.0_wp)
      call group%get_reals('HC1', hill%c1, findings, last=last(1))
      call group%get_reals('HC0', hill%c0, findings, last=last(2))
      call group%get_reals('HP', hill%p, findings, last=last(3))
      call group%get_real('HTOL', hill%tolerance, findings)
      if (.not. hill%tolerance >= finest) call out_of(group, 'HTOL', 'must be at least 1E-14', findings)
      call group%get_integer('NHHARM', hill%harmonics, findings)
      call check_range(group, 'NHHARM', hill%harmonics, 0, most_harmonics, findings)
      if (.not. hill%given) return
      call check_table('HC1', last(1))
      call check_table('HC0', last(2))
      call check_table('HP', last(3))

   contains

      subroutine check_table(item, last)
         character(*), intent(in) :: item
         integer, intent(in) :: last

         if (group%given(item) .and. last < n .and. .not. group%count_missing) then
            call out_of(group, item, to_text(n)//' values are announced by NHILL, but only '//to_text(last)//' given', findings)
         end if
      end subroutine check_table
   end subroutine read_hill_group

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
