!> What a linkage does to one of its links in a turn of the crank: the motion of its start, its turning, the
!> pull at its finish - of its own inertia, of the inertia of all other links, and of weight, loads and springs - and what acts
!> on the link between its pins: its weight, loads, ends of springs.
module psalm_link_cycle
   use psalm_body_points, only: locate_point
   use psalm_crank_motion, only: crank_motion_t, move_in_turn
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t
   use psalm_force_model, only: force_model_t, load_t, vertices_of, parameter_mass, parameter_mx, parameter_my, &
                                parameter_inertia
   use psalm_kinds, only: wp
   use psalm_kinetostatics, only: forces_t, prepare_forces, move_bodies, clear_wrenches, add_source, sweep, joint_rows, &
                                  first_spring, source_inertia, sources_of
   use psalm_link_loads, only: acting_cycle_t, find_foot, list_acting, direction_of_arc, follow_acting
   use psalm_link_vibration, only: moving_link_t
   use psalm_locations, only: location_t
   use psalm_mechanism, only: mechanism_t, at_start, at_finish, body_frame, joint_gear, joint_prismatic
   use psalm_periodic, only: periodic_from_samples
   use psalm_rates, only: rates_t, prepare_rates, differentiate, is_dead
   use psalm_spring_law, only: part_elastic, part_viscous
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   use psalm_beam, only: beam_t
   implicit none (type, external)
   private
   public :: link_cycle_t, find_link_cycle, check_link, moving_link, inertia_at_crank, add_uniform_link, prepare_turn, note_dead, &
             is_turned_by_drive

   real(wp), parameter :: beyond_pin = 1.0e-9_wp !! of the length: a place so far beyond a pin is at the pin

   !> All arrays have the shape (positions): at equal steps of time from the reference position of the crank, at a mean speed of
   !> 1 rad/s.
   type :: link_cycle_t
      type(crank_motion_t) :: crank              !! at these steps
      real(wp) :: length = 0.0_wp                !! m
      real(wp) :: mass = 0.0_wp                  !! of the uniform link, kg
      real(wp), allocatable :: direction(:, :)   !! shape (2, positions): of the link, unit vector in machine axes
      real(wp), allocatable :: along(:), across(:) !! acceleration of the start, m
      real(wp), allocatable :: turning(:)        !! angular acceleration
      real(wp), allocatable :: speed(:)          !! angular speed
      real(wp), allocatable :: own(:)            !! pull at the finish along the link, of its own inertia, N
      real(wp), allocatable :: others(:)         !! of the inertia of all other links
      real(wp), allocatable :: fixed(:)          !! of weight, loads and springs: it does not depend on the speed
      real(wp), allocatable :: viscous(:)        !! of dampers on other links, at 1 rad/s
      real(wp), allocatable :: weight_along(:), weight_across(:) !! gravity in the axes of the link, m/s2
      type(acting_cycle_t), allocatable :: acting(:) !! on the link between its pins
      integer :: failure = 0                     !! position at which it does not close or passes a dead point; 0: none
      integer :: loop = 0                        !! and the loop
      logical :: closes = .true.                 !! it is a dead point
   end type link_cycle_t

contains

   !> What is wrong with a link that is to vibrate. Errors: it is the frame, or its arc is not between two pins of it; a further
   !> joint on it; masses on it besides its own; loads or springs on it beyond its pins; a damper on it; a spring between two
   !> of its points; a sliding input; friction.
   subroutine check_link(set, mechanism, dimensions, model, beam, group, item, entry, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(beam_t), intent(in) :: beam
      character(*), intent(in) :: group, item
      integer, intent(in) :: entry
      type(diagnostics_t), intent(inout) :: findings
      integer :: j, k, n, body, pins(2)

      if (mechanism%sliding_input) then
         call refuse('vibration needs a crank that turns; the input of this linkage slides')
         return
      end if
      if (beam%link%loop == 0) then
         call refuse('no loop runs along this line of the link; name two other joints of it')
         return
      end if
      n = mechanism%seq(beam%link%loop, beam%link%arc)
      body = mechanism%arcs(n)%body
      if (body == body_frame) then
         call refuse('is on the frame, which does not move')
         return
      end if
      if (mechanism%slides(n) .or. .not. mechanism%arcs(n)%attached) then
         call refuse('is no arc between two points of a link')
         return
      end if
      if (is_turned_by_drive(mechanism, body)) then
         call refuse('a drive turns the link against another: only links between two pins are treated')
         return
      end if
      pins = 0
      do j = 1, size(mechanism%joints)
         associate (joint => mechanism%joints(j))
            if (.not. any(joint%bodies == body)) cycle
            if (joint%kind == joint_gear) then
               call refuse('the link is a wheel: only links between two pins are treated')
               return
            else if (joint%kind == joint_prismatic) then
               call refuse('the link slides at joint '//joint%name//': only links between two pins are treated')
               return
            end if
            if (joint%point == mechanism%arcs(n)%ends(at_start)) then
               pins(at_start) = pins(at_start) + 1
            else if (joint%point == mechanism%arcs(n)%ends(at_finish)) then
               pins(at_finish) = pins(at_finish) + 1
            else
               call refuse('the link has joint '//joint%name//' besides the ends of this arc')
               return
            end if
         end associate
      end do
      if (any(pins == 0)) call refuse('there is no pin at an end of this arc')
      if (any(abs(model%inertia(:, body)) > 0.0_wp)) then
         call refuse('&MASSES or &PLATES has a mass on this link; its own mass follows from density and area, and another is '// &
                     'not treated')
      end if
      if (size(model%friction) > 0) then
         call refuse('the equations of a vibrating link are linear, but friction changes its sign with the motion of the '// &
                     'joint; leave &FRICTN out')
      end if
      if (any(pins == 0)) return
      do k = 1, size(model%loads)
         if (model%loads(k)%location%body == body) call check_place('load '//to_text(k)//' of &LOADS', model%loads(k)%location)
      end do
      do k = 1, size(model%springs)
         associate (spring => model%springs(k))
            if (all(spring%ends%body /= body)) cycle
            if (all(spring%ends%body == body)) then
               call refuse('spring '//to_text(k)//' of &SPRING joins two points of this link: it would be a part of it, and '// &
                           'only a uniform link is treated')
               cycle
            end if
            if (spring%damps()) then
               call refuse('&SPRING has damper '//to_text(k)//' on this link: it would damp each mode differently and couple '// &
                           'them; give the damping of the modes by '//group(1:1)//'ZETA, or put the damper on another link')
            end if
            if (spring%torsional .and. spring%side /= 0) then
               call refuse('torsional spring '//to_text(k)//' of &SPRING acts on one side only (SSIDE) and on this link: the '// &
                           'equations of a vibrating link are linear')
            end if
            do j = 1, size(spring%ends)
               if (spring%ends(j)%body == body) call check_place('spring '//to_text(k)//' of &SPRING', spring%ends(j))
            end do
         end associate
      end do

   contains

      !> Between the pins, or above a point between them.
      subroutine check_place(what, location)
         character(*), intent(in) :: what
         type(location_t), intent(in) :: location
         real(wp) :: place, height, length

         call find_foot(mechanism, dimensions, model, n, location, place, height, length)
         if (place >= -beyond_pin*length .and. place <= (1.0_wp + beyond_pin)*length) return
         call refuse(what//' acts on this link beyond its pins: the link is treated as a beam that ends at its pins')
      end subroutine check_place

      subroutine refuse(text)
         character(*), intent(in) :: text

         call set%origins%error(findings, group, item, 'entry '//to_text(entry)//': '//text, entry)
      end subroutine refuse
   end subroutine check_link

   !> True if a drive turns a body against another one that moves.
   pure logical function is_turned_by_drive(mechanism, body)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: body
      integer :: loop, t

      is_turned_by_drive = .false.
      do loop = 1, mechanism%nloop
         if (.not. allocated(mechanism%groups(loop)%ties)) cycle
         do t = 1, size(mechanism%groups(loop)%ties)
            associate (tie => mechanism%groups(loop)%ties(t))
               if (tie%drive == 0) cycle
               is_turned_by_drive = is_turned_by_drive .or. &
                                    any(mechanism%arcs(pack(tie%axes, tie%axes > 0))%body == body)
            end associate
         end do
      end do
   end function is_turned_by_drive

   !> Put the mass of a uniform link on its body, unless it is the body of `beyond`. The link was checked by `check_link`.
   pure subroutine add_uniform_link(mechanism, dimensions, beam, beyond, model)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(beam_t), intent(in) :: beam
      integer, intent(in) :: beyond             !! 0: none
      type(force_model_t), intent(inout) :: model
      real(wp) :: start(2), finish(2), centre(2), mass, length
      integer :: n

      n = mechanism%seq(beam%link%loop, beam%link%arc)
      associate (body => mechanism%arcs(n)%body)
         if (body == beyond) return
         call locate_point(mechanism, dimensions, body, model%reference(body), mechanism%arcs(n)%ends(at_start), start)
         call locate_point(mechanism, dimensions, body, model%reference(body), mechanism%arcs(n)%ends(at_finish), finish)
         length = model%metre*norm2(finish - start)
         centre = 0.5_wp*model%metre*(start + finish)
         mass = beam%density*beam%area*length
         model%inertia(parameter_mass, body) = mass
         model%inertia(parameter_mx, body) = mass*centre(1)
         model%inertia(parameter_my, body) = mass*centre(2)
         model%inertia(parameter_inertia, body) = mass*(length**2/12.0_wp + dot_product(centre, centre))
      end associate
   end subroutine add_uniform_link

   !> Follow the link. It was checked by `check_link`.
   subroutine find_link_cycle(given, dimensions, model, beam, points, crank, cycle_of)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(beam_t), intent(in) :: beam
      integer, intent(in) :: points             !! positions in a turn
      type(crank_motion_t), intent(in) :: crank
      type(link_cycle_t), intent(out) :: cycle_of
      class(problem_t), allocatable :: problem   ! large: it would fill a small stack
      type(force_model_t) :: own, bare, steady, dampers
      type(rates_t) :: rates
      type(forces_t) :: forces
      real(wp) :: input(points)
      integer :: block, offset, n, arc, body, start, finish, source, i

      cycle_of%crank = crank%at_steps(points)
      call prepare_turn(given, dimensions, problem, input, cycle_of)
      if (cycle_of%failure > 0) return
      arc = problem%mechanism%seq(beam%link%loop, beam%link%arc)
      body = problem%mechanism%arcs(arc)%body
      start = problem%mechanism%arcs(arc)%ends(at_start)
      finish = problem%mechanism%arcs(arc)%ends(at_finish)
      allocate (cycle_of%along(points), cycle_of%across(points), cycle_of%turning(points), cycle_of%speed(points), &
                cycle_of%own(points), cycle_of%others(points), cycle_of%fixed(points), cycle_of%weight_along(points), &
                cycle_of%weight_across(points), cycle_of%direction(2, points))
      allocate (cycle_of%viscous(points), source=0.0_wp)
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      bare = model
      bare%gravity = 0.0_wp
      own = bare
      own%inertia = 0.0_wp
      steady = model
      steady%springs%part = part_elastic
      dampers = bare
      dampers%loads = [load_t ::]
      dampers%springs%part = part_viscous
      call list_acting(problem%mechanism, dimensions, steady, arc, points, cycle_of%acting)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         call note_dead(problem, rates, offset, n, cycle_of)
         if (cycle_of%failure > 0) return
         call move_in_turn(cycle_of%crank, problem, rates, offset, n, 1.0_wp, forces)
         call follow_motion()
         if (block == 1) call make_own()
         call follow_acting(problem, steady, direction_of_arc(problem, arc, n), input(offset + 1:offset + n), offset, n, forces, &
                            cycle_of%acting)
         call clear_wrenches(n, forces)
         call add_source(problem, own, source_inertia, input(offset + 1:offset + n), n, forces)
         call sweep(problem, n, forces)
         call take_pull(cycle_of%own)
         call clear_wrenches(n, forces)
         call add_source(problem, bare, source_inertia, input(offset + 1:offset + n), n, forces)
         call sweep(problem, n, forces)
         call take_pull(cycle_of%others)
         call clear_wrenches(n, forces)
         do source = source_inertia + 1, sources_of(steady)
            call add_source(problem, steady, source, input(offset + 1:offset + n), n, forces)
         end do
         call sweep(problem, n, forces)
         call take_pull(cycle_of%fixed)
         if (.not. any(dampers%springs%damps())) cycle
         call move_in_turn(cycle_of%crank, problem, rates, offset, n, cycle_of%crank%sense, forces)
         call clear_wrenches(n, forces)
         do source = first_spring(dampers), sources_of(dampers)
            call add_source(problem, dampers, source, input(offset + 1:offset + n), n, forces)
         end do
         call sweep(problem, n, forces)
         call take_pull(cycle_of%viscous)
      end do

   contains

      !> Acceleration of the start in the axes of the link, and its turning.
      subroutine follow_motion()
         real(wp) :: x, y, dx, dy, ux, uy, ax, ay, metre

         metre = model%metre/forces%unit
         associate (link => problem%linkage, w => forces%w%v, rows => forces%bodies(body), points_of => problem%plan%joint_points)
            do i = 1, n
               x = link%store%v(i, link%point_x(points_of(start)))
               y = link%store%v(i, link%point_y(points_of(start)))
               dx = link%store%v(i, link%point_x(points_of(finish))) - x
               dy = link%store%v(i, link%point_y(points_of(finish))) - y
               cycle_of%length = sqrt(dx*dx + dy*dy)
               ux = dx/cycle_of%length
               uy = dy/cycle_of%length
               x = x - link%store%v(i, rows%px)
               y = y - link%store%v(i, rows%py)
               ax = w(i, rows%ax) - w(i, rows%al)*y - w(i, rows%w)**2*x
               ay = w(i, rows%ay) + w(i, rows%al)*x - w(i, rows%w)**2*y
               cycle_of%along(offset + i) = metre*(ax*ux + ay*uy)
               cycle_of%across(offset + i) = metre*(ay*ux - ax*uy)
               cycle_of%turning(offset + i) = w(i, rows%al)
               cycle_of%speed(offset + i) = w(i, rows%w)
               cycle_of%direction(:, offset + i) = [ux, uy]
               cycle_of%weight_along(offset + i) = model%gravity(1)*ux + model%gravity(2)*uy
               cycle_of%weight_across(offset + i) = model%gravity(2)*ux - model%gravity(1)*uy
            end do
         end associate
         cycle_of%length = cycle_of%length*metre
      end subroutine follow_motion

      !> The link's own mass, about the reference of its body and in the body's axes, from the first position.
      subroutine make_own()
         real(wp) :: x, y, cx, cy, metre

         metre = model%metre/forces%unit
         cycle_of%mass = beam%density*beam%area*cycle_of%length
         associate (link => problem%linkage, w => forces%w%v, rows => forces%bodies(body), points_of => problem%plan%joint_points)
            x = 0.5_wp*(link%store%v(1, link%point_x(points_of(start))) + link%store%v(1, link%point_x(points_of(finish)))) &
                - link%store%v(1, rows%px)
            y = 0.5_wp*(link%store%v(1, link%point_y(points_of(start))) + link%store%v(1, link%point_y(points_of(finish)))) &
                - link%store%v(1, rows%py)
            cx = metre*(x*w(1, rows%ex) + y*w(1, rows%ey))
            cy = metre*(y*w(1, rows%ex) - x*w(1, rows%ey))
         end associate
         own%inertia(parameter_mass, body) = cycle_of%mass
         own%inertia(parameter_mx, body) = cycle_of%mass*cx
         own%inertia(parameter_my, body) = cycle_of%mass*cy
         own%inertia(parameter_inertia, body) = cycle_of%mass*(cycle_of%length**2/12.0_wp + cx**2 + cy**2)
         steady%inertia(:, body) = own%inertia(:, body)
      end subroutine make_own

      !> Sum of the forces of all joints on the link at its finish, along it.
      subroutine take_pull(pull)
         real(wp), intent(inout) :: pull(:)
         real(wp) :: fx(n), fy(n), dx, dy, length
         integer :: j

         fx = 0.0_wp
         fy = 0.0_wp
         do j = 1, size(problem%mechanism%joints)
            associate (joint => problem%mechanism%joints(j), rows => joint_rows(problem, forces, j, n))
               if (joint%point /= finish) cycle
               if (joint%bodies(2) == body) then
                  fx = fx + rows(:, 1)
                  fy = fy + rows(:, 2)
               else if (joint%bodies(1) == body) then
                  fx = fx - rows(:, 1)
                  fy = fy - rows(:, 2)
               end if
            end associate
         end do
         associate (link => problem%linkage, points_of => problem%plan%joint_points)
            do i = 1, n
               dx = link%store%v(i, link%point_x(points_of(finish))) - link%store%v(i, link%point_x(points_of(start)))
               dy = link%store%v(i, link%point_y(points_of(finish))) - link%store%v(i, link%point_y(points_of(start)))
               length = sqrt(dx*dx + dy*dy)
               pull(offset + i) = (fx(i)*dx + fy(i)*dy)/length
            end do
         end associate
      end subroutine take_pull
   end subroutine find_link_cycle

   !> The link's motion at a speed, with e times the inertia of the other links.
   function moving_link(cycle_of, speed, e) result(link)
      type(link_cycle_t), intent(in) :: cycle_of
      real(wp), intent(in) :: speed              !! rad/s; what does not depend on it is left out at 0
      real(wp), intent(in) :: e
      type(moving_link_t) :: link
      real(wp), dimension(size(cycle_of%own)) :: pull, along, across
      integer :: k, c

      pull = cycle_of%own + e*cycle_of%others
      along = cycle_of%along
      across = cycle_of%across
      if (speed > 0.0_wp) then
         pull = pull + cycle_of%fixed/speed**2 + cycle_of%viscous/speed
         along = along - cycle_of%weight_along/speed**2
         across = across - cycle_of%weight_across/speed**2
         allocate (link%acting(size(cycle_of%acting)))
         do k = 1, size(link%acting)
            associate (from => cycle_of%acting(k), to => link%acting(k), force => cycle_of%mass*cycle_of%length*speed**2)
               to%place = from%place/cycle_of%length
               to%height = from%height/cycle_of%length
               to%along = periodic_from_samples(from%along/force)
               to%across = periodic_from_samples(from%across/force)
               to%moment = periodic_from_samples(from%moment/(force*cycle_of%length))
               do c = 1, size(to%spring)
                  to%spring(c) = periodic_from_samples(from%held(:, c)*cycle_of%length/force)
               end do
               to%torsion = from%torsion/(force*cycle_of%length)
            end associate
         end do
      end if
      link%tension = periodic_from_samples(pull/(cycle_of%mass*cycle_of%length))
      link%along = periodic_from_samples(along/cycle_of%length)
      link%across = periodic_from_samples(across/cycle_of%length)
      link%turning = periodic_from_samples(cycle_of%turning)
      link%turning_squared = periodic_from_samples(cycle_of%speed**2)
   end function moving_link

   !> Inertia that the crank feels: twice the kinetic energy at 1 rad/s, kg m2, at its steps. Shape of `inertia`: (points).
   subroutine inertia_at_crank(given, dimensions, model, points, crank, inertia, cycle_of)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: points
      type(crank_motion_t), intent(in) :: crank
      real(wp), allocatable, intent(out) :: inertia(:)
      type(link_cycle_t), intent(out) :: cycle_of !! where it does not turn
      class(problem_t), allocatable :: problem
      type(rates_t) :: rates
      type(forces_t) :: forces
      real(wp) :: input(points)
      integer :: block, offset, n

      allocate (inertia(points), source=0.0_wp)
      cycle_of%crank = crank%at_steps(points)
      call prepare_turn(given, dimensions, problem, input, cycle_of)
      if (cycle_of%failure > 0) return
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         call note_dead(problem, rates, offset, n, cycle_of)
         if (cycle_of%failure > 0) return
         call move_bodies(problem, rates, n, 1.0_wp, 0.0_wp, forces)
         call clear_wrenches(n, forces)
         call add_source(problem, model, source_inertia, input(offset + 1:offset + n), n, forces)
         inertia(offset + 1:offset + n) = 2.0_wp*forces%w%v(1:n, forces%kinetic)
      end do
   end subroutine inertia_at_crank

   !> A problem that solves everything at the steps of the crank; `failure` of the cycle is set where it does not close.
   subroutine prepare_turn(given, dimensions, problem, input, cycle_of)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      class(problem_t), allocatable, intent(out) :: problem
      real(wp), intent(out) :: input(:)          !! shape (points): degrees
      type(link_cycle_t), intent(inout) :: cycle_of !! with its crank
      type(motion_t) :: motion

      allocate (problem, source=given)
      call problem%set_inputs(cycle_of%crank%input)
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(dimensions, motion)
      input = motion%input
      cycle_of%failure = findloc(motion%closed, .false., dim=1)
      if (cycle_of%failure > 0) cycle_of%closes = .false.
   end subroutine prepare_turn

   !> The first dead point of the block just solved, which `failure` and `loop` of the cycle say.
   subroutine note_dead(problem, rates, offset, n, cycle_of)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: offset, n
      type(link_cycle_t), intent(inout) :: cycle_of
      integer :: i, loop

      do i = 1, n
         do loop = 1, problem%mechanism%nloop
            if (.not. is_dead(problem, rates, loop, i)) cycle
            cycle_of%failure = offset + i
            cycle_of%loop = loop
            return
         end do
      end do
   end subroutine note_dead
end module psalm_link_cycle
