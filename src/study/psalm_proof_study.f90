!> What is proven of the motion of a case, and where its prescribed positions lie.
!>
!> Data in, results out: nothing is printed or worded here.
module psalm_proof_study
   use psalm_angles, only: unit_vector
   use psalm_clearances, only: clearance_t, list_clearances, find_corners
   use psalm_constraint_group, only: range_inputs, range_positions, range_turn, region_box, region_half_plane, region_circle
   use psalm_data_set, only: data_set_t
   use psalm_limits_group, only: proof_by_default
   use psalm_dimensions, only: dimensions_t
   use psalm_dyad_kind, only: assur_rrr
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, full_turn, right_angle
   use psalm_mechanism, only: mechanism_t
   use psalm_output_kind, only: motion_point
   use psalm_parameters, only: no_parameters
   use psalm_place, only: beside_t
   use psalm_plan, only: plan_t, make_plan
   use psalm_proof, only: proof_t, proof_linkage_t, prepare_proof, bind_proof, prove_closure, piece_closes
   use psalm_proof_clearance, only: step_path_t, keeping_t, nearest_t, prove_clearance, apart_from_link, apart_from_corners, &
                                    within_edges, within_circle
   use psalm_proof_motion, only: movement_t, bracket_t, prove_movement
   use psalm_proof_plan, only: path_of
   use psalm_proven_margins, only: proven_margin_t, prove_margins
   use psalm_proof_ranges, only: proven_extreme_t, prove_extremes, prove_tolerance, extreme_output, extreme_distance, extreme_ratio
   use psalm_stop, only: stop_t, is_to_end
   use psalm_samples, only: sample_set_t, prepare_samples, linearise_samples
   use psalm_summary, only: loop_kind_t, kinds_of
   use psalm_shown_input, only: input_in_turn, reference_input, zero_input
   implicit none (type, external)
   private
   public :: touching, proof_study_t, kept_t, study_proof, study_closure, proof_wanted, no_proof, proof_of_turn, proof_of_inputs

   integer, parameter :: no_proof = 0
   integer, parameter :: proof_of_turn = 1   !! IPROOF: over a full turn (a sliding input: over the range of the inputs)
   integer, parameter :: proof_of_inputs = 2 !! item IPROOF: over the range of the prescribed inputs

   integer, parameter :: steps_of_corner = 360     !! of the range, for an estimate
   real(wp), parameter :: part_of_longest = 0.1_wp !! of the longest arc: the largest deviation tried

   real(wp), parameter :: touching = 1.0e-9_wp     !! of the longest arc: less below what is asked is rounding

   !> A clearance asked for, and what is proven of it.
   type :: kept_t
      type(clearance_t) :: clearance
      type(nearest_t) :: nearest
      logical :: is_broken = .false.         !! proven: less than asked
   end type kept_t

   type :: proof_study_t
      logical :: empty = .false.             !! all inputs are the same: there is no range
      logical :: stopped = .false.           !! the host asked for the end: what is there is no proof of the whole
      logical :: full_turn = .false.         !! the range is a full turn, whose end is its beginning
      real(wp) :: reference = 0.0_wp         !! the reference input as shown, degrees or length
      type(proof_t) :: proof
      type(proven_extreme_t), allocatable :: extremes(:)
      type(loop_kind_t), allocatable :: kinds(:) !! of loops that are a four-bar, by the lengths exactly as given
      type(movement_t) :: movement           !! dead points, velocity ratio, strokes, dwells
      real(wp) :: dwell = 0.0_wp             !! amount of a dwell, degrees or length; 0: none are looked for
      real(wp) :: tolerance = 0.0_wp         !! deviations of all lengths for which it is proven to close over the range
      real(wp) :: largest_tried = 0.0_wp     !! larger ones were not tried
      real(wp) :: worst_corner = 0.0_wp      !! deviations of the worst combination that opens it, first order; 0: none
      integer, allocatable :: circuit(:)     !! by prescribed position: number of the part that closes without a gap; 0: none
      integer :: circuits = 0                !! such parts that hold prescribed positions
      type(kept_t), allocatable :: kept(:)   !! clearances asked for in &CONSTR
      type(proven_margin_t), allocatable :: margins(:) !! of the dyads, where limits are asked for over this range
      logical :: trmin_given = .false.       !! the limit of angles is TRMIN
   contains
      procedure :: is_violating
      procedure :: is_open
   end type proof_study_t

contains

   !> What IPROOF asks for; without it the result of a search is proven, and what IRANGE of &CONSTR speaks of.
   pure integer function proof_wanted(set, searched)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: searched              !! the linkage is the result of a search

      proof_wanted = set%limits%iproof
      if (set%limits%iproof /= proof_by_default) return
      proof_wanted = merge(proof_of_inputs, no_proof, searched)
      if (set%constr%given .and. set%constr%irange == range_inputs) proof_wanted = proof_of_inputs
      if (set%constr%given .and. set%constr%irange == range_turn) proof_wanted = proof_of_turn
   end function proof_wanted

   !> Prove the motion of a linkage. Every loop is looked at, wanted by the output or not.
   subroutine study_proof(set, problem, dimensions, range, study, stop)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: range                 !! one of `proof_of_...`
      type(proof_study_t), intent(out) :: study
      type(stop_t), intent(in), optional :: stop   !! asked between the steps
      class(problem_t), allocatable :: bound
      type(proof_linkage_t), allocatable :: linkage
      type(plan_t) :: plan
      type(clearance_t), allocatable :: clearances(:)
      integer, allocatable :: joints(:, :)
      type(beside_t), allocatable :: beside(:)
      integer :: i

      call list_clearances(set%constr, problem%mechanism, dimensions%outlk <= 0.0_wp, clearances, joints, beside)
      call dimensions%put_aside(beside)
      ! asked for at the prescribed positions only, and no proof either
      if (set%constr%irange == range_positions .and. set%limits%iproof == proof_by_default) deallocate (clearances, joints)
      if (.not. allocated(clearances)) then
         allocate (clearances(0), joints(2, 0))
         deallocate (beside)
         allocate (beside(0))
      end if
      allocate (linkage)
      call begin_proof(problem, dimensions, range, joints, size(clearances) > 0, study, linkage, plan, beside)
      study%stopped = is_to_end(stop)
      if (study%empty .or. study%stopped) return
      allocate (bound, source=problem)
      call bound%bind(dimensions)
      study%kinds = kinds_of(bound, dimensions, .true.)
      study%dwell = set%limits%dwell
      call prove_movement(linkage, study%proof, set%limits%dwell, study%movement, stop)
      call add_output(study)
      study%stopped = is_to_end(stop)
      if (study%stopped) return
      if (study%proof%closes_everywhere()) then
         study%largest_tried = part_of_longest*maxval(dimensions%arcl)
         call prove_tolerance(linkage, study%proof%from, study%proof%to, study%largest_tried, study%tolerance)
         if (set%limits%iproof /= proof_by_default) call estimate_corner(problem, dimensions, study)
      end if
      if (study%proof%closes_everywhere() .and. covers_limits()) then
         study%trmin_given = set%limits%trmin_given
         ! a clearance has every loop solved, as with `inspect`
         study%margins = prove_margins(bound, dimensions, bound%linkage%step_of_loop > 0 .or. size(clearances) > 0, &
                                       set%limits%tangle, &
                                       merge(set%limits%toggle, 0.0_wp, set%search%solver%many_starts), study%extremes)
      end if
      deallocate (study%kept)
      allocate (study%kept(size(clearances)))
      do i = 1, size(clearances)
         study%stopped = is_to_end(stop)
         if (study%stopped) return
         associate (kept => study%kept(i))
            kept%clearance = clearances(i)
            call prove_clearance(linkage, study%proof, keeping_of(linkage, plan, clearances(i)), kept%nearest)
            kept%is_broken = kept%nearest%found .and. &
                             kept%nearest%high < clearances(i)%asked - touching*maxval(dimensions%arcl)
         end associate
      end do

   contains

      !> True if IRANGE asks for the limits over no more and no less than the range of the proof.
      pure logical function covers_limits()
         select case (set%constr%irange)
         case (range_inputs)
            covers_limits = range == proof_of_inputs .or. problem%mechanism%sliding_input
         case (range_turn)
            covers_limits = range == proof_of_turn
         case default
            covers_limits = .false.
         end select
      end function covers_limits
   end subroutine study_proof

   !> Prove where a linkage closes, and how far its transmission angles, slides and output point go there.
   subroutine study_closure(problem, dimensions, range, study, linkage)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: range                 !! one of `proof_of_...`
      type(proof_study_t), intent(out) :: study
      type(proof_linkage_t), intent(out) :: linkage      !! what was proven, ready for more
      type(plan_t) :: plan

      call begin_proof(problem, dimensions, range, reshape([integer ::], [2, 0]), .false., study, linkage, plan)
   end subroutine study_closure

   !> Closure and extremes; the linkage and the plan know the joints given.
   subroutine begin_proof(problem, dimensions, range, joints, placed, study, linkage, plan, beside)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: range                 !! one of `proof_of_...`
      integer, intent(in) :: joints(:, :)          !! shape (2, joints): loop and arc, as `make_plan` has them
      logical, intent(in) :: placed                !! places in the machine are asked for, that of the output point too
      type(proof_study_t), intent(out) :: study
      type(proof_linkage_t), intent(out) :: linkage
      type(plan_t), intent(out) :: plan
      type(beside_t), intent(in), optional :: beside(:) !! shape (joints): how far from there
      real(wp) :: from, to
      integer :: boxes(2)

      allocate (study%kept(0), study%margins(0))
      study%full_turn = range == proof_of_turn .and. .not. problem%mechanism%sliding_input
      study%reference = reference_input(problem%mechanism, dimensions)
      from = problem%mechanism%first_input
      to = from + full_turn
      if (.not. study%full_turn) then
         from = study%reference + minval(problem%delt)
         to = study%reference + maxval(problem%delt)
      end if
      study%empty = .not. from < to
      if (study%empty) return
      plan = make_plan(problem%mechanism, merge(motion_point, problem%motion, placed), everything=.true., all_roots=.true., &
                       joints=joints)
      call prepare_proof(problem%mechanism, plan, linkage, placed, beside)
      call bind_proof(plan, dimensions, linkage, zero_input(problem%mechanism, dimensions))
      call prove_closure(linkage, from, to, study%proof)
      call prove_extremes(linkage, study%proof, study%extremes, boxes)
      call place_positions(problem%mechanism, study%reference + problem%delt, study)
   end subroutine begin_proof

   !> The worst corner to first order: least over the range of what is left of a closure measure over the sum of its slopes.
   subroutine estimate_corner(problem, dimensions, study)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(proof_study_t), intent(inout) :: study
      class(problem_t), allocatable :: plain        ! large: they would fill a small stack
      class(sample_set_t), allocatable :: samples
      integer :: n, loop, i

      allocate (plain, samples)
      plain = problem
      plain%tangle = right_angle
      plain%spare = 0.0_wp
      plain%slide_angle = right_angle
      plain%toggle = 0.0_wp
      plain%parameters = no_parameters(problem%mechanism)
      do n = 1, size(problem%mechanism%arcs)
         if (problem%mechanism%arcs(n)%representative == n .and. .not. problem%mechanism%slides(n) .and. &
             dimensions%arcl(n) > 0.0_wp) call plain%parameters%vary_length(problem%mechanism, n)
      end do
      if (size(plain%parameters%variables) == 0) return
      ! a joint that is asked for has every loop solved
      call prepare_samples(plain, [(study%proof%from - study%reference + (study%proof%to - study%proof%from) &
                                    *(real(i, wp)/real(steps_of_corner, wp)), i=0, steps_of_corner)], .false., &
                           reshape([1, 0], [2, 1]), .true., samples)
      call linearise_samples(samples, dimensions)
      study%worst_corner = huge(1.0_wp)   ! no measure depends on a length yet
      do loop = 1, size(samples%k, 2)
         do i = 1, size(samples%k, 1)
            if (problem%mechanism%groups(loop)%kind == assur_rrr) then
               call look_at_links()
            else
               call take(1.0_wp - abs(samples%k(i, loop)), samples%dk(i, loop, :))
            end if
         end do
      end do

      if (study%worst_corner >= huge(1.0_wp)) study%worst_corner = 0.0_wp

   contains

      subroutine take(g, slopes)
         real(wp), intent(in) :: g, slopes(:)

         if (sum(abs(slopes)) > 0.0_wp) study%worst_corner = min(study%worst_corner, g/sum(abs(slopes)))
      end subroutine take

      !> (p+q)**2 - d and d - (p-q)**2, which are nearer to linear than the cosine k; d = p**2 + q**2 - 2 p q k.
      subroutine look_at_links()
         real(wp), dimension(size(samples%dk, 3)) :: dp, dq, dd
         real(wp) :: d

         associate (members => problem%mechanism%groups(loop)%members, k => samples%k(i, loop))
            associate (p => dimensions%arcl(members(1)), q => dimensions%arcl(members(2)))
               dp = 0.0_wp
               dq = 0.0_wp
               where (plain%parameters%length_variable(members(1)) == [(n, n=1, size(dp))]) dp = 1.0_wp
               where (plain%parameters%length_variable(members(2)) == [(n, n=1, size(dq))]) dq = 1.0_wp
               d = p*p + q*q - 2.0_wp*p*q*k
               dd = 2.0_wp*(p - q*k)*dp + 2.0_wp*(q - p*k)*dq - 2.0_wp*p*q*samples%dk(i, loop, :)
               call take((p + q)**2 - d, 2.0_wp*(p + q)*(dp + dq) - dd)
               call take(d - (p - q)**2, dd - 2.0_wp*(p - q)*(dp - dq))
            end associate
         end associate
      end subroutine look_at_links
   end subroutine estimate_corner

   !> A clearance with the ways to its points.
   pure type(keeping_t) function keeping_of(linkage, plan, clearance) result(keeping)
      type(proof_linkage_t), intent(in) :: linkage
      type(plan_t), intent(in) :: plan             !! with the joints of the clearances
      type(clearance_t), intent(in) :: clearance
      real(wp) :: c, s
      integer :: k

      do k = 1, 2
         keeping%ends(k) = way_to(clearance%points(k))
      end do
      keeping%reach = clearance%reach
      if (clearance%region == 0) then
         keeping%kind = apart_from_link
         do k = 1, 2
            keeping%others(k) = way_to(clearance%points(2 + k))
         end do
         return
      end if
      associate (region => clearance%shape)
         select case (region%kind)
         case (region_box)
            call find_corners(region, keeping%corner, keeping%corners)
            keeping%kind = merge(within_edges, apart_from_corners, region%stay_inside)
            ! from lower left to lower right and so on: what is inside lies to the left
            keeping%normal = reshape([0.0_wp, 1.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, -1.0_wp, 1.0_wp, 0.0_wp], shape(keeping%normal))
         case (region_half_plane)
            call unit_vector(region%at(3), c, s)
            keeping%kind = within_edges
            keeping%corners = 1
            keeping%corner(:, 1) = region%at(:2)
            keeping%normal(:, 1) = merge(-1.0_wp, 1.0_wp, region%stay_inside)*[s, -c]
         case (region_circle)
            keeping%kind = merge(within_circle, apart_from_corners, region%stay_inside)
            keeping%corners = 1
            keeping%corner(:, 1) = region%at(:2)
            keeping%radius = region%at(3)
         end select
      end associate

   contains

      !> Steps to a point; 0: the output point.
      pure type(step_path_t) function way_to(point) result(path)
         integer, intent(in) :: point

         if (point == 0) then
            path%steps = [linkage%pivot, path_of(linkage%plan, plan%output_point), linkage%tip]
         else
            path%steps = [linkage%pivot, path_of(linkage%plan, plan%joint_points(point))]
            if (linkage%beside(point) > 0) path%steps = [path%steps, linkage%beside(point)]
         end if
      end function way_to
   end function keeping_of

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
         type(bracket_t), intent(in) :: spans(2)
         type(proven_extreme_t) :: extreme

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
   pure subroutine place_positions(mechanism, inputs, study)
      type(mechanism_t), intent(in) :: mechanism
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
            if (study%full_turn) input = input_in_turn(mechanism, input)
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

   !> True unless the linkage is proven to close over the whole range and no limit or clearance is proven to be violated.
   pure logical function is_violating(self)
      class(proof_study_t), intent(in) :: self

      is_violating = self%is_open() .or. any(self%kept%is_broken) .or. any(self%margins%is_broken)
   end function is_violating

   !> True unless the linkage is proven to close over the whole range.
   pure logical function is_open(self)
      class(proof_study_t), intent(in) :: self

      is_open = .not. self%empty
      if (is_open) is_open = .not. self%proof%closes_everywhere()
   end function is_open
end module psalm_proof_study
