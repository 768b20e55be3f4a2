!> The law of a cam: a function of the cam's angle over one turn, made of pieces, with five derivatives.
!>
!> A piece is a polynomial, or a quarter wave of acceleration. Sines are those of `psalm_angles`, the same on every processor.
!> Source: Oldham (1977), 9.3.2, with the seven zones of any trigonometric law in one formula; derivation in doc/theory/cams.md.
module psalm_cam_law
   use psalm_angles, only: unit_vector
   use psalm_cam_data, only: cam_group_t, fit_least_squares, most_pieces
   use psalm_cam_kind, only: law_dwell, law_ramp, law_poly345, law_poly4567, law_poly, has_zones, zone_count
   use psalm_kinds, only: wp, full_turn, radians_per_degree, right_angle
   use psalm_periodic_spline, only: periodic_spline, quintic_hermite, septic_hermite
   use psalm_spline_fit, only: fit_spline
   implicit none (type, external)
   private
   public :: law_t, law_joint_t, make_law, highest_law_order
   public :: law_made, law_velocity_jumps, law_singular, law_jerk_jumps, law_points_missing, law_beyond_tolerance

   integer, parameter :: highest_law_order = 5, highest_power = 7
   integer, parameter :: cells = 64                  !! of a piece, where extremes of a polynomial are looked for
   integer, parameter :: bisections = 60
   real(wp), parameter :: settled = 1.0e-10_wp       !! relative jump that is rounding

   integer, parameter :: law_made = 0, law_velocity_jumps = 1, law_singular = 2, law_jerk_jumps = 3 !! how the making ended
   integer, parameter :: law_points_missing = 4 !! a table has too few points for the pieces of its fit
   integer, parameter :: law_beyond_tolerance = 5         !! the fit does not stay within TABTOL

   integer, parameter :: wave_polynomial = 0, wave_up = 1, wave_down = 2

   !> One piece; whole, in u = 0 ... 1.
   type :: piece_t
      real(wp) :: start = 0.0_wp, width = 0.0_wp     !! degrees
      real(wp) :: before = 0.0_wp, after = 0.0_wp    !! degrees cut off: u counts from start - before
      integer :: wave = wave_polynomial
      real(wp) :: c(0:highest_power) = 0.0_wp        !! by powers of u; of a wave: value, slope, amplitude of its acceleration by u
      integer :: segment = 0
   end type piece_t

   !> What a segment does. Peaks are normalised: times T**k/lift; 0 for a dwell.
   type :: law_segment_t
      real(wp) :: start = 0.0_wp, finish = 0.0_wp    !! degrees
      real(wp) :: from = 0.0_wp, to = 0.0_wp         !! output there
      real(wp) :: peak(3) = 0.0_wp                   !! of velocity, acceleration, jerk
      logical :: steps = .false.                     !! the acceleration jumps within the segment
   end type law_segment_t

   !> Jumps at the beginning of a piece, in the user's unit by radians of cam: orders 0 to 3.
   type :: law_joint_t
      real(wp) :: at = 0.0_wp                        !! degrees
      real(wp) :: jump(0:3) = 0.0_wp
   end type law_joint_t

   type :: law_t
      type(piece_t), allocatable :: pieces(:)
      type(law_segment_t), allocatable :: segments(:)
      integer :: state = law_made
      integer :: faulty = 0                          !! segment that cannot be made, or at whose end the velocity jumps
      real(wp) :: lag = 0.0_wp, inertia = 0.0_wp     !! flexible drive: the law is y + lag y' + inertia y''
      real(wp) :: residual = 0.0_wp, mean_residual = 0.0_wp !! of a table: largest, and root of the mean square
   contains
      procedure :: evaluate
      procedure :: evaluate_from_rest
      procedure :: piece_at
      procedure :: joints
      procedure :: greatest
      procedure :: cut_at
   end type law_t

contains

   !> Make the law of a group. `law%state` says whether it could be made.
   subroutine make_law(cam, law)
      type(cam_group_t), intent(in) :: cam
      type(law_t), intent(out) :: law
      type(law_joint_t), allocatable :: joints(:)
      integer :: k

      allocate (law%pieces(0))
      if (size(cam%table) > 0) then
         call add_table(cam, law)
      else
         call add_segments(cam, law)
      end if
      if (law%state /= law_made) return
      allocate (joints(size(law%pieces)))
      call find_jumps(law_velocity_jumps)
      if (law%state /= law_made .or. .not. cam%frequency > 0.0_wp) return
      law%lag = 2.0_wp*cam%damping/cam%frequency
      law%inertia = 1.0_wp/cam%frequency**2
      call find_jumps(law_jerk_jumps)

   contains

      subroutine find_jumps(state)
         integer, intent(in) :: state
         real(wp) :: rounding(0:1)

         joints = law%joints()
         rounding = settled*[law%greatest(0), law%greatest(1)]
         do k = merge(2, 1, cam%slides), size(joints)
            if (all(abs(joints(k)%jump(:1)) <= rounding)) cycle
            law%state = state
            law%faulty = law%pieces(modulo(k - 2, size(joints)) + 1)%segment
         end do
      end subroutine find_jumps
   end subroutine make_law

   subroutine add_table(cam, law)
      type(cam_group_t), intent(in) :: cam
      type(law_t), intent(inout) :: law
      real(wp), allocatable :: c(:, :), at(:)
      type(piece_t) :: piece
      logical :: found
      integer :: k, n

      n = size(cam%table)
      allocate (law%segments(1))
      law%segments(1)%finish = full_turn
      law%segments(1)%from = cam%table(1)
      law%segments(1)%to = cam%table(1)
      law%faulty = 1
      if (cam%fit == fit_least_squares) then
         call fit_table(cam, law, c)
         if (law%state /= law_made) return
         n = size(c, 2)
         at = [(full_turn*real(k - 1, wp)/real(n, wp), k=1, n)]
      else
         call periodic_spline(cam%table_at, cam%table, full_turn, cam%degree, cam%table_tolerance, c, found)
         if (.not. found) then
            law%state = law_singular
            return
         end if
         at = cam%table_at
      end if
      law%faulty = 0
      deallocate (law%pieces)
      allocate (law%pieces(n))
      do k = 1, n
         piece%start = at(k)
         piece%width = full_turn - piece%start
         if (k < n) piece%width = at(k + 1) - piece%start
         piece%c(0:cam%degree) = c(:, k)
         piece%segment = 1
         law%pieces(k) = piece
      end do
      call find_residuals(cam, law)
   end subroutine add_table

   !> The fit by least squares of as many pieces as are wanted, or of the fewest that stay within the tolerance.
   subroutine fit_table(cam, law, c)
      type(cam_group_t), intent(in) :: cam
      type(law_t), intent(inout) :: law
      real(wp), allocatable, intent(out) :: c(:, :)
      type(law_t) :: trial
      integer :: m, k, first, last
      logical :: found, once

      first = cam%pieces
      last = cam%pieces
      if (cam%pieces == 0) then
         first = cam%degree + 1
         last = min(size(cam%table), most_pieces)
      end if
      once = .false.
      do m = first, last
         if (allocated(c)) deallocate (c)
         allocate (c(0:cam%degree, m))
         call fit_spline(cam%table_at, cam%table, cam%weight, full_turn, cam%degree, &
                         [cam%most_velocity*radians_per_degree, cam%most_acceleration*radians_per_degree**2], c, found)
         if (.not. found) exit
         allocate (trial%pieces(m))
         do k = 1, m
            trial%pieces(k) = piece_t(start=full_turn*real(k - 1, wp)/real(m, wp), width=full_turn/real(m, wp))
            trial%pieces(k)%c(0:cam%degree) = c(:, k)
         end do
         call find_residuals(cam, trial)
         deallocate (trial%pieces)
         if (.not. once .or. trial%residual < law%residual) law%residual = trial%residual
         once = .true.
         if (.not. cam%table_tolerance > 0.0_wp .or. trial%residual <= cam%table_tolerance) return
      end do
      law%state = merge(law_beyond_tolerance, law_points_missing, once)
   end subroutine fit_table

   !> How far a table's points are from the law.
   subroutine find_residuals(cam, law)
      type(cam_group_t), intent(in) :: cam
      type(law_t), intent(inout) :: law
      real(wp) :: miss(size(cam%table)), y(0:highest_law_order)
      integer :: k

      do k = 1, size(miss)
         y = law%evaluate(cam%table_at(k), law%piece_at(cam%table_at(k)))
         miss(k) = y(0) - cam%table(k)
      end do
      law%residual = maxval(abs(miss), cam%weight > 0.0_wp)
      law%mean_residual = sqrt(sum(miss**2, cam%weight > 0.0_wp)/real(count(cam%weight > 0.0_wp), wp))
   end subroutine find_residuals

   subroutine add_segments(cam, law)
      type(cam_group_t), intent(in) :: cam
      type(law_t), intent(inout) :: law
      real(wp) :: speed(0:size(cam%finish)), accel(0:size(cam%finish)), jerk(0:size(cam%finish))
      real(wp) :: width, t
      type(piece_t) :: piece
      integer :: k, n, before, first

      n = size(cam%finish)
      allocate (law%segments(n))
      law%segments%finish = cam%finish
      law%segments%to = cam%output
      law%segments%start = [0.0_wp, cam%finish(:n - 1)]
      law%segments%from = [cam%start, cam%output(:n - 1)]
      speed(1:) = cam%velocity
      accel(1:) = cam%acceleration
      jerk(1:) = cam%jerk
      ! beside a ramp the velocity is the ramp's
      do k = 1, n
         if (cam%law(k) /= law_ramp) cycle
         associate (s => law%segments(k))
            speed(k) = (s%to - s%from)/((s%finish - s%start)*radians_per_degree)
            before = modulo(k - 2, n) + 1
            if (cam%slides .and. k == 1) cycle
            if (cam%law(before) /= law_ramp) speed(before) = speed(k)
         end associate
      end do
      speed(0) = speed(n)
      accel(0) = accel(n)
      jerk(0) = jerk(n)
      if (cam%slides) then
         ! nothing goes before the beginning
         speed(0) = 0.0_wp
         accel(0) = 0.0_wp
         jerk(0) = 0.0_wp
      end if
      do k = 1, n
         associate (s => law%segments(k))
            width = s%finish - s%start
            t = width*radians_per_degree
            first = size(law%pieces) + 1
            piece = piece_t(start=s%start, width=width, segment=k)
            if (has_zones(cam%law(k))) then
               call add_zones(s, cam%zones(:, k), k, speed(k - 1), speed(k), law)
               if (law%state /= law_made) return
            else
               select case (cam%law(k))
               case (law_dwell)
                  piece%c(0) = s%from
                  piece%c(1) = s%to - s%from
               case (law_ramp)
                  piece%c(0) = s%from
                  piece%c(1) = s%to - s%from
               case (law_poly345)
                  piece%c(0:5) = quintic_hermite(s%from, t*speed(k - 1), 0.0_wp, s%to, t*speed(k), 0.0_wp)
               case (law_poly4567)
                  piece%c = septic_hermite(s%from, t*speed(k - 1), 0.0_wp, 0.0_wp, s%to, t*speed(k), 0.0_wp, 0.0_wp)
               case (law_poly)
                  if (cam%jerks) then
                     piece%c = septic_hermite(s%from, t*speed(k - 1), t**2*accel(k - 1), t**3*jerk(k - 1), s%to, t*speed(k), &
                                              t**2*accel(k), t**3*jerk(k))
                  else
                     piece%c(0:5) = quintic_hermite(s%from, t*speed(k - 1), t**2*accel(k - 1), s%to, t*speed(k), t**2*accel(k))
                  end if
               end select
               law%pieces = [law%pieces, piece]
            end if
            call note_peaks(law, first, s)
         end associate
      end do
   end subroutine add_segments

   !> The zones of a segment. Displacement and velocity at its end are linear in the two peaks of acceleration.
   subroutine add_zones(s, zones, segment, v0, v1, law)
      type(law_segment_t), intent(in) :: s
      real(wp), intent(in) :: zones(zone_count)
      integer, intent(in) :: segment
      real(wp), intent(in) :: v0, v1                 !! velocity at the ends, by radians
      type(law_t), intent(inout) :: law
      real(wp) :: d(zone_count), w(zone_count), t, first(2), second(2), rest(2), det, a(2), end_of(2), position, accel, dy(2)
      type(piece_t) :: piece
      integer :: k

      t = (s%finish - s%start)*radians_per_degree
      d = zones*t
      w = zones*(s%finish - s%start)
      call run([1.0_wp, 0.0_wp], first)
      call run([0.0_wp, 1.0_wp], second)
      rest = [s%to - s%from - v0*t, v1 - v0]
      det = first(1)*second(2) - second(1)*first(2)
      if (.not. abs(det) > 0.0_wp) then
         law%state = law_singular
         law%faulty = segment
         return
      end if
      a = [rest(1)*second(2) - second(1)*rest(2), first(1)*rest(2) - rest(1)*first(2)]/det
      end_of = [s%from, v0]
      position = s%start
      do k = 1, zone_count
         if (.not. d(k) > 0.0_wp) cycle
         piece = piece_t(start=position, width=w(k), segment=segment)
         accel = peak_of(k, a)
         piece%c(0) = end_of(1)
         piece%c(1) = end_of(2)*d(k)
         piece%c(2) = accel*d(k)**2
         select case (k)
         case (1, 5)
            piece%wave = wave_up
         case (3, 7)
            piece%wave = wave_down
         case default
            piece%c(2) = 0.5_wp*piece%c(2)
         end select
         law%pieces = [law%pieces, piece]
         dy = change(k, d(k), end_of(2), accel)
         end_of = end_of + dy
         position = position + w(k)
      end do

   contains

      !> Displacement and velocity gained from rest with the given peaks.
      pure subroutine run(peaks, gained)
         real(wp), intent(in) :: peaks(2)
         real(wp), intent(out) :: gained(2)
         integer :: i

         gained = 0.0_wp
         do i = 1, zone_count
            if (d(i) > 0.0_wp) gained = gained + change(i, d(i), gained(2), peak_of(i, peaks))
         end do
      end subroutine run

      pure real(wp) function peak_of(zone, peaks)
         integer, intent(in) :: zone
         real(wp), intent(in) :: peaks(2)

         peak_of = 0.0_wp
         if (zone < 4) peak_of = peaks(1)
         if (zone > 4) peak_of = -peaks(2)
      end function peak_of

      !> Displacement and velocity gained in a zone.
      pure function change(zone, width, v, accel) result(gained)
         integer, intent(in) :: zone
         real(wp), intent(in) :: width, v, accel
         real(wp) :: gained(2), w

         w = right_angle*radians_per_degree/width
         select case (zone)
         case (1, 5)
            gained = [v*width + accel*(width - 1.0_wp/w)/w, accel/w]
         case (3, 7)
            gained = [v*width + accel/w**2, accel/w]
         case default
            gained = [v*width + 0.5_wp*accel*width**2, accel*width]
         end select
      end function change
   end subroutine add_zones

   !> Derivatives of a piece by u at u, orders 0 to 5.
   pure function of_piece(piece, u) result(y)
      type(piece_t), intent(in) :: piece
      real(wp), intent(in) :: u
      real(wp) :: y(0:highest_law_order)
      real(wp), parameter :: w = right_angle*radians_per_degree  !! by u
      real(wp) :: c, s
      integer :: order, power
      real(wp) :: factor(0:highest_power)

      if (piece%wave == wave_polynomial) then
         factor = piece%c
         do order = 0, highest_law_order
            y(order) = 0.0_wp
            do power = highest_power, order, -1
               y(order) = y(order)*u + factor(power)
            end do
            ! of the next derivative
            do power = order + 1, highest_power
               factor(power) = factor(power)*real(power - order, wp)
            end do
         end do
         return
      end if
      call unit_vector(right_angle*u, c, s)
      associate (from => piece%c(0), v => piece%c(1), a => piece%c(2))
         if (piece%wave == wave_up) then
            y = [from + v*u + a*(u - s/w)/w, v + a*(1.0_wp - c)/w, a*s, a*w*c, -a*w**2*s, -a*w**3*c]
         else
            y = [from + v*u + a*(1.0_wp - c)/w**2, v + a*s/w, a*c, -a*w*s, -a*w**2*c, a*w**3*s]
         end if
      end associate
   end function of_piece

   !> The piece that an angle belongs to; at the joint of two, the later.
   elemental integer function piece_at(self, angle)
      class(law_t), intent(in) :: self
      real(wp), intent(in) :: angle    !! degrees, 0 <= angle < 360
      integer :: low, high, middle

      low = 1
      high = size(self%pieces)
      do while (low < high)
         middle = (low + high + 1)/2
         if (self%pieces(middle)%start <= angle) then
            low = middle
         else
            high = middle - 1
         end if
      end do
      piece_at = low
   end function piece_at

   !> Value and derivatives by radians of cam, orders 0 to 5, at an angle that belongs to a piece or is its end.
   pure function evaluate(self, angle, piece) result(y)
      class(law_t), intent(in) :: self
      real(wp), intent(in) :: angle              !! degrees
      integer, intent(in) :: piece
      real(wp) :: y(0:highest_law_order)
      real(wp) :: width
      integer :: order

      associate (p => self%pieces(piece))
         width = (p%before + p%width + p%after)*radians_per_degree
         y = of_piece(p, (angle - (p%start - p%before))/(p%before + p%width + p%after))
         do order = 1, highest_law_order
            y(order) = y(order)/width**order
         end do
      end associate
      if (self%inertia > 0.0_wp) then
         do order = 0, highest_law_order - 2
            y(order) = y(order) + self%lag*y(order + 1) + self%inertia*y(order + 2)
         end do
      end if
   end function evaluate

   !> The same beside an end of a piece at which the motion rests, none of its digits lost to the value there: the value is
   !> counted from the end, and the derivatives there vanish below the order `first`. The law of a rigid drive.
   pure function evaluate_from_rest(self, angle, piece, at_end, first) result(y)
      class(law_t), intent(in) :: self
      real(wp), intent(in) :: angle              !! degrees
      integer, intent(in) :: piece
      logical, intent(in) :: at_end              !! of the piece; else at its start
      integer, intent(in) :: first
      real(wp) :: y(0:highest_law_order)
      real(wp), parameter :: w = right_angle*radians_per_degree  !! by u
      type(piece_t) :: beside
      real(wp) :: u, c, s, binomial
      integer :: order, power

      associate (p => self%pieces(piece))
         u = (angle - p%start)/p%width
         if (at_end) u = (angle - (p%start + p%width))/p%width
         if (p%wave == wave_polynomial) then
            beside%c = p%c
            if (at_end) then
               beside%c = 0.0_wp
               do power = 0, highest_power
                  binomial = 1.0_wp
                  do order = 0, power
                     beside%c(order) = beside%c(order) + binomial*p%c(power)
                     binomial = binomial*real(power - order, wp)/real(order + 1, wp)
                  end do
               end do
            end if
            beside%c(:first - 1) = 0.0_wp
            y = of_piece(beside, u)
         else
            ! at rest with an acceleration: the beginning of a quarter cosine, or the end of a quarter sine
            call unit_vector(right_angle*u, c, s)
            associate (a => p%c(2))
               y = [0.0_wp, a*s/w, a*c, -a*w*s, -a*w**2*c, a*w**3*s]
               call unit_vector(0.5_wp*right_angle*u, c, s)
               y(0) = 2.0_wp*a*(s/w)**2
            end associate
         end if
         do order = 1, highest_law_order
            y(order) = y(order)/(p%width*radians_per_degree)**order
         end do
      end associate
   end function evaluate_from_rest

   !> Cut pieces in two at further angles; the motion stays the same.
   pure subroutine cut_at(self, angles)
      class(law_t), intent(inout) :: self
      real(wp), intent(in) :: angles(:)          !! degrees, 0 <= angle < 360
      type(piece_t) :: second
      integer :: i, k

      do i = 1, size(angles)
         k = self%piece_at(angles(i))
         second = self%pieces(k)
         if (.not. angles(i) > second%start) cycle
         second%before = second%before + (angles(i) - second%start)
         second%width = second%start + second%width - angles(i)
         second%start = angles(i)
         self%pieces(k)%after = self%pieces(k)%after + second%width
         self%pieces(k)%width = angles(i) - self%pieces(k)%start
         self%pieces = [self%pieces(:k), second, self%pieces(k + 1:)]
      end do
   end subroutine cut_at

   !> Jumps at the beginning of every piece.
   function joints(self) result(list)
      class(law_t), intent(in) :: self
      type(law_joint_t), allocatable :: list(:)
      real(wp) :: before(0:highest_law_order), after(0:highest_law_order)
      integer :: k, last

      allocate (list(size(self%pieces)))
      do k = 1, size(self%pieces)
         last = modulo(k - 2, size(self%pieces)) + 1
         before = self%evaluate(self%pieces(last)%start + self%pieces(last)%width, last)
         after = self%evaluate(self%pieces(k)%start, k)
         list(k)%at = self%pieces(k)%start
         list(k)%jump = after(:3) - before(:3)
      end do
   end function joints

   !> Greatest size of a derivative over the turn, at the ends and cells of the pieces.
   pure real(wp) function greatest(self, order)
      class(law_t), intent(in) :: self
      integer, intent(in) :: order
      real(wp) :: y(0:highest_law_order)
      integer :: k, i

      greatest = 0.0_wp
      do k = 1, size(self%pieces)
         do i = 0, cells
            y = self%evaluate(self%pieces(k)%start + self%pieces(k)%width*real(i, wp)/real(cells, wp), k)
            greatest = max(greatest, abs(y(order)))
         end do
      end do
   end function greatest

   !> Peaks of a segment whose pieces are the last ones, from `first` on.
   pure subroutine note_peaks(law, first, s)
      type(law_t), intent(in) :: law
      integer, intent(in) :: first
      type(law_segment_t), intent(inout) :: s
      real(wp) :: y(0:highest_law_order), before(0:highest_law_order), t, lift, largest
      integer :: order, k

      t = (s%finish - s%start)*radians_per_degree
      lift = abs(s%to - s%from)
      if (.not. lift > 0.0_wp) return
      largest = 0.0_wp
      do order = 1, 3
         do k = first, size(law%pieces)
            s%peak(order) = max(s%peak(order), peak_of_piece(law%pieces(k), order)*(t**order/lift))
         end do
      end do
      do k = first + 1, size(law%pieces)
         before = law%evaluate(law%pieces(k)%start, k - 1)
         y = law%evaluate(law%pieces(k)%start, k)
         s%steps = s%steps .or. abs(y(2) - before(2))*(t**2/lift) > settled*s%peak(2)
      end do
   end subroutine note_peaks

   !> Greatest size of a derivative of a piece, by radians: at its ends, and where the next derivative vanishes.
   pure real(wp) function peak_of_piece(piece, order) result(peak)
      type(piece_t), intent(in) :: piece
      integer, intent(in) :: order
      real(wp) :: y(0:highest_law_order), low, high, middle, slope, first
      integer :: i, k

      y = of_piece(piece, 0.0_wp)
      slope = y(order + 1)
      peak = abs(y(order))
      do i = 1, cells
         high = real(i, wp)/real(cells, wp)
         low = high - 1.0_wp/real(cells, wp)
         y = of_piece(piece, high)
         peak = max(peak, abs(y(order)))
         first = slope
         slope = y(order + 1)
         if (first*slope >= 0.0_wp) cycle
         do k = 1, bisections
            middle = 0.5_wp*(low + high)
            y = of_piece(piece, middle)
            if (first*y(order + 1) > 0.0_wp) then
               low = middle
            else
               high = middle
            end if
         end do
         peak = max(peak, abs(y(order)))
      end do
      peak = peak/(piece%width*radians_per_degree)**order
   end function peak_of_piece
end module psalm_cam_law
