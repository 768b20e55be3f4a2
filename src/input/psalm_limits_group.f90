!> The group LIMITS: limits of angles and variables, and what is listed.
!> Source of items and defaults: Oldham (1977), appendix B.
module psalm_limits_group
   use psalm_group, only: group_t, read_flag, check_range, out_of
   use psalm_kinds, only: wp
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: limits_group_t, read_limits_group, proof_by_default

   integer, parameter :: proof_by_default = -1 !! IPROOF was not given: the result of a search is proven

   !> Limits, steps and lists. Angles in degrees, lengths in the user's one unit.
   type :: limits_group_t
      real(wp) :: tangle = 50.0_wp, toggle = 0.1_wp
      logical :: tangle_given = .false.                !! a limit was given: it holds for the angle between two slides too
      logical :: toggle_given = .false.                !! then it is a criterion, else a distance that repairs leave
      logical :: trmin_given = .false.                 !! as the least transmission angle: TANGLE is 90 less TRMIN
      integer :: limval = 0
      real(wp), allocatable :: oplow(:), ophigh(:) !! shape (values given, at least the number of variables)
      integer :: low_given = 0, high_given = 0     !! values given in OPLOW and in OPHIGH
      real(wp) :: stepin = 0.001_wp
      integer :: ktheta = 0
      integer :: icond = 0                         !! condition number of every position on device 9
      integer :: iproof = proof_by_default         !! prove the motion: 1 over a full turn, 2 over the range of the inputs, 0 not
      real(wp) :: dwell = 0.0_wp                   !! amount that the output may move in a dwell, degrees or length; 0: none
      integer :: nviol = 30
      integer :: nprint = 100, nprt = 20
      integer :: iplot = 0
      integer :: last = 1
   end type limits_group_t

contains

   !> Read the group. Errors: numbers out of range.
   subroutine read_limits_group(group, nloop, maxarc, limits, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: nloop, maxarc     !! of &LINKS
      type(limits_group_t), intent(inout) :: limits
      type(diagnostics_t), intent(inout) :: findings
      integer :: room

      call group%get_real('TANGLE', limits%tangle, findings)
      limits%tangle_given = group%given('TANGLE')
      if (limits%tangle <= 0.0_wp .or. limits%tangle > 90.0_wp) then
         call out_of(group, 'TANGLE', 'must lie between 0 and 90 degrees', findings)
      end if
      call group%get_real('TOGGLE', limits%toggle, findings)
      limits%toggle_given = group%given('TOGGLE')
      if (limits%toggle < 0.0_wp) call out_of(group, 'TOGGLE', 'must not be negative', findings)
      call read_flag(group, 'LIMVAL', limits%limval, findings)
      room = 2*nloop*maxarc + 5
      allocate (limits%oplow(room), limits%ophigh(room), source=0.0_wp)
      call group%get_reals('OPLOW', limits%oplow, findings, filler=.true., last=limits%low_given)
      call group%get_reals('OPHIGH', limits%ophigh, findings, filler=.true., last=limits%high_given)
      call group%get_real('STEPIN', limits%stepin, findings)
      if (limits%stepin < 0.0_wp) call out_of(group, 'STEPIN', 'must not be negative', findings)
      call read_flag(group, 'KTHETA', limits%ktheta, findings)
      call read_flag(group, 'ICOND', limits%icond, findings)
      call group%get_integer('IPROOF', limits%iproof, findings)
      if (group%given('IPROOF')) call check_range(group, 'IPROOF', limits%iproof, 0, 2, findings)
      call group%get_real('DWELL', limits%dwell, findings)
      if (limits%dwell < 0.0_wp) call out_of(group, 'DWELL', 'must not be negative', findings)
      call group%get_integer('NVIOL', limits%nviol, findings)
      call check_range(group, 'NVIOL', limits%nviol, 0, huge(1), findings)
      call group%get_integer('NPRINT', limits%nprint, findings)
      call check_range(group, 'NPRINT', limits%nprint, 1, huge(1), findings)
      call group%get_integer('NPRT', limits%nprt, findings)
      call check_range(group, 'NPRT', limits%nprt, 1, huge(1), findings)
      call read_flag(group, 'IPLOT', limits%iplot, findings)
      call read_flag(group, 'LAST', limits%last, findings)
   end subroutine read_limits_group
end module psalm_limits_group
