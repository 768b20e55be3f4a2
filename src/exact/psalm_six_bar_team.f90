!> Paths of six-bars, followed by several threads and by the ranks of a job: portions of them are dealt out.
!>
!> A path does not depend on those beside it, so every number is the same whatever the number of threads and ranks.
module psalm_six_bar_team
   use psalm_kinds, only: wp
   use psalm_six_bar_problem, only: six_bar_data_t, six_bar_problem_t
   use psalm_stop, only: is_to_end, stop_t
   implicit none (type, external)
   private
   public :: follow_shared

   integer, parameter :: most_at_once = 256          !! paths of a portion: a tenth of a second
   integer, parameter :: portions_each = 8           !! at least so many for each rank, where there are so many paths

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

   !> Follow solutions of `from` to `to`: portions of them by the ranks of a job, `threads` portions at once in each. With
   !> `informed` the paths followed are reported to the host.
   subroutine follow_shared(follow, problem, from, to, starts, tolerance, threads, informed, ends, arrived, steps, stopped, stop)
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
      logical, intent(out) :: stopped                !! before all were followed
      type(stop_t), intent(in), optional :: stop     !! asked before every step
      integer :: n, ranks

      n = size(starts, 2)
      ranks = 1
      if (present(stop)) ranks = stop%members()
      if (ranks > 1 .and. n > 1) then
         call follow_by_ranks(follow, problem, from, to, starts, tolerance, threads, informed, ends, arrived, steps, stopped, stop)
         return
      end if
      if (threads > 1 .and. n > 1) then
         call follow_by_threads(follow, problem, from, to, starts, tolerance, threads, informed, ends, arrived, steps, stop)
      else if (informed) then
         call follow(problem, from, to, starts, tolerance, ends, arrived, steps, stop, 0, n)
      else
         call follow(problem, from, to, starts, tolerance, ends, arrived, steps, stop)
      end if
      stopped = is_to_end(stop)
   end subroutine follow_shared

   !> The threads of this process take portions until none is left.
   subroutine follow_by_threads(follow, problem, from, to, starts, tolerance, threads, informed, ends, arrived, steps, stop)
      procedure(follow_i) :: follow
      type(six_bar_problem_t), intent(in) :: problem
      type(six_bar_data_t), intent(in) :: from, to
      complex(wp), intent(in) :: starts(:, :)
      real(wp), intent(in) :: tolerance
      integer, intent(in) :: threads
      logical, intent(in) :: informed
      complex(wp), intent(out) :: ends(:, :)
      logical, intent(out) :: arrived(:)
      integer, intent(out) :: steps
      type(stop_t), intent(in), optional :: stop
      integer :: n, t, portion, next, first, last, own, done, so_far

      n = size(starts, 2)
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
   end subroutine follow_by_threads

   !> The ranks of a job take portions; each gets the ends of all.
   subroutine follow_by_ranks(follow, problem, from, to, starts, tolerance, threads, informed, ends, arrived, steps, stopped, stop)
      procedure(follow_i) :: follow
      type(six_bar_problem_t), intent(in) :: problem
      type(six_bar_data_t), intent(in) :: from, to
      complex(wp), intent(in) :: starts(:, :)
      real(wp), intent(in) :: tolerance
      integer, intent(in) :: threads
      logical, intent(in) :: informed
      complex(wp), intent(out) :: ends(:, :)
      logical, intent(out) :: arrived(:)
      integer, intent(out) :: steps
      logical, intent(out) :: stopped
      type(stop_t), intent(in) :: stop
      complex(wp), allocatable :: reached(:, :)
      real(wp), allocatable :: numbers(:)
      logical :: came(most_at_once)
      integer :: n, m, t, portion, item, items, first, last, own, done, so_far

      n = size(starts, 2)
      portion = min(most_at_once, (n - 1)/(portions_each*stop%members()) + 1)
      items = (n - 1)/portion + 1
      done = 0
      call stop%open_batch('paths', items, passing=.true.)
      !$omp parallel do num_threads(threads) schedule(static) private(item, first, last, m, own, so_far, reached, came)
      do t = 1, threads
         allocate (reached(size(starts, 1), portion))
         item = 0
         do
            item = stop%next_item(item, 1, items)
            if (item > items) exit
            first = 1 + (item - 1)*portion
            last = min(first + portion - 1, n)
            m = last - first + 1
            call follow(problem, from, to, starts(:, first:last), tolerance, reached(:, :m), came(:m), own, stop)
            if (stop%waiting()) exit
            call stop%keep_item(item, [real(own, wp), merge(1.0_wp, 0.0_wp, came(:m)), real(reached(:, :m), wp), &
                                       aimag(reached(:, :m))])
            !$omp atomic capture
            done = done + m
            so_far = done
            !$omp end atomic
            if (t == 1 .and. informed) call stop%tell(min(n, so_far*stop%members()), n)
         end do
         deallocate (reached)
      end do
      !$omp end parallel do
      call stop%close_batch()
      ends = starts
      arrived = .false.
      steps = 0
      stopped = .false.
      do item = 1, items
         call stop%take_item(item, numbers)
         if (allocated(numbers)) then
            first = 1 + (item - 1)*portion
            last = min(first + portion - 1, n)
            m = last - first + 1
            own = m*size(starts, 1)
            steps = steps + nint(numbers(1))
            arrived(first:last) = numbers(2:1 + m) > 0.0_wp
            ends(:, first:last) = reshape(cmplx(numbers(2 + m:1 + m + own), numbers(2 + m + own:1 + m + 2*own), wp), &
                                          [size(starts, 1), m])
         else
            stopped = .true.
         end if
      end do
   end subroutine follow_by_ranks
end module psalm_six_bar_team
