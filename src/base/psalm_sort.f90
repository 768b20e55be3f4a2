!> The order of numbers and of names, and numbers put in rising order at the least cost.
module psalm_sort
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: ascending, pool_rising

   !> Places of numbers or names in rising order; equal ones stay in the order they have. Shape of the result: that of the keys.
   interface ascending
      module procedure places_of_numbers, places_of_names
   end interface ascending

contains

   pure function places_of_numbers(numbers) result(order)
      real(wp), intent(in) :: numbers(:)           !! shape (n)
      integer :: order(size(numbers))

      call merge_places(order, numbers=numbers)
   end function places_of_numbers

   pure function places_of_names(names) result(order)
      character(*), intent(in) :: names(:)         !! shape (n)
      integer :: order(size(names))

      call merge_places(order, names=names)
   end function places_of_names

   !> Merge sort by one of the keys.
   pure subroutine merge_places(order, numbers, names)
      integer, intent(out) :: order(:)             !! shape (n)
      real(wp), intent(in), optional :: numbers(:) !! shape (n)
      character(*), intent(in), optional :: names(:) !! shape (n)
      integer, allocatable :: merged(:)            ! large: it would fill a small stack
      integer :: width, left, middle, right, i, j, k, n
      logical :: second

      n = size(order)
      allocate (merged(n))
      order = [(i, i=1, n)]
      width = 1
      do while (width < n)
         do left = 1, n, 2*width
            middle = min(left + width, n + 1)
            right = min(left + 2*width, n + 1)
            i = left
            j = middle
            do k = left, right - 1
               second = j < right
               if (second .and. i < middle) then
                  if (present(numbers)) then
                     second = numbers(order(j)) < numbers(order(i))
                  else
                     second = names(order(j)) < names(order(i))
                  end if
               end if
               if (second) then
                  merged(k) = order(j)
                  j = j + 1
               else
                  merged(k) = order(i)
                  i = i + 1
               end if
            end do
         end do
         order = merged
         width = 2*width
      end do
   end subroutine merge_places

   !> The nearest numbers, in the sense of least squares, that never fall: neighbours that do are pooled, and get their mean.
   !>
   !> Source: Ayer and others (1955).
   pure subroutine pool_rising(level, last, pools)
      real(wp), intent(inout) :: level(:)          !! shape (n): the numbers; in return of each pool, the first `pools`
      integer, intent(out) :: last(:)              !! shape (n): of each pool its last number
      integer, intent(out) :: pools
      real(wp) :: one, other
      integer :: i

      pools = 0
      do i = 1, size(level)
         pools = pools + 1
         level(pools) = level(i)
         last(pools) = i
         do while (pools > 1)
            if (level(pools - 1) <= level(pools)) exit
            one = real(last(pools - 1), wp)
            if (pools > 2) one = real(last(pools - 1) - last(pools - 2), wp)
            other = real(last(pools) - last(pools - 1), wp)
            level(pools - 1) = (one*level(pools - 1) + other*level(pools))/(one + other)
            last(pools - 1) = last(pools)
            pools = pools - 1
         end do
      end do
   end subroutine pool_rising
end module psalm_sort
