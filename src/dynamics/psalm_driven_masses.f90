!> How a linkage moves when joints of one of its links give way in the axes of that link: the masses that they move take part in the
!> vibration of the link.
!>
!> The link is given other dimensions, by which the joint stands a little aside to either side, and the linkage is solved anew; the
!> difference is how its bodies move. Joints give way in x and y, the second that holds the link along the line of both, the first
!> not at all.
module psalm_driven_masses
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_axes, only: into_axes, out_of_axes, quarter_turn
   use psalm_body_points, only: locate_point
   use psalm_crank_motion, only: crank_motion_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_flexible_link, only: flexible_link_t
   use psalm_force_model, only: force_model_t, parameter_mass, parameter_mx, parameter_my, parameter_inertia
   use psalm_joint_load, only: joint_load_t, find_joint_load
   use psalm_kinds, only: wp
   use psalm_kinetostatics, only: forces_t, prepare_forces
   use psalm_link_cycle, only: link_cycle_t, prepare_turn
   use psalm_mechanism, only: mechanism_t, arc_determined, arc_crank, at_start, at_finish, body_frame
   implicit none (type, external)
   private
   public :: influence_t, find_influence, mass_between, origin_motion

   real(wp), parameter :: aside = 1.0e-5_wp      !! of the size of the link: so far the joint is moved
   real(wp), parameter :: same_point = 1.0e-6_wp !! of it: points so near are one

   !> Directions in which joints give way, and the influence coefficients of first order: how the bodies move by them.
   type :: influence_t
      logical :: known = .false.                 !! the linkage closes with the joints aside
      integer, allocatable :: node(:), direction(:) !! of the frame of the link: 1 along x, 2 along y
      real(wp), allocatable :: motion(:, :, :, :) !! shape (3, bodies, directions, positions): of the reference of each body, m/m
                                                 !! in machine axes, and its turning, rad/m; of the link that of its frame's axes
      real(wp), allocatable :: axes(:, :, :)     !! shape (2, bodies, positions): direction of their own arcs
      real(wp), allocatable :: slide(:, :, :, :) !! of a link with a slide: as `motion`, by its displacement across the line of the
                                                 !! slide at the shoe, and by its turning there
   end type influence_t

contains

   !> Influence coefficients of a link's joints. `model` has the masses of all links; its places are used alone.
   subroutine find_influence(given, dimensions, model, link, points, crank, influence)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(flexible_link_t), intent(in) :: link
      integer, intent(in) :: points              !! positions in a turn
      type(crank_motion_t), intent(in) :: crank
      type(influence_t), intent(out) :: influence
      type(dimensions_t) :: other
      real(wp), allocatable :: at_rest(:, :, :), ahead(:, :, :), behind(:, :, :) ! shape (4, bodies, positions): place and axis
      real(wp) :: step, way(2), lever(2)
      integer :: j, g, b, i, bodies
      logical :: closes

      influence%node = [integer ::]
      influence%direction = [integer ::]
      do j = 1, size(link%nodes)
         if (any(link%nodes(:j - 1) == link%nodes(j)) .or. link%nodes(j) == link%held(1)) cycle
         influence%node = [influence%node, link%nodes(j)]
         influence%direction = [influence%direction, 1]
         if (link%nodes(j) == link%held(2)) cycle
         influence%node = [influence%node, link%nodes(j)]
         influence%direction = [influence%direction, 2]
      end do
      if (link%slide > 0) then
         call cut_joints(given, dimensions, model, link, points, crank, influence)
         return
      end if
      bodies = size(model%reference)
      step = aside*maxval(abs(link%frame%x))
      call take_poses(given, dimensions, model, link, points, crank, at_rest, influence%known)
      if (.not. influence%known) return
      allocate (influence%motion(3, bodies, size(influence%node), points), source=0.0_wp)
      influence%axes = at_rest(3:4, :, :)
      do g = 1, size(influence%node)
         way = 0.0_wp
         way(influence%direction(g)) = step
         other = dimensions
         call displace(given%mechanism, dimensions, model, link, influence%node(g), way, other)
         call take_poses(given, other, model, link, points, crank, ahead, closes)
         influence%known = influence%known .and. closes
         other = dimensions
         call displace(given%mechanism, dimensions, model, link, influence%node(g), -way, other)
         call take_poses(given, other, model, link, points, crank, behind, closes)
         influence%known = influence%known .and. closes
         if (.not. influence%known) return
         do i = 1, points
            do b = body_frame + 1, bodies
               influence%motion(:2, b, g, i) = (ahead(:2, b, i) - behind(:2, b, i))/(2.0_wp*step)
               influence%motion(3, b, g, i) = asin(behind(3, b, i)*ahead(4, b, i) - behind(4, b, i)*ahead(3, b, i))/(2.0_wp*step)
            end do
         end do
      end do
      ! of the link: from the origin of its frame's axes to the reference of its body, and back to the axes of its own arc
      do i = 1, points
         associate (axis => influence%axes(:, link%body, i))
            axis = into_axes(link%axis, axis)
            lever = -out_of_axes(axis, link%origin)
         end associate
         do g = 1, size(influence%node)
            associate (motion => influence%motion(:, link%body, g, i))
               if (link%held(2) == 0) motion = 0.0_wp ! clamped: its axes do not move as it bends
               motion(:2) = motion(:2) + motion(3)*quarter_turn(lever)
            end associate
         end do
      end do
   end subroutine find_influence

   !> The same of a link with a slide, where its axes move as the slide gives way: joint after joint is taken apart.
   subroutine cut_joints(given, dimensions, model, link, points, crank, influence)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(flexible_link_t), intent(in) :: link
      integer, intent(in) :: points
      type(crank_motion_t), intent(in) :: crank
      type(influence_t), intent(inout) :: influence
      real(wp), allocatable :: apart(:, :, :, :)  ! shape (3, bodies, 2, positions)
      real(wp) :: ahead(2)
      integer :: g, j, i

      allocate (influence%motion(3, size(model%reference), size(influence%node), points), source=0.0_wp)
      influence%known = .true.
      call cut(link%slide, influence%slide)
      if (.not. influence%known) return
      call own_axes()
      do j = 1, size(link%joints)
         if (link%nodes(j) == link%held(1)) cycle
         call cut(link%joints(j), apart)
         if (.not. influence%known) return
         do g = 1, size(influence%node)
            if (influence%node(g) /= link%nodes(j)) cycle
            do i = 1, points
               ahead = out_of_axes(influence%axes(:, link%body, i), link%axis)
               if (influence%direction(g) == 2) ahead = quarter_turn(ahead)
               influence%motion(:, :, g, i) = influence%motion(:, :, g, i) + ahead(1)*apart(:, :, 1, i) + ahead(2)*apart(:, :, 2, i)
            end do
         end do
      end do

   contains

      !> Motions by displacements of the link against its neighbour.
      subroutine cut(joint, motions)
         integer, intent(in) :: joint
         real(wp), allocatable, intent(out) :: motions(:, :, :, :)
         type(joint_load_t) :: load

         call find_joint_load(given, dimensions, model, joint, points, crank, load, motions)
         influence%known = load%failure == 0 .and. load%loose == 0
         ! the points move apart by what the link gives way: the first less the second
         if (given%mechanism%joints(joint)%bodies(1) == link%body) motions = -motions
      end subroutine cut

      !> Directions of the arcs of all bodies.
      subroutine own_axes()
         class(problem_t), allocatable :: problem ! large: it would fill a small stack
         type(link_cycle_t) :: turn
         type(forces_t) :: forces
         real(wp) :: input(points)
         integer :: block, offset, n, b

         turn%crank = crank%at_steps(points)
         call prepare_turn(given, dimensions, problem, input, turn)
         allocate (influence%axes(2, size(model%reference), points), source=0.0_wp)
         call prepare_forces(problem, model, forces)
         associate (v => problem%linkage%store%v)
            do block = 1, problem%blocks()
               call problem%solve_block(block, offset, n)
               do i = 1, n
                  do b = body_frame + 1, size(model%reference)
                     associate (rows => forces%bodies(b))
                        influence%axes(:, b, offset + i) = [rows%c*v(i, rows%root_x) - rows%s*v(i, rows%root_y), &
                                                            rows%c*v(i, rows%root_y) + rows%s*v(i, rows%root_x)]
                     end associate
                  end do
               end do
            end do
         end associate
      end subroutine own_axes
   end subroutine cut_joints

   !> Places and axes of all bodies over a turn; of the link those of its frame.
   subroutine take_poses(given, dimensions, model, link, points, crank, poses, closes)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(flexible_link_t), intent(in) :: link
      integer, intent(in) :: points              !! positions in a turn
      type(crank_motion_t), intent(in) :: crank
      real(wp), allocatable, intent(out) :: poses(:, :, :) !! shape (4, bodies, points)
      logical, intent(out) :: closes
      class(problem_t), allocatable :: problem   ! large: it would fill a small stack
      type(link_cycle_t) :: turn
      type(forces_t) :: forces
      real(wp) :: input(points), far(2)
      integer :: block, offset, n, b, i, first, second

      turn%crank = crank%at_steps(points)
      call prepare_turn(given, dimensions, problem, input, turn)
      closes = turn%failure == 0
      allocate (poses(4, size(model%reference), points), source=0.0_wp)
      if (.not. closes) return
      call prepare_forces(problem, model, forces)
      associate (mechanism => problem%mechanism, v => problem%linkage%store%v, places => problem%linkage, &
                 points_of => problem%plan%joint_points)
         first = points_of(mechanism%joints(link%joints(findloc(link%nodes, link%held(1), dim=1)))%point)
         second = first
         if (link%held(2) > 0) second = points_of(mechanism%joints(link%joints(findloc(link%nodes, link%held(2), dim=1)))%point)
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, n)
            do i = 1, n
               do b = body_frame + 1, size(model%reference)
                  associate (rows => forces%bodies(b))
                     poses(1:2, b, offset + i) = forces%metre*[v(i, rows%px), v(i, rows%py)]
                     poses(3:4, b, offset + i) = [rows%c*v(i, rows%root_x) - rows%s*v(i, rows%root_y), &
                                                  rows%c*v(i, rows%root_y) + rows%s*v(i, rows%root_x)]
                  end associate
               end do
               associate (pose => poses(:, link%body, offset + i))
                  pose(1:2) = forces%metre*[v(i, places%point_x(first)), v(i, places%point_y(first))]
                  if (second == first) then
                     pose(3:4) = out_of_axes(link%axis, pose(3:4))
                  else
                     far = forces%metre*[v(i, places%point_x(second)), v(i, places%point_y(second))] - pose(1:2)
                     pose(3:4) = far/sqrt(sum(far**2))
                  end if
               end associate
            end do
         end do
      end associate
   end subroutine take_poses

   !> Other dimensions of the link's arcs: all its points at a node are moved in the axes of its frame.
   pure subroutine displace(mechanism, dimensions, model, link, node, way, other)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(flexible_link_t), intent(in) :: link
      integer, intent(in) :: node
      real(wp), intent(in) :: way(2)             !! m
      type(dimensions_t), intent(inout) :: other
      logical :: moves(size(mechanism%points)), found
      real(wp) :: turn(size(mechanism%arcs)), place(2), at(2), move(2), old(2), new(2)
      integer :: k, n

      associate (body => mechanism%bodies(link%body), x => link%frame%x(:, node))
         place = (link%origin + out_of_axes(link%axis, x))/model%metre
         move = out_of_axes(link%axis, way)/model%metre
         moves = .false.
         do k = 1, size(body%points)
            call locate_point(mechanism, dimensions, link%body, model%reference(link%body), body%points(k), at, found)
            moves(body%points(k)) = found .and. &
                                    maxval(abs(at - place)) <= same_point*maxval(abs(link%frame%x))/model%metre
         end do
         turn = 0.0_wp
         do k = 1, size(body%arcs)
            n = body%arcs(k)
            if (mechanism%slides(n)) cycle
            associate (tips => mechanism%arcs(n)%ends)
               if (moves(tips(at_start)) .eqv. moves(tips(at_finish))) cycle
               call unit_vector(mechanism%angle_on_body(n, dimensions), old(1), old(2))
               old = dimensions%arcl(mechanism%angle_owner(n))*old
               new = old + merge(move, -move, moves(tips(at_finish)))
            end associate
            other%arcl(n) = sqrt(sum(new**2))
            turn(n) = degrees_of(old(1)*new(1) + old(2)*new(2), old(1)*new(2) - old(2)*new(1))
         end do
         do k = 1, size(body%arcs)
            n = body%arcs(k)
            associate (arc => mechanism%arcs(n))
               if (arc%kind == arc_crank .and. arc%loop == 1) then
                  other%crnki = other%crnki + turn(n)
                  other%drawn = other%drawn + turn(n)
                  other%anchor = other%anchor + turn(n)
               end if
               if (arc%kind /= arc_determined .or. arc%same .or. arc%reference == 0) cycle
               other%gama(n) = other%gama(n) + turn(n) - turn(arc%reference)
            end associate
         end do
      end associate
   end subroutine displace

   !> Mass between two motions of all bodies at one position: twice the kinetic energy that both have in common.
   pure real(wp) function mass_between(inertia, axes, one, other) result(mass)
      real(wp), intent(in) :: inertia(:, :)      !! shape (4, bodies), as of a force model
      real(wp), intent(in) :: axes(:, :)         !! shape (2, bodies)
      real(wp), intent(in) :: one(:, :), other(:, :) !! shape (3, bodies)
      real(wp) :: first(2)
      integer :: b

      mass = 0.0_wp
      do b = body_frame + 1, size(inertia, 2)
         associate (of => inertia(:, b), e => axes(:, b), v => one(:, b), w => other(:, b))
            first = out_of_axes(e, of([parameter_mx, parameter_my]))
            mass = mass + of(parameter_mass)*(v(1)*w(1) + v(2)*w(2)) + of(parameter_inertia)*v(3)*w(3) &
                   + w(3)*(v(2)*first(1) - v(1)*first(2)) + v(3)*(w(2)*first(1) - w(1)*first(2))
         end associate
      end do
   end function mass_between

   !> Motion of the origin of a link's axes in these axes, and its turning, where its body moves.
   pure function origin_motion(link, axes, motion) result(own)
      type(flexible_link_t), intent(in) :: link
      real(wp), intent(in) :: axes(:, :)         !! shape (2, bodies)
      real(wp), intent(in) :: motion(:, :)       !! shape (3, bodies)
      real(wp) :: own(3)

      associate (e => axes(:, link%body), of => motion(:, link%body))
         own(:2) = into_axes(out_of_axes(e, link%axis), of(:2) + of(3)*quarter_turn(out_of_axes(e, link%origin)))
         own(3) = of(3)
      end associate
   end function origin_motion
end module psalm_driven_masses
