!> What is proven of the motion of a case, and where its prescribed positions lie.
!>
!> Data in, results out: nothing is printed or worded here.
module psalm_proof_study
   use psalm_angles, only: within_turn
   use psalm_constraint_group, only: range_inputs, range_turn
   use psalm_data_set, only: data_set_t, proof_by_default
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, full_turn
   use psalm_plan, only: plan_t, make_plan
   use psalm_proof, only: proof_t, subject_t, prepare_subject, bind_subject, prove_closure, piece_closes
   use psalm_proof_motion, only: movement_t, span_t, prove_movement
   use psalm_proof_ranges, only: extreme_t, prove_extremes, prove_tolerance, extreme_output, extreme_distance, extreme_ratio
   use psalm_summary, only: loop_kind_t, kinds_of
   implicit none (type, external)
   private
   public :: proof_study_t, study_proof, study_closure, proof_wanted, no_proof, proof_of_turn, proof_of_inputs

   integer, parameter :: no_proof = 0
   integer, parameter :: proof_of_turn = 1   !! IPROOF: over a full turn (a sliding input: over the range of the inputs)
   integer, parameter :: proof_of_inputs = 2 !! IPROOF: over the range of the prescribed inputs

   real(wp), parameter :: part_of_longest = 0.1_wp !! of the longest arc: the largest deviation tried

   type :: proof_study_t
      logical :: empty = .false.             !! all inputs are the same: there is no range
      logical :: full_turn = .false.         !! the range is a full turn, whose end is its beginning
      type(proof_t) :: proof
      type(extreme_t), allocatable :: extremes(:)
      type(loop_kind_t), allocatable :: kinds(:) !! of loops that are a four-bar, by the lengths exactly as given
      type(movement_t) :: movement           !! dead points, velocity ratio, strokes, dwells
      real(wp) :: dwell = 0.0_wp             !! amount of a dwell, degrees or length; 0: none are looked for
      real(wp) :: tolerance = 0.0_wp         !! deviations of all lengths for which it is proven to close over the range
      real(wp) :: largest_tried = 0.0_wp     !! larger ones were not tried
      integer, allocatable :: circuit(:)     !! by prescribed position: number of the part that closes without a gap; 0: none
      integer :: circuits = 0                !! such parts that hold prescribed positions
   contains
      procedure :: is_violating
   end type proof_study_t

contains

   !> What IPROOF asks for; without it the result of a search is proven, and what IRANGE of &CONSTR speaks of.
   pure integer function proof_wanted(set, searched)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: searched              !! the linkage is the result of a search

      proof_wanted = set%iproof
      if (set%iproof /= proof_by_default) return
      proof_wanted = merge(proof_of_inputs, no_proof, searched)
      if (set%constr%given .and. set%constr%irange == range_inputs) proof_wanted = proof_of_inputs
      if (set%constr%given .and. set%constr%irange == range_turn) proof_wanted = proof_of_turn
   end function proof_wanted

   !> Prove the motion of a linkage. Every loop is looked at, wanted by the output or not.
   subroutine study_proof(problem, dimensions, range, dwell, study)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: range                 !! one of `proof_of_...`
      real(wp), intent(in) :: dwell                !! amount of a dwell; 0: none are looked for
      type(proof_study_t), intent(out) :: study
      type(problem_t), allocatable :: bound
      type(subject_t), allocatable :: subject

      allocate (subject)
      call study_closure(problem, dimensions, range, study, subject)
      if (study%empty) return
      allocate (bound, source=problem)
      call bound%bind(dimensions)
      study%kinds = kinds_of(bound, dimensions, .true.)
      study%dwell = dwell
      call prove_movement(subject, study%proof, dwell, study%movement)
      call add_output(study)
      if (.not. study%proof%closes_everywhere()) return
      study%largest_tried = part_of_longest*maxval(dimensions%arcl)
      call prove_tolerance(subject, study%proof%from, study%proof%to, study%largest_tried, study%tolerance)
   end subroutine study_proof

   !> Prove where a linkage closes, and how far its transmission angles, slides and output point go there.
   subroutine study_closure(problem, dimensions, range, study, subject)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: range                 !! one of `proof_of_...`
      type(proof_study_t), intent(out) :: study
      type(subject_t), intent(out) :: subject      !! what was proven, ready for more
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
      call prepare_subject(problem%mechanism, plan, subject)
      call bind_subject(plan, dimensions, subject)
      call prove_closure(subject, from, to, study%proof)
      call prove_extremes(subject, study%proof, study%extremes, boxes)
      call place_positions(dimensions%crnki + problem%delt, study)
   end subroutine study_closure

   !> Extremes of the output and of its rate beside the others.
   subroutine add_output(study)
      type(proof_study_t), intent(inout) :: study

      associate (movement => study%movement)
         if (movement%has_output .and. .not. movement%turns_fully) &
            call add(merge(extreme_output, extreme_distance, movement%is_angle), movement%output)
         if (movement%has_ratio .and. movement%ratio_bounded) call add(extreme_ratio, movement%ratio)
      end associate

   contains

      subroutine add(kind, spans)
         integer, intent(in) :: kind
         type(span_t), intent(in) :: spans(2)
         type(extreme_t) :: extreme

         extreme%kind = kind
         extreme%found = .true.
         extreme%least_low = spans(1)%low
         extreme%least_high = spans(1)%high
         extreme%least_at = spans(1)%at
         extreme%greatest_low = spans(2)%low
         extreme%greatest_high = spans(2)%high
         extreme%greatest_at = spans(2)%at
         study%extremes = [study%extremes, extreme]
      end subroutine add
   end subroutine add_output

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
