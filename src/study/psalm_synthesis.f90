!> The search for better dimensions, by the simplex of the thesis or from many starts, and what came of it.
!>
!> Data in, results out: nothing is printed or worded here. An observer may watch the search.
module psalm_synthesis
   use psalm_constr, only: without_rates
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t, desired_of
   use psalm_kinds, only: wp
   use psalm_margins, only: inspector_t, prepare_inspector
   use psalm_ranking, only: ranked_t, rate_linkage, figure_of, least_sensitive_first, unbeaten
   use psalm_search, only: found_t, result_t, search_many, place_desired
   use psalm_search_group, only: pareto_none, ranking_none
   use psalm_similarity, only: similarity_t, fit_similarity
   use psalm_simplex_search, only: simplex_run_t, run_simplex, run_simplexes, wants_several
   use psalm_simplx, only: simplex_t
   use psalm_solver, only: observer_t, search_state_t, stop_iterations, stop_small_objective, stop_interrupted
   use psalm_stop, only: stop_t
   use psalm_dimensions, only: dimensions_t
   implicit none (type, external)
   private
   public :: synthesis_t, synthesise
   public :: ended_unmade, ended_infeasible, ended_converged, ended_small_objective, ended_iterations, ended_starts, ended_time, &
             ended_on_request, ended_refused, ended_without_rates

   ! how a search ended
   integer, parameter :: ended_unmade = 0          !! nothing varies: there was no search
   integer, parameter :: ended_infeasible = 1      !! simplex; the given linkage violates the constraints and cannot be repaired;
                                                   !! many starts: none led to a linkage that obeys them
   integer, parameter :: ended_converged = 2       !! the simplex has shrunk to a point
   integer, parameter :: ended_small_objective = 3 !! the objective is below FMIN
   integer, parameter :: ended_iterations = 4      !! NITER iterations were made
   integer, parameter :: ended_starts = 5          !! all starts were made
   integer, parameter :: ended_time = 6            !! MAXTIME passed
   integer, parameter :: ended_on_request = 7      !! the host asked for the end
   integer, parameter :: ended_refused = 8         !! NLopt refuses the algorithm for this problem
   integer, parameter :: ended_without_rates = 9   !! simplex; a derivative that is wanted is infinite with every linkage tried

   !> A sketch drawn anew, without loops.
   type :: drawn_case_t
      class(data_set_t), allocatable :: set
   end type drawn_case_t

   !> Results of a search.
   type :: synthesis_t
      integer :: ending = ended_unmade           !! one of `ended_...`
      logical :: many = .false.                  !! from many starts, or several linkages wanted of the simplex; else one simplex
      ! the simplex; of several the one that led to the best linkage
      type(simplex_t) :: first, last             !! the initial simplex, the final one
      type(search_state_t) :: state              !! iterations, evaluations, best objective
      type(simplex_run_t), allocatable :: simplexes(:) !! all that were begun
      ! many starts
      type(result_t) :: found                    !! linkages, best first; counts
      type(ranked_t), allocatable :: ranked(:)   !! by linkage found
      type(drawn_case_t), allocatable :: drawn(:) !! the linkages found, if the search was made in the poses of the links
   contains
      procedure :: is_short
   end type synthesis_t

contains

   !> Search from the given linkage and, if the solver is another than the simplex, from many more.
   !>
   !> `dimensions` becomes the best linkage found and stays what it was if none was; with free timing the inputs of `problem`
   !> become those of the best.
   subroutine synthesise(set, vertices, problem, threads, stop, dimensions, result, observer, found)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: vertices(:, :)       !! shape (nvar, any): supplied
      type(problem_t), intent(inout), target :: problem
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop             !! asked now and then
      type(dimensions_t), intent(inout) :: dimensions
      type(synthesis_t), intent(out) :: result
      class(observer_t), intent(inout), optional :: observer
      type(result_t), intent(in), optional :: found !! what many starts led to, if they were made before

      allocate (result%found%best(0))
      allocate (result%ranked(0), result%simplexes(0))
      if (.not. problem%parameters%has_search()) return
      if (.not. set%search%solver%many_starts) then
         call search_with_simplex(set, vertices, problem, stop, dimensions, result, observer)
      else
         call search_from_starts(set, vertices, problem, threads, stop, dimensions, result, observer, found)
      end if
   end subroutine synthesise

   subroutine search_with_simplex(set, vertices, problem, stop, dimensions, result, observer)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: vertices(:, :)
      type(problem_t), intent(inout), target :: problem
      type(stop_t), intent(in) :: stop
      type(dimensions_t), intent(inout) :: dimensions
      type(synthesis_t), intent(inout) :: result
      class(observer_t), intent(inout), optional :: observer
      type(stop_t) :: limited
      integer :: i

      limited = stop
      call limited%limit_time(set%search%maxtime)
      if (wants_several(set)) then
         result%many = .true.
         deallocate (result%found%best, result%simplexes)
         call run_simplexes(set, vertices, problem, limited, result%simplexes, result%found, observer)
         if (size(result%found%best) == 0) then
            result%ending = ended_infeasible
            if (any(result%simplexes%feasible)) result%ending = ended_without_rates
            return
         end if
         i = findloc(result%simplexes%number, result%found%best(1)%start, dim=1)
         result%ending = ending_of(result%simplexes(i), limited)
         call take(result%simplexes(i))
         if (result%ending /= ended_iterations) result%ending = ended_starts
         if (result%found%out_of_time) result%ending = ended_time
         if (result%found%interrupted) result%ending = ended_on_request
         call look_at_found(set, problem, result)
         call problem%parameters%apply(result%found%best(1)%values, dimensions)
      else
         deallocate (result%simplexes)
         allocate (result%simplexes(1))
         result%simplexes%integer = set%method%istart
         call run_simplex(set, vertices, problem, limited, result%simplexes(1), observer)
         result%ending = ending_of(result%simplexes(1), limited)
         call take(result%simplexes(1))
         if (result%ending == ended_infeasible) return
         call problem%parameters%apply(result%last%v(:, result%last%best), dimensions)
      end if

   contains

      subroutine take(run)
         type(simplex_run_t), intent(in) :: run

         result%first = run%first
         result%last = run%last
         result%state = run%state
      end subroutine take
   end subroutine search_with_simplex

   !> How a simplex ended.
   integer function ending_of(run, stop) result(ending)
      type(simplex_run_t), intent(in) :: run
      type(stop_t), intent(in) :: stop             !! that it asked

      ending = ended_infeasible
      if (.not. run%feasible) return
      ending = ended_without_rates
      if (run%last%f(run%last%best) >= without_rates) return
      select case (run%state%reason)
      case (stop_iterations)
         ending = ended_iterations
      case (stop_small_objective)
         ending = ended_small_objective
      case (stop_interrupted)
         ending = merge(ended_time, ended_on_request, stop%late())
      case default
         ending = ended_converged
      end select
   end function ending_of

   subroutine search_from_starts(set, vertices, problem, threads, stop, dimensions, result, observer, before)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: vertices(:, :)
      type(problem_t), intent(inout), target :: problem
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      type(dimensions_t), intent(inout) :: dimensions
      type(synthesis_t), intent(inout) :: result
      class(observer_t), intent(inout), optional :: observer
      type(result_t), intent(in), optional :: before

      result%many = .true.
      if (present(before)) then
         result%found = before
      else
         call search_many(set, problem, problem%parameters%first_values(dimensions), vertices, threads, stop, result%found, &
                          observer)
      end if
      associate (found => result%found)
         if (set%method%isim /= 0) call find_places(set, problem, found%best)
         if (size(found%best) > 0) then
            call problem%parameters%apply(found%best(1)%values, dimensions)
            if (set%method%ifree /= 0) call problem%move_inputs(found%best(1)%delt)
            call place_desired(found%best(1), problem)
         end if
         result%ending = ended_starts
         if (size(found%best) == 0) result%ending = ended_infeasible
         if (found%out_of_time) result%ending = ended_time
         if (found%refused) result%ending = ended_refused
         if (found%interrupted) result%ending = ended_on_request
      end associate
      call look_at_found(set, problem, result)
      if (set%search%nearly > 1.0_wp .and. size(result%found%best) > 0) then
         call problem%parameters%apply(result%found%best(1)%values, dimensions)
         if (set%method%ifree /= 0) call problem%move_inputs(result%found%best(1)%delt)
         call place_desired(result%found%best(1), problem)
      end if
   end subroutine search_from_starts

   !> Where the desired points, of any place, size and direction, lie for each linkage.
   subroutine find_places(set, problem, best)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(found_t), intent(inout) :: best(:)
      class(problem_t), allocatable :: each
      type(dimensions_t) :: dimensions
      type(motion_t) :: motion
      type(similarity_t) :: similarity
      real(wp), allocatable :: wanted(:, :), weight(:, :)
      complex(wp), allocatable :: points(:)
      integer :: i

      call desired_of(set, wanted, weight)
      allocate (each, source=problem)
      dimensions = problem%given
      do i = 1, size(best)
         call each%parameters%apply(best(i)%values, dimensions)
         call each%move_inputs(best(i)%delt)
         call each%analyse(dimensions, motion)
         points = cmplx(wanted(:, 1), wanted(:, 2), wp)
         call fit_similarity(cmplx(motion%actual(:, 1), motion%actual(:, 2), wp), points, weight(:, 1), similarity)
         points = similarity%placed(points)
         best(i)%desired = reshape([points%re, points%im], [size(points), 2])
      end do
   end subroutine find_places

   !> True if the search found nothing, or ended before it was done.
   pure logical function is_short(self)
      class(synthesis_t), intent(in) :: self

      is_short = self%ending /= ended_unmade .and. self%ending /= ended_converged .and. self%ending /= ended_small_objective &
                 .and. self%ending /= ended_starts
      if (self%many) is_short = is_short .or. size(self%found%best) == 0 .or. self%found%next > 0
   end function is_short

   !> What every linkage found is like; with PARETO those that are beaten are left out.
   subroutine look_at_found(set, problem, result)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(synthesis_t), intent(inout) :: result
      class(inspector_t), allocatable :: inspector
      class(problem_t), allocatable :: each
      integer, allocatable :: chosen(:)
      integer :: i

      if (size(result%found%best) == 0) return
      if (set%search%nbest == 1 .and. set%search%pareto == pareto_none .and. set%search%ranking == ranking_none) return
      deallocate (result%ranked)
      allocate (result%ranked(size(result%found%best)))
      allocate (inspector)
      call prepare_inspector(set, problem, set%search%solver%many_starts, inspector)
      allocate (each, source=problem)
      do i = 1, size(result%ranked)
         call rate_linkage(set, each, inspector, result%found%best(i), result%ranked(i))
      end do
      if (set%search%nearly > 1.0_wp) then
         chosen = least_sensitive_first(result%found%best%objective, result%ranked, set%search%nearly)
         result%ranked = result%ranked(chosen)
         result%found%best = result%found%best(chosen)
      end if
      if (set%search%pareto == pareto_none) return
      chosen = unbeaten([(figure_of(result%ranked(i), set%search%pareto), i=1, size(result%ranked))], set%search%nbest)
      result%ranked = result%ranked(chosen)
      result%found%best = result%found%best(chosen)
   end subroutine look_at_found
end module psalm_synthesis
