!> Derivatives of the output with respect to the variables of a linkage.
!>
!> For each variable the plan is gone through once with the changes that variable makes, with the inverse matrices of
!> `psalm_rates`. Angles vary in degrees. Derivation: `doc/theory/rates.md`, Sensitivities.
module psalm_sensitivity
   use psalm_arc_kernels, only: add_arc_change, change_ends, change_ends_and_arcs, difference
   use psalm_assur, only: closure_of, change_of_closure
   use psalm_error, only: problem_t
   use psalm_frames, only: frames_t, rows_of_arc, matrix_row
   use psalm_group_rings, only: higher_t
   use psalm_higher_group, only: change_of_higher, gaps_of_ties, add_gaps_of_phase, solve_higher
   use psalm_kinds, only: wp, degrees_per_radian, radians_per_degree
   use psalm_linkage, only: bound_step_t, padded, put_driven_lengths
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_place, only: beside_t
   use psalm_plan, only: step_point
   use psalm_rates, only: rates_t, prepare_rates, form_frames, highest_order
   use psalm_rows, only: rows_t, clear_rows
   use psalm_dimensions, only: dimensions_t
   use psalm_parameters, only: variable_gama, variable_outlk, variable_outang, variable_origng, variable_crnki, variable_aside, &
                               variable_aside_angle
   use psalm_sketch, only: sketch_output_t
   use psalm_sketch_motion, only: find_places, find_changes, find_own_changes
   use psalm_sketch_outputs, only: values_of_outputs
   implicit none (type, external)
   private
   public :: sensitivity_t, prepare_sensitivity, find_jacobian, block_constraints, unit_of, clear_changes
   public :: wanted_outputs_t

   integer, parameter :: change_of_point = 1, change_of_dyad = 2, change_of_group = 3 !! kinds of steps

   !> How a step's result changes: its arcs, and where rows begin in the changes and in the frames, as numbers of elements. What a
   !> dyad finds itself, and fixed lengths, are rows of zeros.
   type :: change_t
      integer :: kind = change_of_group
      integer :: arc(2) = 0                     !! point: the arc; dyad: p and q
      integer :: from(2) = 0, to(2) = 0         !! point to start from and point made; dyad: S and E
      integer :: root(2) = 0, slide(2) = 0      !! changes of angle and length of the arcs
      integer :: unknown(2) = 0                 !! dyad: what it finds
      integer :: vector(3, 2) = 0               !! frames: unit vector and length of the arcs
      integer :: matrix(4) = 0                  !! frames: inverse matrix of a dyad
      logical :: takes_direction = .false.      !! dyad with an arc whose direction it does not find
   end type change_t

   !> Room to work in, and which arcs each variable changes.
   type :: sensitivity_t
      type(rates_t) :: rates
      real(wp), allocatable :: turn(:, :)       !! shape (arcs, nvar): 1 where the arc's fixed angle turns with the variable
      real(wp), allocatable :: stretch(:, :)    !! shape (arcs, nvar): 1 where its length grows with it
      logical, allocatable :: moves(:, :)       !! shape (steps, nvar): the step's result changes with the variable
      integer, allocatable :: moved(:, :)       !! shape (0:steps, nvar): how many of these steps, and which
      integer, allocatable :: written(:, :)     !! shape (0:rows, nvar): how many rows the variable changes, and which
      logical, allocatable :: overwritten(:, :) !! shape (rows, nvar): whatever stood in the row before does not matter
      type(change_t), allocatable :: changes(:) !! shape (steps)
      real(wp), allocatable :: tx(:), ty(:)     !! shape (capacity)
   end type sensitivity_t

   !> Outputs of a sketch, and their changes with the variables.
   type :: wanted_outputs_t
      type(sketch_motion_t) :: sketch                    !! its points are in the plan
      type(sketch_output_t), allocatable :: outputs(:)
      integer :: numbers = 0                             !! of all outputs
      logical, allocatable :: angle(:)                   !! shape (numbers): changes are degrees
      integer, allocatable :: apart(:)                   !! joints that move, at a distance from the points of the plan
      real(wp), allocatable :: change(:, :, :)           !! shape (positions, columns, numbers); columns: the variables, then
                                                         !! distance and angle of each joint of `apart`; not of a ratio
      complex(wp), allocatable, private :: joint(:, :, :) !! shape (joints, 0:highest_order, capacity)
      real(wp), allocatable, private :: moved(:, :, :)   !! shape (slides, 0:highest_order, capacity)
   end type wanted_outputs_t

contains

   !> Allocate for a problem (after `want_derivatives`).
   subroutine prepare_sensitivity(problem, work)
      type(problem_t), intent(in) :: problem
      type(sensitivity_t), intent(out) :: work
      integer :: arcs, nvar, v, k, n, b

      arcs = size(problem%mechanism%arcs)
      nvar = size(problem%parameters%variables)
      call prepare_rates(problem, work%rates)
      allocate (work%turn(arcs, nvar), work%stretch(arcs, nvar), source=0.0_wp)
      allocate (work%moves(size(problem%plan%steps), nvar), source=.false.)
      associate (capacity => problem%linkage%capacity, steps => size(problem%plan%steps), &
                 rows => size(problem%linkage%store%v, 2))
         allocate (work%tx(capacity), work%ty(capacity), source=0.0_wp)
         allocate (work%moved(0:steps, nvar), work%written(0:rows, nvar), source=0)
         allocate (work%overwritten(rows, nvar), source=.false.)
         allocate (work%changes(steps))
      end associate
      do k = 1, size(work%changes)
         call describe(problem%linkage%steps(k), problem%linkage%point_x(0), work%rates%place(k), size(work%rates%d(1)%v, 1), &
                       size(work%rates%frames%work%v, 1), work%changes(k))
      end do
      do v = 1, nvar
         where (problem%parameters%length_variable == v) work%stretch(:, v) = 1.0_wp
         do k = 1, size(problem%plan%order)
            n = problem%plan%order(k)
            b = problem%plan%base(n)
            if (b > 0) work%turn(n, v) = work%turn(b, v)
            if (problem%plan%takes_gama(n) .and. problem%parameters%angle_variable(n) == v) &
               work%turn(n, v) = work%turn(n, v) + 1.0_wp
         end do
         call mark_steps(problem, v, work)
         call list_steps(problem, v, work)
      end do
   end subroutine prepare_sensitivity

   !> Rows and arcs of a step.
   pure subroutine describe(step, zeros, at, leading, wide, change)
      type(bound_step_t), intent(in) :: step
      integer, intent(in) :: zeros              !! a row of zeros: the input pivot never moves
      integer, intent(in) :: at                 !! first row of its frames
      integer, intent(in) :: leading, wide      !! elements between the beginnings of rows of changes and of frames
      type(change_t), intent(inout) :: change
      integer :: i

      if (step%kind == step_point) then
         change%kind = change_of_point
         change%arc(1) = step%arc
         change%from = [step%from_x, step%from_y]
         change%to = [step%to_x, step%to_y]
         change%root(1) = step%root_x
         change%slide(1) = merge(step%slide_row, zeros, step%slide_row > 0)
      else if (.not. allocated(step%dyad%higher)) then
         associate (dyad => step%dyad)
            change%kind = change_of_dyad
            change%arc = [dyad%arc_p, dyad%arc_q]
            change%from = [dyad%s_x, dyad%s_y]
            change%to = [dyad%e_x, dyad%e_y]
            change%unknown = dyad%unknown
            change%root = [dyad%p_x, dyad%q_x]
            where (is_found(change%root)) change%root = zeros
            change%takes_direction = any(change%root /= zeros)
            change%slide = [dyad%slide_p, dyad%slide_q]
            where (change%slide == 0 .or. is_found(change%slide)) change%slide = zeros
         end associate
      end if
      change%from = beginning(change%from, leading)
      change%to = beginning(change%to, leading)
      change%unknown = beginning(change%unknown, leading)
      change%root = beginning(change%root, leading)
      change%slide = beginning(change%slide, leading)
      do i = 1, 2
         change%vector(:, i) = beginning(at + rows_of_arc*(i - 1) + [0, 1, 4], wide)
      end do
      change%matrix = beginning(at + matrix_row + [0, 1, 2, 3], wide)

   contains

      elemental logical function is_found(row)
         integer, intent(in) :: row

         is_found = row == step%dyad%unknown(1) .or. row == step%dyad%unknown(2)
      end function is_found

      !> Number of the element that a row begins with.
      elemental integer function beginning(row, length)
         integer, intent(in) :: row, length

         beginning = (row - 1)*length + 1
      end function beginning
   end subroutine describe

   !> Steps that a variable moves and rows that it changes, for `change_of` and `clear_others`.
   subroutine list_steps(problem, v, work)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v
      type(sensitivity_t), intent(inout) :: work
      integer :: k

      associate (link => problem%linkage)
         if (problem%parameters%variables(v)%kind == variable_crnki) then
            do k = 1, size(link%input_row)
               call enter(link%input_row(k), .true.)
            end do
         end if
         do k = 1, size(link%driven_row)
            call enter(link%driven_row(k), .false.)
         end do
         do k = 1, size(link%steps)
            if (.not. work%moves(k, v)) cycle
            work%moved(0, v) = work%moved(0, v) + 1
            work%moved(work%moved(0, v), v) = k
            associate (step => link%steps(k))
               if (problem%plan%steps(k)%kind == step_point) then
                  call enter(step%to_x, .true.)
                  call enter(step%to_y, .true.)
               else if (allocated(step%dyad%higher)) then
                  call enter_all(step%dyad%higher%row)
               else
                  call enter(step%dyad%unknown(1), .true.)
                  call enter(step%dyad%unknown(2), .true.)
               end if
            end associate
         end do
         ! what is added to must be zero before
         work%overwritten(link%driven_row, v) = .false.
      end associate

   contains

      subroutine enter(row, anew)
         integer, intent(in) :: row
         logical, intent(in) :: anew            !! it is set, whatever it was

         work%overwritten(row, v) = work%overwritten(row, v) .or. anew
         if (any(work%written(1:work%written(0, v), v) == row)) return
         work%written(0, v) = work%written(0, v) + 1
         work%written(work%written(0, v), v) = row
      end subroutine enter

      !> Rows of a larger group, which must hold zero before it is solved.
      subroutine enter_all(rows)
         integer, intent(in) :: rows(:)
         integer :: j

         do j = 1, size(rows)
            call enter(rows(j), .false.)
         end do
      end subroutine enter_all
   end subroutine list_steps

   !> Steps whose result a variable changes.
   subroutine mark_steps(problem, v, work)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v
      type(sensitivity_t), intent(inout) :: work
      logical, allocatable :: row(:)   !! by row of the store: it changes
      integer :: k, m

      allocate (row(0:size(problem%linkage%store%v, 2)), source=.false.)
      associate (link => problem%linkage)
         if (problem%parameters%variables(v)%kind == variable_crnki) then
            row(link%input_row) = .true.
         end if
         row(pack(link%driven_row, abs(work%stretch(link%driven_arc, v)) > 0.0_wp)) = .true.
         row(0) = .false.
         do k = 1, size(link%steps)
            associate (step => link%steps(k))
               if (problem%plan%steps(k)%kind == step_point) then
                  work%moves(k, v) = row(step%from_x) .or. row(step%root_x) .or. row(step%slide_row) .or. &
                                     changes(step%arc)
                  row(step%to_x) = work%moves(k, v)
               else if (allocated(step%dyad%higher)) then
                  associate (higher => step%dyad%higher)
                     work%moves(k, v) = any(row(reshape(higher%ends, [size(higher%ends)]))) .or. &
                                        any(row(higher%terms%root_x)) .or. any(row(higher%terms%slide)) .or. &
                                        any([(changes(higher%terms(m)%arc), m=1, size(higher%terms))]) .or. &
                                        any([(any(row(higher%ties(m)%roots)) .or. row(higher%ties(m)%drive_root), &
                                              m=1, size(higher%ties))])
                     if (problem%parameters%variables(v)%kind == variable_gama .and. size(higher%ties) > 0) &
                        work%moves(k, v) = work%moves(k, v) .or. any(higher%arc == problem%parameters%variables(v)%n)
                     row(higher%row) = work%moves(k, v)
                  end associate
               else
                  associate (dyad => step%dyad)
                     work%moves(k, v) = row(dyad%s_x) .or. row(dyad%e_x) .or. changes(dyad%arc_p) .or. changes(dyad%arc_q) .or. &
                                        row(dyad%p_x) .or. row(dyad%q_x)
                     row(dyad%unknown) = work%moves(k, v)
                  end associate
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

   !> Derivatives of the output's components by every variable, at every position.
   !>
   !> Output as the listing has it (angles in degrees); variables in their own units (degrees for angles). The linkage must
   !> close; at a dead point the derivatives are infinite and zero is given.
   subroutine find_jacobian(problem, dimensions, work, dout, dk, dp, solved, held, loops, wanted, beside)
      type(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(sensitivity_t), intent(inout) :: work
      real(wp), intent(out) :: dout(:, :, :)        !! shape (positions, nvar, components)
      real(wp), intent(out), optional :: dk(:, :, :) !! shape (positions, nloop, nvar): of what `block_constraints` gives
      real(wp), intent(out), optional :: dp(:, :, :, :) !! shape (positions, 2, joints, nvar): of the joints asked for
      logical, intent(in), optional :: solved       !! the positions are one block, which still holds this linkage and its output
      logical, intent(in), optional :: held(:)      !! shape (nvar): not wanted, zero is given
      logical, intent(in), optional :: loops(:)     !! shape (nloop): dk of which is wanted; of the others zero is given
      type(wanted_outputs_t), intent(inout), optional :: wanted !! outputs of a sketch, whose changes are to be found
      type(beside_t), intent(in), optional :: beside(:) !! shape (joints): how far from points of the plan those asked for are
      integer :: block, offset, n, m, v, last
      logical :: ready

      ready = .false.
      if (present(solved)) ready = solved
      if (.not. ready) call problem%bind(dimensions)
      offset = 0
      n = problem%positions
      do block = 1, problem%blocks()
         if (.not. ready) then
            call problem%solve_block(block, offset, n)
            call problem%output_of(n)
         end if
         m = padded(n)
         call form_frames(problem, work%rates, m, fixed_too=.true.)
         call clear_rows(work%rates%d(1))
         last = 0
         if (present(wanted)) call begin_outputs(problem, offset, n, wanted)
         do v = 1, size(problem%parameters%variables)
            if (present(held)) then
               if (held(v)) then
                  dout(offset + 1:offset + n, v, :) = 0.0_wp
                  if (present(dk)) dk(offset + 1:offset + n, :, v) = 0.0_wp
                  if (present(dp)) dp(offset + 1:offset + n, :, :, v) = 0.0_wp
                  cycle
               end if
            end if
            if (last > 0) call clear_others(last, v, m, work)
            last = v
            call change_of(problem, v, m, work)
            call problem%output%change(problem%linkage, work%rates%d(1), n, problem%parameters%variables(v)%kind, &
                                       work%turn(problem%mechanism%outputs(1)%arc, v), unit_of(problem, v), &
                                       dout(offset + 1:offset + n, v, :))
            if (present(dk)) call change_of_constraints(problem, v, n, work, dk(offset + 1:offset + n, :, v), loops)
            if (present(wanted)) call change_of_outputs(problem, v, offset, n, work, wanted)
            if (present(dp)) call change_of_joints(problem, v, n, work, dp(offset + 1:offset + n, :, :, v), beside)
         end do
      end do
   end subroutine find_jacobian

   !> How near each dyad is to its limit, at the positions of the block just solved, as `closure_of` has it; loops that are not
   !> solved: 0.
   pure subroutine block_constraints(problem, n, k)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: n
      real(wp), intent(out) :: k(:, :)              !! shape (n, nloop)
      integer :: loop

      do loop = 1, problem%mechanism%nloop
         k(:, loop) = 0.0_wp
         associate (step => problem%linkage%step_of_loop(loop), link => problem%linkage)
            if (step > 0) call closure_of(n, link%steps(step)%dyad, link%store, problem%toggle*link%scale, &
                                         problem%side(loop), k(:, loop))
         end associate
      end do
   end subroutine block_constraints

   !> Change of the constraints with a variable.
   subroutine change_of_constraints(problem, v, n, work, dk, loops)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v, n
      type(sensitivity_t), intent(in) :: work
      real(wp), intent(out) :: dk(:, :)             !! shape (n, nloop)
      logical, intent(in), optional :: loops(:)     !! shape (nloop): those wanted
      integer :: loop

      do loop = 1, problem%mechanism%nloop
         dk(:, loop) = 0.0_wp
         associate (step => problem%linkage%step_of_loop(loop), link => problem%linkage)
            if (step == 0) cycle
            if (.not. work%moves(step, v)) cycle
            if (present(loops)) then
               if (.not. loops(loop)) cycle
            end if
            associate (dyad => link%steps(step)%dyad)
               if (allocated(dyad%higher)) then
                  call change_of_higher(n, dyad%higher, link%store, work%rates%d(1), work%turn(:, v), &
                                        work%stretch(:, v)*link%scale, dk(:, loop))
                  dk(:, loop) = -dk(:, loop)*unit_of(problem, v)
                  cycle
               end if
               call change_of_closure(n, dyad, link%store, work%rates%d(1), problem%toggle*link%scale, problem%side(loop), &
                                      unit_of(problem, v), &
                                      work%stretch(dyad%arc_p, v)*link%scale, work%stretch(dyad%arc_q, v)*link%scale, &
                                      work%turn(dyad%arc_p, v), work%turn(dyad%arc_q, v), dk(:, loop))
            end associate
         end associate
      end do
   end subroutine change_of_constraints

   !> Places at the block just solved, and what each joint that stands off its arcs does by its own two dimensions.
   subroutine begin_outputs(problem, offset, n, wanted)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: offset, n
      type(wanted_outputs_t), intent(inout) :: wanted
      complex(wp) :: along, across
      integer :: i, k, nvar, joint

      nvar = size(problem%parameters%variables)
      if (.not. allocated(wanted%joint)) then
         allocate (wanted%joint(size(wanted%sketch%drawn), 0:highest_order, problem%linkage%capacity), source=(0.0_wp, 0.0_wp))
         allocate (wanted%moved(size(wanted%sketch%arcs), 0:highest_order, problem%linkage%capacity), source=0.0_wp)
         wanted%apart = pack([(k, k=1, size(wanted%sketch%moving))], abs(wanted%sketch%moving%offset) > 0.0_wp)
         allocate (wanted%change(problem%positions, nvar + 2*size(wanted%apart), wanted%numbers), source=0.0_wp)
      end if
      call find_places(wanted%sketch, problem, n, wanted%joint(:, 0, :n), wanted%moved(:, 0, :n))
      wanted%joint(:, 1, :) = (0.0_wp, 0.0_wp)
      wanted%moved(:, 1, :) = 0.0_wp
      do k = 1, size(wanted%apart)
         joint = wanted%sketch%moving(wanted%apart(k))%joint
         do i = 1, n
            call find_own_changes(wanted%sketch, problem, wanted%apart(k), i, along, across)
            wanted%joint(joint, 1, i) = along
            call note(wanted, i, offset + i, nvar + 2*k - 1)
            wanted%joint(joint, 1, i) = across
            call note(wanted, i, offset + i, nvar + 2*k)
            wanted%joint(joint, 1, i) = (0.0_wp, 0.0_wp)
         end do
      end do
   end subroutine begin_outputs

   !> Change of the outputs of a sketch with a variable. Dimensions of the output arc are those of a joint that stands off its arcs.
   subroutine change_of_outputs(problem, v, offset, n, work, wanted)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v, offset, n
      type(sensitivity_t), intent(in) :: work
      type(wanted_outputs_t), intent(inout) :: wanted
      real(wp) :: x, y
      integer :: i

      associate (kind => problem%parameters%variables(v)%kind)
         if (any(kind == [variable_outlk, variable_outang, variable_aside, variable_aside_angle])) return
         call problem%output%change_of_origin(kind, x, y)
      end associate
      call find_changes(wanted%sketch, problem, work%rates%d(1), work%turn(:, v), cmplx(x, y, wp), unit_of(problem, v), n, &
                        wanted%joint(:, 1, :n), wanted%moved(:, 1, :n))
      do i = 1, n
         call note(wanted, i, offset + i, v)
      end do
   end subroutine change_of_outputs

   !> The change of all numbers from that of the places at position i of the block, k of all: a derivative like that by time.
   subroutine note(wanted, i, k, column)
      type(wanted_outputs_t), intent(inout) :: wanted
      integer, intent(in) :: i, k, column
      real(wp) :: values(wanted%numbers, 0:highest_order)

      call values_of_outputs(wanted%outputs, wanted%joint(:, :, i), wanted%moved(:, :, i), [0.0_wp, 0.0_wp], values)
      wanted%change(k, column, :) = values(:, 1)*merge(degrees_per_radian, 1.0_wp, wanted%angle)
   end subroutine note

   !> Change of the joints asked for with a variable, in machine axes and the user's unit.
   subroutine change_of_joints(problem, v, n, work, dp, beside)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v, n
      type(sensitivity_t), intent(in) :: work
      real(wp), intent(out) :: dp(:, :, :)          !! shape (n, 2, joints)
      type(beside_t), intent(in), optional :: beside(:)
      complex(wp) :: moves
      real(wp) :: back, ox, oy
      integer :: i, j

      back = unit_of(problem, v)/problem%linkage%scale
      call problem%output%change_of_origin(problem%parameters%variables(v)%kind, ox, oy)
      do j = 1, size(problem%plan%joint_points)
         associate (px => problem%linkage%point_x(problem%plan%joint_points(j)), &
                    py => problem%linkage%point_y(problem%plan%joint_points(j)), d => work%rates%d(1)%v)
            dp(:, 1, j) = d(1:n, px)*back + ox*unit_of(problem, v)
            dp(:, 2, j) = d(1:n, py)*back + oy*unit_of(problem, v)
         end associate
         if (.not. present(beside)) cycle
         if (beside(j)%arc == 0) cycle
         associate (root => problem%linkage%root_x(problem%plan%root(beside(j)%arc)))
            do i = 1, n
               moves = problem%line_beside(beside(j), i)*cmplx(0.0_wp, unit_of(problem, v)* &
                                                               (work%rates%d(1)%v(i, root) + work%turn(beside(j)%arc, v)), wp)
               dp(i, :, j) = dp(i, :, j) + [moves%re, moves%im]
            end do
         end associate
         ! its own distance and angle
         associate (variable => problem%parameters%variables(v))
            if (all(variable%kind /= [variable_aside, variable_aside_angle]) .or. variable%n /= beside(j)%joint) cycle
            do i = 1, n
               moves = problem%line_beside(beside(j), i)
               if (variable%kind == variable_aside) then
                  moves = moves/abs(moves)
               else
                  moves = moves*cmplx(0.0_wp, unit_of(problem, v), wp)
               end if
               dp(i, :, j) = dp(i, :, j) + [moves%re, moves%im]
            end do
         end associate
      end do
   end subroutine change_of_joints

   !> Radians a unit of the variable is worth if it is an angle in degrees, else 1.
   pure real(wp) function unit_of(problem, v) result(unit)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v

      unit = 1.0_wp
      select case (problem%parameters%variables(v)%kind)
      case (variable_gama, variable_outang, variable_origng, variable_aside_angle)
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
      integer :: j, k

      associate (link => problem%linkage, d => work%rates%d(1)%v)
         if (problem%parameters%variables(v)%kind == variable_crnki) then
            do k = 1, size(link%input_row)
               d(1:n, link%input_row(k)) = link%input_rate(k)
            end do
         end if
         call put_driven_lengths(link, n, work%stretch(:, v), work%rates%d(1))
         j = 1
         do
            call change_steps(n, d(1, 1), work%rates%frames%work%v(1, 1), work%turn(1, v), work%stretch(1, v), link%scale, &
                              work%changes, work%moved(0, v), work%moved(1, v), j)
            if (j > work%moved(0, v)) return
            k = work%moved(j, v)
            associate (variable => problem%parameters%variables(v))
               call group_change(link%steps(k)%dyad%higher, work%rates%place(k), v, n, &
                                 merge(variable%n, 0, variable%kind == variable_gama), link%scale, work)
            end associate
            j = j + 1
         end do
      end associate
   end subroutine change_of

   !> Points and unknowns of dyads from entry `next` of a list of steps on, up to a larger group; whatever stood in their rows does
   !> not matter. Short blocks make it worth while that places of rows are known before.
   pure subroutine change_steps(n, d, w, turn, stretch, scale, changes, count, list, next)
      integer, intent(in) :: n
      real(wp), intent(inout) :: d(*)           !! rows of changes, from position 1 of the first on
      real(wp), intent(in) :: w(*)              !! rows of frames, the same way
      real(wp), intent(in) :: turn(*), stretch(*) !! by arc
      real(wp), intent(in) :: scale
      type(change_t), intent(in) :: changes(*)  !! by step
      integer, intent(in) :: count, list(*)
      integer, intent(inout) :: next            !! afterwards the entry of the group, or past the last

      do next = next, count
         associate (step => changes(list(next)))
            associate (from => step%from, to => step%to, root => step%root, slide => step%slide, x => step%unknown, &
                       p => step%arc(1), q => step%arc(2), e => step%vector, m => step%matrix)
               select case (step%kind)
               case (change_of_point)
                  call add_arc_change(n, 1.0_wp, d(from(1)), d(from(2)), w(e(1, 1)), w(e(2, 1)), w(e(3, 1)), d(root(1)), &
                                      d(slide(1)), turn(p), stretch(p)*scale, d(to(1)), d(to(2)))
               case (change_of_dyad)
                  if (abs(stretch(p)) + abs(stretch(q)) > 0.0_wp .or. step%takes_direction) then
                     call change_ends_and_arcs(n, d(from(1)), d(from(2)), d(to(1)), d(to(2)), &
                                               w(e(1, 1)), w(e(2, 1)), w(e(3, 1)), d(root(1)), d(slide(1)), turn(p), &
                                               stretch(p)*scale, w(e(1, 2)), w(e(2, 2)), w(e(3, 2)), d(root(2)), &
                                               d(slide(2)), turn(q), stretch(q)*scale, w(m(1)), w(m(2)), w(m(3)), w(m(4)), &
                                               d(x(1)), d(x(2)))
                  else
                     call change_ends(n, d(from(1)), d(from(2)), d(to(1)), d(to(2)), w(m(1)), w(m(2)), w(m(3)), w(m(4)), &
                                      d(x(1)), d(x(2)))
                  end if
               case default
                  return
               end select
            end associate
         end associate
      end do
   end subroutine change_steps

   subroutine arc_change(frames, d, n, factor, at, root, slide, turn, stretch, fx, fy, tx, ty)
      type(frames_t), intent(in) :: frames
      type(rows_t), intent(in) :: d
      integer, intent(in) :: n, at, root, slide
      real(wp), intent(in) :: factor, turn, stretch
      real(wp), intent(in) :: fx(n), fy(n)
      real(wp), intent(out) :: tx(n), ty(n)

      associate (w => frames%work%v)
         if (slide > 0) then
            call add_arc_change(n, factor, fx, fy, w(1, at), w(1, at + 1), w(1, at + 4), d%v(1, root), d%v(1, slide), turn, &
                                stretch, tx, ty)
         else
            call add_arc_change(n, factor, fx, fy, w(1, at), w(1, at + 1), w(1, at + 4), d%v(1, root), w(1, frames%zero), turn, &
                                stretch, tx, ty)
         end if
      end associate
   end subroutine arc_change

   !> Unknowns of a larger group, whose rows hold zero here.
   subroutine group_change(higher, at, v, n, phase, scale, work)
      type(higher_t), intent(in) :: higher
      integer, intent(in) :: at, v, n
      integer, intent(in) :: phase        !! the arc whose angle varies; 0: the variable is no angle of an arc
      real(wp), intent(in) :: scale
      type(sensitivity_t), intent(inout) :: work
      real(wp) :: gap(n, higher%equations)
      integer :: r, k

      associate (d => work%rates%d(1)%v)
         do r = 1, higher%rings
            call difference(n, d(1, higher%ends(1, r)), d(1, higher%ends(2, r)), d(1, higher%ends(3, r)), d(1, higher%ends(4, r)), &
                            gap(:, 2*r - 1), gap(:, 2*r))
         end do
         do k = 1, size(higher%terms)
            associate (term => higher%terms(k), x => gap(:, 2*higher%terms(k)%ring - 1), y => gap(:, 2*higher%terms(k)%ring))
               call arc_change(work%rates%frames, work%rates%d(1), n, -1.0_wp, at + rows_of_arc*(k - 1), term%root_x, term%slide, &
                               work%turn(term%arc, v), work%stretch(term%arc, v)*scale, x, y, work%tx, work%ty)
               x = work%tx(1:n)
               y = work%ty(1:n)
            end associate
         end do
         call gaps_of_ties(n, higher, work%rates%d(1), gap)
         if (phase > 0) call add_gaps_of_phase(n, higher, phase, gap)
         call solve_higher(n, higher, at, work%rates%frames, gap, work%rates%d(1))
      end associate
   end subroutine group_change

   !> Put rows that one variable has changed back to zero, but for those that the next one overwrites.
   subroutine clear_others(last, next, n, work)
      integer, intent(in) :: last, next, n
      type(sensitivity_t), intent(inout) :: work
      integer :: j

      do j = 1, work%written(0, last)
         associate (row => work%written(j, last))
            if (.not. work%overwritten(row, next)) work%rates%d(1)%v(1:n, row) = 0.0_wp
         end associate
      end do
   end subroutine clear_others

   !> Put the rows a variable has changed back to zero.
   subroutine clear_changes(problem, v, n, moves, d)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: v, n
      logical, intent(in) :: moves(:)     !! shape (steps): the step's result changes with the variable
      type(rows_t), intent(inout) :: d
      integer :: k, j

      associate (link => problem%linkage)
         if (problem%parameters%variables(v)%kind == variable_crnki) then
            do k = 1, size(link%input_row)
               call zero(link%input_row(k))
            end do
         end if
         do k = 1, size(link%driven_row)
            call zero(link%driven_row(k))
         end do
         do k = 1, size(link%steps)
            if (.not. moves(k)) cycle
            if (problem%plan%steps(k)%kind == step_point) then
               call zero(link%steps(k)%to_x)
               call zero(link%steps(k)%to_y)
            else if (allocated(link%steps(k)%dyad%higher)) then
               do j = 1, link%steps(k)%dyad%higher%unknowns
                  call zero(link%steps(k)%dyad%higher%row(j))
               end do
            else
               call zero(link%steps(k)%dyad%unknown(1))
               call zero(link%steps(k)%dyad%unknown(2))
            end if
         end do
      end associate

   contains

      subroutine zero(row)
         integer, intent(in) :: row

         d%v(1:n, row) = 0.0_wp
      end subroutine zero
   end subroutine clear_changes
end module psalm_sensitivity
