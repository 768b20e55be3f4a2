!> What acts on each link, point by point, and how the link moves, in axes fixed in it: the loads of a stress analysis.
!>
!> A force acts at a joint, at the place of a load or of a spring's end, or at the centre of mass (weight). What one point cannot
!> carry has a moment beside it: the couple of a slide, the torque of a drive, friction of a pin. The sum of all forces on a link is
!> its mass times the acceleration of its centre of mass, the sum of their moments about that centre its moment of inertia times the
!> angular acceleration; so they are in equilibrium with the inertia loads of that motion.
module psalm_link_wrenches
   use psalm_axes, only: into_axes, out_of_axes, quarter_turn
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t, parameter_inertia, parameter_mass, parameter_mx, parameter_my
   use psalm_group_reactions, only: effects_of_couple, find_pitch_point, group_couple_t
   use psalm_kinds, only: wp
   use psalm_kinetostatics, only: add_source, clear_wrenches, couples_of_group, find_location, find_shoe, first_load, &
                                  first_spring, forces_t, move_bodies, prepare_forces, rub, source_inertia, source_weight, &
                                  sources_of, sweep
   use psalm_linkage, only: padded
   use psalm_locations, only: location_of_place, location_t, place_right
   use psalm_loop_forces, only: link_of_body
   use psalm_mechanism, only: at_finish, at_start, body_frame, joint_gear, joint_revolute, joint_prismatic, mechanism_t
   use psalm_plate_masses, only: is_part_of_cylinder
   use psalm_rates, only: differentiate, prepare_rates, rates_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: link_loads_t, find_link_loads, words_of_kind

   integer, parameter :: by_joint = 1, by_drive = 2, by_load = 3, by_spring = 4, by_friction = 5, by_weight = 6
   character(8), parameter :: words_of_kind(*) = [character(8) :: 'joint', 'drive', 'load', 'spring', 'friction', 'weight']

   !> What acts on a link at one of its points.
   type :: link_force_t
      integer :: body = body_frame
      integer :: kind = by_joint                 !! one of `by_...`
      character(:), allocatable :: name          !! of the joint, drive, load ...
      integer :: joint = 0                       !! of the mechanism
      integer :: pin = 0                         !! several joints
      integer :: number = 0                      !! of the load, spring, entry with friction, drive
      integer :: side = 0                        !! which of the bodies of a joint it is, or of a couple
      integer :: rod = 0                         !! between the rod of a cylinder, this body, and its barrel
      logical :: in_gear = .false.
      type(group_couple_t) :: couple             !! of wheels; of a drive between two links that its group holds
      logical :: free_couple = .false.           !! it is that of such a drive
      ! shape (positions, 2), (positions, 2), (positions)
      real(wp), allocatable :: place(:, :)       !! on the link, user's length
      real(wp), allocatable :: force(:, :)       !! N
      real(wp), allocatable :: moment(:)         !! N m
   end type link_force_t

   !> A link; arrays by position.
   type :: carried_link_t
      character(:), allocatable :: name
      ! its axes in those of the body
      real(wp) :: origin(2) = 0.0_wp             !! from the body's reference, user's length
      real(wp) :: along(2) = [1.0_wp, 0.0_wp]    !! unit vector
      real(wp) :: mass = 0.0_wp                  !! kg
      real(wp) :: centre(2) = 0.0_wp             !! of mass, in its axes, user's length; without a mass the origin of the axes
      real(wp) :: inertia = 0.0_wp               !! about that, kg m2
      real(wp), allocatable :: at(:, :)          !! shape (positions, 2): the origin of its axes in the machine, user's length
      real(wp), allocatable :: direction(:, :)   !! shape (positions, 2): unit vector of its x axis
      real(wp), allocatable :: turning(:, :)     !! shape (positions, 2): rad/s, rad/s2
      real(wp), allocatable :: accel(:, :)       !! shape (positions, 2): of the centre of mass, in its axes, m/s2
   end type carried_link_t

   type :: link_loads_t
      type(carried_link_t), allocatable :: links(:) !! the frame first, in machine axes
      type(link_force_t), allocatable :: acting(:)   !! link by link
   end type link_loads_t

contains

   !> Loads of all links. The problem is bound and its plan has every loop, every root and all vertices (`vertices_of`).
   !>
   !> Without meaning where the linkage does not close, is at a dead point, or friction locks it.
   subroutine find_link_loads(set, problem, dimensions, model, input, loads)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: input(:)           !! shape (positions): degrees or length
      type(link_loads_t), intent(out) :: loads
      type(rates_t) :: rates
      type(forces_t) :: forces
      real(wp), allocatable :: grips(:, :)       ! (position, entry): as `rub` has them
      ! all but what rods do to their barrels: (position, force and moment about the store's origin, body)
      real(wp), allocatable :: balance(:, :, :)
      integer :: block, offset, n, m, source, k, b

      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      call make_links(set, problem, dimensions, model, loads%links)
      call list_acting(set, problem, model, forces, loads%acting)
      allocate (grips(0, 0))
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         m = padded(n)
         call differentiate(problem, rates, n, 2)
         call move_bodies(problem, rates, n, set%pace(), set%change_of_pace(), forces)
         call clear_wrenches(n, forces)
         do source = 1, sources_of(model)
            call add_source(problem, model, source, input(offset + 1:offset + n), n, forces)
         end do
         if (size(model%friction) > 0) then
            call rub(problem, model, rates, n, forces, grips)
         else
            call sweep(problem, n, forces)
         end if
         do b = 1, size(loads%links)
            call move_link(problem, model, forces, b, offset, n, loads%links(b))
         end do
         ! joints and drives keep their rows while the wrenches of single sources are found
         call clear_wrenches(n, forces)
         call add_source(problem, model, source_inertia, input(offset + 1:offset + n), n, forces)
         if (allocated(balance)) deallocate (balance)
         allocate (balance(n, 3, size(forces%bodies)))
         do b = 1, size(forces%bodies)
            balance(:, :, b) = forces%w%v(1:n, forces%bodies(b)%wrench:forces%bodies(b)%wrench + 2)
         end do
         do k = 1, size(loads%acting)
            if (loads%acting(k)%rod == 0 .or. loads%acting(k)%kind == by_drive) &
               call add_acting(problem, model, forces, grips, input(offset + 1:offset + n), offset, n, loads%links, balance, &
                               loads%acting(k))
         end do
         do k = 1, size(loads%acting)
            if (loads%acting(k)%rod > 0 .and. loads%acting(k)%kind == by_joint) &
               call guide_rod(problem, forces, offset, n, loads%links, balance, loads%acting(k))
         end do
      end do
   end subroutine find_link_loads

   !> Names, axes and masses of the links. The axes of a link of a sketch begin at its first joint, their x axis leads to its
   !> second; those of other links are those of the body's own arc; of the parts of a cylinder they lead from its first joint to its
   !> second.
   subroutine make_links(set, problem, dimensions, model, links)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(carried_link_t), allocatable, intent(out) :: links(:)
      type(location_t) :: location
      real(wp) :: at(2)
      integer :: b, k, link, state

      associate (mechanism => problem%mechanism)
         allocate (links(size(mechanism%bodies)))
         do b = 1, size(links)
            associate (own => links(b), inertia => model%inertia(:, b))
               own%name = mechanism%bodies(b)%name
               allocate (own%at(problem%positions, 2), own%turning(problem%positions, 2), own%accel(problem%positions, 2), &
                         source=0.0_wp)
               allocate (own%direction(problem%positions, 2))
               own%direction(:, 1) = 1.0_wp
               own%direction(:, 2) = 0.0_wp
               if (b == body_frame) cycle
               if (allocated(set%traced)) then
                  link = link_of_body(mechanism, b)
                  associate (n => mechanism%bodies(b)%axis)
                     if (is_part_of_cylinder(mechanism, b)) then
                        do k = at_start, at_finish
                           if (mechanism%arcs(n)%joints(k) == 0) cycle
                           if (mechanism%arcs(n)%joints(k) == set%sketch%links(link)%joints(1)) &
                              own%along = merge(1.0_wp, -1.0_wp, k == at_start)*own%along
                        end do
                     else if (link > 0) then
                        call location_of_place(mechanism, dimensions, model%reference, set%traced%link_places(link), &
                                               location, state)
                        if (state == place_right .and. location%body == b) then
                           own%origin = location%at
                           own%along = location%along
                        end if
                     end if
                  end associate
               end if
               own%mass = inertia(parameter_mass)
               own%inertia = inertia(parameter_inertia)
               if (own%mass > 0.0_wp) then
                  at = inertia([parameter_mx, parameter_my])/own%mass
                  own%inertia = own%inertia - own%mass*(at(1)**2 + at(2)**2)
                  own%centre = into_axes(own%along, at/model%metre - own%origin)
               end if
            end associate
         end do
      end associate
   end subroutine make_links

   !> Everything that acts, link by link: joints, drives, loads, springs, friction, weight.
   subroutine list_acting(set, problem, model, forces, acting)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(in) :: forces
      type(link_force_t), allocatable, intent(out) :: acting(:)
      type(link_force_t), allocatable :: list(:), more(:)
      type(link_force_t) :: one
      type(group_couple_t), allocatable :: couples(:)
      integer :: many, b, j, d, k, loop, t

      allocate (list(16))
      many = 0
      associate (mechanism => problem%mechanism)
         do j = 1, size(mechanism%joints)
            associate (joint => mechanism%joints(j))
               if (joint%kind == joint_gear) cycle
               do k = 1, 2
                  if (joint%kind == joint_revolute) then
                     call put(joint%bodies(k), by_joint, pin_name(j, joint%bodies(k)), joint=j, pin=joint%pin)
                  else
                     call put(joint%bodies(k), by_joint, joint%name, joint=j, side=k)
                  end if
               end do
            end associate
         end do
         do b = 1, size(mechanism%bodies)
            if (.not. mechanism%bodies(b)%is_rod) cycle
            associate (barrel => mechanism%arcs(mechanism%bodies(b)%axis)%body, &
                       drive => mechanism%arcs(mechanism%bodies(b)%axis)%drive)
               do k = 1, 2
                  call put(merge(barrel, b, k == 1), by_joint, mechanism%bodies(b)%name//' slide', rod=b, side=k)
                  call put(merge(barrel, b, k == 1), by_drive, drive_name(drive), rod=b, side=k, number=drive)
               end do
            end associate
         end do
         do d = 1, size(mechanism%actuators)
            associate (actuator => mechanism%actuators(d))
               if (actuator%joint == 0) cycle
               if (mechanism%joints(actuator%joint)%kind /= joint_revolute) cycle
               call put(mechanism%arcs(actuator%arc)%body, by_drive, drive_name(d), joint=actuator%joint, number=d, side=2)
               if (set%masses%motor_on_frame) &
                  call put(body_frame, by_drive, drive_name(d), joint=actuator%joint, number=d, side=1)
            end associate
         end do
         do j = 1, size(mechanism%joints)
            if (forces%along(j) == 0) cycle
            do k = 1, 2
               call put(mechanism%joints(j)%bodies(k), by_drive, drive_name(forces%along(j)), joint=j, &
                        number=forces%along(j), side=k)
            end do
         end do
         do loop = 1, mechanism%nloop
            if (.not. allocated(mechanism%groups(loop)%ties)) cycle
            call couples_of_group(problem, forces, loop, couples)
            t = 0
            do d = 1, size(mechanism%groups(loop)%ties)
               associate (tie => mechanism%groups(loop)%ties(d))
                  if (tie%of_slides) cycle
                  t = t + 1
                  do k = 1, size(couples(t)%bodies)
                     if (couples(t)%bodies(k) == 0 .and. .not. abs(couples(t)%factors(k)) > 0.0_wp) cycle
                     one = link_force_t(body=max(couples(t)%bodies(k), body_frame), side=k, couple=couples(t))
                     if (couples(t)%drive > 0) then
                        one%kind = by_drive
                        one%name = drive_name(tie%drive)
                        one%free_couple = .true.
                        one%joint = pin_of_drive(tie%drive, one%body)
                     else
                        one%in_gear = .true.
                        one%name = mechanism%joints(tie%joint)%name
                     end if
                     call append(one)
                  end do
               end associate
            end do
         end do
         do k = 1, size(model%loads)
            call put(model%loads(k)%location%body, by_load, 'load '//to_text(k), number=k)
         end do
         do k = 1, size(model%springs)
            ! one with both ends on a link has no effect
            if (model%springs(k)%ends(1)%body == model%springs(k)%ends(2)%body) cycle
            do b = 1, 2
               call put(model%springs(k)%ends(b)%body, by_spring, 'spring '//to_text(k), number=k, side=b)
            end do
         end do
         do k = 1, size(model%friction)
            do b = 1, 2
               call put(model%friction(k)%bodies(b), by_friction, joint_name(model%friction(k)%joint), &
                        joint=model%friction(k)%joint, number=k, side=b)
            end do
         end do
         do b = body_frame + 1, size(mechanism%bodies)
            if (any(abs(model%gravity) > 0.0_wp) .and. any(abs(model%inertia(:parameter_my, b)) > 0.0_wp)) &
               call put(b, by_weight, 'weight')
         end do
         allocate (acting(many))
         k = 0
         do b = 1, size(mechanism%bodies)
            do j = 1, many
               if (list(j)%body /= b) cycle
               k = k + 1
               acting(k) = list(j)
               allocate (acting(k)%place(problem%positions, 2), acting(k)%force(problem%positions, 2), &
                         acting(k)%moment(problem%positions), source=0.0_wp)
            end do
         end do
      end associate

   contains

      subroutine put(body, kind, name, joint, pin, number, side, rod)
         integer, intent(in) :: body, kind
         character(*), intent(in) :: name
         integer, intent(in), optional :: joint, pin, number, side, rod
         type(link_force_t) :: new
         integer :: i

         new%body = body
         new%kind = kind
         new%name = name
         if (present(joint)) new%joint = joint
         if (present(pin)) new%pin = pin
         if (present(number)) new%number = number
         if (present(side)) new%side = side
         if (present(rod)) new%rod = rod
         do i = 1, many
            ! what a link takes from a pin is one force, however many joints are on it
            if (new%pin > 0 .and. list(i)%pin == new%pin .and. list(i)%body == body) return
         end do
         call append(new)
      end subroutine put

      subroutine append(new)
         type(link_force_t), intent(in) :: new
         integer :: i

         if (many == size(list)) then
            allocate (more(2*many))
            do i = 1, many
               more(i) = list(i)
            end do
            call move_alloc(more, list)
         end if
         many = many + 1
         list(many) = new
      end subroutine append

      !> The name of a joint; of a pin of a sketch the joint of the sketch.
      pure function joint_name(number) result(name)
         integer, intent(in) :: number
         character(:), allocatable :: name
         integer :: at

         name = problem%mechanism%joints(number)%name
         if (.not. set%has_names() .or. problem%mechanism%joints(number)%kind /= joint_revolute) return
         at = problem%mechanism%arcs(problem%mechanism%joints(number)%arc)%joints(problem%mechanism%joints(number)%end)
         if (at > 0) name = trim(set%sketch%joint_name(at))
      end function joint_name

      !> A pin as the columns of kalm call what the link takes from it.
      pure function pin_name(number, body) result(name)
         integer, intent(in) :: number, body
         character(:), allocatable :: name
         integer :: i

         name = joint_name(number)
         if (set%has_names()) return
         do i = 1, size(problem%mechanism%joints)
            associate (other => problem%mechanism%joints(i))
               if (other%kind /= joint_revolute .or. other%pin /= problem%mechanism%joints(number)%pin) cycle
               if (other%bodies(2) == body) name = other%name
            end associate
         end do
      end function pin_name

      !> A joint on the pin at which a drive turns a link; 0: there is none.
      pure integer function pin_of_drive(drive, body) result(found)
         integer, intent(in) :: drive, body
         integer :: i

         found = 0
         if (.not. set%has_names()) return
         associate (at => set%sketch%drives(drive)%joint)
            if (at == 0) return
            do i = 1, size(problem%mechanism%joints)
               associate (other => problem%mechanism%joints(i))
                  if (other%kind == joint_revolute .and. other%pin == problem%mechanism%pin_of_sketch(at) .and. &
                      any(other%bodies == body)) found = i
               end associate
            end do
         end associate
      end function pin_of_drive

      pure function drive_name(drive) result(name)
         integer, intent(in) :: drive
         character(:), allocatable :: name

         name = 'drive'
         if (drive > 1) name = 'drive '//to_text(drive)
         if (drive <= size(set%sketch%drives)) name = 'drive '//trim(set%sketch%drive_label(drive))
      end function drive_name
   end subroutine list_acting

   !> Where a link is and how it moves.
   subroutine move_link(problem, model, forces, body, offset, n, link)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: body, offset, n
      type(carried_link_t), intent(inout) :: link
      real(wp) :: e(2), from(2), centre(2), a(2)
      integer :: i

      if (body == body_frame) return
      associate (row => forces%bodies(body), w => forces%w%v, v => problem%linkage%store%v, metre => model%metre)
         do i = 1, n
            e = [w(i, row%ex), w(i, row%ey)]
            from = [v(i, row%px), v(i, row%py)]/problem%linkage%scale + [problem%output%origin_x, problem%output%origin_y]
            link%at(offset + i, :) = from + out_of_axes(e, link%origin)
            link%direction(offset + i, :) = out_of_axes(e, link%along)
            link%turning(offset + i, :) = [w(i, row%w), w(i, row%al)]
            centre = metre*out_of_axes(e, link%origin + out_of_axes(link%along, link%centre))
            associate (turn => w(i, row%w)**2, al => w(i, row%al))
               a = forces%metre*[w(i, row%ax), w(i, row%ay)] - turn*centre + al*quarter_turn(centre)
            end associate
            link%accel(offset + i, :) = into_axes(out_of_axes(e, link%along), a)
         end do
      end associate
   end subroutine move_link

   !> What acts at one point of a link, and its part in the link's equilibrium.
   subroutine add_acting(problem, model, forces, grips, input, offset, n, links, balance, one)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(inout) :: forces
      real(wp), intent(in) :: grips(:, :)        !! shape (n, entries with friction)
      real(wp), intent(in) :: input(:)           !! shape (n)
      integer, intent(in) :: offset, n
      type(carried_link_t), intent(in) :: links(:)
      real(wp), intent(inout) :: balance(:, :, :) !! shape (n, 3, bodies): N, N times a store unit; of its body this is added
      type(link_force_t), intent(inout) :: one
      real(wp), dimension(padded(n)) :: x, y, fx, fy, moment, ux, uy, reach, aside ! store units, N, N times a store unit
      real(wp) :: sense
      integer :: j

      x = 0.0_wp
      y = 0.0_wp
      fx = 0.0_wp
      fy = 0.0_wp
      moment = 0.0_wp
      sense = merge(1.0_wp, -1.0_wp, one%side == 2)
      select case (one%kind)
      case (by_joint)
         if (one%in_gear) then
            call mesh()
         else if (one%pin > 0) then
            call find_point(one%joint)
            do j = 1, size(problem%mechanism%joints)
               associate (joint => problem%mechanism%joints(j), row => forces%joints(j))
                  if (joint%kind /= joint_revolute .or. joint%pin /= one%pin) cycle
                  sense = 0.0_wp
                  if (joint%bodies(2) == one%body) sense = 1.0_wp
                  if (joint%bodies(1) == one%body) sense = -1.0_wp
                  fx = fx + sense*forces%w%v(1:size(fx), row)
                  fy = fy + sense*forces%w%v(1:size(fy), row + 1)
               end associate
            end do
         else
            call find_slide()
            associate (across => forces%w%v(1:size(fx), forces%joints(one%joint)), &
                       couple => forces%w%v(1:size(fx), forces%joints(one%joint) + 1))
               fx = -sense*across*uy
               fy = sense*across*ux
               moment = sense*(couple - across*reach)
               if (forces%along(one%joint) > 0) moment = moment - sense*aside* &
                                                         forces%w%v(1:size(fx), forces%drives(forces%along(one%joint)))
            end associate
         end if
      case (by_drive)
         if (one%rod > 0) then
            call find_rod(problem, forces, one%rod, size(fx), x, y, ux, uy)
            associate (arc => problem%mechanism%arcs(problem%mechanism%bodies(one%rod)%axis), &
                       push => forces%w%v(1:size(fx), forces%drives(one%number)))
               if (arc%foot /= at_finish) sense = -sense
               fx = sense*push*ux
               fy = sense*push*uy
            end associate
         else if (one%free_couple) then
            if (one%joint > 0) call find_point(one%joint)
            moment = one%couple%factors(one%side)*forces%w%v(1:size(fx), one%couple%drive)/forces%metre
         else if (problem%mechanism%joints(one%joint)%kind == joint_revolute) then
            call find_point(one%joint)
            moment = sense*forces%w%v(1:size(fx), forces%drives(one%number))/forces%metre
         else
            call find_slide()
            associate (push => forces%along_sense(one%joint)*sense*forces%w%v(1:size(fx), forces%drives(one%number)))
               fx = push*ux
               fy = push*uy
            end associate
            ! the lever that it has is part of the couple of the joint, as listed
         end if
      case (by_friction)
         if (problem%mechanism%joints(one%joint)%kind == joint_prismatic) then
            call find_slide()
            fx(:n) = sense*grips(:n, one%number)*ux(:n)
            fy(:n) = sense*grips(:n, one%number)*uy(:n)
         else
            call find_point(one%joint)
            moment(:n) = sense*grips(:n, one%number)/forces%metre
         end if
      case default
         call take_source()
      end select
      do j = 1, n
         balance(j, :, one%body) = balance(j, :, one%body) + [fx(j), fy(j), moment(j) + x(j)*fy(j) - y(j)*fx(j)]
         call enter(problem, forces, links(one%body), offset + j, [x(j), y(j)], [fx(j), fy(j)], moment(j), one)
      end do

   contains

      subroutine find_point(joint)
         integer, intent(in) :: joint

         associate (link => problem%linkage, point => problem%plan%joint_points(problem%mechanism%joints(joint)%point))
            x = link%store%v(1:size(x), link%point_x(point))
            y = link%store%v(1:size(x), link%point_y(point))
         end associate
      end subroutine find_point

      !> The place of a slide, its direction, and what `find_shoe` says of it.
      subroutine find_slide()

         associate (link => problem%linkage, joint => problem%mechanism%joints(one%joint))
            associate (root => problem%plan%root(joint%slide), v => link%store%v)
               ux = link%x(joint%slide)*v(1:size(x), link%root_x(root)) - link%y(joint%slide)*v(1:size(x), link%root_y(root))
               uy = link%x(joint%slide)*v(1:size(x), link%root_y(root)) + link%y(joint%slide)*v(1:size(x), link%root_x(root))
            end associate
         end associate
         if (model%shoes(one%joint)%given) then
            call find_shoe(problem, model, forces, one%joint, size(x), x, y, reach, aside)
         else
            call find_point(one%joint)
            reach = 0.0_wp
            aside = 0.0_wp
         end if
      end subroutine find_slide

      !> Wheels push each other where they touch; on one centre they pass couples.
      subroutine mesh()
         real(wp) :: on(3, 3), pitch(2), arm(2)
         logical :: found
         integer :: i

         do i = 1, n
            call effects_of_couple(one%couple, problem%linkage%store, i, 1.0_wp, on)
            call find_pitch_point(one%couple, problem%linkage%store, i, 1.0_wp, pitch, arm, found)
            if (.not. found .and. one%couple%centres(1) > 0) pitch = problem%linkage%store%v(i, one%couple%centres(:2))
            x(i) = pitch(1)
            y(i) = pitch(2)
            associate (wrench => forces%w%v(i, one%couple%couple)*on(:, one%side))
               fx(i) = wrench(1)
               fy(i) = wrench(2)
               ! about the pitch point the force has no moment
               if (.not. found) moment(i) = wrench(3)
            end associate
         end do
      end subroutine mesh

      !> Loads, springs and weight from the wrench of the source.
      subroutine take_source()
         type(location_t) :: location
         integer :: source

         select case (one%kind)
         case (by_load)
            source = first_load() + one%number - 1
            location = model%loads(one%number)%location
         case (by_spring)
            source = first_spring(model) + one%number - 1
            location = model%springs(one%number)%ends(one%side)
         case default
            source = source_weight
            location%body = one%body
            location%at = links(one%body)%origin + out_of_axes(links(one%body)%along, links(one%body)%centre)
         end select
         call clear_wrenches(n, forces)
         call add_source(problem, model, source, input, n, forces)
         call find_location(problem, forces, location, size(x), x, y)
         associate (row => forces%bodies(one%body)%wrench, w => forces%w%v)
            fx = w(1:size(fx), row)
            fy = w(1:size(fy), row + 1)
            if (one%kind == by_load) then
               ! a moment that the load has besides
               moment = w(1:size(fx), row + 2) - (x*fy - y*fx)
               if (.not. abs(model%loads(one%number)%moment) > 0.0_wp) moment = 0.0_wp
            else if (one%kind == by_spring) then
               if (model%springs(one%number)%torsional) moment = w(1:size(fx), row + 2)
            else if (.not. links(one%body)%mass > 0.0_wp) then
               moment = w(1:size(fx), row + 2) - (x*fy - y*fx)
            end if
         end associate
      end subroutine take_source
   end subroutine add_acting

   !> The foot of a rod, and the direction of its cylinder.
   subroutine find_rod(problem, forces, rod, m, x, y, ux, uy)
      type(problem_t), intent(in) :: problem
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: rod, m
      real(wp), intent(out) :: x(m), y(m), ux(m), uy(m)

      associate (row => forces%bodies(rod), v => problem%linkage%store%v)
         x = v(1:m, row%px)
         y = v(1:m, row%py)
         ux = forces%w%v(1:m, row%ex)
         uy = forces%w%v(1:m, row%ey)
      end associate
   end subroutine find_rod

   !> Between rod and barrel acts what the rod needs for its equilibrium, as a force and a moment at the end of the rod; along the
   !> cylinder the drive bears it.
   subroutine guide_rod(problem, forces, offset, n, links, balance, one)
      type(problem_t), intent(in) :: problem
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: offset, n
      type(carried_link_t), intent(in) :: links(:)
      real(wp), intent(in) :: balance(:, :, :)   !! shape (n, 3, bodies): N, N times a store unit; of the rod all but this
      type(link_force_t), intent(inout) :: one
      real(wp), dimension(padded(n)) :: x, y, ux, uy
      real(wp) :: wrench(3), sense
      integer :: i

      call find_rod(problem, forces, one%rod, size(x), x, y, ux, uy)
      sense = merge(1.0_wp, -1.0_wp, one%side == 2)
      do i = 1, n
         wrench = -sense*balance(i, :, one%rod)
         wrench(3) = wrench(3) - (x(i)*wrench(2) - y(i)*wrench(1))
         call enter(problem, forces, links(one%body), offset + i, [x(i), y(i)], wrench(:2), wrench(3), one)
      end do
   end subroutine guide_rod

   !> A force at a place, and a moment beside it, in the axes of the link at a position.
   subroutine enter(problem, forces, link, position, place, force, moment, one)
      type(problem_t), intent(in) :: problem
      type(forces_t), intent(in) :: forces
      type(carried_link_t), intent(in) :: link
      integer, intent(in) :: position
      real(wp), intent(in) :: place(2), force(2), moment !! of the store: its units, N, N times a store unit
      type(link_force_t), intent(inout) :: one
      real(wp) :: along(2)                        ! a copy: gfortran 12 takes a section's associate name for a whole array

      along = link%direction(position, :)
      one%place(position, :) = into_axes(along, place/problem%linkage%scale + &
                                         [problem%output%origin_x, problem%output%origin_y] - link%at(position, :))
      one%force(position, :) = into_axes(along, force)
      one%moment(position) = forces%metre*moment
   end subroutine enter
end module psalm_link_wrenches
