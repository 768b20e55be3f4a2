!> The scene of a sketch that has no loops of dyads: larger Assur groups, several or floating drives, gears.
!>
!> Its places come from the poses of the links (`psalm_chain_study`), so that pictures and CASE.csv agree to the last digit. The
!> sweep is a whole turn of a drive that can make one; else the way from position to position, all drives together.
module psalm_chain_scene
   use psalm_angles, only: unit_vector
   use psalm_chain_study, only: chain_study_t, inputs_at, inputs_of_row, study_chain, turn_is_open, turn_may_repeat
   use psalm_closure, only: closure_t, state_t
   use psalm_column_names, only: number_unit, per_time
   use psalm_data_set, only: data_set_t
   use psalm_error, only: violation_t
   use psalm_kinds, only: wp, degrees_per_radian, full_turn
   use psalm_link_outline, only: convex_hull
   use psalm_plate_group, only: plate_group_t, plates_of
   use psalm_markup, only: add_string
   use psalm_output_kind, only: motion_point, motion_angle
   use psalm_panels, only: add_study_panels, with_unit
   use psalm_parts, only: drawn_bar_t, edge_t, drawn_joint_t, drawn_slide_t, wheel_t
   use psalm_scene, only: scene_t, message_scene, choose_view, find_rails, motion_number
   use psalm_row_study, only: row_study_t, solved_row_t
   use psalm_sketch, only: columns_of, sketch_t, drive_turns, frame_link, grid_digits, output_angle, &
                           output_point, output_pose, output_slide
   use psalm_sort, only: ascending
   use psalm_status, only: finding_t
   use psalm_sweep, only: sweep_sense
   use psalm_trace, only: position_row_t
   implicit none (type, external)
   private
   public :: make_chain_scene

   integer, parameter :: way_steps = 240            !! positions of a sweep along a way, about
   integer, parameter :: range_steps = 360          !! of a sweep over the range of one drive
   real(wp), parameter :: on_the_line = 1.0e-9_wp   !! part of the size: a joint as near to a slide's line lies on it
   real(wp), parameter :: back_again = 1.0e-6_wp    !! part of the size, or of a turn: a turn as near to its beginning has come back
   real(wp), parameter :: barrel_part = 0.6_wp      !! of a cylinder's shortest length is its barrel

   !> Points of links that are no joints of the sketch: feet of slides, rims of wheels.
   type :: foot_t
      integer :: link = 0
      complex(wp) :: place = (0.0_wp, 0.0_wp)       !! in the axes of the link
   end type foot_t

contains

   !> The scene of a case. Errors among its findings make it a scene of messages.
   subroutine make_chain_scene(set, findings, scene, chosen, inputs, rows)
      type(data_set_t), intent(in) :: set
      type(finding_t), intent(in) :: findings(:)    !! of this case
      type(scene_t), intent(out) :: scene
      real(wp), intent(in), optional :: chosen      !! increment of the drive at one more position, for DXF
      real(wp), intent(in), optional :: inputs(:, :) !! shape (drives, positions): in place of those of the case
      type(row_study_t), intent(in), optional :: rows !! its loops at its positions, over a sweep and at the position chosen: then
                                                    !! nothing is solved again
      type(chain_study_t), allocatable :: own, sweep
      type(foot_t), allocatable :: feet(:)

      call message_scene(set, findings, scene)
      if (size(scene%errors) > 0) return
      allocate (own)
      if (present(rows)) then
         call study_row(rows%prescribed)
      else
         call study_chain(set, set%rates%speed, set%rates%accel, own, inputs, by_loops=.true.)
      end if
      if (.not. own%valid) return
      scene%valid = .true.
      scene%tangle = set%limits%tangle
      if (present(rows)) then
         call take_sweep()
      else
         call make_sweep(set, own, scene, sweep)
      end if
      call make_parts(set%sketch, own%closure, own%start, scene, feet)
      call set_widths(plates_of(set), scene)
      call choose_output(set%sketch, own, scene)
      call trace_chain(set%sketch, own, feet, scene, scene%prescribed)
      call trace_chain(set%sketch, sweep, feet, scene, scene%sweep)
      if (present(chosen) .and. present(rows)) then
         call trace_chosen(set, own, chosen, feet, scene, rows%chosen)
      else if (present(chosen)) then
         call trace_chosen(set, own, chosen, feet, scene)
      end if
      if (.not. present(inputs)) call take_desired(set, scene)
      call tell_open(set%sketch, own, scene%prescribed)
      call tell_open(set%sketch, sweep, scene%sweep)
      scene%prescribed%violated = .not. all(scene%prescribed%closed)
      scene%reference = nearest_to_drawing(own)
      call finish_bars(scene)
      call choose_view(scene, own%closure%size)
      call find_rails(scene)
      scene%pointer = own%closure%size
      call make_curves(set%sketch, own, sweep, scene)
      if (present(rows)) return
      call make_envelope(set%sketch, own, scene)
      ! the way through a grid has no speed, nor has one from position to position without one
      if (count(.not. set%sketch%drives%geared) > 1) return
      call add_study_panels(set, sweep, size(set%sketch%outputs) + 1, maxval(scene%high - scene%low), scene%panels)

   contains

      !> The prescribed positions, solved already.
      subroutine study_row(row)
         type(solved_row_t), intent(in) :: row

         call study_chain(set, set%rates%speed, set%rates%accel, own, inputs_of_row(set, row), by_loops=.true., solved=row)
      end subroutine study_row

      !> The sweep as it is solved already.
      subroutine take_sweep()
         scene%sliding = rows%problem%mechanism%sliding_input
         scene%sense = sweep_sense(rows%problem)
         scene%prescribed%n = size(own%inputs, 2)
         scene%prescribed%delt = own%inputs(1, :)
         scene%prescribed%input = own%inputs(1, :)
         allocate (sweep)
         call study_chain(set, set%rates%speed, set%rates%accel, sweep, inputs_of_row(set, rows%sweep), by_loops=.true., &
                          other=own, solved=rows%sweep)
         scene%sweep%delt = sweep%inputs(1, :)
         scene%sweep%input = sweep%inputs(1, :)
      end subroutine take_sweep
   end subroutine make_chain_scene

   !> The points that are desired of the first output.
   subroutine take_desired(set, scene)
      type(data_set_t), intent(in) :: set
      type(scene_t), intent(inout) :: scene

      if (size(set%sketch%outputs) == 0 .or. scene%motion /= motion_point) return
      associate (row => scene%prescribed, target => set%sketch%outputs(1)%targets(0), method => set%method)
         if (allocated(target%values)) then
            if (size(target%values, 2) /= row%n) return
            row%wanted = target%values(1, :)
            row%desired_y = target%values(2, :)
         else
            ! of loops
            if (.not. method%desired .or. method%ikin /= 0 .or. method%ndes /= row%n) return
            if (set%sketch%joint_of_output(1) /= scene%output) return
            row%wanted = method%desx + method%xadd
            row%desired_y = method%desy + method%yadd
         end if
         scene%desired = .true.
         row%desired_mark(1, :) = row%wanted
         row%desired_mark(2, :) = row%desired_y
         where (row%closed)
            row%error = row%wanted - row%actual
            row%error_y = row%desired_y - row%actual_y
         end where
      end associate
   end subroutine take_desired

   !> One more position, by its increment.
   subroutine trace_chosen(set, own, increment, feet, scene, solved)
      type(data_set_t), intent(in) :: set
      type(chain_study_t), intent(in) :: own
      real(wp), intent(in) :: increment
      type(foot_t), intent(in) :: feet(:)
      type(scene_t), intent(inout) :: scene
      type(solved_row_t), intent(in), optional :: solved !! its loops there
      type(chain_study_t), allocatable :: study

      allocate (study)
      call study_chain(set, 1.0_wp, 0.0_wp, study, inputs_at(set, [increment]), by_loops=.true., other=own, solved=solved)
      call trace_chain(set%sketch, study, feet, scene, scene%chosen)
   end subroutine trace_chosen

   !> The prescribed position nearest to the drawing that closes; the first if none does.
   pure integer function nearest_to_drawing(study) result(place)
      type(chain_study_t), intent(in) :: study

      place = max(1, minloc(sum(study%inputs**2, dim=1), dim=1, mask=study%motion%closed))
   end function nearest_to_drawing

   ! ---- sweep -------------------------------------------------------------------------------------------------------

   !> Positions between and beyond those of the case.
   subroutine make_sweep(set, own, scene, sweep)
      type(data_set_t), intent(in) :: set
      type(chain_study_t), intent(in) :: own
      type(scene_t), intent(inout) :: scene
      type(chain_study_t), allocatable, intent(out) :: sweep
      integer :: i, n, free

      n = size(own%inputs, 2)
      free = count(.not. set%sketch%drives%geared)
      scene%prescribed%n = n
      scene%sliding = .true.
      if (free == 1) then
         scene%prescribed%delt = own%inputs(1, :)
         scene%prescribed%input = own%inputs(1, :)
         if (set%sketch%drives(1)%kind == drive_turns) then
            if (n > 1) scene%sense = sign(1.0_wp, own%inputs(1, 2) - own%inputs(1, 1))
            if (may_come_back()) then
               call run([(own%inputs(1, 1) + scene%sense*real(i, wp), i=0, nint(full_turn))])
               scene%sliding = .not. came_back()
            end if
            if (.not. scene%sliding) then
               ! the last position is the first again
               call sweep%leave_last_out()
               scene%prescribed%input = modulo(own%inputs(1, :), full_turn)
               scene%sweep%delt = sweep%inputs(1, :)
               scene%sweep%input = sweep%inputs(1, :)
               scene%input_label = 'drive '//trim(set%sketch%drives(1)%name)//', degrees from the drawing'
               return
            end if
         end if
         associate (low => minval(own%inputs(1, :)), high => maxval(own%inputs(1, :)))
            if (high > low) then
               call run([(low + (high - low)*(real(i, wp)/real(range_steps, wp)), i=0, range_steps)])
            else
               call run([low])
            end if
         end associate
         scene%sweep%delt = sweep%inputs(1, :)
         scene%sweep%input = sweep%inputs(1, :)
         scene%input_label = 'drive '//trim(set%sketch%drives(1)%name)// &
                             trim(merge(', degrees', ', length ', set%sketch%drives(1)%kind == drive_turns))//' from the drawing'
         return
      end if
      ! several drives: the way through all positions
      associate (between => max(1, way_steps/max(1, n - 1)))
         scene%prescribed%delt = [(real(i - 1, wp), i=1, n)]
         scene%sweep%delt = [(real(i, wp)/real(between, wp), i=0, (n - 1)*between)]
         call run(along(own%inputs(1, :), scene%sweep%delt))
      end associate
      scene%prescribed%input = scene%prescribed%delt + 1.0_wp
      scene%sweep%input = scene%sweep%delt + 1.0_wp
      scene%input_label = 'position'

   contains

      !> Positions at values of the first drive, counted from the drawing.
      subroutine run(first)
         real(wp), intent(in) :: first(:)
         real(wp), allocatable :: inputs(:, :)
         integer :: d

         inputs = inputs_at(set, first - set%method%crnki)
         do d = 2, size(inputs, 1)
            if (.not. set%sketch%drives(d)%geared) inputs(d, :) = along(own%inputs(d, :), scene%sweep%delt)
         end do
         if (allocated(sweep)) deallocate (sweep)
         allocate (sweep)
         call study_chain(set, set%rates%speed, set%rates%accel, sweep, inputs, by_loops=.true., other=own)
      end subroutine run

      !> False where a turn need not be tried: drives or wheels stand elsewhere after it, or the linkage does not go so far. Where
      !> only the turn itself tells how its wheels turn, the one position after it shows whether they are back.
      logical function may_come_back()
         may_come_back = turn_may_repeat(set)
         if (may_come_back .and. allocated(own%looped)) then
            associate (reach => own%looped%reach)
               if (reach%known .and. reach%followed(1) >= full_turn) &
                  may_come_back = reach%ends(1) - reach%ends(2) >= (1.0_wp - back_again)*full_turn
            end associate
         end if
         if (.not. may_come_back .or. .not. turn_is_open(set)) return
         call run([own%inputs(1, 1) + scene%sense*full_turn])
         if (sweep%motion%closed(1) .and. own%motion%closed(1)) may_come_back = are_together(own%motion%states(1), &
                                                                                             sweep%motion%states(1))
      end function may_come_back

      !> True if a whole turn closes everywhere and ends where it began.
      logical function came_back()
         came_back = all(sweep%motion%closed)
         if (.not. came_back) return
         came_back = are_together(sweep%motion%states(1), sweep%motion%states(size(sweep%motion%states)))
      end function came_back

      !> True if all joints of the one state are where those of the other are.
      pure logical function are_together(one, other)
         type(state_t), intent(in) :: one, other

         are_together = maxval(abs(one%joint(:, 0) - other%joint(:, 0))) < back_again*own%closure%size
      end function are_together

      !> Values at places between those of a row.
      pure function along(values, places) result(between)
         real(wp), intent(in) :: values(:), places(:)
         real(wp) :: between(size(places))
         integer :: k, m

         do k = 1, size(places)
            m = min(size(values) - 1, int(places(k)) + 1)
            if (size(values) == 1) then
               between(k) = values(1)
            else
               between(k) = values(m) + (places(k) - real(m - 1, wp))*(values(m + 1) - values(m))
            end if
         end do
      end function along
   end subroutine make_sweep

   ! ---- parts -------------------------------------------------------------------------------------------------------

   !> Widths and holes of the links that are cut from plate.
   pure subroutine set_widths(plates, scene)
      type(plate_group_t), intent(in) :: plates
      type(scene_t), intent(inout) :: scene
      integer :: link, k

      do link = 1, size(scene%bodies)
         k = plates%plate_of_link(link)
         if (k == 0) cycle
         scene%bodies(link)%width = plates%plates(k)%width
         scene%bodies(link)%hole = plates%plates(k)%hole
      end do
   end subroutine set_widths

   !> Joints, links, slides and wheels; feet of slides and rims of wheels are joints without a name.
   subroutine make_parts(sketch, closure, start, scene, feet)
      type(sketch_t), intent(in) :: sketch
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: start
      type(scene_t), intent(inout) :: scene
      type(foot_t), allocatable, intent(out) :: feet(:)
      type(drawn_joint_t) :: joint
      integer :: i, j

      allocate (feet(0))
      if (allocated(scene%pairs)) deallocate (scene%pairs, scene%bars, scene%bodies, scene%slides)
      allocate (scene%pairs(0), scene%bars(0), scene%bodies(size(sketch%links)), scene%slides(size(sketch%slides)))
      do i = 1, size(sketch%links)
         scene%bodies(i)%joints = sketch%links(i)%joints
         scene%bodies(i)%frame = i == frame_link
         scene%bodies(i)%name = trim(sketch%links(i)%name)
         allocate (scene%bodies(i)%hull(0))
         call outline_link(i)
      end do
      do i = 1, size(sketch%slides)
         call add_slide(i)
      end do
      allocate (scene%wheels(0))
      do i = 1, size(sketch%gears)
         associate (gear => sketch%gears(i))
            call add_wheels(gear%wheels(1), gear%wheels(2), common(gear%wheels(1), gear%carrier), &
                            common(gear%wheels(2), gear%carrier), gear%ratio)
         end associate
      end do
      do i = 2, size(sketch%drives)
         associate (drive => sketch%drives(i), first => sketch%drives(1))
            if (.not. drive%geared .or. drive%ratio >= 0.0_wp) cycle
            if (drive%kind /= drive_turns .or. first%kind /= drive_turns .or. drive%base /= first%base) cycle
            call add_wheels(first%link, drive%link, first%joint, drive%joint, drive%ratio)
         end associate
      end do
      if (allocated(scene%joints)) deallocate (scene%joints)
      allocate (scene%joints(size(sketch%joint_name) + size(feet)))
      do j = 1, size(scene%joints)
         joint = drawn_joint_t(name='')
         if (j <= size(sketch%joint_name)) then
            joint%name = trim(sketch%joint_name(j))
            joint%turning = size(sketch%links_of(j)) > 1
            joint%fixed = sketch%has_joint(frame_link, j)
         else
            joint%fixed = feet(j - size(sketch%joint_name))%link == frame_link
         end if
         joint%slides = any(scene%slides%block == j)
         scene%joints(j) = joint
      end do

   contains

      !> A link's bars: along its outline; inner joints hang on the nearest one.
      subroutine outline_link(link)
         integer, intent(in) :: link
         integer, allocatable :: ring(:)
         real(wp) :: x(size(sketch%links(link)%joints)), y(size(x))
         integer :: order(size(x)), a, b, nearest

         associate (joints => sketch%links(link)%joints)
            if (size(joints) < 2) return
            x = start%joint(joints, 0)%re
            y = start%joint(joints, 0)%im
            ring = convex_hull(joints, x, y)
            scene%bodies(link)%hull = ring
            if (size(ring) == 0) then
               order = order_along(x, y)
               do a = 2, size(order)
                  call add_bar(link, joints(order(a - 1)), joints(order(a)))
               end do
               return
            end if
            do a = 1, size(ring)
               call add_bar(link, ring(a), ring(modulo(a, size(ring)) + 1))
            end do
            do a = 1, size(joints)
               if (any(ring == joints(a))) cycle
               nearest = ring(1)
               do b = 2, size(ring)
                  if (abs(start%joint(ring(b), 0) - start%joint(joints(a), 0)) < &
                      abs(start%joint(nearest, 0) - start%joint(joints(a), 0))) nearest = ring(b)
               end do
               call add_bar(link, joints(a), nearest)
            end do
         end associate
      end subroutine outline_link

      subroutine add_bar(link, from, to)
         integer, intent(in) :: link, from, to
         type(drawn_bar_t) :: bar

         bar%start = from
         bar%finish = to
         bar%body = link
         bar%others = ''
         bar%cylinder = closure%cylinder(link) > 0
         scene%bars = [scene%bars, bar]
      end subroutine add_bar

      !> Number of a point of a link as a joint of the scene.
      integer function foot(link, place)
         integer, intent(in) :: link
         complex(wp), intent(in) :: place

         feet = [feet, foot_t(link, place)]
         foot = size(sketch%joint_name) + size(feet)
      end function foot

      !> A slide runs on the frame, else on the link with more joints; each side has its foot on the line.
      subroutine add_slide(which)
         integer, intent(in) :: which
         type(drawn_slide_t) :: slide
         integer :: guide, block

         guide = 1
         associate (links => sketch%slides(which)%links)
            if (links(2) == frame_link) guide = 2
            if (all(links /= frame_link) .and. size(sketch%links(links(2))%joints) > size(sketch%links(links(1))%joints)) guide = 2
            block = 3 - guide
            slide%guide = foot_on_line(which, guide)
            slide%block = foot_on_line(which, block)
            slide%still = links(guide) == frame_link
            slide%of = which
            call add_bar(links(guide), slide%guide, slide%block)
         end associate
         slide%bar = size(scene%bars)
         scene%bars(slide%bar)%slide = which
         scene%slides(which) = slide
      end subroutine add_slide

      !> Where a link touches the line of its slide: a joint on it, else the foot of the nearest one, with a bar to it.
      integer function foot_on_line(which, side) result(point)
         integer, intent(in) :: which, side
         complex(wp) :: at
         real(wp) :: away, least
         integer :: k, nearest

         associate (link => sketch%slides(which)%links(side), line => closure%line(which), &
                    origin => closure%slide_point(side, which))
            nearest = 0
            least = huge(least)
            associate (joints => sketch%links(link)%joints)
               do k = 1, size(joints)
                  away = abs(aimag((closure%point(joints(k), link) - origin)*conjg(line)))
                  if (away >= least) cycle
                  least = away
                  nearest = joints(k)
               end do
            end associate
            if (nearest == 0) then
               point = foot(link, origin)
            else if (least <= on_the_line*closure%size) then
               point = nearest
            else
               at = origin + line*real((closure%point(nearest, link) - origin)*conjg(line), wp)
               point = foot(link, at)
               call add_bar(link, nearest, point)
            end if
         end associate
      end function foot_on_line

      !> Pitch circles of a gear pair from the distance of its centres; on each a point that shows how it turns.
      subroutine add_wheels(a, b, centre_a, centre_b, ratio)
         integer, intent(in) :: a, b, centre_a, centre_b
         real(wp), intent(in) :: ratio              !! turns of b by turns of a; negative for an external pair
         complex(wp) :: d

         if (centre_a == 0 .or. centre_b == 0) return
         if (ratio == 1.0_wp) return
         d = start%joint(centre_b, 0) - start%joint(centre_a, 0)
         if (abs(d) <= 0.0_wp) return
         ! the pitch point has the same speed on both wheels
         call add_wheel(a, centre_a, d*ratio/(ratio - 1.0_wp))
         call add_wheel(b, centre_b, d/(ratio - 1.0_wp))
      end subroutine add_wheels

      subroutine add_wheel(link, centre, arm)
         integer, intent(in) :: link, centre
         complex(wp), intent(in) :: arm             !! from the centre to the pitch point, machine axes, at the drawing

         scene%wheels = [scene%wheels, wheel_t(link, centre, foot(link, closure%point(centre, link) + &
                                                                  arm*conjg(direction(start%phi(link, 0)))), abs(arm))]
      end subroutine add_wheel

      !> A joint of both links; 0: there is none.
      pure integer function common(one, other)
         integer, intent(in) :: one, other

         do common = 1, size(sketch%joint_name)
            if (sketch%has_joint(one, common) .and. sketch%has_joint(other, common)) return
         end do
         common = 0
      end function common
   end subroutine make_parts

   !> Points of a line in their order along it.
   pure function order_along(x, y) result(order)
      real(wp), intent(in) :: x(:), y(:)
      integer :: order(size(x))

      if (maxval(y) - minval(y) > maxval(x) - minval(x)) then
         order = ascending(y)
      else
         order = ascending(x)
      end if
   end function order_along

   !> Lengths of bars; the barrel of each cylinder. Where no prescribed position is reached they are those of the sweep; 0 of a bar
   !> that is reached nowhere.
   subroutine finish_bars(scene)
      type(scene_t), intent(inout) :: scene
      real(wp) :: prescribed, swept
      integer :: b

      do b = 1, size(scene%bars)
         associate (bar => scene%bars(b))
            prescribed = least_length(scene%prescribed, bar%start, bar%finish)
            swept = least_length(scene%sweep, bar%start, bar%finish)
            if (min(prescribed, swept) >= huge(1.0_wp)) cycle
            bar%length = merge(prescribed, swept, prescribed < huge(1.0_wp))
            if (bar%cylinder) bar%barrel = barrel_part*min(prescribed, swept)
         end associate
      end do

   contains

      !> The largest number if none is known.
      pure real(wp) function least_length(row, a, b)
         type(position_row_t), intent(in) :: row
         integer, intent(in) :: a, b

         least_length = minval(hypot(row%x(a, :) - row%x(b, :), row%y(a, :) - row%y(b, :)), &
                               mask=row%known(a, :) .and. row%known(b, :))
      end function least_length
   end subroutine finish_bars

   ! ---- output ------------------------------------------------------------------------------------------------------

   !> The first output is drawn: a point with its path, an angle as the direction of its line, other numbers at one of their joints.
   subroutine choose_output(sketch, own, scene)
      type(sketch_t), intent(in) :: sketch
      type(chain_study_t), intent(in) :: own
      type(scene_t), intent(inout) :: scene
      integer :: j

      scene%motion = motion_number
      scene%output = 0
      if (size(sketch%outputs) > 0) then
         associate (output => sketch%outputs(1))
            scene%output = sketch%joint_of_output(1)
            select case (output%kind)
            case (output_point, output_pose)
               scene%motion = motion_point
            case (output_angle)
               scene%motion = motion_angle
            case (output_slide)
               do j = 1, size(scene%slides)
                  if (scene%slides(j)%of == output%slide) scene%output = scene%slides(j)%block
               end do
            end select
            scene%output_base = scene%output
            if (output%kind == output_angle) scene%output_base = output%joints(1)
            scene%output_label = trim(own%names(1))
            if (columns_of(output) > 1) scene%output_label = trim(output%name)
         end associate
      end if
      if (scene%output > 0) return
      ! without an output it is the last moving joint
      scene%motion = motion_point
      do j = 1, size(sketch%joint_name)
         if (.not. sketch%has_joint(frame_link, j)) scene%output = j
      end do
      scene%output = max(1, scene%output)
      scene%output_base = scene%output
      scene%output_label = 'joint '//trim(sketch%joint_name(scene%output))
   end subroutine choose_output

   !> Everything at a row of positions; `row%delt` and `row%input` are there.
   subroutine trace_chain(sketch, study, feet, scene, row)
      type(sketch_t), intent(in) :: sketch
      type(chain_study_t), intent(in) :: study
      type(foot_t), intent(in) :: feet(:)
      type(scene_t), intent(in) :: scene
      type(position_row_t), intent(inout) :: row
      complex(wp) :: z
      integer :: k, j, n, joints

      n = size(study%motion%closed)
      joints = size(scene%joints)
      row%n = n
      row%closed = study%motion%closed
      allocate (row%actual(n), row%actual_y(n), row%error(n), row%error_y(n), source=0.0_wp)
      allocate (row%wanted(0), row%desired_y(0))
      allocate (row%x(joints, n), row%y(joints, n), source=0.0_wp)
      allocate (row%ux(size(scene%slides), n), row%uy(size(scene%slides), n), source=0.0_wp)
      allocate (row%known(joints, n), row%valid(0, n), row%broken(0, n), row%other_known(0, n))
      allocate (row%tip(4, 0, n), row%other(2, 0, n), row%angle(0, n), row%actual_mark(2, n), row%desired_mark(2, n))
      row%actual_mark = 0.0_wp
      row%desired_mark = 0.0_wp
      allocate (row%violations(0))
      if (allocated(row%words)) deallocate (row%words)
      allocate (row%words(0))
      do k = 1, n
         row%known(:, k) = row%closed(k)
         if (.not. row%closed(k)) cycle
         associate (state => study%motion%states(k))
            do j = 1, joints
               if (j <= size(sketch%joint_name)) then
                  z = state%joint(j, 0)
               else
                  associate (foot => feet(j - size(sketch%joint_name)))
                     z = state%t(foot%link, 0) + direction(state%phi(foot%link, 0))*foot%place
                  end associate
               end if
               row%x(j, k) = z%re
               row%y(j, k) = z%im
            end do
            do j = 1, size(scene%slides)
               z = direction(state%phi(sketch%slides(j)%links(1), 0))*study%closure%line(j)
               row%ux(j, k) = z%re
               row%uy(j, k) = z%im
            end do
         end associate
         row%actual_mark(:, k) = [row%x(scene%output, k), row%y(scene%output, k)]
         row%desired_mark(:, k) = row%actual_mark(:, k)
         if (scene%motion == motion_point) then
            row%actual(k) = row%actual_mark(1, k)
            row%actual_y(k) = row%actual_mark(2, k)
         else
            row%actual(k) = study%values(1, 0, k)
         end if
      end do
   end subroutine trace_chain

   !> exp(i angle).
   elemental complex(wp) function direction(angle)
      real(wp), intent(in) :: angle                 !! radians
      real(wp) :: c, s

      call unit_vector(angle*degrees_per_radian, c, s)
      direction = cmplx(c, s, wp)
   end function direction

   !> Where the linkage does not close, and the links that stand at a dead point on the way there.
   subroutine tell_open(sketch, study, row)
      type(sketch_t), intent(in) :: sketch
      type(chain_study_t), intent(in) :: study
      type(position_row_t), intent(inout) :: row
      type(violation_t) :: violation
      integer :: k, last

      k = 1
      do while (k <= row%n)
         last = k
         if (.not. row%closed(k)) then
            do while (last < row%n)
               if (row%closed(last + 1)) exit
               if (study%motion%group(last + 1) /= study%motion%group(k)) exit
               last = last + 1
            end do
            violation%first = k
            violation%last = last
            row%violations = [row%violations, violation]
            call add_string(row%words, links_of(study%motion%group(k))//' a dead point on the way here')
         end if
         k = last + 1
      end do

   contains

      function links_of(group) result(text)
         integer, intent(in) :: group
         character(:), allocatable :: text
         integer :: l

         text = 'Does not close: there is'
         if (group == 0) return
         associate (links => study%closure%groups(group)%links)
            if (size(links) == 0) return
            text = trim(merge('Link  ', 'Links ', size(links) == 1))
            do l = 1, size(links)
               text = text//' '//trim(sketch%links(links(l))%name)
               if (l < size(links)) text = text//','
            end do
            text = text//trim(merge(' stands', ' stand ', size(links) == 1))//' at'
         end associate
      end function links_of
   end subroutine tell_open

   ! ---- curves and envelope -----------------------------------------------------------------------------------------

   !> Every output, and every drive where there are several.
   subroutine make_curves(sketch, own, sweep, scene)
      type(sketch_t), intent(in) :: sketch
      type(chain_study_t), intent(in) :: own, sweep
      type(scene_t), intent(inout) :: scene
      integer :: n, d

      allocate (scene%curves(size(own%names)), scene%drives(size(sketch%drives)))
      do n = 1, size(own%names)
         ! components one by one: gfortran 12 loses the stride of a section in a structure constructor
         associate (curve => scene%curves(n))
            curve%name = with_unit(trim(own%names(n)), number_unit(sketch%outputs, n, per_time(), 0))
            curve%angle = own%angles(n)
            curve%prescribed = own%values(n, 0, :)
            curve%sweep = sweep%values(n, 0, :)
         end associate
      end do
      do d = 1, size(sketch%drives)
         associate (drive => scene%drives(d))
            drive%name = sketch%drive_label(d)
            drive%turning = sketch%drives(d)%kind == drive_turns
            drive%prescribed = own%inputs(d, :)
            drive%sweep = sweep%inputs(d, :)
         end associate
      end do
   end subroutine make_curves

   !> What the output point reaches over a grid of the drives' strokes: the meshes of the grid, one quadrilateral each, and the
   !> curves along which all drives but one are at an end of their strokes.
   subroutine make_envelope(sketch, own, scene)
      type(sketch_t), intent(in) :: sketch
      type(chain_study_t), intent(in) :: own
      type(scene_t), intent(inout) :: scene
      integer :: counts(size(sketch%drives)), digits(size(sketch%drives))
      integer, allocatable :: at(:)                 !! position by the number of its digits
      real(wp), allocatable :: meshes(:, :, :)
      integer :: k, d, e, corners(4), found

      counts = max(1, sketch%drives%steps)
      if (scene%motion /= motion_point .or. count(counts > 1) < 2) return
      allocate (at(product(counts)), scene%edges(0))
      associate (ways => count(counts > 1))
         allocate (meshes(2, 4, size(at)*ways*(ways - 1)/2))
      end associate
      found = 0
      do k = 1, size(at)
         at(number_of(grid_digits(counts, k))) = k
      end do
      do k = 1, size(at)
         digits = grid_digits(counts, k)
         do d = 1, size(counts)
            if (digits(d) + 1 >= counts(d)) cycle
            do e = d + 1, size(counts)
               if (digits(e) + 1 >= counts(e)) cycle
               corners = [k, at(number_of(step(digits, d))), at(number_of(step(step(digits, d), e))), &
                          at(number_of(step(digits, e)))]
               if (all(own%motion%closed(corners))) call add_mesh()
            end do
         end do
      end do
      scene%meshes = meshes(:, :, :found)
      do d = 1, size(counts)
         if (counts(d) < 2) cycle
         do k = 1, size(at)
            digits = grid_digits(counts, k)
            if (digits(d) /= 0) cycle
            if (any(digits /= 0 .and. digits /= counts - 1)) cycle
            call add_edge()
         end do
      end do

   contains

      pure integer function number_of(digits)
         integer, intent(in) :: digits(:)
         integer :: m

         number_of = 0
         do m = size(digits), 1, -1
            number_of = number_of*counts(m) + digits(m)
         end do
         number_of = number_of + 1
      end function number_of

      pure function step(digits, along) result(next)
         integer, intent(in) :: digits(:), along
         integer :: next(size(digits))

         next = digits
         next(along) = next(along) + 1
      end function step

      !> All meshes run the same way round, so that together they fill what they cover.
      subroutine add_mesh()
         real(wp) :: mesh(2, 4), area
         integer :: m

         do m = 1, 4
            mesh(:, m) = [scene%prescribed%x(scene%output, corners(m)), scene%prescribed%y(scene%output, corners(m))]
         end do
         area = 0.0_wp
         do m = 1, 4
            area = area + mesh(1, m)*mesh(2, modulo(m, 4) + 1) - mesh(2, m)*mesh(1, modulo(m, 4) + 1)
         end do
         if (area < 0.0_wp) mesh = mesh(:, 4:1:-1)
         found = found + 1
         meshes(:, :, found) = mesh
      end subroutine add_mesh

      !> The drive d from end to end, the others where they are.
      subroutine add_edge()
         type(edge_t) :: edge
         real(wp) :: line(2, counts(d))
         integer :: m, n, p

         n = 0
         do m = 1, counts(d)
            digits(d) = m - 1
            p = at(number_of(digits))
            if (.not. own%motion%closed(p)) cycle
            n = n + 1
            line(:, n) = [scene%prescribed%x(scene%output, p), scene%prescribed%y(scene%output, p)]
         end do
         if (n < 2) return
         edge%x = line(1, :n)
         edge%y = line(2, :n)
         scene%edges = [scene%edges, edge]
      end subroutine add_edge
   end subroutine make_envelope
end module psalm_chain_scene
