!> A linkage ready to move: the solution plan with its numbers put in, and the storage one block of positions needs.
!>
!> `prepare` is called once for a topology, `bind` for each set of dimensions, `solve` for each block of positions. After
!> `solve` the unit vectors of all roots, the points, the sliding lengths and the reach of each dyad lie in the object.
!> Nothing is allocated after `prepare`. Knows nothing of desired values or of searches.
module psalm_linkage
   use psalm_angles, only: unit_vector
   use psalm_dyads, only: solve_two_links, solve_slide_on_q, solve_slide_on_p, solve_link_slide, solve_slide_link, &
                          project_on_slides, solve_two_slides
   use psalm_kinds, only: wp, right_angle
   use psalm_plan, only: plan_t, step_point, step_dyad, root_frame, root_crank, origin
   use psalm_topology, only: topology_t, dimensions_t, arc_actuator
   implicit none (type, external)
   private
   public :: linkage_t, bound_step_t, block_length

   integer, parameter :: block_length = 128 !! positions solved together: all arrays stay in first-level cache

   real(wp), parameter :: rounding = 64.0_wp*epsilon(1.0_wp) !! relative width of a limit of closure
   real(wp), parameter :: least_sine = 16.0_wp*epsilon(1.0_wp) !! two slides at a smaller angle are parallel
   integer, parameter :: plain_exponent = maxexponent(1.0_wp)/8 !! lengths beyond 2**this are scaled before they are squared

   !> One step of the plan with its numbers. Which components have a meaning depends on the kind.
   type :: bound_step_t
      integer :: kind = 0, loop = 0, joint = 0
      integer :: from = origin, to = origin      !! points; of a dyad: S and E
      integer :: arc = 0                         !! point step: the arc
      integer :: root = root_frame, slot = 0     !! point step: root of the arc, slot of its varying length
      logical :: fixed = .false.                 !! point step: the point belongs to the frame
      integer :: arc_p = 0, arc_q = 0            !! dyad: the undetermined arcs
      integer :: root_p = root_frame, root_q = root_frame !! dyad: roots found, or roots of the slides' directions
      integer :: slot_p = 0, slot_q = 0          !! dyad: slots of the slides
      real(wp) :: x = 0.0_wp, y = 0.0_wp         !! point step: the arc in the axes of its root, sense included
      real(wp) :: p = 0.0_wp, q = 0.0_wp, sign = 1.0_wp !! dyad: lengths and assembly
      real(wp) :: px = 1.0_wp, py = 0.0_wp       !! dyad: direction of slide p in the axes of its root
      real(wp) :: qx = 1.0_wp, qy = 0.0_wp       !! dyad: direction of slide q in the axes of its root
   end type bound_step_t

   type :: linkage_t
      integer :: room = 0                        !! most positions of a block
      type(bound_step_t), allocatable :: steps(:)
      integer, allocatable :: step_of_loop(:)    !! by loop: its dyad step, 0 if it is not in the plan
      real(wp) :: scale = 1.0_wp                 !! internal length = user's length * scale (a power of two, mostly 1)
      ! arcs, by sequential number
      real(wp), allocatable :: angle(:)          !! degrees from the root
      real(wp), allocatable :: x(:), y(:)        !! its cosine and sine
      real(wp), allocatable :: length(:)         !! scaled length
      ! limits of the dyads' reach, by loop: closure, and closure with transmission angle
      real(wp), allocatable :: closes_low(:), closes_high(:), accepts_low(:), accepts_high(:)
      ! one block of positions
      real(wp), allocatable :: root_x(:, :), root_y(:, :)   !! shape (room, nroots)
      real(wp), allocatable :: point_x(:, :), point_y(:, :) !! shape (room, 0:npoints), scaled
      real(wp), allocatable :: slide(:, :)                  !! shape (room, nlengths), scaled
      real(wp), allocatable :: reach(:, :)                  !! shape (room, nloop), scaled; as `psalm_dyads` defines it
      ! input
      logical :: sliding_input = .false.
      integer :: input_slot = 0                  !! slot of the actuator's length
      real(wp) :: crank_x = 1.0_wp, crank_y = 0.0_wp !! unit vector at the reference position
      real(wp) :: reference_length = 0.0_wp      !! actuator's length at the reference position, user's unit
      real(wp) :: cosine_lowest = 0.0_wp         !! cosine of the smallest transmission angle allowed
   contains
      procedure :: prepare
      procedure :: bind
      procedure :: solve
      procedure :: closes
      procedure :: accepts
      procedure :: all_accepted
   end type linkage_t

contains

   !> Allocate storage and resolve every index of the plan.
   subroutine prepare(self, topology, plan, tangle, positions)
      class(linkage_t), intent(out) :: self
      type(topology_t), intent(in) :: topology
      type(plan_t), intent(in) :: plan
      real(wp), intent(in) :: tangle    !! allowed deviation of a transmission angle from 90 degrees; 90: closure only
      integer, intent(in) :: positions  !! positions there will be
      real(wp) :: unused
      integer :: k, n, loop

      self%room = max(1, min(block_length, positions))
      n = size(topology%arcs)
      allocate (self%steps(size(plan%steps)))
      allocate (self%step_of_loop(topology%nloop), source=0)
      allocate (self%angle(n), self%y(n), source=0.0_wp)
      allocate (self%x(n), source=1.0_wp)
      allocate (self%length(n), source=0.0_wp)
      allocate (self%closes_low(topology%nloop), self%closes_high(topology%nloop), source=0.0_wp)
      allocate (self%accepts_low(topology%nloop), self%accepts_high(topology%nloop), source=0.0_wp)
      allocate (self%root_x(self%room, plan%nroots), source=1.0_wp)
      allocate (self%root_y(self%room, plan%nroots), source=0.0_wp)
      allocate (self%point_x(self%room, 0:plan%npoints), self%point_y(self%room, 0:plan%npoints), source=0.0_wp)
      allocate (self%slide(self%room, plan%nlengths), self%reach(self%room, topology%nloop), source=0.0_wp)
      self%sliding_input = topology%sliding_input
      call unit_vector(right_angle - tangle, self%cosine_lowest, unused)
      if (topology%sliding_input) self%input_slot = plan%length_slot(1)
      do k = 1, size(plan%steps)
         associate (step => plan%steps(k), bound => self%steps(k))
            bound%kind = step%kind
            bound%loop = step%loop
            bound%from = step%from
            bound%to = step%to
            if (step%kind == step_point) then
               bound%arc = step%arc
               bound%root = plan%root(step%arc)
               bound%slot = plan%length_slot(step%arc)
               bound%fixed = step%fixed
               bound%sign = real(step%sense, wp)
            else
               loop = step%loop
               self%step_of_loop(loop) = k
               bound%joint = topology%joint(loop)
               bound%arc_p = topology%seq(loop, topology%larcx(1, loop))
               bound%arc_q = topology%seq(loop, topology%larcx(2, loop))
               bound%root_p = plan%root(bound%arc_p)
               bound%root_q = plan%root(bound%arc_q)
               bound%slot_p = plan%length_slot(bound%arc_p)
               bound%slot_q = plan%length_slot(bound%arc_q)
               bound%sign = real(plan%dyad_sign(loop), wp)
               if (bound%joint == 2) bound%sign = real(-topology%arcs(bound%arc_p)%turn, wp)
               if (bound%joint == 3) bound%sign = real(topology%arcs(bound%arc_q)%turn, wp)
            end if
         end associate
      end do
   end subroutine prepare

   !> Put a set of dimensions in. Only angles that differ from the last ones cost a sine and a cosine.
   pure subroutine bind(self, topology, plan, dimensions)
      class(linkage_t), intent(inout) :: self
      type(topology_t), intent(in) :: topology
      type(plan_t), intent(in) :: plan
      type(dimensions_t), intent(in) :: dimensions
      integer :: k

      call choose_scale(self, dimensions)
      call bind_angles(self, plan, dimensions)
      self%length = dimensions%arcl*self%scale
      if (topology%sliding_input) then
         self%reference_length = dimensions%crnki
      else
         call unit_vector(dimensions%crnki, self%crank_x, self%crank_y)
      end if
      do k = 1, size(self%steps)
         if (self%steps(k)%kind == step_point) then
            call bind_point(self, self%steps(k))
         else
            call bind_dyad(self, self%steps(k))
         end if
      end do
   end subroutine bind

   !> Lengths are squared: far from one they are scaled by a power of two, which changes no digit.
   pure subroutine choose_scale(self, dimensions)
      type(linkage_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      integer :: e

      e = exponent(max(maxval(dimensions%arcl), abs(dimensions%crnki)*merge(1.0_wp, 0.0_wp, self%sliding_input)))
      self%scale = 1.0_wp
      if (abs(e) > plain_exponent) self%scale = scale(1.0_wp, -e)
   end subroutine choose_scale

   pure subroutine bind_angles(self, plan, dimensions)
      type(linkage_t), intent(inout) :: self
      type(plan_t), intent(in) :: plan
      type(dimensions_t), intent(in) :: dimensions
      integer :: k, n, b
      real(wp) :: angle

      do k = 1, size(plan%order)
         n = plan%order(k)
         b = plan%base(n)
         if (plan%takes_gama(n)) then
            angle = dimensions%gama(n)
            if (b > 0) angle = angle + self%angle(b)
            if (angle == self%angle(n)) cycle
            self%angle(n) = angle
            call unit_vector(angle, self%x(n), self%y(n))
         else if (b > 0) then
            self%angle(n) = self%angle(b) + right_angle*real(plan%quarter(n), wp)
            select case (plan%quarter(n))
            case (1)
               self%x(n) = -self%y(b)
               self%y(n) = self%x(b)
            case (-1)
               self%x(n) = self%y(b)
               self%y(n) = -self%x(b)
            case default
               self%x(n) = self%x(b)
               self%y(n) = self%y(b)
            end select
         end if
      end do
   end subroutine bind_angles

   pure subroutine bind_point(self, step)
      type(linkage_t), intent(inout) :: self
      type(bound_step_t), intent(inout) :: step
      real(wp) :: x, y

      step%x = step%sign*self%x(step%arc)
      step%y = step%sign*self%y(step%arc)
      if (step%slot > 0) return
      step%x = step%x*self%length(step%arc)
      step%y = step%y*self%length(step%arc)
      if (.not. step%fixed) return
      x = self%point_x(1, step%from) + step%x
      y = self%point_y(1, step%from) + step%y
      self%point_x(:, step%to) = x
      self%point_y(:, step%to) = y
   end subroutine bind_point

   pure subroutine bind_dyad(self, step)
      type(linkage_t), intent(inout) :: self
      type(bound_step_t), intent(inout) :: step
      real(wp) :: p, q, slack

      p = self%length(step%arc_p)
      q = self%length(step%arc_q)
      step%p = p
      step%q = q
      step%px = self%x(step%arc_p)
      step%py = self%y(step%arc_p)
      step%qx = self%x(step%arc_q)
      step%qy = self%y(step%arc_q)
      associate (low => self%closes_low(step%loop), high => self%closes_high(step%loop))
         select case (step%joint)
         case (1)
            slack = rounding*(p + q)**2
            low = max((p - q)**2 - slack, tiny(p))
            high = (p + q)**2 + slack
            self%accepts_low(step%loop) = max(p*p + q*q - 2.0_wp*p*q*self%cosine_lowest - slack, tiny(p))
            self%accepts_high(step%loop) = p*p + q*q + 2.0_wp*p*q*self%cosine_lowest + slack
            return
         case (2)
            low = max(q*q*(1.0_wp - rounding), tiny(q))
            high = huge(q)
         case (3)
            low = max(p*p*(1.0_wp - rounding), tiny(p))
            high = huge(p)
         case (4)
            high = p*(1.0_wp + rounding)
            low = -high
         case (5)
            high = q*(1.0_wp + rounding)
            low = -high
         case (8)
            low = least_sine
            high = 2.0_wp
         case default
            low = 0.0_wp
            high = 2.0_wp
         end select
         self%accepts_low(step%loop) = low
         self%accepts_high(step%loop) = high
      end associate
   end subroutine bind_dyad

   !> Positions of one block. After it, the object holds roots, points, slides and reaches.
   pure subroutine solve(self, n, first, second, last_step)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: n                   !! positions, at most `room`
      real(wp), intent(in) :: first(n)           !! cosine of the input increment (sliding input: the increment, [length])
      real(wp), intent(in) :: second(n)          !! sine of the input increment (sliding input: not used)
      integer, intent(in), optional :: last_step !! solve the steps up to this one only; default all
      integer :: i, k, last

      if (self%sliding_input) then
         if (self%input_slot > 0) then
            do i = 1, n
               self%slide(i, self%input_slot) = (self%reference_length + first(i))*self%scale
            end do
         end if
      else
         do i = 1, n
            self%root_x(i, root_crank) = self%crank_x*first(i) - self%crank_y*second(i)
            self%root_y(i, root_crank) = self%crank_y*first(i) + self%crank_x*second(i)
         end do
      end if
      last = size(self%steps)
      if (present(last_step)) last = last_step
      do k = 1, last
         associate (step => self%steps(k))
            if (step%kind == step_dyad) then
               call solve_dyad(self, n, step)
            else if (.not. step%fixed) then
               if (step%slot == 0) then
                  call add_arc(n, self%point_x(:, step%from), self%point_y(:, step%from), self%root_x(:, step%root), &
                               self%root_y(:, step%root), step%x, step%y, self%point_x(:, step%to), self%point_y(:, step%to))
               else
                  call add_slide(n, self%point_x(:, step%from), self%point_y(:, step%from), self%root_x(:, step%root), &
                                 self%root_y(:, step%root), self%slide(:, step%slot), step%x, step%y, &
                                 self%point_x(:, step%to), self%point_y(:, step%to))
               end if
            end if
         end associate
      end do
   end subroutine solve

   pure subroutine solve_dyad(self, n, step)
      type(linkage_t), intent(inout) :: self
      integer, intent(in) :: n
      type(bound_step_t), intent(in) :: step
      integer :: p, q

      p = step%root_p
      q = step%root_q
      associate (sx => self%point_x(:, step%from), sy => self%point_y(:, step%from), ex => self%point_x(:, step%to), &
                 ey => self%point_y(:, step%to), rx => self%root_x, ry => self%root_y, reach => self%reach(:, step%loop))
         select case (step%joint)
         case (1)
            call solve_two_links(n, sx, sy, ex, ey, step%p, step%q, step%sign, rx(:, p), ry(:, p), rx(:, q), ry(:, q), reach)
         case (2)
            call solve_slide_on_q(n, sx, sy, ex, ey, step%q, step%sign, rx(:, p), ry(:, p), self%slide(:, step%slot_p), reach)
         case (3)
            call solve_slide_on_p(n, sx, sy, ex, ey, step%p, step%sign, rx(:, p), ry(:, p), self%slide(:, step%slot_q), reach)
         case (4)
            call solve_link_slide(n, sx, sy, ex, ey, step%p, step%sign, rx(:, q), ry(:, q), step%qx, step%qy, rx(:, p), &
                                  ry(:, p), self%slide(:, step%slot_q), reach)
         case (5)
            call solve_slide_link(n, sx, sy, ex, ey, step%q, step%sign, rx(:, p), ry(:, p), step%px, step%py, rx(:, q), &
                                  ry(:, q), self%slide(:, step%slot_p), reach)
         case (6, 7)
            call project_on_slides(n, sx, sy, ex, ey, rx(:, p), ry(:, p), step%px, step%py, step%qx, step%qy, &
                                   self%slide(:, step%slot_p), self%slide(:, step%slot_q), reach)
         case (8)
            call solve_two_slides(n, sx, sy, ex, ey, rx(:, p), ry(:, p), step%px, step%py, rx(:, q), ry(:, q), step%qx, &
                                  step%qy, self%slide(:, step%slot_p), self%slide(:, step%slot_q), reach)
         end select
      end associate
   end subroutine solve_dyad

   !> Point at the other end of an arc of fixed length.
   pure subroutine add_arc(n, fx, fy, rx, ry, ax, ay, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: fx(n), fy(n) !! point to start from
      real(wp), intent(in) :: rx(n), ry(n) !! root
      real(wp), intent(in) :: ax, ay       !! the arc in the axes of its root
      real(wp), intent(out) :: tx(n), ty(n)
      integer :: i

      do i = 1, n
         tx(i) = fx(i) + (ax*rx(i) - ay*ry(i))
         ty(i) = fy(i) + (ax*ry(i) + ay*rx(i))
      end do
   end subroutine add_arc

   !> Point at the other end of an arc of varying length.
   pure subroutine add_slide(n, fx, fy, rx, ry, length, ax, ay, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: fx(n), fy(n), rx(n), ry(n), length(n), ax, ay
      real(wp), intent(out) :: tx(n), ty(n)
      integer :: i

      do i = 1, n
         tx(i) = fx(i) + length(i)*(ax*rx(i) - ay*ry(i))
         ty(i) = fy(i) + length(i)*(ax*ry(i) + ay*rx(i))
      end do
   end subroutine add_slide

   !> True where loop `loop` closes at position `i` of the block (to rounding).
   pure logical function closes(self, i, loop)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: i, loop

      closes = self%reach(i, loop) >= self%closes_low(loop) .and. self%reach(i, loop) <= self%closes_high(loop)
   end function closes

   !> True where loop `loop` closes at position `i` of the block and its transmission angle is within the limits.
   pure logical function accepts(self, i, loop)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: i, loop

      accepts = self%reach(i, loop) >= self%accepts_low(loop) .and. self%reach(i, loop) <= self%accepts_high(loop)
   end function accepts

   !> True if loop `loop` is accepted at the first `n` positions of the block.
   pure logical function all_accepted(self, n, loop)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: n, loop
      integer :: i, outside

      outside = 0
      associate (low => self%accepts_low(loop), high => self%accepts_high(loop), reach => self%reach(:, loop))
         do i = 1, n
            outside = outside + merge(0, 1, reach(i) >= low .and. reach(i) <= high)
         end do
      end associate
      all_accepted = outside == 0
   end function all_accepted
end module psalm_linkage
