!> Bodies and joints from topology: what they are for known linkages, and that they are rigid in motion.
program test_bodies
   use cases, only: load_case
   use check, only: checks_t
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, body_frame, joint_prismatic, pivot
   use psalm_parameters, only: parameters_t
   use psalm_pin_order, only: pin_order_t, order_by_pins
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)

   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: all_cases(*) = [character(27) :: 'needle', 'textile', 'dwell', 'brake_reaction', &
      'dyad1_crank_rocker', 'dyad2_oscillating_cylinder', 'dyad3_quick_return', 'dyad4_slider_crank', 'dyad5_turning_block', &
      'dyad6_scotch_yoke', 'dyad7_oldham_coupling', 'dyad8_tangent_mechanism', 'actuator_rapson_slide', &
      'actuator_davis_steering']
   type(checks_t) :: t
   integer :: i

   call known_joints()
   call hangs('dyad1_crank_rocker', '0 1 2 1')
   call hangs('dyad4_slider_crank', '0 1 2 3')
   call hangs('dyad3_quick_return', '0 1 2 1')
   ! the yoke slides on the block and on the frame, which is nearer; the last link of the tangent mechanism is pinned to the block
   ! and slides on the frame
   call hangs('dyad6_scotch_yoke', '0 1 2 1*')
   call hangs('dyad7_oldham_coupling', '0 1 2* 1')
   call hangs('dyad8_tangent_mechanism', '0 1 2* 1*')
   call hangs('actuator_davis_steering', '0 1* 2* 1 2* 1')
   call hangs('actuator_rapson_slide', '0 1* 2* 1')
   call needle_bodies()
   call arc_on_determined_arc()
   call floating_arc()
   do i = 1, size(all_cases)
      call bodies_are_rigid(trim(all_cases(i)))
   end do
   call t%report()

contains

   !> Joints of every kind of dyad, by hand from the drawings of the thesis: name, kind, the two bodies by number (1 frame,
   !> 2 input, then p and q of each loop).
   subroutine known_joints()
      call has('dyad1_crank_rocker', 'IN R1-2 S1 R2-3 M1 R3-4 E1 R1-4')
      call has('suspension', 'IN R1-2 S1 R2-3 M1 R3-4 E1 R1-4')
      call has('dyad2_oscillating_cylinder', 'IN R1-2 S1 R2-3 M1 P3-4 E1 R1-4')
      call has('dyad3_quick_return', 'IN R1-2 S1 R2-3 M1 P3-4 E1 R1-4')
      call has('dyad4_slider_crank', 'IN R1-2 S1 R2-3 M1 R3-4 E1 P1-4')
      call has('dyad5_turning_block', 'IN R1-2 S1 P2-3 M1 R3-4 E1 R1-4')
      call has('dyad6_scotch_yoke', 'IN R1-2 S1 R2-3 M1 P3-4 E1 P1-4')
      call has('dyad7_oldham_coupling', 'IN R1-2 S1 P2-3 M1 P3-4 E1 R1-4')
      call has('dyad8_tangent_mechanism', 'IN R1-2 S1 P2-3 M1 R3-4 E1 P1-4')
      call has('actuator_rapson_slide', 'IN P1-2 S1 R2-3 M1 P3-4 E1 R1-4')
      ! loop 3: from the coupler of loop 1 (bodies 3, 4) to the rocker of loop 2 (bodies 5, 6)
      call has('needle', 'IN R1-2 S1 R2-3 M1 R3-4 E1 R1-4 S2 R2-5 M2 R5-6 E2 R1-6 S3 R5-7 M3 R7-8 E3 R4-8 '// &
               'S4 R7-9 M4 R9-10 E4 R1-10')
   end subroutine known_joints

   !> Links on the way to the frame, its own included, by the shortest way through pins; * through slides, for no pins lead there.
   subroutine hangs(name, wanted)
      character(*), intent(in) :: name, wanted
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(pin_order_t) :: pins
      character(:), allocatable :: words
      integer :: b

      allocate (problem, set)
      call load_case(name, problem, set)
      call order_by_pins(problem%mechanism, pins)
      words = ''
      do b = 1, size(pins%order)
         words = words//' '//to_text(pins%order(b))//trim(merge('*', ' ', pins%adrift(b)))
      end do
      call t%equal_text(words(2:), wanted, 'links on the way to the frame of '//name)
   end subroutine hangs

   subroutine has(name, wanted)
      character(*), intent(in) :: name, wanted
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set

      allocate (problem, set)
      call load_case(name, problem, set)
      call t%equal_text(in_words(problem%mechanism), wanted, 'joints of '//name)
      call t%is_true(all(problem%mechanism%joints%attached), 'the joints of '//name//' are points of both their bodies')
   end subroutine has

   pure function in_words(mechanism) result(words)
      type(mechanism_t), intent(in) :: mechanism
      character(:), allocatable :: words
      integer :: j

      words = ''
      do j = 1, size(mechanism%joints)
         associate (joint => mechanism%joints(j))
            words = words//' '//joint%name//' '//merge('P', 'R', joint%kind == joint_prismatic)//to_text(joint%bodies(1))//'-'// &
                    to_text(joint%bodies(2))
         end associate
      end do
      words = words(2:)
   end function in_words

   !> The ten-bar needle linkage has nine moving links; its ternary links are one body each, however many arcs they have.
   subroutine needle_bodies()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      integer :: b

      allocate (problem, set)
      call load_case('needle', problem, set)
      associate (mechanism => problem%mechanism)
         call t%equal_integer(size(mechanism%bodies), 10, 'bodies of the ten-bar linkage')
         call t%equal_integer(size(mechanism%joints), 13, 'joints of the ten-bar linkage')
         call t%equal_integer(sum([(size(mechanism%bodies(b)%arcs), b=1, 10)]), size(mechanism%arcs), &
                              'every arc of the ten-bar linkage is fixed in one body')
         ! three degrees of freedom for each moving body, two taken by each joint, one left for the crank
         call t%equal_integer(3*(size(mechanism%bodies) - 1) - 2*size(mechanism%joints), 1, 'degree of freedom of the ten-bar')
         call t%equal_text(mechanism%bodies(body_frame)%name, 'frame', 'name of the frame')
         call t%equal_text(mechanism%bodies(2)%name, 'crank', 'name of the crank')
         call t%equal_text(mechanism%bodies(10)%name, 'arc 5 of loop 4', 'name of the last link')
         call t%is_true(mechanism%has_point(body_frame, pivot), 'the input pivot is a point of the frame')
      end associate
   end subroutine needle_bodies

   !> An arc that hangs on a determined arc belongs to the body at the end of the row.
   subroutine arc_on_determined_arc()
      type(mechanism_t) :: mechanism
      type(dimensions_t) :: dimensions

      ! loop 2: coupler arc turned 30 degrees from arc 2 of loop 1; loop 3: 20 degrees more from that arc
      call understand(' &LINKS NLOOP=3, MAXARC=5, ILINK=1,2,3,4,0, 1,-2,3,4,4, 1,-2,3,4,4, ILOOP=1,0,0,1,0, 1,1,0,0,1, '// &
                      '1,2,0,0,1, ARCL=10.0,30.0,30.0,40.0,0.0, 10.0,12.0,40.0,40.0,40.0, 10.0,9.0,40.0,40.0,40.0, '// &
                      'GAMA=3*0.0,180.0,0.0, 0.0,30.0,3*0.0, 0.0,20.0,3*0.0, NOUTLK=2, NOUTLP=1 &END', mechanism, dimensions)
      associate (arc => mechanism%seq(3, 2), coupler => mechanism%arcs(mechanism%seq(1, 2))%body)
         call t%equal_integer(mechanism%arcs(arc)%body, coupler, 'an arc that hangs on a determined arc is of its body')
         call t%close_to(mechanism%angle_on_body(arc, dimensions), 50.0_wp, 1.0e-14_wp, 'its direction there adds up')
         call t%equal_integer(size(mechanism%bodies(coupler)%arcs), 3, 'arcs of that body')
         call t%equal_integer(size(mechanism%bodies(coupler)%points), 4, 'points of that body')
         call t%equal_integer(mechanism%joints(mechanism%groups(3)%joints(1))%bodies(1), coupler, 'who carries the next dyad')
      end associate
      call t%equal_integer(mechanism%loop_of(mechanism%seq(3, 4)), 3, 'loop of an arc')
      call t%equal_integer(mechanism%seq(3, 1), 10, 'arcs are numbered without gaps')
   end subroutine arc_on_determined_arc

   !> An arc that begins at no point of its body is only parallel to it, and the joint at its end is not on that body.
   subroutine floating_arc()
      type(mechanism_t) :: mechanism
      type(dimensions_t) :: dimensions
      integer :: arc

      ! loop 2 goes from the pivot along an arc of the coupler, which is not there
      call understand(' &LINKS NLOOP=2, MAXARC=4, ILINK=1,2,3,4, -2,2,3,4, ILOOP=1,0,0,1, 1,0,0,1, '// &
                      'ARCL=10.0,30.0,30.0,40.0, 12.0,40.0,40.0,40.0, GAMA=3*0.0,180.0, 30.0,3*0.0, '// &
                      'NOUTLK=2, NOUTLP=1 &END', mechanism, dimensions)
      arc = mechanism%seq(2, 1)
      call t%is_true(.not. mechanism%arcs(arc)%attached, 'an arc apart from its body is known')
      call t%equal_integer(mechanism%arcs(arc)%body, mechanism%arcs(mechanism%seq(1, 2))%body, 'it has the direction of its body')
      call t%is_true(.not. mechanism%joints(mechanism%groups(2)%joints(1))%attached, &
                     'a joint at its end is known to hang in the air')
   end subroutine floating_arc

   !> SETUP for the group LINKS of a case.
   subroutine understand(links, mechanism, dimensions)
      character(*), intent(in) :: links
      type(mechanism_t), intent(out) :: mechanism
      type(dimensions_t), intent(out) :: dimensions
      type(data_set_t), allocatable :: sets(:)
      type(parameters_t) :: parameters
      type(diagnostics_t) :: findings
      character(*), parameter :: file = 'build/test_bodies.nml'
      integer :: unit

      open (newunit=unit, file=file, access='stream', form='unformatted', status='replace')
      write (unit) 'TEST'//nl//links//nl//' &METHOD MOTION=1, NDES=1, DELT=60.0 &END'//nl//' &LIMITS TANGLE=90.0 &END'//nl
      close (unit)
      call read_data_sets(file, sets, findings)
      if (.not. findings%failed()) call set_up(sets(1), mechanism, dimensions, parameters, findings)
      if (findings%failed()) error stop 'a linkage of the tests cannot be read'
   end subroutine understand

   !> In motion the points of a body keep their distances, and its arcs keep their angles to its axis.
   subroutine bodies_are_rigid(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      real(wp), allocatable :: x(:, :), y(:, :), turned(:, :)
      real(wp) :: worst, off, size_of
      integer :: n, b, k, j

      allocate (problem, set)
      call load_case(name, problem, set, everything=.true.)
      call problem%bind(problem%given)
      call find_places(problem, x, y, turned)
      n = size(x, 2)
      size_of = maxval(abs(x)) + maxval(abs(y))
      worst = 0.0_wp
      off = 0.0_wp
      associate (mechanism => problem%mechanism)
         do b = 1, size(mechanism%bodies)
            associate (points => mechanism%bodies(b)%points, arcs => mechanism%bodies(b)%arcs)
               do k = 2, size(points)
                  do j = 1, k - 1
                     worst = max(worst, spread_of(hypot(x(points(k), :) - x(points(j), :), y(points(k), :) - y(points(j), :))))
                  end do
               end do
               do k = 1, size(arcs)
                  off = max(off, maxval(abs(turned(arcs(k), :))))
               end do
            end associate
         end do
      end associate
      call t%close_to(worst/size_of, 0.0_wp, 1.0e3_wp*epsilon(1.0_wp), 'the points of a body keep their distances, '//name)
      call t%close_to(off, 0.0_wp, 1.0e4_wp*epsilon(1.0_wp), 'the arcs of a body keep their angles, '//name)
   end subroutine bodies_are_rigid

   pure real(wp) function spread_of(values)
      real(wp), intent(in) :: values(:)

      spread_of = maxval(values) - minval(values)
   end function spread_of

   !> Points at every position, and the sine of the angle between every arc and its body's axis, less what it ought to be.
   subroutine find_places(problem, x, y, turned)
      type(problem_t), intent(inout) :: problem
      real(wp), allocatable, intent(out) :: x(:, :), y(:, :)   !! shape (points, positions)
      real(wp), allocatable, intent(out) :: turned(:, :)       !! shape (arcs, positions)
      real(wp), parameter :: radian = atan(1.0_wp)/45.0_wp
      real(wp) :: c, s, length, ax, ay, angle
      integer :: block, offset, n, i, k

      associate (mechanism => problem%mechanism, linkage => problem%linkage)
         allocate (x(size(mechanism%points), problem%positions), source=0.0_wp)
         y = x
         allocate (turned(size(mechanism%arcs), problem%positions))
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, n)
            do i = 1, n
               do k = 2, size(mechanism%points)
                  associate (point => mechanism%points(k))
                     call linkage%arc_at(problem%plan, point%arc, i, c, s, length)
                     x(k, offset + i) = x(point%from, offset + i) + real(point%sense, wp)*length*c
                     y(k, offset + i) = y(point%from, offset + i) + real(point%sense, wp)*length*s
                  end associate
               end do
               do k = 1, size(mechanism%arcs)
                  associate (axis => mechanism%bodies(mechanism%arcs(k)%body)%axis)
                     ax = 1.0_wp
                     ay = 0.0_wp
                     if (axis > 0) call linkage%arc_at(problem%plan, axis, i, ax, ay, length)
                     call linkage%arc_at(problem%plan, k, i, c, s, length)
                     angle = radian*mechanism%angle_on_body(k, problem%given)
                     turned(k, offset + i) = (ax*s - ay*c)*cos(angle) - (ax*c + ay*s)*sin(angle)
                  end associate
               end do
            end do
         end do
      end associate
   end subroutine find_places
end program test_bodies
