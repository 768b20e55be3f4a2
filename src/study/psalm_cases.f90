!> The cases of a file, whichever way their linkages are described: what follows works on loops.
module psalm_cases
   use psalm_data_set, only: data_set_t, read_data_sets, read_data_set_text
   use psalm_kinds, only: wp
   use psalm_group_table, only: everything
   use psalm_loop_check, only: check_loops
   use psalm_loop_forces, only: asks_for_forces, loops_carry_forces
   use psalm_mark, only: mark_t
   use psalm_sketch_case, only: refuse_without_loops, resolve_sketch
   use psalm_sketch, only: output_pose
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: read_cases, read_case_text

   !> Why a sketch is solved in poses though it has loops.
   character(*), parameter :: no_forces = 'forces to be found, and loops that leave out a joint'
   character(*), parameter :: no_dimension = 'dimensions to be searched that its loops do not have'

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
         if (.not. sets(i)%sketch%given) cycle
         call resolve(sets(i), reader /= 'psalm', all(reader /= [character(6) :: 'psalm', everything]), findings)
         if (allocated(sets(i)%no_loops)) call refuse_without_loops(sets(i), reader, findings)
      end do
   end subroutine resolve_all

   !> The loops of a sketch, unless they do not give its joints at the drawing, or not its forces: then it is solved in its poses.
   subroutine resolve(set, forces, given, findings)
      type(data_set_t), intent(inout) :: set
      logical, intent(in) :: forces                          !! the program finds them
      logical, intent(in) :: given                           !! it takes linkages as they are given
      type(diagnostics_t), intent(inout) :: findings
      class(data_set_t), allocatable :: as_read    ! large: it would fill a small stack
      type(diagnostics_t) :: own
      character(:), allocatable :: why
      logical :: carry

      own%file = findings%file
      allocate (as_read, source=set)
      call resolve_sketch(set, own, as_given=given)
      why = ''
      ! in its poses a wish can be met by dimensions that are none of the loops
      if (own%failed() .and. .not. allocated(set%no_loops) .and. (as_read%sketch%has_wishes() .or. set%is_beyond_arrays())) &
         why = no_dimension
      if (.not. own%failed() .and. set%loops() > 0) then
         call check_loops(set, why)
         carry = len(why) == 0
         if (carry .and. forces .and. asks_for_forces(as_read)) carry = loops_carry_forces(set)
         if (.not. carry) then
            ! an arc to every joint and slide
            call take(as_read)
            own = diagnostics_t()
            own%file = findings%file
            call resolve_sketch(set, own, as_groups=.true., as_given=given)
            if (.not. own%failed() .and. set%loops() > 0) then
               call check_loops(set, why)
               if (len(why) == 0 .and. forces .and. asks_for_forces(as_read)) then
                  if (.not. loops_carry_forces(set)) why = no_forces
               end if
            end if
         end if
      end if
      if (len(why) > 0) then
         call take(as_read)
         call resolve_sketch(set, findings, why)
         return
      end if
      call findings%append(own)

   contains

      subroutine take(other)
         class(data_set_t), intent(in) :: other

         select type (other)
         type is (data_set_t)
            set = other
         end select
      end subroutine take
   end subroutine resolve
end module psalm_cases
