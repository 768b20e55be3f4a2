!> What is proven of the motion, in the listing and on device 9.
!>
!> Ends are rounded inwards: what is printed stays true.
module psalm_proof_list
   use psalm_column_names, only: input_unit
   use psalm_columns, only: left_column, right_column
   use psalm_data_set, only: data_set_t
   use psalm_group_words, only: arc_heading, group_heading
   use psalm_kinds, only: wp, dp
   use psalm_margin_list, only: name_of_clearance, name_of_limit
   use psalm_markup, only: strings_t, add_string
   use psalm_margins, only: margin_angle, margin_guide, margin_slides
   use psalm_number_format, only: number_format_t, figure, figures_of, format_of, number_words
   use psalm_part_columns, only: add_groups, add_words
   use psalm_proven_margins, only: proven_margin_t
   use psalm_proof, only: proof_t, limit_t, touch_exact, piece_closes, piece_opens, piece_undecided, cause_too_short, &
                          cause_difference, cause_guide, cause_link, cause_parallel
   use psalm_mechanism, only: mechanism_t
   use psalm_proof_motion, only: proven_dead_point_t, quantity_output, quantity_turning
   use psalm_proof_ranges, only: proven_extreme_t, extreme_angle, extreme_slide, extreme_x, extreme_y, extreme_output, &
                                 extreme_distance, extreme_slides
   use psalm_proof_study, only: proof_study_t, kept_t
   use psalm_summary_text, only: name_of_kind
   use psalm_tables, only: table_t, tables_t, table_of
   use psalm_text, only: text_t, cased, full_precision, to_text, upper_case
   implicit none (type, external)
   private
   public :: list_proof, put_proof, describe_proof, about_limits, about_extremes
   public :: list_range, head_of_ranges, shown, short, end_text, cause_words, extreme_name, quantity_name
   public :: list_kept, put_kept, list_dead_points, list_dwell, same_quantity, put_dead_points

   character(*), parameter :: about_limits = 'a row for each part of the range, the brackets between them too'
   character(*), parameter :: about_extremes = 'a row for each quantity: brackets of its extremes; angles in degrees'

   integer, parameter :: quantity_columns = 34, value_columns = 17, list_columns = 110
   character(*), parameter :: head_of_ranges = &
      '   QUANTITY                                      LEAST             AT         GREATEST             AT'
   integer, parameter :: name_columns = 39, limit_columns = 42, number_columns = 15
   real(wp), parameter :: certain = 1.0e-9_wp       !! relative width of a bracket that is reported as one number

   integer, parameter :: width = 16, decimals = 12  !! of an angle below 1000
   integer, parameter :: most_digits = 40           !! of any
   real(wp), parameter :: narrow = 1.0e-12_wp       !! of the range: an end bracketed so is reported as one number

contains

   !> Append the limits of motion.
   subroutine list_proof(set, mechanism, study, text)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: i

      call text%add()
      associate (proof => study%proof)
         call text%add(' LIMITS OF MOTION, PROVEN FOR '//trim(merge('CRANK ANGLES ', 'INPUT LENGTHS', proof%turns))//' '// &
                       short(proof%from)//' TO '//short(proof%to))
         if (proof%closes_everywhere()) then
            if (study%full_turn) then
               call text%add('   CLOSES FOR EVERY CRANK ANGLE; THE CRANK TURNS FULLY')
            else
               call text%add('   CLOSES FOR EVERY INPUT OF THE RANGE')
            end if
            call list_tolerance(study, text)
         else
            do i = 1, size(proof%limits)
               call list_limit(mechanism, proof, i, text)
            end do
            call list_circuits(study, text)
         end if
      end associate
      do i = 1, size(study%kinds)
         call text%add('   '//group_heading(mechanism, study%kinds(i)%loop, .false.)//': '// &
                       upper_case(name_of_kind(study%kinds(i)%kind)))
      end do
      call list_extremes(mechanism, study, text)
      call list_movement(mechanism, study, text)
      call list_proven_margins(mechanism, study, text)
      call list_kept(set, study%kept, text)
   end subroutine list_proof

   !> Margins of the dyads, with the angle or length they keep inside their limits at least.
   subroutine list_proven_margins(mechanism, study, text)
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(:), allocatable :: name
      character(value_columns) :: least
      character(number_columns) :: at(size(study%margins))
      integer :: i

      if (size(study%margins) == 0) return
      at = figures_of(mechanism%has_joint_names(), study%margins%margin%delt)
      call text%add('   MARGIN                                             AT LEAST             AT')
      do i = 1, size(study%margins)
         associate (own => study%margins(i))
            name = name_of_limit(mechanism, own%margin, study%trmin_given, small=.false.)
            name = left_column(name, limit_columns, 0)
            least = shown(own%low, -1)
            call text%add('   '//name//adjustr(least)//at(i)//'  '//verdict(own))
            if (own%high - own%low > certain*max(abs(own%low), abs(own%high), 1.0_wp)) &
               call text%add('     AT MOST '//shown(own%high, 1))
         end associate
      end do

   contains

      pure function verdict(own) result(words)
         type(proven_margin_t), intent(in) :: own
         character(:), allocatable :: words

         if (own%is_broken) then
            words = 'VIOLATED'
         else if (own%low >= own%margin%least_allowed) then
            words = 'KEPT'
         else
            words = 'NOT PROVEN'
         end if
      end function verdict
   end subroutine list_proven_margins

   !> Clearances over what closes.
   subroutine list_kept(set, kept_ones, text)
      type(data_set_t), intent(in) :: set
      type(kept_t), intent(in) :: kept_ones(:)
      type(text_t), intent(inout) :: text
      character(name_columns) :: name
      character(value_columns) :: least
      character(number_columns), dimension(size(kept_ones)) :: at, asked
      integer :: i

      if (count(kept_ones%nearest%found) == 0) return
      at = figures_of(set%has_names(), kept_ones%nearest%at, kept_ones%nearest%found)
      asked = figures_of(set%has_names(), kept_ones%clearance%asked, kept_ones%nearest%found)
      call text%add('   CLEARANCE                                       AT LEAST             AT            ASKED')
      do i = 1, size(kept_ones)
         associate (kept => kept_ones(i), nearest => kept_ones(i)%nearest)
            if (.not. nearest%found) cycle
            name = name_of_clearance(set, kept%clearance, small=.false.)
            least = shown(nearest%low, -1)
            if (nearest%low <= -huge(1.0_wp)) least = 'NOT BOUNDED'
            call text%add('   '//name//adjustr(least)//at(i)//'  '//asked(i)//'  '//verdict(kept))
            if (nearest%high - nearest%low > certain*max(abs(nearest%low), abs(nearest%high), 1.0_wp)) &
               call text%add('     AT MOST '//shown(nearest%high, 1))
         end associate
      end do

   contains

      !> What is proven of a clearance.
      pure function verdict(kept) result(words)
         type(kept_t), intent(in) :: kept
         character(:), allocatable :: words

         if (kept%clearance%region == 0 .and. kept%nearest%high + kept%clearance%reach < 0.0_wp) then
            words = 'BROKEN, THE LINKS CROSS'
         else if (kept%is_broken) then
            words = 'BROKEN'
         else if (kept%nearest%low >= kept%clearance%asked) then
            words = 'KEPT'
         else
            words = 'NOT PROVEN'
         end if
      end function verdict
   end subroutine list_kept

   !> Deviations of the lengths for which the proof still holds.
   subroutine list_tolerance(study, text)
      type(proof_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text

      if (study%tolerance <= 0.0_wp) return
      call text%add('   PROVEN FOR DEVIATIONS OF ALL LENGTHS UP TO '//shown(study%tolerance, -1)// &
                    trim(merge(' (LARGER ONES NOT TRIED)', repeat(' ', 24), study%tolerance >= study%largest_tried)))
      if (study%worst_corner > 0.0_wp) call text%add('   THE WORST COMBINATION, TO FIRST ORDER, OPENS IT AT '// &
                                                     short(study%worst_corner))
   end subroutine list_tolerance

   !> Least and greatest values over what closes.
   subroutine list_extremes(mechanism, study, text)
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(number_format_t) :: of_places
      integer :: i

      if (count(study%extremes%found) == 0) return
      associate (of => study%extremes)
         of_places = format_of(mechanism%has_joint_names(), [of%least_at, of%greatest_at], [of%found, of%found])
      end associate
      call text%add(head_of_ranges)
      do i = 1, size(study%extremes)
         associate (extreme => study%extremes(i))
            if (extreme%found) call list_range(extreme_name(mechanism, extreme, small=.false.), &
                                               [extreme%least_low, extreme%greatest_low], &
                                               [extreme%least_high, extreme%greatest_high], &
                                               [extreme%least_at, extreme%greatest_at], of_places, text)
         end associate
      end do
   end subroutine list_extremes

   !> Least and greatest value of a quantity, each by the outer end of its bracket, rounded outwards, and where it is.
   subroutine list_range(name, low, high, at, format, text)
      character(*), intent(in) :: name
      real(wp), intent(in) :: low(2), high(2)  !! brackets of the least, of the greatest value
      real(wp), intent(in) :: at(2)            !! inputs, or positions
      type(number_format_t), intent(in) :: format   !! of them
      type(text_t), intent(inout) :: text
      character(value_columns) :: least, greatest

      least = shown(low(1), -1)
      greatest = shown(high(2), 1)
      call text%add('   '//left_column(name, quantity_columns, 0)//adjustr(least)//figure(at(1), format)// &
                    adjustr(greatest)//figure(at(2), format))
      if (is_wide(low(1), high(1))) call text%add('     LEAST NOT ABOVE '//shown(high(1), 1))
      if (is_wide(low(2), high(2))) call text%add('     GREATEST NOT BELOW '//shown(low(2), -1))

   contains

      pure logical function is_wide(low, high)
         real(wp), intent(in) :: low, high

         is_wide = high - low > certain*max(abs(low), abs(high), 1.0_wp)
      end function is_wide
   end subroutine list_range

   pure function extreme_name(mechanism, extreme, small) result(name)
      type(mechanism_t), intent(in) :: mechanism
      type(proven_extreme_t), intent(in) :: extreme
      logical, intent(in) :: small                 !! small letters, but for names
      character(:), allocatable :: name

      select case (extreme%kind)
      case (extreme_angle)
         name = cased('TRANSMISSION ANGLE, ', small)//group_heading(mechanism, extreme%loop, small)
      case (extreme_slide)
         name = arc_heading(mechanism, extreme%loop, extreme%place, small)
         if (index(name, cased('SLIDE', small)) /= 1) name = cased('SLIDE, ', small)//name
      case (extreme_x)
         name = cased('OUTPUT POINT, X', small)
      case (extreme_y)
         name = cased('OUTPUT POINT, Y', small)
      case (extreme_output)
         name = cased('OUTPUT ANGLE', small)
      case (extreme_distance)
         name = cased('DISTANCE OF THE OUTPUT POINT', small)
      case (extreme_slides)
         name = cased('ANGLE BETWEEN THE SLIDES, ', small)//group_heading(mechanism, extreme%loop, small)
      case default
         name = cased('VELOCITY RATIO', small)
      end select
   end function extreme_name

   !> Strokes of the output, dead points, dwells.
   subroutine list_movement(mechanism, study, text)
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: i, first

      associate (movement => study%movement)
         if (movement%turns_fully) call text%add('   THE OUTPUT TURNS FULLY')
         if (movement%has_output .and. movement%is_angle .and. .not. movement%turns_fully) &
            call text%add('   SWING OF THE OUTPUT AT MOST '//shown(movement%output(2)%high - movement%output(1)%low, 1))
         if (movement%has_ratio .and. .not. movement%ratio_bounded) call text%add('   VELOCITY RATIO NOT BOUNDED')
         if (movement%has_time_ratio) call text%add('   TIME RATIO AT LEAST '//shown(movement%time_ratio, -1))
         do i = 1, size(movement%dwells)
            associate (dwell => movement%dwells(i))
               call list_dwell('OUTPUT', study%dwell, dwell%at, dwell%from, dwell%to, study%proof%turns, text)
            end associate
         end do
         if (study%dwell > 0.0_wp .and. movement%has_ratio .and. size(movement%dwells) == 0) &
            call text%add('   NO DWELL: THE OUTPUT HAS NO DEAD POINT')
         first = 1
         do i = 1, size(movement%dead)
            if (i < size(movement%dead)) then
               if (same_quantity(movement%dead(i), movement%dead(i + 1))) cycle
            end if
            call list_dead_points(quantity_name(mechanism, movement%dead(i), small=.false.), movement%dead(first:i), &
                                  study%proof%turns, text)
            first = i + 1
         end do
      end associate
   end subroutine list_movement

   !> An output that stays where it is.
   subroutine list_dwell(name, amount, at, from, to, turns, text)
      character(*), intent(in) :: name
      real(wp), intent(in) :: amount, at, from, to
      logical, intent(in) :: turns             !! the input is an angle
      type(text_t), intent(inout) :: text

      call text%add('   DWELL, '//name//' WITHIN '//short(amount)//' OF ITS VALUE AT '//short(at)//': '// &
                    trim(adjustl(end_text(from, 1, turns)))//' TO '//trim(adjustl(end_text(to, -1, turns))))
   end subroutine list_dwell

   pure logical function same_quantity(one, other)
      type(proven_dead_point_t), intent(in) :: one, other

      same_quantity = one%kind == other%kind .and. one%loop == other%loop .and. one%place == other%place
   end function same_quantity

   !> Dead points of one link, slide or output.
   subroutine list_dead_points(name, dead, turns, text)
      character(*), intent(in) :: name
      type(proven_dead_point_t), intent(in) :: dead(:)
      logical, intent(in) :: turns             !! the input is an angle
      type(text_t), intent(inout) :: text
      character(*), parameter :: margin = '     '
      character(:), allocatable :: line, item
      integer :: i

      line = '   DEAD POINTS OF '//name//':'
      do i = 1, size(dead)
         if (dead(i)%high - dead(i)%low > certain*max(1.0_wp, abs(dead(i)%low))) then
            item = ' PERHAPS BETWEEN '//place_of(dead(i)%low, turns)//' AND '//place_of(dead(i)%high, turns)
         else
            item = ' '//short(0.5_wp*(dead(i)%low + dead(i)%high))
            if (dead(i)%at_end) then
               item = item//' (END OF THE RANGE)'
            else if (.not. dead(i)%reverses) then
               item = item//' (NO REVERSAL)'
            end if
         end if
         if (i < size(dead)) item = item//','
         if (len(line) + len(item) > list_columns) then
            call text%add(line)
            line = margin
         end if
         line = line//item
      end do
      call text%add(line)
   end subroutine list_dead_points

   pure function quantity_name(mechanism, dead, small) result(name)
      type(mechanism_t), intent(in) :: mechanism
      type(proven_dead_point_t), intent(in) :: dead
      logical, intent(in) :: small                 !! small letters, but for names
      character(:), allocatable :: name

      if (dead%kind == quantity_output) then
         name = cased('THE OUTPUT', small)
      else
         name = arc_heading(mechanism, dead%loop, dead%place, small)// &
                cased(', '//trim(merge('ITS TURNING', 'ITS LENGTH ', dead%kind == quantity_turning)), small)
      end if
   end function quantity_name

   !> An input in a line of words.
   function place_of(input, turns) result(text)
      real(wp), intent(in) :: input
      logical, intent(in) :: turns
      character(:), allocatable :: text

      text = short(input)
      if (.not. turns) text = full_precision(input)
   end function place_of

   !> Eight digits of a number, rounded down (-1) or up (+1).
   function shown(value, way) result(text)
      real(wp), intent(in) :: value
      integer, intent(in) :: way
      character(:), allocatable :: text
      character(24) :: digits
      real(dp) :: number, read_back, unit
      integer, parameter :: least_power = -4   ! of ten, of numbers without exponent
      character(10) :: layout
      integer :: i, power

      number = real(value, dp)
      if (.not. abs(number) <= huge(number)) then
         text = full_precision(value)
         return
      end if
      write (digits, '(es16.7e3)') number
      read (digits(index(digits, 'E') + 1:), *) power
      unit = 10.0_dp**(power - 7)
      layout = '(g16.8)'
      if (power >= least_power .and. power < -1) write (layout, '("(f24.",i0,")")') 7 - power   ! g would write an exponent
      if (power < least_power .and. abs(number) > 0.0_dp) layout = '(es16.7e2)'
      if (abs(power) >= 99) layout = '(es16.7e3)'
      do i = 0, 2
         write (digits, layout) number + real(way*i, dp)*unit
         read (digits, *) read_back
         if (real(way, dp)*(read_back - number) >= 0.0_dp) exit
      end do
      text = trim(adjustl(digits))
   end function shown

   !> A part of the range that closes, is open or is undecided; a bracket of an end is in the numbers of its neighbours.
   subroutine list_limit(mechanism, proof, i, text)
      type(mechanism_t), intent(in) :: mechanism
      type(proof_t), intent(in) :: proof
      integer, intent(in) :: i
      type(text_t), intent(inout) :: text

      associate (limit => proof%limits(i))
         select case (limit%kind)
         case (piece_closes)
            call text%add('   CLOSES '//end_text(limit%from, 1, proof%turns)//' TO '//end_text(limit%to, -1, proof%turns))
         case (piece_opens)
            call text%add('   OPENS  '//end_text(limit%from, 1, proof%turns)//' TO '//end_text(limit%to, -1, proof%turns)// &
                          ': '//group_heading(mechanism, limit%loop, .false.)//', '//cause_words(limit%cause))
         case (piece_undecided)
            if (is_end(proof, i) .and. limit%to - limit%from <= narrow*(proof%to - proof%from)) return
            call text%add('   UNDECIDED '//undecided_words(mechanism, proof, limit))
         end select
      end associate
   end subroutine list_limit

   !> True for a bracket between a part that closes and one that is open, or between parts that are open for two reasons.
   pure logical function is_end(proof, i)
      type(proof_t), intent(in) :: proof
      integer, intent(in) :: i

      is_end = .false.
      if (i == 1 .or. i == size(proof%limits)) return
      associate (before => proof%limits(i - 1), after => proof%limits(i + 1))
         is_end = before%kind /= after%kind .or. before%loop /= after%loop .or. before%cause /= after%cause
      end associate
   end function is_end

   function undecided_words(mechanism, proof, limit) result(words)
      type(mechanism_t), intent(in) :: mechanism
      type(proof_t), intent(in) :: proof
      type(limit_t), intent(in) :: limit
      character(:), allocatable :: words
      character(9) :: amount

      if (limit%to - limit%from <= narrow*(proof%to - proof%from)) then
         words = 'AT '//short(0.5_wp*(limit%from + limit%to))//': '
      else
         words = end_text(limit%from, -1, proof%turns)//' TO '//end_text(limit%to, 1, proof%turns)//': '
      end if
      if (limit%loop == 0) then
         words = words//'NOT EXAMINED, TOO MANY PARTS'
         return
      end if
      if (limit%touch == touch_exact) words = words//'CHANGE POINT, '
      words = words//group_heading(mechanism, limit%loop, .false.)
      if (limit%touch == touch_exact) then
         words = words//', THE LINKS IN ONE LINE EXACTLY; THE ASSEMBLY IS NOT DETERMINED BEYOND IT'
         return
      end if
      write (amount, '(es9.0e2)') real(min(max(limit%amount, tiny(1.0_wp)), 1.0_wp), dp)*1.5_dp
      words = words//', '//cause_words(limit%cause)//' OR NOT, WITHIN '//trim(adjustl(amount))
   end function undecided_words

   !> What does not close.
   pure function cause_words(cause) result(words)
      integer, intent(in) :: cause
      character(:), allocatable :: words

      select case (cause)
      case (cause_too_short)
         words = 'LINKS TOGETHER TOO SHORT'
      case (cause_difference)
         words = 'DIFFERENCE OF THE LINKS TOO GREAT'
      case (cause_guide)
         words = 'GUIDE TOO LONG'
      case (cause_link)
         words = 'LINK TOO SHORT FOR THE OFFSET OF THE SLIDE'
      case (cause_parallel)
         words = 'SLIDES PARALLEL'
      case default
         words = 'NOTHING IS KNOWN'
      end select
   end function cause_words

   !> Where the prescribed positions lie.
   subroutine list_circuits(study, text)
      type(proof_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: outside

      outside = count(study%circuit == 0)
      if (outside > 0) call text%add('   '//to_text(outside)//' OF '//to_text(size(study%circuit))// &
                                     ' PRESCRIBED POSITIONS LIE WHERE THE LINKAGE IS NOT PROVEN TO CLOSE')
      if (study%circuits > 1) then
         call text%add('   THE OTHERS LIE IN '//to_text(study%circuits)//' SEPARATE RANGES: WITH THESE SIGNS OF ASSEMBLY THE '// &
                       'INPUT CANNOT MOVE FROM ONE TO THE NEXT')
      else if (outside == 0) then
         call text%add('   ALL PRESCRIBED POSITIONS LIE IN ONE RANGE THAT CLOSES')
      end if
   end subroutine list_circuits

   !> What a remark says of a linkage that does not close over the whole range.
   function describe_proof(study) result(words)
      type(proof_study_t), intent(in) :: study
      character(:), allocatable :: words
      integer :: opens

      opens = count(study%proof%limits%kind == piece_opens)
      if (opens > 0) then
         words = 'the linkage is proven to open in '//to_text(opens)//trim(merge(' part ', ' parts', opens == 1))//' of the range'
      else
         words = 'the linkage is not proven to close over the whole range'
      end if
   end function describe_proof

   !> A number in as few digits as tell it.
   pure function short(value) result(text)
      real(wp), intent(in) :: value
      character(:), allocatable :: text

      text = number_words(value)
   end function short

   !> An end of a part, rounded down (-1) or up (+1) to the digits printed; a length has all its digits.
   function end_text(value, way, turns) result(text)
      real(wp), intent(in) :: value
      integer, intent(in) :: way
      logical, intent(in) :: turns
      character(:), allocatable :: text
      character(most_digits) :: digits
      character(16) :: layout
      real(dp) :: shown, number
      integer :: i

      if (.not. turns) then
         text = full_precision(value)
         return
      end if
      write (layout, '("(f",i0,".",i0,")")') most_digits, decimals
      number = real(value, dp)
      do i = 0, 2
         write (digits, layout) number + real(way*i, dp)*10.0_dp**(-decimals)
         if (index(digits, '*') > 0) then
            text = full_precision(value)   ! too many turns for the column
            return
         end if
         read (digits, *) shown
         if (real(way, dp)*(shown - number) >= 0.0_dp) exit
      end do
      text = right_column(trim(adjustl(digits)), width)
   end function end_text

   !> Tables: every part of the range, the brackets too; extremes, dead points, margins, clearances.
   subroutine put_proof(title, mechanism, study, tables)
      character(*), intent(in) :: title
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      character(*), parameter :: kinds(3) = [character(9) :: 'closes', 'opens', 'undecided']
      character(*), parameter :: causes(0:5) = [character(11) :: 'none', 'too_short', 'difference', 'guide', 'link', 'parallel']
      type(table_t) :: table

      table = table_of('limits', about_limits, notes=title)
      associate (limits => study%proof%limits)
         call table%add('kind', kinds(limits%kind))
         call table%add('from', limits%from, input_unit(.not. study%proof%turns))
         call table%add('to', limits%to, input_unit(.not. study%proof%turns))
         call table%add('loop', limits%loop)
         call table%add('cause', causes(limits%cause))
         call add_groups(mechanism, limits%loop, table)
      end associate
      call tables%put(table)
      call put_extremes(title, mechanism, study, tables)
      call put_margins(title, mechanism, study, tables)
      call put_kept(title, study%kept, input_unit(.not. study%proof%turns), tables)
   end subroutine put_proof

   !> Least clearances.
   subroutine put_kept(title, kept, input, tables)
      character(*), intent(in) :: title
      type(kept_t), intent(in) :: kept(:)
      character(*), intent(in) :: input       !! unit of the input
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer, allocatable :: found(:)
      integer :: i

      found = pack([(i, i=1, size(kept))], kept%nearest%found)
      if (size(found) == 0) return
      table = table_of('clearance', 'a row for each clearance asked for: brackets of the least', notes=title)
      associate (list => kept(found))
         call table%add('region', list%clearance%region)
         call table%add('link', [(kept(found(i))%clearance%segments(1), i=1, size(found))])
         call table%add('other', [(kept(found(i))%clearance%segments(2), i=1, size(found))])
         call table%add('low', list%nearest%low, 'length')
         call table%add('high', list%nearest%high, 'length')
         call table%add('at', list%nearest%at, input)
         call table%add('asked', list%clearance%asked, 'length')
      end associate
      call tables%put(table)
   end subroutine put_kept

   !> Least margins of the dyads.
   subroutine put_margins(title, mechanism, study, tables)
      character(*), intent(in) :: title
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: i

      if (size(study%margins) == 0) return
      table = table_of('margins', 'a row for each margin: brackets of the least; angles in degrees', notes=title)
      associate (margins => study%margins)
         call table%add('quantity', [(name_of(margins(i)%margin%kind), i=1, size(margins))])
         call table%add('loop', margins%margin%which)
         call table%add('low', margins%low)
         call table%add('high', margins%high)
         call table%add('at', margins%margin%delt, input_unit(.not. study%proof%turns))
         call add_groups(mechanism, margins%margin%which, table)
      end associate
      call tables%put(table)

   contains

      pure function name_of(kind) result(name)
         integer, intent(in) :: kind
         character(18) :: name

         select case (kind)
         case (margin_angle)
            name = 'transmission_angle'
         case (margin_slides)
            name = 'angle_of_slides'
         case (margin_guide)
            name = 'guide'
         case default
            name = 'offset'
         end select
      end function name_of
   end subroutine put_margins

   !> Extremes and dead points.
   subroutine put_extremes(title, mechanism, study, tables)
      character(*), intent(in) :: title
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      character(*), parameter :: quantities(8) = [character(18) :: 'transmission_angle', 'slide', 'output_x', 'output_y', &
                                                  'output_angle', 'output_distance', 'velocity_ratio', 'angle_of_slides']
      type(table_t) :: table
      type(strings_t), allocatable :: names(:)
      character(:), allocatable :: input
      integer :: i

      if (count(study%extremes%found) == 0) return ! nothing closes, nothing moves
      input = input_unit(.not. study%proof%turns)
      table = table_of('extremes', about_extremes, notes=title)
      associate (e => study%extremes(pack([(i, i=1, size(study%extremes))], study%extremes%found)))
         call table%add('quantity', quantities(e%kind))
         call table%add('loop', e%loop)
         call table%add('arc', e%place)
         call table%add('least_low', e%least_low)
         call table%add('least_high', e%least_high)
         call table%add('least_at', e%least_at, input)
         call table%add('greatest_low', e%greatest_low)
         call table%add('greatest_high', e%greatest_high)
         call table%add('greatest_at', e%greatest_at, input)
         if (mechanism%has_joint_names()) then
            allocate (names(size(e)))
            do i = 1, size(e)
               names(i)%text = extreme_name(mechanism, e(i), small=.true.)
            end do
            call add_words('of', names, table)
         end if
      end associate
      call tables%put(table)
      if (allocated(names)) deallocate (names)
      allocate (names(0))
      if (mechanism%has_joint_names()) then
         do i = 1, size(study%movement%dead)
            call add_string(names, quantity_name(mechanism, study%movement%dead(i), small=.true.))
         end do
      end if
      call put_dead_points(title, study%movement%dead, names, input, tables)
   end subroutine put_extremes

   !> Dead points.
   subroutine put_dead_points(title, dead, names, input, tables)
      character(*), intent(in) :: title
      type(proven_dead_point_t), intent(in) :: dead(:)
      type(strings_t), intent(in) :: names(:)  !! of a sketch what is at rest there, else none
      character(*), intent(in) :: input        !! its unit
      type(tables_t), intent(inout) :: tables
      character(*), parameter :: quantities(3) = [character(7) :: 'output', 'turning', 'sliding']
      type(table_t) :: table

      if (size(dead) == 0) return
      table = table_of('dead_points', 'a row for each dead point: brackets of the input', notes=title)
      call table%add('quantity', quantities(dead%kind))
      call table%add('loop', dead%loop)
      call table%add('arc', dead%place)
      call table%add('low', dead%low, input)
      call table%add('high', dead%high, input)
      call table%add('reverses', dead%reverses)
      if (size(names) > 0) call add_words('of', names, table)
      call tables%put(table)
   end subroutine put_dead_points
end module psalm_proof_list
