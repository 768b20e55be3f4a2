!> Problems of the literature whose optimum is known, for the tests of the solvers. No linkage is among them.
module textbook
   use psalm_kinds, only: wp
   use psalm_nlp, only: nlp_t, plain_nlp_t, normal_equations_t
   implicit none (type, external)
   private
   public :: rosenbrock_t, rosen_suzuki_t, hock_schittkowski_100_t, himmelblau_t, circle_t, timed_circle_t, whole_circle_t, &
             contradiction_t
   public :: rosenbrock, rosen_suzuki, hock_schittkowski_100, himmelblau, circle, timed_circle, whole_circle, contradiction

   !> Rosenbrock (1960): 100 (x2 - x1^2)^2 + (1 - x1)^2; least 0 at (1, 1).
   type, extends(plain_nlp_t) :: rosenbrock_t
   contains
      procedure :: residuals_at => residuals_of_rosenbrock
   end type rosenbrock_t

   !> Hock and Schittkowski (1981), problem 43, of Rosen and Suzuki: quadratic, with three quadratic constraints; -44 at
   !> (0, 1, 2, -1). Written as squares, which adds 79.875.
   type, extends(plain_nlp_t) :: rosen_suzuki_t
   contains
      procedure :: residuals_at => residuals_of_rosen_suzuki
      procedure :: constraints_at => constraints_of_rosen_suzuki
   end type rosen_suzuki_t

   !> Hock and Schittkowski (1981), problem 100: no sum of squares, seven unknowns, four constraints; 680.6300573.
   type, extends(plain_nlp_t) :: hock_schittkowski_100_t
   contains
      procedure :: objective_at => objective_of_100
      procedure :: constraints_at => constraints_of_100
   end type hock_schittkowski_100_t

   !> Himmelblau (1972): (x1^2 + x2 - 11)^2 + (x1 + x2^2 - 7)^2; four minima of 0.
   type, extends(plain_nlp_t) :: himmelblau_t
   contains
      procedure :: residuals_at => residuals_of_himmelblau
   end type himmelblau_t

   !> The circle nearest to points: sum of (distance from the centre - radius)^2.
   type, extends(plain_nlp_t) :: circle_t
      real(wp), allocatable :: px(:), py(:)
   contains
      procedure :: residuals_at => residuals_of_circle
   end type circle_t

   !> The same, with the place of each point's neighbour on the circle, an angle, as a local unknown.
   type, extends(nlp_t) :: timed_circle_t
      real(wp), allocatable :: px(:), py(:)
   contains
      procedure :: measure => measure_timed
      procedure :: linearise => linearise_timed
      procedure :: accept => accept_timed
   end type timed_circle_t

   !> The same once more, all unknowns core ones.
   type, extends(plain_nlp_t) :: whole_circle_t
      real(wp), allocatable :: px(:), py(:)
   contains
      procedure :: residuals_at => residuals_of_whole_circle
   end type whole_circle_t

   !> (x1 - 3)^2 + (x2 - 3)^2 with the constraint 1 + x1^2 + x2^2 <= 0, which nothing obeys; the origin violates it least.
   type, extends(plain_nlp_t) :: contradiction_t
   contains
      procedure :: residuals_at => residuals_of_contradiction
      procedure :: constraints_at => constraints_of_contradiction
   end type contradiction_t

contains

   !> Number of unknowns and residuals, and wide bounds.
   subroutine set_sizes(problem, core, residuals, inequalities, box)
      class(plain_nlp_t), intent(inout) :: problem
      integer, intent(in) :: core, residuals, inequalities
      real(wp), intent(in) :: box                !! half of its side

      problem%core = core
      problem%residuals = residuals
      problem%inequalities = inequalities
      problem%is_sum_of_squares = residuals > 0
      problem%has_gradient = .true.
      problem%low = spread(-box, 1, core)
      problem%high = spread(box, 1, core)
   end subroutine set_sizes

   type(rosenbrock_t) function rosenbrock() result(problem)
      call set_sizes(problem, 2, 2, 0, 2.0_wp)
   end function rosenbrock

   subroutine residuals_of_rosenbrock(self, x, r, jacobian)
      class(rosenbrock_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: r(:)
      real(wp), intent(out), optional :: jacobian(:, :)

      r = [10.0_wp*(x(2) - x(1)**2), 1.0_wp - x(self%core - 1)]
      if (present(jacobian)) jacobian = reshape([-20.0_wp*x(1), -1.0_wp, 10.0_wp, 0.0_wp], [2, 2])
   end subroutine residuals_of_rosenbrock

   type(rosen_suzuki_t) function rosen_suzuki() result(problem)
      call set_sizes(problem, 4, 4, 3, 10.0_wp)
   end function rosen_suzuki

   subroutine residuals_of_rosen_suzuki(self, x, r, jacobian)
      class(rosen_suzuki_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: r(:)
      real(wp), intent(out), optional :: jacobian(:, :)
      integer :: i

      r = [x(1) - 2.5_wp, x(2) - 2.5_wp, sqrt(2.0_wp)*(x(3) - 5.25_wp), x(4) + 3.5_wp]
      if (.not. present(jacobian)) return
      jacobian = 0.0_wp
      do i = 1, self%core
         jacobian(i, i) = merge(sqrt(2.0_wp), 1.0_wp, i == 3)
      end do
   end subroutine residuals_of_rosen_suzuki

   subroutine constraints_of_rosen_suzuki(self, x, c, slopes)
      class(rosen_suzuki_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: c(:)
      real(wp), intent(out), optional :: slopes(:, :)

      c(1) = x(1)**2 + x(2)**2 + x(3)**2 + x(4)**2 + x(1) - x(2) + x(3) - x(4) - 8.0_wp
      c(2) = x(1)**2 + 2.0_wp*x(2)**2 + x(3)**2 + 2.0_wp*x(4)**2 - x(1) - x(4) - 10.0_wp
      c(self%inequalities) = 2.0_wp*x(1)**2 + x(2)**2 + x(3)**2 + 2.0_wp*x(1) - x(2) - x(4) - 5.0_wp
      if (.not. present(slopes)) return
      slopes(:, 1) = 2.0_wp*x + [1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp]
      slopes(:, 2) = [2.0_wp, 4.0_wp, 2.0_wp, 4.0_wp]*x + [-1.0_wp, 0.0_wp, 0.0_wp, -1.0_wp]
      slopes(:, 3) = [4.0_wp, 2.0_wp, 2.0_wp, 0.0_wp]*x + [2.0_wp, -1.0_wp, 0.0_wp, -1.0_wp]
   end subroutine constraints_of_rosen_suzuki

   type(hock_schittkowski_100_t) function hock_schittkowski_100() result(problem)
      call set_sizes(problem, 7, 0, 4, 10.0_wp)
   end function hock_schittkowski_100

   subroutine objective_of_100(self, x, f, gradient)
      class(hock_schittkowski_100_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: f
      real(wp), intent(out), optional :: gradient(:)

      f = (x(1) - 10.0_wp)**2 + 5.0_wp*(x(2) - 12.0_wp)**2 + x(3)**4 + 3.0_wp*(x(4) - 11.0_wp)**2 + 10.0_wp*x(5)**6 &
          + 7.0_wp*x(6)**2 + x(7)**4 - 4.0_wp*x(6)*x(7) - 10.0_wp*x(6) - 8.0_wp*x(self%core)
      if (.not. present(gradient)) return
      gradient = [2.0_wp*(x(1) - 10.0_wp), 10.0_wp*(x(2) - 12.0_wp), 4.0_wp*x(3)**3, 6.0_wp*(x(4) - 11.0_wp), &
                  60.0_wp*x(5)**5, 14.0_wp*x(6) - 4.0_wp*x(7) - 10.0_wp, 4.0_wp*x(7)**3 - 4.0_wp*x(6) - 8.0_wp]
   end subroutine objective_of_100

   subroutine constraints_of_100(self, x, c, slopes)
      class(hock_schittkowski_100_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: c(:)
      real(wp), intent(out), optional :: slopes(:, :)

      c(1) = 2.0_wp*x(1)**2 + 3.0_wp*x(2)**4 + x(3) + 4.0_wp*x(4)**2 + 5.0_wp*x(5) - 127.0_wp
      c(2) = 7.0_wp*x(1) + 3.0_wp*x(2) + 10.0_wp*x(3)**2 + x(4) - x(5) - 282.0_wp
      c(3) = 23.0_wp*x(1) + x(2)**2 + 6.0_wp*x(6)**2 - 8.0_wp*x(7) - 196.0_wp
      c(self%inequalities) = 4.0_wp*x(1)**2 + x(2)**2 - 3.0_wp*x(1)*x(2) + 2.0_wp*x(3)**2 + 5.0_wp*x(6) - 11.0_wp*x(7)
      if (.not. present(slopes)) return
      slopes = 0.0_wp
      slopes(:5, 1) = [4.0_wp*x(1), 12.0_wp*x(2)**3, 1.0_wp, 8.0_wp*x(4), 5.0_wp]
      slopes(:5, 2) = [7.0_wp, 3.0_wp, 20.0_wp*x(3), 1.0_wp, -1.0_wp]
      slopes([1, 2, 6, 7], 3) = [23.0_wp, 2.0_wp*x(2), 12.0_wp*x(6), -8.0_wp]
      slopes([1, 2, 3, 6, 7], 4) = [8.0_wp*x(1) - 3.0_wp*x(2), 2.0_wp*x(2) - 3.0_wp*x(1), 4.0_wp*x(3), 5.0_wp, -11.0_wp]
   end subroutine constraints_of_100

   type(himmelblau_t) function himmelblau() result(problem)
      call set_sizes(problem, 2, 2, 0, 6.0_wp)
   end function himmelblau

   subroutine residuals_of_himmelblau(self, x, r, jacobian)
      class(himmelblau_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: r(:)
      real(wp), intent(out), optional :: jacobian(:, :)

      r = [x(1)**2 + x(2) - 11.0_wp, x(1) + x(self%core)**2 - 7.0_wp]
      if (present(jacobian)) jacobian = reshape([2.0_wp*x(1), 1.0_wp, 1.0_wp, 2.0_wp*x(2)], [2, 2])
   end subroutine residuals_of_himmelblau

   !> The circle (x, y, radius) nearest to points.
   type(circle_t) function circle(px, py) result(problem)
      real(wp), intent(in) :: px(:), py(:)

      call set_sizes(problem, 3, size(px), 0, 100.0_wp)
      problem%px = px
      problem%py = py
   end function circle

   subroutine residuals_of_circle(self, x, r, jacobian)
      class(circle_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: r(:)
      real(wp), intent(out), optional :: jacobian(:, :)
      real(wp) :: distance(size(r))

      distance = hypot(self%px - x(1), self%py - x(2))
      r = distance - x(3)
      if (.not. present(jacobian)) return
      jacobian(:, 1) = (x(1) - self%px)/distance
      jacobian(:, 2) = (x(2) - self%py)/distance
      jacobian(:, 3) = -1.0_wp
   end subroutine residuals_of_circle

   type(timed_circle_t) function timed_circle(px, py) result(problem)
      real(wp), intent(in) :: px(:), py(:)

      problem%core = 3
      problem%local = size(px)
      problem%is_sum_of_squares = .true.
      problem%has_gradient = .true.
      problem%low = spread(-100.0_wp, 1, 3)
      problem%high = spread(100.0_wp, 1, 3)
      problem%px = px
      problem%py = py
   end function timed_circle

   subroutine measure_timed(self, x, objective, violation)
      class(timed_circle_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective, violation

      self%evaluations = self%evaluations + 1
      objective = sum((x(1) + x(3)*cos(x(4:)) - self%px)**2 + (x(2) + x(3)*sin(x(4:)) - self%py)**2)
      violation = 0.0_wp
   end subroutine measure_timed

   subroutine linearise_timed(self, x, weight, equations)
      class(timed_circle_t), intent(inout) :: self
      real(wp), intent(in) :: x(:), weight
      type(normal_equations_t), intent(inout) :: equations
      real(wp) :: rows(2, 3), turn(2), r(2)
      integer :: i, a

      if (weight >= 0.0_wp) self%jacobians = self%jacobians + 1
      call equations%clear(3, self%local)
      do i = 1, self%local
         associate (c => cos(x(3 + i)), s => sin(x(3 + i)))
            r = [x(1) + x(3)*c - self%px(i), x(2) + x(3)*s - self%py(i)]
            rows = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, c, s], [2, 3])
            turn = x(3)*[-s, c]
         end associate
         equations%gradient = equations%gradient + matmul(r, rows)
         do a = 1, 3
            equations%matrix(:, a) = equations%matrix(:, a) + matmul(rows(:, a), rows)
         end do
         equations%border(:, i) = matmul(turn, rows)
         equations%edge(i) = sum(turn**2)
         equations%edge_gradient(i) = sum(turn*r)
      end do
   end subroutine linearise_timed

   subroutine accept_timed(self, x, objective, feasible)
      class(timed_circle_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      real(wp) :: violation

      call self%measure(x, objective, violation)
      feasible = violation <= 0.0_wp
   end subroutine accept_timed

   type(whole_circle_t) function whole_circle(px, py) result(problem)
      real(wp), intent(in) :: px(:), py(:)

      call set_sizes(problem, 3 + size(px), 2*size(px), 0, 100.0_wp)
      problem%px = px
      problem%py = py
   end function whole_circle

   subroutine residuals_of_whole_circle(self, x, r, jacobian)
      class(whole_circle_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: r(:)
      real(wp), intent(out), optional :: jacobian(:, :)
      integer :: i, n

      n = size(self%px)
      r(:n) = x(1) + x(3)*cos(x(4:)) - self%px
      r(n + 1:) = x(2) + x(3)*sin(x(4:)) - self%py
      if (.not. present(jacobian)) return
      jacobian = 0.0_wp
      jacobian(:n, 1) = 1.0_wp
      jacobian(n + 1:, 2) = 1.0_wp
      jacobian(:n, 3) = cos(x(4:))
      jacobian(n + 1:, 3) = sin(x(4:))
      do i = 1, n
         jacobian(i, 3 + i) = -x(3)*sin(x(3 + i))
         jacobian(n + i, 3 + i) = x(3)*cos(x(3 + i))
      end do
   end subroutine residuals_of_whole_circle

   type(contradiction_t) function contradiction() result(problem)
      call set_sizes(problem, 2, 2, 1, 10.0_wp)
   end function contradiction

   subroutine residuals_of_contradiction(self, x, r, jacobian)
      class(contradiction_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: r(:)
      real(wp), intent(out), optional :: jacobian(:, :)

      r = x(:self%core) - 3.0_wp
      if (present(jacobian)) jacobian = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
   end subroutine residuals_of_contradiction

   subroutine constraints_of_contradiction(self, x, c, slopes)
      class(contradiction_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: c(:)
      real(wp), intent(out), optional :: slopes(:, :)

      c(self%inequalities) = 1.0_wp + sum(x**2)
      if (present(slopes)) slopes(:, 1) = 2.0_wp*x
   end subroutine constraints_of_contradiction
end module textbook
