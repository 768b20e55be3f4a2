!> Velocities, accelerations and jerks of the output, and on request of every joint and arc.
!>
!> Derivatives are taken with respect to the input (per radian, or per unit of length of a sliding input) and with respect to
!> time, for the speed and acceleration of the group RATES. Data in, results out. Source: Haines (about 1982), section 15.1;
!> Oldham (1977), 9.3.1.
module psalm_rate_study
   use psalm_angles, only: degrees_of
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_mechanism, only: at_finish, at_start
   use psalm_observable, only: at_origin
   use psalm_output_kind, only: motion_distance
   use psalm_plan, only: step_point
   use psalm_rates, only: rates_t, prepare_rates, differentiate, output_rates, derivatives_of, in_time, is_dead, &
                          highest_order
   use psalm_dimensions, only: dimensions_t
   use psalm_stop, only: stop_t, is_to_end
   implicit none (type, external)
   private
   public :: rate_study_t, arc_rates_t, find_rates, output_at_origin, highest_order

   integer, parameter :: output_at_origin = -1 !! in place of a loop: the distance has no derivative

   !> Every arc and every joint at every position; zero where `dead` or not closed.
   type :: arc_rates_t
      real(wp), allocatable :: length(:, :, :)   !! shape (0:2, arcs, positions): length, its first and second rate by time
      real(wp), allocatable :: angle(:, :, :)    !! the same shape: angle in radians and its rates
      integer, allocatable :: joint_arc(:)       !! shape (joints): the joint is at an end of this arc (sequential number),
      integer, allocatable :: joint_end(:)       !! at this one: `at_start` or `at_finish`
      real(wp), allocatable :: x(:, :, :), y(:, :, :) !! shape (0:2, joints, positions): place, velocity, acceleration
   end type arc_rates_t

   !> Derivatives of the output at all positions.
   type :: rate_study_t
      type(dimensions_t) :: dimensions              !! the linkage
      type(motion_t) :: motion                      !! positions and output
      real(wp), allocatable :: by_input(:, :, :)    !! shape (3, components, positions)
      real(wp), allocatable :: by_time(:, :, :)     !! the same shape
      integer, allocatable :: dead(:)               !! loop at a dead point, 0: none, or `output_at_origin`
      type(arc_rates_t), allocatable :: arcs        !! KTHETA=1
   contains
      procedure :: is_violating
   end type rate_study_t

contains

   !> Rates of a linkage. `problem` finds derivatives afterwards and is bound to the linkage. What the host ends is of no use.
   subroutine find_rates(set, problem, dimensions, rates, every_arc, motion, stop)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(rate_study_t), intent(out) :: rates
      logical, intent(in), optional :: every_arc !! and not the output alone; without it as KTHETA says
      type(motion_t), intent(in), optional :: motion !! of these positions, if they have been analysed
      type(stop_t), intent(in), optional :: stop !! asked before each block of positions
      type(rates_t), allocatable :: of_block
      logical :: everywhere
      integer :: block, offset, n, i, k, c, loop

      rates%dimensions = dimensions
      everywhere = set%limits%ktheta /= 0
      if (present(every_arc)) everywhere = every_arc
      call problem%want_derivatives(everywhere)
      if (present(motion)) then
         rates%motion = motion
         if (.not. everywhere) rates%motion%closed = motion%output_known
         call problem%bind(dimensions)
      else
         call problem%analyse(dimensions, rates%motion, stop=stop)
      end if
      associate (m => problem%positions, components => problem%output%kind%components)
         allocate (rates%by_input(highest_order, components, m))
         allocate (rates%by_time(highest_order, components, m))
         allocate (rates%dead(m), source=0)
      end associate
      if (everywhere) then
         allocate (rates%arcs)
         call grow(problem, rates%arcs)
      end if
      allocate (of_block)
      call prepare_rates(problem, of_block)
      do block = 1, problem%blocks()
         if (is_to_end(stop)) return
         call problem%solve_block(block, offset, n)
         call differentiate(problem, of_block, n, highest_order)
         do i = 1, n
            k = offset + i
            call output_rates(problem, of_block, i, highest_order, rates%by_input(:, :, k))
            do c = 1, problem%output%kind%components
               rates%by_time(:, c, k) = in_time(rates%by_input(:, c, k), set%pace(), set%change_of_pace())
            end do
            do loop = problem%mechanism%nloop, 1, -1
               if (problem%linkage%step_of_loop(loop) == 0) cycle
               if (is_dead(problem, of_block, loop, i)) rates%dead(k) = loop
            end do
            if (problem%motion == motion_distance .and. all(abs(rates%by_input(:, 1, k)) <= 0.0_wp)) then
               if (rates%motion%actual(k, 1) <= at_origin*maxval(problem%given%arcl)) rates%dead(k) = output_at_origin
            end if
            if (.not. allocated(rates%arcs)) cycle
            if (rates%motion%closed(k) .and. rates%dead(k) == 0) call follow_arcs(set, problem, of_block, i, k, rates%arcs)
         end do
      end do
   end subroutine find_rates

   !> True if the linkage does not close somewhere, or has no rates somewhere.
   pure logical function is_violating(self)
      class(rate_study_t), intent(in) :: self

      is_violating = .not. all(self%motion%closed) .or. any(self%dead /= 0)
   end function is_violating

   subroutine grow(problem, arcs)
      type(problem_t), intent(in) :: problem
      type(arc_rates_t), intent(out) :: arcs

      associate (n => size(problem%mechanism%arcs), positions => problem%positions, steps => problem%plan%steps)
         arcs%joint_arc = pack(steps%arc, steps%kind == step_point)
         arcs%joint_end = pack(merge(at_finish, at_start, steps%sense > 0), steps%kind == step_point)
         allocate (arcs%length(0:2, n, positions), arcs%angle(0:2, n, positions), source=0.0_wp)
         allocate (arcs%x(0:2, size(arcs%joint_arc), positions), arcs%y(0:2, size(arcs%joint_arc), positions), source=0.0_wp)
      end associate
   end subroutine grow

   !> Every arc and every joint at one position: i of the block, k of all.
   subroutine follow_arcs(set, problem, rates, i, k, arcs)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: i, k
      type(arc_rates_t), intent(inout) :: arcs
      real(wp) :: x, y, of_order(highest_order)
      integer :: loop, a, n, step, joint

      associate (link => problem%linkage, plan => problem%plan)
         do loop = 1, problem%mechanism%nloop
            do a = 1, problem%mechanism%loops(loop)%arcs
               n = problem%mechanism%seq(loop, a)
               call link%arc_at(plan, n, i, x, y, arcs%length(0, n, k))
               if (plan%length_slot(n) > 0) then
                  of_order = in_time(derivatives_of(rates, link%slide(plan%length_slot(n)), i)/link%scale, set%rates%speed, &
                                     set%rates%accel)
                  arcs%length(1:2, n, k) = of_order(1:2)
               end if
               of_order = in_time(derivatives_of(rates, link%root_x(plan%root(n)), i), set%pace(), set%change_of_pace())
               arcs%angle(0, n, k) = degrees_of(x, y)*radians_per_degree
               arcs%angle(1:2, n, k) = of_order(1:2)
            end do
         end do
         joint = 0
         do step = 1, size(plan%steps)
            if (plan%steps(step)%kind /= step_point) cycle
            joint = joint + 1
            associate (point => plan%steps(step)%to)
               of_order = in_time(derivatives_of(rates, link%point_x(point), i)/link%scale, set%pace(), set%change_of_pace())
               arcs%x(0, joint, k) = link%store%v(i, link%point_x(point))/link%scale + problem%output%origin_x
               arcs%x(1:2, joint, k) = of_order(1:2)
               of_order = in_time(derivatives_of(rates, link%point_y(point), i)/link%scale, set%pace(), set%change_of_pace())
               arcs%y(0, joint, k) = link%store%v(i, link%point_y(point))/link%scale + problem%output%origin_y
               arcs%y(1:2, joint, k) = of_order(1:2)
            end associate
         end do
      end associate
   end subroutine follow_arcs
end module psalm_rate_study
