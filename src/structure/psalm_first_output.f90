!> The first output of a sketch as that of its loops, and its desired values.
module psalm_first_output
   use psalm_angles, only: degrees_of
   use psalm_closure, only: state_t
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, full_turn
   use psalm_output_kind, only: output_kind_t, kind_of_output, motion_point, motion_angle, motion_distance, motion_slide, &
                                motion_pose
   use psalm_sketch, only: sketch_t, sketch_output_t, frame_link, output_point, output_angle, output_distance, output_slide, &
                           output_pose, most_targets
   use psalm_sketch_dimensions, only: quadrant_angle
   use psalm_status, only: diagnostics_t
   use psalm_traced_loops, only: loops_t, arc_with
   implicit none (type, external)
   private
   public :: fill_output, wants_poses, wants_travel, take_targets

contains

   !> The first output that the arrays can describe; without one the first point of a single link, else the last moving joint.
   subroutine fill_output(loops, state, sketch, set, findings)
      type(loops_t), intent(inout) :: loops
      type(state_t), intent(in) :: state
      type(sketch_t), intent(in) :: sketch
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(sketch_output_t) :: shown
      logical :: done

      done = .false.
      if (size(sketch%outputs) > 0) then
         call put_output(loops, state, sketch, sketch%outputs(1), done)
         if (done) return
         if (set%method%desired) then
            call set%origins%error(findings, 'OUTPUTS', 'OUTPUT', 'the desired values of &METHOD are those of the first '// &
                                   'output, which '//trim(sketch%outputs(1)%name)//' cannot be here; give its values as DES1 '// &
                                   'of &OUTPUTS, or put a point, angle, distance from the origin or slide first', 1)
         end if
         if (set%toler%adjusted) call set%origins%error(findings, 'TOLER', 'ADJUST', 'ADJUST restores the first output, which '// &
            trim(sketch%outputs(1)%name)//' cannot be here; put a point, angle, distance from the origin or slide first', 1)
         loops%stand_in = trim(sketch%joint_name(sketch%shown_joint()))
      end if
      shown%kind = output_point
      shown%joints(1) = sketch%shown_joint()
      call put_output(loops, state, sketch, shown, done)
   end subroutine fill_output

   !> True if the first output is a pose that has desired values.
   pure logical function wants_poses(set)
      type(data_set_t), intent(in) :: set

      wants_poses = set%method%desired .and. size(set%sketch%outputs) > 0
      if (wants_poses) wants_poses = set%sketch%outputs(1)%kind == output_pose
   end function wants_poses

   !> True if the first output is a slide of a larger group that has desired values: those are of its travel, for the user knows no
   !> length of its arc.
   pure logical function wants_travel(loops, set)
      type(loops_t), intent(in) :: loops
      type(data_set_t), intent(in) :: set
      integer :: arc

      wants_travel = .false.
      if (.not. (loops%found .and. set%method%desired) .or. size(set%sketch%outputs) == 0) return
      if (set%sketch%outputs(1)%kind /= output_slide) return
      arc = findloc(loops%arcs%slide, set%sketch%outputs(1)%slide, dim=1)
      if (arc > 0) wants_travel = loops%arcs(arc)%guide_link > 0
   end function wants_travel

   !> Desired values of the first output are those of &METHOD, if the loops can describe it: DES1 is another word for DESX and DESY,
   !> or DESANG, DVEL1 and DACC1 for their derivatives. Not so of a slide, whose arc has another zero. Values of the others, and of
   !> a first one that is no output of the loops, are compared beside it.
   subroutine take_targets(loops, state, sketch, set)
      type(loops_t), intent(inout) :: loops
      type(state_t), intent(in) :: state
      type(sketch_t), intent(in) :: sketch
      type(data_set_t), intent(inout) :: set
      logical :: reported

      associate (first => sketch%outputs(1))
         reported = first%kind /= output_slide
         if (reported) call put_output(loops, state, sketch, first, reported)
         if (reported .and. (set%method%desired .neqv. first%has_target())) then
            call give_to_method(set)
         else if (wants_travel(loops, set) .or. (set%method%desired .and. first%kind == output_pose .and. .not. reported)) then
            call take_from_method(set)
         end if
      end associate
   end subroutine take_targets

   !> Targets of the first output as desired values of &METHOD.
   subroutine give_to_method(set)
      type(data_set_t), intent(inout) :: set
      type(output_kind_t) :: kind
      integer :: order

      kind = kind_of_output(set%sketch%outputs(1)%kind)
      associate (targets => set%sketch%outputs(1)%targets)
         if (allocated(targets(0)%values)) then
            if (kind%components > 1) then
               set%method%desx = targets(0)%values(1, :)
               set%method%desy = targets(0)%values(2, :)
               set%method%xmult = targets(0)%weights(1, :)
               set%method%ymult = targets(0)%weights(2, :)
            end if
            if (kind%components /= 2) then
               set%method%desang = targets(0)%values(kind%components, :)
               set%method%anmult = targets(0)%weights(kind%components, :)
            end if
            deallocate (targets(0)%values, targets(0)%weights)
         end if
         do order = 1, most_targets
            if (.not. allocated(targets(order)%values)) cycle
            if (.not. allocated(set%method%rate_desired)) &
               allocate (set%method%rate_desired(set%method%ndes, kind%components, most_targets), &
                         set%method%rate_weight(set%method%ndes, kind%components, most_targets), source=0.0_wp)
            set%method%rate_desired(:, :, order) = transpose(targets(order)%values)
            set%method%rate_weight(:, :, order) = transpose(targets(order)%weights)
            deallocate (targets(order)%values, targets(order)%weights)
         end do
      end associate
      set%method%desired = .true.
   end subroutine give_to_method

   !> Desired poses or travels of &METHOD, and their derivatives, as targets of the first output.
   subroutine take_from_method(set)
      type(data_set_t), intent(inout) :: set
      integer :: order

      associate (targets => set%sketch%outputs(1)%targets, method => set%method)
         method%desired = .false.
         if (set%sketch%outputs(1)%kind == output_slide) then
            targets(0)%values = reshape(method%desang, [1, method%ndes])
            targets(0)%weights = reshape(method%anmult, [1, method%ndes])
         else
            allocate (targets(0)%values(3, method%ndes), targets(0)%weights(3, method%ndes))
            targets(0)%values(1, :) = method%desx + method%xadd
            targets(0)%values(2, :) = method%desy + method%yadd
            targets(0)%values(3, :) = method%desang
            targets(0)%weights(1, :) = method%xmult
            targets(0)%weights(2, :) = method%ymult
            targets(0)%weights(3, :) = method%anmult
         end if
         if (.not. allocated(method%rate_desired)) return
         do order = 1, most_targets
            if (.not. any(method%rate_weight(:, :, order) > 0.0_wp)) cycle
            targets(order)%values = transpose(method%rate_desired(:, :, order))
            targets(order)%weights = transpose(method%rate_weight(:, :, order))
         end do
         deallocate (method%rate_desired, method%rate_weight)
      end associate
   end subroutine take_from_method

   !> Describe an output by an arc. `done` is false for one that the arrays cannot tell.
   subroutine put_output(loops, state, sketch, output, done)
      type(loops_t), intent(inout) :: loops
      type(state_t), intent(in) :: state
      type(sketch_t), intent(in) :: sketch
      type(sketch_output_t), intent(in) :: output
      logical, intent(out) :: done
      integer :: arc, k
      integer, allocatable :: links(:)
      complex(wp) :: h

      done = .false.
      loops%motion = motion_point
      loops%outlk = 0.0_wp
      loops%outang = 0.0_wp
      loops%output_joint = 0
      if (any(output%kind == [output_point, output_distance, output_pose])) loops%output_joint = output%joints(1)
      select case (output%kind)
      case (output_point, output_distance)
         if (output%kind == output_distance) then
            loops%motion = motion_distance
            if (output%joints(2) > 0) return
         end if
         links = sketch%links_of(output%joints(1))
         do k = size(links), 1, -1
            if (links(k) == frame_link .and. k > 1) cycle
            call from_arc_of(links(k))
            if (done) exit
         end do
      case (output_angle, output_pose)
         loops%motion = merge(motion_angle, motion_pose, output%kind == output_angle)
         k = merge(1, 2, output%kind == output_angle)
         do arc = 1, size(sketch%links)
            if (.not. sketch%has_joint(arc, output%joints(k)) .or. .not. sketch%has_joint(arc, output%joints(k + 1))) cycle
            if (output%kind == output_pose) then
               if (.not. sketch%has_joint(arc, output%joints(1))) return
               call from_arc_of(arc)
            else
               loops%output_arc = 0
               done = loops%axis(arc) > 0
               if (done) call name_arc(loops%axis(arc), .false.)
            end if
            if (.not. done) return
            h = state%joint(output%joints(k + 1), 0) - state%joint(output%joints(k), 0)
            if (output%kind == output_angle) loops%outang = quadrant_angle(degrees_of(h%re, h%im) - direction())
            exit
         end do
         ! the direction of a pose is that of its output arc: only from the joint along the line
         if (output%kind == output_pose .and. done) done = abs(modulo(loops%outang + direction() - degrees_of(h%re, h%im) &
                                                                      + 180.0_wp, full_turn) - 180.0_wp) < 1.0e-9_wp
      case (output_slide)
         loops%motion = motion_slide
         do k = 1, size(loops%arcs)
            if (loops%arcs(k)%slide /= output%slide) cycle
            call name_arc(k, .false.)
            done = .true.
            return
         end do
      end select

   contains

      real(wp) function direction()
         direction = 0.0_wp
         if (loops%output_arc > 0) direction = loops%arcs(loops%output_arc)%direction
      end function direction

      subroutine name_arc(which, from_start)
         integer, intent(in) :: which
         logical, intent(in) :: from_start

         loops%output_arc = which
         loops%from_start = from_start
      end subroutine name_arc

      !> From an end of an arc of the link: the joint itself if it is one.
      subroutine from_arc_of(link)
         integer, intent(in) :: link
         integer :: point, found, chosen
         logical :: from_start, start_of_it
         complex(wp) :: v

         call arc_with(loops, link, output%joints(1), chosen, from_start)
         if (chosen == 0) then
            do point = 1, size(loops%point)
               call arc_with(loops, link, point, found, start_of_it)
               if (found == 0) cycle
               chosen = found
               from_start = start_of_it
               exit
            end do
         end if
         if (chosen == 0) return
         done = .true.
         call name_arc(chosen, from_start)
         point = loops%arcs(chosen)%ends(merge(1, 2, from_start))
         v = state%joint(output%joints(1), 0) - loops%point(point)
         loops%outlk = abs(v)
         if (point == output%joints(1)) loops%outlk = 0.0_wp
         if (loops%outlk > 0.0_wp) loops%outang = quadrant_angle(degrees_of(v%re, v%im) - loops%arcs(chosen)%direction)
         if (output%kind == output_pose) then
            v = state%joint(output%joints(3), 0) - state%joint(output%joints(2), 0)
            if (loops%outlk == 0.0_wp) loops%outang = quadrant_angle(degrees_of(v%re, v%im) - loops%arcs(chosen)%direction)
         end if
      end subroutine from_arc_of
   end subroutine put_output
end module psalm_first_output
