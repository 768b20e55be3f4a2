!> Desired values of several outputs of a sketch, and of their derivatives by the input: how far they are missed, and how that
!> changes with every variable.
!>
!> Those of the first output are, where they can be, the desired values of the problem itself; here are the others. Angles are
!> in degrees, in derivatives in radians. Where the linkage does not close nothing is compared; at a dead point no derivative is,
!> and no ratio where the second of its rates is none.
module psalm_output_targets
   use psalm_angles, only: unit_vector
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_equalities, only: equal_numbers_t, relations_of, compared_columns, miss_of
   use psalm_error, only: problem_t
   use psalm_joint_location, only: locate_sketch
   use psalm_kinds, only: wp, full_turn
   use psalm_linkage, only: padded
   use psalm_output_kind, only: most_rates
   use psalm_parameters, only: variable_t, variable_aside, variable_aside_angle, variable_crnki, variable_outang, variable_outlk
   use psalm_closure, only: most_orders
   use psalm_rate_changes, only: change_rates
   use psalm_rates, only: prepare_rates, differentiate, form_frames, is_dead
   use psalm_rows, only: rows_t, make_rows, clear_rows
   use psalm_sensitivity, only: sensitivity_t, wanted_outputs_t, prepare_sensitivity, find_jacobian, unit_of, clear_changes
   use psalm_sketch, only: sketch_t, sketch_output_t, target_column_t, output_ratio, columns_of, first_number, &
                           most_targets
   use psalm_sketch_motion, only: find_places, observe_sketch, find_rate_changes, find_own_rate_changes
   use psalm_sketch_outputs, only: names_of_numbers, values_of_outputs, change_of_values, name_length
   implicit none (type, external)
   private
   public :: output_targets_t, prepare_output_targets, find_output_targets, differentiate_output_targets, sum_of_desired_errors, &
             compare_with_targets, both_exist, target_group_t, target_groups, first_target

   integer, parameter :: of_one_joint(*) = [variable_outlk, variable_outang, variable_aside, variable_aside_angle] !! kinds
   character(*), parameter :: of_order(0:most_targets) = [character(6) :: '', ' (VEL)', ' (ACC)'] !! after the items that want them

   !> Numbers whose errors are given as one: x and y of a point, else one number.
   type :: target_group_t
      integer, allocatable :: columns(:)            !! of the targets
      integer :: number = 0                         !! the first of them, counted through the numbers of all outputs of the sketch
      integer :: order = 0                          !! derivative
      character(name_length) :: name = ''             !! of the output, or of the number
   end type target_group_t

   !> Room to work in, and the linkage looked at last. Columns are the numbers that are wanted, as
   !> `compared_columns` has them; those of equalities alone weigh nothing there.
   type :: output_targets_t
      class(problem_t), allocatable :: problem      !! finds every joint
      type(sensitivity_t) :: work
      type(wanted_outputs_t) :: wanted              !! outputs with targets, and those of which ratios are
      type(rows_t) :: change(0:most_rates)          !! changes with one variable of positions, first and second derivatives
      integer :: shown = 0                          !! of the joints that move: the first output, if it stands off its arc; 0: none
      logical :: moving = .false.                   !! derivatives or ratios are wanted
      integer, allocatable :: number(:), order(:)   !! by column: of all numbers of the outputs; derivative
      logical, allocatable :: angle(:)              !! by column: it is one, in degrees
      logical, allocatable :: rate(:)               !! by column: needs derivatives
      logical, allocatable :: is_length(:)          !! by column: it, or what it is a derivative of, is a length
      character(name_length), allocatable :: names(:) !! by column
      logical, allocatable :: exists(:, :)          !! shape (positions, columns)
      real(wp), allocatable :: actual(:, :)         !! shape (positions, columns)
      real(wp), allocatable :: miss(:, :)           !! the same shape: actual - desired
      real(wp), allocatable :: by(:, :, :)          !! shape (positions, variables, columns): derivatives of `miss`
      type(equal_numbers_t), allocatable :: relations(:) !! numbers that are to be equal
      real(wp), allocatable :: difference(:)        !! shape (relations): by how much they are not; 0 where one does not exist
      real(wp), allocatable :: difference_by(:, :)  !! shape (relations, variables): its derivatives
   end type output_targets_t

contains

   !> Make ready for a problem with such targets. With `timed` the input of every position is the last variable.
   subroutine prepare_output_targets(set, problem, timed, derivatives, targets)
      type(data_set_t), intent(in) :: set           !! a sketch with its loops
      type(problem_t), intent(in) :: problem
      logical, intent(in) :: timed
      logical, intent(in) :: derivatives            !! by the variables
      type(output_targets_t), intent(out) :: targets
      type(variable_t) :: input
      integer :: k

      allocate (targets%problem, source=problem)
      if (allocated(targets%problem%linkages)) deallocate (targets%problem%linkages)
      if (timed) then
         input%kind = variable_crnki
         targets%problem%parameters%variables = [problem%parameters%variables, input]
      end if
      associate (wanted => targets%wanted, n => problem%positions)
         call locate_sketch(set, wanted%sketch, problem%given)
         call list_columns(set%sketch%outputs, compared_columns(set%sketch), targets)
         targets%relations = relations_of(set%sketch, n)
         allocate (targets%difference(size(targets%relations)), source=0.0_wp)
         do k = 1, size(wanted%sketch%moving)
            if (wanted%sketch%moving(k)%joint == set%traced%output_joint .and. problem%given%outlk > 0.0_wp) targets%shown = k
         end do
         call targets%problem%want_derivatives(.true., wanted%sketch%points)
         allocate (targets%exists(n, size(targets%number)), source=.false.)
         allocate (targets%actual(n, size(targets%number)), targets%miss(n, size(targets%number)), source=0.0_wp)
      end associate
      if (.not. derivatives) then
         if (targets%moving) call prepare_rates(targets%problem, targets%work%rates)
         return
      end if
      allocate (targets%by(problem%positions, size(targets%problem%parameters%variables), size(targets%number)), source=0.0_wp)
      allocate (targets%difference_by(size(targets%relations), size(targets%by, 2)), source=0.0_wp)
      call prepare_sensitivity(targets%problem, targets%work)
      if (.not. targets%moving) return
      associate (link => targets%problem%linkage)
         do k = 0, most_rates
            call make_rows(link%capacity, size(link%store%v, 2), targets%change(k))
         end do
      end associate
   end subroutine prepare_output_targets

   !> The outputs that are wanted, or whose rates are parts of a ratio that is, and what each column is of them.
   subroutine list_columns(outputs, columns, targets)
      type(sketch_output_t), intent(in) :: outputs(:)
      type(target_column_t), intent(in) :: columns(:)
      type(output_targets_t), intent(inout) :: targets
      character(name_length), allocatable :: names(:)
      logical, allocatable :: turning(:)
      integer :: first(size(outputs)), place(size(outputs)), n, k
      logical :: used(size(outputs))

      used = [(any(columns%output == k), k=1, size(outputs))]
      do k = 1, size(outputs)
         if (used(k) .and. outputs(k)%kind == output_ratio) used(outputs(k)%outputs) = .true.
      end do
      associate (wanted => targets%wanted)
         wanted%outputs = pack(outputs, used)
         place = [(count(used(:k)), k=1, size(outputs))]
         n = 0
         do k = 1, size(outputs)
            first(k) = n
            if (used(k)) n = n + columns_of(outputs(k))
         end do
         do k = 1, size(wanted%outputs)
            if (wanted%outputs(k)%kind == output_ratio) wanted%outputs(k)%outputs = place(wanted%outputs(k)%outputs)
         end do
         call names_of_numbers(wanted%outputs, names, turning, wanted%angle)
         wanted%numbers = n
         targets%number = first(columns%output) + columns%component
         targets%order = columns%order
         targets%angle = wanted%angle(targets%number) .and. targets%order == 0
         targets%rate = targets%order > 0 .or. outputs(columns%output)%kind == output_ratio
         targets%is_length = .not. (wanted%angle(targets%number) .or. outputs(columns%output)%kind == output_ratio)
         targets%moving = any(targets%rate)
         targets%names = names(targets%number)
         do k = 1, size(columns)
            if (columns(k)%order > 0) targets%names(k) = trim(targets%names(k))//of_order(columns(k)%order)
         end do
      end associate
   end subroutine list_columns

   !> What a linkage does of what is desired.
   subroutine find_output_targets(targets, dimensions)
      type(output_targets_t), intent(inout) :: targets
      type(dimensions_t), intent(in) :: dimensions

      call look(targets, dimensions, .false.)
   end subroutine find_output_targets

   !> The same, and its changes with every variable.
   subroutine differentiate_output_targets(targets, dimensions)
      type(output_targets_t), intent(inout) :: targets
      type(dimensions_t), intent(in) :: dimensions
      real(wp) :: unused(size(targets%by, 1), size(targets%by, 2), targets%problem%output%kind%components)
      integer :: v, k, nvar

      call look(targets, dimensions, targets%moving)
      if (.not. targets%moving) then
         call find_jacobian(targets%problem, dimensions, targets%work, unused, wanted=targets%wanted)
         nvar = size(targets%by, 2)
         targets%by = targets%wanted%change(:, :nvar, targets%number)
         do v = 1, nvar
            associate (kind => targets%problem%parameters%variables(v)%kind)
               if (all(kind /= of_one_joint)) cycle
               targets%by(:, v, :) = 0.0_wp
               k = findloc(targets%wanted%apart, moved_by(targets, v), dim=1)
               if (moved_by(targets, v) == 0 .or. k == 0) cycle
               targets%by(:, v, :) = targets%wanted%change(:, nvar + 2*k - merge(1, 0, any(kind == [variable_outlk, &
                                                                                      variable_aside])), targets%number)
            end associate
         end do
      end if
      do v = 1, size(targets%by, 2)
         where (.not. targets%exists) targets%by(:, v, :) = 0.0_wp
         do k = 1, size(targets%relations)
            associate (of => targets%relations(k))
               targets%difference_by(k, v) = targets%by(of%positions(1), v, of%columns(1)) &
                                             - of%factor*targets%by(of%positions(2), v, of%columns(2))
            end associate
            if (.not. both_exist(targets, k)) targets%difference_by(k, v) = 0.0_wp
         end do
      end do
   end subroutine differentiate_output_targets

   !> True if both numbers of a relation are there.
   pure logical function both_exist(targets, k)
      type(output_targets_t), intent(in) :: targets
      integer, intent(in) :: k                      !! relation

      associate (of => targets%relations(k))
         both_exist = targets%exists(of%positions(1), of%columns(1)) .and. targets%exists(of%positions(2), of%columns(2))
      end associate
   end function both_exist

   !> By how much numbers that are to be equal are not.
   pure subroutine compare_equals(targets)
      type(output_targets_t), intent(inout) :: targets
      integer :: k

      do k = 1, size(targets%relations)
         associate (of => targets%relations(k))
            targets%difference(k) = 0.0_wp
            if (both_exist(targets, k)) targets%difference(k) = miss_of(of, targets%actual(of%positions(1), of%columns(1)), &
                                                                        targets%actual(of%positions(2), of%columns(2)))
         end associate
      end do
   end subroutine compare_equals

   !> Which of the joints that move off the arcs has the distance or angle that a variable of one joint is; 0: none.
   pure integer function moved_by(targets, v) result(moving)
      type(output_targets_t), intent(in) :: targets
      integer, intent(in) :: v                      !! variable, one of `of_one_joint`

      moving = targets%shown
      associate (variable => targets%problem%parameters%variables(v))
         if (any(variable%kind == [variable_aside, variable_aside_angle])) &
            moving = findloc(targets%wanted%sketch%moving%joint, variable%n, dim=1)
      end associate
   end function moved_by

   !> What a linkage does of what is desired at the positions that it comes to; elsewhere nothing is compared.
   subroutine compare_with_targets(set, problem, dimensions, closed, targets)
      type(data_set_t), intent(in) :: set           !! a sketch with its loops
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in) :: closed(:)              !! shape (positions): by the analysis of the problem
      type(output_targets_t), intent(out) :: targets
      integer :: k

      call prepare_output_targets(set, problem, .false., .false., targets)
      call find_output_targets(targets, dimensions)
      do k = 1, size(targets%miss, 2)
         targets%exists(:, k) = targets%exists(:, k) .and. closed
      end do
      where (.not. targets%exists) targets%miss = 0.0_wp
      call compare_equals(targets)
   end subroutine compare_with_targets

   !> What errors are given of, in the order of the columns. The angle of a pose is given by itself.
   pure function target_groups(sketch) result(groups)
      type(sketch_t), intent(in) :: sketch
      type(target_group_t), allocatable :: groups(:)
      type(target_column_t), allocatable :: columns(:)
      type(target_group_t) :: one
      character(name_length), allocatable :: names(:)
      logical, allocatable :: turning(:)
      integer, parameter :: of_x = 1, of_y = 2  ! components
      integer :: k

      columns = sketch%target_columns()
      call names_of_numbers(sketch%outputs, names, turning)
      allocate (groups(0))
      do k = 1, size(columns)
         associate (at => columns(k), output => sketch%outputs(columns(k)%output))
            if (at%component == of_y) cycle
            one%columns = [k]
            one%number = first_number(sketch%outputs, at%output) + at%component - 1
            one%order = at%order
            one%name = names(one%number)
            if (at%component == of_x .and. columns_of(output) > 1) then
               one%columns = [k, k + 1]
               one%name = output%name
            end if
            if (at%order > 0) one%name = trim(one%name)//of_order(at%order)
            groups = [groups, one]
         end associate
      end do
   end function target_groups

   !> What the errors of a linkage are those of where they are given as one number: the first that a value is wanted of, else the
   !> first of all.
   pure integer function first_target(groups)
      type(target_group_t), intent(in) :: groups(:)   !! at least one

      first_target = max(1, findloc(groups%order, 0, dim=1))
   end function first_target

   !> Values, of a moving linkage with derivatives, and, with `changes`, what these do with every variable.
   subroutine look(targets, dimensions, changes)
      type(output_targets_t), intent(inout) :: targets
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in) :: changes
      complex(wp), allocatable :: joint(:, :, :), joint_change(:, :, :)
      real(wp), allocatable :: moved(:, :, :), moved_change(:, :, :), values(:, :, :)
      integer :: block, offset, n, v, order

      call place_first_output(targets, dimensions)
      associate (problem => targets%problem, sketch => targets%wanted%sketch, capacity => targets%problem%linkage%capacity)
         allocate (joint(size(sketch%drawn), 0:most_orders, capacity), source=(0.0_wp, 0.0_wp))
         allocate (moved(size(sketch%arcs), 0:most_orders, capacity), source=0.0_wp)
         allocate (values(targets%wanted%numbers, 0:most_orders, capacity))
         if (changes) then
            allocate (joint_change(size(sketch%drawn), 0:most_targets, capacity), &
                      moved_change(size(sketch%arcs), 0:most_targets, capacity))
         end if
         call problem%bind(dimensions)
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, n)
            if (targets%moving) then
               call differentiate(problem, targets%work%rates, n, most_orders)
               ! by the input itself: it moves at the rate 1
               call observe_sketch(sketch, problem, targets%work%rates, n, 1.0_wp, 0.0_wp, joint(:, :, :n), moved(:, :, :n))
            else
               call find_places(sketch, problem, n, joint(:, 0, :n), moved(:, 0, :n))
            end if
            call compare(targets, offset, n, joint, moved, values)
            if (.not. changes) cycle
            call form_frames(problem, targets%work%rates, padded(n), fixed_too=.true.)
            do order = 0, most_rates
               call clear_rows(targets%change(order))
            end do
            do v = 1, size(targets%by, 2)
               call change_of_places(targets, v, n, joint_change(:, :, :n), moved_change(:, :, :n))
               call note_changes(targets, v, offset, n, joint, joint_change, moved_change, values)
            end do
         end do
      end associate
      call compare_equals(targets)
   end subroutine look

   !> The numbers that are wanted at the block just solved, and by how much they miss.
   subroutine compare(targets, offset, n, joint, moved, values)
      type(output_targets_t), intent(inout) :: targets
      integer, intent(in) :: offset, n
      complex(wp), intent(in) :: joint(:, 0:, :)
      real(wp), intent(in) :: moved(:, 0:, :)
      real(wp), intent(out) :: values(:, 0:, :)
      logical :: closes, alive
      integer :: i, k, loop

      do i = 1, n
         associate (problem => targets%problem, exists => targets%exists(offset + i, :), actual => targets%actual(offset + i, :), &
                    miss => targets%miss(offset + i, :))
            closes = all([(problem%linkage%closes(i, loop), loop=1, problem%mechanism%nloop)])
            alive = closes
            if (closes .and. targets%moving) alive = .not. any([(is_dead(problem, targets%work%rates, loop, i), &
                                                                 loop=1, problem%mechanism%nloop)])
            exists = merge(alive, closes, targets%rate)
            values(:, :, i) = 0.0_wp
            actual = 0.0_wp
            miss = 0.0_wp
            if (.not. closes) cycle
            call values_of_outputs(targets%wanted%outputs, joint(:, :, i), moved(:, :, i), fastest(i), values(:, :, i))
            do k = 1, size(miss)
               exists(k) = exists(k) .and. values(targets%number(k), targets%order(k), i) < huge(1.0_wp)
               if (.not. exists(k)) cycle
               actual(k) = values(targets%number(k), targets%order(k), i)
               miss(k) = actual(k) - problem%target_values(offset + i, k)
               if (targets%angle(k)) miss(k) = miss(k) - full_turn*anint(miss(k)/full_turn)
            end do
         end associate
      end do

   contains

      !> The largest rates of any direction and of any joint and slide.
      function fastest(i)
         integer, intent(in) :: i
         real(wp) :: fastest(2)
         integer :: r

         fastest = 0.0_wp
         if (.not. targets%moving) return
         associate (link => targets%problem%linkage)
            do r = 1, size(link%root_x)
               fastest(1) = max(fastest(1), abs(targets%work%rates%d(1)%v(i, link%root_x(r))))
            end do
         end associate
         fastest(2) = max(maxval(abs(joint(:, 1, i))), maxval(abs(moved(:, 1, i))))
      end function fastest
   end subroutine compare

   !> Changes of places and their derivatives with a variable. Dimensions of the output arc are those of a joint that stands off it.
   subroutine change_of_places(targets, v, n, joint, moved)
      type(output_targets_t), intent(inout) :: targets
      integer, intent(in) :: v, n
      complex(wp), intent(out) :: joint(:, 0:, :)    !! shape (joints, 0:most_targets, n)
      real(wp), intent(out) :: moved(:, 0:, :)       !! shape (slides, 0:most_targets, n)
      complex(wp) :: along(0:most_targets), across(0:most_targets)
      real(wp) :: x, y
      integer :: i, k, order

      associate (problem => targets%problem, kind => targets%problem%parameters%variables(v)%kind, sketch => targets%wanted%sketch)
         if (any(kind == of_one_joint)) then
            joint = (0.0_wp, 0.0_wp)
            moved = 0.0_wp
            k = moved_by(targets, v)
            if (k == 0) return
            do i = 1, n
               call find_own_rate_changes(sketch, problem, targets%work%rates, k, i, along, across)
               joint(sketch%moving(k)%joint, :, i) = merge(along, across, any(kind == [variable_outlk, variable_aside]))
            end do
            return
         end if
         call change_rates(problem, targets%work, v, padded(n), targets%change)
         call problem%output%change_of_origin(kind, x, y)
         call find_rate_changes(sketch, problem, targets%work%rates, targets%change, targets%work%turn(:, v), cmplx(x, y, wp), &
                                unit_of(problem, v), n, joint, moved)
         do order = 0, most_rates
            call clear_changes(problem, v, padded(n), targets%work%moves(:, v), targets%change(order))
         end do
      end associate
   end subroutine change_of_places

   !> The same of the numbers that are wanted.
   subroutine note_changes(targets, v, offset, n, joint, joint_change, moved_change, values)
      type(output_targets_t), intent(inout) :: targets
      integer, intent(in) :: v, offset, n
      complex(wp), intent(in) :: joint(:, 0:, :), joint_change(:, 0:, :)
      real(wp), intent(in) :: moved_change(:, 0:, :)
      real(wp), intent(in) :: values(:, 0:, :)
      real(wp) :: change(targets%wanted%numbers, 0:most_targets)
      integer :: i, k

      do i = 1, n
         targets%by(offset + i, v, :) = 0.0_wp
         if (.not. any(targets%exists(offset + i, :))) cycle
         call change_of_values(targets%wanted%outputs, joint(:, :, i), joint_change(:, :, i), moved_change(:, :, i), &
                               values(:, :, i), change)
         do k = 1, size(targets%number)
            targets%by(offset + i, v, k) = change(targets%number(k), targets%order(k))
         end do
      end do
   end subroutine note_changes

   !> The joint that is the first output moves with OUTLK and OUTANG, others off the arcs with what varies of them.
   subroutine place_first_output(targets, dimensions)
      type(output_targets_t), intent(inout) :: targets
      type(dimensions_t), intent(in) :: dimensions
      real(wp) :: c, s
      integer :: v

      associate (moving => targets%wanted%sketch%moving)
         do v = 1, size(targets%problem%parameters%variables)
            associate (variable => targets%problem%parameters%variables(v))
               if (all(variable%kind /= [variable_aside, variable_aside_angle]) .or. moved_by(targets, v) == 0) cycle
               call unit_vector(dimensions%aside_angle(variable%n), c, s)
               moving(moved_by(targets, v))%offset = dimensions%aside_length(variable%n)*cmplx(c, s, wp)
            end associate
         end do
      end associate
      if (targets%shown == 0) return
      call unit_vector(dimensions%outang, c, s)
      targets%wanted%sketch%moving(targets%shown)%offset = dimensions%outlk*cmplx(c, s, wp)
   end subroutine place_first_output

   !> Sum of weight * miss**2 of the linkage looked at last, those of numbers that are to be equal too.
   pure real(wp) function sum_of_desired_errors(targets) result(total)
      type(output_targets_t), intent(in) :: targets

      total = sum(targets%problem%target_weights*targets%miss**2)
      if (size(targets%relations) > 0) total = total + sum(targets%relations%weight*targets%difference**2)
   end function sum_of_desired_errors
end module psalm_output_targets
