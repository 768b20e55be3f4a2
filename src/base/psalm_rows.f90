!> Rows of numbers, one number for each position of a block, every row beginning on a cache line.
module psalm_rows
   use, intrinsic :: iso_c_binding, only: c_intptr_t, c_loc
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: rows_t, make_rows, clear_rows

   integer, parameter :: line_bytes = 64    !! of a cache line
   integer, parameter :: line_elements = line_bytes/(storage_size(1.0_wp)/8) !! reals of a cache line
   integer, parameter :: tries = 3          !! allocations before a row may begin where it likes

   !> `v(i, row)` is the value of position i. The first dimension begins below 1, so that element 1 can lie on a cache line.
   type :: rows_t
      real(wp), allocatable :: v(:, :)
   end type rows_t

contains

   !> Allocate `count` rows for `room` positions, filled with zero.
   !>
   !> Where the memory lies is known only afterwards, so further tries may be needed. If they fail nothing is lost but speed.
   subroutine make_rows(capacity, count, rows)
      integer, intent(in) :: capacity, count
      type(rows_t), intent(out) :: rows
      integer :: low, leading, try, gap

      ! a leading dimension of whole cache lines: if one row begins on a line, all do
      leading = line_elements*((capacity + 2*line_elements - 1)/line_elements)
      low = 1
      do try = 1, tries
         if (allocated(rows%v)) deallocate (rows%v)
         allocate (rows%v(low:low + leading - 1, count), source=0.0_wp)
         gap = modulo(elements_to_line(rows%v(low:, 1)) - (1 - low), line_elements)
         if (gap == 0) return
         low = low - gap
         if (low <= 1 - line_elements) low = low + line_elements
      end do
   end subroutine make_rows

   !> Put zero into all rows, in one piece.
   pure subroutine clear_rows(rows)
      type(rows_t), intent(inout) :: rows

      call clear(size(rows%v), rows%v)
   end subroutine clear_rows

   pure subroutine clear(n, values)
      integer, intent(in) :: n
      real(wp), intent(out) :: values(n)

      values = 0.0_wp
   end subroutine clear

   !> Elements from the beginning of an array to the next beginning of a cache line.
   integer function elements_to_line(array)
      real(wp), intent(in), target, contiguous :: array(:)  !! its first element counts
      integer(c_intptr_t) :: address
      integer :: bytes

      address = transfer(c_loc(array), address)
      bytes = int(modulo(-address, int(line_bytes, c_intptr_t)))
      elements_to_line = bytes/(storage_size(1.0_wp)/8)
   end function elements_to_line
end module psalm_rows
