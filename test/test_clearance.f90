!> The standard flypast of a joint with clearance: tables computed independently (theory after Haines, chapters 3 and 4), laws.
program test_clearance
   use check, only: checks_t
   use psalm_flypast, only: flypast_t, flight_t, loss_range_t, follow_flypast, fly, loss_ranges
   use psalm_kinds, only: wp, radians_per_degree
   implicit none (type, external)
   type(checks_t) :: t

   call minima()
   call late_starts()
   call flights()
   call thresholds()
   call limits()
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
      call t%close_to(ranges(1)%to, 0.3207_wp, 3.0e-3_wp, 'chart: round inertia')
      ! the line at 35 degrees leaves and enters the lost region again
      ranges = loss_ranges(35.0_wp*radians_per_degree, 0.75_wp, 0.88_wp, 1.48_wp, 0.03_wp)
      call t%equal_integer(size(ranges), 2, 'chart: a line that cuts the lost region twice')
      if (size(ranges) /= 2) return
      call t%close_to(ranges(1)%to, 0.913_wp, 2.0e-3_wp, 'chart: the first range ends')
      call t%equal_integer(ranges(1)%minimum, 5, 'chart: at the fifth minimum')
      call t%close_to(ranges(2)%from, 1.139_wp, 2.0e-3_wp, 'chart: the second begins')
      call t%close_to(ranges(2)%to, 1.410_wp, 2.0e-3_wp, 'chart: and ends')
   end subroutine thresholds

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
end program test_clearance
