!> What a joint with clearance feels in a turn of the crank: its load without the clearance, and the inertia that a pair of
!> opposite forces moves there, for any revolute joint of any linkage.
!>
!> The joint is taken apart, the crank held: the mechanism then has two freedoms, the displacement (u, v) of the pin in its hole.
!> The motion of every link for a unit of u and of v follows from the conditions of all other joints, one linear system a
!> position; the 2 by 2 tensor is the kinetic energy of that motion. Source: Haines, chapters 3 and 4, for one joint of a four-bar.
module psalm_joint_load
   use psalm_crank_motion, only: crank_motion_t, move_in_turn
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t
   use psalm_force_model, only: force_model_t, vertices_of, parameter_mass, parameter_mx, parameter_my, parameter_inertia
   use psalm_kinds, only: wp
   use psalm_group_reactions, only: group_couple_t, effects_of_couple
   use psalm_kinetostatics, only: forces_t, couples_of_group, prepare_forces, clear_wrenches, add_source, sweep, &
                                  joint_rows, source_inertia, sources_of
   use psalm_lapack, only: solve_general
   use psalm_mechanism, only: body_frame, joint_gear, joint_prismatic
   use psalm_rates, only: rates_t, prepare_rates, differentiate, is_dead
   implicit none (type, external)
   private
   public :: joint_load_t, find_joint_load

   integer, parameter :: freedoms = 3 !! of a body: x, y, angle

   !> Arrays have the shape (.., positions): at equal steps of time from the reference position of the crank. SI units.
   type :: joint_load_t
      type(crank_motion_t) :: crank              !! at these steps
      real(wp), allocatable :: inertia(:, :)     !! shape (2, positions): load x and y of inertia at a mean of 1 rad/s
      real(wp), allocatable :: fixed(:, :)       !! of weight, loads and springs, N
      real(wp), allocatable :: tensor(:, :)      !! shape (3, positions): M_uu, M_uv, M_vv in machine axes, kg
      integer :: failure = 0                     !! position at which it does not close or passes a dead point; 0: none
      integer :: loop = 0                        !! and the loop
      logical :: closes = .true.                 !! it is a dead point
      integer :: loose = 0                       !! position at which the joint taken apart leaves more than two freedoms; 0: none
   end type joint_load_t

contains

   !> Follow a revolute joint. The load is that of its first body on its second, the displacement that of the first in the second.
   !> `motion`: how the bodies move for a unit of u and of v; a slide may be taken apart for it, which is then displaced across its
   !> line and turned.
   subroutine find_joint_load(given, dimensions, model, joint, points, crank, load, motion_of_bodies)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model       !! without friction
      integer, intent(in) :: joint
      integer, intent(in) :: points                  !! positions in a turn
      type(crank_motion_t), intent(in) :: crank      !! dampers feel its speed
      type(joint_load_t), intent(out) :: load
      real(wp), allocatable, intent(out), optional :: motion_of_bodies(:, :, :, :) !! shape (3, bodies, 2, positions): of the
                                                     !! reference of each body, in machine axes; turning
      class(problem_t), allocatable :: problem        ! large: it would fill a small stack
      type(motion_t) :: motion
      type(rates_t) :: rates
      type(forces_t) :: forces
      integer :: block, offset, n, i, loop, source
      logical :: ok

      load%crank = crank%at_steps(points)
      allocate (load%inertia(2, points), load%fixed(2, points), load%tensor(3, points), source=0.0_wp)
      if (present(motion_of_bodies)) allocate (motion_of_bodies(freedoms, size(model%reference), 2, points), source=0.0_wp)
      allocate (problem, source=given)
      call problem%set_inputs(load%crank%input)
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(dimensions, motion)
      load%failure = findloc(motion%closed, .false., dim=1)
      load%closes = load%failure == 0
      if (load%failure > 0) return
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         do i = 1, n
            do loop = 1, problem%mechanism%nloop
               if (.not. is_dead(problem, rates, loop, i)) cycle
               load%failure = offset + i
               load%loop = loop
               return
            end do
         end do
         call move_in_turn(load%crank, problem, rates, offset, n, 1.0_wp, forces)
         call clear_wrenches(n, forces)
         call add_source(problem, model, source_inertia, motion%input(offset + 1:offset + n), n, forces)
         call sweep(problem, n, forces)
         load%inertia(:, offset + 1:offset + n) = transpose(joint_rows(problem, forces, joint, n))
         call move_in_turn(load%crank, problem, rates, offset, n, crank%sense*crank%speed, forces)
         call clear_wrenches(n, forces)
         do source = source_inertia + 1, sources_of(model)
            call add_source(problem, model, source, motion%input(offset + 1:offset + n), n, forces)
         end do
         call sweep(problem, n, forces)
         load%fixed(:, offset + 1:offset + n) = transpose(joint_rows(problem, forces, joint, n))
         do i = 1, n
            if (present(motion_of_bodies)) then
               call find_tensor(problem, model, forces, joint, i, load%tensor(:, offset + i), ok, &
                                motion_of_bodies(:, :, :, offset + i))
            else
               call find_tensor(problem, model, forces, joint, i, load%tensor(:, offset + i), ok)
            end if
            if (.not. ok .and. load%loose == 0) load%loose = offset + i
         end do
      end do
   end subroutine find_joint_load

   !> M_uu, M_uv, M_vv at position i of the block. Errors: `ok` false if the conditions of the other joints do not suffice.
   subroutine find_tensor(problem, model, forces, joint, i, tensor, ok, motion_of_bodies)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(forces_t), intent(in) :: forces
      integer, intent(in) :: joint, i
      real(wp), intent(out) :: tensor(3)
      logical, intent(out) :: ok
      real(wp), intent(inout), optional :: motion_of_bodies(:, :, :) !! shape (3, bodies, 2)
      real(wp) :: matrix(freedoms*size(forces%bodies), freedoms*size(forces%bodies))
      real(wp) :: right(freedoms*size(forces%bodies), 2), moved(freedoms*size(forces%bodies), 2)
      real(wp) :: reference(2, size(forces%bodies)), metre
      integer :: slot(size(forces%bodies)), row_of(size(problem%mechanism%joints))
      integer :: b, j, row, u, unknowns, input, input_joint

      metre = model%metre/forces%unit
      input = 0
      input_joint = problem%mechanism%actuators(1)%joint
      if (input_joint > 0) input = problem%mechanism%arcs(problem%mechanism%actuators(1)%arc)%body
      ! frame and input link are held; a driven cylinder moves as one, barrel and rod
      slot = 0
      unknowns = 0
      do b = body_frame + 1, size(forces%bodies)
         reference(:, b) = metre*[problem%linkage%store%v(i, forces%bodies(b)%px), &
                                  problem%linkage%store%v(i, forces%bodies(b)%py)]
         if (b == input .or. problem%mechanism%bodies(b)%is_rod) cycle
         unknowns = unknowns + freedoms
         slot(b) = unknowns - freedoms
      end do
      matrix = 0.0_wp
      right = 0.0_wp
      row = 1
      do j = 1, size(problem%mechanism%joints)
         if (j == input_joint .or. problem%mechanism%joints(j)%kind == joint_gear) cycle
         ok = row < unknowns
         if (.not. ok) return
         row_of(j) = row
         call add_conditions(j)
         row = row + 2
         if (forces%along(j) == 0) cycle
         ok = row <= unknowns
         if (.not. ok) return
         call hold_along(j)
         row = row + 1
      end do
      call hold_drives()
      if (ok) call hold_ties()
      ok = ok .and. row == unknowns + 1
      if (.not. ok) return
      ! the input's pivot taken apart: the link moves without turning, frame minus link is the displacement
      if (joint == input_joint) call move_input()
      do u = 1, 2
         call solve_general(matrix(:unknowns, :unknowns), right(:unknowns, u), moved(:unknowns, u), ok)
         if (.not. ok) return
      end do
      tensor = [energy(1, 1), energy(1, 2), energy(2, 2)]
      if (.not. present(motion_of_bodies)) return
      do b = body_frame + 1, size(forces%bodies)
         do u = 1, 2
            motion_of_bodies(:, b, u) = motion_of(b, u)
         end do
      end do

   contains

      !> True if the motion of a body is not looked for.
      pure logical function is_held(body)
         integer, intent(in) :: body

         is_held = body == body_frame .or. body == input
      end function is_held

      !> The body that moves as one with another: a rod with its barrel.
      pure integer function whole(body)
         integer, intent(in) :: body

         whole = body
         associate (of => problem%mechanism%bodies(body))
            if (of%is_rod) whole = problem%mechanism%arcs(of%axis)%body
         end associate
      end function whole

      !> What moves with the input's pivot taken apart: the conditions of joints on the input link feel it.
      subroutine move_input()
         integer :: k

         do k = 1, size(problem%mechanism%joints)
            associate (of => problem%mechanism%joints(k))
               if (k == input_joint .or. of%kind == joint_gear) cycle
               associate (at => row_of(k))
                  if (of%kind == joint_prismatic) then
                     if (of%bodies(2) == input) right(at, :) = right(at, :) + normal_of(k)
                     if (of%bodies(1) == input) right(at, :) = right(at, :) - normal_of(k)
                  else
                     if (of%bodies(2) == input) then
                        right(at, 1) = right(at, 1) + 1.0_wp
                        right(at + 1, 2) = right(at + 1, 2) + 1.0_wp
                     else if (of%bodies(1) == input) then
                        right(at, 1) = right(at, 1) - 1.0_wp
                        right(at + 1, 2) = right(at + 1, 2) - 1.0_wp
                     end if
                  end if
               end associate
            end associate
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

      !> Where a joint is, metres.
      function place_of(k) result(point)
         integer, intent(in) :: k
         real(wp) :: point(2)

         associate (of => problem%mechanism%joints(k), link => problem%linkage)
            point = metre*[link%store%v(i, link%point_x(problem%plan%joint_points(of%point))), &
                           link%store%v(i, link%point_y(problem%plan%joint_points(of%point)))]
         end associate
      end function place_of

      !> Points of both bodies at a joint move alike; at the joint taken apart those of the first move by (u, v) against the second.
      subroutine add_conditions(k)
         integer, intent(in) :: k
         real(wp) :: point(2), normal(2), sign_of, arm(2)
         integer :: side, body

         associate (of => problem%mechanism%joints(k))
            point = place_of(k)
            normal = 0.0_wp
            if (of%kind == joint_prismatic) normal = normal_of(k)
            do side = 1, 2
               body = whole(of%bodies(side))
               if (is_held(body)) cycle
               sign_of = real(3 - 2*side, wp)
               arm = point - reference(:, body)
               associate (c => slot(body))
                  if (of%kind == joint_prismatic) then
                     matrix(row, c + 1) = sign_of*normal(1)
                     matrix(row, c + 2) = sign_of*normal(2)
                     matrix(row, c + 3) = sign_of*(normal(2)*arm(1) - normal(1)*arm(2))
                     matrix(row + 1, c + 3) = sign_of
                  else
                     matrix(row, c + 1) = sign_of
                     matrix(row, c + 3) = -sign_of*arm(2)
                     matrix(row + 1, c + 2) = sign_of
                     matrix(row + 1, c + 3) = sign_of*arm(1)
                  end if
               end associate
            end do
         end associate
         if (k == joint) then
            right(row, 1) = 1.0_wp
            right(row + 1, 2) = 1.0_wp
         end if
      end subroutine add_conditions

      !> A drive along a slide holds it.
      subroutine hold_along(k)
         integer, intent(in) :: k
         real(wp) :: normal(2), along(2), arm(2)
         integer :: side, body

         normal = normal_of(k)
         along = [normal(2), -normal(1)]
         do side = 1, 2
            body = whole(problem%mechanism%joints(k)%bodies(side))
            if (is_held(body)) cycle
            arm = place_of(k) - reference(:, body)
            associate (c => slot(body))
               matrix(row, c + 1:c + 2) = real(3 - 2*side, wp)*along
               matrix(row, c + 3) = real(3 - 2*side, wp)*(along(2)*arm(1) - along(1)*arm(2))
            end associate
         end do
      end subroutine hold_along

      !> Drives after the first hold the links that they turn on the frame.
      subroutine hold_drives()
         integer :: d

         do d = 2, size(problem%mechanism%actuators)
            associate (actuator => problem%mechanism%actuators(d))
               if (actuator%joint == 0 .or. actuator%slides) cycle
               ok = row <= unknowns
               if (.not. ok) return
               matrix(row, slot(problem%mechanism%arcs(actuator%arc)%body) + 3) = 1.0_wp
               row = row + 1
            end associate
         end do
      end subroutine hold_drives

      !> What does no work against the forces and couples of wheels in mesh, and of drives between links.
      subroutine hold_ties()
         type(group_couple_t), allocatable :: couples(:)
         real(wp) :: on(freedoms, 3)
         integer :: loop, k, side

         do loop = 1, problem%mechanism%nloop
            call couples_of_group(problem, forces, loop, couples)
            do k = 1, size(couples)
               ok = row <= unknowns
               if (.not. ok) return
               call effects_of_couple(couples(k), problem%linkage%store, i, 1.0_wp/metre, on)
               do side = 1, size(on, 2)
                  associate (body => couples(k)%bodies(side))
                     if (body == 0) cycle
                     if (is_held(body)) cycle
                     associate (c => slot(body))
                        matrix(row, c + 1:c + 2) = matrix(row, c + 1:c + 2) + on(:2, side)
                        ! moments are about the origin
                        matrix(row, c + 3) = matrix(row, c + 3) + (on(freedoms, side) - (reference(1, body)*on(2, side) - &
                                                                                         reference(2, body)*on(1, side)))
                     end associate
                  end associate
               end do
               row = row + 1
            end do
         end do
      end subroutine hold_ties

      !> The motion of a body for a unit of a displacement.
      pure function motion_of(body, p) result(a)
         integer, intent(in) :: body, p
         real(wp) :: a(freedoms), arm(2)

         a = 0.0_wp
         if (body == input) then
            if (joint == input_joint) a(p) = -1.0_wp
            return
         end if
         associate (as => whole(body))
            a = moved(slot(as) + 1:slot(as) + freedoms, p)
            if (as == body) return
            arm = reference(:, body) - reference(:, as)
            a(1) = a(1) - a(3)*arm(2)
            a(2) = a(2) + a(3)*arm(1)
         end associate
      end function motion_of

      !> Twice the mixed kinetic energy of the motions for units of both displacements.
      pure real(wp) function energy(p, q)
         integer, intent(in) :: p, q
         real(wp) :: a(freedoms), b(freedoms), first(2)
         integer :: body

         energy = 0.0_wp
         do body = body_frame + 1, size(forces%bodies)
            associate (of => model%inertia(:, body), rows => forces%bodies(body), w => forces%w%v)
               if (body == input .and. joint /= input_joint) cycle
               a = motion_of(body, p)
               b = motion_of(body, q)
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
