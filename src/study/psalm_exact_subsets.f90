!> More points than a four-bar can meet: those that pass nine of them exactly as starts of least squares over all.
!>
!> Nine points are drawn, one from each ninth of the path; of all four-bars through them, cognates and both drivers, those whose
!> crank turns fully are laid over all points in the best timing that keeps their order. The best are refined with free timing.
!> Source: Wampler, Morgan and Sommese (1992) for the idea; notation of the refining: psalm_path_fit.
module psalm_exact_subsets
   use psalm_defects, only: cognates_of, exact_linkage_t, assess, verdict_t, with_other_driver
   use psalm_kinds, only: wp
   use psalm_leg_problem, only: absolute, at_a, at_b, at_x, at_y, variables
   use psalm_nine_points, only: in_place, nine_points_t, solve_nine_points
   use psalm_path_descent, only: descend, nearest_g, retime
   use psalm_path_fit, only: error_of, path_workspace_t, fitted_path_t, prepare_path, trace_coupler, path_timing_t
   use psalm_stop, only: stop_t
   use psalm_xoshiro, only: purpose_starts, xoshiro_t
   implicit none (type, external)
   private
   public :: subset_study_t, find_by_subsets

   integer, parameter :: taken = 9                   !! points that are met exactly
   integer, parameter :: most_refined = 8            !! of a set
   integer, parameter :: most_draws = 50             !! until nine distinct points are found
   integer, parameter :: seed = 1
   real(wp), parameter :: distinct = 1.0e-6_wp       !! distance of two points of a set, over the size of the path
   real(wp), parameter :: same = 1.0e-4_wp           !! relative difference of the errors of two results that are one
   real(wp), parameter :: real_within = 1.0e-6_wp    !! of a number and the conjugate of its partner, over the largest

   !> A four-bar near all points, at its places there.
   type :: subset_result_t
      type(exact_linkage_t) :: linkage
      type(verdict_t) :: verdict
      real(wp) :: before = 0.0_wp                    !! root of the mean squared distance as it passed nine points exactly
      real(wp) :: after = 0.0_wp                     !! refined
   end type subset_result_t

   type :: subset_study_t
      integer :: sets = 0                            !! searched
      logical :: stopped = .false.                   !! before all sets were searched
      integer :: complete = 0                        !! sets of which all four-bars were found
      integer :: starts = 0                          !! four-bars with a turning crank that were laid over the points
      type(subset_result_t), allocatable :: results(:) !! ranked by the distance
   end type subset_study_t

contains

   !> Draw sets of nine points, lay all their four-bars over all points, refine the best. A stop leaves the results of the sets
   !> that were searched before, and of the last one what was refined.
   subroutine find_by_subsets(p, sets, closed, longest, most, study, stop)
      complex(wp), intent(in) :: p(:)                !! shape (points), more than nine
      integer, intent(in) :: sets, most              !! results kept
      logical, intent(in) :: closed
      real(wp), intent(in) :: longest                !! link, over the size of the path
      type(subset_study_t), intent(out) :: study
      type(stop_t), intent(in), optional :: stop     !! asked now and then
      type(fitted_path_t) :: paths(2)                       !! as it is, and mirrored: passed the other way round
      type(path_workspace_t), allocatable :: work
      type(nine_points_t) :: found
      type(path_timing_t) :: best(most_refined)
      type(xoshiro_t) :: random
      type(exact_linkage_t) :: one, others(2)
      complex(wp) :: v(variables), legs(variables), first
      real(wp) :: size_of_path, scores(most_refined)
      integer :: set, i, k, chosen(taken), sense, senses(most_refined)
      logical :: drawn

      allocate (study%results(0))
      size_of_path = maxval(abs(p - sum(p)/real(size(p), wp)))
      do k = 2, 1, -1
         if (allocated(work)) deallocate (work)
         allocate (work)
         call prepare_path(real(p, wp), aimag(p)*merge(1.0_wp, -1.0_wp, k == 1), [(1.0_wp, i=1, size(p))], &
                           [(0.0_wp, i=1, 6)], [(longest*size_of_path, i=1, 6)], 1.0_wp, 1.0_wp, paths(k), work)
      end do
      call random%seed(seed, purpose_starts)
      do set = 1, sets
         call draw(p, size_of_path, random, chosen, drawn)
         if (.not. drawn) exit
         call solve_nine_points(p(chosen), 1, found, quick=.true., stop=stop)
         study%stopped = found%ends%stopped
         if (study%stopped) exit
         if (found%ends%complete()) study%complete = study%complete + 1
         scores = huge(1.0_wp)
         do i = 1, size(found%solutions, 2)
            v = in_place(found, found%solutions(:, i))
            if (maxval(abs(v(2::2) - conjg(v(1::2)))) > real_within*maxval(abs(v))) cycle
            legs = absolute(found%path%problem, v)
            first = p(chosen(found%order(0)))
            one%a = first + legs(at_a)
            one%b = first + legs(at_b)
            one%p = [first]
            one%c = [first + legs(at_x)]
            one%d = [first + legs(at_y)]
            one%turn = [(1.0_wp, 0.0_wp)]
            call cognates_of(one, others)
            call lay(one)
            call lay(others(1))
            call lay(others(2))
         end do
         do k = 1, most_refined
            if (.not. scores(k) < huge(1.0_wp)) cycle
            if (present(stop)) study%stopped = stop%waiting()
            if (study%stopped) return
            call refine(best(k), senses(k))
         end do
         study%sets = study%sets + 1
      end do

   contains

      !> Lay a four-bar, driven at either pivot and passed in either sense, over all points; the best are remembered.
      subroutine lay(four_bar)
         type(exact_linkage_t), intent(in) :: four_bar
         type(exact_linkage_t) :: driven
         type(path_timing_t) :: timing
         integer :: driver, worst
         logical :: turns

         driven = four_bar
         do driver = 1, 2
            if (driver == 2) driven = with_other_driver(four_bar)
            do sense = 1, 2
               call timing_of(driven, paths(sense), sense == 2, timing, turns)
               if (.not. turns) exit
               study%starts = study%starts + 1
               call retime(paths(sense), timing, work)
               call trace_coupler(timing, timing%t, work%e, work%v)
               timing%error = error_of(paths(sense), work%e, work%v, timing)
               worst = maxloc(scores, dim=1)
               if (timing%error >= scores(worst)) cycle
               ! cognates and drivers of one curve have one error
               if (any(abs(scores - timing%error) < same*timing%error)) cycle
               scores(worst) = timing%error
               best(worst) = timing
               senses(worst) = sense
            end do
         end do
      end subroutine lay

      !> Refine a timing and add it to the results.
      subroutine refine(timing, sense)
         type(path_timing_t), intent(inout) :: timing
         integer, intent(in) :: sense
         type(subset_result_t) :: own
         type(subset_result_t), allocatable :: more(:)
         integer :: place, n

         own%before = paths(sense)%size*sqrt(timing%error/real(size(p), wp))
         call finish(paths(sense), timing, work)
         own%after = paths(sense)%size*sqrt(timing%error/real(size(p), wp))
         call linkage_of(timing, paths(sense), sense == 2, own%linkage)
         call assess(own%linkage, closed, own%verdict)
         if (any(abs(study%results%after - own%after) < same*own%after)) return
         place = count(study%results%after <= own%after) + 1
         if (place > most) return
         n = min(size(study%results) + 1, most)
         allocate (more(n))
         more(:place - 1) = study%results(:place - 1)
         more(place) = own
         more(place + 1:) = study%results(place:n - 1)
         call move_alloc(more, study%results)
      end subroutine refine
   end subroutine find_by_subsets

   !> Least squares from a start and from its best timing anew, the better of both; then until every bound is kept.
   subroutine finish(path, timing, work)
      type(fitted_path_t), intent(in) :: path
      type(path_timing_t), intent(inout) :: timing
      type(path_workspace_t), intent(inout) :: work
      integer, parameter :: steps = 500, rounds = 5
      real(wp), parameter :: gain = 1.0e-5_wp, inside = 1.0e-6_wp, of_violations = 30.0_wp, least_error = 1.0e-9_wp
      type(path_timing_t) :: other
      real(wp) :: weight
      integer :: k

      weight = of_violations*max(timing%error, least_error*real(path%n, wp))
      call descend(path, steps, gain, weight, 0.0_wp, timing, work)
      other = timing
      call retime(path, other, work)
      call descend(path, steps, gain, weight, 0.0_wp, other, work)
      if (other%error + weight*other%violation < timing%error + weight*timing%violation) timing = other
      do k = 1, rounds
         weight = 100.0_wp**k*max(timing%error, least_error*real(path%n, wp))
         call descend(path, steps, gain, weight, inside, timing, work)
         if (timing%worst < inside) exit
      end do
   end subroutine finish

   !> Nine points, one from each ninth of the path, no two of them together.
   subroutine draw(p, size_of_path, random, chosen, drawn)
      complex(wp), intent(in) :: p(:)
      real(wp), intent(in) :: size_of_path
      type(xoshiro_t), intent(inout) :: random
      integer, intent(out) :: chosen(taken)
      logical, intent(out) :: drawn
      real(wp) :: deviate
      integer :: try, i, k, from, to

      do try = 1, most_draws
         drawn = .true.
         do i = 1, taken
            from = ((i - 1)*size(p))/taken + 1
            to = (i*size(p))/taken
            call random%next(deviate)
            chosen(i) = min(from + int(deviate*real(to - from + 1, wp)), to)
            do k = 1, i - 1
               drawn = drawn .and. abs(p(chosen(i)) - p(chosen(k))) > distinct*size_of_path
            end do
         end do
         if (drawn) return
      end do
   end subroutine draw

   !> A four-bar in the notation of psalm_path_fit. `turns`: its crank does, fully.
   subroutine timing_of(four_bar, path, mirrored, timing, turns)
      type(exact_linkage_t), intent(in) :: four_bar
      type(fitted_path_t), intent(in) :: path
      logical, intent(in) :: mirrored
      type(path_timing_t), intent(out) :: timing
      logical, intent(out) :: turns
      complex(wp) :: a, b, c, d, p, along
      real(wp) :: ground, crank, coupler, follower

      a = four_bar%a
      b = four_bar%b
      c = four_bar%c(1)
      d = four_bar%d(1)
      p = four_bar%p(1)
      if (mirrored) then
         a = conjg(a)
         b = conjg(b)
         c = conjg(c)
         d = conjg(d)
         p = conjg(p)
      end if
      ground = abs(b - a)
      crank = abs(c - a)
      coupler = abs(d - c)
      follower = abs(d - b)
      timing%g = ground/crank
      turns = abs(timing%g - 1.0_wp) > nearest_g
      if (.not. turns) return
      timing%sigma = (coupler + follower)/(ground + crank)
      timing%q = (coupler - follower)/(ground - crank)
      turns = timing%sigma > 1.0_wp .and. abs(timing%q) < 1.0_wp
      if (.not. turns) return
      timing%side = merge(1.0_wp, -1.0_wp, aimag(conjg(b - c)*(d - c)) > 0.0_wp)
      along = crank*(b - a)/ground
      timing%z0 = a/path%size - path%centre
      timing%w1 = along/path%size
      timing%w2 = (p - c)*along/(d - c)/path%size
      allocate (timing%t(path%n), source=0.0_wp)
   end subroutine timing_of

   !> The four-bar of a timing at its places.
   subroutine linkage_of(timing, path, mirrored, one)
      type(path_timing_t), intent(in) :: timing
      type(fitted_path_t), intent(in) :: path
      logical, intent(in) :: mirrored
      type(exact_linkage_t), intent(out) :: one
      complex(wp) :: e(path%n), v(path%n), z0

      call trace_coupler(timing, timing%t, e, v)
      z0 = timing%z0 + path%centre
      one%a = path%size*z0
      one%b = path%size*(z0 + timing%g*timing%w1)
      one%c = path%size*(z0 + timing%w1*e)
      one%d = path%size*(z0 + timing%w1*(e + v))
      one%p = path%size*(z0 + timing%w1*e + timing%w2*v)
      if (mirrored) then
         one%a = conjg(one%a)
         one%b = conjg(one%b)
         one%c = conjg(one%c)
         one%d = conjg(one%d)
         one%p = conjg(one%p)
      end if
      one%turn = (one%d - one%c)/(one%d(1) - one%c(1))
   end subroutine linkage_of
end module psalm_exact_subsets
