!> Dimensional synthesis of four-bars and slider-cranks as polynomial equations in two legs.
!>
!> At the first point the fixed pivots are a and b, the pins x and y, all from that point. At point j, displaced by d, the coupler
!> is turned by 1 + g. Every number has an independent partner (names with an h) in place of its conjugate; a linkage is real
!> where both are conjugate. A leg is good for point j when
!>    (ah - dh) x g + (a - d) xh gh + (ah - xh) d + (a - x) dh - d dh = 0,   with   g gh + g + gh = 0.
!> A point has g unknown; a pose has it given; at a timed point the crank's turn 1 + f is given, x g = (x - a) f - d. In place of
!> leg b a slider: d + y g = w (dh + yh gh), w = exp(2 i direction). Source: Wampler, Morgan and Sommese (1992).
!>
!> Along the path all of these are series in its arc: d0 + d1 s + d2 s**2, g likewise. A tangent at a point is d1 of modulus 1, a
!> curvature k the term d2 = i k d1/2; the coefficients of s and s**2 of the equations of both legs and of the turn are further
!> conditions, each with a coefficient of g of its own. That is the limit of two and three points that fall together.
module psalm_leg_problem
   use psalm_kinds, only: wp, pi
   use psalm_xoshiro, only: xoshiro_t
   implicit none (type, external)
   private
   public :: leg_problem_t, leg_data_t, kind_point, kind_pose, kind_timed, kind_rate, variables, most_points, most_order
   public :: make_problem, draw_problem, turns_of, random_unit, gaussian, absolute
   public :: at_x, at_xh, at_a, at_ah, at_y, at_yh, at_b, at_bh

   integer, parameter :: kind_point = 1, kind_pose = 2, kind_timed = 3, kind_rate = 4
   integer, parameter :: variables = 8, most_points = 8
   integer, parameter :: most_order = 2              !! of the terms of a series
   integer, parameter :: at_x = 1, at_xh = 2, at_a = 3, at_ah = 4, at_y = 5, at_yh = 6, at_b = 7, at_bh = 8 !! of a slider w is at b
   real(wp), parameter :: least_term = 0.1_wp, largest_term = 20.0_wp !! of a displacement that is drawn
   real(wp), parameter :: dependent = 1.0e-10_wp     !! determinant of two equations, over its terms, that are one
   integer, parameter :: equations_of(4) = [1, 2, 2, 1] !! of a point, a pose, a timed point, a term along the path

   !> What is asked: topology of the equations, without numbers.
   type :: leg_problem_t
      integer :: points = 0                          !! beyond the first, with the terms of the series along the path
      integer :: kind(most_points) = kind_point
      integer :: order(most_points) = 0              !! of a term along the path: 1, 2
      integer :: chain(0:most_order, most_points) = 0 !! its point, 0 the first one, and the terms there up to itself
      logical :: continued(most_points) = .false.    !! a term along the path, or a point that has some
      logical :: slides = .false.                    !! a slider in place of leg b
      logical :: crank_given = .false., follower_given = .false. !! the fixed pivots
      logical :: differences = .false.               !! the last four numbers are those of leg b less those of leg a
      integer :: unknowns = 0
      integer :: free(variables) = 0                 !! the first `unknowns` elements
   contains
      procedure :: is_square
      procedure :: is_symmetric
      procedure :: has_cognates
   end type leg_problem_t

   !> The numbers of a problem.
   type :: leg_data_t
      complex(wp) :: d(most_points) = (0.0_wp, 0.0_wp), dh(most_points) = (0.0_wp, 0.0_wp) !! displacements
      complex(wp) :: turn(most_points) = (0.0_wp, 0.0_wp) !! logarithm: of the coupler's turn, timed of the crank's
      complex(wp) :: pivot(variables) = (0.0_wp, 0.0_wp)  !! those given, at their places in the unknowns
   end type leg_data_t

contains

   !> A problem of some kinds of points.
   pure subroutine make_problem(kinds, slides, crank_given, follower_given, problem, along)
      integer, intent(in) :: kinds(:)
      logical, intent(in) :: slides, crank_given, follower_given
      type(leg_problem_t), intent(out) :: problem
      integer, intent(in), optional :: along(:)      !! points, 0 the first, of terms along the path: one for each, in their order
      integer :: j, k

      problem%points = size(kinds)
      problem%kind(:size(kinds)) = kinds
      if (present(along)) then
         do k = 1, size(along)
            j = size(kinds) + k
            problem%kind(j) = kind_rate
            problem%order(j) = count(along(:k) == along(k))
            problem%chain(0, j) = along(k)
            if (along(k) > 0) problem%continued(along(k)) = .true.
            problem%continued(j) = .true.
            if (problem%order(j) > 1) problem%chain(1, j) = size(kinds) + findloc(along, along(k), dim=1)
            problem%chain(problem%order(j), j) = j
         end do
         problem%points = size(kinds) + size(along)
      end if
      problem%slides = slides
      problem%crank_given = crank_given
      problem%follower_given = follower_given
      problem%differences = .not. slides .and. all(kinds /= kind_timed) .and. (crank_given .or. .not. follower_given)
      do k = 1, variables
         if (crank_given .and. (k == at_a .or. k == at_ah)) cycle
         if (follower_given .and. .not. slides .and. (k == at_b .or. k == at_bh)) cycle
         if (slides .and. k == at_bh) cycle
         problem%unknowns = problem%unknowns + 1
         problem%free(problem%unknowns) = k
      end do
   end subroutine make_problem

   !> True if there are as many equations as unknowns: finitely many solutions.
   pure logical function is_square(self)
      class(leg_problem_t), intent(in) :: self

      is_square = sum(equations_of(self%kind(:self%points))) == self%unknowns
   end function is_square

   !> True if both legs may change places.
   pure logical function is_symmetric(self)
      class(leg_problem_t), intent(in) :: self

      is_symmetric = .not. self%slides .and. (self%crank_given .eqv. self%follower_given) .and. .not. self%crank_given .and. &
                     all(self%kind(:self%points) /= kind_timed)
   end function is_symmetric

   !> True if the coupler's path alone is asked for: cognates are solutions, too.
   pure logical function has_cognates(self)
      class(leg_problem_t), intent(in) :: self

      has_cognates = self%is_symmetric() .and. all(self%kind(:self%points) /= kind_pose)
   end function has_cognates

   !> A generic problem with one solution, drawn at random: the solution first, then displacements for which it is one.
   subroutine draw_problem(problem, random, data, solution, drawn)
      type(leg_problem_t), intent(in) :: problem
      type(xoshiro_t), intent(inout) :: random
      type(leg_data_t), intent(out) :: data
      complex(wp), intent(out) :: solution(variables)
      logical, intent(out) :: drawn
      integer, parameter :: most_steps = 60, most_tries = 40
      complex(wp) :: e, g, gh, d, dh, f(2), j11, j12, j21, j22, determinant, q, turns(most_points), partners(most_points)
      real(wp) :: stretch
      integer :: k, j, step, try

      do k = 1, variables
         solution(k) = 1.5_wp*gaussian(random)
      end do
      if (problem%slides) solution(at_bh) = (0.0_wp, 0.0_wp)
      drawn = .true.
      do j = 1, problem%points
         drawn = .false.
         do try = 1, most_tries
            if (problem%kind(j) == kind_rate) then
               call draw_term(problem, j, random, solution, turns, partners, data, drawn)
               if (drawn) exit
               cycle
            end if
            e = random_unit(random)
            if (problem%kind(j) == kind_pose) then
               ! whether a solution is at infinity may depend on the turns alone: a way on the unit circle would meet it
               call random%next(stretch)
               e = e*exp(stretch - 0.5_wp)
            end if
            g = e - 1.0_wp
            gh = 1.0_wp/e - 1.0_wp
            d = gaussian(random)
            dh = gaussian(random)
            associate (x => solution(at_x), xh => solution(at_xh), a => solution(at_a), ah => solution(at_ah), &
                       y => solution(at_y), yh => solution(at_yh), b => solution(at_b), bh => solution(at_bh))
               do step = 1, most_steps
                  f(1) = (ah - dh)*x*g + (a - d)*xh*gh + (ah - xh)*d + (a - x)*dh - d*dh
                  j11 = -xh*gh + ah - xh - dh
                  j12 = -x*g + a - x - d
                  if (problem%slides) then
                     f(2) = d + y*g - b*(dh + yh*gh)
                     j21 = (1.0_wp, 0.0_wp)
                     j22 = -b
                  else
                     f(2) = (bh - dh)*y*g + (b - d)*yh*gh + (bh - yh)*d + (b - y)*dh - d*dh
                     j21 = -yh*gh + bh - yh - dh
                     j22 = -y*g + b - y - d
                  end if
                  determinant = j11*j22 - j12*j21
                  if (.not. abs(determinant) > 0.0_wp) exit
                  d = d - (f(1)*j22 - f(2)*j12)/determinant
                  dh = dh - (j11*f(2) - j21*f(1))/determinant
                  drawn = maxval(abs(f)) < 100.0_wp*epsilon(1.0_wp)
                  if (drawn .or. abs(d) + abs(dh) > 100.0_wp) exit
               end do
               ! not the reference point itself
               drawn = drawn .and. abs(d) + abs(dh) > 0.1_wp .and. abs(d) + abs(dh) < 20.0_wp
               if (drawn) exit
            end associate
         end do
         if (.not. drawn) return
         if (problem%kind(j) == kind_rate) cycle
         turns(j) = g
         partners(j) = gh
         data%d(j) = d
         data%dh(j) = dh
         data%turn(j) = log(e)
         if (problem%kind(j) == kind_timed) then
            q = 1.0_wp + (solution(at_x)*g + d)/(solution(at_x) - solution(at_a))
            data%turn(j) = log(q)
         end if
      end do
      if (problem%differences) solution(at_y:) = solution(at_y:) - solution(:at_ah)
      data%pivot = solution
   end subroutine draw_problem

   !> The numbers of a term along the path: a turn at random and the displacement for which both legs are good.
   subroutine draw_term(problem, j, random, solution, turns, partners, data, drawn)
      type(leg_problem_t), intent(in) :: problem
      integer, intent(in) :: j
      type(xoshiro_t), intent(inout) :: random
      complex(wp), intent(in) :: solution(variables) !! without differences
      complex(wp), intent(inout) :: turns(most_points), partners(most_points)
      type(leg_data_t), intent(inout) :: data
      logical, intent(out) :: drawn
      complex(wp), dimension(0:most_order) :: g, gh, d, dh
      complex(wp) :: f(2), j11, j12, j21, j22, determinant
      real(wp) :: size
      integer :: m

      m = problem%order(j)
      turns(j) = gaussian(random)
      partners(j) = (0.0_wp, 0.0_wp)
      data%d(j) = (0.0_wp, 0.0_wp)
      data%dh(j) = (0.0_wp, 0.0_wp)
      call terms_of(problem, j, data, turns, partners, g, gh, d, dh)
      partners(j) = -modulus_term(g(:m), gh(:m))/(1.0_wp + g(0))
      gh(m) = partners(j)
      associate (x => solution(at_x), xh => solution(at_xh), a => solution(at_a), ah => solution(at_ah), &
                 y => solution(at_y), yh => solution(at_yh), b => solution(at_b), bh => solution(at_bh))
         f(1) = leg_term(x, xh, a, ah, g(:m), gh(:m), d(:m), dh(:m))
         j11 = -xh*gh(0) + ah - xh - dh(0)
         j12 = -x*g(0) + a - x - d(0)
         if (problem%slides) then
            f(2) = slide_term(y, yh, b, g(:m), gh(:m), d(:m), dh(:m))
            j21 = (1.0_wp, 0.0_wp)
            j22 = -b
         else
            f(2) = leg_term(y, yh, b, bh, g(:m), gh(:m), d(:m), dh(:m))
            j21 = -yh*gh(0) + bh - yh - dh(0)
            j22 = -y*g(0) + b - y - d(0)
         end if
      end associate
      determinant = j11*j22 - j12*j21
      drawn = abs(determinant) > 0.0_wp
      if (.not. drawn) return
      data%d(j) = -(f(1)*j22 - f(2)*j12)/determinant
      data%dh(j) = -(j11*f(2) - j21*f(1))/determinant
      size = abs(data%d(j)) + abs(data%dh(j))
      drawn = size > least_term .and. size < largest_term
   end subroutine draw_term

   !> The terms of turns and displacements at the point of a term along the path, up to its own.
   pure subroutine terms_of(problem, j, data, turns, partners, g, gh, d, dh)
      type(leg_problem_t), intent(in) :: problem
      integer, intent(in) :: j
      type(leg_data_t), intent(in) :: data
      complex(wp), intent(in) :: turns(:), partners(:)
      complex(wp), dimension(0:most_order), intent(out) :: g, gh, d, dh
      integer :: i

      g = (0.0_wp, 0.0_wp)
      gh = g
      d = g
      dh = g
      do i = 0, problem%order(j)
         associate (own => problem%chain(i, j))
            if (own == 0) cycle
            g(i) = turns(own)
            gh(i) = partners(own)
            d(i) = data%d(own)
            dh(i) = data%dh(own)
         end associate
      end do
   end subroutine terms_of

   !> Last term of the equation of a leg along the path.
   pure complex(wp) function leg_term(x, xh, a, ah, g, gh, d, dh)
      complex(wp), intent(in) :: x, xh, a, ah
      complex(wp), intent(in) :: g(0:), gh(0:), d(0:), dh(0:) !! shapes (0:order)
      integer :: i, m

      m = ubound(g, 1)
      leg_term = ah*x*g(m) + a*xh*gh(m) + (ah - xh)*d(m) + (a - x)*dh(m)
      do i = 0, m
         leg_term = leg_term - dh(i)*x*g(m - i) - d(i)*xh*gh(m - i) - d(i)*dh(m - i)
      end do
   end function leg_term

   !> The same of leg b less leg a, y, yh, b, bh being the differences.
   pure complex(wp) function difference_term(v, g, gh, d, dh)
      complex(wp), intent(in) :: v(variables)
      complex(wp), intent(in) :: g(0:), gh(0:), d(0:), dh(0:) !! shapes (0:order)
      integer :: i, m

      m = ubound(g, 1)
      associate (x => v(at_x), xh => v(at_xh), a => v(at_a), ah => v(at_ah), y => v(at_y), yh => v(at_yh), b => v(at_b), &
                 bh => v(at_bh))
         difference_term = (ah*y + bh*(x + y))*g(m) + (a*yh + b*(xh + yh))*gh(m) + (bh - yh)*d(m) + (b - y)*dh(m)
         do i = 0, m
            difference_term = difference_term - dh(i)*y*g(m - i) - d(i)*yh*gh(m - i)
         end do
      end associate
   end function difference_term

   !> The same of a slider.
   pure complex(wp) function slide_term(y, yh, w, g, gh, d, dh)
      complex(wp), intent(in) :: y, yh, w
      complex(wp), intent(in) :: g(0:), gh(0:), d(0:), dh(0:) !! shapes (0:order)
      integer :: m

      m = ubound(g, 1)
      slide_term = d(m) + y*g(m) - w*(dh(m) + yh*gh(m))
   end function slide_term

   !> The same of the modulus of the coupler's turn.
   pure complex(wp) function modulus_term(g, gh)
      complex(wp), intent(in) :: g(0:), gh(0:)       !! shapes (0:order)
      integer :: i, m

      m = ubound(g, 1)
      modulus_term = g(m) + gh(m)
      do i = 0, m
         modulus_term = modulus_term + g(i)*gh(m - i)
      end do
   end function modulus_term

   !> x, xh, a, ah, y, yh, b, bh of a solution.
   pure function absolute(problem, v) result(legs)
      type(leg_problem_t), intent(in) :: problem
      complex(wp), intent(in) :: v(variables)
      complex(wp) :: legs(variables)

      legs = v
      if (problem%differences) legs(at_y:) = v(at_y:) + v(:at_ah)
   end function absolute

   !> Turns of the coupler at all points, 1 + g and its partner less 1, that belong to the legs of a solution.
   pure subroutine turns_of(problem, data, v, g, gh)
      type(leg_problem_t), intent(in) :: problem
      type(leg_data_t), intent(in) :: data
      complex(wp), intent(in) :: v(variables)
      complex(wp), intent(out) :: g(:), gh(:)        !! shape (points)
      complex(wp) :: u(2), w(2), r(2), determinant, q, turns(most_points), partners(most_points)
      integer :: j

      do j = 1, problem%points
         associate (x => v(at_x), xh => v(at_xh), a => v(at_a), ah => v(at_ah), y => v(at_y), yh => v(at_yh), &
                    b => v(at_b), bh => v(at_bh), d => data%d(j), dh => data%dh(j))
            select case (problem%kind(j))
            case (kind_pose)
               g(j) = exp(data%turn(j)) - 1.0_wp
               gh(j) = exp(-data%turn(j)) - 1.0_wp
            case (kind_timed)
               q = exp(data%turn(j))
               g(j) = ((x - a)*(q - 1.0_wp) - d)/x
               gh(j) = ((xh - ah)*(1.0_wp/q - 1.0_wp) - dh)/xh
            case (kind_rate)
               turns(:j - 1) = g(:j - 1)
               partners(:j - 1) = gh(:j - 1)
               call turn_of_term(problem, j, data, v, turns, partners)
               g(j) = turns(j)
               gh(j) = partners(j)
            case default
               u(1) = (ah - dh)*x
               w(1) = (a - d)*xh
               r(1) = d*dh - (ah - xh)*d - (a - x)*dh
               if (problem%slides) then
                  u(2) = y
                  w(2) = -b*yh
                  r(2) = b*dh - d
               else if (problem%differences) then
                  u(2) = (ah - dh)*y + bh*(x + y)
                  w(2) = (a - d)*yh + b*(xh + yh)
                  r(2) = (yh - bh)*d + (y - b)*dh
               else
                  u(2) = (bh - dh)*y
                  w(2) = (b - d)*yh
                  r(2) = d*dh - (bh - yh)*d - (b - y)*dh
               end if
               determinant = u(1)*w(2) - u(2)*w(1)
               if (.not. abs(determinant) > dependent*(abs(u(1)*w(2)) + abs(u(2)*w(1)))) then
                  call either_turn(u, w, r, g(j), gh(j))
               else if (abs(determinant) > 0.0_wp) then
                  g(j) = (r(1)*w(2) - r(2)*w(1))/determinant
                  gh(j) = (u(1)*r(2) - u(2)*r(1))/determinant
               else
                  g(j) = (0.0_wp, 0.0_wp)
                  gh(j) = (0.0_wp, 0.0_wp)
               end if
            end select
         end associate
      end do
   end subroutine turns_of

   !> The turn of a term along the path: three linear equations, of which two are independent.
   pure subroutine turn_of_term(problem, j, data, v, turns, partners)
      type(leg_problem_t), intent(in) :: problem
      integer, intent(in) :: j
      type(leg_data_t), intent(in) :: data
      complex(wp), intent(in) :: v(variables)
      complex(wp), intent(inout) :: turns(most_points), partners(most_points)
      complex(wp), dimension(0:most_order) :: g, gh, d, dh
      complex(wp) :: u(3), w(3), r(3), n(3)
      real(wp) :: square
      integer :: m

      m = problem%order(j)
      turns(j) = (0.0_wp, 0.0_wp)
      partners(j) = (0.0_wp, 0.0_wp)
      call terms_of(problem, j, data, turns, partners, g, gh, d, dh)
      associate (x => v(at_x), xh => v(at_xh), a => v(at_a), ah => v(at_ah), y => v(at_y), yh => v(at_yh), &
                 b => v(at_b), bh => v(at_bh))
         u(1) = (ah - dh(0))*x
         w(1) = (a - d(0))*xh
         r(1) = -leg_term(x, xh, a, ah, g(:m), gh(:m), d(:m), dh(:m))
         if (problem%slides) then
            u(2) = y
            w(2) = -b*yh
            r(2) = -slide_term(y, yh, b, g(:m), gh(:m), d(:m), dh(:m))
         else if (problem%differences) then
            u(2) = (ah - dh(0))*y + bh*(x + y)
            w(2) = (a - d(0))*yh + b*(xh + yh)
            r(2) = -difference_term(v, g(:m), gh(:m), d(:m), dh(:m))
         else
            u(2) = (bh - dh(0))*y
            w(2) = (b - d(0))*yh
            r(2) = -leg_term(y, yh, b, bh, g(:m), gh(:m), d(:m), dh(:m))
         end if
      end associate
      u(3) = 1.0_wp + gh(0)
      w(3) = 1.0_wp + g(0)
      r(3) = -modulus_term(g(:m), gh(:m))
      n(1) = conjg(u(2)*w(3) - u(3)*w(2))
      n(2) = conjg(u(3)*w(1) - u(1)*w(3))
      n(3) = conjg(u(1)*w(2) - u(2)*w(1))
      square = real(n(1)*conjg(n(1)) + n(2)*conjg(n(2)) + n(3)*conjg(n(3)), wp)
      if (.not. square > 0.0_wp) return
      turns(j) = (n(1)*(r(2)*w(3) - r(3)*w(2)) + n(2)*(r(3)*w(1) - r(1)*w(3)) + n(3)*(r(1)*w(2) - r(2)*w(1)))/square
      partners(j) = (n(1)*(u(2)*r(3) - u(3)*r(2)) + n(2)*(u(3)*r(1) - u(1)*r(3)) + n(3)*(u(1)*r(2) - u(2)*r(1)))/square
   end subroutine turn_of_term

   !> One of the two turns of the coupler at a point that the coupler curve passes twice: there both legs give one equation,
   !> u g + w gh = r, and g gh + g + gh = 0 leaves a choice.
   pure subroutine either_turn(u, w, r, g, gh)
      complex(wp), intent(in) :: u(2), w(2), r(2)    !! of both legs
      complex(wp), intent(out) :: g, gh
      complex(wp) :: half, root
      integer :: k

      k = maxloc(abs(u) + abs(w), dim=1)
      g = (0.0_wp, 0.0_wp)
      gh = g
      if (.not. abs(u(k)) > 0.0_wp) return
      half = 0.5_wp*(u(k) - w(k) - r(k))/u(k)
      root = sqrt(half**2 + r(k)/u(k))
      if (real(conjg(half)*root, wp) < 0.0_wp) root = -root
      g = -(half + root)
      gh = g
      if (abs(1.0_wp + g) > 0.0_wp) gh = -g/(1.0_wp + g)
   end subroutine either_turn

   !> A random number of modulus 1.
   complex(wp) function random_unit(random)
      type(xoshiro_t), intent(inout) :: random
      real(wp) :: deviate

      call random%next(deviate)
      random_unit = cmplx(cos(2.0_wp*pi*deviate), sin(2.0_wp*pi*deviate), wp)
   end function random_unit

   !> A complex number normally distributed about 0.
   complex(wp) function gaussian(random)
      type(xoshiro_t), intent(inout) :: random
      real(wp) :: deviate

      call random%next(deviate)
      gaussian = sqrt(-log(deviate))*random_unit(random)
   end function gaussian
end module psalm_leg_problem
