!> The group LOADS: forces and moments that act on links, constant, turning with the link, or by a table over the input.
module psalm_load_group
   use psalm_group, only: group_t
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places, refuse_unless
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_flag, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: load_items
   public :: load_group_t, read_load_group

   type :: load_group_t
      logical :: given = .false.                  !! the group was given
      type(place_t), allocatable :: places(:)     !! shape (entries): where they act
      real(wp), allocatable :: force(:, :)        !! shape (2, entries): N, machine axes or along and across the arc
      real(wp), allocatable :: moment(:)          !! shape (entries): N m
      logical, allocatable :: turns(:)            !! shape (entries): the force turns with the link
      integer, allocatable :: table(:)            !! shape (entries): the table it is multiplied by, 0: none
      real(wp), allocatable :: input(:)           !! shape (rows): inputs of the tables, degrees or length, ascending
      logical :: timed = .false.                  !! or times, s
      real(wp), allocatable :: factor(:, :)       !! shape (rows, tables)
   end type load_group_t

   !> The items of the group.
   type(rule_t), parameter :: load_items(*) = [ &
      rule_t('NLOAD', a_whole, '', '', 'as many as the longest item has', '[0,100000]', &
             'number of loads'), &
      rule_t('LLINK', a_whole, 'NLOAD', '', 'required', '', &
             'an arc of the link where each acts, as in &MASSES'), &
      rule_t('LLOOP', a_whole, 'NLOAD', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('LNAME', a_text, 'NLOAD', '', '', '', &
             'of a sketch, in place of both: the link, and the joint the place is counted from'), &
      rule_t('LDIST', a_number, 'NLOAD', 'length', '0', '', &
             'distance from that end'), &
      rule_t('LANG', a_number, 'NLOAD', 'degrees', '0', '', &
             'angle from the arc''s direction'), &
      rule_t('LFX', a_number, 'NLOAD', 'N', '0', '', &
             'force along the machine''s x axis; with LTURN=1 along the arc, turning with it'), &
      rule_t('LFY', a_number, 'NLOAD', 'N', '0', '', &
             'force along the machine''s y axis; with LTURN=1 across the arc'), &
      rule_t('LMOM', a_number, 'NLOAD', 'N m', '0', '', &
             'moment'), &
      rule_t('LTURN', a_whole, 'NLOAD', '', '0', '0 1', &
             '1: the force turns with the link', &
             '0 (machine axes) or 1 (turning with the arc) is expected'), &
      rule_t('LTABLE', a_whole, 'NLOAD', '', '0', '', &
             'number of the table that force and moment are multiplied by; 0: none'), &
      rule_t('NTABLE', a_whole, '', '', 'as many as TABVAL has', '[0,1000]', &
             'number of tables'), &
      rule_t('NTABIN', a_whole, '', '', 'as many as TABIN has', '[0,100000]', &
             'number of inputs in each table'), &
      rule_t('TABIN', a_number, 'NTABIN', '', '', '', &
             'inputs of the tables, ascending: crank angles in degrees, or lengths; of a sketch counted from the drawing; '// &
             'with LTIME=1 times in s'), &
      rule_t('LTIME', a_flag, '', '', '0', '0 1', &
             '1: the tables are over the time of &TIME (at positions they are those of time 0); beyond their ends they '// &
             'keep the end values'), &
      rule_t('TABVAL', a_number, 'NTABLE*NTABIN', '', '', '', &
             'factors, table by table: NTABIN for each. Between two inputs the factor is on the straight line; '// &
             'a table over the crank goes round the turn, one over a length keeps its end values')]

contains

   !> Read the group. Errors: arcs and tables that are not there, inputs of the tables that do not ascend.
   subroutine read_load_group(group, ilink, sketch, loads, findings)
      use psalm_value_tables, only: table_items_t, read_value_tables
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(load_group_t), intent(inout) :: loads
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: turning(:)
      integer :: n

      loads%given = group%line > 0
      call group%follow(load_items)
      call take_count(group, 'NLOAD', n, findings)
      allocate (loads%places(n), loads%turns(n), loads%force(2, n), loads%moment(n), loads%table(n), turning(n))
      call read_places(group, 'L', ilink, loads%places, findings, sketch=sketch)
      call take(group, 'LFX', loads%force(1, :), findings)
      call take(group, 'LFY', loads%force(2, :), findings)
      call take(group, 'LMOM', loads%moment, findings)
      call take(group, 'LTURN', turning, findings)
      loads%turns = turning == 1
      call take(group, 'LTIME', loads%timed, findings)
      call read_value_tables(group, table_items_t('NTABLE', 'NTABIN', 'TABIN', 'TABVAL', 'inputs'), loads%input, loads%factor, &
                             findings)
      call take(group, 'LTABLE', loads%table, findings)
      call refuse_unless(loads%table >= 0 .and. loads%table <= size(loads%factor, 2), group, 'LTABLE', &
                         'there are tables 1 to '//to_text(size(loads%factor, 2))//' (0: none)', findings)
      where (loads%table < 0 .or. loads%table > size(loads%factor, 2)) loads%table = 0
   end subroutine read_load_group
end module psalm_load_group
