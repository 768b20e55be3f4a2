!> From a sketch to the arrays of &LINKS, where they exist: what every program then works on.
!>
!> The drawing is assembled first (exact lengths may have moved it), then `psalm_sketch_loops` chooses loops and signs, and
!> outputs, variables, bounds and tolerances by name become those of arcs.
module psalm_sketch_case
   use psalm_angles, only: degrees_of, within_turn
   use psalm_closure, only: closure_t, state_t
   use psalm_data_set, only: data_set_t
   use psalm_first_output, only: fill_output, take_targets, wants_poses, wants_travel
   use psalm_frame_places, only: part_frame_arcs
   use psalm_joint_location, only: locate_sketch
   use psalm_kinds, only: wp
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_sketch, only: sketch_t, drive_turns
   use psalm_sketch_assembly, only: assemble_sketch, move_slides
   use psalm_dimension_change, only: check_sweep
   use psalm_sketch_dimensions, only: fill_tolerances, fill_variables, take_dimensions
   use psalm_sketch_loops, only: make_loops
   use psalm_sketch_places, only: fill_places, fill_regions
   use psalm_status, only: diagnostics_t
   use psalm_traced_loops, only: loops_t, traced_crank
   implicit none (type, external)
   private
   public :: copy_cases_of_loops, resolve_sketch

   character(*), parameter :: no_dimension = 'dimensions that its loops do not have'

contains

   !> The case with its loops, made of one whose linkage is a sketch. Errors: a sketch that is none, that does not close, or is not
   !> to be traced; dimensions to be searched that the loops have not. The case is then as it was read.
   subroutine resolve_sketch(as_read, set, findings, as_groups, as_given, in_poses)
      class(data_set_t), intent(in) :: as_read       !! without loops
      type(data_set_t), intent(out) :: set
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in), optional :: as_groups     !! trace dyads as larger groups
      logical, intent(in), optional :: as_given      !! nothing is searched: what only a search could not do is no failure
      character(:), allocatable, intent(out), optional :: in_poses !! what varies that loops cannot vary, so that the search is one
                                                                   !! in poses; empty: nothing. There are no loops then
      character(:), allocatable :: why
      type(closure_t) :: closure
      type(state_t) :: state
      type(loops_t), allocatable :: loops             ! large: it would fill a small stack
      type(sketch_motion_t), allocatable :: moving
      type(diagnostics_t) :: of_search
      logical :: closes, given

      allocate (loops, moving)
      if (present(in_poses)) in_poses = ''
      select type (as_read)
      type is (data_set_t)
         set = as_read
      end select
      given = .false.
      if (present(as_given)) given = as_given
      call assemble_sketch(set, closure, state, closes, findings)
      if (.not. closes) return
      call make_loops(closure, state, loops, as_groups)
      if (.not. loops%found) then
         call set%origins%error(findings, 'CHAIN', 'LNK', 'no loops lead to every link of this sketch, for it has '//loops%why)
         return
      end if
      if (set%sketch%has_targets() .or. wants_poses(set) .or. wants_travel(loops, set)) &
         call take_targets(loops, state, closure%sketch, set)
      if (.not. given) then
         call part_frame_arcs(closure%sketch, loops, why)
         if (present(in_poses)) in_poses = why
         if (len(why) > 0) return
      end if
      ! exact lengths may have moved the joints, and slides with their links
      call move_slides(closure, state, set%sketch%slides)
      set%sketch%x = state%joint(:, 0)%re
      set%sketch%y = state%joint(:, 0)%im
      call warn_of_idle_angle(loops, set, findings)
      call take_dimensions(loops)
      call fill_places(closure, loops, state, set)
      if (given) then
         call fill_output(loops, state, closure%sketch, set, of_search)
         call fill_variables(loops, closure%sketch, set, of_search)
         if (of_search%failed()) call loops%hold_all()
      else
         call fill_output(loops, state, closure%sketch, set, findings)
         call fill_variables(loops, closure%sketch, set, of_search)
         if (of_search%failed() .and. present(in_poses)) then
            in_poses = no_dimension
            return
         end if
         call findings%append(of_search)
      end if
      call fill_regions(loops, closure%sketch, set)
      call fill_tolerances(loops, closure%sketch, set, findings)
      call check_sweep(loops, closure%sketch, set, findings)
      loops%crank = crank_direction(loops, set%sketch)
      allocate (set%traced)
      set%traced = loops
      call locate_sketch(set, moving)
      set%traced%moving = moving
   end subroutine resolve_sketch

   !> Cases, of which those that are no sketch are there already. A procedure of another module than that which goes on with the
   !> sketches: a copy takes 10 kB of the stack.
   subroutine copy_cases_of_loops(as_read, sets)
      type(data_set_t), intent(in) :: as_read(:)
      type(data_set_t), allocatable, intent(out) :: sets(:) !! shape that of `as_read`
      integer :: i

      allocate (sets(size(as_read)))
      do i = 1, size(sets)
         if (.not. as_read(i)%is_drawn()) sets(i) = as_read(i)
      end do
   end subroutine copy_cases_of_loops

   !> Direction of the crank in the drawing, whatever joint its loop goes through: from its drive to the joint that it shares with
   !> another link, of several to the first by the alphabet; of a crank without such a joint to any of its joints; of a crank
   !> without any that of its slide, of several of the first by the alphabet; degrees.
   pure real(wp) function crank_direction(loops, sketch) result(direction)
      type(loops_t), intent(in) :: loops
      type(sketch_t), intent(in) :: sketch
      integer :: joint, chosen, arc, k, guide
      logical :: shared, chosen_shared

      direction = loops%input
      arc = findloc(loops%arcs%kind == traced_crank .and. loops%arcs%drive == 1, .true., dim=1)
      if (loops%floating .or. sketch%drives(1)%kind /= drive_turns .or. arc == 0) return
      chosen = 0
      chosen_shared = .false.
      associate (drive => sketch%drives(1))
         do joint = 1, size(sketch%joint_name)
            if (joint == drive%joint .or. .not. sketch%has_joint(drive%link, joint)) cycle
            shared = size(sketch%links_of(joint)) > 1
            if (chosen > 0) then
               if (chosen_shared .and. .not. shared) cycle
               if ((chosen_shared .eqv. shared) .and. sketch%joint_name(joint) > sketch%joint_name(chosen)) cycle
            end if
            chosen = joint
            chosen_shared = shared
         end do
         if (chosen == 0) then
            guide = 0
            do k = 1, size(sketch%slides)
               if (.not. any(sketch%slides(k)%links == drive%link)) cycle
               if (guide > 0) then
                  if (sketch%slides(k)%name > sketch%slides(guide)%name) cycle
               end if
               guide = k
            end do
            if (guide > 0) direction = within_turn(sketch%slides(guide)%angle)
            return
         end if
         if (all(loops%arcs(arc)%ends == [drive%joint, chosen])) return
         direction = within_turn(degrees_of(sketch%x(chosen) - sketch%x(drive%joint), sketch%y(chosen) - sketch%y(drive%joint)))
      end associate
   end function crank_direction

   !> Only dyads have a transmission angle. TRMIN is refused where there is none.
   subroutine warn_of_idle_angle(loops, set, findings)
      type(loops_t), intent(in) :: loops
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      character(*), parameter :: why = 'has no effect: all links are in groups of more than two, which have no transmission '// &
                                       'angle (the margins of &CONSTR say how far these are from a dead point)'
      integer :: loop

      if (any([(loops%is_dyad(loop), loop=1, loops%loops)])) return
      if (set%limits%trmin_given .or. .not. set%limits%tangle_given) return
      call set%origins%warning(findings, 'LIMITS', 'TANGLE', why)
   end subroutine warn_of_idle_angle
end module psalm_sketch_case
