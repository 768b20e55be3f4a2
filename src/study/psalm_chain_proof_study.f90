!> What is proven of the motion of a sketch in the poses of its links.
!>
!> One drive (others may be geared to it) goes from the drawing to both ends of its range; several go from position to position, as
!> the positions are found. Data in, results out: nothing is printed or worded here.
module psalm_chain_proof_study
   use psalm_angles, only: within_turn
   use psalm_chain_clearance_proof, only: bracket_clearance
   use psalm_chain_motion, only: nearest_known
   use psalm_chain_study, only: chain_study_t, inputs_of_drives, study_chain, turn_repeats
   use psalm_clearances, only: clearance_t, list_sketch_clearances
   use psalm_closure, only: closure_t, state_t, matrix_of
   use psalm_constraint_group, only: range_positions
   use psalm_data_set, only: data_set_t
   use psalm_dense, only: factors_t, factorise
   use psalm_limits_group, only: proof_by_default
   use psalm_kinds, only: wp, full_turn, degrees_per_radian, radians_per_degree
   use psalm_proof_chain, only: chain_tubes_t, path_segment_t, output_range_t, start_tubes, cover_segment, stands_as_drawn, &
                               is_on_motion, bracket_outputs
   use psalm_proof_motion, only: proven_dead_point_t
   use psalm_proof_standstill, only: chain_movement_t, chain_way_t, prove_standstill
   use psalm_proof_study, only: kept_t, touching, proof_of_turn
   use psalm_proof_tube, only: in_one_group
   use psalm_sketch, only: drive_turns
   use psalm_stop, only: stop_t, is_to_end
   implicit none (type, external)
   private
   public :: chain_proof_t, study_chain_proof, prove_loops, place_on, place_of_extreme

   real(wp), parameter :: rounding = 4.0_wp*epsilon(1.0_wp)*full_turn !! of an input in degrees that is moved by a turn

   !> Parts of the motion and what is proven of them.
   type :: chain_proof_t
      logical :: empty = .false.             !! all inputs are those of the drawing: nothing moves
      logical :: stopped = .false.           !! the host asked for the end: what is there is no proof of the whole
      integer :: braced = 0                  !! a group with more equations than unknowns, of which nothing can be proven; 0: none
      logical :: one_drive = .true.          !! from and to are inputs of the first drive; else numbers of positions
      logical :: full_turn = .false.
      logical :: returns = .false.           !! after it the linkage stands as drawn
      logical :: complete = .false.          !! everything asked for is proven to close
      real(wp) :: begins = 0.0_wp            !! where a turn of inputs begins as shown, degrees
      real(wp) :: from = 0.0_wp, to = 0.0_wp !! what is asked for: degrees or length, or positions
      type(path_segment_t), allocatable :: segments(:)
      integer, allocatable :: group(:)       !! by segment: where an incomplete one ends, the group nearest to a dead point
      integer, allocatable :: position(:)    !! by segment, of several drives: where it ends
      type(output_range_t), allocatable :: ranges(:) !! by number of all outputs
      type(output_range_t), allocatable :: ratios(:) !! likewise: rate by the input, radians for degrees
      type(chain_movement_t) :: movement     !! dead points, strokes, dwells
      real(wp) :: dwell = 0.0_wp             !! amount of a dwell, degrees or length; 0: none are looked for
      type(kept_t), allocatable :: kept(:)   !! clearances; they are asked for over the range
      integer :: misplaced = 0               !! positions found in another assembly than the proven motion leads to
      integer :: tubes = 0
   end type chain_proof_t

contains

   !> Prove the motion of a sketch over a full turn of its first drive, or over its positions.
   subroutine study_chain_proof(set, study, range, proof, stop)
      type(data_set_t), intent(in) :: set
      type(chain_study_t), intent(in) :: study
      integer, intent(in) :: range           !! one of `proof_of_...`
      type(chain_proof_t), intent(out) :: proof
      type(stop_t), intent(in), optional :: stop !! asked between the steps
      type(chain_tubes_t), allocatable :: tubes
      real(wp), allocatable :: inputs(:, :)
      type(closure_t) :: whole
      logical :: valid, begun
      integer :: g, k

      associate (closure => study%closure, drives => set%sketch%drives)
         do g = 1, size(closure%groups)
            if (closure%groups(g)%equations > 3*size(closure%groups(g)%links)) proof%braced = g
         end do
         if (proof%braced > 0) return
         inputs = inputs_of_drives(set, .true.)
         do k = 2, size(drives)
            if (.not. drives(k)%geared .and. allocated(drives(k)%delt)) proof%one_drive = .false.
            ! with a phase the drawing is on no line of the first drive
            if (drives(k)%geared .and. abs(drives(k)%phase) > 0.0_wp) proof%one_drive = .false.
         end do
         proof%full_turn = proof%one_drive .and. range == proof_of_turn .and. drives(1)%kind == drive_turns
         if (proof%one_drive) then
            call find_both_ways(set, inputs, proof)
         else
            call find_lines(inputs, study%motion%closed, proof)
         end if
         proof%empty = size(proof%segments) == 0
         if (proof%empty) return
         allocate (tubes)
         call in_one_group(closure, whole)
         call start_tubes(whole, study%start, size(proof%segments), tubes, valid)
         proof%complete = valid
         do k = 1, size(proof%segments)
            proof%stopped = is_to_end(stop)
            if (proof%stopped) return
            if (proof%full_turn .and. k == 2) then
               if (proof%complete) then
                  proof%segments = proof%segments(:1)
                  exit
               end if
               ! what is left of the turn
               proof%segments(2)%to = -(1.0_wp - proof%segments(1)%reached)*proof%segments(1)%to
               proof%segments(2)%per = 1.0_wp/proof%segments(2)%to(1)
            end if
            begun = valid
            if (proof%segments(k)%after > 0) begun = proof%segments(proof%segments(k)%after)%complete
            if (begun) call cover_segment(whole, set%sketch%outputs, k, proof%segments(k), tubes)
            proof%complete = proof%complete .and. proof%segments(k)%complete
         end do
         if (proof%full_turn .and. proof%complete) proof%returns = stands_as_drawn(whole, tubes, 1)
         proof%tubes = tubes%count
         call compare_positions(study, whole, inputs, tubes, proof)
         call find_singular_groups(study, tubes, proof)
         proof%stopped = is_to_end(stop)
         if (proof%stopped) return
         call prove_movement(set, whole, tubes, proof)
         proof%stopped = is_to_end(stop)
         if (proof%stopped) return
         ! near a dead point rates are beyond all bounds
         call bracket_outputs(whole, set%sketch%outputs, merge(merge(1.0_wp, whole%size, drives(1)%kind == drive_turns), 0.0_wp, &
                                                               proof%one_drive .and. proof%complete), tubes, proof%ranges, &
                              proof%ratios)
         call prove_clearances(set, whole, tubes, proof)
      end associate
   end subroutine study_chain_proof

   !> Dead points of outputs, links and slides, strokes and dwells.
   subroutine prove_movement(set, whole, tubes, proof)
      type(data_set_t), intent(in) :: set
      type(closure_t), intent(in) :: whole   !! in one group
      type(chain_tubes_t), intent(in) :: tubes
      type(chain_proof_t), intent(inout) :: proof
      type(chain_way_t) :: ways(size(proof%segments))
      logical :: turns
      integer :: k

      turns = set%sketch%drives(1)%kind == drive_turns
      do k = 1, size(ways)
         ! along lines of several drives each segment is a way of its own
         ways(k)%base = place_on(proof, k, 0.0_wp, turns)
         ways(k)%gain = place_on(proof, k, 1.0_wp, turns) - ways(k)%base
         ways(k)%run = merge(1, k, proof%one_drive)
      end do
      proof%dwell = set%limits%dwell
      call prove_standstill(whole, set%sketch%outputs, tubes, ways, proof%returns, proof%dwell, proof%movement)
      if (.not. proof%full_turn) return
      ! in the turn that is shown
      associate (movement => proof%movement)
         do k = 1, size(movement%dead)
            associate (dead => movement%dead(k), shift => in_turn_of(proof, 0.5_wp*(movement%dead(k)%low + movement%dead(k)%high)) &
                                                          - 0.5_wp*(movement%dead(k)%low + movement%dead(k)%high))
               dead%low = dead%low + shift - rounding
               dead%high = dead%high + shift + rounding
            end associate
         end do
         do k = 1, size(movement%dwells)
            associate (dwell => movement%dwells(k), shift => in_turn_of(proof, movement%dwells(k)%from) - movement%dwells(k)%from)
               dwell%from = dwell%from + shift + rounding
               dwell%to = dwell%to + shift - rounding
               dwell%at = in_turn_of(proof, dwell%at)
            end associate
         end do
      end associate
      call put_in_order(proof%movement%dead)
   end subroutine prove_movement

   !> Sort the dead points of each quantity by their place; those of one quantity stand together.
   pure subroutine put_in_order(dead)
      type(proven_dead_point_t), intent(inout) :: dead(:)
      type(proven_dead_point_t) :: moved
      integer :: i, k

      do i = 2, size(dead)
         moved = dead(i)
         do k = i - 1, 1, -1
            if (dead(k)%kind /= moved%kind .or. dead(k)%place /= moved%place .or. dead(k)%low <= moved%low) exit
            dead(k + 1) = dead(k)
         end do
         dead(k + 1) = moved
      end do
   end subroutine put_in_order

   !> How near joints and links come to regions and each other; not where limits are for the positions alone.
   subroutine prove_clearances(set, whole, tubes, proof)
      type(data_set_t), intent(in) :: set
      type(closure_t), intent(in) :: whole   !! in one group
      type(chain_tubes_t), intent(in) :: tubes
      type(chain_proof_t), intent(inout) :: proof
      type(clearance_t), allocatable :: clearances(:)
      real(wp) :: way
      integer :: k, segment

      allocate (clearances(0))
      if (set%constr%given .and. (set%constr%irange /= range_positions .or. set%limits%iproof /= proof_by_default)) &
         call list_sketch_clearances(set%constr, set%sketch, clearances)
      allocate (proof%kept(size(clearances)))
      do k = 1, size(clearances)
         associate (kept => proof%kept(k))
            kept%clearance = clearances(k)
            call bracket_clearance(whole, clearances(k), tubes, kept%nearest, segment, way)
            if (.not. kept%nearest%found) cycle
            kept%nearest%at = place_on(proof, segment, way, set%sketch%drives(1)%kind == drive_turns)
            kept%nearest%at = in_turn_of(proof, kept%nearest%at)
            kept%is_broken = kept%nearest%high < clearances(k)%asked - touching*whole%size
         end associate
      end do
   end subroutine prove_clearances

   !> The proof of a sketch with loops and a larger group, made in the poses of its links. Not `valid`: the drawing does not close.
   subroutine prove_loops(set, range, study, proof, valid, stop)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: range           !! one of `proof_of_...`
      type(chain_study_t), intent(out) :: study
      type(chain_proof_t), intent(out) :: proof
      logical, intent(out) :: valid
      type(stop_t), intent(in), optional :: stop !! asked between the steps

      call study_chain(set, 1.0_wp, 0.0_wp, study)
      valid = study%valid
      if (valid) call study_chain_proof(set, study, range, proof, stop)
   end subroutine prove_loops

   !> Count the positions that are not on the motion that is proven to lead to them.
   subroutine compare_positions(study, whole, inputs, tubes, proof)
      type(chain_study_t), intent(in) :: study
      type(closure_t), intent(in) :: whole   !! in one group
      real(wp), intent(in) :: inputs(:, :)   !! shape (drives, positions)
      type(chain_tubes_t), intent(in) :: tubes
      type(chain_proof_t), intent(inout) :: proof
      type(state_t) :: state
      real(wp) :: way
      integer :: k, segment
      logical :: same

      do k = 1, size(inputs, 2)
         if (.not. study%motion%closed(k)) cycle
         state = study%motion%states(k)
         segment = 0
         way = 1.0_wp
         same = .true.
         if (proof%one_drive) then
            ! where the position has really been reached from the drawing, backwards perhaps
            do segment = size(proof%segments), 1, -1
               way = state%input(1, 0)/proof%segments(segment)%to(1)
               if (way < 0.0_wp) cycle
               if (proof%segments(segment)%turns_back) same = way <= proof%segments(segment)%dead_high
               if (way <= proof%segments(segment)%reached) exit
            end do
         else if (any(proof%position == k)) then
            segment = findloc(proof%position, k, dim=1)
            if (.not. proof%segments(segment)%complete) segment = 0
         end if
         if (segment > 0) same = is_on_motion(whole, tubes, segment, way, state)
         if (.not. same) proof%misplaced = proof%misplaced + 1
      end do
   end subroutine compare_positions

   !> Of the segments that are not complete the group whose matrix is nearest to a singular one where the proof ends.
   subroutine find_singular_groups(study, tubes, proof)
      type(chain_study_t), intent(in) :: study
      type(chain_tubes_t), intent(in) :: tubes
      type(chain_proof_t), intent(inout) :: proof
      type(factors_t) :: factors
      real(wp) :: least
      integer :: k, g, i, last

      allocate (proof%group(size(proof%segments)), source=0)
      do k = 1, size(proof%segments)
         if (proof%segments(k)%complete) cycle
         last = 0
         do i = 1, tubes%count
            if (tubes%parts(i)%segment == k) last = i
         end do
         least = huge(1.0_wp)
         do g = 1, size(study%closure%groups)
            if (size(study%closure%groups(g)%links) == 0) cycle
            if (last > 0) then
               call factorise(matrix_of(study%closure, tubes%parts(last)%tube%state, g), factors)
            else
               call factorise(matrix_of(study%closure, study%start, g), factors)
            end if
            if (factors%reciprocal_condition >= least) cycle
            least = factors%reciprocal_condition
            proof%group(k) = g
         end do
      end do
   end subroutine find_singular_groups

   !> One drive: from the drawing to both ends.
   subroutine find_both_ways(set, inputs, proof)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: inputs(:, :)   !! shape (drives, positions)
      type(chain_proof_t), intent(inout) :: proof
      type(path_segment_t) :: segment
      real(wp) :: ends(2), unit
      integer :: k, d

      unit = merge(degrees_per_radian, 1.0_wp, set%sketch%drives(1)%kind == drive_turns)
      ends = [max(0.0_wp, maxval(inputs(1, :))), min(0.0_wp, minval(inputs(1, :)))]
      if (proof%full_turn) ends = [full_turn*radians_per_degree, -full_turn*radians_per_degree]
      proof%begins = set%method%turn_begins()
      proof%from = merge(proof%begins, ends(2)*unit, proof%full_turn)
      proof%to = merge(proof%begins + full_turn, ends(1)*unit, proof%full_turn)
      allocate (proof%segments(0))
      do k = 1, 2
         if (abs(ends(k)) <= 0.0_wp) cycle
         ! one turn on a geared drive stands elsewhere: backwards is no part of the turn
         if (k == 2 .and. proof%full_turn .and. .not. turn_repeats(set)) cycle
         segment%from = [(0.0_wp, d=1, size(inputs, 1))]
         segment%to = segment%from
         segment%to(1) = ends(k)
         segment%per = 1.0_wp/ends(k)
         associate (drives => set%sketch%drives)
            do d = 2, size(drives)
               if (.not. drives(d)%geared) cycle
               segment%to(d) = drives(d)%ratio*ends(k)*merge(degrees_per_radian, 1.0_wp, drives(1)%kind == drive_turns) &
                           *merge(radians_per_degree, 1.0_wp, drives(d)%kind == drive_turns)
            end do
         end associate
         proof%segments = [proof%segments, segment]   ! of a constructor within a constructor gfortran 12 loses the memory
      end do
   end subroutine find_both_ways

   !> Several drives: from the nearest position that is known, as the positions are found.
   subroutine find_lines(inputs, closed, proof)
      real(wp), intent(in) :: inputs(:, :)   !! shape (drives, positions)
      logical, intent(in) :: closed(:)
      type(chain_proof_t), intent(inout) :: proof
      type(path_segment_t) :: segment
      integer :: segment_to(size(closed)), k, before, d

      segment_to = 0
      allocate (proof%segments(0), proof%position(0))
      proof%from = 1.0_wp
      proof%to = real(size(closed), wp)
      do k = 1, size(closed)
         before = nearest_known(inputs, closed, k)
         if (before == 0) then
            if (all(abs(inputs(:, k)) <= 0.0_wp)) cycle
            segment%from = [(0.0_wp, d=1, size(inputs, 1))]
            segment%after = 0
         else
            segment%from = inputs(:, before)
            segment%after = segment_to(before)
         end if
         segment%to = inputs(:, k)
         proof%segments = [proof%segments, segment]
         proof%position = [proof%position, k]
         segment_to(k) = size(proof%segments)
      end do
   end subroutine find_lines

   !> A place on a segment as it is reported: the first drive's input, or between positions.
   pure real(wp) function place_on(proof, segment, way, turns) result(place)
      type(chain_proof_t), intent(in) :: proof
      integer, intent(in) :: segment
      real(wp), intent(in) :: way            !! part of it
      logical, intent(in) :: turns           !! the first drive turns

      if (proof%one_drive) then
         place = proof%segments(segment)%from(1) + way*(proof%segments(segment)%to(1) - proof%segments(segment)%from(1))
         if (turns) place = place*degrees_per_radian
      else
         place = real(proof%position(segment) - 1, wp) + way
      end if
   end function place_on

   !> Where an output is least or greatest; over a turn in the turn that is shown.
   pure real(wp) function place_of_extreme(proof, range, which, turns) result(place)
      type(chain_proof_t), intent(in) :: proof
      type(output_range_t), intent(in) :: range
      integer, intent(in) :: which           !! 1: the least, 2: the greatest value
      logical, intent(in) :: turns           !! the first drive turns

      place = place_on(proof, range%segment(which), range%way(which), turns)
      place = in_turn_of(proof, place)
   end function place_of_extreme

   !> The same input in the turn that is shown.
   pure real(wp) function in_turn_of(proof, input)
      type(chain_proof_t), intent(in) :: proof
      real(wp), intent(in) :: input          !! degrees

      in_turn_of = input
      if (proof%full_turn) in_turn_of = proof%begins + within_turn(input - proof%begins)
   end function in_turn_of
end module psalm_chain_proof_study
