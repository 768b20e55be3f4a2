!> Device 8: the annotated input, the intermediate arrays of SETUP, and the table of all arcs (KTHETA).
!>
!> Layout of Oldham (1977), figures 7.3 and C1.
module psalm_check_list
   use psalm_analysis, only: arc_table_t, warnings_t
   use psalm_columns, only: left_column, right_column, add_rows
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t
   use psalm_finale, only: arc_table, list_reference, list_output_arc
   use psalm_group_words, only: arc_heading, group_heading
   use psalm_input_text, only: angle_text
   use psalm_kinds, only: wp
   use psalm_loop_arrays, only: loop_arrays_t, arrays_of
   use psalm_output_kind, only: output_kind_t, output_kind
   use psalm_rate_items, only: rate_row_t, wanted_rows
   use psalm_mechanism, only: mechanism_t, arc_crank, arc_determined, arc_slide
   use psalm_sketch_text, only: write_sketch
   use psalm_number_format, only: number_format_t, figure, format_of, in_sentence
   use psalm_text, only: text_t, fixed, general, to_text
   implicit none (type, external)
   private
   public :: list_input, list_setup, list_arcs, list_reference_joints

   integer, parameter :: column = 10      !! width of a dimension
   integer, parameter :: wide_column = 14 !! width of a coordinate
   integer, parameter :: name_column = 30 !! of the name of a line
   integer, parameter :: per_row = 5      !! values in a row of positions
   real(wp), parameter :: link_mark = 1.0_wp    !! SLIDE and CONFIG: a link
   real(wp), parameter :: slide_mark = 1.57_wp  !! SLIDE and CONFIG: a slide (a right angle, radians)

contains

   !> Append the annotated input: of a sketch the data set as it was read, of a linkage of loops its arrays.
   subroutine list_input(heading, set, problem, text)
      character(*), intent(in) :: heading    !! program and version
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(text_t), intent(inout) :: text
      type(loop_arrays_t) :: arrays

      call text%add(heading)
      call text%add()
      if (set%has_names()) then
         call write_sketch(set, text)
         return
      end if
      arrays = arrays_of(set)
      call text%add(' '//set%title)
      call text%add(' MOTION  NLOOP MAXARC ILKOUT INGOUT   ICRK   IORIG KTHETA  IPLOT')
      call text%add(integers([set%motion(), arrays%nloop, arrays%maxarc, arrays%ilkout, arrays%ingout, &
                              arrays%icrk, arrays%iorig, set%limits%ktheta, &
                              set%limits%iplot], 7))
      call text%add(' ARRAY OF ARC LENGTHS, ARCL')
      call arc_table(arrays%arcl, .false., text)
      call text%add(' ARRAY OF ARC ANGLES, GAMA')
      call arc_table(arrays%gama, .false., text)
      call list_reference(problem%mechanism, arrays%crnki, text)
      call text%add(' POLAR CO-ORDINATES (LENGTH, ANGLE) OF')
      call text%add(' INPUT PIVOT '//fixed(arrays%origlk, column, 3)//fixed(arrays%origng, column, 4))
      call text%add(' OUTPUT ARC  '//fixed(arrays%outlk, column, 3)//fixed(arrays%outang, column, 4))
      call list_output_arc(arrays, text)
      if (set%method%ikin /= 0) then
         call text%add(' ANALYSIS EVERY '//to_text(set%method%ikin)//' DEGREES')
      else
         call list_positions(set, problem%mechanism, text)
      end if
      call text%add(' TOPOLOGICAL ARRAY, ILINK')
      call loop_rows(arrays%ilink, text)
      call text%add(' TOPOLOGICAL ARRAY, ILOOP')
      call loop_rows(arrays%iloop, text)
      if (.not. problem%parameters%has_search()) return
      call text%add(' ARRAY OF VARIABLE ARC LENGTHS, IVA')
      call loop_rows(arrays%iva, text)
      call text%add(' ARRAY OF VARIABLE ARC ANGLES, IVG')
      call loop_rows(arrays%ivg, text)
   end subroutine list_input

   !> Desired values, weights and inputs, five in a row.
   subroutine list_positions(set, mechanism, text)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(text_t), intent(inout) :: text
      type(output_kind_t) :: kind

      call text%add(' NUMBER OF DESIRED POSITIONS, NDES'//trim(integers([set%method%ndes], 7)))
      if (set%method%desired) then
         kind = output_kind(set%motion())
         if (kind%components > 1) then
            call text%add(' THE DESIRED POINTS ARE RELATIVE TO XADD, YADD')
            call rows([set%method%xadd, set%method%yadd])
            call text%add(' THE DESIRED X CO-ORDINATE')
            call rows(set%method%desx)
            call text%add(' WEIGHTING FACTORS FOR THE VALUES ABOVE')
            call rows(set%method%xmult)
            call text%add(' THE DESIRED Y CO-ORDINATE')
            call rows(set%method%desy)
            call text%add(' WEIGHTING FACTORS FOR THE VALUES ABOVE')
            call rows(set%method%ymult)
         end if
         if (kind%components /= 2) then
            if (kind%angle > 0) then
               call text%add(' THE DESIRED OUTPUT ANGLE')
            else if (kind%has_point) then
               call text%add(' THE DESIRED OUTPUT DISTANCE')
            else
               call text%add(' THE DESIRED SLIDING LENGTH')
            end if
            call rows(set%method%desang)
            call text%add(' WEIGHTING FACTORS FOR THE VALUES ABOVE')
            call rows(set%method%anmult)
         end if
         if (allocated(set%method%rate_desired)) call list_desired_rates(wanted_rows(set%method%rate_weight))
      end if
      if (mechanism%sliding_input) then
         call text%add(' THE DESIRED INPUT LENGTH')
      else
         call text%add(' THE DESIRED CRANK INPUT ANGLE')
      end if
      call rows(set%method%delt)

   contains

      !> Derivatives by the input, under the names of their items.
      subroutine list_desired_rates(wanted)
         type(rate_row_t), intent(in) :: wanted(:)
         integer :: k

         do k = 1, size(wanted)
            associate (own => wanted(k))
               call text%add(' THE DESIRED '//trim(merge('FIRST ', 'SECOND', own%order == 1))//' DERIVATIVE BY THE INPUT, '// &
                             trim(own%item))
               call rows(set%method%rate_desired(:, own%component, own%order))
               call text%add(' WEIGHTING FACTORS FOR THE VALUES ABOVE, 0 WHERE NONE IS WANTED')
               call rows(set%method%rate_weight(:, own%component, own%order))
            end associate
         end do
      end subroutine list_desired_rates

      subroutine rows(values)
         real(wp), intent(in) :: values(:)

         call add_rows(values, per_row, '', text)
      end subroutine rows
   end subroutine list_positions

   !> Append the intermediate arrays and the control values.
   subroutine list_setup(set, problem, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(text_t), intent(inout) :: text
      type(loop_arrays_t) :: arrays
      integer :: loop, which

      call text%add()
      if (set%has_names()) then
         call list_groups(problem, text)
         call text%add(' NUMBER OF OPTIMIZATION VARIABLES '//to_text(size(problem%parameters%variables)))
         call list_controls(set, text)
         return
      end if
      arrays = arrays_of(set)
      associate (mechanism => problem%mechanism, parameters => problem%parameters)
         call text%add(' NUMBER OF ARCS IN EACH LOOP, LOOPL')
         call text%add(integers([mechanism%loops%arcs], 5))
         call text%add(' UNDETERMINED ARCS IN EACH LOOP, LARCX')
         call loop_rows(reshape([([(place_of_member(mechanism, which, loop), which=1, most_members(mechanism))], &
                                  loop=1, mechanism%nloop)], [most_members(mechanism), mechanism%nloop]), text)
         call list_references(arrays, mechanism, text)
         if (parameters%has_search()) then
            call text%add(' ARRAY OF VARIABLES CORRESPONDING TO ARCS')
            call by_loop(arrays, mechanism, parameters%length_variable, text)
            call text%add(' ARRAY OF VARIABLES CORRESPONDING TO ANGLES')
            call by_loop(arrays, mechanism, parameters%angle_variable, text)
         end if
         call text%add(' NUMBER OF OPTIMIZATION VARIABLES, MARBLE '//to_text(size(parameters%variables)))
         call list_dyads(arrays, mechanism, text)
      end associate
      call list_controls(set, text)
      call list_pruned(problem, text)
   end subroutine list_setup

   !> The groups of a sketch in the order in which they are solved.
   subroutine list_groups(problem, text)
      type(problem_t), intent(in) :: problem
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: k, m

      associate (mechanism => problem%mechanism)
         call text%add(' ASSUR GROUPS IN THE ORDER OF THEIR SOLUTION')
         do k = 1, mechanism%nloop
            if (size(mechanism%groups(k)%members) == 0) then   ! the drives place all links
               call text%add('  NONE')
               cycle
            end if
            line = '  '//group_heading(mechanism, k, small=.false.)//': '
            if (mechanism%is_dyad(k)) then
               line = line//'DYAD OF TYPE '//to_text(mechanism%groups(k)%kind)//', LINKS'
            else
               line = line//'LARGER GROUP, LINKS'
            end if
            associate (members => mechanism%groups(k)%members)
               do m = 1, size(members)
                  line = line//trim(merge(',', ' ', m > 1))//' '//mechanism%bodies(mechanism%arcs(members(m))%body)%name
               end do
            end associate
            if (.not. problem%plan%solved(k)) line = line//'; THE OUTPUT DOES NOT DEPEND ON IT'
            call text%add(line)
         end do
      end associate
   end subroutine list_groups

   !> Which arcs hang on which and which are identical, by sequential numbers (loop-1)*MAXARC + arc.
   subroutine list_references(arrays, mechanism, text)
      type(loop_arrays_t), intent(in) :: arrays
      type(mechanism_t), intent(in) :: mechanism
      type(text_t), intent(inout) :: text
      integer, dimension(size(mechanism%arcs)) :: larcd, larcf, identa, alike
      integer :: n, m

      alike = 0
      do n = 1, size(mechanism%arcs)
         associate (first => mechanism%arcs(n)%representative)
            alike(first) = alike(first) + 1
         end associate
      end do
      larcd = 0
      larcf = 0
      identa = 0
      do n = 1, size(mechanism%arcs)
         associate (arc => mechanism%arcs(n))
            m = arc%reference
            if (m == 0 .and. (arc%kind == arc_crank .or. arc%kind == arc_determined)) m = n
            if (m > 0) then
               larcd(n) = sequential(m)
               larcf(n) = sequential(mechanism%seq(mechanism%arcs(m)%loop, mechanism%loops(mechanism%arcs(m)%loop)%arcs))
            end if
            if (alike(arc%representative) > 1) identa(n) = sequential(arc%representative)
         end associate
      end do
      call text%add(' INDICES OF ARCS THAT PROVIDE DATA FOR OTHER ARCS, LARCD')
      call by_loop(arrays, mechanism, larcd, text)
      call text%add(' INDICES OF FRAME ARCS CORRESPONDING TO LARCD, LARCF')
      call by_loop(arrays, mechanism, larcf, text)
      call text%add(' ARRAY OF IDENTICAL ARCS, IDENTA')
      call by_loop(arrays, mechanism, identa, text)

   contains

      pure integer function sequential(arc)
         integer, intent(in) :: arc

         sequential = (mechanism%arcs(arc)%loop - 1)*arrays%maxarc + mechanism%arcs(arc)%place
      end function sequential
   end subroutine list_references

   !> The groups; SLIDE and CONFIG show the sign each undetermined arc has in ILINK.
   subroutine list_dyads(arrays, mechanism, text)
      type(loop_arrays_t), intent(in) :: arrays
      type(mechanism_t), intent(in) :: mechanism
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: loop, which, n

      call text%add(' ARRAYS "JOINT", "SLIDE", "CONFIG"')
      call text%add(integers([mechanism%groups%kind], 8))
      do which = 1, most_members(mechanism)
         line = ''
         do loop = 1, mechanism%nloop
            if (which > size(mechanism%groups(loop)%members)) then
               line = line//fixed(0.0_wp, column, 2)
               cycle
            end if
            n = mechanism%groups(loop)%members(which)
            associate (arc => mechanism%arcs(n))
               line = line//fixed(-real(sign(1, arrays%ilink(arc%place, loop)), wp)* &
                                  merge(slide_mark, link_mark, arc%kind == arc_slide), column, 2)
            end associate
         end do
         call text%add(line)
      end do
   end subroutine list_dyads

   !> Undetermined arcs of the largest group.
   pure integer function most_members(mechanism)
      type(mechanism_t), intent(in) :: mechanism
      integer :: loop

      most_members = maxval([(size(mechanism%groups(loop)%members), loop=1, mechanism%nloop)])
   end function most_members

   !> Number in its loop of an undetermined arc; 0: the group has fewer.
   pure integer function place_of_member(mechanism, which, loop) result(place)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: which, loop

      place = 0
      if (which <= size(mechanism%groups(loop)%members)) place = mechanism%place(which, loop)
   end function place_of_member

   subroutine list_controls(set, text)
      type(data_set_t), intent(in) :: set
      type(text_t), intent(inout) :: text

      call text%add('      FMIN     SMALL       VAR    TANGLE    TOGGLE    STEPIN')
      call text%add(reals([set%method%fmin, set%method%small, set%method%var, set%limits%tangle, set%limits%toggle, &
                           set%limits%stepin]))
      call text%add('    BOUNCE    EXPAND     SNAKE    REDUCE    SHRINK')
      call text%add(reals([set%method%bounce, set%method%expand, set%method%snake, set%method%reduce, set%method%shrink]))
      call text%add(' NGUESS   IKIN LIMVAL  NVIOL  NITER NCHECK NPRINT   NPRT')
      call text%add(integers([set%method%nguess, set%method%ikin, set%limits%limval, set%limits%nviol, set%method%niter, &
                              set%method%ncheck, set%limits%nprint, set%limits%nprt], 7))
   end subroutine list_controls

   !> What the output does not depend on is not solved; say so.
   subroutine list_pruned(problem, text)
      type(problem_t), intent(in) :: problem
      type(text_t), intent(inout) :: text
      character(:), allocatable :: kept, dropped
      integer :: loop

      if (all(problem%plan%solved)) return
      kept = ''
      dropped = ''
      do loop = 1, problem%mechanism%nloop
         if (problem%plan%solved(loop)) then
            kept = kept//' '//to_text(loop)
         else
            dropped = dropped//' '//to_text(loop)
         end if
      end do
      if (len(kept) == 0) kept = ' NONE'
      call text%add(' LOOPS THE OUTPUT DEPENDS ON:'//kept)
      call text%add(' LOOPS NOT SOLVED (KTHETA=1 SOLVES ALL):'//dropped)
   end subroutine list_pruned

   !> Length and angle of every arc at every position.
   subroutine list_arcs(mechanism, motion, arcs, condition, text)
      type(mechanism_t), intent(in) :: mechanism
      type(motion_t), intent(in) :: motion
      type(arc_table_t), intent(in) :: arcs
      real(wp), intent(in) :: condition(:)    !! shape (positions)
      type(text_t), intent(inout) :: text
      integer :: k, loop
      character(:), allocatable :: lengths, angles

      call text%add()
      if (mechanism%has_joint_names()) then
         call text%add(' LENGTHS AND ANGLES OF ALL LINES')
      else
         call text%add(' LENGTHS AND ANGLES OF ALL ARCS')
      end if
      do k = 1, size(motion%input)
         call text%add()
         call text%add(' INPUT'//in_sentence(mechanism%has_joint_names(), motion%input(k))//'  CONDITION NUMBER'// &
                       in_sentence(mechanism%has_joint_names(), condition(k)))
         do loop = 1, mechanism%nloop
            if (loop == arcs%open(k)) then
               call text%add(open_group(mechanism, loop))
               if (loop < mechanism%nloop) &
                  call text%add(' THE '//trim(merge('GROUPS', 'LOOPS ', mechanism%has_joint_names()))// &
                                ' AFTER IT ARE NOT DETERMINED')
               exit
            end if
            if (mechanism%has_joint_names()) then
               call line_rows(mechanism, arcs, k, loop, text)
               cycle
            end if
            call arc_lines(mechanism, arcs, k, loop, lengths, angles)
            call text%add(lengths)
            call text%add(angles)
         end do
      end do
   end subroutine list_arcs

   subroutine arc_lines(mechanism, arcs, k, loop, lengths, angles)
      type(mechanism_t), intent(in) :: mechanism
      type(arc_table_t), intent(in) :: arcs
      integer, intent(in) :: k, loop
      character(:), allocatable, intent(out) :: lengths, angles
      type(text_t) :: first, second
      integer :: a, n

      do a = 1, mechanism%loops(loop)%arcs
         n = mechanism%seq(loop, a)
         call first%add_text(general(arcs%length(n, k)))
         call second%add_text(angle_text(arcs%angle(n, k)))
      end do
      lengths = first%content()
      angles = second%content()
   end subroutine arc_lines

   !> Lines of a sketch by their names, a row each.
   subroutine line_rows(mechanism, arcs, k, loop, text)
      type(mechanism_t), intent(in) :: mechanism
      type(arc_table_t), intent(in) :: arcs
      integer, intent(in) :: k, loop
      type(text_t), intent(inout) :: text
      character(:), allocatable :: name
      type(number_format_t) :: of_length, of_angle
      integer, allocatable :: in_order(:)
      integer :: a, n

      in_order = [(mechanism%seq(loop, a), a=1, mechanism%loops(loop)%arcs)]
      of_length = format_of(.true., arcs%length(in_order, k))
      of_angle = format_of(.true., arcs%angle(in_order, k))
      do a = 1, size(in_order)
         n = in_order(a)
         if (mechanism%arcs(n)%representative /= n) cycle    ! reported before
         name = arc_heading(mechanism, loop, a, small=.false.)
         call text%add('  '//left_column(name, name_column)//figure(arcs%length(n, k), of_length)// &
                       angle_text(arcs%angle(n, k), of_angle))
      end do
   end subroutine line_rows

   !> Append where the joint of the two undetermined arcs of every loop is at the reference position.
   subroutine list_reference_joints(mechanism, warnings, text)
      type(mechanism_t), intent(in) :: mechanism
      type(warnings_t), intent(in) :: warnings
      type(text_t), intent(inout) :: text
      character(:), allocatable :: arcs
      integer :: loop

      if (mechanism%has_joint_names()) then
         call text%add(' INNER JOINT OF EACH GROUP AT THE REFERENCE INPUT (X,Y)')
      else
         call text%add(' JOINT OF THE UNDETERMINED ARCS OF EACH LOOP AT THE REFERENCE INPUT (X,Y)')
      end if
      do loop = 1, mechanism%nloop
         if (.not. warnings%closes(loop)) then
            call text%add(open_group(mechanism, loop)//' AT THE REFERENCE INPUT')
            return
         end if
         if (mechanism%has_joint_names()) then
            if (size(mechanism%groups(loop)%members) == 0) cycle
            call text%add(' '//group_heading(mechanism, loop, small=.false.)//'  '// &
                          fixed(warnings%joint(1, loop), wide_column, 4)// &
                          fixed(warnings%joint(2, loop), wide_column, 4))
            cycle
         end if
         arcs = 'FINISH OF ARC '//to_text(mechanism%place(1, loop))
         if (mechanism%is_dyad(loop)) arcs = 'ARCS '//to_text(mechanism%place(1, loop))//' AND '// &
                                             to_text(mechanism%place(2, loop))
         call text%add(' LOOP '//to_text(loop)//', '//arcs//'  '//fixed(warnings%joint(1, loop), wide_column, 4)// &
                       fixed(warnings%joint(2, loop), wide_column, 4))
      end do
   end subroutine list_reference_joints

   !> The loop or group that does not close.
   function open_group(mechanism, loop) result(words)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop
      character(:), allocatable :: words

      words = ' '//group_heading(mechanism, loop, small=.false.)//' '// &
              trim(merge('DO NOT MEET   ', 'DOES NOT CLOSE', mechanism%has_joint_names()))
   end function open_group

   ! ---- rows --------------------------------------------------------------------------------------------------------

   pure function integers(values, width) result(line)
      integer, intent(in) :: values(:), width
      character(:), allocatable :: line
      type(text_t) :: row              ! grows in time linear in its length
      integer :: i

      do i = 1, size(values)
         call row%add_text(right_column(values(i), width, 1))
      end do
      line = row%content()
   end function integers

   pure function reals(values) result(line)
      real(wp), intent(in) :: values(:)
      character(:), allocatable :: line
      character(column) :: buffer
      type(text_t) :: row
      integer :: i

      do i = 1, size(values)
         write (buffer, '(f10.4)') values(i)
         if (buffer(1:1) == '*') write (buffer, '(es10.3)') values(i)
         call row%add_text(buffer)
      end do
      line = row%content()
   end function reals

   subroutine loop_rows(values, text)
      integer, intent(in) :: values(:, :)  !! shape (columns, loops)
      type(text_t), intent(inout) :: text
      integer :: loop

      do loop = 1, size(values, 2)
         call text%add(integers(values(:, loop), max(5, widest(values) + 2)))
      end do
   end subroutine loop_rows

   subroutine by_loop(arrays, mechanism, values, text)
      type(loop_arrays_t), intent(in) :: arrays
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: values(:)     !! by arc
      type(text_t), intent(inout) :: text
      integer :: table(arrays%maxarc, arrays%nloop), n

      table = 0
      do n = 1, size(values)
         table(mechanism%arcs(n)%place, mechanism%arcs(n)%loop) = values(n)
      end do
      call loop_rows(table, text)
   end subroutine by_loop

   pure integer function widest(values)
      integer, intent(in) :: values(:, :)

      widest = len(to_text(maxval(abs(values))))
   end function widest
end module psalm_check_list
