!> A choice of drives for a motion in time: the case with the drives that it names, or with others in their place.
!>
!> Others are drives of a sketch drawn anew where the links are, whose loops are traced from them. Masses, loads and springs are
!> carried over from body to body where they are then, so that nothing is read again; forces of joints are sorted into the columns
!> that the case has.
module psalm_time_chart
   use psalm_angles, only: degrees_of, nearest_difference
   use psalm_cases, only: resolve_drawn
   use psalm_change_point, only: change_point_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, make_problem
   use psalm_force_analysis, only: column_drive, column_moment, column_of_joint, column_of_other_drive
   use psalm_force_model, only: force_model_t, body_of_link, make_force_model, vertices_of, parameter_mass, parameter_mx, &
                                parameter_my, parameter_inertia
   use psalm_free_motion, only: free_motion_t, free_state_t, make_free_motion
   use psalm_joint_location, only: locate_sketch
   use psalm_joint_stops, only: joint_stop_t, make_stops, rate_at, rubbing_joints, watch_joint
   use psalm_kinds, only: wp, degrees_per_radian, full_turn
   use psalm_locations, only: location_t
   use psalm_loop_forces, only: link_of_body
   use psalm_mechanism, only: mechanism_t, at_finish, at_start, body_frame, joint_prismatic, joint_revolute
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_place, only: place_t
   use psalm_preparation, only: prepared_t, prepare
   use psalm_rates, only: rates_t, prepare_rates, differentiate, highest_order
   use psalm_sketch, only: sketch_t, drive_t, drive_slides, drive_stretches, drive_turns
   use psalm_source, only: line_t
   use psalm_spring_law, only: part_elastic, part_viscous
   use psalm_status, only: diagnostics_t
   use psalm_time_motion, only: time_motion_t
   implicit none (type, external)
   private
   public :: time_chart_t, list_drives, exchange_drives

   real(wp), parameter :: elsewhere = 0.5_wp      !! weight of a drive that is not on the frame: its groups are larger
   real(wp), parameter :: same = 1.0e-9_wp        !! part of the largest: what both choices of drives must agree in

   !> A choice of drives, and what is shown of the motion by it.
   type :: time_chart_t
      class(data_set_t), allocatable :: set       !! not allocated: the case itself
      class(problem_t), allocatable :: shown      !! with the joints of the sketch
      type(rates_t), allocatable :: rates
      type(sketch_motion_t) :: sketch
      type(drive_t), allocatable :: drives(:)     !! those there might be, as `joints` of the motion has them
      real(wp), allocatable :: travelled(:)       !! by slide: from time 0 to where it was drawn
      integer, allocatable :: same_joint(:)       !! by joint of the case: the joint here whose force is listed, or those that are
      logical, allocatable :: rest_of(:)          !! by joint of the case: it is what is left of the pin, all others with - before
      type(change_point_t), allocatable :: passing !! the change point of the motion, in what is shown
      integer :: passages = 0                     !! which of those that the motion had
   contains
      procedure :: solve_shown
      procedure :: follow
      procedure :: columns_of_case
   end type time_chart_t

contains

   !> The joints and slides of a case that could be drives, those that move freely now first.
   subroutine list_drives(set, chart, moving)
      type(data_set_t), intent(in) :: set            !! with its loops
      type(time_chart_t), intent(inout) :: chart
      type(time_motion_t), intent(inout) :: moving
      type(drive_t), allocatable :: all_of(:)
      type(joint_stop_t) :: one
      integer, allocatable :: links(:)
      integer :: j, k, n

      if (allocated(moving%joints)) deallocate (moving%joints, moving%weights)
      if (size(moving%motion%free) == 0 .or. any(set%sketch%drives%geared .or. set%sketch%drives%kind == drive_stretches) .or. &
          size(set%sketch%gears) > 0) return
      associate (sketch => set%sketch, free => moving%motion%free)
         all_of = sketch%drives(free)
         do j = 1, size(sketch%joint_name)
            links = sketch%links_of(j)
            do k = 2, size(links)
               call add(drive_t(name=sketch%joint_name(j), kind=drive_turns, joint=j, base=links(1), link=links(k)))
            end do
         end do
         do j = 1, size(sketch%slides)
            call add(drive_t(name=sketch%slides(j)%name, kind=drive_slides, slide=j, base=sketch%slides(j)%links(1), &
                             link=sketch%slides(j)%links(2)))
         end do
      end associate
      allocate (moving%joints(size(all_of)), moving%weights(size(all_of)))
      n = 0
      do k = 1, size(all_of)
         call joint_of(set, moving%motion%problem, all_of(k), one)
         if (one%joint == 0) then
            ! a drive that is no joint is not compared, and none then takes its place
            if (k <= size(moving%motion%free)) exit
            cycle
         end if
         n = n + 1
         moving%joints(n) = one
         all_of(n) = all_of(k)
         moving%weights(n) = 1.0_wp
         if (one%slides) moving%weights(n) = 1.0_wp/moving%size_of_linkage()
         if (n > size(moving%motion%free) .and. all(one%bodies /= body_frame)) moving%weights(n) = elsewhere*moving%weights(n)
      end do
      if (n < size(moving%motion%free)) n = 0
      moving%joints = moving%joints(:n)
      moving%weights = moving%weights(:n)
      chart%drives = all_of(:n)
      if (n == 0) deallocate (moving%joints, moving%weights)

   contains

      !> Add a drive if it is not there.
      subroutine add(drive)
         type(drive_t), intent(in) :: drive
         integer :: i

         do i = 1, size(set%sketch%drives)
            associate (there => set%sketch%drives(i))
               if (there%kind == drive%kind .and. there%joint == drive%joint .and. there%slide == drive%slide .and. &
                   any(there%link == [drive%base, drive%link]) .and. any(there%base == [drive%base, drive%link])) return
            end associate
         end do
         all_of = [all_of, drive]
      end subroutine add
   end subroutine list_drives

   !> The joint of a drive; `joint` is 0 where it has none.
   subroutine joint_of(set, problem, drive, one)
      type(data_set_t), intent(in) :: set
      class(problem_t), intent(in) :: problem
      type(drive_t), intent(in) :: drive
      type(joint_stop_t), intent(out) :: one
      type(place_t) :: place
      integer :: k

      if (drive%kind == drive_slides) then
         place%slide = drive%slide
         place%loop = set%traced%travels(drive%slide)%loop
         place%arc = set%traced%travels(drive%slide)%arc
         call watch_joint(set, problem, place, one)
      else if (drive%kind == drive_turns) then
         one%bodies = [body_of_link(problem%mechanism, drive%base), body_of_link(problem%mechanism, drive%link)]
         associate (joints => problem%mechanism%joints)
            do k = 1, size(joints)
               if (joints(k)%kind == joint_revolute .and. pin_of(problem%mechanism, k) == drive%joint) one%joint = k
            end do
         end associate
      end if
   end subroutine joint_of

   !> The joint of the sketch that a revolute joint is; 0: none.
   pure integer function pin_of(mechanism, joint)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: joint

      associate (of => mechanism%joints(joint))
         pin_of = mechanism%arcs(of%arc)%joints(of%end)
      end associate
   end function pin_of

   !> Let other drives take the place of the free ones. `done` is false where that cannot be; all is then as it was.
   subroutine exchange_drives(set, of_case, chart, moving, chosen, state, done)
      type(data_set_t), intent(in) :: set            !! the case
      type(mechanism_t), intent(in) :: of_case
      type(time_chart_t), intent(inout) :: chart
      type(time_motion_t), intent(inout) :: moving
      integer, intent(in) :: chosen(:)               !! shape (free drives): of the drives there might be
      type(free_state_t), intent(in) :: state        !! now
      logical, intent(out) :: done

      if (allocated(chart%set)) then
         call exchange(set, of_case, chart%set, chart, moving, chosen, state, done)
      else
         call exchange(set, of_case, set, chart, moving, chosen, state, done)
      end if
   end subroutine exchange_drives

   subroutine exchange(set, of_case, from, chart, moving, chosen, state, done)
      type(data_set_t), intent(in) :: set, from      !! the case, and as it is drawn now
      type(mechanism_t), intent(in) :: of_case
      type(time_chart_t), intent(inout) :: chart
      type(time_motion_t), intent(inout) :: moving
      integer, intent(in) :: chosen(:)
      type(free_state_t), intent(in) :: state
      logical, intent(out) :: done
      type(data_set_t), allocatable :: drawn         ! large, as the others are: they would fill a small stack
      type(time_chart_t), allocatable :: next
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(free_motion_t), allocatable :: motion
      type(joint_stop_t), allocatable :: stops(:), rubbing(:), drives(:)
      type(joint_stop_t) :: one
      type(force_model_t) :: model
      type(sketch_t) :: sketch
      type(diagnostics_t) :: findings
      type(line_t) :: none(0)
      real(wp), allocatable :: own(:, :), start(:), speeds(:), rates(:, :), travelled(:), speed(:), accel(:), now(:)
      logical, allocatable :: free(:)
      integer, allocatable :: body(:)
      integer :: k, d, n, m

      done = .false.
      associate (old => moving%motion)
         allocate (drawn, next, prepared, problem, motion)
         call draw_here(from, old%problem, sketch, travelled, done)
         if (.not. done) return
         done = .false.
         call put_drives()
         allocate (now(size(chosen)))
         do k = 1, size(chosen)
            call joint_of(from, old%problem, sketch%drives(old%free(k)), one)
            now(k) = rate_at(old%problem, old%rates, old%forces, one, 1)
         end do
         call from%redraw(from%title, sketch, from%method, from%search, drawn)
         call strip(drawn)
         allocate (data_set_t :: next%set)
         call resolve_drawn(drawn, next%set, findings, 'kalm')
         if (findings%failed()) return
         call prepare(next%set, none, prepared, findings)
         if (findings%failed() .or. .not. prepared%ready) return
         call make_problem(next%set, prepared%mechanism, prepared%given, prepared%parameters, problem)
         n = size(old%slides)
         allocate (start(n), speed(n), accel(n), source=0.0_wp)
         if (problem%mechanism%from_drawing) start(1) = -problem%mechanism%reference
         allocate (own(1, n - 1), source=0.0_wp)
         if (allocated(problem%linkages)) deallocate (problem%linkages)
         call problem%set_inputs(start(:1), own)
         allocate (next%shown, source=problem)
         call problem%want_derivatives(.true., vertices_of(problem%mechanism))
         call problem%bind(prepared%given)
         next%sketch = next%set%traced%moving
         call next%shown%want_derivatives(.true., next%sketch%points)
         call next%shown%bind(prepared%given)
         allocate (next%rates)
         call prepare_rates(next%shown, next%rates)
         if (.not. problem%mechanism%sliding_input) start(1) = start(1)/degrees_per_radian
         speed = old%speed
         accel = old%accel
         free = [(any(old%free == d), d=1, n)]
         where (.not. free) start = start - moving%time*(speed + 0.5_wp*accel*moving%time)
         call make_force_model(next%set, problem%mechanism, prepared%given, model, findings)
         if (findings%failed()) return
         call make_stops(next%set, problem, stops)
         n = size(stops)
         allocate (drives(size(set%sketch%drives)))
         do d = 1, size(drives)
            call joint_of(next%set, problem, set%sketch%drives(d), drives(d))
            if (drives(d)%joint == 0) return
         end do
         body = [(body_of_link(problem%mechanism, link_of_body(old%problem%mechanism, k)), &
                  k=1, size(old%problem%mechanism%bodies))]
         if (any(body(2:) == body_frame)) return
         call match_friction(old, body, model, done)
         if (.not. done) return
         done = .false.
         call rubbing_joints(model, problem, rubbing)
         do k = 1, size(rubbing)
            if (.not. rubbing(k)%slides) cycle
            ! counted in the sense in which it was
            m = problem%mechanism%arcs(problem%mechanism%joints(rubbing(k)%joint)%slide)%rail
            rubbing(k)%growth = old%stops(n + k)%growth*from%traced%travels(m)%sense*next%set%traced%travels(m)%sense
            rubbing(k)%slip = rubbing(k)%slip*rubbing(k)%growth
         end do
         m = n + size(rubbing)
         stops = [stops, rubbing, drives]
         call make_free_motion(problem, model, old%motor, free, start, speed, accel, stops, motion, moving%time, &
                               old%rest_coefficient, n)
         call carry_over(old, motion, body)
         call put_model(motion)
         motion%level = old%level - sum(motion%model%inertia(parameter_mass, :))*motion%model%metre* &
                        (motion%model%gravity(1)*(problem%output%origin_x - old%problem%output%origin_x) + &
                         motion%model%gravity(2)*(problem%output%origin_y - old%problem%output%origin_y))
         ! where the case's drives and the stops are
         motion%watched = m + 1
         allocate (motion%sense(size(drives)), source=1.0_wp)
         if (old%watched > 0) then
            motion%sense = old%sense
            motion%reference = old%reference
            motion%turning = old%turning
         else
            motion%turning = .not. old%slides(1)
            motion%reference = old%first_input(0.0_wp, old%start(old%free))
            call find_senses(set, old, motion%sense)
         end if
         do k = 1, m
            motion%stops(k)%zero = motion%stops(k)%zero - old%place(k)
            motion%anchored(k) = old%place(k)
            motion%resting(k) = old%resting(k)
            motion%stuck(k) = old%stuck(k)
            motion%stuck_at(k) = old%stuck_at(k)
            motion%sense_of_slip(k) = old%sense_of_slip(k)
         end do
         motion%engaged = old%engaged
         motion%switched_on = old%switched_on
         do d = 1, size(drives)
            k = m + d
            motion%anchored(k) = motion%sense(d)*named(state, d, 0)
            motion%stops(k)%zero = motion%stops(k)%zero - motion%anchored(k)
         end do
         if (allocated(old%turned)) motion%turned = old%turned
         ! speeds of the new drives, in their own sense
         allocate (rates(size(chosen), size(chosen)))
         do k = 1, size(chosen)
            call joint_of(next%set, problem, sketch%drives(old%free(k)), drives(k))
            if (drives(k)%joint == 0) return
         end do
         call motion%rates_of(drives(:size(chosen)), rates)
         speeds = [(sign(1.0_wp, rates(k, k))*now(k), k=1, size(chosen))]
         call match_joints(set, of_case, next, problem%mechanism, done)
         if (.not. done) return
         next%travelled = travelled
         if (allocated(chart%travelled)) next%travelled = next%travelled + chart%travelled
      end associate
      call take()

   contains

      !> The chosen drives in the places of the free ones; those that stay keep theirs.
      subroutine put_drives()
         logical :: kept(size(chosen)), placed(size(chosen))
         integer :: i, slot

         kept = [(any(chosen == i), i=1, size(chosen))]
         placed = chosen <= size(chosen)
         associate (free_ones => moving%motion%free)
            do i = 1, size(chosen)
               if (kept(i)) cycle
               slot = findloc(placed, .false., dim=1)
               placed(slot) = .true.
               associate (to => sketch%drives(free_ones(i)), by => chart%drives(chosen(slot)))
                  to%name = by%name
                  to%kind = by%kind
                  to%joint = by%joint
                  to%slide = by%slide
                  to%base = by%base
                  to%link = by%link
               end associate
            end do
         end associate
      end subroutine put_drives

      !> Loads, springs, masses in the parts that the motion has of its model.
      subroutine put_model(motion)
         type(free_motion_t), intent(inout) :: motion

         associate (model => motion%model)
            call motion%note_kinks()
            motion%lasting%inertia = model%inertia
            motion%lasting%springs = model%springs
            motion%lasting%springs%part = part_elastic
            motion%loads%inertia = model%inertia
            motion%loads%loads = model%loads
            motion%loads%table_input = model%table_input
            motion%loads%table_factor = model%table_factor
            motion%dampers%inertia = model%inertia
            motion%dampers%springs = pack(model%springs, model%springs%damps())
            motion%dampers%springs%part = part_viscous
         end associate
      end subroutine put_model

      !> The new choice takes the place of the old one, if its motion is the same.
      subroutine take()
         type(free_motion_t), allocatable :: before
         real(wp), allocatable :: y(:)

         call move_alloc(moving%motion, before)
         call move_alloc(motion, moving%motion)
         y = moving%y
         call moving%go_on_with(speeds, done)
         if (done) done = agrees()
         if (done) then
            call move_alloc(next%set, chart%set)
            call move_alloc(next%shown, chart%shown)
            call move_alloc(next%rates, chart%rates)
            chart%sketch = next%sketch
            chart%travelled = next%travelled
            chart%same_joint = next%same_joint
            chart%rest_of = next%rest_of
            if (allocated(chart%passing)) deallocate (chart%passing)
            chart%passages = 0
            return
         end if
         call move_alloc(before, moving%motion)
         call moving%go_back_to(y)
      end subroutine take

      !> True if the case's drives have the rates and accelerations that they had.
      logical function agrees()
         real(wp) :: rate(size(set%sketch%drives)), accel(size(rate)), was(size(rate), 2)
         integer :: i

         associate (motion => moving%motion)
            do i = 1, size(rate)
               rate(i) = motion%sense(i)*motion%pace(motion%watched + i - 1)
               accel(i) = motion%sense(i)*motion%growth(motion%watched + i - 1)
               was(i, :) = [named(state, i, 1), named(state, i, 2)]
            end do
         end associate
         agrees = all(abs(rate - was(:, 1)) <= same*maxval(abs(was(:, 1)))) .and. &
                  all(abs(accel - was(:, 2)) <= sqrt(same)*maxval(abs(was(:, 2))))
      end function agrees
   end subroutine exchange

   !> A drive of the case: from time 0, or by time.
   pure real(wp) function named(state, drive, order)
      type(free_state_t), intent(in) :: state
      integer, intent(in) :: drive, order

      if (allocated(state%named)) then
         named = state%named(drive, order)
      else if (order == 0) then
         named = state%input(drive) - state%begun(drive)
      else
         named = merge(state%rate(drive), state%accel(drive), order == 1)
      end if
   end function named

   !> Rates of the drives of the case by those of their joints: 1 or -1.
   subroutine find_senses(set, motion, sense)
      type(data_set_t), intent(in) :: set
      type(free_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: sense(:)
      type(joint_stop_t) :: one
      integer :: d

      do d = 1, size(sense)
         call joint_of(set, motion%problem, set%sketch%drives(d), one)
         if (one%joint == 0) cycle
         sense(d) = sign(1.0_wp, motion%rate_for(d, one))
      end do
   end subroutine find_senses

   !> What has been read already, and what asks for studies that are none of a motion, is left out of a case drawn anew.
   subroutine strip(drawn)
      type(data_set_t), intent(inout) :: drawn
      integer :: k

      drawn%masses%places = drawn%masses%places(:0)
      drawn%masses%added = 0
      drawn%loads%places = drawn%loads%places(:0)
      drawn%springs%first = drawn%springs%first(:0)
      drawn%springs%second = drawn%springs%second(:0)
      drawn%springs%added = 0
      do k = 1, size(drawn%sections)
         if (any(drawn%sections(k)%name == [character(5) :: 'STOPS', 'TIME'])) cycle
         drawn%sections(k)%group%given = .false.
      end do
   end subroutine strip

   !> The sketch drawn where the links are at the position solved last. `drawn` is false where a slide is on no arc.
   subroutine draw_here(set, problem, sketch, travelled, drawn)
      type(data_set_t), intent(in) :: set
      class(problem_t), intent(in) :: problem
      type(sketch_t), intent(out) :: sketch
      real(wp), allocatable, intent(out) :: travelled(:) !! by slide: from its drawing
      logical, intent(out) :: drawn
      type(sketch_motion_t) :: motion
      complex(wp), allocatable :: place(:)
      complex(wp) :: root
      real(wp) :: x, y, length
      integer :: k, n, vertex, joints

      sketch = set%sketch
      joints = size(sketch%x)
      call locate_sketch(set, motion, with_slides=.true.)
      drawn = all(motion%arcs > 0)
      if (.not. drawn) return
      place = motion%drawn
      associate (link => problem%linkage, plan => problem%plan, mechanism => problem%mechanism)
         do k = 1, size(motion%moving)
            associate (one => motion%moving(k), at => motion%points(:, k))
               n = mechanism%seq(at(1), max(1, at(2)))
               vertex = plan%joint_points(mechanism%arcs(n)%ends(merge(at_start, at_finish, at(2) == 0)))
               root = cmplx(link%store%v(1, link%root_x(plan%root(one%arc))), link%store%v(1, link%root_y(plan%root(one%arc))), wp)
               place(one%joint) = cmplx(link%store%v(1, link%point_x(vertex))/link%scale + problem%output%origin_x, &
                                        link%store%v(1, link%point_y(vertex))/link%scale + problem%output%origin_y, wp) &
                                  + one%offset*cmplx(link%x(one%arc), link%y(one%arc), wp)*root
            end associate
         end do
         sketch%x = place(:joints)%re
         sketch%y = place(:joints)%im
         allocate (travelled(size(sketch%slides)), source=0.0_wp)
         do k = 1, size(sketch%slides)
            associate (slide => sketch%slides(k), arc => motion%arcs(k))
               slide%x = place(joints + k)%re
               slide%y = place(joints + k)%im
               call link%arc_at(plan, arc, 1, x, y, length)
               slide%angle = slide%angle + nearest_difference(degrees_of(x, y), set%traced%arcs(arc)%direction)
               travelled(k) = motion%sense(k)*link%store%v(1, link%slide(plan%length_slot(arc)))/link%scale + motion%zero(k)
            end associate
         end do
      end associate
      ! lengths are in the coordinates now
      deallocate (sketch%length_of, sketch%length, sketch%variations)
      allocate (sketch%length_of(2, 0), sketch%length(0), sketch%variations(0))
   end subroutine draw_here

   !> Let joints with friction be between the links that they were between, first and second. `found` is false where a pin of
   !> several links is held by another one now: its load is that of another pair.
   pure subroutine match_friction(old, body, model, found)
      type(free_motion_t), intent(in) :: old
      integer, intent(in) :: body(:)                 !! by body of the old one: that of the new one
      type(force_model_t), intent(inout) :: model
      logical, intent(out) :: found
      integer :: k

      found = size(model%friction) == size(old%model%friction)
      if (.not. found) return
      do k = 1, size(model%friction)
         associate (of => model%friction(k), bodies => body(old%model%friction(k)%bodies))
            found = all(of%bodies == bodies) .or. (all(of%bodies == [bodies(2), bodies(1)]) .and. .not. of%all_of_pin)
            if (.not. found) return
            of%bodies = bodies
         end associate
      end do
   end subroutine match_friction

   !> Masses, loads and springs of one motion in another of the same links, at the same position.
   subroutine carry_over(old, new, body)
      type(free_motion_t), intent(in) :: old
      type(free_motion_t), intent(inout) :: new
      integer, intent(in) :: body(:)                 !! by body of the old one: that of the new one
      complex(wp) :: moment, turn, shift
      integer :: b, e

      associate (from => old%model, to => new%model)
         to%inertia = 0.0_wp
         do b = body_frame + 1, size(body)
            associate (m => from%inertia(:, b), own => to%inertia(:, body(b)))
               shift = (reference_of(old, b) - reference_of(new, body(b)))*from%metre
               moment = cmplx(m(parameter_mx), m(parameter_my), wp)*axes_of(old, b)
               own(parameter_mass) = m(parameter_mass)
               own(parameter_inertia) = m(parameter_inertia) + 2.0_wp*real(moment*conjg(shift), wp) + &
                                        m(parameter_mass)*real(shift*conjg(shift), wp)
               moment = (moment + m(parameter_mass)*shift)*conjg(axes_of(new, body(b)))
               own(parameter_mx) = moment%re
               own(parameter_my) = moment%im
            end associate
         end do
         to%loads = from%loads
         do b = 1, size(to%loads)
            associate (load => to%loads(b))
               turn = turn_of(load%location%body)
               if (load%turns) then
                  moment = cmplx(load%force(1), load%force(2), wp)*turn
                  load%force = [moment%re, moment%im]
               end if
               call carry(load%location)
            end associate
         end do
         to%springs = from%springs
         do b = 1, size(to%springs)
            do e = 1, size(to%springs(b)%ends)
               call carry(to%springs(b)%ends(e))
            end do
         end do
         to%table_input = from%table_input
         to%table_factor = from%table_factor
         ! the first drive may slide here: a table over a turn goes on there as it begins
         if (size(from%table_input) > 0 .and. old%watched == 0 .and. .not. (old%slides(1) .or. from%timed)) then
            to%table_input = [from%table_input, from%table_input(1) + full_turn]
            to%table_factor = reshape([transpose(from%table_factor), from%table_factor(1, :)], &
                                      [size(from%table_input) + 1, size(from%table_factor, 2)], order=[2, 1])
         end if
      end associate

   contains

      !> From the axes of an old body to those of the new one.
      complex(wp) function turn_of(b)
         integer, intent(in) :: b

         turn_of = axes_of(old, b)*conjg(axes_of(new, body(b)))
      end function turn_of

      subroutine carry(location)
         type(location_t), intent(inout) :: location
         complex(wp) :: z

         associate (b => location%body)
            z = (reference_of(old, b) + cmplx(location%at(1), location%at(2), wp)*axes_of(old, b) - &
                 reference_of(new, body(b)))*conjg(axes_of(new, body(b)))
            location%at = [z%re, z%im]
            z = cmplx(location%along(1), location%along(2), wp)*turn_of(b)
            location%along = [z%re, z%im]
            b = body(b)
         end associate
      end subroutine carry
   end subroutine carry_over

   !> Where the reference of a body is: user's length, machine axes.
   complex(wp) function reference_of(motion, body)
      type(free_motion_t), intent(in) :: motion
      integer, intent(in) :: body

      associate (of => motion%forces%bodies(body), v => motion%problem%linkage%store%v, out => motion%problem%output)
         reference_of = cmplx(v(1, of%px), v(1, of%py), wp)/motion%forces%unit + cmplx(out%origin_x, out%origin_y, wp)
      end associate
   end function reference_of

   !> The direction of its axes.
   complex(wp) function axes_of(motion, body)
      type(free_motion_t), intent(in) :: motion
      integer, intent(in) :: body

      associate (of => motion%forces%bodies(body), w => motion%forces%w%v)
         axes_of = cmplx(w(1, of%ex), w(1, of%ey), wp)
      end associate
   end function axes_of

   !> Solve and differentiate what is shown where the motion is; beside a change point it is the smooth motion through it.
   subroutine solve_shown(self, motion, state)
      class(time_chart_t), intent(inout) :: self
      type(free_motion_t), intent(in) :: motion
      type(free_state_t), intent(in) :: state
      real(wp) :: inputs(size(motion%slides))
      logical :: passes
      integer :: d, offset, n

      passes = .false.
      if (allocated(motion%passing)) then
         if (self%passages /= motion%passages) then
            self%passing = motion%passing
            self%passages = motion%passages
            call self%passing%tabulate(self%shown, self%rates, passes)
            if (.not. passes) self%passing%half = 0.0_wp
         end if
         call self%passing%put_signs(self%shown, motion%at)
         passes = self%passing%holds(motion%at)
      end if
      inputs = state%input
      where (.not. motion%slides) inputs = inputs*degrees_per_radian
      associate (shown => self%shown)
         if (size(inputs) > 1) shown%own_delt(1, :) = inputs(2:)
         call shown%move_inputs(inputs(:1))
         if (passes) then
            call self%passing%put_place(shown, motion%at)
            call self%passing%put_rates(self%rates, motion%at, state%rate(motion%free(1)), state%accel(motion%free(1)), &
                                        highest_order)
            return
         end if
         call self%follow(motion)
         call shown%solve_block(1, offset, n)
         do d = 1, size(inputs)
            shown%linkage%drive_rate(:, d) = [state%rate(d), state%accel(d), 0.0_wp]
         end do
         call differentiate(shown, self%rates, n, highest_order)
      end associate
   end subroutine solve_shown

   !> Larger groups of what is shown are followed from where the motion has them.
   pure subroutine follow(self, motion)
      class(time_chart_t), intent(inout) :: self
      type(free_motion_t), intent(in) :: motion
      integer :: k, j

      associate (from => motion%problem%linkage, to => self%shown%linkage)
         do k = 1, size(to%steps)
            if (.not. allocated(to%steps(k)%dyad%higher)) cycle
            associate (moved => from%steps(k)%dyad%higher, shown => to%steps(k)%dyad%higher)
               shown%from = moved%from
               do j = 1, size(shown%known)
                  shown%known(j)%from = moved%known(j)%from
               end do
            end associate
         end do
         to%from = from%from
      end associate
   end subroutine follow

   !> Which joint of a new choice of drives has the force that the case lists for a joint. A pin of the case lists what a link takes
   !> from it that another link holds; where that link holds it here it is what the others leave.
   subroutine match_joints(set, of_case, next, mechanism, found)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: of_case
      type(time_chart_t), intent(inout) :: next
      type(mechanism_t), intent(in) :: mechanism
      logical, intent(out) :: found

      integer :: k, j

      found = .false.
      allocate (next%same_joint(size(of_case%joints)), source=0)
      allocate (next%rest_of(size(of_case%joints)), source=.false.)
      do k = 1, size(of_case%joints)
         do j = 1, size(mechanism%joints)
            if (of_case%joints(k)%kind /= mechanism%joints(j)%kind) cycle
            if (of_case%joints(k)%kind == joint_prismatic) then
               if (mechanism%arcs(mechanism%joints(j)%slide)%rail == of_case%arcs(of_case%joints(k)%slide)%rail) &
                  next%same_joint(k) = j
            else if (of_case%joints(k)%kind == joint_revolute) then
               if (pin_of(mechanism, j) /= pin_of(of_case, k)) cycle
               if (taker(next%set, mechanism, j) == taker(set, of_case, k)) next%same_joint(k) = j
               next%rest_of(k) = .true.
            end if
         end do
         if (next%same_joint(k) > 0) next%rest_of(k) = .false.
         if (next%same_joint(k) == 0 .and. .not. next%rest_of(k)) return
      end do
      found = .true.
   end subroutine match_joints

   !> The link that takes the listed force of a revolute joint.
   integer function taker(set, mechanism, joint)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: joint
      integer, allocatable :: links(:)
      integer :: pin

      taker = link_of_body(mechanism, mechanism%joints(joint)%bodies(2))
      pin = pin_of(mechanism, joint)
      if (pin == 0) return
      links = set%sketch%links_of(pin)
      if (size(links) == 2) taker = links(merge(2, 1, links(1) == set%traced%pin_holders(pin)))
   end function taker

   !> The columns of forces of a moment as the case has them. A free drive has its motor alone.
   function columns_of_case(self, of_case, free, state) result(columns)
      class(time_chart_t), intent(in) :: self
      type(mechanism_t), intent(in) :: of_case
      logical, intent(in) :: free(:)                 !! by drive
      type(free_state_t), intent(in) :: state
      real(wp), allocatable :: columns(:)
      integer :: k, j, d, to, from

      columns = state%columns
      if (.not. allocated(self%same_joint)) return
      deallocate (columns)
      allocate (columns(column_of_joint(size(of_case%joints) + 1) + size(free) - 2), source=0.0_wp)
      associate (here => self%shown%mechanism)
         columns(:column_moment) = state%columns(:column_moment)
         do k = 1, size(of_case%joints)
            to = column_of_joint(k)
            if (self%same_joint(k) > 0) then
               from = column_of_joint(self%same_joint(k))
               columns(to:to + 1) = state%columns(from:from + 1)
               cycle
            end if
            do j = 1, size(here%joints)
               if (here%joints(j)%kind /= joint_revolute) cycle
               if (pin_of(here, j) /= pin_of(of_case, k)) cycle
               from = column_of_joint(j)
               columns(to:to + 1) = columns(to:to + 1) - state%columns(from:from + 1)
            end do
         end do
         do d = 1, size(free)
            to = column_drive
            from = column_drive
            if (d > 1) to = column_of_other_drive(size(of_case%joints), d)
            if (d > 1) from = column_of_other_drive(size(here%joints), d)
            columns(to) = merge(0.0_wp, state%columns(from), free(d))
         end do
         d = state%motor_drive
         to = column_drive
         if (d > 1) to = column_of_other_drive(size(of_case%joints), d)
         if (free(d)) columns(to) = state%motor
      end associate
   end function columns_of_case
end module psalm_time_chart
