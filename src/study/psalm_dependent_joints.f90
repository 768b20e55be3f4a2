!> The coordinates of joints as polynomials of the stroke of the only drive: range that is proven, series, greatest error.
!>
!> The stroke runs from low to high; with t = (2 stroke - low - high)/(high - low) a coordinate is the sum of c(k) T(k, t) over k
!> from 0 on, T(k, cos a) = cos k a. The series of a function that is smooth within its range converges as a geometric one does; it
!> is cut where what is left out is small. Its coefficients are cosine transforms of values at Chebyshev's points.
module psalm_dependent_joints
   use psalm_angles, only: unit_vector
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, degrees_per_radian, full_turn
   use psalm_proof, only: piece_closes, proof_linkage_t
   use psalm_proof_study, only: proof_of_turn, proof_study_t, study_closure
   implicit none (type, external)
   private
   public :: dependence_t, polynomial_t, find_proven_range, chebyshev_points, even_points, fit_series

   integer, parameter :: nodes = 512                !! of the interpolation
   integer, parameter :: most_terms = 241           !! of a series
   integer, parameter :: tried = 2048               !! places at which the error is measured
   real(wp), parameter :: wanted = 1.0e-8_wp        !! error, radians or part of the size, with which a series is long enough
   real(wp), parameter :: aside = 0.02_wp           !! part of the range that it ends before a dead point, where rates are infinite

   !> A coordinate by the stroke.
   type :: polynomial_t
      integer :: joint = 0                          !! of the model
      real(wp) :: advance = 0.0_wp                  !! of a full turn of the drive, radians
      real(wp), allocatable :: coefficients(:)      !! from that of T(0) on, radians or m
      real(wp) :: error = 0.0_wp                    !! greatest that was found, radians or m
   end type polynomial_t

   !> How all coordinates follow the drive.
   type :: dependence_t
      real(wp) :: low = 0.0_wp, high = 0.0_wp       !! range of the stroke from where the model stands, radians or m
      logical :: whole_turn = .false.               !! proven over a full turn
      type(polynomial_t), allocatable :: joints(:)
   end type dependence_t

contains

   !> The range of the first drive that is proven to close: increments from its reference in degrees or user's length. A turn that
   !> closes everywhere is whole; ends at dead points lie before them. `low` equals `high` where nothing is proven.
   subroutine find_proven_range(set, problem, dimensions, at, low, high, whole)
      use psalm_chain_study, only: chain_study_t
      use psalm_chain_proof_study, only: chain_proof_t, prove_loops
      type(data_set_t), intent(in) :: set
      class(problem_t), intent(in) :: problem       !! of the positions of the case
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: at                    !! an increment within it; of a sketch with larger groups 0
      real(wp), intent(out) :: low, high
      logical, intent(out) :: whole
      logical :: ends(2)                            ! they are no ends of what was asked for

      low = 0.0_wp
      high = 0.0_wp
      whole = .false.
      ends = .false.
      if (set%is_beyond_arrays()) then
         call of_poses()
      else
         call of_dyads()
      end if
      if (whole) then
         low = at - 0.5_wp*full_turn
         high = at + 0.5_wp*full_turn
         return
      end if
      associate (width => high - low)
         ! but not beyond where the model stands
         if (ends(1) .and. low < at) low = min(low + aside*width, at)
         if (ends(2) .and. high > at) high = max(high - aside*width, at)
      end associate

   contains

      subroutine of_poses()
         class(chain_study_t), allocatable :: study
         class(chain_proof_t), allocatable :: proof
         real(wp) :: way
         logical :: valid
         integer :: k

         allocate (study, proof)
         call prove_loops(set, proof_of_turn, study, proof, valid)
         if (.not. valid) return
         if (proof%empty .or. proof%braced > 0 .or. .not. proof%one_drive) return
         whole = proof%full_turn .and. proof%complete .and. proof%returns
         if (whole) return
         do k = 1, size(proof%segments)
            associate (segment => proof%segments(k))
               way = segment%to(1)*segment%reached
               if (.not. problem%mechanism%sliding_input) way = way*degrees_per_radian
               if (way < low) ends(1) = .not. segment%complete
               if (way > high) ends(2) = .not. segment%complete
               low = min(low, way)
               high = max(high, way)
            end associate
         end do
      end subroutine of_poses

      subroutine of_dyads()
         class(proof_study_t), allocatable :: study
         class(proof_linkage_t), allocatable :: linkage
         real(wp) :: from, to
         integer :: k, last

         allocate (study, linkage)
         call study_closure(problem, dimensions, proof_of_turn, study, linkage)
         if (study%empty) return
         whole = study%full_turn .and. study%proof%closes_everywhere()
         if (whole) return
         associate (limits => study%proof%limits, proof => study%proof)
            last = size(limits)
            do k = 1, last
               if (limits(k)%kind /= piece_closes) cycle
               from = limits(k)%from - study%reference
               to = limits(k)%to - study%reference
               ends = [limits(k)%from > proof%from, limits(k)%to < proof%to]
               ! a part that goes on where the turn begins again
               if (study%full_turn .and. k == 1 .and. .not. ends(1) .and. limits(last)%kind == piece_closes) then
                  from = limits(last)%from - full_turn - study%reference
                  ends(1) = .true.
               else if (study%full_turn .and. k == last .and. .not. ends(2) .and. limits(1)%kind == piece_closes) then
                  to = limits(1)%to + full_turn - study%reference
                  ends(2) = .true.
               end if
               if (study%full_turn) then
                  do while (to < at)
                     from = from + full_turn
                     to = to + full_turn
                  end do
                  do while (from > at)
                     from = from - full_turn
                     to = to - full_turn
                  end do
               end if
               if (from > at .or. to < at) cycle
               low = from
               high = to
               return
            end do
         end associate
         ends = .false.
      end subroutine of_dyads
   end subroutine find_proven_range

   !> Chebyshev's points of a range, ascending.
   pure function chebyshev_points(low, high) result(points)
      real(wp), intent(in) :: low, high
      real(wp) :: points(nodes)
      real(wp) :: c, s
      integer :: i

      do i = 1, nodes
         call unit_vector(0.5_wp*full_turn*(real(nodes - i, wp) + 0.5_wp)/real(nodes, wp), c, s)
         points(i) = 0.5_wp*(low + high) + 0.5_wp*(high - low)*c
      end do
   end function chebyshev_points

   !> Places at which errors are measured, from end to end.
   pure function even_points(low, high) result(points)
      real(wp), intent(in) :: low, high
      real(wp) :: points(tried + 1)
      integer :: i

      points = [(low + (high - low)*real(i, wp)/real(tried, wp), i=0, tried)]
   end function even_points

   !> The series of a function by its values at Chebyshev's points, as long as the error at even places, whose values are given too,
   !> asks for, and that error.
   pure subroutine fit_series(at_nodes, at_even, size_of, coefficients, error)
      real(wp), intent(in) :: at_nodes(:), at_even(:)  !! shapes (nodes), (tried + 1)
      real(wp), intent(in) :: size_of                  !! what errors are parts of
      real(wp), allocatable, intent(out) :: coefficients(:)
      real(wp), intent(out) :: error
      real(wp) :: all_terms(0:most_terms - 1), left, unused
      real(wp), allocatable :: cosine(:)               ! of multiples of half the angle between nodes
      integer :: i, k, terms

      allocate (cosine(0:4*nodes - 1))
      do i = 0, 4*nodes - 1
         call unit_vector(0.5_wp*full_turn*real(i, wp)/real(2*nodes, wp), cosine(i), unused)
      end do
      all_terms = 0.0_wp
      do i = 1, nodes
         do k = 0, most_terms - 1
            all_terms(k) = all_terms(k) + at_nodes(i)*cosine(modulo(k*(2*(nodes - i) + 1), 4*nodes))
         end do
      end do
      all_terms = all_terms*2.0_wp/real(nodes, wp)
      all_terms(0) = 0.5_wp*all_terms(0)
      ! what is left out is at most the sum of the terms
      terms = most_terms
      left = 0.0_wp
      do while (terms > 1)
         left = left + abs(all_terms(terms - 1))
         if (left > 0.5_wp*wanted*size_of) exit
         terms = terms - 1
      end do
      coefficients = all_terms(:terms - 1)
      error = 0.0_wp
      do i = 1, size(at_even)
         error = max(error, abs(series_at(coefficients, real(2*(i - 1) - tried, wp)/real(tried, wp)) - at_even(i)))
      end do
   end subroutine fit_series

   !> The sum of a series, by Clenshaw's rule.
   pure real(wp) function series_at(coefficients, t) result(value)
      real(wp), intent(in) :: coefficients(:)
      real(wp), intent(in) :: t                        !! from -1 to 1
      real(wp) :: before, later
      integer :: k

      value = 0.0_wp
      before = 0.0_wp
      do k = size(coefficients), 2, -1
         later = before
         before = value
         value = 2.0_wp*t*before - later + coefficients(k)
      end do
      value = t*value - before + coefficients(1)
   end function series_at
end module psalm_dependent_joints
