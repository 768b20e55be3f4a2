!> Start sets of six-bar problems: made once, kept in the user's cache, checked when they are read.
!>
!> A set that is being made is kept after every pass and taken up where it was left. The directory is XDG_CACHE_HOME/psalm, else
!> HOME/.cache/psalm; where there is neither, or nothing can be written, a set is made anew each time.
module psalm_six_bar_starts
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: wp
   use psalm_six_bar_loops, only: begin_loops, start_set_t, next_loop
   use psalm_six_bar_paths, only: polish
   use psalm_six_bar_problem, only: six_bar_problem_t
   use psalm_stop, only: stop_t
   use psalm_system, only: make_directories, move_file, remove_file
   implicit none (type, external)
   private
   public :: starts_of

   integer(int64), parameter :: mark = 1936288882_int64, version = 1_int64
   integer, parameter :: checked = 10                !! solutions of a file that are polished
   real(wp), parameter :: valid = 1.0e-9_wp          !! largest first correction of these
   integer, parameter :: most_seeds = 3

contains

   !> The start set of a problem. `loops%done` is false if a stop came before it was made, or if `expected` were not found.
   subroutine starts_of(problem, expected, stop, loops)
      type(six_bar_problem_t), intent(in) :: problem
      integer, intent(in) :: expected                !! solutions of the kind
      type(stop_t), intent(in), optional :: stop
      type(start_set_t), intent(out) :: loops
      character(:), allocatable :: file
      logical :: kept, stopped, drawn
      integer :: seed

      file = start_file(problem)
      call read_loops(file, problem, loops, kept)
      if (kept) then
         if (loops%done .and. size(loops%first, 2) == expected) return
         kept = .not. loops%done
      end if
      do seed = 1, most_seeds
         if (.not. kept) then
            call begin_loops(problem, seed, loops, drawn)
            if (.not. drawn) cycle
         end if
         kept = .false.
         do while (.not. loops%done)
            call next_loop(loops, expected, stop, stopped)
            if (stopped) return
            call write_loops(file, loops)
         end do
         if (size(loops%first, 2) == expected) exit
      end do
   end subroutine starts_of

   !> Where the start set of a problem is kept; empty: nowhere.
   function start_file(problem) result(file)
      type(six_bar_problem_t), intent(in) :: problem
      character(:), allocatable :: file

      file = variable('XDG_CACHE_HOME')
      if (file == '') then
         file = variable('HOME')
         if (file /= '') file = file//'/.cache'
      end if
      if (file /= '') file = file//'/psalm/'//problem%key()//'.start'
   end function start_file

   !> The value of an environment variable, empty if there is none.
   function variable(name) result(value)
      character(*), intent(in) :: name
      character(:), allocatable :: value
      integer :: length, status

      call get_environment_variable(name, length=length, status=status)
      if (status /= 0) length = 0
      allocate (character(length) :: value)
      if (length > 0) call get_environment_variable(name, value)
   end function variable

   !> Write a state beside its place, then put it there. What cannot be written is made again next time.
   subroutine write_loops(file, loops)
      character(*), intent(in) :: file
      type(start_set_t), intent(in) :: loops
      integer :: unit, error

      if (file == '') return
      call make_directories(file(:index(file, '/', back=.true.) - 1), error)
      open (newunit=unit, file=file//'.new', access='stream', form='unformatted', status='replace', action='write', iostat=error)
      if (error /= 0) return
      write (unit, iostat=error) mark, version, int(storage_size(1.0_wp), int64), &
         int([loops%seed, loops%passes, loops%idle, merge(1, 0, loops%done), size(loops%first, 1), size(loops%first, 2), &
              size(loops%second, 2)], int64)
      if (error == 0) write (unit, iostat=error) loops%data%e0, loops%data%f0, loops%data(1)%de, loops%data(2)%de, &
         loops%data(1)%df, loops%data(2)%df, loops%data(1)%known, loops%data(2)%known, loops%data%square
      if (error == 0) write (unit, iostat=error) loops%first, loops%second, sum_of(loops)
      if (error == 0) then
         close (unit, iostat=error)
      else
         close (unit, status='delete')
      end if
      if (error == 0) call move_file(file//'.new', file, error)
      if (error /= 0) call remove_file(file//'.new')
   end subroutine write_loops

   !> Read a state; `kept` is false for a file that is not there, of another version, cut short or damaged.
   subroutine read_loops(file, problem, loops, kept)
      character(*), intent(in) :: file
      type(six_bar_problem_t), intent(in) :: problem
      type(start_set_t), intent(out) :: loops
      logical, intent(out) :: kept
      integer(int64) :: head(3), numbers(7)
      complex(wp) :: total
      integer :: unit, error

      kept = .false.
      allocate (loops%first(2*problem%unknowns, 0), loops%second(2*problem%unknowns, 0))
      if (file == '') return
      open (newunit=unit, file=file, access='stream', form='unformatted', status='old', action='read', iostat=error)
      if (error /= 0) return
      loops%problem = problem
      read (unit, iostat=error) head, numbers
      if (error == 0) then
         if (any(head /= [mark, version, int(storage_size(1.0_wp), int64)]) .or. numbers(5) /= 2*problem%unknowns .or. &
             any(numbers < 0) .or. any(numbers > huge(1))) error = 1
      end if
      if (error == 0) then
         loops%seed = int(numbers(1))
         loops%passes = int(numbers(2))
         loops%idle = int(numbers(3))
         loops%done = numbers(4) == 1
         read (unit, iostat=error) loops%data%e0, loops%data%f0, loops%data(1)%de, loops%data(2)%de, &
            loops%data(1)%df, loops%data(2)%df, loops%data(1)%known, loops%data(2)%known, loops%data%square
      end if
      if (error == 0) then
         deallocate (loops%first, loops%second)
         allocate (loops%first(numbers(5), numbers(6)), stat=error)
         if (error == 0) allocate (loops%second(numbers(5), numbers(7)), stat=error)
      end if
      if (error == 0) read (unit, iostat=error) loops%first, loops%second, total
      close (unit)
      if (error == 0) kept = .not. abs(total - sum_of(loops)) > 0.0_wp .and. size(loops%first, 2) > 0
      if (kept) kept = is_valid(loops)
   end subroutine read_loops

   !> What tells whether numbers were damaged.
   pure complex(wp) function sum_of(loops)
      type(start_set_t), intent(in) :: loops

      sum_of = sum(loops%first/(1.0_wp + abs(loops%first))) + sum(loops%second/(1.0_wp + abs(loops%second)))
   end function sum_of

   !> True if some of the solutions, spread over all, solve the problem.
   logical function is_valid(loops)
      type(start_set_t), intent(in) :: loops
      complex(wp) :: some(size(loops%first, 1), checked), polished(size(loops%first, 1), checked)
      real(wp) :: left(checked)
      integer :: i, n

      n = size(loops%first, 2)
      do i = 1, checked
         some(:, i) = loops%first(:, 1 + (i - 1)*(n - 1)/(checked - 1))
      end do
      polished = some
      call polish(loops%problem, loops%data(1), polished, left)
      is_valid = all(abs(polished - some) <= valid*(1.0_wp + abs(some)))
   end function is_valid
end module psalm_six_bar_starts
