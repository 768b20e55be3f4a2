!> Paths of six-bars, followed by several threads: portions of them are dealt out.
!>
!> A path does not depend on those beside it, so every number is the same whatever the number of threads.
module psalm_six_bar_team
   use psalm_kinds, only: wp
   use psalm_six_bar_problem, only: six_bar_data_t, six_bar_problem_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: follow_shared

   integer, parameter :: most_at_once = 256          !! paths of a portion: a tenth of a second

   abstract interface
      !> `follow` of psalm_six_bar_paths and of its kinds.
      subroutine follow_i(problem, from, to, starts, tolerance, ends, arrived, steps, stop, before, of)
         import :: six_bar_data_t, six_bar_problem_t, stop_t, wp
         implicit none (type, external)
         type(six_bar_problem_t), intent(in) :: problem
         type(six_bar_data_t), intent(in) :: from, to
         complex(wp), intent(in) :: starts(:, :)
         real(wp), intent(in) :: tolerance
         complex(wp), intent(out) :: ends(:, :)
         logical, intent(out) :: arrived(:)
         integer, intent(out) :: steps
         type(stop_t), intent(in), optional :: stop
         integer, intent(in), optional :: before, of
      end subroutine follow_i
   end interface

contains

   !> Follow solutions of `from` to `to`, `threads` portions at once. With `informed` the paths followed are reported to the host.
   subroutine follow_shared(follow, problem, from, to, starts, tolerance, threads, informed, ends, arrived, steps, stop)
      procedure(follow_i) :: follow                  !! follows a portion
      type(six_bar_problem_t), intent(in) :: problem
      type(six_bar_data_t), intent(in) :: from, to   !! at t = 1 and t = 0
      complex(wp), intent(in) :: starts(:, :)        !! shape (2 unknowns, count)
      real(wp), intent(in) :: tolerance              !! error of a prediction that is aimed at
      integer, intent(in) :: threads
      logical, intent(in) :: informed
      complex(wp), intent(out) :: ends(:, :)         !! shape of the starts; of one that did not arrive its last valid place
      logical, intent(out) :: arrived(:)             !! shape (count)
      integer, intent(out) :: steps                  !! of all
      type(stop_t), intent(in), optional :: stop     !! asked before every step
      integer :: n, t, portion, next, first, last, own, done, so_far

      n = size(starts, 2)
      if (threads < 2 .or. n < 2) then
         if (informed) then
            call follow(problem, from, to, starts, tolerance, ends, arrived, steps, stop, 0, n)
         else
            call follow(problem, from, to, starts, tolerance, ends, arrived, steps, stop)
         end if
         return
      end if
      portion = min(most_at_once, (n + threads - 1)/threads)
      ends = starts
      arrived = .false.
      steps = 0
      next = 1
      done = 0
      !$omp parallel do num_threads(threads) schedule(static) private(first, last, own, so_far) reduction(+:steps)
      do t = 1, threads
         do
            !$omp atomic capture
            first = next
            next = next + portion
            !$omp end atomic
            if (first > n) exit
            last = min(first + portion - 1, n)
            call follow(problem, from, to, starts(:, first:last), tolerance, ends(:, first:last), arrived(first:last), own, stop)
            steps = steps + own
            !$omp atomic capture
            done = done + last - first + 1
            so_far = done
            !$omp end atomic
            ! hosts are informed from their own thread
            if (t == 1 .and. informed .and. present(stop)) call stop%tell(so_far, n)
         end do
      end do
      !$omp end parallel do
   end subroutine follow_shared
end module psalm_six_bar_team
