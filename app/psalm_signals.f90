!> Signals that end a search in good order: a study is informed of them through its stop token.
!>
!> Between `hold` and `release` the signals INT and TERM wait; no handler is installed and nothing is kept but the mask of before.
module psalm_signals
   use, intrinsic :: iso_c_binding, only: c_int, c_long
   use omp_lib, only: omp_get_thread_num
   use psalm_stop, only: stop_request_t
   use psalm_system, only: held_signals_t
   implicit none (type, external)
   private
   public :: signals_t, shield_threads

   integer, parameter :: mask_words = 32           !! a signal set is smaller in every C library
   integer(c_int), parameter :: signal_interrupt = 2_c_int, signal_terminate = 15_c_int !! numbers fixed by POSIX
   integer(c_int), parameter :: how_block = 0_c_int, how_set = 2_c_int !! SIG_BLOCK and SIG_SETMASK of Linux

   type, extends(stop_request_t) :: signals_t
      private
      integer(c_long) :: before(mask_words) = 0_c_long !! mask of before
      integer(c_long) :: wanted(mask_words) = 0_c_long !! the signals that wait
      logical :: holds = .false.
   contains
      procedure :: hold
      procedure :: asked
      procedure :: release
   end type signals_t

   interface
      integer(c_int) function c_sigemptyset(set) bind(c, name='sigemptyset')
         import :: c_int, c_long
         implicit none (type, external)
         integer(c_long), intent(inout) :: set(*)
      end function c_sigemptyset

      integer(c_int) function c_sigaddset(set, number) bind(c, name='sigaddset')
         import :: c_int, c_long
         implicit none (type, external)
         integer(c_long), intent(inout) :: set(*)
         integer(c_int), value :: number
      end function c_sigaddset

      integer(c_int) function c_sigismember(set, number) bind(c, name='sigismember')
         import :: c_int, c_long
         implicit none (type, external)
         integer(c_long), intent(in) :: set(*)
         integer(c_int), value :: number
      end function c_sigismember

      integer(c_int) function c_pthread_sigmask(how, set, before) bind(c, name='pthread_sigmask')
         import :: c_int, c_long
         implicit none (type, external)
         integer(c_int), value :: how
         integer(c_long), intent(in) :: set(*)
         integer(c_long), intent(inout) :: before(*)
      end function c_pthread_sigmask

      integer(c_int) function c_sigpending(set) bind(c, name='sigpending')
         import :: c_int, c_long
         implicit none (type, external)
         integer(c_long), intent(inout) :: set(*)
      end function c_sigpending

      integer(c_int) function c_sigwait(set, number) bind(c, name='sigwait')
         import :: c_int, c_long
         implicit none (type, external)
         integer(c_long), intent(in) :: set(*)
         integer(c_int), intent(out) :: number
      end function c_sigwait
   end interface

contains

   !> Leave signals to the first thread: the others never take one.
   subroutine shield_threads(threads)
      integer, intent(in) :: threads              !! as many as the case will use

      !$omp parallel num_threads(threads)
      if (omp_get_thread_num() > 0) call shield()
      !$omp end parallel

   contains

      ! a procedure of its own: gfortran 12 gives private copies no default values
      subroutine shield()
         type(held_signals_t) :: kept

         call kept%hold()
      end subroutine shield
   end subroutine shield_threads

   !> Let the signals wait from now on, in this thread and those it makes. To be called again before more threads are used.
   subroutine hold(self, threads)
      class(signals_t), intent(inout) :: self
      integer, intent(in) :: threads              !! as many as the case will use
      integer(c_long) :: unused(mask_words)
      integer(c_int) :: status, ignored

      if (.not. self%holds) then
         status = c_sigemptyset(self%wanted)
         status = c_sigaddset(self%wanted, signal_interrupt)
         status = c_sigaddset(self%wanted, signal_terminate)
         self%holds = c_pthread_sigmask(how_block, self%wanted, self%before) == 0
      end if
      ! threads that an earlier case left waiting must not take the signals either
      !$omp parallel num_threads(threads) private(unused, ignored)
      unused = 0_c_long
      ignored = c_pthread_sigmask(how_block, self%wanted, unused)
      !$omp end parallel
   end subroutine hold

   !> True if a signal is waiting.
   logical function asked(self)
      class(signals_t), intent(in) :: self
      integer(c_long) :: pending(mask_words)

      asked = .false.
      if (.not. self%holds) return
      pending = 0_c_long
      if (c_sigpending(pending) /= 0) return
      asked = c_sigismember(pending, signal_interrupt) == 1 .or. c_sigismember(pending, signal_terminate) == 1
   end function asked

   !> Take what is waiting and let signals through again. A caller that was interrupted ends in good order by itself.
   subroutine release(self)
      class(signals_t), intent(inout) :: self
      integer(c_long) :: unused(mask_words)
      integer(c_int) :: status, number

      do while (self%asked())
         if (c_sigwait(self%wanted, number) /= 0) exit
      end do
      unused = 0_c_long
      if (self%holds) status = c_pthread_sigmask(how_set, self%before, unused)
      self%holds = .false.
   end subroutine release
end module psalm_signals
