!> The table of the positions, which every analysis has: inputs, outputs, desired values, their rates, joints, forces; and the
!> blocks of device 9 that are extracts of it.
module psalm_position_table
   use psalm_column_names, only: by_input, by_time, closed_name, condition_name, crank_name, desired_name, drive_unit, input_name, &
                                 input_unit, joint_name, number_unit, output_name, &
                                 output_unit, per_input, per_time, plotted_component, plotted_desired, plotted_output, &
                                 plotted_rate, position_name, rate_unit, target_name
   use psalm_error, only: problem_t, motion_t
   use psalm_force_list, only: add_forces
   use psalm_force_study, only: force_study_t
   use psalm_kinds, only: wp
   use psalm_output_kind, only: motion_pose, most_rates
   use psalm_rate_study, only: rate_study_t, highest_order
   use psalm_sketch, only: sketch_t, target_column_t, first_number
   use psalm_sketch_study, only: sketch_study_t
   use psalm_tables, only: table_t, tables_t, table_of, for_all, for_plots, for_programs
   use psalm_text, only: full_precision
   implicit none (type, external)
   private
   public :: add_joints, add_outputs
   public :: put_positions, plot_positions, plot_desired_rates, put_rates, put_sketch, plot_sketch, positions_block

   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: positions_block = 'positions'
   character(1), parameter :: axes(2) = ['x', 'y']
   character(*), parameter :: about_positions = 'a row for each prescribed position'

contains

   ! ---- a linkage of loops ------------------------------------------------------------------------------------------

   !> The table of an analysis: input, closed, output, desired values if there are any, wanted derivatives.
   pure subroutine put_positions(problem, motion, tables, condition)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion                 !! at the prescribed positions
      type(tables_t), intent(inout) :: tables
      real(wp), intent(in), optional :: condition(:)       !! shape (positions)
      type(table_t) :: table

      table = table_of(positions_block, about_positions, audience=for_programs, main=.true.)
      call add_motion(problem, motion, table)
      call add_desired(problem, size(motion%input), .true., table)
      if (present(condition)) call table%add(condition_name, condition)
      if (allocated(motion%rates)) call add_desired_rates(problem, motion, .true., table)
      call add_crank(motion, table)
      call tables%put(table)
   end subroutine put_positions

   !> Device 9: positions, the prescribed ones or many more. With desired values the columns are there in every block; `NaN` where
   !> the motion is not that at the positions that have some.
   pure subroutine plot_positions(title, block, problem, motion, tables, condition)
      character(*), intent(in) :: title     !! of the case
      character(*), intent(in) :: block     !! `positions`, or another name: then other programs have the table, too
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(tables_t), intent(inout) :: tables
      real(wp), intent(in), optional :: condition(:) !! shape (positions): a column more
      type(table_t) :: table
      character(:), allocatable :: name, unit, about
      logical :: prescribed

      prescribed = block == positions_block
      name = 'prescribed positions'
      if (.not. prescribed) name = trim(merge('evenly spaced', 'every degree ', problem%mechanism%sliding_input))
      unit = trim(merge('degrees', 'length ', problem%output%kind%angle > 0))
      if (problem%motion == motion_pose) unit = 'length and degrees'
      about = name//'; input in '//trim(merge('length ', 'degrees', problem%mechanism%sliding_input))
      if (.not. problem%mechanism%outputs(1)%stands_in) about = about//', output in '//unit
      table = table_of(block, 'a row for each position, '//name, notes=title//nl//about, &
                       named=.false., audience=merge(for_plots, for_all, prescribed))
      call add_motion(problem, motion, table)
      if (problem%desired) call add_desired(problem, size(motion%input), prescribed, table)
      if (present(condition) .and. .not. problem%mechanism%outputs(1)%stands_in) &
         call table%add(condition_name, condition, short=.true.)
      call add_crank(motion, table)
      call tables%put(table)
   end subroutine plot_positions

   !> Device 9: the derivatives by the input that are wanted; `NaN` where there is none or none is wanted.
   pure subroutine plot_desired_rates(title, problem, motion, tables)
      character(*), intent(in) :: title     !! of the case
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion  !! with derivatives
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(:), allocatable :: note

      note = 'derivatives; by the input in '//trim(merge('length ', 'radians', problem%mechanism%sliding_input))
      if (problem%output%kind%angle > 0) note = note//', of angles in radians'
      table = table_of('derivatives', note, notes=title//nl//note, named=.false., audience=for_plots)
      call add_input(problem, motion, table)
      call add_desired_rates(problem, motion, .false., table)
      call tables%put(table)
   end subroutine plot_desired_rates

   pure subroutine add_input(problem, motion, table)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(table_t), intent(inout) :: table

      call table%add(input_name(), motion%input, input_unit(problem%mechanism%sliding_input))
      call table%add(closed_name, motion%closed)
   end subroutine add_input

   !> The crank's angle from the x axis, where inputs count from the drawing.
   pure subroutine add_crank(motion, table)
      type(motion_t), intent(in) :: motion
      type(table_t), intent(inout) :: table

      if (allocated(motion%crank)) call table%add(crank_name(), motion%crank, output_unit(.true.))
   end subroutine add_crank

   !> Input, closed, output.
   pure subroutine add_motion(problem, motion, table)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(table_t), intent(inout) :: table
      integer :: c

      call add_input(problem, motion, table)
      if (problem%mechanism%outputs(1)%stands_in) return
      associate (kind => problem%output%kind)
         do c = 1, kind%components
            call table%add(output_name(kind, c), motion%actual(:, c), output_unit(c == kind%angle), motion%closed, &
                           plotted_output(kind, c))
         end do
      end associate
   end subroutine add_motion

   pure subroutine add_desired(problem, positions, known, table)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: positions
      logical, intent(in) :: known          !! the positions are those with desired values
      type(table_t), intent(inout) :: table
      real(wp) :: values(positions)
      integer :: c

      if (.not. problem%desired) return
      values = 0.0_wp
      associate (kind => problem%output%kind)
         do c = 1, kind%components
            if (known) values = problem%wanted(:positions, c)
            call table%add(desired_name(kind, c), values, output_unit(c == kind%angle), spread(known, 1, positions), &
                           plotted_desired(kind, c))
         end do
      end associate
   end subroutine add_desired

   !> Derivatives by the input, actual and desired.
   pure subroutine add_desired_rates(problem, motion, only_wanted, table)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      logical, intent(in) :: only_wanted    !! leave out what is wanted nowhere
      type(table_t), intent(inout) :: table
      character(:), allocatable :: per, unit
      integer :: order, c

      per = per_input(problem%mechanism%sliding_input)
      associate (kind => problem%output%kind, wanted => problem%rate_weight > 0.0_wp)
         do order = 1, most_rates
            do c = 1, kind%components
               if (only_wanted .and. .not. any(wanted(:, c, order))) cycle
               unit = rate_unit(c == kind%angle, per, order)
               call table%add(by_input(output_name(kind, c), order), motion%rates(:, c, order), unit, motion%has_rates, &
                              plotted_rate(plotted_output(kind, c), per, order))
               call table%add(by_input(desired_name(kind, c), order), problem%rate_desired(:, c, order), unit, &
                              wanted(:, c, order), plotted_rate(plotted_desired(kind, c), per, order))
            end do
         end do
      end associate
   end subroutine add_desired_rates

   !> The table of `kalm`: derivatives by the input and by time, forces; on device 9 and, unless it is a sketch, which has a table
   !> of its own, for other programs.
   subroutine put_rates(title, speed, accel, problem, rates, for_others, tables, forces)
      character(*), intent(in) :: title
      real(wp), intent(in) :: speed, accel         !! of the input
      type(problem_t), intent(in) :: problem
      type(rate_study_t), intent(in) :: rates
      logical, intent(in) :: for_others
      type(tables_t), intent(inout) :: tables
      type(force_study_t), intent(in), optional :: forces  !! their columns follow
      type(table_t) :: table
      character(:), allocatable :: per, notes

      per = per_input(problem%mechanism%sliding_input)
      notes = title//nl//'derivatives per '//per//' of input and per second at input speed '//full_precision(speed)// &
              ', acceleration '//full_precision(accel)//'; angles in degrees, their derivatives in radians'
      if (present(forces)) notes = notes//nl//'drive, forces and couples of joints in newtons and newton metres; frame moment '// &
                                   'about the machine origin'
      table = table_of(positions_block, about_positions, notes=notes, named=.false., main=.true., &
                       audience=merge(for_all, for_plots, for_others))
      call add_motion(problem, rates%motion, table)
      if (.not. problem%mechanism%outputs(1)%stands_in) then
         call add_derivatives(rates%by_input, per)
         call add_derivatives(rates%by_time, per_time())
      end if
      if (present(forces)) call add_forces(forces, table)
      call add_crank(rates%motion, table)
      call tables%put(table)

   contains

      subroutine add_derivatives(values, by)
         real(wp), intent(in) :: values(:, :, :)   !! shape (orders, components, positions)
         character(*), intent(in) :: by
         character(:), allocatable :: name
         integer :: order, c

         associate (kind => problem%output%kind)
            do order = 1, highest_order
               do c = 1, kind%components
                  name = by_input(output_name(kind, c), order)
                  if (by == per_time()) name = by_time(output_name(kind, c), order)
                  call table%add(name, values(order, c, :), rate_unit(c == kind%angle, by, order), &
                                 rates%motion%closed .and. rates%dead == 0, plotted_rate(plotted_component(kind, c), by, order))
               end do
            end do
         end associate
      end subroutine add_derivatives
   end subroutine put_rates

   ! ---- a sketch ----------------------------------------------------------------------------------------------------

   !> The table of a sketch: inputs, closed, outputs, joints. With `orders` above 0 outputs have `.v` and `.a`, joints
   !> `.vx .vy .ax .ay`. What does not close is not known.
   pure subroutine put_sketch(sketch, study, orders, tables, forces, problem)
      type(sketch_t), intent(in) :: sketch
      type(sketch_study_t), intent(in) :: study
      integer, intent(in) :: orders                  !! 0 or 2
      type(tables_t), intent(inout) :: tables
      type(force_study_t), intent(in), optional :: forces
      type(problem_t), intent(in), optional :: problem !! of the study: its desired values are columns, too
      type(table_t) :: table
      logical :: known(size(study%closed), 0:2)
      integer :: d

      table = table_of(positions_block, about_positions, audience=for_programs, main=.true.)
      known(:, 0) = study%closed
      known(:, 1) = study%closed .and. .not. study%dead
      known(:, 2) = known(:, 1)
      do d = 1, size(study%inputs, 1)
         call table%add(input_name(sketch, d), study%inputs(d, :), drive_unit(sketch, d))
      end do
      call table%add(closed_name, study%closed)
      call add_outputs(sketch, study, orders, known, table)
      if (present(problem)) call add_targets(sketch, study, problem, table)
      call add_conditions(sketch, study, table)
      call add_joints(sketch, study, orders, known, table)
      if (present(forces)) call add_forces(forces, table, study%closed)
      if (size(study%crank) > 0) call table%add(crank_name(sketch), study%crank, output_unit(.true.))
      call tables%put(table)
   end subroutine put_sketch

   !> Outputs of a sketch, with `.v` and `.a`.
   pure subroutine add_outputs(sketch, study, orders, known, table)
      type(sketch_t), intent(in) :: sketch
      type(sketch_study_t), intent(in) :: study
      integer, intent(in) :: orders                  !! 0 or 2
      logical, intent(in) :: known(:, 0:)            !! shape (rows, 0:orders)
      type(table_t), intent(inout) :: table
      integer :: n, o

      do n = 1, size(study%names)
         do o = 0, orders
            call table%add(by_time(study%names(n), o), study%values(n, o, :), &
                           number_unit(sketch%outputs, n, per_time(), o), known(:, o))
         end do
      end do
   end subroutine add_outputs

   !> Joints of a sketch, with `.vx .vy .ax .ay`.
   pure subroutine add_joints(sketch, study, orders, known, table)
      type(sketch_t), intent(in) :: sketch
      type(sketch_study_t), intent(in) :: study
      integer, intent(in) :: orders                  !! 0 or 2
      logical, intent(in) :: known(:, 0:)            !! shape (rows, 0:orders)
      type(table_t), intent(inout) :: table
      character(:), allocatable :: unit
      integer :: j, o

      do j = 1, size(study%joints, 1)
         do o = 0, orders
            unit = rate_unit(.false., per_time(), o)
            call table%add(joint_name(sketch%joint_name(j), o, 'x'), real(study%joints(j, o, :), wp), unit, known(:, o))
            call table%add(joint_name(sketch%joint_name(j), o, 'y'), aimag(study%joints(j, o, :)), unit, known(:, o))
         end do
      end do
   end subroutine add_joints

   !> Desired values of the outputs of a sketch; of derivatives by the input the actual ones, too. Without outputs they are those of
   !> the joint that is shown. Values are given for every position, whatever their weights; of derivatives those without a weight
   !> are not.
   pure subroutine add_targets(sketch, study, problem, table)
      type(sketch_t), intent(in) :: sketch
      type(sketch_study_t), intent(in) :: study      !! at a speed of 1, without acceleration
      type(problem_t), intent(in) :: problem
      type(table_t), intent(inout) :: table
      type(target_column_t), allocatable :: columns(:)
      integer :: k, c, order
      logical :: every(problem%positions)

      every = .true.
      if (problem%desired) then
         do c = 1, problem%output%kind%components
            call add(table, c, 0, problem%wanted(:problem%positions, c), every)
         end do
         if (allocated(problem%rate_desired)) then
            do order = 1, most_rates
               do c = 1, problem%output%kind%components
                  if (any(problem%rate_weight(:, c, order) > 0.0_wp)) &
                     call add(table, c, order, problem%rate_desired(:, c, order), problem%rate_weight(:, c, order) > 0.0_wp)
               end do
            end do
         end if
      end if
      if (.not. allocated(problem%target_values)) return
      columns = sketch%target_columns()
      do k = 1, size(columns)
         associate (at => columns(k))
            call add(table, first_number(sketch%outputs, at%output) + at%component - 1, at%order, problem%target_values(:, k), &
                     merge(every, problem%target_weights(:, k) > 0.0_wp, at%order == 0))
         end associate
      end do

   contains

      pure subroutine add(into, number, of_order, values, known)
         type(table_t), intent(inout) :: into
         integer, intent(in) :: number, of_order
         real(wp), intent(in) :: values(:)           !! shape (positions)
         logical, intent(in) :: known(:)
         character(:), allocatable :: name, unit, per
         real(wp) :: actual(size(values))
         integer :: joint

         per = per_input(problem%mechanism%sliding_input)
         if (size(sketch%outputs) > 0) then
            name = by_input(study%names(number), of_order)
            unit = number_unit(sketch%outputs, number, per, of_order)
            actual = study%values(number, of_order, :)
         else
            joint = sketch%shown_joint()
            name = by_input(joint_name(sketch%joint_name(joint), 0, axes(number)), of_order)
            unit = rate_unit(.false., per, of_order)
            actual = merge(study%joints(joint, of_order, :)%re, study%joints(joint, of_order, :)%im, number == 1)
         end if
         if (of_order > 0) call into%add(name, actual, unit, study%closed .and. .not. study%dead)
         call into%add(target_name(name), values, unit, known)
      end subroutine add
   end subroutine add_targets

   !> Blocks of device 9: all outputs of a sketch, whose first one alone is in the table before; with rates of several drives the
   !> change of every output with each of them, the others held.
   pure subroutine plot_sketch(block, sketch, study, orders, tables)
      character(*), intent(in) :: block              !! `outputs`, or `swept_outputs`: at every position of a sweep
      type(sketch_t), intent(in) :: sketch
      type(sketch_study_t), intent(in) :: study
      integer, intent(in) :: orders                  !! 2 with rates, else 0
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: n, o, d, k

      associate (numbers => [(k, k=1, size(study%closed))])
         table = table_of(block, about_positions, audience=for_plots)
         if (block /= 'outputs') table = table_of(block, 'a row for each position of the block before it')
         call table%add(position_name, numbers)
         do n = 1, size(study%names)
            do o = 0, orders
               call table%add(by_time(study%names(n), o), study%values(n, o, :), &
                              number_unit(sketch%outputs, n, per_time(), o), study%closed .and. .not. (o > 0 .and. study%dead))
            end do
         end do
         call add_conditions(sketch, study, table)
         call tables%put(table)
         if (orders == 0 .or. size(study%inputs, 1) == 1) return
         table = table_of('drives', 'a row for each prescribed position: the change of outputs with a drive, the others held')
         call table%add(position_name, numbers)
         do n = 1, size(study%names)
            do d = 1, size(study%by_drive, 2)
               call table%add(trim(study%names(n))//'/'//input_name(sketch, d), study%by_drive(n, d, :), &
                              number_unit(sketch%outputs, n, drive_unit(sketch, d, by=.true.), 1), &
                              study%closed .and. .not. study%dead)
            end do
         end do
         call tables%put(table)
      end associate
   end subroutine plot_sketch

   !> Condition numbers of all outputs, if they were asked for.
   pure subroutine add_conditions(sketch, study, table)
      type(sketch_t), intent(in) :: sketch
      type(sketch_study_t), intent(in) :: study
      type(table_t), intent(inout) :: table
      integer :: k

      if (.not. allocated(study%conditions)) return
      do k = 1, size(sketch%outputs)
         call table%add(trim(sketch%outputs(k)%name)//'.'//condition_name, study%conditions(k, :), known=study%closed)
      end do
   end subroutine add_conditions
end module psalm_position_table
