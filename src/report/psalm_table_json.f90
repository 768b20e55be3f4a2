!> Tables as JSON: one object a file, `include/psalm_results.schema.json` says what is in it.
module psalm_table_json
   use psalm_json, only: json_number, json_text, comma
   use psalm_tables, only: column_t, table_t, tables_t, for_plots, kind_real, kind_short, kind_word
   use psalm_table_field, only: add_number
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: write_json

contains

   !> Append cases as one object: `program`, `version`, `run`, and `cases`, each with its `title` and, under `blocks`, its tables by
   !> their names: `about`, `units` and `columns`, every column by its name.
   pure subroutine write_json(cases, program, version, run, text)
      type(tables_t), intent(in) :: cases(:)
      character(*), intent(in) :: program, version, run
      type(text_t), intent(inout) :: text
      integer :: i, b, blocks

      call text%add('{"program":'//json_text(program)//',"version":'//json_text(version)//',"run":'//json_text(trim(run))// &
                    ',"cases":[')
      do i = 1, size(cases)
         call text%add_text('{"title":'//json_text(trim(cases(i)%title))//',"blocks":{')
         blocks = 0
         do b = 1, cases(i)%count
            associate (table => cases(i)%tables(b))
               if (table%audience == for_plots) cycle
               blocks = blocks + 1
               call text%add(comma(blocks))
               call write_table(table, text)
            end associate
         end do
         call text%add('}}'//trim(merge(',', ' ', i < size(cases))))
      end do
      call text%add(']}')
   end subroutine write_json

   pure subroutine write_table(table, text)
      type(table_t), intent(in) :: table
      type(text_t), intent(inout) :: text
      integer :: c, k

      call text%add_text(json_text(table%block)//':{"about":'//json_text(table%about)//',"units":{')
      do c = 1, table%count
         call text%add_text(comma(c)//json_text(table%columns(c)%name)//':'//json_text(table%columns(c)%unit))
      end do
      call text%add('},"columns":{')
      do c = 1, table%count
         call text%add_text(json_text(table%columns(c)%name)//':[')
         do k = 1, table%rows
            if (k > 1) call text%add_text(',')
            call add_field(table%columns(c), k, text)
         end do
         call text%add(']'//trim(merge(',', ' ', c < table%count)))
      end do
      call text%add_text('}}')
   end subroutine write_table

   pure subroutine add_field(column, row, text)
      type(column_t), intent(in) :: column
      integer, intent(in) :: row
      type(text_t), intent(inout) :: text

      if (.not. column%known(row)) then
         call text%add_text('null')
         return
      end if
      select case (column%kind)
      case (kind_word)
         call text%add_text(json_text(trim(column%words(row))))
      case (kind_real, kind_short)
         call text%add_text(json_number(column%values(row), exact=.true.))
      case default
         call add_number(column, row, text)
      end select
   end subroutine add_field
end module psalm_table_json
