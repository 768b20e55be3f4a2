!> Where forces act while a mechanism moves: centres of mass, loads, joints, and the forces there, for pictures.
module psalm_force_trace
   use psalm_error, only: problem_t
   use psalm_force_analysis, only: force_table_t, analyse_forces, column_of_joint
   use psalm_force_model, only: force_model_t, parameter_mass, parameter_mx, parameter_my
   use psalm_kinds, only: wp
   use psalm_kinetostatics, only: forces_t, prepare_forces, move_bodies, clear_wrenches, add_source, find_location, first_load
   use psalm_locations, only: location_t
   use psalm_mechanism, only: body_frame, joint_prismatic
   use psalm_rates, only: rates_t, prepare_rates, differentiate
   implicit none (type, external)
   private
   public :: force_trace_t, trace_forces

   !> Places in machine axes, user's length; forces in newtons, machine axes. Valid where the table knows the forces.
   type :: force_trace_t
      type(force_table_t) :: table
      integer, allocatable :: bodies(:)          !! shape (centres): bodies with a mass
      real(wp), allocatable :: centre(:, :, :)   !! shape (2, positions, centres): their centres of mass
      real(wp), allocatable :: load_at(:, :, :)  !! shape (2, positions, loads)
      real(wp), allocatable :: load(:, :, :)     !! shape (2, positions, loads): forces, without moments
      real(wp), allocatable :: joint_at(:, :, :) !! shape (2, positions, joints)
      real(wp), allocatable :: joint(:, :, :)    !! shape (2, positions, joints): on the later link, of a sketch as listed
      real(wp), allocatable :: weight_at(:, :, :) !! shape (2, positions, counterweights)
      real(wp), allocatable :: spring_at(:, :, :, :) !! shape (2, positions, ends, springs)
      real(wp), allocatable :: spring_foot(:, :, :, :) !! shape (2, positions, ends, springs): a joint of the holding link
   end type force_trace_t

contains

   !> Forces, and where they act. The problem is as `analyse_forces` wants it.
   subroutine trace_forces(problem, model, speed, accel, closed, input, added, trace, known)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: speed, accel
      logical, intent(in) :: closed(:)
      real(wp), intent(in) :: input(:)
      integer, intent(in) :: added               !! so many of the last masses are counterweights
      type(force_trace_t), intent(out) :: trace
      type(force_table_t), intent(in), optional :: known !! the forces, where another motion than that of the speed has them
      type(rates_t) :: rates
      type(forces_t) :: forces
      type(location_t) :: location
      integer :: block, offset, n, k, b, l

      if (present(known)) then
         trace%table = known
      else
         call analyse_forces(problem, model, speed, accel, closed, input, trace%table)
      end if
      trace%bodies = pack([(b, b=1, size(model%reference))], &
                          [(abs(model%inertia(parameter_mass, b)) >= tiny(1.0_wp) .and. b /= body_frame, b=1, &
                            size(model%reference))])
      associate (m => problem%positions, joints => size(problem%mechanism%joints))
         allocate (trace%centre(2, m, size(trace%bodies)), trace%load_at(2, m, size(model%loads)), &
                   trace%load(2, m, size(model%loads)), trace%joint_at(2, m, joints), trace%joint(2, m, joints), &
                   trace%weight_at(2, m, added), trace%spring_at(2, m, 2, size(model%springs)), source=0.0_wp)
         trace%spring_foot = trace%spring_at
      end associate
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         call move_bodies(problem, rates, n, speed, accel, forces)
         do k = 1, size(trace%bodies)
            b = trace%bodies(k)
            location%body = b
            location%at = model%inertia([parameter_mx, parameter_my], b)/(model%inertia(parameter_mass, b)*model%metre)
            call place(location, trace%centre(:, offset + 1:offset + n, k))
         end do
         do l = 1, size(model%loads)
            call place(model%loads(l)%location, trace%load_at(:, offset + 1:offset + n, l))
            call clear_wrenches(n, forces)
            call add_source(problem, model, first_load() + l - 1, input(offset + 1:offset + n), n, forces)
            associate (row => forces%bodies(model%loads(l)%location%body)%wrench)
               trace%load(1, offset + 1:offset + n, l) = forces%w%v(1:n, row)
               trace%load(2, offset + 1:offset + n, l) = forces%w%v(1:n, row + 1)
            end associate
         end do
         do k = 1, size(problem%mechanism%joints)
            call trace_joint(k)
         end do
         do k = 1, added
            call place(model%centres(size(model%centres) - added + k), trace%weight_at(:, offset + 1:offset + n, k))
         end do
         do k = 1, size(model%springs)
            do l = 1, 2
               location = model%springs(k)%ends(l)
               call place(location, trace%spring_at(:, offset + 1:offset + n, l, k))
               location%at = 0.0_wp
               call place(location, trace%spring_foot(:, offset + 1:offset + n, l, k))
            end do
         end do
      end do

   contains

      subroutine place(location, at)
         type(location_t), intent(in) :: location
         real(wp), intent(out) :: at(:, :)       !! shape (2, n)
         real(wp) :: x(n), y(n)

         call find_location(problem, forces, location, n, x, y)
         at(1, :) = x/problem%linkage%scale + problem%output%origin_x
         at(2, :) = y/problem%linkage%scale + problem%output%origin_y
      end subroutine place

      subroutine trace_joint(j)
         integer, intent(in) :: j
         real(wp) :: x, y, length
         integer :: i, row_x, row_y

         associate (joint => problem%mechanism%joints(j), link => problem%linkage, &
                    point => problem%plan%joint_points(problem%mechanism%joints(j)%point), c => column_of_joint(j), &
                    value => trace%table%value)
            row_x = link%point_x(point)
            row_y = link%point_y(point)
            do i = 1, n
               trace%joint_at(1, offset + i, j) = link%store%v(i, row_x)/link%scale + problem%output%origin_x
               trace%joint_at(2, offset + i, j) = link%store%v(i, row_y)/link%scale + problem%output%origin_y
               trace%joint(:, offset + i, j) = value(offset + i, c:c + 1)
               if (joint%kind /= joint_prismatic) cycle
               call link%arc_at(problem%plan, joint%slide, i, x, y, length)
               trace%joint(:, offset + i, j) = model%shoes(j)%sense*value(offset + i, c)*[-y, x]
            end do
            if (model%shoes(j)%given) call place(model%shoes(j)%location, trace%joint_at(:, offset + 1:offset + n, j))
         end associate
      end subroutine trace_joint
   end subroutine trace_forces
end module psalm_force_trace
