!> The ranking of the linkages found in the listing: what makes them different, their margins, their quality and size.
module psalm_ranking_list
   use psalm_column_names, only: output_unit
   use psalm_columns, only: right_column
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_number_format, only: figures_of, in_a_row
   use psalm_output_targets, only: target_group_t, target_groups, first_target
   use psalm_parameters, only: name_of, words_of
   use psalm_ranking, only: ranked_t
   use psalm_search, only: result_t
   use psalm_search_group, only: pareto_none, pareto_largest, pareto_angle, pareto_ratio, pareto_room, pareto_band
   use psalm_summary_text, only: plain_number
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_solver_kind, only: family_simplex
   use psalm_text, only: text_t, rank_column, to_text
   implicit none (type, external)
   private
   public :: ranking_entry_t, list_ranking, put_ranking, bounds_reached, add_to_ranking, add_share, list_common_ranking

   character(*), parameter :: heads = &
      '      RMS ERROR  LARGEST ERROR  TRANSM. ANGLE LONGEST/SHORT.     ROOM WIDTH    ROOM HEIGHT TOLERANCE BAND'
   character(*), parameter :: none = '              -'   !! in a column of numbers
   integer, parameter :: quality_columns = 7              !! of `heads`
   real(wp), parameter :: at_bound = 1.0e-6_wp            !! relative distance from a bound that is reached
   real(wp), parameter :: percent = 100.0_wp

   integer, parameter :: title_width = 120                 !! of the title of a case, in the ranking of several
   !> A linkage in the ranking of several cases.
   type :: ranking_entry_t
      character(title_width) :: title = ''    !! of its case
      integer :: rank = 0                     !! in its case
      logical :: named = .false.              !! its joints have names: a sketch
      real(wp) :: objective = 0.0_wp
      type(ranked_t) :: is
   end type ranking_entry_t

contains

   !> Append both tables and what they mean.
   subroutine list_ranking(set, problem, found, ranked, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(result_t), intent(in) :: found
      type(ranked_t), intent(in) :: ranked(:)            !! shape (linkages found)
      type(text_t), intent(inout) :: text
      type(target_group_t), allocatable :: groups(:)
      character(:), allocatable :: line
      character(15) :: first(size(ranked), 5), cost(size(ranked)), qualities(size(ranked), quality_columns)
      integer :: i

      associate (named => set%has_names(), best => found%best(:size(ranked)))
         first(:, 1) = figures_of(named, best%objective, all_count=.true.)
         first(:, 2) = figures_of(named, ranked%angle_margin)
         first(:, 3) = figures_of(named, ranked%length_margin)
         first(:, 4) = figures_of(named, ranked%longest_arc)
         first(:, 5) = figures_of(named, best%distance)
         qualities = qualities_of(named, ranked)
         cost = figures_of(named, ranked%cost, ranked%has_cost .and. ranked%cost < huge(1.0_wp))
         where (cost == '') cost = none
      end associate
      call text%add()
      call text%add(' LINKAGES FOUND (DEVICE 7 HAS THEM ALL)')
      call text%add('  RANK      OBJECTIVE  ANGLE MARGIN LENGTH MARGIN    LONGEST ARC LARGEST CHANGE   START')
      do i = 1, size(ranked)
         line = to_text(found%best(i)%start)
         if (found%best(i)%start < 0) line = 'SUPPLIED '//to_text(-found%best(i)%start)
         if (found%best(i)%iteration > 0) line = line//' AT ITERATION '//to_text(found%best(i)%iteration)
         call text%add(rank_column(i)//in_a_row(first(i, :))//'   '//line)
      end do
      line = ''
      if (any(ranked%has_cost)) line = ' TOLERANCE COST'
      call text%add('  RANK'//heads//line//'   CRANK')
      do i = 1, size(ranked)
         if (any(ranked%has_cost)) line = cost(i)
         call text%add(rank_column(i)//in_a_row(qualities(i, :))//line//'   '//turning(ranked(i)))
      end do
      if (problem%blank) then
         groups = target_groups(set%sketch)
         ! outputs that are to be equal have no error of their own
         if (size(groups) > 0) call text%add(' ERRORS ARE THOSE OF '//trim(groups(first_target(groups))%name))
      end if
      call text%add(' LINKAGES DIFFER WHERE A LENGTH DOES BY MORE THAN '//plain_number(percent*set%search%differ)// &
                    ' PER CENT OF IT, OR AN ANGLE BY MORE THAN '//plain_number(degrees_per_radian*set%search%differ)// &
                    ' DEGREES (DIFFER='//plain_number(set%search%differ)//');')
      call text%add(' WHERE THE OBJECTIVES ARE THE SAME, IF A LENGTH DOES BY TEN TIMES AS MUCH')
      call text%add(' TRANSMISSION ANGLE AND ROOM: OVER THE FULL TURN, OR THE PRESCRIBED INPUTS WHERE THE CRANK DOES NOT TURN')
      if (set%search%nearly > 1.0_wp) call text%add(' THOSE WITH AN OBJECTIVE OF AT MOST '//plain_number(set%search%nearly)// &
         ' TIMES THE BEST STAND BY THEIR '//trim(merge('TOLERANCE COST', 'TOLERANCE BAND', all(ranked%has_cost)))//' (NEARLY)')
      if (set%toler%in_objective > 0.0_wp) call text%add(' THE OBJECTIVE HAS DEVIATIONS WITHIN TOLERANCES IN IT (TOLOBJ='// &
                                                         plain_number(set%toler%in_objective)//')')
      if (set%search%pareto /= pareto_none) call text%add(' NONE OF THEM IS BEATEN IN BOTH THE OBJECTIVE AND THE '// &
                                                          weighed(set%search%pareto))
      if (any(found%by_default)) call list_default_bounds(set, problem, found, text)
   end subroutine list_ranking

   !> What linkages are like, in columns under `heads`; `none` if it is not known, a band at a dead point is infinite.
   pure function qualities_of(named, ranked) result(texts)
      logical, intent(in) :: named                       !! joints have names: sketches
      type(ranked_t), intent(in) :: ranked(:)
      character(15) :: texts(size(ranked), quality_columns)

      texts(:, 1) = figures_of(named, ranked%rms, ranked%compared, all_count=.true.)
      texts(:, 2) = figures_of(named, ranked%largest, ranked%compared, all_count=.true.)
      texts(:, 3) = figures_of(named, ranked%angle, ranked%has_angle)
      texts(:, 4) = figures_of(named, ranked%ratio)
      texts(:, 5) = figures_of(named, ranked%width)
      texts(:, 6) = figures_of(named, ranked%height)
      texts(:, 7) = figures_of(named, ranked%band, ranked%has_band)
      where (ranked%has_band .and. ranked%band >= huge(1.0_wp)) texts(:, 7) = '       INFINITE'
      where (texts == '') texts = none
   end function qualities_of

   pure function turning(one) result(words)
      type(ranked_t), intent(in) :: one
      character(:), allocatable :: words

      words = trim(merge('TURNS   ', 'DOES NOT', one%turns))
      if (one%sliding_input) words = '    -'
   end function turning

   !> The linkages of a case join the ranking of several.
   pure subroutine add_to_ranking(set, found, ranked, entries)
      type(data_set_t), intent(in) :: set
      type(result_t), intent(in) :: found
      type(ranked_t), intent(in) :: ranked(:)            !! shape (linkages found)
      type(ranking_entry_t), allocatable, intent(inout) :: entries(:)
      type(ranking_entry_t), allocatable :: more(:)
      integer :: before, i

      before = 0
      if (allocated(entries)) before = size(entries)
      allocate (more(before + size(ranked)))
      if (before > 0) more(:before) = entries
      do i = 1, size(ranked)
         more(before + i)%title = set%title
         more(before + i)%rank = i
         more(before + i)%named = set%has_names()
         more(before + i)%objective = found%best(i)%objective
         more(before + i)%is = ranked(i)
      end do
      call move_alloc(more, entries)
   end subroutine add_to_ranking

   !> What a case that shares its starts with others had of them.
   subroutine add_share(set, found, shares)
      type(data_set_t), intent(in) :: set
      type(result_t), intent(in) :: found
      type(text_t), intent(inout) :: shares
      call shares%add(right_column(found%starts, 8, 1)//'   '//trim(adjustl(set%title)))
   end subroutine add_share

   !> Append the ranking of several cases, the best first.
   subroutine list_common_ranking(entries, shares, text)
      type(ranking_entry_t), intent(in) :: entries(:)
      type(text_t), intent(in) :: shares                 !! by `add_share`; empty: each had its own
      type(text_t), intent(inout) :: text
      logical :: left(size(entries))
      character(15) :: objective(size(entries)), qualities(size(entries), quality_columns)
      integer :: place, i

      objective = figures_of(all(entries%named), entries%objective, all_count=.true.)
      qualities = qualities_of(all(entries%named), entries%is)
      call text%add()
      call text%add(' RANKING OF ALL CASES')
      call text%add(' PLACE      OBJECTIVE'//heads//'   CRANK      CASE, RANK IN IT')
      left = .true.
      do place = 1, size(entries)
         i = minloc(entries%objective, dim=1, mask=left)
         left(i) = .false.
         associate (one => entries(i))
            call text%add(rank_column(place)//objective(i)//in_a_row(qualities(i, :))//'   '// &
                          padded(turning(one%is))//'   '//trim(adjustl(one%title))//', '//to_text(one%rank))
         end associate
      end do
      if (shares%length == 0) return
      call text%add(' STARTS THAT EACH CASE HAD (RANKING=2: ALL FROM FEW, THE BETTER HALF FROM TWICE AS MANY, AND SO ON)')
      call text%add_text(shares%content())
   end subroutine list_common_ranking

   pure function padded(words) result(column)
      character(*), intent(in) :: words
      character(8) :: column

      column = words
   end function padded

   !> Bounds of arcs' lengths that the data set did not give.
   subroutine list_default_bounds(set, problem, found, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(result_t), intent(in) :: found
      type(text_t), intent(inout) :: text
      integer :: v

      call text%add(' BOUNDS WHERE THE DATA SET GIVES NONE ('//set%bound_items(', ')//')')
      do v = 1, size(found%by_default)
         if (found%by_default(v)) call text%add('  '//name_of(problem%parameters%variables(v))//': '// &
                                                plain_number(found%low(v))//' TO '//plain_number(found%high(v)))
      end do
   end subroutine list_default_bounds

   !> Lengths of the best linkage at bounds that the data set did not give, or beyond them, in words; empty: there are none.
   function bounds_reached(set, problem, found) result(words)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(result_t), intent(in) :: found
      character(:), allocatable :: words
      type(dimensions_t) :: dimensions
      real(wp) :: longest
      logical :: beyond
      integer :: v

      words = ''
      beyond = .false.
      dimensions = problem%given
      call problem%parameters%apply(found%best(1)%values, dimensions)
      longest = maxval(dimensions%arcl)
      do v = 1, size(found%by_default)
         if (.not. found%by_default(v)) cycle
         associate (length => found%best(1)%values(v), low => found%low(v), high => found%high(v))
            if (length > low*(1.0_wp + at_bound) .and. length < high*(1.0_wp - at_bound)) cycle
            if (length < low*(1.0_wp - at_bound) .or. length > high*(1.0_wp + at_bound)) beyond = .true.
            if (len(words) > 0) words = words//', '
            words = words//words_of(problem%parameters%variables(v))//' ('//plain_number(length)
            if (length > 0.0_wp .and. longest > length) &
               words = words//', the longest '//trim(merge('length', 'arc   ', set%has_names()))//' is '// &
                       plain_number(longest/length)//' times as long'
            words = words//')'
         end associate
      end do
      if (len(words) == 0) return
      words = words//'; set '//set%bound_items(' and ')
      if (beyond) then
         words = 'beyond the bounds that hold where none are given, for no linkage found within them obeys: '//words
      else
         words = 'at the bound that holds where none is given: '//words
      end if
   end function bounds_reached

   pure function weighed(pareto) result(words)
      integer, intent(in) :: pareto
      character(:), allocatable :: words

      select case (pareto)
      case (pareto_largest)
         words = 'LARGEST ERROR'
      case (pareto_angle)
         words = 'TRANSMISSION ANGLE'
      case (pareto_ratio)
         words = 'RATIO OF LONGEST TO SHORTEST LINK'
      case (pareto_room)
         words = 'LONGER SIDE OF THE ROOM'
      case (pareto_band)
         words = 'TOLERANCE BAND'
      case default
         words = ''
      end select
   end function weighed

   !> Tables for other programs: ranking, and the dimensions that vary of each linkage.
   subroutine put_ranking(set, problem, found, ranked, tables)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(result_t), intent(in) :: found
      type(ranked_t), intent(in) :: ranked(:)            !! shape (linkages found)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(title_width), allocatable :: names(:)
      character(:), allocatable :: unit     ! of errors
      integer :: i, v

      unit = ''
      if (size(ranked) > 0) unit = trim(ranked(1)%error_unit)
      table = table_of('ranking', 'a row for each linkage found, the best first', audience=for_programs)
      call table%add('rank', [(i, i=1, size(ranked))])
      call table%add('objective', found%best(:size(ranked))%objective)
      call table%add('start', found%best(:size(ranked))%start)
      if (set%search%solver%family == family_simplex) call table%add('iteration', found%best(:size(ranked))%iteration)
      call table%add('change', found%best(:size(ranked))%distance)
      call table%add('angle_margin', ranked%angle_margin, 'deg')
      call table%add('length_margin', ranked%length_margin, 'length')
      call table%add('longest_arc', ranked%longest_arc, 'length')
      call table%add('rms_error', ranked%rms, unit, ranked%compared)
      call table%add('largest_error', ranked%largest, unit, ranked%compared)
      call table%add('transmission', ranked%angle, 'deg', ranked%has_angle)
      call table%add('longest_to_shortest', ranked%ratio)
      call table%add('room_width', ranked%width, 'length')
      call table%add('room_height', ranked%height, 'length')
      call table%add('tolerance_band', ranked%band, output_unit(problem%output%kind%angle == 1), ranked%has_band)
      if (any(ranked%has_cost)) call table%add('tolerance_cost', ranked%cost, known=ranked%has_cost)
      call table%add('turns', ranked%turns, .not. ranked%sliding_input)
      call tables%put(table)

      associate (variables => problem%parameters%variables, best => found%best)
         allocate (names(size(variables)*size(ranked)))
         do i = 1, size(names)
            names(i) = words_of(variables(modulo(i - 1, size(variables)) + 1))
         end do
         table = table_of('ranked_dimensions', 'a row for each linkage found and dimension that varies: length or degrees', &
                          audience=for_programs)
         call table%add('rank', [((i, v=1, size(variables)), i=1, size(ranked))])
         call table%add('dimension', names)
         call table%add('value', [(best(i)%values(:size(variables)), i=1, size(ranked))])
      end associate
      call tables%put(table)
   end subroutine put_ranking
end module psalm_ranking_list
