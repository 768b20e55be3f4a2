!> The notation of data sets by itself: cases and their groups, items by name, origins of values, the groups that are known.
program test_notation
   use check, only: checks_t
   use psalm_group, only: group_t, check_flags, check_range
   use psalm_group_table, only: is_users, nearest_group, program_of, program_reads
   use psalm_kinds, only: wp
   use psalm_namelist, only: case_text_t, read_case
   use psalm_origin, only: origins_t
   use psalm_rule, only: rule_t, a_flag, a_number, a_text, a_whole, a_word
   use psalm_search_group, only: search_group_t, read_search_group
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t, level_warning
   use psalm_take, only: take, take_count
   use psalm_text, only: text_t
   implicit none (type, external)
   type(checks_t) :: t

   call cases()
   call broken_cases()
   call items()
   call wrong_items()
   call rules()
   call origins()
   call table()
   call search_group()
   call t%report()

contains

   !> The group FIRST of a case whose groups stand in the lines given.
   subroutine read_group(text, group, findings)
      character(*), intent(in) :: text(:)
      type(group_t), intent(out) :: group
      type(diagnostics_t), intent(out) :: findings
      type(case_text_t) :: case
      type(line_t) :: lines(size(text) + 1)
      integer :: next

      lines(1)%text = 'TITLE'
      lines(2:) = as_lines(text)
      next = 1
      call read_case(lines, next, case, findings)
      if (case%count == 0) return
      group = case%groups(1)
      call group%sort_items()
   end subroutine read_group

   pure function as_lines(text) result(lines)
      character(*), intent(in) :: text(:)
      type(line_t) :: lines(size(text))
      integer :: i

      do i = 1, size(text)
         lines(i)%text = trim(text(i))
      end do
   end function as_lines

   subroutine cases()
      type(case_text_t) :: case
      type(diagnostics_t) :: findings
      integer :: next
      character(40), parameter :: text(*) = [character(40) :: '! a comment', '', 'THE FIRST', ' &one a=1 / $TWO', &
                                             ' b=2 ! &THREE', '$end', ' THE SECOND ', ' &ONE &END']

      next = 1
      call read_case(as_lines(text), next, case, findings)
      call t%equal_integer(findings%count, 0, 'both terminators, both marks, comments')
      call t%equal_text(case%title, 'THE FIRST', 'title behind comments and blank lines')
      call t%equal_integer(case%line, 3, 'line of the title')
      call t%equal_integer(case%count, 2, 'two groups, one of them begun on the line where the first ends')
      call t%equal_text(trim(case%groups(1)%name)//' '//trim(case%groups(2)%name), 'ONE TWO', 'names in capitals')
      call t%equal_integer(case%groups(2)%line, 4, 'line of a group')
      call t%equal_integer(next, 7, 'the next case begins at its title')
      call read_case(as_lines(text), next, case, findings)
      call t%equal_text(trim(adjustl(case%title)), 'THE SECOND', 'title of the second case')
      call t%is_true(next > size(text) .and. case%count == 1 .and. findings%count == 0, 'the second case ends the text')
      call read_case(as_lines(text), next, case, findings)
      call t%is_true(case%line == 0 .and. findings%count == 0, 'no case behind the last')
   end subroutine cases

   subroutine broken_cases()
      type(case_text_t) :: case
      type(diagnostics_t) :: findings
      integer :: next

      next = 1
      call read_case(as_lines([character(20) :: ' &ONE A=1 &END']), next, case, findings)
      call t%finds(findings, 'put a title line before it', 'a case without a title')
      call read_one([character(20) :: ' &ONE A=1', ' &TWO B=2 &END'], 'not closed before &TWO', 'a group that is not closed')
      call read_one([character(20) :: ' &ONE A=1'], 'not closed before the end of the file', 'a group the file ends in')
      call read_one([character(20) :: ' &ONE &END &ONE &END'], 'given twice', 'a group given twice')
      call read_one([character(20) :: " &ONE A='x &END"], 'not closed on its line', 'a quotation that is not closed')
      call read_one([character(20) :: ' &ONE A(1,2,3)=1 /'], 'more than two subscripts', 'three subscripts')
      call read_one([character(20) :: ' &ONE A()=1 /'], 'lacks a subscript', 'no subscript')
      call read_one([character(20) :: ' &ONE A(0)=1 /'], 'counted from 1', 'a subscript of 0')
      call read_one([character(20) :: ' &ONE A(1:3)=1 /'], 'is a section', 'a section')
   end subroutine broken_cases

   subroutine read_one(text, words, law)
      character(*), intent(in) :: text(:), words, law
      type(group_t) :: group
      type(diagnostics_t) :: findings

      call read_group(text, group, findings)
      call t%finds(findings, words, law)
   end subroutine read_one

   subroutine items()
      type(group_t) :: group
      type(diagnostics_t) :: findings
      character(:), allocatable :: word
      type(text_t) :: text
      integer :: whole, numbers(6)
      real(wp) :: number, reals(4)

      call read_group([character(40) :: ' &FIRST n=7, X=1.5d2', " w='lsq', L=3*4,,6", ' R(2)=2*-1., L(1)=9', ' /'], group, findings)
      call t%equal_integer(findings%count, 0, 'items without a fault')
      whole = 0
      number = 0.0_wp
      word = ''
      numbers = 0
      reals = 5.0_wp
      call group%get_integer('N', whole, findings)
      call group%get_real('X', number, findings)
      call group%get_word('W', word, findings)
      call group%get_integers('L', numbers, findings)
      call group%get_reals('R', reals, findings)
      call t%equal_integer(whole, 7, 'an integer; names in any case')
      call t%close_to(number, 150.0_wp, 0.0_wp, 'a real with the exponent D')
      call t%equal_text(word, 'LSQ', 'a word comes in capitals')
      call t%is_true(all(numbers == [9, 4, 4, 0, 6, 0]), 'repeat counts, a null value, one element set later')
      call t%is_true(all(abs(reals - [5.0_wp, -1.0_wp, -1.0_wp, 5.0_wp]) <= 0.0_wp), 'values from an element on')
      call t%is_true(group%given('L') .and. .not. group%given('M'), 'what is given')
      call t%equal_integer(group%item_line('W'), 3, 'line of an item')
      whole = 3
      call group%get_integer('ABSENT', whole, findings)
      call t%equal_integer(whole, 3, 'what is not given stays as it was')
      call group%finish([group], findings)
      call t%equal_integer(findings%count, 0, 'everything was asked for')

      call read_group([character(40) :: " &FIRST W='it''s', V=""a""""b""", ' /'], group, findings)
      call group%get_word('W', word, findings)
      call t%equal_text(word, "IT'S", 'an apostrophe is written twice')
      call group%get_word('V', word, findings)
      call t%equal_text(word, 'A"B', 'so is the other mark')
      call group%render(text)
      call t%is_true(index(text%content(), "W='it''s',") > 0, 'and so it is written again')
   end subroutine items

   subroutine wrong_items()
      type(group_t) :: group
      type(diagnostics_t) :: findings
      integer :: whole, numbers(2), flags(2, 1)

      call read_group([character(40) :: ' &FIRST NSTART=2.5, ITEMS=1,2,3', ' NSTRAT=4 FLAG=2 FLAGS=0,3', ' /'], group, findings)
      whole = 1
      numbers = 0
      call group%get_integer('NSTART', whole, findings)
      call t%finds(findings, &
                   "2: error: &FIRST NSTART: an integer is expected, not a real with a fraction or exponent; found '2.5'", &
                   'a real for an integer')
      call group%get_integers('ITEMS', numbers, findings)
      call t%finds(findings, "ITEMS: too many values: at most 2 are expected; the first one beyond is '3'", 'too many values')
      call group%follow([rule_t('FLAG', a_flag, '', '', '0', '', 'a flag')])
      call take(group, 'FLAG', whole, findings)
      call t%finds(findings, '3: error: &FIRST FLAG: must be from 0 to 1; found 2', 'a flag that is none')
      flags = 0
      call group%get_integers('FLAGS', flags(:, 1), findings)
      call check_flags(group, 'FLAGS', flags, findings)
      call t%finds(findings, 'FLAGS: entries are 0 (fixed) or 1 (may vary); found 3', 'flags that are none')
      call check_range(group, 'NBEST', 5, 1, huge(1), findings, must_be=.true.)
      call group%finish([group], findings)
      call t%finds(findings, 'NSTRAT: no such item; did you mean NSTART?', 'the nearest name')
      call t%finds(findings, 'NBEST: missing; this item is required', 'a required item')
   end subroutine wrong_items

   !> Values by the rules of a table.
   subroutine rules()
      type(rule_t), parameter :: table(*) = [ &
         rule_t('NROW', a_whole, '', '', '', '[0,9]', 'rows'), &
         rule_t('CELLS', a_number, 'NROW*3', '', '', '', 'three cells of each row'), &
         rule_t('SIZES', a_number, '1 to NROW', '', '2.5', '(0,)', 'sizes'), &
         rule_t('FORM', a_word, '', '', 'DISC', 'POINT DISC', 'the form'), &
         rule_t('PART', a_number, '', '', '0.5', '[0,1)', 'a part'), &
         rule_t('SENSE', a_whole, '', '', '1', '-1 1', 'a sense'), &
         rule_t('NEED', a_number, '', '', 'required', '', 'what is needed; and more'), &
         rule_t('DES#', a_number, 'n', '', '', '', 'values'), &
         rule_t('NAME', a_text, 'n', '', '', '', 'names')]
      type(group_t) :: group
      type(diagnostics_t) :: findings
      real(wp) :: sizes(3), part, need
      integer :: rows, form, sense

      call read_group([character(60) :: ' &FIRST CELLS=1,2,3,4,99*0.0, SIZES=1.0,-2.0', &
                       ' FORM=BALL, PART=1.0, SENSE=2', ' PRAT=1 /'], group, findings)
      call group%follow(table)
      call take_count(group, 'NROW', rows, findings)
      call t%equal_integer(rows, 2, 'a count that is not given is that of the longest item, without what fills it up')
      call take(group, 'SIZES', sizes, findings, repeated=.true.)
      call t%close_to(sizes(3), -2.0_wp, 0.0_wp, 'an entry that is not given is that before it')
      call t%finds(findings, 'SIZES: entry 2: must be above 0', 'the first entry that cannot be')
      call take(group, 'FORM', form, findings)
      call t%equal_integer(form, 2, 'a word that is not there leaves the default')
      call t%finds(findings, "FORM: 'POINT' or 'DISC' is expected; found 'BALL'", 'a word that is not there')
      call take(group, 'PART', part, findings)
      call t%finds(findings, 'PART: must lie between 0 and 1', 'the end of an open interval')
      call take(group, 'SENSE', sense, findings)
      call t%finds(findings, 'SENSE: must be -1 or 1; found 2', 'one of some integers')
      need = 7.0_wp
      call take(group, 'NEED', need, findings)
      call t%close_to(need, 7.0_wp, 0.0_wp, 'without a default the value stays')
      call group%finish([group], findings)
      call t%finds(findings, 'NEED: missing; this item is required: what is needed', 'what is required')
      call t%finds(findings, 'PRAT: no such item; did you mean PART?', 'names come from the table')
      call read_group([character(40) :: ' &FIRST NROW=12 /'], group, findings)
      call group%follow(table)
      call take_count(group, 'NROW', rows, findings)
      call t%finds(findings, 'NROW: must be from 0 to 9; found 12', 'a count out of range')
      call t%equal_integer(rows, 0, 'counts nothing')
      call take(group, 'PART', part, findings)
      call t%close_to(part, 0.5_wp, 0.0_wp, 'the default of the table')
   end subroutine rules

   subroutine origins()
      type(origins_t) :: all_origins, more
      type(diagnostics_t) :: findings
      integer :: k

      call all_origins%clear()
      call all_origins%mention('LINKS', '', 2)
      call all_origins%mention('LINKS', 'ARCL', 3)
      call all_origins%place(1, 2, 3)
      call all_origins%place(3, 4, 4)
      call all_origins%mention('LINKS', 'ARCL', 6)
      call all_origins%place(2, 2, 6)
      call t%equal_integer(all_origins%line('LINKS', 'ARCL', 1), 3, 'line of the first value')
      call t%equal_integer(all_origins%line('LINKS', 'ARCL', 2), 6, 'what was written last counts')
      call t%equal_integer(all_origins%line('LINKS', 'ARCL', 4), 4, 'line of a value in a further line')
      call t%equal_integer(all_origins%line('LINKS', 'ARCL', 9), 6, 'a value not given: line of the item')
      call t%equal_integer(all_origins%line('LINKS', 'GAMA', 1), 2, 'an item not given: line of the group')
      call t%equal_integer(all_origins%line('LIMITS', 'TANGLE', 1), 0, 'a group not given')
      call more%clear()
      call more%mention('LIMITS', '', 8)
      call more%mention('LIMITS', 'OPLOW', 9)
      call more%place(1, 3, 9)
      call all_origins%append(more)
      call t%equal_integer(all_origins%line('LIMITS', 'OPLOW', 3), 9, 'origins of another group, taken over')
      findings%file = 'a.nml'
      call all_origins%error(findings, 'LINKS', 'ARCL', 'is wrong', 2)
      call all_origins%warning(findings, 'LINKS', '', 'is odd')
      call all_origins%error(findings, 'LINKS', 'ARCL', 'is wrong, too', 2, row=2, columns=2)
      call t%finds(findings, 'a.nml:6: error: &LINKS ARCL: is wrong', 'an error in an element')
      call t%finds(findings, 'a.nml:2: warning: &LINKS: is odd', 'a warning about a group')
      call t%finds(findings, 'a.nml:4: error: &LINKS ARCL: is wrong, too', 'an error in an element of a row')
      do k = 1, 10
         call all_origins%error(findings, 'LIMITS', 'OPLOW', 'is wrong', 1)
      end do
      call t%equal_integer(findings%count, 9, 'of one kind a few are told')
      call t%finds(findings, 'a.nml:9: error: &LIMITS OPLOW: and 5 more', 'and the others counted')
   end subroutine origins

   subroutine table()
      call t%is_true(program_reads('kalm', 'RATES') .and. .not. program_reads('psalm', 'RATES'), 'RATES is of kalm')
      call t%is_true(program_reads('balm', 'LINKS') .and. .not. program_reads('alm', 'LINKS'), 'programs by their whole name')
      call t%is_true(program_of('NOSUCH') == '', 'an unknown group has no program')
      call t%is_true(is_users('USERDATA') .and. is_users('USER') .and. .not. is_users('MYUSER'), 'groups of the user')
      call t%equal_text(nearest_group('CONST'), 'CONSTR', 'the nearest group')
      call t%equal_text(nearest_group('QQQQQQQQ'), '', 'nothing is near')
   end subroutine table

   subroutine search_group()
      type(group_t) :: group
      type(diagnostics_t) :: findings
      type(search_group_t) :: search

      call group%begin('SEARCH', 0)
      call group%sort_items()
      call read_search_group(group, search, findings)
      call t%is_true(.not. search%given .and. search%solver%name == 'SIMPLEX' .and. search%nstart == 1, 'no group: one search')
      call read_group([character(60) :: " &SEARCH SOLVER='nlopt_ld_slsqp', NSTART=20 &END"], group, findings)
      call read_search_group(group, search, findings)
      call t%equal_text(trim(search%solver%name), 'LD_SLSQP', 'an algorithm of NLopt, with or without NLOPT_')
      call t%is_true(search%given .and. search%nstart == 20 .and. findings%count == 0, 'starts')
      call read_group([character(60) :: ' &SEARCH MAXEVAL=9, MAXTIME=-1.0, THREADS=5000 &END'], group, findings)
      call read_search_group(group, search, findings)
      call t%finds(findings, 'MAXEVAL: a simplex is searched to NITER', 'evaluations need another solver')
      call t%finds(findings, 'MAXTIME: must not be negative', 'a time below 0')
      call t%finds(findings, 'THREADS: must be from 0 to 1024', 'too many threads')
      call read_group([character(60) :: " &SEARCH SOLVER='LSQR' &END"], group, findings)
      call read_search_group(group, search, findings)
      call t%finds(findings, "did you mean 'LSQ'?", 'the nearest solver')
      call t%is_true(all(findings%list(:findings%count)%level /= level_warning), 'an unknown solver is an error')
   end subroutine search_group
end program test_notation
