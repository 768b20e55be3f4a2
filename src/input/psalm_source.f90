!> A text file, or standard input, as lines in memory.
!>
!> Carriage returns before line ends and a byte order mark are dropped; a last line without line end is a line like any
!> other. Knows nothing of what the lines mean.
module psalm_source
   use, intrinsic :: iso_fortran_env, only: input_unit
   use psalm_status, only: diagnostics_t
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: line_t, read_lines, split_lines

   !> One line, without its end.
   type :: line_t
      character(:), allocatable :: text
   end type line_t

   integer, parameter :: chunk = 4096 !! characters read at a time
   character, parameter :: line_feed = achar(10)

contains

   !> Read all lines of a file.
   !>
   !> Errors: a file that is missing, a directory or not readable is reported in `findings` (exit status 3).
   subroutine read_lines(file, lines, findings)
      character(*), intent(in) :: file                      !! name; `-` is standard input
      type(line_t), allocatable, intent(out) :: lines(:)    !! the lines
      type(diagnostics_t), intent(inout) :: findings
      integer :: unit, status
      character(256) :: message
      logical :: is_directory

      allocate (lines(0))
      if (file == '-') then
         unit = input_unit
      else
         ! the run-time library opens a directory and finds it empty
         inquire (file=file//'/.', exist=is_directory)
         if (is_directory) then
            call findings%trouble("cannot read '"//file//"': it is a directory")
            return
         end if
         message = ''
         open (newunit=unit, file=file, action='read', status='old', form='formatted', iostat=status, iomsg=message)
         if (status /= 0) then
            call findings%trouble("cannot open '"//file//"': "//plain(message))
            return
         end if
      end if
      call read_unit(unit, lines, status, message)
      if (status /= 0) call findings%trouble("cannot read '"//file//"': "//plain(message))
      if (file /= '-') close (unit)
   end subroutine read_lines

   !> The lines of a text in memory. Carriage returns before line ends are dropped.
   pure subroutine split_lines(text, lines)
      character(*), intent(in) :: text
      type(line_t), allocatable, intent(out) :: lines(:)
      integer :: count, i, first, last

      count = 0
      do i = 1, len(text)
         if (text(i:i) == line_feed) count = count + 1
      end do
      if (len(text) > 0) then
         if (text(len(text):) /= line_feed) count = count + 1
      end if
      allocate (lines(count))
      first = 1
      do i = 1, count
         last = index(text(first:), line_feed) + first - 2
         if (last < first - 1) last = len(text)
         lines(i)%text = text(first:last)
         if (last >= first) then
            if (text(last:last) == achar(13)) lines(i)%text = text(first:last - 1)
         end if
         first = last + 2
      end do
   end subroutine split_lines

   subroutine read_unit(unit, lines, status, message)
      integer, intent(in) :: unit
      type(line_t), allocatable, intent(inout) :: lines(:)
      integer, intent(out) :: status
      character(*), intent(out) :: message
      character(chunk) :: buffer
      type(text_t) :: line
      integer :: got, count

      count = 0
      message = ''
      each_line: do
         line%length = 0
         do
            got = 0
            read (unit, '(a)', advance='no', iostat=status, iomsg=message, size=got) buffer
            call line%add_text(buffer(:got))
            if (status /= 0) exit
         end do
         if (is_iostat_end(status)) then
            if (line%length > 0) call append(line%buffer(:line%length))
            status = 0
            exit each_line
         else if (.not. is_iostat_eor(status)) then
            exit each_line
         end if
         call append(line%buffer(:line%length))
      end do each_line
      call resize(count)

   contains

      subroutine append(text)
         character(*), intent(in) :: text
         integer :: first, last
         character(3), parameter :: byte_order_mark = char(239)//char(187)//char(191)

         if (count == size(lines)) call resize(max(64, 2*count))
         first = 1
         last = len(text)
         if (count == 0 .and. last >= 3) then
            if (text(1:3) == byte_order_mark) first = 4
         end if
         if (last > 0) then
            if (text(last:last) == achar(13)) last = last - 1
         end if
         count = count + 1
         lines(count)%text = text(first:last)
      end subroutine append

      !> Give `lines` another size; the texts are moved, not copied.
      subroutine resize(n)
         integer, intent(in) :: n
         type(line_t), allocatable :: others(:)
         integer :: i

         allocate (others(n))
         do i = 1, count
            call move_alloc(lines(i)%text, others(i)%text)
         end do
         call move_alloc(others, lines)
      end subroutine resize
   end subroutine read_unit

   !> The run-time library's message without the file name it repeats.
   pure function plain(message) result(text)
      character(*), intent(in) :: message
      character(:), allocatable :: text
      integer :: at

      at = index(message, "': ", back=.true.)
      text = trim(message(merge(at + 3, 1, at > 0):))
      if (len(text) == 0) text = 'the system gives no reason'
   end function plain
end module psalm_source
