!> All linkages that &EXACT asks for: found, proven over their motion where IPROOF asks for it, reported.
module psalm_exact_run
   use psalm_cases, only: read_case_text
   use psalm_chain_proof_study, only: chain_proof_t, study_chain_proof
   use psalm_chain_study, only: chain_study_t, study_chain
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_error, only: problem_t, make_problem
   use psalm_exact_group, only: exact_group_t, exact_of
   use psalm_exact_report, only: report_exact, write_case
   use psalm_exact_results, only: exact_proof_t
   use psalm_exact_study, only: exact_study_t, find_exact, leave_out_flat, rank_proven, results_of, stays_assembled, &
                                tries
   use psalm_kinds, only: wp, degrees_per_radian, full_turn, half_turn
   use psalm_preparation, only: prepared_t, prepare
   use psalm_proof, only: piece_closes, proof_linkage_t
   use psalm_proof_ranges, only: extreme_angle
   use psalm_proof_study, only: proof_study_t, study_closure, proof_of_inputs, proof_of_turn
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: run_exact, study_all_exact

contains

   !> Find, prove and report. `set` has passed `check_exact`. After a stop, or when MAXTIME is over, what was found so far is
   !> reported.
   subroutine run_exact(set, threads, stop, devices)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop               !! asked now and then
      type(devices_t), intent(inout) :: devices
      type(exact_study_t), allocatable :: study

      allocate (study)
      call study_all_exact(set, threads, stop, study)
      call report_exact(set, study, devices)
   end subroutine run_exact

   !> Find and prove.
   subroutine study_all_exact(set, threads, stop, study)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: threads                 !! that share the paths of six-bars
      type(stop_t), intent(in) :: stop               !! asked now and then
      type(exact_study_t), intent(out) :: study
      type(stop_t) :: limited

      limited = stop
      call limited%limit_time(longest_time_of(set))
      call find_exact(set, study, stop, threads)
      if (set%limits%iproof > 0) call prove(set, limited, study)
   end subroutine study_all_exact

   !> MAXTIME of the group; the group is large, and the small stack is wanted by what is called later.
   pure real(wp) function longest_time_of(set) result(seconds)
      type(data_set_t), intent(in) :: set
      type(exact_group_t) :: exact

      exact = exact_of(set)
      seconds = exact%longest_time
   end function longest_time_of

   !> Look at results in their order until as many are proven as are listed, or until a stop: then the others are skipped.
   subroutine prove(set, stop, study)
      type(data_set_t), intent(in) :: set
      type(stop_t), intent(in) :: stop
      type(exact_study_t), intent(inout) :: study
      type(exact_group_t) :: exact
      type(exact_proof_t), allocatable :: proofs(:)
      integer :: i, n

      exact = exact_of(set)
      allocate (proofs(min(results_of(study), tries*exact%listed)))
      n = 0
      do i = 1, size(proofs)
         if (n == exact%listed) exit
         if (stop%waiting()) then
            proofs(i:)%skipped = .true.
            if (.not. study%stopped) study%out_of_time = .not. stop%requested()
            exit
         end if
         if (stays_assembled(study, i)) call prove_one(set, study, i, proofs(i))
         if (proofs(i)%closes) n = n + 1
      end do
      if (i <= size(proofs)) then
         if (proofs(i)%skipped) i = size(proofs) + 1
      end if
      call rank_proven(proofs(:i - 1), study)
      ! what is proven of a rocking crank may be less than what its points show
      call leave_out_flat(exact, study)
   end subroutine prove

   !> The motion of one result: of the numbers that its case on device 7 has.
   subroutine prove_one(set, study, number, proof)
      type(data_set_t), intent(in) :: set
      type(exact_study_t), intent(in) :: study
      integer, intent(in) :: number
      type(exact_proof_t), intent(out) :: proof
      type(text_t) :: text
      type(data_set_t), allocatable :: sets(:)
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      type(proof_study_t), allocatable :: turn, way
      type(proof_linkage_t), allocatable :: linkage
      type(diagnostics_t) :: findings
      type(line_t) :: none(0)

      call write_case(set, study, number, 1, text)
      call read_case_text(text%content(), 'device 7', sets, findings, 'psalm')
      if (findings%failed()) return
      if (sets(1)%is_beyond_arrays()) then
         call prove_groups(set, sets(1), proof)
         return
      end if
      allocate (prepared, problem, turn, way, linkage)
      call prepare(sets(1), none, prepared, findings)
      if (.not. prepared%ready) return
      call make_problem(sets(1), prepared%mechanism, prepared%given, prepared%parameters, problem)
      call study_closure(problem, prepared%given, proof_of_inputs, way, linkage)
      if (way%empty) return
      proof%known = .true.
      proof%closes = way%proof%closes_everywhere()
      proof%from = minval(problem%delt)
      proof%to = maxval(problem%delt)
      if (proof%closes) call take_least_angle(way, proof)
      if (set%limits%iproof == proof_of_turn) then
         call study_closure(problem, prepared%given, proof_of_turn, turn, linkage)
         proof%turns = turn%proof%closes_everywhere()
         if (proof%turns) then
            proof%closes = .true.
            call take_least_angle(turn, proof)
            proof%from = 0.0_wp
            proof%to = full_turn
         else
            call take_part(turn, proof)
         end if
      else if (.not. proof%closes) then
         call take_part(way, proof)
      end if
   end subroutine prove_one

   !> Least of all transmission angles, from 0 to 90 degrees.
   pure subroutine take_least_angle(study, proof)
      type(proof_study_t), intent(in) :: study
      type(exact_proof_t), intent(inout) :: proof
      integer :: i

      proof%transmission = half_turn
      do i = 1, size(study%extremes)
         associate (own => study%extremes(i))
            if (own%kind /= extreme_angle .or. .not. own%found) cycle
            proof%transmits = .true.
            proof%transmission = min(proof%transmission, own%least_low, half_turn - own%greatest_high)
         end associate
      end do
   end subroutine take_least_angle

   !> The part of the range that closes and holds the first position.
   pure subroutine take_part(study, proof)
      type(proof_study_t), intent(in) :: study
      type(exact_proof_t), intent(inout) :: proof
      real(wp) :: shift
      integer :: part, last

      proof%from = 0.0_wp
      proof%to = 0.0_wp
      part = study%circuit(1)
      if (part == 0) return
      associate (limits => study%proof%limits)
         last = size(limits)
         proof%from = limits(part)%from - study%reference
         proof%to = limits(part)%to - study%reference
         ! a part that goes on over the end of the turn
         if (study%full_turn .and. part == 1 .and. last > 1 .and. limits(last)%kind == piece_closes) &
            proof%from = limits(last)%from - full_turn - study%reference
      end associate
      if (.not. study%full_turn) return
      ! the first position is in it
      shift = full_turn*real(ceiling(max(proof%from, 0.0_wp)/full_turn) - ceiling(max(-proof%to, 0.0_wp)/full_turn), wp)
      proof%from = proof%from - shift
      proof%to = proof%to - shift
   end subroutine take_part

   !> The motion of a result with larger groups, from its first position, where it is drawn.
   subroutine prove_groups(set, case, proof)
      type(data_set_t), intent(in) :: set
      type(data_set_t), intent(in) :: case           !! the result, a sketch
      type(exact_proof_t), intent(inout) :: proof
      type(chain_study_t), allocatable :: study
      type(chain_proof_t), allocatable :: motion

      allocate (study, motion)
      call study_chain(case, 1.0_wp, 0.0_wp, study)
      if (.not. study%valid) return
      call study_chain_proof(case, study, proof_of_inputs, motion)
      if (motion%empty .or. motion%braced > 0 .or. motion%misplaced > 0) return
      proof%known = .true.
      proof%closes = motion%complete
      if (set%limits%iproof == proof_of_turn) then
         call study_chain_proof(case, study, proof_of_turn, motion)
         proof%turns = motion%complete
         proof%closes = proof%closes .or. proof%turns
      end if
      call take_segments(motion, proof)
   end subroutine prove_groups

   !> How far a motion is proven either way.
   pure subroutine take_segments(motion, proof)
      type(chain_proof_t), intent(in) :: motion
      type(exact_proof_t), intent(inout) :: proof
      real(wp) :: way
      integer :: k

      do k = 1, size(motion%segments)
         way = motion%segments(k)%reached*motion%segments(k)%to(1)*degrees_per_radian
         proof%from = min(proof%from, way)
         proof%to = max(proof%to, way)
      end do
   end subroutine take_segments
end module psalm_exact_run
