!> The interface for C: what a study gave.
module psalm_capi_results
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_loc, c_null_ptr, c_ptr
   use psalm, only: column_named, table_t, table_kind_flag, table_kind_whole, table_kind_word, wp
   use psalm_capi_handles, only: done, misuse, handle_t, result_handle_t, text_of, new_handle, handed_out, hand_over, &
                                 put_reals, result_of
   implicit none (type, external)
   private
   public :: psalm_result_free, psalm_table_count, psalm_table_name, psalm_table_about, psalm_find_table, psalm_row_count
   public :: psalm_column_count, psalm_column_name, psalm_column_unit, psalm_column_kind, psalm_find_column, psalm_column
   public :: psalm_columns, psalm_word, psalm_listing, psalm_found_text, psalm_case_count, psalm_case_of, psalm_file_count
   public :: psalm_file_ending, psalm_file_content

   ! kinds of columns, as in psalm.h
   integer(c_int), parameter :: column_real = 0, column_whole = 1, column_flag = 2, column_word = 3
   character(*), parameter :: tab = achar(9)

contains

   subroutine psalm_result_free(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      own => result_of(handle)
      if (associated(own)) deallocate (own)
   end subroutine psalm_result_free

   integer(c_int) function psalm_table_count(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      psalm_table_count = 0
      own => result_of(handle)
      if (associated(own)) psalm_table_count = size(own%tables, kind=c_int)
   end function psalm_table_count

   !> A table of a result, and a column of it; not associated if there is none.
   subroutine look_up(handle, table, own, found, column)
      type(c_ptr), intent(in) :: handle
      integer(c_int), intent(in) :: table
      type(result_handle_t), pointer, intent(out) :: own
      type(table_t), pointer, intent(out) :: found
      integer(c_int), intent(in), optional :: column

      found => null()
      own => result_of(handle)
      if (.not. associated(own)) return
      if (table < 1 .or. table > size(own%tables)) return
      found => own%report%tables%tables(own%tables(table))
      if (.not. present(column)) return
      if (column < 1 .or. column > found%count) found => null()
   end subroutine look_up

   type(c_ptr) function psalm_table_name(handle, table) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_table_name = c_null_ptr
      call look_up(handle, table, own, found)
      if (associated(found)) psalm_table_name = handed_out(found%block, own%reported)
   end function psalm_table_name

   type(c_ptr) function psalm_table_about(handle, table) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_table_about = c_null_ptr
      call look_up(handle, table, own, found)
      if (associated(found)) psalm_table_about = handed_out(found%about, own%reported)
   end function psalm_table_about

   !> Number of the table of that name; 0: there is none.
   integer(c_int) function psalm_find_table(handle, name) bind(C)
      type(c_ptr), value, intent(in) :: handle, name
      type(result_handle_t), pointer :: own
      character(:), allocatable :: wanted
      integer :: place

      psalm_find_table = 0
      own => result_of(handle)
      if (.not. (associated(own) .and. c_associated(name))) return
      wanted = text_of(name)
      place = own%report%find(wanted)
      if (place > 0) psalm_find_table = int(findloc(own%tables, place, dim=1), c_int)
   end function psalm_find_table

   integer(c_int) function psalm_row_count(handle, table) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_row_count = 0
      call look_up(handle, table, own, found)
      if (associated(found)) psalm_row_count = int(found%rows, c_int)
   end function psalm_row_count

   integer(c_int) function psalm_column_count(handle, table) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_column_count = 0
      call look_up(handle, table, own, found)
      if (associated(found)) psalm_column_count = int(found%count, c_int)
   end function psalm_column_count

   type(c_ptr) function psalm_column_name(handle, table, column) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table, column
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_column_name = c_null_ptr
      call look_up(handle, table, own, found, column)
      if (associated(found)) psalm_column_name = handed_out(found%columns(column)%name, own%reported)
   end function psalm_column_name

   type(c_ptr) function psalm_column_unit(handle, table, column) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table, column
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_column_unit = c_null_ptr
      call look_up(handle, table, own, found, column)
      if (associated(found)) psalm_column_unit = handed_out(found%columns(column)%unit, own%reported)
   end function psalm_column_unit

   !> One of PSALM_REAL, PSALM_WHOLE, PSALM_FLAG, PSALM_WORD; -1 if there is no such column.
   integer(c_int) function psalm_column_kind(handle, table, column) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table, column
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_column_kind = -1
      call look_up(handle, table, own, found, column)
      if (associated(found)) psalm_column_kind = kind_of(found%columns(column)%kind)
   end function psalm_column_kind

   !> The number that psalm.h has for a kind of columns.
   pure integer(c_int) function kind_of(kind)
      integer, intent(in) :: kind

      select case (kind)
      case (table_kind_whole)
         kind_of = column_whole
      case (table_kind_flag)
         kind_of = column_flag
      case (table_kind_word)
         kind_of = column_word
      case default
         kind_of = column_real
      end select
   end function kind_of

   !> Kind, unit and name of every column, a line for each: a caller that reads many columns asks once.
   type(c_ptr) function psalm_columns(handle, table) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found
      character(:), allocatable :: lines
      integer :: c, at

      psalm_columns = c_null_ptr
      call look_up(handle, table, own, found)
      if (.not. associated(found)) return
      at = 0
      do c = 1, found%count
         at = at + 4 + len(found%columns(c)%unit) + len(found%columns(c)%name)
      end do
      allocate (character(at) :: lines)
      at = 0
      do c = 1, found%count
         associate (kind => found%columns(c)%kind, unit => found%columns(c)%unit, name => found%columns(c)%name)
            lines(at + 1:at + 2) = achar(iachar('0') + int(kind_of(kind)))//tab
            lines(at + 3:at + 2 + len(unit)) = unit
            at = at + 3 + len(unit)
            lines(at:at) = tab
            lines(at + 1:at + len(name)) = name
            at = at + len(name) + 1
            lines(at:at) = new_line('a')
         end associate
      end do
      psalm_columns = handed_out(lines, own%reported)
   end function psalm_columns

   !> Number of the column of that name; 0: there is none.
   integer(c_int) function psalm_find_column(handle, table, name) bind(C)
      type(c_ptr), value, intent(in) :: handle, name
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found
      character(:), allocatable :: wanted

      psalm_find_column = 0
      call look_up(handle, table, own, found)
      if (.not. (associated(found) .and. c_associated(name))) return
      wanted = text_of(name)
      psalm_find_column = int(column_named(found, wanted), c_int)
   end function psalm_find_column

   !> Copy the numbers of a column; NaN for what is not known.
   integer(c_int) function psalm_column(handle, table, column, count, values) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table, column, count
      type(c_ptr), value, intent(in) :: values
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_column = misuse
      call look_up(handle, table, own, found, column)
      if (.not. associated(found)) return
      if (count /= found%rows .or. found%columns(column)%kind == table_kind_word) return
      if (count > 0) then
         if (.not. c_associated(values)) return
         associate (one => found%columns(column))
            call put_reals(merge(one%values, ieee_value(1.0_wp, ieee_quiet_nan), one%known), values)
         end associate
      end if
      psalm_column = done
   end function psalm_column

   !> One word of a column of words; empty for what is not known.
   type(c_ptr) function psalm_word(handle, table, column, row) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table, column, row
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_word = c_null_ptr
      call look_up(handle, table, own, found, column)
      if (.not. associated(found)) return
      if (row < 1 .or. row > found%rows .or. found%columns(column)%kind /= table_kind_word) return
      if (found%columns(column)%known(row)) then
         psalm_word = handed_out(trim(found%columns(column)%words(row)), own%reported)
      else
         psalm_word = handed_out('', own%reported)
      end if
   end function psalm_word

   type(c_ptr) function psalm_listing(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      psalm_listing = c_null_ptr
      own => result_of(handle)
      if (associated(own)) psalm_listing = c_loc(own%listing%letters)
   end function psalm_listing

   type(c_ptr) function psalm_found_text(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      psalm_found_text = c_null_ptr
      own => result_of(handle)
      if (associated(own)) psalm_found_text = c_loc(own%data_set%letters)
   end function psalm_found_text

   integer(c_int) function psalm_case_count(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      psalm_case_count = 0
      own => result_of(handle)
      if (associated(own)) psalm_case_count = size(own%report%cases, kind=c_int)
   end function psalm_case_count

   integer(c_int) function psalm_case_of(handle, number, made) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: number
      type(c_ptr), value, intent(in) :: made
      type(result_handle_t), pointer :: own
      type(handle_t), pointer :: found

      psalm_case_of = misuse
      if (.not. c_associated(made)) return
      call hand_over(made, c_null_ptr)
      own => result_of(handle)
      if (.not. associated(own)) return
      if (number < 1 .or. number > size(own%report%cases)) return
      found => new_handle()
      found%case = own%report%cases(number)
      call hand_over(made, c_loc(found))
      psalm_case_of = done
   end function psalm_case_of

   integer(c_int) function psalm_file_count(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      psalm_file_count = 0
      own => result_of(handle)
      if (associated(own)) psalm_file_count = size(own%files, kind=c_int)
   end function psalm_file_count

   type(c_ptr) function psalm_file_ending(handle, number) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: number
      type(result_handle_t), pointer :: own

      psalm_file_ending = c_null_ptr
      own => result_of(handle)
      if (.not. associated(own)) return
      if (number < 1 .or. number > size(own%files)) return
      psalm_file_ending = handed_out(own%report%files(number)%ending, own%reported)
   end function psalm_file_ending

   type(c_ptr) function psalm_file_content(handle, number) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: number
      type(result_handle_t), pointer :: own

      psalm_file_content = c_null_ptr
      own => result_of(handle)
      if (.not. associated(own)) return
      if (number < 1 .or. number > size(own%files)) return
      psalm_file_content = c_loc(own%files(number)%letters)
   end function psalm_file_content
end module psalm_capi_results
