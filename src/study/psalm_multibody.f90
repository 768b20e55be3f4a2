!> A mechanism as multibody programs read it: bodies with inertias, joints that make a tree of them, joints that close the loops.
!>
!> Everything is given where the mechanism stands at one position, in metres and machine axes. The coordinate of a joint is 0
!> there: the turn of its second body in the first, or how far that slides along the joint's line. Wheels in gear, drives that
!> follow others and drives between links that have no joint in common are linear relations of these coordinates.
!>
!> The result is checked before it is given: at all positions of the case the pins of both bodies must meet, slides stay on their
!> lines, and the relations hold.
module psalm_multibody
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_body_motion, only: body_motion_t, follow_bodies
   use psalm_body_points, only: locate_point
   use psalm_data_set, only: data_set_t
   use psalm_dependent_joints, only: dependence_t, polynomial_t, find_proven_range, chebyshev_points, even_points, fit_series
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, motion_t, make_problem
   use psalm_force_model, only: force_model_t, make_force_model, parameter_inertia, parameter_mass, parameter_mx, parameter_my, &
                                vertices_of
   use psalm_kinds, only: wp, full_turn, radians_per_degree
   use psalm_locations, only: location_of_place, location_t, place_right
   use psalm_loop_forces, only: loops_carry_forces
   use psalm_mechanism, only: mechanism_t, arc_actuator, at_finish, body_frame, joint_gear, joint_prismatic
   use psalm_output_kind, only: motion_point
   use psalm_place, only: place_t
   use psalm_preparation, only: prepared_t, prepare
   use psalm_sketch, only: sketch_t
   use psalm_source, only: line_t
   use psalm_spring_law, only: spring_law_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: multibody_t, tree_joint_t, make_multibody

   integer, parameter :: most_checked = 720      !! positions at which the result is checked
   real(wp), parameter :: misfit = 1.0e-8_wp     !! part of the size, and radians, by which joints may gape there
   real(wp), parameter :: turn = full_turn*radians_per_degree !! radians
   real(wp), parameter :: largest_machine = 20.0_wp !! metres; a larger one may have been drawn in millimetres
   real(wp), parameter :: most_felt = 2.0_wp     !! times the least inertia
   real(wp), parameter :: bar_mass = 1.0_wp      !! kg for a metre of link, where no link has a mass
   real(wp), parameter :: shortest_bar = 0.1_wp  !! part of the size: blocks are taken for bars of this length
   real(wp), parameter :: light = 1.0e-4_wp      !! a link without a mass among others that have one: so much of their mean
   real(wp), parameter :: least_radius = 1.0e-3_wp !! of gyration, as part of the size: programs refuse a body without inertia

   !> A rigid body. The frame is the first.
   type :: rigid_body_t
      character(:), allocatable :: name
      real(wp) :: at(2) = 0.0_wp                 !! where its axes begin: at the joint that leads to it in the tree
      real(wp) :: mass = 0.0_wp, centre(2) = 0.0_wp, inertia = 0.0_wp !! kg, m, kg m2 about the centre of mass
      logical :: mass_assumed = .false., inertia_assumed = .false.
      real(wp), allocatable :: points(:, :)      !! shape (2, points): joints and other points of it
      integer :: joint = 0                       !! the joint that leads to it in the tree; 0: the frame
      ! of a plate, m
      real(wp) :: thickness = 0.0_wp             !! 0: it is none
      real(wp) :: width = 0.0_wp, hole = 0.0_wp  !! hole: the diameter of all
      real(wp), allocatable :: corners(:, :), holes(:, :) !! shapes (2, corners), (2, holes): corners anticlockwise
   end type rigid_body_t

   !> A joint.
   type :: tree_joint_t
      character(:), allocatable :: name
      logical :: slides = .false.
      integer :: bodies(2) = 0                   !! in the tree the first is nearer to the frame
      real(wp) :: at(2) = 0.0_wp                 !! the pin; a point of the slide's line
      real(wp) :: along(2) = [1.0_wp, 0.0_wp]    !! of a slide
      logical :: in_tree = .false.
      real(wp) :: rate = 0.0_wp                  !! of its coordinate at the speed of the case, rad/s or m/s
      integer :: number = 0                      !! of the mechanism's joint; 0: between rod and barrel
      integer :: drive = 0                       !! the actuator that moves it,
      real(wp) :: sense = 1.0_wp                 !! in this sense
   end type tree_joint_t

   !> The sum of `factors` times the coordinates of the joints is 0, or the stroke of a drive from here, rad or m.
   type :: relation_t
      character(:), allocatable :: name
      real(wp), allocatable :: factors(:)        !! by joint; 0 of those that are not in the tree
      logical :: is_drive = .false.
      logical :: slides = .false.                !! its stroke is a length
      real(wp) :: rate = 0.0_wp                  !! of a drive: rad/s or m/s
   end type relation_t

   !> A point of a body that is no joint: a coupler point.
   type :: marked_point_t
      character(:), allocatable :: name
      integer :: body = body_frame
      real(wp) :: at(2) = 0.0_wp
   end type marked_point_t

   !> A linear spring with a damper.
   type :: link_spring_t
      integer :: bodies(2) = body_frame
      real(wp) :: ends(2, 2) = 0.0_wp            !! shape (x and y, ends)
      real(wp) :: stiffness = 0.0_wp, damping = 0.0_wp, free = 0.0_wp !! N/m, N s/m; m, what the preload adds taken off
   end type link_spring_t

   type :: multibody_t
      character(:), allocatable :: name
      type(rigid_body_t), allocatable :: bodies(:) !! those of the tree after the body that they hang on
      type(tree_joint_t), allocatable :: joints(:)
      type(relation_t), allocatable :: relations(:)
      type(marked_point_t), allocatable :: marked(:)
      type(link_spring_t), allocatable :: springs(:)
      real(wp) :: gravity(2) = 0.0_wp            !! m/s2, machine axes
      real(wp) :: size = 0.0_wp                  !! of the mechanism, m
      real(wp) :: speed = 1.0_wp                 !! of the first drive, rad/s or m/s
      real(wp) :: inertia = 0.0_wp               !! of all links as the first drive feels it, kg m2 or kg: the mean over the
                                                 !! positions, but not more than some times the least
      real(wp) :: input = 0.0_wp                 !! where it stands, as listed: degrees or user's length
      type(dependence_t), allocatable :: dependence !! how joints follow the only drive; not allocated: not asked for, or not known
   end type multibody_t

contains

   !> Make it of a case.
   !>
   !> Errors: the case itself has mistakes; loops that do not have all joints of a sketch; joints that are no points of both their
   !> links; a linkage that closes nowhere. Warnings: what of the case the result does not have; masses that had to be assumed.
   subroutine make_multibody(set, model, findings, with_dependence, shapes_alone)
      type(data_set_t), intent(in) :: set
      type(multibody_t), intent(out) :: model
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in) :: with_dependence            !! the joints as polynomials of the drive are asked for
      logical, intent(in) :: shapes_alone               !! masses and forces do not matter
      class(prepared_t), allocatable :: prepared        ! large, as are the next: they would fill a small stack
      class(problem_t), allocatable :: problem, wider
      class(force_model_t), allocatable :: forces
      type(body_motion_t) :: pose
      type(diagnostics_t) :: unused
      type(line_t) :: none(0)
      real(wp) :: origin(2)
      integer, allocatable :: order(:)

      allocate (prepared, forces)
      unused%file = set%file
      call prepare(set, none, prepared, unused)
      if (.not. prepared%ready) then
         call findings%error('has mistakes, so there is no model of its bodies', line=set%title_line)
         return
      end if
      if (set%is_drawn()) then
         if (.not. loops_carry_forces(set)) then
            call findings%error('this sketch is solved by loops that do not have all its joints; with the group &MASSES '// &
                                '(it may be empty) they have', line=set%title_line)
            return
         end if
      end if
      unused = diagnostics_t()
      unused%file = set%file
      call make_force_model(set, prepared%mechanism, prepared%given, forces, unused)
      if (unused%failed()) then
         call findings%append(unused)
         return
      end if
      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call problem%want_derivatives(.true., vertices_of(prepared%mechanism))
      call stand(set, prepared, problem, wider, model, findings)
      if (.not. allocated(wider)) return
      call follow_bodies(problem, forces, pose)
      model%name = trim(set%title)
      model%gravity = forces%gravity
      model%speed = set%pace()
      if (prepared%mechanism%sliding_input) model%speed = model%speed*forces%metre
      origin = origin_of(prepared, forces%metre)
      call add_bodies(prepared, forces, pose, model)
      call mark_points(set, prepared, forces, pose, model)
      call add_joints(prepared%mechanism, problem, forces%metre, origin, model)
      call add_masses(forces, pose, origin, model)
      call add_plates(forces, pose, origin, model)
      call plant_tree(model, order)
      call add_relations(prepared%mechanism, forces%metre, set%pace(), set%sketch, model)
      call add_rates(pose, 1, origin, set%pace(), model%joints)
      call add_springs(forces, pose, origin, model)
      call check(set, wider, forces, pose, origin, model, findings)
      if (with_dependence .and. .not. findings%failed()) &
         call follow_joints(set, prepared, problem, wider, forces, pose, origin, model, findings)
      if (.not. shapes_alone .or. any(model%bodies%thickness > 0.0_wp)) call warn_of_size(set, forces, model, findings)
      if (.not. shapes_alone) call warn(set, forces, model, findings)
      call put_in_order(order, model)
   end subroutine make_multibody

   !> Where the input pivot is, m.
   pure function origin_of(prepared, metre) result(at)
      type(prepared_t), intent(in) :: prepared
      real(wp), intent(in) :: metre
      real(wp) :: at(2)

      call unit_vector(prepared%given%origng, at(1), at(2))
      at = metre*prepared%given%origlk*at
   end function origin_of

   !> Put the linkage where it is to be described: at the reference position, of a sketch its drawing; where it does not close
   !> there, or has several drives of their own, at the first position that closes.
   !>
   !> `wider` is not allocated if it closes nowhere; else it has positions that close.
   subroutine stand(set, prepared, problem, wider, model, findings)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      class(problem_t), intent(inout) :: problem       !! becomes one of a single position
      class(problem_t), allocatable, intent(out) :: wider
      type(multibody_t), intent(inout) :: model
      type(diagnostics_t), intent(inout) :: findings
      class(problem_t), allocatable :: one
      type(motion_t) :: motion
      integer, allocatable :: closed(:)
      integer :: i, step

      call problem%analyse(prepared%given, motion)
      closed = pack([(i, i=1, size(motion%closed))], motion%closed)
      if (size(closed) == 0) then
         call findings%error('closes at none of its positions, so there is no model of its bodies', line=set%title_line)
         return
      end if
      model%input = motion%input(closed(1))
      step = (size(closed) - 1)/most_checked + 1
      allocate (wider, source=problem)
      call wider%keep_positions(closed(::step))
      call wider%bind(prepared%given)
      if (all(prepared%mechanism%actuators(2:)%geared)) then
         allocate (one, source=problem)
         call one%set_inputs([0.0_wp])
         call one%analyse(prepared%given, motion)
         if (motion%closed(1)) then
            model%input = motion%input(1)
            call problem%set_inputs([0.0_wp])
            call problem%bind(prepared%given)
            return
         end if
      end if
      call problem%keep_positions(closed(:1))
      call problem%bind(prepared%given)
   end subroutine stand

   !> Names and points of the bodies.
   pure subroutine add_bodies(prepared, forces, pose, model)
      type(prepared_t), intent(in) :: prepared
      type(force_model_t), intent(in) :: forces
      type(body_motion_t), intent(in) :: pose
      type(multibody_t), intent(inout) :: model
      real(wp) :: origin(2), from(2), points(2, size(prepared%mechanism%points))
      integer :: b, k, n
      logical :: found

      origin = origin_of(prepared, forces%metre)
      associate (mechanism => prepared%mechanism)
         allocate (model%bodies(size(mechanism%bodies)))
         do b = 1, size(model%bodies)
            associate (body => model%bodies(b))
               body%name = mechanism%bodies(b)%name
               body%at = origin
               n = 0
               do k = 1, size(mechanism%bodies(b)%points)
                  call locate_point(mechanism, prepared%given, b, forces%reference(b), mechanism%bodies(b)%points(k), from, found)
                  if (.not. found) cycle
                  n = n + 1
                  points(:, n) = placed(pose, 1, b, origin, from*forces%metre)
               end do
               body%points = points(:, :n)
               model%size = max(model%size, maxval(abs(body%points - spread(origin, 2, n))))
            end associate
         end do
      end associate
   end subroutine add_bodies

   !> Joints of a sketch that no other link shares; of loops the output point. They are points of their bodies, too.
   subroutine mark_points(set, prepared, forces, pose, model)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(force_model_t), intent(in) :: forces
      type(body_motion_t), intent(in) :: pose
      type(multibody_t), intent(inout) :: model
      type(location_t) :: location
      type(place_t) :: place
      integer :: j, state

      allocate (model%marked(0))
      if (allocated(set%traced)) then
         do j = 1, size(set%traced%joint_places)
            if (set%traced%joint_places(j)%distance > 0.0_wp) call mark(trim(set%sketch%joint_name(j)), set%traced%joint_places(j))
         end do
      else if (prepared%mechanism%outputs(1)%motion == motion_point) then
         associate (output => prepared%mechanism%outputs(1), arcs => prepared%mechanism%arcs)
            place = place_t(arc=arcs(output%arc)%place, loop=arcs(output%arc)%loop, from_start=output%from_start, &
                            distance=prepared%given%outlk, angle=prepared%given%outang)
         end associate
         if (place%distance > 0.0_wp) call mark('output', place)
      end if

   contains

      subroutine mark(name, place)
         character(*), intent(in) :: name
         type(place_t), intent(in) :: place
         type(marked_point_t) :: point

         call location_of_place(prepared%mechanism, prepared%given, forces%reference, place, location, state)
         if (state /= place_right) return
         point%name = name
         point%body = location%body
         point%at = placed(pose, 1, location%body, origin_of(prepared, forces%metre), forces%metre*location%at)
         model%marked = [model%marked, point]
         associate (body => model%bodies(location%body))
            body%points = reshape([body%points, point%at], [2, size(body%points, 2) + 1])
         end associate
      end subroutine mark
   end subroutine mark_points

   !> What of the bodies is cut from plate.
   pure subroutine add_plates(forces, pose, origin, model)
      type(force_model_t), intent(in) :: forces
      type(body_motion_t), intent(in) :: pose
      real(wp), intent(in) :: origin(2)
      type(multibody_t), intent(inout) :: model
      integer :: k

      do k = 1, size(forces%plates)
         associate (plate => forces%plates(k), body => model%bodies(forces%plates(k)%body))
            body%thickness = forces%metre*plate%thickness
            body%width = forces%metre*plate%width
            body%hole = forces%metre*plate%hole
            body%corners = all_placed(plate%body, plate%corners)
            body%holes = all_placed(plate%body, plate%holes)
         end associate
      end do

   contains

      pure function all_placed(body, from) result(at)
         integer, intent(in) :: body
         real(wp), intent(in) :: from(:, :)
         real(wp) :: at(2, size(from, 2))
         integer :: i

         do i = 1, size(from, 2)
            at(:, i) = placed(pose, 1, body, origin, forces%metre*from(:, i))
         end do
      end function all_placed
   end subroutine add_plates

   !> A place on a body, from its reference in its axes, as a place of the machine.
   pure function placed(pose, position, body, origin, from) result(at)
      type(body_motion_t), intent(in) :: pose
      integer, intent(in) :: position, body
      real(wp), intent(in) :: origin(2), from(2)
      real(wp) :: at(2)

      associate (c => pose%c(position, body), s => pose%s(position, body))
         at = origin + [pose%x(position, body) + from(1)*c - from(2)*s, pose%y(position, body) + from(1)*s + from(2)*c]
      end associate
   end function placed

   !> The joints where they are, those between rod and barrel of cylinders after the others.
   pure subroutine add_joints(mechanism, problem, metre, origin, model)
      type(mechanism_t), intent(in) :: mechanism
      class(problem_t), intent(in) :: problem          !! solved at its one position
      real(wp), intent(in) :: metre, origin(2)
      type(multibody_t), intent(inout) :: model
      integer :: j, k, b

      allocate (model%joints(count(mechanism%joints%kind /= joint_gear) + count(mechanism%bodies%is_rod)))
      k = 0
      associate (link => problem%linkage, plan => problem%plan)
         do j = 1, size(mechanism%joints)
            if (mechanism%joints(j)%kind == joint_gear) cycle
            k = k + 1
            associate (joint => mechanism%joints(j), own => model%joints(k))
               own%name = joint%name
               own%number = j
               own%slides = joint%kind == joint_prismatic
               own%bodies = joint%bodies
               associate (point => plan%joint_points(joint%point))
                  own%at = origin + metre*[link%store%v(1, link%point_x(point)), link%store%v(1, link%point_y(point))]
               end associate
               own%drive = findloc(mechanism%actuators%joint, j, dim=1)
               if (.not. own%slides) cycle
               associate (n => mechanism%arcs(joint%slide)%representative)
                  own%along = direction_of(n)
                  if (mechanism%arcs(n)%kind /= arc_actuator) cycle
                  own%drive = mechanism%arcs(n)%drive
                  ! the input is the arc's length, which leads to the body at its finish
                  if (mechanism%body_at(n, at_finish) /= joint%bodies(2)) own%sense = -1.0_wp
               end associate
            end associate
         end do
         do b = 1, size(mechanism%bodies)
            if (.not. mechanism%bodies(b)%is_rod) cycle
            k = k + 1
            associate (own => model%joints(k), n => mechanism%bodies(b)%axis)
               own%name = mechanism%bodies(b)%name//' slide'
               own%slides = .true.
               own%bodies = [b, mechanism%arcs(n)%body]
               if (mechanism%arcs(n)%foot == at_finish) own%bodies = own%bodies([2, 1])
               associate (point => plan%joint_points(mechanism%arcs(n)%ends(mechanism%arcs(n)%foot)))
                  own%at = origin + metre*[link%store%v(1, link%point_x(point)), link%store%v(1, link%point_y(point))]
               end associate
               own%along = direction_of(n)
               own%drive = mechanism%arcs(n)%drive
            end associate
         end do
      end associate

   contains

      !> Direction of an arc, from its start.
      pure function direction_of(n) result(along)
         integer, intent(in) :: n
         real(wp) :: along(2)

         associate (link => problem%linkage, root => problem%plan%root(n))
            associate (x => link%store%v(1, link%root_x(root)), y => link%store%v(1, link%root_y(root)))
               along = [link%x(n)*x - link%y(n)*y, link%x(n)*y + link%y(n)*x]
            end associate
         end associate
      end function direction_of
   end subroutine add_joints

   !> Choose the joints of the tree, and turn them so that they lead away from the frame. `order` has the bodies, each after the one
   !> that it hangs on.
   !>
   !> Drives come first; then slides, for one that closes a loop is hard to state; then pins of links that a drive moves, and of
   !> links without a mass: a drive must bear more than such a link in the tree where loops are closed by stiff springs.
   pure subroutine plant_tree(model, order)
      type(multibody_t), intent(inout) :: model
      integer, allocatable, intent(out) :: order(:)
      integer, parameter :: drives = 1, slides = 2, driven_pins = 3, light_pins = 4, pins = 5
      integer :: part(size(model%bodies)), n, i, j, b, round
      logical :: wanted, driven(size(model%bodies))

      driven = .false.
      do j = 1, size(model%joints)
         if (model%joints(j)%drive > 0) driven(model%joints(j)%bodies) = .true.
      end do
      driven(body_frame) = .false.
      part = [(b, b=1, size(part))]
      do round = drives, pins
         do j = 1, size(model%joints)
            associate (joint => model%joints(j))
               wanted = round == pins .or. (round >= slides .and. joint%slides) .or. joint%drive > 0 .or. &
                        (round >= driven_pins .and. any(driven(joint%bodies))) .or. &
                        (round >= light_pins .and. any(model%bodies(joint%bodies)%mass_assumed))
               if (.not. wanted .or. part(joint%bodies(1)) == part(joint%bodies(2))) cycle
               joint%in_tree = .true.
               where (part == part(joint%bodies(2))) part = part(joint%bodies(1))
            end associate
         end do
      end do
      allocate (order(size(part)), source=0)
      order(1) = body_frame
      n = 1
      i = 0
      do while (i < n)
         i = i + 1
         do j = 1, size(model%joints)
            associate (joint => model%joints(j))
               if (.not. joint%in_tree .or. all(joint%bodies /= order(i)) .or. model%bodies(order(i))%joint == j) cycle
               if (joint%bodies(2) == order(i)) then
                  joint%bodies = joint%bodies([2, 1])
                  ! a slide's coordinate stays what it was, a pin's changes its sign
                  joint%along = -joint%along
                  if (.not. joint%slides) joint%sense = -joint%sense
               end if
               n = n + 1
               order(n) = joint%bodies(2)
               model%bodies(order(n))%joint = j
               model%bodies(order(n))%at = joint%at
            end associate
         end do
      end do
      order = order(:n)
   end subroutine plant_tree

   !> What drives move, and what holds between joints besides the loops.
   pure subroutine add_relations(mechanism, metre, pace, sketch, model)
      type(mechanism_t), intent(in) :: mechanism
      real(wp), intent(in) :: metre, pace        !! pace: of the first drive, rad/s or user's length/s
      type(sketch_t), intent(in) :: sketch
      type(multibody_t), intent(inout) :: model
      type(relation_t) :: relation
      integer :: d, g, t

      allocate (model%relations(0))
      do d = 1, size(mechanism%actuators)
         associate (actuator => mechanism%actuators(d), first => mechanism%actuators(1))
            relation = relation_t()
            relation%factors = stroke(d)
            relation%slides = actuator%slides
            relation%is_drive = .not. actuator%geared
            relation%name = 'drive'
            if (size(mechanism%actuators) > 1) relation%name = 'drive '//to_text(d)
            if (d <= size(sketch%drives)) relation%name = 'drive '//trim(sketch%drive_label(d))
            if (actuator%geared) relation%factors = relation%factors - actuator%ratio*input_unit(actuator%slides)/ &
                                                    input_unit(first%slides)*stroke(1)
            ! drives of their own have speeds of their own
            if (relation%is_drive) relation%rate = pace*actuator%by_first(1)*unit(actuator%slides)
            model%relations = [model%relations, relation]
         end associate
      end do
      do g = 1, size(mechanism%groups)
         if (.not. allocated(mechanism%groups(g)%ties)) cycle
         do t = 1, size(mechanism%groups(g)%ties)
            associate (tie => mechanism%groups(g)%ties(t))
               if (tie%drive > 0 .or. tie%of_slides) cycle
               relation = relation_t()
               relation%factors = turns_of(g, t)
               relation%name = 'gear '//to_text(t)
               if (tie%joint > 0) relation%name = mechanism%joints(tie%joint)%name
               model%relations = [model%relations, relation]
            end associate
         end do
      end do

   contains

      pure real(wp) function unit(slides)
         logical, intent(in) :: slides

         unit = merge(metre, 1.0_wp, slides)
      end function unit

      !> Metres, or radians, in a unit of an input.
      pure real(wp) function input_unit(slides)
         logical, intent(in) :: slides

         input_unit = merge(metre, radians_per_degree, slides)
      end function input_unit

      !> The stroke of a drive by the coordinates of the joints: that of its joint, or turns of links.
      pure function stroke(drive) result(factors)
         integer, intent(in) :: drive
         real(wp), allocatable :: factors(:)
         integer :: j, loop, k

         allocate (factors(size(model%joints)), source=0.0_wp)
         do j = 1, size(factors)
            if (model%joints(j)%drive /= drive .or. .not. model%joints(j)%in_tree) cycle
            factors(j) = model%joints(j)%sense
            return
         end do
         do loop = 1, size(mechanism%groups)
            if (.not. allocated(mechanism%groups(loop)%ties)) cycle
            do k = 1, size(mechanism%groups(loop)%ties)
               if (mechanism%groups(loop)%ties(k)%drive /= drive) cycle
               factors = turns_of(loop, k)
               return
            end do
         end do
      end function stroke

      !> The sum of turns that a tie is.
      pure function turns_of(group, number) result(factors)
         integer, intent(in) :: group, number
         real(wp), allocatable :: factors(:)
         integer :: k, body

         allocate (factors(size(model%joints)), source=0.0_wp)
         associate (tie => mechanism%groups(group)%ties(number))
            do k = 1, size(tie%axes)
               if (tie%axes(k) == 0) cycle
               body = mechanism%arcs(tie%axes(k))%body
               do while (model%bodies(body)%joint > 0)
                  associate (joint => model%bodies(body)%joint)
                     if (.not. model%joints(joint)%slides) factors(joint) = factors(joint) + tie%factors(k)
                     body = model%joints(joint)%bodies(1)
                  end associate
               end do
            end do
         end associate
      end function turns_of
   end subroutine add_relations

   !> How fast the coordinates of all joints change at a position.
   pure subroutine add_rates(pose, position, origin, pace, joints)
      type(body_motion_t), intent(in) :: pose
      integer, intent(in) :: position
      real(wp), intent(in) :: origin(2)
      real(wp), intent(in) :: pace              !! of the input, rad/s or user's length/s
      type(tree_joint_t), intent(inout) :: joints(:)  !! where they are at that position
      integer :: j

      do j = 1, size(joints)
         associate (joint => joints(j))
            joint%rate = pose%w(position, joint%bodies(2)) - pose%w(position, joint%bodies(1))
            if (joint%slides) joint%rate = dot_product(speed_on(joint%bodies(2)) - speed_on(joint%bodies(1)), joint%along)
            joint%rate = pace*joint%rate
         end associate
      end do

   contains

      !> Speed of the place of the joint on a body.
      pure function speed_on(body) result(v)
         integer, intent(in) :: body
         real(wp) :: v(2)

         associate (from => joints(j)%at - origin - [pose%x(position, body), pose%y(position, body)], w => pose%w(position, body))
            v = [pose%vx(position, body) - w*from(2), pose%vy(position, body) + w*from(1)]
         end associate
      end function speed_on
   end subroutine add_rates

   !> Masses; those that have to be assumed, too.
   pure subroutine add_masses(forces, pose, origin, model)
      type(force_model_t), intent(in) :: forces
      type(body_motion_t), intent(in) :: pose
      real(wp), intent(in) :: origin(2)
      type(multibody_t), intent(inout) :: model
      real(wp) :: sum_of, ends(2, 2), length
      integer :: b, heavy

      sum_of = sum(forces%inertia(parameter_mass, :))
      heavy = count(forces%inertia(parameter_mass, :) > 0.0_wp)
      do b = body_frame + 1, size(model%bodies)
         associate (body => model%bodies(b), own => forces%inertia(:, b))
            body%mass = own(parameter_mass)
            body%inertia = own(parameter_inertia)
            body%mass_assumed = .not. body%mass > 0.0_wp
            if (body%mass_assumed) then
               call longest(body%points, ends, length)
               body%centre = 0.5_wp*(ends(:, 1) + ends(:, 2))
               if (size(body%points, 2) == 0) body%centre = placed(pose, 1, b, origin, [0.0_wp, 0.0_wp])
               length = max(length, shortest_bar*model%size)
               body%mass = light*sum_of/real(max(heavy, 1), wp)
               if (heavy == 0) body%mass = bar_mass*length
               body%inertia = max(body%inertia, body%mass*length**2/12.0_wp)  ! of a uniform bar
            else
               body%centre = placed(pose, 1, b, origin, own([parameter_mx, parameter_my])/body%mass)
               body%inertia = body%inertia - (own(parameter_mx)**2 + own(parameter_my)**2)/body%mass
            end if
            associate (least => body%mass*(least_radius*model%size)**2)
               body%inertia_assumed = body%inertia < least .and. .not. body%mass_assumed
               body%inertia = max(body%inertia, least)
            end associate
         end associate
      end do
   end subroutine add_masses

   !> The two points farthest from each other.
   pure subroutine longest(points, ends, length)
      real(wp), intent(in) :: points(:, :)
      real(wp), intent(out) :: ends(2, 2), length
      integer :: i, k

      ends = 0.0_wp
      if (size(points, 2) > 0) ends = spread(points(:, 1), 2, 2)
      length = 0.0_wp
      do i = 1, size(points, 2)
         do k = i + 1, size(points, 2)
            associate (away => hypotenuse(points(1, k) - points(1, i), points(2, k) - points(2, i)))
               if (away <= length) cycle
               length = away
               ends = points(:, [i, k])
            end associate
         end do
      end do
   end subroutine longest

   !> Springs along a line.
   pure subroutine add_springs(forces, pose, origin, model)
      type(force_model_t), intent(in) :: forces
      type(body_motion_t), intent(in) :: pose
      real(wp), intent(in) :: origin(2)
      type(multibody_t), intent(inout) :: model
      type(link_spring_t) :: own
      integer :: k, e

      allocate (model%springs(0))
      do k = 1, size(forces%springs)
         associate (spring => forces%springs(k))
            if (.not. is_carried(spring)) cycle
            own%bodies = spring%ends%body
            do e = 1, 2
               own%ends(:, e) = placed(pose, 1, spring%ends(e)%body, origin, forces%metre*spring%ends(e)%at)
            end do
            own%stiffness = spring%stiffness
            own%damping = spring%damping
            own%free = forces%metre*spring%free - spring%preload/spring%stiffness
            model%springs = [model%springs, own]
         end associate
      end do
   end subroutine add_springs

   pure logical function is_carried(spring)
      class(spring_law_t), intent(in) :: spring

      is_carried = .not. spring%torsional .and. spring%stiffness > 0.0_wp .and. spring%is_plain()
   end function is_carried

   !> Errors: a body that no joint leads to; joints that gape, slides that leave their lines, relations that do not hold at some
   !> position. None of them is to be expected.
   subroutine check(set, problem, forces, pose, origin, model, findings)
      type(data_set_t), intent(in) :: set
      class(problem_t), intent(inout) :: problem       !! of the positions
      type(force_model_t), intent(in) :: forces
      type(body_motion_t), intent(in) :: pose          !! where the model stands
      real(wp), intent(in) :: origin(2)
      type(multibody_t), intent(inout) :: model        !! gets the inertia that the drive feels
      type(diagnostics_t), intent(inout) :: findings
      type(body_motion_t) :: motion
      type(tree_joint_t), allocatable :: joints(:)
      real(wp), allocatable :: felt(:)
      real(wp) :: ends(2, 2), before(2), after(2), gap, askew, v(2), rate
      integer :: i, j, k, b

      do b = body_frame + 1, size(model%bodies)
         if (model%bodies(b)%joint > 0) cycle
         call findings%error('no joint leads to the link '//model%bodies(b)%name//': there is no model of its bodies', &
                             line=set%title_line)
         return
      end do
      call follow_bodies(problem, forces, motion)
      joints = model%joints
      do i = 1, size(motion%x, 1)
         do j = 1, size(joints)
            associate (joint => joints(j), one => joints(j)%bodies(1), other => joints(j)%bodies(2))
               do k = 1, 2
                  ends(:, k) = carried(joint%bodies(k), model%joints(j)%at, .true.)
               end do
               joint%at = ends(:, 2)
               gap = hypotenuse(ends(1, 2) - ends(1, 1), ends(2, 2) - ends(2, 1))
               askew = 0.0_wp
               if (joint%slides) then
                  joint%along = carried(one, model%joints(j)%along, .false.)
                  before = carried(other, model%joints(j)%along, .false.)
                  askew = abs(joint%along(1)*before(2) - joint%along(2)*before(1))
                  after = ends(:, 2) - ends(:, 1)
                  gap = abs(joint%along(1)*after(2) - joint%along(2)*after(1))
               end if
               if (gap > misfit*model%size .or. askew > misfit) then
                  call refuse('joint '//joint%name)
                  return
               end if
            end associate
         end do
         call add_rates(motion, i, origin, set%pace(), joints)
         do j = 1, size(model%relations)
            associate (relation => model%relations(j))
               associate (sum_of => sum(relation%factors*joints%rate), large => sum(abs(relation%factors*joints%rate)))
                  if (abs(sum_of - relation%rate) <= misfit*(abs(model%speed) + large)) cycle
               end associate
               call refuse(relation%name)
               return
            end associate
         end do
      end do
      ! twice the kinetic energy over the square of the drive's speed
      allocate (felt(size(motion%x, 1)), source=0.0_wp)
      do i = 1, size(felt)
         do b = body_frame + 1, size(model%bodies)
            associate (body => model%bodies(b), at => carried(b, model%bodies(b)%centre, .true.), w => motion%w(i, b))
               v = at - origin - [motion%x(i, b), motion%y(i, b)]
               v = [motion%vx(i, b) - w*v(2), motion%vy(i, b) + w*v(1)]
               felt(i) = felt(i) + body%mass*sum(v**2) + body%inertia*w**2
            end associate
         end do
      end do
      rate = merge(forces%metre, 1.0_wp, problem%mechanism%sliding_input)
      model%inertia = min(most_felt*minval(felt), sum(felt)/real(size(felt), wp))/rate**2
      ! a motion in time starts at rest: no inertia is felt
      if (.not. model%inertia > 0.0_wp) model%inertia = sum(model%bodies%mass)* &
                                                        merge(1.0_wp, model%size**2, problem%mechanism%sliding_input)

   contains

      !> A place, or a direction, of a body as it is at position `i`.
      pure function carried(body, given, is_place) result(at)
         integer, intent(in) :: body
         real(wp), intent(in) :: given(2)
         logical, intent(in) :: is_place
         real(wp) :: at(2), from(2)

         from = given
         if (is_place) from = given - origin - [pose%x(1, body), pose%y(1, body)]
         from = [from(1)*pose%c(1, body) + from(2)*pose%s(1, body), from(2)*pose%c(1, body) - from(1)*pose%s(1, body)]
         at = [from(1)*motion%c(i, body) - from(2)*motion%s(i, body), from(1)*motion%s(i, body) + from(2)*motion%c(i, body)]
         if (is_place) at = at + origin + [motion%x(i, body), motion%y(i, body)]
      end function carried

      subroutine refuse(what)
         character(*), intent(in) :: what

         call findings%error('the model of its bodies does not move as the linkage does: '//what//', position '//to_text(i)// &
                             '; please report this case', line=set%title_line)
      end subroutine refuse
   end subroutine check

   !> The coordinates of the joints as polynomials of the stroke of the drive, over the range that is proven to close.
   !>
   !> Warnings: several drives; no range that is proven.
   subroutine follow_joints(set, prepared, problem, wider, forces, pose, origin, model, findings)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      class(problem_t), intent(in) :: problem          !! where the model stands
      class(problem_t), intent(in) :: wider            !! of the positions
      type(force_model_t), intent(in) :: forces
      type(body_motion_t), intent(in) :: pose          !! where the model stands
      real(wp), intent(in) :: origin(2)
      type(multibody_t), intent(inout) :: model
      type(diagnostics_t), intent(inout) :: findings
      type(dependence_t) :: dependence
      type(polynomial_t) :: one
      real(wp), allocatable :: at_nodes(:, :), at_even(:, :), nodes(:), even(:)
      real(wp) :: low, high, unit
      logical :: whole, closes
      integer :: j, n

      associate (actuators => prepared%mechanism%actuators)
         if (.not. all(actuators(2:)%geared)) then
            call findings%warning('has several drives: no joint follows one of them alone, and the URDF model has neither '// &
                                  'limits of drives nor polynomials', line=set%title_line)
            return
         end if
         unit = merge(forces%metre, radians_per_degree, actuators(1)%slides)
      end associate
      call find_proven_range(set, wider, prepared%given, problem%delt(1), low, high, whole)
      closes = high > low .and. low <= problem%delt(1) .and. problem%delt(1) <= high
      if (closes) then
         nodes = chebyshev_points(low, high)
         even = even_points(low, high)
         call coordinates_at(nodes, at_nodes, closes)
         if (closes) call coordinates_at(even, at_even, closes)
      end if
      if (.not. closes) then
         call findings%warning('no range of the drive is proven to close: the URDF model has neither limits of the drive nor '// &
                               'polynomials', line=set%title_line)
         return
      end if
      dependence%whole_turn = whole
      dependence%low = unit*(low - problem%delt(1))
      dependence%high = unit*(high - problem%delt(1))
      allocate (dependence%joints(0))
      n = size(even)
      do j = 1, size(model%joints)
         if (.not. model%joints(j)%in_tree) cycle
         one%joint = j
         one%advance = 0.0_wp
         if (whole) one%advance = at_even(n, j) - at_even(1, j)
         call fit_series(at_nodes(:, j), at_even(:, j), merge(model%size, 1.0_wp, model%joints(j)%slides), one%coefficients, &
                         one%error)
         dependence%joints = [dependence%joints, one]
      end do
      model%dependence = dependence

   contains

      !> Coordinates of all joints at inputs in order, turns going on from one to the next. Shape (inputs, joints).
      subroutine coordinates_at(inputs, coordinates, closes)
         real(wp), intent(in) :: inputs(:)
         real(wp), allocatable, intent(out) :: coordinates(:, :)
         logical, intent(out) :: closes
         class(problem_t), allocatable :: full
         type(motion_t) :: found
         type(body_motion_t) :: motion
         integer :: i, joint, home

         allocate (full, source=problem)
         call full%set_inputs(inputs)
         call full%analyse(prepared%given, found)
         closes = all(found%closed)
         if (.not. closes) return
         call full%bind(prepared%given)
         call follow_bodies(full, forces, motion)
         allocate (coordinates(size(inputs), size(model%joints)))
         home = minloc(abs(inputs - problem%delt(1)), dim=1)
         do joint = 1, size(model%joints)
            do i = 1, size(inputs)
               coordinates(i, joint) = coordinate_of(model%joints(joint), pose, motion, i, origin)
               if (model%joints(joint)%slides .or. i == 1) cycle
               associate (step => coordinates(i, joint) - coordinates(i - 1, joint))
                  coordinates(i, joint) = coordinates(i, joint) - turn*anint(step/turn)
               end associate
            end do
            if (model%joints(joint)%slides) cycle
            ! where the model stands it is 0
            coordinates(:, joint) = coordinates(:, joint) - turn*anint(coordinates(home, joint)/turn)
         end do
      end subroutine coordinates_at
   end subroutine follow_joints

   !> The coordinate of a joint at a position: 0 where the model stands, at the first position of `pose`.
   pure real(wp) function coordinate_of(joint, pose, motion, position, origin) result(coordinate)
      type(tree_joint_t), intent(in) :: joint
      type(body_motion_t), intent(in) :: pose, motion
      integer, intent(in) :: position
      real(wp), intent(in) :: origin(2)
      real(wp) :: turned(2, 2), ends(2, 2), along(2), from(2)
      integer :: k

      do k = 1, 2
         associate (b => joint%bodies(k))
            ! how the body has turned, as a unit vector
            turned(:, k) = [motion%c(position, b)*pose%c(1, b) + motion%s(position, b)*pose%s(1, b), &
                            motion%s(position, b)*pose%c(1, b) - motion%c(position, b)*pose%s(1, b)]
            from = joint%at - origin - [pose%x(1, b), pose%y(1, b)]
            ends(:, k) = [motion%x(position, b) + turned(1, k)*from(1) - turned(2, k)*from(2), &
                          motion%y(position, b) + turned(2, k)*from(1) + turned(1, k)*from(2)]
         end associate
      end do
      if (joint%slides) then
         along = [turned(1, 1)*joint%along(1) - turned(2, 1)*joint%along(2), &
                  turned(2, 1)*joint%along(1) + turned(1, 1)*joint%along(2)]
         coordinate = (ends(1, 2) - ends(1, 1))*along(1) + (ends(2, 2) - ends(2, 1))*along(2)
      else
         coordinate = radians_per_degree*degrees_of(turned(1, 1)*turned(1, 2) + turned(2, 1)*turned(2, 2), &
                                                    turned(1, 1)*turned(2, 2) - turned(2, 1)*turned(1, 2))
      end if
   end function coordinate_of

   !> A linkage that may have been drawn in millimetres.
   subroutine warn_of_size(set, forces, model, findings)
      type(data_set_t), intent(in) :: set
      type(force_model_t), intent(in) :: forces
      type(multibody_t), intent(in) :: model
      type(diagnostics_t), intent(inout) :: findings

      if (model%size > largest_machine .and. forces%metre == 1.0_wp) &
         call findings%warning('lengths are taken as metres, and this linkage is '//to_text(nint(model%size))//' m large; if '// &
                               'it is drawn in millimetres, set UNITL=0.001 in the group &MASSES', line=set%title_line)
   end subroutine warn_of_size

   !> What the model does not have, and what was assumed.
   subroutine warn(set, forces, model, findings)
      type(data_set_t), intent(in) :: set
      type(force_model_t), intent(in) :: forces
      type(multibody_t), intent(in) :: model
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: left_out
      integer :: k

      left_out = ''
      if (set%loads%given) left_out = left_out//', &LOADS'
      if (set%friction%given) left_out = left_out//', &FRICTN'
      if (set%gives('MOTOR')) left_out = left_out//', &MOTOR'
      if (set%gives('TIME')) left_out = left_out//', &TIME'
      if (len(left_out) > 0) call findings%warning('the model of its bodies does not have what these groups say: '// &
                                                   left_out(3:), line=set%title_line)
      if (any([(.not. is_carried(forces%springs(k)), k=1, size(forces%springs))])) &
         call findings%warning('the model of its bodies has the linear springs between two points that have a stiffness, no '// &
                               'others', line=set%title_line, group='SPRING')
      if (all(model%bodies(2:)%mass_assumed)) then
         call findings%warning('no link has a mass: in the model of its bodies each is a bar of 1 kg/m', line=set%title_line)
         return
      end if
      call name_bodies(model%bodies%mass_assumed, 'have no mass: in the model of its bodies they have 1/10000 of the mean of '// &
                       'the others')
      call name_bodies(model%bodies%inertia_assumed, 'have a mass and no moment of inertia: in the model of its bodies their '// &
                       'radius of gyration is 1/1000 of the size of the linkage')

   contains

      subroutine name_bodies(marked, words)
         logical, intent(in) :: marked(:)
         character(*), intent(in) :: words
         character(:), allocatable :: names
         integer :: b

         if (.not. any(marked)) return
         names = ''
         do b = 1, size(marked)
            if (marked(b)) names = names//', '//model%bodies(b)%name
         end do
         call findings%warning('links that '//words//': '//names(3:), line=set%title_line)
      end subroutine name_bodies
   end subroutine warn

   !> The bodies in an order in which each comes after the one that it hangs on.
   pure subroutine put_in_order(order, model)
      integer, intent(in) :: order(:)
      type(multibody_t), intent(inout) :: model
      type(rigid_body_t), allocatable :: ordered(:)
      integer :: number(size(model%bodies)), i, j

      if (size(order) < size(model%bodies)) return     ! `check` has said so
      allocate (ordered(size(order)))
      do i = 1, size(order)
         number(order(i)) = i
         ordered(i) = model%bodies(order(i))
      end do
      call move_alloc(ordered, model%bodies)
      do j = 1, size(model%joints)
         model%joints(j)%bodies = number(model%joints(j)%bodies)
      end do
      do j = 1, size(model%springs)
         model%springs(j)%bodies = number(model%springs(j)%bodies)
      end do
      do j = 1, size(model%marked)
         model%marked(j)%body = number(model%marked(j)%body)
      end do
   end subroutine put_in_order
end module psalm_multibody
