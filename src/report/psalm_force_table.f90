!> Forces as columns of the table for other programs.
module psalm_force_table
   use psalm_force_list, only: column_room, force_columns, force_values
   use psalm_force_study, only: force_study_t
   use psalm_kinds, only: wp
   use psalm_table, only: table_t
   implicit none (type, external)
   private
   public :: add_force_columns

contains

   !> Add the columns that device 9 has, to a table of the same positions.
   pure subroutine add_force_columns(study, table)
      type(force_study_t), intent(in) :: study
      type(table_t), intent(inout) :: table
      character(column_room), allocatable :: names(:)
      real(wp), allocatable :: values(:, :)
      logical :: known(size(study%input))
      integer :: k, c

      names = force_columns(study)
      allocate (values(size(study%input), size(names)))
      do k = 1, size(study%input)
         values(k, :) = force_values(study, k)
         known(k) = study%table%known(k)
      end do
      ! a row that is empty stays so: followed from the drawing, a sketch may not reach where its loops close
      do c = 1, table%count
         if (table%columns(c)%is_flag) known = known .and. table%columns(c)%values > 0.0_wp
      end do
      do c = 1, size(names)
         call table%add(trim(names(c)), values(:, c), known)
      end do
   end subroutine add_force_columns
end module psalm_force_table
