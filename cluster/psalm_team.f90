!> Who does the numbered work of a run: the ranks of an MPI job, each with threads of its own.
!>
!> Every rank runs the whole program on the same cases, so that all come to the same batches of work in the same order; what is
!> numbered is divided. Items go to whoever asks next: a counter in a window of rank 0, raised by MPI_Fetch_and_op, numbers portions
!> of items, large ones first and single items at last, so that the counter is asked seldom and all ranks end at the same time
!> (source: guided self-scheduling, Polychronopoulos and Kuck (1987), with half its portions). At the end of a batch every rank
!> gets what the others have made. Rank 0 alone writes results; every rank writes what it has made to a file of its own now and
!> then, from which a later run goes on.
!>
!> A run ends where rank 0 says so: its clock is the one that counts for MAXTIME. Within a batch whoever finds that it must end
!> raises a flag beside the counter.
module psalm_team
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use, intrinsic :: iso_fortran_env, only: int64
   use mpi_f08
   use psalm_kinds, only: wp
   use psalm_stop, only: stop_request_t
   use psalm_system, only: finish_program, held_signals_t
   use psalm_work_parts, only: parts_t, known_only
   implicit none (type, external)
   private
   public :: team_t

   integer, parameter :: usual_every = 60       !! seconds between two files of a rank
   integer, parameter :: looks_in_second = 50   !! at the flag
   integer, parameter :: counter = 1, flag = 2  !! places in the window
   integer(c_int), parameter :: pause = 500_c_int !! microseconds between two looks while others finish a batch
   integer(c_int), parameter :: standard_output = 1_c_int, standard_error = 2_c_int, write_only = 1_c_int

   type, extends(parts_t) :: team_t
      logical :: shares = .true.              !! as in the programs without MPI
      logical :: delivers = .true.            !! this is rank 0
      logical :: takes_part = .false.         !! as there: ranks share all of the work
      integer, private :: rank = 0, ranks = 1
      logical, private :: asked = .false.     !! one of the ranks was asked to end
      class(stop_request_t), pointer, private :: host => null()
      integer, allocatable, private :: pending(:) !! items of the batch that are not known
      integer, allocatable, private :: ends_at(:) !! shape (portions): the last item of each, as a place in `pending`
      integer, private :: at = 0, upto = 0    !! the places of this rank's portion that are left: those after `at`
      integer, pointer, private :: window(:) => null()
      type(MPI_Win), private :: handle
      integer(int64), private :: looked = 0_int64
      logical, private :: raised = .false.    !! the flag, as it was seen last
   contains
      procedure :: start
      procedure :: read_parts
      procedure :: leave
      procedure :: open => open_batch
      procedure :: next => next_item
      procedure :: close => close_batch
      procedure :: agree
      procedure :: ends
      procedure :: members
   end type team_t

   interface
      integer(c_int) function c_open(path, how) bind(c, name='open')
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: how
      end function c_open

      integer(c_int) function c_dup2(from, to) bind(c, name='dup2')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: from, to
      end function c_dup2

      integer(c_int) function c_usleep(microseconds) bind(c, name='usleep')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: microseconds
      end function c_usleep
   end interface

contains

   !> Before anything else. `host` is asked whether the run is to end.
   subroutine start(self, host)
      class(team_t), intent(inout) :: self
      class(stop_request_t), intent(in), target, optional :: host
      integer :: provided
      integer(MPI_ADDRESS_KIND) :: bytes
      integer(c_int) :: nowhere, ignored
      type(held_signals_t) :: signals

      ! threads of the MPI's own must not take the signals that a study waits for
      call signals%hold()
      call MPI_Init_thread(MPI_THREAD_SERIALIZED, provided)
      call signals%release()
      if (provided < MPI_THREAD_SERIALIZED) call MPI_Abort(MPI_COMM_WORLD, 3)
      call MPI_Comm_rank(MPI_COMM_WORLD, self%rank)
      call MPI_Comm_size(MPI_COMM_WORLD, self%ranks)
      if (present(host)) self%host => host
      self%delivers = self%rank == 0
      self%part = self%rank + 1
      self%parts = self%ranks
      self%every = usual_every
      if (.not. self%delivers) then
         ! what all have to say is said once; the launcher tells of a rank that fails
         nowhere = c_open('/dev/null'//c_null_char, write_only)
         ignored = c_dup2(nowhere, standard_output)
         ignored = c_dup2(nowhere, standard_error)
      end if
      bytes = 0
      if (self%delivers) bytes = 2*int(storage_size(0)/8, MPI_ADDRESS_KIND)
      call make_window(self, bytes)
   end subroutine start

   !> Memory of rank 0 that all ranks reach.
   subroutine make_window(self, bytes)
      use, intrinsic :: iso_c_binding, only: c_f_pointer, c_ptr
      class(team_t), intent(inout) :: self
      integer(MPI_ADDRESS_KIND), intent(in) :: bytes
      type(c_ptr) :: memory

      call MPI_Win_allocate(bytes, storage_size(0)/8, MPI_INFO_NULL, MPI_COMM_WORLD, memory, self%handle)
      if (self%delivers) then
         call c_f_pointer(memory, self%window, [2])
         self%window = 0
      end if
      call MPI_Win_lock_all(0, self%handle)
      call MPI_Barrier(MPI_COMM_WORLD)
   end subroutine make_window

   !> Read the files that other runs have left: rank 0 reads them, all take them in.
   subroutine read_parts(self, files, message)
      class(team_t), intent(inout) :: self
      integer, intent(out) :: files                   !! how many there are
      character(:), allocatable, intent(out) :: message !! what is wrong with one; empty: nothing
      integer, parameter :: looked_for = 65536        !! numbers of parts at most
      character(:), allocatable :: text
      integer :: k, length, missed

      files = 0
      message = ''
      missed = 0
      k = 0
      do while (missed < max(64, self%ranks) .and. k < looked_for .and. len(message) == 0)
         k = k + 1
         length = -1
         if (self%delivers) then
            call self%found(k, text, message)
            if (allocated(text)) length = len(text)
         end if
         call share_text(message)
         call MPI_Bcast(length, 1, MPI_INTEGER, 0, MPI_COMM_WORLD)
         missed = missed + 1
         if (length < 0) cycle
         missed = 0
         files = files + 1
         if (.not. self%delivers) then
            if (allocated(text)) deallocate (text)
            allocate (character(length) :: text)
         end if
         call MPI_Bcast(text, length, MPI_CHARACTER, 0, MPI_COMM_WORLD)
         call self%take_text(text, k, message)
      end do

   contains

      !> What rank 0 has to say.
      subroutine share_text(words)
         character(:), allocatable, intent(inout) :: words
         integer :: count

         count = len(words)
         call MPI_Bcast(count, 1, MPI_INTEGER, 0, MPI_COMM_WORLD)
         if (count == 0) return
         if (.not. self%delivers) then
            deallocate (words)
            allocate (character(count) :: words)
         end if
         call MPI_Bcast(words, count, MPI_CHARACTER, 0, MPI_COMM_WORLD)
      end subroutine share_text
   end subroutine read_parts

   !> Last of all: end the program with the status of rank 0.
   subroutine leave(self, status)
      class(team_t), intent(inout) :: self
      integer, intent(in) :: status
      integer :: shared

      shared = status
      call MPI_Bcast(shared, 1, MPI_INTEGER, 0, MPI_COMM_WORLD)
      call MPI_Win_unlock_all(self%handle)
      call MPI_Win_free(self%handle)
      call MPI_Finalize()
      call finish_program(shared)
   end subroutine leave

   !> Begin a batch: rank 0 sets the counter back before anyone takes from it.
   subroutine open_batch(self, label, items, passing)
      class(team_t), intent(inout) :: self
      character(*), intent(in) :: label
      integer, intent(in) :: items
      logical, intent(in) :: passing
      integer :: i, before

      call self%parts_t%open(label, items, passing)
      if (self%now > 0) then
         self%pending = pack([(i, i=1, items)], [(.not. self%is_known(i), i=1, items)])
      else
         self%pending = [integer ::]
      end if
      self%ends_at = portions_of(size(self%pending), self%ranks)
      self%at = 0
      self%upto = 0
      self%raised = .false.
      if (self%delivers) then
         call MPI_Fetch_and_op(0, before, MPI_INTEGER, 0, place(counter), MPI_REPLACE, self%handle)
         call MPI_Fetch_and_op(0, before, MPI_INTEGER, 0, place(flag), MPI_REPLACE, self%handle)
         call MPI_Win_flush(0, self%handle)
      end if
      call MPI_Barrier(MPI_COMM_WORLD)
   end subroutine open_batch

   !> The portions in which items are taken: each a part of what is left before it.
   pure function portions_of(items, ranks) result(ends_at)
      integer, intent(in) :: items, ranks
      integer, parameter :: finer = 2      !! portions of what is left for each rank
      integer, allocatable :: ends_at(:)   !! the last item of each
      integer :: n, turn, upto

      do turn = 1, 2 ! to count them, to note them
         n = 0
         upto = 0
         do while (upto < items)
            n = n + 1
            upto = upto + max(1, (items - upto)/(finer*ranks))
            if (turn == 2) ends_at(n) = upto
         end do
         if (turn == 1) allocate (ends_at(n))
      end do
   end function portions_of

   pure integer(MPI_ADDRESS_KIND) function place(which)
      integer, intent(in) :: which

      place = int(which - 1, MPI_ADDRESS_KIND)
   end function place

   !> The next item of the portion of this rank, or of the next portion that no rank has taken.
   integer function next_item(self) result(item)
      class(team_t), intent(inout) :: self
      integer :: taken

      item = 0
      if (self%mode == known_only) return
      !$omp critical (psalm_ranks)
      if (self%at == self%upto) then
         call MPI_Fetch_and_op(1, taken, MPI_INTEGER, 0, place(counter), MPI_SUM, self%handle)
         call MPI_Win_flush(0, self%handle)
         if (taken < size(self%ends_at)) then
            self%upto = self%ends_at(taken + 1)
            self%at = 0
            if (taken > 0) self%at = self%ends_at(taken)
         end if
      end if
      if (self%at < self%upto) then
         self%at = self%at + 1
         item = self%pending(self%at)
      end if
      !$omp end critical (psalm_ranks)
   end function next_item

   !> End a batch: all get what each has made.
   subroutine close_batch(self)
      class(team_t), intent(inout) :: self
      real(wp), allocatable :: mine(:), all_of_it(:), numbers(:)
      integer :: counts(self%ranks), offsets(self%ranks)
      type(MPI_Request) :: request
      type(MPI_Datatype) :: kind_of_numbers
      integer :: i, k, length, at, asked
      logical :: over
      integer(c_int) :: ignored

      ! a rank that is done waits without taking the processor from those that are not
      call MPI_Ibarrier(MPI_COMM_WORLD, request)
      do
         call MPI_Test(request, over, MPI_STATUS_IGNORE)
         if (over) exit
         ignored = c_usleep(pause)
      end do
      asked = 0
      if (associated(self%host)) then
         if (self%host%asked()) asked = 1
      end if
      call MPI_Allreduce(MPI_IN_PLACE, asked, 1, MPI_INTEGER, MPI_MAX, MPI_COMM_WORLD)
      self%asked = self%asked .or. asked > 0
      length = 0
      do i = 1, size(self%pending)
         if (self%is_known(self%pending(i))) then
            call self%take(self%pending(i), numbers)
            length = length + 2 + size(numbers)
         end if
      end do
      allocate (mine(length))
      at = 0
      do i = 1, size(self%pending)
         if (.not. self%is_known(self%pending(i))) cycle
         call self%take(self%pending(i), numbers)
         mine(at + 1) = real(self%pending(i), wp)
         mine(at + 2) = real(size(numbers), wp)
         mine(at + 3:at + 2 + size(numbers)) = numbers
         at = at + 2 + size(numbers)
      end do
      call MPI_Allgather(length, 1, MPI_INTEGER, counts, 1, MPI_INTEGER, MPI_COMM_WORLD)
      offsets(1) = 0
      do k = 2, self%ranks
         offsets(k) = offsets(k - 1) + counts(k - 1)
      end do
      allocate (all_of_it(sum(counts)))
      call MPI_Type_match_size(MPI_TYPECLASS_REAL, storage_size(1.0_wp)/8, kind_of_numbers)
      call MPI_Allgatherv(mine, length, kind_of_numbers, all_of_it, counts, offsets, kind_of_numbers, MPI_COMM_WORLD)
      at = 0
      do while (at < size(all_of_it))
         i = nint(all_of_it(at + 1))
         length = nint(all_of_it(at + 2))
         if (.not. self%is_known(i)) call self%put(i, all_of_it(at + 3:at + 2 + length))
         at = at + 2 + length
      end do
      call self%parts_t%close()
   end subroutine close_batch

   !> Within a batch: whether anyone has found that all must end. Between batches: what rank 0 finds.
   logical function agree(self, waiting)
      class(team_t), intent(inout) :: self
      logical, intent(in) :: waiting
      integer(int64) :: now, rate
      integer :: before
      logical :: over

      if (self%within) then
         call system_clock(now, rate)
         if (.not. self%raised .and. (waiting .or. now - self%looked > rate/looks_in_second)) then
            !$omp critical (psalm_ranks)
            self%looked = now
            call MPI_Fetch_and_op(merge(1, 0, waiting), before, MPI_INTEGER, 0, place(flag), MPI_SUM, self%handle)
            call MPI_Win_flush(0, self%handle)
            self%raised = before > 0 .or. waiting
            !$omp end critical (psalm_ranks)
         end if
         over = self%raised
      else
         over = waiting .or. self%asked
         call MPI_Bcast(over, 1, MPI_LOGICAL, 0, MPI_COMM_WORLD)
      end if
      agree = self%parts_t%agree(over)
   end function agree

   !> True if a rank was asked to end.
   pure logical function ends(self)
      class(team_t), intent(in) :: self

      ends = self%asked .or. self%parts_t%ends()
   end function ends

   integer function members(self)
      class(team_t), intent(in) :: self

      members = self%ranks
   end function members
end module psalm_team
