!> The group LOADS: forces and moments that act on links, constant, turning with the link, or by a table over the input.
module psalm_load_group
   use psalm_group, only: group_t, check_range, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: place_t, read_places, read_count, refuse_unless
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: load_group_t, read_load_group

   integer, parameter :: most_tables = 1000, most_rows = 100000 !! above these a number is taken for a slip of the pen

   type :: load_group_t
      logical :: given = .false.                  !! the group was given
      type(place_t), allocatable :: places(:)     !! shape (entries): where they act
      real(wp), allocatable :: force(:, :)        !! shape (2, entries): N, machine axes or along and across the arc
      real(wp), allocatable :: moment(:)          !! shape (entries): N m
      logical, allocatable :: turns(:)            !! shape (entries): the force turns with the link
      integer, allocatable :: table(:)            !! shape (entries): the table it is multiplied by, 0: none
      real(wp), allocatable :: input(:)           !! shape (rows): inputs of the tables, degrees or length, ascending
      real(wp), allocatable :: factor(:, :)       !! shape (rows, tables)
   end type load_group_t

contains

   !> Read the group. Errors: arcs and tables that are not there, inputs of the tables that do not ascend.
   subroutine read_load_group(group, ilink, sketch, loads, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(load_group_t), intent(inout) :: loads
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: turning(:)
      integer :: n

      loads%given = group%line > 0
      call read_count(group, 'NLOAD', n, findings)
      allocate (loads%places(n), loads%turns(n))
      allocate (loads%force(2, n), loads%moment(n), source=0.0_wp)
      allocate (loads%table(n), turning(n), source=0)
      call read_places(group, 'L', ilink, loads%places, findings, sketch=sketch)
      call group%get_reals('LFX', loads%force(1, :), findings)
      call group%get_reals('LFY', loads%force(2, :), findings)
      call group%get_reals('LMOM', loads%moment, findings)
      call group%get_integers('LTURN', turning, findings)
      call refuse_unless(turning == 0 .or. turning == 1, group, 'LTURN', &
                         '0 (machine axes) or 1 (turning with the arc) is expected', findings)
      loads%turns = turning == 1
      call read_tables(group, loads, findings)
      call group%get_integers('LTABLE', loads%table, findings)
      call refuse_unless(loads%table >= 0 .and. loads%table <= size(loads%factor, 2), group, 'LTABLE', &
                         'there are tables 1 to '//to_text(size(loads%factor, 2))//' (0: none)', findings)
      where (loads%table < 0 .or. loads%table > size(loads%factor, 2)) loads%table = 0
   end subroutine read_load_group

   !> Tables over the input: NTABLE of them, each with NTABIN factors at the inputs TABIN.
   subroutine read_tables(group, loads, findings)
      type(group_t), intent(inout) :: group
      type(load_group_t), intent(inout) :: loads
      type(diagnostics_t), intent(inout) :: findings
      integer :: tables, rows, last_input, last_factor
      real(wp), allocatable :: factors(:)

      tables = 0
      rows = 0
      call group%get_integer('NTABLE', tables, findings)
      call group%get_integer('NTABIN', rows, findings)
      call check_range(group, 'NTABLE', tables, 0, most_tables, findings)
      call check_range(group, 'NTABIN', rows, merge(2, 0, tables > 0), most_rows, findings)
      tables = min(max(tables, 0), most_tables)
      rows = min(max(rows, 0), most_rows)
      allocate (loads%input(rows), factors(rows*tables), source=0.0_wp)
      call group%get_reals('TABIN', loads%input, findings, last=last_input)
      call group%get_reals('TABVAL', factors, findings, max(rows, 1), last=last_factor)
      loads%factor = reshape(factors, [rows, tables])
      if (tables == 0 .or. rows < 2) return
      if (last_input < rows) call out_of(group, 'TABIN', 'NTABIN='//to_text(rows)//' inputs are announced, but only '// &
                                         to_text(last_input)//' values given', findings)
      if (last_factor < rows*tables) call out_of(group, 'TABVAL', to_text(tables)//' tables of '//to_text(rows)// &
                                                 ' values are announced, but only '//to_text(last_factor)//' values given', &
                                                 findings)
      if (last_input == rows) call refuse_unless([.true., loads%input(2:) > loads%input(:rows - 1)], group, 'TABIN', &
                                                 'inputs of the tables must ascend', findings)
   end subroutine read_tables
end module psalm_load_group
