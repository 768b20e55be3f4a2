!> A number of a table as all its writers have it.
module psalm_table_field
   use psalm_kinds, only: wp
   use psalm_tables, only: column_t, kind_flag, kind_whole
   use psalm_text, only: text_t, full_precision, to_text
   implicit none (type, external)
   private
   public :: add_number

contains

   !> Append a known value of a column without words: 17 digits, an integer, or a flag.
   pure subroutine add_number(column, row, text)
      type(column_t), intent(in) :: column
      integer, intent(in) :: row
      type(text_t), intent(inout) :: text

      select case (column%kind)
      case (kind_flag)
         call text%add_text(merge('1', '0', column%values(row) > 0.0_wp))
      case (kind_whole)
         call text%add_text(to_text(nint(column%values(row))))
      case default
         call text%add_text(full_precision(column%values(row)))
      end select
   end subroutine add_number
end module psalm_table_field
