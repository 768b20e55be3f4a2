!> Desired points whose place, size and direction are free: the linkage has to trace a curve of their shape.
!>
!> With P(t) the output point and Q the desired points, in the complex plane, the errors are
!>
!>    f = u P + s - Q,
!>
!> u and s being those for which the weighted sum of their squares is least: the points are compared in their own size, so that a
!> linkage gains nothing by a small path. u and s follow from a linear problem; derivatives are those of the eliminated one
!> (Kaufman, A variable projection method, 1975): what a change of u and s can undo does not count. With free timing it does not
!> count either what a change of the inputs can undo: the two are eliminated together.
module psalm_similarity
   use psalm_kinds, only: wp, full_turn
   use psalm_linear, only: solve_positive
   use psalm_path_fit, only: square
   use psalm_timing_order, only: choose_inputs, never
   implicit none (type, external)
   private
   public :: similarity_t, fit_similarity, errors_of, take_out_similarity, time_similar

   integer, parameter :: freedoms = 4                 !! of a similarity
   integer, parameter :: phases = 8                   !! of the timing given, of a turn, that a timing is sought from
   integer, parameter :: most_rounds = 8              !! of it
   real(wp), parameter :: least_gain = 1.0e-3_wp      !! of a round, relative

   !> The points of the linkage are turned, enlarged and moved: u P + s.
   type :: similarity_t
      complex(wp) :: u = (1.0_wp, 0.0_wp), s = (0.0_wp, 0.0_wp)
   contains
      procedure :: placed
   end type similarity_t

contains

   !> The similarity that brings the actual points nearest to the desired ones. Points that are one are brought to their mean.
   pure subroutine fit_similarity(actual, desired, weight, similarity)
      complex(wp), intent(in) :: actual(:), desired(:) !! shape (positions)
      real(wp), intent(in) :: weight(:)
      type(similarity_t), intent(out) :: similarity
      complex(wp) :: centre, middle
      real(wp) :: extent, total

      total = sum(weight)
      centre = sum(weight*actual)/total
      middle = sum(weight*desired)/total
      extent = sum(weight*square(actual - centre))
      similarity%u = (0.0_wp, 0.0_wp)
      if (extent > tiny(extent)) similarity%u = sum(weight*conjg(actual - centre)*(desired - middle))/extent
      similarity%s = middle - similarity%u*centre
   end subroutine fit_similarity

   !> u P + s - Q.
   elemental complex(wp) function errors_of(similarity, actual, desired) result(error)
      type(similarity_t), intent(in) :: similarity
      complex(wp), intent(in) :: actual, desired

      error = similarity%u*actual + similarity%s - desired
   end function errors_of

   !> Where the desired points are in the coordinates of the linkage.
   elemental complex(wp) function placed(self, desired)
      class(similarity_t), intent(in) :: self
      complex(wp), intent(in) :: desired

      placed = desired
      if (square(self%u) > 0.0_wp) placed = (desired - self%s)/self%u
   end function placed

   !> Take out of errors and of their derivatives what a change of u and s undoes. `tangent` are the derivatives by the input of
   !> each position: what is along them counts nothing, for the inputs are free; without it errors are at their least already.
   pure subroutine take_out_similarity(actual, weight, error, by, tangent)
      complex(wp), intent(in) :: actual(:)            !! shape (positions)
      real(wp), intent(in) :: weight(:)
      complex(wp), intent(inout) :: error(:), by(:, :) !! shapes (positions), (positions, unknowns)
      complex(wp), intent(in), optional :: tangent(:)
      complex(wp) :: ways(size(actual), freedoms), bare(size(actual), freedoms)
      real(wp) :: matrix(freedoms, freedoms), unit(freedoms)
      integer :: a, b

      ways(:, 1) = actual - sum(weight*actual)/sum(weight)
      ways(:, 2) = (0.0_wp, 1.0_wp)*ways(:, 1)
      ways(:, 3) = (1.0_wp, 0.0_wp)
      ways(:, 4) = (0.0_wp, 1.0_wp)
      bare = ways
      if (present(tangent)) then
         do a = 1, freedoms
            bare(:, a) = across(ways(:, a), tangent)
         end do
      end if
      do a = 1, freedoms
         do b = 1, freedoms
            matrix(a, b) = weighted_product(bare(:, a), bare(:, b), weight)
         end do
      end do
      ! the unknowns in units of their own: a point and a length differ by orders
      do a = 1, freedoms
         unit(a) = sqrt(max(matrix(a, a), tiny(1.0_wp)**0.25_wp))
      end do
      do b = 1, freedoms
         matrix(:, b) = matrix(:, b)/(unit*unit(b))
         matrix(b, b) = matrix(b, b) + epsilon(1.0_wp)
      end do
      if (present(tangent)) call take_out(error)
      do a = 1, size(by, 2)
         call take_out(by(:, a))
      end do

   contains

      pure subroutine take_out(column)
         complex(wp), intent(inout) :: column(:)
         real(wp) :: work(freedoms, freedoms), right(freedoms), part(freedoms)
         logical :: valid
         integer :: k

         do k = 1, freedoms
            right(k) = weighted_product(bare(:, k), column, weight)/unit(k)
         end do
         work = matrix
         call solve_positive(work, right, part, valid)
         if (.not. valid) return
         do k = 1, freedoms
            column = column - (part(k)/unit(k))*ways(:, k)
         end do
      end subroutine take_out
   end subroutine take_out_similarity

   !> What of it is across the tangent.
   elemental complex(wp) function across(line, tangent)
      complex(wp), intent(in) :: line, tangent

      across = line
      if (square(tangent) > tiny(1.0_wp)) across = line - tangent*(line%re*tangent%re + line%im*tangent%im)/square(tangent)
   end function across

   pure real(wp) function weighted_product(a, b, weight)
      complex(wp), intent(in) :: a(:), b(:)
      real(wp), intent(in) :: weight(:)

      weighted_product = sum(weight*(a%re*b%re + a%im*b%im))
   end function weighted_product

   !> Free timing of a shape: the inputs of a path at which it comes nearest to the desired points, wherever they lie. From the
   !> timing given, shifted by parts of a turn, place and timing are found in turns.
   pure subroutine time_similar(path, known, inputs, desired, weight, turns, ordered, sense, delt, cost, best)
      complex(wp), intent(in) :: path(:)              !! shape (steps): the output point
      logical, intent(in) :: known(:)                 !! shape (steps): the linkage comes there
      real(wp), intent(in) :: inputs(:)               !! shape (steps)
      complex(wp), intent(in) :: desired(:)           !! shape (positions)
      real(wp), intent(in) :: weight(:)
      logical, intent(in) :: turns, ordered           !! the last step is followed by the first; the inputs go one way
      real(wp), intent(in) :: sense                   !! of the order
      real(wp), intent(inout) :: delt(:)              !! shape (positions)
      real(wp), intent(out) :: cost(:, :)             !! shape (steps, positions): to work in
      real(wp), intent(out) :: best                   !! what the timing costs
      real(wp) :: trial(size(delt)), given(size(delt)), total, before
      type(similarity_t) :: similarity
      integer :: phase, round, at(size(delt)), i

      best = huge(best)
      given = delt
      do phase = 0, merge(phases - 1, 0, turns)
         trial = given + sense*full_turn*(real(phase, wp)/real(phases, wp))
         before = huge(before)
         do round = 1, most_rounds
            do i = 1, size(trial)
               at(i) = nearest_step(inputs, trial(i), turns)
            end do
            if (.not. all(known(at))) exit
            call fit_similarity(path(at), desired, weight, similarity)
            do i = 1, size(trial)
               cost(:, i) = weight(i)*square(errors_of(similarity, path, desired(i)))
               where (.not. known) cost(:, i) = cost(:, i) + never
            end do
            call choose_inputs(inputs, cost, turns, ordered, sense, trial, total)
            if (total < best) then
               best = total
               delt = trial
            end if
            if (total > (1.0_wp - least_gain)*before) exit
            before = total
         end do
      end do
   end subroutine time_similar

   !> The step of a path nearest to an input.
   pure integer function nearest_step(inputs, input, turns) result(step)
      real(wp), intent(in) :: inputs(:), input
      logical, intent(in) :: turns
      real(wp) :: away

      away = (input - inputs(1))/(inputs(2) - inputs(1))
      if (turns) then
         step = 1 + modulo(nint(away), size(inputs))
      else
         step = min(max(1 + nint(away), 1), size(inputs))
      end if
   end function nearest_step
end module psalm_similarity
