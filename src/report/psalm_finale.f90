!> FINALE writes the listing of the final linkage and its motion, device 6.
!>
!> Layout and numbers follow the published listing (Oldham 1977, figure 7.2), so that listings can be compared. A line of its own
!> begins what that listing does not have.
module psalm_finale
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_columns, only: left_column
   use psalm_data_set, only: data_set_t
   use psalm_dyad, only: violation_too_short, violation_too_long, violation_parallel, violation_angle_small, &
                         violation_angle_large, violation_undetermined, violation_slides, violation_toggle
   use psalm_dyad_kind, only: assur_rpr, assur_rpr_guide_first, form_of, form_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, motion_t, violation_t, crossing_t, new_problem
   use psalm_group_words, only: group_heading, group_words
   use psalm_input_text, only: angle_text, crank_heading, input_heading, input_text, list_sketch_notes
   use psalm_loop_arrays, only: loop_arrays_t, arrays_of
   use psalm_kinds, only: wp, right_angle, half_turn, degrees_per_radian
   use psalm_markup, only: strings_t, add_string
   use psalm_number_format, only: number_format_t, format_of, figure, figures_of, in_a_row, number_in_sentence => in_sentence, &
                                  rounding_error
   use psalm_output_kind, only: motion_point, motion_angle, motion_distance, motion_pose, most_rates
   use psalm_parameters, only: no_parameters, variable_aside, variable_aside_angle, variable_outlk, variable_outang
   use psalm_plan, only: root_crank, root_frame
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t, arc_link
   use psalm_text, only: text_t, cased, fixed, to_text
   implicit none (type, external)
   private
   public :: list_results, arc_table, in_columns, list_reference, list_output_arc, describe_violation, &
             describe_crossing, mark_beyond, open_words

   character(*), parameter :: beyond_line = ' *** BEYOND THE PUBLISHED LISTING ***'
   integer, parameter :: column = 10   !! width of a dimension
   integer, parameter :: name_columns = 30 !! of the name of a dimension of a sketch

contains

   !> Append the whole listing. `problem` is bound to `dimensions`. What else belongs to the case may be added before `mark_beyond`.
   subroutine list_results(set, problem, dimensions, motion, text, published, condition)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(in) :: motion
      type(text_t), intent(inout) :: text
      integer, intent(out) :: published      !! length of `text` up to where the published listing ends
      real(wp), intent(in), optional :: condition(:) !! shape (positions): numbers of the first output; then digits of a sketch
                                             !! that rounding leaves open are blank

      call text%add(' '//set%title)
      call text%add()
      call list_sketch_notes(set, text)
      if (problem%mechanism%has_joint_names()) then
         call list_by_joints(problem, dimensions, text)
      else
         call list_by_arcs(set, problem, dimensions, text)
      end if
      call list_motion(problem, motion, text, condition)
      published = text%length
      if (allocated(motion%rates)) call list_desired_rates(problem, motion, text)
      call list_violations(problem, motion, text)
   end subroutine list_results

   !> Dimensions of a linkage of loops, as the published listing has them.
   subroutine list_by_arcs(set, problem, dimensions, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(text_t), intent(inout) :: text

      call list_dimensions(set, problem%mechanism, dimensions, text)
      call list_reference(problem%mechanism, dimensions%crnki, text)
      call text%add(' POLAR CO-ORDINATES (LENGTH, ANGLE) OF')
      call text%add(' INPUT PIVOT '//fixed(dimensions%origlk, column, 3)//fixed(dimensions%origng, column, 4, tie_away=.true.))
      call text%add(' OUTPUT LINK '//fixed(dimensions%outlk, column, 3)//fixed(dimensions%outang, column, 4, tie_away=.true.))
      call list_output_arc(arrays_of(set), text)
      call list_cartesian(set, problem, dimensions, text)
   end subroutine list_by_arcs

   !> Dimensions of a sketch by the names of its joints: lengths, each once, and angles of lines that are not found from others.
   subroutine list_by_joints(problem, dimensions, text)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(text_t), intent(inout) :: text
      type(strings_t), allocatable :: names(:)
      real(wp), allocatable :: values(:)
      type(number_format_t) :: format
      real(wp) :: c, s
      integer :: n

      associate (mechanism => problem%mechanism)
         call text%add(' LENGTHS BETWEEN JOINTS')
         allocate (names(0), values(0))
         do n = 1, size(mechanism%arcs)
            if (mechanism%slides(n) .or. .not. abs(dimensions%arcl(n)) > 0.0_wp) cycle
            call take(mechanism%length_called(n), dimensions%arcl(n))
         end do
         if (abs(dimensions%outlk) > 0.0_wp .and. shows_output_link(problem) .and. len_trim(mechanism%outputs(1)%line(1)) > 0) &
            call take(mechanism%length_called(0), dimensions%outlk)
         call take_aside(variable_aside)
         call add_rows()
         call text%add(' ANGLES, DEGREES: OF A LINE FROM THE X AXIS, OR OF THE SECOND LINE FROM THE FIRST')
         deallocate (names, values)
         allocate (names(0), values(0))
         do n = 1, size(mechanism%arcs)
            if (is_phase(n)) then
               call take(mechanism%angle_called(n), direction_at_reference(mechanism, dimensions, n))
               cycle
            end if
            if (is_found(n)) cycle
            if (follows(n)) cycle
            call take(mechanism%angle_called(n), dimensions%gama(n))
         end do
         if (shows_output_angle()) call take(mechanism%angle_called(0), dimensions%outang)
         call take_aside(variable_aside_angle)
         call add_rows()
         call list_reference(mechanism, dimensions%crnki, text)
         call unit_vector(dimensions%origng, c, s)
         call text%add(' ITS PIVOT (X,Y)')
         format = format_of(.true., dimensions%origlk*[c, s])
         call text%add(figure(dimensions%origlk*c, format)//figure(dimensions%origlk*s, format))
      end associate

   contains

      !> True if the direction of an arc follows from the motion: of the crank, of dyads, of larger groups.
      pure logical function is_found(n)
         integer, intent(in) :: n

         associate (arc => problem%mechanism%arcs(n))
            is_found = arc%dyad /= 0 .or. problem%plan%root(n) == root_crank
         end associate
      end function is_found

      !> True if a search may choose how a wheel stands to the one that it is in gear with, and the arc shows it.
      pure logical function is_phase(n)
         integer, intent(in) :: n

         is_phase = problem%mechanism%arcs(n)%kind == arc_link .and. problem%parameters%angle_variable(n) > 0
      end function is_phase

      !> True if an arc has no direction of its own: it is one joint, it lies along the one that it hangs on, or it is the same line
      !> of two joints back again.
      pure logical function follows(n)
         integer, intent(in) :: n

         associate (arcs => problem%mechanism%arcs, ends => problem%mechanism%ends)
            follows = problem%mechanism%is_one_joint(n)
            if (follows .or. arcs(n)%reference == 0) return
            follows = abs(dimensions%gama(n)) <= 0.0_wp
            if (all(ends(:, n) == ends([2, 1], arcs(n)%reference))) follows = abs(dimensions%gama(n) - half_turn) <= 0.0_wp
         end associate
      end function follows

      !> True if the direction of the output is a dimension: to its point, or of a line that is not that of the arc it turns with.
      pure logical function shows_output_angle()
         associate (output => problem%mechanism%outputs(1), ends => problem%mechanism%ends)
            shows_output_angle = shows_output_link(problem) .and. len_trim(output%line(1)) > 0
            if (.not. shows_output_angle .or. output%arc == 0 .or. abs(dimensions%outlk) > 0.0_wp) return
            shows_output_angle = .not. (all(ends(:, output%arc) == output%line) .or. all(ends([2, 1], output%arc) == output%line))
         end associate
      end function shows_output_angle

      !> A name and its value; a name that was there is skipped.
      subroutine take(name, value)
         character(*), intent(in) :: name
         real(wp), intent(in) :: value
         integer :: k

         do k = 1, size(names)
            if (names(k)%text == name) return
         end do
         call add_string(names, name)
         values = [values, value]
      end subroutine take

      !> What varies of joints off the arcs.
      subroutine take_aside(kind)
         integer, intent(in) :: kind
         integer :: v

         do v = 1, size(problem%parameters%variables)
            associate (variable => problem%parameters%variables(v))
               if (variable%kind /= kind) cycle
               call take(trim(variable%of), merge(dimensions%aside_length(variable%n), dimensions%aside_angle(variable%n), &
                                                  kind == variable_aside))
            end associate
         end do
      end subroutine take_aside

      subroutine add_rows()
         integer :: k

         format = format_of(.true., values)
         do k = 1, size(names)
            call text%add('  '//left_column(names(k)%text, name_columns)//figure(values(k), format))
         end do
      end subroutine add_rows
   end subroutine list_by_joints

   !> Direction of an arc at the reference input, degrees.
   real(wp) function direction_at_reference(mechanism, dimensions, arc) result(direction)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: arc
      class(problem_t), allocatable :: problem      ! large: it would fill a small stack
      real(wp) :: x, y, length
      integer :: offset, n

      allocate (problem)
      call new_problem(mechanism, dimensions, no_parameters(mechanism), [0.0_wp], .true., problem)
      call problem%bind(dimensions)
      call problem%solve_block(1, offset, n)
      call problem%linkage%arc_at(problem%plan, arc, 1, x, y, length)
      direction = degrees_of(x, y)
   end function direction_at_reference

   !> True if the output link is that of the output, or its dimensions vary.
   pure logical function shows_output_link(problem)
      type(problem_t), intent(in) :: problem

      shows_output_link = .not. problem%mechanism%outputs(1)%stands_in
      if (shows_output_link) return
      associate (kinds => problem%parameters%variables%kind)
         shows_output_link = any(kinds == variable_outlk .or. kinds == variable_outang)
      end associate
   end function shows_output_link

   !> Insert the line that begins what the published listing does not have, if there is any.
   pure subroutine mark_beyond(published, text)
      integer, intent(in) :: published       !! of `list_results`
      type(text_t), intent(inout) :: text
      character(:), allocatable :: whole

      if (text%length == published) return
      whole = text%content()
      text%length = published
      call text%add(beyond_line)
      call text%add_text(whole(published + 1:))
   end subroutine mark_beyond

   !> Lengths and angles of every arc of the results.
   subroutine list_dimensions(set, mechanism, dimensions, text)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(text_t), intent(inout) :: text
      type(loop_arrays_t) :: arrays

      arrays = arrays_of(set)
      call text%add(' ARRAY OF ARC LENGTHS, ARCL')
      call column_heads('L', arrays%maxarc, text)
      call arc_table(in_columns(mechanism, dimensions%arcl, arrays%arcl), .false., text)
      call text%add(' ARRAY OF ARC ANGLES, GAMA')
      call column_heads('G', arrays%maxarc, text)
      call arc_table(in_columns(mechanism, dimensions%gama, arrays%gama), .true., text)
   end subroutine list_dimensions

   !> Values of arcs in the columns of the user's arrays; what belongs to no arc is as written. Shape: that of `written`.
   pure function in_columns(mechanism, values, written) result(table)
      type(mechanism_t), intent(in) :: mechanism
      real(wp), intent(in) :: values(:)       !! by arc
      real(wp), intent(in) :: written(:, :)   !! shape (columns, loops)
      real(wp), allocatable :: table(:, :)
      integer :: n

      table = written
      do n = 1, size(values)
         table(mechanism%arcs(n)%place, mechanism%arcs(n)%loop) = values(n)
      end do
   end function in_columns

   subroutine column_heads(letter, count, text)
      character(*), intent(in) :: letter
      integer, intent(in) :: count
      type(text_t), intent(inout) :: text
      character(column) :: head
      type(text_t) :: row              ! grows in time linear in its length
      integer :: i

      do i = 1, count
         head = letter//to_text(i)
         call row%add_text(adjustr(head))
      end do
      call text%add(row%content())
   end subroutine column_heads

   !> One row for each loop, three decimals.
   subroutine arc_table(values, tie_away, text)
      real(wp), intent(in) :: values(:, :) !! shape (columns, loops)
      logical, intent(in) :: tie_away      !! ties away from zero
      type(text_t), intent(inout) :: text
      type(text_t), allocatable :: row
      integer :: loop, a

      do loop = 1, size(values, 2)
         allocate (row)
         do a = 1, size(values, 1)
            call row%add_text(fixed(values(a, loop), column, 3, tie_away))
         end do
         call text%add(row%content())
         deallocate (row)
      end do
   end subroutine arc_table

   subroutine list_reference(mechanism, value, text)
      type(mechanism_t), intent(in) :: mechanism
      real(wp), intent(in) :: value
      type(text_t), intent(inout) :: text

      if (mechanism%sliding_input) then
         call text%add(' THE REFERENCE INPUT LENGTH')
      else
         call text%add(' THE REFERENCE CRANK ANGLE')
      end if
      call text%add(fixed(value, column, 3))
   end subroutine list_reference

   subroutine list_output_arc(arrays, text)
      type(loop_arrays_t), intent(in) :: arrays
      type(text_t), intent(inout) :: text

      call text%add(' OUTPUT ARC IS MEASURED FROM THE '//trim(merge('START ', 'FINISH', arrays%noutlk < 0))//' OF ARC '// &
                    to_text(abs(arrays%noutlk))//' IN LOOP '//to_text(arrays%noutlp))
   end subroutine list_output_arc

   !> Cartesian dimensions: frame arcs in machine axes, the last arc of each loop turned round so that it leads from the input
   !> pivot to the frame joint; other arcs in the axes of the arc they hang on.
   subroutine list_cartesian(set, problem, dimensions, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(text_t), intent(inout) :: text
      real(wp), allocatable :: x(:, :), y(:, :)   ! shape (columns, loops)
      real(wp) :: c, s
      integer :: loop, a, n, longest

      call text%add(' INPUT PIVOT (X,Y)')
      call unit_vector(dimensions%origng, c, s)
      call text%add(fixed(dimensions%origlk*c, column, 3)//fixed(dimensions%origlk*s, column, 3))
      longest = max(set%links%maxarc, maxval(problem%mechanism%loops%arcs))
      allocate (x(longest, problem%mechanism%nloop), y(longest, problem%mechanism%nloop), source=0.0_wp)
      do loop = 1, problem%mechanism%nloop
         do a = 1, problem%mechanism%loops(loop)%arcs
            n = problem%mechanism%seq(loop, a)
            if (problem%plan%root(n) == root_frame .and. problem%mechanism%arcs(n)%dyad == 0) then
               c = problem%linkage%x(n)
               s = problem%linkage%y(n)
               if (a == problem%mechanism%loops(loop)%arcs) then
                  c = -c
                  s = -s
               end if
            else
               call unit_vector(dimensions%gama(n), c, s)
            end if
            x(a, loop) = dimensions%arcl(n)*c
            y(a, loop) = dimensions%arcl(n)*s
         end do
      end do
      call text%add(' ARRAY OF LINK X DIMENSIONS, XLINK')
      call column_heads('L', longest, text)
      call arc_table(x, .false., text)
      call text%add(' ARRAY OF LINK Y DIMENSIONS, YLINK')
      call column_heads('L', longest, text)
      call arc_table(y, .false., text)
      call text%add(' OUTPUT LINK (X,Y)')
      call unit_vector(dimensions%outang, c, s)
      call text%add(fixed(dimensions%outlk*c, column, 3)//fixed(dimensions%outlk*s, column, 3))
   end subroutine list_cartesian

   !> Heading of the motion table.
   pure function motion_headings(problem) result(line)
      type(problem_t), intent(in) :: problem
      character(:), allocatable :: line

      line = input_heading(problem%mechanism)
      select case (problem%motion)
      case (motion_point)
         if (problem%desired) line = line//'      DESIRED X      DESIRED Y'
         line = line//'       ACTUAL X       ACTUAL Y'
         if (problem%desired) line = line//'        ERROR X        ERROR Y'
         return
      case (motion_pose)
         if (problem%desired) line = line//'      DESIRED X      DESIRED Y  DESIRED ANGLE'
         line = line//'       ACTUAL X       ACTUAL Y   ACTUAL ANGLE'
         if (problem%desired) line = line//'        ERROR X        ERROR Y    ERROR ANGLE'
         return
      case (motion_angle)
         if (problem%desired) line = line//'  DESIRED ANGLE'
         line = line//'   ACTUAL ANGLE'
      case (motion_distance)
         if (problem%desired) line = line//' DESIRED DIST. '
         line = line//'  ACTUAL DIST. '
      case default
         if (problem%desired) line = line//' DESIRED LENGTH'
         line = line//'  ACTUAL LENGTH'
      end select
      if (problem%desired) line = line//'          ERROR'
   end function motion_headings

   !> Desired, actual and error at every position, and their sum of squares.
   subroutine list_motion(problem, motion, text, condition)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(text_t), intent(inout) :: text
      real(wp), intent(in), optional :: condition(:) !! as `list_results` has it
      character(:), allocatable :: line
      real(wp) :: errors(size(motion%actual, 2))
      type(number_format_t) :: of_input, of_crank
      type(number_format_t), dimension(size(motion%actual, 2)) :: of_wanted, of_actual, of_error
      logical :: in_turn
      integer :: i, c

      if (problem%mechanism%outputs(1)%stands_in) return
      associate (named => problem%mechanism%has_joint_names())
         of_input = format_of(named, motion%input)
         if (allocated(motion%crank)) of_crank = format_of(named, motion%crank)
         do c = 1, size(of_actual)
            of_actual(c) = format_of(named, motion%actual(:, c), motion%closed, among(c))
            if (.not. problem%desired) cycle
            of_wanted(c) = format_of(named, problem%wanted(:size(motion%input), c))
            of_error(c) = format_of(named, motion%error(:, c), motion%closed)
         end do
      end associate
      call text%add()
      line = motion_headings(problem)
      if (allocated(motion%crank)) line = line//crank_heading
      call text%add(line)
      do i = 1, size(motion%input)
         line = input_text(problem%mechanism, motion%input(i), of_input)
         if (problem%desired) then
            do c = 1, size(motion%actual, 2)
               line = line//figure(problem%wanted(i, c), of_wanted(c))
            end do
         end if
         if (motion%closed(i)) then
            errors = 0.0_wp
            if (present(condition)) errors = rounding_error(condition(i), what_it_is_of(i))
            do c = 1, size(motion%actual, 2)
               in_turn = c == problem%output%kind%angle .and. .not. problem%desired
               if (in_turn) then
                  line = line//angle_text(motion%actual(i, c), of_actual(c), errors(c))
               else
                  line = line//figure(motion%actual(i, c), of_actual(c), errors(c))
               end if
            end do
            if (problem%desired) then
               do c = 1, size(motion%actual, 2)
                  line = line//figure(motion%error(i, c), of_error(c), errors(c))
               end do
            end if
            if (allocated(motion%crank)) line = line//angle_text(motion%crank(i), of_crank)
         else
            line = line//open_words(motion, i)
         end if
         call text%add(line)
      end do
      if (problem%desired .and. any(motion%closed)) then   ! a sum over no position would be 0, as if it were perfect
         if (all(motion%closed) .and. is_partial()) then
            call text%add(' TOTAL ERROR WITHOUT THE DERIVATIVES AT DEAD POINTS')
         else if (all(motion%closed)) then
            call text%add(' TOTAL ERROR')
         else
            call text%add(' TOTAL ERROR OF THE POSITIONS THAT CLOSE')
         end if
         call text%add(figure(motion%total, format_of(problem%mechanism%has_joint_names(), [motion%total])))
      end if

   contains

      !> Numbers of the kind of a component: a radian, or the lengths of the linkage.
      pure function among(component) result(numbers)
         integer, intent(in) :: component
         real(wp), allocatable :: numbers(:)

         numbers = problem%given%arcl
         if (component == problem%output%kind%angle) numbers = [degrees_per_radian]
      end function among

      !> What the condition number of a position is relative to: of points their distance from the origin, of angles a radian.
      pure function what_it_is_of(position) result(sizes)
         integer, intent(in) :: position
         real(wp) :: sizes(size(motion%actual, 2))

         sizes = motion%actual(position, :)
         if (size(sizes) > 1) sizes(:2) = hypotenuse(motion%actual(position, 1), motion%actual(position, 2))
         if (problem%output%kind%angle > 0) sizes(problem%output%kind%angle) = degrees_per_radian
      end function what_it_is_of

      !> True if a derivative that is wanted does not exist.
      pure logical function is_partial()
         is_partial = .false.
         if (.not. allocated(motion%rates)) return
         is_partial = any(.not. motion%has_rates .and. any(any(problem%rate_weight > 0.0_wp, dim=3), dim=2))
      end function is_partial
   end subroutine list_motion

   !> Why a position has no values.
   pure function open_words(motion, position) result(words)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: position
      character(:), allocatable :: words

      words = '   DOES NOT CLOSE'
      if (.not. allocated(motion%beyond)) return
      if (motion%beyond(position)) words = '   NOT REACHED'
   end function open_words

   subroutine list_violations(problem, motion, text)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(text_t), intent(inout) :: text
      integer :: i

      if (size(motion%violations) == 0) return
      call text%add()
      call text%add(' CONSTRAINTS VIOLATED')
      do i = 1, size(motion%violations)
         call text%add(' '//describe_violation(problem, motion%input, motion%violations(i)))
      end do
   end subroutine list_violations

   !> Derivatives by the input of the orders of which some are wanted: desired, actual, error; what they add to the objective.
   subroutine list_desired_rates(problem, motion, text)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(text_t), intent(inout) :: text
      character(*), parameter :: names(most_rates) = [character(6) :: 'FIRST', 'SECOND']
      character(*), parameter :: blank = repeat(' ', 14)//'-'
      character(:), allocatable :: line
      type(number_format_t) :: of_input
      type(number_format_t), dimension(size(motion%actual, 2)) :: of_wanted, of_actual, of_error
      integer :: order, i, c, n

      n = size(motion%input)
      of_input = format_of(problem%mechanism%has_joint_names(), motion%input)
      do order = 1, most_rates
         associate (wanted => problem%rate_weight(:, :, order) > 0.0_wp, named => problem%mechanism%has_joint_names())
            if (.not. any(wanted)) cycle
            do c = 1, size(of_actual)
               of_wanted(c) = format_of(named, problem%rate_desired(:n, c, order), wanted(:n, c))
               of_actual(c) = format_of(named, motion%rates(:, c, order), motion%closed .and. motion%has_rates)
               of_error(c) = format_of(named, motion%rate_error(:, c, order), motion%closed .and. motion%has_rates)
            end do
            line = ' '//trim(names(order))//' DERIVATIVES BY THE INPUT'
            line = line//', PER '//trim(merge('UNIT OF LENGTH', 'RADIAN        ', problem%mechanism%sliding_input))
            if (order == 2) line = line//' SQUARED'
            if (problem%output%kind%angle > 0) line = line//' (ANGLES IN RADIANS)'
            call text%add()
            call text%add(line)
            line = input_heading(problem%mechanism)
            line = line//headings('DESIRED')//headings(' ACTUAL')//headings('  ERROR')
            call text%add(line)
            do i = 1, size(motion%input)
               line = input_text(problem%mechanism, motion%input(i), of_input)
               do c = 1, size(wanted, 2)
                  line = line//merge(figure(problem%rate_desired(i, c, order), of_wanted(c)), blank, wanted(i, c))
               end do
               if (.not. motion%closed(i)) then
                  line = line//open_words(motion, i)
               else if (.not. motion%has_rates(i)) then
                  line = line//'   DEAD POINT'
               else
                  do c = 1, size(wanted, 2)
                     line = line//figure(motion%rates(i, c, order), of_actual(c))
                  end do
                  do c = 1, size(wanted, 2)
                     line = line//merge(figure(motion%rate_error(i, c, order), of_error(c)), blank, wanted(i, c))
                  end do
               end if
               call text%add(line)
            end do
         end associate
      end do
      call text%add()
      call text%add(' OF THE TOTAL: VALUES, FIRST DERIVATIVES, SECOND DERIVATIVES')
      call text%add(in_a_row(figures_of(problem%mechanism%has_joint_names(), motion%part(0:2), all_count=.true.)))

   contains

      !> One heading for each number of the output.
      pure function headings(word) result(words)
         character(7), intent(in) :: word
         character(:), allocatable :: words

         select case (problem%motion)
         case (motion_point)
            words = '      '//word//' X'//'      '//word//' Y'
         case (motion_pose)
            words = '      '//word//' X'//'      '//word//' Y'//'  '//word//' ANGLE'
         case default
            words = '        '//word
         end select
      end function headings
   end subroutine list_desired_rates

   !> Slides that are parallel between two positions, in words.
   function describe_crossing(problem, motion, crossing) result(text)
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(crossing_t), intent(in) :: crossing
      character(:), allocatable :: text

      associate (i => crossing%position)
         text = 'the slides of '//group_words(problem%mechanism, crossing%loop)// &
                ' are parallel between positions '//to_text(i)//' and '// &
                to_text(i + 1)//' (inputs '//value_words(problem, motion%input(i))//' and '// &
                value_words(problem, motion%input(i + 1))//'): the linkage cannot move from one to the other'
      end associate
   end function describe_crossing

   !> Names of the links of a larger group.
   function names_of_group(mechanism, loop) result(text)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop
      character(:), allocatable :: text
      integer :: k

      text = ''
      associate (members => mechanism%groups(loop)%members)
         do k = 1, size(members)
            if (k > 1) text = text//', '
            text = text//mechanism%bodies(mechanism%arcs(members(k))%body)%name
         end do
      end associate
   end function names_of_group

   !> A violation in words: loop, dyad, positions and by how much; in capitals or small letters, but for names.
   function describe_violation(problem, input, violation, numbered, small) result(text)
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: input(:)          !! shape (positions): as it is shown
      type(violation_t), intent(in) :: violation
      logical, intent(in), optional :: numbered !! if false the positions have no numbers that a user knows; default true
      logical, intent(in), optional :: small    !! in small letters but for names; default false
      character(:), allocatable :: text
      character(:), allocatable :: pair, p, q, group
      type(form_t) :: form
      logical :: with_numbers, in_sentence

      with_numbers = .true.
      if (present(numbered)) with_numbers = numbered
      in_sentence = .false.
      if (present(small)) in_sentence = small
      group = group_heading(problem%mechanism, violation%loop, in_sentence)
      form = form_of(problem%mechanism%groups(violation%loop)%kind)
      if (.not. problem%mechanism%is_dyad(violation%loop)) then
         text = group//said(', GROUP OF LINKS ')//names_of_group(problem%mechanism, violation%loop)
         if (with_numbers) text = text//positions()
         text = text//said(': IT CANNOT FOLLOW FROM THE DRAWING')
         return
      end if
      if (problem%mechanism%has_joint_names()) then
         p = name_of_member(1)
         q = name_of_member(2)
         pair = said('LINKS ')//p//said(' AND ')//q
      else
         p = to_text(problem%mechanism%place(1, violation%loop))
         q = to_text(problem%mechanism%place(2, violation%loop))
         pair = said('ARCS ')//p//said(' AND ')//q
      end if
      text = group//said(', DYAD OF TYPE ')//to_text(problem%mechanism%groups(violation%loop)%kind)//' ('//pair//')'
      if (with_numbers) text = text//positions()
      text = text//': '
      select case (violation%kind)
      case (violation_too_short)
         if (.not. any(form%slides)) then
            text = text//said('BOTH LINKS ARE TOO SHORT BY ')//amount()
         else
            text = text//said('LINK ')//either(form%slides(2))//said(' IS TOO SHORT BY ')//amount()
         end if
      case (violation_too_long)
         if (.not. any(form%slides)) then
            text = text//said('THE DIFFERENCE OF THE LINKS IS TOO GREAT BY ')//amount()
         else
            text = text//said('GUIDE ')//either(.not. form%slides(1))//said(' IS TOO LONG BY ')//amount()
         end if
      case (violation_undetermined)
         text = text//said('THE OUTER JOINTS COINCIDE, THE DIRECTION OF THE LINKS IS NOT DETERMINED')
      case (violation_parallel)
         text = text//said('THE SLIDES ARE PARALLEL')
      case (violation_angle_small, violation_angle_large)
         text = text//said('TRANSMISSION ANGLE ')//amount()//limit(problem%tangle)
      case (violation_toggle)
         select case (problem%mechanism%groups(violation%loop)%kind)
         case (assur_rpr, assur_rpr_guide_first)
            text = text//said('GUIDE ')//either(.not. form%slides(1))
         case default
            text = text//said('LINK ')//either(form%slides(2))
         end select
         text = text//said(' CLOSES WITH ')//amount()//said(' TO SPARE, LESS THAN TOGGLE ')//value_words(problem, problem%toggle)
      case (violation_slides)
         text = text//said('ANGLE BETWEEN THE SLIDES ')//amount()//limit(problem%slide_angle)
      end select
      if (violation%first /= violation%last .and. violation%kind /= violation_parallel .and. &
          violation%kind /= violation_undetermined) then
         text = text//said(' AT WORST')
         if (with_numbers) text = text//said(' (POSITION ')//to_text(violation%worst)//')'
      end if
      if (with_numbers) then
         text = text//said('; INPUT ')//value_words(problem, input(violation%worst))
      else
         text = text//said(' (INPUT ')//value_words(problem, input(violation%worst))//')'
      end if

   contains

      !> Words that are no names.
      function said(words)
         character(*), intent(in) :: words
         character(len(words)) :: said

         said = cased(words, in_sentence)
      end function said

      !> The link that a member of the dyad is fixed in.
      function name_of_member(member) result(words)
         integer, intent(in) :: member
         character(:), allocatable :: words

         associate (arc => problem%mechanism%groups(violation%loop)%members(member))
            words = problem%mechanism%bodies(problem%mechanism%arcs(arc)%body)%name
         end associate
      end function name_of_member

      !> The first of the two, or the second.
      function either(first) result(words)
         logical, intent(in) :: first
         character(:), allocatable :: words

         words = q
         if (first) words = p
      end function either

      function positions() result(words)
         character(:), allocatable :: words

         words = said(', POSITION ')//to_text(violation%first)
         if (violation%first /= violation%last) words = said(', POSITIONS ')//to_text(violation%first)//said(' TO ')// &
                                                        to_text(violation%last)
      end function positions

      !> The limit as it was given.
      function limit(deviation) result(words)
         real(wp), intent(in) :: deviation     !! from a right angle, degrees
         character(:), allocatable :: words

         if (problem%trmin_given) then
            words = value_words(problem, right_angle - deviation)
            words = said(', OUTSIDE TRMIN ')//words//said(' TO 180 - ')//words
         else
            words = said(', OUTSIDE 90 +- ')//value_words(problem, deviation)
         end if
      end function limit

      function amount() result(words)
         character(:), allocatable :: words

         words = value_words(problem, violation%amount)
      end function amount
   end function describe_violation

   !> A number in a sentence as the listing of this linkage has it, without blanks.
   pure function value_words(problem, value) result(words)
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: value
      character(:), allocatable :: words

      words = trim(adjustl(number_in_sentence(problem%mechanism%has_joint_names(), value)))
   end function value_words
end module psalm_finale
