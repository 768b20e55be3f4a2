!> All linkages that meet points, poses, timed points or a function exactly. Data in, results out.
module psalm_exact_study
   use psalm_burmester, only: dyad_condition_t, pin_pair_t, dyads_t, derivative_of, five_conditions, of_poses, pin_for_pivot
   use psalm_careful_tracking, only: ends_t, take_ends, track_carefully
   use psalm_certificate, only: certificate_t, certify_generators, certify_legs, certify_poses
   use psalm_data_set, only: data_set_t
   use psalm_defects, only: exact_linkage_t, cognates_of, place_pins
   use psalm_dense, only: factors_t, factorise, solve
   use psalm_every_six_bar, only: every_six_bar_t, find_every_six_bar
   use psalm_exact_group, only: exact_of, exact_group_t, is_missing, kind_function, kind_motion, six_bar_none, &
                               six_bar_stephenson_2, six_bar_watt
   use psalm_exact_results, only: exact_proof_t, exact_result_t, add_result, is_better, assessed, pair_of, rank, span_of
   use psalm_exact_subsets, only: find_by_subsets, subset_study_t
   use psalm_function_points, only: function_point_t, generators_t, five_points, four_points, three_points
   use psalm_generic, only: generic_solutions
   use psalm_generic_counts, only: solutions_of
   use psalm_guided_six_bars, only: arm_t, guided_study_t, find_guided, place_arm, poses_guided
   use psalm_kinds, only: wp, full_turn, pi, radians_per_degree
   use psalm_leg_lanes, only: problem_path_t
   use psalm_leg_problem, only: absolute, at_a, at_ah, at_b, at_bh, at_x, at_y, kind_point, kind_pose, kind_rate, kind_timed, &
                                leg_data_t, leg_problem_t, make_problem, most_points, random_unit, turns_of, variables
   use psalm_angles, only: unit_vector
   use psalm_minimax, only: approximation_t, approximate
   use psalm_monodromy, only: generic_t, scale_problem, scale_solutions
   use psalm_nine_points, only: in_place, nine_point_orbits, nine_points_t, solve_nine_points
   use psalm_pole_curves, only: curve_sample_t, find_lines, find_pairs, sample_curve
   use psalm_six_bar_certificate, only: certify_six_bars
   use psalm_six_bar_problem, only: at_c, at_first_arm, at_output, at_p, at_q, make_six_bar_problem, most_unknowns, &
                                    six_bar_problem_t, stephenson_2, stephenson_3, watt_2
   use psalm_six_bars, only: six_bars_t, find_stephenson, find_watt
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_symmetric_points, only: leave_a_curve
   use psalm_number_format, only: number_words
   use psalm_text, only: to_text
   use psalm_tracker, only: polish, tracked_t
   use psalm_desired_function, only: desired_function_t, function_kind, function_table
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: exact_study_t, check_exact, find_exact, poses_of, leaves_curves, rank_proven, results_of, &
             leave_out_flat, obeys_transmission, stays_assembled, tries, way_burmester, way_curves, way_legs, way_nine, &
             way_generators, way_minimax, way_six_bars, way_subsets, &
             way_guided, way_every_six_bar

   !> How the linkages are found.
   integer, parameter :: way_burmester = 1, way_curves = 2, way_legs = 3, way_nine = 4, way_generators = 5, way_minimax = 6, &
                         way_six_bars = 7, way_subsets = 8, way_guided = 9, way_every_six_bar = 10
   integer, parameter :: dyad_conditions = 4         !! that determine a dyad, beyond the first pose
   integer, parameter :: seed = 1                    !! of the phases
   integer, parameter :: most_passes = 4
   integer, parameter :: tries = 5                   !! results looked at for each that is to be proven
   real(wp), parameter :: real_within = 1.0e-6_wp    !! of a number and the conjugate of its partner, over the largest
   real(wp), parameter :: on_circle = 1.0e-7_wp      !! distance of points from a circle or line, over their size
   real(wp), parameter :: coincident = 1.0e-9_wp     !! distance of two points that are one, over the size of all
   !> Distance of two points over the size of all below which ends of paths are one end: psalm_monodromy takes two solutions
   !> for one at this difference, and the precision is used up long before.
   real(wp), parameter :: too_close = 1.0e-6_wp
   real(wp), parameter :: apart = 1.0e-6_wp          !! radians between two angles of points of six-bars
   real(wp), parameter :: outlying = 0.1_wp          !! size of all points without one that lies far from them, over that with it

   type :: exact_study_t
      integer :: way = way_legs
      integer :: expected = 0                        !! solutions of a generic problem; 0: not known
      integer :: generic = 0                         !! those of the generic problem that the search began with
      integer :: ends = 0                            !! distinct finite ends found
      integer :: imaginary = 0, infinite = 0         !! five poses, functions: those that are not real or have a pivot at infinity
      integer :: singular = 0                        !! of these those where the equations are singular: multiple or not isolated
      integer :: merged = 0                          !! paths that end where others do: at multiple ends, or at one linkage that
                                                     !! passes a given point in two positions
      integer :: real_ends = 0                       !! of the distinct ends those that are real
      integer :: linkages = 0                        !! real linkages, without exchange of the legs
      logical :: cognates = .false.                  !! each of these stands for three linkages that draw one curve
      logical :: complete = .false.
      logical :: degenerate = .false.                !! more than finitely many
      logical :: symmetric = .false.                 !! points leave a curve of symmetric linkages besides
      integer :: passes = 0
      logical :: stopped = .false.                   !! the host wanted the end, or MAXTIME was over, before all was found
      logical :: out_of_time = .false.               !! of these: MAXTIME
      integer :: paths = 0, followed = 0             !! those of a pass, and how many of them were followed as far as they lead
      type(exact_result_t), allocatable :: results(:) !! ranked
      type(generators_t) :: generators
      real(wp), allocatable :: phi(:), psi(:)        !! their points, radians; of a slider psi is the travel
      type(desired_function_t) :: wanted
      type(approximation_t), allocatable :: approximations(:)
      type(six_bars_t) :: six_bars
      type(every_six_bar_t) :: every
      type(subset_study_t) :: subsets
      type(guided_study_t) :: guided
      logical :: examined = .false.                  !! there is a certificate
      type(certificate_t) :: certificate
      type(curve_sample_t), allocatable :: curve(:)  !! four poses: points of the curves, from the first pose's
      type(pin_pair_t), allocatable :: lines(:)          !! slides found, of four poses 1 at most, from the first pose's point
      integer :: flat = 0                            !! linkages left out: their transmission angle is less than TRMIN
      integer :: too_long = 0                        !! optima with a link that is too long
      type(exact_proof_t), allocatable :: proofs(:)  !! of the first results; not allocated: none were asked for
   end type exact_study_t

contains

   ! ---- what cannot be ------------------------------------------------------------------------------------------------

   !> Errors: points that coincide or lie on a circle, equal poses, too few or too many conditions.
   subroutine check_exact(set, findings)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(exact_group_t) :: exact
      type(leg_problem_t) :: problem
      character(:), allocatable :: text
      complex(wp), allocatable :: p(:)
      integer :: i, k, conditions

      exact = exact_of(set)
      if (exact%kind == kind_function) then
         call check_six_bar_points(exact, set, findings)
         return
      end if
      p = cmplx(exact%x, exact%y, wp)
      if (size(p) < 2) then
         call complain('XP', 'one point does not ask for anything; give at least two')
         return
      end if
      if (size(p) > most_points + 1) then
         if (lie_on_circle(p, exact)) call complain('XP', 'the points lie on one circle or line: one link draws it')
         return
      end if
      do i = 1, size(p)
         do k = 1, i - 1
            if (abs(p(i) - p(k)) > too_close*span_of(p)) cycle
            if (.not. is_missing(exact%time(i)) .or. .not. is_missing(exact%time(k))) cycle
            if (is_missing(exact%angle(i)) .or. is_missing(exact%angle(k))) then
               text = 'points '//to_text(k)//' and '//to_text(i)//' coincide'
               if (abs(p(i) - p(k)) > coincident*span_of(p)) text = text//' but for '// &
                  number_words(abs(p(i) - p(k)))//', less than 1E-6 of the size of all points'
               text = text//': leave one of both out'
               if (outlier(p) > 0) text = text//', or mend point '//to_text(outlier(p))//', which lies far from all others'
               call complain('XP', text)
               return
            end if
            if (abs(modulo(exact%angle(i) - exact%angle(k) + 180.0_wp, 360.0_wp) - 180.0_wp) > 0.0_wp) cycle
            call complain('ANGP', 'poses '//to_text(k)//' and '//to_text(i)//' are the same: leave one of both out')
            return
         end do
      end do
      if ((exact%slider .or. exact%block) .and. exact%follower_pivot) then
         if (exact%slider) call complain('PIVOTS', 'a slider has no fixed pivot; leave the follower''s out')
         if (exact%block) call complain('PIVOTS', 'the pivot of the block is found; leave the follower''s out')
         return
      end if
      if (exact%has_arm) then
         call check_arm(exact, i)
         if (i > 0) call complain('ARM', 'the chain does not reach pose '//to_text(i)//': make its links longer, or its '// &
                                  'elbow less straight')
         return
      end if
      if (has_poles(exact)) then
         conditions = size(p) - 1 + count(.not. is_missing(exact%pole_x))
         if (exact%slider .or. exact%block .or. exact%crank_pivot .or. exact%follower_pivot) then
            call complain('XPOLE', 'poses with poles are met by free four-bars: leave SLIDER and PIVOTS out')
         else if (conditions /= dyad_conditions) then
            call complain('XPOLE', to_text(size(p))//' poses and '//to_text(conditions - size(p) + 1)//' poles are '// &
                          to_text(conditions)//' conditions beyond the first pose; a four-bar meets four')
         end if
         return
      end if
      if (leaves_curves(exact)) return
      if (size(p) - 1 + terms_along(exact) > most_points) then
         call complain('TANP', to_text(size(p))//' points and '//to_text(terms_along(exact))//' tangents and curvatures are '// &
                       to_text(size(p) + terms_along(exact))//' conditions; no linkage meets more than nine: give fewer')
         return
      end if
      if (exact%block) then
         call complain('SLIDER', "a line of the coupler through a fixed pivot (SLIDER=2) is found for four poses, or for "// &
                       "three with the crank's pivot; five poses have one without being asked if they are those of one")
         return
      end if
      call problem_of(exact, problem)
      if (problem%is_square()) then
         if (all(problem%kind(:problem%points) == kind_point .or. problem%kind(:problem%points) == kind_rate) .and. &
             .not. problem%crank_given .and. .not. problem%follower_given .and. lie_on_circle(p, exact)) call complain('XP', &
            'the points lie on one circle or line: infinitely many linkages pass them')
         if (.not. leaves_symmetric_curve(exact)) return
         text = 'with both pivots on it'
         if (exact%slider) text = 'with their slide at right angles to it'
         call set%origins%warning(findings, 'EXACT', 'XP', 'the points are symmetric about a line: infinitely many linkages '// &
                                  'pass them, '//text//' and the coupler point on the line of its joints; only others can be '// &
                                  'listed. Move a point, or a given pivot off the line, for a complete list', 1)
         return
      end if
      conditions = sum(merge(2, 1, problem%kind(:problem%points) == kind_pose .or. &
                                   problem%kind(:problem%points) == kind_timed))
      text = ''
      if (exact%has_tangents()) text = 'a tangent or curvature 1, '
      text = 'the points make '//to_text(conditions)//' conditions (a point 1, a pose or timed point 2, '//text// &
             'the first none), but the linkage has '//to_text(problem%unknowns)//' dimensions to choose: '
      if (conditions < problem%unknowns) then
         call complain('XP', text//'infinitely many pass; give more')
      else
         call complain('XP', text//'none passes; give fewer')
      end if

   contains

      !> The point that lies far from all others, 0 if there is none.
      pure integer function outlier(p)
         complex(wp), intent(in) :: p(:)
         integer :: number(size(p)), i

         number = [(i, i=1, size(p))]
         do outlier = 1, size(p)
            if (span_of(pack(p, number /= outlier)) < outlying*span_of(p)) return
         end do
         outlier = 0
      end function outlier

      subroutine complain(item, message)
         character(*), intent(in) :: item, message

         call set%origins%error(findings, 'EXACT', item, message, 1)
      end subroutine complain
   end subroutine check_exact

   !> How many tangents and curvatures are given.
   pure integer function terms_along(exact)
      type(exact_group_t), intent(in) :: exact

      terms_along = count(.not. is_missing(exact%tangent)) + count(.not. is_missing(exact%bend))
   end function terms_along

   !> Directions of the path at the points, 0 where none is given.
   pure function directions_of(exact) result(along)
      type(exact_group_t), intent(in) :: exact
      complex(wp) :: along(size(exact%x))
      real(wp) :: c, s
      integer :: i

      along = (0.0_wp, 0.0_wp)
      do i = 1, size(along)
         if (is_missing(exact%tangent(i))) cycle
         call unit_vector(exact%tangent(i), c, s)
         along(i) = cmplx(c, s, wp)
      end do
   end function directions_of

   !> First pose that the chain of six-bars does not reach, 0 if there is none.
   subroutine check_arm(exact, pose)
      type(exact_group_t), intent(in) :: exact
      integer, intent(out) :: pose
      type(arm_t) :: arm
      complex(wp) :: p(poses_guided), d(poses_guided - 1), g(poses_guided - 1)

      call poses_of(exact, p, d, g)
      associate (joints => cmplx(exact%arm(1::2), exact%arm(2::2), wp) - p(1))
         call place_arm(d, g, joints(1), joints(2), joints(3), arm)
      end associate
      pose = arm%out_of_reach
   end subroutine check_arm

   !> True if the body is to turn about given points in some poses.
   pure logical function has_poles(exact)
      type(exact_group_t), intent(in) :: exact

      has_poles = exact%kind == kind_motion
      if (has_poles) has_poles = any(.not. is_missing(exact%pole_x))
   end function has_poles

   !> True if the poses leave curves of pivots: four, or three for a given crank's pivot and a slide.
   pure logical function leaves_curves(exact)
      type(exact_group_t), intent(in) :: exact

      leaves_curves = exact%kind == kind_motion .and. .not. exact%follower_pivot .and. .not. has_poles(exact)
      if (.not. leaves_curves) return
      leaves_curves = size(exact%x) == 4 .and. .not. exact%crank_pivot
      if (exact%slider .or. exact%block) leaves_curves = leaves_curves .or. (size(exact%x) == 3 .and. exact%crank_pivot)
   end function leaves_curves

   !> True if the points leave a curve of linkages that are symmetric as they are.
   pure logical function leaves_symmetric_curve(exact)
      type(exact_group_t), intent(in) :: exact

      leaves_symmetric_curve = all(is_missing(exact%angle(2:)) .and. is_missing(exact%time(2:)))
      if (leaves_symmetric_curve) leaves_symmetric_curve = leave_a_curve(cmplx(exact%x, exact%y, wp), &
         pack(cmplx(exact%pivots(1::2), exact%pivots(2::2), wp), [exact%crank_pivot, exact%follower_pivot]), exact%slider, &
         directions_of(exact), exact%bend, .not. is_missing(exact%bend))
   end function leaves_symmetric_curve

   !> True if points lie on one circle or line, which has their tangents and curvatures too, as far as rounding tells.
   pure logical function lie_on_circle(p, exact)
      complex(wp), intent(in) :: p(:)
      type(exact_group_t), intent(in) :: exact       !! tangents and curvatures
      complex(wp) :: q(size(p)), along(size(p))
      type(factors_t) :: factors
      real(wp) :: m(4, 4), rows(4, 3*size(p)), vector(4), norm
      integer :: i, k, n, turns

      n = size(p)
      lie_on_circle = n + terms_along(exact) > 3
      if (.not. lie_on_circle) return
      q = (p - sum(p)/real(size(p), wp))/span_of(p)
      do i = 1, size(p)
         rows(:, i) = [abs(q(i))**2, real(q(i), wp), aimag(q(i)), 1.0_wp]
      end do
      ! the first and second derivative of that along the path
      along = directions_of(exact)
      do i = 1, size(p)
         if (is_missing(exact%tangent(i))) cycle
         n = n + 1
         rows(:, n) = [2.0_wp*real(conjg(q(i))*along(i), wp), real(along(i), wp), aimag(along(i)), 0.0_wp]
         if (is_missing(exact%bend(i))) cycle
         n = n + 1
         associate (second => (0.0_wp, 1.0_wp)*(exact%bend(i)*span_of(p))*along(i))
            rows(:, n) = [2.0_wp + 2.0_wp*real(conjg(q(i))*second, wp), real(second, wp), aimag(second), 0.0_wp]
         end associate
      end do
      m = 0.0_wp
      do i = 1, n
         do k = 1, 4
            m(:, k) = m(:, k) + rows(:, i)*rows(k, i)
         end do
      end do
      ! the vector that the inverse magnifies most is the circle that fits best
      vector = [1.0_wp, 0.3_wp, -0.7_wp, 0.2_wp]
      do i = 1, 4
         m(i, i) = m(i, i) + epsilon(1.0_wp)
      end do
      call factorise(m, factors)
      do turns = 1, 4
         vector = solve(factors, vector)
         norm = sqrt(sum(vector**2))
         if (.not. norm > 0.0_wp) return
         vector = vector/norm
      end do
      lie_on_circle = all(abs(vector(1)*rows(1, :n) + vector(2)*rows(2, :n) + vector(3)*rows(3, :n) + vector(4)*rows(4, :n)) < &
                          on_circle)
   end function lie_on_circle

   !> The problem that the points ask for.
   pure subroutine problem_of(exact, problem)
      type(exact_group_t), intent(in) :: exact
      type(leg_problem_t), intent(out) :: problem
      integer :: kinds(size(exact%x) - 1), along(2*size(exact%x)), i, n

      kinds = kind_point
      where (.not. is_missing(exact%angle(2:))) kinds = kind_pose
      where (.not. is_missing(exact%time(2:))) kinds = kind_timed
      n = 0
      do i = 1, size(exact%x)
         if (is_missing(exact%tangent(i))) cycle
         along(n + 1:n + 2) = i - 1
         n = n + merge(1, 2, is_missing(exact%bend(i)))
      end do
      call make_problem(kinds, exact%slider, exact%crank_pivot, exact%follower_pivot, problem, along(:n))
   end subroutine problem_of

   !> Its numbers. `size` is the length by which they are divided.
   pure subroutine data_of(exact, problem, size, data)
      type(exact_group_t), intent(in) :: exact
      type(leg_problem_t), intent(in) :: problem
      real(wp), intent(in) :: size
      type(leg_data_t), intent(out) :: data
      complex(wp) :: first, a, b, along(ubound(exact%x, 1))
      real(wp) :: angle
      integer :: j

      first = cmplx(exact%x(1), exact%y(1), wp)
      along = directions_of(exact)
      do j = 1, problem%points
         if (problem%kind(j) == kind_rate) then
            associate (i => problem%chain(0, j) + 1)
               data%d(j) = along(i)
               if (problem%order(j) > 1) data%d(j) = cmplx(0.0_wp, 0.5_wp*exact%bend(i)*size, wp)*along(i)
            end associate
            data%dh(j) = conjg(data%d(j))
            cycle
         end if
         data%d(j) = (cmplx(exact%x(j + 1), exact%y(j + 1), wp) - first)/size
         data%dh(j) = conjg(data%d(j))
         if (problem%kind(j) == kind_point) cycle
         if (problem%kind(j) == kind_pose) angle = exact%angle(j + 1) - exact%angle(1)
         if (problem%kind(j) == kind_timed) angle = exact%time(j + 1) - exact%time(1)
         ! whole turns are no turn: the paths would wind with them
         if (abs(angle) > full_turn) angle = modulo(angle, full_turn)
         data%turn(j) = cmplx(0.0_wp, radians_per_degree*angle, wp)
      end do
      a = (0.0_wp, 0.0_wp)
      if (exact%crank_pivot) a = (cmplx(exact%pivots(1), exact%pivots(2), wp) - first)/size
      data%pivot(at_a) = a
      data%pivot(at_ah) = conjg(a)
      if (.not. exact%follower_pivot) return
      b = (cmplx(exact%pivots(3), exact%pivots(4), wp) - first)/size
      if (problem%differences) b = b - a
      data%pivot(at_b) = b
      data%pivot(at_bh) = conjg(b)
   end subroutine data_of

   ! ---- finding -------------------------------------------------------------------------------------------------------

   !> Find all linkages, assess and rank them. `set` has passed `check_exact`. After a stop, or when MAXTIME is over, those found so
   !> far; the list is never complete then, and there is no certificate.
   subroutine find_exact(set, study, stop, threads)
      type(data_set_t), intent(in) :: set
      type(exact_study_t), intent(out) :: study
      type(stop_t), intent(in), optional :: stop     !! asked now and then
      integer, intent(in), optional :: threads       !! that share the paths of six-bars; default 1
      type(exact_group_t), allocatable :: exact      ! large: it would fill a small stack
      type(stop_t) :: limited
      integer :: team

      team = 1
      if (present(threads)) team = threads
      exact = exact_of(set)
      if (present(stop)) limited = stop
      call limited%limit_time(exact%longest_time)
      allocate (study%results(0), study%approximations(0))
      if (exact%kind == kind_function) then
         call find_generators(exact, team, limited, study)
      else if (exact%has_arm) then
         call find_six_bars_of_arm(exact, study)
      else if (has_poles(exact) .or. (exact%kind == kind_motion .and. size(exact%x) == 5 .and. &
                                      .not. (exact%slider .or. exact%crank_pivot .or. exact%follower_pivot))) then
         call find_by_dyads(exact, study)
      else if (leaves_curves(exact)) then
         call find_on_curves(exact, study)
      else if (size(exact%x) > most_points + 1) then
         study%way = way_subsets
         call find_by_subsets(cmplx(exact%x, exact%y, wp), exact%subsets, exact%closed, exact%longest, exact%listed, &
                              study%subsets, limited)
         study%stopped = study%subsets%stopped
      else if (size(exact%x) == most_points + 1 .and. all(is_missing(exact%angle(2:)) .and. is_missing(exact%time(2:)))) then
         call find_nine_points(exact, limited, study)
      else
         call find_by_legs(exact, limited, study)
      end if
      if (study%way == way_nine .or. study%way == way_legs) then
         study%symmetric = leaves_symmetric_curve(exact)
         study%complete = study%complete .and. .not. study%symmetric
      end if
      if (study%stopped) study%out_of_time = .not. limited%requested()
      call leave_out_flat(exact, study)
   end subroutine find_exact

   !> True for kinds of results whose transmission angle TRMIN bounds: all but function generators with four links and chains that
   !> carry a body.
   pure logical function obeys_transmission(study)
      type(exact_study_t), intent(in) :: study

      obeys_transmission = all(study%way /= [way_generators, way_minimax, way_guided])
   end function obeys_transmission

   !> Leave out results whose transmission angle is less than TRMIN, if it was given. (Six-bars obey it when they are found.)
   pure subroutine leave_out_flat(exact, study)
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(inout) :: study
      integer, allocatable :: kept(:)
      integer :: i

      if (.not. exact%has_least_transmission) return
      select case (study%way)
      case (way_burmester, way_curves, way_legs, way_nine)
         kept = pack([(i, i=1, size(study%results))], study%results%verdict%transmission >= exact%least_transmission)
         study%flat = study%flat + size(study%results) - size(kept)
         study%results = study%results(kept)
      case (way_subsets)
         if (.not. allocated(study%subsets%results)) return
         kept = pack([(i, i=1, size(study%subsets%results))], &
                     study%subsets%results%verdict%transmission >= exact%least_transmission)
         study%flat = study%flat + size(study%subsets%results) - size(kept)
         study%subsets%results = study%subsets%results(kept)
      case default
         return
      end select
      if (allocated(study%proofs)) study%proofs = study%proofs(kept)
   end subroutine leave_out_flat

   !> Poses from the first.
   pure subroutine poses_of(exact, p, d, g)
      type(exact_group_t), intent(in) :: exact
      complex(wp), intent(out) :: p(:), d(:), g(:)   !! shapes (poses), (poses - 1), (poses - 1)
      real(wp) :: c, s
      integer :: j

      p = cmplx(exact%x, exact%y, wp)
      d = p(2:) - p(1)
      do j = 1, size(d)
         call unit_vector(exact%angle(j + 1) - exact%angle(1), c, s)
         g(j) = cmplx(c, s, wp) - 1.0_wp
      end do
   end subroutine poses_of

   !> Five poses, or fewer with poles: pairs of dyads.
   subroutine find_by_dyads(exact, study)
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(inout) :: study
      complex(wp) :: p(size(exact%x)), d(size(exact%x) - 1), g(size(exact%x) - 1)
      type(dyad_condition_t) :: conditions(dyad_conditions)
      type(dyads_t) :: dyads
      integer :: i, k

      study%way = way_burmester
      study%expected = size(dyads%list)
      call poses_of(exact, p, d, g)
      conditions = [of_poses(d, g), turns_about_poles(exact, p, d, g)]
      call five_conditions(conditions, dyads)
      study%degenerate = dyads%degenerate
      study%imaginary = dyads%imaginary
      study%infinite = dyads%infinite
      study%real_ends = dyads%count
      study%ends = dyads%count + dyads%imaginary + dyads%infinite
      study%complete = .not. dyads%degenerate .and. study%ends == study%expected
      do i = 1, dyads%count
         do k = i + 1, dyads%count
            call add_result(pair_of(p, g, dyads%list(i), dyads%list(k), exact%closed), study%results)
         end do
         do k = 1, dyads%sliding
            call add_result(pair_of(p, g, dyads%list(i), dyads%lines(k), exact%closed), study%results)
         end do
      end do
      study%linkages = size(study%results)
      call rank(study%results)
      i = dyads%count + dyads%imaginary
      if (.not. exact%certify .or. dyads%degenerate) return
      study%examined = .true.
      call certify_poses(p, exact%angle, pack(cmplx(exact%pole_x, exact%pole_y, wp), .not. is_missing(exact%pole_x)), &
                         pack([(k, k=0, size(p) - 1)], .not. is_missing(exact%pole_x)), dyads%ends(:, :i), &
                         [(k <= dyads%count, k=1, i)], study%certificate)
   end subroutine find_by_dyads

   !> Conditions of the poles: while the body turns, its reference point moves at right angles to the line from the pole.
   pure function turns_about_poles(exact, p, d, g) result(conditions)
      type(exact_group_t), intent(in) :: exact
      complex(wp), intent(in) :: p(:), d(:), g(:)    !! shapes (poses), (poses - 1), (poses - 1)
      type(dyad_condition_t), allocatable :: conditions(:)
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      complex(wp) :: place(size(p)), turn(size(p))
      integer :: k

      place = [(0.0_wp, 0.0_wp), d]
      turn = [(0.0_wp, 0.0_wp), g]
      allocate (conditions(0))
      do k = 1, size(p)
         if (is_missing(exact%pole_x(k))) cycle
         conditions = [conditions, derivative_of([place(k), i*(p(k) - cmplx(exact%pole_x(k), exact%pole_y(k), wp))], &
                                                 [turn(k), i*(1.0_wp + turn(k))], .false.)]
      end do
   end function turns_about_poles

   !> Poses that leave curves: pairs of their points, or of one and of a line.
   subroutine find_on_curves(exact, study)
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(inout) :: study
      complex(wp) :: p(size(exact%x)), d(size(exact%x) - 1), g(size(exact%x) - 1)
      type(pin_pair_t), allocatable :: cranks(:)
      type(pin_pair_t) :: one
      logical :: exists

      study%way = way_curves
      call poses_of(exact, p, d, g)
      allocate (study%lines(0))
      if (exact%slider .or. exact%block) call find_lines(exact%block, d, g, study%lines)
      if (size(p) == 4) then
         call sample_curve(d, g, 0, study%curve)
         cranks = study%curve%dyad
      else
         one%pivot = cmplx(exact%pivots(1), exact%pivots(2), wp) - p(1)
         call pin_for_pivot(d, g, one, exists)
         cranks = pack([one], [exists])
      end if
      study%ends = size(cranks)
      study%degenerate = size(cranks) == 0 .or. ((exact%slider .or. exact%block) .and. size(study%lines) == 0)
      if (study%degenerate) return
      call find_pairs(p, g, cranks, study%lines, exact%closed, tries*exact%listed, study%results, study%linkages)
   end subroutine find_on_curves

   !> Six-bars that lead a body: a chain and two links.
   subroutine find_six_bars_of_arm(exact, study)
      type(exact_group_t), intent(in) :: exact
      type(exact_study_t), intent(inout) :: study
      type(arm_t) :: arm
      complex(wp) :: p(poses_guided), d(poses_guided - 1), g(poses_guided - 1)

      study%way = way_guided
      call poses_of(exact, p, d, g)
      associate (joints => cmplx(exact%arm(1::2), exact%arm(2::2), wp) - p(1))
         call place_arm(d, g, joints(1), joints(2), joints(3), arm)
      end associate
      call find_guided(arm, span_of(p), exact%listed, study%guided)
   end subroutine find_six_bars_of_arm

   !> Nine points: the stored problem, then all cognates of what is real.
   subroutine find_nine_points(exact, stop, study)
      type(exact_group_t), intent(in) :: exact
      type(stop_t), intent(in) :: stop
      type(exact_study_t), intent(inout) :: study
      type(nine_points_t) :: found
      type(leg_data_t) :: data
      type(exact_linkage_t) :: one, others(2)
      complex(wp), allocatable :: own(:, :), turns(:, :), partners(:, :)
      logical, allocatable :: likely(:)
      complex(wp) :: p(0:most_points), v(variables), g(most_points), gh(most_points), turn(0:most_points), legs(variables), first
      integer :: i, k

      study%way = way_nine
      study%cognates = .true.
      study%expected = nine_point_orbits
      study%generic = nine_point_orbits
      p = cmplx(exact%x, exact%y, wp)
      call solve_nine_points(p, 1, found, stop=stop)
      study%ends = size(found%solutions, 2)
      call take_counts(found%ends, study)
      study%complete = found%ends%complete()
      study%passes = found%passes
      allocate (own(variables, study%ends), turns(most_points, study%ends), partners(most_points, study%ends), likely(study%ends))
      first = p(found%order(0) - 1)
      data%d = p(found%order(1:) - 1) - first
      data%dh = conjg(data%d)
      do i = 1, study%ends
         v = in_place(found, found%solutions(:, i))
         call turns_of(found%path%problem, data, v, g, gh)
         own(:, i) = v
         turns(:, i) = g
         partners(:, i) = gh
         likely(i) = is_real(v)
         if (.not. likely(i)) cycle
         study%real_ends = study%real_ends + 1
         legs = absolute(found%path%problem, v)
         turn(found%order(0) - 1) = (1.0_wp, 0.0_wp)
         turn(found%order(1:) - 1) = (1.0_wp + g)/abs(1.0_wp + g)
         one%p = [p]
         one%a = first + legs(at_a)
         one%b = first + legs(at_b)
         one%c = p + turn*legs(at_x)
         one%d = p + turn*legs(at_y)
         one%turn = [turn/turn(0)]
         call cognates_of(one, others)
         call add_result(assessed(one, .true., exact%closed), study%results)
         do k = 1, 2
            call add_result(assessed(others(k), .true., exact%closed), study%results)
         end do
      end do
      study%linkages = size(study%results)
      call rank(study%results)
      if (.not. exact%certify .or. study%stopped) return
      study%examined = .true.
      call certify_legs(found%path%problem, p(found%order - 1), [(0.0_wp, i=0, most_points)], [(first, i=1, 2)], own, turns, &
                        partners, likely, .true., study%certificate)
   end subroutine find_nine_points

   !> How many ends are no regular ones.
   pure subroutine take_counts(ends, study)
      type(ends_t), intent(in) :: ends
      type(exact_study_t), intent(inout) :: study

      study%stopped = ends%stopped
      study%paths = ends%paths
      study%followed = ends%followed
      study%infinite = ends%infinite
      study%singular = size(ends%singular, 2)
      study%merged = ends%to_singular - study%singular + ends%shared
   end subroutine take_counts

   !> True if numbers and partners are conjugate.
   pure logical function is_real(v)
      complex(wp), intent(in) :: v(variables)

      is_real = maxval(abs(v(2::2) - conjg(v(1::2)))) < real_within*maxval(abs(v))
   end function is_real

   !> Mixed points, poses and timed points, tangents and curvatures: a generic problem is solved and its solutions followed. Of
   !> a path alone, nine conditions, a solution stands for its cognates.
   subroutine find_by_legs(exact, stop, study)
      type(exact_group_t), intent(in) :: exact
      type(stop_t), intent(in) :: stop
      type(exact_study_t), intent(inout) :: study
      type(leg_problem_t) :: problem
      type(generic_t) :: generic
      type(leg_data_t), allocatable :: turned        ! large, as the next: they would fill a small stack
      type(problem_path_t), allocatable :: path
      type(tracked_t) :: tracked
      type(ends_t) :: ends
      type(xoshiro_t) :: random
      type(exact_linkage_t) :: one, others(2)
      complex(wp), allocatable :: starts(:, :), found(:, :)
      complex(wp), allocatable :: turns(:, :), partners(:, :)
      complex(wp) :: v(variables), legs(variables), l, m, first
      logical, allocatable :: likely(:)
      real(wp), allocatable :: left(:)
      complex(wp) :: points(0:most_points)
      real(wp) :: size_of_all, degrees(0:most_points), curvatures(0:most_points)
      integer :: i, k, pass, before

      allocate (turned, path)
      study%way = way_legs
      call problem_of(exact, problem)
      study%cognates = problem%has_cognates()
      study%expected = solutions_of(problem)
      call generic_solutions(problem, study%expected, generic, stop)
      study%generic = size(generic%solutions, 2)
      size_of_all = span_of(cmplx(exact%x, exact%y, wp))
      if (.not. size_of_all > 0.0_wp) size_of_all = 1.0_wp
      path%problem = problem
      call data_of(exact, problem, size_of_all, path%to)
      call random%seed(seed, purpose_starts)
      call random%jump()
      before = 0
      do pass = 1, most_passes
         l = random_unit(random)
         m = random_unit(random)
         starts = generic%solutions
         call scale_problem(problem, generic%data, l, m, turned)
         call scale_solutions(problem, l, m, starts)
         path%from = turned
         call track_carefully(path, starts, problem%has_cognates(), tracked, stop)
         call take_ends(path, tracked, problem%has_cognates(), ends)
         study%passes = pass
         if (ends%complete() .or. ends%stopped) exit
         if (pass > 1 .and. ends%settled + size(ends%regular, 2) == before) exit
         before = ends%settled + size(ends%regular, 2)
      end do
      allocate (left(size(ends%regular, 2)))
      call polish(path, ends%regular, left)
      study%ends = ends%count_of()
      allocate (found(variables, study%ends))
      found(:, :size(ends%regular, 2)) = ends%regular
      found(:, size(ends%regular, 2) + 1:) = ends%singular
      call take_counts(ends, study)
      study%complete = ends%complete() .and. study%generic == study%expected
      first = cmplx(exact%x(1), exact%y(1), wp)
      allocate (likely(study%ends), source=.false.)
      allocate (turns(most_points, study%ends), partners(most_points, study%ends), source=(0.0_wp, 0.0_wp))
      do i = 1, study%ends
         v = found(:, i)
         call turns_of(problem, path%to, v, turns(:problem%points, i), partners(:problem%points, i))
         if (problem%slides) v(at_bh) = conjg(v(at_b))
         if (problem%slides) then
            if (abs(abs(v(at_b)) - 1.0_wp) > real_within) cycle
         end if
         if (.not. is_real(v)) cycle
         likely(i) = .true.
         study%real_ends = study%real_ends + 1
         legs = absolute(problem, v)
         ! of two solutions with exchanged legs one is enough
         if (problem%is_symmetric() .and. .not. problem%has_cognates() .and. comes_second(legs)) cycle
         one%p = cmplx(exact%x, exact%y, wp)
         associate (turn => 1.0_wp + turns(:size(exact%x) - 1, i))
            one%turn = [(1.0_wp, 0.0_wp), turn/abs(turn)]
         end associate
         one%a = first + size_of_all*legs(at_a)
         one%b = first + size_of_all*legs(at_b)
         one%slides = problem%slides
         call place_pins(first + size_of_all*legs(at_x), first + size_of_all*legs(at_y), one)
         if (problem%slides) then
            one%guide = sqrt(legs(at_b)/abs(legs(at_b)))
            one%b = one%d(1)
         end if
         call add_result(assessed(one, .not. (problem%crank_given .or. problem%follower_given) .and. &
                                all(problem%kind(:problem%points) /= kind_timed), exact%closed), study%results)
         if (.not. problem%has_cognates()) cycle
         call cognates_of(one, others)
         do k = 1, size(others)
            call add_result(assessed(others(k), .true., exact%closed), study%results)
         end do
      end do
      study%linkages = size(study%results)
      call rank(study%results)
      if (.not. exact%certify .or. study%stopped) return
      study%examined = .true.
      call scale_solutions(problem, cmplx(size_of_all, kind=wp), cmplx(size_of_all, kind=wp), found)
      degrees = 0.0_wp
      curvatures = 0.0_wp
      points = (0.0_wp, 0.0_wp)
      do i = 0, size(exact%x) - 1
         points(i) = cmplx(exact%x(i + 1), exact%y(i + 1), wp)
         if (.not. is_missing(exact%angle(i + 1))) degrees(i) = exact%angle(i + 1)
         if (any(problem%kind == kind_timed) .and. .not. is_missing(exact%time(i + 1))) degrees(i) = exact%time(i + 1)
      end do
      do k = size(exact%x), problem%points
         i = problem%chain(0, k) + 1
         degrees(k) = exact%tangent(i)
         if (problem%order(k) > 1) curvatures(k) = exact%bend(i)
         ! by the arc as it is, no longer by that over the size of all
         turns(k, :) = turns(k, :)/size_of_all**problem%order(k)
         partners(k, :) = partners(k, :)/size_of_all**problem%order(k)
      end do
      call certify_legs(problem, points(:problem%points), degrees(:problem%points), &
                        cmplx(exact%pivots(1::2), exact%pivots(2::2), wp), found, turns, partners, likely, &
                        problem%has_cognates(), study%certificate, curvatures(:problem%points))
   end subroutine find_by_legs

   !> True for one of two solutions that are each other's with exchanged legs.
   pure logical function comes_second(legs)
      complex(wp), intent(in) :: legs(variables)

      if (abs(real(legs(at_x) - legs(at_y), wp)) > 0.0_wp) then
         comes_second = real(legs(at_x), wp) > real(legs(at_y), wp)
      else
         comes_second = aimag(legs(at_x)) > aimag(legs(at_y))
      end if
   end function comes_second

   ! ---- what is proven ------------------------------------------------------------------------------------------------

   !> How many results there are.
   pure integer function results_of(study)
      type(exact_study_t), intent(in) :: study

      select case (study%way)
      case (way_generators)
         results_of = study%generators%count
      case (way_minimax)
         results_of = size(study%approximations)
      case (way_six_bars)
         results_of = size(study%six_bars%best)
      case (way_every_six_bar)
         results_of = size(study%every%best)
      case (way_subsets)
         results_of = size(study%subsets%results)
      case (way_guided)
         results_of = size(study%guided%list)
      case default
         results_of = size(study%results)
      end select
   end function results_of

   !> True if a result meets all that is wanted in the assembly of its first position.
   pure logical function stays_assembled(study, number)
      type(exact_study_t), intent(in) :: study
      integer, intent(in) :: number

      select case (study%way)
      case (way_generators)
         stays_assembled = study%generators%list(number)%assembly /= 0 .and. .not. study%generators%list(number)%opens
      case (way_guided)
         stays_assembled = study%guided%list(number)%valid
      case (way_minimax, way_six_bars, way_subsets, way_every_six_bar)
         stays_assembled = .true.
      case default
         stays_assembled = study%results(number)%verdict%branch
      end select
   end function stays_assembled

   !> Take what is proven of the first results, and put those that are proven to close between the positions before the others. A
   !> rocking crank's transmission angle, so far that at the points, is the proven one from now on.
   pure subroutine rank_proven(proofs, study)
      type(exact_proof_t), intent(in) :: proofs(:)   !! shape (results looked at)
      type(exact_study_t), intent(inout) :: study
      integer :: order(results_of(study)), i, k, n

      n = size(proofs)
      if (allocated(study%results)) then
         do i = 1, min(n, size(study%results))
            associate (verdict => study%results(i)%verdict)
               if (proofs(i)%closes .and. proofs(i)%transmits .and. .not. verdict%crank) &
                  verdict%transmission = proofs(i)%transmission
            end associate
         end do
      end if
      do i = 1, size(order)
         k = i
         do while (k > 1)
            if (.not. goes_before(i, order(k - 1))) exit
            order(k) = order(k - 1)
            k = k - 1
         end do
         order(k) = i
      end do
      study%proofs = [proofs, [(exact_proof_t(), i=n + 1, size(order))]]
      study%proofs = study%proofs(order)
      select case (study%way)
      case (way_generators)
         study%generators%list(:size(order)) = study%generators%list(order)
      case (way_minimax)
         study%approximations = study%approximations(order)
      case (way_six_bars)
         study%six_bars%best = study%six_bars%best(order)
      case (way_every_six_bar)
         study%every%best = study%every%best(order)
      case (way_subsets)
         study%subsets%results = study%subsets%results(order)
      case (way_guided)
         study%guided%list = study%guided%list(order)
      case default
         study%results = study%results(order)
      end select

   contains

      !> True if the first result is to stand before the second, which is before it now.
      pure logical function goes_before(first, second)
         integer, intent(in) :: first, second
         logical :: closes(2)

         closes = .false.
         if (first <= n) closes(1) = proofs(first)%closes
         if (second <= n) closes(2) = proofs(second)%closes
         goes_before = closes(1) .and. .not. closes(2)
         if (all(closes) .and. allocated(study%results)) then
            if (size(study%results) == size(order)) goes_before = is_better(study%results(first)%verdict, &
                                                                            study%results(second)%verdict)
         end if
      end function goes_before
   end subroutine rank_proven

   ! ---- functions -----------------------------------------------------------------------------------------------------

   !> The function that is asked for, and its points: of a name those of Chebyshev, radians; of a slider psi is the travel.
   pure subroutine wanted_of(exact, wanted, phi, psi)
      type(exact_group_t), intent(in) :: exact
      type(desired_function_t), intent(out) :: wanted
      real(wp), allocatable, intent(out) :: phi(:), psi(:)
      real(wp) :: unit

      unit = merge(1.0_wp, radians_per_degree, exact%slider)
      wanted%slides = exact%slider
      if (allocated(exact%function_name)) then
         wanted%kind = function_kind(exact%function_name)
         wanted%low = exact%low
         wanted%high = exact%high
         wanted%power = exact%power
         wanted%swing_in = exact%swing_in*radians_per_degree
         wanted%swing_out = exact%swing_out*unit
         phi = wanted%input_at(chebyshev(exact%precision_points))
         psi = wanted%output_at(chebyshev(exact%precision_points))
      else
         phi = exact%phi*radians_per_degree
         psi = exact%psi*unit
         wanted%kind = function_table
         wanted%continuous = .false.
         wanted%table_input = phi
         wanted%table_output = psi
         wanted%swing_in = phi(size(phi)) - phi(1)
         wanted%swing_out = maxval(psi) - minval(psi)
      end if
   end subroutine wanted_of

   !> Errors: points of a function for which six-bars cannot be found one by one.
   subroutine check_six_bar_points(exact, set, findings)
      type(exact_group_t), intent(in) :: exact
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(desired_function_t) :: wanted
      real(wp), allocatable :: phi(:), psi(:)
      character(:), allocatable :: item
      integer :: i, k

      if (exact%six_bar == six_bar_none) return
      call wanted_of(exact, wanted, phi, psi)
      if (exact%minimax .and. .not. wanted%continuous) call choose_entries(exact%points_determined(), wanted, phi, psi)
      if (.not. maxval(angle_between(psi - psi(1))) > apart) then
         call set%origins%error(findings, 'EXACT', trim(merge('FUNC', 'PSI ', wanted%continuous)), &
                                'the output stands still, as far as whole turns do not count: no linkage is needed', 1)
         return
      end if
      if (.not. exact%wants_every_six_bar()) return
      item = 'PHI'
      if (wanted%continuous) item = 'DPHI'
      do i = 2, size(phi)
         do k = 1, i - 1
            if (angle_between(phi(i) - phi(k)) > apart) cycle
            call set%origins%error(findings, 'EXACT', item, 'points '//to_text(k)//' and '//to_text(i)//' have the same input, '// &
                                   'as far as whole turns do not count: leave one of both out', 1)
            return
         end do
      end do
      if (all(angle_between(psi - psi(1) - phi + phi(1)) < apart) .or. &
          all(angle_between(psi - psi(1) + phi - phi(1)) < apart)) call set%origins%error(findings, 'EXACT', item, &
         'the output turns as the input does, alike or against it: infinitely many six-bars with parallelograms or kites pass '// &
         'the points; gears or a four-bar with parallel cranks do it', 1)
   end subroutine check_six_bar_points

   !> Size of an angle without whole turns, radians.
   elemental real(wp) function angle_between(angle)
      real(wp), intent(in) :: angle

      angle_between = abs(modulo(angle + pi, 2.0_wp*pi) - pi)
   end function angle_between

   !> Function generators: through points, or with the least largest error.
   subroutine find_generators(exact, threads, stop, study)
      type(exact_group_t), intent(in) :: exact
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      type(exact_study_t), intent(inout) :: study
      integer :: node
      real(wp), allocatable :: phi(:), psi(:)
      type(function_point_t), allocatable :: points(:)
      real(wp) :: unit
      logical :: exists

      study%way = merge(way_minimax, way_generators, exact%minimax .and. exact%six_bar == six_bar_none)
      unit = merge(1.0_wp, radians_per_degree, exact%slider)
      call wanted_of(exact, study%wanted, phi, psi)
      if (exact%minimax .and. exact%six_bar == six_bar_none) then
         call approximate(study%wanted, exact%longest, study%approximations, study%too_long)
         return
      end if
      study%phi = phi
      study%psi = psi
      if (exact%wants_every_six_bar()) then
         call find_all_six_bars(exact, threads, stop, study)
         return
      end if
      if (exact%six_bar /= six_bar_none) then
         study%way = way_six_bars
         if (exact%six_bar == six_bar_watt) then
            call find_watt(study%wanted, phi, psi, 2*exact%grid, exact%listed, exact%least_transmission, exact%longest, &
                           study%six_bars, stop)
         else
            call find_stephenson(study%wanted, phi, psi, exact%grid, exact%listed, exact%least_transmission, exact%longest, &
                                 study%six_bars, stop)
         end if
         study%stopped = study%six_bars%stopped
         return
      end if
      points = points_of(exact, phi, psi)
      select case (size(phi) + sum(points%order))
      case (5)
         call five_points(points, exact%slider, study%generators)
         study%expected = 3
         if (exact%certify .and. .not. study%generators%degenerate) then
            study%examined = .true.
            associate (dyads => study%generators%dyads)
               call certify_generators(points, exact%slider, dyads%ends(:, :dyads%count + dyads%imaginary), &
                                       [(node <= dyads%count, node=1, dyads%count + dyads%imaginary)], study%generators%frame, &
                                       study%certificate)
            end associate
         end if
      case (4)
         call four_points(points, exact%slider, is_missing(exact%zero_in), &
                          radians_per_degree*merge(exact%zero_out, exact%zero_in, is_missing(exact%zero_in)), study%generators)
         study%expected = 2
      case default
         points%phi = phi + exact%zero_in*radians_per_degree
         points%psi = psi + exact%zero_out*unit
         call three_points(points, study%generators%list(1), exists)
         study%generators%list(1)%phi0 = study%generators%list(1)%phi0 + exact%zero_in*radians_per_degree
         study%generators%list(1)%psi0 = study%generators%list(1)%psi0 + exact%zero_out*unit
         study%generators%count = merge(1, 0, exists)
         study%expected = 1
      end select
      study%ends = study%generators%count + study%generators%imaginary + study%generators%infinite
      study%degenerate = study%generators%degenerate
      study%complete = .not. study%degenerate .and. study%ends == study%expected
      study%real_ends = study%generators%count
   end subroutine find_generators

   !> Points of a function with the derivatives that are wanted there.
   pure function points_of(exact, phi, psi) result(points)
      type(exact_group_t), intent(in) :: exact
      real(wp), intent(in) :: phi(:), psi(:)
      type(function_point_t) :: points(size(phi))
      integer :: i

      do i = 1, size(points)
         points(i)%phi = phi(i)
         points(i)%psi = psi(i)
         if (allocated(exact%function_name)) cycle
         points(i)%order = merge(0, merge(1, 2, is_missing(exact%curvature(i))), is_missing(exact%slope(i)))
         if (points(i)%order > 0) points(i)%rate(1) = exact%slope(i)
         if (points(i)%order > 1) points(i)%rate(2) = exact%curvature(i)
      end do
   end function points_of

   !> Chebyshev's points of a range from 0 to 1.
   pure function chebyshev(points) result(places)
      integer, intent(in) :: points
      real(wp) :: places(points)
      integer :: k

      places = [(0.5_wp - 0.5_wp*cos(pi*(2.0_wp*real(k, wp) - 1.0_wp)/real(2*points, wp)), k=1, points)]
   end function chebyshev

   !> Of a table with more entries those that exact six-bars are to meet: the nearest to Chebyshev's points, each once.
   pure subroutine choose_entries(points, wanted, phi, psi)
      integer, intent(in) :: points
      type(desired_function_t), intent(in) :: wanted
      real(wp), allocatable, intent(inout) :: phi(:), psi(:)
      integer :: entry(points), i, k, n, before
      real(wp) :: place(points)

      n = size(wanted%table_input)
      place = chebyshev(points)
      before = 0
      do i = 1, points
         entry(i) = minloc(abs(wanted%place_of([(k, k=1, n)]) - place(i)), dim=1)
         entry(i) = min(max(entry(i), before + 1), n - points + i)
         before = entry(i)
      end do
      phi = wanted%table_input(entry)
      psi = wanted%table_output(entry)
   end subroutine choose_entries

   !> All six-bars through the points of a function.
   subroutine find_all_six_bars(exact, threads, stop, study)
      type(exact_group_t), intent(in) :: exact
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      type(exact_study_t), intent(inout) :: study
      type(six_bar_problem_t) :: problem
      complex(wp) :: given(most_unknowns)
      logical :: is_given(most_unknowns)
      real(wp), allocatable :: phi(:), psi(:)
      integer :: type, length_of

      study%way = way_every_six_bar
      given = (0.0_wp, 0.0_wp)
      is_given = .false.
      length_of = 0
      select case (exact%six_bar)
      case (six_bar_watt)
         type = watt_2
         if (.not. is_missing(exact%arm_length)) length_of = at_q
      case (six_bar_stephenson_2)
         type = stephenson_2
         is_given(at_output) = .not. is_missing(exact%output_pin(1))
         if (is_given(at_output)) given(at_output) = -cmplx(exact%output_pin(1), exact%output_pin(2), wp)/exact%frame
         if (.not. is_missing(exact%arm_length)) length_of = at_first_arm
      case default
         type = stephenson_3
         is_given(at_p) = .not. is_missing(exact%crank(1))
         is_given(at_c) = exact%crank_pivot
         if (is_given(at_p)) given(at_p) = cmplx(exact%crank(1), exact%crank(2), wp)/exact%frame
         if (is_given(at_c)) given(at_c) = -cmplx(exact%pivots(1), exact%pivots(2), wp)/exact%frame
      end select
      phi = study%phi
      psi = study%psi
      if (exact%minimax .and. .not. study%wanted%continuous) call choose_entries(exact%points_determined(), study%wanted, phi, psi)
      call make_six_bar_problem(type, size(phi) - 1, is_given, length_of, problem)
      if (length_of > 0) given(length_of) = (exact%arm_length/exact%frame)**2
      call find_every_six_bar(problem, study%wanted, phi, psi, given, exact%least_transmission, exact%longest, exact%minimax, &
                              threads, study%every, stop)
      associate (found => study%every%found)
         study%expected = merge(study%every%expected, 0, study%every%certain)
         study%generic = study%every%known
         study%ends = size(found%ends, 2)
         study%paths = found%paths
         study%followed = found%followed
         study%passes = found%passes
         study%stopped = found%stopped
         study%real_ends = size(study%every%real_ones)
         study%complete = found%complete() .and. study%every%certain .and. study%generic == study%expected
      end associate
      study%linkages = study%real_ends
      if (.not. exact%certify .or. study%stopped) return
      study%examined = .true.
      if (study%real_ends == 0) return
      associate (every => study%every)
         call certify_six_bars(problem, every%data, phi, psi, every%found%ends(:, every%real_ones), study%certificate)
      end associate
   end subroutine find_all_six_bars
end module psalm_exact_study
