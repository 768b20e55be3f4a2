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
      integer :: n, t, members, portion, item, items, first, last, own, done, so_far
      logical :: shared

      n = size(starts, 2)
      shared = .false.
      members = 1
      if (present(stop)) then
         shared = stop%is_shared() .and. n > 1
         members = stop%members()
      end if
      if (.not. shared .and. (threads < 2 .or. n < 2)) then
         if (informed) then
            call follow(problem, from, to, starts, tolerance, ends, arrived, steps, stop, 0, n)
         else
            call follow(problem, from, to, starts, tolerance, ends, arrived, steps, stop)
         end if
         stopped = is_to_end(stop)
         return
      end if
      portion = min(most_at_once, (n - 1)/(portions_each*members) + 1)
      items = (n - 1)/portion + 1
      ends = starts
      arrived = .false.
      steps = 0
      done = 0
      if (shared) call stop%open_batch('paths', items, passing=.true.)
      !$omp parallel do num_threads(threads) schedule(static) private(item, first, last, own, so_far) reduction(+:steps)
      do t = 1, threads
         item = t - threads
         do
            item = next_after(item)
            if (item > items) exit
            first = 1 + (item - 1)*portion
            last = min(first + portion - 1, n)
            call follow(problem, from, to, starts(:, first:last), tolerance, ends(:, first:last), arrived(first:last), own, stop)
            if (shared) then
               if (stop%waiting()) exit
               call stop%keep_item(item, [real(own, wp), merge(1.0_wp, 0.0_wp, arrived(first:last)), &
                                          real(ends(:, first:last), wp), aimag(ends(:, first:last))])
            else
               steps = steps + own
            end if
            ! (flang 19 takes only one sum here)
            !$omp atomic capture
            done = done + (last - first + 1)
            so_far = done
            !$omp end atomic
            ! hosts are informed from their own thread
            if (t == 1 .and. informed .and. present(stop)) call stop%tell(min(n, so_far*members), n)
         end do
      end do
      !$omp end parallel do
      if (shared) then
         call stop%close_batch()
         call take_all()
      else
         stopped = is_to_end(stop)
      end if

   contains

      !> The portion that this thread follows after one.
      integer function next_after(item)
         integer, intent(in) :: item

         if (present(stop)) then
            next_after = stop%next_item(item, threads, items)
         else
            next_after = item + threads
         end if
      end function next_after

      !> What all ranks have followed.
      subroutine take_all()
         real(wp), allocatable :: numbers(:)
         integer :: k, low, high, m, behind

         stopped = .false.
         do k = 1, items
            call stop%take_item(k, numbers)
            stopped = stopped .or. .not. allocated(numbers)
            if (.not. allocated(numbers)) cycle
            low = 1 + (k - 1)*portion
            high = min(low + portion - 1, n)
            m = high - low + 1
            behind = 1 + m + m*size(starts, 1)
            steps = steps + nint(numbers(1))
            arrived(low:high) = numbers(2:1 + m) > 0.0_wp
            ends(:, low:high) = reshape(cmplx(numbers(2 + m:behind), numbers(behind + 1:), wp), [size(starts, 1), m])
         end do
      end subroutine take_all
   end subroutine follow_shared
end module psalm_six_bar_team
