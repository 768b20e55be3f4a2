!> A mechanism whose drives, or some of them, move freely: their accelerations from what acts on its links.
!>
!> Co-ordinates are the drives that follow no other. With the rates of the poses for each free one alone (Y) the equations are
!> Y'M Y q'' = Y'(F - M g0), where g0 are the accelerations at q'' = 0. The right side is what the free drives would have to bear at
!> q'' = 0, a column of the matrix what they bear for the inertia at q'' = 1 of one of them: a sweep of the forces each.
!> A joint that rests on its stop adds the equation that its acceleration is 0, and the force of the stop as an unknown.
!> Where other drives have taken the place of those of the case (`watched`), theirs are joints like those with stops, without any.
!> Beside a change point (`passing`) positions are those of the smooth motion through it, and what the free drive bears is the power
!> of all that acts, for the sweeps lose digits there.
module psalm_free_motion
   use psalm_change_point, only: change_point_t, drive_path_t, find_change_point, pivots_of
   use psalm_error, only: problem_t
   use psalm_force_analysis, only: column_drive, column_of_other_drive, columns_of, take_columns
   use psalm_force_model, only: force_model_t, load_t, spring_t
   use psalm_friction_forces, only: find_friction, load_of_joint
   use psalm_joint_stops, only: joint_stop_t, place_at, rate_at, press, side_none
   use psalm_kinds, only: wp, pi, degrees_per_radian, radians_per_degree, full_turn
   use psalm_kinetostatics, only: forces_t, prepare_forces, move_bodies, clear_wrenches, add_source, sweep, external_power, &
                                  friction_parts, &
                                  sources_of, source_inertia, source_weight
   use psalm_linear, only: solve_positive
   use psalm_motor_group, only: motor_group_t
   use psalm_potential, only: potential_energy, stretch_of, torsion
   use psalm_rates, only: rates_t, prepare_rates, differentiate
   use psalm_shown_input, only: input_at, reference_input
   use psalm_spring_law, only: part_elastic, part_viscous
   implicit none (type, external)
   private
   public :: free_motion_t, free_state_t, make_free_motion

   integer, parameter :: orders = 2        !! of rates
   integer, parameter :: most_rounds = 60  !! of friction, which depends on the forces that it changes, by turns
   integer, parameter :: most_shared = 1000 !! where joints at rest share what they hold
   real(wp), parameter :: settled = 4.0_wp*epsilon(1.0_wp) !! part of the largest friction: a change that is none
   real(wp), parameter :: rounded = 1.0e-11_wp !! and one that may be rounding, if it grows
   real(wp), parameter :: least_inertia = 1.0e-12_wp !! what others leave of the inertia at a drive, as a part of it: less is 0
   real(wp), parameter :: same_motion = 1.0e-9_wp    !! what other stops leave of a motion, as a part of it: less is 0

   !> What moves, and how its drives go. Inputs are increments from the reference position, radians or user's lengths.
   type :: free_motion_t
      class(problem_t), allocatable :: problem         !! bound, at one position; large: it would fill a small stack
      type(force_model_t) :: model
      type(force_model_t) :: lasting, loads, dampers   !! parts of it: weight and springs, loads, dampers
      type(motor_group_t) :: motor                     !! on the first drive
      logical :: driven = .false.                      !! there is a motor
      logical :: switched_on = .true.                  !! it has its torque
      logical, allocatable :: slides(:)                !! by drive
      integer, allocatable :: leader(:)                !! by drive: the drive that it follows, mostly itself
      real(wp), allocatable :: ratio(:)                !! by drive: its rate by that one's
      integer, allocatable :: free(:)                  !! the drives that move freely
      real(wp), allocatable :: start(:)                !! by drive: input at time 0,
      real(wp), allocatable :: speed(:), accel(:)      !! and of those that are not free how it goes on
      type(rates_t), allocatable :: rates
      type(forces_t), allocatable :: forces
      logical, allocatable :: side(:)                  !! by loop: two slides of it are on the positive side of each other at time 0
      integer :: open_loop = 0                         !! why the last evaluation has no result: this loop does not close,
      logical :: massless = .false.                    !! or some motion of the free drives moves no mass
      integer :: jammed = 0                            !! or friction of this stop, a joint, has no force that agrees with its load
      ! friction: joints of some stops, without limits; others have none
      integer :: smooth = 0                            !! so many stops come before them, drives that are watched after them
      logical, allocatable :: stuck(:)                 !! by stop: its joint is held by friction,
      real(wp), allocatable :: sense_of_slip(:)        !! or slips this way, 1 or -1
      real(wp), allocatable :: stuck_at(:)             !! by stop: place there
      real(wp), allocatable :: rest_coefficient(:)     !! by joint with friction: at rest
      logical, allocatable :: engaged(:)               !! by joint with friction: it acts
      real(wp), allocatable :: parts(:, :)             !! shape (2, joints with friction): what their friction grows with
      real(wp), allocatable :: most_held(:)            !! by stop: friction at rest holds so much, N m, N times metre
      real(wp) :: level = 0.0_wp                       !! J: added to the potential energy, whose zero is that of the input pivot
      integer :: wound = 0                             !! a torsional spring that was turned past half a turn of SFREE, 0: none
      integer, allocatable :: kinked(:)                !! springs whose pull has kinks over their length
      real(wp), allocatable :: stretch(:)              !! by one of them: length less the free one, metres, or angle, radians
      integer :: closed = 0                            !! a gas spring that has no room left, 0: none
      real(wp), allocatable :: turned(:)               !! by spring, torsional: from SFREE where `anchor` saw it last, radians
      type(joint_stop_t), allocatable :: stops(:)
      integer, allocatable :: resting(:)               !! by stop: side on which its joint rests, `side_...`
      ! by stop, at the last evaluation: from time 0, radians or user's lengths, and by time
      real(wp), allocatable :: place(:), pace(:), growth(:) !! where its joint is, its rate, its acceleration
      real(wp), allocatable :: freely(:)               !! what its acceleration is made of where nothing holds it, without signs
      real(wp), allocatable :: push(:)                 !! force of the stop, forwards: N m, N times metre
      real(wp), allocatable :: normal(:, :)            !! shape (stops, drives): rate of the joint for a drive's rate 1
      real(wp), allocatable :: acting(:)               !! by free drive: force on it, N m, N times metre
      real(wp), allocatable :: inertia(:, :)           !! shape (drives, free drives): what drives bear for q'' = 1
      real(wp), allocatable :: anchored(:)             !! by stop: its place where `anchor` was last
      integer :: watched = 0                           !! the stop that stands for the first drive of the case, which others follow;
                                                       !! 0: the drives are those of the case
      real(wp), allocatable :: sense(:)                !! by drive of the case, if watched: its rate by that of its joint
      real(wp) :: reference = 0.0_wp                   !! if watched: input of the first drive at time 0, degrees or length
      logical :: turning = .false.                     !! if watched: that drive turns
      type(change_point_t), allocatable :: passing     !! the change point that was found last
      integer :: passages = 0                          !! how many were found
      real(wp) :: at = 0.0_wp                          !! the free drive, if there is one, at the last evaluation
   contains
      procedure :: accelerate
      procedure :: describe
      procedure :: anchor
      procedure :: loosen
      procedure :: rates_of
      procedure :: rate_for
      procedure :: first_input
      procedure :: motor_speed
      procedure :: rubs
      procedure :: beside_change
      procedure :: may_change
      procedure :: pivots
      procedure :: find_change
      procedure :: is_rough
      procedure :: note_kinks
      procedure, private :: table_input
      procedure, private :: put_normal
      procedure, private :: put_inputs
      procedure, private :: put_rates
      procedure, private :: drive_loads
      procedure, private :: loads_by_power
   end type free_motion_t

   !> Everything about one moment.
   type :: free_state_t
      real(wp), allocatable :: input(:), rate(:), accel(:) !! by drive: increments, radians or lengths, and by time
      real(wp), allocatable :: begun(:)                !! by drive: input at time 0
      real(wp), allocatable :: named(:, :)             !! shape (drives, 0:2): if watched those of the case, from time 0
      real(wp) :: motor = 0.0_wp                       !! if watched: torque of the motor less what its flywheel takes up, N m
      real(wp), allocatable :: columns(:)              !! as `force_table_t` has them
      integer :: motor_drive = 1
      real(wp) :: kinetic = 0.0_wp, growth = 0.0_wp    !! J, W; flywheel included
      real(wp) :: potential = 0.0_wp                   !! of weight and springs, J
      real(wp), allocatable :: stops(:)                !! by stop: its force forwards, N m or N
      integer :: undetermined = 0                      !! this loop is at a change point: forces of joints are not determined there
   end type free_state_t

contains

   !> Bind a mechanism whose problem has all loops, roots and vertices (`vertices_of`) and one position.
   subroutine make_free_motion(problem, model, motor, free, start, speed, accel, stops, motion, time, at_rest, smooth)
      class(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(motor_group_t), intent(in) :: motor
      logical, intent(in) :: free(:)                    !! by drive; of those that follow the first without meaning
      real(wp), intent(in) :: start(:), speed(:), accel(:) !! by drive
      type(joint_stop_t), intent(in) :: stops(:)
      class(free_motion_t), intent(out) :: motion
      real(wp), intent(in), optional :: at_rest(:)      !! coefficients of friction at rest
      integer, intent(in), optional :: smooth           !! of the stops that come after so many
      real(wp), intent(in), optional :: time            !! where the free drives are at `start`; 0 if absent
      real(wp) :: now
      integer :: d, k

      allocate (motion%problem, source=problem)
      motion%model = model
      motion%motor = motor
      motion%driven = motor%given
      call motion%note_kinks()
      motion%lasting = model
      motion%lasting%loads = [load_t ::]
      motion%lasting%springs%part = part_elastic
      motion%loads = model
      motion%loads%gravity = 0.0_wp
      motion%loads%springs = [spring_t ::]
      motion%dampers = motion%loads
      motion%dampers%loads = [load_t ::]
      motion%dampers%springs = pack(model%springs, model%springs%damps())
      motion%dampers%springs%part = part_viscous
      associate (actuators => problem%mechanism%actuators)
         motion%slides = actuators%slides
         motion%leader = [(d, d=1, size(actuators))]
         allocate (motion%ratio(size(actuators)), source=1.0_wp)
         do d = 2, size(actuators)
            if (.not. actuators(d)%geared) cycle
            motion%leader(d) = 1
            ! ratios are of degrees and lengths
            motion%ratio(d) = actuators(d)%ratio*merge(1.0_wp, degrees_per_radian, actuators(1)%slides)* &
                              merge(1.0_wp, radians_per_degree, actuators(d)%slides)
         end do
         motion%free = pack([(d, d=1, size(actuators))], free .and. .not. actuators%geared)
      end associate
      motion%start = start
      motion%speed = speed
      motion%accel = accel
      allocate (motion%rates, motion%forces)
      call prepare_rates(motion%problem, motion%rates)
      call prepare_forces(motion%problem, model, motion%forces)
      allocate (motion%side(problem%mechanism%nloop), source=.true.)
      now = 0.0_wp
      if (present(time)) now = time
      call motion%put_inputs(now, start(motion%free), .false.)
      do k = 1, size(motion%side)
         motion%side(k) = motion%problem%linkage%store%v(1, motion%problem%linkage%measure(k)) > 0.0_wp
      end do
      motion%stops = stops
      allocate (motion%resting(size(stops)), source=side_none)
      motion%smooth = size(stops)
      allocate (motion%stuck(size(stops)), source=.false.)
      allocate (motion%sense_of_slip(size(stops)), source=1.0_wp)
      allocate (motion%stuck_at(size(stops)), motion%most_held(size(stops)), source=0.0_wp)
      allocate (motion%rest_coefficient(0), motion%engaged(0), motion%parts(2, 0))
      if (present(at_rest)) then
         motion%rest_coefficient = at_rest
         motion%parts = 0.0_wp*spread(at_rest, 1, 2)
         motion%engaged = spread(.true., 1, size(at_rest))
         motion%smooth = smooth
      end if
      allocate (motion%place(size(stops)), motion%pace(size(stops)), motion%growth(size(stops)), motion%freely(size(stops)), &
                motion%push(size(stops)), motion%anchored(size(stops)), source=0.0_wp)
      allocate (motion%acting(size(motion%free)), source=0.0_wp)
      allocate (motion%normal(size(stops), size(start)), source=0.0_wp)
      allocate (motion%inertia(size(start), size(motion%free)), source=0.0_wp)
      call motion%put_rates(0.0_wp*start, 0.0_wp*start)
      do k = 1, size(stops)
         motion%stops(k)%zero = place_at(motion%problem, motion%forces, stops(k), 0.0_wp)
      end do
   end subroutine make_free_motion

   !> Which springs of the model have kinks.
   pure subroutine note_kinks(self)
      class(free_motion_t), intent(inout) :: self
      integer :: k

      associate (springs => self%model%springs)
         self%kinked = pack([(k, k=1, size(springs))], [(size(springs(k)%kinks(self%model%metre)) > 0, k=1, size(springs))])
      end associate
      self%stretch = [(0.0_wp, k=1, size(self%kinked))]
   end subroutine note_kinks

   !> Accelerations of the free drives, what loads, motor and the drives that are not free put in, and what dampers take out.
   !> `valid` is false where a loop does not close (`open_loop`), or nothing has mass (`massless`).
   subroutine accelerate(self, time, q, v, a, work, loss, valid)
      use psalm_machine, only: motor_torque
      class(free_motion_t), intent(inout) :: self
      real(wp), intent(in) :: time, q(:), v(:)          !! shape (free drives): radians or lengths, and by time
      real(wp), intent(out) :: a(:)
      real(wp), intent(out) :: work, loss               !! W
      logical, intent(out) :: valid
      real(wp) :: b(size(self%slides)), rate(size(self%slides)), accel(size(self%slides)), torque, speed
      real(wp) :: unused
      ! as many as there are joints with friction; flang 19 takes no call of `rubs` here
      real(wp) :: by_accel(2, size(self%rest_coefficient), size(q)), by_push(2, size(self%rest_coefficient), size(self%stops))
      real(wp) :: at_first(2, size(self%rest_coefficient))
      integer :: j, k, source

      a = 0.0_wp
      work = 0.0_wp
      loss = 0.0_wp
      call self%put_inputs(time, q, .true., valid)
      if (.not. valid) return
      self%jammed = 0
      self%loads%time = time
      self%model%time = time
      associate (problem => self%problem, forces => self%forces, h => self%inertia)
         do j = 1, size(self%slides)
            if (.not. any(self%free == j)) call self%put_normal(j)
         end do
         do j = 1, size(q)
            call self%put_normal(self%free(j))
            call clear_wrenches(1, forces)
            call add_source(problem, self%model, source_inertia, [real(wp) ::], 1, forces)
            if (self%beside_change()) then
               h(:, j) = self%loads_by_power()
               cycle
            end if
            call sweep(problem, 1, forces)
            h(:, j) = self%drive_loads()
            do k = 1, self%rubs()
               call friction_parts(problem, self%model, k, forces, by_accel(:, k, j))
            end do
         end do
         if (self%rubs() > 0) then
            do j = 1, size(self%stops)
               by_push(:, :, j) = 0.0_wp
               if (.not. self%is_rough(j) .and. self%resting(j) == side_none) cycle
               call clear_wrenches(1, forces)
               call press(problem, self%model, self%stops(j), 1.0_wp/merge(self%model%metre, 1.0_wp, self%stops(j)%slides), forces)
               call sweep(problem, 1, forces)
               do k = 1, self%rubs()
                  call friction_parts(problem, self%model, k, forces, by_push(:, k, j))
               end do
            end do
         end if
         rate = self%speed + self%accel*time
         accel = self%accel
         rate(self%free) = v
         accel(self%free) = 0.0_wp
         call self%put_rates(rate, accel)
         do k = 1, size(self%stops)
            self%place(k) = place_at(problem, forces, self%stops(k), self%anchored(k) + self%stops(k)%zero) - self%stops(k)%zero
            self%pace(k) = rate_at(problem, self%rates, forces, self%stops(k), 1)
            self%growth(k) = rate_at(problem, self%rates, forces, self%stops(k), 2)
         end do
         do k = 1, size(self%kinked)
            self%stretch(k) = stretch_of(problem, self%model, self%model%springs(self%kinked(k)), forces)
         end do
         call clear_wrenches(1, forces)
         associate (input => [self%table_input(time, q)])
            do source = source_weight + 1, sources_of(self%dampers)
               call add_source(problem, self%dampers, source, input, 1, forces)
            end do
            call external_power(problem, 1, forces)
            loss = -forces%w%v(1, forces%power)
            forces%w%v(:, forces%power) = 0.0_wp
            do source = source_weight + 1, sources_of(self%loads)
               call add_source(problem, self%loads, source, input, 1, forces)
            end do
            call external_power(problem, 1, forces)
            work = forces%w%v(1, forces%power) + loss
            do source = source_weight, sources_of(self%lasting)
               call add_source(problem, self%lasting, source, input, 1, forces)
            end do
            call add_source(problem, self%model, source_inertia, input, 1, forces)
         end associate
         if (self%beside_change()) then
            b = self%loads_by_power()
         else
            call sweep(problem, 1, forces)
            b = self%drive_loads()
         end if
         do k = 1, self%rubs()
            call friction_parts(problem, self%model, k, forces, at_first(:, k))
         end do
      end associate
      torque = 0.0_wp
      if (self%driven) then
         if (self%watched == 0) then
            associate (d => self%motor%drive)
               if (self%switched_on) call motor_torque(self%motor, rate(d), torque, unused)
               b(d) = b(d) - torque
               do j = 1, size(q)
                  if (self%free(j) == d) self%inertia(d, j) = self%inertia(d, j) + self%motor%flywheel
               end do
               work = work + torque*rate(d)
            end associate
         else
            k = self%watched + self%motor%drive - 1
            speed = self%sense(self%motor%drive)*self%pace(k)
            if (self%switched_on) call motor_torque(self%motor, speed, torque, unused)
            work = work + torque*speed
            b = b - (self%sense(self%motor%drive)*torque - self%motor%flywheel*self%growth(k))*self%normal(k, :)
            do j = 1, size(q)
               self%inertia(:, j) = self%inertia(:, j) + self%motor%flywheel*self%normal(k, self%free(j))*self%normal(k, :)
            end do
         end if
      end if
      self%push = 0.0_wp
      self%acting = -b(self%free)
      if (size(q) > 0) then
         call solve_positive(self%inertia(self%free, :), -b(self%free), a, valid, least_inertia)
         self%massless = .not. valid
         if (.not. valid) return
         do k = 1, size(self%stops)
            self%freely(k) = abs(self%growth(k))
            do j = 1, size(q)
               self%freely(k) = self%freely(k) + abs(self%normal(k, self%free(j))*a(j))
            end do
         end do
         if (self%rubs() > 0) then
            call rub(valid)
            if (.not. valid) return
         else if (any(self%resting /= side_none)) then
            call hold()
         end if
      end if
      do j = 1, size(q)
         b = b + self%inertia(:, j)*a(j)
      end do
      do k = 1, size(self%stops)
         b = b - self%push(k)*self%normal(k, :)
         self%growth(k) = self%growth(k) + dot_product(self%normal(k, self%free), a)
      end do
      b(self%free) = 0.0_wp
      where (self%leader /= [(j, j=1, size(b))]) b = 0.0_wp
      work = work + sum(b*rate)

   contains

      !> Friction and what holds joints: each depends on the other, so that the forces are found by turns; where these do not come
      !> to an end soon, by following friction from none to all of it.
      subroutine rub(settles)
         logical, intent(out) :: settles
         real(wp) :: free_accel(size(a)), before(size(self%stops)), change, change_before, largest
         integer :: round, most, e

         free_accel = a
         settles = .false.
         self%most_held = 0.0_wp
         change_before = huge(change)
         most = most_rounds
         if (all(self%stuck(self%smooth + 1:self%smooth + self%rubs()))) most = most_shared
         do round = 1, most
            before = self%push
            call bear(free_accel)
            do e = 1, self%rubs()
               k = self%smooth + e
               if (.not. self%stuck(k)) self%push(k) = slipping(e)*load_of(e) + gripping(e)
            end do
            change = maxval(abs(self%push - before))
            largest = maxval(abs(self%push))
            settles = change <= settled*largest .or. (change <= rounded*largest .and. change >= change_before)
            if (settles) exit
            change_before = change
         end do
         if (.not. settles) call follow(free_accel, settles)
         if (settles) then
            do e = 1, self%rubs()
               k = self%smooth + e
               if (.not. self%stuck(k)) loss = loss - self%push(k)*self%pace(k)
            end do
         else
            self%jammed = maxloc(abs(self%push - before), dim=1)
         end if
      end subroutine rub

      !> With the friction of joints that slip: accelerations, what is held, the loads of all joints and what they could hold.
      subroutine bear(free_accel)
         real(wp), intent(in) :: free_accel(:)
         integer :: e

         a = free_accel
         do k = self%smooth + 1, self%smooth + self%rubs()
            if (.not. self%stuck(k)) a = a + self%loosen(k)*self%push(k)
         end do
         call hold()
         self%parts = at_first
         do j = 1, size(a)
            self%parts = self%parts + a(j)*by_accel(:, :, j)
         end do
         do j = 1, size(self%stops)
            self%parts = self%parts + self%push(j)*by_push(:, :, j)
         end do
         do e = 1, self%rubs()
            self%most_held(self%smooth + e) = 0.0_wp
            if (self%engaged(e)) self%most_held(self%smooth + e) = self%rest_coefficient(e)*load_of(e) + grip_of(e)
         end do
      end subroutine bear

      !> The friction of joints that slip: what they bear is linear in it.
      subroutine follow(free_accel, found)
         real(wp), intent(in) :: free_accel(:)
         logical, intent(out) :: found
         integer :: slips(size(self%rest_coefficient)), n, i, e
         real(wp) :: fixed(2, size(self%rest_coefficient)), by_force(2, size(self%rest_coefficient), size(self%rest_coefficient))
         real(wp) :: coefficient(size(self%rest_coefficient)), force(size(self%rest_coefficient))
         real(wp) :: grip(size(self%rest_coefficient)), largest

         n = 0
         do e = 1, self%rubs()
            if (self%stuck(self%smooth + e)) cycle
            n = n + 1
            slips(n) = e
         end do
         found = n > 0
         if (.not. found) return
         associate (own => self%smooth + slips(:n))
            self%push(own) = 0.0_wp
            call bear(free_accel)
            fixed = self%parts
            largest = 0.0_wp
            do i = 1, n
               coefficient(i) = slipping(slips(i))*merge(self%model%metre, 1.0_wp, self%stops(own(i))%slides)
               grip(i) = gripping(slips(i))
               largest = max(largest, abs(slipping(slips(i))*load_of(slips(i))), abs(grip(i)))
            end do
            if (.not. largest > 0.0_wp) largest = 1.0_wp
            do i = 1, n
               self%push(own) = 0.0_wp
               self%push(own(i)) = largest
               call bear(free_accel)
               by_force(:, :, i) = (self%parts - fixed)/largest
            end do
            call find_friction(fixed(:, slips(:n)), by_force(:, slips(:n), :n), self%stops(own)%slides, coefficient(:n), &
                               grip(:n), force(:n), found)
            self%push(own) = force(:n)
         end associate
         if (found) call bear(free_accel)
      end subroutine follow

      !> What friction is a part of: N m of a pin, N times metre of a slide.
      pure real(wp) function load_of(entry)
         integer, intent(in) :: entry

         associate (slides => self%stops(self%smooth + entry)%slides)
            load_of = load_of_joint(self%parts(:, entry), slides)*merge(self%model%metre, 1.0_wp, slides)
         end associate
      end function load_of

      !> Friction of a joint that slips by that.
      pure real(wp) function slipping(entry)
         integer, intent(in) :: entry

         slipping = 0.0_wp
         if (self%engaged(entry)) slipping = -self%sense_of_slip(self%smooth + entry)*self%model%friction(entry)%coefficient
      end function slipping

      !> What it has whatever its load is: N m, N times metre.
      pure real(wp) function grip_of(entry)
         integer, intent(in) :: entry

         grip_of = self%model%friction(entry)%grip*merge(self%model%metre, 1.0_wp, self%stops(self%smooth + entry)%slides)
      end function grip_of

      !> The same against its slip.
      pure real(wp) function gripping(entry)
         integer, intent(in) :: entry

         gripping = 0.0_wp
         if (self%engaged(entry)) gripping = -self%sense_of_slip(self%smooth + entry)*grip_of(entry)
      end function gripping

      !> Joints that rest on their stops, or are stuck, do not accelerate. Of those that hold the same motion the first bears it; of
      !> one free drive all joints that are stuck bear it by what they can hold.
      subroutine hold()
         integer :: held(size(self%resting)), n, i
         real(wp) :: borne, most

         n = 0
         do k = 1, size(self%resting)
            if (self%stuck(k)) self%push(k) = 0.0_wp
            if (self%resting(k) == side_none .and. .not. self%stuck(k)) cycle
            n = n + 1
            held(n) = k
            if (.not. all_pressed(held(:n))) n = n - 1
         end do
         do i = 1, n
            a = a + self%loosen(held(i))*self%push(held(i))
         end do
         if (n /= 1 .or. size(a) /= 1 .or. count(self%stuck) < 2) return
         associate (one => held(1), along => self%normal(:, self%free(1)))
            most = sum(self%most_held*abs(along), mask=self%stuck)
            if (.not. (self%stuck(one) .and. most > 0.0_wp)) return
            borne = self%push(one)*along(one)/most
            where (self%stuck) self%push = borne*sign(self%most_held, along)
         end associate
      end subroutine hold

      !> Forces of these stops. False: some of them hold the same motion.
      logical function all_pressed(held) result(pressed)
         integer, intent(in) :: held(:)
         real(wp) :: compliance(size(held), size(held)), force(size(held)), missing(size(held)), loosened(size(a))
         integer :: i, j

         do i = 1, size(held)
            loosened = self%loosen(held(i))
            do j = 1, size(held)
               compliance(j, i) = dot_product(self%normal(held(j), self%free), loosened)
            end do
            missing(i) = -self%growth(held(i)) - dot_product(self%normal(held(i), self%free), a)
         end do
         call solve_positive(compliance, missing, force, pressed, same_motion)
         if (pressed) self%push(held) = force
      end function all_pressed
   end subroutine accelerate

   !> True if the last evaluation was so near a change point that the smooth motion through it took the place of closed forms.
   pure logical function beside_change(self)
      class(free_motion_t), intent(in) :: self

      beside_change = .false.
      if (allocated(self%passing)) beside_change = self%passing%holds(self%at)
   end function beside_change

   !> True if change points are looked for: one free drive, the others at rest, dyads alone, no friction of joints.
   pure logical function may_change(self)
      class(free_motion_t), intent(in) :: self
      integer :: k

      may_change = size(self%free) == 1 .and. self%rubs() == 0
      if (.not. may_change) return
      do k = 1, size(self%slides)
         if (k == self%free(1) .or. self%leader(k) /= k) cycle
         may_change = may_change .and. .not. (abs(self%speed(k)) > 0.0_wp .or. abs(self%accel(k)) > 0.0_wp)
      end do
      do k = 1, size(self%problem%linkage%steps)
         may_change = may_change .and. .not. allocated(self%problem%linkage%steps(k)%dyad%higher)
      end do
   end function may_change

   !> Sines of the dyads at the last evaluation, which go through 0 at change points.
   function pivots(self)
      class(free_motion_t), intent(in) :: self
      real(wp), allocatable :: pivots(:)

      pivots = pivots_of(self%problem, self%rates)
   end function pivots

   !> Look for a change point where the dyad of a loop may come into line. The position is lost.
   subroutine find_change(self, loop, expected, direction, size_of, found, open)
      class(free_motion_t), intent(inout) :: self
      integer, intent(in) :: loop
      real(wp), intent(in) :: expected, direction       !! of the free drive
      real(wp), intent(in) :: size_of                   !! what its changes count by
      logical, intent(out) :: found, open               !! as `find_change_point` has them
      type(change_point_t), allocatable :: point
      type(drive_path_t) :: path
      integer :: d

      allocate (point)
      path%slides = self%slides
      path%size = size_of
      path%base = self%start
      path%slope = 0.0_wp*self%start
      do d = 1, size(self%slides)
         if (self%leader(d) /= self%free(1)) cycle
         path%slope(d) = self%ratio(d)
         path%base(d) = self%start(d) - self%ratio(d)*self%start(self%free(1))
      end do
      path%base(self%free(1)) = 0.0_wp
      call find_change_point(self%problem, self%rates, path, expected, direction, loop, point, found, open)
      if (.not. found) return
      call move_alloc(point, self%passing)
      self%passages = self%passages + 1
   end subroutine find_change

   !> What the free drive bears for what acts on the bodies, beside a change point: the power of that for its rate 1, turned round.
   function loads_by_power(self) result(load)
      class(free_motion_t), intent(inout) :: self
      real(wp) :: load(size(self%slides))
      real(wp) :: rate(size(self%slides))

      rate = 0.0_wp
      rate(self%free(1)) = 1.0_wp
      call self%put_rates(rate, 0.0_wp*rate)
      self%forces%w%v(:, self%forces%power) = 0.0_wp
      call external_power(self%problem, 1, self%forces)
      load = 0.0_wp
      load(self%free(1)) = -self%forces%w%v(1, self%forces%power)
   end function loads_by_power

   !> How many joints have friction.
   pure integer function rubs(self)
      class(free_motion_t), intent(in) :: self

      rubs = size(self%rest_coefficient)
   end function rubs

   !> True of a stop that is a joint with friction.
   pure logical function is_rough(self, stop)
      class(free_motion_t), intent(in) :: self
      integer, intent(in) :: stop

      is_rough = stop > self%smooth .and. stop <= self%smooth + self%rubs()
   end function is_rough

   !> Accelerations of the free drives for a force 1 of a stop, at the last evaluation.
   pure function loosen(self, stop) result(a)
      class(free_motion_t), intent(in) :: self
      integer, intent(in) :: stop
      real(wp) :: a(size(self%free))
      logical :: unused

      call solve_positive(self%inertia(self%free, :), self%normal(stop, self%free), a, unused)
   end function loosen

   !> Rates of joints for each free drive alone at rate 1, at the last evaluation. Accelerations of bodies are lost.
   subroutine rates_of(self, joints, rates)
      class(free_motion_t), intent(inout) :: self
      type(joint_stop_t), intent(in) :: joints(:)
      real(wp), intent(out) :: rates(:, :)              !! shape (joints, free drives): radians or user's lengths
      real(wp) :: accel(size(self%slides))
      integer :: j, k

      do j = 1, size(self%free)
         accel = 0.0_wp
         accel(self%free(j)) = 1.0_wp
         call self%put_rates(0.0_wp*accel, accel)
         do k = 1, size(joints)
            rates(k, j) = rate_at(self%problem, self%rates, self%forces, joints(k), 2)
         end do
      end do
   end subroutine rates_of

   !> Rate of a joint for one drive alone at rate 1, likewise.
   real(wp) function rate_for(self, drive, joint)
      class(free_motion_t), intent(inout) :: self
      integer, intent(in) :: drive
      type(joint_stop_t), intent(in) :: joint
      real(wp) :: accel(size(self%slides))

      accel = 0.0_wp
      accel(drive) = 1.0_wp
      call self%put_rates(0.0_wp*accel, accel)
      rate_for = rate_at(self%problem, self%rates, self%forces, joint, 2)
   end function rate_for

   !> Input of the first drive as tables of loads have it: degrees or user's length.
   pure real(wp) function table_input(self, time, q)
      class(free_motion_t), intent(in) :: self
      real(wp), intent(in) :: time, q(:)                !! shape (free drives)

      if (self%watched == 0) then
         table_input = input_at(self%problem%mechanism, self%problem%given, self%problem%delt(1))
         return
      end if
      table_input = self%first_input(time, q)
      if (.not. self%turning .or. size(self%model%table_input) == 0) return
      associate (first => self%model%table_input(1))
         table_input = first + modulo(table_input - first, full_turn)
      end associate
   end function table_input

   !> Input of the first drive as tables of loads count it, but not within a turn: degrees or user's length.
   pure real(wp) function first_input(self, time, q)
      class(free_motion_t), intent(in) :: self
      real(wp), intent(in) :: time, q(:)                !! shape (free drives)
      real(wp) :: input(size(self%slides))

      if (self%watched > 0) then
         first_input = self%reference + self%sense(1)*self%place(self%watched)*merge(degrees_per_radian, 1.0_wp, self%turning)
         return
      end if
      input = self%start + time*(self%speed + 0.5_wp*self%accel*time)
      input(self%free) = q
      first_input = reference_input(self%problem%mechanism, self%problem%given) + &
                    input(1)*merge(1.0_wp, degrees_per_radian, self%slides(1))
   end function first_input

   !> Speed of the drive that the motor turns: rad/s or user's lengths/s.
   pure real(wp) function motor_speed(self, time, v)
      class(free_motion_t), intent(in) :: self
      real(wp), intent(in) :: time, v(:)                !! shape (at least the free drives)
      real(wp) :: rate(size(self%slides))

      if (self%watched > 0) then
         motor_speed = self%sense(self%motor%drive)*self%pace(self%watched + self%motor%drive - 1)
         return
      end if
      rate = self%speed + self%accel*time
      rate(self%free) = v(:size(self%free))
      motor_speed = rate(self%motor%drive)
   end function motor_speed

   !> Put the rate 0 and the acceleration 1 of one drive in; rates of joints with stops for it.
   subroutine put_normal(self, drive)
      class(free_motion_t), intent(inout) :: self
      integer, intent(in) :: drive
      real(wp) :: accel(size(self%slides))
      integer :: k

      if (self%leader(drive) /= drive) return
      if (size(self%stops) == 0 .and. .not. any(self%free == drive)) return
      accel = 0.0_wp
      accel(drive) = 1.0_wp
      call self%put_rates(0.0_wp*accel, accel)
      do k = 1, size(self%stops)
         self%normal(k, drive) = rate_at(self%problem, self%rates, self%forces, self%stops(k), 2)
      end do
   end subroutine put_normal

   !> Everything at a moment, with accelerations that `accelerate` found there last. Larger groups are followed from here on.
   subroutine describe(self, time, q, v, a, state)
      use psalm_machine, only: motor_torque
      class(free_motion_t), intent(inout) :: self
      real(wp), intent(in) :: time, q(:), v(:), a(:)
      type(free_state_t), intent(out) :: state
      real(wp) :: columns(1, columns_of(self%problem)), unused, slope, own
      integer :: source, d

      call self%put_inputs(time, q, .true.)
      state%rate = self%speed + self%accel*time
      state%accel = self%accel
      state%rate(self%free) = v
      state%accel(self%free) = a
      state%input = self%start + time*(self%speed + 0.5_wp*self%accel*time)
      state%input(self%free) = q
      state%begun = self%start
      call self%put_rates(state%rate, state%accel)
      do d = 1, size(self%leader)
         if (self%leader(d) == d) cycle
         state%rate(d) = self%ratio(d)*state%rate(self%leader(d))
         state%accel(d) = self%ratio(d)*state%accel(self%leader(d))
         state%input(d) = self%start(d) + self%ratio(d)*(state%input(self%leader(d)) - self%start(self%leader(d)))
      end do
      associate (problem => self%problem, forces => self%forces)
         state%potential = potential_energy(problem, self%model, forces) + self%level
         call clear_wrenches(1, forces)
         do source = source_inertia, sources_of(self%model)
            call add_source(problem, self%model, source, [self%table_input(time, q)], 1, forces)
         end do
         state%kinetic = forces%w%v(1, forces%kinetic)
         state%growth = forces%w%v(1, forces%growth)
         state%stops = self%push/merge(self%model%metre, 1.0_wp, self%stops%slides)
         do d = 1, size(self%stops)
            if (abs(self%push(d)) > 0.0_wp) call press(problem, self%model, self%stops(d), state%stops(d), forces)
         end do
         if (self%watched > 0) then
            allocate (state%named(size(self%sense), 0:orders))
            do d = 1, size(self%sense)
               associate (one => self%stops(self%watched + d - 1))
                  state%named(d, 0) = self%sense(d)*self%place(self%watched + d - 1)
                  state%named(d, 1) = self%sense(d)*rate_at(problem, self%rates, forces, one, 1)
                  state%named(d, 2) = self%sense(d)*rate_at(problem, self%rates, forces, one, 2)
               end associate
            end do
            if (self%driven) then
               d = self%motor%drive
               state%motor_drive = d
               if (self%switched_on) call motor_torque(self%motor, state%named(d, 1), state%motor, unused)
               state%motor = state%motor - self%motor%flywheel*state%named(d, 2)
               call press(problem, self%model, self%stops(self%watched + d - 1), self%sense(d)*state%motor, forces)
            end if
         end if
         call sweep(problem, 1, forces)
         if (self%beside_change()) then
            if (self%passing%undetermined(self%at)) state%undetermined = self%passing%loop
         end if
         if (self%driven) then
            associate (rate => self%motor_speed(time, v))
               state%kinetic = state%kinetic + 0.5_wp*self%motor%flywheel*rate**2
               if (self%watched > 0) then
                  state%growth = state%growth + self%motor%flywheel*rate*state%named(self%motor%drive, 2)
               else
                  state%growth = state%growth + self%motor%flywheel*rate*state%accel(self%motor%drive)
               end if
            end associate
         end if
         call take_columns(problem, self%model, forces, 1, columns)
      end associate
      state%columns = columns(1, :)
      if (.not. self%beside_change() .or. self%watched > 0 .or. any(self%leader /= [(d, d=1, size(self%leader))])) return
      ! of a free drive the rounding of the sweep is left out
      d = column_drive
      own = 0.0_wp
      if (self%free(1) > 1) then
         d = column_of_other_drive(size(self%problem%mechanism%joints), self%free(1))
      else if (self%driven) then
         call motor_torque(self%motor, v(1), own, slope)
         own = own - self%motor%flywheel*a(1)
      end if
      state%columns(d) = own
   end subroutine describe

   !> Larger groups are followed from the position that was put in last. Springs are looked at: their moment is that of the angle
   !> within half a turn of SFREE.
   subroutine anchor(self)
      class(free_motion_t), intent(inout) :: self
      real(wp) :: turned
      integer :: k

      call self%problem%follow_from_here()
      self%anchored = self%place
      if (.not. allocated(self%turned)) allocate (self%turned(size(self%model%springs)), source=0.0_wp)
      do k = 1, size(self%turned)
         ! without stiffness the moment does not depend on the angle
         if (.not. self%model%springs(k)%torsional .or. .not. abs(self%model%springs(k)%stiffness) > 0.0_wp) cycle
         turned = torsion(self%model%springs(k), self%forces)
         if (abs(turned - self%turned(k)) > pi) self%wound = k
         self%turned(k) = turned
      end do
      do k = 1, size(self%model%springs)
         associate (spring => self%model%springs(k))
            if (.not. spring%power > 0.0_wp) cycle
            if (spring%is_closed(stretch_of(self%problem, self%model, spring, self%forces), self%model%metre)) self%closed = k
         end associate
      end do
   end subroutine anchor

   !> Find the position at a time. `valid` is false if a loop does not close, or two slides have passed each other.
   subroutine put_inputs(self, time, q, checked, valid)
      class(free_motion_t), intent(inout) :: self
      real(wp), intent(in) :: time, q(:)
      logical, intent(in) :: checked                    !! look at the sides of slides
      logical, intent(out), optional :: valid
      real(wp) :: input(size(self%slides))
      integer :: offset, n, k
      logical :: closes

      input = self%start + time*(self%speed + 0.5_wp*self%accel*time)
      input(self%free) = q
      where (.not. self%slides) input = input*degrees_per_radian
      if (size(q) == 1) self%at = q(1)
      associate (problem => self%problem)
         if (size(input) > 1) problem%own_delt(1, :) = input(2:)
         call problem%move_inputs(input(:1))
         self%open_loop = 0
         if (present(valid)) valid = .true.
         if (allocated(self%passing)) then
            call self%passing%put_signs(problem, self%at)
            if (self%passing%holds(self%at)) then
               call self%passing%put_place(problem, self%at)
               return
            end if
         end if
         call problem%solve_block(1, offset, n)
         do k = problem%mechanism%nloop, 1, -1
            closes = problem%linkage%closes(1, k)
            if (checked .and. problem%linkage%two_slides(k)) &
               closes = closes .and. (problem%linkage%store%v(1, problem%linkage%measure(k)) > 0.0_wp .eqv. self%side(k))
            if (.not. closes) self%open_loop = k
         end do
      end associate
      if (present(valid)) valid = self%open_loop == 0
   end subroutine put_inputs

   !> Rates of all bodies from those of the drives that follow no other.
   subroutine put_rates(self, rate, accel)
      class(free_motion_t), intent(inout) :: self
      real(wp), intent(in) :: rate(:), accel(:)         !! shape (drives)
      integer :: d, k

      do d = 1, size(rate)
         k = self%leader(d)
         self%problem%linkage%drive_rate(:, d) = self%ratio(d)*[rate(k), accel(k), 0.0_wp]
      end do
      if (self%beside_change()) then
         call self%passing%put_rates(self%rates, self%at, rate(self%free(1)), accel(self%free(1)), orders)
      else
         call differentiate(self%problem, self%rates, 1, orders)
      end if
      call move_bodies(self%problem, self%rates, 1, 1.0_wp, 0.0_wp, self%forces)
   end subroutine put_rates

   !> What the drives bear after a sweep, by a unit of their inputs; those that others follow bear for these, too.
   function drive_loads(self) result(load)
      class(free_motion_t), intent(in) :: self
      real(wp) :: load(size(self%slides))
      integer :: d

      do d = 1, size(load)
         load(d) = self%forces%w%v(1, self%forces%drives(d))
         if (self%slides(d)) load(d) = load(d)*self%model%metre
      end do
      do d = 2, size(load)
         if (self%leader(d) == d) cycle
         load(1) = load(1) + self%ratio(d)*load(d)
         load(d) = 0.0_wp
      end do
   end function drive_loads
end module psalm_free_motion
