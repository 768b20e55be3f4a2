!> Handles, texts and arrays of the interface for C.
!>
!> A handle is the address of a `handle_t`, which owns the case, its results and the texts that are handed out. Every argument that
!> could be wrong is checked; results are copied into arrays of the caller's. Whatever is wrong comes back as a status and as
!> findings.
module psalm_capi_handles
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, c_ptr, &
                                          c_size_t
   use psalm, only: case_t, findings_t, observer_t, report_t, search_state_t, stop_request_t, stop_t, wp
   implicit none (type, external)
   private
   public :: done, violation, bad_input, misuse, c_text_t, handle_t, result_handle_t, text_of, as_c, handle_of, new_handle
   public :: handed_out, concluded, wrong, hand_over, integers_at, reals_at, put_integer, put_reals, checked_words
   public :: result_of, length_of

   ! statuses, as in psalm.h
   integer(c_int), parameter :: done = 0, violation = 1, bad_input = 2, misuse = 4

   !> A text that ends as C wants it.
   type :: c_text_t
      character(kind=c_char), allocatable :: letters(:)
   end type c_text_t

   !> Whether a study is to end; another thread, or a signal handler, may say so.
   type, extends(stop_request_t) :: host_t
      integer(c_int) :: wants_end = 0
      integer(c_int) :: followed = 0, paths = 0   !! of an exact synthesis: how far it is
   contains
      procedure :: asked
      procedure :: reported
   end type host_t

   !> How far a search is; another thread may ask.
   type, extends(observer_t) :: watch_t
      integer(c_int) :: made = 0, most = 0        !! starts or iterations
      real(c_double) :: best = 0.0_c_double       !! objective
   contains
      procedure :: report
   end type watch_t

   !> What the handle of a case points to.
   type :: handle_t
      type(case_t) :: case
      type(host_t) :: host
      type(watch_t) :: watch
      type(stop_t) :: ending                      !! asks the host
      type(findings_t) :: findings                !! of the last call
      type(c_text_t), allocatable :: texts(:)     !! of the findings
      type(c_text_t) :: reported                      !! the text handed out last
   end type handle_t

   !> What the handle of a result points to.
   type :: result_handle_t
      type(report_t) :: report
      integer, allocatable :: tables(:)           !! those of the report that are for other programs
      type(c_text_t) :: reported                      !! the text handed out last
      type(c_text_t) :: listing, data_set         !! handed out as long as the result lives
      type(c_text_t), allocatable :: files(:)
   end type result_handle_t

   interface
      pure integer(c_size_t) function length_of(text) bind(C, name='strlen')
         import :: c_ptr, c_size_t
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: text
      end function length_of
   end interface

contains

   !> A text of C as a Fortran one; empty for a null pointer.
   function text_of(pointer) result(text)
      type(c_ptr), intent(in) :: pointer
      character(:), allocatable :: text
      character(kind=c_char), pointer :: letters(:)
      integer :: i

      allocate (character(0) :: text)
      if (.not. c_associated(pointer)) return
      call c_f_pointer(pointer, letters, [length_of(pointer)])
      deallocate (text)
      allocate (character(size(letters)) :: text)
      do i = 1, size(letters)
         text(i:i) = letters(i)
      end do
   end function text_of

   pure type(c_text_t) function as_c(text)
      character(*), intent(in) :: text
      integer :: i

      allocate (as_c%letters(len(text) + 1))
      do i = 1, len(text)
         as_c%letters(i) = text(i:i)
      end do
      as_c%letters(len(text) + 1) = c_null_char
   end function as_c

   !> What a handle points to; not associated for a null pointer.
   function handle_of(pointer) result(handle)
      type(c_ptr), intent(in) :: pointer
      type(handle_t), pointer :: handle

      handle => null()
      if (c_associated(pointer)) call c_f_pointer(pointer, handle)
   end function handle_of

   !> A handle without a case.
   function new_handle() result(handle)
      type(handle_t), pointer :: handle

      allocate (handle)
      allocate (handle%texts(0))
      handle%reported = as_c('')
   end function new_handle

   !> A text that the caller may read until the next call with this handle.
   function handed_out(text, reported) result(pointer)
      character(*), intent(in) :: text
      type(c_text_t), intent(inout), target :: reported
      type(c_ptr) :: pointer

      reported = as_c(text)
      pointer = c_loc(reported%letters)
   end function handed_out

   !> Keep the findings of a call and give its status: `violation` if something is violated, unless there are errors.
   integer(c_int) function concluded(handle, findings, violated) result(status)
      type(handle_t), intent(inout) :: handle
      type(findings_t), intent(in) :: findings
      logical, intent(in), optional :: violated
      integer :: i

      handle%findings = findings
      deallocate (handle%texts)
      allocate (handle%texts(findings%count))
      do i = 1, findings%count
         handle%texts(i) = as_c(findings%list(i)%render())
      end do
      status = int(findings%exit_code(), c_int)
      if (status /= done .or. .not. present(violated)) return
      if (violated) status = violation
   end function concluded

   !> The status of a wrong call, with a finding that says what is wrong.
   integer(c_int) function wrong(handle, text)
      type(handle_t), intent(inout) :: handle
      character(*), intent(in) :: text
      type(findings_t) :: findings

      call findings%error(text)
      wrong = concluded(handle, findings)
      wrong = misuse
   end function wrong

   !> Store a handle where the caller wants it.
   subroutine hand_over(place, pointer)
      type(c_ptr), intent(in) :: place, pointer
      type(c_ptr), pointer :: there

      call c_f_pointer(place, there)
      there = pointer
   end subroutine hand_over

   function integers_at(pointer, n) result(values)
      type(c_ptr), intent(in) :: pointer
      integer(c_int), intent(in) :: n
      integer :: values(n)
      integer(c_int), pointer :: there(:)

      call c_f_pointer(pointer, there, [n])
      values = int(there)
   end function integers_at

   function reals_at(pointer, n) result(values)
      type(c_ptr), intent(in) :: pointer
      integer(c_int), intent(in) :: n
      real(wp) :: values(n)
      real(c_double), pointer :: there(:)

      call c_f_pointer(pointer, there, [n])
      values = real(there, wp)
   end function reals_at

   subroutine put_integer(value, pointer)
      integer(c_int), intent(in) :: value
      type(c_ptr), intent(in) :: pointer
      integer(c_int), pointer :: there

      call c_f_pointer(pointer, there)
      there = value
   end subroutine put_integer

   subroutine put_reals(values, pointer)
      real(wp), intent(in) :: values(:)
      type(c_ptr), intent(in) :: pointer
      real(c_double), pointer :: there(:)

      call c_f_pointer(pointer, there, [size(values)])
      there = real(values, c_double)
   end subroutine put_reals

   !> What a call with texts must have.
   integer(c_int) function checked_words(caller, handle, texts, own) result(status)
      character(*), intent(in) :: caller           !! and what must not be NULL
      type(c_ptr), intent(in) :: handle
      type(c_ptr), intent(in) :: texts(:)
      type(handle_t), pointer, intent(out) :: own
      integer :: i

      status = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      do i = 1, size(texts)
         if (c_associated(texts(i))) cycle
         status = wrong(own, caller//' must not be NULL')
         return
      end do
      status = done
   end function checked_words

   !> What the handle of a result points to; not associated for a null pointer.
   function result_of(pointer) result(handle)
      type(c_ptr), intent(in) :: pointer
      type(result_handle_t), pointer :: handle

      handle => null()
      if (c_associated(pointer)) call c_f_pointer(pointer, handle)
   end function result_of

   !> True if an end was asked for.
   logical function asked(self)
      class(host_t), intent(in) :: self
      integer(c_int) :: wanted

      !$omp atomic read
      wanted = self%wants_end
      asked = wanted /= 0
   end function asked

   !> Note how many paths are followed.
   subroutine reported(self, done, of)
      class(host_t), intent(inout) :: self
      integer, intent(in) :: done, of

      !$omp atomic write
      self%paths = int(of, c_int)
      !$omp atomic write
      self%followed = int(done, c_int)
   end subroutine reported

   !> Note where a search stands.
   subroutine report(self, state, points, objectives)
      class(watch_t), intent(inout) :: self
      type(search_state_t), intent(in) :: state
      real(wp), intent(in), optional :: points(:, :)
      real(wp), intent(in), optional :: objectives(:)

      associate (no_points => present(points), no_objectives => present(objectives))
      end associate
      !$omp atomic write
      self%most = int(state%limit, c_int)
      !$omp atomic write
      self%best = real(state%best, c_double)
      !$omp atomic write
      self%made = int(state%iteration, c_int)
   end subroutine report
end module psalm_capi_handles
