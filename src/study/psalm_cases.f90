!> The cases of a file, whichever way their linkages are described: what follows works on loops.
module psalm_cases
   use psalm_data_set, only: data_set_t, read_data_sets, read_data_set_text
   use psalm_group_table, only: everything
   use psalm_loop_check, only: check_loops
   use psalm_loop_forces, only: asks_for_forces, loops_carry_forces
   use psalm_mark, only: mark_t
   use psalm_sketch_case, only: refuse_in_poses, resolve_sketch
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

      call read_data_sets(file, sets, findings, program, mark)
      call resolve_all(sets, findings, program)
   end subroutine read_cases

   !> The same from a text.
   subroutine read_case_text(text, name, sets, findings, program)
      character(*), intent(in) :: text                       !! lines, each ended by a line feed
      character(*), intent(in) :: name                       !! in the findings in place of a file
      type(data_set_t), allocatable, intent(out) :: sets(:)  !! the cases
      type(diagnostics_t), intent(inout) :: findings
      character(*), intent(in) :: program                    !! who reads

      call read_data_set_text(text, name, sets, findings, program)
      call resolve_all(sets, findings, program)
   end subroutine read_case_text

   subroutine resolve_all(sets, findings, program)
      type(data_set_t), intent(inout) :: sets(:)
      type(diagnostics_t), intent(inout) :: findings
      character(*), intent(in), optional :: program
      character(:), allocatable :: reader
      integer :: i

      if (findings%failed()) return
      reader = 'psalm'
      if (present(program)) reader = program
      do i = 1, size(sets)
         if (sets(i)%sketch%given) call resolve(sets(i), reader, findings)
      end do
   end subroutine resolve_all

   !> The loops of a sketch that was drawn anew.
   subroutine resolve_drawn(set, findings)
      class(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings

      select type (set)
      type is (data_set_t)
         if (allocated(set%traced)) deallocate (set%traced)
         if (allocated(set%search_in_poses)) deallocate (set%search_in_poses)
         call resolve(set, 'psalm', findings)
      end select
   end subroutine resolve_drawn

   !> The loops of a sketch; those of larger groups where the loops of dyads do not give its joints at the drawing, or not its
   !> forces.
   !> A search for dimensions that loops have not is one in poses: the loops are then those of the linkage as given.
   subroutine resolve(set, reader, findings)
      type(data_set_t), intent(inout) :: set
      character(*), intent(in) :: reader                     !! the program, or `everything`
      type(diagnostics_t), intent(inout) :: findings
      class(data_set_t), allocatable :: as_read    ! large: it would fill a small stack
      type(diagnostics_t) :: own
      character(:), allocatable :: why, in_poses
      logical :: forces, given, sound

      forces = reader /= 'psalm'
      given = all(reader /= [character(6) :: 'psalm', everything])
      own%file = findings%file
      allocate (as_read, source=set)
      call resolve_sketch(set, own, as_given=given, sound=sound, in_poses=in_poses)
      if (len(in_poses) > 0) then
         call begin_again(as_read, set, own)
         call resolve_sketch(set, own, as_given=.true.)
         set%search_in_poses = in_poses
         if (set%wants_search()) call refuse_in_poses(set, findings)
         ! what loops cannot do for the drawing may be no trouble for the linkage found
         if (reader == 'psalm') own = diagnostics_t()
      end if
      if (.not. own%failed() .and. set%loops() > 0) then
         call check_loops(set, why)
         if (len(why) == 0 .and. forces .and. asks_for_forces(as_read)) then
            if (.not. loops_carry_forces(set)) why = 'forces'
         end if
         if (len(why) > 0) then
            ! an arc to every joint and slide
            call begin_again(as_read, set, own)
            call resolve_sketch(set, own, as_groups=.true., as_given=given .or. len(in_poses) > 0)
            if (len(in_poses) > 0) set%search_in_poses = in_poses
            if (.not. own%failed() .and. set%loops() > 0) then
               call check_loops(set, why)
               if (len(why) > 0) call set%origins%error(own, 'CHAIN', 'LNK', &
                                                        'no loops give this sketch as it is drawn, for it has '//why)
            end if
         end if
      end if
      call findings%append(own)

   end subroutine resolve

   !> The case as it was read, and nothing found about it.
   subroutine begin_again(as_read, set, own)
      class(data_set_t), intent(in) :: as_read
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: own
      character(:), allocatable :: file

      file = own%file
      select type (as_read)
      type is (data_set_t)
         set = as_read
      end select
      own = diagnostics_t()
      own%file = file
   end subroutine begin_again
end module psalm_cases
