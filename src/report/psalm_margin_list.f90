!> How far the linkage is inside its constraints, for the listing.
module psalm_margin_list
   use psalm_clearances, only: clearance_t, list_clearances
   use psalm_column_names, only: input_unit
   use psalm_columns, only: left_column
   use psalm_constraint_group, only: range_positions, range_inputs
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_group_words, only: group_heading
   use psalm_kinds, only: wp
   use psalm_margins, only: margin_t, is_violated, margin_angle, margin_slides, margin_guide, margin_offset, &
                             margin_clearance, margin_bound, margin_group
   use psalm_mechanism, only: mechanism_t
   use psalm_number_format, only: figures_of, in_sentence
   use psalm_place, only: beside_t
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t, cased, to_text
   use psalm_dimensions, only: dimensions_t
   use psalm_parameters, only: name_of, words_of
   use psalm_shown_input, only: input_at, input_in_turn
   implicit none (type, external)
   private
   public :: list_margins, put_margins, describe_margin, name_of_clearance, name_of_limit

   integer, parameter :: name_length = 120     !! characters of a name in a table
   integer, parameter :: name_columns = 44   !! width of a constraint's name

contains

   !> Append the table of margins.
   subroutine list_margins(set, problem, dimensions, margins, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(margin_t), intent(in) :: margins(:)
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      character(15) :: margin(size(margins)), input(size(margins))
      integer :: i

      call text%add()
      select case (set%constr%irange)
      case (range_positions)
         call text%add(' MARGINS OF THE CONSTRAINTS, AT THE PRESCRIBED POSITIONS')
      case (range_inputs)
         call text%add(' MARGINS OF THE CONSTRAINTS, OVER THE RANGE OF THE INPUTS')
      case default
         call text%add(' MARGINS OF THE CONSTRAINTS, OVER A FULL TURN')
      end select
      call text%add(' CONSTRAINT                                           MARGIN       AT INPUT')
      margin = figures_of(problem%mechanism%has_joint_names(), margins%margin)
      input = figures_of(problem%mechanism%has_joint_names(), &
                         [(input_of(problem, dimensions, margins(i)), i=1, size(margins))], has_input(margins))
      do i = 1, size(margins)
         line = name_of_margin(set, problem, margins(i), small=.false.)
         line = ' '//left_column(line, name_columns)//margin(i)
         if (has_input(margins(i))) line = line//input(i)
         if (is_violated(margins(i))) line = line//'  VIOLATED'
         call text%add(line)
      end do
   end subroutine list_margins

   !> A violated constraint in words.
   function describe_margin(set, problem, dimensions, margin, small) result(text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(margin_t), intent(in) :: margin
      logical, intent(in) :: small                 !! small letters, but for names
      character(:), allocatable :: text

      text = name_of_margin(set, problem, margin, small)
      associate (named => problem%mechanism%has_joint_names())
         text = text//' by '//trim(adjustl(in_sentence(named, -margin%margin)))
         if (has_input(margin)) text = text//' at input '//trim(adjustl(in_sentence(named, input_of(problem, dimensions, margin))))
      end associate
   end function describe_margin

   !> True if a margin is least at an input, false if it is the same at all of them.
   elemental logical function has_input(margin)
      type(margin_t), intent(in) :: margin

      has_input = margin%kind < margin_bound .or. margin%kind == margin_group
   end function has_input

   pure real(wp) function input_of(problem, dimensions, margin)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(margin_t), intent(in) :: margin

      input_of = input_in_turn(problem%mechanism, input_at(problem%mechanism, dimensions, margin%delt))
   end function input_of

   pure function name_of_margin(set, problem, margin, small) result(name)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(margin_t), intent(in) :: margin
      logical, intent(in) :: small           !! small letters, but for names
      character(:), allocatable :: name
      type(clearance_t), allocatable :: clearances(:)
      integer, allocatable :: joints(:, :)
      type(beside_t), allocatable :: beside(:)

      select case (margin%kind)
      case (margin_angle, margin_slides, margin_guide, margin_offset)
         name = name_of_limit(problem%mechanism, margin, set%limits%trmin_given, small)
      case (margin_group)
         name = group_heading(problem%mechanism, margin%which, small)//cased(', DEAD POINT OF ITS GROUP (1 IS BEST)', small)
      case (margin_clearance)
         call list_clearances(set%constr, problem%mechanism, problem%given%outlk <= 0.0_wp, clearances, joints, &
                              beside)
         name = name_of_clearance(set, clearances(margin%which), small)
      case (margin_bound)
         name = cased('BOUND, ', small)//variable_name()
      case default
         name = cased('LENGTH, ', small)//variable_name()
      end select

   contains

      pure function variable_name() result(words)
         character(:), allocatable :: words

         associate (variable => problem%parameters%variables(margin%which))
            if (small) then
               words = words_of(variable)
            else
               words = name_of(variable)
            end if
         end associate
      end function variable_name
   end function name_of_margin

   !> What a dyad is to keep.
   pure function name_of_limit(mechanism, margin, trmin_given, small) result(name)
      type(mechanism_t), intent(in) :: mechanism
      type(margin_t), intent(in) :: margin
      logical, intent(in) :: trmin_given           !! the limit of angles is TRMIN
      logical, intent(in) :: small                 !! small letters, but for names
      character(:), allocatable :: name
      character(:), allocatable :: group

      group = group_heading(mechanism, margin%which, small)
      select case (margin%kind)
      case (margin_angle)
         name = cased('TRANSMISSION ANGLE'//as_given()//', ', small)//group//cased(', DEGREES', small)
      case (margin_slides)
         name = cased('ANGLE BETWEEN THE SLIDES, ', small)//group//cased(', DEGREES', small)
      case (margin_guide)
         name = cased('GUIDE AND TOGGLE, ', small)//group
      case default
         name = cased('OFFSET AND TOGGLE, ', small)//group
      end select

   contains

      pure function as_given() result(words)
         character(:), allocatable :: words

         words = ''
         if (trmin_given) words = ' (TRMIN)'
      end function as_given
   end function name_of_limit

   !> What keeps apart from what.
   pure function name_of_clearance(set, clearance, small) result(name)
      type(data_set_t), intent(in) :: set
      type(clearance_t), intent(in) :: clearance
      logical, intent(in) :: small                 !! small letters, but for the names of joints
      character(:), allocatable :: name

      if (clearance%region == 0) then
         name = cased('LINKS ', small)//segment_name(clearance%segments(1))//cased(' AND ', small)// &
                segment_name(clearance%segments(2))
      else if (clearance%segments(1) > 0) then
         name = cased('REGION ', small)//to_text(clearance%region)//cased(', LINK ', small)//segment_name(clearance%segments(1))
      else
         name = cased('REGION ', small)//to_text(clearance%region)//', '//joint_name()
      end if

   contains

      !> Number of a segment, or its joints as the user calls them.
      pure function segment_name(number) result(words)
         integer, intent(in) :: number
         character(:), allocatable :: words

         words = to_text(number)
         if (.not. set%has_names()) return
         associate (joints => set%constr%segments(number)%joints)
            words = trim(set%sketch%joint_name(joints(1)))//'-'//trim(set%sketch%joint_name(joints(2)))
         end associate
      end function segment_name

      pure function joint_name() result(words)
         character(:), allocatable :: words

         associate (region => clearance%shape)
            if (set%has_names()) then
               words = cased('JOINT ', small)//trim(set%sketch%joint_name(region%joint))
            else if (region%loop == 0) then
               words = cased('OUTPUT POINT', small)
            else if (region%arc == 0) then
               words = cased('INPUT PIVOT', small)
            else
               words = cased('FINISH OF ARC '//to_text(region%arc)//' IN LOOP '//to_text(region%loop), small)
            end if
         end associate
      end function joint_name
   end function name_of_clearance

   !> The table `constraints` for other programs: the same.
   subroutine put_margins(set, problem, dimensions, margins, tables)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(margin_t), intent(in) :: margins(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: names(:)
      integer :: i

      allocate (names(size(margins)))
      do i = 1, size(margins)
         names(i) = name_of_margin(set, problem, margins(i), small=.true.)
      end do
      table = table_of('constraints', 'a row for each constraint: its least margin, degrees or length', audience=for_programs)
      call table%add('constraint', names)
      call table%add('margin', margins%margin)
      call table%add('at', [(input_of(problem, dimensions, margins(i)), i=1, size(margins))], &
                     input_unit(problem%mechanism%sliding_input), has_input(margins))
      call table%add('violated', [(is_violated(margins(i)), i=1, size(margins))])
      call tables%put(table)
   end subroutine put_margins
end module psalm_margin_list
