!> Tables on device 9, which plotting programs read: blocks two blank lines apart (gnuplot's `index`), comment begins with `#`, one
!> row a line; what is not known is `NaN` among numbers and `none` among words.
module psalm_table_plot
   use psalm_columns, only: in_words
   use psalm_tables, only: column_t, table_t, for_programs, kind_short, kind_word
   use psalm_table_field, only: add_number
   use psalm_text, only: text_t
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
            call add_field(table%columns(c), k, text)
         end do
         call text%add()
      end do
   end subroutine write_plot_block

   pure subroutine add_field(column, row, text)
      type(column_t), intent(in) :: column
      integer, intent(in) :: row
      type(text_t), intent(inout) :: text
      character(:), allocatable :: word
      integer :: i

      if (.not. column%known(row)) then
         if (column%kind == kind_word) then
            call text%add_text('none')
         else
            call text%add_text('NaN')
         end if
      else if (column%kind == kind_word) then
         word = trim(column%words(row))
         do i = 1, len(word)
            if (word(i:i) == ' ') word(i:i) = '-'
         end do
         call text%add_text(word)
      else if (column%kind == kind_short) then
         call text%add_text(in_words(column%values(row), 'E'))
      else
         call add_number(column, row, text)
      end if
   end subroutine add_field
end module psalm_table_plot
