!> Change points of a motion in time: that ahead, and one that was passed without being found.
submodule(psalm_time_motion) psalm_time_change_body
   implicit none (type, external)

   real(wp), parameter :: looked_ahead = 0.2_wp    !! radians, or parts of the size: change points are looked for so far ahead,
   real(wp), parameter :: steps_ahead = 2.0_wp     !! or as far as so many steps lead
   real(wp), parameter :: looked_back = 1.0e-3_wp  !! where there has been no step
   real(wp), parameter :: folds_below = 1.0e-3_wp  !! sine of a dyad beside a change point that it passes,
   real(wp), parameter :: folds_like = 0.1_wp      !! and part of its change by which it may be off what it was to be
   real(wp), parameter :: short_of = 0.9_wp        !! part of the way to where one might be: if none was found no step goes farther

contains

   module procedure watch_folds
      real(wp), allocatable :: now(:)
      real(wp) :: slope, through
      integer :: loop

      if (self%motion%beside_change()) then
         if (allocated(self%sines)) deallocate (self%sines)
         return
      end if
      now = abs(self%motion%pivots())
      if (.not. allocated(self%sines)) then
         self%sines = spread(now, 2, 2)
         self%sines_at = self%time
         return
      end if
      associate (first => self%sines(:, 1), last => self%sines(:, 2), steps => [self%sines_at(2) - self%sines_at(1), &
                                                                                 self%time - self%sines_at(2)])
         do loop = 1, size(now)
            if (.not. (last(loop) < first(loop) .and. last(loop) < now(loop) .and. last(loop) < folds_below .and. &
                       steps(1) > 0.0_wp)) cycle
            slope = (last(loop) - first(loop))/steps(1)
            through = last(loop) + slope*steps(2)
            if (abs(through + now(loop)) < folds_like*abs(through - now(loop)) .and. self%folded == 0) self%folded = loop
         end do
      end associate
      self%sines(:, 1) = self%sines(:, 2)
      self%sines(:, 2) = now
      self%sines_at = [self%sines_at(2), self%time]
   end procedure watch_folds

   module procedure look_ahead
      real(wp), allocatable :: now(:)
      real(wp) :: there, direction, way, far, ahead, least, before(2)
      integer :: loop, nearest
      logical :: found

      valid = .true.
      self%unseen = huge(1.0_wp)
      if (.not. self%motion%may_change()) return
      associate (f => size(self%size_of), motion => self%motion, size_of => self%size_of(1))
         there = self%y(1)
         if (allocated(motion%passing)) then
            ! what was before it says nothing here
            if ((motion%passing%centre - there)*(motion%passing%centre - self%pivots_at) < 0.0_wp .or. motion%beside_change()) then
               if (allocated(self%pivots)) deallocate (self%pivots)
            end if
         end if
         if (motion%beside_change() .or. .not. abs(self%y(f + 1)) > 0.0_wp) return
         direction = sign(1.0_wp, self%y(f + 1))
         now = motion%pivots()
         before = self%y(:2)
         if (.not. allocated(self%pivots)) then
            self%pivots_at = there - looked_back*size_of*direction
            before(1) = self%pivots_at
            call self%rates(self%time, [before, self%y(3:)], self%first, valid)
            if (valid .and. .not. motion%beside_change()) self%pivots = motion%pivots()
            call self%rates(self%time, self%y, self%first, valid)
            if (.not. allocated(self%pivots)) return
         end if
         way = direction*(there - self%pivots_at)
         nearest = 0
         far = steps_ahead*max(way, abs(self%y(f + 1))*self%step)
         least = max(looked_ahead*size_of, far)
         if (way > 0.0_wp) then
            do loop = 1, size(now)
               if (.not. abs(now(loop)) < abs(self%pivots(loop))) cycle
               ahead = way*abs(now(loop))/(abs(self%pivots(loop)) - abs(now(loop)))
               if (ahead > least) cycle
               least = ahead
               nearest = loop
            end do
         end if
         self%pivots = now
         self%pivots_at = there
         if (nearest > 0 .and. allocated(motion%passing)) then
            if (motion%passing%holds(there + least*direction)) nearest = 0
         end if
         if (nearest == 0) then
            self%failed = huge(1.0_wp)
            self%open_ahead = .true.
            return
         end if
         if (.not. (least > 0.5_wp*self%failed .and. least > far)) then
            call motion%find_change(nearest, there + least*direction, direction, size_of, found, self%open_ahead)
            self%failed = least
            if (found) then
               self%failed = huge(1.0_wp)
               self%open_ahead = .true.
               self%gap = max(self%gap, motion%passing%gap)
            end if
            call self%rates(self%time, self%y, self%first, valid)
         end if
         if (.not. self%open_ahead) self%unseen = short_of*least/abs(self%y(f + 1))
      end associate
   end procedure look_ahead
end submodule psalm_time_change_body
