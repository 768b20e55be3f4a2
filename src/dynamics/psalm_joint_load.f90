!> What a joint with clearance feels in a turn of the crank: its load without the clearance, and the inertia that a pair of
!> opposite forces moves there, for any revolute joint of any linkage.
!>
!> The joint is taken apart, the crank held: the mechanism then has two freedoms, the displacement (u, v) of the pin in its hole.
!> The motion of every link for a unit of u and of v follows from the conditions of all other joints, one linear system a
!> position; the 2 by 2 tensor is the kinetic energy of that motion. Source: Haines, chapters 3 and 4, for one joint of a four-bar.
module psalm_joint_load
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t
   use psalm_force_model, only: force_model_t, vertices_of, parameter_mass, parameter_mx, parameter_my, parameter_inertia
   use psalm_kinds, only: wp, full_turn
   use psalm_kinetostatics, only: forces_t, prepare_forces, move_bodies, clear_wrenches, add_source, sweep, joint_rows, &
                                  source_inertia, sources_of
   use psalm_lapack, only: solve_general
   use psalm_mechanism, only: body_frame, joint_prismatic
   use psalm_rates, only: rates_t, prepare_rates, differentiate, is_dead
   implicit none (type, external)
   private
   public :: joint_load_t, find_joint_load

   integer, parameter :: body_input = 2
   integer, parameter :: freedoms = 3 !! of a body: x, y, angle

   !> Arrays have the shape (.., positions): at equal steps of the crank from its reference position. SI units.
   type :: joint_load_t
      real(wp) :: sense = 1.0_wp                 !! -1: the crank turns backwards
      real(wp), allocatable :: inertia(:, :)     !! shape (2, positions): load x and y of inertia at 1 rad/s
      real(wp), allocatable :: fixed(:, :)       !! of weight, loads and springs, N
      real(wp), allocatable :: tensor(:, :)      !! shape (3, positions): M_uu, M_uv, M_vv in machine axes, kg
      integer :: trouble = 0                     !! position at which it does not close or passes a dead point; 0: none
      integer :: loop = 0                        !! and the loop
      logical :: closes = .true.                 !! it is a dead point
      integer :: loose = 0                       !! position at which the joint taken apart leaves more than two freedoms; 0: none
   end type joint_load_t

contains

   !> Follow a revolute joint. The load is that of its first body on its second, the displacement that of the first in the second.
   subroutine find_joint_load(given, dimensions, model, joint, points, speed, load)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model       !! without friction
      integer, intent(in) :: joint
      integer, intent(in) :: points                  !! positions in a turn
      real(wp), intent(in) :: speed                  !! rad/s; what dampers feel
      type(joint_load_t), intent(out) :: load
      class(problem_t), allocatable :: problem        ! large: it would fill a small stack
      type(motion_t) :: motion
      type(rates_t) :: rates
      type(forces_t) :: forces
      integer :: block, offset, n, i, loop, source
      logical :: ok

      load%sense = sign(1.0_wp, speed)
      allocate (load%inertia(2, points), load%fixed(2, points), load%tensor(3, points), source=0.0_wp)
      allocate (problem, source=given)
      call problem%set_inputs([(load%sense*full_turn*real(i - 1, wp)/real(points, wp), i=1, points)])
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(dimensions, motion)
      load%trouble = findloc(motion%closed, .false., dim=1)
      load%closes = load%trouble == 0
      if (load%trouble > 0) return
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         do i = 1, n
            do loop = 1, problem%mechanism%nloop
               if (.not. is_dead(problem, rates, loop, i)) cycle
               load%trouble = offset + i
               load%loop = loop
               return
            end do
         end do
         call move_bodies(problem, rates, n, 1.0_wp, 0.0_wp, forces)
         call clear_wrenches(n, forces)
         call add_source(problem, model, source_inertia, motion%input(offset + 1:offset + n), n, forces)
         call sweep(problem, n, forces)
         load%inertia(:, offset + 1:offset + n) = transpose(joint_rows(problem, forces, joint, n))
         call move_bodies(problem, rates, n, speed, 0.0_wp, forces)
         call clear_wrenches(n, forces)
         do source = source_inertia + 1, sources_of(model)
            call add_source(problem, model, source, motion%input(offset + 1:offset + n), n, forces)
         end do
         call sweep(problem, n, forces)
         load%fixed(:, offset + 1:offset + n) = transpose(joint_rows(problem, forces, joint, n))
         do i = 1, n
            call find_tensor(problem, model, forces, joint, i, load%tensor(:, offset + i), ok)
            if (.not. ok .and. load%loose == 0) load%loose = offset + i
         end do
      end do
   end subroutine find_joint_load

   !> M_uu, M_uv, M_vv at position i of the block. Errors: `ok` false if the conditions of the other joints do not suffice.
   subroutine find_tensor(problem, model, forces, joint, i, tensor, ok)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: joint, i
      real(wp), intent(out) :: tensor(3)
      logical, intent(out) :: ok
      real(wp) :: matrix(freedoms*(size(forces%bodies) - body_input), freedoms*(size(forces%bodies) - body_input))
      real(wp) :: right(freedoms*(size(forces%bodies) - body_input), 2), moved(freedoms*(size(forces%bodies) - body_input), 2)
      real(wp) :: reference(2, size(forces%bodies)), metre
      integer :: b, j, row, u

      metre = model%metre/forces%unit
      do b = 1, size(forces%bodies)
         reference(:, b) = metre*[problem%linkage%store%v(i, forces%bodies(b)%px), &
                                  problem%linkage%store%v(i, forces%bodies(b)%py)]
      end do
      matrix = 0.0_wp
      right = 0.0_wp
      row = 1
      do j = 1, size(problem%mechanism%joints)
         if (j == 1 .and. joint /= 1) cycle          ! the crank is held
         if (j == 1) then
            ! its pivot is taken apart: it moves without turning, frame minus crank is the displacement
            call move_input()
            cycle
         end if
         call add_conditions(j)
         row = row + 2
      end do
      ok = row == size(matrix, 1) + 1
      if (.not. ok) return
      do u = 1, 2
         call solve_general(matrix, right(:, u), moved(:, u), ok)
         if (.not. ok) return
      end do
      tensor = [energy(1, 1), energy(1, 2), energy(2, 2)]

   contains

      !> Column of a freedom of a body; 0 or less: the body is held.
      pure integer function column(body, freedom)
         integer, intent(in) :: body, freedom

         column = freedoms*(body - body_input - 1) + freedom
      end function column

      !> What moves with the crank's pivot taken apart: the conditions of joints on the crank feel it.
      subroutine move_input()
         integer :: k, at

         at = 1
         do k = 2, size(problem%mechanism%joints)
            associate (of => problem%mechanism%joints(k))
               if (of%kind == joint_prismatic) then
                  if (of%bodies(2) == body_input) right(at, :) = right(at, :) + normal_of(k)
                  if (of%bodies(1) == body_input) right(at, :) = right(at, :) - normal_of(k)
               else
                  if (of%bodies(2) == body_input) then
                     right(at, 1) = right(at, 1) + 1.0_wp
                     right(at + 1, 2) = right(at + 1, 2) + 1.0_wp
                  else if (of%bodies(1) == body_input) then
                     right(at, 1) = right(at, 1) - 1.0_wp
                     right(at + 1, 2) = right(at + 1, 2) - 1.0_wp
                  end if
               end if
            end associate
            at = at + 2
         end do
      end subroutine move_input

      !> Unit vector across the direction of a prismatic joint.
      function normal_of(k) result(normal)
         integer, intent(in) :: k
         real(wp) :: normal(2), along(2)
         integer :: slide, root

         slide = problem%mechanism%joints(k)%slide
         root = problem%plan%root(slide)
         associate (link => problem%linkage)
            along = [link%x(slide)*link%store%v(i, link%root_x(root)) - link%y(slide)*link%store%v(i, link%root_y(root)), &
                     link%x(slide)*link%store%v(i, link%root_y(root)) + link%y(slide)*link%store%v(i, link%root_x(root))]
         end associate
         along = along/norm2(along)
         normal = [-along(2), along(1)]
      end function normal_of

      !> Points of both bodies at a joint move alike; at the joint taken apart those of the first move by (u, v) against the second.
      subroutine add_conditions(k)
         integer, intent(in) :: k
         real(wp) :: point(2), normal(2), sign_of, arm(2)
         integer :: side, body

         associate (of => problem%mechanism%joints(k), link => problem%linkage)
            point = metre*[link%store%v(i, link%point_x(problem%plan%joint_points(of%point))), &
                           link%store%v(i, link%point_y(problem%plan%joint_points(of%point)))]
            normal = 0.0_wp
            if (of%kind == joint_prismatic) normal = normal_of(k)
            do side = 1, 2
               body = of%bodies(side)
               if (body <= body_input) cycle
               sign_of = real(3 - 2*side, wp)
               arm = point - reference(:, body)
               if (of%kind == joint_prismatic) then
                  matrix(row, column(body, 1)) = sign_of*normal(1)
                  matrix(row, column(body, 2)) = sign_of*normal(2)
                  matrix(row, column(body, 3)) = sign_of*(normal(2)*arm(1) - normal(1)*arm(2))
                  matrix(row + 1, column(body, 3)) = sign_of
               else
                  matrix(row, column(body, 1)) = sign_of
                  matrix(row, column(body, 3)) = -sign_of*arm(2)
                  matrix(row + 1, column(body, 2)) = sign_of
                  matrix(row + 1, column(body, 3)) = sign_of*arm(1)
               end if
            end do
         end associate
         if (k == joint) then
            right(row, 1) = 1.0_wp
            right(row + 1, 2) = 1.0_wp
         end if
      end subroutine add_conditions

      !> Twice the mixed kinetic energy of the motions for units of both displacements.
      pure real(wp) function energy(p, q)
         integer, intent(in) :: p, q
         real(wp) :: a(freedoms), b(freedoms), first(2)
         integer :: body

         energy = 0.0_wp
         do body = body_frame + 1, size(forces%bodies)
            associate (of => model%inertia(:, body), rows => forces%bodies(body), w => forces%w%v)
               if (body == body_input) then
                  if (joint /= 1) cycle
                  a = 0.0_wp
                  b = 0.0_wp
                  a(p) = -1.0_wp
                  b(q) = -1.0_wp
               else
                  a = moved(column(body, 1):column(body, 3), p)
                  b = moved(column(body, 1):column(body, 3), q)
               end if
               ! first moments in machine axes
               first = [of(parameter_mx)*w(i, rows%ex) - of(parameter_my)*w(i, rows%ey), &
                        of(parameter_mx)*w(i, rows%ey) + of(parameter_my)*w(i, rows%ex)]
               energy = energy + of(parameter_mass)*dot_product(a(1:2), b(1:2)) + of(parameter_inertia)*a(3)*b(3) &
                        + a(3)*(first(1)*b(2) - first(2)*b(1)) + b(3)*(first(1)*a(2) - first(2)*a(1))
            end associate
         end do
      end function energy
   end subroutine find_tensor
end module psalm_joint_load
