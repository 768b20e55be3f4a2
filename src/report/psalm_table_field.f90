!> A number of a table as all its writers have it.
module psalm_table_field
   use psalm_kinds, only: wp
   use psalm_tables, only: column_t, kind_flag, kind_whole
   use psalm_text, only: full_precision, to_text
   implicit none (type, external)
   private
   public :: number_field

contains

   !> A known value of a column without words: 17 digits, an integer, or a flag.
   pure function number_field(column, row) result(text)
      type(column_t), intent(in) :: column
      integer, intent(in) :: row
      character(:), allocatable :: text

      select case (column%kind)
      case (kind_flag)
         text = merge('1', '0', column%values(row) > 0.0_wp)
      case (kind_whole)
         text = to_text(nint(column%values(row)))
      case default
         text = full_precision(column%values(row))
      end select
   end function number_field
end module psalm_table_field
