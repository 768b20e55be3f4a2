!> When a search must end: the host asks for it, or the time it was given is up.
!>
!> A study asks now and then. The library installs no handler and masks no signal: a program that wants to stop a study extends
!> `stop_request_t` and hands it over in a `stop_t`.
module psalm_stop
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: dp, wp
   implicit none (type, external)
   private
   public :: stop_request_t, stop_t, is_to_end

   !> What a host extends to be able to end a study, and, if it wants to, to show how far one is.
   type, abstract :: stop_request_t
   contains
      procedure(asked), deferred :: asked
      procedure :: told
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
      integer(int64) :: end = huge(1_int64)            !! clock count after which time is up
   contains
      procedure :: listen_to
      procedure :: limit_time
      procedure :: waiting
      procedure :: tell
      procedure :: requested
      procedure :: late
   end type stop_t

contains

   !> So many of the paths of a study are followed: nothing is done with it here. Called often, from one thread.
   subroutine told(self, done, of)
      class(stop_request_t), intent(inout) :: self
      integer, intent(in) :: done, of

      associate (unused => same_type_as(self, self) .and. done == of)
      end associate
   end subroutine told

   !> Ask this host from now on. It must live as long as the token and its copies.
   subroutine listen_to(self, request)
      class(stop_t), intent(inout) :: self
      class(stop_request_t), intent(in), target :: request

      self%request => request
   end subroutine listen_to

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
   end function waiting

   !> True if a study must end that was given a token, or none.
   logical function is_to_end(stop)
      type(stop_t), intent(in), optional :: stop

      is_to_end = .false.
      if (present(stop)) is_to_end = stop%waiting()
   end function is_to_end

   !> Tell the host, if there is one, that so many paths are followed.
   subroutine tell(self, done, of)
      class(stop_t), intent(in) :: self
      integer, intent(in) :: done, of

      if (associated(self%request)) call self%request%told(done, of)
   end subroutine tell

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
   end function requested
end module psalm_stop
