!> Tables of what a linkage does over the range of its input, of what it violates, of its dimensions and
!> arcs, and of how a search for it went; for other programs.
module psalm_summary_table
   use psalm_analysis, only: arc_table_t
   use psalm_column_names, only: closed_name, input_name, input_unit, output_unit, per_input, per_time, position_name, &
                                 rate_unit
   use psalm_dyad, only: violation_too_short, violation_too_long, violation_parallel, violation_angle_small, &
                         violation_angle_large, violation_undetermined, violation_slides
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_markup, only: strings_t
   use psalm_mechanism, only: mechanism_t
   use psalm_output_kind, only: motion_angle, motion_point, most_rates
   use psalm_part_columns, only: add_groups, add_lines, add_words
   use psalm_rate_study, only: rate_study_t
   use psalm_search, only: result_t
   use psalm_sketch_study, only: sketch_study_t
   use psalm_summary, only: summary_t, range_t
   use psalm_summary_text, only: name_of_kind
   use psalm_simplex_search, only: simplex_run_t
   use psalm_solver, only: search_state_t
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   implicit none (type, external)
   private
   public :: put_summary, put_output_ranges, put_desired_errors, put_violations, put_dimensions, put_arcs, put_arc_rates, &
             put_simplex, put_simplexes, put_starts

   integer, parameter :: name_length = 48  !! characters of a word in a table

contains

   ! ---- the range of the input --------------------------------------------------------------------------------------

   !> Tables summary, closing, reversals, loop_kinds, and of wanted derivatives rate_errors.
   pure subroutine put_summary(mechanism, summary, motion, stands_in, tables)
      type(mechanism_t), intent(in) :: mechanism
      type(summary_t), intent(in) :: summary
      type(motion_t), intent(in) :: motion         !! at the prescribed positions
      logical, intent(in) :: stands_in             !! the output is that of a joint that stands in for it: it is not reported
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(:), allocatable :: of_input, of_output

      of_input = input_unit(summary%sliding_input)
      of_output = output_unit(summary%motion == motion_angle)
      table = table_of('summary', 'one row: what the linkage does over the range of its input, by a search', &
                       audience=for_programs)
      associate (swept => .not. summary%at_positions)
         call table%add('positions', [size(motion%input)])
         call table%add(closed_name, [count(motion%closed)])
         call table%add('closes_everywhere', [summary%everywhere], known=[swept])
         ! true: what the output depends on closes where other loops do not
         call table%add('others_open', [summary%others_open], known=[swept])
         associate (known => [summary%partial])
            call table%add('prescribed_only', known)
            call table%add('from', [summary%prescribed%low], of_input, known)
            call table%add('to', [summary%prescribed%high], of_input, known)
         end associate
         associate (known => [summary%undetermined_loop > 0])
            call table%add('undetermined_loop', [summary%undetermined_loop], known=known)
            call table%add('undetermined_from', [summary%undetermined%low], of_input, known)
            call table%add('undetermined_to', [summary%undetermined%high], of_input, known)
         end associate
         ! of several drives what follows was found at a position, not at an input
         associate (known => [summary%angle_loop > 0])
            call table%add('transmission_angle', [summary%angle], 'deg', known)
            call table%add('transmission_loop', [summary%angle_loop], known=known)
            call table%add('transmission_at', [summary%angle_input], of_input, known .and. swept)
            call table%add('transmission_position', [nint(summary%angle_input)], known=known .and. .not. swept)
            call table%add('transmission_asked', [summary%least_asked], 'deg', [summary%least_asked > 0.0_wp])
         end associate
         associate (known => [summary%group_loop > 0])
            call table%add('group_measure', [summary%group_measure], known=known)
            call table%add('group_loop', [summary%group_loop], known=known)
            call table%add('group_at', [summary%group_input], of_input, known .and. swept)
            call table%add('group_position', [nint(summary%group_input)], known=known .and. .not. swept)
         end associate
      end associate
      if (.not. stands_in) call add_output(summary, of_output, table)
      associate (known => [summary%compared > 0])
         call table%add('compared', [summary%compared])
         call table%add('error_rms', [summary%rms], trim(summary%error_unit), known)
         call table%add('error_largest', [summary%largest], trim(summary%error_unit), known)
         call table%add('error_largest_position', [summary%worst], known=known)
         call table%add('error_largest_at', [summary%worst_input], of_input, known)
      end associate
      call tables%put(table)
      call put_ranges('closing', 'a row for each range of inputs over which the linkage closes', summary%closing, of_input, tables)
      if (.not. stands_in) then
         table = table_of('reversals', 'a row for each input at which the output reverses', audience=for_programs)
         call table%add(input_name(), summary%reverses, of_input)
         call tables%put(table)
      end if
      call put_kinds(mechanism, summary, tables)
      call put_rate_errors(summary, tables)
   end subroutine put_summary

   !> Range of the output.
   pure subroutine add_output(summary, unit, table)
      type(summary_t), intent(in) :: summary
      character(*), intent(in) :: unit
      type(table_t), intent(inout) :: table
      logical :: known(1), plane(1)

      known = size(summary%closing) > 0 .and. .not. (summary%at_positions .or. summary%unbounded)
      plane = known .and. summary%motion == motion_point
      call table%add('output_unbounded', [summary%unbounded])
      call table%add('output_turns', [summary%turns])
      call table%add('output_least', [summary%output%low], unit, known .and. .not. summary%turns)
      call table%add('output_most', [summary%output%high], unit, known .and. .not. summary%turns)
      call table%add('output_y_least', [summary%output_y%low], unit, plane)
      call table%add('output_y_most', [summary%output_y%high], unit, plane)
   end subroutine add_output

   pure subroutine put_ranges(block, about, ranges, unit, tables)
      character(*), intent(in) :: block, about, unit
      type(range_t), intent(in) :: ranges(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of(block, about, audience=for_programs)
      call table%add('from', ranges%low, unit)
      call table%add('to', ranges%high, unit)
      call tables%put(table)
   end subroutine put_ranges

   !> What the loops are by the rule of Grashof.
   pure subroutine put_kinds(mechanism, summary, tables)
      type(mechanism_t), intent(in) :: mechanism
      type(summary_t), intent(in) :: summary
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: names(:)
      integer :: i

      allocate (names(size(summary%kinds)))
      do i = 1, size(names)
         names(i) = name_of_kind(summary%kinds(i)%kind)
      end do
      table = table_of('loop_kinds', 'a row for each loop that is a four-bar or a slider-crank', audience=for_programs)
      call table%add('loop', summary%kinds%loop)
      call table%add('kind', names)
      call add_groups(mechanism, summary%kinds%loop, table)
      call tables%put(table)
   end subroutine put_kinds

   !> Errors of the derivatives that are wanted.
   pure subroutine put_rate_errors(summary, tables)
      type(summary_t), intent(in) :: summary
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length) :: units(most_rates)
      integer, allocatable :: there(:)
      integer :: order

      if (all(summary%rates%compared == 0)) return
      do order = 1, most_rates
         units(order) = rate_unit(summary%motion == motion_angle .or. summary%rates(order)%of_angle, &
                                  per_input(summary%sliding_input), order)
      end do
      table = table_of('rate_errors', 'a row for each order of the derivatives that are wanted', audience=for_programs)
      there = pack([(order, order=1, most_rates)], summary%rates%compared > 0)
      call table%add('order', there)
      call table%add('compared', summary%rates(there)%compared)
      call table%add('rms', summary%rates(there)%rms)
      call table%add('largest', summary%rates(there)%largest)
      call table%add('largest_position', summary%rates(there)%worst)
      call table%add('unit', units(there))
      call tables%put(table)
   end subroutine put_rate_errors

   !> Table desired_errors: of each output with desired values.
   pure subroutine put_desired_errors(summary, tables)
      type(summary_t), intent(in) :: summary
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: names(:)
      integer :: k

      if (.not. allocated(summary%targets)) return
      associate (of => summary%targets)
         allocate (names(size(of)))
         do k = 1, size(of)
            names(k) = of(k)%name
         end do
         table = table_of('desired_errors', 'a row for each output with desired values', audience=for_programs)
         call table%add('output', names)
         call table%add('compared', of%compared)
         call table%add('rms', of%rms, known=of%compared > 0)
         call table%add('largest', of%largest, known=of%compared > 0)
         call table%add('largest_position', of%worst, known=of%compared > 0)
         call table%add('largest_at', of%worst_input, input_unit(summary%sliding_input), of%compared > 0)
         call table%add('unit', of%unit)
      end associate
      call tables%put(table)
   end subroutine put_desired_errors

   !> Table output_ranges: the least and the greatest value of every number of a sketch's outputs at the positions.
   pure subroutine put_output_ranges(study, tables)
      type(sketch_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      real(wp) :: least(size(study%names)), most(size(study%names))
      integer :: n

      do n = 1, size(study%names)
         call study%find_range(n, least(n), most(n))
      end do
      table = table_of('output_ranges', 'a row for each number of the outputs, over the positions; units as of these', &
                       audience=for_programs)
      call table%add('output', study%names)
      call table%add('least', least, known=least <= most)
      call table%add('most', most, known=least <= most)
      call tables%put(table)
   end subroutine put_output_ranges

   ! ---- the positions -----------------------------------------------------------------------------------------------

   !> Tables violations and crossings: limits of closure and transmission that are not kept, and slides that were parallel between
   !> two positions.
   pure subroutine put_violations(problem, motion, tables)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: words(:)
      logical, allocatable :: angle(:), length(:)
      integer :: i

      associate (of => motion%violations)
         allocate (words(size(of)), angle(size(of)), length(size(of)))
         do i = 1, size(of)
            words(i) = violation_name(problem, of(i)%kind, of(i)%loop)
            angle(i) = any(of(i)%kind == [violation_angle_small, violation_angle_large, violation_slides])
            length(i) = .not. (angle(i) .or. any(of(i)%kind == [violation_parallel, violation_undetermined])) .and. &
                        problem%mechanism%is_dyad(of(i)%loop)
         end do
         table = table_of('violations', 'a row for each loop and limit that is not kept, the amount where it is worst', &
                          audience=for_programs)
         call table%add('loop', of%loop)
         call table%add('violation', words)
         call table%add('first', of%first)
         call table%add('last', of%last)
         call table%add('worst', of%worst)
         call table%add('length', of%amount, 'length', length)
         call table%add('angle', of%amount, 'deg', angle)
         call add_groups(problem%mechanism, of%loop, table)
         call tables%put(table)
      end associate
      if (size(motion%crossings) == 0) return
      table = table_of('crossings', 'a row for each position after which two slides are parallel before the next', &
                       audience=for_programs)
      call table%add('loop', motion%crossings%loop)
      call table%add(position_name, motion%crossings%position)
      call add_groups(problem%mechanism, motion%crossings%loop, table)
      call tables%put(table)
   end subroutine put_violations

   pure function violation_name(problem, kind, loop) result(name)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: kind, loop
      character(:), allocatable :: name

      if (.not. problem%mechanism%is_dyad(loop)) then
         name = 'does not follow from the drawing'
         return
      end if
      select case (kind)
      case (violation_too_short)
         name = 'links too short'
      case (violation_too_long)
         name = 'links too long'
      case (violation_undetermined)
         name = 'outer joints coincide'
      case (violation_parallel)
         name = 'slides parallel'
      case (violation_angle_small, violation_angle_large)
         name = 'transmission angle'
      case (violation_slides)
         name = 'angle between slides'
      case default
         name = 'closes with too little to spare'
      end select
   end function violation_name

   !> Table dimensions: the linkage that the tables are about, at the reference position.
   pure subroutine put_dimensions(mechanism, dimensions, tables)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of('dimensions', 'a row for each arc of the linkage: its length, its angle where that is given', &
                       audience=for_programs)
      call table%add('loop', mechanism%arcs%loop)
      call table%add('arc', mechanism%arcs%place)
      call table%add('length', dimensions%arcl, 'length')
      call table%add('angle', dimensions%gama, 'deg')
      call add_lines(mechanism, mechanism%arcs%loop, mechanism%arcs%place, table)
      call tables%put(table)
   end subroutine put_dimensions

   !> Table arcs: length and angle of every arc at every position; those of loops that do not close are not known.
   pure subroutine put_arcs(mechanism, motion, arcs, condition, tables)
      type(mechanism_t), intent(in) :: mechanism
      type(motion_t), intent(in) :: motion
      type(arc_table_t), intent(in) :: arcs
      real(wp), intent(in) :: condition(:)    !! shape (positions)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      logical, allocatable :: known(:, :)
      integer :: k, n

      allocate (known(size(mechanism%arcs), size(motion%input)), source=.true.)
      do k = 1, size(motion%input)
         if (arcs%open(k) > 0) known(:, k) = mechanism%arcs%loop < arcs%open(k)
      end do
      table = table_of('arcs', 'a row for each position and arc', audience=for_programs)
      call add_places(mechanism, motion%input, [(n, n=1, size(mechanism%arcs))], table)
      call table%add('condition', [(spread(condition(k), 1, size(known, 1)), k=1, size(condition))])
      call add_column('length', arcs%length, 'length', known, table)
      call add_column('angle', arcs%angle, 'deg', known, table)
      call add_lines(mechanism, mechanism%arcs%loop, mechanism%arcs%place, table, size(motion%input))
      call tables%put(table)
   end subroutine put_arcs

   !> Tables arcs and arc_joints: every arc and every joint at every position with velocity and acceleration.
   pure subroutine put_arc_rates(mechanism, rates, tables)
      type(mechanism_t), intent(in) :: mechanism
      type(rate_study_t), intent(in) :: rates     !! with arcs
      type(tables_t), intent(inout) :: tables
      character(*), parameter :: of_time(0:2) = [character(2) :: '', '.v', '.a'], of_joint(0:2) = [character(1) :: '', 'v', 'a']
      type(table_t) :: table
      type(strings_t), allocatable :: joints(:)   ! names
      logical, allocatable :: known(:)
      real(wp) :: scale
      integer :: n, order

      known = rates%motion%closed .and. rates%dead == 0
      associate (arcs => rates%arcs)
         table = table_of('arcs', 'a row for each position and arc, rates by time', audience=for_programs)
         call add_places(mechanism, rates%motion%input, [(n, n=1, size(mechanism%arcs))], table)
         do order = 0, 2
            call add_column('length'//trim(of_time(order)), arcs%length(order, :, :), rate_unit(.false., per_time(), order), &
                            spread(known, 1, size(mechanism%arcs)), table)
         end do
         do order = 0, 2
            scale = merge(degrees_per_radian, 1.0_wp, order == 0)
            call add_column('angle'//trim(of_time(order)), scale*arcs%angle(order, :, :), rate_unit(.true., per_time(), order), &
                            spread(known, 1, size(mechanism%arcs)), table)
         end do
         call add_lines(mechanism, mechanism%arcs%loop, mechanism%arcs%place, table, size(known))
         call tables%put(table)
         table = table_of('arc_joints', 'a row for each position and joint at the finish of an arc, rates by time', &
                          audience=for_programs)
         call add_places(mechanism, rates%motion%input, arcs%joint_arc, table)
         do order = 0, 2
            call add_column(trim(of_joint(order))//'x', arcs%x(order, :, :), rate_unit(.false., per_time(), order), &
                            spread(known, 1, size(arcs%joint_arc)), table)
            call add_column(trim(of_joint(order))//'y', arcs%y(order, :, :), rate_unit(.false., per_time(), order), &
                            spread(known, 1, size(arcs%joint_arc)), table)
         end do
         if (mechanism%has_joint_names()) then
            allocate (joints(size(arcs%joint_arc)))
            do n = 1, size(joints)
               joints(n)%text = trim(mechanism%ends(arcs%joint_end(n), arcs%joint_arc(n)))
            end do
            call add_words('joint', joints, table, size(known))
         end if
         call tables%put(table)
      end associate
   end subroutine put_arc_rates

   !> Columns that say which position and which arc a row is about: the arcs run faster.
   pure subroutine add_places(mechanism, inputs, arcs, table)
      type(mechanism_t), intent(in) :: mechanism
      real(wp), intent(in) :: inputs(:)      !! shape (positions)
      integer, intent(in) :: arcs(:)         !! sequential numbers
      type(table_t), intent(inout) :: table
      integer :: k, n

      associate (many => size(arcs), positions => size(inputs))
         call table%add(position_name, [((k, n=1, many), k=1, positions)])
         call table%add(input_name(), [((inputs(k), n=1, many), k=1, positions)], input_unit(mechanism%sliding_input))
         call table%add('loop', [((mechanism%arcs(arcs(n))%loop, n=1, many), k=1, positions)])
         call table%add('arc', [((mechanism%arcs(arcs(n))%place, n=1, many), k=1, positions)])
      end associate
   end subroutine add_places

   pure subroutine add_column(name, values, unit, known, table)
      character(*), intent(in) :: name, unit
      real(wp), intent(in) :: values(:, :)   !! shape (arcs, positions)
      logical, intent(in) :: known(:, :)     !! the same shape
      type(table_t), intent(inout) :: table

      call table%add(name, reshape(values, [size(values)]), unit, reshape(known, [size(known)]))
   end subroutine add_column

   ! ---- searches ----------------------------------------------------------------------------------------------------

   !> Table search: how a search by the simplex went.
   pure subroutine put_simplex(state, ending, tables)
      type(search_state_t), intent(in) :: state
      character(*), intent(in) :: ending         !! how it ended, in words
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of('search', 'one row: how the search by the simplex went', audience=for_programs)
      call table%add('ending', [ending])
      call table%add('objective', [state%best])
      call add_simplexes([state], table)
      call tables%put(table)
   end subroutine put_simplex

   !> Table simplexes: how each of several simplexes went.
   pure subroutine put_simplexes(runs, tables)
      type(simplex_run_t), intent(in) :: runs(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of('simplexes', 'a row for each simplex of the search', audience=for_programs)
      call table%add('start', runs%number)
      call table%add('random_integer', runs%integer)
      call table%add('objective', runs%state%best, known=runs%feasible)
      call table%add('converged', runs%has_settled())
      call add_simplexes(runs%state, table)
      call tables%put(table)
   end subroutine put_simplexes

   !> What simplexes took.
   pure subroutine add_simplexes(states, table)
      type(search_state_t), intent(in) :: states(:)
      type(table_t), intent(inout) :: table

      call table%add('iterations', states%iteration)
      call table%add('evaluations', states%evaluations)
      call table%add('violations', states%counts%calls)
      call table%add('repairs', states%counts%repairs)
      call table%add('moves', states%counts%moves)
   end subroutine add_simplexes

   !> Table search: how a search from many starts went.
   pure subroutine put_starts(found, tables)
      type(result_t), intent(in) :: found
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      real(wp) :: best

      best = huge(1.0_wp)            ! not known
      if (size(found%best) > 0) best = found%best(1)%objective
      table = table_of('search', 'one row: how the search from many starts went', audience=for_programs)
      call table%add('objective', [best])
      call table%add('starts', [found%starts])
      call table%add('feasible', [found%feasible])
      call table%add('evaluations', [found%evaluations])
      call table%add('jacobians', [found%jacobians])
      call table%add('out_of_time', [found%out_of_time])
      call table%add('interrupted', [found%interrupted])
      call table%add('refused', [found%refused])
      call tables%put(table)
   end subroutine put_starts
end module psalm_summary_table
