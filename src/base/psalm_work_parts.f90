!> Parts of a run in files: what numbered items have led to, so that other runs of the same case go on from there.
!>
!> A part K of N makes every N-th item of the first batch that is not known yet, from the K-th on, and ends where it needs what the
!> other parts have made. A run that makes all items itself writes them now and then, to be gone on with after it was killed. The
!> files are the same in both cases: CASE.part1, CASE.part2 and so on; whoever reads them reads all.
!>
!> The file (doc/manual/parts.md): a line `PSALM parts 1`; `run MARK`; `part K of N`; for each batch a line
!> `batch CASE ORDINAL LABEL ITEMS` and a line for each item, `ITEM COUNT` and so many numbers, with all their digits; at last
!> `end`.
module psalm_work_parts
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_files, only: exchange_t, directory_of
   use psalm_kinds, only: wp
   use psalm_shared_work, only: sharing_t
   use psalm_status, only: exit_bad_input, exit_done
   use psalm_system, only: identity_t, input_valid, read_input, remove_file
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: parts_t, part_name
   public :: all_of_it, one_part, known_only

   integer, parameter :: all_of_it = 1        !! what others have not made is made here
   integer, parameter :: one_part = 2         !! a part is made, what goes beyond it is left
   integer, parameter :: known_only = 3       !! nothing is made: what others have made counts

   integer, parameter :: looked_for = 64      !! files of parts are looked for up to this number, or that of parts that one tells
   integer, parameter :: most_bytes = huge(1) !! of a file
   real(wp), parameter :: largest_whole = 1.0e9_wp !! whole numbers below it are written as such
   ! so many digits after the point tell every number apart
   integer, parameter :: decimals = max(16, 1 + int(real(digits(1.0_wp))*log10(2.0)))
   integer, parameter :: width = decimals + 10
   character(*), parameter :: number_format = merge('(es26.16e4)', '(es45.35e4)', decimals == 16)
   character(*), parameter :: first_line = 'PSALM parts 1', last_line = 'end'
   character(*), parameter :: nl = new_line('a')

   !> What an item led to; not allocated: it is not known.
   type :: made_t
      real(wp), allocatable :: numbers(:)
      logical :: own = .false.                !! goes into the file of this run
   end type made_t

   type :: batch_t
      character(:), allocatable :: label
      integer :: of_case = 0, ordinal = 0
      logical :: passing = .false.            !! depends on when the run had to end, or is too large: not for a file
      logical :: forgotten = .false.          !! when the next begins
      type(made_t), allocatable :: items(:)
   end type batch_t

   type, extends(sharing_t) :: parts_t
      integer :: mode = all_of_it
      integer :: part = 1, parts = 1          !! of this run
      integer :: every = 0                    !! seconds between two files; 0: one at the end
      logical :: incomplete = .false.         !! of this case: items are missing that others are to make
      logical :: ever_incomplete = .false.    !! of any case
      logical :: ever_short = .false.         !! a batch was closed without all of its items, or a stop was seen
      integer :: opened = 0                   !! batches
      integer :: made = 0                     !! items made by this run
      integer :: missing = 0                  !! items of the batches that are left to others
      logical :: within = .false.             !! a batch is open
      integer :: now = 0                      !! the batch; 0: none may be made
      character(:), allocatable :: stem       !! of the files' names
      character(:), allocatable :: message    !! what went wrong when a file was written; empty: nothing
      integer :: code = exit_done             !! and the exit status it leads to
      type(batch_t), allocatable, private :: batches(:) !! room; the first `count` are used
      integer, private :: count = 0, cursor = 0, of_case = 0, ordinal = 0, highest = 0
      logical, private :: sealed = .false.    !! of this case: what follows depends on when the run had to end
      integer(int64), private :: written = 0_int64
      character(:), allocatable, private :: mark
      type(identity_t), allocatable, private :: inputs(:)
   contains
      procedure :: begin
      procedure :: begin_case
      procedure :: read_all
      procedure :: take_text
      procedure :: found
      procedure :: is_known
      procedure :: items
      procedure :: put
      procedure :: write_file
      procedure :: remove_files
      procedure :: open => open_batch
      procedure :: next => next_item
      procedure :: keep
      procedure :: close => close_batch
      procedure :: take
      procedure :: agree
      procedure :: ends
      procedure :: members
   end type parts_t

contains

   !> Begin a run.
   subroutine begin(self, stem, mark, inputs)
      class(parts_t), intent(inout) :: self
      character(*), intent(in) :: stem                !! of the files' names
      character(*), intent(in) :: mark                !! of the run: files of other runs are refused
      type(identity_t), intent(in) :: inputs(:)       !! of the files that the run reads

      self%stem = stem
      self%mark = mark
      self%inputs = inputs
      self%message = ''
      self%count = 0
      self%highest = self%parts
      self%now = 0
      if (allocated(self%batches)) deallocate (self%batches)
      allocate (self%batches(8))
      self%ever_incomplete = .false.
      self%ever_short = .false.
      self%opened = 0
      self%made = 0
      self%missing = 0
      call system_clock(self%written)
      call self%begin_case(0)
   end subroutine begin

   !> Begin the work of a case; 0: that of all together.
   subroutine begin_case(self, number)
      class(parts_t), intent(inout) :: self
      integer, intent(in) :: number

      call forget(self)
      self%of_case = number
      self%ordinal = 0
      self%incomplete = .false.
      self%sealed = .false.
      self%within = .false.
      self%now = 0
   end subroutine begin_case

   !> Read the files of all parts that there are.
   subroutine read_all(self, files, message)
      class(parts_t), intent(inout) :: self
      integer, intent(out) :: files                   !! how many there are
      character(:), allocatable, intent(out) :: message !! what is wrong with one; empty: nothing
      character(:), allocatable :: text
      integer :: k

      files = 0
      message = ''
      k = 0
      do while (k < max(looked_for, self%highest) .and. len(message) == 0)
         k = k + 1
         call self%found(k, text, message)
         if (.not. allocated(text)) cycle
         files = files + 1
         call self%take_text(text, k, message)
      end do
   end subroutine read_all

   !> The file of a part; not allocated if there is none.
   subroutine found(self, number, text, message)
      class(parts_t), intent(in) :: self
      integer, intent(in) :: number
      character(:), allocatable, intent(out) :: text
      character(:), allocatable, intent(out) :: message !! it cannot be read; empty: it can
      integer :: verdict, error
      logical :: there

      message = ''
      inquire (file=part_name(self%stem, number), exist=there)
      if (.not. there) return
      call read_input(part_name(self%stem, number), most_bytes, text, verdict, error)
      if (verdict == input_valid) return
      message = "cannot read '"//part_name(self%stem, number)//"'"
      deallocate (text)
   end subroutine found

   !> Take in what a file says.
   subroutine take_text(self, text, number, message)
      class(parts_t), intent(inout) :: self
      character(*), intent(in) :: text
      integer, intent(in) :: number                   !! of the part
      character(:), allocatable, intent(out) :: message !! what is wrong; empty: nothing
      character(80) :: word, label
      logical :: valid
      integer :: from, upto, status, of, part, of_case, ordinal, items, item, count, batch
      real(wp), allocatable :: numbers(:)

      message = ''
      upto = -1
      batch = 0
      if (next_line() /= first_line) then
         message = 'is no file of a part'
      else if (next_line() /= 'run '//self%mark) then
         message = 'belongs to another run: the case or the version of the program has changed since; remove the file'
      else
         word = next_line()
         read (text(from:upto), *, iostat=status) word, part, label, of
         if (status /= 0) message = 'is damaged in its third line'
         if (status == 0) self%highest = max(self%highest, of)
      end if
      do while (len(message) == 0)
         if (next_line() == last_line) exit
         if (upto < from) then
            message = 'ends early'
         else if (text(from:min(upto, from + 4)) == 'batch') then
            read (text(from:upto), *, iostat=status) word, of_case, ordinal, label, items
            if (status == 0) then
               batch = place_of(self, of_case, ordinal)
               if (batch == 0) call add_batch(self, of_case, ordinal, trim(label), items, batch)
               if (size(self%batches(batch)%items) /= items) status = 1
            end if
            if (status /= 0) message = 'is damaged: '//text(from:min(upto, from + 60))
         else
            valid = .false.
            read (text(from:upto), *, iostat=status) item, count
            if (status == 0 .and. batch > 0) valid = item > 0 .and. count > 0
            if (valid) valid = item <= size(self%batches(batch)%items) .and. count <= upto - from
            if (valid) then
               allocate (numbers(count))
               read (text(from:upto), *, iostat=status) item, count, numbers
               valid = status == 0
            end if
            if (.not. valid) then
               message = 'is damaged: '//text(from:min(upto, from + 60))
            else
               self%batches(batch)%items(item)%own = self%batches(batch)%items(item)%own .or. number == self%part
               call move_alloc(numbers, self%batches(batch)%items(item)%numbers)
            end if
         end if
      end do
      if (len(message) > 0) message = "'"//part_name(self%stem, number)//"' "//message

   contains

      !> The next line, or what matters here of its beginning; it stands from `from` to `upto`.
      character(80) function next_line()
         from = upto + 2
         upto = from + index(text(from:), nl) - 2
         next_line = text(from:max(upto, from - 1))
      end function next_line
   end subroutine take_text

   !> The batch of a case; 0: there is none.
   pure integer function place_of(self, of_case, ordinal) result(place)
      class(parts_t), intent(in) :: self
      integer, intent(in) :: of_case, ordinal

      do place = self%count, 1, -1
         if (self%batches(place)%of_case == of_case .and. self%batches(place)%ordinal == ordinal) return
      end do
   end function place_of

   subroutine add_batch(self, of_case, ordinal, label, items, place)
      class(parts_t), intent(inout) :: self
      integer, intent(in) :: of_case, ordinal, items
      character(*), intent(in) :: label
      integer, intent(out) :: place
      type(batch_t), allocatable :: more(:)
      integer :: i

      if (self%count == size(self%batches)) then
         allocate (more(2*self%count))
         do i = 1, self%count
            call move_alloc(self%batches(i)%label, more(i)%label)
            call move_alloc(self%batches(i)%items, more(i)%items)
            more(i)%of_case = self%batches(i)%of_case
            more(i)%ordinal = self%batches(i)%ordinal
            more(i)%passing = self%batches(i)%passing
            more(i)%forgotten = self%batches(i)%forgotten
         end do
         call move_alloc(more, self%batches)
      end if
      self%count = self%count + 1
      place = self%count
      call renew(self%batches(place), of_case, ordinal, label, items)
   end subroutine add_batch

   !> Make a batch that knows nothing.
   pure subroutine renew(batch, of_case, ordinal, label, items)
      type(batch_t), intent(inout) :: batch
      integer, intent(in) :: of_case, ordinal, items
      character(*), intent(in) :: label

      batch%label = label
      batch%of_case = of_case
      batch%ordinal = ordinal
      batch%passing = .false.
      batch%forgotten = .false.
      if (allocated(batch%items)) deallocate (batch%items)
      allocate (batch%items(items))
   end subroutine renew

   !> Items of the batch at hand.
   pure integer function items(self)
      class(parts_t), intent(in) :: self

      items = 0
      if (self%now > 0) items = size(self%batches(self%now)%items)
   end function items

   !> True if it is known what an item of the batch at hand leads to.
   pure logical function is_known(self, item)
      class(parts_t), intent(in) :: self
      integer, intent(in) :: item

      is_known = allocated(self%batches(self%now)%items(item)%numbers)
   end function is_known

   !> What another has made of the batch at hand.
   pure subroutine put(self, item, numbers)
      class(parts_t), intent(inout) :: self
      integer, intent(in) :: item
      real(wp), intent(in) :: numbers(:)

      self%batches(self%now)%items(item)%numbers = numbers
   end subroutine put

   !> Write what this run has made. A file is written whole or not at all.
   subroutine write_file(self)
      class(parts_t), intent(inout) :: self
      type(exchange_t) :: files
      type(text_t) :: text
      integer :: b, i

      call text%add(first_line)
      call text%add('run '//self%mark)
      call text%add('part '//to_text(self%part)//' of '//to_text(self%parts))
      do b = 1, self%count
         associate (batch => self%batches(b))
            if (batch%passing) cycle
            if (.not. any(batch%items%own)) cycle
            call text%add('batch '//to_text(batch%of_case)//' '//to_text(batch%ordinal)//' '//batch%label//' '// &
                          to_text(size(batch%items)))
            do i = 1, size(batch%items)
               if (batch%items(i)%own) call add_numbers(i, batch%items(i)%numbers, text)
            end do
         end associate
      end do
      call text%add(last_line)
      call files%begin(directory_of(self%stem), self%inputs)
      call files%add(part_name(self%stem, self%part), text%content())
      call files%finish()
      self%message = files%message
      self%code = files%code
      call system_clock(self%written)
   end subroutine write_file

   !> A line of numbers with all their digits.
   pure subroutine add_numbers(item, numbers, text)
      integer, intent(in) :: item
      real(wp), intent(in) :: numbers(:)
      type(text_t), intent(inout) :: text
      character(width*size(numbers)) :: line
      integer :: i, at

      at = 0
      do i = 1, size(numbers)
         associate (number => numbers(i), field => line(at + 1:at + width))
            if (abs(number) < largest_whole .and. number == aint(number) .and. &
                .not. (number == 0.0_wp .and. sign(1.0_wp, number) < 0.0_wp)) then
               write (field, '(i0)') int(number)
            else
               write (field, number_format) number
            end if
            at = at + len_trim(field) + 1
            line(at:at) = ' '
         end associate
      end do
      call text%add(to_text(item)//' '//to_text(size(numbers))//' '//line(:at))
   end subroutine add_numbers

   !> Remove the files of all parts that this run has read or written.
   subroutine remove_files(self)
      class(parts_t), intent(in) :: self
      integer :: k
      logical :: there

      do k = 1, max(looked_for, self%highest)
         inquire (file=part_name(self%stem, k), exist=there)
         if (there) call remove_file(part_name(self%stem, k))
      end do
   end subroutine remove_files

   !> The file of a part.
   pure function part_name(stem, part) result(name)
      character(*), intent(in) :: stem
      integer, intent(in) :: part
      character(:), allocatable :: name

      name = stem//'.part'//to_text(part)
   end function part_name

   !> Forget the batch at hand if it asked for that.
   pure subroutine forget(self)
      class(parts_t), intent(inout) :: self

      if (self%now == 0) return
      associate (batch => self%batches(self%now))
         if (.not. batch%forgotten) return
         call renew(batch, batch%of_case, batch%ordinal, 'forgotten', 0)
      end associate
      if (self%now == self%count) self%count = self%count - 1
   end subroutine forget

   !> Begin a batch: what files know of it is known.
   subroutine open_batch(self, label, items, passing)
      class(parts_t), intent(inout) :: self
      character(*), intent(in) :: label
      integer, intent(in) :: items
      logical, intent(in) :: passing

      call forget(self)
      self%ordinal = self%ordinal + 1
      self%cursor = 0
      self%now = 0
      if (self%incomplete) return
      self%opened = self%opened + 1
      self%within = .true.
      self%now = place_of(self, self%of_case, self%ordinal)
      if (self%now == 0) then
         call add_batch(self, self%of_case, self%ordinal, label, items, self%now)
      else
         associate (batch => self%batches(self%now))
            ! a run that had to end at another time went another way: what followed is not ours
            if (self%sealed .or. batch%label /= label .or. size(batch%items) /= items) &
               call renew(batch, self%of_case, self%ordinal, label, items)
         end associate
      end if
      self%batches(self%now)%passing = self%sealed .or. passing
      self%batches(self%now)%forgotten = passing
   end subroutine open_batch

   !> The next item that is not known and that this run is to make.
   integer function next_item(self) result(item)
      class(parts_t), intent(inout) :: self

      item = 0
      if (self%now == 0 .or. self%mode == known_only) return
      !$omp critical (psalm_work_parts)
      do while (self%cursor < self%items())
         self%cursor = self%cursor + 1
         if (self%is_known(self%cursor)) cycle
         if (self%mode == one_part .and. modulo(self%cursor - self%part, self%parts) /= 0) cycle
         item = self%cursor
         exit
      end do
      !$omp end critical (psalm_work_parts)
   end function next_item

   !> Keep what an item led to; now and then all is written.
   subroutine keep(self, item, numbers)
      class(parts_t), intent(inout) :: self
      integer, intent(in) :: item
      real(wp), intent(in) :: numbers(:)
      integer(int64) :: clock, rate

      if (self%now == 0) return
      !$omp critical (psalm_work_parts)
      self%batches(self%now)%items(item)%numbers = numbers
      self%batches(self%now)%items(item)%own = .true.
      self%made = self%made + 1
      if (self%every > 0) then
         call system_clock(clock, rate)
         if (clock - self%written >= int(self%every, int64)*rate) call self%write_file()
      end if
      !$omp end critical (psalm_work_parts)
   end subroutine keep

   !> End a batch. Where others are to make what is missing, the case ends here.
   subroutine close_batch(self)
      class(parts_t), intent(inout) :: self
      integer :: i, missing

      self%within = .false.
      if (self%now == 0) return
      missing = count([(.not. self%is_known(i), i=1, self%items())])
      if (missing == 0) return
      self%sealed = .true.
      self%ever_short = .true.
      if (self%mode == all_of_it) return
      self%incomplete = .true.
      self%ever_incomplete = .true.
      self%missing = self%missing + missing
   end subroutine close_batch

   !> What is known of an item of the batch at hand.
   subroutine take(self, item, numbers)
      class(parts_t), intent(in) :: self
      integer, intent(in) :: item
      real(wp), allocatable, intent(out) :: numbers(:)

      if (self%now == 0) return
      if (self%is_known(item)) numbers = self%batches(self%now)%items(item)%numbers
   end subroutine take

   !> A case ends where others are to go on. What follows a stop is not what a run without one would have made.
   logical function agree(self, waiting)
      class(parts_t), intent(inout) :: self
      logical, intent(in) :: waiting

      agree = waiting .or. self%incomplete
      if (.not. agree) return
      !$omp critical (psalm_work_parts)
      self%sealed = .true.
      self%ever_short = .true.
      !$omp end critical (psalm_work_parts)
   end function agree

   !> True if the case ends where others are to go on.
   pure logical function ends(self)
      class(parts_t), intent(in) :: self

      ends = self%incomplete
   end function ends

   !> One run makes the items of one part.
   integer function members(self)
      class(parts_t), intent(in) :: self

      members = merge(self%parts, 1, self%mode == one_part)
   end function members
end module psalm_work_parts
