!> Work in numbered items that others may do a part of: what an item leads to depends on its number alone (and on what was known
!> before the first of them was begun).
!>
!> A study opens a batch, asks for one item after another until none is left, hands over what each led to as numbers, closes the
!> batch and takes the numbers of all items. Who does which item, and how the numbers come from one to the other, is the host's:
!> files of parts (`psalm_work_parts`), ranks of a job (the package `cluster`). All who share the work run the same study, so that
!> they open the same batches in the same order.
module psalm_shared_work
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: sharing_t

   type, abstract :: sharing_t
   contains
      procedure(open_i), deferred :: open
      procedure(next_i), deferred :: next
      procedure(keep_i), deferred :: keep
      procedure(close_i), deferred :: close
      procedure(take_i), deferred :: take
      procedure(agree_i), deferred :: agree
      procedure(ends_i), deferred :: ends
      procedure(members_i), deferred :: members
   end type sharing_t

   abstract interface
      !> Begin a batch. Called from one thread.
      subroutine open_i(self, label, items, passing)
         import :: sharing_t
         implicit none (type, external)
         class(sharing_t), intent(inout) :: self
         character(*), intent(in) :: label              !! what the items are, one word
         integer, intent(in) :: items
         logical, intent(in) :: passing                 !! forgotten when the next begins, and in no file: it is too large
      end subroutine open_i

      !> An item that is to be done here and now; 0: none is left. Called from several threads at once.
      integer function next_i(self)
         import :: sharing_t
         implicit none (type, external)
         class(sharing_t), intent(inout) :: self
      end function next_i

      !> What an item led to. Called from several threads at once; never for an item that was cut short.
      subroutine keep_i(self, item, numbers)
         import :: sharing_t, wp
         implicit none (type, external)
         class(sharing_t), intent(inout) :: self
         integer, intent(in) :: item
         real(wp), intent(in) :: numbers(:)
      end subroutine keep_i

      !> End a batch: what others have done becomes known. Called from one thread.
      subroutine close_i(self)
         import :: sharing_t
         implicit none (type, external)
         class(sharing_t), intent(inout) :: self
      end subroutine close_i

      !> What an item of the batch closed last led to; not allocated: it is not known.
      subroutine take_i(self, item, numbers)
         import :: sharing_t, wp
         implicit none (type, external)
         class(sharing_t), intent(in) :: self
         integer, intent(in) :: item
         real(wp), allocatable, intent(out) :: numbers(:)
      end subroutine take_i

      !> Whether all are to end, if one of them finds that it is to end (or not). Within a batch called by several threads at once.
      logical function agree_i(self, waiting)
         import :: sharing_t
         implicit none (type, external)
         class(sharing_t), intent(inout) :: self
         logical, intent(in) :: waiting
      end function agree_i

      !> True if the study is to end because others must go on first, or because one of them was asked to end.
      pure logical function ends_i(self)
         import :: sharing_t
         implicit none (type, external)
         class(sharing_t), intent(in) :: self
      end function ends_i

      !> How many do items at the same time, each with threads of its own.
      integer function members_i(self)
         import :: sharing_t
         implicit none (type, external)
         class(sharing_t), intent(in) :: self
      end function members_i
   end interface
end module psalm_shared_work
