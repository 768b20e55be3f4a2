!> What is proven of the motion of a case, and where its prescribed positions lie.
!>
!> Data in, results out: nothing is printed or worded here.
module psalm_proof_study
   use psalm_angles, only: within_turn
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, full_turn
   use psalm_plan, only: plan_t, make_plan
   use psalm_proof, only: proof_t, subject_t, prepare_subject, bind_subject, prove_closure, piece_closes
   use psalm_proof_ranges, only: extreme_t, prove_extremes, prove_tolerance
   implicit none (type, external)
   private
   public :: proof_study_t, study_proof, proof_of_turn, proof_of_inputs

   integer, parameter :: proof_of_turn = 1   !! IPROOF: over a full turn (a sliding input: over the range of the inputs)
   integer, parameter :: proof_of_inputs = 2 !! IPROOF: over the range of the prescribed inputs

   real(wp), parameter :: part_of_longest = 0.1_wp !! of the longest arc: the largest deviation tried

   type :: proof_study_t
      logical :: empty = .false.             !! all inputs are the same: there is no range
      logical :: full_turn = .false.         !! the range is a full turn, whose end is its beginning
      type(proof_t) :: proof
      type(extreme_t), allocatable :: extremes(:)
      real(wp) :: tolerance = 0.0_wp         !! deviations of all lengths for which it is proven to close over the range
      real(wp) :: largest_tried = 0.0_wp     !! larger ones were not tried
      integer, allocatable :: circuit(:)     !! by prescribed position: number of the part that closes without a gap; 0: none
      integer :: circuits = 0                !! such parts that hold prescribed positions
   contains
      procedure :: is_violating
   end type proof_study_t

contains

   !> Prove the motion of a linkage. Every loop is looked at, wanted by the output or not.
   subroutine study_proof(problem, dimensions, range, study)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: range                 !! one of `proof_of_...`
      type(proof_study_t), intent(out) :: study
      type(subject_t), allocatable :: subject
      type(plan_t) :: plan
      real(wp) :: from, to
      integer :: boxes(2)

      study%full_turn = range == proof_of_turn .and. .not. problem%mechanism%sliding_input
      from = 0.0_wp
      to = full_turn
      if (.not. study%full_turn) then
         from = dimensions%crnki + minval(problem%delt)
         to = dimensions%crnki + maxval(problem%delt)
      end if
      study%empty = .not. from < to
      if (study%empty) return
      plan = make_plan(problem%mechanism, problem%motion, everything=.true., all_roots=.false.)
      allocate (subject)
      call prepare_subject(problem%mechanism, plan, subject)
      call bind_subject(plan, dimensions, subject)
      call prove_closure(subject, from, to, study%proof)
      call prove_extremes(subject, study%proof, study%extremes, boxes)
      if (study%proof%closes_everywhere()) then
         study%largest_tried = part_of_longest*maxval(dimensions%arcl)
         call prove_tolerance(subject, from, to, study%largest_tried, study%tolerance)
      end if
      call place_positions(dimensions%crnki + problem%delt, study)
   end subroutine study_proof

   !> Which part of the range that closes without a gap holds each prescribed position.
   pure subroutine place_positions(inputs, study)
      real(wp), intent(in) :: inputs(:)            !! shape (positions)
      type(proof_study_t), intent(inout) :: study
      real(wp) :: input
      integer :: i, last, count
      logical :: joined

      allocate (study%circuit(size(inputs)), source=0)
      associate (limits => study%proof%limits)
         last = size(limits)
         joined = study%full_turn .and. last > 1 .and. limits(1)%kind == piece_closes .and. limits(last)%kind == piece_closes
         do i = 1, size(inputs)
            input = inputs(i)
            if (study%full_turn) input = within_turn(input)
            study%circuit(i) = study%proof%closes_at(input)
            if (joined .and. study%circuit(i) == last) study%circuit(i) = 1
         end do
         count = 0
         do i = 1, last
            if (any(study%circuit == i)) count = count + 1
         end do
      end associate
      study%circuits = count
   end subroutine place_positions

   !> True unless the linkage is proven to close over the whole range.
   pure logical function is_violating(self)
      class(proof_study_t), intent(in) :: self

      is_violating = .not. self%empty
      if (is_violating) is_violating = .not. self%proof%closes_everywhere()
   end function is_violating
end module psalm_proof_study
