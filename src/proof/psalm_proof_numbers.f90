!> The numbers of all outputs of a sketch, and their rates, within a tube: quadratics with a bound of what they leave out.
!>
!> Along the prediction a number and its first derivatives are known in the middle; the next derivative is bounded over the tube
!> by majorants, and so is what poses and rates differ from the prediction. Of a line from joint to joint the derivatives of its
!> logarithm are those of its length and of its direction.
module psalm_proof_numbers
   use psalm_chain_outputs, only: output_at
   use psalm_closure, only: closure_t, most_orders, travel
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_proof_tube, only: tube_t, point_majorant, travel_majorant, rates, size_of, rounding, outwards, degree
   use psalm_sketch, only: sketch_output_t, output_point, output_angle, output_distance, output_slide, output_between, &
                           output_pose, output_ratio, output_x, output_y, columns_of, first_number, sketch_t, &
                           drive_slides, drive_stretches
   implicit none (type, external)
   private
   public :: quadratic_t, find_numbers, rate_of_link, rate_of_slide, is_angle, has_rate, play_of_joint

   !> c(0) + c(1) s + c(2) s**2 but for `error`, s from the middle of the tube.
   type :: quadratic_t
      logical :: bounded = .false.
      real(wp) :: c(0:2) = 0.0_wp
      real(wp) :: error = 0.0_wp
   end type quadratic_t

contains

   !> True if a number of all outputs is an angle.
   pure logical function is_angle(outputs, number)
      type(sketch_output_t), intent(in) :: outputs(:)
      integer, intent(in) :: number
      integer :: k, n

      is_angle = .false.
      call find_output(outputs, number, k, n)
      if (k == 0) return
      is_angle = outputs(k)%kind == output_angle .or. outputs(k)%kind == output_between .or. &
                 (outputs(k)%kind == output_pose .and. n == 3)
   end function is_angle

   !> True if a number stands for its output, so that it has a velocity ratio and dead points; x and y of a point have none, nor has
   !> a ratio, nor what is itself the displacement of a drive.
   pure logical function has_rate(sketch, outputs, number)
      type(sketch_t), intent(in) :: sketch
      type(sketch_output_t), intent(in) :: outputs(:)
      integer, intent(in) :: number
      integer :: k, n, i

      has_rate = .false.
      call find_output(outputs, number, k, n)
      if (k == 0) return
      has_rate = (columns_of(outputs(k)) == 1 .and. outputs(k)%kind /= output_ratio) .or. is_angle(outputs, number)
      associate (output => outputs(k), drives => sketch%drives)
         do n = 1, size(drives)
            select case (drives(n)%kind)
            case (drive_slides)
               if (output%kind == output_slide .and. output%slide == drives(n)%slide) has_rate = .false.
            case (drive_stretches)
               if (output%kind == output_distance .and. all([(any(sketch%links(drives(n)%link)%joints == output%joints(i)), &
                                                              i=1, 2)])) has_rate = .false.
            end select
         end do
      end associate
   end function has_rate

   !> Which output a number of all outputs belongs to, and which of its numbers it is. 0: there is no such number.
   pure subroutine find_output(outputs, number, output, component)
      type(sketch_output_t), intent(in) :: outputs(:)
      integer, intent(in) :: number
      integer, intent(out) :: output, component

      component = number
      do output = 1, size(outputs)
         if (component <= columns_of(outputs(output))) return
         component = component - columns_of(outputs(output))
      end do
      output = 0
   end subroutine find_output

   !> Derivatives of a quadratic and its next one, from the derivatives of a number in the middle.
   pure function quadratic_of(derivatives, next, error, r) result(q)
      real(wp), intent(in) :: derivatives(0:2)
      real(wp), intent(in) :: next             !! bound of the third derivative
      real(wp), intent(in) :: error, r
      type(quadratic_t) :: q

      q%bounded = .true.
      q%c = [derivatives(0), derivatives(1), 0.5_wp*derivatives(2)]
      q%error = (error + next*r**3/6.0_wp + rounding*sum(abs(derivatives)*[1.0_wp, r, 0.5_wp*r*r]))*outwards
   end function quadratic_of

   !> All numbers of all outputs within a tube, and their derivatives by the way: of angles degrees, of their rates radians.
   subroutine find_numbers(closure, outputs, tube, values, speeds)
      type(closure_t), intent(in) :: closure
      type(sketch_output_t), intent(in) :: outputs(:)
      type(tube_t), intent(in) :: tube
      type(quadratic_t), allocatable, intent(out) :: values(:), speeds(:) !! shape (numbers of all outputs)
      real(wp), allocatable :: at(:, :)
      integer :: first(size(outputs))
      integer :: k, n, numbers

      first = [(first_number(outputs, k), k=1, size(outputs))]
      numbers = first_number(outputs, size(outputs) + 1) - 1
      allocate (values(numbers), speeds(numbers), at(numbers, 0:most_orders))
      call output_at(closure, tube%state, outputs, at)
      do k = 1, size(outputs)
         n = first(k)
         associate (output => outputs(k), joints => outputs(k)%joints)
            select case (output%kind)
            case (output_point, output_pose, output_x, output_y)
               call put_point(n, joints(1))
               if (output%kind == output_point .or. output%kind == output_pose) call put_point(n + 1, joints(1))
               if (output%kind == output_pose) call put_angle(n + 2, joints(2:3))
            case (output_angle)
               call put_angle(n, joints(:2))
            case (output_between)
               call put_angle(n, joints)
            case (output_distance)
               call put_distance(n, joints(:2))
            case (output_slide)
               call put_travel(n, output%slide)
            case (output_ratio)
               call put_ratio(n, first(output%outputs(1)), first(output%outputs(2)))
            end select
         end associate
      end do

   contains

      !> A coordinate of a joint.
      subroutine put_point(number, joint)
         integer, intent(in) :: number, joint
         real(wp) :: z(0:degree)

         z = point_majorant(closure, tube, joint, closure%holder(joint))
         values(number) = quadratic_of(at(number, :2), z(3), play_of_joint(closure, tube, joint), tube%r)
         speeds(number) = quadratic_of(at(number, 1:), z(4), play_of_speed(joint), tube%r)
      end subroutine put_point

      !> The direction of a line, or the angle from one to another.
      subroutine put_angle(number, joints)
         integer, intent(in) :: number
         integer, intent(in) :: joints(:)      !! two joints, or four
         real(wp) :: l(degree), sums(4), bounds(4), low
         integer :: i

         bounds = 0.0_wp
         do i = 1, size(joints), 2
            call bound_line(joints(i), joints(i + 1), l, sums, low)
            if (low <= 0.0_wp) return
            bounds = bounds + sums
         end do
         values(number) = quadratic_of(at(number, :2)*[1.0_wp, degrees_per_radian, degrees_per_radian], &
                                       bounds(1)*degrees_per_radian, bounds(2)*degrees_per_radian, tube%r)
         speeds(number) = quadratic_of(at(number, 1:), bounds(3), bounds(4), tube%r)
      end subroutine put_angle

      !> The distance of two joints, or of one from the origin (0).
      subroutine put_distance(number, joints)
         integer, intent(in) :: number
         integer, intent(in) :: joints(2)
         real(wp) :: l(degree), sums(4), low, play, slip, longest, speed

         call bound_line(joints(1), joints(2), l, sums, low)
         if (low <= 0.0_wp) return
         play = play_of_joint(closure, tube, joints(1))
         slip = play_of_speed(joints(1))
         if (joints(2) > 0) then
            play = play + play_of_joint(closure, tube, joints(2))
            slip = slip + play_of_speed(joints(2))
         end if
         ! the length is not greater than that in the middle and the way, whose relative rate is well below 1 where tubes hold
         longest = at(number, 0)*(1.0_wp + tube%r*l(1)/max(1.0_wp - tube%r*l(1), tiny(1.0_wp)))
         speed = longest*l(1)
         values(number) = quadratic_of(at(number, :2), longest*(l(1)**3 + 3.0_wp*l(1)*l(2) + l(3)), play, tube%r)
         speeds(number) = quadratic_of(at(number, 1:), longest*(l(1)**4 + 6.0_wp*l(1)**2*l(2) + 3.0_wp*l(2)**2 &
                                                                + 4.0_wp*l(1)*l(3) + l(4)), slip + speed*play/low, tube%r)
      end subroutine put_distance

      !> The displacement along a slide.
      subroutine put_travel(number, slide)
         integer, intent(in) :: number, slide
         real(wp) :: z(0:degree), error, q

         z = travel_majorant(closure, tube, slide)
         associate (a => closure%sketch%slides(slide)%links(1), b => closure%sketch%slides(slide)%links(2))
            q = size_of(closure%slide_point(2, slide))
            error = tube%off_t(a) + tube%off_t(b) + z(0)*tube%off_phi(a) + q*tube%off_phi(b)
            error = error + rounding*(z(0) + maxval(size_of(tube%state%t([a, b], 0))))
         end associate
         values(number) = quadratic_of(at(number, :2), z(3), error, tube%r)
         speeds(number) = rate_of_slide(closure, tube, slide)
      end subroutine put_travel

      !> The ratio of two rates: its value c in the middle, and (a - c b)/b.
      subroutine put_ratio(number, of, by)
         integer, intent(in) :: number, of, by
         real(wp) :: low, high, c, n(0:2)

         associate (a => speeds(of), b => speeds(by), r => tube%r)
            if (.not. (a%bounded .and. b%bounded)) return
            high = abs(b%c(1))*r + abs(b%c(2))*r*r + b%error
            low = (abs(b%c(0)) - high)/outwards
            high = (abs(b%c(0)) + high)*outwards
            if (low <= 0.0_wp) return
            c = a%c(0)/b%c(0)
            n = (a%c - c*b%c)/b%c(0)
            values(number)%bounded = .true.
            values(number)%c = [c, n(1), n(2)]
            ! of the quotient by b in the middle, and of that it is another one elsewhere
            values(number)%error = ((a%error + abs(c)*b%error)/low + (abs(n(1))*r + abs(n(2))*r*r)*(high - low)/low &
                                    + rounding*(abs(c) + (maxval(abs(a%c)) + abs(c)*maxval(abs(b%c)))/low))*outwards
         end associate
      end subroutine put_ratio

      !> The line from joint to joint (0: the origin): bounds of the derivatives of the logarithm of its vector, of its direction
      !> the third, what is open of it (radians), the fourth, what is open of its rate; the least length, 0 or less: not bounded.
      subroutine bound_line(from, to, l, sums, low)
         integer, intent(in) :: from, to
         real(wp), intent(out) :: l(degree), sums(4), low
         real(wp) :: p(0:degree), z(degree), play, slip, angles
         complex(wp) :: vector
         integer :: link

         p = point_majorant(closure, tube, from, closure%holder(from))
         z = p(1:)
         play = play_of_joint(closure, tube, from)
         slip = play_of_speed(from)
         vector = tube%state%joint(from, 0)
         if (to > 0) then
            p = point_majorant(closure, tube, to, closure%holder(to))
            z = z + p(1:)
            play = play + play_of_joint(closure, tube, to)
            slip = slip + play_of_speed(to)
            vector = tube%state%joint(to, 0) - vector
         end if
         low = size_of(vector) - tube%r*z(1) - play
         l = 0.0_wp
         sums = 0.0_wp
         if (low <= 0.0_wp) return
         l(1) = z(1)/low
         l(2) = z(2)/low + l(1)**2
         l(3) = z(3)/low + 3.0_wp*l(1)*l(2) + l(1)**3
         l(4) = z(4)/low + 4.0_wp*l(1)*l(3) + 3.0_wp*l(2)**2 + 6.0_wp*l(1)**2*l(2) + l(1)**4
         sums = [l(3), play/low, l(4), (slip + z(1)*play/low)/low]
         if (to == 0) return
         ! of two joints of one link the direction is the link's, but not of a cylinder that turns round in itself
         do link = 1, size(closure%sketch%links)
            if (.not. closure%sketch%has_joint(link, from) .or. .not. closure%sketch%has_joint(link, to)) cycle
            angles = 1.0_wp + abs(tube%state%phi(link, 0))
            sums = [abs(tube%state%phi(link, 3)), tube%off_phi(link) + rounding*angles, 0.0_wp, tube%rate_phi(link) &
                    + rounding*angles*(l(1) + tube%r*l(2) + tube%r**2*l(3))]
            return
         end do
      end subroutine bound_line

      !> How far the rate of a joint may lie from that of its prediction, roundings included.
      pure real(wp) function play_of_speed(joint) result(slip)
         integer, intent(in) :: joint
         real(wp) :: p(0:degree), f(3)

         associate (link => closure%holder(joint))
            p = point_majorant(closure, tube, joint, link)
            f = rates(abs(tube%state%phi(link, 1:)), tube%r)
            ! p(1) is not below the rate of a point that moves in the link
            slip = tube%rate_t(link) + p(0)*(tube%rate_phi(link) + f(1)*tube%off_phi(link)) + p(1)*tube%off_phi(link) &
                   + rounding*(1.0_wp + abs(tube%state%phi(link, 0)))*(p(1) + tube%r*p(2) + tube%r**2*p(3))
         end associate
      end function play_of_speed
   end subroutine find_numbers

   !> How far a joint may lie from its prediction, roundings included.
   pure real(wp) function play_of_joint(closure, tube, joint) result(play)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      integer, intent(in) :: joint
      real(wp) :: p(0:degree)

      associate (link => closure%holder(joint))
         p = point_majorant(closure, tube, joint, link)
         play = tube%off_t(link) + p(0)*tube%off_phi(link) &
                + rounding*(abs(tube%state%t(link, 0)%re) + abs(tube%state%t(link, 0)%im) &
                            + p(0)*(1.0_wp + abs(tube%state%phi(link, 0))))
      end associate
   end function play_of_joint

   !> How fast a link turns, radians by the way.
   pure type(quadratic_t) function rate_of_link(tube, link) result(q)
      type(tube_t), intent(in) :: tube
      integer, intent(in) :: link

      q = quadratic_of(tube%state%phi(link, 1:), 0.0_wp, tube%rate_phi(link), tube%r)
   end function rate_of_link

   !> How fast the second link of a slide moves along it, by the way.
   pure type(quadratic_t) function rate_of_slide(closure, tube, slide) result(q)
      type(closure_t), intent(in) :: closure
      type(tube_t), intent(in) :: tube
      integer, intent(in) :: slide
      real(wp) :: along(3), z(0:degree), q2, play, slip, of_first(3), of_second(3), first_t(3), second_t(3)
      complex(wp) :: w
      integer :: order

      do order = 1, 3
         w = travel(closure, tube%state, slide, order)
         along(order) = w%re
      end do
      z = travel_majorant(closure, tube, slide)
      associate (a => closure%sketch%slides(slide)%links(1), b => closure%sketch%slides(slide)%links(2), state => tube%state)
         ! the line's axes turn with the first link: D = t_b + e_b q - t_a, seen from there
         q2 = size_of(closure%slide_point(2, slide))
         of_first = rates(abs(state%phi(a, 1:)), tube%r)
         of_second = rates(abs(state%phi(b, 1:)), tube%r)
         first_t = rates(size_of(state%t(a, 1:)), tube%r)
         second_t = rates(size_of(state%t(b, 1:)), tube%r)
         play = tube%off_t(a) + tube%off_t(b) + q2*tube%off_phi(b)
         slip = tube%rate_t(a) + tube%rate_t(b) + q2*(tube%rate_phi(b) + of_second(1)*tube%off_phi(b))
         slip = slip + tube%off_phi(a)*(first_t(1) + second_t(1) + q2*of_second(1)) + tube%rate_phi(a)*(z(0) + play) &
                + of_first(1)*(play + tube%off_phi(a)*(z(0) + play))
         slip = slip + rounding*(1.0_wp + maxval(abs(state%phi([a, b], 0))))*(z(1) + tube%r*z(2) + tube%r**2*z(3))
      end associate
      q = quadratic_of(along, z(4), slip, tube%r)
   end function rate_of_slide
end module psalm_proof_numbers
