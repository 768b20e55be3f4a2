!> The proof that solutions exist, are distinct and are real: Krawczyk's test, in extended precision where double fails.
!>
!> What is certified are the equations of psalm_leg_problem for the numbers of the data set as they stand there: displacements,
!> turns and pivots are formed from them in quadruple precision. Solutions are apart if in one number their discs are; of nine
!> points, where a solution stands for its cognates too, in the sum of the three pivots.
module psalm_certificate
   use psalm_function_points, only: function_point_t
   use psalm_kinds, only: wp
   use psalm_krawczyk, only: examine
   use psalm_krawczyk_extended, only: examine_extended => examine
   use psalm_leg_problem, only: at_a, at_ah, at_b, at_bh, at_x, at_xh, at_y, at_yh, kind_pose, kind_rate, kind_timed, &
                                leg_problem_t, most_order, most_points, variables
   use psalm_product_sums, only: product_sums_t
   use psalm_quad, only: qp, exp, unit_vector_quad
   implicit none (type, external)
   private
   public :: certificate_t, certify_legs, certify_poses, certify_generators, examine_all

   !> Places of the numbers behind those of the legs; point j is j places on. f is the crank's turn less 1, k and square are
   !> the numbers of a condition (psalm_burmester).
   integer, parameter :: at_g = variables, at_gh = at_g + most_points, at_d = at_gh + most_points, at_dh = at_d + most_points, &
                         at_f = at_dh + most_points, at_fh = at_f + most_points, at_k = at_fh + most_points, &
               at_kh = at_k + most_points, at_square = at_kh + most_points, places = at_square + most_points
   integer, parameter :: leg = 4                      !! numbers of a leg
   integer, parameter :: corrections = 2              !! steps of Newton's method before the test
   integer, parameter :: more_corrections = 4         !! in extended precision
   real(wp), parameter :: rounding = 2.0e-14_wp       !! of the sum of the pivots, relative
   real(wp), parameter :: outward = 1.0_wp + 1.0e-10_wp !! that covers the rounding of bounds themselves

   type :: certificate_t
      integer :: examined = 0                        !! solutions
      integer :: proven = 0                          !! solutions that exist
      integer :: apart = 0                           !! of these those whose discs meet no other's
      integer :: real_ones = 0                       !! proven to be real
      integer :: not_real = 0                        !! proven not to be
   contains
      procedure :: holds
   end type certificate_t

contains

   !> True if all that were examined exist and are distinct.
   elemental logical function holds(self)
      class(certificate_t), intent(in) :: self

      holds = self%examined > 0 .and. self%proven == self%examined .and. self%apart == self%examined
   end function holds

   !> Examine solutions of a problem of two legs, from the first point. With `orbits`, nine points, each stands for all that
   !> exchange of the legs and cognates make of it.
   subroutine certify_legs(problem, points, degrees, pivots, solutions, turns, partners, likely_real, orbits, certificate, &
                           curvatures)
      type(leg_problem_t), intent(in) :: problem
      complex(wp), intent(in) :: points(0:)          !! shape (0:problem%points), as given; of terms along the path not used
      real(wp), intent(in) :: degrees(0:)            !! likewise: of poses the orientation, of timed points the crank angle, of
                                                     !! terms along the path the direction of the tangent
      complex(wp), intent(in) :: pivots(2)           !! the fixed ones as given, if they are
      complex(wp), intent(in) :: solutions(:, :)     !! shape (variables, count)
      complex(wp), intent(in) :: turns(:, :), partners(:, :) !! g and gh, shape (points, count)
      logical, intent(in) :: likely_real(:)          !! shape (count)
      logical, intent(in) :: orbits
      type(certificate_t), intent(out) :: certificate
      real(wp), intent(in), optional :: curvatures(0:) !! of terms along the path of second order
      type(product_sums_t) :: sums
      complex(qp) :: numbers(places)
      real(qp) :: along, across
      complex(wp), allocatable :: starts(:, :)
      integer, allocatable :: unknown(:), keys(:)
      integer :: j, n

      n = problem%points
      numbers = (0.0_qp, 0.0_qp)
      unknown = problem%free(:problem%unknowns)
      keys = unknown
      do j = 1, n
         if (problem%kind(j) == kind_rate) then
            call unit_vector_quad(real(degrees(j), qp), along, across)
            numbers(at_d + j) = cmplx(along, across, qp)
            if (problem%order(j) > 1) numbers(at_d + j) = 0.5_qp*real(curvatures(j), qp)*cmplx(-across, along, qp)
         else
            numbers(at_d + j) = cmplx(points(j), kind=qp) - cmplx(points(0), kind=qp)
         end if
         numbers(at_dh + j) = conjg(numbers(at_d + j))
         if (problem%kind(j) == kind_pose) call set_turn(real(degrees(j), qp) - real(degrees(0), qp), numbers(at_g + j), &
                                                         numbers(at_gh + j))
         if (problem%kind(j) == kind_timed) call set_turn(real(degrees(j), qp) - real(degrees(0), qp), numbers(at_f + j), &
                                                          numbers(at_fh + j))
         if (problem%kind(j) /= kind_pose) unknown = [unknown, at_g + j, at_gh + j]
      end do
      if (problem%crank_given) numbers(at_a) = cmplx(pivots(1), kind=qp) - cmplx(points(0), kind=qp)
      if (problem%follower_given) numbers(at_b) = cmplx(pivots(2), kind=qp) - &
                                                  cmplx(merge(pivots(1), points(0), problem%differences), kind=qp)
      numbers(at_ah) = conjg(numbers(at_a))
      numbers(at_bh) = conjg(numbers(at_b))
      call sums%begin(places, unknown)
      do j = 1, n
         select case (problem%kind(j))
         case (kind_rate)
            call add_terms_along(problem, j, sums)
            cycle
         case (kind_timed)
            call add_crank(at_x, at_a, at_g + j, at_f + j, at_d + j, sums)
            call add_crank(at_xh, at_ah, at_gh + j, at_fh + j, at_dh + j, sums)
         case default
            call add_leg(at_x, j, sums)
         end select
         if (problem%slides) then
            call add_slide(j, sums)
         else if (problem%differences) then
            call add_difference(j, sums)
         else
            call add_leg(at_y, j, sums)
         end if
         if (problem%kind(j) /= kind_pose) call add_modulus(j, sums)
      end do
      allocate (starts(size(unknown), size(solutions, 2)))
      do j = 1, size(unknown)
         if (unknown(j) <= at_g) then
            starts(j, :) = solutions(unknown(j), :)
         else if (unknown(j) <= at_gh) then
            starts(j, :) = turns(unknown(j) - at_g, :)
         else
            starts(j, :) = partners(unknown(j) - at_gh, :)
         end if
      end do
      call examine_all(sums, numbers, partners_of(sums, unknown, problem%slides), starts, likely_real, sums%place(keys), &
                       orbits, 0, certificate)
   end subroutine certify_legs

   !> Examine the dyads of five poses, or of fewer with points about which the body turns.
   subroutine certify_poses(points, degrees, poles, of_pose, dyads, likely_real, certificate)
      complex(wp), intent(in) :: points(0:)          !! as given
      real(wp), intent(in) :: degrees(0:)
      complex(wp), intent(in) :: poles(:)            !! as given
      integer, intent(in) :: of_pose(:)              !! shape (poles): counted from 0
      complex(wp), intent(in) :: dyads(:, :)         !! x, xh, a, ah from the first point, shape (4, count)
      logical, intent(in) :: likely_real(:)          !! shape (count)
      type(certificate_t), intent(out) :: certificate
      complex(qp), parameter :: i = (0.0_qp, 1.0_qp)
      complex(qp) :: numbers(places), d, g, gh
      integer :: j, n

      numbers = (0.0_qp, 0.0_qp)
      n = ubound(points, 1)
      do j = 1, n
         call set_turn(real(degrees(j), qp) - real(degrees(0), qp), g, gh)
         call set_condition(j, [cmplx(points(j), kind=qp) - cmplx(points(0), kind=qp)], [g], numbers)
      end do
      do j = 1, size(poles)
         d = cmplx(points(of_pose(j)), kind=qp) - cmplx(points(0), kind=qp)
         call set_turn(real(degrees(of_pose(j)), qp) - real(degrees(0), qp), g, gh)
         call set_condition(n + j, [d, i*(cmplx(points(of_pose(j)), kind=qp) - cmplx(poles(j), kind=qp))], [g, i*(1.0_qp + g)], &
                            numbers)
      end do
      call examine_dyads(n + size(poles), numbers, dyads, likely_real, 0, certificate)
   end subroutine certify_poses

   !> Examine the dyads of the output link seen from the crank, for five points and derivatives of a function: one of a four-bar is
   !> the frame, which is not counted.
   subroutine certify_generators(points, slides, dyads, likely_real, frame, certificate)
      type(function_point_t), intent(in) :: points(0:)
      logical, intent(in) :: slides
      complex(wp), intent(in) :: dyads(:, :)         !! x, xh, a, ah from the first point, shape (4, count)
      logical, intent(in) :: likely_real(:)          !! shape (count)
      integer, intent(in) :: frame                   !! which of them is the frame; 0: none
      type(certificate_t), intent(out) :: certificate
      complex(qp), parameter :: i = (0.0_qp, 1.0_qp)
      complex(qp) :: numbers(places), place(0:2), turned(0:2), first(2)
      real(qp) :: rate(0:2), w(2)
      integer :: j, n, order

      numbers = (0.0_qp, 0.0_qp)
      n = 0
      do j = 0, ubound(points, 1)
         rate = [real(points(j)%psi, qp), real(points(j)%rate, qp)]
         ! exp(-i phi), whose derivatives are by phi, and the turn of the output link
         place(0) = exp(cmplx(0.0_qp, -real(points(j)%phi, qp), qp))
         place(1:) = [-i, (-1.0_qp, 0.0_qp)]*place(0)
         turned = place
         if (slides) then
            place = [rate(0)*turned(0), rate(1)*turned(0) + rate(0)*turned(1), &
                     rate(2)*turned(0) + 2.0_qp*rate(1)*turned(1) + rate(0)*turned(2)]
         else
            turned(0) = turned(0)*exp(cmplx(0.0_qp, rate(0), qp))
            w = rate(1:) - [1.0_qp, 0.0_qp]
            turned(1) = i*w(1)*turned(0)
            turned(2) = (i*w(2) - w(1)**2)*turned(0)
         end if
         if (j == 0) first = [place(0), turned(0)]
         place(0) = place(0) - first(1)
         turned = turned*conjg(first(2))
         turned(0) = turned(0) - 1.0_qp
         do order = merge(1, 0, j == 0), points(j)%order
            n = n + 1
            call set_condition(n, place(:order), turned(:order), numbers)
         end do
      end do
      call examine_dyads(n, numbers, dyads, likely_real, frame, certificate)
   end subroutine certify_generators

   !> The numbers of a condition: of a pose, or of its first or second derivative, as many as there are beyond the pose itself.
   subroutine set_condition(n, d, g, numbers)
      integer, intent(in) :: n                       !! which condition
      complex(qp), intent(in) :: d(0:), g(0:)        !! the pose and its derivatives
      complex(qp), intent(inout) :: numbers(:)
      integer :: last

      last = ubound(d, 1)
      numbers(at_d + n) = d(last)
      numbers(at_g + n) = g(last)
      select case (last)
      case (0)
         numbers(at_k + n) = conjg(d(0))*(1.0_qp + g(0))
         numbers(at_square + n) = d(0)*conjg(d(0))
      case (1)
         numbers(at_k + n) = conjg(d(1))*(1.0_qp + g(0)) + conjg(d(0))*g(1)
         numbers(at_square + n) = cmplx(2.0_qp*real(conjg(d(0))*d(1), qp), kind=qp)
      case default
         numbers(at_k + n) = conjg(d(2))*(1.0_qp + g(0)) + 2.0_qp*conjg(d(1))*g(1) + conjg(d(0))*g(2)
         numbers(at_square + n) = cmplx(2.0_qp*(real(d(1)*conjg(d(1)), qp) + real(conjg(d(0))*d(2), qp)), kind=qp)
      end select
      numbers([at_gh, at_dh, at_kh] + n) = conjg(numbers([at_g, at_d, at_k] + n))
   end subroutine set_condition

   subroutine examine_dyads(conditions, numbers, dyads, likely_real, frame, certificate)
      integer, intent(in) :: conditions              !! beyond the first pose
      complex(qp), intent(in) :: numbers(places)
      complex(wp), intent(in) :: dyads(:, :)
      logical, intent(in) :: likely_real(:)
      integer, intent(in) :: frame
      type(certificate_t), intent(out) :: certificate
      type(product_sums_t) :: sums
      integer, parameter :: unknown(leg) = [at_x, at_xh, at_a, at_ah]
      integer :: j

      call sums%begin(places, unknown)
      do j = 1, conditions
         call add_condition(j, sums)
      end do
      call examine_all(sums, numbers, partners_of(sums, unknown, .false.), dyads, likely_real, unknown, .false., frame, certificate)
   end subroutine examine_dyads

   ! ---- the equations -------------------------------------------------------------------------------------------------

   !> exp(i angle) - 1 and its conjugate, without loss where the angle is small.
   subroutine set_turn(degrees, g, gh)
      real(qp), intent(in) :: degrees
      complex(qp), intent(out) :: g, gh
      real(qp) :: c, s

      call unit_vector_quad(0.5_qp*degrees, c, s)
      g = 2.0_qp*s*cmplx(-s, c, qp)
      gh = conjg(g)
   end subroutine set_turn

   !> (ah - dh) x g + (a - d) xh gh + (ah - xh) d + (a - x) dh - d dh.
   subroutine add_leg(first, j, sums)
      integer, intent(in) :: first, j                !! place of the leg's first number; point
      type(product_sums_t), intent(inout) :: sums

      associate (x => first, xh => first + 1, a => first + 2, ah => first + 3, g => at_g + j, gh => at_gh + j, d => at_d + j, &
                 dh => at_dh + j)
         call sums%next_equation()
         call sums%add(1, [ah, x, g])
         call sums%add(-1, [dh, x, g])
         call sums%add(1, [a, xh, gh])
         call sums%add(-1, [d, xh, gh])
         call sums%add(1, [ah, d])
         call sums%add(-1, [xh, d])
         call sums%add(1, [a, dh])
         call sums%add(-1, [x, dh])
         call sums%add(-1, [d, dh])
      end associate
   end subroutine add_leg

   !> The equations of a term along the path: both legs and the modulus of the coupler's turn.
   subroutine add_terms_along(problem, j, sums)
      type(leg_problem_t), intent(in) :: problem
      integer, intent(in) :: j
      type(product_sums_t), intent(inout) :: sums
      integer :: i, m, chain(0:most_order)

      m = problem%order(j)
      chain = problem%chain(:, j)
      call add_leg_term(at_x, chain(:m), sums)
      if (problem%slides) then
         call add_slide(j, sums)
      else if (problem%differences) then
         call sums%next_equation()
         call sums%add(1, [at_ah, at_y, at_g + j])
         call sums%add(1, [at_bh, at_x, at_g + j])
         call sums%add(1, [at_bh, at_y, at_g + j])
         call sums%add(1, [at_a, at_yh, at_gh + j])
         call sums%add(1, [at_b, at_xh, at_gh + j])
         call sums%add(1, [at_b, at_yh, at_gh + j])
         call sums%add(1, [at_bh, at_d + j])
         call sums%add(-1, [at_yh, at_d + j])
         call sums%add(1, [at_b, at_dh + j])
         call sums%add(-1, [at_y, at_dh + j])
         call add_turned_back(at_y, chain(:m), sums)
      else
         call add_leg_term(at_y, chain(:m), sums)
      end if
      call sums%next_equation()
      call sums%add(1, [at_g + j])
      call sums%add(1, [at_gh + j])
      do i = 0, m
         if (min(chain(i), chain(m - i)) > 0) call sums%add(1, [at_g + chain(i), at_gh + chain(m - i)])
      end do
   end subroutine add_terms_along

   !> The last term of the equation of a leg: as add_leg, products being sums over the terms.
   subroutine add_leg_term(first, chain, sums)
      integer, intent(in) :: first                   !! place of the leg's first number
      integer, intent(in) :: chain(0:)               !! the terms, shape (0:order); 0: of the first point, which has none
      type(product_sums_t), intent(inout) :: sums
      integer :: i, m

      m = ubound(chain, 1)
      associate (x => first, xh => first + 1, a => first + 2, ah => first + 3, g => at_g + chain(m), gh => at_gh + chain(m), &
                 d => at_d + chain(m), dh => at_dh + chain(m))
         call sums%next_equation()
         call sums%add(1, [ah, x, g])
         call sums%add(1, [a, xh, gh])
         call sums%add(1, [ah, d])
         call sums%add(-1, [xh, d])
         call sums%add(1, [a, dh])
         call sums%add(-1, [x, dh])
      end associate
      call add_turned_back(first, chain, sums)
      do i = 0, m
         if (min(chain(i), chain(m - i)) > 0) call sums%add(-1, [at_d + chain(i), at_dh + chain(m - i)])
      end do
   end subroutine add_leg_term

   !> -dh x g - d xh gh, products being sums over the terms.
   subroutine add_turned_back(x, chain, sums)
      integer, intent(in) :: x                       !! its place; xh is behind it
      integer, intent(in) :: chain(0:)               !! shape (0:order)
      type(product_sums_t), intent(inout) :: sums
      integer :: i, m

      m = ubound(chain, 1)
      do i = 0, m
         if (min(chain(i), chain(m - i)) == 0) cycle
         call sums%add(-1, [at_dh + chain(i), x, at_g + chain(m - i)])
         call sums%add(-1, [at_d + chain(i), x + 1, at_gh + chain(m - i)])
      end do
   end subroutine add_turned_back

   !> ah x g - k x + a xh gh - kh xh + ah d + a dh - square: a dyad's condition, whatever its numbers are derived from.
   subroutine add_condition(j, sums)
      integer, intent(in) :: j                       !! condition
      type(product_sums_t), intent(inout) :: sums

      call sums%next_equation()
      call sums%add(1, [at_ah, at_x, at_g + j])
      call sums%add(-1, [at_k + j, at_x])
      call sums%add(1, [at_a, at_xh, at_gh + j])
      call sums%add(-1, [at_kh + j, at_xh])
      call sums%add(1, [at_ah, at_d + j])
      call sums%add(1, [at_a, at_dh + j])
      call sums%add(-1, [at_square + j])
   end subroutine add_condition

   !> The equation of leg b less that of leg a, in the differences of their numbers.
   subroutine add_difference(j, sums)
      integer, intent(in) :: j
      type(product_sums_t), intent(inout) :: sums

      associate (g => at_g + j, gh => at_gh + j, d => at_d + j, dh => at_dh + j)
         call sums%next_equation()
         call sums%add(1, [at_ah, at_y, g])
         call sums%add(-1, [dh, at_y, g])
         call sums%add(1, [at_bh, at_x, g])
         call sums%add(1, [at_bh, at_y, g])
         call sums%add(1, [at_a, at_yh, gh])
         call sums%add(-1, [d, at_yh, gh])
         call sums%add(1, [at_b, at_xh, gh])
         call sums%add(1, [at_b, at_yh, gh])
         call sums%add(1, [at_bh, d])
         call sums%add(-1, [at_yh, d])
         call sums%add(1, [at_b, dh])
         call sums%add(-1, [at_y, dh])
      end associate
   end subroutine add_difference

   !> A slider: d + y g - w (dh + yh gh).
   subroutine add_slide(j, sums)
      integer, intent(in) :: j
      type(product_sums_t), intent(inout) :: sums

      call sums%next_equation()
      call sums%add(1, [at_d + j])
      call sums%add(1, [at_y, at_g + j])
      call sums%add(-1, [at_b, at_dh + j])
      call sums%add(-1, [at_b, at_yh, at_gh + j])
   end subroutine add_slide

   !> A crank whose turn is given: x g - (x - a) f + d.
   subroutine add_crank(x, a, g, f, d, sums)
      integer, intent(in) :: x, a, g, f, d
      type(product_sums_t), intent(inout) :: sums

      call sums%next_equation()
      call sums%add(1, [x, g])
      call sums%add(-1, [x, f])
      call sums%add(1, [a, f])
      call sums%add(1, [d])
   end subroutine add_crank

   !> g gh + g + gh.
   subroutine add_modulus(j, sums)
      integer, intent(in) :: j
      type(product_sums_t), intent(inout) :: sums

      call sums%next_equation()
      call sums%add(1, [at_g + j, at_gh + j])
      call sums%add(1, [at_g + j])
      call sums%add(1, [at_gh + j])
   end subroutine add_modulus

   !> Which unknown is the partner of each; of a slide's direction, itself.
   pure function partners_of(sums, unknown, slides) result(partner)
      type(product_sums_t), intent(in) :: sums
      integer, intent(in) :: unknown(:)
      logical, intent(in) :: slides
      integer :: partner(size(unknown)), k

      do k = 1, size(unknown)
         if (unknown(k) > at_gh) then
            partner(k) = sums%place(unknown(k) - most_points)
         else if (unknown(k) > at_g) then
            partner(k) = sums%place(unknown(k) + most_points)
         else if (slides .and. unknown(k) == at_b) then
            partner(k) = k
         else
            ! a number stands at an odd place, its partner behind it
            partner(k) = sums%place(unknown(k) + merge(1, -1, modulo(unknown(k), 2) == 1))
         end if
      end do
   end function partners_of

   ! ---- the test ------------------------------------------------------------------------------------------------------

   !> Examine solutions of equations.
   subroutine examine_all(sums, numbers, partner, starts, likely_real, keys, orbits, uncounted, certificate)
      type(product_sums_t), intent(in) :: sums
      complex(qp), intent(in) :: numbers(:)          !! those given, each at its place
      integer, intent(in) :: partner(:)              !! shape (unknowns)
      complex(wp), intent(in) :: starts(:, :)        !! shape (unknowns, count)
      logical, intent(in) :: likely_real(:)
      integer, intent(in) :: keys(:)                 !! unknowns in which solutions are compared
      logical, intent(in) :: orbits                  !! they are compared in the sum of the pivots
      integer, intent(in) :: uncounted               !! a solution that is none of those wanted; 0: there is none
      type(certificate_t), intent(out) :: certificate
      complex(wp) :: v(size(starts, 1))
      complex(wp), allocatable :: key(:, :)
      real(wp) :: r(size(starts, 1))
      real(wp), allocatable :: radius(:, :)
      logical :: valid(size(starts, 2)), is_real, is_not
      integer :: i, n

      n = merge(2, size(keys), orbits)
      allocate (key(n, size(starts, 2)), source=(0.0_wp, 0.0_wp))
      allocate (radius(n, size(starts, 2)), source=0.0_wp)
      certificate%examined = size(starts, 2) - merge(1, 0, uncounted > 0)
      do i = 1, size(starts, 2)
         call examine(sums, numbers, partner, starts(:, i), corrections, likely_real(i), v, r, valid(i), is_real, is_not)
         if (.not. valid(i) .or. (likely_real(i) .and. .not. is_real)) &
            call examine_extended(sums, numbers, partner, starts(:, i), more_corrections, likely_real(i), v, r, valid(i), is_real, &
                                  is_not)
         if (.not. valid(i)) cycle
         if (orbits) then
            call third_pivot(v([at_x, at_a, at_y, at_b]), r([at_x, at_a, at_y, at_b]), key(1, i), radius(1, i))
            call third_pivot(v([at_xh, at_ah, at_yh, at_bh]), r([at_xh, at_ah, at_yh, at_bh]), key(2, i), radius(2, i))
         else
            key(:, i) = v(keys)
            radius(:, i) = r(keys)
         end if
         if (i == uncounted) cycle
         certificate%proven = certificate%proven + 1
         if (is_real) certificate%real_ones = certificate%real_ones + 1
         if (is_not) certificate%not_real = certificate%not_real + 1
      end do
      call count_apart(valid, key, radius, uncounted, certificate%apart)
   end subroutine examine_all

   !> Three times a plus s less s x/u: sum of the three pivots, which exchange of the legs and cognates leave alone; with its disc.
   pure subroutine third_pivot(legs, r, key, radius)
      complex(wp), intent(in) :: legs(4)             !! x, a, u, s
      real(wp), intent(in) :: r(4)
      complex(wp), intent(out) :: key
      real(wp), intent(out) :: radius
      complex(wp) :: quotient
      real(wp) :: product_radius

      quotient = legs(4)*legs(1)/legs(3)
      key = 3.0_wp*legs(2) + legs(4) - quotient
      radius = huge(1.0_wp)
      if (abs(legs(3)) <= 2.0_wp*r(3)) return
      product_radius = abs(legs(4))*r(1) + abs(legs(1))*r(4) + r(1)*r(4)
      radius = (product_radius + abs(quotient)*r(3))/(abs(legs(3)) - r(3)) + 3.0_wp*r(2) + r(4) + &
               rounding*(abs(quotient) + 3.0_wp*abs(legs(2)) + abs(legs(4)))
      radius = outward*radius
   end subroutine third_pivot

   !> Solutions of which some disc meets none of each other's.
   pure subroutine count_apart(valid, key, radius, uncounted, apart)
      logical, intent(in) :: valid(:)                !! shape (count): with discs
      complex(wp), intent(in) :: key(:, :)           !! shape (numbers, count)
      real(wp), intent(in) :: radius(:, :)
      integer, intent(in) :: uncounted
      integer, intent(out) :: apart
      logical :: meets(size(valid))
      integer :: i, k

      meets = .false.
      do i = 1, size(valid)
         if (.not. valid(i)) cycle
         do k = i + 1, size(valid)
            if (.not. valid(k)) cycle
            if (abs(real(key(1, i) - key(1, k), wp)) > outward*(radius(1, i) + radius(1, k))) cycle
            if (any(abs(key(:, i) - key(:, k)) > outward*(radius(:, i) + radius(:, k)))) cycle
            meets(i) = .true.
            meets(k) = .true.
         end do
      end do
      apart = count(valid .and. .not. meets)
      if (uncounted == 0) return
      if (valid(uncounted) .and. .not. meets(uncounted)) apart = apart - 1
   end subroutine count_apart
end module psalm_certificate
