!> Free timing, seen as a whole: which point of the path a linkage traces comes nearest to each desired one.
!>
!> A descent moves every input only as far as its own valley goes; this looks over the whole range of the input.
module psalm_timing
   use psalm_angles, only: nearest_difference
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, full_turn
   use psalm_merit, only: merit_t
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples
   implicit none (type, external)
   private
   public :: timing_t, prepare_timing, find_timing

   integer, parameter :: steps = 120              !! of the range: 3 degrees each
   integer, parameter :: starts = 60              !! where an ordered timing may begin
   real(wp), parameter :: never = 1.0e30_wp       !! cost of a position that does not close

   type :: timing_t
      class(sample_set_t), allocatable :: path
      real(wp), allocatable :: inputs(:)          !! shape (steps)
      real(wp), allocatable :: cost(:, :)         !! shape (steps, positions): weighted squared distance
      real(wp), allocatable :: least(:, :)        !! shape (steps, positions): of timings that end here or before
      integer, allocatable :: like(:)             !! shape (steps): the first step with all pairs of slides on the same sides
   end type timing_t

contains

   !> Allocate for a search with free timing.
   subroutine prepare_timing(problem, merit, timing)
      type(problem_t), intent(in) :: problem
      type(merit_t), intent(in) :: merit
      type(timing_t), intent(out) :: timing
      real(wp) :: from, to
      integer :: i

      from = merit%sense*minval(merit%sense*problem%delt)
      to = from + merit%sense*full_turn
      if (problem%mechanism%sliding_input) to = merit%sense*maxval(merit%sense*problem%delt)
      timing%inputs = [(from + (to - from)*(real(i, wp)/real(merge(steps - 1, steps, problem%mechanism%sliding_input), wp)), &
                        i=0, steps - 1)]
      allocate (timing%path)
      call prepare_samples(problem, timing%inputs, .false., reshape([integer ::], [2, 0]), .false., timing%path)
      allocate (timing%cost(steps, problem%positions), timing%least(steps, problem%positions), source=0.0_wp)
      allocate (timing%like(steps), source=1)
   end subroutine prepare_timing

   !> The timing that fits the merit's linkage (`merit%dimensions`) best, at the steps of the range.
   !>
   !> No linkage moves through parallel slides: what lies on one side of them is a path of its own.
   subroutine find_timing(timing, merit, delt)
      type(timing_t), intent(inout) :: timing
      type(merit_t), intent(in) :: merit
      real(wp), intent(out) :: delt(:)            !! shape (positions)
      real(wp) :: trial(size(delt)), total, best
      integer :: i

      call evaluate_samples(timing%path, merit%dimensions)
      call find_paths(timing)
      best = huge(best)
      do i = 1, steps
         if (timing%like(i) /= i) cycle
         call time_path(timing, merit, i, trial, total)
         if (i > 1 .and. total >= best) cycle
         best = total
         delt = trial
      end do
   end subroutine find_timing

   !> Which steps belong together.
   pure subroutine find_paths(timing)
      type(timing_t), intent(inout) :: timing
      integer :: i, j

      timing%like = 1
      associate (pairs => timing%path%problem%linkage%two_slides .and. timing%path%problem%linkage%step_of_loop > 0)
         if (.not. any(pairs)) return
         do i = 2, steps
            do j = 1, i
               if (all((timing%path%k(j, :) < 1.0_wp .eqv. timing%path%k(i, :) < 1.0_wp) .or. .not. pairs)) exit
            end do
            timing%like(i) = j
         end do
      end associate
   end subroutine find_paths

   !> The best timing on one of the paths, and what it costs.
   subroutine time_path(timing, merit, path, delt, best)
      type(timing_t), intent(inout) :: timing
      type(merit_t), intent(in) :: merit
      integer, intent(in) :: path                 !! its first step
      real(wp), intent(out) :: delt(:)            !! shape (positions)
      real(wp), intent(out) :: best
      integer :: i, c, from, best_from
      real(wp) :: total

      associate (problem => merit%main%problem, out => timing%path%out)
         do i = 1, size(delt)
            timing%cost(:, i) = 0.0_wp
            do c = 1, size(out, 2)
               if (c == problem%output%kind%angle) then
                  timing%cost(:, i) = timing%cost(:, i) &
                                      + problem%weight(i, c)*nearest_difference(out(:, c), problem%wanted(i, c))**2
               else
                  timing%cost(:, i) = timing%cost(:, i) + problem%weight(i, c)*(out(:, c) - problem%wanted(i, c))**2
               end if
            end do
            where (.not. timing%path%closed .or. timing%like /= path) timing%cost(:, i) = timing%cost(:, i) + never
         end do
         if (.not. merit%ordered) then
            delt = timing%inputs(minloc(timing%cost, dim=1))
            best = sum(minval(timing%cost, dim=1))
            return
         end if
         best = huge(best)
         best_from = 1
         do from = 1, merge(1, steps, problem%mechanism%sliding_input), steps/starts
            call try_from(timing, from, total)
            if (total < best) then
               best = total
               best_from = from
            end if
         end do
         call try_from(timing, best_from, total)
         call trace_back(timing, best_from, merit%sense, delt)
      end associate
   end subroutine time_path

   !> Least cost of passing all points in order that begins at step `from` or after.
   subroutine try_from(timing, from, total)
      type(timing_t), intent(inout) :: timing
      integer, intent(in) :: from
      real(wp), intent(out) :: total
      integer :: i, j
      real(wp) :: before

      do i = 1, size(timing%cost, 2)
         do j = 1, steps
            before = 0.0_wp
            if (i > 1) before = timing%least(j, i - 1)
            timing%least(j, i) = before + timing%cost(modulo(from + j - 2, steps) + 1, i)
            if (j > 1) timing%least(j, i) = min(timing%least(j, i), timing%least(j - 1, i))
         end do
      end do
      total = timing%least(steps, size(timing%cost, 2))
   end subroutine try_from

   !> The timing itself.
   pure subroutine trace_back(timing, from, sense, delt)
      type(timing_t), intent(in) :: timing
      integer, intent(in) :: from
      real(wp), intent(in) :: sense
      real(wp), intent(out) :: delt(:)
      integer :: i, j, place

      j = steps
      do i = size(delt), 1, -1
         do while (j > 1)
            if (timing%least(j - 1, i) > timing%least(j, i)) exit
            j = j - 1
         end do
         place = modulo(from + j - 2, steps) + 1
         delt(i) = timing%inputs(place)
         if (place < from) delt(i) = delt(i) + sense*full_turn
      end do
   end subroutine trace_back
end module psalm_timing
