!> A joint with clearance: what the group CLEAR asks for. Data in, results out. Source: Haines, chapters 3 and 4.
!>
!> Every minimum of the nominal load is a flypast that keeps contact or loses it; the contact is also followed through a turn.
module psalm_clearance_study
   use psalm_clearance_group, only: clearance_group_t, losses_passage
   use psalm_contact_pulse, only: contact_pulse_t, pulse_shape_t, find_pulse, shock_of
   use psalm_crank_motion, only: crank_motion_t
   use psalm_crank_study, only: check_crank, find_crank
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_flypast, only: flypast_t, flight_t, passing_contact_t, passed_step_t, follow_flypast, fly
   use psalm_flypast_chart, only: chart_t, make_chart, outermost_loss
   use psalm_following, only: followed_contact_t, contact_of, follow_contact, least_force_t
   use psalm_force_model, only: force_model_t, make_force_model, joint_at
   use psalm_joint_load, only: joint_load_t, find_joint_load
   use psalm_kinds, only: wp, pi, full_turn, degrees_per_radian
   use psalm_mechanism, only: mechanism_t, joint_revolute
   use psalm_periodic, only: periodic_t, periodic_from_samples
   use psalm_preparation, only: prepared_t
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t, is_to_end
   implicit none (type, external)
   private
   public :: clearance_study_t, flypast_of_joint_t, margins_t, check_clearance, find_clearance, find_margins
   public :: verdict_kept, verdict_lost, verdict_zero

   integer, parameter :: verdict_kept = 1, verdict_lost = 2
   integer, parameter :: verdict_zero = 3            !! the load passes through zero, or nearly: no flypast
   real(wp), parameter :: least_h1 = 0.02_wp         !! below it a load counts as zero
   real(wp), parameter :: surely_kept = 20.0_wp      !! H1 from which contact is never lost
   real(wp), parameter :: greatest_h3 = 0.999_wp     !! nearer to 1 the inertia is of rank one
   real(wp), parameter :: sharpness = 1.0e-6_wp      !! of the critical speed, relative
   integer, parameter :: halvings = 60

   !> One minimum of the load.
   type :: flypast_of_joint_t
      real(wp) :: input = 0.0_wp                     !! degrees from the reference position
      real(wp) :: load = 0.0_wp                      !! N
      real(wp) :: rate = 0.0_wp                      !! of the load across, N/s
      real(wp) :: mass = 0.0_wp                      !! M0, kg
      real(wp) :: h1 = 0.0_wp, h2 = 0.0_wp, h3 = 0.0_wp !! h2 in degrees; h3 is eps
      integer :: verdict = verdict_kept
      type(flypast_t) :: contact
      type(flight_t) :: flight                       !! if contact is lost
      real(wp) :: loss = 0.0_wp                      !! s after the minimum
      real(wp) :: duration = 0.0_wp                  !! of the flight, s
      real(wp) :: across = 0.0_wp, along = 0.0_wp    !! speed at the impact, m/s
      real(wp) :: impulse = 0.0_wp                   !! N s
      type(contact_pulse_t) :: pulse                 !! of the force where contact is kept, in SI units, its time from the minimum
      real(wp) :: cycles = 0.0_wp                    !! its width in periods of the links; 0: their frequency is not given
      real(wp) :: shock = 0.0_wp                     !! greatest deflection of the links over that by its height at rest
      real(wp) :: clearance = 0.0_wp                 !! diametral, m, up to which contact is kept; 0: however large
      ! in the passage, and at any of the minima that are looked at:
      real(wp) :: border(2) = 0.0_wp                 !! H1 beyond which contact is kept; 0: it always is
      real(wp) :: more(2) = 0.0_wp                   !! N by which the least load must rise, as by a preload, to keep contact
   contains
      procedure :: in_passage
   end type flypast_of_joint_t

   type :: clearance_row_t
      real(wp) :: speed = 0.0_wp                     !! rad/s
      real(wp) :: least = 0.0_wp                     !! load, N
      integer :: lost = 0                            !! minima at which contact is lost
      integer :: in_passage = 0                      !! of these in the passage, or where the load passes through zero
   end type clearance_row_t

   !> The load without clearance over the turn.
   type :: load_cycle_t
      real(wp), allocatable :: input(:)              !! degrees from the reference position
      real(wp), allocatable :: force(:, :)           !! shape (2, positions): x and y, N
      real(wp), allocatable :: amount(:)             !! N
   end type load_cycle_t

   type :: clearance_study_t
      type(crank_motion_t) :: crank                  !! if it is not known there is nothing else
      type(joint_load_t) :: load
      integer :: joint = 0
      real(wp) :: diametral = 0.0_wp                 !! m
      logical :: stopped = .false.                   !! the host asked for the end: the rest is not there
      logical :: done = .false.                      !! false: something hinders, and there is nothing else
      logical :: massless = .false.                  !! nothing moves with the pin somewhere
      type(load_cycle_t) :: cycle
      logical :: rank_one = .false.                  !! or only along one line
      type(flypast_of_joint_t), allocatable :: minima(:)
      real(wp), allocatable :: input(:), lag(:), force(:) !! following: degrees, degrees, N
      real(wp), allocatable :: pin(:)                !! direction of the pin in its hole, degrees in machine axes
      type(least_force_t), allocatable :: least(:)
      real(wp) :: loss = -1.0_wp                     !! input, degrees, where following loses contact; with `loses`
      logical :: loses = .false., followed = .false.
      type(clearance_row_t), allocatable :: speeds(:)
      real(wp) :: critical_speed = 0.0_wp            !! rad/s, below which contact is kept; 0: none within the range
      real(wp) :: critical_clearance = 0.0_wp        !! diametral, m, least of the minima; 0: none
      type(chart_t) :: chart                         !! if it is asked for
   end type clearance_study_t

   !> How far a joint is from losing contact, over all minima of its load at the speed of the case.
   type :: margins_t
      logical :: known = .false.                     !! false: something hinders the study
      real(wp) :: h1 = 0.0_wp                        !! least
      real(wp) :: over(2) = 0.0_wp                   !! least H1 over that of a loss in the passage, of any loss; `huge` if there
                                                     !! is none
      integer :: lost(2) = 0                         !! minima that lose contact in the passage, and all that do
   end type margins_t

contains

   !> The margins of the joint with clearance of a case whose links are heavier by some masses. The case is one that
   !> `check_clearance` found no fault with.
   subroutine find_margins(set, clearance, problem, mechanism, dimensions, added, margins)
      type(data_set_t), intent(in) :: set
      type(clearance_group_t), intent(in) :: clearance
      type(problem_t), intent(in) :: problem
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: added(:, :)            !! shape (4, bodies): about the references, as the inertia of a force model
      type(margins_t), intent(out) :: margins
      type(clearance_study_t) :: study
      type(force_model_t) :: model
      type(diagnostics_t) :: unused
      type(periodic_t) :: tensor(3)
      integer :: k

      call make_force_model(set, mechanism, dimensions, model, unused)
      model%inertia = model%inertia + added
      call begin_study(set, clearance, problem, mechanism, dimensions, model, study, tensor)
      margins%known = study%done
      if (.not. study%done) return
      call find_minima(study, tensor, study%crank%speed, 0.0_wp, .true., study%minima)
      margins%h1 = huge(1.0_wp)
      margins%over = huge(1.0_wp)
      do k = 1, size(study%minima)
         associate (m => study%minima(k))
            margins%h1 = min(margins%h1, m%h1)
            if (m%verdict == verdict_zero) margins%over = 0.0_wp
            where (m%border > 0.0_wp) margins%over = min(margins%over, m%h1/max(m%border, tiny(1.0_wp)))
            if (m%in_passage()) margins%lost(1) = margins%lost(1) + 1
            if (m%verdict /= verdict_kept) margins%lost(2) = margins%lost(2) + 1
         end associate
      end do
   end subroutine find_margins

   !> True if contact is lost in the passage, or where the load passes through zero.
   pure logical function in_passage(self)
      class(flypast_of_joint_t), intent(in) :: self

      in_passage = self%verdict == verdict_zero .or. (self%verdict == verdict_lost .and. self%contact%at == 1)
   end function in_passage

   !> Errors: no speed, a sliding input, friction, no revolute joint there, no masses.
   subroutine check_clearance(set, clearance, prepared, findings)
      type(data_set_t), intent(in) :: set
      type(clearance_group_t), intent(in) :: clearance
      type(prepared_t), intent(in) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(force_model_t) :: model
      integer :: joint

      if (.not. clearance%given) then
         call findings%error('the case asks for nothing: give &CLEAR', line=set%title_line)
         return
      end if
      call make_force_model(set, prepared%mechanism, prepared%given, model, findings)
      if (findings%failed()) return
      if (.not. set%rates%given) then
         call findings%error('the group is missing: bridge needs the SPEED of the input', line=set%title_line, group='RATES')
      else if (.not. abs(set%rates%speed) > 0.0_wp) then
         call set%origins%error(findings, 'RATES', 'SPEED', 'a joint with clearance needs a speed other than 0', 1)
      else if (abs(set%rates%accel) > 0.0_wp) then
         call set%origins%error(findings, 'RATES', 'ACCEL', 'the speed is to be constant: no ACCEL', 1)
      else
         call check_crank(set, findings)
      end if
      if (prepared%mechanism%sliding_input) then
         call refuse('bridge needs a crank that turns; the input of this linkage slides')
         return
      end if
      if (size(model%friction) > 0) call refuse('a joint with clearance does not go with friction in the joints')
      joint = joint_at(prepared%mechanism, clearance%joint)
      if (joint == 0) then
         call refuse('there is no joint at this end of the arc')
      else if (prepared%mechanism%joints(joint)%kind /= joint_revolute) then
         call refuse('joint '//prepared%mechanism%joints(joint)%name//' slides: only pins in holes are treated')
      end if

   contains

      subroutine refuse(text)
         character(*), intent(in) :: text

         call set%origins%error(findings, 'CLEAR', set%link_item('C'), text, 1)
      end subroutine refuse
   end subroutine check_clearance

   !> Study of a case that `check_clearance` found no fault with. `study%load%failure` tells where the crank cannot turn, and
   !> `study%crank%known` that its machine has no steady cycle: then there is nothing else.
   subroutine find_clearance(set, clearance, problem, mechanism, dimensions, study, stop)
      type(data_set_t), intent(in) :: set
      type(clearance_group_t), intent(in) :: clearance
      type(problem_t), intent(in) :: problem
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(clearance_study_t), intent(out) :: study
      type(stop_t), intent(in), optional :: stop     !! asked before each step, and before each speed
      type(force_model_t) :: model
      type(diagnostics_t) :: unused
      type(periodic_t) :: tensor(3)
      integer :: i

      call make_force_model(set, mechanism, dimensions, model, unused)
      call begin_study(set, clearance, problem, mechanism, dimensions, model, study, tensor, stop)
      if (.not. study%done) return
      call find_cycle(study, study%crank%speed)
      call find_minima(study, tensor, study%crank%speed, clearance%restitution, .true., study%minima, clearance%frequency)
      do i = 1, size(study%minima)
         associate (limit => study%minima(i)%clearance)
            if (limit <= 0.0_wp) cycle
            if (study%critical_clearance <= 0.0_wp .or. limit < study%critical_clearance) study%critical_clearance = limit
         end associate
      end do
      study%stopped = is_to_end(stop)
      if (.not. study%stopped) call follow(clearance, tensor, study)
      if (.not. study%stopped) call find_speeds(clearance, tensor, study, stop)
      if (study%stopped) return
      associate (c => clearance)
         if (c%radii > 0) call make_chart(c%radii, c%angles, c%greatest_h1, c%h3, study%chart, stop)
      end associate
      study%stopped = is_to_end(stop)
   end subroutine find_clearance

   !> The load of the joint and the inertia that moves with it; `study%done` unless something hinders.
   subroutine begin_study(set, clearance, problem, mechanism, dimensions, model, study, tensor, stop)
      type(data_set_t), intent(in) :: set
      type(clearance_group_t), intent(in) :: clearance
      type(problem_t), intent(in) :: problem
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(clearance_study_t), intent(out) :: study
      type(periodic_t), intent(out) :: tensor(3)
      type(stop_t), intent(in), optional :: stop
      integer :: i, c

      allocate (study%minima(0), study%speeds(0), study%least(0), study%input(0), study%lag(0), study%force(0), study%pin(0))
      study%joint = joint_at(mechanism, clearance%joint)
      study%diametral = clearance%diametral*model%metre
      call find_crank(set, problem, model, study%crank, stop)
      study%stopped = is_to_end(stop)
      if (study%stopped .or. .not. study%crank%known) return
      call find_joint_load(problem, dimensions, model, study%joint, clearance%points, study%crank, study%load)
      if (study%load%failure > 0 .or. study%load%loose > 0) return
      associate (m => study%load%tensor)
         study%massless = .not. all(m(1, :) + m(3, :) > 0.0_wp)
         if (study%massless) return
         do i = 1, size(m, 2)
            study%rank_one = study%rank_one .or. &
                             hypot(m(3, i) - m(1, i), 2.0_wp*m(2, i)) >= greatest_h3*(m(1, i) + m(3, i))
         end do
      end associate
      if (study%rank_one) return
      study%done = .true.
      do c = 1, 3
         tensor(c) = periodic_from_samples(study%load%tensor(c, :))
      end do
   end subroutine begin_study

   subroutine find_cycle(study, speed)
      type(clearance_study_t), intent(inout) :: study
      real(wp), intent(in) :: speed

      study%cycle%input = study%load%crank%input
      study%cycle%force = speed**2*study%load%inertia + study%load%fixed
      study%cycle%amount = norm2(study%cycle%force, dim=1)
   end subroutine find_cycle

   !> The load at a speed, N.
   pure function load_at(study, speed) result(load)
      type(clearance_study_t), intent(in) :: study
      real(wp), intent(in) :: speed
      type(periodic_t) :: load(2)
      integer :: c

      do c = 1, 2
         load(c) = periodic_from_samples(speed**2*study%load%inertia(c, :) + study%load%fixed(c, :))
      end do
   end function load_at

   !> Minima of the load at a speed and what becomes of contact there.
   subroutine find_minima(study, tensor, speed, restitution, limits, minima, frequency)
      type(clearance_study_t), intent(in) :: study
      type(periodic_t), intent(in) :: tensor(3)
      real(wp), intent(in) :: speed, restitution
      logical, intent(in) :: limits              !! find the critical clearance of each too
      type(flypast_of_joint_t), allocatable, intent(out) :: minima(:)
      real(wp), intent(in), optional :: frequency !! of the links, rad/s, 0: not known; without it no pulses are found
      type(periodic_t) :: load(2), slope(2)
      type(passing_contact_t) :: passing
      type(passed_step_t), allocatable :: steps(:)
      real(wp), allocatable :: amount(:)
      real(wp) :: low, high, middle
      integer :: i, k, n

      allocate (minima(0))
      load = load_at(study, speed)
      slope(1) = load(1)%derivative(1)
      slope(2) = load(2)%derivative(1)
      n = size(study%load%inertia, 2)
      amount = load(1)%values(n)**2 + load(2)%values(n)**2
      do i = 1, n
         if (.not. (amount(i) < amount(modulo(i - 2, n) + 1) .and. amount(i) <= amount(modulo(i, n) + 1))) cycle
         low = 2.0_wp*pi*real(i - 2, wp)/real(n, wp)
         high = 2.0_wp*pi*real(i, wp)/real(n, wp)
         do k = 1, halvings
            middle = 0.5_wp*(low + high)
            if (load(1)%at(middle)*slope(1)%at(middle) + load(2)%at(middle)*slope(2)%at(middle) < 0.0_wp) then
               low = middle
            else
               high = middle
            end if
         end do
         minima = [minima, flypast_at(modulo(0.5_wp*(low + high), 2.0_wp*pi))]
      end do

   contains

      function flypast_at(angle) result(here)
         real(wp), intent(in) :: angle           !! time, in radians of the mean turning
         type(flypast_of_joint_t) :: here
         real(wp) :: x, y, m(3), twice, radius
         integer :: c

         x = load(1)%at(angle)
         y = load(2)%at(angle)
         do c = 1, 3
            m(c) = tensor(c)%at(angle)
         end do
         radius = 0.5_wp*study%diametral
         here%input = study%crank%input_at(angle)
         here%load = hypot(x, y)
         here%rate = 0.0_wp
         if (here%load > 0.0_wp) here%rate = speed*(x*slope(2)%at(angle) - y*slope(1)%at(angle))/here%load
         here%mass = 0.5_wp*(m(1) + m(3))
         here%h3 = hypot(0.5_wp*(m(3) - m(1)), m(2))/here%mass
         twice = atan2(2.0_wp*m(2), m(3) - m(1)) + 2.0_wp*atan2(y, x)
         if (here%rate < 0.0_wp) twice = -twice
         twice = twice - 2.0_wp*pi*ceiling((twice - pi)/(2.0_wp*pi))
         here%h2 = twice*degrees_per_radian
         here%rate = abs(here%rate)
         here%h1 = surely_kept
         if (here%rate**2*radius*here%mass > tiny(1.0_wp)) then
            here%h1 = min(surely_kept, here%load/(here%rate**2*radius*here%mass)**(1.0_wp/3.0_wp))
         end if
         if (here%h1 < least_h1) then
            here%verdict = verdict_zero
            return
         end if
         if (here%h3 >= greatest_h3 .or. here%h1 >= surely_kept) return
         here%contact = follow_flypast(here%h1, twice, here%h3, passing=passing, steps=steps)
         if (present(frequency)) call find_pulse_of(here)
         if (here%contact%lost) then
            here%verdict = verdict_lost
            here%flight = fly(here%h1, twice, here%h3, here%contact%loss)
            here%loss = here%contact%loss(1)*here%load/here%rate
            here%duration = here%flight%duration*here%load/here%rate
            here%across = here%flight%across*radius*here%rate/here%load
            here%along = here%flight%along*radius*here%rate/here%load
            here%impulse = here%mass*here%rate*radius/here%load*here%flight%index*(1.0_wp + restitution)
         end if
         if (.not. limits) return
         ! H1 goes with the cube root of 1/e: contact is kept beyond the outermost border of the lost region
         here%border = [outermost_loss(twice, here%h3, .true.), outermost_loss(twice, here%h3, .false.)]
         if (here%border(2) > 0.0_wp) here%clearance = study%diametral*(here%h1/here%border(2))**3
         ! and as the least load, whose direction a preload along it does not change
         here%more = max(0.0_wp, here%load*(here%border/here%h1 - 1.0_wp))
      end function flypast_at

      !> The pulse if contact is kept.
      subroutine find_pulse_of(here)
         type(flypast_of_joint_t), intent(inout) :: here
         type(pulse_shape_t) :: shape

         call find_pulse(passing, steps, here%pulse, shape)
         if (.not. here%pulse%known) return
         associate (pulse => here%pulse, unit => here%load/here%rate)
            if (frequency > 0.0_wp) then
               here%cycles = pulse%width*unit*frequency/(2.0_wp*pi)
               here%shock = shock_of(shape, frequency*unit)
            end if
            pulse%at = pulse%at*unit
            pulse%force = pulse%force*here%load
            pulse%height = pulse%height*here%load
            pulse%width = pulse%width*unit
            pulse%growth = pulse%growth*here%rate
            pulse%decay = pulse%decay*here%rate
            pulse%impulse = pulse%impulse*here%load*unit
         end associate
      end subroutine find_pulse_of
   end subroutine find_minima

   !> Follow the contact through a turn at the speed of the case, by equal steps of time.
   subroutine follow(clearance, tensor, study)
      type(clearance_group_t), intent(in) :: clearance
      type(periodic_t), intent(in) :: tensor(3)
      type(clearance_study_t), intent(inout) :: study
      type(followed_contact_t) :: contact
      type(periodic_t) :: load(2)
      real(wp) :: from, loss
      real(wp), allocatable :: amount(:)
      integer :: n, i

      n = clearance%points
      load = load_at(study, study%crank%speed)
      amount = load(1)%values(n)**2 + load(2)%values(n)**2
      from = 2.0_wp*pi*real(maxloc(amount, 1) - 1, wp)/real(n, wp)
      if (clearance%begins) from = study%crank%time_of(clearance%begin)
      contact = contact_of(load, tensor, study%crank%speed, 0.5_wp*study%diametral)
      deallocate (study%input, study%lag, study%force)
      allocate (study%input(n), study%lag(n), study%force(n))
      call follow_contact(contact, from, n, study%lag, study%force, study%least, loss, study%followed)
      study%input = [(study%crank%sense*(from*degrees_per_radian + full_turn*real(i - 1, wp)/real(n, wp)), i=1, n)]
      if (study%crank%varies) study%input = [(study%crank%input_at(from + 2.0_wp*pi*real(i - 1, wp)/real(n, wp)), i=1, n)]
      study%lag = study%lag*degrees_per_radian
      study%pin = [(direction_at(from + 2.0_wp*pi*real(i - 1, wp)/real(n, wp)), i=1, n)] - study%lag
      study%loses = loss >= 0.0_wp
      study%loss = study%crank%input_at(loss)

   contains

      !> Of the load, degrees.
      real(wp) function direction_at(angle) result(direction)
         real(wp), intent(in) :: angle           !! time, in radians of the mean turning

         direction = atan2(load(2)%at(angle), load(1)%at(angle))*degrees_per_radian
      end function direction_at
   end subroutine follow

   !> Verdicts over speeds, and the speed up to which contact is kept.
   subroutine find_speeds(clearance, tensor, study, stop)
      type(clearance_group_t), intent(in) :: clearance
      type(periodic_t), intent(in) :: tensor(3)
      type(clearance_study_t), intent(inout) :: study
      type(stop_t), intent(in), optional :: stop
      real(wp) :: low, high, middle
      type(clearance_row_t) :: row
      integer :: i

      deallocate (study%speeds)
      allocate (study%speeds(clearance%speeds))
      associate (c => clearance)
         do i = 1, c%speeds
            study%stopped = is_to_end(stop)
            if (study%stopped) return
            middle = c%slowest
            if (c%speeds > 1) middle = c%slowest + (c%fastest - c%slowest)*real(i - 1, wp)/real(c%speeds - 1, wp)
            study%speeds(i) = row_at(middle)
         end do
      end associate
      i = findloc([(counted_at(study%speeds(i)) > 0, i=1, size(study%speeds))], .true., dim=1)
      if (i <= 1) return
      low = study%speeds(i - 1)%speed
      high = study%speeds(i)%speed
      do while (high - low > sharpness*high)
         study%stopped = is_to_end(stop)
         if (study%stopped) return
         middle = 0.5_wp*(low + high)
         row = row_at(middle)
         if (counted_at(row) > 0) then
            high = middle
         else
            low = middle
         end if
      end do
      study%critical_speed = low

   contains

      type(clearance_row_t) function row_at(speed)
         real(wp), intent(in) :: speed
         type(flypast_of_joint_t), allocatable :: minima(:)
         integer :: k

         call find_minima(study, tensor, speed, 0.0_wp, .false., minima)
         row_at%speed = speed
         row_at%least = 0.0_wp
         if (size(minima) > 0) row_at%least = minval(minima%load)
         row_at%lost = count(minima%verdict /= verdict_kept)
         row_at%in_passage = count([(minima(k)%in_passage(), k=1, size(minima))])
      end function row_at

      !> Minima with a loss that counts.
      pure integer function counted_at(row)
         type(clearance_row_t), intent(in) :: row

         counted_at = row%lost
         if (clearance%counted == losses_passage) counted_at = row%in_passage
      end function counted_at
   end subroutine find_speeds
end module psalm_clearance_study
