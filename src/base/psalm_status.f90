!> What a procedure has to say about its input or its results: errors, warnings and remarks, each with its place in the text.
!>
!> Nothing below `app/` prints or stops. Findings are collected in a `diagnostics_t`, carried to the caller and printed
!> once by the program, which derives its exit status from them.
module psalm_status
   implicit none (type, external)
   private
   public :: finding_t, diagnostics_t
   public :: level_error, level_warning, level_remark
   public :: exit_done, exit_violation, exit_bad_input, exit_file_error

   integer, parameter :: level_remark = 0  !! of a result
   integer, parameter :: level_warning = 1 !! worth a look; the run goes on
   integer, parameter :: level_error = 2   !! the run cannot start

   integer, parameter :: most_of_a_kind = 5 !! findings of one level, group and item that are reported
   integer, parameter :: most_findings = 200 !! findings that are reported

   integer, parameter :: exit_done = 0          !! done
   integer, parameter :: exit_violation = 1     !! done, but constraints are violated or the search stopped early
   integer, parameter :: exit_bad_input = 2     !! the input is wrong
   integer, parameter :: exit_file_error = 3  !! a file could not be read or written

   !> One finding and its place.
   type :: finding_t
      integer :: level = level_error           !! `level_error`, `level_warning` or `level_remark`
      integer :: code = exit_bad_input         !! exit status that an error of this kind leads to
      character(:), allocatable :: text        !! what is wrong and how to mend it
      character(:), allocatable :: file        !! name of the file, empty if none
      character(:), allocatable :: group       !! namelist group, empty if none
      character(:), allocatable :: item        !! namelist item, empty if none
      integer :: line = 0                      !! line of the file, 0 if none
      integer :: more = 0                      !! stands for so many findings of one kind that are not reported one by one
      character(:), allocatable :: pointer     !! of a case in JSON: the place as a JSON pointer, `/LINKS/ARCL/0/3`
   contains
      procedure :: render => render_finding
   end type finding_t

   !> A growing list of findings. Of one kind (level, group, item) the first few are kept, the rest is counted; of remarks all are.
   type :: diagnostics_t
      type(finding_t), allocatable :: list(:)  !! room for findings; the first `count` are valid
      integer :: count = 0                     !! findings so far
      character(:), allocatable :: file        !! file the following findings belong to
      character(:), allocatable :: prefix      !! the following findings are about JSON: pointer to the case
   contains
      procedure :: error => add_error
      procedure :: warning => add_warning
      procedure :: failure => add_failure
      procedure :: remark => add_remark
      procedure :: add => add_finding
      procedure :: append => add_list
      procedure :: reported_enough
      procedure :: failed
      procedure :: exit_code
   end type diagnostics_t

contains

   !> Add an error in the input. `line`, `group` and `item`, in JSON `pointer` say where; each may be left out.
   pure subroutine add_error(self, text, line, group, item, pointer)
      class(diagnostics_t), intent(inout) :: self
      character(*), intent(in) :: text
      integer, intent(in), optional :: line
      character(*), intent(in), optional :: group, item, pointer

      call append(self, level_error, exit_bad_input, text, line, group, item, pointer)
   end subroutine add_error

   !> Add a warning.
   pure subroutine add_warning(self, text, line, group, item, pointer)
      class(diagnostics_t), intent(inout) :: self
      character(*), intent(in) :: text
      integer, intent(in), optional :: line
      character(*), intent(in), optional :: group, item, pointer

      call append(self, level_warning, exit_done, text, line, group, item, pointer)
   end subroutine add_warning

   !> Add an error of the file system (not to be read, not to be written).
   pure subroutine add_failure(self, text)
      class(diagnostics_t), intent(inout) :: self
      character(*), intent(in) :: text

      call append(self, level_error, exit_file_error, text)
   end subroutine add_failure

   !> Add a remark on a result.
   pure subroutine add_remark(self, text)
      class(diagnostics_t), intent(inout) :: self
      character(*), intent(in) :: text

      call append(self, level_remark, exit_done, text)
   end subroutine add_remark

   !> Add what was found elsewhere.
   pure subroutine add_finding(self, finding)
      class(diagnostics_t), intent(inout) :: self
      type(finding_t), intent(in) :: finding
      integer :: i

      do i = 1, max(1, finding%more)
         call append(self, finding%level, finding%code, finding%text, finding%line, finding%group, finding%item, finding%pointer)
      end do
   end subroutine add_finding

   !> Add all that was found elsewhere, as findings of this list's file.
   pure subroutine add_list(self, other)
      class(diagnostics_t), intent(inout) :: self
      type(diagnostics_t), intent(in) :: other
      integer :: i

      do i = 1, other%count
         call self%add(other%list(i))
      end do
   end subroutine add_list

   !> True if further findings of this kind are only counted, so that their words and places need not be looked for.
   pure logical function reported_enough(self, level, group, item)
      class(diagnostics_t), intent(in) :: self
      integer, intent(in) :: level
      character(*), intent(in) :: group, item
      integer :: i

      reported_enough = .false.
      do i = 1, self%count
         associate (old => self%list(i))
            if (old%more == 0 .or. old%level /= level .or. old%group /= group .or. old%item /= item) cycle
            if (allocated(self%file)) then
               if (old%file /= self%file) cycle
            end if
            reported_enough = .true.
            return
         end associate
      end do
   end function reported_enough

   !> True if any finding is an error.
   pure logical function failed(self)
      class(diagnostics_t), intent(in) :: self

      failed = self%exit_code() /= exit_done
   end function failed

   !> Exit status the findings lead to: the highest of their codes.
   pure integer function exit_code(self)
      class(diagnostics_t), intent(in) :: self
      integer :: i

      exit_code = exit_done
      do i = 1, self%count
         if (self%list(i)%level == level_error) exit_code = max(exit_code, self%list(i)%code)
      end do
   end function exit_code

   !> The finding as one line: `file:line: error: &GROUP ITEM: text`; of a remark `file: text`.
   pure function render_finding(self) result(text)
      class(finding_t), intent(in) :: self
      character(:), allocatable :: text
      character(12) :: number

      text = ''
      if (len(self%file) > 0) text = self%file//':'
      if (self%line > 0) then
         write (number, '(i0)') self%line
         text = text//trim(number)//':'
      end if
      if (len(text) > 0) text = text//' '
      if (self%level /= level_remark) text = text//trim(merge('error:  ', 'warning:', self%level == level_error))//' '
      if (allocated(self%pointer)) then
         text = text//self%pointer//': '
      else
         if (len(self%group) > 0) text = text//'&'//self%group//' '
         if (len(self%item) > 0) text = text//self%item
         if (len(self%group) + len(self%item) > 0) text = trim(text)//': '
      end if
      text = text//self%text
      if (self%more > 0) then
         write (number, '(i0)') self%more
         text = text//trim(number)//' more'
      end if
   end function render_finding

   pure subroutine append(self, level, code, text, line, group, item, pointer)
      class(diagnostics_t), intent(inout) :: self
      integer, intent(in) :: level, code
      character(*), intent(in) :: text
      integer, intent(in), optional :: line
      character(*), intent(in), optional :: group, item, pointer
      type(finding_t), allocatable :: larger(:)
      type(finding_t) :: new
      integer :: i, alike

      new%level = level
      new%code = code
      new%text = text
      new%file = ''
      if (allocated(self%file)) new%file = self%file
      new%group = ''
      if (present(group)) new%group = group
      new%item = ''
      if (present(item)) new%item = item
      if (present(line)) new%line = line
      if (present(pointer)) then
         new%pointer = pointer
      else if (allocated(self%prefix) .and. len(new%group) > 0) then
         new%pointer = self%prefix//'/'//new%group
         if (len(new%item) > 0) new%pointer = new%pointer//'/'//new%item
      end if
      alike = 0
      do i = merge(0, self%count, level == level_remark), 1, -1
         associate (old => self%list(i))
            if (old%level /= level .or. old%code /= code) cycle
            if (old%file /= new%file .or. old%group /= new%group .or. old%item /= new%item) cycle
            if (old%more > 0) then
               old%more = old%more + 1
               return
            end if
            alike = alike + 1
         end associate
      end do
      if (self%count >= most_findings .and. level /= level_remark) then
         associate (final => self%list(self%count))
            if (final%more == 0 .or. len(final%group) > 0) &
               final = finding_t(final%level, final%code, 'and ', final%file, '', '', 0, max(1, final%more))
            final%level = max(final%level, level)
            final%code = max(final%code, code)
            final%more = final%more + 1
         end associate
         return
      end if
      if (alike == most_of_a_kind) then
         new%text = 'and '
         new%more = 1
      end if
      if (.not. allocated(self%list)) allocate (self%list(8))
      if (self%count == size(self%list)) then
         allocate (larger(2*size(self%list)))
         larger(:self%count) = self%list
         call move_alloc(larger, self%list)
      end if
      self%count = self%count + 1
      self%list(self%count) = new
   end subroutine append
end module psalm_status
