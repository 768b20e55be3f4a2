!> Free timing on a path that is known at a row of inputs: the inputs at which its points are passed, by dynamic programming.
module psalm_timing_order
   use psalm_kinds, only: wp, full_turn
   implicit none (type, external)
   private
   public :: choose_inputs, steps_of_path, inputs_of_path, never

   integer, parameter :: steps_of_path = 120      !! of the range: 3 degrees each of a turn
   real(wp), parameter :: never = 1.0e30_wp       !! cost of an input that is not reached
   integer, parameter :: starts = 60              !! where an ordered timing may begin

contains

   !> Increments of the input at which a path is looked at: a turn the way of `sense` from the first one; of an input that slides
   !> from one end of those given to the other.
   pure function inputs_of_path(delt, sense, turns) result(inputs)
      real(wp), intent(in) :: delt(:)             !! shape (positions): increments given
      real(wp), intent(in) :: sense               !! +1: they grow, -1: they fall
      logical, intent(in) :: turns                !! the input does
      real(wp) :: inputs(steps_of_path)
      real(wp) :: from, to
      integer :: i

      from = sense*minval(sense*delt)
      to = from + sense*full_turn
      if (.not. turns) to = sense*maxval(sense*delt)
      inputs = [(from + (to - from)*(real(i, wp)/real(merge(steps_of_path, steps_of_path - 1, turns), wp)), i=0, steps_of_path - 1)]
   end function inputs_of_path

   !> The inputs at which all points are passed at the least cost: each where it costs least, or in order.
   pure subroutine choose_inputs(inputs, cost, turns, ordered, sense, delt, best)
      real(wp), intent(in) :: inputs(:)           !! shape (steps): of the path
      real(wp), intent(in) :: cost(:, :)          !! shape (steps, positions): weighted squared distance
      logical, intent(in) :: turns                !! the last step is followed by the first
      logical, intent(in) :: ordered
      real(wp), intent(in) :: sense               !! of the order
      real(wp), intent(out) :: delt(:)            !! shape (positions)
      real(wp), intent(out) :: best               !! what it costs
      real(wp) :: least(size(cost, 1), size(cost, 2)) ! of timings that end here or before
      real(wp) :: totals(starts)
      integer :: from

      if (.not. ordered) then
         delt = inputs(minloc(cost, dim=1))
         best = sum(minval(cost, dim=1))
         return
      end if
      from = 1
      if (turns) then
         call try_together(cost, size(inputs)/starts, totals)
         from = 1 + (minloc(totals, dim=1) - 1)*(size(inputs)/starts)
      end if
      call try_from(cost, from, least, best)
      call trace_back(inputs, least, from, sense, delt)
   end subroutine choose_inputs

   !> The totals that `try_from` finds for steps 1, 1 + `apart` and so on, side by side: the same numbers.
   pure subroutine try_together(cost, apart, totals)
      real(wp), intent(in) :: cost(:, :)          !! shape (steps, positions), a multiple of `apart` steps
      integer, intent(in) :: apart
      real(wp), intent(out) :: totals(:)          !! shape (steps/apart)
      real(wp) :: before(size(totals), size(cost, 1)), here(size(totals))
      real(wp) :: turn(2*size(totals), apart)     ! of a position: step 1 + apart*(m - 1) + r at (m, r + 1), twice
      integer :: i, j, k, r, first

      before = 0.0_wp
      do i = 1, size(cost, 2)
         do r = 1, apart
            turn(:size(totals), r) = cost(r::apart, i)
            turn(size(totals) + 1:, r) = turn(:size(totals), r)
         end do
         here = huge(here)
         do j = 1, size(cost, 1)
            first = (j - 1)/apart
            r = j - first*apart
            do k = 1, size(totals)
               here(k) = min(before(k, j) + turn(first + k, r), here(k))
               before(k, j) = here(k)
            end do
         end do
      end do
      totals = here
   end subroutine try_together

   !> Least cost of passing all points in order that begins at step `from` or after.
   pure subroutine try_from(cost, from, least, total)
      real(wp), intent(in) :: cost(:, :)          !! shape (steps, positions)
      integer, intent(in) :: from
      real(wp), intent(inout) :: least(:, :)      !! shape (steps, positions)
      real(wp), intent(out) :: total
      integer :: i, j, steps
      real(wp) :: before(size(cost, 1)), here

      steps = size(cost, 1)
      before = 0.0_wp
      do i = 1, size(cost, 2)
         here = huge(here)
         do j = 1, steps
            here = min(before(j) + cost(modulo(from + j - 2, steps) + 1, i), here)
            least(j, i) = here
         end do
         before = least(:, i)
      end do
      total = least(steps, size(cost, 2))
   end subroutine try_from

   !> The timing itself.
   pure subroutine trace_back(inputs, least, from, sense, delt)
      real(wp), intent(in) :: inputs(:), least(:, :)
      integer, intent(in) :: from
      real(wp), intent(in) :: sense
      real(wp), intent(out) :: delt(:)
      integer :: i, j, place

      j = size(inputs)
      do i = size(delt), 1, -1
         do while (j > 1)
            if (least(j - 1, i) > least(j, i)) exit
            j = j - 1
         end do
         place = modulo(from + j - 2, size(inputs)) + 1
         delt(i) = inputs(place)
         if (place < from) delt(i) = delt(i) + sense*full_turn
      end do
   end subroutine trace_back
end module psalm_timing_order
