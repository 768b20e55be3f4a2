!> The operating system: files, signals, memory and threads, through the C border of psalm_border.c.
!>
!> Fortran output to a full disk can fail unseen when a unit is closed; here every failure is seen.
module psalm_system
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int64_t, c_long, c_null_char, c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64
   implicit none (type, external)
   private
   public :: identity_t, held_signals_t, same_file, identity_of, identity_of_open, look_at
   public :: lock_directory, keep_file, let_go, stage, move_file, remove_file, synchronize
   public :: make_directories, error_text
   public :: kind_none, kind_file, kind_directory, kind_link, kind_other, kind_unknown
   public :: read_input, input_valid, input_unreadable, input_directory, input_too_large, input_has_zero
   public :: begin_program, finish_program, write_standard_output, write_standard_error, error_is_terminal
   public :: memory_to_be_had, threads_to_be_had, hash
   public :: standard_input, standard_output, standard_error

   integer, parameter :: standard_input = 0, standard_output = 1, standard_error = 2 !! file descriptors
   ! what may stand at a path, as in psalm_border.c
   integer, parameter :: kind_none = 0       !! nothing
   integer, parameter :: kind_file = 1       !! a regular file
   integer, parameter :: kind_directory = 2
   integer, parameter :: kind_link = 3       !! a symbolic link
   integer, parameter :: kind_other = 4      !! a pipe, a device ...
   integer, parameter :: kind_unknown = 5    !! not to be seen
   integer, parameter :: input_valid = 0       !! verdicts on an input: text
   integer, parameter :: input_unreadable = 1
   integer, parameter :: input_directory = 2
   integer, parameter :: input_too_large = 3
   integer, parameter :: input_has_zero = 4    !! no text: it has a zero byte
   integer, parameter :: longest_path = 4096 !! PATH_MAX of Linux
   integer, parameter :: longest_error = 256
   integer, parameter :: no_memory = 12      !! ENOMEM of Linux
   integer, parameter :: mask_words = 32     !! a signal set is smaller in every C library

   !> What makes a file the same under every name: device and inode.
   type :: identity_t
      integer(c_int64_t) :: numbers(2) = 0_c_int64_t
      logical :: known = .false.
   end type identity_t

   !> Signals that wait while something is done that must not be cut short.
   type :: held_signals_t
      private
      integer(c_long) :: before(mask_words) = 0_c_long
      logical :: holds = .false.
   contains
      procedure :: hold => hold_signals
      procedure :: release => release_signals
   end type held_signals_t

   interface
      subroutine begin_program() bind(c, name='psalm_begin')
         implicit none (type, external)
      end subroutine begin_program

      subroutine c_finish(status) bind(c, name='psalm_finish')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: status
      end subroutine c_finish

      subroutine c_error_text(error, text, room) bind(c, name='psalm_error_text')
         import :: c_int, c_char, c_size_t
         implicit none (type, external)
         integer(c_int), value :: error
         character(kind=c_char), intent(inout) :: text(*)
         integer(c_size_t), value :: room
      end subroutine c_error_text

      integer(c_int) function c_read_input(path, most, bytes, count, error) bind(c, name='psalm_read_input')
         import :: c_int, c_char, c_int64_t, c_ptr
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int64_t), value :: most
         type(c_ptr), intent(out) :: bytes
         integer(c_int64_t), intent(out) :: count
         integer(c_int), intent(out) :: error
      end function c_read_input

      subroutine c_take_input(bytes, text, count) bind(c, name='psalm_take_input')
         import :: c_char, c_ptr, c_size_t
         implicit none (type, external)
         type(c_ptr), value :: bytes
         character(kind=c_char), intent(inout), optional :: text(*)
         integer(c_size_t), value :: count
      end subroutine c_take_input

      integer(c_int) function c_hold_signals(before, room) bind(c, name='psalm_hold_signals')
         import :: c_int, c_long, c_size_t
         implicit none (type, external)
         integer(c_long), intent(inout) :: before(*)
         integer(c_size_t), value :: room
      end function c_hold_signals

      integer(c_int) function c_restore_signals(before) bind(c, name='psalm_restore_signals')
         import :: c_int, c_long
         implicit none (type, external)
         integer(c_long), intent(in) :: before(*)
      end function c_restore_signals

      integer(c_int) function c_look_at(path, identity, writable) bind(c, name='psalm_look_at')
         import :: c_int, c_char, c_int64_t
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int64_t), intent(out) :: identity(2)
         integer(c_int), intent(out) :: writable
      end function c_look_at

      integer(c_int) function c_identity_of(path, identity) bind(c, name='psalm_identity_of')
         import :: c_int, c_char, c_int64_t
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int64_t), intent(inout) :: identity(2)
      end function c_identity_of

      integer(c_int) function c_identity_of_open(descriptor, identity) bind(c, name='psalm_identity_of_open')
         import :: c_int, c_int64_t
         implicit none (type, external)
         integer(c_int), value :: descriptor
         integer(c_int64_t), intent(inout) :: identity(2)
      end function c_identity_of_open

      integer(c_int) function c_stage(path, bytes, count, name, room) bind(c, name='psalm_stage')
         import :: c_int, c_char, c_size_t
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*), bytes(*)
         integer(c_size_t), value :: count, room
         character(kind=c_char), intent(inout) :: name(*)
      end function c_stage

      integer(c_int) function c_lock_directory(path) bind(c, name='psalm_lock_directory')
         import :: c_int, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
      end function c_lock_directory

      integer(c_int) function c_keep(path) bind(c, name='psalm_keep')
         import :: c_int, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
      end function c_keep

      subroutine c_let_go(file) bind(c, name='psalm_let_go')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: file
      end subroutine c_let_go

      integer(c_int) function c_make_directory(path) bind(c, name='psalm_make_directory')
         import :: c_int, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
      end function c_make_directory

      integer(c_int) function c_synchronize(path) bind(c, name='psalm_synchronize')
         import :: c_int, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
      end function c_synchronize

      integer(c_int) function c_rename(from, to) bind(c, name='psalm_rename')
         import :: c_int, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: from(*), to(*)
      end function c_rename

      integer(c_int) function c_remove(path) bind(c, name='psalm_remove')
         import :: c_int, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
      end function c_remove

      integer(c_int) function c_write(descriptor, bytes, count) bind(c, name='psalm_write')
         import :: c_int, c_size_t, c_char
         implicit none (type, external)
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(in) :: bytes(*)
         integer(c_size_t), value :: count
      end function c_write

      integer(c_int) function c_isatty(descriptor) bind(c, name='isatty')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: descriptor
      end function c_isatty

      integer(c_int) function c_memory_to_be_had(bytes) bind(c, name='psalm_memory_to_be_had')
         import :: c_int, c_int64_t
         implicit none (type, external)
         integer(c_int64_t), value :: bytes
      end function c_memory_to_be_had

      integer(c_int) function c_threads_to_be_had(wanted) bind(c, name='psalm_threads_to_be_had')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: wanted
      end function c_threads_to_be_had

      pure integer(c_int64_t) function c_hash(state, bytes, count) bind(c, name='psalm_hash')
         import :: c_int64_t, c_char, c_size_t
         implicit none (type, external)
         integer(c_int64_t), value :: state
         character(kind=c_char), intent(in) :: bytes(*)
         integer(c_size_t), value :: count
      end function c_hash
   end interface

contains

   !> Last of all: end the program with this status. `begin_program` must have been called, first of all: it makes writes that go
   !> too far or into a closed pipe fail instead of killing, and gives status 3 to an end by the run-time library.
   subroutine finish_program(status)
      integer, intent(in) :: status

      call c_finish(int(status, c_int))
   end subroutine finish_program

   !> An error number in words, as `: No space left on device`; empty for 0.
   function error_text(error) result(text)
      integer, intent(in) :: error
      character(:), allocatable :: text
      character(kind=c_char) :: room(longest_error)

      text = ''
      if (error == 0) return
      room = c_null_char
      call c_error_text(int(error, c_int), room, int(longest_error, c_size_t))
      text = ': '//from_c(room)
   end function error_text

   ! ---- signals -----------------------------------------------------------------------------------------------------

   !> Let all signals wait in this thread that can.
   subroutine hold_signals(self)
      class(held_signals_t), intent(inout) :: self

      if (self%holds) return
      self%holds = c_hold_signals(self%before, int(mask_words*(storage_size(self%before)/8), c_size_t)) == 0
   end subroutine hold_signals

   !> Let them through again.
   subroutine release_signals(self)
      class(held_signals_t), intent(inout) :: self

      if (.not. self%holds) return
      self%holds = c_restore_signals(self%before) /= 0
   end subroutine release_signals

   ! ---- files -------------------------------------------------------------------------------------------------------

   elemental logical function same_file(one, other)
      type(identity_t), intent(in) :: one, other

      same_file = one%known .and. other%known .and. all(one%numbers == other%numbers)
   end function same_file

   !> Identity of the file that a path leads to, links followed; not known if there is none.
   function identity_of(path) result(identity)
      character(*), intent(in) :: path
      type(identity_t) :: identity

      identity%known = c_identity_of(path//c_null_char, identity%numbers) == 0
   end function identity_of

   !> Identity of the regular file that a descriptor is open on.
   function identity_of_open(descriptor) result(identity)
      integer, intent(in) :: descriptor
      type(identity_t) :: identity

      identity%known = c_identity_of_open(int(descriptor, c_int), identity%numbers) == 0
   end function identity_of_open

   !> What stands at a path itself. `writable`: a file that is not marked read-only and that we may write.
   subroutine look_at(path, kind, identity, writable)
      character(*), intent(in) :: path
      integer, intent(out) :: kind             !! kind_none ...
      type(identity_t), intent(out) :: identity
      logical, intent(out) :: writable
      integer(c_int) :: can

      kind = c_look_at(path//c_null_char, identity%numbers, can)
      identity%known = kind /= kind_none .and. kind /= kind_unknown
      writable = can /= 0
   end subroutine look_at

   !> Keep other runs from writing in a directory and remove what killed ones have left there; `lock` is for `let_go`.
   !>
   !> Where locks are not to be had the run goes on without.
   subroutine lock_directory(path, lock)
      character(*), intent(in) :: path
      integer, intent(out) :: lock

      lock = c_lock_directory(path//c_null_char)
   end subroutine lock_directory

   !> Keep the file at a path, if there is one, until `let_go`: a file that takes its place then does so at once.
   integer function keep_file(path)
      character(*), intent(in) :: path

      keep_file = c_keep(path//c_null_char)
   end function keep_file

   !> Let go of a lock or of a file that was kept.
   impure elemental subroutine let_go(held)
      integer, intent(in) :: held

      call c_let_go(int(held, c_int))
   end subroutine let_go

   !> All bytes of a file, or of standard input (`-`), which may be a pipe or a device without end: reading stops after `most` bytes
   !> and at the first zero byte, with the text so far.
   subroutine read_input(path, most, text, verdict, error)
      character(*), intent(in) :: path
      integer, intent(in) :: most                     !! bytes
      character(:), allocatable, intent(out) :: text
      integer, intent(out) :: verdict                 !! input_valid ...
      integer, intent(out) :: error                   !! error number with input_unreadable, else 0
      type(c_ptr) :: bytes
      integer(c_int64_t) :: count
      integer(c_int) :: number
      integer :: status

      verdict = c_read_input(path//c_null_char, int(most, c_int64_t), bytes, count, number)
      error = number
      if (verdict /= input_valid .and. verdict /= input_has_zero) count = 0_c_int64_t
      allocate (character(count) :: text, stat=status)
      if (status == 0) then
         call c_take_input(bytes, text, int(count, c_size_t))
      else
         call c_take_input(bytes, count=0_c_size_t)
         verdict = input_unreadable
         error = no_memory
         text = ''
      end if
   end subroutine read_input

   !> Write a file of our own beside a path; `name` is its name. Errors: nothing is left then.
   subroutine stage(path, text, name, error)
      character(*), intent(in) :: path, text
      character(:), allocatable, intent(out) :: name
      integer, intent(out) :: error            !! 0 or an error number
      character(kind=c_char) :: room(longest_path)

      room = c_null_char
      error = c_stage(path//c_null_char, text, len(text, c_size_t), room, int(longest_path, c_size_t))
      name = from_c(room)
   end subroutine stage

   !> Make a directory and those above it; existing ones are as good.
   subroutine make_directories(path, error)
      character(*), intent(in) :: path
      integer, intent(out) :: error            !! 0 or an error number
      integer :: i

      error = 0
      do i = 2, len(path)
         if (path(i:i) /= '/' .or. path(i - 1:i - 1) == '/') cycle
         error = c_make_directory(path(:i - 1)//c_null_char)
         if (error /= 0) return
      end do
      error = c_make_directory(path//c_null_char)
   end subroutine make_directories

   !> Give a file another name, in place of a file that has it.
   subroutine move_file(from, to, error)
      character(*), intent(in) :: from, to
      integer, intent(out) :: error            !! 0 or an error number

      error = c_rename(from//c_null_char, to//c_null_char)
   end subroutine move_file

   !> Remove a file or an empty directory, if it is there.
   subroutine remove_file(path)
      character(*), intent(in) :: path

      if (c_remove(path//c_null_char) /= 0) return
   end subroutine remove_file

   !> Bring a file or a directory to the disk.
   subroutine synchronize(path, error)
      character(*), intent(in) :: path
      integer, intent(out) :: error            !! 0 or an error number

      error = c_synchronize(path//c_null_char)
   end subroutine synchronize

   !> Write to standard output; `done` is false if it takes no more.
   subroutine write_standard_output(text, done)
      character(*), intent(in) :: text
      logical, intent(out) :: done

      done = c_write(int(standard_output, c_int), text, len(text, c_size_t)) == 0
   end subroutine write_standard_output

   !> Write to standard error, whatever becomes of it.
   subroutine write_standard_error(text)
      character(*), intent(in) :: text

      if (c_write(int(standard_error, c_int), text, len(text, c_size_t)) /= 0) return
   end subroutine write_standard_error

   !> True if standard error is a terminal.
   logical function error_is_terminal()

      error_is_terminal = c_isatty(int(standard_error, c_int)) == 1
   end function error_is_terminal

   ! ---- memory, threads, marks --------------------------------------------------------------------------------------

   !> True if so many bytes can be had now.
   logical function memory_to_be_had(bytes)
      integer(int64), intent(in) :: bytes

      memory_to_be_had = c_memory_to_be_had(int(bytes, c_int64_t)) /= 0
   end function memory_to_be_had

   !> Threads to work with where `wanted` are asked for. They are tried out, for OpenMP ends the program if it cannot have them; if
   !> there are fewer, half of those is taken, so that stacks leave room for the work.
   integer function threads_to_be_had(wanted) result(threads)
      integer, intent(in) :: wanted

      threads = c_threads_to_be_had(int(wanted, c_int))
      if (threads < wanted) threads = max(1, threads/2)
   end function threads_to_be_had

   !> Go on with a 64-bit hash (FNV-1a).
   pure integer(int64) function hash(state, text)
      integer(int64), intent(in) :: state
      character(*), intent(in) :: text

      hash = c_hash(int(state, c_int64_t), text, len(text, c_size_t))
   end function hash

   pure function from_c(room) result(text)
      character(kind=c_char), intent(in) :: room(:)   !! ended by a zero byte
      character(:), allocatable :: text
      integer :: i, length

      length = findloc(room, c_null_char, dim=1) - 1
      if (length < 0) length = size(room)
      allocate (character(length) :: text)
      do i = 1, length
         text(i:i) = room(i)
      end do
   end function from_c
end module psalm_system
