!> Which joints with friction are held by it in a motion in time, and which way the others slip.
submodule(psalm_time_motion) psalm_time_friction_body
   implicit none (type, external)

contains

   module procedure choose_friction
      logical, allocatable :: still_there(:), was(:), own(:)
      integer :: k

      valid = .true.
      if (self%motion%rubs() == 0) return
      associate (motion => self%motion)
         was = motion%stuck
         allocate (still_there(size(was)), own(size(was)), source=.false.)
         do k = motion%smooth + 1, motion%smooth + motion%rubs()
            self%fastest(k) = max(self%fastest(k), abs(motion%pace(k)))
            still_there(k) = motion%engaged(k - motion%smooth) .and. abs(motion%pace(k)) <= nothing*self%fastest(k)
            if (present(joint)) still_there(k) = still_there(k) .or. k == joint
            if (.not. still_there(k) .and. abs(motion%pace(k)) > 0.0_wp) &
               motion%sense_of_slip(k) = sign(1.0_wp, motion%pace(k))
         end do
         ! what one free drive moves turns back by itself where the rest goes on
         if (size(motion%free) == 1) then
            do k = motion%smooth + 1, motion%smooth + motion%rubs()
               own(k) = still_there(k) .and. abs(self%y(2)) > nothing*self%largest(2) .and. abs(motion%growth(k)) > &
                        nothing*motion%freely(k)
               if (own(k)) motion%sense_of_slip(k) = sign(1.0_wp, motion%growth(k))
            end do
            still_there = still_there .and. .not. own
         end if
         motion%stuck = still_there
         where (still_there .and. .not. was) motion%stuck_at = motion%place
         call let_go(valid)
         if (.not. valid) call try_all(valid)
         if (.not. valid) return
         do k = motion%smooth + 1, motion%smooth + motion%rubs()
            if (motion%stuck(k) .and. .not. was(k)) call self%note(event_t(time=self%time, kind=event_stick, stop=k))
            if (was(k) .and. .not. motion%stuck(k)) call self%note(event_t(time=self%time, kind=event_slip, stop=k))
         end do
         if (any(motion%stuck)) then
            call self%settle()
            call self%rates(self%time, self%y, self%first, valid)
         end if
      end associate

   contains

      !> Let joints go until friction can hold the others. `agrees` is false where the state does not agree with itself then.
      subroutine let_go(agrees)
         logical, intent(out) :: agrees
         real(wp) :: excess(size(was))
         integer :: round, i

         associate (motion => self%motion)
            if (present(slips)) then
               if (slips) call release(joint)
            end if
            do round = 1, size(was) + 1
               call self%rates(self%time, self%y, self%first, agrees)
               if (.not. agrees) return
               excess = 0.0_wp
               do i = motion%smooth + 1, motion%smooth + motion%rubs()
                  if (.not. motion%stuck(i)) cycle
                  excess(i) = abs(motion%push(i)) - motion%most_held(i)*(1.0_wp + within)
                  if (.not. abs(motion%push(i)) > 0.0_wp .and. abs(motion%growth(i)) > nothing*motion%freely(i)) &
                     excess(i) = huge(1.0_wp)
               end do
               i = maxloc(excess, dim=1)
               if (.not. excess(i) > 0.0_wp) exit
               call release(i)
            end do
            agrees = agreed()
         end associate
      end subroutine let_go

      !> Whether joints at rest that slip begin to move the way that they are thought to, and friction holds the others.
      logical function agreed()
         integer :: i

         associate (motion => self%motion)
            agreed = .true.
            do i = motion%smooth + 1, motion%smooth + motion%rubs()
               if (motion%stuck(i)) then
                  agreed = agreed .and. abs(motion%push(i)) <= motion%most_held(i)*(1.0_wp + within)
                  agreed = agreed .and. (abs(motion%growth(i)) <= nothing*motion%freely(i) .or. abs(motion%push(i)) > 0.0_wp)
               else if (still_there(i)) then
                  agreed = agreed .and. motion%sense_of_slip(i)*motion%growth(i) >= -nothing*motion%freely(i)
               end if
            end do
         end associate
      end function agreed

      !> Try every state of the joints at rest: stuck, or slipping one way or the other; with one free drive all are one.
      subroutine try_all(found)
         logical, intent(out) :: found
         integer, parameter :: most = 8
         integer :: at_rest(size(was)), n, digits, code, rest, i
         logical :: there, together

         found = .false.
         n = 0
         do i = 1, size(was)
            if (.not. still_there(i)) cycle
            n = n + 1
            at_rest(n) = i
         end do
         if (n == 0) return
         if (n > most) return
         associate (motion => self%motion)
            together = size(motion%free) == 1
            digits = merge(min(n, 1), n, together)
            do code = 0, 3**digits - 1
               rest = code
               do i = 1, n
                  associate (k => at_rest(i), state => modulo(rest, 3))
                     motion%stuck(k) = state == 0
                     if (state > 0) motion%sense_of_slip(k) = real(3 - 2*state, wp)
                     if (state > 0 .and. together) motion%sense_of_slip(k) = motion%sense_of_slip(k)* &
                                                                              sign(1.0_wp, motion%normal(k, motion%free(1)))
                  end associate
                  if (.not. together) rest = rest/3
               end do
               call self%rates(self%time, self%y, self%first, there)
               if (.not. there) cycle
               found = agreed()
               if (found) return
            end do
            motion%jammed = at_rest(1)
         end associate
      end subroutine try_all

      !> Let a joint slip the way that what holds it keeps it from; with one free drive all that are at rest slip.
      subroutine release(k)
         integer, intent(in) :: k
         integer :: i

         associate (motion => self%motion)
            do i = motion%smooth + 1, motion%smooth + motion%rubs()
               if (.not. motion%stuck(i)) cycle
               if (i /= k .and. size(motion%free) > 1) cycle
               motion%stuck(i) = .false.
               if (abs(motion%push(i)) > 0.0_wp) then
                  motion%sense_of_slip(i) = -sign(1.0_wp, motion%push(i))
               else
                  motion%sense_of_slip(i) = sign(1.0_wp, motion%growth(i))
               end if
               motion%push(i) = 0.0_wp
            end do
         end associate
      end subroutine release
   end procedure choose_friction
end submodule psalm_time_friction_body
