!> Complete force balance by counterweights: whether it is possible, with how many, on which links, and with what masses.
!>
!> The frame feels no force of inertia if sum m G is constant: sum over the links of m z + s exp(i theta), z the anchor of a link
!> and s its first moment about it, complex and in the link's axes. A weight mu with the first moment p adds mu z + p exp(i theta).
!> The links whose columns exp(i theta), less their means, are a basis can balance what any others do: these bases are the
!> minimal sets. For given links the least masses are a convex problem: min sum mu so that |p| <= reach*mu. Source: Oldham (1977),
!> chapter 11; that its sets are bases of a linear matroid is shown in `doc/theory/forces.md`, Counterweights.
module psalm_force_balance
   use psalm_conic, only: conic_t, conic_solution_t, solve_conic
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: force_balance_t, weights_t, prepare_balance, find_sets, least_weights, solve_moments, rank_of, unspanned, heaviest
   public :: conditions_t, find_conditions

   real(wp), parameter :: dependent = 1.0e-10_wp   !! a column of which less is left depends on the others
   real(wp), parameter :: penalty = 1.0e4_wp       !! of missing room, in masses of the linkage: no limit costs more to keep
   real(wp), parameter :: kept = 1.0e-7_wp         !! missing room that is rounding
   real(wp), parameter :: heaviest = 100.0_wp      !! masses of the linkage: a weight is not heavier, where the user sets no limit

   !> What moves, in complex coordinates along an orthonormal basis of all that the columns and the imbalance span.
   type :: force_balance_t
      complex(wp), allocatable :: turning(:, :)    !! shape (rank, links): exp(i theta)
      complex(wp), allocatable :: moving(:, :)     !! shape (rank, links): anchors, m
      complex(wp), allocatable :: imbalance(:)     !! shape (rank): of the linkage, kg m
      complex(wp), allocatable :: parts(:, :)      !! shape (rank, links): of it by the mass of each link, kg m; where it was given
      real(wp) :: swing = 0.0_wp                   !! RMS of the imbalance about its mean, kg m
      real(wp) :: left = 0.0_wp                    !! part of it that no weights can balance
      real(wp) :: mass = 0.0_wp                    !! of all moving links, kg
   end type force_balance_t

   !> What the weights of a set must satisfy: equations 11.15 to 11.21 as numbers.
   type :: conditions_t
      integer, allocatable :: links(:)             !! with weights
      complex(wp), allocatable :: by_links(:, :)   !! shape (weights, links): first moment that the mass of each link asks for, kg m
      complex(wp), allocatable :: by_weights(:, :) !! shape (weights, weights): and each kilogram of each weight, m
   end type conditions_t

   !> Weights on links, and what proves that none are lighter.
   type :: weights_t
      integer, allocatable :: links(:)
      real(wp), allocatable :: mass(:)             !! kg
      complex(wp), allocatable :: moment(:)        !! first moment about the anchor, kg m, axes of the link
      real(wp) :: total = 0.0_wp                   !! kg
      real(wp) :: bound = 0.0_wp                   !! no weights on these links are lighter, kg
      real(wp) :: gap = 0.0_wp, residual = 0.0_wp  !! of the optimality conditions
      logical :: found = .false.                   !! there are such weights within the limits
   end type weights_t

contains

   !> Reduce the motion of the links to its own dimension.
   subroutine prepare_balance(turning, moving, imbalance, mass, balance, parts)
      complex(wp), intent(in) :: turning(:, :)     !! shape (positions, links): exp(i theta)
      complex(wp), intent(in) :: moving(:, :)      !! shape (positions, links): anchors, m
      complex(wp), intent(in) :: imbalance(:)      !! shape (positions): sum m G, kg m
      real(wp), intent(in) :: mass                 !! of all links, kg
      type(force_balance_t), intent(out) :: balance
      complex(wp), intent(in), optional :: parts(:, :) !! shape (positions, links): m G of each, kg m
      complex(wp) :: basis(size(turning, 1), size(turning, 2)), column(size(turning, 1))
      real(wp) :: unit, rest, largest
      integer :: k, b, rank, best
      logical :: used(size(turning, 2))

      unit = sqrt(real(size(turning, 1), wp))
      rank = 0
      used = .false.
      do k = 1, size(turning, 2)
         ! the column of which most is left
         best = 0
         largest = dependent
         do b = 1, size(turning, 2)
            if (used(b)) cycle
            column = reduced(centred(turning(:, b))/unit, basis(:, :rank))
            rest = length_of(column)
            if (rest <= largest) cycle
            largest = rest
            best = b
         end do
         if (best == 0) exit
         used(best) = .true.
         column = reduced(reduced(centred(turning(:, best))/unit, basis(:, :rank)), basis(:, :rank))
         rank = rank + 1
         basis(:, rank) = column/length_of(column)
      end do
      allocate (balance%turning(rank, size(turning, 2)), balance%moving(rank, size(turning, 2)), balance%imbalance(rank))
      if (present(parts)) allocate (balance%parts(rank, size(turning, 2)))
      do b = 1, size(turning, 2)
         balance%turning(:, b) = along(basis(:, :rank), centred(turning(:, b))/unit)
         balance%moving(:, b) = along(basis(:, :rank), centred(moving(:, b))/unit)
         if (present(parts)) balance%parts(:, b) = along(basis(:, :rank), centred(parts(:, b))/unit)
      end do
      column = centred(imbalance)/unit
      balance%swing = length_of(column)
      balance%imbalance = along(basis(:, :rank), column)
      balance%left = length_of(reduced(column, basis(:, :rank)))
      balance%mass = mass
   end subroutine prepare_balance

   pure function centred(values) result(swing)
      complex(wp), intent(in) :: values(:)
      complex(wp) :: swing(size(values))

      swing = values - sum(values)/real(size(values), wp)
   end function centred

   !> A vector less its parts along an orthonormal basis.
   pure function reduced(vector, basis) result(rest)
      complex(wp), intent(in) :: vector(:), basis(:, :)
      complex(wp) :: rest(size(vector))
      integer :: k

      rest = vector
      do k = 1, size(basis, 2)
         rest = rest - dot_product(basis(:, k), rest)*basis(:, k)
      end do
   end function reduced

   pure function along(basis, vector) result(parts)
      complex(wp), intent(in) :: basis(:, :), vector(:)
      complex(wp) :: parts(size(basis, 2))
      integer :: k

      parts = [(dot_product(basis(:, k), vector), k=1, size(basis, 2))]
   end function along

   pure real(wp) function length_of(vector)
      complex(wp), intent(in) :: vector(:)

      length_of = sqrt(sum(real(vector, wp)**2 + aimag(vector)**2))
   end function length_of

   !> How many of the columns of some links are independent.
   pure integer function rank_of(balance, links) result(rank)
      type(force_balance_t), intent(in) :: balance
      integer, intent(in) :: links(:)
      integer, allocatable :: basis(:)

      call choose_basis(balance, links, basis)
      rank = size(basis)
   end function rank_of

   !> An independent choice of links, the first ones first.
   pure subroutine choose_basis(balance, links, basis)
      type(force_balance_t), intent(in) :: balance
      integer, intent(in) :: links(:)
      integer, allocatable, intent(out) :: basis(:)
      complex(wp) :: frame(size(balance%turning, 1), size(balance%turning, 1)), column(size(balance%turning, 1))
      integer :: k, rank, chosen(size(links))

      rank = 0
      do k = 1, size(links)
         if (rank == size(frame, 2)) exit
         column = reduced(reduced(balance%turning(:, links(k)), frame(:, :rank)), frame(:, :rank))
         if (length_of(column) <= dependent) cycle
         rank = rank + 1
         frame(:, rank) = column/length_of(column)
         chosen(rank) = links(k)
      end do
      basis = chosen(:rank)
   end subroutine choose_basis

   !> Orthonormal columns that span those of an independent choice of links.
   pure function frame_of(balance, basis) result(frame)
      type(force_balance_t), intent(in) :: balance
      integer, intent(in) :: basis(:)
      complex(wp) :: frame(size(balance%turning, 1), size(basis)), column(size(balance%turning, 1))
      integer :: k

      do k = 1, size(basis)
         column = reduced(reduced(balance%turning(:, basis(k)), frame(:, :k - 1)), frame(:, :k - 1))
         frame(:, k) = column/length_of(column)
      end do
   end function frame_of

   !> Part of the imbalance that weights on some links cannot balance, of the whole; 0 for a linkage that is balanced.
   pure real(wp) function unspanned(balance, links) result(part)
      type(force_balance_t), intent(in) :: balance
      integer, intent(in) :: links(:)
      complex(wp) :: column(size(balance%turning, 1))
      integer, allocatable :: basis(:)

      part = 0.0_wp
      call choose_basis(balance, links, basis)
      column = reduced(balance%imbalance, frame_of(balance, basis))
      if (balance%swing > 0.0_wp) part = sqrt(length_of(column)**2 + balance%left**2)/balance%swing
   end function unspanned

   ! ---- minimal sets ------------------------------------------------------------------------------------------------

   !> All bases of the columns of some links, each in the order of `links`; `all_found` is false where there are more.
   subroutine find_sets(balance, links, most, sets, all_found)
      type(force_balance_t), intent(in) :: balance
      integer, intent(in) :: links(:)
      integer, intent(in) :: most
      integer, allocatable, intent(out) :: sets(:, :)   !! shape (rank, sets)
      logical, intent(out) :: all_found
      complex(wp) :: frame(size(balance%turning, 1), size(balance%turning, 1))
      integer, allocatable :: longer(:, :)
      integer :: rank, found
      integer :: chosen(size(balance%turning, 1))

      rank = rank_of(balance, links)
      allocate (sets(rank, 64))
      found = 0
      all_found = .true.
      if (rank > 0) call choose(1, 0)
      sets = sets(:, :found)

   contains

      !> Go on with links from `first` on, `depth` being chosen.
      recursive subroutine choose(first, depth)
         integer, intent(in) :: first, depth
         complex(wp) :: column(size(balance%turning, 1))
         integer :: k

         if (depth == rank) then
            all_found = found < most
            if (.not. all_found) return
            if (found == size(sets, 2)) then
               allocate (longer(rank, 2*found))
               longer(:, :found) = sets
               call move_alloc(longer, sets)
            end if
            found = found + 1
            sets(:, found) = chosen(:rank)
            return
         end if
         do k = first, size(links) - (rank - depth) + 1
            column = reduced(reduced(balance%turning(:, links(k)), frame(:, :depth)), frame(:, :depth))
            if (length_of(column) <= dependent) cycle
            frame(:, depth + 1) = column/length_of(column)
            chosen(depth + 1) = links(k)
            call choose(k + 1, depth + 1)
            if (.not. all_found) return
         end do
      end subroutine choose
   end subroutine find_sets

   ! ---- least masses ------------------------------------------------------------------------------------------------

   !> The lightest weights on some links that balance the linkage completely. Their columns must span those of all links that
   !> may be out of balance (`unspanned`).
   !>
   !> The moments of an independent choice of the links follow from the masses and from the moments of the others. Missing
   !> room counts as much as `penalty` masses of the linkage: where some is left, there are no such weights.
   subroutine least_weights(balance, links, reach, most, weights, axis, low, high)
      type(force_balance_t), intent(in) :: balance
      integer, intent(in) :: links(:)
      real(wp), intent(in) :: reach(:)             !! shape (links): greatest distance from the anchor, m; above 0
      real(wp), intent(in) :: most(:)              !! shape (links): kg; 0: no limit
      type(weights_t), intent(out) :: weights
      real(wp), intent(in), optional :: axis(:, :) !! shape (2, links): direction of each link's line in its axes
      real(wp), intent(in), optional :: low(:, :), high(:, :) !! shape (2, links): limits of the centre along and across it, m
      type(conic_t) :: problem
      type(conic_solution_t) :: solution
      integer, allocatable :: basis(:), free(:)
      complex(wp), allocatable :: right(:, :)
      real(wp) :: unit
      integer :: k, n, m, first, rank, j, place, column
      logical :: valid

      weights%links = links
      allocate (weights%mass(size(links)), source=0.0_wp)
      allocate (weights%moment(size(links)), source=(0.0_wp, 0.0_wp))
      call solve_moments(balance, links, basis, free, right, valid)
      rank = size(basis)
      if (.not. valid) return
      ! unknowns: masses in masses of the linkage, free moments in reach times these, missing room
      unit = merge(balance%mass, 1.0_wp, balance%mass > 0.0_wp)   ! without any mass there is nothing to scale by
      n = size(links) + 2*size(free) + 1
      problem%lines = size(links) + 1
      problem%cones = spread(3, 1, size(links))
      m = problem%lines + 3*size(links)
      allocate (problem%q(n), problem%g(m, n), problem%h(m), source=0.0_wp)
      problem%q(:size(links)) = 1.0_wp
      problem%q(n) = penalty
      do k = 1, size(links)
         problem%h(k) = heaviest
         if (most(k) > 0.0_wp) problem%h(k) = most(k)/unit
         problem%g(k, k) = 1.0_wp
         problem%g(k, n) = -1.0_wp
      end do
      problem%g(size(links) + 1, n) = -1.0_wp
      do k = 1, size(links)
         first = problem%lines + 3*k - 2
         problem%g(first, k) = -1.0_wp
         problem%g(first, n) = -1.0_wp
         place = findloc(basis, links(k), dim=1)
         if (place > 0) then
            call put(right(place, 1), reach(k)*unit, problem%h(first + 1:first + 2))
            do j = 1, size(links)
               call put(-right(place, j + 1), reach(k), problem%g(first + 1:first + 2, j))
            end do
            do j = 1, size(free)
               column = size(links) + 2*j - 1
               associate (value => -right(place, size(links) + 1 + j)*reach(findloc(links, free(j), dim=1)))
                  call put(value, reach(k), problem%g(first + 1:first + 2, column))
                  call put(value*(0.0_wp, 1.0_wp), reach(k), problem%g(first + 1:first + 2, column + 1))
               end associate
            end do
         else
            column = size(links) + 2*findloc(free, links(k), dim=1) - 1
            problem%g(first + 1, column) = -1.0_wp
            problem%g(first + 2, column + 1) = -1.0_wp
         end if
      end do
      if (present(axis)) call keep_in_boxes(axis, low, high)
      call solve_conic(problem, solution)
      if (.not. solution%solved .or. solution%x(n) > kept) return
      weights%found = .true.
      weights%mass = max(solution%x(:size(links)), 0.0_wp)*unit
      do j = 1, size(free)
         place = findloc(links, free(j), dim=1)
         column = size(links) + 2*j - 1
         weights%moment(place) = unit*reach(place)*cmplx(solution%x(column), solution%x(column + 1), wp)
      end do
      do k = 1, rank
         place = findloc(links, basis(k), dim=1)
         weights%moment(place) = right(k, 1) + sum(right(k, 2:size(links) + 1)*weights%mass)
         do j = 1, size(free)
            weights%moment(place) = weights%moment(place) + right(k, size(links) + 1 + j)* &
                                    weights%moment(findloc(links, free(j), dim=1))
         end do
      end do
      weights%total = sum(weights%mass)
      weights%bound = solution%bound*unit
      weights%gap = solution%gap
      weights%residual = solution%residual

   contains

      !> Low m <= p <= high m, along each link's line and across it, as lines before the cones.
      subroutine keep_in_boxes(axis, low, high)
         real(wp), intent(in) :: axis(:, :), low(:, :), high(:, :)
         real(wp), allocatable :: g(:, :), h(:), h_box(:), g_box(:, :)
         real(wp) :: along(2)
         integer :: link, side, at, row

         allocate (g_box(4*size(links), n), h_box(4*size(links)), source=0.0_wp)
         row = 0
         do link = 1, size(links)
            at = problem%lines + 3*link - 1        ! moment over reach: h - Gx of these two rows
            along = axis(:, link)
            do side = 1, 2
               h_box(row + 1) = -dot_product(along, problem%h(at:at + 1))
               g_box(row + 1, :) = -(along(1)*problem%g(at, :) + along(2)*problem%g(at + 1, :))
               g_box(row + 2, :) = -g_box(row + 1, :)
               h_box(row + 2) = -h_box(row + 1)
               g_box(row + 1, link) = g_box(row + 1, link) - high(side, link)/reach(link)
               g_box(row + 2, link) = g_box(row + 2, link) + low(side, link)/reach(link)
               g_box(row + 1:row + 2, n) = -1.0_wp
               row = row + 2
               along = [-axis(2, link), axis(1, link)]
            end do
         end do
         allocate (g(m + row, n), h(m + row))
         g(:problem%lines, :) = problem%g(:problem%lines, :)
         h(:problem%lines) = problem%h(:problem%lines)
         g(problem%lines + 1:problem%lines + row, :) = g_box
         h(problem%lines + 1:problem%lines + row) = h_box
         g(problem%lines + row + 1:, :) = problem%g(problem%lines + 1:, :)
         h(problem%lines + row + 1:) = problem%h(problem%lines + 1:)
         call move_alloc(g, problem%g)
         call move_alloc(h, problem%h)
         problem%lines = problem%lines + row
      end subroutine keep_in_boxes

      pure subroutine put(value, size_of, rows)
         complex(wp), intent(in) :: value
         real(wp), intent(in) :: size_of
         real(wp), intent(out) :: rows(2)

         rows = [real(value, wp), aimag(value)]/size_of
      end subroutine put
   end subroutine least_weights

   !> Complete balance solved for the moments of an independent choice of links: moment of basis(k) =
   !> right(k, 1) + right(k, 2:)*[masses of all links, moments of the free links].
   subroutine solve_moments(balance, links, basis, free, right, valid)
      type(force_balance_t), intent(in) :: balance
      integer, intent(in) :: links(:)
      integer, allocatable, intent(out) :: basis(:), free(:) !! of the links
      complex(wp), allocatable, intent(out) :: right(:, :)   !! shape (basis, 1 + links + free)
      logical, intent(out) :: valid
      complex(wp), allocatable :: frame(:, :), square(:, :)
      integer :: k, rank

      call choose_basis(balance, links, basis)
      rank = size(basis)
      free = pack(links, [(all(basis /= links(k)), k=1, size(links))])
      allocate (right(rank, 1 + size(links) + size(free)))
      frame = frame_of(balance, basis)
      square = conjugate_product(frame, balance%turning(:, basis))
      right(:, 1:1) = -conjugate_product(frame, reshape(balance%imbalance, [size(balance%imbalance), 1]))
      right(:, 2:size(links) + 1) = -conjugate_product(frame, balance%moving(:, links))
      right(:, size(links) + 2:) = -conjugate_product(frame, balance%turning(:, free))
      call solve_complex(square, right, valid)
   end subroutine solve_moments

   !> The terms of the conditions of a minimal set of links that balances the linkage.
   subroutine find_conditions(balance, links, conditions, valid)
      type(force_balance_t), intent(in) :: balance
      integer, intent(in) :: links(:)              !! with weights; their columns are independent
      type(conditions_t), intent(out) :: conditions
      logical, intent(out) :: valid
      complex(wp), allocatable :: frame(:, :), square(:, :), right(:, :)

      conditions%links = links
      frame = frame_of(balance, links)
      square = conjugate_product(frame, balance%turning(:, links))
      associate (n => size(balance%parts, 2))
         allocate (right(size(links), n + size(links)))
         right(:, :n) = -conjugate_product(frame, balance%parts)
         right(:, n + 1:) = -conjugate_product(frame, balance%moving(:, links))
         call solve_complex(square, right, valid)
         conditions%by_links = right(:, :n)
         conditions%by_weights = right(:, n + 1:)
      end associate
   end subroutine find_conditions

   !> Product of the conjugate transpose of a matrix with another one.
   pure function conjugate_product(a, b) result(c)
      complex(wp), intent(in) :: a(:, :), b(:, :)
      complex(wp) :: c(size(a, 2), size(b, 2))
      integer :: i, j

      do j = 1, size(b, 2)
         do i = 1, size(a, 2)
            c(i, j) = dot_product(a(:, i), b(:, j))
         end do
      end do
   end function conjugate_product

   !> Solve with several right sides by elimination with row exchanges.
   pure subroutine solve_complex(a, b, valid)
      complex(wp), intent(inout) :: a(:, :)        !! shape (n, n): destroyed
      complex(wp), intent(inout) :: b(:, :)        !! shape (n, m): right sides, then solutions
      logical, intent(out) :: valid
      complex(wp) :: row_a(size(a, 2)), row_b(size(b, 2))
      integer :: i, k, n, pivot

      n = size(a, 1)
      valid = .true.
      do k = 1, n
         pivot = k - 1 + maxloc(real(a(k:, k), wp)**2 + aimag(a(k:, k))**2, dim=1)
         valid = valid .and. abs(real(a(pivot, k), wp)) + abs(aimag(a(pivot, k))) > 0.0_wp
         if (.not. valid) return
         row_a = a(k, :)
         a(k, :) = a(pivot, :)
         a(pivot, :) = row_a
         row_b = b(k, :)
         b(k, :) = b(pivot, :)
         b(pivot, :) = row_b
         do i = k + 1, n
            a(i, k) = a(i, k)/a(k, k)
            a(i, k + 1:) = a(i, k + 1:) - a(i, k)*a(k, k + 1:)
            b(i, :) = b(i, :) - a(i, k)*b(k, :)
         end do
      end do
      do k = n, 1, -1
         do i = k + 1, n
            b(k, :) = b(k, :) - a(k, i)*b(i, :)
         end do
         b(k, :) = b(k, :)/a(k, k)
      end do
   end subroutine solve_complex
end module psalm_force_balance
