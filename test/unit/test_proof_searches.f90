!> Linkages found by searches: what the search says of them, by looking at its inputs, against what is proven.
!>
!> An argument is the number of searches of each problem, a second one the first seed.
program test_proof_searches
   use cases, only: load_case
   use check, only: checks_t, number_argument
   use psalm_constraint_group, only: range_turn
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, full_turn, right_angle
   use psalm_margins, only: inspector_t, margin_t, prepare_inspector, inspect, is_violated, margin_angle
   use psalm_plan, only: plan_t, make_plan
   use psalm_proof, only: proof_t, proof_linkage_t, prepare_proof, bind_proof, prove_closure
   use psalm_proof_ranges, only: proven_extreme_t, extreme_angle, prove_extremes
   use psalm_search, only: result_t, search_many
   use psalm_stop, only: stop_t
   implicit none (type, external)

   character(*), parameter :: problems(3) = [character(15) :: 'paths/line6', 'paths/ellipse10', 'paths/ten10']
   integer, parameter :: starts = 6, kept = 6
   real(wp), parameter :: near = 1.0e-4_wp       !! degrees, to which a margin looked for is found
   type(checks_t) :: t
   integer :: k, seed, found, agree, at_limit, open, margins_off

   found = 0
   agree = 0
   at_limit = 0
   open = 0
   margins_off = 0
   do k = 1, size(problems)
      do seed = number_argument(2, 1), number_argument(2, 1) + number_argument(1, 1) - 1
         call search_and_prove(trim(problems(k)), seed)
      end do
   end do
   if (command_argument_count() > 0) print '(5(a,i0))', 'linkages found ', found, ', verdicts that agree ', agree, &
      ', at their limit within rounding ', at_limit, ', open though found sound ', open, ', margins that differ ', margins_off
   call t%is_true(found >= 5, 'searches find linkages')
   call t%equal_integer(agree + at_limit, found, 'searches and proofs agree')
   call t%equal_integer(margins_off, 0, 'margins that a search lists lie in their proven brackets')
   call t%report()

contains

   subroutine search_and_prove(name, seed)
      character(*), intent(in) :: name
      integer, intent(in) :: seed
      class(problem_t), allocatable :: problem
      type(data_set_t), target :: set
      type(result_t) :: result
      type(stop_t) :: never
      class(inspector_t), allocatable :: inspector
      type(proof_linkage_t) :: linkage
      type(dimensions_t) :: dimensions
      type(plan_t) :: plan
      real(wp), allocatable :: none(:, :)
      integer :: i

      allocate (problem, inspector)
      call load_case(name, problem, set)
      set%method%istart = seed
      set%search%nstart = starts
      set%search%nbest = kept
      set%constr%irange = range_turn
      allocate (none(size(problem%parameters%variables), 0))
      call search_many(set, problem, problem%parameters%first_values(problem%given), none, 1, never, result)
      call prepare_inspector(set, problem, .true., inspector)
      plan = make_plan(problem%mechanism, problem%motion, everything=.false., all_roots=.false.)
      call prepare_proof(problem%mechanism, plan, linkage)
      do i = 1, size(result%best)
         dimensions = problem%given
         call problem%parameters%apply(result%best(i)%values, dimensions)
         call bind_proof(plan, dimensions, linkage)
         call compare(inspector, linkage, dimensions, result%best(i)%delt, set%limits%tangle)
      end do
   end subroutine search_and_prove

   !> Verdicts and margins of one linkage that a search holds for valid.
   subroutine compare(inspector, linkage, dimensions, delt, tangle)
      type(inspector_t), intent(inout) :: inspector
      type(proof_linkage_t), intent(inout) :: linkage
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: delt(:), tangle
      type(margin_t), allocatable :: margins(:)
      type(proven_extreme_t), allocatable :: extremes(:)
      type(proof_t) :: proof
      real(wp) :: least, slack
      integer :: boxes(2), i, k
      logical :: valid

      found = found + 1
      call inspect(inspector, dimensions, delt, margins)
      valid = .not. any(is_violated(margins))
      call prove_closure(linkage, 0.0_wp, full_turn, proof)
      call prove_extremes(linkage, proof, extremes, boxes)
      ! how near the worst angle is to its limit
      least = huge(least)
      do i = 1, size(extremes)
         if (extremes(i)%kind /= extreme_angle) cycle
         slack = min(extremes(i)%least_low - (right_angle - tangle), right_angle + tangle - extremes(i)%greatest_high)
         least = min(least, slack)
         do k = 1, size(margins)
            if (margins(k)%kind /= margin_angle .or. margins(k)%which /= extremes(i)%loop) cycle
            if (abs(margins(k)%margin - slack) > near) margins_off = margins_off + 1
         end do
      end do
      if (proof%closes_everywhere() .eqv. valid) then
         agree = agree + 1
      else if (valid .and. abs(least) <= near) then
         at_limit = at_limit + 1
      else
         open = open + 1
      end if
   end subroutine compare
end program test_proof_searches
