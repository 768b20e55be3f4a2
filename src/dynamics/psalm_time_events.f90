!> Events in a step of a motion in time: a joint comes to its stop, or leaves it; one with friction stops, or comes loose; a table
!> or a spring has a kink; a change point is passed.
module psalm_time_events
   use psalm_free_motion, only: free_motion_t
   use psalm_joint_stops, only: side_none, side_low, side_high
   use psalm_kinds, only: wp, full_turn
   implicit none (type, external)
   private
   public :: marks_t, passage_t, crossings_of, value_of
   public :: rub_none, rub_stops, rub_slips, rub_kink, table_change

   integer, parameter :: samples = 32                 !! of a step, in which a joint may reach its stop and leave it again
   real(wp), parameter :: near_zero = 1.0e-9_wp       !! part of the force at the end of a step: less at its beginning is 0
   real(wp), parameter :: on_kink = 1.0e-11_wp        !! part of the span of a table: so near a kink it is there

   integer, parameter :: rub_none = 0, rub_stops = 1, rub_slips = 2, rub_kink = 3 !! a joint with friction comes to rest; friction
                                                   !! no longer holds it; the force that makes friction changes its sign

   !> What events are known by at a moment.
   type :: marks_t
      real(wp), allocatable :: place(:), pace(:), growth(:), push(:) !! by stop, as `free_motion_t` has them
      real(wp), allocatable :: spare(:)               !! by stop: what friction could hold beyond what it does
      real(wp), allocatable :: still(:)               !! by stop: rate of its joint that is none, where it slips
      real(wp), allocatable :: parts(:, :)            !! by joint with friction: what it grows with
      real(wp), allocatable :: stretch(:)             !! by spring that has kinks
      real(wp) :: input = 0.0_wp, speed = 0.0_wp      !! of the first drive: degrees or length as tables count them; by time
      real(wp) :: at = 0.0_wp                         !! the free drive, if there is one
   end type marks_t

   !> Something that has a positive value until it happens.
   type :: passage_t
      integer :: stop = 0, side = side_none
      logical :: lifts = .false.                      !! the value is the force of the stop, else the way to it
      integer :: rub = rub_none                       !! `rub_...`
      integer :: part = 0                             !! `rub_kink`: which
      integer :: table = 0                            !! `kink_...`, 0: no table
      integer :: spring = 0                           !! `kink_stretch`: which of those that have kinks
      real(wp) :: kink = 0.0_wp, sense = 1.0_wp       !! the value is sense times what is left to the kink
      real(wp) :: within = 0.0_wp                     !! s: by then its value is negative
      real(wp) :: at_first = 0.0_wp                   !! value at the beginning of the step
      logical :: rises = .false.                      !! which is 0 but for rounding
   end type passage_t

   integer, parameter :: kink_input = 1, kink_speed = 2, kink_stretch = 3, table_change = 4 !! the last is no table:
                                                   !! a change point
   real(wp), parameter :: on_change = 1.0e-12_wp   !! radians, or parts of the size: so near a change point it is there

contains

   !> Everything that happens in a step, in no order.
   function crossings_of(motion, before, after, h) result(crossings)
      type(free_motion_t), intent(in) :: motion
      type(marks_t), intent(in) :: before, after
      real(wp), intent(in) :: h                       !! s
      type(passage_t), allocatable :: crossings(:)
      type(passage_t) :: one
      integer :: k, side

      allocate (crossings(0))
      do k = 1, size(motion%stops)
         do side = side_low, side_high, side_high - side_low
            one = passage_t(stop=k, side=side, within=h)
            if (motion%resting(k) == side) then
               one%lifts = .true.
               if (value_of(motion, one, after) < 0.0_wp) call add()
               exit
            else if (motion%resting(k) /= side_none) then
               cycle
            end if
            if (limit_of(motion, one) >= huge(1.0_wp)) cycle
            if (value_of(motion, one, after) >= 0.0_wp) one%within = lowest_within()
            if (one%within > 0.0_wp) call add()
         end do
      end do
      do k = motion%smooth + 1, motion%smooth + motion%rubs()
         one = passage_t(stop=k, within=h, rub=merge(rub_slips, rub_stops, motion%stuck(k)))
         if (.not. motion%engaged(k - motion%smooth)) cycle
         if (value_of(motion, one, after) < merge(0.0_wp, -after%still(k), motion%stuck(k))) call add()
         if (motion%stuck(k) .or. .not. motion%stops(k)%slides) cycle
         do side = 1, 2
            associate (from => before%parts(side, k - motion%smooth), to => after%parts(side, k - motion%smooth))
               if (.not. (from*to < 0.0_wp .and. abs(from) > near_zero*abs(to))) cycle
               one = passage_t(stop=k, within=h, rub=rub_kink, part=side, sense=sign(1.0_wp, from))
               call add()
            end associate
         end do
      end do
      if (any(motion%loads%loads%table > 0) .and. .not. motion%model%timed) &
         call find_kink(motion%model%table_input, .not. motion%slides(1), before%input, after%input, kink_input)
      if (motion%driven) call find_kink(motion%motor%speed, .false., before%speed, after%speed, kink_speed)
      do k = 1, size(motion%kinked)
         call find_kink(motion%model%springs(motion%kinked(k))%kinks(motion%model%metre), .false., before%stretch(k), &
                        after%stretch(k), kink_stretch)
      end do
      if (allocated(motion%passing)) call find_change()

   contains

      !> The change point, if it is passed.
      subroutine find_change()
         associate (centre => motion%passing%centre)
            one = passage_t(table=table_change, kink=centre, sense=sign(1.0_wp, after%at - before%at), within=h)
            if (one%sense*(centre - before%at) <= on_change*motion%passing%path%size) return
            if (one%sense*(after%at - centre) <= 0.0_wp) return
            call add()
         end associate
      end subroutine find_change

      subroutine add()
         one%at_first = value_of(motion, one, before)
         one%rises = .not. one%at_first > 0.0_wp
         crossings = [crossings, one]
      end subroutine add

      !> Where the way to the stop, a polynomial by places, rates and accelerations at both ends, is negative; 0: nowhere.
      real(wp) function lowest_within() result(within)
         real(wp) :: way, least, s, r
         integer :: i

         within = 0.0_wp
         least = 0.0_wp
         do i = 1, samples - 1
            s = real(i, wp)/real(samples, wp)
            r = 1.0_wp - s
            way = r**3*(before%place(k)*(1.0_wp + 3.0_wp*s + 6.0_wp*s**2) + h*before%pace(k)*s*(1.0_wp + 3.0_wp*s) + &
                        0.5_wp*h**2*before%growth(k)*s**2) + &
                  s**3*(after%place(k)*(1.0_wp + 3.0_wp*r + 6.0_wp*r**2) - h*after%pace(k)*r*(1.0_wp + 3.0_wp*r) + &
                        0.5_wp*h**2*after%growth(k)*r**2)
            way = real(side, wp)*(merge(motion%stops(k)%high, motion%stops(k)%low, side == side_high) - way)
            if (way >= least) cycle
            least = way
            within = s*h
         end do
      end function lowest_within

      !> The first row of a table that is passed.
      subroutine find_kink(rows, turning, from, to, table)
         real(wp), intent(in) :: rows(:), from, to
         logical, intent(in) :: turning                !! it goes on round the turn
         integer, intent(in) :: table
         real(wp) :: near
         integer :: i

         if (size(rows) == 0) return
         near = on_kink*max(maxval(abs(rows)), abs(from), abs(to), merge(full_turn, 0.0_wp, turning))
         if (abs(to - from) <= near) return
         one = passage_t(table=table, spring=k, kink=huge(1.0_wp), sense=sign(1.0_wp, to - from), within=h)
         do i = 1, size(rows)
            one%kink = min(one%kink, next_above(one%sense*rows(i), one%sense*from + near, turning))
         end do
         if (one%kink >= one%sense*to) return
         one%kink = one%sense*one%kink
         call add()
      end subroutine find_kink
   end function crossings_of

   !> The least of a row of a table and, round the turn, its repetitions that is above a value; huge: there is none.
   pure real(wp) function next_above(row, value, turning)
      real(wp), intent(in) :: row, value
      logical, intent(in) :: turning

      next_above = row
      if (turning) then
         next_above = row + full_turn*real(floor((value - row)/full_turn) + 1, wp)
      else if (row <= value) then
         next_above = huge(1.0_wp)
      end if
   end function next_above

   !> What is positive until something happens.
   pure real(wp) function value_of(motion, crossing, marks)
      type(free_motion_t), intent(in) :: motion
      type(passage_t), intent(in) :: crossing
      type(marks_t), intent(in) :: marks

      if (crossing%rub == rub_stops) then
         value_of = motion%sense_of_slip(crossing%stop)*marks%pace(crossing%stop)
      else if (crossing%rub == rub_slips) then
         value_of = marks%spare(crossing%stop)
      else if (crossing%rub == rub_kink) then
         value_of = crossing%sense*marks%parts(crossing%part, crossing%stop - motion%smooth)
      else if (crossing%table == kink_input) then
         value_of = crossing%sense*(crossing%kink - marks%input)
      else if (crossing%table == kink_speed) then
         value_of = crossing%sense*(crossing%kink - marks%speed)
      else if (crossing%table == kink_stretch) then
         value_of = crossing%sense*(crossing%kink - marks%stretch(crossing%spring))
      else if (crossing%table == table_change) then
         value_of = crossing%sense*(crossing%kink - marks%at)
      else if (crossing%lifts) then
         value_of = -real(crossing%side, wp)*marks%push(crossing%stop)
      else
         value_of = limit_of(motion, crossing) - real(crossing%side, wp)*marks%place(crossing%stop)
      end if
   end function value_of

   !> Place of a stop, times its side: huge where there is none.
   pure real(wp) function limit_of(motion, crossing)
      type(free_motion_t), intent(in) :: motion
      type(passage_t), intent(in) :: crossing

      limit_of = motion%stops(crossing%stop)%high
      if (crossing%side == side_low) limit_of = -motion%stops(crossing%stop)%low
   end function limit_of
end module psalm_time_events
