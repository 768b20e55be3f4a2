!> A sketch read to be solved in the poses of its links: the witness of its loops.
module poses
   use psalm_data_set, only: data_set_t, read_data_set_text
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: read_in_poses

contains

   subroutine read_in_poses(text, set, findings)
      character(*), intent(in) :: text
      type(data_set_t), intent(out) :: set
      type(diagnostics_t), intent(out) :: findings
      type(data_set_t), allocatable :: sets(:)

      call read_data_set_text(text, 'test', sets, findings, 'psalm')
      if (findings%failed()) return
      set = sets(1)
   end subroutine read_in_poses
end module poses
