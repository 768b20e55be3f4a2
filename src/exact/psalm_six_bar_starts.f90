!> Start sets of six-bar problems: made once, kept in the user's cache, checked when they are read.
!>
!> A set that is being made is kept after every pass and taken up where it was left. The directory is XDG_CACHE_HOME/psalm, else
!> HOME/.cache/psalm; where there is neither, or nothing can be written, a set is made anew each time. Of the ranks of a job one
!> reads the file for all, and one writes it.
module psalm_six_bar_starts
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: wp
   use psalm_six_bar_loops, only: begin_loops, start_set_t, next_loop
   use psalm_six_bar_paths, only: polish
   use psalm_six_bar_problem, only: most_six_bar_points, most_unknowns, six_bar_problem_t
   use psalm_stop, only: stop_t
   use psalm_system, only: hash, make_directories, move_file, remove_file, stage
   implicit none (type, external)
   private
   public :: starts_of

   integer(int64), parameter :: mark = 1936288882_int64, version = 2_int64
   integer(int64), parameter :: head(3) = [mark, version, int(digits(1.0_wp), int64)]
   integer, parameter :: counters = 7                !! numbers behind the head
   integer, parameter :: of_data = 2*(2 + 2*most_six_bar_points + 2*most_unknowns) !! complex numbers of both problems
   integer, parameter :: bytes = storage_size(0_int64)/8, complex_bytes = storage_size((0.0_wp, 0.0_wp))/8
   integer, parameter :: checked = 10                !! solutions of a file that are polished
   real(wp), parameter :: valid = 1.0e-9_wp          !! largest first correction of these
   integer, parameter :: most_seeds = 3

contains

   !> The start set of a problem: fewer solutions than `expected` if a stop came before it was made, or if no seed led to so many.
   subroutine starts_of(problem, expected, threads, stop, loops)
      type(six_bar_problem_t), intent(in) :: problem
      integer, intent(in) :: expected                !! solutions of the kind; 0: not known, what the loops find is taken
      integer, intent(in) :: threads                 !! that share the paths
      type(stop_t), intent(in), optional :: stop
      type(start_set_t), intent(out) :: loops
      character(:), allocatable :: file
      logical :: kept, stopped, drawn
      integer :: seed, first

      file = start_file(problem)
      call read_for_all(file, problem, stop, loops, kept)
      first = 1
      if (kept) then
         if (loops%done .and. (expected == 0 .or. size(loops%first, 2) == expected)) return
         ! what a seed that failed has left is no reason to begin with it again
         first = loops%seed + merge(1, 0, loops%done)
         kept = .not. loops%done
      end if
      do seed = first, first + most_seeds - 1
         if (.not. kept) then
            call begin_loops(problem, seed, loops, drawn)
            if (.not. drawn) cycle
         end if
         kept = .false.
         do while (.not. loops%done)
            call next_loop(loops, expected, threads, stopped, stop)
            if (stopped) return
            call write_once(file, loops, stop)
         end do
         if (expected == 0 .or. size(loops%first, 2) == expected) exit
      end do
   end subroutine starts_of

   !> Read a state; of the ranks of a job one does, and all get what it has read.
   subroutine read_for_all(file, problem, stop, loops, kept)
      character(*), intent(in) :: file
      type(six_bar_problem_t), intent(in) :: problem
      type(stop_t), intent(in), optional :: stop
      type(start_set_t), intent(out) :: loops
      logical, intent(out) :: kept
      real(wp), allocatable :: numbers(:)
      type(start_set_t) :: found

      if (.not. is_shared(stop)) then
         call read_loops(file, problem, loops, kept)
         return
      end if
      if (is_mine('kept', stop)) then
         call read_loops(file, problem, found, kept)
         call stop%keep_item(1, numbers_of(found, kept))
      end if
      call stop%close_batch()
      call stop%take_item(1, numbers)
      kept = allocated(numbers)
      if (kept) kept = numbers(1) > 0.0_wp
      if (kept) then
         call take_numbers(numbers, problem, loops)
      else
         allocate (loops%first(2*problem%unknowns, 0), loops%second(2*problem%unknowns, 0))
      end if
   end subroutine read_for_all

   !> Write a state; of the ranks of a job one does.
   subroutine write_once(file, loops, stop)
      character(*), intent(in) :: file
      type(start_set_t), intent(in) :: loops
      type(stop_t), intent(in), optional :: stop

      if (.not. is_shared(stop)) then
         call write_loops(file, loops)
         return
      end if
      if (is_mine('written', stop)) then
         call write_loops(file, loops)
         call stop%keep_item(1, [1.0_wp])
      end if
      call stop%close_batch()
   end subroutine write_once

   !> True if the work is shared.
   logical function is_shared(stop)
      type(stop_t), intent(in), optional :: stop

      is_shared = .false.
      if (present(stop)) is_shared = stop%is_shared()
   end function is_shared

   !> Begin a batch of one item; true for the one who is to do it.
   logical function is_mine(label, stop)
      character(*), intent(in) :: label
      type(stop_t), intent(in) :: stop

      call stop%open_batch(label, 1, passing=.true.)
      is_mine = stop%next_item(0, 1, 1) == 1
   end function is_mine

   !> A state in numbers.
   pure function numbers_of(loops, kept) result(numbers)
      type(start_set_t), intent(in) :: loops
      logical, intent(in) :: kept                    !! false: there was none
      real(wp), allocatable :: numbers(:)
      complex(wp) :: data(of_data)
      integer :: i, at

      if (.not. kept) then
         numbers = [0.0_wp]
         return
      end if
      at = 0
      do i = 1, size(loops%data)
         associate (one => loops%data(i))
            data(at + 1:at + of_data/2) = [one%e0, one%f0, one%de, one%df, one%known]
         end associate
         at = at + of_data/2
      end do
      numbers = [1.0_wp, real([loops%seed, loops%passes, loops%idle, merge(1, 0, loops%done), size(loops%first, 2), &
                               size(loops%second, 2)], wp), real(data, wp), aimag(data), real(loops%first, wp), &
                 aimag(loops%first), real(loops%second, wp), aimag(loops%second)]
   end function numbers_of

   !> The state that numbers describe: the reverse of `numbers_of`.
   pure subroutine take_numbers(numbers, problem, loops)
      real(wp), intent(in) :: numbers(:)
      type(six_bar_problem_t), intent(in) :: problem
      type(start_set_t), intent(out) :: loops
      complex(wp) :: data(of_data)
      integer, parameter :: counts = 7
      integer :: i, at, points, n, many

      loops%problem = problem
      loops%seed = nint(numbers(2))
      loops%passes = nint(numbers(3))
      loops%idle = nint(numbers(4))
      loops%done = numbers(5) > 0.0_wp
      n = 2*problem%unknowns
      data = cmplx(numbers(counts + 1:counts + of_data), numbers(counts + of_data + 1:counts + 2*of_data), wp)
      at = 0
      do i = 1, size(loops%data)
         associate (one => loops%data(i))
            points = size(one%de)
            one%e0 = data(at + 1)
            one%f0 = data(at + 2)
            one%de = data(at + 3:at + 2 + points)
            one%df = data(at + 3 + points:at + 2 + 2*points)
            one%known = data(at + 3 + 2*points:at + of_data/2)
         end associate
         at = at + of_data/2
      end do
      at = counts + 2*of_data
      many = n*nint(numbers(6))
      loops%first = reshape(cmplx(numbers(at + 1:at + many), numbers(at + many + 1:at + 2*many), wp), [n, many/n])
      at = at + 2*many
      many = n*nint(numbers(7))
      loops%second = reshape(cmplx(numbers(at + 1:at + many), numbers(at + many + 1:at + 2*many), wp), [n, many/n])
   end subroutine take_numbers

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

   !> Write a state under a name of its own, then put it in its place. What cannot be written is made again next time.
   subroutine write_loops(file, loops)
      character(*), intent(in) :: file
      type(start_set_t), intent(in) :: loops
      character(:), allocatable :: text, beside
      integer :: at, error, i

      if (file == '') return
      allocate (character(bytes*(size(head) + counters + 1) + complex_bytes* &
                          (of_data + size(loops%first) + size(loops%second))) :: text, stat=error)
      if (error /= 0) return
      at = 0
      call put_integers([head, int([loops%seed, loops%passes, loops%idle, merge(1, 0, loops%done), size(loops%first, 1), &
                                    size(loops%first, 2), size(loops%second, 2)], int64)])
      do i = 1, size(loops%data)
         associate (data => loops%data(i))
            call put([data%e0, data%f0, data%de, data%df, data%known])
         end associate
      end do
      do i = 1, size(loops%first, 2)
         call put(loops%first(:, i))
      end do
      do i = 1, size(loops%second, 2)
         call put(loops%second(:, i))
      end do
      call put_integers([sum_of(text(:at))])
      call make_directories(file(:index(file, '/', back=.true.) - 1), error)
      call stage(file, text, beside, error)
      if (error /= 0) return
      call move_file(beside, file, error)
      if (error /= 0) call remove_file(beside)

   contains

      subroutine put_integers(numbers)
         integer(int64), intent(in) :: numbers(:)

         text(at + 1:at + bytes*size(numbers)) = transfer(numbers, repeat(' ', bytes*size(numbers)))
         at = at + bytes*size(numbers)
      end subroutine put_integers

      subroutine put(numbers)
         complex(wp), intent(in) :: numbers(:)

         text(at + 1:at + complex_bytes*size(numbers)) = transfer(numbers, repeat(' ', complex_bytes*size(numbers)))
         at = at + complex_bytes*size(numbers)
      end subroutine put
   end subroutine write_loops

   !> Read a state; `kept` is false for a file that is not there, of another version, cut short or damaged.
   subroutine read_loops(file, problem, loops, kept)
      character(*), intent(in) :: file
      type(six_bar_problem_t), intent(in) :: problem
      type(start_set_t), intent(out) :: loops
      logical, intent(out) :: kept
      integer(int64) :: found(size(head)), numbers(counters), sum
      character(:), allocatable :: text
      integer :: unit, length, error, i

      kept = .false.
      allocate (loops%first(2*problem%unknowns, 0), loops%second(2*problem%unknowns, 0))
      if (file == '') return
      open (newunit=unit, file=file, access='stream', form='unformatted', status='old', action='read', iostat=error)
      if (error /= 0) return
      inquire (unit=unit, size=length)
      if (length < bytes*(size(head) + counters + 1)) error = 1
      if (error == 0) allocate (character(length) :: text, stat=error)
      if (error == 0) read (unit, iostat=error) text
      if (error == 0) read (unit, pos=1, iostat=error) found, numbers
      if (error == 0) read (unit, pos=length - bytes + 1, iostat=error) sum
      if (error == 0) then
         if (any(found /= head) .or. sum /= sum_of(text(:length - bytes)) .or. numbers(5) /= 2*problem%unknowns .or. &
             numbers(6) < 1) error = 1
      end if
      if (error == 0) then
         loops%problem = problem
         loops%seed = int(numbers(1))
         loops%passes = int(numbers(2))
         loops%idle = int(numbers(3))
         loops%done = numbers(4) == 1
         deallocate (loops%first, loops%second)
         allocate (loops%first(numbers(5), numbers(6)), stat=error)
         if (error == 0) allocate (loops%second(numbers(5), numbers(7)), stat=error)
      end if
      if (error == 0) then
         read (unit, pos=bytes*(size(head) + counters) + 1, iostat=error) (loops%data(i)%e0, loops%data(i)%f0, loops%data(i)%de, &
            loops%data(i)%df, loops%data(i)%known, i=1, size(loops%data)), loops%first, loops%second
      end if
      close (unit)
      if (error == 0) kept = is_valid(loops)
   end subroutine read_loops

   !> What tells whether a file was damaged: a hash of all its bytes before it.
   pure integer(int64) function sum_of(text)
      character(*), intent(in) :: text

      sum_of = hash(mark, text)
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
