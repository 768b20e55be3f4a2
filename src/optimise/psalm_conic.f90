!> Convex problems of some tens of unknowns: a linear objective over half-spaces and second-order cones.
!>
!> minimise q'x so that  s = h - Gx lies in K, a product of half-lines s_i >= 0 and cones s_1 >= |(s_2, s_3, ...)|.
!> Primal-dual interior-point method with the scaling of Nesterov and Todd (1997) and the predictor and corrector of Mehrotra
!> (1992); dense, without random numbers. The dual point that comes with the solution proves a lower bound: whatever x is allowed,
!> its objective is at least `bound`, as far as `residual` is zero. Source: Vandenberghe (2010), The CVXOPT linear and quadratic
!> cone program solvers.
module psalm_conic
   use psalm_kinds, only: wp
   use psalm_linear, only: along_columns, triangle_of
   implicit none (type, external)
   private
   public :: conic_t, conic_solution_t, solve_conic

   integer, parameter :: most_iterations = 100
   real(wp), parameter :: wanted = 1.0e-11_wp      !! relative gap and residual at which it ends
   real(wp), parameter :: enough = 1.0e-7_wp       !! at which, making no headway any more, it has still solved the problem
   real(wp), parameter :: to_the_edge = 0.99_wp    !! part of the way to the edge of the cone that is gone
   real(wp), parameter :: dependent = 1.0e-15_wp   !! part of a column that is left: it depends on those before it
   integer, parameter :: refinements = 3           !! solutions of a linear system, the later ones of what the earlier left
   integer, parameter :: most_stalled = 8          !! iterations without headway

   !> The problem.
   type :: conic_t
      real(wp), allocatable :: q(:)                !! shape (n)
      real(wp), allocatable :: g(:, :)             !! shape (m, n): rows of the half-lines first, then cone after cone
      real(wp), allocatable :: h(:)                !! shape (m)
      integer :: lines = 0                         !! half-lines
      integer, allocatable :: cones(:)             !! rows of each cone
   end type conic_t

   !> Its solution and what proves it.
   type :: conic_solution_t
      real(wp), allocatable :: x(:)                !! shape (n)
      real(wp) :: value = huge(1.0_wp)             !! objective
      real(wp) :: bound = -huge(1.0_wp)            !! dual objective: no allowed x has less
      real(wp) :: gap = huge(1.0_wp)               !! s'z, of the larger of |value| and 1
      real(wp) :: residual = huge(1.0_wp)          !! of the optimality conditions, relative
      integer :: iterations = 0
      logical :: solved = .false.
   end type conic_solution_t

   !> Scaling of the cones: W z = W**-1 s.
   type :: scaling_t
      real(wp), allocatable :: line(:)             !! of the half-lines
      real(wp), allocatable :: size(:)             !! of each cone
      real(wp), allocatable :: w(:)                !! rows of the cones: hyperbolic unit vectors
   end type scaling_t

contains

   !> Solve a problem. Not solved: it has no allowed point, or none is best, or rounding prevents it.
   subroutine solve_conic(problem, solution)
      type(conic_t), intent(in) :: problem
      type(conic_solution_t), intent(out) :: solution
      real(wp), dimension(size(problem%q)) :: x, rx, dx
      real(wp), dimension(size(problem%h)) :: s, z, rz, lambda, ds, dz, u, affine
      real(wp) :: matrix(size(problem%q), size(problem%q)), scaled(size(problem%h), size(problem%q))
      real(wp) :: gap, step, sigma, mu, best, merit, norm_q, norm_h, value, bound, residual, reach
      type(scaling_t) :: scaling
      integer :: k, degree, stalled
      logical :: valid

      allocate (solution%x(size(x)), source=0.0_wp)
      degree = problem%lines + size(problem%cones)
      norm_q = max(1.0_wp, norm(problem%q))
      norm_h = max(1.0_wp, norm(problem%h))
      call first_point(valid)
      if (.not. valid) return
      best = huge(1.0_wp)
      stalled = 0
      do k = 0, most_iterations
         solution%iterations = k
         rx = problem%q + along_columns(problem%g, z)
         rz = times(problem%g, x) + s - problem%h
         gap = dot_product(s, z)
         value = dot_product(problem%q, x)
         bound = -dot_product(problem%h, z)
         residual = max(norm(rx)/norm_q, norm(rz)/norm_h)
         merit = max(residual, gap/max(1.0_wp, abs(value)))
         if (merit < best) then
            if (merit < 0.9_wp*best) stalled = 0
            best = merit
            solution%x = x
            solution%value = value
            solution%bound = bound
            solution%gap = gap/max(1.0_wp, abs(value))
            solution%residual = residual
         end if
         if (merit <= wanted) exit
         stalled = stalled + 1
         if (stalled > most_stalled .or. .not. (merit < huge(1.0_wp))) exit
         call scale_cones(problem, s, z, scaling, lambda, valid)
         if (.not. valid) exit
         call factor(valid)
         if (.not. valid) exit
         ! predictor
         call direction(-lambda)
         affine = jordan(problem, unscale(problem, scaling, ds), rescale(problem, scaling, dz))
         reach = min(1.0_wp, longest_step(problem, lambda, unscale(problem, scaling, ds)), &
                     longest_step(problem, lambda, rescale(problem, scaling, dz)))
         sigma = min(1.0_wp, max(0.0_wp, 1.0_wp - reach + reach**2*dot_product(ds, dz)/gap))**3
         mu = gap/real(degree, wp)
         ! corrector
         u = -jordan(problem, lambda, lambda) - affine
         call add_unit(problem, sigma*mu, u)
         call divide(problem, lambda, u)
         call direction(u)
         step = min(1.0_wp, to_the_edge*longest_step(problem, lambda, unscale(problem, scaling, ds)), &
                    to_the_edge*longest_step(problem, lambda, rescale(problem, scaling, dz)))
         x = x + step*dx
         s = s + step*ds
         z = z + step*dz
      end do
      solution%solved = best <= enough

   contains

      !> Minimum of the penalised problem, moved into the cones.
      subroutine first_point(valid)
         logical, intent(out) :: valid
         integer :: i

         allocate (scaling%line(problem%lines), source=1.0_wp)
         allocate (scaling%size(size(problem%cones)), source=1.0_wp)
         allocate (scaling%w(size(problem%h) - problem%lines), source=0.0_wp)
         i = 1
         do k = 1, size(problem%cones)
            scaling%w(i) = 1.0_wp
            i = i + problem%cones(k)
         end do
         call factor(valid)
         x = 0.0_wp
         s = 0.0_wp
         z = 0.0_wp
         if (.not. valid) return
         rx = problem%q
         rz = -problem%h
         u = 0.0_wp
         call direction(u)
         x = dx
         z = dz
         s = -dz
         call move_inside(problem, s)
         call move_inside(problem, z)
      end subroutine first_point

      !> The triangle R of W**-1 G: R'R = G' W**-2 G, which is never formed.
      subroutine factor(valid)
         logical, intent(out) :: valid
         integer :: j

         do j = 1, size(x)
            scaled(:, j) = unscale(problem, scaling, problem%g(:, j))
         end do
         valid = all(abs(scaled) < sqrt(huge(1.0_wp)))
         if (valid) matrix = triangle_of(scaled)
         if (valid) call fill_zeros(matrix)
      end subroutine factor

      !> Direction towards smaller residuals with W dz + W**-1 ds = u.
      subroutine direction(u)
         real(wp), intent(in) :: u(:)
         real(wp) :: back(size(s)), miss(size(x)), before(size(x)), left
         integer :: round

         back = unscale(problem, scaling, -rz) - u
         dx = 0.0_wp
         ! again with what is left, as long as that falls: R'R is as ill-conditioned as the square of R
         left = huge(1.0_wp)
         do round = 1, refinements
            miss = along_columns(scaled, back - times(scaled, dx)) - rx
            if (round > 1 .and. norm(miss) >= left) then
               dx = before
               exit
            end if
            left = norm(miss)
            before = dx
            call solve_triangles(matrix, miss)
            dx = dx + miss
         end do
         dz = times(scaled, dx) - back
         ds = rescale(problem, scaling, u - dz)
         dz = unscale(problem, scaling, dz)
      end subroutine direction
   end subroutine solve_conic

   pure real(wp) function norm(v)
      real(wp), intent(in) :: v(:)

      norm = sqrt(sum(v**2))
   end function norm

   !> Product of a matrix and a vector.
   pure function times(matrix, x) result(y)
      real(wp), intent(in) :: matrix(:, :)         !! shape (m, n)
      real(wp), intent(in) :: x(:)                 !! shape (n)
      real(wp) :: y(size(matrix, 1))
      integer :: j

      y = 0.0_wp
      do j = 1, size(x)
         y = y + matrix(:, j)*x(j)
      end do
   end function times

   ! ---- cones -------------------------------------------------------------------------------------------------------

   !> s and z made one by a scaling: lambda = W z = W**-1 s. Not valid: one of them is on the edge or outside.
   pure subroutine scale_cones(problem, s, z, scaling, lambda, valid)
      type(conic_t), intent(in) :: problem
      real(wp), intent(in) :: s(:), z(:)           !! shape (m)
      type(scaling_t), intent(inout) :: scaling
      real(wp), intent(out) :: lambda(:)           !! shape (m)
      logical, intent(out) :: valid
      real(wp) :: size_s, size_z, bend
      integer :: k, first, last, offset

      lambda = 0.0_wp
      valid = all(s(:problem%lines) > 0.0_wp) .and. all(z(:problem%lines) > 0.0_wp)
      if (.not. valid) return
      scaling%line = sqrt(s(:problem%lines)/z(:problem%lines))
      first = problem%lines + 1
      offset = problem%lines
      do k = 1, size(problem%cones)
         last = first + problem%cones(k) - 1
         size_s = lorentz(s(first:last))
         size_z = lorentz(z(first:last))
         valid = s(first) > 0.0_wp .and. z(first) > 0.0_wp .and. size_s > 0.0_wp .and. size_z > 0.0_wp
         if (.not. valid) return
         size_s = sqrt(size_s)
         size_z = sqrt(size_z)
         bend = sqrt(0.5_wp*(1.0_wp + dot_product(s(first:last)/size_s, z(first:last)/size_z)))
         associate (w => scaling%w(first - offset:last - offset))
            w = (s(first:last)/size_s - z(first:last)/size_z)/(2.0_wp*bend)
            w(1) = (s(first)/size_s + z(first)/size_z)/(2.0_wp*bend)
         end associate
         scaling%size(k) = sqrt(size_s/size_z)
         first = last + 1
      end do
      lambda = rescale(problem, scaling, z)
      ! rounding may leave a point so near the edge of its cones that its image is outside: no step from there has a length
      first = problem%lines + 1
      do k = 1, size(problem%cones)
         last = first + problem%cones(k) - 1
         valid = valid .and. lorentz(lambda(first:last)) > 0.0_wp
         first = last + 1
      end do
   end subroutine scale_cones

   !> s_1**2 - |(s_2, ...)|**2, without cancellation.
   pure real(wp) function lorentz(s)
      real(wp), intent(in) :: s(:)
      real(wp) :: rest

      rest = norm(s(2:))
      lorentz = (s(1) - rest)*(s(1) + rest)
   end function lorentz

   !> W v.
   pure function rescale(problem, scaling, v) result(y)
      type(conic_t), intent(in) :: problem
      type(scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: v(:)
      real(wp) :: y(size(v))

      y = scaled_by(problem, scaling, v, .false.)
   end function rescale

   !> W**-1 v.
   pure function unscale(problem, scaling, v) result(y)
      type(conic_t), intent(in) :: problem
      type(scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: v(:)
      real(wp) :: y(size(v))

      y = scaled_by(problem, scaling, v, .true.)
   end function unscale

   pure function scaled_by(problem, scaling, v, inverse) result(y)
      type(conic_t), intent(in) :: problem
      type(scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: v(:)
      logical, intent(in) :: inverse
      real(wp) :: y(size(v)), inner, sense
      integer :: k, first, last

      sense = merge(-1.0_wp, 1.0_wp, inverse)
      associate (l => problem%lines)
         if (inverse) then
            y(:l) = v(:l)/scaling%line
         else
            y(:l) = v(:l)*scaling%line
         end if
         first = l + 1
         do k = 1, size(problem%cones)
            last = first + problem%cones(k) - 1
            associate (w => scaling%w(first - l:last - l), size => scaling%size(k))
               inner = dot_product(w(2:), v(first + 1:last))
               y(first) = w(1)*v(first) + sense*inner
               y(first + 1:last) = v(first + 1:last) + (sense*v(first) + inner/(1.0_wp + w(1)))*w(2:)
               if (inverse) then
                  y(first:last) = y(first:last)/size
               else
                  y(first:last) = y(first:last)*size
               end if
            end associate
            first = last + 1
         end do
      end associate
   end function scaled_by

   !> Jordan product of two vectors.
   pure function jordan(problem, a, b) result(c)
      type(conic_t), intent(in) :: problem
      real(wp), intent(in) :: a(:), b(:)
      real(wp) :: c(size(a))
      integer :: k, first, last

      associate (l => problem%lines)
         c(:l) = a(:l)*b(:l)
         first = l + 1
      end associate
      do k = 1, size(problem%cones)
         last = first + problem%cones(k) - 1
         c(first) = dot_product(a(first:last), b(first:last))
         c(first + 1:last) = a(first)*b(first + 1:last) + b(first)*a(first + 1:last)
         first = last + 1
      end do
   end function jordan

   !> Add `amount` times the unit of the Jordan product.
   pure subroutine add_unit(problem, amount, v)
      type(conic_t), intent(in) :: problem
      real(wp), intent(in) :: amount
      real(wp), intent(inout) :: v(:)
      integer :: k, first

      v(:problem%lines) = v(:problem%lines) + amount
      first = problem%lines + 1
      do k = 1, size(problem%cones)
         v(first) = v(first) + amount
         first = first + problem%cones(k)
      end do
   end subroutine add_unit

   !> v becomes the u of which the Jordan product with lambda is v.
   pure subroutine divide(problem, lambda, v)
      type(conic_t), intent(in) :: problem
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: v(:)
      integer :: k, first, last

      associate (l => problem%lines)
         v(:l) = v(:l)/lambda(:l)
         first = l + 1
      end associate
      do k = 1, size(problem%cones)
         last = first + problem%cones(k) - 1
         v(first) = (lambda(first)*v(first) - dot_product(lambda(first + 1:last), v(first + 1:last)))/lorentz(lambda(first:last))
         v(first + 1:last) = (v(first + 1:last) - v(first)*lambda(first + 1:last))/lambda(first)
         first = last + 1
      end do
   end subroutine divide

   !> The longest step along d from a point inside the cones that does not leave them.
   pure real(wp) function longest_step(problem, lambda, d) result(step)
      type(conic_t), intent(in) :: problem
      real(wp), intent(in) :: lambda(:), d(:)
      real(wp) :: steepest, size_of, along
      integer :: k, first, last

      steepest = 0.0_wp
      if (problem%lines > 0) steepest = max(0.0_wp, maxval(-d(:problem%lines)/lambda(:problem%lines)))
      first = problem%lines + 1
      do k = 1, size(problem%cones)
         last = first + problem%cones(k) - 1
         size_of = sqrt(max(lorentz(lambda(first:last)), tiny(1.0_wp)))
         associate (unit => lambda(first:last)/size_of)
            along = unit(1)*d(first) - dot_product(unit(2:), d(first + 1:last))
            steepest = max(steepest, (norm(d(first + 1:last) - (along + d(first))/(unit(1) + 1.0_wp)*unit(2:)) - along)/size_of)
         end associate
         first = last + 1
      end do
      step = huge(1.0_wp)
      if (steepest > 0.0_wp) step = 1.0_wp/steepest
   end function longest_step

   !> Add of the unit what brings a point well inside the cones.
   pure subroutine move_inside(problem, v)
      type(conic_t), intent(in) :: problem
      real(wp), intent(inout) :: v(:)
      real(wp) :: least
      integer :: k, first, last

      least = huge(1.0_wp)
      if (problem%lines > 0) least = minval(v(:problem%lines))
      first = problem%lines + 1
      do k = 1, size(problem%cones)
         last = first + problem%cones(k) - 1
         least = min(least, v(first) - norm(v(first + 1:last)))
         first = last + 1
      end do
      if (least < 1.0e-8_wp*max(1.0_wp, norm(v))) call add_unit(problem, 1.0_wp - least, v)
   end subroutine move_inside

   ! ---- linear algebra ----------------------------------------------------------------------------------------------

   !> Make a triangle one that can be solved: what the rows do not determine stays where it is.
   pure subroutine fill_zeros(r)
      real(wp), intent(inout) :: r(:, :)           !! shape (n, n)
      integer :: j

      do j = 1, size(r, 1)
         if (abs(r(j, j)) <= dependent*norm(r(:j, j))) r(j, j) = sqrt(huge(1.0_wp))
      end do
   end subroutine fill_zeros

   !> Solve R'R x = b.
   pure subroutine solve_triangles(r, b)
      real(wp), intent(in) :: r(:, :)              !! shape (n, n): upper triangle
      real(wp), intent(inout) :: b(:)              !! right side, then the solution
      integer :: j

      do j = 1, size(b)
         b(j) = (b(j) - dot_product(r(:j - 1, j), b(:j - 1)))/r(j, j)
      end do
      do j = size(b), 1, -1
         b(j) = b(j)/r(j, j)
         b(:j - 1) = b(:j - 1) - b(j)*r(:j - 1, j)
      end do
   end subroutine solve_triangles
end module psalm_conic
