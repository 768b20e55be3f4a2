!> Blocks of device 9, which plotting programs tell apart by two blank lines: the one place for their heads.
module psalm_block
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: begin_block

contains

   !> Begin a block: its name, then the names of its columns.
   subroutine begin_block(name, columns, text)
      character(*), intent(in) :: name, columns
      type(text_t), intent(inout) :: text

      if (text%length > 0) then
         call text%add()
         call text%add()
      end if
      call text%add('# block '//name)
      call text%add('# '//columns)
   end subroutine begin_block
end module psalm_block
