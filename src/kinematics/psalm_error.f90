!> ERROR: positions of the linkage at the prescribed inputs, the output there, and the objective.
!>
!> A `problem_t` is everything an analysis or a search works on: topology, plan, inputs, desired values and weights, and a
!> linkage to move. Source of motions and objective: Oldham (1977), chapter 5 and appendix B.
module psalm_error
   use psalm_angles, only: unit_vector, degrees_of, nearest_difference, within_turn
   use psalm_data_set, only: data_set_t, motion_point, motion_angle, motion_distance, motion_slide
   use psalm_kinds, only: wp
   use psalm_linkage, only: linkage_t
   use psalm_plan, only: plan_t, make_plan
   use psalm_topology, only: topology_t, dimensions_t
   implicit none (type, external)
   private
   public :: problem_t, motion_t, violation_t, make_problem, violation_none
   public :: violation_too_short, violation_too_long, violation_parallel, violation_angle_small, violation_angle_large

   integer, parameter :: violation_none = 0
   integer, parameter :: violation_too_short = 1    !! the dyad does not reach
   integer, parameter :: violation_too_long = 2     !! the difference of the links, or the guide, is too great
   integer, parameter :: violation_parallel = 3     !! two slides are parallel
   integer, parameter :: violation_angle_small = 4  !! closes, but the transmission angle is too small
   integer, parameter :: violation_angle_large = 5  !! closes, but the transmission angle is too large

   !> Consecutive positions at which one dyad violates one limit.
   type :: violation_t
      integer :: kind = violation_none
      integer :: loop = 0
      integer :: first = 0, last = 0   !! positions
      integer :: worst = 0             !! position of the largest amount
      real(wp) :: amount = 0.0_wp      !! length missing, or the transmission angle, degrees, at the worst position
   end type violation_t

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
   end type motion_t

   type :: problem_t
      type(topology_t) :: topology
      type(plan_t) :: plan
      type(dimensions_t) :: given                  !! the user's linkage
      type(linkage_t) :: linkage                   !! bound to the last dimensions evaluated
      integer :: motion = motion_point
      real(wp) :: tangle = 90.0_wp, toggle = 0.0_wp
      integer :: positions = 0
      real(wp), allocatable :: delt(:)             !! shape (positions): degrees or length
      real(wp), allocatable :: first(:), second(:) !! shape (positions): cosine and sine of DELT, or DELT and nothing
      logical :: desired = .false.                 !! there are desired values
      real(wp), allocatable :: wanted(:), wanted_y(:) !! shape (positions): desired values, machine coordinates for MOTION 0
      real(wp), allocatable :: weight(:), weight_y(:) !! shape (positions)
      real(wp), allocatable :: out_x(:), out_y(:)     !! shape (room): output of one block
   contains
      procedure :: set_inputs
      procedure :: bind => bind_problem
      procedure :: solve_block
      procedure :: blocks
      procedure :: evaluate
      procedure :: analyse
      procedure :: reach_of
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
      problem%plan = make_plan(topology, set%motion, everything=set%ktheta /= 0)
      if (set%ikin /= 0) then
         turn = [(real(i*set%ikin, wp), i=0, (359/abs(set%ikin)))]
         call problem%set_inputs(turn)
         return
      end if
      call problem%set_inputs(set%delt)
      problem%desired = set%desired
      if (.not. set%desired) return
      if (set%motion == motion_point) then
         problem%wanted = set%desx + set%xadd
         problem%wanted_y = set%desy + set%yadd
         problem%weight = set%xmult
         problem%weight_y = set%ymult
      else
         problem%wanted = set%desang
         problem%weight = set%anmult
      end if
   end subroutine make_problem

   !> Give the input positions (increments from the reference position); desired values are dropped.
   subroutine set_inputs(self, delt)
      class(problem_t), intent(inout) :: self
      real(wp), intent(in) :: delt(:)  !! degrees, or length with a sliding input
      integer :: i

      self%positions = size(delt)
      self%delt = delt
      self%desired = .false.
      self%first = delt
      self%second = delt
      if (.not. self%topology%sliding_input) then
         do i = 1, size(delt)
            call unit_vector(delt(i), self%first(i), self%second(i))
         end do
      end if
      call self%linkage%prepare(self%topology, self%plan, self%tangle, size(delt))
      if (allocated(self%out_x)) deallocate (self%out_x, self%out_y)
      allocate (self%out_x(self%linkage%room), self%out_y(self%linkage%room), source=0.0_wp)
   end subroutine set_inputs

   !> Put dimensions in.
   pure subroutine bind_problem(self, dimensions)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions

      call self%linkage%bind(self%topology, self%plan, dimensions)
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

      offset = (block - 1)*self%linkage%room
      n = min(self%linkage%room, self%positions - offset)
      call self%linkage%solve(n, self%first(offset + 1:offset + n), self%second(offset + 1:offset + n), last_step)
   end subroutine solve_block

   !> Objective of a linkage: the sum of weight * (desired - actual)**2.
   !>
   !> `loop` is the lowest loop that does not close, or whose transmission angle is out of limits, at any position; the
   !> objective has no meaning then. No allocation.
   pure subroutine evaluate(self, dimensions, objective, loop)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(out) :: objective
      integer, intent(out) :: loop         !! 0: none
      integer :: block, offset, n, l

      call self%bind(dimensions)
      objective = 0.0_wp
      loop = self%topology%nloop + 1
      do block = 1, self%blocks()
         call self%solve_block(block, offset, n)
         do l = 1, min(loop - 1, self%topology%nloop)
            if (self%linkage%step_of_loop(l) == 0) cycle
            if (.not. self%linkage%all_accepted(n, l)) then
               loop = l
               exit
            end if
         end do
         if (loop > self%topology%nloop) then
            call output_of_block(self, dimensions, n)
            call add_errors(self, offset, n, objective)
         end if
      end do
      if (loop > self%topology%nloop) loop = 0
   end subroutine evaluate

   !> Output of the block: x and y; unit vector of the output arc; distance or length (x only).
   pure subroutine output_of_block(self, dimensions, n)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: n
      real(wp) :: c, s, x, y, origin_x, origin_y, back
      integer :: i, root, point, slot

      associate (link => self%linkage, arc => self%topology%output_arc)
         root = self%plan%root(arc)
         back = 1.0_wp/link%scale
         if (self%motion == motion_slide) then
            slot = self%plan%length_slot(arc)
            self%out_x(:n) = link%slide(:n, slot)*back
            return
         end if
         call unit_vector(link%angle(arc) + dimensions%outang, c, s)
         if (self%motion == motion_angle) then
            do i = 1, n
               self%out_x(i) = c*link%root_x(i, root) - s*link%root_y(i, root)
               self%out_y(i) = c*link%root_y(i, root) + s*link%root_x(i, root)
            end do
            return
         end if
         point = self%plan%output_point
         c = c*dimensions%outlk
         s = s*dimensions%outlk
         call unit_vector(dimensions%origng, origin_x, origin_y)
         origin_x = origin_x*dimensions%origlk
         origin_y = origin_y*dimensions%origlk
         do i = 1, n
            x = c*link%root_x(i, root) - s*link%root_y(i, root)
            y = c*link%root_y(i, root) + s*link%root_x(i, root)
            self%out_x(i) = link%point_x(i, point)*back + x + origin_x
            self%out_y(i) = link%point_y(i, point)*back + y + origin_y
         end do
         if (self%motion == motion_distance) then
            do i = 1, n
               self%out_x(i) = sqrt(self%out_x(i)**2 + self%out_y(i)**2)
            end do
         end if
      end associate
   end subroutine output_of_block

   pure subroutine add_errors(self, offset, n, objective)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: offset, n
      real(wp), intent(inout) :: objective
      real(wp) :: error
      integer :: i, k

      select case (self%motion)
      case (motion_point)
         do i = 1, n
            k = offset + i
            objective = objective + self%weight(k)*(self%wanted(k) - self%out_x(i))**2 &
                        + self%weight_y(k)*(self%wanted_y(k) - self%out_y(i))**2
         end do
      case (motion_angle)
         do i = 1, n
            k = offset + i
            error = nearest_difference(self%wanted(k), degrees_of(self%out_x(i), self%out_y(i)))
            objective = objective + self%weight(k)*error**2
         end do
      case default
         do i = 1, n
            k = offset + i
            objective = objective + self%weight(k)*(self%wanted(k) - self%out_x(i))**2
         end do
      end select
   end subroutine add_errors

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
         reach(offset + 1:offset + n) = self%linkage%reach(:n, loop)*back
      end do
   end subroutine reach_of

   !> The whole motion of a linkage: actual values, errors, and every violation of closure or transmission limits.
   subroutine analyse(self, dimensions, motion)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(out) :: motion
      integer :: block, offset, n, i, k, l
      integer, allocatable :: open_violation(:)
      real(wp) :: angle

      n = self%positions
      allocate (motion%closed(n), source=.true.)
      allocate (motion%input(n), motion%actual(n), motion%actual_y(n), motion%error(n), motion%error_y(n), source=0.0_wp)
      allocate (motion%violations(0))
      allocate (open_violation(self%topology%nloop), source=0)
      motion%input = dimensions%crnki + self%delt
      if (.not. self%topology%sliding_input) motion%input = within_turn(motion%input)
      call self%bind(dimensions)
      do block = 1, self%blocks()
         call self%solve_block(block, offset, n)
         do l = 1, self%topology%nloop
            if (self%linkage%step_of_loop(l) == 0) cycle
            if (self%linkage%all_accepted(n, l)) cycle
            do i = 1, n
               if (self%linkage%accepts(i, l)) cycle
               if (.not. self%linkage%closes(i, l)) motion%closed(offset + i) = .false.
               call note_violation(self, l, i, offset + i, open_violation(l), motion%violations)
            end do
         end do
         call output_of_block(self, dimensions, n)
         do i = 1, n
            k = offset + i
            motion%actual(k) = self%out_x(i)
            motion%actual_y(k) = self%out_y(i)
            if (self%motion == motion_angle) then
               angle = degrees_of(self%out_x(i), self%out_y(i))
               if (self%desired) then
                  motion%error(k) = nearest_difference(self%wanted(k), angle)
                  motion%actual(k) = self%wanted(k) - motion%error(k)
               else
                  motion%actual(k) = within_turn(angle)
               end if
            else if (self%desired) then
               motion%error(k) = self%wanted(k) - motion%actual(k)
               if (self%motion == motion_point) motion%error_y(k) = self%wanted_y(k) - motion%actual_y(k)
            end if
            if (self%desired .and. motion%closed(k)) then
               motion%total = motion%total + self%weight(k)*motion%error(k)**2
               if (self%motion == motion_point) motion%total = motion%total + self%weight_y(k)*motion%error_y(k)**2
            end if
         end do
      end do
   end subroutine analyse

   !> Enter a violation, or let the one of the position before go on.
   subroutine note_violation(self, loop, i, position, current, violations)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: loop, i, position
      integer, intent(inout) :: current    !! the loop's last violation in the list, 0: none
      type(violation_t), allocatable, intent(inout) :: violations(:)
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
               if (new%kind == violation_angle_small) worse = new%amount < old%amount
               if (worse) then
                  old%amount = new%amount
                  old%worst = position
               end if
               return
            end if
         end associate
      end if
      allocate (more(size(violations) + 1))
      more(:size(violations)) = violations
      more(size(more)) = new
      call move_alloc(more, violations)
      current = size(violations)
   end subroutine note_violation

   !> What is wrong with a loop at position `i` of the block, and by how much.
   pure type(violation_t) function violation_at(self, loop, i) result(violation)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: loop, i
      real(wp) :: reach, h, cosine

      violation%loop = loop
      reach = self%linkage%reach(i, loop)
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
            return
         end select
      end associate
      violation%amount = violation%amount/self%linkage%scale
   end function violation_at
end module psalm_error
