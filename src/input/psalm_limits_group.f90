!> The group LIMITS: limits of angles and variables, and what is listed.
!> Source of items and defaults: Oldham (1977), appendix B.
module psalm_limits_group
   use psalm_group, only: group_t
   use psalm_kinds, only: wp
   use psalm_rule, only: rule_t, a_flag, a_number, a_whole
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   implicit none (type, external)
   private
   public :: limit_items
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

   !> The items of the group.
   type(rule_t), parameter :: limit_items(*) = [ &
      rule_t('TANGLE', a_number, '', 'degrees', '50; analysis of a sketch: 90', '(0,90]', &
             'allowed deviation of the transmission angle of a link pair from 90 degrees; 90: closure only. '// &
             'Where it is given it holds for the angle between the two slides of a dyad of type 8 too; else the '// &
             'slides only must not become parallel', &
             'must lie between 0 and 90 degrees'), &
      rule_t('TRMIN', a_number, '', 'degrees', '', '[0,90)', &
             'the same limit as the least transmission angle itself, degrees: TRMIN=40 is TANGLE=50; see '// &
             '[below](#tangle-and-trmin)', &
             'is the least transmission angle: at least 0, less than 90 degrees'), &
      rule_t('TOGGLE', a_number, '', 'length', '0.1', '[0,)', &
             'length that the link of a dyad of type 4 or 5, or the distance over the guide of type 2 or 3, '// &
             'must have to spare at every position; less of it is a violation, in an analysis too. Where it is '// &
             'not given, only repairs and the searches of &SEARCH leave so much'), &
      rule_t('LIMVAL', a_flag, '', '', '0', '', &
             '1: every variable has bounds, OPLOW and OPHIGH'), &
      rule_t('OPLOW', a_number, 'n', '', '0', '', &
             'lower bounds, in the order of the listing (lengths row by row, ILKOUT, IORIG distance, angles, '// &
             'INGOUT, IORIG angle, ICRK)'), &
      rule_t('OPHIGH', a_number, 'n', '', '0', '', &
             'upper bounds, in the same order'), &
      rule_t('STEPIN', a_number, '', '', '0.001', '[0,)', &
             'a value out of bounds is put this far inside'), &
      rule_t('KTHETA', a_flag, '', '', '0', '', &
             '1: length and angle of every arc at every position on device 8; solves every loop'), &
      rule_t('ICOND', a_flag, '', '', '0', '', &
             '1: device 9 gets a column with the condition number of each position (KTHETA lists it too); in listings of '// &
             'sketches decimals of outputs that rounding makes uncertain are blank'), &
      rule_t('IPROOF', a_whole, '', '', '2 after a search, else 0', '[0,2]', &
             '1: prove where the linkage closes over a full turn (a sliding input: over the range of the '// &
             'inputs), 2: over the range of the inputs, 0: prove nothing; where it is not given, IRANGE=1 '// &
             'of &CONSTR means 2 and IRANGE=2 means 1; see '// &
             '[below](#the-motion-between-the-positions-proven)'), &
      rule_t('DWELL', a_number, '', '', '0', '[0,)', &
             'with a proof: amount that the output may move in a dwell, degrees or length'), &
      rule_t('IPLOT', a_flag, '', '', '0', '', &
             '1: analyse every degree (a sliding input: 361 even steps) and add it to device 9'), &
      rule_t('NVIOL', a_whole, '', '', '30', '[0,)', &
             'device 1: number of violations in an iteration above which they are reported'), &
      rule_t('NPRINT', a_whole, '', '', '100', '[1,)', &
             'device 1: coordinates of the simplex every so many iterations'), &
      rule_t('NPRT', a_whole, '', '', '20', '[1,)', &
             'device 1: objectives every so many iterations'), &
      rule_t('LAST', a_flag, '', '', '1', '', &
             '0: another case follows in the file')]

contains

   !> Read the group. Errors: numbers out of range.
   subroutine read_limits_group(group, nloop, maxarc, limits, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: nloop, maxarc     !! of &LINKS
      type(limits_group_t), intent(inout) :: limits
      type(diagnostics_t), intent(inout) :: findings
      integer :: capacity

      call group%follow(limit_items)
      call take(group, 'TANGLE', limits%tangle, findings)
      limits%tangle_given = group%given('TANGLE')
      call take(group, 'TOGGLE', limits%toggle, findings)
      limits%toggle_given = group%given('TOGGLE')
      call take(group, 'LIMVAL', limits%limval, findings)
      capacity = 2*nloop*maxarc + 5
      allocate (limits%oplow(capacity), limits%ophigh(capacity), source=0.0_wp)
      call group%get_reals('OPLOW', limits%oplow, findings, filler=.true., last=limits%low_given)
      call group%get_reals('OPHIGH', limits%ophigh, findings, filler=.true., last=limits%high_given)
      call take(group, 'STEPIN', limits%stepin, findings)
      call take(group, 'KTHETA', limits%ktheta, findings)
      call take(group, 'ICOND', limits%icond, findings)
      call take(group, 'IPROOF', limits%iproof, findings)
      call take(group, 'DWELL', limits%dwell, findings)
      call take(group, 'NVIOL', limits%nviol, findings)
      call take(group, 'NPRINT', limits%nprint, findings)
      call take(group, 'NPRT', limits%nprt, findings)
      call take(group, 'IPLOT', limits%iplot, findings)
      call take(group, 'LAST', limits%last, findings)
   end subroutine read_limits_group
end module psalm_limits_group
