!> Where the values of a case were written: line, group and item of each element.
!>
!> What is judged after reading (the topology, the search) names the line of the very value that is wrong. Elements that
!> follow each other on one line are one run, so that the table is no longer than the file.
module psalm_origin
   implicit none (type, external)
   private
   public :: origin_t, origins_t
   public :: name_length

   integer, parameter :: name_length = 31  !! longest name of a group or an item kept

   !> The place of one value.
   type :: origin_t
      character(:), allocatable :: file   !! name of the file
      character(:), allocatable :: group  !! in capitals, without `&`
      character(:), allocatable :: item   !! in capitals
      integer :: line = 0                 !! of the value; of the item or the group where the value is not given; 0: none
   end type origin_t

   !> One mention of an item or a group.
   type :: mention_t
      character(name_length) :: group = '', item = '' !! item empty: the group itself
      integer :: line = 0
   end type mention_t

   !> Elements of one line.
   type :: run_t
      integer :: mention = 0              !! index of the mention
      integer :: first = 0, last = 0      !! elements
      integer :: line = 0
   end type run_t

   !> The places of all values of a case.
   type :: origins_t
      private
      character(:), allocatable :: file
      type(mention_t), allocatable :: mentions(:)
      type(run_t), allocatable :: runs(:)
      integer :: mentioned = 0, ran = 0   !! valid elements of `mentions` and `runs`
   contains
      procedure :: in_file
      procedure :: mention
      procedure :: place
      procedure :: append
      procedure :: of
      procedure :: line
   end type origins_t

contains

   !> Name the file; what was noted before is dropped.
   pure subroutine in_file(self, file)
      class(origins_t), intent(inout) :: self
      character(*), intent(in) :: file

      self%file = file
      if (allocated(self%mentions)) deallocate (self%mentions, self%runs)
      allocate (self%mentions(16), self%runs(16))
      self%mentioned = 0
      self%ran = 0
   end subroutine in_file

   !> Note a group (`item` empty) or an item. The elements noted next are its.
   pure subroutine mention(self, group, item, line)
      class(origins_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      integer, intent(in) :: line
      type(mention_t), allocatable :: larger(:)

      if (.not. allocated(self%mentions)) call self%in_file('')
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
      type(run_t), allocatable :: larger(:)

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
      self%runs(self%ran) = run_t(self%mentioned, first, last, line)
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

   !> Place of an element. What was not given has the line of its item, else of its group.
   pure function of(self, group, item, element) result(origin)
      class(origins_t), intent(in) :: self
      character(*), intent(in) :: group, item
      integer, intent(in) :: element    !! from 1; 0: the item
      type(origin_t) :: origin

      origin%file = ''
      if (allocated(self%file)) origin%file = self%file
      origin%group = group
      origin%item = item
      origin%line = self%line(group, item, element)
   end function of

   !> Line of an element, in the manner of `of`.
   pure integer function line(self, group, item, element)
      class(origins_t), intent(in) :: self
      character(*), intent(in) :: group, item
      integer, intent(in), optional :: element
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
