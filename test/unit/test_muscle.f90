!> Counterweights and springs: the conic solver against solutions known otherwise, force balance, loads linear in weights.
program test_muscle
   use check, only: checks_t
   use psalm_conic, only: conic_t, conic_solution_t, solve_conic
   use psalm_force_balance, only: force_balance_t, weights_t, prepare_balance, find_sets, least_weights, rank_of, unspanned
   use psalm_kinds, only: wp, pi
   use psalm_linear, only: triangle_of
   use psalm_xoshiro, only: xoshiro_t, purpose_sample
   implicit none (type, external)
   type(checks_t) :: t

   call corner_of_a_polygon()
   call nearest_point_of_a_disc()
   call random_programmes()
   call no_allowed_point()
   call triangles()
   call wheel()
   call wheels_that_move_alike()
   call t%report()

contains

   !> max x + 2y on x + y <= 4, x + 3y <= 6, x, y >= 0: the corner (3, 1).
   subroutine corner_of_a_polygon()
      type(conic_t) :: problem
      type(conic_solution_t) :: solution

      problem%q = [-1.0_wp, -2.0_wp]
      problem%g = reshape([1.0_wp, 1.0_wp, -1.0_wp, 0.0_wp, 1.0_wp, 3.0_wp, 0.0_wp, -1.0_wp], [4, 2])
      problem%h = [4.0_wp, 6.0_wp, 0.0_wp, 0.0_wp]
      problem%lines = 4
      allocate (problem%cones(0))
      call solve_conic(problem, solution)
      call t%is_true(solution%solved, 'a linear programme is solved')
      call t%close_to(solution%x(1), 3.0_wp, 1.0e-9_wp, 'corner of a polygon, x')
      call t%close_to(solution%x(2), 1.0_wp, 1.0e-9_wp, 'corner of a polygon, y')
      call t%close_to(solution%bound, -5.0_wp, 1.0e-9_wp, 'the dual objective is the primal one')
   end subroutine corner_of_a_polygon

   !> min |(x, y) - (3, 4)| with |(x, y)| <= 1: the distance is 4, at (.6, .8).
   subroutine nearest_point_of_a_disc()
      type(conic_t) :: problem
      type(conic_solution_t) :: solution

      problem%q = [0.0_wp, 0.0_wp, 1.0_wp]
      allocate (problem%g(6, 3), problem%h(6), source=0.0_wp)
      problem%cones = [3, 3]
      problem%g(1, 3) = -1.0_wp
      problem%g(2, 1) = -1.0_wp
      problem%g(3, 2) = -1.0_wp
      problem%h(:3) = [0.0_wp, -3.0_wp, -4.0_wp]
      problem%h(4) = 1.0_wp
      problem%g(5, 1) = -1.0_wp
      problem%g(6, 2) = -1.0_wp
      call solve_conic(problem, solution)
      call t%is_true(solution%solved, 'a problem with two cones is solved')
      call t%close_to(solution%value, 4.0_wp, 1.0e-9_wp, 'distance of a point from a disc')
      call t%close_to(solution%x(1), 0.6_wp, 1.0e-7_wp, 'nearest point of a disc')
   end subroutine nearest_point_of_a_disc

   !> Random problems with an inner point: no allowed point that is drawn lies below the bound, and value and bound agree.
   subroutine random_programmes()
      type(conic_t) :: problem
      type(conic_solution_t) :: solution
      type(xoshiro_t) :: random
      real(wp) :: x(5), s(23), draw, least
      integer :: trial, i, j, k

      call random%seed(7, purpose_sample)
      do trial = 1, 20
         if (allocated(problem%g)) deallocate (problem%g)
         allocate (problem%g(23, 5))
         problem%lines = 11
         problem%cones = [4, 3, 5]
         if (.not. allocated(problem%q)) allocate (problem%q(5), problem%h(23))
         do j = 1, 5
            call random%next(draw)
            problem%q(j) = draw - 0.5_wp
            do i = 1, 23
               call random%next(draw)
               problem%g(i, j) = draw - 0.5_wp
            end do
         end do
         problem%h = 0.0_wp
         problem%h(:11) = 1.0_wp
         problem%h([12, 16, 19]) = 2.0_wp
         ! a box, so that there is an optimum
         problem%g(:10, :) = 0.0_wp
         do j = 1, 5
            problem%g(2*j - 1, j) = 1.0_wp
            problem%g(2*j, j) = -1.0_wp
         end do
         call solve_conic(problem, solution)
         call t%is_true(solution%solved, 'a random problem is solved')
         call t%close_to(solution%value, solution%bound, 1.0e-9_wp, 'value and bound agree')
         least = huge(1.0_wp)
         do k = 1, 2000
            do j = 1, 5
               call random%next(draw)
               x(j) = 2.0_wp*draw - 1.0_wp
            end do
            do i = 1, 23
               s(i) = problem%h(i) - dot_product(problem%g(i, :), x)
            end do
            if (any(s(:11) < 0.0_wp)) cycle
            if (s(12) < norm2(s(13:15)) .or. s(16) < norm2(s(17:18)) .or. s(19) < norm2(s(20:23))) cycle
            least = min(least, dot_product(problem%q, x))
         end do
         call t%is_true(least >= solution%bound - 1.0e-9_wp .and. least < huge(1.0_wp), 'no allowed point is below the bound')
      end do
   end subroutine random_programmes

   !> x <= 0 and x >= 1: there is none.
   subroutine no_allowed_point()
      type(conic_t) :: problem
      type(conic_solution_t) :: solution

      problem%q = [1.0_wp]
      problem%g = reshape([1.0_wp, -1.0_wp], [2, 1])
      problem%h = [0.0_wp, -1.0_wp]
      problem%lines = 2
      allocate (problem%cones(0))
      call solve_conic(problem, solution)
      call t%is_true(.not. solution%solved, 'a problem without an allowed point is not solved')
   end subroutine no_allowed_point

   !> R'R = A'A, R triangular; with more columns than rows too.
   subroutine triangles()
      real(wp) :: a(6, 4), r(4, 4), b(2, 4)
      integer :: i, j

      do j = 1, 4
         do i = 1, 6
            a(i, j) = 1.0_wp/real(i + j, wp) + real(modulo(i*j, 5), wp)
         end do
      end do
      r = triangle_of(a)
      call t%close_to(maxval(abs(matmul(transpose(r), r) - matmul(transpose(a), a))), 0.0_wp, 1.0e-12_wp, 'R''R is A''A')
      call t%close_to(abs(r(2, 1)) + abs(r(4, 1)) + abs(r(4, 3)), 0.0_wp, 1.0e-300_wp, 'R is a triangle')
      b = a(:2, :)
      r = triangle_of(b)
      call t%close_to(maxval(abs(matmul(transpose(r), r) - matmul(transpose(b), b))), 0.0_wp, 1.0e-12_wp, 'of few rows too')
   end subroutine triangles

   !> One link that turns about a pivot: the weight lies opposite to its centre, at the full reach.
   subroutine wheel()
      type(force_balance_t) :: balance
      type(weights_t) :: weights
      complex(wp) :: turning(24, 1), moving(24, 1)
      integer, allocatable :: sets(:, :)
      integer :: k
      logical :: all_found

      turning(:, 1) = [(exp(cmplx(0.0_wp, 2.0_wp*pi*real(k, wp)/24.0_wp, wp)), k=1, 24)]
      moving = (0.0_wp, 0.0_wp)
      call prepare_balance(turning, moving, 0.3_wp*(0.0_wp, 1.0_wp)*turning(:, 1), 2.0_wp, balance)
      call t%equal_integer(rank_of(balance, [1]), 1, 'one wheel needs one weight')
      call find_sets(balance, [1], 10, sets, all_found)
      call t%is_true(all_found .and. size(sets) == 1, 'the one set of a wheel')
      call least_weights(balance, [1], [0.05_wp], [0.0_wp], weights)
      call t%is_true(weights%found, 'a wheel is balanced')
      call t%close_to(weights%total, 6.0_wp, 1.0e-8_wp, 'mass: moment over reach')
      call t%close_to(abs(weights%moment(1) - (0.0_wp, -0.3_wp)), 0.0_wp, 1.0e-10_wp, 'the weight lies opposite')
      call t%is_true(weights%bound <= weights%total*(1.0_wp + 1.0e-9_wp), 'the bound is no higher')
      call least_weights(balance, [1], [0.05_wp], [5.0_wp], weights)
      call t%is_true(.not. weights%found, 'less mass than is needed is not enough')
      call prepare_balance(turning, moving, 0.0_wp*turning(:, 1), 0.0_wp, balance)
      call least_weights(balance, [1], [0.05_wp], [5.0_wp], weights)
      call t%is_true(weights%found .and. weights%total <= 1.0e-6_wp, 'a wheel without mass needs no weight')
   end subroutine wheel

   !> Two wheels that turn alike (a parallelogram): either can balance both; a third that does not turn is of no use.
   subroutine wheels_that_move_alike()
      type(force_balance_t) :: balance
      type(weights_t) :: weights
      complex(wp) :: turning(24, 3), moving(24, 3)
      integer, allocatable :: sets(:, :)
      integer :: k
      logical :: all_found

      turning(:, 1) = [(exp(cmplx(0.0_wp, 2.0_wp*pi*real(k, wp)/24.0_wp, wp)), k=1, 24)]
      turning(:, 2) = turning(:, 1)*exp((0.0_wp, 0.7_wp))
      turning(:, 3) = (1.0_wp, 0.0_wp)
      moving = (0.0_wp, 0.0_wp)
      call prepare_balance(turning, moving, turning(:, 1) + turning(:, 2), 1.0_wp, balance)
      call t%equal_integer(rank_of(balance, [1, 2, 3]), 1, 'wheels that turn alike need one weight')
      call find_sets(balance, [1, 2, 3], 10, sets, all_found)
      call t%equal_integer(size(sets, 2), 2, 'on either of them')
      call t%close_to(unspanned(balance, [3]), 1.0_wp, 1.0e-12_wp, 'what does not turn balances nothing')
      call least_weights(balance, [1, 2], [1.0_wp, 2.0_wp], [0.0_wp, 0.0_wp], weights)
      call t%close_to(weights%total, 0.5_wp*abs((1.0_wp, 0.0_wp) + exp((0.0_wp, 0.7_wp))), 1.0e-8_wp, &
                      'the longer reach takes the weight')
   end subroutine wheels_that_move_alike
end program test_muscle
