!> The scene: everything that pictures of a linkage show, computed once, in machine axes.
!>
!> Two rows of positions (`psalm_trace`): the prescribed ones and a sweep between and beyond them.
module psalm_scene
   use psalm_allocation_scene, only: allocation_scene_t
   use psalm_angles, only: unit_vector
   use psalm_clearance_scene, only: clearance_scene_t
   use psalm_constraint_group, only: region_t
   use psalm_data_set, only: data_set_t
   use psalm_dyad_kind, only: direction_known, form_of, form_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: forces_wanted
   use psalm_force_scene, only: force_scene_t, extent_of_weights, make_force_scene
   use psalm_group_words, only: group_words
   use psalm_kinds, only: wp, full_turn
   use psalm_link_outline, only: convex_hull
   use psalm_plate_group, only: plate_group_t, plates_of
   use psalm_plate_masses, only: plate_of_body
   use psalm_margin_list, only: describe_margin
   use psalm_margins, only: margin_t, inspector_t, prepare_inspector, inspect, is_violated
   use psalm_markup, only: strings_t, add_string
   use psalm_output_kind, only: motion_point, motion_angle, motion_distance, motion_slide, motion_pose
   use psalm_panels, only: panel_t, tolerance_band_t, add_family_panels, add_rate_panels, add_study_panels, find_band
   use psalm_parts, only: drawn_joint_t, drawn_bar_t, drawn_body_t, drawn_slide_t, drawn_dyad_t, wheel_t, output_curve_t, &
                          drive_part_t, edge_t, ghost_t, find_slides
   use psalm_sketch, only: output_point, output_pose, output_x, output_y
   use psalm_sketch_study, only: sketch_study_t, study_sketch
   use psalm_proof_scene, only: proof_scene_t, make_proof_scene
   use psalm_row_study, only: row_study_t, find_sweep_outputs, solved_row_t
   use psalm_status, only: finding_t, level_error
   use psalm_sweep, only: sweep_sense
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t, at_finish, at_start, body_frame, joint_revolute
   use psalm_trace, only: position_row_t, trace_row, trace_points
   use psalm_vibration_scene, only: vibration_scene_t
   implicit none (type, external)
   private
   public :: place_on_sweep, scene_t, make_scene, add_curves, message_scene, choose_view, find_rails, motion_number

   integer, parameter :: motion_number = -1      !! output of a sketch that has no place of its own

   real(wp), parameter :: same_place = 1.0e-9_wp !! joints nearer than this times the size of the linkage are one
   real(wp), parameter :: pointer_part = 0.16_wp !! an output arc without length is drawn this part of the view long
   real(wp), parameter :: flattest = 0.12_wp     !! a view is at least this part as high as it is wide
   real(wp), parameter :: enlarge = 0.25_wp       !! a sweep widens the view by at most this part of it

   type :: scene_t
      character(:), allocatable :: title, file
      logical :: valid = .false.                          !! there is a linkage to draw, not messages only
      type(strings_t), allocatable :: errors(:), warnings(:)
      type(strings_t), allocatable :: breaches(:)         !! constraints of the group CONSTR that are violated
      integer :: motion = motion_point
      logical :: sliding = .false., desired = .false., everywhere = .false. !! sliding input; desired values; KTHETA=1
      real(wp) :: tangle = 90.0_wp, sense = 1.0_wp
      real(wp) :: time = 0.0_wp                           !! a motion in time: the rows count it, up to here, s; else 0
      integer :: loops = 0
      type(drawn_joint_t), allocatable :: joints(:)
      type(drawn_bar_t), allocatable :: bars(:)
      type(drawn_body_t), allocatable :: bodies(:)
      type(drawn_slide_t), allocatable :: slides(:)
      type(drawn_dyad_t), allocatable :: pairs(:)               !! by loop
      type(region_t), allocatable :: regions(:)           !! where joints must not go
      integer :: output = 0, output_base = 0              !! joints: the output point, where the output arc begins
      integer :: output_slide = 0                         !! MOTION 3: the slide
      type(position_row_t) :: prescribed, sweep
      type(position_row_t) :: chosen                               !! one more position, for DXF; n is 0 if there is none
      real(wp) :: pointer = 0.0_wp                        !! drawn length of the output arc with MOTION 1
      integer :: reference = 1                            !! prescribed position nearest to the reference position
      real(wp) :: low(2) = 0.0_wp, high(2) = 1.0_wp       !! corners of the view
      type(force_scene_t), allocatable :: forces          !! if the case has masses, loads or springs
      type(vibration_scene_t), allocatable :: vibration   !! if the case has a vibrating link
      type(clearance_scene_t), allocatable :: clearance   !! if the case has a joint with clearance
      type(proof_scene_t), allocatable :: proof           !! if the motion is proven, or links have a width
      integer, allocatable :: drawn(:)                    !! by point of the mechanism: the joint that is drawn there
      type(ghost_t), allocatable :: ghosts(:)             !! equilibria
      type(panel_t), allocatable :: panels(:)             !! other curves over the sweep: rates, further outputs
      type(tolerance_band_t), allocatable :: band                   !! of the output, if the dimensions have tolerances
      type(allocation_scene_t), allocatable :: allotted   !! tolerances, if the case asks for the cheapest
      character(:), allocatable :: output_label           !! of a sketch: name of the output drawn
      ! of sketches without loops of dyads only
      character(:), allocatable :: input_label            !! what counts along the sweep
      type(wheel_t), allocatable :: wheels(:)
      type(output_curve_t), allocatable :: curves(:)             !! all outputs
      type(drive_part_t), allocatable :: drives(:)        !! all drives
      real(wp), allocatable :: meshes(:, :, :)            !! shape (2, 4, meshes): what the output reaches over a grid of strokes
      type(edge_t), allocatable :: edges(:)               !! of that, all drives but one at an end of their strokes
   end type scene_t

   !> A point of a link off its arcs: a joint of a sketch that no other link shares.
   type :: side_point_t
      integer :: joint = 0                                !! of the sketch
      integer :: body = 0, base = 0                       !! of the mechanism: the body; the point that it is counted from
      real(wp) :: length = 0.0_wp                         !! from there
   end type side_point_t

contains

   !> A scene of messages only, for a case that cannot be solved.
   pure subroutine message_scene(set, findings, scene)
      type(data_set_t), intent(in) :: set
      type(finding_t), intent(in) :: findings(:)   !! of this case
      type(scene_t), intent(out) :: scene
      integer :: i

      scene%title = set%title
      scene%file = set%file(index(set%file, '/', back=.true.) + 1:)
      allocate (scene%errors(0), scene%warnings(0), scene%joints(0), scene%bars(0), scene%bodies(0))
      allocate (scene%slides(0), scene%pairs(0), scene%regions(0), scene%breaches(0), scene%panels(0))
      do i = 1, size(findings)
         if (findings(i)%level == level_error) then
            call add_string(scene%errors, words(findings(i)))
         else
            call add_string(scene%warnings, words(findings(i)))
         end if
      end do
      allocate (scene%prescribed%words(0), scene%sweep%words(0))

   contains

      !> The finding with the name of its file, without the way there.
      pure function words(finding) result(text)
         type(finding_t), intent(in) :: finding
         character(:), allocatable :: text
         type(finding_t) :: short

         short = finding
         short%file = finding%file(index(finding%file, '/', back=.true.) + 1:)
         text = short%render()
      end function words
   end subroutine message_scene

   !> The scene of a case. Errors among its findings make it a scene of messages (`scene%valid` is false).
   subroutine make_scene(set, study, bare, findings, scene)
      type(data_set_t), intent(in) :: set
      type(row_study_t), intent(inout) :: study    !! of its linkage
      logical, intent(in) :: bare                  !! the linkage alone, without targets, forces and forbidden regions
      type(finding_t), intent(in) :: findings(:)   !! of this case, SETUP's included
      type(scene_t), intent(out) :: scene
      type(side_point_t), allocatable :: sides(:)
      integer, allocatable :: place(:)
      integer :: side
      logical :: proven, everything

      call message_scene(set, findings, scene)
      if (size(scene%errors) > 0) return
      scene%valid = .true.
      deallocate (scene%joints, scene%bars, scene%bodies, scene%pairs)
      ! a pose is drawn as its point
      scene%motion = merge(motion_point, set%motion(), set%motion() == motion_pose)
      if (set%has_names()) then
         if (size(set%sketch%outputs) > 0) scene%output_label = trim(set%sketch%outputs(1)%name)
      end if
      scene%everywhere = set%limits%ktheta /= 0
      scene%tangle = set%limits%tangle
      if (allocated(set%constr%regions)) scene%regions = set%constr%regions
      associate (own => study%problem, dimensions => study%dimensions, mechanism => study%problem%mechanism)
         scene%sliding = mechanism%sliding_input
         if (mechanism%from_drawing) &
            scene%input_label = trim(merge('input length  ', 'input, degrees', scene%sliding))//' from the drawing'
         scene%loops = mechanism%nloop
         scene%desired = own%desired
         scene%sense = sweep_sense(own)
         everything = all(own%plan%solved)
         call find_slides(mechanism, study%prescribed%problem%plan, scene%slides)
         if (scene%motion == motion_slide) call find_output_slide(mechanism, scene)
         call trace_row(study%prescribed, everything, dimensions, scene%slides, scene%output_slide, .true., scene%prescribed)
         if (set%constr%given .and. .not. bare) call check_constraints(set, own, dimensions, scene)
         if (forces_wanted(set) .and. .not. bare) then
            allocate (scene%forces)
            call make_force_scene(set, study, scene%forces)
         end if
         call trace_row(study%sweep, everything, dimensions, scene%slides, scene%output_slide, .false., scene%sweep)
         if (allocated(study%chosen)) &
            call trace_row(study%chosen, everything, dimensions, scene%slides, scene%output_slide, .false., scene%chosen)
         call find_sides(set, mechanism, sides)
         if (size(sides) > 0) then
            call trace_points(study%prescribed, dimensions, set%traced%moving, sides%joint, scene%prescribed)
            call trace_points(study%sweep, dimensions, set%traced%moving, sides%joint, scene%sweep)
            if (allocated(study%chosen)) &
               call trace_points(study%chosen, dimensions, set%traced%moving, sides%joint, scene%chosen)
         end if
         call merge_joints(scene, size(mechanism%points) + 1, place)
         scene%drawn = place
         call make_bars(mechanism, dimensions, place, sides, scene)
         call name_joints(set, mechanism, place, scene)
         do side = 1, size(sides)
            scene%joints(place(size(mechanism%points) + 1 + side))%name = trim(set%sketch%joint_name(sides(side)%joint))
         end do
         scene%reference = minloc(abs(scene%prescribed%delt), dim=1)
         call make_bodies(mechanism, set%has_names(), sides, scene, plates_of(set))
         call choose_view(scene, maxval(dimensions%arcl))
         call find_rails(scene)
         call find_others(scene, scene%prescribed)
         call find_others(scene, scene%sweep)
         if (set%has_stand_in()) call show_own_output(set, study, scene)
         scene%pointer = dimensions%outlk
         if (scene%output == scene%output_base) scene%pointer = pointer_part*norm2(scene%high - scene%low)
         call find_targets(scene, scene%prescribed)
         call find_targets(scene, scene%sweep)
         call widen_view(scene)
         allocate (scene%proof)
         call make_proof_scene(set, own, dimensions, scene%drawn, scene%output, scene%proof, proven)
         if (.not. proven) deallocate (scene%proof)
      end associate
   end subroutine make_scene

   !> The first output of a sketch where another joint stands in for it in the loops: a number, drawn at one of its joints.
   subroutine show_own_output(set, study, scene)
      type(data_set_t), intent(in) :: set
      type(row_study_t), intent(inout) :: study
      type(scene_t), intent(inout) :: scene
      integer :: j, k

      scene%motion = motion_number
      if (any(set%sketch%outputs(1)%kind == [output_point, output_pose])) scene%motion = motion_point
      j = set%sketch%joint_of_output(1)
      if (j > 0) j = findloc([(scene%joints(k)%name == trim(set%sketch%joint_name(j)), k=1, size(scene%joints))], .true., dim=1)
      if (j > 0) scene%output = j
      scene%output_base = scene%output
      call find_sweep_outputs(set, study)
      call take_number(study%outputs, scene%sweep)
      call find_number(study%prescribed, scene%prescribed)
      if (allocated(study%chosen)) call find_number(study%chosen, scene%chosen)

   contains

      !> Its values at the positions of another row.
      subroutine find_number(solved, row)
         type(solved_row_t), intent(in) :: solved
         type(position_row_t), intent(inout) :: row
         type(sketch_study_t), allocatable :: own

         allocate (own)
         call study_sketch(set, solved%problem, study%dimensions, solved%motion%closed, 1.0_wp, 0.0_wp, own, &
                           places_only=.true.)
         call take_number(own, row)
      end subroutine find_number

      !> Its values, as a study has them.
      pure subroutine take_number(own, row)
         type(sketch_study_t), intent(in) :: own
         type(position_row_t), intent(inout) :: row

         row%actual = own%values(1, 0, :)
         row%actual_y = merge(own%values(min(2, size(own%values, 1)), 0, :), 0.0_wp, scene%motion == motion_point)
      end subroutine take_number
   end subroutine show_own_output

   !> Points of links off the arcs that are not the output point, which is drawn already.
   pure subroutine find_sides(set, mechanism, sides)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(side_point_t), allocatable, intent(out) :: sides(:)
      integer :: joint, arc, end

      allocate (sides(0))
      if (.not. allocated(set%traced)) return
      do joint = 1, size(set%traced%joint_places)
         associate (place => set%traced%joint_places(joint))
            if (place%arc == 0 .or. .not. place%distance > 0.0_wp .or. joint == output_joint(set)) cycle
            arc = mechanism%seq(place%loop, place%arc)
            end = merge(at_start, at_finish, place%from_start)
            sides = [sides, side_point_t(joint, mechanism%body_at(arc, end), mechanism%arcs(arc)%ends(end), place%distance)]
         end associate
      end do
   end subroutine find_sides

   !> The joint of a sketch that is the output point; 0: there is none.
   pure integer function output_joint(set) result(joint)
      type(data_set_t), intent(in) :: set

      joint = 0
      if (set%has_stand_in()) then
         joint = set%sketch%joint_called(set%traced%stand_in)
      else if (size(set%sketch%outputs) > 0) then
         associate (output => set%sketch%outputs(1))
            if (any(output%kind == [output_point, output_x, output_y, output_pose])) joint = output%joints(1)
         end associate
      end if
   end function output_joint

   !> Rates of the output, further outputs of a sketch, bands of tolerance, a family of curves, over the sweep of a valid scene.
   subroutine add_curves(set, study, scene)
      type(data_set_t), intent(in) :: set
      type(row_study_t), intent(inout) :: study
      type(scene_t), intent(inout) :: scene
      type(tolerance_band_t), allocatable :: band
      real(wp) :: size_of
      logical :: found

      size_of = maxval(scene%high - scene%low)
      allocate (band)
      associate (mechanism => study%problem%mechanism)
         call find_band(set, mechanism, study%dimensions, scene%sweep%delt, scene%sweep%closed, band, found)
         if (found) call move_alloc(band, scene%band)
         if (set%has_names()) then
            call find_sweep_outputs(set, study)
            call add_study_panels(set, study%outputs, merge(1, 2, set%has_stand_in()), size_of, scene%panels)
         else
            call add_rate_panels(set, study%sweep, study%dimensions, size_of, scene%panels)
         end if
         if (set%gives('SWEEP')) &
            call add_family_panels(set, mechanism, study%dimensions, scene%sweep%delt, size_of, scene%panels)
      end associate
   end subroutine add_curves

   !> Where a prescribed position lies on the sweep, counted in its positions from 0.
   pure real(wp) function place_on_sweep(scene, position) result(place)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: position
      real(wp) :: whole

      associate (sweep => scene%sweep)
         place = scene%prescribed%delt(position) - sweep%delt(1)
         whole = sweep%delt(sweep%n) - sweep%delt(1)
         if (.not. scene%sliding) then
            place = modulo(scene%sense*place, full_turn)
         else if (abs(whole) > 0.0_wp) then
            place = place/whole*real(sweep%n - 1, wp)
         else
            place = 0.0_wp
         end if
      end associate
   end function place_on_sweep

   !> Directions and desired places of the output belong into the view too, counterweights and springs.
   subroutine widen_view(scene)
      type(scene_t), intent(inout) :: scene
      integer :: k

      do k = 1, scene%prescribed%n
         if (.not. scene%prescribed%closed(k)) cycle
         if (scene%motion == motion_angle) call take(scene%prescribed%actual_mark(:, k))
         if (scene%desired) call take(scene%prescribed%desired_mark(:, k))
      end do
      if (allocated(scene%forces)) call extent_of_weights(scene%forces, scene%low, scene%high)

   contains

      subroutine take(point)
         real(wp), intent(in) :: point(2)

         scene%low = min(scene%low, point)
         scene%high = max(scene%high, point)
      end subroutine take
   end subroutine widen_view

   !> The other assembly of each pair: the common joint mirrored in the line of the outer joints (types 1 to 3), or the other
   !> point of the slide's line at the link's distance (types 4 and 5).
   pure subroutine find_others(scene, row)
      type(scene_t), intent(in) :: scene
      type(position_row_t), intent(inout) :: row
      type(form_t) :: form
      real(wp) :: from(2), along(2), joint(2)
      integer :: loop, k, s
      logical :: mirrored

      allocate (row%other(2, scene%loops, row%n), source=0.0_wp)
      allocate (row%other_known(scene%loops, row%n), source=.false.)
      do loop = 1, scene%loops
         associate (pair => scene%pairs(loop))
            form = form_of(pair%joint_type)
            if (form%power == 0) cycle
            mirrored = all(form%direction /= direction_known)
            s = scene%bars(pair%bars(merge(2, 1, form%slides(2))))%slide
            do k = 1, row%n
               if (.not. row%valid(loop, k)) cycle
               joint = [row%x(pair%shared, k), row%y(pair%shared, k)]
               from = [row%x(pair%start, k), row%y(pair%start, k)]
               along = [row%x(pair%finish, k), row%y(pair%finish, k)] - from
               if (mirrored) then
                  if (norm2(along) <= 0.0_wp) cycle
                  along = along/norm2(along)
                  row%other(:, loop, k) = 2.0_wp*(from + along*dot_product(joint - from, along)) - joint
               else
                  if (form%slides(1)) from = from + along
                  along = [row%ux(s, k), row%uy(s, k)]
                  row%other(:, loop, k) = joint - 2.0_wp*along*dot_product(joint - from, along)
               end if
               row%other_known(loop, k) = .true.
            end do
         end associate
      end do
   end subroutine find_others

   !> Where the output ought to be, and for MOTION 1 the direction it has.
   pure subroutine find_targets(scene, row)
      type(scene_t), intent(in) :: scene
      type(position_row_t), intent(inout) :: row
      real(wp) :: base(2), unit(2)
      integer :: k

      allocate (row%actual_mark(2, row%n), row%desired_mark(2, row%n), source=0.0_wp)
      do k = 1, row%n
         if (scene%motion == motion_point .and. size(row%wanted) > 0) row%desired_mark(:, k) = [row%wanted(k), row%desired_y(k)]
         if (.not. row%closed(k)) cycle
         base = [row%x(scene%output_base, k), row%y(scene%output_base, k)]
         if (scene%motion == motion_angle) then
            call unit_vector(row%actual(k), unit(1), unit(2))
            row%actual_mark(:, k) = base + scene%pointer*unit
         end if
         if (size(row%wanted) == 0) cycle
         select case (scene%motion)
         case (motion_angle)
            call unit_vector(row%wanted(k), unit(1), unit(2))
            row%desired_mark(:, k) = base + scene%pointer*unit
         case (motion_distance)
            if (row%actual(k) <= 0.0_wp) cycle
            row%desired_mark(:, k) = row%wanted(k)*([row%x(scene%output, k), row%y(scene%output, k)]/row%actual(k))
         case (motion_slide)
            associate (slide => scene%slides(scene%output_slide))
               row%desired_mark(:, k) = [row%x(slide%guide, k), row%y(slide%guide, k)] + slide%sense*row%wanted(k)* &
                                [row%ux(scene%output_slide, k), row%uy(scene%output_slide, k)]
            end associate
         end select
      end do
   end subroutine find_targets

   !> Constraints of the group CONSTR, as `psalm` assesses its results.
   subroutine check_constraints(set, own, dimensions, scene)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: own
      type(dimensions_t), intent(in) :: dimensions
      type(scene_t), intent(inout) :: scene
      type(inspector_t) :: inspector
      type(margin_t), allocatable :: margins(:)
      integer :: i

      call prepare_inspector(set, own, set%search%solver%many_starts, inspector)
      call inspect(inspector, dimensions, own%delt, margins)
      do i = 1, size(margins)
         if (.not. is_violated(margins(i))) cycle
         call add_string(scene%breaches, 'violated: '//describe_margin(set, own, dimensions, margins(i), small=.true.))
      end do
   end subroutine check_constraints

   subroutine find_output_slide(mechanism, scene)
      type(mechanism_t), intent(in) :: mechanism
      type(scene_t), intent(inout) :: scene
      integer :: k

      do k = 1, size(scene%slides)
         if (scene%slides(k)%bar == mechanism%arcs(mechanism%outputs(1)%arc)%bar) scene%output_slide = k
      end do
   end subroutine find_output_slide

   ! ---- what is there -----------------------------------------------------------------------------------------------

   !> Joints that are always at the same place are one joint. `place` tells where each went.
   subroutine merge_joints(scene, output, place)
      type(scene_t), intent(inout) :: scene
      integer, intent(in) :: output                   !! the row of the output; points of links off the arcs follow
      integer, allocatable, intent(out) :: place(:)   !! shape (joints)
      integer, allocatable :: kept(:)
      real(wp) :: near
      integer :: j, k, count, joints

      joints = size(scene%prescribed%x, 1)
      allocate (place(joints), kept(joints), source=0)
      associate (x => scene%prescribed%x, y => scene%prescribed%y, known => scene%prescribed%known)
         near = max(maxval(x, known) - minval(x, known), maxval(y, known) - minval(y, known))*same_place
      end associate
      count = 0
      do j = 1, joints
         do k = 1, count
            if (together(scene%prescribed, j, kept(k))) then
               if (together(scene%sweep, j, kept(k))) exit
            end if
         end do
         if (k > count) then
            count = count + 1
            kept(count) = j
         end if
         place(j) = k
      end do
      kept = kept(:count)
      call keep(scene%prescribed)
      call keep(scene%sweep)
      if (scene%chosen%n > 0) call keep(scene%chosen)
      allocate (scene%joints(count))
      scene%output = place(output)
      do k = 1, size(scene%slides)
         scene%slides(k)%guide = place(scene%slides(k)%guide)
         scene%slides(k)%block = place(scene%slides(k)%block)
      end do

   contains

      pure logical function together(row, j, k)
         type(position_row_t), intent(in) :: row
         integer, intent(in) :: j, k
         integer :: i

         together = .false.
         do i = 1, row%n
            if (row%known(j, i) .neqv. row%known(k, i)) return
            if (max(abs(row%x(j, i) - row%x(k, i)), abs(row%y(j, i) - row%y(k, i))) > near) return
         end do
         together = any(row%known(j, :)) .or. .not. any(scene%prescribed%known(j, :))
         ! joints that are known nowhere are not the same for that
         if (.not. any(scene%prescribed%known(j, :)) .and. .not. any(scene%sweep%known(j, :))) together = .false.
      end function together

      subroutine keep(row)
         type(position_row_t), intent(inout) :: row

         row%x = row%x(kept, :)
         row%y = row%y(kept, :)
         row%known = row%known(kept, :)
      end subroutine keep
   end subroutine merge_joints

   !> The bars with their names, then the output arc, then lines to points of links off the arcs.
   subroutine make_bars(mechanism, dimensions, place, sides, scene)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: place(:)
      type(side_point_t), intent(in) :: sides(:)      !! their places are the last ones
      type(scene_t), intent(inout) :: scene
      integer :: b, n, loop, a, k, bars
      character(24) :: name

      bars = size(mechanism%bars) + merge(0, 1, scene%motion == motion_slide)
      allocate (scene%bars(bars + size(sides)))
      do k = 1, size(sides)
         associate (bar => scene%bars(bars + k))
            bar%start = place(sides(k)%base)
            bar%finish = place(size(place) - size(sides) + k)
            bar%length = sides(k)%length
            bar%others = ''
         end associate
      end do
      do b = 1, size(mechanism%bars)
         associate (bar => scene%bars(b))
            bar%start = place(mechanism%bars(b)%ends(at_start))
            bar%finish = place(mechanism%bars(b)%ends(at_finish))
            bar%length = dimensions%arcl(mechanism%bars(b)%arc)
            bar%others = ''
         end associate
      end do
      do k = 1, size(scene%slides)
         scene%bars(scene%slides(k)%bar)%slide = k
      end do
      do loop = 1, mechanism%nloop
         do a = 1, mechanism%loops(loop)%arcs
            n = mechanism%seq(loop, a)
            associate (bar => scene%bars(mechanism%arcs(n)%bar))
               if (bar%loop == 0) then
                  bar%loop = loop
                  bar%arc = a
               else
                  if (mechanism%has_joint_names()) cycle      ! the same line
                  write (name, '("loop ",i0," arc ",i0)') loop, a
                  if (len(bar%others) > 0) bar%others = bar%others//', '
                  bar%others = bar%others//trim(name)
               end if
            end associate
         end do
      end do
      allocate (scene%pairs(mechanism%nloop))
      do loop = 1, mechanism%nloop
         associate (pair => scene%pairs(loop))
            pair%name = group_words(mechanism, loop)
            pair%joint_type = mechanism%groups(loop)%kind
            ! of a larger group its first and its last arc
            associate (p => mechanism%arcs(mechanism%groups(loop)%members(1)), &
                       q => mechanism%arcs(mechanism%groups(loop)%members(size(mechanism%groups(loop)%members))))
               pair%start = place(p%ends(at_start))
               pair%finish = place(q%ends(at_finish))
               pair%shared = place(p%ends(at_finish))
               pair%bars = [p%bar, q%bar]
            end associate
         end associate
      end do
      scene%output_base = scene%output
      if (scene%motion == motion_slide) return
      associate (output => mechanism%outputs(1))
         scene%output_base = place(mechanism%arcs(output%arc)%ends(merge(at_start, at_finish, output%from_start)))
      end associate
      associate (bar => scene%bars(bars))
         bar%start = scene%output_base
         bar%finish = scene%output
         bar%length = dimensions%outlk
         bar%others = ''
      end associate
   end subroutine make_bars

   !> What kind each joint is, and its letter.
   subroutine name_joints(set, mechanism, place, scene)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: place(:)        !! by point of the mechanism: the joint drawn there
      type(scene_t), intent(inout) :: scene
      integer :: j, k, count

      scene%joints(place(mechanism%bodies(body_frame)%points))%fixed = .true.
      do k = 1, size(mechanism%joints)
         if (mechanism%joints(k)%kind == joint_revolute) scene%joints(place(mechanism%joints(k)%point))%turning = .true.
      end do
      do k = 1, size(scene%slides)
         scene%joints(scene%slides(k)%block)%slides = .true.
      end do
      count = 0
      do j = 1, size(scene%joints)
         associate (joint => scene%joints(j))
            joint%name = ''
            if (.not. (joint%turning .or. joint%slides)) cycle
            joint%name = letters(count)
            count = count + 1
         end associate
      end do
      if (.not. set%has_names()) return
      ! a sketch has names of its own; feet of slides keep none
      do j = 1, size(scene%joints)
         scene%joints(j)%name = ''
      end do
      do j = 1, size(mechanism%arcs)
         associate (arc => mechanism%arcs(j))
            do k = at_start, at_finish
               if (arc%joints(k) == 0) cycle
               scene%joints(place(arc%ends(k)))%name = trim(set%sketch%joint_name(arc%joints(k)))
            end do
         end associate
      end do
      ! the output point is the end of no arc
      if (len(scene%joints(scene%output)%name) > 0) return
      j = output_joint(set)
      if (j > 0) scene%joints(scene%output)%name = trim(set%sketch%joint_name(j))

   contains

      !> A to Z, then AA, AB ...
      pure recursive function letters(number) result(name)
         integer, intent(in) :: number
         character(:), allocatable :: name

         name = achar(iachar('A') + modulo(number, 26))
         if (number >= 26) name = letters(number/26 - 1)//name
      end function letters
   end subroutine name_joints

   !> The mechanism's bodies as far as they have bars of fixed length; one with an area is a plate. Bars of one body that hang
   !> together nowhere, as where one is only parallel to the others, are drawn apart. A slide belongs with the body that guides it.
   subroutine make_bodies(mechanism, named, sides, scene, plates)
      type(mechanism_t), intent(in) :: mechanism
      logical, intent(in) :: named        !! the links have names of the user's
      type(side_point_t), intent(in) :: sides(:)
      type(scene_t), intent(inout) :: scene
      type(plate_group_t), intent(in) :: plates
      integer :: body(size(scene%bars))   !! the mechanism's
      integer :: piece(size(scene%bars)), first(size(mechanism%bodies)), b, c, pieces, old

      body(:size(mechanism%bars)) = mechanism%arcs(mechanism%bars%arc)%body
      associate (output => mechanism%outputs(1), bars => size(mechanism%bars), all_bars => size(scene%bars))
         body(all_bars - size(sides) + 1:) = sides%body
         if (all_bars - size(sides) > bars) &
            body(bars + 1) = mechanism%body_at(output%arc, merge(at_start, at_finish, output%from_start))
      end associate
      piece = 0
      pieces = 0
      do b = 1, size(body)
         if (scene%bars(b)%slide > 0) cycle
         do c = 1, b - 1
            if (piece(c) == 0 .or. body(c) /= body(b) .or. .not. touch(b, c)) cycle
            if (piece(b) == 0) then
               piece(b) = piece(c)
            else if (piece(c) /= piece(b)) then
               ! the bar joins two pieces
               old = max(piece(b), piece(c))
               where (piece == old) piece = min(piece(b), piece(c))
            end if
         end do
         if (piece(b) > 0) cycle
         pieces = pieces + 1
         piece(b) = pieces
      end do
      allocate (scene%bodies(0))
      first = 0
      do c = 1, pieces
         b = findloc(piece, c, dim=1)
         if (b == 0) cycle
         call add_body(c, body(b))
         if (first(body(b)) == 0) first(body(b)) = size(scene%bodies)
      end do
      do b = 1, size(mechanism%bars)
         if (scene%bars(b)%slide == 0) cycle
         old = mechanism%guide_of(mechanism%bars(b)%arc)
         scene%bars(b)%body = first(old)
         do c = 1, size(body)
            if (scene%bars(c)%slide > 0 .or. body(c) /= old) cycle
            if (any([scene%bars(c)%start, scene%bars(c)%finish] == scene%slides(scene%bars(b)%slide)%guide)) &
               scene%bars(b)%body = scene%bars(c)%body
         end do
      end do

   contains

      !> True if two bars have a joint in common.
      pure logical function touch(b, c)
         integer, intent(in) :: b, c

         associate (ends => [scene%bars(c)%start, scene%bars(c)%finish])
            touch = any(ends == scene%bars(b)%start .or. ends == scene%bars(b)%finish)
         end associate
      end function touch

      subroutine add_body(number, whole)
         integer, intent(in) :: number    !! of the piece
         integer, intent(in) :: whole     !! of the mechanism's body
         type(drawn_body_t) :: new
         type(drawn_body_t), allocatable :: more(:)
         logical :: member(size(scene%joints))
         integer :: j, k

         member = .false.
         do k = 1, size(piece)
            if (piece(k) /= number) cycle
            member([scene%bars(k)%start, scene%bars(k)%finish]) = .true.
            scene%bars(k)%body = size(scene%bodies) + 1
         end do
         new%joints = pack([(j, j=1, size(member))], member)
         new%frame = whole == body_frame
         k = plate_of_body(plates, mechanism, whole)
         if (k > 0) then
            new%width = plates%plates(k)%width
            new%hole = plates%plates(k)%hole
         end if
         if (named .and. allocated(mechanism%bodies(whole)%name)) new%name = mechanism%bodies(whole)%name
         allocate (new%hull(0))
         do k = 1, scene%prescribed%n
            if (.not. all(scene%prescribed%known(new%joints, k))) cycle
            new%hull = convex_hull(new%joints, scene%prescribed%x(new%joints, k), scene%prescribed%y(new%joints, k))
            exit
         end do
         allocate (more(size(scene%bodies) + 1))
         do k = 1, size(scene%bodies)
            more(k) = scene%bodies(k)
         end do
         more(size(more)) = new
         call move_alloc(more, scene%bodies)
      end subroutine add_body
   end subroutine make_bodies

   ! ---- view --------------------------------------------------------------------------------------------------------

   !> All that is prescribed, and of the sweep what does not make it much smaller.
   subroutine choose_view(scene, longest)
      type(scene_t), intent(inout) :: scene
      real(wp), intent(in) :: longest          !! longest arc
      real(wp) :: low(2), high(2), widest_low(2), widest_high(2), border
      integer :: k, loop

      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      widest_low = -huge(1.0_wp)
      widest_high = huge(1.0_wp)
      do k = 1, scene%prescribed%n
         call take(pack(scene%prescribed%x(:, k), scene%prescribed%known(:, k)), &
                   pack(scene%prescribed%y(:, k), scene%prescribed%known(:, k)))
         do loop = 1, scene%loops
            if (scene%prescribed%broken(loop, k)) &
               call take(scene%prescribed%tip(1::2, loop, k), scene%prescribed%tip(2::2, loop, k))
         end do
         if (allocated(scene%wheels)) call take_wheels(k)
      end do
      if (scene%motion == motion_point .and. scene%desired) call take(scene%prescribed%wanted, scene%prescribed%desired_y)
      if (scene%motion == motion_distance) call take([0.0_wp], [0.0_wp])
      border = maxval(high - low)*enlarge
      widest_low = low - border
      widest_high = high + border
      do k = 1, scene%sweep%n
         call take(pack(scene%sweep%x(:, k), scene%sweep%known(:, k)), pack(scene%sweep%y(:, k), scene%sweep%known(:, k)))
      end do
      if (maxval(high - low) <= 0.0_wp) then
         low = low - max(longest, 1.0_wp)
         high = high + max(longest, 1.0_wp)
      end if
      ! a straight mechanism is given some height
      border = flattest*maxval(high - low)
      where (high - low < border)
         low = low - border
         high = high + border
      end where
      scene%low = low
      scene%high = high

   contains

      subroutine take(x, y)
         real(wp), intent(in) :: x(:), y(:)

         if (size(x) == 0) return
         low = min(low, max([minval(x), minval(y)], widest_low))
         high = max(high, min([maxval(x), maxval(y)], widest_high))
      end subroutine take

      !> The pitch circles at a prescribed position.
      subroutine take_wheels(at)
         integer, intent(in) :: at
         integer :: w

         do w = 1, size(scene%wheels)
            associate (wheel => scene%wheels(w))
               if (.not. scene%prescribed%known(wheel%centre, at)) cycle
               call take(scene%prescribed%x(wheel%centre, at) + wheel%radius*[-1.0_wp, 1.0_wp], &
                         scene%prescribed%y(wheel%centre, at) + wheel%radius*[-1.0_wp, 1.0_wp])
            end associate
         end do
      end subroutine take_wheels
   end subroutine choose_view

   !> How far the rail of each slide reaches: from its guide over all places of its block that can be seen.
   subroutine find_rails(scene)
      type(scene_t), intent(inout) :: scene
      real(wp) :: farthest
      integer :: k

      farthest = maxval(scene%high - scene%low)
      do k = 1, size(scene%slides)
         associate (slide => scene%slides(k))
            call reach(scene%prescribed, huge(1.0_wp))
            call reach(scene%sweep, farthest)
         end associate
      end do

   contains

      subroutine reach(row, limit)
         type(position_row_t), intent(in) :: row
         real(wp), intent(in) :: limit
         real(wp) :: along
         integer :: i

         associate (slide => scene%slides(k))
            do i = 1, row%n
               if (.not. (row%known(slide%guide, i) .and. row%known(slide%block, i))) cycle
               along = slide%sense*((row%x(slide%block, i) - row%x(slide%guide, i))*row%ux(k, i) + &
                                    (row%y(slide%block, i) - row%y(slide%guide, i))*row%uy(k, i))
               slide%low = min(slide%low, max(along, -limit))
               slide%high = max(slide%high, min(along, limit))
            end do
         end associate
      end subroutine reach
   end subroutine find_rails
end module psalm_scene
