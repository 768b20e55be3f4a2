!> All tables of items: as a list to read, and as a schema (JSON Schema) of a case.
module psalm_item_list
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: list_items, list_groups, write_schema, why_no_group

   interface
      !> Why a program has no items of that group; empty if it has.
      module pure function why_no_group(program, group) result(text)
         implicit none (type, external)
         character(*), intent(in) :: program, group
         character(:), allocatable :: text
      end function why_no_group

      !> The groups that a program reads, with the names of their items.
      module pure subroutine list_groups(program, text)
         implicit none (type, external)
         character(*), intent(in) :: program
         type(text_t), intent(inout) :: text
      end subroutine list_groups

      !> The items of a group, one after another.
      module pure subroutine list_items(group, text)
         implicit none (type, external)
         character(*), intent(in) :: group          !! in any case
         type(text_t), intent(inout) :: text
      end subroutine list_items

      !> The schema of the cases that a program reads, as JSON Schema. Beside its words there are `x-kind`, `x-shape`, `x-unit`,
      !> `x-values` and `x-default`, as they stand in the tables, and of each group `x-programs`.
      module pure subroutine write_schema(program, version, text)
         implicit none (type, external)
         character(*), intent(in) :: program, version
         type(text_t), intent(inout) :: text
      end subroutine write_schema
   end interface
end module psalm_item_list
