!> Derivatives of the output and of the objective with respect to the variables of a linkage.
!>
!> The Jacobian goes forward: for each variable the plan is gone through once with the changes that variable makes. The
!> gradient of the objective goes backward (adjoint): once through the plan for all variables together. Both use the inverse
!> matrices of `psalm_rates`. Angles vary in degrees. Derivation: `doc/theory.md`, Sensitivities.
module psalm_sensitivity
   use psalm_angles, only: angles_between
   use psalm_data_set, only: motion_point, motion_angle, motion_distance, motion_slide
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, radians_per_degree, degrees_per_radian
   use psalm_linkage, only: bound_step_t, padded
   use psalm_plan, only: step_point, root_crank
   use psalm_rate_kernels, only: add_arc_change, difference, solve_columns, link_pair_change, point_back, dyad_back, arc_back
   use psalm_rates, only: rates_t, prepare_rates, form_frames, row_of, unknowns_of, rows_of_arc
   use psalm_topology, only: dimensions_t, variable_length, variable_gama, variable_outlk, variable_outang, variable_origlk, &
                             variable_origng, variable_crnki
   implicit none (type, external)
   private
   public :: sensitivity_t, prepare_sensitivity, find_jacobian, find_constraints, block_constraints, find_gradient

   !> Room to work in, and which arcs each variable changes.
   type :: sensitivity_t
      type(rates_t) :: rates
      real(wp), allocatable :: turn(:, :)       !! shape (arcs, marble): 1 where the arc's fixed angle turns with the variable
      real(wp), allocatable :: stretch(:, :)    !! shape (arcs, marble): 1 where its length grows with it
      logical, allocatable :: turns(:), stretches(:) !! by arc: some variable does so
      logical, allocatable :: moves(:, :)       !! shape (steps, marble): the step's result changes with the variable
      real(wp), allocatable :: angle_bar(:), length_bar(:) !! by arc: derivatives of the objective
      real(wp), allocatable :: across(:), along(:), gx(:), gy(:), tx(:), ty(:) !! shape (room)
   end type sensitivity_t

contains

   !> Allocate for a problem (after `want_derivatives`).
   subroutine prepare_sensitivity(problem, work)
      type(problem_t), intent(in) :: problem
      type(sensitivity_t), intent(out) :: work
      integer :: arcs, marble, v, k, n, b

      arcs = size(problem%topology%arcs)
      marble = size(problem%topology%variables)
      call prepare_rates(problem, work%rates)
      allocate (work%turn(arcs, marble), work%stretch(arcs, marble), source=0.0_wp)
      allocate (work%angle_bar(arcs), work%length_bar(arcs), source=0.0_wp)
      allocate (work%moves(size(problem%plan%steps), marble), source=.false.)
      associate (room => problem%linkage%room)
         allocate (work%across(room), work%along(room), work%gx(room), work%gy(room), work%tx(room), work%ty(room), source=0.0_wp)
      end associate
      do v = 1, marble
         where (problem%topology%length_variable == v) work%stretch(:, v) = 1.0_wp
         do k = 1, size(problem%plan%order)
            n = problem%plan%order(k)
            b = problem%plan%base(n)
            if (b > 0) work%turn(n, v) = work%turn(b, v)
            if (problem%plan%takes_gama(n) .and. problem%topology%angle_variable(n) == v) work%turn(n, v) = work%turn(n, v) + 1.0_wp
         end do
         call mark_steps(problem, v, work)
      end do
      work%turns = any(abs(work%turn) > 0.0_wp, dim=2)
      work%stretches = any(abs(work%stretch) > 0.0_wp, dim=2)
   end subroutine prepare_sensitivity

   !> Steps whose result a variable changes.
   subroutine mark_steps(problem, v, work)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v
      type(sensitivity_t), intent(inout) :: work
      logical, allocatable :: row(:)   !! by place in the store: it changes
      integer :: k, first, second

      allocate (row(0:size(problem%linkage%store)), source=.false.)
      associate (link => problem%linkage)
         if (problem%topology%variables(v)%kind == variable_crnki) then
            if (.not. link%sliding_input) then
               row(link%root_x(root_crank)) = .true.
            else if (link%input_slot > 0) then
               row(link%slide(link%input_slot)) = .true.
            end if
         end if
         do k = 1, size(link%steps)
            associate (step => link%steps(k))
               if (problem%plan%steps(k)%kind == step_point) then
                  work%moves(k, v) = row(step%from_x) .or. row(step%root_x) .or. row(step%slide_row) .or. &
                                     changes(step%arc)
                  row(step%to_x) = work%moves(k, v)
               else
                  work%moves(k, v) = row(step%from_x) .or. row(step%to_x) .or. changes(step%arc_p) .or. changes(step%arc_q) .or. &
                                     row(step%p_x) .or. row(step%q_x)
                  call unknowns_of(step, first, second)
                  row(first) = work%moves(k, v)
                  row(second) = work%moves(k, v)
               end if
            end associate
         end do
      end associate

   contains

      logical function changes(arc)
         integer, intent(in) :: arc

         changes = abs(work%turn(arc, v)) > 0.0_wp .or. abs(work%stretch(arc, v)) > 0.0_wp
      end function changes
   end subroutine mark_steps

   ! ---- forward -----------------------------------------------------------------------------------------------------

   !> Derivatives of the output by every variable, at every position: dx(i, v), and dy(i, v) for MOTION 0.
   !>
   !> Output as the listing has it (degrees for MOTION 1); variables in their own units (degrees for angles). The linkage must
   !> close; at a dead point the derivatives are infinite and zero is given.
   subroutine find_jacobian(problem, dimensions, work, dx, dy, k, dk, dp)
      type(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(sensitivity_t), intent(inout) :: work
      real(wp), intent(out) :: dx(:, :), dy(:, :)   !! shape (positions, marble)
      real(wp), intent(out), optional :: k(:, :)    !! shape (positions, nloop): as `find_constraints` has it
      real(wp), intent(out), optional :: dk(:, :, :) !! shape (positions, nloop, marble): its derivatives
      real(wp), intent(out), optional :: dp(:, :, :, :) !! shape (positions, 2, joints, marble): of the joints asked for
      integer :: block, offset, n, m, v

      call problem%bind(dimensions)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call problem%output_of(n)
         m = padded(n)
         call form_frames(problem, work%rates, m, fixed_too=.true.)
         work%rates%d(:, 1) = 0.0_wp
         if (present(k)) call block_constraints(problem, n, k(offset + 1:offset + n, :))
         do v = 1, size(problem%topology%variables)
            call change_of(problem, v, m, work)
            call change_of_output(problem, v, n, work, dx(offset + 1:offset + n, v), dy(offset + 1:offset + n, v))
            if (present(dk)) call change_of_constraints(problem, v, n, work, dk(offset + 1:offset + n, :, v))
            if (present(dp)) call change_of_joints(problem, v, n, work, dp(offset + 1:offset + n, :, :, v))
            call clear(problem, v, m, work)
         end do
      end do
   end subroutine find_jacobian

   !> How near each dyad is to its limit, at every position: the dyad closes, with TOGGLE in hand, while abs(k) <= 1.
   !>
   !> Type 1: the cosine of the transmission angle, beyond 1 where the dyad is open: smooth across closing. Types 2 and 3: guide
   !> and TOGGLE over distance. Types 4 and 5: offset and TOGGLE over link. Type 8: 1 less the sine between the slides, negative on
   !> the other side of parallel than `side` wants. Others, and loops that are not solved: 0.
   subroutine find_constraints(problem, k)
      type(problem_t), intent(inout) :: problem     !! bound
      real(wp), intent(out) :: k(:, :)              !! shape (positions, nloop)
      integer :: block, offset, n

      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call block_constraints(problem, n, k(offset + 1:offset + n, :))
      end do
   end subroutine find_constraints

   !> The same for the block just solved; shape of k (n, nloop).
   pure subroutine block_constraints(problem, n, k)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: n
      real(wp), intent(out) :: k(:, :)
      real(wp) :: hand
      integer :: loop

      hand = problem%toggle*problem%linkage%scale
      do loop = 1, problem%topology%nloop
         k(:, loop) = 0.0_wp
         if (problem%linkage%step_of_loop(loop) == 0) cycle
         associate (dyad => problem%linkage%steps(problem%linkage%step_of_loop(loop)), row => problem%linkage%reach(loop))
            associate (reach => problem%linkage%store(row:row + n - 1))
               select case (dyad%joint)
               case (1)
                  k(:, loop) = (dyad%p**2 + dyad%q**2 - reach)/(2.0_wp*dyad%p*dyad%q)
               case (2)
                  k(:, loop) = (dyad%q + hand)/sqrt(max(reach, tiny(1.0_wp)))
               case (3)
                  k(:, loop) = (dyad%p + hand)/sqrt(max(reach, tiny(1.0_wp)))
               case (4)
                  k(:, loop) = (reach + sign(hand, reach))/dyad%p
               case (5)
                  k(:, loop) = (reach + sign(hand, reach))/dyad%q
               case (8)
                  k(:, loop) = 1.0_wp - problem%side(loop)*reach
               end select
            end associate
         end associate
      end do
   end subroutine block_constraints

   !> Change of the constraints with a variable.
   subroutine change_of_constraints(problem, v, n, work, dk)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v, n
      type(sensitivity_t), intent(in) :: work
      real(wp), intent(out) :: dk(:, :)             !! shape (n, nloop)
      real(wp) :: unit, hx, hy, gx, gy, dp, dq, reach, h, ux, uy, turn, hand
      integer :: loop, i

      unit = unit_of(problem, v)
      hand = problem%toggle*problem%linkage%scale
      do loop = 1, problem%topology%nloop
         dk(:, loop) = 0.0_wp
         if (problem%linkage%step_of_loop(loop) == 0) cycle
         if (.not. work%moves(problem%linkage%step_of_loop(loop), v)) cycle
         associate (dyad => problem%linkage%steps(problem%linkage%step_of_loop(loop)), link => problem%linkage, d => work%rates%d)
            if (dyad%joint == 6 .or. dyad%joint == 7) cycle
            dp = work%stretch(dyad%arc_p, v)*link%scale
            dq = work%stretch(dyad%arc_q, v)*link%scale
            if (dyad%joint == 1) then
               h = 0.5_wp/(dyad%p*dyad%q)
               call link_pair_change(n, link%store(dyad%from_x), link%store(dyad%from_y), link%store(dyad%to_x), &
                                     link%store(dyad%to_y), d(dyad%from_x, 1), d(dyad%from_y, 1), d(dyad%to_x, 1), &
                                     d(dyad%to_y, 1), link%store(dyad%reach_row), &
                                     unit*h*(dp/dyad%p - dq/dyad%q)*(dyad%p - dyad%q)*(dyad%p + dyad%q), &
                                     unit*h*(dp/dyad%p + dq/dyad%q), 2.0_wp*unit*h, dk(:, loop))
               cycle
            end if
            if (dyad%joint == 8) then
               call slides_change(dk(:, loop))
               cycle
            end if
            do i = 0, n - 1
               hx = link%store(dyad%to_x + i) - link%store(dyad%from_x + i)
               hy = link%store(dyad%to_y + i) - link%store(dyad%from_y + i)
               gx = d(dyad%to_x + i, 1) - d(dyad%from_x + i, 1)
               gy = d(dyad%to_y + i, 1) - d(dyad%from_y + i, 1)
               reach = link%store(dyad%reach_row + i)
               select case (dyad%joint)
               case (2, 3)
                  h = sqrt(max(reach, tiny(1.0_wp)))
                  dk(i + 1, loop) = merge(dq, dp, dyad%joint == 2)/h &
                                    - (merge(dyad%q, dyad%p, dyad%joint == 2) + hand)*(hx*gx + hy*gy)/(h*h*h)
               case default
                  if (dyad%joint == 4) then
                     ux = dyad%qx*link%store(dyad%q_x + i) - dyad%qy*link%store(dyad%q_y + i)
                     uy = dyad%qx*link%store(dyad%q_y + i) + dyad%qy*link%store(dyad%q_x + i)
                     turn = d(dyad%q_x + i, 1) + work%turn(dyad%arc_q, v)
                     dk(i + 1, loop) = (ux*gy - uy*gx - turn*(ux*hx + uy*hy))/dyad%p - (reach + sign(hand, reach))*dp/dyad%p**2
                  else
                     ux = dyad%px*link%store(dyad%p_x + i) - dyad%py*link%store(dyad%p_y + i)
                     uy = dyad%px*link%store(dyad%p_y + i) + dyad%py*link%store(dyad%p_x + i)
                     turn = d(dyad%p_x + i, 1) + work%turn(dyad%arc_p, v)
                     dk(i + 1, loop) = (ux*gy - uy*gx - turn*(ux*hx + uy*hy))/dyad%q - (reach + sign(hand, reach))*dq/dyad%q**2
                  end if
               end select
            end do
            dk(:, loop) = dk(:, loop)*unit
         end associate
      end do

   contains

      !> Two slides: what the sine between them loses where the angle from p to q turns.
      subroutine slides_change(change)
         real(wp), intent(inout) :: change(:)

         associate (dyad => problem%linkage%steps(problem%linkage%step_of_loop(loop)), link => problem%linkage, d => work%rates%d)
            do i = 0, n - 1
               hx = dyad%px*link%store(dyad%p_x + i) - dyad%py*link%store(dyad%p_y + i)
               hy = dyad%px*link%store(dyad%p_y + i) + dyad%py*link%store(dyad%p_x + i)
               ux = dyad%qx*link%store(dyad%q_x + i) - dyad%qy*link%store(dyad%q_y + i)
               uy = dyad%qx*link%store(dyad%q_y + i) + dyad%qy*link%store(dyad%q_x + i)
               turn = d(dyad%q_x + i, 1) + work%turn(dyad%arc_q, v) - d(dyad%p_x + i, 1) - work%turn(dyad%arc_p, v)
               change(i + 1) = -problem%side(loop)*(hx*ux + hy*uy)*turn*unit
            end do
         end associate
      end subroutine slides_change
   end subroutine change_of_constraints

   !> Change of the joints asked for with a variable, in machine axes and the user's unit.
   subroutine change_of_joints(problem, v, n, work, dp)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v, n
      type(sensitivity_t), intent(in) :: work
      real(wp), intent(out) :: dp(:, :, :)          !! shape (n, 2, joints)
      real(wp) :: back, ox, oy
      integer :: j

      back = unit_of(problem, v)/problem%linkage%scale
      call change_of_origin(problem, v, ox, oy)
      do j = 1, size(problem%plan%joint_points)
         associate (px => problem%linkage%point_x(problem%plan%joint_points(j)), &
                    py => problem%linkage%point_y(problem%plan%joint_points(j)), d => work%rates%d)
            dp(:, 1, j) = d(px:px + n - 1, 1)*back + ox*unit_of(problem, v)
            dp(:, 2, j) = d(py:py + n - 1, 1)*back + oy*unit_of(problem, v)
         end associate
      end do
   end subroutine change_of_joints

   !> Change of the input pivot with a variable (per radian for its angle).
   pure subroutine change_of_origin(problem, v, x, y)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v
      real(wp), intent(out) :: x, y

      x = 0.0_wp
      y = 0.0_wp
      if (problem%topology%variables(v)%kind == variable_origlk) then
         x = problem%origin_c
         y = problem%origin_s
      else if (problem%topology%variables(v)%kind == variable_origng) then
         x = -problem%origin_y
         y = problem%origin_x
      end if
   end subroutine change_of_origin

   !> Radians a unit of the variable is worth if it is an angle in degrees, else 1.
   pure real(wp) function unit_of(problem, v) result(unit)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v

      unit = 1.0_wp
      select case (problem%topology%variables(v)%kind)
      case (variable_gama, variable_outang, variable_origng)
         unit = radians_per_degree
      case (variable_crnki)
         if (.not. problem%linkage%sliding_input) unit = radians_per_degree
      end select
   end function unit_of

   !> Changes of every root, point and slide that moves with a variable (per radian for angles).
   subroutine change_of(problem, v, n, work)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v, n
      type(sensitivity_t), intent(inout) :: work
      integer :: k

      associate (link => problem%linkage, d => work%rates%d)
         if (problem%topology%variables(v)%kind == variable_crnki) then
            if (.not. link%sliding_input) then
               d(link%root_x(root_crank):link%root_x(root_crank) + n - 1, 1) = 1.0_wp
            else if (link%input_slot > 0) then
               associate (at => link%slide(link%input_slot))
                  d(at:at + n - 1, 1) = link%scale
               end associate
            end if
         end if
         do k = 1, size(link%steps)
            if (.not. work%moves(k, v)) cycle
            if (problem%plan%steps(k)%kind == step_point) then
               associate (step => link%steps(k))
                  call arc_change(work%rates, n, 1.0_wp, row_of(work%rates, k, 0), step%root_x, step%slide_row, &
                                  work%turn(step%arc, v), work%stretch(step%arc, v)*link%scale, d(step%from_x, 1), &
                                  d(step%from_y, 1), d(step%to_x, 1), d(step%to_y, 1))
               end associate
            else
               call dyad_change(link%steps(k), k, v, n, link%scale, work)
            end if
         end do
      end associate
   end subroutine change_of

   subroutine arc_change(rates, n, factor, at, root, slide, turn, stretch, fx, fy, tx, ty)
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: n, at, root, slide
      real(wp), intent(in) :: factor, turn, stretch
      real(wp), intent(in) :: fx(n), fy(n)
      real(wp), intent(out) :: tx(n), ty(n)

      associate (w => rates%work, d => rates%d, room => rates%room)
         if (slide > 0) then
            call add_arc_change(n, factor, fx, fy, w(at), w(at + room), w(at + 4*room), d(root, 1), d(slide, 1), turn, &
                                stretch, tx, ty)
         else
            call add_arc_change(n, factor, fx, fy, w(at), w(at + room), w(at + 4*room), d(root, 1), w(rates%zero), turn, &
                                stretch, tx, ty)
         end if
      end associate
   end subroutine arc_change

   subroutine dyad_change(step, k, v, n, scale, work)
      type(bound_step_t), intent(in) :: step
      integer, intent(in) :: k, v, n
      real(wp), intent(in) :: scale
      type(sensitivity_t), intent(inout) :: work
      integer :: first, second, a, b, m
      logical :: known

      a = row_of(work%rates, k, 0)
      b = row_of(work%rates, k, rows_of_arc)
      m = row_of(work%rates, k, 2*rows_of_arc)
      call unknowns_of(step, first, second)
      associate (w => work%rates%work, room => work%rates%room, d => work%rates%d)
         call difference(n, d(step%from_x, 1), d(step%from_y, 1), d(step%to_x, 1), d(step%to_y, 1), work%gx, work%gy)
         known = abs(work%stretch(step%arc_p, v)) + abs(work%stretch(step%arc_q, v)) > 0.0_wp
         if (step%joint > 3 .or. known) then
            ! unknown rows hold zero here
            call arc_change(work%rates, n, -1.0_wp, a, step%p_x, step%slide_p, work%turn(step%arc_p, v), &
                            work%stretch(step%arc_p, v)*scale, work%gx, work%gy, work%tx, work%ty)
            call arc_change(work%rates, n, -1.0_wp, b, step%q_x, step%slide_q, work%turn(step%arc_q, v), &
                            work%stretch(step%arc_q, v)*scale, work%tx, work%ty, work%gx, work%gy)
         end if
         call solve_columns(n, w(m), w(m + room), w(m + 2*room), w(m + 3*room), work%gx, work%gy, d(first, 1), d(second, 1))
      end associate
   end subroutine dyad_change

   !> Put the rows a variable has changed back to zero.
   subroutine clear(problem, v, n, work)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v, n
      type(sensitivity_t), intent(inout) :: work
      integer :: k, first, second

      associate (link => problem%linkage)
         if (problem%topology%variables(v)%kind == variable_crnki) then
            if (.not. link%sliding_input) then
               call zero(link%root_x(root_crank))
            else if (link%input_slot > 0) then
               call zero(link%slide(link%input_slot))
            end if
         end if
         do k = 1, size(link%steps)
            if (.not. work%moves(k, v)) cycle
            if (problem%plan%steps(k)%kind == step_point) then
               call zero(link%steps(k)%to_x)
               call zero(link%steps(k)%to_y)
            else
               call unknowns_of(link%steps(k), first, second)
               call zero(first)
               call zero(second)
            end if
         end do
      end associate

   contains

      subroutine zero(at)
         integer, intent(in) :: at

         work%rates%d(at:at + n - 1, 1) = 0.0_wp
      end subroutine zero
   end subroutine clear

   !> Change of the output with a variable, in the listing's units.
   subroutine change_of_output(problem, v, n, work, dx, dy)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v, n
      type(sensitivity_t), intent(in) :: work
      real(wp), intent(out) :: dx(:), dy(:)
      real(wp) :: turn, back, unit, ex, ey, w, grow, ox, oy
      integer :: i, root, root_y, px, py

      associate (link => problem%linkage, plan => problem%plan, variable => problem%topology%variables(v), &
                 arc => problem%topology%output_arc, d => work%rates%d)
         unit = unit_of(problem, v)
         back = 1.0_wp/link%scale
         turn = work%turn(arc, v)
         if (variable%kind == variable_outang) turn = turn + 1.0_wp
         dy = 0.0_wp
         root = link%root_x(plan%root(arc))
         root_y = link%root_y(plan%root(arc))
         select case (problem%motion)
         case (motion_angle)
            dx = (d(root:root + n - 1, 1) + turn)*(unit*degrees_per_radian)
            return
         case (motion_slide)
            associate (slide => link%slide(plan%length_slot(arc)))
               dx = d(slide:slide + n - 1, 1)*(back*unit)
            end associate
            return
         end select
         grow = merge(1.0_wp, 0.0_wp, variable%kind == variable_outlk)
         call change_of_origin(problem, v, ox, oy)
         px = link%point_x(plan%output_point)
         py = link%point_y(plan%output_point)
         do i = 1, n
            ex = problem%out_c*link%store(root + i - 1) - problem%out_s*link%store(root_y + i - 1)
            ey = problem%out_c*link%store(root_y + i - 1) + problem%out_s*link%store(root + i - 1)
            w = (d(root + i - 1, 1) + turn)*problem%out_length
            dx(i) = (d(px + i - 1, 1)*back + grow*ex - w*ey + ox)*unit
            dy(i) = (d(py + i - 1, 1)*back + grow*ey + w*ex + oy)*unit
         end do
         if (problem%motion /= motion_distance) return
         do i = 1, n
            call output_vector(problem, i, ex, ey)
            w = hypotenuse(ex, ey)
            if (w > 0.0_wp) dx(i) = (ex/w)*dx(i) + (ey/w)*dy(i)
            dy(i) = 0.0_wp
         end do
      end associate
   end subroutine change_of_output

   !> Output point in machine co-ordinates at position `i` of the block.
   pure subroutine output_vector(problem, i, x, y)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: i
      real(wp), intent(out) :: x, y
      real(wp) :: rx, ry

      associate (link => problem%linkage, plan => problem%plan)
         rx = link%store(link%root_x(plan%root(problem%topology%output_arc)) + i - 1)
         ry = link%store(link%root_y(plan%root(problem%topology%output_arc)) + i - 1)
         x = link%store(link%point_x(plan%output_point) + i - 1)/link%scale + problem%origin_x &
             + (problem%out_c*rx - problem%out_s*ry)*problem%out_length
         y = link%store(link%point_y(plan%output_point) + i - 1)/link%scale + problem%origin_y &
             + (problem%out_c*ry + problem%out_s*rx)*problem%out_length
      end associate
   end subroutine output_vector

   ! ---- backward ----------------------------------------------------------------------------------------------------

   !> Objective and its derivatives by every variable, by the adjoint route.
   subroutine find_gradient(problem, dimensions, work, objective, gradient)
      type(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(sensitivity_t), intent(inout) :: work
      real(wp), intent(out) :: objective
      real(wp), intent(out) :: gradient(:)      !! shape (marble)
      real(wp) :: crank_bar, outlk_bar, outang_bar, origin_bar(2)
      integer :: block, offset, n, m, k, v

      call problem%bind(dimensions)
      objective = 0.0_wp
      crank_bar = 0.0_wp
      outlk_bar = 0.0_wp
      outang_bar = 0.0_wp
      origin_bar = 0.0_wp
      work%angle_bar = 0.0_wp
      work%length_bar = 0.0_wp
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         m = padded(n)
         call form_frames(problem, work%rates, m, fixed_too=.true.)
         work%rates%d(:, 1) = 0.0_wp
         call seed(problem, offset, n, m, work, objective, outlk_bar, outang_bar, origin_bar)
         do k = size(problem%linkage%steps), 1, -1
            if (problem%plan%steps(k)%kind == step_point) then
               call back_through_point(problem, k, m, work)
            else
               call back_through_dyad(problem%linkage%steps(k), k, m, work)
            end if
         end do
         associate (link => problem%linkage)
            if (.not. link%sliding_input) then
               crank_bar = crank_bar + sum(work%rates%d(link%root_x(root_crank):link%root_x(root_crank) + n - 1, 1))
            else if (link%input_slot > 0) then
               associate (at => link%slide(link%input_slot))
                  crank_bar = crank_bar + sum(work%rates%d(at:at + n - 1, 1))*link%scale
               end associate
            end if
         end associate
      end do
      call back_through_angles(problem, work)
      do v = 1, size(gradient)
         associate (variable => problem%topology%variables(v))
            select case (variable%kind)
            case (variable_length)
               gradient(v) = sum(work%length_bar, mask=problem%topology%length_variable == v)*problem%linkage%scale
            case (variable_gama)
               gradient(v) = sum(work%angle_bar, mask=problem%topology%angle_variable == v .and. problem%plan%takes_gama) &
                             *radians_per_degree
            case (variable_outlk)
               gradient(v) = outlk_bar
            case (variable_outang)
               gradient(v) = outang_bar*radians_per_degree
            case (variable_origlk)
               gradient(v) = origin_bar(1)*problem%origin_c + origin_bar(2)*problem%origin_s
            case (variable_origng)
               gradient(v) = (origin_bar(2)*problem%origin_x - origin_bar(1)*problem%origin_y)*radians_per_degree
            case default
               gradient(v) = crank_bar
               if (.not. problem%linkage%sliding_input) gradient(v) = crank_bar*radians_per_degree
            end select
         end associate
      end do
   end subroutine find_gradient

   !> Objective of a block and its derivatives by what the output hangs on.
   subroutine seed(problem, offset, n, m, work, objective, outlk_bar, outang_bar, origin_bar)
      type(problem_t), intent(inout) :: problem
      integer, intent(in) :: offset, n, m
      type(sensitivity_t), intent(inout) :: work
      real(wp), intent(inout) :: objective, outlk_bar, outang_bar, origin_bar(2)
      real(wp) :: e, bar, bx, by, x, y, ex, ey, r, back
      integer :: i, k, root, root_y, px, py, slide

      associate (link => problem%linkage, plan => problem%plan, arc => problem%topology%output_arc, d => work%rates%d)
         root = link%root_x(plan%root(arc))
         root_y = link%root_y(plan%root(arc))
         back = 1.0_wp/link%scale
         if (problem%motion == motion_angle) then
            call angles_between(m, link%store(root), link%store(root_y), problem%out_c, problem%out_s, &
                                problem%toward_x(offset + 1:offset + m), problem%toward_y(offset + 1:offset + m), work%along)
            do i = 1, n
               e = work%along(i)*problem%weight(offset + i)
               objective = objective + e*work%along(i)
               bar = -2.0_wp*e*degrees_per_radian
               d(root + i - 1, 1) = bar
               outang_bar = outang_bar + bar
               work%angle_bar(arc) = work%angle_bar(arc) + bar
            end do
            return
         end if
         if (problem%motion == motion_slide) then
            slide = link%slide(plan%length_slot(arc))
            do i = 1, n
               e = problem%wanted(offset + i) - link%store(slide + i - 1)*back
               objective = objective + problem%weight(offset + i)*e*e
               d(slide + i - 1, 1) = -2.0_wp*problem%weight(offset + i)*e*back
            end do
            return
         end if
         px = link%point_x(plan%output_point)
         py = link%point_y(plan%output_point)
         do i = 1, n
            k = offset + i
            call output_vector(problem, i, x, y)
            if (problem%motion == motion_point) then
               bx = problem%weight(k)*(problem%wanted(k) - x)
               by = problem%weight_y(k)*(problem%wanted_y(k) - y)
               objective = objective + bx*(problem%wanted(k) - x) + by*(problem%wanted_y(k) - y)
               bx = -2.0_wp*bx
               by = -2.0_wp*by
            else
               r = hypotenuse(x, y)
               e = problem%wanted(k) - r
               objective = objective + problem%weight(k)*e*e
               bar = -2.0_wp*problem%weight(k)*e
               bx = 0.0_wp
               by = 0.0_wp
               if (r > 0.0_wp) then
                  bx = bar*(x/r)
                  by = bar*(y/r)
               end if
            end if
            ex = problem%out_c*link%store(root + i - 1) - problem%out_s*link%store(root_y + i - 1)
            ey = problem%out_c*link%store(root_y + i - 1) + problem%out_s*link%store(root + i - 1)
            outlk_bar = outlk_bar + bx*ex + by*ey
            bar = (by*ex - bx*ey)*problem%out_length
            d(root + i - 1, 1) = bar
            outang_bar = outang_bar + bar
            work%angle_bar(arc) = work%angle_bar(arc) + bar
            origin_bar = origin_bar + [bx, by]
            d(px + i - 1, 1) = bx*back
            d(py + i - 1, 1) = by*back
         end do
      end associate
   end subroutine seed

   subroutine back_through_point(problem, k, n, work)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: k, n
      type(sensitivity_t), intent(inout) :: work
      integer :: a

      a = row_of(work%rates, k, 0)
      associate (step => problem%linkage%steps(k), w => work%rates%work, room => work%rates%room, d => work%rates%d)
         call arc_back(n, d(step%to_x, 1), d(step%to_y, 1), w(a), w(a + room), w(a + 4*room), work%across, work%along)
         if (work%turns(step%arc)) work%angle_bar(step%arc) = work%angle_bar(step%arc) - sum(work%across(:n))
         if (work%stretches(step%arc)) work%length_bar(step%arc) = work%length_bar(step%arc) - sum(work%along(:n))
         call point_back(n, d(step%to_x, 1), d(step%to_y, 1), w(a), w(a + room), w(a + 4*room), d(step%from_x, 1), &
                         d(step%from_y, 1), d(step%root_x, 1), work%along)
         if (step%slide_row > 0) d(step%slide_row:step%slide_row + n - 1, 1) = &
            d(step%slide_row:step%slide_row + n - 1, 1) + work%along(:n)
      end associate
   end subroutine back_through_point

   subroutine back_through_dyad(step, k, n, work)
      type(bound_step_t), intent(in) :: step
      integer, intent(in) :: k, n
      type(sensitivity_t), intent(inout) :: work
      integer :: m, first, second

      m = row_of(work%rates, k, 2*rows_of_arc)
      call unknowns_of(step, first, second)
      associate (w => work%rates%work, room => work%rates%room, d => work%rates%d)
         call dyad_back(n, d(first, 1), d(second, 1), w(m), w(m + room), w(m + 2*room), w(m + 3*room), d(step%from_x, 1), &
                        d(step%from_y, 1), d(step%to_x, 1), d(step%to_y, 1), work%gx, work%gy)
      end associate
      call known_part(row_of(work%rates, k, 0), step%p_x, step%slide_p, step%arc_p)
      call known_part(row_of(work%rates, k, rows_of_arc), step%q_x, step%slide_q, step%arc_q)

   contains

      !> An arc whose direction is not the dyad's to find hands on to its root; a fixed length that varies to itself.
      subroutine known_part(at, root, slide, arc)
         integer, intent(in) :: at, root, slide, arc
         logical :: turned

         turned = root /= first .and. root /= second .and. step%joint > 3
         if (.not. turned .and. .not. (work%stretches(arc) .and. slide == 0)) return
         associate (w => work%rates%work, room => work%rates%room, d => work%rates%d)
            call arc_back(n, work%gx, work%gy, w(at), w(at + room), w(at + 4*room), work%across, work%along)
            if (turned) then
               d(root:root + n - 1, 1) = d(root:root + n - 1, 1) + work%across(:n)
               if (work%turns(arc)) work%angle_bar(arc) = work%angle_bar(arc) + sum(work%across(:n))
            end if
            if (work%stretches(arc) .and. slide == 0) work%length_bar(arc) = work%length_bar(arc) + sum(work%along(:n))
         end associate
      end subroutine known_part
   end subroutine back_through_dyad

   !> An arc's fixed angle is counted from another arc's: hand on along the chain.
   subroutine back_through_angles(problem, work)
      type(problem_t), intent(in) :: problem
      type(sensitivity_t), intent(inout) :: work
      integer :: k, n, b

      do k = size(problem%plan%order), 1, -1
         n = problem%plan%order(k)
         b = problem%plan%base(n)
         if (b > 0) work%angle_bar(b) = work%angle_bar(b) + work%angle_bar(n)
      end do
   end subroutine back_through_angles
end module psalm_sensitivity
