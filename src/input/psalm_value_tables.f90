!> Tables of values over ascending numbers, all over the same: items of LOADS and SPRING.
module psalm_value_tables
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: refuse_unless
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: table_items_t, read_value_tables

   integer, parameter :: fewest_rows = 2          !! of a table

   !> The items that tables are given by, and what they are over.
   type :: table_items_t
      character(:), allocatable :: tables, rows   !! how many tables, how many values in each
      character(:), allocatable :: over, values
      character(:), allocatable :: what           !! what `over` are, in the plural
   end type table_items_t

contains

   !> Errors: a table of one row, fewer numbers than announced, numbers that do not ascend.
   subroutine read_value_tables(group, items, over, values, findings)
      type(group_t), intent(inout) :: group
      type(table_items_t), intent(in) :: items
      real(wp), allocatable, intent(out) :: over(:)      !! shape (rows)
      real(wp), allocatable, intent(out) :: values(:, :) !! shape (rows, tables)
      type(diagnostics_t), intent(inout) :: findings
      integer :: tables, rows, last_over, last_value
      real(wp), allocatable :: all_values(:)

      call take_count(group, items%tables, tables, findings)
      call take_count(group, items%rows, rows, findings)
      if (tables > 0 .and. rows < fewest_rows) call out_of(group, items%rows, 'a table has 2 '//items%what//' or more; found '// &
                                                           to_text(rows), findings)
      allocate (over(rows), all_values(rows*tables), source=0.0_wp)
      call group%get_reals(items%over, over, findings, last=last_over)
      call group%get_reals(items%values, all_values, findings, max(rows, 1), last=last_value)
      values = reshape(all_values, [rows, tables])
      if (tables == 0 .or. rows < fewest_rows) return
      if (last_over < rows) call out_of(group, items%over, items%rows//'='//to_text(rows)//' '//items%what// &
                                        ' are announced, but only '//to_text(last_over)//' values given', findings)
      if (last_value < rows*tables) call out_of(group, items%values, to_text(tables)//' tables of '//to_text(rows)// &
                                                ' values are announced, but only '//to_text(last_value)//' values given', findings)
      if (last_over == rows) call refuse_unless([.true., over(2:) > over(:rows - 1)], group, items%over, items%what// &
                                                ' of the tables must ascend', findings)
   end subroutine read_value_tables
end module psalm_value_tables
