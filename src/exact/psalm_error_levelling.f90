!> Parameters with the least largest error over a range, by exchange (Remez).
!>
!> With n parameters the error of a best approximation alternates at n + 1 places, which is a local optimum. Newton's method makes
!> the errors there equal; where so many alternations are not found, linear programs in a region of trust go on. Sources: Remez
!> (1934); Osborne and Watson (1969) for the linear programs.
module psalm_error_levelling
   use psalm_conic, only: conic_t, conic_solution_t, solve_conic
   use psalm_dense, only: factors_t, factorise, solve
   use psalm_kinds, only: wp
   use psalm_linear, only: along_columns
   implicit none (type, external)
   private
   public :: error_family_t, level_errors, hopeless

   integer, parameter :: coarse = 201, fine = 2001   !! points at which the error is looked at
   integer, parameter :: most_exchanges = 40, most_halvings = 30
   real(wp), parameter :: wanted_level = 1.0e-9_wp   !! relative excess of the largest error over the levelled one
   real(wp), parameter :: worth_it = 1.0e-5_wp       !! relative gain of a linear program that goes on
   real(wp), parameter :: good_gain = 0.75_wp        !! of what a linear program promises, that lets the region grow
   real(wp), parameter :: first_trust = 0.2_wp, last_trust = 1.0e-7_wp
   real(wp), parameter :: hopeless = 40.0_wp         !! error of a start, degrees or per cent of the travel, that is not followed

   !> What is approximated: an error over places from 0 to 1 that depends on parameters.
   type, abstract :: error_family_t
      real(wp), allocatable :: entries(:)            !! the places that count, rising; not allocated: all
      !> How often a step of a linear program is corrected by the errors that it led to: in a bent valley steps that are not
      !> corrected must be short.
      integer :: corrections = 0
      integer :: in_program = 61                     !! points of a linear program
   contains
      procedure :: look_at
      procedure(errors_of), deferred :: errors
      procedure(is_out), deferred :: runs_away
   end type error_family_t

   abstract interface
      !> Errors at places that rise: degrees or per cent; `huge` where there is none.
      pure subroutine errors_of(self, q, at, error, slopes)
         import :: error_family_t, wp
         implicit none (type, external)
         class(error_family_t), intent(in) :: self
         real(wp), intent(in) :: q(:), at(:)
         real(wp), intent(out) :: error(:)           !! shape (places)
         real(wp), intent(out), optional :: slopes(:, :) !! by the parameters, shape (parameters, places)
      end subroutine errors_of

      !> True for parameters from which the search does not go on; a linear program that is corrected does not go there.
      pure logical function is_out(self, q)
         import :: error_family_t, wp
         implicit none (type, external)
         class(error_family_t), intent(in) :: self
         real(wp), intent(in) :: q(:)
      end function is_out
   end interface

contains

   !> Only these places count.
   pure subroutine look_at(self, entries)
      class(error_family_t), intent(inout) :: self
      real(wp), intent(in) :: entries(:)

      self%entries = entries
   end subroutine look_at

   !> From a start to the nearest optimum. A start that is further off than `hopeless` stays as it is.
   subroutine level_errors(family, programs, q, largest, at, levelled)
      class(error_family_t), intent(in) :: family
      integer, intent(in) :: programs                !! linear programs at most
      real(wp), intent(inout) :: q(:)
      real(wp), intent(out) :: largest               !! error over the range
      real(wp), intent(out) :: at(:)                 !! where it is reached, shape (parameters + 1)
      logical, intent(out) :: levelled               !! it alternates there
      real(wp) :: trust
      logical :: gained
      integer :: round

      at = 0.0_wp
      levelled = .false.
      call error_over(family, q, coarse, largest)
      if (largest > hopeless) return
      trust = first_trust
      do round = 0, programs
         call exchange(family, coarse, q, largest, at, levelled)
         if (levelled .or. family%runs_away(q)) exit
         if (round == programs) exit
         call linear_program(family, q, largest, trust, gained)
         if (.not. gained) exit
      end do
      if (levelled .and. .not. allocated(family%entries)) call exchange(family, fine, q, largest, at, levelled)
   end subroutine level_errors

   !> Places at which the error is looked at.
   pure function places(family, points) result(at)
      class(error_family_t), intent(in) :: family
      integer, intent(in) :: points
      real(wp), allocatable :: at(:)
      integer :: i

      if (allocated(family%entries)) then
         at = family%entries
      else
         at = [(real(i - 1, wp)/real(points - 1, wp), i=1, points)]
      end if
   end function places

   !> Largest error over the range.
   pure subroutine error_over(family, q, points, largest)
      class(error_family_t), intent(in) :: family
      real(wp), intent(in) :: q(:)
      integer, intent(in) :: points
      real(wp), intent(out) :: largest
      real(wp), allocatable :: at(:), error(:)

      at = places(family, points)
      allocate (error(size(at)))
      call family%errors(q, at, error)
      largest = maxval(abs(error))
   end subroutine error_over

   !> The largest error of each run of one sign, refined by a parabola; of these as many in a row as alternate whose smallest is
   !> largest.
   pure subroutine extremes(family, q, points, at, sides, largest, enough)
      class(error_family_t), intent(in) :: family
      real(wp), intent(in) :: q(:)
      integer, intent(in) :: points
      real(wp), intent(out) :: at(:), sides(:), largest
      logical, intent(out) :: enough
      real(wp), allocatable :: place(:), error(:), peak(:), peak_at(:)
      integer :: n, i, runs, best, k, alternations

      alternations = size(at)
      place = places(family, points)
      n = size(place)
      allocate (error(n), peak(n), peak_at(n))
      call family%errors(q, place, error)
      largest = maxval(abs(error))
      enough = .false.
      at = 0.0_wp
      sides = 0.0_wp
      if (largest > hopeless) return
      runs = 0
      best = 0
      do i = 1, n
         if (runs > 0) then
            if (error(i)*peak(runs) > 0.0_wp) then
               if (abs(error(i)) > abs(error(best))) then
                  best = i
                  peak(runs) = error(i)
               end if
               cycle
            end if
            call refine(best, peak(runs), peak_at(runs))
         end if
         runs = runs + 1
         best = i
         peak(runs) = error(i)
      end do
      call refine(best, peak(runs), peak_at(runs))
      largest = max(largest, maxval(abs(peak(:runs))))
      enough = runs >= alternations
      if (.not. enough) return
      k = 1
      do i = 2, runs - alternations + 1
         if (minval(abs(peak(i:i + alternations - 1))) > minval(abs(peak(k:k + alternations - 1)))) k = i
      end do
      at = peak_at(k:k + alternations - 1)
      sides = sign(1.0_wp, peak(k:k + alternations - 1))

   contains

      !> The peak of a run at sample i.
      pure subroutine refine(i, own_peak, own_place)
         integer, intent(in) :: i
         real(wp), intent(out) :: own_peak, own_place
         real(wp) :: bend, slope, value(1)

         own_peak = error(i)
         own_place = place(i)
         if (allocated(family%entries) .or. i == 1 .or. i == n) return
         bend = error(i + 1) - 2.0_wp*error(i) + error(i - 1)
         slope = 0.5_wp*(error(i + 1) - error(i - 1))
         if (.not. abs(bend) > abs(slope)) return
         own_place = place(i) - slope/bend/real(n - 1, wp)
         call family%errors(q, [own_place], value)
         if (abs(value(1)) > abs(error(i)) .and. value(1)*error(i) > 0.0_wp) then
            own_peak = value(1)
         else
            own_place = place(i)
         end if
      end subroutine refine
   end subroutine extremes

   !> Newton's method on equal errors of alternating sign, with extremes found anew for each step.
   subroutine exchange(family, points, q, largest, at, levelled)
      class(error_family_t), intent(in) :: family
      integer, intent(in) :: points
      real(wp), intent(inout) :: q(:)
      real(wp), intent(out) :: largest, at(:)
      logical, intent(out) :: levelled
      real(wp) :: m(size(at), size(at)), right(size(at)), step(size(at)), sides(size(at)), part, trial_largest
      real(wp) :: trial(size(q)), error(size(at)), slopes(size(q), size(at))
      type(factors_t) :: factors
      logical :: enough
      integer :: round, halving

      levelled = .false.
      do round = 1, most_exchanges
         call extremes(family, q, points, at, sides, largest, enough)
         if (.not. enough) return
         call family%errors(q, at, error, slopes)
         m(:, :size(q)) = transpose(slopes)
         levelled = largest - minval(abs(error)) < wanted_level*largest
         if (levelled) return
         m(:, size(at)) = -sides
         right = -error
         call factorise(m, factors)
         if (factors%reciprocal_condition < epsilon(1.0_wp)) return
         step = solve(factors, right)
         part = 1.0_wp
         do halving = 0, most_halvings
            trial = q + part*step(:size(q))
            call extremes(family, trial, points, at, sides, trial_largest, enough)
            if (trial_largest < largest) exit
            part = 0.5_wp*part
         end do
         if (halving > most_halvings) then
            ! no lower one within rounding: levelled as far as numbers go
            call extremes(family, q, points, at, sides, largest, enough)
            levelled = enough .and. largest - minval(abs(error)) < sqrt(wanted_level)*largest
            return
         end if
         q = trial
         largest = trial_largest
      end do
   end subroutine exchange

   !> One step of least largest error of the linearised errors within a region of trust.
   subroutine linear_program(family, q, largest, trust, gained)
      class(error_family_t), intent(in) :: family
      real(wp), intent(inout) :: q(:), largest, trust
      logical, intent(out) :: gained
      real(wp), allocatable :: at(:), error(:), slopes(:, :)
      type(conic_t) :: program
      type(conic_solution_t) :: solution
      real(wp), allocatable :: model(:), found(:)
      real(wp) :: trial(size(q)), best(size(q)), step(size(q)), reached, nearest, promised, scale(size(q)), slope(size(q))
      integer :: n, i, j, unknowns, turn

      gained = .false.
      unknowns = size(q)
      at = places(family, family%in_program)
      n = size(at)
      allocate (error(n), found(n), slopes(unknowns, n))
      call error_over(family, q, coarse, largest)
      scale = max(abs(q), 0.1_wp)
      allocate (program%q(unknowns + 1), program%g(2*n + 2*unknowns, unknowns + 1), program%h(2*n + 2*unknowns), source=0.0_wp)
      allocate (program%cones(0))
      program%lines = 2*n + 2*unknowns
      ! unknowns: steps over their region, and the level over the largest error
      program%q(unknowns + 1) = 1.0_wp
      call family%errors(q, at, error, slopes)
      do while (trust > last_trust)
         do i = 1, n
            slope = slopes(:, i)*scale*trust/largest
            program%g(2*i - 1, :) = [slope, -1.0_wp]
            program%g(2*i, :) = [-slope, -1.0_wp]
         end do
         do j = 1, unknowns
            program%g(2*n + 2*j - 1, j) = 1.0_wp
            program%g(2*n + 2*j, j) = -1.0_wp
         end do
         program%h(2*n + 1:) = 1.0_wp
         model = error
         nearest = huge(1.0_wp)
         promised = 0.0_wp
         do turn = 0, family%corrections
            program%h(1:2*n:2) = -model/largest
            program%h(2:2*n:2) = model/largest
            call solve_conic(program, solution)
            if (.not. solution%solved) exit
            step = trust*scale*solution%x(:unknowns)
            trial = q + step
            call error_over(family, trial, coarse, reached)
            if (family%corrections > 0) then
               if (family%runs_away(trial)) reached = huge(1.0_wp)
            end if
            if (turn == 0) promised = largest*(1.0_wp - solution%x(unknowns + 1))
            if (promised < worth_it*largest) return
            if (.not. reached < nearest) exit
            nearest = reached
            best = trial
            if (turn == family%corrections .or. largest - nearest > good_gain*promised) exit
            call family%errors(trial, at, found)
            if (maxval(abs(found)) > hopeless) exit
            model = found - along_columns(slopes, step)
         end do
         if (.not. solution%solved .and. turn == 0 .and. family%corrections == 0) return
         associate (gain => largest - nearest)
            if (gain > 0.0_wp) then
               if (gain > good_gain*promised) trust = min(2.0_wp*trust, 1.0_wp)
               q = best
               gained = gain > worth_it*largest
               largest = nearest
               return
            end if
         end associate
         trust = 0.25_wp*trust
      end do
   end subroutine linear_program
end module psalm_error_levelling
