!> What the tolerances of the dimensions cost, between which limits they lie, and which steps they have: the entries of ALNAM.
!>
!> A tolerance T to either side costs A + B/T**K; a grade of ISO 286 is half of its width, a step of a table that of the table, and
!> both may have costs of their own, A + B times that.
module psalm_allocation_terms
   use psalm_allocation_group, only: allocation_group_t
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_separable, only: inverse_power
   use psalm_sort, only: ascending
   use psalm_standard_tolerances, only: coarsest_grade, finest_grade, grade_width
   use psalm_text, only: upper_case, lower_case
   use psalm_tolerance, only: allowance_t
   implicit none (type, external)
   private
   public :: terms_t, make_terms, costs_of, are_meant, is_play, item_name

   real(wp), parameter :: largest_of_length = 0.1_wp  !! part of a length that its tolerance is at most, by default
   real(wp), parameter :: largest_angle = 5.0_wp      !! degrees, the same of an angle
   real(wp), parameter :: half = 0.5_wp               !! of the width of a grade: to either side
   real(wp), parameter :: rounding = 1.0e-12_wp       !! part of a limit by which a step may be beyond it
   character(*), parameter :: of_joint = ' OF JOINT ', of_arc = ' OF ARC ' !! in names that joints have no part in, or one

   !> The terms of the costs and the limits of every dimension.
   type :: terms_t
      real(wp), allocatable :: fixed(:), cost(:), power(:), low(:), high(:)
      integer, allocatable :: class(:)
      integer, allocatable :: group(:)                !! shape (dimensions): correlated group with its sign; 0: in none
      logical, allocatable :: in_steps(:)             !! shape (dimensions): else any tolerance
      integer, allocatable :: steps(:)                !! shape (dimensions): how many are within its limits
      integer, allocatable :: kind(:, :)              !! shape (steps, dimensions): grade, or number in its table: ascending
      logical, allocatable :: graded(:)               !! shape (dimensions): its steps are grades
      real(wp), allocatable :: step(:, :), step_cost(:, :) !! shape (steps, dimensions): tolerance and the whole cost
   end type terms_t

contains

   !> Costs and limits of every dimension: those of the last entry that means it, else as by default.
   pure subroutine make_terms(asked, allowance, dimensions, terms)
      type(allocation_group_t), intent(in) :: asked
      type(allowance_t), intent(in) :: allowance
      type(dimensions_t), intent(in) :: dimensions
      type(terms_t), intent(out) :: terms
      real(wp) :: mean, own
      integer :: i, k, n
      integer, allocatable :: entry(:)                !! of ALNAM, by dimension
      logical, allocatable :: own_cost(:)

      n = size(allowance%names)
      allocate (terms%fixed(n), terms%cost(n), terms%low(n), terms%high(n), source=0.0_wp)
      allocate (terms%power(n), source=1.0_wp)
      allocate (terms%class(n), terms%group(n), source=0)
      entry = [(0, i=1, n)]
      do k = 1, size(asked%names)
         associate (named => are_meant(asked%names(k), allowance%names, allowance%is_angle))
            where (named)
               terms%fixed = asked%fixed(k)
               terms%cost = asked%cost(k)
               terms%power = asked%power(k)
               terms%low = asked%low(k)
               terms%high = asked%high(k)
               terms%class = asked%class(k)
               terms%group = asked%group(k)
               entry = k
            end where
         end associate
      end do
      own_cost = terms%cost > 0.0_wp
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
      call make_steps(asked, allowance%size, entry, own_cost, terms)
   end subroutine make_terms

   !> The steps of every dimension that has some: those within its limits.
   pure subroutine make_steps(asked, sizes, entry, own_cost, terms)
      type(allocation_group_t), intent(in) :: asked
      real(wp), intent(in) :: sizes(:)                !! of the dimensions, user's length
      integer, intent(in) :: entry(:)                 !! of ALNAM, by dimension; 0: none
      logical, intent(in) :: own_cost(:)              !! ALCOST has a cost
      type(terms_t), intent(inout) :: terms
      integer, allocatable :: kinds(:)
      real(wp), allocatable :: tolerance(:)
      real(wp) :: factor
      integer :: i, k, n, most

      n = size(entry)
      most = max(coarsest_grade - finest_grade + 1, size(asked%step))
      allocate (terms%steps(n), source=0)
      allocate (terms%in_steps(n), source=.false.)
      allocate (terms%graded(n), source=.false.)
      allocate (terms%kind(most, n), source=0)
      allocate (terms%step(most, n), terms%step_cost(most, n), source=0.0_wp)
      do i = 1, n
         if (entry(i) == 0) cycle
         call steps_of(asked, entry(i), sizes(i), kinds, tolerance)
         terms%in_steps(i) = asked%finest(entry(i)) > 0 .or. asked%table(entry(i)) > 0
         terms%graded(i) = asked%finest(entry(i)) > 0
         factor = merge(terms%cost(i), 1.0_wp, own_cost(i))
         do k = 1, size(kinds)
            if (tolerance(k) < asked%low(entry(i))*(1.0_wp - rounding)) cycle
            if (asked%high(entry(i)) > 0.0_wp .and. tolerance(k) > asked%high(entry(i))*(1.0_wp + rounding)) cycle
            terms%steps(i) = terms%steps(i) + 1
            associate (at => terms%steps(i))
               terms%kind(at, i) = kinds(k)
               terms%step(at, i) = tolerance(k)
               if (.not. terms%graded(i)) then
                  terms%step_cost(at, i) = terms%fixed(i) + factor*asked%step_cost(kinds(k))
               else if (size(asked%grade_cost) > 0) then
                  terms%step_cost(at, i) = terms%fixed(i) + factor*asked%grade_cost(kinds(k) - finest_grade + 1)
               else
                  terms%step_cost(at, i) = terms%fixed(i) + terms%cost(i)*inverse_power(tolerance(k), terms%power(i))
               end if
            end associate
         end do
      end do
      do i = 1, n
         if (terms%graded(i) .or. terms%steps(i) == 0) cycle
         terms%kind(:terms%steps(i), i) = [(count(asked%step_table(:terms%kind(k, i)) == asked%table(entry(i))), &
                                            k=1, terms%steps(i))]
      end do
   end subroutine make_steps

   !> The steps of an entry of ALNAM, ascending: grades, or places in ALSTEP, and their tolerances; none: any tolerance.
   pure subroutine steps_of(asked, entry, nominal, kinds, tolerance)
      type(allocation_group_t), intent(in) :: asked
      integer, intent(in) :: entry
      real(wp), intent(in) :: nominal                 !! size, user's length; of grades
      integer, allocatable, intent(out) :: kinds(:)
      real(wp), allocatable, intent(out) :: tolerance(:) !! the same shape
      integer, allocatable :: order(:)
      integer :: k

      if (asked%finest(entry) > 0) then
         kinds = [(k, k=asked%finest(entry), asked%coarsest(entry))]
         tolerance = half*grade_width(kinds, asked%millimetres*abs(nominal))/asked%millimetres
         kinds = pack(kinds, tolerance > 0.0_wp)
         tolerance = pack(tolerance, tolerance > 0.0_wp)
      else if (asked%table(entry) > 0) then
         kinds = pack([(k, k=1, size(asked%step))], asked%step_table == asked%table(entry))
         order = ascending(asked%step(kinds))
         kinds = kinds(order)
         tolerance = asked%step(kinds)
      else
         allocate (kinds(0), tolerance(0))
      end if
   end subroutine steps_of

   !> What tolerances cost. With steps it is the largest step that is not above the tolerance; `huge` where there is none.
   pure function costs_of(terms, tolerance) result(costs)
      type(terms_t), intent(in) :: terms
      real(wp), intent(in) :: tolerance(:)            !! shape (dimensions)
      real(wp) :: costs(size(tolerance))
      integer :: i, k

      do i = 1, size(costs)
         if (.not. terms%in_steps(i)) then
            costs(i) = terms%fixed(i) + terms%cost(i)*inverse_power(tolerance(i), terms%power(i))
         else
            k = count(terms%step(:terms%steps(i), i) <= tolerance(i)*(1.0_wp + rounding))
            costs(i) = huge(1.0_wp)
            if (k > 0) costs(i) = terms%step_cost(k, i)
         end if
      end do
   end function costs_of

   !> The name of a dimension as ALNAM has it: small letters, names of joints as they are.
   pure function item_name(name)
      character(*), intent(in) :: name
      character(:), allocatable :: item_name
      integer :: at

      item_name = trim(name)
      at = index(item_name, ' ')
      if (is_by_joints(name) .or. is_play(name)) then
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

   !> True for the clearance of a joint.
   elemental logical function is_play(name)
      character(*), intent(in) :: name

      is_play = index(name, 'PLAY ') == 1
   end function is_play

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
         meant = .not. (is_angle .or. is_play(names))
      case ('PLAY *')
         meant = is_play(names)
      case ('ANGLE *')
         meant = is_angle
      case default
         pair = trim(name)
         if (index(upper_case(name), 'LENGTH ') == 1) pair = trim(adjustl(name(len('LENGTH '):)))
         blank = index(pair, ' ')
         do i = 1, size(names)
            if (is_play(names(i))) then
               meant(i) = names(i)(len('PLAY '):) == after(name, 'PLAY ')
            else if (.not. is_by_joints(names(i))) then
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
end module psalm_allocation_terms
