!> Results as tables: named columns with units, a row for each position, linkage, mode or whatever the table is about.
!>
!> Studies' results become tables once; device 9, CSV and JSON are writers of them (`psalm_table_plot`, `psalm_table_csv`,
!> `psalm_table_json`), and other programs get them through the library. How the columns of common quantities are called, and
!> which of them have another name on device 9, says `psalm_column_names`.
module psalm_tables
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: column_t, table_t, tables_t, table_of, tables_of
   public :: kind_real, kind_short, kind_whole, kind_flag, kind_word, for_all, for_plots, for_programs

   integer, parameter :: kind_real = 1   !! a number of 17 digits
   integer, parameter :: kind_short = 2  !! a number of which device 9 shows 7 digits
   integer, parameter :: kind_whole = 3  !! an integer
   integer, parameter :: kind_flag = 4   !! 1 or 0
   integer, parameter :: kind_word = 5   !! a word

   integer, parameter :: for_all = 1      !! device 9 and other programs have it
   integer, parameter :: for_plots = 2    !! device 9 alone: an extract of another table, laid out as it always was
   integer, parameter :: for_programs = 3 !! CSV, JSON and library alone: device 9 has extracts of it

   integer, parameter :: first_columns = 16 !! that a table has room for when it is made
   integer, parameter :: first_tables = 4   !! the same of tables

   type :: column_t
      character(:), allocatable :: name
      character(:), allocatable :: unit     !! `deg`, `length`, `N m` ...; empty: a pure number, a word or a flag
      character(:), allocatable :: plotted  !! its name on device 9
      integer :: kind = kind_real
      real(wp), allocatable :: values(:)    !! shape (rows); of words not allocated
      logical, allocatable :: known(:)      !! shape (rows); for what is not known device 9 has `NaN`, of words `none`, CSV
                                            !! nothing, JSON `null`
      character(:), allocatable :: words(:) !! shape (rows); of words alone
   end type column_t

   type :: table_t
      character(:), allocatable :: block    !! its name
      character(:), allocatable :: about    !! a sentence: what a row is
      character(:), allocatable :: aside    !! device 9: behind the names of the columns
      character(:), allocatable :: notes    !! device 9: lines of comment below them, a line feed between two
      logical :: named = .true.             !! device 9 says how the block is called
      logical :: main = .false.             !! the table that a case is about: its CSV file is called by the case alone
      integer :: audience = for_all
      integer :: rows = 0
      integer :: count = 0                      !! columns
      type(column_t), allocatable :: columns(:) !! the first `count` are there
   contains
      generic :: add => add_numbers, add_integers, add_flags, add_words
      procedure, private :: add_numbers, add_integers, add_flags, add_words
   end type table_t

   !> The tables of a case.
   type :: tables_t
      character(:), allocatable :: title
      logical :: in_file = .false.            !! its main table goes into a CSV file without being asked for
      integer :: count = 0                    !! tables
      type(table_t), allocatable :: tables(:) !! the first `count` are there
   contains
      procedure :: put, hand_over
   end type tables_t

contains

   !> A table without columns.
   pure function table_of(block, about, aside, notes, named, audience, main) result(table)
      character(*), intent(in) :: block, about
      character(*), intent(in), optional :: aside, notes
      logical, intent(in), optional :: named       !! default: true
      logical, intent(in), optional :: main        !! default: false
      integer, intent(in), optional :: audience    !! default: `for_all`
      type(table_t) :: table

      table%block = block
      table%about = about
      table%aside = ''
      if (present(aside)) table%aside = aside
      table%notes = ''
      if (present(notes)) table%notes = notes
      if (present(named)) table%named = named
      if (present(main)) table%main = main
      if (present(audience)) table%audience = audience
      allocate (table%columns(first_columns))
   end function table_of

   !> A case without tables.
   pure function tables_of(title, in_file) result(tables)
      character(*), intent(in) :: title
      logical, intent(in), optional :: in_file  !! default: false
      type(tables_t) :: tables

      tables%title = title
      if (present(in_file)) tables%in_file = in_file
      allocate (tables%tables(first_tables))
   end function tables_of

   !> A column of numbers. All columns of a table have the same number of rows; huge values count as not known.
   pure subroutine add_numbers(self, name, values, unit, known, plotted, short)
      class(table_t), intent(inout) :: self
      character(*), intent(in) :: name
      real(wp), intent(in) :: values(:)            !! shape (rows)
      character(*), intent(in), optional :: unit   !! default: none
      logical, intent(in), optional :: known(:)    !! shape (rows); default: all
      character(*), intent(in), optional :: plotted !! its name on device 9; default: the same
      logical, intent(in), optional :: short       !! seven digits do on device 9

      call begin_column(self, name, size(values), unit, known, plotted)
      associate (column => self%columns(self%count))
         column%values = values
         column%known = column%known .and. abs(values) < huge(1.0_wp)
         if (present(short)) column%kind = merge(kind_short, kind_real, short)
      end associate
   end subroutine add_numbers

   !> A column of integers.
   pure subroutine add_integers(self, name, values, unit, known, plotted)
      class(table_t), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(in) :: values(:)             !! shape (rows)
      character(*), intent(in), optional :: unit
      logical, intent(in), optional :: known(:)    !! shape (rows); default: all
      character(*), intent(in), optional :: plotted

      call begin_column(self, name, size(values), unit, known, plotted)
      self%columns(self%count)%values = real(values, wp)
      self%columns(self%count)%kind = kind_whole
   end subroutine add_integers

   !> A column of ones and zeros.
   pure subroutine add_flags(self, name, values, known, plotted)
      class(table_t), intent(inout) :: self
      character(*), intent(in) :: name
      logical, intent(in) :: values(:)             !! shape (rows)
      logical, intent(in), optional :: known(:)    !! shape (rows); default: all
      character(*), intent(in), optional :: plotted

      call begin_column(self, name, size(values), known=known, plotted=plotted)
      self%columns(self%count)%values = merge(1.0_wp, 0.0_wp, values)
      self%columns(self%count)%kind = kind_flag
   end subroutine add_flags

   !> A column of words.
   pure subroutine add_words(self, name, values, known, plotted)
      class(table_t), intent(inout) :: self
      character(*), intent(in) :: name
      character(*), intent(in) :: values(:)        !! shape (rows)
      logical, intent(in), optional :: known(:)    !! shape (rows); default: all
      character(*), intent(in), optional :: plotted

      call begin_column(self, name, size(values), known=known, plotted=plotted)
      self%columns(self%count)%words = values
      self%columns(self%count)%kind = kind_word
   end subroutine add_words

   !> A column more, at the end: everything but its values.
   pure subroutine begin_column(table, name, rows, unit, known, plotted)
      type(table_t), intent(inout) :: table
      character(*), intent(in) :: name
      integer, intent(in) :: rows
      character(*), intent(in), optional :: unit, plotted
      logical, intent(in), optional :: known(:)
      type(column_t), allocatable :: more(:)
      integer :: i

      table%count = table%count + 1
      table%rows = rows
      if (table%count > size(table%columns)) then
         allocate (more(2*size(table%columns)))
         do i = 1, size(table%columns)
            call move_column(table%columns(i), more(i))
         end do
         call move_alloc(more, table%columns)
      end if
      associate (column => table%columns(table%count))
         column%name = name
         column%unit = ''
         if (present(unit)) column%unit = unit
         column%plotted = name
         if (present(plotted)) column%plotted = plotted
         allocate (column%known(rows), source=.true.)
         if (present(known)) column%known = known
      end associate
   end subroutine begin_column

   !> A table more, after the others; what was given is empty then.
   pure subroutine put(self, table)
      class(tables_t), intent(inout) :: self
      type(table_t), intent(inout) :: table
      type(table_t), allocatable :: more(:)
      integer :: i

      if (self%count == size(self%tables)) then
         allocate (more(2*self%count))
         do i = 1, self%count
            call move_table(self%tables(i), more(i))
         end do
         call move_alloc(more, self%tables)
      end if
      self%count = self%count + 1
      call move_table(table, self%tables(self%count))
   end subroutine put

   !> All tables to another owner; what gave them has none and takes none then.
   pure subroutine hand_over(self, to)
      class(tables_t), intent(inout) :: self
      type(tables_t), intent(out) :: to

      call move_alloc(self%title, to%title)
      to%in_file = self%in_file
      to%count = self%count
      call move_alloc(self%tables, to%tables)
      self%count = 0
   end subroutine hand_over

   pure subroutine move_table(from, to)
      type(table_t), intent(inout) :: from
      type(table_t), intent(inout) :: to

      call move_alloc(from%block, to%block)
      call move_alloc(from%about, to%about)
      call move_alloc(from%aside, to%aside)
      call move_alloc(from%notes, to%notes)
      call move_alloc(from%columns, to%columns)
      to%named = from%named
      to%main = from%main
      to%audience = from%audience
      to%rows = from%rows
      to%count = from%count
   end subroutine move_table

   pure subroutine move_column(from, to)
      type(column_t), intent(inout) :: from
      type(column_t), intent(inout) :: to

      call move_alloc(from%name, to%name)
      call move_alloc(from%unit, to%unit)
      call move_alloc(from%plotted, to%plotted)
      call move_alloc(from%values, to%values)
      call move_alloc(from%known, to%known)
      call move_alloc(from%words, to%words)
      to%kind = from%kind
   end subroutine move_column
end module psalm_tables
