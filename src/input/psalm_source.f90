!> A text file, or standard input, as lines in memory.
!>
!> A line ends with a line feed, a carriage return or both; a byte order mark is dropped; a last line without line end is a line
!> like any other. Knows nothing of what the lines mean.
module psalm_source
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_status, only: diagnostics_t
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: line_t, joined, read_lines, split_lines

   !> One line, without its end.
   type :: line_t
      character(:), allocatable :: text
   end type line_t

   integer(int64), parameter :: bytes_of_line = 64_int64 !! its descriptor and what the C library adds to it
   integer, parameter :: megabyte = 1024*1024
   integer, parameter :: largest_file = 32*megabyte    !! bytes; a million positions have 20 MB
   integer, parameter :: longest_line = 4*megabyte     !! bytes
   character, parameter :: line_feed = achar(10), carriage_return = achar(13)
   character(*), parameter :: byte_order_mark = char(239)//char(187)//char(191)

contains

   !> Read all lines of a file.
   !>
   !> Errors, in `findings`: a file that is missing, a directory, not readable or larger than 32 MB (exit status 3); one that is
   !> no text or has a line longer than 4 MB (2).
   subroutine read_lines(file, lines, findings, largest)
      use psalm_system, only: read_input, error_text, input_directory, input_has_zero, input_valid, input_too_large, &
                              memory_to_be_had
      character(*), intent(in) :: file                      !! name; `-` is standard input
      type(line_t), allocatable, intent(out) :: lines(:)    !! the lines; none after an error
      type(diagnostics_t), intent(inout) :: findings
      integer, intent(in), optional :: largest              !! MB of the file; default 32
      character(:), allocatable :: text
      integer :: verdict, error, most, k

      most = largest_file
      if (present(largest)) most = largest*megabyte
      call read_input(file, most, text, verdict, error)
      allocate (lines(0))
      select case (verdict)
      case (input_valid)
         if (index(text, byte_order_mark) == 1) text = text(len(byte_order_mark) + 1:)
         if (.not. memory_to_be_had(len(text, int64) + bytes_of_line*int(lines_in(text), int64))) then
            call findings%failure("not enough memory to read '"//file//"'")
            return
         end if
         call split_lines(text, lines)
         do k = 1, size(lines)
            if (len(lines(k)%text) <= longest_line) cycle
            call findings%error('the line is longer than '//to_text(longest_line/megabyte)//' MB; break it where a blank or a '// &
                                'comma is', line=k)
            deallocate (lines)
            allocate (lines(0))
            return
         end do
      case (input_has_zero)
         call split_lines(text(:index(text, achar(0))), lines)
         call findings%error('a zero byte: this is no plain text; save it as text in UTF-8', line=size(lines))
         deallocate (lines)
         allocate (lines(0))
      case (input_directory)
         call findings%failure("cannot read '"//file//"': it is a directory")
      case (input_too_large)
         call findings%failure("cannot read '"//file//"': it is larger than "//to_text(most/megabyte)// &
                               ' MB, the most that is taken; split its cases over several files')
      case default
         call findings%failure("cannot open '"//file//"'"//error_text(error))
      end select
   end subroutine read_lines

   !> The lines of a text in memory.
   pure subroutine split_lines(text, lines)
      character(*), intent(in) :: text
      type(line_t), allocatable, intent(out) :: lines(:)
      integer :: count, i, first, last

      allocate (lines(lines_in(text)))
      first = 1
      do count = 1, size(lines)
         call find_end(text, first, last, i)
         lines(count)%text = text(first:last)
         first = i
      end do
   end subroutine split_lines

   pure integer function lines_in(text) result(count)
      character(*), intent(in) :: text
      integer :: first, last, next

      count = 0
      first = 1
      do while (first <= len(text))
         call find_end(text, first, last, next)
         count = count + 1
         first = next
      end do
   end function lines_in

   !> Where a line ends and the next begins.
   pure subroutine find_end(text, first, last, next)
      character(*), intent(in) :: text
      integer, intent(in) :: first             !! place where the line begins
      integer, intent(out) :: last, next       !! of the line without its end; of the next line

      last = first - 1
      do while (last < len(text))
         if (text(last + 1:last + 1) == line_feed .or. text(last + 1:last + 1) == carriage_return) exit
         last = last + 1
      end do
      next = last + 2
      if (last + 2 > len(text)) return
      if (text(last + 1:last + 2) == carriage_return//line_feed) next = last + 3
   end subroutine find_end

   !> Lines as one text.
   pure function joined(lines) result(whole)
      type(line_t), intent(in) :: lines(:)
      character(:), allocatable :: whole
      type(text_t) :: text
      integer :: k

      do k = 1, size(lines)
         call text%add(lines(k)%text)
      end do
      whole = text%content()
   end function joined
end module psalm_source
