!> Proofs of motion: the arithmetic against quadruple precision, ends against numbers computed in 50 digits, verdicts against the
!> sampled motion.
program test_proof
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t, new_problem
   use psalm_exact_sum, only: sign_of_sum
   use psalm_kinds, only: wp, full_turn, radians_per_degree
   use psalm_plan, only: plan_t, make_plan
   use psalm_proof, only: proof_t, proof_linkage_t, prepare_proof, bind_proof, prove_closure, piece_closes, piece_opens, &
                          piece_undecided, cause_too_short, cause_difference, cause_guide, cause_link, touch_exact, touch_none
   use psalm_output_kind, only: motion_angle
   use psalm_proof_motion, only: movement_t, proven_dead_point_t, prove_movement, quantity_output, quantity_turning
   use psalm_proof_ranges, only: proven_extreme_t, prove_extremes, prove_tolerance
   use psalm_quad, only: qp, unit_vector_quad
   use psalm_taylor, only: lanes, degree, multiply, range_of, reciprocal, square_root, turn_crank, norm_of, rounding
   use psalm_xoshiro, only: xoshiro_t
   implicit none (type, external)

   real(wp), parameter :: one_ulp = 5.7e-14_wp     !! of an angle between 256 and 512 degrees
   real(wp), parameter :: frame_angle = 20.25_wp
   integer, parameter :: places = 9                 !! of a box, looked at
   type(checks_t) :: t
   type(problem_t) :: problem
   type(data_set_t) :: set
   type(dimensions_t) :: dimensions
   type(proof_t) :: proof
   integer :: k

   call check_arithmetic()
   call check_sums()

   ! ends in degrees, computed in 50 digits
   call load_case('dyad1_crank_rocker', problem, set)
   call four_bar([1.5_wp, 4.0_wp, 3.4999999999999996_wp, 6.0_wp])
   call opens_between(20.249998441229716_wp, 20.250001558770284_wp, 1, cause_too_short, 'four-bar short of a change point')
   call four_bar([1.5_wp, 4.0_wp, 3.5_wp, 6.0_wp])
   call t%equal_integer(size(proof%limits), 3, 'a change point is all that is undecided')
   call t%is_true(proof%limits(2)%kind == piece_undecided .and. proof%limits(2)%touch == touch_exact, &
                  'lengths that add up exactly are named a change point')
   call t%is_true(proof%limits(2)%from <= frame_angle .and. proof%limits(2)%to >= frame_angle .and. &
                  proof%limits(2)%to - proof%limits(2)%from < 1.0e-15_wp*full_turn, 'the bracket of a change point is narrow')
   call four_bar([1.0_wp, 3.00000002_wp, 3.0_wp, 1.00000001_wp])
   call opens_between(200.249999007608_wp, 200.250000992392_wp, 1, cause_difference, 'kite with links of unequal length')
   call four_bar([30.0_wp, 60.0_wp, 68.88391998183876_wp, 80.0_wp])
   call t%is_true(proof%closes_everywhere(), 'a crank-rocker turns fully')
   call four_bar([1.5_wp, 4.0_wp, nearest(3.5_wp, 1.0_wp), 6.0_wp])
   call t%is_true(size(proof%limits) > 0 .and. all(proof%limits%touch == touch_none), &
                  'a length that is a digit too long makes no change point')
   call four_bar([1.0_wp, 3.0_wp, nearest(3.0_wp, 1.0_wp), 1.0_wp])
   call t%is_true(size(proof%limits) > 0 .and. all(proof%limits%touch == touch_none), 'nor one in a kite')
   call four_bar([1.0_wp, 2.0_wp, 3.0_wp, 2.0_wp])
   call t%is_true(any(proof%limits%touch == touch_exact .and. proof%limits%cause == cause_difference), &
                  'links that fold on the frame exactly are a change point')
   call load_case('dyad4_slider_crank', problem, set)
   dimensions = problem%given
   dimensions%arcl(1:4) = [25.0_wp, 30.0_wp, 0.0_wp, 5.0_wp]
   call prove_turn()
   call t%is_true(any(proof%limits%kind == piece_undecided) .and. all(proof%limits%touch == touch_none), &
                  'a rod that just reaches is not decided, and no change point of a four-bar')
   dimensions%arcl(1:4) = [25.0_wp, 29.999999999_wp, 0.0_wp, 5.0_wp]
   call prove_turn()
   call opens_between(269.99948753094754_wp, 270.00051246905246_wp, 1, cause_link, 'slider-crank, rod a little too short')
   call load_case('dyad3_quick_return', problem, set)
   dimensions = problem%given
   dimensions%arcl(1:4) = [50.0_wp, 40.000000001_wp, 0.0_wp, 90.0_wp]
   dimensions%gama(4) = frame_angle
   call prove_turn()
   call opens_between(200.24975842020104_wp, 200.25024157979896_wp, 1, cause_guide, 'slotted lever, guide a little too long')
   call load_case('dwell', problem, set)
   dimensions = problem%given
   dimensions%arcl(problem%mechanism%seq(2, 3)) = 1.994360047547_wp
   call prove_turn()
   call opens_between(285.69600625172651_wp, 285.69701500315786_wp, 2, cause_too_short, 'six-bar with a dwell, dyad short')
   call load_case('needle', problem, set)
   dimensions = problem%given
   call prove_turn()
   call t%is_true(proof%closes_everywhere(), 'the needle linkage turns fully')
   call t%is_true(proof%fine_boxes == 0 .and. proof%boxes <= 16, 'a wide margin is proven in few boxes')
   call check_extremes()
   call check_parallelogram()

   do k = 1, size(names)
      call agrees_with_samples(names(k))
   end do
   call agrees_with_samples('quick_return')
   call agrees_with_samples('four_bar_haines')
   call t%report()

contains

   !> The crank-rocker of `data/` with other lengths.
   subroutine four_bar(lengths)
      real(wp), intent(in) :: lengths(4)

      dimensions = problem%given
      dimensions%arcl(1:4) = lengths
      dimensions%gama(4) = frame_angle
      call prove_turn()
   end subroutine four_bar

   subroutine prove_turn()
      call prove(0.0_wp, full_turn)
   end subroutine prove_turn

   subroutine prove(from, to)
      real(wp), intent(in) :: from, to
      type(proof_linkage_t) :: linkage
      type(plan_t) :: plan

      plan = make_plan(problem%mechanism, problem%motion, everything=.true., all_roots=.false.)
      call prepare_proof(problem%mechanism, plan, linkage)
      call bind_proof(plan, dimensions, linkage)
      call prove_closure(linkage, from, to, proof)
   end subroutine prove

   !> Transmission angles in degrees, computed in 50 digits, and what the lengths alone say of tolerances.
   subroutine check_extremes()
      type(proof_linkage_t) :: linkage
      type(proven_extreme_t), allocatable :: extremes(:)
      type(plan_t) :: plan
      real(wp) :: tolerance
      integer :: boxes(2)

      ! the needle linkage
      call prove_turn()
      plan = make_plan(problem%mechanism, problem%motion, everything=.true., all_roots=.false.)
      call prepare_proof(problem%mechanism, plan, linkage)
      call bind_proof(plan, dimensions, linkage)
      call prove_extremes(linkage, proof, extremes, boxes)
      call t%equal_integer(size(extremes), 4, 'the needle linkage has four transmission angles')
      call holds(extremes(1), 55.629566864372296_wp, 58.3591_wp, 82.296817292824374_wp, 238.3591_wp, 'loop 1')
      call holds(extremes(2), 55.435241336673324_wp, 91.9525_wp, 135.85560262535641_wp, 271.9525_wp, 'loop 2')
      call holds(extremes(3), 62.013712565713751_wp, 165.465584877_wp, 111.17352686010631_wp, 266.072665573_wp, 'loop 3')
      call holds(extremes(4), 78.870740311878348_wp, 334.454869784_wp, 85.867085518809795_wp, 157.893040857_wp, 'loop 4')
      call check_movement(linkage)
      ! a crank-rocker: the sum of crank and frame is 18.88391998183876 short of the links, which four deviations close
      call load_case('dyad1_crank_rocker', problem, set)
      call four_bar([30.0_wp, 60.0_wp, 68.88391998183876_wp, 80.0_wp])
      call prepare_proof(problem%mechanism, plan_of(), linkage)
      call bind_proof(plan_of(), dimensions, linkage)
      call prove_extremes(linkage, proof, extremes, boxes)
      call holds(extremes(1), 45.0_wp - 1.0e-15_wp, 200.25_wp, 117.01780160191131_wp, 20.25_wp, 'crank-rocker')
      call prove_tolerance(linkage, 0.0_wp, full_turn, 8.0_wp, tolerance)
      call t%is_true(tolerance <= 18.88391998183876_wp/4.0_wp, 'no tolerance is proven at which the linkage opens')
      call t%is_true(tolerance >= 18.88391998183876_wp/4.0_wp - 0.01_wp, 'a tolerance is proven that is hardly less')
   end subroutine check_extremes

   !> Rates and dead points of the needle linkage, computed in 50 digits, and the strokes of a crank-rocker.
   subroutine check_movement(linkage)
      type(proof_linkage_t), intent(inout) :: linkage
      type(movement_t) :: movement
      type(proven_dead_point_t), allocatable :: own(:)
      real(wp), parameter :: dead_of_p(4) = [7.8084731752614_wp, 87.578210292501_wp, 147.79448573772_wp, 260.03221795726_wp]
      real(wp), parameter :: dead_of_q(4) = [11.798387991037_wp, 50.39894978684_wp, 156.37903747427_wp, 312.9502531781_wp]
      real(wp), parameter :: least = -0.0881349872442579_wp, greatest = 0.097646273426758_wp

      call prove_movement(linkage, proof, 0.0_wp, movement)
      own = pack(movement%dead, movement%dead%kind == quantity_turning .and. movement%dead%loop == 4)
      call t%equal_integer(count(movement%dead%kind == quantity_turning), 22, 'the needle linkage has 22 dead points of its links')
      call are_at(own(:size(own)/2), dead_of_p, 'needle linkage, first link of loop 4')
      call are_at(own(size(own)/2 + 1:), dead_of_q, 'needle linkage, second link of loop 4')
      ! as the output
      linkage%output_motion = motion_angle
      linkage%output_arc = problem%mechanism%groups(4)%members(2)
      call prove_movement(linkage, proof, 0.0_wp, movement)
      call are_at(pack(movement%dead, movement%dead%kind == quantity_output), dead_of_q, 'needle linkage, the same as output')
      associate (ratio => movement%ratio)
         call t%is_true(ratio(1)%low <= least .and. least <= ratio(1)%high .and. ratio(2)%low <= greatest .and. &
                        greatest <= ratio(2)%high, 'extremes of a velocity ratio')
         call t%is_true(maxval(ratio%high - ratio%low) <= 1.0e-11_wp, 'extremes of a velocity ratio: brackets are narrow')
         call t%is_true(abs(ratio(1)%at - 191.4524007_wp) <= 1.0e-6_wp .and. abs(ratio(2)%at - 118.4596521_wp) <= 1.0e-6_wp, &
                        'places of the extremes of a velocity ratio')
      end associate
      call t%is_true(.not. movement%has_time_ratio, 'an output with four dead points has no time ratio')
   end subroutine check_movement

   !> The coupler of a parallelogram does not turn: nothing is said of its reversals there. Between the change points, where its
   !> links cross, crank and rocker are parallel once, and there it reverses.
   subroutine check_parallelogram()
      type(proof_linkage_t) :: linkage
      type(movement_t) :: movement
      type(proven_dead_point_t), allocatable :: own(:)
      real(wp), parameter :: crank = 30.0_wp, frame = 80.0_wp
      logical, allocatable :: of_coupler(:)

      call load_case('dyad1_crank_rocker', problem, set)
      call four_bar([crank, frame, crank, frame])
      call t%equal_integer(count(proof%limits%touch == touch_exact), 2, 'a parallelogram has two change points')
      call prepare_proof(problem%mechanism, plan_of(), linkage)
      call bind_proof(plan_of(), dimensions, linkage)
      call prove_movement(linkage, proof, 0.0_wp, movement)
      associate (dead => movement%dead, limits => proof%limits)
         of_coupler = dead%kind == quantity_turning .and. dead%place == 2
         own = pack(dead, of_coupler .and. dead%reverses)
         call are_at(own, [frame_angle + acos(-crank/frame)/radians_per_degree], 'parallelogram, coupler')
         own = pack(dead, of_coupler .and. .not. dead%reverses)
         call t%is_true(any(own%low <= limits(1)%from .and. own%high >= limits(1)%to) .and. &
                        any(own%low <= limits(5)%from .and. own%high >= limits(5)%to), &
                        'parallelogram: a coupler that does not turn has no sign of its rate')
      end associate
   end subroutine check_parallelogram

   !> Dead points that reverse lie in narrow brackets round given inputs, and no others.
   subroutine are_at(dead, inputs, what)
      type(proven_dead_point_t), intent(in) :: dead(:)
      real(wp), intent(in) :: inputs(:)
      character(*), intent(in) :: what
      real(wp), parameter :: digits = 2.0e-12_wp, narrow = 1.0e-9_wp !! degrees: of the inputs given; of the brackets

      call t%equal_integer(size(dead), size(inputs), what//': number of dead points')
      if (size(dead) /= size(inputs)) return
      call t%is_true(all(dead%reverses .and. dead%low <= inputs + digits .and. dead%high >= inputs - digits .and. &
                         dead%high - dead%low <= narrow), what//': brackets of dead points')
   end subroutine are_at

   type(plan_t) function plan_of()
      plan_of = make_plan(problem%mechanism, problem%motion, everything=.true., all_roots=.false.)
   end function plan_of

   !> The brackets hold the values, and are narrow.
   subroutine holds(extreme, least, least_at, greatest, greatest_at, what)
      type(proven_extreme_t), intent(in) :: extreme
      real(wp), intent(in) :: least, least_at, greatest, greatest_at
      character(*), intent(in) :: what
      real(wp), parameter :: narrow = 1.0e-10_wp, near = 2.0e-6_wp  !! degrees; an extreme is flat

      call t%is_true(extreme%least_low <= least .and. least <= extreme%least_high .and. extreme%least_high - extreme%least_low &
                     <= narrow, what//': least transmission angle')
      call t%is_true(extreme%greatest_low <= greatest .and. greatest <= extreme%greatest_high .and. &
                     extreme%greatest_high - extreme%greatest_low <= narrow, what//': greatest transmission angle')
      call t%is_true(abs(extreme%least_at - least_at) <= near .and. abs(extreme%greatest_at - greatest_at) <= near, &
                     what//': places of the extremes')
   end subroutine holds

   !> The full turn closes but for one part between two ends.
   subroutine opens_between(from, to, loop, cause, what)
      real(wp), intent(in) :: from, to
      integer, intent(in) :: loop, cause
      character(*), intent(in) :: what

      call t%equal_integer(size(proof%limits), 5, what//': closes, opens, closes, with two brackets')
      if (size(proof%limits) /= 5) return
      call t%is_true(all(proof%limits%kind == [piece_closes, piece_undecided, piece_opens, piece_undecided, piece_closes]), &
                     what//': closes, opens, closes')
      call t%is_true(proof%limits(3)%loop == loop .and. proof%limits(3)%cause == cause, what//': loop and cause')
      call t%is_true(abs(proof%limits(3)%from - from) <= one_ulp .and. abs(proof%limits(3)%to - to) <= one_ulp, what//': ends')
      call t%is_true(all(proof%limits([2, 4])%to - proof%limits([2, 4])%from <= 1.0e-15_wp*full_turn), what//': brackets')
   end subroutine opens_between

   !> The proof and the positions of the engine agree on whether the linkage closes.
   subroutine agrees_with_samples(name)
      character(*), intent(in) :: name
      integer, parameter :: samples = 361
      type(problem_t) :: fine
      type(motion_t) :: motion
      real(wp) :: inputs(samples), from, to
      integer :: i, wrong, open
      logical :: proven

      call load_case(name, problem, set)
      dimensions = problem%given
      from = 0.0_wp
      to = full_turn
      if (problem%mechanism%sliding_input) then
         from = dimensions%crnki + minval(problem%delt)
         to = dimensions%crnki + maxval(problem%delt)
      end if
      inputs = [(from + (to - from)*(real(i, wp) - 0.5_wp)/real(samples, wp), i=1, samples)]
      call new_problem(problem%mechanism, dimensions, problem%parameters, inputs - dimensions%crnki, .true., fine)
      call fine%analyse(dimensions, motion)
      call prove(from, to)
      wrong = 0
      open = 0
      do i = 1, samples
         proven = proof%closes_at(inputs(i)) > 0
         if (proven .neqv. motion%closed(i)) wrong = wrong + 1
         if (.not. proven) open = open + 1
      end do
      call t%equal_integer(wrong, 0, trim(name)//': proof and samples agree')
      call t%is_true(maxval(proof%limits%to - proof%limits%from, mask=proof%limits%kind == piece_undecided) &
                     <= 1.0e-15_wp*max(abs(from), abs(to)) + 1.0e-13_wp, trim(name)//': brackets are narrow')
   end subroutine agrees_with_samples

   !> Random models: every value in quadruple precision lies within the radius.
   subroutine check_arithmetic()
      integer, parameter :: trials = 300
      type(xoshiro_t) :: stream
      real(wp), dimension(lanes, 0:degree) :: a, b, c, y
      real(wp), dimension(lanes) :: e, tail, zero, low, high, na, nb, m, r
      real(qp) :: s, x, cosine, sine
      integer :: trial, i, j, outside(5)

      call stream%seed(20, 1)
      outside = 0
      zero = 0.0_wp
      do trial = 1, trials
         do j = 0, degree
            do i = 1, lanes
               a(i, j) = uniform(stream, -1.0_wp, 1.0_wp)*0.4_wp**j
               b(i, j) = uniform(stream, -1.0_wp, 1.0_wp)*0.4_wp**j
            end do
         end do
         do i = 1, lanes
            m(i) = uniform(stream, -full_turn, full_turn)
            r(i) = 22.5_wp*uniform(stream, 0.0_wp, 1.0_wp)**4
         end do
         call multiply(a, b, c, tail)
         call norm_of(a, na)
         call norm_of(b, nb)
         e = tail + rounding*na*nb
         call compare(1, a, b, c, e, outside(1))
         call range_of(a, zero, low, high)
         a(:, 0) = a(:, 0) + max(0.0_wp, 10.0_wp**(-1 - 12*modulo(trial, 2)) - low)
         call range_of(a, zero, low, high)
         call reciprocal(a, zero, low, c, e)
         call compare(2, a, b, c, e, outside(2))
         call square_root(a, zero, low, c, e)
         call compare(3, a, b, c, e, outside(3))
         call turn_crank(m, r, c, y, e)
         do i = 1, lanes
            do j = 1, places
               s = place(j)
               x = value_at(a, i, s)
               if (x < real(low(i), qp) .or. x > real(high(i), qp)) outside(4) = outside(4) + 1
               call unit_vector_quad(real(m(i), qp) + real(r(i), qp)*s, cosine, sine)
               if (hypot(value_at(c, i, s) - cosine, value_at(y, i, s) - sine) > real(e(i), qp)) outside(5) = outside(5) + 1
            end do
         end do
      end do
      call t%equal_integer(outside(1), 0, 'products lie within their radii')
      call t%equal_integer(outside(2), 0, 'reciprocals lie within their radii')
      call t%equal_integer(outside(3), 0, 'square roots lie within their radii')
      call t%equal_integer(outside(4), 0, 'values lie within the bounds of a model')
      call t%equal_integer(outside(5), 0, 'the crank lies within its radius')
   end subroutine check_arithmetic

   !> A random number between two others.
   real(wp) function uniform(stream, low, high)
      type(xoshiro_t), intent(inout) :: stream
      real(wp), intent(in) :: low, high

      call stream%next(uniform)
      uniform = low + (high - low)*uniform
   end function uniform

   pure real(qp) function place(j)
      integer, intent(in) :: j

      place = -1.0_qp + 2.0_qp*real(j - 1, qp)/real(places - 1, qp)
   end function place

   pure real(qp) function value_at(p, i, s)
      real(wp), intent(in) :: p(lanes, 0:degree)
      integer, intent(in) :: i
      real(qp), intent(in) :: s
      integer :: k

      value_at = 0.0_qp
      do k = degree, 0, -1
         value_at = value_at*s + real(p(i, k), qp)
      end do
   end function value_at

   !> Count what lies outside the radius of c: a product (1), a reciprocal (2), a square root (3).
   subroutine compare(which, a, b, c, e, outside)
      integer, intent(in) :: which
      real(wp), intent(in), dimension(lanes, 0:degree) :: a, b, c
      real(wp), intent(in) :: e(lanes)
      integer, intent(inout) :: outside
      real(qp) :: exact, s
      integer :: i, j

      do i = 1, lanes
         do j = 1, places
            s = place(j)
            select case (which)
            case (1)
               exact = value_at(a, i, s)*value_at(b, i, s)
            case (2)
               exact = 1.0_qp/value_at(a, i, s)
            case default
               exact = sqrt(value_at(a, i, s))
            end select
            if (abs(value_at(c, i, s) - exact) > real(e(i), qp)) outside = outside + 1
         end do
      end do
   end subroutine compare

   !> Signs of sums where plain addition is wrong.
   subroutine check_sums()
      call t%equal_integer(sign_of_sum([1.0_wp, 1.0e-30_wp, -1.0_wp]), 1, 'a small term decides')
      call t%equal_integer(sign_of_sum([1.0e-30_wp, 1.0_wp, -1.0_wp, -1.0e-30_wp]), 0, 'terms that cancel')
      call t%equal_integer(sign_of_sum([1.0_wp, epsilon(1.0_wp)/4.0_wp, epsilon(1.0_wp)/4.0_wp, -1.0_wp, -epsilon(1.0_wp)]), -1, &
                           'terms that vanish beside the others decide together')
   end subroutine check_sums
end program test_proof
