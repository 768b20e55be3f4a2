!> What the devices of the programs receive, in memory.
module psalm_devices
   use psalm_data_set, only: data_set_t
   use psalm_mark, only: mark_width
   use psalm_ranking_list, only: ranking_entry_t
   use psalm_status, only: diagnostics_t, exit_done, exit_violation
   use psalm_tables, only: tables_t, tables_of, for_plots
   use psalm_table_plot, only: write_plot_block
   use psalm_text, only: text_t
   use psalm_version, only: version
   implicit none (type, external)
   private
   public :: devices_t, drawing_t, header_of, most_reported

   integer, parameter :: most_reported = 5 !! messages of one kind on standard error; the listing has all

   !> A file beside the devices that belongs to one case.
   type :: drawing_t
      character(:), allocatable :: ending, content
   end type drawing_t

   !> Texts of the devices. Cases of one file follow each other.
   type :: devices_t
      type(text_t) :: one     !! progress, random integers, violations
      type(text_t) :: two     !! limits of the initial simplex, generated coordinates
      type(text_t) :: six     !! results
      integer :: published = 0 !! length of `six` up to the end of what the published listing has of the last case
      type(text_t) :: seven   !! vertices and data set
      type(text_t) :: eight   !! annotated input, intermediate arrays, all arcs
      type(tables_t), allocatable :: cases(:) !! results as tables: device 9 and, for other programs, CSV and JSON; those up to
                                         !! `last_case` are there
      integer, private :: begun = 0      !! cases
      type(drawing_t), allocatable :: drawings(:) !! of the cases, by `add_drawing`
      type(ranking_entry_t), allocatable :: ranking(:) !! linkages of the cases so far that are ranked together; not allocated: none
      type(text_t) :: shares  !! of the starts, of those of them that share these
      type(diagnostics_t) :: remarks     !! on the results, for standard error
      type(text_t) :: summary !! what the linkage does, for standard error
      integer :: summarised = 0          !! cases met by the summary
      character(:), allocatable :: next  !! a sensible next step, for the end of the run; not allocated: none
      integer :: code = exit_done        !! exit status so far
      character(mark_width) :: mark = '' !! of the run; blank: none
   contains
      procedure :: begin_case
      procedure :: last_case
      procedure :: nine
      procedure :: has_tables
      procedure :: remark
      procedure :: detail
      procedure :: note_violation
      procedure :: add_drawing
      procedure :: suggest
   end type devices_t

contains

   !> First line of device 8.
   pure function header_of(program, mark) result(line)
      character(*), intent(in) :: program      !! its name in capitals
      character(*), intent(in) :: mark         !! of the run; blank: none
      character(:), allocatable :: line

      line = ' *** '//program//', VERSION '//version//' ***'
      if (len_trim(mark) > 0) line = line//' RUN '//mark
   end function header_of

   !> A further case, without tables: the last of `cases`.
   pure subroutine begin_case(self, title, in_file)
      class(devices_t), intent(inout) :: self
      character(*), intent(in) :: title
      logical, intent(in) :: in_file     !! its main table goes into a CSV file without being asked for
      type(tables_t), allocatable :: more(:)
      integer :: i, n

      if (.not. allocated(self%cases)) allocate (self%cases(1))
      n = size(self%cases)
      if (self%begun == n) then
         allocate (more(2*n))
         do i = 1, n
            call self%cases(i)%hand_over(more(i))
         end do
         call move_alloc(more, self%cases)
      end if
      self%begun = self%begun + 1
      self%cases(self%begun) = tables_of(title, in_file)
   end subroutine begin_case

   !> Index of the case that is reported on.
   pure integer function last_case(self)
      class(devices_t), intent(in) :: self

      last_case = self%begun
   end function last_case

   !> Device 9: plotting data.
   pure function nine(self) result(content)
      class(devices_t), intent(in) :: self
      character(:), allocatable :: content
      type(text_t) :: text
      integer :: i, k

      content = ''
      do i = 1, self%begun
         do k = 1, self%cases(i)%count
            call write_plot_block(self%cases(i)%tables(k), text)
         end do
      end do
      content = text%content()
   end function nine

   !> True if there are tables for other programs.
   pure logical function has_tables(self)
      class(devices_t), intent(in) :: self
      integer :: i

      has_tables = .false.
      do i = 1, self%begun
         if (any(self%cases(i)%tables(:self%cases(i)%count)%audience /= for_plots)) has_tables = .true.
      end do
   end function has_tables

   !> A remark on a case, with its file and title.
   subroutine remark(self, set, text, part)
      class(devices_t), intent(inout) :: self
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: text
      character(*), intent(in), optional :: part     !! of the case that it is about

      self%remarks%file = set%file
      if (present(part)) then
         call self%remarks%remark(trim(set%title)//', '//part//': '//text)
      else
         call self%remarks%remark(trim(set%title)//': '//text)
      end if
   end subroutine remark

   !> A further line to a remark, with the name of the file.
   subroutine detail(self, set, text)
      class(devices_t), intent(inout) :: self
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: text

      self%remarks%file = set%file
      call self%remarks%remark('  '//text)
   end subroutine detail

   !> A further file.
   pure subroutine add_drawing(self, ending, content)
      class(devices_t), intent(inout) :: self
      character(*), intent(in) :: ending, content
      type(drawing_t), allocatable :: more(:)
      integer :: i, n

      n = 1
      if (allocated(self%drawings)) n = size(self%drawings) + 1
      allocate (more(n))
      do i = 1, n - 1     ! moved: a constructor of the whole list keeps memory that nobody frees (gfortran 12)
         call move_alloc(self%drawings(i)%ending, more(i)%ending)
         call move_alloc(self%drawings(i)%content, more(i)%content)
      end do
      more(n)%ending = ending
      more(n)%content = content
      call move_alloc(more, self%drawings)
   end subroutine add_drawing

   !> A next step; the first that is not empty stays.
   pure subroutine suggest(self, words)
      class(devices_t), intent(inout) :: self
      character(*), intent(in) :: words

      if (len(words) > 0 .and. .not. allocated(self%next)) self%next = words
   end subroutine suggest

   !> Done, but a constraint is violated or a search stopped early.
   pure subroutine note_violation(self)
      class(devices_t), intent(inout) :: self

      self%code = max(self%code, exit_violation)
   end subroutine note_violation
end module psalm_devices
