!> What the best linkages of a search among kinds are like, in the numbers by which a designer chooses.
module psalm_kind_choice
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kind_search, only: kind_study_t
   use psalm_kinds, only: wp
   use psalm_margins, only: inspector_t, prepare_inspector
   use psalm_mechanism, only: arc_crank, arc_determined, arc_link, body_frame
   use psalm_proof, only: proof_linkage_t
   use psalm_proof_study, only: proof_study_t, study_closure, proof_of_inputs, proof_of_turn
   use psalm_ranking, only: ranked_t, rate_linkage
   implicit none (type, external)
   private
   public :: choice_t, look_at_choice, unbeaten_choices
   public :: proven_unknown, proven_not, proven_closes

   integer, parameter :: proven_unknown = 0, proven_not = 1, proven_closes = 2

   type :: choice_t
      type(ranked_t) :: is
      integer :: links = 0, joints = 0          !! frame included; pins and slides between two links each
      real(wp) :: length = 0.0_wp               !! of all moving links: the lengths of their arcs, that of the output point included
      integer :: proof = proven_unknown         !! that it closes over the turn, or over the inputs
   end type choice_t

contains

   !> Look at the best linkage of each case of a study.
   subroutine look_at_choice(study, choices)
      class(kind_study_t), intent(in) :: study
      type(choice_t), allocatable, intent(out) :: choices(:) !! shape (cases)
      class(problem_t), allocatable :: problem
      class(inspector_t), allocatable :: inspector
      type(dimensions_t) :: dimensions
      integer :: k

      allocate (choices(size(study%sets)))
      do k = 1, size(choices)
         associate (set => study%sets(k), prepared => study%prepared(k), choice => choices(k))
            allocate (problem, inspector)
            call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
            call prepare_inspector(set, problem, .true., inspector)
            call rate_linkage(set, problem, inspector, prepared%found%best(1), choice%is)
            choice%links = size(set%sketch%links)
            choice%joints = size(set%sketch%slides) + joints_of(set)
            dimensions = prepared%given
            call prepared%parameters%apply(prepared%found%best(1)%values, dimensions)
            choice%length = length_of(problem, dimensions) + dimensions%outlk
            if (.not. set%is_beyond_arrays()) choice%proof = proof_of(problem, dimensions, choice%is%turns)
            deallocate (problem, inspector)
         end associate
      end do
   end subroutine look_at_choice

   !> Pins, each between two links: one that k links share counts k - 1.
   pure integer function joints_of(set)
      type(data_set_t), intent(in) :: set
      integer :: j

      joints_of = 0
      do j = 1, size(set%sketch%joint_name)
         joints_of = joints_of + size(set%sketch%links_of(j)) - 1
      end do
   end function joints_of

   pure real(wp) function length_of(problem, dimensions)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      integer :: n

      length_of = 0.0_wp
      do n = 1, size(dimensions%arcl)
         associate (arc => problem%mechanism%arcs(n))
            if (all(arc%kind /= [arc_crank, arc_determined, arc_link])) cycle
            if (arc%representative /= n .or. arc%frame .or. arc%body == body_frame) cycle
            length_of = length_of + dimensions%arcl(n)
         end associate
      end do
   end function length_of

   !> Whether the linkage closes, proven.
   integer function proof_of(problem, dimensions, turns)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in) :: turns
      type(proof_study_t), allocatable :: study
      type(proof_linkage_t), allocatable :: linkage

      allocate (study, linkage)
      call study_closure(problem, dimensions, merge(proof_of_turn, proof_of_inputs, turns), study, linkage)
      proof_of = proven_unknown
      if (study%empty) return
      proof_of = merge(proven_closes, proven_not, study%proof%closes_everywhere())
   end function proof_of

   !> A number of a choice, so that less is better.
   pure real(wp) function figure_of_choice(choice, which) result(figure)
      type(choice_t), intent(in) :: choice
      integer, intent(in) :: which              !! its place in `weighable`

      select case (which)
      case (1)
         figure = choice%is%rms
      case (2)
         figure = choice%is%largest
      case (3)
         figure = -choice%is%angle
      case (4)
         figure = choice%is%ratio
      case (5)
         figure = max(choice%is%width, choice%is%height)
      case (6)
         figure = choice%length
      case (7)
         figure = real(choice%links, wp)
      case default
         figure = real(choice%joints, wp)
      end select
   end function figure_of_choice

   !> Those than which none other is at least as good in both numbers and better in one.
   pure function unbeaten_choices(choices, weighed) result(unbeaten)
      type(choice_t), intent(in) :: choices(:)
      integer, intent(in) :: weighed(2)         !! places in `weighable`
      logical :: unbeaten(size(choices))
      real(wp) :: figure(2, size(choices))
      integer :: i, k

      do k = 1, size(choices)
         figure(:, k) = [(figure_of_choice(choices(k), weighed(i)), i=1, 2)]
      end do
      do k = 1, size(choices)
         unbeaten(k) = .not. any([(all(figure(:, i) <= figure(:, k)) .and. any(figure(:, i) < figure(:, k)), i=1, size(choices))])
      end do
   end function unbeaten_choices
end module psalm_kind_choice
