!> The cheapest tolerances: closed forms, problems of every scale, the law of sums of deviations.
program test_allocation
   use check, only: checks_t
   use psalm_kinds, only: wp
   use psalm_separable, only: separable_t, separable_solution_t, solve_separable, dual_value
   use psalm_standard_tolerances, only: grade_width, finest_grade, coarsest_grade
   use psalm_sum_law, only: law_uniform, law_triangle, law_normal, half_width, share_within, standard_normal
   use psalm_xoshiro, only: xoshiro_t, purpose_sample
   implicit none (type, external)
   type(checks_t) :: t
   type(xoshiro_t) :: random

   call random%seed(41, purpose_sample)
   call one_band()
   call own_bounds()
   call every_scale()
   call widths()
   call shares()
   call normal_deviations()
   call convex_widths()
   call grades()
   call t%report()

contains

   real(wp) function next()
      call random%next(next)
   end function next

   !> One band and one exponent, by Lagrange: t_i is (B_i/s_i)**(1/(k + 1)) in the worst case, (B_i/s_i**2)**(1/(k + 2)) by
   !> root-sum-square, times what fills the band (Chase and Greenwood 1988).
   subroutine one_band()
      type(separable_t) :: problem
      type(separable_solution_t) :: solution
      real(wp), parameter :: cost(4) = [1.0_wp, 2.5_wp, 0.4_wp, 7.0_wp], effect(4) = [1.0_wp, 0.3_wp, 2.0_wp, 1.5_wp]
      real(wp), parameter :: powers(3) = [0.5_wp, 1.0_wp, 2.0_wp], band = 0.2_wp
      real(wp) :: wanted(4)
      integer :: order, k, i

      do order = 1, 2
         do k = 1, size(powers)
            problem%cost = cost
            problem%power = [(powers(k)/real(order, wp), i=1, 4)]
            problem%unknown = [1, 2, 3, 4]
            problem%share = reshape((effect/band)**order, [4, 1])
            problem%low = [(0.0_wp, i=1, 4)]
            problem%high = [(1.0e3_wp, i=1, 4)]
            call solve_separable(problem, solution)
            wanted = (cost/effect**order)**(1.0_wp/(powers(k) + real(order, wp)))
            wanted = wanted*band/sum((effect*wanted)**order)**(1.0_wp/real(order, wp))
            associate (found => solution%x**(1.0_wp/real(order, wp)))
               call t%is_true(solution%solved .and. maxval(abs(found/wanted - 1.0_wp)) < 1.0e-5_wp, &
                              'one band: tolerances of Lagrange')
            end associate
            call t%close_to(solution%value/sum(cost/wanted**powers(k)), 1.0_wp, 1.0e-9_wp, 'one band: cost')
            call t%is_true(solution%bound <= solution%value .and. solution%value - solution%bound < 1.0e-9_wp*solution%value, &
                           'one band: the bound')
            ! the cost goes like the band to the power -k
            call t%close_to(real(order, wp)*solution%price(1)/(powers(k)*solution%value), 1.0_wp, 1.0e-6_wp, 'one band: its price')
         end do
      end do
   end subroutine one_band

   !> Bounds: what is not limited by a band is the largest; what cannot be is reported; held unknowns stay.
   subroutine own_bounds()
      type(separable_t) :: problem
      type(separable_solution_t) :: solution

      problem%cost = [1.0_wp, 1.0_wp, 1.0_wp]
      problem%power = [1.0_wp, 1.0_wp, 1.0_wp]
      problem%unknown = [1, 2, 2]
      problem%share = reshape([1.0_wp, 0.0_wp], [2, 1])
      problem%low = [0.0_wp, 0.0_wp]
      problem%high = [5.0_wp, 4.0_wp]
      call solve_separable(problem, solution)
      call t%is_true(solution%solved .and. abs(solution%x(1) - 1.0_wp) < 1.0e-8_wp .and. abs(solution%x(2) - 4.0_wp) < 1.0e-6_wp, &
                     'bounds: one tolerance at its band, one at its largest')
      problem%high = [0.5_wp, 4.0_wp]
      call solve_separable(problem, solution)
      call t%is_true(solution%solved .and. all(abs(solution%x - problem%high) <= 0.0_wp) .and. &
                     all(abs(solution%price) <= 0.0_wp), 'bounds: no band is full')
      problem%low = [2.0_wp, 0.0_wp]
      problem%high = [5.0_wp, 4.0_wp]
      call solve_separable(problem, solution)
      call t%is_true(.not. solution%solved .and. solution%tightest == 1, 'bounds: a band that the least tolerances leave')
      problem%low = [1.0_wp, 0.0_wp]
      call solve_separable(problem, solution)
      call t%is_true(solution%solved .and. abs(solution%x(1) - 1.0_wp) <= 0.0_wp, 'bounds: a band that they fill')
   end subroutine own_bounds

   !> Costs over six decades, changes over seven, exponents from 0.1 to 3: always solved, within every band, at the bound; and the
   !> bound holds at any other prices.
   subroutine every_scale()
      type(separable_t) :: problem
      type(separable_solution_t) :: solution
      integer, parameter :: trials = 2000
      integer :: trial, n, m, i, j, good, within, below
      real(wp) :: scale

      good = 0
      within = 0
      below = 0
      do trial = 1, trials
         n = 1 + int(12*next())
         m = 1 + int(30*next())
         problem%cost = [(10.0_wp**(6*next() - 3), i=1, n)]
         problem%power = [(0.1_wp + 2.9_wp*next(), i=1, n)]
         problem%unknown = [(i, i=1, n)]
         problem%low = [(merge(10.0_wp**(-9*next() - 9), 0.0_wp, next() > 0.7_wp), i=1, n)]
         problem%high = [(10.0_wp**(2*next()), i=1, n)]
         if (allocated(problem%share)) deallocate (problem%share)
         allocate (problem%share(n, m))
         do j = 1, m
            scale = 10.0_wp**(4*next())
            do i = 1, n
               problem%share(i, j) = merge(scale*next()*10.0_wp**(3*next()), 0.0_wp, next() > 0.2_wp)
            end do
         end do
         call solve_separable(problem, solution)
         if (solution%solved .and. solution%value - solution%bound <= 1.0e-8_wp*solution%value) good = good + 1
         if (all([(sum(problem%share(:, j)*solution%x), j=1, m)] <= 1.0_wp + 1.0e-12_wp)) within = within + 1
         if (dual_value(problem, [(2.0_wp*next()*solution%price(j), j=1, m)]) <= solution%value*(1.0_wp + 1.0e-12_wp)) &
            below = below + 1
      end do
      call t%equal_integer(good, trials, 'every scale: solved to the bound')
      call t%equal_integer(within, trials, 'every scale: within every band')
      call t%equal_integer(below, trials, 'every scale: a bound at any prices')
   end subroutine every_scale

   !> The width of a share: the share of the width is that, and its slopes are differences.
   subroutine widths()
      real(wp), parameter :: effects(6) = [1.0_wp, -0.5_wp, 0.7_wp, 0.1_wp, 1.2_wp, -0.03_wp], step = 1.0e-4_wp
      integer, parameter :: laws(3) = [law_uniform, law_triangle, law_normal]
      real(wp) :: width, slope(6), more(6), less(6), any_slope(6), above, below
      integer :: law, n, i

      do law = 1, size(laws)
         do n = 1, size(effects)
            call half_width(laws(law), effects(:n), 0.99_wp, width, slope(:n))
            call t%close_to(share_within(laws(law), effects(:n), width), 0.99_wp, 1.0e-9_wp, 'widths: the share')
            call t%close_to(sum(slope(:n)*abs(effects(:n))), width, 1.0e-12_wp, 'widths: they grow like the deviations')
            do i = 1, n
               more = effects
               less = effects
               more(i) = effects(i)*(1.0_wp + step)
               less(i) = effects(i)*(1.0_wp - step)
               call half_width(laws(law), more(:n), 0.99_wp, above, any_slope(:n))
               call half_width(laws(law), less(:n), 0.99_wp, below, any_slope(:n))
               call t%close_to(slope(i), (above - below)/(2.0_wp*step*abs(effects(i))), 1.0e-5_wp, 'widths: the slope')
            end do
         end do
      end do
      call t%close_to(share_within(law_uniform, [2.0_wp], 0.5_wp), 0.25_wp, 1.0e-14_wp, 'one uniform deviation')
      ! two equal ones have a triangle for density
      call t%close_to(share_within(law_uniform, [1.0_wp, 1.0_wp], 0.5_wp), 0.4375_wp, 1.0e-9_wp, 'two uniform deviations')
      call t%close_to(share_within(law_triangle, [2.0_wp], 0.5_wp), 0.4375_wp, 1.0e-9_wp, 'one triangular deviation')
      call t%close_to(share_within(law_uniform, [1.0_wp, 1.0_wp], 2.0_wp), 1.0_wp, 0.0_wp, 'all of them')
   end subroutine widths

   !> Shares against samples, within four standard errors.
   subroutine shares()
      integer, parameter :: trials = 400000
      real(wp), parameter :: effects(5) = [1.0_wp, 0.8_wp, 0.5_wp, 0.2_wp, 0.001_wp], parts(3) = [0.3_wp, 0.6_wp, 0.9_wp]
      real(wp) :: total, share, width, slope(5)
      integer :: law, n, i, k, part, within

      do law = law_uniform, law_normal
         do n = 1, size(effects), 2
            call half_width(law, effects(:n), 0.999_wp, width, slope(:n))
            part = 1 + modulo(n/2, size(parts))
            within = 0
            do i = 1, trials
               total = 0.0_wp
               do k = 1, n
                  select case (law)
                  case (law_uniform)
                     total = total + effects(k)*(2.0_wp*next() - 1.0_wp)
                  case (law_triangle)
                     total = total + effects(k)*(next() + next() - 1.0_wp)
                  case default
                     total = total + effects(k)*standard_normal(next())
                  end select
               end do
               if (abs(total) <= parts(part)*width) within = within + 1
            end do
            share = share_within(law, effects(:n), parts(part)*width)
            call t%close_to(real(within, wp)/real(trials, wp), share, 4.0_wp*sqrt(share*(1.0_wp - share)/real(trials, wp)), &
                            'the share of a sample')
         end do
      end do
   end subroutine shares

   !> Normal deviations of given deviates, by the error function; a tolerance is three standard deviations.
   subroutine normal_deviations()
      real(wp) :: deviate, worst
      integer :: k

      worst = 0.0_wp
      do k = 1, 60
         deviate = 0.5_wp**k
         worst = max(worst, abs(0.5_wp*erfc(-3.0_wp*standard_normal(deviate)/sqrt(2.0_wp))/deviate - 1.0_wp))
         deviate = real(k, wp)/61.0_wp
         worst = max(worst, abs(0.5_wp*erfc(-3.0_wp*standard_normal(deviate)/sqrt(2.0_wp))/deviate - 1.0_wp))
      end do
      call t%is_true(worst < 1.0e-12_wp, 'normal deviations')
   end subroutine normal_deviations
   !> The width of a share is convex in the deviations, for every law: between two rows of them it is at most the mean of theirs.
   subroutine convex_widths()
      integer, parameter :: laws(3) = [law_uniform, law_triangle, law_normal], n = 5, trials = 300
      real(wp) :: one(n), other(n), slope(n), of_one, of_other, between, share, part
      integer :: law, trial, i, good

      good = 0
      do law = 1, size(laws)
         do trial = 1, trials
            one = [(next()**3, i=1, n)]
            other = [(next()**3, i=1, n)]
            share = 0.02_wp + 0.97_wp*next()
            part = next()
            call half_width(laws(law), one, share, of_one, slope)
            call half_width(laws(law), other, share, of_other, slope)
            call half_width(laws(law), part*one + (1.0_wp - part)*other, share, between, slope)
            if (between <= (part*of_one + (1.0_wp - part)*of_other)*(1.0_wp + 1.0e-7_wp)) good = good + 1
         end do
      end do
      call t%equal_integer(good, trials*size(laws), 'widths: convex')
   end subroutine convex_widths

   !> The table of ISO 286 against the formulas that it was rounded from: within a tenth, sizes up to 3 mm 16 per cent; and values
   !> known from every handbook: IT7 of 50 mm and beyond it, IT6 of 10, IT11 of 500, IT8 of 120, IT13 of 3150.
   subroutine grades()
      real(wp), parameter :: limits(0:21) = [1.0_wp, 3.0_wp, 6.0_wp, 10.0_wp, 18.0_wp, 30.0_wp, 50.0_wp, 80.0_wp, 120.0_wp, &
                                             180.0_wp, 250.0_wp, 315.0_wp, 400.0_wp, 500.0_wp, 630.0_wp, 800.0_wp, 1000.0_wp, &
                                             1250.0_wp, 1600.0_wp, 2000.0_wp, 2500.0_wp, 3150.0_wp]
      real(wp), parameter :: times(finest_grade:coarsest_grade) = [7.0_wp, 10.0_wp, 16.0_wp, 25.0_wp, 40.0_wp, 64.0_wp, 100.0_wp, &
                                                                  160.0_wp, 250.0_wp]
      real(wp) :: mean, unit
      integer :: step, grade, near, rising

      near = 0
      rising = 0
      do step = 1, ubound(limits, 1)
         mean = sqrt(limits(step - 1)*limits(step))
         unit = 1.0e-3_wp*merge(0.45_wp*mean**(1.0_wp/3.0_wp) + 1.0e-3_wp*mean, 4.0e-3_wp*mean + 2.1_wp, limits(step) <= 500.0_wp)
         do grade = finest_grade, coarsest_grade
            associate (width => grade_width(grade, limits(step)), formula => times(grade)*unit)
               if (abs(width - formula) <= merge(0.16_wp, 0.1_wp, step == 1)*formula) near = near + 1
               if (grade_width(grade, limits(step)*1.001_wp) > width .or. step == ubound(limits, 1)) rising = rising + 1
            end associate
         end do
      end do
      call t%equal_integer(near, 21*9, 'grades: near the formula')
      call t%equal_integer(rising, 21*9, 'grades: wider beyond each step')
      call t%close_to(maxval(abs(grade_width([7, 7, 6, 11, 8, 13], [50.0_wp, 50.1_wp, 10.0_wp, 500.0_wp, 120.0_wp, 3150.0_wp]) - &
                                 [0.025_wp, 0.030_wp, 0.009_wp, 0.4_wp, 0.054_wp, 3.3_wp])), 0.0_wp, 1.0e-12_wp, 'grades: handbook')
      call t%is_true(all(abs(grade_width([4, 14, 7, 7], [10.0_wp, 10.0_wp, 0.0_wp, 3151.0_wp])) &
                         <= 0.0_wp), 'grades: those that there are not')
   end subroutine grades
end program test_allocation
