!> Where the values of a case were written: line, group and item of each element.
!>
!> What is judged after reading (the topology, the search) names the line of the very value that is wrong. Elements that
!> follow each other on one line are one run, so that the table is no longer than the file. `error` and `warning` complain about
!> an element: they add a finding with its group, item and line.
module psalm_origin
   use psalm_status, only: diagnostics_t, level_error, level_warning
   implicit none (type, external)
   private
   public :: origins_t, name_length

   integer, parameter :: name_length = 31  !! longest name of a group or an item kept

   !> One mention of an item or a group.
   type :: mention_t
      character(name_length) :: group = '', item = '' !! item empty: the group itself
      integer :: line = 0
   end type mention_t

   !> Elements of one line.
   type :: element_run_t
      integer :: mention = 0              !! index of the mention
      integer :: first = 0, last = 0      !! elements
      integer :: line = 0
   end type element_run_t

   !> The places of all values of a case.
   type :: origins_t
      private
      type(mention_t), allocatable :: mentions(:)
      type(element_run_t), allocatable :: runs(:)
      integer :: mentioned = 0, ran = 0   !! valid elements of `mentions` and `runs`
   contains
      procedure :: clear
      procedure :: mention
      procedure :: place
      procedure :: append
      procedure :: line
      procedure :: error
      procedure :: warning
   end type origins_t

contains

   !> Drop what was noted before.
   pure subroutine clear(self)
      class(origins_t), intent(inout) :: self

      if (allocated(self%mentions)) deallocate (self%mentions, self%runs)
      allocate (self%mentions(16), self%runs(16))
      self%mentioned = 0
      self%ran = 0
   end subroutine clear

   !> Note a group (`item` empty) or an item. The elements noted next are its.
   pure subroutine mention(self, group, item, line)
      class(origins_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      integer, intent(in) :: line
      type(mention_t), allocatable :: larger(:)

      if (.not. allocated(self%mentions)) call self%clear()
      if (self%mentioned == size(self%mentions)) then
         allocate (larger(2*self%mentioned))
         larger(:self%mentioned) = self%mentions
         call move_alloc(larger, self%mentions)
      end if
      self%mentioned = self%mentioned + 1
      self%mentions(self%mentioned) = mention_t(group, item, line)
   end subroutine mention

   !> Note elements `first` to `last` of the item mentioned last.
   pure subroutine place(self, first, last, line)
      class(origins_t), intent(inout) :: self
      integer, intent(in) :: first, last, line
      type(element_run_t), allocatable :: larger(:)

      if (self%ran > 0) then
         associate (run => self%runs(self%ran))
            if (run%mention == self%mentioned .and. run%line == line .and. run%last + 1 == first) then
               run%last = last
               return
            end if
         end associate
      end if
      if (self%ran == size(self%runs)) then
         allocate (larger(2*self%ran))
         larger(:self%ran) = self%runs
         call move_alloc(larger, self%runs)
      end if
      self%ran = self%ran + 1
      self%runs(self%ran) = element_run_t(self%mentioned, first, last, line)
   end subroutine place

   !> Take over what another table holds.
   pure subroutine append(self, other)
      class(origins_t), intent(inout) :: self
      class(origins_t), intent(in) :: other
      integer :: k, m

      k = 1
      do m = 1, other%mentioned
         call self%mention(other%mentions(m)%group, other%mentions(m)%item, other%mentions(m)%line)
         do while (k <= other%ran)
            if (other%runs(k)%mention /= m) exit
            call self%place(other%runs(k)%first, other%runs(k)%last, other%runs(k)%line)
            k = k + 1
         end do
      end do
   end subroutine append

   !> Add an error in an item, or in an element of it.
   pure subroutine error(self, findings, group, item, text, element, row, columns)
      class(origins_t), intent(in) :: self
      type(diagnostics_t), intent(inout) :: findings
      character(*), intent(in) :: group, item   !! item empty: the group itself
      character(*), intent(in) :: text
      integer, intent(in), optional :: element  !! from 1; absent: the item
      integer, intent(in), optional :: row, columns !! the element is one of this row, and rows are so long

      if (findings%told_enough(level_error, group, item)) then
         call findings%error(text, group=group, item=item)
      else
         call findings%error(text, line_of(self, group, item, element, row, columns), group, item)
      end if
   end subroutine error

   !> Add a warning, in the manner of `error`.
   pure subroutine warning(self, findings, group, item, text, element, row, columns)
      class(origins_t), intent(in) :: self
      type(diagnostics_t), intent(inout) :: findings
      character(*), intent(in) :: group, item   !! item empty: the group itself
      character(*), intent(in) :: text
      integer, intent(in), optional :: element  !! from 1; absent: the item
      integer, intent(in), optional :: row, columns !! the element is one of this row, and rows are so long

      if (findings%told_enough(level_warning, group, item)) then
         call findings%warning(text, group=group, item=item)
      else
         call findings%warning(text, line_of(self, group, item, element, row, columns), group, item)
      end if
   end subroutine warning

   pure integer function line_of(self, group, item, element, row, columns)
      class(origins_t), intent(in) :: self
      character(*), intent(in) :: group, item
      integer, intent(in), optional :: element, row, columns

      if (present(row)) then
         line_of = self%line(group, item, (row - 1)*columns + element)
      else
         line_of = self%line(group, item, element)
      end if
   end function line_of

   !> Line of an element. What was not given has the line of its item, else of its group; 0: neither was given.
   pure integer function line(self, group, item, element)
      class(origins_t), intent(in) :: self
      character(*), intent(in) :: group, item
      integer, intent(in), optional :: element    !! from 1; absent: the item
      integer :: k

      line = 0
      ! what was written last counts
      if (present(element)) then
         do k = self%ran, 1, -1
            if (element < self%runs(k)%first .or. element > self%runs(k)%last) cycle
            if (.not. named(self%runs(k)%mention, item)) cycle
            line = self%runs(k)%line
            return
         end do
      end if
      do k = self%mentioned, 1, -1
         if (named(k, item)) then
            line = self%mentions(k)%line
            return
         end if
      end do
      do k = 1, self%mentioned
         if (named(k, '')) line = self%mentions(k)%line
      end do

   contains

      pure logical function named(k, name)
         integer, intent(in) :: k
         character(*), intent(in) :: name

         named = self%mentions(k)%item == name
         if (named) named = self%mentions(k)%group == group
      end function named
   end function line
end module psalm_origin
