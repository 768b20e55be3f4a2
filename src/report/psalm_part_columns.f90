!> Columns that say in words which group, line or quantity a row of a table is about: only of a sketch, for a linkage of loops the
!> numbers of its loops and arcs say it.
module psalm_part_columns
   use psalm_group_words, only: arc_heading, group_words
   use psalm_markup, only: strings_t
   use psalm_mechanism, only: mechanism_t
   use psalm_tables, only: table_t
   implicit none (type, external)
   private
   public :: add_groups, add_lines, add_words

contains

   !> The column `group`: `joints B, C, D`.
   pure subroutine add_groups(mechanism, loops, table)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loops(:)          !! shape (rows); 0: none
      type(table_t), intent(inout) :: table
      type(strings_t) :: names(size(loops))
      integer :: k

      if (.not. mechanism%has_joint_names()) return
      do k = 1, size(loops)
         names(k)%text = ''
         if (loops(k) > 0) names(k)%text = group_words(mechanism, loops(k))
      end do
      call add_words('group', names, table)
   end subroutine add_groups

   !> The column `line`: `line B C`, `slide S1`.
   pure subroutine add_lines(mechanism, loops, places, table, times)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loops(:), places(:)   !! shape (arcs)
      type(table_t), intent(inout) :: table
      integer, intent(in), optional :: times       !! how often these rows come; default 1
      type(strings_t) :: names(size(loops))
      integer :: k

      if (.not. mechanism%has_joint_names()) return
      do k = 1, size(loops)
         names(k)%text = arc_heading(mechanism, loops(k), places(k), small=.true.)
      end do
      call add_words('line', names, table, times)
   end subroutine add_lines

   !> A column of words; an empty one is not known.
   pure subroutine add_words(name, words, table, times)
      character(*), intent(in) :: name
      type(strings_t), intent(in) :: words(:)
      type(table_t), intent(inout) :: table
      integer, intent(in), optional :: times       !! how often they come; default 1: the table has as many rows as words
      character(:), allocatable :: column(:)
      integer :: k, longest, blocks

      blocks = 1
      if (present(times)) blocks = times
      longest = 1
      do k = 1, size(words)
         longest = max(longest, len(words(k)%text))
      end do
      allocate (character(longest) :: column(size(words)*blocks))
      do k = 1, size(column)
         column(k) = words(1 + modulo(k - 1, size(words)))%text
      end do
      call table%add(name, column, known=len_trim(column) > 0)
   end subroutine add_words
end module psalm_part_columns
