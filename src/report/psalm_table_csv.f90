!> Tables as CSV (RFC 4180 but for the line feeds): a row of names, then the rows; nothing stands for what is not known.
module psalm_table_csv
   use psalm_tables, only: column_t, table_t, kind_word
   use psalm_table_field, only: add_number
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: write_csv

contains

   !> Append a table.
   pure subroutine write_csv(table, text)
      type(table_t), intent(in) :: table
      type(text_t), intent(inout) :: text
      integer :: c, k

      do c = 1, table%count
         if (c > 1) call text%add_text(',')
         call text%add_text(quoted(table%columns(c)%name))
      end do
      call text%add()
      do k = 1, table%rows
         do c = 1, table%count
            if (c > 1) call text%add_text(',')
            if (table%columns(c)%known(k)) call add_field(table%columns(c), k, text)
         end do
         call text%add()
      end do
   end subroutine write_csv

   pure subroutine add_field(column, row, text)
      type(column_t), intent(in) :: column
      integer, intent(in) :: row
      type(text_t), intent(inout) :: text

      if (column%kind == kind_word) then
         call text%add_text(quoted(trim(column%words(row))))
      else
         call add_number(column, row, text)
      end if
   end subroutine add_field

   !> A text as CSV has it.
   pure function quoted(written) result(text)
      character(*), intent(in) :: written
      character(:), allocatable :: text
      integer :: i

      text = written
      if (scan(written, ',"'//new_line('a')) == 0) return
      text = '"'
      do i = 1, len(written)
         if (written(i:i) == '"') text = text//'"'
         text = text//written(i:i)
      end do
      text = text//'"'
   end function quoted
end module psalm_table_csv
