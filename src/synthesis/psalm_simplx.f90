!> SIMPLX: the constrained simplex search of the thesis.
!>
!> Nelder and Mead's simplex with the unlimited expansion and translation of Parkinson and Hutchinson; every vertex passes
!> through CONSTR. Source: Oldham (1977), section 6.4.3, equations 6.17 to 6.24.
module psalm_simplx
   use psalm_constr, only: constraints_t, constrain
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_stop, only: stop_t
   use psalm_kinds, only: wp
   use psalm_start, only: simplex_t
   use psalm_text, only: text_t, general, to_text
   implicit none (type, external)
   private
   public :: search_monitor_t, search_state_t, search_simplex
   public :: stop_iterations, stop_small_objective, stop_converged, stop_interrupted

   integer, parameter :: stop_iterations = 1       !! NITER was passed
   integer, parameter :: stop_small_objective = 2  !! best objective below FMIN
   integer, parameter :: stop_converged = 3        !! simplex has shrunk to a point
   integer, parameter :: stop_interrupted = 4      !! a signal came

   integer, parameter :: most_expansions = 200     !! of one move: a factor of EXPAND**200 is no linkage any more

   !> Where the search stands.
   type :: search_state_t
      integer :: iteration = 0
      integer :: limit = 0              !! NITER
      integer :: evaluations = 0
      real(wp) :: best = 0.0_wp, worst = 0.0_wp
      integer :: reason = 0             !! one of `stop_...` when the search is over
   end type search_state_t

   !> Watches a search; a program extends it to show progress.
   type, abstract :: search_monitor_t
   contains
      procedure(report), deferred :: report
   end type search_monitor_t

   abstract interface
      !> Called after every iteration.
      subroutine report(self, state)
         import :: search_monitor_t, search_state_t
         implicit none (type, external)
         class(search_monitor_t), intent(inout) :: self
         type(search_state_t), intent(in) :: state
      end subroutine report
   end interface

contains

   !> Improve the simplex until one of the criteria of convergence is met. On return `simplex%best` is the result.
   subroutine search_simplex(set, problem, constraints, simplex, interrupt, state, device1, monitor)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(constraints_t), intent(inout) :: constraints
      type(simplex_t), intent(inout) :: simplex
      type(stop_t), intent(in) :: interrupt       !! asked after every iteration
      type(search_state_t), intent(out) :: state
      type(text_t), intent(inout) :: device1
      class(search_monitor_t), intent(inout), optional :: monitor
      integer :: worst, calls_before

      state%limit = set%niter
      do
         worst = maxloc(simplex%f, dim=1)
         simplex%best = minloc(simplex%f, dim=1)
         state%best = simplex%f(simplex%best)
         state%worst = simplex%f(worst)
         state%evaluations = simplex%evaluations
         call note_progress(set, state, simplex, worst, device1)
         if (present(monitor)) call monitor%report(state)
         if (mod(state%iteration, set%ncheck) == 0) then
            if (state%best < set%fmin) then
               state%reason = stop_small_objective
            else if (has_converged(simplex, worst, set%small)) then
               state%reason = stop_converged
            end if
         end if
         if (state%reason == 0 .and. state%iteration >= set%niter) state%reason = stop_iterations
         if (state%reason == 0) then
            if (interrupt%waiting()) state%reason = stop_interrupted
         end if
         if (state%reason /= 0) return
         state%iteration = state%iteration + 1
         calls_before = simplex%repairs%calls
         call iterate(set, problem, constraints, simplex)
         if (simplex%repairs%calls - calls_before > set%nviol) then
            call device1%add(' ITERATION '//to_text(state%iteration)//'  VIOLATIONS '// &
                             to_text(simplex%repairs%calls - calls_before)//'  LAST IN LOOP '//to_text(simplex%repairs%loop))
         end if
      end do
   end subroutine search_simplex

   !> One iteration: reflection, then expansion and translation, contraction or shrinkage.
   subroutine iterate(set, problem, constraints, simplex)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(constraints_t), intent(inout) :: constraints
      type(simplex_t), intent(inout) :: simplex
      real(wp) :: centroid(size(simplex%v, 1)), trial(size(simplex%v, 1)), lowest(size(simplex%v, 1))
      real(wp) :: f_trial, f_lowest, f_second
      integer :: worst, i, n
      logical :: feasible

      n = size(simplex%f)
      worst = maxloc(simplex%f, dim=1)
      simplex%best = minloc(simplex%f, dim=1)
      f_second = maxval(simplex%f, mask=[(i /= worst, i=1, n)])
      centroid = (sum(simplex%v, dim=2) - simplex%v(:, worst))/real(n - 1, wp)
      trial = set%bounce*centroid + (1.0_wp - set%bounce)*simplex%v(:, worst)
      call settle(trial, f_trial)
      if (f_trial < simplex%f(simplex%best)) then
         lowest = trial
         f_lowest = f_trial
         do i = 1, most_expansions
            trial = set%expand*lowest + (1.0_wp - set%expand)*centroid
            call constrain(problem, constraints, trial, f_trial, feasible, simplex%evaluations, simplex%repairs)
            if (.not. feasible) exit
            if (f_trial >= f_lowest) exit
            lowest = trial
            f_lowest = f_trial
         end do
         if (f_lowest > set%snake*simplex%f(simplex%best)) then
            call replace(lowest, f_lowest)
         else
            call translate()
         end if
      else if (f_trial < f_second) then
         call replace(trial, f_trial)
      else
         if (f_trial < simplex%f(worst)) then
            trial = (1.0_wp - set%reduce)*centroid + set%reduce*trial
         else
            trial = (1.0_wp - set%reduce)*centroid + set%reduce*simplex%v(:, worst)
         end if
         call settle(trial, f_trial)
         if (f_trial < simplex%f(worst)) then
            call replace(trial, f_trial)
         else
            call shrink()
         end if
      end if
      simplex%best = minloc(simplex%f, dim=1)

   contains

      !> The linkage a conflicting vertex moves towards: the centroid if it is feasible, else the best vertex.
      function safe_haven() result(place)
         real(wp) :: place(size(centroid))
         real(wp) :: f
         integer :: loop

         place = centroid
         call problem%topology%apply(place, constraints%dimensions)
         call problem%evaluate(constraints%dimensions, f, loop)
         simplex%evaluations = simplex%evaluations + 1
         if (loop /= 0 .or. out_of_bounds(place)) place = simplex%v(:, simplex%best)
      end function safe_haven

      pure logical function out_of_bounds(values)
         real(wp), intent(in) :: values(:)

         out_of_bounds = .false.
         if (constraints%bounded) out_of_bounds = any(values < constraints%low .or. values > constraints%high)
      end function out_of_bounds

      !> Constrain a vertex; where its demands conflict it moves towards `towards`, or else towards a safe haven.
      subroutine settle(values, f, towards)
         real(wp), intent(inout) :: values(:)
         real(wp), intent(out) :: f
         real(wp), intent(in), optional :: towards(:)
         logical :: reached

         if (present(towards)) then
            call constrain(problem, constraints, values, f, reached, simplex%evaluations, simplex%repairs, towards)
         else
            call constrain(problem, constraints, values, f, reached, simplex%evaluations, simplex%repairs)
            if (.not. reached) call constrain(problem, constraints, values, f, reached, simplex%evaluations, &
                                              simplex%repairs, safe_haven())
         end if
         if (.not. reached) f = huge(f)
      end subroutine settle

      subroutine replace(values, f)
         real(wp), intent(in) :: values(:), f

         simplex%v(:, worst) = values
         simplex%f(worst) = f
      end subroutine replace

      !> The whole simplex makes the move of its worst vertex.
      subroutine translate()
         real(wp) :: move(size(centroid))
         integer :: k

         move = lowest - simplex%v(:, worst)
         do k = 1, n
            if (k == worst) cycle
            simplex%v(:, k) = simplex%v(:, k) + move
            call settle(simplex%v(:, k), simplex%f(k), lowest)
         end do
         call replace(lowest, f_lowest)
      end subroutine translate

      !> All vertices draw near the best.
      subroutine shrink()
         integer :: k

         do k = 1, n
            if (k == simplex%best) cycle
            simplex%v(:, k) = set%shrink*simplex%v(:, k) + (1.0_wp - set%shrink)*simplex%v(:, simplex%best)
            call settle(simplex%v(:, k), simplex%f(k), simplex%v(:, simplex%best))
         end do
      end subroutine shrink
   end subroutine iterate

   !> Criterion (iii): objectives and coordinates of the worst and the best vertex agree.
   pure logical function has_converged(simplex, worst, small)
      type(simplex_t), intent(in) :: simplex
      integer, intent(in) :: worst
      real(wp), intent(in) :: small

      associate (b => simplex%v(:, simplex%best), w => simplex%v(:, worst), f => simplex%f)
         has_converged = f(worst) - f(simplex%best) <= small*f(simplex%best)
         if (has_converged) has_converged = all(abs(w - b) <= small*abs(b) .or. abs(b) <= small)
      end associate
   end function has_converged

   !> Progress to device 1: objectives every NPRT iterations, coordinates every NPRINT.
   subroutine note_progress(set, state, simplex, worst, device1)
      type(data_set_t), intent(in) :: set
      type(search_state_t), intent(in) :: state
      type(simplex_t), intent(in) :: simplex
      integer, intent(in) :: worst
      type(text_t), intent(inout) :: device1
      character(:), allocatable :: line
      integer :: i, vertex, which

      if (mod(state%iteration, set%nprt) == 0) then
         call device1%add(' ITERATION '//to_text(state%iteration)//'  BEST'//general(state%best)//'  WORST'// &
                          general(state%worst)//'  EVALUATIONS '//to_text(state%evaluations)//'  REPAIRS '// &
                          to_text(simplex%repairs%repairs)//'  MOVES '//to_text(simplex%repairs%moves))
      end if
      if (mod(state%iteration, set%nprint) /= 0 .or. state%iteration == 0) return
      do which = 1, 2
         vertex = merge(simplex%best, worst, which == 1)
         call device1%add(trim(merge(' CO-ORDINATES OF THE BEST VERTEX ', ' CO-ORDINATES OF THE WORST VERTEX', which == 1)))
         do i = 1, size(simplex%v, 1), 5
            line = '     '
            associate (row => simplex%v(i:min(i + 4, size(simplex%v, 1)), vertex))
               call add_row(row, line)
            end associate
            call device1%add(line)
         end do
      end do
   end subroutine note_progress

   pure subroutine add_row(values, line)
      real(wp), intent(in) :: values(:)
      character(:), allocatable, intent(inout) :: line
      integer :: i

      do i = 1, size(values)
         line = line//general(values(i))
      end do
   end subroutine add_row
end module psalm_simplx
