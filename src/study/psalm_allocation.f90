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
   use psalm_allocation_group, only: allocation_group_t, allocation_of, proof_none, proof_scale, rule_worst, rule_yield
   use psalm_allocation_proof, only: allocation_proof_t, prove_bands, band_certified
   use psalm_column_names, only: output_name
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t, inputs_of
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_mechanism, only: mechanism_t
   use psalm_output_kind, only: output_kind_t, output_kind
   use psalm_parameters, only: parameters_t, variable_gama, variable_length
   use psalm_sketch, only: output_ratio
   use psalm_separable, only: separable_t, separable_solution_t, solve_separable, inverse_power
   use psalm_sketch_outputs, only: names_of_numbers, name_length
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_sum_law, only: half_width, share_within
   use psalm_text, only: to_text, upper_case, lower_case
   use psalm_tolerance, only: allowance_t, column_length, deviating_t, sample_t, tolerance_t, allot, allowances_of, &
                              dimensions_to_allot, draw_sample, find_tolerances
   implicit none (type, external)
   private
   public :: allocation_t, study_allocation, check_allocation, item_name
   public :: limit_least, limit_largest

   integer, parameter :: limit_none = 0, limit_least = 1, limit_largest = 2
   real(wp), parameter :: largest_of_length = 0.1_wp  !! part of a length that its tolerance is at most, by default
   real(wp), parameter :: largest_angle = 5.0_wp      !! degrees, the same of an angle
   real(wp), parameter :: at_limit = 1.0e-6_wp        !! part of a limit within which a tolerance is at it
   integer, parameter :: most_rounds = 100            !! of weights
   integer, parameter :: undamped = 8                 !! rounds that go all the way to the next weights
   real(wp), parameter :: kept_to = 1.0e-6_wp         !! part of a band that rounds which have ended may leave over
   real(wp), parameter :: steady = 1.0e-9_wp          !! change of the cost between two rounds at which they end
   character(*), parameter :: of_joint = ' OF JOINT ', of_arc = ' OF ARC ' !! in names that joints have no part in, or one
   real(wp), parameter :: least_change = 1.0e-10_wp           !! part of the largest change below which a dimension has none

   !> A band at a position.
   type :: allocated_band_t
      integer :: position = 0, number = 0             !! number: of the outputs
      real(wp) :: width = 0.0_wp                      !! to either side
      real(wp) :: used = 0.0_wp                       !! deviation by the rule
      real(wp) :: price = 0.0_wp                      !! cost saved by a wider band, to first order, for its whole width
      real(wp) :: share = 0.0_wp                      !! of the linkages within it, by the law of the deviations
   end type allocated_band_t

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
      integer, allocatable :: limit(:)                !! shape (dimensions): one of `limit_...`
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
   contains
      procedure :: is_violating
      procedure :: is_kept
   end type allocation_t

   !> The terms of the costs and the limits of every dimension.
   type :: terms_t
      real(wp), allocatable :: fixed(:), cost(:), power(:), low(:), high(:)
      integer, allocatable :: class(:)
   end type terms_t

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
      real(wp), allocatable :: within(:, :)
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
      call find_cheapest(asked, allowance, terms, result)
      result%with_given = set%toler%given
      if (result%with_given) then
         result%cost_of_given = sum(costs_of(terms, allowance%given))
         do j = 1, size(result%bands)
            result%use_of_given = max(result%use_of_given, &
                                      used_of(asked, allowance, result%bands(j), allowance%given)/result%bands(j)%width)
         end do
      end if
      if (.not. result%solved) return
      if (asked%proof /= proof_none) call prove_all(asked, terms, deviating, linear, allowance, result)
      if (asked%trials == 0) return
      limited = stop
      call limited%limit_time(set%search%maxtime)
      call allot(allowance, result%tolerance, asked%law, deviating, linear)
      j = size(linear%effect, 3)
      if (.not. allocated(linear%bands)) j = 0
      result%columns = result%bands%number + j
      allocate (within(size(linear%dead), j + size(allowance%numbers)), source=huge(1.0_wp))
      do j = 1, size(result%bands)
         within(result%bands(j)%position, result%columns(j)) = result%bands(j)%width
      end do
      call draw_sample(deviating, linear, asked%trials, set%method%istart, threads, result%sample, limited, within)
      result%out_of_time = limited%late()
   end subroutine study_allocation

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
      allocate (result%loop(size(allowance%column)), result%place(size(allowance%column)), source=0)
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

   !> True if no tolerances keep the bands, there are dead points without bands, the sample ended early, or the linkages of the
   !> sample do not keep what the tolerances promise.
   pure logical function is_violating(self)
      class(allocation_t), intent(in) :: self
      integer :: j

      is_violating = .false.
      if (.not. self%closes) return
      is_violating = .not. self%solved .or. any(self%dead)
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
      integer, allocatable :: class(:)
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
      if (size(names) == 0) then
         call set%origins%error(findings, 'ALLOC', '', 'no dimension has a tolerance that is above 0 in &TOLER')
         return
      end if
      allocate (class(size(names)), source=0)
      allocate (low(size(names)), high(size(names)), source=0.0_wp)
      do i = 1, size(asked%names)
         named = are_meant(asked%names(i), names, is_angle)
         if (any(named)) then
            where (named)
               class = asked%class(i)
               low = asked%low(i)
               high = asked%high(i)
            end where
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

   !> The name of a dimension as ALNAM has it: small letters, names of joints as they are.
   pure function item_name(name)
      character(*), intent(in) :: name
      character(:), allocatable :: item_name
      integer :: at

      item_name = trim(name)
      at = index(item_name, ' ')
      if (is_by_joints(name)) then
         item_name(:at) = lower_case(item_name(:at))
      else if (index(item_name, of_joint) == 0) then
         item_name = lower_case(item_name)
      end if
   end function item_name

   !> True for a length or an angle of a sketch, which has the names of joints.
   elemental logical function is_by_joints(name)
      character(*), intent(in) :: name

      is_by_joints = (index(name, 'LENGTH ') == 1 .or. index(name, 'ANGLE ') == 1) .and. index(name, of_joint) == 0 .and. &
                     index(name, of_arc) == 0
   end function is_by_joints

   !> Which dimensions a name of ALNAM means. Of a length between two joints the order is free, and the word `length`.
   pure function are_meant(name, names, is_angle) result(meant)
      character(*), intent(in) :: name, names(:)
      logical, intent(in) :: is_angle(:)
      logical :: meant(size(names))
      character(:), allocatable :: pair
      integer :: i, blank

      select case (upper_case(name))
      case ('*')
         meant = .true.
      case ('LENGTH *')
         meant = .not. is_angle
      case ('ANGLE *')
         meant = is_angle
      case default
         pair = trim(name)
         if (index(upper_case(name), 'LENGTH ') == 1) pair = trim(adjustl(name(len('LENGTH '):)))
         blank = index(pair, ' ')
         do i = 1, size(names)
            if (.not. is_by_joints(names(i))) then
               meant(i) = upper_case(trim(names(i))) == upper_case(trim(name))
            else if (is_angle(i)) then
               meant(i) = names(i)(len('ANGLE '):) == after(name, 'ANGLE ')
            else
               meant(i) = names(i) == 'LENGTH '//pair
               if (blank > 0) meant(i) = meant(i) .or. names(i) == 'LENGTH '//trim(adjustl(pair(blank:)))//' '//pair(:blank - 1)
            end if
         end do
      end select
   end function are_meant

   !> What follows a word at the beginning of a name, with one blank before it; nothing if the name does not begin so.
   pure function after(name, word) result(rest)
      character(*), intent(in) :: name, word
      character(:), allocatable :: rest

      rest = ''
      if (index(upper_case(name), word) == 1) rest = ' '//trim(adjustl(name(len(word):)))
   end function after

   !> Costs and limits of every dimension: those of the last entry that means it, else as by default.
   pure subroutine make_terms(asked, allowance, dimensions, terms)
      type(allocation_group_t), intent(in) :: asked
      type(allowance_t), intent(in) :: allowance
      type(dimensions_t), intent(in) :: dimensions
      type(terms_t), intent(out) :: terms
      real(wp) :: mean, own
      integer :: i, k, n

      n = size(allowance%names)
      allocate (terms%fixed(n), terms%cost(n), terms%low(n), terms%high(n), source=0.0_wp)
      allocate (terms%power(n), source=1.0_wp)
      allocate (terms%class(n), source=0)
      do k = 1, size(asked%names)
         associate (named => are_meant(asked%names(k), allowance%names, allowance%is_angle))
            where (named)
               terms%fixed = asked%fixed(k)
               terms%cost = asked%cost(k)
               terms%power = asked%power(k)
               terms%low = asked%low(k)
               terms%high = asked%high(k)
               terms%class = asked%class(k)
            end where
         end associate
      end do
      mean = sum(abs(dimensions%arcl))/real(max(1, count(abs(dimensions%arcl) > 0.0_wp)), wp)
      do i = 1, n
         if (.not. terms%cost(i) > 0.0_wp) then
            terms%cost(i) = 1.0_wp
            if (allowance%is_angle(i)) terms%cost(i) = inverse_power(radians_per_degree*mean, terms%power(i))
         end if
         if (terms%high(i) > 0.0_wp) cycle
         own = abs(allowance%size(i))
         if (.not. own > 0.0_wp) own = mean           ! of a travel, or of a length that is 0
         terms%high(i) = merge(largest_angle, largest_of_length*own, allowance%is_angle(i))
         terms%high(i) = max(terms%high(i), terms%low(i))
      end do
   end subroutine make_terms

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

   ! ---- the problem ---------------------------------------------------------------------------------------------------

   !> Solve the problem and take down what it led to.
   subroutine find_cheapest(asked, allowance, terms, result)
      type(allocation_group_t), intent(in) :: asked
      type(allowance_t), intent(in) :: allowance
      type(terms_t), intent(in) :: terms
      type(allocation_t), intent(inout) :: result
      type(separable_t) :: problem
      type(separable_solution_t) :: solution
      integer :: unknown(size(terms%cost)), i, j, k, n, rounds
      real(wp) :: weights(size(terms%cost), size(result%bands)), before, order, most

      n = 0
      do i = 1, size(unknown)
         k = 0
         if (terms%class(i) > 0) k = findloc(terms%class(:i - 1), terms%class(i), dim=1)
         if (k > 0) then
            unknown(i) = unknown(k)
         else
            n = n + 1
            unknown(i) = n
         end if
      end do
      order = merge(1.0_wp, 2.0_wp, asked%rule == rule_worst)
      problem%cost = terms%cost
      problem%power = terms%power/order
      problem%unknown = unknown
      problem%low = [(maxval(terms%low, unknown == k), k=1, n)]**nint(order)
      problem%high = [(minval(terms%high, unknown == k), k=1, n)]**nint(order)
      problem%high = max(problem%low, problem%high)
      do j = 1, size(result%bands)
         associate (band => result%bands(j))
            weights(:, j) = abs(allowance%change(band%position, :, band%number))
            most = maxval(weights(:, j))
            where (weights(:, j) < least_change*most) weights(:, j) = 0.0_wp
            if (order > 1.0_wp) weights(:, j) = weights(:, j)**2
         end associate
      end do
      before = huge(1.0_wp)
      do rounds = 1, merge(most_rounds, 1, asked%rule == rule_yield)
         call solve_with(weights)
         if (.not. solution%solved) exit
         result%tolerance = solution%x(unknown)
         if (order > 1.0_wp) result%tolerance = sqrt(result%tolerance)
         if (asked%rule /= rule_yield) exit
         if (abs(solution%value - before) <= steady*solution%value) exit
         before = solution%value
         call reweigh(rounds > undamped)
      end do
      result%impossible = solution%tightest
      result%solved = solution%solved
      if (.not. result%solved) return
      do j = 1, size(result%bands)
         result%bands(j)%used = used_of(asked, allowance, result%bands(j), result%tolerance)
      end do
      if (asked%rule == rule_yield) result%unsettled = rounds > most_rounds .or. &
         any(result%bands%used > (1.0_wp + kept_to)*result%bands%width)
      result%solved = .not. result%unsettled
      if (.not. result%solved) return
      result%cost = costs_of(terms, result%tolerance)
      result%value = sum(result%cost)
      result%bound = sum(terms%fixed) + solution%bound
      result%limit = [(limit_none, i=1, size(unknown))]
      where (result%tolerance >= (1.0_wp - at_limit)*terms%high) result%limit = limit_largest
      where (result%tolerance <= (1.0_wp + at_limit)*terms%low) result%limit = limit_least
      allocate (result%effect(size(unknown), size(result%bands)))
      do j = 1, size(result%bands)
         associate (band => result%bands(j))
            band%price = order*solution%price(j)
            result%effect(:, j) = allowance%change(band%position, :, band%number)*result%tolerance
            band%share = share_within(asked%law, result%effect(:, j), band%width)
         end associate
      end do

   contains

      subroutine solve_with(weights)
         real(wp), intent(in) :: weights(:, :)
         integer :: c, b

         if (allocated(problem%share)) deallocate (problem%share)
         allocate (problem%share(n, size(weights, 2)), source=0.0_wp)
         do b = 1, size(weights, 2)
            do c = 1, size(unknown)
               problem%share(unknown(c), b) = problem%share(unknown(c), b) + weights(c, b)/result%bands(b)%width**nint(order)
            end do
         end do
         call solve_separable(problem, solution)
      end subroutine solve_with

      !> Weights whose sum has the value and the slopes of the width that holds the share; damped, halfway from those before.
      subroutine reweigh(damped)
         logical, intent(in) :: damped
         real(wp) :: width, slope(size(unknown)), effect(size(unknown)), next(size(unknown))
         integer :: b

         do b = 1, size(result%bands)
            effect = abs(allowance%change(result%bands(b)%position, :, result%bands(b)%number))
            where (effect < least_change*maxval(effect)) effect = 0.0_wp
            call half_width(asked%law, effect*result%tolerance, asked%yield, width, slope)
            next = width*slope*effect/result%tolerance
            if (damped) next = 0.5_wp*(next + weights(:, b))
            weights(:, b) = next
         end do
      end subroutine reweigh
   end subroutine find_cheapest

   !> What tolerances cost.
   pure function costs_of(terms, tolerance) result(costs)
      type(terms_t), intent(in) :: terms
      real(wp), intent(in) :: tolerance(:)            !! shape (dimensions)
      real(wp) :: costs(size(tolerance))

      costs = terms%fixed + terms%cost*inverse_power(tolerance, terms%power)
   end function costs_of

   !> How far tolerances let the output go in a band, by the rule.
   pure real(wp) function used_of(asked, allowance, band, tolerance) result(used)
      type(allocation_group_t), intent(in) :: asked
      type(allowance_t), intent(in) :: allowance
      type(allocated_band_t), intent(in) :: band
      real(wp), intent(in) :: tolerance(:)            !! shape (dimensions)
      real(wp) :: effect(size(tolerance)), slope(size(tolerance))

      effect = allowance%change(band%position, :, band%number)*tolerance
      select case (asked%rule)
      case (rule_worst)
         used = sum(abs(effect))
      case (rule_yield)
         call half_width(asked%law, effect, asked%yield, used, slope)
      case default
         used = sqrt(sum(effect**2))
      end select
   end function used_of
end module psalm_allocation
