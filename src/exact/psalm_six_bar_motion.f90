!> The motion of a six-bar of psalm_six_bar_problem: whether it meets its points one after the other on one branch.
!>
!> Driven at the input it is followed from the first point: the turn of the floating link and the output solve the equations of both
!> legs by Newton's method, in steps of a degree or less. A linkage without a defect meets every output in turn, and the determinant
!> of these equations keeps its sign: circuit, branch and order are right at once. Driven at the output input and output change
!> places.
module psalm_six_bar_motion
   use psalm_angles, only: degrees_of
   use psalm_kinds, only: wp, pi, radians_per_degree, right_angle
   use psalm_six_bar_problem, only: at_c, at_p, at_q, at_r, at_s, six_bar_problem_t, watt_2
   use psalm_desired_function, only: desired_function_t
   implicit none (type, external)
   private
   public :: moving_six_bar_t, assess_motion, joints_of

   integer, parameter :: legs = 2
   real(wp), parameter :: step = radians_per_degree  !! of the driver
   real(wp), parameter :: largest_turn = 0.2_wp      !! of the others in a step, radians
   real(wp), parameter :: largest_correction = 0.1_wp !! first one of Newton's method, radians
   real(wp), parameter :: converged = 1.0e-13_wp, near_enough = 1.0e-9_wp !! last correction aimed at, and accepted
   integer, parameter :: newton_steps = 12
   real(wp), parameter :: least_step = step/4.0_wp**4
   real(wp), parameter :: met_within = 1.0e-9_wp     !! radians

   !> A real solution.
   type :: moving_six_bar_t
      complex(wp) :: x(5) = (0.0_wp, 0.0_wp)         !! numbers of the linkage, the frame is 1 long
      real(wp) :: phi(2) = 0.0_wp                    !! input and output at the first point
      logical :: by_input = .false., by_output = .false. !! it meets all points on one branch, driven there
      logical :: over_range = .false.                !! driven at the input it reaches both ends of the function's range
      real(wp) :: transmission = 0.0_wp              !! least angle of both dyads over the range, degrees
      real(wp) :: longest = 0.0_wp                   !! link over the frame; Watt II: each half over its own
      real(wp) :: error = 0.0_wp                     !! largest over the range, radians; of a table 0
   end type moving_six_bar_t

   !> A place on the way.
   type :: six_bar_place_t
      real(wp) :: turn = 0.0_wp                      !! of the floating link
      real(wp) :: angle(2) = 0.0_wp                  !! input and output
      real(wp) :: determinant = 0.0_wp
      real(wp) :: sine = 1.0_wp                      !! of the least transmission angle
   end type six_bar_place_t

contains

   !> Follow a linkage over its points, and over the range of a function.
   pure subroutine assess_motion(problem, wanted, phi, psi, one)
      type(six_bar_problem_t), intent(in) :: problem
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: phi(:), psi(:)         !! radians
      type(moving_six_bar_t), intent(inout) :: one
      real(wp) :: lengths(legs), least
      logical :: met

      one%phi = [phi(1), psi(1)]
      call lengths_of(problem, one, lengths)
      one%longest = longest_of(problem, one, lengths)
      least = 1.0_wp
      call meet(problem, one, lengths, 1, phi, psi, one%by_input, least)
      call meet(problem, one, lengths, 2, psi, phi, one%by_output)
      one%over_range = one%by_input
      one%error = 0.0_wp
      if (one%by_input .and. wanted%continuous) then
         call sweep(problem, wanted, lengths, 0.0_wp, one, met, least)
         if (met) call sweep(problem, wanted, lengths, 1.0_wp, one, met, least)
         one%over_range = met
      end if
      one%transmission = 0.0_wp
      if (one%over_range) one%transmission = min(degrees_of(sqrt((1.0_wp - least)*(1.0_wp + least)), least), right_angle)

   end subroutine assess_motion

   !> From the first point to an end of the range of a function: the error and the transmission on the way.
   pure subroutine sweep(problem, wanted, lengths, share, one, reached, least)
      type(six_bar_problem_t), intent(in) :: problem
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: lengths(legs), share   !! 0: the beginning, 1: the end
      type(moving_six_bar_t), intent(inout) :: one
      logical, intent(out) :: reached
      real(wp), intent(inout) :: least               !! sine of the transmission angle
      type(six_bar_place_t) :: place
      real(wp) :: first, goal, away
      integer :: k, n

      place%angle = one%phi
      call settle(problem, one, lengths, 1, place, reached)
      first = one%phi(1)
      goal = wanted%input_at(share)
      n = max(1, ceiling(abs(goal - first)/step))
      do k = 1, n
         if (reached) call go_to(problem, one, lengths, 1, first + (goal - first)*real(k, wp)/real(n, wp), place, reached, least)
         if (.not. reached) return
         away = place%angle(2) - wanted%output_at(place%angle(1)/wanted%swing_in)
         one%error = max(one%error, abs(modulo(away + pi, 2.0_wp*pi) - pi))
      end do
   end subroutine sweep

   !> Go from the first point through all others, driven at the input (1) or the output (2).
   pure subroutine meet(problem, one, lengths, driver, goals, others, met, least)
      type(six_bar_problem_t), intent(in) :: problem
      type(moving_six_bar_t), intent(in) :: one
      real(wp), intent(in) :: lengths(legs)
      integer, intent(in) :: driver
      real(wp), intent(in) :: goals(:), others(:)    !! angles of the driver and of the other link
      logical, intent(out) :: met
      real(wp), intent(inout), optional :: least
      type(six_bar_place_t) :: place
      integer :: j

      place%angle = one%phi
      call settle(problem, one, lengths, driver, place, met)
      if (present(least)) least = min(least, place%sine)
      do j = 2, size(goals)
         if (met) call go_to(problem, one, lengths, driver, goals(j), place, met, least)
         if (.not. met) return
         met = abs(modulo(place%angle(3 - driver) - others(j) + pi, 2.0_wp*pi) - pi) < met_within
      end do
   end subroutine meet

   !> Move the driver to an angle; `reached` is false if the linkage comes apart or to a dead point before.
   pure subroutine go_to(problem, one, lengths, driver, goal, place, reached, least)
      type(six_bar_problem_t), intent(in) :: problem
      type(moving_six_bar_t), intent(in) :: one
      real(wp), intent(in) :: lengths(legs)
      integer, intent(in) :: driver
      real(wp), intent(in) :: goal
      type(six_bar_place_t), intent(inout) :: place
      logical, intent(out) :: reached
      real(wp), intent(inout), optional :: least     !! sine of the transmission angle
      type(six_bar_place_t) :: next
      real(wp) :: way, rest

      way = step
      reached = .true.
      do
         rest = goal - place%angle(driver)
         if (.not. abs(rest) > 0.0_wp) exit
         next = place
         if (abs(rest) <= way) then
            next%angle(driver) = goal
         else
            next%angle(driver) = place%angle(driver) + sign(way, rest)
         end if
         call settle(problem, one, lengths, driver, next, reached)
         if (reached) reached = abs(next%turn - place%turn) < largest_turn .and. &
                                abs(next%angle(3 - driver) - place%angle(3 - driver)) < largest_turn
         if (reached) then
            if (.not. next%determinant*place%determinant > 0.0_wp) then
               reached = .false.
               return
            end if
            place = next
            if (present(least)) least = min(least, place%sine)
            way = min(4.0_wp*way, step)
            cycle
         end if
         way = 0.25_wp*way
         if (way < least_step) return
      end do
   end subroutine go_to

   !> Newton's method for the turn of the floating link and the link that is not the driver.
   pure subroutine settle(problem, one, lengths, driver, place, settled)
      type(six_bar_problem_t), intent(in) :: problem
      type(moving_six_bar_t), intent(in) :: one
      real(wp), intent(in) :: lengths(legs)          !! squares
      integer, intent(in) :: driver
      type(six_bar_place_t), intent(inout) :: place
      logical, intent(out) :: settled
      complex(wp) :: e, f, t, z, by_other
      real(wp) :: value(legs), by_turn(legs), by_angle(legs), change(2), largest
      integer :: k, turn

      largest = huge(1.0_wp)
      settled = .false.
      do turn = 1, newton_steps
         e = unit(place%angle(1))
         f = unit(place%angle(2))
         t = unit(place%turn)
         place%sine = 1.0_wp
         do k = 1, legs
            call leg_at(problem, one, k, e, f, t, z)
            value(k) = abs(z)**2 - lengths(k)
            by_turn(k) = derivative(z, t*one%x(problem%q(k)))
            if (driver == 1) then
               by_other = (0.0_wp, 0.0_wp)
               if (problem%b(k) > 0) by_other = f*one%x(problem%b(k))
            else
               by_other = (0.0_wp, 0.0_wp)
               if (problem%a(k) > 0) by_other = e*one%x(problem%a(k))
            end if
            by_angle(k) = derivative(z, by_other)
            ! the dyad of a leg: it and the link that it moves
            if (driver == 1) then
               associate (moved => merge(t*one%x(problem%q(k)), by_other, k == 1))
                  place%sine = min(place%sine, abs(derivative(z, moved))/(2.0_wp*abs(z)*abs(moved)))
               end associate
            end if
         end do
         place%determinant = by_turn(1)*by_angle(2) - by_turn(2)*by_angle(1)
         if (.not. abs(place%determinant) > 0.0_wp) return
         if (largest < converged) exit
         change(1) = -(value(1)*by_angle(2) - value(2)*by_angle(1))/place%determinant
         change(2) = -(by_turn(1)*value(2) - by_turn(2)*value(1))/place%determinant
         if (turn == 1 .and. .not. maxval(abs(change)) < largest_correction) return
         if (.not. maxval(abs(change)) < 0.5_wp*largest) exit
         largest = maxval(abs(change))
         place%turn = place%turn + change(1)
         place%angle(3 - driver) = place%angle(3 - driver) + change(2)
      end do
      settled = largest < near_enough
   end subroutine settle

   !> d |z|**2 for a part of z that turns.
   elemental real(wp) function derivative(z, part)
      complex(wp), intent(in) :: z, part

      derivative = 2.0_wp*real(conjg(z)*cmplx(-aimag(part), real(part, wp), wp), wp)
   end function derivative

   elemental complex(wp) function unit(angle)
      real(wp), intent(in) :: angle

      unit = cmplx(cos(angle), sin(angle), wp)
   end function unit

   !> The vector of a leg.
   pure subroutine leg_at(problem, one, k, e, f, t, z)
      type(six_bar_problem_t), intent(in) :: problem
      type(moving_six_bar_t), intent(in) :: one
      integer, intent(in) :: k
      complex(wp), intent(in) :: e, f, t
      complex(wp), intent(out) :: z

      z = t*one%x(problem%q(k))
      if (problem%a(k) > 0) z = z + e*one%x(problem%a(k))
      if (problem%b(k) > 0) z = z + f*one%x(problem%b(k))
      if (problem%c(k) > 0) then
         z = z + one%x(problem%c(k))
      else
         z = z - 1.0_wp
      end if
   end subroutine leg_at

   !> Squares of the lengths of both legs.
   pure subroutine lengths_of(problem, one, lengths)
      type(six_bar_problem_t), intent(in) :: problem
      type(moving_six_bar_t), intent(in) :: one
      real(wp), intent(out) :: lengths(legs)
      complex(wp) :: z
      integer :: k

      do k = 1, legs
         call leg_at(problem, one, k, unit(one%phi(1)), unit(one%phi(2)), (1.0_wp, 0.0_wp), z)
         lengths(k) = abs(z)**2
      end do
   end subroutine lengths_of

   pure real(wp) function longest_of(problem, one, lengths)
      type(six_bar_problem_t), intent(in) :: problem
      type(moving_six_bar_t), intent(in) :: one
      real(wp), intent(in) :: lengths(legs)

      longest_of = max(1.0_wp, maxval(abs(one%x(:problem%unknowns))), maxval(sqrt(lengths)))
      if (problem%type /= watt_2) longest_of = max(longest_of, abs(one%x(at_q) - one%x(at_r)))
   end function longest_of

   !> Joints at the first point, the frame A-B from 0 to 1: A, B, C, D, third fixed pivot E, G and H, as psalm_exact_text draws a
   !> six-bar. Watt II: the second half is as long as the first, with E on the line of A and B.
   pure function joints_of(problem, one) result(joints)
      type(six_bar_problem_t), intent(in) :: problem
      type(moving_six_bar_t), intent(in) :: one
      complex(wp) :: joints(7), e, f

      e = unit(one%phi(1))
      f = unit(one%phi(2))
      joints(1) = (0.0_wp, 0.0_wp)
      joints(2) = (1.0_wp, 0.0_wp)
      joints(3) = one%x(at_p)*e
      if (problem%type == watt_2) then
         joints(4) = 1.0_wp - one%x(at_q)
         joints(5) = (2.0_wp, 0.0_wp)
         joints(6) = 1.0_wp + one%x(at_r)
         joints(7) = 2.0_wp - one%x(at_s)*f
      else
         joints(4) = joints(3) + one%x(at_q)
         joints(5) = -one%x(at_c)
         joints(6) = joints(3) + one%x(at_r)
         joints(7) = joints(5) - one%x(at_s)*f
      end if
   end function joints_of
end module psalm_six_bar_motion
