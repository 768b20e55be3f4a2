!> Who does the numbered work of a run: this process, with a clock. `cluster/measure.py` builds psalm with it.
!>
!> It writes the file work.times: `open SECONDS LABEL ITEMS` where a batch begins, `item NUMBER SECONDS NUMBERS` for each item (what it
!> took, how many numbers it led to), `close SECONDS` where all items of the batch are made, `end SECONDS` at last. Seconds of the lines without item
!> count from the beginning of the run. They are of the processor, so that other work on the machine does not count. One thread only: an
!> item is timed from when it is asked for until it is handed over.
module psalm_team
   use psalm_kinds, only: dp, wp
   use psalm_stop, only: stop_request_t
   use psalm_system, only: finish_program
   use psalm_work_parts, only: parts_t
   implicit none (type, external)
   private
   public :: team_t

   type, extends(parts_t) :: team_t
      logical :: shares = .true.              !! numbered work is looked after
      logical :: delivers = .true.            !! this process writes the results
      logical :: takes_part = .false.         !! as ranks do not
      integer, private :: unit = 0
      real(dp), private :: asked = 0.0_dp     !! seconds when the last item was asked for
   contains
      procedure :: start
      procedure :: read_parts
      procedure :: leave
      procedure :: open => open_batch
      procedure :: next => next_item
      procedure :: keep => keep_item
      procedure :: close => close_batch
   end type team_t

contains

   !> Before anything else. `host` is asked whether the run is to end.
   subroutine start(self, host)
      class(team_t), intent(inout) :: self
      class(stop_request_t), intent(in), target, optional :: host

      associate (unused => present(host))
      end associate
      open (newunit=self%unit, file='work.times', status='replace', action='write')
   end subroutine start

   !> Read the files that other runs have left.
   subroutine read_parts(self, files, message)
      class(team_t), intent(inout) :: self
      integer, intent(out) :: files                   !! how many there are
      character(:), allocatable, intent(out) :: message !! what is wrong with one; empty: nothing

      call self%read_all(files, message)
   end subroutine read_parts

   !> Last of all: end the program with this status.
   subroutine leave(self, status)
      class(team_t), intent(inout) :: self
      integer, intent(in) :: status

      write (self%unit, '(a, f0.6)') 'end ', seconds()
      close (self%unit)
      call finish_program(status)
   end subroutine leave

   subroutine open_batch(self, label, items, passing)
      class(team_t), intent(inout) :: self
      character(*), intent(in) :: label
      integer, intent(in) :: items
      logical, intent(in) :: passing

      write (self%unit, '(a, f0.6, 1x, a, 1x, i0)') 'open ', seconds(), label, items
      call self%parts_t%open(label, items, passing)
   end subroutine open_batch

   integer function next_item(self) result(item)
      class(team_t), intent(inout) :: self

      item = self%parts_t%next()
      self%asked = seconds()
   end function next_item

   subroutine keep_item(self, item, numbers)
      class(team_t), intent(inout) :: self
      integer, intent(in) :: item
      real(wp), intent(in) :: numbers(:)

      write (self%unit, '(a, i0, 1x, f0.6, 1x, i0)') 'item ', item, seconds() - self%asked, size(numbers)
      call self%parts_t%keep(item, numbers)
   end subroutine keep_item

   subroutine close_batch(self)
      class(team_t), intent(inout) :: self

      write (self%unit, '(a, f0.6)') 'close ', seconds()
      call take_all(self)
      call self%parts_t%close()
   end subroutine close_batch

   !> What every rank of a job does with the results of all at the end of a batch, but for the exchange.
   subroutine take_all(self)
      class(team_t), intent(inout) :: self
      real(wp), allocatable :: all_of_it(:), numbers(:)
      integer :: i, at, length

      length = 0
      do i = 1, self%items()
         if (.not. self%is_known(i)) cycle
         call self%take(i, numbers)
         length = length + 1 + size(numbers)
      end do
      allocate (all_of_it(length))
      at = 0
      do i = 1, self%items()
         if (.not. self%is_known(i)) cycle
         call self%take(i, numbers)
         all_of_it(at + 1) = real(size(numbers), wp)
         all_of_it(at + 2:at + 1 + size(numbers)) = numbers
         at = at + 1 + size(numbers)
      end do
      at = 0
      do i = 1, self%items()
         if (.not. self%is_known(i)) cycle
         length = nint(all_of_it(at + 1))
         call self%put(i, all_of_it(at + 2:at + 1 + length))
         at = at + 1 + length
      end do
   end subroutine take_all

   !> Seconds of the processor since the program began.
   real(dp) function seconds()
      call cpu_time(seconds)
   end function seconds
end module psalm_team
