!> Where every body of a mechanism is, and how it moves, at a row of input positions.
module psalm_body_motion
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t
   use psalm_kinds, only: wp
   use psalm_kinetostatics, only: forces_t, prepare_forces, move_bodies
   use psalm_mechanism, only: body_frame
   use psalm_rates, only: rates_t, prepare_rates, differentiate
   implicit none (type, external)
   private
   public :: body_motion_t, follow_bodies

   !> Poses of the bodies, the frame first; all arrays have the shape (positions, bodies).
   type :: body_motion_t
      real(wp), allocatable :: c(:, :), s(:, :)      !! direction of the axes
      real(wp), allocatable :: x(:, :), y(:, :)      !! reference, from the input pivot, metres
      real(wp), allocatable :: vx(:, :), vy(:, :)    !! its derivative by the input, metres for a radian
      real(wp), allocatable :: w(:, :)               !! derivative of the angle
   end type body_motion_t

contains

   !> Follow all bodies. The problem is bound and its plan has every loop, every root and all vertices (`vertices_of`).
   subroutine follow_bodies(problem, model, motion)
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      type(body_motion_t), intent(out) :: motion
      type(rates_t) :: rates
      type(forces_t) :: forces
      integer :: block, offset, n, b

      associate (m => problem%positions, bodies => size(model%reference))
         allocate (motion%c(m, bodies), source=1.0_wp)
         allocate (motion%s(m, bodies), motion%x(m, bodies), motion%y(m, bodies), motion%vx(m, bodies), motion%vy(m, bodies), &
                   motion%w(m, bodies), source=0.0_wp)
      end associate
      call prepare_rates(problem, rates)
      call prepare_forces(problem, model, forces)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call differentiate(problem, rates, n, 2)
         call move_bodies(problem, rates, n, 1.0_wp, 0.0_wp, forces)
         do b = body_frame + 1, size(model%reference)
            associate (row => forces%bodies(b), w => forces%w%v, v => problem%linkage%store%v, metre => forces%metre, &
                       first => offset + 1, last => offset + n)
               motion%c(first:last, b) = w(1:n, row%ex)
               motion%s(first:last, b) = w(1:n, row%ey)
               motion%x(first:last, b) = metre*v(1:n, row%px)
               motion%y(first:last, b) = metre*v(1:n, row%py)
               motion%vx(first:last, b) = metre*w(1:n, row%vx)
               motion%vy(first:last, b) = metre*w(1:n, row%vy)
               motion%w(first:last, b) = w(1:n, row%w)
            end associate
         end do
      end do
   end subroutine follow_bodies
end module psalm_body_motion
