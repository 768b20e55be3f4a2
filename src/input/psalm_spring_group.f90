!> The group SPRING: springs and dampers between two points of two links, and torsional ones between two links.
module psalm_spring_group
   use psalm_group, only: group_t, check_range
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places, refuse_unless
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: spring_items
   public :: spring_group_t, read_spring_group

   type :: spring_group_t
      logical :: given = .false.                  !! the group was given
      type(place_t), allocatable :: first(:), second(:) !! shape (entries): where the ends are held
      logical, allocatable :: torsional(:)        !! shape (entries)
      real(wp), allocatable :: stiffness(:)       !! shape (entries): N/m, N m/rad
      real(wp), allocatable :: free(:)            !! shape (entries): free length, user's length; torsional: angle from the first
                                                  !! arc to the second, degrees, at which it is free
      real(wp), allocatable :: preload(:)         !! shape (entries): N or N m at the free length or angle, positive: pulls
      real(wp), allocatable :: damping(:)         !! shape (entries): N s/m, N m s/rad
      real(wp), allocatable :: drag(:)            !! shape (entries): N s2/m2, N m s2/rad2
      integer, allocatable :: side(:)             !! shape (entries): 1 pulls only, -1 pushes only, 0 both
      real(wp), allocatable :: power(:)           !! shape (entries): exponent of a gas spring, 0: none
      real(wp), allocatable :: closed(:)          !! shape (entries): its length without room, user's length
      integer, allocatable :: table(:)            !! shape (entries): table of its pull, 0: none
      real(wp), allocatable :: table_length(:)    !! shape (rows): lengths of the tables, user's, ascending
      real(wp), allocatable :: table_pull(:, :)   !! shape (rows, tables): N
      integer :: added = 0                        !! SADDED: so many of the last entries were found by muscle
   end type spring_group_t

   !> The items of the group.
   type(rule_t), parameter :: spring_items(*) = [ &
      rule_t('NSPRNG', a_whole, '', '', 'as many as the longest item has', '[0,100000]', &
             'number of springs and dampers'), &
      rule_t('ALINK', a_whole, 'NSPRNG', '', 'required', '', &
             'an arc of the link that holds one end, as in &MASSES; an arc of the frame holds it on the frame'), &
      rule_t('ALOOP', a_whole, 'NSPRNG', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('ANAME', a_text, 'NSPRNG', '', '', '', &
             'of a sketch, in place of both: the link, and the joint the place is counted from'), &
      rule_t('ADIST', a_number, 'NSPRNG', 'length', '0', '', &
             'distance from that end of the arc'), &
      rule_t('AANG', a_number, 'NSPRNG', 'degrees', '0', '', &
             'angle from the arc''s direction'), &
      rule_t('BLINK', a_whole, 'NSPRNG', '', 'required', '', &
             'an arc of the link that holds the other end'), &
      rule_t('BLOOP', a_whole, 'NSPRNG', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('BNAME', a_text, 'NSPRNG', '', '', '', &
             'of a sketch, in place of both: the link, and the joint the place is counted from'), &
      rule_t('BDIST', a_number, 'NSPRNG', 'length', '0', '', &
             'distance from that end of the arc'), &
      rule_t('BANG', a_number, 'NSPRNG', 'degrees', '0', '', &
             'angle from the arc''s direction'), &
      rule_t('STORS', a_whole, 'NSPRNG', '', '0', '0 1', &
             '1: torsional, between the two links', &
             '0 (along its length) or 1 (torsional) is expected'), &
      rule_t('STIFF', a_number, 'NSPRNG', 'N/m, N m/rad', '0', '', &
             'stiffness'), &
      rule_t('SFREE', a_number, 'NSPRNG', 'length, degrees', '0', '', &
             'free length; torsional: angle from arc ALINK to arc BLINK at which it is free (within half a turn '// &
             'of it)'), &
      rule_t('SPRE', a_number, 'NSPRNG', 'N, N m', '0', '', &
             'pull at the free length; torsional: moment'), &
      rule_t('SDAMP', a_number, 'NSPRNG', 'N s/m, N m s/rad', '0', '[0,)', &
             'damping', &
             'damping is not negative'), &
      rule_t('SQUAD', a_number, 'NSPRNG', 'N s2/m2, N m s2/rad2', '0', '[0,)', &
             'damping that grows with the square of the speed', &
             'damping is not negative'), &
      rule_t('SSIDE', a_whole, 'NSPRNG', '', '0', '-1 0 1', &
             '1: pulls only, slack below SFREE (a cord); -1: pushes only, free beyond SFREE (a buffer); with its damping it '// &
             'never acts the other way', &
             '-1 (pushes only), 0 or 1 (pulls only) is expected'), &
      rule_t('SGAS', a_number, 'NSPRNG', '', '0', '[0,10]', &
             'gas spring: the pull SPRE (negative: it pushes) at SFREE is multiplied by ((SFREE - SGASP)/(length - SGASP)) to '// &
             'the power SGAS; 0: none', &
             'the exponent of a gas spring lies between 0 (none) and 10'), &
      rule_t('SGASP', a_number, 'NSPRNG', 'length', '0', '[0,)', &
             'length of a gas spring without room for the gas', &
             'a length is not negative'), &
      rule_t('SLTAB', a_whole, 'NSPRNG', '', '0', '', &
             'number of the table of its pull over its length, which is added; 0: none'), &
      rule_t('NSTAB', a_whole, '', '', 'as many as STABF has', '[0,1000]', &
             'number of tables'), &
      rule_t('NSTABL', a_whole, '', '', 'as many as STABL has', '[0,100000]', &
             'number of lengths in each table'), &
      rule_t('STABL', a_number, 'NSTABL', 'length', '', '', &
             'lengths of the tables, ascending; beyond them the end values hold'), &
      rule_t('STABF', a_number, 'NSTAB*NSTABL', 'N', '', '', &
             'pulls, table by table: NSTABL for each, on straight lines between'), &
      rule_t('SADDED', a_whole, '', '', '0', '[0,NSPRNG]', &
             'so many of the last entries were added by `muscle`; `balm` shows drive and frame force without '// &
             'them too')]

contains

   !> Read the group. Errors: arcs that are not there, negative lengths and damping.
   subroutine read_spring_group(group, ilink, sketch, springs, findings)
      use psalm_value_tables, only: table_items_t, read_value_tables
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(spring_group_t), intent(inout) :: springs
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: kind(:)
      integer :: n

      springs%given = group%line > 0
      call group%follow(spring_items)
      call take_count(group, 'NSPRNG', n, findings)
      allocate (springs%first(n), springs%second(n), kind(n))
      allocate (springs%stiffness(n), springs%free(n), springs%preload(n), springs%damping(n))
      call read_places(group, 'A', ilink, springs%first, findings, sketch=sketch)
      call read_places(group, 'B', ilink, springs%second, findings, sketch=sketch)
      call take(group, 'STORS', kind, findings)
      call take(group, 'STIFF', springs%stiffness, findings)
      call take(group, 'SFREE', springs%free, findings)
      call take(group, 'SPRE', springs%preload, findings)
      call take(group, 'SDAMP', springs%damping, findings)
      springs%torsional = kind == 1
      call doubt_place('ADIST', springs%first%distance)
      call doubt_place('BDIST', springs%second%distance)
      allocate (springs%drag(n), springs%side(n), springs%power(n), springs%closed(n), springs%table(n))
      call take(group, 'SQUAD', springs%drag, findings)
      call take(group, 'SSIDE', springs%side, findings)
      call take(group, 'SGAS', springs%power, findings)
      call take(group, 'SGASP', springs%closed, findings)
      call read_value_tables(group, table_items_t('NSTAB', 'NSTABL', 'STABL', 'STABF', 'lengths'), springs%table_length, &
                             springs%table_pull, findings)
      call take(group, 'SLTAB', springs%table, findings)
      call refuse_unless(springs%table >= 0 .and. springs%table <= size(springs%table_pull, 2), group, 'SLTAB', &
                         'there are tables 1 to '//to_text(size(springs%table_pull, 2))//' (0: none)', findings)
      where (springs%table < 0 .or. springs%table > size(springs%table_pull, 2)) springs%table = 0
      call refuse_unless(springs%table == 0 .or. .not. springs%torsional, group, 'SLTAB', &
                         'a table is over the length; a torsional spring has none', findings)
      associate (gas => springs%power > 0.0_wp)
         call refuse_unless(.not. gas .or. .not. springs%torsional, group, 'SGAS', 'a gas spring has a length; a torsional '// &
                            'spring has none', findings)
         call refuse_unless(.not. gas .or. .not. abs(springs%stiffness) > 0.0_wp, group, 'STIFF', 'the pull of a gas spring '// &
                            'follows from SPRE and SGAS; leave its STIFF out', findings)
         call refuse_unless(.not. gas .or. springs%closed < springs%free, group, 'SGASP', 'must be below SFREE, the length '// &
                            'at which the gas spring has the force SPRE', findings)
         call refuse_unless(.not. gas .or. abs(springs%preload) > 0.0_wp, group, 'SPRE', 'a gas spring needs its force at '// &
                            'SFREE (negative: it pushes)', findings)
         call refuse_unless(gas .or. .not. springs%closed > 0.0_wp, group, 'SGASP', 'is for a gas spring; give its exponent '// &
                            'SGAS', findings)
      end associate
      call refuse_unless(springs%free >= 0.0_wp .or. springs%torsional, group, 'SFREE', 'a free length is not negative', findings)
      call take(group, 'SADDED', springs%added, findings)
      call check_range(group, 'SADDED', springs%added, 0, n, findings)

   contains

      !> A torsional spring turns two links wherever it is mounted.
      subroutine doubt_place(item, distances)
         character(*), intent(in) :: item
         real(wp), intent(in) :: distances(:)
         integer :: k

         k = findloc(springs%torsional .and. abs(distances) > 0.0_wp, .true., dim=1)
         if (k > 0) call findings%warning('entry '//to_text(k)//': a torsional spring turns its links wherever it is mounted; '// &
                                          'the distance has no effect', line=group%item_line(item), group='SPRING', item=item)
      end subroutine doubt_place
   end subroutine read_spring_group
end module psalm_spring_group
