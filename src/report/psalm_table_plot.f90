!> Tables on device 9, which plotting programs read: blocks two blank lines apart (gnuplot's `index`), comment begins with `#`, one
!> row a line, `NaN` for what is not known.
module psalm_table_plot
   use psalm_tables, only: column_t, table_t, for_programs, kind_short, kind_word
   use psalm_table_field, only: number_field
   use psalm_text, only: text_t, general
   implicit none (type, external)
   private
   public :: write_plot_block

contains

   !> Append a table, unless it is for other programs alone. A block without a name begins with the names of its columns, where
   !> programs that plot look for them.
   pure subroutine write_plot_block(table, text)
      type(table_t), intent(in) :: table
      type(text_t), intent(inout) :: text
      integer :: c, k, first, last

      if (table%audience == for_programs) return
      if (text%length > 0) then
         call text%add()
         call text%add()
      end if
      if (table%named) call text%add('# block '//table%block)
      call text%add_text('#')
      do c = 1, table%count
         call text%add_text(' '//table%columns(c)%plotted)
      end do
      call text%add(table%aside)
      first = 1
      do while (first <= len(table%notes))
         last = index(table%notes(first:)//new_line('a'), new_line('a')) + first - 2
         call text%add('# '//table%notes(first:last))
         first = last + 2
      end do
      do k = 1, table%rows
         do c = 1, table%count
            if (c > 1) call text%add_text(' ')
            call text%add_text(field(table%columns(c), k))
         end do
         call text%add()
      end do
   end subroutine write_plot_block

   pure function field(column, row) result(text)
      type(column_t), intent(in) :: column
      integer, intent(in) :: row
      character(:), allocatable :: text
      integer :: i

      if (.not. column%known(row)) then
         text = 'NaN'
      else if (column%kind == kind_word) then
         text = trim(column%words(row))
         do i = 1, len(text)
            if (text(i:i) == ' ') text(i:i) = '-'
         end do
      else if (column%kind == kind_short) then
         text = trim(adjustl(general(column%values(row), 'E')))
      else
         text = number_field(column, row)
      end if
   end function field
end module psalm_table_plot
