!> When a search must end: the host asks for it, or the time it was given is up.
!>
!> A study asks now and then. The library installs no handler and masks no signal: a program that wants to stop a study extends
!> `stop_request_t` and hands it over in a `stop_t`. So does a host that lets others do a part of the work (`psalm_shared_work`).
module psalm_stop
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: dp, wp
   use psalm_shared_work, only: sharing_t
   implicit none (type, external)
   private
   public :: stop_request_t, stop_t, is_to_end, tell_host

   !> What a host extends to be able to end a study, and, if it wants to, to show how far one is.
   type, abstract :: stop_request_t
   contains
      procedure(asked), deferred :: asked
      procedure :: reported
   end type stop_request_t

   abstract interface
      !> True if the study is to end. Called often and from several threads at once.
      logical function asked(self)
         import :: stop_request_t
         implicit none (type, external)
         class(stop_request_t), intent(in) :: self
      end function asked
   end interface

   !> The token that a study is given. Copies ask the same host; without one only the time counts, if it is limited.
   type :: stop_t
      private
      class(stop_request_t), pointer :: request => null()
      class(sharing_t), pointer :: others => null()    !! not associated: all work is done here
      logical :: by_items = .true.                     !! batches are shared with them; false: only the end is agreed with them
      integer(int64) :: end = huge(1_int64)            !! clock count after which time is up
   contains
      procedure :: listen_to
      procedure :: share_with
      procedure :: within_item
      procedure :: is_shared
      procedure :: members
      procedure :: open_batch
      procedure :: next_item
      procedure :: keep_item
      procedure :: close_batch
      procedure :: take_item
      procedure :: limit_time
      procedure :: waiting
      procedure :: tell
      procedure :: requested
      procedure :: late
   end type stop_t

contains

   !> So many of the paths, turns or rows of a study are done: nothing is done with it here. Called often, from one thread.
   subroutine reported(self, done, of)
      class(stop_request_t), intent(inout) :: self
      integer, intent(in) :: done, of

      associate (unused => same_type_as(self, self) .and. done == of)
      end associate
   end subroutine reported

   !> Ask this host from now on. It must live as long as the token and its copies.
   subroutine listen_to(self, request)
      class(stop_t), intent(inout) :: self
      class(stop_request_t), intent(in), target :: request

      self%request => request
   end subroutine listen_to

   !> Let numbered work be shared so from now on. What it is shared by must live as long as the token and its copies.
   subroutine share_with(self, others)
      class(stop_t), intent(inout) :: self
      class(sharing_t), intent(in), target :: others

      self%others => others
   end subroutine share_with

   !> The token for what belongs to one item of a shared batch: its own work is not shared, but it ends when the others end.
   type(stop_t) function within_item(self)
      class(stop_t), intent(in) :: self

      within_item = self
      within_item%by_items = .false.
   end function within_item

   !> True if numbered work is shared.
   pure logical function is_shared(self)
      class(stop_t), intent(in) :: self

      is_shared = associated(self%others) .and. self%by_items
   end function is_shared

   !> How many share the work, each with threads of its own.
   integer function members(self)
      class(stop_t), intent(in) :: self

      members = 1
      if (self%is_shared()) members = self%others%members()
   end function members

   !> Begin a batch of numbered items; without others nothing is done by this.
   subroutine open_batch(self, label, items, passing)
      class(stop_t), intent(in) :: self
      character(*), intent(in) :: label                !! what the items are, one word
      integer, intent(in) :: items
      logical, intent(in), optional :: passing         !! forgotten when the next begins, and in no file; default no
      logical :: forgotten

      if (.not. self%is_shared()) return
      forgotten = .false.
      if (present(passing)) forgotten = passing
      call self%others%open(label, items, forgotten)
   end subroutine open_batch

   !> The item to do after `item`, which was done last by this thread: the next one for this machine if the work is shared, else the
   !> one after a step; beyond `items`: none is left.
   integer function next_item(self, item, step, items)
      class(stop_t), intent(in) :: self
      integer, intent(in) :: item, step, items

      next_item = item + step
      if (.not. self%is_shared()) return
      next_item = self%others%next()
      if (next_item == 0) next_item = items + 1
   end function next_item

   !> Hand over what an item led to.
   subroutine keep_item(self, item, numbers)
      class(stop_t), intent(in) :: self
      integer, intent(in) :: item
      real(wp), intent(in) :: numbers(:)

      if (self%is_shared()) call self%others%keep(item, numbers)
   end subroutine keep_item

   !> End the batch.
   subroutine close_batch(self)
      class(stop_t), intent(in) :: self

      if (self%is_shared()) call self%others%close()
   end subroutine close_batch

   !> What an item of the batch closed last led to; not allocated: it is not known, or the work is not shared.
   subroutine take_item(self, item, numbers)
      class(stop_t), intent(in) :: self
      integer, intent(in) :: item
      real(wp), allocatable, intent(out) :: numbers(:)

      if (self%is_shared()) call self%others%take(item, numbers)
   end subroutine take_item

   !> Give so many seconds from now on; 0: no limit.
   subroutine limit_time(self, seconds)
      class(stop_t), intent(inout) :: self
      real(wp), intent(in) :: seconds
      integer(int64) :: now, rate

      self%end = huge(self%end)
      if (seconds <= 0.0_wp) return
      call system_clock(now, rate)
      if (real(seconds, dp) < real(self%end - now, dp)/real(rate, dp)) self%end = now + int(real(seconds, dp)*real(rate, dp), int64)
   end subroutine limit_time

   !> True if the search must end.
   logical function waiting(self)
      class(stop_t), intent(in) :: self

      waiting = self%late()
      if (.not. waiting) waiting = self%requested()
      if (associated(self%others)) waiting = self%others%agree(waiting)
   end function waiting

   !> True if a study must end that was given a token, or none.
   logical function is_to_end(stop)
      type(stop_t), intent(in), optional :: stop

      is_to_end = .false.
      if (present(stop)) is_to_end = stop%waiting()
   end function is_to_end

   !> Tell the host, if there is one, that so many paths, turns or rows are done.
   subroutine tell(self, done, of)
      class(stop_t), intent(in) :: self
      integer, intent(in) :: done, of

      if (associated(self%request)) call self%request%reported(done, of)
   end subroutine tell

   !> Tell the host of a study that was given a token, or none, that so many of its steps are done.
   subroutine tell_host(stop, done, of)
      type(stop_t), intent(in), optional :: stop
      integer, intent(in) :: done, of

      if (present(stop)) call stop%tell(done, of)
   end subroutine tell_host

   !> True if the time is up.
   logical function late(self)
      class(stop_t), intent(in) :: self
      integer(int64) :: now

      late = .false.
      if (self%end == huge(self%end)) return
      call system_clock(now)
      late = now > self%end
   end function late

   !> True if the host wants the search to end.
   logical function requested(self)
      class(stop_t), intent(in) :: self

      requested = .false.
      if (associated(self%request)) requested = self%request%asked()
      if (associated(self%others)) requested = requested .or. self%others%ends()
   end function requested
end module psalm_stop
