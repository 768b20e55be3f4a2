!> Checks: each counts as passed or failed; a failed one prints the law it was to show and what came instead.
module check
   use psalm_kinds, only: wp
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: checks_t, number_argument

   type :: checks_t
      integer :: passed = 0, failed = 0
   contains
      procedure :: is_true
      procedure :: equal_integer
      procedure :: equal_text
      procedure :: close_to
      procedure :: finds
      procedure :: report
   end type checks_t

contains

   subroutine is_true(self, condition, law, got)
      class(checks_t), intent(inout) :: self
      logical, intent(in) :: condition
      character(*), intent(in) :: law
      character(*), intent(in), optional :: got

      if (condition) then
         self%passed = self%passed + 1
         return
      end if
      self%failed = self%failed + 1
      if (present(got)) then
         print '(4a)', 'FAILED: ', law, '; got ', got
      else
         print '(2a)', 'FAILED: ', law
      end if
   end subroutine is_true

   subroutine equal_integer(self, got, want, law)
      class(checks_t), intent(inout) :: self
      integer, intent(in) :: got, want
      character(*), intent(in) :: law
      character(40) :: text

      write (text, '(i0," instead of ",i0)') got, want
      call self%is_true(got == want, law, trim(text))
   end subroutine equal_integer

   subroutine equal_text(self, got, want, law)
      class(checks_t), intent(inout) :: self
      character(*), intent(in) :: got, want, law

      call self%is_true(got == want, law, "'"//got//"' instead of '"//want//"'")
   end subroutine equal_text

   !> |got - want| <= tolerance * max(1, |want|)
   subroutine close_to(self, got, want, tolerance, law)
      class(checks_t), intent(inout) :: self
      real(wp), intent(in) :: got, want, tolerance
      character(*), intent(in) :: law
      character(80) :: text

      write (text, '(es24.16," instead of ",es24.16)') got, want
      call self%is_true(abs(got - want) <= tolerance*max(1.0_wp, abs(want)), law, trim(text))
   end subroutine close_to

   !> One of the findings holds the words.
   subroutine finds(self, findings, words, law)
      class(checks_t), intent(inout) :: self
      type(diagnostics_t), intent(in) :: findings
      character(*), intent(in) :: words, law
      character(:), allocatable :: all
      logical :: found
      integer :: i

      all = ''
      found = .false.
      do i = 1, findings%count
         all = all//' | '//findings%list(i)%render()
         if (index(findings%list(i)%render(), words) > 0) found = .true.
      end do
      call self%is_true(found, law//" (expected: '"//words//"')", all)
   end subroutine finds

   subroutine report(self)
      class(checks_t), intent(in) :: self

      print '(i0,a,i0,a)', self%passed, ' passed, ', self%failed, ' failed'
      if (self%failed > 0) error stop 1
   end subroutine report

   !> An argument of the command line that is a number, or its default.
   integer function number_argument(number, default)
      integer, intent(in) :: number, default
      character(20) :: text
      integer :: status

      call get_command_argument(number, text)
      read (text, *, iostat=status) number_argument
      if (status /= 0) number_argument = default
   end function number_argument
end module check
