!> Where the values of a case were written: line, group and item of each element.
!>
!> What is assessed after reading (the topology, the search) names the line of the very value that is wrong. Elements that
!> follow each other on one line are one run, so that the table is no longer than the file. `error` and `warning` complain about
!> an element: they add a finding with its group, item and line.
module psalm_origin
   use psalm_status, only: diagnostics_t, level_error, level_warning
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: origins_t, name_length

   integer, parameter :: name_length = 31  !! longest name of a group or an item kept

   !> One mention of an item or a group.
   type :: mention_t
      character(name_length) :: group = '', item = '' !! item empty: the group itself
      integer :: line = 0
      logical :: list = .false.           !! of JSON: an array
      integer :: row = 0                  !! of an array with rows: this row, from 1
      integer :: base = 1                 !! the first element
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
      character(:), allocatable :: prefix !! of JSON: pointer to the case
   contains
      procedure :: clear
      procedure :: mention
      procedure :: place
      procedure :: use_pointers
      procedure :: as_list
      procedure :: pointer_to_last
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
      if (allocated(self%prefix)) deallocate (self%prefix)
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

   !> The case is JSON: places are reported as pointers, too.
   pure subroutine use_pointers(self, prefix)
      class(origins_t), intent(inout) :: self
      character(*), intent(in) :: prefix          !! of all pointers: empty, or that of the case

      self%prefix = prefix
   end subroutine use_pointers

   !> The item mentioned last is an array, or a row of one.
   pure subroutine as_list(self, row, base)
      class(origins_t), intent(inout) :: self
      integer, intent(in) :: row                  !! from 1; 0: there are no rows
      integer, intent(in) :: base                 !! its first element

      self%mentions(self%mentioned)%list = .true.
      self%mentions(self%mentioned)%row = row
      self%mentions(self%mentioned)%base = base
   end subroutine as_list

   !> Pointer to an element of the item mentioned last; not allocated if the case is no JSON.
   pure subroutine pointer_to_last(self, element, pointer)
      class(origins_t), intent(in) :: self
      integer, intent(in) :: element
      character(:), allocatable, intent(out) :: pointer

      if (allocated(self%prefix)) pointer = pointer_at(self, self%mentioned, element)
   end subroutine pointer_to_last

   !> Pointer to an element of a mention; 0: to the item.
   pure function pointer_at(self, m, element) result(pointer)
      class(origins_t), intent(in) :: self
      integer, intent(in) :: m, element
      character(:), allocatable :: pointer

      associate (mention => self%mentions(m))
         pointer = self%prefix//'/'//trim(mention%group)
         if (len_trim(mention%item) > 0) pointer = pointer//'/'//trim(mention%item)
         if (.not. mention%list .or. element == 0) return
         if (mention%row > 0) pointer = pointer//'/'//to_text(mention%row - 1)
         pointer = pointer//'/'//to_text(element - mention%base)
      end associate
   end function pointer_at

   !> Take over what another table holds.
   pure subroutine append(self, other)
      class(origins_t), intent(inout) :: self
      class(origins_t), intent(in) :: other
      integer :: k, m

      if (allocated(other%prefix)) self%prefix = other%prefix
      k = 1
      do m = 1, other%mentioned
         call self%mention(other%mentions(m)%group, other%mentions(m)%item, other%mentions(m)%line)
         self%mentions(self%mentioned) = other%mentions(m)
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
      character(:), allocatable :: pointer
      integer :: line

      if (findings%reported_enough(level_error, group, item)) then
         call findings%error(text, group=group, item=item)
      else
         call find(self, group, item, element, row, columns, line, pointer)
         call findings%error(text, line, group, item, pointer)
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
      character(:), allocatable :: pointer
      integer :: line

      if (findings%reported_enough(level_warning, group, item)) then
         call findings%warning(text, group=group, item=item)
      else
         call find(self, group, item, element, row, columns, line, pointer)
         call findings%warning(text, line, group, item, pointer)
      end if
   end subroutine warning

   !> Line of an element. What was not given has the line of its item, else of its group; 0: neither was given.
   pure integer function line(self, group, item, element)
      class(origins_t), intent(in) :: self
      character(*), intent(in) :: group, item
      integer, intent(in), optional :: element    !! from 1; absent: the item
      character(:), allocatable :: pointer

      call find(self, group, item, element, line=line, pointer=pointer)
   end function line

   !> Line of an element, or of one of a row, in the manner of `line`, and its pointer, not allocated if the case is no JSON.
   pure subroutine find(self, group, item, element, row, columns, line, pointer)
      class(origins_t), intent(in) :: self
      character(*), intent(in) :: group, item
      integer, intent(in), optional :: element, row, columns
      integer, intent(out) :: line
      character(:), allocatable, intent(out) :: pointer
      integer :: k, which

      line = 0
      ! what was written last counts
      if (present(element)) then
         which = element
         if (present(row)) which = (row - 1)*columns + element
         do k = self%ran, 1, -1
            if (which < self%runs(k)%first .or. which > self%runs(k)%last) cycle
            if (.not. named(self%runs(k)%mention, item)) cycle
            line = self%runs(k)%line
            if (allocated(self%prefix)) pointer = pointer_at(self, self%runs(k)%mention, which)
            return
         end do
      end if
      do k = self%mentioned, 1, -1
         if (named(k, item)) then
            line = self%mentions(k)%line
            if (allocated(self%prefix)) pointer = pointer_at(self, k, 0)
            return
         end if
      end do
      do k = 1, self%mentioned
         if (named(k, '')) line = self%mentions(k)%line
      end do
      if (.not. allocated(self%prefix)) return
      pointer = self%prefix//'/'//group
      if (len_trim(item) > 0) pointer = pointer//'/'//trim(item)

   contains

      pure logical function named(k, name)
         integer, intent(in) :: k
         character(*), intent(in) :: name

         named = self%mentions(k)%item == name
         if (named) named = self%mentions(k)%group == group
      end function named
   end subroutine find
end module psalm_origin
