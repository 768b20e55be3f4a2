!> The motion of a linkage between its positions, proven: where it closes over a range of its input.
!>
!> Closure is proven in the working precision; what stays in doubt, the ends included, is looked at again in quadruple precision.
!> What is proven is true of the numbers as they were read, for every real input of the range. Recipe and formulas:
!> `doc/theory/proof.md`.
module psalm_proof
   use psalm_dimensions, only: dimensions_t
   use psalm_exact_sum, only: sign_of_sum
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_output_kind, only: output_kind_t, output_kind
   use psalm_place, only: beside_t
   use psalm_plan, only: plan_t, root_crank, root_frame
   use psalm_proof_closure, only: piece_t, find_pieces
   use psalm_proof_closure_quad, only: fine_piece_t => piece_t, find_fine_pieces => find_pieces, join_pieces
   use psalm_proof_groups, only: numbers_t, models_t, prepare_models
   use psalm_proof_groups_quad, only: fine_numbers_t => numbers_t, fine_models_t => models_t, prepare_fine_models => prepare_models
   use psalm_proof_pieces, only: piece_closes, piece_opens, piece_undecided
   use psalm_proof_plan, only: proof_plan_t, proof_step_t, make_proof_plan, path_of, cause_too_short, cause_difference, &
                               cause_guide, cause_link, cause_parallel
   use psalm_quad, only: qp, unit_vector_quad
   implicit none (type, external)
   private
   public :: proof_t, limit_t, proof_linkage_t, prepare_proof, bind_proof, ready_proof, prove_closure
   public :: touch_none, touch_exact, rounded
   public :: piece_closes, piece_opens, piece_undecided, cause_too_short, cause_difference, cause_guide, &
             cause_link, cause_parallel

   integer, parameter :: touch_none = 0
   integer, parameter :: touch_exact = 1      !! the lengths as given add up exactly: a change point

   real(qp), parameter :: right_angle = 90.0_qp
   integer, parameter :: first_boxes = 8
   integer, parameter :: most_boxes = 20000, most_fine_boxes = 2000

   !> A linkage made ready for proofs.
   type :: proof_linkage_t
      type(proof_plan_t) :: plan
      type(numbers_t) :: numbers
      type(models_t) :: models
      type(fine_numbers_t) :: fine_numbers
      type(fine_models_t) :: fine_models
      integer :: output_motion = -1             !! MOTION; -1: there is no output
      integer, allocatable :: output_path(:)    !! steps to the output point; empty: the output is none
      integer :: pivot = 0, tip = 0             !! steps: from the machine's origin to the input pivot, the output arc; 0: none
      integer, allocatable :: beside(:)         !! by joint asked for: the step from a point of the plan to it; 0: it is the point
      type(beside_t), allocatable :: lines(:)   !! of those steps
      integer :: output_arc = 0                 !! the arc that the output arc hangs on, or that is the output
      real(wp) :: output_x = 1.0_wp, output_y = 0.0_wp !! unit vector of the output arc from its root
   end type proof_linkage_t

   !> A part of the range and what is proven of it.
   type :: limit_t
      integer :: kind = piece_undecided   !! one of `piece_...`
      real(wp) :: from = 0.0_wp, to = 0.0_wp !! of what is claimed rounded inwards, of what is undecided outwards
      integer :: loop = 0                 !! open or undecided: the loop
      integer :: cause = 0                !! one of `cause_...`
      integer :: touch = touch_none       !! undecided: one of `touch_...`
      real(wp) :: amount = 0.0_wp         !! undecided: bound of the closure measure, relative
   end type limit_t

   type :: proof_t
      logical :: turns = .true.           !! the input turns
      real(wp) :: from = 0.0_wp, to = 0.0_wp !! range of the input, degrees or length
      type(limit_t), allocatable :: limits(:) !! in the order of the input
      integer :: boxes = 0, fine_boxes = 0 !! evaluated in working and in quadruple precision
   contains
      procedure :: closes_everywhere
      procedure :: closes_at
   end type proof_t

contains

   !> Make a topology ready.
   pure subroutine prepare_proof(mechanism, plan, linkage, placed, beside)
      type(mechanism_t), intent(in) :: mechanism
      type(plan_t), intent(in) :: plan       !! of the same mechanism; what is not in it is not proven
      type(proof_linkage_t), intent(out) :: linkage
      logical, intent(in), optional :: placed !! places of points in the machine are asked for, whatever the output
      type(beside_t), intent(in), optional :: beside(:) !! shape (joints of the plan): how far from its points; only if `placed`

      call make_proof_plan(mechanism, plan, linkage%plan)
      call add_output(mechanism, plan, placed, linkage)
      allocate (linkage%beside(size(plan%joint_points)), source=0)
      allocate (linkage%lines(0))
      if (present(beside)) call add_lines(plan, beside, linkage)
   end subroutine prepare_proof

   !> The way to the output point: an arc from the machine's origin to the input pivot, the plan's arcs, the output arc.
   pure subroutine add_output(mechanism, plan, placed, linkage)
      type(mechanism_t), intent(in) :: mechanism
      type(plan_t), intent(in) :: plan
      logical, intent(in), optional :: placed
      type(proof_linkage_t), intent(inout) :: linkage
      type(output_kind_t) :: kind
      type(proof_step_t) :: pivot, tip
      integer :: n, base
      logical :: wanted

      allocate (linkage%output_path(0))
      if (.not. mechanism%outputs(1)%stands_in) then
         linkage%output_motion = mechanism%outputs(1)%motion
         kind = output_kind(linkage%output_motion)
      end if
      n = size(plan%root)
      base = mechanism%outputs(1)%arc
      linkage%output_arc = base
      wanted = kind%has_point
      if (present(placed)) wanted = wanted .or. placed
      if (.not. wanted) return
      pivot%arc = n + 1
      pivot%fixed = .true.
      tip%arc = n + 2
      ! both lead to no point of the plan
      associate (proof => linkage%plan)
         proof%root = [proof%root, root_frame, plan%root(base)]
         proof%slot = [proof%slot, 0, 0]
         linkage%pivot = size(proof%steps) + 1
         linkage%tip = size(proof%steps) + 2
         if (kind%has_point) linkage%output_path = [linkage%pivot, path_of(proof, plan%output_point), linkage%tip]
         proof%steps = [proof%steps, pivot, tip]
      end associate
   end subroutine add_output

   !> Lines to joints that are no points of the plan, each an arc with the direction of one of its arcs.
   pure subroutine add_lines(plan, beside, linkage)
      type(plan_t), intent(in) :: plan
      type(beside_t), intent(in) :: beside(:)
      type(proof_linkage_t), intent(inout) :: linkage
      type(proof_step_t) :: line
      integer :: j

      associate (proof => linkage%plan)
         do j = 1, size(beside)
            if (beside(j)%distance <= 0.0_wp) cycle
            line%fixed = beside(j)%arc == 0
            if (line%fixed) then
               proof%root = [proof%root, root_frame]
            else
               proof%root = [proof%root, plan%root(beside(j)%arc)]
            end if
            proof%slot = [proof%slot, 0]
            line%arc = size(proof%root)
            proof%steps = [proof%steps, line]
            linkage%beside(j) = size(proof%steps)
            linkage%lines = [linkage%lines, beside(j)]
         end do
      end associate
   end subroutine add_lines

   !> Put the numbers of a linkage in. Cosines are formed in quadruple precision from the degrees as given.
   subroutine bind_proof(plan, dimensions, linkage, zero)
      type(plan_t), intent(in) :: plan
      type(dimensions_t), intent(in) :: dimensions
      type(proof_linkage_t), intent(inout) :: linkage
      real(wp), intent(in), optional :: zero     !! crank angle, or length of the actuator, at input 0; default 0
      real(qp) :: angle(size(plan%root)), x, y
      integer :: k, n, b

      angle = 0.0_qp
      do k = 1, size(plan%order)
         n = plan%order(k)
         b = plan%base(n)
         if (plan%takes_gama(n)) angle(n) = real(dimensions%gama(n), qp)
         if (b > 0) angle(n) = angle(n) + angle(b) + right_angle*real(plan%quarter(n), qp)
         if (b > 0 .or. .not. present(zero) .or. linkage%plan%sliding_input) cycle
         if (plan%root(n) == root_crank) angle(n) = angle(n) + real(zero, qp)
      end do
      call unit_vector_quad(angle(linkage%output_arc) + real(dimensions%outang, qp), x, y)
      linkage%output_x = real(x, wp)
      linkage%output_y = real(y, wp)
      if (linkage%pivot == 0) then
         call take_numbers(dimensions%arcl, angle, linkage)
      else
         call take_numbers([dimensions%arcl, dimensions%origlk, dimensions%outlk, linkage%lines%distance], &
                           [angle, real(dimensions%origng, qp), angle(linkage%output_arc) + real(dimensions%outang, qp), &
                            [(angle_of(linkage%lines(k)), k=1, size(linkage%lines))]], linkage)
      end if
      if (.not. present(zero) .or. .not. linkage%plan%sliding_input) return
      linkage%numbers%zero = zero
      linkage%fine_numbers%zero = real(zero, qp)

   contains

      pure real(qp) function angle_of(line)
         type(beside_t), intent(in) :: line

         angle_of = real(line%angle, qp)
         if (line%arc > 0) angle_of = angle_of + angle(line%arc)
      end function angle_of
   end subroutine bind_proof

   !> A linkage that is a plan and its dimensions by arc, made ready.
   subroutine ready_proof(plan, lengths, angles, linkage)
      type(proof_plan_t), intent(in) :: plan
      real(wp), intent(in) :: lengths(:), angles(:)   !! shape (arcs): angles from the roots, degrees
      type(proof_linkage_t), intent(out) :: linkage

      linkage%plan = plan
      allocate (linkage%output_path(0), linkage%beside(0), linkage%lines(0))
      call take_numbers(lengths, real(angles, qp), linkage)
   end subroutine ready_proof

   subroutine take_numbers(lengths, angles, linkage)
      real(wp), intent(in) :: lengths(:)
      real(qp), intent(in) :: angles(:)               !! degrees
      type(proof_linkage_t), intent(inout) :: linkage
      integer :: n

      associate (fine => linkage%fine_numbers, rough => linkage%numbers)
         fine%x = 0.0_qp*angles
         fine%y = fine%x
         do n = 1, size(angles)
            call unit_vector_quad(angles(n), fine%x(n), fine%y(n))
         end do
         ! the longest arc between 1 and 2: a power of two changes no digit
         rough%scale = scale(1.0_wp, 1 - exponent(maxval(lengths)))
         fine%scale = real(rough%scale, qp)
         rough%length = lengths*rough%scale
         fine%length = real(rough%length, qp)
         rough%x = real(fine%x, wp)
         rough%y = real(fine%y, wp)
         rough%length_slack = 0.0_wp*rough%length
         rough%turn_slack = rough%length_slack
         fine%length_slack = real(rough%length_slack, qp)
         fine%turn_slack = fine%length_slack
      end associate
      call prepare_models(linkage%plan, linkage%numbers, linkage%models)
      call prepare_fine_models(linkage%plan, linkage%fine_numbers, linkage%fine_models)
   end subroutine take_numbers

   !> Where the linkage closes between two inputs.
   subroutine prove_closure(linkage, from, to, proof)
      type(proof_linkage_t), intent(inout) :: linkage  !! bound
      real(wp), intent(in) :: from, to           !! from < to; degrees of a turning input, else its length
      type(proof_t), intent(out) :: proof
      type(piece_t), allocatable :: pieces(:)
      type(fine_piece_t), allocatable :: fine(:), part(:), joined(:)
      integer :: i, count

      proof%turns = .not. linkage%plan%sliding_input
      proof%from = from
      proof%to = to
      call find_pieces(linkage%plan, linkage%numbers, from, to, first_boxes, most_boxes, linkage%models, pieces, proof%boxes)
      allocate (fine(0))
      do i = 1, size(pieces)
         associate (piece => pieces(i))
            if (piece%kind == piece_undecided) then
               call find_fine_pieces(linkage%plan, linkage%fine_numbers, real(piece%from, qp), real(piece%to, qp), 1, &
                                     most_fine_boxes, linkage%fine_models, part, count)
               proof%fine_boxes = proof%fine_boxes + count
               fine = [fine, part]
            else
               fine = [fine, fine_piece_t(real(piece%from, qp), real(piece%to, qp), piece%kind, piece%measure, 0.0_qp)]
            end if
         end associate
      end do
      call join_pieces(fine, joined)
      allocate (proof%limits(size(joined)))
      do i = 1, size(joined)
         proof%limits(i) = limit_of(linkage, joined(i))
      end do
      proof%limits = pack(proof%limits, proof%limits%from <= proof%limits%to)
   end subroutine prove_closure

   !> A piece in working precision.
   pure type(limit_t) function limit_of(linkage, piece) result(limit)
      type(proof_linkage_t), intent(in) :: linkage
      type(fine_piece_t), intent(in) :: piece

      limit%kind = piece%kind
      if (piece%kind == piece_undecided) then
         limit%from = rounded(piece%from, -1)
         limit%to = rounded(piece%to, 1)
      else
         limit%from = rounded(piece%from, 1)
         limit%to = rounded(piece%to, -1)
      end if
      if (piece%measure == 0) return
      limit%loop = linkage%plan%loop_of(piece%measure)
      limit%cause = linkage%plan%cause_of(piece%measure)
      if (piece%kind /= piece_undecided) return
      limit%amount = real(min(piece%amount, 1.0_qp), wp)
      if (is_change_point(linkage, limit)) limit%touch = touch_exact
   end function limit_of

   !> To working precision, down (-1) or up (+1).
   pure real(wp) function rounded(value, way)
      real(qp), intent(in) :: value
      integer, intent(in) :: way

      rounded = real(value, wp)
      if (way < 0 .and. real(rounded, qp) > value) rounded = nearest(rounded, -1.0_wp)
      if (way > 0 .and. real(rounded, qp) < value) rounded = nearest(rounded, 1.0_wp)
   end function rounded

   !> True if the links of a four-bar can lie in one line at an input of the bracket, exactly: the lengths as given add up.
   pure logical function is_change_point(linkage, limit)
      type(proof_linkage_t), intent(in) :: linkage
      type(limit_t), intent(in) :: limit
      real(wp) :: lengths(4)
      logical :: found

      is_change_point = .false.
      if (limit%cause /= cause_too_short .and. limit%cause /= cause_difference) return
      call four_bar_of(linkage, limit%loop, lengths, found)
      if (.not. found) return
      associate (crank => lengths(1), p => lengths(2), q => lengths(3), frame => lengths(4))
         if (limit%cause == cause_too_short) then
            is_change_point = sign_of_sum([crank, frame, -p, -q]) == 0
         else
            is_change_point = sign_of_sum([max(crank, frame), min(p, q), -min(crank, frame), -max(p, q)]) == 0
         end if
      end associate
   end function is_change_point

   !> Crank, links and frame of a loop that is a four-bar with the crank itself and one arc of the frame.
   pure subroutine four_bar_of(linkage, loop, lengths, found)
      type(proof_linkage_t), intent(in) :: linkage
      integer, intent(in) :: loop
      real(wp), intent(out) :: lengths(4)
      logical, intent(out) :: found
      integer :: k, i, crank, frame

      found = .false.
      lengths = 0.0_wp
      do k = 1, size(linkage%plan%steps)
         associate (step => linkage%plan%steps(k))
            if (.not. step%dyad .or. step%loop /= loop) cycle
            if (size(step%terms) /= 2) return
            crank = 0
            frame = 0
            do i = 1, 2
               associate (arc => linkage%plan%steps(step%terms(i))%arc)
                  if (linkage%plan%slot(arc) > 0) return
                  if (linkage%plan%root(arc) == root_crank) crank = arc
                  if (linkage%plan%root(arc) == root_frame) frame = arc
               end associate
            end do
            found = crank > 0 .and. frame > 0 .and. .not. linkage%plan%sliding_input
            if (found) lengths = linkage%numbers%length([crank, step%p, step%q, frame])
         end associate
      end do
   end subroutine four_bar_of

   !> True if every group closes at every input of the range.
   pure logical function closes_everywhere(self)
      class(proof_t), intent(in) :: self

      closes_everywhere = all(self%limits%kind == piece_closes)
   end function closes_everywhere

   !> Number of the closing part of the range that holds an input; 0: none.
   pure integer function closes_at(self, input)
      class(proof_t), intent(in) :: self
      real(wp), intent(in) :: input

      do closes_at = 1, size(self%limits)
         associate (limit => self%limits(closes_at))
            if (limit%kind == piece_closes .and. limit%from <= input .and. input <= limit%to) return
         end associate
      end do
      closes_at = 0
   end function closes_at
end module psalm_proof
