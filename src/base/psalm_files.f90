!> The files of a run: written beside their places first, then all put in place together.
!>
!> If one cannot be written none is exchanged, and the files of an earlier run stay as they were. Signals wait from `begin` to
!> `finish`, so that no file of ours is left beside. No output takes the place of an input, of a read-only file, of a symbolic
!> link or of what is no file.
module psalm_files
   use psalm_status, only: exit_bad_input, exit_done, exit_file_error
   use psalm_system, only: identity_t, held_signals_t, same_file, look_at, lock_directory, keep_file, let_go, stage, move_file, &
                           remove_file, synchronize, error_text, kind_file, kind_directory, kind_link, kind_other
   implicit none (type, external)
   private
   public :: exchange_t, check_target, directory_of

   !> A file that waits beside its place.
   type :: staged_t
      character(:), allocatable :: path, beside
   end type staged_t

   !> Files to exchange. All lie in one directory.
   type :: exchange_t
      private
      type(staged_t), allocatable :: files(:)        !! room; the first `count` wait
      integer :: count = 0
      type(identity_t), allocatable :: inputs(:)     !! what the run reads
      type(held_signals_t) :: held
      integer :: lock = -1
      character(:), allocatable, public :: message   !! the first thing that went wrong, empty if none did
      integer, public :: code = exit_done            !! exit status it leads to
   contains
      procedure :: begin
      procedure :: add
      procedure :: finish
   end type exchange_t

contains

   !> Whether a run may write a file: `message` says why not, and what to do.
   subroutine check_target(path, inputs, message, code)
      character(*), intent(in) :: path
      type(identity_t), intent(in) :: inputs(:)        !! of the files that the run reads
      character(:), allocatable, intent(out) :: message !! empty: it may
      integer, intent(out) :: code                     !! exit status
      type(identity_t) :: identity
      integer :: kind
      logical :: writable

      call look_at(path, kind, identity, writable)
      code = exit_file_error
      message = ''
      select case (kind)
      case (kind_directory)
         message = "cannot write '"//path//"': it is a directory; move it away or choose another place with --output-dir DIR"
      case (kind_link)
         message = "cannot write '"//path//"': it is a symbolic link, which is neither replaced nor followed; remove it or "// &
                   "choose another place with --output-dir DIR"
      case (kind_other)
         message = "cannot write '"//path//"': it is not a regular file; move it away or choose another place with --output-dir DIR"
      case (kind_file)
         if (any(same_file(identity, inputs))) then
            code = exit_bad_input
            message = "'"//path//"' is in use by this run and would be overwritten: choose another place with "// &
                      "--output-dir DIR, or copy the input under another name"
         else if (.not. writable) then
            message = "cannot write '"//path//"': it is read-only or belongs to another user; make it writable (chmod u+w), "// &
                      "move it away or choose another place with --output-dir DIR"
         end if
      end select
      if (len(message) == 0) code = exit_done
   end subroutine check_target

   !> Begin: from here on signals wait, and other runs that want to write there.
   subroutine begin(self, directory, inputs)
      class(exchange_t), intent(inout) :: self
      character(*), intent(in) :: directory
      type(identity_t), intent(in) :: inputs(:)

      self%inputs = inputs
      self%message = ''
      self%code = exit_done
      self%count = 0
      if (allocated(self%files)) deallocate (self%files)
      allocate (self%files(8))
      call self%held%hold()
      call lock_directory(directory, self%lock)
   end subroutine begin

   !> Write a file beside its place. After a failure nothing more is written.
   subroutine add(self, path, text)
      class(exchange_t), intent(inout) :: self
      character(*), intent(in) :: path, text
      character(:), allocatable :: beside
      integer :: error

      if (self%code /= exit_done) return
      call check_target(path, self%inputs, self%message, self%code)
      if (self%code /= exit_done) return
      call stage(path, text, beside, error)
      if (error == 0) then
         call remember(self, path, beside)
      else
         call fail(self, path, error)
      end if
   end subroutine add

   !> Put all files in their places, or remove them if something went wrong; signals come through again.
   subroutine finish(self)
      class(exchange_t), intent(inout) :: self
      integer :: old(self%count)
      integer :: i, placed, error

      placed = 0
      ! all are on the disk before the first is put in its place; the first of these calls does most of the work for all
      do i = 1, self%count
         if (self%code /= exit_done) exit
         call synchronize(self%files(i)%beside, error)
         if (error /= 0) call fail(self, self%files(i)%path, error)
      end do
      if (self%code == exit_done) then
         do i = 1, self%count
            old(i) = keep_file(self%files(i)%path)
         end do
         do i = 1, self%count
            call move_file(self%files(i)%beside, self%files(i)%path, error)
            if (error /= 0) then
               call fail(self, self%files(i)%path, error)
               exit
            end if
            placed = i
         end do
         call let_go(old)
         if (placed > 0) then
            ! a directory that we may not read cannot be brought to the disk by us; the files are in their places all the same
            call synchronize(directory_of(self%files(1)%path), error)
         end if
      end if
      do i = placed + 1, self%count
         call remove_file(self%files(i)%beside)
      end do
      if (self%code /= exit_done .and. placed == 0) then
         self%message = self%message//'; no file of this run was written, existing files are unchanged'
      else if (self%code /= exit_done) then
         self%message = self%message//'; other files of this run were written'
      end if
      self%count = 0
      call let_go(self%lock)
      call self%held%release()
   end subroutine finish

   subroutine remember(self, path, beside)
      class(exchange_t), intent(inout) :: self
      character(*), intent(in) :: path, beside
      type(staged_t), allocatable :: more(:)
      integer :: i

      if (self%count == size(self%files)) then
         allocate (more(2*self%count))
         do i = 1, self%count
            call move_alloc(self%files(i)%path, more(i)%path)
            call move_alloc(self%files(i)%beside, more(i)%beside)
         end do
         call move_alloc(more, self%files)
      end if
      self%count = self%count + 1
      self%files(self%count)%path = path
      self%files(self%count)%beside = beside
   end subroutine remember

   subroutine fail(self, path, error)
      class(exchange_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer, intent(in) :: error

      self%message = "cannot write '"//path//"'"//error_text(error)
      self%code = exit_file_error
   end subroutine fail

   !> The directory part of a path, `.` if it has none.
   pure function directory_of(path) result(directory)
      character(*), intent(in) :: path
      character(:), allocatable :: directory
      integer :: slash

      slash = index(path, '/', back=.true.)
      directory = '.'
      if (slash > 0) directory = path(:slash)
   end function directory_of
end module psalm_files
