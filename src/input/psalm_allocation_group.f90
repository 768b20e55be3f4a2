!> The group ALLOC: bands of the outputs, and what tolerances cost: the cheapest tolerances within the bands are wanted.
module psalm_allocation_group
   use psalm_case_group, only: case_group_t, place_visitor_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_number, a_text, a_whole, a_word
   use psalm_status, only: diagnostics_t
   use psalm_sum_law, only: law_uniform
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: allocation_items
   public :: allocation_group_t, allocation_of
   public :: rule_worst, rule_square, rule_yield
   public :: proof_none, proof_scale

   integer, parameter :: rule_worst = 1, rule_square = 2, rule_yield = 3 !! words of ALRULE in their order
   integer, parameter :: proof_none = 1, proof_scale = 3 !! words of ALPROF in their order; between them: the bands as they are
   real(wp), parameter :: percent = 0.01_wp
   real(wp), parameter :: per_metre = 1000.0_wp  !! millimetres
   integer, parameter :: first_grade = 5, grades = 9 !! of ISO 286, up to IT13
   integer, parameter :: most_steps = 500        !! of all tables
   integer, parameter :: text_length = 120       !! characters of a name

   type, extends(case_group_t) :: allocation_group_t
      real(wp), allocatable :: bands(:)        !! ALBAND: one for all outputs, or one for each
      character(text_length), allocatable :: outputs(:) !! ALOUT: numbers of outputs that have bands; none: all of the first output
      real(wp), allocatable :: factors(:)      !! ALPOS: of the bands at every position; none: 1
      integer :: rule = rule_worst             !! ALRULE: one of `rule_...`
      real(wp) :: yield = 0.9973_wp            !! ALYLD: share of the linkages
      integer :: law = law_uniform             !! ALLAW: one of `law_...`, the words in their order
      character(text_length), allocatable :: names(:) !! ALNAM: dimensions with entries of their own
      real(wp), allocatable :: fixed(:)        !! ALFIX, shape (names): part of the cost that does not depend on the tolerance
      real(wp), allocatable :: cost(:)         !! ALCOST: of a tolerance of 1; 0: as by default
      real(wp), allocatable :: power(:)        !! ALEXP
      real(wp), allocatable :: low(:), high(:) !! ALMIN, ALMAX; 0: as by default
      integer, allocatable :: class(:)         !! ALCLAS; 0: in none
      integer, allocatable :: finest(:), coarsest(:) !! ALGRAD, ALGRDC, shape (names): grades of ISO 286; finest 0: none
      integer, allocatable :: table(:)         !! ALTAB, shape (names): number of a table of steps; 0: none
      real(wp) :: millimetres = 1.0_wp         !! ALUNIT: in one unit of length
      logical :: unit_given = .false.          !! ALUNIT was
      real(wp), allocatable :: grade_cost(:)   !! ALGCST: of the grades from IT5 on; none: by the formula
      real(wp), allocatable :: step(:), step_cost(:) !! ALSTEP, ALSCST: tolerances of the tables and their costs
      integer, allocatable :: step_table(:)    !! ALSTAB, shape (steps): the table it belongs to
      integer, allocatable :: group(:)         !! ALGRP, shape (names): correlated group, below 0: against its others; 0: in none
      real(wp), allocatable :: correlation(:)  !! ALCORR, by group
      type(place_t), allocatable :: plays(:)   !! PLINK, PLOOP: joints with clearance; of a sketch PNAME
      character(text_length), allocatable :: play_names(:) !! PNAME, shape (plays) of a sketch, else 0
      integer, allocatable :: loaded(:)        !! PLOAD, shape (plays): 1: on the side of the load
      real(wp), allocatable :: play_given(:)   !! PGIVEN, shape (plays): clearance of today, user's length
      integer :: most_nodes = 0                !! ALNODE: of the search for grades and steps
      integer :: proof = proof_none            !! ALPROF: one of `proof_...`
      integer :: trials = 0                    !! ALTRY: linkages of the sample
   contains
      procedure :: read => read_allocation
      procedure :: visit_places => visit_allocation
   end type allocation_group_t

   !> The items of the group.
   type(rule_t), parameter :: allocation_items(*) = [ &
      rule_t('ALBAND', a_number, 'n', '', 'required', '(0,)', &
             'largest deviation of the output to either side: one for all its numbers, or one for each of ALOUT'), &
      rule_t('ALOUT', a_text, 'n', '', '', '', &
             'outputs that have bands, by the names of their columns (`''point_P.x''`); without it all numbers of the first '// &
             'output'), &
      rule_t('ALPOS', a_number, 'n', '', '1', '[0,)', &
             'factor of the bands at every position; 0: no band there'), &
      rule_t('ALRULE', a_word, '', '', 'WORST', 'WORST RSS YIELD', &
             'what keeps within the band: the worst case, the root-sum-square, or a share of the linkages'), &
      rule_t('ALYLD', a_number, '', 'per cent', '99.73', '(0,100)', &
             'that share, at every position, with YIELD'), &
      rule_t('ALLAW', a_word, '', '', 'UNIFORM', 'UNIFORM TRIANGLE NORMAL', &
             'how dimensions deviate within their tolerances, for YIELD and the sample; NORMAL: a tolerance is three standard '// &
             'deviations'), &
      rule_t('ALNAM', a_text, 'n', '', '', '', &
             'dimensions with entries of their own in the next items, by the names of the listing: `''length A B''`; '// &
             '`''length *''`: all lengths, `''angle *''`: all angles, `''play *''`: all clearances, `''*''`: all'), &
      rule_t('ALCOST', a_number, 'n', '', '', '[0,)', &
             'cost B of a tolerance of 1, in the order of ALNAM; 0 or not given: 1 for a length, for an angle that of the '// &
             'length by which it moves the end of an arc of mean length'), &
      rule_t('ALEXP', a_number, 'n', '', '1', '(0,10]', &
             'exponent K of the cost A + B/T**K, in the order of ALNAM'), &
      rule_t('ALFIX', a_number, 'n', '', '0', '[0,)', &
             'cost A that does not depend on the tolerance, in the order of ALNAM'), &
      rule_t('ALMIN', a_number, 'n', '', '0', '[0,)', &
             'least tolerance, in the order of ALNAM'), &
      rule_t('ALMAX', a_number, 'n', '', '0', '[0,)', &
             'largest tolerance, in the order of ALNAM; 0: a tenth of the length, 5 degrees'), &
      rule_t('ALCLAS', a_whole, 'n', '', '0', '[0,)', &
             'class, in the order of ALNAM: tolerances of a class are equal; 0: in none'), &
      rule_t('ALGRAD', a_whole, 'n', '', '0', '[0,13]', &
             'finest grade of ISO 286 that the length may have, 5 to 13, in the order of ALNAM: its tolerance is half the '// &
             'width of a grade; 0: any tolerance'), &
      rule_t('ALGRDC', a_whole, 'n', '', '13', '[5,13]', &
             'coarsest grade, in the order of ALNAM'), &
      rule_t('ALGCST', a_number, '9', '', '', '(0,)', &
             'costs of the grades IT5 to IT13: a grade costs A + B times that (B: ALCOST, by default 1); without it '// &
             'A + B/T**K'), &
      rule_t('ALUNIT', a_number, '', 'mm', '1', '(0,)', &
             'millimetres in one unit of length, for the grades; with UNITL of &MASSES that by default'), &
      rule_t('ALTAB', a_whole, 'n', '', '0', '[0,)', &
             'table of the steps that the tolerance has, in the order of ALNAM; 0: any tolerance'), &
      rule_t('ALSTEP', a_number, 'n', '', '', '(0,)', &
             'tolerances of the steps of all tables'), &
      rule_t('ALSCST', a_number, 'n', '', '', '(0,)', &
             'costs of the steps, in their order: a step costs A + B times that (B: ALCOST, by default 1)'), &
      rule_t('ALSTAB', a_whole, 'n', '', '1', '[1,)', &
             'table that each of these steps belongs to'), &
      rule_t('ALGRP', a_whole, 'n', '', '0', '[-99,99]', &
             'correlated group, in the order of ALNAM: deviations of a group have a part in common; negative: it is turned '// &
             'round in this dimension; 0: in none'), &
      rule_t('ALCORR', a_number, 'n', '', '1', '[0,1]', &
             'correlation of two deviations of each of these groups; 1: they deviate as one'), &
      rule_t('NPLAY', a_whole, '', '', 'as many as the longest item has', '[0,1000]', &
             'joints with clearance'), &
      rule_t('PLINK', a_whole, 'NPLAY', '', 'required', '', &
             'the joint at the finish of this arc; negative: at its start'), &
      rule_t('PLOOP', a_whole, 'NPLAY', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('PNAME', a_text, 'NPLAY', '', '', '', &
             'of a sketch, in place of both: the joint or slide; where a joint pins more than two links with '// &
             'the one that turns in it, `''B rod''`'), &
      rule_t('PLOAD', a_whole, 'NPLAY', '', '0', '[0,1]', &
             '0: the gap may lie in any direction; 1: on the side to which the load of the case presses'), &
      rule_t('PGIVEN', a_number, 'NPLAY', 'length', '0', '[0,)', &
             'clearance of today, for the comparison with &TOLER: radial, of a slide to either side; 0: there is no comparison'), &
      rule_t('ALNODE', a_whole, '', '', '100000', '[1,1000000000]', &
             'nodes of the search for grades and steps at most'), &
      rule_t('ALPROF', a_word, '', '', 'NO', 'NO CHECK SCALE', &
             'proof of the worst case: whether every linkage within the tolerances keeps the bands; SCALE: all tolerances are '// &
             'multiplied by the factor that makes it so'), &
      rule_t('ALTRY', a_whole, '', '', '0', '[0,1000000000]', &
             'linkages of a Monte-Carlo sample within the tolerances found')]

contains

   !> Read the group. Errors: more entries than names, a least tolerance above the largest.
   subroutine read_allocation(self, group, about, findings)
      class(allocation_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: texts(:)
      integer :: last, n, i

      self%given = group%line > 0
      call group%follow(allocation_items)
      call group%get_texts('ALOUT', texts, findings)
      self%outputs = [character(text_length) :: (adjustl(texts(i)), i=1, size(texts))]
      allocate (self%bands(max(1, size(texts))))
      call take(group, 'ALBAND', self%bands, findings, last=last, repeated=.true.)
      if (last > 1 .and. last /= size(self%bands)) call out_of(group, 'ALBAND', to_text(size(texts))//' numbers are named in '// &
                                                               'ALOUT, but '//to_text(last)//' bands given', findings, last)
      allocate (self%factors(about%positions))
      call take(group, 'ALPOS', self%factors, findings, last=last)
      if (last > 0 .and. last /= about%positions) call out_of(group, 'ALPOS', 'a factor for each of the '// &
         to_text(about%positions)//' positions is expected; found '//to_text(last), findings, last)
      if (self%given .and. about%positions > 0 .and. .not. any(self%factors > 0.0_wp)) &
         call out_of(group, 'ALPOS', 'no position has a band', findings)
      call take(group, 'ALRULE', self%rule, findings)
      call take(group, 'ALYLD', self%yield, findings)
      self%yield = self%yield*percent
      if (group%given('ALYLD') .and. self%rule /= rule_yield) call out_of(group, 'ALYLD', "is for ALRULE='YIELD'", findings)
      call take(group, 'ALLAW', self%law, findings)
      call take(group, 'ALTRY', self%trials, findings)
      if (group%given('ALLAW') .and. self%rule /= rule_yield .and. self%trials == 0) &
         call out_of(group, 'ALLAW', "is for ALRULE='YIELD' and for a sample (ALTRY)", findings)
      call take(group, 'ALPROF', self%proof, findings)
      if (self%proof /= proof_none .and. self%rule /= rule_worst) &
         call out_of(group, 'ALPROF', "is for ALRULE='WORST'", findings)
      call group%get_texts('ALNAM', texts, findings)
      n = size(texts)
      self%names = [character(text_length) :: (adjustl(texts(i)), i=1, n)]
      allocate (self%fixed(n), self%cost(n), self%power(n), self%low(n), self%high(n), self%class(n))
      call take(group, 'ALFIX', self%fixed, findings)
      self%cost = 0.0_wp
      call take(group, 'ALCOST', self%cost, findings)
      call take(group, 'ALEXP', self%power, findings)
      call take(group, 'ALMIN', self%low, findings)
      call take(group, 'ALMAX', self%high, findings)
      call take(group, 'ALCLAS', self%class, findings)
      do i = 1, n
         if (self%high(i) > 0.0_wp .and. self%low(i) > self%high(i)) &
            call out_of(group, 'ALMIN', 'the least tolerance of '//trim(self%names(i))//' is above the largest', findings, i)
      end do
      call read_steps(self, group, n, findings)
      call read_plays(self, group, about, findings)
      allocate (self%group(n))
      call take(group, 'ALGRP', self%group, findings)
      allocate (self%correlation(maxval(abs([self%group, 0]))))
      call take(group, 'ALCORR', self%correlation, findings)
      if (self%proof /= proof_none .and. any(self%group /= 0)) call out_of(group, 'ALPROF', &
         'all linkages within the tolerances are enclosed, as if no deviations were correlated (ALGRP)', findings)
      if (self%proof == proof_scale .and. any(self%finest > 0 .or. self%table > 0)) call out_of(group, 'ALPROF', &
         "'SCALE' makes tolerances smaller, and grades and steps (ALGRAD, ALTAB) are what they are; use 'CHECK'", findings)
      if (group%given('ALCORR') .and. size(self%correlation) == 0) &
         call out_of(group, 'ALCORR', 'no dimension is in a correlated group (ALGRP)', findings)
   end subroutine read_allocation

   !> Joints with clearance. Errors: joints that are not there; a proof, which knows no clearances.
   subroutine read_plays(self, group, about, findings)
      class(allocation_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: texts(:)
      integer :: n, i

      call take_count(group, 'NPLAY', n, findings)
      allocate (self%plays(n), self%loaded(n), self%play_given(n))
      call read_places(group, 'P', about%ilink, self%plays, findings, ends_only=.true., sketch=about%sketch)
      call group%get_texts('PNAME', texts, findings)
      self%play_names = [character(text_length) :: (adjustl(texts(i)), i=1, size(texts))]
      call take(group, 'PLOAD', self%loaded, findings)
      call take(group, 'PGIVEN', self%play_given, findings)
      if (n > 0 .and. self%proof /= proof_none) call out_of(group, 'ALPROF', &
         'the proof encloses linkages whose dimensions deviate, without clearances; leave out the joints with clearance, '// &
         'or ALPROF', &
         findings)
   end subroutine read_plays

   !> Grades and tables of steps. Errors: grades that ISO 286 does not have here, or in the wrong order; both a grade and a table; a
   !> table without steps; costs and steps that are not as many.
   subroutine read_steps(self, group, n, findings)
      class(allocation_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      integer, intent(in) :: n                 !! names
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: costs(grades), tolerances(most_steps)
      integer :: i, steps, last

      allocate (self%finest(n), self%coarsest(n), self%table(n))
      call take(group, 'ALGRAD', self%finest, findings)
      call take(group, 'ALGRDC', self%coarsest, findings)
      call take(group, 'ALTAB', self%table, findings)
      call take(group, 'ALUNIT', self%millimetres, findings)
      self%unit_given = group%given('ALUNIT')
      costs = 1.0_wp
      allocate (self%grade_cost(0))
      call take(group, 'ALGCST', costs, findings, last=last)
      if (group%given('ALGCST')) then
         self%grade_cost = costs
         if (last /= grades) call out_of(group, 'ALGCST', 'costs of the 9 grades IT5 to IT13 are expected; found '// &
                                         to_text(last), findings, last)
         if (.not. any(self%finest > 0)) call out_of(group, 'ALGCST', 'no dimension has grades (ALGRAD)', findings)
      end if
      if (self%unit_given .and. .not. any(self%finest > 0)) &
         call out_of(group, 'ALUNIT', 'no dimension has grades (ALGRAD)', findings)
      tolerances = 1.0_wp
      call take(group, 'ALSTEP', tolerances, findings, last=steps)
      self%step = tolerances(:steps)
      tolerances = 1.0_wp
      call take(group, 'ALSCST', tolerances, findings, last=last)
      self%step_cost = tolerances(:steps)
      if (last /= steps) call out_of(group, 'ALSCST', 'a cost for each of the '//to_text(steps)//' steps of ALSTEP is '// &
                                     'expected; found '//to_text(last), findings, last)
      allocate (self%step_table(steps))
      call take(group, 'ALSTAB', self%step_table, findings)
      call take(group, 'ALNODE', self%most_nodes, findings)
      if (group%given('ALNODE') .and. .not. any(self%finest > 0 .or. self%table > 0)) &
         call out_of(group, 'ALNODE', 'no dimension has grades or steps (ALGRAD, ALTAB)', findings)
      if (steps > 0 .and. .not. any(self%table > 0)) call out_of(group, 'ALSTEP', 'no dimension has these steps (ALTAB)', findings)
      do i = 1, n
         if (self%finest(i) > 0 .and. self%finest(i) < first_grade) &
            call out_of(group, 'ALGRAD', 'grades are 5 to 13; found '//to_text(self%finest(i)), findings, i)
         if (self%finest(i) > self%coarsest(i)) &
            call out_of(group, 'ALGRDC', 'the coarsest grade of '//trim(self%names(i))//' is finer than the finest', findings, i)
         if (self%finest(i) > 0 .and. self%table(i) > 0) &
            call out_of(group, 'ALTAB', trim(self%names(i))//' has grades (ALGRAD) and cannot have a table, too', findings, i)
         if (self%table(i) > 0 .and. .not. any(self%step_table == self%table(i))) &
            call out_of(group, 'ALTAB', 'table '//to_text(self%table(i))//' has no steps (ALSTEP, ALSTAB)', findings, i)
      end do
   end subroutine read_steps

   subroutine visit_allocation(self, visitor)
      class(allocation_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor
      integer :: k

      if (.not. allocated(self%plays)) return
      do k = 1, size(self%plays)
         call visitor%joint(self%plays(k))
      end do
   end subroutine visit_allocation

   !> The group ALLOC of a case; as it is by default where the case does not have it.
   pure function allocation_of(set) result(allocation)
      class(data_set_t), intent(in) :: set
      type(allocation_group_t) :: allocation
      integer :: k

      k = set%place_of('ALLOC')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (allocation_group_t)
         allocation = group
      end select
      if (set%masses%given .and. .not. allocation%unit_given) allocation%millimetres = per_metre*set%masses%metre
   end function allocation_of
end module psalm_allocation_group
