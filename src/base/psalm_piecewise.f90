!> Tables whose values lie on straight lines between their rows.
module psalm_piecewise
   use psalm_kinds, only: wp, full_turn
   implicit none (type, external)
   private
   public :: interpolated

contains

   !> Values of a table, straight between its rows and constant beyond them; a table over a crank angle goes on round the turn.
   pure function interpolated(inputs, factors, at, turning) result(values)
      real(wp), intent(in) :: inputs(:), factors(:)  !! shape (rows), inputs ascending
      real(wp), intent(in) :: at(:)
      logical, intent(in) :: turning                 !! inputs are degrees of a turn
      real(wp) :: values(size(at)), x, low, width, from, to
      integer :: i, k, rows

      rows = size(inputs)
      do i = 1, size(at)
         x = at(i)
         if (turning) x = inputs(1) + modulo(at(i) - inputs(1), full_turn)
         k = count(inputs <= x)
         if (k == 0) then
            values(i) = factors(1)
         else if (k < rows) then
            low = inputs(k)
            width = inputs(k + 1) - low
            from = factors(k)
            to = factors(k + 1)
            values(i) = from + (to - from)*((x - low)/width)
         else
            values(i) = factors(rows)
            width = inputs(1) + full_turn - inputs(rows)
            if (turning .and. width > 0.0_wp) values(i) = factors(rows) + (factors(1) - factors(rows))*((x - inputs(rows))/width)
         end if
      end do
   end function interpolated
end module psalm_piecewise
