!> A spring of zero free length that gives the drive torque a wanted value at six crank angles, up to a constant.
!>
!> The spring joins the point (x1, y1) of one link with (x2, y2) of another. Let p be the origin of the first link's axes in those
!> of the second, turned by the angle c, s. With |p| constant the torque of the spring is sum q_k H_k, k = 2 to 7,
!>   H2 = p1', H3 = p2', H4 = (p1 c + p2 s)', H5 = (p2 c - p1 s)', H6 = c', H7 = s'
!>   q2 = -S x2, q3 = -S y2, q4 = S x1, q5 = S y1, q6 = -S (x1 x2 + y1 y2), q7 = S (y1 x2 - x1 y2)
!> so that F(q) = (q2 q4 + q3 q5) q7 - (q3 q4 - q2 q5) q6 = 0. In a four-bar linkage H2 ... H7 have rank 5: a vector n of their
!> null space is free, and F(q + v n) = 0 is a quadratic equation in v, whose real roots are springs of the same torque. The six
!> angles are spaced so that the errors between them are equal. Source: Haines (about 1982), 8D and 8E; the printed 6 by 6 system
!> is singular.
module psalm_spring_exact
   use psalm_kinds, only: wp
   use psalm_lapack, only: solve_general
   implicit none (type, external)
   private
   public :: exact_spring_t, exact_task_t, prepare_exact, find_exact, columns_of_torque
   public :: exact_possible, exact_distance_varies, exact_wrong_rank

   integer, parameter :: terms = 6, points = 6     !! q2 ... q7; precision points
   integer, parameter :: exact_possible = 0, exact_distance_varies = 1, exact_wrong_rank = 2
   integer, parameter :: stencil = 8               !! points of an interpolation
   integer, parameter :: respacings = 12
   real(wp), parameter :: caution = 5.0_wp         !! eta: arcs change by the power -1/eta of their errors
   real(wp), parameter :: dependent = 1.0e-9_wp    !! a column of which less is left depends on the others

   !> The spring's columns over a turn.
   type :: exact_task_t
      real(wp), allocatable :: h(:, :)             !! shape (steps, 6)
      real(wp), allocatable :: torque(:)           !! shape (steps): without the spring, N m
      real(wp) :: null(terms) = 0.0_wp             !! vector of the null space
      integer :: dropped = 0                       !! column that is left out
      integer :: state = exact_wrong_rank          !! one of `exact_...`
   end type exact_task_t

   !> One design.
   type :: exact_spring_t
      real(wp) :: phase = 0.0_wp                   !! sum of the six angles, turns
      real(wp) :: angles(points) = 0.0_wp          !! turns
      real(wp) :: ratio = huge(1.0_wp)             !! range of the torque with the spring over that without
      real(wp) :: stiffness = 0.0_wp               !! N/m
      real(wp) :: at(2, 2) = 0.0_wp                !! (x1, y1), (x2, y2), m
      logical :: real = .false.                    !! there is such a spring, of positive stiffness
   end type exact_spring_t

contains

   !> H1 = p1 p1' + p2 p2', which must vanish, then H2 ... H7. Shapes: (steps), (steps, 7).
   pure function columns_of_torque(p1, p2, c, s, d1, d2, dc, ds) result(h)
      real(wp), intent(in), dimension(:) :: p1, p2, c, s, d1, d2, dc, ds !! p, direction, and their derivatives by the crank angle
      real(wp) :: h(size(p1), terms + 1)

      h(:, 1) = p1*d1 + p2*d2
      h(:, 2) = d1
      h(:, 3) = d2
      h(:, 4) = d1*c + p1*dc + d2*s + p2*ds
      h(:, 5) = d2*c + p2*dc - d1*s - p1*ds
      h(:, 6) = dc
      h(:, 7) = ds
   end function columns_of_torque

   !> Whether the method can be used, and the null vector.
   subroutine prepare_exact(h, torque, task)
      real(wp), intent(in) :: h(:, :)              !! shape (steps, 7): by `columns_of_torque`
      real(wp), intent(in) :: torque(:)            !! shape (steps)
      type(exact_task_t), intent(out) :: task
      real(wp) :: left(size(torque), terms), scale(terms), mix(terms, terms), factor
      integer :: order(terms), k, j, i
      logical :: used(terms)

      task%h = h(:, 2:)
      task%torque = torque
      task%state = exact_distance_varies
      if (maxval(abs(h(:, 1))) > dependent*maxval(abs(h(:, 2:3)))*maxval(abs(h(:, 2:5)))) return
      task%state = exact_wrong_rank
      do k = 1, terms
         scale(k) = sqrt(sum(task%h(:, k)**2))
         if (.not. scale(k) > 0.0_wp) return
         left(:, k) = task%h(:, k)/scale(k)
      end do
      ! orthogonal columns; row k of `mix` is column k by the columns themselves
      mix = 0.0_wp
      used = .false.
      do k = 1, terms
         mix(k, k) = 1.0_wp
      end do
      do k = 1, terms
         order(k) = maxloc([(sum(left(:, j)**2), j=1, terms)], dim=1, mask=.not. used)
         associate (chosen => order(k))
            used(chosen) = .true.
            if (sqrt(sum(left(:, chosen)**2)) <= dependent) exit
            do j = 1, terms
               if (used(j)) cycle
               do i = 1, 2                          ! twice is enough
                  factor = dot_product(left(:, chosen), left(:, j))/sum(left(:, chosen)**2)
                  left(:, j) = left(:, j) - factor*left(:, chosen)
                  mix(j, :) = mix(j, :) - factor*mix(chosen, :)
               end do
            end do
         end associate
      end do
      if (k /= terms) return                       ! rank 5 is wanted
      task%dropped = order(terms)
      task%null = mix(task%dropped, :)/scale
      task%null = task%null/maxval(abs(task%null))
      task%state = exact_possible
      if (abs(auxiliary(task%null)) > 1.0e-6_wp) task%state = exact_wrong_rank
   end subroutine prepare_exact

   !> F(q).
   pure real(wp) function auxiliary(q)
      real(wp), intent(in) :: q(terms)             !! q2 ... q7

      auxiliary = (q(1)*q(3) + q(2)*q(4))*q(6) - (q(2)*q(3) - q(1)*q(4))*q(5)
   end function auxiliary

   !> The springs at a phase: up to two of the same torque. Without `from` the six angles begin equally spaced; with `respace` they
   !> are moved until the errors between them are equal, their sum kept.
   subroutine find_exact(task, phase, respace, designs, from)
      type(exact_task_t), intent(in) :: task
      real(wp), intent(in) :: phase                !! sum of the six angles, turns
      logical, intent(in) :: respace
      type(exact_spring_t), intent(out) :: designs(2)
      real(wp), intent(in), optional :: from(:)    !! shape (6): angles to begin with, turns
      real(wp) :: angles(points), q(terms), best_q(terms), best_angles(points), worst(points), arcs(points), ratio, best
      integer :: k, round
      logical :: valid

      angles = [(phase/real(points, wp) + (real(k, wp) - 0.5_wp*real(points + 1, wp))/real(points, wp), k=1, points)]
      if (present(from)) angles = from + (phase - sum(from))/real(points, wp)
      designs%phase = phase
      best = huge(1.0_wp)
      do round = 0, merge(respacings, 0, respace)
         call fit(task, angles, q, worst, ratio, valid)
         if (.not. valid) exit
         if (ratio < best) then
            best = ratio
            best_q = q
            best_angles = angles
         end if
         if (.not. respace) exit
         if (.not. maxval(worst) > 0.0_wp) exit
         arcs(:points - 1) = angles(2:) - angles(:points - 1)
         arcs(points) = 1.0_wp + angles(1) - angles(points)
         arcs = arcs*fifth_root(max(worst/maxval(worst), 1.0e-6_wp))
         arcs = arcs/sum(arcs)
         angles(1) = 0.0_wp
         do k = 2, points
            angles(k) = angles(k - 1) + arcs(k - 1)
         end do
         angles = angles + (phase - sum(angles))/real(points, wp)
      end do
      if (.not. best < huge(1.0_wp)) return
      designs(1)%angles = best_angles
      designs(2)%angles = best_angles
      designs%ratio = best
      call take_roots(task, best_q, designs)
   end subroutine find_exact

   !> The power -1/eta of errors, by Newton's method: no function of a library is needed.
   pure elemental real(wp) function fifth_root(error) result(y)
      real(wp), intent(in) :: error                !! 0 to 1
      integer :: k

      ! y**-5 = error, from below
      y = 1.0_wp
      do k = 1, 200
         y = y*(1.0_wp + (1.0_wp - error*y**int(caution))/caution)
      end do
   end function fifth_root

   !> Coefficients that make the torque constant at six angles; greatest error on each arc between them; ratio of the ranges.
   subroutine fit(task, angles, q, worst, ratio, valid)
      type(exact_task_t), intent(in) :: task
      real(wp), intent(in) :: angles(:)            !! shape (6): ascending, turns
      real(wp), intent(out) :: q(terms), worst(points), ratio
      logical, intent(out) :: valid
      real(wp) :: matrix(points, points), right(points), x(points), sizes(terms), error, level
      real(wp) :: torque(size(task%torque))
      integer :: i, k, column, steps, arc

      steps = size(task%torque)
      do k = 1, terms
         sizes(k) = maxval(abs(task%h(:, k)))
      end do
      do i = 1, points
         column = 0
         do k = 1, terms
            if (k == task%dropped) cycle
            column = column + 1
            matrix(i, column) = interpolated(task%h(:, k), angles(i))/sizes(k)
         end do
         matrix(i, points) = -1.0_wp
         right(i) = -interpolated(task%torque, angles(i))
      end do
      call solve_general(matrix, right, x, valid)
      worst = 0.0_wp
      ratio = huge(1.0_wp)
      q = 0.0_wp
      if (.not. valid) return
      column = 0
      do k = 1, terms
         if (k == task%dropped) cycle
         column = column + 1
         q(k) = x(column)/sizes(k)
      end do
      level = x(points)
      torque = task%torque
      do k = 1, terms
         torque = torque + q(k)*task%h(:, k)
      end do
      do i = 1, steps
         error = abs(torque(i) - level)
         arc = count(angles <= angles(1) + modulo(real(i - 1, wp)/real(steps, wp) - angles(1), 1.0_wp))
         arc = max(1, arc)
         worst(arc) = max(worst(arc), error)
      end do
      error = maxval(task%torque) - minval(task%torque)
      if (error > 0.0_wp) ratio = (maxval(torque) - minval(torque))/error
   end subroutine fit

   !> A function given over a turn, by a polynomial through the nearest points.
   pure real(wp) function interpolated(values, turn) result(value)
      real(wp), intent(in) :: values(:)            !! at even steps from 0
      real(wp), intent(in) :: turn
      real(wp) :: at, weight
      integer :: first, i, j

      at = turn*real(size(values), wp)
      first = floor(at) - stencil/2 + 1
      value = 0.0_wp
      do i = first, first + stencil - 1
         weight = 1.0_wp
         do j = first, first + stencil - 1
            if (j /= i) weight = weight*(at - real(j, wp))/real(i - j, wp)
         end do
         value = value + weight*values(1 + modulo(i, size(values)))
      end do
   end function interpolated

   !> The real springs of q + v n.
   subroutine take_roots(task, q, designs)
      type(exact_task_t), intent(in) :: task
      real(wp), intent(in) :: q(:)                 !! shape (6)
      type(exact_spring_t), intent(inout) :: designs(:) !! shape (2)
      real(wp) :: step, below, here, above, a, b, root, found(2), v(terms)
      integer :: k

      step = maxval(abs(q))/maxval(abs(task%null))
      if (.not. step > 0.0_wp) return              ! no spring is needed
      below = auxiliary(q - step*task%null)
      here = auxiliary(q)
      above = auxiliary(q + step*task%null)
      a = 0.5_wp*(above + below) - here
      b = 0.5_wp*(above - below)
      root = b**2 - 4.0_wp*a*here
      if (root < 0.0_wp .or. .not. abs(a) > 0.0_wp) return
      root = -0.5_wp*(b + sign(sqrt(root), b))
      found = root/a
      if (abs(root) > 0.0_wp) found(2) = here/root
      do k = 1, 2
         v = q + found(k)*step*task%null
         associate (design => designs(k))
            if (abs(v(5)) >= abs(v(6))) then
               if (.not. abs(v(5)) > 0.0_wp) cycle
               design%stiffness = (v(1)*v(3) + v(2)*v(4))/v(5)
            else
               design%stiffness = (v(2)*v(3) - v(1)*v(4))/v(6)
            end if
            if (.not. design%stiffness > 0.0_wp) cycle
            design%at(:, 1) = v(3:4)/design%stiffness
            design%at(:, 2) = -v(1:2)/design%stiffness
            design%real = .true.
         end associate
      end do
   end subroutine take_roots
end module psalm_spring_exact
