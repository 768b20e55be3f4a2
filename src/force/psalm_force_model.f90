!> Masses, loads, springs and friction of a mechanism: the groups of the data set put on its bodies.
!>
!> A place of the data set (an end of an arc, distance, angle) becomes a vector fixed in a body, from the body's *reference*: the
!> end of its own arc that is its own (the start; the finish where the start is the foot of a slide). All masses of a body
!> together are its mass, its first moment and its moment of inertia about the reference, in the axes of its own arc: the
!> four numbers in which every force of the mechanism is linear. Source: Oldham (1977), 15.1; Haines (about 1982), chapter 9.
module psalm_force_model
   use psalm_angles, only: unit_vector
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_force_entries, only: loading_t, loading_of
   use psalm_kinds, only: wp
   use psalm_locations, only: location_t, location_of_place, place_afloat, place_nowhere, place_on_foot, place_right, turned
   use psalm_loop_forces, only: link_of_body
   use psalm_mechanism, only: mechanism_t, at_start, at_finish, body_frame, joint_gear, joint_prismatic, joint_revolute, pivot
   use psalm_motor_group, only: motor_group_t, motor_of
   use psalm_place, only: place_t
   use psalm_plate_masses, only: plate_mass_t, find_plates
   use psalm_sketch, only: frame_link
   use psalm_spring_law, only: spring_law_t, spring_law_of
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: force_model_t, load_t, spring_t, friction_t, make_force_model, forces_wanted, vertices_of
   public :: body_of_link, joint_at, moving_pair
   public :: mass_parameters, parameter_mass, parameter_mx, parameter_my, parameter_inertia

   integer, parameter :: mass_parameters = 4  !! of a body
   integer, parameter :: parameter_mass = 1, parameter_mx = 2, parameter_my = 3, parameter_inertia = 4
   real(wp), parameter :: rounding = 64.0_wp*epsilon(1.0_wp) !! of sums of masses that cancel

   type, extends(loading_t) :: load_t
      type(location_t) :: location
      real(wp) :: force(2) = 0.0_wp         !! N; machine axes, or the axes of the body's own arc if it turns
   end type load_t

   type, extends(spring_law_t) :: spring_t
      type(location_t) :: ends(2)
   end type spring_t

   type :: friction_t
      integer :: joint = 0
      integer :: bodies(2) = 0              !! of a pin: what turns in the first is the second
      logical :: all_of_pin = .false.       !! pin of several links: its load is all that the second body takes from the pin
      real(wp) :: coefficient = 0.0_wp
      real(wp) :: grip = 0.0_wp             !! friction besides, whatever the load is: N m or N
      real(wp) :: from = 0.0_wp, until = huge(1.0_wp) !! s: it acts between these in time
      real(wp) :: radius = 0.0_wp           !! of the pin, half the length of the shoe; user's length
   end type friction_t

   !> How the loads of a joint are listed where a sketch names its links and slides; of &LINKS as they are found.
   type :: shoe_t
      logical :: given = .false.            !! prismatic joint of a sketch: couple and friction are those at this place
      type(location_t) :: location                  !! the middle of the shoe, on the second link of the slide
      real(wp) :: order = 1.0_wp            !! -1: the force on the first body of the joint is listed, not on the second
      real(wp) :: sense = 1.0_wp            !! -1: the arc's direction is opposite to that of the slide's line
   end type shoe_t

   type :: force_model_t
      real(wp) :: metre = 1.0_wp            !! metres in a unit of length
      real(wp) :: gravity(2) = 0.0_wp       !! m/s2
      logical :: timed = .false.            !! tables of loads are over the time,
      real(wp) :: time = 0.0_wp             !! which is this, s
      ! by body, the frame included
      integer, allocatable :: reference(:)  !! vertex of the mechanism
      real(wp), allocatable :: inertia(:, :) !! shape (4, bodies): mass [kg], first moments [kg m], moment of inertia [kg m2]
                                            !! about the reference
      logical :: tilts = .false.            !! masses have heights above the plane
      real(wp), allocatable :: tilt(:, :)   !! shape (3, bodies): masses times height [kg m], and these times place [kg m2]
      type(load_t), allocatable :: loads(:)
      type(spring_t), allocatable :: springs(:)
      type(friction_t), allocatable :: friction(:)
      type(shoe_t), allocatable :: shoes(:)       !! by joint
      real(wp), allocatable :: table_input(:)     !! shape (rows): degrees or user's length, ascending
      real(wp), allocatable :: table_factor(:, :) !! shape (rows, tables)
      type(location_t), allocatable :: centres(:)     !! shape (entries of MASSES)
      type(plate_mass_t), allocatable :: plates(:)    !! of PLATES
   end type force_model_t

contains

   !> True if a data set asks for forces.
   pure logical function forces_wanted(set)
      type(data_set_t), intent(in) :: set

      forces_wanted = set%masses%given .or. set%loads%given .or. set%springs%given .or. set%friction%given .or. &
                      set%gives('PLATES') .or. set%gives('MOTOR')
   end function forces_wanted

   !> Every vertex of a mechanism as the finish of an arc, for the plan. Shape of the result: (2, points), loop and arc.
   pure function vertices_of(mechanism) result(vertices)
      type(mechanism_t), intent(in) :: mechanism
      integer, allocatable :: vertices(:, :)
      integer :: n

      allocate (vertices(2, size(mechanism%points)), source=0)
      do n = size(mechanism%arcs), 1, -1
         associate (arc => mechanism%arcs(n))
            vertices(:, arc%ends(at_start)) = [arc%loop, arc%place - 1]
            vertices(:, arc%ends(at_finish)) = [arc%loop, arc%place]
         end associate
      end do
      vertices(:, pivot) = [1, 0]
   end function vertices_of

   !> Put the groups of a data set on the bodies of its mechanism.
   !>
   !> Errors: a place at the foot of a slide or on an arc that is only parallel to its link; a joint whose vertex is no point of
   !> both its links; a link whose mass or inertia is negative; friction where there is no joint, or of the link that holds a pin.
   !> Warning: a mass on the frame.
   subroutine make_force_model(set, mechanism, dimensions, model, findings, without_added)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(out) :: model
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in), optional :: without_added !! counterweights and springs that were added are left out
      integer :: k, body, masses, springs
      logical :: placed

      model%metre = set%masses%metre
      model%gravity = set%masses%gravity
      allocate (model%reference(size(mechanism%bodies)), source=pivot)
      allocate (model%inertia(mass_parameters, size(mechanism%bodies)), source=0.0_wp)
      do body = body_frame + 1, size(mechanism%bodies)
         associate (arc => mechanism%arcs(mechanism%bodies(body)%axis))
            model%reference(body) = arc%ends(merge(at_finish, at_start, arc%foot == at_start))
            if (mechanism%bodies(body)%is_rod) model%reference(body) = arc%ends(arc%foot)
         end associate
      end do
      allocate (model%shoes(size(mechanism%joints)))
      call put_shoes(set, mechanism, dimensions, model)
      call check_joints(set, mechanism, findings)
      if (any([(mechanism%is_braced(k), k=1, mechanism%nloop)])) &
         call set%origins%error(findings, 'CHAIN', 'KOVER', 'KOVER allows superfluous constraints; how forces divide between '// &
                                'them depends on the stiffness of the links, which is not known here')
      if (.not. set%gives('TIME')) then
         if (set%loads%timed) call needs_time('LOADS', 'LTIME')
         if (set%friction%timed) call needs_time('FRICTN', 'FTON, FTOFF')
         if (set%gives('MOTOR')) then
            if (is_switched(set)) call needs_time('MOTOR', 'MTON, MTOFF')
            if (drive_of_motor(set) > 1) call needs_time('MOTOR', 'MNAME')
         end if
      end if
      if (set%gives('MOTOR') .and. mechanism%sliding_input .and. drive_of_motor(set) == 1) then
         call set%origins%error(findings, 'MOTOR', '', 'motion from torque needs a crank that turns; the input of this linkage '// &
                                'slides')
      end if
      if (set%gives('MOTOR') .and. any(.not. mechanism%actuators(2:)%geared) .and. .not. set%gives('TIME')) then
         call set%origins%error(findings, 'MOTOR', '', 'motion from torque needs one drive that all others follow; '// &
                                'this linkage has several of their own')
      end if
      model%tilts = set%masses%has_heights
      allocate (model%tilt(parameter_my, size(mechanism%bodies)), source=0.0_wp)
      if (model%tilts .and. set%gives('TIME')) call set%origins%warning(findings, 'MASSES', 'MZ', &
         'has no effect on a motion in time: moments out of the plane are found where the drive has its speed')
      if (set%masses%link_loads .and. set%gives('TIME')) call set%origins%warning(findings, 'MASSES', 'ILOADS', &
         'has no effect on a motion in time: the loads of the links are those where the drive has its speed')
      masses = size(set%masses%places)
      springs = size(set%springs%first)
      if (present(without_added)) then
         if (without_added) masses = masses - set%masses%added
         if (without_added) springs = springs - set%springs%added
      end if
      allocate (model%loads(size(set%loads%places)), model%springs(springs), model%friction(size(set%friction%joints)), &
                model%centres(masses))
      do k = 1, size(model%centres)
         call place('MASSES', set%link_item('M'), k, set%masses%places(k), model%centres(k), placed)
         if (.not. placed) cycle
         if (model%centres(k)%body == body_frame) then
            call set%origins%warning(findings, 'MASSES', set%link_item('M'), 'entry '//to_text(k)//' is a mass on the '// &
                                     'frame: it has no effect', k)
            cycle
         end if
         call add_mass(model, model%centres(k), set%masses%mass(k), set%masses%inertia(k))
         if (.not. model%tilts) cycle
         associate (body => model%tilt(:, model%centres(k)%body))
            body = body + set%masses%mass(k)*set%masses%height(k)*model%metre*[1.0_wp, model%centres(k)%at*model%metre]
         end associate
      end do
      call find_plates(set, mechanism, dimensions, model%reference, model%metre, model%plates, findings)
      do k = 1, size(model%plates)
         associate (plate => model%plates(k))
            model%inertia(:, plate%body) = model%inertia(:, plate%body) + [plate%mass, plate%moment, plate%inertia]
         end associate
      end do
      call check_masses(set, mechanism, model, findings)
      do k = 1, size(model%loads)
         associate (load => model%loads(k))
            call place('LOADS', set%link_item('L'), k, set%loads%places(k), load%location, placed)
            load%force = set%loads%force(:, k)
            load%loading_t = loading_of(set%loads, k)
            if (load%turns) load%force = turned(load%force, load%location%along)
         end associate
      end do
      ! of a sketch every input counts from the drawing
      model%timed = set%loads%timed
      model%table_input = set%loads%input
      model%table_factor = set%loads%factor
      do k = 1, size(model%springs)
         associate (spring => model%springs(k))
            call place('SPRING', set%link_item('A'), k, set%springs%first(k), spring%ends(1), placed)
            call place('SPRING', set%link_item('B'), k, set%springs%second(k), spring%ends(2), placed)
            if (spring%ends(1)%body == spring%ends(2)%body .and. placed) then
               call set%origins%warning(findings, 'SPRING', set%link_item('B'), 'entry '//to_text(k)//' has both its ends on '// &
                                        'the same link: it has no effect', k)
            end if
            spring%spring_law_t = spring_law_of(set%springs, k)
            if (set%gives('TIME') .or. .not. (set%gives('MOTOR') .or. set%gives('DRIVEL'))) cycle
            if (abs(spring%drag) > 0.0_wp .or. (spring%side /= 0 .and. spring%damps())) &
               call set%origins%error(findings, 'SPRING', trim(merge('SQUAD', 'SSIDE', abs(spring%drag) > 0.0_wp)), 'entry '// &
                                      to_text(k)//': here damping must grow with the speed in a straight line; motion in time '// &
                                      '(&TIME) takes any', k)
         end associate
      end do
      do k = 1, size(model%friction)
         model%friction(k)%joint = joint_at(mechanism, set%friction%joints(k))
         model%friction(k)%coefficient = set%friction%coefficient(k)
         model%friction(k)%radius = set%friction%radius(k)
         model%friction(k)%grip = set%friction%grip(k)
         model%friction(k)%from = set%friction%from(k)
         model%friction(k)%until = set%friction%until(k)
         if (model%friction(k)%joint == 0) then
            call set%origins%error(findings, 'FRICTN', set%link_item('F'), 'entry '//to_text(k)//': there is no joint at this '// &
                                   'end of the arc', k)
            cycle
         end if
         model%friction(k)%bodies = mechanism%joints(model%friction(k)%joint)%bodies
         call choose_pair(k)
      end do

   contains

      subroutine needs_time(group, items)
         character(*), intent(in) :: group, items

         call set%origins%error(findings, group, items(:scan(items//',', ',') - 1), 'what it says is for motion in time; '// &
                                'give &TIME, or leave '//items//' out')
      end subroutine needs_time

      !> A place of the data set on its body.
      subroutine place(group, item, entry, given, location, placed)
         character(*), intent(in) :: group, item
         integer, intent(in) :: entry
         type(place_t), intent(in) :: given
         type(location_t), intent(out) :: location
         logical, intent(out) :: placed
         integer :: state

         call location_of_place(mechanism, dimensions, model%reference, given, location, state)
         placed = state == place_right
         if (state == place_nowhere) then
            call refuse(group, item, entry, 'is on a link that no loop runs through')
         else if (state == place_on_foot) then
            call refuse(group, item, entry, 'is counted from the foot of a slide, which is no point of the '// &
                        'sliding link; count it from the other end')
         else if (state == place_afloat) then
            call refuse(group, item, entry, 'is on an arc that is only parallel to its link: neither end of it is '// &
                        'a joint of the link')
         end if
      end subroutine place

      !> On a pin of several links of a sketch friction is between the named link and the one that holds the pin, in whatever order
      !> the loops run through it.
      subroutine choose_pair(entry)
         integer, intent(in) :: entry

         associate (at => set%friction%joints(entry), of => model%friction(entry))
            if (at%joint == 0 .or. at%slide > 0) return
            if (set%friction%others(entry) > 0) then
               call pair_clutch(entry)
               return
            end if
            if (size(set%sketch%links_of(at%joint)) == 2) return
            associate (holder => set%traced%pin_holders(at%joint))
               if (at%link == holder) then
                  call set%origins%error(findings, 'FRICTN', 'FNAME', 'entry '//to_text(entry)//': the pin is held by link '// &
                                         trim(set%sketch%links(holder)%name)//'; name another that turns on it', entry)
                  return
               end if
               of%bodies = [body_of_link(mechanism, holder), body_of_link(mechanism, at%link)]
               of%all_of_pin = .true.
            end associate
         end associate
      end subroutine choose_pair

      !> A clutch is between two of the links that the joint pins.
      subroutine pair_clutch(entry)
         integer, intent(in) :: entry

         associate (at => set%friction%joints(entry), of => model%friction(entry), other => set%friction%others(entry))
            associate (links => set%sketch%links_of(at%joint))
               if (at%link == 0 .or. at%link == other .or. .not. any(links == at%link) .or. .not. any(links == other)) then
                  call set%origins%error(findings, 'FRICTN', 'FOTHER', 'entry '//to_text(entry)//': a clutch is between two '// &
                                         'links of its joint; give the joint with the first in FNAME, and the other here', entry)
                  return
               end if
            end associate
            of%bodies = [body_of_link(mechanism, other), body_of_link(mechanism, at%link)]
            of%all_of_pin = .true.
         end associate
      end subroutine pair_clutch

      subroutine refuse(group, item, entry, words)
         character(*), intent(in) :: group, item, words
         integer, intent(in) :: entry

         call set%origins%error(findings, group, item, 'entry '//to_text(entry)//' '//words, entry)
      end subroutine refuse
   end subroutine make_force_model

   !> True if the motor is switched on or off at a time.
   pure logical function is_switched(set)
      type(data_set_t), intent(in) :: set
      type(motor_group_t) :: motor

      motor = motor_of(set)
      is_switched = motor%switched
   end function is_switched

   !> The drive that the motor turns.
   pure integer function drive_of_motor(set) result(drive)
      type(data_set_t), intent(in) :: set
      type(motor_group_t) :: motor

      motor = motor_of(set)
      drive = motor%drive
   end function drive_of_motor

   !> The body that a link of a sketch is.
   pure integer function body_of_link(mechanism, link) result(body)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: link

      do body = size(mechanism%bodies), body_frame + 1, -1
         if (link_of_body(mechanism, body) == link) return
      end do
   end function body_of_link

   !> Order, sense and shoe of every joint of a sketch: of a slide its first link acts on its second, of a pin of two links the one
   !> that places it on the other.
   subroutine put_shoes(set, mechanism, dimensions, model)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(inout) :: model
      real(wp) :: z(2), pivot_at(2)
      integer :: j, k, slide, state

      if (.not. allocated(set%traced)) return
      do k = 1, size(model%shoes)
         associate (joint => mechanism%joints(k), shoe => model%shoes(k))
            if (joint%kind == joint_gear) cycle
            if (joint%kind /= joint_prismatic) then
               j = mechanism%arcs(joint%arc)%joints(joint%end)
               if (j == 0) cycle
               if (size(set%sketch%links_of(j)) == 2 .and. &
                   link_of_body(mechanism, joint%bodies(2)) == set%traced%pin_holders(j)) shoe%order = -1.0_wp
               cycle
            end if
            slide = mechanism%arcs(joint%slide)%rail
            if (slide == 0) cycle
            if (link_of_body(mechanism, joint%bodies(1)) /= set%sketch%slides(slide)%links(1)) shoe%order = -1.0_wp
            shoe%sense = real(set%traced%line_senses(slide), wp)
            associate (place => set%traced%shoes(slide))
               if (place%link == frame_link) then
                  call unit_vector(place%angle, z(1), z(2))
                  call unit_vector(dimensions%origng, pivot_at(1), pivot_at(2))
                  shoe%location%at = place%distance*z - dimensions%origlk*pivot_at
                  shoe%given = .true.
               else
                  call location_of_place(mechanism, dimensions, model%reference, place, shoe%location, state)
                  shoe%given = state == place_right
               end if
            end associate
         end associate
      end do
   end subroutine put_shoes

   !> Add one entry to its body.
   pure subroutine add_mass(model, location, mass, inertia)
      type(force_model_t), intent(inout) :: model
      type(location_t), intent(in) :: location
      real(wp), intent(in) :: mass, inertia
      real(wp) :: r(2)

      r = location%at*model%metre
      associate (body => model%inertia(:, location%body))
         body(parameter_inertia) = body(parameter_inertia) + inertia
         if (.not. abs(mass) > 0.0_wp) return   ! a square of a length may overflow
         body(parameter_mass) = body(parameter_mass) + mass
         body(parameter_mx) = body(parameter_mx) + mass*r(1)
         body(parameter_my) = body(parameter_my) + mass*r(2)
         body(parameter_inertia) = body(parameter_inertia) + mass*(r(1)**2 + r(2)**2)
      end associate
   end subroutine add_mass

   !> Refuse links whose mass, or inertia about the centre of mass, is negative.
   subroutine check_masses(set, mechanism, model, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(force_model_t), intent(in) :: model
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: centre_inertia, size_of
      integer :: body, entry, n

      n = size(model%centres)
      do body = body_frame + 1, size(mechanism%bodies)
         associate (m => model%inertia(parameter_mass, body), mx => model%inertia(parameter_mx, body), &
                    my => model%inertia(parameter_my, body), io => model%inertia(parameter_inertia, body))
            entry = findloc(model%centres%body, body, dim=1, back=.true.)
            if (entry == 0) cycle
            size_of = sum(abs(set%masses%mass(:n)), mask=model%centres%body == body)
            if (m < -rounding*size_of) then
               call refuse('mass')
               cycle
            end if
            centre_inertia = io
            if (m > rounding*size_of) centre_inertia = io - (mx**2 + my**2)/m
            if (centre_inertia < -rounding*(abs(io) + sum(abs(set%masses%inertia(:n)), mask=model%centres%body == body))) &
               call refuse('moment of inertia')
         end associate
      end do

   contains

      subroutine refuse(what)
         character(*), intent(in) :: what

         call set%origins%error(findings, 'MASSES', 'MASS', 'the entries of '//mechanism%bodies(body)%name//' add up to a '// &
                                'negative '//what, entry)
      end subroutine refuse
   end subroutine check_masses

   !> Refuse joints that could not pass a force on: their vertex is no point of both links.
   subroutine check_joints(set, mechanism, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(diagnostics_t), intent(inout) :: findings
      integer :: k

      do k = 1, size(mechanism%joints)
         associate (joint => mechanism%joints(k), arc => mechanism%arcs(mechanism%joints(k)%arc))
            if (joint%attached) cycle
            call set%origins%error(findings, 'LINKS', 'ILINK', 'joint '//joint%name//' of loop '//to_text(arc%loop)//' is no '// &
                                   'point of both links that it joins: an arc there is only parallel to its link, which is '// &
                                   'enough for motion but not for forces', arc%place, arc%loop, set%links%maxarc)
         end associate
      end do
   end subroutine check_joints

   !> The joint at a place and its two bodies: the second is the one whose motion in the first counts.
   !>
   !> Of a slide it is the link named second; in a pin of a sketch the named link, or the later of two, in the first other link that
   !> the pin has; of &LINKS the link of the named arc. `joint` is 0 where there is none.
   subroutine moving_pair(set, mechanism, place, joint, bodies)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(place_t), intent(in) :: place
      integer, intent(out) :: joint, bodies(2)
      integer, allocatable :: links(:)
      integer :: turning

      bodies = 0
      joint = joint_at(mechanism, place)
      if (joint == 0) return
      bodies = mechanism%joints(joint)%bodies
      if (place%slide > 0 .or. mechanism%joints(joint)%kind == joint_prismatic) return
      if (place%joint == 0) then
         if (mechanism%arcs(mechanism%seq(place%loop, place%arc))%body == bodies(1)) bodies = bodies([2, 1])
         return
      end if
      links = set%sketch%links_of(place%joint)
      turning = links(2)
      if (place%link > 0) turning = place%link
      bodies = [body_of_link(mechanism, links(merge(2, 1, links(1) == turning))), body_of_link(mechanism, turning)]
   end subroutine moving_pair

   !> The joint at an end of an arc, or on a pin of a sketch; 0: there is none. Where several meet, one of that arc itself comes
   !> first; a link of a sketch that is named is the one that turns in the joint.
   pure integer function joint_at(mechanism, place) result(found)
      type(mechanism_t), intent(in) :: mechanism
      type(place_t), intent(in) :: place
      integer :: k, n, end

      found = 0
      if (place%loop == 0) return
      n = mechanism%seq(place%loop, place%arc)
      end = merge(at_start, at_finish, place%from_start)
      do k = size(mechanism%joints), 1, -1
         associate (joint => mechanism%joints(k))
            if (place%slide > 0) then
               if (joint%slide == n) found = k
               cycle
            end if
            if (.not. any(joint%bodies == mechanism%arcs(n)%body)) cycle
            if (place%joint > 0) then
               if (joint%kind /= joint_revolute .or. joint%pin /= mechanism%pin_of_sketch(place%joint)) cycle
               found = k
               if (place%link > 0 .and. joint%bodies(2) == mechanism%arcs(n)%body) return
               cycle
            end if
            if (joint%point /= mechanism%arcs(n)%ends(end)) cycle
            found = k
            if (joint%arc == n .and. joint%end == end) return
         end associate
      end do
   end function joint_at
end module psalm_force_model
