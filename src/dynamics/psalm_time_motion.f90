!> Motion in time of a mechanism whose drives, or some of them, move freely, by an explicit method of order 8.
!>
!> Unknowns are the free drives, their speeds, and, carried along without a say in the steps, the work that is put in and that is
!> lost: kinetic and potential energy less the one and with the other stay what they were. A step in which a joint comes to its stop
!> or leaves it, or a table has a kink, is repeated so that it ends there (`psalm_time_events`). What happens then is in submodules:
!> impacts (`psalm_time_stops_body`), friction (`psalm_time_friction_body`), change points (`psalm_time_change_body`).
!>
!> Drives are coordinates, some of which have dead points where the mechanism has none. After each step their rates at unit kinetic
!> energy are compared with those of all joints; where others would be much better the motion stops to be given a motion with those
!> (`poor`, `go_on_with`). What is compared for several drives is the volume of their rates as vectors; the best joints are chosen
!> one by one, each the longest across those before.
module psalm_time_motion
   use psalm_free_motion, only: free_motion_t, free_state_t
   use psalm_joint_stops, only: joint_stop_t, side_none, side_low, side_high
   use psalm_kinds, only: wp
   use psalm_linear, only: product_of, solve_positive
   use psalm_ode, only: ode_t, advance, next_step, one_step
   use psalm_root, only: root_search_t, begin_search
   use psalm_stiff_steps, only: stiff_steps_t
   use psalm_stop, only: stop_t
   use psalm_time_events, only: passage_t, marks_t, crossings_of, value_of, rub_none, rub_stops, rub_slips, table_change
   implicit none (type, external)
   private
   public :: time_motion_t, event_t, begin_motion
   public :: event_impact, event_rest, event_lift, event_stick, event_slip, event_on, event_off, event_change

   real(wp), parameter :: collapsed = 1.0e-13_wp   !! part of the whole time: no step is shorter
   real(wp), parameter :: creeping = 1.0e-7_wp     !! part of the whole time: so many steps in turn that are shorter,
   integer, parameter :: most_creeping = 200       !! as beside a dead point of a drive, where rounding spoils rates, lead nowhere
   real(wp), parameter :: first_part = 1.0e-3_wp   !! part of the whole time: the first step that is tried
   real(wp), parameter :: least_part = 1.0e-2_wp   !! of the size, or the size over the whole time, or of the largest so far: less
                                                    !! counts as that for errors
   real(wp), parameter :: touching = 1.0e-10_wp    !! radians, or parts of the size: a joint so near its stop touches it
   real(wp), parameter :: most_turned = 1.0_wp     !! radians that a joint with stops turns in a step, for its turns are counted
   real(wp), parameter :: stable_steps = 5.0_wp    !! step of the explicit method times the fastest decay: about 6.1 is the limit,
                                                    !! about which steps vary by a tenth where it holds them
   integer, parameter :: most_held = 15, most_free = 6 !! steps in turn that say that it limits them, or does not
   real(wp), parameter :: most_left = 1.0e5_wp     !! steps that are left: the motion does not go on then
   integer, parameter :: most_in_place = 100       !! events in turn between which no time passes
   integer, parameter :: many_creeping = 20        !! of those steps in turn, after which drives are exchanged that have
   real(wp), parameter :: fair_share = 0.5_wp      !! less than this part of the volume of the best,
   real(wp), parameter :: least_share = 0.1_wp     !! of the volume of the best drives: others take the place of drives with less
   integer, parameter :: event_impact = 1          !! a joint hits its stop
   integer, parameter :: event_rest = 2            !! it rests on it from then on
   integer, parameter :: event_lift = 3            !! it leaves it, because nothing presses it there
   integer, parameter :: event_stick = 4           !! friction holds a joint from then on
   integer, parameter :: event_slip = 5            !! until then
   integer, parameter :: event_on = 6              !! friction of a joint begins to act, or the motor (stop 0)
   integer, parameter :: event_off = 7             !! it ends
   integer, parameter :: event_change = 8          !! it passes a change point; no stop, rates of the first drive
   real(wp), parameter :: beside_line = 0.05_wp    !! sine of a dyad after a step, in the next of which it may be in line
   real(wp), parameter :: within = 1.0e-12_wp      !! part of what friction can hold: so much more is held
   real(wp), parameter :: nothing = 1.0e-9_wp      !! part of the greatest rate of a joint with friction, or of its acceleration
                                                    !! where nothing holds it: less is 0

   !> What happens at a time that is known before: a table of loads has a kink there, or friction or the motor is switched.
   type :: switch_t
      real(wp) :: time = 0.0_wp                       !! s
      integer :: kind = 0                             !! `event_on`, `event_off`; 0: a kink
      integer :: entry = 0                            !! of friction; 0: the motor
   end type switch_t

   !> What happened at a time.
   type :: event_t
      real(wp) :: time = 0.0_wp                       !! s
      integer :: kind = 0                             !! `event_...`
      integer :: stop = 0
      real(wp) :: before = 0.0_wp, after = 0.0_wp     !! rate of the joint: rad/s or lengths/s
      real(wp) :: impulse = 0.0_wp                    !! of the stop, forwards: N m s or N s
   end type event_t

   !> A motion and where it is.
   type, extends(ode_t) :: time_motion_t
      type(free_motion_t), allocatable :: motion      !! large: it would fill a small stack
      real(wp), allocatable :: size_of(:)             !! by free drive: what a change counts by, a radian or the size of the linkage
      real(wp), allocatable :: size_of_stop(:)        !! by stop: the same
      real(wp) :: end = 0.0_wp                        !! of the whole motion, s
      real(wp), allocatable :: largest(:)             !! shape (2 free drives): coordinates and speeds so far
      real(wp) :: time = 0.0_wp
      real(wp), allocatable :: y(:), first(:)         !! unknowns there, and their rates
      real(wp) :: step = 0.0_wp                       !! s: the next that is tried
      integer :: steps = 0
      class(stiff_steps_t), pointer :: stiff => null() !! steps by another method, which `close` ends; none: the explicit one
      integer :: held_steps = 0, free_steps = 0       !! steps in turn that stability limits; since, those it does not
      logical :: held = .false.                       !! it has limited many in turn,
      logical :: endless = .false.                    !! and so many would follow that the motion ends there
      integer :: most_events = huge(1)
      logical :: crowded = .false.                    !! there were more events than that
      integer :: most_steps = huge(1)
      logical :: tired = .false.                      !! more steps would follow than that
      type(stop_t) :: host                            !! who may ask for the end
      logical :: asked = .false.                      !! it was asked for
      type(event_t), allocatable :: events(:)
      type(switch_t), allocatable :: switches(:)      !! in the order of their times
      integer :: switched = 0                         !! so many of them are over
      real(wp), allocatable :: begun(:)               !! by drive of the case: its input at time 0
      real(wp), allocatable :: fastest(:)             !! by stop: greatest rate of its joint so far, at least one that counts
      integer :: jumped = 0                           !! impacts, several at a time as one
      real(wp), allocatable :: jumps(:, :)            !! shape (1 + 3 drives, at least `jumped`): time, s; by drive its place,
                                                      !! its rate before and after, as `free_state_t` has them
      type(joint_stop_t), allocatable :: joints(:)    !! drives there might be, the present free ones first; none: no exchange
      real(wp), allocatable :: weights(:)             !! of their rates: a travel by the size of the linkage
      logical :: poor = .false.                       !! it stopped because drives are to be exchanged
      real(wp), allocatable :: pivots(:)              !! by loop: sines of dyads, which go through 0 at change points, after the
      real(wp) :: pivots_at = 0.0_wp                  !! last step, and the free drive there
      real(wp) :: failed = huge(1.0_wp)               !! so far from where one might have been there was none
      real(wp) :: unseen = huge(1.0_wp)               !! s: by then it might be passed, though none was found
      real(wp), allocatable :: sines(:, :)            !! shape (loops, 2): their amounts after the step before and the last,
      real(wp) :: sines_at(2) = 0.0_wp                !! and when
      integer :: folded = 0                           !! the motion ends, for this loop has passed a change point in its assembly
      logical :: open_ahead = .true.                  !! nothing can be passed there: one was found, or the linkage does not close
      real(wp) :: gap = 0.0_wp                        !! part of the lengths by which the linkage misses a change point, at most
   contains
      procedure :: rates
      procedure :: tolerances
      procedure :: advance_to
      procedure :: observe
      procedure :: sizes
      procedure :: work
      procedure :: lost
      procedure :: compare_drives
      procedure :: go_on_with
      procedure :: go_back_to
      procedure :: size_of_linkage
      procedure, private :: marks
      procedure, private :: go_to_first
      procedure, private :: settle
      procedure, private :: longest_step
      procedure, private :: note
      procedure, private :: note_stability
      procedure, private :: switch
      procedure :: near_line
   end type time_motion_t

   interface
      !> Stops that joints touch, and perhaps one that a joint has just come to: impacts, and which joints rest then.
      !>
      !> Of stops that close at the same time the one with the greatest speed acts first, again and again until none closes.
      module subroutine meet_stops(self, valid, stop, side)
         implicit none (type, external)
         class(time_motion_t), intent(inout) :: self
         logical, intent(out) :: valid
         integer, intent(in), optional :: stop, side
      end subroutine meet_stops

      !> Which joints with friction are stuck, and which way others slip: those that move as they move; of those at rest all are
      !> stuck that friction can hold, and others slip the way that the force goes. One of them may be known to slip.
      !>
      !> Joints are let go one by one, that first which lacks most. Where this leads to no state that agrees with itself (what is
      !> held is not more than friction holds, what slips goes the way that it is thought to go) all states are tried.
      module subroutine choose_friction(self, valid, joint, slips)
         implicit none (type, external)
         class(time_motion_t), intent(inout) :: self
         logical, intent(out) :: valid
         integer, intent(in), optional :: joint          !! that has come to rest, or that is not held any longer
         logical, intent(in), optional :: slips          !! it is not held
      end subroutine choose_friction

      !> Whether a change point has been passed that was not found, so that the linkage has folded: the sine of a dyad, which is
      !> small, had to go through 0, but for its assembly has come back from there.
      module subroutine watch_folds(self)
         implicit none (type, external)
         class(time_motion_t), intent(inout) :: self
      end subroutine watch_folds

      !> Find the change point ahead, if there is one near enough: where the line through the sines of a dyad now and after the step
      !> before, or a little behind, goes through 0.
      module subroutine look_ahead(self, valid)
         implicit none (type, external)
         class(time_motion_t), intent(inout) :: self
         logical, intent(out) :: valid
      end subroutine look_ahead
   end interface

contains

   !> Put a motion at time 0. Errors: `valid` is false where there are no accelerations; `moving%motion` says why.
   subroutine begin_motion(speeds, end, tolerance, most_events, most_steps, moving, valid)
      real(wp), intent(in) :: speeds(:)               !! shape (free drives)
      real(wp), intent(in) :: end, tolerance
      integer, intent(in) :: most_events, most_steps
      class(time_motion_t), intent(inout) :: moving   !! with its motion
      logical, intent(out) :: valid
      real(wp) :: length

      moving%end = end
      moving%tolerance = tolerance
      moving%most_events = most_events
      moving%most_steps = most_steps
      moving%step = first_part*end
      allocate (moving%events(0))
      moving%begun = moving%motion%start
      allocate (moving%jumps(1 + 3*size(moving%begun), 0))
      associate (f => size(speeds))
         length = length_of(moving%motion)
         moving%size_of = moving%sizes()
         moving%size_of_stop = merge(length, 1.0_wp, moving%motion%stops%slides)
         moving%y = [moving%motion%start(moving%motion%free), speeds, 0.0_wp, 0.0_wp]
         moving%largest = abs(moving%y(:2*f))
         allocate (moving%first(2*f + 2))
         moving%fastest = least_part*moving%size_of_stop/end
      end associate
      call list_switches(moving%motion, moving%switches)
      do while (moving%switched < size(moving%switches))
         if (moving%switches(moving%switched + 1)%time > 0.0_wp) exit
         moving%switched = moving%switched + 1
      end do
      moving%motion%switched_on = .not. moving%motion%motor%from > 0.0_wp
      moving%motion%engaged = .not. moving%motion%model%friction%from > 0.0_wp
      call moving%rates(0.0_wp, moving%y, moving%first, valid)
      if (.not. valid) return
      ! over a long time a first step of many turns could seem right by chance
      associate (f => size(speeds), size_of => moving%size_of)
         if (f > 0) moving%step = moving%step/max(1.0_wp, moving%step*maxval(abs(speeds)/size_of), &
                                                  moving%step*sqrt(maxval(abs(moving%first(f + 1:2*f))/size_of)))
      end associate
      call choose_friction(moving, valid)
      if (valid) call meet_stops(moving, valid)
      if (valid) call look_ahead(moving, valid)
      if (valid) call moving%motion%anchor()
   end subroutine begin_motion

   !> Times at which a step has to end, in their order.
   pure subroutine list_switches(motion, switches)
      type(free_motion_t), intent(in) :: motion
      type(switch_t), allocatable, intent(out) :: switches(:)
      type(switch_t) :: one
      integer :: k, i

      allocate (switches(0))
      if (motion%model%timed .and. any(motion%model%loads%table > 0)) then
         switches = [(switch_t(motion%model%table_input(k)), k=1, size(motion%model%table_input))]
      end if
      if (motion%driven) switches = [switches, switch_t(motion%motor%from, event_on), switch_t(motion%motor%until, event_off)]
      do k = 1, size(motion%model%friction)
         associate (of => motion%model%friction(k))
            switches = [switches, switch_t(of%from, event_on, k), switch_t(of%until, event_off, k)]
         end associate
      end do
      do k = 2, size(switches)
         one = switches(k)
         do i = k - 1, 1, -1
            if (switches(i)%time <= one%time) exit
            switches(i + 1) = switches(i)
         end do
         switches(i + 1) = one
      end do
   end subroutine list_switches

   !> Do what happens at the time that has come.
   subroutine switch(self, valid)
      class(time_motion_t), intent(inout) :: self
      logical, intent(out) :: valid
      logical :: rubs

      rubs = .false.
      do while (self%switched < size(self%switches))
         associate (one => self%switches(self%switched + 1), motion => self%motion)
            if (one%time > self%time) exit
            self%switched = self%switched + 1
            if (one%kind == 0) cycle
            if (one%entry == 0) then
               motion%switched_on = one%kind == event_on
               call self%note(event_t(time=self%time, kind=one%kind))
            else
               motion%engaged(one%entry) = one%kind == event_on
               call self%note(event_t(time=self%time, kind=one%kind, stop=motion%smooth + one%entry))
               rubs = .true.
            end if
         end associate
      end do
      if (associated(self%stiff)) call self%stiff%close()
      call self%rates(self%time, self%y, self%first, valid)
      if (valid .and. rubs) call choose_friction(self, valid)
   end subroutine switch

   !> Go on with the motion of before, which has been put in `motion` again.
   subroutine go_back_to(self, y)
      class(time_motion_t), intent(inout) :: self
      real(wp), intent(in) :: y(:)
      logical :: unused

      call self%go_on_with(y(size(self%motion%free) + 1:2*size(self%motion%free)), unused)
      self%y = y
      self%largest = abs(y(:size(self%largest)))
      call self%rates(self%time, self%y, self%first, unused)
   end subroutine go_back_to

   !> What lengths are compared with, user's length.
   pure real(wp) function size_of_linkage(self)
      class(time_motion_t), intent(in) :: self

      size_of_linkage = length_of(self%motion)
   end function size_of_linkage

   !> By free drive: a radian or the size of the linkage.
   pure function sizes(self)
      class(time_motion_t), intent(in) :: self
      real(wp), allocatable :: sizes(:)

      sizes = merge(length_of(self%motion), 1.0_wp, self%motion%slides(self%motion%free))
   end function sizes

   !> The size of a linkage, user's length; slides alone have no links with lengths, perhaps stops.
   pure real(wp) function length_of(motion) result(length)
      type(free_motion_t), intent(in) :: motion
      integer :: k

      length = max(0.0_wp, maxval(motion%problem%linkage%length))/motion%problem%linkage%scale
      do k = 1, size(motion%stops)
         associate (ends => [motion%stops(k)%low, motion%stops(k)%high])
            if (motion%stops(k)%slides) length = max(length, maxval(abs(pack(ends, abs(ends) < huge(length)))))
         end associate
      end do
      if (.not. length > 0.0_wp) length = 1.0_wp
   end function length_of

   subroutine rates(self, time, y, d, valid)
      class(time_motion_t), intent(inout) :: self
      real(wp), intent(in) :: time, y(:)
      real(wp), intent(out) :: d(:)
      logical, intent(out) :: valid

      associate (f => size(self%motion%free))
         d(:f) = y(f + 1:2*f)
         call self%motion%accelerate(time, y(:f), y(f + 1:2*f), d(f + 1:2*f), d(2*f + 1), d(2*f + 2), valid)
      end associate
   end subroutine rates

   pure function tolerances(self, y, after) result(allowed)
      class(time_motion_t), intent(in) :: self
      real(wp), intent(in) :: y(:), after(:)
      real(wp) :: allowed(size(y))

      associate (f => size(self%size_of))
         associate (least => least_part*max([self%size_of, self%size_of/self%end], self%largest))
            allowed(:2*f) = self%tolerance*max(abs(y(:2*f)), abs(after(:2*f)), least)
         end associate
         allowed(2*f + 1:) = huge(1.0_wp)
      end associate
   end function tolerances

   !> Go on to a time. `reached` is false where no step that counts keeps the tolerance, a torsional spring is wound half a
   !> turn, there are too many events, or the host asks for the end; it stands at the time before then, or at that.
   subroutine advance_to(self, target, reached)
      class(time_motion_t), intent(inout) :: self
      real(wp), intent(in) :: target
      logical, intent(out) :: reached
      real(wp) :: after(size(self%y)), before(size(self%y)), rates_before(size(self%y)), taken, error, wanted, shortest, longest
      real(wp) :: began, share, last_stage(size(self%y), 2)
      integer :: better(size(self%size_of))
      type(marks_t) :: marks
      type(passage_t), allocatable :: crossings(:)
      real(wp) :: next
      integer :: short, in_place
      logical :: last

      short = 0
      in_place = 0
      shortest = collapsed*self%end
      do while (self%time < target)
         self%asked = self%host%requested()
         reached = .not. self%asked
         if (.not. reached) return
         next = target
         if (self%switched < size(self%switches)) next = min(target, self%switches(self%switched + 1)%time)
         longest = min(self%longest_step(), self%unseen)
         wanted = min(self%step, longest)
         last = wanted >= (1.0_wp - sqrt(epsilon(1.0_wp)))*(next - self%time)
         if (last) wanted = next - self%time
         marks = self%marks()
         if (associated(self%stiff)) then
            wanted = min(next - self%time, longest)
            last = wanted >= next - self%time
            call self%stiff%step(self, self%time, self%y, wanted, after, taken, reached)
            error = merge(1.0_wp, huge(1.0_wp), reached)
         else
            call advance(self, self%time, self%y, wanted, shortest, after, taken, error, self%first, last_stage)
         end if
         short = merge(short + 1, 0, taken < creeping*self%end .and. .not. (last .or. taken >= longest))
         reached = error <= 1.0_wp .and. short <= most_creeping
         if (.not. reached) return
         last = last .and. taken >= wanted
         began = self%time
         before = self%y
         rates_before = self%first
         ! a step that the end of an interval cut short says nothing against a longer one
         self%step = max(next_step(taken, error), merge(self%step, 0.0_wp, last .or. taken >= longest))
         self%time = merge(next, self%time + taken, last)
         self%y = after
         call self%rates(self%time, self%y, self%first, reached)
         if (.not. reached) return
         if (.not. associated(self%stiff)) call self%note_stability(before, taken, last_stage)
         crossings = crossings_of(self%motion, marks, self%marks(), taken)
         if (size(crossings) > 0) then
            call self%go_to_first(crossings, began, before, rates_before, taken, reached)
            if (.not. reached) return
            if (self%time < next) last = .false.
            in_place = merge(0, in_place + 1, self%time > began)
            reached = in_place <= most_in_place
            if (.not. reached) return
         end if
         self%largest = max(self%largest, abs(self%y(:size(self%largest))))
         self%steps = self%steps + 1
         self%fastest(:) = max(self%fastest, abs(self%motion%pace))
         if (any(self%motion%resting /= side_none) .or. any(self%motion%stuck)) then
            call self%settle()
            call self%rates(self%time, self%y, self%first, reached)
            if (.not. reached) return
         end if
         if (self%switched < size(self%switches)) then
            if (self%time >= self%switches(self%switched + 1)%time) call self%switch(reached)
            if (.not. reached) return
         end if
         call self%motion%anchor()
         reached = self%motion%wound == 0 .and. self%motion%closed == 0
         if (.not. reached) return
         self%crowded = size(self%events) > self%most_events
         self%tired = self%steps >= self%most_steps .and. self%time < self%end
         reached = .not. (self%crowded .or. self%endless .or. self%tired)
         if (.not. reached) return
         call watch_folds(self)
         reached = self%folded == 0
         if (.not. reached) return
         call look_ahead(self, reached)
         if (.not. reached) return
         if (.not. allocated(self%joints) .or. self%motion%beside_change()) cycle
         call self%compare_drives(share, better)
         self%poor = share < least_share .or. (short > many_creeping .and. share < fair_share)
         reached = .not. self%poor
         if (.not. reached) return
      end do
      reached = .true.
   end subroutine advance_to

   !> True if a dyad was nearly in line after the last step: beside a dead point or a change point rates mean nothing.
   pure logical function near_line(self)
      class(time_motion_t), intent(in) :: self

      near_line = .false.
      if (allocated(self%sines)) near_line = any(self%sines(:, 2) < beside_line)
   end function near_line

   !> The best drives among the joints, and the part of their volume that the present ones have.
   subroutine compare_drives(self, share, chosen)
      class(time_motion_t), intent(inout) :: self
      real(wp), intent(out) :: share
      integer, intent(out) :: chosen(:)               !! shape (free drives): of `joints`
      real(wp) :: rates(size(self%joints), size(chosen)), per_force(size(chosen), size(self%joints)), own, best
      integer :: unused(size(chosen)), k
      logical :: valid

      call self%motion%rates_of(self%joints, rates)
      do k = 1, size(self%joints)
         rates(k, :) = rates(k, :)*self%weights(k)
         call solve_positive(self%motion%inertia(self%motion%free, :), rates(k, :), per_force(:, k), valid)
      end do
      associate (products => product_of(rates, per_force), f => size(chosen))
         call choose(products, chosen, best)
         call choose(products(:f, :f), unused, own)
      end associate
      share = 1.0_wp
      if (best > 0.0_wp) share = sqrt(own/best)
   end subroutine compare_drives

   !> Vectors of which each is the longest across those before, from the products of all; the square of their volume.
   pure subroutine choose(products, chosen, square)
      real(wp), intent(in) :: products(:, :)
      integer, intent(out) :: chosen(:)
      real(wp), intent(out) :: square
      real(wp) :: rest(size(products, 1), size(products, 1)), across(size(products, 1)), pivot
      logical :: taken(size(products, 1))
      integer :: i, j, k

      rest = products
      taken = .false.
      square = 1.0_wp
      do i = 1, size(chosen)
         across = [(rest(j, j), j=1, size(across))]
         k = maxloc(across, dim=1, mask=.not. taken)
         chosen(i) = k
         taken(k) = .true.
         pivot = max(0.0_wp, across(k))
         square = square*pivot
         if (.not. pivot > 0.0_wp) cycle
         across = rest(:, k)
         do j = 1, size(across)
            rest(:, j) = rest(:, j) - across*(across(j)/pivot)
         end do
      end do
   end subroutine choose

   !> Go on with the motion of other drives that has been put in `motion`, at the position and time where it is.
   subroutine go_on_with(self, speeds, valid)
      class(time_motion_t), intent(inout) :: self
      real(wp), intent(in) :: speeds(:)               !! shape (free drives)
      logical, intent(out) :: valid
      real(wp) :: work, lost, fastest(self%motion%smooth + self%motion%rubs())

      if (associated(self%stiff)) call self%stiff%close()
      self%poor = .false.
      associate (f => size(speeds))
         work = self%work()
         lost = self%lost()
         self%size_of = self%sizes()
         self%size_of_stop = merge(length_of(self%motion), 1.0_wp, self%motion%stops%slides)
         self%y = [self%motion%start(self%motion%free), speeds, work, lost]
         fastest = self%fastest(:size(fastest))
         self%fastest = least_part*self%size_of_stop/self%end
         self%fastest(:size(fastest)) = fastest
         if (allocated(self%pivots)) deallocate (self%pivots)
         if (allocated(self%sines)) deallocate (self%sines)
         self%largest = abs(self%y(:2*f))
      end associate
      call self%rates(self%time, self%y, self%first, valid)
      if (valid) call self%motion%anchor()
   end subroutine go_on_with

   !> What events are known by, where it is now.
   function marks(self)
      class(time_motion_t), intent(in) :: self
      type(marks_t) :: marks

      marks%place = self%motion%place
      marks%pace = self%motion%pace
      marks%growth = self%motion%growth
      marks%push = self%motion%push
      marks%stretch = self%motion%stretch
      marks%spare = self%motion%most_held*(1.0_wp + within) - abs(self%motion%push)
      marks%parts = self%motion%parts
      marks%still = nothing*self%fastest
      marks%input = self%motion%first_input(self%time, self%y(:size(self%motion%free)))
      marks%at = self%y(1)
      marks%speed = self%motion%motor_speed(self%time, self%y(size(self%motion%free) + 1:))
   end function marks

   !> End a step of length h, which goes on beyond events, at the first of them, and do what happens there.
   subroutine go_to_first(self, crossings, began, before, rates_before, h, valid)
      class(time_motion_t), intent(inout) :: self
      type(passage_t), intent(in) :: crossings(:)
      real(wp), intent(in) :: began, before(:), rates_before(:), h !! state at the beginning of the step
      logical, intent(out) :: valid
      type(root_search_t) :: search
      real(wp) :: ends, least, greatest, length
      integer :: k, first

      ends = h
      first = 0
      do k = 1, size(crossings)
         if (.not. found(crossings(k), least, greatest)) cycle
         search = begin_search(least, value_after(least), greatest, value_after(greatest), epsilon(1.0_wp)*(began + h))
         do while (.not. search%done())
            length = search%next()
            call search%put(length, value_after(length))
         end do
         greatest = search%root()
         if (first > 0 .and. greatest >= ends) cycle
         ends = greatest
         first = k
      end do
      if (first == 0) then
         self%y = state_after(h)
         call self%rates(began + h, self%y, self%first, valid)
         return
      end if
      k = first
      self%y = state_after(ends)
      self%time = began + ends
      call self%rates(self%time, self%y, self%first, valid)
      if (.not. valid) return
      associate (crossing => crossings(first))
         if (crossing%table == table_change) then
            associate (rate => self%y(size(self%motion%free) + 1))
               call self%note(event_t(time=self%time, kind=event_change, before=rate, after=rate))
            end associate
         else if (crossing%rub /= rub_none) then
            if (crossing%rub == rub_stops .or. crossing%rub == rub_slips) &
               call choose_friction(self, valid, crossing%stop, crossing%rub == rub_slips)
         else if (crossing%lifts) then
            call self%note(event_t(time=self%time, kind=event_lift, stop=crossing%stop))
            self%motion%resting(crossing%stop) = side_none
            call self%rates(self%time, self%y, self%first, valid)
         else if (crossing%stop > 0) then
            call meet_stops(self, valid, crossing%stop, crossing%side)
         end if
      end associate

   contains

      !> Between what lengths of the step its value becomes negative. A value that is 0 at the beginning first rises.
      logical function found(crossing, least, greatest)
         type(passage_t), intent(in) :: crossing
         real(wp), intent(out) :: least, greatest
         integer, parameter :: halvings = 60
         integer :: i

         least = 0.0_wp
         greatest = crossing%within
         found = value_after(greatest) < 0.0_wp
         if (.not. found) return
         if (crossing%rises) then
            least = greatest
            do i = 1, halvings
               least = 0.5_wp*least
               found = value_after(least) > 0.0_wp
               if (found) return
               greatest = least
            end do
            ! it is there already
            found = .true.
            least = 0.0_wp
            greatest = 0.0_wp
         end if
      end function found

      !> Value of the event that is looked for (k) after a step of that length.
      real(wp) function value_after(length)
         real(wp), intent(in) :: length
         real(wp) :: y(size(before)), d(size(before))
         logical :: there

         if (length <= 0.0_wp) then
            value_after = crossings(k)%at_first
            return
         end if
         y = state_after(length)
         call self%rates(began + length, y, d, there)
         self%time = began + length
         self%y = y
         value_after = value_of(self%motion, crossings(k), self%marks())
      end function value_after

      function state_after(length) result(y)
         real(wp), intent(in) :: length
         real(wp) :: y(size(before))

         y = before
         if (associated(self%stiff)) then
            if (length > 0.0_wp) call self%stiff%state(began + length, y)
            return
         end if
         if (length > 0.0_wp) call one_step(self, began, before, length, y, first=rates_before)
      end function state_after
   end subroutine go_to_first

   !> Put joints that rest exactly on their stops, and those that friction holds where it does, at rate 0.
   subroutine settle(self)
      class(time_motion_t), intent(inout) :: self
      real(wp), dimension(size(self%size_of)) :: loosened, back, slower
      real(wp) :: yields, limit
      integer :: f, j, k

      f = size(self%size_of)
      do k = 1, size(self%motion%resting)
         associate (motion => self%motion)
            if (motion%resting(k) == side_none .and. .not. motion%stuck(k)) cycle
            loosened = motion%loosen(k)
            yields = dot_product(motion%normal(k, motion%free), loosened)
            if (.not. yields > 0.0_wp) cycle
            limit = motion%stuck_at(k)
            if (.not. motion%stuck(k)) limit = merge(motion%stops(k)%high, motion%stops(k)%low, motion%resting(k) == side_high)
            back = loosened*((limit - motion%place(k))/yields)
            slower = loosened*(motion%pace(k)/yields)
            self%y(:f) = self%y(:f) + back
            self%y(f + 1:2*f) = self%y(f + 1:2*f) - slower
            ! another joint of the same motion then has nothing to correct
            do j = 1, size(motion%place)
               motion%place(j) = motion%place(j) + dot_product(motion%normal(j, motion%free), back)
               motion%pace(j) = motion%pace(j) - dot_product(motion%normal(j, motion%free), slower)
            end do
         end associate
      end do
      ! a drive that friction holds still is still
      if (any(self%motion%stuck)) then
         where (abs(self%y(f + 1:2*f)) <= epsilon(1.0_wp)**2*self%largest(f + 1:)) self%y(f + 1:2*f) = 0.0_wp
      end if
   end subroutine settle

   !> So long a step may be: joints with stops are not to turn farther, and what leaves a stop is not to come back in the same step.
   pure real(wp) function longest_step(self) result(longest)
      class(time_motion_t), intent(in) :: self
      real(wp) :: away, toward
      integer :: k, side

      longest = huge(1.0_wp)
      do k = 1, size(self%size_of_stop)
         associate (motion => self%motion, stop => self%motion%stops(k))
            if (motion%resting(k) /= side_none) cycle
            if (.not. stop%slides .and. abs(motion%pace(k)) > 0.0_wp) longest = min(longest, most_turned/abs(motion%pace(k)))
            do side = side_low, side_high, side_high - side_low
               if (real(side, wp)*(merge(stop%high, stop%low, side == side_high) - motion%place(k)) > &
                   touching*self%size_of_stop(k)) cycle
               away = -real(side, wp)*motion%pace(k)
               toward = real(side, wp)*motion%growth(k)
               if (away > 0.0_wp .and. toward > 0.0_wp) longest = min(longest, max(away/toward, collapsed*self%end))
            end do
         end associate
      end do
   end function longest_step

   !> Whether stability, not the error, limits the steps: the step that has just been made, from `before`, times the greatest rate
   !> at which deviations decay, by the last stage and the end, which are at the same time (Hairer and Wanner, Solving Ordinary
   !> Differential Equations II, IV.2).
   pure subroutine note_stability(self, before, h, last_stage)
      class(time_motion_t), intent(inout) :: self
      real(wp), intent(in) :: before(:), h, last_stage(:, :)
      real(wp) :: away, change, allowed(size(self%y))
      integer :: k

      if (self%held) return
      allowed = self%tolerances(before, self%y)
      away = 0.0_wp
      change = 0.0_wp
      do k = 1, 2*size(self%size_of)
         away = max(away, abs(self%y(k) - last_stage(k, 1))/allowed(k))
         change = max(change, abs(self%first(k) - last_stage(k, 2))/allowed(k))
      end do
      if (h*change > stable_steps*away .and. away > 0.0_wp) then
         self%held_steps = self%held_steps + 1
         self%free_steps = 0
      else
         self%free_steps = self%free_steps + 1
         if (self%free_steps >= most_free) self%held_steps = 0
      end if
      self%held = self%held_steps >= most_held
      self%endless = self%held .and. self%end - self%time > most_left*h
   end subroutine note_stability

   subroutine note(self, event)
      class(time_motion_t), intent(inout) :: self
      type(event_t), intent(in) :: event

      self%events = [self%events, event]
   end subroutine note

   !> Everything where it is.
   subroutine observe(self, state)
      class(time_motion_t), intent(inout) :: self
      type(free_state_t), intent(out) :: state

      associate (f => size(self%motion%free))
         call self%motion%describe(self%time, self%y(:f), self%y(f + 1:2*f), self%first(f + 1:2*f), state)
      end associate
   end subroutine observe

   !> Work of loads, motor and the drives that are not free, J.
   pure real(wp) function work(self)
      class(time_motion_t), intent(in) :: self

      work = self%y(size(self%y) - 1)
   end function work

   !> Work lost in dampers and impacts, J.
   pure real(wp) function lost(self)
      class(time_motion_t), intent(in) :: self

      lost = self%y(size(self%y))
   end function lost
end module psalm_time_motion
