!> The dimensions of a sketch as unknowns of an optimisation problem, solved in the poses of its links: any Assur groups and drives.
!>
!> A dimension that varies moves a joint in the axes of its link: along the line from another joint (a length), round that joint
!> (an angle), or, on the frame, both. To new dimensions the assembly of the drawing is followed as it is to new inputs, by
!> prediction and correction in steps that halve themselves. Derivatives by a dimension are rates while it alone changes; those
!> of rates by the input follow from rates along sums of both (polarisation of the second and third derivative).
!>
!> With free timing (IFREE) the input of every position is one more unknown. With IRANGE constraints hold over the range of the
!> first drive too, which is followed from the drawing in either direction.
module psalm_chain_problem
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_chain_motion, only: chain_motion_t, advance, follow, differentiate, try_step, senses, easy, first_step, least_step
   use psalm_chain_outputs, only: output_at
   use psalm_closure, only: closure_t, state_t, most_orders, matrix_of, place_points, row_pin
   use psalm_clearances, only: clearance_t, list_sketch_clearances, find_depth, points_of_clearance
   use psalm_constraint_group, only: range_positions, range_turn
   use psalm_data_set, only: data_set_t
   use psalm_dense, only: factors_t, factorise
   use psalm_equalities, only: equal_numbers_t, relations_of, miss_of
   use psalm_error, only: desired_of
   use psalm_kinds, only: wp, full_turn, half_turn, right_angle, radians_per_degree, degrees_per_radian
   use psalm_merit, only: extra_positions, least_margin, put_in_order
   use psalm_nlp, only: plain_nlp_t
   use psalm_similarity, only: similarity_t, fit_similarity, errors_of, take_out_similarity
   use psalm_search_group, only: order_free
   use psalm_sketch, only: sketch_t, variation_t, columns_of, first_number, frame_link, most_targets, drive_turns, &
                           output_angle, output_between, output_pose, output_ratio, vary_angle, vary_input, vary_length, vary_place
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: chain_problem_t, make_chain_problem, unknown_name

   real(wp), parameter :: nudge = 1.0e-5_wp   !! of an unknown, for the slope of that margin
   real(wp), parameter :: rounding = 1.0e-9_wp !! of the drawing's size: deviations that are none
   real(wp), parameter :: far = 1.0e4_wp      !! of the drawing's size: the residual of a position that cannot be reached
   integer, parameter :: absolute = 0         !! in place of an anchor: the machine origin
   integer, parameter :: range_steps = 60     !! in which a search looks at the range of the input: 6 degrees of a turn
   integer, parameter :: fine_steps = 720     !! in which what it found is inspected: half a degree
   real(wp), parameter :: inside = 0.1_wp     !! of the drawing's size: constraints over the range kept by more get no slopes
   real(wp), parameter :: slack = 1.0e-7_wp   !! of the drawing's size: constraints over the range aim so far inside their limits,
                                              !! for between its steps the margin may be a little less
   integer, parameter :: of_whole = 2         !! constraints of the whole motion: its positions and its range are reached

   !> A joint that moves in the axes of its link: from an anchor by a length in a direction.
   type :: moved_t
      integer :: link = 0, joint = 0
      integer :: anchor = absolute
      real(wp) :: length = 0.0_wp, direction = 0.0_wp !! as drawn; radians, in the axes of the link
      integer :: of_length = 0                !! unknown that is its length; 0: fixed
      integer :: of_angle = 0                 !! unknown that its direction is counted by
      integer :: base(2) = 0                  !! joints of the line that this angle is counted from; 0: the x axis
   end type moved_t

   !> Two links that are pinned to each other, and to others: their transmission angle is that between them.
   type :: link_pair_t
      integer :: inner = 0, outer(2) = 0      !! joints
   end type link_pair_t

   type, extends(plain_nlp_t) :: chain_problem_t
      type(closure_t) :: drawn
      type(state_t) :: start                  !! at the drawing
      type(moved_t), allocatable :: moved(:)
      integer :: variables = 0                !! of the core unknowns: the dimensions; with free timing inputs follow
      real(wp), allocatable :: first(:)       !! shape (core): values of the drawing; angles in degrees
      integer :: of_input = 0                 !! unknown that is the reference input; 0: fixed
      real(wp), allocatable :: inputs(:, :)   !! shape (drives, positions): radians or length, from the drawing
      real(wp), allocatable :: speed(:)       !! shape (drives): change with the first one
      real(wp) :: unit_of_input = 1.0_wp      !! radians a degree, if the first drive turns
      real(wp), allocatable :: wanted(:, :, :), weight(:, :, :) !! shape (numbers, 0:most_targets, positions)
      logical, allocatable :: angle(:)        !! shape (numbers): it is one
      logical, allocatable :: ratio(:)        !! shape (numbers): it is a ratio of rates
      integer, allocatable :: ratio_of(:, :)  !! shape (2, numbers): the numbers whose rates it is of
      type(equal_numbers_t), allocatable :: relations(:) !! numbers that are to be equal
      integer :: highest = 0                  !! derivative that is prescribed
      type(clearance_t), allocatable :: clearances(:) !! their points are joints of the sketch
      real(wp), allocatable :: margin(:)      !! shape (groups): how far from a dead point each must keep
      type(link_pair_t), allocatable :: pairs(:) !! whose transmission angle has a limit
      real(wp) :: cosine = 1.0_wp             !! of the least transmission angle
      real(wp), allocatable :: delt(:)        !! shape (positions): increments of the first drive, degrees or length
      logical :: free = .false.               !! the inputs of the positions are unknowns
      logical :: ordered = .false.            !! they follow each other
      real(wp) :: sense = 1.0_wp              !! in this direction
      real(wp) :: span = huge(1.0_wp)         !! most between the first and the last
      integer :: irange = range_positions     !! IRANGE
      real(wp), allocatable :: between(:)     !! shape (any): increments over the range at which constraints hold too
      logical :: similar = .false.            !! place, size and direction of the desired points are free
      logical :: looks_between = .true.       !! they count, and the order of free inputs
   contains
      procedure :: project
      procedure :: at_positions
      procedure :: increments
      procedure :: set_range
      procedure :: find_violations
      procedure :: find_path
      procedure :: residuals_at
      procedure :: find_similarity
      procedure :: find_equals
      procedure :: constraints_at
      procedure :: find_motion
      procedure :: find_values
      procedure :: dimensioned
      procedure :: is_length
      procedure :: shape_point
      procedure :: settle_signs
   end type chain_problem_t

contains

   !> Make the problem of a sketch that was assembled. Not empty `failure` says, with the number of the variable, what it cannot do.
   subroutine make_chain_problem(set, closure, start, inputs, problem, failure, which)
      type(data_set_t), intent(in) :: set
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: start
      real(wp), intent(in) :: inputs(:, :)    !! shape (drives, positions): radians or length, from the drawing
      type(chain_problem_t), intent(out) :: problem
      character(:), allocatable, intent(out) :: failure
      integer, intent(out) :: which           !! the variable that cannot vary so; 0: none
      integer :: n, v

      failure = ''
      which = 0
      problem%drawn = closure
      problem%start = start
      problem%inputs = inputs
      associate (drives => set%sketch%drives)
         problem%unit_of_input = merge(radians_per_degree, 1.0_wp, drives(1)%kind == drive_turns)
         allocate (problem%speed(size(drives)), source=0.0_wp)
         problem%speed(1) = 1.0_wp
         do n = 2, size(drives)
            if (.not. drives(n)%geared) cycle
            problem%speed(n) = drives(n)%ratio/problem%unit_of_input
            if (drives(n)%kind == drive_turns) problem%speed(n) = problem%speed(n)*radians_per_degree
         end do
      end associate
      allocate (problem%moved(0), problem%first(0), problem%low(0), problem%high(0))
      do v = 1, size(set%sketch%variations)
         call add_variation(set%sketch%variations(v))
         if (len(failure) > 0) then
            which = v
            return
         end if
      end do
      problem%variables = size(problem%first)
      call take_timing()
      problem%core = size(problem%first)
      call take_targets(set, problem)
      problem%similar = set%method%isim /= 0
      call list_sketch_clearances(set%constr, set%sketch, problem%clearances)
      problem%margin = least_margin*margins_of(closure, start)
      call list_pairs(set%limits%tangle)
      call problem%set_range(problem%first)
      call count_constraints(problem)
      problem%has_gradient = .true.
      problem%is_sum_of_squares = .true.
      problem%scale = [(change_of(v), v=1, problem%core)]
      problem%floor = (rounding*closure%size)**2
      problem%small = problem%floor

   contains

      !> What is asked of the inputs; with free timing they are unknowns.
      subroutine take_timing()
         integer :: n

         n = size(inputs, 2)
         allocate (problem%delt(n), source=0.0_wp)
         if (set%method%ikin == 0) problem%delt = set%method%delt
         problem%irange = set%constr%irange
         problem%free = set%method%ifree /= 0
         problem%ordered = problem%free .and. set%search%order /= order_free
         if (n > 1) problem%sense = sign(1.0_wp, problem%delt(2) - problem%delt(1))
         if (set%sketch%drives(1)%kind == drive_turns) problem%span = full_turn
         if (.not. problem%free) return
         problem%first = [problem%first, problem%delt]
         problem%low = [problem%low, spread(-huge(1.0_wp), 1, n)]
         problem%high = [problem%high, spread(huge(1.0_wp), 1, n)]
      end subroutine take_timing

      !> Dyads of two links and three pins, if TANGLE limits their transmission angle.
      subroutine list_pairs(tangle)
         real(wp), intent(in) :: tangle        !! degrees
         type(link_pair_t) :: one
         real(wp) :: unused
         integer :: g, k, outer

         allocate (problem%pairs(0))
         if (tangle >= right_angle) return
         call unit_vector(right_angle - tangle, problem%cosine, unused)
         do g = 1, size(closure%groups)
            associate (group => closure%groups(g))
               if (size(group%links) /= 2 .or. size(group%rows) /= 3) cycle
               if (any(group%rows%kind /= row_pin)) cycle
               one = link_pair_t()
               outer = 0
               do k = 1, size(group%rows)
                  if (any(group%rows(k)%links(1) == group%links) .and. any(group%rows(k)%links(2) == group%links)) then
                     one%inner = group%rows(k)%which
                  else
                     outer = min(outer + 1, size(one%outer))
                     one%outer(outer) = group%rows(k)%which
                  end if
               end do
               if (one%inner == 0 .or. outer /= size(one%outer) .or. any(one%outer == one%inner)) cycle
               problem%pairs = [problem%pairs, one]
            end associate
         end do
      end subroutine list_pairs

      !> A change that is noticed.
      real(wp) function change_of(unknown)
         integer, intent(in) :: unknown
         real(wp), parameter :: degrees = 5.0_wp, part = 0.02_wp

         change_of = merge(part*closure%size, degrees, problem%is_length(unknown))
      end function change_of

      subroutine add_unknown(value, low, high, bounded, number)
         real(wp), intent(in) :: value, low, high
         logical, intent(in) :: bounded
         integer, intent(out) :: number

         problem%first = [problem%first, value]
         problem%low = [problem%low, merge(low, -huge(1.0_wp), bounded)]
         problem%high = [problem%high, merge(high, huge(1.0_wp), bounded)]
         number = size(problem%first)
      end subroutine add_unknown

      subroutine add_variation(one)
         type(variation_t), intent(in) :: one
         integer :: at, link
         complex(wp) :: line

         select case (one%kind)
         case (vary_input)
            call add_unknown(set%method%crnki, one%low(1), one%high(1), one%bounded, problem%of_input)
         case (vary_length)
            link = common_link(one%joints(:2))
            call find_moved(link, one%joints(1), one%joints(2), at)
            if (at == 0) return
            call add_unknown(problem%moved(at)%length, one%low(1), one%high(1), one%bounded, problem%moved(at)%of_length)
         case (vary_angle)
            link = common_link(one%joints)
            call find_moved(link, one%joints(3), one%joints(4), at)
            if (at == 0) return
            problem%moved(at)%base = one%joints(:2)
            line = closure%point(one%joints(2), link) - closure%point(one%joints(1), link)
            call add_unknown(near_bounds(problem%moved(at)%direction*degrees_per_radian - degrees_of(line%re, line%im), one), &
                             one%low(1), one%high(1), one%bounded, problem%moved(at)%of_angle)
         case (vary_place)
            call find_moved(frame_link, pivot(one%joints(1)), one%joints(1), at)
            if (at == 0) return
            call add_unknown(problem%moved(at)%length, one%low(1), one%high(1), one%bounded, problem%moved(at)%of_length)
            call add_unknown(near_bounds(problem%moved(at)%direction*degrees_per_radian, one), one%low(2), one%high(2), &
                             one%bounded, problem%moved(at)%of_angle)
         end select
      end subroutine add_variation

      !> An angle within half a turn of 0, or of the middle of its bounds.
      pure real(wp) function near_bounds(angle, one)
         real(wp), intent(in) :: angle         !! degrees
         type(variation_t), intent(in) :: one
         real(wp) :: middle
         integer :: last

         middle = 0.0_wp
         last = merge(2, 1, one%kind == vary_place)
         if (one%bounded) middle = 0.5_wp*(one%low(last) + one%high(last))
         near_bounds = angle - full_turn*anint((angle - middle)/full_turn)
      end function near_bounds

      !> What the place of a joint of the frame is counted from: the first drive's joint, if that is another one of the frame.
      integer function pivot(joint)
         integer, intent(in) :: joint

         pivot = set%sketch%drives(1)%joint
         if (pivot == 0) pivot = absolute
         if (pivot == joint) pivot = absolute
         if (pivot /= absolute) then
            if (.not. set%sketch%has_joint(frame_link, pivot)) pivot = absolute
         end if
      end function pivot

      integer function common_link(joints) result(link)
         integer, intent(in) :: joints(:)
         integer :: j

         do link = 1, size(set%sketch%links)
            if (all([(set%sketch%has_joint(link, joints(j)), j=1, size(joints))])) return
         end do
         link = 0
      end function common_link

      !> The entry of a moved joint, made if it is not there.
      subroutine find_moved(link, anchor, joint, at)
         integer, intent(in) :: link, anchor, joint
         integer, intent(out) :: at
         complex(wp) :: h

         do at = 1, size(problem%moved)
            if (problem%moved(at)%link == link .and. problem%moved(at)%joint == joint) exit
         end do
         if (at <= size(problem%moved)) then
            if (problem%moved(at)%anchor == anchor) return
            failure = 'joint '//name(joint)//' of link '//trim(set%sketch%links(link)%name)// &
                      ' is moved from two other joints; count both variables from one of them'
            at = 0
            return
         end if
         if (closure%cylinder(link) > 0) then
            failure = 'the length of a cylinder is driven and cannot vary'
            at = 0
            return
         end if
         h = closure%point(joint, link)
         if (anchor /= absolute) h = h - closure%point(anchor, link)
         problem%moved = [problem%moved, moved_t(link, joint, anchor, abs(h), degrees_of(h%re, h%im)*radians_per_degree)]
         at = size(problem%moved)
         if (leads_to(anchor, link, joint)) then
            failure = 'joint '//name(joint)//' is counted from '//name(anchor)//', and that in the end from '//name(joint)
            at = 0
         end if
      end subroutine find_moved

      !> True if the anchor hangs on the joint.
      logical function leads_to(anchor, link, joint)
         integer, intent(in) :: anchor, link, joint
         integer :: here, k, round

         leads_to = .false.
         here = anchor
         do round = 1, size(problem%moved)
            do k = 1, size(problem%moved)
               if (problem%moved(k)%link /= link .or. problem%moved(k)%joint /= here) cycle
               here = problem%moved(k)%anchor
               exit
            end do
            leads_to = leads_to .or. here == joint
         end do
      end function leads_to

      pure function name(joint)
         integer, intent(in) :: joint
         character(:), allocatable :: name

         name = 'the machine origin'
         if (joint /= absolute) name = trim(set%sketch%joint_name(joint))
      end function name
   end subroutine make_chain_problem

   !> True for an unknown that is a length, not an angle.
   pure logical function is_length(self, unknown)
      class(chain_problem_t), intent(in) :: self
      integer, intent(in) :: unknown

      is_length = any(self%moved%of_length == unknown) .or. &
                  (self%unit_of_input == 1.0_wp .and. (unknown == self%of_input .or. unknown > self%variables))
   end function is_length

   !> Desired values of &METHOD for the first output, and those of &OUTPUTS.
   subroutine take_targets(set, problem)
      type(data_set_t), intent(in) :: set
      type(chain_problem_t), intent(inout) :: problem
      real(wp), allocatable :: wanted(:, :), weight(:, :)
      integer, allocatable :: first(:)
      integer :: k, n, order, c, positions

      associate (outputs => set%sketch%outputs)
         positions = size(problem%inputs, 2)
         first = [(first_number(outputs, k), k=1, size(outputs))]
         n = first_number(outputs, size(outputs) + 1) - 1
         allocate (problem%wanted(n, 0:most_targets, positions), problem%weight(n, 0:most_targets, positions), source=0.0_wp)
         allocate (problem%angle(n), problem%ratio(n), source=.false.)
         allocate (problem%ratio_of(2, n), source=0)
         do k = 1, size(outputs)
            associate (last => first(k) + columns_of(outputs(k)) - 1)
               problem%angle(last) = any(outputs(k)%kind == [output_angle, output_between, output_pose])
               problem%ratio(last) = outputs(k)%kind == output_ratio
               if (problem%ratio(last)) problem%ratio_of(:, last) = first(outputs(k)%outputs)
               do order = 0, most_targets
                  if (.not. allocated(outputs(k)%targets(order)%values)) cycle
                  problem%wanted(first(k):last, order, :) = outputs(k)%targets(order)%values
                  problem%weight(first(k):last, order, :) = outputs(k)%targets(order)%weights
               end do
            end associate
         end do
         if (set%method%desired .and. size(outputs) > 0) then
            call desired_of(set, wanted, weight)
            do c = 1, min(size(wanted, 2), columns_of(outputs(1)))
               problem%wanted(c, 0, :) = wanted(:, c)
               problem%weight(c, 0, :) = weight(:, c)
               if (.not. allocated(set%method%rate_desired)) cycle
               do order = 1, most_targets
                  where (set%method%rate_weight(:, c, order) > 0.0_wp)
                     problem%wanted(c, order, :) = set%method%rate_desired(:, c, order)
                     problem%weight(c, order, :) = set%method%rate_weight(:, c, order)
                  end where
               end do
            end do
         end if
      end associate
      problem%relations = relations_of(set%sketch, size(problem%inputs, 2))
      call count_targets(problem)
   end subroutine take_targets

   pure subroutine count_targets(problem)
      type(chain_problem_t), intent(inout) :: problem
      integer :: order

      problem%residuals = count(problem%weight > 0.0_wp) + size(problem%relations)
      problem%highest = 0
      if (size(problem%relations) > 0) problem%highest = maxval(problem%relations%order)
      do order = 1, most_targets
         if (any(problem%weight(:, order, :) > 0.0_wp)) problem%highest = max(problem%highest, order)
      end do
   end subroutine count_targets

   pure subroutine count_constraints(problem)
      class(chain_problem_t), intent(inout) :: problem

      associate (n => size(problem%inputs, 2))
         problem%inequalities = of_whole + n + at_a_position(problem)*(n + size(problem%between))
      end associate
   end subroutine count_constraints

   !> The same problem at some of its positions, for prescribed timing.
   subroutine at_positions(self, which, part)
      class(chain_problem_t), intent(in) :: self
      integer, intent(in) :: which(:)
      type(chain_problem_t), intent(out) :: part

      part = self
      part%inputs = self%inputs(:, which)
      deallocate (part%wanted, part%weight)
      allocate (part%wanted(size(self%angle), 0:most_targets, size(which)), source=self%wanted(:, :, which))
      allocate (part%weight(size(self%angle), 0:most_targets, size(which)), source=self%weight(:, :, which))
      part%delt = self%delt(which)
      call count_targets(part)
      call part%set_range(part%first)
      call count_constraints(part)
   end subroutine at_positions

   !> Name of an unknown for a listing, as it is written in VARY.
   function unknown_name(sketch, unknown) result(text)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: unknown
      character(:), allocatable :: text
      integer :: v, n, j

      text = to_text(unknown)
      n = 0
      do v = 1, size(sketch%variations)
         associate (one => sketch%variations(v))
            n = n + merge(2, 1, one%kind == vary_place)
            if (n < unknown) cycle
            select case (one%kind)
            case (vary_input)
               text = 'input'
               return
            case (vary_angle)
               text = 'angle'
            case (vary_place)
               text = merge('direction of', 'distance of ', n == unknown)
            case default
               text = 'length'
            end select
            do j = 1, size(one%joints)
               if (one%joints(j) > 0) text = trim(text)//' '//trim(sketch%joint_name(one%joints(j)))
            end do
            return
         end associate
      end do
   end function unknown_name

   ! ---- dimensions --------------------------------------------------------------------------------------------------

   !> Give a closure the dimensions x. With `rate` they change, and places have derivatives.
   subroutine dimensioned(self, x, closure, rate)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)              !! shape (core)
      type(closure_t), intent(inout) :: closure
      real(wp), intent(in), optional :: rate(size(x))
      complex(wp) :: p(0:most_orders)
      integer :: k

      if (present(rate) .and. .not. allocated(closure%point_rate)) &
         allocate (closure%point_rate(size(closure%point, 1), size(closure%point, 2), most_orders))
      if (allocated(closure%point_rate)) closure%point_rate = (0.0_wp, 0.0_wp)
      do k = 1, size(self%moved)
         associate (one => self%moved(k))
            p = self%shape_point(one%link, one%joint, x, rate)
            closure%point(one%joint, one%link) = p(0)
            if (present(rate)) closure%point_rate(one%joint, one%link, :) = p(1:)
         end associate
      end do
   end subroutine dimensioned

   !> Place of a joint in the axes of its link and the derivatives of that, from dimensions and their rates.
   pure recursive function shape_point(self, link, joint, x, rate) result(p)
      class(chain_problem_t), intent(in) :: self
      integer, intent(in) :: link, joint
      real(wp), intent(in) :: x(:)              !! shape (core)
      real(wp), intent(in), optional :: rate(size(x))
      complex(wp) :: p(0:most_orders)
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      complex(wp) :: e
      real(wp) :: length(0:1), angle(0:1), c, s
      integer :: k

      p = (0.0_wp, 0.0_wp)
      if (joint == absolute) return
      do k = 1, size(self%moved)
         if (self%moved(k)%link == link .and. self%moved(k)%joint == joint) exit
      end do
      if (k > size(self%moved)) then
         p(0) = self%drawn%point(joint, link)
         return
      end if
      associate (one => self%moved(k))
         length = [one%length, 0.0_wp]
         if (one%of_length > 0) then
            length(0) = x(one%of_length)
            if (present(rate)) length(1) = rate(one%of_length)
         end if
         call direction_of(self, link, one%anchor, joint, x, angle, rate)
         call unit_vector(angle(0)*degrees_per_radian, c, s)
         e = cmplx(c, s, wp)
         p = self%shape_point(link, one%anchor, x, rate)
         p(0) = p(0) + length(0)*e
         p(1) = p(1) + (length(1) + i*angle(1)*length(0))*e
         p(2) = p(2) + (2.0_wp*i*angle(1)*length(1) - angle(1)**2*length(0))*e
         p(3) = p(3) - (3.0_wp*angle(1)**2*length(1) + i*angle(1)**3*length(0))*e
      end associate
   end function shape_point

   !> Tell a linkage by positive lengths and angles nearest to 0, or to the middle of their bounds, where the bounds allow: a length
   !> backwards in a direction is that length in the opposite one, from which other angles may be counted.
   pure subroutine settle_signs(self, x)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(inout) :: x(:)           !! shape (core)
      real(wp) :: turned(size(x))
      integer :: k, m

      do k = 1, size(self%moved)
         associate (one => self%moved(k))
            if (one%of_length == 0 .or. one%of_angle == 0) cycle
            if (x(one%of_length) >= 0.0_wp) cycle
            turned = x
            turned(one%of_length) = -x(one%of_length)
            turned(one%of_angle) = x(one%of_angle) + half_turn
            do m = 1, size(self%moved)
               associate (other => self%moved(m))
                  if (m == k .or. other%link /= one%link .or. other%of_angle == 0) cycle
                  if (all(other%base == [one%anchor, one%joint]) .or. all(other%base == [one%joint, one%anchor])) &
                     turned(other%of_angle) = turned(other%of_angle) + half_turn
               end associate
            end do
            call unwind(turned)
            if (all(turned >= self%low .and. turned <= self%high)) x = turned
         end associate
      end do
      turned = x
      call unwind(turned)
      x = merge(turned, x, turned >= self%low .and. turned <= self%high)

   contains

      !> Full turns of angles are none.
      pure subroutine unwind(values)
         real(wp), intent(inout) :: values(:)
         real(wp) :: middle
         integer :: n

         do n = 1, size(self%moved)
            associate (v => self%moved(n)%of_angle)
               if (v == 0) cycle
               middle = 0.0_wp
               if (self%high(v) < huge(1.0_wp)) middle = 0.5_wp*(self%low(v) + self%high(v))
               values(v) = values(v) - full_turn*anint((values(v) - middle)/full_turn)
            end associate
         end do
      end subroutine unwind
   end subroutine settle_signs

   !> Direction of a line of a link and its rate, radians.
   pure recursive subroutine direction_of(self, link, from, to, x, angle, rate)
      class(chain_problem_t), intent(in) :: self
      integer, intent(in) :: link, from, to
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: angle(0:1)
      real(wp), intent(in), optional :: rate(size(x))
      complex(wp) :: h
      integer :: k

      angle = 0.0_wp
      do k = 1, size(self%moved)
         associate (one => self%moved(k))
            if (one%link /= link) cycle
            if (.not. ((one%joint == to .and. one%anchor == from) .or. (one%joint == from .and. one%anchor == to))) cycle
            angle(0) = one%direction
            if (one%of_angle > 0) then
               if (one%base(1) > 0) call direction_of(self, link, one%base(1), one%base(2), x, angle, rate)
               if (one%base(1) == 0) angle = 0.0_wp
               angle(0) = angle(0) + x(one%of_angle)*radians_per_degree
               if (present(rate)) angle(1) = angle(1) + rate(one%of_angle)*radians_per_degree
            end if
            if (one%joint == from) angle(0) = angle(0) + half_turn*radians_per_degree
            return
         end associate
      end do
      h = self%drawn%point(to, link) - self%drawn%point(from, link)
      angle(0) = degrees_of(h%re, h%im)*radians_per_degree
   end subroutine direction_of

   ! ---- motion ------------------------------------------------------------------------------------------------------

   !> Everything at all positions with the dimensions x; `reached` is false where the drawing's assembly ends on the way.
   subroutine find_motion(self, x, closure, motion, reached, drawing)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)              !! shape (core)
      type(closure_t), intent(out) :: closure
      type(chain_motion_t), intent(out) :: motion
      logical, intent(out) :: reached
      type(state_t), intent(out), optional :: drawing !! at the input of the drawing
      type(state_t) :: state
      real(wp) :: rate(size(self%inputs, 1), most_orders, size(self%inputs, 2))
      integer :: d

      closure = self%drawn
      state = self%start
      call change_dimensions(self, x, closure, state, reached)
      if (present(drawing)) drawing = state
      if (.not. reached) return
      rate = 0.0_wp
      do d = 1, size(self%inputs, 1)
         rate(d, 1, :) = self%speed(d)
      end do
      call follow(closure, state, inputs_at_positions(self, x), rate, motion)
      reached = all(motion%closed) .and. .not. any(motion%dead)
   end subroutine find_motion

   !> Increments of the first drive at the positions: those given, or unknowns. Shape (positions).
   pure function increments(self, x) result(delt)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)              !! shape (core)
      real(wp), allocatable :: delt(:)

      delt = self%delt
      if (self%free) delt = x(self%variables + 1:)
   end function increments

   !> Inputs of all drives at the positions, from the drawing.
   pure function inputs_at_positions(self, x) result(inputs)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)              !! shape (core)
      real(wp) :: inputs(size(self%inputs, 1), size(self%inputs, 2))
      integer :: d

      if (self%free) then
         inputs = inputs_at(self, x, self%increments(x))
         return
      end if
      do d = 1, size(inputs, 1)
         inputs(d, :) = self%inputs(d, :) + self%speed(d)*shift_of(self, x)*self%unit_of_input
      end do
   end function inputs_at_positions

   !> Inputs of all drives, from the drawing, at increments of the first one, to which all others are geared.
   pure function inputs_at(self, x, delt) result(inputs)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)              !! shape (core)
      real(wp), intent(in) :: delt(:)
      real(wp) :: inputs(size(self%inputs, 1), size(delt))
      integer :: d

      do d = 1, size(inputs, 1)
         inputs(d, :) = self%inputs(d, 1) + self%speed(d)*((delt - self%delt(1) + shift_of(self, x))*self%unit_of_input)
      end do
   end function inputs_at

   !> How far the reference input is from that of the drawing, degrees or length.
   pure real(wp) function shift_of(self, x) result(shift)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)              !! shape (core)

      shift = 0.0_wp
      if (self%of_input > 0) shift = x(self%of_input) - self%first(self%of_input)
   end function shift_of

   !> Constraints hold over the range of the inputs of x, and at further ones.
   subroutine set_range(self, x, extra)
      class(chain_problem_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)              !! shape (core)
      real(wp), intent(in), optional :: extra(:) !! shape (at most extra_positions): increments
      integer :: n

      if (allocated(self%between)) deallocate (self%between)
      if (self%irange == range_positions) then
         allocate (self%between(0))
         return
      end if
      self%between = [even_inputs(self, x, range_steps), spread(minval(self%increments(x)), 1, extra_positions)]
      if (.not. present(extra)) return
      n = min(size(extra), extra_positions)
      self%between(range_steps + 2:range_steps + 1 + n) = extra(:n)
   end subroutine set_range

   !> Increments of the first drive in even steps over the range that IRANGE asks for, ends included; by itself that of the inputs.
   pure function even_inputs(self, x, steps) result(delt)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)              !! shape (core)
      integer, intent(in) :: steps
      real(wp) :: delt(steps + 1)
      real(wp) :: from, to
      integer :: i

      from = minval(self%increments(x))
      to = maxval(self%increments(x))
      if (self%irange == range_turn .and. self%span < huge(1.0_wp)) to = from + self%span
      delt = [(from + (to - from)*(real(i, wp)/real(steps, wp)), i=0, steps)]
   end function even_inputs

   !> From one input to the next, in one step where that can be trusted. Where the motion ends on the way, `state` is near its end.
   subroutine go_on(closure, target, state, reached)
      type(closure_t), intent(in) :: closure
      real(wp), intent(in) :: target(:)         !! shape (drives): from the drawing
      type(state_t), intent(inout) :: state
      logical, intent(out) :: reached
      type(state_t) :: next
      real(wp) :: from(size(target)), sense(size(closure%groups)), sense_next(size(closure%groups)), worst
      logical :: dead
      integer :: group

      reached = all(abs(target - state%input(:, 0)) <= 0.0_wp)
      if (reached) return
      from = state%input(:, 0)
      state%input(:, 1) = target - from
      state%input(:, 2:) = 0.0_wp
      call differentiate(closure, 2, state, dead)
      if (.not. dead) then
         call senses(closure, state, sense)
         next = state
         call try_step(closure, from, target, 0.0_wp, 1.0_wp, next, sense, sense_next, worst, reached, group)
         if (reached) then
            state = next
            call place_points(closure, state, 0)
            return
         end if
      end if
      call advance(closure, target, state, reached, group)
   end subroutine go_on

   !> All numbers of the outputs at increments of the first drive.
   subroutine find_path(self, x, delt, values, known)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)              !! shape (core)
      real(wp), intent(in) :: delt(:)
      real(wp), intent(out) :: values(:, 0:, :) !! shape (numbers, 0:most_orders, size of delt); rates are by the first drive
      logical, intent(out) :: known(:)          !! shape of delt: it is reached from the drawing
      type(closure_t) :: closure
      type(state_t) :: drawing, states(size(delt))
      logical :: dead
      integer :: k

      values = 0.0_wp
      known = .false.
      closure = self%drawn
      drawing = self%start
      call change_dimensions(self, x, closure, drawing, known(1))
      if (.not. known(1)) return
      call find_between(self, x, closure, drawing, delt, states, known)
      do k = 1, size(delt)
         if (.not. known(k)) cycle
         states(k)%input(:, 1:) = 0.0_wp
         states(k)%input(:, 1) = self%speed
         call differentiate(closure, most_orders, states(k), dead)
         known(k) = .not. dead
         call output_at(closure, states(k), self%drawn%sketch%outputs, values(:, :, k))
      end do
   end subroutine find_path

   !> Follow the drawing upwards and downwards to increments of the first drive. Where it does not get there, `states` are those
   !> where it stopped.
   subroutine find_between(self, x, closure, drawing, delt, states, reached)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)              !! shape (core)
      type(closure_t), intent(in) :: closure    !! with the dimensions x
      type(state_t), intent(in) :: drawing      !! at the input of the drawing
      real(wp), intent(in) :: delt(:)
      type(state_t), intent(out) :: states(:)   !! shape of delt
      logical, intent(out) :: reached(:)        !! shape of delt
      real(wp) :: inputs(size(self%inputs, 1), size(delt))
      logical :: waiting(size(delt)), going
      type(state_t) :: state
      integer :: side, k

      inputs = inputs_at(self, x, delt)
      reached = .false.
      do side = -1, 1, 2
         state = drawing
         going = .true.
         waiting = merge(inputs(1, :) >= 0.0_wp, inputs(1, :) < 0.0_wp, side == 1)
         do while (any(waiting))
            k = minloc(side*inputs(1, :), dim=1, mask=waiting)
            waiting(k) = .false.
            if (going) call go_on(closure, inputs(:, k), state, going)
            states(k) = state
            reached(k) = going
         end do
      end do
   end subroutine find_between

   !> Follow the drawing's assembly to new dimensions.
   subroutine change_dimensions(self, x, closure, state, reached)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      type(closure_t), intent(inout) :: closure !! as drawn; with the dimensions x on return
      type(state_t), intent(inout) :: state
      logical, intent(out) :: reached
      type(state_t) :: next
      real(wp) :: sense(size(closure%groups)), sense_next(size(closure%groups)), drawn(size(self%inputs, 1))
      real(wp) :: way, step, worst
      integer :: group
      logical :: dead, valid

      reached = .true.
      drawn = state%input(:, 0)
      if (size(x) == 0) return
      reached = .false.
      call senses(closure, state, sense)
      way = 0.0_wp
      step = 4.0_wp*first_step
      do while (way < 1.0_wp)
         call self%dimensioned(self%first + way*(x - self%first), closure, x - self%first)
         state%input(:, 1:) = 0.0_wp
         call differentiate(closure, 2, state, dead)
         if (dead) return
         step = min(step, 1.0_wp - way)
         do
            if (way + step >= 1.0_wp) then
               call self%dimensioned(x, closure)
            else
               call self%dimensioned(self%first + (way + step)*(x - self%first), closure)
            end if
            next = state
            call try_step(closure, drawn, drawn, way, step, next, sense, sense_next, worst, valid, group)
            if (valid) exit
            step = 0.5_wp*step
            if (step < least_step) return
         end do
         state = next
         sense = sense_next
         way = way + step
         if (worst < easy) step = 2.0_wp*step
      end do
      if (allocated(closure%point_rate)) deallocate (closure%point_rate)
      call place_points(closure, state, 0)
      reached = .true.
   end subroutine change_dimensions

   !> Values of all outputs and their derivatives by the first drive at a position, and with `by` those of these by every unknown.
   subroutine find_values(self, x, closure, state, values, by)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      type(closure_t), intent(inout) :: closure !! with the dimensions x
      type(state_t), intent(in) :: state        !! at the position, with rates by the first drive
      real(wp), intent(out) :: values(:, 0:)    !! shape (numbers, 0:most_orders); angles in degrees, their rates in radians
      real(wp), intent(out), optional :: by(:, 0:, :) !! shape (numbers, 0:most_targets, core)
      real(wp) :: alone(size(values, 1), 0:most_orders), plus(size(values, 1), 0:most_orders), minus(size(values, 1), 0:most_orders)
      real(wp) :: mixed(size(values, 1))
      integer :: v, n, need

      call output_at(closure, state, self%drawn%sketch%outputs, values)
      if (.not. present(by)) return
      by = 0.0_wp
      need = self%highest + 1
      if (any(self%ratio)) need = max(need, 2)
      do v = 1, self%variables
         call along(v, 1.0_wp, 0.0_wp, need, alone)
         by(:, 0, v) = alone(:, 1)
         if (need > 1) then
            call along(v, 1.0_wp, 1.0_wp, need, plus)
            mixed = 0.5_wp*(plus(:, 2) - values(:, 2) - alone(:, 2))
            by(:, 1, v) = mixed
            do n = 1, size(mixed)
               if (.not. self%ratio(n)) cycle
               associate (a => self%ratio_of(1, n), b => self%ratio_of(2, n))
                  by(n, :, v) = 0.0_wp
                  if (values(n, 0) < huge(1.0_wp)) by(n, 0, v) = (mixed(a) - values(n, 0)*mixed(b))/values(b, 1)
               end associate
            end do
         end if
         if (need > 2) then
            call along(v, -1.0_wp, 1.0_wp, need, minus)
            by(:, 2, v) = (plus(:, 3) - minus(:, 3) - 2.0_wp*alone(:, 3))/6.0_wp
         end if
         do n = 1, size(mixed)
            if (self%angle(n)) by(n, 0, v) = by(n, 0, v)*degrees_per_radian
         end do
      end do

   contains

      !> Derivatives while unknown v and the first drive change at steady rates.
      subroutine along(v, of_unknown, of_input, orders, rates)
         integer, intent(in) :: v, orders
         real(wp), intent(in) :: of_unknown, of_input
         real(wp), intent(out) :: rates(:, 0:)
         type(state_t) :: moving
         real(wp) :: rate(self%core)
         logical :: dead

         moving = state
         moving%input(:, 1:) = 0.0_wp
         moving%input(:, 1) = of_input*self%speed
         rate = 0.0_wp
         rate(v) = of_unknown
         if (v == self%of_input) moving%input(:, 1) = moving%input(:, 1) + of_unknown*self%unit_of_input*self%speed
         call self%dimensioned(x, closure, rate)
         call differentiate(closure, orders, moving, dead)
         call output_at(closure, moving, self%drawn%sketch%outputs, rates)
         deallocate (closure%point_rate)
      end subroutine along
   end subroutine find_values

   ! ---- the problem -------------------------------------------------------------------------------------------------

   !> Weighted deviations from what is wanted, position after position, then of numbers that are to be equal.
   subroutine residuals_at(self, x, r, jacobian)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core)
      real(wp), intent(out) :: r(:)                  !! shape (residuals)
      real(wp), intent(out), optional :: jacobian(:, :) !! shape (residuals, core)
      type(closure_t) :: closure
      type(chain_motion_t) :: motion
      real(wp) :: values(size(self%wanted, 1), 0:most_orders), by(size(self%wanted, 1), 0:most_targets, size(x)), root, miss
      real(wp) :: compared(2, size(self%relations))
      integer :: k, n, order, m
      logical :: reached

      call self%find_motion(x, closure, motion, reached)
      r = far*self%drawn%size
      if (present(jacobian)) jacobian = 0.0_wp
      if (.not. reached) return
      m = 0
      do k = 1, size(self%inputs, 2)
         if (present(jacobian)) then
            call self%find_values(x, closure, motion%states(k), values, by)
         else
            call self%find_values(x, closure, motion%states(k), values)
         end if
         do order = 0, most_targets
            do n = 1, size(values, 1)
               if (self%weight(n, order, k) <= 0.0_wp) cycle
               m = m + 1
               root = sqrt(self%weight(n, order, k))
               miss = values(n, order) - self%wanted(n, order, k)
               if (order == 0 .and. self%angle(n)) miss = miss - full_turn*anint(miss/full_turn)
               r(m) = root*miss
               if (.not. present(jacobian)) cycle
               jacobian(m, :) = root*by(n, order, :)
               if (self%free) jacobian(m, self%variables + k) = root*by_input(self, values, n, order)
            end do
         end do
         call take_equals(self, values, k, compared)
         if (present(jacobian)) call add_equals()
      end do
      do k = 1, size(self%relations)
         r(m + k) = sqrt(self%relations(k)%weight)*miss_of(self%relations(k), compared(1, k), compared(2, k))
      end do
      if (self%similar) call compare_shapes(self, r, jacobian)

   contains

      !> What position k adds to the rows of the Jacobian of numbers that are to be equal, the last ones.
      subroutine add_equals()
         real(wp) :: factor(2)
         integer :: q, side

         do q = 1, size(self%relations)
            associate (of => self%relations(q), row => self%residuals - size(self%relations) + q)
               factor = sqrt(of%weight)*[1.0_wp, -of%factor]
               do side = 1, 2
                  if (of%positions(side) == k) jacobian(row, :) = jacobian(row, :) + factor(side)*by(of%numbers(side), of%order, :)
               end do
            end associate
         end do
      end subroutine add_equals
   end subroutine residuals_at

   !> What a position gives to the numbers that are to be equal.
   pure subroutine take_equals(self, values, position, compared)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: values(:, 0:)          !! shape (numbers, 0:most_orders): at the position
      integer, intent(in) :: position
      real(wp), intent(inout) :: compared(:, :)      !! shape (2, relations): first and second of each
      integer :: q, side

      do q = 1, size(self%relations)
         associate (of => self%relations(q))
            do side = 1, 2
               if (of%positions(side) == position) compared(side, q) = values(of%numbers(side), of%order)
            end do
         end associate
      end do
   end subroutine take_equals

   !> The same against desired points of any place, size and direction. All residuals are of x and y of the first output, at the
   !> positions that weigh.
   pure subroutine compare_shapes(self, r, jacobian)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(inout) :: r(:)                !! weighted deviations from the points where they were given
      real(wp), intent(inout), optional :: jacobian(:, :)
      complex(wp) :: actual(size(r)/2), desired(size(r)/2), error(size(r)/2)
      complex(wp), allocatable :: by(:, :)
      real(wp) :: weight(size(r)/2)
      type(similarity_t) :: similarity

      call weighing_points(self, desired, weight)
      actual = cmplx(r(1::2), r(2::2), wp)/sqrt(weight) + desired
      call fit_similarity(actual, desired, weight, similarity)
      error = errors_of(similarity, actual, desired)
      r(1::2) = sqrt(weight)*error%re
      r(2::2) = sqrt(weight)*error%im
      if (.not. present(jacobian)) return
      by = cmplx(jacobian(1::2, :), jacobian(2::2, :), wp)*spread(similarity%u/sqrt(weight), 2, size(jacobian, 2))
      call take_out_similarity(actual, weight, error, by)
      by = by*spread(sqrt(weight), 2, size(jacobian, 2))
      jacobian(1::2, :) = by%re
      jacobian(2::2, :) = by%im
   end subroutine compare_shapes

   !> The desired points of the first output that weigh, and their weights.
   pure subroutine weighing_points(self, desired, weight)
      class(chain_problem_t), intent(in) :: self
      complex(wp), intent(out) :: desired(:)
      real(wp), intent(out) :: weight(:)
      logical :: weighs(size(self%weight, 3))

      weighs = self%weight(1, 0, :) > 0.0_wp
      weight = pack(self%weight(1, 0, :), weighs)
      desired = pack(cmplx(self%wanted(1, 0, :), self%wanted(2, 0, :), wp), weighs)
   end subroutine weighing_points

   !> The numbers that are to be equal of a linkage, first and second; none where a position is not reached.
   subroutine find_equals(self, x, compared)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core)
      real(wp), allocatable, intent(out) :: compared(:, :) !! shape (2, relations)
      type(closure_t) :: closure
      type(chain_motion_t) :: motion
      real(wp) :: values(size(self%wanted, 1), 0:most_orders)
      integer :: k
      logical :: reached

      call self%find_motion(x, closure, motion, reached)
      allocate (compared(2, merge(size(self%relations), 0, reached)), source=0.0_wp)
      if (.not. reached) return
      do k = 1, size(self%inputs, 2)
         call self%find_values(x, closure, motion%states(k), values)
         call take_equals(self, values, k, compared)
      end do
   end subroutine find_equals

   !> Where the desired points lie for a linkage; `reached` is false where it does not come to all positions.
   subroutine find_similarity(self, x, similarity, reached)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core)
      type(similarity_t), intent(out) :: similarity
      logical, intent(out) :: reached
      type(closure_t) :: closure
      type(chain_motion_t) :: motion
      complex(wp) :: actual(size(self%inputs, 2))
      real(wp) :: values(size(self%wanted, 1), 0:most_orders)
      integer :: k

      call self%find_motion(x, closure, motion, reached)
      if (.not. reached) return
      do k = 1, size(actual)
         call self%find_values(x, closure, motion%states(k), values)
         actual(k) = cmplx(values(1, 0), values(2, 0), wp)
      end do
      call fit_similarity(actual, cmplx(self%wanted(1, 0, :), self%wanted(2, 0, :), wp), self%weight(1, 0, :), similarity)
   end subroutine find_similarity

   !> Derivative of a number's value, or of its derivative by the first drive, by the increment of that drive.
   pure real(wp) function by_input(self, values, n, order) result(slope)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: values(:, 0:)          !! shape (numbers, 0:most_orders): as `find_values` has them
      integer, intent(in) :: n, order

      slope = values(n, order + 1)
      if (self%ratio(n)) then
         slope = 0.0_wp
         associate (a => self%ratio_of(1, n), b => self%ratio_of(2, n))
            if (order == 0 .and. values(n, 0) < huge(1.0_wp)) slope = (values(a, 2) - values(n, 0)*values(b, 2))/values(b, 1)
         end associate
      end if
      slope = slope*self%unit_of_input
      if (order == 0 .and. self%angle(n)) slope = slope*degrees_per_radian
   end function by_input

   !> Inputs that must follow each other are put in order.
   subroutine project(self, x)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(inout) :: x(:)                !! shape (core)

      if (self%ordered) call put_in_order(x(self%variables + 1:), self%sense, self%span)
   end subroutine project

   !> Distance of each group from a dead point: its determinant against the product of the norms of its columns, 0 to 1.
   function margins_of(closure, state) result(margins)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      real(wp) :: margins(size(closure%groups))
      real(wp), allocatable :: matrix(:, :)
      type(factors_t) :: factors
      integer :: g

      margins = 1.0_wp
      do g = 1, size(closure%groups)
         if (size(closure%groups(g)%links) == 0) cycle
         matrix = matrix_of(closure, state, g)
         call factorise(matrix, factors)
         margins(g) = product(abs(factors%diagonal)/sqrt(sum(matrix**2, dim=1)))
      end do
   end function margins_of

   !> The first two: that every position is reached, and the range. Then the order of free inputs; then at each position, and at
   !> inputs over the range, the margin of each group, the transmission angle of each link pair and each clearance.
   subroutine constraints_at(self, x, c, slopes)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core)
      real(wp), intent(out) :: c(:)                  !! shape (inequalities)
      real(wp), intent(out), optional :: slopes(:, :) !! shape (core, inequalities)
      type(closure_t) :: closure
      type(chain_motion_t) :: motion
      type(state_t) :: drawing
      type(state_t), allocatable :: states(:)
      logical, allocatable :: known(:)
      integer :: k, n, m, v
      logical :: reached

      call self%find_motion(x, closure, motion, reached, drawing)
      c = self%drawn%size
      if (present(slopes)) slopes = 0.0_wp
      if (.not. reached) return
      c(:of_whole) = -self%drawn%size
      n = at_a_position(self)
      m = of_whole
      call keep_order()
      do k = 1, size(self%inputs, 2)
         call values_of(self, closure, motion%states(k), c(m + 1:m + n))
         if (present(slopes)) then
            do v = 1, self%variables
               call slopes_of(self, x, v, closure, motion%states(k), slopes(v, m + 1:m + n))
            end do
            if (self%free) call slopes_of(self, x, self%variables + k, closure, motion%states(k), &
                                          slopes(self%variables + k, m + 1:m + n))
         end if
         m = m + n
      end do
      if (size(self%between) == 0) return
      if (.not. self%looks_between) then
         c(m + 1:) = -self%drawn%size
         return
      end if
      allocate (states(size(self%between)), known(size(self%between)))
      call find_between(self, x, closure, drawing, self%between, states, known)
      if (.not. all(known)) c(of_whole) = self%drawn%size*real(count(.not. known), wp)/real(size(known), wp)
      do k = 1, size(states)
         call values_of(self, closure, states(k), c(m + 1:m + n))
         c(m + 1:m + n) = c(m + 1:m + n) + slack*self%drawn%size
         if (present(slopes) .and. any(c(m + 1:m + n) > -inside*self%drawn%size)) then
            do v = 1, self%variables
               call slopes_of(self, x, v, closure, states(k), slopes(v, m + 1:m + n))
            end do
         end if
         m = m + n
      end do

   contains

      !> Inputs never go back; a solver that projects keeps them in order by itself.
      subroutine keep_order()
         real(wp), allocatable :: delt(:)
         real(wp) :: unit

         delt = self%increments(x)
         associate (positions => size(delt))
            c(m + 1:m + positions) = -self%drawn%size
            if (self%ordered .and. self%looks_between .and. .not. self%projects) then
               unit = self%sense*self%unit_of_input
               if (self%span < huge(1.0_wp)) unit = unit*self%drawn%size
               c(m + 1:m + positions) = unit*(delt - cshift(delt, 1))
               if (self%span < huge(1.0_wp)) then
                  c(m + positions) = c(m + positions) - abs(unit)*self%span
               else
                  c(m + positions) = -self%drawn%size
               end if
               if (present(slopes)) then
                  do k = 1, positions
                     if (k == positions .and. self%span >= huge(1.0_wp)) exit
                     ! of a single position both are one
                     associate (own => slopes(self%variables + k, m + k), &
                                next => slopes(self%variables + 1 + modulo(k, positions), m + k))
                        own = own + unit
                        next = next - unit
                     end associate
                  end do
               end if
            end if
            m = m + positions
         end associate
      end subroutine keep_order
   end subroutine constraints_at

   !> Constraints of one position.
   pure integer function at_a_position(self)
      class(chain_problem_t), intent(in) :: self

      at_a_position = size(self%margin) + size(self%pairs) + size(self%clearances)
   end function at_a_position

   !> Inspect the range more finely than a search does: increments where constraints are violated, the worst of each. Between two
   !> steps a parabola tells; a range that is not reached is violated where that is known first.
   subroutine find_violations(self, x, delt)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core)
      real(wp), allocatable, intent(out) :: delt(:)
      type(closure_t) :: closure
      type(chain_motion_t) :: motion
      type(state_t) :: drawing, states(fine_steps + 1)
      real(wp) :: inputs(fine_steps + 1), c(at_a_position(self), fine_steps + 1), bend, worst, where_worst, top, at
      logical :: reached, known(fine_steps + 1)
      integer :: k, r

      allocate (delt(0))
      if (self%irange == range_positions) return
      call self%find_motion(x, closure, motion, reached, drawing)
      if (.not. reached) then
         delt = [self%delt(1)]
         return
      end if
      inputs = even_inputs(self, x, fine_steps)
      call find_between(self, x, closure, drawing, inputs, states, known)
      if (.not. all(known)) then
         delt = [inputs(findloc(known, .false., dim=1))]
         return
      end if
      do k = 1, size(states)
         call values_of(self, closure, states(k), c(:, k))
      end do
      do r = 1, size(c, 1)
         worst = 0.0_wp
         where_worst = inputs(1)
         do k = 1, size(states)
            associate (before => c(r, max(k - 1, 1)), here => c(r, k), after => c(r, min(k + 1, size(states))))
               if (here < max(before, after)) cycle
               top = here
               at = inputs(k)
               bend = 2.0_wp*here - before - after
               if (bend > 0.0_wp .and. k > 1 .and. k < size(states)) then
                  top = here + (after - before)**2/(8.0_wp*bend)
                  at = at + 0.5_wp*(after - before)/bend*(inputs(2) - inputs(1))
               end if
               if (top <= worst) cycle
               worst = top
               where_worst = at
            end associate
         end do
         if (worst > 0.0_wp) delt = [delt, where_worst]
      end do
   end subroutine find_violations

   !> Constraints of one position.
   subroutine values_of(self, closure, state, c)
      class(chain_problem_t), intent(in) :: self
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      real(wp), intent(out) :: c(:)                  !! shape (groups + link pairs + clearances)
      real(wp) :: at(2, points_of_clearance), unused(2, points_of_clearance)
      complex(wp) :: side(2)
      integer :: n, k, m

      c(:size(self%margin)) = self%drawn%size*(self%margin - margins_of(closure, state))
      m = size(self%margin)
      do n = 1, size(self%pairs)
         side = state%joint(self%pairs(n)%outer, 0) - state%joint(self%pairs(n)%inner, 0)
         c(m + n) = self%drawn%size*(abs(real(side(1)*conjg(side(2)), wp))/max(product(abs(side)), tiny(1.0_wp)) - self%cosine)
      end do
      m = m + size(self%pairs)
      do n = 1, size(self%clearances)
         do k = 1, points_of_clearance
            ! a region has two points only
            associate (joint => state%joint(max(self%clearances(n)%points(k), 1), 0))
               at(:, k) = [joint%re, joint%im]
            end associate
         end do
         call find_depth(self%clearances(n), at, c(m + n), unused)
      end do
   end subroutine values_of

   !> Their slopes by one unknown: the position is moved a little along its rates, to either side.
   subroutine slopes_of(self, x, v, closure, state, slopes)
      class(chain_problem_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      integer, intent(in) :: v
      type(closure_t), intent(inout) :: closure      !! with the dimensions x
      type(state_t), intent(in) :: state
      real(wp), intent(out) :: slopes(:)
      type(state_t) :: moving, moved
      real(wp) :: rate(size(x)), side(size(slopes), 2), h
      logical :: dead
      integer :: k

      moving = state
      moving%input(:, 1:) = 0.0_wp
      rate = 0.0_wp
      rate(v) = 1.0_wp
      if (v == self%of_input .or. v > self%variables) moving%input(:, 1) = self%unit_of_input*self%speed
      call self%dimensioned(x, closure, rate)
      call differentiate(closure, 1, moving, dead)
      deallocate (closure%point_rate)
      h = nudge*max(1.0_wp, abs(x(v)))
      do k = 1, 2
         moved = moving
         moved%t(:, 0) = moving%t(:, 0) + h*moving%t(:, 1)
         moved%phi(:, 0) = moving%phi(:, 0) + h*moving%phi(:, 1)
         moved%joint(:, 0) = moving%joint(:, 0) + h*moving%joint(:, 1)
         moved%input(:, 0) = moving%input(:, 0) + h*moving%input(:, 1)
         call self%dimensioned(x + h*rate, closure)
         call values_of(self, closure, moved, side(:, k))
         h = -h
      end do
      call self%dimensioned(x, closure)
      slopes = (side(:, 1) - side(:, 2))/(2.0_wp*h)
   end subroutine slopes_of
end module psalm_chain_problem
