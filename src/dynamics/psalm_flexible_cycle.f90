!> What a linkage does to a link of beam elements in a turn of the crank: its motion, the forces of its joints,
!> loads and springs on it; in the axes of its frame.
module psalm_flexible_cycle
   use psalm_axes, only: into_axes, out_of_axes, quarter_turn
   use psalm_crank_motion, only: crank_motion_t, move_in_turn
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_flexible_link, only: flexible_link_t, attached_t
   use psalm_force_model, only: force_model_t, load_t
   use psalm_kinds, only: wp
   use psalm_kinetostatics, only: forces_t, prepare_forces, move_bodies, clear_wrenches, add_source, sweep, joint_rows, &
                                  find_shoe, first_spring, source_inertia, sources_of
   use psalm_link_cycle, only: link_cycle_t, prepare_turn, note_dead
   use psalm_link_loads, only: acting_cycle_t, follow_acting
   use psalm_rates, only: rates_t, prepare_rates, differentiate
   use psalm_spring_law, only: part_elastic, part_viscous
   implicit none (type, external)
   private
   public :: flexible_cycle_t, find_flexible_cycle

   integer, parameter, public :: parts = 4
   integer, parameter, public :: part_inertia = 1, part_fixed = 2, part_damped = 3, part_pushed = 4 !! of the loads

   !> At equal steps of time from the reference position of the crank, at a mean speed of 1 rad/s; `pushed`: at rest, with 1 rad/s2
   !> in its sense.
   type :: flexible_cycle_t
      type(link_cycle_t) :: turn                 !! where the crank cannot turn, and its motion
      real(wp), allocatable :: acceleration(:, :) !! shape (2, positions): of the origin of the frame's axes, m
      real(wp), allocatable :: turning(:), speed(:) !! shape (positions): angular acceleration and speed
      real(wp), allocatable :: pushed(:, :)      !! shape (3, positions): acceleration of the origin, and turning
      real(wp), allocatable :: weight(:, :)      !! shape (2, positions): gravity, m/s2
      real(wp), allocatable :: forces(:, :, :, :) !! shape (2, joints, parts, positions): of the joints on the link, by
                                                 !! `part_...`: of inertia, N; of weight, loads and springs, N; of dampers;
                                                 !! of inertia where the crank is pushed
      type(acting_cycle_t), allocatable :: acting(:) !! loads, then springs on the link
      real(wp), allocatable :: shoe(:, :)        !! shape (2, positions): of its slide, the middle of the shoe, m
      real(wp), allocatable :: normal(:, :)      !! the same: unit vector across its line
      real(wp), allocatable :: reach(:)          !! shape (positions): of the shoe along the line, from the foot of the joint, m
   end type flexible_cycle_t

contains

   !> Follow a link. `model` has the masses of its segments.
   subroutine find_flexible_cycle(given, dimensions, model, link, points, crank, cycle_of)
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(flexible_link_t), intent(in) :: link
      integer, intent(in) :: points             !! positions in a turn
      type(crank_motion_t), intent(in) :: crank
      type(flexible_cycle_t), intent(out) :: cycle_of
      class(problem_t), allocatable :: problem   ! large: it would fill a small stack
      type(force_model_t) :: bare, steady, dampers
      type(rates_t) :: rates
      type(forces_t) :: forces
      real(wp) :: input(points)
      real(wp), allocatable :: unit(:, :)        ! shape (2, positions of the block): direction of the frame's x axis
      integer :: block, offset, n, source, k

      cycle_of%turn%crank = crank%at_steps(points)
      call prepare_turn(given, dimensions, problem, input, cycle_of%turn)
      if (cycle_of%turn%failure > 0) return
      allocate (cycle_of%acceleration(2, points), cycle_of%turning(points), cycle_of%speed(points), cycle_of%weight(2, points))
      allocate (cycle_of%forces(2, size(link%joints), parts, points), cycle_of%pushed(3, points), source=0.0_wp)
      if (link%slide > 0) allocate (cycle_of%shoe(2, points), cycle_of%normal(2, points), cycle_of%reach(points))
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      bare = model
      bare%gravity = 0.0_wp
      steady = model
      steady%springs%part = part_elastic
      dampers = bare
      dampers%loads = [load_t ::]
      dampers%springs%part = part_viscous
      allocate (cycle_of%acting(size(link%loads) + size(link%springs)))
      do k = 1, size(cycle_of%acting)
         call begin_acting(cycle_of%acting(k), k)
      end do
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         call note_dead(problem, rates, offset, n, cycle_of%turn)
         if (cycle_of%turn%failure > 0) return
         call move_in_turn(cycle_of%turn%crank, problem, rates, offset, n, 1.0_wp, forces)
         call follow_motion()
         if (link%slide > 0) call follow_slide()
         call follow_acting(problem, steady, unit, input(offset + 1:offset + n), offset, n, forces, cycle_of%acting)
         call clear_wrenches(n, forces)
         call add_source(problem, bare, source_inertia, input(offset + 1:offset + n), n, forces)
         call sweep(problem, n, forces)
         call take_forces(part_inertia)
         call clear_wrenches(n, forces)
         do source = source_inertia + 1, sources_of(steady)
            call add_source(problem, steady, source, input(offset + 1:offset + n), n, forces)
         end do
         call sweep(problem, n, forces)
         call take_forces(part_fixed)
         call move_bodies(problem, rates, n, 0.0_wp, cycle_of%turn%crank%sense, forces)
         call follow_push()
         call clear_wrenches(n, forces)
         call add_source(problem, bare, source_inertia, input(offset + 1:offset + n), n, forces)
         call sweep(problem, n, forces)
         call take_forces(part_pushed)
         if (.not. any(dampers%springs%damps())) cycle
         call move_in_turn(cycle_of%turn%crank, problem, rates, offset, n, cycle_of%turn%crank%sense, forces)
         call clear_wrenches(n, forces)
         do source = first_spring(dampers), sources_of(dampers)
            call add_source(problem, dampers, source, input(offset + 1:offset + n), n, forces)
         end do
         call sweep(problem, n, forces)
         call take_forces(part_damped)
      end do

   contains

      subroutine begin_acting(acting, k)
         type(acting_cycle_t), intent(inout) :: acting
         integer, intent(in) :: k
         type(attached_t) :: attached

         if (k <= size(link%loads)) then
            attached = link%loads(k)
            acting%load = attached%entry
            acting%location = model%loads(attached%entry)%location
         else
            attached = link%springs(k - size(link%loads))
            acting%spring = attached%entry
            acting%end = attached%end
            associate (spring => model%springs(attached%entry))
               acting%location = spring%ends(attached%end)
               if (spring%torsional) acting%torsion = spring%stiffness
            end associate
         end if
         allocate (acting%along(points), acting%across(points), acting%moment(points), acting%held(points, 3), source=0.0_wp)
      end subroutine begin_acting

      !> The frame's axes, and the acceleration of their origin.
      subroutine follow_motion()
         real(wp) :: arm(2), accel(2)
         integer :: i

         if (allocated(unit)) deallocate (unit)
         allocate (unit(2, n))
         associate (w => forces%w%v, rows => forces%bodies(link%body))
            do i = 1, n
               unit(:, i) = out_of_axes([w(i, rows%ex), w(i, rows%ey)], link%axis)
               arm = out_of_axes([w(i, rows%ex), w(i, rows%ey)], link%origin)
               accel = forces%metre*[w(i, rows%ax), w(i, rows%ay)] + w(i, rows%al)*quarter_turn(arm) - w(i, rows%w)**2*arm
               cycle_of%acceleration(:, offset + i) = into_axes(unit(:, i), accel)
               cycle_of%turning(offset + i) = w(i, rows%al)
               cycle_of%speed(offset + i) = w(i, rows%w)
               cycle_of%weight(:, offset + i) = into_axes(unit(:, i), model%gravity)
            end do
         end associate
      end subroutine follow_motion

      !> The middle of the shoe, and the direction across the line; the axes are known.
      subroutine follow_slide()
         real(wp), dimension(n) :: x, y, reach, aside
         real(wp) :: along(2), origin(2)
         integer :: i

         call find_shoe(problem, model, forces, link%slide, n, x, y, reach, aside)
         associate (w => forces%w%v, v => problem%linkage%store%v, rows => forces%bodies(link%body), at => link%origin, &
                    of => problem%linkage, slide => problem%mechanism%joints(link%slide)%slide)
            associate (root => problem%plan%root(slide))
               do i = 1, n
                  origin = forces%metre*[v(i, rows%px), v(i, rows%py)] + out_of_axes([w(i, rows%ex), w(i, rows%ey)], at)
                  cycle_of%shoe(:, offset + i) = into_axes(unit(:, i), forces%metre*[x(i), y(i)] - origin)
                  cycle_of%reach(offset + i) = forces%metre*reach(i)
                  along = [of%x(slide)*v(i, of%root_x(root)) - of%y(slide)*v(i, of%root_y(root)), &
                           of%x(slide)*v(i, of%root_y(root)) + of%y(slide)*v(i, of%root_x(root))]
                  cycle_of%normal(:, offset + i) = into_axes(unit(:, i), quarter_turn(along/sqrt(sum(along**2))))
               end do
            end associate
         end associate
      end subroutine follow_slide

      !> The same where the crank is pushed; the axes are known.
      subroutine follow_push()
         real(wp) :: arm(2)
         integer :: i

         associate (w => forces%w%v, rows => forces%bodies(link%body))
            do i = 1, n
               arm = out_of_axes([w(i, rows%ex), w(i, rows%ey)], link%origin)
               cycle_of%pushed(:2, offset + i) = into_axes(unit(:, i), forces%metre*[w(i, rows%ax), w(i, rows%ay)] + &
                                                           w(i, rows%al)*quarter_turn(arm))
               cycle_of%pushed(3, offset + i) = w(i, rows%al)
            end do
         end associate
      end subroutine follow_push

      !> Forces of the joints on the link, in the frame's axes.
      subroutine take_forces(part)
         integer, intent(in) :: part
         real(wp) :: rows(n, 2), sense
         integer :: j, i

         do j = 1, size(link%joints)
            rows = joint_rows(problem, forces, link%joints(j), n)
            sense = merge(1.0_wp, -1.0_wp, problem%mechanism%joints(link%joints(j))%bodies(2) == link%body)
            do i = 1, n
               cycle_of%forces(:, j, part, offset + i) = sense*into_axes(unit(:, i), rows(i, :))
            end do
         end do
      end subroutine take_forces
   end subroutine find_flexible_cycle
end module psalm_flexible_cycle
