!> Inputs between the prescribed positions: every degree of a turn, or even steps of a sliding input.
module psalm_sweep
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, full_turn
   implicit none (type, external)
   private
   public :: sweep_inputs, sweep_sense

   integer, parameter :: intervals = 360 !! of a sliding input's range

contains

   !> Increments of a sweep, from the first prescribed position, in the direction of the first two.
   pure function sweep_inputs(problem) result(delt)
      type(problem_t), intent(in) :: problem
      real(wp), allocatable :: delt(:)   !! shape (360), degrees; sliding input: shape (361), length
      integer :: i

      if (problem%mechanism%sliding_input) then
         delt = evenly(problem%delt)
      else
         delt = [(problem%delt(1) + sweep_sense(problem)*real(i, wp), i=0, nint(full_turn) - 1)]
      end if
   end function sweep_inputs

   !> +1 or -1: the direction in which the first two prescribed positions follow each other.
   pure real(wp) function sweep_sense(problem)
      type(problem_t), intent(in) :: problem

      sweep_sense = 1.0_wp
      if (size(problem%delt) > 1) sweep_sense = sign(1.0_wp, problem%delt(2) - problem%delt(1))
   end function sweep_sense

   pure function evenly(delt) result(steps)
      real(wp), intent(in) :: delt(:)
      real(wp), allocatable :: steps(:)
      real(wp) :: from, to
      integer :: i

      from = minval(delt)
      to = maxval(delt)
      if (size(delt) > 1) then
         if (delt(2) < delt(1)) then
            from = maxval(delt)
            to = minval(delt)
         end if
      end if
      steps = [(from + (to - from)*(real(i, wp)/real(intervals, wp)), i=0, intervals)]
   end function evenly
end module psalm_sweep
