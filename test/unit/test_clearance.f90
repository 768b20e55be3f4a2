!> The standard flypast of a joint with clearance: tables computed independently (theory after Haines, chapters 3 and 4), laws.
program test_clearance
   use check, only: checks_t
   use psalm_flypast, only: flypast_t, flight_t, follow_flypast, fly
   use psalm_flypast_chart, only: chart_t, loss_range_t, make_chart, scan_line, outermost_loss
   use psalm_following, only: followed_contact_t, contact_of, follow_contact, least_force_t
   use psalm_kinds, only: wp, pi, radians_per_degree
   use psalm_periodic, only: periodic_t, periodic_from_samples, periodic_constant
   implicit none (type, external)
   type(checks_t) :: t

   call minima()
   call late_starts()
   call flights()
   call thresholds()
   call limits()
   call near_rank_one()
   call charts()
   call round_inertia()
   call through_zero()
   call t%report()

contains

   subroutine minima()
      real(wp), parameter :: h(3, 6) = reshape([0.5_wp, 180.0_wp, 0.5_wp, 0.3_wp, 0.0_wp, 0.5_wp, 1.0_wp, -20.0_wp, 0.5_wp, &
                                                0.5_wp, 0.0_wp, 0.0_wp, 1.3_wp, 35.0_wp, 0.75_wp, 1.0_wp, 35.0_wp, 0.75_wp], [3, 6])
      real(wp), parameter :: want(5, 6) = reshape([0.0090_wp, 6.4411_wp, 4.8625_wp, 8.4695_wp, 14.8219_wp, &
         1.1179_wp, -0.5940_wp, 1.7082_wp, 1.3477_wp, 3.5618_wp, 1.2828_wp, 0.6613_wp, 2.2435_wp, 2.0032_wp, 3.4956_wp, &
         0.8669_wp, 1.5399_wp, 3.8521_wp, 5.8661_wp, 7.7665_wp, 0.9506_wp, -0.0410_wp, 0.7149_wp, 0.9446_wp, 0.8668_wp, &
         0.9023_wp, 0.0920_wp, 0.3406_wp, 1.3255_wp, 0.2744_wp], [5, 6])
      real(wp), parameter :: loss(6) = [0.0_wp, 10.6277_wp, 0.0_wp, 0.0_wp, 1.5797_wp, 0.0_wp]
      type(flypast_t) :: f
      integer :: i, k

      do i = 1, 6
         f = follow_flypast(h(1, i), h(2, i)*radians_per_degree, h(3, i))
         call t%is_true(f%ok .and. (f%lost .eqv. loss(i) > 0.0_wp), 'flypast: contact kept or lost')
         do k = 1, 5
            call t%close_to(f%minima(k), want(k, i), 1.0e-4_wp, 'flypast: minimum of the force')
         end do
         call t%close_to(f%loss(1), loss(i), 1.0e-5_wp, 'flypast: time of the loss')
         if (f%lost) call t%equal_integer(f%at, 2, 'flypast: the minimum that is lost')
      end do
   end subroutine minima

   !> What begins too late swings: the figures move until T = -40.
   subroutine late_starts()
      real(wp), parameter :: from(4) = [-5.0_wp, -10.0_wp, -20.0_wp, -40.0_wp]
      real(wp), parameter :: want(4) = [1.590_wp, 0.0029_wp, -0.1085_wp, -0.1088_wp]
      type(flypast_t) :: f
      integer :: i

      do i = 1, 4
         f = follow_flypast(0.166_wp, 0.0_wp, 0.5_wp, from=from(i))
         call t%close_to(f%minima(1), want(i), 5.0e-4_wp, 'flypast: late starts')
      end do
   end subroutine late_starts

   subroutine flights()
      real(wp), parameter :: h(3, 7) = reshape([0.1_wp, 0.0_wp, 0.5_wp, 0.3_wp, 180.0_wp, 0.5_wp, 0.6_wp, 0.0_wp, 0.5_wp, &
         0.2_wp, 0.0_wp, 0.0_wp, 1.3_wp, 35.0_wp, 0.75_wp, 0.4_wp, -60.0_wp, 0.5_wp, 0.2_wp, 90.0_wp, 0.99_wp], [3, 7])
      real(wp), parameter :: want(6, 7) = reshape([0.92525_wp, 21.22338_wp, 0.27934_wp, 0.101855_wp, 0.143515_wp, 0.053647_wp, &
         0.21949_wp, 4.983532_wp, 0.45908_wp, 0.473401_wp, 0.606877_wp, 0.509869_wp, 4.75841_wp, 0.584446_wp, 2.55320_wp, &
         0.017728_wp, -0.342774_wp, 0.011155_wp, 0.50041_wp, 9.052907_wp, 0.29591_wp, 0.216431_wp, 0.326259_wp, 0.216431_wp, &
         1.57970_wp, 0.263193_wp, 1.77264_wp, 0.048171_wp, -0.721643_wp, 0.034892_wp, 6.81493_wp, 1.973055_wp, 2.01770_wp, &
         0.424885_wp, -0.905578_wp, 0.629932_wp, 0.99661_wp, 2.692699_wp, 2.75598_wp, 1.847107_wp, -0.840431_wp, 0.021749_wp], &
         [6, 7])
      type(flypast_t) :: f
      type(flight_t) :: g
      real(wp) :: got(6), normal(2), tensor(2, 2), inverse
      integer :: i, k

      do i = 1, 7
         f = follow_flypast(h(1, i), h(2, i)*radians_per_degree, h(3, i))
         g = fly(h(1, i), h(2, i)*radians_per_degree, h(3, i), f%loss)
         got = [f%loss(1), g%duration, g%angle, g%across, g%along, g%index]
         call t%is_true(g%ok .and. g%across >= 0.0_wp, 'flight: the pin strikes the wall from inside')
         do k = 1, 6
            call t%close_to(got(k), want(k, i), 1.0e-5_wp, 'flight and impact')
         end do
         ! the impulse is that which stops the speed across: VN/(n M**-1 n), M of mean 1
         associate (c => cos(h(2, i)*radians_per_degree), s => sin(h(2, i)*radians_per_degree), e => h(3, i))
            tensor = reshape([1.0_wp - e*c, e*s, e*s, 1.0_wp + e*c], [2, 2])
            normal = [cos(g%angle), sin(g%angle)]
            inverse = (normal(1)**2*tensor(2, 2) - 2.0_wp*normal(1)*normal(2)*tensor(1, 2) + normal(2)**2*tensor(1, 1)) &
                      /(tensor(1, 1)*tensor(2, 2) - tensor(1, 2)**2)
            call t%close_to(g%index*inverse, g%across, 1.0e-12_wp, 'impact: the impulse stops the speed across')
            if (e <= 0.0_wp) call t%close_to(g%index, g%across, 1.0e-14_wp, 'impact: round inertia')
         end associate
      end do
   end subroutine flights

   !> Passage and envelope on radial lines of the chart.
   subroutine thresholds()
      type(loss_range_t), allocatable :: ranges(:)

      ranges = loss_ranges(180.0_wp*radians_per_degree, 0.5_wp, 0.42_wp, 0.56_wp, 0.02_wp)
      call t%equal_integer(size(ranges), 1, 'chart: one border at H2 = 180')
      call t%close_to(ranges(1)%to, 0.4980_wp, 2.0e-3_wp, 'chart: H2 = 180, H3 = 0.5')
      call t%equal_integer(ranges(1)%minimum, 1, 'chart: the passage')
      ranges = loss_ranges(0.0_wp, 0.5_wp, 0.60_wp, 0.72_wp, 0.02_wp)
      call t%close_to(ranges(size(ranges))%to, 0.6664_wp, 2.0e-3_wp, 'chart: H2 = 0, H3 = 0.5, terminal')
      call t%equal_integer(ranges(size(ranges))%minimum, 2, 'chart: the second minimum')
      ranges = loss_ranges(0.0_wp, 0.0_wp, 0.28_wp, 0.36_wp, 0.02_wp)
      call t%close_to(ranges(1)%to, 0.31867_wp, 5.0e-6_wp, 'chart: round inertia')
      call passage_and_envelope()
      ! the line at 35 degrees leaves and enters the lost region again
      ranges = loss_ranges(35.0_wp*radians_per_degree, 0.75_wp, 0.88_wp, 1.48_wp, 0.03_wp)
      call t%equal_integer(size(ranges), 2, 'chart: a line that cuts the lost region twice')
      if (size(ranges) /= 2) return
      call t%close_to(ranges(1)%to, 0.913_wp, 2.0e-3_wp, 'chart: the first range ends')
      call t%equal_integer(ranges(1)%minimum, 5, 'chart: at the fifth minimum')
      call t%close_to(ranges(2)%from, 1.139_wp, 2.0e-3_wp, 'chart: the second begins')
      call t%close_to(ranges(2)%to, 1.410_wp, 2.0e-3_wp, 'chart: and ends')
   end subroutine thresholds

   !> H1 of the passage and of any loss, found independently from a start at T = -40: the thesis reads them off charts.
   subroutine passage_and_envelope()
      real(wp), parameter :: table(4, 6) = reshape([ & ! H2, H3, passage, envelope
         -140.0_wp, 0.5_wp, 0.409_wp, 0.409_wp, -60.0_wp, 0.5_wp, 0.201_wp, 0.619_wp, &
         0.0_wp, 0.25_wp, 0.244_wp, 0.348_wp, 20.0_wp, 0.75_wp, 0.182_wp, 1.421_wp, &
         100.0_wp, 0.75_wp, 0.645_wp, 0.930_wp, 60.0_wp, 0.5_wp, 0.364_wp, 0.694_wp], [4, 6])
      integer :: i

      do i = 1, size(table, 2)
         call t%close_to(outermost_loss(table(1, i)*radians_per_degree, table(2, i), .true.), table(3, i), 2.0e-3_wp, &
                         'chart: outermost loss in the passage')
         call t%close_to(outermost_loss(table(1, i)*radians_per_degree, table(2, i), .false.), table(4, i), 2.0e-3_wp, &
                         'chart: outermost loss of any kind')
      end do
   end subroutine passage_and_envelope

   subroutine limits()
      type(flypast_t) :: one, two
      type(flight_t) :: g
      integer :: k

      one = follow_flypast(0.5_wp, 0.3_wp, 0.0_wp)
      two = follow_flypast(0.5_wp, 2.0_wp, 0.0_wp)
      do k = 1, 5
         call t%close_to(one%minima(k), two%minima(k), 1.0e-9_wp, 'round inertia has no direction')
      end do
      one = follow_flypast(0.4_wp, 180.0_wp*radians_per_degree, 0.5_wp)
      two = follow_flypast(0.4_wp, -180.0_wp*radians_per_degree, 0.5_wp)
      call t%close_to(one%minima(1), two%minima(1), 1.0e-9_wp, 'H2 of 180 and of -180 degrees are one')
      one = follow_flypast(0.0_wp, 0.0_wp, 0.5_wp)
      call t%is_true(.not. one%ok, 'H1 = 0 is refused')
      one = follow_flypast(0.5_wp, 0.0_wp, 1.0_wp)
      call t%is_true(.not. one%ok, 'H3 = 1 is refused')
      one = follow_flypast(8.0_wp, 1.0_wp, 0.5_wp)
      call t%is_true(one%ok .and. .not. one%lost, 'a large H1 keeps contact')
      ! a loss that only grazes: the flight ends at once and strikes softly
      one = follow_flypast(0.3190_wp, 0.0_wp, 0.0_wp)
      two = follow_flypast(0.2_wp, 0.0_wp, 0.0_wp)
      g = fly(0.3190_wp, 0.0_wp, 0.0_wp, one%loss)
      if (one%lost) call t%is_true(g%ok .and. g%duration < 1.0_wp .and. g%index < 0.05_wp, 'a grazing loss strikes softly')
      call t%is_true(two%lost, 'a small H1 loses contact')
   end subroutine limits

   !> H3 -> 1: k grows beyond bounds while the index and the impulse stay finite.
   subroutine near_rank_one()
      real(wp), parameter :: h3(4) = [0.99_wp, 0.999_wp, 0.9999_wp, 0.99999_wp]
      type(flypast_t) :: f
      type(flight_t) :: g
      real(wp) :: index(size(h3))
      integer :: i

      do i = 1, size(h3)
         f = follow_flypast(0.2_wp, 90.0_wp*radians_per_degree, h3(i))
         call t%is_true(f%ok .and. f%lost, 'H3 near 1: the contact is followed and lost')
         g = fly(0.2_wp, 90.0_wp*radians_per_degree, h3(i), f%loss)
         index(i) = g%index
         call t%is_true(g%ok .and. g%across > 0.0_wp, 'H3 near 1: the pin strikes')
      end do
      call t%is_true(all(index > 0.0_wp .and. index < 1.0_wp), 'H3 near 1: the index stays finite')
   end subroutine near_rank_one

   !> Ranges of H1 between two ends within which contact is lost, in ascending order.
   function loss_ranges(h2, h3, least, greatest, step) result(ranges)
      real(wp), intent(in) :: h2, h3
      real(wp), intent(in) :: least, greatest   !! of H1
      real(wp), intent(in) :: step              !! at which H1 is looked at
      type(loss_range_t), allocatable :: ranges(:)
      type(loss_range_t), allocatable :: passage(:)
      real(wp), allocatable :: h1(:), index(:)
      integer, allocatable :: lost(:)
      integer :: i, steps

      steps = max(1, ceiling((greatest - least)/step))
      h1 = [(least + (greatest - least)*real(i, wp)/real(steps, wp), i=0, steps)]
      allocate (index(size(h1)), lost(size(h1)))
      call scan_line(h2, h3, h1, lost, index, ranges, passage)
   end function loss_ranges

   !> The chart is what single lines and flypasts say, and the same for any number of threads.
   subroutine charts()
      type(chart_t) :: chart
      type(loss_range_t), allocatable :: ranges(:)
      type(flypast_t) :: f
      integer :: i, j

      call make_chart(6, 8, 1.5_wp, [0.5_wp, 0.75_wp], chart)
      do i = 1, 8, 3
         ranges = loss_ranges(chart%h2(i), 0.75_wp, 0.25_wp, 1.5_wp, 0.25_wp)
         call t%equal_integer(size(chart%lines(i, 2)%ranges), size(ranges), 'chart: number of ranges on a line')
         if (size(ranges) == size(chart%lines(i, 2)%ranges)) then
            do j = 1, size(ranges)
               call t%close_to(chart%lines(i, 2)%ranges(j)%to, ranges(j)%to, 0.0_wp, 'chart: borders')
            end do
         end if
         f = follow_flypast(chart%h1(2), chart%h2(i), 0.5_wp)
         call t%is_true((chart%lost(2, i, 1) > 0) .eqv. f%lost, 'chart: verdict of a point')
      end do
   end subroutine charts

   !> Round inertia and a load that turns steadily: the pin goes with it.
   subroutine round_inertia()
      real(wp), parameter :: load = 3.0_wp, mass = 0.4_wp, speed = 20.0_wp, e = 1.0e-4_wp
      integer, parameter :: inputs = 64
      type(followed_contact_t) :: contact
      type(least_force_t), allocatable :: minima(:)
      real(wp) :: lag(inputs), force(inputs), loss, turning
      logical :: ok
      integer :: i

      ! the load turns once a turn of the crank: seen from it the pin hangs still, a steady force R* + M0 e w**2
      contact = contact_under(turned(load, 0.0_wp), turned(load, -0.5_wp*pi), mass, speed, e)
      call follow_contact(contact, 0.3_wp, inputs, lag, force, minima, loss, ok)
      call t%is_true(ok .and. loss < 0.0_wp, 'following: a load that turns steadily keeps contact')
      turning = load + mass*e*speed**2
      do i = 1, inputs
         call t%close_to(lag(i), 0.0_wp, 1.0e-9_wp, 'following: no lag behind a load that turns steadily')
         call t%close_to(force(i), turning, 1.0e-8_wp*turning, 'following: its force')
      end do
   end subroutine round_inertia

   !> amount*cos(x + phase) as a periodic function.
   function turned(amount, phase) result(f)
      real(wp), intent(in) :: amount, phase
      type(periodic_t) :: f
      integer :: i

      f = periodic_from_samples([(amount*cos(2.0_wp*pi*real(i, wp)/16.0_wp + phase), i=0, 15)])
   end function turned

   !> Contact under a load in two components, with the same inertia in all directions. The arrays are filled one by one: gfortran 12
   !> does not free function results within an array constructor.
   function contact_under(load_x, load_y, mass, speed, e) result(contact)
      type(periodic_t), intent(in) :: load_x, load_y
      real(wp), intent(in) :: mass, speed, e
      type(followed_contact_t) :: contact
      type(periodic_t) :: load(2), tensor(3)

      load(1) = load_x
      load(2) = load_y
      tensor(1) = periodic_constant(mass)
      tensor(2) = periodic_constant(0.0_wp)
      tensor(3) = tensor(1)
      contact = contact_of(load, tensor, speed, e)
   end function contact_under

   !> A load that passes through zero, A sin x along a line: its angle is not defined there, the pin goes on and the force is the
   !> load itself. With a second load across that, against another method for the same equation.
   subroutine through_zero()
      real(wp), parameter :: amount = 2.0_wp, mass = 0.3_wp, speed = 50.0_wp, e = 2.0e-4_wp
      integer, parameter :: inputs = 32, steps = 20000
      type(followed_contact_t) :: contact
      type(least_force_t), allocatable :: minima(:)
      real(wp) :: lag(inputs), force(inputs), loss, x, h, y(2), k(2, 4), stiff
      logical :: ok
      integer :: i, j

      contact = contact_under(turned(amount, -0.5_wp*pi), turned(0.05_wp, 0.0_wp), mass, speed, e)
      call follow_contact(contact, 0.5_wp*pi, inputs, lag, force, minima, loss, ok)
      call t%is_true(ok, 'following: a load that nearly passes through zero is followed')
      contact = contact_under(turned(amount, -0.5_wp*pi), turned(0.0_wp, 0.0_wp), mass, speed, e)
      call follow_contact(contact, 0.5_wp*pi, inputs, lag, force, minima, loss, ok)
      call t%is_true(ok .and. loss > pi - 1.0e-6_wp .and. loss < pi + 1.0e-6_wp, &
                     'following: along a line contact is lost where the load changes its sign')
      call t%close_to(maxval(abs(force - [(amount*cos(2.0_wp*pi*real(i, wp)/real(inputs, wp)), i=0, inputs - 1)])), 0.0_wp, &
                      1.0e-9_wp, 'following: there the force is the load itself')
      call follow_contact(contact, 0.0_wp, inputs, lag, force, minima, loss, ok)
      call t%is_true(.not. ok, 'following: no load where it begins is refused')
      ! a load at right angles besides: against the classical method of Runge and Kutta for the equation above
      contact = contact_under(turned(amount, -0.5_wp*pi), turned(0.4_wp, 0.0_wp), mass, speed, e)
      call follow_contact(contact, 0.5_wp*pi, inputs, lag, force, minima, loss, ok)
      stiff = 1.0_wp/(mass*e*speed**2)
      x = 0.5_wp*pi
      y = [atan2(0.4_wp*cos(x), amount*sin(x)), (amount*sin(x)*(-0.4_wp*sin(x)) - 0.4_wp*cos(x)*amount*cos(x))/ &
           ((amount*sin(x))**2 + (0.4_wp*cos(x))**2)]
      h = 2.0_wp*pi/real(steps, wp)
      do i = 0, inputs - 1
         call t%close_to(force(i + 1), amount*sin(x)*cos(y(1)) + 0.4_wp*cos(x)*sin(y(1)) + y(2)**2/stiff, 1.0e-6_wp, &
                         'following: force against the classical method')
         do j = 1, steps/inputs
            k(:, 1) = slope(x, y, amount, stiff)
            k(:, 2) = slope(x + 0.5_wp*h, y + 0.5_wp*h*k(:, 1), amount, stiff)
            k(:, 3) = slope(x + 0.5_wp*h, y + 0.5_wp*h*k(:, 2), amount, stiff)
            k(:, 4) = slope(x + h, y + h*k(:, 3), amount, stiff)
            y = y + h*(k(:, 1) + 2.0_wp*k(:, 2) + 2.0_wp*k(:, 3) + k(:, 4))/6.0_wp
            x = x + h
         end do
      end do

   end subroutine through_zero

   !> (g, g')' of the pin with the load amount sin x along, 0.4 cos x across, round inertia.
   pure function slope(x, y, amount, stiff) result(d)
      real(wp), intent(in) :: x, y(2), amount, stiff
      real(wp) :: d(2)

      d = [y(2), stiff*(0.4_wp*cos(x)*cos(y(1)) - amount*sin(x)*sin(y(1)))]
   end function slope
end program test_clearance
