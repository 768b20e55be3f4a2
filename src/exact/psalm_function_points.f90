!> Function generators through precision points, all of them: four-bars and slider-cranks.
!>
!> The four-bar has its fixed pivots at 0 and 1, the input crank r2 at phi + phi0, the output link r4 at psi + psi0 and the
!> coupler r3. Seen from the crank, the output link takes up the poses exp(-i phi) with the orientation psi - phi, and the coupler
!> is an RR dyad of these: five points have at most three linkages, the frame itself being the fourth. Of a slider-crank the
!> slider takes up the poses s exp(-i phi) with the orientation -phi. Sources: Freudenstein (1954); Hartenberg and Denavit (1964),
!> chapter 10.
!>
!> A point may have derivatives of the output by the input, which are met exactly too (Oldham (1977), 9.1.1): each is a condition as
!> a point is, and takes the place of one.
module psalm_function_points
   use psalm_burmester, only: centres_on_line, dyad_condition_t, derivative_of, dyad_swings, dyads_t, five_conditions, of_poses
   use psalm_kinds, only: wp, pi
   implicit none (type, external)
   private
   public :: generator_t, generators_t, function_point_t, plain_point, five_points, four_points, three_points, output_of

   integer, parameter :: most_generators = 3
   real(wp), parameter :: no_length = 1.0e-7_wp      !! of a link, over the frame
   real(wp), parameter :: rounding = 1.0e-9_wp       !! of lengths: a linkage may close at a dead point

   !> A four-bar or slider-crank that generates a function; angles in radians.
   type :: generator_t
      logical :: slides = .false.                    !! a slider-crank: see r3, r4, psi0
      real(wp) :: r2 = 0.0_wp                        !! crank; of a four-bar over the frame
      real(wp) :: r3 = 0.0_wp                        !! coupler
      real(wp) :: r4 = 0.0_wp                        !! output link; of a slider-crank the offset of the slide
      real(wp) :: phi0 = 0.0_wp                      !! direction of the crank at input 0
      real(wp) :: psi0 = 0.0_wp                      !! direction of the output link at output 0; of a slider its place
      integer :: assembly = 0                        !! +1 or -1; 0: the points lie on different ones
      logical :: opens = .false.                     !! it does not close at every input between the points
   end type generator_t

   !> A point of a function, and what the output does there.
   type :: function_point_t
      real(wp) :: phi = 0.0_wp, psi = 0.0_wp         !! radians; of a slider-crank psi is the travel
      integer :: order = 0                           !! derivatives that are wanted
      real(wp) :: rate(2) = 0.0_wp                   !! of psi by phi: first and second, of those wanted
   end type function_point_t

   type :: generators_t
      integer :: count = 0
      type(generator_t) :: list(most_generators)
      integer :: imaginary = 0                       !! roots that are not real
      integer :: infinite = 0
      logical :: degenerate = .false.
      type(dyads_t) :: dyads                         !! of the output link seen from the crank
      integer :: frame = 0                           !! which of them is the frame
   end type generators_t

contains

   !> All linkages through five points. Of a slider-crank psi is the travel.
   pure subroutine five_points(points, slides, found)
      type(function_point_t), intent(in) :: points(:) !! five, or fewer with derivatives: points and these are five
      logical, intent(in) :: slides
      type(generators_t), intent(out) :: found
      complex(wp) :: p, turned
      type(dyad_condition_t) :: conditions(4)
      type(dyads_t) :: dyads

      call conditions_of(points, slides, .false., p, turned, conditions)
      call five_conditions(conditions, dyads)
      call generators_of(points%phi, points%psi, slides, p, turned, dyads, found)
   end subroutine five_points

   !> All linkages through four points whose crank, or with `of_output` whose output link, has a given zero line: at most two, of a
   !> slider-crank at most three. The centre points of the output link seen from the crank lie on the line through the crank's
   !> pivot, which of a four-bar is one of them. Of a slider-crank psi is the travel and `of_output` must be false.
   pure subroutine four_points(points, slides, of_output, zero, found)
      type(function_point_t), intent(in) :: points(:) !! four, or fewer with derivatives: points and these are four
      logical, intent(in) :: slides, of_output
      real(wp), intent(in) :: zero                   !! direction at 0, from the frame
      type(generators_t), intent(out) :: found
      complex(wp) :: p, turned
      type(dyad_condition_t) :: conditions(3)
      real(wp) :: input(size(points)), output(size(points)), line
      type(dyads_t) :: dyads
      type(generator_t) :: own
      integer :: k

      input = points%phi
      output = points%psi
      line = zero
      if (of_output) then
         ! the linkage seen from the other side: mirrored, so that the frame lies as before
         input = -points%psi
         output = -points%phi
         line = pi - zero
      end if
      call conditions_of(points, slides, of_output, p, turned, conditions)
      call centres_on_line(conditions, -p, cmplx(cos(line), sin(line), wp), dyads)
      call generators_of(input, output, slides, p, turned, dyads, found)
      if (.not. of_output) return
      do k = 1, found%count
         own = found%list(k)
         found%list(k)%r2 = own%r4
         found%list(k)%r4 = own%r2
         found%list(k)%phi0 = pi - own%psi0
         found%list(k)%psi0 = pi - own%phi0
         found%list(k)%assembly = assembly_of(found%list(k), points%phi, points%psi)
         found%list(k)%opens = opens_between(found%list(k), minval(points%phi), maxval(points%phi))
      end do
   end subroutine four_points

   !> A point without derivatives.
   elemental type(function_point_t) function plain_point(phi, psi)
      real(wp), intent(in) :: phi, psi

      plain_point%phi = phi
      plain_point%psi = psi
   end function plain_point

   !> What points ask of the dyads of the output link seen from the crank, beyond the first pose, which is the first point.
   pure subroutine conditions_of(points, slides, of_output, p, turned, conditions)
      type(function_point_t), intent(in) :: points(:)
      logical, intent(in) :: slides
      logical, intent(in) :: of_output               !! the crank seen from the output link, mirrored
      complex(wp), intent(out) :: p, turned          !! the first pose: place, and turn as a complex number
      type(dyad_condition_t), intent(out) :: conditions(:)
      complex(wp) :: place(0:2), turn(0:2)
      integer :: i, n, order

      n = 0
      do i = 1, size(points)
         if (of_output) then
            call pose_of(-[points(i)%psi, points(i)%rate], -[points(i)%phi, 1.0_wp, 0.0_wp], slides, place, turn)
         else
            call pose_of([points(i)%phi, 1.0_wp, 0.0_wp], [points(i)%psi, points(i)%rate], slides, place, turn)
         end if
         if (i == 1) then
            p = place(0)
            turned = turn(0)
         end if
         place(0) = place(0) - p
         turn = turn/turned
         turn(0) = turn(0) - 1.0_wp
         if (i > 1) then
            n = n + 1
            conditions(n) = of_poses(place(0), turn(0))
         end if
         do order = 1, points(i)%order
            n = n + 1
            conditions(n) = derivative_of(place, turn, order > 1)
         end do
      end do
   end subroutine conditions_of

   !> Pose of the output link seen from the crank and its derivatives, from input and output and theirs by any parameter.
   pure subroutine pose_of(input, output, slides, place, turn)
      real(wp), intent(in) :: input(0:2), output(0:2)
      logical, intent(in) :: slides
      complex(wp), intent(out) :: place(0:2), turn(0:2)

      place = turning(-input)
      turn = place
      if (slides) then
         place = [output(0)*turn(0), output(1)*turn(0) + output(0)*turn(1), &
                  output(2)*turn(0) + 2.0_wp*output(1)*turn(1) + output(0)*turn(2)]
      else
         turn = turning(output - input)
         turn(0) = place(0)*cmplx(cos(output(0)), sin(output(0)), wp)
      end if
   end subroutine pose_of

   !> exp(i angle) and its derivatives.
   pure function turning(angle)
      real(wp), intent(in) :: angle(0:2)             !! and its derivatives
      complex(wp) :: turning(0:2)
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)

      turning(0) = cmplx(cos(angle(0)), sin(angle(0)), wp)
      turning(1) = i*angle(1)*turning(0)
      turning(2) = (i*angle(2) - angle(1)**2)*turning(0)
   end function turning

   !> Linkages of the dyads that lead the output link.
   pure subroutine generators_of(phi, psi, slides, p, turned, dyads, found)
      real(wp), intent(in) :: phi(:), psi(:)
      logical, intent(in) :: slides
      complex(wp), intent(in) :: p, turned           !! first pose
      type(dyads_t), intent(in) :: dyads
      type(generators_t), intent(out) :: found
      type(generator_t) :: one
      complex(wp) :: crank, output
      real(wp) :: length
      integer :: k

      length = 1.0_wp
      if (slides) length = max(maxval(psi) - minval(psi), tiny(1.0_wp))
      found%degenerate = dyads%degenerate
      found%imaginary = dyads%imaginary
      found%infinite = dyads%infinite
      found%dyads = dyads
      ! of a slider-crank the frame is a line of the slider, the one of its travel, through the crank's pivot
      do k = 1, merge(dyads%sliding, 0, slides)
         if (dyads%lines(k)%kind == dyad_swings .and. abs(dyads%lines(k)%pivot + p) < no_length*length) &
            found%infinite = found%infinite - 1
      end do
      do k = 1, dyads%count
         crank = dyads%list(k)%pivot + p
         output = dyads%list(k)%pin/turned
         ! the frame itself is one of them
         if (abs(crank) < no_length*length .or. (.not. slides .and. abs(output) < no_length)) then
            found%frame = k
            cycle
         end if
         one = generator_t(slides=slides, r2=abs(crank), phi0=atan2(aimag(crank), real(crank, wp)))
         if (slides) then
            one%psi0 = -real(output, wp)
            one%r4 = aimag(output)
            one%r3 = abs(crank*cmplx(cos(phi(1)), sin(phi(1)), wp) - psi(1) - output)
         else
            one%r4 = abs(output)
            one%psi0 = atan2(aimag(output), real(output, wp))
            one%r3 = abs(1.0_wp + output*cmplx(cos(psi(1)), sin(psi(1)), wp) - crank*cmplx(cos(phi(1)), sin(phi(1)), wp))
         end if
         one%assembly = assembly_of(one, phi, psi)
         one%opens = opens_between(one, minval(phi), maxval(phi))
         if (found%count == most_generators) cycle
         found%count = found%count + 1
         found%list(found%count) = one
      end do
   end subroutine generators_of

   !> The four-bar through three points whose zero lines are given, by Freudenstein's equation
   !> cos(phi - psi) = k1 cos(psi) - k2 cos(phi) + k3, k1 = 1/r2, k2 = 1/r4. Negative lengths are those of the opposite direction.
   !> `exists` false: the equations depend on each other or ask for an infinite length.
   pure subroutine three_points(points, one, exists)
      type(function_point_t), intent(in) :: points(:) !! three, or fewer with derivatives; from the frame
      type(generator_t), intent(out) :: one
      logical, intent(out) :: exists
      real(wp) :: m(3, 3), right(3), k(3), determinant, column(3), third
      integer :: i, n

      n = 0
      do i = 1, size(points)
         associate (phi => points(i)%phi, psi => points(i)%psi, v => points(i)%rate(1), a => points(i)%rate(2))
            n = n + 1
            m(n, :) = [cos(psi), -cos(phi), 1.0_wp]
            right(n) = cos(phi - psi)
            if (points(i)%order == 0) cycle
            n = n + 1
            m(n, :) = [-sin(psi)*v, sin(phi), 0.0_wp]
            right(n) = -sin(phi - psi)*(1.0_wp - v)
            if (points(i)%order == 1) cycle
            n = n + 1
            m(n, :) = [-cos(psi)*v**2 - sin(psi)*a, cos(phi), 0.0_wp]
            right(n) = sin(phi - psi)*a - cos(phi - psi)*(1.0_wp - v)**2
         end associate
      end do
      determinant = determinant_of(m)
      exists = abs(determinant) > epsilon(1.0_wp)
      if (.not. exists) return
      do i = 1, 3
         column = m(:, i)
         m(:, i) = right
         k(i) = determinant_of(m)/determinant
         m(:, i) = column
      end do
      exists = all(abs(k(:2)) > no_length)
      if (.not. exists) return
      one%r2 = 1.0_wp/k(1)
      one%r4 = 1.0_wp/k(2)
      third = one%r2**2 + one%r4**2 + 1.0_wp - 2.0_wp*one%r2*one%r4*k(3)
      exists = third > 0.0_wp
      if (.not. exists) return
      one%r3 = sqrt(third)
      if (one%r2 < 0.0_wp) one%phi0 = pi
      if (one%r4 < 0.0_wp) one%psi0 = pi
      one%r2 = abs(one%r2)
      one%r4 = abs(one%r4)
      one%assembly = assembly_of(one, points%phi, points%psi)
      one%opens = opens_between(one, minval(points%phi), maxval(points%phi))
   end subroutine three_points

   !> True if the linkage does not close at every input of a range: what coupler and output link must span is longest and shortest
   !> at an end of the range or where the crank is in line with the frame, of a slider-crank across its slide.
   pure logical function opens_between(one, from, to)
      type(generator_t), intent(in) :: one
      real(wp), intent(in) :: from, to               !! radians
      integer, parameter :: halves = 8               !! quarter turns looked at beside the ends: two turns
      real(wp) :: at(2 + 2*halves), span
      integer :: k, n, first

      at(:2) = [from, to]
      n = 2
      first = ceiling((from + one%phi0)/(0.5_wp*pi))
      do k = first, first + 2*halves - 1
         if (0.5_wp*pi*real(k, wp) - one%phi0 > to) exit
         n = n + 1
         at(n) = 0.5_wp*pi*real(k, wp) - one%phi0
      end do
      opens_between = .false.
      do k = 1, n
         associate (crank => one%r2*cmplx(cos(at(k) + one%phi0), sin(at(k) + one%phi0), wp))
            if (one%slides) then
               opens_between = opens_between .or. abs(aimag(crank) - one%r4) > one%r3*(1.0_wp + rounding)
            else
               span = abs(1.0_wp - crank)
               opens_between = opens_between .or. span > (one%r3 + one%r4)*(1.0_wp + rounding) .or. &
                               abs(one%r3 - one%r4) > span + rounding*(one%r3 + one%r4)
            end if
         end associate
      end do
   end function opens_between

   pure real(wp) function determinant_of(m)
      real(wp), intent(in) :: m(3, 3)

      determinant_of = m(1, 1)*(m(2, 2)*m(3, 3) - m(2, 3)*m(3, 2)) - m(1, 2)*(m(2, 1)*m(3, 3) - m(2, 3)*m(3, 1)) + &
                       m(1, 3)*(m(2, 1)*m(3, 2) - m(2, 2)*m(3, 1))
   end function determinant_of

   !> The assembly in which the linkage passes all points, 0 if they lie on both.
   pure integer function assembly_of(one, phi, psi)
      type(generator_t), intent(in) :: one
      real(wp), intent(in) :: phi(:), psi(:)         !! radians
      complex(wp) :: crank, output, diagonal
      integer :: i, side

      assembly_of = 0
      do i = 1, size(phi)
         crank = one%r2*cmplx(cos(phi(i) + one%phi0), sin(phi(i) + one%phi0), wp)
         if (one%slides) then
            side = merge(1, -1, psi(i) - one%psi0 > real(crank, wp))
         else
            output = one%r4*cmplx(cos(psi(i) + one%psi0), sin(psi(i) + one%psi0), wp)
            diagonal = 1.0_wp - crank
            side = merge(1, -1, aimag(conjg(diagonal)*output) > 0.0_wp)
         end if
         if (i > 1 .and. side /= assembly_of) then
            assembly_of = 0
            return
         end if
         assembly_of = side
      end do
   end function assembly_of

   !> Output at an input, radians (of a slider its travel), and whether the linkage closes there.
   pure subroutine output_of(one, phi, psi, closes)
      type(generator_t), intent(in) :: one
      real(wp), intent(in) :: phi
      real(wp), intent(out) :: psi
      logical, intent(out) :: closes
      complex(wp) :: crank, diagonal
      real(wp) :: cosine, square

      crank = one%r2*cmplx(cos(phi + one%phi0), sin(phi + one%phi0), wp)
      if (one%slides) then
         square = one%r3**2 - (aimag(crank) - one%r4)**2
         closes = square >= 0.0_wp
         psi = real(crank, wp) + real(one%assembly, wp)*sqrt(max(square, 0.0_wp)) + one%psi0
         return
      end if
      diagonal = 1.0_wp - crank
      cosine = (one%r3**2 - one%r4**2 - abs(diagonal)**2)/(2.0_wp*one%r4*abs(diagonal))
      closes = abs(cosine) <= 1.0_wp
      psi = atan2(aimag(diagonal), real(diagonal, wp)) + &
            real(one%assembly, wp)*acos(min(max(cosine, -1.0_wp), 1.0_wp)) - one%psi0
   end subroutine output_of
end module psalm_function_points
