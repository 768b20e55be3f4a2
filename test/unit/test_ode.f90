!> The explicit method of order 8 for differential equations: the conditions on its coefficients, and an equation whose solution is
!> known.
program test_ode
   use check, only: checks_t
   use psalm_dormand_prince, only: stages, nodes, weights, stage_weights, error_fifth, error_third
   use psalm_kinds, only: wp, pi
   use psalm_ode, only: advance, next_step, one_step
   use swing, only: swing_t
   implicit none (type, external)
   integer, parameter :: order = 8
   integer, parameter :: most_trees = 1000           !! of one order, trees found twice counted twice
   real(wp), parameter :: rounding = 2.0e4_wp*epsilon(1.0_wp) !! the weights are up to 43 and multiply each other

   !> Rooted trees of one order: what stages make of them, and their densities.
   type :: trees_t
      integer :: count = 0
      real(wp) :: stage(stages, most_trees) = 0.0_wp
      real(wp) :: density(most_trees) = 1.0_wp
   end type trees_t

   type(checks_t) :: t

   call conditions()
   call swinging()
   call orders()
   call at_a_wall()
   call t%report()

contains

   !> Every rooted tree is one tree grafted on the root of another. The method has an order if for all trees up to it the weighted
   !> sum of the stages is 1/density (Butcher).
   subroutine conditions()
      type(trees_t), allocatable :: trees(:)
      real(wp) :: worst(order), fifth, third, row(stages)
      integer :: n, k, i, j, m

      allocate (trees(order))
      row = sum(stage_weights, dim=1)
      call t%is_true(all(abs(row - nodes) <= rounding), 'the weights of every stage add up to its node')
      trees(1)%count = 1
      trees(1)%stage(:, 1) = 1.0_wp
      do n = 2, order
         m = 0
         do k = 1, n - 1
            do i = 1, trees(k)%count
               do j = 1, trees(n - k)%count
                  m = m + 1
                  trees(n)%stage(:, m) = trees(k)%stage(:, i)*matmul(trees(n - k)%stage(:, j), stage_weights)
                  trees(n)%density(m) = trees(k)%density(i)/real(k, wp)*trees(n - k)%density(j)*real(n, wp)
               end do
            end do
         end do
         trees(n)%count = m
      end do
      fifth = 0.0_wp
      third = 0.0_wp
      do n = 1, order
         worst(n) = 0.0_wp
         do i = 1, trees(n)%count
            worst(n) = max(worst(n), abs(sum(weights*trees(n)%stage(:, i))*trees(n)%density(i) - 1.0_wp))
            if (n <= 5) fifth = max(fifth, abs(sum(error_fifth*trees(n)%stage(:, i))))
            if (n <= 3) third = max(third, abs(sum(error_third*trees(n)%stage(:, i))))
         end do
      end do
      call t%equal_integer(trees(order)%count, 429, 'trees of order 8, some twice: the eighth number of Catalan')
      call t%is_true(all(worst <= rounding), 'the conditions of all trees up to order 8')
      call t%is_true(fifth <= rounding, 'the first error has none of orders 1 to 5')
      call t%is_true(third <= rounding, 'the second error has none of orders 1 to 3')
      call t%is_true(maxval([(abs(sum(error_fifth*trees(6)%stage(:, i))), i=1, trees(6)%count)]) > 1.0e-6_wp, &
                     'the first error has one of order 6')
      call t%is_true(maxval([(abs(sum(error_third*trees(4)%stage(:, i))), i=1, trees(4)%count)]) > 1.0e-6_wp, &
                     'the second error has one of order 4')
   end subroutine conditions

   !> Ten turns of y'' = -y within the tolerance, forwards and back.
   subroutine swinging()
      type(swing_t) :: bob
      real(wp) :: y(3), after(3), time, h, taken, error, last, from(3)

      from = [0.6_wp, 0.8_wp, 0.0_wp]
      y = from
      time = 0.0_wp
      last = 20.0_wp*pi
      h = 0.01_wp
      do while (time < last)
         call advance(bob, time, y, min(h, last - time), 1.0e-9_wp, after, taken, error)
         time = time + taken
         y = after
         h = next_step(taken, error)
         if (last - time < 1.0e-9_wp) exit
      end do
      call t%is_true(maxval(abs(y(:2) - from(:2))) <= 1.0e-11_wp, 'ten turns of an oscillator come back to 1E-11')
      call t%close_to(y(3), time, 1.0e-13_wp, 'an unknown that may have any error is integrated all the same')
      call t%is_true(bob%evaluations < 6000, 'ten turns of an oscillator take less than 6000 evaluations')
      call one_step(bob, time, y, 0.1_wp, after)
      call one_step(bob, time + 0.1_wp, after, -0.1_wp, y)
      call t%is_true(maxval(abs(y(:2) - from(:2))) <= 1.0e-11_wp, 'a step back ends where the step began')
   end subroutine swinging

   !> Half the step: an error of a step less by about 2**9, and an estimate of it less by about 2**8.
   subroutine orders()
      type(swing_t) :: bob
      real(wp) :: y(3), long(3), short(3), error(2), miss(2)

      y = [1.0_wp, 0.0_wp, 0.0_wp]
      call one_step(bob, 0.0_wp, y, 0.8_wp, long, error(1))
      call one_step(bob, 0.0_wp, y, 0.4_wp, short, error(2))
      miss = [norm2(long(:2) - [cos(0.8_wp), -sin(0.8_wp)]), norm2(short(:2) - [cos(0.4_wp), -sin(0.4_wp)])]
      call t%is_true(miss(1)/miss(2) > 2.0_wp**8 .and. miss(1)/miss(2) < 2.0_wp**10, 'a step has an error of order 9')
      call t%is_true(error(1)/error(2) > 2.0_wp**7 .and. error(1)/error(2) < 2.0_wp**9, 'its estimate is of order 8')
      call t%is_true(error(1)*bob%allowed > miss(1), 'the estimate is above the error')
   end subroutine orders

   !> Where an equation ends, steps become shorter up to there.
   subroutine at_a_wall()
      type(swing_t) :: bob
      real(wp) :: y(3), after(3), h, error

      bob%wall = 0.25_wp
      y = [1.0_wp, 0.0_wp, 0.0_wp]
      call one_step(bob, 0.0_wp, y, 0.4_wp, after, error)
      call t%is_true(error >= huge(1.0_wp), 'a step beyond the end of an equation has no error that counts')
      call t%is_true(maxval(abs(after - y)) <= 0.0_wp, 'and is not made')
      call advance(bob, 0.0_wp, y, 0.4_wp, 1.0e-9_wp, after, h, error)
      call t%is_true(h <= 0.25_wp .and. error <= 1.0_wp, 'a shorter step is made in its place')
   end subroutine at_a_wall
end program test_ode
