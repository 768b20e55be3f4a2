!> Allotted tolerances in the listing and in tables.
module psalm_allocation_list
   use psalm_allocation, only: allocation_t
   use psalm_allocation_terms, only: item_name
   use psalm_cheapest_tolerances, only: limit_largest, limit_least, wider
   use psalm_allocation_proof, only: band_certified, band_violated
   use psalm_allocation_group, only: rule_square, rule_worst, rule_yield
   use psalm_column_names, only: input_name, input_unit, position_name
   use psalm_columns, only: left_column, right_column
   use psalm_joint_play, only: play_t, play_across, play_loaded
   use psalm_kinds, only: wp
   use psalm_number_format, only: error_words, figures_of, in_sentence, number_words
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t, fixed, lower_case, to_text, upper_case
   implicit none (type, external)
   private
   public :: list_allocation, put_allocation

   real(wp), parameter :: percent = 0.01_wp
   real(wp), parameter :: full = 1.0e-6_wp      !! part of a band that is left where it is full
   integer, parameter :: name_columns = 32
   integer, parameter :: limit_room = 7
   integer, parameter :: step_column = 91       !! characters before the grade or step
   integer, parameter :: verdict_room = 10
   integer, parameter :: gap_room = 26

contains

   !> Append the tolerances, then the bands that limit them.
   subroutine list_allocation(named, result, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(allocation_t), intent(in) :: result
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      character(15), dimension(size(result%names)) :: tolerance, cost, worth
      character(15), dimension(size(result%bands)) :: input, width, saves, all_input, all_width
      logical :: is_full(size(result%bands))
      integer :: i, j

      tolerance = figures_of(named, result%tolerance)
      cost = figures_of(named, result%cost)
      worth = figures_of(named, percent*result%worth)
      associate (of => result%bands)
         is_full = of%used >= (1.0_wp - full)*result%scaled*of%width
         input = figures_of(named, result%input(of%position), is_full)
         width = figures_of(named, of%width, is_full)
         saves = figures_of(named, percent*of%price, is_full)
         all_input = figures_of(named, result%input(of%position))
         all_width = figures_of(named, of%width)
      end associate
      call text%add()
      select case (result%rule)
      case (rule_worst)
         call text%add(' CHEAPEST TOLERANCES WITHIN THE BANDS: WORST CASE')
      case (rule_square)
         call text%add(' CHEAPEST TOLERANCES WITHIN THE BANDS: ROOT SUM SQUARE')
      case (rule_yield)
         call text%add(' CHEAPEST TOLERANCES WITHIN THE BANDS: '//part_words(result%yield)// &
                       ' PER CENT AT EACH POSITION')
      end select
      call text%add(' COST'//in_sentence(named, result%value)//'   LOWER BOUND'//in_sentence(named, result%bound)// &
                    trim(merge('   GAP        ', '   DUALITY GAP', result%in_steps))// &
                    error_words(named, result%value - result%bound))
      if (result%in_steps) then
         line = ' NODES OF THE SEARCH FOR GRADES AND STEPS '//to_text(result%nodes)
         if (result%proven) then
            line = line//', NO CHOICE IS CHEAPER'
            if (result%wider_saves >= 0.0_wp) line = line//'; ALL BANDS WIDER BY '//to_text(nint(wider/percent))// &
                                                     ' PER CENT SAVE'//in_sentence(named, result%wider_saves)
         else
            line = line//', ENDED EARLY'
         end if
         call text%add(line)
      end if
      if (result%with_given) call text%add(' COST OF THE TOLERANCES OF TOLER'//in_sentence(named, result%cost_of_given)// &
         ', WHICH TAKE UP AT MOST '//part_words(result%use_of_given)//' PER CENT OF A BAND')
      line = ' DIMENSION                       TOLERANCE (+-)           COST  PER CENT'
      if (.not. result%in_steps) line = line//'          WORTH'
      line = line//'  LIMIT    CLASS'
      if (result%in_steps) line = line//'  STEP'
      call text%add(line)
      do i = 1, size(result%names)
         line = ' '//trim(result%names(i))
         line = left_column(line, name_columns)//tolerance(i)//cost(i)// &
                fixed(result%cost(i)/result%value/percent, 10, 2)
         if (.not. result%in_steps) line = line//worth(i)
         line = line//'  '//limit_of(i)
         if (result%class(i) > 0) line = line//'  '//to_text(result%class(i))
         if (result%in_steps .and. result%step(i) > 0) line = left_column(line, step_column)//step_name(i)
         call text%add(trim(line))
      end do
      call text%add()
      if (result%in_steps) then
         call text%add(' BANDS THAT ARE FULL')
         call text%add(' NUMBER          POSITION          INPUT      BAND (+-)')
      else
         call text%add(' BANDS THAT ARE FULL: WHAT A BAND WIDER BY 1 PER CENT SAVES')
         call text%add(' NUMBER          POSITION          INPUT      BAND (+-)          SAVES')
      end if
      do j = 1, size(result%bands)
         if (.not. is_full(j)) cycle
         line = ' '//trim(result%numbers(result%bands(j)%number))
         if (.not. named) line = upper_case(line)
         line = left_column(line, 17)//right_column(result%bands(j)%position, 8)//input(j)//width(j)
         if (.not. result%in_steps) line = line//saves(j)
         call text%add(line)
      end do
      if (.not. any(is_full)) then
         line = ' NONE'
         if (.not. result%in_steps) line = line//': EVERY TOLERANCE IS THE LARGEST'
         call text%add(line)
      end if
      if (size(result%plays) > 0) call list_plays()
      if (result%proof%asked) call list_proof()
      if (result%sample%trials == 0) return
      line = ' LINKAGES OF THE SAMPLE '//to_text(result%sample%trials)//', WITHIN ALL BANDS '//to_text(result%sample%kept)//' ('
      line = line//part_words(real(result%sample%kept, wp)/real(result%sample%trials, wp))//' PER CENT)'
      call text%add(line//', THAT DO NOT CLOSE '//to_text(result%sample%open))

   contains

      !> A grade, or the number of a step in its table.
      pure function step_name(i) result(name)
         integer, intent(in) :: i
         character(:), allocatable :: name

         name = to_text(result%step(i))
         if (result%graded(i)) name = 'IT'//name
      end function step_name

      !> A part in per cent.
      pure function part_words(part) result(words)
         real(wp), intent(in) :: part
         character(:), allocatable :: words

         words = trim(adjustl(in_sentence(named, part/percent)))
      end function part_words

      !> Where the gaps of joints with clearance lie, and their loads.
      subroutine list_plays()
         character(15), dimension(size(result%plays)) :: least, most
         integer :: p

         least = figures_of(named, result%plays%least, result%plays%asked)
         most = figures_of(named, result%plays%most, result%plays%asked)
         call text%add()
         line = ' JOINTS WITH CLEARANCE            GAP'
         if (any(result%plays%asked)) line = left_column(line, name_columns + 2 + gap_room)//'LEAST LOAD (N)   LARGEST (N)'
         call text%add(line)
         do p = 1, size(result%plays)
            associate (play => result%plays(p))
               line = left_column(' '//trim(play%name), name_columns + 2)//upper_case(gap_words(play))
               if (play%asked) line = left_column(line, name_columns + 2 + gap_room)//least(p)(2:)//most(p)
               call text%add(trim(line))
            end associate
         end do
      end subroutine list_plays

      !> What is proven of the bands that are full, and of those that are not kept.
      subroutine list_proof()
         character(15), dimension(size(result%bands)) :: low, high, corner
         logical :: shown(size(result%bands))

         associate (proof => result%proof)
            shown = is_full .or. proof%verdict /= band_certified
            low = figures_of(named, proof%low, shown .and. proof%known)
            high = figures_of(named, proof%high, shown .and. proof%known)
            corner = figures_of(named, proof%corner, shown .and. proof%verdict /= band_certified .and. &
                                proof%corner < huge(1.0_wp))
            call text%add()
            call text%add(' PROOF OF THE WORST CASE: '//to_text(count(proof%verdict == band_certified))//' OF '// &
                          to_text(size(proof%verdict))//' BANDS CERTIFIED')
            if (result%scaled < 1.0_wp) then
               call text%add(' ALL TOLERANCES WERE MULTIPLIED BY '//trim(adjustl(in_sentence(named, result%scaled)))//' FOR IT')
            else if (proof%factor > 0.0_wp .and. proof%factor < 1.0_wp) then
               call text%add(' ALL TOLERANCES TIMES '//trim(adjustl(in_sentence(named, proof%factor)))// &
                             ' WOULD CERTIFY ALL BANDS')
            end if
            if (.not. any(shown)) return
            call text%add(' NUMBER          POSITION          INPUT      BAND (+-)         LOWEST        HIGHEST  VERDICT'// &
                          '           CORNER')
            do j = 1, size(result%bands)
               if (.not. shown(j)) cycle
               line = ' '//trim(result%numbers(result%bands(j)%number))
               if (.not. named) line = upper_case(line)
               line = left_column(line, 17)//right_column(result%bands(j)%position, 8)//all_input(j)//all_width(j)//low(j)//high(j)
               line = line//'  '//verdict_words(proof%verdict(j))
               if (proof%verdict(j) /= band_certified) then
                  if (proof%corner(j) < huge(1.0_wp)) then
                     line = line//corner(j)
                  else
                     line = line//' DOES NOT CLOSE'
                  end if
               end if
               call text%add(trim(line))
            end do
         end associate
      end subroutine list_proof

      pure function limit_of(i) result(word)
         integer, intent(in) :: i
         character(limit_room) :: word

         word = '-'
         if (result%limit(i) == limit_least) word = 'LEAST'
         if (result%limit(i) == limit_largest) word = 'LARGEST'
      end function limit_of
   end subroutine list_allocation

   !> Where a gap lies.
   pure function gap_words(play) result(words)
      type(play_t), intent(in) :: play
      character(gap_room) :: words

      select case (play%kind)
      case (play_loaded)
         words = 'on the side of the load'
      case (play_across)
         words = 'to either side'
      case default
         words = 'anywhere'
      end select
   end function gap_words

   !> What is proven of a band.
   pure function verdict_words(verdict) result(words)
      integer, intent(in) :: verdict
      character(verdict_room) :: words

      select case (verdict)
      case (band_certified)
         words = 'CERTIFIED'
      case (band_violated)
         words = 'VIOLATED'
      case default
         words = 'UNDECIDED'
      end select
   end function verdict_words

   !> The tables `allocation`, `allocation_bands`, and with clearances `clearances` and `clearance_effects`.
   subroutine put_allocation(sliding_input, result, tables)
      logical, intent(in) :: sliding_input
      type(allocation_t), intent(in) :: result
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: i
      character(len=limit_room) :: limits(size(result%names))
      character(verdict_room) :: verdicts(size(result%bands))
      character(len(result%names)), allocatable :: names(:)

      table = table_of('allocation', 'a row for each dimension: its cheapest tolerance; cost '// &
                       number_words(result%value)//', at least '//number_words(result%bound), &
                       audience=for_programs)
      names = result%names
      do i = 1, size(names)
         names(i) = item_name(result%names(i))
      end do
      call table%add('dimension', names)
      call table%add('angle', result%is_angle)
      call table%add('tolerance', result%tolerance)
      call table%add('cost', result%cost)
      limits = 'none'
      where (result%limit == limit_least) limits = 'least'
      where (result%limit == limit_largest) limits = 'largest'
      call table%add('limit', limits)
      call table%add('class', result%class)
      if (.not. result%in_steps) then
         call table%add('worth', result%worth)
      else
         call table%add('grade', merge(result%step, 0, result%graded))
         call table%add('step', merge(result%step, 0, .not. result%graded))
      end if
      call tables%put(table)
      table = table_of('allocation_bands', 'a row for each number of an output and position that has a band (+-)')
      associate (bands => result%bands)
         call table%add('number', [character(len(result%numbers)) :: (result%numbers(bands(i)%number), i=1, size(bands))])
         call table%add(position_name, bands%position)
         call table%add(input_name(), result%input(bands%position), input_unit(sliding_input))
         call table%add('band', bands%width)
         call table%add('used', bands%used)
         if (.not. result%in_steps) call table%add('price', bands%price)
         call table%add('share_within', bands%share)
         if (result%proof%asked) then
            call table%add('lowest', result%proof%low, known=result%proof%known)
            call table%add('highest', result%proof%high, known=result%proof%known)
            do i = 1, size(bands)
               verdicts(i) = lower_case(verdict_words(result%proof%verdict(i)))
            end do
            call table%add('proof', verdicts)
         end if
         if (result%sample%trials > 0) then
            call table%add('sample_beyond', [(result%sample%beyond(bands(i)%position, result%columns(i)), i=1, size(bands))])
            call table%add('sample_lowest', [(result%sample%low(bands(i)%position, result%columns(i)), i=1, size(bands))], &
                           known=spread(result%sample%any_closed, 1, size(bands)))
            call table%add('sample_highest', [(result%sample%high(bands(i)%position, result%columns(i)), i=1, size(bands))], &
                           known=spread(result%sample%any_closed, 1, size(bands)))
         end if
      end associate
      call tables%put(table)
      if (size(result%plays) > 0) call put_plays(sliding_input, result, tables)
   end subroutine put_allocation

   !> Joints with clearance, and the effects of their gaps.
   subroutine put_plays(sliding_input, result, tables)
      logical, intent(in) :: sliding_input
      type(allocation_t), intent(in) :: result
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(len(result%names)), allocatable :: names(:)
      integer, allocatable :: play(:), band(:)
      integer :: i, k, n, bands

      n = size(result%plays)
      bands = size(result%bands)
      names = [character(len(result%names)) :: (item_name(result%plays(i)%name), i=1, n)]
      associate (plays => result%plays)
         table = table_of('clearances', 'a row for each joint with clearance: where its gap lies', audience=for_programs)
         call table%add('dimension', names)
         call table%add('gap', [(gap_words(plays(i)), i=1, n)])
         call table%add('least_load', plays%least, 'N', known=plays%asked)
         call table%add('largest_load', plays%most, 'N', known=plays%asked)
         call tables%put(table)
         table = table_of('clearance_effects', 'a row for each joint with clearance and each band: change of the output by a '// &
                          'gap along x and y (of a slide: across it, and 0), and by the clearance', audience=for_programs)
         play = [((i, k=1, bands), i=1, n)]
         band = [((k, k=1, bands), i=1, n)]
         call table%add('dimension', names(play))
         call table%add('number', [character(len(result%numbers)) :: &
                                   (result%numbers(result%bands(band(i))%number), i=1, size(band))])
         call table%add(position_name, result%bands(band)%position)
         call table%add(input_name(), result%input(result%bands(band)%position), input_unit(sliding_input))
         call table%add('by_x', [(plays(play(i))%by_gap(1, result%bands(band(i))%position, result%bands(band(i))%number), &
                                  i=1, size(band))])
         call table%add('by_y', [(plays(play(i))%by_gap(2, result%bands(band(i))%position, result%bands(band(i))%number), &
                                  i=1, size(band))])
         call table%add('by_clearance', [(plays(play(i))%change(result%bands(band(i))%position, result%bands(band(i))%number), &
                                          i=1, size(band))])
         call tables%put(table)
      end associate
   end subroutine put_plays
end module psalm_allocation_list
