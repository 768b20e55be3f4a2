!> Impacts of a motion in time: joints come to their stops, bounce and rest there.
submodule(psalm_time_motion) psalm_time_stops_body
   implicit none (type, external)

   real(wp), parameter :: last_bounces = 1.0e-6_wp !! part of the whole time: if all bounces that follow take less, the joint rests
   real(wp), parameter :: still = 64.0_wp*epsilon(1.0_wp) !! part of the greatest rate of a joint: less is 0
   integer, parameter :: most_blows = 1000         !! of stops that close together

contains

   module procedure meet_stops
      real(wp), dimension(size(self%size_of_stop)) :: before, impulse, part
      integer :: touched(size(self%size_of_stop)), k, round
      real(wp) :: least, y_before(size(self%y))

      valid = .true.
      if (size(touched) == 0) return
      y_before = self%y
      associate (motion => self%motion)
         touched = motion%resting
         where (motion%place - motion%stops%low <= touching*self%size_of_stop) touched = side_low
         where (motion%stops%high - motion%place <= touching*self%size_of_stop) touched = side_high
         if (present(stop)) touched(stop) = side
         before = motion%pace
         least = still*maxval(abs(before))
         impulse = 0.0_wp
         do round = 1, most_blows
            part = merge(real(touched, wp)*motion%pace, 0.0_wp, touched /= side_none)
            k = maxloc(part, dim=1)
            if (.not. part(k) > least) exit
            call blow(self, k, merge(0.0_wp, motion%stops(k)%restitution, motion%resting(k) /= side_none), impulse(k))
         end do
         do k = 1, size(touched)
            if (.not. abs(impulse(k)) > 0.0_wp) cycle
            call self%note(event_t(self%time, event_impact, k, before(k), motion%pace(k), &
                                   impulse(k)/merge(motion%model%metre, 1.0_wp, motion%stops(k)%slides)))
         end do
         do k = 1, size(touched)
            if (motion%resting(k) == side_none .or. -real(touched(k), wp)*motion%pace(k) <= least) cycle
            call self%note(event_t(self%time, event_lift, k, 0.0_wp, motion%pace(k)))
            motion%resting(k) = side_none
         end do
      end associate
      if (any(abs(impulse) > 0.0_wp) .and. self%motion%rubs() > 0) then
         call choose_friction(self, valid)
      else
         call self%rates(self%time, self%y, self%first, valid)
      end if
      if (valid) call rest_on_stops(self, touched, least, valid)
      if (valid .and. any(abs(impulse) > 0.0_wp)) call note_jump(self, y_before)
   end procedure meet_stops

   !> Joints that touch a stop and are pressed to it rest if their bounces are over, or would be in next to no time.
   subroutine rest_on_stops(self, touched, least, valid)
      class(time_motion_t), intent(inout) :: self
      integer, intent(in) :: touched(:)               !! by stop: side
      real(wp), intent(in) :: least                   !! rate that counts as 0
      logical, intent(out) :: valid
      real(wp) :: away, toward, bounces, impulse, rate
      integer :: k

      valid = .true.
      do k = 1, size(touched)
         associate (motion => self%motion, stop => self%motion%stops(k))
            if (touched(k) == side_none .or. motion%resting(k) /= side_none) cycle
            away = -real(touched(k), wp)*motion%pace(k)
            toward = real(touched(k), wp)*motion%growth(k)
            if (.not. toward > 0.0_wp) cycle
            bounces = 0.0_wp
            if (away > least) then
               if (.not. 2.0_wp*away < last_bounces*self%end*toward*(1.0_wp - stop%restitution)) cycle
               bounces = 2.0_wp*away/(toward*(1.0_wp - stop%restitution))
            end if
            rate = motion%pace(k)
            call blow(self, k, 0.0_wp, impulse)
            motion%resting(k) = touched(k)
            call self%note(event_t(self%time + bounces, event_rest, k, rate))
         end associate
         call self%settle()
         call self%rates(self%time, self%y, self%first, valid)
         if (.not. valid) return
      end do
   end subroutine rest_on_stops

   !> Keep the rates of all drives before impacts, when the unknowns were `y_before`, and after them.
   subroutine note_jump(self, y_before)
      class(time_motion_t), intent(inout) :: self
      real(wp), intent(in) :: y_before(:)
      type(free_state_t) :: before, after
      real(wp) :: y(size(self%y))
      real(wp), allocatable :: more(:, :)

      y = self%y
      self%y = y_before
      call self%observe(before)
      self%y = y
      call self%observe(after)
      if (self%jumped == size(self%jumps, 2)) then
         allocate (more(size(self%jumps, 1), 2*self%jumped + 1), source=0.0_wp)
         more(:, :self%jumped) = self%jumps
         call move_alloc(more, self%jumps)
      end if
      self%jumped = self%jumped + 1
      if (allocated(after%named)) then
         self%jumps(:, self%jumped) = [self%time, self%begun + after%named(:, 0), before%named(:, 1), after%named(:, 1)]
      else
         self%jumps(:, self%jumped) = [self%time, after%input, before%rate, after%rate]
      end if
   end subroutine note_jump

   !> A stop changes the rate of its joint: to minus `restitution` times that. What the drives that are not free give is work.
   subroutine blow(self, stop, restitution, impulse)
      class(time_motion_t), intent(inout) :: self
      integer, intent(in) :: stop
      real(wp), intent(in) :: restitution
      real(wp), intent(inout) :: impulse              !! N m s, N s times metre: it is added
      real(wp) :: change(size(self%size_of)), loosened(size(self%size_of)), yields, own
      integer :: f, d, k

      f = size(self%size_of)
      associate (motion => self%motion)
         loosened = motion%loosen(stop)
         yields = dot_product(motion%normal(stop, motion%free), loosened)
         if (.not. yields > 0.0_wp) return
         own = -(1.0_wp + restitution)*motion%pace(stop)/yields
         change = loosened*own
         self%y(2*f + 2) = self%y(2*f + 2) + (1.0_wp - restitution**2)*motion%pace(stop)**2/(2.0_wp*yields)
         do d = 1, size(motion%leader)
            if (motion%leader(d) /= d .or. any(motion%free == d)) cycle
            self%y(2*f + 1) = self%y(2*f + 1) + (dot_product(motion%inertia(d, :), change) - own*motion%normal(stop, d))* &
                              (motion%speed(d) + motion%accel(d)*self%time)
         end do
         self%y(f + 1:2*f) = self%y(f + 1:2*f) + change
         do k = 1, size(motion%pace)
            motion%pace(k) = motion%pace(k) + dot_product(motion%normal(k, motion%free), change)
         end do
      end associate
      impulse = impulse + own
   end subroutine blow
end submodule psalm_time_stops_body
