!> A table for other programs: named columns, a row for each position, as CSV and as JSON with the same figures.
module psalm_table
   use psalm_kinds, only: wp
   use psalm_markup, only: json_text
   use psalm_text, only: text_t, full_precision
   implicit none (type, external)
   private
   public :: table_t, table_of, write_csv, write_json

   integer, parameter :: first_room = 16 !! columns that a table has room for when it is made

   type :: column_t
      character(:), allocatable :: name
      logical :: is_flag = .false.          !! 1 or 0
      real(wp), allocatable :: values(:)    !! shape (rows)
      logical, allocatable :: known(:)      !! shape (rows); what is not known is an empty field, in JSON null
   end type column_t

   type :: table_t
      character(:), allocatable :: title
      integer :: count = 0                        !! columns
      type(column_t), allocatable :: columns(:)   !! the first `count` are there
   contains
      procedure :: add
      procedure :: add_flag
   end type table_t

contains

   !> A table without columns.
   pure function table_of(title) result(table)
      character(*), intent(in) :: title
      type(table_t) :: table

      table%title = title
      allocate (table%columns(first_room))
   end function table_of

   !> A column more. All columns of a table have the same number of rows; huge values count as not known.
   pure subroutine add(self, name, values, known)
      class(table_t), intent(inout) :: self
      character(*), intent(in) :: name
      real(wp), intent(in) :: values(:)            !! shape (rows)
      logical, intent(in), optional :: known(:)    !! shape (rows); default: all

      call make_room(self)
      associate (column => self%columns(self%count))
         column%name = name
         column%values = values
         column%known = abs(values) < huge(1.0_wp)
         if (present(known)) column%known = column%known .and. known
      end associate
   end subroutine add

   !> A column of ones and zeros.
   pure subroutine add_flag(self, name, flags)
      class(table_t), intent(inout) :: self
      character(*), intent(in) :: name
      logical, intent(in) :: flags(:)              !! shape (rows)

      call self%add(name, merge(1.0_wp, 0.0_wp, flags))
      self%columns(self%count)%is_flag = .true.
   end subroutine add_flag

   !> One column more, at its end.
   pure subroutine make_room(table)
      type(table_t), intent(inout) :: table
      type(column_t), allocatable :: more(:)
      integer :: i

      table%count = table%count + 1
      if (table%count <= size(table%columns)) return
      allocate (more(2*size(table%columns)))
      do i = 1, size(table%columns)
         more(i)%is_flag = table%columns(i)%is_flag
         call move_alloc(table%columns(i)%name, more(i)%name)
         call move_alloc(table%columns(i)%values, more(i)%values)
         call move_alloc(table%columns(i)%known, more(i)%known)
      end do
      call move_alloc(more, table%columns)
   end subroutine make_room

   !> Append a table as CSV: a row of names, then the rows. Tables are an empty line apart.
   pure subroutine write_csv(table, text)
      type(table_t), intent(in) :: table
      type(text_t), intent(inout) :: text
      integer :: c, k

      if (text%length > 0) call text%add()
      do c = 1, table%count
         if (c > 1) call text%add_text(',')
         call text%add_text(quoted(table%columns(c)%name))
      end do
      call text%add()
      do k = 1, rows_of(table)
         do c = 1, table%count
            if (c > 1) call text%add_text(',')
            if (table%columns(c)%known(k)) call text%add_text(field(table%columns(c), k))
         end do
         call text%add()
      end do
   end subroutine write_csv

   !> Append tables as one JSON object: `program`, `version`, `run`, and `cases`, each with its `title` and, under `columns`, every
   !> column by its name.
   pure subroutine write_json(tables, program, version, run, text)
      type(table_t), intent(in) :: tables(:)
      character(*), intent(in) :: program, version, run
      type(text_t), intent(inout) :: text
      integer :: i, c, k

      call text%add('{"program":'//json_text(program)//',"version":'//json_text(version)//',"run":'//json_text(trim(run))// &
                    ',"cases":[')
      do i = 1, size(tables)
         call text%add('{"title":'//json_text(trim(tables(i)%title))//',"columns":{')
         do c = 1, tables(i)%count
            call text%add_text(json_text(tables(i)%columns(c)%name)//':[')
            do k = 1, rows_of(tables(i))
               if (k > 1) call text%add_text(',')
               if (tables(i)%columns(c)%known(k)) then
                  call text%add_text(field(tables(i)%columns(c), k))
               else
                  call text%add_text('null')
               end if
            end do
            call text%add(trim(merge('],', '] ', c < tables(i)%count)))
         end do
         call text%add(trim(merge('}},', '}} ', i < size(tables))))
      end do
      call text%add(']}')
   end subroutine write_json

   pure integer function rows_of(table) result(rows)
      type(table_t), intent(in) :: table

      rows = 0
      if (table%count > 0) rows = size(table%columns(1)%values)
   end function rows_of

   !> A known value: 17 digits, or a flag.
   pure function field(column, row) result(text)
      type(column_t), intent(in) :: column
      integer, intent(in) :: row
      character(:), allocatable :: text

      if (column%is_flag) then
         text = merge('1', '0', column%values(row) > 0.0_wp)
      else
         text = full_precision(column%values(row))
      end if
   end function field

   !> A name as CSV has it.
   pure function quoted(name) result(text)
      character(*), intent(in) :: name
      character(:), allocatable :: text
      integer :: i

      text = name
      if (scan(name, ',"') == 0) return
      text = '"'
      do i = 1, len(name)
         if (name(i:i) == '"') text = text//'"'
         text = text//name(i:i)
      end do
      text = text//'"'
   end function quoted
end module psalm_table
