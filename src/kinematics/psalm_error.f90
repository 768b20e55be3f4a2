!> ERROR: positions of the linkage at the prescribed inputs, the output there, and the objective.
!>
!> A `problem_t` is everything an analysis or a search works on: topology, plan, inputs, desired values and weights, and a
!> linkage to move. Source of motions and objective: Oldham (1977), chapter 5 and appendix B.
module psalm_error
   use psalm_angles, only: unit_vector, angles_between, arc_sine, degrees_of, within_turn
   use psalm_data_set, only: data_set_t, motion_point, motion_angle, motion_distance, motion_slide
   use psalm_kinds, only: wp
   use psalm_linkage, only: linkage_t, padded
   use psalm_plan, only: plan_t, make_plan
   use psalm_topology, only: topology_t, dimensions_t
   implicit none (type, external)
   private
   public :: problem_t, motion_t, violation_t, crossing_t, make_problem, violation_none
   public :: violation_too_short, violation_too_long, violation_parallel, violation_angle_small, violation_angle_large, &
             violation_undetermined, violation_slides

   integer, parameter :: violation_none = 0
   integer, parameter :: violation_too_short = 1    !! the dyad does not reach
   integer, parameter :: violation_too_long = 2     !! the difference of the links, or the guide, is too great
   integer, parameter :: violation_parallel = 3     !! two slides are parallel
   integer, parameter :: violation_angle_small = 4  !! closes, but the transmission angle is too small
   integer, parameter :: violation_angle_large = 5  !! closes, but the transmission angle is too large

   real(wp), parameter :: no_distance = 1.0e3_wp*epsilon(1.0_wp) !! of the links: outer joints so near each other coincide
   integer, parameter :: violation_undetermined = 6 !! the outer joints coincide: no direction is determined
   integer, parameter :: violation_slides = 7       !! closes, but the angle between the slides is too small

   !> Consecutive positions at which one dyad violates one limit.
   type :: violation_t
      integer :: kind = violation_none
      integer :: loop = 0
      integer :: first = 0, last = 0   !! positions
      integer :: worst = 0             !! position of the largest amount
      real(wp) :: amount = 0.0_wp      !! length missing, or the transmission angle, degrees, at the worst position
   end type violation_t

   !> Two slides that have been parallel between a position and the next: the linkage cannot move from one to the other.
   type :: crossing_t
      integer :: loop = 0
      integer :: position = 0
   end type crossing_t

   !> What the linkage does at a row of input positions.
   type :: motion_t
      logical, allocatable :: closed(:)            !! every loop the output depends on closes
      real(wp), allocatable :: input(:)            !! degrees in a turn, or length
      real(wp), allocatable :: actual(:)           !! angle, distance or length; x for MOTION 0
      real(wp), allocatable :: actual_y(:)         !! y for MOTION 0
      real(wp), allocatable :: error(:)            !! desired - actual (x for MOTION 0); 0 without desired values
      real(wp), allocatable :: error_y(:)
      real(wp) :: total = 0.0_wp                   !! objective over the closed positions
      type(violation_t), allocatable :: violations(:)
      type(crossing_t), allocatable :: crossings(:)
   end type motion_t

   type :: problem_t
      type(topology_t) :: topology
      type(plan_t) :: plan
      type(dimensions_t) :: given                  !! the user's linkage
      type(linkage_t) :: linkage                   !! bound to the last dimensions evaluated
      type(linkage_t), allocatable :: crew(:)      !! one more linkage for each further thread
      integer :: motion = motion_point
      real(wp) :: tangle = 90.0_wp, toggle = 0.0_wp
      real(wp) :: slide_angle = 90.0_wp            !! allowed deviation of the angle between two slides from 90 degrees
      real(wp), allocatable :: side(:)             !! by loop: +1 or -1, sign of the sine between two slides that is wanted
      integer :: positions = 0
      real(wp), allocatable :: delt(:)             !! shape (positions): degrees or length
      ! tables for whole blocks: the positions, padded with the last one
      real(wp), allocatable :: first(:), second(:) !! cosine and sine of DELT; sliding input: DELT twice
      logical :: desired = .false.                 !! there are desired values
      real(wp), allocatable :: wanted(:), wanted_y(:) !! desired values, machine co-ordinates for MOTION 0
      real(wp), allocatable :: toward_x(:), toward_y(:) !! MOTION 1: unit vectors of the desired angles
      real(wp), allocatable :: weight(:), weight_y(:) !! weights, 0 for padding
      real(wp), allocatable :: partial(:)          !! shape (blocks): objective of each
      integer, allocatable :: offending(:)         !! shape (blocks): lowest loop not accepted in each
      real(wp) :: out_angle = 0.0_wp, out_c = 1.0_wp, out_s = 0.0_wp    !! output arc from its root: degrees, cosine, sine
      real(wp) :: out_length = 0.0_wp
      real(wp) :: origin_angle = 0.0_wp, origin_c = 1.0_wp, origin_s = 0.0_wp !! direction of the input pivot
      real(wp) :: origin_x = 0.0_wp, origin_y = 0.0_wp                  !! the input pivot
   contains
      procedure :: want_derivatives
      procedure :: set_inputs
      procedure :: move_inputs
      procedure :: set_desired
      procedure :: set_threads
      procedure :: bind => bind_problem
      procedure :: solve_block
      procedure :: blocks
      procedure :: evaluate
      procedure :: analyse
      procedure :: reach_of
      procedure :: deviations
      procedure :: output_of
   end type problem_t

contains

   !> Set a problem up from a data set and its topology.
   subroutine make_problem(set, topology, dimensions, problem)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(in) :: topology
      type(dimensions_t), intent(in) :: dimensions
      type(problem_t), intent(out) :: problem
      real(wp), allocatable :: turn(:)
      integer :: i

      problem%topology = topology
      problem%given = dimensions
      problem%motion = set%motion
      problem%tangle = set%tangle
      problem%toggle = set%toggle
      if (set%tangle_given) problem%slide_angle = set%tangle
      allocate (problem%side(topology%nloop), source=1.0_wp)
      problem%plan = make_plan(topology, set%motion, everything=set%ktheta /= 0, all_roots=.false.)
      if (set%ikin /= 0) then
         turn = [(real(i*set%ikin, wp), i=0, (359/abs(set%ikin)))]
         call problem%set_inputs(turn)
         return
      end if
      call problem%set_inputs(set%delt)
      if (.not. set%desired) return
      if (set%motion == motion_point) then
         call problem%set_desired(set%desx + set%xadd, set%xmult, set%desy + set%yadd, set%ymult)
      else
         call problem%set_desired(set%desang, set%anmult)
      end if
   end subroutine make_problem

   !> Make a plan that finds everything derivatives need; inputs and desired values are kept.
   subroutine want_derivatives(self, everything, joints)
      class(problem_t), intent(inout) :: self
      logical, intent(in) :: everything     !! solve every loop, wanted or not
      integer, intent(in), optional :: joints(:, :) !! joints to be made, as `make_plan` has them

      self%plan = make_plan(self%topology, self%motion, everything, .true., joints)
      call self%linkage%prepare(self%topology, self%plan, self%tangle, self%slide_angle, self%delt)
      if (allocated(self%crew)) call self%set_threads(size(self%crew))
   end subroutine want_derivatives

   !> Give the input positions (increments from the reference position); desired values are dropped.
   subroutine set_inputs(self, delt)
      class(problem_t), intent(inout) :: self
      real(wp), intent(in) :: delt(:)  !! degrees, or length with a sliding input
      integer :: i

      self%positions = size(delt)
      self%delt = delt
      self%desired = .false.
      call self%linkage%prepare(self%topology, self%plan, self%tangle, self%slide_angle, delt)
      if (allocated(self%crew)) deallocate (self%crew)
      self%first = whole_blocks(self, delt, delt(size(delt)))
      self%second = self%first
      if (.not. self%topology%sliding_input) then
         do i = 1, size(self%first)
            call unit_vector(self%second(i), self%first(i), self%second(i))
         end do
      end if
      if (allocated(self%partial)) deallocate (self%partial, self%offending)
      allocate (self%partial(self%blocks()), source=0.0_wp)
      allocate (self%offending(self%blocks()), source=0)
   end subroutine set_inputs

   !> Move the input positions; their number, desired values and weights stay. No allocation.
   pure subroutine move_inputs(self, delt)
      class(problem_t), intent(inout) :: self
      real(wp), intent(in) :: delt(:)  !! shape (positions)
      integer :: i

      self%delt = delt
      do i = 1, size(self%first)
         associate (value => delt(min(i, size(delt))))
            if (self%topology%sliding_input) then
               self%first(i) = value
               self%second(i) = value
            else
               call unit_vector(value, self%first(i), self%second(i))
            end if
         end associate
      end do
   end subroutine move_inputs

   !> Give desired values and weights for the positions.
   subroutine set_desired(self, wanted, weight, wanted_y, weight_y)
      class(problem_t), intent(inout) :: self
      real(wp), intent(in) :: wanted(:), weight(:)                        !! shape (positions)
      real(wp), intent(in), optional :: wanted_y(:), weight_y(:)          !! shape (positions); MOTION 0
      integer :: i

      self%desired = .true.
      self%wanted = whole_blocks(self, wanted, wanted(size(wanted)))
      self%weight = whole_blocks(self, weight, 0.0_wp)
      if (present(wanted_y)) self%wanted_y = whole_blocks(self, wanted_y, wanted_y(size(wanted_y)))
      if (present(weight_y)) self%weight_y = whole_blocks(self, weight_y, 0.0_wp)
      if (self%motion /= motion_angle) return
      self%toward_x = self%wanted
      self%toward_y = self%wanted
      do i = 1, size(self%wanted)
         call unit_vector(self%wanted(i), self%toward_x(i), self%toward_y(i))
      end do
   end subroutine set_desired

   !> Values of the positions, then a filler up to the end of the last block.
   pure function whole_blocks(self, values, filler) result(padded_values)
      class(problem_t), intent(in) :: self
      real(wp), intent(in) :: values(:), filler
      real(wp), allocatable :: padded_values(:)

      allocate (padded_values(self%blocks()*self%linkage%room), source=filler)
      padded_values(:size(values)) = values
   end function whole_blocks

   !> Let `threads` threads share the blocks of an evaluation. The results have the same bits for any number.
   subroutine set_threads(self, threads)
      class(problem_t), intent(inout) :: self
      integer, intent(in) :: threads
      integer :: t

      if (allocated(self%crew)) deallocate (self%crew)
      if (threads < 2 .or. self%blocks() < 2*threads) return
      allocate (self%crew(threads))
      do t = 1, threads
         call self%crew(t)%prepare(self%topology, self%plan, self%tangle, self%slide_angle, self%delt)
      end do
   end subroutine set_threads

   !> Put dimensions in.
   pure subroutine bind_problem(self, dimensions)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      real(wp) :: angle

      call self%linkage%bind(self%topology, self%plan, dimensions)
      angle = self%linkage%angle(self%topology%output_arc) + dimensions%outang
      if (angle /= self%out_angle) call unit_vector(angle, self%out_c, self%out_s)
      self%out_angle = angle
      self%out_length = dimensions%outlk
      angle = dimensions%origng
      if (angle /= self%origin_angle) call unit_vector(angle, self%origin_c, self%origin_s)
      self%origin_angle = angle
      self%origin_x = dimensions%origlk*self%origin_c
      self%origin_y = dimensions%origlk*self%origin_s
   end subroutine bind_problem

   !> Number of blocks the positions make.
   pure integer function blocks(self)
      class(problem_t), intent(in) :: self

      blocks = (self%positions + self%linkage%room - 1)/self%linkage%room
   end function blocks

   !> Solve block `block`: positions offset+1 ... offset+n.
   pure subroutine solve_block(self, block, offset, n, last_step)
      class(problem_t), intent(inout) :: self
      integer, intent(in) :: block
      integer, intent(out) :: offset, n
      integer, intent(in), optional :: last_step
      integer :: m

      offset = (block - 1)*self%linkage%room
      n = min(self%linkage%room, self%positions - offset)
      m = padded(n)
      call self%linkage%solve(m, self%first(offset + 1:offset + m), self%second(offset + 1:offset + m), last_step)
   end subroutine solve_block

   !> Objective of a linkage: the sum of weight * (desired - actual)**2.
   !>
   !> `loop` is the lowest loop that does not close, or whose transmission angle is out of limits, at any position, or whose two
   !> slides are not always on the same side of each other; the objective has no meaning then. No allocation. With
   !> `set_threads` the blocks are shared out; each block's sum is formed by itself and the sums are added in order, so that the
   !> bits do not depend on the number of threads.
   subroutine evaluate(self, dimensions, objective, loop)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(out) :: objective
      integer, intent(out) :: loop         !! 0: none
      integer :: block, t

      call self%bind(dimensions)
      if (allocated(self%crew)) then
         !$omp parallel do num_threads(size(self%crew)) schedule(static) private(block)
         do t = 1, size(self%crew)
            call self%crew(t)%bind(self%topology, self%plan, dimensions)
            do block = t, self%blocks(), size(self%crew)
               call evaluate_block(self, self%crew(t), block, self%partial(block), self%offending(block))
            end do
         end do
         !$omp end parallel do
      else
         do block = 1, self%blocks()
            call evaluate_block(self, self%linkage, block, self%partial(block), self%offending(block))
         end do
      end if
      objective = 0.0_wp
      loop = 0
      do block = 1, self%blocks()
         objective = objective + self%partial(block)
         if (self%offending(block) > 0 .and. (loop == 0 .or. self%offending(block) < loop)) loop = self%offending(block)
      end do
      if (loop > 0 .or. .not. any(self%linkage%two_slides)) return
      do loop = 1, self%topology%nloop
         if (allocated(self%crew)) then
            do t = 1, size(self%crew)
               if (.not. self%crew(t)%stays_on_side(loop, self%crew(1))) return
            end do
         else
            if (.not. self%linkage%stays_on_side(loop)) return
         end if
      end do
      loop = 0
   end subroutine evaluate

   !> Deviations actual - desired of a linkage at every position; `loop` is the lowest loop not accepted, 0: none. No allocation.
   pure subroutine deviations(self, dimensions, miss, loop)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(inout) :: miss(:, :)  !! shape (positions, 2): second column for MOTION 0 only
      integer, intent(out) :: loop
      real(wp) :: unused
      integer :: block, offset, n

      call self%bind(dimensions)
      loop = 0
      do block = 1, self%blocks()
         call evaluate_block(self, self%linkage, block, unused, loop)
         if (loop > 0) return
         offset = (block - 1)*self%linkage%room
         n = min(self%linkage%room, self%positions - offset)
         associate (link => self%linkage)
            if (self%motion == motion_point) then
               miss(offset + 1:offset + n, 1) = link%store(link%out_x:link%out_x + n - 1) - self%wanted(offset + 1:offset + n)
               miss(offset + 1:offset + n, 2) = link%store(link%out_y:link%out_y + n - 1) - self%wanted_y(offset + 1:offset + n)
            else
               miss(offset + 1:offset + n, 1) = -link%store(link%miss:link%miss + n - 1)
            end if
         end associate
      end do
   end subroutine deviations

   !> One block of an evaluation with a bound linkage.
   pure subroutine evaluate_block(self, linkage, block, objective, loop)
      class(problem_t), intent(in) :: self
      type(linkage_t), intent(inout) :: linkage
      integer, intent(in) :: block
      real(wp), intent(out) :: objective
      integer, intent(out) :: loop         !! lowest loop not accepted, 0: none
      integer :: offset, m

      offset = (block - 1)*linkage%room
      m = padded(min(linkage%room, self%positions - offset))
      objective = 0.0_wp
      call linkage%solve(m, self%first(offset + 1:offset + m), self%second(offset + 1:offset + m), offending=loop)
      if (loop > 0) return
      call linkage%note_sides(m)
      if (self%motion /= motion_angle) call output_of_block(self, linkage, m)
      associate (store => linkage%store, rx => linkage%root_x(self%plan%root(self%topology%output_arc)), &
                 ry => linkage%root_y(self%plan%root(self%topology%output_arc)), &
                 x => linkage%out_x, y => linkage%out_y, miss => linkage%miss, first => offset + 1, &
                 last => offset + m)
         select case (self%motion)
         case (motion_angle)
            call angles_between(m, store(rx), store(ry), self%out_c, self%out_s, self%toward_x(first:last), &
                                self%toward_y(first:last), store(miss))
            objective = sum_of_squares(m, store(miss), self%weight(first:last))
         case (motion_point)
            call misses(m, self%wanted(first:last), store(x), store(miss))
            objective = sum_of_squares(m, store(miss), self%weight(first:last))
            call misses(m, self%wanted_y(first:last), store(y), store(miss))
            objective = objective + sum_of_squares(m, store(miss), self%weight_y(first:last))
         case default
            call misses(m, self%wanted(first:last), store(x), store(miss))
            objective = sum_of_squares(m, store(miss), self%weight(first:last))
         end select
      end associate
   end subroutine evaluate_block

   pure subroutine misses(n, wanted, actual, miss)
      integer, intent(in) :: n
      real(wp), intent(in) :: wanted(n), actual(n)
      real(wp), intent(out) :: miss(n)

      miss = wanted - actual
   end subroutine misses

   !> Sum of weight * error**2 in a fixed order: eight partial sums, so that it runs in vector lanes.
   pure real(wp) function sum_of_squares(n, error, weight)
      integer, intent(in) :: n          !! a multiple of 8
      real(wp), intent(in) :: error(n), weight(n)
      integer, parameter :: lanes = 8
      real(wp) :: part(lanes)
      integer :: i

      part = 0.0_wp
      do i = 1, n, lanes
         part = part + weight(i:i + lanes - 1)*error(i:i + lanes - 1)**2
      end do
      sum_of_squares = ((part(1) + part(2)) + (part(3) + part(4))) + ((part(5) + part(6)) + (part(7) + part(8)))
   end function sum_of_squares

   !> Output of the first `n` positions of the block just solved, into the rows `out_x` and `out_y` of the linkage.
   pure subroutine output_of(self, n)
      class(problem_t), intent(inout) :: self
      integer, intent(in) :: n

      call output_of_block(self, self%linkage, padded(n))
   end subroutine output_of

   !> Output of the block: x and y; unit vector of the output arc; distance or length (x only).
   pure subroutine output_of_block(self, linkage, n)
      class(problem_t), intent(in) :: self
      type(linkage_t), intent(inout) :: linkage
      integer, intent(in) :: n
      real(wp) :: back
      integer :: root

      root = self%plan%root(self%topology%output_arc)
      back = 1.0_wp/linkage%scale
      associate (store => linkage%store, x => linkage%out_x, y => linkage%out_y, rx => linkage%root_x(root), &
                 ry => linkage%root_y(root), px => linkage%point_x(self%plan%output_point), &
                 py => linkage%point_y(self%plan%output_point))
         select case (self%motion)
         case (motion_slide)
            associate (slide => linkage%slide(self%plan%length_slot(self%topology%output_arc)))
               call scaled(n, store(slide), back, store(x))
            end associate
         case (motion_angle)
            call turned(n, store(rx), store(ry), self%out_c, self%out_s, store(x), store(y))
         case default
            call output_points(n, store(px), store(py), store(rx), store(ry), back, self%out_c*self%out_length, &
                               self%out_s*self%out_length, self%origin_x, self%origin_y, store(x), store(y))
            if (self%motion == motion_distance) call distances(n, store(x), store(y))
         end select
      end associate
   end subroutine output_of_block

   pure subroutine scaled(n, from, factor, to)
      integer, intent(in) :: n
      real(wp), intent(in) :: from(n), factor
      real(wp), intent(out) :: to(n)

      to = from*factor
   end subroutine scaled

   pure subroutine turned(n, rx, ry, c, s, x, y)
      integer, intent(in) :: n
      real(wp), intent(in) :: rx(n), ry(n), c, s
      real(wp), intent(out) :: x(n), y(n)
      integer :: i

      do i = 1, n
         x(i) = c*rx(i) - s*ry(i)
         y(i) = c*ry(i) + s*rx(i)
      end do
   end subroutine turned

   pure subroutine output_points(n, px, py, rx, ry, back, c, s, origin_x, origin_y, x, y)
      integer, intent(in) :: n
      real(wp), intent(in) :: px(n), py(n), rx(n), ry(n), back, c, s, origin_x, origin_y
      real(wp), intent(out) :: x(n), y(n)
      integer :: i

      do i = 1, n
         x(i) = px(i)*back + (c*rx(i) - s*ry(i)) + origin_x
         y(i) = py(i)*back + (c*ry(i) + s*rx(i)) + origin_y
      end do
   end subroutine output_points

   !> Distance from the machine origin, in place of x.
   pure subroutine distances(n, x, y)
      integer, intent(in) :: n
      real(wp), intent(inout) :: x(n)
      real(wp), intent(in) :: y(n)
      real(wp) :: largest
      integer :: i

      do i = 1, n
         largest = max(max(abs(x(i)), abs(y(i))), tiny(1.0_wp))
         x(i) = largest*sqrt((x(i)/largest)**2 + (y(i)/largest)**2)
      end do
   end subroutine distances

   !> Reach of one loop at every position: what `psalm_dyads` defines for its type, in the user's unit.
   pure subroutine reach_of(self, loop, reach)
      class(problem_t), intent(inout) :: self
      integer, intent(in) :: loop
      real(wp), intent(out) :: reach(:)    !! shape (positions)
      real(wp) :: back
      integer :: block, offset, n

      back = 1.0_wp/self%linkage%scale
      if (self%topology%joint(loop) <= 3) back = back*back
      if (self%topology%joint(loop) >= 6) back = 1.0_wp
      do block = 1, self%blocks()
         call self%solve_block(block, offset, n, self%linkage%step_of_loop(loop))
         associate (row => self%linkage%reach(loop))
            reach(offset + 1:offset + n) = self%linkage%store(row:row + n - 1)*back
         end associate
      end do
   end subroutine reach_of

   !> The whole motion of a linkage: actual values, errors, and every violation of closure or transmission limits.
   subroutine analyse(self, dimensions, motion)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(out) :: motion
      integer :: block, offset, n, m, i, k, l, noted
      integer, allocatable :: open_violation(:)
      real(wp), allocatable :: sine(:)     !! by loop: between two slides, at the position before
      logical :: closed_before

      n = self%positions
      noted = 0
      allocate (motion%closed(n), source=.true.)
      allocate (motion%input(n), motion%actual(n), motion%actual_y(n), motion%error(n), motion%error_y(n), source=0.0_wp)
      allocate (motion%violations(0), motion%crossings(0))
      allocate (sine(self%topology%nloop), source=0.0_wp)
      closed_before = .false.
      allocate (open_violation(self%topology%nloop), source=0)
      motion%input = dimensions%crnki + self%delt
      if (.not. self%topology%sliding_input) motion%input = within_turn(motion%input)
      call self%bind(dimensions)
      do block = 1, self%blocks()
         call self%solve_block(block, offset, n)
         m = padded(n)
         do l = 1, self%topology%nloop
            if (self%linkage%step_of_loop(l) == 0) cycle
            if (self%linkage%all_accepted(m, l) .and. .not. may_coincide(self, l)) cycle
            do i = 1, n
               if (self%linkage%accepts(i, l) .and. .not. coincides(self, l, i)) cycle
               if (.not. self%linkage%closes(i, l) .or. coincides(self, l, i)) motion%closed(offset + i) = .false.
               call note_violation(self, l, i, offset + i, open_violation(l), motion%violations, noted)
            end do
         end do
         do i = 1, n
            do l = 1, self%topology%nloop
               if (.not. self%linkage%two_slides(l) .or. self%linkage%step_of_loop(l) == 0) cycle
               associate (now => self%linkage%store(self%linkage%reach(l) + i - 1))
                  if (now*sine(l) < 0.0_wp .and. closed_before .and. motion%closed(offset + i)) &
                     motion%crossings = [motion%crossings, crossing_t(l, offset + i - 1)]
                  sine(l) = now
               end associate
            end do
            closed_before = motion%closed(offset + i)
         end do
         call output_of_block(self, self%linkage, m)
         associate (store => self%linkage%store, x => self%linkage%out_x, y => self%linkage%out_y, &
                    miss => self%linkage%miss, &
                    rx => self%linkage%root_x(self%plan%root(self%topology%output_arc)), &
                    ry => self%linkage%root_y(self%plan%root(self%topology%output_arc)))
            if (self%desired .and. self%motion == motion_angle) then
               call angles_between(m, store(rx), store(ry), self%out_c, self%out_s, self%toward_x(offset + 1:offset + m), &
                                   self%toward_y(offset + 1:offset + m), store(miss))
            end if
            do i = 1, n
               k = offset + i
               motion%actual(k) = store(x + i - 1)
               motion%actual_y(k) = store(y + i - 1)
               if (self%motion == motion_angle .and. self%desired) then
                  motion%error(k) = store(miss + i - 1)
                  motion%actual(k) = self%wanted(k) - motion%error(k)
               else if (self%motion == motion_angle) then
                  motion%actual(k) = within_turn(degrees_of(motion%actual(k), motion%actual_y(k)))
               else if (self%desired) then
                  motion%error(k) = self%wanted(k) - motion%actual(k)
                  if (self%motion == motion_point) motion%error_y(k) = self%wanted_y(k) - motion%actual_y(k)
               end if
               if (self%desired .and. motion%closed(k)) then
                  motion%total = motion%total + self%weight(k)*motion%error(k)**2
                  if (self%motion == motion_point) motion%total = motion%total + self%weight_y(k)*motion%error_y(k)**2
               end if
            end do
         end associate
      end do
      motion%violations = motion%violations(:noted)
   end subroutine analyse

   !> Enter a violation, or let the one of the position before go on.
   subroutine note_violation(self, loop, i, position, current, violations, noted)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: loop, i, position
      integer, intent(inout) :: current    !! the loop's last violation in the list, 0: none
      type(violation_t), allocatable, intent(inout) :: violations(:) !! room; the first `noted` are valid
      integer, intent(inout) :: noted
      type(violation_t) :: new
      type(violation_t), allocatable :: more(:)
      logical :: worse

      new = violation_at(self, loop, i)
      new%first = position
      new%last = position
      new%worst = position
      if (current > 0) then
         associate (old => violations(current))
            if (old%kind == new%kind .and. old%last == position - 1) then
               old%last = position
               worse = new%amount > old%amount
               if (new%kind == violation_angle_small .or. new%kind == violation_slides) worse = new%amount < old%amount
               if (worse) then
                  old%amount = new%amount
                  old%worst = position
               end if
               return
            end if
         end associate
      end if
      if (noted == size(violations)) then
         allocate (more(max(8, 2*noted)))
         more(:noted) = violations
         call move_alloc(more, violations)
      end if
      noted = noted + 1
      violations(noted) = new
      current = noted
   end subroutine note_violation

   !> True if the outer joints of a loop's dyad can meet while it closes: two equal links, a slide whose guide has no length.
   pure logical function may_coincide(self, loop)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: loop

      associate (dyad => self%linkage%steps(self%linkage%step_of_loop(loop)))
         select case (dyad%joint)
         case (1)
            may_coincide = abs(dyad%p - dyad%q) <= no_distance*(dyad%p + dyad%q)
         case (2)
            may_coincide = dyad%q <= 0.0_wp
         case (3)
            may_coincide = dyad%p <= 0.0_wp
         case default
            may_coincide = .false.
         end select
      end associate
   end function may_coincide

   !> True if the outer joints of a loop's dyad coincide at position `i` of the block: no direction is determined.
   pure logical function coincides(self, loop, i)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: loop, i
      real(wp) :: least

      coincides = .false.
      if (.not. may_coincide(self, loop)) return
      associate (dyad => self%linkage%steps(self%linkage%step_of_loop(loop)))
         ! lengths are scaled: the longest arc is about 1
         least = no_distance
         if (dyad%joint == 1) least = no_distance*(dyad%p + dyad%q)
         coincides = self%linkage%store(self%linkage%reach(loop) + i - 1) <= least**2
      end associate
   end function coincides

   !> What is wrong with a loop at position `i` of the block, and by how much.
   pure type(violation_t) function violation_at(self, loop, i) result(violation)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: loop, i
      real(wp) :: reach, h, cosine

      violation%loop = loop
      reach = self%linkage%store(self%linkage%reach(loop) + i - 1)
      if (coincides(self, loop, i)) then
         violation%kind = violation_undetermined
         return
      end if
      associate (dyad => self%linkage%steps(self%linkage%step_of_loop(loop)))
         select case (dyad%joint)
         case (1)
            h = sqrt(reach)
            if (self%linkage%closes(i, loop)) then
               cosine = (dyad%p**2 + dyad%q**2 - reach)/(2.0_wp*dyad%p*dyad%q)
               violation%kind = merge(violation_angle_small, violation_angle_large, cosine > 0.0_wp)
               violation%amount = degrees_of(cosine, sqrt(max((1.0_wp - cosine)*(1.0_wp + cosine), 0.0_wp)))
               return
            end if
            if (h > dyad%p + dyad%q) then
               violation%kind = violation_too_short
               violation%amount = h - (dyad%p + dyad%q)
            else
               violation%kind = violation_too_long
               violation%amount = abs(dyad%p - dyad%q) - h
            end if
         case (2, 3)
            violation%kind = violation_too_long
            violation%amount = merge(dyad%q, dyad%p, dyad%joint == 2) - sqrt(reach)
         case (4, 5)
            violation%kind = violation_too_short
            violation%amount = abs(reach) - merge(dyad%p, dyad%q, dyad%joint == 4)
         case default
            violation%kind = violation_parallel
            violation%amount = 0.0_wp
            if (self%linkage%closes(i, loop)) then
               violation%kind = violation_slides
               violation%amount = arc_sine(min(abs(reach), 1.0_wp))
            end if
            return
         end select
      end associate
      violation%amount = violation%amount/self%linkage%scale
   end function violation_at
end module psalm_error
