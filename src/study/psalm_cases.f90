!> The cases of a file, whichever way their linkages are described: what follows works on loops. A case is read, a sketch is given
!> its loops, and then nothing is written into it any more.
module psalm_cases
   use psalm_data_set, only: data_set_t, read_data_sets, read_data_set_text
   use psalm_group_table, only: everything
   use psalm_loop_check, only: check_loops
   use psalm_loop_forces, only: asks_for_forces, loops_carry_forces
   use psalm_mark, only: mark_t
   use psalm_sketch_case, only: copy_cases_of_loops, resolve_sketch
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: read_cases, read_case_text, resolve_drawn

contains

   !> Read every case of a file and choose the loops of those that are sketches. Errors: those of both, in `findings`.
   subroutine read_cases(file, sets, findings, program, mark)
      character(*), intent(in) :: file                       !! name, `-` for standard input
      type(data_set_t), allocatable, intent(out) :: sets(:)  !! the cases
      type(diagnostics_t), intent(inout) :: findings
      character(*), intent(in), optional :: program          !! who reads; default psalm
      type(mark_t), intent(inout), optional :: mark          !! takes in the text

      type(data_set_t), allocatable :: as_read(:)

      call read_data_sets(file, as_read, findings, program, mark)
      call resolve_all(as_read, sets, findings, program)
   end subroutine read_cases

   !> The same from a text.
   subroutine read_case_text(text, name, sets, findings, program)
      character(*), intent(in) :: text                       !! lines, each ended by a line feed
      character(*), intent(in) :: name                       !! in the findings in place of a file
      type(data_set_t), allocatable, intent(out) :: sets(:)  !! the cases
      type(diagnostics_t), intent(inout) :: findings
      character(*), intent(in) :: program                    !! who reads

      type(data_set_t), allocatable :: as_read(:)

      call read_data_set_text(text, name, as_read, findings, program)
      call resolve_all(as_read, sets, findings, program)
   end subroutine read_case_text

   subroutine resolve_all(as_read, sets, findings, program)
      type(data_set_t), allocatable, intent(inout) :: as_read(:)  !! not allocated afterwards where it has no sketch
      type(data_set_t), allocatable, intent(out) :: sets(:)
      type(diagnostics_t), intent(inout) :: findings
      character(*), intent(in), optional :: program
      character(:), allocatable :: reader
      integer :: i

      if (findings%failed() .or. .not. any([(as_read(i)%is_drawn(), i=1, size(as_read))])) then
         call move_alloc(as_read, sets)
         return
      end if
      reader = 'psalm'
      if (present(program)) reader = program
      call copy_cases_of_loops(as_read, sets)
      do i = 1, size(sets)
         if (as_read(i)%is_drawn()) call resolve(as_read(i), reader, sets(i), findings)
      end do
   end subroutine resolve_all

   !> The loops of a sketch that was drawn anew.
   subroutine resolve_drawn(drawn, set, findings, program)
      class(data_set_t), intent(in) :: drawn                 !! without loops
      type(data_set_t), intent(out) :: set                   !! the case with its loops
      type(diagnostics_t), intent(inout) :: findings
      character(*), intent(in), optional :: program          !! who reads; default psalm

      if (present(program)) then
         call resolve(drawn, program, set, findings)
      else
         call resolve(drawn, 'psalm', set, findings)
      end if
   end subroutine resolve_drawn

   !> A sketch with its loops; those of larger groups where the loops of dyads do not give its joints at the drawing, or not its
   !> forces.
   !> A search for dimensions that loops have not is one in poses: the loops are then those of the linkage as given.
   subroutine resolve(as_read, reader, set, findings)
      class(data_set_t), intent(in) :: as_read
      character(*), intent(in) :: reader                     !! the program, or `everything`
      type(data_set_t), intent(out) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(diagnostics_t) :: own
      character(:), allocatable :: why, in_poses
      logical :: forces, given

      forces = reader /= 'psalm'
      given = all(reader /= [character(6) :: 'psalm', everything])
      call begin(own)
      call resolve_sketch(as_read, set, own, as_given=given, in_poses=in_poses)
      if (len(in_poses) > 0) then
         call begin(own)
         call resolve_sketch(as_read, set, own, as_given=.true.)
         set%search_in_poses = in_poses
         ! what loops cannot do for the drawing may be no failure for the linkage found
         if (reader == 'psalm') own = diagnostics_t()
      end if
      if (.not. own%failed() .and. set%loops() > 0) then
         call check_loops(set, why)
         if (len(why) == 0 .and. forces .and. asks_for_forces(as_read)) then
            if (.not. loops_carry_forces(set)) why = 'forces'
         end if
         if (len(why) > 0) then
            ! an arc to every joint and slide
            call begin(own)
            call resolve_sketch(as_read, set, own, as_groups=.true., as_given=given .or. len(in_poses) > 0)
            if (len(in_poses) > 0) set%search_in_poses = in_poses
            if (.not. own%failed() .and. set%loops() > 0) then
               call check_loops(set, why)
               if (len(why) > 0) call set%origins%error(own, 'CHAIN', 'LNK', &
                                                        'no loops give this sketch as it is drawn, for it has '//why)
            end if
         end if
      end if
      call findings%append(own)

   contains

      !> Nothing found yet.
      subroutine begin(own)
         type(diagnostics_t), intent(out) :: own

         own%file = findings%file
      end subroutine begin
   end subroutine resolve
end module psalm_cases
