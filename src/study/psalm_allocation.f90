!> Which tolerances? The cheapest ones that keep the outputs within their bands.
!>
!> Dimension i with the tolerance t_i, to either side, costs A_i + B_i/t_i**K_i; an output changes by s_ij with it at band j, of the
!> width b_j. The worst case, sum |s_ij| t_i <= b_j, and the root-sum-square, sum s_ij**2 t_i**2 <= b_j**2, are linear in t_i or its
!> square and the cost is convex in it: the optimum is global, and the dual function bounds the cost from below (`psalm_separable`).
!> A share of the linkages within the band has a width q_j(t) that grows like t: with the weights w_ij = q_j dq_j/dt_i / t_i
!> the sum of w_ij t_i**2 is q_j**2 and has its slopes, so that the root-sum-square with these weights, found anew until nothing
!> changes, ends where the conditions of the optimum hold. Source: Chase and Greenwood (1988), Design issues in mechanical tolerance
!> analysis; Spotts (1973), Allocation of tolerances to minimize cost of assembly.
module psalm_allocation
   use psalm_allocation_group, only: allocation_group_t, allocation_of, proof_none, proof_scale, rule_square, rule_worst
   use psalm_allocation_proof, only: allocation_proof_t, prove_bands, band_certified
   use psalm_allocation_rule, only: allocated_band_t, band_rule_t
   use psalm_allocation_terms, only: are_meant, costs_of, is_play, item_name, make_terms, terms_t
   use psalm_cheapest_tolerances, only: at_limit, cheapest_t, find_cheapest, limit_least, limit_none
   use psalm_column_names, only: output_name
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t, inputs_of
   use psalm_joint_play, only: play_t, check_plays, find_plays, names_of_plays, play_anywhere, play_loaded
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_output_kind, only: output_kind_t, output_kind
   use psalm_parameters, only: parameters_t, variable_gama, variable_length
   use psalm_sketch, only: output_ratio
   use psalm_sketch_outputs, only: names_of_numbers, name_length
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_sum_law, only: law_normal
   use psalm_text, only: to_text
   use psalm_tolerance, only: allowance_t, column_length, deviating_t, sample_t, tolerance_t, add_plays, allot, &
                              allowances_of, correlate, dimensions_to_allot, draw_sample, find_tolerances
   implicit none (type, external)
   private
   public :: allocation_t, study_allocation, check_allocation

   !> Results.
   type :: allocation_t
      logical :: closes = .false.                     !! the nominal linkage closes everywhere; else there is nothing more
      logical :: solved = .false.                     !! tolerances were found
      logical :: unsettled = .false.                  !! the rounds of a yield did not come to an end
      integer :: rule = rule_worst                    !! one of `rule_...`
      real(wp) :: yield = 0.0_wp                      !! share of the linkages that is wanted
      character(name_length), allocatable :: numbers(:) !! of the outputs
      logical, allocatable :: turns(:)                !! shape (numbers): degrees
      character(column_length), allocatable :: names(:) !! shape (dimensions)
      logical, allocatable :: is_angle(:)             !! shape (dimensions)
      integer, allocatable :: class(:)                !! shape (dimensions); 0: in none
      real(wp), allocatable :: nominal(:)             !! shape (dimensions): the length or angle itself; 0: not known
      integer, allocatable :: loop(:), place(:)       !! shape (dimensions): of a length or angle its arc; 0: of none
      real(wp), allocatable :: tolerance(:), cost(:)  !! shape (dimensions)
      real(wp), allocatable :: effect(:, :)           !! shape (dimensions, bands): change of the output by the whole tolerance
      real(wp), allocatable :: worst(:), square(:)    !! shape (bands): worst case and root-sum-square, with clearances; without
                                                      !! them not allocated: the effects add up
      integer, allocatable :: limit(:)                !! shape (dimensions): one of `limit_...`
      logical :: in_steps = .false.                   !! some dimensions have grades or steps
      logical, allocatable :: graded(:)               !! shape (dimensions): its steps are grades
      integer, allocatable :: step(:)                 !! shape (dimensions): grade, or number of its step; 0: any tolerance
      integer :: nodes = 0                            !! of the search for steps
      logical :: proven = .true.                      !! nothing is cheaper; else the search for steps ended early
      real(wp), allocatable :: worth(:)               !! shape (dimensions): cost saved by a smaller effect, to first order, for the
                                                      !! whole effect; with steps 0
      real(wp) :: wider_saves = 0.0_wp                !! with steps: what all bands wider by `wider` save
      integer :: without_step = 0                     !! dimension that has no step within its limits; 0: there is none
      real(wp) :: value = 0.0_wp, bound = 0.0_wp      !! cost of all, and what it cannot be below
      type(allocated_band_t), allocatable :: bands(:) !! by number of the output, then by position
      integer :: impossible = 0                       !! band that even the least tolerances do not keep; 0: there is none
      real(wp), allocatable :: input(:)               !! shape (positions), as listings have it
      logical, allocatable :: dead(:)                 !! shape (positions): dead points where a band was asked for and there is none
      type(allocation_proof_t) :: proof               !! of the worst case, if it is asked for
      real(wp) :: scaled = 1.0_wp                     !! all tolerances have been multiplied by this so that it is proven
      logical :: with_given = .false.                 !! the case has tolerances of its own (TOLER)
      real(wp) :: cost_of_given = 0.0_wp              !! their cost
      real(wp) :: use_of_given = 0.0_wp               !! and how much of a band they use at most
      integer :: trials = 0                           !! linkages of the sample that were asked for
      type(sample_t) :: sample
      logical :: out_of_time = .false.                !! MAXTIME ended it
      integer, allocatable :: columns(:)              !! shape (bands): of the sample
      type(play_t), allocatable :: plays(:)           !! joints with clearance, the last of the dimensions
   contains
      procedure :: is_violating
      procedure :: is_kept
   end type allocation_t

contains

   !> The cheapest tolerances of a linkage, and the sample of linkages within them if one is asked for.
   subroutine study_allocation(set, mechanism, dimensions, threads, stop, result, delt, given, analysed, unchecked)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions    !! the nominal linkage
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop                !! asked now and then by the sample
      type(allocation_t), intent(out) :: result
      real(wp), intent(in), optional :: delt(:)       !! increments of the input in place of those of the case
      type(problem_t), intent(in), optional :: given  !! see `find_tolerances`
      type(motion_t), intent(in), optional :: analysed
      logical, intent(in), optional :: unchecked      !! no sample is wanted
      type(allocation_group_t) :: asked
      type(deviating_t), allocatable :: deviating
      type(tolerance_t), allocatable :: linear
      type(allowance_t) :: allowance
      type(terms_t) :: terms
      type(stop_t) :: limited
      type(band_rule_t) :: rule
      type(cheapest_t) :: cheapest
      type(play_t), allocatable :: plays(:)
      real(wp), allocatable :: within(:, :), given_cost(:), slope(:), own(:), common(:)
      real(wp) :: far
      integer :: j

      asked = allocation_of(set)
      if (present(unchecked)) then
         if (unchecked) then
            asked%trials = 0
            if (asked%proof /= proof_scale) asked%proof = proof_none
         end if
      end if
      result%rule = asked%rule
      result%yield = asked%yield
      result%trials = asked%trials
      allocate (deviating, linear)
      call find_tolerances(set, mechanism, dimensions, deviating, linear, result%closes, delt, of_lengths=1.0_wp, given=given, &
                           analysed=analysed)
      if (.not. result%closes) return
      call allowances_of(set, mechanism%sliding_input, deviating, linear, allowance)
      if (present(delt)) then
         call find_plays(set, asked, mechanism, dimensions, delt, plays)
      else
         call find_plays(set, asked, mechanism, dimensions, inputs_of(set), plays)
      end if
      call add_plays(plays, allowance)
      result%plays = plays
      result%numbers = allowance%numbers
      result%turns = allowance%turns
      result%names = allowance%names
      result%is_angle = allowance%is_angle
      call take_dimensions(linear, allowance, result)
      result%dead = linear%dead .and. asked%factors > 0.0_wp
      result%input = linear%nominal%input
      call make_terms(asked, allowance, linear%dimensions, terms)
      result%class = terms%class
      call make_bands(asked, allowance, linear%dead, result%bands)
      limited = stop
      call limited%limit_time(set%search%maxtime)
      rule = band_rule_t(asked%rule, asked%law, asked%yield, terms%group, asked%correlation)
      if (size(plays) > 0) then
         rule%disc = [(.false., j=1, size(allowance%column)), plays%kind == play_anywhere]
         rule%leaning = [(.false., j=1, size(allowance%column)), plays%kind == play_loaded]
      end if
      call find_cheapest(asked, rule, allowance, terms, result%bands, limited, cheapest)
      call take_down(terms, allowance, cheapest, result)
      result%out_of_time = limited%late()
      result%with_given = set%toler%given .and. all(allowance%given > 0.0_wp)
      if (result%with_given) then
         given_cost = costs_of(terms, allowance%given)
         result%with_given = all(given_cost < huge(1.0_wp)) ! a step that is finer than all costs nothing known
         if (result%with_given) result%cost_of_given = sum(given_cost)
         allocate (slope(size(allowance%names)))
         do j = 1, size(result%bands)
            associate (band => result%bands(j))
               call rule%reach(allowance%change(band%position, :, band%number), allowance%given, far, slope)
               result%use_of_given = max(result%use_of_given, far/band%width)
            end associate
         end do
      end if
      if (.not. result%solved) return
      if (size(plays) > 0) then
         allocate (result%worst(size(result%bands)), result%square(size(result%bands)))
         call reach_by(rule_worst, result%worst)
         call reach_by(rule_square, result%square)
      end if
      if (asked%proof /= proof_none) call prove_all(asked, terms, deviating, linear, allowance, result)
      if (asked%trials == 0) return
      limited = stop
      call limited%limit_time(set%search%maxtime)
      call allot(allowance, result%tolerance, asked%law, deviating, linear)
      if (any(terms%group /= 0)) then
         allocate (own(size(allowance%names)), common(size(allowance%names)))
         call rule%parts(asked%law == law_normal, own, common)
         call correlate(allowance, terms%group, own, common, linear)
      end if
      j = size(linear%effect, 3)
      if (.not. allocated(linear%bands)) j = 0
      result%columns = result%bands%number + j
      allocate (within(size(linear%dead), j + size(allowance%numbers)), source=huge(1.0_wp))
      do j = 1, size(result%bands)
         within(result%bands(j)%position, result%columns(j)) = result%bands(j)%width
      end do
      call draw_sample(deviating, linear, asked%trials, set%method%istart, threads, result%sample, limited, within)
      result%out_of_time = result%out_of_time .or. limited%late()

   contains

      !> How far the tolerances let the outputs go by another rule.
      subroutine reach_by(which, reached)
         integer, intent(in) :: which              !! one of `rule_...`
         real(wp), intent(out) :: reached(:)       !! shape (bands)
         type(band_rule_t) :: other
         real(wp) :: of_each(size(allowance%names))
         integer :: b

         other = rule
         other%rule = which
         do b = 1, size(reached)
            associate (band => result%bands(b))
               call other%reach(allowance%change(band%position, :, band%number), result%tolerance, reached(b), of_each)
            end associate
         end do
      end subroutine reach_by
   end subroutine study_allocation

   !> What was found.
   pure subroutine take_down(terms, allowance, cheapest, result)
      type(terms_t), intent(in) :: terms
      type(allowance_t), intent(in) :: allowance
      type(cheapest_t), intent(in) :: cheapest
      type(allocation_t), intent(inout) :: result
      integer :: j

      result%solved = cheapest%solved
      result%unsettled = cheapest%unsettled
      result%impossible = cheapest%impossible
      result%in_steps = any(terms%in_steps)
      result%graded = terms%graded
      result%step = cheapest%step
      result%nodes = cheapest%nodes
      result%proven = cheapest%proven
      result%without_step = cheapest%without_step
      if (.not. cheapest%solved) return
      result%tolerance = cheapest%tolerance
      result%cost = cheapest%cost
      result%limit = cheapest%limit
      result%worth = cheapest%worth
      result%wider_saves = cheapest%wider_saves
      result%value = cheapest%value
      result%bound = cheapest%bound
      allocate (result%effect(size(result%tolerance), size(result%bands)))
      do j = 1, size(result%bands)
         associate (band => result%bands(j))
            result%effect(:, j) = allowance%change(band%position, :, band%number)*result%tolerance
         end associate
      end do
   end subroutine take_down

   !> Prove the worst case, with all tolerances made smaller for it if that is asked for.
   subroutine prove_all(asked, terms, deviating, linear, allowance, result)
      type(allocation_group_t), intent(in) :: asked
      type(terms_t), intent(in) :: terms
      type(deviating_t), intent(in) :: deviating
      type(tolerance_t), intent(in) :: linear
      type(allowance_t), intent(in) :: allowance
      type(allocation_t), intent(inout) :: result

      call prove()
      if (asked%proof /= proof_scale .or. result%proof%factor >= 1.0_wp .or. .not. result%proof%factor > 0.0_wp) return
      result%scaled = result%proof%factor
      result%tolerance = result%scaled*result%tolerance
      result%effect = result%scaled*result%effect
      result%bands%used = result%scaled*result%bands%used
      result%cost = costs_of(terms, result%tolerance)
      result%value = sum(result%cost)
      result%limit = limit_none
      where (result%tolerance < (1.0_wp - at_limit)*terms%low) result%limit = limit_least
      call prove()

   contains

      subroutine prove()
         call prove_bands(deviating, linear, allowance, result%tolerance, result%bands%position, result%bands%number, &
                          result%bands%width, result%proof)
      end subroutine prove
   end subroutine prove_all

   !> The dimensions themselves, and the arcs that they are of.
   pure subroutine take_dimensions(linear, allowance, result)
      type(tolerance_t), intent(in) :: linear
      type(allowance_t), intent(in) :: allowance
      type(allocation_t), intent(inout) :: result
      type(parameters_t) :: parameters
      real(wp), allocatable :: values(:)
      integer :: i

      parameters%variables = linear%variables
      values = parameters%first_values(linear%dimensions)
      result%nominal = allowance%size
      allocate (result%loop(size(allowance%names)), result%place(size(allowance%names)), source=0)
      do i = 1, size(allowance%column)
         if (allowance%column(i) > size(values)) cycle      ! of a joint that stands off the arcs
         associate (variable => linear%variables(allowance%column(i)))
            result%nominal(i) = values(allowance%column(i))
            if (.not. any(variable%kind == [variable_length, variable_gama])) cycle
            result%loop(i) = variable%loop
            result%place(i) = variable%arc
         end associate
      end do
   end subroutine take_dimensions

   !> True if no tolerances keep the bands, there are dead points without bands, the search for steps or the sample ended early, or
   !> the linkages of the sample do not keep what the tolerances promise.
   pure logical function is_violating(self)
      class(allocation_t), intent(in) :: self
      integer :: j

      is_violating = .false.
      if (.not. self%closes) return
      is_violating = .not. self%solved .or. any(self%dead) .or. .not. self%proven
      if (.not. is_violating .and. self%proof%asked) is_violating = any(self%proof%verdict /= band_certified)
      if (is_violating .or. self%trials == 0) return
      is_violating = self%sample%trials < self%trials .or. any([(.not. self%is_kept(j), j=1, size(self%bands))])
   end function is_violating

   !> True if the sample keeps a band as promised: the share that the law of the deviations has within it, but for three standard
   !> errors.
   pure logical function is_kept(self, j)
      class(allocation_t), intent(in) :: self
      integer, intent(in) :: j                        !! band
      real(wp), parameter :: errors = 3.0_wp
      real(wp) :: beyond, expected

      is_kept = .true.
      if (self%sample%trials == 0) return
      associate (trials => real(self%sample%trials, wp))
         beyond = self%sample%beyond(self%bands(j)%position, self%columns(j))
         expected = trials*(1.0_wp - self%bands(j)%share)
         is_kept = beyond <= expected + errors*sqrt(max(0.0_wp, expected*(1.0_wp - expected/trials)))
      end associate
   end function is_kept

   ! ---- what is asked for ---------------------------------------------------------------------------------------------

   !> Find what the group names and the linkage does not have, before anything is done.
   subroutine check_allocation(set, mechanism, dimensions, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: list
      character(column_length), allocatable :: names(:)
      character(name_length), allocatable :: numbers(:)
      logical, allocatable :: is_angle(:), turning(:), named(:)
      integer, allocatable :: class(:), entry(:)
      real(wp), allocatable :: low(:), high(:)
      type(allocation_group_t) :: asked
      type(output_kind_t) :: kind
      integer :: i, k

      if (.not. set%gives('ALLOC')) return
      asked = allocation_of(set)
      if (size(asked%factors) /= size(inputs_of(set))) then
         call set%origins%error(findings, 'ALLOC', 'ALPOS', 'tolerances are allotted for the '//to_text(size(inputs_of(set)))// &
                                ' positions of the input')
      end if
      call dimensions_to_allot(set, mechanism, dimensions, names, is_angle)
      call check_plays(set, asked, mechanism, dimensions, findings)
      if (size(asked%plays) > 0) then
         if (findings%failed()) return
         names = [names, [character(column_length) :: names_of_plays(asked, mechanism)]]
         is_angle = [is_angle, [(.false., k=1, size(asked%plays))]]
      end if
      if (size(names) == 0) then
         call set%origins%error(findings, 'ALLOC', '', 'no dimension has a tolerance that is above 0 in &TOLER')
         return
      end if
      allocate (class(size(names)), entry(size(names)), source=0)
      allocate (low(size(names)), high(size(names)), source=0.0_wp)
      do i = 1, size(asked%names)
         named = are_meant(asked%names(i), names, is_angle)
         if (any(named)) then
            where (named)
               class = asked%class(i)
               low = asked%low(i)
               high = asked%high(i)
               entry = i
            end where
            if (asked%group(i) /= 0 .and. any(named .and. index(names, ' OF JOINT ') > 0)) &
               call set%origins%error(findings, 'ALLOC', 'ALGRP', "'"//trim(asked%names(i))//"' means a joint off the lines of "// &
                                      'its link, whose place can be in no group', i)
            if (asked%group(i) /= 0 .and. any(named .and. is_play(names))) &
               call set%origins%error(findings, 'ALLOC', 'ALGRP', "'"//trim(asked%names(i))//"' means clearances of joints, "// &
                                      'which can be in no group', i)
            if (asked%finest(i) > 0 .and. any(named .and. is_play(names))) call set%origins%error(findings, 'ALLOC', 'ALGRAD', &
               "'"//trim(asked%names(i))//"' means clearances of joints, and ISO 286 has grades for lengths; give a table of "// &
               'fits (ALTAB)', i)
            if (asked%finest(i) > 0 .and. any(named .and. is_angle)) call set%origins%error(findings, 'ALLOC', 'ALGRAD', &
               "'"//trim(asked%names(i))//"' means angles, and ISO 286 has grades for lengths", i)
            cycle
         end if
         list = ''
         do k = 1, size(names)
            list = list//trim(merge(',', ' ', k > 1))//" '"//item_name(names(k))//"'"
         end do
         call set%origins%error(findings, 'ALLOC', 'ALNAM', "no dimension with a tolerance is called '"//trim(asked%names(i))// &
                                "'; there are"//list, i)
      end do
      do i = 1, size(names)
         if (class(i) == 0) cycle
         if (any(class == class(i) .and. low > high(i) .and. high(i) > 0.0_wp)) then
            call set%origins%error(findings, 'ALLOC', 'ALCLAS', 'class '//to_text(class(i))//': the least tolerance of one '// &
                                   'dimension is above the largest of another')
            exit
         end if
         if (any(class == class(i) .and. [(.not. same_steps(asked, entry(i), entry(k)), k=1, size(names))])) then
            call set%origins%error(findings, 'ALLOC', 'ALCLAS', 'class '//to_text(class(i))//' has grades, steps of a table '// &
                                   'and tolerances of any size, or two of these')
            exit
         end if
         if (all((class /= class(i)) .or. (is_angle .eqv. is_angle(i)))) cycle
         call set%origins%error(findings, 'ALLOC', 'ALCLAS', 'class '//to_text(class(i))//' has lengths and angles')
         exit
      end do
      if (size(set%sketch%outputs) > 0) then
         call names_of_numbers(set%sketch%outputs, numbers, turning)
         if (size(asked%outputs) == 0 .and. set%sketch%outputs(1)%kind == output_ratio) &
            call set%origins%error(findings, 'ALLOC', 'ALOUT', 'the first output is a ratio of rates, which has no band')
      else
         kind = output_kind(set%method%motion)
         allocate (numbers(kind%components))
         do k = 1, kind%components
            numbers(k) = output_name(kind, k)
         end do
      end if
      do i = 1, size(asked%outputs)
         if (any(asked%outputs(:i - 1) == asked%outputs(i))) &
            call set%origins%error(findings, 'ALLOC', 'ALOUT', "'"//trim(asked%outputs(i))//"' is named twice", i)
         if (any(set%sketch%outputs%name == asked%outputs(i) .and. set%sketch%outputs%kind == output_ratio)) &
            call set%origins%error(findings, 'ALLOC', 'ALOUT', "'"//trim(asked%outputs(i))// &
                                   "' is a ratio of rates, which has no band", i)
         if (any(numbers == asked%outputs(i))) cycle
         list = ''
         do k = 1, size(numbers)
            if (any(set%sketch%outputs%name == numbers(k) .and. set%sketch%outputs%kind == output_ratio)) cycle
            list = list//trim(merge(',', ' ', len(list) > 0))//" '"//trim(numbers(k))//"'"
         end do
         call set%origins%error(findings, 'ALLOC', 'ALOUT', "no number of an output is called '"//trim(asked%outputs(i))// &
                                "'; there are"//list, i)
      end do
   end subroutine check_allocation

   !> True if two entries of ALNAM have tolerances of one kind: grades, steps of one table, or any.
   pure logical function same_steps(asked, one, other)
      type(allocation_group_t), intent(in) :: asked
      integer, intent(in) :: one, other               !! 0: none

      same_steps = one == other
      if (same_steps .or. one == 0 .or. other == 0) return
      same_steps = (asked%finest(one) > 0) .eqv. (asked%finest(other) > 0)
      same_steps = same_steps .and. asked%table(one) == asked%table(other)
   end function same_steps

   !> The bands, at every position but dead points.
   pure subroutine make_bands(asked, allowance, dead, bands)
      type(allocation_group_t), intent(in) :: asked
      type(allowance_t), intent(in) :: allowance
      logical, intent(in) :: dead(:)
      type(allocated_band_t), allocatable, intent(out) :: bands(:)
      type(allocated_band_t) :: one
      integer, allocatable :: numbers(:)
      real(wp) :: width
      integer :: k, i, n

      if (size(asked%outputs) == 0) then
         numbers = [(k, k=1, size(allowance%numbers))]
         numbers = pack(numbers, belongs_to_first(allowance%numbers))
      else
         numbers = [(findloc(allowance%numbers, asked%outputs(k), dim=1), k=1, size(asked%outputs))]
      end if
      allocate (bands(size(numbers)*size(dead)))
      n = 0
      do k = 1, size(numbers)
         width = asked%bands(min(k, size(asked%bands)))
         do i = 1, size(dead)
            if (dead(i) .or. .not. asked%factors(i) > 0.0_wp .or. .not. allowance%known(numbers(k))) cycle
            one%position = i
            one%number = numbers(k)
            one%width = width*asked%factors(i)
            n = n + 1
            bands(n) = one
         end do
      end do
      bands = bands(:n)
   end subroutine make_bands

   !> Numbers of the first output: its name is that before the point.
   pure function belongs_to_first(numbers) result(first)
      character(*), intent(in) :: numbers(:)
      logical :: first(size(numbers))
      integer :: k

      do k = 1, size(numbers)
         first(k) = stem(numbers(k)) == stem(numbers(1))
      end do

   contains

      pure function stem(name)
         character(*), intent(in) :: name
         character(:), allocatable :: stem
         integer :: point

         point = index(name, '.', back=.true.)
         stem = trim(name)
         if (point > 1) stem = name(:point - 1)
      end function stem
   end function belongs_to_first

end module psalm_allocation
