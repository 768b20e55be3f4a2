!> The group METHOD: the positions, what is wanted of the output there, what may vary, how the thesis's search goes.
!> Source of items and defaults: Oldham (1977), appendix B.
module psalm_method_group
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_group, only: group_t, read_flag, check_flags, check_range, out_of, required
   use psalm_kinds, only: wp
   use psalm_links_group, only: original_arcs, most_arcs
   use psalm_output_kind, only: output_kind_t, output_kind, motion_point, motion_pose
   use psalm_rate_items, only: read_rate_items
   use psalm_status, only: diagnostics_t
   use psalm_system, only: memory_to_be_had
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: method_group_t, read_method_group, default_niter, most_positions, bytes_of_position

   integer, parameter :: most_positions = 10000000 !! above this NDES is taken for a slip of the pen
   integer(int64), parameter :: bytes_of_position = 10*storage_size(1.0_wp)/8 !! of a case: seven arrays, and copies on the way
   integer, parameter :: largest_istart = 999999999 !! nine digits
   integer, parameter :: default_niter = 2         !! the thesis's: enough to look at the start of a search

   !> Positions, wishes, variables and the simplex. Angles in degrees, lengths in the user's one unit.
   type :: method_group_t
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
      real(wp), allocatable :: rate_wanted(:, :, :) !! shape (ndes, components, most_rates): derivatives of the output by the
                                           !! input; not allocated: none is wanted
      real(wp), allocatable :: rate_weight(:, :, :) !! the same shape: their weights, 0 where none is wanted
      real(wp) :: origlk = 0.0_wp, origng = 0.0_wp
      real(wp) :: var = 0.1_wp
      integer :: istart = 19
      integer :: nguess = 0
      real(wp) :: bounce = 3.0_wp, expand = 2.0_wp, snake = 0.5_wp, reduce = 0.25_wp, shrink = 0.5_wp
      integer :: niter = default_niter, ncheck = 1
      real(wp) :: fmin = 0.0_wp, small = 0.001_wp
   end type method_group_t

contains

   !> Read the group. Errors: numbers out of range, fewer or more values than NDES.
   subroutine read_method_group(group, nloop, maxarc, shape_known, of_sketch, method, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: nloop, maxarc           !! of &LINKS; 0 if they are not sound
      logical, intent(in) :: shape_known             !! they are
      logical, intent(in) :: of_sketch               !! the linkage is one
      type(method_group_t), intent(inout) :: method  !! MOTION as the outputs of a sketch have it
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: integers(:)
      integer :: n

      n = nloop*maxarc
      allocate (integers(max(n, merge(0, original_arcs, shape_known))), source=0)
      call group%get_integers('IVA', integers, findings, maxarc, filler=.true.)
      method%iva = reshape(integers(:n), [maxarc, nloop])
      integers = 0
      call group%get_integers('IVG', integers, findings, maxarc, filler=.true.)
      method%ivg = reshape(integers(:n), [maxarc, nloop])
      call check_flags(group, 'IVA', method%iva, findings)
      call check_flags(group, 'IVG', method%ivg, findings)
      call read_flag(group, 'ILKOUT', method%ilkout, findings)
      call read_flag(group, 'INGOUT', method%ingout, findings)
      call read_flag(group, 'ICRK', method%icrk, findings)
      call read_flag(group, 'IORIG', method%iorig, findings)
      call read_flag(group, 'IFREE', method%ifree, findings)
      call group%get_integer('IKIN', method%ikin, findings)
      call check_range(group, 'IKIN', method%ikin, -360, 360, findings)
      call group%get_integer('NDES', method%ndes, findings)
      if (group%given('NDES')) then
         call check_range(group, 'NDES', method%ndes, 1, most_positions, findings)
         if (method%ndes < 1 .or. method%ndes > most_positions) method%ndes = 0
         if (.not. memory_to_be_had(bytes_of_position*int(method%ndes, int64))) then
            call findings%trouble('not enough memory for NDES='//to_text(method%ndes)//' positions')
            method%ndes = 0
         end if
      else if (method%ikin == 0) then
         call required(group, 'NDES', 'the number of prescribed positions is required (or IKIN for an analysis through one turn)')
      end if
      call group%get_real('CRNKI', method%crnki, findings)
      call group%get_integer('MOTION', method%motion, findings)
      call check_range(group, 'MOTION', method%motion, motion_point, motion_pose, findings)
      method%motion = min(max(method%motion, motion_point), motion_pose)
      call group%get_real('XADD', method%xadd, findings)
      call group%get_real('YADD', method%yadd, findings)
      call group%get_real('ORIGLK', method%origlk, findings)
      call group%get_real('ORIGNG', method%origng, findings)
      call read_positions(group, of_sketch, method, findings)
      call group%get_real('VAR', method%var, findings)
      if (method%var < 0.0_wp .or. method%var > 1.0_wp) call out_of(group, 'VAR', 'must be from 0.0 to 1.0', findings)
      call group%get_integer('ISTART', method%istart, findings)
      call check_range(group, 'ISTART', method%istart, 1, largest_istart, findings)
      if (method%istart > 0 .and. mod(method%istart, 2) == 0) then
         call group%origins%warning(findings, 'METHOD', 'ISTART', 'the random integer must be odd; '//to_text(method%istart + 1)// &
                                    ' is used', 1)
         method%istart = method%istart + 1
      end if
      call group%get_integer('NGUESS', method%nguess, findings)
      call check_range(group, 'NGUESS', method%nguess, 0, most_arcs, findings)
      call group%get_real('BOUNCE', method%bounce, findings)
      call group%get_real('EXPAND', method%expand, findings)
      call group%get_real('SNAKE', method%snake, findings)
      call group%get_real('REDUCE', method%reduce, findings)
      call group%get_real('SHRINK', method%shrink, findings)
      if (method%bounce <= 1.0_wp) call out_of(group, 'BOUNCE', 'must be above 1 (2 reflects by the full distance)', findings)
      if (method%expand <= 1.0_wp) call out_of(group, 'EXPAND', 'must be above 1', findings)
      if (method%snake < 0.0_wp) call out_of(group, 'SNAKE', 'must not be negative', findings)
      if (method%reduce <= 0.0_wp .or. method%reduce >= 1.0_wp) call out_of(group, 'REDUCE', 'must lie between 0 and 1', findings)
      if (method%shrink <= 0.0_wp .or. method%shrink >= 1.0_wp) call out_of(group, 'SHRINK', 'must lie between 0 and 1', findings)
      call group%get_integer('NITER', method%niter, findings)
      call check_range(group, 'NITER', method%niter, 0, huge(1), findings)
      call group%get_integer('NCHECK', method%ncheck, findings)
      call check_range(group, 'NCHECK', method%ncheck, 1, huge(1), findings)
      call group%get_real('FMIN', method%fmin, findings)
      call group%get_real('SMALL', method%small, findings)
      if (method%small < 0.0_wp) call out_of(group, 'SMALL', 'must not be negative', findings)
   end subroutine read_method_group

   !> Increments, desired values and weights: as many as NDES, and fillers up to the size of the original program's arrays
   !> (`161*0.0`, weights `181*1.0`). With IKIN they are not used, and may be any number.
   subroutine read_positions(group, of_sketch, method, findings)
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
      call read_rate_items(group, method%motion, merge(0, n, method%ikin /= 0), method%rate_wanted, method%rate_weight, findings)
      if (allocated(method%rate_wanted) .and. .not. method%desired) &
         call group%origins%error(findings, 'METHOD', '', 'derivatives are wanted beside values ('// &
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
