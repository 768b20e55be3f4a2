!> Six-bar function generators through five points: all closing links over a grid of drivers.
!>
!> Stephenson III: a four-bar whose coupler drives an output link by a further link. Seen from the output link the coupler takes up
!> five poses for any choice of the four-bar and the third fixed pivot; an RR dyad of these is the closing link, so each driver has
!> at most four. Watt II: two four-bars in series with the turns of the link between them chosen; each half has at most three.
!> Sources: McCarthy and Soh (2011), Geometric Design of Linkages, chapter 6; Plecnik and McCarthy (2016).
module psalm_six_bars
   use psalm_angles, only: degrees_of
   use psalm_burmester, only: dyads_t, five_poses
   use psalm_function_points, only: plain_point, five_points, generator_t, generators_t, output_of
   use psalm_kinds, only: wp, pi, radians_per_degree, right_angle
   use psalm_stop, only: stop_t
   use psalm_desired_function, only: desired_function_t
   implicit none (type, external)
   private
   public :: six_bar_t, six_bars_t, six_bar_joints, closing_links, find_stephenson, find_watt, six_bar_output, most_links

   integer, parameter :: precision_points = 5, most_links = 4
   integer, parameter :: between = 8                 !! inputs looked at from one point to the next
   integer, parameter :: ask_after = 64              !! drivers: a look at the clock and for a signal costs less than one of them
   integer, parameter :: looks = between*(precision_points - 1) + 1
   real(wp), parameter :: at_points = 1.0e-8_wp      !! radians: the output at a point by the analysis against the one wanted
   real(wp), parameter :: no_length = 1.0e-7_wp      !! of a link, over the frame
   ! drivers of Stephenson III, over the frame A-B = 1: cranks, couplers and followers, and places of the third pivot
   real(wp), parameter :: crank_range(2) = [0.2_wp, 1.0_wp], link_range(2) = [0.5_wp, 1.6_wp]
   real(wp), parameter :: pivot_low(2) = [-1.5_wp, -2.0_wp], pivot_high(2) = [2.5_wp, 2.0_wp]
   ! Watt II: turn of the link between, degrees, and how far the inner points leave the mean of input and output
   real(wp), parameter :: turn_range(2) = [20.0_wp, 150.0_wp], away = 0.2_wp

   type :: six_bar_t
      logical :: watt = .false.
      type(generator_t) :: driver                    !! frame from 0 to 1
      ! Stephenson III
      complex(wp) :: pivot = (0.0_wp, 0.0_wp)        !! third fixed pivot
      complex(wp) :: coupler_pin = (0.0_wp, 0.0_wp)  !! from pin C, axis from C to D
      complex(wp) :: output_pin = (0.0_wp, 0.0_wp)   !! from the third pivot, at output 0
      real(wp) :: link = 0.0_wp                      !! between both pins
      integer :: assembly = 0                        !! side of the output pin on the line from the pivot to the coupler's pin
      ! Watt II
      type(generator_t) :: second                    !! frame from 1 to 2; its input is the driver's output
      real(wp) :: transmission = 0.0_wp              !! least angle over the range, degrees
      real(wp) :: longest = 0.0_wp                   !! link, over the frame
      real(wp) :: error = 0.0_wp                     !! largest over the range, radians; of a table 0
   end type six_bar_t

   type :: six_bars_t
      integer :: drivers = 0                         !! looked at that close at all points
      integer :: linkages = 0                        !! closing links, all of them
      integer :: too_long = 0                        !! of these those with a link that is too long: left out
      integer :: valid = 0                           !! of the others those that stay assembled on one branch over the range
      integer :: flat = 0                            !! of these those that do not transmit well enough: left out
      integer :: tried = 0, planned = 0              !! drivers of the grid
      logical :: stopped = .false.                   !! before all were tried
      type(six_bar_t), allocatable :: best(:)        !! ranked
   end type six_bars_t

contains

   !> Stephenson III: `grid` values of each of crank, coupler, follower, zero line of the input, and x and y of the third pivot, in
   !> both assemblies. A stop leaves what was found before.
   subroutine find_stephenson(wanted, phi, psi, grid, most, least_angle, longest, found, stop)
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: phi(precision_points), psi(precision_points) !! radians
      integer, intent(in) :: grid, most              !! linkages kept
      real(wp), intent(in) :: least_angle            !! transmission, degrees
      real(wp), intent(in) :: longest                !! link, over the frame
      type(six_bars_t), intent(out) :: found
      type(stop_t), intent(in), optional :: stop     !! asked now and then
      integer, parameter :: dimensions = 6
      type(six_bar_t) :: one, links(most_links)
      integer :: place(dimensions), number, rest, i, k, links_found
      logical :: closes

      allocate (found%best(0))
      found%planned = 2*grid**dimensions
      do number = 0, found%planned - 1
         if (present(stop)) then
            if (modulo(number, ask_after) == 0) found%stopped = stop%waiting()
         end if
         if (found%stopped) exit
         found%tried = number + 1
         rest = number/2
         do i = 1, dimensions
            place(i) = modulo(rest, grid)
            rest = rest/grid
         end do
         one%driver%r2 = along(crank_range, place(1))
         one%driver%r3 = along(link_range, place(2))
         one%driver%r4 = along(link_range, place(3))
         one%driver%phi0 = 2.0_wp*pi*real(place(4), wp)/real(grid, wp)
         one%driver%assembly = 2*modulo(number, 2) - 1
         one%pivot = cmplx(along([pivot_low(1), pivot_high(1)], place(5)), along([pivot_low(2), pivot_high(2)], place(6)), wp)
         call closing_links(one%driver, one%pivot, phi, psi, links, links_found, closes)
         if (closes) found%drivers = found%drivers + 1
         do k = 1, links_found
            found%linkages = found%linkages + 1
            if (min(abs(links(k)%output_pin), links(k)%link) < no_length) cycle
            if (links(k)%longest > longest) then
               found%too_long = found%too_long + 1
               cycle
            end if
            call assess(wanted, phi, psi, links(k))
            if (links(k)%transmission <= 0.0_wp) cycle
            found%valid = found%valid + 1
            if (links(k)%transmission < least_angle) then
               found%flat = found%flat + 1
               cycle
            end if
            call keep(links(k), most, wanted%continuous, found%best)
         end do
      end do

   contains

      !> A value of a range.
      pure real(wp) function along(range, step)
         real(wp), intent(in) :: range(2)
         integer, intent(in) :: step

         along = range(1) + (range(2) - range(1))*(real(step, wp) + 0.5_wp)/real(grid, wp)
      end function along
   end subroutine find_stephenson

   !> All links that close a Stephenson III on a given driver and third pivot: at most four. `closes`: the driver does at all
   !> points.
   pure subroutine closing_links(driver, pivot, phi, psi, links, links_found, closes)
      type(generator_t), intent(in) :: driver
      complex(wp), intent(in) :: pivot
      real(wp), intent(in) :: phi(precision_points), psi(precision_points) !! radians
      type(six_bar_t), intent(out) :: links(most_links)
      integer, intent(out) :: links_found
      logical, intent(out) :: closes
      type(dyads_t) :: dyads
      complex(wp), dimension(precision_points) :: c, coupler, p, turned, back
      logical :: closed(precision_points)
      integer :: k

      links_found = 0
      call coupler_at(driver, phi, c, coupler, closed)
      closes = all(closed)
      if (.not. closes) return
      back = cmplx(cos(psi), -sin(psi), wp)
      p = (c - pivot)*back
      turned = coupler*back
      call five_poses(p(2:) - p(1), turned(2:)/turned(1) - 1.0_wp, dyads)
      links_found = dyads%count
      do k = 1, dyads%count
         associate (one => links(k))
            one%driver = driver
            one%pivot = pivot
            one%output_pin = dyads%list(k)%pivot + p(1)
            one%coupler_pin = dyads%list(k)%pin/turned(1)
            one%link = abs(dyads%list(k)%pivot - dyads%list(k)%pin)
            one%longest = maxval([driver%r2, driver%r3, driver%r4, one%link, abs(one%output_pin), abs(one%coupler_pin), abs(pivot)])
            one%assembly = merge(1, -1, aimag(conjg(c(1) + one%coupler_pin*coupler(1) - pivot)*one%output_pin/back(1)) > 0.0_wp)
         end associate
      end do
   end subroutine closing_links

   !> Watt II: `grid` turns of the link between, in either sense, and `grid` values of each of its three inner places.
   !> A stop leaves what was found before.
   subroutine find_watt(wanted, phi, psi, grid, most, least_angle, longest, found, stop)
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: phi(precision_points), psi(precision_points) !! radians
      integer, intent(in) :: grid, most
      real(wp), intent(in) :: least_angle, longest
      type(six_bars_t), intent(out) :: found
      type(stop_t), intent(in), optional :: stop     !! asked now and then
      type(six_bar_t) :: one
      type(generators_t) :: first, second
      real(wp) :: chi(precision_points), middle(precision_points), turn
      integer :: place(4), number, rest, i, k, m

      allocate (found%best(0))
      one%watt = .true.
      middle = 0.5_wp*((phi - phi(1))/(phi(precision_points) - phi(1)) + (psi - psi(1))/(psi(precision_points) - psi(1)))
      found%planned = 2*grid**4
      do number = 0, found%planned - 1
         if (present(stop)) then
            if (modulo(number, ask_after) == 0) found%stopped = stop%waiting()
         end if
         if (found%stopped) exit
         found%tried = number + 1
         rest = number/2
         do i = 1, 4
            place(i) = modulo(rest, grid)
            rest = rest/grid
         end do
         turn = radians_per_degree*(turn_range(1) + (turn_range(2) - turn_range(1))*share(place(4)))
         if (modulo(number, 2) == 1) turn = -turn
         chi = turn*middle
         chi(2:4) = chi(2:4) + turn*away*(2.0_wp*[share(place(1)), share(place(2)), share(place(3))] - 1.0_wp)
         found%drivers = found%drivers + 1
         call five_points(plain_point(phi, chi), .false., first)
         if (.not. any(first%list(:first%count)%assembly /= 0)) cycle
         call five_points(plain_point(chi, psi), .false., second)
         do k = 1, first%count
            do m = 1, second%count
               found%linkages = found%linkages + 1
               one%driver = first%list(k)
               one%second = second%list(m)
               if (one%driver%assembly == 0 .or. one%second%assembly == 0) cycle
               one%longest = maxval([one%driver%r2, one%driver%r3, one%driver%r4, one%second%r2, one%second%r3, one%second%r4])
               if (one%longest > longest) then
                  found%too_long = found%too_long + 1
                  cycle
               end if
               call assess(wanted, phi, psi, one)
               if (one%transmission <= 0.0_wp) cycle
               found%valid = found%valid + 1
               if (one%transmission < least_angle) then
                  found%flat = found%flat + 1
                  cycle
               end if
               call keep(one, most, wanted%continuous, found%best)
            end do
         end do
      end do

   contains

      pure real(wp) function share(step)
         integer, intent(in) :: step

         share = (real(step, wp) + 0.5_wp)/real(grid, wp)
      end function share
   end subroutine find_watt

   !> Crank pin and direction of the coupler of a four-bar.
   elemental subroutine coupler_at(driver, phi, c, coupler, closes)
      type(generator_t), intent(in) :: driver
      real(wp), intent(in) :: phi
      complex(wp), intent(out) :: c, coupler
      logical, intent(out) :: closes
      real(wp) :: chi
      complex(wp) :: d

      call output_of(driver, phi, chi, closes)
      c = driver%r2*cmplx(cos(phi + driver%phi0), sin(phi + driver%phi0), wp)
      d = 1.0_wp + driver%r4*cmplx(cos(chi + driver%psi0), sin(chi + driver%psi0), wp)
      coupler = (d - c)/driver%r3
   end subroutine coupler_at

   !> Output at an input, radians; whether the linkage closes, and the sine of its least transmission angle there.
   pure subroutine six_bar_output(one, phi, psi, sine, closes)
      type(six_bar_t), intent(in) :: one
      real(wp), intent(in) :: phi
      real(wp), intent(out) :: psi, sine
      logical, intent(out) :: closes
      complex(wp) :: c, coupler, line, output
      real(wp) :: chi, reach, cosine, length

      psi = 0.0_wp
      sine = 0.0_wp
      call output_of(one%driver, phi, chi, closes)
      if (.not. closes) return
      sine = sine_of_transmission(one%driver, phi)
      if (one%watt) then
         call output_of(one%second, chi, psi, closes)
         if (closes) sine = min(sine, sine_of_transmission(one%second, chi))
         return
      end if
      call coupler_at(one%driver, phi, c, coupler, closes)
      line = c + one%coupler_pin*coupler - one%pivot
      reach = abs(line)
      length = abs(one%output_pin)
      closes = reach < one%link + length .and. reach > abs(one%link - length)
      if (.not. closes) return
      cosine = (reach**2 + length**2 - one%link**2)/(2.0_wp*reach*length)
      output = line/reach*cmplx(cosine, real(one%assembly, wp)*sqrt(max((1.0_wp - cosine)*(1.0_wp + cosine), 0.0_wp)), wp)
      output = output*length/one%output_pin
      psi = atan2(aimag(output), real(output, wp))
      cosine = (one%link**2 + length**2 - reach**2)/(2.0_wp*one%link*length)
      sine = min(sine, sqrt(max((1.0_wp - cosine)*(1.0_wp + cosine), 0.0_wp)))
   end subroutine six_bar_output

   !> Sine of the angle between coupler and output link of a four-bar.
   pure real(wp) function sine_of_transmission(one, phi)
      type(generator_t), intent(in) :: one
      real(wp), intent(in) :: phi
      real(wp) :: square, cosine

      square = 1.0_wp + one%r2**2 - 2.0_wp*one%r2*cos(phi + one%phi0)
      cosine = (one%r3**2 + one%r4**2 - square)/(2.0_wp*one%r3*one%r4)
      sine_of_transmission = sqrt(max((1.0_wp - cosine)*(1.0_wp + cosine), 0.0_wp))
   end function sine_of_transmission

   !> Transmission and error over the range; a transmission of 0 where it comes apart or changes its branch.
   pure subroutine assess(wanted, phi, psi, one)
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: phi(precision_points), psi(precision_points)
      type(six_bar_t), intent(inout) :: one
      real(wp) :: got, sine, least, input
      logical :: closes
      integer :: i, j, k

      one%transmission = 0.0_wp
      one%error = 0.0_wp
      least = 1.0_wp
      do i = 1, looks
         j = min(1 + (i - 1)/between, precision_points - 1)
         k = i - 1 - between*(j - 1)
         input = phi(j) + (phi(j + 1) - phi(j))*real(k, wp)/real(between, wp)
         call six_bar_output(one, input, got, sine, closes)
         if (.not. closes) return
         least = min(least, sine)
         if (k == 0 .and. abs(modulo(got - psi(j) + pi, 2.0_wp*pi) - pi) > at_points) return
         if (k == between .and. abs(modulo(got - psi(j + 1) + pi, 2.0_wp*pi) - pi) > at_points) return
      end do
      if (wanted%continuous) then
         do i = 1, looks
            associate (share => real(i - 1, wp)/real(looks - 1, wp))
               call six_bar_output(one, wanted%input_at(share), got, sine, closes)
               if (.not. closes) return
               least = min(least, sine)
               one%error = max(one%error, abs(modulo(got - wanted%output_at(share) + pi, 2.0_wp*pi) - pi))
            end associate
         end do
      end if
      one%transmission = min(degrees_of(sqrt((1.0_wp - least)*(1.0_wp + least)), least), right_angle)
   end subroutine assess

   !> Put a linkage into a ranked list: of a function by the error, of a table by the transmission angle.
   pure subroutine keep(one, most, by_error, best)
      type(six_bar_t), intent(in) :: one
      integer, intent(in) :: most
      logical, intent(in) :: by_error
      type(six_bar_t), allocatable, intent(inout) :: best(:)
      integer :: place, n

      n = size(best)
      place = n + 1
      do while (place > 1)
         if (by_error) then
            if (one%error >= best(place - 1)%error) exit
         else
            if (one%transmission <= best(place - 1)%transmission) exit
         end if
         place = place - 1
      end do
      if (place > most) return
      n = min(n + 1, most)
      best = [best(:place - 1), one, best(place:n - 1)]
   end subroutine keep

   !> Joints at an input: A, B, C, D, the third fixed pivot, the pin on the link that the driver moves, the pin on the output link.
   pure function six_bar_joints(one, phi) result(joints)
      type(six_bar_t), intent(in) :: one
      real(wp), intent(in) :: phi
      complex(wp) :: joints(7), c, coupler
      real(wp) :: chi, psi, sine
      logical :: closes

      call coupler_at(one%driver, phi, c, coupler, closes)
      call output_of(one%driver, phi, chi, closes)
      call six_bar_output(one, phi, psi, sine, closes)
      joints(:4) = [(0.0_wp, 0.0_wp), (1.0_wp, 0.0_wp), c, c + one%driver%r3*coupler]
      if (one%watt) then
         joints(5) = (2.0_wp, 0.0_wp)
         joints(6) = 1.0_wp + one%second%r2*cmplx(cos(chi + one%second%phi0), sin(chi + one%second%phi0), wp)
         joints(7) = 2.0_wp + one%second%r4*cmplx(cos(psi + one%second%psi0), sin(psi + one%second%psi0), wp)
      else
         joints(5) = one%pivot
         joints(6) = c + one%coupler_pin*coupler
         joints(7) = one%pivot + one%output_pin*cmplx(cos(psi), sin(psi), wp)
      end if
   end function six_bar_joints
end module psalm_six_bars
