!> The groups that studies read, one after the other. What they are stands in a submodule, so that a change of one group does
!> not concern whoever reads a case.
module psalm_study_groups
   use psalm_case_group, only: section_t
   implicit none (type, external)
   private
   public :: study_groups

   interface
      !> All groups of the studies as they are by default.
      module subroutine study_groups(sections)
         implicit none (type, external)
         type(section_t), allocatable, intent(out) :: sections(:)
      end subroutine study_groups
   end interface
end module psalm_study_groups
