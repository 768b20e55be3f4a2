!> Free timing, seen as a whole: which point of the path a linkage traces comes nearest to each desired one.
!>
!> A descent moves every input only as far as its own valley goes; this looks over the whole range of the input.
module psalm_timing
   use psalm_angles, only: nearest_difference
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp
   use psalm_merit, only: merit_t
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples
   use psalm_similarity, only: time_similar
   use psalm_timing_order, only: choose_inputs, inputs_of_path, never, steps_of_path
   implicit none (type, external)
   private
   public :: timing_t, prepare_timing, find_timing

   type :: timing_t
      class(sample_set_t), allocatable :: path
      real(wp), allocatable :: inputs(:)          !! shape (steps_of_path)
      real(wp), allocatable :: cost(:, :)         !! shape (steps_of_path, positions): weighted squared distance
      integer, allocatable :: like(:)             !! shape (steps_of_path): the first step with all slides on the same sides
   end type timing_t

contains

   !> Allocate for a search with free timing.
   subroutine prepare_timing(problem, merit, timing)
      type(problem_t), intent(in) :: problem
      type(merit_t), intent(in) :: merit
      type(timing_t), intent(out) :: timing

      timing%inputs = inputs_of_path(problem%delt, merit%sense, .not. problem%mechanism%sliding_input)
      allocate (timing%path)
      call prepare_samples(problem, timing%inputs, .false., reshape([integer ::], [2, 0]), .false., timing%path)
      allocate (timing%cost(steps_of_path, problem%positions), source=0.0_wp)
      allocate (timing%like(steps_of_path), source=1)
   end subroutine prepare_timing

   !> The timing that fits the merit's linkage (`merit%dimensions`) best, at the steps of the range.
   !>
   !> No linkage moves through parallel slides: what lies on one side of them is a path of its own.
   subroutine find_timing(timing, merit, delt)
      type(timing_t), intent(inout) :: timing
      type(merit_t), intent(in) :: merit
      real(wp), intent(inout) :: delt(:)          !! shape (positions); where the desired points have no place, those to begin with
      real(wp) :: trial(size(delt)), total, best
      integer :: i

      call evaluate_samples(timing%path, merit%dimensions)
      call find_paths(timing)
      best = huge(best)
      do i = 1, steps_of_path
         if (timing%like(i) /= i) cycle
         if (merit%similar) then
            trial = delt
            call time_shape(timing, merit, i, trial, total)
         else
            call time_path(timing, merit, i, trial, total)
         end if
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
         do i = 2, steps_of_path
            do j = 1, i
               if (all((timing%path%k(j, :) < 1.0_wp .eqv. timing%path%k(i, :) < 1.0_wp) .or. .not. pairs)) exit
            end do
            timing%like(i) = j
         end do
      end associate
   end subroutine find_paths

   !> The same where the desired points may lie anywhere, in any size.
   subroutine time_shape(timing, merit, path, delt, best)
      type(timing_t), intent(inout) :: timing
      type(merit_t), intent(in) :: merit
      integer, intent(in) :: path                 !! its first step
      real(wp), intent(inout) :: delt(:)          !! shape (positions)
      real(wp), intent(out) :: best

      associate (problem => merit%main%problem, out => timing%path%out, n => size(delt))
         call time_similar(cmplx(out(:, 1), out(:, 2), wp), timing%path%closed .and. timing%like == path, timing%inputs, &
                           cmplx(problem%wanted(:n, 1), problem%wanted(:n, 2), wp), problem%weight(:n, 1), &
                           .not. problem%mechanism%sliding_input, merit%ordered, merit%sense, delt, timing%cost, best)
      end associate
   end subroutine time_shape

   !> The best timing on one of the paths, and what it costs.
   subroutine time_path(timing, merit, path, delt, best)
      type(timing_t), intent(inout) :: timing
      type(merit_t), intent(in) :: merit
      integer, intent(in) :: path                 !! its first step
      real(wp), intent(out) :: delt(:)            !! shape (positions)
      real(wp), intent(out) :: best
      integer :: i, c

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
         call choose_inputs(timing%inputs, timing%cost, .not. problem%mechanism%sliding_input, merit%ordered, merit%sense, delt, &
                            best)
      end associate
   end subroutine time_path
end module psalm_timing
